r"""From one start to the nearest optimum in ln tau, linear parameters solved exactly on the way."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray, IndexArray
from dashpot.numerics.design_matrices.block import DataBlock, stiffnesses
from dashpot.numerics.least_squares.levenberg_marquardt import (
    FINISHED,
    LocalOptimum,
    Objective,
    triangle,
)
from dashpot.numerics.least_squares.levenberg_marquardt import descend as downhill
from dashpot.numerics.least_squares.nnls import nonnegative_columns


class StackRows(NamedTuple):
    """A whole stack at one ln tau.

    Attributes
    ----------
    columns : array, shape (p + a + 1, n)
        Those of Phi, of dPhi / d ln tau for the arms, and y, as rows: so they are factored.
    width : int
        p.
    """

    columns: FloatArray
    width: int

    @property
    def target(self) -> FloatArray:
        """What is to be explained, y (n,)."""
        return np.asarray(self.columns[-1])

    @property
    def phi(self) -> FloatArray:
        """The design matrix, (n, p)."""
        return self.columns[: self.width].T

    @property
    def slope(self) -> FloatArray:
        """Its derivative by ln tau where arms are, (n, a)."""
        return self.columns[self.width : -1].T


class Stack:
    """Blocks on top of each other, their columns matched by name and group.

    The linear parameters stand as all fixed names, then the arms of the first group, of the
    second, and so on: p = q + G N.
    """

    def __init__(self, blocks: Sequence[DataBlock]) -> None:
        self.blocks = tuple(blocks)
        self.names = tuple(dict.fromkeys(n for block in blocks for n in block.fixed_names))
        self.groups = tuple(dict.fromkeys(block.arm_group for block in blocks))
        self.floor = sum(block.floor for block in blocks)
        #: of the data: what was known before is not a sample
        self.samples = sum(block.samples for block in blocks if block.variance is None)
        #: what was known before, in rows
        self.known = sum(block.samples for block in blocks) - self.samples
        shortest, longest = zip(*(block.window for block in blocks), strict=True)
        self.bounds = (float(np.log(min(shortest))), float(np.log(max(longest))))
        #: how often :func:`point_at` was asked
        self.trials = 0
        #: stacks of equal sampling have equal columns
        self.sampling = blocks[0].sampling if len(blocks) == 1 else None

    @cached_property
    def rotated_basis(self) -> bool:
        """The blocks' coordinates depend on tau, so only columns evaluated together compare."""
        return any(block.rotated_basis for block in self.blocks)

    @cached_property
    def rounding_floor(self) -> float:
        """Sum of squares below which a residual is rounding."""
        return float(sum(block.rounding_floor for block in self.blocks))

    @cached_property
    def energy(self) -> float:
        """Sum of squares of the target."""
        return float(sum(block.energy for block in self.blocks))

    @property
    def nothing(self) -> float:
        """Sum of squares that a finished descent leaves of exact data."""
        return max(self.rounding_floor, FINISHED**2 * self.energy)

    def get_nonnegative_mask(self, arms: int, *, signed: bool) -> BoolArray:
        """Which linear parameters must not be negative, shape (p,)."""
        every = np.ones(len(self.names) + arms * len(self.groups), dtype=bool)
        every[: len(self.names)] = stiffnesses(self.names)
        return every & (not signed)

    def evaluate(self, log_tau: FloatArray, *, derivative: bool = True) -> StackRows:
        """Return the stacked design matrix, slopes if asked for, and target."""
        parts = [block.evaluate(log_tau, derivative) for block in self.blocks]
        arms, q = len(log_tau), len(self.names)
        every = arms * len(self.groups)
        slopes = every if derivative else 0
        columns = np.zeros((q + every + slopes + 1, sum(len(part.target) for part in parts)))
        first = 0
        for (indices, group), part in zip(self._places, parts, strict=True):
            here = slice(first, first + len(part.target))
            at = q + group * arms
            columns[indices, here] = part.fixed.T
            columns[at : at + arms, here] = part.arms.T
            if derivative:
                columns[at + every : at + every + arms, here] = part.d_arms.T
            columns[-1, here] = part.target
            first = here.stop
        return StackRows(columns, q + every)

    @cached_property
    def _places(self) -> list[tuple[list[int], int]]:
        """The fixed columns of each block among all, and its group."""
        return [
            ([*map(self.names.index, block.fixed_names)], self.groups.index(block.arm_group))
            for block in self.blocks
        ]


