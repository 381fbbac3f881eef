r"""Preload map: complex stiffness over frequency, amplitude and compression."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import ComplexArray, EqualByValue, FloatArray, frozen, samples
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
from dashpot.solids.maxwell import GeneralizedMaxwell

_SAME = 1e-6
"""Relative distance beyond a range that is rounding."""
_PER_OCTAVE = 6


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
        Rms of measured less map, relative.
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
        Which of them are c_0 and X_0.
    compression_factor : array
        :math:`F_e'(c)/F_e'(c_0)` at the levels.
    amplitude_factor : complex array
        :math:`s(X)/s(X_0)` at the levels; of no amplitude one of 1.
    covariance : array
        Of ln of the factors of compression, of ln and angle of those of amplitude, and of the
        stiffnesses of the model, widened so that 1.96 standard errors are 95 %.
    gain_error, phase_error : float
        Standard errors of the sensors common to all lines: relative, and rad.
    line_scatter, sweep_scatter : (float, float)
        Of ln K and of the loss angle: of a line, and of a whole sweep beside it.
    pairs : tuple of PairTest
    cells : tuple of MapCell
    frequency, value, line_compression, line_amplitude : array, shape (n,)
        Every measured line; an unknown amplitude is nan.
    mass, seals : float
        That the resonances are of; a mass of 0 is none.
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
            object.__setattr__(self, name, frozen(array))
        for name in ("amplitude_factor", "value"):
            array = np.asarray(getattr(self, name), dtype=complex)
            object.__setattr__(self, name, frozen(array))

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
            If one lies outside what was measured: a map is not extrapolated.
        """
        f = (
            np.array([convert_to_si(frequency, "frequency")])
            if isinstance(frequency, str)
            else np.atleast_1d(np.asarray(frequency, dtype=float))
        )
        f = samples("frequency", f)
        for end in (float(f.min()), float(f.max())):
            _require_within("frequency", end, self.band, "Hz")
        c, X = self._convert_place(compression, amplitude)
        on_c = compute_level_weights(self.compressions, c)
        moved = np.log(self.amplitudes) if len(self.amplitudes) else np.zeros(1)
        on_X = compute_level_weights(moved, 0.0 if X is None else float(np.log(X)))
        ln_h, ln_s = np.log(self.compression_factor), np.log(self.amplitude_factor)
        factor = np.exp(on_c.curve @ ln_h + on_X.curve @ ln_s)
        master = self.model.complex_stiffness(omega=2 * np.pi * f)
        value = np.asarray(master * factor)
        eta = value.imag / value.real
        real, imaginary = self._compute_gradients(f, master, on_c.curve, on_X.curve)
        gap_c, gap_X = float(on_c.doubt @ ln_h), complex(on_X.doubt @ ln_s)
        gain, phase = NORMAL * self.gain_error, NORMAL * self.phase_error

        def half(re: FloatArray | float, im: FloatArray | float) -> FloatArray:
            """95 % half width of re times ln|K| and im times the angle."""
            re, im = np.broadcast_to(re, f.shape), np.broadcast_to(im, f.shape)
            gradient = re[:, None] * real + im[:, None] * imaginary
            noise = np.einsum("ij,jk,ik->i", gradient, self.covariance, gradient)
            common = (re * gain) ** 2 + (im * phase) ** 2
            between = (re * gap_c) ** 2 + (re * gap_X.real + im * gap_X.imag) ** 2
            return np.asarray(np.sqrt(np.maximum(NORMAL**2 * noise, 0.0) + common + between))

        return MapValues(
            f,
            value,
            value.real * half(1.0, -eta),
            half(value.imag, value.real),
            half(0.0, 1 + eta**2),
            half(1.0, 0.0),
        )

    def build_model(
        self, compression: Quantity, amplitude: Quantity | None = None
    ) -> GeneralizedMaxwell:
        """Return the Maxwell model at a compression and an amplitude, N/m.

        The factor of the amplitude is taken by its size: an angle of its own is no Maxwell model.

        Raises
        ------
        DataError
            As :meth:`evaluate`.
        """
        c, X = self._convert_place(compression, amplitude)
        on_c = compute_level_weights(self.compressions, c).curve
        factor = float(np.exp(on_c @ np.log(self.compression_factor)))
        if X is not None:
            on_X = compute_level_weights(np.log(self.amplitudes), float(np.log(X))).curve
            factor *= float(np.exp(on_X @ np.log(np.abs(self.amplitude_factor))))
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

        def excess(f: float) -> float:
            value = self.evaluate(np.array([f]), compression=c, amplitude=X).value[0]
            return float((2 * np.pi * f) ** 2 * kilograms - seals * value.real)

        if excess(low) > 0 or excess(high) < 0:
            where = "below" if excess(low) > 0 else "above"
            raise DataError(
                f"the resonance of {convert_to_unit(kilograms, 'g'):.4g} g on {seals:g} parts lies "
                f"{where} the measured band, {low:.4g} to {high:.4g} Hz. Check the mass, or "
                "measure further"
            )
        for _ in range(60):
            middle = float(np.sqrt(low * high))
            low, high = (middle, high) if excess(middle) < 0 else (low, middle)
        f = float(np.sqrt(low * high))
        at = self.evaluate(np.array([f]), compression=c, amplitude=X)
        storage, error = float(at.value.real[0]), float(at.storage_error[0])
        ends = [f * float(np.sqrt(max(1 + side * error / storage, 0.0))) for side in (-1, 1)]
        damping = float(at.value.imag[0]) / storage / 2
        return MapResonance(c, X, f, (ends[0], ends[1]), damping)

    def _convert_place(
        self, compression: Quantity, amplitude: Quantity | None
    ) -> tuple[float, float | None]:
        """Return compression and amplitude, m, in the measured range."""
        c, X = convert_to_si(compression, "length"), convert_to_si(amplitude, "length")
        least, most = float(self.compressions[0]), float(self.compressions[-1])
        _require_within("compression", c, (least, most), "mm")
        if not len(self.amplitudes):
            if X is not None:
                raise DataError(
                    "no sweep stated its amplitude, so the map has none: leave the amplitude out"
                )
            return min(max(c, least), most), None
        X = float(self.amplitudes[self.reference[1]]) if X is None else X
        smallest, largest = float(self.amplitudes[0]), float(self.amplitudes[-1])
        _require_within("amplitude", X, (smallest, largest), "mm")
        return min(max(c, least), most), min(max(X, smallest), largest)

    def _compute_gradients(
        self, f: FloatArray, master: ComplexArray, on_c: FloatArray, on_X: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return what ln|K| and the angle gain with each estimated number, shape (n, q) each."""
        n = len(f)
        product = 2j * np.pi * f[:, None] * np.array(self.model.tau)
        arms = np.column_stack((np.ones(n), product / (1 + product))) / master[:, None]
        zero_c, zero_X = np.zeros((n, len(on_c))), np.zeros((n, len(on_X)))
        c, X = np.tile(on_c, (n, 1)), np.tile(on_X, (n, 1))
        return (
            np.hstack((c, X, zero_X, arms.real)),
            np.hstack((zero_c, zero_X, X, arms.imag)),
        )

    # -- what it tells ------------------------------------------------------------------------

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
        return np.geomspace(low, high, max(round(_PER_OCTAVE * np.log2(high / low)), 2) + 1)

    @property
    def settings(self) -> tuple[tuple[float, float | None], ...]:
        """Every combination of measured levels of compression and amplitude, m."""
        amplitudes = self.amplitudes.tolist() or [None]
        return tuple((c, X) for c in self.compressions.tolist() for X in amplitudes)

    @property
    def facts(self) -> tuple[ReportedValue, ...]:
        """Storage stiffness and loss factor at the middle frequency, and the resonances."""
        f = self.middle_frequency
        facts = []
        for c in self.compressions.tolist():
            at = self.evaluate(np.array([f]), compression=c)
            value, error = float(at.value.real[0]), float(at.storage_error[0])
            name = f"K' at {convert_to_unit(c, 'mm'):.4g} mm, {f:g} Hz"
            facts.append(ReportedValue(name, value, value - error, value + error, unit="N/m"))
        for X in self.amplitudes.tolist() or [None]:
            at = self.evaluate(np.array([f]), compression=self.reference_compression, amplitude=X)
            eta, error = float(at.value.imag[0] / at.value.real[0]), float(at.loss_factor_error[0])
            where = "" if X is None else f"amplitude {convert_to_unit(X, 'mm'):.4g} mm, "
            name = f"loss factor at {where}{f:g} Hz"
            facts.append(ReportedValue(name, eta, eta - error, eta + error))
        for found in self.resonances:
            name = f"resonance at {convert_to_unit(found.compression, 'mm'):.4g} mm"
            facts.append(ReportedValue(name, found.frequency, *found.frequency_limits, unit="Hz"))
        return tuple(facts)

    @property
    def _table_columns(self) -> Series:
        """The map on its levels and over frequency."""
        rows: dict[str, list[FloatArray]] = {}
        f = self.grid
        for c, X in self.settings:
            at = self.evaluate(f, compression=c, amplitude=X)
            eta = at.value.imag / at.value.real
            columns = {
                "compression": np.full(len(f), c),
                "amplitude": np.full(len(f), np.nan if X is None else X),
                "frequency": f,
                "storage": at.value.real,
                "storage_low": at.value.real - at.storage_error,
                "storage_high": at.value.real + at.storage_error,
                "loss": at.value.imag,
                "loss_low": at.value.imag - at.loss_error,
                "loss_high": at.value.imag + at.loss_error,
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
        ends = []
        for c in (float(self.compressions[0]), float(self.compressions[-1])):
            value = self.evaluate(np.array([f]), compression=c).value[0]
            ends.append(
                f"{convert_to_unit(float(value.real), 'N/mm'):.4g} N/mm at "
                f"{convert_to_unit(c, 'mm'):.4g} mm"
            )
        headline = f"at {f:g} Hz the stiffness is {' and '.join(ends)}"
        if not self.resonances:
            return headline
        mass = format_quantity_short(self.mass, "kg")
        first, last = (self.resonances[i].frequency for i in (0, -1))
        return f"{headline}. The resonance of {mass} is at {first:.4g} and {last:.4g} Hz"


def _require_within(name: str, value: float, range_: tuple[float, float], unit: str) -> None:
    low, high = range_
    if low * (1 - _SAME) <= value <= high * (1 + _SAME):
        return
    shown, least, most = (convert_to_unit(entry, unit) for entry in (value, low, high))
    raise DataError(
        f"{name} = {shown:.4g} {unit}; the sweeps cover {least:.4g} to {most:.4g} {unit}, and a "
        "map is not extrapolated. Ask inside, or measure there"
    )
