"""The hyperelastic law behind tests in one mode or several."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import FitError
from dashpot.base.student_t import t_quantile
from dashpot.fitting.hyperelastic import checks
from dashpot.fitting.hyperelastic.curves import elastic_curve
from dashpot.fitting.hyperelastic.solving import (
    EXACT,
    Solution,
    Weighed,
    invariant_law,
    power_law,
    weighed,
)
from dashpot.records.hyperelastic import ElasticCurve, HyperelasticFit, Span, StressStrainTest
from dashpot.records.indentation import Found
from dashpot.solids.hyperelastic import KINDS, POWERS, SHEARING, Hyperelastic, Kind, Mode, direction
from dashpot.solids.maxwell import GeneralizedMaxwell

LawName: TypeAlias = Literal["auto", "neo-hooke", "mooney-rivlin", "yeoh", "ogden", "hyperfoam"]
MOST_TERMS = 3
_WORTH = 0.95
"""Times the residual of one term fewer, at most, of a law that a further term is tried for."""
_CORRELATED = 0.95
"""Of neighbouring residuals, at most: a hundred points are then worth two and a half."""


class Evidence(NamedTuple):
    """What is known of a solution beside itself.

    Attributes
    ----------
    rows : float
        That are worth an independent one each.
    covariance : array, shape (p, p)
    times : float
        Standard errors in half an interval of 95 %.
    """

    rows: float
    covariance: FloatArray
    times: float


def fit_hyperelastic(
    tests: Sequence[StressStrainTest],
    *,
    law: LawName = "auto",
    terms: int | Literal["auto"] = "auto",
    poisson: float | None = None,
    memory: GeneralizedMaxwell | None = None,
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
        of rubber, or of foam where Poisson's ratio is given.
    terms : int or "auto"
        Of ``"ogden"`` and ``"hyperfoam"``, 1 to 3; ``"auto"`` by BIC.
    poisson : float, optional
        Of a foam; sought where it is not given and there are two modes.
    memory : GeneralizedMaxwell, optional
        Whose k_inf is 1; taken off every test.
    cycle : int, optional
        The loading to use, counted from 1; by default the last.
    stretches : (float, float), optional
        Least and largest principal stretch of use; by default those measured.
    temperature : float, optional
        Of the tests, K.

    Raises
    ------
    FitError
        If there is no test that changes the shape, or what was asked for does not fit together.
    """
    curves = [elastic_curve(one, memory=memory, cycle=cycle) for one in tests]
    foam = law == "hyperfoam" or (law == "auto" and poisson is not None)
    _refuse(curves, law, terms, poisson, foam=foam)
    fitted, volumetric = _parted(curves, foam=foam)
    tried = _of_foam(fitted, terms, poisson) if foam else _of_rubber(fitted, terms)
    tried = list({one.name: one for one in tried}.values())
    best = min(tried, key=lambda one: one.rms)
    worth = _worth(best, fitted)
    scores = {one.name: _bic(one, worth) for one in tried}
    reach = reach_of(curves, best.law.poisson, stretches)
    chosen = _chosen(tried, scores, law, reach)
    known = _evidence(chosen, worth)
    found, bulk = _found(chosen, known, volumetric)
    chosen = chosen._replace(law=_with_bulk(chosen, bulk))
    kept = HyperelasticFit(
        chosen.law,
        tuple(found),
        tuple(scores.items()),
        tuple(curves),
        tuple(_left(chosen, one) for one in curves),
        tuple(reach.items()),
        tuple(zip(SHEARING, map(chosen.law.stable_range, SHEARING), strict=True)),
        memory,
        (),
        temperature,
    )
    judged = checks.judge(kept, chosen, tried, known.covariance, known.times, asked=stretches)
    return replace(kept, checks=judged)


def _parted(
    curves: Sequence[ElasticCurve], *, foam: bool
) -> tuple[list[ElasticCurve], list[ElasticCurve]]:
    """What the law is fitted to, and what tells the bulk modulus of a rubber alone."""
    if foam:
        return list(curves), []
    return (
        [one for one in curves if one.mode != "volumetric"],
        [one for one in curves if one.mode == "volumetric"],
    )


