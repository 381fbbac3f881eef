"""Records with a shared sampling, compressed for a batched fit."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from functools import partial
from typing import ClassVar, NamedTuple

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import BoolArray, FloatArray, IndexArray
from dashpot.base.errors import DataError
from dashpot.numerics.design_matrices.block import DataBlock, stiffnesses
from dashpot.numerics.design_matrices.data_compression import (
    DataCompression,
    plan_compression,
    project_values,
    uniform_step,
)
from dashpot.numerics.design_matrices.displacement_correlation import (
    ROUNDING,
    ConvolvedMotion,
    Force,
    correlate_displacement,
    upper_factor,
)
from dashpot.numerics.design_matrices.recorded_motion import build_hold_block, build_recorded_block

#: number of samples that are compressed together
BATCH_SIZE = 400_000
TIMES_PER_FOLD = 9.5
RANK = 1e-14


class ReducedRecords(NamedTuple):
    """Records of a family, compressed for a fit."""

    data: tuple[FloatArray, ...]  # arrays whose first axis is the record
    floor: FloatArray  # (R,)
    energy: FloatArray  # (R,) sum of squares of what the rows hold

    def select(self, index: IndexArray | BoolArray) -> ReducedRecords:
        """Return some of the records."""
        return ReducedRecords(
            tuple(part[index] for part in self.data), self.floor[index], self.energy[index]
        )


@dataclass(frozen=True, eq=False)
class SharedSampling(ABC):
    """Records that share a sampling and a history, so that only the data differ.

    Attributes
    ----------
    build_block : callable
        Makes the block of one record, shape (M,).
    template : DataBlock
        Data block of a record of zeros.
    rounding_floor : float
        Relative sum of squares that is rounding.
    """

    build_block: Callable[[FloatArray], DataBlock]
    template: DataBlock
    rounding_floor: ClassVar[float] = ROUNDING

    @property
    def fixed_count(self) -> int:
        """Number of fixed columns."""
        return len(self.template.fixed_names)

    @property
    def nonnegative(self) -> BoolArray:
        """Mask of the fixed coefficients that are stiffnesses, shape (q,)."""
        return stiffnesses(self.template.fixed_names)

    def reduce(self, values: FloatArray) -> ReducedRecords:
        """Reduce records, shape (R, M), a few at a time: they stay in the cache."""
        records_at_once = max(1, BATCH_SIZE // values.shape[1])
        parts = [
            self._reduce_records(values[i : i + records_at_once])
            for i in range(0, len(values), records_at_once)
        ]
        data, remainder_sse, energy = zip(*parts, strict=True)
        stacked = tuple(np.concatenate(part) for part in zip(*data, strict=True))
        return ReducedRecords(stacked, np.concatenate(remainder_sse), np.concatenate(energy))

    @abstractmethod
    def _reduce_records(self, values: FloatArray) -> ReducedRecords: ...

    @abstractmethod
    def compute_triangular_factors(
        self, log_tau: FloatArray, reduced: ReducedRecords, *, exact: bool
    ) -> FloatArray:
        """Triangular factors of [fixed, arms, slopes, y] at ln tau (R, N), one per record.

        `exact` asks for the factor that does not go through a Gram matrix, if there is one.
        """

    @abstractmethod
    def moments(
        self, log_tau: FloatArray, reduced: ReducedRecords
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Gram of [fixed, arms] at shared ln tau (G,), products with y: (R, q) and (R, G)."""


def make_hold_family(
    time: FloatArray, *, depth: float, ramp_time: float, ramp: bool = False
) -> CompressedFamily:
    """Holds after an ideal ramp, or with it
    (:func:`~dashpot.numerics.design_matrices.recorded_motion.build_hold_block`).
    """
    make = partial(build_hold_block, depth=depth, ramp_time=ramp_time, ramp=ramp)
    if not ramp:
        return _make_compressed_family(time, (plan_compression(time),), make)
    first = int(np.searchsorted(time, ramp_time))
    plans = plan_compression(time[:first]), plan_compression(time[first:] - ramp_time)
    return _make_compressed_family(time, plans, make, second_from=ramp_time)


