r"""Selection of the number of arms by two rules that fail in different ways.

* BIC with the effective sample size, :math:`M_\mathrm{eff} \ln S + p \ln M_\mathrm{eff}`:
  correlated residuals do not count as fresh evidence.
* Significance: every arm has k > 3 SE and SE(ln tau) < 0.5.

The smaller of the two numbers is taken: an arm must satisfy both rules. But a number of arms that
BIC rejects by more than 50 is no answer. Such a fall is significant (11.8 for the k and tau of an
arm) even if only one in four of the residuals counted that kappa lets count; the arm is there,
however poorly its k and tau are distinguished from a plateau and a drift. If the rules disagree,
the result is marked. Source: G. Schwarz, Annals of Statistics 6 (1978) 461, with the sample size of
a correlated record.

Where the noise is as slow as the arms, one :math:`M_\mathrm{eff}` is wrong for all of them: fast
arms meet little of that noise. And the slowest arm, which trades with the plateau, has an SE of
ln tau above 0.5 however sure it is that something relaxes there: a Wald ratio falls as the
estimate runs away. The same two questions are then put to the fits in the metric of the noise
(:mod:`dashpot.numerics.inference.correlated_noise`), whose SSE is a deviance :math:`\chi^2`:

* BIC, :math:`\chi^2 + p \ln M_\mathrm{eff}`;
* significance, :math:`\chi^2_{n-1} - \chi^2_n` beyond what chance exceeds with probability 0.0027,
  3 standard errors of one normal variable, for the parameters that an arm brings. The extra arm's
  tau exists only if the arm does; that k > 0 makes up for the search over it.

Sources: W. W. Hauck and A. Donner, Journal of the American Statistical Association 72 (1977) 851,
for the Wald ratio; R. B. Davies, Biometrika 74 (1987) 33, for a parameter without a null value.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import erfc, exp, lgamma, log, sqrt
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray

MIN_K_OVER_SE = 3.0
MAX_SE_LN_TAU = 0.5
#: chance of a normal variable beyond `MIN_K_OVER_SE` standard deviations
MAX_CHANCE = erfc(MIN_K_OVER_SE / sqrt(2.0))


#: difference of BIC that is decisive even where k and tau are uncertain
DECISIVE_BIC = 50.0


class OrderChoice(NamedTuple):
    """Chosen number of arms, with the choice of each rule.

    Attributes
    ----------
    arms, by_bic, by_significance : int
        `arms` is the smaller of the two, unless BIC is decisive.
    is_largest_tried : bool
        The choice is the largest number that was tried, and more might be better still.
    in_noise_metric : bool
        The rules judged fits in the metric of the noise, not by plain least squares.
    """

    arms: int
    by_bic: int
    by_significance: int
    is_largest_tried: bool = False
    in_noise_metric: bool = False

    @property
    def has_agreement(self) -> bool:
        """True if both rules chose the same number."""
        return self.by_bic == self.by_significance


class ArmShortage(NamedTuple):
    """Requested number of arms below the number that the data support.

    Attributes
    ----------
    requested_arms, supported_arms : int
        Requested number, and number by the rules.
    rms, supported_rms : float
        What either leaves.
    """

    requested_arms: int
    supported_arms: int
    rms: float
    supported_rms: float


def deviance(sse: float, *, effective: float, rounding_sse: float = 0.0) -> float:
    r"""Return :math:`M_\mathrm{eff} \ln(S + S_0)`: BIC without the term of the parameters.

    As :func:`bic`; sums of squares below 1e-300 are taken for that.
    """
    return effective * float(np.log(max(sse + rounding_sse, 1e-300)))


def bic(sse: float, *, effective: float, parameters: int, rounding_sse: float = 0.0) -> float:
    r"""Return :math:`M_\mathrm{eff} \ln(S + S_0) + p \ln M_\mathrm{eff}`.

    Parameters
    ----------
    sse : float
        Sum of squared residuals S.
    effective : float
        Effective number of independent residuals.
    parameters : int
        Number of fitted parameters p, nuisance terms included.
    rounding_sse : float
        :math:`S_0`, the sum of squares that rounding alone leaves; a gain below it is no gain.
    """
    fits = deviance(sse, effective=effective, rounding_sse=rounding_sse)
    return fits + parameters * float(np.log(effective))


def bic_of_deviance(deviance: float, *, effective: float, parameters: int) -> float:
    r"""Return :math:`\chi^2 + p \ln M_\mathrm{eff}`, for noise of known covariance."""
    return deviance + parameters * float(np.log(effective))


def significant(k: FloatArray, se_k: FloatArray, se_ln_tau: FloatArray) -> bool:
    """Return True if every arm has k > 3 SE and SE(ln tau) < 0.5; True without arms."""
    return bool(is_well_determined(k, se_k, se_ln_tau).all())


def is_well_determined(k: FloatArray, se_k: FloatArray, se_ln_tau: FloatArray) -> BoolArray:
    """Return for each arm whether k > 3 SE and SE(ln tau) < 0.5."""
    return np.asarray((k > MIN_K_OVER_SE * se_k) & (se_ln_tau < MAX_SE_LN_TAU))


def is_significant_fall(deviance_fall: float, parameters: int) -> bool:
    """Return whether `deviance_fall` is significant for the number of parameters."""
    return chi2_sf(deviance_fall, parameters) < MAX_CHANCE


def chi2_sf(value: float, dof: int) -> float:
    r"""Return :math:`P(\chi^2_\nu > x)` for whole degrees of freedom.

    .. math:: Q_{\nu+2} = Q_\nu + \frac{(x/2)^{\nu/2} e^{-x/2}}{\Gamma(\nu/2 + 1)}, \qquad
        Q_1 = \mathrm{erfc}\sqrt{x/2}, \quad Q_2 = e^{-x/2}

    Every term is the exponential of its logarithm: power and gamma function alone overflow.

    >>> round(chi2_sf(11.829, 2), 5)
    0.0027
    """
    half_value = max(value, 0.0) / 2.0
    if half_value == 0.0:
        return 1.0
    chance = erfc(sqrt(half_value)) if dof % 2 else exp(-half_value)
    for nu in range(2 - dof % 2, dof, 2):
        chance += exp(nu / 2.0 * log(half_value) - half_value - lgamma(nu / 2.0 + 1.0))
    return min(chance, 1.0)


def select_model_order(
    arms: Sequence[int],
    bics: Sequence[float],
    significances: Sequence[bool],
    *,
    is_exhausted: bool = True,
    in_noise_metric: bool = False,
    decisive: float = np.inf,
) -> OrderChoice:
    """Return the number of arms that both rules support.

    Parameters
    ----------
    arms : sequence of int
        Candidates.
    bics, significances : sequences
        Score of each candidate, and whether all of its arms are significant.
    is_exhausted : bool
        False if larger numbers could still fit better and were not tried.
    in_noise_metric : bool
        How the scores were made; kept in the choice.
    decisive : float
        How much worse than the best BIC the choice may be.
    """
    by_bic = arms[int(np.argmin(bics))]
    by_significance = max(
        (n for n, is_significant in zip(arms, significances, strict=True) if is_significant),
        default=0,
    )
    allowed = (n for n, score in zip(arms, bics, strict=True) if score <= min(bics) + decisive)
    arm_count = min(n for n in allowed if n >= min(by_bic, by_significance))
    return OrderChoice(
        arm_count,
        by_bic,
        by_significance,
        is_largest_tried=not is_exhausted and arm_count == max(arms),
        in_noise_metric=in_noise_metric,
    )
