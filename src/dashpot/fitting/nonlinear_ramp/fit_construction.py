"""From an elastic law and its solid to a fit."""

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
from dashpot.fitting.check_suite import Residuals, run_relaxation_checks
from dashpot.fitting.checks.solid import frequencies_informed, loss_factor_known
from dashpot.fitting.design_matrix import FitSetup, compressed
from dashpot.fitting.fit_construction import SolidEstimate, build_fit, provenance_of
from dashpot.fitting.nonlinear_ramp import checks
from dashpot.fitting.nonlinear_ramp.elastic_law_estimate import RampLaw
from dashpot.fitting.nuisance_priors import delay_prior, last_of_hold, significant_drift
from dashpot.fitting.relaxation_data import RelaxationData
from dashpot.fitting.relaxation_likelihood import hold_only_data
from dashpot.fitting.uncertainty.admissible_spectra import AdmissibleSpectra
from dashpot.fitting.uncertainty.band_limits import band_of_hold
from dashpot.fitting.uncertainty.rig_sensitivity import clock_sensitivity
from dashpot.fitting.uncertainty.valid_band import informed_band
from dashpot.solids.maxwell import GeneralizedMaxwell


def ramp_fit(
    tests: Sequence[RampHold],
    found: RampLaw,
    *,
    asked: int | None = None,
    by_depth: tuple[DepthStiffness, ...] = (),
    further: Sequence[Check] = (),
    end: EndOfHold | None = None,
    unseen: FloatArray | None = None,
    spectra: AdmissibleSpectra | None = None,
) -> Fit:
    """Return the fit of tests that share an elastic law.

    Parameters
    ----------
    tests : sequence of RampHold
    found : RampLaw
    asked : int or None
        Number of arms asked for; None if the holds chose.
    by_depth, further
        The stiffnesses of each test, and checks besides those of the law.
    end : EndOfHold or None
        What the holds know of their end.
    unseen : array, shape (p, d), optional
        What each doubt of the rigs adds to the parameters: it is in every interval, and in nothing
        that a check judges by the noise.
    spectra : AdmissibleSpectra, optional
        What the holds do not reject: they end the valid band.
    """
    model, estimate = found.model, _doubted(found.estimate, found.model, tests)
    found = replace(found, estimate=estimate)
    residual = estimate.residual
    band = informed_band(
        tests,
        compressed(tests, FitSetup("full")),
        stiffness=max(model.k_0, 1e-300),
        noise=max(residual.rms * np.sqrt(residual.kappa), 1e-300),
    )
    known = None
    if spectra is not None:
        band, known = band_of_hold(spectra, model, band)
    noticed = [check for test in tests for check in test.checks]
    answers = (
        *law_checks(tests, found, end),
        *further,
        frequencies_informed(band),
        loss_factor_known(known),
    )
    return build_fit(
        SolidEstimate(
            model,
            estimate if unseen is None else estimate.with_rig(unseen),
            fewer=asked is not None and model.arms < asked,
        ),
        Evidence(
            band, checks=(*noticed, *answers), by_depth=by_depth, end_of_hold=end, band_error=known
        ),
        provenance_of("full", tests, _step(tests, found)),
        elastic_law=replace(found.law, ratio_se=_shape_error(found)),
    )


def held_ramps(tests: Sequence[RampHold], found: RampLaw) -> list[RelaxationData]:
    """The holds of tests that share an elastic law, with what their rigs may have done unseen."""
    return [
        hold_only_data(
            test,
            found.model,
            residual[test.settled.start - test.hold.stop :],
            law=found.law,
        )
        for test, residual in zip(tests, found.residuals, strict=True)
    ]


def depth_error(test: RampHold) -> float:
    """Of the depth that was held, of which every stiffness has as much: relative, one deviation."""
    return float(np.hypot(test.depth_doubt, test.contact_error / test.depth))


def _doubted(
    estimate: ParameterEstimate, model: GeneralizedMaxwell, tests: Sequence[RampHold]
) -> ParameterEstimate:
    r"""Return the estimate with what depth and clock of the tests leave unknown.

    A relative error of the depth scales every stiffness, a delay :math:`\delta` of the ramp each
    arm by :math:`\delta/\tau_j`; of n tests each counts :math:`1/\sqrt n`.
    """
    depth = [depth_error(test) for test in tests]
    scaled = np.concatenate(([model.k_inf], model.k, np.zeros(model.arms)))
    off = float(np.sqrt(np.mean(np.square(depth)) / len(tests)))
    by = np.column_stack((off * scaled, clock_sensitivity(tests, model)))
    return replace(estimate, covariance=estimate.covariance + by @ by.T)


