"""From a raw creep test to a load and its hold."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray, median
from dashpot.base.errors import DataError
from dashpot.base.provenance import Step
from dashpot.preparation import checks
from dashpot.preparation.denoising import SCATTER_OF_A_COUNT, between_counts, denoised
from dashpot.preparation.noise import scatter, without_spikes
from dashpot.preparation.segments import cycles_of, find_segments
from dashpot.records.creep import CreepTest, LoadHold
from dashpot.records.relaxation import quantum

_FEWEST = 8
# a load of more corners is no ramp and hold; steps and tolerance of the search for their times
_MOST_CORNERS, _STEPS, _PART, _SETTLED = 16, 20, 0.3, 1e-9
# a mean of white noise is that many standard deviations off once in a million
_CHANCE = 5.0


class _Held(NamedTuple):
    """Times of a load, s, its level, the force before it, and the sign that makes it rise."""

    onset: float
    ramp_end: float
    hold_end: float
    level: float
    preload: float
    turn: int


def load_hold(test: CreepTest) -> LoadHold:
    """Find the load and its hold, turn both signals so that they rise; change nothing else.

    The load is read from the force alone. A record that begins under load is a step at its first
    sample. What follows the hold, such as a recovery, stays part of the record: the recorded
    force is the input of the fit, whatever it does.

    Parameters
    ----------
    test : CreepTest

    Raises
    ------
    DataError
        If no force is held, or the displacement does not follow it.
    """
    where = test.source.file if test.source is not None else "the record"
    force = without_spikes(test.time, test.force)
    held = _held(test.time, force, where)
    pressed = held.turn * test.force - held.preload
    noise = scatter(test.time, test.force)
    load = _freed(test.time, held.turn * force - held.preload, noise)
    if held.ramp_end > test.time[0]:
        load = load - load[0]
    turn = _turn(test, held, where)
    record = LoadHold(
        time=test.time,
        displacement=turn * test.displacement,
        force=pressed,
        load=load,
        onset=held.onset,
        ramp_end=held.ramp_end,
        hold_end=held.hold_end,
        level=held.level,
        preload=held.preload,
        displacement_noise=scatter(test.time, test.displacement),
        force_noise=noise,
        unit=test.unit,
        specimen=test.specimen,
        source=test.source,
        steps=(_step(held, turn, test.unit),),
    )
    answers = (checks.load_begins_at_rest(record), checks.load_held(record))
    return replace(record, checks=answers)


def _held(time: FloatArray, force: FloatArray, where: str) -> _Held:
    """The load with the longest hold."""
    found = [_cycle(time, turn * force, turn) for turn in (1, -1)]
    loads = [one for one in found if one is not None]
    if loads:
        return max(loads, key=lambda one: (one.hold_end - one.ramp_end, one.turn))
    level = median(force)
    turn = 1 if level > 0 else -1
    if not abs(level) > 4 * float(np.std(force)):
        raise DataError(
            f"{where}: no force is held: expected a load that rises and then stays, or stays from "
            "the first sample on; check which column is the force (--force, --stress)"
        )
    return _Held(float(time[0]), float(time[0]), float(time[-1]), abs(level), 0.0, turn)


def _cycle(time: FloatArray, force: FloatArray, turn: int) -> _Held | None:
    """The longest hold of a force that rises, and when its load began."""
    cycles = cycles_of(find_segments(time, force))
    holds = [(cycle, one) for cycle in cycles for one in cycle.segments if one.kind == "hold"]
    if not holds:
        return None
    cycle, hold = max(holds, key=lambda pair: pair[1].duration)
    before = force[: cycle.ramp.first + 1]
    # a record that begins on its load ramp begins at its first reading
    preload = median(before) if len(before) >= _FEWEST else float(force[0])
    level = hold.level - preload
    if not level > 0 or hold.last - hold.first < _FEWEST:
        return None
    at = cycle.segments.index(hold)
    ramp = cycle.segments[at - 1]
    return _Held(float(cycle.ramp.start), float(ramp.end), float(hold.end), level, preload, turn)


def _turn(test: CreepTest, held: _Held, where: str) -> int:
    """The sign that makes the displacement rise under the load."""
    time, x = test.time, test.displacement
    hold = (time >= held.ramp_end) & (time <= held.hold_end)
    begin = x[time <= held.onset]
    moved = float(x[hold][-max(1, hold.sum() // 10) :].mean()) - median(begin)
    if moved == 0:
        raise DataError(
            f"{where}: the displacement does not move under the load; check which column it is "
            "(--displacement, --strain)"
        )
    return 1 if moved > 0 else -1


def _freed(time: FloatArray, force: FloatArray, noise: float) -> FloatArray:
    """The load behind its readings, freed of counts and of noise (errors in variables).

    Ramps and holds that are straight to their noise are straight; any other load is the mean over
    windows as wide as noise alone explains.
    """
    step = quantum(force)
    if noise == 0:
        return force
    straight = _straight(time, force)
    if straight is not None and _is_noise(force - straight, noise, step):
        return straight
    if noise <= 0.5 * step:
        return denoised(between_counts(time, force), SCATTER_OF_A_COUNT * step)[0]
    return denoised(force, noise)[0]


def _straight(time: FloatArray, force: FloatArray) -> FloatArray | None:
    """The load as straight lines between corners, each corner where least squares puts it.

    Gauss-Newton on the corners' times; their heights are linear. None for a load of many corners.
    """
    knots = np.array([time[0], *(one.end for one in find_segments(time, force))])
    if len(knots) > _MOST_CORNERS:
        return None
    for _ in range(_STEPS):
        tents = np.stack([np.interp(time, knots, one) for one in np.eye(len(knots))], axis=1)
        heights = np.linalg.lstsq(tents, force, rcond=None)[0]
        slopes = np.diff(heights) / np.diff(knots)
        leaning = [
            -tents[:, j] * np.where(time <= knots[j], slopes[j - 1], slopes[j])
            for j in range(1, len(knots) - 1)
        ]
        if not leaning:
            break
        both = np.column_stack((tents, *leaning))
        moved = np.linalg.lstsq(both, force - tents @ heights, rcond=None)[0][len(knots) :]
        room = _PART * np.minimum(np.diff(knots)[:-1], np.diff(knots)[1:])
        knots[1:-1] += np.clip(moved, -room, room)
        if float(np.abs(moved).max()) < _SETTLED * (time[-1] - time[0]):
            break
    return np.asarray(np.interp(time, knots, heights))


def _is_noise(left: FloatArray, noise: float, step: float) -> bool:
    """True if means over 1, 2, 4, ... neighbours are no larger than white noise makes them."""
    width = 1
    while len(left) // width >= 2:
        means = left[: len(left) // width * width].reshape(-1, width).mean(axis=1)
        if float(np.abs(means).max()) > _CHANCE * noise / np.sqrt(width) + 0.5 * step:
            return False
        width *= 2
    return True


def _step(held: _Held, turn: int, unit: str) -> Step:
    word = "N" if unit == "N/m" else "Pa"
    begun = f"the load of {held.level:.4g} {word} rises from {held.onset:.5g} s and is held from "
    says = (
        f"{begun}{held.ramp_end:.5g} to {held.hold_end:.5g} s, after {held.preload:.3g} {word} of "
        "preload; the recorded force, freed of its noise, is what the fit answers"
    )
    options = (("force turned", str(held.turn)), ("displacement turned", str(turn)))
    return Step("load_hold", options, says)
