"""Simulated hammer test: a block on two seals, a soft tip, two accelerometers."""

from __future__ import annotations

from math import pi
from typing import ClassVar

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import ComplexArray, FloatArray, sample_count
from dashpot.base.errors import DataError
from dashpot.base.units import Quantity, convert_to_si
from dashpot.base.value_ranges import require_positive
from dashpot.datamodel.vibration_tests import ImpactTest
from dashpot.simulation.rig_errors import Climate, round_to_quantum
from dashpot.solids.maxwell import GeneralizedMaxwell, arm_response

_OVERSAMPLING = 4


@dataclass(frozen=True)
class HalfSine:
    """Half-sine pulse: start, s; duration, s; peak, N (or N m about the centre)."""

    start: float
    duration: float
    peak: float

    def force(self, time: FloatArray) -> FloatArray:
        """Return the force at `time`."""
        in_pulse = (time >= self.start) & (time <= self.start + self.duration)
        phase = np.pi * (time - self.start) / self.duration
        return np.asarray(np.where(in_pulse, self.peak * np.sin(phase), 0.0))


@dataclass(frozen=True)
class Oscillator:
    r"""Oscillator of one degree of freedom on a solid, in modal form.

    .. math::

        m\ddot y + k_\infty y + \sum_j k_j q_j + b\dot y = F, \qquad
        \dot q_j = \dot y - q_j / \tau_j, \qquad
        \ddot y = \frac{F}{m} + \sum_i r_i z_i, \quad \dot z_i = \lambda_i z_i + F

    Attributes
    ----------
    inertia : float
        kg (kg m^2 for rocking).
    poles, residues : array, shape (modes,)
        lambda, 1/s, and r.
    """

    inertia: float
    poles: ComplexArray
    residues: ComplexArray

    @classmethod
    def from_solid(cls, solid: GeneralizedMaxwell, inertia: float) -> Oscillator:
        """Return a mass (or a moment of inertia) on a solid (or a rotary one).

        Raises
        ------
        DataError
            If the solid has no stiffness at rest, or two poles coincide.
        """
        if solid.k_inf <= 0:
            raise DataError(
                "k_inf = 0: the test mass has no static equilibrium; the simulation needs a model "
                "with k_inf > 0"
            )
        k, tau = np.array(solid.k), np.array(solid.tau)
        size = 2 + len(k)
        matrix = np.zeros((size, size))
        matrix[0, 1] = 1.0
        matrix[1] = -np.concatenate(([solid.k_inf, solid.b], k)) / inertia
        matrix[2:, 1] = 1.0
        matrix[2:, 2:] = -np.diag(1 / tau)
        poles, vectors = np.linalg.eig(matrix)
        if np.linalg.cond(vectors / np.linalg.norm(vectors, axis=0)) > 1e10:
            raise DataError("two poles of the mass on its seals coincide; change the mass a little")
        unit_force = np.zeros(size)
        unit_force[1] = 1 / inertia
        return cls(inertia, poles, (matrix[1] @ vectors) * np.linalg.solve(vectors, unit_force))

    def acceleration(
        self,
        time: FloatArray,
        pulses: tuple[HalfSine, ...],
        start: ComplexArray | None = None,
    ) -> tuple[FloatArray, ComplexArray]:
        r"""Acceleration at `time`, and the modal state at its end.

        A half-sine of duration T, with :math:`\Omega = \pi/T` and s since its start, moves a
        mode to

        .. math:: z = P\,\frac{\Omega e^{\lambda s} - \Omega\cos\Omega s - \lambda\sin\Omega s}
            {\lambda^2 + \Omega^2}, \quad s \le T; \qquad z(T)\,e^{\lambda(s - T)}, \quad s > T

        Parameters
        ----------
        time : array, shape (n,)
            Evenly spaced, s.
        pulses : tuple of HalfSine
        start : array, shape (modes,), optional
            Modal state at ``time[0]``; at rest if not given.
        """
        total = sum((pulse.force(time) for pulse in pulses), np.zeros(len(time))) / self.inertia
        state = np.zeros(len(self.poles), dtype=complex)
        for i, (pole, residue) in enumerate(zip(self.poles, self.residues, strict=True)):
            if pole.imag < 0:  # its mode is the conjugate of the one before
                state[i] = state[i - 1].conjugate()
                continue
            is_oscillatory = pole.imag > 0
            p, r = (pole, 2 * residue) if is_oscillatory else (pole.real, residue.real)
            free = np.exp(p * (time - time[0]))
            start_value = 0.0 if start is None else start[i] if is_oscillatory else start[i].real
            z = start_value * free
            for pulse in pulses:
                z += _compute_mode_response(pulse, p, time, free)
            state[i] = z[-1]
            total += (r * z).real
        return total, state


