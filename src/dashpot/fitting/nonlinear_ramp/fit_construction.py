"""Construction of a `Fit` from an elastic law and its solid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check
from dashpot.base.provenance import Step
from dashpot.datamodel.bounds import EndOfHold
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.fit_diagnostics import DepthStiffness, Evidence
from dashpot.datamodel.parameter_estimate import Nuisance, ParameterEstimate
from dashpot.datamodel.relaxation import RampHold
from dashpot.fitting.admissible_spectra import AdmissibleSpectra
from dashpot.fitting.checks.solid import loss_factor_determined, valid_band_exists
from dashpot.fitting.data_blocks import FitSetup, compress_tests
from dashpot.fitting.fit_construction import (
    Residuals,
    SolidEstimate,
    build_fit,
    collect_provenance,
    run_relaxation_checks,
)
from dashpot.fitting.marginal_relaxation import RelaxationData
from dashpot.fitting.nonlinear_ramp import checks
from dashpot.fitting.nonlinear_ramp.elastic_law import RampLaw
from dashpot.fitting.nuisance_priors import (
    build_delay_prior,
    compute_significant_drift,
    select_hold_end,
)
from dashpot.fitting.parameter_errors import compute_clock_sensitivity
from dashpot.fitting.relaxation_likelihood import build_hold_data
from dashpot.fitting.valid_band import find_hold_band, find_informed_band
from dashpot.solids.maxwell import GeneralizedMaxwell


def build_ramp_fit(
    tests: Sequence[RampHold],
    law: RampLaw,
    *,
    requested_arms: int | None = None,
    by_depth: tuple[DepthStiffness, ...] = (),
    checks: Sequence[Check] = (),
    end: EndOfHold | None = None,
    unmeasured: FloatArray | None = None,
    spectra: AdmissibleSpectra | None = None,
) -> Fit:
    """Return the fit of tests that share an elastic law.

    Parameters
    ----------
    tests : sequence of RampHold
    law : RampLaw
    requested_arms : int or None
        Requested number of arms; None if selected by the holds.
    by_depth, checks
        Stiffnesses of each test, and checks other than those of the law.
    end : EndOfHold or None
        Limits at the end of the hold.
    unmeasured : array, shape (p, d), optional
        Changes of the parameters by one standard deviation of each unknown of the rigs. They
        widen intervals; checks against the noise do not use them.
    spectra : AdmissibleSpectra, optional
        Spectra that the holds do not reject; they limit the valid band.
    """
    model, estimate = law.model, _add_test_errors(law.estimate, law.model, tests)
    law = replace(law, estimate=estimate)
    residual = estimate.residual
    band = find_informed_band(
        tests,
        compress_tests(tests, FitSetup("full")),
        stiffness=max(model.k_0, 1e-300),
        noise=max(residual.rms * np.sqrt(residual.variance_inflation), 1e-300),
    )
    error = None
    if spectra is not None:
        band, error = find_hold_band(spectra, model, band)
    record_checks = [check for test in tests for check in test.checks]
    all_checks = (
        *checks,
        *law_checks(tests, law, end),
        valid_band_exists(band),
        loss_factor_determined(error),
    )
    return build_fit(
        SolidEstimate(
            model,
            estimate if unmeasured is None else estimate.with_rig(unmeasured),
            has_fewer_arms=requested_arms is not None and model.arms < requested_arms,
        ),
        Evidence(
            band,
            checks=(*record_checks, *all_checks),
            stiffness_by_depth=by_depth,
            end_of_hold=end,
            band_error=error,
        ),
        collect_provenance("full", tests, _make_step(tests, law)),
        elastic_law=replace(law.law, ratio_se=_shape_error(law)),
    )


def build_ramp_data(tests: Sequence[RampHold], law: RampLaw) -> list[RelaxationData]:
    """Return the data of the holds of tests with one elastic law, and the errors by their rigs."""
    return [
        build_hold_data(
            test,
            law.model,
            residual[test.settled_samples.start - test.hold.stop :],
            law=law.law,
        )
        for test, residual in zip(tests, law.residuals, strict=True)
    ]


def depth_error(test: RampHold) -> float:
    """Return the relative standard error of the held depth, which every stiffness shares."""
    return float(np.hypot(test.depth_error, test.contact_error / test.depth))


def _add_test_errors(
    estimate: ParameterEstimate, model: GeneralizedMaxwell, tests: Sequence[RampHold]
) -> ParameterEstimate:
    r"""Return the estimate with the errors of depth and clock of the tests.

    A relative error of the depth scales every stiffness, a delay :math:`\delta` of the ramp each
    arm by :math:`\delta/\tau_j`; of n tests each counts :math:`1/\sqrt n`.
    """
    depth = [depth_error(test) for test in tests]
    stiffness_vector = np.concatenate(([model.k_inf], model.k, np.zeros(model.arms)))
    mean_error = float(np.sqrt(np.mean(np.square(depth)) / len(tests)))
    error_columns = np.column_stack(
        (mean_error * stiffness_vector, compute_clock_sensitivity(tests, model))
    )
    return replace(estimate, covariance=estimate.covariance + error_columns @ error_columns.T)


def _shape_error(law: RampLaw) -> tuple[float, ...]:
    """Return standard errors of the law's shape at its knots; none of a straight line."""
    if law.law.kind == "linear":
        return ()
    shape = np.diag(law.law_covariance)[-len(law.law.knots) :]
    return tuple(float(error) for error in np.sqrt(np.maximum(shape, 0.0)))


