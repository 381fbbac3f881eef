"""Segments of a recorded displacement: ramps, holds, and the kind of test they form."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from dashpot.base.arrays import FloatArray, median
from dashpot.base.errors import DataError
from dashpot.base.plain_text import sentence
from dashpot.base.units import format_quantity
from dashpot.datamodel.relaxation import quantum
from dashpot.signals.noise import estimate_robust_scatter, median_of_three

# Ramps and holds, and the loadings that they form.


_LEAST_MOVE = 0.05
"""A move smaller than this part of the whole travel is settling, not a ramp."""


_STOP = 0.01
"""A stop shorter than this part of the longest hold interrupts a ramp, and does not end it."""
_LOOKS = 64
"""As often may every sample be looked at for a corner; then all but short stretches are halved."""
_SHORT, _FEW = 1024, 32
"""Samples of a stretch."""


_Kind: TypeAlias = Literal["hold", "load", "unload"]
_Side: TypeAlias = tuple[_Kind, int, int]
_TURNED: dict[_Kind, _Kind] = {"hold": "hold", "load": "unload", "unload": "load"}


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
        resolution = resolution_of(time, displacement, quantum(displacement))
    if travel <= 4 * resolution:
        return (_segment("hold", time, x, 0, len(x) - 1),)
    corners = _polygon(time, x, max(2 * resolution, 0.01 * travel))
    kinds = _kinds(time[corners], x[corners], travel)
    sides = _merge_neighbours(zip(kinds, corners, corners[1:], strict=False))
    sides = _merge_small_moves(sides, time, x, travel)
    return tuple(_segment(kind, time, x, first, last) for kind, first, last in sides)


def negate_segments(segments: Iterable[MotionSegment]) -> tuple[MotionSegment, ...]:
    """Return what :func:`find_segments` finds of the same record with its sign turned."""
    return tuple(
        part._replace(kind=_TURNED[part.kind], origin=-part.origin, level=-part.level)
        for part in segments
    )


def resolution_of(time: FloatArray, displacement: FloatArray, count: float) -> float:
    """What a displacement can differ by without having moved, m: 4 sigma, and half a quantum."""
    return 4 * estimate_robust_scatter(time, displacement) + 0.5 * count


def _segment(
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


def _polygon(time: FloatArray, x: FloatArray, tolerance: float) -> list[int]:
    """Corners of the coarsest polygon within `tolerance` (Ramer, Douglas and Peucker).

    Thousands of cycles of one size would each be cut off the whole rest, which takes the square
    of their number: a record that was looked at so often is halved, where a corner more is none
    of another kind.
    """
    corners = {0, len(x) - 1}
    stack = [(0, len(x) - 1)]
    remaining = _LOOKS * len(x)
    while stack:
        a, b = stack.pop()
        if b - a < 2:
            continue
        remaining -= b - a
        worst, miss = _find_farthest_sample(time[a : b + 1], x[a : b + 1])
        if miss > tolerance:
            corner = a + worst if remaining > 0 or b - a < _SHORT else (a + b) // 2
            corners.add(corner)
            stack += [(a, corner), (corner, b)]
    return sorted(corners)


def _find_farthest_sample(time: FloatArray, x: FloatArray) -> tuple[int, float]:
    """The sample of a stretch that is farthest from the line between its ends, and how far."""
    if len(x) < _FEW and time[-1] > time[0]:  # a loop costs less than the calls of NumPy
        (t, *_, end), (low, *_, high) = times, values = time.tolist(), x.tolist()
        rise, span = high - low, end - t
        off = [abs(v - (low + rise * (u - t) / span)) for u, v in zip(times, values, strict=True)]
        far = max(off)
        return off.index(far), far
    line = x[0] + (x[-1] - x[0]) * (time - time[0]) / (time[-1] - time[0])
    miss = np.abs(x - line)
    worst = int(np.argmax(miss))
    return worst, float(miss[worst])


def _kinds(time: FloatArray, x: FloatArray, travel: float) -> list[_Kind]:
    steps = np.diff(x)
    speed = np.abs(steps) / np.diff(time)
    long = np.abs(steps) > _LEAST_MOVE * travel
    fastest = speed[long].max() if long.any() else speed.max()
    moving = (speed > 0.02 * fastest) | (np.abs(steps) > 0.25 * travel)
    return [
        "hold" if not moves else "load" if step > 0 else "unload"
        for moves, step in zip(moving, steps, strict=True)
    ]


def _merge_neighbours(sides: Iterable[_Side]) -> list[_Side]:
    """Make one side of neighbours of one kind."""
    joined: list[_Side] = []
    for kind, first, last in sides:
        goes_on = bool(joined) and joined[-1][0] == kind
        joined.append((kind, joined.pop()[1] if goes_on else first, last))
    return joined


def _merge_small_moves(
    sides: list[_Side], time: FloatArray, x: FloatArray, travel: float
) -> list[_Side]:
    """Give small moves to the hold beside them, then bridge stutters within a ramp."""
    sides = _merge_neighbours(_merge_steps(_merge_neighbours(_rung_out(sides, x)), time))
    sides = _merge_neighbours(
        [
            ("hold" if abs(x[last] - x[first]) < _LEAST_MOVE * travel else kind, first, last)
            for kind, first, last in sides
        ]
    )
    bridged = list(sides)
    for i in range(1, len(sides) - 1):
        (before, start, _), (kind, first, last), (after, _, end) = sides[i - 1 : i + 2]
        brief = time[last] - time[first] < 0.05 * (time[end] - time[start])
        if kind == "hold" and brief and before == after:
            bridged[i] = (before, first, last)
    return _merge_neighbours(bridged)


def _merge_steps(sides: list[_Side], time: FloatArray) -> list[_Side]:
    """Call the stops of an axis that climbs in steps a part of its ramp."""
    longest = max((time[b] - time[a] for kind, a, b in sides if kind == "hold"), default=0.0)
    climbed = list(sides)
    for i in range(1, len(sides) - 1):
        before, (kind, first, last), after = sides[i - 1][0], sides[i], sides[i + 1][0]
        if kind == "hold" and time[last] - time[first] <= _STOP * longest and before == after:
            climbed[i] = (before, first, last)
    return climbed


def _rung_out(sides: list[_Side], x: FloatArray) -> list[_Side]:
    """Call ringing a hold: to and fro right after a ramp, by less than 30 % of it."""
    settled: list[_Side] = []
    ramp = 0.0
    for kind, first, last in sides:
        change = abs(x[last] - x[first])
        ringing = kind != "hold" and 0 < change < 0.3 * ramp
        settled.append(("hold" if ringing else kind, first, last))
        if not ringing:
            ramp = 0.0 if kind == "hold" else change
    return settled


_LISTED = 3
"""As many loadings are listed one by one."""
_LEAST_HOLD = 0.2
"""A stop shorter than this part of the ramp before it is a turning point, not a hold."""


class RampHoldCycle(NamedTuple):
    """One loading of the seal: a rest, at least one ramp, at least one hold.

    Attributes
    ----------
    rest : MotionSegment or None
        The stand before the first ramp; None if the record starts on the ramp.
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
    def moves(self) -> int:
        """Number of ramps, up or down, between the rest and the last hold."""
        return sum(segment.kind != "hold" for segment in self.segments)

    def words(self) -> str:
        """Return every segment, in words."""
        return ", ".join(_format_segment(segment) for segment in self.segments)


