"""Starting points in ln tau, and descent to the nearest optimum."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Hashable, Sequence
from functools import cached_property, lru_cache
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray, IndexArray
from dashpot.numerics.design_matrices.block import DataBlock, stiffnesses
from dashpot.numerics.least_squares import FINAL_TOLERANCE, LocalOptimum, Objective, triangle
from dashpot.numerics.least_squares import descend as descend_problem
from dashpot.numerics.nonnegative_least_squares import nonnegative_columns, solve_nonnegative
from dashpot.numerics.quasirandom import fill_unit_cube

# Descent in ln tau, linear parameters solved exactly.


class StackRows(NamedTuple):
    """Rows of a whole stack at one ln tau.

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
        """Target y (n,)."""
        return np.asarray(self.columns[-1])

    @property
    def phi(self) -> FloatArray:
        """The design matrix, (n, p)."""
        return self.columns[: self.width].T

    @property
    def slope(self) -> FloatArray:
        """Derivative of the columns by ln tau, (n, a)."""
        return self.columns[self.width : -1].T


class Stack:
    """Stacked blocks, their columns matched by name and group.

    The linear parameters are ordered as all fixed names, then the arms of the first group, of the
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
        #: how often :func:`solve_at` was asked
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
    def rounding_sse(self) -> float:
        """Residual sum of squares of a finished descent on exact data."""
        return max(self.rounding_floor, FINAL_TOLERANCE**2 * self.energy)

    def get_nonnegative_mask(self, arms: int, *, signed: bool) -> BoolArray:
        """Return which linear parameters must not be negative, shape (p,)."""
        nonnegative_mask = np.ones(len(self.names) + arms * len(self.groups), dtype=bool)
        nonnegative_mask[: len(self.names)] = stiffnesses(self.names)
        return nonnegative_mask & (not signed)

    def evaluate(self, log_tau: FloatArray, *, derivative: bool = True) -> StackRows:
        """Return the stacked design matrix, slopes if requested, and target."""
        rows_of_blocks = [block.evaluate(log_tau, derivative) for block in self.blocks]
        arms, q = len(log_tau), len(self.names)
        column_count = arms * len(self.groups)
        slopes = column_count if derivative else 0
        columns = np.zeros(
            (
                q + column_count + slopes + 1,
                sum(len(block_rows.target) for block_rows in rows_of_blocks),
            )
        )
        first = 0
        for (indices, group), block_rows in zip(self._places, rows_of_blocks, strict=True):
            rows = slice(first, first + len(block_rows.target))
            slope_column = q + group * arms
            columns[indices, rows] = block_rows.fixed.T
            columns[slope_column : slope_column + arms, rows] = block_rows.arms.T
            if derivative:
                columns[slope_column + column_count : slope_column + column_count + arms, rows] = (
                    block_rows.d_arms.T
                )
            columns[-1, rows] = block_rows.target
            first = rows.stop
        return StackRows(columns, q + column_count)

    @cached_property
    def _places(self) -> list[tuple[list[int], int]]:
        """The fixed columns of each block among all, and its group."""
        return [
            ([*map(self.names.index, block.fixed_names)], self.groups.index(block.arm_group))
            for block in self.blocks
        ]


class StackTrial(NamedTuple):
    r"""Trial ln tau with all linear parameters solved; of each record, if axes lead.

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
        """Parameters of the descent."""
        return self.log_tau

    @classmethod
    def from_factor(
        cls, log_tau: FloatArray, factor: FloatArray, fixed: int, active: BoolArray | None = None
    ) -> StackTrial:
        r"""Return the trial from the triangular factor of the `active` columns, slopes and target.

        With Phi = QR, r = (I - QQ')y and beta = R^{-1}Q'y, the derivative of r by ln tau_j is

        .. math:: J_j = -(I - QQ') D_j \beta_j - Q R^{-T} e_j (D_j' r)

        (G. H. Golub and V. Pereyra, *SIAM J. Numer. Anal.* 10, 1973); arms shared by several groups
        add up. The two terms are orthogonal, and only the first meets r. They are computed from the
        triangular factor of one QR,

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
        coefficients = inverse @ factor[..., :p, p:-1]
        inverse_rows = inverse
        if active is not None:
            beta, coefficients, inverse_rows = (
                _spread(active, values) for values in (beta, coefficients, inverse)
            )
        residual, upper_block = factor[..., p:, -1], factor[..., p:, p:-1]
        k = beta[..., fixed:]
        outward = (residual[..., None, :] @ upper_block)[..., 0, :]
        projected = inverse_rows[..., fixed:, :] * outward[..., None]
        scale = k[..., None, :]
        upper_block, coefficients = upper_block * scale, coefficients * scale
        gradient = -k * outward
        if k.shape[-1] > arms:
            gradient = gradient.reshape(-1, arms).sum(axis=0)
            projected = projected.reshape(-1, arms, p).sum(axis=0)
            upper_block = upper_block.reshape(len(upper_block), -1, arms).sum(axis=1)
            coefficients = coefficients.reshape(len(coefficients), -1, arms).sum(axis=1)
        transposed = projected.swapaxes(-1, -2)
        curvature = upper_block.swapaxes(-1, -2) @ upper_block + projected @ transposed
        # a Python number is compared faster
        sse = np.vecdot(residual, residual) if residual.ndim > 1 else float(residual @ residual)
        return cls(
            log_tau, beta, sse, gradient, curvature, inverse_rows @ transposed - coefficients
        )

    def step_ahead(self, step: FloatArray) -> StackTrial:
        """Return the point a short step away, where beta is linear and the SSE is flat."""
        rotated_step = (self.turn @ step[..., None])[..., 0]
        return self._replace(log_tau=self.log_tau + step, beta=self.beta + rotated_step)

    def take(self, index: IndexArray | BoolArray) -> StackTrial:
        """Copies of some records."""
        return StackTrial(*(array[index] for array in self))

    def put(self, index: IndexArray, new: StackTrial) -> None:
        """Write some records anew."""
        for record, updated in zip(self, new, strict=True):
            record[index] = updated


def solve_at(
    stack: Stack, log_tau: FloatArray, *, restricted: BoolArray | None = None
) -> StackTrial:
    r"""Solve the linear parameters at ln tau and differentiate the residual left over.

    With `restricted`, those coefficients stay >= 0; an arm at zero has no derivative. Columns that
    are dependent to 13 digits have an infinite SSE.
    """
    stack.trials += 1
    rows = stack.evaluate(log_tau)
    point = _point(log_tau, rows)
    # the free optimum, where it is allowed
    if restricted is None or (point.sse < np.inf and (point.beta[restricted] > 0).all()):
        return point
    return _point(log_tau, rows, nonnegative_columns(rows.phi, rows.target, restricted))


def _point(log_tau: FloatArray, rows: StackRows, active: BoolArray | None = None) -> StackTrial:
    """Return the point of some columns, all by default; an infinite SSE if they are dependent."""
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
    """Return values of the active columns in their places among all, zero elsewhere."""
    scattered = np.zeros((len(active), *values.shape[1:]))
    scattered[active] = values
    return scattered


def descend(
    stack: Stack,
    start: FloatArray,
    *,
    restricted: BoolArray | None = None,
    expected_positive: BoolArray | None = None,
    known_optima: Sequence[FloatArray] = (),
    step_tolerance: float = FINAL_TOLERANCE,
    cost_tolerance: float = 0.0,
    damping: float = 1e-3,
) -> LocalOptimum[StackTrial] | None:
    """As :func:`dashpot.numerics.least_squares.descend`, in ln tau, inside the
    window.

    Returns None when it runs into one of the `known_optima` (optima already known) or when the
    start cannot be evaluated.
    """
    low, high = (np.full(len(start), end) for end in stack.bounds)
    objective = Objective(
        lambda log_tau, _: solve_at(stack, log_tau, restricted=restricted),
        low, high, stack.floor, stack.rounding_floor,
    )  # fmt: skip
    return descend_problem(
        objective,
        np.sort(start),
        expected_positive=expected_positive,
        is_known_optimum=(lambda log_tau: _is_near_rival(log_tau, known_optima))
        if known_optima
        else None,
        step_tolerance=step_tolerance,
        cost_tolerance=cost_tolerance,
        damping=damping,
    )


def is_inside_window(log_tau: FloatArray, bounds: tuple[float, float]) -> bool:
    """Return whether no relaxation time sits at an end of the window."""
    low, high = bounds
    return all(low < value < high for value in log_tau.tolist())


def _is_near_rival(log_tau: FloatArray, known_optima: Sequence[FloatArray]) -> bool:
    return bool(np.abs(np.sort(log_tau) - known_optima).max(axis=1).min() < 1e-2)


def relative_offset(point: StackTrial, sse: float) -> float:
    r"""Return the length of the residual that a Gauss-Newton step would still remove, over |r|.

    The criterion of D. M. Bates and D. G. Watts, *Technometrics* 23 (1981).
    """
    if not len(point.gradient) or sse <= 0:
        return 0.0
    try:
        step = np.linalg.solve(point.curvature, point.gradient)
    except np.linalg.LinAlgError:
        step = np.linalg.lstsq(point.curvature, point.gradient, rcond=1e-14)[0]
    return float(np.sqrt(abs(point.gradient @ step) / sse))


# Starting points: peaks of the best positive spectrum, and of the dual gradient.


GRID_POINTS = 72
#: triples are first looked for among every so-many-th point
COARSE_STRIDE = 3
MAX_PEAKS = 9
#: samplings whose lattices are kept
MAX_CACHED = 8


class ColumnGrid(NamedTuple):
    """Columns of a stack on a grid of ln tau, free of the fixed columns, of unit length.

    Attributes
    ----------
    log_tau : array, shape (m,)
    rows : array, shape (G m, n)
        A row per column of the design matrix, group by group.
    length : array, shape (G m,)
        Norms before they were made one.
    gram : array, shape (G m, G m)
    basis : array, shape (n, q)
        Orthonormal columns that span the fixed ones.
    """

    log_tau: FloatArray
    rows: FloatArray
    length: FloatArray
    gram: FloatArray
    basis: FloatArray

    @classmethod
    def from_stack(
        cls, stack: Stack, log_tau: FloatArray, is_free: BoolArray | None = None
    ) -> tuple[ColumnGrid, FloatArray]:
        """Return the lattice, and the target in its coordinates.

        `is_free` marks the fixed columns with a coefficient not fixed at zero; all, by default.
        """
        stack_rows = stack.evaluate(log_tau, derivative=False)
        target, phi, q = stack_rows.target, stack_rows.phi, len(stack.names)
        rows = np.ascontiguousarray(phi.T[q:])
        fixed = phi[:, :q] if is_free is None else phi[:, :q][:, is_free]
        basis = np.linalg.qr(fixed)[0] if fixed.size else np.zeros((len(target), 0))
        raw = np.vecdot(rows, rows)
        rows -= (rows @ basis) @ basis.T
        remainder = np.vecdot(rows, rows)
        # a column that the fixed ones explain to seven digits points nowhere
        length = np.sqrt(np.where(remainder > 1e-14 * raw, remainder, np.inf))
        rows /= length[:, None]
        return cls(log_tau, rows, length, rows @ rows.T, basis), target


class _GridCache(OrderedDict[Hashable, ColumnGrid]):
    """The lattices of the last few samplings."""

    def get_grid(self, stack: Stack, size: int) -> tuple[ColumnGrid, FloatArray]:
        key = (stack.sampling, size)
        if key in self:
            return self[key], stack.blocks[0].target
        grid, target = ColumnGrid.from_stack(stack, np.linspace(*stack.bounds, size))
        if stack.sampling is None:
            return grid, target
        self[key] = grid
        if len(self) > MAX_CACHED:
            self.popitem(last=False)
        return grid, target


_KEPT_LATTICES = _GridCache()


class Grid:
    """Stack on a grid of ln tau: its columns, and their products with the data.

    Attributes
    ----------
    log_tau, columns, length, gram
        Of the :class:`ColumnGrid`; columns of shape (n, G m).
    moment : array, shape (G m,)
        Inner products of columns with the target.
    likely_positive : array, shape (m,), or None
        Where the best spectrum is likely to have weight.
    """

    def __init__(
        self,
        stack: Stack,
        size: int = GRID_POINTS,
        *,
        log_tau: FloatArray | None = None,
        is_free: BoolArray | None = None,
        likely_positive: BoolArray | None = None,
    ) -> None:
        if log_tau is None:
            cached, target = _KEPT_LATTICES.get_grid(stack, size)
        else:
            cached, target = ColumnGrid.from_stack(stack, log_tau, is_free)
        self.stack, self.near = stack, likely_positive
        self.groups = len(stack.groups)
        self.log_tau, self.length, self.gram = (cached.log_tau, cached.length, cached.gram)
        self.columns = cached.rows.T
        self.moment = cached.rows @ target
        self.target, self.basis = target, cached.basis

    @cached_property
    def aim(self) -> FloatArray:
        """The target, fixed columns swept out, shape (n,)."""
        return np.asarray(self.target - self.basis @ (self.basis.T @ self.target))

    @cached_property
    def spectrum(self) -> FloatArray:
        """Best non-negative spectrum on the grid, in unit columns, shape (G, m)."""
        likely_positive = None if self.near is None else np.tile(self.near, self.groups)
        values = solve_nonnegative(self.gram, self.moment, likely_positive)
        return np.asarray(values.reshape(self.groups, -1))

    @cached_property
    def residual_sse(self) -> float:
        """Residual sum of squares of the best spectrum."""
        residual = self.aim - self.columns @ self.spectrum.ravel()
        return float(residual @ residual)

    def dual_gradient(self, point: StackTrial, *, signed: bool) -> FloatArray:
        r"""Return the gain of one more arm at each grid point, shape (m,).

        :math:`D(\tau) = \hat\varphi_\perp' r`, with the columns of the point swept out of
        phi; negative where only a negative coefficient would help. Groups add as squares.
        """
        if len(point.log_tau):
            columns, residual, phi = self._compute_shared_rows(point)
            basis = np.linalg.qr(phi)[0]
            coefficients = basis.T @ columns
            remainder = np.sqrt(np.maximum(1.0 - (coefficients * coefficients).sum(axis=0), 0.0))
            dual_gradient = (columns.T @ residual) / np.where(remainder > 1e-4, remainder, np.inf)
        else:
            dual_gradient = self.moment
        dual_gradient = np.where(np.isfinite(self.length), dual_gradient, 0.0).reshape(
            self.groups, -1
        )
        if signed:
            return np.asarray(np.sqrt((dual_gradient * dual_gradient).sum(axis=0)))
        positive_gradient = np.maximum(dual_gradient, 0.0)
        return np.asarray(
            np.where(
                positive_gradient.any(axis=0),
                np.sqrt((positive_gradient * positive_gradient).sum(axis=0)),
                dual_gradient.max(axis=0),
            )
        )

    def _compute_shared_rows(self, point: StackTrial) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Grid columns, the point's residual and its columns, in common coordinates."""
        if not self.stack.rotated_basis:
            rows = self.stack.evaluate(point.log_tau, derivative=False)
            return self.columns, rows.target - rows.phi @ point.beta, rows.phi
        arms, q = len(point.log_tau), len(self.stack.names)
        log_tau = np.concatenate((point.log_tau, self.log_tau))
        rows = self.stack.evaluate(log_tau, derivative=False)
        arm_columns = rows.phi[:, q:].reshape(len(rows.target), self.groups, -1)
        fixed = rows.phi[:, :q]
        phi = np.concatenate((fixed, arm_columns[:, :, :arms].reshape(len(fixed), -1)), axis=1)
        grid = arm_columns[:, :, arms:].reshape(len(fixed), -1)
        basis = np.linalg.qr(fixed)[0]
        columns = (grid - basis @ (basis.T @ grid)) / self.length
        return columns, rows.target - phi @ point.beta, phi


