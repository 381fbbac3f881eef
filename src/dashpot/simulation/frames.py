"""Where the plate is: set-points on a line in space, and a transducer turned from its normal."""

from __future__ import annotations

from math import cos, sin
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError

Point: TypeAlias = tuple[float, float, float]
"""x, y, z, m; or a direction."""


def setpoints(
    start: float | Point, stop: float | Point, *, duration: float, interval: float
) -> FloatArray:
    """Positions that a robot is sent through, evenly spaced in time, both ends exact.

    >>> len(setpoints(0.0, -8e-3, duration=1.0, interval=10e-3))
    101
    >>> setpoints((0, 0, 0), (0, 0, -8e-3), duration=1.0, interval=10e-3)[-1].tolist()
    [0.0, 0.0, -0.008]
    """
    first, last = np.asarray(start, dtype=float), np.asarray(stop, dtype=float)
    count = max(1, round(duration / interval))
    points = np.asarray(first + np.multiply.outer(np.arange(count + 1), last - first) / count)
    points[-1] = last
    return points


def unit(direction: npt.ArrayLike) -> FloatArray:
    """Return a direction as a vector of length 1.

    Raises
    ------
    DataError
        If it is not three numbers, or has no length.
    """
    vector = np.asarray(direction, dtype=float)
    length = float(np.linalg.norm(vector)) if vector.shape == (3,) else 0.0
    if not (np.isfinite(length) and length > 0):
        raise DataError(f"{direction!r} is no direction; expected three numbers, not all zero")
    return np.asarray(vector / length)


def tilted(force: npt.ArrayLike, angle: float, *, towards: float = 0.0) -> FloatArray:
    r"""Return the force that a misaligned transducer feels, shape (3, n), N.

    A seal pushes along the plate's normal; a transducer turned by `angle` from it feels

    .. math:: F\,(\sin\theta\cos\varphi,\; \sin\theta\sin\varphi,\; \cos\theta)

    Parameters
    ----------
    force : array_like, shape (n,)
        Along the normal, N.
    angle, towards : float
        :math:`\theta` from the normal and :math:`\varphi` from x, rad.
    """
    arrow = [sin(angle) * cos(towards), sin(angle) * sin(towards), cos(angle)]
    return np.asarray(np.multiply.outer(arrow, np.asarray(force, dtype=float)))
