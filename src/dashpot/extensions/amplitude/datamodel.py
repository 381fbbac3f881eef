"""Amplitude sweeps, storage and loss against amplitude, and their fit."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass, field, replace
from dashpot.base.arrays import (
    BoolArray,
    ComplexArray,
    Dimensions,
    EqualByValue,
    FloatArray,
    convert_arrays_to_si,
    make_units_field,
    resolve_unit,
    validate_measured_fields,
)
from dashpot.base.checks import Check, HasChecks
from dashpot.base.errors import DataError
from dashpot.base.number_format import ascii_only, round_to_error
from dashpot.base.provenance import Source, describe_record_source
from dashpot.base.result_mixins import HasSummary, Series, collect_arrays
from dashpot.base.serialisation import Key, Serialisable
from dashpot.base.units import convert_to_unit, format_quantity, get_display_unit
from dashpot.datamodel.relaxation import RelaxationTest
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.amplitude.friction import Kraus, RelativeToAmplitude
from dashpot.extensions.amplitude.payne_softening import Softening, softening_factor
from dashpot.solids.maxwell import Solid
from dashpot.solids.nonlinear_springs import Cubic
from dashpot.solids.rate_independent import AmplitudeDependent, InParallel


@dataclass(frozen=True, eq=False, repr=False)
class AmplitudeSweep(EqualByValue, HasSummary):
    """Storage and loss of one specimen at several amplitudes, at one frequency or a few.

    Attributes
    ----------
    frequency : array, shape (n,)
        Hz, > 0.
    amplitude : array, shape (n,)
        m, or a strain, > 0.
    storage, loss : array, shape (n,)
        Pa or N/m (`unit`).
    unit : str
        ``"Pa"`` or ``"N/m"``.
    amplitude_unit : str
        ``"m"`` or ``"strain"``: whether the amplitude is a length or a strain.
    specimen : Specimen
    source : Source or None
    sd : array, shape (n,) or None
        Standard deviation of storage and of loss, in `unit`, if known.
    delay_sd : float
        For recorded loops: standard deviation of the delay of their force, s.
    units : str
        Units of the arrays, in their order: ``"s, mm, N"``, or ``"SI"``. Stored in SI.

    Raises
    ------
    DataError
        If the arrays differ in length, are not finite, or a frequency or amplitude is not above 0.

    Examples
    --------
    >>> import dashpot as dp, numpy as np
    >>> t = np.linspace(0, 10, 50)
    >>> sweep = dp.AmplitudeSweep(1 + 0 * t, 1 + t, 5 - t / 9, 1 + 0 * t, units="Hz, %, MPa, MPa")
    >>> sweep.amplitude_unit, float(sweep.amplitude[0])
    ('strain', 0.01)
    """

    frequency: FloatArray
    amplitude: FloatArray
    storage: FloatArray
    loss: FloatArray
    unit: str = "Pa"
    amplitude_unit: str = "strain"
    specimen: Specimen = field(default_factory=Specimen)
    source: Source | None = None
    sd: FloatArray | None = None
    delay_sd: float = 0.0
    units: str = make_units_field()

    def __post_init__(self) -> None:
        dimensions: Dimensions = ("stress", "stiffness")
        arrays = convert_arrays_to_si(
            self,
            frequency="frequency",
            amplitude=("strain", "length"),
            storage=dimensions,
            loss=dimensions,
            sd=dimensions,
        )
        resolve_unit(self, arrays, "storage", "loss", "sd")
        if arrays:
            object.__setattr__(
                self, "amplitude_unit", {"length": "m"}.get(arrays["amplitude"], "strain")
            )
        validate_measured_fields(self, "frequency", "amplitude", "storage", "loss", "sd")
        for name, unit in (("frequency", "Hz"), ("amplitude", self.amplitude_unit)):
            values = getattr(self, name)
            bad_indices = np.flatnonzero(values <= 0)
            if bad_indices.size:
                raise DataError(
                    f"{name}[{bad_indices[0]}] = {values[bad_indices[0]]:g} {unit}; expected > 0"
                )
        if self.unit not in {"Pa", "N/m"} or self.amplitude_unit not in {"m", "strain"}:
            raise DataError(
                f"unit '{self.unit}' of storage and loss, '{self.amplitude_unit}' of amplitude; "
                "expected 'Pa' or 'N/m', and 'm' or 'strain'"
            )

    @property
    def _table_columns(self) -> Series:
        """Storage and loss over amplitude."""
        unit, amplitude_unit = self.unit, "m" if self.amplitude_unit == "m" else "1"
        return collect_arrays(
            self, amplitude=amplitude_unit, frequency="Hz", storage=unit, loss=unit, sd=unit
        )

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """Summary: the sweep and its range."""
        tones = ", ".join(f"{item:.4g}" for item in np.unique(self.frequency))
        return (
            describe_record_source(self.source, len(self.frequency)),
            (
                f"storage and loss in {self.unit} at {tones} Hz, amplitudes of "
                f"{self.amplitude.min():.3g} to {self.amplitude.max():.3g} {self.amplitude_unit}"
            ),
        )

    @property
    def value(self) -> ComplexArray:
        """Complex modulus or stiffness, in `unit`."""
        return np.asarray(self.storage + 1j * self.loss, dtype=complex)

    def only(self, chosen: BoolArray) -> AmplitudeSweep:
        """Return the chosen samples."""
        names = ("frequency", "amplitude", "storage", "loss", "sd")
        entries = {name: getattr(self, name) for name in names}
        return replace(
            self, **{name: entry[chosen] for name, entry in entries.items() if entry is not None}
        )


@dataclass(frozen=True, eq=False, repr=False)
class StressStrainLoops(EqualByValue, HasSummary):
    """Hysteresis loops of a material as recorded: strain to and fro, stress measured.

    Attributes
    ----------
    time : array, shape (n,)
        s, strictly increasing.
    strain : array, shape (n,)
        Change of length over length, sign and zero as recorded.
    stress : array, shape (n,)
        Pa, sign and zero as recorded.
    specimen : Specimen
    source : Source or None
    units : str
        Units of the arrays, in their order: ``"s, %, MPa"``, or ``"SI"``. Stored in SI.

    Raises
    ------
    DataError
        If the arrays differ in length, hold fewer than 8 samples, are not finite, or time stalls.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(0, 10, 50)
    >>> loops = StressStrainLoops(t, 10 * np.sin(t), 2 * np.sin(t), units="s, %, MPa")
    >>> round(float(np.ptp(loops.stress) / np.ptp(loops.strain)), 3)
    20000000.0
    """

    time: FloatArray
    strain: FloatArray
    stress: FloatArray
    specimen: Specimen = field(default_factory=Specimen)
    source: Source | None = None
    units: str = make_units_field()

    def __post_init__(self) -> None:
        convert_arrays_to_si(self, time="time", strain="strain", stress="stress")
        validate_measured_fields(self, "time", "strain", "stress", minimum=8)

    @property
    def _table_columns(self) -> Series:
        """Strain and stress over time."""
        return collect_arrays(self, time="s", strain="1", stress="Pa")

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """Summary: the record and its range."""
        return (
            describe_record_source(self.source, len(self.time)),
            (
                f"{np.ptp(self.time):.5g} s; strain spans "
                f"{format_quantity(float(np.ptp(self.strain)), '%', '.4g')}, stress "
                f"{format_quantity(float(np.ptp(self.stress)), 'MPa', '.4g')}"
            ),
        )


LoopRecord: TypeAlias = RelaxationTest | StressStrainLoops
"""Recorded loops of a part, or of a material."""


class LinearModulus(NamedTuple):
    """Storage and loss at one frequency, with their standard errors."""

    frequency_hz: float
    storage: float
    loss: float
    storage_se: float
    loss_se: float


@dataclass(frozen=True, eq=False, repr=False)
class AmplitudeFit(EqualByValue, HasSummary, HasChecks, Serialisable):
    r"""Amplitude dependence of stiffness and loss, fitted to a sweep.

    ``"factor"``: :math:`K^*(\omega, X) = K^*(\omega)\,\phi(X)`; ``"additive"``:
    :math:`K^*(\omega) + d\,[\phi_1(X) - 1]`, with :math:`\phi_1` that of a share of 1;
    ``"cubic"``: :math:`K^*(\omega) + \tfrac34 k_3 X^2`; ``"factor+cubic"`` and
    ``"additive+cubic"``: both; ``"none"``: no dependence is seen.

    Attributes
    ----------
    law : str
    frequency : array, shape (f,)
        Hz.
    linear : complex array, shape (f,)
        At a vanishing amplitude, in `unit`.
    linear_se : complex array, shape (f,)
        Standard errors of its real and of its imaginary part.
    lost : float
        d: share of the stiffness (factor), or stiffness in `unit` (additive), that is lost.
    half_way : float
        Amplitude X_c where half of it is lost.
    exponent : float
    se : tuple of (str, float)
        Standard errors of lost, half_way, exponent and k3, those that the law has; 0 for an
        exponent that was set.
    amplitudes : (float, float)
        The range that the sweep informs.
    residual : float
        Rms residual over the magnitude of the modulus.
    orders : tuple of (str, float)
        BIC of each law that may be: the smallest is best, and is taken unless another is as good.
    omitted_samples : int
        Number of omitted samples: those of the smallest amplitudes with more scatter than the
        others.
    unit, amplitude_unit : str
        As in the sweep.
    checks : tuple of Check
    source : Source or None
    k3 : float
        Coefficient of the cubic spring, in `unit` per square of `amplitude_unit`; 0 if there is
        none.
    k3_detection_limit : float
        Without a cubic spring: largest magnitude that the data cannot exclude, 95 %; else 0.
    loss_per_lag : float or None
        Change of the loss factor per second of delay between the channels of recorded loops, 1/s.
        It does so at every amplitude alike, so loops of one frequency do not distinguish it from
        loss.
    delay_sd : float
        For recorded loops: standard deviation of the delay of their force, s, which every standard
        error includes.

    Examples
    --------
    >>> import dashpot as dp, numpy as np
    >>> X = np.geomspace(0.1, 10, 30)
    >>> E = 5 - 2 * X / (1 + X)
    >>> sweep = dp.AmplitudeSweep(1 + 0 * X, X, E, 0.3 + 0 * X, units="Hz, %, MPa, MPa")
    >>> dp.fit(sweep).unit
    'Pa'
    """

    _keys = (
        "residual",
        "law",
        "unit",
        "amplitude_unit",
        Key("loss_factor_per_lag", "loss_per_lag"),
        "delay_sd",
        Key("linear", "lines"),
        Key("numbers", flatten=True),
        "k3_detection_limit",
        Key("orders", "bic_by_law"),
    )

    law: str
    frequency: FloatArray
    linear: ComplexArray
    linear_se: ComplexArray
    lost: float
    half_way: float
    exponent: float
    se: tuple[tuple[str, float], ...]
    amplitudes: tuple[float, float]
    residual: float
    orders: tuple[tuple[str, float], ...]
    omitted_samples: int = 0
    unit: str = "Pa"
    amplitude_unit: str = "strain"
    checks: tuple[Check, ...] = ()
    source: Source | None = None
    k3: float = 0.0
    k3_detection_limit: float = 0.0
    loss_per_lag: float | None = None
    delay_sd: float = 0.0

    @property
    def lines(self) -> tuple[LinearModulus, ...]:
        """The stiffness at a vanishing amplitude, frequency by frequency."""
        value, se = self.linear, self.linear_se
        rows = (self.frequency, value.real, value.imag, se.real, se.imag)
        return tuple(map(LinearModulus, *(row.tolist() for row in rows)))

    @property
    def constants(self) -> dict[str, float]:
        """The numbers of the law."""
        return {name: getattr(self, name) for name, _ in self.se}

    @property
    def numbers(self) -> dict[str, float]:
        """The numbers of the law, and their standard errors."""
        return self.constants | {f"{name}_se": error for name, error in self.se}

    @property
    def bic_by_law(self) -> dict[str, float]:
        """`orders` by their names."""
        return dict(self.orders)

    @property
    def _headline(self) -> str:
        """Change of the stiffness over the amplitudes, and residual of the law."""
        unit, amplitude_unit = get_display_unit(self.unit), get_display_unit(self.amplitude_unit)
        low, high = (convert_to_unit(amplitude, amplitude_unit) for amplitude in self.amplitudes)
        end_stiffnesses = self.stiffness(self.amplitudes).real
        verb = "falls" if end_stiffnesses[1] < end_stiffnesses[0] else "rises"
        return (
            f"from {low:.3g} to {high:.3g} {amplitude_unit} the stiffness {verb} by "
            f"{100 * abs(end_stiffnesses[1] / end_stiffnesses[0] - 1):.2g} %, to "
            f"{format_quantity(float(end_stiffnesses[1]), unit, '.3g')}. "
            f"The law follows it to {100 * self.residual:.2g} %"
        )

    @property
    def _table_columns(self) -> Series:
        """The numbers of the law."""
        unit, is_length = self.unit, self.amplitude_unit == "m"
        units = {
            "lost": "1" if self.law.startswith("factor") else unit,
            "half_way": "m" if is_length else "1", "exponent": "1",
            "k3": f"{unit}/m^2" if is_length else unit,
        }  # fmt: skip
        return {
            "parameter": (list(self.constants), ""),
            "value": (list(self.constants.values()), ""),
            "standard_error": ([error for _, error in self.se], ""),
            "unit": ([units[name] for name in self.constants], ""),
        }

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """The verdict, the law and its numbers."""
        lines, error = [str(self.verdict)], dict(self.se)
        unit, amplitude_unit = get_display_unit(self.unit), get_display_unit(self.amplitude_unit)
        low, high = (convert_to_unit(amplitude, amplitude_unit) for amplitude in self.amplitudes)
        kraus = self.law.partition("+")[0]
        if kraus in {"factor", "additive"}:
            softening = (
                format_quantity(self.lost, "%", ".3g")
                if kraus == "factor"
                else format_quantity(self.lost, unit)
            )
            half_way, half_way_error = (
                convert_to_unit(value, amplitude_unit)
                for value in (self.half_way, error["half_way"])
            )
            lines.append(
                f"{kraus} law: {softening} of the stiffness is lost with amplitude, half of it at "
                f"{ascii_only(round_to_error(half_way, half_way_error))} ± {half_way_error:.2g} "
                f"{amplitude_unit}; exponent "
                f"{self.exponent:.2g}"
            )
        if self.k3:
            unit_text = f"{self.unit}" + ("" if self.amplitude_unit == "strain" else "/m^2")
            verb = "stiffens" if self.k3 > 0 else "softens"
            cubic_stiffness = format_quantity(
                0.75 * abs(self.k3) * self.amplitudes[1] ** 2, unit, ".3g"
            )
            lines.append(
                f"cubic spring: k3 = {self.k3:.4g} ± {error['k3']:.2g} {unit_text}, which {verb} "
                f"by {cubic_stiffness} at the largest amplitude"
            )
        if self.k3_detection_limit:
            share = 0.75 * self.k3_detection_limit * self.amplitudes[1] ** 2
            part = share / float(np.abs(self.stiffness(self.amplitudes[1])))
            lines.append(
                f"No cubic spring is detected. The data cannot exclude one of up to "
                f"{format_quantity(share, unit, '.2g')} ({100 * part:.2g} %) at the largest "
                "amplitude."
            )
        lines.append(
            f"residual {100 * self.residual:.2g} % rms; valid from {low:.3g} to {high:.3g} "
            f"{amplitude_unit}"
        )
        if self.omitted_samples:
            lines.append(
                f"left out: {self.omitted_samples} samples of the smallest amplitudes, "
                "which scatter"
            )
        return tuple(lines)

    def stiffness(self, amplitude: npt.ArrayLike, *, tone: int = 0) -> ComplexArray:
        """Return complex stiffness, in `unit`, at amplitudes, at one of the frequencies."""
        return np.asarray(self.linear[tone] * self.ratio(amplitude, tone=tone))

    def ratio(self, amplitude: npt.ArrayLike, *, tone: int = 0) -> ComplexArray:
        """Return complex stiffness at amplitudes over that at a vanishing one, at one frequency."""
        X = np.asarray(amplitude, dtype=float)
        linear, kraus = complex(self.linear[tone]), self.law.partition("+")[0]
        weights = np.ones(X.shape, dtype=complex)
        if kraus == "factor":
            weights = softening_factor(X, self.lost, self.half_way, self.exponent)
        elif kraus == "additive":
            change = softening_factor(X, 1.0, self.half_way, self.exponent) - 1
            weights = weights + self.lost * change / linear
        return np.asarray(weights + 0.75 * self.k3 * X**2 / linear)

    def build_dependence(
        self, solid: Solid, scale: float = 1.0, *, stretch: float = 1.0, since: float = 0.0
    ) -> AmplitudeDependent | None:
        """Return the change of a linear solid with amplitude; None if it is negligible.

        Parameters
        ----------
        solid : Solid
            N/m, as it is at the amplitude `since`.
        scale, stretch : float
            As in `element`.
        since : float
            As `of`; 0 for a vanishing amplitude.
        """
        kraus, parts, x0 = self.law.partition("+")[0], list[AmplitudeDependent](), since * stretch
        if kraus == "factor":
            parts.append(Softening(solid, self.lost, self.half_way * stretch, self.exponent, x0))
        elif kraus == "additive":
            parts.append(RelativeToAmplitude(self.element(scale, stretch=stretch), x0))
        if self.k3:
            parts.append(RelativeToAmplitude(self.spring(scale, stretch=stretch), x0))
        return InParallel(tuple(parts)) if parts else None

    def spring(self, scale: float = 1.0, *, stretch: float = 1.0) -> Cubic:
        """The cubic spring as an element parallel to a solid; scale and stretch as in `element`."""
        if not self.k3:
            raise DataError(f"the law is '{self.law}', which has no cubic spring")
        return Cubic(self.k3 * scale / stretch**2)

    def element(self, scale: float = 1.0, *, stretch: float = 1.0) -> Kraus:
        """Return the additive law as an element in parallel to a solid.

        Parameters
        ----------
        scale : float
            N/m for each of `unit`: 1 for a part, area over height for a material.
        stretch : float
            m for each of `of`: 1 for a part, the height over the strain factor for a material.
        """
        if not self.law.startswith("additive"):
            raise DataError(f"the law is '{self.law}'; only an additive law is added to a model")
        return Kraus(self.lost * scale, self.half_way * stretch, self.exponent)
