"""Each way in which a record can deceive, before any fit, as a named check with a sentence."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray, median
from dashpot.base.checks import Check
from dashpot.base.errors import DataError
from dashpot.preparation.baseline import Baseline
from dashpot.preparation.contact import Touch
from dashpot.preparation.cycles import Cycle, listed
from dashpot.preparation.noise import median_of_three, spikes, usual_scatter
from dashpot.records.measures import MAX_CREEP, depth_doubt, hold_creep
from dashpot.records.relaxation import RampHold
from dashpot.records.resolution import quantum

MIN_QUANTA = 20.0
MIN_BASELINE = 5
MAX_CONTACT_DOUBT = 0.01
MAX_PRELOAD = 0.05
MAX_OVERSHOOT = 0.05
MAX_PAUSE = 0.2
MIN_RANGE = 0.05


def refuse_unresolved(where: str, rise: float, force: FloatArray) -> None:
    """Refuse a test whose force is a few steps of the sensor.

    Raises
    ------
    DataError
        If it rises by fewer than 20 quanta.
    """
    step = quantum(force)
    if step > 0 and rise < MIN_QUANTA * step:
        raise DataError(
            f"{where}: the force rises by {1e3 * rise:.3g} mN, {rise / step:.0f} steps of the "
            f"sensor's {1e3 * step:.3g} mN: the signal is below resolution; expected at least "
            f"{MIN_QUANTA:.0f} steps: press deeper, take a longer piece, or use a smaller sensor"
        )


def refuse_saturated(where: str, test: RampHold, rise: float) -> None:
    """Refuse a force with a flat top: a fit through it would be wrong everywhere.

    Raises
    ------
    DataError
        If the force stands still at its highest value while the plate still moves, or, in a
        noisy record, for longer than noise allows.
    """
    top = float(test.force.max())
    first, last = _longest(test.force >= top - 1e-9 * abs(top))
    count = last - first + 1
    if count < 5:
        return
    moved = float(np.ptp(test.displacement[first : last + 1]))
    step = quantum(test.force)
    # over so far the force climbs by three quanta even at half its mean rate
    far = max(0.02 * test.depth, 6 * step * test.depth / rise, 4 * test.displacement_noise)
    too_even = count >= 10 and 0 < step < 2 * test.force_noise
    if not (moved > far or too_even):
        return
    plausible = columns_plausible(test)
    if not plausible.passed:
        raise DataError(f"{where}: {plausible.says}")
    raise DataError(
        f"{where}: the force stands at exactly {top:.4g} N above the tare for {count} samples from "
        f"t = {test.time[first]:.6g} s to {test.time[last]:.6g} s: the sensor or the converter is "
        "saturated, and a fit through the clipped part would be wrong; use a larger range, or "
        "press less deep"
    )


def _longest(true: BoolArray) -> tuple[int, int]:
    """First and last sample of the longest run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], true.astype(int), [0]))))
    starts, stops = edges[::2], edges[1::2]
    i = int(np.argmax(stops - starts))
    return int(starts[i]), int(stops[i]) - 1


def baseline_recorded(before: Baseline) -> Check:
    """Whether there is a baseline before contact to take the tare from."""
    passed = before.samples >= MIN_BASELINE
    if passed:
        says = (
            f"{before.samples} samples ({before.duration:.3g} s) before contact give the tare to "
            f"{1e3 * before.noise / np.sqrt(before.samples):.2g} mN"
        )
    else:
        count = f"{before.samples} sample{'s' * (before.samples != 1)}"
        says = (
            f"only {count} before contact, expected at least {MIN_BASELINE}: the zero of the force "
            "rests on the fit's offset alone; start the record a second before the ramp"
        )
    return Check("baseline_recorded", passed, says, float(before.samples), float(MIN_BASELINE))


