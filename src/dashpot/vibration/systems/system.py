"""Bodies joined by viscoelastic mounts: FRFs and transmissibility, exactly."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from dashpot.base.arrays import ComplexArray, FloatArray, samples
from dashpot.base.errors import DataError
from dashpot.datamodel.free_modes import FreeModes
from dashpot.datamodel.frf import FRF, Kind
from dashpot.solids.maxwell import Solid
from dashpot.vibration.systems.bodies import (
    MOTIONS,
    Body,
    ModalSpring,
    Mount,
    Point,
    bent_by,
    motion_of,
)


@dataclass(frozen=True)
class System:
    r"""Bodies, mounts and grounds: a linear system of many degrees of freedom.

    .. math:: \left[s^2 M + E^T K(s) E\right] q = F - E^T K(s) G u

    with the stretch :math:`E q + G u` of each spring, motions q of the bodies, u of the grounds,
    and K(s) the diagonal of the springs' stiffnesses. The springs are the mounts, and what holds
    the modes of bodies that have any.

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
        return tuple(f"{body.name}.{motion}" for body in self.bodies for motion in body.motions)

    @property
    def base_dofs(self) -> tuple[str, ...]:
        """Names of the ground motions: six each, rotations about the origin."""
        return tuple(f"{ground}.{motion}" for ground in self.grounds for motion in MOTIONS)

    def with_modes(self, body: str, modes: FreeModes) -> System:
        """The system with a body that bends, too.

        Parameters
        ----------
        body : str
        modes : FreeModes
            Its elastic modes, as it moves when nothing holds it; rigid ones are left out, since the
            body's mass and inertia are there for them.
        """
        if body not in [body.name for body in self.bodies]:
            listed = ", ".join(body.name for body in self.bodies)
            raise DataError(f"no body '{body}'; the system has {listed}")
        bent = modes.only(~modes.rigid)
        bodies = [replace(item, modes=bent) if item.name == body else item for item in self.bodies]
        return replace(self, bodies=tuple(bodies))

    @cached_property
    def _columns(self) -> dict[str, int]:
        """Where each motion of the bodies, then of the grounds, stands in a row."""
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
        """The mounts, then what holds the modes of the bodies."""
        return (*self.mounts, *(spring for body in self.bodies for spring in body.springs))

    def spring_stiffness(self, s: npt.ArrayLike) -> ComplexArray:
        """K of each spring at s, 1/s, shape (..., springs)."""
        return self._evaluate_springs(s, lambda solid, at: solid.stiffness_at(at))

    def spring_slope(self, s: npt.ArrayLike) -> ComplexArray:
        """dK/ds of each spring at s, shape (..., springs)."""
        return self._evaluate_springs(s, lambda solid, at: solid.slope_at(at))

    def dynamic_stiffness(self, s: npt.ArrayLike) -> ComplexArray:
        r""":math:`s^2 M + E^T K(s) E`, shape (..., n, n)."""
        s = np.asarray(s, dtype=complex)
        K = self.spring_stiffness(s)
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
        forces = -(self.spring_stiffness(s) * G) @ self.stretch
        motion = np.linalg.solve(self.dynamic_stiffness(s), forces[..., None])[..., 0]
        return np.asarray(motion @ self.participation(response))

    # -- private --------------------------------------------------------------------------------

    def _evaluate_springs(
        self, s: npt.ArrayLike, function: Callable[[Solid, ComplexArray], ComplexArray]
    ) -> ComplexArray:
        s = np.asarray(s, dtype=complex)
        entries: dict[Solid, ComplexArray] = {}  # a line of seal is one solid many times
        solids = [spring.felt for spring in self.springs]
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
        held = [
            f"{body.name}.{motion}"
            for body in self.bodies
            for motion in body.motions[len(body.free) :]
        ]
        rows += [self._row(dof) for dof in held]
        return np.array(rows).reshape(len(rows), columns)

    def _row(self, place: str | Point) -> FloatArray:
        """How body motions, then ground motions, move a place, shape (n + 6 grounds,)."""
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
        at = (0.0, 0.0, 0.0) if body is None else body.at
        motion = dict(zip(MOTIONS, motion_of(place, at), strict=True))
        if body is not None and body.modes:
            motion |= zip(body.motions[len(body.free) :], bent_by(body, place), strict=True)
        for name, value in motion.items():
            dof = f"{place.body}.{name}"
            if dof in names:  # a motion that is held does not move the point
                row[names[dof]] = value
        return row
