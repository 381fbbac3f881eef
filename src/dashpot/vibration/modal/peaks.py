"""Highest peak of an FRF, by interpolation of its inverse."""

from __future__ import annotations

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import BoolArray, ComplexArray, FloatArray
from dashpot.base.errors import DataError
from dashpot.datamodel.frf import FRF, Kind

# Smallest and largest number of lines of the parabola.
MIN_LINES, MAX_LINES = 5, 31


@dataclass(frozen=True)
class Peak:
    """Peak of the accelerance.

    Attributes
    ----------
    frequency, height : float
        Hz and 1/kg, of the accelerance at s = j omega (an exponential window is undone).
    damping_ratio : float
        Damping ratio of the pole of the local parabola.
    frequency_se, damping_se : float
        Random standard errors, from the scatter of the lines or their standard deviation.
    half_power_lines : float
        How many lines fall into the half-power band; below about 5 the lines hide the peak.
    decay : float
        How far the free response has decayed at the end of the record, exp(-sigma T); 0 if
        the record is not known to be cut.
    """

    frequency: float
    height: float
    damping_ratio: float
    frequency_se: float
    damping_se: float
    half_power_lines: float
    decay: float


def find_run(mask: BoolArray, index: int) -> slice:
    """Return the unbroken run of True about an index."""
    gaps = np.flatnonzero(~mask)
    left_gaps, right_gaps = gaps[gaps < index], gaps[gaps > index]
    return slice(
        int(left_gaps[-1]) + 1 if left_gaps.size else 0,
        int(right_gaps[0]) if right_gaps.size else len(mask),
    )


def find_mount_band(
    frequency: FloatArray, accelerance: ComplexArray, sd: FloatArray | None = None
) -> tuple[float, float]:
    """Two octaves to either side of where a block on its mounts moves most, Hz.

    The receptance has its highest peak there; lines that are mostly noise are passed over, and so
    is the rise of noise towards 0 Hz, which is no peak.
    """
    receptance = np.abs(accelerance) / np.maximum(frequency, 1e-12) ** 2
    is_candidate = frequency > 2 * frequency[0] if len(frequency) > 8 else frequency > 0
    if sd is not None:
        is_quiet = is_candidate & (sd < 0.3 * np.abs(accelerance))
        is_candidate = is_quiet if is_quiet.sum() >= 8 else is_candidate
    is_inner = np.zeros(len(frequency), dtype=bool)
    is_inner[1:-1] = (receptance[1:-1] >= receptance[:-2]) & (receptance[1:-1] >= receptance[2:])
    best, peak_frequency = 0.0, None
    for i in np.flatnonzero(is_inner & is_candidate)[
        np.argsort(-receptance[is_inner & is_candidate])
    ][:20]:
        is_nearby = (frequency > frequency[i] / 2) & (frequency < frequency[i] * 2)
        if receptance[i] > 3 * np.median(receptance[is_nearby]) and receptance[i] > best:
            best, peak_frequency = float(receptance[i]), float(frequency[i])
    if peak_frequency is None:  # a heavily damped mode hardly peaks; its mobility does best
        mobility = np.where(is_candidate, np.abs(accelerance) / np.maximum(frequency, 1e-12), 0.0)
        peak_frequency = float(frequency[np.argmax(mobility)])
    return max(peak_frequency / 4, float(frequency[0])), min(
        peak_frequency * 4, float(frequency[-1])
    )


def find_peak(frf: FRF) -> Peak:
    r"""Find the highest peak of the accelerance, between the lines if need be.

    Where a response peaks, its inverse, the dynamic stiffness
    :math:`D(s) = m s^2 + K(s)`, is smooth. A parabola in s laid through D on the lines about the
    highest one gives the peak of :math:`|s^2/D|` on s = j omega and, as its root, the pole, even
    where the peak is narrower than the line spacing; no response value is interpolated.

    Raises
    ------
    DataError
        If fewer than 5 lines can be used.
    """
    accelerance = frf.to(Kind.ACCELERANCE)
    keep = accelerance.usable
    if np.count_nonzero(keep) < MIN_LINES:
        raise DataError(
            f"{np.count_nonzero(keep)} usable lines between {frf.frequency[0]:g} and "
            f"{frf.frequency[-1]:g} Hz; a peak needs at least {MIN_LINES}: widen the band"
        )
    s, value = accelerance.s[keep], accelerance.value[keep]
    sd = accelerance.random_sd
    relative = None if sd is None else sd[keep] / np.abs(value)
    lines = _select_peak_lines(np.abs(value))
    local = None if relative is None else relative[lines]
    return _fit_parabola(s[lines], s[lines] ** 2 / value[lines], local, frf)


