"""Fit of the aging law to the counterforce of specimens in several ovens.

Forces are fitted, with the F0 of every specimen free: one noisy reading of F0 moves all ratios
of a specimen together. The temperature of every oven has an error of its own, with the prior
:math:`N(0, s_T)`. The zero of the load cell drifts by the same force for all specimens: the force
left on a hot specimen separates drift from the chemical relaxation of a cool one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.base.provenance import list_sources
from dashpot.datamodel.checks import caution_checks
from dashpot.datamodel.machine import Machine
from dashpot.extensions.materials.csr import checks
from dashpot.extensions.materials.csr.datamodel import Aging, CSRTest, Oven
from dashpot.extensions.materials.csr.law import (
    ONE_SIDED_QUANTILE,
    THOUSAND_HOURS,
    AgingLaw,
    retained_fraction,
)
from dashpot.extensions.materials.csr.preprocess import Readings, collect_readings
from dashpot.numerics.inference.covariance_estimate import Estimate, estimate, score, white_noise
from dashpot.numerics.least_squares import Parameter, Problem, Rows, require_optimum
from dashpot.solids.shift_laws import GAS_CONSTANT

USUAL_OVEN, WORST_OVEN = 1.0, 30.0
"""Standard deviation of an oven's temperature, K: the usual one, and the largest accepted."""
USUAL_DRIFT = 0.03
"""Drift of a load cell's zero, in parts of F0 in 1000 h: standard deviation if none is stated."""
_USUAL_SCATTER, _MAX_OVEN_ERROR = 0.01, 6.0
"""Usual scatter of a reading, in parts of F0; largest error of a temperature, in standard
deviations."""
_ENERGY_UNIT = 1e4
"""J/mol in a unit of the activation energy."""
_PHYSICAL, _ACTIVATION, _EXPONENT = (
    Parameter(-0.1, 0.25, 0.01), Parameter(-10, 60, 0.3), Parameter(-1, 1, 0.1),
)  # fmt: skip
_FIXED_PARAMETERS = {"exponential": (3,), "stretched": ()}
"""Indices of the parameters (physical loss, ln tau, energy, ln exponent) fixed at 0 by each law."""


def fit_aging(records: Sequence[CSRTest], *, machine: Machine | None = None) -> Aging:
    """Fit the aging law to the specimens of one compound, shape and method.

    Parameters
    ----------
    records : sequence of CSRTest
    machine : Machine, optional
        How well the temperature of each oven is known, by default to 1 K: two ovens then show no
        error of the activation energy. How the load cell drifts, one standard deviation, by
        default 3 % of the force in 1000 h.

    Raises
    ------
    DataError, FitError
        If the readings are not of one lot, or no law follows them.
    """
    machine = machine or Machine()
    machine.refuse_unused("oven", "drift", subject="compression stress relaxation")
    if machine.oven is not None and machine.oven > WORST_OVEN:
        raise DataError(
            f"an oven's temperature is said to be known to {machine.oven:.4g} K; expected 0 to "
            f"{WORST_OVEN:g} K. Write it in K: --machine oven=1K"
        )
    readings, sd = collect_readings(records), USUAL_OVEN if machine.oven is None else machine.oven
    mean_force = float(np.mean(np.concatenate([record.force for record in records])))
    drift = USUAL_DRIFT if machine.drift is None else machine.drift * THOUSAND_HOURS / mean_force
    uncertainty = _fit_oven_rates(readings, drift)
    ovens = readings.ovens(uncertainty)
    orders: dict[str, float] = {}
    law, strain = _limit_rate(uncertainty, ovens[-1]), None
    if ovens[-1].significance >= checks.MIN_SIGNIFICANCE:
        is_oven_stated = machine.oven is not None
        law, orders, strain = _fit_arrhenius(
            readings, uncertainty, ovens, (sd, drift), is_oven_stated=is_oven_stated
        )
        if machine.drift is None and strain is not None:  # which a drift nobody saw may hide
            fit_without_drift = _fit_oven_rates(readings, 0.0)
            curvature = _fit_arrhenius(
                readings,
                fit_without_drift,
                readings.ovens(fit_without_drift),
                (sd, 0.0),
                is_oven_stated=is_oven_stated,
            )[2]
            strain = max(strain, curvature or 0.0)
    aging = Aging(
        law, ovens, float(readings.time.max()), tuple(orders.items()),
        float(np.sqrt(uncertainty.noises[0].power)), sd, (), list_sources(records),
    )  # fmt: skip
    checked_checks = checks.run_checks(aging, readings, uncertainty, strain, drift=drift)
    return replace(aging, checks=(*checked_checks, *caution_checks(aging.sources)))


