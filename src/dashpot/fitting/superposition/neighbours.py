"""Where the shifts of a master curve start: each isotherm on its neighbour, chained."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.fitting.checks.temperature import OVERLAP
from dashpot.fitting.superposition.isotherms import Isotherm
from dashpot.fitting.superposition.joint_spectrum import grid_of, spectrum_at

_LN10 = float(np.log(10.0))
_STEP, _FARTHEST, _LEAST = 0.2, 4.0, 0.3


def chained_starts(isotherms: Sequence[Isotherm], ln_b: FloatArray, reference: int) -> FloatArray:
    """Return ln a of each isotherm, by rising temperature, 0 at the reference."""
    steps = [
        _step(pair, np.asarray(ln_b[i : i + 2]))
        for i, pair in enumerate(pairwise(isotherms))
    ]  # fmt: skip
    chain = np.concatenate(([0.0], -np.cumsum(steps)))
    return np.asarray(chain - chain[reference])


def _step(pair: tuple[Isotherm, Isotherm], ln_b: FloatArray) -> float:
    """Return by how much ln a falls from an isotherm to the next warmer one."""
    cold, warm = pair
    shared = min(one.window[1] - one.window[0] for one in pair) / _LN10
    farthest = min(max(shared - OVERLAP, _LEAST), _FARTHEST)
    trials = _LN10 * np.arange(0.0, farthest + _STEP / 2, _STEP)
    sse = []
    for ln_a in trials:
        at = np.array([ln_a, 0.0])
        residual = spectrum_at((cold, warm), at, ln_b, grid_of((cold, warm), at))[2]
        sse.append(float(residual @ residual))
    return float(trials[int(np.argmin(sse))])
