"""Preparation of a compression load deflection record: its cycles and their values."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import chain
from typing import NamedTuple, TypeAlias

import numpy as np

from dashpot.base.arrays import FloatArray, median
from dashpot.base.checks import Check
from dashpot.base.errors import DataError
from dashpot.base.provenance import list_sources
from dashpot.base.units import Quantity, Range, convert_to_si, format_quantity, si_range
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.relaxation import find_quantum
from dashpot.extensions.materials.cld import checks
from dashpot.extensions.materials.cld.datamodel import (
    CLD,
    Branch,
    CLDTest,
    CompressionValues,
    Cycle,
)
from dashpot.extensions.materials.cld.local_stiffness import (
    WINDOW,
    delay_channel,
    evaluate_cycle,
    fit_local_slope,
    measure_speed,
)
from dashpot.extensions.materials.cld.zero_point import Zero, find_later_contact, find_zero
from dashpot.extensions.materials.strokes import Stroke, find_strokes, get_inward_signs
from dashpot.fitting.nuisance_priors import Prior, compute_delay_errors
from dashpot.preprocessing.checks import check_machine
from dashpot.signals.segments import estimate_resolution

_SMOOTHED, _SIGNIFICANT_SD = 5, 4.0
"""Samples of a mean in which a pull is sought, and standard deviations that chance may make."""
_COMMON_DEPTH_SHARE = 0.95
"""Part of the least depth at which cycles are compared."""
_MAX_EXTRAPOLATION = 5e-3
"""Part of the depth by which a compression asked for may lie beyond the last reading."""
_MAX_RETURN_SHARE = 0.2
"""Part of the depth by which a release may go behind the start of a record without air."""
_MIN_COMPLETE_SHARE = 0.9
"""A last loading that ends before this part of the depth, and is not unloaded, is left out."""


class _RecordCycles(NamedTuple):
    """Cycles of a record; a compression may exceed them by `max_extrapolation`."""

    cycles: tuple[Cycle, ...]
    zero: Zero
    max_extrapolation: float
    common_depth: float
    speed_variations: tuple[float | None, ...]
    compression: FloatArray
    force: FloatArray


def cld(
    test: CLDTest,
    *,
    at: Quantity | None = None,
    compression_limits: Range | None = None,
    cycle: int | None = None,
    machine: Machine | None = None,
) -> CLD:
    """Find the cycles of a compression load deflection test, and the figures of one of them.

    Compression is counted from first contact of the first cycle; the load cell's zero is its
    reading in air, if the plate comes through air. The effect of a delay of the force,
    indistinguishable from loss, is in the error of each value.

    Parameters
    ----------
    test : CLDTest
    at : float or str, optional
        Nominal compression, m or with its unit; by default the depth of the cycle.
    compression_limits : (float, float) or str, optional
        Least and greatest compression of the tolerance, m or as ``"4:8mm"``.
    cycle : int, optional
        Which cycle, from 1; by default the last that was unloaded and reaches `at`.
    machine : Machine, optional
        Known properties of the machine: its `sync`.

    Returns
    -------
    CLD

    Raises
    ------
    DataError
        If there is no compression, no such cycle, or no cycle reaches `at`.
    """
    machine = machine or Machine()
    machine.refuse_unused("sync", subject="load deflection")
    if machine.sync is not None and test.time is None:
        raise DataError(
            "--machine sync= is a time, and the record has no clock. Leave it out, or export the "
            "time, too"
        )
    cycles = _find_cycles(test)
    nominal = None if at is None else convert_to_si(at, "length")
    index = _choose_cycle(cycles, cycle, nominal)
    chosen_cycle = cycles.cycles[index]
    nominal = chosen_cycle.depth if nominal is None else nominal
    limits = (None, None) if compression_limits is None else si_range(compression_limits, "length")
    mark_below, middle, mark_above = (
        _evaluate_record_cycle(cycles, chosen_cycle, value)
        for value in (limits[0], nominal, limits[1])
    )
    if middle is None:
        max_depth = max(cycle.depth for cycle in cycles.cycles)
        raise DataError(
            f"{format_quantity(nominal, 'mm')} was asked for; expected a compression > 0 that the "
            f"seal was pressed to, at most {format_quantity(max_depth, 'mm')}: --compression gives "
            "it, --file-part cycle=N another cycle"
        )
    delay = Prior(0.0, machine.delay_sd(median(np.diff(get_sample_clock(test)))))
    cycles, (mark_below, middle, mark_above) = _with_delay(
        test, cycles, index, (mark_below, middle, mark_above), delay
    )
    chosen_cycle = cycles.cycles[index]
    zero, specimen = cycles.zero, test.specimen
    return CLD(
        cycles.cycles,
        index,
        zero.contact,
        zero.contact_se,
        zero.force_se,
        zero.preload,
        zero.drift,
        zero.noise,
        cycles.common_depth,
        middle,
        mark_below,
        mark_above,
        test.time,
        cycles.compression,
        cycles.force,
        _run_checks(cycles, index, max(end for end in (nominal, *limits) if end is not None), test),
        specimen,
        test.source,
        delay.sd,
    )


_Marks: TypeAlias = tuple[CompressionValues | None, CompressionValues, CompressionValues | None]
"""Values of a cycle at the smallest, the nominal and the largest compression."""


def get_sample_clock(test: CLDTest) -> FloatArray:
    """Return the clock of a test, s; the number of each sample where it has none."""
    return np.arange(float(len(test.force))) if test.time is None else test.time


def _with_delay(
    test: CLDTest, new_cycles: _RecordCycles, index: int, marks: _Marks, delay: Prior
) -> tuple[_RecordCycles, _Marks]:
    """Return cycles and marks with the error by a delay of the force."""
    points = [mark for mark in marks if mark is not None]

    def numbers(delay: float) -> FloatArray:
        clock = get_sample_clock(test)
        cycles = new_cycles
        if delay:
            cycles = _find_cycles(
                replace(test, force=delay_channel(clock, test.force, delay), units="SI")
            )
        has_same_cycles = len(cycles.cycles) == len(new_cycles.cycles)
        if not has_same_cycles:  # of noise that is taken for a stroke nothing follows
            return np.full(len(new_cycles.cycles) + 3 * len(points), np.nan)
        at = (
            _evaluate_record_cycle(cycles, cycles.cycles[index], point.compression)
            for point in points
        )
        group = (
            (np.nan,) * 3 if point is None else (point.loading, point.unloading, point.slope)
            for point in at
        )
        loss_ratios = (cycle.hysteresis for cycle in cycles.cycles)
        return np.array([*loss_ratios, *chain.from_iterable(group)], dtype=float)

    error = compute_delay_errors(numbers, delay)
    loss_errors, at = np.split(np.where(np.isfinite(error), error, 0.0), [len(new_cycles.cycles)])
    cycles = tuple(
        cycle
        if cycle.hysteresis is None
        else replace(
            cycle,
            hysteresis_se=float(
                np.hypot(loss_error, _compute_hysteresis_error(cycle, new_cycles.zero))
            ),
        )
        for cycle, loss_error in zip(new_cycles.cycles, loss_errors.tolist(), strict=True)
    )
    new_points = iter(
        [
            replace(
                point,
                loading_se=float(np.hypot(point.loading_se, loading)),
                unloading_se=None
                if point.unloading_se is None
                else float(np.hypot(point.unloading_se, unloading)),
                slope_se=float(np.hypot(point.slope_se, slope)),
            )
            for point, (loading, unloading, slope) in zip(points, at.reshape(-1, 3), strict=True)
        ]
    )
    shifted_marks = tuple(None if mark is None else next(new_points) for mark in marks)
    return new_cycles._replace(cycles=cycles), shifted_marks  # type: ignore[return-value]  # the same three


def _compute_hysteresis_error(cycle: Cycle, zero: Zero) -> float:
    """Return standard error of a cycle's hysteresis by the noise of the force and by its zero."""
    branches = [branch for branch in (cycle.loading, cycle.unloading) if branch is not None]
    steps = np.concatenate([np.diff(np.maximum(branch.compression, 0.0)) for branch in branches])
    scatter = zero.noise * float(np.linalg.norm(steps))
    # a zero that is off adds as much to both works
    zero_error_term = zero.force_se * cycle.depth * float(cycle.hysteresis or 0.0)
    return float(np.hypot(scatter, zero_error_term)) / cycle.energy


