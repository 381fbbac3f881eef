"""Mode of a single resonance by the classical methods: peak, half power, circle and decrement.

They read the highest peak and take no account of a record that was cut: a truncated decay reads as
damping. With an exponential window they see the pole :math:`p - a`; the a is added back, which is
exact, since the window moves the poles of any linear solid by that much.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import BoolArray, ComplexArray, FloatArray
from dashpot.base.errors import FitError
from dashpot.datamodel.frf import FRF, Mode
from dashpot.numerics.inference.covariance_estimate import estimate, white_noise
from dashpot.numerics.least_squares import solve_ordinary
from dashpot.vibration.modal.modal_methods import Method, make_mode
from dashpot.vibration.modal.peaks import find_run

MIN_HALF_POWER_LINES = 5  # in the half-power band, for its width to be read
HALF_POWER_RATIO = np.sqrt(0.5)


def read_resonance(method: Method, frf: FRF) -> Mode:
    """Return the mode of the highest peak of accelerances, read by a method of one resonance."""
    if method is Method.DECREMENT:
        reading = _fit_decrement(frf.s, frf.value, frf.record)
    else:
        read = {
            Method.PEAK: _find_peak,
            Method.HALF_POWER: _find_half_power_width,
            Method.CIRCLE: _fit_circle,
        }[method]
        reading = read(frf.s, frf.value, frf.sd)
    errors = (reading.sigma_se, reading.omega_se, reading.residue_se)
    return make_mode(reading.pole, reading.residue, errors, method)


@dataclass(frozen=True)
class _Reading:
    """A pole, the residue of the accelerance there, and standard errors (nan where unknown).

    `sigma_se` and `omega_se` belong to -Re p and Im p.
    """

    pole: complex
    residue: complex
    sigma_se: float
    omega_se: float
    residue_se: float


def _find_peak(s: ComplexArray, accelerance: ComplexArray, sd: FloatArray | None) -> _Reading:
    r"""Parabola through the lines above half power, three at least.

    For one viscously damped mode :math:`|F/X|^2` is a parabola in :math:`\omega^2`,

    .. math:: m^2 \left[(\omega^2 - \omega_0^2 + 2\sigma^2)^2
              + 4\sigma^2 (\omega_0^2 - \sigma^2)\right]

    so its lowest point gives the frequency and the height there the damping.

    Raises
    ------
    FitError
        If the parabola has no lowest point above zero: the peak falls between the lines.
    """
    top = _find_highest_line(accelerance)
    is_near_peak = np.zeros(len(s), dtype=bool)
    is_near_peak[
        find_run(np.abs(accelerance) > HALF_POWER_RATIO * np.abs(accelerance[top]), top)
    ] = True
    is_near_peak[top - 1 : top + 2] = True

    def poles(value: ComplexArray) -> tuple[complex, complex]:
        x = s[is_near_peak].imag ** 2
        y = np.abs(s[is_near_peak] ** 2 / value[is_near_peak]) ** 2
        centre, scale = float(s[top].imag ** 2), float(np.ptp(x))
        a, b, c = np.polyfit((x - centre) / scale, y / y.min(), 2, w=y.min() / y)
        depth = float(c / a - (0.5 * b / a) ** 2) * scale**2 if a > 0 else 0.0
        if depth <= 0:
            raise FitError(
                f"the lines about {s[top].imag / (2 * np.pi):.5g} Hz miss the peak between them, "
                "so its damping cannot be read there; record longer, or fit its poles "
                "(Python: method='rational')"
            )
        lowest = centre - 0.5 * float(b / a) * scale
        # lowest = omega_d^2 - sigma^2, depth = 4 sigma^2 omega_d^2
        omega2 = 0.5 * (lowest + np.sqrt(lowest**2 + depth))
        pole = complex(-np.sqrt(depth / omega2) / 2, np.sqrt(omega2))
        return pole, complex(value[top] * (1j * s[top].imag - pole))

    return _read_with_errors(poles, s, accelerance, sd, is_near_peak)


def _find_half_power_width(
    s: ComplexArray, accelerance: ComplexArray, sd: FloatArray | None
) -> _Reading:
    r"""Width of the peak at :math:`1/\sqrt2` of its height: :math:`\sigma = \pi \Delta f`.

    Raises
    ------
    FitError
        If fewer than 5 lines lie in that width: the peak would lie between them.
    """
    top = _find_highest_line(accelerance)
    omega = s.imag
    lines, low, high = _find_peak_width(omega, accelerance, top)
    if lines < MIN_HALF_POWER_LINES:
        step = float(np.median(np.diff(omega))) / (2 * np.pi)
        width = max((high - low) / (2 * np.pi), step)
        raise FitError(
            f"half-power damping needs at least {MIN_HALF_POWER_LINES} lines in the half-power "
            f"band, but only {lines}, {step:.3g} Hz apart, lie there about "
            f"{omega[top] / (2 * np.pi):.5g} Hz; record "
            f"{MIN_HALF_POWER_LINES / width:.2g} s at the least, or fit its poles "
            "(Python: method='rational')"
        )

    def poles(value: ComplexArray) -> tuple[complex, complex]:
        _, left_frequency, right = _find_peak_width(omega, value, top)
        centre = _find_peak(s, value, None).pole.imag
        pole = complex(-0.5 * (right - left_frequency), centre)
        return pole, complex(value[top] * (1j * omega[top] - pole))

    in_band = (omega > low - (high - low)) & (omega < high + (high - low))
    return _read_with_errors(poles, s, accelerance, sd, in_band)


def _fit_circle(s: ComplexArray, accelerance: ComplexArray, sd: FloatArray | None) -> _Reading:
    r"""Circle of the mobility in the Nyquist plane.

    Near a resonance the mobility :math:`Y = R/(s - p) + Y_0` maps the frequency axis onto a circle.
    The three complex numbers of that map solve :math:`s Y = p Y + Y_0 s + (R - p Y_0)` in least
    squares over the lines above 0.4 of the peak, weighted anew by :math:`1/|s - p|` until p stays.
    """
    top = _find_highest_line(accelerance)
    magnitude = np.abs(accelerance)
    is_near_peak = np.zeros(len(s), dtype=bool)
    is_near_peak[find_run(magnitude > 0.4 * magnitude[top], top)] = True
    is_near_peak[max(top - 2, 0) : top + 3] = True

    def poles(value: ComplexArray) -> tuple[complex, complex]:
        x, y = 1j * s[is_near_peak].imag, value[is_near_peak] / s[is_near_peak]
        weight = np.ones(len(x))
        p = 1j * s[top].imag
        for _ in range(10):
            rows = np.column_stack((y, x, np.ones_like(x))) * weight[:, None]
            scale = np.linalg.norm(rows, axis=0)
            c = np.linalg.lstsq(rows / scale, weight * x * y, rcond=None)[0] / scale
            p = complex(c[0])
            weight = 1 / np.abs(x - p)
        return p, complex((c[2] + p * c[1]) * (p + s[0].real))

    return _read_with_errors(poles, s, accelerance, sd, is_near_peak)


def _fit_decrement(s: ComplexArray, accelerance: ComplexArray, record: float | None) -> _Reading:
    r"""Logarithmic decrement of the impulse response about the peak.

    The lines about the peak, faded out to either side and transformed back, are the analytic
    impulse response :math:`R e^{pt}`: the slope of its logarithm is the pole. Its ends, where
    the fading rings, are omitted, and so is what has decayed to a thirtieth.
    """
    omega, top = s.imag, _find_highest_line(accelerance)
    step = float(np.median(np.diff(omega)))
    if np.abs(np.diff(omega) - step).max() > 1e-3 * step:
        raise FitError("the logarithmic decrement needs evenly spaced lines")
    period = 2 * np.pi / step
    length = min(record or period, period)
    _, low, high = _find_peak_width(omega, accelerance, top)
    half_range = min(0.5 * omega[top], max(4 * (high - low), 8 * np.pi / length))
    taper = np.cos(0.5 * np.pi * np.clip((omega - omega[top]) / half_range, -1, 1)) ** 2
    edge = 2 * np.pi / half_range
    # one sample each time the faded band can bring something new
    t = np.arange(edge, length - edge, edge / 4)
    if len(t) < 6:
        raise FitError(
            f"a record of {length:.3g} s is too short for a logarithmic decrement at "
            f"{omega[top] / (2 * np.pi):.4g} Hz; fit its poles (Python: method='rational')"
        )
    h = np.exp(1j * np.outer(t, omega)) @ (taper * accelerance) * step / (2 * np.pi)
    size = np.abs(h)
    t, h, size = t[size > size[0] / 30], h[size > size[0] / 30], size[size > size[0] / 30]
    turning = np.unwrap(np.angle(h * np.exp(-1j * omega[top] * t)))
    rows = np.column_stack((t, np.ones_like(t))) * size[:, None]
    fits = [solve_ordinary(size * y, rows) for y in (np.log(size), turning)]
    (slope, start), (phase_slope, phase) = (fit.beta for fit in fits)
    # neighbours share four samples' worth of band
    noises = [white_noise(fit, 4 * fit.sse / max(len(t) / 4 - 2, 1)) for fit in fits]
    errors = [
        float(estimate(fit, noises=[noise]).standard_error[0])
        for fit, noise in zip(fits, noises, strict=True)
    ]
    p = complex(slope, omega[top] + phase_slope)
    # the fading lets through, of e^{pt}, its own value at p
    let_through = 0.5 * (1 + np.cos(np.pi * (p / 1j - omega[top]) / half_range))
    residue = complex(np.exp(start + 1j * phase) / let_through)
    return _Reading(p + s[0].real, residue, errors[0], errors[1], float("nan"))


def _find_highest_line(accelerance: ComplexArray) -> int:
    magnitude = np.abs(accelerance)
    peak_index = int(np.argmax(magnitude))
    if not 0 < peak_index < len(magnitude) - 1:
        raise FitError("the highest line stands at the edge of the band; widen the band")
    return peak_index


def _find_peak_width(omega: FloatArray, value: ComplexArray, top: int) -> tuple[int, float, float]:
    """Return lines above half power, and where the power falls to a half of its peak, rad/s.

    Between lines 1/|A|^2 is taken as straight, its lowest point from a parabola.
    """
    y = 1 / np.abs(value) ** 2
    x = (omega[top - 1 : top + 2] - omega[top]) / (omega[top + 1] - omega[top])
    a, b, c = np.polyfit(x, y[top - 1 : top + 2], 2)
    level = 2 * (c - 0.25 * b**2 / a if a > 0 else y[top])
    run_inside = find_run(y < level, top)
    i, j = run_inside.start, run_inside.stop - 1
    low, high = float(omega[i]), float(omega[j])
    if i > 0:
        low -= float((level - y[i]) / (y[i - 1] - y[i]) * (omega[i] - omega[i - 1]))
    if j < len(omega) - 1:
        high += float((level - y[j]) / (y[j + 1] - y[j]) * (omega[j + 1] - omega[j]))
    return j - i + 1, low, high


def _read_with_errors(
    poles: Callable[[ComplexArray], tuple[complex, complex]],
    s: ComplexArray,
    value: ComplexArray,
    sd: FloatArray | None,
    used_lines: slice | BoolArray,
) -> _Reading:
    """Read once, and once more for each line and part moved by its own error."""
    p, residue = poles(value)
    if sd is None:
        nan = float("nan")
        return _Reading(p + s[0].real, residue, nan, nan, nan)
    sums = np.zeros(3)
    for i in np.arange(len(s))[used_lines]:
        for direction in (1.0, 1j):
            shift = value.copy()
            shift[i] += 1e-3 * sd[i] * direction
            q, r = poles(shift)
            change = np.array([q.real - p.real, q.imag - p.imag, abs(r - residue)]) / 1e-3
            sums += change**2
    sigma_se, omega_se, residue_se = np.sqrt(sums)
    return _Reading(p + s[0].real, residue, float(sigma_se), float(omega_se), float(residue_se))