def find_best_point(grid: Grid) -> FloatArray | None:
    """Return the grid point whose column, with a positive coefficient, fits best; for one group."""
    best_index = int(np.argmax(grid.moment))
    return grid.log_tau[best_index : best_index + 1] if grid.moment[best_index] > 0 else None


def find_best_pair(grid: Grid) -> FloatArray | None:
    r"""Next to the two grid points whose columns, both with positive coefficients, fit best.

    All pairs at once: unit columns with cosine c and moments m_1, m_2 explain
    :math:`(m_1^2 + m_2^2 - 2 c\, m_1 m_2)/(1 - c^2)` of the sum of squares. The best of them and
    its neighbours then show where between the points that is largest.
    """
    cosine, m = grid.gram, grid.moment
    determinant = 1.0 - cosine * cosine
    residual_gain = m[:, None] - cosine * m
    # neighbours that agree to five digits cannot be distinguished from one
    positive = residual_gain > 0
    allowed = positive & positive.T & (determinant > 1e-10)
    gain = np.divide(
        m[:, None] * residual_gain + m * residual_gain.T,
        determinant,
        out=np.zeros_like(cosine),
        where=allowed,
    )
    best = int(np.argmax(gain))
    if gain.flat[best] <= 0:
        return None
    i, j = sorted(divmod(best, len(m)))
    step = grid.log_tau[1] - grid.log_tau[0]
    return np.asarray(grid.log_tau[[i, j]] + step * _find_vertex(gain, i, j))


