"""From recorded hysteresis loops to an amplitude sweep: the first harmonic of each cycle."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.records.amplitude import AmplitudeSweep
from dashpot.records.relaxation import RelaxationTest

_LEAST = 12
"""Samples of a cycle."""
_STEADY = 0.05
"""Change of amplitude from a cycle to the next, relatively, in which a loop is closed."""


def sweep_of_loops(test: RelaxationTest) -> AmplitudeSweep:
    r"""Return stiffness and loss of every steady cycle of a harmonic motion.

    Cycles are cut where the displacement rises through its mean. Over each, force and
    displacement are fitted by a constant, a slope and :math:`e^{j\omega t}` of its own period:

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
            "each amplitude"
        )
    rows, last = [], np.nan
    for begin, end in pairwise(starts.tolist()):
        inside = (t >= begin) & (t < end)
        if np.count_nonzero(inside) < _LEAST:
            raise DataError(
                f"{np.count_nonzero(inside)} samples in a cycle of {end - begin:.3g} s; loops need "
                f"{_LEAST} or more"
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
        frequency, amplitude, storage, loss, "N/m", "m", test.specimen, test.source
    )


def _cycles(t: FloatArray, x: FloatArray) -> FloatArray:
    """Times at which the displacement rises through its running middle, s."""
    low, high = float(x.min()), float(x.max())
    # a loop may stand on a preload, and small ones follow large ones about the same middle
    middle = float(np.median(x)) if high > low else low
    above = x - middle
    turns = np.flatnonzero((above[:-1] < 0) & (above[1:] >= 0))
    share = above[turns] / (above[turns] - above[turns + 1])
    found = t[turns] + share * (t[turns + 1] - t[turns])
    if len(found) < 2:
        return found
    # noise at a slow crossing is no cycle
    kept = [found[0]]
    period = float(np.median(np.diff(found)))
    for one in found[1:]:
        if one - kept[-1] > period / 4:
            kept.append(one)
    return np.array(kept)


def _harmonics(t: FloatArray, signals: FloatArray, omega: float) -> tuple[complex, complex]:
    """First harmonics over one period, beside a constant and a slope."""
    phase = omega * (t - t[0])
    A = np.column_stack((np.ones_like(t), phase, np.cos(phase), -np.sin(phase)))
    found = np.linalg.lstsq(A, signals.T, rcond=None)[0]
    X1, F1 = found[2] + 1j * found[3]
    return complex(X1), complex(F1)
