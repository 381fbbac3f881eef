"""Closing analysis of a door: outcome, minimum speed, and their scatter."""

from __future__ import annotations

from typing import Any

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray, IndexArray
from dashpot.base.errors import DataError
from dashpot.base.reported_values import NORMAL
from dashpot.base.serialisation import Key, Serialisable
from dashpot.base.units import GRAVITY, Quantity, convert_to_si
from dashpot.datamodel.fit import Fit
from dashpot.extensions.systems.door.closing import (
    ELASTIC,
    STEPS,
    ClosingDoor,
    ClosingHistory,
    simulate_closing,
)
from dashpot.extensions.systems.door.closing_setup import ClosingSetup, Tolerances
from dashpot.extensions.systems.door.door_model import Door, RigidPart
from dashpot.extensions.systems.door.seal_line import SealLine
from dashpot.solids.maxwell import GeneralizedMaxwell

FASTEST = 20.0
"""m/s: a door that needs more does not close."""
_SIGNIFICANT = 1e-5
_COARSE_STEPS, _COARSE_STATIONS, _COARSE_TOLERANCE = 60, 24, 1e-3
"""Steps, stations and tolerance of the many doors of a scatter."""
_ZERO_SPEED = 1e-9
"""Share of the energy at 1 m/s with which a door closes by itself."""
_TRIES = 60
_SPEED_FACTORS = (1.02, 1.1, 1.25, 1.5, 2.0, 3.0)


@dataclass(frozen=True)
class Share(Serialisable):
    """Energy that one term took from the motion.

    Attributes
    ----------
    name : str
    work : float
        J; negative if it helped.
    stored : float
        The part of the work that it would give back, J; nan of a door that stopped.
    peak_moment : float
        The largest against closing, N m.
    """

    _keys = (
        "name",
        "work",
        Key("stored", nonfinite_as_null=True),
        Key("lost", "dissipated_energy", nonfinite_as_null=True),
        "peak_moment",
    )

    name: str
    work: float
    stored: float
    peak_moment: float

    @property
    def dissipated_energy(self) -> float:
        """Dissipated energy, J."""
        return self.work - self.stored


@dataclass(frozen=True)
class Scatter(Serialisable):
    """Closing of doors drawn within their tolerances.

    Attributes
    ----------
    variation : Tolerances
    least_speed : array, shape (doors,)
        The least that closes each, m/s; inf where none does.
    least_compression : array, shape (doors,)
        Least compression along the line once closed, m; below 0 it leaks.
    least_contact_force : array, shape (doors,)
        Least relaxed force of contact along the line, N/m.
    """

    _keys = (
        Key("variation", flatten=True),
        Key("least_speed", nonfinite_as_null=True),
        Key("least_speed_95", nonfinite_as_null=True),
        Key("above_limit", "share_above_limit"),
        "share_leaking",
        "least_compression",
        "least_contact_force",
    )

    variation: Tolerances
    least_speed: FloatArray
    least_compression: FloatArray
    least_contact_force: FloatArray

    def quantile(self, part: float) -> float:
        """Return the speed that closes a fraction of the doors, m/s."""
        return float(np.quantile(self.least_speed, part, method="higher"))

    @property
    def least_speed_95(self) -> float:
        """The speed that closes 95 % of the doors, m/s."""
        return self.quantile(0.95)

    @property
    def share_above_limit(self) -> float | None:
        """Share of the doors that need more than the limit; None without one."""
        limit = self.variation.limit
        return None if limit is None else float((self.least_speed > limit).mean())

    @property
    def share_leaking(self) -> float:
        """Share of the doors whose seal does not touch all along."""
        return float((self.least_compression < 0).mean())


