"""From the transforms of hits to complex lines and their errors."""

from __future__ import annotations

from enum import StrEnum

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import BoolArray, ComplexArray, FloatArray
from dashpot.base.errors import DataError
from dashpot.vibration.impact.hits import HitBlock

# FRF of hits.


POOLED_LINES = 40  # degrees of freedom that an estimate of the noise should rest on


class Estimator(StrEnum):
    """FRF estimator, by the channel that bears the noise."""

    H1 = "H1"  # on the response
    H2 = "H2"  # on the force
    HV = "Hv"  # on both, in proportion to the power of each channel
    HS = "Hs"  # on both, as large as it is before the hits


@dataclass(frozen=True, eq=False)
class Spectra:
    r"""Fourier transforms of force and response, one row per hit.

    Attributes
    ----------
    frequency : array, shape (n,)
        Hz.
    force, response : complex arrays, shape (hits, n)
    noise : tuple of float
        Standard deviation of the noise in force and response before the hits.
    """

    frequency: FloatArray
    force: ComplexArray
    response: ComplexArray
    noise: tuple[float, float] = (0.0, 0.0)

    @property
    def averages(self) -> int:
        """Number of hits."""
        return len(self.force)

    def only(self, hits: BoolArray) -> Spectra:
        """Return the chosen hits."""
        return Spectra(self.frequency, self.force[hits], self.response[hits], self.noise)


@dataclass(frozen=True, eq=False)
class ChannelSpectra:
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
    def s(self) -> ComplexArray:
        """Points of the lines on the Laplace plane, 1/s."""
        return np.asarray(2j * np.pi * self.frequency + self.shift)

    @property
    def record(self) -> float:
        """Length of the record after the middle of the hit, s, as averages count it."""
        return self.hits[0].length - self._moments()[0]

    @property
    def pulse(self) -> float:
        """Rms width of the hit, s, as averages count it."""
        return self._moments()[1]

    def band(self, low: float, high: float) -> ChannelSpectra:
        """Return the lines from `low` to `high`, Hz, without 0 Hz."""
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

    def only(self, accepted: BoolArray) -> ChannelSpectra:
        """Return the chosen hits."""
        return replace(
            self,
            force=self.force[accepted],
            response=self.response[:, accepted],
            hits=tuple(b for b, t in zip(self.hits, accepted, strict=True) if t),
        )

    def apply_signs(self, signs: FloatArray) -> ChannelSpectra:
        """Return the accelerations times +1 or -1 each."""
        return replace(
            self, response=self.response * signs[:, None, None], signs=self.signs * signs
        )

    def combine_channels(self, weights: FloatArray) -> Spectra:
        """One response made of all: the weighted sum of the accelerations."""
        noise = np.mean([hit.noise**2 for hit in self.hits], axis=0)
        return Spectra(
            self.frequency,
            self.force,
            np.einsum("c,chn->hn", weights, self.response),
            (float(np.sqrt(noise[0])), float(np.sqrt(noise[1:] @ weights**2))),
        )

    def split_channels(self) -> list[Spectra]:
        """Return every accelerometer by itself."""
        return [self.combine_channels(row) for row in np.eye(len(self.channels))]

    def _moments(self) -> tuple[float, float]:
        weights = [float(hit.force @ hit.force) for hit in self.hits]
        mean_time, width = np.average([hit.moments() for hit in self.hits], axis=0, weights=weights)
        return float(mean_time), float(width)


