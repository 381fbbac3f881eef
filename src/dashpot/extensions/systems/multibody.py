"""Multibody systems on viscoelastic mounts: FRFs and transmissibility."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass, replace
from dashpot.base.arrays import ComplexArray, FloatArray, to_complex, validate_samples
from dashpot.base.errors import DataError
from dashpot.base.units import Quantity, convert_to_si
from dashpot.base.value_ranges import require_positive
from dashpot.datamodel.frf import FRF, Kind
from dashpot.extensions.systems.free_modes import FreeModes
from dashpot.extensions.systems.linearised_solid import Linearised
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid
from dashpot.solids.rate_independent import AmplitudeDependent, amplitudes

# Bodies, mounts and points.


MOTIONS = ("x", "y", "z", "rx", "ry", "rz")
"""Translations, m, and small rotations, rad, about the global axes."""

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Body:
    """Rigid body, free in some of six directions about its centre of mass.

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
        moves_freely = self.free or self.modes is not None
        if unknown or not moves_freely or len(set(self.free)) < len(self.free):
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
        full_matrix = np.zeros((6, 6))
        full_matrix[:3, :3] = self.mass * np.eye(3)
        full_matrix[3:, 3:] = np.diag(tensor) if tensor.ndim == 1 else tensor
        rows = [MOTIONS.index(motion) for motion in self.free]
        matrix = np.eye(len(self.motions))
        matrix[: len(rows), : len(rows)] = full_matrix[np.ix_(rows, rows)]
        return matrix

    @property
    def motions(self) -> tuple[str, ...]:
        """Free motions, then the modes."""
        count = 0 if self.modes is None else len(self.modes)
        return (*self.free, *(f"q{i + 1}" for i in range(count)))

    @property
    def springs(self) -> tuple[ModalSpring, ...]:
        """Modal springs of the body."""
        if self.modes is None:
            return ()
        rows = zip(2 * np.pi * self.modes.frequency, self.modes.damping_ratio, strict=True)
        return tuple(
            ModalSpring(self.name, GeneralizedMaxwell(w**2, b=2 * zeta * w)) for w, zeta in rows
        )


def point_mass(name: str, mass: Quantity) -> Body:
    """Return a mass that bounces along z."""
    mass = convert_to_si(mass, "mass")
    return Body(name, mass)


def planar_body(
    name: str, mass: Quantity, inertia: float, *, at: tuple[float, float] = (0.0, 0.0)
) -> Body:
    """Return a rigid body in the x-y plane: x, y and the rotation rz, with its inertia about z."""
    mass = convert_to_si(mass, "mass")
    return Body(name, mass, inertia=(0.0, 0.0, inertia), at=(*at, 0.0), free=("x", "y", "rz"))


@dataclass(frozen=True)
class Mount:
    """Viscoelastic solid between two bodies, or a body and a ground, along one line.

    Attributes
    ----------
    solid : Solid
    between : (str, str)
        Names of two bodies, or of a body and a ground.
    at : (float, float, float)
        Attachment point, m.
    along : (float, float, float)
        The direction in which it acts; need not have length 1.
    rotary : bool
        True for a torsional mount about `along`: its solid is then in N m/rad.
    friction : AmplitudeDependent or None
        Element in parallel to the solid that depends on amplitude: friction, stiffening, or both.
    amplitude : float or None
        Amplitude of the stretch, m (rad), at which every linear answer takes the friction; None
        leaves it to ``dashpot.systems.response_at_level``.
    name : str
        Name of the part; mounts of one name are one part in the energy balance.
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
    def linearised_solid(self) -> Solid:
        """The linear solid of the mount, or its linearisation at the given amplitude.

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
    r"""Modal stiffness of a body: :math:`\omega_r^2 + 2\zeta_r\omega_r s`, per modal mass.

    Attributes
    ----------
    name : str
        Name of the body.
    linearised_solid : GeneralizedMaxwell
    """

    name: str
    linearised_solid: GeneralizedMaxwell


@dataclass(frozen=True)
class Point:
    """Point and direction on a body, of a force or an accelerometer.

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


def get_point_motion(point: Point, centre: Vector) -> FloatArray:
    r"""Return the motion of a point by the six motions of its body about `centre`, shape (6,).

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


