"""Starting shifts of several temperatures: pairs of neighbours, chained."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.extensions.curves.superposition.checks import MIN_OVERLAP
from dashpot.extensions.curves.superposition.isotherms import Isotherm
from dashpot.extensions.curves.superposition.joint_spectrum import ShiftSearch, make_grid
from dashpot.numerics.least_squares import Problem

_LN10 = float(np.log(10.0))
_STEP, _MAX_SHIFT, _MIN_SHIFT = 0.2, 4.0, 0.3
"""Decades: grid of trial shifts, and the smallest and the largest end of that grid."""


def chain_shifts(pairs: Iterable[tuple[Problem, FloatArray]], reference: int) -> FloatArray:
    """Return ln a of each temperature, rising, 0 at the reference.

    Parameters
    ----------
    pairs : iterable of (Problem, array)
        Positive spectrum of each temperature and the next warmer one, whose theta is the decrease
        of ln a from the colder to the warmer; and the decreases to try.
    reference : int
    """
    chain = np.concatenate(([0.0], -np.cumsum([_find_best_shift(*pair) for pair in pairs])))
    return np.asarray(chain - chain[reference])


def _find_best_shift(problem: Problem, log_shifts: FloatArray) -> float:
    cost, is_best_interior = [], None
    for log_shift in log_shifts:
        optimum = problem.solve_linear(np.array([log_shift]), is_best_interior)
        is_best_interior = optimum.beta > 0
        cost.append(optimum.cost)
    return float(log_shifts[int(np.argmin(cost))])


def make_chained_starts(
    isotherms: Sequence[Isotherm], ln_b: FloatArray, reference: int
) -> FloatArray:
    """Return ln a of each isotherm, by rising temperature, 0 at the reference."""
    return chain_shifts(
        map(_make_trial_shifts, pairwise(isotherms), pairwise(ln_b.tolist())), reference
    )


def _make_trial_shifts(
    pair: tuple[Isotherm, Isotherm], ln_b: tuple[float, float]
) -> tuple[Problem, FloatArray]:
    shared = min(isotherm.window[1] - isotherm.window[0] for isotherm in pair) / _LN10
    max_decades = min(max(shared - MIN_OVERLAP, _MIN_SHIFT), _MAX_SHIFT)
    log_shifts = _LN10 * np.arange(0.0, max_decades + _STEP / 2, _STEP)
    # of all that are tried, so that each knows where the spectrum of the last had weight
    grid = make_grid((pair[0], *pair), np.array([log_shifts[-1], 0.0, 0.0]))
    search = ShiftSearch(pair, grid, np.array([0.0, 0.0, *ln_b]), np.array([0]))
    return search.problem, log_shifts
