"""Each way in which a relaxation fit can deceive, as a named check with a sentence."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

from dashpot._arrays import FloatArray
from dashpot.checks import Check
from dashpot.relaxation.records import RampHold
from dashpot.relaxation.scatter import quantum, usual_scatter
from dashpot.solids.maxwell import GeneralizedMaxwell

MIN_QUANTA = 20.0
MIN_HOLD_OVER_TAU = 3.0
MIN_HOLD_OVER_RAMP = 10.0
MAX_CREEP = 0.01
MIN_RAMP_SAMPLES = 10
MIN_TAU_RATIO = 1.5
MAX_KAPPA = 20.0
MIN_TAU_OVER_RAMP = 0.1
MAX_DRIFT_CORRELATION = 0.9
MAX_DRIFT_DOUBT = 0.1
MAX_WANDER = 4.0
MAX_METHOD_DIFFERENCE = 0.10
MAX_STRAIN = 0.20
MAX_DEPTH_DOUBT = 0.005


# -- what the records show ----------------------------------------------------------------------


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


# -- what the fit shows -------------------------------------------------------------------------


def hold_long_enough(model: GeneralizedMaxwell, tests: Sequence[RampHold]) -> Check:
    """The slowest arm had the time to relax."""
    hold = max(test.hold_time for test in tests)
    name = "hold_long_enough"
    if not model.arms:
        return Check(name, True, "a spring does not relax", None, MIN_HOLD_OVER_TAU)
    ratio = hold / model.tau[-1]
    passed = ratio >= MIN_HOLD_OVER_TAU
    says = f"the hold of {hold:.4g} s lasts {ratio:.2g} of the longest relaxation time"
    if not passed:
        says += (
            f", {model.tau[-1]:.3g} s; below {MIN_HOLD_OVER_TAU:.0f} k_inf rests on "
            f"extrapolation: hold for {MIN_HOLD_OVER_TAU * model.tau[-1]:.0f} s"
        )
    return Check(name, passed, says, ratio, MIN_HOLD_OVER_TAU)


def arms_distinct(model: GeneralizedMaxwell) -> Check:
    """Neighbouring relaxation times are far enough apart to be two."""
    ratios = [slow / fast for fast, slow in zip(model.tau, model.tau[1:], strict=False)]
    if not ratios:
        return Check("arms_distinct", True, "there is at most one arm", None, MIN_TAU_RATIO)
    j = int(np.argmin(ratios))
    passed = ratios[j] >= MIN_TAU_RATIO
    says = f"the closest relaxation times are a factor {ratios[j]:.3g} apart"
    if not passed:
        says += (
            f" (arms {j + 1} and {j + 2}); below {MIN_TAU_RATIO} the data cannot tell two arms "
            f"from one: fit {model.arms - 1} arm{'s' * (model.arms > 2)}"
        )
    return Check("arms_distinct", passed, says, ratios[j], MIN_TAU_RATIO)


def arms_supported(model: GeneralizedMaxwell, se_k: FloatArray, se_ln_tau: FloatArray) -> Check:
    """Every arm stands out of the noise."""
    name = "arms_supported"
    weak = [
        f"arm {j} (k = {1e-3 * k:.3g} N/mm, tau = {tau:.3g} s)"
        for j, (k, tau, sk, st) in enumerate(
            zip(model.k, model.tau, se_k, se_ln_tau, strict=True), start=1
        )
        if not (k > 3 * sk and st < 0.5)
    ]
    value = min(
        (k / sk if sk > 0 else np.inf for k, sk in zip(model.k, se_k, strict=True)), default=None
    )
    value = None if value is None or not np.isfinite(value) else float(value)
    if weak:
        says = (
            f"{' and '.join(weak)} cannot be told from noise: k is below 3 standard errors or "
            "tau is uncertain by more than a factor 1.6; fit fewer arms"
        )
    else:
        says = "every arm stands out of the noise"
    return Check(name, not weak, says, value, 3.0)


def tau_inside_window(model: GeneralizedMaxwell, tests: Sequence[RampHold]) -> Check:
    """Every relaxation time is one that the record could show: two samples to the hold."""
    shortest = min(2.0 * float(np.diff(test.time).min()) for test in tests)
    longest = max(test.hold_time for test in tests)
    outside = [tau for tau in model.tau if not shortest < tau < longest]
    window = f"{shortest:.3g} s (two samples) to {longest:.3g} s (the hold)"
    says = f"every relaxation time lies in what the record can show, {window}"
    if outside:
        listed = ", ".join(f"{tau:.3g} s" for tau in outside)
        says = (
            f"tau = {listed} lies outside what the record can show, {window}; do not use this "
            "arm: fit fewer arms, hold longer or sample faster"
        )
    return Check("tau_inside_window", not outside, says, min(outside, default=None), longest)


def k_inf_positive(model: GeneralizedMaxwell, se: float) -> Check:
    """There is an equilibrium stiffness left."""
    passed = model.k_inf > 3.0 * se
    says = f"k_inf = {1e-3 * model.k_inf:.4g} N/mm with a standard error of {1e-3 * se:.2g}"
    if not passed:
        says += (
            "; it is not told from zero: the hold ended before the force levelled off, or the "
            "seal flows; hold longer"
        )
    return Check("k_inf_positive", passed, says, model.k_inf, 3.0 * se)


def residuals_random(kappa: float, rms: float, noise: float) -> Check:
    """The residuals are noise: no curve is left in them."""
    passed = kappa <= MAX_KAPPA
    says = f"the residuals are {1e3 * rms:.3g} mN rms and {kappa:.3g} neighbours say the same"
    if not passed:
        cause = (
            "the model misses part of the curve (try another arm, or look at the residuals)"
            if rms > 1.3 * noise
            else "the record was filtered or drifts"
        )
        says += f": {cause}; intervals are widened for it"
    return Check("residuals_random", passed, says, kappa, MAX_KAPPA)


def step_bias(model: GeneralizedMaxwell, tests: Sequence[RampHold]) -> Check:
    """What a step would have made of this ramp: (tau/c)(1 - exp(-c/tau)) - 1, the worst arm."""
    if not model.arms:
        return Check("step_bias", True, "a spring does not feel the ramp", None, None)
    c = max(test.ramp_time for test in tests)
    bias = [tau / c * -np.expm1(-c / tau) - 1.0 for tau in model.tau]
    listed = ", ".join(f"k_{j} by {100 * b:.2g} %" for j, b in enumerate(bias, start=1))
    says = (
        f"the ramp of {c:.3g} s is accounted for; taking it as a step at its end would change "
        f"{listed}"
    )
    return Check("step_bias", True, says, float(min(bias)), None)


def fast_arm_visible(model: GeneralizedMaxwell, tests: Sequence[RampHold]) -> Check:
    """The fastest arm is slow enough to be seen after the ramp."""
    c = min(test.ramp_time for test in tests)
    if not model.arms:
        return Check("fast_arm_visible", True, "there is no arm", None, MIN_TAU_OVER_RAMP)
    ratio = model.tau[0] / c
    passed = ratio >= MIN_TAU_OVER_RAMP
    says = f"the fastest arm, tau = {model.tau[0]:.3g} s, is {ratio:.2g} of the shortest ramp"
    if not passed:
        says += (
            "; it has relaxed before the ramp ends, so only its b = k tau is seen, not its k: "
            "ramp faster, or identify it from vibration"
        )
    return Check("fast_arm_visible", passed, says, ratio, MIN_TAU_OVER_RAMP)


def drift_told_from_arm(
    model: GeneralizedMaxwell, correlation: float | None, se_ln_tau: float
) -> Check:
    """The slowest arm can be told from a drifting sensor."""
    name, limit = "drift_told_from_arm", MAX_DRIFT_DOUBT
    if not model.arms:
        return Check(name, True, "there is no slow arm to be taken for drift", None, limit)
    if correlation is None:
        says = (
            "no drift is fitted, so a drifting sensor would be taken for the slowest arm; "
            "method='full' fits it"
        )
        return Check(name, True, says, None, limit)
    passed = correlation < MAX_DRIFT_CORRELATION or se_ln_tau <= limit
    says = (
        f"the slowest tau and the drift of the sensor are correlated by {correlation:.2f}, and "
        f"with the drift unknown tau is known to {100 * se_ln_tau:.2g} %"
    )
    if not passed:
        says += (
            ": the record cannot tell the arm from drift; record a baseline before contact for "
            "as long as you can, and hold longer"
        )
    return Check(name, passed, says, se_ln_tau, limit)


def residuals_steady(residuals: Sequence[FloatArray]) -> Check:
    """The residuals do not wander slowly, as 1/f drift and a missed slow arm do."""
    name, limit = "residuals_steady", MAX_WANDER
    ratios = [wander(residual) for residual in residuals if len(residual) >= 800]
    if not ratios:
        return Check(name, True, "the record is too short to judge slow wandering", None, limit)
    ratio = max(ratios)
    passed = ratio <= limit
    says = f"slow and medium residuals differ by a factor {ratio:.2g} in power"
    if not passed:
        says += (
            ": the force wanders slowly (1/f drift, temperature, or a missed arm), and no fit "
            "can tell that from a slow arm; the intervals of k_inf and of the slowest arm are "
            "too narrow"
        )
    return Check(name, passed, says, ratio, limit)


def order_agreed(by_bic: int, by_significance: int, chosen: int) -> Check:
    """The two rules for the number of arms agree."""
    passed = by_bic == by_significance
    if passed:
        says = f"both rules choose {_arms(chosen)}"
    else:
        says = (
            f"BIC supports {_arms(by_bic)}, the significance of k and tau supports "
            f"{_arms(by_significance)}; {_arms(chosen)} taken: look at the residuals of both"
        )
    return Check("order_agreed", passed, says, float(by_bic), float(by_significance))


def hold_and_full_agree(
    full: GeneralizedMaxwell, hold: GeneralizedMaxwell | None, error: FloatArray
) -> Check:
    """The paper's eq. 5 on the hold says the same as the recorded motion.

    `error` holds the standard errors of the full fit: k_inf, every k, every ln tau. A
    difference within three of them is noise.
    """
    name, limit = "hold_and_full_agree", MAX_METHOD_DIFFERENCE
    if hold is None or hold.arms != full.arms:
        says = "eq. 5 on the hold supports another number of arms, so the two are not compared"
        if hold is None:
            says = "eq. 5 does not apply to this history, so the two methods are not compared"
        return Check(name, True, says, None, limit)
    ours = np.array((full.k_inf, *full.k, *full.tau))
    theirs = np.array((hold.k_inf, *hold.k, *hold.tau))
    labels = [f"{kind}_{j}" for kind in ("k", "tau") for j in range(1, full.arms + 1)]
    labels = ["k_inf", *labels]
    # an error of ln tau is relative as it stands
    relative = np.concatenate(
        (error[: 1 + full.arms] / np.maximum(ours[: 1 + full.arms], 1e-300), error[1 + full.arms :])
    )
    difference = theirs / np.maximum(ours, 1e-300) - 1.0
    beyond = np.abs(difference) > 3.0 * relative
    failed = beyond & (np.abs(difference) > limit)
    worst = int(np.argmax(np.where(failed, 1e9, 0.0) + np.abs(difference)))
    says = (
        f"eq. 5 on the hold alone changes {labels[worst]} by {100 * difference[worst]:+.2g} %, "
        f"{'more' if beyond[worst] else 'not more'} than noise explains"
    )
    if failed.any():
        says += (
            "; the ramp, drift or tare is not what eq. 5 assumes: compare both residuals, and "
            "trust the recorded motion"
        )
    return Check(name, not failed.any(), says, float(np.abs(difference[worst])), limit)


def frequencies_informed(band: tuple[float, float]) -> Check:
    """The test informs a band of frequencies at all."""
    low, high = band
    passed = high > low
    if passed:
        says = (
            f"this test informs {low:.2g} to {high:.2g} Hz; a prediction beyond is an extrapolation"
        )
    else:
        says = (
            "at no frequency does this test halve what was unknown of the loss stiffness: reduce "
            "the noise, press deeper or hold longer"
        )
    return Check("frequencies_informed", passed, says, high, low)


# -- measures -----------------------------------------------------------------------------------


def depth_doubt(test: RampHold) -> float:
    r"""Return the relative standard deviation of the depth that the encoder's step leaves.

    Depth is the difference of two readings, each uniform within one step q: :math:`q/\sqrt6`.
    """
    return encoder_step(test) / float(np.sqrt(6.0)) / test.depth


def encoder_step(test: RampHold) -> float:
    """Return the step of the displacement's readings, m; 0 if none shows.

    Noise beyond half a step dithers it away: readings then average to the truth.
    """
    step = quantum(test.displacement)
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


def wander(residual: FloatArray) -> float:
    """Return the mean power at 6 to 24 cycles per record over that at 60 to 240."""
    power = np.abs(np.fft.rfft(residual - residual.mean())) ** 2
    medium = float(power[60:241].mean())
    return float(power[6:25].mean()) / medium if medium > 0 else 1.0


def _worst(checks: Sequence[Check]) -> Check:
    """Return the first check that failed, with its test's number if there are several."""
    for number, check in enumerate(checks, start=1):
        if not check.passed:
            if len(checks) == 1:
                return check
            says = f"test {number} of {len(checks)}: {check.says}"
            return Check(check.name, False, says, check.value, check.limit)
    return checks[0]


def _arms(count: int) -> str:
    return "no arm" if count == 0 else f"{count} arm{'s' * (count > 1)}"
