"""Criteria on a hyperelastic law."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from dashpot.base.checks import Check, Finding, Remedy, criterion
from dashpot.base.provenance import list_sources
from dashpot.extensions.materials.hyperelastic.datamodel import ElasticCurve, HyperelasticFit, Span
from dashpot.extensions.materials.hyperelastic.law_least_squares import (
    HyperelasticOptimum,
    compute_best_signed_misfit,
    compute_best_stable_misfit,
)
from dashpot.extensions.materials.hyperelastic.strain_energy import (
    SHEARING,
    Hyperelastic,
    direction,
)
from dashpot.extensions.materials.options import Mode
from dashpot.numerics.inference.covariance_estimate import DerivedQuantity
from dashpot.preprocessing.checks import MACHINE_NAME

FOLLOWED = 0.05
ALIKE = 0.05
LARGEST_ERROR = 0.1
SCALED = 1.1
_MUCH_CLOSER = 0.25
"""Ratio of residuals below which the other material is suggested."""
SMALL_RESIDUAL = 0.005
"""Rms over the rms of the stress, below which a residual is no matter: a load cell's."""
_AS_GOOD = 10.0
"""Difference of BIC that refutes no law (R. E. Kass, A. E. Raftery, 1995)."""
_FACTORS = (0.03, 0.06, 0.12, 0.2)
"""Trial errors of the stress of one mode, as logarithms."""
_OF_NOTE = 0.03
_BOTH_STRAIN = 0.1
"""Logarithmic strain in tension and in compression from which one test is as good as two modes."""
_SHIFTS = (0.01, 0.02, 0.04, 0.08, 0.16)
"""Parts of the largest strain by which a zero is tried to be off."""


def run_checks(
    fit: HyperelasticFit,
    selected: HyperelasticOptimum,
    candidates: Sequence[HyperelasticOptimum],
    quantity: DerivedQuantity,
    times: float,
    *,
    use_range: Span | None,
) -> tuple[Check, ...]:
    """Return every check of a hyperelastic law."""
    shape_curves = [curve for curve in fit.curves if curve.mode != "volumetric"]
    worst_index = int(np.argmax(fit.residuals))
    foam = fit.law.kind == "hyperfoam"
    through = list(fit.curves) if foam else shape_curves
    flexible = compute_best_stable_misfit(through, fit.law.poisson)
    # of a foam that is known to be one its own ratio has been tried
    best_stable_misfit = math.inf if foam else compute_best_stable_misfit(shape_curves, 0.0)
    stretch_ranges = dict(fit.reach)
    min_drucker, location = least_drucker(fit.law, stretch_ranges)
    half_widths = times * quantity.standard_error[: len(fit.law.constants)]
    largest = max(abs(c) for c in fit.law.constants)
    widest_index = int(np.argmax(half_widths))
    loss_fractions = [curve.lost for curve in fit.curves if curve.lost is not None]
    softer = [curve.softer for curve in fit.curves if curve.softer is not None]
    return (
        law_residual_small(
            fit.residuals[worst_index],
            _get_curve_name(fit.curves[worst_index]),
            best_stable_misfit,
        ),
        no_better_law(selected.rms, flexible),
        compressible_law_no_better(
            None if foam else min(selected.rms, flexible), best_stable_misfit
        ),
        stable_in_use(min_drucker, location, fit.stable),
        modes_enough(
            len({curve.mode for curve in shape_curves}),
            has_two_modes=_has_both_directions(shape_curves),
            foam=foam,
        ),
        unmeasured_modes_determined(*_find_mode_error(fit, selected, candidates, quantity, times)),
        modes_in_scale(*_find_better_scale(through, fit.law.poisson, min(flexible, selected.rms))),
        use_range_measured(_compute_extrapolation_ratio(shape_curves, fit.law.poisson, use_range)),
        constants_determined(
            fit.law.constant_names[widest_index], float(half_widths[widest_index]) / largest
        ),
        rows_enough(len(selected.optimum.residual), len(selected.optimum.values)),
        files_agree(_compare_repeat_files(fit.curves)),
        loading_reversible(
            max(loss_fractions, default=None), is_removed=fit.relaxation is not None
        ),
        specimen_conditioned(max(softer, default=None, key=abs)),
        zero_stress_at_zero_strain(*_find_slack(through, fit.law.poisson, flexible)),
        labels_agree(*_find_other_label(through, fit.law.poisson, flexible)),
        measures_stated(_estimate_measure_error(fit.curves)),
        strain_measured_on_specimen(
            tuple({curve.mode: None for curve in shape_curves if _is_motion_of_machine(curve)})
        ),
        bulk_modulus_determined(is_known=fit.law.bulk_modulus is not None),
    )


