"""What to make of a solution: its status, and every check put to it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot._arrays import FloatArray
from dashpot.checks import Check
from dashpot.engine.order import Choice
from dashpot.engine.separable import Solution, solve
from dashpot.relaxation import checks
from dashpot.relaxation.design import Design, Method, compressed, eq5_obstacle
from dashpot.relaxation.estimate import Estimate
from dashpot.relaxation.fit import Status
from dashpot.relaxation.record_checks import of_records
from dashpot.relaxation.records import RampHold
from dashpot.solids.maxwell import GeneralizedMaxwell

# a step that would remove less of the residual than this is rounding, whatever it does to tau
_STATIONARY = 1e-6


def solid_of(solution: Solution, suffix: str) -> GeneralizedMaxwell:
    """Return the solid of one arm group; an arm that this group does not show is left out."""
    k = solution.arms[solution.groups.index(f"k{suffix}")] if solution.order else np.zeros(0)
    return GeneralizedMaxwell(
        max(solution.coefficient(f"k_inf{suffix}"), 0.0),
        tuple(k[k > 0]),
        tuple(solution.tau[k > 0]),
    )


def status_of(solution: Solution, asked: int | None, found: Sequence[Check]) -> Status:
    """Return how the fit ended: the first thing that went wrong, or that nothing did."""
    failed = {check.name for check in found if not check.passed}
    if "force_relaxes" in failed:
        return Status.FORCE_RISES
    stationary = solution.converged or solution.relative_offset < _STATIONARY
    if not stationary and not solution.at_bound.any():
        return Status.NOT_CONVERGED
    if asked is not None and solution.order < asked:
        return Status.FEWER_ARMS
    if solution.at_bound.any() or "tau_inside_window" in failed:
        return Status.TAU_AT_BOUND
    if failed & {"arms_supported", "k_inf_positive"}:
        return Status.NOT_IDENTIFIED
    return Status.CONVERGED


def all_checks(
    records: Sequence[RampHold],
    estimate: Estimate,
    model: GeneralizedMaxwell,
    error: FloatArray,
    choice: Choice | None,
    *,
    method: Method,
) -> tuple[Check, ...]:
    """Return every check of the records and of the fit; `error` as the rows of the model."""
    arms = model.arms
    found = [
        *of_records(records, method=method),
        checks.hold_long_enough(model, records),
        checks.arms_distinct(model),
        checks.arms_supported(
            model,
            error[1 : 1 + arms],
            error[1 + arms :],
            needed=choice is not None and choice.fewer_rejected,
        ),
        checks.tau_inside_window(model, records),
        checks.k_inf_positive(model, float(error[0])),
        checks.residuals_random(
            estimate.kappa,
            float(np.sqrt(estimate.sse / estimate.samples)),
            max(record.force_noise for record in records),
        ),
        checks.step_bias(model, records),
        checks.fast_arm_visible(model, records),
        checks.drift_told_from_arm(model, _drift_correlation(estimate), float(error[-1])),
        checks.residuals_steady(estimate.residuals),
    ]
    if choice is not None:
        found.append(checks.order_agreed(choice))
    if method == "full" and len(estimate.solution.groups) == 1:
        found.append(checks.hold_and_full_agree(model, _by_eq5(records, arms), error))
    return tuple(found)


def _by_eq5(records: Sequence[RampHold], arms: int) -> GeneralizedMaxwell | None:
    """Return what eq. 5 on the holds says with as many arms, where it applies."""
    held = sum(len(record.time[record.hold]) for record in records)
    if held <= 1 + 2 * arms or any(eq5_obstacle(record) is not None for record in records):
        return None
    return solid_of(solve(compressed(records, Design("hold")), arms), "")


def _drift_correlation(estimate: Estimate) -> float | None:
    """Return the largest correlation between the slowest arm and a drift, None without either."""
    drifts = [i for i, name in enumerate(estimate.names) if name.startswith("drift@")]
    if not drifts or not estimate.solution.order:
        return None
    slow = estimate.names.index(f"ln_tau_{estimate.solution.order}")
    error = np.sqrt(np.diag(estimate.covariance))
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation = np.abs(estimate.covariance[slow, drifts] / (error[slow] * error[drifts]))
    return float(np.nan_to_num(correlation, nan=1.0).max())
