"""A seal along a line: how it lies, how far it is pressed, and what one metre of it is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from dashpot.base.arrays import ByValue, FloatArray, frozen
from dashpot.base.demands import not_negative
from dashpot.base.errors import DataError
from dashpot.base.offered import verb
from dashpot.base.units import Quantity, si
from dashpot.records.fit import Fit
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.maxwell import Solid

CLOSED = 1e-6
"""Part of its length by which the ends of a line may lie apart, and it is closed."""


@dataclass(frozen=True)
class SealSection:
    r"""One metre of seal.

    All its arms answer the relaxed force (Fung), so that small vibration about a compression x
    feels :math:`F_e'(x)/k` times the solid, k its secant stiffness at the depth tested.

    Attributes
    ----------
    solid : Solid
        N/m per m, the secant at the depth tested.
    law : ElasticLaw or None
        Relaxed force per metre, N/m; None is a straight line.
    band : (float, float) or None
        The frequencies that its test informs, Hz.
    """

    solid: Solid
    law: ElasticLaw | None = None
    band: tuple[float, float] | None = None

    @classmethod
    def of(
        cls, fit: Fit, *, length: Quantity | None = None, temperature: Quantity | None = None
    ) -> SealSection:
        """One metre of what was tested.

        Parameters
        ----------
        fit : Fit
            Of a piece of seal.
        length : str or float, optional
            Of that piece, m; by default what the fit knows of its specimen.
        temperature : str or float, optional
            K; by default that of the fit.

        Raises
        ------
        DataError
            If the length is not known, or the fit is of a material or not at that temperature.
        """
        here = fit if temperature is None else fit.at_temperature(temperature)
        if here.unit != "N/m":
            raise DataError(f"the fit is of a material, in {here.unit}: a seal line needs a part's")
        metres = here.specimen.length if length is None else si(length, "length")
        if metres is None or not (np.isfinite(metres) and metres > 0):
            said = "is not known" if metres is None else f"is {metres!r} m"
            raise DataError(
                f"the length of the piece of seal that was tested {said}; expected one > 0, of "
                'which the stiffness of a metre follows: length = "100mm" in [seal] '
                "(Python: length=)"
            )
        law = here.elastic_law
        own = None if law is None or law.kind == "linear" else law * (1 / metres)
        return cls((1 / metres) * here.solid, own, here.band)

    def path(self, compression: npt.ArrayLike) -> FloatArray:
        """What the solid is pressed by, m, where the seal is: less where it is softer at first.

        The force of a history of compressions is that of the solid under this one.
        """
        x = np.maximum(np.asarray(compression, dtype=float), 0.0)
        return x if self.law is None else self.law.path(x)

    def force(self, compression: npt.ArrayLike) -> FloatArray:
        """Relaxed force per metre, N/m; none where it does not touch."""
        return np.asarray(self.solid.k_inf * self.path(compression))

    def factor(self, compression: npt.ArrayLike) -> FloatArray:
        """Tangent stiffness over that of the solid; 0 where it does not touch."""
        x = np.asarray(compression, dtype=float)
        tangent = np.ones_like(x) if self.law is None else self.law.factor(x)
        return np.where(x < 0, 0.0, tangent)


@dataclass(frozen=True)
class Joint:
    """A piece of a line that is stiffer or softer than its seal: a corner moulding, a splice.

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
class Stations(ByValue):
    """A line cut into equal pieces, each stood for by its middle.

    Attributes
    ----------
    along : array, shape (n,)
        Of the middles, from the first point, m.
    place, normal : array, shape (n, 3)
        m, and the direction in which the seal is pressed there, of length 1.
    length : array, shape (n,)
        Of seal that each stands for, m: together the whole line.
    factor : array, shape (n,)
        Stiffness over that of the seal: 1 but at joints.
    compression : array, shape (n,), or None
        m, below 0 by as much as the seal does not reach; None where it is not stated.
    """

    along: FloatArray
    place: FloatArray
    normal: FloatArray
    length: FloatArray
    factor: FloatArray
    compression: FloatArray | None = None