def _get_curve_name(curve: ElasticCurve) -> str:
    return curve.mode if curve.source is None else f"{curve.mode} ({curve.source.file})"


def least_drucker(law: Hyperelastic, stretch_ranges: dict[Mode, Span]) -> tuple[float, str]:
    """Return the least eigenvalue over G of the law's tangent over stretches, and where it is."""
    pairs = []
    for mode, (low, high) in stretch_ranges.items():
        x = np.linspace(low, high, 200)
        value = law.drucker(mode, x)
        least_index = int(np.argmin(value))
        pairs.append((float(value[least_index]), f"{mode} stretch {x[least_index]:.3g}"))
    return min(pairs)


def _find_mode_error(
    fit: HyperelasticFit,
    selected: HyperelasticOptimum,
    candidates: Sequence[HyperelasticOptimum],
    quantity: DerivedQuantity,
    times: float,
) -> tuple[float | None, str, str]:
    """Return the largest error of the stress in an unmeasured mode, over the largest stress."""
    measured = {curve.mode for curve in fit.curves}
    score = dict(fit.orders)
    good_score = min(score.values()) + _AS_GOOD
    other_laws = [
        optimum
        for optimum in candidates
        if score[optimum.name] <= good_score and optimum.name != selected.name
    ]
    errors: list[tuple[float, str, str]] = []
    for mode, (low, high) in fit.reach:
        if mode in measured:
            continue
        x = np.linspace(low, high, 60)
        stress = selected.law.nominal(mode, x)
        size = float(np.abs(stress).max())
        for other in other_laws:
            ratio = float(np.abs(other.law.nominal(mode, x) - stress).max()) / size
            errors.append((ratio, mode, f"{other.name} follows the tests too and differs"))
        if not selected.law.exponents:
            J = selected.law.columns(mode, x)
            covariance = quantity.covariance[: J.shape[1], : J.shape[1]]
            half_width = times * np.sqrt(np.einsum("ij,jk,ik->i", J, covariance, J))
            errors.append((float(half_width.max()) / size, mode, "the law is uncertain"))
    return max(errors, default=(0.0 if measured >= set(SHEARING) else None, "", ""))


def _compute_extrapolation_ratio(
    curves: Sequence[ElasticCurve], poisson: float, use_range: Span | None
) -> float:
    """Return the ratio of the largest logarithmic strains of use and of the tests, by sign."""
    if use_range is None:
        return 1.0
    end_strains = np.concatenate([
        np.log(x) * direction(curve.mode, poisson)
        for curve in curves
        for x in (curve.stretch.min(), curve.stretch.max())
    ])  # fmt: skip
    parts = [
        sign * math.log(use) / value
        if (value := float((sign * end_strains).max())) > 0
        else math.inf
        for sign, use in zip((-1.0, 1.0), use_range, strict=True)
        if sign * (use - 1) > 0
    ]
    return max(parts, default=0.0)


def _compare_repeat_files(curves: Sequence[ElasticCurve]) -> float | None:
    """Return the largest mean difference of two files of one mode over their common range."""
    values = []
    for curve, other_curve in combinations(curves, 2):
        low = max(curve.stretch[0], other_curve.stretch[0])
        high = min(curve.stretch[-1], other_curve.stretch[-1])
        if curve.mode == other_curve.mode and high > low:
            x = np.linspace(low, high, 60)
            first, second = (
                np.interp(x, elastic_curve.stretch, elastic_curve.stress)
                for elastic_curve in (curve, other_curve)
            )
            values.append(float(np.abs(first - second).sum() / np.abs(first + second).sum() * 2))
    return max(values, default=None)


