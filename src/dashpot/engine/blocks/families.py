"""Records that share a sampling: what a fit of many records needs to know of each kind."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from dashpot.base.arrays import BoolArray, ByValue, FloatArray, IndexArray
from dashpot.base.errors import DataError
from dashpot.engine.blocks.block import Block, DesignBlock
from dashpot.engine.blocks.column_space import ColumnSpace, column_space
from dashpot.engine.blocks.compression import Compression, compression, uniform_step
from dashpot.engine.blocks.correlation import ROUNDING, Force, Response, response, upper_factor
from dashpot.engine.blocks.family import Seen
from dashpot.engine.blocks.hold import decay_block, hold_block, ramp_hold_block
from dashpot.engine.blocks.recorded import recorded_block

#: samples compressed together
AT_ONCE = 400_000


def decay_family(time: FloatArray, *, constant: str | None = "k_inf") -> CompressedFamily:
    """Plain decays from t = 0 (:func:`~dashpot.engine.blocks.hold.decay_block`)."""
    return _compressed(time, (compression(time),), partial(decay_block, constant=constant))


def hold_family(time: FloatArray, *, depth: float, ramp_time: float) -> CompressedFamily:
    """Holds after an ideal ramp (:func:`~dashpot.engine.blocks.hold.hold_block`)."""
    make = partial(hold_block, depth=depth, ramp_time=ramp_time)
    return _compressed(time, (compression(time),), make)


def ramp_hold_family(time: FloatArray, *, depth: float, ramp_time: float) -> CompressedFamily:
    """Ideal ramps and holds (:func:`~dashpot.engine.blocks.hold.ramp_hold_block`)."""
    make = partial(ramp_hold_block, depth=depth, ramp_time=ramp_time)
    first = int(np.searchsorted(time, ramp_time))
    plans = compression(time[:first]), compression(time[first:] - ramp_time)
    return _compressed(time, plans, make, second_from=ramp_time)


def recorded_family(
    time: FloatArray, displacement: FloatArray, *, window: slice = slice(None)
) -> RecordedFamily:
    """Forces under one recorded displacement (:func:`.recorded_block`).

    Raises
    ------
    DataError
        If the grid is not uniform or the displacement does not start at zero: nothing can be
        shared there.
    """
    start, stop, _ = window.indices(len(time))
    make = partial(_recorded_block, time, displacement, slice(start, stop))
    x = np.asarray(displacement, dtype=float)
    if not shares_correlation(time, x):
        raise DataError("records share a correlation only on a uniform grid and from x = 0")
    template = make(np.zeros(len(time)))
    shared = response(time, x, x[start:stop, None], start=start, stop=stop)
    return RecordedFamily(shared, template.fixed_names, template.window, make)


def shares_correlation(time: FloatArray, displacement: FloatArray) -> bool:
    """True if forces under this displacement can be correlated with it once for all."""
    return displacement[0] == 0 and uniform_step(time) is not None


def _recorded_block(
    time: FloatArray, displacement: FloatArray, window: slice, force: FloatArray
) -> Block:
    return recorded_block(time, displacement, force, window=window)


def _compressed(
    time: FloatArray,
    plans: tuple[Compression, ...],
    make: Callable[..., DesignBlock],
    *,
    second_from: float = 0.0,
) -> CompressedFamily:
    origins = (0.0, second_from)
    nodes = np.concatenate([plan.nodes + at for plan, at in zip(plans, origins, strict=False)])
    root = np.concatenate([plan.root_weight for plan in plans])

    def at_nodes(chosen: slice | IndexArray) -> DesignBlock:
        return make(
            nodes[chosen], np.zeros(len(nodes[chosen])), weights=root[chosen], compress=False
        )

    template = make(time, np.zeros(len(time)))
    return CompressedFamily(
        template, plans, column_space(template, at_nodes), lambda values: make(time, values)
    )


@dataclass(frozen=True, eq=False)
class CompressedFamily(ByValue):
    """Records of a hold, a ramp and hold, or a plain decay on one sampling.

    A record is seen as its coordinates in the space of the sampling's columns, those along the
    fixed columns apart: Gram matrices of the others then hold no large constant.
    """

    template: DesignBlock
    plans: tuple[Compression, ...]
    space: ColumnSpace
    again: Callable[[FloatArray], DesignBlock]

    @property
    def fixed_count(self) -> int:
        """Number of fixed columns."""
        return len(self.template.fixed_names)

    @property
    def samples(self) -> int:
        """Samples of a record."""
        return self.template.samples

    @property
    def nonnegative(self) -> BoolArray:
        """Which fixed coefficients are stiffnesses."""
        return _stiff(self.template.fixed_names)

    @property
    def bounds(self) -> tuple[float, float]:
        """The window of ln tau."""
        low, high = np.log(self.template.window)
        return float(low), float(high)

    @property
    def rounding_floor(self) -> float:
        """Relative sum of squares below which a Gram matrix holds rounding only."""
        return ROUNDING

    def see(self, values: FloatArray) -> Seen:
        """Compress a few records at a time: they stay in the cache."""
        few = max(1, AT_ONCE // values.shape[1])
        parts = [self._project(values[i : i + few]) for i in range(0, len(values), few)]
        z = np.concatenate([part[0] for part in parts])
        at = z @ self.space.basis
        rest = z - at @ self.space.basis.T
        floor = np.concatenate([part[1] for part in parts]) + np.vecdot(rest, rest)
        q = self.fixed_count
        return Seen((at[:, :q], at[:, q:]), floor, np.vecdot(at[:, q:], at[:, q:]))

    def _project(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        z, floor, first = [], np.zeros(len(values)), 0
        for plan in self.plans:
            part, aside = plan.project(values[:, first : first + plan.samples])
            z.append(part)
            floor += aside
            first += plan.samples
        return np.concatenate(z, axis=1), floor

    def factor(self, tau: FloatArray, seen: Seen, *, exact: bool) -> FloatArray:
        """Triangular factors of [fixed, arms, slopes, y] at tau (R, N), one per record."""
        along, beside = seen.data
        count, arms = tau.shape
        q, size = self.fixed_count, 2 * arms + 1
        both = np.empty((count, size, q + beside.shape[1]))
        columns, slopes = self.space.chosen.columns(tau.ravel(), True)
        both[:, :arms] = (columns.T @ self.space.inverse.T).reshape(count, arms, -1)
        both[:, arms:-1] = (slopes.T @ self.space.inverse.T).reshape(count, arms, -1)
        both[:, -1, :q], both[:, -1, q:] = along, beside
        swept = both[:, :, q:]
        out = np.zeros((count, q + size, q + size))
        out[:, :q, :q] = self.space.triangle
        out[:, :q, q:] = both[:, :, :q].transpose(0, 2, 1)
        if exact:
            out[:, q:, q:] = np.linalg.qr(swept.transpose(0, 2, 1), mode="r")
        else:
            out[:, q:, q:] = upper_factor(swept @ swept.transpose(0, 2, 1))
        return out

    def moments(self, tau: FloatArray, seen: Seen) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Gram of [fixed, arms] at shared tau (G,), products with y: (R, q) and (R, G)."""
        columns = self.space.inverse @ self.space.chosen.columns(tau, False)[0]
        q = self.fixed_count
        fixed = np.zeros((len(columns), q))
        fixed[:q] = self.space.triangle
        every = np.concatenate((fixed, columns), axis=1)
        at = np.concatenate(seen.data, axis=1) @ every
        return every.T @ every, at[:, :q], at[:, q:]

    def block(self, values: FloatArray) -> Block:
        """One record as a block, shape (M,)."""
        return self.again(values)