def cycles_of(segments: tuple[MotionSegment, ...]) -> tuple[RampHoldCycle, ...]:
    """Return the loadings that hold, in order; whatever follows the last hold is left out.

    A loading ends where the displacement comes back to within 10 % of where it began: there the
    plate may leave the seal, and no linear solid describes what follows.
    """
    cycles: list[RampHoldCycle] = []
    rest: MotionSegment | None = None
    current: list[MotionSegment] = []
    top = 0.0
    for segment in segments:
        if not current:
            if segment.kind == "load":
                current, top = [segment], segment.level
            else:
                rest = segment if segment.kind == "hold" else None
            continue
        current.append(segment)
        begin, top = current[0].origin, max(top, segment.level)
        if segment.kind == "unload" and segment.level <= begin + 0.1 * (top - begin):
            cycles += _close_loading(rest, current)
            current, rest = [], None
    return tuple(cycles + _close_loading(rest, current))


def choose_cycle(
    segments: tuple[MotionSegment, ...], number: int | None, *, where: str
) -> tuple[int, tuple[RampHoldCycle, ...]]:
    """Return the index of the loading to be used, and all of them; there is at least one.

    Parameters
    ----------
    segments : tuple of MotionSegment
    number : int or None
        Counted from 1; None takes the longest hold.
    where : str
        Name of the record, for the error.

    Raises
    ------
    DataError
        If there is no such loading.
    """
    cycles = cycles_of(segments)
    if number is None:
        return int(np.argmax([cycle.hold.duration for cycle in cycles])), cycles
    if not 1 <= number <= len(cycles):
        raise DataError(
            f"{where}: cycle {number} was asked for, but the record holds {format_cycles(cycles)}"
        )
    return number - 1, cycles


