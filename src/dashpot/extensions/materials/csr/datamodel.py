"""Counterforce of specimens compressed for weeks, and the fitted aging law."""

from __future__ import annotations

import math

import numpy as np

from dashpot.base import dataclass, field
from dashpot.base.arrays import (
    EqualByValue,
    FloatArray,
    IndexArray,
    convert_arrays_to_si,
    make_units_field,
    require_same_length,
    validate_measured,
)
from dashpot.base.checks import Check
from dashpot.base.errors import DataError
from dashpot.base.number_format import format_count
from dashpot.base.provenance import Source, describe_record_source
from dashpot.base.reported_values import HasReportedValues, ReportedValue
from dashpot.base.result_mixins import HasSummary, HasVerdict, Series, collect_arrays, load_function
from dashpot.base.serialisation import EVERY_FIELD, Key, Serialisable
from dashpot.base.units import Quantity, celsius, format_quantity
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.specimen import tested_at
from dashpot.extensions.materials.csr.law import AgingLaw


@dataclass(frozen=True, eq=False, repr=False)
class CSRTest(EqualByValue, HasSummary):
    """Counterforce of specimens at constant compression over hours to months.

    Attributes
    ----------
    time, force : array, shape (n,)
        Since the compression, s; of a specimen in any one unit, N or parts of F0.
    temperature : array, shape (n,)
        Temperature of the oven, K.
    specimen_number : array, shape (n,)
        Number of the specimen; by default all readings are of one.
    method : str
        ``"A"``, read in the oven, ``"B"``, read cold, or ``""`` (ISO 3384-1).
    source : Source or None
    units : str
        Units of time, force and temperature: ``"h, N, degC"``, or ``"SI"``. Stored in SI.

    Raises
    ------
    DataError
        If the arrays differ in length, a time or a force is not above 0, or a temperature is
        impossible for an oven.

    Examples
    --------
    >>> import dashpot as dp
    >>> read = dp.CSRTest([0.5, 24, 500], [40, 38, 33], [125] * 3, units="h, N, degC")
    >>> float(read.time[0])
    1800.0
    """

    time: FloatArray
    force: FloatArray
    temperature: FloatArray
    specimen_number: IndexArray = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    method: str = ""
    source: Source | None = None
    units: str = make_units_field()

    def __post_init__(self) -> None:
        convert_arrays_to_si(self, time="time", force="force", temperature="temperature")
        for name in ("time", "force", "temperature"):
            object.__setattr__(self, name, validate_measured(name, getattr(self, name)))
        specimen_number = (
            self.specimen_number if len(self.specimen_number) else np.ones(len(self.time))
        )
        object.__setattr__(self, "specimen_number", np.asarray(specimen_number, dtype=np.intp))
        require_same_length(
            time=self.time,
            force=self.force,
            temperature=self.temperature,
            specimen_number=self.specimen_number.astype(float),
        )
        for name, values in (("force", self.force), ("time", self.time)):
            if not (values > 0).all():
                raise DataError(
                    f"a {name} is {values.min():.4g}; expected numbers above 0. Count the time "
                    "from the compression, the force from zero"
                )
        tested_at("temperature", float(self.temperature.min()), float(self.temperature.max()))

    @property
    def _table_columns(self) -> Series:
        """The readings: force, in the unit of the file, over time."""
        return collect_arrays(self, time="s", force="", temperature="K", specimen_number="")

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """The record, its number of specimens and its length."""
        specimens = format_count(len(np.unique(self.specimen_number)), "specimen")
        longest = format_quantity(float(self.time.max()), "h", ".4g")
        return describe_record_source(
            self.source, len(self.time)
        ), f"{specimens}, read for {longest}"


@dataclass(frozen=True, eq=False)
class Oven(EqualByValue, Serialisable):
    """Results of the specimens of one oven.

    Attributes
    ----------
    temperature : float
        K.
    specimens : int
    rate, rate_error : float
        Rate of the chemical factor, and its standard error, 1/s.
    time, retained : array, shape (n,)
        Time and retained force of every reading, s and F/F0.
    """

    _keys = ("temperature", Key("pieces", "specimens"), EVERY_FIELD)

    temperature: float
    specimens: int
    rate: float
    rate_error: float
    time: FloatArray
    retained: FloatArray

    @property
    def significance(self) -> float:
        """The rate in its standard errors."""
        return self.rate / self.rate_error


