r"""Rate dependence of load deflection: spring and dashpot by compression, and Maxwell arms.

.. math:: F = F_e(x) + c(x)\,\dot x + \sum_j k_j \int_0^t e^{-(t-u)/\tau_j}\,dx(u)

The arms are those of a linear model, unlike those of one relaxation function under a nonlinear
law (:mod:`~dashpot.extensions.materials.cld.multi_speed_fit`). BIC decides. At given relaxation
times all is linear: tangents of :math:`F_e` on hats, c on hats, k, each >= 0. Source:
E. Dikmen and I. Basdogan, ESDA2006-95402.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray
from dashpot.datamodel.fit import Fit
from dashpot.extensions.materials.cld import checks
from dashpot.extensions.materials.cld.datamodel import CLD, RateLaw
from dashpot.extensions.materials.cld.equilibrium_curve import make_law, place_knots
from dashpot.extensions.materials.cld.multi_speed_fit import (
    DECISIVE,
    DownsampledRecord,
    thin_records,
)
from dashpot.fitting.nonlinear_ramp.quasi_linear import integrate_hats
from dashpot.numerics.design_matrices.recorded_motion import compute_arm_columns
from dashpot.numerics.inference.covariance_estimate import estimate, score
from dashpot.numerics.inference.model_order import bic
from dashpot.numerics.least_squares import Optimum, Parameter, Problem, Rows, require_optimum

DAMPING_KNOTS = 7
MAX_ARMS = 2
_CONTACT = 0.01
"""Standard deviation of first contact over the depth: a dashpot's force jumps there."""


class _Data(NamedTuple):
    """Records, the knots of c and of the law, the depth, m, and the noise, N."""

    records: Sequence[DownsampledRecord]
    damping_knots: FloatArray
    law_knots: FloatArray
    depth: float
    noise: float


def fit_rate(specimens: Sequence[CLD], fit: Fit) -> RateLaw:
    """Fit a rate-dependent spring and dashpot to load deflection tests of one seal at some speeds.

    Parameters
    ----------
    specimens : sequence of CLD
        With clocks, at two speeds or more.
    fit : Fit
        One law with one relaxation function, as
        :func:`~dashpot.extensions.materials.cld.multi_speed_fit.fit_speeds` fits it to the same
        tests.
    """
    fine_record, records = thin_records(specimens)
    depth = float(fine_record[-1])
    strokes = [
        specimen.cycle.depth / specimen.cycle.speed
        for specimen in specimens
        if specimen.cycle.speed
    ]
    window = np.log([min(strokes) / 20, 3 * max(strokes)])
    of = _Data(
        records, place_knots(fine_record[1:], depth, DAMPING_KNOTS), fine_record, depth,
        max(specimen.noise for specimen in specimens),
    )  # fmt: skip
    candidates = [_fit_next_arm(of, np.zeros(len(records)), None)]
    for _ in range(MAX_ARMS):
        candidates.append(_fit_next_arm(of, candidates[-1].theta, window))
    effective = estimate(
        candidates[-1], parts=_split_rows(of), prior_variance=of.noise**2
    ).effective
    scores = [score(optimum, effective) for optimum in candidates]
    best = 0
    while best + 1 < len(candidates) and scores[best] - scores[best + 1] >= DECISIVE:
        best += 1
    return _build_rate_law(specimens, fit, of, candidates[best])


def _split_rows(data: _Data) -> list[int]:
    """Return rows of each record."""
    return [int(_select_moving_samples(record).sum()) for record in data.records]


def _make_hat_weights(x: FloatArray, knots: FloatArray) -> FloatArray:
    """Return a straight line between knots as weights of its values there, shape (n, knots)."""
    return np.stack([np.interp(x, knots, values) for values in np.eye(len(knots))], axis=1)


