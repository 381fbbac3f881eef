"""What a hyperelastic law can be trusted with, as criteria."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from dashpot.base.checks import Check, Finding, criterion
from dashpot.engine.inference.estimate import Derived
from dashpot.kinds.hyperelastic.record import ElasticCurve, HyperelasticFit, Span
from dashpot.kinds.hyperelastic.solving import HyperelasticOptimum, closest
from dashpot.solids.hyperelastic import SHEARING, Hyperelastic, Mode, direction

FOLLOWED = 0.05
ALIKE = 0.05
TOLD = 0.1
SMALL = 0.005
"""Rms over the rms of the stress, below which a residual is no matter: a load cell's."""
_AS_GOOD = 10.0
"""Of BIC: what is no farther is not refuted (R. E. Kass, A. E. Raftery, 1995)."""
_SHIFTS = (0.01, 0.02, 0.04, 0.08, 0.16)
"""Parts of the largest strain by which a zero is tried to be off."""


def judge(
    fit: HyperelasticFit,
    chosen: HyperelasticOptimum,
    tried: Sequence[HyperelasticOptimum],
    known: Derived,
    times: float,
    *,
    asked: Span | None,
) -> tuple[Check, ...]:
    """Every check of a law."""
    shaped = [one for one in fit.curves if one.mode != "volumetric"]
    worst = int(np.argmax(fit.residuals))
    foam = fit.law.kind == "hyperfoam"
    through = list(fit.curves) if foam else shaped
    flexible = closest(through, fit.law.poisson)
    reach = dict(fit.reach)
    least, where = least_drucker(fit.law, reach)
    half = times * known.standard_error[: len(fit.law.constants)]
    largest = max(abs(c) for c in fit.law.constants)
    wide = int(np.argmax(half))
    lost = [one.lost for one in fit.curves if one.lost is not None]
    softer = [one.softer for one in fit.curves if one.softer is not None]
    return (
        law_followed(fit.residuals[worst], _name(fit.curves[worst])),
        no_law_closer(chosen.rms, flexible),
        stable_in_use(least, where, fit.stable),
        modes_told(*_untold(fit, chosen, tried, known, times)),
        use_measured(_beyond(shaped, fit.law.poisson, asked)),
        constants_known(fit.law.constant_names[wide], float(half[wide]) / largest),
        rows_enough(len(chosen.optimum.residual), len(chosen.optimum.values)),
        files_agree(_apart(fit.curves)),
        loading_returned(max(lost, default=None), removed=fit.memory is not None),
        conditioned(max(softer, default=None, key=abs)),
        zero_known(*_slack(through, fit.law.poisson, flexible)),
        labels_agree(*_reading(through, fit.law.poisson, flexible)),
        measures_stated(_unstated(fit.curves)),
        volume_known(known=fit.law.bulk_modulus is not None),
    )


def _name(one: ElasticCurve) -> str:
    return one.mode if one.source is None else f"{one.mode} ({one.source.file})"


def least_drucker(law: Hyperelastic, reach: dict[Mode, Span]) -> tuple[float, str]:
    """Return the least eigenvalue over G of the law's tangent over stretches, and where it is."""
    found = []
    for mode, (low, high) in reach.items():
        x = np.linspace(low, high, 200)
        value = law.drucker(mode, x)
        at = int(np.argmin(value))
        found.append((float(value[at]), f"{mode} stretch {x[at]:.3g}"))
    return min(found)


def _untold(
    fit: HyperelasticFit,
    chosen: HyperelasticOptimum,
    tried: Sequence[HyperelasticOptimum],
    known: Derived,
    times: float,
) -> tuple[float | None, str, str]:
    """The largest doubt of the stress in a mode that was not measured, over the largest there."""
    measured = {one.mode for one in fit.curves}
    score = dict(fit.orders)
    close = min(score.values()) + _AS_GOOD
    others = [one for one in tried if score[one.name] <= close and one.name != chosen.name]
    doubts: list[tuple[float, str, str]] = []
    for mode, (low, high) in fit.reach:
        if mode in measured:
            continue
        x = np.linspace(low, high, 60)
        stress = chosen.law.nominal(mode, x)
        size = float(np.abs(stress).max())
        for one in others:
            apart = float(np.abs(one.law.nominal(mode, x) - stress).max()) / size
            doubts.append((apart, mode, f"{one.name} follows the tests as well and differs"))
        if not chosen.law.exponents:
            J = chosen.law.columns(mode, x)
            own = known.covariance[: J.shape[1], : J.shape[1]]
            wide = times * np.sqrt(np.einsum("ij,jk,ik->i", J, own, J))
            doubts.append((float(wide.max()) / size, mode, "its interval is"))
    return max(doubts, default=(0.0 if measured >= set(SHEARING) else None, "", ""))