def _estimate_measure_error(curves: Sequence[ElasticCurve]) -> float:
    """Return the error of the stress if an unstated measure were the true stress."""
    open_ = [curve for curve in curves if not curve.stated and curve.mode != "volumetric"]
    return max((float(np.abs(curve.stretch - 1).max()) for curve in open_), default=0.0)


def _find_slack(curves: Sequence[ElasticCurve], poisson: float, best: float) -> tuple[float, str]:
    """Return the shift of a curve's zero that halves the residual of stable laws."""
    result = (best, 0.0, "")
    for i, elastic_curve in enumerate(curves):
        largest_strain = float(
            elastic_curve.stretch[np.argmax(np.abs(elastic_curve.stretch - 1))] - 1
        )
        for part in (*_SHIFTS, *(-shift for shift in _SHIFTS)):
            curve = replace(elastic_curve, stretch=elastic_curve.stretch - part * largest_strain)
            misfit = compute_best_stable_misfit([*curves[:i], curve, *curves[i + 1 :]], poisson)
            result = min(result, (misfit, part, _get_curve_name(elastic_curve)))
    misfit, part, name = result
    return (part, name) if misfit < 0.5 * best and best > SMALL_RESIDUAL else (0.0, "")


def _has_both_directions(curves: Sequence[ElasticCurve]) -> bool:
    """Return whether one file covers tension and compression."""
    return any(
        min(math.log(curve.stretch.max()), -math.log(curve.stretch.min())) >= _BOTH_STRAIN
        for curve in curves
        if curve.stretch.min() > 0
    )


def _find_better_scale(
    curves: Sequence[ElasticCurve], poisson: float, best: float
) -> tuple[float | None, float, str, bool]:
    """Return the reduction of the residual by scaling the stress of one mode, factor and mode.

    The last value says whether a law with a negative term is as close without a factor.
    """
    modes = dict.fromkeys(curve.mode for curve in curves if curve.mode != "volumetric")
    if len(modes) < 2:
        return None, 0.0, "", False
    result: tuple[float, float, str] = (best, 0.0, "")
    for mode in modes if best > SMALL_RESIDUAL else ():
        for size in (*_FACTORS, *(-factor for factor in _FACTORS)):
            scaled_curves = [
                replace(curve, stress=curve.stress * math.exp(size))
                if curve.mode == mode
                else curve
                for curve in curves
            ]
            result = min(result, (compute_best_stable_misfit(scaled_curves, poisson), size, mode))
    remainder, size, kind_index = result
    remainder = max(remainder, SMALL_RESIDUAL)
    is_signed_as_close = compute_best_signed_misfit(curves, poisson) <= SCALED * remainder
    return best / remainder, math.expm1(size), kind_index, is_signed_as_close


def _find_other_label(
    curves: Sequence[ElasticCurve], poisson: float, best: float
) -> tuple[float | None, str, float]:
    """Return the reduction of the residual by another label of one file, and the label."""
    if len({curve.mode for curve in curves}) < 2:
        return None, "", best
    result = (best, "")
    for i, elastic_curve in enumerate(curves):
        if elastic_curve.mode == "volumetric":
            continue
        alternatives: dict[str, ElasticCurve] = {
            "true stress where nominal stress was taken": replace(
                elastic_curve, stress=elastic_curve.stress / elastic_curve.stretch
            ),
            "nominal stress where true stress was taken": replace(
                elastic_curve, stress=elastic_curve.stress * elastic_curve.stretch
            ),
            **{
                mode: replace(elastic_curve, mode=mode)
                for mode in SHEARING
                if mode != elastic_curve.mode
            },
        }
        for message, alternative in alternatives.items():
            misfit = compute_best_stable_misfit(
                [*curves[:i], alternative, *curves[i + 1 :]], poisson
            )
            result = min(result, (misfit, f"{_get_curve_name(elastic_curve)} read as {message}"))
    return best / max(result[0], SMALL_RESIDUAL), result[1], best


