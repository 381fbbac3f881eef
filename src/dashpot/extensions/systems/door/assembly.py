"""Assembly of a door's system: its bodies, mounts and seal line."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.extensions.systems.door.door_model import Door, RigidPart, Support
from dashpot.extensions.systems.door.mounts import make_line_mounts
from dashpot.extensions.systems.free_modes import FreeModes
from dashpot.extensions.systems.multibody import Body, Mount, System
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid

DOOR, BODY = "door", "body"
_MASS_TOLERANCE = 0.01
"""Relative difference of the masses that rigid modes imply along x, y and z."""
_MAX_RIGID_HZ = 1.0
"""Hz, below which no door bends."""
AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True)
class Assembly:
    """Door with the contents of its files.

    Attributes
    ----------
    door : Door
        Its line with the section, if it has a seal.
    modes : FreeModes or None
        Modes of the door.
    parts : mapping
        From the path of a fit to the solid of the part, N/m.
    """

    door: Door
    modes: FreeModes | None = None
    parts: Mapping[str, Solid] | None = None

    def body(self) -> Body:
        """Return the door by itself: mass and inertia as stated, else those that its modes imply.

        Raises
        ------
        DataError
            If neither is available, or the rigid modes are inconsistent.
        """
        rigid, modes = self.door.rigid, self.modes
        choice = self.door.modes
        is_hung = choice is not None and choice.is_hung
        if modes is not None and is_hung:
            return Body(DOOR, 1.0 if rigid is None else rigid.mass, free=(), modes=modes)
        if rigid is None:
            if modes is None:
                raise DataError(
                    "the door has no mass: give [door] its mass, centre and inertia, or [modes] "
                    "with its six rigid ones"
                )
            rigid = find_rigid_body(modes)
        elastic = None if modes is None else _select_elastic_modes(modes)
        return Body(
            DOOR, rigid.mass, rigid.inertia, at=rigid.centre, free=rigid.motions, modes=elastic
        )

    def system(
        self, *, sealed: bool = True, pitch: float | None = None, friction_sticks: bool = True
    ) -> System:
        """Return the door on its hinges, latch and bumpers, with its seal or without.

        Parameters
        ----------
        sealed : bool
        pitch : float, optional
            Pitch of the stations, m; by default the one stated.
        friction_sticks : bool
            The friction of the seal sticks, as under small vibration; else it may slip, and the
            response depends on amplitude.
        """
        door = self.door
        bodies = [self.body()]
        grounds: tuple[str, ...] = (BODY,)
        if door.body is not None:
            car = door.body
            bodies.append(Body(BODY, car.mass, car.inertia, at=car.centre, free=car.motions))
            grounds = ()
        latches = () if door.latch is None else (door.latch,)
        mounts = [
            mount
            for support in (*door.hinges, *latches, *door.bumpers)
            for mount in self._held_by(support)
        ]
        if sealed and door.line is not None:
            requested_pitch = pitch or self.door.pitch
            mounts += make_line_mounts(
                door.line, DOOR, requested_pitch, ground=BODY, friction_sticks=friction_sticks
            )
        return System(tuple(bodies), tuple(mounts), grounds)

    def _held_by(self, support: Support) -> list[Mount]:
        if support.fit:
            solids = [(self.parts or {})[support.fit]]
        else:
            damping = support.damping or (0.0,) * len(support.stiffness)
            pairs = zip(support.stiffness, damping, strict=True)
            solids = [GeneralizedMaxwell(k, b=b) for k, b in pairs]
        directions = AXES if support.along is None else (support.along,)
        return [
            Mount(solid, (DOOR, BODY), support.at, direction, name=support.name)
            for solid, direction in zip(solids, directions, strict=True)
            if solid.k_0 > 0 or solid.maxwell.b > 0
        ]


def _select_elastic_modes(modes: FreeModes) -> FreeModes | None:
    """Return the modes by which a door bends; those at rest must be rigid motions."""
    is_elastic = ~modes.rigid
    zero_frequency_count = int((modes.frequency[is_elastic] < _MAX_RIGID_HZ).sum())
    if zero_frequency_count:
        raise DataError(
            f"{zero_frequency_count} of {len(modes)} modes lie below {_MAX_RIGID_HZ:g} Hz and are "
            "no rigid motions of their points: the axes of shapes and points differ, or the "
            "points are not those of the shapes; modes of a door that hangs need held = true"
        )
    return modes.only(is_elastic) if is_elastic.any() else None


def compute_inertia_about_origin(part: RigidPart) -> FloatArray:
    """Mass and inertia of a rigid part about the origin, shape (6, 6), kg, kg m, kg m^2."""
    x, y, z = part.centre
    tensor = np.array(part.inertia, dtype=float)
    offset = np.array([(0.0, z, -y), (-z, 0.0, x), (y, -x, 0.0)])  # u = d + offset @ rotation
    mass_about_origin = np.zeros((6, 6))
    mass_about_origin[:3, :3] = part.mass * np.eye(3)
    mass_about_origin[:3, 3:] = part.mass * offset
    mass_about_origin[3:, :3] = mass_about_origin[:3, 3:].T
    turning = np.diag(tensor) if tensor.ndim == 1 else tensor
    mass_about_origin[3:, 3:] = turning + part.mass * offset.T @ offset
    return mass_about_origin


def estimate_mass(modes: FreeModes, part: RigidPart) -> float | None:
    r"""Mass, kg, of a door like `part` whose rigid modes those are, :math:`m\,t^T M t = m'`.

    None if no mode is rigid.
    """
    motion = modes.rigid_motion
    if not len(motion):
        return None
    modal = np.einsum("ri,ij,rj->r", motion, compute_inertia_about_origin(part), motion)
    return float(part.mass / np.median(modal))


def find_rigid_body(modes: FreeModes) -> RigidPart:
    """Mass, centre and the inertia tensor about it that six rigid modes imply.

    Raises
    ------
    DataError
        If there are not six, or they imply three different masses along x, y and z.
    """
    mass_matrix = modes.rigid_mass()
    masses = np.diag(mass_matrix)[:3]
    mass = float(masses.mean())
    if np.ptp(masses) > _MASS_TOLERANCE * mass:
        masses_text = ", ".join(f"{mass:.4g}" for mass in masses)
        raise DataError(
            f"the rigid modes imply masses of {masses_text} kg along x, y and z; expected one: "
            "their modal masses, or the unit of their coordinates, are not what was said"
        )
    coupled = mass_matrix[:3, 3:] / mass
    c = np.array([coupled[1, 2], coupled[2, 0], coupled[0, 1]])
    tensor = mass_matrix[3:, 3:] - mass * (c @ c * np.eye(3) - np.outer(c, c))
    xx, xy, xz, yx, yy, yz, zx, zy, zz = ((tensor + tensor.T) / 2).ravel().tolist()
    x, y, z = c.tolist()
    return RigidPart(mass, ((xx, xy, xz), (yx, yy, yz), (zx, zy, zz)), (x, y, z))
