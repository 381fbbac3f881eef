r"""Hum: lines of one frequency in the force, from the mains or the machine, and their aliases.

A line is no noise: it repeats, so it can be known. Over the hold, where the force is smooth, the
spectrum of the windowed force shows each as a peak far above its neighbourhood, and

.. math:: F_h(t) = a\cos 2\pi f t + b\sin 2\pi f t

follows from the windowed transform at its frequency; the frequency from the turn of its phase
between the two halves.

A line that the plate has, too, is the answer of the seal to a servo that hunts: it stays, where a
stiffness explains its size. The mains that both channels pick up are larger than that.
"""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import (
    FloatArray,
    compute_single_dft,
    find_fast_length,
    make_cosine_sequence,
    median,
)
from dashpot.base.provenance import Step
from dashpot.base.units import format_quantity
from dashpot.datamodel.relaxation import Hum

# a line stands out of its neighbourhood by this factor in power: white noise does so once in 1e8
_STANDS_OUT = 40.0
# bins of the neighbourhood on either side
_NEIGHBOURS = 40
# cycles per hold below which a line cannot be told from relaxation
_FEWEST_CYCLES = 20.0
_MOST_LINES = 8
_FEWEST_SAMPLES = 400
# a line of the plate, looked for at one frequency, stands out by so much: by chance once in 1e5
_PLATE_STANDS_OUT = 12.0
# a seal answers a vibration with at most so many times its stiffness in the hold
_STIFFEST = 10.0
# a line below this part of the scatter does nothing
_TOO_SMALL = 0.02


def hum_lines(
    time: FloatArray,
    force: FloatArray,
    held: slice,
    *,
    noise: float,
    displacement: FloatArray | None = None,
) -> tuple[tuple[Hum, ...], FloatArray, bool]:
    """Return the lines of a force, the strongest first, and their sum at all times, N.

    And whether the force has lines that are its response to the plate.

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
    displacement : array, shape (n,), optional
        m, of the same samples: lines of the force that are its response are no hum.
    """
    n, everywhere, time = len(force), time, time[held]
    if n < _FEWEST_SAMPLES or noise == 0:
        return (), np.zeros(len(everywhere)), False
    step = (time[-1] - time[0]) / (n - 1)
    window = _hann(n)
    # a prime number of them takes ten times as long
    bins = find_fast_length(n)
    rest = _remove_trend(time, force)
    stiffest = 0.0
    if displacement is not None:
        stiffest = _STIFFEST * abs(force.mean() / (displacement.mean() or np.inf))
    del force  # of a long record each array weighs beside the transform
    hums: list[Hum] = []
    responds = False
    for _ in range(_MOST_LINES):
        windowed = window * rest
        at = _strongest(np.abs(np.fft.rfft(windowed, bins)) ** 2, int(np.ceil(_FEWEST_CYCLES)))
        if at is None:
            break
        frequency = _refine_frequency(rest, step, at / (bins * step))
        c = _transform(windowed, step, frequency) * 2 / window.sum()
        line = Hum(frequency, float(c.real), float(-c.imag), float(time[0]))
        if line.amplitude < _TOO_SMALL * noise:
            break
        if displacement is None or line.amplitude > stiffest * _plate_amplitude(
            _remove_trend(time, displacement), window, step, frequency
        ):
            hums.append(line)
        else:
            responds = True
        rest -= line.force(time)
    total = np.zeros(len(everywhere))
    for line in hums:
        total += line.force(everywhere)
    return tuple(hums), total, responds


def white_noise(time: FloatArray, values: FloatArray) -> float:
    r"""Return the standard deviation of the white noise of a channel over a hold, lines left out.

    The median of the power of a windowed spectrum is :math:`\ln 2\,\sigma^2 \sum w^2`, whatever
    lines stand in it.

    Parameters
    ----------
    time, values : array, shape (n,)
        On a uniform clock.
    """
    window = _hann(len(values))
    windowed = window * _remove_trend(time, values)
    power = np.abs(np.fft.rfft(windowed, find_fast_length(len(values)))) ** 2
    return float(np.sqrt(median(power) / np.log(2) / (window @ window)))


def _remove_trend(time: FloatArray, values: FloatArray) -> FloatArray:
    """A channel less the straight line between its ends, which leaks most."""
    ends = [values[:20].mean(), values[-20:].mean()]
    return np.asarray(values - np.interp(time, time[[0, -1]], ends))


def _plate_amplitude(
    change: FloatArray, window: FloatArray, step: float, frequency: float
) -> float:
    """The amplitude of a line of the plate's motion, m; 0 if it does not stand out."""
    windowed = window * change
    bins = find_fast_length(len(change))
    power = np.abs(np.fft.rfft(windowed, bins)) ** 2
    at = round(frequency * bins * step)
    low, high = max(at - _NEIGHBOURS, 1), at + _NEIGHBOURS + 1
    level = median(power[low:high]) / np.log(2)
    size = abs(_transform(windowed, step, frequency))
    # a motion without noise has lines of rounding alone
    rounding = 1e-12 * float(np.abs(change).max(initial=0.0)) * window.sum()
    stands_out = size**2 > _PLATE_STANDS_OUT * level and size > rounding
    return float(2 * size / window.sum()) if stands_out else 0.0


def hum_step(lines: tuple[Hum, ...]) -> tuple[Step, ...]:
    """Return what was taken off, as a step of the preparation; nothing if nothing was."""
    if not lines:
        return ()
    listed = ", ".join(
        f"{format_quantity(line.amplitude, 'mN', '.3g')} at {line.frequency:.5g} Hz"
        for line in lines
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


def _refine_frequency(rest: FloatArray, step: float, frequency: float) -> float:
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
    return compute_single_dft(values, -2 * np.pi * frequency * step)


def _hann(count: int) -> FloatArray:
    """Hann's window, as numpy.hanning makes it with a cosine for each sample."""
    return 0.5 - make_cosine_sequence(count, 2 * np.pi / (count - 1), 0.5)
