"""From prepared relaxation tests to a fitted solid."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from dashpot._arrays import FloatArray
from dashpot.checks import Check
from dashpot.engine.blocks import Block
from dashpot.engine.certificate import certificate
from dashpot.engine.order import Choice, choose
from dashpot.engine.separable import Solution, solve, solve_orders
from dashpot.errors import FitError
from dashpot.provenance import Step
from dashpot.relaxation import checks as questions
from dashpot.relaxation.band import informed_band
from dashpot.relaxation.design import (
    NUISANCE,
    Design,
    Method,
    compressed,
    eq5_obstacle,
    every_sample,
)
from dashpot.relaxation.encoder import Encoder
from dashpot.relaxation.estimate import (
    Estimate,
    Score,
    effective_samples,
    estimated,
    scored,
)
from dashpot.relaxation.fit import (
    AtDepth,
    Certificate,
    Fit,
    Nuisance,
    OrderScore,
    Residual,
    Status,
)
from dashpot.relaxation.profiles import profiles
from dashpot.relaxation.records import RampHold
from dashpot.solids.maxwell import GeneralizedMaxwell

# a step that would remove less of the residual than this is rounding, whatever it does to tau
_STATIONARY = 1e-6


def fit(
    tests: RampHold | Sequence[RampHold],
    *,
    arms: int | Literal["auto"] = "auto",
    method: Method = "full",
    thorough: bool = False,
    depth_law: bool = False,
    nuisance: Sequence[str] = NUISANCE,
    max_arms: int = 4,
) -> Fit:
    r"""Fit a generalized Maxwell solid to one prepared test, or to several at once.

    ``method="full"`` answers the *recorded* motion x(t) from the first sample to the end of the
    hold, with the tare and drift of the load cell as nuisance terms,

    .. math:: F(t) = k_\infty x(t) + \sum_j k_j \int_0^t e^{-(t-u)/\tau_j} \dot x(u)\,du
              + F_0 + \dot F t

    ``method="hold"`` is the paper's eq. (5) on the hold after an ideal ramp of rate A = x_h/c,

    .. math:: F(t) = A \Bigl[k_\infty c + \sum_j b_j e^{-(t-c)/\tau_j}
              (1 - e^{-c/\tau_j})\Bigr], \qquad b_j = k_j \tau_j

    No starting guess is needed.

    Parameters
    ----------
    tests : RampHold or sequence of RampHold
        What :func:`~dashpot.relaxation.preparation.prepare` returns. Several tests share their
        relaxation times, and their stiffnesses unless `depth_law`; each has its own tare and
        drift.
    arms : int or "auto"
        Number of Maxwell arms; 0 is a spring. ``"auto"`` takes the number that BIC with the
        effective sample size and the significance of every arm both support.
    method : "full" or "hold"
    thorough : bool
        Add quasi-random starts.
    depth_law : bool
        Give each test its own k_inf and k; ``Fit.by_depth`` holds them, ``Fit.model`` is the
        deepest test's.
    nuisance : sequence of str
        Which terms of the load cell ``method="full"`` fits along with the solid: ``"offset"``
        and ``"drift"``. Eq. (5) has none.
    max_arms : int
        The most that ``"auto"`` tries.

    Returns
    -------
    Fit

    Raises
    ------
    FitError
        If an option makes no sense, a test is not prepared, or eq. (5) does not apply to the
        recorded history.
    """
    records = _records(tests)
    most = _most_arms(arms, max_arms)
    _checked_method(records, method)
    design = Design(method, depth_law, _checked_nuisance(nuisance))
    peak = max(float(np.abs(record.force).max()) for record in records)
    blocks = compressed(records, design)
    samples = every_sample(records, design, blocks)
    trial = _tried(blocks, samples, most, peak=peak, thorough=thorough)
    choice = choose(
        range(len(trial)),
        [score.bic for score in trial],
        [score.significant for score in trial],
    )
    chosen = choice.arms if arms == "auto" else min(most, len(trial) - 1)
    estimate = estimated(
        trial[chosen].solution, samples, peak=peak, encoders=_encoders(records, design)
    )
    return _fit(
        records,
        blocks,
        estimate,
        trial,
        choice=choice if arms == "auto" else None,
        asked=None if arms == "auto" else most,
        design=design,
        thorough=thorough,
    )


def _records(tests: RampHold | Sequence[RampHold]) -> tuple[RampHold, ...]:
    records = (tests,) if isinstance(tests, RampHold) else tuple(tests)
    if not records:
        raise FitError("there is no test to fit; expected at least one prepared test")
    for record in records:
        if not isinstance(record, RampHold):
            raise FitError(
                f"fit takes prepared tests, found a {type(record).__name__}; "
                "call fit(prepare(test))"
            )
    return records


def _most_arms(arms: object, max_arms: object) -> int:
    if arms == "auto":
        if not _whole(max_arms):
            raise FitError(f"max_arms = {max_arms!r}; expected a whole number >= 0")
        return int(max_arms)  # type: ignore[call-overload,no-any-return]
    if not _whole(arms):
        raise FitError(
            f'arms = {arms!r}; expected "auto" or a whole number of arms, 0 for a spring alone'
        )
    return int(arms)  # type: ignore[call-overload,no-any-return]


def _whole(number: object) -> bool:
    whole = isinstance(number, int | np.integer) and not isinstance(number, bool)
    return whole and number >= 0  # type: ignore[operator]


def _checked_method(records: Sequence[RampHold], method: str) -> None:
    if method not in ("full", "hold"):
        raise FitError(
            f'method = {method!r}; expected "full" (the recorded motion) or "hold" (eq. 5)'
        )
    if method == "full":
        return
    for number, record in enumerate(records, start=1):
        obstacle = eq5_obstacle(record)
        if obstacle is not None:
            which = f"test {number} of {len(records)}: " if len(records) > 1 else ""
            raise FitError(which + obstacle)


def _encoders(records: Sequence[RampHold], design: Design) -> tuple[Encoder, ...] | None:
    if design.method == "hold":
        return None
    return tuple(
        Encoder(
            record.time[: record.hold.stop],
            record.displacement[: record.hold.stop],
            questions.encoder_step(record),
        )
        for record in records
    )


def _checked_nuisance(nuisance: Sequence[str]) -> tuple[str, ...]:
    unknown = [name for name in nuisance if name not in NUISANCE]
    if isinstance(nuisance, str) or unknown:
        raise FitError(
            f"nuisance = {nuisance!r}; expected a tuple of names out of {', '.join(NUISANCE)}"
        )
    return tuple(name for name in NUISANCE if name in nuisance)


def _tried(
    blocks: Sequence[Block],
    samples: Sequence[Block],
    most: int,
    *,
    peak: float,
    thorough: bool,
) -> tuple[Score, ...]:
    """Return every number of arms from none up, judged by the residuals of the largest."""
    solutions = [solve(blocks, 0)]
    if most:
        solutions += [s for s in solve_orders(blocks, most, thorough=thorough) if s.order]
    effective = effective_samples(solutions[-1], samples, peak=peak)
    return tuple(
        scored(solution, blocks, samples, effective=effective, peak=peak) for solution in solutions
    )


def _fit(
    records: Sequence[RampHold],
    blocks: Sequence[Block],
    estimate: Estimate,
    scores: Sequence[Score],
    *,
    choice: Choice | None,
    asked: int | None,
    design: Design,
    thorough: bool,
) -> Fit:
    solution = estimate.solution
    method, depth_law = design.method, design.depth_law
    deepest = max(range(len(records)), key=lambda i: records[i].depth)
    suffix = f"@{deepest}" if depth_law else ""
    if method == "hold":
        estimate = estimate.with_depth_doubt(
            [questions.depth_doubt(record) for record in records], shared=not depth_law
        )
    model = _model(solution, suffix)
    names, index = _rows(estimate, suffix)
    covariance = estimate.covariance[np.ix_(index, index)]
    peak = max(float(np.abs(record.force).max()) for record in records)
    band = informed_band(
        records,
        blocks,
        stiffness=max(model.k_0, 1e-300),
        noise=max(estimate.spread, 1e-6 * peak, 1e-300),
    )
    found = (
        *_checks(records, estimate, model, np.sqrt(np.diag(covariance)), choice, method=method),
        questions.frequencies_informed(band),
    )
    return Fit(
        model=model,
        status=_status(solution, asked, found),
        method=method,
        residual=_residual(estimate),
        parameters=names,
        covariance=covariance,
        dof=estimate.dof,
        band=band,
        orders=tuple(_order(score, suffix) for score in scores),
        certificate=_certificate(blocks, solution),
        profiles=profiles(blocks, estimate, suffix=suffix),
        nuisance=_nuisance(estimate),
        checks=found,
        source=tuple(record.source for record in records if record.source is not None),
        steps=(
            *(step for record in records for step in record.steps),
            _step(records, model, design, asked=asked, thorough=thorough),
        ),
        by_depth=_by_depth(records, estimate) if depth_law else (),
        specimen=records[deepest].specimen,
    )


def _model(solution: Solution, suffix: str) -> GeneralizedMaxwell:
    """Return the solid of one arm group; an arm that this group does not show is left out."""
    k = solution.arms[solution.groups.index(f"k{suffix}")] if solution.order else np.zeros(0)
    return GeneralizedMaxwell(
        max(solution.coefficient(f"k_inf{suffix}"), 0.0),
        tuple(k[k > 0]),
        tuple(solution.tau[k > 0]),
    )


def _rows(estimate: Estimate, suffix: str) -> tuple[tuple[str, ...], list[int]]:
    """Return the names of the model's parameters and their rows in the covariance."""
    solution = estimate.solution
    k = solution.arms[solution.groups.index(f"k{suffix}")] if solution.order else np.zeros(0)
    there = np.flatnonzero(k > 0) + 1
    numbers = range(1, len(there) + 1)
    names = ("k_inf", *(f"k_{j}" for j in numbers), *(f"ln_tau_{j}" for j in numbers))
    rows = (
        f"k_inf{suffix}",
        *(f"k_{j}{suffix}" for j in there),
        *(f"ln_tau_{j}" for j in there),
    )
    return names, [estimate.names.index(row) for row in rows]


