"""Each way in which a fit can deceive, as a named check with a sentence."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check
from dashpot.engine.inference.order import Choice
from dashpot.records.relaxation import RampHold
from dashpot.solids.maxwell import GeneralizedMaxwell

MIN_HOLD_OVER_TAU = 3.0
MIN_TAU_RATIO = 1.5
MAX_KAPPA = 20.0
MIN_TAU_OVER_RAMP = 0.1
MAX_DRIFT_CORRELATION = 0.9
MAX_DRIFT_DOUBT = 0.1
MAX_WANDER = 4.0
MAX_METHOD_DIFFERENCE = 0.10


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


def arms_supported(
    model: GeneralizedMaxwell,
    se_k: FloatArray,
    se_ln_tau: FloatArray,
    *,
    needed: bool = False,
) -> Check:
    """Every arm stands out of the noise; `needed` if fewer arms were rejected all the same."""
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
    if weak and needed:
        says = (
            f"the record rejects fewer arms, yet hardly tells {' and '.join(weak)}: k is below 3 "
            "standard errors or tau is uncertain by more than a factor 1.6; "
            "hold longer, or quieten the slow noise"
        )
    elif weak:
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


def order_agreed(choice: Choice) -> Check:
    """The two rules for the number of arms agree, on less than the most that was tried."""
    passed = choice.agreed and not choice.capped
    chosen = _arms(choice.arms)
    if not choice.agreed:
        says = (
            f"BIC supports {_arms(choice.by_bic)}, the significance of k and tau supports "
            f"{_arms(choice.by_significance)}; {chosen} taken: look at the residuals of both"
        )
    else:
        says = f"both rules choose {chosen}"
    if choice.in_noise_metric:
        says += "; the noise is as slow as the arms, so fits in its own metric were judged"
    if choice.capped:
        says += f"; that is the most that was tried: raise max_arms above {choice.arms}"
    return Check("order_agreed", passed, says, float(choice.by_bic), float(choice.by_significance))


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


def wander(residual: FloatArray) -> float:
    """Return the mean power at 6 to 24 cycles per record over that at 60 to 240."""
    power = np.abs(np.fft.rfft(residual - residual.mean())) ** 2
    medium = float(power[60:241].mean())
    return float(power[6:25].mean()) / medium if medium > 0 else 1.0


def _arms(count: int) -> str:
    return "no arm" if count == 0 else f"{count} arm{'s' * (count > 1)}"