@dataclass(frozen=True, eq=False)
class RecordedFamily(ByValue):
    """Records under one recorded displacement on a uniform grid."""

    response: Response
    fixed_names: tuple[str, ...]
    window: tuple[float, float]
    again: Callable[[FloatArray], Block]

    @property
    def fixed_count(self) -> int:
        """Number of fixed columns."""
        return len(self.fixed_names)

    @property
    def samples(self) -> int:
        """Samples of a record in the window."""
        return len(self.response.fixed)

    @property
    def nonnegative(self) -> BoolArray:
        """Which fixed coefficients are stiffnesses."""
        return _stiff(self.fixed_names)

    @property
    def bounds(self) -> tuple[float, float]:
        """The window of ln tau."""
        low, high = np.log(self.window)
        return float(low), float(high)

    @property
    def rounding_floor(self) -> float:
        """Relative sum of squares below which a Gram matrix holds rounding only."""
        return 100 * ROUNDING

    def see(self, values: FloatArray) -> Seen:
        """Correlate every record with the displacement."""
        window = values[:, self.response.start : self.response.count]
        few = max(1, 400_000 // values.shape[1])
        forces = [Force.of(self.response, window[i : i + few]) for i in range(0, len(window), few)]
        data = tuple(np.concatenate(part) for part in zip(*forces, strict=True))
        return Seen(data, np.zeros(len(values)), data[2])

    def factor(self, tau: FloatArray, seen: Seen, *, exact: bool) -> FloatArray:  # noqa: ARG002
        """Triangular factors of [fixed, arms, slopes, y] at tau (R, N), one per record."""
        return upper_factor(self.response.gram(tau, Force(*seen.data), derivative=True))

    def moments(self, tau: FloatArray, seen: Seen) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Gram of [fixed, arms] at shared tau (G,), products with y: (R, q) and (R, G)."""
        force = Force(*seen.data)
        first = Force(force.sequence[0], force.fixed[0], force.energy[0])
        gram = self.response.gram(tau, first, derivative=False)[:-1, :-1]
        return gram, force.fixed, self.response.products(tau, force.sequence)

    def block(self, values: FloatArray) -> Block:
        """One record as a block, shape (M,)."""
        return self.again(values)


def _stiff(names: tuple[str, ...]) -> BoolArray:
    return np.array([name.partition("@")[0] in {"k_inf", "b"} for name in names], dtype=bool)
