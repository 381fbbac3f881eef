"""Fit of thousands of relaxation records on one clock in one call."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass
from dashpot.base.arrays import (
    FloatArray,
    FrozenArrays,
    convert_numbers_to_si,
    require_increasing,
    validate_samples,
)
from dashpot.base.checks import select_fit_status
from dashpot.base.errors import DataError, Status
from dashpot.base.option_fields import Method
from dashpot.extensions.batch.arrays.batched_solver import (
    ManySolutions,
    solve_many,
    solve_separately,
)
from dashpot.extensions.batch.arrays.batched_standard_errors import compute_standard_errors
from dashpot.extensions.batch.arrays.shared_sampling import (
    SharedSampling,
    make_hold_family,
    make_recorded_family,
    shares_correlation,
)
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.design_matrices.recorded_motion import build_hold_block, build_recorded_block

# number of records below which single fits are faster than a batched one
_STACK = 4


@dataclass(frozen=True, eq=False)
class BatchErrors(FrozenArrays):
    """Standard errors of many solids; NaN without an arm, infinite if undetermined.

    Errors by noise alone, without unmeasured effects of the machine.

    Attributes
    ----------
    k_inf : array, shape (R,)
        N/m.
    k, tau : array, shape (R, N)
        N/m and s.
    """

    k_inf: FloatArray
    k: FloatArray
    tau: FloatArray


@dataclass(frozen=True, eq=False)
class BatchFit(FrozenArrays):
    """Solids of many records; a record without a fit holds NaN and a status with the reason.

    Attributes
    ----------
    k_inf : array, shape (R,)
        N/m.
    k, tau : array, shape (R, N)
        N/m and s, ascending in tau; NaN beyond the arms that the record supports.
    sse : array, shape (R,)
        Sum of squared residuals, N^2.
    status : tuple of Status, length R
    errors : BatchErrors or None
        Standard errors, where they were requested.
    """

    k_inf: FloatArray
    k: FloatArray
    tau: FloatArray
    sse: FloatArray
    status: tuple[Status, ...]
    errors: BatchErrors | None = None

    def __len__(self) -> int:
        """Number of records."""
        return len(self.k_inf)


def fit_many(
    time: npt.ArrayLike,
    forces: npt.ArrayLike,
    *,
    displacement: npt.ArrayLike | None = None,
    ramp: tuple[float, float] | None = None,
    arms: int = 2,
    method: Method = "full",
    errors: bool = False,
) -> BatchFit:
    r"""Fit every record of a stack that was taken on one clock under one displacement.

    The result of each is that of a single fit of the same record. Nothing is raised by one bad
    record: it is returned as NaN with a status.

    Parameters
    ----------
    time : array_like, shape (M,)
        s, strictly increasing.
    forces : array_like, shape (R, M)
        N, tared, compression positive, one record per row.
    displacement : array_like, shape (M,), optional
        The recorded displacement, m, zero before contact. Fastest on a uniform clock.
    ramp : pair of float, optional
        Depth, m, and ramp time, s, of an ideal ramp from time[0] on, where no displacement was
        recorded.
    arms : int
        Maxwell arms of each solid.
    method : {"full", "hold"}
        Fit the whole record, or only its hold: from the end of the ramp, or from the first
        sample within 1 % of the largest displacement.
    errors : bool
        Also give standard errors, :math:`S\,(J'J)^{-1}` with S the power of the residuals in the
        band of the arms: their variance times the correlated samples. Both come from means over a
        few samples, about 1000 in all, which change neither for arms slower than such a mean.

    Returns
    -------
    Many

    Raises
    ------
    DataError
        If the shapes do not fit together, or the history is missing or given twice.
    FitError
        If the records are too short for that number of arms.

    Examples
    --------
    >>> import numpy as np
    >>> from dashpot.solids.maxwell import GeneralizedMaxwell
    >>> time = np.linspace(0, 10, 1001)
    >>> displacement = 1e-3 * np.minimum(time, 1)
    >>> noise = np.random.default_rng(0).normal(0, 1e-3, (3, 1001))
    >>> seal = GeneralizedMaxwell(200.0, k=(100.0,), tau=(0.5,))
    >>> many = fit_many(time, seal.force(time, displacement) + noise,
    ...                 displacement=displacement, arms=1)
    >>> [status.name for status in many.status]
    ['CONVERGED', 'CONVERGED', 'CONVERGED']
    >>> bool(np.all(abs(many.k_inf - 200) < 1))
    True
    """
    clock = require_increasing("time", validate_samples("time", time, minimum=8))
    records = np.atleast_2d(convert_numbers_to_si("forces", forces))
    if records.ndim != 2 or records.shape[1] != len(clock):
        raise DataError(
            f"forces have shape {np.shape(forces)}; expected (records, {len(clock)}), "
            "one column per time"
        )
    if (displacement is None) == (ramp is None):
        raise DataError(
            "the history must be given once: displacement= as recorded, or ramp=(depth, ramp_time)"
        )
    if ramp is not None:
        history = _make_ideal_family(clock, ramp, method=method)
    else:
        x = validate_samples("displacement", displacement if displacement is not None else ())
        history = _build_recorded_motion(clock, x, method=method)
    solutions = history.solve_records(records, arms)
    return BatchFit(
        k_inf=solutions.fixed_coefficients[:, 0],
        k=solutions.arms,
        tau=np.exp(solutions.log_tau),
        sse=solutions.sse,
        status=tuple(_get_status(solutions, row, arms) for row in range(len(records))),
        errors=_compute_errors(clock, records, history, solutions) if errors else None,
    )


class _SharedMotion(NamedTuple):
    """The motion that all records share.

    Attributes
    ----------
    x : array, shape (M,)
        m, from zero on.
    first_sample : int
        Index of the first fitted sample.
    samples : slice
        The samples that `build_block` and `build_sampling` take.
    build_block : callable
        Makes the block of one record.
    build_sampling : callable or None
        Returns the common sampling of a stack of records; None if nothing can be shared.
    """

    x: FloatArray
    first_sample: int
    samples: slice
    build_block: Callable[[FloatArray], DataBlock]
    build_sampling: Callable[[], SharedSampling] | None

    def solve_records(self, records: FloatArray, arms: int) -> ManySolutions:
        """Fit every record, in parallel if there are enough of them."""
        values = records[:, self.samples]
        if self.build_sampling is None or len(values) < _STACK:
            return solve_separately(self.build_block, values, arms, fixed_count=1)
        return solve_many(self.build_sampling(), values, arms)


def _make_ideal_family(
    clock: FloatArray, ramp: tuple[float, float], *, method: str
) -> _SharedMotion:
    depth, ramp_time = ramp
    if not (depth > 0 and ramp_time >= 0):
        raise DataError(f"ramp = {ramp!r}; expected (depth > 0 in m, ramp_time >= 0 in s)")
    elapsed_time = clock - clock[0]
    x = (
        depth * np.minimum(elapsed_time / ramp_time, 1.0)
        if ramp_time
        else np.full(len(elapsed_time), depth)
    )
    if method == "full" and ramp_time > 0:
        return _SharedMotion(
            x,
            0,
            slice(None),
            partial(build_hold_block, elapsed_time, depth=depth, ramp_time=ramp_time, ramp=True),
            partial(make_hold_family, elapsed_time, depth=depth, ramp_time=ramp_time, ramp=True),
        )
    first = int(np.searchsorted(elapsed_time, ramp_time))
    hold_time = elapsed_time[first:] - ramp_time
    return _SharedMotion(
        x,
        first,
        slice(first, None),
        partial(build_hold_block, hold_time, depth=depth, ramp_time=ramp_time),
        partial(make_hold_family, hold_time, depth=depth, ramp_time=ramp_time),
    )


def _build_recorded_motion(clock: FloatArray, x: FloatArray, *, method: str) -> _SharedMotion:
    if len(x) != len(clock):
        raise DataError(f"displacement has {len(x)} samples, time has {len(clock)}")
    if not x.max() > 0:
        raise DataError("the displacement is never positive; expected compression in m, > 0")
    first = int(np.argmax(x >= 0.99 * x.max())) if method == "hold" else 0
    window = slice(first, len(clock))
    has_shared_correlation = shares_correlation(clock, x)
    return _SharedMotion(
        x,
        first,
        slice(None),
        partial(build_recorded_block, clock, x, window=window),
        partial(make_recorded_family, clock, x, window=window) if has_shared_correlation else None,
    )


def _get_status(solutions: ManySolutions, row: int, arms: int) -> Status:
    is_at_bound = solutions.at_bound[row]
    return select_fit_status(
        (),
        {
            Status.NO_DATA: not solutions.is_finite[row],
            Status.NOT_CONVERGED: solutions.order[row] < 0
            or not (solutions.converged[row] or is_at_bound),
            Status.FEWER_ARMS: solutions.order[row] < arms,
            Status.TAU_AT_BOUND: is_at_bound,
        },
    )


def _compute_errors(
    clock: FloatArray, records: FloatArray, history: _SharedMotion, solutions: ManySolutions
) -> BatchErrors:
    error = compute_standard_errors(clock, history.x, records, history.first_sample, solutions)
    arms = solutions.arms.shape[1]
    return BatchErrors(
        error[:, 0], error[:, 1 : 1 + arms], error[:, 1 + arms :] * np.exp(solutions.log_tau)
    )
