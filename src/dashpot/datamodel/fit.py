"""Result of a fit: the solid, its uncertainty, and its limits of use."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from typing import Any, TypeVar

import numpy as np

from dashpot.base import dataclass, fields, replace
from dashpot.base.arrays import EqualByValue, FloatArray
from dashpot.base.checks import Check, Verdict, verdict
from dashpot.base.errors import DataError, Status
from dashpot.base.number_format import format_band, format_count
from dashpot.base.option_fields import Family, Method, PartMode, get_choice_values
from dashpot.base.plain_text import sentence
from dashpot.base.provenance import Source, Step
from dashpot.base.reported_values import NORMAL, ReportedValue
from dashpot.base.result_mixins import Plottable
from dashpot.base.serialisation import Key, Serialisable
from dashpot.base.units import Quantity, celsius, convert_to_si, format_quantity
from dashpot.base.value_ranges import require_positive
from dashpot.datamodel.bounds import EndOfHold, StiffnessLimits
from dashpot.datamodel.fit_diagnostics import Evidence, Provenance, get_model_family
from dashpot.datamodel.parameter_estimate import (
    SHAPE_PREFIXES,
    Interval,
    Intervals,
    Nuisance,
    ParameterEstimate,
    StandardErrors,
)
from dashpot.datamodel.shift_factors import (
    MIN_CONTRADICTING_TESTS,
    SAME_TEMPERATURE,
    TemperatureShifts,
)
from dashpot.datamodel.specimen import Specimen
from dashpot.numerics.inference.model_order import is_well_determined
from dashpot.solids.elastic import ElasticLaw, require_plausible_compression
from dashpot.solids.fractional import FractionalZener
from dashpot.solids.maxwell import GeneralizedMaxwell, MaxwellArm, Solid
from dashpot.solids.part_geometry import Geometry, find_shape
from dashpot.solids.shift_laws import TemperatureLaw

_Value = TypeVar("_Value")
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
        Estimate of the parameters of `solid`.
    evidence : Evidence
    provenance : Provenance
    unit : str
        Unit of every stiffness: ``"N/m"`` for a part, ``"Pa"`` where a material's modulus was
        fitted.
    elastic_law : ElasticLaw or None
        Relaxed force against compression, where a part was pressed; `solid` is the secant one at
        its depth.
    temperatures : TemperatureShifts or None
        Shift factors, where tests at several temperatures were fitted; `solid` is that of their
        reference.

    Examples
    --------
    >>> import dashpot as dp
    >>> fit = dp.fit(dp.simulate("relaxation", hold="5s", noise_free=True), arms=2)
    >>> fit.model.arms, sorted(fit.intervals(level=0.95))
    (2, ['b', 'k', 'k_inf', 'tau'])
    """

    schema = "dashpot/fit@2"
    _keys = (
        Key("id", "_identity"),
        "status",
        "ok",
        Key("message", "status.value"),
        "verdict",
        "model",
        Key("solid", "_document_solid", nonfinite_as_null=True),
        Key("standard_error", "_document_errors", nonfinite_as_null=True),
        Key("interval_95", "_document_intervals", nonfinite_as_null=True),
        "estimate.residual",
        Key("band_hz", "evidence.band"),
        "elastic_law",
        Key("end_of_hold_limits", "evidence.end_of_hold"),
        Key("error_in_band", "evidence.band_error"),
        Key("largest_error_in_band", "_error_in_band", nonfinite_as_null=True),
        Key("temperature", "temperatures"),
        Key("mass", "_fitted_mass", optional=True),
        Key("creep", "evidence.creep", optional=True),
        "provenance.method",
        "estimate.parameters",
        "estimate.covariance",
        Key("noise_covariance", "estimate.noise_covariance", optional=True),
        "estimate.dof",
        "evidence.orders",
        "evidence.certificate",
        "estimate.profiles",
        "estimate.nuisance",
        "evidence.checks",
        "provenance.source",
        "provenance.steps",
        Key("by_depth", "evidence.stiffness_by_depth"),
        "provenance.specimen",
        "evidence.parameter_changes",
        "evidence.explanations",
        "evidence.alternative",
        "unit",
    )

    solid: Solid
    status: Status
    estimate: ParameterEstimate
    evidence: Evidence
    provenance: Provenance
    unit: str = "N/m"
    elastic_law: ElasticLaw | None = None
    temperatures: TemperatureShifts | None = None

    @property
    def _has_digest(self) -> bool:
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
    def family(self) -> Family:
        """Family of the solid: ``"maxwell"`` or ``"fractional"``."""
        return get_model_family(self.solid)

    @property
    def verdict(self) -> Verdict:
        """Verdict on the fit, by the gravest check that failed."""
        return verdict(self.checks, headline=self._headline)

    @property
    def _headline(self) -> str:
        """Errors of stiffness and loss factor in the band, as text; empty without a band."""
        if not self.band[1] > 0:
            return ""
        band = format_band(self.band)
        advice = "Outside this band the model is an extrapolation."
        if self.unit == "N/m" and self.method in get_choice_values(Method):
            # no ramp and hold shows a flow that grows as a power of its force from arms
            advice = "Outside this band a linear seal is assumed: add a hammer test."
        shifts = () if self.temperatures is None else self.temperatures.tested_shifts
        if self.method == "full" and 1 < len(shifts) < MIN_CONTRADICTING_TESTS:
            advice = "Test at a third temperature: two cannot show arms that shift apart."
        stiffness, loss_factor = self._error_in_band
        quantity = "modulus" if self.unit == "Pa" else "stiffness"
        if not (np.isfinite(stiffness) and stiffness < 1):
            text_in_band = f"{band} the error of the {quantity} is above 100 % or not known"
            return f"{sentence(text_in_band)} {advice}"
        text_in_band = f"{band} the {quantity} is known to ±{100 * stiffness:.2g} %"
        if np.isfinite(loss_factor) and loss_factor < 1:
            text_in_band += f", the loss factor to ±{100 * loss_factor:.2g} %"
        return f"{sentence(text_in_band)} {advice}"

    @property
    def _error_in_band(self) -> tuple[float, float]:
        r"""Largest 95 % error of stiffness and of loss factor in the band, each over its value.

        Of :math:`|K^*|` and :math:`\eta = K''/K'`, over every spectrum that the test does not
        reject, and no less than what the fit misses of the record's own lines
        (``datamodel.bounds.BandError``). Where that was not asked, by the
        covariance of the arms, and by the limits at the end of the hold where they are wider;
        infinite where none is known.
        """
        if self.evidence.band_error is not None:
            return self.evidence.band_error.max_errors
        low, high = self.band
        if not (0 < high < np.inf):
            return np.inf, np.inf
        lines = np.geomspace(low or 1e-3 * high, high, LINES_IN_BAND)
        s = np.asarray(2j * np.pi * lines, dtype=complex)
        stiffness, loss_factor = (
            NORMAL * error for error in self._arm_estimate.errors_of_vibration(self.model, s)
        )
        end = self.evidence.end_of_hold
        if end is not None and np.isfinite(end.k_end[1]):
            # its limits hold for every rig that may have made the test, the covariance for one
            half_width = (end.k_end[1] - end.k_end[0]) / 2
            k_end = end.compute_stiffness(self.model)
            stiffness = max(stiffness, half_width / k_end) if k_end > 0 else np.inf
        return stiffness, loss_factor

    def model_at(self, compression: Quantity, *, secant: bool = False) -> GeneralizedMaxwell:
        """Return the model for small vibration at a compression: the tangent of the elastic law.

        Parameters
        ----------
        compression : float or str
            m, or a text such as ``"3mm"``.
        secant : bool
            The linear model that gives the relaxed force at the compression instead.

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

    def at(self, temperature: Quantity) -> GeneralizedMaxwell:
        r"""Return the model at another temperature: times a_T the times, times b_T the stiffnesses.

        Parameters
        ----------
        temperature : float or str
            K, or a text such as ``"-20degC"``.

        Raises
        ------
        DataError
            If the fit is of one temperature and this is another, if it is less than 10 K above
            the glass transition that a WLF law implies, or where the law is not valid.
        """
        kelvin = convert_to_si(temperature, "temperature")
        require_positive(temperature=kelvin, unit=" K")
        if self.temperatures is not None:
            return self.temperatures.shift_model(self.model, kelvin)
        tested_temperature = self.specimen.temperature
        if tested_temperature is not None and abs(kelvin - tested_temperature) <= SAME_TEMPERATURE:
            return self.model
        name = (
            "a temperature that nobody noted"
            if tested_temperature is None
            else celsius(tested_temperature)
        )
        raise DataError(
            f"the fit is of tests at {name}, and nothing says how the model shifts to "
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
            (("temperature_K", repr(kelvin)), ("of", self._identity)),
            f"at {celsius(kelvin)}, a_T = {a_t:.5g} and b_T = {b_t:.5g} times fit {self._identity}",
        )
        scaled = scale_stiffness(self, b_t, step)

        def convert_covariance(covariance: FloatArray) -> FloatArray:
            return shifts.covariance_at(kelvin, self.estimate.parameters, covariance, self.model)

        noise = self.estimate.noise_covariance
        # what a test adds to the force of the solid it adds at any temperature
        estimate = replace(
            scaled.estimate,
            covariance=convert_covariance(self.covariance),
            noise_covariance=None if noise is None else convert_covariance(noise),
            profiles=(),
            nuisance=self.estimate.nuisance,
        )
        (low, high), error = self.band, self.evidence.band_error
        return replace(
            scaled,
            solid=solid,
            estimate=estimate,
            evidence=replace(
                scaled.evidence,
                band=(low / a_t, high / a_t),
                end_of_hold=self._shift_end_of_hold(kelvin, scaled.evidence.end_of_hold, a_t),
                band_error=error and error.shift_to_temperature(a_t),
            ),
            provenance=replace(
                scaled.provenance, specimen=replace(self.specimen, temperature=kelvin)
            ),
            temperatures=shifts.change_reference(kelvin),
        )

    def _shift_end_of_hold(
        self, kelvin: float, end: EndOfHold | None, a_t: float
    ) -> EndOfHold | None:
        """Return limits at the end of the test as they are at another temperature, K.

        They refer to a time that is a_T times as long. They are widened by the errors of shifts and
        their law in the stiffness there.
        """
        if end is None or self.temperatures is None:
            return None
        s = np.array([1j / end.end_time], dtype=complex)
        arms = self._arm_estimate
        shifted_arms = replace(
            arms,
            covariance=self.temperatures.covariance_at(
                kelvin, arms.parameters, arms.covariance, self.model
            ),
        )
        error, shifted_error = (
            estimate.errors_of_vibration(model, s_line)[0]
            for estimate, model, s_line in (
                (arms, self.model, s),
                (shifted_arms, self.at(kelvin), np.asarray(s / a_t, dtype=complex)),
            )
        )
        if not np.isfinite(shifted_error):
            return None
        widening = NORMAL * float(np.sqrt(max(shifted_error**2 - error**2, 0.0)))
        return replace(end.widen(widening), end_time=a_t * end.end_time)

    # -- how well it is known -----------------------------------------------------------------

    @property
    def covariance(self) -> FloatArray:
        """Covariance of the parameters by noise and rigs, shape (p, p)."""
        return self.estimate.covariance

    @property
    def _has_given_k_inf(self) -> bool:
        """Whether k_inf was given and not fitted."""
        return bool(self.estimate.parameters) and "k_inf" not in self.estimate.parameters

    @property
    def standard_error(self) -> StandardErrors:
        """Standard errors of k_inf, and of k, tau and b = k tau of each arm, SI units.

        No test bounds k_inf from below, so it has no standard error (nan) but where it was given:
        :meth:`intervals` has its upper limit. For a fractional solid, the values of its equivalent
        arms follow from its own four parameters. Of relaxation tests they hold what their rigs may
        have done unseen; without it they are those of `estimate.noise_only`.
        """
        errors = self._arm_estimate.standard_errors(self.model)
        return {**errors, "k_inf": self._select_k_inf_error(errors["k_inf"])}

    def _select_k_inf_error(self, error: float) -> float:
        """The standard error of k_inf: none (nan), unless given or wholly unknown (infinite)."""
        return error if self._has_given_k_inf or not np.isfinite(error) else np.nan

    def intervals(self, level: float = 0.95) -> Intervals:
        """Confidence intervals at `level`, SI units: Student's, or the profile's where stored.

        An end that the data leave open is 0 or infinite. No test bounds k_inf from below: it is at
        most the upper end of `stiffness_limits`, or of its own interval where nothing was left
        open. The end of `stiffness_limits` is computed at 95 %, and at another level its distance
        from the fit is in the ratio of Student's quantiles.

        Raises
        ------
        DataError
            If `level` is not between 0 and 1.
        """
        intervals = self._arm_estimate.intervals(self.model, level)
        return {**intervals, "k_inf": self._k_inf_limits(intervals["k_inf"], level)}

    def _k_inf_limits(self, formal: Interval, level: float) -> Interval:
        """The interval of k_inf: from 0 to the upper limit by the test, or to its own upper end."""
        if self._has_given_k_inf:
            return formal
        end = self.evidence.end_of_hold
        if end is None:
            return 0.0, formal[1]
        estimate = replace(self.estimate, dof=max(self.estimate.dof, 1.0))
        widening = estimate.quantile(level) / estimate.quantile(0.95)
        return 0.0, self.model.k_inf + widening * (end.k_inf[1] - self.model.k_inf)

    def _compute_solid_intervals(self, level: float = 0.95) -> dict[str, Interval]:
        """Confidence intervals at `level` of the solid's own parameters by their names, SI units.

        The names are those of `facts`.

        Raises
        ------
        DataError
            If `level` is not between 0 and 1.
        """
        entries = self.estimate.confidence_limits(self.solid, level)
        return _exclude_dashpots({**entries, "k_inf": self._k_inf_limits(entries["k_inf"], level)})

    @property
    def facts(self) -> tuple[ReportedValue, ...]:
        """Every parameter of the solid with its standard error and 95 % interval.

        No test bounds k_inf from below: it is at most so much, and has no error.
        """
        return self._bound_k_inf(self.estimate.list_values(self.solid, self.unit))

    @property
    def _arm_values(self) -> tuple[ReportedValue, ...]:
        """Return the values of the arms, for a fractional solid those of its approximation."""
        return self._bound_k_inf(self._arm_estimate.list_values(self.model, self.unit))

    def _bound_k_inf(self, reported_values: tuple[ReportedValue, ...]) -> tuple[ReportedValue, ...]:
        """Return the values, k_inf with its upper limit."""
        return tuple(
            self._bound_k_inf_from_above(reported_value)
            if reported_value.name == "k_inf"
            else reported_value
            for reported_value in reported_values
        )

    def _bound_k_inf_from_above(self, fitted: ReportedValue) -> ReportedValue:
        """Return k_inf as every table has it: its upper limit in place of its fitted interval."""
        end = self.evidence.end_of_hold
        upper_limit = fitted.high if end is None else end.k_inf[1]
        if self._has_given_k_inf or not np.isfinite(upper_limit):
            return fitted
        source_note = "" if end is None or end.test_kind != "frf" else "stiffness below the band"
        return replace(fitted, low=np.nan, high=upper_limit, error=None, words=source_note)

    @property
    def _document_intervals(self) -> Intervals:
        """95 % intervals, as :meth:`intervals`."""
        return self.intervals(level=0.95)

    @property
    def _document_errors(self) -> dict[str, Any]:
        """Standard errors laid out as the document of a model is."""
        error, k_inf = self.standard_error, self._arm_values[0]
        arms = zip(error["k"], error["tau"], error["b"], strict=True)
        return {"k_inf": k_inf.error, "arms": tuple(MaxwellArm(*arm) for arm in arms)}

    @property
    def _document_solid(self) -> dict[str, Any]:
        """The family of the solid; of another than arms its parameters and how they are known."""
        if self.family == "maxwell":
            return {"family": self.family}
        return {
            "family": self.family,
            **{field.name: getattr(self.solid, field.name) for field in fields(self.solid)},  # type: ignore[arg-type]
            "standard_error": {
                reported_value.name: reported_value.error for reported_value in self.facts
            },
            "interval_95": self._compute_solid_intervals(level=0.95),
        }

    @property
    def _fitted_mass(self) -> float | None:
        """The fitted mass, kg."""
        if self.evidence.has_unexplained_discrepancy:
            return None
        masses = (item.value for item in self.estimate.nuisance if item.name == "mass")
        return next(masses, None)

    @property
    def _arm_estimate(self) -> ParameterEstimate:
        """Estimate of the arms of the solid."""
        if isinstance(self.solid, FractionalZener) and self.estimate.parameters:
            return self.estimate.convert_to_arms(self.solid)
        return self.estimate

    # -- what the data support ----------------------------------------------------------------

    @property
    def band(self) -> tuple[float, float]:
        """Valid band, Hz: where the test determines stiffness and loss factor."""
        return self.evidence.band

    @property
    def checks(self) -> tuple[Check, ...]:
        """Every check put to the records and to the fit."""
        return self.evidence.checks

    @property
    def stiffness_limits(self) -> StiffnessLimits | None:
        r"""Limits of k_inf, k(T) and k(3 T) by the tests, in `unit`.

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
        """All processing steps since the raw files."""
        return self.provenance.steps

    @property
    def specimen(self) -> Specimen:
        """Specimen of the test."""
        return self.provenance.specimen

    @property
    def _identity(self) -> str:
        """Sixteen hexadecimal digits that name this result: of its solid, method and raw files.

        Decks and reports carry it, so that each can be traced to the fit it came from.
        """
        model = self.model
        content = (
            (model.k_inf, model.k, model.tau, model.b),
            self.method,
            tuple(source.sha256 for source in self.source),
        )
        return hashlib.sha256(repr(content).encode()).hexdigest()[:16]

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """The verdict, the solid, and how the optimiser ended."""
        return (
            str(self.verdict),
            f"{self.solid} ({self.unit}, s), method {self.method}",
            f"optimiser: {self.status.value}",
        )

    def in_parallel(self, count: float) -> Fit:
        """The fit of `count` such parts side by side: stiffnesses, errors and length scale alike.

        Orders, certificate and nuisances, which describe only the fitted record, are dropped.
        """
        length = None if self.specimen.length is None else count * self.specimen.length
        step = Step(
            "parallel",
            (("count", f"{count:g}"), ("of", self._identity)),
            f"{count:g} in parallel of fit {self._identity}",
        )
        scaled = scale_stiffness(self, count, step)
        specimen = replace(self.specimen, length=length)
        return replace(scaled, provenance=replace(scaled.provenance, specimen=specimen))

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
            (("compression_m", repr(compression)), ("of", self._identity)),
            f"tangent at {format_quantity(compression, 'mm')}, {factor:.4g} times the secant of "
            f"fit {self._identity}",
        )
        return replace(scale_stiffness(self, factor, step), solid=tangent, elastic_law=None)

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
            shape = find_shape(shape)
        has_geometry = isinstance(shape, Geometry)
        factor = shape.factor(mode, bonded=bonded) if isinstance(shape, Geometry) else shape
        require_positive("geometry ", factor=factor, unit=" m")
        step = Step(
            "part",
            (("factor_m", repr(factor)), ("shape", repr(shape) if has_geometry else "given")),
            f"{factor:.5g} m times the modulus of fit {self._identity}",
        )
        return replace(scale_stiffness(self, factor, step), unit="N/m")


