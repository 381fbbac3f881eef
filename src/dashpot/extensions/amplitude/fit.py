"""Fit of amplitude laws of stiffness and loss to an amplitude sweep."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dashpot.base.arrays import BoolArray, ComplexArray, FloatArray, median
from dashpot.base.checks import Check
from dashpot.base.errors import FitError
from dashpot.base.provenance import list_sources
from dashpot.base.reported_values import NORMAL
from dashpot.datamodel.checks import caution_checks
from dashpot.extensions.amplitude.amplitude_laws import (
    DEFAULT_EXPONENT,
    LAWS,
    FittedLaw,
    fit_sweep_law,
    join_complex_parts,
)
from dashpot.extensions.amplitude.checks import (
    FAR_ENOUGH,
    SIGNIFICANT_DEVIANCE,
    amplitude_dependence_detected,
    amplitudes_spread,
    law_residual_small,
    loss_residual_small,
    no_hidden_cubic_spring,
    softening_seen,
    spring_cubic,
    up_and_down_sweeps_agree,
)
from dashpot.extensions.amplitude.datamodel import AmplitudeFit, AmplitudeSweep
from dashpot.fitting.nuisance_priors import Prior, compute_delay_errors
from dashpot.preprocessing.checks import check_machine

_MIN_SAMPLES = 6
"""Smallest number of samples: two of the stiffness, three of the law, one spare."""
_MIN_OF_LEVEL = 2
"""Loops at one amplitude, which have no law."""
_WORDS = {
    "factor": "Kraus's law",
    "additive": "friction",
    "cubic": "a cubic spring",
    "factor+cubic": "Kraus's law and a cubic spring",
    "additive+cubic": "friction and a cubic spring",
}
_DISTINCT_BIC = 2.0
"""Difference of BIC below which two laws are not distinguished (Kass and Raftery 1995)."""
_ONE_AMPLITUDE = 1.05
"""Ratio of amplitudes at one frequency up to which the amplitude counts as constant."""
_OUTLIER_SD = 5.0
"""Robust SD by which a leading sample is an outlier of the instrument's lower range."""


