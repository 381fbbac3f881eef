"""Starting points of many records: the best set of grid points for each."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from itertools import combinations

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray, IndexArray
from dashpot.extensions.batch.arrays.shared_sampling import ReducedRecords, SharedSampling

#: grid points by number of arms, of which all sets are tried; larger numbers of arms are added
#: one at a time
POINTS = {1: 72, 2: 40, 3: 24}


class GridSearch:
    """Search for the best set of grid points of each record, by swept Gram matrices."""

    def __init__(self, family: SharedSampling, arms: int) -> None:
        self.family = family
        self.log_tau = np.linspace(*family.template.bounds, POINTS[arms])
        self.sets = np.array(list(combinations(range(POINTS[arms]), arms)))
        self.inverse: FloatArray | None = None

    def gains(self, reduced: ReducedRecords) -> FloatArray:
        """Return the explained sum of squares by set and record, (sets, R); 0 if not positive."""
        gram, products_with_fixed, products_with_grid = self.family.moments(self.log_tau, reduced)
        q = self.family.fixed_count
        coefficients = np.linalg.solve(gram[:q, :q], gram[:q, q:])
        residual_gram = gram[q:, q:] - gram[q:, :q] @ coefficients
        length = np.sqrt(np.maximum(np.diagonal(residual_gram), 1e-14 * np.diagonal(gram)[q:]))
        moment = (products_with_grid - products_with_fixed @ coefficients) / length
        if self.inverse is None:
            cosine = residual_gram / length / length[:, None]
            parts = cosine[self.sets[:, :, None], self.sets[:, None, :]]
            is_independent = np.linalg.eigvalsh(parts)[:, 0] > 1e-7
            self.sets = self.sets[is_independent]
            self.inverse = np.linalg.inv(parts[is_independent])
        # one row per set: whole rows of records are picked, added and compared
        set_moments = [moment.T[column] for column in self.sets.T]
        gain, positive = np.zeros(set_moments[0].shape), np.ones(set_moments[0].shape, dtype=bool)
        for i, row in enumerate(set_moments):
            beta = sum(self.inverse[:, i, j, None] * other for j, other in enumerate(set_moments))
            positive &= beta > 0
            gain += beta * row
        return gain * positive

    def best(self, gain: FloatArray) -> tuple[FloatArray, BoolArray]:
        """Return ln tau (R, N) of the best set of each record, and whether it explains anything."""
        best = np.argmax(gain, axis=0)
        return self.log_tau[self.sets[best]], gain[best, np.arange(gain.shape[1])] > 0

    def peaks(self, gain: FloatArray, count: int) -> Iterator[tuple[FloatArray, BoolArray]]:
        """Yield the result of `best` at the second, third, ... highest maximum of each record."""
        residual = gain * (
            gain >= np.maximum.reduce([gain[item] for item in self.neighbour_sets.T])
        )
        records = np.arange(gain.shape[1])
        for _ in range(count):
            residual[np.argmax(residual, axis=0), records] = 0.0
            yield self.best(residual)

    @cached_property
    def neighbour_sets(self) -> IndexArray:
        """The sets next to each set, shape (sets, 3^N); itself if there is none."""
        size = len(self.log_tau) + 2
        shape = (size,) * self.sets.shape[1]
        row = np.full(size ** len(shape), -1)
        row[np.ravel_multi_index((self.sets + 1).T, shape)] = np.arange(len(self.sets))
        offsets = np.indices((3,) * len(shape)).reshape(len(shape), -1)
        value = row[np.ravel_multi_index(self.sets.T[:, :, None] + offsets[:, None], shape)]
        return np.where(value < 0, np.arange(len(self.sets))[:, None], value)
