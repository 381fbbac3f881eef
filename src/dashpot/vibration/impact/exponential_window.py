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
freedom as its samples hold.

Source: W. G. Halvorsen and D. L. Brown, Sound and Vibration 11(11), 1977, for the window.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import BoolArray, FloatArray
from dashpot.datamodel.vibration_tests import ImpactTest
from dashpot.vibration.impact.hits import GUARD_SAMPLES, HitBlock

EVIDENT_SHARE = 0.5
"""Scatter at the end over that before the pulse, below which a channel was windowed."""
_MIN_QUIET_SAMPLES = 8
"""Samples of a quarter of the quiet that is judged by itself."""
_NOISE_RISE = 3.0
"""Times the usual mean square beyond which a quarter of the quiet heard something."""
_STRETCH_COUNT = 40
_MIN_STRETCHES = 5
_TAPS = 65
_MIN_TAPS = 9
_PASS_BAND_EDGE = 0.3
"""Share of the sampling rate above which a channel is noise."""
_KAISER_BETA = 8.0
_MIN_ROUNDING_RATIO = 1.5
"""Times the variance of rounding that noise must have to be seen: below that it rounds to none."""
_WINDOW_DEVIANCE = 4.0
"""Fall of the deviance by which a window begins with the pulse."""
_LINEAR_LIMIT = 15.0
"""The same below which rounding distorts a variance: noise of a step and more only adds to it."""
_MIN_VARIANCE_SHARE = 1e-5
"""Part of the variance before the pulse down to which its decay is followed."""
_DECISIVE_DEVIANCE = 30.0
"""Fall of the deviance by which a slower decay is evident, too."""
_SLOW_DECAY_RATIO = 0.8
"""Ratio of the scatters that it then must have."""
_MAX_FLOOR_RATIO = 4.0
"""Variance at the end, over what window and rounding leave of it, above which there is a floor."""
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
        The scatter of the responses decays.
    on_force : bool
        The hammer's channel carries it, too.
    ratio : float
        Scatter of the responses at the end over that before the pulse; nan where it is not seen.
    seen_rate : float
        a by the scatter, 1/s; nan where it shows none.
    is_known : bool
        a is known: stated and not contradicted, or seen.
    from_start : bool
        It begins with the record, not with the pulse: of a window that the force lacks.
    """

    rate: float = 0.0
    sd: float = 0.0
    stated: bool = False
    evident: bool = False
    on_force: bool = True
    ratio: float = float("nan")
    seen_rate: float = float("nan")
    is_known: bool = True
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
    """Noise variance of one channel in sections of a block, averaged over hits.

    Attributes
    ----------
    time : array, shape (m,)
        Middle of each stretch, s from the onset; the first is before it.
    variance : array, shape (m,)
    freedom : array, shape (m,)
        Degrees of freedom of each.
    width : array, shape (m,)
        Length of each, s.
    rounding : float
        Variance that the step of the number format adds.
    """

    time: FloatArray
    variance: FloatArray
    freedom: FloatArray
    width: FloatArray
    rounding: float = 0.0

    def only(self, keep: BoolArray) -> ScatterDecay:
        """Return some of the stretches."""
        return ScatterDecay(
            self.time[keep], self.variance[keep], self.freedom[keep], self.width[keep],
            self.rounding,
        )  # fmt: skip

    @property
    def ratio(self) -> float:
        """Scatter at the end over that before the pulse."""
        last = self.variance[-max(len(self.variance) // 6, 1) :]
        return float(np.sqrt(np.median(last) / self.variance[0]))

    def deviance(self, rate: float, *, from_start: bool = True) -> float:
        r"""Deviance of the variances under a window of this decay, 1/s, at best noise and floor.

        .. math:: \sum_i \nu_i \left[\ln v_i + \hat v_i / v_i\right]

        Not `from_start` it begins with the pulse: what lies before is 1.
        """
        half_exponent = np.maximum(rate * self.width, 1e-9)
        # the mean over a stretch, not the value in its middle
        mean = np.exp(-2 * rate * self.time) * np.sinh(half_exponent) / half_exponent
        mean[0] = mean[0] if from_start else 1.0
        shape = np.column_stack((mean, np.ones(len(self.time))))
        model = self.variance
        for _ in range(12):
            weights = np.sqrt(self.freedom) / model
            pair = _nonnegative_pair(shape * weights[:, None], self.variance * weights)
            model = np.maximum(shape @ pair, 1e-12 * self.variance.max())
        return float(self.freedom @ (np.log(model) + self.variance / model))


def _nonnegative_pair(columns: FloatArray, target: FloatArray) -> FloatArray:
    """Least squares of two columns with coefficients >= 0."""
    best, *_ = np.linalg.lstsq(columns, target, rcond=None)
    if (best >= 0).all():
        return np.asarray(best)
    single_coefficients = np.maximum(
        columns.T @ target / np.maximum((columns**2).sum(axis=0), 1e-300), 0.0
    )
    residuals = [
        float(np.sum((target - columns[:, i] * single_coefficients[i]) ** 2)) for i in (0, 1)
    ]
    first = int(np.argmin(residuals))
    return np.where(np.arange(2) == first, single_coefficients, 0.0)


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
    stated_rate = next((rate for rate in rates if np.isfinite(rate)), None)
    all_scatter = _scatter_of_responses(hits)
    # a window is one of all responses: a channel alone may have heard something before the pulse
    windowed_scatter = all_scatter if all_scatter and all(map(_is_windowed, all_scatter)) else []
    ratio = max((decay.ratio for decay in all_scatter), default=float("nan"))
    if stated_rate is None and not windowed_scatter:
        # one is stated, and neither its decay nor a trace of it
        return ExponentialWindow(stated=bool(rates), ratio=ratio, is_known=not rates)
    if not windowed_scatter:
        return ExponentialWindow(stated_rate or 0.0, stated=True, ratio=ratio)
    rate, sd = _fit_decay_rate(windowed_scatter)
    if not np.isfinite(sd):
        return ExponentialWindow(
            stated_rate or 0.0, 0.0, bool(rates), True, True, ratio, rate, bool(stated_rate)
        )
    window = ExponentialWindow(
        rate, sd, bool(rates), True, _on_force(hits, rate), ratio, rate,
        from_start=_begins_with_record(windowed_scatter, rate),
    )  # fmt: skip
    if stated_rate is None:
        return window
    separate = abs(stated_rate - rate) > _CONTRADICTION_SE * sd + 0.1 * rate
    return window._replace(rate=stated_rate, sd=0.0, stated=True, is_known=not separate)


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


# -- what noise shows ------------------------------------------------------------------------------


def _scatter_of_responses(hits: Sequence[HitBlock]) -> list[ScatterDecay]:
    """Return the scatter of every response whose noise can be seen before the pulse."""
    channels = range(len(hits[0].acceleration))
    decays = [estimate_scatter_decay([hit.acceleration[i] for hit in hits], hits) for i in channels]
    return [decay for decay in decays if decay is not None]


def estimate_scatter_decay(
    rows: Sequence[FloatArray], hits: Sequence[HitBlock]
) -> ScatterDecay | None:
    """Return the decay of one channel's noise, from its rows in all hits; None if it is not seen.

    Parameters
    ----------
    rows : sequence of array, shape (n,)
        Rows of one channel, one for each hit.
    hits : sequence of HitBlock
    """
    quiet_samples = min(hit.onset for hit in hits)
    quiet_samples -= max(GUARD_SAMPLES, quiet_samples // 8)
    taps = min(_TAPS, 2 * (quiet_samples // 4) - 1)
    sample_count = min(len(hit.force) - hit.missing for hit in hits)
    if taps < _MIN_TAPS or sample_count < 4 * _STRETCH_COUNT + taps:
        return None
    filters = _high_pass(taps)
    squares = np.array([np.convolve(row[:sample_count], filters, "valid") ** 2 for row in rows])
    early_power = _estimate_noise_power(squares[:, : quiet_samples - taps + 1])
    rounding = float(np.sum(filters**2)) / 12 * _number_step(rows) ** 2
    if not early_power > _MIN_ROUNDING_RATIO * rounding:
        return None
    start = max(hit.pulse(0.01).stop for hit in hits)
    stretches = np.array_split(np.arange(start, squares.shape[1]), _STRETCH_COUNT)
    if min(map(len, stretches)) < 2:
        return None
    rate, onset = hits[0].rate, hits[0].onset
    mean_times = [(stretch.mean() + (taps - 1) / 2 - onset) / rate for stretch in stretches]
    variance = [float(squares[:, stretch].mean()) for stretch in stretches]
    expected_spread = 2 * (0.5 - _PASS_BAND_EDGE) * len(rows)
    time = np.array([(quiet_samples / 2 - onset) / rate, *mean_times])
    values = np.array([early_power, *variance])
    freedom = expected_spread * np.array([quiet_samples, *map(len, stretches)], dtype=float)
    width = np.array([quiet_samples, *map(len, stretches)]) / rate
    decay = ScatterDecay(time, np.maximum(values, 1e-300), freedom, width, rounding)
    return _clip_at_noise_rise(decay)


def _estimate_noise_power(squares: FloatArray) -> float:
    """The mean square before the pulse: the median over hits and quarters, for what is heard there.

    Of few numbers their mean.
    """
    quarters = [
        quarter
        for quarter in np.array_split(squares, 4, axis=1)
        if quarter.shape[1] >= _MIN_QUIET_SAMPLES
    ]
    means = np.array([quarter.mean(axis=1) for quarter in quarters]).ravel()
    typical_power = float(np.median(means)) if len(means) else 0.0
    quiet_means = means[means <= _NOISE_RISE * typical_power]
    return float(quiet_means.mean()) if len(quiet_means) else float(squares.mean())


def _high_pass(taps: int) -> FloatArray:
    """Return a linear-phase high-pass with its edge at .3 of the sampling rate: windowed sinc."""
    taps_from_centre = np.arange(taps) - (taps - 1) / 2
    low = (
        2
        * _PASS_BAND_EDGE
        * np.sinc(2 * _PASS_BAND_EDGE * taps_from_centre)
        * np.kaiser(taps, _KAISER_BETA)
    )
    low /= low.sum()
    return np.asarray((taps_from_centre == 0) - low)


def _number_step(rows: Sequence[FloatArray]) -> float:
    """Step of the number format of a channel: the least distance of two values of a block."""
    steps = []
    for row in rows:  # each is less an offset of its own
        differences = np.diff(np.unique(np.round(row[: len(row) // 8], 12)))
        steps.append(float(np.quantile(differences, 0.05)) if len(differences) > 1 else np.inf)
    return float(np.median(steps))


def _clip_at_noise_rise(decay: ScatterDecay) -> ScatterDecay:
    """Return the stretches up to where the noise starts anew, as at the block of the next hit."""
    quietest = int(np.argmin(decay.variance))
    rises = decay.variance[quietest:] > 4 * decay.variance[quietest] * (
        1 + 4 * np.sqrt(2 / decay.freedom[quietest:])
    )
    # the last stretches alone: the quiet before the next hit
    rise_indices = np.flatnonzero(rises)
    end = (
        quietest + int(rise_indices[0])
        if rise_indices.size and rise_indices[-1] == len(rises) - 1
        else len(rises)
    )
    end = end if rise_indices.size else len(decay.variance)
    keep = np.arange(len(decay.variance)) < max(end, 8)
    return decay.only(keep)


def _fit_decay_rate(scatter_decays: Sequence[ScatterDecay]) -> tuple[float, float]:
    """Return the decay that all channels share, 1/s, and its standard error."""
    noise_segments = [_select_noise_segments(decay) for decay in scatter_decays]
    if not noise_segments or max(len(decay.time) for decay in noise_segments) < _MIN_STRETCHES:
        return float("nan"), np.inf
    length = max(decay.time[-1] for decay in noise_segments)

    def total(rate: float) -> float:
        return sum(decay.deviance(rate) for decay in noise_segments)

    grid = np.geomspace(*_DECAY_RANGE, 60) / length
    values = [total(rate) for rate in grid]
    best = int(np.argmin(values))
    low, high = grid[max(best - 1, 0)], grid[min(best + 1, len(grid) - 1)]
    for _ in range(40):
        third_length = (high - low) / 3
        lower, upper = low + third_length, high - third_length
        if total(lower) < total(upper):
            high = upper
        else:
            low = lower
    rate = float((low + high) / 2)
    lowest_deviance, step = total(rate), 0.01 * rate
    curvature = (total(rate + step) - 2 * lowest_deviance + total(rate - step)) / step**2
    # chi-square of what the model leaves, against what chance would
    freedom = sum(len(decay.time) for decay in noise_segments) - 3 * len(noise_segments)
    chance = sum(float(decay.freedom @ (np.log(decay.variance) + 1)) for decay in noise_segments)
    excess_scatter = max((lowest_deviance - chance) / max(freedom, 1), 1.0)
    sd = float(np.sqrt(2 * excess_scatter / curvature)) if curvature > 0 else np.inf
    return rate, sd


def _select_noise_segments(decay: ScatterDecay) -> ScatterDecay:
    """Return the stretches that neither a high mode nor rounding drowns."""
    low = max(_LINEAR_LIMIT * decay.rounding, _MIN_VARIANCE_SHARE * decay.variance[0])
    rising_indices = np.flatnonzero(decay.variance[1:] > decay.variance[0])
    low_indices = np.flatnonzero(decay.variance[1:] < low)
    first = 1 + (int(rising_indices[-1]) + 1 if rising_indices.size else 0)
    segment_stop = 1 + int(low_indices[0]) if low_indices.size else len(decay.variance)
    indices = np.arange(len(decay.variance))
    return decay.only((indices == 0) | ((indices >= first) & (indices < segment_stop)))


def _is_windowed(decay: ScatterDecay) -> bool:
    """Return whether the noise of a channel decays: by half, or by less beyond any chance."""
    if decay.ratio > _SLOW_DECAY_RATIO:
        return False
    noise_segments = _select_noise_segments(decay)
    has_many_stretches = len(noise_segments.time) >= _MIN_STRETCHES
    if decay.ratio >= EVIDENT_SHARE:
        if not has_many_stretches:
            return False
        rates = np.geomspace(0.1, 3.0, 12) / noise_segments.time[-1]
        lowest_deviance = min(noise_segments.deviance(float(rate)) for rate in rates)
        if noise_segments.deviance(0.0) - lowest_deviance <= _DECISIVE_DEVIANCE:
            return False
    return not (has_many_stretches and _has_noise_floor(decay))


def _has_noise_floor(decay: ScatterDecay) -> bool:
    """Return whether the noise ends on a floor above what a window and rounding would leave of it.

    What rings before and after a pulse (a filter of linear phase, a response that the high-pass
    lets through) falls to the noise of the channel, and a window takes that with it.
    """
    rate, _ = _fit_decay_rate([decay])
    end_time = float(np.median(decay.time[-max(len(decay.time) // 6, 1) :]))
    window_power = float(np.exp(-2 * rate * (end_time - decay.time[0])))
    expected = window_power * decay.variance[0] + _LINEAR_LIMIT * decay.rounding
    return bool(decay.ratio**2 * decay.variance[0] > _MAX_FLOOR_RATIO * expected)


def _begins_with_record(scatter_decays: Sequence[ScatterDecay], rate: float) -> bool:
    """Return whether the noise before the pulse decays, too, unless it clearly does not."""
    segments = [_select_noise_segments(decay) for decay in scatter_decays]
    deviance_if_constant = sum(decay.deviance(rate, from_start=False) for decay in segments)
    return deviance_if_constant > sum(decay.deviance(rate) for decay in segments) - _WINDOW_DEVIANCE


def _on_force(hits: Sequence[HitBlock], rate: float) -> bool:
    """Return whether the noise of the hammer decays with the window; True where it is not seen."""
    decay = estimate_scatter_decay([hit.force for hit in hits], hits)
    if decay is None:
        return True
    decay_index = int(np.argmin(np.abs(decay.time - 1 / rate)))
    return bool(np.sqrt(decay.variance[decay_index] / decay.variance[0]) < (1 + np.exp(-1)) / 2)