def format_cycles(cycles: tuple[RampHoldCycle, ...]) -> str:
    """Return the choices, in words."""
    parts = [f"cycle {i}: {cycle.words()}" for i, cycle in enumerate(cycles, start=1)]
    if len(parts) > _LISTED:
        parts = [*parts[: _LISTED - 1], "...", parts[-1]]
    count = f"{len(cycles)} loading{'s' * (len(cycles) > 1)}"
    return f"{count} ({'; '.join(parts)})"


def nothing_held(segments: tuple[MotionSegment, ...], where: str, advice: str) -> str:
    """Return the sentence for a record without a ramp and a hold."""
    text = loading_of(segments)
    if text == "still":
        return f"{where}: the displacement never moves by more than its scatter. {sentence(advice)}"
    shown = ", ".join(_format_segment(segment) for segment in segments[:4])
    more = f", and {len(segments) - 4} more" if len(segments) > 4 else ""
    names = {"cld": "a triangle, a ramp up and down", "cyclic": "a cyclic (fatigue) run"}
    if text in names:
        return (
            f"{where}: there is no hold, but {names[text]} ({shown}{more}). Relaxation times need "
            "a ramp and then a rest. For force and hysteresis use dashpot fit"
        )
    return (
        f"{where}: no hold after a ramp was found. The displacement shows {shown}{more}. "
        f"{sentence(advice)}"
    )


Loading: TypeAlias = Literal["relaxation", "creep", "cld", "cyclic", "still", "other"]


def loading_of(segments: tuple[MotionSegment, ...]) -> Loading:
    """Return the loading of a displacement: ramp and hold, triangle, cycles, none, other."""
    if cycles_of(segments):
        return "relaxation"
    moves = [segment.kind for segment in segments if segment.kind != "hold"]
    if not moves:
        return "still"
    if {"load", "unload"} == set(moves):
        return "cld" if len(moves) == 2 else "cyclic" if len(moves) > 3 else "other"
    return "other"


def _close_loading(rest: MotionSegment | None, parts: list[MotionSegment]) -> list[RampHoldCycle]:
    """Return a loading up to its last hold, if it has one."""
    for stop in range(len(parts), 1, -1):
        hold, before = parts[stop - 1], parts[stop - 2]
        enough = hold.last - hold.first >= 3 and hold.duration >= _LEAST_HOLD * before.duration
        if hold.kind == "hold" and enough:
            return [RampHoldCycle(rest, tuple(parts[:stop]))]
    return []


def _format_segment(segment: MotionSegment) -> str:
    if segment.kind == "hold":
        return f"hold {segment.start:.5g} to {segment.end:.5g} s"
    verb = "ramp" if segment.kind == "load" else "unloading"
    quantity = format_quantity(segment.level - segment.origin, "mm", "+.4g")
    return f"{verb} {segment.start:.5g} to {segment.end:.5g} s by {quantity}"


# Kind of loading: ramp and hold, creep, compression and release, cycles.


STEADY = 0.01
"""Part of its rise by which a held signal may change."""
CREPT = 0.02
"""Part of its travel by which a displacement goes on under a force that is held."""
EVEN = 0.05
"""Part of a move by which a quarter of it may be early or late where its speed is even."""
PARTS = 10
"""Of a record, whose means are held against each other."""
GONE = 0.1
"""Part of its travel by which a signal ends elsewhere that does not only scatter."""
SETTLES = 0.05
"""Part of its level by which a displacement may move that is held from the first sample on."""


def classify_load_history(time: FloatArray, displacement: FloatArray, force: FloatArray) -> Loading:
    """What a record shows, whether or not it can be prepared: a ramp and a hold, or what else.

    Ramps up and down at one speed are compression load deflection; a sine is not.

    Parameters
    ----------
    time, displacement, force : array, shape (n,)
        s, m and N, sign and zero as recorded; a strain and a stress show the same.
    """
    if held_throughout(force) and goes_on(displacement):
        return "creep"
    turn, segments = find_rising_sign(time, displacement)
    if is_creep_test(time, turn * displacement, force, segments):
        return "creep"
    if began_late(displacement, force):
        return "other"
    if is_at_one_speed(time, turn * displacement, segments):
        return "cld"
    return loading_of(segments)