@dataclass(frozen=True)
class SealDoubt:
    """Uncertainty of the seal's response within milliseconds.

    Attributes
    ----------
    relative : float
        Half width of the 95 % interval of its instantaneous stiffness, of that stiffness.
    delay : float
        By how much the force may lead the displacement for arms faster than the ramp of its test,
        s: so long, times the stiffness, is the dashpot that they may hide as. inf where the test
        does not limit it.
    highest : float
        Upper end of its valid band, Hz.
    """

    relative: float = 0.0
    delay: float = 0.0
    highest: float = 0.0

    @classmethod
    def from_fit(cls, fit: Fit) -> SealDoubt:
        """Return the uncertainty of a fit: its covariance, and arms that look like a delay.

        A fast arm and clocks that differ are one column of the fit: the lead that was found may be
        all of the arms', and more by as much as the clocks may hide. A fit of the hold alone, a
        nonlinear ramp and a sweep limit neither.
        """
        names = fit.estimate.parameters
        is_stiffness = np.array([name.startswith("k_") for name in names], dtype=float)
        variance = float(is_stiffness @ fit.covariance @ is_stiffness)
        k_0 = fit.model.k_0
        law = fit.elastic_law
        is_linear = law is not None and law.kind == "linear"
        delay_limits = [
            max(
                NORMAL * float(np.hypot(nuisance.standard_error, nuisance.prior_sd))
                - nuisance.value,
                0.0,
            )
            for nuisance in fit.estimate.nuisance
            if is_linear and nuisance.name.startswith("delay") and nuisance.prior_sd is not None
        ]
        return cls(
            NORMAL * float(np.sqrt(max(variance, 0.0))) / k_0 if k_0 > 0 else 0.0,
            # every test is of the same arms
            min((lead for lead in delay_limits if np.isfinite(lead)), default=float("inf")),
            fit.band[1],
        )

    def extremes(
        self, solid: GeneralizedMaxwell, frequency: float
    ) -> tuple[FloatArray, FloatArray]:
        """Return the softest and the hardest seal that is left open at a frequency, Hz.

        Factors of its force, and dashpots beside it before those, N s/m per m: inf where nothing
        limits it.
        """
        load = np.array([max(1 - self.relative, 1e-6), 1 + self.relative])
        hidden_delay = self.delay if frequency > self.highest else 0.0
        return load, np.array([0.0, hidden_delay * solid.k_0 / load[1]])


@dataclass(frozen=True)
class ClosingAnalysis:
    """Closing of a door.

    Attributes
    ----------
    door : ClosingDoor
    speed : float
        Initial speed at the edge, m/s.
    march : ClosingHistory
        Every step of it.
    terms : tuple of Share
    minimum : float
        The least speed that closes it, m/s; 0 where it closes by itself, inf where none does.
    interval : (float, float) or None
        Between which limits the uncertainty of the seal leaves that; None where it is not known.
    monotone : bool
        Whether every faster computed door closes as well.
    scatter : Scatter or None
    """

    door: ClosingDoor
    speed: float
    march: ClosingHistory
    terms: tuple[Share, ...]
    minimum: float
    interval: tuple[float, float] | None
    monotone: bool
    scatter: Scatter | None

    @property
    def is_latched(self) -> bool:
        """Whether it closed."""
        return bool(self.march.is_latched[0])

    @property
    def energy(self) -> float:
        """Initial kinetic energy, J."""
        return float(self.march.kinetic[0, 0])

    @property
    def remaining_energy(self) -> float:
        """Energy that remains at the latch for bumpers and striker, J; 0 if it does not latch."""
        return float(np.nan_to_num(self.march.kinetic[-1, 0]))

    @property
    def stopped_gap(self) -> float | None:
        """Distance of the edge from closed where the door stops, m; None if it closes."""
        if self.is_latched:
            return None
        last_step = int(np.flatnonzero(np.isfinite(self.march.kinetic[:, 0]))[-1])
        return self.door.edge * float(self.march.angle[last_step])

    @property
    def rebound(self) -> float:
        """Rebound speed of the edge, m/s."""
        return self.door.edge * float(np.sqrt(2 * self.march.returned / self.door.inertia))

    @property
    def seconds(self) -> float:
        """Time from the start to closed, or to the stop, s."""
        return float(self.march.time[-1, 0])

    @property
    def sealing(self) -> float:
        """Seconds in which the last nine tenths of the relaxed force's work are done."""
        work = np.cumsum(self.march.work[ELASTIC][:, 0])
        start_index = int(np.searchsorted(work, 0.1 * work[-1]))
        return self.seconds - float(self.march.time[start_index, 0])

    @property
    def frequency(self) -> float:
        """Frequency of which that time is a quarter of a period, Hz."""
        return 1 / (4 * self.sealing) if self.sealing > 0 else float("inf")

    def share(self, name: str) -> Share:
        """Return the term of that name, of no work if it is not there."""
        return next((term for term in self.terms if term.name == name), Share(name, 0.0, 0.0, 0.0))