def _evaluate_record_cycle(
    cycles: _RecordCycles, cycle: Cycle, nominal: float | None
) -> CompressionValues | None:
    if nominal is None or not nominal > 0:
        return None
    return evaluate_cycle(
        cycle,
        nominal,
        excess=cycles.max_extrapolation,
        contact_se=cycles.zero.contact_se,
        force_se=cycles.zero.force_se,
    )


def _find_cycles(test: CLDTest) -> _RecordCycles:
    turn, push = get_inward_signs(test.displacement, test.force)
    x, force = turn * test.displacement, push * test.force
    clock = get_sample_clock(test)
    resolution = estimate_resolution(clock, x, find_quantum(x))
    strokes = find_strokes(x, resolution=resolution)
    pairs = _pair_strokes(strokes)
    zero = find_zero(clock, x, force, pairs[0][0], resolution=resolution)
    x, force = x - zero.contact, force - zero.force
    depths = [float(x[stroke.last]) for stroke, _ in pairs]
    if not zero.comes_through_air:
        _refuse_loops(float(-x.min()), max(depths), rated=test.time is not None)
    max_extrapolation = max(resolution, 3 * zero.contact_se, _MAX_EXTRAPOLATION * max(depths))
    if len(pairs) > 1 and pairs[-1][1] is None and depths[-1] < _MIN_COMPLETE_SHARE * max(depths):
        pairs, depths = pairs[:-1], depths[:-1]
    common = _COMMON_DEPTH_SHARE * min(depths)
    cycles, speed_variations = [], []
    for number, (loading, unloading) in enumerate(pairs, start=1):
        speed = relative_variation = None
        if test.time is not None:
            speed, relative_variation = measure_speed(clock[loading.samples], x[loading.samples])
        cycles.append(
            _make_cycle(x, force, number, loading, unloading, zero=zero, common_depth=common,
                   max_extrapolation=max_extrapolation, speed=speed)
        )  # fmt: skip
        speed_variations.append(relative_variation)
    return _RecordCycles(
        tuple(cycles), zero, max_extrapolation, common, tuple(speed_variations), x, force
    )


