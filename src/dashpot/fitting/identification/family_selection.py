"""Arms or a fractional element, where a hammer has a say: which to take, and what the other is.

The rule is that of tests alone (:mod:`dashpot.fitting.fractional_model.family_selection`): arms
keep their place unless BIC falls by more than 10, and what chance does not tell from the best is
told beside it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from dashpot.base.checks import Check
from dashpot.datamodel.alternative_model import Alternative
from dashpot.fitting.fractional_model.checks import (
    element_explains,
    families_told_apart,
    slope_known,
)
from dashpot.fitting.fractional_model.family_selection import VERY_STRONG, build_alternative
from dashpot.fitting.identification.likelihood import Candidate
from dashpot.fitting.identification.parametrisation import FractionalElement, is_at_edge
from dashpot.numerics.inference.model_order import is_significant_fall

# what would tell families apart that explain a hammer alone, and with relaxation tests
_ALONE, _JOINT = "a relaxation test of the seal", "a colder test or a hammer on another mass"


class AlternativeCandidate(NamedTuple):
    """The best candidate of the other family.

    Attributes
    ----------
    best, other : Candidate
    explains : bool
        What it leaves may be chance, or BIC does not tell the two apart.
    """

    best: Candidate
    other: Candidate
    explains: bool

    @property
    def worst_misfit_ratio(self) -> float:
        """Root of what the best leaves of a test over what the other does, of the worst test."""
        mine, other = (_compute_misfits(candidate) for candidate in (self.best, self.other))
        return float(np.sqrt(np.max(mine / np.maximum(other, 1e-300))))

    def alternative(self, band: tuple[float, float]) -> Alternative:
        """The other family as a fit keeps it; `band` is what the tests inform, Hz."""
        problem, rise = self.best.problem, self.other.bic - self.best.bic
        single = not problem.relaxations and problem.constraints.before is None
        return build_alternative(
            self.best.point.model, self.other.point.model, rise, band,
            explains=self.explains, extra=_ALONE if single else _JOINT,
        )  # fmt: skip


def chosen_rival(
    arms: Candidate, tried: Sequence[Candidate], candidate: Candidate, family: str
) -> AlternativeCandidate:
    """Return the family asked for, or with ``"auto"`` the one that BIC prefers, and the other.

    Parameters
    ----------
    arms : Candidate
        The number of arms taken.
    tried : sequence of Candidate
        Every one.
    candidate : Candidate
        The best element.
    family : "fractional" or "auto"
    """
    several = [arms, *(other for other in tried if other.arms > arms.arms)]
    better = candidate.bic + VERY_STRONG < arms.bic and not is_at_bound(candidate)
    best, others = (candidate, several) if family == "fractional" or better else (arms, [candidate])
    explain = [other for other in others if _explains(other, best)]
    return AlternativeCandidate(best, (explain or others)[0], bool(explain))


def reselect_family(
    rival: AlternativeCandidate, free: Callable[[Candidate], Candidate]
) -> AlternativeCandidate:
    """The same two where what the tests contradict is free: else a wrong mass chooses the solid."""
    best, other = free(rival.best), free(rival.other)
    return AlternativeCandidate(best, other, _explains(other, best))


def is_at_bound(candidate: Candidate) -> bool:
    """True if a relaxation time or a slope stands at an end of what is sought."""
    problem = candidate.problem
    numbers = candidate.theta[: problem.sought.size]
    return is_at_edge(problem.sought, numbers, problem.log_tau_range)


def family_checks(
    best: Candidate, rival: AlternativeCandidate | None, other: Alternative | None
) -> list[Check]:
    """Ask of an element whether it is known and explains the tests, of either for the other."""
    answers = []
    if isinstance(best.problem.sought, FractionalElement):
        answers.append(slope_known(float(np.sqrt(best.covariance[3, 3])), edge=is_at_bound(best)))
        if rival is not None:
            answers.append(element_explains(rival.worst_misfit_ratio, rival.other.arms))
    return answers if rival is None else [*answers, families_told_apart(other)]


def _compute_misfits(candidate: Candidate) -> np.ndarray:
    """Squared misfit of the lines, then of each relaxation test."""
    return np.array([candidate.line_misfit, *candidate.relaxation_chi2])


def _explains(other: Candidate, best: Candidate) -> bool:
    more = len(best.theta) - len(other.theta)
    rise = other.bic - best.bic
    fall = rise + more * float(np.log(best.samples))
    return rise < VERY_STRONG or not is_significant_fall(fall, max(more, 1))