def fit_amplitude(sweep: AmplitudeSweep, *, law: str = "auto") -> AmplitudeFit:
    r"""Fit how stiffness and loss move with amplitude: Kraus's law, a cubic spring, or both.

    Least squares on complex residuals over the size of the modulus; a linear complex level for each
    frequency, one share, half-way amplitude and exponent of Kraus's law with tied loss for all, and
    one :math:`\tfrac34 k_3 X^2`. A law is taken where it explains what is left without it by 2 ln L
    > 20, a spring beside Kraus's law where it makes the storage rise again: else it is but another
    way to soften. Kraus's law is a factor, or in parallel to the solid: BIC chooses where
    frequencies differ enough to distinguish them; at one frequency the two are the same curve, and
    the factor is taken for a modulus, the element beside the solid for a stiffness. Where the sweep
    ends below twice X_c the exponent is set to 0.5.

    Source: G. Kraus (1984); the tie of the loss is the rule of broad friction,
    :math:`K'' = -(2/\pi)\,dK'/d\ln X`.

    Parameters
    ----------
    sweep : AmplitudeSweep
    law : str
        ``"auto"`` or one of `LAWS`.

    Raises
    ------
    FitError
        If there are too few samples, or not two for each frequency.
    """
    has_several_amplitudes = _has_several_amplitudes(sweep)
    min_samples = _MIN_SAMPLES if has_several_amplitudes else _MIN_OF_LEVEL
    if len(sweep.amplitude) < min_samples:
        requirement = (
            "a law of amplitude needs"
            if has_several_amplitudes
            else "at one amplitude the fit needs"
        )
        raise FitError(f"loops or lines found: {len(sweep.amplitude)}; {requirement} {min_samples}")
    tones = len(np.unique(sweep.frequency))
    if 2 * tones > len(sweep.amplitude):
        raise FitError(
            f"{len(sweep.amplitude)} loops or lines at {tones} frequencies; expected two or more "
            "at each: the effects of frequency and of amplitude cannot be separated. Record three "
            "loops at each frequency, or a second amplitude. For a model over frequency alone, fit "
            "a table with the columns frequency, storage and loss"
        )
    return_difference = _compare_way_back(sweep)
    candidates = _sort_candidate_laws(sweep, law)
    is_stray = _find_strays(sweep, candidates[0].residuals) & has_several_amplitudes
    if is_stray.any() and np.count_nonzero(~is_stray) >= _MIN_SAMPLES:
        sweep = sweep.only(~is_stray)
        candidates = _sort_candidate_laws(sweep, law)
    constant_fit, best = fit_sweep_law(sweep, "none"), candidates[0]
    reach_ratio = float(sweep.amplitude.max()) / best.parameters.get("half_way", np.nan)
    if reach_ratio < FAR_ENOUGH:
        best = fit_sweep_law(sweep, best.law, DEFAULT_EXPONENT)
    gain, law_words = constant_fit.deviance - best.deviance, _WORDS.get(best.law, "")
    if gain <= SIGNIFICANT_DEVIANCE:  # nothing moves with amplitude
        best = constant_fit
    range_ = (float(sweep.amplitude.min()), float(sweep.amplitude.max()))
    residual_check = law_residual_small(best.residual)
    followed_well = bool(residual_check.passed)
    detection = amplitude_dependence_detected(
        gain, range_, sweep.amplitude_unit, law_words, is_explained=followed_well
    )
    checks: list[Check] = [
        *([detection] if has_several_amplitudes else []),
        amplitudes_spread(range_[1] / range_[0], sweep.amplitude_unit),
        residual_check,
        loss_residual_small(best.residual_loss),
        *check_machine(list_sources([sweep]), float(np.hypot(sweep.storage, sweep.loss).max())),
    ]
    if "lost" in best.parameters:
        checks.insert(2, softening_seen(reach_ratio))
    if return_difference is not None:
        checks.append(up_and_down_sweeps_agree(return_difference))
    cubic = 0.0
    if "k3" in best.parameters:
        checks.append(spring_cubic(best.quartic_gain))
    elif has_several_amplitudes:
        cubic = _estimate_hidden_cubic(sweep, best)
        top = sweep.amplitude == sweep.amplitude.max()
        storage = float(sweep.storage[top].min())
        checks.append(no_hidden_cubic_spring(0.75 * cubic * range_[1] ** 2 / max(storage, 1e-300)))
    linear_se, se = _compute_errors_with_delay(sweep, best)
    return AmplitudeFit(
        best.law,
        np.unique(sweep.frequency),
        best.linear,
        linear_se,
        best.parameters.get("lost", 0.0),
        best.parameters.get("half_way", np.nan),
        best.parameters.get("exponent", np.nan),
        tuple(se.items()),
        range_,
        best.residual,
        tuple((fitted.law, fitted.bic) for fitted in (constant_fit, *candidates)),
        int(np.count_nonzero(is_stray)),
        sweep.unit,
        sweep.amplitude_unit,
        (*checks, *caution_checks(list_sources([sweep]))),
        sweep.source,
        best.parameters.get("k3", 0.0),
        cubic,
        delay_sd=sweep.delay_sd,
    )


def _compute_errors_with_delay(
    sweep: AmplitudeSweep, best: FittedLaw
) -> tuple[ComplexArray, dict[str, float]]:
    r"""Standard errors of the levels and of the law's numbers with those by a delay of the force.

    Of a force that is late by :math:`\delta` every stiffness is turned by
    :math:`e^{-j\omega\delta}`, whatever the amplitude: no law parts that from loss.
    """
    fixed_exponent = DEFAULT_EXPONENT if best.se.get("exponent") == 0 else None

    def numbers(delay: float) -> FloatArray:
        K = sweep.value * np.exp(-2j * np.pi * sweep.frequency * delay)
        rotated_sweep = replace(sweep, storage=K.real, loss=K.imag, units="SI")
        fitted_law = fit_sweep_law(rotated_sweep, best.law, fixed_exponent)
        return np.array(
            [*fitted_law.linear.real, *fitted_law.linear.imag, *fitted_law.parameters.values()]
        )

    def levels(delay: float) -> FloatArray:
        L = best.linear * np.exp(-2j * np.pi * np.unique(sweep.frequency) * delay)
        return np.array([*L.real, *L.imag, *best.parameters.values()])

    if not sweep.delay_sd:
        return best.linear_se, best.se
    delay = Prior(0.0, sweep.delay_sd)
    # a law that stands beside the solid may take part of the turn, or leave it all to the solid
    by_delay = np.maximum(compute_delay_errors(numbers, delay), compute_delay_errors(levels, delay))
    storage, loss, law = np.split(by_delay, [len(best.linear), 2 * len(best.linear)])
    parts = np.append(best.linear_se.real, best.linear_se.imag)
    linear_se = join_complex_parts(np.hypot(parts, np.append(storage, loss)))
    error_pairs = zip(best.se.items(), law.tolist(), strict=True)
    return linear_se, {
        name: float(np.hypot(value, added_error)) for (name, value), added_error in error_pairs
    }


