"""Blocks: single data sets as design matrices in the relaxation times."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from functools import cached_property, lru_cache
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import BoolArray, FloatArray, IndexArray
from dashpot.base.errors import DataError

# Arms under a recorded displacement on a uniform clock, block by block.
#
# With d_i = x_i - x_{i-1}, z = h/tau, a = e^{-z}, G = (1 - e^{-z})/z, sample i of a stretch is
#
# .. math:: u_i = \sum_{j \le i} a^{i-j} d_j + a^{i+1} u_{-1}, \qquad q_i = G u_i, \qquad
#     p_i = \frac{\partial q_i}{\partial \ln\tau} = (G - a)\,u_i + G z\,v_i, \qquad
#     v_i = \sum_{j \le i} (i - j)\, a^{i-j} d_j + a^{i+1} (v_{-1} + (i + 1)\, u_{-1})
#
# with what the stretch before it ends with at index -1. All stretches are one product with one
# triangular matrix, and their ends are such a sum again, of fewer samples: the recursion in the
# order of a matrix product, for the same result in an eighth of the time.


#: samples of a segment: longer segments and shorter ones take more time
STRETCH_SAMPLES = 32


def compute_arm_elongations(
    x: FloatArray, z: FloatArray, *, derivative: bool = True
) -> tuple[FloatArray, FloatArray]:
    """Elongations q of unit arms and p = dq / d ln tau, both (M, N), from q_0 = x_0.

    Parameters
    ----------
    x : array, shape (M,)
        Displacement.
    z : array, shape (N,)
        Sample interval over each relaxation time.
    derivative : bool
        Without it the second is the first.
    """
    sample_count = len(x)
    count = -(-sample_count // STRETCH_SAMPLES)
    steps = np.zeros(count * STRETCH_SAMPLES)
    np.subtract(x[1:], x[:-1], out=steps[1:sample_count])
    # beside the steps of each stretch, what the one before it ends with
    values = np.zeros((count, STRETCH_SAMPLES + 2))
    values[:, :STRETCH_SAMPLES] = steps.reshape(count, STRETCH_SAMPLES)
    columns = np.empty((2 if derivative else 1, len(z), count, STRETCH_SAMPLES))
    index = np.arange(STRETCH_SAMPLES + 1.0)
    for j, value in enumerate(z):
        power = np.exp(-value * index)
        mean = -np.expm1(-value) / value
        block_ends = compute_exponential_cumsum(
            values[:, :STRETCH_SAMPLES] @ power[STRETCH_SAMPLES - 1 :: -1], value * STRETCH_SAMPLES
        )
        values[1:, STRETCH_SAMPLES] = block_ends[:-1]
        np.matmul(values[:, :-1], _compute_responses(mean * power), out=columns[0, j])
        if derivative:
            delayed = index * power
            late_ends = values[:, :STRETCH_SAMPLES] @ delayed[STRETCH_SAMPLES - 1 :: -1]
            late_ends[1:] += delayed[STRETCH_SAMPLES] * block_ends[:-1]
            values[1:, STRETCH_SAMPLES + 1] = compute_exponential_cumsum(
                late_ends, value * STRETCH_SAMPLES
            )[:-1]
            elongations = _compute_responses((mean - power[1]) * power + mean * value * delayed)
            np.matmul(
                values,
                np.concatenate((elongations, mean * value * power[None, 1:])),
                out=columns[1, j],
            )
    q, p = (
        stacked.reshape(len(z), count * STRETCH_SAMPLES) for stacked in (columns[0], columns[-1])
    )
    if x[0] != 0.0:
        scaled_time = z[:, None] * np.arange(q.shape[1])
        remainder = x[0] * np.exp(-scaled_time)
        q += remainder
        if derivative:
            p += scaled_time * remainder
    return q.T[:sample_count], p.T[:sample_count]


def _compute_responses(kernel: FloatArray) -> FloatArray:
    """Return a row of responses to each step of a stretch, and one to the end before it."""
    return np.concatenate((_make_triangular_matrix(kernel[:STRETCH_SAMPLES]), kernel[None, 1:]))


def compute_exponential_cumsum(values: FloatArray, z: float) -> FloatArray:
    r"""Return the sums :math:`\sum_{j \le i} e^{-z (i - j)} v_j`, shape (n,)."""
    sample_count = len(values)
    if sample_count <= STRETCH_SAMPLES:
        return values @ _make_triangular_matrix(np.exp(-z * np.arange(float(sample_count))))
    power = np.exp(-z * np.arange(STRETCH_SAMPLES + 1.0))
    matrix = np.zeros((-(-sample_count // STRETCH_SAMPLES), STRETCH_SAMPLES))
    matrix.ravel()[:sample_count] = values
    result = matrix @ _make_triangular_matrix(power[:STRETCH_SAMPLES])
    result[1:] += (
        compute_exponential_cumsum(result[:, -1], z * STRETCH_SAMPLES)[:-1, None] * power[1:]
    )
    return np.asarray(result.ravel()[:sample_count])


def _make_triangular_matrix(kernel: FloatArray) -> FloatArray:
    """Return the matrix whose row j holds kernel[i - j] at every i >= j."""
    lag, lower_indices = _make_lag_matrix(len(kernel))
    return np.where(lower_indices, kernel[lag], 0.0)


@lru_cache(maxsize=64)
def _make_lag_matrix(lag_count: int) -> tuple[IndexArray, BoolArray]:
    lag = np.arange(lag_count) - np.arange(lag_count)[:, None]
    return np.maximum(lag, 0), lag >= 0


# Column of a delayed force, and its closed-form correlation with the motion.
#
# .. math:: c = -\dot F = \sum_j \frac{k_j}{\tau_j}\,q_j - k_g\,\dot x
#
# On an even clock, with the steps d of the motion, a window from b + 1 to e and the correlation
# :math:`C_d` of its steps with all steps, the recursion of an arm is one of its correlation,
#
# .. math::
#
#     C_q(l) &= a\,C_q(l-1) + G\,C_d(l) + (q_{b+1} - G d_{b+1})\,d_{b+1-l} - a\,q_e\,d_{e+1-l} \\
#     2h\,C_{\dot x}(l) &= C_d(l) + C_d(l+1) + d_{e+1} d_{e-l} - d_{b+1} d_{b-l}


class DelayedForce(NamedTuple):
    """Delayed force, sample by sample.

    Attributes
    ----------
    column : array, shape (n,)
        c over the window.
    arms : array, shape (n, N)
        q over the window.
    k, tau : array, shape (N,)
    k_g : float
        Number of k_inf and all arms together.
    """

    column: FloatArray
    arms: FloatArray
    k: FloatArray
    tau: FloatArray
    k_g: float

    @classmethod
    def from_arms(
        cls, arms: FloatArray, k: FloatArray, tau: FloatArray, k_g: float, speed: FloatArray
    ) -> DelayedForce:
        """Return the force from the arms' elongations and the speed of the motion in the window."""
        return cls(arms @ (k / tau) - k_g * speed, arms, k, tau, k_g)