def get_modal_motion(body: Body, point: Point) -> FloatArray:
    """Return how the modes of its body move a point along its direction, shape (modes,)."""
    if point.rotary or body.modes is None:
        raise DataError(
            f"'{body.name}' bends, and its modes do not say how it rotates at {point.at}; take a "
            "direction along which the point moves"
        )
    return np.asarray(body.modes.evaluate_shapes(point.at)[0] @ unit_vector(point.along))


def unit_vector(along: Vector) -> FloatArray:
    """Return the direction with length 1."""
    d = np.array(along, dtype=float)
    length = float(np.linalg.norm(d))
    if not (np.isfinite(length) and length > 0):
        raise DataError(f"direction {along!r} has no length; expected three numbers, not all 0")
    return d / length


# Systems: exact FRFs and transmissibility.


@dataclass(frozen=True)
class System:
    r"""Linear system of bodies, mounts and grounds with many degrees of freedom.

    .. math:: \left[s^2 M + E^T K(s) E\right] q = F - E^T K(s) G u

    with the stretch :math:`E q + G u` of each spring, motions q of the bodies, u of the grounds,
    and K(s) the diagonal of the springs' stiffnesses. The springs are the mounts, and what holds
    the modes of bodies that have any.

    Attributes
    ----------
    bodies : tuple of Body
    mounts : tuple of Mount
    grounds : tuple of str
        Bodies with prescribed motion, or at rest.

    Degrees of freedom are named ``"body.motion"``, such as ``"block.z"``.
    """

    bodies: tuple[Body, ...]
    mounts: tuple[Mount, ...]
    grounds: tuple[str, ...] = ("ground",)

    def __post_init__(self) -> None:
        names = [body.name for body in self.bodies] + list(self.grounds)
        if not self.bodies:
            raise DataError("a system needs at least one body")
        repeated_names = sorted({name for name in names if names.count(name) > 1})
        if repeated_names:
            raise DataError(
                f"'{repeated_names[0]}' names two things in the system; names must differ"
            )
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
        return tuple(f"{body.name}.{motion}" for body in self.bodies for motion in body.motions)

    @property
    def base_dofs(self) -> tuple[str, ...]:
        """Names of the ground motions: six each, rotations about the origin."""
        return tuple(f"{ground}.{motion}" for ground in self.grounds for motion in MOTIONS)

    def with_modes(self, body: str, modes: FreeModes) -> System:
        """Return the system with an elastic body.

        Parameters
        ----------
        body : str
        modes : FreeModes
            Its free elastic modes; rigid ones are omitted, since the body has mass and inertia.
        """
        if body not in [body.name for body in self.bodies]:
            names_text = ", ".join(body.name for body in self.bodies)
            raise DataError(f"no body '{body}'; the system has {names_text}")
        elastic_modes = modes.only(~modes.rigid)
        bodies = [
            replace(item, modes=elastic_modes) if item.name == body else item
            for item in self.bodies
        ]
        return replace(self, bodies=tuple(bodies))

    @cached_property
    def _columns(self) -> dict[str, int]:
        """Column of each motion of the bodies, then of the grounds."""
        return {name: i for i, name in enumerate(self.dofs + self.base_dofs)}

    # -- matrices -------------------------------------------------------------------------------

    @cached_property
    def mass_matrix(self) -> FloatArray:
        """M, shape (n, n)."""
        from scipy.linalg import block_diag

        return np.asarray(block_diag(*(body.mass_matrix for body in self.bodies)))

    @cached_property
    def stretch(self) -> FloatArray:
        """E, shape (springs, n): how the bodies' motions stretch each spring."""
        return self._stretch[:, : len(self.dofs)]

    @cached_property
    def base_stretch(self) -> FloatArray:
        """G, shape (springs, 6 grounds): how the grounds' motions stretch each spring."""
        return self._stretch[:, len(self.dofs) :]

    @cached_property
    def springs(self) -> tuple[Mount | ModalSpring, ...]:
        """The mounts, then the springs of the modes of the bodies."""
        return (*self.mounts, *(spring for body in self.bodies for spring in body.springs))

    def spring_stiffness(self, s: npt.ArrayLike) -> ComplexArray:
        """K of each spring at s, 1/s, shape (..., springs)."""
        return self._evaluate_springs(s, lambda solid, at: solid.stiffness_at(at))

    def spring_slope(self, s: npt.ArrayLike) -> ComplexArray:
        """dK/ds of each spring at s, shape (..., springs)."""
        return self._evaluate_springs(s, lambda solid, at: solid.slope_at(at))

    def dynamic_stiffness(self, s: npt.ArrayLike) -> ComplexArray:
        r""":math:`s^2 M + E^T K(s) E`, shape (..., n, n)."""
        s = to_complex(s)
        K = self.spring_stiffness(s)
        E = self.stretch
        return np.asarray(s[..., None, None] ** 2 * self.mass_matrix + (E.T * K[..., None, :]) @ E)

    def receptance(self, s: npt.ArrayLike) -> ComplexArray:
        """Motion per force between every two degrees of freedom at s, shape (..., n, n).

        Raises
        ------
        DataError
            If the system is singular there: a body is not held.
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
        """Return how each degree of freedom moves a place along its direction, shape (n,)."""
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
        f = validate_samples("frequency", frequency)
        s = 2j * np.pi * f + shift
        H = self.receptance(s) @ self.participation(force) @ self.participation(response)
        return FRF.from_receptance(f, H, kind=kind, shift=shift)

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
        s = 2j * np.pi * validate_samples("frequency", frequency)
        if base not in self.base_dofs:
            raise DataError(f"'{base}' is no ground motion; known: {', '.join(self.base_dofs)}")
        G = self.base_stretch[:, self.base_dofs.index(base)]
        forces = -(self.spring_stiffness(s) * G) @ self.stretch
        motion = np.linalg.solve(self.dynamic_stiffness(s), forces[..., None])[..., 0]
        return np.asarray(motion @ self.participation(response))

    # -- private --------------------------------------------------------------------------------

    def _evaluate_springs(
        self, s: npt.ArrayLike, function: Callable[[Solid, ComplexArray], ComplexArray]
    ) -> ComplexArray:
        s = to_complex(s)
        entries: dict[Solid, ComplexArray] = {}  # a line of seal is one solid many times
        solids = [spring.linearised_solid for spring in self.springs]
        for solid in solids:
            if solid not in entries:
                entries[solid] = function(solid, s)
        rows = [entries[solid] for solid in solids]
        return np.stack(rows, axis=-1) if rows else np.zeros((*s.shape, 0), dtype=complex)

    @cached_property
    def _stretch(self) -> FloatArray:
        columns = len(self.dofs) + len(self.base_dofs)
        rows = [
            self._row(Point(mount.between[0], mount.at, mount.along, mount.rotary))
            - self._row(Point(mount.between[1], mount.at, mount.along, mount.rotary))
            for mount in self.mounts
        ]
        fixed_motions = [
            f"{body.name}.{motion}"
            for body in self.bodies
            for motion in body.motions[len(body.free) :]
        ]
        rows += [self._row(dof) for dof in fixed_motions]
        return np.array(rows).reshape(len(rows), columns)

    def _row(self, place: str | Point) -> FloatArray:
        """Return how body motions, then ground motions, move a place, shape (n + 6 grounds,)."""
        names = self._columns
        row = np.zeros(len(names))
        if isinstance(place, str):
            if place not in names:
                raise DataError(f"'{place}' is no degree of freedom; known: {', '.join(names)}")
            row[names[place]] = 1.0
            return row
        bodies: dict[str, Body | None] = {body.name: body for body in self.bodies}
        bodies |= dict.fromkeys(self.grounds)
        if place.body not in bodies:
            raise DataError(f"no body '{place.body}'; the system has {', '.join(bodies)}")
        body = bodies[place.body]
        centre = (0.0, 0.0, 0.0) if body is None else body.at
        motion = dict(zip(MOTIONS, get_point_motion(place, centre), strict=True))
        if body is not None and body.modes:
            motion |= zip(
                body.motions[len(body.free) :], get_modal_motion(body, place), strict=True
            )
        for name, value in motion.items():
            dof = f"{place.body}.{name}"
            if dof in names:  # a motion that is held does not move the point
                row[names[dof]] = value
        return row
