"""Hits averaged into one FRF, as chosen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dashpot.base.arrays import BoolArray, ComplexArray, FloatArray
from dashpot.base.errors import DataError
from dashpot.vibration.impact.checks import agreement
from dashpot.vibration.impact.estimators import Estimator, Spectra, estimate, random_error
from dashpot.vibration.impact.hit_spectra import Stack
from dashpot.vibration.impact.hits import HitBlock
from dashpot.vibration.impact.quality import Verdict, judge, remaining
from dashpot.vibration.impact.rocking import Combination, null_rocking
from dashpot.vibration.impact.windows import force_window, window_decay
from dashpot.vibration.modal.modes import mount_band
from dashpot.vibration.modal.rational_fraction import Lines

FORCE_LEFT = 0.1  # -20 dB: where the force has fallen this far, the FRF ends
ALIAS_FREE = 0.4  # of the sampling rate
CLEAR = 0.5  # of all motion must go one way to tell the polarity of an accelerometer


@dataclass(frozen=True)
class Choices:
    """What the caller chose, understood."""

    estimator: Estimator
    force_window: bool
    exponential: bool
    end: float | None
    combine: str
    polarity: Sequence[int] | None
    band: tuple[float, float] | None
    accept: tuple[str, ...]
    channels: tuple[str, ...]
    reach: float | None


@dataclass(frozen=True, eq=False)
class Average:
    """All hits and their verdicts; the transforms, weights and FRF of those taken."""

    hits: tuple[HitBlock, ...]
    verdicts: tuple[Verdict, ...]
    taken: BoolArray
    stack: Stack
    weights: FloatArray
    rocking: Combination | None
    spectra: Spectra
    value: ComplexArray


def average_hits(hits: Sequence[HitBlock], taken: BoolArray, choices: Choices) -> Average:
    """Transform, turn, weight and average the hits taken, and judge them all."""
    verdicts = [judge(hit, windowed=choices.exponential) for hit in hits]
    good = [hit for hit, t in zip(hits, taken, strict=True) if t]
    decay = 0.0
    if choices.exponential:
        decay = window_decay(max(map(remaining, good)), hits[0].length, choices.end)
    stack = _transform(hits, choices, decay).band(*(choices.band or _excited(good)))
    stack = stack.turned(_signs(stack.only(taken), choices.polarity))
    weights, rocking = _combine(stack.only(taken), choices)
    verdicts, taken = agreement(stack.weighted(weights), verdicts, taken, choices.accept)
    stack = stack.only(taken)
    spectra = stack.weighted(weights)
    return Average(
        hits=tuple(hits),
        verdicts=tuple(verdicts),
        taken=taken,
        stack=stack,
        weights=weights,
        rocking=rocking,
        spectra=spectra,
        value=estimate(spectra, choices.estimator),
    )


def _transform(hits: Sequence[HitBlock], choices: Choices, decay: float) -> Stack:
    rate = hits[0].rate
    fade = np.exp(-decay * np.arange(len(hits[0].force)) / rate)
    force = [b.force * fade * (force_window(b) if choices.force_window else 1.0) for b in hits]
    response = np.array([b.acceleration * fade for b in hits]).swapaxes(0, 1)
    return Stack(
        frequency=np.asarray(np.fft.rfftfreq(len(fade), 1 / rate), dtype=np.float64),
        force=np.fft.rfft(force, axis=-1) / rate,
        response=np.fft.rfft(response, axis=-1) / rate,
        hits=tuple(hits),
        channels=choices.channels,
        signs=np.ones(len(choices.channels)),
        shift=decay,
    )


def _excited(hits: Sequence[HitBlock]) -> tuple[float, float]:
    """Lines above 0 Hz that the hammer excites: up to where its spectrum falls by 20 dB."""
    rate, n = hits[0].rate, len(hits[0].force)
    power = (np.abs(np.fft.rfft([b.force * force_window(b) for b in hits])) ** 2).mean(axis=0)
    weak = np.flatnonzero(power < FORCE_LEFT**2 * power[: max(n // 500, 2)].max())
    top = float(weak[0]) if weak.size else np.inf
    return 0.5 * rate / n, min(max(top - 0.5, 8.5), ALIAS_FREE * n) * rate / n


def _signs(stack: Stack, polarity: Sequence[int] | None) -> FloatArray:
    """Sign of each accelerometer: a hit sets a block moving in its own direction."""
    count = len(stack.channels)
    if polarity is not None:
        if len(polarity) != count or any(abs(sign) != 1 for sign in polarity):
            raise DataError(
                f"polarity = {tuple(polarity)}; expected +1 or -1 for each of the {count} "
                f"accelerometers ({', '.join(stack.channels)})"
            )
        return np.array(polarity, dtype=float)
    near = stack.band(*_mounts(stack))
    h = np.array([estimate(spectra) for spectra in near.each()])
    # the real part of the mobility, summed, is the velocity just after the hit
    mobility = (h / (2j * np.pi * near.frequency + near.shift)).real
    kick = mobility.sum(axis=1) / np.abs(mobility).sum(axis=1)
    if kick.min() < -CLEAR and kick.max() > CLEAR:
        along = [name for name, k in zip(stack.channels, kick, strict=True) if k > 0]
        against = [name for name, k in zip(stack.channels, kick, strict=True) if k < 0]
        raise DataError(
            f"accelerometers of opposite polarity: a hit moves {', '.join(along)} along with it "
            f"but {', '.join(against)} against it; check the mounting and give the polarity, such "
            f"as {tuple(1 if k > 0 else -1 for k in kick)}"
        )
    return np.full(count, -1.0 if kick.min() < -CLEAR else 1.0)


def _combine(stack: Stack, choices: Choices) -> tuple[FloatArray, Combination | None]:
    """Weights of the accelerometers, and what is known of rocking."""
    count = len(stack.channels)
    mean = np.full(count, 1 / count)
    if choices.combine in stack.channels:
        return np.array([float(name == choices.combine) for name in stack.channels]), None
    if count < 2:
        return mean, None
    near = stack.band(*_mounts(stack))
    values = np.array([estimate(spectra) for spectra in near.each()])
    errors = [
        random_error(spectra, value) for spectra, value in zip(near.each(), values, strict=True)
    ]
    found = null_rocking(
        Lines.measured(
            near.frequency,
            values,
            None if near.averages < 2 else np.array(errors),
            record=near.record,
            pulse=near.pulse,
            shift=near.shift,
        ),
        near.response / near.force[None],
        choices.reach,
    )
    if choices.combine == "mean" or found is None:
        return mean, found
    return np.array(found.weights), found


def _mounts(stack: Stack) -> tuple[float, float]:
    """The band in which the block moves on its mounts, from the accelerometer that moves most."""
    values = [estimate(spectra) for spectra in stack.each()]
    return mount_band(stack.frequency, max(values, key=lambda h: float((np.abs(h) ** 2).sum())))
