"""By how much the parameters of a fit follow what its rig may have added unseen."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.fitting.nuisance import delay_prior
from dashpot.records.relaxation import RampHold
from dashpot.solids.maxwell import GeneralizedMaxwell


def moved_by_clocks(tests: Sequence[RampHold], model: GeneralizedMaxwell) -> FloatArray:
    r"""Return what late forces add to the parameters of a solid fitted to holds, shape (p, 1).

    A hold that begins :math:`\delta` late has arms of :math:`k\,e^{\delta/\tau}`. The end of a ramp
    is as late as the clocks are apart, and as the encoder's step leaves it.
    """
    late = [
        np.hypot(
            delay_prior(test).sd, test.encoder_step / np.sqrt(12) * test.ramp_time / test.depth
        )
        for test in tests
    ]
    k, tau = np.asarray(model.k), np.asarray(model.tau)
    change = np.concatenate(([0.0], k / tau, np.zeros(len(k))))
    return np.asarray(np.sqrt(np.mean(np.square(late)) / len(tests)) * change)[:, None]
