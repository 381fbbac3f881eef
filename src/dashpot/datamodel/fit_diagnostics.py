"""Diagnostics of a fit: model orders, optimality certificate, alternatives, provenance."""

from __future__ import annotations

import numpy as np

from dashpot.base import dataclass, field
from dashpot.base.checks import Check
from dashpot.base.option_fields import Family
from dashpot.base.provenance import Source, Step
from dashpot.base.reported_values import ReportedValue
from dashpot.base.serialisation import EVERY_FIELD, Serialisable
from dashpot.datamodel.bounds import BandError, EndOfHold
from dashpot.datamodel.parameter_estimate import CreepEstimate
from dashpot.datamodel.specimen import Specimen
from dashpot.solids.fractional import FractionalZener
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid

# Alternative families of solids.


def get_model_family(solid: Solid) -> Family:
    """Return the family of a solid: fractional, or of springs and dashpots."""
    return "fractional" if isinstance(solid, FractionalZener) else "maxwell"


@dataclass(frozen=True)
class Alternative(Serialisable):
    """Best solid of another family, fitted to the same data.

    Attributes
    ----------
    solid : Solid
    bic : float
        Its Bayesian information criterion less that of the selected solid.
    is_sufficient : bool
        The difference of the residuals may be due to chance.
    differs_from_hz : float or None
        Frequency above which the two differ by more than the accuracy of such data, Hz; None if
        they agree wherever a part vibrates.
    message : str
        Predictions of both there, and the test that would distinguish them.
    """

    _keys = (
        "family",
        EVERY_FIELD,
        "is_sufficient",
        "differs_from_hz",
        "message",
    )

    solid: Solid
    bic: float
    is_sufficient: bool
    differs_from_hz: float | None
    message: str

    @property
    def family(self) -> Family:
        """Family of the solid."""
        return get_model_family(self.solid)


# Evidence and provenance of a fit.


@dataclass(frozen=True)
class OrderScore:
    """Score of one candidate number of arms.

    Attributes
    ----------
    arms : int
    sse : float
        Sum of squared residuals.
    bic : float
        Bayesian information criterion with the effective sample size; differences count.
    significant : bool
        Every arm has k > 3 SE and SE(ln tau) < 0.5. Where the noise was as slow as the arms: the
        last arm lowers the deviance by more than chance.
    model : GeneralizedMaxwell
        The best solid with this many arms.
    """

    arms: int
    sse: float
    bic: float
    significant: bool
    model: GeneralizedMaxwell


@dataclass(frozen=True)
class Certificate(Serialisable):
    """Optimality certificate: distance to the best positive model with any number of arms.

    Attributes
    ----------
    optimal : bool
        True if no further arm with k > 0, at any relaxation time, lowers the SSE.
    gap : float
        Relative SSE that the best positive spectrum with any number of arms would still gain.
    tau : float or None
        Where a further arm would gain most, s.
    message : str
        The sentence printed with the fit.
    """

    _keys = (EVERY_FIELD, "message")

    optimal: bool
    gap: float
    tau: float | None
    message: str


@dataclass(frozen=True)
class ParameterChange:
    """Change of one parameter of the solid by a further test.

    Attributes
    ----------
    name : str
        As in ``Fit.parameters``, of the arm's place in the new model: ``"k_1"``, ``"tau_1"``.
    before, before_se : float or None
        Value and standard error without the further test; None for a new arm.
    after, after_se : float
        With it.
    unit : str
    before_most, after_most : float or None
        Upper limit of k_inf, which no test bounds from below and which has no standard error.
    """

    name: str
    before: float | None
    before_se: float | None
    after: float
    after_se: float | None
    unit: str
    before_most: float | None = None
    after_most: float | None = None

    @property
    def was(self) -> ReportedValue | None:
        """Value before, as a table shows it; None for a new arm."""
        if self.before is None:
            return None
        high = np.nan if self.before_most is None else self.before_most
        return ReportedValue(
            self.name, self.before, high=high, unit=self.unit, error=self.before_se
        )

    @property
    def now(self) -> ReportedValue:
        """Value after, as a table shows it."""
        high = np.nan if self.after_most is None else self.after_most
        return ReportedValue(self.name, self.after, high=high, unit=self.unit, error=self.after_se)

    @property
    def shift(self) -> float | None:
        """Change in units of the former standard error; None if there is none."""
        if self.before is None or not self.before_se or not np.isfinite(self.before_se):
            return None
        return (self.after - self.before) / self.before_se