def make_recorded_family(
    time: FloatArray, displacement: FloatArray, *, window: slice = slice(None)
) -> RecordedFamily:
    """Forces under one recorded displacement (:func:`.build_recorded_block`).

    Raises
    ------
    DataError
        If the grid is not uniform or the displacement does not start at zero: nothing can be
        shared there.
    """
    x, (start, stop, _) = np.asarray(displacement, dtype=float), window.indices(len(time))
    if not shares_correlation(time, x):
        raise DataError("records share a correlation only on a uniform grid and from x = 0")
    make = partial(build_recorded_block, time, x, window=slice(start, stop))
    convolved_motion = correlate_displacement(time, x, x[start:stop, None], start=start, stop=stop)
    return RecordedFamily(make, make(np.zeros(len(time))), convolved_motion)


def shares_correlation(time: FloatArray, displacement: FloatArray) -> bool:
    """Return whether forces under this displacement can be correlated with it once for all."""
    return displacement[0] == 0 and uniform_step(time) is not None


class ColumnSpace(NamedTuple):
    r"""Low-dimensional space of the compressed columns of a sampling.

    With B an orthonormal basis of them, the fixed columns first, :math:`G = B_f F`, and S as many
    nodes as it has columns, so chosen that B_S is well conditioned,

    .. math:: B'\varphi(\tau) = B_S^{-1} \varphi_S(\tau)

    Attributes
    ----------
    basis : array, shape (n, q + r)
    triangular_factor : array, shape (q, q)
        F.
    inverse : array, shape (q + r, q + r)
        The inverse of B_S.
    node_columns : DataBlock
        The columns at the nodes S alone.
    """

    basis: FloatArray
    triangular_factor: FloatArray
    inverse: FloatArray
    node_columns: DataBlock


def build_column_space(
    template: DataBlock, at_nodes: Callable[[IndexArray], DataBlock]
) -> ColumnSpace:
    """Return the space of a block's columns; `at_nodes` makes the block at some of its rows."""
    low, high = template.bounds
    log_tau = np.linspace(low, high, round(TIMES_PER_FOLD * (high - low)))
    _, values, columns, _ = template.evaluate(log_tau, False)
    fixed = np.linalg.qr(values)[0]
    projected = columns - fixed @ (fixed.T @ columns)
    u, s, _ = np.linalg.svd(projected / np.linalg.norm(columns, axis=0), full_matrices=False)
    # the last directions hold rounding along the fixed columns
    basis, r = np.linalg.qr(np.concatenate((values, u[:, s > RANK * s[0]]), axis=1))
    nodes, q = _select_independent_rows(basis), values.shape[1]
    return ColumnSpace(basis, r[:q, :q], np.linalg.inv(basis[nodes]), at_nodes(nodes))


def _select_independent_rows(basis: FloatArray) -> IndexArray:
    """Return as many row indices as columns, each farthest from the span of those before it."""
    remainder, indices = basis.copy(), []
    for _ in range(basis.shape[1]):
        square = np.vecdot(remainder, remainder)
        indices.append(int(np.argmax(square)))
        unit = remainder[indices[-1]] / np.sqrt(square[indices[-1]])
        remainder -= np.outer(remainder @ unit, unit)
    return np.sort(np.array(indices))


def _make_compressed_family(
    time: FloatArray,
    plans: tuple[DataCompression, ...],
    make: Callable[..., DataBlock],
    *,
    second_from: float = 0.0,
) -> CompressedFamily:
    origins = (0.0, second_from)
    nodes = np.concatenate(
        [plan.nodes + origin for plan, origin in zip(plans, origins, strict=False)]
    )
    root = np.concatenate([plan.root_weight for plan in plans])

    def make_node_block(indices: IndexArray) -> DataBlock:
        zeros = np.zeros(len(indices))
        return make(nodes[indices], zeros, weights=root[indices], compress=False)

    block = partial(make, time)
    template = block(np.zeros(len(time)))
    return CompressedFamily(block, template, plans, build_column_space(template, make_node_block))