def close_door(
    door: Door | ClosingDoor,
    line: SealLine | None = None,
    speed: Quantity = 1.0,
    *,
    seal_uncertainty: SealDoubt | None = None,
    steps: int = STEPS,
) -> ClosingAnalysis:
    r"""Close a door against its seal.

    Parameters
    ----------
    door : Door or ClosingDoor
        One as its file describes it, with `closing`, or the motion itself.
    line : SealLine, optional
        With its section and compression; by default the door's own.
    speed : str or float
        Initial speed at the edge, m/s.
    seal_uncertainty : SealDoubt, optional
        Uncertainty of the seal.
    steps : int
        Steps of the angle over which the seal is pressed.

    Raises
    ------
    DataError
        If the door lacks values for closing, or the speed is not > 0.
    """
    v = convert_to_si(speed, "velocity")
    if not 0 < v <= FASTEST:
        raise DataError(
            f"a closing speed of {v:g} m/s; expected > 0 and at most {FASTEST:g} m/s, such as 1m/s"
        )
    closing_door = door if isinstance(door, ClosingDoor) else make_closing_door(door, line)
    closing_march = simulate_closing(closing_door, np.array([v]), steps=steps)
    closing = ClosingAnalysis(
        closing_door,
        v,
        closing_march,
        tuple(_list_energy_shares(closing_march)),
        np.inf,
        None,
        True,
        None,
    )
    load, hidden = np.ones(1), np.zeros(1)
    if seal_uncertainty is not None:
        extremes = seal_uncertainty.extremes(closing_door.section.solid.maxwell, closing.frequency)
        load, hidden = (
            np.append(values, two) for values, two in zip((load, hidden), extremes, strict=True)
        )
    min_speed, limited = np.full(len(load), np.inf), np.isfinite(hidden)
    min_speed[limited] = find_least_speed(
        closing_door, load=load[limited], dashpot=hidden[limited], steps=steps
    )
    minimum, variation = float(min_speed[0]), closing_door.setup.variation
    return replace(
        closing,
        minimum=minimum,
        interval=None if seal_uncertainty is None else (float(min_speed[1]), float(min_speed[2])),
        monotone=_check_faster_doors(closing_door, minimum),
        scatter=None if variation is None else simulate_scatter(closing_door, variation, minimum),
    )


def _list_energy_shares(history: ClosingHistory) -> list[Share]:
    turned_angle = -np.diff(history.angle)
    return [
        Share(
            name,
            float(work[:, 0].sum()),
            float(history.stored[name][0]),
            float((work[:, 0] / turned_angle).max()),
        )
        for name, work in history.work.items()
    ]


def _check_faster_doors(door: ClosingDoor, minimum: float) -> bool:
    if not np.isfinite(minimum):
        return True
    faster_speeds = max(minimum, 1e-2) * np.array(_SPEED_FACTORS)
    return bool(simulate_closing(door, faster_speeds, steps=_COARSE_STEPS).is_latched.all())


