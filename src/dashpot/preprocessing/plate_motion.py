"""Plate motion from the recorded displacement: rests, ramps, holds, and the ideal ramp."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray, cache_on_record, median
from dashpot.base.errors import DataError
from dashpot.datamodel.relaxation import RelaxationTest
from dashpot.signals.noise import median_of_three
from dashpot.signals.segments import (
    MotionSegment,
    RampHoldCycle,
    begins_in_hold,
    choose_cycle,
    estimate_resolution,
    explain_missing_hold,
    find_cycles,
    find_rising_sign,
    find_segments,
    is_creep_test,
    is_force_held,
    relaxes,
)

# Number of samples at rest before stated times.
_MIN_REST_SAMPLES = 5
_LATE_START_MESSAGE = (
    "yet the force relaxes: the record begins after its ramp. Start recording a second before the "
    "ramp, because its speed and the force before it are needed"
)


class IdealRamp(NamedTuple):
    """Straight ramp: ``x = reference_displacement + speed * (t - reference_time)``.

    Attributes
    ----------
    speed : float
        m/s.
    reference_time, reference_displacement : float
        One point of it, s and m.
    first, last : int
        The samples it was fitted to.
    """

    speed: float
    reference_time: float
    reference_displacement: float
    first: int
    last: int

    def time_of(self, displacement: float) -> float:
        """Return the time at which the line passes `displacement`, s."""
        return self.reference_time + (displacement - self.reference_displacement) / self.speed


def ideal_ramp(
    time: FloatArray, displacement: FloatArray, ramp: MotionSegment, *, origin: float, level: float
) -> IdealRamp:
    """Return the straight line through the middle of a ramp, from `origin` to `level`, m.

    A real axis starts late and rounds both corners; between 20 % and 80 % of the rise it runs
    straight, and there a line is fitted. Extended to `origin` and to `level` it gives the
    ramp of equal speed that eq. 5 asks for, with the lag of the axis taken out and the encoder's
    count averaged away. With fewer than 3 samples there, the line joins the crossings of 20 %
    and 80 %.
    """
    # one sample beyond the segment on either side holds the corners of a coarse record
    start, stop = max(ramp.first - 1, 0), min(ramp.last + 2, len(time))
    t, x = time[start:stop], displacement[start:stop]
    low, high = origin + 0.2 * (level - origin), origin + 0.8 * (level - origin)
    first = _last_below(x, low)
    last = first + int(np.argmax(x[first:] >= high))
    ramp_samples = slice(first + 1, last)
    if last - first - 1 >= 3:
        tm, xm = float(t[ramp_samples].mean()), float(x[ramp_samples].mean())
        change = t[ramp_samples] - tm
        speed = float(change @ (x[ramp_samples] - xm) / (change @ change))
        return IdealRamp(speed, tm, xm, start + first + 1, start + last - 1)
    t_low = _find_crossing(t, x, first, low)
    t_high = max(_find_crossing(t, x, last - 1, high), np.nextafter(t_low, np.inf))
    return IdealRamp((high - low) / (t_high - t_low), t_low, low, start + first, start + last)


def _last_below(x: FloatArray, level: float) -> int:
    """Return the last sample below `level` before the record first reaches its maximum."""
    peak_index = int(np.argmax(x))
    indices_below = np.flatnonzero(x[:peak_index] < level)
    return int(indices_below[-1]) if indices_below.size else 0


def _find_crossing(t: FloatArray, x: FloatArray, i: int, level: float) -> float:
    """Return where the straight line from sample `i` to the next passes `level`."""
    step = x[i + 1] - x[i]
    fraction = (level - x[i]) / step if step > 0 else 0.0
    return float(t[i] + min(max(fraction, 0.0), 1.0) * (t[i + 1] - t[i]))


@dataclass(frozen=True)
class PlateMotion:
    """Motion of the plate, compression positive.

    Attributes
    ----------
    sign : int
        -1 if the record counted compression downwards.
    cycles : tuple of RampHoldCycle
        Every loading found.
    cycle_index : int
        Which of them is used.
    straight_ramp : IdealRamp
        The straight part of its first ramp.
    rest_position, hold_position : float
        Displacement before the first ramp and in the first hold, m.
    start, last_rest_sample, stop : int
        The first sample kept, the last one at rest, and the last one of the last hold.
    segments : tuple of MotionSegment
        Segments of the whole record; empty where the times were given.
    """

    sign: int
    cycles: tuple[RampHoldCycle, ...]
    cycle_index: int
    straight_ramp: IdealRamp
    rest_position: float
    hold_position: float
    start: int
    last_rest_sample: int
    stop: int
    segments: tuple[MotionSegment, ...] = ()

    @property
    def cycle(self) -> RampHoldCycle:
        """The loading used."""
        return self.cycles[self.cycle_index]


def find_motion(
    test: RelaxationTest,
    *,
    location: str,
    sign: int | None,
    number: int | None,
) -> PlateMotion:
    """Find the loadings in a record, and the samples of the one to be used.

    Parameters
    ----------
    test : RelaxationTest
        As recorded; the force only shows whether the columns are swapped.
    location : str
        Name of the record, for errors.
    sign : {1, -1} or None
        None turns the displacement so that the first ramp rises.
    number : int or None
        Which loading, from 1.

    Raises
    ------
    DataError
        If nothing is held.
    """
    if sign is None:
        sign_found, segments = _find_rising_sign(test)
    else:
        x = sign * test.displacement
        sign_found, segments = sign, find_segments(test.time, x, _resolution(test))
    time, x, force = test.time, sign_found * test.displacement, test.force
    if is_creep_test(time, x, force, segments):
        raise DataError(
            f"{location}: this is a creep test, because the force is held while the displacement "
            "goes on. Use dashpot fit (Python: fit of a CreepTest)"
        )
    if not find_cycles(segments):
        if begins_in_hold(x, force):
            raise DataError(f"{location}: the displacement hardly moves, {_LATE_START_MESSAGE}")
        raise DataError(explain_missing_hold(segments, location, _format_advice(time, x, force)))
    index, cycles = choose_cycle(segments, number, location=location)
    return replace(_select_cycle(test, sign_found, cycles, index), segments=segments)


@cache_on_record
def _find_rising_sign(test: RelaxationTest) -> tuple[int, tuple[MotionSegment, ...]]:
    return find_rising_sign(test.time, test.displacement, _resolution(test))


@cache_on_record
def _resolution(test: RelaxationTest) -> float:
    return estimate_resolution(test.time, test.displacement, test.displacement_quantum)


def build_motion_from_times(
    test: RelaxationTest, *, onset: float, ramp_end: float, hold_end: float, sign: int | None
) -> PlateMotion:
    """Return the motion between times that the user gave, s.

    Raises
    ------
    DataError
        If they are out of order or outside the record, or nothing moved between them.
    """
    time, displacement = test.time, test.displacement
    if not time[0] <= onset < ramp_end < hold_end <= time[-1] + 1e-9:
        raise DataError(
            f"onset = {onset:g} s, ramp_end = {ramp_end:g} s, hold_end = {hold_end:g} s; expected "
            f"them in this order within the record, {time[0]:g} to {time[-1]:g} s"
        )
    first, corner, last = np.searchsorted(time, [onset, ramp_end, hold_end])
    first, last = max(int(first) - 1, 0), min(int(last), len(time) - 1)
    corner = int(corner)
    if corner - first < 1 or last - corner < 3:
        raise DataError(
            f"{corner - first} samples lie in the ramp and {last - corner} in the hold that were "
            "given; expected at least 1 and 3"
        )
    displacement_rise = median(displacement[corner : last + 1]) - float(displacement[first])
    direction = sign or (1 if displacement_rise > 0 else -1)
    x = direction * displacement
    if direction * displacement_rise <= 0:
        raise DataError("the displacement does not rise between the onset and the hold given")
    level = median(x[corner : last + 1])
    rest_segment, segments = None, find_segments(time, x, _resolution(test))
    if first >= 1:
        # begin of the last rest, if the plate moved before
        changes = [
            segment.last for segment in segments if segment.kind != "hold" and segment.last < first
        ]
        rest_start = changes[-1] if changes and first - changes[-1] >= _MIN_REST_SAMPLES else 0
        level_before = median(x[rest_start : first + 1])
        rest_segment = MotionSegment(
            "hold", rest_start, first, float(time[rest_start]), onset, level_before, level_before
        )  # fmt: skip
    ramp = MotionSegment("load", first, corner, onset, ramp_end, float(x[first]), level)
    hold = MotionSegment("hold", corner, last, ramp_end, hold_end, level, level)
    motion = _select_cycle(test, direction, (RampHoldCycle(rest_segment, (ramp, hold)),), 0)
    return replace(motion, stop=last, segments=segments)


def follow_contact(
    test: RelaxationTest, motion: PlateMotion, contact: float, *, tolerance: float
) -> PlateMotion:
    """Return the motion without the ramps that end in air, before `contact` less `tolerance`, m."""
    segments = motion.cycle.segments
    ramps_in_air = [
        i
        for i, segment in enumerate(segments[:-2])
        if segment.kind == "load" and segment.level <= contact + tolerance
    ]
    if not ramps_in_air or segments[ramps_in_air[-1] + 1].kind != "hold":
        return motion
    first = ramps_in_air[-1] + 2
    cycle = RampHoldCycle(segments[first - 1], segments[first:])
    cycles = (*motion.cycles[: motion.cycle_index], cycle, *motion.cycles[motion.cycle_index + 1 :])
    plate_motion = _select_cycle(test, motion.sign, cycles, motion.cycle_index)
    return replace(plate_motion, stop=motion.stop, segments=motion.segments)


def find_first_press(
    test: RelaxationTest, motion: PlateMotion, force: FloatArray, *, min_rise: float
) -> PlateMotion | None:
    """Return the motion of the first loading that raised the force, if it is before that used.

    Parameters
    ----------
    test : RelaxationTest
    motion : PlateMotion
        Motion of the loading that is used.
    force : array, shape (n,)
        N, rising with compression.
    min_rise : float
        A force that rises by less was of no seal, N.
    """
    earlier_segments = [segment for segment in motion.segments if segment.last <= motion.start]
    for i, segment in enumerate(earlier_segments):
        if segment.kind != "load" or not _has_rise(
            force[segment.first : segment.last + 1], min_rise
        ):
            continue
        rest_segment = (
            earlier_segments[i - 1] if i and earlier_segments[i - 1].kind == "hold" else None
        )
        # it turns there: whatever follows is not asked about
        top_segment = MotionSegment(
            "unload",
            segment.last,
            segment.last,
            segment.end,
            segment.end,
            segment.level,
            segment.level,
        )
        return _select_cycle(
            test, motion.sign, (RampHoldCycle(rest_segment, (segment, top_segment)),), 0
        )
    return None


def list_earlier_presses(motion: PlateMotion) -> tuple[MotionSegment, ...]:
    """Return every move towards the seal before the loading that is used."""
    return tuple(
        segment
        for segment in motion.segments
        if segment.last <= motion.start and segment.kind == "load"
    )


def begins_with_release(motion: PlateMotion) -> bool:
    """Return whether the record begins with a retracting plate: the seal was pressed before."""
    moving_segments = [segment for segment in motion.segments if segment.kind != "hold"]
    first_move = moving_segments[0] if moving_segments else None
    return (
        first_move is not None and first_move.kind == "unload" and first_move.last <= motion.start
    )


def _has_rise(force: FloatArray, min_rise: float) -> bool:
    smooth_force = median_of_three(force)
    return bool(
        smooth_force.max() - smooth_force[: max(len(smooth_force) // 20, 1)].mean() > min_rise
    )


def _select_cycle(
    test: RelaxationTest, sign: int, cycles: tuple[RampHoldCycle, ...], index: int
) -> PlateMotion:
    time, x = test.time, sign * test.displacement
    cycle, resolution = cycles[index], _resolution(test)
    ramp = cycle.ramp
    rest_level = _select_rest(x, cycle.rest, ramp)
    level = _find_hold(time, x, cycle)
    start = cycle.rest.first if cycle.rest is not None else ramp.first
    line = ideal_ramp(time, x, ramp, origin=rest_level, level=level)
    still_indices = np.flatnonzero(np.abs(x[start : line.first] - rest_level) <= resolution)
    departure_index = (
        start + int(still_indices[-1])
        if cycle.rest is not None and still_indices.size
        else ramp.first
    )
    return PlateMotion(
        sign=sign, cycles=cycles, cycle_index=index, straight_ramp=line,
        rest_position=rest_level, hold_position=level, start=start,
        last_rest_sample=departure_index, stop=_find_last_held(x, cycle.hold, resolution),
    )  # fmt: skip


def _format_advice(time: FloatArray, x: FloatArray, force: FloatArray) -> str:
    """Return the possible faults of a displacement without a hold."""
    has_motion = any(segment.kind != "hold" for segment in find_segments(time, x))
    if find_cycles(find_segments(time, -x)):
        return "with the other sign it would ramp and rest. Leave out sign, or give the other"
    if not has_motion and relaxes(force):
        return _LATE_START_MESSAGE
    if has_motion and any(is_force_held(time, sign * force) for sign in (1, -1)):
        return "the force column ramps and rests instead. Check whether the two are swapped"
    return "expected a ramp and then a hold. Check the columns and the units"


def _select_rest(x: FloatArray, rest_segment: MotionSegment | None, ramp: MotionSegment) -> float:
    if rest_segment is None:
        return float(x[ramp.first])
    second_half = rest_segment.first + (rest_segment.last - rest_segment.first) // 2
    return median(x[second_half : rest_segment.last + 1])


def _find_hold(time: FloatArray, x: FloatArray, cycle: RampHoldCycle) -> float:
    """Return the position of the plate in the hold, after it settled and before it creeps."""
    ramp, hold = cycle.segments[0], cycle.segments[1]
    if hold.kind != "hold":
        return ramp.level
    time_since_ramp = time[hold.first : hold.last + 1] - ramp.end
    latest = max(0.6 * ramp.duration, 0.02 * hold.duration)
    is_settled = (time_since_ramp >= 0.1 * ramp.duration) & (time_since_ramp <= latest)
    values = x[hold.first : hold.last + 1]
    return median(values[is_settled] if np.count_nonzero(is_settled) >= 5 else values[1:7])


def _find_last_held(x: FloatArray, hold: MotionSegment, resolution: float) -> int:
    """Return the last sample before the plate leaves the hold."""
    if hold.last == len(x) - 1:
        return hold.last
    last_quarter = x[hold.first + 3 * (hold.last - hold.first) // 4 : hold.last + 1]
    level = median(last_quarter)
    middle = (hold.first + hold.last) // 2
    is_still = np.abs(x[middle : hold.last + 1] - level) <= max(resolution, 2e-3 * abs(np.ptp(x)))
    return middle + int(np.flatnonzero(is_still)[-1])
