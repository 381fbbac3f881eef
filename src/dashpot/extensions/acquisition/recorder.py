"""Interface of an acquisition device: three methods, all of which only read."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Protocol, TypeAlias

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray

Block: TypeAlias = tuple[FloatArray, FloatArray]
"""Times, shape (n,), s; values, shape (n, channels), in the units of their channels."""
COLUMNS = ("time [s]", "displacement [mm]", "force [N]")
"""Columns that a bench sends by default."""


@dataclass(frozen=True)
class Description:
    """Description of an acquisition: device, channels, and faults so far.

    Attributes
    ----------
    device : str
        Description of the device, for the header of the file.
    channels : tuple of str
        Names with their units, without the time: ``("displacement [mm]", "force [N]")``.
    notes : tuple of str
        Losses and faults up to now; empty if there are none.
    """

    device: str
    channels: tuple[str, ...]
    notes: tuple[str, ...] = ()


class Recorder(Protocol):
    """Acquisition device that is read until it ends or is stopped; a driver has these methods."""

    def describe(self) -> Description:
        """Return the source and its errors so far."""

    def blocks(self) -> Iterator[Block]:
        """Yield the samples since the last block, at least every few tenths of a second.

        A block may be empty. After `stop` the samples that were read already are still returned,
        then the end.
        """

    def stop(self) -> None:
        """End the reading soon; may be called from another thread, or twice."""