def find_least_speed(
    door: ClosingDoor,
    *,
    compression: FloatArray | None = None,
    load: FloatArray | None = None,
    dashpot: FloatArray | None = None,
    steps: int = STEPS,
    tolerance: float = _SIGNIFICANT,
) -> FloatArray:
    """Return the least speed of the edge that closes each of some doors, m/s.

    From a door that closes, the least kinetic energy that it kept on the way is taken off, by as
    much more as slower doors were found to meet less; where that was too much, the middle of what
    closes and what does not is next.

    Parameters
    ----------
    door : ClosingDoor
    compression : array, shape (doors, stations), optional
        With the door closed, m.
    load : array, shape (doors,), optional
        Factor of the seal's force.
    dashpot : array, shape (doors,), optional
        Beside the seal before that factor, N s/m per m.
    steps : int
    tolerance : float
        Tolerance of the speed, relative.
    """
    row = load if compression is None else compression
    doors = 1 if row is None else len(row)
    entries: dict[str, Any] = {"compression": compression, "load": load, "dashpot": dashpot}
    half_mass = 0.5 * door.inertia / door.edge**2

    def spare(energy: FloatArray) -> FloatArray:
        speed = np.sqrt(np.maximum(energy, _ZERO_SPEED * half_mass) / half_mass)
        return simulate_closing(door, speed, steps=steps, **entries).least_kinetic_energy

    high, low = np.full(doors, half_mass), np.zeros(doors)
    energy_left = spare(high)
    while np.isnan(energy_left).any() and high.max() < half_mass * FASTEST**2:
        is_stopped = np.isnan(energy_left)
        low, high = np.where(is_stopped, high, low), np.where(is_stopped, 4 * high, high)
        energy_left = spare(high)
    never_closes, slope = np.isnan(energy_left), np.ones(doors)
    for _ in range(_TRIES):
        is_converged = (high - low <= 2 * tolerance * high) | (
            slope * energy_left <= tolerance * high
        )
        open_ = ~never_closes & ~is_converged
        if not open_.any():
            break
        guess = high - energy_left * slope
        guess = np.where((guess > low) | (low == 0), np.maximum(guess, 0.0), 0.5 * (low + high))
        values = spare(np.where(open_, guess, high))
        closes = open_ & ~np.isnan(values)
        low = np.where(open_ & ~closes, guess, low)
        # what is spared falls faster than the energy where the air takes a part that grows with it
        energy_fall = np.where(closes, energy_left - values, np.nan)
        steeper = np.where(
            energy_fall > 0, (high - guess) / np.where(energy_fall > 0, energy_fall, 1.0), slope
        )
        slope = np.where(closes, np.clip(steeper, 1.0, 50.0), slope)
        high, energy_left = np.where(closes, guess, high), np.where(closes, values, energy_left)
    return np.where(never_closes, np.inf, np.sqrt(high / half_mass))


def _reduce_stations(door: ClosingDoor) -> tuple[ClosingDoor, IndexArray]:
    """Return the same door with few stations, and which of them each of its own belongs to."""
    n = len(door.lever)
    group = np.arange(n) * min(n, _COARSE_STATIONS) // n
    length = np.asarray(np.bincount(group, door.length), dtype=float)

    def mean(values: FloatArray) -> FloatArray:
        return np.asarray(np.bincount(group, values * door.length) / np.maximum(length, 1e-12))

    reduced_door = replace(
        door, lever=mean(door.lever), compression=mean(door.compression), length=length
    )
    return reduced_door, group


def simulate_scatter(door: ClosingDoor, variation: Tolerances, minimum: float) -> Scatter:
    """Draw doors within their tolerances, and find the least speed that closes each.

    The gap moves as one, or by a normal process along the line whose correlation falls to 1/e over
    the length stated; the seal's force differs as a whole. Both are cut at their tolerance, three
    standard deviations.
    """
    random = np.random.default_rng(variation.seed)
    n, count = len(door.lever), variation.count
    if variation.correlation is None:
        shape = np.ones((n, 1))
    else:
        middles = np.cumsum(door.length) - 0.5 * door.length
        magnitude = np.abs(middles[:, None] - middles)
        magnitude = np.minimum(magnitude, door.length.sum() - magnitude)
        value, vector = np.linalg.eigh(np.exp(-magnitude / variation.correlation))
        shape = vector * np.sqrt(np.maximum(value, 0.0))
    normal_draws = random.standard_normal((count, shape.shape[1])) @ shape.T
    displacement = variation.gap * np.clip(normal_draws / 3, -1, 1)
    load = 1 + variation.load * np.clip(random.standard_normal(count) / 3, -1, 1)
    compressions = door.compression + displacement
    reduced_door, group = _reduce_stations(door)
    ratio = door.length / reduced_door.length[group]
    groups = np.zeros((n, len(reduced_door.lever)))
    groups[np.arange(n), group] = ratio
    coarse_speeds = find_least_speed(
        reduced_door,
        compression=compressions @ groups,
        load=load,
        steps=_COARSE_STEPS,
        tolerance=_COARSE_TOLERANCE,
    )
    nominal = find_least_speed(reduced_door, steps=_COARSE_STEPS, tolerance=_COARSE_TOLERANCE)[0]
    # few stations and steps miss alike in every door what the nominal one shows of it
    scale = minimum / nominal if 0 < nominal < np.inf and np.isfinite(minimum) else 1.0
    speed = scale * coarse_speeds
    force = load[:, None] * door.section.force(compressions)
    return Scatter(variation, speed, compressions.min(axis=1), force.min(axis=1))