class StackTrial(NamedTuple):
    r"""One trial of ln tau with everything linear solved; of each record, if axes lead.

    `gradient` is J'r and `curvature` J'J of the reduced residual, both per ln tau, `turn`
    (p, N) the derivative of beta by ln tau; `sse` is without the floor, infinite where the columns
    are dependent and the rest says nothing.
    """

    log_tau: FloatArray
    beta: FloatArray
    sse: Any  # a number, or one of each record
    gradient: FloatArray
    curvature: FloatArray
    turn: FloatArray

    @property
    def theta(self) -> FloatArray:
        """What a descent moves."""
        return self.log_tau

    @classmethod
    def from_factor(
        cls, log_tau: FloatArray, factor: FloatArray, fixed: int, active: BoolArray | None = None
    ) -> StackTrial:
        r"""From the triangular factor of the `active` columns, the slopes and the target.

        With Phi = QR, r = (I - QQ')y and beta = R^{-1}Q'y, the derivative of r by ln tau_j is

        .. math:: J_j = -(I - QQ') D_j \beta_j - Q R^{-T} e_j (D_j' r)

        (G. H. Golub and V. Pereyra, *SIAM J. Numer. Anal.* 10, 1973); arms shared by several
        groups add up. The two terms are orthogonal, and only the first meets r. Everything that
        they need stands in the triangular factor of one QR,

        .. math:: [\Phi, D, y] \to
            \begin{bmatrix} R & Q'D & Q'y \\ 0 & D_\perp & r \end{bmatrix}

        where D_perp and r are in coordinates orthogonal to Q. In the same letters

        .. math:: \frac{\partial\beta}{\partial\ln\tau_j}
            = -R^{-1} Q' D_j \beta_j + R^{-1} R^{-T} e_j (D_j' r)
        """
        arms, slopes = log_tau.shape[-1], factor.shape[-1] - 1
        p = fixed + (slopes - fixed) // 2 if active is None else int(active.sum())
        inverse = np.asarray(np.linalg.inv(factor[..., :p, :p]), dtype=float)
        beta = (inverse @ factor[..., :p, -1:])[..., 0]
        along = inverse @ factor[..., :p, p:-1]
        towards = inverse
        if active is not None:
            beta, along, towards = (_spread(active, values) for values in (beta, along, inverse))
        residual, outside = factor[..., p:, -1], factor[..., p:, p:-1]
        k = beta[..., fixed:]
        outward = (residual[..., None, :] @ outside)[..., 0, :]
        inside = towards[..., fixed:, :] * outward[..., None]
        scale = k[..., None, :]
        outside, along = outside * scale, along * scale
        gradient = -k * outward
        if k.shape[-1] > arms:
            gradient = gradient.reshape(-1, arms).sum(axis=0)
            inside = inside.reshape(-1, arms, p).sum(axis=0)
            outside = outside.reshape(len(outside), -1, arms).sum(axis=1)
            along = along.reshape(len(along), -1, arms).sum(axis=1)
        turned = inside.swapaxes(-1, -2)
        curvature = outside.swapaxes(-1, -2) @ outside + inside @ turned
        # a Python number is compared faster
        sse = np.vecdot(residual, residual) if residual.ndim > 1 else float(residual @ residual)
        return cls(log_tau, beta, sse, gradient, curvature, towards @ turned - along)

    def ahead(self, step: FloatArray) -> StackTrial:
        """The point a short step away, where beta is linear and the SSE is flat."""
        turned = (self.turn @ step[..., None])[..., 0]
        return self._replace(log_tau=self.log_tau + step, beta=self.beta + turned)

    def take(self, index: IndexArray | BoolArray) -> StackTrial:
        """Copies of some records."""
        return StackTrial(*(part[index] for part in self))

    def put(self, index: IndexArray, new: StackTrial) -> None:
        """Write some records anew."""
        for old, fresh in zip(self, new, strict=True):
            old[index] = fresh


