r"""Exponential window that was applied to a hammer record before it was written.

Analysers multiply a block by :math:`w = e^{-at}`, so that a response that rings on dies within it.
Read as it stands, such a record decays by a more than its structure does. On force and response
alike the window is exact for a linear structure: the ratio of their transforms is
:math:`H(j\omega + a)`. All that is needed is a.

A header or a user may state it. Else the record itself shows it: the noise of an honest channel
does not decay, that of a windowed one falls as the window does, to the floor of its number format,

.. math:: v(t) = n^2 e^{-2at} + q^2

where v is the variance of what a high-pass leaves, above all that is struck. The three are found by
the likelihood of variances in stretches of the block, each chi-square with as many degrees of
freedom as its samples hold. Noise, unlike what rings, is of a broad band, and unlike the last
digits of numbers no constant part of the signal; a window takes it to the end, or to rounding.

Source: W. G. Halvorsen and D. L. Brown, Sound and Vibration 11(11), 1977, for the window.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import BoolArray, FloatArray, IndexArray
from dashpot.datamodel.vibration_tests import ImpactTest
from dashpot.vibration.impact.hits import GUARD_SAMPLES, HitBlock

_SAME_NUMBER = 1e-12
"""Distance of two values over the range of all, up to which they are one."""
_STRETCH_COUNT = 40
_MIN_SAMPLES = 4
"""Samples of a stretch."""
_MIN_STRETCHES = 5
_TAPS = 65
_MIN_TAPS = 9
_PASS_BAND_EDGE = 0.3
"""Share of the sampling rate above which a channel is noise."""
_PASS_BAND_SHARE = 1 - 2 * _PASS_BAND_EDGE
"""Degrees of freedom of a sample of it."""
_KAISER_BETA = 8.0
_MIN_ROUNDING_RATIO = 1.5
"""Times the variance of rounding that noise must have to be seen: below that it rounds to none."""
_WINDOW_DEVIANCE = 4.0
"""Fall of the deviance by which a window begins with the pulse."""
_LINEAR_LIMIT = 15.0
"""Times the variance of rounding below which it distorts a variance: noise of a step and more only
adds to it."""
_STEADY_RATIO = 0.9
"""Variance of the last quarter over that of the third above which no decay is sought."""
_CONSTANT_RATIO = 1e-6
"""Variance over the lowest usable one below which a stretch is constant."""
_DECISIVE_DEVIANCE = 30.0
"""Fall of the deviance by which a decay is evident."""
_MAX_FLOOR_RATIO = 4.0
"""Variance at the end, over what window and rounding leave of it, above which there is a floor."""
_MIN_VARIANCE_SHARE = 1e-10
"""Part of the greatest variance down to which its decay is followed."""
_NOISE_SHARE, _DIGIT_RATIO = 1e-4, 4.0
"""Scatter over the power of a channel beyond which no last digits of numbers are it; and the growth
of that ratio from the first quarter to the last."""
_COARSE_SHARE = 1e-5
"""Step of the numbers over the peak of a channel from which it may hide the noise of a sensor."""
_TONAL_SHARE = 0.5
"""Part of the scatter in a tenth of its lines above which it is what rings, and no noise."""
_MAX_EXCESS_SCATTER = 1.5
"""Chi-square over its freedom up to which stretches decay as one exponential does."""
_DECAY_RANGE = (0.02, 60.0)
"""Decays that are sought, times the length of the block."""
_CONTRADICTION_SE = 4.0
"""Standard errors between what is stated and what the scatter shows."""


class ExponentialWindow(NamedTuple):
    """Exponential window: its decay, and the origin of that value.

    Attributes
    ----------
    rate, sd : float
        a and its standard error, 1/s; 0 without a window.
    stated : bool
        A file or a user gives a.
    evident : bool
        The noise of the responses decays.
    on_force : bool
        The hammer's channel carries it, too.
    has_noise : bool
        The noise of the responses is seen.
    seen_rate : float
        a by the scatter, 1/s; nan where it shows none.
    is_determined : bool
        a is known: stated and not contradicted, or seen; else the step of the numbers hides it.
    from_start : bool
        It begins with the record, not with the pulse: of a window that the force lacks.
    """

    rate: float = 0.0
    sd: float = 0.0
    stated: bool = False
    evident: bool = False
    on_force: bool = True
    has_noise: bool = True
    seen_rate: float = float("nan")
    is_determined: bool = True
    from_start: bool = False

    def compute_response_only_window(self, hit: HitBlock) -> FloatArray:
        """Return the window that the force of a hit lacks, shape (n,); ones where it has it."""
        count = len(hit.force)
        if self.on_force or self.rate <= 0:
            return np.ones(count)
        time_since_onset = (np.arange(count) - hit.onset) / hit.rate
        start = hit.since_start if self.from_start and np.isfinite(hit.since_start) else 0.0
        return np.asarray(np.exp(-self.rate * (time_since_onset + start)))


NO_WINDOW = ExponentialWindow()


@dataclass(frozen=True, eq=False)
class ScatterDecay:
    """Noise variance of one channel in stretches of a block behind the pulse, averaged over hits.

    Attributes
    ----------
    time : array, shape (m,)
        Middle of each stretch, s from the onset.
    variance : array, shape (m,)
    freedom : array, shape (m,)
        Degrees of freedom of each.
    width : array, shape (m,)
        Length of each, s.
    rounding : float
        Variance that the step of the number format adds.
    is_noise : bool
        It is neither of few frequencies, as what rings, nor a constant small part of the signal,
        as its last digits are.
    """

    time: FloatArray
    variance: FloatArray
    freedom: FloatArray
    width: FloatArray
    rounding: float = 0.0
    is_noise: bool = True

    def only(self, keep: BoolArray) -> ScatterDecay:
        """Return some of the stretches."""
        return replace(
            self, time=self.time[keep], variance=self.variance[keep], freedom=self.freedom[keep],
            width=self.width[keep],
        )  # fmt: skip

    @property
    def lowest_usable_variance(self) -> float:
        """Variance below which rounding distorts it."""
        return max(_LINEAR_LIMIT * self.rounding, _MIN_VARIANCE_SHARE * float(self.variance.max()))

    @property
    def end_variance(self) -> float:
        """Variance in the last sixth of the stretches."""
        return float(np.median(self.variance[-max(len(self.time) // 6, 1) :]))

    def deviance(self, rates: FloatArray) -> FloatArray:
        r"""Deviance of the variances under windows of these decays, 1/s, at best noise and floor.

        .. math:: \sum_i \nu_i \left[\ln v_i + \hat v_i / v_i\right]
        """
        half_exponent = np.maximum(rates[:, None] * self.width, 1e-9)
        # the mean over a stretch, not the value in its middle
        mean = np.exp(-2 * rates[:, None] * self.time) * np.sinh(half_exponent) / half_exponent
        model = self.variance[None]
        for _ in range(12):
            noise, floor = _solve_nonnegative(mean, self.variance, self.freedom / model**2)
            model = np.maximum(noise * mean + floor, 1e-12 * self.variance.max())
        return np.asarray((np.log(model) + self.variance / model) @ self.freedom)


def _solve_nonnegative(
    mean: FloatArray, variance: FloatArray, weights: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the coefficients >= 0 of a column and of a constant, by weighted least squares.

    A row of `mean` for each problem; shape (problems, 1) each.
    """

    def sum_weighted(values: FloatArray | float) -> FloatArray:
        return np.asarray((weights * values).sum(axis=1, keepdims=True))

    squares, products, total = sum_weighted(mean**2), sum_weighted(mean), sum_weighted(1.0)
    column_target, target = sum_weighted(mean * variance), sum_weighted(variance)
    determinant = np.maximum(squares * total - products**2, 1e-12 * squares * total)
    noise = np.maximum((total * column_target - products * target) / determinant, 0.0)
    floor = (target - noise * products) / total
    return np.where(floor < 0, column_target / squares, noise), np.maximum(floor, 0.0)


