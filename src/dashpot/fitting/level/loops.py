"""From recorded hysteresis loops to an amplitude sweep: the first harmonic of each cycle."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.polynomial import Polynomial

from dashpot.base.arrays import FloatArray, median
from dashpot.base.errors import DataError
from dashpot.records.amplitude import AmplitudeSweep
from dashpot.records.relaxation import RelaxationTest

_LEAST = 12
"""Samples of a cycle."""
_STEADY = 0.05
"""Change of amplitude from a cycle to the next, relatively, in which a loop is closed."""
_ONE_TONE = 1.05
"""Cycles whose frequencies lie no farther apart than this factor were asked for at one."""
_CROSSED = 5.0
"""SD of the displacement's noise beyond which its sign is sure."""
_PASSES = 3


def sweep_of_loops(test: RelaxationTest) -> AmplitudeSweep:
    r"""Return stiffness and loss of every steady cycle of a harmonic motion.

    Cycles are cut where the displacement, less its drift, rises through its middle. Over each,
    force and displacement are fitted by a constant, a slope and :math:`e^{j\omega t}` of its own
    period:

    .. math:: K^* = F_1 / X_1

    A cycle counts where its amplitude is that of the one before within 5 %: the loop has closed.

    Raises
    ------
    DataError
        If there are fewer than two cycles, or too few samples in them.
    """
    t, x, F = test.time, test.displacement, test.force
    starts = _cycles(t, x)
    if len(starts) < 3:
        raise DataError(
            f"{max(len(starts) - 1, 0)} cycles of displacement found; loops need two or more at "
            "each amplitude; a ramp and a hold, or a creep test, is for dashpot fit"
        )
    rows, last = [], np.nan
    for begin, end in pairwise(starts.tolist()):
        inside = (t >= begin) & (t < end)
        if np.count_nonzero(inside) < _LEAST:
            raise DataError(
                f"{np.count_nonzero(inside)} samples in a cycle of {end - begin:.3g} s; loops need "
                f"{_LEAST} or more; export more samples, or move slower"
            )
        X1, F1 = _harmonics(t[inside], np.array([x[inside], F[inside]]), 2 * np.pi / (end - begin))
        size = abs(X1)
        if abs(size / last - 1) <= _STEADY:
            K = F1 / X1
            rows.append((1 / (end - begin), size, K.real, K.imag))
        last = size
    if not rows:
        raise DataError(
            "no two cycles that follow each other have one amplitude: hold each for some cycles"
        )
    frequency, amplitude, storage, loss = np.array(rows).T
    return AmplitudeSweep(
        _tones(frequency), amplitude, storage, loss, "N/m", "m", test.specimen, test.source
    )


def _cycles(t: FloatArray, x: FloatArray) -> FloatArray:
    """Times at which the displacement, less its drift, rises through its middle, s."""
    drift = Polynomial.fit(t, x, 1)
    noise = 1.4826 * median(np.abs(np.diff(x, 2))) / np.sqrt(6)
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
    """The frequency that each cycle was asked to have: neighbours share their median."""
    order = np.argsort(frequency)
    apart = np.flatnonzero(np.diff(np.log(frequency[order])) > np.log(_ONE_TONE))
    found = np.empty_like(frequency)
    for part in np.split(order, apart + 1):
        found[part] = median(frequency[part])
    return found


def _harmonics(t: FloatArray, signals: FloatArray, omega: float) -> tuple[complex, complex]:
    """First harmonics over one period, beside a constant and a slope."""
    phase = omega * (t - t[0])
    A = np.column_stack((np.ones_like(t), phase, np.cos(phase), -np.sin(phase)))
    found = np.linalg.lstsq(A, signals.T, rcond=None)[0]
    X1, F1 = found[2] + 1j * found[3]
    return complex(X1), complex(F1)
