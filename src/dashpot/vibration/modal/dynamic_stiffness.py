"""Dynamic stiffness and damping from the FRF of a mass, without a model of the seal."""

from __future__ import annotations

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import (
    BoolArray,
    ComplexArray,
    EqualByValue,
    FloatArray,
    make_readonly_copy,
)
from dashpot.base.checks import Check
from dashpot.base.errors import DataError
from dashpot.base.units import Quantity, Range, convert_to_si, si_range
from dashpot.base.value_ranges import require_positive
from dashpot.datamodel.frf import FRF, Kind
from dashpot.vibration.checks import stiffness_causal
from dashpot.vibration.modal.peaks import find_peak, find_run

# Effect of small errors of a test on storage and loss factor.


def compute_stiffness_change(slope: ComplexArray, eta: FloatArray) -> tuple[FloatArray, FloatArray]:
    r"""Relative change of the storage, and change of the loss factor, by a small :math:`d\ln K^*`.

    .. math::

        \frac{dK'}{K'} = \mathrm{Re}\,d\ln K^* - \eta\,\mathrm{Im}\,d\ln K^*, \qquad
        d\eta = (1 + \eta^2)\,\mathrm{Im}\,d\ln K^*

    Parameters
    ----------
    slope : complex array, shape (n,)
        :math:`d\ln K^*`.
    eta : array, shape (n,)
    """
    return (
        np.asarray(slope.real - eta * slope.imag),
        np.asarray(slope.imag * (1 + eta**2)),
    )


DEGREE = float(np.pi / 180)
STORAGE_LIMIT, LOSS_LIMIT = 0.1, 0.3
# the slope of ln K' is taken over this factor in frequency to either side
SLOPE_BAND_FACTOR = 1.6


@dataclass(frozen=True, eq=False)
class DynamicStiffness(EqualByValue):
    r"""Dynamic stiffness of one seal against frequency, with its errors.

    Attributes
    ----------
    frequency : array, shape (n,)
        Hz.
    storage, loss : array, shape (n,)
        N/m.
    damping : array, shape (n,)
        :math:`c = K''/\omega`, N s/m.
    loss_factor : array, shape (n,)
    storage_random, loss_random : array, shape (n,)
        Standard deviation from the scatter of the FRF, N/m; 0 where that is unknown.
    by_mass, by_phase : complex array, shape (n,)
        What :math:`K^*` gains for a relative change of the mass, and for each rad by which the
        motion leads the force, or the mass the base, N/m; what that does to storage and loss factor
        is :meth:`changes`.
    over_base : bool
        It was a transmissibility, or a relative one.
    mass, mass_sd : float
        kg.
    phase_sd : float
        rad.
    storage_band, loss_band : (float, float)
        Where the storage stiffness is good to 10 % and the loss stiffness to 30 %, all errors
        together, about the peak, Hz; (nan, nan) if nowhere.
    checks : tuple of Check
        Whether stiffness and loss belong together; none with fewer than 3 lines about the peak.
    """

    frequency: FloatArray
    storage: FloatArray
    loss: FloatArray
    damping: FloatArray
    loss_factor: FloatArray
    storage_random: FloatArray
    loss_random: FloatArray
    by_mass: ComplexArray
    by_phase: ComplexArray
    over_base: bool
    mass: float
    mass_sd: float
    phase_sd: float
    storage_band: tuple[float, float]
    loss_band: tuple[float, float]
    checks: tuple[Check, ...]

    @property
    def storage_mass(self) -> FloatArray:
        """Error of the storage stiffness by the error of the mass, N/m."""
        return np.asarray(self.mass_sd / self.mass * np.abs(self.by_mass.real))

    @property
    def storage_phase(self) -> FloatArray:
        """Error of the storage stiffness by a phase error between the channels, N/m."""
        return np.asarray(self.phase_sd * np.abs(self.by_phase.real))

    @property
    def loss_phase(self) -> FloatArray:
        """Error of the loss stiffness by that phase error, N/m."""
        return np.asarray(self.phase_sd * np.abs(self.by_phase.imag))

    def changes(self, name: str, size: float) -> tuple[FloatArray, FloatArray]:
        """Relative change of the storage, and change of the loss factor, by an error of `name`."""
        stiffness = self.storage + 1j * self.loss
        slope: ComplexArray = getattr(self, f"by_{name}") / stiffness
        return compute_stiffness_change(size * slope, self.loss_factor)

    @property
    def usable(self) -> BoolArray:
        """The lines in both bands."""
        f, (low, high), (loss_low, loss_high) = self.frequency, self.storage_band, self.loss_band
        return np.asarray((f >= low) & (f >= loss_low) & (f <= high) & (f <= loss_high))

    @property
    def storage_sd(self) -> FloatArray:
        """All errors of the storage stiffness together, N/m."""
        return np.asarray(
            np.sqrt(self.storage_random**2 + self.storage_mass**2 + self.storage_phase**2)
        )

    @property
    def loss_sd(self) -> FloatArray:
        """All errors of the loss stiffness together, N/m."""
        return np.asarray(np.hypot(self.loss_random, self.loss_phase))

    @property
    def loss_factor_sd(self) -> FloatArray:
        """All errors of the loss factor together."""
        # of tan delta = loss / storage; no loss at all leaves its own error
        return np.asarray(
            np.hypot(self.loss_sd, self.loss_factor * self.storage_sd) / np.abs(self.storage)
        )