def scale_stiffness(fit: Fit, factor: float, step: Step) -> Fit:
    """Return a fit of which every stiffness, and its error, is `factor` times as large."""
    scale = np.array(
        [1.0 if name.startswith(SHAPE_PREFIXES) else factor for name in fit.estimate.parameters]
    )
    alternative = fit.evidence.alternative
    return replace(
        fit,
        solid=factor * fit.solid,
        elastic_law=None if fit.elastic_law is None else factor * fit.elastic_law,
        temperatures=None if fit.temperatures is None else fit.temperatures.times(scale),
        estimate=replace(
            fit.estimate.scale(scale),
            profiles=tuple(
                profile
                for profile in fit.estimate.profiles
                if profile.parameter.startswith("ln_tau")
            ),
            nuisance=(),
        ),
        evidence=Evidence(
            fit.band,
            checks=fit.checks,
            end_of_hold=None
            if fit.evidence.end_of_hold is None
            else fit.evidence.end_of_hold * factor,
            alternative=None
            if alternative is None
            else replace(alternative, solid=factor * alternative.solid),
            band_error=fit.evidence.band_error,
        ),
        provenance=replace(fit.provenance, steps=(*fit.steps, step)),
    )


def _exclude_dashpots(entries: dict[str, _Value]) -> dict[str, _Value]:
    """Return the entries without b = k tau."""
    return {name: entry for name, entry in entries.items() if not name.startswith("b")}


