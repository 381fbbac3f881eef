"""Simulated force/torque transducer and its acquisition card."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, pi, sin, sqrt
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass, field
from dashpot.base.arrays import BoolArray, FloatArray
from dashpot.base.errors import DataError
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.base.value_ranges import require_nonnegative, require_positive, select_fields
from dashpot.base.version import byline
from dashpot.datamodel.relaxation import RelaxationTest
from dashpot.reading.write import describe_temperature, format_table, save_text
from dashpot.simulation.rig_errors import Rig

# Acquisition card: one converter behind a multiplexer, with or without a filter.


@dataclass(frozen=True)
class Daq:
    r"""Multiplexed acquisition card, such as the 16-bit one of 200 kS/s of the paper's rig.

    Channel :math:`i`, counted from 0, is sampled :math:`i\,\delta` after the first, with
    :math:`\delta = 1/` `fastest`; a Butterworth filter of second order, if there is one, stands
    before each channel and delays what is slow by :math:`\sqrt2 / \omega_c`.

    Attributes
    ----------
    bits : int
    span : float
        Largest voltage to either side, V.
    rate : float
        Sampling rate of each channel, Hz.
    channels : int
    fastest : float
        Conversions a second, of all channels together.
    filter : float
        Corner of the anti-alias filter, Hz; 0 for none.
    """

    bits: int = 16
    span: float = 10.0
    rate: float = 1000.0
    channels: int = 7
    fastest: float = 200e3
    filter: float = 0.0

    def __post_init__(self) -> None:
        require_positive(
            "daq ", **select_fields(self, "bits", "span", "rate", "channels", "fastest")
        )
        require_nonnegative("daq ", filter=self.filter, expected="a corner in Hz, or 0")
        total_rate = self.channels * self.rate
        if total_rate > self.fastest:
            raise DataError(
                f"{self.channels} channels at {format_quantity(self.rate, 'kHz', 'g')} are "
                f"{convert_to_unit(total_rate, 'kHz'):g} kS/s; the card converts "
                f"{convert_to_unit(self.fastest, 'kHz'):g} kS/s in all: take "
                f"{format_quantity(self.fastest / self.channels, 'kHz')} at most, or fewer channels"
            )

    @property
    def lsb(self) -> float:
        """One count, V."""
        return self.span / float(1 << (self.bits - 1))

    def skew(self, channel: int) -> float:
        """Return how long after the first channel another is sampled, s; counted from 1."""
        return (channel - 1) / self.fastest

    def alias(self, frequency: float) -> float | None:
        """Return where a line above half the rate shows, Hz; None if it shows where it is."""
        if frequency <= self.rate / 2:
            return None
        return abs(frequency - self.rate * round(frequency / self.rate))

    def filter_gain(self, frequency: float) -> float:
        """Return the fraction of a line at `frequency`, Hz, that the filter passes."""
        return 1 / sqrt(1 + (frequency / self.filter) ** 4) if self.filter else 1.0

    def quantise(self, volts: FloatArray) -> FloatArray:
        """Return voltages in whole counts; values beyond the span are clipped."""
        top = 2 ** (self.bits - 1)
        return np.asarray(np.clip(np.round(volts / self.lsb), -top, top - 1) * self.lsb)

    def read(self, clock: FloatArray, volts: FloatArray, at: FloatArray) -> FloatArray:
        """Return the voltages at the converter, shape (channels, m), V, before quantisation.

        Parameters
        ----------
        clock : array, shape (n,)
            Evenly spaced, s, fine against the rate; on it the voltages are straight.
        volts : array, shape (channels, n)
            In the order in which they are converted.
        at : array, shape (m,)
            When the first channel is sampled, s.
        """
        filtered = self._filter_voltages(clock, volts)
        return np.array(
            [np.interp(at + self.skew(i), clock, item) for i, item in enumerate(filtered, start=1)]
        )

    def _filter_voltages(self, clock: FloatArray, volts: FloatArray) -> FloatArray:
        if not self.filter:
            return volts
        from scipy import signal

        sections = signal.butter(2, self.filter, fs=1 / (clock[1] - clock[0]), output="sos")
        filter_state = signal.sosfilt_zi(sections)[:, None, :] * volts[None, :, :1]
        return np.asarray(signal.sosfilt(sections, volts, zi=filter_state)[0])


# Transducer: loads to six gauge voltages, and calibration.


AXES = ("Fx", "Fy", "Fz", "Tx", "Ty", "Tz")
_ARM = 5e-3
"""Distance of the three beams from the middle, m."""
_OVERSAMPLING = 8
"""Instants between two samples at which the voltages are made before they are filtered."""


def nano(gain: float = 2.56, crosstalk: float = 0.02) -> tuple[tuple[float, ...], ...]:
    r"""Return a matrix C, :math:`[F; T] = C v`, in N/V and N m/V, of three beams at 120 degrees.

    The even gauges feel the axial force of a beam, the odd ones its tangential force, `gain` N for
    each volt: with a span of 10 V to either side and 16 bits a count of one axial gauge is
    1/1280 N of :math:`F_z`. `crosstalk` mixes neighbouring gauges.
    """
    angle = 2 * pi * np.arange(3) / 3
    c, s, zero = np.cos(angle), np.sin(angle), np.zeros(3)
    axial = np.array([zero, zero, zero + 1, _ARM * s, -_ARM * c, zero])
    lever_row = np.array([-s, c, zero, zero, zero, zero + _ARM])
    matrix = np.empty((6, 6))
    matrix[:, ::2], matrix[:, 1::2] = gain * axial, gain * lever_row
    mixed = matrix @ (np.eye(6) + crosstalk * np.roll(np.eye(6), 1, axis=1))
    return tuple(tuple(map(float, row)) for row in mixed)


@dataclass(frozen=True)
class Transducer:
    """Force/torque transducer of six strain gauges under a tool.

    Attributes
    ----------
    matrix : 6 rows of 6
        C, N/V and N m/V.
    limit : tuple of 6 float
        Range of each axis, N and N m.
    bias : tuple of 6 float
        Voltages of the unloaded gauges, V.
    tool : float
        Weight of the plate that hangs on it along z, N.
    serial : str
    """

    matrix: tuple[tuple[float, ...], ...] = field(default_factory=nano)
    limit: tuple[float, ...] = (50.0, 50.0, 70.0, 0.5, 0.5, 0.5)
    bias: tuple[float, ...] = (0.12, -0.31, 0.05, 0.22, -0.14, 0.40)
    tool: float = 0.3
    serial: str = "SIMULATED"

    def __post_init__(self) -> None:
        if np.shape(self.matrix) != (6, 6) or np.linalg.cond(self.matrix) > 1e8:
            raise DataError("matrix: expected six rows of six numbers that can be inverted")

    def volts(self, load: FloatArray) -> FloatArray:
        """Return the gauge voltages under force and torque, both of shape (6, n)."""
        tool_load = np.array([0.0, 0.0, -self.tool, 0.0, 0.0, 0.0])
        solution = np.linalg.solve(np.array(self.matrix), load + tool_load[:, None])
        return np.asarray(solution + np.array(self.bias)[:, None])

    def find_saturated(self, load: FloatArray) -> BoolArray:
        """Return which axes pass their range, shape (6, n); both across where their sum does."""
        magnitude = np.abs(load)
        is_overloaded = magnitude > np.array(self.limit)[:, None]
        has_transverse_overload = np.hypot(load[0], load[1]) > min(self.limit[:2])
        is_overloaded[:2] |= has_transverse_overload
        return np.asarray(is_overloaded)

    def calibration(self) -> str:
        """Return the calibration file, as ATI writes version 1.1."""
        scale = np.repeat([1.0, 1e3], 3)
        root = ET.Element(
            "FTSensor", Serial=self.serial, BodyStyle="virtual", NumGages="6", CalFileVersion="1.1"
        )
        root.append(ET.Comment(f" simulated by {byline('a virtual transducer')} "))
        units = {"ForceUnits": "N", "TorqueUnits": "N-mm", "DistUnits": "mm"}
        sensor = ET.SubElement(root, "Calibration", units, PartNumber="virtual", CalDate="none")
        for axis, row, limit, factor in zip(AXES, self.matrix, self.limit, scale, strict=True):
            values = " ".join(repr(float(factor * v)) for v in row)
            ET.SubElement(sensor, "UserAxis", Name=axis, values=values, max=f"{factor * limit:g}")
        ET.indent(root)
        return ET.tostring(root, encoding="unicode") + "\n"


def tilt_motion(force: npt.ArrayLike, angle: float, *, azimuth: float = 0.0) -> FloatArray:
    r"""Return the force that a misaligned transducer feels, shape (3, n), N.

    A seal pushes along the plate's normal; a transducer turned by `angle` from it feels

    .. math:: F\,(\sin\theta\cos\varphi,\; \sin\theta\sin\varphi,\; \cos\theta)

    Parameters
    ----------
    force : array_like, shape (n,)
        Along the normal, N.
    angle, azimuth : float
        :math:`\theta` from the normal and :math:`\varphi` from x, rad.
    """
    arrow = [sin(angle) * cos(azimuth), sin(angle) * sin(azimuth), cos(angle)]
    return np.asarray(np.multiply.outer(arrow, np.asarray(force, dtype=float)))


# Simulated force/torque transducer with its acquisition card.


@dataclass(frozen=True)
class Instrument:
    """Transducer under a plate that may be tilted, and the card that reads it.

    Attributes
    ----------
    transducer : Transducer
    daq : Daq
    misaligned, towards : float
        Angle between its axis and the plate's normal, and in which direction from x, rad.
    """

    transducer: Transducer = field(default_factory=Transducer)
    daq: Daq = field(default_factory=Daq)
    misaligned: float = 0.0
    towards: float = 0.0

    def load(self, force: FloatArray) -> FloatArray:
        """Return force and torque, shape (6, n), under a force along the plate's normal, N."""
        response = tilt_motion(force, self.misaligned, azimuth=self.towards)
        return np.vstack([response, np.zeros_like(response)])

    def read(self, time: FloatArray, force: FloatArray, *, rig: Rig, seed: int = 0) -> FloatArray:
        """Return the gauge voltages that the card writes, shape (6, n), V.

        Parameters
        ----------
        time : array, shape (n,)
            Samples of the card, s.
        force : array, shape (n,)
            Force of the seal along the plate's normal, N.
        rig : Rig
            Whose offset, drifts, hum and noise are in F_z.
        seed : int
            Seed of the noise.
        """
        from scipy.interpolate import CubicSpline

        random = np.random.default_rng([seed, 6])
        fine_time = time[0] + np.arange(_OVERSAMPLING * len(time)) / (_OVERSAMPLING * self.daq.rate)
        smooth_force = np.asarray(CubicSpline(time, force)(np.minimum(fine_time, time[-1])))
        volts = self.transducer.volts(
            self.load(rig.add_disturbances(fine_time, smooth_force, random))
        )
        readings = self.daq.read(fine_time, volts, time)
        gain = float(np.linalg.norm(self.transducer.matrix[2]))
        return self.daq.quantise(
            readings + rig.noise / gain * random.standard_normal(readings.shape)
        )

    def list_limitations(self, force: FloatArray, rig: Rig) -> tuple[str, ...]:
        """Return the limitations of such a record: overload, and aliased lines."""
        names = []
        is_overloaded = self.transducer.find_saturated(self.load(force))
        axes = ", ".join(axis for axis, item in zip(AXES, is_overloaded, strict=True) if item.any())
        if axes:
            names.append(f"the transducer is beyond its range in {axes}")
        for name in ("hum", "vibration"):
            size, line = getattr(rig, name), getattr(rig, f"{name}_frequency")
            alias_frequency = self.daq.alias(line)
            remainder = size * self.daq.filter_gain(line)
            if alias_frequency is not None and size:
                names.append(
                    f"{name} of {line:g} Hz shows at {alias_frequency:g} Hz, "
                    f"{format_quantity(remainder, 'mN', '.3g')}: "
                    f"{self.daq.rate:g} samples a second are too few for it, and the filter lets "
                    "it through"
                )
        return tuple(names)


def write_gauges(
    test: RelaxationTest,
    volts: FloatArray,
    path: str | Path | None = None,
    *,
    comments: Sequence[str] = (),
) -> str:
    """Return a test with gauge voltages in the place of its force, and write it to `path`.

    The columns are ``time [s], displacement [mm], G0 [V], ..., G5 [V]``, from which
    `ReadOptions(calibration=)` makes the force.
    """
    header = ["time [s]", "displacement [mm]", *(f"G{i} [V]" for i in range(len(volts)))]
    columns = [test.time, convert_to_unit(test.displacement, "mm"), *volts]
    return save_text(
        format_table([*comments, *describe_temperature(test.specimen)], header, columns), path
    )
