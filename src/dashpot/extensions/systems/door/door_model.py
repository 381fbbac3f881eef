"""A door as its file describes it: mass, hinges, latch, bumpers, seal line, modes."""

from __future__ import annotations

from typing import TypeAlias

from dashpot.base import dataclass, field
from dashpot.base.arrays import EqualByValue
from dashpot.base.provenance import Source
from dashpot.datamodel.seal_line import LineFriction
from dashpot.extensions.systems.door.closing_setup import ClosingSetup
from dashpot.extensions.systems.door.leak_setup import LeakSetup
from dashpot.extensions.systems.door.seal_line import SealLine

Vector: TypeAlias = tuple[float, float, float]

PITCH = 0.025
"""m, of the stations where none is stated."""


@dataclass(frozen=True)
class RigidPart:
    """Rigid part: a door, or the car body around it.

    Attributes
    ----------
    mass : float
        kg.
    inertia : (float, float, float) or three rows of three
        Moments about axes through its centre of gravity that are parallel to x, y and z, or the
        whole tensor, kg m^2.
    centre : (float, float, float)
        Centre of gravity, m.
    motions : tuple of str
        Those in which it is free: of x, y, z, rx, ry, rz.
    """

    mass: float
    inertia: Vector | tuple[Vector, Vector, Vector]
    centre: Vector
    motions: tuple[str, ...] = ("x", "y", "z", "rx", "ry", "rz")


@dataclass(frozen=True)
class Support:
    """Support of the door besides its seal: a hinge, the latch or a bumper.

    Attributes
    ----------
    name : str
    at : (float, float, float)
        m.
    stiffness, damping : tuple of float
        Along x, y and z, or the one along `along`, N/m and N s/m.
    along : (float, float, float) or None
    fit : str
        Path of the fit of the part, in place of stiffness and damping; "" if there is none.
    compression : float or None
        Compression of that part, m.
    """

    name: str
    at: Vector
    stiffness: tuple[float, ...] = ()
    damping: tuple[float, ...] = ()
    along: Vector | None = None
    fit: str = ""
    compression: float | None = None


@dataclass(frozen=True)
class ShearChoice:
    """Shear stiffness of the seal of a door.

    Attributes
    ----------
    across, along : float or str
        Fit of the stiffness normal to the line; or the path of a fit of a specimen that was pressed
        and then moved that way.
    length : float or None
        Length of that specimen, m; None where the fit states it.
    """

    across: float | str = 0.0
    along: float | str = 0.0
    length: float | None = None


@dataclass(frozen=True)
class SealChoice:
    """Seal along the line of a door.

    Attributes
    ----------
    fit : str
        Path of the fit of a specimen of it.
    length : float or None
        Length of that specimen, m; None where the fit states it.
    temperature : float or None
        K; None for the temperature of the fit.
    pitch : float or None
        Wanted distance of its stations, m.
    shear : ShearChoice
    friction : LineFriction or None
    """

    fit: str
    length: float | None = None
    temperature: float | None = None
    pitch: float | None = None
    shear: ShearChoice = ShearChoice()
    friction: LineFriction | None = None


@dataclass(frozen=True)
class ModesChoice:
    """Free modes of the door, from a file.

    Attributes
    ----------
    path : str
    unit : str or None
        Default unit of the coordinates.
    modal_mass : float or None
        Default modal mass of every mode, kg.
    damping : float or None
        Damping ratio of every mode, in place of the value in the file.
    most : float
        Modes above this frequency are omitted, Hz.
    is_hung : bool
        The modes belong to the hung door, without rigid motions.
    """

    path: str
    unit: str | None = None
    modal_mass: float | None = None
    damping: float | None = None
    most: float = float("inf")
    is_hung: bool = False


@dataclass(frozen=True)
class DoorPoint:
    """Point and direction of a measured or driven motion.

    Attributes
    ----------
    name : str
    at, along : (float, float, float)
        m, and a direction.
    on : str
        ``"door"`` or ``"body"``.
    """

    name: str
    at: Vector
    along: Vector
    on: str = "door"


@dataclass(frozen=True, eq=False)
class Door(EqualByValue):
    """Door as its file describes it, in SI units; x, y and z are the file's own axes.

    Attributes
    ----------
    rigid : RigidPart or None
        Mass and inertia; None where its modes bring them along.
    width, height : float or None
        Along x and y, m.
    hinges, bumpers : tuple of Support
    latch : Support or None
    line : SealLine or None
        Without its section, which is the fit's.
    seal : SealChoice or None
    modes : ModesChoice or None
    points : tuple of DoorPoint
    body : RigidPart or None
        The car body; None stands still, or moves as prescribed.
    base : str
        How the body shakes: a file, or words such as ``"0.01g^2/Hz"``; "" if it does not.
    base_along : (float, float, float)
    closing : ClosingSetup
        Data for the closing analysis.
    leak : LeakSetup or None
        Pressure on its seal.
    source : Source or None

    Examples
    --------
    >>> import dashpot as dp
    >>> dp.predict(dp.read("door.toml"), close="1.2m/s").verdict.use  # doctest: +SKIP
    'use'
    """

    rigid: RigidPart | None = None
    width: float | None = None
    height: float | None = None
    hinges: tuple[Support, ...] = ()
    latch: Support | None = None
    bumpers: tuple[Support, ...] = ()
    line: SealLine | None = None
    seal: SealChoice | None = None
    modes: ModesChoice | None = None
    points: tuple[DoorPoint, ...] = ()
    body: RigidPart | None = None
    base: str = ""
    base_along: Vector = (0.0, 0.0, 1.0)
    closing: ClosingSetup = field(default_factory=ClosingSetup)
    leak: LeakSetup | None = None
    source: Source | None = None

    @property
    def pitch(self) -> float:
        """Distance of the stations along the seal line, m."""
        given_pitch = None if self.seal is None else self.seal.pitch
        return PITCH if given_pitch is None else given_pitch
