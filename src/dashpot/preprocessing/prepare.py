"""Preparation of a raw relaxation test: its ramp and hold."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray, median, replace_notes, set_readonly
from dashpot.base.checks import Check
from dashpot.base.errors import DataError
from dashpot.base.provenance import Step, sources_of
from dashpot.base.units import Quantity, convert_to_si, format_quantity
from dashpot.base.value_ranges import SIZES, format_quantity_short
from dashpot.datamodel.checks import caution_checks
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.relaxation import RampHold, RelaxationTest
from dashpot.preprocessing import checks
from dashpot.preprocessing.contact import (
    MIN_BASELINE,
    MOST_DELAY_SD,
    WATCHED_AFTER_RAMP,
    Baseline,
    Lateness,
    Touch,
    baseline_of,
    estimate_contact_delay,
    find_first_contact,
    subtract_tare,
)
from dashpot.preprocessing.denoising import denoise_values
from dashpot.preprocessing.history import EarlierLoadings, follow_history, is_bonded
from dashpot.preprocessing.plate_motion import (
    PlateMotion,
    begins_with_release,
    build_motion_from_times,
    find_motion,
    first_press,
    from_contact,
    presses_before,
)
from dashpot.preprocessing.signal_conditioning import (
    decimate,
    filter_record,
    hum_lines,
    hum_step,
    parse_filter,
    white_noise,
)
from dashpot.signals.clock import is_evenly_sampled
from dashpot.signals.noise import median_of_three, scatter, without_spikes

# times that a gap and a delay are found, each with the other
ROUNDS = 3
# of the samples of a ramp, to tell a delay from air
WATCHED = 8000
# a later clock and less air explain the force better by this deviance
TOLD = 10.0
# of the rise of the force: a loading that raises it by less meets no seal
LEAST_PRESS = 0.01


def prepare(
    test: RelaxationTest,
    *,
    sign: int | None = None,
    contact: Quantity | None = None,
    onset: Quantity | None = None,
    ramp_end: Quantity | None = None,
    hold_end: Quantity | None = None,
    cycle: int | None = None,
    filter: str | None = None,
    drift: float | str | None = None,
    force_range: Quantity | None = None,
    machine: Machine | None = None,
    judged: bool = True,
) -> RampHold:
    r"""Return a test with its ramp and hold found, tared and counted from first contact.

    What the machine is known to add, such as its deflection or hum, is taken off.

    Everything is read from the record: which way is compression, where the displacement
    ramps and rests, where the force leaves its baseline. What was done is kept in ``steps``,
    what deserves a second look in ``checks``. Nothing is filtered unless asked for.

    The ramp is the straight line through its middle, extended to contact and to the held
    depth: the equal-speed ramp of eq. 5 with the lag of the axis taken out. The displacement
    itself is kept as recorded, lag, overshoot and all, for the full-history fit.

    Parameters
    ----------
    test : RelaxationTest
        As recorded. It is not changed.
    sign : {1, -1}, optional
        1 keeps the signs of both channels, -1 turns both; by default each is turned so that
        the ramp compresses and the force answers.
    contact : float, optional
        Displacement at first contact, m, as the record counts it; found by default.
    onset, ramp_end, hold_end : float, optional
        Seconds on the clock of the record; found by default. With all three given the
        displacement is not searched for ramps.
    cycle : int, optional
        Which loading, from 1, if the record holds several that return to the start; by default
        the one with the longest hold.
    filter : str, optional
        ``"lowpass:10Hz"``, ``"notch:50Hz"`` (zero phase; with ``":causal"`` not) or
        ``"median:5"``. The fit predicts the bias it brings, and reports it.
    drift : float or "baseline", optional
        Drift of the load cell to take off, N/s, or the slope of the baseline. By default none
        is taken off: the full-history fit estimates it.
    force_range : float, optional
        Full scale of the load cell, N, to say how much of it the test used.
    machine : Machine, optional
        What is known of the machine: clocks, drift, compliance, a filter in the force channel.
    judged : bool
        False leaves ``checks`` empty, for whoever asks for an optimum alone; what no fit could be
        made of is refused all the same.

    Raises
    ------
    DataError
        If there is no ramp, no hold, a force on both sides of zero, a saturated or an
        unresolved force, or times out of order.
    """
    contact, onset, ramp_end = (
        convert_to_si(contact, "length"),
        convert_to_si(onset, "time"),
        convert_to_si(ramp_end, "time"),
    )
    hold_end, force_range = convert_to_si(hold_end, "time"), convert_to_si(force_range, "force")
    where = test.source.file if test.source is not None else "the record"
    by = None if filter is None else parse_filter(filter)
    _refuse_choices(sign=sign, drift=drift, force_range=force_range)
    motion = _motion(test, where, sign, cycle, (onset, ramp_end, hold_end))
    clean = without_spikes(test.time, test.force)
    if motion.departure - motion.start < MIN_BASELINE:
        checks.refuse_late_start(where, *_loaded_and_relaxed(clean, motion))
    turn = _force_sign(clean, motion) if sign is None else sign
    x, force = motion.sign * test.displacement, turn * test.force
    count = test.displacement_quantum
    gap = _least_gap(count, motion)
    machine = machine or Machine()
    if machine.rest is None:
        machine = replace(machine, rest=test.specimen.rested)
    step = median(np.diff(test.time))
    late = machine.delay_sd(step)
    before, touch = _touch(
        test.time, x, turn * clean, motion, provided=contact, least_gap=gap, delay_sd=late
    )
    pressed = from_contact(test, motion, touch.displacement, doubt=gap)
    if pressed is not motion:
        # the plate was first moved through air: the ramp that meets the seal is the first
        motion = pressed
        gap = _least_gap(count, motion)
        before, touch = _touch(
            test.time, x, turn * clean, motion, provided=contact, least_gap=gap, delay_sd=late
        )
    earlier = _earlier(test, x, turn * clean, motion, (before, touch), provided=contact, late=late)
    if earlier is not None:
        before, touch = earlier.zero, earlier.met_again
    force, tared = subtract_tare(test.time, force, before, drift=drift, where=where)
    times = _times(motion, touch, test.time, step, (onset, ramp_end, hold_end))
    record = _record(test, x, force, motion, touch, times=times, count=count, earlier=earlier)
    # of a long record every channel weighs: these are not needed beside its spectrum
    del clean, x, force
    record = _without_hum(record)
    rise = _risen(record, before, where, pulled=earlier is not None and earlier.bonded)
    # a force that is the same whenever the plate is away is the cell's own
    preload = _preload(record, before, touch, rise)
    if earlier is not None:
        touch = earlier.touch
    machine.refuse_unused(
        "sync", "drift", "compliance", "creep", "force_filter", "rest", of="a ramp and hold"
    )
    record = _on_the_machine(record, preload, machine)
    past = None
    if earlier is not None:
        record, past = follow_history(record)
    checks.refuse_unresolved(where, rise, test.force)
    checks.refuse_saturated(where, record)
    SIZES["ramp"].refuse(
        record.ramp_time,
        f"{where}: the ramp takes {format_quantity_short(record.ramp_time, 's')}",
        remedy="Check the unit of time: --units time=ms (Python: units='ms, mm, N').",
    )
    last = record.last_loading
    raw = slice(motion.stop + 1 - len(last.time), motion.stop + 1)
    answers = (
        []
        if not judged
        else [
            checks.single_loading(
                motion.index,
                motion.cycles,
                requested=cycle is not None,
                before=presses_before(motion),
            ),
            checks.baseline_recorded(before),
            checks.contact_found(touch, record.depth, provided=contact is not None),
            checks.preload_absent(
                preload, rise, moving=earlier is None and motion.cycle.rest is None
            ),
            checks.overshoot_small(last, moves=motion.cycle.moves),
            checks.samples_unbroken(last),
            checks.clock_steady(last, _clock(test.time, motion, hold_end)),
            checks.spikes_absent(last),
            checks.readings_not_repeated(last, test.force[raw], test.displacement[raw]),
            checks.columns_plausible(last),
            checks.motion_resolved(last),
            checks.motion_measured(last),
            *checks.check_temperature(test.specimen),
            *caution_checks(sources_of([test])),
        ]
    )
    if judged:
        answers += _check_history(record, motion, earlier, past)
    if judged and force_range is not None:
        answers.append(checks.load_cell_range_used(rise, force_range))
    steps = [
        _make_orientation_step(motion.sign, turn),
        _make_segments_step(motion, record),
        _make_contact_step(touch),
        tared,
    ]
    steps += [
        *_make_machine_steps(record.machine),
        _make_ramp_step(record, motion),
        *hum_step(record.hum),
    ]
    if past is not None:
        steps.append(_followed_step(record, past, len(presses_before(motion))))
    record = decimate(replace_notes(record, steps=tuple(steps), checks=tuple(answers)))
    return record if by is None else filter_record(record, by)


def _check_history(
    record: RampHold,
    motion: PlateMotion,
    earlier: _Earlier | None,
    past: EarlierLoadings | None,
) -> list[Check]:
    """Return the checks of what came before the loading that is fitted, if anything did."""
    pressed = begins_with_release(motion)
    if past is not None and earlier is not None:
        return checks.history_checks(record, past, earlier.met_again, pressed=pressed)
    nothing = EarlierLoadings(0.0, 0, converged=True)
    return [checks.history_explained(nothing, broken=False, pressed=True)] if pressed else []


class _Earlier(NamedTuple):
    """What came before the loading that is fitted.

    Attributes
    ----------
    touch : Touch
        First contact of the first loading: the zero of compression.
    met_again : Touch
        Where the plate met the seal in the loading that is fitted.
    zero : Baseline
        Of the force while the seal was free.
    bonded : bool
        The seal pulls at a plate that goes back.
    moves : int
        The first sample after first contact.
    """

    touch: Touch
    met_again: Touch
    zero: Baseline
    bonded: bool
    moves: int


def _earlier(
    test: RelaxationTest,
    x: FloatArray,
    force: FloatArray,
    motion: PlateMotion,
    last: tuple[Baseline, Touch],
    *,
    provided: float | None,
    late: float,
) -> _Earlier | None:
    """Return what came before the loading that is fitted; None if nothing that pressed the seal."""
    before, touch = last
    if not presses_before(motion):
        return None
    peak = float(np.ptp(force[motion.start : motion.stop + 1]))
    late_hold = slice(motion.cycle.hold.first, motion.stop + 1)
    noise = scatter(test.time[late_hold], force[late_hold])
    least = max(8 * noise, LEAST_PRESS * peak)
    first = first_press(test, motion, force, least=least)
    if first is None:
        return None
    # of the depth that is fitted: what is too small for it is none of a shallow press
    gap = _least_gap(test.displacement_quantum, motion)
    zero, met = _touch(test.time, x, force, first, provided=provided, least_gap=gap, delay_sd=late)
    moves = first.departure + 1 + int(np.argmax(x[first.departure + 1 :] > met.displacement))
    tare = zero.level if zero.long_enough else before.level if before.long_enough else 0.0
    past = slice(moves, motion.departure + 1)
    bonded = is_bonded(
        force[past] - tare, x[past] - met.displacement, noise=noise, peak=peak,
        depth=motion.level - met.displacement,
    )  # fmt: skip
    if bonded:
        return _Earlier(met, Touch(motion.rest, 0.0), zero, True, moves)
    # in air the force is zero now; on the seal it was before all
    away = touch.gap > 0 and before.long_enough
    return _Earlier(met, touch, before if away or not zero.long_enough else zero, False, moves)


def _refuse_choices(
    *, sign: int | None, drift: float | str | None, force_range: float | None
) -> None:
    if sign not in {None, 1, -1}:
        raise DataError(f"sign = {sign!r}; expected 1, -1 or None")
    if isinstance(drift, str) and drift != "baseline":
        raise DataError(f"drift = {drift!r}; expected a number in N/s, 'baseline' or None")
    if force_range is not None and not force_range > 0:
        raise DataError(f"force_range = {force_range!r} N; expected a number > 0")


def _motion(
    test: RelaxationTest,
    where: str,
    sign: int | None,
    cycle: int | None,
    times: tuple[float | None, float | None, float | None],
) -> PlateMotion:
    onset, ramp_end, hold_end = times
    if onset is not None and ramp_end is not None and hold_end is not None:
        return build_motion_from_times(
            test, onset=onset, ramp_end=ramp_end, hold_end=hold_end, sign=sign
        )
    if hold_end is not None:
        # what comes after a given end is not there
        until = int(np.searchsorted(test.time, hold_end, side="right"))
        if until < 8:
            raise DataError(f"hold_end = {hold_end:g} s leaves {until} samples; expected 8 or more")
        test = RelaxationTest(
            test.time[:until], test.displacement[:until], test.force[:until], units="SI"
        )
    return find_motion(test, where=where, sign=sign, number=cycle)


def _clock(time: FloatArray, motion: PlateMotion, hold_end: float | None) -> FloatArray:
    """The clock that a record of one loading may be asked about: up to where it is cut by hand."""
    if len(motion.cycles) > 1:
        return time[motion.start : motion.stop + 1]
    return time if hold_end is None else time[time <= hold_end]


def _loaded_and_relaxed(force: FloatArray, motion: PlateMotion) -> tuple[float, float]:
    """How far the force goes from its first value in the ramps, and on from there in the hold."""
    loaded, held = force[motion.start : motion.cycle.hold.first + 1], force[: motion.stop + 1]
    first = median(force[motion.start : motion.departure + 1])
    furthest = float(loaded[np.argmax(np.abs(loaded - first))])
    last = median(held[-max((motion.stop - motion.cycle.hold.first) // 10, 1) :])
    return furthest - first, last - furthest


def _force_sign(force: FloatArray, motion: PlateMotion) -> int:
    """1 if the force rises as the plate presses, else -1."""
    before = median(force[motion.start : motion.departure + 1][-50:])
    after = force[motion.line.last : motion.stop + 1]
    furthest = after[np.argmax(np.abs(after - before))]
    return 1 if furthest >= before else -1


def _touch(
    time: FloatArray,
    x: FloatArray,
    force: FloatArray,
    motion: PlateMotion,
    *,
    provided: float | None,
    least_gap: float,
    delay_sd: float,
) -> tuple[Baseline, Touch]:
    """First contact, and the baseline before it."""
    still = slice(motion.start, motion.departure + 1)
    before = baseline_of(time[still], force[still])
    if provided is not None:
        at = motion.sign * provided
        if at >= motion.cycle.hold.level:
            raise DataError(
                f"contact = {provided:g} m lies at or beyond the held displacement, "
                f"{motion.sign * motion.cycle.hold.level:g} m; expected it before"
            )
        touch = Touch(at, at - motion.rest)
    else:
        peak = motion.line.last + int(np.argmax(force[motion.line.last : motion.stop + 1]))
        rising = slice(motion.start, peak + 1)
        level, noise = before.level, before.noise
        if not before.long_enough:
            level = median(force[rising][:5])
            noise = scatter(time[rising], force[rising])

        def find_touch(displacement: FloatArray) -> Touch:
            return find_first_contact(
                displacement[rising],
                force[rising] - level,
                noise=max(noise, 1e-6 * (float(force[peak]) - level)),
                rest=motion.rest,
                level=motion.cycle.hold.level,
                least_gap=least_gap,
                rested=motion.cycle.rest is not None,
            )

        touch = _but_late(time, x, force, motion, find_touch, delay_sd=delay_sd)
    if touch.gap > 0:
        # half of the air is far enough from contact to be called quiet
        approach = x[motion.start : motion.stop + 1] > motion.rest + 0.5 * touch.gap
        quiet = slice(motion.start, max(motion.start + int(np.argmax(approach)), still.stop))
        before = baseline_of(time[quiet], force[quiet])
    return before, touch


def _but_late(
    time: FloatArray,
    x: FloatArray,
    force: FloatArray,
    motion: PlateMotion,
    met: Callable[[FloatArray], Touch],
    *,
    delay_sd: float,
) -> Touch:
    """First contact behind air as `met` finds it, less what only the clock of the force makes."""
    touch = met(x)
    if not touch.gap > 0:
        return touch
    ends = motion.line.time_of(motion.rest), motion.line.time_of(motion.level)
    until = int(np.searchsorted(time, ends[1] + WATCHED_AFTER_RAMP * (ends[1] - ends[0])))
    until = min(until, motion.stop + 1)
    watched = slice(motion.start, until, max(1, (until - motion.start) // WATCHED))

    def late_from(contact: float) -> Lateness:
        pressed = np.maximum(x[watched] - contact, 0.0)
        return estimate_contact_delay(
            time[watched], pressed, force[watched], corners=ends, delay_sd=delay_sd
        )

    best, behind = touch, late_from(touch.displacement)
    if touch.gap <= MOST_DELAY_SD * delay_sd * motion.line.speed:
        at_rest = late_from(motion.rest)
        if at_rest.deviance < behind.deviance - TOLD:
            best, behind = Touch(motion.rest, 0.0), at_rest
    for _ in range(ROUNDS if behind.delay else 0):
        # the plate as it was when the force that is read was felt
        touch = met(np.interp(time - behind.delay, time, x))
        again = late_from(touch.displacement)
        if again.deviance > behind.deviance - TOLD:
            break
        best, behind = touch, again
    return best


def _least_gap(count: float, motion: PlateMotion) -> float:
    """Return the smallest air gap worth telling from none, m."""
    return max(2 * count, 0.005 * (motion.cycle.hold.level - motion.rest))


def _times(
    motion: PlateMotion,
    touch: Touch,
    time: FloatArray,
    step: float,
    provided: tuple[float | None, float | None, float | None],
) -> tuple[float, float, float]:
    onset, ramp_end, hold_end = provided
    last = float(time[motion.stop])
    if onset is None:
        onset = max(
            _snap_to_sample(motion.line.time_of(touch.displacement), time, step), float(time[0])
        )
    if ramp_end is None:
        ramp_end = _snap_to_sample(motion.line.time_of(motion.level), time, step)
    return onset, ramp_end, last if hold_end is None else min(hold_end, last)


def _snap_to_sample(moment: float, time: FloatArray, step: float) -> float:
    """Return a moment that only rounding parts from a sample is that sample."""
    i = int(np.argmin(np.abs(time - moment)))
    return float(time[i]) if abs(time[i] - moment) < 1e-6 * step else moment


def _record(
    test: RelaxationTest,
    x: FloatArray,
    force: FloatArray,
    motion: PlateMotion,
    touch: Touch,
    *,
    times: tuple[float, float, float],
    count: float,
    earlier: _Earlier | None = None,
) -> RampHold:
    """Trim to the loading, or to all up to it, and count compression from first contact."""
    onset, ramp_end, hold_end = times
    if not onset < ramp_end < hold_end:
        raise DataError(
            f"onset {onset:.6g} s, ramp end {ramp_end:.6g} s and hold end {hold_end:.6g} s are out "
            "of order; expected them in this order"
        )
    if earlier is None:
        span = slice(motion.start, motion.stop + 1)
        compression = np.maximum(x - touch.displacement, 0.0)
        # before the plate departs, whatever the encoder shows is scatter
        if touch.gap >= 0:
            compression[: motion.departure + 1] = 0.0
    else:
        span, touch = slice(0, motion.stop + 1), earlier.touch
        compression = x - touch.displacement
        compression[: earlier.moves] = 0.0
    t = test.time
    held = slice(int(np.searchsorted(t, max(ramp_end, motion.cycle.hold.start))), motion.stop + 1)
    if held.stop - held.start < 3:
        raise DataError(
            f"{held.stop - held.start} samples lie between the ramp end, {ramp_end:g} s, and the "
            f"hold end, {hold_end:g} s; expected at least 3"
        )
    late = slice(held.start + (held.stop - held.start) // 10, held.stop)
    return RampHold(
        time=t[span],
        displacement=set_readonly(compression)[span],
        force=set_readonly(force)[span],
        onset=onset,
        ramp_end=ramp_end,
        hold_end=hold_end,
        depth=_mean(t[held], compression[held]),
        force_noise=scatter(t[late], force[late]),
        displacement_noise=max(scatter(t[late], x[late]), count / 12**0.5),
        contact_error=touch.standard_error,
        specimen=test.specimen,
        source=test.source,
        gap=max(touch.gap, 0.0),
        loading_start=None if earlier is None else float(t[motion.start]),
        plate=None if earlier is None or earlier.bonded else set_readonly(compression.copy())[span],
    )


def _set_broadband_noise(record: RampHold) -> RampHold:
    """Return the record whose noise is what is left beside lines that force and plate have both.

    From sample to sample they scatter, but they are motion and its response: no mean takes them
    off, and no residual may be as large.
    """
    time, x, force = (
        channel[record.hold] for channel in (record.time, record.displacement, record.force)
    )
    least = record.displacement_quantum / 12**0.5
    return replace(
        record,
        displacement_noise=min(record.displacement_noise, max(white_noise(time, x), least)),
        force_noise=min(record.force_noise, white_noise(time, force)),
    )


def _without_hum(record: RampHold) -> RampHold:
    """Take the lines of the hold off the whole force, on a uniform clock."""
    held = record.hold
    time, force = record.time[held], record.force[held]
    if not is_evenly_sampled(time):
        return record
    lines, hum, responds = hum_lines(
        record.time,
        without_spikes(time, force),
        held,
        noise=record.force_noise,
        displacement=record.displacement[held],
    )
    if responds:
        record = _set_broadband_noise(record)
    if not lines:
        return record
    force = set_readonly(record.force - hum)
    late = slice(held.start + (held.stop - held.start) // 10, held.stop)
    noise = scatter(record.time[late], force[late])
    return replace(record, force=force, force_noise=noise, hum=lines)


def _mean(time: FloatArray, values: FloatArray) -> float:
    """Return mean over time, whatever the sampling."""
    steps = np.diff(time)
    return float(steps @ (values[1:] + values[:-1]) / (2 * steps.sum()))


def _risen(record: RampHold, before: Baseline, where: str, *, pulled: bool = False) -> float:
    """Return the peak of the force over its baseline, N, on one side of zero."""
    loaded = record.force[np.searchsorted(record.time, record.onset) :]
    start = 0.0 if before.long_enough else float(record.force[0])
    loaded = median_of_three(loaded) if len(loaded) > 50 else loaded
    peak, least = float(loaded.max()) - start, float(loaded.min()) - start
    if peak <= 8 * record.force_noise:
        raise DataError(
            f"{where}: the force does not rise while the plate presses (by "
            f"{format_quantity(peak, 'mN', '.3g')}, with a scatter of "
            f"{format_quantity(record.force_noise, 'mN', '.3g')}); check the force column, its "
            "unit and "
            "the sign"
        )
    if before.long_enough and not pulled and least < -max(8 * record.force_noise, 0.1 * peak):
        raise DataError(
            f"{where}: the force has mixed signs: between onset and hold end it rises to "
            f"{peak:.4g} N above its baseline and falls to {-least:.4g} N below it; a pressed seal "
            "only pushes. Check the tare, the sign and the columns, or cut the file before that"
        )
    return peak


def _preload(record: RampHold, before: Baseline, touch: Touch, rise: float) -> float:
    """Return what the load cell carries at the start in contact; an air gap carries nothing."""
    if touch.gap > 0:
        return 0.0
    if before.long_enough:
        return before.level if abs(before.level) > checks.MAX_PRELOAD * rise else 0.0
    first = float(record.force[0])
    return first if abs(first) > max(5 * record.force_noise, 0.01 * rise) else 0.0


def _on_the_machine(record: RampHold, preload: float, machine: Machine) -> RampHold:
    """Return the record of that machine: its give, C F, is off displacement and depth."""
    if not machine.compliance:
        return replace(record, preload=preload, machine=machine)
    # the noise of the force moved no plate: answered as motion, it would rule out fast arms
    force = record.force
    if record.force_noise > 0:
        force, _ = denoise_values(force, record.force_noise)
    pressed = record.displacement > 0
    deflection = np.where(pressed, machine.compliance * (force - preload), 0.0)
    sank = _mean(record.time[record.hold], deflection[record.hold])
    if not sank < record.depth:
        raise DataError(
            f"a machine of {format_quantity(machine.compliance, 'um/N')} gives "
            f"{format_quantity(sank, 'mm')} under "
            f"the force of the hold, and the plate moved {format_quantity(record.depth, 'mm')}; "
            "check the "
            "unit of the compliance"
        )
    return replace(
        record,
        displacement=record.displacement - deflection,
        plate=None if record.plate is None else record.plate - deflection,
        depth=record.depth - sank,
        preload=preload,
        machine=machine,
        machine_deflection=deflection,
    )


def _followed_step(record: RampHold, past: EarlierLoadings, many: int) -> Step:
    face = (
        "the seal is bonded, or the plate never left it: it moves as the plate does"
        if record.plate is None
        else f"where the plate is away the seal recovers under no force, as a solid of {past.arms} "
        f"arm{'s' * (past.arms != 1)} does"
    )
    message = f"{many} earlier loading{'s' * (many != 1)} followed from the first sample on; {face}"
    return Step("history", (("loadings", str(many)), ("misfit", f"{past.misfit:.4g}")), message)


def _make_machine_steps(machine: Machine) -> tuple[Step, ...]:
    """Return what was said of the machine, and what is done with it."""
    done = (
        ("sync_s", machine.sync, "clocks known to {:.4g} s"),
        ("drift_n_per_s", machine.drift, "load cell that drifts by {:.4g} N/s (one SD)"),
        ("compliance_m_per_n", machine.compliance or None,
         "machine that gives {:.4g} m/N, taken off the displacement with the force freed of noise"),
        ("creep_m", machine.creep, "crosshead that creeps by {:.4g} m in e-fold time (one SD)"),
        ("rest_s", machine.rest, "seal that rested for {:.4g} s before its record"),
        ("force_filter_hz", machine.force_filter,
         "force behind a first-order low-pass of {:.4g} Hz, which the fit's motion passes too"),
    )  # fmt: skip
    stated = [(name, value, words) for name, value, words in done if value is not None]
    if not stated:
        return ()
    message = "; ".join(words.format(value) for _, value, words in stated)
    return (Step("machine", tuple((name, repr(value)) for name, value, _ in stated), message),)


def _make_orientation_step(displacement: int, force: int) -> Step:
    words = {
        (1, 1): "compression and force count upwards, as recorded",
        (-1, -1): "displacement and force count downwards in the record; both are turned",
        (-1, 1): "displacement counts downwards in the record and is turned",
        (1, -1): "force counts downwards in the record and is turned",
    }
    parameters = (("displacement_sign", str(displacement)), ("force_sign", str(force)))
    return Step("orientation", parameters, words[displacement, force])


def _make_segments_step(motion: PlateMotion, record: RampHold) -> Step:
    message = (
        f"{motion.cycle.words()}; the {len(record.time)} samples from {record.time[0]:.6g} s to "
        f"{record.time[-1]:.6g} s are kept"
    )
    return Step("segments", (("cycle", f"{motion.index + 1} of {len(motion.cycles)}"),), message)


def _make_contact_step(touch: Touch) -> Step:
    message = (
        f"an air gap of {format_quantity(touch.gap, 'mm')} is taken off the displacement"
        if touch.gap > 0
        else "contact where the motion begins"
    )
    return Step("contact", (("displacement_m", repr(touch.displacement)),), message)


def _make_ramp_step(record: RampHold, motion: PlateMotion) -> Step:
    message = (
        f"the ramp runs at {format_quantity(motion.line.speed, 'mm/s')} from {record.onset:.6g} s "
        "to "
        f"{record.ramp_end:.6g} s ({record.ramp_time:.5g} s), the hold to {record.hold_end:.6g} s "
        f"({record.hold_time:.5g} s), at {format_quantity(record.depth, 'mm', '.5g')}"
    )
    parameters = (
        ("onset_s", repr(record.onset)),
        ("ramp_end_s", repr(record.ramp_end)),
        ("hold_end_s", repr(record.hold_end)),
        ("depth_m", repr(record.depth)),
    )
    return Step("ramp", parameters, message)