def _order(score: Score, suffix: str) -> OrderScore:
    solution = score.solution
    return OrderScore(
        solution.order, solution.sse, score.bic, score.significant, _model(solution, suffix)
    )


def _residual(estimate: Estimate) -> Residual:
    weights = [residual @ residual for residual in estimate.residuals]
    total = sum(weights)
    watson = [noise.durbin_watson for noise in estimate.noises]
    return Residual(
        n=estimate.samples,
        sse=estimate.sse,
        rms=float(np.sqrt(estimate.sse / estimate.samples)),
        kappa=estimate.kappa,
        durbin_watson=float(np.average(watson, weights=weights)) if total > 0 else 2.0,
    )


def _nuisance(estimate: Estimate) -> tuple[Nuisance, ...]:
    units = {"offset": "N", "drift": "N/s"}
    several = len(estimate.residuals) > 1
    found = []
    for name in estimate.solution.fixed_names:
        kind, _, test = name.partition("@")
        if kind in units:
            found.append(
                Nuisance(
                    name=f"{kind} of test {int(test) + 1}" if several else kind,
                    value=estimate.solution.coefficient(name),
                    standard_error=estimate.standard_error(name),
                    unit=units[kind],
                )
            )
    return tuple(found)


def _by_depth(records: Sequence[RampHold], estimate: Estimate) -> tuple[AtDepth, ...]:
    solution, arms = estimate.solution, range(1, estimate.solution.order + 1)
    found = [
        AtDepth(
            depth=record.depth,
            k_inf=solution.coefficient(f"k_inf@{i}"),
            k_inf_se=estimate.standard_error(f"k_inf@{i}"),
            k=tuple(float(solution.arms[solution.groups.index(f"k@{i}"), j - 1]) for j in arms),
            k_se=tuple(estimate.standard_error(f"k_{j}@{i}") for j in arms),
        )
        for i, record in enumerate(records)
    ]
    return tuple(sorted(found, key=lambda at: at.depth))


