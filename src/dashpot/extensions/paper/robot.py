"""The robot of the paper's bench: three axes, an arm with two links, and their encoders."""

from __future__ import annotations

from math import atan2, hypot, pi

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass, field
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.simulation.robot import Axis, Point, unit


def compute_depth_along(
    positions: npt.ArrayLike, normal: npt.ArrayLike, *, contact: Point = (0.0, 0.0, 0.0)
) -> FloatArray:
    r"""Return the compression along the plate's normal, :math:`(p - p_0) \cdot \hat n`, m.

    Parameters
    ----------
    positions : array, shape (n, 3)
        m.
    normal : array, shape (3,)
        Into the seal; of any length.
    contact : (float, float, float)
        Where the plate touches, m.
    """
    return np.asarray((np.asarray(positions, dtype=float) - np.asarray(contact)) @ unit(normal))


@dataclass(frozen=True)
class Robot:
    """Three axes at right angles, each with its own controller and encoder.

    Attributes
    ----------
    axes : tuple of Axis
        x, y, z.
    encoder : float
        Position quantum of each, m; 0 for none.
    """

    axes: tuple[Axis, Axis, Axis] = field(default_factory=lambda: (Axis(), Axis(), Axis()))
    encoder: float = 0.02e-3

    def follow(self, reference: npt.ArrayLike) -> FloatArray:
        """Return the true position at each control instant, shape (n, 3), m.

        Parameters
        ----------
        reference : array_like, shape (n, 3)
            Set-point in force at each control instant, m.
        """
        target = np.asarray(reference, dtype=float)
        return np.column_stack([a.follow(w) for a, w in zip(self.axes, target.T, strict=True)])

    def read(self, positions: FloatArray) -> FloatArray:
        """Return the encoder readings of positions, m: whole counts of each axis."""
        counts = np.round(positions / self.encoder) if self.encoder else positions
        return np.asarray(counts * self.encoder if self.encoder else counts)


@dataclass(frozen=True)
class Arm:
    r"""Two links that turn about z, and a spindle along it (2R+z), with their encoders.

    .. math:: x = l_1 \cos q_1 + l_2 \cos(q_1 + q_2), \quad y = l_1 \sin q_1 + l_2 \sin(q_1 + q_2)

    Attributes
    ----------
    links : (float, float)
        Lengths, m.
    count : float
        Angle of one count of each joint, rad; 0 for none.
    encoder : float
        Position quantum of the spindle, m; 0 for none.
    """

    links: tuple[float, float] = (0.3, 0.25)
    count: float = 2 * pi / 2**17
    encoder: float = 0.02e-3

    def place(self, joints: npt.ArrayLike) -> FloatArray:
        """Return x, y, z, m, shape (n, 3), of the joints: two angles, rad, and a height, m."""
        first, second, z = np.asarray(joints, dtype=float).T
        a, b = self.links
        x, y = (a * f(first) + b * f(first + second) for f in (np.cos, np.sin))
        return np.column_stack((x, y, z))

    def joints(self, positions: npt.ArrayLike) -> FloatArray:
        """Return the joints, shape (n, 3), that put the plate there, the elbow to one side.

        Raises
        ------
        DataError
            If the arm does not reach.
        """
        x, y, z = np.asarray(positions, dtype=float).T
        a, b = self.links
        cosine = (x**2 + y**2 - a**2 - b**2) / (2 * a * b)
        if not (np.abs(cosine) <= 1).all():
            raise DataError(
                f"an arm of {a:g} and {b:g} m reaches from {abs(a - b):g} to {a + b:g} m from its "
                f"axis; found {np.hypot(x, y).min():g} to {np.hypot(x, y).max():g} m"
            )
        second = np.arccos(cosine)
        first = np.arctan2(y, x) - np.arctan2(b * np.sin(second), a + b * cosine)
        return np.column_stack((first, second, z))

    def read(self, positions: FloatArray) -> FloatArray:
        """Return where its encoders say that it is, m: whole counts of each joint."""
        quanta = (self.count, self.count, self.encoder)
        quantised = [
            np.round(q / value) * value if value else q
            for q, value in zip(self.joints(positions).T, quanta, strict=True)
        ]
        return self.place(np.column_stack(quantised))


def compute_misalignment(x: float, y: float, z: float) -> float:
    r"""Return the angle between plate and transducer, :math:`\arctan(F_{lat} / F_z)`, rad."""
    return atan2(hypot(x, y), z)
