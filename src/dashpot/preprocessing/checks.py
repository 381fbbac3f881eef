"""Criteria on records before any fit."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Protocol

import numpy as np

from dashpot.base.arrays import FloatArray, cache_on_record, find_true_runs, median
from dashpot.base.checks import Check, Finding, Remedy, criterion, select_gravest_check
from dashpot.base.errors import DataError, Status
from dashpot.base.lazy import compile_on_use
from dashpot.base.number_format import round_to_error
from dashpot.base.plain_text import decapitalise_sentence
from dashpot.base.provenance import Source
from dashpot.base.units import celsius, format_quantity
from dashpot.datamodel.relaxation import MAX_CREEP, SETTLING_SHARE, RampHold, find_quantum
from dashpot.datamodel.specimen import Specimen
from dashpot.preprocessing.contact import MIN_BASELINE, Baseline, Touch
from dashpot.preprocessing.denoising import (
    CORNERS,
    MIN_LOST_FORCE,
    compute_interpolation_bends,
    compute_largest_bend,
    denoise_displacement,
)
from dashpot.preprocessing.history import EarlierLoadings
from dashpot.signals.clock import NEIGHBOUR_STEPS, find_clock_jumps, has_few_pauses
from dashpot.signals.noise import estimate_robust_scatter, median_of_three, spikes
from dashpot.signals.segments import MotionSegment, RampHoldCycle
from dashpot.signals.stuck_channel import MIN_SAMPLES, SAMPLES_BEFORE, find_stuck_runs
from dashpot.solids.maxwell import GeneralizedMaxwell, arm_response

LIMIT_REASON = "by physics; a tenth for noise and drift"
MIN_QUANTA = 20.0
MAX_PRELOAD = 0.05
GROSS_PRELOAD = 0.2
# below this the limits include the relaxation of the preload, and the law's curvature is negligible
LARGE_PRELOAD = 0.1
MAX_OVERSHOOT = 0.05
MIN_HOLD_OVER_RAMP = 10.0
MIN_RAMP_SAMPLES = 10.0
MIN_FLAT_SAMPLES = 5.0
MAX_UNRESOLVED_ERROR = 0.125
# largest error of a stated temperature, and largest drift over a record, K
MAX_TEMPERATURE_ERROR, MAX_TEMPERATURE_DRIFT = 1.0, 1.0
# a loss, in noises, that the weights of the ramp's rows may not count: behind plates that step by
# 10 to 100 ms, limits held in 24 of 24 records of less, and in 15 of 16 of more
GROSS_FACTOR = 2.0
# shares of a hold: of a frozen channel, which fails; of a frozen force, which is grave
MAX_FROZEN_SHARE, GROSS_FROZEN_SHARE = 0.005, 0.1
# of the depth: a plate that moved; of the hold: in which it is braked
MOVED_SHARE, BRAKED_SHARE = 1e-3, 0.05
# smallest number of bends of a stepped motion
MIN_STEPPED_BENDS = 8
# largest pause, and largest jump of an even clock, relative to the time from onset
MAX_PAUSE, MAX_CLOCK_JUMP = 0.25, 1e-3
# largest misfit of earlier loadings, relative to their force, and error of the face, to the depth
MAX_HISTORY_MISFIT, MAX_FACE_ERROR = 0.03, 0.01
# motion between rows, relative to the depth, that shows missing rows
MAX_HISTORY_JUMP = 0.1
# largest deflection relative to the depth, and compliance of a soft machine with load cell, m/N
MAX_DEFLECTION, USUAL_COMPLIANCE = 0.025, 5e-5
MACHINE_NAME = compile_on_use(
    r"(?i)cross[ -]?head|tra[vw]ers|querhaupt|kolben|maschinenweg|standardweg|\bxhd\b|\bgrip"
    r"|einspann|piston|actuator|\bram\b|stroke|(?<!meter )\bextension\b|\bposition\b"
    "|ストローク|横梁|活塞|크로스헤드"
)
"""Names of a displacement of crosshead, piston or grips, as test machines export it."""
JUMP_MESSAGE = (
    "The clock jumped, or the record was interrupted. Later times and slow arms are not known"
)


class ClockedTest(Protocol):
    """Interface of a test with onset and hold, of a motion or of a load: its clock."""

    @property
    def time(self) -> FloatArray:
        """Time of every sample, s."""

    @property
    def onset(self) -> float:
        """Start of the ramp, s."""

    @property
    def ramp_time(self) -> float:
        """Duration of the ramp, s; 0 for a step."""

    @property
    def hold(self) -> slice:
        """The samples of the hold."""


# -- Temperature of the file ----------------------------------------------------------------------


@criterion(
    "K apart", "|x| <=", MAX_TEMPERATURE_ERROR, "simulation: no other check shows an error of 1 K"
)
def temperature_as_stated(specimen: Specimen) -> Finding:
    """The given temperature agrees with the one in the file."""
    measured, stated = (specimen.temperature or 0.0, specimen.stated_temperature or 0.0)
    return Finding(
        f"The file says {celsius(stated)}, and {celsius(measured)} was given",
        measured - stated,
        "Shifts and predictions use the one given",
        Remedy("Check which is right.", "temperature"),
    )


@criterion("K over the record", "|x| <=", MAX_TEMPERATURE_DRIFT, "our choice: chambers hold 0.5 K")
def temperature_held(specimen: Specimen) -> Finding:
    """The recorded temperature was constant during the test."""
    warmed = specimen.warmed or 0.0
    return Finding(
        f"The recorded temperature rose by {warmed:.2g} K over the record",
        warmed,
        "Stiffness and relaxation times changed with it",
        "Let the seal soak longer.",
    )


def check_temperature(specimen: Specimen) -> list[Check]:
    """Return the checks of the temperature that the file states."""
    all_checks = []
    if specimen.stated_temperature is not None:
        all_checks.append(temperature_as_stated(specimen))
    if specimen.warmed is not None:
        all_checks.append(temperature_held(specimen))
    return all_checks


# -- Preparation ----------------------------------------------------------------------------------


@criterion(
    "samples", ">=", MIN_BASELINE, "our choice: the fewest that give a scatter", grade="note"
)
def baseline_recorded(baseline: Baseline) -> Finding:
    """A baseline before contact gives the tare."""
    count = f"{baseline.samples} sample{'s' * (baseline.samples != 1)}"
    return Finding(
        f"{baseline.samples} samples ({baseline.duration:.3g} s) before contact give the tare to "
        f"{format_quantity(baseline.noise / max(baseline.samples, 1) ** 0.5, 'mN', '.2g')}",
        float(baseline.samples),
        failure=f"The record has {count} before contact; at least {MIN_BASELINE:.0f} are needed. "
        "The fitted offset alone sets the zero of the force",
        remedy="Start the record a second before the ramp.",
    )


@criterion("its error / depth", "<=", 0.01, "our choice: it enters every stiffness")
def contact_detected(touch: Touch, depth: float, *, is_given: bool) -> Finding:
    """The position of first contact is known well enough."""
    if is_given:
        return Finding(
            f"Contact was given, {format_quantity(touch.gap, 'mm', '.3g')} after the start of the "
            "motion"
        )
    if touch.gap == 0:
        return Finding("The seal touches where the motion begins: there is no air gap")
    relative_error = touch.standard_error / depth
    return Finding(
        f"The depth is known to {100 * relative_error:.2g} %. The plate crosses an air gap of "
        f"{format_quantity(touch.gap, 'mm', '.3g')} (± "
        f"{format_quantity(touch.standard_error, 'mm', '.1g')}) "
        "before the force rises",
        relative_error,
        "Every stiffness has the same uncertainty",
        "Start in light contact.",
    )


@criterion(
    "preload / rise of the force",
    "<=",
    MAX_PRELOAD,
    grade="note",
    other_grade=f"limit beyond {LARGE_PRELOAD}; stop beyond {GROSS_PRELOAD} of a plate that moves",
)
def preload_absent(
    initial_force: float, loading_rise: float, *, is_moving: bool = False
) -> Finding:
    """The force before the ramp is close to zero."""
    preload_ratio = abs(initial_force) / loading_rise
    message = "There is no preload before the ramp"
    if initial_force:
        message = (
            f"The load cell reads {initial_force:.3g} N as the ramp starts, "
            f"{round_to_error(100 * preload_ratio, digits=2)} % of the rise"
        )
    is_late = is_moving and preload_ratio > GROSS_PRELOAD
    return Finding(
        message,
        preload_ratio,
        "The plate moves already at the first sample. The record begins within its ramp, or the "
        "load cell was not tared"
        if is_late
        else "If this is the cell's offset, the tare is right. If the seal was pressed, the "
        "stiffnesses are those about that preload",
        "Record from a second before the ramp." if is_late else "Tare in air, or start from rest.",
        grade="stop" if is_late else "limit" if preload_ratio > LARGE_PRELOAD else None,
    )


@criterion("its change in the hold / its rise in the ramp", "<=", 1.1, LIMIT_REASON, grade="stop")
def ramp_recorded(loading_rise: float, change: float) -> Finding:
    """The record begins before its ramp."""
    return Finding(
        "The ramp raises the force that relaxes",
        abs(change) / max(abs(loading_rise), 1e-300),
        failure=f"The record begins within its ramp, or after it. The force changes by "
        f"{format_quantity(loading_rise, 'mN', '.3g')} in the ramp and by "
        f"{format_quantity(change, 'mN', '.3g')} in the "
        "hold; no part relaxes more than it was loaded",
        remedy="Start recording a second before the ramp.",
    )


def refuse_late_start(location: str, loading_rise: float, change: float) -> None:
    """Raise DataError if the record begins after its ramp: a fit would be meaningless."""
    check = ramp_recorded(loading_rise, change)
    if check.failed:
        raise DataError(f"{location}: {decapitalise_sentence(check.message_with_remedy)}")


@criterion(
    "loadings in the record",
    "<=",
    1.0,
    "by definition; or `--file-part cycle=N` chooses",
    grade="note",
)
def single_loading(
    index: int,
    cycles: tuple[RampHoldCycle, ...],
    *,
    is_requested: bool,
    earlier_loadings: Sequence[MotionSegment] = (),
) -> Finding:
    """The record has one loading, or the user chose one.

    `earlier_loadings` are those before the fitted one, with a hold or without.
    """
    cycle = cycles[index]
    message, remedy = f"Used: {cycle.words()}", Remedy("Choose another.", "file-part", "cycle=N")
    if len(cycles) > 1:
        message = f"The record has {len(cycles)} loadings with a hold; cycle {index + 1} is fitted"
        if not is_requested:
            message += ", because its hold is the longest"
    if earlier_loadings:
        loading_count = len(earlier_loadings)
        message += (
            f". {loading_count} move{'s' * (loading_count != 1)} towards the seal before it, from "
            f"{earlier_loadings[0].start:.5g} to {earlier_loadings[-1].end:.5g} s, "
            f"{'are' if loading_count > 1 else 'is'} followed from the first sample on as what the "
            "seal remembers, and not fitted"
        )
    if cycle.ramp_count > 1:
        message += (
            f". It has {cycle.ramp_count} ramps. The fit of ramp and hold follows them all; the "
            "fit of the hold alone (eq. 5) does not apply"
        )
    return Finding(message, float(len(cycles)), remedy=remedy, always_passes=is_requested)


@criterion(
    "their misfit / their force",
    "<=",
    MAX_HISTORY_MISFIT,
    "simulation: conditioned seals that soften",
)
def history_explained(
    earlier_loadings: EarlierLoadings, *, has_missing_rows: bool, was_pressed: bool = False
) -> Finding:
    """The model also fits the loadings before the one that is fitted."""
    message = (
        f"The solid of the last loading gives the force of the earlier ones to "
        f"{100 * earlier_loadings.misfit:.2g} %"
    )
    if not earlier_loadings.converged:
        message += ". How its face recovers was not found"
    if has_missing_rows:
        message += ". Rows are missing while the plate moved"
    if was_pressed:
        message = "The record begins with the seal pressed, before the loading that is fitted"
    return Finding(
        message,
        earlier_loadings.misfit,
        "The seal softened, was set, or moved otherwise, so what it remembers is not known",
        "Let it rest before the test, or condition it more often.",
        always_fails=has_missing_rows or was_pressed or not earlier_loadings.converged,
    )


@criterion(
    "surface less expected position / depth",
    "|x| <=",
    MAX_FACE_ERROR,
    "simulation: a set that stays",
)
def face_recovered(
    measured_position: float, expected: float, *, error: float, depth: float
) -> Finding:
    """The plate meets the seal again where the model expects its recovered surface.

    Compressions there, m, with the standard error of the one that is seen.
    """
    excess_distance = max(abs(measured_position - expected) - 3 * error, 0.0)
    return Finding(
        f"The plate meets the seal again {format_quantity(measured_position, 'mm', '.3g')} from "
        f"first contact, where its face is expected at {format_quantity(expected, 'mm', '.3g')}",
        float(np.copysign(excess_distance, measured_position - expected)) / depth,
        "The seal was set, or recovers otherwise than it relaxes",
        "Let it rest before the test.",
    )


@criterion(
    "part of the depth, or of the force",
    "|x| <=",
    0.005,
    "our choice: half of what a ramp can show",
)
def earlier_loading_negligible(value: float) -> Finding:
    """Earlier loadings have little effect on the one that is fitted.

    `value` is the compression or force from which the seal has not recovered when its ramp begins,
    relative to depth or force.
    """
    return Finding(
        f"When its ramp begins the seal has not recovered by {100 * value:.2g} %",
        value,
        "A law of the depth takes each loading of a record as one of a seal that has rested",
        "Let it rest longer between two depths.",
    )


def history_checks(
    record: RampHold, earlier_loadings: EarlierLoadings, first_contact: Touch, *, was_pressed: bool
) -> list[Check]:
    """Return the checks of the loadings before the fitted one."""
    stop, corner = record.start, int(np.searchsorted(record.time, record.ramp_end))
    pauses, change = np.diff(record.time[: stop + 1]), np.diff(record.displacement[: stop + 1])
    is_jump = np.abs(change) > MAX_HISTORY_JUMP * record.depth
    broken = bool(np.any(is_jump & (pauses > 5 * median(np.diff(record.time)))))
    all_checks = [
        history_explained(earlier_loadings, has_missing_rows=broken, was_pressed=was_pressed)
    ]
    plate, face = record.plate, record.displacement[stop:corner]
    if plate is not None and first_contact.gap > 0:
        indices_without_contact = np.flatnonzero(plate[stop:corner] < face)
        if indices_without_contact.size:
            plate_position = float(np.interp(record.onset, record.time, plate))
            expected = float(face[indices_without_contact[-1]])
            error = first_contact.standard_error
            all_checks.append(
                face_recovered(plate_position, expected, error=error, depth=record.depth)
            )
    return all_checks


@criterion("overshoot / depth", "<=", MAX_OVERSHOOT, grade="note")
def overshoot_small(test: RampHold, *, ramp_count: int) -> Finding:
    """The plate stops without overshoot."""
    if ramp_count > 1:
        return Finding("With several ramps an overshoot is not checked")
    highest = float(median_of_three(test.displacement).max()) - 3 * test.displacement_noise
    overshoot_ratio = max(highest / test.depth - 1, 0.0)
    return Finding(
        f"The plate overshoots the held depth by {100 * overshoot_ratio:.2g} %",
        overshoot_ratio,
        "The fit of ramp and hold follows it. The fit of the hold alone (eq. 5) does not, and a "
        "seal pressed deeper is softer",
        "Slow the last part of the ramp.",
    )


@criterion("longest pause / ramp", "<=", 0.2, "our choice; or 3 usual pauses")
def samples_unbroken(test: RampHold) -> Finding:
    """No samples are missing where the force changes fastest."""
    early = (test.time >= test.onset) & (test.time <= test.ramp_end + test.ramp_time)
    pauses = np.diff(test.time[early])
    pause = float(pauses.max(initial=0.0))
    ratio = pause / test.ramp_time
    return Finding(
        f"The longest pause between samples, up to one ramp time after the ramp, is {pause:.3g} s",
        ratio,
        f"It is {100 * ratio:.0f} % of the ramp. The motion in the pause is taken as straight",
        "Restore the missing rows, or sample faster.",
        always_passes=pause <= 3 * (median(pauses) if pauses.size else 0.0),
    )


@criterion(
    "pause / time from onset",
    "<=",
    MAX_PAUSE,
    "our choice; or 3 times the pauses beside it, or 5 % of the rest",
    other_grade=f"at most {MAX_CLOCK_JUMP} for a leap of an even clock; stop if it is longer than "
    "all the rest",
)
def clock_steady(test: ClockedTest, time: FloatArray | None = None) -> Finding:
    """The clock has no jump.

    That is from onset to the end of the hold; for an even clock over the whole of `time`, by
    default that of the record.
    """
    used_time = test.time[int(np.searchsorted(test.time, test.onset)) : test.hold.stop]
    if len(used_time) <= NEIGHBOUR_STEPS:
        return Finding("The record is too short to judge its clock")
    pauses = np.diff(used_time)
    # a load that is a step has no ramp
    shortest = test.ramp_time or NEIGHBOUR_STEPS * median(pauses)
    jump = _find_clock_jump(test.time if time is None else time, test.onset, shortest)
    if jump is not None:
        return jump
    time_since_onset = np.maximum(used_time[:-1] - test.onset, shortest)
    at_pause = int(np.argmax(pauses / time_since_onset))
    longest, other_time = (
        float(pauses[at_pause]),
        float(used_time[-1] - used_time[0] - pauses[at_pause]),
    )
    nearby_pauses = np.delete(
        pauses[max(at_pause - NEIGHBOUR_STEPS, 0) : at_pause + NEIGHBOUR_STEPS + 1],
        min(at_pause, NEIGHBOUR_STEPS),
    )
    return Finding(
        f"The longest relative pause is {longest:.3g} s, {time_since_onset[at_pause]:.3g} s after "
        "onset",
        float(longest / time_since_onset[at_pause]),
        JUMP_MESSAGE,
        Remedy(
            "Cut the record before the pause, or correct its clock.", "time-limits", "hold-end=..."
        ),
        # two leaps side by side do not excuse each other
        always_passes=longest <= 3 * float(np.sort(nearby_pauses)[-NEIGHBOUR_STEPS // 2])
        or longest <= 0.05 * other_time,
        grade="stop" if longest > other_time else None,
    )


def _find_clock_jump(time: FloatArray, onset: float, shortest: float) -> Finding | None:
    """The largest relative jump of an even clock, if it is too large."""
    jumps = find_clock_jumps(time)
    if not jumps or not has_few_pauses(time):
        return None
    step_ratios = [jump.step / max(abs(time[jump.at] - onset), shortest) for jump in jumps]
    jump_index = int(np.argmax(step_ratios))
    if step_ratios[jump_index] <= MAX_CLOCK_JUMP:
        return None
    longest_leap, leap_time = jumps[jump_index], float(time[jumps[jump_index].at] - onset)
    is_before_contact = leap_time < 0
    return Finding(
        f"The clock goes on by {longest_leap.step:.3g} s where its steps are "
        f"{longest_leap.expected_step:.3g} s, {abs(leap_time):.3g} s "
        f"{'before' if is_before_contact else 'after'} onset",
        step_ratios[jump_index],
        "The clock jumped, or the record was interrupted" if is_before_contact else JUMP_MESSAGE,
        Remedy("Leave out the rows before it, or correct its clock.")
        if is_before_contact
        else Remedy("Cut the record there, or correct its clock.", "time-limits", "hold-end=..."),
        limit=MAX_CLOCK_JUMP,
        grade="stop"
        if not is_before_contact and 2 * longest_leap.step > time[-1] - onset
        else None,
    )


@criterion("outliers", "<=", 0.0, source="by definition")
def spikes_absent(test: RampHold) -> Finding:
    """Neither channel has single outliers (spikes)."""
    force = np.flatnonzero(spikes(test.time, test.force))
    plate = np.flatnonzero(spikes(test.time, test.displacement))
    count = len(force) + len(plate)
    if not count:
        return Finding("No single sample differs from its neighbours", 0.0)
    first = test.time[min(np.concatenate((force, plate)))]
    return Finding(
        f"{count} single samples differ from both neighbours, the first at t = {first:.6g} s. "
        f"{len(force)} are of the force, {len(plate)} of the displacement",
        float(count),
        remedy=Remedy("Correct them in the file, or use a running median.", "filter", "median:3"),
    )


@criterion(
    "part of the hold",
    "<=",
    MAX_FROZEN_SHARE,
    "our choice: a shorter stretch changes no stiffness",
    other_grade=f"stop if the force stands for more than {GROSS_FROZEN_SHARE}",
)
def readings_not_repeated(test: RampHold, force: FloatArray, displacement: FloatArray) -> Finding:
    """Both channels have a new reading in each row of the hold.

    Parameters
    ----------
    test : RampHold
    force, displacement : array, shape (n,)
        Signals of the same samples, as in the file: a tare or a line of hum taken off would leave
        no two readings equal bit for bit.
    """
    hold, time = test.hold, test.time[test.hold]
    f, x = force[hold], displacement[hold]
    if len(f) < MIN_SAMPLES:
        return Finding("The hold has too few samples to show whether a channel stands still")
    step = np.abs(x[SAMPLES_BEFORE:] - x[:-SAMPLES_BEFORE])
    is_moving = step > max(MOVED_SHARE * test.depth, 6 * test.displacement_noise)
    is_at_rest = ~np.concatenate((is_moving, np.zeros(SAMPLES_BEFORE, dtype=bool)))
    is_at_rest[SAMPLES_BEFORE:] &= ~is_moving
    is_at_rest &= time > test.ramp_end + SETTLING_SHARE * test.ramp_time
    onset_index, ramp = np.searchsorted(test.time, (test.onset, test.ramp_end)).tolist()
    # a part that is pressed falls, on either side of zero; a plate that moves on loads it again
    sign = 1.0 if (f - f.mean()) @ test.force[hold] >= 0 else -1.0
    time_since_ramp = time - test.ramp_end if not is_moving[is_at_rest.argmax() :].any() else None
    other_forces = force[:onset_index], force[onset_index:ramp]
    stuck_runs = find_stuck_runs(
        sign * f,
        is_at_rest=is_at_rest,
        time_since_ramp=time_since_ramp,
        other_stretches=other_forces,
    )
    still_runs = find_stuck_runs(x, is_at_rest=np.zeros(len(x), dtype=bool))
    # a plate that soon rests for good may well show no more noise
    still_runs = still_runs[
        (still_runs[:, 1] < len(x) - 1) | (still_runs[:, 0] > BRAKED_SHARE * len(x))
    ]
    of_force, of_plate = (
        float(np.sum(np.diff(values) + 1)) / len(f) for values in (stuck_runs, still_runs)
    )
    channel, runs_of_it = (
        ("force", stuck_runs) if of_force >= of_plate else ("displacement", still_runs)
    )
    repeated_fraction = max(of_force, of_plate)
    if not len(runs_of_it):
        return Finding("No channel repeats one value while it should scatter or change", 0.0)
    first, last = runs_of_it[np.argmax(np.diff(runs_of_it)[:, 0])]
    count = len(runs_of_it)
    others_text = f", and {count - 1} more times" if count > 1 else ""
    return Finding(
        f"The {channel} has one and the same value for {last - first + 1} samples, from "
        f"{time[first]:.4g} to {time[last]:.4g} s{others_text}",
        repeated_fraction,
        f"Its other samples rule that out: the channel was not read for "
        f"{100 * repeated_fraction:.2g} % of the hold",
        Remedy("Cut the record before that, or repeat the test.", "time-limits", "hold-end=..."),
        grade="stop" if of_force > GROSS_FROZEN_SHARE else None,
    )


@criterion(
    "force lost / noise",
    "<=",
    MAX_UNRESOLVED_ERROR,
    "our choice: 1 noise SD over the samples of a step",
    grade="note",
    other_grade=f"limit beyond {GROSS_FACTOR:g}",
)
def motion_resolved(test: RampHold) -> Finding:
    r"""The sampling rate resolves the motion of the plate.

    Taken as straight, a motion is missed by :math:`h^2 \ddot x/8`, and the force by the largest
    secant stiffness of the ramp times that. A few sharp corners may lie between samples. Limits
    count the rows of the ramp for less by it.
    """
    ramp = test.with_hold_end(test.ramp_end + test.ramp_time)
    x, residual = denoise_displacement(ramp)
    time, force = test.time[: len(x)], test.force[: len(x)]
    if len(x) < 4 * CORNERS:
        return Finding("The ramp has too few samples to show how its motion bends between them")
    motion_errors = compute_interpolation_bends(ramp, time, x, residual)
    is_compressed = x > 0.2 * test.depth
    stiffness = float(((force[is_compressed] - test.preload) / x[is_compressed]).max(initial=0.0))
    force_errors = compute_largest_bend(np.abs(motion_errors)) * stiffness
    value = force_errors / max(test.force_noise, 1e-3 * float(force.max()))
    needed_rate = np.sqrt(value / MAX_UNRESOLVED_ERROR) / median(np.diff(time))
    # a motor bends to and fro all along the ramp, a servo swings a few times
    seen_errors = motion_errors[
        np.abs(motion_errors) * stiffness * value > MIN_LOST_FORCE * force_errors
    ]
    steps_on = (
        value > MIN_LOST_FORCE
        and np.count_nonzero(np.diff(np.sign(seen_errors))) >= MIN_STEPPED_BENDS
    )
    return Finding(
        "Between two samples the displacement departs from a straight line by a force of "
        f"{format_quantity(force_errors, 'mN', '.2g')}",
        value,
        f"That is {value:.2g} times the noise at many samples. Fast arms follow what is missed",
        f"Sample at {round_to_error(needed_rate, digits=2)} Hz or faster.",
        always_fails=bool(steps_on),
        grade="limit" if value > GROSS_FACTOR else None,
    )


@criterion("readings that moved in the later half", ">", 0.0, "by definition")
def motion_measured(test: RampHold) -> Finding:
    """The displacement of the hold is measured, so that creep of the crosshead would show."""
    force, change = test.force[test.hold], test.changed_readings
    tenth_length, half_length = max(len(force) // 20, 1), len(force) // 2
    if change:
        return Finding("The displacement of the hold is measured, not commanded", float(change))
    force_fall = float(
        force[half_length : half_length + tenth_length].mean() - force[-tenth_length:].mean()
    )
    creep = 1e-3 * abs(float(force[-tenth_length:].mean()))
    note = f" ({100 * creep / force_fall:.2g} % of its fall)" if force_fall > creep else ""
    step_note = (
        f", or its step of {format_quantity(test.encoder_step, 'um', '.3g')} hides the change"
    )
    return Finding(
        "The displacement does not change in the hold: it is the commanded one"
        f"{step_note if test.encoder_step else ''}. A crosshead that crept by 0.1 % of the depth "
        f"would change the force by {format_quantity(creep, 'mN', '.2g')}{note} over the last half "
        "of the hold",
        remedy="Measure the displacement at the seal.",
    )


@criterion(
    "50 um/N x force / displacement",
    "<=",
    MAX_DEFLECTION,
    "two standard deviations of the deflection that limits include",
)
def machine_deflection_small(stiffness: float, remedy: Remedy | str) -> Finding:
    """The displacement of a crosshead or piston has little deflection of the machine in it."""
    deflection_ratio = USUAL_COMPLIANCE * stiffness
    return Finding(
        "The displacement is that of a crosshead or piston: a compliance of 50 um/N would be "
        f"{100 * deflection_ratio:.2g} % of it",
        deflection_ratio,
        "The stiffness is then too low. Press steel on steel; 0 if it is measured at the seal",
        remedy,
    )


def check_machine(
    sources: Iterable[Source], stiffness: float, remedy: Remedy | str = "Measure it at the seal."
) -> list[Check]:
    """Return the check of a displacement that is named for a machine; none of another.

    Parameters
    ----------
    sources : iterable of Source
        The files.
    stiffness : float
        Greatest force over displacement, N/m: the share of the machine grows with it.
    remedy : Remedy or str
    """
    is_named = any(
        column.startswith("displacement") and MACHINE_NAME.search(column)
        for source in sources
        for column in source.columns
    )
    return [machine_deflection_small(stiffness, remedy)] if is_named else []


@criterion(
    "motion in the hold / depth",
    "<=",
    0.03,
    "our choice; or the force falls a tenth as much",
    grade="stop",
)
def columns_plausible(test: RampHold) -> Finding:
    """In the hold the displacement rests and the force decays, not the reverse."""
    x, f = test.displacement[test.hold], test.force[test.hold]
    tenth = max(len(x) // 10, 1)
    displacement_fall = float(x[:tenth].mean() - x[-tenth:].mean()) / test.depth
    force_fall = float(f[:tenth].mean() - f[-tenth:].mean()) / max(float(np.abs(f).max()), 1e-300)
    return Finding(
        "The displacement rests while the force decays",
        displacement_fall,
        failure=f"Force and displacement look swapped. In the hold the displacement sinks by "
        f"{100 * displacement_fall:.2g} % while the force rests",
        remedy=Remedy("Name the columns.", "column", "force=NAME"),
        always_passes=abs(force_fall) >= 0.1 * displacement_fall,
    )


@criterion("peak / full scale", ">=", 0.05, grade="note")
def load_cell_range_used(peak: float, full_scale: float) -> Finding:
    """The force uses enough of the range of the load cell."""
    used_fraction = peak / full_scale
    return Finding(
        f"The peak force is {100 * used_fraction:.2g} % of the load cell's {full_scale:g} N",
        used_fraction,
        "A smaller load cell would drift and scatter less",
        "Use a smaller load cell.",
    )


# -- Prepared records -----------------------------------------------------------------------------


def check_records(
    tests: Sequence[RampHold], *, method: str, solids: Sequence[GeneralizedMaxwell | None] = ()
) -> tuple[Check, ...]:
    """Return the checks of the records, each at its worst over `tests`.

    `solids` are the fitted ones, one per test: what such a solid explains is no fault.
    """
    stillness_checks = [hold_is_still(test, method=method) for test in tests]
    pairs = zip(tests, solids or [None] * len(tests), strict=True)
    relaxes = [force_relaxes(test, solid) for test, solid in pairs]
    loading, later_checks, of_last = zip(*map(_check_record, tests), strict=True)
    columns = (
        *zip(*loading, strict=True), stillness_checks, *zip(*later_checks, strict=True), relaxes,
        *zip(*of_last, strict=True),
    )  # fmt: skip
    return tuple(map(select_gravest_check, columns))


@cache_on_record
def _check_record(test: RampHold) -> tuple[tuple[Check, ...], tuple[Check, ...], tuple[Check, ...]]:
    """The checks of one record for any fit: before its hold, after it, and of its depth."""
    last_loading = test.last_loading
    loading_checks = (
        force_not_clipped(last_loading),
        force_resolved(last_loading.reading),
        depth_resolved(test),
    )
    later_checks = hold_outlasts_ramp(test), ramp_sampled(test)
    return loading_checks, later_checks, (strain_small(test),)


@criterion(
    "samples at the peak",
    "<",
    MIN_FLAT_SAMPLES,
    "our choice; or a rest or noise explains it",
    grade="stop",
)
def force_not_clipped(test: RampHold) -> Finding:
    """The force is not clipped at its peak."""
    highest_force, count, first, last = _flat_top(test.reading)
    change = float(np.ptp(test.displacement[first : last + 1]))
    is_long = last - first >= MIN_FLAT_SAMPLES - 1
    # of most records no more need be known
    step = find_quantum(test.reading) if is_long else 0.0
    # over so far the force climbs by three quanta even at half its mean rate
    climb = 6 * step * test.depth / max(float(np.ptp(test.force)), 1e-300)
    distance_limit = max(0.02 * test.depth, climb, 4 * test.displacement_noise)
    too_even = last - first >= 9 and 0 < step < 2 * test.force_noise
    return Finding(
        f"The force peaks at {highest_force:.4g} N without a flat top",
        float(count),
        failure=f"The force is clipped at {highest_force:.4g} N. {count} samples have this value "
        f"while the compression grows by {100 * change / test.depth:.0f} % of the depth, so every "
        "stiffness is too low",
        remedy="Use a larger range of the sensor, or press less deep.",
        always_passes=not (is_long and (change > distance_limit or too_even)),
    )


@criterion(
    "rise / step of the sensor",
    ">=",
    MIN_QUANTA,
    "our choice: a decay is then visible",
    grade="stop",
)
def force_resolved(force: FloatArray, loading_rise: float | None = None) -> Finding:
    """The force is many times the resolution of the load cell."""
    step = find_quantum(force)
    if step == 0.0:
        return Finding("The force shows no quantisation")
    quanta = (float(np.ptp(force)) if loading_rise is None else loading_rise) / step
    return Finding(
        f"The peak force is {quanta:.0f} steps of the sensor's resolution "
        f"({format_quantity(step, 'mN', '.3g')}); at least {MIN_QUANTA:.0f} are needed",
        quanta,
        "Fewer steps cannot show a decay",
        "Press deeper, take a longer specimen, or use a smaller sensor.",
    )


def refuse_unresolved(location: str, loading_rise: float, force: FloatArray) -> None:
    """Raise DataError if the force, as recorded, rises by a few steps of the sensor only."""
    if force_resolved(force, loading_rise).failed:
        step = find_quantum(force)
        raise DataError(
            f"{location}: not fitted. The force rises by "
            f"{format_quantity(loading_rise, 'mN', '.3g')}, {loading_rise / step:.0f} steps of the "
            f"sensor's {format_quantity(step, 'mN', '.3g')}; at least {MIN_QUANTA:.0f} are needed. "
            "Press deeper, take a longer specimen, or use a smaller sensor."
        )


def refuse_saturated(location: str, test: RampHold) -> None:
    """Raise DataError if the force has a flat top: a fit through it is wrong everywhere."""
    test = test.last_loading
    if not force_not_clipped(test).failed:
        return
    plausibility_check = columns_plausible(test)
    if plausibility_check.failed:
        raise DataError(
            f"{location}: {decapitalise_sentence(plausibility_check.message_with_remedy)}"
        )
    highest_force, _, first, last = _flat_top(test.force)
    raise DataError(
        f"{location}: not fitted. The force is clipped at {highest_force:.4g} N above the tare "
        f"from {test.time[first]:.3g} to {test.time[last]:.3g} s ({last - first + 1} samples). A "
        "fit through it would be wrong. Choose a larger load-cell range or a smaller compression, "
        "and repeat the test."
    )


def _flat_top(force: FloatArray) -> tuple[float, int, int, int]:
    """Return the highest force, how often it is read, and its longest run: first and last."""
    highest_force = float(force.max())
    at_top = force >= highest_force - 1e-9 * abs(highest_force)
    runs = find_true_runs(at_top)
    first, last = runs[np.argmax(runs[:, 1] - runs[:, 0])].tolist()
    return highest_force, int(np.count_nonzero(at_top)), first, last


@criterion(
    "its error / depth",
    "<=",
    0.0025,
    "simulation: with steps of 60 um in 5 to 9 mm, 1 result in 5 is wrong",
)
def depth_resolved(test: RampHold) -> Finding:
    """The displacement is resolved finely enough for stiffness and fast arms."""
    depth_error = test.depth_error
    return Finding(
        f"The encoder gives the depth of {format_quantity(test.depth, 'mm')} to "
        f"±{100 * depth_error:.2g} "
        "%. Every stiffness shares this uncertainty, and its standard error includes it",
        depth_error,
        "What lies between its counts on the ramp looks like a fast arm",
        remedy="Use a finer encoder, or press deeper.",
    )


@criterion(
    "motion in the hold / depth", "<=", MAX_CREEP, "our choice; the fit of ramp and hold follows it"
)
def hold_is_still(test: RampHold, *, method: str) -> Finding:
    """The plate rests during the hold, or the fit follows its motion."""
    creep = test.hold_creep
    is_full = method == "full"
    message = f"The displacement changes by {100 * creep:.2g} % of the depth during the hold"
    if is_full and not abs(creep) <= MAX_CREEP:
        message += ". The fit uses the recorded motion, so the result is valid"
    return Finding(
        message,
        abs(creep),
        f"The fit of the hold alone (eq. 5) allows {100 * MAX_CREEP:.0f} %",
        Remedy("Fit ramp and hold together.", "method", "full"),
        always_passes=is_full,
    )


@criterion("hold / ramp", ">=", MIN_HOLD_OVER_RAMP, grade="note", other_grade="limit below 3.3")
def hold_outlasts_ramp(test: RampHold) -> Finding:
    """The hold lasts many times as long as the ramp."""
    ratio = test.hold_time / test.ramp_time
    return Finding(
        f"The hold lasts {ratio:.3g} ramp times; at least {MIN_HOLD_OVER_RAMP:.0f} are needed",
        ratio,
        "The ramp hides the fast decay",
        "Hold longer, or ramp faster.",
        # the recorded ramp is followed, so that hiding some of the decay costs precision alone
        grade="limit" if ratio < MIN_HOLD_OVER_RAMP / 3 else None,
    )


@criterion("samples in the ramp", ">=", MIN_RAMP_SAMPLES)
def ramp_sampled(test: RampHold) -> Finding:
    """The ramp has enough samples to show a fast arm."""
    in_ramp = (test.time >= test.onset) & (test.time <= test.ramp_end)
    count = int(np.count_nonzero(in_ramp))
    return Finding(
        f"The ramp of {test.ramp_time:.3g} s has {count} samples; at least "
        f"{MIN_RAMP_SAMPLES:.0f} are needed",
        float(count),
        "An arm as fast as the ramp cannot be seen",
        "Sample faster.",
    )


@criterion(
    "rise in the hold, N",
    "<=",
    source="7 SE of a tenth of it, or 0.5 % of the force",
    grade="stop",
    fit_status=Status.FORCE_RISES,
)
def force_relaxes(test: RampHold, solid: GeneralizedMaxwell | None = None) -> Finding:
    """The force rises in the hold by no more than the model explains.

    Under a plate that stands still the force of a relaxing solid falls; after an unloading it
    recovers. `solid` is the one fitted, if there is one.
    """
    rise, limit = force_rise(test)
    if solid is not None and rise > limit:
        unexplained = force_rise(test, solid)[0]
        if unexplained <= limit:
            return Finding(
                f"The force rises by {format_quantity(rise, 'mN', '.3g')} after an unloading, as "
                "the fitted model does",
                unexplained,
                limit=limit,
            )
    return Finding(
        "The force does not rise during the hold",
        rise,
        failure=f"The force rises by {format_quantity(rise, 'mN', '.3g')} during the hold; noise "
        f"explains {format_quantity(limit, 'mN', '.3g')}. No relaxing part does that",
        remedy="Look for swelling, warming, a plate that creeps, or a sensor that drifts.",
        limit=limit,
    )


@criterion("depth / height", "<=", 0.20, "our choice: beyond, secant is not tangent")
def strain_small(test: RampHold) -> Finding:
    """The compression is small relative to the height of the section."""
    height = test.specimen.height
    if height is None:
        return Finding("The height of the section is not given, so its strain is not checked")
    strain = test.depth / height
    return Finding(
        f"The section is compressed by {100 * strain:.0f} % of its height",
        strain,
        "At this depth k_inf is a secant stiffness; vibration about it has the tangent stiffness",
        "Test several depths, and fit them together.",
    )


def force_rise(test: RampHold, solid: GeneralizedMaxwell | None = None) -> tuple[float, float]:
    """Return how far the force climbs from its lowest tenth to the last tenth of the hold, N.

    The second value is the rise explained by noise and half a per cent of the force. The part that
    a creeping plate explains by the secant stiffness is taken off first, or with a `solid` its
    whole answer to the recorded motion.
    """
    force, x = test.force[test.hold], test.displacement[test.hold]
    if len(force) < 20:
        return 0.0, np.inf
    secant = max(float(force[-len(force) // 10 :].mean()), 0.0) / test.depth
    response = (
        secant * (x - x.mean()) if solid is None else _compute_response(solid, test)[test.hold]
    )
    tenths = [part.mean() for part in np.array_split(force - response, 10)]
    rise = float(tenths[-1] - min(tenths))
    noise = max(test.force_noise, estimate_robust_scatter(test.time, test.force))
    scatter = noise / np.sqrt(len(force) / 10)
    return rise, float(max(7.0 * scatter, 0.005 * np.abs(force).max()))


def _compute_response(solid: GeneralizedMaxwell, test: RampHold) -> FloatArray:
    """The force of a solid that follows the recorded motion, N, shape (n,)."""
    x = test.displacement
    arms = zip(solid.k, solid.tau, strict=True)
    responses = [k * arm_response(test.time, x, tau) for k, tau in arms]
    return np.asarray(solid.k_inf * x + np.sum(responses, axis=0))
