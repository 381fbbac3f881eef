"""Rigid and bending bodies, the mounts that join them, and points on them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.base.units import Quantity, convert_to_si
from dashpot.base.validators import require_positive
from dashpot.datamodel.free_modes import FreeModes
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid
from dashpot.solids.rate_independent import AmplitudeDependent, Linearised, amplitudes

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
    modes : FreeModes or None
        Elastic modes, by which it moves besides: degrees of freedom q1, q2, ...
    """

    name: str
    mass: float
    inertia: Vector | tuple[Vector, Vector, Vector] = (0.0, 0.0, 0.0)
    at: Vector = (0.0, 0.0, 0.0)
    free: tuple[str, ...] = ("z",)
    modes: FreeModes | None = None

    def __post_init__(self) -> None:
        require_positive(f"body '{self.name}': ", mass=self.mass, unit=" kg")
        unknown = [motion for motion in self.free if motion not in MOTIONS]
        moves = self.free or self.modes is not None
        if unknown or not moves or len(set(self.free)) < len(self.free):
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
        """Mass and inertia of the free motions, and 1 of each mode, shape (motions, motions)."""
        tensor = np.array(self.inertia, dtype=float)
        full = np.zeros((6, 6))
        full[:3, :3] = self.mass * np.eye(3)
        full[3:, 3:] = np.diag(tensor) if tensor.ndim == 1 else tensor
        rows = [MOTIONS.index(motion) for motion in self.free]
        matrix = np.eye(len(self.motions))
        matrix[: len(rows), : len(rows)] = full[np.ix_(rows, rows)]
        return matrix

    @property
    def motions(self) -> tuple[str, ...]:
        """Those that are free, then the modes."""
        count = 0 if self.modes is None else len(self.modes)
        return (*self.free, *(f"q{i + 1}" for i in range(count)))

    @property
    def springs(self) -> tuple[ModalSpring, ...]:
        """What holds each mode back."""
        if self.modes is None:
            return ()
        rows = zip(2 * np.pi * self.modes.frequency, self.modes.damping_ratio, strict=True)
        return tuple(
            ModalSpring(self.name, GeneralizedMaxwell(w**2, b=2 * zeta * w)) for w, zeta in rows
        )


def point_mass(name: str, mass: Quantity) -> Body:
    """A mass that bounces along z."""
    mass = convert_to_si(mass, "mass")
    return Body(name, mass)


def planar_body(
    name: str, mass: Quantity, inertia: float, *, at: tuple[float, float] = (0.0, 0.0)
) -> Body:
    """A rigid body in the x-y plane: x, y and the rotation rz, with its inertia about z."""
    mass = convert_to_si(mass, "mass")
    return Body(name, mass, inertia=(0.0, 0.0, inertia), at=(*at, 0.0), free=("x", "y", "rz"))


@dataclass(frozen=True)
class Mount:
    """A viscoelastic solid between two bodies, or a body and a ground, acting along one line.

    Attributes
    ----------
    solid : Solid
    between : (str, str)
        Names of two bodies, or of a body and a ground.
    at : (float, float, float)
        Where it is attached, m.
    along : (float, float, float)
        The direction in which it acts; need not have length 1.
    rotary : bool
        True for a torsional mount about `along`: its solid is then in N m/rad.
    friction : AmplitudeDependent or None
        What stands beside the solid and answers to amplitude: friction, stiffening, both.
    amplitude : float or None
        Amplitude of the stretch, m (rad), at which every linear answer takes the friction; None
        leaves it to ``dashpot.systems.response_at_level``.
    name : str
        Of the part that it belongs to: those of one name share its energy.
    """

    solid: Solid
    between: tuple[str, str]
    at: Vector = (0.0, 0.0, 0.0)
    along: Vector = (0.0, 0.0, 1.0)
    rotary: bool = False
    friction: AmplitudeDependent | None = None
    amplitude: float | None = None
    name: str = ""

    def __post_init__(self) -> None:
        if self.between[0] == self.between[1]:
            raise DataError(f"a mount joins '{self.between[0]}' to itself")
        unit_vector(self.along)
        if self.amplitude is not None:
            amplitudes(self.amplitude)

    @property
    def felt(self) -> Solid:
        """The linear solid that the mount is: its own, or what it is at the amplitude given.

        Raises
        ------
        DataError
            If there is friction and no amplitude.
        """
        if self.friction is None:
            return self.solid
        if self.amplitude is None:
            raise DataError(
                f"the mount between {' and '.join(self.between)} has friction, and what it is "
                "depends on how far it moves; give it an amplitude, or ask response_at_level"
            )
        return Linearised(self.solid, self.friction, self.amplitude)


@dataclass(frozen=True)
class ModalSpring:
    r"""What holds a mode of a body back: :math:`\omega_r^2 + 2\zeta_r\omega_r s`, per modal mass.

    Attributes
    ----------
    name : str
        Of the body.
    felt : GeneralizedMaxwell
    """

    name: str
    felt: GeneralizedMaxwell


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
    # by hand: a line of seal asks a thousand times, and np.cross costs more than all the rest
    x, y, z = (float(p) - float(c) for p, c in zip(point.at, centre, strict=True))
    a, b, c = d.tolist()
    return np.array((a, b, c, y * c - z * b, z * a - x * c, x * b - y * a))


def bent_by(body: Body, point: Point) -> FloatArray:
    """How the modes of its body move a point along its direction, shape (modes,)."""
    if point.rotary or body.modes is None:
        raise DataError(
            f"'{body.name}' bends, and its modes do not say how it rotates at {point.at}; take a "
            "direction along which the point moves"
        )
    return np.asarray(body.modes.at(point.at)[0] @ unit_vector(point.along))


def unit_vector(along: Vector) -> FloatArray:
    """The direction with length 1."""
    d = np.array(along, dtype=float)
    length = float(np.linalg.norm(d))
    if not (np.isfinite(length) and length > 0):
        raise DataError(f"direction {along!r} has no length; expected three numbers, not all 0")
    return d / length
