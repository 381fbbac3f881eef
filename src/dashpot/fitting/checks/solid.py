"""What a fitted solid must hold, whatever it was fitted to."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Finding, criterion
from dashpot.base.status import Status
from dashpot.base.units import read_in, written
from dashpot.engine.inference.order import MAX_SE_LN_TAU, MIN_K_OVER_SE, Choice
from dashpot.solids.maxwell import GeneralizedMaxwell

MIN_TAU_RATIO = 1.5
# what is left of zero in a sum of stiffnesses, relative to it
ROUNDING = 1e-12


@criterion(
    source="the gradient vanishes, or a bound holds the point",
    grade="stop",
    ends=Status.NOT_CONVERGED,
)
def optimum_found(*, stationary: bool) -> Finding:
    """The optimiser ended at an optimum."""
    return Finding(
        "the optimiser ended at an optimum",
        instead="the optimiser reached its limit of iterations before the gradient vanished: fit "
        "fewer arms, or ask for thorough starts",
        faulted=not stationary,
    )


@criterion(source="by definition")
def uncertainty_estimated(*, made: bool) -> Finding:
    """Intervals and checks were asked for."""
    return Finding(
        "intervals and checks were made",
        instead="this is a point estimate: neither intervals nor checks were made; fit with them "
        "before use (Python: intervals=True)",
        faulted=not made,
    )


@criterion("ratio of neighbouring tau", ">=", MIN_TAU_RATIO)
def arms_distinct(model: GeneralizedMaxwell) -> Finding:
    """Neighbouring relaxation times are far enough apart to be two."""
    ratios = [slow / fast for fast, slow in zip(model.tau, model.tau[1:], strict=False)]
    if not ratios:
        return Finding("there is at most one arm")
    j = int(np.argmin(ratios))
    return Finding(
        f"the closest relaxation times are a factor {ratios[j]:.3g} apart",
        ratios[j],
        f" (arms {j + 1} and {j + 2}); below {MIN_TAU_RATIO} the data cannot tell two arms "
        f"from one: fit {model.arms - 1} arm{'s' * (model.arms > 2)}",
    )


@criterion(
    "k / SE(k)",
    ">",
    MIN_K_OVER_SE,
    "3 SE; and SE(ln tau) < 0.5, a factor 1.6",
    otherwise="note where fewer arms are rejected",
    ends=Status.NOT_IDENTIFIED,
)
def arms_supported(
    model: GeneralizedMaxwell, error: FloatArray, *, unit: str = "N/m", needed: bool = False
) -> Finding:
    """Every arm stands out of the noise.

    `error` as `Fit.parameters`: k_inf, k, ln tau; `needed` if the rules chose their number, for
    then BIC rejects fewer.
    """
    n = model.arms
    each = list(zip(model.k, model.tau, error[1 : 1 + n], error[1 + n : 1 + 2 * n], strict=True))
    weak = " and ".join(
        f"arm {j} (k = {amount(k, unit)}, tau = {tau:.3g} s)"
        for j, (k, tau, sk, st) in enumerate(each, start=1)
        if not (k > MIN_K_OVER_SE * sk and st < MAX_SE_LN_TAU)
    )
    value = float(min((k / sk for k, _, sk, _ in each if sk > 0), default=np.inf))
    doubt = (
        f"k is below {MIN_K_OVER_SE:.0f} standard errors or tau is uncertain by more than a "
        "factor 1.6"
    )
    return Finding(
        "every arm stands out of the noise",
        value if np.isfinite(value) else None,
        excused=n > 0 and not weak,
        instead=f"the record rejects fewer arms, yet hardly tells {weak}: {doubt}; "
        "hold longer, or quieten the slow noise"
        if needed
        else f"{weak} cannot be told from noise: {doubt}; fit fewer arms",
        faulted=bool(weak),
        grade="note" if needed else None,
    )


@criterion(
    "tau outside, s",
    "<=",
    source="the ends of what was sampled",
    grade="note",
    ends=Status.TAU_AT_BOUND,
)
def tau_inside_window(
    model: GeneralizedMaxwell,
    window: tuple[float, float],
    of: str,
    *,
    ends: tuple[str, str] = ("", ""),
    within: bool = False,
    advice: str = ": only the tail of this arm was measured, so its k and tau are an "
    "extrapolation; fit fewer arms or measure wider",
) -> Finding:
    """Every relaxation time is one that the data could show.

    `window` is in s; `within` it, an arm at an end of it is outside.
    """
    low, high = window
    holds = np.less if within else np.less_equal
    outside = [tau for tau in model.tau if not (holds(low, tau) and holds(tau, high))]
    span = f"{low:.3g} s{ends[0]} to {high:.3g} s{ends[1]}"
    listed = ", ".join(f"{tau:.3g} s" for tau in outside)
    return Finding(
        f"every relaxation time lies in what {of} can show, {span}",
        min(outside, default=None),
        excused=bool(model.arms) and not outside,
        instead=f"tau = {listed} lies outside what {of} can show, {span}{advice}",
        limit=high,
        faulted=bool(outside),
    )


@criterion(
    "residuals that say the same", "<=", 20.0, "our choice: white residuals give 1", grade="note"
)
def residuals_random(kappa: float, rms: float, noise: float | None = None) -> Finding:
    """The residuals are noise: no curve is left in them.

    `rms` is that of weighted residuals, or in N beside a `noise`.
    """
    size = f"weighted residuals are {rms:.3g} rms"
    cause = "the model misses part of the curve (a broad spectrum has no few arms: see the dense "
    cause += "spectrum)"
    if noise is not None:
        size = f"residuals are {written(rms, 'mN', '.3g')} rms"
        cause = "the record was filtered or drifts"
        if rms > 1.3 * noise:
            cause = "the model misses part of the curve (try another arm, or look at the residuals)"
    return Finding(
        f"the {size} and {kappa:.3g} neighbours say the same",
        kappa,
        f": {cause}; intervals are widened for it",
    )


@criterion(
    "arms by BIC",
    "==",
    source="arms by significance, below the most that was tried",
    grade="note",
)
def order_agreed(choice: Choice) -> Finding:
    """The two rules for the number of arms agree, on less than the most that was tried."""
    chosen = arms_said(choice.arms)
    says = f"both rules choose {chosen}"
    if not choice.agreed:
        says = (
            f"BIC supports {arms_said(choice.by_bic)}, the significance of k and tau supports "
            f"{arms_said(choice.by_significance)}; {chosen} taken: look at the residuals of both"
        )
    if choice.in_noise_metric:
        says += "; the noise is as slow as the arms, so fits in its own metric were judged"
    if choice.capped:
        says += f"; that is the most that was tried: ask for more than {choice.arms}"
    return Finding(
        says,
        float(choice.by_bic),
        limit=float(choice.by_significance),
        faulted=choice.capped,
    )


@criterion("upper end, Hz", ">", source="the lower end of the band", grade="stop")
def frequencies_informed(band: tuple[float, float]) -> Finding:
    """The test informs a band of frequencies at all."""
    low, high = band
    return Finding(
        f"this test informs {low:.2g} to {high:.2g} Hz; a prediction beyond is an extrapolation",
        high,
        instead="at no frequency does this test halve what was unknown of the loss stiffness: "
        "reduce the noise, press deeper or hold longer",
        limit=low,
    )


def amount(value: float, unit: str) -> str:
    """Return a stiffness as people read it: N/mm of a part, MPa of a material."""
    return written(value, read_in(unit), ".3g")


def arms_said(count: int) -> str:
    """Return a number of arms in words."""
    return "no arm" if count == 0 else f"{count} arm{'s' * (count > 1)}"