def _select_peak_lines(height: FloatArray) -> slice:
    """Return the lines of the half-power band, widened to the fewest that hold a parabola."""
    peak_line = int(np.argmax(height))
    run = find_run(height > height[peak_line] / np.sqrt(2), peak_line)
    low = min(max(run.start, peak_line - MAX_LINES // 2), peak_line - MIN_LINES // 2)
    high = max(min(run.stop - 1, peak_line + MAX_LINES // 2), peak_line + MIN_LINES // 2)
    low = max(0, min(low, len(height) - MIN_LINES))
    high = min(len(height) - 1, max(high, MIN_LINES - 1))
    return slice(low, high + 1)


def _fit_parabola(
    s: ComplexArray, stiffness: ComplexArray, sd: FloatArray | None, frf: FRF
) -> Peak:
    centre = complex(np.mean(s))
    scale = float(np.ptp(s.imag)) / 2
    u = (s - centre) / scale
    # relative scatter is smallest where |D| is small: at the peak, where it matters
    weight = 1 / np.abs(stiffness) if sd is None else 1 / (np.abs(stiffness) * np.maximum(sd, 1e-9))
    basis = u[:, None] ** np.arange(3)
    rows = weight[:, None] * basis
    c = np.asarray(np.linalg.lstsq(rows, weight * stiffness, rcond=None)[0], dtype=complex)
    misfit = weight * (stiffness - basis @ c)
    dof = max(2 * len(s) - 6, 1)
    variance = float(np.sum(np.abs(misfit) ** 2)) / dof if sd is None else 1.0
    covariance = np.asarray(np.linalg.pinv(rows.conj().T @ rows), dtype=complex)

    first, last = float(s.imag[0]), float(s.imag[-1])
    omega = np.linspace(first, last, 2001)
    for _ in range(3):  # each pass looks 1000 times closer
        height = omega**2 / np.abs(_value(c, np.asarray((1j * omega - centre) / scale)))
        best = int(np.argmax(height))
        span = (omega[1] - omega[0]) * np.array([-1.0, 1.0])
        peak, peak_height = float(omega[best]), float(height[best])
        omega = np.linspace(max(first, peak + span[0]), min(last, peak + span[1]), 2001)
    pole = _compute_pole(c, centre, scale, peak)
    # off the axis, where the pole is, the parabola is known less well than on its lines
    scaled_pole = (pole - centre) / scale
    slope = abs(c[1] + 2 * c[2] * scaled_pole) / scale
    row = scaled_pole ** np.arange(3)
    error = np.sqrt(max(variance * float((row @ covariance @ row.conj()).real), 0.0)) / slope
    sigma = -pole.real
    step = float(np.median(np.diff(frf.frequency)))
    return Peak(
        frequency=peak / (2 * np.pi),
        height=peak_height,
        damping_ratio=float(sigma / abs(pole)),
        frequency_se=float(np.sqrt(variance))
        * _compute_peak_sd(c, covariance, peak, centre, scale)
        / (2 * np.pi),
        damping_se=float(error / peak),
        half_power_lines=float(abs(sigma) / np.pi / step),
        decay=0.0 if frf.record is None else float(np.exp(-(sigma + frf.shift) * frf.record)),
    )


def _compute_peak_sd(
    c: ComplexArray,
    coefficient_covariance: ComplexArray,
    peak: float,
    centre: complex,
    scale: float,
) -> float:
    r"""Return standard deviation of the peak, rad/s, for unit scatter of the rows.

    The peak is where :math:`g = \mathrm{Re}(\bar u u') = 0`, u = D/s^2, so it moves by
    :math:`-\delta g / g'`, and :math:`\delta g` is linear in the coefficients.
    """
    step = 1e-4 * peak
    omega = peak + step * np.array([-1.0, 0.0, 1.0])
    rows = ((1j * omega - centre) / scale)[:, None] ** np.arange(3) / (1j * omega[:, None]) ** 2
    u = rows @ c
    first, second_difference = (u[2] - u[0]) / (2 * step), (u[2] - 2 * u[1] + u[0]) / step**2
    curvature = abs(first) ** 2 + (np.conj(u[1]) * second_difference).real
    change = np.conj(first) * rows[1] + np.conj(u[1]) * (rows[2] - rows[0]) / (2 * step)
    peak_sd = float(np.sqrt(max((change @ coefficient_covariance @ change.conj()).real, 0.0)))
    return peak_sd / max(abs(float(curvature)), np.finfo(float).tiny)


def _value(c: ComplexArray, u: ComplexArray) -> ComplexArray:
    return np.asarray(c[0] + u * (c[1] + u * c[2]))


def _compute_pole(c: ComplexArray, centre: complex, scale: float, peak: float) -> complex:
    roots = centre + scale * np.roots(c[::-1])
    return complex(roots[np.argmin(np.abs(roots - 1j * peak))])