def _compute_rows(data: _Data, theta: FloatArray) -> Rows:
    """Return the rows at relaxation times, ln s, and places of first contact, in their deviations.

    The priors of these come last.
    """
    ln_tau, offsets = np.split(theta, [-len(data.records)])
    parts, targets = [], []
    for record, contact_shift in zip(data.records, offsets * _CONTACT * data.depth, strict=True):
        is_moving = _select_moving_samples(record)
        x, v = record.compression[is_moving] + contact_shift, record.velocity[is_moving]
        compression = np.maximum(record.compression + contact_shift, 0.0)
        q, _ = compute_arm_columns(record.time, compression, np.exp(ln_tau), derivative=False)
        damping = _make_hat_weights(x, data.damping_knots) * v[:, None]
        parts.append(
            np.concatenate((integrate_hats(x, data.law_knots), damping, q[is_moving]), axis=1)
        )
        targets.append(record.force[is_moving])
    A = np.concatenate((*parts, np.zeros((len(offsets), parts[0].shape[1]))))
    return Rows(np.concatenate((*targets, -data.noise * offsets)), A)


def _select_moving_samples(record: DownsampledRecord) -> BoolArray:
    """Return the samples of the chosen cycle in contact, but for those beside a turning point."""
    direction = np.sign(record.velocity)
    is_steady = (direction == np.roll(direction, 1)) & (direction == np.roll(direction, -1))
    values = np.asarray(record.is_in_contact & is_steady)
    values[: record.first_sample] = False
    return values


def _fit_next_arm(data: _Data, previous_arms: FloatArray, window: FloatArray | None) -> Optimum:
    """Return the best fit from an earlier one, with one more arm at the best place in a window."""
    starts = [previous_arms]
    if window is not None:
        starts = [
            np.insert(previous_arms, 0, at) for at in np.linspace(window[0], window[1], 7)[1:-1]
        ]
    parameters = [Parameter()] * len(starts[0])
    problem = Problem(
        partial(_compute_rows, data), parameters, positive=True, priors=len(data.records)
    )
    start = min(starts, key=lambda values: problem.solve_linear(values).cost)
    return require_optimum(problem, [start], max_steps=40, step_tolerance=1e-6, cost_tolerance=1e-8)


def _build_rate_law(specimens: Sequence[CLD], fit: Fit, data: _Data, best: Optimum) -> RateLaw:
    first = len(data.law_knots)
    count, arms = first + len(data.damping_knots), len(best.theta) - len(data.records)
    is_arm_parameter = np.zeros(count + arms, dtype=bool)
    is_arm_parameter[first:count] = True  # of a damping of 0 the error is its bound
    uncertainty = estimate(
        best, parts=_split_rows(data), is_bounded=is_arm_parameter, prior_variance=data.noise**2
    )
    ln_tau_se, error = np.split(uncertainty.standard_error, [len(best.theta)])
    _, c, k = np.split(best.beta, [first, count])
    tau = np.exp(best.theta[:arms])
    arm_indices = [int(i) for i in np.argsort(tau) if k[i] > 0]
    n = len(best.residual)
    rms = float(np.sqrt(best.sse / n))
    kappa = min(
        (best.sse, uncertainty.kappa),
        (fit.estimate.residual.sse, fit.estimate.residual.variance_inflation),
    )[1]
    value = score(best, n / kappa)
    other_bic = bic(
        fit.estimate.residual.sse, effective=n / kappa, parameters=first + 2 * fit.model.arms
    )
    return RateLaw(
        make_law(uncertainty, data.law_knots, slice(len(best.theta), len(best.theta) + first)),
        tuple(data.damping_knots.tolist()),
        tuple(c.tolist()),
        tuple(error[first:count].tolist()),
        tuple(k[arm_indices].tolist()),
        tuple(tau[arm_indices].tolist()),
        tuple(error[count:][arm_indices].tolist()),
        tuple(ln_tau_se[:arms][arm_indices].tolist()),
        rms,
        value - other_bic,
        (
            checks.single_relaxation_explains_speeds(other_bic - value),
            checks.speeds_residual_small(
                rms, data.noise, max(specimen.cycle.peak for specimen in specimens)
            ),
        ),
    )