@dataclass(frozen=True, eq=False)
class SealLine(ByValue):
    """A polyline of seal.

    Attributes
    ----------
    points : array, shape (n, 3)
        m; repeat the first at the end to close the line.
    compression : float or array, shape (n,), optional
        Of the seal at each point, m, straight between them: its free height less the gap that it
        fills, so below 0 where it does not reach. None is the compression of its test.
    section : SealSection or Solid, optional
        One metre of the seal, N/m per m; without it the line is its geometry.
    normal : (float, float, float) or array, shape (n, 3)
        Direction in which the seal is pressed, of the line or at each point; need not have
        length 1.
    joints : tuple of Joint
        Where it is stiffer or softer: corners, splices.
    """

    points: FloatArray
    compression: FloatArray | None = None
    section: SealSection | None = None
    normal: FloatArray = (0.0, 0.0, 1.0)  # type: ignore[assignment]
    joints: tuple[Joint, ...] = ()

    def __post_init__(self) -> None:
        points = _points(self.points)
        object.__setattr__(self, "points", frozen(points))
        object.__setattr__(self, "normal", frozen(_normals(self.normal, len(points))))
        if self.compression is not None:
            pressed = np.array(self.compression, dtype=float)
            if pressed.shape not in {(), (len(points),)} or not np.isfinite(pressed).all():
                raise DataError(
                    f"the compression of a seal line is one finite number or one for each of its "
                    f"{len(points)} points; found shape {pressed.shape}"
                )
            pressed = np.broadcast_to(pressed, len(points))
            object.__setattr__(self, "compression", frozen(pressed.copy()))
        given: Any = self.section
        if given is not None and not isinstance(given, SealSection):
            object.__setattr__(self, "section", SealSection(given))
        object.__setattr__(self, "joints", tuple(self.joints))
        for joint in self.joints:
            if not (0 <= joint.at <= self.length and 0 < joint.length <= self.length):
                raise DataError(
                    f"{joint.name}, {joint.length:g} m long at {joint.at:g} m, is not on the seal "
                    f"line of {self.length:.4g} m"
                )
            not_negative(f"{joint.name}: ", factor=joint.factor)

    @property
    def length(self) -> float:
        """Length along the line, m."""
        return float(_lengths(self.points).sum())

    @property
    def closed(self) -> bool:
        """Whether its last point is its first."""
        apart = float(np.linalg.norm(self.points[0] - self.points[-1]))
        return apart <= CLOSED * self.length

    @property
    def along(self) -> FloatArray:
        """How far along the line each point lies, m, shape (n,)."""
        return np.append(0.0, np.cumsum(_lengths(self.points)))

    def stations(self, pitch: Quantity) -> Stations:
        """Cut the line into equal pieces, as near to a pitch as divides it evenly.

        Parameters
        ----------
        pitch : str or float
            Wanted distance of the stations along the line, m.

        Raises
        ------
        DataError
            If the pitch does not fit on the line.
        """
        wanted, length = si(pitch, "length"), self.length
        if not 0 < wanted <= length:
            raise DataError(
                f"pitch = {pitch!r} on a seal line of {length:g} m; expected a distance > 0 that "
                "fits on it"
            )
        count = max(1, round(length / wanted))
        piece = length / count
        middles: FloatArray = np.asarray((np.arange(count) + 0.5) * piece)
        place, normal = (
            np.stack([np.interp(middles, self.along, field[:, i]) for i in range(3)], axis=1)
            for field in (self.points, self.normal)
        )
        pressed = self.compression
        return Stations(
            middles,
            place,
            normal / np.linalg.norm(normal, axis=1)[:, None],
            np.full(count, piece),
            self._factor(middles, piece),
            None if pressed is None else np.interp(middles, self.along, pressed),
        )

    def mounts(self, body: str, pitch: Quantity, *, ground: str = "ground") -> Any:
        """Return its :class:`~dashpot.vibration.systems.bodies.Mount` elements, one a station.

        As :func:`dashpot.door.mounts.line_mounts`.
        """
        return verb("door.mounts", "line_mounts")(self, body, pitch, ground=ground)

    def _factor(self, middles: FloatArray, piece: float) -> FloatArray:
        """Mean factor of the joints over each piece."""
        factor = np.ones(len(middles))
        rounds = np.array([-1, 0, 1] if self.closed else [0]) * self.length
        for joint in self.joints:
            away = np.abs(middles - joint.at - rounds[:, None])
            covered = np.clip((piece + joint.length) / 2 - away, 0.0, min(piece, joint.length))
            factor += (joint.factor - 1) * covered.sum(axis=0) / piece
        return np.maximum(factor, 0.0)