@dataclass(frozen=True)
class Explanation(Serialisable):
    """Explanation of two tests that disagree on one seal.

    Attributes
    ----------
    name : str
        ``"stiffness"``, a factor of the seals under the hammer; ``"k_inf"``, such a factor of
        their stiffness at rest alone; ``"mass"``; ``"gain"`` of acceleration over force; either of
        these two with a stiffness: ``"mass and stiffness"``; or ``"high-pass"`` of one channel.
    value, standard_error : float
        The value that explains both tests.
    unit : str
    relative_deviation : float
        Relative deviation from the stated value; of a high-pass that is not stated, its corner over
        the resonance.
    deviance_fall : float
        Decrease of chi-square.
    is_sufficient : bool
        With this value every other quantity agrees with its prior.
    message : str
        With its value only if it explains both tests best: one quantity has one value.
    """

    _keys = (
        EVERY_FIELD,
        "relative_deviation",
        "deviance_fall",
        "is_sufficient",
        "message",
    )

    name: str
    value: float
    standard_error: float
    unit: str
    relative_deviation: float
    deviance_fall: float
    is_sufficient: bool
    message: str


@dataclass(frozen=True)
class DepthStiffness:
    """Stiffnesses of one test of several that share their relaxation times.

    Attributes
    ----------
    depth : float
        Compression held, m.
    k_inf, k_inf_most : float
        Secant equilibrium stiffness at this depth, N/m, and its upper 95 % limit.
    k, k_se : tuple of float
        Arm stiffnesses at this depth, N/m, in the order of the model's arms.
    """

    depth: float
    k_inf: float
    k_inf_most: float
    k: tuple[float, ...]
    k_se: tuple[float, ...]

    def list_values(self, unit: str) -> tuple[ReportedValue, ...]:
        """Each stiffness with its error; an arm of zero stiffness belongs to other depths."""
        equilibrium_value = ReportedValue("k_inf", self.k_inf, high=self.k_inf_most, unit=unit)
        names = (f"k_{j}" for j in range(1, len(self.k) + 1))
        pairs = zip(names, self.k, self.k_se, strict=True)
        return equilibrium_value, *(
            ReportedValue(name, value, unit=unit, error=error) for name, value, error in pairs
        )


@dataclass(frozen=True)
class Evidence:
    """Evidence for a fit: scores of the model orders, checks, and undetermined quantities.

    Attributes
    ----------
    band : (float, float)
        The valid band: the frequencies at which the test determines the model, Hz.
    orders : tuple of OrderScore
        The numbers of arms that were tried.
    certificate : Certificate or None
    checks : tuple of Check
    stiffness_by_depth : tuple of DepthStiffness
        One per test where each has its own stiffnesses (``fit_depths``), shallowest
        first; the fit's solid is then the deepest test's.
    parameter_changes : tuple of ParameterChange
        Changes of an earlier fit's parameters by a further test.
    explanations : tuple of Explanation
        Explanations of two tests that disagree, the best first.
    end_of_hold : EndOfHold or None
        Limits of the stiffness at the end of the test, and of the equilibrium stiffness.
    creep : CreepEstimate or None
        The compliances and retardation times that were fitted to a creep test.
    alternative : Alternative or None
        The best solid of the other family, if both were fitted.
    band_error : BandError or None
        How well stiffness and loss factor are known in the band, over all spectra that the test
        does not reject; None where that was not asked.
    """

    band: tuple[float, float]
    orders: tuple[OrderScore, ...] = ()
    certificate: Certificate | None = None
    checks: tuple[Check, ...] = ()
    stiffness_by_depth: tuple[DepthStiffness, ...] = ()
    parameter_changes: tuple[ParameterChange, ...] = ()
    explanations: tuple[Explanation, ...] = ()
    end_of_hold: EndOfHold | None = None
    creep: CreepEstimate | None = None
    alternative: Alternative | None = None
    band_error: BandError | None = None

    @property
    def has_unexplained_discrepancy(self) -> bool:
        """Whether tests disagree and not even the best explanation suffices."""
        return any(not explanation.is_sufficient for explanation in self.explanations[:1])


@dataclass(frozen=True)
class Provenance:
    """Provenance of a fit: method, files, steps and specimen.

    Attributes
    ----------
    method : str
        ``"full"``, ``"hold"``, ``"frf"``, ``"joint"``, ``"dynamic"``, ``"modulus"``,
        ``"creep"`` or ``"cld"``.
    source : tuple of Source
    steps : tuple of Step
        Everything done since the raw file, with its parameters.
    specimen : Specimen
    """

    method: str
    source: tuple[Source, ...] = ()
    steps: tuple[Step, ...] = ()
    specimen: Specimen = field(default_factory=Specimen)