@criterion(
    "residual / stress, rms",
    "<=",
    FOLLOWED,
    "our choice: scatter of specimens",
    other_grade="stop beyond 0.2",
)
def law_residual_small(residual: float, worst_curve: str, swelling: float = math.inf) -> Finding:
    """The law fits every curve.

    `swelling` is the residual of a foam law without lateral strain.
    """
    remedy = Remedy("Use a law of more constants, or name the test of each file.", "model")
    reason = ""
    if swelling <= min(FOLLOWED, _MUCH_CLOSER * residual):
        reason = f"A foam that does not swell sideways follows to {100 * swelling:.2g} %"
        remedy = Remedy(
            "Give the Poisson's ratio of the foam, 0 if it does not swell.", "poisson", "0"
        )
    return Finding(
        f"The hyperelastic law misses the stress by up to {100 * residual:.2g} %, in {worst_curve}",
        residual,
        reason,
        remedy,
        grade="stop" if residual > 0.2 else "limit",
    )


@criterion("residual / that of the closest stable law", "<=", 2.0, "our choice: twice as close")
def no_better_law(residual: float, flexible: float) -> Finding:
    """No other stable law fits the curves much better."""
    ratio = residual / max(flexible, SMALL_RESIDUAL)
    return Finding(
        f"The hyperelastic law misses the stress by {100 * residual:.2g} %, the most flexible "
        f"stable one by {100 * flexible:.2g} %",
        ratio,
        "A law of more constants fits the rest",
        Remedy("Use a law of more constants.", "model", "ogden"),
    )


@criterion("residual / that of a foam", "<=", 1.3, "our choice: rubber 1.0, foam 1.6 or more")
def compressible_law_no_better(residual: float | None, swelling: float) -> Finding:
    """A foam law without lateral strain fits the curves no better than the rubber law."""
    if residual is None:
        return Finding("The law is that of a foam, so it is not compared with one")
    return Finding(
        f"Rubber misses the stress by {100 * residual:.2g} %, a foam of Poisson's ratio 0 by "
        f"{100 * swelling:.2g} %",
        residual / max(swelling, SMALL_RESIDUAL),
        "A sponge is compressible, and the law is of incompressible rubber",
        Remedy("Give the ratio of a foam, 0 if it does not swell.", "poisson", "0"),
    )


@criterion("least eigenvalue of the tangent / G", ">", 0.0, "D. C. Drucker, 1959", grade="stop")
def stable_in_use(
    min_drucker: float,
    location: str,
    limits: Sequence[tuple[Mode, tuple[float | None, float | None]]],
) -> Finding:
    """The hyperelastic law is stable over the stretches of use in every mode (Drucker)."""
    limit_texts = [
        f"{mode} {'below' if low else 'above'} {limit:.4g}"
        for mode, stretch_limits in limits
        for low, limit in zip((True, False), stretch_limits, strict=True)
        if limit is not None
    ]
    text = (
        f"; it is not stable in {', '.join(limit_texts)}" if limit_texts else " and from 0.1 to 10"
    )
    return Finding(
        f"The hyperelastic law is stable over the stretches of use{text}",
        min_drucker,
        failure=f"The law is not stable in use, first at {location}{text if limit_texts else ''}",
        reason="A solver stops there, or gives a wrong result",
        remedy=Remedy("Use another law, such as one of power terms.", "model", "ogden"),
    )


@criterion("difference of Poisson's ratio", "|x| <=", 0.05, "our choice: error of a tape or camera")
def lateral_swelling_agrees(ratio: float, reported_poisson: float | None, *, foam: bool) -> Finding:
    """The lateral strain of the law agrees with the measured one."""
    if reported_poisson is None:
        return Finding("No strain sideways was measured, so Poisson's ratio is not held against it")
    return Finding(
        f"The strain sideways shows Poisson's ratio {reported_poisson:.2g}, and the law has "
        f"{ratio:.2g}",
        reported_poisson - ratio,
        "The lateral strain of the law differs from that of the specimen",
        Remedy(
            "Give the ratio that was measured.",
            "poisson",
            f"{min(max(reported_poisson, 0.0), 0.49):.2g}",
        )
        if foam
        else Remedy("Ask for the law of a foam.", "model", "hyperfoam"),
    )


