"""What a fit says: the solid, how well it is known, and what it must not be asked."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import TYPE_CHECKING, TypedDict

import numpy as np

from dashpot._arrays import ByValue, FloatArray, frozen
from dashpot.checks import Check
from dashpot.errors import DataError
from dashpot.provenance import Source, Step
from dashpot.relaxation.records import Specimen
from dashpot.solids.maxwell import GeneralizedMaxwell

if TYPE_CHECKING:
    from dashpot.relaxation.intervals import Estimates

Interval = tuple[float, float]


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


class Status(Enum):
    """How a fit ended; the name is for programs, the value for people."""

    CONVERGED = "the optimum was found and every parameter is inside the measured window"
    FEWER_ARMS = "fewer arms than asked for: the data reject a further arm with k > 0"
    TAU_AT_BOUND = "a relaxation time sits at the edge of the measured window"
    NOT_IDENTIFIED = "the data do not determine every parameter"
    NOT_CONVERGED = "the iteration limit was reached before the gradient vanished"
    FORCE_RISES = "the force rises during the hold: no relaxing solid does that"
    NO_DATA = "the record holds values that are not finite: nothing was fitted"


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
        Bayesian information criterion with the effective sample size; differences count.
    significant : bool
        Every arm has k > 3 SE and SE(ln tau) < 0.5. Where the noise was as slow as the arms:
        chance does not explain what the last arm takes off the deviance.
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
        Name as in ``Fit.parameters``, for example ``"ln_tau_2"``; ``"ln_b_2"`` for b = k tau.
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


@dataclass(frozen=True)
class Moved:
    """What a further test did to one parameter of the solid.

    Attributes
    ----------
    name : str
        As in ``Fit.parameters``, of the arm's place in the new model: ``"k_1"``, ``"tau_1"``.
    before, before_se : float or None
        Value and standard error without the further test; None for a new arm.
    after, after_se : float
        With it.
    unit : str
    """

    name: str
    before: float | None
    before_se: float | None
    after: float
    after_se: float
    unit: str


@dataclass(frozen=True)
class AtDepth:
    """The stiffnesses of one test of several that share their relaxation times.

    Attributes
    ----------
    depth : float
        Compression held, m.
    k_inf, k_inf_se : float
        Secant equilibrium stiffness at this depth, N/m, and its standard error.
    k, k_se : tuple of float
        Arm stiffnesses at this depth, N/m, in the order of the model's arms.
    """

    depth: float
    k_inf: float
    k_inf_se: float
    k: tuple[float, ...]
    k_se: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Fit(ByValue):
    """A fitted solid, how well each parameter is known, and what the test cannot tell.

    Attributes
    ----------
    model : GeneralizedMaxwell
    status : Status
    method : str
        ``"full"``, ``"hold"``, ``"frf"``, ``"joint"``, ``"dynamic"`` or ``"modulus"``.
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
    by_depth : tuple of AtDepth
        One per test where each test has its own stiffnesses (``depth_law=True``), shallowest
        first; `model` is then the deepest test's.
    moved : tuple of Moved
        What a further test changed, where there was an earlier fit.
    unit : str
        Of every stiffness: ``"N/m"`` for a part, ``"Pa"`` where a material's modulus was fitted.
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
    by_depth: tuple[AtDepth, ...] = ()
    specimen: Specimen = field(default_factory=Specimen)
    moved: tuple[Moved, ...] = ()
    unit: str = "N/m"

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
        """True if the fit converged; what it must not be asked stands in `checks`."""
        return self.status is Status.CONVERGED

    def in_parallel(self, count: float) -> Fit:
        """The fit of `count` such parts side by side: stiffnesses, errors and length scale alike.

        What belongs to the fitted record alone (orders, certificate, nuisances) stays behind.
        """
        scale = np.array([1.0 if name.startswith("ln_") else count for name in self.parameters])
        length = None if self.specimen.length is None else count * self.specimen.length
        step = Step(
            "parallel",
            (("count", f"{count:g}"), ("of", self.identity)),
            f"{count:g} in parallel of fit {self.identity}",
        )
        return replace(
            self,
            model=count * self.model,
            covariance=self.covariance * np.outer(scale, scale),
            profiles=tuple(one for one in self.profiles if one.parameter.startswith("ln_tau")),
            specimen=replace(self.specimen, length=length),
            steps=(*self.steps, step),
            orders=(),
            certificate=None,
            nuisance=(),
            by_depth=(),
            moved=(),
        )

    @property
    def identity(self) -> str:
        """Sixteen hexadecimal digits that name this result: of its solid, method and raw files.

        Decks and reports carry it, so that each can be traced to the fit it came from.
        """
        model = self.model
        stands_for = (
            (model.k_inf, model.k, model.tau, model.b),
            self.method,
            tuple(source.sha256 for source in self.source),
        )
        return hashlib.sha256(repr(stands_for).encode()).hexdigest()[:16]

    @property
    def standard_error(self) -> StandardErrors:
        """Standard errors of k_inf, and of k, tau and b = k tau of each arm, SI units."""
        from dashpot.relaxation.intervals import standard_errors

        errors = standard_errors(self._estimates())
        return StandardErrors(k_inf=errors.k_inf, k=errors.k, tau=errors.tau, b=errors.b)

    def intervals(self, level: float = 0.95) -> Intervals:
        """Confidence intervals at `level`, SI units: Student's, or the profile's where stored.

        An end that the data leave open is 0 or infinite.

        Raises
        ------
        DataError
            If `level` is not between 0 and 1.
        """
        from dashpot.relaxation.intervals import intervals

        if not 0.0 < level < 1.0:
            raise DataError(f"level = {level!r}; expected a coverage between 0 and 1, such as 0.95")
        profiles = {p.parameter: (p.value, p.deviance) for p in self.profiles}
        bounds = intervals(self._estimates(), profiles, level=level)
        return Intervals(k_inf=bounds.k_inf, k=bounds.k, tau=bounds.tau, b=bounds.b)

    def _estimates(self) -> Estimates:
        from dashpot.relaxation.intervals import Estimates

        model = self.model
        return Estimates(
            model.k_inf, model.k, model.tau, self.parameters, self.covariance, self.dof
        )
