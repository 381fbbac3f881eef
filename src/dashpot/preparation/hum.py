r"""Hum: lines of one frequency in the force, from the mains or the machine, and their aliases.

A line is no noise: it repeats, so it can be known. Over the hold, where the force is smooth, the
spectrum of the windowed force shows each as a peak far above its neighbourhood, and

.. math:: F_h(t) = a\cos 2\pi f t + b\sin 2\pi f t

follows from the windowed transform at its frequency; the frequency from the turn of its phase
between the two halves.
"""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import FloatArray, fast_length, turned_sum, wave
from dashpot.base.provenance import Step
from dashpot.base.units import written
from dashpot.records.relaxation import Hum

# a line stands out of its neighbourhood by this factor in power: white noise does so once in 1e8
_STANDS_OUT = 40.0
# bins of the neighbourhood on either side
_NEIGHBOURS = 40
# cycles per hold below which a line cannot be told from relaxation
_FEWEST_CYCLES = 20.0
_MOST_LINES = 8
_FEWEST_SAMPLES = 400
# a line below this part of the scatter does nothing
_TOO_SMALL = 0.02


def hum_lines(
    time: FloatArray, force: FloatArray, held: slice, *, noise: float
) -> tuple[tuple[Hum, ...], FloatArray]:
    """Return the lines of a force, the strongest first, and their sum at all times, N.

    Parameters
    ----------
    time : array, shape (m,)
        s, of the whole record.
    force : array, shape (n,)
        N, over the hold, whose clock is uniform.
    held : slice
        The hold.
    noise : float
        Scatter of the force from sample to sample, N.
    """
    n, everywhere, time = len(force), time, time[held]
    if n < _FEWEST_SAMPLES or noise == 0:
        return (), np.zeros(len(everywhere))
    step = (time[-1] - time[0]) / (n - 1)
    window = _hann(n)
    # a prime number of them takes ten times as long
    bins = fast_length(n)
    # the straight line between the ends leaks most
    rest = force - np.interp(time, time[[0, -1]], [force[:20].mean(), force[-20:].mean()])
    del force  # of a long record each array weighs beside the transform
    found: list[Hum] = []
    for _ in range(_MOST_LINES):
        windowed = window * rest
        at = _strongest(np.abs(np.fft.rfft(windowed, bins)) ** 2, int(np.ceil(_FEWEST_CYCLES)))
        if at is None:
            break
        frequency = _refined(rest, step, at / (bins * step))
        c = _transform(windowed, step, frequency) * 2 / window.sum()
        line = Hum(frequency, float(c.real), float(-c.imag), float(time[0]))
        if line.amplitude < _TOO_SMALL * noise:
            break
        found.append(line)
        rest -= line.force(time)
    total = np.zeros(len(everywhere))
    for line in found:
        total += line.force(everywhere)
    return tuple(found), total


def hum_step(lines: tuple[Hum, ...]) -> tuple[Step, ...]:
    """Return what was taken off, as a step of the preparation; nothing if nothing was."""
    if not lines:
        return ()
    listed = ", ".join(
        f"{written(line.amplitude, 'mN', '.3g')} at {line.frequency:.5g} Hz" for line in lines
    )
    parameters = tuple((f"{line.frequency:.6g} Hz", f"{line.amplitude:.6g} N") for line in lines)
    return (Step("hum", parameters, f"hum taken off the force: {listed}"),)


def _strongest(power: FloatArray, first: int) -> int | None:
    """The bin that stands out of its neighbourhood most, if any does."""
    if len(power) <= first + 2 * _NEIGHBOURS:
        return None
    blocks = len(power) // _NEIGHBOURS
    ordered = np.sort(power[: blocks * _NEIGHBOURS].reshape(blocks, _NEIGHBOURS), axis=1)
    level = ordered[:, _NEIGHBOURS // 2]
    # the median of the power of white noise is ln 2 of its mean
    about = np.interp(
        np.arange(len(power)), _NEIGHBOURS * (np.arange(blocks) + 0.5), level / np.log(2)
    )
    above = power / np.maximum(about, 1e-300)
    above[:first] = 0.0
    above[-2:] = 0.0
    at = int(np.argmax(above))
    return at if above[at] > _STANDS_OUT else None


def _refined(rest: FloatArray, step: float, frequency: float) -> float:
    """The frequency at which both halves have the same phase."""
    half = len(rest) // 2
    taper = _hann(half)
    for _ in range(3):
        first = _transform(taper * rest[:half], step, frequency)
        second = _transform(taper * rest[half : 2 * half], step, frequency)
        turn = np.angle(second * np.conj(first) * np.exp(-2j * np.pi * frequency * half * step))
        frequency += float(turn) / (2 * np.pi * half * step)
    return float(frequency)


def _transform(values: FloatArray, step: float, frequency: float) -> complex:
    return turned_sum(values, -2 * np.pi * frequency * step)


def _hann(count: int) -> FloatArray:
    """Hann's window, as numpy.hanning makes it with a cosine for each sample."""
    return 0.5 - wave(count, 2 * np.pi / (count - 1), 0.5)
