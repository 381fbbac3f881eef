"""Prediction of the FRF of a mass on a fitted seal or part: peak, modes, limits."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Protocol, get_args, overload

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check, Verdict, verdict
from dashpot.base.errors import DataError
from dashpot.base.number_format import format_band
from dashpot.base.option_fields import PartMode
from dashpot.base.reported_values import ReportedValue
from dashpot.base.result_mixins import HasVerdict, Series
from dashpot.base.serialisation import Key, Serialisable
from dashpot.base.value_ranges import SIZES, require_positive
from dashpot.datamodel.bounds import FRFBounds
from dashpot.datamodel.checks import temperature_tested
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.frf import FRF, Kind, Mode
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.random_response import RandomLimits, RandomResponse
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.write import write_frf
from dashpot.registry import require_handler
from dashpot.solids.maxwell import Solid
from dashpot.solids.part_geometry import Block, Bulb, Bush, Disc, Geometry, find_shape
from dashpot.vibration.mass_on_seals import (
    MassOnSeals,
    add_mount_mass,
    compute_coupled_mass,
    geometry_factor,
    isolation_frequency,
    model_modes,
    moving_mass,
    predict_frf,
)
from dashpot.workflow.checks import base_band_in_valid_band, prediction_in_valid_band
from dashpot.workflow.job import BlockOnSeals, LevelChoices, PartChoices, require_test_for_machine
from dashpot.workflow.stiffness_under_mass import (
    LIMIT_LINES,
    RivalModes,
    StaticEquilibrium,
    family_checks,
    find_alternative_modes,
    find_static_equilibrium,
    formal_limits,
    frf_limits,
    rest_checks,
)

if TYPE_CHECKING:
    from dashpot.datamodel.relaxation import RampHold

# Geometry of the part under a mass.


def apply_part_factor(
    part: PartChoices,
    fit: Fit,
    *,
    seals: float,
    base: bool,
    peak: Callable[[Solid, float, float], float] | None = None,
) -> Fit:
    """Return the fit of one of `seals` such parts; the fit itself if no part is given.

    `peak(solid, factor, mass)` returns the resonance at the level at which the user's resonance was
    measured.

    Raises
    ------
    DataError
        If more than one geometry is given, or one that cannot be.
    """
    given_flags = [flag for flag in (*_PART_SHAPES, "resonance") if getattr(part, flag) is not None]
    if not given_flags:
        if part != PartChoices():
            raise DataError(
                "--loading, --lubricated and --resonance-mass belong to a --shape or to a "
                "--resonance; add one, or leave them out"
            )
        return fit
    if len(given_flags) > 1:
        raise DataError(
            f"--{given_flags[0]} and --{given_flags[1]} both give the geometry; leave one of them "
            "out"
        )
    if part.resonance is None:
        if part.resonance_mass is not None:
            raise DataError("--resonance-mass belongs to a --resonance; add that, or leave it")
        return fit.part(
            parse_part_shape(given_flags[0], getattr(part, given_flags[0])),
            _part_mode(part.mode),
            bonded=not part.lubricated,
        )
    factor = _part_factor(part, part.resonance, fit.solid, base=base, peak=peak)
    return fit.part(factor / seals)


def _part_factor(
    part: PartChoices,
    resonance: float,
    solid: Solid,
    *,
    base: bool,
    peak: Callable[[Solid, float, float], float] | None,
) -> float:
    """Return the geometry factor of all the parts, by the resonance of a mass on them."""
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
        for _ in range(_FACTOR_ROUNDS):
            value = peak(factor * solid, factor, part.resonance_mass)
            factor *= (resonance / value) ** 2
    return factor


_FACTOR_ROUNDS = 6
"""To a factor whose resonance at a level is the measured one: each leaves a tenth at most."""
_PART_SHAPES: dict[str, type[Disc | Block | Bush | Bulb]] = {
    "disc": Disc, "block": Block, "bush": Bush, "bulb": Bulb,
}  # fmt: skip


@overload
def parse_part_shape(flag: Literal["disc"], lengths: str | None) -> Disc: ...
@overload
def parse_part_shape(flag: Literal["block"], lengths: str | None) -> Block: ...
@overload
def parse_part_shape(flag: str, lengths: str | None) -> Geometry: ...
def parse_part_shape(flag: str, lengths: str | None) -> Geometry:
    """Return the shape that an option names, of its lengths with commas between them.

    Raises
    ------
    DataError
        If there are too few or too many, or one is no length > 0.
    """
    return find_shape(f"{flag}:{lengths}")


def _part_mode(word: str | None) -> PartMode | None:
    return next((arg for arg in get_args(PartMode) if arg == word), None)


# Predicted FRF of a mass, with peak, modes and limits.


DEFAULT_BAND = (1.0, 50.0)
"""Hz, where none is said."""


@dataclass(frozen=True)
class ResponseLimits(Serialisable):
    """Limits of the accelerance, 1/kg, or of T, over frequencies, Hz.

    Attributes
    ----------
    kind : Kind
        For a force on the mass the accelerance, from which the others follow.
    frequency : array, shape (n,)
    parameter : array, shape (2, n)
        By standard errors alone.
    bounds : FRFBounds or None
        By both kinds of ignorance, if the relaxation record is at hand.
    """

    _keys = (
        "kind",
        Key("frequency_hz", "frequency"),
        "parameter",
        Key("admissible", flatten=True, nonfinite_as_null=True),
    )

    kind: Kind
    frequency: FloatArray
    parameter: FloatArray
    bounds: FRFBounds | None

    @property
    def admissible(self) -> dict[str, Any] | None:
        """Ranges that the fitted tests do not reject."""
        bounds = self.bounds
        if bounds is None:
            return None
        peak_frequencies, height = bounds.peak_frequency, bounds.peak_height
        return {
            "unmeasured": bounds.unmeasured,
            "peak_frequency_hz": peak_frequencies,
            "peak_height": height,
        }


@dataclass(frozen=True)
class ShakenMass(Serialisable):
    """Response of a mass to random base motion, as standard deviations.

    Attributes
    ----------
    response : RandomResponse
    excitation : str
        File of the base's power spectral density, or white noise.
    band : (float, float) or None
        Band of that file, Hz.
    limits : RandomLimits or None
        If the relaxation record is at hand.
    """

    _keys = (
        Key("response", flatten=True),
        "excitation",
        Key("band_hz", "band"),
        Key("limits", optional=True, nonfinite_as_null=True),
    )

    response: RandomResponse
    excitation: str
    band: tuple[float, float] | None
    limits: RandomLimits | None


@dataclass(frozen=True, repr=False)
class Prediction(HasVerdict, Serialisable):
    """Predicted FRF of a mass on `seals` seals, with its uncertainty.

    Attributes
    ----------
    fit : Fit
        Fit of one seal, at its temperature and of its shape.
    mass, moving_mass : float
        Mass of the block, and with the seals' share, kg.
    seals : float
    frf : FRF
    modes : tuple of Mode
    peak : (float, float)
        Frequency, Hz, and height of the largest magnitude, interpolated between lines.
    is_peak_at_edge : bool
        The largest magnitude lies at an end of the band, so it is no peak.
    response_limits : ResponseLimits
    checks : tuple of Check
        Checks of the static equilibrium, of the peak against the valid band, of the fit, and of the
        mass of the seals.
    verdict : Verdict
        What to make of it.
    static_equilibrium : StaticEquilibrium
        Where the mass rests, and what secant and tangent make of it.
    alternative : RivalModes or None
    is_of_part : bool
        Whether the model is a part made of the fitted material.
    random : ShakenMass or None
        Response to random motion of the base.
    isolation : float or None
        Above it the mass moves less than its base, Hz.

    Examples
    --------
    >>> import dashpot as dp
    >>> fit = dp.fit(dp.simulate("relaxation", hold="5s", noise_free=True), arms=2)
    >>> dp.predict(fit, mass="104g", seals=2).frf.unit
    '(m/s^2)/N'
    """

    schema = "dashpot/prediction@2"
    _keys: ClassVar[tuple[str | Key, ...]] = (
        "mass",
        "moving_mass",
        "seals",
        "fit.specimen.temperature",
        Key("kind", "frf.quantity"),
        "frf.unit",
        Key("static_equilibrium.summary", flatten=True),
        Key("peak", "max_magnitudes"),
        "modes",
        "alternative",
        Key("band_hz", "fit.band"),
        Key("extrapolated", "has_extrapolated_modes"),
        Key("frequency_hz", "frf.frequency"),
        "frf.value.real",
        "frf.value.imag",
        Key("limits", "response_limits"),
        Key("random", optional=True),
        Key("isolation_hz", "isolation", optional=True),
        "verdict",
    )

    fit: Fit
    mass: float
    moving_mass: float
    seals: float
    frf: FRF
    modes: tuple[Mode, ...]
    peak: tuple[float, float]
    is_peak_at_edge: bool
    response_limits: ResponseLimits
    checks: tuple[Check, ...]
    verdict: Verdict
    static_equilibrium: StaticEquilibrium
    alternative: RivalModes | None = None
    is_of_part: bool = False
    random: ShakenMass | None = None
    isolation: float | None = None

    @property
    def facts(self) -> tuple[ReportedValue, ...]:
        """Frequency, damping ratio and residue of each mode."""
        return tuple(reported_value for mode in self.modes for reported_value in mode.facts)

    @property
    def _table_columns(self) -> Series:
        """The response over frequency."""
        return self.frf._table_columns

    @property
    def limits(self) -> FRFBounds | None:
        """Limits by both kinds of uncertainty, if the relaxation record is at hand."""
        return self.response_limits.bounds

    @property
    def interval(self) -> tuple[FloatArray, FloatArray]:
        """Lines, Hz, and limits by standard errors alone, of the accelerance, 1/kg, or of T."""
        return self.response_limits.frequency, self.response_limits.parameter

    @property
    def height_between(self) -> tuple[float, float] | None:
        """Limits of the magnitude at the peak by the errors of a fit to vibration; None of others.

        The errors include unmeasured effects of the hammer rig.
        """
        frequency, limits = self.interval
        if self.fit.method not in {"frf", "joint"} or self.is_peak_at_edge or len(frequency) < 2:
            return None
        low, high = (float(np.interp(self.peak[0], frequency, row)) for row in limits)
        return (low, high) if np.isfinite(high) and low < high else None

    @property
    def max_magnitudes(self) -> dict[str, float | bool]:
        """The largest magnitude by the names of its numbers."""
        return {
            "frequency_hz": self.peak[0],
            "value": self.peak[1],
            "at_edge": self.is_peak_at_edge,
        }

    @property
    def has_extrapolated_modes(self) -> bool:
        """Whether a mode lies outside the band that the test informs."""
        low, high = self.fit.band
        return any(not low <= mode.frequency <= high for mode in self.modes)

    @property
    def table_frf(self) -> FRF:
        """Return the FRF of a table."""
        return self.frf

    def csv(self) -> str:
        """Return the FRF as a table, marked if the test of its fit was simulated."""
        return write_frf(
            self.table_frf,
            comments=["SIMULATED: the test behind this prediction was simulated"]
            * any(source.simulated for source in self.fit.source),
        )


class PredictedLevels(Protocol):
    """Predicted response of a mass on seals at levels."""

    @property
    def checks(self) -> tuple[Check, ...]:
        """Checks of the levels."""

    def add_to_prediction(self, prediction: Prediction) -> Prediction:
        """Return the prediction with its levels."""


class LevelPredictor(Protocol):
    """Interface of the effect of levels on parts, named by a row of the registry."""

    def measured_peak(self, kind: Kind) -> Callable[[Solid, float, float], float] | None:
        """Return the resonance of a mass at the level of the user's; None by a vanishing one."""

    def predict_resonances(
        self,
        rig: MountedMass,
        part: PartChoices | None,
        *,
        scale: float,
        linear_frequency: float,
        frequency: FloatArray,
    ) -> PredictedLevels:
        """Return the resonance at each level: of `scale` parts, `linear_frequency` in Hz."""