def _refuse_loops(return_distance: float, depth: float, *, rated: bool) -> None:
    """Refuse cycles about a mean compression: their work and forces have no zero."""
    if return_distance > _MAX_RETURN_SHARE * depth:
        rate = "" if rated else " --rate 1000Hz"
        raise DataError(
            "the record begins in contact, and its release goes "
            f"{format_quantity(return_distance, 'mm', '.3g')} back behind that: these are loops "
            "about a mean compression; expected a seal that is pressed from its free height. "
            f"Storage and loss of loops: dashpot fit FILE --kind cyclic{rate}"
        )


def _pair_strokes(strokes: Sequence[Stroke]) -> list[tuple[Stroke, Stroke | None]]:
    """Return every loading, with the unloading after it if recorded."""
    stroke_pairs = zip(strokes, [*strokes[1:], None], strict=True)
    pairs = [
        (stroke, following_stroke) for stroke, following_stroke in stroke_pairs if stroke.inward
    ]
    if not pairs:
        raise DataError(
            "no loading was found: the compression only falls, or never moves by more than its "
            "scatter; expected a seal that is pressed, and then released"
        )
    return pairs


def _make_cycle(
    x: FloatArray,
    force: FloatArray,
    number: int,
    loading: Stroke,
    unloading: Stroke | None,
    *,
    zero: Zero,
    common_depth: float,
    max_extrapolation: float,
    speed: float | None,
) -> Cycle:
    way_in = _make_branch(x, force, loading)
    unloading_branch = None if unloading is None else _make_branch(x, force, unloading)
    contact = 0.0
    if number > 1:
        next_contact = find_later_contact(way_in.compression, way_in.force, noise=zero.noise)
        contact = np.nan if next_contact is None else next_contact
    depth = float(x[loading.last])
    local_slope = fit_local_slope(
        way_in, common_depth, half_width=WINDOW * depth, excess=max_extrapolation
    )
    peak = fit_local_slope(way_in, depth, half_width=WINDOW * depth, excess=max_extrapolation)
    if local_slope is None or peak is None:
        raise DataError(
            f"cycle {number}: {len(way_in.force)} samples of loading; expected 4 or more"
        )
    return Cycle(
        number, depth, speed, None if np.isnan(contact) else contact, peak.force, local_slope.force,
        way_in, unloading_branch,
    )  # fmt: skip