# Values of a fit as reports, solver inputs and later fits need them, and fits with more checks.


def get_model_label(fit: Fit) -> str:
    """Return the model in few words: how many arms it has, or its family."""
    if fit.family == "fractional":
        return "fractional solid"
    return format_count(fit.model.arms, "arm")


def get_fewest_arms_model(fit: Fit) -> GeneralizedMaxwell:
    """Return the model of the fit; of a fractional one, the alternative with few arms.

    They weigh a record as well as the many that stand for the fractional model itself.
    """
    alternative = fit.evidence.alternative
    if fit.family == "maxwell" or alternative is None or alternative.family != "maxwell":
        return fit.model
    return alternative.solid.maxwell


def get_temperature_law(fit: Fit) -> TemperatureLaw | None:
    """Return the shift factor of time against temperature; None where one was tested."""
    return None if fit.temperatures is None else fit.temperatures.law


def get_error_label(fit: Fit) -> str:
    """Return the label of the errors of shifts and of their law.

    Errors of the rigs may be larger than these.
    """
    return "± SE" if fit.estimate.noise_covariance is None else "± noise"


def list_undetermined_times(fit: Fit) -> tuple[float, ...]:
    """Return relaxation times, s, of arms that the data require but do not determine.

    Such an arm only corrects the others: its own k or tau is hardly determined. None are listed of
    a fit whose parameters are identified.
    """
    arms = fit.model.arms
    if fit.status is not Status.NOT_IDENTIFIED or len(fit.estimate.parameters) < 1 + 2 * arms:
        return ()
    error = np.sqrt(np.diag(fit.estimate.noise_only.covariance))
    is_determined = is_well_determined(
        np.array(fit.model.k), error[1 : 1 + arms], error[1 + arms : 1 + 2 * arms]
    )
    return tuple(
        tau for tau, determined in zip(fit.model.tau, is_determined, strict=True) if not determined
    )