class MotionSteps(NamedTuple):
    """Steps of a motion from its first sample to the end of a window, and the next one.

    Attributes
    ----------
    sizes : array, shape (stop,)
        d; the first is the first displacement, zero.
    next_step : float
        The step after the window, or its last where the record ends.
    correlation : array, shape (stop,)
        C_d at every lag.
    """

    sizes: FloatArray
    next_step: float
    correlation: FloatArray


def compute_delayed_lags(
    steps: MotionSteps, delayed_force: DelayedForce, *, start: int, interval: float
) -> FloatArray:
    """Correlation of the column with the steps at every lag, shape (stop,)."""
    d, values = steps.sizes, steps.correlation
    first = reverse_before_start(d, start + 1)
    after_last = np.concatenate(([0.0], d[:0:-1]))
    total = np.zeros(len(d))
    for q, k, tau in zip(delayed_force.arms.T, delayed_force.k, delayed_force.tau, strict=True):
        z = interval / tau
        mean = -np.expm1(-z) / z
        difference = (
            mean * values + (q[0] - mean * d[start]) * first - np.exp(-z) * q[-1] * after_last
        )
        difference[0] = q @ d[start:]
        total += k / tau * compute_exponential_cumsum(difference, z)
    change = values + steps.next_step * d[::-1] - d[start] * reverse_before_start(d, start)
    change[:-1] += values[1:]
    return np.asarray(total - delayed_force.k_g / (2.0 * interval) * change)


