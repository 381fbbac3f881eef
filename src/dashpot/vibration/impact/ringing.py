"""What still rings from an earlier hit, taken off as the free decay that it is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.vibration.impact.hits import GUARD, HitBlock

EXPLAINED = 0.5  # of the motion before the hit must be free decay to be taken off


def calm(hit: HitBlock, poles: Sequence[complex]) -> HitBlock:
    r"""Take off :math:`\sum_i \mathrm{Re}\,c_i e^{p_i t} + c_0`, fitted to what precedes the hit.

    A block that has not come to rest moves on as if nothing had struck it, and answers the hit on
    top of that. With the poles known, up to a second of record before the hit tells how.
    The hit is returned as it is if that explains less than half of the motion.
    """
    past = hit.past
    if past.shape[1] < 4 * (2 * len(poles) + 1) or not poles:
        return hit
    before = (np.arange(past.shape[1]) - past.shape[1] - GUARD) / hit.rate
    basis = _decays(before, np.array(poles))
    c, *_ = np.linalg.lstsq(basis, past.T, rcond=1e-10)
    left = past.T - basis @ c
    if left.var() > (1 - EXPLAINED) * past.var():
        return hit
    after = (np.arange(len(hit.force)) - hit.onset) / hit.rate
    return replace(
        hit, acceleration=hit.acceleration - (_decays(after, np.array(poles)) @ c).T, calmed=True
    )


def _decays(t: FloatArray, poles: ComplexArray) -> FloatArray:
    waves = np.exp(np.outer(t, poles))
    return np.column_stack((waves.real, waves.imag, np.ones_like(t)))
