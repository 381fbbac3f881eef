"""Fit of a hyperelastic law to tests in one mode or several."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import FitError
from dashpot.base.reported_values import ReportedValue
from dashpot.datamodel.checks import caution_checks
from dashpot.extensions.materials.hyperelastic import checks
from dashpot.extensions.materials.hyperelastic.datamodel import (
    ElasticCurve,
    HyperelasticFit,
    Span,
    StressStrainTest,
)
from dashpot.extensions.materials.hyperelastic.law_choices import ElasticKind, ElasticKindOption
from dashpot.extensions.materials.hyperelastic.law_least_squares import (
    EXACT,
    HyperelasticOptimum,
    WeightedCurves,
    fit_invariant_law,
    fit_power_law,
    weight_curves,
)
from dashpot.extensions.materials.hyperelastic.preprocess import extract_elastic_curve
from dashpot.extensions.materials.hyperelastic.strain_energy import (
    POWERS,
    SHEARING,
    Hyperelastic,
    direction,
)
from dashpot.extensions.materials.options import Mode
from dashpot.numerics.inference.covariance_estimate import estimate, score
from dashpot.numerics.least_squares import solve_ordinary
from dashpot.solids.maxwell import GeneralizedMaxwell

MAX_TERMS = 3
FOAM_POISSON = 0.45
"""Poisson's ratio below which a strain sideways shows a foam: rubber has 0.499, and a tape errs."""
_TERM_GAIN = 0.95
"""Times the residual of one term fewer, at most, of a law that a further term is tried for."""


def fit_hyperelastic(
    tests: Sequence[StressStrainTest],
    *,
    law: ElasticKindOption = "auto",
    terms: int | Literal["auto"] = "auto",
    poisson: float | None = None,
    relaxation: GeneralizedMaxwell | None = None,
    cycle: int | None = None,
    stretches: Span | None = None,
    temperature: float | None = None,
) -> HyperelasticFit:
    """Fit a hyperelastic law to tests of one material.

    Parameters
    ----------
    tests : sequence of StressStrainTest
        At least one changes the shape. Modes weigh alike, however many rows or files each has.
    law : str
        ``"auto"`` takes the law of least BIC among those that are stable over the stretches of use:
        of rubber, or of foam where Poisson's ratio is given, or a strain sideways shows it.
    terms : int or "auto"
        Number of terms of ``"ogden"`` and ``"hyperfoam"``, 1 to 3; ``"auto"`` by BIC.
    poisson : float, optional
        Poisson's ratio of a foam; where it is not given, that of the strain sideways of one mode,
        or else sought by two.
    relaxation : GeneralizedMaxwell, optional
        Whose k_inf is 1; taken off every test.
    cycle : int, optional
        The loading to use, counted from 1; by default the last.
    stretches : (float, float), optional
        Least and largest principal stretch of use; by default those measured.
    temperature : float, optional
        Temperature of the tests, K.

    Raises
    ------
    FitError
        If no test changes the shape, or the options contradict each other.
    """
    curves = [extract_elastic_curve(test, relaxation=relaxation, cycle=cycle) for test in tests]
    measured_poisson, foam = _find_poisson(tests, law, poisson)
    is_compressible = measured_poisson is not None and measured_poisson < FOAM_POISSON
    if foam and is_compressible and poisson is None and len({curve.mode for curve in curves}) == 1:
        poisson = measured_poisson
    _refuse_choices(curves, law, terms, poisson, foam=foam)
    law_curves, volumetric = _split_volumetric_curves(curves, foam=foam)
    candidates = (
        _fit_foam_laws(law_curves, terms, poisson) if foam else _fit_rubber_laws(law_curves, terms)
    )
    candidates = list({optimum.name: optimum for optimum in candidates}.values())
    best = min(candidates, key=lambda optimum: optimum.rms)
    parts = [len(curve.stretch) for curve in law_curves]
    # all laws by the noise of the closest: what another leaves more is no noise
    noises = estimate(best.optimum, parts=parts, rounding=EXACT).noises
    effective = sum(noise.effective for noise in noises)
    min_cost = EXACT**2 * len(best.optimum.residual)
    scores = {
        optimum.name: score(optimum.optimum, effective, rounding_sse=min_cost)
        for optimum in candidates
    }
    stretch_ranges = get_stretch_range(curves, best.law.poisson, stretches)
    selected = _choose_law(candidates, scores, law, stretch_ranges)
    uncertainty = estimate(selected.optimum, parts=parts, rounding=EXACT)
    derived_quantity = uncertainty.derive_quantity(selected.numbers)
    half_widths = uncertainty.quantile() * derived_quantity.standard_error
    reported_values = _make_law_facts(selected, derived_quantity.values, half_widths)
    bulk = _find_bulk_modulus(volumetric)
    selected = selected._replace(
        law=_add_bulk_modulus(selected, None if bulk is None else bulk.value)
    )
    hyperelastic_fit = HyperelasticFit(
        selected.law,
        (*reported_values, bulk) if bulk else reported_values,
        tuple(scores.items()),
        tuple(curves),
        tuple(_compute_relative_residual(selected, curve) for curve in curves),
        tuple(stretch_ranges.items()),
        tuple(zip(SHEARING, map(selected.law.stable_range, SHEARING), strict=True)),
        relaxation,
        (),
        temperature,
    )
    all_checks = checks.run_checks(
        hyperelastic_fit,
        selected,
        candidates,
        derived_quantity,
        uncertainty.quantile(),
        use_range=stretches,
    )
    lateral_check = checks.lateral_swelling_agrees(
        selected.law.poisson, measured_poisson, foam=foam
    )
    all_checks = (*all_checks, lateral_check, *caution_checks(hyperelastic_fit.sources))
    return replace(hyperelastic_fit, checks=all_checks)


