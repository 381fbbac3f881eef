"""Preparation of a raw relaxation test: its ramp and hold."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray, median, replace_notes, set_readonly
from dashpot.base.checks import Check, Remedy
from dashpot.base.errors import DataError
from dashpot.base.provenance import Step, list_sources
from dashpot.base.units import Quantity, convert_to_si, format_quantity
from dashpot.base.value_ranges import SIZES, format_quantity_short
from dashpot.datamodel.checks import caution_checks
from dashpot.datamodel.machine import Machine, MachineCalibration
from dashpot.datamodel.relaxation import RampHold, RelaxationTest
from dashpot.preprocessing import checks
from dashpot.preprocessing.contact import (
    MAX_DELAY_SD,
    MIN_BASELINE,
    SPAN_AFTER_RAMP,
    Baseline,
    DelayEstimate,
    Touch,
    estimate_baseline,
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
    find_first_press,
    find_motion,
    follow_contact,
    list_earlier_presses,
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
from dashpot.signals.noise import median_of_three, remove_spikes, scatter

# Number of iterations of air gap and delay.
MAX_ITERATIONS = 3
# samples of a ramp that distinguish a delay from an air gap
MAX_DELAY_SAMPLES = 8000
# fall of the deviance from which a delay replaces an air gap
MIN_DEVIANCE_GAIN = 10.0
# part of the rise of the force below which a loading meets no seal
MIN_FORCE_RISE = 0.01


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
    with_checks: bool = True,
) -> RampHold:
    r"""Return the ramp and hold of a test: tared, compression counted from first contact.

    The record shows the direction of compression, the ramp, the hold and the baseline of the
    force. Known effects of the machine, such as its deflection and hum, are subtracted. ``steps``
    lists what was done, ``checks`` what needs attention. Nothing is filtered by default.

    The ramp is the straight line through its middle, extended to contact and to the held
    depth: the ramp of constant speed of eq. 5, without the lag of the axis. The displacement
    itself stays as recorded, with lag and overshoot, for the fit of the full history.

    Parameters
    ----------
    test : RelaxationTest
        As recorded. It is not changed.
    sign : {1, -1}, optional
        1 keeps the signs of both channels, -1 changes both; by default displacement and force
        both rise with compression.
    contact : float, optional
        Displacement at first contact, m, in the coordinates of the record; found by default.
    onset, ramp_end, hold_end : float, optional
        Seconds on the clock of the record; found by default. With all three given the
        displacement is not searched for ramps.
    cycle : int, optional
        Which loading, from 1, if the record holds several that return to the start; by default
        the one with the longest hold.
    filter : str, optional
        ``"lowpass:10Hz"``, ``"notch:50Hz"`` (zero phase; with ``":causal"`` not) or
        ``"median:5"``. The fit predicts and reports the bias of the filter.
    drift : float or "baseline", optional
        Drift of the load cell to subtract, N/s, or the slope of the baseline. By default none:
        the fit of the full history estimates it.
    force_range : float, optional
        Full scale of the load cell, N, for the check of the range used.
    machine : Machine, optional
        Known properties: clocks, drift, compliance, a filter in the force channel.
    with_checks : bool
        False leaves ``checks`` empty; a record that no fit can use is refused all the same.

    Raises
    ------
    DataError
        If there is no ramp, no hold, a force on both sides of zero, a saturated or an
        unresolved force, or times out of order.
    """
    contact = convert_to_si(contact, "length")
    onset = convert_to_si(onset, "time")
    ramp_end = convert_to_si(ramp_end, "time")
    hold_end, force_range = convert_to_si(hold_end, "time"), convert_to_si(force_range, "force")
    location = test.source.file if test.source is not None else "the record"
    parsed_filter = None if filter is None else parse_filter(filter)
    machine = machine or Machine()
    test = _calibrate_record(test, machine.calibration)
    _refuse_options(sign=sign, drift=drift, force_range=force_range)
    motion = _find_plate_motion(test, location, sign, cycle, (onset, ramp_end, hold_end))
    despiked_force = remove_spikes(test.time, test.force)
    if motion.last_rest_sample - motion.start < MIN_BASELINE:
        checks.refuse_late_start(location, *_compute_force_changes(despiked_force, motion))
    force_sign = _determine_force_sign(despiked_force, motion) if sign is None else sign
    x, force = motion.sign * test.displacement, force_sign * test.force
    despiked_force = force_sign * despiked_force
    encoder_step = test.displacement_quantum
    least_gap = _compute_least_gap(encoder_step, motion)
    if machine.rest is None:
        machine = replace(machine, rest=test.specimen.rested)
    step = median(np.diff(test.time))
    delay_sd = machine.delay_sd(step)
    find_contact = partial(
        _find_contact, test.time, x, despiked_force, provided_contact=contact, delay_sd=delay_sd
    )
    baseline, first_contact = find_contact(motion, least_gap=least_gap)
    contact_motion = follow_contact(test, motion, first_contact.displacement, tolerance=least_gap)
    if contact_motion is not motion:
        # the plate was first moved through air: the ramp that touches the seal is the first
        motion = contact_motion
        least_gap = _compute_least_gap(encoder_step, motion)
        baseline, first_contact = find_contact(motion, least_gap=least_gap)
    earlier_loading = _find_earlier_loading(
        test, x, despiked_force, motion, (baseline, first_contact), find_contact=find_contact
    )
    if earlier_loading is not None:
        baseline, first_contact = earlier_loading.baseline, earlier_loading.last_touch
    force, tare_step = subtract_tare(test.time, force, baseline, drift=drift, location=location)
    times = _determine_phase_times(
        motion, first_contact, test.time, step, (onset, ramp_end, hold_end)
    )
    record = _build_record(
        test,
        x,
        force,
        motion,
        first_contact,
        times=times,
        encoder_step=encoder_step,
        earlier_loading=earlier_loading,
    )
    # frees the memory of a long record before its spectrum is computed
    del despiked_force, find_contact, x, force
    record = _subtract_hum(record)
    rise = _compute_force_rise(
        record,
        baseline,
        location,
        may_pull=earlier_loading is not None and earlier_loading.is_bonded,
    )
    # a force that is the same whenever the plate is away is the offset of the load cell
    preload = _compute_preload(record, baseline, first_contact, rise)
    if earlier_loading is not None:
        first_contact = earlier_loading.touch
    machine.refuse_unused(
        "sync", "drift", "compliance", "creep", "force_filter", "rest", subject="a ramp and hold"
    )
    record = _subtract_machine_deflection(record, preload, machine)
    history = None
    if earlier_loading is not None:
        record, history = follow_history(record)
    checks.refuse_unresolved(location, rise, test.force)
    checks.refuse_saturated(location, record)
    SIZES["ramp"].refuse(
        record.ramp_time,
        f"{location}: the ramp takes {format_quantity_short(record.ramp_time, 's')}",
        remedy="Check the unit of time: --units time=ms (Python: units='ms, mm, N').",
    )
    loading = record.last_loading
    loading_samples = slice(motion.stop + 1 - len(loading.time), motion.stop + 1)
    all_checks = (
        []
        if not with_checks
        else [
            checks.single_loading(
                motion.cycle_index,
                motion.cycles,
                is_requested=cycle is not None,
                earlier_loadings=list_earlier_presses(motion),
            ),
            checks.baseline_recorded(baseline),
            checks.contact_detected(first_contact, record.depth, is_given=contact is not None),
            checks.preload_absent(
                preload, rise, is_moving=earlier_loading is None and motion.cycle.rest is None
            ),
            checks.overshoot_small(loading, ramp_count=motion.cycle.ramp_count),
            checks.samples_unbroken(loading),
            checks.clock_steady(loading, _select_times(test.time, motion, hold_end)),
            checks.spikes_absent(loading),
            checks.readings_not_repeated(
                loading, test.force[loading_samples], test.displacement[loading_samples]
            ),
            checks.columns_plausible(loading),
            checks.motion_resolved(loading),
            checks.motion_measured(loading),
            *_check_machine(loading),
            *checks.check_temperature(test.specimen),
            *caution_checks(list_sources([test])),
        ]
    )
    if with_checks:
        all_checks += _check_history(record, motion, earlier_loading, history)
    if with_checks and force_range is not None:
        all_checks.append(checks.load_cell_range_used(rise, force_range))
    steps = [
        _make_orientation_step(motion.sign, force_sign),
        _make_segments_step(motion, record),
        _make_contact_step(first_contact),
        tare_step,
    ]
    steps += [
        *_make_machine_steps(record.machine),
        _make_ramp_step(record, motion),
        *hum_step(record.hum),
    ]
    if history is not None:
        steps.append(_make_history_step(record, history, len(list_earlier_presses(motion))))
    record = decimate(replace_notes(record, steps=tuple(steps), checks=tuple(all_checks)))
    return record if parsed_filter is None else filter_record(record, parsed_filter)


def _check_machine(loading: RampHold) -> list[Check]:
    """Return the check of a displacement of the machine, unless its compliance is stated."""
    if loading.machine.compliance is not None:
        return []
    stiffness = float(np.abs(loading.force).max()) / loading.depth
    remedy = Remedy("State the compliance of the machine.", "machine", "compliance=...")
    return checks.check_machine(list_sources([loading]), stiffness, remedy)


def _check_history(
    record: RampHold,
    motion: PlateMotion,
    earlier_loading: _EarlierLoading | None,
    history: EarlierLoadings | None,
) -> list[Check]:
    """Return the checks of the loadings before the fitted one, if there are any."""
    begins_loaded = begins_with_release(motion)
    if history is not None and earlier_loading is not None:
        return checks.history_checks(
            record, history, earlier_loading.last_touch, was_pressed=begins_loaded
        )
    no_history = EarlierLoadings(0.0, 0, converged=True)
    return (
        [checks.history_explained(no_history, has_missing_rows=False, was_pressed=True)]
        if begins_loaded
        else []
    )


class _EarlierLoading(NamedTuple):
    """First contact and baseline of the loadings before the fitted one.

    Attributes
    ----------
    touch : Touch
        First contact of the first loading: the zero of compression.
    last_touch : Touch
        First contact in the fitted loading.
    baseline : Baseline
        Baseline of the force without contact.
    is_bonded : bool
        The seal pulls at a plate that retracts.
    first_sample : int
        The first sample after first contact.
    """

    touch: Touch
    last_touch: Touch
    baseline: Baseline
    is_bonded: bool
    first_sample: int


def _find_earlier_loading(
    test: RelaxationTest,
    x: FloatArray,
    force: FloatArray,
    motion: PlateMotion,
    last_contact: tuple[Baseline, Touch],
    *,
    find_contact: Callable[..., tuple[Baseline, Touch]],
) -> _EarlierLoading | None:
    """Return contact and baseline of earlier loadings; None if there was no contact."""
    last_baseline, last_touch = last_contact
    if not list_earlier_presses(motion):
        return None
    peak = float(np.ptp(force[motion.start : motion.stop + 1]))
    hold_samples = slice(motion.cycle.hold.first, motion.stop + 1)
    noise = scatter(test.time[hold_samples], force[hold_samples])
    least_force = max(8 * noise, MIN_FORCE_RISE * peak)
    first_motion = find_first_press(test, motion, force, min_rise=least_force)
    if first_motion is None:
        return None
    # from the depth of the fitted loading, as a shallow press would allow too small a gap
    least_gap = _compute_least_gap(test.displacement_quantum, motion)
    baseline, first_touch = find_contact(first_motion, least_gap=least_gap)
    first_sample = (
        first_motion.last_rest_sample
        + 1
        + int(np.argmax(x[first_motion.last_rest_sample + 1 :] > first_touch.displacement))
    )
    levels = [
        baseline_result.level
        for baseline_result in (baseline, last_baseline)
        if baseline_result.long_enough
    ]
    tare = [*levels, 0.0][0]
    earlier_samples = slice(first_sample, motion.last_rest_sample + 1)
    pulls_back = is_bonded(
        force[earlier_samples] - tare,
        x[earlier_samples] - first_touch.displacement,
        noise=noise,
        peak=peak,
        depth=motion.hold_position - first_touch.displacement,
    )
    if pulls_back:
        return _EarlierLoading(
            first_touch, Touch(motion.rest_position, 0.0), baseline, True, first_sample
        )
    # lifted off, the force is zero before the last loading; on the seal before the first
    is_lifted = last_touch.gap > 0 and last_baseline.long_enough
    return _EarlierLoading(
        first_touch,
        last_touch,
        last_baseline if is_lifted or not baseline.long_enough else baseline,
        False,
        first_sample,
    )


def _refuse_options(
    *, sign: int | None, drift: float | str | None, force_range: float | None
) -> None:
    if sign not in {None, 1, -1}:
        raise DataError(f"sign = {sign!r}; expected 1, -1 or None")
    if isinstance(drift, str) and drift != "baseline":
        raise DataError(f"drift = {drift!r}; expected a number in N/s, 'baseline' or None")
    if force_range is not None and not force_range > 0:
        raise DataError(f"force_range = {force_range!r} N; expected a number > 0")


def _find_plate_motion(
    test: RelaxationTest,
    location: str,
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
        # samples after a stated end are ignored
        sample_count = int(np.searchsorted(test.time, hold_end, side="right"))
        if sample_count < 8:
            raise DataError(
                f"hold_end = {hold_end:g} s leaves {sample_count} samples; expected 8 or more"
            )
        test = RelaxationTest(
            test.time[:sample_count],
            test.displacement[:sample_count],
            test.force[:sample_count],
            units="SI",
        )
    return find_motion(test, location=location, sign=sign, number=cycle)


def _select_times(time: FloatArray, motion: PlateMotion, hold_end: float | None) -> FloatArray:
    """Return the times whose sampling is checked: of the loading, or up to a stated hold end."""
    if len(motion.cycles) > 1:
        return time[motion.start : motion.stop + 1]
    return time if hold_end is None else time[time <= hold_end]


def _compute_force_changes(force: FloatArray, motion: PlateMotion) -> tuple[float, float]:
    """Return the largest change of the force in the ramps, and its change in the hold."""
    ramp_force = force[motion.start : motion.cycle.hold.first + 1]
    hold_force = force[: motion.stop + 1]
    initial_force = median(force[motion.start : motion.last_rest_sample + 1])
    extreme_force = float(ramp_force[np.argmax(np.abs(ramp_force - initial_force))])
    final_force = median(hold_force[-max((motion.stop - motion.cycle.hold.first) // 10, 1) :])
    return extreme_force - initial_force, final_force - extreme_force


def _determine_force_sign(force: FloatArray, motion: PlateMotion) -> int:
    """Return 1 if the force rises as the plate presses, else -1."""
    rest_force = median(force[motion.start : motion.last_rest_sample + 1][-50:])
    loaded_force = force[motion.straight_ramp.last : motion.stop + 1]
    extreme_force = loaded_force[np.argmax(np.abs(loaded_force - rest_force))]
    return 1 if extreme_force >= rest_force else -1


def _find_contact(
    time: FloatArray,
    x: FloatArray,
    force: FloatArray,
    motion: PlateMotion,
    *,
    provided_contact: float | None,
    least_gap: float,
    delay_sd: float,
) -> tuple[Baseline, Touch]:
    """Return the baseline before first contact, and first contact."""
    rest_samples = slice(motion.start, motion.last_rest_sample + 1)
    baseline = estimate_baseline(time[rest_samples], force[rest_samples])
    if provided_contact is not None:
        contact_displacement = motion.sign * provided_contact
        if contact_displacement >= motion.cycle.hold.level:
            raise DataError(
                f"contact = {provided_contact:g} m lies at or beyond the held displacement, "
                f"{motion.sign * motion.cycle.hold.level:g} m; expected it before"
            )
        first_contact = Touch(contact_displacement, contact_displacement - motion.rest_position)
    else:
        peak = motion.straight_ramp.last + int(
            np.argmax(force[motion.straight_ramp.last : motion.stop + 1])
        )
        loading_samples = slice(motion.start, peak + 1)
        level, noise = baseline.level, baseline.noise
        # a drift is no contact; it is followed no further than half a baseline beyond its end
        time_from_middle = np.minimum(time - baseline.mean_time, baseline.duration)
        steady_force = force - baseline.slope * time_from_middle
        if not baseline.long_enough:
            level = median(force[loading_samples][:5])
            noise = scatter(time[loading_samples], force[loading_samples])

        def find_touch(displacement: FloatArray) -> Touch:
            return find_first_contact(
                displacement[loading_samples],
                steady_force[loading_samples] - level,
                noise=max(noise, 1e-6 * (float(force[peak]) - level)),
                rest_position=motion.rest_position,
                level=motion.cycle.hold.level,
                least_gap=least_gap,
                is_rested=motion.cycle.rest is not None,
            )

        first_contact = _correct_delayed_contact(
            time, x, steady_force, motion, find_touch, delay_sd=delay_sd
        )
    if first_contact.gap > 0:
        # the first half of the air gap is surely without contact
        approach = (
            x[motion.start : motion.stop + 1] > motion.rest_position + 0.5 * first_contact.gap
        )
        quiet_samples = slice(
            motion.start, max(motion.start + int(np.argmax(approach)), rest_samples.stop)
        )
        baseline = estimate_baseline(time[quiet_samples], force[quiet_samples])
    return baseline, first_contact


def _correct_delayed_contact(
    time: FloatArray,
    x: FloatArray,
    force: FloatArray,
    motion: PlateMotion,
    find_touch: Callable[[FloatArray], Touch],
    *,
    delay_sd: float,
) -> Touch:
    """Return first contact behind air, corrected for a delay of the force."""
    first_contact = find_touch(x)
    if not first_contact.gap > 0:
        return first_contact
    ramp_corners = (
        motion.straight_ramp.time_of(motion.rest_position),
        motion.straight_ramp.time_of(motion.hold_position),
    )
    stop = int(
        np.searchsorted(
            time, ramp_corners[1] + SPAN_AFTER_RAMP * (ramp_corners[1] - ramp_corners[0])
        )
    )
    stop = min(stop, motion.stop + 1)
    selected = slice(motion.start, stop, max(1, (stop - motion.start) // MAX_DELAY_SAMPLES))

    def estimate_delay(contact: float) -> DelayEstimate:
        compression = np.maximum(x[selected] - contact, 0.0)
        return estimate_contact_delay(
            time[selected], compression, force[selected], corners=ramp_corners, delay_sd=delay_sd
        )

    best_touch, delay_estimate = first_contact, estimate_delay(first_contact.displacement)
    doubtful_gap = 0.0
    if first_contact.gap <= MAX_DELAY_SD * delay_sd * motion.straight_ramp.speed:
        rest_estimate = estimate_delay(motion.rest_position)
        deviance_fall = delay_estimate.deviance - rest_estimate.deviance
        if deviance_fall > MIN_DEVIANCE_GAIN:
            best_touch, delay_estimate = Touch(motion.rest_position, 0.0), rest_estimate
        elif deviance_fall > -MIN_DEVIANCE_GAIN:
            # the record does not tell a delay from so much air
            doubtful_gap = first_contact.gap
    for _ in range(MAX_ITERATIONS if delay_estimate.delay else 0):
        # the displacement at the time at which the force of each sample arose
        first_contact = find_touch(np.interp(time - delay_estimate.delay, time, x))
        new_estimate = estimate_delay(first_contact.displacement)
        if new_estimate.deviance > delay_estimate.deviance - MIN_DEVIANCE_GAIN:
            break
        best_touch, delay_estimate = first_contact, new_estimate
    return best_touch._replace(standard_error=max(best_touch.standard_error, doubtful_gap))


def _compute_least_gap(encoder_step: float, motion: PlateMotion) -> float:
    """Return the smallest detectable air gap, m."""
    return max(2 * encoder_step, 0.005 * (motion.cycle.hold.level - motion.rest_position))


def _determine_phase_times(
    motion: PlateMotion,
    first_contact: Touch,
    time: FloatArray,
    step: float,
    provided_times: tuple[float | None, float | None, float | None],
) -> tuple[float, float, float]:
    onset, ramp_end, hold_end = provided_times
    last_time = float(time[motion.stop])
    if onset is None:
        onset = max(
            _snap_to_sample(motion.straight_ramp.time_of(first_contact.displacement), time, step),
            float(time[0]),
        )
    if ramp_end is None:
        ramp_end = _snap_to_sample(motion.straight_ramp.time_of(motion.hold_position), time, step)
    return onset, ramp_end, last_time if hold_end is None else min(hold_end, last_time)


def _snap_to_sample(instant: float, time: FloatArray, step: float) -> float:
    """Return the sample time that an instant equals within rounding, else the instant."""
    i = int(np.argmin(np.abs(time - instant)))
    return float(time[i]) if abs(time[i] - instant) < 1e-6 * step else instant


def _build_record(
    test: RelaxationTest,
    x: FloatArray,
    force: FloatArray,
    motion: PlateMotion,
    first_contact: Touch,
    *,
    times: tuple[float, float, float],
    encoder_step: float,
    earlier_loading: _EarlierLoading | None = None,
) -> RampHold:
    """Return the record of the loading, or of all up to it, with compression from contact."""
    onset, ramp_end, hold_end = times
    if not onset < ramp_end < hold_end:
        raise DataError(
            f"onset {onset:.6g} s, ramp end {ramp_end:.6g} s and hold end {hold_end:.6g} s are out "
            "of order; expected them in this order"
        )
    if earlier_loading is None:
        span = slice(motion.start, motion.stop + 1)
        compression = np.maximum(x - first_contact.displacement, 0.0)
        # before the plate moves, the encoder shows scatter only
        if first_contact.gap >= 0:
            compression[: motion.last_rest_sample + 1] = 0.0
    else:
        span, first_contact = slice(0, motion.stop + 1), earlier_loading.touch
        compression = x - first_contact.displacement
        compression[: earlier_loading.first_sample] = 0.0
    time = test.time
    hold_samples = slice(
        int(np.searchsorted(time, max(ramp_end, motion.cycle.hold.start))), motion.stop + 1
    )
    if hold_samples.stop - hold_samples.start < 3:
        raise DataError(
            f"{hold_samples.stop - hold_samples.start} samples lie between the ramp end, "
            f"{ramp_end:g} s, and the hold end, {hold_end:g} s; expected at least 3"
        )
    settled_samples = slice(
        hold_samples.start + (hold_samples.stop - hold_samples.start) // 10, hold_samples.stop
    )
    return RampHold(
        time=time[span],
        displacement=set_readonly(compression)[span],
        force=set_readonly(force)[span],
        onset=onset,
        ramp_end=ramp_end,
        hold_end=hold_end,
        depth=_time_average(time[hold_samples], compression[hold_samples]),
        force_noise=scatter(time[settled_samples], force[settled_samples]),
        displacement_noise=max(
            scatter(time[settled_samples], x[settled_samples]), encoder_step / 12**0.5
        ),
        contact_error=first_contact.standard_error,
        specimen=test.specimen,
        source=test.source,
        gap=max(first_contact.gap, 0.0),
        loading_start=None if earlier_loading is None else float(time[motion.start]),
        plate=None
        if earlier_loading is None or earlier_loading.is_bonded
        else set_readonly(compression.copy())[span],
    )


def _set_broadband_noise(record: RampHold) -> RampHold:
    """Return the record with the noise outside the spectral lines that force and plate share.

    Such lines are motion and its response, not noise.
    """
    time, x, force = (
        channel[record.hold] for channel in (record.time, record.displacement, record.force)
    )
    least_displacement_noise = record.displacement_quantum / 12**0.5
    return replace(
        record,
        displacement_noise=min(
            record.displacement_noise, max(white_noise(time, x), least_displacement_noise)
        ),
        force_noise=min(record.force_noise, white_noise(time, force)),
    )


def _subtract_hum(record: RampHold) -> RampHold:
    """Return the record without the hum found in its hold, if it is evenly sampled."""
    hold_samples = record.hold
    time, force = record.time[hold_samples], record.force[hold_samples]
    if not is_evenly_sampled(time):
        return record
    lines, hum, plate_responds = hum_lines(
        record.time,
        remove_spikes(time, force),
        hold_samples,
        noise=record.force_noise,
        displacement=record.displacement[hold_samples],
    )
    if plate_responds:
        record = _set_broadband_noise(record)
    if not lines:
        return record
    force = set_readonly(record.force - hum)
    settled_samples = slice(
        hold_samples.start + (hold_samples.stop - hold_samples.start) // 10, hold_samples.stop
    )
    force_noise = scatter(record.time[settled_samples], force[settled_samples])
    return replace(record, force=force, force_noise=force_noise, hum=lines)


def _time_average(time: FloatArray, values: FloatArray) -> float:
    """Return the mean over time, by the trapezoidal rule."""
    intervals = np.diff(time)
    return float(intervals @ (values[1:] + values[:-1]) / (2 * intervals.sum()))


def _compute_force_rise(
    record: RampHold, baseline: Baseline, location: str, *, may_pull: bool = False
) -> float:
    """Return the peak of the force over its baseline, N, on one side of zero."""
    loaded_force = record.force[np.searchsorted(record.time, record.onset) :]
    base_force = 0.0 if baseline.long_enough else float(record.force[0])
    loaded_force = median_of_three(loaded_force) if len(loaded_force) > 50 else loaded_force
    peak, minimum = float(loaded_force.max()) - base_force, float(loaded_force.min()) - base_force
    if peak <= 8 * record.force_noise:
        raise DataError(
            f"{location}: the force does not rise while the plate presses (by "
            f"{format_quantity(peak, 'mN', '.3g')}, with a scatter of "
            f"{format_quantity(record.force_noise, 'mN', '.3g')}); check the force column, its "
            "unit and the sign"
        )
    if baseline.long_enough and not may_pull and minimum < -max(8 * record.force_noise, 0.1 * peak):
        raise DataError(
            f"{location}: the force has mixed signs: between onset and hold end it rises to "
            f"{peak:.4g} N above its baseline and falls to {-minimum:.4g} N below it; a pressed "
            "seal only pushes. Check the tare, the sign and the columns, or cut the file before it"
        )
    return peak


def _compute_preload(
    record: RampHold, baseline: Baseline, first_contact: Touch, force_rise: float
) -> float:
    """Return the force at the start, in contact, N; 0 behind an air gap."""
    if first_contact.gap > 0:
        return 0.0
    if baseline.long_enough:
        return baseline.level if abs(baseline.level) > checks.MAX_PRELOAD * force_rise else 0.0
    first_force = float(record.force[0])
    return first_force if abs(first_force) > max(5 * record.force_noise, 0.01 * force_rise) else 0.0


def _calibrate_record(
    test: RelaxationTest, calibration: MachineCalibration | None
) -> RelaxationTest:
    """Return a test corrected for the gain and delay that blank tests measured."""
    if calibration is None:
        return test
    displacement = np.interp(test.time - calibration.delay, test.time, test.displacement)
    return replace(test, displacement=displacement, force=test.force / calibration.gain, units="SI")


def _subtract_machine_deflection(record: RampHold, preload: float, machine: Machine) -> RampHold:
    """Return the record with the deflection C F of the machine subtracted."""
    calibration, settling = machine.calibration, 0.0
    if calibration is not None:
        # the error of the contact is an error of the depth
        gain_error = float(np.hypot(calibration.gain_error, record.contact_error / record.depth))
        machine = replace(machine, calibration=replace(calibration, gain_error=gain_error))
        settling = calibration.settling
    if not machine.compliance and not settling:
        return replace(record, preload=preload, machine=machine)
    # noise of the force is no deflection: as motion it would rule out fast arms
    force = record.force
    if record.force_noise > 0:
        force, _ = denoise_values(force, record.force_noise)
    is_compressed = record.displacement > 0
    compliance = machine.compliance or 0.0
    relative_time = np.maximum(record.time - record.ramp_end, 0.0) / record.ramp_time
    deflection = compliance * (force - preload) - settling * np.log1p(relative_time)
    deflection = np.where(is_compressed, deflection, 0.0)
    held_deflection = _time_average(record.time[record.hold], deflection[record.hold])
    if not held_deflection < record.depth:
        raise DataError(
            f"a machine compliance of {format_quantity(compliance, 'um/N')} means a deflection of "
            f"{format_quantity(held_deflection, 'mm')} under "
            f"the force of the hold, and the plate moved {format_quantity(record.depth, 'mm')}; "
            "check the unit of the compliance"
        )
    return replace(
        record,
        displacement=record.displacement - deflection,
        plate=None if record.plate is None else record.plate - deflection,
        depth=record.depth - held_deflection,
        preload=preload,
        machine=machine,
        machine_deflection=deflection,
    )


def _make_history_step(record: RampHold, history: EarlierLoadings, count: int) -> Step:
    surface_text = (
        "the seal is bonded, or the plate never left it, so its face moves with the plate"
        if record.plate is None
        else "without contact the seal recovers under no force, as a model of "
        f"{history.arms} arm{'s' * (history.arms != 1)}"
    )
    loadings = f"{count} earlier loading{'s' * (count != 1)}"
    message = f"{loadings} followed from the first sample on; {surface_text}"
    return Step("history", (("loadings", str(count)), ("misfit", f"{history.misfit:.4g}")), message)


def _make_machine_steps(machine: Machine) -> tuple[Step, ...]:
    """Return the step that states the values of the machine and their use."""
    effects = (
        ("sync_s", machine.sync, "clock error of {:.4g} s (one SD)"),
        ("drift_n_per_s", machine.drift, "load cell drift of {:.4g} N/s (one SD)"),
        ("compliance_m_per_n", machine.compliance or None,
         "machine compliance of {:.4g} m/N, subtracted with the denoised force"),
        ("creep_m", machine.creep, "crosshead creep of {:.4g} m in e-fold time (one SD)"),
        ("rest_s", machine.rest, "rest of the seal for {:.4g} s before its record"),
        ("force_filter_hz", machine.force_filter,
         "first-order low-pass of the force at {:.4g} Hz, also applied to the fitted motion"),
    )  # fmt: skip
    items = [(name, value, effect) for name, value, effect in effects if value is not None]
    if not items:
        return ()
    message = "; ".join(effect.format(value) for _, value, effect in items)
    if machine.calibration:
        message = f"{machine.calibration.source}: {message}"
    return (Step("machine", tuple((name, repr(value)) for name, value, _ in items), message),)


def _make_orientation_step(displacement: int, force: int) -> Step:
    words = {
        (1, 1): "displacement and force are positive in compression, as recorded",
        (-1, -1): "displacement and force are negative in compression; both signs are changed",
        (-1, 1): "displacement is negative in compression; its sign is changed",
        (1, -1): "force is negative in compression; its sign is changed",
    }
    parameters = (("displacement_sign", str(displacement)), ("force_sign", str(force)))
    return Step("orientation", parameters, words[displacement, force])


def _make_segments_step(motion: PlateMotion, record: RampHold) -> Step:
    message = (
        f"{motion.cycle.words()}; the {len(record.time)} samples from {record.time[0]:.6g} s to "
        f"{record.time[-1]:.6g} s are kept"
    )
    return Step(
        "segments", (("cycle", f"{motion.cycle_index + 1} of {len(motion.cycles)}"),), message
    )


def _make_contact_step(first_contact: Touch) -> Step:
    message = (
        f"an air gap of {format_quantity(first_contact.gap, 'mm')} is subtracted from the "
        "displacement"
        if first_contact.gap > 0
        else "contact where the motion begins"
    )
    return Step("contact", (("displacement_m", repr(first_contact.displacement)),), message)


def _make_ramp_step(record: RampHold, motion: PlateMotion) -> Step:
    message = (
        f"the ramp runs at {format_quantity(motion.straight_ramp.speed, 'mm/s')} from "
        f"{record.onset:.6g} s to {record.ramp_end:.6g} s ({record.ramp_time:.5g} s), the hold to "
        f"{record.hold_end:.6g} s ({record.hold_time:.5g} s), at "
        f"{format_quantity(record.depth, 'mm', '.5g')}"
    )
    parameters = (
        ("onset_s", repr(record.onset)),
        ("ramp_end_s", repr(record.ramp_end)),
        ("hold_end_s", repr(record.hold_end)),
        ("depth_m", repr(record.depth)),
    )
    return Step("ramp", parameters, message)
