"""What the readings of a prepared record leave in doubt."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from dashpot.records.relaxation import RampHold

MAX_CREEP = 0.01


def depth_doubt(test: RampHold) -> float:
    r"""Return the relative standard deviation of the depth that the encoder's step leaves.

    Depth is the difference of two readings, each uniform within one step q: :math:`q/\sqrt6`.
    """
    return encoder_step(test) / float(np.sqrt(6.0)) / test.depth


def encoder_step(test: RampHold) -> float:
    """Return the step of the displacement's readings, m; 0 if none shows.

    Noise beyond half a step dithers it away: readings then average to the truth.
    """
    step = test.displacement_quantum
    return 0.0 if test.displacement_noise > 0.5 * step else step


def hold_creep(test: RampHold) -> float:
    """Return the largest motion left in the hold, to its last tenth, as a part of the depth.

    Means over twelve stretches, each longer than the one before; the first fifth of a ramp time
    is left to the plate for settling.
    """
    x, t = test.displacement[test.hold], test.time[test.hold] - test.ramp_end
    edges = np.searchsorted(t, np.geomspace(0.2 * test.ramp_time, t[-1], 13))
    last = float(x[-max(1, len(x) // 10) :].mean())
    means = [x[a:b].mean() for a, b in pairwise(edges) if b > a]
    moved = [last - float(mean) for mean in means]
    return max(moved, key=abs, default=0.0) / test.depth