def _split_volumetric_curves(
    curves: Sequence[ElasticCurve], *, foam: bool
) -> tuple[list[ElasticCurve], list[ElasticCurve]]:
    """Return the curves of the law, and the volumetric one of the bulk modulus of rubber."""
    if foam:
        return list(curves), []
    return (
        [curve for curve in curves if curve.mode != "volumetric"],
        [curve for curve in curves if curve.mode == "volumetric"],
    )


def _fit_foam_laws(
    curves: Sequence[ElasticCurve], terms: int | Literal["auto"], poisson: float | None
) -> list[HyperelasticOptimum]:
    return _fit_power_laws(weight_curves(curves), "hyperfoam", terms, poisson)


def _fit_rubber_laws(
    curves: Sequence[ElasticCurve], terms: int | Literal["auto"]
) -> list[HyperelasticOptimum]:
    rows = weight_curves(curves)
    return [
        *(fit_invariant_law(rows, name) for name in POWERS),
        *_fit_power_laws(rows, "ogden", terms, 0.5),
    ]


def _fit_power_laws(
    rows: WeightedCurves, kind: ElasticKind, terms: int | Literal["auto"], poisson: float | None
) -> list[HyperelasticOptimum]:
    """Return the laws of a number of terms, or of increasing numbers while each pays."""
    if terms != "auto":
        return [fit_power_law(rows, terms, kind, poisson)]
    optima = [fit_power_law(rows, count, kind, poisson) for count in (1, 2)]
    while len(optima) < MAX_TERMS and optima[-1].rms < _TERM_GAIN * optima[-2].rms:
        optima.append(fit_power_law(rows, len(optima) + 1, kind, poisson))
    return optima


def _refuse_choices(
    curves: Sequence[ElasticCurve],
    law: ElasticKindOption,
    terms: int | Literal["auto"],
    poisson: float | None,
    *,
    foam: bool,
) -> None:
    modes = {curve.mode for curve in curves}
    if not modes - {"volumetric"}:
        raise FitError(
            "a volumetric test alone gives no law of shape; expected a uniaxial, equibiaxial or "
            "planar one beside it"
        )
    if terms != "auto" and not 1 <= terms <= MAX_TERMS:
        raise FitError(f"terms = {terms}; expected 1 to {MAX_TERMS}, or 'auto'")
    if poisson is not None and not foam:
        raise FitError(
            f"Poisson's ratio belongs to a foam, and {law} keeps its volume; leave it out, or ask "
            "for hyperfoam"
        )
    if poisson is not None and not 0 <= poisson < 0.5:
        raise FitError(f"Poisson's ratio = {poisson:g}; expected one from 0 to below 0.5 of a foam")
    if foam and poisson is None and len(modes) < 2:
        raise FitError(
            "one mode alone does not give the Poisson's ratio of a foam; give it (--poisson 0 of "
            "an open-cell foam under compression), or a second mode"
        )


def _choose_law(
    candidates: Sequence[HyperelasticOptimum],
    scores: dict[str, float],
    law: ElasticKindOption,
    stretch_ranges: dict[Mode, Span],
) -> HyperelasticOptimum:
    eligible_optima = [optimum for optimum in candidates if law in {"auto", optimum.law.kind}]
    if law == "auto":
        eligible_optima = [
            optimum
            for optimum in eligible_optima
            if checks.least_drucker(optimum.law, stretch_ranges)[0] > 0
        ] or eligible_optima
    return min(eligible_optima, key=lambda optimum: scores[optimum.name])