def _shape_error(found: RampLaw) -> tuple[float, ...]:
    """Standard errors of the law's shape at its knots; none of a straight line."""
    if found.law.kind == "linear":
        return ()
    shape = np.diag(found.law_covariance)[-len(found.law.knots) :]
    return tuple(float(error) for error in np.sqrt(np.maximum(shape, 0.0)))


def law_checks(
    tests: Sequence[RampHold], found: RampLaw, end: EndOfHold | None
) -> tuple[Check, ...]:
    """Return every check of the records, of the solid and of its elastic law."""
    residual = found.estimate.residual
    error = np.sqrt(np.diag(found.estimate.covariance))
    # the ramp's own misfit is priced, and judged by ramp_followed
    held = [
        one[test.settled.start - test.hold.stop :]
        for one, test in zip(found.residuals, tests, strict=True)
    ]
    left = Residuals(held, residual.rms, residual.kappa)
    return (
        *run_relaxation_checks(tests, found.model, error, left, end),
        *ramp_checks(tests, found, end),
    )


def ramp_checks(
    tests: Sequence[RampHold], found: RampLaw, end: EndOfHold | None
) -> tuple[Check, ...]:
    """Return the checks of elastic law and load cell, each at its worst over the records."""
    rows = found.followed.weighted.solid.rows
    worst = int(np.argmax(found.missed))
    values = found.followed.nuisance
    error = np.sqrt(np.diag(found.estimate.covariance))
    deepest = int(np.argmax(rows.depths))
    followed = checks.ramp_followed(
        found.missed[worst],
        max(rows.noise[worst], found.hold.rms[worst]) / rows.peak(worst),
        found.discrepancy[worst],
        found.law.kind,
    )
    return (
        followed,
        checks.hold_followed(
            found.rho, [one / rows.peak(i) for i, one in enumerate(found.followed.hold)]
        ),
        checks.tangent_told(found.law, different_ramps(tests)),
        checks.k_inf_believable(
            found.model,
            float(np.hypot(error[0], found.hold.plateau_error[deepest])),
            end_stiffness(tests[deepest], rows.known[deepest].offset.mean),
            tests[deepest].hold_time,
        ),
        checks.offset_believable(
            [
                (values[f"offset@{i}"], *known.offset, significant_drift(tests[i]).offset)
                for i, known in enumerate(rows.known)
            ]
        ),
        checks.drift_believable(
            [
                (values[f"drift@{i}"], *known.drift, significant_drift(tests[i]).drift)
                for i, known in enumerate(rows.known)
            ],
            np.inf if end is None else end.beyond,
        ),
        checks.baseline_agrees([(known.slope.mean, known.conflict) for known in rows.known]),
        checks.clocks_agree(
            [
                (late.value, late.standard_error, delay_prior(test).sd)
                for late, test in zip(_of_kind("delay", found), tests, strict=False)
            ]
        ),
    )


def _of_kind(kind: str, found: RampLaw) -> list[Nuisance]:
    """The nuisances of a kind, in the order of the tests, where they were fitted."""
    return [one for one in found.estimate.nuisance if one.name.startswith(kind)]


def end_stiffness(test: RampHold, rest: float) -> float:
    """Return the force over the last twentieth of the hold, less that at rest, over x, N/m."""
    held = last_of_hold(test)
    return float(np.mean(test.force[held]) - rest) / float(np.mean(test.displacement[held]))


def different_ramps(tests: Sequence[RampHold]) -> int:
    """Return how many ramps differ in rate or depth by a tenth or more."""
    told: list[tuple[float, float]] = []
    for test in tests:
        here = (test.depth / test.ramp_time, test.depth)
        if all(max(abs(np.log(a / b)) for a, b in zip(here, one, strict=True)) >= 0.1
               for one in told):  # fmt: skip
            told.append(here)
    return len(told)


def _step(tests: Sequence[RampHold], found: RampLaw) -> Step:
    law, arms = found.law, found.model.arms
    plural = f"{len(tests)} tests" if len(tests) > 1 else "one test"
    shape = "a linear elastic law" if law.kind == "linear" else (
        f"an elastic law whose tangent is linear between {len(law.knots)} knots"
    )  # fmt: skip
    says = (
        f"fitted a generalized Maxwell solid with {arms} arm{'s' * (arms != 1)} and {shape} to "
        f"{plural}, holds first"
    )
    parameters = (("law", law.kind), ("knots", str(len(law.knots))), ("arms", str(arms)))
    return Step("fit", parameters, says)
