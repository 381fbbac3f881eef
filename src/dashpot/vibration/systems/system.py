"""Rigid bodies joined by viscoelastic mounts: FRFs and transmissibility, exactly."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from dashpot.base.arrays import ComplexArray, FloatArray, samples
from dashpot.base.errors import DataError
from dashpot.base.units import Quantity, si
from dashpot.records.frf import FRF, Kind
from dashpot.solids.maxwell import Solid
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


def point_mass(name: str, mass: Quantity) -> Body:
    """A mass that bounces along z."""
    mass = si(mass, "mass")
    return Body(name, mass)


def planar_body(
    name: str, mass: Quantity, inertia: float, *, at: tuple[float, float] = (0.0, 0.0)
) -> Body:
    """A rigid body in the x-y plane: x, y and the rotation rz, with its inertia about z."""
    mass = si(mass, "mass")
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
        leaves it to :func:`~dashpot.vibration.systems.level.response_at_level`.
    """

    solid: Solid
    between: tuple[str, str]
    at: Vector = (0.0, 0.0, 0.0)
    along: Vector = (0.0, 0.0, 1.0)
    rotary: bool = False
    friction: AmplitudeDependent | None = None
    amplitude: float | None = None

    def __post_init__(self) -> None:
        if self.between[0] == self.between[1]:
            raise DataError(f"a mount joins '{self.between[0]}' to itself")
        _unit_vector(self.along)
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