@dataclass(frozen=True, eq=False, repr=False)
class Aging(EqualByValue, HasReportedValues, HasVerdict, Serialisable):
    """Fitted aging law, with its uncertainty.

    Attributes
    ----------
    law : AgingLaw
    ovens : tuple of Oven
        The coldest first.
    longest : float
        Time of the last reading, s.
    orders : tuple of (str, float)
        BIC of each law that was tried.
    scatter : float
        Standard deviation of a reading, in parts of F0.
    oven_sd : float
        Standard deviation of the temperature of an oven, K.
    checks : tuple of Check
    sources : tuple of Source
    """

    schema = "dashpot/csr@2"
    _keys = ("verdict", Key("values", "reported_values"), EVERY_FIELD)

    law: AgingLaw
    ovens: tuple[Oven, ...]
    longest: float
    orders: tuple[tuple[str, float], ...]
    scatter: float
    oven_sd: float
    checks: tuple[Check, ...] = ()
    sources: tuple[Source, ...] = ()

    @property
    def reported_values(self) -> tuple[ReportedValue, ...]:  # type: ignore[override]  # a field in the base, here computed from the law
        """Physical and chemical relaxation: loss in a decade, time, activation, exponent."""
        law = self.law
        (loss, chemical, activation, exponent), tau = law.errors, law.tau(law.reference)
        tau_name = f"chemical relaxation time at {celsius(law.reference)}"
        reported_values = [
            ReportedValue.from_error(
                "physical_loss", law.physical, loss, law.quantile, unit="1", read="%",
                words="physical relaxation per decade of time",
            ),
            ReportedValue("chemical_time", math.nan, tau, math.inf, "s", None, "h", tau_name)
            if law.is_lower_bound
            else ReportedValue.from_error(
                "chemical_time", tau, chemical, law.quantile, of_log=True, unit="s", read="h",
                words=tau_name,
            ),
        ]  # fmt: skip
        if law.activation:
            reported_values.append(
                ReportedValue.from_error(
                    "activation_energy", law.activation, activation, law.quantile, unit="J/mol"
                )
            )
        if law.exponent != 1:
            error = exponent * law.exponent
            reported_values.append(
                ReportedValue.from_error("exponent", law.exponent, error, law.quantile)
            )
        return tuple(reported_values)

    def age_fit(self, fit: Fit, *, temperature: Quantity, time: Quantity) -> Fit:
        """Return the fit of a seal after a time at a temperature.

        Every stiffness is times F/F0, with its error; what
        ``dashpot.extensions.materials.csr.lifetime_prediction.age_fit`` says of that holds.

        Examples
        --------
        >>> import dashpot as dp
        >>> aging = dp.fit(dp.read("ovens.csv"))  # doctest: +SKIP
        >>> new = dp.fit(dp.read("seal_8mm.csv"))  # doctest: +SKIP
        >>> aging.age_fit(new, temperature="70degC", time="1000h")  # doctest: +SKIP
        """
        new_fit: Fit = load_function("extensions.materials.csr.lifetime_prediction", "age_fit")(
            self, fit, temperature=temperature, time=time
        )
        return new_fit

    @property
    def source(self) -> Source | None:
        """The first file behind it."""
        return next(iter(self.sources), None)

    @property
    def _headline(self) -> str:
        """The activation energy, or the chemical relaxation time, and the number of ovens."""
        last = self.reported_values[-1 if self.law.activation else 1]
        hours = format_quantity(self.longest, "h", ".4g")
        return (
            f"{format_fact_clause(last)}, from {format_count(len(self.ovens), 'oven')} up to "
            f"{hours}"
        )


def format_fact_clause(reported_value: ReportedValue) -> str:
    """Return a number with its interval for a sentence."""
    cells = reported_value.cells
    if reported_value.is_lower_bound or not reported_value.has_interval:
        return f"the {reported_value.label} is {cells.value or cells.interval} {cells.unit}"
    return f"the {reported_value.label} is {cells.with_unit} ({cells.interval})"
