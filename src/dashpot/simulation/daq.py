"""The acquisition card: one converter behind a multiplexer, with a filter or without."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.base.validators import require_nonnegative, require_positive, select_fields


@dataclass(frozen=True)
class Daq:
    r"""A multiplexed card, such as the 16-bit one of 200 kS/s of the paper's rig.

    Channel :math:`i`, counted from 0, is sampled :math:`i\,\delta` after the first, with
    :math:`\delta = 1/` `fastest`; a Butterworth filter of second order, if there is one, stands
    before each channel and delays what is slow by :math:`\sqrt2 / \omega_c`.

    Attributes
    ----------
    bits : int
    span : float
        Largest voltage to either side, V.
    rate : float
        Of each channel, Hz.
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
        requested = self.channels * self.rate
        if requested > self.fastest:
            raise DataError(
                f"{self.channels} channels at {format_quantity(self.rate, 'kHz', 'g')} are "
                f"{convert_to_unit(requested, 'kHz'):g} kS/s; the card converts "
                f"{convert_to_unit(self.fastest, 'kHz'):g} kS/s in all: take "
                f"{format_quantity(self.fastest / self.channels, 'kHz')} at most, or fewer channels"
            )

    @property
    def lsb(self) -> float:
        """One count, V."""
        return self.span / float(1 << (self.bits - 1))

    def skew(self, channel: int) -> float:
        """How long after the first channel another is sampled, s; counted from 1."""
        return (channel - 1) / self.fastest

    def alias(self, frequency: float) -> float | None:
        """Return where a line above half the rate shows, Hz; None if it shows where it is."""
        if frequency <= self.rate / 2:
            return None
        return abs(frequency - self.rate * round(frequency / self.rate))

    def passed(self, frequency: float) -> float:
        """Return what part of a line at `frequency`, Hz, the filter lets through."""
        return 1 / sqrt(1 + (frequency / self.filter) ** 4) if self.filter else 1.0

    def counted(self, volts: FloatArray) -> FloatArray:
        """Return voltages in whole counts; what lies beyond the span reads as its end."""
        top = 2 ** (self.bits - 1)
        return np.asarray(np.clip(np.round(volts / self.lsb), -top, top - 1) * self.lsb)

    def read(self, clock: FloatArray, volts: FloatArray, at: FloatArray) -> FloatArray:
        """Return what the card writes, shape (channels, m), V, before it is counted.

        Parameters
        ----------
        clock : array, shape (n,)
            Evenly spaced, s, fine against the rate; on it the voltages are straight.
        volts : array, shape (channels, n)
            In the order in which they are converted.
        at : array, shape (m,)
            When the first channel is sampled, s.
        """
        seen = self._filter_voltages(clock, volts)
        return np.array(
            [np.interp(at + self.skew(i), clock, item) for i, item in enumerate(seen, start=1)]
        )

    def _filter_voltages(self, clock: FloatArray, volts: FloatArray) -> FloatArray:
        if not self.filter:
            return volts
        from scipy import signal

        sections = signal.butter(2, self.filter, fs=1 / (clock[1] - clock[0]), output="sos")
        settled = signal.sosfilt_zi(sections)[:, None, :] * volts[None, :, :1]
        return np.asarray(signal.sosfilt(sections, volts, zi=settled)[0])