@dataclass(frozen=True)
class System:
    r"""Bodies, mounts and grounds: a linear system of many degrees of freedom.

    .. math:: \left[s^2 M + E^T K(s) E\right] q = F - E^T K(s) G u

    with the stretch :math:`E q + G u` of each mount, motions q of the bodies, u of the grounds,
    and K(s) the diagonal of the mounts' stiffnesses.

    Attributes
    ----------
    bodies : tuple of Body
    mounts : tuple of Mount
    grounds : tuple of str
        Things that move as they are told, or stand still.

    Degrees of freedom are named ``"body.motion"``, such as ``"block.z"``.
    """

    bodies: tuple[Body, ...]
    mounts: tuple[Mount, ...]
    grounds: tuple[str, ...] = ("ground",)

    def __post_init__(self) -> None:
        names = [body.name for body in self.bodies] + list(self.grounds)
        if not self.bodies:
            raise DataError("a system needs at least one body")
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise DataError(f"'{twice[0]}' names two things in the system; names must differ")
        for mount in self.mounts:
            for name in mount.between:
                if name not in names:
                    raise DataError(
                        f"a mount is attached to '{name}', which is not in the system; it has "
                        f"{', '.join(names)}"
                    )

    # -- names ----------------------------------------------------------------------------------

    @property
    def dofs(self) -> tuple[str, ...]:
        """Names of the degrees of freedom, in the order of every matrix."""
        return tuple(f"{body.name}.{motion}" for body in self.bodies for motion in body.free)

    @property
    def base_dofs(self) -> tuple[str, ...]:
        """Names of the ground motions: six each, rotations about the origin."""
        return tuple(f"{ground}.{motion}" for ground in self.grounds for motion in MOTIONS)

    # -- matrices -------------------------------------------------------------------------------

    @cached_property
    def mass_matrix(self) -> FloatArray:
        """M, shape (n, n)."""
        from scipy.linalg import block_diag

        return np.asarray(block_diag(*(body.mass_matrix for body in self.bodies)))

    @cached_property
    def stretch(self) -> FloatArray:
        """E, shape (mounts, n): how the bodies' motions stretch each mount."""
        return self._stretch()[:, : len(self.dofs)]

    @cached_property
    def base_stretch(self) -> FloatArray:
        """G, shape (mounts, 6 grounds): how the grounds' motions stretch each mount."""
        return self._stretch()[:, len(self.dofs) :]

    def mount_stiffness(self, s: npt.ArrayLike) -> ComplexArray:
        """K of each mount at s, 1/s, shape (..., mounts)."""
        s = np.asarray(s, dtype=complex)
        rows = [mount.felt.stiffness_at(s) for mount in self.mounts]
        return np.stack(rows, axis=-1) if rows else np.zeros((*s.shape, 0), dtype=complex)

    def dynamic_stiffness(self, s: npt.ArrayLike) -> ComplexArray:
        r""":math:`s^2 M + E^T K(s) E`, shape (..., n, n)."""
        s = np.asarray(s, dtype=complex)
        K = self.mount_stiffness(s)
        E = self.stretch
        return np.asarray(s[..., None, None] ** 2 * self.mass_matrix + (E.T * K[..., None, :]) @ E)

    def receptance(self, s: npt.ArrayLike) -> ComplexArray:
        """Motion per force between every two degrees of freedom at s, shape (..., n, n).

        Raises
        ------
        DataError
            If the system is singular there: a body hangs on nothing.
        """
        try:
            with np.errstate(all="ignore"):
                matrix = np.linalg.inv(self.dynamic_stiffness(s))
        except np.linalg.LinAlgError:
            matrix = np.full(1, np.nan, dtype=complex)
        if not np.isfinite(matrix).all():
            raise DataError(
                "the response is infinite at a requested frequency: some motion has no stiffness "
                "there; leave 0 Hz out, or hold that motion"
            )
        return np.asarray(matrix)

    def participation(self, place: str | Point) -> FloatArray:
        """How each degree of freedom moves a place along its direction, shape (n,)."""
        return self._row(place)[: len(self.dofs)]

    # -- answers --------------------------------------------------------------------------------

    def frf(
        self,
        *,
        response: str | Point,
        force: str | Point,
        frequency: npt.ArrayLike,
        kind: Kind | str = Kind.ACCELERANCE,
        shift: float = 0.0,
    ) -> FRF:
        r"""FRF from a force, or a moment, to a response, at degrees of freedom or at points.

        Parameters
        ----------
        response, force : str or Point
            ``"block.z"``, or a place and direction on a body.
        frequency : array_like, shape (f,)
            Hz.
        kind : Kind or str
        shift : float
            Decay of an exponential window, 1/s: evaluates at :math:`s = j\omega + a`.
        """
        f = samples("frequency", frequency)
        s = 2j * np.pi * f + shift
        H = self.receptance(s) @ self.participation(force) @ self.participation(response)
        return FRF.of_receptance(f, H, kind=kind, shift=shift)

    def transmissibility(
        self, *, response: str | Point, base: str, frequency: npt.ArrayLike
    ) -> ComplexArray:
        r"""Motion of a place per motion of a ground, shape (f,); 1 at 0 Hz for a body that follows.

        .. math:: T = -\left[s^2 M + E^T K E\right]^{-1} E^T K G

        Parameters
        ----------
        response : str or Point
        base : str
            A ground motion, such as ``"ground.z"``.
        frequency : array_like, shape (f,)
            Hz.
        """
        s = 2j * np.pi * samples("frequency", frequency)
        if base not in self.base_dofs:
            raise DataError(f"'{base}' is no ground motion; known: {', '.join(self.base_dofs)}")
        G = self.base_stretch[:, self.base_dofs.index(base)]
        forces = -(self.mount_stiffness(s) * G) @ self.stretch
        motion = np.linalg.solve(self.dynamic_stiffness(s), forces[..., None])[..., 0]
        return np.asarray(motion @ self.participation(response))

    # -- private --------------------------------------------------------------------------------

    def _stretch(self) -> FloatArray:
        columns = len(self.dofs) + len(self.base_dofs)
        rows = [
            self._row(Point(mount.between[0], mount.at, mount.along, mount.rotary))
            - self._row(Point(mount.between[1], mount.at, mount.along, mount.rotary))
            for mount in self.mounts
        ]
        return np.array(rows).reshape(len(rows), columns)

    def _row(self, place: str | Point) -> FloatArray:
        """How body motions, then ground motions, move a place, shape (n + 6 grounds,)."""
        names = self.dofs + self.base_dofs
        row = np.zeros(len(names))
        if isinstance(place, str):
            if place not in names:
                raise DataError(f"'{place}' is no degree of freedom; known: {', '.join(names)}")
            row[names.index(place)] = 1.0
            return row
        known = {body.name: body.at for body in self.bodies}
        known |= dict.fromkeys(self.grounds, (0.0, 0.0, 0.0))
        if place.body not in known:
            raise DataError(f"no body '{place.body}'; the system has {', '.join(known)}")
        motion = _motion_of(place, known[place.body])
        for name, value in zip(MOTIONS, motion, strict=True):
            dof = f"{place.body}.{name}"
            if dof in names:  # a motion that is held does not move the point
                row[names.index(dof)] = value
        return row


def _motion_of(point: Point, centre: Vector) -> FloatArray:
    r"""How the six motions of its body about `centre` move a point along its direction, shape (6,).

    .. math:: d \cdot (u + \theta \times r) = d \cdot u + (r \times d) \cdot \theta

    and :math:`d \cdot \theta` for a rotary one.
    """
    d = _unit_vector(point.along)
    if point.rotary:
        return np.concatenate((np.zeros(3), d))
    r = np.array(point.at, dtype=float) - np.array(centre, dtype=float)
    return np.concatenate((d, np.cross(r, d)))


def _unit_vector(along: Vector) -> FloatArray:
    """The direction with length 1."""
    d = np.array(along, dtype=float)
    length = float(np.linalg.norm(d))
    if not (np.isfinite(length) and length > 0):
        raise DataError(f"direction {along!r} has no length; expected three numbers, not all 0")
    return d / length