def contact_found(touch: Touch, depth: float, *, given: bool) -> Check:
    """Whether first contact is known well enough."""
    name, limit = "contact_found", MAX_CONTACT_DOUBT
    if given:
        says = f"contact was given, {1e3 * touch.gap:.3g} mm after the start of the motion"
        return Check(name, True, says, None, limit)
    if touch.gap == 0:
        says = "the seal is in contact where the motion begins: no air gap shows"
        return Check(name, True, says, None, limit)
    doubt = touch.standard_error / depth
    passed = doubt <= limit
    says = (
        f"the plate crosses an air gap of {1e3 * touch.gap:.3g} mm "
        f"(+- {1e3 * touch.standard_error:.1g} mm) before the force rises; the depth counts from "
        "there"
    )
    if not passed:
        says += (
            f"; that leaves the depth uncertain by {100 * doubt:.2g} %, and every stiffness with "
            "it: start in light contact, or give contact"
        )
    return Check(name, passed, says, doubt, limit)


def preload_absent(carried: float, rise: float) -> Check:
    """Whether the load cell reads zero, near enough, before the ramp."""
    share = abs(carried) / rise
    passed = share <= MAX_PRELOAD
    says = "no preload shows before the ramp"
    if carried:
        says = (
            f"the load cell reads {carried:.3g} N as the ramp starts, {100 * share:.2g} % of the "
            "rise"
        )
    if not passed:
        says += (
            "; if that is its offset, the tare removes it rightly; if the seal was already "
            "pressed, the stiffnesses are those about that preload, and what it still relaxes is "
            "taken for drift: tare in air, or start from rest"
        )
    return Check("preload_absent", passed, says, share, MAX_PRELOAD)


def single_loading(index: int, cycles: tuple[Cycle, ...], *, asked: bool) -> Check:
    """Whether the record leaves a choice of loadings that the user has not made."""
    cycle = cycles[index]
    passed = asked or len(cycles) == 1
    says = f"used: {cycle.words()}"
    if len(cycles) > 1:
        says = f"the record holds {listed(cycles)}; cycle {index + 1} is used"
        if not asked:
            says += ", which has the longest hold: choose with cycle=1, 2, ..."
    if cycle.moves > 1:
        says += (
            f"; {cycle.moves} ramps belong to it: method='full' follows them all, eq. 5 "
            "(method='hold') does not apply; give hold_end to keep the first alone"
        )
    return Check("single_loading", passed, says, float(len(cycles)), 1.0)


def overshoot_small(test: RampHold, *, moves: int) -> Check:
    """Whether the plate stops where it is held."""
    name, limit = "overshoot_small", MAX_OVERSHOOT
    if moves > 1:
        return Check(name, True, "with several ramps an overshoot is not judged", None, limit)
    highest = float(median_of_three(test.displacement).max()) - 3 * test.displacement_noise
    share = max(highest / test.depth - 1, 0.0)
    passed = share <= limit
    says = f"the plate overshoots the held depth by {100 * share:.2g} %"
    if not passed:
        says += (
            "; method='full' follows it, eq. 5 (method='hold') does not, and a seal that has been "
            "pressed deeper answers more softly: slow the last part of the ramp"
        )
    return Check(name, passed, says, share, limit)


def samples_unbroken(test: RampHold) -> Check:
    """Whether samples are missing where the force changes fastest."""
    early = (test.time >= test.onset) & (test.time <= test.ramp_end + test.ramp_time)
    pauses = np.diff(test.time[early])
    worst = float(pauses.max(initial=0.0))
    share = worst / test.ramp_time
    usual = median(pauses) if pauses.size else 0.0
    passed = share <= MAX_PAUSE or worst <= 3 * usual
    says = f"the longest pause between samples, from onset to a ramp after it, is {worst:.3g} s"
    if not passed:
        says += (
            f", {100 * share:.0f} % of the ramp: the motion in between is taken as straight; "
            "mend the missing rows, or sample faster"
        )
    return Check("samples_unbroken", passed, says, share, MAX_PAUSE)


