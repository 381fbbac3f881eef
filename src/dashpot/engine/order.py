r"""How many arms the data support, by two rules that fail in different ways.

* BIC with the effective sample size, :math:`M_\mathrm{eff} \ln S + p \ln M_\mathrm{eff}`:
  correlated residuals do not count as fresh evidence.
* Significance: every arm has k > 3 SE and SE(ln tau) < 0.5.

The smaller of the two answers is taken: an arm that either rule doubts is not worth its place.
Where they disagree the caller is told.
Source: G. Schwarz, Annals of Statistics 6 (1978) 461, with the sample size of a correlated record.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dashpot._arrays import FloatArray

MIN_K_OVER_SE = 3.0
MAX_SE_LN_TAU = 0.5


@dataclass(frozen=True)
class Choice:
    """The chosen number of arms, and what each rule would have chosen.

    Attributes
    ----------
    arms, by_bic, by_significance : int
    capped : bool
        The choice is the largest number that was tried, and more might be better still.
    """

    arms: int
    by_bic: int
    by_significance: int
    capped: bool = False

    @property
    def agreed(self) -> bool:
        """True if both rules chose the same number."""
        return self.by_bic == self.by_significance


def bic(sse: float, *, effective: float, parameters: int, floor: float = 0.0) -> float:
    r"""Return :math:`M_\mathrm{eff} \ln(S + S_0) + p \ln M_\mathrm{eff}`.

    Parameters
    ----------
    sse : float
        Sum of squared residuals S.
    effective : float
        Effective number of independent residuals.
    parameters : int
        Number of fitted parameters p, nuisance terms included.
    floor : float
        :math:`S_0`, the sum of squares that rounding alone leaves; a gain below it is no gain.
    """
    return effective * float(np.log(sse + floor)) + parameters * float(np.log(effective))


def significant(k: FloatArray, se_k: FloatArray, se_ln_tau: FloatArray) -> bool:
    """Return True if every arm has k > 3 SE and SE(ln tau) < 0.5; True without arms."""
    return bool(np.all(k > MIN_K_OVER_SE * se_k) and np.all(se_ln_tau < MAX_SE_LN_TAU))


def choose(
    arms: Sequence[int],
    bics: Sequence[float],
    significances: Sequence[bool],
    *,
    exhausted: bool = True,
) -> Choice:
    """Return the number of arms that both rules support.

    Parameters
    ----------
    arms : sequence of int
        Candidates.
    bics, significances : sequences
        Score of each candidate, and whether all of its arms are significant.
    exhausted : bool
        False if larger numbers could still fit better and were not tried.
    """
    by_bic = arms[int(np.argmin(bics))]
    by_significance = max((n for n, yes in zip(arms, significances, strict=True) if yes), default=0)
    chosen = min(by_bic, by_significance)
    return Choice(chosen, by_bic, by_significance, capped=not exhausted and chosen == max(arms))
