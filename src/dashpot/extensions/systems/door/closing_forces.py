"""Forces on a closing door: the viscoelastic seal and air, angle by angle."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.datamodel.seal_line import SealSection
from dashpot.extensions.systems.door import air_flow
from dashpot.extensions.systems.door.closing_setup import Air, DoorPosition
from dashpot.solids.moving_plate import EvenStep


class PressedSeal:
    """Seal at every station of every door: its arms, and their forces.

    Parameters
    ----------
    section : SealSection
    lever : array, shape (stations,)
        m.
    share : array, shape (doors, stations)
        m of seal, by the factors of its force.
    dashpot : array, shape (doors,)
        Beside the solid, N s/m per m.
    closed_compression : array, shape (doors, stations)
        Compression with the door closed, m.
    angle : float
        To which it is pressed, and relaxed there.
    """

    def __init__(
        self,
        section: SealSection,
        *,
        lever: FloatArray,
        share: FloatArray,
        dashpot: FloatArray,
        closed_compression: FloatArray,
        angle: float,
    ) -> None:
        self.section, self.lever, self.share, self.closed = (
            section,
            lever,
            share,
            closed_compression,
        )
        solid = section.solid.maxwell
        self.k_inf, self.b = solid.k_inf, solid.b + dashpot[:, None]
        self.k, self.tau = np.array(solid.k), np.array(solid.tau)
        self.at = np.maximum(closed_compression - lever * angle, 0.0)
        self.path = section.path(self.at)
        self.arms = np.zeros((*closed_compression.shape, len(self.k)))

    def step(self, angle: float, seconds: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Press on to an angle: work of the relaxed force and of the rest, J, shape (doors,)."""
        at = np.maximum(self.closed - self.lever * angle, 0.0)
        path = self.section.path(at)
        compression, change = at - self.at, path - self.path
        mean_relaxed_force = 0.5 * self.k_inf * (path + self.path)
        steps = EvenStep.from_ratio((seconds[:, None] / self.tau)[:, None, :])
        elastic_force = self.k * change[..., None]
        relaxing_work = (
            steps.mean(self.arms, elastic_force).sum(axis=-1) + self.b * change / seconds[:, None]
        )
        self.arms = steps.end(self.arms, elastic_force)
        # it cannot pull
        total_force = np.maximum(mean_relaxed_force + relaxing_work, 0.0)
        self.at, self.path = at, path
        elastic = (self.share * mean_relaxed_force * compression).sum(axis=1)
        return elastic, (self.share * total_force * compression).sum(axis=1) - elastic

    def compute_stored_energy(self) -> FloatArray:
        """Return the energy stored in the arms, J, shape (doors,)."""
        factor = np.where(self.path > 0, self.section.factor(self.at), 1.0)
        arm_energy = (self.arms**2 / (2 * self.k)).sum(axis=-1)
        return np.asarray((self.share * arm_energy / np.where(factor > 0, factor, 1.0)).sum(axis=1))


class Chambers:
    """Chambers of one kind of air in every door, initially at rest.

    Parameters
    ----------
    name : str
    kind : Air
    lever, length : array, shape (stations,)
        m.
    closed_compression : array, shape (doors, stations)
        Compression with the door closed, m.
    angle : float
    """

    def __init__(
        self,
        name: str,
        kind: Air,
        *,
        lever: FloatArray,
        length: FloatArray,
        closed_compression: FloatArray,
        angle: float,
    ) -> None:
        self.name, self.kind = name, kind
        self.lever, self.length, self.closed = lever, length, closed_compression
        self.volume, self.opening = self._compute_chamber_geometry(angle)
        self.density = np.full(self.volume.shape, air_flow.AIR_DENSITY)

    def _compute_chamber_geometry(self, angle: float) -> tuple[FloatArray, FloatArray]:
        residual = self.closed - self.lever * angle
        ajar = DoorPosition(
            angle, np.maximum(residual, 0.0), np.maximum(-residual, 0.0), self.length, self.lever
        )
        return self.kind.chambers(ajar)

    def step(self, angle: float, seconds: FloatArray) -> FloatArray:
        """Close on to an angle: work done on the air, J, shape (doors,)."""
        volume, opening = self._compute_chamber_geometry(angle)
        jet = 0.5 * self.kind.discharge * (opening + self.opening)
        previous_pressure = self.pressure
        self.density = air_flow.compute_next_density(
            self.density, (self.volume, volume), jet, seconds[:, None], self.kind.exponent
        )
        mean = 0.5 * (previous_pressure + self.pressure) - air_flow.AMBIENT_PRESSURE
        work = (mean * (self.volume - volume)).sum(axis=1)
        self.volume, self.opening = volume, opening
        return np.asarray(work)

    @property
    def pressure(self) -> FloatArray:
        """Pa, shape (doors, chambers)."""
        return air_flow.compute_pressure(self.density, self.kind.exponent)

    @property
    def gauge(self) -> FloatArray:
        """The highest over the ambient's, Pa, shape (doors,)."""
        return np.asarray(self.pressure.max(axis=1) - air_flow.AMBIENT_PRESSURE)

    def compute_stored_energy(self) -> FloatArray:
        """Return the stored energy of the air, J, shape (doors,)."""
        row = air_flow.compute_stored_energy(self.density, self.volume, self.kind.exponent)
        return np.asarray(row.sum(axis=1))
