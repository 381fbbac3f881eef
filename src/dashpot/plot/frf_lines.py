"""Lines of an FRF as they are drawn: their phase, and what lies between them."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.datamodel.frf import FRF


def wrap_phase(value: ComplexArray, lowest: float) -> FloatArray:
    """Phase in degrees within one turn from `lowest`."""
    return np.asarray((np.degrees(np.angle(value)) - lowest) % 360 + lowest)


def break_wrapped_phase(
    frequency: FloatArray, value: ComplexArray, lowest: float
) -> tuple[FloatArray, FloatArray]:
    """Phase in degrees from `lowest` up to a full turn more, broken by nan where it wraps."""
    degrees = wrap_phase(value, lowest)
    breaks = np.flatnonzero(np.abs(np.diff(degrees)) > 180) + 1
    return np.insert(frequency, breaks, np.nan), np.insert(degrees, breaks, np.nan)


def phase_axis(values: ComplexArray) -> tuple[float, tuple[float, ...]]:
    """Where the turn begins for all `values`, degrees, and the quarters that they use.

    From -180 as usual. Where that would cut through the data, from -90, as for the noise of an
    accelerance below its resonance, or from -270, as for a transmissibility above its own.
    """

    def cuts(lowest: float) -> int:
        return int(np.count_nonzero(np.abs(np.diff(wrap_phase(values, lowest))) > 180))

    often = bool(np.mean(np.abs(wrap_phase(values, -180.0)) > 165) > 0.02)
    lowest = min((-90.0, -270.0), key=cuts) if often else -180.0
    degrees = wrap_phase(values, lowest)
    first = 90 * np.floor((np.percentile(degrees, 1) + 20) / 90)
    last = 90 * np.ceil((np.percentile(degrees, 99) - 20) / 90)
    return lowest, tuple(np.arange(first, max(last, first + 90) + 1, 90).tolist())


_NEAR = 1e-4
"""Lines nearer than this part of their frequency are joined straight."""


def smooth(frf: FRF) -> tuple[FloatArray, ComplexArray]:
    """A predicted FRF on denser lines, densest near its peak; a measured one as it is.

    A sharp resonance between two lines is drawn round: not the FRF but its inverse is joined by
    straight lines, which is smooth where the FRF peaks (it is the dynamic mass m + K/s^2). Both
    sides of a jump stand too near for anything between.
    """
    dense_already = len(frf.frequency) > 2000 or len(frf.frequency) < 2
    if frf.averages > 0 or dense_already or bool((frf.value == 0).any()):
        return frf.frequency, frf.value
    size = np.abs(frf.value)
    parts = np.where(np.maximum(size[:-1], size[1:]) > 0.2 * size.max(), 24, 2)
    parts = np.where(np.diff(frf.frequency) < _NEAR * frf.frequency[1:], 1, parts)
    start = np.repeat(np.arange(len(parts)), parts)
    within = np.arange(len(start)) - np.repeat(np.cumsum(parts) - parts, parts)
    place = np.append(start + within / np.repeat(parts, parts), len(parts))
    lines = np.arange(len(size))
    inverse = 1 / frf.value
    real, imag = (np.interp(place, lines, part) for part in (inverse.real, inverse.imag))
    return np.interp(place, lines, frf.frequency), np.asarray(1 / (real + 1j * imag))


def half_power(value: ComplexArray) -> list[int]:
    """The lines nearest to the half-power points on either side of the largest magnitude."""
    size = np.abs(value)
    peak = int(np.argmax(size))
    target = size[peak] / np.sqrt(2)
    indices = []
    for side in (np.arange(peak, -1, -1), np.arange(peak, len(size))):
        below = np.flatnonzero(size[side] < target)
        if below.size:
            pair = side[max(below[0] - 1, 1) : below[0] + 1]  # never the peak itself
            indices.append(int(pair[np.argmin(np.abs(size[pair] - target))]))
    return sorted(indices)