def _certificate(blocks: Sequence[Block], solution: Solution) -> Certificate:
    proof = certificate(blocks, solution)
    if proof.optimal:
        says = "no positive spectrum, with any number of arms, fits better"
    else:
        says = (
            f"the best positive spectrum with any number of arms would lower the sum of squares "
            f"by {100 * proof.gap:.2g} %"
        )
    return Certificate(proof.optimal, proof.gap, proof.tau, says)


def _status(solution: Solution, asked: int | None, found: Sequence[Check]) -> Status:
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


def _checks(
    records: Sequence[RampHold],
    estimate: Estimate,
    model: GeneralizedMaxwell,
    error: FloatArray,
    choice: Choice | None,
    *,
    method: Method,
) -> tuple[Check, ...]:
    arms = model.arms
    found = [
        *questions.of_records(records, method=method),
        questions.hold_long_enough(model, records),
        questions.arms_distinct(model),
        questions.arms_supported(model, error[1 : 1 + arms], error[1 + arms :]),
        questions.tau_inside_window(model, records),
        questions.k_inf_positive(model, float(error[0])),
        questions.residuals_random(
            estimate.kappa,
            float(np.sqrt(estimate.sse / estimate.samples)),
            max(record.force_noise for record in records),
        ),
        questions.step_bias(model, records),
        questions.fast_arm_visible(model, records),
        questions.drift_told_from_arm(model, _drift_correlation(estimate), float(error[-1])),
        questions.residuals_steady(estimate.residuals),
    ]
    if choice is not None:
        found.append(questions.order_agreed(choice.by_bic, choice.by_significance, choice.arms))
    if method == "full" and len(estimate.solution.groups) == 1:
        found.append(questions.hold_and_full_agree(model, _by_eq5(records, arms), error))
    return tuple(found)


def _by_eq5(records: Sequence[RampHold], arms: int) -> GeneralizedMaxwell | None:
    """Return what eq. 5 on the holds says with as many arms, where it applies."""
    if any(eq5_obstacle(record) is not None for record in records):
        return None
    return _model(solve(compressed(records, Design("hold")), arms), "")


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


def _step(
    records: Sequence[RampHold],
    model: GeneralizedMaxwell,
    design: Design,
    *,
    asked: int | None,
    thorough: bool,
) -> Step:
    options = (
        ("arms", "auto" if asked is None else str(asked)),
        ("method", design.method),
        ("thorough", str(thorough).lower()),
        ("depth_law", str(design.depth_law).lower()),
        ("nuisance", ", ".join(design.nuisance) or "none"),
    )
    plural = f"{len(records)} tests" if len(records) > 1 else "one test"
    says = (
        f"fitted a generalized Maxwell solid with {model.arms} arm{'s' * (model.arms != 1)} to "
        f"{plural} by method {design.method!r}"
    )
    return Step("fit", options, says)
