"""Blocks: one data set each, as a design matrix in the relaxation times."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import NamedTuple, Protocol, TypeAlias

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError

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


class Block(Protocol):
    """One data set in a separable stack.

    Attributes
    ----------
    floor : float
        Sum of squares that no model of the block's family can remove.
    rounding_floor : float
        Sum of squares below which a residual is rounding or compression, not data.
    energy : float
        Sum of squares of the target.
    sampling : hashable or None
        Blocks of equal sampling have equal columns; None if nothing is known.
    rotated_basis : bool
        The orthogonal coordinates of `evaluate` depend on the relaxation times, so that only
        columns evaluated together may be compared.
    samples : int
        Samples of the full data set.
    fixed_names : tuple of str
        Names of the columns that no relaxation time moves, such as ``("k_inf", "offset@0")``.
        Columns of one name are one parameter, shared by all blocks of a stack. The part before
        ``@`` names the kind: ``k_inf`` and ``b`` are a spring and a dashpot and never
        negative, every other kind has either sign.
    arm_group : str
        Blocks of one group share the arms' coefficients: ``"k"``, or ``"k@0"``, ``"k@1"``.
    exact : Block
        The same data with every weighted sample as a row, in order.
    window : (float, float)
        Shortest and longest relaxation time that the data could possibly tell, s.
    """

    @property
    def floor(self) -> float: ...  # noqa: D102
    @property
    def rounding_floor(self) -> float: ...  # noqa: D102
    @property
    def energy(self) -> float: ...  # noqa: D102
    @property
    def sampling(self) -> Hashable: ...  # noqa: D102
    @property
    def rotated_basis(self) -> bool: ...  # noqa: D102
    @property
    def samples(self) -> int: ...  # noqa: D102
    @property
    def fixed_names(self) -> tuple[str, ...]: ...  # noqa: D102
    @property
    def arm_group(self) -> str: ...  # noqa: D102
    @property
    def exact(self) -> Block: ...  # noqa: D102
    @property
    def window(self) -> tuple[float, float]: ...  # noqa: D102

    def evaluate(self, log_tau: FloatArray, derivative: bool = True) -> Evaluation:
        """Return target and design matrix at these relaxation times."""
        ...


@dataclass(frozen=True, eq=False)
class DesignBlock:
    """A block whose arms' columns come from a function of tau.

    The columns are returned in the coordinates of `target`: weighted, and projected if the
    data were. `accuracy` is the relative accuracy of target and columns; `full` makes the same
    block with every sample as a row; blocks of equal `sampling`, where known, have equal columns.
    """

    target: FloatArray
    fixed: FloatArray
    fixed_names: tuple[str, ...]
    columns: Columns
    window: tuple[float, float]
    floor: float = 0.0
    samples: int = 0
    arm_group: str = "k"
    accuracy: float = 1e-15
    full: Callable[[], DesignBlock] | None = None
    sampling: Hashable = None

    def __post_init__(self) -> None:
        rows = len(self.target)
        if self.fixed.shape != (rows, len(self.fixed_names)):
            raise DataError(
                f"the fixed columns have shape {self.fixed.shape}, expected "
                f"{(rows, len(self.fixed_names))}: one row per target value, one column per name"
            )
        if not self.samples:
            object.__setattr__(self, "samples", rows)

    @property
    def exact(self) -> DesignBlock:
        """The same data with every sample as a row; itself if nothing was compressed."""
        return self if self.full is None else self.full()

    @property
    def rotated_basis(self) -> bool:
        """Rows stay what they are."""
        return False

    @property
    def energy(self) -> float:
        """Sum of squares of the target."""
        return float(self.target @ self.target)

    @property
    def rounding_floor(self) -> float:
        """Sum of squares below which a residual is rounding or compression, not data."""
        return self.accuracy**2 * self.energy

    def evaluate(self, log_tau: FloatArray, derivative: bool = True) -> Evaluation:
        """Return target and design matrix at these relaxation times."""
        arms, d_arms = self.columns(np.exp(log_tau), derivative)
        return Evaluation(self.target, self.fixed, arms, d_arms)


def frequency_block(
    omega: FloatArray,
    stiffness: FloatArray,
    *,
    weights: tuple[FloatArray, FloatArray] | None = None,
    dashpot: bool = False,
    arm_group: str = "k",
) -> DesignBlock:
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

    return DesignBlock(
        target=np.concatenate((stiffness.real, stiffness.imag)) * weight,
        fixed=fixed,
        fixed_names=names,
        columns=columns,
        window=(0.1 / float(omega.max()), 10 / float(omega.min())),
        arm_group=arm_group,
    )
