r"""Joint fit of one elastic law and one set of arms to load deflection at several speeds.

The quasi-linear seal of :mod:`~dashpot.extensions.materials.cld.equilibrium_curve` is fitted to the
chosen cycle of each record, its law on hats with tangents >= 0. Within the cycle the plate drives
the seal, :math:`e = F_e(x)`; before it, and in air, the relaxed force that drives is the exact
inverse of the force recorded so far, so that neither the softening of earlier cycles nor a seal
that the plate has left is taken for relaxation. The law is linear at each trial of g and tau
(variable projection).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Literal, NamedTuple

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray, block_means
from dashpot.base.errors import FitError
from dashpot.base.provenance import Step, list_sources
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.fit_diagnostics import Evidence, OrderScore, Provenance
from dashpot.datamodel.parameter_estimate import ParameterEstimate, Residual, parameter_names
from dashpot.extensions.materials.cld import checks
from dashpot.extensions.materials.cld.datamodel import CLD, SAME_SPEED
from dashpot.extensions.materials.cld.equilibrium_curve import (
    average_slope,
    find_loaded_samples,
    get_clock,
    make_law,
    place_knots,
)
from dashpot.extensions.materials.cld.local_stiffness import delay_channel
from dashpot.extensions.materials.systematic_error import estimate_parameter_shift
from dashpot.fitting.fit_construction import SolidEstimate, build_fit
from dashpot.fitting.nonlinear_ramp.quasi_linear import integrate_hats
from dashpot.fitting.nuisance_priors import Prior
from dashpot.numerics.design_matrices.recorded_motion import compute_arm_columns, recursion
from dashpot.numerics.inference.covariance_estimate import estimate, score
from dashpot.numerics.least_squares import Optimum, Parameter, Problem, Rows, require_optimum
from dashpot.solids.maxwell import GeneralizedMaxwell

KNOTS = 13
MAX_ARMS = 3
_PER_STROKE = 120
_MAX_RESIDUAL_RATIO = 0.98
"""Ratio of residuals above which no further arm is tried."""
DECISIVE = 10.0
"""Decrease of BIC that a further arm needs."""
_SIGNIFICANT_DELAY = 3.0
"""Standard errors of a delay from which on a record is taken to have one."""
_MIN_G, _MAX_G = 1e-3, 20.0
"""Smallest and largest g."""


class DownsampledRecord(NamedTuple):
    """Record downsampled to the end of the chosen cycle, with hat functions of its samples."""

    time: FloatArray
    compression: FloatArray
    velocity: FloatArray
    force: FloatArray
    is_in_contact: BoolArray
    first_sample: int
    hat_functions: FloatArray


def fit_speeds(specimens: Sequence[CLD], *, arms: int | Literal["auto"] = "auto") -> Fit:
    """Fit elastic law and relaxation function to load deflection of one seal at several speeds.

    Parameters
    ----------
    specimens : sequence of CLD
        Records with clocks, of one specimen or of equal ones.
    arms : int or "auto"
        ``"auto"`` takes as many, up to three, as lower BIC by ten each.

    Returns
    -------
    Fit
        Its model is the secant one at the least depth of the evaluated cycles.

    Raises
    ------
    FitError
        If there is no clock, or one speed alone.
    """
    speeds = [
        specimen.cycle.speed
        for specimen in specimens
        if get_clock(specimen).size and specimen.cycle.speed
    ]
    if len(speeds) < 2 or max(speeds) < SAME_SPEED * min(speeds):
        raise FitError(
            "one speed alone does not separate relaxation from the elastic law; expected "
            "tests at two or more, a decade apart or farther"
        )
    knots, records = thin_records(specimens)
    strokes = [
        specimen.cycle.depth / speed for specimen, speed in zip(specimens, speeds, strict=True)
    ]
    window = min(strokes) / 20, 3 * max(strokes)
    counts = range(MAX_ARMS + 1) if arms == "auto" else [arms]
    candidates = _fit_arm_counts(records, window, counts)
    delays = _find_delays(specimens, records, knots, candidates[-1])
    if any(abs(delay.mean) > _SIGNIFICANT_DELAY * delay.sd for delay in delays):
        records = [
            _delay_record(record, specimen, knots, delay.mean)
            for record, specimen, delay in zip(records, specimens, delays, strict=True)
        ]
        candidates = _fit_arm_counts(records, window, counts)
    # what is left of too few arms is no noise: all are weighed by that of the most
    effective = estimate(candidates[-1], parts=_split_rows(records)).effective
    scores = [score(optimum, effective) for optimum in candidates]
    best = _select_arm_count(records, knots, candidates, scores)
    orders = tuple(
        OrderScore(
            len(optimum.theta) // 2, optimum.sse, bic, number <= best, _make_model(knots, optimum)
        )
        for number, (bic, optimum) in enumerate(zip(scores, candidates, strict=True))
    )
    return _build_fit(
        specimens,
        records,
        candidates[best],
        knots=knots,
        strokes=strokes,
        orders=orders,
        delays=delays,
    )


def _delay_record(
    record: DownsampledRecord, cld: CLD, knots: FloatArray, delay: float
) -> DownsampledRecord:
    """Return a record with its force delayed, s, and its first contact deeper accordingly."""
    hat_columns = downsample_record(
        cld, knots, offset=-delay * (cld.cycle.speed or 0.0)
    ).hat_functions
    return record._replace(
        force=delay_channel(record.time, record.force, delay), hat_functions=hat_columns
    )


def _compute_row_change(
    records: Sequence[DownsampledRecord], index: int, replacement: DownsampledRecord, best: Optimum
) -> FloatArray:
    """Return the change of the rows by another record in place of one."""
    rows = _compute_rows([*records[:index], replacement, *records[index + 1 :]], best.theta)
    return rows.A @ best.beta - rows.y + best.all_residuals


def _find_delays(
    specimens: Sequence[CLD], records: Sequence[DownsampledRecord], knots: FloatArray, best: Optimum
) -> list[Prior]:
    r"""Return the delay of each force, s, at which one relaxation function fits the records best.

    Of a delay with prior standard deviation s, whose change of the rows beyond all parameters is d,
    the mean is :math:`s\,d \cdot r/(d \cdot d + \gamma)` and the variance
    :math:`s^2 \gamma/(d \cdot d + \gamma)`, with the residual r and its power.
    """
    power = best.sse / len(best.residual) * estimate(best, parts=_split_rows(records)).kappa
    J = best.jacobian[:, best.free]
    priors = []
    for i, specimen in enumerate(specimens):
        change = _compute_row_change(
            records, i, _delay_record(records[i], specimen, knots, specimen.delay_sd), best
        )
        difference = change - J @ np.linalg.lstsq(J, change, rcond=1e-12)[0]
        gain = float(difference @ difference) + power
        mean, part = float(difference @ best.all_residuals) / gain, float(np.sqrt(power / gain))
        priors.append(Prior(specimen.delay_sd * mean, specimen.delay_sd * part))
    return priors


def _fit_arm_counts(
    records: Sequence[DownsampledRecord], window: tuple[float, float], counts: Sequence[int]
) -> list[Optimum]:
    """Return the best fit of each number of arms, up to the first that does not pay."""
    candidates: list[Optimum] = []
    for count in counts:
        candidates.append(
            _fit_next_arm(records, count, window, candidates[-1].theta if candidates else None)
        )
        if len(candidates) > 1 and candidates[-1].sse > _MAX_RESIDUAL_RATIO**2 * candidates[-2].sse:
            break
    return candidates


def _select_arm_count(
    records: Sequence[DownsampledRecord],
    knots: FloatArray,
    candidates: Sequence[Optimum],
    scores: Sequence[float],
) -> int:
    """Return the index of the last fit that lowers BIC decisively with every arm determined."""
    for i in range(len(candidates) - 1, 0, -1):
        if scores[i - 1] - scores[i] >= DECISIVE and _has_determined_arms(
            records, knots, candidates[i]
        ):
            return i
    return 0


def thin_records(specimens: Sequence[CLD]) -> tuple[FloatArray, list[DownsampledRecord]]:
    """Return the knots of a law to the least depth of tests, m, and their records to it."""
    compressions = np.concatenate(
        [specimen.compression[find_loaded_samples(specimen)] for specimen in specimens]
    )
    knots = place_knots(compressions, min(specimen.cycle.depth for specimen in specimens), KNOTS)
    return knots, [downsample_record(specimen, knots) for specimen in specimens]


def _has_determined_arms(
    records: Sequence[DownsampledRecord], knots: FloatArray, best: Optimum
) -> bool:
    """Return whether every arm exceeds three errors, and ln tau is known to 0.5."""
    arms = len(best.theta) // 2
    quantity = estimate(best, parts=_split_rows(records)).derive_quantity(
        partial(_make_solid, knots)
    )
    k, error = quantity.values[1 : 1 + arms], quantity.standard_error[1:]
    ln_tau_se = error[arms : 2 * arms]
    return bool((k > 3 * error[:arms]).all() and (ln_tau_se < checks.LARGEST_LN_TAU_SE).all())


def downsample_record(cld: CLD, knots: FloatArray, *, offset: float = 0.0) -> DownsampledRecord:
    """Return means of neighbours, so that a stroke of the chosen cycle has some hundred rows."""
    last_stroke = cld.unloading or cld.loading
    stop = last_stroke.samples.stop
    rows = np.zeros(len(cld.force), dtype=bool)
    rows[find_loaded_samples(cld)] = True
    rows &= cld.compression <= 1.005 * knots[-1]
    block = max(1, len(cld.loading.force) // _PER_STROKE)
    clock = get_clock(cld)
    time, x, velocity, force, share = (
        block_means(np.asarray(values[:stop], dtype=float), block)
        for values in (clock, cld.compression, np.gradient(cld.compression, clock), cld.force, rows)
    )
    is_in_contact = share == 1.0  # a block that holds a turning point is not taken
    first = min(int(np.flatnonzero(is_in_contact)[0]), cld.loading.samples.start // block)
    hat_columns = np.where(is_in_contact[:, None], integrate_hats(x + offset, knots), 0.0)
    return DownsampledRecord(time, x, velocity, force, is_in_contact, first, hat_columns[first:])


def _build_relaxation(theta: FloatArray) -> GeneralizedMaxwell:
    g, tau = np.exp(theta).reshape(2, -1)
    return GeneralizedMaxwell(1.0, tuple(g.tolist()), tuple(tau.tolist()))


def _split_rows(records: Sequence[DownsampledRecord]) -> list[int]:
    """Return rows of each record."""
    return [int(record.is_in_contact[record.first_sample :].sum()) for record in records]


def _compute_rows(records: Sequence[DownsampledRecord], theta: FloatArray) -> Rows:
    """Return the least-squares rows at ln g and ln tau of the arms; tangents are linear."""
    relaxation = _build_relaxation(theta)
    columns, targets = [], []
    for record in records:
        # where the plate does not drive it, the seal is where the recorded force has brought it
        free_compression = np.where(
            record.is_in_contact, 0.0, relaxation.displacement(record.time, record.force)
        )
        answer, hat_columns = free_compression.copy(), record.hat_functions.copy()
        steps = np.diff(record.hat_functions, axis=0)
        step = np.diff(record.time[record.first_sample :])[:, None, None]
        g, tau = np.asarray(relaxation.k), np.asarray(relaxation.tau)
        if len(tau):
            answer += (
                compute_arm_columns(record.time, free_compression, tau, derivative=False)[0] @ g
            )
            # every hat under every arm side by side
            z = step / tau[:, None]
            decay_less_one = np.expm1(-z)
            first = np.tile(record.hat_functions[0], (len(tau), 1))
            arms = recursion(1 + decay_less_one, -decay_less_one / z * steps[:, None], first)
            hat_columns += np.einsum("nap,a->np", arms, g)
        is_in_contact = record.is_in_contact[record.first_sample :]
        columns.append(hat_columns[is_in_contact])
        targets.append((record.force - answer)[record.first_sample :][is_in_contact])
    return Rows(np.concatenate(targets), np.concatenate(columns))


def _fit_next_arm(
    records: Sequence[DownsampledRecord],
    arms: int,
    window: tuple[float, float],
    previous_arms: FloatArray | None,
) -> Optimum:
    """Return the best fit with one arm more, started with that arm at three times."""
    low, high = np.log(window).tolist()
    problem = Problem(
        partial(_compute_rows, records),
        [Parameter(float(np.log(_MIN_G)), float(np.log(_MAX_G)))] * arms
        + [Parameter(low - 1, high + 1)] * arms,
        positive=True,
    )
    if arms == 0:
        return require_optimum(problem)
    values = np.empty((2, 0)) if previous_arms is None else previous_arms.reshape(2, -1)
    log_tau_values = np.linspace(low, high, 5)[1:-1]
    if values.shape[1] + 1 < arms:  # a number that was asked for
        values = np.array([np.full(arms - 1, np.log(0.2)), np.linspace(low, high, arms + 1)[1:-1]])
    starts = [
        np.column_stack((values, [np.log(0.15), log_tau])).ravel()
        for log_tau in log_tau_values.tolist()
    ]
    start = min(starts, key=lambda row: problem.solve_linear(row).cost)
    best = require_optimum(problem, [start], max_steps=40, step_tolerance=1e-5, cost_tolerance=1e-6)
    g, tau = best.theta.reshape(2, -1)
    order = np.argsort(tau)
    return replace(
        problem.solve_linear(np.concatenate((g[order], tau[order]))), stationary=best.stationary
    )


def _make_solid(knots: FloatArray, values: FloatArray) -> FloatArray:
    """Return k_inf and k, N/m, and ln tau by relaxation parameters and tangents."""
    theta, slope = np.split(values, [-len(knots)])
    k_inf = average_slope(slope, knots)
    g, ln_tau = np.split(theta, 2)
    return np.concatenate(([k_inf], np.exp(g) * k_inf, ln_tau))


def _make_model(knots: FloatArray, best: Optimum) -> GeneralizedMaxwell:
    return _build_relaxation(best.theta) * average_slope(best.beta, knots)


def _build_fit(
    specimens: Sequence[CLD],
    records: Sequence[DownsampledRecord],
    best: Optimum,
    *,
    knots: FloatArray,
    strokes: Sequence[float],
    orders: tuple[OrderScore, ...],
    delays: Sequence[Prior],
) -> Fit:
    model, n = _make_model(knots, best), len(best.residual)
    uncertainty = estimate(best, parts=_split_rows(records))
    # beside the noise, what both zeros and the clock leave unknown: a record with one of them an
    # error off
    for i, specimen in enumerate(specimens):
        downsampled = downsample_record(specimen, knots, offset=specimen.contact_se)
        force_variant = records[i]._replace(force=records[i].force + specimen.zero_se)
        delay_variant = _delay_record(records[i], specimen, knots, delays[i].sd)
        for variant in (downsampled, force_variant, delay_variant):
            uncertainty = uncertainty.add_parameter_error(
                estimate_parameter_shift(
                    uncertainty, _compute_row_change(records, i, variant, best)
                )
            )
    covariance = uncertainty.derive_quantity(partial(_make_solid, knots)).covariance
    rms = float(np.sqrt(best.sse / n))
    peak = max(cld.cycle.peak for cld in specimens)
    law = make_law(uncertainty, knots, slice(-len(knots), None))
    error = np.sqrt(np.diag(covariance))[1 + model.arms :]
    speeds = [cld.cycle.speed or np.nan for cld in specimens]
    requested_checks = (
        checks.speeds_spread(max(speeds) / min(speeds)),
        checks.speeds_residual_small(rms, max(cld.noise for cld in specimens), peak),
        checks.slowest_stroke_quasi_static(max(model.tau, default=None), max(strokes)),
        checks.relaxation_times_determined(float(error.max()) if model.arms else None),
    )
    step = Step(
        "fit",
        (("arms", str(model.arms)), ("knots", str(len(knots)))),
        f"fitted an elastic law and {model.arms} arms to load deflection at "
        f"{len(specimens)} speeds",
    )
    parameter_estimate = ParameterEstimate(
        parameter_names(model.arms),
        covariance,
        uncertainty.dof,
        Residual(n, best.sse, rms, uncertainty.kappa),
    )
    band = 1 / (2 * np.pi * max(strokes)), 1 / (np.pi * min(strokes))
    return build_fit(
        SolidEstimate(model, parameter_estimate),
        Evidence(band, orders, checks=requested_checks),
        Provenance("cld", list_sources(specimens), (step,), specimens[0].specimen),
        elastic_law=law,
    )