def find_window(tests: Sequence[ImpactTest], hits: Sequence[HitBlock]) -> ExponentialWindow:
    """Return the exponential window of hits: as their tests state it, else as their noise shows it.

    Parameters
    ----------
    tests : sequence of ImpactTest
        With what their files state.
    hits : sequence of HitBlock
        Hits: samples of all of them, of one length.
    """
    rates = {test.window_rate for test in tests if test.window_rate is not None}
    stated_rate = next(filter(np.isfinite, rates), None)
    channels = np.moveaxis(np.array([hit.acceleration for hit in hits]), 1, 0)
    all_scatter = [decay for rows in channels if (decay := estimate_scatter_decay(rows, hits))]
    decaying_channels = [decay for decay in all_scatter if _decays_to_end(decay)]
    # what rings, or rounds, down to no noise shows neither a window nor that there is none
    has_steady_noise = any(
        decay.end_variance > _MIN_ROUNDING_RATIO * decay.rounding
        for decay in all_scatter
        if decay not in decaying_channels
    )
    decaying_channels = [decay for decay in decaying_channels if decay.is_noise]
    # a window is one of all responses
    rate, sd = 0.0, np.inf
    if decaying_channels and not has_steady_noise:
        rate, sd = _fit_decay_rate(decaying_channels)
    if not np.isfinite(sd):
        if stated_rate is not None:
            return ExponentialWindow(stated_rate, stated=True)
        # one is stated without its decay, or could not be seen
        is_known = not rates and (has_steady_noise or any(
            _find_number_step([*rows]) < _COARSE_SHARE * np.abs(rows).max() for rows in channels
        ))  # fmt: skip
        return ExponentialWindow(
            stated=bool(rates), has_noise=has_steady_noise, is_determined=is_known
        )
    window = ExponentialWindow(
        rate, sd, bool(rates), True, _is_on_force(hits, rate), seen_rate=rate,
        from_start=_begins_with_record(channels, hits, rate),
    )  # fmt: skip
    if stated_rate is None:
        return window
    separate = abs(stated_rate - rate) > _CONTRADICTION_SE * sd + 0.1 * rate
    return window._replace(rate=stated_rate, sd=0.0, stated=True, is_determined=not separate)


