"""Modulus of a rod's material from files of a mass on the rod."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check, Verdict, verdict
from dashpot.base.errors import DataError, FitError
from dashpot.base.option_fields import FamilyOption
from dashpot.base.provenance import Step
from dashpot.base.result_mixins import HasVerdict, Series, collect_arrays
from dashpot.base.serialisation import Key, Serialisable, to_plain_value
from dashpot.base.units import format_quantity
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.frf import FRF
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.materials.options import RodChoices
from dashpot.extensions.materials.rod.datamodel import RodErrors, RodModulus
from dashpot.extensions.materials.rod.fit import fit_rod
from dashpot.extensions.materials.rod.wave_equation import rod_modulus
from dashpot.reading.read_options import ReadOptions
from dashpot.solids.part_geometry import Block, Disc
from dashpot.vibration.impact.checks import line_errors_stated
from dashpot.workflow.frf_prediction import parse_part_shape
from dashpot.workflow.job import HammerChoices
from dashpot.workflow.measured_frf import read_measured

_LIGHTEST, _HEAVIEST = 5.0, 2e4
"""Density of a light foam and of a metal, kg/m^3."""
_ERRORS = ("gain", "phase", "mass", "length", "area", "density", "poisson", "glue")
_OF_THE_PLATEAU = frozenset({"plateau_determined", "curve_level_at_end"})
"""Checks of frequencies below the band of a rod, which its modulus in the band does not need."""


@dataclass(frozen=True, repr=False)
class Rod(HasVerdict, Serialisable):
    """Result of ``dashpot fit`` on a rod.

    Attributes
    ----------
    frf : FRF
        FRF of the mass, judged.
    modulus : RodModulus
        Line by line.
    part : Disc or Block
    bonded : bool
    mass, rod_mass : float
        On the rod, and of the rod, kg.
    errors : RodErrors
    fit : Fit or None
        Viscoelastic model, Pa, of the usable band.
    reason : str
        Why there is none.
    """

    schema = "dashpot/rod@2"
    _keys = (
        "shape",
        "part.shape_factor",
        "bonded",
        "mass",
        Key("rod_mass", "rod_mass"),
        "errors",
        "modulus.frequency",
        "modulus.storage",
        "modulus.loss_factor",
        "modulus.storage_sd",
        "modulus.loss_factor_sd",
        "sensitivity",
        "band",
        "verdict",
        "checks",
        Key("fit", optional=True),
    )

    frf: FRF
    modulus: RodModulus
    part: Disc | Block
    bonded: bool
    mass: float
    rod_mass: float
    errors: RodErrors
    fit: Fit | None
    reason: str = ""

    @property
    def _saved_result(self) -> Rod | Fit:
        """The fit, if there is one."""
        return self.fit or self

    @property
    def checks(self) -> tuple[Check, ...]:
        """Checks of FRF, inversion and fit."""
        # of an FRF without coherence the lines themselves show how they scatter
        frf_checks = tuple(
            check for check in self.frf.checks if check.name != line_errors_stated.name
        )
        checks = (*frf_checks, *self.modulus.checks)
        return checks if self.fit is None else self.fit.checks

    @property
    def _table_columns(self) -> Series:
        """The modulus over frequency."""
        return collect_arrays(
            self.modulus, frequency="Hz", storage="Pa", storage_sd="Pa", loss_factor="",
            loss_factor_sd="",
        )  # fmt: skip

    @property
    def verdict(self) -> Verdict:
        """Verdict, with the modulus of the usable band."""
        low, high = self.modulus.band
        return verdict(
            self.checks, headline=f"from {low:.3g} to {high:.3g} Hz the modulus is known to 10 %"
        )

    @property
    def shape(self) -> dict[str, Any]:
        """Shape and lengths of the rod."""
        return {"kind": type(self.part).__name__.lower(), **to_plain_value(self.part)}

    @property
    def sensitivity(self) -> dict[str, FloatArray]:
        """Each as rows of the real and the imaginary part of d ln E*."""
        modulus = self.modulus
        sensitivities = {name: getattr(modulus, f"by_{name}") for name in _ERRORS}
        return {
            name: np.column_stack([item.real, item.imag]) for name, item in sensitivities.items()
        }

    @property
    def band(self) -> tuple[float, float] | None:
        """Band in which the modulus is determined, Hz; None without one."""
        return self.modulus.band if self.modulus.usable.any() else None


def rod_files(
    files: Sequence[str | Path],
    *,
    mass: float,
    band: tuple[float, float] | None = None,
    hammer: HammerChoices | None = None,
    options: ReadOptions | None = None,
    **modulus_options: Any,
) -> Rod:
    """Find the modulus of a rod's material from the motion of the mass on it.

    Parameters
    ----------
    files : sequence of path
        A transmissibility, or another FRF of the mass; or records of base and mass in time, or hits
        on the mass.
    hammer, options
        How the files are read.
    mass, band, modulus_options
        As of :func:`rod_under`.
    """
    _, frf = read_measured(
        files, choices=hammer or HammerChoices(), options=options or ReadOptions(), mass=mass,
        band=band,
    )  # fmt: skip
    return rod_under(frf, mass=mass, band=band, **modulus_options)


def rod_under(
    frf: FRF,
    *,
    mass: float,
    density: float,
    rod: RodChoices,
    arms: int | Literal["auto"] = "auto",
    family: FamilyOption = "maxwell",
    band: tuple[float, float] | None = None,
    mass_sd: float | None = None,
    poisson: float | None = None,
    specimen: Specimen | None = None,
) -> Rod:
    """Find the modulus of a rod's material from the FRF of the mass on it, with its checks.

    Parameters
    ----------
    frf : FRF
    mass : float
        On the rod, kg.
    density : float
        Density of the rod, kg/m^3.
    rod : RodChoices
    arms, family
        Of the model fitted to the usable band.
    band : (float, float), optional
        Lines to use, Hz.
    mass_sd : float, optional
        Standard deviation of the mass, kg; 1 % by default: no line shows a mass that is off.
    poisson : float, optional
        Poisson's ratio of the rod, for its bonded ends; by default that of a rubber.
    specimen : Specimen, optional
    """
    part, errors, bonded = (
        _make_rod_shape(rod),
        RodErrors(rod.gain_error, rod.phase_error, glue=rod.glue_error),
        not rod.lubricated,
    )
    if mass_sd is not None:
        errors = replace(errors, mass=mass_sd / mass)
    if poisson is not None:
        if rod.lubricated:
            raise DataError("Poisson's ratio is asked of bonded ends: give it, or let them slide")
        part = replace(part, poisson=poisson)
    if not _LIGHTEST <= density <= _HEAVIEST:
        raise DataError(
            f"--density {density:g}: expected {_LIGHTEST:g} to {_HEAVIEST:g} kg/m^3, such as 1100 "
            "of rubber"
        )
    modulus = rod_modulus(
        frf, part, mass=mass, density=density, bonded=bonded, errors=errors, band=band
    )
    value = density * part.area * part.height
    new_rod = Rod(frf, modulus, part, bonded, mass, value, modulus.errors, None)
    try:
        fit = fit_rod(modulus, arms=arms, family=family, specimen=specimen)
    except FitError as error:
        return replace(new_rod, reason=str(error))
    step = Step(
        "rod_modulus",
        (("mass", f"{mass:.6g} kg"), ("density", f"{density:.6g} kg/m^3"), ("shape", str(part)),
         ("bonded", str(bonded).lower())),
        f"inverted the wave equation of a rod of {format_quantity(value, 'g')} under "
        f"{format_quantity(mass, 'g')}",
    )  # fmt: skip
    provenance = replace(
        fit.provenance, source=frf.source, steps=(*frf.steps, step, *fit.provenance.steps)
    )
    # what is asked of a rod is its modulus within a band; a plateau below it is not, and is noted
    final_checks = (
        replace(check, grade="note") if check.name in _OF_THE_PLATEAU else check
        for check in fit.checks
    )
    checks = (*new_rod.checks, *final_checks)
    evidence = replace(fit.evidence, checks=checks)
    return replace(new_rod, fit=replace(fit, provenance=provenance, evidence=evidence))


def _make_rod_shape(rod: RodChoices) -> Disc | Block:
    """Return the shape of the rod; its last length is the axial one."""
    if (rod.disc is None) == (rod.block is None):
        raise DataError(
            "a rod's shape turns motion into a modulus: give "
            "--shape disc:DIAMETER,LENGTH or --shape block:WIDTH,WIDTH,LENGTH"
        )
    return (
        parse_part_shape("disc", rod.disc)
        if rod.block is None
        else parse_part_shape("block", rod.block)
    )