@criterion("modes tested", ">=", 2.0, "simulation: one tension test is up to 18 % wrong elsewhere")
def modes_enough(modes: int, *, has_two_modes: bool, foam: bool) -> Finding:
    """At least two loading modes were tested; many laws fit one mode."""
    return Finding(
        f"{modes} modes were tested" if modes != 1 else "One mode was tested",
        float(modes),
        "Laws that fit it differ in the others by up to 18 %",
        Remedy("Test a second mode, or use the law in that mode alone.", "test"),
        # pressed one way is pulled both others; a foam's Poisson's ratio is given
        always_passes=has_two_modes or foam,
    )


@criterion(
    "residual / that with one mode scaled", "<=", SCALED,
    "simulation: faultless tests at most 1.02; 1.1 to 7 where a mode is 5 or 10 % off",
)  # fmt: skip
def modes_in_scale(
    ratio: float | None, scale_factor: float, mode: str, is_signed_as_close: bool = False
) -> Finding:
    """No scale factor on the stress of one mode improves the fit much."""
    if ratio is None:
        return Finding("One mode cannot show whether its stress is off by a factor")
    if not mode:
        return Finding("No factor on one mode brings the curves closer to a law", ratio)
    return Finding(
        f"The modes agree {ratio:.3g} times better if the stress in {mode} is "
        f"{100 * scale_factor:+.0f} %",
        ratio,
        "A law with a negative term, which is not fitted, is as close without it"
        if is_signed_as_close
        else "Softening of one specimen (Mullins), its area or a gain may cause this",
        "Check areas and load cells. If they are right, fit each mode alone."
        if is_signed_as_close
        else "Condition all specimens alike, and check areas and load cells.",
        always_passes=abs(scale_factor) < _OF_NOTE,
    )


@criterion("error of the stress / largest stress", "<=", LARGEST_ERROR, "our choice: a tenth")
def unmeasured_modes_determined(error: float | None, mode: str, reason: str) -> Finding:
    """The data determine the stress in the modes that were not measured."""
    if error is None:
        return Finding("No second law fits the tests, so the other modes are not compared")
    if not mode:
        return Finding("Every mode was measured", 0.0)
    return Finding(
        f"In {mode}, which was not measured, {reason} by {100 * error:.2g} % of the largest stress",
        error,
        "The tests do not determine the law there",
        "Measure that mode, or use the law in the measured modes only.",
    )


@criterion("largest strain of use / measured", "<=", 1.0, "beyond it nothing was measured")
def use_range_measured(ratio: float) -> Finding:
    """The stretches of use lie within the measured range."""
    message = "not measured at all" if math.isinf(ratio) else f"{ratio:.3g} times those measured"
    return Finding(
        f"The largest strains of use are {message}",
        ratio,
        "The law is extrapolated",
        Remedy("Test as far as the part goes, in tension and compression.", "stretches"),
    )


@criterion("half interval / largest constant", "<=", 0.25, "our choice: a quarter")
def constants_determined(name: str, part: float) -> Finding:
    """The data determine every constant of the law."""
    return Finding(
        f"The least certain constant, {name}, is known to {100 * part:.2g} % of the largest",
        part,
        "The tests do not separate the constants",
        Remedy("Add a mode, such as equibiaxial, or use a law of fewer constants.", "model"),
    )


@criterion("rows / constants", ">=", 4.0, "our choice: fewer rows fit any law")
def rows_enough(rows: int, constants: int) -> Finding:
    """There are enough rows for the number of constants."""
    return Finding(
        f"{rows} points determine {constants} constants; at least four points each are needed",
        rows / constants,
        "Such a law fits any points, wrong ones too",
        Remedy("Use more rows, or fewer constants.", "terms"),
    )


@criterion("mean difference of two files", "<=", ALIKE, "our choice: scatter of specimens")
def files_agree(difference: float | None) -> Finding:
    """Files of one loading mode show the same curve."""
    if difference is None:
        return Finding("No mode has two files over the same stretches")
    return Finding(
        f"Files of one mode differ by up to {100 * difference:.2g} %",
        difference,
        "They differ in rate, specimen or conditioning",
        Remedy("Give a relaxation test, if rates differ.", "relaxation"),
    )