def _beyond(curves: Sequence[ElasticCurve], poisson: float, asked: Span | None) -> float:
    """The largest logarithmic strain of use over the largest principal one of a test, by sign."""
    if asked is None:
        return 1.0
    ends = np.concatenate([
        np.log(x) * direction(one.mode, poisson)
        for one in curves
        for x in (one.stretch.min(), one.stretch.max())
    ])  # fmt: skip
    parts = [
        sign * math.log(use) / known if (known := float((sign * ends).max())) > 0 else math.inf
        for sign, use in zip((-1.0, 1.0), asked, strict=True)
        if sign * (use - 1) > 0
    ]
    return max(parts, default=0.0)


def _apart(curves: Sequence[ElasticCurve]) -> float | None:
    """The largest mean difference of two files of one mode over what both cover."""
    found = []
    for one, other in combinations(curves, 2):
        low = max(one.stretch[0], other.stretch[0])
        high = min(one.stretch[-1], other.stretch[-1])
        if one.mode == other.mode and high > low:
            x = np.linspace(low, high, 60)
            first, second = (np.interp(x, each.stretch, each.stress) for each in (one, other))
            found.append(float(np.abs(first - second).sum() / np.abs(first + second).sum() * 2))
    return max(found, default=None)


def _unstated(curves: Sequence[ElasticCurve]) -> float:
    """What the stress would be off by if it were the true one, where nothing says which."""
    open_ = [one for one in curves if not one.stated and one.mode != "volumetric"]
    return max((float(np.abs(one.stretch - 1).max()) for one in open_), default=0.0)


def _slack(curves: Sequence[ElasticCurve], poisson: float, best: float) -> tuple[float, str]:
    """The shift of one curve's zero without which no stable law comes half as close."""
    found = (best, 0.0, "")
    for i, one in enumerate(curves):
        far = float(one.stretch[np.argmax(np.abs(one.stretch - 1))] - 1)
        for part in (*_SHIFTS, *(-each for each in _SHIFTS)):
            moved = replace(one, stretch=one.stretch - part * far)
            left = closest([*curves[:i], moved, *curves[i + 1 :]], poisson)
            found = min(found, (left, part, _name(one)))
    left, part, name = found
    return (part, name) if left < 0.5 * best and best > SMALL else (0.0, "")


def _reading(
    curves: Sequence[ElasticCurve], poisson: float, best: float
) -> tuple[float | None, str, float]:
    """How many times closer a stable law comes if one file is read otherwise, and how."""
    if len({one.mode for one in curves}) < 2:
        return None, "", best
    found = (best, "")
    for i, one in enumerate(curves):
        if one.mode == "volumetric":
            continue
        named: dict[str, ElasticCurve] = {
            "true stress where nominal stress was taken": replace(
                one, stress=one.stress / one.stretch
            ),
            "nominal stress where true stress was taken": replace(
                one, stress=one.stress * one.stretch
            ),
            **{mode: replace(one, mode=mode) for mode in SHEARING if mode != one.mode},
        }
        for says, other in named.items():
            left = closest([*curves[:i], other, *curves[i + 1 :]], poisson)
            found = min(found, (left, f"{_name(one)} read as {says}"))
    return best / max(found[0], SMALL), found[1], best


@criterion(
    "residual / stress, rms",
    "<=",
    FOLLOWED,
    "our choice: pieces scatter so",
    otherwise="stop beyond 0.2",
)
def law_followed(residual: float, worst: str) -> Finding:
    """The law follows every curve."""
    return Finding(
        f"what is left is at most {100 * residual:.2g} % of the stress, in {worst}",
        residual,
        ": take a law of more constants, or see whether the file is what it is said to be",
        grade="stop" if residual > 0.2 else "limit",
    )


@criterion("residual / that of the closest stable law", "<=", 2.0, "our choice: twice as close")
def no_law_closer(residual: float, flexible: float) -> Finding:
    """No other stable law follows the curves much closer."""
    ratio = residual / max(flexible, SMALL)
    return Finding(
        f"the law leaves {100 * residual:.2g} % of the stress, the most flexible stable one "
        f"{100 * flexible:.2g} %",
        ratio,
        ": what is left has a shape that a law of more constants follows (--model ogden)",
    )


@criterion("least eigenvalue of the tangent / G", ">", 0.0, "D. C. Drucker, 1959", grade="stop")
def stable_in_use(
    least: float, where: str, limits: Sequence[tuple[Mode, tuple[float | None, float | None]]]
) -> Finding:
    """The law is stable over the stretches of use in every mode (Drucker)."""
    ends = [
        f"{mode} {'below' if low else 'above'} {at:.4g}"
        for mode, both in limits
        for low, at in zip((True, False), both, strict=True)
        if at is not None
    ]
    beyond = f"; it is not in {', '.join(ends)}" if ends else " and everywhere from 0.1 to 10"
    return Finding(
        f"the law is stable over the stretches of use{beyond}",
        least,
        instead=f"the law is not stable in use, first at {where}{beyond if ends else ''}: a solver "
        "stops there or finds what is not; take another law, or one of power terms (--model "
        "ogden), "
        "which are stable",
    )


