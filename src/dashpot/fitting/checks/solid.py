"""Criteria on a fitted solid, independent of the kind of test."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Finding, Remedy, criterion
from dashpot.base.errors import Status
from dashpot.base.plain_text import sentence
from dashpot.base.units import format_quantity, get_display_unit
from dashpot.datamodel.bounds import MAX_LOSS_FACTOR_ERROR, BandError
from dashpot.numerics.inference.model_order import (
    MAX_SE_LN_TAU,
    MIN_K_OVER_SE,
    ArmShortage,
    OrderChoice,
)
from dashpot.solids.maxwell import GeneralizedMaxwell

MIN_TAU_RATIO = 1.5
# relative rounding error of a sum of stiffnesses
ROUNDING = 1e-12
# error of a loss factor above which it is undetermined
MAX_STATED_ERROR = 1.0
# so many independent samples beyond the parameters show the size of a noise to a third
MIN_DOF = 5.0
# kappa up to which residuals count as white
MAX_KAPPA = 10.0
# kappa above which residuals contain a part of the curve
MIN_CORRELATED_KAPPA = 20.0


@criterion(
    source="the gradient vanishes, or the optimum lies at a bound",
    grade="stop",
    fit_status=Status.NOT_CONVERGED,
)
def optimiser_converged(*, stationary: bool) -> Finding:
    """The optimiser converged to an optimum."""
    return Finding(
        "The optimiser ended at an optimum",
        failure="The optimiser reached its limit of iterations before the gradient vanished",
        remedy=Remedy("Use fewer arms, or more starting points.", "thorough"),
        always_fails=not stationary,
    )


@criterion(source="by definition")
def uncertainty_estimated(*, is_estimated: bool) -> Finding:
    """Intervals and checks were computed."""
    return Finding(
        "Intervals and checks were made",
        failure="This fit has neither intervals nor checks",
        remedy="Fit with intervals before use.",
        always_fails=not is_estimated,
    )


@criterion("ratio of neighbouring tau", ">=", MIN_TAU_RATIO)
def arms_distinct(model: GeneralizedMaxwell) -> Finding:
    """Neighbouring relaxation times differ enough to be two."""
    ratios = [
        slow_tau / fast_tau for fast_tau, slow_tau in zip(model.tau, model.tau[1:], strict=False)
    ]
    if not ratios:
        return Finding("There is at most one arm")
    j = int(np.argmin(ratios))
    return Finding(
        f"The closest relaxation times differ by a factor of {ratios[j]:.3g}",
        ratios[j],
        f"They are those of arms {j + 1} and {j + 2}. Below {MIN_TAU_RATIO} the data cannot "
        "separate two arms",
        Remedy(f"Use {format_arm_count(model.arms - 1)}.", "arms", f"{model.arms - 1}"),
    )


@criterion(
    "k / SE(k)",
    ">",
    MIN_K_OVER_SE,
    "3 SE, and SE(ln tau) < 0.5",
    other_grade="note where fewer arms are rejected",
    fit_status=Status.NOT_IDENTIFIED,
)
def arms_supported(
    model: GeneralizedMaxwell, error: FloatArray, *, unit: str = "N/m", arms_selected: bool = False
) -> Finding:
    """Every arm is significant.

    `error` as `Fit.estimate.parameters`: k_inf, k, ln tau; `arms_selected` if the rules chose their
    number, for then BIC rejects fewer.
    """
    n = model.arms
    group = list(zip(model.k, model.tau, error[1 : 1 + n], error[1 + n : 1 + 2 * n], strict=True))
    weak_arms = " and ".join(
        f"arm {j} (k = {format_amount(k, unit)}, tau = {tau:.3g} s)"
        for j, (k, tau, sk, st) in enumerate(group, start=1)
        if not (k > MIN_K_OVER_SE * sk and st < MAX_SE_LN_TAU)
    )
    value = float(min((k / sk for k, _, sk, _ in group if sk > 0), default=np.inf))
    error_text = (
        f"Its k is below {MIN_K_OVER_SE:.0f} standard errors, or its tau is uncertain by more "
        "than a factor of 1.6"
    )
    return Finding(
        "Every arm is above the noise",
        value if np.isfinite(value) else None,
        always_passes=n > 0 and not weak_arms,
        failure=f"{weak_arms} is hardly known, though the record rejects fewer arms. {error_text}"
        if arms_selected
        else f"{weak_arms} cannot be separated from noise. {error_text}",
        remedy="Hold longer, or reduce slow noise."
        if arms_selected
        else Remedy("Use fewer arms.", "arms", f"{max(n - 1, 0)}"),
        always_fails=bool(weak_arms),
        grade="note" if arms_selected else None,
    )


@criterion(
    "tau outside, s",
    "<=",
    source="the ends of the sampled times",
    grade="note",
    fit_status=Status.TAU_AT_BOUND,
)
def tau_inside_window(
    model: GeneralizedMaxwell,
    window: tuple[float, float],
    subject: str,
    *,
    end_names: tuple[str, str] = ("", ""),
    is_closed: bool = False,
    remedy: Remedy | str = Remedy("Use fewer arms, or measure over a wider range.", "arms"),  # noqa: B008
) -> Finding:
    """Every relaxation time lies in the range that the data cover.

    `window` is in s; `is_closed` it, an arm at an end of it is outside.
    """
    low, high = window
    holds = np.less if is_closed else np.less_equal
    outside_times = [tau for tau in model.tau if not (holds(low, tau) and holds(tau, high))]
    span = f"{low:.3g} s{end_names[0]} to {high:.3g} s{end_names[1]}"
    taus_text = ", ".join(f"{tau:.3g} s" for tau in outside_times)
    return Finding(
        f"Every relaxation time lies in what {subject} can show, {span}",
        min(outside_times, default=None),
        always_passes=bool(model.arms) and not outside_times,
        failure=f"A relaxation time, {taus_text}, lies outside what {subject} can show, {span}. "
        "Only the tail of this arm was measured, so its k and tau are extrapolated",
        remedy=remedy,
        limit=high,
        always_fails=bool(outside_times),
    )


@criterion(
    "samples that count as one",
    "<=",
    MIN_CORRELATED_KAPPA,
    "our choice: white residuals give 1",
    grade="note",
)
def residuals_white(kappa: float, rms: float, noise: float | None = None) -> Finding:
    """The residuals are noise, without a systematic curve.

    `rms` is that of weighted residuals, or in N beside a `noise`.
    """
    size_text = f"weighted residuals are {rms:.3g} rms"
    cause, advice = "The model misses part of the curve", "Look at the dense spectrum."
    if noise is not None:
        size_text = f"residuals are {format_quantity(rms, 'mN', '.3g')} rms"
        if rms > 1.3 * noise:
            advice = "Try another arm, or look at the residuals."
        else:
            cause, advice = "The record was filtered, or drifts", "Use the raw record."
    count = "each sample counts" if kappa < 1.005 else f"{kappa:.3g} samples count"
    return Finding(
        f"The {size_text}, and {count} as one independent sample",
        kappa,
        f"The intervals are wider for it. {cause}",
        advice,
    )


@criterion(
    "arms by BIC",
    "==",
    source="arms by significance, below the most that was tried",
    grade="note",
)
def order_agreed(choice: OrderChoice) -> Finding:
    """BIC and significance agree on the number of arms, below the largest that was tried."""
    chosen_text = format_arm_count(choice.arms)
    message = f"BIC and significance choose {chosen_text}"
    if not choice.has_agreement:
        message = (
            f"BIC supports {format_arm_count(choice.by_bic)}, the significance of k and tau "
            f"{format_arm_count(choice.by_significance)}; {chosen_text} taken"
        )
    if choice.in_noise_metric:
        message += ". The noise is as slow as the arms, so fits in its own metric were judged"
    if choice.is_largest_tried:
        message += ". That is the most that was tried"
    return Finding(
        message,
        float(choice.by_bic),
        remedy=Remedy(f"Ask for more than {choice.arms} arms.", "arms", f"{choice.arms + 1}"),
        limit=float(choice.by_significance),
        always_fails=choice.is_largest_tried,
    )


@criterion("arms that the data support", "<=", source="the requested number; BIC and significance")
def arms_enough(arm_shortage: ArmShortage | None, arms: int, *, unit: str) -> Finding:
    """The requested number of arms is enough: the data support no further one.

    `unit` is that of the residual.
    """
    if arm_shortage is None:
        return Finding("The data support no further arm", float(arms), limit=float(arms))
    arm_count, supported_count = arm_shortage.requested_arms, arm_shortage.supported_arms
    verb = "leaves" if arm_count == 1 else "leave"
    remainder, supported_text = (
        format_residual(rms, unit) for rms in (arm_shortage.rms, arm_shortage.supported_rms)
    )
    return Finding(
        f"{sentence(format_arm_count(arm_count))[:-1]} {verb} {remainder} rms, "
        f"{format_arm_count(supported_count)} leave{'s' * (supported_count < 2)} {supported_text}",
        float(supported_count),
        "What too few arms miss is in no interval",
        Remedy(f"Use {format_arm_count(supported_count)}.", "arms", f"{supported_count}"),
        limit=float(arm_count),
    )


@criterion(
    "independent samples beyond the parameters", ">=", MIN_DOF,
    "our choice; only if at least ten samples count as one",
)  # fmt: skip
def samples_independent(effective: float, parameters: int, kappa: float) -> Finding:
    """There are enough independent residuals to estimate the noise."""
    return Finding(
        f"The residuals have an effective sample size of {effective:.3g}, for {parameters} "
        "parameters",
        effective - parameters,
        "So few do not show how large the noise is",
        "Look at the residuals: use more arms, or reduce slow noise.",
        always_passes=kappa < MAX_KAPPA,
    )


def format_residual(rms: float, unit: str) -> str:
    """Return the residual of a fit as text."""
    if unit in {"N", "m"}:
        return format_quantity(rms, {"N": "mN", "m": "um"}[unit], ".3g")
    return f"{100 * rms:.3g} %" if unit == "1" else f"{rms:.3g} {unit}"


@criterion("upper end, Hz", ">", source="the lower end of the band", grade="stop")
def valid_band_exists(band: tuple[float, float]) -> Finding:
    """The test has a valid band."""
    low, high = band
    return Finding(
        f"The valid band of this test is {low:.2g} to {high:.2g} Hz; a prediction outside it is "
        "an extrapolation",
        high,
        failure="This test has no valid band. It halves the uncertainty of the loss stiffness at "
        "no frequency",
        remedy="Reduce the noise, press deeper, or hold longer.",
        limit=low,
    )


@criterion(
    "error of the loss factor", "<=", MAX_LOSS_FACTOR_ERROR, "our choice; 95 %, over all spectra"
)
def loss_factor_determined(band_error: BandError | None) -> Finding:
    """The loss factor is known in the valid band, for every spectrum that fits the data."""
    if band_error is None:
        return Finding("How well the loss factor is known was not computed")
    error = band_error.max_errors[1]
    size_text = f"±{100 * error:.2g} %" if error < MAX_STATED_ERROR else "a factor of two or worse"
    return Finding(
        f"In the valid band the loss factor is known to {size_text}",
        error,
        "Arms that the data cannot show, or lines that the model misses, leave it open",
        "Use the stiffness alone, measure with less noise, or add a hammer test.",
    )


def format_amount(value: float, unit: str) -> str:
    """Return a stiffness as people read it: N/mm of a part, MPa of a material."""
    return format_quantity(value, get_display_unit(unit), ".3g")


def format_arm_count(count: int) -> str:
    """Return a number of arms in words."""
    return "no arm" if count == 0 else f"{count} arm{'s' * (count > 1)}"
