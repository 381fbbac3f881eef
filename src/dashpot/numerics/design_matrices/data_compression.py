"""Compression of data: weighted samples, and a basis of all relaxation kernels."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray, IndexArray
from dashpot.numerics.design_matrices.block import Columns, DataBlock, Rows, design_rows

# Weighted samples: a few hundred in place of many, with the same fit.
#
# A sum of exponentials is smooth on every block [a, 2a) counted from the first sample. On a
# block of m samples with weights, let P_0 ... P_12 be the polynomials orthonormal over the
# samples, and x_i, w_i the nodes and weights of the Gauss rule of that discrete measure. Then
#
# .. math:: \sum_{s \in block} w_s (y_s - F(s))^2
#           = \underbrace{|y - PP'y|^2}_{\mathrm{floor}}
#           + \sum_{i} \bigl(z_i - \sqrt{w_i} F(x_i)\bigr)^2 + O(10^{-11} |F|),
#           \qquad z_i = \sqrt{w_i} \sum_p P_p(x_i)\, (P'y)_p
#
# for every smooth F at once. The floor is |y|^2 - |z|^2, y counted from its last value, where that
# difference keeps 10 digits, and the sum of explicit residuals where it does not. Golub and
# Welsch,
# *Math. Comp.* 23 (1969), give nodes and weights from the Jacobi matrix P' x P.


NODES_PER_PIECE = 13
NODES_PER_SUBPIECE = 8
#: samples of a piece, which starts at NODES_PER_PIECE times its length or later
PIECE_LENGTHS = (1, 32, 256, 2048)
SMALL_BLOCK = 300
#: samples worked on at once
CACHE_SAMPLES = 16_384
_SAMPLE_NUMBERS = np.arange(float(CACHE_SAMPLES))
#: relative accuracy of a compressed model's columns
ACCURACY = 1e-11
#: share of the data's sum of squares from which a difference of such sums keeps 10 digits
MIN_REMAINDER_SHARE = 1e-5


class _RecordSection(NamedTuple):
    """Samples start:stop, cut into equal pieces, each projected on the same orthonormal basis."""

    start: int
    stop: int
    basis: FloatArray  # (length of a piece, points of a piece)


@dataclass(frozen=True, eq=False)
class DataCompression:
    """Compression of a sampling, made once and used for every record on it.

    Attributes
    ----------
    nodes : array, shape (n,)
        Positions of the pseudo-samples, in the unit of the sampling.
    root_weight : array, shape (n,)
        Square roots of their weights: the columns of a model F are root_weight * F(nodes).
    step : float or None
        The interval of a uniform sampling.
    weighted : bool
        The values to compress come multiplied by weights.
    """

    nodes: FloatArray
    root_weight: FloatArray
    stages: tuple[tuple[_RecordSection, ...], ...]
    step: float | None = None
    weighted: bool = False

    @property
    def samples(self) -> int:
        """Number of samples that are compressed."""
        return self.stages[0][-1].stop if self.stages else len(self.nodes)

    def project(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Compress weighted values, shape (..., M), to z (..., n) and floor (...)."""
        if self.weighted or not self.stages:
            return self._explicit(values)
        # a constant is its own compression; without it the differences below are of small numbers
        last_value = values[..., -1:]
        differences = values - last_value
        z = _apply_stages(differences, self.stages)
        energy = _sum_squares(differences)
        remainder_sse = energy - _sum_squares(z)
        if (remainder_sse < MIN_REMAINDER_SHARE * energy).any():
            z, remainder_sse = self._explicit(differences)
        return z + last_value * self.root_weight, remainder_sse

    def compress_to_nodes(self, values: FloatArray) -> FloatArray:
        """Compress and forget the floor: all that inner products with smooth functions need."""
        return _apply_stages(values, self.stages)

    def compute_stacked_nodes(self, sequences: Sequence[FloatArray]) -> FloatArray:
        """Return `nodes_of` for sequences of shape (M,) as rows, one by one while they are long."""
        first = np.stack([_apply_stages(sequence, self.stages[:1]) for sequence in sequences])
        return _apply_stages(first, self.stages[1:])

    def _explicit(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the projection with the remainder summed explicitly, without cancellation."""
        remainder_sse = np.zeros(values.shape[:-1])
        for sections in self.stages:
            projections = []
            for section in sections:
                piece_values, z = _cut_into_pieces(values, section)
                if len(section.basis) > 1:
                    remainder_sse = remainder_sse + _compute_residual_sse(
                        piece_values, z.reshape(*piece_values.shape[:-1], -1), section.basis
                    )
                projections.append(z)
            values = np.concatenate(projections, axis=-1)
        return values, remainder_sse


def project_values(
    plans: Sequence[DataCompression], values: FloatArray
) -> tuple[FloatArray, FloatArray | float]:
    """Compress values, shape (..., M), of several plans in sequence."""
    projections, first_sample = [], 0
    remainder_sse: FloatArray | float = 0.0
    for plan in plans:
        projection, projection_sse = plan.project(
            values[..., first_sample : first_sample + plan.samples]
        )
        projections.append(projection)
        remainder_sse = remainder_sse + projection_sse
        first_sample += plan.samples
    return np.concatenate(projections, axis=-1), remainder_sse


def _apply_stages(values: FloatArray, stages: Sequence[tuple[_RecordSection, ...]]) -> FloatArray:
    for sections in stages:
        values = np.concatenate(
            [_cut_into_pieces(values, section)[1] for section in sections], axis=-1
        )
    return values


def _sum_squares(values: FloatArray) -> FloatArray:
    return np.asarray(np.vecdot(values, values))


def _cut_into_pieces(values: FloatArray, section: _RecordSection) -> tuple[FloatArray, FloatArray]:
    """Return a section's pieces, (..., pieces, length), and their projections, (..., points)."""
    section_values = values[..., section.start : section.stop]
    length = len(section.basis)
    if length == 1:
        return section_values, section_values
    if length == section_values.shape[-1]:
        return section_values[..., None, :], section_values @ section.basis
    pieces = section_values.reshape(*values.shape[:-1], -1, length)
    return pieces, (pieces @ section.basis).reshape(*values.shape[:-1], -1)


def _compute_residual_sse(pieces: FloatArray, z: FloatArray, basis: FloatArray) -> FloatArray:
    """Sum of squares of the explicit residual, a stretch at a time so that it stays in cache."""
    total = np.zeros(pieces.shape[:-2])
    pieces_at_once = max(1, CACHE_SAMPLES // (total.size * len(basis)))
    for first in range(0, pieces.shape[-2], pieces_at_once):
        span = slice(first, first + pieces_at_once)
        residual = z[..., span, :] @ basis.T
        np.subtract(pieces[..., span, :], residual, out=residual)
        total = total + np.einsum("...ij,...ij->...", residual, residual)
    return total


def plan_compression(
    position: FloatArray, weights: FloatArray | None = None, *, step: float | None = None
) -> DataCompression:
    """Plan the compression of a sampling, positions ascending from where the decay starts.

    Parameters
    ----------
    position : array, shape (M,)
        Times, s, any spacing.
    weights : array, shape (M,), optional
        1/sd of each sample, > 0; values must be multiplied by them before `project`.
    step : float, optional
        The interval of a sampling known to be uniform.
    """
    step = step or uniform_step(position)
    if len(position) <= SMALL_BLOCK:
        return make_identity_plan(position, weights, step=step)
    if weights is None and step is not None:
        plan = make_sample_plan(len(position))
        nodes = position[0] + step * plan.nodes
        return DataCompression(nodes, plan.root_weight, plan.stages, step)
    root = np.ones(len(position)) if weights is None else weights
    nodes, root, sections = _place_nodes(position - position[0], root)
    return DataCompression(position[0] + nodes, root, (sections,), step, weights is not None)


def make_identity_plan(
    position: FloatArray, weights: FloatArray | None = None, *, step: float | None = None
) -> DataCompression:
    """Return every sample its own node."""
    root = np.ones(len(position)) if weights is None else weights
    return DataCompression(position, root, (), step or uniform_step(position), weights is not None)


def uniform_step(position: FloatArray) -> float | None:
    """Return the sample interval if the samples are uniform up to rounding."""
    if len(position) < 2:
        return None
    step = float(position[-1] - position[0]) / (len(position) - 1)
    if not step > 0:
        return None
    tolerance = max(1e-9 * step, 8e-16 * float(max(abs(position[0]), abs(position[-1]))))
    grid = step * _SAMPLE_NUMBERS[: len(position)]
    for first in range(0, len(position), CACHE_SAMPLES):
        span = position[first : first + CACHE_SAMPLES]
        deviation = span - grid[: len(span)]
        deviation -= float(position[0]) + step * first
        # the sum of squares, which is cheaper, bounds the largest
        if (
            deviation @ deviation > tolerance**2
            and max(float(deviation.max()), -float(deviation.min())) > tolerance
        ):
            return None
    return step


@lru_cache(maxsize=32)
def make_sample_plan(count: int) -> DataCompression:
    """Plan for samples 0, 1, 2, ... in two stages: short equal pieces, then doubling blocks."""
    if count <= SMALL_BLOCK:
        return make_identity_plan(np.arange(float(count)))
    position: list[FloatArray] = []
    weight: list[FloatArray] = []
    sections: list[_RecordSection] = []
    start = 0
    # ever longer pieces while they are short beside their distance from the start, then the rest
    stops = [
        *(min(count, NODES_PER_PIECE * length_factor) for length_factor in PIECE_LENGTHS[1:]),
        count,
    ]
    rest = [(length, count) for length in PIECE_LENGTHS[::-1]]
    for length, stop in [*zip(PIECE_LENGTHS, stops, strict=True), *rest]:
        pieces = (stop - start) // length
        if pieces > 0:
            nodes, root, basis = _piece(length)
            first = start + length * np.arange(pieces)
            position.append((first[:, None] + nodes).ravel())
            weight.append(np.tile(root, pieces))
            sections.append(_RecordSection(start, start + pieces * length, basis))
            start += pieces * length
    positions, root = np.concatenate(position), np.concatenate(weight)
    edges = np.array(_doubling(count)[1:-1]) - 0.5
    nodes, root, second = _place_nodes(positions, root, np.searchsorted(positions, edges))
    return DataCompression(nodes, root, (tuple(sections), second))


@lru_cache(maxsize=32)
def _piece(length: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Nodes, root weights and basis of one short piece of equal samples."""
    if length == 1:
        return np.zeros(1), np.ones(1), np.ones((1, 1))
    return compute_gauss_nodes(np.arange(float(length)), np.ones(length), NODES_PER_SUBPIECE)


def _doubling(count: int) -> list[int]:
    """Edges 0, 13, 26, 52, ... count; a last block that would be short joins its neighbour."""
    edges = [0, NODES_PER_PIECE]
    while 2 * edges[-1] < count:
        edges.append(2 * edges[-1])
    if count - edges[-1] < edges[-1] // 8 and len(edges) > 2:
        edges.pop()
    return [*edges, count]


def _place_nodes(
    position: FloatArray, root_weight: FloatArray, block_edges: IndexArray | None = None
) -> tuple[FloatArray, FloatArray, tuple[_RecordSection, ...]]:
    """Gauss nodes of every block; cuts are the indices where a new block starts."""
    if block_edges is None:
        first = position[NODES_PER_PIECE]
        doublings = int(np.ceil(np.log2(position[-1] / first)))
        block_edges = np.searchsorted(position, first * 2.0 ** np.arange(doublings))
    edges = sorted({0, *block_edges.tolist(), len(position)})
    nodes, roots, sections = [], [], []
    for start, stop in pairwise(edges):
        span = slice(start, stop)
        if span.stop - span.start <= NODES_PER_PIECE:
            nodes.append(position[span])
            roots.append(root_weight[span])
            sections.append(_RecordSection(span.start, span.stop, np.ones((1, 1))))
            continue
        node, root, basis = compute_gauss_nodes(position[span], root_weight[span], NODES_PER_PIECE)
        nodes.append(node)
        roots.append(root)
        sections.append(_RecordSection(span.start, span.stop, basis))
    return np.concatenate(nodes), np.concatenate(roots), tuple(sections)


def compute_gauss_nodes(
    position: FloatArray, root_weight: FloatArray, count: int
) -> tuple[FloatArray, FloatArray, FloatArray]:
    r"""Return nodes, root weights and basis W (m, count) of a discrete measure.

    W is orthonormal and spans the weighted polynomials of degree < count; W'y are the
    pseudo-samples z. The QR of a Chebyshev basis is graded by degree, so its columns are the
    orthonormal polynomials P, and the eigenvectors of P'xP turn them into W.
    """
    centre = 0.5 * (position[0] + position[-1])
    half_length = 0.5 * (position[-1] - position[0])
    u = (position - centre) / half_length
    chebyshev = np.empty((len(u), count))
    chebyshev[:, 0] = root_weight
    chebyshev[:, 1] = root_weight * u
    for p in range(2, count):
        chebyshev[:, p] = 2 * u * chebyshev[:, p - 1] - chebyshev[:, p - 2]
    q, r = np.linalg.qr(chebyshev)
    q = q * np.sign(np.diagonal(r))
    jacobi = q.T @ (u[:, None] * q)
    value, vector = np.linalg.eigh(0.5 * (jacobi + jacobi.T))
    vector = vector * np.where(vector[0] < 0, -1.0, 1.0)
    total = float(np.linalg.norm(root_weight))
    return centre + half_length * value, total * vector[0], q @ vector


# Space of all relaxation kernels of a window.
#
# With K fixed relaxation times, the kernels at them sampled at some 300 lags as the columns of
# :math:`E = U S V'`, and :math:`e(\tau)` any other sampled at the same lags,
#
# .. math:: e^{-t/\tau} = \sum_k c_k(\tau)\, e^{-t/\tau_k} + O(\epsilon), \qquad
#     c(\tau) = V S^{-1} U' e(\tau)
#
# A column that is a linear image of its kernel is then the same sum of the images at the fixed
# times, computed once:
#
# .. math:: \varphi(\tau) = \Phi V S^{-1} U' e(\tau)
#
# Over all relaxation times of a window the kernels span, to rounding, about sixty dimensions, so
# that any long record, whatever its clock, weights and history, is a block of some seventy rows.


MAX_LAG = 300
TIMES_PER_FOLD = 9.5
RANK_TOLERANCE = 1e-15
#: the same where a few digits do
FEW_TIMES_PER_FOLD, FEW_DIGITS_RANK_TOLERANCE, FEW_DIGITS_ACCURACY = 5.0, 1e-9, 1e-7
TIMES_PER_BATCH = 16
ROWS_PER_BATCH = 2048


class Kernels(NamedTuple):
    """Kernels of fixed relaxation times, and the matrix from their columns to any other's.

    Attributes
    ----------
    tau : array, shape (K,)
        s.
    lags : array, shape (L,)
        s.
    column_basis : array, shape (K, r)
        V: the columns at the fixed times times this span all others.
    projection : array, shape (r, L)
        S^-1 U': turns e(tau) into coordinates of that span.
    """

    tau: FloatArray
    lags: FloatArray
    column_basis: FloatArray
    projection: FloatArray

    @classmethod
    def from_window(cls, window: tuple[float, float], *, per_fold: float, rank: float) -> Kernels:
        """Return the kernels of relaxation times in `window`, s.

        `per_fold` fixed times per factor e; directions weaker than `rank` of the strongest are
        omitted.
        """
        shortest, longest = window
        # kernels scale with the clock: they are made for a window that starts at one
        folds = round(float(np.log(longest / shortest)) + 0.05, 1)
        tau, lags, right_vectors, projection = _make_unit_kernels(folds, per_fold, rank)
        return cls(tau * shortest, lags * shortest, right_vectors, projection)

    def space(
        self, exact: DataBlock, change: Callable[[FloatArray], FloatArray] = np.asarray
    ) -> FloatArray:
        r"""Return the space :math:`\Phi V` of a block that has every sample as a row, shape (n, r).

        `change` is a linear one of the rows.
        """
        projected = np.zeros(())
        for first in range(0, len(self.tau), TIMES_PER_BATCH):
            rows = slice(first, first + TIMES_PER_BATCH)
            arms = change(exact.evaluate(np.log(self.tau[rows]), False).arms)
            projected = projected + arms @ self.column_basis[rows]
        return projected

    def columns(self, operator: FloatArray) -> Columns:
        r"""Return columns :math:`A\, S^{-1} U' e(\tau)` and their slopes, for A of shape (n, r)."""
        full_columns = operator @ self.projection

        def columns(at: FloatArray, derivative: bool) -> tuple[FloatArray, FloatArray]:
            x = self.lags[:, None] / at
            decay = np.exp(-x)
            arms = full_columns @ decay
            return (arms, full_columns @ (x * decay)) if derivative else (arms, arms)

        return columns

    def rows(self, factor: FloatArray) -> Rows:
        """Rows from the triangular factor of columns in this space, fixed columns and target."""
        rank = self.column_basis.shape[1]
        columns = self.columns(factor[:-1, :rank])
        return design_rows(factor[:-1, -1], factor[:-1, rank:-1], columns)


@lru_cache(maxsize=8)
def _make_unit_kernels(log_range: float, per_fold: float, rank: float) -> Kernels:
    tau = np.exp(np.linspace(-0.3, log_range + 0.3, round(per_fold * log_range)))
    lags = np.concatenate(([0.0], np.exp(np.linspace(np.log(0.25), log_range, MAX_LAG))))
    u, s, vt = np.linalg.svd(np.exp(-lags[:, None] / tau), full_matrices=False)
    keep = s > rank * s[0]
    return Kernels(tau, lags, vt[keep].T, u[:, keep].T / s[keep, None])


def reduced_block(exact: DataBlock, *, tau_range: tuple[float, float] | None = None) -> DataBlock:
    r"""Return the same data in orthogonal coordinates, one row per dimension of the kernels' space.

    One triangular factor of :math:`[\Phi V, G, y]` turns every later trial into a product of small
    matrices.

    Parameters
    ----------
    exact : DataBlock
        Every sample as a row; its window's upper end is at least the record's span.
    tau_range : (float, float), optional
        Relaxation times to be evaluated, s; those of the window, if omitted.
    """
    kernels = Kernels.from_window(
        tau_range or exact.window, per_fold=TIMES_PER_FOLD, rank=RANK_TOLERANCE
    )
    target, fixed, *_ = exact.evaluate(np.zeros(0), False)
    all_columns = np.concatenate((kernels.space(exact), fixed, target[:, None]), axis=1)
    factor = all_columns[:0]
    for first in range(0, len(all_columns), ROWS_PER_BATCH):
        rows = np.concatenate((factor, all_columns[first : first + ROWS_PER_BATCH]))
        factor = np.asarray(np.linalg.qr(rows, mode="r"))
    factor = _append_floor_row(factor)
    return replace(
        exact,
        rows=kernels.rows(factor),
        floor=float(factor[-1, -1] ** 2),
        accuracy=ACCURACY,
        build_full=lambda: exact,
        add_fixed_column=lambda name, column: reduced_block(
            exact.with_column(name, column), tau_range=tau_range
        ),
    )


def _append_floor_row(factor: FloatArray) -> FloatArray:
    """Return the factor with a last row for the residual that no column reaches, if any."""
    rows, columns = factor.shape
    return np.concatenate((factor, np.zeros((1, columns)))) if rows < columns else factor


def compact_block(block: DataBlock, *, excess: float) -> DataBlock:
    r"""Return a block in as few rows as its kernels span, for many trials that need few digits.

    The columns at fixed relaxation times come from the block itself, whatever its form, and all
    others from theirs.

    Parameters
    ----------
    block : DataBlock
        Block of any rows, compressed or not.
    excess : float
        Relaxation times up to this factor outside the window are to be evaluated.
    """
    shortest, longest = block.window
    kernels = Kernels.from_window(
        (shortest / excess, longest * excess),
        per_fold=FEW_TIMES_PER_FOLD,
        rank=FEW_DIGITS_RANK_TOLERANCE,
    )
    evaluation = block.evaluate(np.log(kernels.tau), False)
    column_groups = (
        evaluation.arms @ kernels.column_basis,
        evaluation.fixed,
        evaluation.target[:, None],
    )
    factor = _append_floor_row(
        np.asarray(np.linalg.qr(np.concatenate(column_groups, axis=1), mode="r"))
    )
    return replace(
        block,
        rows=kernels.rows(factor),
        floor=block.floor + float(factor[-1, -1] ** 2),
        accuracy=FEW_DIGITS_ACCURACY,
        rotated_basis=False,
        sampling=None,
        build_full=None,
        add_fixed_column=None,
    )
