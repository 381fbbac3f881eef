"""A motion of the plate: recorded, or planned for a controller."""

from __future__ import annotations

from dataclasses import dataclass

from dashpot.base.arrays import EqualByValue, FloatArray, frozen, hold_measured
from dashpot.base.errors import DataError
from dashpot.base.provenance import Source


@dataclass(frozen=True, eq=False)
class Trajectory(EqualByValue):
    """Where the plate is sent, or was.

    Attributes
    ----------
    time : array, shape (n,)
        s, strictly increasing.
    displacement : array, shape (n,)
        Along the plate's normal, m; into the seal is positive.
    position : array, shape (n, 3), or None
        The same in space, m.
    source : Source or None

    Raises
    ------
    DataError
        If the arrays differ in length, are not finite, or time stalls.
    """

    time: FloatArray
    displacement: FloatArray
    position: FloatArray | None = None
    source: Source | None = None

    def __post_init__(self) -> None:
        hold_measured(self, "time", "displacement", minimum=2)
        if self.position is not None:
            if self.position.shape != (len(self.time), 3):
                raise DataError(
                    f"position has the shape {self.position.shape}; expected {len(self.time)} rows "
                    "of x, y, z"
                )
            object.__setattr__(self, "position", frozen(self.position))
