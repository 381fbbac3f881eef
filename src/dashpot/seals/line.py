"""A seal along a line: where its elements stand and how much seal each one carries."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dashpot.base.arrays import ByValue, FloatArray, frozen
from dashpot.base.errors import ExportError


@dataclass(frozen=True, eq=False)
class SealLine(ByValue):
    """A polyline of seal, cut into equal pieces with one element in the middle of each.

    Attributes
    ----------
    points : array, shape (n, 3)
        Corners, m; repeat the first at the end to close the line.
    pitch : float
        Wanted distance of the elements along the line, m; the nearest that divides the line
        evenly is used.
    normal : (float, float, float)
        Direction in which the seal is compressed; need not have length 1.
    """

    points: FloatArray
    pitch: float
    normal: tuple[float, float, float] = (0.0, 0.0, 1.0)

    def __post_init__(self) -> None:
        points: npt.NDArray[np.float64] = np.array(self.points, dtype=float)
        if points.ndim != 2 or points.shape[1] != 3 or len(points) < 2:
            raise ExportError(
                f"a seal line needs at least two points x, y, z; found shape {points.shape}"
            )
        if not np.isfinite(points).all():
            row = int(np.flatnonzero(~np.isfinite(points).all(axis=1))[0])
            raise ExportError(f"point {row} of the seal line is not finite: {points[row]}")
        steps = _lengths(points)
        if (steps == 0).any():
            raise ExportError(
                f"point {int(np.argmin(steps)) + 1} of the seal line repeats the one before it"
            )
        if not 0 < self.pitch <= steps.sum():
            raise ExportError(
                f"pitch = {self.pitch!r} m on a seal line of {steps.sum():g} m; expected a "
                "distance > 0 that fits on it"
            )
        crossing = _first_crossing(points, nearer_than=1e-6 * float(steps.sum()))
        if crossing is not None:
            raise ExportError(
                f"the seal line crosses itself: its piece from point {crossing[0]} meets the one "
                f"from point {crossing[1]}; check the order of the points"
            )
        if not np.linalg.norm(self.normal) > 0:
            raise ExportError("the normal of the seal line has no direction")
        object.__setattr__(self, "points", frozen(points))
        object.__setattr__(self, "normal", tuple(float(value) for value in self.normal))

    @property
    def length(self) -> float:
        """Length along the line, m."""
        return float(_lengths(self.points).sum())

    @property
    def elements(self) -> int:
        """How many elements carry the line."""
        return max(1, round(self.length / self.pitch))

    @property
    def piece(self) -> float:
        """Length of seal that each element carries, m: together they carry the whole line."""
        return self.length / self.elements

    def stations(self) -> FloatArray:
        """Where the elements stand, the middles of the pieces, m, shape (elements, 3)."""
        along = np.append(0.0, np.cumsum(_lengths(self.points)))
        middles = (np.arange(self.elements) + 0.5) * self.piece
        return np.stack([np.interp(middles, along, self.points[:, i]) for i in range(3)], axis=1)


def _lengths(points: FloatArray) -> FloatArray:
    """Of the pieces, m."""
    return np.asarray(np.linalg.norm(np.diff(points, axis=0), axis=1))


def _first_crossing(points: FloatArray, *, nearer_than: float) -> tuple[int, int] | None:
    """Return the first two pieces that meet and are not neighbours, by their first points."""
    pieces = len(points) - 1
    closed = bool(np.linalg.norm(points[0] - points[-1]) <= nearer_than)
    for i in range(pieces):
        for j in range(i + 2, pieces):
            neighbours = closed and i == 0 and j == pieces - 1
            if not neighbours and _distance(points[i : i + 2], points[j : j + 2]) < nearer_than:
                return i, j
    return None


def _distance(first: FloatArray, second: FloatArray) -> float:
    """Return the distance of two straight pieces, each of shape (2, 3).

    It is that of the lines where both feet of the common normal lie within, else that of an end
    from the other piece.
    """
    a, b, between = first[1] - first[0], second[1] - second[0], second[0] - first[0]
    normal = np.cross(a, b)
    square = float(normal @ normal)
    if square > 0:
        s = float(np.cross(between, b) @ normal) / square
        t = float(np.cross(between, a) @ normal) / square
        if 0 <= s <= 1 and 0 <= t <= 1:
            return float(np.linalg.norm(between + t * b - s * a))
    ends = [(point, second) for point in first] + [(point, first) for point in second]
    return min(_from_piece(point, piece) for point, piece in ends)


def _from_piece(point: FloatArray, piece: FloatArray) -> float:
    along = piece[1] - piece[0]
    share = np.clip((point - piece[0]) @ along / (along @ along), 0.0, 1.0)
    return float(np.linalg.norm(point - piece[0] - share * along))
