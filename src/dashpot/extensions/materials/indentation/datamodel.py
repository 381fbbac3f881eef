"""Dynamic indentation tests: the recorded motion of an indenter, and the fitted contact."""

from __future__ import annotations

from typing import Literal, TypeAlias

import numpy as np

from dashpot.base import dataclass
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
from dashpot.base.provenance import Source, describe_record_source
from dashpot.base.reported_values import HasReportedValues, ReportedValue
from dashpot.base.result_mixins import HasSummary, Plottable, Series, collect_arrays
from dashpot.base.serialisation import Key, Serialisable
from dashpot.base.units import Dimension
from dashpot.extensions.materials.indentation.contact_law import ContactLaw
from dashpot.extensions.materials.indentation.indenter import Indenter

Motion: TypeAlias = Literal["acceleration", "velocity", "displacement", "force"]
UNITS: dict[str, str] = {
    "acceleration": "m/s^2", "velocity": "m/s", "displacement": "m", "force": "N",
}  # fmt: skip
_DIMENSIONS: dict[str, Dimension] = {
    "acceleration": "acceleration", "velocity": "velocity", "displacement": "length",
    "force": "force",
}  # fmt: skip


@dataclass(frozen=True, eq=False, repr=False)
class IndentationTest(EqualByValue, HasSummary):
    """Motion of an indenter through one contact or several, in SI units.

    Attributes
    ----------
    time : array, shape (n,)
        s, evenly spaced.
    signal : array, shape (n,)
        In the unit of `quantity`; its sign as recorded.
    quantity : str
        ``"acceleration"``, ``"velocity"``, ``"displacement"`` or ``"force"``.
    indenter : Indenter
    force : array, shape (n,), or None
        Force recorded with a motion, N.
    source : Source or None
    units : str
        Units of the arrays, in their order: ``"s, mm, N"``, or ``"SI"``. Stored in SI.

    Raises
    ------
    DataError
        If the arrays differ in length, hold fewer than 16 samples, are not finite, or sampling is
        not even.

    Examples
    --------
    >>> import dashpot as dp, numpy as np
    >>> t = np.linspace(0, 10, 50)
    >>> from dashpot.extensions.materials.indentation.indenter import Indenter
    >>> hit = dp.IndentationTest(t, t, "velocity", Indenter("5g"), units="ms, mm/s")
    >>> float(hit.signal[-1])
    0.01
    """

    time: FloatArray
    signal: FloatArray
    quantity: Motion
    indenter: Indenter
    force: FloatArray | None = None
    source: Source | None = None
    units: str = make_units_field()

    def __post_init__(self) -> None:
        if self.quantity not in UNITS:
            raise DataError(f"quantity = '{self.quantity}'; expected one of {', '.join(UNITS)}")
        convert_arrays_to_si(self, time="time", signal=_DIMENSIONS[self.quantity], force="force")
        validate_measured_fields(self, "time", "signal", "force", minimum=16)
        steps = np.diff(self.time)
        index = int(np.argmax(np.abs(steps - self.step)))
        if abs(steps[index] - self.step) > 0.2 * self.step:
            raise DataError(
                f"a contact needs even sampling, but the step after t = {self.time[index]:.9g} s "
                f"is {steps[index]:.6g} s where {self.step:.6g} s is usual; cut the record there"
            )

    @property
    def step(self) -> float:
        """Sampling interval, s."""
        return median(np.diff(self.time))

    @property
    def _table_columns(self) -> Series:
        """The motion, and the force recorded beside it, over time."""
        return {
            **collect_arrays(self, time="s", force="N"),
            self.quantity: (self.signal, UNITS[self.quantity]),
        }

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """The record, and its channels."""
        return (
            describe_record_source(self.source, len(self.time)),
            (
                f"{self.quantity} of an indenter at {1 / self.step:.6g} Hz, to "
                f"{np.abs(self.signal).max():.4g} {UNITS[self.quantity]}"
            ),
        )


# Main results, by priority.
_CAME_FOR = ("modulus", "k")


@dataclass(frozen=True, eq=False, repr=False)
class IndentationFit(EqualByValue, Plottable, HasReportedValues, Serialisable):
    """Contact law of a surface, fitted to one contact.

    Attributes
    ----------
    law : str
        ``"kelvin-voigt"``, ``"hertz"``, ``"hertz-kelvin-voigt"`` or ``"hertz-maxwell"``.
    contact : ContactLaw
    reported_values : tuple of ReportedValue
        The law's parameters, then derived values: modulus, restitution, and the motion of the body.
    orders : tuple of (str, float)
        BIC of each law that was tried; the smallest is best.
    indenter : Indenter
    quantity : str
        Recorded quantity.
    time, measured, modelled : array, shape (n,)
        Time from first contact, s; the record around the contact, positive for a push from the
        surface, without offset and drift; and the fitted curve.
    noise : float
        Rms residual in flight, in the record's unit.
    residual : float
        Rms residual in contact over the largest value of the record.
    touch, duration : float
        Time of the first touch in the record, and length of the contact, s.
    checks : tuple of Check
    source : Source or None

    Examples
    --------
    >>> import dashpot as dp
    >>> fit = dp.fit(dp.read("hit.csv", mass="5g", radius="2.5mm"))  # doctest: +SKIP
    >>> fit.law  # doctest: +SKIP
    'hertz'
    """

    schema = "dashpot/indentation@2"
    _keys = (
        "law",
        "quantity",
        "indenter",
        Key("values", flatten=True),
        "intervals",
        "units",
        Key("orders", "scores"),
        "touch",
        "noise",
        "residual",
        "verdict",
        "checks",
        "source",
    )
    _is_loadable = False

    law: str
    contact: ContactLaw
    reported_values: tuple[ReportedValue, ...]
    orders: tuple[tuple[str, float], ...]
    indenter: Indenter
    quantity: str
    time: FloatArray
    measured: FloatArray
    modelled: FloatArray
    noise: float
    residual: float
    touch: float
    duration: float
    checks: tuple[Check, ...] = ()
    source: Source | None = None

    @property
    def values(self) -> dict[str, float]:
        """Fitted values by name."""
        return {
            reported_value.name: reported_value.value for reported_value in self.reported_values
        }

    @property
    def intervals(self) -> dict[str, tuple[float, float]]:
        """95 % intervals by name."""
        return {
            reported_value.name: (reported_value.low, reported_value.high)
            for reported_value in self.reported_values
        }

    @property
    def units(self) -> dict[str, str]:
        """Units of the values, by their names."""
        return {reported_value.name: reported_value.unit for reported_value in self.reported_values}

    @property
    def scores(self) -> dict[str, float]:
        """BIC of each fitted law."""
        return dict(self.orders)

    @property
    def _headline(self) -> str:
        """The modulus or stiffness, and the restitution."""
        values_by_name = {
            reported_value.name: reported_value for reported_value in self.reported_values
        }
        first = next(filter(None, map(values_by_name.get, _CAME_FOR)), self.reported_values[0])
        bounce = values_by_name.get("restitution")
        restitution_text = f", {bounce.label} {bounce.cells.with_unit}" if bounce else ""
        interval_text = f" ({first.cells.interval})" if first.cells.interval else ""
        return f"{first.label} {first.cells.with_unit}{interval_text}{restitution_text}"

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """The verdict, the law and its numbers."""
        return (
            str(self.verdict),
            f"law: {self.law}",
            *(reported_value.text for reported_value in self.reported_values),
        )
