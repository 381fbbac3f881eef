r"""Preload map: complex stiffness over frequency, amplitude and compression."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import (
    ComplexArray,
    EqualByValue,
    FloatArray,
    make_readonly_copy,
    validate_samples,
)
from dashpot.base.checks import Check, HasChecks
from dashpot.base.errors import DataError
from dashpot.base.provenance import Source, Step
from dashpot.base.reported_values import NORMAL, ReportedValue
from dashpot.base.result_mixins import HasVerdict, Series
from dashpot.base.serialisation import Key, Serialisable
from dashpot.base.units import Quantity, convert_to_si, convert_to_unit
from dashpot.base.value_ranges import format_quantity_short, require_positive
from dashpot.extensions.preload_map.interpolation import compute_level_weights
from dashpot.extensions.preload_map.separability import PairTest
from dashpot.extensions.preload_map.stiffness_lines import (
    SAME_AMPLITUDE,
    SAME_COMPRESSION,
    SAME_TONE,
)
from dashpot.solids.maxwell import GeneralizedMaxwell

_LINES_PER_OCTAVE = 6


@dataclass(frozen=True)
class MapCell(Serialisable):
    """Sweeps at one compression and one amplitude.

    Attributes
    ----------
    compression : float
        m.
    amplitude : float or None
        m.
    sweeps, lines : int
    residual : float
        Rms difference of the measured stiffness from the map, relative.
    """

    compression: float
    amplitude: float | None
    sweeps: int
    lines: int
    residual: float


@dataclass(frozen=True)
class MapResonance(Serialisable):
    """Resonance of a mass on the parts at one compression.

    Attributes
    ----------
    compression : float
        m.
    amplitude : float or None
        m.
    frequency : float
        Undamped, Hz.
    frequency_limits : (float, float)
        95 %.
    damping : float
        Damping ratio, half the loss factor there.
    """

    _keys = ("compression", "amplitude", Key("frequency_hz", "frequency"),
             Key("frequency_limits_hz", "frequency_limits"), "damping")  # fmt: skip

    compression: float
    amplitude: float | None
    frequency: float
    frequency_limits: tuple[float, float]
    damping: float

    @property
    def reported_frequency(self) -> ReportedValue:
        """The frequency with its limits, Hz."""
        name = f"resonance at {convert_to_unit(self.compression, 'mm'):.4g} mm"
        return ReportedValue(name, self.frequency, *self.frequency_limits, unit="Hz")


class MapValues(NamedTuple):
    """Complex stiffness at one compression and amplitude over frequency.

    `frequency` is in Hz and `value` in N/m, both of shape (n,). The errors are half widths of the
    95 % intervals: of storage and loss in N/m, of the loss factor plain, of the magnitude relative
    to :math:`|K^*|`.
    """

    frequency: FloatArray
    value: ComplexArray
    storage_error: FloatArray
    loss_error: FloatArray
    loss_factor_error: FloatArray
    magnitude_error: FloatArray


@dataclass(frozen=True, eq=False, repr=False)
class PreloadMap(EqualByValue, HasChecks, HasVerdict, Serialisable):
    r"""Complex stiffness of a part over frequency, amplitude and compression.

    .. math::

        K^*(f, X, c) = \frac{F_e'(c)}{F_e'(c_0)} \Big[k_\infty + \sum_j k_j
            \frac{j\omega\tau_j}{1 + j\omega\tau_j}\Big] \frac{s(X)}{s(X_0)}

    Attributes
    ----------
    model : GeneralizedMaxwell
        At the reference compression c_0 and amplitude X_0.
    band : (float, float)
        Hz, as measured.
    compressions, amplitudes : array
        Levels, m, rising; no amplitude where none is known.
    reference : (int, int)
        Indices of c_0 and X_0 in these levels.
    compression_factor : array
        :math:`F_e'(c)/F_e'(c_0)` at the levels.
    amplitude_factor : complex array
        :math:`s(X)/s(X_0)` at the levels; of no amplitude one of 1.
    covariance : array
        Covariance of ln of the factors of compression, of ln and angle of those of amplitude, and
        of the stiffnesses of the model, widened so that 1.96 standard errors are 95 %.
    gain_error, phase_error : float
        Standard errors of the sensors common to all lines: relative, and rad.
    line_scatter, sweep_scatter : (float, float)
        Scatter of ln K and of the loss angle: of a line, and of a whole sweep beside it.
    pairs : tuple of PairTest
    cells : tuple of MapCell
    frequency, value, line_compression, line_amplitude : array, shape (n,)
        Every measured line; an unknown amplitude is nan.
    mass, seals : float
        Mass, kg, and number of parts of the resonances; without resonances the mass is 0.
    resonances : tuple of MapResonance
    checks, source, steps
        As in a fit.
    """

    schema = "dashpot/preload-map@1"
    _keys = (
        "model",
        Key("band_hz", "band"),
        "compressions",
        "amplitudes",
        "reference",
        "compression_factor",
        "amplitude_factor",
        "covariance",
        "gain_error",
        "phase_error",
        "line_scatter",
        "sweep_scatter",
        "pairs",
        "cells",
        Key("frequency_hz", "frequency"),
        "value",
        "line_compression",
        "line_amplitude",
        "mass",
        "seals",
        "resonances",
        "verdict",
        "checks",
        "source",
        "steps",
    )

    model: GeneralizedMaxwell
    band: tuple[float, float]
    compressions: FloatArray
    amplitudes: FloatArray
    reference: tuple[int, int]
    compression_factor: FloatArray
    amplitude_factor: ComplexArray
    covariance: FloatArray
    gain_error: float
    phase_error: float
    line_scatter: tuple[float, float]
    sweep_scatter: tuple[float, float]
    pairs: tuple[PairTest, ...]
    cells: tuple[MapCell, ...]
    frequency: FloatArray
    value: ComplexArray
    line_compression: FloatArray
    line_amplitude: FloatArray
    mass: float = 0.0
    seals: float = 1.0
    resonances: tuple[MapResonance, ...] = ()
    checks: tuple[Check, ...] = ()
    source: tuple[Source, ...] = ()
    steps: tuple[Step, ...] = ()

    def __post_init__(self) -> None:
        for name in ("compressions", "compression_factor", "covariance", "frequency",
                     "amplitudes", "line_compression", "line_amplitude"):  # fmt: skip
            array = np.asarray(getattr(self, name), dtype=float)
            object.__setattr__(self, name, make_readonly_copy(array))
        for name in ("amplitude_factor", "value"):
            array = np.asarray(getattr(self, name), dtype=complex)
            object.__setattr__(self, name, make_readonly_copy(array))

    # -- evaluation ---------------------------------------------------------------------------

    def evaluate(
        self,
        frequency: Quantity | FloatArray,
        *,
        compression: Quantity,
        amplitude: Quantity | None = None,
    ) -> MapValues:
        """Return the complex stiffness and its 95 % errors at frequencies, N/m.

        Parameters
        ----------
        frequency : array, shape (n,), or str
            Hz, in the measured band.
        compression : float or str
            m, from the least to the greatest that was measured.
        amplitude : float or str, optional
            m, likewise; by default the reference amplitude.

        Raises
        ------
        DataError
            If one lies outside the measured range: a map is not extrapolated.
        """
        f = (
            np.array([convert_to_si(frequency, "frequency")])
            if isinstance(frequency, str)
            else np.atleast_1d(np.asarray(frequency, dtype=float))
        )
        f = validate_samples("frequency", f)
        for end in (float(f.min()), float(f.max())):
            _require_within("frequency", end, self.band, "Hz", SAME_TONE)
        c, X = self._convert_place(compression, amplitude)
        compression_weights = compute_level_weights(self.compressions, c)
        log_amplitudes = np.log(self.amplitudes) if len(self.amplitudes) else np.zeros(1)
        amplitude_weights = compute_level_weights(
            log_amplitudes, 0.0 if X is None else float(np.log(X))
        )
        log_compression_factor, log_amplitude_factor = (
            np.log(self.compression_factor),
            np.log(self.amplitude_factor),
        )
        factor = np.exp(
            compression_weights.parabolic @ log_compression_factor
            + amplitude_weights.parabolic @ log_amplitude_factor
        )
        master = self.model.complex_stiffness(omega=2 * np.pi * f)
        value = np.asarray(master * factor)
        loss_factor = value.imag / value.real
        log_gradient, angle_gradient = self._compute_gradients(
            f, master, compression_weights.parabolic, amplitude_weights.parabolic
        )
        compression_gap, amplitude_gap = (
            float(compression_weights.difference @ log_compression_factor),
            complex(amplitude_weights.difference @ log_amplitude_factor),
        )
        gain_half_width, phase_half_width = NORMAL * self.gain_error, NORMAL * self.phase_error

        def compute_half_width(
            log_weight: FloatArray | float, angle_weight: FloatArray | float
        ) -> FloatArray:
            """Return the 95 % half width of a weighted sum of ln|K| and its angle."""
            log_weight, angle_weight = (
                np.broadcast_to(log_weight, f.shape),
                np.broadcast_to(angle_weight, f.shape),
            )
            gradient = log_weight[:, None] * log_gradient + angle_weight[:, None] * angle_gradient
            noise_variance = np.einsum("ij,jk,ik->i", gradient, self.covariance, gradient)
            sensor_variance = (log_weight * gain_half_width) ** 2 + (
                angle_weight * phase_half_width
            ) ** 2
            interpolation = (log_weight * compression_gap) ** 2 + (
                log_weight * amplitude_gap.real + angle_weight * amplitude_gap.imag
            ) ** 2
            return np.asarray(
                np.sqrt(
                    np.maximum(NORMAL**2 * noise_variance, 0.0) + sensor_variance + interpolation
                )
            )

        return MapValues(
            f,
            value,
            value.real * compute_half_width(1.0, -loss_factor),
            compute_half_width(value.imag, value.real),
            compute_half_width(0.0, 1 + loss_factor**2),
            compute_half_width(1.0, 0.0),
        )

    def build_model(
        self, compression: Quantity, amplitude: Quantity | None = None
    ) -> GeneralizedMaxwell:
        """Return the Maxwell model at a compression and an amplitude, N/m.

        Of the amplitude factor only the magnitude is used, as its angle fits no Maxwell model.

        Raises
        ------
        DataError
            As :meth:`evaluate`.
        """
        c, X = self._convert_place(compression, amplitude)
        compression_weights = compute_level_weights(self.compressions, c).parabolic
        factor = float(np.exp(compression_weights @ np.log(self.compression_factor)))
        if X is not None:
            amplitude_weights = compute_level_weights(
                np.log(self.amplitudes), float(np.log(X))
            ).parabolic
            factor *= float(np.exp(amplitude_weights @ np.log(np.abs(self.amplitude_factor))))
        return self.model * factor

    def find_resonance(
        self,
        mass: Quantity,
        *,
        seals: float = 1.0,
        compression: Quantity,
        amplitude: Quantity | None = None,
    ) -> MapResonance:
        r"""Return the resonance of a mass on parts in parallel, :math:`\omega^2 = n K'(\omega)/m`.

        Raises
        ------
        DataError
            If it lies outside the measured band, or a value is impossible.
        """
        kilograms = convert_to_si(mass, "mass")
        require_positive(mass=kilograms, seals=seals)
        c, X = self._convert_place(compression, amplitude)
        low, high = self.band

        def compute_excess(f: float) -> float:
            value = self.evaluate(np.array([f]), compression=c, amplitude=X).value[0]
            return float((2 * np.pi * f) ** 2 * kilograms - seals * value.real)

        if compute_excess(low) > 0 or compute_excess(high) < 0:
            side_word = "below" if compute_excess(low) > 0 else "above"
            raise DataError(
                f"the resonance of {convert_to_unit(kilograms, 'g'):.4g} g on {seals:g} parts lies "
                f"{side_word} the measured band, {low:.4g} to {high:.4g} Hz. Check the mass, or "
                "measure further"
            )
        for _ in range(60):
            middle = float(np.sqrt(low * high))
            low, high = (middle, high) if compute_excess(middle) < 0 else (low, middle)
        f = float(np.sqrt(low * high))
        map_values = self.evaluate(np.array([f]), compression=c, amplitude=X)
        storage, error = float(map_values.value.real[0]), float(map_values.storage_error[0])
        limits = [f * float(np.sqrt(max(1 + sign * error / storage, 0.0))) for sign in (-1, 1)]
        damping = float(map_values.value.imag[0]) / storage / 2
        return MapResonance(c, X, f, (limits[0], limits[1]), damping)

    def _convert_place(
        self, compression: Quantity, amplitude: Quantity | None
    ) -> tuple[float, float | None]:
        """Return compression and amplitude, m, in the measured range."""
        c, X = convert_to_si(compression, "length"), convert_to_si(amplitude, "length")
        lowest, highest = float(self.compressions[0]), float(self.compressions[-1])
        _require_within("compression", c, (lowest, highest), "mm", SAME_COMPRESSION)
        if not len(self.amplitudes):
            if X is not None:
                raise DataError(
                    "no sweep stated its amplitude, so the map has none: leave the amplitude out"
                )
            return min(max(c, lowest), highest), None
        X = float(self.amplitudes[self.reference[1]]) if X is None else X
        smallest, largest = float(self.amplitudes[0]), float(self.amplitudes[-1])
        _require_within("amplitude", X, (smallest, largest), "mm", SAME_AMPLITUDE)
        return min(max(c, lowest), highest), min(max(X, smallest), largest)

    def _compute_gradients(
        self,
        f: FloatArray,
        master: ComplexArray,
        compression_weights: FloatArray,
        amplitude_weights: FloatArray,
    ) -> tuple[FloatArray, FloatArray]:
        """Return the gradients of ln|K| and angle in the parameters, shape (n, q) each."""
        line_count = len(f)
        arms = build_arm_columns(2 * np.pi * f, np.array(self.model.tau)) / master[:, None]
        zero_c, zero_X = (
            np.zeros((line_count, len(compression_weights))),
            np.zeros((line_count, len(amplitude_weights))),
        )
        c, X = (
            np.tile(compression_weights, (line_count, 1)),
            np.tile(amplitude_weights, (line_count, 1)),
        )
        return (
            np.hstack((c, X, zero_X, arms.real)),
            np.hstack((zero_c, zero_X, X, arms.imag)),
        )

    # -- reported values ------------------------------------------------------------------------

    @property
    def reference_compression(self) -> float:
        """Compression of the model, m."""
        return float(self.compressions[self.reference[0]])

    @property
    def reference_amplitude(self) -> float | None:
        """Amplitude of the model, m."""
        return float(self.amplitudes[self.reference[1]]) if len(self.amplitudes) else None

    @property
    def middle_frequency(self) -> float:
        """Geometric middle of the band, Hz, to three digits."""
        return float(f"{np.sqrt(self.band[0] * self.band[1]):.3g}")

    @property
    def grid(self) -> FloatArray:
        """Frequencies of tables and figures, Hz: both ends and six an octave."""
        low, high = self.band
        return np.geomspace(low, high, max(round(_LINES_PER_OCTAVE * np.log2(high / low)), 2) + 1)

    @property
    def settings(self) -> tuple[tuple[float, float | None], ...]:
        """Every combination of measured levels of compression and amplitude, m."""
        amplitudes = self.amplitudes.tolist() or [None]
        return tuple((c, X) for c in self.compressions.tolist() for X in amplitudes)

    @property
    def facts(self) -> tuple[ReportedValue, ...]:
        """Storage stiffness and loss factor at the middle frequency, and the resonances."""
        f = self.middle_frequency
        reported_values = []
        for c in self.compressions.tolist():
            map_values = self.evaluate(np.array([f]), compression=c)
            value, error = float(map_values.value.real[0]), float(map_values.storage_error[0])
            name = f"K' at {convert_to_unit(c, 'mm'):.4g} mm, {f:g} Hz"
            reported_values.append(
                ReportedValue(name, value, value - error, value + error, unit="N/m")
            )
        for X in self.amplitudes.tolist() or [None]:
            map_values = self.evaluate(
                np.array([f]), compression=self.reference_compression, amplitude=X
            )
            eta, error = (
                float(map_values.value.imag[0] / map_values.value.real[0]),
                float(map_values.loss_factor_error[0]),
            )
            amplitude_label = "" if X is None else f"amplitude {convert_to_unit(X, 'mm'):.4g} mm, "
            name = f"loss factor at {amplitude_label}{f:g} Hz"
            reported_values.append(ReportedValue(name, eta, eta - error, eta + error))
        return (*reported_values, *(resonance.reported_frequency for resonance in self.resonances))

    @property
    def _table_columns(self) -> Series:
        """Columns of the map on its levels and over frequency."""
        rows: dict[str, list[FloatArray]] = {}
        f = self.grid
        for c, X in self.settings:
            map_values = self.evaluate(f, compression=c, amplitude=X)
            eta = map_values.value.imag / map_values.value.real
            columns = {
                "compression": np.full(len(f), c),
                "amplitude": np.full(len(f), np.nan if X is None else X),
                "frequency": f,
                "storage": map_values.value.real,
                "storage_low": map_values.value.real - map_values.storage_error,
                "storage_high": map_values.value.real + map_values.storage_error,
                "loss": map_values.value.imag,
                "loss_low": map_values.value.imag - map_values.loss_error,
                "loss_high": map_values.value.imag + map_values.loss_error,
                "loss_factor": eta,
            }
            for name, values in columns.items():
                rows.setdefault(name, []).append(values)
        units = {"compression": "m", "amplitude": "m", "frequency": "Hz", "loss_factor": ""}
        return {
            name: (np.concatenate(values), units.get(name, "N/m"))
            for name, values in rows.items()
            if name != "amplitude" or len(self.amplitudes)
        }

    @property
    def _headline(self) -> str:
        """The stiffness at the least and at the greatest compression."""
        f = self.middle_frequency
        range_texts = []
        for c in (float(self.compressions[0]), float(self.compressions[-1])):
            value = self.evaluate(np.array([f]), compression=c).value[0]
            range_texts.append(
                f"{convert_to_unit(float(value.real), 'N/mm'):.4g} N/mm at "
                f"{convert_to_unit(c, 'mm'):.4g} mm"
            )
        headline = f"at {f:g} Hz the stiffness is {' and '.join(range_texts)}"
        if not self.resonances:
            return headline
        mass = format_quantity_short(self.mass, "kg")
        first, last = (self.resonances[i].frequency for i in (0, -1))
        return f"{headline}. The resonance of {mass} is at {first:.4g} and {last:.4g} Hz"


def build_arm_columns(omega: FloatArray, tau: FloatArray) -> ComplexArray:
    r"""Return what k_inf and each k_j multiply: 1, :math:`j\omega\tau_j/(1+j\omega\tau_j)`."""
    product = 1j * omega[:, None] * tau
    return np.column_stack((np.ones(len(omega), dtype=complex), product / (1 + product)))


def _require_within(
    name: str, value: float, range_: tuple[float, float], unit: str, relative_tolerance: float
) -> None:
    """Refuse a value outside a range, of which the ends have a relative tolerance.

    A loop whose amplitude was set to 0.5 mm may be measured as 0.4999 mm.
    """
    low, high = range_
    if low * (1 - relative_tolerance) <= value <= high * (1 + relative_tolerance):
        return
    value_in_unit, low_in_unit, high_in_unit = (
        convert_to_unit(entry, unit) for entry in (value, low, high)
    )
    raise DataError(
        f"{name} = {value_in_unit:.4g} {unit}; the sweeps cover {low_in_unit:.4g} to "
        f"{high_in_unit:.4g} {unit}, and a map is not extrapolated. Ask inside, or measure there"
    )