def _build_problem(
    readings: Readings,
    parameters: Sequence[Parameter],
    rates: Callable[[FloatArray], tuple[FloatArray, float]],
    prior_sds: Sequence[float],
    scatter: float,
) -> Problem:
    """Return all forces by a physical loss and the rate of every oven.

    The last parameters are `prior_sds` in their standard deviations, with a prior each: errors of
    ovens, if `rates` has any, and a drift, in parts of F0 in 1000 h; below what weighs them.
    """
    values = [sd for sd in prior_sds if sd > 0]
    specimen_columns = np.eye(readings.specimens)[readings.specimen_number]
    derivative = np.zeros((len(values), readings.specimens))
    drift_force = readings.time / THOUSAND_HOURS * readings.force_scale * prior_sds[-1]

    def model(theta: FloatArray) -> Rows:
        rate, exponent = rates(theta)
        shape = retained_fraction(readings.time, float(theta[0]), rate[readings.oven], exponent)
        prior_deviations = theta[len(theta) - len(values) :]
        force = (
            readings.force - drift_force * prior_deviations[-1] if prior_sds[-1] else readings.force
        )
        y = np.concatenate((force, -scatter * prior_deviations))
        return Rows(y, np.vstack((shape[:, None] * specimen_columns, derivative)))

    all_parameters = [
        *parameters,
        *(Parameter(-_MAX_OVEN_ERROR, _MAX_OVEN_ERROR, 1.0) for _ in values),
    ]
    return Problem(model, all_parameters, priors=len(values))


def _fit_oven_rates(readings: Readings, drift: float) -> Estimate:
    """Return the fit of one rate for each oven, which also gives the scatter of a reading."""
    ovens = len(readings.temperature)
    parameters = [_PHYSICAL, *(Parameter(-2, 200, 0.1) for _ in range(ovens))]
    values = np.array(
        [readings.force[readings.oven == k].min() for k in range(len(readings.temperature))]
    )
    start = np.maximum(-np.log(np.clip(values, 0.01, 1.0)) - 0.06, 0.01)
    theta, scatter = np.array([0.02, *start, *[0.0] * (drift > 0)]), _USUAL_SCATTER
    # what a reading scatters by weighs the drift, and shows after the first
    for _ in range(2 if drift else 1):
        problem = _build_problem(
            readings,
            parameters,
            lambda theta: (theta[1 : 1 + ovens] / readings.last_reading_time, 1.0),
            [drift],
            scatter,
        )
        optimum = require_optimum(problem, [theta])
        noise = white_noise(optimum)
        theta, scatter = optimum.theta, float(np.sqrt(noise.power))
    return estimate(optimum, noises=[noise])


def _limit_rate(uncertainty: Estimate, hottest: Oven) -> AgingLaw:
    """Return the law without chemical aging, with its upper limit by the hottest oven."""
    covariance = np.zeros((4, 4))
    covariance[0, 0] = uncertainty.covariance[0, 0]
    fastest = max(hottest.rate, 0.0) + ONE_SIDED_QUANTILE * hottest.rate_error
    return AgingLaw(
        float(uncertainty.optimum.theta[0]), -float(np.log(fastest)), 0.0, 1.0, hottest.temperature,
        covariance, uncertainty.quantile(), is_lower_bound=True,
    )  # fmt: skip


