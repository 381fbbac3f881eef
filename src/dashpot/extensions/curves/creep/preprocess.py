"""Preparation of a raw creep test: its load and hold."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray, IndexArray, distinct, median
from dashpot.base.errors import DataError
from dashpot.base.provenance import Step, list_sources
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.relaxation import find_quantum
from dashpot.extensions.curves.creep import checks
from dashpot.extensions.curves.datamodel.creep import MAX_CORNERS, CreepTest, LoadHold
from dashpot.preprocessing.checks import check_machine, check_temperature, clock_steady
from dashpot.signals.noise import remove_spikes, scatter
from dashpot.signals.segments import find_cycles, find_segments

_MIN_COUNT = 8
# steps and tolerance of the search for the times of corners
_STEPS, _PART, _CORNER_TOLERANCE = 20, 0.3, 1e-9
# a mean of white noise is hardly ever so many standard deviations off, and seldom so many
_CERTAIN_SD, _UNLIKELY_SD = 6.0, 4.0
# the least readings of a part that is halved, and into how many one is cut that was
_MIN_READINGS, _QUARTERS = 8, 4
# standard deviation of a reading in counts
OF_A_COUNT = 12**-0.5
# a load with less noise than this part of it is taken as it is
_EXACT = 1e-7
# eigenvalue of a Gram matrix of a load, over the largest, up to which it counts as 0
_SINGULAR = 1e-12


class _HeldLoad(NamedTuple):
    """Times of a load, s, its level, the force before it, and the sign that makes it rise."""

    onset: float
    ramp_end: float
    hold_end: float
    level: float
    preload: float
    sign: int


def load_hold(test: CreepTest, machine: Machine | None = None) -> LoadHold:
    """Find the load and its hold, and give both signals a rising sign; change nothing else.

    The load is read from the force alone. A record that begins under load is treated as a step at
    its first sample. Samples after the hold, such as a recovery, remain in the record: the recorded
    force is the input of the fit, whatever it does.

    Parameters
    ----------
    test : CreepTest
    machine : Machine, optional
        Known properties of the machine: of a creep test its `sync`.

    Raises
    ------
    DataError
        If no force is held, the displacement does not follow it, or a property of the machine is
        stated that creep does not use.
    """
    machine = machine or Machine()
    machine.refuse_unused("sync", subject="a creep test")
    file_name = test.source.file if test.source is not None else "the record"
    force = remove_spikes(test.time, test.force)
    held_load = _find_longest_hold(test.time, force, file_name)
    preload_force = held_load.sign * test.force - held_load.preload
    noise = _estimate_force_noise(test.time, test.force, held_load)
    load, corners, heights = _remove_load_noise(
        test.time, held_load.sign * force - held_load.preload, noise
    )
    if held_load.ramp_end > test.time[0]:
        load, heights = load - load[0], heights - load[0]
    sign = _get_displacement_sign(test, held_load, file_name)
    record = LoadHold(
        time=test.time,
        displacement=sign * test.displacement,
        force=preload_force,
        load=load,
        onset=held_load.onset,
        ramp_end=held_load.ramp_end,
        hold_end=held_load.hold_end,
        level=held_load.level,
        preload=held_load.preload,
        displacement_noise=scatter(test.time, test.displacement),
        force_noise=noise,
        unit=test.unit,
        specimen=test.specimen,
        source=test.source,
        steps=(_make_step(held_load, sign, test.unit),),
        corners=tuple(corners.tolist()),
        heights=tuple(heights.tolist()),
        machine=machine,
    )
    all_checks = (
        checks.load_begins_at_rest(record),
        checks.load_held(record),
        checks.displacement_samples_not_repeated(record, test.displacement),
        clock_steady(record),
        *check_machine(
            list_sources([test]), record.level / float(np.abs(record.displacement).max())
        ),
        *check_temperature(test.specimen),
    )
    return replace(record, checks=all_checks)


def _find_longest_hold(time: FloatArray, force: FloatArray, file_name: str) -> _HeldLoad:
    """Return the load with the longest hold."""
    longest_holds = [_find_cycle(time, sign * force, sign) for sign in (1, -1)]
    loads = [hold for hold in longest_holds if hold is not None]
    if loads:
        return max(loads, key=lambda hold: (hold.hold_end - hold.ramp_end, hold.sign))
    level = median(force)
    sign = 1 if level > 0 else -1
    if not abs(level) > 4 * float(np.std(force)):
        raise DataError(
            f"{file_name}: no force is held: expected a load that rises and then stays, or stays "
            "from the first sample on; check which column is the force (--column force=NAME)"
        )
    return _HeldLoad(float(time[0]), float(time[0]), float(time[-1]), abs(level), 0.0, sign)


def _find_cycle(time: FloatArray, force: FloatArray, sign: int) -> _HeldLoad | None:
    """Return the longest hold of a force that rises, and when its load began."""
    cycles = find_cycles(find_segments(time, force))
    cycle_holds = [
        (cycle, segment) for cycle in cycles for segment in cycle.segments if segment.kind == "hold"
    ]
    if not cycle_holds:
        return None
    cycle, hold = max(cycle_holds, key=lambda pair: pair[1].duration)
    force_before = force[: cycle.ramp.first + 1]
    # a record that begins on its load ramp begins at its first reading
    preload = median(force_before) if len(force_before) >= _MIN_COUNT else float(force[0])
    level = hold.level - preload
    if not level > 0 or hold.last - hold.first < _MIN_COUNT:
        return None
    hold_index = cycle.segments.index(hold)
    ramp = cycle.segments[hold_index - 1]
    return _HeldLoad(
        float(cycle.ramp.start), float(ramp.end), float(hold.end), level, preload, sign
    )


def _get_displacement_sign(test: CreepTest, held_load: _HeldLoad, file_name: str) -> int:
    """Return the sign that makes the displacement rise under the load."""
    time, x = test.time, test.displacement
    hold = (time >= held_load.ramp_end) & (time <= held_load.hold_end)
    displacement_before = x[time <= held_load.onset]
    change = float(x[hold][-max(1, hold.sum() // 10) :].mean()) - median(displacement_before)
    if change == 0:
        raise DataError(
            f"{file_name}: the displacement does not move under the load; check which column it is "
            "(--column displacement=NAME)"
        )
    return 1 if change > 0 else -1


def _estimate_force_noise(time: FloatArray, force: FloatArray, held_load: _HeldLoad) -> float:
    """The scatter of the force late in its hold, where the load is constant."""
    second_half = (time >= (held_load.ramp_end + held_load.hold_end) / 2) & (
        time <= held_load.hold_end
    )
    return scatter(time[second_half], force[second_half])


def make_load_error_products(record: LoadHold) -> Callable[[FloatArray], FloatArray]:
    """Return what makes, of columns at every sample, their products with the errors of the load.

    Of independent errors of unit variance, N: those of the load's corners, their heights and, of
    a load of few, their times.
    """
    time, corners = record.time, np.array(record.corners)
    if not record.corners:
        return lambda columns: np.zeros((0, columns.shape[1]))
    has_few_corners = len(corners) <= MAX_CORNERS
    corner_shift_columns = (
        _compute_corner_derivatives(time, corners, np.interp(corners, time, record.load))
        if has_few_corners
        else None
    )

    def directions(columns: FloatArray) -> FloatArray:
        heights = _project_columns(time, corners, columns)
        return (
            heights
            if corner_shift_columns is None
            else np.concatenate((heights, corner_shift_columns.T @ columns))
        )

    gram = _compute_gram(time, corners)
    if corner_shift_columns is not None:
        corner_products = _project_columns(time, corners, corner_shift_columns)
        gram = np.block(
            [
                [gram, corner_products],
                [corner_products.T, corner_shift_columns.T @ corner_shift_columns],
            ]
        )
    value, eigenvectors = np.linalg.eigh(gram)
    reference = value > _SINGULAR * value[-1]
    errors = record.force_noise * (eigenvectors[:, reference] / np.sqrt(value[reference])).T
    # all is measured from the first reading
    first = np.zeros(len(gram))
    first[0] = 1.0

    def products(columns: FloatArray) -> FloatArray:
        response = directions(columns) - np.outer(first, columns.sum(axis=0))
        return np.asarray(errors @ response)

    return products


def _remove_load_noise(
    time: FloatArray, force: FloatArray, noise: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The load behind its readings, freed of noise (errors in variables), its corners and heights.

    A load is straight between corners. Ramps and holds that are straight to their noise have the
    few that least squares puts there. Any other, one that overshoots or hunts, is halved until
    each part is straight to its noise, and those parts are quartered: what a line then misses of
    the curve is a sixteenth of what noise would hide.
    """
    noise_level = max(noise, find_quantum(force) * OF_A_COUNT)
    if noise_level <= _EXACT * float(np.ptp(force)):
        return force, np.zeros(0), np.zeros(0)
    corners = _fit_corner_times(time, force)
    heights = _fit_corner_heights(time, corners, force)
    if not _is_noise(force - np.interp(time, corners, heights), noise_level, _CERTAIN_SD):
        corners = _insert_corners(time, force, corners, noise_level)
        heights = _fit_corner_heights(time, corners, force)
    return np.interp(time, corners, heights), corners, heights