def without_offset(hit: HitBlock, window: ExponentialWindow) -> HitBlock:
    """Return a block whose offsets were windowed with it, freed of them as they decay.

    What was taken off before is their mean in the quiet before the pulse.
    """
    if window.rate <= 0:
        return hit
    count = max(hit.onset - GUARD_SAMPLES, 0)
    centred_time = (np.arange(len(hit.force)) - (count - 1) / 2) / hit.rate
    correction = 1 - np.exp(-window.rate * centred_time)
    length = len(hit.force) - hit.missing
    correction[length:] = 0.0
    return replace(
        hit,
        force=hit.force + hit.offset[0] * correction * window.on_force,
        acceleration=hit.acceleration + hit.offset[1:, None] * correction,
    )


# -- Decay of the noise ----------------------------------------------------------------------------


def estimate_scatter_decay(
    rows: Sequence[FloatArray], hits: Sequence[HitBlock], taps: int = _TAPS
) -> ScatterDecay | None:
    """Return the decay of one channel's noise, from its rows in all hits; None if it is not seen.

    Parameters
    ----------
    rows : sequence of array, shape (n,)
        Rows of one channel, one for each hit.
    hits : sequence of HitBlock
    taps : int
        Length of the high-pass, odd.
    """
    sample_count = min(len(hit.force) - hit.missing for hit in hits)
    start = max(hit.pulse(0.01).stop for hit in hits)
    if sample_count < start + 2 * _STRETCH_COUNT + taps:
        return None
    scatter, rounding = _filter_noise(rows, sample_count, taps)
    squares = (scatter**2).mean(axis=0)
    stretches = np.array_split(np.arange(start, len(squares)), _STRETCH_COUNT)
    variance = _average_by_stretch(squares, stretches)
    low = max(_LINEAR_LIMIT * rounding, _MIN_VARIANCE_SHARE * variance.max())
    stop = int(np.argmax(np.append(variance < low, True)))
    # a fast decay lies within the first few: these are cut anew
    loud = np.arange(start, start + sum(map(len, stretches[:stop])))
    is_noise = False
    if count := min(_STRETCH_COUNT, len(loud) // _MIN_SAMPLES):
        stretches = [*np.array_split(loud, count), *stretches[stop:]]
        variance = _average_by_stretch(squares, stretches)
        first_ratio, *_, last_ratio = (
            squares[part].mean() / np.mean([row[part].var() for row in rows])
            for part in np.array_split(loud, 4)
        )
        is_noise = (
            last_ratio > _NOISE_SHARE or last_ratio > _DIGIT_RATIO * first_ratio
        ) and not _is_tonal(scatter[:, loud], variance[:count])
    rate, onset = hits[0].rate, hits[0].onset
    lengths = np.array([*map(len, stretches)])
    time = np.array([(s.mean() + (taps - 1) / 2 - onset) / rate for s in stretches])
    freedom = _PASS_BAND_SHARE * len(rows) * lengths
    decay = ScatterDecay(time, variance, freedom, lengths / rate, rounding, is_noise)
    return _clip_at_noise_rise(_remove_padding(decay))


def _filter_noise(
    rows: Sequence[FloatArray], sample_count: int, taps: int
) -> tuple[FloatArray, float]:
    """Return what a linear-phase high-pass, a windowed sinc, leaves of rows and of rounding."""
    places = np.arange(taps) - (taps - 1) / 2
    low = np.sinc(2 * _PASS_BAND_EDGE * places) * np.kaiser(taps, _KAISER_BETA)
    kernel = (places == 0) - low / low.sum()
    scatter = np.array([np.convolve(row[:sample_count], kernel, "valid") for row in rows])
    return scatter, float(np.sum(kernel**2)) / 12 * _find_number_step(rows) ** 2


def _average_by_stretch(squares: FloatArray, stretches: Sequence[IndexArray]) -> FloatArray:
    """Return the mean square of each stretch."""
    return np.maximum([squares[stretch].mean() for stretch in stretches], 1e-300)


def _is_tonal(scatter: FloatArray, variance: FloatArray) -> bool:
    """Return whether a tenth of the lines holds most of the scatter, freed of its decay."""
    count = scatter.shape[1]
    places = np.arange(count) * len(variance) // count
    steady = (scatter / np.sqrt(variance[places]))[:, count // 4 :]
    power = np.sort((np.abs(np.fft.rfft(steady, axis=1)) ** 2).sum(axis=0))
    line_count = round(_PASS_BAND_SHARE * len(power))
    return bool(power[-max(line_count // 10, 1) :].sum() > _TONAL_SHARE * power.sum())


def _find_number_step(rows: Sequence[FloatArray]) -> float:
    """Step of the number format of a channel: the least distance of two values of a block."""
    steps = []
    for row in rows:  # each is less an offset of its own
        differences = np.diff(np.sort(row))
        is_step = differences > _SAME_NUMBER * np.ptp(row)
        steps.append(differences.min(initial=np.inf, where=is_step))
    return float(np.median(steps))


def _remove_padding(decay: ScatterDecay) -> ScatterDecay:
    """Return the stretches without a constant end that noise reaches at once, not by a decay."""
    varies = decay.variance > _CONSTANT_RATIO * decay.lowest_usable_variance
    # noise and padding share the last stretch that varies
    end = int(np.flatnonzero(varies).max(initial=0))
    if varies[-1] or decay.variance[end - 1] < decay.lowest_usable_variance:
        return decay
    return decay.only(np.arange(len(decay.variance)) < end)


def _clip_at_noise_rise(decay: ScatterDecay) -> ScatterDecay:
    """Return the stretches up to where the noise starts anew, as at the block of the next hit."""
    quietest = int(np.argmin(decay.variance))
    rises = decay.variance[quietest:] > 4 * decay.variance[quietest] * (
        1 + 4 * np.sqrt(2 / decay.freedom[quietest:])
    )
    # the last stretches alone: the quiet before the next hit
    end = quietest + int(np.argmax(rises)) if rises[-1] else len(decay.variance)
    return decay.only(np.arange(len(decay.variance)) < max(end, 8))


def _fit_decay_rate(scatter_decays: Sequence[ScatterDecay]) -> tuple[float, float]:
    """Return the decay that all channels share, 1/s, and its standard error."""
    rate, excess_scatter, curvature = _search_decay_rate(
        [_select_noise_segments(decay) for decay in scatter_decays]
    )
    sd = float(np.sqrt(2 * max(excess_scatter, 1.0) / curvature)) if curvature > 0 else np.inf
    return rate, sd


def _search_decay_rate(noise_segments: Sequence[ScatterDecay]) -> tuple[float, float, float]:
    """Return the likeliest decay, chi-square over its freedom, and the deviance's curvature."""
    length = max(decay.time[-1] for decay in noise_segments)

    def total(rates: FloatArray) -> FloatArray:
        return np.asarray(sum(decay.deviance(rates) for decay in noise_segments))

    low, high = np.log(np.array(_DECAY_RANGE) / length)
    for count in (60, 12, 12, 12, 12):
        grid = np.exp(np.linspace(low, high, count))
        best = int(np.argmin(total(grid)))
        low, high = np.log(grid[[max(best - 1, 0), min(best + 1, count - 1)]])
    rate = float(np.exp((low + high) / 2))
    before, lowest_deviance, after = total(rate * np.array([0.99, 1.0, 1.01]))
    curvature = float(before - 2 * lowest_deviance + after) / (0.01 * rate) ** 2
    # chi-square of what the model leaves, against what chance would
    freedom = sum(len(decay.time) for decay in noise_segments) - 3 * len(noise_segments)
    chance = sum(float(decay.freedom @ (np.log(decay.variance) + 1)) for decay in noise_segments)
    return rate, float(lowest_deviance - chance) / max(freedom, 1), curvature


def _select_noise_segments(decay: ScatterDecay) -> ScatterDecay:
    """Return the stretches from where the scatter decays as one exponential, down to rounding."""
    stop = int(np.argmax(np.append(decay.variance < decay.lowest_usable_variance, True)))
    indices = np.arange(len(decay.variance))
    segments = decay
    for eighths in range(5):
        segments = decay.only((indices >= eighths * stop // 8) & (indices < stop))
        if len(segments.time) < _MIN_STRETCHES:
            break
        if _search_decay_rate([segments])[1] < _MAX_EXCESS_SCATTER:
            break
    return segments


def _decays_to_end(decay: ScatterDecay) -> bool:
    """Return whether the second half of what is above rounding decays, too, and to no floor."""
    *_, third_quarter, last_quarter = np.array_split(
        decay.variance[decay.variance >= decay.lowest_usable_variance], 4
    )
    if last_quarter.sum() > _STEADY_RATIO * third_quarter.sum():
        return False
    segments = _select_noise_segments(decay)
    half = segments.only(np.arange(len(segments.time)) >= len(segments.time) // 2)
    if len(half.time) < _MIN_STRETCHES:
        return False
    deviance = half.deviance(np.append(0.0, np.geomspace(0.1, 30.0, 24) / half.time[-1]))
    if deviance[0] - deviance.min() <= _DECISIVE_DEVIANCE:
        return False
    # what rings before and after a pulse falls to the noise of the channel
    rate, *_ = _search_decay_rate([segments])
    end_time = np.median(decay.time[-max(len(decay.time) // 6, 1) :])
    window_power = float(np.exp(-2 * rate * (end_time - segments.time[0])))
    remainder = window_power * segments.variance[0] + _MIN_ROUNDING_RATIO * decay.rounding
    return bool(decay.end_variance <= _MAX_FLOOR_RATIO * remainder)


def _begins_with_record(channels: FloatArray, hits: Sequence[HitBlock], rate: float) -> bool:
    """Return whether the noise before the pulse decays, too, unless it clearly does not.

    The excess is the deviance of a window from the start over that of one from the pulse.
    """
    quiet_samples = min(hit.onset for hit in hits)
    quiet_samples -= max(GUARD_SAMPLES, quiet_samples // 8)
    taps = min(_TAPS, 2 * (quiet_samples // 4) - 1)
    excess = 0.0
    for rows in channels if taps >= _MIN_TAPS else ():
        if decay := estimate_scatter_decay(rows, hits, taps):
            segments = _select_noise_segments(decay)
            noise = segments.variance * np.exp(2 * rate * segments.time)
            quiet, _ = _filter_noise(rows, quiet_samples, taps)
            quiet_variance = np.median((quiet**2).mean(axis=1))
            rise = np.log(quiet_variance / np.average(noise, weights=segments.freedom))
            likely_rise = rate * hits[0].onset / hits[0].rate
            excess += _PASS_BAND_SHARE / 2 * quiet.size * ((rise - likely_rise) ** 2 - rise**2)
    return excess < _WINDOW_DEVIANCE


def _is_on_force(hits: Sequence[HitBlock], rate: float) -> bool:
    """Return whether the noise of the hammer decays with the window; True where it is not seen."""
    decay = estimate_scatter_decay([hit.force for hit in hits], hits)
    if decay is None:
        return True
    decay_index = int(np.argmin(np.abs(decay.time - 1 / rate)))
    window = np.exp(-rate * (decay.time[decay_index] - decay.time[0]))
    return bool(np.sqrt(decay.variance[decay_index] / decay.variance[0]) < (1 + window) / 2)