def point_at(
    stack: Stack, log_tau: FloatArray, *, restricted: BoolArray | None = None
) -> StackTrial:
    r"""Solve the linear parameters at ln tau and differentiate the residual left over.

    With `restricted`, those coefficients are kept >= 0; an arm at zero has no derivative.
    Columns that are dependent to 13 digits have an infinite SSE.
    """
    stack.trials += 1
    rows = stack.evaluate(log_tau)
    free = _point(log_tau, rows)
    # what is allowed without being told so is the best of all that is
    if restricted is None or (free.sse < np.inf and (free.beta[restricted] > 0).all()):
        return free
    return _point(log_tau, rows, nonnegative_columns(rows.phi, rows.target, restricted))


def _point(log_tau: FloatArray, rows: StackRows, active: BoolArray | None = None) -> StackTrial:
    """The point of some columns, all by default; an infinite SSE if they are dependent."""
    columns, p = rows
    fixed = 2 * p + 1 - len(columns)
    if active is not None:
        columns = np.concatenate((columns[:p][active], columns[p:]))
        p = int(active.sum())
    factor = triangle(columns)
    r = factor[:p, :p]
    pivot = r.diagonal()
    if len(factor) < p or (pivot * pivot <= 1e-26 * np.vecdot(r.T, r.T)).any():
        return _nowhere(log_tau, rows.width)
    return StackTrial.from_factor(log_tau, factor, fixed, active)


def _nowhere(log_tau: FloatArray, p: int) -> StackTrial:
    n = len(log_tau)
    return StackTrial(log_tau, np.zeros(p), np.inf, np.zeros(n), np.zeros((n, n)), np.zeros((p, n)))


def _spread(active: BoolArray, values: FloatArray) -> FloatArray:
    """Values of the active columns in their places among all, zero elsewhere."""
    out = np.zeros((len(active), *values.shape[1:]))
    out[active] = values
    return out


def descend(
    stack: Stack,
    start: FloatArray,
    *,
    restricted: BoolArray | None = None,
    wanted: BoolArray | None = None,
    rivals: Sequence[FloatArray] = (),
    finished: float = FINISHED,
    flat: float = 0.0,
    damping: float = 1e-3,
) -> LocalOptimum[StackTrial] | None:
    """As :func:`dashpot.numerics.least_squares.levenberg_marquardt.descend`, in ln tau, inside the
    window.

    Returns None when it runs into one of the `rivals` (optima already known) or when the
    start cannot be evaluated.
    """
    low, high = (np.full(len(start), end) for end in stack.bounds)
    objective = Objective(
        lambda log_tau, _: point_at(stack, log_tau, restricted=restricted),
        low, high, stack.floor, stack.rounding_floor,
    )  # fmt: skip
    return downhill(
        objective,
        np.sort(start),
        wanted=wanted,
        met=(lambda log_tau: _is_near_rival(log_tau, rivals)) if rivals else None,
        finished=finished,
        flat=flat,
        damping=damping,
    )


def is_inside_window(log_tau: FloatArray, bounds: tuple[float, float]) -> bool:
    """True if no relaxation time sits at an end of the window."""
    low, high = bounds
    return all(low < value < high for value in log_tau.tolist())


def _is_near_rival(log_tau: FloatArray, rivals: Sequence[FloatArray]) -> bool:
    return bool(np.abs(np.sort(log_tau) - rivals).max(axis=1).min() < 1e-2)


def relative_offset(point: StackTrial, sse: float) -> float:
    r"""The length of the residual that a Gauss-Newton step would still remove, over |r|.

    The criterion of D. M. Bates and D. G. Watts, *Technometrics* 23 (1981).
    """
    if not len(point.gradient) or sse <= 0:
        return 0.0
    try:
        step = np.linalg.solve(point.curvature, point.gradient)
    except np.linalg.LinAlgError:
        step = np.linalg.lstsq(point.curvature, point.gradient, rcond=1e-14)[0]
    return float(np.sqrt(abs(point.gradient @ step) / sse))