def _fit_corner_times(time: FloatArray, force: FloatArray) -> FloatArray:
    """Corners of a load, each at the time where least squares puts it: Gauss-Newton."""
    corners = np.array([time[0], *(segment.end for segment in find_segments(time, force))])
    if not 3 <= len(corners) <= MAX_CORNERS:
        return corners
    for _ in range(_STEPS):
        hat_functions = _make_hat_functions(time, corners)
        heights = np.asarray(np.linalg.lstsq(hat_functions, force, rcond=None)[0])
        columns = np.column_stack(
            (hat_functions, _compute_corner_derivatives(time, corners, heights))
        )
        displacement = np.linalg.lstsq(columns, force - hat_functions @ heights, rcond=None)[0][
            len(corners) :
        ]
        margin = _PART * np.minimum(np.diff(corners)[:-1], np.diff(corners)[1:])
        corners[1:-1] += np.clip(displacement, -margin, margin)
        if float(np.abs(displacement).max()) < _CORNER_TOLERANCE * (time[-1] - time[0]):
            break
    return corners


def _insert_corners(
    time: FloatArray, force: FloatArray, corners: FloatArray, noise: float
) -> FloatArray:
    """Corners, and more between them wherever the load is not straight."""
    arrays, stack = [corners], list(pairwise(corners.tolist()))[::-1]
    original_spans = set(stack)
    while stack:
        low, high = stack.pop()
        span = slice(*np.searchsorted(time, [low, high]).tolist())
        t, f = time[span], force[span]
        if len(t) < _MIN_READINGS:
            continue
        line = np.column_stack((np.ones(len(t)), t - t[0]))
        remainder = f - line @ np.linalg.lstsq(line, f, rcond=None)[0]
        if _is_noise(remainder, noise, _UNLIKELY_SD):
            if (low, high) not in original_spans:
                piece_count = min(_QUARTERS, len(t) // _MIN_READINGS)
                arrays.append(np.linspace(low, high, piece_count + 1))
            continue
        midpoint = (low + high) / 2
        stack += [(midpoint, high), (low, midpoint)]
        arrays.append(np.array([midpoint]))
    return distinct(np.concatenate(arrays))


def _fit_corner_heights(time: FloatArray, corners: FloatArray, force: FloatArray) -> FloatArray:
    """Return the heights of corners whose straight lines are nearest to a force."""
    force_projection = _project_columns(time, corners, force[:, None])[:, 0]
    gram = _compute_gram(time, corners)
    # a corner between which and its neighbours no reading lies has no height of its own
    gram[np.diag_indices_from(gram)] += _SINGULAR * float(np.diag(gram).max())
    return np.asarray(np.linalg.solve(gram, force_projection))


def _locate_readings(time: FloatArray, corners: FloatArray) -> tuple[IndexArray, FloatArray]:
    """Return the corner before each reading, and how far it is to the next, as a part."""
    corner_index = np.clip(np.searchsorted(corners, time, side="right") - 1, 0, len(corners) - 2)
    return corner_index, (time - corners[corner_index]) / (
        corners[corner_index + 1] - corners[corner_index]
    )


def _project_columns(time: FloatArray, corners: FloatArray, columns: FloatArray) -> FloatArray:
    """Products of columns with the shape that the height of each corner gives."""
    corner_index, part = _locate_readings(time, corners)
    products = np.zeros((len(corners), columns.shape[1]))
    np.add.at(products, corner_index, (1 - part)[:, None] * columns)
    np.add.at(products, corner_index + 1, part[:, None] * columns)
    return products


def _compute_gram(time: FloatArray, corners: FloatArray) -> FloatArray:
    """Products of those shapes with one another."""
    corner_index, part = _locate_readings(time, corners)
    gram = np.zeros((len(corners), len(corners)))
    for i, values in ((0, 1 - part), (1, part)):
        for j, other in ((0, 1 - part), (1, part)):
            np.add.at(gram, (corner_index + i, corner_index + j), values * other)
    return gram


def _make_hat_functions(time: FloatArray, corners: FloatArray) -> FloatArray:
    """Return the shape that the height of each corner gives, shape (n, corners)."""
    return np.stack([np.interp(time, corners, values) for values in np.eye(len(corners))], axis=1)


def _compute_corner_derivatives(
    time: FloatArray, corners: FloatArray, heights: FloatArray
) -> FloatArray:
    """Return how a load moves with the times of its inner corners, shape (n, corners - 2)."""
    hat_functions, slopes = _make_hat_functions(time, corners), np.diff(heights) / np.diff(corners)
    shift_columns = [
        -hat_functions[:, j] * np.where(time <= corners[j], slopes[j - 1], slopes[j])
        for j in range(1, len(corners) - 1)
    ]
    return np.array(shift_columns).reshape(-1, len(time)).T


def _is_noise(residual: FloatArray, noise: float, chance: float) -> bool:
    """True if means over 1, 2, 4, ... neighbours are no larger than white noise makes them."""
    width = 1
    while len(residual) // width >= 2:
        means = residual[: len(residual) // width * width].reshape(-1, width).mean(axis=1)
        if float(np.abs(means).max()) > chance * noise / np.sqrt(width):
            return False
        width *= 2
    return True


def _make_step(held_load: _HeldLoad, sign: int, unit: str) -> Step:
    unit_name = "N" if unit == "N/m" else "Pa"
    start_text = (
        f"the load of {held_load.level:.4g} {unit_name} rises from {held_load.onset:.5g} s "
        "and is held from "
    )
    message = (
        f"{start_text}{held_load.ramp_end:.5g} to {held_load.hold_end:.5g} s, after "
        f"{held_load.preload:.3g} {unit_name} of "
        "preload; the recorded force, freed of its noise, is what the fit answers"
    )
    options = (("force turned", str(held_load.sign)), ("displacement turned", str(sign)))
    return Step("load_hold", options, message)
