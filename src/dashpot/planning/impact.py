"""What an impact record must be: long enough for the mass to come to rest, soft enough to ring."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.planning.needs import Pulse, RecordNeed
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.vibration.modal.truncation import cut_accelerance, poles

# Trethewey and Cafeo 1992: six time constants leave less than 0.5 % error in the FRF
TIME_CONSTANTS = 6.0
LINES = 5.0
# places of the lines about the peak that are tried, as parts of a line
PLACES = 21


def mass_for_peak(model: GeneralizedMaxwell, frequency: float) -> float:
    r"""The mass that puts the peak of the accelerance at `frequency` Hz, kg.

    The peak of :math:`|s^2/(ms^2 + K)|` is where
    :math:`d/d\omega\,|m - K/\omega^2|^2 = 0`, linear in m:

    .. math:: m = \frac{\mathrm{Re}(\bar u' u)}{\mathrm{Re}\,u'}, \qquad u = K(j\omega)/\omega^2
    """
    omega = 2 * np.pi * frequency
    step = 1e-5 * omega
    w = np.array([omega - step, omega, omega + step])
    u = model.complex_stiffness(w) / w**2
    slope = (u[2] - u[0]) / (2 * step)
    return float((np.conj(slope) * u[1]).real / slope.real)


def record_need(model: GeneralizedMaxwell, mass: float, record: float | None) -> RecordNeed:
    """How long a record the ringing of this mass on this solid asks for."""
    ringing = poles(model, mass)
    pole = ringing[np.argmax(ringing.imag)]
    sigma = -float(pole.real)
    width = sigma / np.pi
    return RecordNeed(
        frequency=float(pole.imag) / (2 * np.pi),
        damping_ratio=float(sigma / abs(pole)),
        time_constant=1 / sigma,
        half_power_width=width,
        for_decay=TIME_CONSTANTS / sigma,
        for_lines=LINES / width,
        record=record,
        peak_error=None if record is None else _peak_error(model, mass, pole, record),
    )


def hammer_rows(
    model: GeneralizedMaxwell,
    mass: float,
    *,
    seals: float,
    lines: FloatArray,
    relative_sd: float,
) -> FloatArray:
    r"""Sensitivities of a hammer test in units of its scatter, shape (2n, p + 1).

    .. math:: \frac{\partial \ln A}{\partial K} = -\frac{n}{m s^2 + n K}, \qquad
              \frac{\partial \ln A}{\partial \ln m} = -\frac{m s^2}{m s^2 + n K}

    Columns are k_inf, k, ln tau of one seal, then ln m; `relative_sd` is that of real and
    imaginary part of each line.
    """
    s = 2j * np.pi * lines
    x = s[:, None] * np.asarray(model.tau)
    k = np.asarray(model.k)
    slope = np.column_stack((np.ones_like(s), x / (1 + x), k * x / (1 + x) ** 2))
    inverse = 1 / (mass * s**2 + seals * model.stiffness_at(s))
    columns = -np.column_stack((seals * slope, mass * s**2)) * inverse[:, None]
    return np.concatenate((columns.real, columns.imag)) / relative_sd


def _peak_error(model: GeneralizedMaxwell, mass: float, pole: complex, record: float) -> float:
    """Worst relative error of the highest line, over where the lines may lie."""
    near = 1j * (pole.imag - pole.real / 20 * np.arange(-40, 41))
    top = float(np.abs(near**2 / (mass * near**2 + model.stiffness_at(near))).max())
    step = 2 * np.pi / record
    offsets = np.linspace(-0.5, 0.5, PLACES)[:, None] * step + np.arange(-3, 4) * step
    s = 1j * np.maximum(pole.imag + offsets, step / 10)
    lines = np.abs(cut_accelerance(model, mass, s.ravel(), record)).reshape(s.shape)
    errors = lines.max(axis=1) / top - 1
    return float(errors[np.argmax(np.abs(errors))])


def half_sine(duration: float, at: float) -> Pulse:
    r"""The spectrum of a half-sine pulse of `duration` s.

    .. math:: \frac{|F(f)|}{|F(0)|} = \left|\frac{\cos \pi f T}{1 - (2 f T)^2}\right|
    """
    zero = 1.5 / duration

    def level(f: float) -> float:
        x = 2 * f * duration
        if abs(x - 1) < 1e-6:  # the removable singularity
            return float(np.pi / 4)
        return float(abs(np.cos(np.pi * x / 2) / (1 - x**2)))

    def falls_to(decibel: float) -> float:
        low, high = 0.0, zero
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (middle, high) if level(middle) > 10 ** (-decibel / 20) else (low, middle)
        return low

    tiny = float(np.finfo(float).tiny)
    return Pulse(
        duration=duration,
        level_db=float(20 * np.log10(max(level(at), tiny))),
        band_10db=falls_to(10.0),
        band_20db=falls_to(20.0),
        first_zero=zero,
    )
