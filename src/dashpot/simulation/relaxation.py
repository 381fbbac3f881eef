"""The virtual indentation rig: a seal, a robot, a load cell."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import pi, tan

import numpy as np

from dashpot.base.arrays import ByValue, FloatArray, sample_count, samples
from dashpot.base.errors import DataError
from dashpot.base.units import Quantity, si
from dashpot.records.relaxation import RelaxationTest
from dashpot.records.specimen import Specimen
from dashpot.simulation.axis import Axis
from dashpot.simulation.frames import setpoints
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.table_1 import SHIFT
from dashpot.solids.temperature import TemperatureLaw, at_temperature


@dataclass(frozen=True)
class Rig:
    r"""What stands between the seal and the file.

    The robot is sent set-points; its axis lags, rounds corners and overshoots; the seal
    answers to the *true* motion; the encoder writes that motion in counts; the load cell adds

    .. math:: F_{\mathrm{read}} = F + F_b + \dot F_d t + h \sin(2\pi f_h t + \varphi)
        + v \sin(2\pi f_v t + \psi) + e, \quad e \sim N(0, \sigma^2)

    in steps of its quantum, between its limits.

    Attributes
    ----------
    axis : Axis
    setpoint_interval : float
        s between set-points.
    rate : float
        Sampling rate of the record, Hz. Nothing is filtered: what is faster aliases.
    baseline : float
        Recorded before the robot starts, s.
    encoder : float
        Position quantum, m; 0 for none.
    gap : float
        Air between plate and seal at the start, m.
    tilt : float
        Tilt of the plate along the seal, rad: one end touches first.
    length : float
        Contact length of the seal under the plate, m.
    stiffening : float
        Cubic term of the elastic law, 1/m^2: the solid answers to x + stiffening x^3.
    bias, drift : float
        Offset, N, and its growth, N/s, of the load cell.
    noise, position_noise : float
        Standard deviation of white noise, N and m.
    hum, hum_frequency, vibration, vibration_frequency : float
        Amplitude, N, and frequency, Hz, of mains hum and of the robot's shaking.
    quantum, limit : float
        Force quantum and largest force that the load cell can read, N.
    """

    axis: Axis = field(default_factory=Axis)
    setpoint_interval: float = 10e-3
    rate: float = 1000.0
    baseline: float = 1.5
    encoder: float = 0.02e-3
    gap: float = 0.0
    tilt: float = 0.0
    length: float = 0.05
    stiffening: float = 0.0
    bias: float = 0.05
    drift: float = 0.2e-3
    noise: float = 4e-3
    position_noise: float = 0.0
    hum: float = 3e-3
    hum_frequency: float = 50.0
    vibration: float = 1e-3
    vibration_frequency: float = 37.0
    quantum: float = 1 / 1280
    limit: float = 70.0

    def __post_init__(self) -> None:
        for name in ("setpoint_interval", "rate", "length", "limit"):
            value = getattr(self, name)
            if not value > 0:
                raise DataError(f"rig {name} = {value!r}; expected a number > 0")
        for name in ("baseline", "encoder", "gap", "tilt", "noise", "position_noise", "quantum"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value >= 0):
                raise DataError(f"rig {name} = {value!r}; expected a number >= 0")

    def noise_free(self) -> Rig:
        """The same robot and plate with a perfect load cell and a perfect encoder."""
        return replace(
            self,
            encoder=0.0, bias=0.0, drift=0.0, noise=0.0, position_noise=0.0, hum=0.0,
            vibration=0.0, quantum=0.0, limit=float("inf"),
        )  # fmt: skip

    def compression(self, position: FloatArray) -> FloatArray:
        r"""Mean compression of the seal, m, with the plate at `position`.

        Along a tilted plate the gap grows by :math:`w = L\tan\theta`; the mean of
        :math:`(x - g - s)_+` over :math:`0 \le s \le w` is :math:`d^2/2w` for
        :math:`d = x - g < w` and :math:`d - w/2` beyond.
        """
        d = np.maximum(position - self.gap, 0.0)
        wedge = self.length * tan(self.tilt)
        if wedge > 0:
            d = np.where(d < wedge, d**2 / (2 * wedge), d - wedge / 2)
        return np.asarray(d + self.stiffening * d**3)

    def read(self, time: FloatArray, force: FloatArray, random: np.random.Generator) -> FloatArray:
        """What the load cell writes for a true `force`, N."""
        hum_phase, shake_phase = random.uniform(0, 2 * pi, 2)
        signal = force + self.bias + self.drift * (time - time[0])
        signal = signal + self.hum * np.sin(2 * pi * self.hum_frequency * time + hum_phase)
        signal = signal + self.vibration * np.sin(
            2 * pi * self.vibration_frequency * time + shake_phase
        )
        signal = signal + self.noise * random.standard_normal(len(time))
        return in_steps(np.clip(signal, -self.limit, self.limit), self.quantum)


@dataclass(frozen=True)
class Climate:
    r"""The temperature of a simulated test, and the law by which the seal follows it.

    The seal is thermorheologically simple, with stiffnesses in proportion to T:
    :func:`~dashpot.solids.temperature.at_temperature`.

    Attributes
    ----------
    temperature : float
        K.
    law : TemperatureLaw
        That of the demonstration seals by default.
    """

    temperature: float
    law: TemperatureLaw = SHIFT

    def felt(self, seal: GeneralizedMaxwell) -> GeneralizedMaxwell:
        """The seal of the law's reference as it is in this climate."""
        return at_temperature(seal, self.temperature, self.law)


