"""What a quantised encoder saw, between its counts."""

from __future__ import annotations

import numpy as np

from dashpot._arrays import FloatArray


def between_counts(time: FloatArray, displacement: FloatArray) -> FloatArray:
    """Return a quantised displacement as the motion that it samples, shape (n,).

    Where a reading changes, the true position is half way between both counts, so a straight
    line from change to change is much nearer to the truth than the staircase. On a reading that
    stays for longer than the motion takes to cross a count, the reading itself is the better
    guess. A fast arm answers each edge of a staircase with a spike that the force does not show:
    taken at its word, the staircase would rule out arms that are there.
    """
    change = np.flatnonzero(np.diff(displacement))
    if len(change) < 2:
        return displacement
    at = 0.5 * (time[change] + time[change + 1])
    half_way = 0.5 * (displacement[change] + displacement[change + 1])
    stay = np.diff(at)
    crossing = float(np.median(stay))
    # readings before the first change, between changes, and after the last one
    level = displacement[np.append(change, change[-1] + 1)]
    start = np.append(-np.inf, at)
    stop = np.append(at, np.inf)
    long = stop - start > 4 * crossing
    # the motion leaves and reaches a rest as slowly as it crossed the neighbouring count
    before = np.minimum(np.concatenate(([crossing], stay, stay[-1:])), 2 * crossing) / 2
    after = np.minimum(np.concatenate((stay[:1], stay, [crossing])), 2 * crossing) / 2
    leaves = np.maximum(start[long], time[0] - 1) + np.where(
        np.isfinite(start[long]), before[long], 0
    )
    reaches = np.minimum(stop[long], time[-1] + 1) - np.where(
        np.isfinite(stop[long]), after[long], 0
    )
    knots = np.concatenate((at, leaves, reaches))
    values = np.concatenate((half_way, level[long], level[long]))
    order = np.argsort(knots, kind="stable")
    return np.asarray(np.interp(time, knots[order], values[order]))