def estimate(spectra: Spectra, estimator: Estimator | str = Estimator.H1) -> ComplexArray:
    r"""FRF by linear averages over the hits, shape (n,).

    .. math::

        H_1 = \frac{G_{fa}}{G_{ff}}, \qquad H_2 = \frac{G_{aa}}{G_{af}}, \qquad
        H_\kappa = \frac{G_{aa} - \kappa G_{ff}
        + \sqrt{(\kappa G_{ff} - G_{aa})^2 + 4\kappa |G_{fa}|^2}}{2 G_{af}}

    with :math:`G_{fa} = \overline{F^* A}`, :math:`G_{af} = G_{fa}^*`. :math:`\kappa` is the ratio of
    the noise powers of response and force: for Hv that of the channels' whole powers, for Hs that
    of the noise recorded before the hits. Both scale with the channels' units, so the estimate
    does not depend on them; with :math:`\kappa = 1`, as often programmed, it does. Source: Rocklin,
    Crowley & Vold (1985); Wicks & Vold (1986).
    """  # noqa: E501
    estimator = Estimator(estimator)
    ff, aa, fa = _compute_powers(spectra)
    with np.errstate(divide="ignore", invalid="ignore"):
        if estimator is Estimator.H1:
            return np.asarray(fa / ff)
        if estimator is Estimator.H2:
            return np.asarray(aa / fa.conj())
        ratio = _get_noise_ratio(spectra, ff, aa, estimator)
        if ratio == np.inf:
            return np.asarray(fa / ff)
        difference = ratio * ff - aa
        root = np.sqrt(difference**2 + 4 * ratio * np.abs(fa) ** 2)
        # the two forms are equal; each is the one that does not cancel
        return np.asarray(
            np.where(
                difference > 0,
                2 * ratio * fa / (difference + root),
                (root - difference) / (2 * fa.conj()),
            )
        )


def coherence(spectra: Spectra) -> FloatArray | None:
    r"""Ordinary coherence :math:`|G_{fa}|^2 / (G_{ff} G_{aa})`, shape (n,).

    None for a single hit, of which it would be 1 whatever was measured.
    """
    if spectra.averages < 2:
        return None
    ff, aa, fa = _compute_powers(spectra)
    power = ff * aa
    safe = np.where(power > 0, power, 1.0)
    return np.asarray(np.where(power > 0, np.clip(np.abs(fa) ** 2 / safe, 0.0, 1.0), 0.0))


def random_error(spectra: Spectra, value: ComplexArray) -> FloatArray | None:
    r"""Return standard deviation of the real and of the imaginary part of an FRF, shape (n,).

    .. math:: s^2 = \frac{\overline{|A - H F|^2}}{2 (n - 1) \overline{|F|^2}}
              \approx |H|^2 \frac{1 - \gamma^2}{2 n \gamma^2}

    from what the n hits do not share: the usual error from coherence (ISO 7626-2, annex A) with
    the degree of freedom that the FRF itself used. Few hits show the noise of a line badly, so it
    is averaged over neighbours until the estimate rests on some 40 degrees of freedom.
    None for a single hit.
    """
    n = spectra.averages
    if n < 2:
        return None
    unshared = (np.abs(spectra.response - value * spectra.force) ** 2).mean(axis=0) * n / (n - 1)
    half_width = int(np.ceil((POOLED_LINES / (2 * (n - 1)) - 1) / 2))
    pooled = _smooth(unshared, max(half_width, 0))
    return np.asarray(np.sqrt(pooled / (2 * (np.abs(spectra.force) ** 2).sum(axis=0))))


def leave_one_out(spectra: Spectra, estimator: Estimator | str = Estimator.H1) -> ComplexArray:
    """FRF without each hit in turn, shape (hits, n)."""
    average_indices = np.arange(spectra.averages)
    return np.array(
        [estimate(spectra.only(average_indices != i), estimator) for i in average_indices]
    )


def _compute_powers(spectra: Spectra) -> tuple[FloatArray, FloatArray, ComplexArray]:
    f, a = spectra.force, spectra.response
    return (
        (np.abs(f) ** 2).mean(axis=0),
        (np.abs(a) ** 2).mean(axis=0),
        (f.conj() * a).mean(axis=0),
    )


def _get_noise_ratio(
    spectra: Spectra, ff: FloatArray, aa: FloatArray, estimator: Estimator
) -> float:
    force, response = spectra.noise
    if estimator is Estimator.HS and (force > 0 or response > 0):
        return np.inf if force == 0 else (response / force) ** 2
    return float(aa.mean() / ff.mean())


def _smooth(values: FloatArray, half_width: int) -> FloatArray:
    """Return mean over `half_width` neighbours to either side, fewer at the ends."""
    width = np.ones(2 * half_width + 1)
    counts = np.convolve(np.ones(len(values)), width)[half_width : half_width + len(values)]
    return np.asarray(np.convolve(values, width)[half_width : half_width + len(values)] / counts)