def predict_files(
    fit: Fit,
    records: Sequence[str | Path] = (),
    *,
    block: BlockOnSeals,
    part: PartChoices | None = None,
    at_level: LevelChoices | None = None,
    machine: Machine | None = None,
    options: ReadOptions | None = None,
    **choices: Any,
) -> Prediction:
    """Predict the FRF of a mass on a fitted seal, bounded by files of the tests behind the fit.

    Parameters
    ----------
    fit : Fit
        Fit of one seal.
    records : sequence of path
        The relaxation tests behind it: they bound the unresolved arms.
    machine : Machine, optional
        Known properties of the machine of those tests.
    options : ReadOptions, optional
        What the user said of their files.
    block, part, at_level, choices
        As of :func:`prediction`.

    Raises
    ------
    DataError
        If a machine is described without a test on it, or a record is not one of the fitted ones.
    """
    require_test_for_machine(machine, tests=len(records), add="the record (--record)")
    sweep = None
    if at_level is not None and at_level != LevelChoices():
        read_sweep = require_handler("read sweep", at_level)
        sweep = read_sweep(at_level, unit=fit.unit, part=part, options=options)
    tests: tuple[RampHold, ...] = ()
    if records:
        from dashpot.workflow.bench_tests import prepared_files  # it brings every fit

        tests = prepared_files(records, machine=machine, options=options)
    return prediction(fit, tests, block=block, part=part, at_level=at_level, swept=sweep, **choices)


