"""Construction of a `Fit` from an optimum: checks, nuisances, valid band, provenance."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check, Remedy, select_fit_status, select_gravest_check
from dashpot.base.errors import Status
from dashpot.base.option_fields import Method
from dashpot.base.provenance import Step, list_sources, list_steps
from dashpot.base.reported_values import NORMAL
from dashpot.datamodel.bounds import MAX_LOSS_FACTOR_ERROR, EndOfHold
from dashpot.datamodel.checks import caution_checks, numbers_unambiguous
from dashpot.datamodel.fit import LINES_IN_BAND, Fit
from dashpot.datamodel.fit_diagnostics import Evidence, Provenance
from dashpot.datamodel.parameter_estimate import (
    Nuisance,
    ParameterEstimate,
    Residual,
    parameter_names,
)
from dashpot.datamodel.relaxation import RampHold
from dashpot.datamodel.shift_factors import TemperatureShifts
from dashpot.fitting.checks.relaxation import (
    arms_where_force_relaxes,
    fast_arm_visible,
    force_residual_small,
    hold_long_enough,
    k_end_determined,
    k_inf_positive,
    ramp_accounted_for,
    record_window,
    residuals_steady,
    same_specimen,
)
from dashpot.fitting.checks.solid import (
    arms_distinct,
    arms_supported,
    loss_factor_determined,
    residuals_white,
    tau_inside_window,
    uncertainty_estimated,
)
from dashpot.fitting.input_tests import end_stiffnesses
from dashpot.fitting.nuisance_priors import ROUNDING
from dashpot.fitting.valid_band import find_loss_factor_band
from dashpot.preprocessing.checks import check_records
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid

# Construction of a fit, common to all methods.


#: evidence of an optimum without alternatives
NO_EVIDENCE = Evidence((0.0, 0.0), checks=(uncertainty_estimated(is_estimated=False),))


class SolidEstimate(NamedTuple):
    """Result of a search for a solid.

    Attributes
    ----------
    solid : Solid
    estimate : ParameterEstimate
        Estimate of its parameters.
    has_fewer_arms : bool
        It has fewer arms than requested.
    at_bound : bool
        A parameter is at a bound.
    """

    solid: Solid
    estimate: ParameterEstimate
    has_fewer_arms: bool = False
    at_bound: bool = False


def build_fit(
    estimate: SolidEstimate,
    evidence: Evidence,
    provenance: Provenance,
    *,
    unit: str = "N/m",
    elastic_law: ElasticLaw | None = None,
    temperatures: TemperatureShifts | None = None,
) -> Fit:
    """Return the fit of an optimum, which ended as its checks and the optimum itself say.

    Parameters
    ----------
    estimate : SolidEstimate
    evidence : Evidence
        Its checks in display order, those of the records first.
    provenance : Provenance
    unit, elastic_law, temperatures
        As `Fit` holds them.
    """
    evidence = replace(evidence, checks=_add_cautions(evidence.checks, provenance))
    conditions = {
        Status.FEWER_ARMS: estimate.has_fewer_arms,
        Status.TAU_AT_BOUND: estimate.at_bound,
    }
    fit = Fit(
        solid=estimate.solid,
        status=select_fit_status(evidence.checks, conditions),
        estimate=estimate.estimate,
        evidence=evidence,
        provenance=provenance,
        unit=unit,
        elastic_law=elastic_law,
        temperatures=temperatures,
    )
    return fit if evidence.band_error is not None else _restrict_to_loss_band(fit)


def _restrict_to_loss_band(fit: Fit) -> Fit:
    """Return a fit whose errors are those of its covariance, its band where they are small enough.

    Where they are so at no line, a check says it; without a known error the fit is unchanged.
    """
    if not MAX_LOSS_FACTOR_ERROR < fit._error_in_band[1] < np.inf:
        return fit
    estimate = fit.estimate

    def errors(line: float) -> tuple[float, float]:
        stiffness, loss_factor = estimate.errors_of_vibration(
            fit.model, np.array([2j * np.pi * line])
        )
        return NORMAL * stiffness, NORMAL * loss_factor

    lines = np.geomspace(*fit.band, LINES_IN_BAND).tolist()
    band, error = find_loss_factor_band(errors, fit.band, {line: errors(line) for line in lines})
    checks = fit.checks
    if error.max_errors[1] > MAX_LOSS_FACTOR_ERROR:
        checks = (*checks, loss_factor_determined(error))
    return replace(fit, evidence=replace(fit.evidence, band=band, checks=checks))


def _add_cautions(checks: tuple[Check, ...], provenance: Provenance) -> tuple[Check, ...]:
    """Return the checks, with doubts from the files unless preparation has stated them."""
    if any(check.name == numbers_unambiguous.name for check in checks):
        return checks
    return (*checks, *caution_checks(provenance.source))


def estimate_without_errors(
    model: GeneralizedMaxwell, samples: int, sse: float, nuisance: tuple[Nuisance, ...]
) -> ParameterEstimate:
    """Return the parameters of an optimum as an estimate without errors."""
    names = parameter_names(model.arms)
    return ParameterEstimate(
        names,
        np.diag(np.full(len(names), np.inf)),
        dof=0.0,
        residual=Residual(samples, sse, float(np.sqrt(sse / samples))),
        nuisance=nuisance,
    )


def list_nuisances(
    names: Sequence[str],
    value: Callable[[str], float],
    error: Callable[[str], float],
    *,
    unit: str = "N",
    prior_sds: Mapping[str, float] | None = None,
) -> tuple[Nuisance, ...]:
    """Return offset, drift, delay and warming of each test; of several, named by its number.

    Parameters
    ----------
    names : sequence of str
        Names of columns, ``"offset@0"`` of the first test; those of the solid are skipped.
    value, error : callable
        Coefficient and standard error of a column.
    unit : str
        Unit of the measured force or stress.
    prior_sds : mapping of str to float, optional
        Standard deviations that were known before the fit.
    """
    units = {"offset": unit, "drift": f"{unit}/s", "delay": "s", "warming": "K"}
    labels = [name for name in names if name.partition("@")[0] in units]
    has_several_records = len({name.partition("@")[2] for name in labels}) > 1
    terms = []
    for name in labels:
        kind, _, test = name.partition("@")
        title = f"{kind} of test {int(test) + 1}" if has_several_records else kind
        prior_sd = None if prior_sds is None else prior_sds.get(name)
        terms.append(Nuisance(title, value(name), error(name), units[kind], prior_sd))
    return tuple(terms)


def collect_provenance(method: str, tests: Sequence[RampHold], *steps: Step) -> Provenance:
    """Return the provenance of a fit of relaxation tests, with the specimen of the deepest test."""
    deepest_test = max(tests, key=lambda test: test.depth)
    return Provenance(
        method, list_sources(tests), (*list_steps(tests), *steps), deepest_test.specimen
    )


# Checks of every fit of relaxation tests.


class Residuals(NamedTuple):
    """Residuals of each record.

    Attributes
    ----------
    by_record : sequence of array
        One per record, N.
    rms : float
        Over all records, N.
    kappa : float
        Samples per independent residual.
    """

    by_record: Sequence[FloatArray]
    rms: float
    kappa: float


def run_relaxation_checks(
    records: Sequence[RampHold],
    model: GeneralizedMaxwell,
    error: FloatArray,
    residuals: Residuals,
    end: EndOfHold | None,
    *,
    method: Method = "full",
    arms_selected: bool = False,
    in_arms: bool = True,
) -> list[Check]:
    """Return the checks of the records and of the solid fitted to them.

    Parameters
    ----------
    records : sequence of RampHold
    model : GeneralizedMaxwell
    error : array, shape (p,)
        Standard errors of k_inf, every k, every ln tau.
    residuals : Residuals
    end : EndOfHold or None
    method : "full" or "hold"
    arms_selected : bool
        Fewer arms are rejected.
    in_arms : bool
        The fitted parameters are those of the arms.
    """
    window = RelaxationWindow(
        record_window(records), "the record", (" (two samples)", " (the hold)")
    )
    # that the tests are of one specimen comes first: nothing else is wrong where they are not
    return [
        *([same_specimen(end_stiffnesses(records))] if len(records) > 1 else ()),
        *check_records(records, method=method, solids=[model] * len(records)),
        hold_long_enough(end),
        *run_solid_checks(
            records,
            model,
            error,
            residuals,
            window,
            end=end,
            arms_selected=arms_selected,
            in_arms=in_arms,
        ),
    ]


class RelaxationWindow(NamedTuple):
    """Window of relaxation times, s, that some records show, with texts of its two ends."""

    span: tuple[float, float]
    source: str
    end_names: tuple[str, str] = ("", "")


def run_solid_checks(
    records: Sequence[RampHold],
    model: GeneralizedMaxwell,
    error: FloatArray,
    residuals: Residuals,
    window: RelaxationWindow,
    *,
    solids: Sequence[GeneralizedMaxwell] = (),
    end: EndOfHold | None = None,
    arms_selected: bool = False,
    in_arms: bool = True,
) -> list[Check]:
    """Return the checks of a solid, as :func:`run_relaxation_checks`, at each temperature.

    Of several temperatures no arm is fast or slow by itself.
    """
    peak = max(float(abs(record.force).max()) for record in records)
    pairs = zip(solids or [model] * len(records), records, strict=True)
    return [
        *(_check_arms(model, error, window, arms_selected=arms_selected) if in_arms else ()),
        k_inf_positive(model, float(error[0]), end),
        k_end_determined(model, float(error[0]), records, end),
        select_gravest_check(arms_where_force_relaxes(solid, record) for solid, record in pairs),
        select_gravest_check(map(force_residual_small, records, residuals.by_record)),
        residuals_white(
            residuals.kappa, residuals.rms, max(record.force_noise for record in records)
        ),
        *(_check_fast_arms(records, model, error) if in_arms and not solids else ()),
        residuals_steady(residuals.by_record, rounding=ROUNDING * peak, peak=peak),
    ]


def _check_arms(
    model: GeneralizedMaxwell, error: FloatArray, window: RelaxationWindow, *, arms_selected: bool
) -> tuple[Check, ...]:
    return (
        arms_distinct(model),
        arms_supported(model, error, arms_selected=arms_selected),
        tau_inside_window(
            model,
            window.span,
            window.source,
            end_names=window.end_names,
            is_closed=True,
            remedy=Remedy("Use fewer arms, hold longer, or sample faster.", "arms"),
        ),
    )


def _check_fast_arms(
    records: Sequence[RampHold], model: GeneralizedMaxwell, error: FloatArray
) -> tuple[Check, ...]:
    return (
        ramp_accounted_for(model, records),
        fast_arm_visible(model, records, error=_compute_fastest_error(model, error)),
    )


def _compute_fastest_error(model: GeneralizedMaxwell, error: FloatArray) -> float:
    """Return the relative standard error of the fastest arm's k."""
    return float(error[1] / model.k[0]) if model.arms else float("inf")
