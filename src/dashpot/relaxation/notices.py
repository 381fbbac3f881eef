"""What preparation notices, as named checks."""

from __future__ import annotations

import numpy as np

from dashpot._arrays import BoolArray, FloatArray, median
from dashpot.checks import Check
from dashpot.errors import DataError
from dashpot.relaxation.baseline import Baseline
from dashpot.relaxation.contact import Touch
from dashpot.relaxation.cycles import Cycle, listed
from dashpot.relaxation.records import RampHold
from dashpot.relaxation.scatter import median_of_three, quantum, spikes

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
