"""Interpolation between levels of a variable, and its error."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray


class LevelWeights(NamedTuple):
    """Weights of the levels, shape (n,), of a parabola and of a straight line."""

    parabolic: FloatArray
    linear: FloatArray

    @property
    def difference(self) -> FloatArray:
        """Weights of parabola less line: the half width of the interpolation's error."""
        return self.parabolic - self.linear


def compute_level_weights(levels: FloatArray, position: float) -> LevelWeights:
    r"""Return the weights of levels at a place between the first and the last.

    The mean of the two parabolas through three neighbouring levels each, or the one parabola
    at an end: it passes through every level. Of two levels both weights are those of a line.

    Parameters
    ----------
    levels : array, shape (n,)
        Rising.
    position : float
    """
    n = len(levels)
    if n == 1:
        return LevelWeights(np.ones(1), np.ones(1))
    i = int(np.clip(np.searchsorted(levels, position, side="right") - 1, 0, n - 2))
    chord = np.zeros(n)
    part = (position - levels[i]) / (levels[i + 1] - levels[i])
    chord[i], chord[i + 1] = 1 - part, part
    firsts = [first for first in (i - 1, i) if first >= 0 and first + 3 <= n]
    if not firsts:
        return LevelWeights(chord, chord)
    curve = np.zeros(n)
    for first in firsts:
        curve[first : first + 3] += _compute_lagrange_weights(
            levels[first : first + 3], position
        ) / len(firsts)
    return LevelWeights(curve, chord)


def _compute_lagrange_weights(nodes: FloatArray, x: float) -> FloatArray:
    weights = np.ones(len(nodes))
    for j, node in enumerate(nodes):
        for other in np.delete(nodes, j):
            weights[j] *= (x - other) / (node - other)
    return weights