def prediction(
    fit: Fit,
    tests: Sequence[RampHold] = (),
    *,
    block: BlockOnSeals,
    band: tuple[float, float] | None = None,
    lines: int = 2001,
    kind: str | None = None,
    base: bool = False,
    relative: bool = False,
    temperature: float | None = None,
    part: PartChoices | None = None,
    at_level: LevelChoices | None = None,
    swept: object = None,
    base_psd: str | None = None,
) -> Prediction:
    """Predict the FRF of a mass on a fitted seal.

    Parameters
    ----------
    fit : Fit
        Fit of one seal.
    tests : sequence of RampHold
        The relaxation tests behind it: they bound the unresolved arms.
    block : BlockOnSeals
        Its mass is given.
    band : (float, float), optional
        Hz, 1 to 50 Hz by default; `lines` lines are laid over it.
    kind : str, optional
        Kind of the FRF of a force, as in :func:`~dashpot.vibration.mass_on_seals.predict_frf`.
    base, relative : bool
        The base moves, and the motion of the mass is taken relative to it.
    temperature : float, optional
        K; by default that of the fit's solid.
    part : PartChoices, optional
        The geometry of a part, where the fit is of a material's modulus.
    at_level : LevelChoices, optional
        How far the part is moved.
    swept : object, optional
        Amplitude dependence from a sweep, an object of the extension that predicts at levels.
    base_psd : str, optional
        A file, or a word such as ``"0.01g^2/Hz"``: how the base shakes at random.

    Raises
    ------
    DataError
        If the options exclude each other, or a record is not one of the fitted ones.
    """
    mass, seals = block.weighed_mass, block.seals
    SIZES["mass"].refuse(mass)
    require_positive(lines=lines)
    frf_kind = _select_frf_kind(kind, base=base or base_psd is not None, relative=relative)
    band, predictor = band or DEFAULT_BAND, _level_predictor(at_level, swept)
    moving, mass_checks = moving_mass(mass, seal=block.seal_mass or 0.0, seals=seals)
    shifted_fit = fit if temperature is None else fit.at_temperature(temperature)
    stiffer, of_part = 1.0, part is not None and part != PartChoices()
    if part is not None and of_part:
        _refuse_records(tests)
        material = shifted_fit.solid
        measured_peak = None if predictor is None else predictor.measured_peak(frf_kind)
        shifted_fit = fit = apply_part_factor(
            part, shifted_fit, seals=seals, base=frf_kind.over_base, peak=measured_peak
        )
        stiffer = float(
            abs(
                shifted_fit.solid.complex_stiffness(omega=1.0)
                / material.complex_stiffness(omega=1.0)
            )
        )
    # over a base, mounts that weigh something couple the mass to it
    coupled = compute_coupled_mass(block.seal_mass, seals) if frf_kind.over_base else 0.0
    load = MassOnSeals(moving, seals, block.compression, coupled)
    rest_state = find_static_equilibrium(shifted_fit, load)
    mounted_mass = MountedMass(shifted_fit, rest_state, load, frf_kind)
    frf = mounted_mass.frf(np.linspace(*band, lines))
    bounded = _compute_bounds(mounted_mass, fit, tests, temperature=temperature)
    limited = mounted_mass.compute_limits(frf, bounded)
    peak, at_edge = mounted_mass.peak(frf)
    around_hz = mounted_mass.modes[0].frequency if mounted_mass.modes else peak[0]
    levels = None
    if predictor is not None:
        levels = predictor.predict_resonances(
            mounted_mass, part, scale=seals * stiffer, linear_frequency=around_hz,
            frequency=frf.frequency[frf.frequency > 0],
        )  # fmt: skip
    checks = (
        # what the test must inform is the resonance, inside the band or not
        *_put_cause_first(
            mounted_mass, mass=mass, band=band, response=around_hz if at_edge else peak[0]
        ),
        *(() if levels is None else levels.checks),
        *fit.checks,
        *_check_temperature_tested(fit, temperature),
        mass_checks,
        *family_checks(shifted_fit, rest_state.point, load),
    )
    linear_prediction = Prediction(
        shifted_fit,
        mass,
        moving,
        seals,
        frf,
        mounted_mass.modes,
        peak,
        at_edge,
        limited,
        checks,
        verdict(checks, headline=_format_headline(frf, peak, fit, at_edge=at_edge)),
        rest_state,
        mounted_mass.alternative_modes,
        of_part,
        mounted_mass.predict_base_response(base_psd, bounded),
        mounted_mass.isolation,
    )
    return linear_prediction if levels is None else levels.add_to_prediction(linear_prediction)


