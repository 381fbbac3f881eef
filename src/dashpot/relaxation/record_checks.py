"""What a prepared record shows before any fit: its flaws as named checks, and their measures."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

from dashpot.checks import Check
from dashpot.relaxation.records import RampHold
from dashpot.relaxation.scatter import quantum, usual_scatter

MIN_QUANTA = 20.0
MIN_HOLD_OVER_RAMP = 10.0
MAX_CREEP = 0.01
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


def depth_doubt(test: RampHold) -> float:
    r"""Return the relative standard deviation of the depth that the encoder's step leaves.

    Depth is the difference of two readings, each uniform within one step q: :math:`q/\sqrt6`.
    """
    return encoder_step(test) / float(np.sqrt(6.0)) / test.depth


def encoder_step(test: RampHold) -> float:
    """Return the step of the displacement's readings, m; 0 if none shows.

    Noise beyond half a step dithers it away: readings then average to the truth.
    """
    step = test.displacement_quantum
    return 0.0 if test.displacement_noise > 0.5 * step else step


def hold_creep(test: RampHold) -> float:
    """Return the largest motion left in the hold, to its last tenth, as a part of the depth.

    Means over twelve stretches, each longer than the one before; the first fifth of a ramp time
    is left to the plate for settling.
    """
    x, t = test.displacement[test.hold], test.time[test.hold] - test.ramp_end
    edges = np.searchsorted(t, np.geomspace(0.2 * test.ramp_time, t[-1], 13))
    last = float(x[-max(1, len(x) // 10) :].mean())
    means = [x[a:b].mean() for a, b in pairwise(edges) if b > a]
    moved = [last - float(mean) for mean in means]
    return max(moved, key=abs, default=0.0) / test.depth


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