@dataclass(frozen=True, eq=False)
class RelaxationTruth(ByValue):
    """What really happened on the virtual rig.

    Attributes
    ----------
    model : GeneralizedMaxwell
        The seal at the temperature of the test.
    depth, ramp_time, hold_time : float
        As commanded from first contact, m and s.
    onset, ramp_end : float
        The straight part of the true ramp extended to first contact and to the held depth, s
        on the clock of the record: the ideal ramp that the robot made.
    contact : float
        Plate position at first contact, m.
    rig : Rig
    seed : int
    displacement, force : array, shape (n,)
        Plate position, m, and seal force, N, at the samples of the record, before encoder
        and load cell.
    climate : Climate or None
        What made `model` of the seal at the reference; None if no temperature was stated.
    """

    model: GeneralizedMaxwell
    depth: float
    ramp_time: float
    hold_time: float
    onset: float
    ramp_end: float
    contact: float
    rig: Rig
    seed: int
    displacement: FloatArray
    force: FloatArray
    climate: Climate | None = None

    def __post_init__(self) -> None:
        for name in ("displacement", "force"):
            object.__setattr__(self, name, samples(name, getattr(self, name)))


@dataclass(frozen=True)
class SimulatedRelaxation:
    """A simulated test and its truth."""

    test: RelaxationTest
    truth: RelaxationTruth


def simulate_relaxation(
    model: GeneralizedMaxwell,
    *,
    depth: Quantity = 8e-3,
    ramp_time: Quantity = 1.0,
    hold_time: Quantity = 40.0,
    rig: Rig | None = None,
    seed: int = 0,
    climate: Climate | None = None,
) -> SimulatedRelaxation:
    """A ramp to `depth` in `ramp_time`, held for `hold_time`, on a virtual rig.

    Parameters
    ----------
    model : GeneralizedMaxwell
        One piece of seal; with a `climate`, at the reference of its law.
    depth : float
        Compression from first contact, m; the plate crosses ``rig.gap`` on its way, at the
        same speed.
    ramp_time, hold_time : float
        s.
    rig : Rig, optional
        ``Rig()`` if not given.
    seed : int
        Of the noise.
    climate : Climate, optional
        Makes the seal that of its temperature, which the record's specimen then states.

    Raises
    ------
    DataError
        If depth or a time is not positive, or the law knows nothing of the temperature.
    """
    depth, ramp_time, hold_time = si(depth, "length"), si(ramp_time, "time"), si(hold_time, "time")
    rig = Rig() if rig is None else rig
    for name, value in (("depth", depth), ("ramp_time", ramp_time), ("hold_time", hold_time)):
        if not (np.isfinite(value) and value > 0):
            raise DataError(f"{name} = {value!r}; expected a number > 0")
    if climate is not None:
        model = climate.felt(model)
    travel = rig.gap + depth
    duration = ramp_time * travel / depth
    test, position, force = simulate_path(
        model, path=((duration, travel), (duration + hold_time, travel)), rig=rig, seed=seed
    )
    if climate is not None:
        test = replace(test, specimen=replace(test.specimen, temperature=climate.temperature))
    onset, ramp_end = _ideal_ramp(test.time, position, contact=rig.gap, travel=travel)
    truth = RelaxationTruth(
        model=model, depth=depth, ramp_time=ramp_time, hold_time=hold_time, onset=onset,
        ramp_end=ramp_end, contact=rig.gap, rig=rig, seed=seed, displacement=position, force=force,
        climate=climate,
    )  # fmt: skip
    return SimulatedRelaxation(test=test, truth=truth)


