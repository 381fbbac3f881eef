"""A motion of the plate: recorded, or planned for a controller."""

from __future__ import annotations

from dataclasses import dataclass

from dashpot.base.arrays import ByValue, FloatArray, frozen, increasing, measured, same_length
from dashpot.base.errors import DataError
from dashpot.base.provenance import Source


@dataclass(frozen=True, eq=False)
class Trajectory(ByValue):
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
        for name in ("time", "displacement"):
            object.__setattr__(self, name, measured(name, getattr(self, name), minimum=2))
        same_length(time=self.time, displacement=self.displacement)
        increasing("time", self.time)
        if self.position is not None:
            if self.position.shape != (len(self.time), 3):
                raise DataError(
                    f"position has the shape {self.position.shape}; expected {len(self.time)} rows "
                    "of x, y, z"
                )
            object.__setattr__(self, "position", frozen(self.position))