@criterion("doubt of the stress / largest", "<=", TOLD, "our choice: a tenth")
def modes_told(doubt: float | None, mode: str, why: str) -> Finding:
    """The tests tell the stress in the modes that were not measured, too."""
    if doubt is None:
        return Finding("no second law follows the tests to compare with in the modes not measured")
    if not mode:
        return Finding("every mode was measured", 0.0)
    return Finding(
        f"in {mode}, which was not measured, {why} by {100 * doubt:.2g} % of the largest stress",
        doubt,
        ": these tests do not tell the law there; measure that mode, or use the law in the modes "
        "measured alone",
    )


@criterion("largest strain of use / measured", "<=", 1.0, "beyond it nothing was measured")
def use_measured(ratio: float) -> Finding:
    """The stretches of use were measured."""
    says = "not measured at all" if math.isinf(ratio) else f"{ratio:.3g} times those measured"
    return Finding(
        f"the largest strains of use are {says}",
        ratio,
        ": the law is extrapolated; test as far as the part goes, in tension and compression",
    )


@criterion("half interval / largest constant", "<=", 0.25, "our choice: a quarter")
def constants_known(name: str, part: float) -> Finding:
    """Every constant is known."""
    return Finding(
        f"the least known constant, {name}, is known to {100 * part:.2g} % of the largest",
        part,
        ": the tests do not part the constants; add a mode (equibiaxial parts C10 from C01), or "
        "take a law of fewer",
    )


@criterion("rows / constants", ">=", 4.0, "our choice: fewer follow anything")
def rows_enough(rows: int, constants: int) -> Finding:
    """There are enough rows for the constants."""
    return Finding(
        f"{rows} points tell {constants} constants",
        rows / constants,
        ": a law so free follows any points, wrong ones too; take more rows, or fewer constants",
    )


@criterion("mean difference of two files", "<=", ALIKE, "our choice: pieces scatter so")
def files_agree(apart: float | None) -> Finding:
    """Files of one mode show one curve."""
    if apart is None:
        return Finding("no mode has two files over the same stretches")
    return Finding(
        f"files of one mode differ by up to {100 * apart:.2g} %",
        apart,
        ": another rate, piece or conditioning; a rate is taken off with the memory of a "
        "relaxation test (--memory)",
    )


@criterion("part of the energy", "<=", 0.1, "our choice: beyond it loading is not the elastic law")
def loading_returned(lost: float | None, *, removed: bool) -> Finding:
    """Unloading gives back what loading took."""
    if lost is None:
        return Finding("no unloading shows how much of the stress is elastic")
    advice = (
        ": the memory taken off is not this material's, or it rubs or softens besides"
        if removed
        else ": the loading is no elastic curve, but one with memory or softening; take off the "
        "memory of a relaxation test (--memory), or condition and test slowly"
    )
    return Finding(f"a cycle loses {100 * lost:.2g} % of its energy", lost, advice)


@criterion("1 - last loading / first", "|x| <=", 0.05, "our choice; L. Mullins, 1948")
def conditioned(softer: float | None) -> Finding:
    """The material no longer softens from loading to loading."""
    if softer is None:
        return Finding("one loading shows no softening (Mullins); whether it was the first is open")
    return Finding(
        f"the last loading is {100 * softer:.2g} % softer than the first",
        softer,
        ": it was not conditioned; the last is taken, as a part in use is; the first of a new part "
        "is stiffer (--part cycle=1)",
    )


@criterion("shift / largest strain", "|x| <=", 0.005, "a shift below it is not sought")
def zero_known(part: float, name: str) -> Finding:
    """Stress and strain are zero together."""
    if not name:
        return Finding("no shift of the strain's zero makes the curves those of a law", 0.0)
    return Finding(
        f"{name} is followed if its strain is zero {100 * part:.2g} % of the largest later",
        part,
        ": slack, a toe or a preload; set the zero where the stress begins, and cut what is before",
    )


@criterion("residual as read / as read otherwise", "<=", 3.0, "our choice: a third of the residual")
def labels_agree(ratio: float | None, says: str, as_read: float) -> Finding:
    """No other reading of a file makes the modes agree."""
    if ratio is None:
        return Finding("one mode alone does not show whether it, or its stress, is labelled right")
    return Finding(
        f"read as labelled, a stable law leaves {100 * as_read:.2g} % of the stress",
        ratio,
        f"; with {says} {100 * as_read / ratio:.2g} %: is the label right?",
        excused=as_read <= 0.02,
    )


@criterion("part of the stress", "<=", 0.1, "our choice: a tenth")
def measures_stated(part: float) -> Finding:
    """It was said whether stress and strain are nominal or true."""
    return Finding(
        "what stress and strain are over was said" if not part else
        f"stress and strain are taken as nominal, which the files do not say; a true stress is "
        f"{100 * part:.3g} % another",
        part,
        ": laws follow either, so nothing else shows it; say which (--stress-is nominal)",
    )  # fmt: skip


@criterion(grade="note")
def volume_known(*, known: bool) -> Finding:
    """The bulk modulus is known."""
    return Finding(
        "the change of volume is known",
        instead="no test of the volume: a deck needs a bulk modulus, which is then stated, not "
        "measured (--test volumetric, or dashpot export --bulk-modulus)",
        faulted=not known,
    )