def dynamic_stiffness(
    frf: FRF,
    mass: Quantity,
    *,
    seals: float = 1.0,
    mass_sd: Quantity | None = None,
    phase_sd: float = DEGREE,
    band: Range | None = None,
) -> DynamicStiffness:
    r"""Stiffness and damping of one seal, line by line, from the FRF of a mass on `seals` of them.

    .. math::

        n K' = \mathrm{Re}(1/H) + m\omega^2, \qquad n K'' = \mathrm{Im}(1/H), \qquad c = K''/\omega

    with H the receptance (Lin et al. 2005). An error of the mass adds
    :math:`\delta m\,\omega^2` to K', a phase error :math:`\varphi` adds
    :math:`\varphi (n K' - m\omega^2)` to K'': above the resonance the mass hides the seal, below
    it the phase hides its damping. With an exponential window everything is at
    :math:`s = j\omega + a`.

    From a transmissibility T to the mass,

    .. math:: n K^* = m\omega^2 \frac{T}{T - 1}, \qquad
              \delta K^* = K^* \frac{\delta m}{m}, \qquad
              n\,\delta K^* = -\frac{m\omega^2\,j\varphi T}{(T - 1)^2}

    and where it was measured relative to the base, R = T - 1, it is
    :math:`n\,\delta K^* = -m\omega^2\,j\varphi / R`: less below the resonance, more above.

    Parameters
    ----------
    frf : FRF
        Measured, any kind, a transmissibility too, relative or not.
    mass : float
        kg.
    seals : float
    mass_sd : float, optional
        kg; 1 % of the mass by default.
    phase_sd : float
        rad; one degree by default.
    band : (float, float), optional
        Lines to use, Hz.

    Raises
    ------
    DataError
        If mass or seals cannot be, or too few lines are left.
    """
    mass = convert_to_si(mass, "mass")
    mass_sd = convert_to_si(mass_sd, "mass")
    band = si_range(band, "frequency")
    require_positive(mass=mass, seals=seals)
    mass_sd = 0.01 * mass if mass_sd is None else mass_sd
    over_base = frf.quantity.over_base
    accelerance = frf.to(Kind.ACCELERANCE, mass=mass)
    accelerance = accelerance if band is None else accelerance.band(*band)
    accelerance = accelerance.only(accelerance.usable)
    s, value, scatter = accelerance.s, accelerance.value, accelerance.random_sd
    raw = s**2 / value
    K = (raw - mass * s**2) / seals
    by_phase, by_mass = -1j * raw / seals, -mass * s**2 / seals
    if over_base:  # the stiffness is proportional to the mass
        by_mass = K
    if frf.quantity is Kind.TRANSMISSIBILITY:  # the phase is that of T = 1 - m A
        by_phase = by_phase * (1 - 1 / (mass * value))
    random = np.zeros(len(s)) if scatter is None else scatter * np.abs(raw / value) / seals
    arrays = {
        "frequency": accelerance.frequency,
        "storage": K.real,
        "loss": K.imag,
        "damping": K.imag / s.imag,
        "loss_factor": K.imag / K.real,
        "storage_random": random,
        "loss_random": random,
        "by_mass": by_mass,
        "by_phase": by_phase,
    }
    stiffness = DynamicStiffness(
        **{name: make_readonly_copy(values) for name, values in arrays.items()},
        over_base=over_base,
        mass=float(mass),
        mass_sd=float(mass_sd),
        phase_sd=float(phase_sd),
        storage_band=(np.nan, np.nan),
        loss_band=(np.nan, np.nan),
        checks=(),
    )
    f, storage, loss = stiffness.frequency, stiffness.storage, stiffness.loss
    peak = find_peak(accelerance).frequency
    return replace(
        stiffness,
        storage_band=_find_band_around_peak(
            f, peak, stiffness.storage_sd <= STORAGE_LIMIT * np.abs(storage)
        ),
        loss_band=_find_band_around_peak(f, peak, stiffness.loss_sd <= LOSS_LIMIT * np.abs(loss)),
        checks=_check_causality(
            f, storage, loss, peak=peak, random=random, mass=stiffness.storage_mass
        ),
    )