def list_model_values(fit: Fit) -> tuple[ReportedValue, ...]:
    """Return the rows of the model's parameters, the same in all tables.

    The stiffness at the end of the hold, then every parameter; of a spectrum, whose single
    arms mean nothing, its ends.
    """
    values, model, end = fit.facts, fit.model, fit.evidence.end_of_hold
    if not fit.estimate.parameters:
        spectrum_limits = [("k_inf", model.k_inf, fit.unit), ("k_0", model.k_0, fit.unit)]
        if model.arms:
            spectrum_limits += [("tau from", model.tau[0], "s"), ("tau to", model.tau[-1], "s")]
        values = fit._bound_k_inf(
            tuple(
                ReportedValue(name, value, unit=unit, error=np.inf)
                for name, value, unit in spectrum_limits
            )
        )
    return values if end is None else (end.fact(model, fit.unit), *values)


def list_arm_values(fit: Fit) -> tuple[ReportedValue, ...]:
    """Return every parameter of the arms: those that stand for a fractional model, not its own."""
    return fit._arm_values


def list_reported_nuisances(fit: Fit) -> tuple[Nuisance, ...]:
    """Return the nuisance parameters to report; none where two tests are contradictory."""
    return () if fit.evidence.has_unexplained_discrepancy else fit.estimate.nuisance


def get_fitted_mass(fit: Fit) -> float | None:
    """Return the fitted mass, kg."""
    return fit._fitted_mass


def get_hammer_stiffness_factor(fit: Fit) -> float:
    """Return the stiffness ratio of a seal under the hammer, if it explains both tests."""
    is_nonlinear = fit.elastic_law is not None and fit.elastic_law.kind != "linear"
    if is_nonlinear or not any(
        explanation.is_sufficient for explanation in fit.evidence.explanations[:1]
    ):
        return 1.0
    factors = (item.value for item in fit.estimate.nuisance if item.name == "stiffness_factor")
    return next(factors, 1.0)


def add_checks(fit: Fit, checks: Iterable[Check]) -> Fit:
    """Return the fit with additional checks, each once."""
    all_checks = tuple(dict.fromkeys((*fit.checks, *checks)))
    if all_checks == fit.checks:
        return fit
    return replace(fit, evidence=replace(fit.evidence, checks=all_checks))
