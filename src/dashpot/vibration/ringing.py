"""What still rings from an earlier blow, taken off as the free decay that it is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dashpot._arrays import ComplexArray, FloatArray
from dashpot.vibration.blows import GUARD, Blow

EXPLAINED = 0.5  # of the motion before the blow must be free decay to be taken off


def calm(blow: Blow, poles: Sequence[complex]) -> Blow:
    r"""Take off :math:`\sum_i \mathrm{Re}\,c_i e^{p_i t} + c_0`, fitted to what precedes the blow.

    A block that has not come to rest moves on as if nothing had struck it, and answers the blow on
    top of that. With the poles known, up to a second of record before the blow tells how.
    The blow is returned as it is if that explains less than half of the motion.
    """
    past = blow.past
    if past.shape[1] < 4 * (2 * len(poles) + 1) or not poles:
        return blow
    before = (np.arange(past.shape[1]) - past.shape[1] - GUARD) / blow.rate
    basis = _decays(before, np.array(poles))
    c, *_ = np.linalg.lstsq(basis, past.T, rcond=1e-10)
    left = past.T - basis @ c
    if left.var() > (1 - EXPLAINED) * past.var():
        return blow
    after = (np.arange(len(blow.force)) - blow.onset) / blow.rate
    return replace(
        blow, acceleration=blow.acceleration - (_decays(after, np.array(poles)) @ c).T, calmed=True
    )


def _decays(t: FloatArray, poles: ComplexArray) -> FloatArray:
    waves = np.exp(np.outer(t, poles))
    return np.column_stack((waves.real, waves.imag, np.ones_like(t)))
