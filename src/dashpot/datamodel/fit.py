"""Result of a fit: the solid, its uncertainty, and its limits of use."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, TypeVar

import numpy as np

from dashpot.base.arrays import EqualByValue, FloatArray
from dashpot.base.checks import Check, Verdict, verdict
from dashpot.base.errors import DataError, Status
from dashpot.base.number_format import format_band, format_count
from dashpot.base.option_fields import Family, Method, PartMode, get_choice_values
from dashpot.base.plain_text import sentence
from dashpot.base.provenance import Source, Step
from dashpot.base.reported_values import NORMAL, ReportedValue
from dashpot.base.result_mixins import Plottable
from dashpot.base.serialisation import Serialisable
from dashpot.base.units import Quantity, celsius, convert_to_si, format_quantity
from dashpot.base.value_ranges import require_positive
from dashpot.datamodel.bounds import EndOfHold, StiffnessLimits
from dashpot.datamodel.fit_diagnostics import (
    Alternative,
    Certificate,
    DepthStiffness,
    Evidence,
    Explanation,
    OrderScore,
    ParameterChange,
    Provenance,
    family_of,
)
from dashpot.datamodel.parameter_estimate import (
    SHAPE,
    CreepEstimate,
    Interval,
    Intervals,
    Nuisance,
    ParameterEstimate,
    Profile,
    Residual,
    StandardErrors,
)
from dashpot.datamodel.shift_factors import CONTRADICT, SAME_TEMPERATURE, Shift, TemperatureShifts
from dashpot.datamodel.specimen import Specimen
from dashpot.numerics.inference.model_order import is_well_determined
from dashpot.solids.elastic import ElasticLaw, require_plausible_compression
from dashpot.solids.fractional import FractionalZener
from dashpot.solids.maxwell import GeneralizedMaxwell, MaxwellArm, Solid
from dashpot.solids.part_geometry import Geometry, named_shape
from dashpot.solids.shift_laws import TemperatureLaw

_One = TypeVar("_One")
# of frequencies: stiffness and loss factor change slowly over a decade
LINES_IN_BAND = 9


@dataclass(frozen=True, eq=False, repr=False)
class Fit(EqualByValue, Plottable, Serialisable):
    """Fitted solid, with the uncertainty of each parameter and the limits of the test.

    Attributes
    ----------
    solid : Solid
    status : Status
    estimate : ParameterEstimate
        Of the parameters of `solid`.
    evidence : Evidence
    provenance : Provenance
    unit : str
        Of every stiffness: ``"N/m"`` for a part, ``"Pa"`` where a material's modulus was fitted.
    elastic_law : ElasticLaw or None
        Relaxed force against compression, where a part was pressed; `solid` is the secant one at
        its depth.
    temperatures : TemperatureShifts or None
        How the solid moves with temperature, where tests at several were fitted; `solid` is that
        of their reference.

    Examples
    --------
    >>> import dashpot as dp
    >>> fit = dp.fit(dp.simulate("relaxation", hold="5s", noise_free=True), arms=2)
    >>> fit.model.arms, sorted(fit.intervals(level=0.95))
    (2, ['b', 'k', 'k_inf', 'tau'])
    """

    schema = "dashpot/fit@2"
    keys = (
        "id=identity", "status", "ok", "message=status.value", "verdict", "model",
        "solid=own_solid~",
        "standard_error=errors_by_arm~", "interval_95=intervals_95~", "estimate.residual",
        "band_hz=evidence.band", "elastic_law", "end_of_hold_limits=evidence.end_of_hold",
        "error_in_band=evidence.band_error?",
        "temperature=temperatures", "mass=mass_found?", "evidence.creep?", "provenance.method",
        "estimate.parameters", "estimate.covariance", "noise_covariance=estimate.of_noise?",
        "estimate.dof",
        "evidence.orders", "evidence.certificate", "estimate.profiles", "estimate.nuisance",
        "evidence.checks", "provenance.source", "provenance.steps", "evidence.by_depth",
        "provenance.specimen", "parameter_changes=evidence.moved", "evidence.explanations",
        "evidence.alternative",
        "unit",
    )  # fmt: skip

    solid: Solid
    status: Status
    estimate: ParameterEstimate
    evidence: Evidence
    provenance: Provenance
    unit: str = "N/m"
    elastic_law: ElasticLaw | None = None
    temperatures: TemperatureShifts | None = None

    @property
    def digested(self) -> bool:
        """Whether the document ends with a digest, which shows an edit."""
        return True

    @property
    def ok(self) -> bool:
        """True if the optimum was found and the verdict is not "do not use"."""
        return self.status is Status.CONVERGED and self.verdict.use != "do not use"

    @property
    def model(self) -> GeneralizedMaxwell:
        """The arms of the solid."""
        return self.solid.maxwell

    @property
    def few_arms(self) -> GeneralizedMaxwell:
        """The fewest arms that stand for the data: of a fractional solid, those of its alternative.

        They weigh a record as well as the many that stand for the solid itself.
        """
        other = self.alternative
        if self.family == "maxwell" or other is None or other.family != "maxwell":
            return self.model
        return other.solid.maxwell

    @property
    def called(self) -> str:
        """The solid in few words: how many arms it has, or its family."""
        return (
            "fractional model"
            if self.family == "fractional"
            else format_count(self.model.arms, "arm")
        )

    @property
    def family(self) -> Family:
        """Family of the solid: ``"maxwell"`` or ``"fractional"``."""
        return family_of(self.solid)

    @property
    def verdict(self) -> Verdict:
        """Verdict on the fit, by the gravest check that failed."""
        return verdict(self.checks, headline=self.sound)

    @property
    def sound(self) -> str:
        """Errors of stiffness and loss factor in the band, as text; empty without a band."""
        if not self.band[1] > 0:
            return ""
        within = format_band(self.band)
        text = "Outside this band the model is an extrapolation."
        if self.unit == "N/m" and self.method in get_choice_values(Method):
            # no ramp and hold tells a flow that grows as a power of its force from arms
            text = "Outside this band a linear seal is assumed: add a hammer test."
        if self.method == "full" and 1 < len(self.shifts) < CONTRADICT:
            text = "Test at a third temperature: two cannot show arms that shift apart."
        stiffness, loss_factor = self.error_in_band
        if not (np.isfinite(stiffness) and stiffness < 1):
            return f"{sentence(within)} {text}"
        of = "modulus" if self.unit == "Pa" else "stiffness"
        how = f"{within} the {of} is known to ±{100 * stiffness:.2g} %"
        if np.isfinite(loss_factor) and loss_factor < 1:
            how += f", the loss factor to ±{100 * loss_factor:.2g} %"
        return f"{sentence(how)} {text}"

    @property
    def error_in_band(self) -> tuple[float, float]:
        r"""Largest 95 % error of stiffness and of loss factor in the band, each over its value.

        Of :math:`|K^*|` and :math:`\eta = K''/K'`, over every spectrum that the test does not
        reject, and no less than what the fit misses of the record's own lines
        (``records.band_error.BandError``). Where that was not asked, by the
        covariance of the arms, and by the limits at the end of the hold where they are wider;
        infinite where none is known.
        """
        if self.evidence.band_error is not None:
            return self.evidence.band_error.largest
        low, high = self.band
        if not (0 < high < np.inf):
            return np.inf, np.inf
        lines = np.geomspace(low or 1e-3 * high, high, LINES_IN_BAND)
        s = np.asarray(2j * np.pi * lines, dtype=complex)
        stiffness, loss_factor = (
            NORMAL * error for error in self._arm_estimate.errors_of_vibration(self.model, s)
        )
        end = self.end_of_hold
        if end is not None and np.isfinite(end.k_end[1]):
            # its limits hold for every rig that may have made the test, the covariance for one
            wide = (end.k_end[1] - end.k_end[0]) / 2
            held = end.of(self.model)
            stiffness = max(stiffness, wide / held) if held > 0 else np.inf
        return stiffness, loss_factor

    def model_at(self, compression: Quantity, *, secant: bool = False) -> GeneralizedMaxwell:
        """Return the solid that small vibration about a compression, m, feels: its tangent.

        Parameters
        ----------
        compression : float
            m.
        secant : bool
            The linear solid that gives the relaxed force there instead.

        Raises
        ------
        DataError
            If the compression is not a number > 0.
        """
        compression = convert_to_si(compression, "length")
        require_positive(compression=compression, unit=" m")
        law = self.elastic_law
        if law is None or law.kind == "linear":
            return self.model
        if secant:
            return self.model * float(law.path(compression) / compression)
        return self.model * float(law.factor(compression))

    # -- at other temperatures ----------------------------------------------------------------

    @property
    def temperature_law(self) -> TemperatureLaw | None:
        """Shift factor of time against temperature; None where one temperature was tested."""
        return None if self.temperatures is None else self.temperatures.law

    @property
    def shifts(self) -> tuple[Shift, ...]:
        """Shift factors of each tested temperature against the reference."""
        return () if self.temperatures is None else self.temperatures.shifts

    @property
    def error_beside(self) -> str:
        """Label of the errors of shifts and of their law.

        Rigs may have done more than they hold.
        """
        return "± SE" if self.estimate.of_noise is None else "± noise"

    def at(self, temperature: Quantity) -> GeneralizedMaxwell:
        r"""The solid at another temperature: relaxation times times a_T, stiffnesses times b_T.

        Parameters
        ----------
        temperature : float
            K, or a text such as ``"-20degC"``.

        Raises
        ------
        DataError
            If the fit is of one temperature and this is another, if it is less than 10 K above
            the glass transition that a WLF law implies, or where the law says nothing.
        """
        kelvin = convert_to_si(temperature, "temperature")
        require_positive(temperature=kelvin, unit=" K")
        if self.temperatures is not None:
            return self.temperatures.shifted(self.model, kelvin)
        tested = self.specimen.temperature
        if tested is not None and abs(kelvin - tested) <= SAME_TEMPERATURE:
            return self.model
        name = "a temperature that nobody noted" if tested is None else celsius(tested)
        raise DataError(
            f"the fit is of tests at {name}, and nothing says how the solid moves to "
            f"{celsius(kelvin)}: fit tests at several temperatures together"
        )

    def at_temperature(self, temperature: Quantity) -> Fit:
        """Return the fit as it is at another temperature, K: solid, errors, band, elastic law.

        Raises
        ------
        DataError
            As :meth:`at`.
        """
        kelvin = convert_to_si(temperature, "temperature")
        solid, shifts = self.at(kelvin), self.temperatures
        if shifts is None or kelvin == shifts.reference:
            return self
        a_t, b_t = float(shifts.law.a_t(kelvin)), shifts.b_t(kelvin)
        step = Step(
            "temperature",
            (("temperature_K", repr(kelvin)), ("of", self.identity)),
            f"at {celsius(kelvin)}, a_T = {a_t:.5g} and b_T = {b_t:.5g} times fit {self.identity}",
        )
        scaled = self._scale_stiffness(b_t, step)

        def convert_covariance(covariance: FloatArray) -> FloatArray:
            return shifts.covariance_at(kelvin, self.parameters, covariance, self.model)

        of_noise = self.estimate.of_noise
        # what a test adds to the force of the solid it adds at any temperature
        estimate = replace(
            scaled.estimate,
            covariance=convert_covariance(self.covariance),
            of_noise=None if of_noise is None else convert_covariance(of_noise),
            profiles=(),
            nuisance=self.nuisance,
        )
        (low, high), error = self.band, self.evidence.band_error
        return replace(
            scaled,
            solid=solid,
            estimate=estimate,
            evidence=replace(
                scaled.evidence,
                band=(low / a_t, high / a_t),
                end_of_hold=self._end_at(kelvin, scaled.end_of_hold, a_t),
                band_error=error and error.shifted(a_t),
            ),
            provenance=replace(
                scaled.provenance, specimen=replace(self.specimen, temperature=kelvin)
            ),
            temperatures=shifts.referred(kelvin),
        )

    def _end_at(self, kelvin: float, end: EndOfHold | None, a_t: float) -> EndOfHold | None:
        """Return limits at the end of the test as they are at another temperature, K.

        They are of a time that is a_T as long. What shifts and their law add to the errors of the
        stiffness there widens them.
        """
        if end is None or self.temperatures is None:
            return None
        s = np.array([1j / end.time], dtype=complex)
        here = self._arm_estimate
        there = replace(
            here,
            covariance=self.temperatures.covariance_at(
                kelvin, here.parameters, here.covariance, self.model
            ),
        )
        before, after = (
            estimate.errors_of_vibration(model, at)[0]
            for estimate, model, at in (
                (here, self.model, s), (there, self.at(kelvin), np.asarray(s / a_t, dtype=complex))
            )
        )  # fmt: skip
        if not np.isfinite(after):
            return None
        more = NORMAL * float(np.sqrt(max(after**2 - before**2, 0.0)))
        return replace(end.widened(more), time=a_t * end.time)

    # -- how well it is known -----------------------------------------------------------------

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the rows of `covariance`."""
        return self.estimate.parameters

    @property
    def covariance(self) -> FloatArray:
        """Covariance of the parameters, shape (p, p): of the noise and of what rigs may add."""
        return self.estimate.covariance

    @property
    def dof(self) -> float:
        """Degrees of freedom, which are the effective samples less the parameters."""
        return self.estimate.dof

    @property
    def residual(self) -> Residual:
        """Statistics of what the model leaves unexplained."""
        return self.estimate.residual

    @property
    def profiles(self) -> tuple[Profile, ...]:
        """Profile likelihoods, where the covariance is no good guide."""
        return self.estimate.profiles

    @property
    def nuisance(self) -> tuple[Nuisance, ...]:
        """Parameters that the fit needed and nobody asked for."""
        return self.estimate.nuisance

    @property
    def unplaced(self) -> tuple[float, ...]:
        """Relaxation times, s, of the arms that the data ask for and cannot place.

        Such an arm corrects the others: its own k or tau is hardly known. None are listed of a fit
        whose parameters are identified.
        """
        arms = self.model.arms
        if self.status is not Status.NOT_IDENTIFIED or len(self.parameters) < 1 + 2 * arms:
            return ()
        error = np.sqrt(np.diag(self.estimate.noise_alone.covariance))
        certain = is_well_determined(
            np.array(self.model.k), error[1 : 1 + arms], error[1 + arms : 1 + 2 * arms]
        )
        return tuple(tau for tau, sure in zip(self.model.tau, certain, strict=True) if not sure)

    @property
    def k_inf_given(self) -> bool:
        """Whether k_inf was given and not fitted: then it is known as it was given."""
        return bool(self.parameters) and "k_inf" not in self.parameters

    @property
    def standard_error(self) -> StandardErrors:
        """Standard errors of k_inf, and of k, tau and b = k tau of each arm, SI units.

        No test bounds k_inf from below, so it has no standard error (nan) but where it was given:
        :meth:`intervals` has what it is at most. Of a fractional solid, those of the arms that
        stand for it follow from its own four. Of relaxation tests they hold what their rigs may
        have done unseen; without it they are those of `estimate.noise_alone`.
        """
        errors = self._arm_estimate.standard_errors(self.model)
        return {**errors, "k_inf": self._without_error(errors["k_inf"])}

    def _without_error(self, error: float) -> float:
        """The standard error of k_inf: none (nan), unless given or wholly unknown (infinite)."""
        return error if self.k_inf_given or not np.isfinite(error) else np.nan

    def intervals(self, level: float = 0.95) -> Intervals:
        """Confidence intervals at `level`, SI units: Student's, or the profile's where stored.

        An end that the data leave open is 0 or infinite. No test bounds k_inf from below: it is at
        most the upper end of `left_open`, or of its own interval where nothing was left open. The
        end of `left_open` is computed at 95 %, and at another level its distance from the fit is
        in the ratio of Student's quantiles.

        Raises
        ------
        DataError
            If `level` is not between 0 and 1.
        """
        intervals = self._arm_estimate.intervals(self.model, level)
        return {**intervals, "k_inf": self._k_inf_between(intervals["k_inf"], level)}

    def _k_inf_between(self, formal: Interval, level: float) -> Interval:
        """The interval of k_inf: from 0 to what a test leaves of it, or to its own upper end."""
        if self.k_inf_given:
            return formal
        end = self.end_of_hold
        if end is None:
            return 0.0, formal[1]
        most = replace(self.estimate, dof=max(self.dof, 1.0))
        reach = most.quantile(level) / most.quantile(0.95)
        return 0.0, self.model.k_inf + reach * (end.k_inf[1] - self.model.k_inf)

    @property
    def solid_standard_error(self) -> dict[str, float]:
        """Standard errors of the solid's own parameters by their names, SI units.

        ``k_inf``, ``k_0``, ``tau`` and ``alpha`` of a fractional solid; ``k_inf``, ``k_1``,
        ``tau_1``... of one with arms. That of k_inf is nan, as in :attr:`standard_error`.
        """
        dashpots = _drop_dashpots(self.estimate.errors(self.solid))
        return (
            {**dashpots, "k_inf": self._without_error(dashpots["k_inf"])}
            if "k_inf" in dashpots
            else dashpots
        )

    def solid_intervals(self, level: float = 0.95) -> dict[str, Interval]:
        """Confidence intervals at `level` of the solid's own parameters by their names, SI units.

        The names are those of `solid_standard_error`.

        Raises
        ------
        DataError
            If `level` is not between 0 and 1.
        """
        entries = self.estimate.ends(self.solid, level)
        return _drop_dashpots({**entries, "k_inf": self._k_inf_between(entries["k_inf"], level)})

    @property
    def facts(self) -> tuple[ReportedValue, ...]:
        """Every parameter of the solid with its standard error and 95 % interval.

        No test bounds k_inf from below: it is at most so much, and has no error.
        """
        return self._replace_open_k_inf(self.estimate.facts(self.solid, self.unit))

    @property
    def arm_facts(self) -> tuple[ReportedValue, ...]:
        """The same of the arms: those that stand for a fractional solid, not its own four."""
        return self._replace_open_k_inf(self._arm_estimate.facts(self.model, self.unit))

    def _replace_open_k_inf(self, facts: tuple[ReportedValue, ...]) -> tuple[ReportedValue, ...]:
        """Facts with what a test leaves of k_inf: what it is at most."""
        return tuple(self._k_inf_at_most(fact) if fact.name == "k_inf" else fact for fact in facts)

    def _k_inf_at_most(self, formal: ReportedValue) -> ReportedValue:
        """k_inf as every table has it, from its formal interval: what it is at most."""
        end = self.end_of_hold
        high = formal.high if end is None else end.k_inf[1]
        if self.k_inf_given or not np.isfinite(high):
            return formal
        below = "" if end is None or end.ended != "frf" else "stiffness below the band"
        return replace(formal, low=np.nan, high=high, error=None, words=below)

    @property
    def known(self) -> tuple[ReportedValue, ...]:
        """Rows of the solid's parameters, the same in all tables.

        The stiffness at the end of the hold, then every parameter; of a spectrum, whose single
        arms mean nothing, its ends.
        """
        facts, model, end = self.facts, self.model, self.end_of_hold
        if not self.parameters:
            ends = [("k_inf", model.k_inf, self.unit), ("k_0", model.k_0, self.unit)]
            if model.arms:
                ends += [("tau from", model.tau[0], "s"), ("tau to", model.tau[-1], "s")]
            facts = self._replace_open_k_inf(
                tuple(ReportedValue(name, value, unit=of, error=np.inf) for name, value, of in ends)
            )
        return facts if end is None else (end.fact(model, self.unit), *facts)

    @property
    def intervals_95(self) -> Intervals:
        """95 % intervals, as :meth:`intervals`."""
        return self.intervals(level=0.95)

    @property
    def errors_by_arm(self) -> dict[str, Any]:
        """Standard errors laid out as the document of a model is, as `facts` tell them."""
        error, k_inf = self.standard_error, self.arm_facts[0]
        arms = zip(error["k"], error["tau"], error["b"], strict=True)
        return {"k_inf": k_inf.error, "arms": tuple(MaxwellArm(*arm) for arm in arms)}

    @property
    def own_solid(self) -> dict[str, Any]:
        """The family of the solid; of another than arms its parameters and how they are known."""
        if self.family == "maxwell":
            return {"family": self.family}
        return {
            "family": self.family,
            **{field.name: getattr(self.solid, field.name) for field in fields(self.solid)},  # type: ignore[arg-type]
            "standard_error": {fact.name: fact.error for fact in self.facts},
            "interval_95": self.solid_intervals(level=0.95),
        }

    @property
    def also_fitted(self) -> tuple[Nuisance, ...]:
        """The nuisances that anything may be said of: none where nothing explains two tests."""
        lost = any(not explanation.explains for explanation in self.explanations[:1])
        return () if lost else self.nuisance

    @property
    def mass_found(self) -> float | None:
        """The mass that was fitted too, kg."""
        return next(
            (nuisance.value for nuisance in self.also_fitted if nuisance.name == "mass"), None
        )

    @property
    def under_hammer(self) -> float:
        """Stiffness of a seal under the hammer over its own, where that explains two tests."""
        bent = self.elastic_law is not None and self.elastic_law.kind != "linear"
        if bent or not any(explanation.explains for explanation in self.explanations[:1]):
            return 1.0
        return next(
            (nuisance.value for nuisance in self.nuisance if nuisance.name == "stiffness_factor"),
            1.0,
        )

    @property
    def _arm_estimate(self) -> ParameterEstimate:
        """What is known of the arms of the solid."""
        if isinstance(self.solid, FractionalZener) and self.parameters:
            return self.estimate.of_arms(self.solid)
        return self.estimate

    # -- what the data support ----------------------------------------------------------------

    @property
    def band(self) -> tuple[float, float]:
        """The frequencies this test can inform, Hz."""
        return self.evidence.band

    @property
    def orders(self) -> tuple[OrderScore, ...]:
        """The numbers of arms that were tried."""
        return self.evidence.orders

    @property
    def certificate(self) -> Certificate | None:
        """Certificate: distance to the best positive model with any number of arms."""
        return self.evidence.certificate

    @property
    def checks(self) -> tuple[Check, ...]:
        """Every check put to the records and to the fit."""
        return self.evidence.checks

    @property
    def by_depth(self) -> tuple[DepthStiffness, ...]:
        """The stiffnesses of each test, where each has its own."""
        return self.evidence.by_depth

    @property
    def moved(self) -> tuple[ParameterChange, ...]:
        """Changes of the parameters by a further test."""
        return self.evidence.moved

    @property
    def explanations(self) -> tuple[Explanation, ...]:
        """Explanations of two tests that disagree, the best first."""
        return self.evidence.explanations

    @property
    def alternative(self) -> Alternative | None:
        """The best solid of the other family; None where one family alone was fitted."""
        return self.evidence.alternative

    @property
    def end_of_hold(self) -> EndOfHold | None:
        """Stiffness at the end of the tests; None without a hold."""
        return self.evidence.end_of_hold

    @property
    def creep(self) -> CreepEstimate | None:
        """The compliances and retardation times fitted to a creep test; None without one."""
        return self.evidence.creep

    @property
    def left_open(self) -> StiffnessLimits | None:
        r"""Between which limits tests leave k_inf, k(T) and k(3 T), in `unit`.

        T is the time that the seal was held, from the end of the ramp,
        :math:`k(t) = k_\infty + \sum_j k_j e^{-t/\tau_j}`, and the limits are those over every
        positive spectrum that the tests do not reject. No record bounds k_inf from below. Of a
        sweep T is 1/omega of its lowest line and k(t) the storage there; of creep 1/k(t) is the
        compliance. None where tests of several kinds or depths were fitted.
        """
        end = self.evidence.end_of_hold
        return (
            None
            if end is None
            else StiffnessLimits(k_inf=end.k_inf, k_end=end.k_end, k_3end=end.k_3end)
        )

    # -- where it comes from ------------------------------------------------------------------

    @property
    def method(self) -> str:
        """Method of the fit: ``"full"``, ``"hold"``, ``"frf"``, ``"joint"``..."""
        return self.provenance.method

    @property
    def source(self) -> tuple[Source, ...]:
        """The raw files."""
        return self.provenance.source

    @property
    def steps(self) -> tuple[Step, ...]:
        """Everything done since the raw files."""
        return self.provenance.steps

    @property
    def specimen(self) -> Specimen:
        """Specimen of the test."""
        return self.provenance.specimen

    def weighed_by(self, judged: Verdict) -> Fit:
        """Return the fit with what a verdict holds against it, where its own checks are calmer."""
        if not self.verdict.calmer_than(judged):
            return self
        return self.with_checks(judged.because)

    def with_checks(self, checks: Iterable[Check]) -> Fit:
        """Return the fit with these checks beside its own, each once."""
        every = tuple(dict.fromkeys((*self.checks, *checks)))
        if every == self.checks:
            return self
        return replace(self, evidence=replace(self.evidence, checks=every))

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
    def described(self) -> tuple[str, ...]:
        """The verdict, the solid, and how the optimiser ended."""
        return (
            str(self.verdict),
            f"{self.solid} ({self.unit}, s), method {self.method}",
            f"optimiser: {self.status.value}",
        )

    def in_parallel(self, count: float) -> Fit:
        """The fit of `count` such parts side by side: stiffnesses, errors and length scale alike.

        What belongs to the fitted record alone (orders, certificate, nuisances) stays behind.
        """
        length = None if self.specimen.length is None else count * self.specimen.length
        step = Step(
            "parallel",
            (("count", f"{count:g}"), ("of", self.identity)),
            f"{count:g} in parallel of fit {self.identity}",
        )
        scaled = self._scale_stiffness(count, step)
        specimen = replace(self.specimen, length=length)
        return replace(scaled, provenance=replace(scaled.provenance, specimen=specimen))

    def aged(self, left: ReportedValue, says: str, *, checks: Sequence[Check] = ()) -> Fit:
        r"""The fit of the same part when aging has left so much of it: every stiffness times that.

        .. math:: C' = f^2 C + \sigma_f^2\,k k^T

        for the stiffnesses k, with the error of the factor f in the covariance: it is one of all.

        Parameters
        ----------
        left : Fact
            The part that is left, and its standard error.
        says : str
            After what.
        checks : sequence of Check
            Of the factor.

        Raises
        ------
        DataError
            If the part is not known, or only what it is at least.
        """
        error = left.error or 0.0
        if left.least_alone or not np.isfinite(error):
            raise DataError(
                f"a fit is scaled by a number that is known, and this is not: {left.says}. Use a "
                "hotter oven, or read longer"
            )
        step = Step(
            "aging",
            (("left", repr(left.value)), ("of", self.identity)),
            f"{left.value:.4g} of fit {self.identity} is left {says}",
        )
        scaled = self._scale_stiffness(left.value, step)
        here = {fact.name: fact.value for fact in self.estimate.facts(self.solid, self.unit)}
        k = np.array([here.get(name, 0.0) for name in self.parameters])
        estimate, by = scaled.estimate, error**2 * np.outer(k, k)
        of_noise = None if estimate.of_noise is None else estimate.of_noise + by
        return replace(
            scaled,
            estimate=replace(
                estimate, covariance=estimate.covariance + by, of_noise=of_noise, profiles=()
            ),
            evidence=replace(scaled.evidence, checks=(*self.checks, *checks)),
        )

    def at_compression(self, compression: Quantity) -> Fit:
        """The fit as small vibration about a compression, m, feels it: every stiffness the tangent.

        With a straight elastic law that is the fit itself.

        Raises
        ------
        DataError
            If the compression is not a number > 0, or one that no such seal has.
        """
        compression = convert_to_si(compression, "length")
        tangent = self.model_at(compression)
        require_plausible_compression(compression, self.elastic_law, self.specimen.height)
        if self.elastic_law is None or self.elastic_law.kind == "linear":
            return self
        factor = float(self.elastic_law.factor(compression))
        step = Step(
            "compression",
            (("compression_m", repr(compression)), ("of", self.identity)),
            f"tangent at {format_quantity(compression, 'mm')}, {factor:.4g} times the secant of "
            "fit "
            f"{self.identity}",
        )
        return replace(self._scale_stiffness(factor, step), solid=tangent, elastic_law=None)

    def with_elastic_law(
        self, law: ElasticLaw, *, checks: Sequence[Check] = (), stiffness: float | None = None
    ) -> Fit:
        """Return the fit with a law measured otherwise, of which the shape alone is taken.

        Its stiffnesses stay what they are at the depth that was held; the solid is then the secant
        one at the law's deepest compression. With `stiffness`, N/m, the relaxed secant one there,
        the fit is of the part that the law is of, and only its memory is taken.

        Raises
        ------
        DataError
            If no part was pressed, or the law ends more than 1 % before the depth that was held.
        """
        if self.elastic_law is None:
            raise DataError("the fit is of no pressed part: expected one of a relaxation test")
        held = self.elastic_law.depth
        if law.depth < 0.99 * held:
            raise DataError(
                f"the law ends at {format_quantity(law.depth, 'mm')}, and the test was held at "
                f"{format_quantity(held, 'mm')}: expected a cycle at least as deep"
            )
        factor = held / float(law.path(held))
        if stiffness is not None:
            factor = stiffness / self.model.k_inf
        step = Step(
            "elastic law",
            (("depth_m", repr(law.depth)), ("of", self.identity)),
            f"elastic law of compression load deflection to {format_quantity(law.depth, 'mm')}: "
            f"stiffnesses there {factor:.4g} times the secant of fit {self.identity}",
        )
        scaled = self._scale_stiffness(factor, step)
        return replace(
            scaled,
            elastic_law=replace(law, stiffness=scaled.model.k_inf),
            evidence=replace(scaled.evidence, checks=(*self.checks, *checks), end_of_hold=None),
        )

    def part(
        self, shape: Geometry | str | float, mode: PartMode | None = None, *, bonded: bool = True
    ) -> Fit:
        """The fit of a part of this material: modulus, errors and bounds times a geometry factor.

        Parameters
        ----------
        shape : Geometry, str or float
            A :class:`~dashpot.solids.part_geometry.Disc`, ``Block``, ``Bush`` or ``Bulb``, or in
            words ``"disc:20mm,20mm"``; or the factor itself, m: as ``geometry_factor`` of
            :mod:`dashpot.vibration.mass_on_seals` finds it.
        mode : str, optional
            How the shape is loaded.
        bonded : bool
            To its plates.

        Raises
        ------
        DataError
            If the fit is of a part already, or the shape is not loaded so.
        """
        if self.unit != "Pa":
            raise DataError(
                f"the fit is of a part, in {self.unit}; a shape is given to a material's modulus"
            )
        if isinstance(shape, str):
            shape = named_shape(shape)
        drawn = isinstance(shape, Geometry)
        factor = shape.factor(mode, bonded=bonded) if isinstance(shape, Geometry) else shape
        require_positive("geometry ", factor=factor, unit=" m")
        step = Step(
            "part",
            (("factor_m", repr(factor)), ("shape", repr(shape) if drawn else "given")),
            f"{factor:.5g} m times the modulus of fit {self.identity}",
        )
        return replace(self._scale_stiffness(factor, step), unit="N/m")

    def _scale_stiffness(self, count: float, step: Step) -> Fit:
        scale = np.array([1.0 if name.startswith(SHAPE) else count for name in self.parameters])
        other = self.alternative
        return replace(
            self,
            solid=count * self.solid,
            elastic_law=None if self.elastic_law is None else count * self.elastic_law,
            temperatures=None if self.temperatures is None else self.temperatures.times(scale),
            estimate=replace(
                self.estimate.scaled(scale),
                profiles=tuple(
                    profile for profile in self.profiles if profile.parameter.startswith("ln_tau")
                ),
                nuisance=(),
            ),
            evidence=Evidence(
                self.band,
                checks=self.checks,
                end_of_hold=None if self.end_of_hold is None else self.end_of_hold * count,
                alternative=None if other is None else replace(other, solid=count * other.solid),
                band_error=self.evidence.band_error,
            ),
            provenance=replace(self.provenance, steps=(*self.steps, step)),
        )


def _drop_dashpots(entries: dict[str, _One]) -> dict[str, _One]:
    """Without the dashpots, of which k and tau say all."""
    return {name: entry for name, entry in entries.items() if not name.startswith("b")}
