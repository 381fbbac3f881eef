"""What part of a material a mass rests on: its geometry, from what a user says of it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal, get_args, overload

from dashpot.base.choices import PartMode
from dashpot.base.errors import DataError
from dashpot.datamodel.fit import Fit
from dashpot.solids.maxwell import Solid
from dashpot.solids.part_geometry import Block, Bulb, Bush, Disc, Geometry, named_shape
from dashpot.vibration.systems.frf_prediction import geometry_factor
from dashpot.workflow.job import PartChoices


def height_of(part: PartChoices) -> float | None:
    """Return the height of a pad, m; None of what has none, or where no shape is given."""
    shape = next((pad(flag, lengths) for flag in _SHAPES if (lengths := getattr(part, flag))), None)
    return shape.height if isinstance(shape, Disc | Block) else None


def apply_part_factor(
    part: PartChoices,
    fit: Fit,
    *,
    seals: float,
    base: bool,
    peak: Callable[[Solid, float, float], float] | None = None,
) -> Fit:
    """Return the fit of one of `seals` such parts; the fit itself where nothing is said.

    `peak`, of a solid, its factor and a mass, is the resonance at the level at which that of
    the user was measured.

    Raises
    ------
    DataError
        If more than one geometry is given, or one that cannot be.
    """
    provided = [flag for flag in (*_SHAPES, "resonance") if getattr(part, flag) is not None]
    if not provided:
        if part != PartChoices():
            raise DataError(
                "--loading, --lubricated and --resonance-mass belong to a --shape or to a "
                "--resonance; add one, or leave them out"
            )
        return fit
    if len(provided) > 1:
        raise DataError(
            f"--{provided[0]} and --{provided[1]} both give the geometry; leave one of them out"
        )
    if part.resonance is None:
        if part.resonance_mass is not None:
            raise DataError("--resonance-mass belongs to a --resonance; add that, or leave it")
        return fit.part(
            pad(provided[0], getattr(part, provided[0])),
            _mode(part.mode),
            bonded=not part.lubricated,
        )
    factor = _factor(part, part.resonance, fit.solid, base=base, peak=peak)
    return fit.part(factor / seals)


def _factor(
    part: PartChoices,
    resonance: float,
    solid: Solid,
    *,
    base: bool,
    peak: Callable[[Solid, float, float], float] | None,
) -> float:
    """The geometry factor of all the parts, by the resonance of a mass on them."""
    if part.resonance_mass is None:
        raise DataError("--resonance needs the mass that it was measured with: --resonance-mass")
    if part.mode is not None or part.lubricated:
        raise DataError(
            "a resonance gives the factor, however the part is loaded: leave --loading "
            "and --lubricated out"
        )
    kind = "transmissibility" if base else "accelerance"
    factor = geometry_factor(solid, mass=part.resonance_mass, peak=resonance, kind=kind)
    if peak is not None:
        for _ in range(_ROUNDS):
            value = peak(factor * solid, factor, part.resonance_mass)
            factor *= (resonance / value) ** 2
    return factor


_ROUNDS = 6
"""To a factor whose resonance at a level is the measured one: each leaves a tenth at most."""
_SHAPES: dict[str, type[Disc | Block | Bush | Bulb]] = {
    "disc": Disc, "block": Block, "bush": Bush, "bulb": Bulb,
}  # fmt: skip


@overload
def pad(flag: Literal["disc"], lengths: str | None) -> Disc: ...
@overload
def pad(flag: Literal["block"], lengths: str | None) -> Block: ...
@overload
def pad(flag: str, lengths: str | None) -> Geometry: ...
def pad(flag: str, lengths: str | None) -> Geometry:
    """Return the shape that an option names, of its lengths with commas between them.

    Raises
    ------
    DataError
        If there are too few or too many, or one is no length > 0.
    """
    return named_shape(f"{flag}:{lengths}")


def _mode(word: str | None) -> PartMode | None:
    return next((arg for arg in get_args(PartMode) if arg == word), None)
