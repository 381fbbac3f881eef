"""Faults and uncertainty of a hammer hit (double, overloaded, stuck, ringing), after ISO 7626-5."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray
from dashpot.base.units import format_quantity
from dashpot.signals.stuck_channel import find_stuck_runs
from dashpot.vibration.impact.hits import HitBlock, compute_width
from dashpot.vibration.modal.peaks import find_run

SECOND_PULSE_RATIO = 0.05  # height over the peak from which a second pulse is a second hit
MIN_PULSE_SAMPLES = 5  # fewest samples that resolve the shape of a pulse
MAX_UNDECAYED_RATIO = 0.01  # largest part of the response at the end of a record without window
MAX_UNDECAYED_RATIO_WINDOWED = 0.25  # the same with an exponential window
FLAT_WIDTH_RATIO = 0.38  # width at 95 % over width at 50 % of the peak; a half-sine has 0.30
MAX_PRE_HIT_MOTION = 0.02  # largest ratio of the motion before a hit to the response
FLAT_LOBE_RATIO = 0.55  # samples above 97 % over those above 80 % of a flat lobe
MAX_UNDERSHOOT = 0.05  # largest part of the impulse of a pulse that the channel gives back


@dataclass(frozen=True)
class HitQuality:
    """Quality of a hit: faults that exclude it, and doubts, one sentence each."""

    faults: tuple[str, ...] = ()
    doubts: tuple[str, ...] = ()

    @property
    def reasons(self) -> tuple[str, ...]:
        """Faults, then doubts."""
        return self.faults + self.doubts


def judge_hit(hit: HitBlock, *, windowed: bool = False) -> HitQuality:
    """Return the faults and doubts of one hit, judged alone.

    A fault makes the FRF wrong and rejects the hit; a doubt costs accuracy and is only reported.
    """
    return HitQuality(tuple(_list_faults(hit)), tuple(_list_doubts(hit, windowed)))


def compute_undecayed_fraction(hit: HitBlock) -> float:
    """Return the ratio of the response at the end of the block to its maximum, without noise."""
    segment_length = max(len(hit.force) // 16, 4)
    fractions = []
    for row, noise in zip(hit.acceleration, hit.noise[1:], strict=True):
        response = row[
            hit.onset : hit.onset + (len(row) - hit.onset) // segment_length * segment_length
        ]
        power = response.reshape(-1, segment_length).var(axis=1)
        # relative to the loudest segment, which may contain a short-lived mode
        end_power = max(power[-1] - noise**2, 0.0)
        fractions.append(np.sqrt(end_power / max(power.max(), 1e-300)))
    return float(min(max(fractions), 1.0))


def compute_pre_hit_motion(hit: HitBlock) -> float:
    """Return the ratio of the motion before the hit, without noise, to that after it."""
    largest_ratio = 0.0
    for row, ringing_sd, noise in zip(hit.acceleration, hit.ringing, hit.noise[1:], strict=True):
        motion = float(np.sqrt(max(ringing_sd**2 - noise**2, 0.0)))
        response_sd = float(row[hit.onset :][: max(len(row) // 16, 4)].std())
        if motion > 3 * noise / np.sqrt(max(hit.onset, 1)):
            largest_ratio = max(largest_ratio, motion / max(response_sd, 1e-300))
    return largest_ratio


def find_second_pulse(hit: HitBlock) -> tuple[float, float]:
    """Return the largest second rise of the force over its peak, and its time from the peak, s.

    How far the force rises again after it fell from its peak, or before it rose to it. The single
    hump of a soft tip, however long, does not rise twice.
    """
    force, peak, peak_index = hit.force, hit.peak, hit.peak_at
    pulse = hit.pulse(0.05)
    largest_rise, offset = 0.0, 0
    for step in (1, -1):
        samples = force[peak_index::step] if step > 0 else force[peak_index::-1]
        force_rise = samples - np.minimum(np.minimum.accumulate(samples), peak)
        # what starts below the base line rings; only what stands above it pushes
        force_rise = np.minimum(force_rise, samples)
        # ringing of filters about a short pulse dies within a few samples
        is_near = np.arange(len(force_rise)) < (pulse.stop - pulse.start) + 6
        force_rise = np.where(
            is_near & (force_rise < 4 * SECOND_PULSE_RATIO * peak), 0.0, force_rise
        )
        i = int(np.argmax(force_rise))
        if force_rise[i] > largest_rise:
            largest_rise, offset = float(force_rise[i]), step * i
    return largest_rise / peak, offset / hit.rate


def _list_faults(hit: HitBlock) -> Iterator[str]:
    if hit.missing:
        recorded_time = (len(hit.force) - hit.missing) / hit.rate
        yield (
            f"the recording ends {recorded_time:.3g} s into a record of {hit.length:.3g} s; "
            "record on, or ask for a shorter record"
        )
    if hit.onset < 2 and hit.force[0] > 0.05 * hit.peak:
        yield (
            f"the recording begins inside the pulse, at {100 * hit.force[0] / hit.peak:.0f} % of "
            "its peak; set a pretrigger"
        )
    height_ratio, delay = find_second_pulse(hit)
    if height_ratio >= SECOND_PULSE_RATIO and height_ratio * hit.peak >= 8 * hit.noise[0]:
        yield (
            f"double hit: a second pulse of {100 * height_ratio:.0f} % of the peak "
            f"{format_quantity(abs(delay), 'ms', '.0f')} {'after' if delay > 0 else 'before'} it"
        )
    overloads = tuple(_list_overloads(hit))
    yield from overloads
    if not overloads:
        yield from (message for message, rings in _find_stuck_responses(hit) if rings)


def _find_stuck_responses(hit: HitBlock) -> Iterator[tuple[str, bool]]:
    """Yield a message for each response with a stuck value, and whether it was still ringing."""
    sample_count = len(hit.force) - hit.missing
    segment_length = max(sample_count // 16, 4)
    for number, row in enumerate(hit.acceleration[:, :sample_count], 1):
        runs = find_stuck_runs(row, leaps=False)
        if len(runs):
            first, last = runs[np.argmax(np.diff(runs)[:, 0])]
            samples_before = row[max(first - segment_length, 0) : first + 1]
            response_sd = float(row[hit.onset :][:segment_length].std())
            message = (
                f"acceleration {number} has one and the same value for {last - first + 1} samples, "
                f"from {first / hit.rate:.3g} s on; check the cable and the converter"
            )
            yield message, bool(float(samples_before.std()) > MAX_UNDECAYED_RATIO * response_sd)


def _list_overloads(hit: HitBlock) -> Iterator[str]:
    if is_flat_topped(hit.force[hit.pulse(0.3)], hit.noise[0]):
        yield (
            f"hammer overload: the pulse is flat at {hit.peak:.4g} N, as if cut off; hit more "
            "softly or raise the range"
        )
    for number, (row, noise) in enumerate(zip(hit.acceleration, hit.noise[1:], strict=True), 1):
        height = _find_clipping_level(row, noise) or _find_clipping_level(-row, noise)
        if height:
            yield (
                f"acceleration {number} overloads: it is flat at {height:.4g} m/s^2; hit more "
                "softly or raise the range"
            )
            break


def _find_clipping_level(row: FloatArray, noise: float) -> float:
    """Return where the highest lobe of a response is cut off, m/s^2; 0 if it is not."""
    peak_index = int(np.argmax(row))
    lobe = row[find_run(row > 0.3 * row[peak_index], peak_index)]
    peak = float(lobe.max())
    top_samples = int(np.count_nonzero(lobe > peak - max(3 * noise, 1e-6 * peak)))
    # any smooth top is a parabola, which spends 0.39 of its upper fifth in its upper 3 %
    top_ratio = np.count_nonzero(lobe > 0.97 * peak) / np.count_nonzero(lobe > 0.8 * peak)
    is_flat = top_samples >= 4 and top_ratio > FLAT_LOBE_RATIO and is_flat_topped(lobe, noise)
    return peak if is_flat else 0.0


def _list_doubts(hit: HitBlock, windowed: bool) -> Iterator[str]:
    if hit.onset < 8:
        yield (
            f"only {hit.onset} samples lie before the pulse, too few to know the offsets; set a "
            "pretrigger of some 0.1 s"
        )
    pulse = hit.pulse(0.1)
    samples = pulse.stop - pulse.start
    if samples < MIN_PULSE_SAMPLES:
        yield (
            f"only {samples} sample{'s' if samples > 1 else ''} of the pulse exceed"
            f"{'' if samples > 1 else 's'} a tenth of its peak, so its height is "
            f"guesswork; sample at {MIN_PULSE_SAMPLES / samples * hit.rate:.3g} Hz or more, or "
            "take a softer tip"
        )
    yield from _list_ringing(hit, windowed)
    yield from _list_undershoot(hit)
    yield from (message for message, rings in _find_stuck_responses(hit) if not rings)


def _list_ringing(hit: HitBlock, windowed: bool) -> Iterator[str]:
    undecayed = compute_undecayed_fraction(hit)
    limit = MAX_UNDECAYED_RATIO_WINDOWED if windowed else MAX_UNDECAYED_RATIO
    if undecayed > limit and not hit.missing:
        yield (
            f"{100 * undecayed:.2g} % of the response is left at the end of the record (expected "
            f"{100 * limit:.0f} % {'with' if windowed else 'without'} a window); record longer"
            + ("" if windowed else ", or use the exponential window")
        )
    motion = compute_pre_hit_motion(hit)
    if motion >= MAX_PRE_HIT_MOTION:
        yield (
            f"the mass still moves before the hit, by {100 * motion:.0f} % of the response to it; "
            + ("that is taken off as a free decay, but better " if hit.calmed else "")
            + "wait longer between hits"
        )


def is_flat_topped(lobe: FloatArray, noise: float) -> bool:
    """Return whether a lobe is cut off at its top.

    A half-sine spends 0.30 of its half-height width above 95 % of its peak, a haversine 0.29, a
    Gaussian 0.27; one cut at 95 % of its height 0.41. The top is taken as the median of the
    samples about it, so noise on a flat top does not hide it. Lobes of fewer than 8 samples are
    only called flat when 3 neighbours are equal.
    """
    peak_index = int(np.argmax(lobe))
    peak = float(lobe[peak_index])
    if len(lobe) < 8:
        is_equal = np.abs(np.diff(lobe)) <= 1e-9 * peak
        is_high = np.minimum(lobe[1:], lobe[:-1]) >= 0.98 * peak
        pairs = is_equal & is_high
        return bool((pairs[1:] & pairs[:-1]).any())
    peak = float(np.median(lobe[lobe >= peak - max(3 * noise, 0.02 * peak)]))
    if noise > 0.02 * peak:  # the widths drown in noise
        return False
    return _compute_lobe_width(lobe, 0.95 * peak) > FLAT_WIDTH_RATIO * _compute_lobe_width(
        lobe, 0.5 * peak
    )


def _compute_lobe_width(lobe: FloatArray, level: float) -> float:
    """Return samples between the first and the last crossing of a level."""
    indices_above = np.flatnonzero(lobe >= level)
    return compute_width(lobe, level, (int(indices_above[0]), int(indices_above[-1])))


def _list_undershoot(hit: HitBlock) -> Iterator[str]:
    """Yield a doubt if the force undershoots after the pulse, as an AC-coupled channel does."""
    pulse = hit.pulse(0.02)
    undershoot_stop = pulse.stop + (pulse.stop - pulse.start)
    after_pulse = hit.force[undershoot_stop : len(hit.force) - hit.missing]
    if hit.onset < 8 or len(after_pulse) < 16:
        return
    impulse = float(hit.force[pulse].sum())
    undershoot = -float(after_pulse.sum()) / impulse
    # the base line is known only as well as the mean of the samples before the hit
    undershoot_error = 5 * hit.noise[0] * len(after_pulse) / np.sqrt(hit.onset) / impulse
    if undershoot < max(MAX_UNDERSHOOT, undershoot_error):
        return
    # at time t after the pulse, exp(-2 pi f t) of the undershoot is still to come
    early_count = max(len(after_pulse) // 50, 8)
    early_fraction = min(
        max(
            -float(after_pulse[:early_count].sum()) / float(hit.force[:undershoot_stop].sum()), 0.0
        ),
        0.99,
    )
    corner_frequency = -np.log1p(-early_fraction) * hit.rate / (2 * np.pi * early_count)
    yield (
        f"the force stays below its base line after the pulse and gives {100 * undershoot:.0f} % "
        f"of the impulse back, as a channel with a high pass at {corner_frequency:.2g} Hz does; "
        "couple it by DC, or trust only frequencies 20 times as high"
    )
