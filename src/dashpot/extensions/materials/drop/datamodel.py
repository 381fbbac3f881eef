"""Drop tests: recorded force or acceleration of a mass that hits a specimen, and their fit."""

from __future__ import annotations

import numpy as np

from dashpot.base import dataclass, field, replace
from dashpot.base.arrays import (
    EqualByValue,
    FloatArray,
    convert_arrays_to_si,
    make_units_field,
    median,
    validate_measured_fields,
)
from dashpot.base.checks import Check
from dashpot.base.errors import DataError
from dashpot.base.number_format import format_count
from dashpot.base.provenance import Source, describe_record_source
from dashpot.base.reported_values import HasReportedValues, ReportedValue
from dashpot.base.result_mixins import HasSummary, HasVerdict, Series, collect_arrays
from dashpot.base.serialisation import Key, Serialisable
from dashpot.datamodel.fit import Fit, add_checks
from dashpot.datamodel.specimen import Specimen


@dataclass(frozen=True, eq=False, repr=False)
class DropTest(EqualByValue, HasSummary):
    """Drop test: force on a specimen, or acceleration of the mass, during one or more impacts.

    Attributes
    ----------
    time : array, shape (n,)
        s, evenly spaced.
    force, acceleration : array, shape (n,), or None
        N and m/s^2, their sign and their zero as recorded; one of them at least.
    specimen : Specimen
    source : Source or None
    units : str
        Units of the arrays, in their order: ``"ms, N"``, or ``"SI"``. Stored in SI.

    Raises
    ------
    DataError
        If both are missing, arrays differ in length, are not finite, or the sampling is uneven.

    Examples
    --------
    >>> import dashpot as dp, numpy as np
    >>> t = np.linspace(0, 50, 500)
    >>> test = dp.DropTest(t, force=np.sin(np.pi * t / 50), units="ms, N")
    >>> round(float(test.time[-1]), 3)
    0.05
    """

    time: FloatArray
    force: FloatArray | None = None
    acceleration: FloatArray | None = None
    specimen: Specimen = field(default_factory=Specimen)
    source: Source | None = None
    units: str = make_units_field()

    def __post_init__(self) -> None:
        convert_arrays_to_si(self, time="time", force="force", acceleration="acceleration")
        validate_measured_fields(self, "time", "force", "acceleration", minimum=16)
        if self.force is None and self.acceleration is None:
            raise DataError(
                "an impact is a force, or the acceleration of the mass. Give one of them"
            )
        steps = np.diff(self.time)
        index = int(np.argmax(np.abs(steps - self.step)))
        if abs(steps[index] - self.step) > 0.2 * self.step:
            raise DataError(
                f"an impact needs even sampling, and the step after t = {self.time[index]:.9g} s "
                f"is {steps[index]:.6g} s where {self.step:.6g} s is usual. Cut the record there"
            )

    @property
    def step(self) -> float:
        """Sampling interval, s."""
        return median(np.diff(self.time))

    @property
    def _table_columns(self) -> Series:
        """Force and acceleration over time."""
        return collect_arrays(self, time="s", force="N", acceleration="m/s^2")

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """The record, and its channels."""
        signals = {"force": self.force, "acceleration": self.acceleration}
        names_text = " and ".join(name for name, values in signals.items() if values is not None)
        return describe_record_source(
            self.source, len(self.time)
        ), f"{names_text} at {1 / self.step:.6g} Hz"


@dataclass(frozen=True, eq=False)
class DropImpact(EqualByValue, Serialisable):
    """One impact of a fitted drop test.

    Attributes
    ----------
    name : str
        Name made of its file, and its number there.
    speed : ReportedValue
        Impact speed, m/s.
    peak, compression, contact, rebound, lost_part : float
        Largest force, N, and compression, m; time in contact, s; release speed over impact speed,
        and absorbed part of the kinetic energy.
    time, measured, modelled : array, shape (n,)
        s from first contact, and N.
    """

    _keys = (
        "name",
        "speed",
        "peak",
        "compression",
        "contact",
        "rebound",
        Key("lost_fraction", "lost_part"),
    )

    name: str
    speed: ReportedValue
    peak: float
    compression: float
    contact: float
    rebound: float
    lost_part: float
    time: FloatArray
    measured: FloatArray
    modelled: FloatArray


@dataclass(frozen=True, eq=False, repr=False)
class DropFit(EqualByValue, HasReportedValues, HasVerdict, Serialisable):
    """Fit of drop tests: loss factor and fast arm of a specimen.

    Attributes
    ----------
    frequency : float
        Frequency of the loss factor, Hz: a contact is half a cycle.
    reported_values : tuple of ReportedValue
        The loss factor, and the arm.
    hits : tuple of DropImpact
    mass : float
        kg.
    fit : Fit
        Model of the specimen: elastic law, arms of the relaxation test, and the fast arm.
    checks : tuple of Check
    sources : tuple of Source
    """

    schema = "dashpot/slam@2"
    _keys = (
        "verdict",
        "frequency",
        Key("values", "reported_values"),
        "mass",
        "hits",
        "checks",
        "sources",
        "fit",
    )
    _is_loadable = False

    frequency: float
    reported_values: tuple[ReportedValue, ...]
    hits: tuple[DropImpact, ...]
    mass: float
    fit: Fit
    checks: tuple[Check, ...] = ()
    sources: tuple[Source, ...] = ()

    @property
    def _saved_result(self) -> Fit:
        """The fit with every check that decided the verdict."""
        return add_checks(self.fit, self.checks)

    @property
    def source(self) -> Source | None:
        """The first file behind it."""
        return next(iter(self.sources), None)

    @property
    def facts(self) -> tuple[ReportedValue, ...]:
        """Fitted values, and of every impact its speed, peak force, contact and rebound."""
        return (
            *self.reported_values,
            *(
                reported_value
                for hit in self.hits
                for reported_value in _make_impact_facts(hit, len(self.hits))
            ),
        )

    @property
    def _headline(self) -> str:
        """The loss factor, and the number of impacts."""
        loss = self.reported_values[0].cells
        interval_text = f" ({loss.interval})" if loss.interval else ""
        return (
            f"the loss factor at {self.frequency:.3g} Hz is {loss.with_error}{interval_text}, from "
            f"{format_count(len(self.hits), 'impact')}"
        )


def _make_impact_facts(impact: DropImpact, impact_count: int) -> tuple[ReportedValue, ...]:
    """Return the numbers of an impact as reported values."""
    words = f"{impact.name}: " if impact_count > 1 else ""
    return (
        replace(impact.speed, words=f"{words}speed"),
        ReportedValue("peak_force", impact.peak, unit="N", words=f"{words}peak force"),
        ReportedValue("contact", impact.contact, unit="s", read="ms", words=f"{words}contact time"),
        ReportedValue(
            "rebound", impact.rebound, unit="1", read="%", words=f"{words}rebound over impact speed"
        ),
        ReportedValue(
            "lost_part", impact.lost_part, unit="1", read="%", words=f"{words}energy absorbed"
        ),
    )
