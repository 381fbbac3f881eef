"""Stress-strain tests of a material, and the fitted hyperelastic law."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import (
    EqualByValue,
    FloatArray,
    convert_arrays_to_si,
    make_units_field,
    validate_measured_fields,
)
from dashpot.base.checks import Check
from dashpot.base.errors import DataError
from dashpot.base.number_format import format_count
from dashpot.base.provenance import Source, describe_record_source, list_sources
from dashpot.base.reported_values import HasReportedValues, ReportedValue
from dashpot.base.result_mixins import HasSummary, Plottable, Series, collect_arrays
from dashpot.base.serialisation import Key, Serialisable
from dashpot.extensions.materials.hyperelastic.strain_energy import Hyperelastic
from dashpot.extensions.materials.options import Mode
from dashpot.solids.maxwell import GeneralizedMaxwell

MIN_ROWS = 4
MAX_STRETCH = 20.0
MAX_POISSON = 0.6
"""Largest measured Poisson's ratio: 0.5, and the error of a tape or a camera."""


@dataclass(frozen=True, eq=False, repr=False)
class StressStrainTest(EqualByValue, HasSummary):
    """Nominal stress over stretch in one mode, in SI units.

    Attributes
    ----------
    mode : str
        ``"uniaxial"`` (tension and compression), ``"equibiaxial"``, ``"planar"`` or
        ``"volumetric"``.
    stretch : array, shape (n,)
        Length over length at rest in the direction of the force; the volume ratio if volumetric.
    stress : array, shape (n,)
        Force over area at rest, Pa, tension > 0; minus the pressure if volumetric.
    time : array, shape (n,), or None
        s.
    stated : bool
        Whether the file or the user stated true or nominal stress and strain; else both are assumed
        nominal.
    source : Source or None
    poisson : float or None
        Poisson's ratio that the strain sideways shows, of a uniaxial test: 0 to 0.6, where 0.5
        keeps the volume; None if not measured.
    units : str
        Units of the arrays, in their order: ``"s, mm, N"``, or ``"SI"``. Stored in SI.

    Raises
    ------
    DataError
        If the arrays differ in length, hold fewer than four samples or no stretch other than 1,
        or stretch and stress cannot be those of a test.

    Examples
    --------
    >>> import dashpot as dp, numpy as np
    >>> t = np.linspace(0, 10, 50)
    >>> test = dp.StressStrainTest("uniaxial", stretch=1 + t / 10, stress=t, units="1, MPa")
    >>> float(test.stress[-1])
    10000000.0
    """

    mode: Mode
    stretch: FloatArray
    stress: FloatArray
    time: FloatArray | None = None
    stated: bool = True
    source: Source | None = None
    poisson: float | None = None
    units: str = make_units_field()

    def __post_init__(self) -> None:
        convert_arrays_to_si(self, stretch="strain", stress="stress", time="time")
        validate_measured_fields(self, "stretch", "stress", "time", minimum=MIN_ROWS)
        if self.poisson is not None:
            self._refuse_sideways(self.poisson)
        low, high = float(self.stretch.min()), float(self.stretch.max())
        if not (low > 1 / MAX_STRETCH and high < MAX_STRETCH):
            raise DataError(
                f"the stretch runs from {low:.4g} to {high:.4g}; expected lengths over the length "
                "at rest, above 0 and 1 at rest: is it a strain, in per cent, or the other sign?"
            )
        if not (high > low and np.ptp(self.stress) > 0):
            constant_quantity = "stretch" if high == low else "stress"
            raise DataError(f"the {constant_quantity} never changes: nothing was deformed")

    def _refuse_sideways(self, ratio: float) -> None:
        if self.mode != "uniaxial":
            raise DataError(
                f"a strain sideways gives Poisson's ratio of a uniaxial test, and this one is "
                f"{self.mode}; leave it out"
            )
        if not 0 <= ratio <= MAX_POISSON:
            raise DataError(
                f"the strain sideways shows a Poisson's ratio of {ratio:.3g}; expected 0 to "
                f"{MAX_POISSON:g}. Check its unit and its sign: it grows where the specimen is "
                "pressed, and falls where it is pulled"
            )

    @property
    def _table_columns(self) -> Series:
        """Stress over stretch, and time."""
        return collect_arrays(self, stretch="1", stress="Pa", time="s")

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """The record, and its loading mode."""
        return (
            describe_record_source(self.source, len(self.stretch)),
            f"{self.mode}, stretch {self.stretch.min():.4g} to {self.stretch.max():.4g}",
        )