def simulate_path(
    model: GeneralizedMaxwell,
    *,
    path: tuple[tuple[float, float], ...],
    rig: Rig | None = None,
    seed: int = 0,
) -> tuple[RelaxationTest, FloatArray, FloatArray]:
    """Any path of the plate: staircases, cycles, unloading.

    Parameters
    ----------
    path : tuple of (time, position)
        Corners that the plate is sent through, s after the baseline and m; it starts at (0, 0).

    Returns
    -------
    test : RelaxationTest
        The record.
    position, force : array, shape (n,)
        The truth at its samples.
    """
    rig = Rig() if rig is None else rig
    random = np.random.default_rng(seed)
    end = rig.baseline + path[-1][0]
    # the motion is laid on a grid at least as fine as the record
    fine = max(1, int(np.ceil(rig.rate / rig.axis.rate)))
    sample_count(end, max(rig.axis.rate, rig.rate))
    clock = np.arange(round(end * rig.axis.rate) + 1) / rig.axis.rate
    motion = rig.axis.follow(_staircase(clock, path, rig))
    if fine > 1:
        dense = np.arange((len(clock) - 1) * fine + 1) / (rig.axis.rate * fine)
        motion, clock = _between(dense, clock, motion), dense
    answer = model.force(clock, rig.compression(motion))
    time = np.arange(int(np.floor(end * rig.rate * (1 + 1e-12))) + 1) / rig.rate
    position, force = np.interp(time, clock, motion), np.interp(time, clock, answer)
    measured = position + rig.position_noise * random.standard_normal(len(time))
    test = RelaxationTest(
        time=time,
        displacement=in_steps(measured, rig.encoder),
        force=rig.read(time, force, random),
        specimen=Specimen(length=rig.length, notes="simulated"),
    )
    return test, position, force


def in_steps(values: FloatArray, quantum: float) -> FloatArray:
    """`values` rounded to whole quanta; a quantum of 0 leaves them alone."""
    return np.asarray(np.round(values / quantum) * quantum) if quantum > 0 else values


def _staircase(clock: FloatArray, path: tuple[tuple[float, float], ...], rig: Rig) -> FloatArray:
    """The set-point in force at every control instant."""
    points, last, begun = [np.zeros(1)], 0.0, 0.0
    for at, position in path:
        leg = setpoints(last, position, duration=at - begun, interval=rig.setpoint_interval)
        points.append(leg[1:])
        last, begun = position, at
    # a set-point is sent at the start of its interval: the staircase leads the straight line
    sent = np.concatenate(points)
    count = np.floor((clock - rig.baseline) / rig.setpoint_interval + 1e-9).astype(int) + 1
    return np.asarray(sent[np.clip(count, 0, len(sent) - 1)])


def _between(dense: FloatArray, clock: FloatArray, motion: FloatArray) -> FloatArray:
    """Smooth motion between control instants."""
    from scipy.interpolate import CubicSpline

    return np.asarray(CubicSpline(clock, motion)(dense))


def _ideal_ramp(
    time: FloatArray, position: FloatArray, *, contact: float, travel: float
) -> tuple[float, float]:
    middle = (position > 0.3 * travel) & (position < 0.7 * travel) & (np.arange(len(time)) > 0)
    middle &= np.arange(len(time)) <= int(np.argmax(position >= 0.7 * travel))
    if np.count_nonzero(middle) < 2:
        crossing = np.interp([contact, travel * (1 - 1e-6)], np.maximum.accumulate(position), time)
        return float(crossing[0]), float(crossing[1])
    speed, offset = np.polyfit(time[middle] - time[0], position[middle], 1)
    return (
        float(time[0] + (contact - offset) / speed),
        float(time[0] + (travel - offset) / speed),
    )
