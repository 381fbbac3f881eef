"""Records of blank tests, and the fit of a testing machine."""

from __future__ import annotations

import math
from typing import Literal, TypeAlias

from dashpot.base import dataclass
from dashpot.base.arrays import (
    EqualByValue,
    FloatArray,
    convert_arrays_to_si,
    make_units_field,
    validate_measured_fields,
)
from dashpot.base.checks import Check
from dashpot.base.option_fields import require_choice
from dashpot.base.provenance import Source, describe_record_source
from dashpot.base.reported_values import HasReportedValues, ReportedValue
from dashpot.base.result_mixins import HasSummary, HasVerdict, Series, collect_arrays
from dashpot.base.serialisation import EVERY_FIELD, Key, Serialisable
from dashpot.base.value_ranges import refuse_absurd_record
from dashpot.datamodel.machine import Machine, MachineCalibration

Role: TypeAlias = Literal["", "stop", "spring", "empty"]
"""Object that a blank test pressed; "" to detect it from the record."""
SPRING_ERROR = 1e-3
"""Default relative standard error of a spring's stiffness, that of a calibrated spring."""
CREEP_REPEATABILITY = 0.1
"""Relative standard deviation of creep between presses; it depends on load and rest time."""


@dataclass(frozen=True, eq=False, repr=False)
class BlankTest(EqualByValue, HasSummary):
    """Record of a testing machine without a specimen, in SI units.

    Attributes
    ----------
    time, displacement, force : array, shape (n,)
        s, m and N, sign and zero as recorded.
    role : "stop", "spring", "empty" or ""
        Object that was pressed; by default it is detected from the record.
    source : Source or None
    units : str
        Units of the arrays, in their order: ``"s, mm, N"``, or ``"SI"``. Stored in SI.

    Raises
    ------
    DataError
        If the arrays differ in length, hold fewer than 8 samples, are not finite, or time stalls.
    """

    time: FloatArray
    displacement: FloatArray
    force: FloatArray
    role: Role = ""
    source: Source | None = None
    units: str = make_units_field()

    def __post_init__(self) -> None:
        require_choice("role", self.role, Role)
        convert_arrays_to_si(self, time="time", displacement="length", force="force")
        validate_measured_fields(self, "time", "displacement", "force", minimum=8)
        refuse_absurd_record(self)

    @property
    def _table_columns(self) -> Series:
        """Displacement and force over time."""
        return collect_arrays(self, time="s", displacement="m", force="N")

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """The record, and the object that was pressed."""
        return describe_record_source(self.source, len(self.time)), ROLE_LABELS[self.role]


ROLE_LABELS: dict[str, str] = {
    "": "not said what was pressed",
    "stop": "rigid stop",
    "spring": "steel spring",
    "empty": "empty run",
}
"""Labels of blank tests by role."""


@dataclass(frozen=True, eq=False)
class BlankCurve(EqualByValue, Serialisable):
    """One record as its figure shows it.

    Attributes
    ----------
    role, file : str
    reason : str
        How the role was detected.
    time, displacement, force, fitted : array, shape (m,)
        Values of some of the samples, s, m and N; `fitted` is the force by the rig's model.
    """

    _keys = (EVERY_FIELD,)

    role: str
    file: str
    reason: str
    time: FloatArray
    displacement: FloatArray
    force: FloatArray
    fitted: FloatArray


class MachineValue(ReportedValue):
    """Property of a machine, whose document holds its standard error and display unit, too."""

    _keys = (EVERY_FIELD,)  # type: ignore[assignment]


@dataclass(frozen=True, eq=False, repr=False)
class MachineFit(EqualByValue, HasReportedValues, HasVerdict, Serialisable):
    """Testing machine by its blank tests.

    Attributes
    ----------
    reported_values : tuple of MachineValue
        Compliance, creep, gain, delay, noise, drift and hum, each with its 95 % interval.
    records : tuple of BlankCurve
    spring_stiffness, spring_error : float or None
        Stated of the spring, N/m, with its relative standard error.
    drift_sd : float or None
        Standard deviation of a future drift, N/s, estimated from the observed drifts.
    bend : float
        Departure of the stop's force from a straight line, over the largest.
    checks : tuple of Check
    sources : tuple of Source
    """

    schema = "dashpot/blank@2"
    _keys = ("verdict", Key("values", "reported_values"), EVERY_FIELD)

    reported_values: tuple[MachineValue, ...]
    records: tuple[BlankCurve, ...]
    spring_stiffness: float | None = None
    spring_error: float | None = None
    drift_sd: float | None = None
    bend: float = 0.0
    checks: tuple[Check, ...] = ()
    sources: tuple[Source, ...] = ()

    @property
    def source(self) -> Source | None:
        """The first file behind it."""
        return next(iter(self.sources), None)

    @property
    def machine(self) -> Machine:
        """The machine that fits take: ``dp.fit(test, machine=fit.machine)``."""
        reported_values = {value.name: value for value in self.reported_values}
        compliance, creep, delay, gain = (
            reported_values.get(name) for name in ("compliance", "creep", "delay", "gain")
        )
        calibration = MachineCalibration(
            delay=delay.value if delay else 0.0,
            gain=gain.value if gain else 1.0,
            gain_error=(gain.error or 0.0) if gain else 0.0,
            compliance_error=math.hypot(compliance.error or 0.0, self.bend * compliance.value)
            if compliance
            else 0.0,
            settling=creep.value if creep else 0.0,
            source=f"blank tests {', '.join(record.file for record in self.records)}",
        )
        return Machine(
            sync=delay.error if delay else None,
            drift=self.drift_sd,
            compliance=compliance.value if compliance else None,
            creep=math.hypot(creep.error or 0.0, CREEP_REPEATABILITY * creep.value)
            if creep
            else None,
            calibration=calibration,
        )

    def get_value(self, name: str) -> MachineValue | None:
        """Return one of the numbers found, by its name; None where no record gave it."""
        return next((value for value in self.reported_values if value.name == name), None)

    @property
    def _headline(self) -> str:
        """Compliance and delay with their limits."""
        entries = [self.get_value(name) for name in ("compliance", "delay", "gain", "noise")]
        text = ", ".join(
            f"{value.label} {value.cells.with_unit}" for value in entries if value is not None
        )
        return f"The machine: {text}" if text else "No property of the machine was found"
