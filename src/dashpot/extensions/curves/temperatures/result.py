"""Result of a fit over several temperatures: shifts, law and provenance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.option_fields import ShiftLaw, Vertical
from dashpot.base.provenance import Step, list_sources, list_steps
from dashpot.base.units import celsius
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.fit_diagnostics import Provenance
from dashpot.datamodel.shift_factors import TemperatureShifts
from dashpot.extensions.curves.datamodel.sample_temperatures import make_shifts
from dashpot.extensions.curves.shift_law_fit import ShiftLawFit, fit_shift_law
from dashpot.extensions.curves.temperatures.joint_covariance import (
    build_test_nuisances,
    compute_test_residual,
    list_column_names,
)
from dashpot.extensions.curves.temperatures.joint_optimum import ThermalOptimum
from dashpot.extensions.curves.temperatures.marginalised_data import SingleTemperatureTest
from dashpot.fitting.fit_construction import (
    NO_EVIDENCE,
    SolidEstimate,
    build_fit,
    estimate_without_errors,
)
from dashpot.solids.elastic import ElasticLaw


def law_of(best: ThermalOptimum, covariance: FloatArray, law: ShiftLaw) -> ShiftLawFit:
    """Return the law through the shifts, whose covariance begins with that of log10 a_T."""
    joint, point, count = best.joint, best.point, len(best.joint.temperatures)
    return fit_shift_law(
        joint.temperatures,
        point.log_a / np.log(10.0),
        covariance[:count, :count],
        reference=float(joint.temperatures[joint.reference]),
        law=law,
    )


def shifts_of(
    best: ThermalOptimum,
    vertical: Vertical,
    law_fit: ShiftLawFit,
    covariance: FloatArray,
    cross: FloatArray,
) -> TemperatureShifts:
    """Return the shifts with their errors."""
    joint, point = best.joint, best.point
    log10_a, b = point.log_a / np.log(10.0), np.exp(point.log_b)
    return TemperatureShifts(
        law_fit.law,
        make_shifts(joint.temperatures, log10_a, b, covariance),
        covariance,
        law_fit.parameters,
        law_fit.covariance,
        vertical,
        slope=point.slope,
        cross=cross,
    )


def _deepest(best: ThermalOptimum) -> SingleTemperatureTest:
    """Return the test at the reference whose elastic law and specimen are those of the solid."""
    joint = best.joint
    tests_at_reference = [
        test for test, i in zip(best.tests, joint.at, strict=True) if i == joint.reference
    ]
    return max(tests_at_reference, key=lambda test: test.record.depth)


def elastic_law(best: ThermalOptimum) -> ElasticLaw:
    """Return the elastic law at the reference."""
    deepest_test, k_inf = _deepest(best), best.point.k_inf
    if deepest_test.law is None:
        return ElasticLaw.linear(k_inf, deepest_test.record.depth)
    return replace(deepest_test.law, stiffness=k_inf)


def provenance(best: ThermalOptimum, shifts: TemperatureShifts) -> Provenance:
    """Return which records were fitted, and how."""
    records = [test.record for test in best.tests]
    return Provenance(
        "full",
        list_sources(records),
        (*list_steps(records), _step(best, shifts)),
        replace(_deepest(best).record.specimen, temperature=shifts.reference),
    )


def _step(best: ThermalOptimum, shifts: TemperatureShifts) -> Step:
    arms = best.point.order
    temperatures_text = ", ".join(celsius(shift.temperature) for shift in shifts.shifts)
    message = (
        f"fitted a generalized Maxwell model with {arms} arm{'s' * (arms != 1)} to "
        f"{len(best.tests)} tests at {temperatures_text}; the model is that of "
        f"{celsius(shifts.reference)}, its shifts follow the {shifts.law.kind} law"
    )
    parameters = (
        ("arms", "auto" if best.choice is not None else str(arms)),
        ("thorough", str(best.thorough).lower()),
        ("vertical", shifts.vertical),
        ("temperatures_K", ", ".join(repr(float(test.temperature)) for test in best.tests)),
        ("reference_K", repr(shifts.reference)),
        ("law", shifts.law.kind),
    )
    return Step("fit", parameters, message)


def build_point_fit(
    best: ThermalOptimum, vertical: Vertical, law: ShiftLaw, *, requested_arms: int
) -> Fit:
    """Return the optimum as a fit without errors.

    The law is laid through the shifts as white noise would leave them.
    """
    joint, point = best.joint, best.point
    turn = joint.shift_rows(joint.names(point.order))
    law_fit = law_of(best, turn @ joint.covariance(point) @ turn.T, law)
    unknown = np.where(turn.any(axis=1), np.inf, 0.0)
    shifts = shifts_of(best, vertical, law_fit, np.diag(unknown), np.empty(0))
    residuals = [compute_test_residual(joint, test, i, point) for i, test in enumerate(best.tests)]
    residual, values = (
        np.concatenate([getattr(test_residual, part) for test_residual in residuals])
        for part in ("residual", "nuisance_values")
    )
    nuisance = build_test_nuisances(list_column_names(best.tests), values, point, lambda _: np.inf)
    estimate = estimate_without_errors(
        point.solid, len(residual), float(residual @ residual), nuisance
    )
    return build_fit(
        SolidEstimate(point.solid, estimate, has_fewer_arms=point.order < requested_arms),
        NO_EVIDENCE,
        provenance(best, shifts),
        elastic_law=elastic_law(best),
        temperatures=shifts,
    )