def spikes_absent(test: RampHold) -> Check:
    """Whether lone samples stand apart in either channel."""
    force = np.flatnonzero(spikes(test.time, test.force))
    plate = np.flatnonzero(spikes(test.time, test.displacement))
    count = len(force) + len(plate)
    says = "no lone sample stands apart from its neighbours"
    if count:
        first = test.time[min(np.concatenate((force, plate)))]
        says = (
            f"{len(force)} samples of the force and {len(plate)} of the displacement stand apart "
            f"from both neighbours, the first at t = {first:.6g} s; mend them in the file, or use "
            "filter='median:3'"
        )
    return Check("spikes_absent", count == 0, says, float(count), 0.0)


def columns_plausible(test: RampHold) -> Check:
    """Whether it is the displacement that rests, and the force that decays."""
    x, f = test.displacement[test.hold], test.force[test.hold]
    tenth = max(len(x) // 10, 1)
    sank = float(x[:tenth].mean() - x[-tenth:].mean()) / test.depth
    eased = float(f[:tenth].mean() - f[-tenth:].mean()) / max(float(np.abs(f).max()), 1e-300)
    passed = not (sank > 0.03 and abs(eased) < 0.1 * sank)
    says = "the displacement rests while the force decays"
    if not passed:
        says = (
            f"in the hold the displacement sinks by {100 * sank:.2g} % while the force rests: are "
            "force and displacement swapped? Name the columns (--force, --displacement)"
        )
    return Check("columns_plausible", passed, says, sank, 0.03)


def range_used(peak: float, full_scale: float) -> Check:
    """Whether the test uses the range of the load cell."""
    share = peak / full_scale
    passed = share >= MIN_RANGE
    says = f"the peak is {100 * share:.2g} % of the load cell's {full_scale:g} N"
    if not passed:
        says += "; a smaller load cell would drift and scatter less"
    return Check("range_used", passed, says, share, MIN_RANGE)


MIN_HOLD_OVER_RAMP = 10.0


MIN_RAMP_SAMPLES = 10


MAX_STRAIN = 0.20


MAX_DEPTH_DOUBT = 0.005


def of_records(tests: Sequence[RampHold], *, method: str) -> tuple[Check, ...]:
    """Return the checks that need no fit, each at its worst over `tests`."""
    questions: tuple[Callable[[RampHold], Check], ...] = (
        force_not_clipped,
        force_resolved,
        depth_resolved,
        lambda test: hold_is_still(test, method=method),
        hold_outlasts_ramp,
        ramp_sampled,
        force_relaxes,
        strain_small,
    )
    return tuple(_worst([question(test) for test in tests]) for question in questions)


def force_not_clipped(test: RampHold) -> Check:
    """The peak is no ceiling at which the force stayed while the seal still moved."""
    top = test.force.max()
    at_top = np.flatnonzero(test.force >= top - 1e-9 * abs(top))
    moved = float(np.ptp(test.displacement[at_top[0] : at_top[-1] + 1])) / test.depth
    clipped = len(at_top) >= 5 and moved > 0.02
    if clipped:
        says = (
            f"{len(at_top)} samples stand at exactly {top:.4g} N while the seal was still being "
            f"compressed by {100 * moved:.0f} % of the depth: the force is clipped and every "
            "stiffness is too low; raise the range of the sensor or press less"
        )
    else:
        says = f"the force peaks at {top:.4g} N without a flat top"
    return Check("force_not_clipped", not clipped, says, float(len(at_top)), 5.0)


def force_resolved(test: RampHold) -> Check:
    """The force is many times what the sensor can resolve."""
    peak, step = float(np.ptp(test.force)), quantum(test.force)
    if step == 0.0:
        return Check("force_resolved", True, "the force shows no quantisation", None, MIN_QUANTA)
    quanta = peak / step
    passed = quanta >= MIN_QUANTA
    says = f"the peak force is {quanta:.0f} steps of the sensor's resolution, {1e3 * step:.3g} mN"
    if not passed:
        says += (
            f"; fewer than {MIN_QUANTA:.0f} cannot show a decay: press deeper, take a longer "
            "piece, or use a smaller sensor"
        )
    return Check("force_resolved", passed, says, quanta, MIN_QUANTA)


def depth_resolved(test: RampHold) -> Check:
    """The depth is known well enough to divide a force by it."""
    doubt = depth_doubt(test)
    passed = doubt <= MAX_DEPTH_DOUBT
    says = (
        f"the encoder tells the depth of {1e3 * test.depth:.4g} mm to {100 * doubt:.2g} % (one "
        "standard deviation); every stiffness shares this scale error and its standard error "
        "includes it"
    )
    if not passed:
        says += "; use a finer encoder or press deeper"
    return Check("depth_resolved", passed, says, doubt, MAX_DEPTH_DOUBT)


def hold_is_still(test: RampHold, *, method: str) -> Check:
    """The plate stands still during the hold."""
    creep = hold_creep(test)
    still = abs(creep) <= MAX_CREEP
    says = f"the displacement changes by {100 * creep:.2g} % of the depth during the hold"
    if not still and method == "full":
        says += "; the fit uses the recorded motion, so the result holds (eq. 5 would not)"
    elif not still:
        says += f", more than the {100 * MAX_CREEP:.0f} % that eq. 5 can bear; use method='full'"
    return Check("hold_is_still", still or method == "full", says, abs(creep), MAX_CREEP)


def hold_outlasts_ramp(test: RampHold) -> Check:
    """The hold is many times the ramp."""
    ratio = test.hold_time / test.ramp_time
    passed = ratio >= MIN_HOLD_OVER_RAMP
    says = f"the hold lasts {ratio:.3g} ramps"
    if not passed:
        says += (
            f"; below {MIN_HOLD_OVER_RAMP:.0f} the decay is mostly hidden in the ramp: "
            "hold longer or ramp faster"
        )
    return Check("hold_outlasts_ramp", passed, says, ratio, MIN_HOLD_OVER_RAMP)


def ramp_sampled(test: RampHold) -> Check:
    """There are samples enough in the ramp to see a fast arm."""
    inside = (test.time >= test.onset) & (test.time <= test.ramp_end)
    count = int(np.count_nonzero(inside))
    passed = count >= MIN_RAMP_SAMPLES
    says = f"{count} samples fall into the ramp of {test.ramp_time:.3g} s"
    if not passed:
        says += (
            f"; with fewer than {MIN_RAMP_SAMPLES} an arm as fast as the ramp cannot be told: "
            "sample faster"
        )
    return Check("ramp_sampled", passed, says, float(count), float(MIN_RAMP_SAMPLES))


def force_relaxes(test: RampHold) -> Check:
    """The force falls during the hold, as the force of every relaxing solid does."""
    rise, limit = force_rise(test)
    passed = rise <= limit
    if passed:
        says = "the force does not rise during the hold"
    else:
        says = (
            f"the force rises by {1e3 * rise:.3g} mN during the hold, more than noise explains "
            f"({1e3 * limit:.3g} mN): no relaxing solid does that; look for swelling, warming, a "
            "plate that creeps on, or a drifting sensor, and do not use these arms"
        )
    return Check("force_relaxes", passed, says, rise, limit)


def strain_small(test: RampHold) -> Check:
    """The compression is a small part of the height of the section."""
    height = test.specimen.height
    if height is None:
        says = "the height of the section is not given, so its strain is not judged"
        return Check("strain_small", True, says, None, MAX_STRAIN)
    strain = test.depth / height
    passed = strain <= MAX_STRAIN
    says = f"the section is compressed by {100 * strain:.0f} % of its height"
    if not passed:
        says += (
            "; at such a depth k_inf is a secant stiffness, while vibration about it feels the "
            "tangent: test several depths and fit them together"
        )
    return Check("strain_small", passed, says, strain, MAX_STRAIN)


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


def _worst(checks: Sequence[Check]) -> Check:
    """Return the first check that failed, with its test's number if there are several."""
    for number, check in enumerate(checks, start=1):
        if not check.passed:
            if len(checks) == 1:
                return check
            says = f"test {number} of {len(checks)}: {check.says}"
            return Check(check.name, False, says, check.value, check.limit)
    return checks[0]