def _estimate_hidden_cubic(sweep: AmplitudeSweep, best: FittedLaw) -> float:
    """Return the 95 % limit of a cubic spring in parallel to a law without one."""
    law = "cubic" if best.law == "none" else f"{best.law}+cubic"
    fixed_exponent = best.parameters.get("exponent") if best.se.get("exponent") == 0 else None
    fitted_law = fit_sweep_law(sweep, law, fixed_exponent)
    return abs(fitted_law.parameters["k3"]) + NORMAL * fitted_law.se["k3"]


def _sort_candidate_laws(sweep: AmplitudeSweep, law: str) -> list[FittedLaw]:
    """The laws that may be, the best first; of two that BIC does not part the one at home here.

    One with a spring that is but another way to soften is not among them, whatever its BIC.
    """
    if law == "auto" and not _has_several_amplitudes(sweep):
        return [fit_sweep_law(sweep, "none")]
    default_kind = "factor" if sweep.unit == "Pa" else "additive"
    candidates = [fit_sweep_law(sweep, name) for name in LAWS if law in {"auto", name}]
    spring = next((fitted for fitted in candidates if fitted.law == "cubic"), None)

    def cost(fitted: FittedLaw) -> float:
        return fitted.deviance + SIGNIFICANT_DEVIANCE * fitted.terms

    def is_plausible(fitted: FittedLaw) -> bool:
        if fitted.terms < 2 or spring is None:
            return fitted.is_adequate
        # friction beside a spring shows in the loss, another kind of spring in the storage alone
        return (
            fitted.is_adequate
            and spring.loss_deviance - fitted.loss_deviance > SIGNIFICANT_DEVIANCE / 2
        )

    candidates = [fitted for fitted in candidates if is_plausible(fitted)] or candidates
    lowest_cost = min(map(cost, candidates))
    return sorted(
        candidates,
        key=lambda fitted: (
            cost(fitted) > lowest_cost + _DISTINCT_BIC,
            fitted.terms,
            default_kind not in fitted.law,
            cost(fitted),
        ),
    )


def _compare_way_back(sweep: AmplitudeSweep) -> float | None:
    """Return the change of the modulus on the way down; None if there is no such way."""
    values = []
    for tone in np.unique(sweep.frequency):
        rows = np.flatnonzero(sweep.frequency == tone)
        X, magnitude = np.log(sweep.amplitude[rows]), np.abs(sweep.value[rows])
        peak_index = int(np.argmax(X))
        rising_samples, falling_samples = slice(0, peak_index + 1), slice(peak_index + 1, None)
        if np.any(np.diff(X[rising_samples]) <= 0) or np.any(np.diff(X[peak_index:]) > 0):
            continue
        in_common_range = (X[falling_samples] >= X[0]) & (X[falling_samples] < X[peak_index])
        if peak_index >= 2 and np.count_nonzero(in_common_range) >= 3:
            size_on_way_up = np.interp(
                X[falling_samples][in_common_range], X[rising_samples], magnitude[rising_samples]
            )
            values.append(
                float(median(magnitude[falling_samples][in_common_range] / size_on_way_up)) - 1
            )
    return max(values, key=abs) if values else None


def _has_several_amplitudes(sweep: AmplitudeSweep) -> bool:
    """Return whether amplitudes differ at one frequency: else their effect is not seen."""
    tones = [sweep.amplitude[sweep.frequency == tone] for tone in np.unique(sweep.frequency)]
    return max(float(X.max() / X.min()) for X in tones) > _ONE_AMPLITUDE


def _find_strays(sweep: AmplitudeSweep, residual: ComplexArray) -> BoolArray:
    """The smallest amplitudes of a frequency whose residual exceeds the scatter of the others."""
    magnitude = np.abs(residual)
    limit = _OUTLIER_SD * 1.4826 * median(magnitude)
    is_stray = np.zeros(len(magnitude), dtype=bool)
    for tone in np.unique(sweep.frequency):
        rows = np.flatnonzero(sweep.frequency == tone)
        for i in rows[np.argsort(sweep.amplitude[rows])]:
            if magnitude[i] <= limit:
                break
            is_stray[i] = True
    return is_stray