def _level_predictor(choices: LevelChoices | None, swept: object) -> LevelPredictor | None:
    """Return the predictor of a level of excitation; None if none is given."""
    if choices is None or not choices.levels:
        return None
    predictor: LevelPredictor = require_handler("predict at levels", choices)(choices, swept)
    return predictor


def _select_frf_kind(kind: str | None, *, base: bool, relative: bool) -> Kind:
    """Return the kind of FRF of a mass: per force on it, or per motion of its base."""
    if base and kind is not None:
        raise DataError("--frf-type is of a force on the mass, --base of none: leave one out")
    if relative and not base:
        raise DataError(
            "--relative is of a mass over a base that moves: add --base (Python: base=True)"
        )
    if not base:
        return Kind.ACCELERANCE if kind is None else Kind(kind)
    return Kind.RELATIVE_TRANSMISSIBILITY if relative else Kind.TRANSMISSIBILITY


def _format_headline(frf: FRF, peak: tuple[float, float], fit: Fit, *, at_edge: bool) -> str:
    """Return where the predicted peak lies, how high it is, and where the model is valid."""
    hz, height = peak
    unit = frf.read
    height_text = f"{height:.4g}{f' {unit}' if unit != '1' else ''} at {hz:.4g} Hz"
    peak_text = (
        f"the {frf.quantity.label} is {height_text}, the end of the band"
        if at_edge
        else f"peak of the {frf.quantity.label} {height_text}"
    )
    return f"{peak_text}. The model is valid {format_band(fit.band)}"