def _find_poisson(
    tests: Sequence[StressStrainTest], law: ElasticKindOption, poisson: float | None
) -> tuple[float | None, bool]:
    """Return Poisson's ratio by lateral strain, if measured, and whether a foam is fitted."""
    poisson_ratios = [test.poisson for test in tests if test.poisson is not None]
    ratio = sum(poisson_ratios) / len(poisson_ratios) if poisson_ratios else None
    is_compressible = ratio is not None and ratio < FOAM_POISSON
    return ratio, law == "hyperfoam" or (law == "auto" and (poisson is not None or is_compressible))


# -- Uncertainty ------------------------------------------------------------------------------


def _make_law_facts(
    optimum: HyperelasticOptimum, values: FloatArray, half_widths: FloatArray
) -> tuple[ReportedValue, ...]:
    """Return constants, exponents and the shear modulus with their intervals."""
    law = optimum.law
    names = [*law.constant_names, *(f"alpha{k}" for k in range(1, len(law.exponents) + 1))]
    names += ["poisson"] * (len(names) < len(values) - 1)
    units = ["Pa"] * len(law.constants) + ["1"] * (len(names) - len(law.constants)) + ["Pa"]
    return tuple(
        ReportedValue(name, value, value - half_width, value + half_width, unit)
        for name, value, half_width, unit in zip(
            [*names, "shear_modulus"], values.tolist(), half_widths.tolist(), units, strict=True
        )
    )


def _find_bulk_modulus(volumetric: Sequence[ElasticCurve]) -> ReportedValue | None:
    """Return the bulk modulus of a rubber."""
    if not volumetric:
        return None
    x = np.concatenate([curve.stretch - 1 for curve in volumetric])
    y = np.concatenate([curve.stress for curve in volumetric])
    best = solve_ordinary(y, x[:, None])
    uncertainty = estimate(best, parts=[len(curve.stretch) for curve in volumetric])
    bulk, half_width = (
        float(best.beta[0]),
        uncertainty.quantile() * float(uncertainty.standard_error[0]),
    )
    return ReportedValue("bulk_modulus", bulk, bulk - half_width, bulk + half_width, "Pa")


def _add_bulk_modulus(optimum: HyperelasticOptimum, bulk: float | None) -> Hyperelastic:
    if bulk is None:
        return optimum.law
    if not bulk > 0:
        raise FitError(
            f"the volumetric test has a bulk modulus of {bulk:.4g} Pa; expected one > 0: a "
            "pressure makes the volume smaller, so give volume ratios below 1 and the pressure"
        )
    return replace(optimum.law, bulk=bulk)


def _compute_relative_residual(optimum: HyperelasticOptimum, curve: ElasticCurve) -> float:
    """Return the rms residual of a curve over the rms of its stress."""
    residual = curve.stress - optimum.law.nominal(curve.mode, curve.stretch)
    return float(np.sqrt(np.mean(residual**2))) / curve.size


# -- Range of stretches in use ------------------------------------------------------------------


def get_stretch_range(
    curves: Sequence[ElasticCurve], poisson: float, stretches: Span | None
) -> dict[Mode, Span]:
    """Return the stretches of use in every mode that changes the shape.

    Where a mode was not measured, those of the same size (the root of the sum of squares of the
    three logarithmic strains), and of two modes no principal stretch beyond theirs.
    """
    spans: dict[Mode, Span] = {}
    for curve in curves:
        if curve.mode != "volumetric":
            low, high = spans.get(curve.mode, (1.0, 1.0))
            x = curve.stretch
            spans[curve.mode] = min(low, float(x.min())), max(high, float(x.max()))
    if stretches is not None:
        spans = {"uniaxial": (min(stretches[0], 1.0), max(stretches[1], 1.0))}
    return {
        mode: spans[mode] if mode in spans else _estimate_stretch_range(mode, spans, poisson)
        for mode in SHEARING
    }


def _estimate_stretch_range(mode: Mode, spans: dict[Mode, Span], poisson: float) -> Span:
    """Return stretches of an unmeasured mode of the size of the measured ones."""
    strain_direction = direction(mode, poisson)
    measured = [
        [math.log(span[end]) * direction(name, poisson) for name, span in spans.items()]
        for end in (0, 1)
    ]
    principal = np.concatenate([end for end_strains in measured for end in end_strains])
    values = []
    for sign, end_strains in zip((-1.0, 1.0), measured, strict=True):
        size = max(float(np.linalg.norm(end)) for end in end_strains) / float(
            np.linalg.norm(strain_direction)
        )
        if len(spans) > 1:
            limit = [
                (principal.max() if d * sign > 0 else -principal.min()) / abs(d)
                for d in strain_direction
                if d
            ]
            size = min(size, *limit)
        values.append(math.exp(sign * size))
    return values[0], values[1]
