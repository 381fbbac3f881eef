"""Segments of a recorded displacement: ramps, holds, and the kind of test they form."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from dashpot.base.arrays import FloatArray, median
from dashpot.base.errors import DataError
from dashpot.base.plain_text import sentence
from dashpot.base.units import format_quantity
from dashpot.datamodel.relaxation import find_quantum
from dashpot.signals.noise import estimate_robust_scatter, median_of_three

# Ramps and holds, and the loadings that they form.


_MIN_MOVE = 0.05
"""A move smaller than this part of the whole travel is settling, not a ramp."""


_MIN_STOP = 0.01
"""A stop shorter than this part of the longest hold interrupts a ramp, and does not end it."""
_MAX_VISITS = 64
"""Mean number of times that a sample is searched for a corner; then long spans are halved."""
_SHORT_SPAN, _LOOP_SPAN = 1024, 32
"""Samples of a span that is never halved, and of one that a loop searches faster than NumPy."""


_Kind: TypeAlias = Literal["hold", "load", "unload"]
_Side: TypeAlias = tuple[_Kind, int, int]
_OPPOSITE_KIND: dict[_Kind, _Kind] = {"hold": "hold", "load": "unload", "unload": "load"}


class MotionSegment(NamedTuple):
    """Segment of one motion.

    Attributes
    ----------
    kind : str
        ``"hold"``, ``"load"`` (displacement rises) or ``"unload"``.
    first, last : int
        Its first and last sample; neighbours share a sample.
    start, end : float
        Their times, s.
    origin, level : float
        Displacement at start and end, m; of a hold, the median twice.
    """

    kind: _Kind
    first: int
    last: int
    start: float
    end: float
    origin: float
    level: float

    @property
    def duration(self) -> float:
        """Time from start to end, s."""
        return self.end - self.start


def find_segments(
    time: FloatArray, displacement: FloatArray, resolution: float | None = None
) -> tuple[MotionSegment, ...]:
    """Split a record into loading, unloading and holding.

    A polygon is laid through the record, with a corner wherever a straight line would miss it
    by more than the resolution of the channel or 1 % of the travel. Its sides are moves where they
    are fast or long, else holds; sides of one kind join; a move below 5 % of the travel
    (overshoot, settling) belongs to the hold beside it, and so does ringing of up to 30 % of the
    ramp right before it. Any sampling will do.

    Parameters
    ----------
    time, displacement : array, shape (n,)
        s and m; the sign as it is.
    resolution : float, optional
        That of the displacement, where it is known already.
    """
    x = median_of_three(displacement)
    travel = float(np.ptp(x))
    if resolution is None:
        resolution = estimate_resolution(time, displacement, find_quantum(displacement))
    if travel <= 4 * resolution:
        return (_make_segment("hold", time, x, 0, len(x) - 1),)
    corners = _find_corners(time, x, max(2 * resolution, 0.01 * travel))
    kinds = _classify_sides(time[corners], x[corners], travel)
    sides = _merge_neighbours(zip(kinds, corners, corners[1:], strict=False))
    sides = _merge_small_moves(sides, time, x, travel)
    return tuple(_make_segment(kind, time, x, first, last) for kind, first, last in sides)


def negate_segments(segments: Iterable[MotionSegment]) -> tuple[MotionSegment, ...]:
    """Return the segments of the same record with the opposite sign."""
    return tuple(
        segment._replace(
            kind=_OPPOSITE_KIND[segment.kind], origin=-segment.origin, level=-segment.level
        )
        for segment in segments
    )


def estimate_resolution(time: FloatArray, displacement: FloatArray, count: float) -> float:
    """Return the resolution of a displacement, m: 4 sigma of its noise and half a quantum."""
    return 4 * estimate_robust_scatter(time, displacement) + 0.5 * count


def _make_segment(
    kind: _Kind,
    time: FloatArray,
    x: FloatArray,
    first: int,
    last: int,
) -> MotionSegment:
    origin, level = float(x[first]), float(x[last])
    if kind == "hold":
        origin = level = median(x[first : last + 1])
    return MotionSegment(kind, first, last, float(time[first]), float(time[last]), origin, level)


def _find_corners(time: FloatArray, x: FloatArray, tolerance: float) -> list[int]:
    """Corners of the coarsest polygon within `tolerance` (Ramer, Douglas and Peucker).

    With thousands of equal cycles each corner would cut off one cycle, at a cost that grows with
    the square of their number. After so many visits of a sample, long spans are halved instead:
    one more corner does not change the kind of a side.
    """
    corners = {0, len(x) - 1}
    stack = [(0, len(x) - 1)]
    visits_left = _MAX_VISITS * len(x)
    while stack:
        a, b = stack.pop()
        if b - a < 2:
            continue
        visits_left -= b - a
        farthest_index, distance = _find_farthest_sample(time[a : b + 1], x[a : b + 1])
        if distance > tolerance:
            corner = a + farthest_index if visits_left > 0 or b - a < _SHORT_SPAN else (a + b) // 2
            corners.add(corner)
            stack += [(a, corner), (corner, b)]
    return sorted(corners)


def _find_farthest_sample(time: FloatArray, x: FloatArray) -> tuple[int, float]:
    """Return the sample of a span farthest from the line between its ends, and its distance."""
    if len(x) < _LOOP_SPAN and time[-1] > time[0]:  # a loop costs less than the calls of NumPy
        (t, *_, end), (low, *_, high) = times, values = time.tolist(), x.tolist()
        rise_of_line, span = high - low, end - t
        line_distances = [
            abs(v - (low + rise_of_line * (u - t) / span))
            for u, v in zip(times, values, strict=True)
        ]
        largest = max(line_distances)
        return line_distances.index(largest), largest
    line = x[0] + (x[-1] - x[0]) * (time - time[0]) / (time[-1] - time[0])
    distance = np.abs(x - line)
    farthest_index = int(np.argmax(distance))
    return farthest_index, float(distance[farthest_index])


def _classify_sides(time: FloatArray, x: FloatArray, travel: float) -> list[_Kind]:
    """Return the kind of each side of the polygon: moves are fast or long."""
    steps = np.diff(x)
    speed = np.abs(steps) / np.diff(time)
    is_long = np.abs(steps) > _MIN_MOVE * travel
    fastest = speed[is_long].max() if is_long.any() else speed.max()
    is_moving = (speed > 0.02 * fastest) | (np.abs(steps) > 0.25 * travel)
    return [
        "hold" if not is_move else "load" if step > 0 else "unload"
        for is_move, step in zip(is_moving, steps, strict=True)
    ]


def _merge_neighbours(sides: Iterable[_Side]) -> list[_Side]:
    """Return the sides, with neighbours of one kind merged."""
    merged: list[_Side] = []
    for kind, first, last in sides:
        continues = bool(merged) and merged[-1][0] == kind
        merged.append((kind, merged.pop()[1] if continues else first, last))
    return merged


def _merge_small_moves(
    sides: list[_Side], time: FloatArray, x: FloatArray, travel: float
) -> list[_Side]:
    """Merge small moves into the hold beside them, then short stops into their ramp."""
    sides = _merge_neighbours(_merge_steps(_merge_neighbours(_merge_ringing(sides, x)), time))
    sides = _merge_neighbours(
        [
            ("hold" if abs(x[last] - x[first]) < _MIN_MOVE * travel else kind, first, last)
            for kind, first, last in sides
        ]
    )
    bridged = list(sides)
    for i in range(1, len(sides) - 1):
        (kind_before, start, _), (kind, first, last), (kind_after, _, end) = sides[i - 1 : i + 2]
        is_brief = time[last] - time[first] < 0.05 * (time[end] - time[start])
        if kind == "hold" and is_brief and kind_before == kind_after:
            bridged[i] = (kind_before, first, last)
    return _merge_neighbours(bridged)


def _merge_steps(sides: list[_Side], time: FloatArray) -> list[_Side]:
    """Return the sides with the short stops of a stepping axis as parts of its ramp."""
    longest_hold = max((time[b] - time[a] for kind, a, b in sides if kind == "hold"), default=0.0)
    merged = list(sides)
    for i in range(1, len(sides) - 1):
        kind_before, (kind, first, last), kind_after = sides[i - 1][0], sides[i], sides[i + 1][0]
        if (
            kind == "hold"
            and time[last] - time[first] <= _MIN_STOP * longest_hold
            and kind_before == kind_after
        ):
            merged[i] = (kind_before, first, last)
    return merged


def _merge_ringing(sides: list[_Side], x: FloatArray) -> list[_Side]:
    """Return the sides with ringing as a hold: moves after a ramp of less than 30 % of it."""
    merged: list[_Side] = []
    ramp = 0.0
    for kind, first, last in sides:
        change = abs(x[last] - x[first])
        is_ringing = kind != "hold" and 0 < change < 0.3 * ramp
        merged.append(("hold" if is_ringing else kind, first, last))
        if not is_ringing:
            ramp = 0.0 if kind == "hold" else change
    return merged


_MAX_LISTED = 3
"""Number of loadings that a message lists."""
_MIN_HOLD = 0.2
"""A stop shorter than this part of the ramp before it is a turning point, not a hold."""


class RampHoldCycle(NamedTuple):
    """One loading of the seal: a rest, at least one ramp, at least one hold.

    Attributes
    ----------
    rest : MotionSegment or None
        The hold before the first ramp; None if the record starts on the ramp.
    segments : tuple of MotionSegment
        From the first ramp to the last hold.
    """

    rest: MotionSegment | None
    segments: tuple[MotionSegment, ...]

    @property
    def ramp(self) -> MotionSegment:
        """The first ramp."""
        return self.segments[0]

    @property
    def hold(self) -> MotionSegment:
        """The last hold."""
        return self.segments[-1]

    @property
    def ramp_count(self) -> int:
        """Number of ramps, up or down, between the rest and the last hold."""
        return sum(segment.kind != "hold" for segment in self.segments)

    def words(self) -> str:
        """Return every segment as text."""
        return ", ".join(_format_segment(segment) for segment in self.segments)


def find_cycles(segments: tuple[MotionSegment, ...]) -> tuple[RampHoldCycle, ...]:
    """Return the loadings with a hold, in order; data after the last hold are omitted.

    A loading ends where the displacement comes back to within 10 % of where it began: there the
    plate may leave the seal, and no linear solid describes what follows.
    """
    cycles: list[RampHoldCycle] = []
    rest_segment: MotionSegment | None = None
    loading: list[MotionSegment] = []
    top_level = 0.0
    for segment in segments:
        if not loading:
            if segment.kind == "load":
                loading, top_level = [segment], segment.level
            else:
                rest_segment = segment if segment.kind == "hold" else None
            continue
        loading.append(segment)
        start, top_level = loading[0].origin, max(top_level, segment.level)
        if segment.kind == "unload" and segment.level <= start + 0.1 * (top_level - start):
            cycles += _close_loading(rest_segment, loading)
            loading, rest_segment = [], None
    return tuple(cycles + _close_loading(rest_segment, loading))


def choose_cycle(
    segments: tuple[MotionSegment, ...], number: int | None, *, location: str
) -> tuple[int, tuple[RampHoldCycle, ...]]:
    """Return the index of the loading to be used, and all of them; there is at least one.

    Parameters
    ----------
    segments : tuple of MotionSegment
    number : int or None
        Counted from 1; None takes the longest hold.
    location : str
        Name of the record, for the error.

    Raises
    ------
    DataError
        If there is no such loading.
    """
    cycles = find_cycles(segments)
    if number is None:
        return int(np.argmax([cycle.hold.duration for cycle in cycles])), cycles
    if not 1 <= number <= len(cycles):
        raise DataError(
            f"{location}: cycle {number} was asked for, but the record holds "
            f"{format_cycles(cycles)}"
        )
    return number - 1, cycles


def format_cycles(cycles: tuple[RampHoldCycle, ...]) -> str:
    """Return the loadings of a record as text, numbered."""
    lines = [f"cycle {i}: {cycle.words()}" for i, cycle in enumerate(cycles, start=1)]
    if len(lines) > _MAX_LISTED:
        lines = [*lines[: _MAX_LISTED - 1], "...", lines[-1]]
    count = f"{len(cycles)} loading{'s' * (len(cycles) > 1)}"
    return f"{count} ({'; '.join(lines)})"


def explain_missing_hold(segments: tuple[MotionSegment, ...], name: str, advice: str) -> str:
    """Return the message for a record without a ramp and a hold."""
    loading = classify_loading(segments)
    if loading == "still":
        return f"{name}: the displacement never moves by more than its scatter. {sentence(advice)}"
    segments_text = ", ".join(_format_segment(segment) for segment in segments[:4])
    more_text = f", and {len(segments) - 4} more" if len(segments) > 4 else ""
    names = {"cld": "a triangle, a ramp up and down", "cyclic": "a cyclic (fatigue) run"}
    if loading in names:
        return (
            f"{name}: there is no hold, but {names[loading]} ({segments_text}{more_text}). "
            "Relaxation times need a ramp and then a hold. For force and hysteresis use dashpot fit"
        )
    return (
        f"{name}: no hold after a ramp was found. The displacement shows "
        f"{segments_text}{more_text}. {sentence(advice)}"
    )


Loading: TypeAlias = Literal["relaxation", "creep", "cld", "cyclic", "still", "other"]


def classify_loading(segments: tuple[MotionSegment, ...]) -> Loading:
    """Return the loading of a displacement: ramp and hold, triangle, cycles, none, other."""
    if find_cycles(segments):
        return "relaxation"
    moving_kinds = [segment.kind for segment in segments if segment.kind != "hold"]
    if not moving_kinds:
        return "still"
    if {"load", "unload"} == set(moving_kinds):
        return "cld" if len(moving_kinds) == 2 else "cyclic" if len(moving_kinds) > 3 else "other"
    return "other"


def _close_loading(
    rest_segment: MotionSegment | None, segments: list[MotionSegment]
) -> list[RampHoldCycle]:
    """Return a loading up to its last hold, if it has one."""
    for stop in range(len(segments), 1, -1):
        hold, loading = segments[stop - 1], segments[stop - 2]
        is_long = hold.last - hold.first >= 3 and hold.duration >= _MIN_HOLD * loading.duration
        if hold.kind == "hold" and is_long:
            return [RampHoldCycle(rest_segment, tuple(segments[:stop]))]
    return []


def _format_segment(segment: MotionSegment) -> str:
    if segment.kind == "hold":
        return f"hold {segment.start:.5g} to {segment.end:.5g} s"
    verb = "ramp" if segment.kind == "load" else "unloading"
    quantity = format_quantity(segment.level - segment.origin, "mm", "+.4g")
    return f"{verb} {segment.start:.5g} to {segment.end:.5g} s by {quantity}"


# Kind of loading: ramp and hold, creep, compression and release, cycles.


MAX_HELD_CHANGE = 0.01
"""Over its rise, most that a held signal changes."""
MIN_CREEP = 0.02
"""Over its travel, least displacement under a held force that is creep."""
MAX_SPEED_CHANGE = 0.05
"""Over the move, most that the displacement at a quarter of the time differs from a quarter."""
PART_COUNT = 10
"""Number of parts of a record whose means are compared."""
MIN_DRIFT = 0.1
"""Over its travel, least change from start to end that is more than scatter."""
MAX_SETTLING = 0.05
"""Over its value, most that a displacement held from the first sample moves."""


def classify_load_history(time: FloatArray, displacement: FloatArray, force: FloatArray) -> Loading:
    """Return the loading that a record shows, whether or not it can be prepared.

    Ramps up and down at one speed are compression load deflection; a sine is not.

    Parameters
    ----------
    time, displacement, force : array, shape (n,)
        s, m and N, sign and zero as recorded; a strain and a stress show the same.
    """
    if is_held_throughout(force) and is_drifting(displacement):
        return "creep"
    sign, segments = find_rising_sign(time, displacement)
    if is_creep_test(time, sign * displacement, force, segments):
        return "creep"
    if begins_in_hold(displacement, force):
        return "other"
    if is_at_one_speed(time, sign * displacement, segments):
        return "cld"
    return classify_loading(segments)


def is_creep_test(
    time: FloatArray, x: FloatArray, force: FloatArray, segments: tuple[MotionSegment, ...]
) -> bool:
    """Return whether a record from its beginning on shows creep, and no strokes at one speed."""
    is_displacement_controlled = begins_in_hold(x, force) or is_at_one_speed(time, x, segments)
    return not is_displacement_controlled and is_creep(time, x, force, find_cycles(segments))


def is_held_throughout(force: FloatArray) -> bool:
    """Return whether a force is constant, apart from scatter, over the whole record."""
    means = [float(part.mean()) for part in np.array_split(force, min(PART_COUNT, len(force)))]
    return float(np.ptp(means)) < MAX_HELD_CHANGE * abs(median(force))


def is_drifting(x: FloatArray) -> bool:
    """Return whether a signal ends, by more than a tenth of its travel, elsewhere than it began."""
    tenth = max(len(x) // 10, 1)
    return abs(float(x[-tenth:].mean() - x[:tenth].mean())) > MIN_DRIFT * float(np.ptp(x))


def find_rising_sign(
    time: FloatArray, displacement: FloatArray, resolution: float | None = None
) -> tuple[int, tuple[MotionSegment, ...]]:
    """Return the sign that makes the first ramp rise, and the segments of the signed record."""
    segments = find_segments(time, displacement, resolution)
    if _begins_with_unloading(segments):
        return -1, negate_segments(segments)
    return 1, segments


def is_at_one_speed(time: FloatArray, x: FloatArray, segments: Sequence[MotionSegment]) -> bool:
    """Return whether a compression goes in and out at one speed, without a hold."""
    moves = [segment for segment in segments if segment.kind != "hold"]
    to_and_fro = {segment.kind for segment in moves} == {"load", "unload"}
    has_hold = bool(find_cycles(tuple(segments)))
    return to_and_fro and not has_hold and all(_is_straight(time, x, segment) for segment in moves)


def _is_straight(time: FloatArray, x: FloatArray, move: MotionSegment) -> bool:
    """Return whether a quarter of a move takes a quarter of its time; a sine lags by 0.1."""
    quarter = float(np.interp(move.start + 0.25 * move.duration, time, x))
    return abs((quarter - move.origin) / (move.level - move.origin) - 0.25) < MAX_SPEED_CHANGE


def _begins_with_unloading(segments: Sequence[MotionSegment]) -> bool:
    moving_kinds = [segment.kind for segment in segments if segment.kind != "hold"]
    return moving_kinds[:1] == ["unload"]


def is_force_held(time: FloatArray, force: FloatArray) -> bool:
    """Return whether the force is ramped and then held, as a controlled plate is."""
    return any(
        _is_constant_over_hold(force, cycle) for cycle in find_cycles(find_segments(time, force))
    )


def _is_constant_over_hold(values: FloatArray, cycle: RampHoldCycle) -> bool:
    """Return whether a signal is constant over the hold of a cycle."""
    travel = cycle.hold.level - cycle.ramp.origin
    return abs(_compute_change_over_hold(values, cycle.hold)) < MAX_HELD_CHANGE * travel


def _compute_change_over_hold(values: FloatArray, hold: MotionSegment) -> float:
    """Return the change of a signal from the first tenth of a hold to the last."""
    hold_values = values[hold.first : hold.last + 1]
    tenth = max(len(hold_values) // 10, 1)
    return float(hold_values[-tenth:].mean() - hold_values[:tenth].mean())


def is_creep(
    time: FloatArray, x: FloatArray, force: FloatArray, displacement_cycles: Sequence[RampHoldCycle]
) -> bool:
    """Return whether the force is ramped and held while the displacement creeps.

    A record whose displacement is constant in each of `displacement_cycles` is none.
    """
    least_creep = MIN_CREEP * float(np.ptp(x))
    if displacement_cycles and all(
        abs(_compute_change_over_hold(x, cycle.hold)) <= least_creep
        for cycle in displacement_cycles
    ):
        return False
    force_segments = find_segments(time, force)
    for sign, segments in ((1, force_segments), (-1, negate_segments(force_segments))):
        for cycle in find_cycles(segments):
            ramp_change = float(x[cycle.ramp.last] - x[cycle.ramp.first])
            creep = _compute_change_over_hold(x, cycle.hold) * np.sign(ramp_change)
            if creep > least_creep and _is_constant_over_hold(sign * force, cycle):
                return True
    return False


def begins_in_hold(x: FloatArray, force: FloatArray) -> bool:
    """Return whether a record begins in the hold: the displacement settles, the force relaxes."""
    return float(np.ptp(x)) < MAX_SETTLING * abs(median(x)) and relaxes(force)


def relaxes(force: FloatArray) -> bool:
    """Return whether a force falls from its first tenth to its last by more than its scatter."""
    tenth = max(len(force) // 10, 1)
    first, last = force[:tenth], force[-tenth:]
    decrease = abs(float(first.mean())) - abs(float(last.mean()))
    return decrease > max(MAX_HELD_CHANGE * abs(float(first.mean())), 4 * float(last.std()))
