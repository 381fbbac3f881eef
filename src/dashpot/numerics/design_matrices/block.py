"""Blocks: one data set each, as a design matrix in the relaxation times."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray
from dashpot.base.errors import DataError
from dashpot.numerics.design_matrices.delayed_force import DelayedForce

_NEVER_NEGATIVE = {"k_inf", "b", "glass", "flow"}

Columns: TypeAlias = Callable[[FloatArray, bool], tuple[FloatArray, FloatArray]]
r"""``columns(tau, derivative) -> (arms, d_arms)``, both (n, N); d_arms is d arms / d ln tau.

Without the derivative `d_arms` is not read and may be `arms` itself.
"""


class Evaluation(NamedTuple):
    r"""A block at one set of relaxation times.

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
        """The same change made to every part."""
        target, fixed, arms = change(self.target), change(self.fixed), change(self.arms)
        return Evaluation(
            target, fixed, arms, arms if self.d_arms is self.arms else change(self.d_arms)
        )


#: what a block cannot do once its rows are others
_LOST: dict[str, None] = dict.fromkeys(("sampling", "full", "widen", "delayed"))

Rows: TypeAlias = Callable[[FloatArray, bool], Evaluation]
"""``rows(log_tau, derivative) -> Evaluation``."""


@dataclass(frozen=True, eq=False)
class DataBlock:
    """One data set in a separable stack: rows, the names of their fixed columns, a window.

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
        Shortest and longest relaxation time that the data could possibly tell, s.
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
    full : callable, optional
        Makes the same data with every weighted sample as a row, in order; left out if the rows
        are those already.
    widen : callable, optional
        Adds a fixed column: takes its name and its value at every sample, weighted.
    delayed : callable, optional
        Adds the column of a force that comes late, where that costs less than any column.
    variance : float or None
        Of every row, where it is known: the rows are what was known before the data.
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
    full: Callable[[], DataBlock] | None = None
    widen: Callable[[str, FloatArray], DataBlock] | None = None
    delayed: Callable[[str, DelayedForce], DataBlock] | None = None
    variance: float | None = None

    def evaluate(self, log_tau: FloatArray, derivative: bool = True) -> Evaluation:
        """Return target and design matrix at these relaxation times."""
        return self.rows(log_tau, derivative)

    @property
    def exact(self) -> DataBlock:
        """The same data with every sample as a row; itself if nothing was compressed."""
        return self if self.full is None else self.full()

    def with_column(self, name: str, column: FloatArray) -> DataBlock:
        """The block with one more fixed column, given at every sample."""
        return self.widen(name, column) if self.widen else self.append_column(name, column)

    def with_delay(self, name: str, late: DelayedForce) -> DataBlock:
        """The block with the column of a force that comes late."""
        return self.delayed(name, late) if self.delayed else self.with_column(name, late.column)

    def append_column(
        self, name: str, column: FloatArray, *, full: Callable[[], DataBlock] | None = None
    ) -> DataBlock:
        """The block with one more fixed column in its own coordinates, which are steady."""
        fixed = self.rows(np.zeros(0), False).fixed
        wider = np.concatenate((fixed.T, column[None])).T

        def rows(log_tau: FloatArray, derivative: bool) -> Evaluation:
            return self.rows(log_tau, derivative)._replace(fixed=wider)

        names = (*self.fixed_names, name)
        return replace(self, rows=rows, fixed_names=names, sampling=None, full=full)

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

    def transform_rows(self, change: Callable[[FloatArray], FloatArray], **facts: Any) -> DataBlock:
        """The block with the same linear change made to target and columns; `facts` as new."""

        def rows(log_tau: FloatArray, derivative: bool) -> Evaluation:
            return self.rows(log_tau, derivative).map_parts(change)

        return replace(self, rows=rows, **{**_LOST, **facts})

    def map_relaxation_times(
        self,
        log_tau: Callable[[FloatArray], FloatArray],
        factor: float,
        *,
        stretch: float = 1.0,
        window: tuple[float, float],
    ) -> DataBlock:
        """The same data of a solid whose relaxation times and stiffnesses were others.

        Rows at ``log_tau(...)`` of the times asked for, springs and arms times `factor`; `stretch`
        is the slope of that map, `window` that of the times asked for.
        """
        stiff = np.where(stiffnesses(self.fixed_names), factor, 1.0)

        def rows(asked: FloatArray, derivative: bool) -> Evaluation:
            evaluation = self.rows(log_tau(asked), derivative)
            arms = factor * evaluation.arms
            slopes = stretch * factor * evaluation.d_arms if derivative else arms
            return Evaluation(evaluation.target, evaluation.fixed * stiff, arms, slopes)

        return replace(self, rows=rows, window=window, sampling=None, full=None, widen=None)

    def scale_rows(self, factor: float, fixed_names: tuple[str, ...] | None = None) -> DataBlock:
        """Every row times one factor, 1/sd; with other names, if they are given."""
        full, names = self.full, fixed_names or self.fixed_names
        return self.transform_rows(
            lambda part: factor * part,
            fixed_names=names,
            floor=factor**2 * self.floor,
            variance=None if self.variance is None else factor**2 * self.variance,
            full=None if full is None else lambda: full().scale_rows(factor, names),
        )


def design_rows(target: FloatArray, fixed: FloatArray, columns: Columns) -> Rows:
    """Rows of a design matrix whose arms' columns come from a function of tau.

    The columns are returned in the coordinates of `target`: weighted, and projected if the
    data were.
    """
    none = np.empty((len(target), 0))

    def rows(log_tau: FloatArray, derivative: bool) -> Evaluation:
        if not len(log_tau):
            return Evaluation(target, fixed, none, none)
        return Evaluation(target, fixed, *columns(np.exp(log_tau), derivative))

    return rows


def design_block(
    target: FloatArray,
    fixed: FloatArray,
    fixed_names: tuple[str, ...],
    columns: Columns,
    window: tuple[float, float],
) -> DataBlock:
    """A block of every sample as a row; see :class:`DataBlock` and :func:`design_rows`."""
    rows = len(target)
    if fixed.shape != (rows, len(fixed_names)):
        raise DataError(
            f"the fixed columns have shape {fixed.shape}, expected "
            f"{(rows, len(fixed_names))}: one row per target value, one column per name"
        )
    made = design_rows(target, fixed, columns)
    return DataBlock(made, fixed_names, window, rows)


def retarding(block: DataBlock, whole: str) -> DataBlock:
    r"""The block with each arm turned into a retardation: what a force has yet to move.

    An arm's column q of the input F is :math:`\int e^{-(t-u)/\lambda}\,dF`, so

    .. math:: \int_0^t \bigl(1 - e^{-(t-u)/\lambda}\bigr)\,dF(u) = F(t) - q(t)

    Parameters
    ----------
    block : DataBlock
        Of arms under the input F.
    whole : str
        Name of the fixed column that is F.
    """
    at = block.fixed_names.index(whole)

    def rows(log_tau: FloatArray, derivative: bool) -> Evaluation:
        evaluation = block.rows(log_tau, derivative)
        arms = evaluation.fixed[:, [at]] - evaluation.arms
        return evaluation._replace(arms=arms, d_arms=-evaluation.d_arms if derivative else arms)

    return replace(
        block,
        rows=rows,
        sampling=None,
        full=None if block.full is None else lambda: retarding(block.exact, whole),
        widen=lambda name, column: retarding(block.with_column(name, column), whole),
        delayed=None,
    )


def prior_block(
    like: DataBlock,
    names: tuple[str, ...],
    rows: FloatArray,
    mean: FloatArray,
    sd: FloatArray,
    *,
    unit: float,
) -> DataBlock:
    r"""What is known of fixed coefficients before the data, as rows beside those of a block.

    .. math:: \frac{s}{\sigma_i} \sum_n C_{in} c_n = \frac{s}{\sigma_i} m_i

    Parameters
    ----------
    like : DataBlock
        Whose coefficients they are.
    names : tuple of str
    rows : array, shape (p, q)
        C, one column per name.
    mean, sd : array, shape (p,)
    unit : float
        s, the standard deviation of one independent row of `like`.
    """
    scale = unit / sd
    fixed, target = rows * scale[:, None], mean * scale
    none = np.zeros((len(mean), 0))

    def evaluate_prior(log_tau: FloatArray, _derivative: bool) -> Evaluation:
        arms = np.zeros((len(mean), len(log_tau))) if len(log_tau) else none
        return Evaluation(target, fixed, arms, arms)

    return DataBlock(
        evaluate_prior, names, like.window, len(mean), like.arm_group, variance=unit**2
    )


def stiffnesses(names: Sequence[str]) -> BoolArray:
    """Which fixed coefficients are those of a spring or a dashpot and never negative."""
    return np.array([name.partition("@")[0] in _NEVER_NEGATIVE for name in names], dtype=bool)


def frequency_block(
    omega: FloatArray,
    stiffness: FloatArray,
    *,
    weights: tuple[FloatArray, FloatArray] | None = None,
    dashpot: bool = False,
) -> DataBlock:
    r"""Storage and loss stiffness at given frequencies as one block of real rows.

    .. math:: K' + jK'' = k_\infty + \sum_j k_j \frac{j\omega\tau_j}{1 + j\omega\tau_j}
        + j\omega b

    Parameters
    ----------
    omega : array, shape (m,)
        rad/s, > 0, any order.
    stiffness : complex array, shape (m,)
        K' + jK'', N/m.
    weights : (array, array), optional
        1/sd of K' and of K'', each shape (m,); 1 by default.
    dashpot : bool
        Add the column of a parallel dashpot, named ``b``.
    """
    omega = np.asarray(omega, dtype=float)
    stiffness = np.asarray(stiffness, dtype=complex)
    ones = np.ones(len(omega))
    weight = np.concatenate(weights if weights is not None else (ones, ones))
    spring = np.concatenate((ones, 0 * omega))
    damper = np.concatenate((0 * omega, omega))
    names = ("k_inf", "b") if dashpot else ("k_inf",)
    fixed = np.column_stack((spring, damper)[: len(names)]) * weight[:, None]

    def columns(tau: FloatArray, derivative: bool) -> tuple[FloatArray, FloatArray]:
        x = omega[:, None] * tau
        arms = np.concatenate((x * x, x)) / np.tile(1 + x * x, (2, 1)) * weight[:, None]
        if not derivative:
            return arms, arms
        # d/d ln tau of jx/(1+jx) is jx/(1+jx)^2
        slope = np.concatenate((2 * x * x, x * (1 - x * x))) / np.tile((1 + x * x) ** 2, (2, 1))
        return arms, slope * weight[:, None]

    return design_block(
        target=np.concatenate((stiffness.real, stiffness.imag)) * weight,
        fixed=fixed,
        fixed_names=names,
        columns=columns,
        window=(0.1 / float(omega.max()), 10 / float(omega.min())),
    )