def _compute_mode_response(
    pulse: HalfSine, pole: complex, time: FloatArray, free: FloatArray | ComplexArray
) -> FloatArray | ComplexArray:
    """Return the response of one mode to a pulse; `free` is its decay since ``time[0]``."""
    omega = np.pi / pulse.duration
    stop = pulse.start + pulse.duration
    in_pulse = slice(*np.searchsorted(time, [pulse.start, stop]))
    s = time[in_pulse] - pulse.start
    scale = pulse.peak / (pole**2 + omega**2)
    z = np.zeros_like(free)
    z[in_pulse] = scale * (
        omega * np.exp(pole * s) - omega * np.cos(omega * s) - pole * np.sin(omega * s)
    )
    end_value = scale * omega * (np.exp(pole * pulse.duration) + 1)
    time_after = slice(in_pulse.stop, None)
    if len(time[time_after]):
        # the decay after the pulse is the common decay, shifted in time
        first = time[time_after][0]
        z[time_after] = (
            end_value * np.exp(pole * (first - stop)) * free[: len(time) - in_pulse.stop]
        )
    return z


@dataclass(frozen=True)
class Hammer:
    """Simulated hammer and analyser.

    Attributes
    ----------
    rate : float
        Sampling rate of the record, Hz, behind an anti-alias filter common to all channels.
    record : float
        Recorded time per hit, s; by default 7 time constants of the seal of the paper.
    pretrigger : float
        Recorded time before each hit, s.
    continuous : bool
        Whether all hits are in one record, in which the block may still ring at the next hit; else
        each hit has a record that begins at rest.
    peak, duration : (float, float)
        Range of the peak force, N, and of the length of the half-sine, s.
    eccentricity : float
        Standard deviation of the point of impact from the middle of the block, m.
    double_hits : tuple of int
        Indices of double hits: a second pulse of 40 % follows after 60 ms.
    length, arm : float
        Length of the block, m, and distance of each seal from its middle, m.
    accelerometer : float
        Distance of each of the two accelerometers from the middle, m.
    gain_mismatch : float
        Relative difference of their sensitivities.
    force_noise, acceleration_noise : float
        Standard deviation, N and m/s^2.
    force_offset, acceleration_offset : float
        Constant offset of the channels, N and m/s^2.
    force_range, acceleration_range : float
        Full scale, N and m/s^2.
    bits : int
        Bits of the converter; 0 without quantisation.
    highpass : float
        Corner of the first-order high pass in the accelerometers' supply, Hz; 0 for none.
    """

    rate: float = 2048.0
    record: float = 20.0
    pretrigger: float = 0.1
    continuous: bool = False
    peak: tuple[float, float] = (2.0, 5.0)
    duration: tuple[float, float] = (10e-3, 20e-3)
    eccentricity: float = 3e-3
    double_hits: tuple[int, ...] = ()
    length: float = 0.12
    arm: float = 0.045
    accelerometer: float = 0.05
    gain_mismatch: float = 0.02
    force_noise: float = 5e-3
    acceleration_noise: float = 0.02
    force_offset: float = 0.02
    acceleration_offset: float = 0.05
    force_range: float = 20.0
    acceleration_range: float = 200.0
    bits: int = 16
    highpass: float = 0.0

    def __post_init__(self) -> None:
        if not (self.rate > 0 and self.pretrigger >= 0):
            raise DataError(
                f"rate = {self.rate!r} Hz, pretrigger = {self.pretrigger!r} s; expected a rate > 0 "
                "and a pretrigger >= 0"
            )
        if not self.record > self.pretrigger + 0.1:
            raise DataError(
                f"record = {self.record!r} s; expected more than the pretrigger, "
                f"{self.pretrigger:g} s, and 0.1 s for the hit"
            )
        if not 0 < self.duration[0] <= self.duration[1]:
            raise DataError(f"duration = {self.duration!r} s; expected a range above 0")
        if self.duration[0] * self.rate < 4:
            raise DataError(
                f"a pulse of {self.duration[0]:g} s has fewer than 4 samples at {self.rate:g} Hz; "
                f"expected a rate of at least {4 / self.duration[0]:g} Hz"
            )

    def noise_free(self) -> Hammer:
        """Return the same hits, centred, with ideal channels."""
        return replace(
            self,
            eccentricity=0.0, gain_mismatch=0.0, force_noise=0.0, acceleration_noise=0.0,
            force_offset=0.0, acceleration_offset=0.0, bits=0, highpass=0.0,
        )  # fmt: skip