@criterion("part of the energy", "<=", 0.1, "our choice: beyond it loading is not the elastic law")
def loading_reversible(loss_fraction: float | None, *, is_removed: bool) -> Finding:
    """Unloading returns most of the energy of loading."""
    if loss_fraction is None:
        return Finding("No unloading shows how much of the stress is elastic")
    reason = (
        "The relaxation test is of another material, or there is friction or softening"
        if is_removed
        else "The loading contains relaxation or softening"
    )
    advice = Remedy("Give a relaxation test, or test slowly.", "relaxation")
    return Finding(
        f"A cycle loses {100 * loss_fraction:.2g} % of its energy", loss_fraction, reason, advice
    )


@criterion("1 - last loading / first", "|x| <=", 0.05, "our choice; L. Mullins, 1948")
def specimen_conditioned(softening: float | None) -> Finding:
    """The material is conditioned: it no longer softens from loading to loading."""
    if softening is None:
        return Finding("One loading shows no softening (Mullins); it may have been the first")
    return Finding(
        f"The last loading is {100 * softening:.2g} % softer than the first",
        softening,
        "The material was not conditioned. The last loading is used; a new part is stiffer",
        Remedy(
            "Condition the specimen, or use the first loading of a new part.",
            "file-part",
            "cycle=1",
        ),
    )


@criterion("zero shift / largest strain", "|x| <=", 0.005, "a shift below it is not sought")
def zero_stress_at_zero_strain(part: float, name: str) -> Finding:
    """Stress and strain are zero together."""
    if not name:
        return Finding("No shift of the zero of strain brings the curves closer to a law", 0.0)
    return Finding(
        f"{name} follows a law if its zero moves by {100 * part:.2g} % of the largest strain",
        part,
        "Slack, a toe or a preload may cause this",
        "Set the zero where the stress begins.",
    )


@criterion("residual as read / as read otherwise", "<=", 3.0, "our choice: a third of the residual")
def labels_agree(ratio: float | None, message: str, as_read: float) -> Finding:
    """No other label of a file makes the modes agree much better."""
    if ratio is None:
        return Finding("One mode cannot show whether it, or its stress, is labelled right")
    return Finding(
        f"As labelled, a stable law misses the stress by {100 * as_read:.2g} %",
        ratio,
        f"With {message} it misses {100 * as_read / ratio:.2g} %",
        Remedy("Check the label.", "test"),
        always_passes=as_read <= 0.02,
    )


@criterion("part of the stress", "<=", 0.1, "our choice: a tenth")
def measures_stated(part: float) -> Finding:
    """Stress and strain were stated as nominal or true, or it makes little difference."""
    return Finding(
        "The files say whether stress and strain are nominal or true" if not part else
        f"Stress and strain are taken as nominal, which the files do not say. A true stress would "
        f"differ by {100 * part:.3g} %",
        part,
        "A law fits either",
        Remedy("Say which they are.", "stress-is", "nominal"),
    )  # fmt: skip


def _is_motion_of_machine(curve: ElasticCurve) -> bool:
    """Return whether the strain is named for crosshead, piston, grips or a displacement."""
    return any(
        column.startswith(("strain", "stretch"))
        and ("displacement" in column.casefold() or MACHINE_NAME.search(column))
        for source in list_sources([curve])
        for column in source.columns
    )


@criterion("modes by the machine", "<=", 0.0, "ISO 37: the length between marks, not the grips")
def strain_measured_on_specimen(modes: Sequence[Mode]) -> Finding:
    """The strain is that of the specimen between marks, not the motion of crosshead or grips."""
    return Finding(
        "No strain is named for the motion of crosshead or grips",
        float(len(modes)),
        f"The strain of the {' and '.join(modes)} test is named for the motion of the machine. "
        "Grips or plates, ends of the specimen and the machine deform as well: the stiffness is "
        "wrong",
        "Measure it between marks, with an extensometer or a camera.",
    )


@criterion(grade="note")
def bulk_modulus_determined(*, is_known: bool) -> Finding:
    """The bulk modulus is known."""
    return Finding(
        "The change of volume is known",
        failure="The volume was not tested, so a deck needs a bulk modulus that is stated, not "
        "measured",
        remedy=Remedy("Add a test of the volume.", "test", "volumetric"),
        always_fails=not is_known,
    )
