"""Elastic modes of a free body."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass, replace
from dashpot.base.arrays import (
    BoolArray,
    EqualByValue,
    FloatArray,
    make_readonly_copy,
    validate_samples,
)
from dashpot.base.errors import DataError
from dashpot.base.provenance import Source

_RIGID_TOLERANCE = 1e-3
"""Relative deviation of a shape from a rigid motion up to which it counts as rigid."""
_NEIGHBOUR_COUNT = 8
"""Points among which the next ones to a place are looked for."""


@dataclass(frozen=True, eq=False)
class FreeModes(EqualByValue):
    r"""Undamped modes, scaled to a modal mass of 1 kg: :math:`u(p) = \sum_r \phi_r(p)\,q_r`.

    Attributes
    ----------
    frequency : array, shape (r,)
        Hz; 0, or nearly, of a rigid motion.
    place : array, shape (p, 3)
        Where the shapes are known, m.
    shapes : array, shape (r, p, 3)
        :math:`\phi`, along x, y and z, 1/sqrt(kg).
    damping_ratio : float or array, shape (r,)
        Damping ratio of the structure by itself.
    source : Source or None
    """

    frequency: FloatArray
    place: FloatArray
    shapes: FloatArray
    damping_ratio: FloatArray = 0.0  # type: ignore[assignment]
    source: Source | None = None

    def __post_init__(self) -> None:
        f = validate_samples("frequency", self.frequency)
        positions = np.array(self.place, dtype=float)
        shape = np.array(self.shapes, dtype=float)
        if (
            positions.ndim != 2
            or positions.shape[1] != 3
            or shape.shape != (len(f), len(positions), 3)
        ):
            raise DataError(
                f"modes need places of shape (p, 3) and shapes of (modes, p, 3); found "
                f"{positions.shape} and {shape.shape} for {len(f)} frequencies"
            )
        if not (np.isfinite(positions).all() and np.isfinite(shape).all()):
            raise DataError("a place or a shape of the modes is not finite")
        if (f < 0).any():
            raise DataError(f"a mode has a frequency of {f.min():g} Hz; expected numbers >= 0")
        zeta = _expand_damping_ratios(self.damping_ratio, len(f))
        zero_modes = np.flatnonzero(np.abs(shape).max(axis=(1, 2)) == 0)
        if zero_modes.size:
            raise DataError(
                f"mode {int(zero_modes[0]) + 1} of {len(f)}, at {f[zero_modes[0]]:.5g} Hz, does "
                "not move any of its points"
            )
        checked = {"frequency": f, "place": positions, "shapes": shape, "damping_ratio": zeta}
        for name, value in checked.items():
            object.__setattr__(self, name, make_readonly_copy(value))

    def __len__(self) -> int:
        return len(self.frequency)

    def only(self, chosen: npt.ArrayLike) -> FreeModes:
        """Return some of the modes, by a mask or by their numbers."""
        indices = np.asarray(chosen)
        return replace(
            self,
            frequency=self.frequency[indices],
            shapes=self.shapes[indices],
            damping_ratio=self.damping_ratio[indices],
        )

    def evaluate_shapes(self, place: npt.ArrayLike) -> tuple[FloatArray, float]:
        """Shapes at a point, shape (r, 3), and its distance from the nearest given point, m.

        Straight between the two neighbouring points whose connection passes nearest: exact at a
        point, and of second order between points along a line.
        """
        p = np.asarray(place, dtype=float)
        distances = np.linalg.norm(self.place - p, axis=1)
        neighbours = np.argsort(distances, kind="stable")[:_NEIGHBOUR_COUNT]
        first = int(neighbours[0])
        legs = self.place[neighbours[1:]] - self.place[first]
        square = np.einsum("ij,ij->i", legs, legs)
        difference = square > 0
        if distances[first] == 0 or not difference.any():
            return self.shapes[:, first], float(distances[first])
        others_used, legs, square = neighbours[1:][difference], legs[difference], square[difference]
        ratio = np.clip(legs @ (p - self.place[first]) / square, 0.0, 1.0)
        norm = np.linalg.norm(self.place[first] + ratio[:, None] * legs - p, axis=1)
        # of connections as near, the shortest
        best = int(np.lexsort((square, np.round(norm, 12)))[0])
        t, other = float(ratio[best]), int(others_used[best])
        return (1 - t) * self.shapes[:, first] + t * self.shapes[:, other], float(norm[best])

    @property
    def rigid(self) -> BoolArray:
        """Whether each mode is a rigid motion of its points, shape (r,)."""
        motions, _ = self._as_rigid()
        shapes = self.shapes.reshape(len(self), -1)
        residual = shapes - motions
        size = np.linalg.norm(shapes, axis=1)
        elastic = float(self.frequency.max())
        change = np.linalg.norm(residual, axis=1) <= _RIGID_TOLERANCE * size
        return np.asarray(change & (self.frequency <= 0.5 * elastic))

    @property
    def rigid_motion(self) -> FloatArray:
        """Translation of the origin and rotation about it of each rigid mode, shape (rigid, 6)."""
        return self._as_rigid()[1][self.rigid]

    def rigid_mass(self) -> FloatArray:
        r"""Mass and inertia about the origin that six rigid modes imply, shape (6, 6), kg, kg m^2.

        With :math:`\phi_r = R\,t_r` of a modal mass of 1, :math:`T^T M T = 1`.

        Raises
        ------
        DataError
            If there are not six of them.
        """
        T = self.rigid_motion.T
        if T.shape != (6, 6) or np.linalg.matrix_rank(T) < 6:
            raise DataError(
                f"{T.shape[1]} of the {len(self)} modes are rigid motions, and only six say what "
                "the door weighs; give its mass, centre and inertia"
            )
        inverse = np.linalg.inv(T)
        return np.asarray(inverse.T @ inverse)

    def _as_rigid(self) -> tuple[FloatArray, FloatArray]:
        """Return the rigid motion next to each shape, (r, 3p), and its six numbers, (r, 6)."""
        x, y, z = self.place.T
        zeros, item = np.zeros_like(x), np.ones_like(x)
        R = np.stack(
            [
                np.stack((item, zeros, zeros, zeros, z, -y), axis=1),
                np.stack((zeros, item, zeros, -z, zeros, x), axis=1),
                np.stack((zeros, zeros, item, y, -x, zeros), axis=1),
            ],
            axis=1,
        ).reshape(-1, 6)
        motion = np.linalg.lstsq(R, self.shapes.reshape(len(self), -1).T, rcond=None)[0].T
        return motion @ R.T, motion


def _expand_damping_ratios(damping_ratio: npt.ArrayLike, count: int) -> FloatArray:
    """Return the damping ratio of each mode."""
    zeta = np.array(damping_ratio, dtype=float)
    zeta = np.full(count, zeta) if zeta.shape == () else zeta
    if zeta.shape != (count,) or not ((zeta >= 0) & (zeta < 1)).all():
        raise DataError("the damping ratios of modes must be one each, from 0 up to 1")
    return zeta