def law_checks(tests: Sequence[RampHold], law: RampLaw, end: EndOfHold | None) -> tuple[Check, ...]:
    """Return every check of the records, of the solid and of its elastic law."""
    residual = law.estimate.residual
    error = np.sqrt(np.diag(law.estimate.covariance))
    # the misfit of the ramp is assessed by ramp_residual_small
    residuals_by_record = [
        residual[test.settled_samples.start - test.hold.stop :]
        for residual, test in zip(law.residuals, tests, strict=True)
    ]
    residuals = Residuals(residuals_by_record, residual.rms, residual.variance_inflation)
    return (
        *run_relaxation_checks(tests, law.model, error, residuals, end),
        *ramp_checks(tests, law, end),
    )


def ramp_checks(
    tests: Sequence[RampHold], law: RampLaw, end: EndOfHold | None
) -> tuple[Check, ...]:
    """Return the checks of elastic law and load cell, each at its worst over the records."""
    rows = law.optimum.weighted.solid.rows
    worst_index = int(np.argmax(law.relative_residuals))
    values = law.optimum.nuisance
    error = np.sqrt(np.diag(law.estimate.covariance))
    deepest_index = int(np.argmax(rows.depths))
    residual_check = checks.ramp_residual_small(
        law.relative_residuals[worst_index],
        max(rows.noise[worst_index], law.hold.rms[worst_index]) / rows.peak(worst_index),
        law.discrepancy[worst_index],
        law.law.kind,
    )
    return (
        residual_check,
        checks.hold_residual_small(
            law.rho, [value / rows.peak(i) for i, value in enumerate(law.optimum.hold_rms)]
        ),
        checks.tangent_determined(law.law, different_ramps(tests)),
        checks.k_inf_plausible(
            law.model,
            float(np.hypot(error[0], law.hold.plateau_error[deepest_index])),
            end_stiffness(tests[deepest_index], rows.priors[deepest_index].offset.mean),
            tests[deepest_index].hold_time,
        ),
        checks.offset_plausible(
            [
                (values[f"offset@{i}"], *priors.offset, compute_significant_drift(tests[i]).offset)
                for i, priors in enumerate(rows.priors)
            ]
        ),
        checks.drift_plausible(
            [
                (values[f"drift@{i}"], *priors.drift, compute_significant_drift(tests[i]).drift)
                for i, priors in enumerate(rows.priors)
            ],
            np.inf if end is None else end.distance_outside,
        ),
        checks.baseline_agrees(
            [(priors.baseline_drift.mean, priors.conflict) for priors in rows.priors]
        ),
        checks.clocks_agree(
            [
                (delay.value, delay.standard_error, build_delay_prior(test).sd)
                for delay, test in zip(_select_nuisances("delay", law), tests, strict=False)
            ]
        ),
    )


def _select_nuisances(kind: str, law: RampLaw) -> list[Nuisance]:
    """Return the fitted nuisances of a kind, in the order of the tests."""
    return [nuisance for nuisance in law.estimate.nuisance if nuisance.name.startswith(kind)]


def end_stiffness(test: RampHold, equilibrium_force: float) -> float:
    """Return the mean force above rest in the last twentieth of the hold over x, N/m."""
    last_samples = select_hold_end(test)
    return float(np.mean(test.force[last_samples]) - equilibrium_force) / float(
        np.mean(test.displacement[last_samples])
    )


def different_ramps(tests: Sequence[RampHold]) -> int:
    """Return how many ramps differ in rate or depth by a tenth or more."""
    distinct_ramps: list[tuple[float, float]] = []
    for test in tests:
        ramp = (test.depth / test.ramp_time, test.depth)
        if all(max(abs(np.log(a / b)) for a, b in zip(ramp, rate_and_depth, strict=True)) >= 0.1
               for rate_and_depth in distinct_ramps):  # fmt: skip
            distinct_ramps.append(ramp)
    return len(distinct_ramps)


def _make_step(tests: Sequence[RampHold], ramp_law: RampLaw) -> Step:
    law, arms = ramp_law.law, ramp_law.model.arms
    test_count = f"{len(tests)} tests" if len(tests) > 1 else "one test"
    shape = "a linear elastic law" if law.kind == "linear" else (
        f"an elastic law whose tangent is linear between {len(law.knots)} knots"
    )  # fmt: skip
    message = (
        f"fitted a generalized Maxwell model with {arms} arm{'s' * (arms != 1)} and {shape} to "
        f"{test_count}, holds first"
    )
    parameters = (("law", law.kind), ("knots", str(len(law.knots))), ("arms", str(arms)))
    return Step("fit", parameters, message)
