"""What a fit says: the solid, how well it is known, and what it must not be asked."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import TypedDict

import numpy as np

from dashpot._arrays import ByValue, FloatArray, frozen
from dashpot.checks import Check
from dashpot.errors import DataError
from dashpot.provenance import Source, Step
from dashpot.solids.maxwell import GeneralizedMaxwell

Interval = tuple[float, float]


class Intervals(TypedDict):
    """Confidence intervals in SI units, one per parameter of the model."""

    k_inf: Interval
    k: tuple[Interval, ...]
    tau: tuple[Interval, ...]
    b: tuple[Interval, ...]


class Status(Enum):
    """How a fit ended; the name is for programs, the value for people."""

    CONVERGED = "the optimum was found and every parameter is inside the measured window"
    FEWER_ARMS = "fewer arms than asked for: the data reject a further arm with k > 0"
    TAU_AT_BOUND = "a relaxation time sits at the edge of the measured window"
    NOT_IDENTIFIED = "the data do not determine every parameter"
    NOT_CONVERGED = "the iteration limit was reached before the gradient vanished"
    FORCE_RISES = "the force rises during the hold: no relaxing solid does that"


@dataclass(frozen=True)
class Residual:
    """Statistics of what the model leaves unexplained.

    Attributes
    ----------
    n : int
        Samples fitted.
    sse : float
        Sum of squared residuals, N^2 (dimensionless when weighted).
    rms : float
        Root mean square residual, N.
    kappa : float
        n / effective n: how many neighbouring residuals say the same thing (1 if white).
    durbin_watson : float
        About 2 for white residuals, towards 0 for correlated ones.
    """

    n: int
    sse: float
    rms: float
    kappa: float = 1.0
    durbin_watson: float = 2.0


@dataclass(frozen=True)
class OrderScore:
    """One candidate number of arms.

    Attributes
    ----------
    arms : int
    sse : float
        Sum of squared residuals.
    bic : float
        Bayesian information criterion with the effective sample size.
    significant : bool
        Every arm has k > 3 SE and SE(ln tau) < 0.5.
    model : GeneralizedMaxwell
        The best solid with this many arms.
    """

    arms: int
    sse: float
    bic: float
    significant: bool
    model: GeneralizedMaxwell


@dataclass(frozen=True)
class Certificate:
    """How far the optimum can be from the best positive model with any number of arms.

    Attributes
    ----------
    optimal : bool
        True if no further arm with k > 0, at any relaxation time, lowers the SSE.
    gap : float
        Relative SSE that the best positive spectrum with any number of arms would still gain.
    tau : float or None
        Where a further arm would gain most, s.
    says : str
        The sentence printed with the fit.
    """

    optimal: bool
    gap: float
    tau: float | None
    says: str


@dataclass(frozen=True, eq=False)
class Profile(ByValue):
    """Profile likelihood of one parameter: deviance against its value.

    Attributes
    ----------
    parameter : str
        Name as in ``Fit.parameters``, for example ``"ln_tau_2"``.
    value, deviance : array, shape (m,)
        Trial values, ascending, and ``(SSE(value) - SSE_min) / (kappa * s^2)``: compared
        with the chi-square or F quantile of one degree of freedom.
    """

    parameter: str
    value: FloatArray
    deviance: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "value", frozen(np.asarray(self.value, dtype=float)))
        object.__setattr__(self, "deviance", frozen(np.asarray(self.deviance, dtype=float)))


@dataclass(frozen=True)
class Nuisance:
    """A parameter the fit needed and the user did not ask for: tare, drift, gain, delay, mass."""

    name: str
    value: float
    standard_error: float
    unit: str


@dataclass(frozen=True, eq=False)
class Fit(ByValue):
    """A fitted solid, how well each parameter is known, and what the test cannot tell.

    Attributes
    ----------
    model : GeneralizedMaxwell
    status : Status
    method : str
        ``"full"``, ``"hold"``, ``"frf"`` or ``"joint"``.
    residual : Residual
    parameters : tuple of str
        Names of the rows of `covariance`: ``"k_inf"``, ``"k_1"``..., ``"ln_tau_1"``...,
        and ``"b"`` if it was fitted. Stiffness in N/m, ln of tau in s.
    covariance : array, shape (p, p)
        Of those parameters, for correlated residuals. Infinite where not identified.
    dof : float
        Degrees of freedom of the t quantile: effective samples less parameters.
    band : (float, float)
        The frequencies this test can inform, Hz.
    orders : tuple of OrderScore
        The numbers of arms that were tried.
    certificate : Certificate or None
    profiles : tuple of Profile
        Where the covariance is no good guide to an interval.
    nuisance : tuple of Nuisance
    checks : tuple of Check
    source : tuple of Source
    steps : tuple of Step
        Everything done since the raw file, with its parameters.
    """

    model: GeneralizedMaxwell
    status: Status
    method: str
    residual: Residual
    parameters: tuple[str, ...]
    covariance: FloatArray
    dof: float
    band: tuple[float, float]
    orders: tuple[OrderScore, ...] = ()
    certificate: Certificate | None = None
    profiles: tuple[Profile, ...] = ()
    nuisance: tuple[Nuisance, ...] = ()
    checks: tuple[Check, ...] = field(default_factory=tuple)
    source: tuple[Source, ...] = ()
    steps: tuple[Step, ...] = ()

    def __post_init__(self) -> None:
        covariance = np.asarray(self.covariance, dtype=float)
        size = len(self.parameters)
        if covariance.shape != (size, size):
            raise DataError(
                f"covariance has shape {covariance.shape}, expected {(size, size)}: "
                "one row per parameter"
            )
        object.__setattr__(self, "covariance", frozen(covariance))

    @property
    def ok(self) -> bool:
        """True if the fit converged and every check passed."""
        return self.status is Status.CONVERGED and all(check.passed for check in self.checks)
