"""Compression load deflection (CLD) tests, as recorded and as cycles."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from dashpot.base import dataclass, field
from dashpot.base.arrays import (
    EqualByValue,
    FloatArray,
    convert_arrays_to_si,
    make_units_field,
    validate_measured_fields,
)
from dashpot.base.checks import Check, HasChecks
from dashpot.base.provenance import Source, describe_record_source
from dashpot.base.reported_values import ReportedValue
from dashpot.base.result_mixins import HasSummary, Plottable, Series, collect_arrays
from dashpot.base.serialisation import EVERY_FIELD, Key, Serialisable
from dashpot.base.units import format_quantity
from dashpot.base.value_ranges import refuse_absurd_record
from dashpot.datamodel.specimen import Specimen
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.maxwell import GeneralizedMaxwell

QUOTED_LENGTH = 0.1
"""Length of seal that a force is quoted for, m."""

SAME_SPEED = 1.5
"""Factor within which two speeds are one."""


class TangentTable(NamedTuple):
    """Table of an elastic law: its kind, compressions, m, and tangent stiffnesses, N/m."""

    kind: str
    knots: tuple[float, ...]
    tangent: FloatArray


@dataclass(frozen=True, eq=False, repr=False)
class CLDTest(EqualByValue, HasSummary):
    """Compression load deflection test as recorded, in SI units.

    Attributes
    ----------
    displacement, force : array, shape (n,)
        m and N in the order of recording, sign and zero as recorded.
    time : array, shape (n,), or None
        s, strictly increasing; None where the file has no clock.
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
    >>> test = dp.CLDTest(displacement=t, force=t**2, units="mm, N")
    >>> float(test.displacement[-1])
    0.01
    """

    displacement: FloatArray
    force: FloatArray
    time: FloatArray | None = None
    specimen: Specimen = field(default_factory=Specimen)
    source: Source | None = None
    units: str = make_units_field()

    def __post_init__(self) -> None:
        convert_arrays_to_si(self, displacement="length", force="force", time="time")
        validate_measured_fields(self, "time", "displacement", "force", minimum=8)
        refuse_absurd_record(self)

    @property
    def _table_columns(self) -> Series:
        """Force over displacement, and time."""
        return collect_arrays(self, displacement="m", force="N", time="s")

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """Summary: the record and its range."""
        return (
            describe_record_source(self.source, len(self.force)),
            (
                f"displacement spans {format_quantity(np.ptp(self.displacement), 'mm')}, force "
                f"{np.ptp(self.force):.4g} N" + ", no clock" * (self.time is None)
            ),
        )


@dataclass(frozen=True, eq=False)
class Branch(EqualByValue):
    """Branch of a cycle, loading or unloading, in the order of recording.

    Attributes
    ----------
    compression : array, shape (n,)
        From first contact of the first cycle, m; below 0 is air.
    force : array, shape (n,)
        Compressive, tared, N.
    first : int
        Its first sample in the record.
    """

    compression: FloatArray
    force: FloatArray
    first: int

    @property
    def samples(self) -> slice:
        """Samples of the record."""
        return slice(self.first, self.first + len(self.force))

    def work(self, depth: float = np.inf) -> float:
        r"""Work on the seal from contact to a depth, m: :math:`\int F\,dx` along the path, J."""
        x = np.clip(self.compression, 0.0, depth)
        return float(np.trapezoid(self.force, x))


@dataclass(frozen=True, eq=False)
class Cycle(EqualByValue, Serialisable):
    """Cycle: one loading and, where recorded, the unloading after it.

    Attributes
    ----------
    number : int
        In the record, from 1.
    depth : float
        Greatest compression, m.
    speed : float or None
        Speed of the loading, m/s; None without a clock.
    contact : float or None
        Compression at which the loading met the seal again, m: the set by the earlier cycles. 0 of
        the first cycle; None if the plate never moved through air.
    peak : float
        Force at `depth`, N.
    common : float
        Force on loading at the compression that every cycle reaches, N.
    loading : Branch
    unloading : Branch or None
    hysteresis_se : float or None
        Standard error of `hysteresis`: by noise, the zero and a delay of the force.
    """

    _keys = (
        "number",
        "depth",
        "speed",
        "contact",
        "peak",
        "energy",
        Key("returned", "recovered_energy"),
        "hysteresis",
        "hysteresis_se",
    )

    number: int
    depth: float
    speed: float | None
    contact: float | None
    peak: float
    common: float
    loading: Branch
    unloading: Branch | None
    hysteresis_se: float | None = None

    @property
    def energy(self) -> float:
        """Energy put in by the loading, J."""
        return self.loading.work()

    @property
    def recovered_energy(self) -> float | None:
        """Given back by the unloading, J."""
        return None if self.unloading is None else -self.unloading.work()

    @property
    def hysteresis(self) -> float | None:
        """Fraction of the energy that was dissipated."""
        returned = self.recovered_energy
        return None if returned is None else 1 - returned / self.energy


def format_hysteresis(cycle: Cycle) -> str:
    """Return the hysteresis of a cycle in words, with its error where a delay makes one."""
    loss_ratio, error = cycle.hysteresis, cycle.hysteresis_se
    if loss_ratio is None:
        return ""
    return (
        ReportedValue.from_error("", loss_ratio, error or None, unit="1", read="%").cells.with_error
        + " %"
    )


@dataclass(frozen=True)
class CompressionValues(Serialisable):
    """Values of a cycle at one compression.

    Attributes
    ----------
    compression : float
        m.
    loading, loading_se : float
        Force on loading and its standard error, N.
    unloading : float or None
        Force on unloading, N.
    slope, slope_se : float
        Slope and its standard error of the loading curve, N/m.
    energy : float
        Put in up to here, J.
    unloading_se : float or None
        Standard error of `unloading`, N.
    """

    _keys = (EVERY_FIELD, "secant", "hysteresis")

    compression: float
    loading: float
    loading_se: float
    unloading: float | None
    slope: float
    slope_se: float
    energy: float
    unloading_se: float | None = None

    @property
    def secant(self) -> float:
        """Force on loading over compression, N/m."""
        return self.loading / self.compression

    @property
    def hysteresis(self) -> float | None:
        """Part of the force that is missing on the way back."""
        return None if self.unloading is None else 1 - self.unloading / self.loading


@dataclass(frozen=True)
class ScaledCompressionValues(Serialisable):
    """Values of a cycle at one compression, also of 100 mm, where the length is known."""

    _keys = (Key("values", flatten=True), Key("per_100mm", optional=True))

    values: CompressionValues
    cld: CLD

    @property
    def per_100mm(self) -> dict[str, float | None] | None:
        """Forces, N, slope, N/m, and energy, J, of 100 mm."""
        if self.cld.specimen.length is None:
            return None
        names = ("loading", "loading_se", "unloading", "slope", "energy")
        entries = {name: getattr(self.values, name) for name in names}
        return {
            name: None if entry is None else self.cld.per * entry for name, entry in entries.items()
        }


@dataclass(frozen=True, eq=False, repr=False)
class CLD(EqualByValue, Plottable, HasChecks, Serialisable):
    """Compression load deflection test as cycles, with the values of one of them.

    Made by :func:`dashpot.extensions.materials.cld.preprocess.cld`.

    Attributes
    ----------
    cycles : tuple of Cycle
    index : int
        Index in `cycles` of the evaluated cycle.
    contact, contact_se : float
        Where the plate first met the seal, on the scale of the record, and its standard error, m.
    zero_se : float
        Standard error of the load cell's zero, N.
    preload : float
        Force at the first sample where the record begins in contact under a load, N; else 0.
    drift : float
        Change of the load cell's zero over the record, N, taken off; 0 if it is not visible in air.
    noise : float
        Scatter of the force from sample to sample, N.
    common : float
        Compression at which cycles are compared, m.
    nominal : CompressionValues
    least, most : CompressionValues or None
        At the limits of the tolerance, where requested and reached.
    time : array, shape (n,), or None
        Duration of the whole record, s; None without a clock.
    compression, force : array, shape (n,)
        Compression and force of the whole record, zeroed, m and N.
    checks : tuple of Check
    specimen : Specimen
    source : Source or None
    delay_sd : float
        Standard deviation of the delay of the force, s, or in samples without a clock.
    """

    _keys = (
        "source.file",
        "source.sha256",
        "specimen.length",
        "specimen",
        "contact",
        "contact_se",
        "preload",
        "drift",
        "delay_sd",
        Key("cycle", "cycle.number"),
        "softening",
        "set",
        Key("least", "scaled_least"),
        Key("nominal", "scaled_nominal"),
        Key("most", "scaled_most"),
        "cycles",
        "checks",
    )

    cycles: tuple[Cycle, ...]
    index: int
    contact: float
    contact_se: float
    zero_se: float
    preload: float
    drift: float
    noise: float
    common: float
    nominal: CompressionValues
    least: CompressionValues | None
    most: CompressionValues | None
    time: FloatArray | None
    compression: FloatArray
    force: FloatArray
    checks: tuple[Check, ...] = ()
    specimen: Specimen = field(default_factory=Specimen)
    source: Source | None = None
    delay_sd: float = 0.0

    @property
    def cycle(self) -> Cycle:
        """The evaluated cycle."""
        return self.cycles[self.index]

    @property
    def loading(self) -> Branch:
        """Loading branch."""
        return self.cycle.loading

    @property
    def unloading(self) -> Branch | None:
        """Unloading branch."""
        return self.cycle.unloading

    @property
    def contact_delay_error(self) -> float:
        """Compression that the first contact gains by a delay of one `delay_sd`, m."""
        return self.delay_sd * (self.cycle.speed or 0.0)

    @property
    def limit_marks(self) -> tuple[CompressionValues, ...]:
        """Least, nominal and most, as far as they are known."""
        return tuple(point for point in (self.least, self.nominal, self.most) if point is not None)

    @property
    def scaled_least(self) -> ScaledCompressionValues | None:
        """`least`, and of 100 mm."""
        return None if self.least is None else ScaledCompressionValues(self.least, self)

    @property
    def scaled_nominal(self) -> ScaledCompressionValues:
        """`nominal`, and of 100 mm."""
        return ScaledCompressionValues(self.nominal, self)

    @property
    def scaled_most(self) -> ScaledCompressionValues | None:
        """`most`, and of 100 mm."""
        return None if self.most is None else ScaledCompressionValues(self.most, self)

    @property
    def per(self) -> float:
        """Factor from a force, N, to N per 100 mm; 1 if no length is known."""
        return 1.0 if self.specimen.length is None else QUOTED_LENGTH / self.specimen.length

    @property
    def unit(self) -> str:
        """Unit of a force times `per`."""
        return "N" if self.specimen.length is None else "N per 100 mm"

    @property
    def softening(self) -> float:
        """Part of the first cycle's force that is missing in the last, at `common`."""
        return 1 - self.cycles[-1].common / self.cycles[0].common

    @property
    def set(self) -> float | None:
        """Compression at which the last cycle that crossed air met the seal again, m."""
        contacts = [cycle.contact for cycle in self.cycles[1:] if cycle.contact is not None]
        return contacts[-1] if contacts else None

    @property
    def _table_columns(self) -> Series:
        """Force over compression, and time."""
        return collect_arrays(self, compression="m", force="N", time="s")

    @property
    def _headline(self) -> str:
        """The force at the nominal compression."""
        point = self.nominal
        force = self.per * point.loading
        return f"{force:.3g} {self.unit} at {format_quantity(point.compression, 'mm', '.3g')}"

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """The verdict, the force at the nominal compression, and the evaluated cycle."""
        point, cycle = self.nominal, self.cycle
        loss_ratio = cycle.hysteresis
        return (
            str(self.verdict),
            (
                f"{self.per * point.loading:.4g} {self.unit} at "
                f"{format_quantity(point.compression, 'mm')}, "
                f"slope {format_quantity(self.per * point.slope, 'N/mm', '.3g')}"
                + " per 100 mm"
                * (self.specimen.length is not None)
            ),
            (
                f"cycle {cycle.number} of {len(self.cycles)}, to "
                f"{format_quantity(cycle.depth, 'mm')}"
                + ("" if loss_ratio is None else f", hysteresis {format_hysteresis(cycle)}")
            ),
            *(check.message_with_remedy for check in self.checks if check.failed),
        )