@dataclass(frozen=True, eq=False)
class CompressedFamily(SharedSampling):
    """Records of a hold, a ramp and hold, or a free decay on one sampling.

    A record is reduced as its coordinates in the space of the sampling's columns, those along the
    fixed columns apart: Gram matrices of the others then hold no large constant.
    """

    plans: tuple[DataCompression, ...]
    space: ColumnSpace

    def _reduce_records(self, values: FloatArray) -> ReducedRecords:
        z, remainder_sse = project_values(self.plans, values)
        projected = z @ self.space.basis
        remainder = z - projected @ self.space.basis.T
        fixed_part, remaining_part = (
            projected[:, : self.fixed_count],
            projected[:, self.fixed_count :],
        )
        return ReducedRecords(
            (fixed_part, remaining_part),
            remainder_sse + np.vecdot(remainder, remainder),
            np.vecdot(remaining_part, remaining_part),
        )

    def compute_triangular_factors(
        self, log_tau: FloatArray, reduced: ReducedRecords, *, exact: bool
    ) -> FloatArray:
        """Triangular factors, by a Gram matrix or `exact` by QR."""
        fixed_part, remaining_part = reduced.data
        count, arms = log_tau.shape
        q, size = self.fixed_count, 2 * arms + 1
        stacked = np.empty((count, size, q + remaining_part.shape[1]))
        _, _, columns, slopes = self.space.node_columns.evaluate(log_tau.ravel())
        stacked[:, :arms] = (columns.T @ self.space.inverse.T).reshape(count, arms, -1)
        stacked[:, arms:-1] = (slopes.T @ self.space.inverse.T).reshape(count, arms, -1)
        stacked[:, -1, :q], stacked[:, -1, q:] = fixed_part, remaining_part
        projected = stacked[:, :, q:]
        factors = np.zeros((count, q + size, q + size))
        factors[:, :q, :q] = self.space.triangular_factor
        factors[:, :q, q:] = stacked[:, :, :q].transpose(0, 2, 1)
        if exact:
            factors[:, q:, q:] = np.linalg.qr(projected.transpose(0, 2, 1), mode="r")
        else:
            factors[:, q:, q:] = upper_factor(projected @ projected.transpose(0, 2, 1))
        return factors

    def moments(
        self, log_tau: FloatArray, reduced: ReducedRecords
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the moments in the space of the columns."""
        columns = self.space.inverse @ self.space.node_columns.evaluate(log_tau, False).arms
        q = self.fixed_count
        fixed = np.zeros((len(columns), q))
        fixed[:q] = self.space.triangular_factor
        all_columns = np.concatenate((fixed, columns), axis=1)
        projected = np.concatenate(reduced.data, axis=1) @ all_columns
        return all_columns.T @ all_columns, projected[:, :q], projected[:, q:]


@dataclass(frozen=True, eq=False)
class RecordedFamily(SharedSampling):
    """Records under one recorded displacement on a uniform grid."""

    motion: ConvolvedMotion
    rounding_floor: ClassVar[float] = 100 * ROUNDING

    def _reduce_records(self, values: FloatArray) -> ReducedRecords:
        force = Force.from_motion(self.motion, values[:, self.motion.start : self.motion.count])
        return ReducedRecords(force, np.zeros(len(values)), force.energy)

    def compute_triangular_factors(
        self,
        log_tau: FloatArray,
        reduced: ReducedRecords,
        *,
        exact: bool,  # noqa: ARG002
    ) -> FloatArray:
        """Triangular factors by a Gram matrix: it is all that there is."""
        return upper_factor(
            self.motion.gram(np.exp(log_tau), Force(*reduced.data), derivative=True)
        )

    def moments(
        self, log_tau: FloatArray, reduced: ReducedRecords
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the moments from the correlations."""
        tau, force = np.exp(log_tau), Force(*reduced.data)
        first = Force(force.sequence[0], force.fixed[0], force.energy[0])
        gram = self.motion.gram(tau, first, derivative=False)[:-1, :-1]
        return gram, force.fixed, self.motion.products(tau, force.sequence)
