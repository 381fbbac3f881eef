r"""From the covariance of a fit to standard errors, to intervals a reader can trust.

The rows of the covariance are k in N/m and ln tau; what people read follows by the delta method:

.. math:: \mathrm{SE}(\tau) = \tau\,\mathrm{SE}(\ln\tau), \qquad
          \mathrm{Var}(\ln b) = \frac{\mathrm{Var}(k)}{k^2} + \frac{2\,\mathrm{Cov}(k, \ln\tau)}{k}
                              + \mathrm{Var}(\ln\tau), \quad b = k\tau

Intervals are Student's, symmetric in k and in ln tau (so tau > 0 always). Where a profile
likelihood is stored it replaces them: both ends are where the deviance reaches the quantile, and
an end that the data leave open is open.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import exp, inf, isfinite, sqrt
from typing import NamedTuple

import numpy as np

from dashpot._arrays import FloatArray
from dashpot.engine.student import t_quantile

Interval = tuple[float, float]


class Estimates(NamedTuple):
    """The numbers of a fit that its intervals follow from."""

    k_inf: float
    k: tuple[float, ...]
    tau: tuple[float, ...]
    parameters: tuple[str, ...]
    covariance: FloatArray
    dof: float


class Errors(NamedTuple):
    """Standard errors in SI units."""

    k_inf: float
    k: tuple[float, ...]
    tau: tuple[float, ...]
    b: tuple[float, ...]


class Bounds(NamedTuple):
    """Lower and upper end of each parameter, SI units."""

    k_inf: Interval
    k: tuple[Interval, ...]
    tau: tuple[Interval, ...]
    b: tuple[Interval, ...]


def standard_errors(estimates: Estimates) -> Errors:
    """Return the standard errors of k_inf, of each k, tau and b = k tau."""
    arms = range(1, len(estimates.k) + 1)
    log_tau = [_se(estimates, f"ln_tau_{j}") for j in arms]
    log_b = [_se_log_b(estimates, j) for j in arms]
    return Errors(
        _se(estimates, "k_inf"),
        tuple(_se(estimates, f"k_{j}") for j in arms),
        tuple(tau * se for tau, se in zip(estimates.tau, log_tau, strict=True)),
        tuple(k * tau * se for k, tau, se in zip(estimates.k, estimates.tau, log_b, strict=True)),
    )


def intervals(
    estimates: Estimates,
    profiles: Mapping[str, tuple[FloatArray, FloatArray]],
    *,
    level: float,
) -> Bounds:
    """Return the intervals at `level`, from the profile where there is one.

    Parameters
    ----------
    estimates : Estimates
    profiles : mapping
        Parameter name to (trial values ascending, deviance).
    level : float
        Coverage, such as 0.95.
    """
    quantile = t_quantile(level, estimates.dof)

    def of(name: str, value: float, se: float) -> Interval:
        if name in profiles:
            return profile_interval(*profiles[name], deviance_limit=quantile**2)
        if not isfinite(se):
            return -inf, inf
        return value - quantile * se, value + quantile * se

    def positive(name: str, value: float) -> Interval:
        low, high = of(name, value, _se(estimates, name))
        return max(low, 0.0), high

    def exponential(name: str, value: float, se: float) -> Interval:
        low, high = of(name, float(np.log(value)), se)
        return _exp(low), _exp(high)

    arms = list(enumerate(zip(estimates.k, estimates.tau, strict=True), start=1))
    return Bounds(
        positive("k_inf", estimates.k_inf),
        tuple(positive(f"k_{j}", k) for j, (k, _) in arms),
        tuple(
            exponential(f"ln_tau_{j}", tau, _se(estimates, f"ln_tau_{j}")) for j, (_, tau) in arms
        ),
        tuple(exponential(f"ln_b_{j}", k * tau, _se_log_b(estimates, j)) for j, (k, tau) in arms),
    )


def profile_interval(value: FloatArray, deviance: FloatArray, *, deviance_limit: float) -> Interval:
    """Return where `deviance` crosses `deviance_limit`; an end that it never reaches is open.

    The crossing is interpolated on the square root of the deviance, which is straight where the
    likelihood is Gaussian.
    """
    root = np.sqrt(np.maximum(deviance, 0.0))
    limit = sqrt(deviance_limit)
    best = int(np.argmin(root))
    return (
        _crossing(value[best::-1], root[best::-1], limit, -inf),
        _crossing(value[best:], root[best:], limit, inf),
    )


def _crossing(value: FloatArray, root: FloatArray, limit: float, open_end: float) -> float:
    beyond = np.flatnonzero(root >= limit)
    if not beyond.size:
        return open_end
    i = int(beyond[0])
    if i == 0:
        return float(value[0])
    share = (limit - root[i - 1]) / (root[i] - root[i - 1])
    return float(value[i - 1] + share * (value[i] - value[i - 1]))


def _exp(value: float) -> float:
    return exp(value) if value < 700.0 else inf


def _row(parameters: Sequence[str], name: str) -> int | None:
    return parameters.index(name) if name in parameters else None


def _se(estimates: Estimates, name: str) -> float:
    """Return the standard error of one row; 0 for a parameter that was held fixed.

    Where no parameter has a row, nothing was held: nothing is known of any.
    """
    if not estimates.parameters:
        return inf
    row = _row(estimates.parameters, name)
    return 0.0 if row is None else sqrt(max(float(estimates.covariance[row, row]), 0.0))


def _se_log_b(estimates: Estimates, arm: int) -> float:
    if not estimates.parameters:
        return inf
    k = estimates.k[arm - 1]
    rows = [_row(estimates.parameters, name) for name in (f"k_{arm}", f"ln_tau_{arm}")]
    gradient = np.zeros(len(estimates.parameters))
    for row, slope in zip(rows, (1.0 / k, 1.0), strict=True):
        if row is not None:
            gradient[row] = slope
    used = gradient != 0.0
    block = estimates.covariance[np.ix_(used, used)]
    if not np.all(np.isfinite(block)):
        return inf
    return sqrt(max(float(gradient[used] @ block @ gradient[used]), 0.0))