@dataclass(frozen=True, eq=False)
class ElasticCurve(EqualByValue):
    """Elastic curve of a test, to which a law is fitted.

    Attributes
    ----------
    mode : str
    stretch, stress : array, shape (n,)
        Stretch and stress of the chosen loading, means over neighbours where there are many;
        without relaxation where a relaxation test was given.
    rows : int
        Behind them.
    lost : float or None
        Part of the energy of the loading that the unloading does not give back; None without one.
    softer : float or None
        1 - stress of the last loading over that of the first; None for a single one.
    duration : float or None
        Duration of the loading, s.
    stated : bool
        As of the test.
    source : Source or None
    """

    mode: Mode
    stretch: FloatArray
    stress: FloatArray
    rows: int
    lost: float | None = None
    softer: float | None = None
    duration: float | None = None
    stated: bool = True
    source: Source | None = None

    @property
    def rate(self) -> float | None:
        """Mean rate of the strain of the loading, 1/s; None without a clock."""
        return float(np.ptp(self.stretch)) / self.duration if self.duration else None

    @property
    def size(self) -> float:
        """Rms of the stress, Pa."""
        return float(np.sqrt(np.mean(self.stress**2)))


Span: TypeAlias = tuple[float, float]
"""Smallest and largest stretch."""
Limits: TypeAlias = tuple[float | None, float | None]
"""Stretches below and above 1; None where there is none."""


@dataclass(frozen=True, eq=False, repr=False)
class HyperelasticFit(EqualByValue, Plottable, HasReportedValues, Serialisable):
    """Hyperelastic law, with its uncertainty.

    Attributes
    ----------
    law : Hyperelastic
    reported_values : tuple of ReportedValue
        Its constants and derived values, with their 95 % intervals.
    orders : tuple of (str, float)
        BIC of each law that was tried; the smallest is best.
    curves : tuple of ElasticCurve
    residuals : tuple of float
        Relative residual of each curve, rms over the rms of its stress.
    reach : tuple of (str, (float, float))
        Stretches of use in every mode: those measured, or as large in the other modes.
    stable : tuple of (str, (float or None, float or None))
        The first stretches below and above 1 at which the law is not stable (Drucker).
    relaxation : GeneralizedMaxwell or None
        Removed from the tests; its k_inf is 1.
    checks : tuple of Check
    temperature : float or None
        Temperature of the tests, K.

    Examples
    --------
    >>> import dashpot as dp, numpy as np
    >>> stretch = np.linspace(1, 2, 40)
    >>> stress = stretch - 1 / stretch**2
    >>> test = dp.StressStrainTest("uniaxial", stretch, stress, units="1, MPa")
    >>> dp.fit(test, model="neo-hooke").law.kind
    'neo-hooke'
    """

    schema = "dashpot/hyperelastic@2"
    _keys = (
        "verdict",
        "law",
        "orders",
        "curves",
        "residuals",
        "reach",
        "stable",
        Key("memory", "relaxation"),
        "checks",
        "temperature",
        Key("values", "reported_values"),
    )

    law: Hyperelastic
    reported_values: tuple[ReportedValue, ...]
    orders: tuple[tuple[str, float], ...]
    curves: tuple[ElasticCurve, ...]
    residuals: tuple[float, ...]
    reach: tuple[tuple[Mode, Span], ...]
    stable: tuple[tuple[Mode, Limits], ...]
    relaxation: GeneralizedMaxwell | None = None
    checks: tuple[Check, ...] = ()
    temperature: float | None = None

    @property
    def sources(self) -> tuple[Source, ...]:
        """The files behind it."""
        return list_sources(self.curves)

    @property
    def _headline(self) -> str:
        """The law, its residual, and its range of stretches."""
        stretch_ranges = [span for _, span in self.reach]
        low, high = (
            min(values[0] for values in stretch_ranges),
            max(values[1] for values in stretch_ranges),
        )
        return (
            f"the {self.law.kind} law follows {format_count(len(self.curves), 'curve')} to "
            f"{100 * max(self.residuals):.2g} % of the stress, for stretches of {low:.3g} to "
            f"{high:.3g}{self._speed}"
        )

    @property
    def loading_rate(self) -> str:
        """Strain rate of the law, as text."""
        return self._speed.partition(":")[0].removeprefix(", ")

    @property
    def _speed(self) -> str:
        """Strain rate of the law; at rest where relaxation was removed."""
        if self.relaxation is not None:
            return ", at rest, without relaxation"
        rates = [curve.rate for curve in self.curves if curve.mode != "volumetric"]
        values = [rate for rate in rates if rate is not None]
        if not values:
            return ", at an unknown rate"
        low, high = min(values), max(values)
        range_text = f"{low:.2g}" if high < 1.05 * low else f"{low:.2g} to {high:.2g}"
        return (
            f", at the rate of the tests, {range_text} 1/s: a slower or faster load has another "
            "law, and the law at rest needs a relaxation test"
        )

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """The verdict, the law and its numbers."""
        return (
            str(self.verdict),
            f"law: {self.law.kind}",
            *(reported_value.text for reported_value in self.reported_values),
        )