def is_creep_test(
    time: FloatArray, x: FloatArray, force: FloatArray, segments: tuple[MotionSegment, ...]
) -> bool:
    """Return whether a record from its beginning on shows creep, and no strokes at one speed."""
    driven = began_late(x, force) or is_at_one_speed(time, x, segments)
    return not driven and is_creep(time, x, force, cycles_of(segments))


def held_throughout(force: FloatArray) -> bool:
    """Whether a load was on before the record began, and stays, whatever its samples scatter."""
    means = [float(part.mean()) for part in np.array_split(force, min(PARTS, len(force)))]
    return float(np.ptp(means)) < STEADY * abs(median(force))


def goes_on(x: FloatArray) -> bool:
    """Return whether a signal ends, by more than a tenth of its travel, elsewhere than it began."""
    tenth = max(len(x) // 10, 1)
    return abs(float(x[-tenth:].mean() - x[:tenth].mean())) > GONE * float(np.ptp(x))


def find_rising_sign(
    time: FloatArray, displacement: FloatArray, resolution: float | None = None
) -> tuple[int, tuple[MotionSegment, ...]]:
    """Return the sign that makes the first ramp rise, and what then is found."""
    segments = find_segments(time, displacement, resolution)
    if _falls_first(segments):
        return -1, negate_segments(segments)
    return 1, segments


def is_at_one_speed(time: FloatArray, x: FloatArray, segments: Sequence[MotionSegment]) -> bool:
    """Return whether a compression goes in and back at one speed, and is never held."""
    moves = [part for part in segments if part.kind != "hold"]
    to_and_fro = {part.kind for part in moves} == {"load", "unload"}
    held = bool(cycles_of(tuple(segments)))
    return to_and_fro and not held and all(_straight(time, x, part) for part in moves)


def _straight(time: FloatArray, x: FloatArray, part: MotionSegment) -> bool:
    """Whether a move is at a quarter of its way after a quarter of its time; a sine lags by 0.1."""
    quarter = float(np.interp(part.start + 0.25 * part.duration, time, x))
    return abs((quarter - part.origin) / (part.level - part.origin) - 0.25) < EVEN


def _falls_first(segments: Sequence[MotionSegment]) -> bool:
    moves = [part.kind for part in segments if part.kind != "hold"]
    return moves[:1] == ["unload"]


def held_by_plate(time: FloatArray, force: FloatArray) -> bool:
    """Return whether the force ramps and then stands as still as a plate does."""
    return any(_stands(force, cycle) for cycle in cycles_of(find_segments(time, force)))


def _stands(values: FloatArray, cycle: RampHoldCycle) -> bool:
    """Return whether a signal stays where it was ramped to, whatever the displacement does."""
    rise = cycle.hold.level - cycle.ramp.origin
    return abs(_change(values, cycle.hold)) < STEADY * rise


def _change(values: FloatArray, hold: MotionSegment) -> float:
    """Return how far a signal goes from the first tenth of a hold to the last."""
    held = values[hold.first : hold.last + 1]
    tenth = max(len(held) // 10, 1)
    return float(held[-tenth:].mean() - held[:tenth].mean())


def is_creep(
    time: FloatArray, x: FloatArray, force: FloatArray, held: Sequence[RampHoldCycle]
) -> bool:
    """Return whether it is the force that is ramped and held, while the displacement goes on.

    Only a displacement that is not `held` is worth the search.
    """
    far = CREPT * float(np.ptp(x))
    if held and all(abs(_change(x, cycle.hold)) <= far for cycle in held):
        return False
    pushed = find_segments(time, force)
    for turn, segments in ((1, pushed), (-1, negate_segments(pushed))):
        for cycle in cycles_of(segments):
            ramped = float(x[cycle.ramp.last] - x[cycle.ramp.first])
            onward = _change(x, cycle.hold) * np.sign(ramped)
            if onward > far and _stands(turn * force, cycle):
                return True
    return False


def began_late(x: FloatArray, force: FloatArray) -> bool:
    """True if a displacement only settles about where it is held, while the force relaxes."""
    return float(np.ptp(x)) < SETTLES * abs(median(x)) and relaxes(force)


def relaxes(force: FloatArray) -> bool:
    """Return whether a force falls, from its first tenth to its last, by more than it scatters."""
    tenth = max(len(force) // 10, 1)
    first, last = force[:tenth], force[-tenth:]
    fell = abs(float(first.mean())) - abs(float(last.mean()))
    return fell > max(STEADY * abs(float(first.mean())), 4 * float(last.std()))