def _points(given: npt.ArrayLike) -> FloatArray:
    """Points that make a line, or what is wrong with them."""
    points = np.array(given, dtype=float)
    if points.ndim != 2 or points.shape[1] != 3 or len(points) < 2:
        raise DataError(
            f"a seal line needs at least two points x, y, z; found shape {points.shape}"
        )
    if not np.isfinite(points).all():
        row = int(np.flatnonzero(~np.isfinite(points).all(axis=1))[0])
        raise DataError(f"point {row} of the seal line is not finite: {points[row]}")
    steps = _lengths(points)
    if (steps == 0).any():
        raise DataError(
            f"point {int(np.argmin(steps)) + 1} of the seal line repeats the one before it"
        )
    crossing = _first_crossing(points, nearer_than=CLOSED * float(steps.sum()))
    if crossing is not None:
        raise DataError(
            f"the seal line crosses itself: its piece from point {crossing[0]} meets the one "
            f"from point {crossing[1]}; check the order of the points"
        )
    return points


def _normals(given: npt.ArrayLike, count: int) -> FloatArray:
    """Unit normals at each point, or what is wrong with them."""
    normal = np.array(given, dtype=float)
    if normal.shape not in {(3,), (count, 3)}:
        raise DataError(
            f"the normal of a seal line is one direction or one for each of its {count} points; "
            f"found shape {normal.shape}"
        )
    normal = np.array(np.broadcast_to(normal, (count, 3)))
    size = np.linalg.norm(normal, axis=1)
    if not (np.isfinite(size) & (size > 0)).all():
        raise DataError("the normal of the seal line has no direction")
    normal /= size[:, None]
    turned = np.einsum("ij,ij->i", normal[1:], normal[:-1])
    if (turned < -CLOSED).any():
        row = int(np.argmin(turned))
        raise DataError(
            f"the normals of points {row} and {row + 1} of the seal line stand "
            f"{np.degrees(np.arccos(np.clip(turned[row], -1, 1))):.3g} deg apart: one of them is "
            "turned round, or points are missing between them"
        )
    return normal


def _lengths(points: FloatArray) -> FloatArray:
    """Of the pieces, m."""
    return np.asarray(np.linalg.norm(np.diff(points, axis=0), axis=1))


def _first_crossing(points: FloatArray, *, nearer_than: float) -> tuple[int, int] | None:
    """Return the first two pieces that meet and are not neighbours, by their first points."""
    pieces = len(points) - 1
    closed = bool(np.linalg.norm(points[0] - points[-1]) <= nearer_than)
    low = np.minimum(points[1:], points[:-1]) - nearer_than
    high = np.maximum(points[1:], points[:-1]) + nearer_than
    for i in range(pieces):
        # only pieces whose boxes meet can meet
        near = (low[i + 2 :] <= high[i]).all(axis=1) & (high[i + 2 :] >= low[i]).all(axis=1)
        for j in (np.flatnonzero(near) + i + 2).tolist():
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
