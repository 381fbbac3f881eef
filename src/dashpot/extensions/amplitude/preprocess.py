"""Preparation of recorded hysteresis loops as an amplitude sweep, by first harmonics."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.polynomial import Polynomial

from dashpot.base import dataclass
from dashpot.base.arrays import ComplexArray, FloatArray, median
from dashpot.base.errors import DataError
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.relaxation import RelaxationTest
from dashpot.extensions.amplitude.datamodel import AmplitudeSweep

_LEAST = 12
"""Samples of a cycle."""
_STEADY = 0.05
"""Change of amplitude from a cycle to the next, relatively, in which a loop is closed."""
_ONE_TONE = 1.05
"""Cycles whose frequencies lie no farther apart than this factor were asked for at one."""
_CROSSED = 5.0
"""SD of the displacement's noise beyond which its sign is sure."""
_PASSES = 3


@dataclass(frozen=True, eq=False)
class HysteresisLoop:
    """Closed hysteresis loop: one steady cycle about its mean.

    Attributes
    ----------
    frequency : float
        Hz.
    amplitude : float
        Of the first harmonic of the displacement, m.
    stiffness : complex
        First harmonic of the force over that of the displacement, N/m.
    sd : float
        Of either part of that, from the scatter between neighbouring samples, N/m.
    displacement, force : array, shape (n,)
        As recorded, less their mean and drift, m and N.
    """

    frequency: float
    amplitude: float
    stiffness: complex
    sd: float
    displacement: FloatArray
    force: FloatArray


def sweep_of_loops(test: RelaxationTest, machine: Machine | None = None) -> AmplitudeSweep:
    r"""Return stiffness and loss of every steady cycle of a harmonic motion.

    As :func:`steady_cycles` finds them, :math:`K^* = F_1 / X_1`. Of the `machine` the `sync` is
    heeded.

    Raises
    ------
    DataError
        If there are fewer than two cycles, or too few samples in them.
    """
    machine = machine or Machine()
    machine.refuse_unused("sync", of="recorded loops")
    cycles = steady_cycles(test)
    K = np.array([cycle.stiffness for cycle in cycles])
    return AmplitudeSweep(
        np.array([cycle.frequency for cycle in cycles]),
        np.array([cycle.amplitude for cycle in cycles]),
        K.real,
        K.imag,
        "N/m",
        "m",
        test.specimen,
        test.source,
        np.array([cycle.sd for cycle in cycles]),
        machine.delay_sd(median(np.diff(test.time))),
        units="SI",
    )


def steady_cycles(test: RelaxationTest) -> tuple[HysteresisLoop, ...]:
    r"""Return every cycle of a harmonic motion whose loop has closed.

    Cycles are cut where the displacement, less its drift, rises through its middle. Over each,
    force and displacement, less their drift from the mean of the cycle before, are fitted by a
    constant and :math:`e^{j\omega t}`; of neighbouring frequencies omega is the median. A cycle
    counts where its amplitude is that of the one before within 5 %: the loop has closed.

    Raises
    ------
    DataError
        If there are fewer than two cycles, or too few samples in them.
    """
    t, signals = test.time, np.array([test.displacement, test.force])
    starts = _cycles(t, test.displacement)
    if len(starts) < 3:
        raise DataError(
            f"{max(len(starts) - 1, 0)} cycles of displacement found; loops need two or more at "
            "each amplitude; a ramp and a hold, or a creep test, is for dashpot fit"
        )
    tones, means = _tones(1 / np.diff(starts)), _means(t, signals, starts)
    loops, last = [], np.nan
    for i, (begin, end) in enumerate(pairwise(starts.tolist())):
        inside = (t >= begin) & (t < end)
        if np.count_nonzero(inside) < _LEAST:
            raise DataError(
                f"{np.count_nonzero(inside)} samples in a cycle of {end - begin:.3g} s; loops need "
                f"{_LEAST} or more; export more samples, or move slower"
            )
        within = t[inside] - (begin + end) / 2
        # what is higher than the first harmonic leaks into a slope fitted to one cycle
        drift = (means[:, i] - means[:, max(i - 1, 0)])[:, None] / (end - begin) * within
        x, F = signals[:, inside] - means[:, i, None] - drift
        X1, F1 = _harmonics(within, np.array((x, F)), 2 * np.pi * tones[i])
        size = float(abs(X1))
        if abs(size / last - 1) <= _STEADY:
            K = complex(F1 / X1)
            sd = _scatter(F - K.real * x) * np.sqrt(2 / len(x)) / size
            loops.append(HysteresisLoop(float(tones[i]), size, K, sd, x, F))
        last = size
    if not loops:
        raise DataError(
            "no two cycles that follow each other have one amplitude: hold each for some cycles"
        )
    return tuple(loops)


def _cycles(t: FloatArray, x: FloatArray) -> FloatArray:
    """Times at which the displacement, less its drift, rises through its middle, s."""
    drift = Polynomial.fit(t, x, 1)
    noise = _scatter(x)
    for _ in range(_PASSES):
        starts = _rises(t, x - drift(t), _CROSSED * noise)
        if len(starts) < 3:
            break
        rows = np.searchsorted(t, starts)
        count = np.diff(rows)
        means = np.add.reduceat(np.column_stack((t, x)), rows)[:-1] / count[:, None]
        # of whole cycles: a sine itself has a slope
        drift = Polynomial.fit(means[:, 0], means[:, 1], 1)
    return starts


def _scatter(x: FloatArray) -> float:
    """SD of the noise of samples, by their second differences."""
    return float(1.4826 * median(np.abs(np.diff(x, 2))) / np.sqrt(6))


def _rises(t: FloatArray, x: FloatArray, unsure: float) -> FloatArray:
    """Times at which x rises through its median; noise at a slow crossing is no cycle."""
    # a loop may stand on a preload, and small ones follow large ones about the same middle
    above = x - median(x)
    sure = np.abs(above) > unsure
    t, above = t[sure], above[sure]
    turns = np.flatnonzero((above[:-1] < 0) & (above[1:] > 0))
    share = above[turns] / (above[turns] - above[turns + 1])
    return np.asarray(t[turns] + share * (t[turns + 1] - t[turns]))


def _tones(frequency: FloatArray) -> FloatArray:
    """Return the frequency that each cycle was asked to have: neighbours share their median."""
    order = np.argsort(frequency)
    indices = np.flatnonzero(np.diff(np.log(frequency[order])) > np.log(_ONE_TONE))
    values = np.empty_like(frequency)
    for part in np.split(order, indices + 1):
        values[part] = median(frequency[part])
    return values


def _means(t: FloatArray, signals: FloatArray, starts: FloatArray) -> FloatArray:
    """Return mean of each signal over each cycle, shape (signals, cycles)."""
    steps = np.diff(t) * (signals[:, 1:] + signals[:, :-1]) / 2
    total = np.pad(np.cumsum(steps, axis=1), ((0, 0), (1, 0)))
    whole = np.array([np.interp(starts, t, item) for item in total])
    return np.asarray(np.diff(whole) / np.diff(starts))


def _harmonics(t: FloatArray, signals: FloatArray, omega: float) -> ComplexArray:
    """First harmonics over one period, beside a constant."""
    A = np.column_stack((np.ones_like(t), np.cos(omega * t), -np.sin(omega * t)))
    result = np.linalg.lstsq(A, signals.T, rcond=None)[0]
    return np.asarray(result[1] + 1j * result[2])
