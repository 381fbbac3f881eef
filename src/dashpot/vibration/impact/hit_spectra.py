"""The transforms of all hits and all accelerometers, side by side."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dashpot.base.arrays import BoolArray, ComplexArray, FloatArray
from dashpot.base.errors import DataError
from dashpot.vibration.impact.estimators import Spectra
from dashpot.vibration.impact.hits import HitBlock


@dataclass(frozen=True, eq=False)
class Stack:
    """Transforms of one force and several accelerations, hit by hit.

    Attributes
    ----------
    frequency : array, shape (n,)
        Hz.
    force : complex array, shape (hits, n)
    response : complex array, shape (channels, hits, n)
    hits : tuple of HitBlock
    channels : tuple of str
    signs : array, shape (channels,)
        By which each acceleration has been turned.
    shift : float
        Decay of the exponential window, 1/s.
    """

    frequency: FloatArray
    force: ComplexArray
    response: ComplexArray
    hits: tuple[HitBlock, ...]
    channels: tuple[str, ...]
    signs: FloatArray
    shift: float

    @property
    def averages(self) -> int:
        """Number of hits."""
        return len(self.hits)

    @property
    def record(self) -> float:
        """Length of the record after the middle of the hit, s, as averages count it."""
        return self.hits[0].length - self._moments()[0]

    @property
    def pulse(self) -> float:
        """Rms width of the hit, s, as averages count it."""
        return self._moments()[1]

    def band(self, low: float, high: float) -> Stack:
        """The lines from `low` to `high`, Hz, without 0 Hz."""
        keep = (self.frequency >= low) & (self.frequency <= high) & (self.frequency > 0)
        if np.count_nonzero(keep) < 8:
            raise DataError(
                f"{np.count_nonzero(keep)} lines between {low:g} and {high:g} Hz, expected at "
                "least 8: widen the band or record longer"
            )
        return replace(
            self,
            frequency=self.frequency[keep],
            force=self.force[:, keep],
            response=self.response[:, :, keep],
        )

    def only(self, taken: BoolArray) -> Stack:
        """The chosen hits."""
        return replace(
            self,
            force=self.force[taken],
            response=self.response[:, taken],
            hits=tuple(b for b, t in zip(self.hits, taken, strict=True) if t),
        )

    def turned(self, signs: FloatArray) -> Stack:
        """The accelerations times +1 or -1 each."""
        return replace(
            self, response=self.response * signs[:, None, None], signs=self.signs * signs
        )

    def weighted(self, weights: FloatArray) -> Spectra:
        """One response made of all: the weighted sum of the accelerations."""
        noise = np.mean([hit.noise**2 for hit in self.hits], axis=0)
        return Spectra(
            self.frequency,
            self.force,
            np.einsum("c,chn->hn", weights, self.response),
            (float(np.sqrt(noise[0])), float(np.sqrt(noise[1:] @ weights**2))),
        )

    def each(self) -> list[Spectra]:
        """Every accelerometer by itself."""
        return [self.weighted(row) for row in np.eye(len(self.channels))]

    def _moments(self) -> tuple[float, float]:
        weights = [float(hit.force @ hit.force) for hit in self.hits]
        middle, width = np.average([hit.moments() for hit in self.hits], axis=0, weights=weights)
        return float(middle), float(width)
