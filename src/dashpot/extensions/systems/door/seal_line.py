"""Seal line: its points, joints and compression, divided into stations."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass
from dashpot.base.arrays import EqualByValue, FloatArray, IndexArray, make_readonly_copy
from dashpot.base.errors import DataError
from dashpot.base.units import Quantity, convert_to_si
from dashpot.base.value_ranges import require_nonnegative
from dashpot.datamodel.seal_line import SealSection, Stations
from dashpot.registry import require_handler

CLOSURE_TOLERANCE = 1e-6
"""Distance of the ends, relative to the length, up to which a line counts as closed."""
_CORNER_COSINE = np.cos(np.radians(30.0))
"""Cosine of the turn at a point beyond which it is a corner, not a point of a curve."""
_PARALLEL_SINE = 0.01
"""Sine of the angle of a line and its normal below which the one runs along the other."""


@dataclass(frozen=True)
class Joint:
    """Joint of a line, stiffer or softer than its seal: a corner moulding or a splice.

    Attributes
    ----------
    at : float
        Its middle along the line, from the first point, m.
    length : float
        m.
    factor : float
        Its stiffness per length over that of the seal, >= 0.
    name : str
    """

    at: float
    length: float
    factor: float
    name: str = "joint"


@dataclass(frozen=True, eq=False)
class SealLine(EqualByValue):
    """Seal along a polyline.

    Attributes
    ----------
    points : array, shape (n, 3)
        m; repeat the first at the end to close the line.
    compression : float or array, shape (n,), optional
        Compression of the seal at each point, m, straight between them: its free height less the
        gap, so negative without contact. None is the compression of its test.
    section : SealSection or Solid, optional
        One metre of the seal, N/m per m; without it the line is its geometry.
    normal : (float, float, float) or array, shape (n, 3) or (n - 1, 3)
        Direction in which the seal is pressed, of the line, at each point or of each piece
        between two; need not have length 1.
    joints : tuple of Joint
        Joints with another stiffness: corners, splices.
    """

    points: FloatArray
    compression: FloatArray | None = None
    section: SealSection | None = None
    normal: FloatArray = (0.0, 0.0, 1.0)  # type: ignore[assignment]
    joints: tuple[Joint, ...] = ()

    def __post_init__(self) -> None:
        points = _validate_points(self.points)
        object.__setattr__(self, "points", make_readonly_copy(points))
        object.__setattr__(
            self, "normal", make_readonly_copy(_validate_normals(self.normal, points))
        )
        if self.compression is not None:
            compressions = np.array(self.compression, dtype=float)
            if (
                compressions.shape not in {(), (len(points),)}
                or not np.isfinite(compressions).all()
            ):
                raise DataError(
                    f"the compression of a seal line is one finite number or one for each of its "
                    f"{len(points)} points; found shape {compressions.shape}"
                )
            compressions = np.broadcast_to(compressions, len(points))
            object.__setattr__(self, "compression", make_readonly_copy(compressions.copy()))
        section: Any = self.section
        if section is not None and not isinstance(section, SealSection):
            object.__setattr__(self, "section", SealSection(section))
        object.__setattr__(self, "joints", tuple(self.joints))
        for joint in self.joints:
            if not (0 <= joint.at <= self.length and 0 < joint.length <= self.length):
                raise DataError(
                    f"{joint.name}, {joint.length:g} m long at {joint.at:g} m, is not on the seal "
                    f"line of {self.length:.4g} m"
                )
            require_nonnegative(f"{joint.name}: ", factor=joint.factor)

    @property
    def length(self) -> float:
        """Length along the line, m."""
        return float(_compute_lengths(self.points).sum())

    @property
    def is_closed(self) -> bool:
        """Whether its last point is its first."""
        norm = float(np.linalg.norm(self.points[0] - self.points[-1]))
        return norm <= CLOSURE_TOLERANCE * self.length

    @property
    def arc_length(self) -> FloatArray:
        """Arc length of each point, m, shape (n,)."""
        return np.append(0.0, np.cumsum(_compute_lengths(self.points)))

    def normal_at(self, along: FloatArray) -> FloatArray:
        """Direction in which the seal is pressed so far along the line, m, shape (..., 3)."""
        if len(self.normal) < len(self.points):
            return np.asarray(self.normal[self._find_piece(along)])
        field = np.stack(
            [np.interp(along, self.arc_length, item) for item in self.normal.T], axis=-1
        )
        return np.asarray(field / np.linalg.norm(field, axis=-1, keepdims=True))

    def stations(self, pitch: Quantity) -> Stations:
        """Cut the line into cells of two stations, as near to a pitch as divides it evenly.

        No cell reaches over a corner, the end of a straight piece of a cell's length or more, the
        end of a joint, or where the seal begins to touch: a straight line is summed exactly at any
        pitch.

        Parameters
        ----------
        pitch : str or float
            Wanted distance of the stations along the line, on average, m: half a cell.

        Raises
        ------
        DataError
            If the pitch does not fit on the line.
        """
        requested_pitch, length = convert_to_si(pitch, "length"), self.length
        if not 0 < requested_pitch <= length:
            raise DataError(
                f"pitch = {pitch!r} on a seal line of {length:g} m; expected a distance > 0 that "
                "fits on it"
            )
        middle, cell = _divide_cells(self._list_breaks(2 * requested_pitch), 2 * requested_pitch)
        positions = (middle[:, None] + np.array([-0.5, 0.5]) / np.sqrt(3) * cell[:, None]).ravel()
        normal = self.normal_at(positions)
        runs = np.diff(self.points, axis=0)[self._find_piece(positions)]
        tangent = runs - (runs * normal).sum(axis=1, keepdims=True) * normal
        compressions = self.compression
        return Stations(
            positions,
            np.stack(
                [np.interp(positions, self.arc_length, item) for item in self.points.T], axis=1
            ),
            normal,
            tangent / np.linalg.norm(tangent, axis=1)[:, None],
            np.repeat(0.5 * cell, 2),
            np.repeat(self._factor(middle), 2),
            None if compressions is None else np.interp(positions, self.arc_length, compressions),
        )

    def mounts(self, body: str, pitch: Quantity, *, ground: str = "ground") -> Any:
        """Return its :class:`~dashpot.extensions.systems.multibody.Mount` elements, one a station.

        Parameters
        ----------
        body, ground : str
            Bodies that it connects.
        pitch : str or float
            Wanted distance of the mounts, m.
        """
        return require_handler("mounts", self)(self, body, pitch, ground=ground)

    def _find_piece(self, arc_length: FloatArray) -> IndexArray:
        """Return the index of the piece in which a point lies."""
        return np.clip(
            np.searchsorted(self.arc_length, arc_length, "right") - 1, 0, len(self.points) - 2
        )

    def _list_breaks(self, cell: float) -> FloatArray:
        """Return where no cell may reach across, from end to end, m; points of a curve are none."""
        runs, lengths = np.diff(self.points, axis=0), _compute_lengths(self.points)
        tangents = runs / lengths[:, None]
        is_bend = (tangents[1:] * tangents[:-1]).sum(axis=1) < _CORNER_COSINE
        is_long = np.maximum(lengths[1:], lengths[:-1]) >= cell
        corners = self.arc_length[1:-1][is_bend | is_long]
        joint_ends = [end for first, last, _ in self._joints() for end in (first, last)]
        inner_breaks = [
            end for end in (*joint_ends, *self._contact_edges()) if 0 < end < self.length
        ]
        return np.unique(np.concatenate(([0.0, self.length], corners, inner_breaks)))

    def _contact_edges(self) -> list[float]:
        """Return where the seal begins or ends to touch, m along the line."""
        if self.compression is None:
            return []
        first, last = self.compression[:-1], self.compression[1:]
        crossed = np.flatnonzero(first * last < 0)
        ratio = first[crossed] / (first - last)[crossed]
        values: list[float] = (
            self.arc_length[crossed] + ratio * _compute_lengths(self.points)[crossed]
        ).tolist()
        return values

    def _joints(self) -> list[tuple[float, float, float]]:
        """Return start and end of each joint along the line, m, and its factor."""
        rounds = (-self.length, 0.0, self.length) if self.is_closed else (0.0,)
        return [
            (joint.at - joint.length / 2 + turn, joint.at + joint.length / 2 + turn, joint.factor)
            for joint in self.joints
            for turn in rounds
        ]

    def _factor(self, middle: FloatArray) -> FloatArray:
        """Return the factor of the joints at a position; those that overlap add."""
        factor = np.ones(len(middle))
        for first, last, value in self._joints():
            factor += (value - 1) * ((first < middle) & (middle < last))
        return np.maximum(factor, 0.0)


def _divide_cells(breaks: FloatArray, requested_length: float) -> tuple[FloatArray, FloatArray]:
    """Middle and length, m, of cells between breaks, equal from one to the next."""
    spans = np.diff(breaks)
    counts = np.maximum(np.rint(spans / requested_length), 1).astype(int)
    cell = np.repeat(spans / counts, counts)
    first = np.repeat(breaks[:-1], counts)
    rank = np.concatenate([np.arange(count) for count in counts])
    return first + (rank + 0.5) * cell, cell


def _validate_points(value: npt.ArrayLike) -> FloatArray:
    """Return the points of a line; refuse points that make none."""
    points = np.array(value, dtype=float)
    if points.ndim != 2 or points.shape[1] != 3 or len(points) < 2:
        raise DataError(
            f"a seal line needs at least two points x, y, z; found shape {points.shape}"
        )
    if not np.isfinite(points).all():
        row = int(np.flatnonzero(~np.isfinite(points).all(axis=1))[0])
        raise DataError(f"point {row} of the seal line is not finite: {points[row]}")
    steps = _compute_lengths(points)
    if (steps == 0).any():
        raise DataError(
            f"point {int(np.argmin(steps)) + 1} of the seal line repeats the one before it"
        )
    crossing = _find_first_crossing(points, nearer_than=CLOSURE_TOLERANCE * float(steps.sum()))
    if crossing is not None:
        raise DataError(
            f"the seal line crosses itself: its segment from point {crossing[0]} meets the one "
            f"from point {crossing[1]}; check the order of the points"
        )
    return points


def _validate_normals(value: npt.ArrayLike, points: FloatArray) -> FloatArray:
    """Return unit normals at each point or of each piece; refuse impossible ones."""
    normal, count = np.array(value, dtype=float), len(points)
    if normal.shape not in {(3,), (count, 3), (count - 1, 3)}:
        raise DataError(
            f"the normal of a seal line is one direction, or one for each of its {count} points "
            f"or of the segments between them; found shape {normal.shape}"
        )
    pieces = normal.shape == (count - 1, 3)
    normal = normal if pieces else np.array(np.broadcast_to(normal, (count, 3)))
    size = np.linalg.norm(normal, axis=1)
    if not (np.isfinite(size) & (size > 0)).all():
        raise DataError("the normal of the seal line has no direction")
    normal /= size[:, None]
    cosine = np.einsum("ij,ij->i", normal[1:], normal[:-1])
    if (cosine < -CLOSURE_TOLERANCE).any():
        row = int(np.argmin(cosine))
        raise DataError(
            f"the normals of points {row} and {row + 1} of the seal line stand "
            f"{np.degrees(np.arccos(np.clip(cosine[row], -1, 1))):.3g} deg apart: one of them is "
            "turned round, or points are missing between them"
        )
    _refuse_along(normal if pieces else normal[1:] + normal[:-1], np.diff(points, axis=0))
    return normal


def _refuse_along(normal: FloatArray, runs: FloatArray) -> None:
    """Refuse a seal that is pressed along its own line."""
    size = np.linalg.norm(normal, axis=1) * np.linalg.norm(runs, axis=1)
    sine = np.linalg.norm(np.cross(normal, runs), axis=1) / size
    row = int(np.argmin(sine))
    if sine[row] < _PARALLEL_SINE:
        x, y, z = (normal[row] / np.linalg.norm(normal[row])).round(4).tolist()
        raise DataError(
            f"the seal line runs along its own normal from point {row} to {row + 1}: the normal "
            f"there is {x:g}, {y:g}, {z:g}; expected the direction in which the seal is pressed, "
            "square to the line: look at the normal and the axes of the points"
        )


def _compute_lengths(points: FloatArray) -> FloatArray:
    """Lengths of the pieces, m."""
    return np.asarray(np.linalg.norm(np.diff(points, axis=0), axis=1))


def _find_first_crossing(points: FloatArray, *, nearer_than: float) -> tuple[int, int] | None:
    """Return the first two pieces that meet and are not neighbours, by their first points."""
    pieces = len(points) - 1
    closed = bool(np.linalg.norm(points[0] - points[-1]) <= nearer_than)
    low = np.minimum(points[1:], points[:-1]) - nearer_than
    high = np.maximum(points[1:], points[:-1]) + nearer_than
    for i in range(pieces):
        # only pieces whose boxes meet can meet
        may_cross = (low[i + 2 :] <= high[i]).all(axis=1) & (high[i + 2 :] >= low[i]).all(axis=1)
        for j in (np.flatnonzero(may_cross) + i + 2).tolist():
            neighbours = closed and i == 0 and j == pieces - 1
            if (
                not neighbours
                and _compute_distance(points[i : i + 2], points[j : j + 2]) < nearer_than
            ):
                return i, j
    return None


def _compute_distance(first: FloatArray, second: FloatArray) -> float:
    """Return the distance of two straight pieces, each of shape (2, 3).

    It is that of the lines where both feet of the common normal lie within, else that of an end
    from the other piece.
    """
    a, b, offset = first[1] - first[0], second[1] - second[0], second[0] - first[0]
    normal = np.cross(a, b)
    square = float(normal @ normal)
    if square > 0:
        s = float(np.cross(offset, b) @ normal) / square
        t = float(np.cross(offset, a) @ normal) / square
        if 0 <= s <= 1 and 0 <= t <= 1:
            return float(np.linalg.norm(offset + t * b - s * a))
    points_and_pieces = [(point, second) for point in first] + [(point, first) for point in second]
    return min(_from_piece(point, piece) for point, piece in points_and_pieces)


def _from_piece(point: FloatArray, segment: FloatArray) -> float:
    vector = segment[1] - segment[0]
    ratio = np.clip((point - segment[0]) @ vector / (vector @ vector), 0.0, 1.0)
    return float(np.linalg.norm(point - segment[0] - ratio * vector))
