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

from dataclasses import dataclass
from math import exp, inf, isfinite, sqrt
from typing import TYPE_CHECKING, TypedDict

import numpy as np

from dashpot.base.arrays import ByValue, FloatArray, Frozen, frozen
from dashpot.base.errors import DataError
from dashpot.solids.interconversion import CreepSpectrum

if TYPE_CHECKING:
    from dashpot.solids.fractional import FractionalZener
    from dashpot.solids.maxwell import GeneralizedMaxwell

Interval = tuple[float, float]

#: rows of the covariance of a fractional Zener solid
ELEMENT = ("k_inf", "k_0", "ln_tau", "alpha")
#: rows that no number of equal solids in parallel changes
SHAPE = ("ln_", "alpha")


class Intervals(TypedDict):
    """Confidence intervals in SI units, one per parameter of the model."""

    k_inf: Interval
    k: tuple[Interval, ...]
    tau: tuple[Interval, ...]
    b: tuple[Interval, ...]


class StandardErrors(TypedDict):
    """Standard errors in SI units, one per parameter of the model."""

    k_inf: float
    k: tuple[float, ...]
    tau: tuple[float, ...]
    b: tuple[float, ...]


def parameter_names(arms: int, *, dashpot: bool = False) -> tuple[str, ...]:
    """Return the names of a solid's parameters: k_inf, every k, every ln tau, and b."""
    numbers = range(1, arms + 1)
    names = ("k_inf", *(f"k_{j}" for j in numbers), *(f"ln_tau_{j}" for j in numbers))
    return (*names, "b") if dashpot else names


@dataclass(frozen=True)
class Residual:
    """Statistics of what the model leaves unexplained.

    Attributes
    ----------
    n : int
        Samples fitted.
    sse : float
        Sum of squared residuals, in the square of `unit`.
    rms : float
        Root mean square residual, in `unit`.
    kappa : float
        n / effective n: how many neighbouring residuals say the same thing (1 if white).
    durbin_watson : float
        About 2 for white residuals, towards 0 for correlated ones.
    unit : str
        ``"N"``; ``"1"`` where each is relative to its own value; ``"sd"`` in standard deviations of
        the scatter of each set; else that of the modulus.
    """

    n: int
    sse: float
    rms: float
    kappa: float = 1.0
    durbin_watson: float = 2.0
    unit: str = "N"


@dataclass(frozen=True, eq=False)
class Profile(Frozen):
    """Profile likelihood of one parameter: deviance against its value.

    Attributes
    ----------
    parameter : str
        Name as in ``Fit.parameters``, for example ``"ln_tau_2"``; ``"ln_b_2"`` for b = k tau.
    value, deviance : array, shape (m,)
        Trial values, ascending, and ``(SSE(value) - SSE_min) / (kappa * s^2)``: compared
        with the chi-square or F quantile of one degree of freedom.
    """

    parameter: str
    value: FloatArray
    deviance: FloatArray

    def __post_init__(self) -> None:
        if len(self.value) != len(self.deviance) or not len(self.value):
            raise DataError(
                f"the profile of {self.parameter} has {len(self.value)} values and "
                f"{len(self.deviance)} deviances; expected one of each, or more"
            )
        super().__post_init__()


@dataclass(frozen=True)
class Nuisance:
    """A parameter the fit needed and the user did not ask for: tare, drift, gain, delay, mass.

    `prior_sd` is its standard deviation before the fit, where that is on record.
    """

    name: str
    value: float
    standard_error: float
    unit: str
    prior_sd: float | None = None