def reverse_before_start(values: FloatArray, start: int) -> FloatArray:
    """Return the values before `start`, the last first, then zeros."""
    reversed_values = np.zeros(len(values))
    reversed_values[:start] = values[:start][::-1]
    return reversed_values


_NEVER_NEGATIVE = {"k_inf", "b", "glass", "flow"}

Columns: TypeAlias = Callable[[FloatArray, bool], tuple[FloatArray, FloatArray]]
r"""``columns(tau, derivative) -> (arms, d_arms)``, both (n, N); d_arms is d arms / d ln tau.

Without the derivative `d_arms` is not read and may be `arms` itself.
"""


class Evaluation(NamedTuple):
    r"""Evaluation of a block at one set of relaxation times.

    .. math:: \mathrm{SSE}(g, k, \tau) = \mathrm{floor} + |y - G g - \Phi(\tau) k|^2

    Attributes
    ----------
    target : array, shape (n,)
        y, data in any orthogonal coordinates, weighted.
    fixed : array, shape (n, q)
        G, the columns that no relaxation time moves.
    arms : array, shape (n, N)
        Phi, one column per arm.
    d_arms : array, shape (n, N)
        d Phi / d ln tau, column by column.
    """

    target: FloatArray
    fixed: FloatArray
    arms: FloatArray
    d_arms: FloatArray

    def map_parts(self, change: Callable[[FloatArray], FloatArray]) -> Evaluation:
        """Return the same change made to every part."""
        target, fixed, arms = change(self.target), change(self.fixed), change(self.arms)
        return Evaluation(
            target, fixed, arms, arms if self.d_arms is self.arms else change(self.d_arms)
        )


#: methods that a block of transformed rows does not have
_DROPPED_FIELDS: dict[str, None] = dict.fromkeys(
    ("sampling", "build_full", "add_fixed_column", "add_delayed_column")
)

Rows: TypeAlias = Callable[[FloatArray, bool], Evaluation]
"""``rows(log_tau, derivative) -> Evaluation``."""