def _refuse_records(tests: Sequence[RampHold]) -> None:
    if tests:
        raise DataError(
            "a record (--record) bounds the part that was tested, not another of its material: "
            "leave it or the geometry out"
        )


@dataclass(frozen=True)
class MountedMass:
    """Mass on fitted seals: the fit of one, and their static equilibrium."""

    fit: Fit
    equilibrium: StaticEquilibrium
    mass_on_seals: MassOnSeals
    kind: Kind

    @property
    def solid(self) -> Solid:
        """All the seals, as small vibration feels them."""
        return self.mass_on_seals.seals * self.equilibrium.point.solid(self.fit)

    @cached_property
    def modes(self) -> tuple[Mode, ...]:
        """Modes of the mass on the seals."""
        return model_modes(self.solid, self.mass_on_seals.mass)

    @property
    def isolation(self) -> float | None:
        """Above it the mass moves less than its base, Hz."""
        if self.kind is not Kind.TRANSMISSIBILITY:
            return None
        return isolation_frequency(self.solid, self.mass_on_seals.mass - self.mass_on_seals.coupled)

    def frf(self, frequency: FloatArray) -> FRF:
        """Return the FRF at some frequencies, Hz."""
        frf = predict_frf(
            self.solid, mass=self.mass_on_seals.mass, frequency=frequency, kind=self.kind
        )
        if self.mass_on_seals.coupled > 0:
            frf = add_mount_mass(
                frf, mass=self.mass_on_seals.mass, coupled=self.mass_on_seals.coupled
            )
        return frf

    def peak(self, frf: FRF) -> tuple[tuple[float, float], bool]:
        """Return frequency and height of the largest magnitude, and whether it is at an end."""
        peak_line, last_line = int(np.abs(frf.value).argmax()), len(frf.value) - 1
        low, high = (
            frf.frequency[max(peak_line - 1, 0)],
            frf.frequency[min(peak_line + 1, last_line)],
        )
        fine_frf = self.frf(np.linspace(low, high, 2001))
        height = np.abs(fine_frf.value)
        peak = float(fine_frf.frequency[height.argmax()]), float(height.max())
        return peak, peak_line in {0, last_line} and peak[0] in {low, high}

    @property
    def alternative_modes(self) -> RivalModes | None:
        """Resonance by the other family of solids that explains the test."""
        alternative = self.fit.evidence.alternative
        if alternative is None or not alternative.is_sufficient:
            return None
        return RivalModes(
            alternative.family,
            find_alternative_modes(self.fit, self.equilibrium.point, self.mass_on_seals),
        )

    def compute_limits(
        self, frf: FRF, compute_bounds: Callable[..., FRFBounds] | None
    ) -> ResponseLimits:
        """Return the limits of the response, over fewer lines."""
        kind = self.kind if self.kind.over_base else Kind.ACCELERANCE
        lines, bounds = frf.frequency[frf.frequency > 0], None
        limit_frequencies = np.linspace(lines[0], lines[-1], LIMIT_LINES)
        if compute_bounds is not None:
            limit_frequencies = np.linspace(
                max(frf.frequency[0], 1e-3), frf.frequency[-1], LIMIT_LINES
            )
            bounds = compute_bounds(frequency=limit_frequencies, kind=kind)
            limit_frequencies = bounds.frequency
        formal = formal_limits(
            self.fit,
            self.equilibrium.point,
            self.mass_on_seals,
            frequency=limit_frequencies,
            kind=kind,
        )
        return ResponseLimits(kind, limit_frequencies, formal, bounds)

    def predict_base_response(
        self, base_psd: str | None, compute_bounds: Callable[..., FRFBounds] | None
    ) -> ShakenMass | None:
        """Return the response to a random base, with its limits."""
        if base_psd is None or self.kind is not Kind.TRANSMISSIBILITY:
            return None
        shaken_mass: ShakenMass = require_handler("random base", "mass")(
            self, base_psd, compute_bounds
        )
        return shaken_mass