@dataclass(frozen=True)
class ImpactTruth:
    """Truth of a simulated hammer test.

    Attributes
    ----------
    model : GeneralizedMaxwell
        One seal at the temperature of the test.
    mass : float
        Block, kg.
    seals : float
    hammer : Hammer
    seed : int
    hits : tuple of HalfSine
        Each first pulse: start within its record, s; duration, s; peak, N.
    eccentricities : tuple of float
        Distance of each hit from the middle, m.
    gains : (float, float)
        Gains of the two accelerometers, relative to their stated sensitivity.
    bounce_poles, rocking_poles : tuple of complex
        Poles of bounce and rocking, 1/s.
    climate : Climate or None
        Temperature and shift law from which `model` follows; None if no temperature was stated.
    """

    kind: ClassVar[str] = "impact"

    model: GeneralizedMaxwell
    mass: float
    seals: float
    hammer: Hammer
    seed: int
    hits: tuple[HalfSine, ...]
    eccentricities: tuple[float, ...]
    gains: tuple[float, float]
    bounce_poles: tuple[complex, ...]
    rocking_poles: tuple[complex, ...]
    climate: Climate | None = None


@dataclass(frozen=True)
class SimulatedImpact:
    """Simulated hammer test and its truth."""

    test: ImpactTest
    truth: ImpactTruth


def simulate_impact(
    model: GeneralizedMaxwell,
    *,
    mass: Quantity,
    seals: float = 2,
    hits: int = 5,
    rig: Hammer | None = None,
    seed: int = 0,
    climate: Climate | None = None,
) -> SimulatedImpact:
    r"""Return a block on `seals` equal seals, struck `hits` times.

    The block bounces, :math:`m\ddot y + n\,k * y = F`, and rocks,
    :math:`I\ddot\theta + n b^2\,k * \theta = F e` with :math:`I = m L^2 / 12`; the
    accelerometers see :math:`\ddot y \pm p\,\ddot\theta`. Both motions are integrated exactly;
    force and accelerations then pass one common anti-alias filter.

    Parameters
    ----------
    model : GeneralizedMaxwell
        One seal; with a `climate`, at the reference of its law.
    mass : float
        Block, kg.
    rig : Hammer, optional
        ``Hammer()`` if not given.
    climate : Climate, optional
        Shifts the seal to its temperature.

    Raises
    ------
    DataError
        If the mass, the seals or the hits are not positive, or the seal has no k_inf.
    """
    mass = convert_to_si(mass, "mass")
    rig = Hammer() if rig is None else rig
    require_positive(mass=mass, seals=seals, hits=hits)
    if climate is not None:
        model = climate.shift_seal(model)
    random = np.random.default_rng(seed)
    bounce = Oscillator.from_solid(seals * model, mass)
    rock = Oscillator.from_solid((seals * rig.arm**2) * model, mass * rig.length**2 / 12)
    pulses = tuple(_pulse(rig, random) for _ in range(hits))
    eccentricities = tuple(float(e) for e in rig.eccentricity * random.standard_normal(hits))
    signals = _motion(rig, bounce, rock, pulses, eccentricities)
    gains = (1 + rig.gain_mismatch / 2, 1 - rig.gain_mismatch / 2)
    count = sample_count(rig.record, rig.rate)
    force = _record(
        signals[0],
        rig,
        random,
        noise=rig.force_noise,
        offset=rig.force_offset,
        full_scale=rig.force_range,
    )
    acceleration = [
        _record(
            gain * signal,
            rig,
            random,
            noise=rig.acceleration_noise,
            offset=rig.acceleration_offset,
            full_scale=rig.acceleration_range,
        )
        for gain, signal in zip(gains, signals[1:], strict=True)
    ]
    clock = np.arange(hits * count) / rig.rate
    test = ImpactTest(
        time=clock if rig.continuous else np.tile(clock[:count], hits),
        force=force,
        acceleration=np.array(acceleration),
        starts=(0,) if rig.continuous else tuple(range(0, hits * count, count)),
        positions=(rig.accelerometer, -rig.accelerometer),
        units="SI",
    )
    truth = ImpactTruth(
        model=model, mass=mass, seals=seals, hammer=rig, seed=seed, hits=pulses,
        eccentricities=eccentricities, gains=gains,
        bounce_poles=tuple(complex(pole) for pole in bounce.poles),
        rocking_poles=tuple(complex(pole) for pole in rock.poles), climate=climate,
    )  # fmt: skip
    return SimulatedImpact(test=test, truth=truth)


