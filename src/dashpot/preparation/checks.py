"""Each way in which a record can deceive, before any fit, as a criterion with a sentence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dashpot.base.arrays import FloatArray, kept, median, runs
from dashpot.base.checks import Check, Finding, criterion, worst
from dashpot.base.errors import DataError
from dashpot.base.numbers import rounded
from dashpot.base.status import Status
from dashpot.base.units import celsius, written
from dashpot.preparation.contact import MIN_BASELINE, Baseline, Touch
from dashpot.preparation.denoising import CORNERS, LOST, bends, but_corners, true_motion
from dashpot.preparation.noise import median_of_three, spikes, usual_scatter
from dashpot.preparation.segments import RampHoldCycle, listed
from dashpot.records.creep import LoadHold
from dashpot.records.relaxation import MAX_CREEP, RampHold, quantum
from dashpot.records.specimen import Specimen

LAW = "by law; a tenth for noise and drift"
MIN_QUANTA = 20.0
MAX_PRELOAD = 0.05
LATE_START = 0.2
# what a smaller one still relaxes is in the limits, and no law bends by so much of its depth
LARGE_PRELOAD = 0.1
MAX_OVERSHOOT = 0.05
MIN_HOLD_OVER_RAMP = 10.0
MIN_RAMP_SAMPLES = 10.0
FLAT_SAMPLES = 5.0
MAX_UNRESOLVED = 0.125
# of the travel, before the load: k_inf is then about half as wrong
MAX_STIR = 0.01
# of a held load; a controller that hunts by more moves the part with it
MAX_LOAD_CHANGE = 0.02
# K that a temperature may be misread by, and that a chamber may drift over a record
MAX_MISREAD, MAX_WARMED = 1.0, 1.0
# a loss, in noises, that the weights of the ramp's rows do not count
GROSSLY = 0.5
# bends of a motion that steps, at least
TO_AND_FRO = 8
# pauses on either side of one, to compare it with
BESIDE = 5


# -- what the file says of the temperature --------------------------------------------------------


@criterion("K apart", "|x| <=", MAX_MISREAD, "simulated pairs: an error of 1 K moves nothing else")
def temperature_as_stated(specimen: Specimen) -> Finding:
    """The temperature that was given is the one that the file itself says."""
    given, stated = specimen.temperature or 0.0, specimen.stated_temperature or 0.0
    return Finding(
        f"the file says {celsius(stated)}, and {celsius(given)} was given",
        given - stated,
        ": which is right? Shifts and predictions at a temperature rest on the one given "
        "(--temperature; leave it out to take that of the file)",
    )


@criterion("K over the record", "|x| <=", MAX_WARMED, "our choice: chambers hold 0.5 K")
def temperature_held(specimen: Specimen) -> Finding:
    """The recorded temperature stood still during the test."""
    warmed = specimen.warmed or 0.0
    return Finding(
        f"the recorded temperature rose by {warmed:.2g} K over the record",
        warmed,
        ": the seal was not at rest, and its stiffness and its clock changed with it; let it soak "
        "longer",
    )


def of_temperature(specimen: Specimen) -> list[Check]:
    """What the file says of the temperature, as far as it says anything."""
    answers = []
    if specimen.stated_temperature is not None:
        answers.append(temperature_as_stated(specimen))
    if specimen.warmed is not None:
        answers.append(temperature_held(specimen))
    return answers


# -- what preparation found -----------------------------------------------------------------------


@criterion(
    "samples", ">=", MIN_BASELINE, "our choice: the fewest that have a scatter", grade="note"
)
def baseline_recorded(before: Baseline) -> Finding:
    """There is a baseline before contact to take the tare from."""
    count = f"{before.samples} sample{'s' * (before.samples != 1)}"
    return Finding(
        f"{before.samples} samples ({before.duration:.3g} s) before contact give the tare to "
        f"{written(before.noise / max(before.samples, 1) ** 0.5, 'mN', '.2g')}",
        float(before.samples),
        instead=f"only {count} before contact, expected at least {MIN_BASELINE:.0f}: the zero of "
        "the force rests on the fit's offset alone; start the record a second before the ramp",
    )


@criterion("its error / depth", "<=", 0.01, "our choice: every stiffness shares it")
def contact_found(touch: Touch, depth: float, *, given: bool) -> Finding:
    """First contact is known well enough."""
    if given:
        return Finding(
            f"contact was given, {written(touch.gap, 'mm', '.3g')} after the start of the motion"
        )
    if touch.gap == 0:
        return Finding("the seal is in contact where the motion begins: no air gap shows")
    doubt = touch.standard_error / depth
    return Finding(
        f"the plate crosses an air gap of {written(touch.gap, 'mm', '.3g')} "
        f"(+- {written(touch.standard_error, 'mm', '.1g')}) before the force rises; the depth "
        "counts from there",
        doubt,
        f"; that leaves the depth uncertain by {100 * doubt:.2g} %, and every stiffness with "
        "it: start in light contact",
    )


@criterion(
    "preload / rise of the force",
    "<=",
    MAX_PRELOAD,
    grade="note",
    otherwise=f"limit beyond {LARGE_PRELOAD}; stop beyond {LATE_START} of a plate that moves already",
)
def preload_absent(carried: float, rise: float, *, moving: bool = False) -> Finding:
    """The load cell reads zero, near enough, before the ramp."""
    share = abs(carried) / rise
    says = "no preload shows before the ramp"
    if carried:
        says = (
            f"the load cell reads {carried:.3g} N as the ramp starts, "
            f"{rounded(100 * share, digits=2)} % of the rise"
        )
    late = moving and share > LATE_START
    return Finding(
        says,
        share,
        "; the plate moves already at the first sample: the record begins within its ramp, or the "
        "load cell was not tared: record from a second before the ramp"
        if late
        else "; if that is its offset, the tare removes it rightly; if the seal was already "
        "pressed, the stiffnesses are those about that preload, and what it still relaxes is "
        "taken for drift: tare in air, or start from rest",
        grade="stop" if late else "limit" if share > LARGE_PRELOAD else None,
    )


@criterion("its change in the hold / its rise in the ramp", "<=", 1.1, LAW, grade="stop")
def ramp_recorded(rise: float, change: float) -> Finding:
    """The record begins before its ramp: what the ramp raises is more than what relaxes."""
    return Finding(
        "the force that relaxes is raised by the ramp",
        abs(change) / max(abs(rise), 1e-300),
        instead=f"the force changes by {written(rise, 'mN', '.3g')} in what looks like the ramp "
        f"and by {written(change, 'mN', '.3g')} in the hold, and no solid relaxes more than it was "
        "loaded: the record begins after its ramp, or within it. The whole ramp and the force "
        "before it are needed: start recording a second before the ramp",
    )


def refuse_late_start(where: str, rise: float, change: float) -> None:
    """Raise DataError if the record begins after its ramp: nothing in a fit of it would be true."""
    answer = ramp_recorded(rise, change)
    if answer.failed:
        raise DataError(f"{where}: {answer.says}")


@criterion("loadings in the record", "<=", 1.0, "by definition; or `--cycle` chooses", grade="note")
def single_loading(index: int, cycles: tuple[RampHoldCycle, ...], *, asked: bool) -> Finding:
    """The record leaves no choice of loadings that the user has not made."""
    cycle = cycles[index]
    says = f"used: {cycle.words()}"
    if len(cycles) > 1:
        says = f"the record holds {listed(cycles)}; cycle {index + 1} is used"
        if not asked:
            says += ", which has the longest hold; another can be chosen (--cycle N)"
    if cycle.moves > 1:
        says += (
            f"; {cycle.moves} ramps belong to it: the fit of ramp and hold follows them all, the "
            "fit of the hold alone (eq. 5) does not apply"
        )
    return Finding(says, float(len(cycles)), excused=asked)


@criterion("overshoot / depth", "<=", MAX_OVERSHOOT, grade="note")
def overshoot_small(test: RampHold, *, moves: int) -> Finding:
    """The plate stops where it is held."""
    if moves > 1:
        return Finding("with several ramps an overshoot is not judged")
    highest = float(median_of_three(test.displacement).max()) - 3 * test.displacement_noise
    share = max(highest / test.depth - 1, 0.0)
    return Finding(
        f"the plate overshoots the held depth by {100 * share:.2g} %",
        share,
        "; the fit of ramp and hold follows it, that of the hold alone (eq. 5) does not, and a "
        "seal that has been pressed deeper answers more softly: slow the last part of the ramp",
    )


@criterion("longest pause / ramp", "<=", 0.2, "our choice; or 3 usual pauses")
def samples_unbroken(test: RampHold) -> Finding:
    """No samples are missing where the force changes fastest."""
    early = (test.time >= test.onset) & (test.time <= test.ramp_end + test.ramp_time)
    pauses = np.diff(test.time[early])
    worst = float(pauses.max(initial=0.0))
    share = worst / test.ramp_time
    return Finding(
        f"the longest pause between samples, from onset to a ramp after it, is {worst:.3g} s",
        share,
        f", {100 * share:.0f} % of the ramp: the motion in between is taken as straight; "
        "mend the missing rows, or sample faster",
        excused=worst <= 3 * (median(pauses) if pauses.size else 0.0),
    )


@criterion(
    "pause / time since onset",
    "<=",
    0.25,
    "our choice; or 3 times the pauses beside it, or 5 % of the rest",
    otherwise="stop if it is longer than all the rest",
)
def clock_steady(test: RampHold) -> Finding:
    """The clock runs on without a jump, from onset to the end of the hold."""
    used = test.time[int(np.searchsorted(test.time, test.onset)) : test.hold.stop]
    if len(used) <= BESIDE:
        return Finding("the record is too short to judge its clock")
    pauses, since = np.diff(used), np.maximum(used[:-1] - test.onset, test.ramp_time)
    worst = int(np.argmax(pauses / since))
    jump, rest = float(pauses[worst]), float(used[-1] - used[0] - pauses[worst])
    near = np.delete(pauses[max(worst - BESIDE, 0) : worst + BESIDE + 1], min(worst, BESIDE))
    return Finding(
        f"the longest pause for its place, {jump:.3g} s, comes {since[worst]:.3g} s after onset",
        float(jump / since[worst]),
        ". The clock jumped, or the record was interrupted: later times, and the slow arms, are "
        "not known. Cut the record there, or mend its clock",
        excused=jump <= 3 * float(near.max()) or jump <= 0.05 * rest,
        grade="stop" if jump > rest else None,
    )


@criterion("lone samples", "<=", 0.0, source="by definition")
def spikes_absent(test: RampHold) -> Finding:
    """No lone sample stands apart in either channel."""
    force = np.flatnonzero(spikes(test.time, test.force))
    plate = np.flatnonzero(spikes(test.time, test.displacement))
    count = len(force) + len(plate)
    if not count:
        return Finding("no lone sample stands apart from its neighbours", 0.0)
    first = test.time[min(np.concatenate((force, plate)))]
    return Finding(
        f"{len(force)} samples of the force and {len(plate)} of the displacement stand apart "
        f"from both neighbours, the first at t = {first:.6g} s; mend them in the file, or take a "
        "running median of three (dashpot fit --filter median:3)",
        float(count),
    )


@criterion(
    "force lost / noise",
    "<=",
    MAX_UNRESOLVED,
    "our choice: 1 noise SD over the samples of a step",
    grade="note",
    otherwise=f"limit where the motion steps, and beyond {GROSSLY}",
)
def motion_resolved(test: RampHold) -> Finding:
    r"""The samples follow the motion between them.

    Taken as straight, a motion is missed by :math:`h^2 \ddot x/8`, and the force by the largest
    secant stiffness of the ramp times that. A few sharp corners may lie between samples.
    """
    ramp = replace(test, hold_end=min(test.ramp_end + test.ramp_time, test.hold_end))
    x, left = true_motion(ramp)
    time, force = test.time[: len(x)], test.force[: len(x)]
    if len(x) < 4 * CORNERS:
        return Finding("the ramp has too few samples to tell how its motion bends between them")
    missed = bends(ramp, time, x, left)
    pressed = x > 0.2 * test.depth
    stiffness = float(((force[pressed] - test.preload) / x[pressed]).max(initial=0.0))
    worst = but_corners(np.abs(missed)) * stiffness
    value = worst / max(test.force_noise, 1e-3 * float(force.max()))
    needed = np.sqrt(value / MAX_UNRESOLVED) / median(np.diff(time))
    # a motor bends to and fro all along the ramp, a servo swings a few times
    seen = missed[np.abs(missed) * stiffness * value > LOST * worst]
    steps_on = value > LOST and np.count_nonzero(np.diff(np.sign(seen))) >= TO_AND_FRO
    return Finding(
        f"between two samples the motion bends by what would be {written(worst, 'mN', '.2g')}",
        value,
        f", {value:.2g} of the noise at each of many samples: it is finer than the sampling, and "
        f"fast arms follow what is missed; sample at {rounded(needed, digits=2)} Hz or faster",
        faulted=bool(steps_on),
        grade="limit" if steps_on or value > GROSSLY else None,
    )


@criterion("readings that moved in the later half", ">", 0.0, "by definition")
def motion_measured(test: RampHold) -> Finding:
    """The displacement of the hold is a reading that would show a creeping crosshead."""
    force, moved = test.force[test.hold], test.readings_moved
    part, middle = max(len(force) // 20, 1), len(force) // 2
    if moved:
        return Finding("the displacement of the hold is read, not commanded", float(moved))
    fall = float(force[middle : middle + part].mean() - force[-part:].mean())
    creep = 1e-3 * float(force[-part:].mean())
    share = f", {100 * creep / fall:.2g} % of its fall" if fall > creep else ""
    step = f", or hides less than a count of {written(test.encoder_step, 'um', '.3g')}"
    return Finding(
        "the displacement stands perfectly still in the hold: it is the commanded one"
        f"{step if test.encoder_step else ''}. A crosshead that crept on by 0.1 % of the depth, "
        f"unseen, would move the force by {written(creep, 'mN', '.2g')}{share} over the last half "
        "of the hold, and the slowest arm with it: a gauge at the seal would show it"
    )


@criterion(
    "sinking / depth", "<=", 0.03, "our choice; or the force falls a tenth as much", grade="stop"
)
def columns_plausible(test: RampHold) -> Finding:
    """It is the displacement that rests, and the force that decays."""
    x, f = test.displacement[test.hold], test.force[test.hold]
    tenth = max(len(x) // 10, 1)
    sank = float(x[:tenth].mean() - x[-tenth:].mean()) / test.depth
    eased = float(f[:tenth].mean() - f[-tenth:].mean()) / max(float(np.abs(f).max()), 1e-300)
    return Finding(
        "the displacement rests while the force decays",
        sank,
        instead=f"in the hold the displacement sinks by {100 * sank:.2g} % while the force rests: "
        "are force and displacement swapped? Name the columns (--force, --displacement)",
        excused=abs(eased) >= 0.1 * sank,
    )


@criterion("peak / full scale", ">=", 0.05, grade="note")
def range_used(peak: float, full_scale: float) -> Finding:
    """The test uses the range of the load cell."""
    share = peak / full_scale
    return Finding(
        f"the peak is {100 * share:.2g} % of the load cell's {full_scale:g} N",
        share,
        "; a smaller load cell would drift and scatter less",
    )


# -- what a prepared record shows -----------------------------------------------------------------


def of_records(tests: Sequence[RampHold], *, method: str) -> tuple[Check, ...]:
    """Return the checks that need no fit, each at its worst over `tests`."""
    still = [hold_is_still(test, method=method) for test in tests]
    before, after = zip(*map(_as_recorded, tests), strict=True)
    columns = (*zip(*before, strict=True), still, *zip(*after, strict=True))
    return tuple(map(worst, columns))


@kept
def _as_recorded(test: RampHold) -> tuple[tuple[Check, ...], tuple[Check, ...]]:
    """The checks of one record whatever is fitted, before and behind that of its hold."""
    before = force_not_clipped(test), force_resolved(test.reading), depth_resolved(test)
    after = hold_outlasts_ramp(test), ramp_sampled(test), force_relaxes(test), strain_small(test)
    return before, after


@criterion(
    "samples at the peak",
    "<",
    FLAT_SAMPLES,
    "our choice; or a rest or noise explains it",
    grade="stop",
)
def force_not_clipped(test: RampHold) -> Finding:
    """The peak is no ceiling at which the force stayed while the seal still moved."""
    top, count, first, last = _flat_top(test.reading)
    moved = float(np.ptp(test.displacement[first : last + 1]))
    long = last - first >= FLAT_SAMPLES - 1
    # of most records no more need be known
    step = quantum(test.reading) if long else 0.0
    # over so far the force climbs by three quanta even at half its mean rate
    climb = 6 * step * test.depth / max(float(np.ptp(test.force)), 1e-300)
    far = max(0.02 * test.depth, climb, 4 * test.displacement_noise)
    too_even = last - first >= 9 and 0 < step < 2 * test.force_noise
    return Finding(
        f"the force peaks at {top:.4g} N without a flat top",
        float(count),
        instead=f"{count} samples stand at exactly {top:.4g} N while the seal was still being "
        f"compressed by {100 * moved / test.depth:.0f} % of the depth: the force is clipped and "
        "every stiffness is too low; raise the range of the sensor or press less",
        excused=not (long and (moved > far or too_even)),
    )


@criterion("rise / step of the sensor", ">=", MIN_QUANTA, "our choice: a decay shows", grade="stop")
def force_resolved(force: FloatArray, rise: float | None = None) -> Finding:
    """The force is many times what the sensor can resolve."""
    step = quantum(force)
    if step == 0.0:
        return Finding("the force shows no quantisation")
    quanta = (float(np.ptp(force)) if rise is None else rise) / step
    return Finding(
        f"the peak force is {quanta:.0f} steps of the sensor's resolution, "
        f"{written(step, 'mN', '.3g')}",
        quanta,
        f"; fewer than {MIN_QUANTA:.0f} cannot show a decay: press deeper, take a longer "
        "piece, or use a smaller sensor",
    )


def refuse_unresolved(where: str, rise: float, force: FloatArray) -> None:
    """Raise DataError if the force, as recorded, rises by a few steps of the sensor only."""
    if force_resolved(force, rise).failed:
        step = quantum(force)
        raise DataError(
            f"{where}: the force rises by {written(rise, 'mN', '.3g')}, {rise / step:.0f} steps of "
            f"the sensor's {written(step, 'mN', '.3g')}: the signal is below resolution; expected "
            f"at least {MIN_QUANTA:.0f} steps: press deeper, take a longer piece, or use a smaller "
            "sensor"
        )


def refuse_saturated(where: str, test: RampHold) -> None:
    """Raise DataError if the force has a flat top: a fit through it is wrong everywhere."""
    if not force_not_clipped(test).failed:
        return
    plausible = columns_plausible(test)
    if plausible.failed:
        raise DataError(f"{where}: {plausible.says}")
    top, _, first, last = _flat_top(test.force)
    raise DataError(
        f"{where}: the force stands at exactly {top:.4g} N above the tare for {last - first + 1} "
        f"samples from t = {test.time[first]:.6g} s to {test.time[last]:.6g} s: the sensor or the "
        "converter is saturated, and a fit through the clipped part would be wrong; use a larger "
        "range, or press less deep"
    )


def _flat_top(force: FloatArray) -> tuple[float, int, int, int]:
    """Return the highest force, how often it is read, and its longest run: first and last."""
    top = float(force.max())
    at_top = force >= top - 1e-9 * abs(top)
    found = runs(at_top)
    first, last = found[np.argmax(found[:, 1] - found[:, 0])].tolist()
    return top, int(np.count_nonzero(at_top)), first, last


@criterion("its error / depth", "<=", 0.005, "our choice: half a per cent")
def depth_resolved(test: RampHold) -> Finding:
    """The depth is known well enough to divide a force by it."""
    doubt = test.depth_doubt
    return Finding(
        f"the encoder tells the depth of {written(test.depth, 'mm')} to {100 * doubt:.2g} % (one "
        "standard deviation); every stiffness shares this scale error and its standard error "
        "includes it",
        doubt,
        "; use a finer encoder or press deeper",
    )


@criterion(
    "motion in the hold / depth", "<=", MAX_CREEP, "our choice; the fit of ramp and hold follows it"
)
def hold_is_still(test: RampHold, *, method: str) -> Finding:
    """The plate stands still during the hold, or the fit follows it."""
    creep = test.hold_creep
    full = method == "full"
    says = f"the displacement changes by {100 * creep:.2g} % of the depth during the hold"
    if full and not abs(creep) <= MAX_CREEP:
        says += "; the fit uses the recorded motion, so the result holds (eq. 5 would not)"
    return Finding(
        says,
        abs(creep),
        f", more than the {100 * MAX_CREEP:.0f} % that eq. 5 can bear; fit ramp and hold together",
        excused=full,
    )


@criterion("hold / ramp", ">=", MIN_HOLD_OVER_RAMP, grade="note", otherwise="limit below 3.3")
def hold_outlasts_ramp(test: RampHold) -> Finding:
    """The hold is many times the ramp."""
    ratio = test.hold_time / test.ramp_time
    return Finding(
        f"the hold lasts {ratio:.3g} ramps",
        ratio,
        f"; below {MIN_HOLD_OVER_RAMP:.0f} much of the decay is hidden in the ramp: "
        "hold longer or ramp faster",
        # the recorded ramp is followed, so that hiding some of the decay costs precision alone
        grade="limit" if ratio < MIN_HOLD_OVER_RAMP / 3 else None,
    )


@criterion("samples in the ramp", ">=", MIN_RAMP_SAMPLES)
def ramp_sampled(test: RampHold) -> Finding:
    """There are samples enough in the ramp to see a fast arm."""
    inside = (test.time >= test.onset) & (test.time <= test.ramp_end)
    count = int(np.count_nonzero(inside))
    return Finding(
        f"{count} samples fall into the ramp of {test.ramp_time:.3g} s",
        float(count),
        f"; with fewer than {MIN_RAMP_SAMPLES:.0f} an arm as fast as the ramp cannot be told: "
        "sample faster",
    )


@criterion(
    "rise in the hold, N",
    "<=",
    source="7 SE of a tenth of it, or 0.5 % of the force",
    grade="stop",
    ends=Status.FORCE_RISES,
)
def force_relaxes(test: RampHold) -> Finding:
    """The force falls during the hold, as the force of every relaxing solid does."""
    rise, limit = force_rise(test)
    return Finding(
        "the force does not rise during the hold",
        rise,
        instead=f"the force rises by {written(rise, 'mN', '.3g')} during the hold, more than noise "
        f"explains ({written(limit, 'mN', '.3g')}): no relaxing solid does that; look for "
        "swelling, warming, a plate that creeps on, or a drifting sensor, and do not use these "
        "arms",
        limit=limit,
    )


@criterion("depth / height", "<=", 0.20, "our choice: beyond, secant is not tangent")
def strain_small(test: RampHold) -> Finding:
    """The compression is a small part of the height of the section."""
    height = test.specimen.height
    if height is None:
        return Finding("the height of the section is not given, so its strain is not judged")
    strain = test.depth / height
    return Finding(
        f"the section is compressed by {100 * strain:.0f} % of its height",
        strain,
        "; at such a depth k_inf is a secant stiffness, while vibration about it feels the "
        "tangent: test several depths and fit them together",
    )


def force_rise(test: RampHold) -> tuple[float, float]:
    """Return how far the force climbs from its lowest tenth to the last tenth of the hold, N.

    The second value is what noise, and a half per cent of the force, would explain. The part
    that a creeping plate explains by the secant stiffness is taken off first.
    """
    force, x = test.force[test.hold], test.displacement[test.hold]
    if len(force) < 20:
        return 0.0, np.inf
    secant = max(float(force[-len(force) // 10 :].mean()), 0.0) / test.depth
    tenths = [part.mean() for part in np.array_split(force - secant * (x - x.mean()), 10)]
    rise = float(tenths[-1] - min(tenths))
    noise = max(test.force_noise, usual_scatter(test.time, test.force))
    scatter = noise / np.sqrt(len(force) / 10)
    return rise, float(max(7.0 * scatter, 0.005 * np.abs(force).max()))


# -- a creep test ---------------------------------------------------------------------------------


@criterion("samples", ">=", MIN_BASELINE, "our choice: the fewest that have a scatter")
def load_begins_at_rest(test: LoadHold) -> Finding:
    """The record shows the part at rest before the load: the zero of the displacement."""
    before = int(np.searchsorted(test.time, test.onset))
    count = f"{before} sample{'s' * (before != 1)}"
    zero = f"{before} samples before the load give the zero of the displacement"
    third = before // 3
    # under a load that is on record the part may move
    unloaded = before and float(np.ptp(test.load[:before])) < MAX_PRELOAD * test.level
    if before >= MIN_BASELINE and unloaded:
        first, last = test.displacement[:third], test.displacement[before - third : before]
        travel = float(np.ptp(test.displacement))
        moved = abs(median(last) - median(first)) / travel
        chance = 4 * test.displacement_noise * np.sqrt(2 / third)
        return Finding(
            f"{zero}, and move by {100 * moved:.2g} % of the travel",
            float(before),
            ": the part still moves under an earlier load; let it rest, or record that load too",
            faulted=moved > max(MAX_STIR, chance / travel),
        )
    return Finding(
        zero,
        float(before),
        instead=f"only {count} before the load, expected at least {MIN_BASELINE:.0f}: the "
        "displacement's own zero is taken for that of the unloaded part, and what it gave at once "
        "rests on it; start the record a second before the load",
    )


@criterion("change in the hold / load", "<=", MAX_LOAD_CHANGE, grade="note")
def load_held(test: LoadHold) -> Finding:
    """The load stays what it is held at, or the fit follows it."""
    held = test.load[test.hold]
    settled = held[len(held) // 10 :]
    change = float(np.ptp(settled)) / test.level
    return Finding(
        f"the load changes by {100 * change:.2g} % while it is held",
        change,
        "; the fit uses the recorded force, so the result holds, but a curve of displacement over "
        "load would not",
    )
