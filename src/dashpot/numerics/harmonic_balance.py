"""Newton's method with halved steps, and cycles between harmonics and samples."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray


class AlternatingFrequencyTime:
    r"""Transform of a cycle between harmonics and samples (AFT).

    Harmonics are of :math:`c_0 + \operatorname{Re} \sum_h c_h e^{jh\varphi}`.
    """

    def __init__(self, harmonics: Sequence[int], samples: int) -> None:
        h = np.asarray(harmonics)
        phase = 2 * np.pi * np.arange(samples) / samples
        self.turn = np.exp(1j * np.outer(h, phase))
        self.back = np.where(h == 0, 1.0, 2.0)[:, None] / samples * self.turn.conj()

    def path(self, harmonics: ComplexArray) -> FloatArray:
        """Samples, shape (n,) or (p, n), of harmonics, shape (h,) or (h, p)."""
        return np.asarray((harmonics.T @ self.turn).real)

    def harmonics_of(self, path: FloatArray) -> ComplexArray:
        """Return the way back."""
        return np.asarray(self.back @ path.T)


_Unknown = TypeVar("_Unknown", FloatArray, ComplexArray)


def find_root_by_newton(
    residual: Callable[[_Unknown], _Unknown],
    step: Callable[[_Unknown, _Unknown], _Unknown],
    start: _Unknown,
    *,
    size: float,
    max_steps: int = 60,
) -> _Unknown | None:
    """Newton's descent, its steps halved where they do not help; None short of an answer.

    `step` is the step, to be taken off, of an unknown and its residual; `size` that of what is
    balanced, `max_steps` the steps at most.
    """
    x, r = start, residual(start)
    for _ in range(max_steps):
        if np.abs(r).max() <= 1e-12 * size:
            return x
        full_step, step_fraction = step(x, r), 1.0
        trial = x - full_step
        remainder = residual(trial)
        while step_fraction > 1e-4 and np.abs(remainder).max() >= np.abs(r).max():
            step_fraction /= 2
            trial = x - step_fraction * full_step
            remainder = residual(trial)
        x, r = trial, remainder
    return x if np.abs(r).max() <= 1e-9 * size else None