@dataclass(frozen=True)
class RelaxedLaw(Serialisable):
    """Elastic law of a cycle that was driven at a finite speed.

    Made by :func:`dashpot.extensions.materials.cld.equilibrium_curve.fit_relaxed_law`.

    Attributes
    ----------
    law : ElasticLaw
        Relaxed force against compression, to the depth of the cycle.
    relaxation : GeneralizedMaxwell
        The relaxation function that was removed, with k_inf = 1: its k are parts of the relaxed
        force.
    residual : float
        Rms residual of the relaxed loading and unloading, N.
    hysteresis, residual_hysteresis : float
        Part of the energy that the cycle lost, and that its relaxed forces still lose: friction.
    softening : float
        Part of the first cycle's relaxed force that is missing in the last, at ``CLD.common``.
    checks : tuple of Check
    perturbed_laws : tuple of ElasticLaw
        The elastic law with one of its inputs changed by a standard error: the relaxation function,
        along each axis of its covariance, first contact, and the zero of the force.
    """

    _keys = (
        Key("elastic_law", "tangent_table"),
        Key("force_se", "knot_se"),
        "residual",
        "hysteresis",
        "residual_hysteresis",
        "softening",
    )

    law: ElasticLaw
    relaxation: GeneralizedMaxwell
    residual: float
    hysteresis: float | None
    residual_hysteresis: float | None
    softening: float
    checks: tuple[Check, ...] = ()
    perturbed_laws: tuple[ElasticLaw, ...] = ()

    @property
    def tangent_table(self) -> TangentTable:
        """The elastic law by its tangent stiffness at the knots."""
        return TangentTable(self.law.kind, self.law.knots, self.law.tangents)

    @property
    def knot_se(self) -> tuple[float, ...]:
        """Standard error of the relaxed force at the knots, N."""
        return tuple(map(self.force_se, self.law.knots))

    def force_se(self, x: float) -> float:
        """Standard error of the relaxed force at a compression, m, from relaxation and zeros, N."""
        force_errors = [
            float(other.force(x)) - float(self.law.force(x)) for other in self.perturbed_laws
        ]
        return float(np.linalg.norm(force_errors)) if force_errors else 0.0