def _pulse(rig: Hammer, random: np.random.Generator) -> HalfSine:
    # a hit does not begin at the instant of a sample
    start = rig.pretrigger + random.uniform(0, 1) / rig.rate
    return HalfSine(
        float(start), float(random.uniform(*rig.duration)), float(random.uniform(*rig.peak))
    )


def _motion(
    rig: Hammer,
    bounce: Oscillator,
    rock: Oscillator,
    pulses: tuple[HalfSine, ...],
    eccentricities: tuple[float, ...],
) -> list[FloatArray]:
    """Return force and the two accelerations at the sampling rate, hit after hit."""
    count = sample_count(rig.record, rig.rate) * _OVERSAMPLING
    # one more sample: its state is the initial state of the next hit
    time = np.arange(count + 1) / (rig.rate * _OVERSAMPLING)
    parts: list[list[FloatArray]] = [[], [], []]
    bounce_state = rocking_state = None
    for i, (pulse, offset) in enumerate(zip(pulses, eccentricities, strict=True)):
        train: tuple[HalfSine, ...] = (pulse,)
        if i in rig.double_hits:
            train += (replace(pulse, start=pulse.start + 0.06, peak=0.4 * pulse.peak),)
        moments = tuple(replace(item, peak=item.peak * offset) for item in train)
        vertical, bounce_end = bounce.acceleration(time, train, bounce_state)
        pitch, rocking_end = rock.acceleration(time, moments, rocking_state)
        if rig.continuous:
            bounce_state, rocking_state = bounce_end, rocking_end
        force = sum((item.force(time) for item in train), np.zeros(len(time)))
        pitch_acceleration = rig.accelerometer * pitch
        for part, signal in zip(
            parts,
            (force, vertical + pitch_acceleration, vertical - pitch_acceleration),
            strict=True,
        ):
            part.append(signal[:-1])
    joined_parts = [[np.concatenate(part)] if rig.continuous else part for part in parts]
    return [
        np.concatenate([_decimate(_apply_highpass(x, rig) if channel else x) for x in records])
        for channel, records in enumerate(joined_parts)
    ]


def _apply_highpass(signal: FloatArray, rig: Hammer) -> FloatArray:
    """Return a signal after a first-order high-pass filter, computed as a Maxwell arm."""
    if rig.highpass == 0:
        return signal
    time = np.arange(len(signal)) / (rig.rate * _OVERSAMPLING)
    return arm_response(time, signal, 1 / (2 * pi * rig.highpass))


def _decimate(signal: FloatArray) -> FloatArray:
    """Band-limit to 0.45 of the new rate (linear phase, no delay) and keep every fourth sample."""
    half_length = 16 * _OVERSAMPLING
    n = np.arange(-half_length, half_length + 1)
    taps = np.sinc(0.9 * n / _OVERSAMPLING) * np.kaiser(len(n), 8.0)
    return np.asarray(np.convolve(signal, taps / taps.sum(), mode="same")[::_OVERSAMPLING])


def _record(
    signal: FloatArray,
    rig: Hammer,
    random: np.random.Generator,
    *,
    noise: float,
    offset: float,
    full_scale: float,
) -> FloatArray:
    """Return a signal as recorded: with noise, offset and quantisation."""
    measured = signal + offset + noise * random.standard_normal(len(signal))
    if rig.bits == 0:
        return np.asarray(measured)
    return round_to_quantum(
        np.clip(measured, -full_scale, full_scale), 2 * full_scale / 2**rig.bits
    )
