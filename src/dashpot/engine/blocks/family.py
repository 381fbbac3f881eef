"""What the fit of many records at once asks of records that share a sampling."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from dashpot.base.arrays import BoolArray, FloatArray, IndexArray
from dashpot.engine.blocks.block import Block


class Seen(NamedTuple):
    """A stack of records through a family: all that a fit needs of them."""

    data: tuple[FloatArray, ...]  # arrays whose first axis is the record
    floor: FloatArray  # (R,)
    energy: FloatArray  # (R,) sum of squares of what the rows hold

    def take(self, index: IndexArray | BoolArray) -> Seen:
        """Some of the records."""
        return Seen(tuple(part[index] for part in self.data), self.floor[index], self.energy[index])


class Family(Protocol):
    """Records that share a sampling and a history, so that only the data differ.

    Attributes
    ----------
    fixed_count, samples : int
    nonnegative : bool array, shape (q,)
        Which fixed coefficients are stiffnesses.
    bounds : (float, float)
        The window of ln tau.
    rounding_floor : float
        Relative sum of squares that is rounding.
    """

    @property
    def fixed_count(self) -> int: ...  # noqa: D102
    @property
    def samples(self) -> int: ...  # noqa: D102
    @property
    def nonnegative(self) -> BoolArray: ...  # noqa: D102
    @property
    def bounds(self) -> tuple[float, float]: ...  # noqa: D102
    @property
    def rounding_floor(self) -> float: ...  # noqa: D102

    def see(self, values: FloatArray) -> Seen:
        """Reduce records, shape (R, M)."""
        ...

    def factor(self, tau: FloatArray, seen: Seen, *, exact: bool) -> FloatArray:
        """Triangular factors of [fixed, arms, slopes, y] at tau (R, N), one per record.

        `exact` asks for the factor that does not go through a Gram matrix, if there is one.
        """
        ...

    def moments(self, tau: FloatArray, seen: Seen) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Gram of [fixed, arms] at shared tau (G,), products with y: (R, q) and (R, G)."""
        ...

    def block(self, values: FloatArray) -> Block:
        """One record as a block, shape (M,)."""
        ...