def _of_foam(
    curves: Sequence[ElasticCurve], terms: int | Literal["auto"], poisson: float | None
) -> list[Solution]:
    return _power_laws(weighed(curves), "hyperfoam", terms, poisson)


def _of_rubber(curves: Sequence[ElasticCurve], terms: int | Literal["auto"]) -> list[Solution]:
    rows = weighed(curves)
    return [
        *(invariant_law(rows, one) for one in KINDS[:3]),
        *_power_laws(rows, "ogden", terms, 0.5),
    ]


def _power_laws(
    rows: Weighed, kind: Kind, terms: int | Literal["auto"], poisson: float | None
) -> list[Solution]:
    """The law of so many terms; or of one and two, and of more while each is worth it."""
    if terms != "auto":
        return [power_law(rows, terms, kind, poisson)]
    found = [power_law(rows, count, kind, poisson) for count in (1, 2)]
    while len(found) < MOST_TERMS and found[-1].rms < _WORTH * found[-2].rms:
        found.append(power_law(rows, len(found) + 1, kind, poisson))
    return found


def _refuse(
    curves: Sequence[ElasticCurve],
    law: LawName,
    terms: int | Literal["auto"],
    poisson: float | None,
    *,
    foam: bool,
) -> None:
    modes = {one.mode for one in curves}
    if not modes - {"volumetric"}:
        raise FitError(
            "a volumetric test alone tells no law of shape; expected a uniaxial, equibiaxial or "
            "planar one beside it"
        )
    if terms != "auto" and not 1 <= terms <= MOST_TERMS:
        raise FitError(f"terms = {terms}; expected 1 to {MOST_TERMS}, or 'auto'")
    if poisson is not None and not foam:
        raise FitError(
            f"Poisson's ratio belongs to a foam, and {law} keeps its volume; leave it out, or ask "
            "for hyperfoam"
        )
    if poisson is not None and not 0 <= poisson < 0.5:
        raise FitError(f"Poisson's ratio = {poisson:g}; expected one from 0 to below 0.5 of a foam")
    if foam and poisson is None and len(modes) < 2:
        raise FitError(
            "one mode alone does not tell the Poisson's ratio of a foam; give it (--poisson 0 of "
            "an open-cell foam under compression), or a second mode"
        )


def _chosen(
    tried: Sequence[Solution], scores: dict[str, float], law: LawName, reach: dict[Mode, Span]
) -> Solution:
    named = [one for one in tried if law in {"auto", one.law.kind}]
    if law == "auto":
        named = [one for one in named if checks.least_drucker(one.law, reach)[0] > 0] or named
    return min(named, key=lambda one: scores[one.name])


# -- how well it is known ---------------------------------------------------------------------


def _worth(best: Solution, curves: Sequence[ElasticCurve]) -> float:
    """How many independent rows the residuals of the closest law are worth."""
    ends = np.cumsum([len(one.stretch) for one in curves])[:-1]
    parts = np.split(best.residual, ends)
    near = sum(float(part[1:] @ part[:-1]) for part in parts)
    share: float = near / max(float(best.residual @ best.residual), 1e-300)
    rho = min(max(share, 0.0), _CORRELATED)
    return float(len(best.residual) * (1 - rho) / (1 + rho))


def _bic(one: Solution, worth: float) -> float:
    variance = max(one.rms, EXACT) ** 2
    constants: int = one.jacobian.shape[1]
    return worth * math.log(variance) + constants * math.log(max(worth, 2.0))


def _evidence(one: Solution, worth: float) -> Evidence:
    n, p = one.jacobian.shape
    size = np.linalg.norm(one.jacobian, axis=0)
    size[size == 0] = 1.0
    inverse = np.linalg.pinv(one.jacobian / size, rcond=1e-10)
    spread = float(one.residual @ one.residual) / max(n - p, 1) * n / max(worth, 1.0)
    dof = max(worth - p, 1.0)
    covariance = spread * (inverse @ inverse.T) / np.outer(size, size)
    return Evidence(worth, covariance, t_quantile(0.95, dof))


