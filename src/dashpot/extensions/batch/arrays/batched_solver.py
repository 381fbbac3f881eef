r"""Batched solver: least-squares fits of thousands of records with one sampling.

The computation of one record, for a stack of records at once: compression is a matrix product, a
start is the best of all sets of grid points (:class:`.GridSearch`), and every step of the descent
is arithmetic on small matrices, one per record. Where a relaxation time is not known to 10 %, other
peaks of the grid search are descended from too; whatever leaves another doubt (an arm at the edge
of the window, a coefficient that is not positive) is solved again one by one, so that the result is
that of :func:`dashpot.numerics.exponential_fit.solve`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import BoolArray, EqualByValue, FloatArray, IndexArray
from dashpot.base.errors import FitError
from dashpot.extensions.batch.arrays.grid_search import POINTS, GridSearch
from dashpot.extensions.batch.arrays.shared_sampling import ReducedRecords, SharedSampling
from dashpot.extensions.batch.arrays.simultaneous_descent import descend_together, evaluate_trials
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.design_matrices.data_compression import MIN_REMAINDER_SHARE
from dashpot.numerics.exponential_fit import MAX_LN_TAU_SD, Solution, solve
from dashpot.numerics.log_tau_descent import StackTrial

CHUNK = 128
#: further peaks of the grid search that are tried where a relaxation time is not well known
RIVALS = 3


@dataclass(frozen=True, eq=False)
class ManySolutions(EqualByValue):
    """Optima of many records; rows without a solution hold NaN.

    Attributes
    ----------
    log_tau, arms : array, shape (R, N)
        Ascending in tau; NaN beyond `order`.
    fixed_coefficients : array, shape (R, q)
    sse : array, shape (R,)
    order : int array, shape (R,)
        Arms found; -1 where nothing was fitted.
    is_finite, converged, at_bound : bool array, shape (R,)
        Samples and the sum of their squares are finite; the gradient vanished inside the
        window; an arm sits at its edge.
    """

    log_tau: FloatArray
    arms: FloatArray
    fixed_coefficients: FloatArray
    sse: FloatArray
    order: IndexArray
    is_finite: BoolArray
    converged: BoolArray
    at_bound: BoolArray


def solve_many(family: SharedSampling, records: FloatArray, arms: int) -> ManySolutions:
    """Fit every row of `records`, shape (R, M), with up to `arms` exponentials.

    A bad row raises no error: it has no solution.
    """
    _refuse(family.template.samples, family.fixed_count, arms)
    count = len(records)
    solutions = _make_empty_solutions(count, arms, family.fixed_count)
    search = GridSearch(family, arms) if arms in POINTS else None
    for first in range(0, count, CHUNK):
        chunk = records[first : first + CHUNK]
        index = first + np.arange(len(chunk))
        if search is None:
            solutions.is_finite[index] = _select_usable_records(chunk)
            index = index[solutions.is_finite[index]]
        else:
            with np.errstate(over="ignore", invalid="ignore"):
                reduced = family.reduce(chunk)
                finite = np.isfinite(reduced.floor + reduced.energy)
            solutions.is_finite[index] = finite
            index = index[finite]
            if len(index):
                is_certain = _solve_chunk(family, search, reduced.select(finite), index, solutions)
                index = index[~is_certain]
        for i in index:
            _solve_record(family.build_block, records[i], arms, int(i), solutions)
    return solutions


def solve_separately(
    make: Callable[[FloatArray], DataBlock], records: FloatArray, arms: int, *, fixed_count: int
) -> ManySolutions:
    """Fit every row by itself, where nothing can be shared: `make` turns a row into a block."""
    _refuse(records.shape[1], fixed_count, arms)
    solutions = _make_empty_solutions(len(records), arms, fixed_count)
    solutions.is_finite[:] = _select_usable_records(records)
    for i in np.flatnonzero(solutions.is_finite):
        _solve_record(make, records[i], arms, int(i), solutions)
    return solutions


def _refuse(samples: int, fixed_count: int, arms: int) -> None:
    if arms < 1:
        raise FitError(f"arms = {arms}; expected at least one")
    unknown = fixed_count + 2 * arms
    if samples < unknown:
        raise FitError(
            f"{samples} samples cannot determine {unknown} parameters; "
            "use fewer arms or longer records"
        )


def _select_usable_records(records: FloatArray) -> BoolArray:
    """Return which records have finite samples whose squares do not overflow."""
    with np.errstate(over="ignore", invalid="ignore"):
        return np.asarray(np.isfinite(np.einsum("ij,ij->i", records, records)))


def _make_empty_solutions(count: int, arms: int, fixed_count: int) -> ManySolutions:
    return ManySolutions(
        log_tau=np.full((count, arms), np.nan),
        arms=np.full((count, arms), np.nan),
        fixed_coefficients=np.full((count, fixed_count), np.nan),
        sse=np.full(count, np.nan),
        order=np.full(count, -1),
        is_finite=np.zeros(count, dtype=bool),
        converged=np.zeros(count, dtype=bool),
        at_bound=np.zeros(count, dtype=bool),
    )


def _solve_record(
    make: Callable[[FloatArray], DataBlock],
    values: FloatArray,
    arms: int,
    row: int,
    solutions: ManySolutions,
) -> None:
    """One record by the single solver; a record that it refuses stays without a solution."""
    try:
        solution: Solution = solve([make(values)], arms)
    except (FitError, np.linalg.LinAlgError):
        return
    n = solution.order
    solutions.log_tau[row, :n] = solution.log_tau
    solutions.arms[row, :n] = solution.arms[0]
    solutions.fixed_coefficients[row] = solution.fixed
    solutions.sse[row] = solution.sse
    solutions.order[row] = n
    solutions.converged[row] = solution.converged
    solutions.at_bound[row] = solution.at_bound.any()


def _solve_chunk(
    family: SharedSampling,
    search: GridSearch,
    reduced: ReducedRecords,
    index: IndexArray,
    solutions: ManySolutions,
) -> BoolArray:
    """Solve all records of a chunk; store the certain optima, and return which they are."""
    gain = search.gains(reduced)
    point, converged = descend_together(family, *search.best(gain), reduced)
    is_certain = converged & _is_interior_positive(family, point, reduced)
    weak_rows = np.flatnonzero(is_certain)
    weak_rows = weak_rows[
        ~_is_well_determined(family, point.take(weak_rows), reduced.select(weak_rows))
    ]
    if len(weak_rows):
        best, is_certain[weak_rows] = _compare_peak_descents(
            family, search, gain[:, weak_rows], point.take(weak_rows), reduced.select(weak_rows)
        )
        point.put(weak_rows, best)
    q, (_, arms) = family.fixed_count, point.log_tau.shape
    small = np.flatnonzero(is_certain & (point.sse < MIN_REMAINDER_SHARE * reduced.energy))
    if len(small):
        point.put(
            small, evaluate_trials(family, point.log_tau[small], reduced.select(small), exact=True)
        )
    sse = reduced.floor + point.sse
    rows = index[is_certain]
    order = np.argsort(point.log_tau[is_certain], axis=1)
    solutions.log_tau[rows] = np.take_along_axis(point.log_tau[is_certain], order, axis=1)
    solutions.arms[rows] = np.take_along_axis(point.beta[is_certain, q:], order, axis=1)
    solutions.fixed_coefficients[rows] = point.beta[is_certain, :q]
    solutions.sse[rows] = sse[is_certain]
    solutions.order[rows] = arms
    solutions.converged[rows] = True
    return is_certain


def _is_interior_positive(
    family: SharedSampling, point: StackTrial, reduced: ReducedRecords
) -> BoolArray:
    """Return which points lie inside the window, all coefficients positive."""
    low, high = family.template.bounds
    q, beta = family.fixed_count, point.beta
    is_proper: BoolArray = point.sse > 100 * family.rounding_floor * reduced.energy
    is_proper &= (beta[:, q:] > 0).all(axis=1) & (beta[:, :q] > 0)[:, family.nonnegative].all(
        axis=1
    )
    is_proper &= ((point.log_tau > low) & (point.log_tau < high)).all(axis=1)
    return is_proper


def _is_well_determined(
    family: SharedSampling, point: StackTrial, reduced: ReducedRecords
) -> BoolArray:
    """Return a mask of records whose relaxation times exclude any better optimum."""
    count, arms = point.log_tau.shape
    dof = family.template.samples - family.fixed_count - 2 * arms
    if dof < 10:
        return np.zeros(count, dtype=bool)
    curvature = point.curvature
    scale = np.maximum(np.diagonal(curvature, axis1=1, axis2=2), 1e-300)
    unit = curvature / np.sqrt(scale[:, :, None] * scale[:, None, :]) + 1e-14 * np.eye(arms)
    variance = np.diagonal(np.linalg.inv(unit), axis1=1, axis2=2) / scale
    noise = (reduced.floor + point.sse) / dof
    value = (variance > 0) & (variance * noise[:, None] < MAX_LN_TAU_SD**2)
    return np.asarray(value.all(axis=1))


def _compare_peak_descents(
    family: SharedSampling,
    search: GridSearch,
    gain: FloatArray,
    trial: StackTrial,
    reduced: ReducedRecords,
) -> tuple[StackTrial, BoolArray]:
    """The best of what was found and of descents from other peaks, and where it is proper."""
    is_proper = np.ones(len(trial.sse), dtype=bool)
    for start, started in search.peaks(gain, RIVALS):
        other, converged = descend_together(family, start, started, reduced)
        better_rows = np.flatnonzero(other.sse < trial.sse * (1 - 1e-10))
        is_proper[better_rows] = (converged & _is_interior_positive(family, other, reduced))[
            better_rows
        ]
        trial.put(better_rows, other.take(better_rows))
    return trial, is_proper