def _find_vertex(gain: FloatArray, i: int, j: int) -> FloatArray:
    """Return the maximum of the parabola through a largest value and its eight neighbours."""
    no_shift = np.zeros(2)
    if not 0 < i < j - 2 < len(gain) - 3:
        return no_shift
    (a, b, c), (d, e, f), (g, h, k) = gain[i - 1 : i + 2, j - 1 : j + 2].tolist()
    curvature_down, curvature_across, mixed_derivative = (
        b - 2 * e + h,
        d - 2 * e + f,
        (a - c - g + k) / 4,
    )
    determinant = curvature_down * curvature_across - mixed_derivative * mixed_derivative
    if min(a, b, c, d, f, g, h, k) <= 0 or curvature_down >= 0 or determinant <= 0:
        return no_shift
    by_row, by_column = (h - b) / 2, (f - d) / 2
    row = (mixed_derivative * by_column - curvature_across * by_row) / determinant
    column = (mixed_derivative * by_row - curvature_down * by_column) / determinant
    return np.array([max(-1.0, min(1.0, row)), max(-1.0, min(1.0, column))])


def find_best_triple(grid: Grid) -> FloatArray | None:
    """Return the three grid points whose columns, with positive coefficients, fit best.

    Of every third point, all triples; then around the best of them, the points between.
    """
    last = len(grid.log_tau) - 1
    sets = _list_triples(1 + last // COARSE_STRIDE)
    gain = _compute_triple_gain(grid, sets)
    best_index = int(np.argmax(gain))
    if gain[best_index] <= 0:
        return None
    offsets = np.indices((2 * COARSE_STRIDE - 1,) * 3).reshape(3, -1) - (COARSE_STRIDE - 1)
    finer_triples = np.clip(offsets + np.array([[values[best_index]] for values in sets]), 0, last)
    return np.asarray(
        grid.log_tau[finer_triples[:, int(np.argmax(_compute_triple_gain(grid, finer_triples)))]]
    )


def _compute_triple_gain(grid: Grid, sets: IndexArray) -> FloatArray:
    """Return the sum of squares explained by triples of grid points, (3, sets): Cramer's rule.

    Zero where a coefficient would not be positive, or two points are one.
    """
    first, second, third = sets
    m1, m2, m3 = grid.moment[sets]
    c12, c13, c23 = (grid.gram[i, j] for i, j in ((first, second), (first, third), (second, third)))
    minor12, minor13, minor23 = c13 * c23 - c12, c12 * c23 - c13, c12 * c13 - c23
    beta1 = (1 - c23 * c23) * m1 + minor12 * m2 + minor13 * m3
    beta2 = minor12 * m1 + (1 - c13 * c13) * m2 + minor23 * m3
    beta3 = minor13 * m1 + minor23 * m2 + (1 - c12 * c12) * m3
    determinant = 1 - c23 * c23 + c12 * minor12 + c13 * minor13
    allowed = (np.minimum(np.minimum(beta1, beta2), beta3) > 0) & (determinant > 1e-10)
    explained = beta1 * m1 + beta2 * m2 + beta3 * m3
    no_gain = np.zeros_like(m1)
    return np.asarray(np.divide(explained, determinant, out=no_gain, where=allowed))


@lru_cache(maxsize=2)
def _list_triples(size: int) -> IndexArray:
    """Return all i < j < k below size, three rows, with a stride of COARSE_STRIDE."""
    i = np.arange(size)
    return COARSE_STRIDE * np.array(np.nonzero((i[:, None, None] < i[:, None]) & (i[:, None] < i)))


def make_insertion_starts(
    grid: Grid, point: StackTrial, *, signed: bool, count: int
) -> list[FloatArray]:
    """Starts with one arm more than the point, at the highest maxima of its dual gradient."""
    dual_gradient = grid.dual_gradient(point, signed=signed)
    padded_gradient = np.concatenate(([-np.inf], dual_gradient, [-np.inf]))
    peaks = np.flatnonzero(
        (dual_gradient >= padded_gradient[:-2])
        & (dual_gradient > padded_gradient[2:])
        & (dual_gradient > 0)
    )
    highest_peaks = peaks[np.argsort(-dual_gradient[peaks], kind="stable")][:count]
    return [np.sort(np.append(point.log_tau, grid.log_tau[i])) for i in highest_peaks]


def find_peaks(grid: Grid) -> tuple[FloatArray, FloatArray]:
    """Positions in ln tau and weights of the spectrum's peaks, neighbours merged."""
    weight = grid.spectrum.sum(axis=0)
    support = np.flatnonzero(weight > 1e-9 * weight.max(initial=0.0))
    if not len(support):
        return np.zeros(0), np.zeros(0)
    runs = np.split(support, np.flatnonzero(np.diff(support) > 1) + 1)
    mass = np.array([weight[run].sum() for run in runs])
    log_tau_peaks = np.array([weight[run] @ grid.log_tau[run] for run in runs]) / mass
    keep = np.sort(np.argsort(-mass, kind="stable")[:MAX_PEAKS])
    return log_tau_peaks[keep], mass[keep]


def make_partition_starts(
    grid: Grid, log_tau: FloatArray, mass: FloatArray, arms: int, count: int = 2
) -> list[FloatArray]:
    """Starts from the peaks: contiguous groups merged, or some peaks alone; best by one LSQ."""
    m = len(log_tau)
    if m < arms:
        return []
    candidates: dict[tuple[int, ...], FloatArray] = {}
    weighted_sums = np.concatenate(([0.0], np.cumsum(mass * log_tau)))
    total = np.concatenate(([0.0], np.cumsum(mass)))
    step = grid.log_tau[1] - grid.log_tau[0]
    for cuts in combinations(range(1, m), arms - 1):
        group_edges = np.array((0, *cuts, m))
        start = np.diff(weighted_sums[group_edges]) / np.diff(total[group_edges])
        candidates.setdefault(tuple(np.rint((start - grid.log_tau[0]) / step).astype(int)), start)
    for indices in combinations(range(m), arms):
        start = log_tau[list(indices)]
        candidates.setdefault(tuple(np.rint((start - grid.log_tau[0]) / step).astype(int)), start)
    distinct = [key for key in candidates if len(set(key)) == arms]
    if not distinct:
        return []
    index = np.array(distinct)
    index = (index[:, None, :] + len(grid.log_tau) * np.arange(grid.groups)[:, None]).reshape(
        len(distinct), -1
    )
    gram = grid.gram[index[:, :, None], index[:, None, :]] + 1e-12 * np.eye(index.shape[1])
    moment = grid.moment[index]
    beta = np.linalg.solve(gram, moment[..., None])[..., 0]
    # negative coefficients count for nothing in the ranking
    gain = np.where((beta > 0).all(axis=1), 1.0, 0.5) * (moment * beta).sum(axis=1)
    order = np.argsort(-gain, kind="stable")[:count]
    return [candidates[distinct[int(i)]] for i in order]


def draw_quasirandom_starts(stack: Stack, arms: int, count: int, seed: int) -> list[FloatArray]:
    """Return quasi-random starts that fill the window, shifted by the seed."""
    points = fill_unit_cube(count, arms, np.random.default_rng(seed).random(arms))
    low, high = stack.bounds
    return [np.sort(low + (high - low) * row) for row in points]
