"""Rigid bodies and the mounts between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.solids.maxwell import GeneralizedMaxwell

MOTIONS = ("x", "y", "z", "rx", "ry", "rz")
"""Translations, m, and small rotations, rad, about the global axes."""

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Body:
    """A rigid body that may move in some of six ways about its centre of mass.

    Attributes
    ----------
    name : str
    mass : float
        kg.
    inertia : (float, float, float) or three rows of three
        Principal moments about the global axes, or the whole inertia tensor, kg m^2.
    at : (float, float, float)
        Centre of mass, m.
    free : tuple of str
        Names from :data:`MOTIONS`; the others are held. ``("z",)`` is a point mass that bounces.
    """

    name: str
    mass: float
    inertia: Vector | tuple[Vector, Vector, Vector] = (0.0, 0.0, 0.0)
    at: Vector = (0.0, 0.0, 0.0)
    free: tuple[str, ...] = ("z",)

    def __post_init__(self) -> None:
        if not (np.isfinite(self.mass) and self.mass > 0):
            raise DataError(f"body '{self.name}': mass = {self.mass!r} kg; expected a number > 0")
        unknown = [motion for motion in self.free if motion not in MOTIONS]
        if unknown or not self.free or len(set(self.free)) < len(self.free):
            raise DataError(
                f"body '{self.name}': free = {self.free!r}; expected different names from "
                f"{', '.join(MOTIONS)}"
            )
        if "." in self.name:
            raise DataError(f"body '{self.name}': a name must not hold a dot")
        smallest = float(np.linalg.eigvalsh(self.mass_matrix).min())
        if not smallest > 0:
            raise DataError(
                f"body '{self.name}' is free to rotate ({', '.join(self.free)}) but its inertia "
                f"{self.inertia!r} kg m^2 is not positive there"
            )

    @property
    def mass_matrix(self) -> FloatArray:
        """Mass and inertia of the free motions, shape (free, free)."""
        tensor = np.array(self.inertia, dtype=float)
        full = np.zeros((6, 6))
        full[:3, :3] = self.mass * np.eye(3)
        full[3:, 3:] = np.diag(tensor) if tensor.ndim == 1 else tensor
        rows = [MOTIONS.index(motion) for motion in self.free]
        return full[np.ix_(rows, rows)]


def point_mass(name: str, mass: float) -> Body:
    """A mass that bounces along z."""
    return Body(name, mass)


def planar_body(
    name: str, mass: float, inertia: float, *, at: tuple[float, float] = (0.0, 0.0)
) -> Body:
    """A rigid body in the x-y plane: x, y and the rotation rz, with its inertia about z."""
    return Body(name, mass, inertia=(0.0, 0.0, inertia), at=(*at, 0.0), free=("x", "y", "rz"))


@dataclass(frozen=True)
class Mount:
    """A viscoelastic solid between two bodies, or a body and a ground, acting along one line.

    Attributes
    ----------
    solid : GeneralizedMaxwell
    between : (str, str)
        Names of two bodies, or of a body and a ground.
    at : (float, float, float)
        Where it is attached, m.
    along : (float, float, float)
        The direction in which it acts; need not have length 1.
    rotary : bool
        True for a torsional mount about `along`: its solid is then in N m/rad.
    """

    solid: GeneralizedMaxwell
    between: tuple[str, str]
    at: Vector = (0.0, 0.0, 0.0)
    along: Vector = (0.0, 0.0, 1.0)
    rotary: bool = False

    def __post_init__(self) -> None:
        if self.between[0] == self.between[1]:
            raise DataError(f"a mount joins '{self.between[0]}' to itself")
        unit_vector(self.along)


@dataclass(frozen=True)
class Point:
    """A place and a direction on a body: where a force acts, or an accelerometer looks.

    Attributes
    ----------
    body : str
    at : (float, float, float)
        m.
    along : (float, float, float)
    rotary : bool
        True for a moment or a rotation about `along` instead.
    """

    body: str
    at: Vector = (0.0, 0.0, 0.0)
    along: Vector = (0.0, 0.0, 1.0)
    rotary: bool = False


def motion_of(point: Point, centre: Vector) -> FloatArray:
    r"""How the six motions of its body about `centre` move a point along its direction, shape (6,).

    .. math:: d \cdot (u + \theta \times r) = d \cdot u + (r \times d) \cdot \theta

    and :math:`d \cdot \theta` for a rotary one.
    """
    d = unit_vector(point.along)
    if point.rotary:
        return np.concatenate((np.zeros(3), d))
    r = np.array(point.at, dtype=float) - np.array(centre, dtype=float)
    return np.concatenate((d, np.cross(r, d)))


def unit_vector(along: Vector) -> FloatArray:
    """The direction with length 1."""
    d = np.array(along, dtype=float)
    length = float(np.linalg.norm(d))
    if not (np.isfinite(length) and length > 0):
        raise DataError(f"direction {along!r} has no length; expected three numbers, not all 0")
    return d / length