def _make_branch(x: FloatArray, force: FloatArray, stroke: Stroke) -> Branch:
    return Branch(x[stroke.samples], force[stroke.samples], stroke.first)


def _choose_cycle(
    new_cycles: _RecordCycles, requested_number: int | None, nominal: float | None
) -> int:
    cycles = new_cycles.cycles
    if requested_number is not None:
        if not 1 <= requested_number <= len(cycles):
            plural = "s" * (len(cycles) != 1)
            raise DataError(
                f"cycle {requested_number} was asked for, but the record holds {len(cycles)} "
                f"cycle{plural}"
            )
        return requested_number - 1
    reaching_cycles = [
        i
        for i, cycle in enumerate(cycles)
        if nominal is None or cycle.depth >= nominal - new_cycles.max_extrapolation
    ]
    complete_cycles = [i for i in reaching_cycles if cycles[i].unloading is not None]
    return (complete_cycles or reaching_cycles or [len(cycles) - 1])[-1]


def _measure_pull(cycle: Cycle, zero: Zero) -> float | None:
    """The greatest pull of a release, over the greatest force; less than noise makes is none."""
    unloading = cycle.unloading
    if unloading is None or not zero.comes_through_air or len(unloading.force) < _SMOOTHED:
        return None
    means = np.convolve(unloading.force, np.full(_SMOOTHED, 1 / _SMOOTHED), "valid")
    chance = _SIGNIFICANT_SD * zero.noise / _SMOOTHED**0.5 + 2 * zero.force_se
    return float(max(-means.min() - chance, 0.0) / cycle.peak)


def _run_checks(
    new_cycles: _RecordCycles, index: int, largest: float, test: CLDTest
) -> tuple[Check, ...]:
    cycles, zero = new_cycles.cycles, new_cycles.zero
    chosen_cycle, earlier_cycles = cycles[index], cycles[:index]
    drift = zero.drift / chosen_cycle.peak if zero.drift else None
    return (
        checks.zero_recorded(zero.initial_force_ratio, comes_through_air=zero.comes_through_air),
        *check_machine(list_sources([test]), chosen_cycle.peak / chosen_cycle.depth),
        checks.specimen_conditioned(
            chosen_cycle.common / earlier_cycles[-1].common - 1 if earlier_cycles else None,
            cycle=chosen_cycle.number,
            softening=cycles[0].common / cycles[-1].common - 1,
        ),
        checks.depth_conditioned(
            chosen_cycle.depth / max(cycle.depth for cycle in earlier_cycles)
            if earlier_cycles
            else None,
            chosen_cycle.number,
        ),
        checks.compressions_reached(largest, chosen_cycle.depth + new_cycles.max_extrapolation),
        checks.load_cell_steady(drift),
        checks.plate_speed_constant(new_cycles.speed_variations[index]),
        checks.no_energy_gained(chosen_cycle.hysteresis),
        checks.no_adhesion_on_release(_measure_pull(chosen_cycle, zero)),
        checks.unloading_recorded(is_recorded=chosen_cycle.unloading is not None),
        checks.length_stated(is_given=test.specimen.length is not None),
    )