def _find_band_around_peak(
    frequency: FloatArray, peak: float, is_usable: BoolArray
) -> tuple[float, float]:
    """Return the unbroken run of good lines about the peak."""
    peak_line = int(np.argmin(np.abs(frequency - peak)))
    if not is_usable[peak_line]:
        return float("nan"), float("nan")
    run = find_run(is_usable, peak_line)
    return float(frequency[run.start]), float(frequency[run.stop - 1])


def causal_loss_factor(frequency: FloatArray, storage: FloatArray, centre: float) -> float:
    r"""Loss factor that the rise of the storage stiffness implies (local Kramers-Kronig rule).

    .. math:: \tan\delta \approx \frac{\pi}{2} \frac{d \ln K'}{d \ln \omega}

    The slope is a straight line through ln K' over a factor of 1.6 to either side of
    `centre` Hz. Source: H. C. Booij and G. P. J. M. Thoone, Rheol. Acta 21 (1982).

    Raises
    ------
    DataError
        If fewer than 3 lines lie there.
    """
    slope, weights = _make_slope_weights(frequency, storage, centre)
    return float(np.pi / 2 * weights @ np.log(storage[slope]))


def _make_slope_weights(
    frequency: FloatArray, storage: FloatArray, centre: float
) -> tuple[BoolArray, FloatArray]:
    """Return the lines about `centre`, and their weights in the slope of a straight line."""
    is_near = (
        (frequency >= centre / SLOPE_BAND_FACTOR)
        & (frequency <= centre * SLOPE_BAND_FACTOR)
        & (storage > 0)
    )
    if np.count_nonzero(is_near) < 3:
        raise DataError(f"fewer than 3 lines about {centre:g} Hz: no slope of the stiffness there")
    x = np.log(frequency[is_near])
    weight = np.exp(-x)  # lines crowd at the upper end of a logarithmic axis
    x = x - weight @ x / weight.sum()
    return is_near, np.asarray(weight * x / (weight @ x**2))


def _check_causality(
    frequency: FloatArray,
    storage: FloatArray,
    loss: FloatArray,
    *,
    peak: float,
    random: FloatArray,
    mass: FloatArray,
) -> tuple[Check, ...]:
    """Return the check that loss and slope of the stiffness belong together, within errors."""
    try:
        slope, weights = _make_slope_weights(frequency, storage, peak)
    except DataError:
        return ()
    implied = causal_loss_factor(frequency, storage, peak)
    scatter = weights * random[slope] / storage[slope]
    tilt = float(weights @ (mass[slope] / storage[slope]))
    error = float(np.pi / 2 * np.hypot(np.linalg.norm(scatter), tilt))
    peak_line = int(np.argmin(np.abs(frequency - peak)))
    measured_loss_factor = float(loss[peak_line] / storage[peak_line])
    return (stiffness_causal(implied, measured_loss_factor, error=error, peak=peak),)
