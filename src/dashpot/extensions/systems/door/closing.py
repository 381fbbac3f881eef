r"""Closing motion of a door onto its seal.

.. math:: I\ddot\theta = -\sum_i M_i, \qquad \delta_s = (\delta_{c,s} - \ell_s\theta)_+

The angle falls from where the door has its speed to closed, in steps: over each the kinetic energy
loses the work of every term, so that energy balances by construction and the time follows as step
over mean speed, to second order. The arms of the seal answer a compression that is straight within
a step exactly, whatever their times; air leaves by :mod:`dashpot.extensions.systems.door.air_flow`.
Any number of doors are computed simultaneously.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray
from dashpot.base.errors import DataError
from dashpot.base.value_ranges import require_positive
from dashpot.datamodel.seal_line import SealSection
from dashpot.extensions.systems.door.closing_forces import Chambers, PressedSeal
from dashpot.extensions.systems.door.closing_setup import ClosingSetup

ELASTIC, VISCOUS = "seal, elastic", "seal, viscous"
HINGE, CHECK, LATCH, GRAVITY = "hinge friction", "check", "latch", "gravity"
STEPS = 200
_MAX_ANGLE = 1.2
"""rad, at which a seal near the hinges is taken as pressed from the start."""


@dataclass(frozen=True)
class ClosingDoor:
    """Door about its hinges, with the seal that it meets.

    Attributes
    ----------
    inertia : float
        I about the hinge axis, kg m^2.
    edge : float
        Distance from that axis at which speeds are meant, m: v = edge * angular speed.
    lever : array, shape (stations,)
        By how much each station's gap grows with the angle, m.
    compression : array, shape (stations,)
        With the door closed, m; below 0 where the seal does not reach.
    length : array, shape (stations,)
        Length of seal that each station represents, m, times the stiffness factor of its joints.
    section : SealSection
        One metre of it.
    weight : (float, float)
        Moments of gravity against closing, N m, by the cosine and the sine of the angle.
    setup : ClosingSetup
        All other data.
    """

    inertia: float
    edge: float
    lever: FloatArray
    compression: FloatArray
    length: FloatArray
    section: SealSection
    weight: tuple[float, float] = (0.0, 0.0)
    setup: ClosingSetup = field(default_factory=ClosingSetup)

    def __post_init__(self) -> None:
        require_positive(inertia=self.inertia, edge=self.edge, unit=" of a closing door")
        shapes = {np.shape(values) for values in (self.lever, self.compression, self.length)}
        if len(shapes) != 1 or not all(
            np.isfinite(values).all() for values in (self.lever, self.compression, self.length)
        ):
            raise DataError(
                f"levers, compressions and lengths of the seal's stations have the shapes "
                f"{sorted(shapes)}; expected one, all finite"
            )

    @property
    def latch_angle(self) -> float:
        """The angle at which the door is latched, rad: below 0 where the latch wants more."""
        latch = self.setup.latch
        return 0.0 if latch is None else -latch.overtravel / latch.lever

    @property
    def touching(self) -> float:
        """The angle at which the seal first touches, rad, 0 if it never does."""
        has_lever = self.lever > 0
        angles = self.compression[has_lever] / self.lever[has_lever]
        return float(np.clip(angles.max(initial=0.0), 0.0, _MAX_ANGLE))

    @property
    def begins(self) -> float:
        """The angle at which the door has its speed, rad."""
        if self.setup.start is not None:
            return self.setup.start
        travel = self.setup.latch.travel[-1] / self.setup.latch.lever if self.setup.latch else 0.0
        return max(self.touching, self.latch_angle + travel) or 1e-3

    def angles(self, steps: int = STEPS, touching: float | None = None) -> FloatArray:
        """Return angles from the initial one to closed, rad, densest there, shape (n + 1,)."""
        start, end = self.begins, self.latch_angle
        near_angle = min(self.touching if touching is None else touching, start) - end
        fine_angles = end + near_angle * np.linspace(1.0, 0.0, steps + 1) ** 1.5
        if near_angle >= start - end:
            return fine_angles
        coarse_angles = np.linspace(start, end + near_angle, max(steps // 4, 2) + 1)
        return (
            np.concatenate((coarse_angles[:-1], fine_angles)) if near_angle > 0 else coarse_angles
        )

    def resisting(self, angle: FloatArray) -> dict[str, FloatArray]:
        """Moments against closing that depend only on the angle, N m."""
        setup, entries = self.setup, {}
        if setup.friction:
            entries[HINGE] = np.full_like(angle, setup.friction)
        if setup.check is not None:
            entries[CHECK] = setup.check.moment_at(angle)
        if setup.latch is not None:
            entries[LATCH] = setup.latch.moment(angle - self.latch_angle)
        if any(self.weight):
            entries[GRAVITY] = self.weight[0] * np.cos(angle) + self.weight[1] * np.sin(angle)
        return entries


@dataclass(frozen=True)
class ClosingHistory:
    """History of closing doors, step by step.

    Attributes
    ----------
    angle : array, shape (n + 1,)
        rad.
    kinetic, time : array, shape (n + 1, doors)
        J, nan once a door has stopped, and s.
    work : mapping of str to array, shape (n, doors)
        Work of every term in every step, J: the energy that it removed from the motion.
    stored : mapping of str to array, shape (doors,)
        The part of the work that it would give back, J, at the end of the march; nan for
        doors that stopped.
    pressure : mapping of str to array, shape (n + 1, doors)
        Highest gauge pressure in the chambers, Pa.
    returned : float
        For the first door, if it stopped: kinetic energy of its rebound, J.
    """

    angle: FloatArray
    kinetic: FloatArray
    time: FloatArray
    work: Mapping[str, FloatArray]
    stored: Mapping[str, FloatArray]
    pressure: Mapping[str, FloatArray]
    returned: float = 0.0

    @property
    def is_latched(self) -> BoolArray:
        """Whether each door reached the end, shape (doors,)."""
        return np.asarray(np.isfinite(self.kinetic[-1]))

    @property
    def least_kinetic_energy(self) -> FloatArray:
        """The least kinetic energy on the way, J, nan for those that stopped, shape (doors,)."""
        return np.asarray(self.kinetic.min(axis=0))


@dataclass
class _Doors:
    """State of the doors during time integration."""

    door: ClosingDoor
    seal: PressedSeal
    chambers: list[Chambers]
    angle: float

    @classmethod
    def from_angle(
        cls,
        door: ClosingDoor,
        closed_compression: FloatArray,
        load: FloatArray,
        dashpot: FloatArray,
        angle: float,
    ) -> _Doors:
        """Return the doors at an angle, with their compressions and seal forces."""
        geometry: dict[str, Any] = {
            "lever": door.lever,
            "closed_compression": closed_compression,
            "angle": angle,
        }
        share = door.length * load[:, None]
        seal = PressedSeal(door.section, share=share, dashpot=dashpot, **geometry)
        air_chambers = [
            Chambers(name, chamber_air, length=door.length, **geometry)
            for name, chamber_air in door.setup.air_terms
        ]
        return cls(door, seal, air_chambers, angle)

    def copy_state(self) -> _Doors:
        """Return the same, which the next step leaves where they are."""
        return replace(
            self, seal=copy(self.seal), chambers=[copy(chamber) for chamber in self.chambers]
        )

    def compute_stored_energy(self, work: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
        """Return the recoverable work of every term in all steps, J."""
        stored_energy = {
            name: work[name].sum(axis=0) for name in (ELASTIC, GRAVITY) if name in work
        }
        stored_energy |= {
            VISCOUS: self.seal.compute_stored_energy(),
            **{chamber.name: chamber.compute_stored_energy() for chamber in self.chambers},
        }
        return {
            name: stored_energy.get(name, np.zeros(values.shape[1]))
            for name, values in work.items()
        }

    def step(self, angle: float, kinetic: FloatArray, moment: FloatArray) -> _Instants:
        """Turn to an angle, with the moment of the step before to show how long it takes."""
        end_angles = np.array([self.angle, angle])
        turned_angle = float(end_angles[0] - end_angles[1])
        seconds = _compute_step_times(
            self.door.inertia, kinetic, moment * turned_angle, turned_angle
        )
        work: dict[str, FloatArray | float] = {}
        for name, values in self.door.resisting(end_angles).items():
            path = abs(turned_angle) if name == HINGE else turned_angle
            work[name] = float(values.mean()) * path
        work[ELASTIC], work[VISCOUS] = self.seal.step(angle, seconds)
        for chamber in self.chambers:
            work[chamber.name] = chamber.step(angle, seconds)
        self.angle = angle
        return _Instants(work, sum(work.values()), seconds)  # type: ignore[arg-type]


class _Instants(NamedTuple):
    work: dict[str, FloatArray | float]
    total_work: FloatArray
    seconds: FloatArray


def simulate_closing(
    door: ClosingDoor,
    speed: FloatArray,
    *,
    compression: FloatArray | None = None,
    load: FloatArray | None = None,
    dashpot: FloatArray | None = None,
    steps: int = STEPS,
) -> ClosingHistory:
    """Simulate closing doors that differ in speed, compression and force of the seal.

    Parameters
    ----------
    door : ClosingDoor
    speed : array, shape (doors,)
        At the edge where the march begins, m/s.
    compression : array, shape (doors, stations), optional
        With the door closed, m.
    load : array, shape (doors,), optional
        Factor of the seal's force.
    dashpot : array, shape (doors,), optional
        Beside the seal before that factor, N s/m per m.
    steps : int
        Steps of the angle over which the seal is pressed.
    """
    doors = len(speed)
    compressions = np.broadcast_to(
        door.compression if compression is None else compression, (doors, len(door.lever))
    )
    angle = replace(door, compression=compressions.max(axis=0)).angles(steps)
    first = float(angle[0])
    load = np.ones(doors) if load is None else load
    dashpot = np.zeros(doors) if dashpot is None else dashpot
    state = _Doors.from_angle(door, compressions, load, dashpot, first)
    n = len(angle) - 1
    work: dict[str, FloatArray] = defaultdict(lambda: np.zeros((n, doors)))
    pressure: dict[str, FloatArray] = defaultdict(lambda: np.zeros((n + 1, doors)))
    kinetic, time = np.zeros((2, n + 1, doors))
    kinetic[0] = 0.5 * door.inertia * (np.asarray(speed) / door.edge) ** 2
    moment, returned_energy = np.zeros(doors), 0.0
    for i in range(n):
        # of one door alone it is asked with what it comes back
        previous_state = state.copy_state() if doors == 1 else state
        energy_done = state.step(float(angle[i + 1]), kinetic[i], moment)
        kinetic[i + 1] = kinetic[i] - energy_done.total_work
        is_moving = kinetic[i + 1] > 0
        kinetic[i + 1, ~is_moving] = np.nan
        for name, values in energy_done.work.items():
            work[name][i] = np.where(is_moving, values, 0.0)
        for chamber in state.chambers:
            pressure[chamber.name][i + 1] = np.where(is_moving, chamber.gauge, 0.0)
        time[i + 1] = time[i] + np.where(is_moving, energy_done.seconds, 0.0)
        moment = energy_done.total_work / float(angle[i] - angle[i + 1])
        if not is_moving.any():
            kinetic[i + 1 :] = np.nan
            time[i + 1 :] = time[i + 1]
            if doors == 1:
                returned_energy = _compute_rebound_energy(previous_state, angle[i::-1])
            break
    is_stopped = np.isnan(kinetic[-1])
    stored_energy = {
        name: np.where(is_stopped, np.nan, row)
        for name, row in state.compute_stored_energy(work).items()
    }
    return ClosingHistory(
        angle, kinetic, time, dict(work), stored_energy, dict(pressure), returned_energy
    )


def _compute_rebound_energy(state: _Doors, angle: FloatArray) -> float:
    """Return the rebound energy of a door that stopped at the first of the angles, J."""
    kinetic, moment = np.zeros(1), np.zeros(1)
    for step_angle in angle[1:].tolist():
        turned_angle = state.angle - step_angle
        if not kinetic[0]:
            # as it starts, the relaxed force and what the arms still carry show its pace
            trial = copy(state.seal).step(step_angle, np.full(1, 1e-3))
            moment = np.full(1, (trial[0][0] + trial[1][0]) / turned_angle)
        energy_done = state.step(step_angle, kinetic, moment)
        kinetic = np.maximum(kinetic - energy_done.total_work, 0.0)
        moment = energy_done.total_work / turned_angle
        if not kinetic[0]:
            break
    return float(kinetic[0])


def _compute_step_times(
    inertia: float, kinetic: FloatArray, energy: FloatArray, turned_angle: float
) -> FloatArray:
    """Return how long a step takes that takes so much energy, s."""
    energy_before = np.nan_to_num(kinetic)
    energy_after = np.maximum(energy_before - np.nan_to_num(energy), 0.0)
    mean = 0.5 * (np.sqrt(2 * energy_before / inertia) + np.sqrt(2 * energy_after / inertia))
    # a door that has stopped is counted out by its energy, and takes any time
    return np.asarray(np.where(mean > 1e-6, abs(turned_angle) / np.maximum(mean, 1e-6), 1e-3))