def _found(
    one: Solution, known: Evidence, volumetric: Sequence[ElasticCurve]
) -> tuple[list[Found], float | None]:
    """Constants and moduli with their intervals; and the bulk modulus of a rubber."""
    law, half = one.law, known.times * np.sqrt(np.diag(known.covariance))
    numbers = [*zip(law.constant_names, law.constants, strict=True)]
    units = ["Pa"] * len(numbers) + ["1"] * (len(half) - len(numbers))
    numbers += [(f"alpha{k}", a) for k, a in enumerate(law.exponents, start=1)]
    numbers += [("poisson", law.poisson)] * (len(half) > len(numbers))
    found = [
        Found(name, value, value - float(h), value + float(h), unit)
        for (name, value), h, unit in zip(numbers, half, units, strict=True)
    ]
    count = len(law.constants)
    gradient = np.zeros(len(half))
    if law.kind in POWERS:
        gradient[:count] = [2.0 if i + j == 1 else 0.0 for i, j in POWERS[law.kind]]
    else:
        gradient[:count] = 1.0
    G, wide = law.shear_modulus, known.times * math.sqrt(gradient @ known.covariance @ gradient)
    found.append(Found("shear_modulus", G, G - wide, G + wide, "Pa"))
    if not volumetric:
        return found, None
    x = np.concatenate([each.stretch - 1 for each in volumetric])
    y = np.concatenate([each.stress for each in volumetric])
    bulk = float(x @ y / (x @ x))
    error = float(np.sqrt(np.sum((y - bulk * x) ** 2) / max(len(x) - 1, 1) / (x @ x)))
    wide = t_quantile(0.95, max(len(x) - 1.0, 1.0)) * error
    return [*found, Found("bulk_modulus", bulk, bulk - wide, bulk + wide, "Pa")], bulk


def _with_bulk(one: Solution, bulk: float | None) -> Hyperelastic:
    if bulk is None:
        return one.law
    if not bulk > 0:
        raise FitError(
            f"the volumetric test has a bulk modulus of {bulk:.4g} Pa; expected one > 0: a "
            "pressure makes the volume smaller, so give volume ratios below 1 and the pressure"
        )
    return replace(one.law, bulk=bulk)


def _left(one: Solution, curve: ElasticCurve) -> float:
    """Rms of what the law leaves of a curve, over the rms of its stress."""
    left = curve.stress - one.law.nominal(curve.mode, curve.stretch)
    return float(np.sqrt(np.mean(left**2))) / curve.size


# -- stretches of use ---------------------------------------------------------------------------


def reach_of(
    curves: Sequence[ElasticCurve], poisson: float, stretches: Span | None
) -> dict[Mode, Span]:
    """Return the stretches of use in every mode that changes the shape.

    Where a mode was not measured, those of the same size (the root of the sum of squares of the
    three logarithmic strains), and of two modes no principal stretch beyond theirs.
    """
    spans: dict[Mode, Span] = {}
    for one in curves:
        if one.mode != "volumetric":
            low, high = spans.get(one.mode, (1.0, 1.0))
            x = one.stretch
            spans[one.mode] = min(low, float(x.min())), max(high, float(x.max()))
    if stretches is not None:
        spans = {"uniaxial": (min(stretches[0], 1.0), max(stretches[1], 1.0))}
    return {
        mode: spans[mode] if mode in spans else _as_large(mode, spans, poisson) for mode in SHEARING
    }


def _as_large(mode: Mode, spans: dict[Mode, Span], poisson: float) -> Span:
    """Stretches of a mode that was not measured, of the size of those that were."""
    along = direction(mode, poisson)
    measured = [
        [math.log(span[end]) * direction(one, poisson) for one, span in spans.items()]
        for end in (0, 1)
    ]
    principal = np.concatenate([each for ends in measured for each in ends])
    found = []
    for sign, ends in zip((-1.0, 1.0), measured, strict=True):
        size = max(float(np.linalg.norm(each)) for each in ends) / float(np.linalg.norm(along))
        if len(spans) > 1:
            limit = [
                (principal.max() if d * sign > 0 else -principal.min()) / abs(d) for d in along if d
            ]
            size = min(size, *limit)
        found.append(math.exp(sign * size))
    return found[0], found[1]
