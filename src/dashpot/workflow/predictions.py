"""From a fit to the FRF of a mass on it, with its peak, its modes and its limits."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check, Verdict, verdict
from dashpot.base.errors import DataError
from dashpot.fitting.temperature.checks import temperature_tested
from dashpot.io.options import ReadOptions
from dashpot.io.readers.psd import BasePSD, read_psd
from dashpot.records.bounds import FRFBounds
from dashpot.records.fit import Fit
from dashpot.records.frf import FRF, Kind, Mode
from dashpot.records.machine import Machine
from dashpot.solids.maxwell import Solid
from dashpot.vibration.systems.mounts import entrained, on_heavy_mounts
from dashpot.vibration.systems.operating_point import OperatingPoint
from dashpot.vibration.systems.prediction import (
    isolation_frequency,
    model_modes,
    moving_mass,
    predict_frf,
)
from dashpot.vibration.systems.random_base import random_base, random_limits
from dashpot.workflow.at_level import (
    VANISHING,
    AtLevel,
    SweptPart,
    level_of,
    swept_part,
)
from dashpot.workflow.checks import base_band_informed, prediction_informed
from dashpot.workflow.job import LevelChoices, PartChoices, known_of_a_test
from dashpot.workflow.part import applied
from dashpot.workflow.prepared import at_their_temperatures, prepared_files, refuse_others
from dashpot.workflow.resting import (
    LIMIT_LINES,
    AtRest,
    at_rest,
    family_checks,
    formal_limits,
    frf_limits,
    rest_checks,
    rival_modes,
)


@dataclass(frozen=True)
class Prediction:
    """The FRF of a mass on `seals` seals, and what is known of it.

    Attributes
    ----------
    frf : FRF
    modes : tuple of Mode
    peak : (float, float)
        Frequency, Hz, and height of the largest magnitude, between the lines of the grid too.
    at_edge : bool
        That magnitude stands at an end of the band: it is no peak.
    limits : FRFBounds or None
        By both kinds of ignorance, if the relaxation record is at hand.
    checks : tuple of Check
        Where the mass rests, whether the peak is informed, those of the fit, and what the mass
        of the seals does.
    verdict : Verdict
        What to make of it.
    at_rest : AtRest
        Where the mass rests, and what secant and tangent make of it.
    document : dict
        ``dashpot/prediction@1``.
    of_part : bool
        Of a part of a material, not of the fit itself.
    levels : tuple of AtLevel
        The resonance at each level that was asked for; all else is of a vanishing one.
    """

    frf: FRF
    modes: tuple[Mode, ...]
    peak: tuple[float, float]
    at_edge: bool
    limits: FRFBounds | None
    checks: tuple[Check, ...]
    verdict: Verdict
    at_rest: AtRest
    document: dict[str, Any]
    of_part: bool = False
    levels: tuple[AtLevel, ...] = ()

    @property
    def interval(self) -> tuple[FloatArray, FloatArray]:
        """Lines, Hz, and limits by standard errors alone, of the accelerance, 1/kg, or of T."""
        limits = self.document["limits"]
        return np.asarray(limits["frequency_hz"]), np.asarray(limits["parameter"])


def predict_files(
    found: Fit,
    records: Sequence[str | Path] = (),
    *,
    mass: float,
    seal_mass: float | None = None,
    seals: float = 1.0,
    band: tuple[float, float],
    lines: int = 2001,
    kind: str = "accelerance",
    compression: float | None = None,
    temperature: float | None = None,
    part: PartChoices | None = None,
    at_level: LevelChoices | None = None,
    machine: Machine | None = None,
    options: ReadOptions | None = None,
    base_psd: str | None = None,
) -> Prediction:
    """Predict the FRF of a mass on a fitted seal.

    Parameters
    ----------
    found : Fit
        Of one seal.
    records : sequence of path
        The relaxation tests behind it: they bound the unresolved arms.
    mass, seal_mass : float
        Of the block and of one seal, kg.
    seals : float
    band : (float, float)
        Hz; `lines` lines are laid over it.
    kind : str
        What the FRF relates, as in :func:`~dashpot.vibration.systems.prediction.predict_frf`.
    compression : float, optional
        Of the seals, m; by default that of the mass's weight.
    temperature : float, optional
        K; by default that of the fit's solid.
    part : PartChoices, optional
        The geometry of a part, where the fit is of a material's modulus.
    at_level : LevelChoices, optional
        How far the part is moved, and the sweep that tells what this does.
    machine : Machine, optional
        What is known of the machine of those tests.
    options : ReadOptions, optional
        What the user said of their files.
    base_psd : str, optional
        A file, or a word such as ``"0.01g^2/Hz"``: how the base shakes at random.

    Raises
    ------
    DataError
        If a machine is described and no test was made on it, or a record is not what was fitted.
    """
    known_of_a_test(machine, tests=len(records), add="the record (--with)")
    moving, noted = moving_mass(mass, seal=seal_mass or 0.0, seals=seals)
    here = found if temperature is None else found.at_temperature(temperature)
    of_part, asked, scale = part is not None and part != PartChoices(), Kind(kind), seals
    swept = swept_part(at_level or LevelChoices(), unit=found.unit, part=part, options=options)
    if part is not None and of_part:
        if records:
            raise DataError(
                "a record (--with) bounds the part that was tested, not another of its material: "
                "leave it or the geometry out"
            )
        material = here.solid
        here = found = applied(
            part, here, seals=seals, base=asked.over_base, peak=_measured_at(swept, at_level, asked)
        )
        scale *= float(abs(here.solid.complex_stiffness(1.0) / material.complex_stiffness(1.0)))
    rests = at_rest(here, mass=moving, seals=seals, compression=compression)
    # over a base, mounts that weigh something couple the mass to it
    coupled = entrained(seal_mass, seals) if asked.over_base else 0.0
    on = _OnSeals(here, rests, moving, seals, coupled, asked)
    frf = on.frf(np.linspace(*band, lines))
    modes = model_modes(on.solid, moving)
    bounded = _bounds(on, found, records, temperature=temperature, machine=machine, options=options)
    limits = None
    if bounded is not None:
        few = np.linspace(max(frf.frequency[0], 1e-3), frf.frequency[-1], LIMIT_LINES)
        limits = bounded(frequency=few, kind=_bounded(frf))
    peak, at_edge = on.peak(frf)
    # what the test must inform is the resonance, inside the band or not
    felt = modes[0].frequency if modes and at_edge else peak[0]
    levels: tuple[AtLevel, ...] = ()
    moved: tuple[Check, ...] = ()
    if swept is not None and at_level is not None:
        about = modes[0].frequency if modes else peak[0]
        levels = on.at(swept, at_level.levels, frf, scale=scale, about=about)
        moved = (*swept.covered(levels), *swept.checks)
    checks = (
        *_led_by(on, mass=mass, band=band, felt=felt),
        *moved,
        *found.checks,
        *_asked_of(found, temperature),
        noted,
        *family_checks(here, rests.point, mass=moving, seals=seals),
    )
    judged = verdict(checks, sound=found.verdict.says)
    document = {
        "schema": "dashpot/prediction@1",
        "mass": mass,
        "moving_mass": moving,
        "seals": seals,
        "temperature": here.specimen.temperature,
        "kind": str(frf.kind),
        "unit": frf.unit,
        **rests.document,
        "peak": {"frequency_hz": peak[0], "value": peak[1], "at_edge": at_edge},
        "modes": _listed(modes),
        "alternative": _rival(here, rival_modes(here, rests.point, mass=moving, seals=seals)),
        "band_hz": list(here.band),
        "extrapolated": any(not here.band[0] <= mode.frequency <= here.band[1] for mode in modes),
        "frequency_hz": frf.frequency.tolist(),
        "real": frf.value.real.tolist(),
        "imag": frf.value.imag.tolist(),
        "limits": _plain(
            here, limits, rests.point, mass=moving, seals=seals, frf=frf, coupled=coupled
        ),
    }
    if swept is not None:
        document |= {"levels": [one.document for one in levels], "sweep": swept.document}
    if frf.kind is Kind.TRANSMISSIBILITY:
        document |= _over_base(on, base_psd, bounded)
    document["verdict"] = judged.document
    return Prediction(
        frf, modes, peak, at_edge, limits, checks, judged, rests, document, of_part, levels
    )


@dataclass(frozen=True)
class _OnSeals:
    """A mass on seals: the fit of one, where they rest, and what of them moves along."""

    fit: Fit
    rests: AtRest
    mass: float
    seals: float
    coupled: float
    kind: Kind

    @property
    def solid(self) -> Solid:
        """All the seals, as small vibration feels them."""
        return self.seals * self.rests.point.solid(self.fit)

    def frf(self, frequency: FloatArray) -> FRF:
        frf = predict_frf(self.solid, mass=self.mass, frequency=frequency, kind=self.kind)
        if self.coupled > 0:
            frf = on_heavy_mounts(frf, mass=self.mass, coupled=self.coupled)
        return frf

    def peak(self, frf: FRF) -> tuple[tuple[float, float], bool]:
        """Frequency and height of the largest magnitude, and whether it stands at an end."""
        top, last = int(np.abs(frf.value).argmax()), len(frf.value) - 1
        low, high = frf.frequency[max(top - 1, 0)], frf.frequency[min(top + 1, last)]
        fine = self.frf(np.linspace(low, high, 2001))
        height = np.abs(fine.value)
        peak = float(fine.frequency[height.argmax()]), float(height.max())
        return peak, top in {0, last} and peak[0] in {low, high}

    def at(
        self, swept: SweptPart, levels: Sequence[str], frf: FRF, *, scale: float, about: float
    ) -> tuple[AtLevel, ...]:
        """The resonance at each level."""
        return swept.at(
            self.solid,
            [level_of(word, self.kind) for word in levels],
            scale=scale,
            mass=self.mass,
            kind=self.kind,
            about=about,
            frequency=frf.frequency[frf.frequency > 0],
            coupled=self.coupled,
        )


def _bounds(
    on: _OnSeals,
    found: Fit,
    records: Sequence[str | Path],
    *,
    temperature: float | None,
    machine: Machine | None,
    options: ReadOptions | None,
) -> Callable[..., FRFBounds] | None:
    """What bounds the FRF by the relaxation tests; None without them."""
    if not records:
        return None
    tests = prepared_files(records, machine=machine, options=options)
    refuse_others(tests, found)
    return partial(
        frf_limits,
        found,
        at_their_temperatures(tests, found),
        on.rests.point,
        mass=on.mass,
        seals=on.seals,
        temperature=temperature,
        coupled=on.coupled,
    )


def _over_base(
    on: _OnSeals, base_psd: str | None, bounded: Callable[..., FRFBounds] | None
) -> dict[str, Any]:
    """From where the mass moves less than its base, and what one that shakes at random does."""
    found: dict[str, Any] = {}
    if base_psd is not None:
        found["random"] = _shaken(
            on.solid, read_psd(base_psd), bounded, mass=on.mass, coupled=on.coupled
        )
    return found | {"isolation_hz": isolation_frequency(on.solid, on.mass - on.coupled)}


def _led_by(
    on: _OnSeals, *, mass: float, band: tuple[float, float], felt: float
) -> tuple[Check, ...]:
    """A mass in a wrong unit first; then a solid that is not known at the peak."""
    informed = [prediction_informed(felt, on.fit.band)]
    if on.kind.over_base:
        informed.append(base_band_informed(band, felt, on.fit.band))
    return (*rest_checks(on.rests.point, mass), *informed)


def _asked_of(found: Fit, temperature: float | None) -> tuple[Check, ...]:
    """Whether a temperature that is asked for was tested."""
    if temperature is None or found.temperatures is None:
        return ()
    return (temperature_tested(found.temperatures, temperature),)


def _measured_at(
    swept: SweptPart | None, choices: LevelChoices | None, kind: Kind
) -> Callable[[Solid, float, float], float] | None:
    """The resonance of a mass at the level at which that of the user was measured.

    None where the solid was measured as the resonance was: by a vanishing motion.
    """
    if choices is None or swept is None or not (choices.resonance_level or swept.fitted_at):
        return None
    level = level_of(choices.resonance_level, kind) if choices.resonance_level else VANISHING

    def peak(solid: Solid, factor: float, mass: float) -> float:
        about = model_modes(solid, mass)[0].frequency
        how = {"scale": factor, "mass": mass, "level": level, "kind": kind}
        return swept.peak(solid, swept.law, swept.factors[0], about=about, **how)[0]

    return peak


def _shaken(
    solid: Solid,
    base: BasePSD,
    bounded: Callable[..., FRFBounds] | None,
    *,
    mass: float,
    coupled: float,
) -> dict[str, Any]:
    """Standard deviations over a base that shakes at random, of what, and between which limits."""
    f = base.frequency
    shaken: dict[str, Any] = {"mass": mass, "psd": base.density, "frequency": f, "coupled": coupled}
    document = {
        **asdict(random_base(solid, **shaken)),
        "of": "white noise" if f is None else base.source[0].file,
        "band_hz": None if f is None else [float(f[0]), float(f[-1])],
    }
    if bounded is not None:
        limits = random_limits(
            solid, lambda at, kind: bounded(frequency=at, kind=kind).unseen, **shaken
        )
        document["limits"] = {name: _or_null(ends) for name, ends in asdict(limits).items()}
    return document


def _listed(modes: Iterable[Mode]) -> list[dict[str, float]]:
    return [{"frequency_hz": mode.frequency, "damping_ratio": mode.damping_ratio} for mode in modes]


def _rival(found: Fit, modes: Sequence[Mode]) -> dict[str, Any] | None:
    """What the other family of solids that explains the test makes of the resonance."""
    other = found.alternative
    if other is None or not other.explains:
        return None
    return {"family": other.family, "modes": _listed(modes)}


def _plain(
    found: Fit,
    limits: FRFBounds | None,
    point: OperatingPoint,
    *,
    mass: float,
    seals: float,
    frf: FRF,
    coupled: float,
) -> dict[str, Any]:
    """Return the limits of the accelerance, 1/kg, or of T; null where nothing limits it."""
    lines = frf.frequency[frf.frequency > 0]
    f = np.linspace(lines[0], lines[-1], LIMIT_LINES) if limits is None else limits.frequency
    of = _bounded(frf)
    formal = formal_limits(
        found, point, mass=mass, frequency=f, seals=seals, kind=of, coupled=coupled
    )
    plain: dict[str, Any] = {
        "kind": str(of),
        "frequency_hz": f.tolist(),
        "parameter": formal.tolist(),
    }
    if limits is not None:
        plain["unseen"] = [_or_null(row) for row in limits.unseen]
        plain["peak_frequency_hz"] = _or_null(limits.peak_frequency)
        plain["peak_height"] = _or_null(limits.peak_height)
    return plain


def _bounded(frf: FRF) -> Kind:
    """What is bounded: of a force on the mass the accelerance, from which the others follow."""
    return frf.kind if frf.kind.over_base else Kind.ACCELERANCE


def _or_null(values: Iterable[float] | None) -> list[float | None] | None:
    """Numbers with null where nothing limits them."""
    if values is None:
        return None
    return [float(value) if np.isfinite(value) else None for value in values]
