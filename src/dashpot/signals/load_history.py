"""What a record shows: a ramp and a hold, creep under a held force, a press and release, cycles."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base.arrays import FloatArray, median
from dashpot.signals.segments import (
    Loading,
    MotionSegment,
    RampHoldCycle,
    cycles_of,
    find_segments,
    loading_of,
    negate_segments,
)

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
    if began_late(displacement, force):
        return "other"
    if is_at_one_speed(time, turn * displacement, segments):
        return "cld"
    if is_creep(time, turn * displacement, force, cycles_of(segments)):
        return "creep"
    return loading_of(segments)


def held_throughout(force: FloatArray) -> bool:
    """Whether a load was on before the record began, and stays, whatever its samples scatter."""
    means = [float(part.mean()) for part in np.array_split(force, min(PARTS, len(force)))]
    return float(np.ptp(means)) < STEADY * abs(median(force))


def goes_on(x: FloatArray) -> bool:
    """Whether a signal ends, by more than a tenth of its travel, elsewhere than it began."""
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
    """Whether a compression goes in and back at one speed, and is never held."""
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
    """True if the force ramps and then stands as still as a plate does."""
    return any(_stands(force, cycle) for cycle in cycles_of(find_segments(time, force)))


def _stands(values: FloatArray, cycle: RampHoldCycle) -> bool:
    """Whether a signal stays where it was ramped to, whatever the displacement does."""
    rise = cycle.hold.level - cycle.ramp.origin
    return abs(_change(values, cycle.hold)) < STEADY * rise


def _change(values: FloatArray, hold: MotionSegment) -> float:
    """How far a signal goes from the first tenth of a hold to the last."""
    held = values[hold.first : hold.last + 1]
    tenth = max(len(held) // 10, 1)
    return float(held[-tenth:].mean() - held[:tenth].mean())


def is_creep(
    time: FloatArray, x: FloatArray, force: FloatArray, held: Sequence[RampHoldCycle]
) -> bool:
    """True if it is the force that is ramped and held, while the displacement goes on.

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
    """True if a force falls, from its first tenth to its last, by more than it scatters."""
    tenth = max(len(force) // 10, 1)
    first, last = force[:tenth], force[-tenth:]
    fell = abs(float(first.mean())) - abs(float(last.mean()))
    return fell > max(STEADY * abs(float(first.mean())), 4 * float(last.std()))