class RateArm(NamedTuple):
    """Maxwell arm: stiffness, N/m, and relaxation time, s, with their errors."""

    k: float
    tau: float
    k_se: float
    ln_tau_se: float


@dataclass(frozen=True, eq=False)
class RateLaw(EqualByValue, Serialisable):
    r"""Spring and dashpot that depend on compression, with parallel Maxwell arms.

    .. math:: F = F_e(x) + c(x)\,\dot x + \sum_j k_j \int_0^t e^{-(t-u)/\tau_j}\,dx(u)

    Made by :func:`dashpot.extensions.materials.cld.rate_dependence.fit_rate`.

    Attributes
    ----------
    law : ElasticLaw
        :math:`F_e`.
    knots : tuple of float
        Compressions, m, between which c is a straight line.
    damping, damping_se : tuple of float
        c at the knots and its standard error, N s/m.
    k, tau, k_se, ln_tau_se : tuple of float
        Stiffnesses, relaxation times and standard errors of the arms, N/m and s.
    residual : float
        Rms residual, N.
    bic : float
        Difference from the BIC of one elastic law with one relaxation function for the same
        records: below 0 this model is better.
    checks : tuple of Check
    """

    _keys = (
        Key("elastic_law", "tangent_table"),
        "knots",
        "damping",
        "damping_se",
        "arms",
        "residual",
        Key("bic_over_relaxation", "bic"),
        "checks",
    )

    law: ElasticLaw
    knots: tuple[float, ...]
    damping: tuple[float, ...]
    damping_se: tuple[float, ...]
    k: tuple[float, ...]
    tau: tuple[float, ...]
    k_se: tuple[float, ...]
    ln_tau_se: tuple[float, ...]
    residual: float
    bic: float
    checks: tuple[Check, ...] = ()

    @property
    def tangent_table(self) -> TangentTable:
        """The elastic law by its tangent stiffness at the knots."""
        return TangentTable(self.law.kind, self.law.knots, self.law.tangents)

    @property
    def arms(self) -> tuple[RateArm, ...]:
        """The arms one by one."""
        return tuple(map(RateArm, self.k, self.tau, self.k_se, self.ln_tau_se))

    def c(self, x: float) -> tuple[float, float]:
        """Damping at a compression, m, and its standard error, N s/m."""
        damping_and_error = (
            np.interp(x, self.knots, values) for values in (self.damping, self.damping_se)
        )
        value, error = map(float, damping_and_error)
        return value, error

    def model_at(self, compression: float) -> GeneralizedMaxwell:
        """Return the linear model of small vibration about a compression, m."""
        tangent = float(self.law.tangent(compression))
        return GeneralizedMaxwell(tangent, self.k, self.tau, self.c(compression)[0])


class ProcessCapability(Protocol):
    """Process capability of specimens between two force limits.

    Attributes
    ----------
    count, outside : int
        Number of specimens, and of those beyond a limit.
    lower, upper : float or None
        The limits.
    cpk : float or None
        None without scatter of the forces.
    cpk_interval : (float, float) or None
        95 %.
    summary : str
        Cpk with its interval.
    """

    count: int
    outside: int
    lower: float | None
    upper: float | None
    cpk: float | None
    cpk_interval: tuple[float, float] | None
    summary: str
