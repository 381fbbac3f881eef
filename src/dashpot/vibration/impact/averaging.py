"""Hits averaged into one FRF, windowed, turned and weighted as chosen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray
from dashpot.base.errors import DataError
from dashpot.datamodel.frf import FRF
from dashpot.vibration.impact.checks import agreement
from dashpot.vibration.impact.estimators import (
    ChannelSpectra,
    Estimator,
    Spectra,
    coherence,
    estimate,
    random_error,
)
from dashpot.vibration.impact.exponential_window import NO_WINDOW, ExponentialWindow
from dashpot.vibration.impact.hit_quality import HitQuality, compute_undecayed_fraction, judge
from dashpot.vibration.impact.hits import HitBlock
from dashpot.vibration.impact.rocking import Combination, null_rocking
from dashpot.vibration.modal.frf_lines import FRFLines
from dashpot.vibration.modal.peaks import mount_band

FORCE_LEFT = 0.1  # -20 dB: where the force has fallen this far, the FRF ends
ALIAS_FREE = 0.4  # of the sampling rate
CLEAR = 0.5  # of all motion must go one way to tell the polarity of an accelerometer
LEFT = 0.01  # what an exponential window leaves of the response at the end of the record
FORMS = "none, force, exponential, exponential:0.01, force+exponential"


@dataclass(frozen=True)
class Window:
    """Whether to window the force, whether exponentially both, and the end value if given."""

    force: bool = False
    exponential: bool = False
    end: float | None = None

    @classmethod
    def parse(cls, window: str) -> Window:
        """Understand ``"force+exponential:0.01"``.

        Never a Hann window: it would erase the pulse, which stands at the edge of the record.
        """
        force, exponential, end = False, False, None
        for part in window.split("+"):
            name, _, value = part.strip().partition(":")
            if name == "force" and not value:
                force = True
            elif name == "exponential":
                exponential = True
                end = _end(value, window) if value else None
            elif name != "none" or value or window != "none":
                raise DataError(
                    f"window {window!r} does not suit a hammer test; expected one of {FORMS}"
                )
        return cls(force, exponential, end)

    def decay(self, hits: Sequence[HitBlock]) -> float:
        r"""Decay a of the exponential window :math:`e^{-at}`, 1/s; 0 without one.

        Without a wanted end value, the gentlest that leaves 1 % of the response at the end of
        the record, of which a part is left without a window.
        """
        if not self.exponential:
            return 0.0
        remainder = max(map(compute_undecayed_fraction, hits))
        end = min(1.0, LEFT / max(remainder, LEFT)) if self.end is None else self.end
        return float(-np.log(end) / hits[0].length)


def _end(value: str, window: str) -> float:
    try:
        end = float(value)
    except ValueError:
        end = float("nan")
    if not 0 < end < 1:
        raise DataError(
            f"window {window!r}: the number is what the window leaves at the end of the record; "
            "expected more than 0 and less than 1, such as exponential:0.01"
        )
    return end


def _force_window(hit: HitBlock) -> FloatArray:
    """One over the pulse, a half-cosine down over twice its length, then zero: shape (n,)."""
    pulse = hit.pulse(0.01)
    flat = pulse.stop + max(pulse.stop - pulse.start, 4)
    fall = 2 * max(pulse.stop - pulse.start, 4)
    at = np.arange(len(hit.force))
    return np.asarray(0.5 * (1 + np.cos(np.pi * np.clip((at - flat) / fall, 0, 1))))


@dataclass(frozen=True)
class AveragingOptions:
    """What the caller chose, understood."""

    estimator: Estimator
    window: Window
    combine: str
    polarity: Sequence[int] | None
    band: tuple[float, float] | None
    accept: tuple[str, ...]
    channels: tuple[str, ...]
    reach: float | None
    recorded: ExponentialWindow = NO_WINDOW
    """The window that the record carries."""


@dataclass(frozen=True, eq=False)
class Average:
    """All hits and their qualities; the transforms, weights and FRF of those taken."""

    hits: tuple[HitBlock, ...]
    qualities: tuple[HitQuality, ...]
    taken: BoolArray
    transforms: ChannelSpectra
    weights: FloatArray
    rocking: Combination | None
    spectra: Spectra
    estimator: Estimator
    shift_sd: float = 0.0

    @cached_property
    def frf(self) -> FRF:
        """The numbers of the average: FRF, coherence and random error."""
        transforms, value = self.transforms, estimate(self.spectra, self.estimator)
        return FRF(
            frequency=transforms.frequency,
            value=value,
            coherence=coherence(self.spectra),
            sd=random_error(self.spectra, value),
            shift=transforms.shift,
            shift_sd=self.shift_sd,
            record=transforms.record,
            pulse=transforms.pulse,
            averages=self.spectra.averages,
            units="SI",
        )


def average_hits(hits: Sequence[HitBlock], taken: BoolArray, choices: AveragingOptions) -> Average:
    """Transform, turn, weight and average the hits taken, and judge them all."""
    windowed = choices.window.exponential or choices.recorded.rate > 0
    qualities = [judge(hit, windowed=windowed) for hit in hits]
    good = [hit for hit, t in zip(hits, taken, strict=True) if t]
    transforms = _transform(hits, choices, choices.window.decay(good)).band(
        *(choices.band or _find_excited_band(good))
    )
    transforms = transforms.apply_signs(_signs(transforms.only(taken), choices.polarity))
    weights, rocking = _combine(transforms.only(taken), choices)
    qualities, taken = agreement(
        transforms.combine_channels(weights), qualities, taken, choices.accept
    )
    transforms = transforms.only(taken)
    return Average(
        hits=tuple(hits),
        qualities=tuple(qualities),
        taken=taken,
        transforms=transforms,
        weights=weights,
        rocking=rocking,
        spectra=transforms.combine_channels(weights),
        estimator=choices.estimator,
        shift_sd=choices.recorded.sd,
    )


def _transform(hits: Sequence[HitBlock], choices: AveragingOptions, decay: float) -> ChannelSpectra:
    rate = hits[0].rate
    recorded, time = choices.recorded, np.arange(len(hits[0].force)) / rate
    fade = np.exp(-decay * time)
    # of the response alone: the force is given the same
    faded = [fade * recorded.compute_response_only_window(b) for b in hits]
    force = [f * b.force * (_force_window(b) if choices.window.force else 1.0)
             for f, b in zip(faded, hits, strict=True)]  # fmt: skip
    response = np.array([b.acceleration * fade for b in hits]).swapaxes(0, 1)
    return ChannelSpectra(
        frequency=np.asarray(np.fft.rfftfreq(len(fade), 1 / rate), dtype=np.float64),
        force=np.fft.rfft(force, axis=-1) / rate,
        response=np.fft.rfft(response, axis=-1) / rate,
        hits=tuple(hits),
        channels=choices.channels,
        signs=np.ones(len(choices.channels)),
        shift=decay + recorded.rate,
    )


def _find_excited_band(hits: Sequence[HitBlock]) -> tuple[float, float]:
    """Lines above 0 Hz that the hammer excites: up to where its spectrum falls by 20 dB."""
    rate, n = hits[0].rate, len(hits[0].force)
    power = (np.abs(np.fft.rfft([b.force * _force_window(b) for b in hits])) ** 2).mean(axis=0)
    weak = np.flatnonzero(power < FORCE_LEFT**2 * power[: max(n // 500, 2)].max())
    top = float(weak[0]) if weak.size else np.inf
    return 0.5 * rate / n, min(max(top - 0.5, 8.5), ALIAS_FREE * n) * rate / n


def _signs(transforms: ChannelSpectra, polarity: Sequence[int] | None) -> FloatArray:
    """Sign of each accelerometer: a hit sets a block moving in its own direction."""
    count = len(transforms.channels)
    if polarity is not None:
        values = np.array(polarity, dtype=float)
        if len(values) != count or (np.abs(values) != 1).any():
            raise DataError(
                f"polarity = {tuple(polarity)}; expected +1 or -1 for each of the {count} "
                f"accelerometers ({', '.join(transforms.channels)})"
            )
        return values
    near = transforms.band(*_mounts(transforms))
    h = np.array([estimate(spectra) for spectra in near.split_channels()])
    # the real part of the mobility, summed, is the velocity just after the hit
    mobility = (h / near.s).real
    kick = mobility.sum(axis=1) / np.abs(mobility).sum(axis=1)
    if kick.min() < -CLEAR and kick.max() > CLEAR:
        along, against = (
            ", ".join(np.array(transforms.channels)[side]) for side in (kick > 0, kick <= 0)
        )
        raise DataError(
            f"accelerometers of opposite polarity: a hit moves {along} along with it but {against} "
            "against it; check the mounting and give the polarity, such as "
            f"{tuple(np.where(kick > 0, 1, -1).tolist())}"
        )
    return np.full(count, -1.0 if kick.min() < -CLEAR else 1.0)


def _combine(
    transforms: ChannelSpectra, choices: AveragingOptions
) -> tuple[FloatArray, Combination | None]:
    """Weights of the accelerometers, and what is known of rocking."""
    count = len(transforms.channels)
    mean = np.full(count, 1 / count)
    if choices.combine in transforms.channels:
        return np.array([float(name == choices.combine) for name in transforms.channels]), None
    if count < 2:
        return mean, None
    near = transforms.band(*_mounts(transforms))
    values = np.array([estimate(spectra) for spectra in near.split_channels()])
    errors = [
        random_error(spectra, value)
        for spectra, value in zip(near.split_channels(), values, strict=True)
    ]
    combination = null_rocking(
        FRFLines.measured(
            near.s,
            values,
            None if near.averages < 2 else np.array(errors),
            record=near.record,
            pulse=near.pulse,
        ),
        near.response / near.force[None],
        choices.reach,
    )
    if choices.combine == "mean" or combination is None:
        return mean, combination
    return np.array(combination.weights), combination


def _mounts(transforms: ChannelSpectra) -> tuple[float, float]:
    """The band in which the block moves on its mounts, from the accelerometer that moves most."""
    pairs = [(estimate(spectra), spectra) for spectra in transforms.split_channels()]
    value, spectra = max(pairs, key=lambda pair: float((np.abs(pair[0]) ** 2).sum()))
    return mount_band(transforms.frequency, value, random_error(spectra, value))