def make_closing_door(door: Door, line: SealLine | None = None) -> ClosingDoor:
    """Return the motion of a door about its hinges.

    Raises
    ------
    DataError
        If the hinge axis, the inertia, the seal or its compression is not known.
    """
    line, setup = line or door.line, door.closing
    if line is None or line.section is None or line.compression is None:
        raise DataError(
            "closing needs a seal line with its fit and how far it is pressed when closed: "
            "compression, or gap and height"
        )
    if not door.hinges:
        raise DataError("closing needs the hinges of the door; none is there")
    stations = line.stations(min(door.pitch, line.length))
    hinge = np.array(door.hinges[0].at)
    axis = _get_hinge_axis(door, setup)
    lever = -(np.cross(axis, stations.place - hinge) * stations.normal).sum(axis=1)
    if (lever * stations.length).sum() < 0:
        axis, lever = -axis, -lever
    width = setup.edge if setup.edge is not None else door.width
    if width is None:
        raise DataError("closing needs edge, the distance from the hinges at which speed is meant")
    inertia, weight = _compute_hinge_inertia(door.rigid, setup, hinge, axis)
    return ClosingDoor(
        inertia,
        width,
        lever,
        np.array(stations.compression),
        stations.length * stations.factor,
        line.section,
        weight,
        setup,
    )


def _compute_hinge_inertia(
    rigid: RigidPart | None, setup: ClosingSetup, hinge: FloatArray, axis: FloatArray
) -> tuple[float, tuple[float, float]]:
    """Inertia about the hinges, kg m^2, and the moments of gravity as in :class:`ClosingDoor`."""
    if rigid is None:
        if setup.gravity is not None:
            raise DataError("gravity needs mass and centre of the door in [door]")
        if setup.inertia is None:
            raise DataError("closing needs inertia about the hinges, or mass and centre in [door]")
        return setup.inertia, (0.0, 0.0)
    centre_offset = np.array(rigid.centre) - hinge
    centre_offset = centre_offset - (centre_offset @ axis) * axis
    tensor = np.array(rigid.inertia)
    tensor = np.diag(tensor) if tensor.ndim == 1 else tensor
    inertia = setup.inertia
    if inertia is None:
        inertia = float(axis @ tensor @ axis + rigid.mass * centre_offset @ centre_offset)
    if setup.gravity is None:
        return inertia, (0.0, 0.0)
    weight_vector = rigid.mass * GRAVITY * np.array(setup.gravity) / np.linalg.norm(setup.gravity)
    turning = float(axis @ np.cross(centre_offset, weight_vector))
    return inertia, (turning, float(axis @ np.cross(np.cross(axis, centre_offset), weight_vector)))


def _get_hinge_axis(door: Door, setup: ClosingSetup) -> FloatArray:
    if setup.axis is not None:
        axis_vector = np.array(setup.axis, dtype=float)
    elif len(door.hinges) >= 2:
        axis_vector = np.array(door.hinges[-1].at) - np.array(door.hinges[0].at)
    else:
        raise DataError("one hinge has no axis: give axis in [closing], such as [0, 1, 0]")
    magnitude = float(np.linalg.norm(axis_vector))
    if not magnitude > 0:
        raise DataError("the hinges lie at one place: give axis in [closing], such as [0, 1, 0]")
    return np.asarray(axis_vector / magnitude)