@dataclass(frozen=True, eq=False)
class DataBlock:
    """Data set of a separable stack: rows, names of their fixed columns, and a window.

    Attributes
    ----------
    rows : callable
        Target and design matrix at any relaxation times, weighted.
    fixed_names : tuple of str
        Names of the columns that no relaxation time moves, such as ``("k_inf", "offset@0")``.
        Columns of one name are one parameter, shared by all blocks of a stack. The part before
        ``@`` names the kind: ``k_inf`` and ``b`` are a spring and a dashpot, ``glass`` and
        ``flow`` those of a compliance, and never negative; every other kind has either sign.
    window : (float, float)
        Shortest and longest relaxation time that the data could possibly show, s.
    samples : int
        Samples of the full data set.
    arm_group : str
        Blocks of one group share the arms' coefficients: ``"k"``, or ``"k@0"``, ``"k@1"``.
    floor : float
        Sum of squares that no model of the block's family can remove.
    accuracy : float
        Relative accuracy of target and columns: a residual below is rounding or compression.
    rotated_basis : bool
        The orthogonal coordinates depend on the relaxation times, so that only columns
        evaluated together may be compared.
    sampling : hashable or None
        Blocks of equal sampling have equal columns; None if nothing is known.
    build_full : callable, optional
        Returns the same data with every weighted sample as a row, in order; None if the rows are
        the samples already.
    add_fixed_column : callable, optional
        Adds a fixed column: takes its name and its value at every sample, weighted.
    add_delayed_column : callable, optional
        Adds the column of a delayed force, where that is cheaper than a general column.
    variance : float or None
        Variance of every row, where it is known: the rows are priors.
    """

    rows: Rows
    fixed_names: tuple[str, ...]
    window: tuple[float, float]
    samples: int
    arm_group: str = "k"
    floor: float = 0.0
    accuracy: float = 1e-15
    rotated_basis: bool = False
    sampling: Hashable = None
    build_full: Callable[[], DataBlock] | None = None
    add_fixed_column: Callable[[str, FloatArray], DataBlock] | None = None
    add_delayed_column: Callable[[str, DelayedForce], DataBlock] | None = None
    variance: float | None = None

    def evaluate(self, log_tau: FloatArray, derivative: bool = True) -> Evaluation:
        """Return target and design matrix at these relaxation times."""
        return self.rows(log_tau, derivative)

    @property
    def exact(self) -> DataBlock:
        """Block with every sample as a row; itself if nothing was compressed."""
        return self if self.build_full is None else self.build_full()

    def with_column(self, name: str, column: FloatArray) -> DataBlock:
        """Return the block with one more fixed column, given at every sample."""
        return (
            self.add_fixed_column(name, column)
            if self.add_fixed_column
            else self.append_column(name, column)
        )

    def with_delay(self, name: str, delayed_force: DelayedForce) -> DataBlock:
        """Return the block with the column of a force that comes late."""
        if self.add_delayed_column:
            return self.add_delayed_column(name, delayed_force)
        return self.with_column(name, delayed_force.column)

    def append_column(
        self, name: str, column: FloatArray, *, make_full: Callable[[], DataBlock] | None = None
    ) -> DataBlock:
        """Return the block with one more fixed column in its own coordinates, which are steady."""
        fixed = self.rows(np.zeros(0), False).fixed
        extended = np.concatenate((fixed.T, column[None])).T

        def rows(log_tau: FloatArray, derivative: bool) -> Evaluation:
            return self.rows(log_tau, derivative)._replace(fixed=extended)

        names = (*self.fixed_names, name)
        return replace(self, rows=rows, fixed_names=names, sampling=None, build_full=make_full)

    @property
    def target(self) -> FloatArray:
        """The data in the coordinates of no arms."""
        return self.rows(np.zeros(0), False).target

    @cached_property
    def energy(self) -> float:
        """Sum of squares of the target."""
        target = self.target
        return float(target @ target)

    @property
    def rounding_floor(self) -> float:
        """Sum of squares below which a residual is rounding or compression, not data."""
        return self.accuracy**2 * self.energy

    @property
    def bounds(self) -> tuple[float, float]:
        """The window of ln tau."""
        low, high = np.log(self.window)
        return float(low), float(high)

    def transform_rows(
        self, change: Callable[[FloatArray], FloatArray], **fields: Any
    ) -> DataBlock:
        """The block with the same linear change made to target and columns; `fields` as new."""

        def rows(log_tau: FloatArray, derivative: bool) -> Evaluation:
            return self.rows(log_tau, derivative).map_parts(change)

        return replace(self, rows=rows, **{**_DROPPED_FIELDS, **fields})

    def map_relaxation_times(
        self,
        log_tau: Callable[[FloatArray], FloatArray],
        factor: float,
        *,
        stretch: float = 1.0,
        window: tuple[float, float],
    ) -> DataBlock:
        """Return the same data of a solid whose relaxation times and stiffnesses were others.

        Rows at ``log_tau(...)`` of the times requested, springs and arms times `factor`; `stretch`
        is the slope of that map, `window` that of the times requested.
        """
        row_factors = np.where(stiffnesses(self.fixed_names), factor, 1.0)

        def rows(log_tau_values: FloatArray, derivative: bool) -> Evaluation:
            evaluation = self.rows(log_tau(log_tau_values), derivative)
            arms = factor * evaluation.arms
            slopes = stretch * factor * evaluation.d_arms if derivative else arms
            return Evaluation(evaluation.target, evaluation.fixed * row_factors, arms, slopes)

        return replace(
            self, rows=rows, window=window, sampling=None, build_full=None, add_fixed_column=None
        )

    def scale_rows(self, factor: float, fixed_names: tuple[str, ...] | None = None) -> DataBlock:
        """Return every row times one factor, 1/sd; with other names, if they are given."""
        make_full, names = self.build_full, fixed_names or self.fixed_names
        return self.transform_rows(
            lambda part: factor * part,
            fixed_names=names,
            floor=factor**2 * self.floor,
            variance=None if self.variance is None else factor**2 * self.variance,
            build_full=None if make_full is None else lambda: make_full().scale_rows(factor, names),
        )


