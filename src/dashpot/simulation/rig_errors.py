"""Virtual rig: load cell, displacement, noise and climate of a simulated test."""

from __future__ import annotations

from math import pi, tan
from typing import ClassVar

import numpy as np

from dashpot.base import dataclass, field, replace
from dashpot.base.arrays import EqualByValue, FloatArray, validate_samples
from dashpot.base.errors import DataError
from dashpot.base.value_ranges import require_nonnegative, select_fields
from dashpot.datamodel.specimen import Specimen
from dashpot.simulation.robot import Axis
from dashpot.solids.demo_seals import SHIFT
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.shift_laws import TemperatureLaw, shift_to_temperature


@dataclass(frozen=True)
class Rig:
    r"""Virtual rig: the errors of a simulated test.

    The robot is sent set-points; its axis lags, rounds corners and overshoots; the seal
    answers to the *true* motion; the encoder writes that motion in counts; the load cell adds

    .. math:: F_{\mathrm{read}} = F + F_b + \dot F_d t + h \sin(2\pi f_h t + \varphi)
        + v \sin(2\pi f_v t + \psi) + F_w (1 - e^{-t/\tau_w}) + e, \quad e \sim N(0, \sigma^2)

    in steps of its quantum, between its limits.

    Attributes
    ----------
    axis : Axis
    setpoint_interval : float
        s between set-points.
    rate : float
        Sampling rate of the record, Hz. There is no anti-aliasing filter.
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
    softening : float
        Mullins effect: relative loss s of force after many cycles; :math:`1 - s (1 -
        e^{-(n-1)/1.5})` is left in cycle n.
    bias, drift : float
        Offset, N, and its growth, N/s, of the load cell.
    warming, warming_time : float
        What the load cell's zero moves by while it warms up, N, and in what time, s.
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
    softening: float = 0.0
    bias: float = 0.05
    drift: float = 0.2e-3
    warming: float = 0.0
    warming_time: float = 600.0
    noise: float = 4e-3
    position_noise: float = 0.0
    hum: float = 3e-3
    hum_frequency: float = 50.0
    vibration: float = 1e-3
    vibration_frequency: float = 37.0
    quantum: float = 1 / 1280
    limit: float = 70.0

    def __post_init__(self) -> None:
        for name in ("setpoint_interval", "rate", "length", "limit", "warming_time"):
            value = getattr(self, name)
            if not value > 0:
                raise DataError(f"rig {name} = {value!r}; expected a number > 0")
        nonnegative = ("baseline", "encoder", "gap", "tilt", "noise", "position_noise", "quantum")
        require_nonnegative("rig ", **select_fields(self, *nonnegative))
        if not 0 <= self.softening < 1:
            raise DataError(
                f"rig softening = {self.softening!r}; expected a share from 0 to below 1"
            )

    def noise_free(self) -> Rig:
        """Return the same robot and plate with a perfect load cell and a perfect encoder."""
        return replace(
            self,
            encoder=0.0, bias=0.0, drift=0.0, warming=0.0, noise=0.0, position_noise=0.0, hum=0.0,
            vibration=0.0, quantum=0.0, limit=float("inf"),
        )  # fmt: skip

    def compression(self, position: FloatArray) -> FloatArray:
        r"""Return mean compression of the seal, m, with the plate at `position`.

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
        """Return the recorded signal of the load cell for a true `force`, N."""
        signal = self.add_disturbances(time, force, random)
        signal = signal + self.noise * random.standard_normal(len(time))
        return round_to_quantum(np.clip(signal, -self.limit, self.limit), self.quantum)

    def add_disturbances(
        self, time: FloatArray, force: FloatArray, random: np.random.Generator
    ) -> FloatArray:
        """A true `force`, N, with offset, drifts, hum and shaking, before noise and converter."""
        hum_phase, shake_phase = random.uniform(0, 2 * pi, 2)
        signal = force + self.bias + self.drift * (time - time[0])
        signal = signal - self.warming * np.expm1(-(time - time[0]) / self.warming_time)
        signal = signal + self.hum * np.sin(2 * pi * self.hum_frequency * time + hum_phase)
        shaking = np.sin(2 * pi * self.vibration_frequency * time + shake_phase)
        return np.asarray(signal + self.vibration * shaking)


@dataclass(frozen=True)
class Climate:
    r"""Temperature of a simulated test, and the temperature law of the seal.

    The seal is thermorheologically simple, with stiffnesses in proportion to T:
    :func:`~dashpot.solids.shift_laws.shift_to_temperature`.

    Attributes
    ----------
    temperature : float
        K.
    law : TemperatureLaw
        By default that of the demonstration seals.
    """

    temperature: float
    law: TemperatureLaw = SHIFT

    def shift_seal(self, seal: GeneralizedMaxwell) -> GeneralizedMaxwell:
        """Return the seal of the law's reference as it is in this climate."""
        return shift_to_temperature(seal, self.temperature, self.law)


def prepare_specimen(
    seal: GeneralizedMaxwell, rig: Rig, climate: Climate | None
) -> tuple[GeneralizedMaxwell, Specimen]:
    """Return the seal in a climate, and the metadata of its record."""
    if climate is None:
        return seal, Specimen(length=rig.length, notes="simulated")
    specimen = Specimen(length=rig.length, temperature=climate.temperature, notes="simulated")
    return climate.shift_seal(seal), specimen


@dataclass(frozen=True, eq=False, kw_only=True)
class RigTruth(EqualByValue):
    """Truth of a simulated test on the virtual rig.

    Attributes
    ----------
    kind : str
        Kind of the test.
    model : GeneralizedMaxwell
        The seal at the temperature of the test, before any softening.
    rig : Rig
    seed : int
    displacement, force : array, shape (n,)
        Plate position, m, and seal force, N, at the samples of the record, before encoder
        and load cell.
    climate : Climate or None
        What made `model` of the seal at the reference; None if no temperature was stated.
    """

    kind: ClassVar[str]

    model: GeneralizedMaxwell
    rig: Rig
    seed: int
    displacement: FloatArray
    force: FloatArray
    climate: Climate | None = None

    def __post_init__(self) -> None:
        for name in ("displacement", "force"):
            object.__setattr__(self, name, validate_samples(name, getattr(self, name)))


def round_to_quantum(values: FloatArray, quantum: float) -> FloatArray:
    """`values` rounded to whole quanta; a quantum of 0 leaves them alone."""
    return np.asarray(np.round(values / quantum) * quantum) if quantum > 0 else values
