"""Faults and doubts of a hammer hit (double, overloaded, stuck, ringing), after ISO 7626-5."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray
from dashpot.base.units import format_quantity
from dashpot.signals.stuck_channel import find_stuck_runs
from dashpot.vibration.impact.hits import HitBlock, width_at
from dashpot.vibration.modal.peaks import run_about

REBOUND = 0.05  # of the peak: a second pulse this high is a second hit
LEAST_SAMPLES = 5  # that a pulse must hold to be known in shape
UNDECAYED = 0.01  # of the response may be left at the end of a record without a window
UNDECAYED_WITH_WINDOW = 0.25
FLAT = 0.38  # width at 95 % over width at 50 % of the peak; a half-sine has 0.30
PRE_HIT_MOTION = 0.02  # of the response may be there before the hit
FLAT_RESPONSE = 0.55
UNDERSHOOT = 0.05  # of the pulse's impulse given back after it


@dataclass(frozen=True)
class HitQuality:
    """Quality of a hit: faults that exclude it, and doubts, one sentence each."""

    faults: tuple[str, ...] = ()
    doubts: tuple[str, ...] = ()

    @property
    def reasons(self) -> tuple[str, ...]:
        """Faults first."""
        return self.faults + self.doubts


def judge_hit(hit: HitBlock, *, windowed: bool = False) -> HitQuality:
    """Judge one hit by itself.

    A fault makes the FRF wrong and rejects the hit; a doubt costs accuracy and is only said.
    """
    return HitQuality(tuple(_list_faults(hit)), tuple(_list_doubts(hit, windowed)))


def compute_undecayed_fraction(hit: HitBlock) -> float:
    """Part of the response that is left at the end of the block, noise taken off; 0 to 1."""
    length = max(len(hit.force) // 16, 4)
    remaining = []
    for row, noise in zip(hit.acceleration, hit.noise[1:], strict=True):
        start = row[hit.onset : hit.onset + (len(row) - hit.onset) // length * length]
        power = start.reshape(-1, length).var(axis=1)
        # the decay of what rings longest: the loudest sixteenth may hold what dies at once
        last = max(power[-1] - noise**2, 0.0)
        remaining.append(np.sqrt(last / max(power.max(), 1e-300)))
    return float(min(max(remaining), 1.0))


def compute_pre_hit_motion(hit: HitBlock) -> float:
    """Return the motion before the hit, noise removed, over that after it."""
    worst = 0.0
    for row, spread, noise in zip(hit.acceleration, hit.ringing, hit.noise[1:], strict=True):
        slow = float(np.sqrt(max(spread**2 - noise**2, 0.0)))
        level = float(row[hit.onset :][: max(len(row) // 16, 4)].std())
        if slow > 3 * noise / np.sqrt(max(hit.onset, 1)):
            worst = max(worst, slow / max(level, 1e-300))
    return worst


def find_second_pulse(hit: HitBlock) -> tuple[float, float]:
    """Return largest second rise of the force: its height over the peak, and s from the peak.

    How far the force rises again after it fell from its peak, or before it rose to it. The single
    hump of a soft tip, however long, does not rise twice.
    """
    f, top, at = hit.force, hit.peak, hit.peak_at
    inside = hit.pulse(0.05)
    best, where = 0.0, 0
    for step in (1, -1):
        walk = f[at::step] if step > 0 else f[at::-1]
        rise = walk - np.minimum(np.minimum.accumulate(walk), top)
        # what starts below the base line rings; only what stands above it pushes
        rise = np.minimum(rise, walk)
        # ringing of filters about a short pulse dies within a few samples
        near = np.arange(len(rise)) < (inside.stop - inside.start) + 6
        rise = np.where(near & (rise < 4 * REBOUND * top), 0.0, rise)
        i = int(np.argmax(rise))
        if rise[i] > best:
            best, where = float(rise[i]), step * i
    return best / top, where / hit.rate


def _list_faults(hit: HitBlock) -> Iterator[str]:
    if hit.missing:
        have = (len(hit.force) - hit.missing) / hit.rate
        yield (
            f"the recording ends {have:.3g} s into a block of {hit.length:.3g} s; record on, or "
            "ask for a shorter record"
        )
    if hit.onset < 2 and hit.force[0] > 0.05 * hit.peak:
        yield (
            f"the recording begins inside the pulse, at {100 * hit.force[0] / hit.peak:.0f} % of "
            "its peak; set a pretrigger"
        )
    second, after = find_second_pulse(hit)
    if second >= REBOUND and second * hit.peak >= 8 * hit.noise[0]:
        yield (
            f"double hit: a second pulse of {100 * second:.0f} % of the peak "
            f"{format_quantity(abs(after), 'ms', '.0f')} {'after' if after > 0 else 'before'} it"
        )
    overloads = tuple(_list_overloads(hit))
    yield from overloads
    if not overloads:
        yield from (message for message, rings in _find_stuck_responses(hit) if rings)


def _find_stuck_responses(hit: HitBlock) -> Iterator[tuple[str, bool]]:
    """Where a response keeps one value that its noise rules out, and whether it still rang."""
    measured = len(hit.force) - hit.missing
    length = max(measured // 16, 4)
    for number, row in enumerate(hit.acceleration[:, :measured], 1):
        runs = find_stuck_runs(row, leaps=False)
        if len(runs):
            first, last = runs[np.argmax(np.diff(runs)[:, 0])]
            before = row[max(first - length, 0) : first + 1]
            loudest = float(row[hit.onset :][:length].std())
            message = (
                f"acceleration {number} has one and the same value for {last - first + 1} samples, "
                f"from {first / hit.rate:.3g} s on; check the cable and the converter"
            )
            yield message, bool(float(before.std()) > UNDECAYED * loudest)


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
    top = int(np.argmax(row))
    lobe = row[run_about(row > 0.3 * row[top], top)]
    peak = float(lobe.max())
    run = int(np.count_nonzero(lobe > peak - max(3 * noise, 1e-6 * peak)))
    # any smooth top is a parabola, which spends 0.39 of its upper fifth in its upper 3 %
    upper = np.count_nonzero(lobe > 0.97 * peak) / np.count_nonzero(lobe > 0.8 * peak)
    flat = run >= 4 and upper > FLAT_RESPONSE and is_flat_topped(lobe, noise)
    return peak if flat else 0.0


def _list_doubts(hit: HitBlock, windowed: bool) -> Iterator[str]:
    if hit.onset < 8:
        yield (
            f"only {hit.onset} samples lie before the pulse, too few to know the offsets; set a "
            "pretrigger of some 0.1 s"
        )
    inside = hit.pulse(0.1)
    samples = inside.stop - inside.start
    if samples < LEAST_SAMPLES:
        yield (
            f"the pulse is {samples} sample{'s' if samples > 1 else ''} long, so its height is "
            f"guesswork; sample at {LEAST_SAMPLES / samples * hit.rate:.3g} Hz or more, or take "
            "a softer tip"
        )
    yield from _list_ringing(hit, windowed)
    yield from _list_undershoot(hit)
    yield from (message for message, rings in _find_stuck_responses(hit) if not rings)


def _list_ringing(hit: HitBlock, windowed: bool) -> Iterator[str]:
    remainder, limit = (
        compute_undecayed_fraction(hit),
        UNDECAYED_WITH_WINDOW if windowed else UNDECAYED,
    )
    if remainder > limit and not hit.missing:
        yield (
            f"{100 * remainder:.2g} % of the response is left at the end of the record (expected "
            f"{100 * limit:.0f} % {'with' if windowed else 'without'} a window); record longer"
            + ("" if windowed else ", or use the exponential window")
        )
    worst = compute_pre_hit_motion(hit)
    if worst >= PRE_HIT_MOTION:
        yield (
            f"the block still moves before the hit, by {100 * worst:.0f} % of the response to it; "
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
    top = int(np.argmax(lobe))
    peak = float(lobe[top])
    if len(lobe) < 8:
        equal = np.abs(np.diff(lobe)) <= 1e-9 * peak
        high = np.minimum(lobe[1:], lobe[:-1]) >= 0.98 * peak
        pairs = equal & high
        return bool((pairs[1:] & pairs[:-1]).any())
    peak = float(np.median(lobe[lobe >= peak - max(3 * noise, 0.02 * peak)]))
    if noise > 0.02 * peak:  # the widths drown in noise
        return False
    return _compute_lobe_width(lobe, 0.95 * peak) > FLAT * _compute_lobe_width(lobe, 0.5 * peak)


def _compute_lobe_width(lobe: FloatArray, level: float) -> float:
    """Return samples between the first and the last crossing of a level."""
    above = np.flatnonzero(lobe >= level)
    return width_at(lobe, level, (int(above[0]), int(above[-1])))


def _list_undershoot(hit: HitBlock) -> Iterator[str]:
    """A force channel coupled by a capacitor gives the impulse back after the pulse."""
    inside = hit.pulse(0.02)
    end = inside.stop + (inside.stop - inside.start)
    tail = hit.force[end : len(hit.force) - hit.missing]
    if hit.onset < 8 or len(tail) < 16:
        return
    impulse = float(hit.force[inside].sum())
    given_back = -float(tail.sum()) / impulse
    # the base line is known only as well as the mean of the samples before the hit
    doubt = 5 * hit.noise[0] * len(tail) / np.sqrt(hit.onset) / impulse
    if given_back < max(UNDERSHOOT, doubt):
        return
    # of what is to be given back, exp(-2 pi f t) is still to come after t
    early = max(len(tail) // 50, 8)
    share = min(max(-float(tail[:early].sum()) / float(hit.force[:end].sum()), 0.0), 0.99)
    corner = -np.log1p(-share) * hit.rate / (2 * np.pi * early)
    yield (
        f"the force stays below its base line after the pulse and gives {100 * given_back:.0f} % "
        f"of the impulse back, as a channel with a high pass at {corner:.2g} Hz does; couple "
        "it by DC, or trust only frequencies 20 times as high"
    )
