"""Natural frequencies, damping ratios and residues of a measured FRF."""

from __future__ import annotations

from enum import StrEnum

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.errors import DataError
from dashpot.records.frf import Mode
from dashpot.vibration.modal.rational_fraction import Lines, find_poles


class Method(StrEnum):
    """How modes are found."""

    RATIONAL = "rational"  # rational fraction with the kernel of a finite record
    PEAK = "peak"  # parabola through the highest line
    HALF_POWER = "half-power"  # width of the peak at 1/sqrt(2) of its height
    CIRCLE = "circle"  # circle in the plane of the mobility
    DECREMENT = "decrement"  # logarithmic decrement of the impulse response


def find_modes(
    frequency: FloatArray,
    accelerance: ComplexArray,
    *,
    sd: FloatArray | None = None,
    record: float | None = None,
    pulse: float = 0.0,
    shift: float = 0.0,
    method: Method | str = Method.RATIONAL,
    band: tuple[float, float] | None = None,
    count: int | None = None,
) -> tuple[Mode, ...]:
    """Modes of a measured accelerance; see :meth:`dashpot.records.frf.FRF.modes`."""
    try:
        method = Method(method)
    except ValueError:
        raise DataError(
            f"method {method!r} is unknown; expected one of {', '.join(Method)}"
        ) from None
    low, high = band or mount_band(frequency, accelerance, sd)
    keep = (frequency >= low) & (frequency <= high) & (frequency > 0)
    if np.count_nonzero(keep) < 8:
        raise DataError(
            f"{np.count_nonzero(keep)} lines between {low:g} and {high:g} Hz; modes need at least "
            "8: widen the band or record longer"
        )
    lines = Lines.measured(
        frequency[keep],
        accelerance[None, keep],
        None if sd is None else sd[None, keep],
        record=record,
        pulse=pulse,
        shift=shift,
    )
    if method is Method.RATIONAL:
        return rational_modes(lines, count)
    if count not in (None, 1):
        raise DataError(f"method {method.value!r} reads one mode, not {count}; use 'rational'")
    return (_read(method, lines, None if sd is None else sd[keep]),)


def mount_band(
    frequency: FloatArray, accelerance: ComplexArray, sd: FloatArray | None = None
) -> tuple[float, float]:
    """Two octaves to either side of where a block on its mounts moves most, Hz.

    The receptance has its highest peak there; lines that are mostly noise are passed over, and so
    is the rise of noise towards 0 Hz, which is no peak.
    """
    receptance = np.abs(accelerance) / np.maximum(frequency, 1e-12) ** 2
    good = frequency > 2 * frequency[0] if len(frequency) > 8 else frequency > 0
    if sd is not None:
        quiet = good & (sd < 0.3 * np.abs(accelerance))
        good = quiet if quiet.sum() >= 8 else good
    inner = np.zeros(len(frequency), dtype=bool)
    inner[1:-1] = (receptance[1:-1] >= receptance[:-2]) & (receptance[1:-1] >= receptance[2:])
    best, centre = 0.0, None
    for i in np.flatnonzero(inner & good)[np.argsort(-receptance[inner & good])][:20]:
        near = (frequency > frequency[i] / 2) & (frequency < frequency[i] * 2)
        if receptance[i] > 3 * np.median(receptance[near]) and receptance[i] > best:
            best, centre = float(receptance[i]), float(frequency[i])
    if centre is None:  # a heavily damped mode hardly peaks; its mobility does best
        mobility = np.where(good, np.abs(accelerance) / np.maximum(frequency, 1e-12), 0.0)
        centre = float(frequency[np.argmax(mobility)])
    return max(centre / 4, float(frequency[0])), min(centre * 4, float(frequency[-1]))


def rational_modes(lines: Lines, count: int | None) -> tuple[Mode, ...]:
    """Modes by the rational fraction of :func:`.find_poles`, largest motion first."""
    fit = find_poles(lines, most=6, count=count)
    if fit is None:
        return ()
    # a window spreads each line's noise over its neighbours, which then count less
    spread = 1.0
    fall = 0.5 * float(lines.s.real[0]) * (lines.record or 0.0)
    if fall > 0:
        spread = float(np.sqrt(fall / np.tanh(fall)))
    se = np.sqrt(np.maximum(np.diag(fit.covariance), 0.0)) * spread
    number = len(fit.poles)
    modes = []
    for i, (p, residue) in enumerate(zip(fit.poles, fit.residues[0], strict=True)):
        residue_se = np.hypot(se[2 * number + 2 * i], se[2 * number + 2 * i + 1])
        errors = (float(se[2 * i]), float(se[2 * i + 1]), float(residue_se))
        modes.append(_mode(complex(p), complex(residue), errors, Method.RATIONAL))
    return tuple(sorted(modes, key=lambda mode: -abs(mode.residue)))


def _read(method: Method, lines: Lines, sd: FloatArray | None) -> Mode:
    from dashpot.vibration.modal import resonance

    s, value = lines.s, lines.value[0]
    if method is Method.DECREMENT:
        reading = resonance.read_decrement(s, value, lines.record)
    else:
        read = {
            Method.PEAK: resonance.read_peak,
            Method.HALF_POWER: resonance.read_half_power,
            Method.CIRCLE: resonance.read_circle,
        }[method]
        reading = read(s, value, sd)
    errors = (reading.sigma_se, reading.omega_se, reading.residue_se)
    return _mode(reading.pole, reading.residue, errors, method)


def _mode(p: complex, residue: complex, errors: tuple[float, float, float], method: Method) -> Mode:
    """Turn a pole and the accelerance's residue into a mode, errors of sigma and omega and all."""
    sigma_se, omega_se, residue_se = errors
    size = abs(p)
    return Mode(
        frequency=size / (2 * np.pi),
        damping_ratio=-p.real / size,
        residue=residue / p**2,
        frequency_se=float(np.hypot(p.imag * omega_se, p.real * sigma_se)) / size / (2 * np.pi),
        damping_ratio_se=float(np.hypot(p.imag * sigma_se, p.real * omega_se)) * p.imag / size**3,
        residue_se=residue_se / size**2,
        method=method.value,
    )