def _fit_arrhenius(
    readings: Readings,
    uncertainty: Estimate,
    ovens: Sequence[Oven],
    prior_sds: tuple[float, float],
    *,
    is_oven_stated: bool,
) -> tuple[AgingLaw, dict[str, float], float | None]:
    """Return the law of all ovens, the BIC of each exponent, and the misfit of Arrhenius' line."""
    kelvin, power, has_several_ovens = (
        readings.temperature,
        uncertainty.noises[0].power,
        len(ovens) > 1,
    )
    sd, drift = prior_sds
    mean_inverse_kelvin, oven_count = (
        float(1 / np.mean(1 / kelvin)),
        len(ovens) if has_several_ovens and sd else 0,
    )
    inverse_kelvin_difference = (1 / kelvin - 1 / mean_inverse_kelvin) / GAS_CONSTANT

    def rates(theta: FloatArray) -> tuple[FloatArray, float]:
        oven_temperature = kelvin + sd * theta[4 : 4 + oven_count] if oven_count else kelvin
        slope = (
            _ENERGY_UNIT
            * theta[2]
            * (1 / oven_temperature - 1 / mean_inverse_kelvin)
            / GAS_CONSTANT
        )
        return np.exp(-theta[1] - slope), float(np.exp(theta[3]))

    fastest = max(oven.rate for oven in ovens)
    log_time = -np.log([max(oven.rate, 1e-3 * fastest) for oven in ovens])
    energy, log_tau = (
        np.polyfit(_ENERGY_UNIT * inverse_kelvin_difference, log_time, 1)
        if has_several_ovens
        else (0.0, log_time[0])
    )
    chemical = Parameter(log_tau - 20, log_tau + 20, 0.1)
    all_parameters = [_PHYSICAL, chemical, _ACTIVATION, _EXPONENT]
    full_problem = _build_problem(
        readings, all_parameters, rates, [*[sd] * oven_count, drift], float(np.sqrt(power))
    )
    zeros = [0.0] * (1 + oven_count + (drift > 0))
    start = np.array([uncertainty.optimum.theta[0], log_tau, energy, *zeros])
    estimates = {}
    for name, fixed_indices in _FIXED_PARAMETERS.items():
        problem, fixed_parameters = (
            full_problem,
            [*fixed_indices, *([] if has_several_ovens else [2])],
        )
        for i in fixed_parameters:
            problem = problem.fix_parameter(i, 0.0)
        optimum = require_optimum(problem, [np.delete(start, fixed_parameters)])
        estimates[name] = (
            fixed_parameters,
            estimate(optimum, noises=[white_noise(optimum, power)]),
        )
    count = len(readings.time)
    orders = {name: score(estimate.optimum, count) for name, (_, estimate) in estimates.items()}
    fixed_parameters, resolved_estimate = estimates[min(orders, key=lambda name: orders[name])]
    values, covariance = np.zeros(4), np.zeros((4, 4))
    free = [i for i in range(4) if i not in fixed_parameters]
    values[free] = resolved_estimate.optimum.theta[: len(free)]
    covariance[np.ix_(free, free)] = resolved_estimate.covariance[: len(free), : len(free)]
    if (
        len(ovens) == 2 and not is_oven_stated
    ):  # nothing but their temperatures could show its error
        covariance[2], covariance[:, 2] = 0.0, 0.0
        covariance[2, 2] = np.inf
    parameter_units = np.array([1.0, 1.0, _ENERGY_UNIT, 1.0])
    physical, tau, energy, exponent = (values * parameter_units).tolist()
    law = AgingLaw(
        physical, tau, energy, float(np.exp(exponent)), mean_inverse_kelvin,
        covariance * np.outer(parameter_units, parameter_units),
        resolved_estimate.quantile(),
    )  # fmt: skip
    if len(ovens) < 3:
        return law, orders, None
    extra_misfit = resolved_estimate.optimum.cost - uncertainty.optimum.cost
    return law, orders, extra_misfit / power / (len(ovens) - 2)
