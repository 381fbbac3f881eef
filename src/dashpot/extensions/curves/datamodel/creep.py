"""Creep tests, raw and prepared, and the creep compliance."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeAlias

import numpy as np

from dashpot.base import dataclass, field, replace
from dashpot.base.arrays import (
    Dimensions,
    EqualByValue,
    FloatArray,
    convert_arrays_to_si,
    make_units_field,
    median,
    resolve_unit,
    validate_measured_fields,
)
from dashpot.base.checks import Check
from dashpot.base.errors import DataError
from dashpot.base.provenance import Source, Step, describe_record_source
from dashpot.base.result_mixins import HasSummary, Series, collect_arrays
from dashpot.base.serialisation import Serialisable
from dashpot.base.units import Dimension, Quantity, convert_to_si, format_quantity
from dashpot.base.value_ranges import refuse_absurd_record, require_positive
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.curves.datamodel.sample_temperatures import (
    describe_step_response,
    has_several_temperatures,
    select_temperature,
    validate_step_response,
)

MAX_CORNERS = 16
"""Largest number of corners of a load of ramps and holds."""
COMPLIANCES = {"N/m": "m/N", "Pa": "1/Pa"}
_ARE = {"N/m": ("m", "N"), "Pa": ("1", "Pa")}
"""Units of displacement and force, by the unit of the stiffness."""
"""Unit of the compliance by that of the stiffness."""


@dataclass(frozen=True, eq=False, repr=False)
class CreepTest(EqualByValue, HasSummary, Serialisable):
    """Creep test as recorded, in SI units: force held, displacement measured.

    Attributes
    ----------
    time : array, shape (n,)
        s, strictly increasing; any sampling.
    displacement : array, shape (n,)
        m, sign and zero as recorded; of a material (`unit` Pa) the strain.
    force : array, shape (n,)
        N, sign and zero as recorded; of a material the stress, Pa.
    unit : str
        Unit of the stiffness, force over displacement: ``"N/m"`` or ``"Pa"``.
    specimen : Specimen
    source : Source or None
        The file it came from; None for arrays made in memory.
    units : str
        Units of the arrays, in their order: ``"s, mm, N"``, or ``"SI"``. Stored in SI.

    Raises
    ------
    DataError
        If the arrays differ in length, hold fewer than 8 samples, are not finite, or time stalls.

    Examples
    --------
    >>> import dashpot as dp, numpy as np
    >>> t = np.linspace(0, 10, 50)
    >>> dp.CreepTest(time=t, displacement=t, force=1 + 0 * t, units="s, mm, N").unit
    'N/m'
    """

    schema = "dashpot/creep-test@1"

    time: FloatArray
    displacement: FloatArray
    force: FloatArray
    unit: str = "N/m"
    specimen: Specimen = field(default_factory=Specimen)
    source: Source | None = None
    units: str = make_units_field()

    def __post_init__(self) -> None:
        arrays = convert_arrays_to_si(
            self, time="time", displacement=("length", "strain"), force=("force", "stress")
        )
        if arrays:
            object.__setattr__(
                self, "unit", _determine_stiffness_unit(arrays["displacement"], arrays["force"])
            )
        validate_measured_fields(self, "time", "displacement", "force", minimum=8)
        _require_unit(self.unit, COMPLIANCES)
        if self.unit == "N/m":
            refuse_absurd_record(self)

    @property
    def _table_columns(self) -> Series:
        """Displacement and force, or strain and stress, over time."""
        motion_quantity, load_quantity = _ARE[self.unit]
        return collect_arrays(self, time="s", displacement=motion_quantity, force=load_quantity)

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """Summary: the record and its range."""
        change, force_range = float(np.ptp(self.displacement)), float(np.ptp(self.force))
        return (
            describe_record_source(self.source, len(self.time)),
            f"{np.ptp(self.time):.5g} s; {_format_spans(change, force_range, self.unit)}",
        )


@dataclass(frozen=True, eq=False, repr=False)
class CreepCompliance(EqualByValue, HasSummary, Serialisable):
    r"""Creep compliance :math:`J(t)`, measured or superposed, after a force step at t = 0.

    Attributes
    ----------
    time : array, shape (n,)
        s since the step, >= 0, strictly increasing; at several temperatures in any order.
    compliance : array, shape (n,)
        1/Pa for a material, m/N for a part (`unit`).
    unit : str
        ``"1/Pa"`` or ``"m/N"``.
    specimen : Specimen
    source : Source or None
    temperature : array, shape (n,), or None
        K, where the curve was measured at several; to be shifted together.
    units : str
        Units of the arrays, in their order: ``"s, mm, N"``, or ``"SI"``. Stored in SI.

    Raises
    ------
    DataError
        If the arrays differ in length, are not finite, or time falls or starts below 0.

    Examples
    --------
    >>> import dashpot as dp, numpy as np
    >>> t = np.linspace(0, 10, 50)
    >>> dp.CreepCompliance(time=t, compliance=1 + t, units="s, 1/MPa").unit
    '1/Pa'
    """

    schema = "dashpot/creep-compliance@1"

    time: FloatArray
    compliance: FloatArray
    unit: str = "1/Pa"
    specimen: Specimen = field(default_factory=Specimen)
    source: Source | None = None
    temperature: FloatArray | None = None
    units: str = make_units_field()

    def __post_init__(self) -> None:
        dimensions: Dimensions = ("material compliance", "compliance")
        arrays = convert_arrays_to_si(
            self, time="time", compliance=dimensions, temperature="temperature"
        )
        resolve_unit(self, arrays, "compliance")
        validate_step_response(self, "compliance")
        _require_unit(self.unit, COMPLIANCES.values())

    def select_temperature(self, temperature: Quantity) -> CreepCompliance:
        """Return the samples within a kelvin of a temperature, K, in order of time.

        Raises
        ------
        DataError
            If there are none, or two at the same time.
        """
        return select_temperature(self, "compliance", convert_to_si(temperature, "temperature"))

    @property
    def several_temperatures(self) -> bool:
        """Whether the samples differ too much in temperature for one solid."""
        return has_several_temperatures(self.temperature)

    @property
    def stiffness_unit(self) -> str:
        """Unit of the inverse: ``"Pa"`` or ``"N/m"``."""
        return next(
            stiffness for stiffness, compliance in COMPLIANCES.items() if compliance == self.unit
        )

    @property
    def _table_columns(self) -> Series:
        """Compliance over time."""
        return collect_arrays(self, time="s", compliance=self.unit)

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """Summary: the curve and its range."""
        return describe_step_response(self, "compliance")


@dataclass(frozen=True, eq=False, repr=False)
class LoadHold(EqualByValue, HasSummary, Serialisable):
    """Prepared creep test: load and displacement relative to the state before loading.

    Attributes
    ----------
    time : array, shape (n,)
        s, as recorded.
    displacement : array, shape (n,)
        m, positive the way the load pushes; its zero is the recorded one. A strain if `unit` is Pa.
    force : array, shape (n,)
        N beyond `preload`, as read; a stress, Pa, if `unit` is Pa.
    load : array, shape (n,)
        The same freed of the load cell's noise: the input that the fit answers.
    onset, ramp_end, hold_end : float
        When the load begins to rise, is reached and is left, s; onset and ramp_end are one where
        the record begins under load.
    level : float
        The load held, N, > 0.
    preload : float
        The force before, N, positive the way the load pushes.
    displacement_noise, force_noise : float
        Standard deviation of the scatter from sample to sample.
    unit : str
        Unit of the stiffness: ``"N/m"`` or ``"Pa"``.
    specimen : Specimen
    source : Source or None
    steps : tuple of Step
    checks : tuple of Check
    corners : tuple of float
        Times, s, between which `load` is straight, both ends included; none if it is not.
    heights : tuple of float
        The load at the corners, N.
    machine : Machine
        Known properties of the testing machine.
    lead : float
        By how much `load` comes before `force`, s: 0 as recorded.
    """

    schema = "dashpot/load-hold@2"

    time: FloatArray
    displacement: FloatArray
    force: FloatArray
    load: FloatArray
    onset: float
    ramp_end: float
    hold_end: float
    level: float
    preload: float = 0.0
    displacement_noise: float = 0.0
    force_noise: float = 0.0
    unit: str = "N/m"
    specimen: Specimen = field(default_factory=Specimen)
    source: Source | None = None
    steps: tuple[Step, ...] = ()
    checks: tuple[Check, ...] = ()
    corners: tuple[float, ...] = ()
    heights: tuple[float, ...] = ()
    machine: Machine = field(default_factory=Machine)
    lead: float = 0.0

    def __post_init__(self) -> None:
        validate_measured_fields(self, "time", "displacement", "force", "load", minimum=8)
        if not self.onset <= self.ramp_end < self.hold_end:
            raise DataError(
                f"the load must rise and be held in that order, found onset {self.onset:g} s, "
                f"ramp end {self.ramp_end:g} s, hold end {self.hold_end:g} s"
            )
        require_positive(level=self.level, expected="a load > 0")
        _require_unit(self.unit, COMPLIANCES)

    @property
    def _table_columns(self) -> Series:
        """Displacement and force over time, and the load without noise."""
        motion_quantity, load_quantity = _ARE[self.unit]
        return collect_arrays(
            self, time="s", displacement=motion_quantity, force=load_quantity, load=load_quantity
        )

    @property
    def step(self) -> float:
        """Median time step, s."""
        return median(np.diff(self.time))

    def with_load_earlier(self, by: float) -> LoadHold:
        """Return the record with its load so much earlier, s, as of a force that was recorded late.

        A record that begins under its load has no moment that a delay moves, and stays.
        """
        if self.onset <= self.time[0]:
            return self
        first = float(self.time[0])
        times = (max(value - by, first) for value in (self.onset, self.ramp_end, self.hold_end))
        onset, ramp_end, hold_end = times
        # what a straight line has between readings stands at its corners
        corner_times, heights = np.array(self.corners), np.array(self.heights)
        if not len(heights):
            corner_times, heights = self.time, self.load
        corners = np.clip(np.array(self.corners) - by, first, self.time[-1])
        return replace(
            self,
            load=np.interp(self.time + by, corner_times, heights),
            onset=onset,
            ramp_end=ramp_end,
            hold_end=hold_end,
            corners=tuple(corners.tolist()),
            lead=self.lead + by,
        )

    @property
    def ramp_time(self) -> float:
        """Time in which the load rises, s; 0 for a step."""
        return self.ramp_end - self.onset

    @property
    def hold_time(self) -> float:
        """Duration of the hold, s."""
        return self.hold_end - self.ramp_end

    @property
    def hold(self) -> slice:
        """The samples of the hold, ramp end included."""
        start, stop = np.searchsorted(self.time, [self.ramp_end, self.hold_end]).tolist()
        return slice(start, min(stop + 1, len(self.time)))

    @property
    def resolution(self) -> float:
        """The shortest time between corners of a load that is not straight, s; 0 if it is."""
        has_many_corners = len(self.corners) > MAX_CORNERS
        return float(np.diff(self.corners).min()) if has_many_corners else 0.0

    @property
    def has_recovery(self) -> bool:
        """True if the record goes on after the load was left: a recovery."""
        return bool(self.hold.stop < len(self.time))

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """Summary: the record, its load and hold, and the notes of preparation."""
        failed = (f"  {check.name}: {check.message}" for check in self.checks if check.failed)
        return (
            describe_record_source(self.source, len(self.time)),
            (
                f"load of {self.level:.4g} {'N' if self.unit == 'N/m' else 'Pa'} in "
                f"{self.ramp_time:.4g} s from {self.onset:.5g} s, held {self.hold_time:.5g} s"
            ),
            *failed,
        )


Creep: TypeAlias = CreepTest | LoadHold | CreepCompliance
"""Record of creep that can be fitted."""


def _determine_stiffness_unit(motion_dimension: Dimension, load_dimension: Dimension) -> str:
    """Return the unit of a stiffness from those of motion and force."""
    pairs = {("length", "force"): "N/m", ("strain", "stress"): "Pa"}
    if (motion_dimension, load_dimension) not in pairs:
        raise DataError(
            f"CreepTest: a {motion_dimension} under a {load_dimension} is of neither a part nor a "
            "material. Give a displacement and a force, or a strain and a stress"
        )
    return pairs[motion_dimension, load_dimension]


def _require_unit(unit: str, names: Iterable[str]) -> None:
    words = tuple(names)
    if unit not in words:
        raise DataError(f"unit = {unit!r}; expected {' or '.join(map(repr, words))}")


def _format_spans(change: float, stress_range: float, unit: str) -> str:
    if unit == "Pa":
        return f"strain spans {change:.4g}, stress {stress_range:.4g} Pa"
    return f"displacement spans {format_quantity(change, 'mm')}, force {stress_range:.4g} N"