def design_rows(target: FloatArray, fixed: FloatArray, columns: Columns) -> Rows:
    """Return rows of a design matrix with columns of arms from a function of tau.

    The columns are returned in the coordinates of `target`: weighted, and projected if the
    data were.
    """
    no_columns = np.empty((len(target), 0))

    def rows(log_tau: FloatArray, derivative: bool) -> Evaluation:
        if not len(log_tau):
            return Evaluation(target, fixed, no_columns, no_columns)
        return Evaluation(target, fixed, *columns(np.exp(log_tau), derivative))

    return rows


def design_block(
    target: FloatArray,
    fixed: FloatArray,
    fixed_names: tuple[str, ...],
    columns: Columns,
    window: tuple[float, float],
) -> DataBlock:
    """Return a block of every sample as a row; see :class:`DataBlock` and :func:`design_rows`."""
    rows = len(target)
    if fixed.shape != (rows, len(fixed_names)):
        raise DataError(
            f"the fixed columns have shape {fixed.shape}, expected "
            f"{(rows, len(fixed_names))}: one row per target value, one column per name"
        )
    rows_block = design_rows(target, fixed, columns)
    return DataBlock(rows_block, fixed_names, window, rows)


def prior_block(
    template: DataBlock,
    names: tuple[str, ...],
    rows: FloatArray,
    mean: FloatArray,
    sd: FloatArray,
    *,
    unit: float,
) -> DataBlock:
    r"""Return priors of fixed coefficients as additional rows of a block.

    .. math:: \frac{s}{\sigma_i} \sum_n C_{in} c_n = \frac{s}{\sigma_i} m_i

    Parameters
    ----------
    template : DataBlock
        Whose coefficients they are.
    names : tuple of str
    rows : array, shape (p, q)
        C, one column per name.
    mean, sd : array, shape (p,)
    unit : float
        s, the standard deviation of one independent row of `template`.
    """
    scale = unit / sd
    fixed, target = rows * scale[:, None], mean * scale
    no_columns = np.zeros((len(mean), 0))

    def evaluate_prior(log_tau: FloatArray, _derivative: bool) -> Evaluation:
        arms = np.zeros((len(mean), len(log_tau))) if len(log_tau) else no_columns
        return Evaluation(target, fixed, arms, arms)

    return DataBlock(
        evaluate_prior, names, template.window, len(mean), template.arm_group, variance=unit**2
    )


def stiffnesses(names: Sequence[str]) -> BoolArray:
    """Return which fixed coefficients belong to a spring or a dashpot and must not be negative."""
    return np.array([name.partition("@")[0] in _NEVER_NEGATIVE for name in names], dtype=bool)