@dataclass(frozen=True, eq=False)
class ParameterEstimate(ByValue):
    """How well the parameters of a solid are known.

    Attributes
    ----------
    parameters : tuple of str
        Names of the rows of `covariance`: ``"k_inf"``, ``"k_1"``..., ``"ln_tau_1"``...,
        and ``"b"`` if it was fitted; of a fractional Zener solid ``"k_inf"``, ``"k_0"``,
        ``"ln_tau"`` and ``"alpha"``. Stiffness in N/m, ln of tau in s.
    covariance : array, shape (p, p)
        Of those parameters, for correlated residuals. Infinite where not identified.
    dof : float
        Degrees of freedom of the t quantile: effective samples less parameters.
    residual : Residual
    profiles : tuple of Profile
        Where the covariance is no good guide to an interval.
    nuisance : tuple of Nuisance
    """

    parameters: tuple[str, ...]
    covariance: FloatArray
    dof: float
    residual: Residual
    profiles: tuple[Profile, ...] = ()
    nuisance: tuple[Nuisance, ...] = ()

    def __post_init__(self) -> None:
        covariance = np.asarray(self.covariance, dtype=float)
        size = len(self.parameters)
        if covariance.shape != (size, size):
            raise DataError(
                f"covariance has shape {covariance.shape}, expected {(size, size)}: "
                "one row per parameter"
            )
        object.__setattr__(self, "covariance", frozen(covariance))

    def of_arms(self, solid: FractionalZener) -> ParameterEstimate:
        """What is known of a fractional solid, as of the arms that stand for it: to first order."""
        gradient = solid.arm_gradient()
        rows = [self.parameters.index(name) for name in ELEMENT]
        own = self.covariance[np.ix_(rows, rows)]
        if np.isfinite(own).all():
            covariance = gradient @ own @ gradient.T
        else:
            covariance = np.diag(np.full(len(gradient), inf))
        names = parameter_names(len(gradient) // 2)
        return ParameterEstimate(names, covariance, self.dof, self.residual)

    def element_errors(self, solid: FractionalZener) -> dict[str, float]:
        """Standard errors of k_inf, k_0, tau and alpha, SI units."""
        own = {name: self._error(name) for name in ELEMENT}
        return {
            "k_inf": own["k_inf"],
            "k_0": own["k_0"],
            "tau": solid.tau * own["ln_tau"],
            "alpha": own["alpha"],
        }

    def element_intervals(self, solid: FractionalZener, level: float) -> dict[str, Interval]:
        """Student's intervals at `level` of k_inf, k_0, tau and alpha, SI units.

        Raises
        ------
        DataError
            If `level` is not between 0 and 1.
        """
        quantile = self._quantile(level)
        own = {name: self._error(name) for name in ELEMENT}
        reach = {name: quantile * e if isfinite(e) else inf for name, e in own.items()}
        log_tau = float(np.log(solid.tau))
        return {
            "k_inf": (max(solid.k_inf - reach["k_inf"], 0.0), solid.k_inf + reach["k_inf"]),
            "k_0": (max(solid.k_0 - reach["k_0"], 0.0), solid.k_0 + reach["k_0"]),
            "tau": (_exp(log_tau - reach["ln_tau"]), _exp(log_tau + reach["ln_tau"])),
            "alpha": (
                max(solid.alpha - reach["alpha"], 0.0),
                min(solid.alpha + reach["alpha"], 1.0),
            ),
        }

    def standard_errors(self, model: GeneralizedMaxwell) -> StandardErrors:
        """Standard errors of k_inf, and of k, tau and b = k tau of each arm of `model`."""
        arms = range(1, model.arms + 1)
        return StandardErrors(
            k_inf=self._error("k_inf"),
            k=tuple(self._error(f"k_{j}") for j in arms),
            tau=tuple(t * self._error(f"ln_tau_{j}") for j, t in enumerate(model.tau, start=1)),
            b=tuple(b * self._error_of_log_b(model, j) for j, b in enumerate(model.arm_b, start=1)),
        )

    def intervals(self, model: GeneralizedMaxwell, level: float) -> Intervals:
        """Intervals at `level` of the parameters of `model`, from the profile where there is one.

        Raises
        ------
        DataError
            If `level` is not between 0 and 1.
        """
        quantile = self._quantile(level)
        profiles = {profile.parameter: profile for profile in self.profiles}

        def of(name: str, value: float, error: float) -> Interval:
            if name in profiles:
                return profile_interval(profiles[name], deviance_limit=quantile**2)
            reach = quantile * error if isfinite(error) else inf
            return value - reach, value + reach

        def stiffness(name: str, value: float) -> Interval:
            low, high = of(name, value, self._error(name))
            return max(low, 0.0), high

        def exponential(name: str, value: float, error: float) -> Interval:
            low, high = of(name, float(np.log(value)), error)
            return _exp(low), _exp(high)

        k, tau, b = (list(enumerate(each, start=1)) for each in (model.k, model.tau, model.arm_b))
        return Intervals(
            k_inf=stiffness("k_inf", model.k_inf),
            k=tuple(stiffness(f"k_{j}", value) for j, value in k),
            tau=tuple(
                exponential(f"ln_tau_{j}", value, self._error(f"ln_tau_{j}")) for j, value in tau
            ),
            b=tuple(
                exponential(f"ln_b_{j}", value, self._error_of_log_b(model, j)) for j, value in b
            ),
        )

    def _quantile(self, level: float) -> float:
        # Student's distribution costs an import that a fit alone does not pay
        from dashpot.base.student_t import t_quantile

        if not 0.0 < level < 1.0:
            raise DataError(f"level = {level!r}; expected a coverage between 0 and 1, such as 0.95")
        return t_quantile(level, self.dof)

    def _error(self, name: str) -> float:
        """Standard error of one row; 0 for a parameter that was held fixed.

        Where no parameter has a row, nothing was held: nothing is known of any.
        """
        if not self.parameters:
            return inf
        if name not in self.parameters:
            return 0.0
        row = self.parameters.index(name)
        return sqrt(max(float(self.covariance[row, row]), 0.0))

    def _error_of_log_b(self, model: GeneralizedMaxwell, arm: int) -> float:
        if not self.parameters:
            return inf
        gradient = np.zeros(len(self.parameters))
        for name, slope in ((f"k_{arm}", 1.0 / model.k[arm - 1]), (f"ln_tau_{arm}", 1.0)):
            if name in self.parameters:
                gradient[self.parameters.index(name)] = slope
        used = gradient != 0.0
        block = self.covariance[np.ix_(used, used)]
        if not np.all(np.isfinite(block)):
            return inf
        return sqrt(max(float(gradient[used] @ block @ gradient[used]), 0.0))


@dataclass(frozen=True, eq=False)
class CreepEstimate(Frozen):
    r"""The compliances behind a solid that was fitted to creep, and how well they are known.

    Attributes
    ----------
    spectrum : CreepSpectrum
        :math:`J(t) = D_g + D_f t + \sum_i D_i (1 - e^{-t/\lambda_i})`, m/N or 1/Pa.
    parameters : tuple of str
        Names of the rows of `covariance`: ``"glass"``, ``"d_1"``..., ``"ln_lam_1"``..., and
        ``"flow"`` if the solid flows.
    covariance : array, shape (p, p)
        Of those parameters, for correlated residuals.
    """

    spectrum: CreepSpectrum
    parameters: tuple[str, ...]
    covariance: FloatArray

    def standard_error(self, name: str) -> float:
        """Standard error of one parameter; of ``"lam_1"`` in s. 0 for one that was not fitted."""
        scale, row = 1.0, name
        if name.startswith("lam_"):
            scale, row = self.spectrum.lam[int(name.removeprefix("lam_")) - 1], f"ln_{name}"
        if row not in self.parameters:
            return 0.0
        at = self.parameters.index(row)
        return scale * sqrt(max(float(self.covariance[at, at]), 0.0))


def profile_interval(profile: Profile, *, deviance_limit: float) -> Interval:
    """Return where the deviance crosses `deviance_limit` for good; an end it never reaches is open.

    The crossing is interpolated on the square root of the deviance, which is straight where the
    likelihood is Gaussian. Beyond a hill there may be another solution that the data do not reject,
    two arms having changed places: the interval reaches there.
    """
    value, root = profile.value, np.sqrt(np.maximum(profile.deviance, 0.0))
    limit = sqrt(deviance_limit)
    best = int(np.argmin(root))
    return (
        _crossing(value[best::-1], root[best::-1], limit, -inf),
        _crossing(value[best:], root[best:], limit, inf),
    )


def _crossing(value: FloatArray, root: FloatArray, limit: float, open_end: float) -> float:
    within = np.flatnonzero(root < limit)
    i = int(within[-1]) + 1 if within.size else 0
    if i == len(root):
        return open_end
    if i == 0:
        return float(value[0])
    share = (limit - root[i - 1]) / (root[i] - root[i - 1])
    return float(value[i - 1] + share * (value[i] - value[i - 1]))


def _exp(value: float) -> float:
    return exp(value) if value < 700.0 else inf