def _compute_bounds(
    load: MountedMass, fit: Fit, tests: Sequence[RampHold], *, temperature: float | None
) -> Callable[..., FRFBounds] | None:
    """Return the bounds of the FRF by the relaxation tests; None without tests."""
    if not tests:
        return None
    from dashpot.workflow.bench_tests import fill_missing_temperatures, refuse_unfitted_tests

    refuse_unfitted_tests(tests, fit)
    return partial(
        frf_limits,
        fit,
        fill_missing_temperatures(tests, fit),
        load.equilibrium.point,
        load.mass_on_seals,
        temperature=temperature,
    )


def _put_cause_first(
    load: MountedMass, *, mass: float, band: tuple[float, float], response: float
) -> tuple[Check, ...]:
    """Return a mass in a wrong unit first; then a solid that is not known at the peak."""
    band_checks = [prediction_in_valid_band(response, load.fit.band)]
    if load.kind.over_base:
        band_checks.append(base_band_in_valid_band(band, response, load.fit.band))
    return (*rest_checks(load.equilibrium.point, mass), *band_checks)


def _check_temperature_tested(fit: Fit, temperature: float | None) -> tuple[Check, ...]:
    """Return whether the requested temperature was tested."""
    if temperature is None or fit.temperatures is None:
        return ()
    return (temperature_tested(fit.temperatures, temperature),)
