"""From a judged solution to the fit that people read."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.engine.blocks import Block
from dashpot.engine.order import Choice
from dashpot.provenance import Step
from dashpot.relaxation import checks
from dashpot.relaxation.band import informed_band
from dashpot.relaxation.design import Design
from dashpot.relaxation.estimate import Estimate, Score
from dashpot.relaxation.fit import AtDepth, Fit, OrderScore
from dashpot.relaxation.profiles import profiles
from dashpot.relaxation.record_checks import depth_doubt, encoder_step
from dashpot.relaxation.records import RampHold
from dashpot.relaxation.telling import nuisance_of, proof_of, residual_of
from dashpot.relaxation.verdict import all_checks, solid_of, status_of
from dashpot.solids.maxwell import GeneralizedMaxwell


def outcome(
    records: Sequence[RampHold],
    blocks: Sequence[Block],
    samples: Sequence[Block],
    estimate: Estimate,
    scores: Sequence[Score],
    *,
    choice: Choice | None,
    asked: int | None,
    design: Design,
    thorough: bool,
) -> Fit:
    """Return the fit that a judged solution makes.

    Parameters
    ----------
    records : sequence of RampHold
    blocks, samples : sequences of Block
        Their compressed data, and all of it.
    estimate : Estimate
        The chosen number of arms.
    scores : sequence of Score
        Every number of arms tried.
    choice : Choice or None
        How the rules chose; None if the user did.
    asked : int or None
        The number of arms the user asked for; None if the rules chose.
    design : Design
    thorough : bool
    """
    solution = estimate.solution
    method, depth_law = design.method, design.depth_law
    deepest = max(range(len(records)), key=lambda i: records[i].depth)
    suffix = f"@{deepest}" if depth_law else ""
    if method == "hold":
        estimate = estimate.with_depth_doubt(
            [depth_doubt(record) for record in records], shared=not depth_law
        )
    model = solid_of(solution, suffix)
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
        *all_checks(records, estimate, model, np.sqrt(np.diag(covariance)), choice, method=method),
        checks.frequencies_informed(band),
    )
    return Fit(
        model=model,
        status=status_of(solution, asked, found),
        method=method,
        residual=residual_of(estimate),
        parameters=names,
        covariance=covariance,
        dof=estimate.dof,
        band=band,
        orders=tuple(_order(score, suffix) for score in scores),
        certificate=proof_of(blocks, solution),
        profiles=profiles(blocks, estimate, suffix=suffix, every_sample=samples),
        nuisance=nuisance_of(estimate, tests=len(records)),
        checks=(*(check for record in records for check in record.checks), *found),
        source=tuple(record.source for record in records if record.source is not None),
        steps=(
            *(step for record in records for step in record.steps),
            *_motion_steps(records, design),
            _step(records, model, design, asked=asked, thorough=thorough),
        ),
        by_depth=_by_depth(records, estimate) if depth_law else (),
        specimen=records[deepest].specimen,
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
        solution.order, solution.sse, score.bic, score.significant, solid_of(solution, suffix)
    )


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


def _motion_steps(records: Sequence[RampHold], design: Design) -> tuple[Step, ...]:
    """Return what was taken out of each recorded displacement before the fit answered to it."""
    if design.method == "hold":
        return ()
    steps = []
    for record in records:
        count, noise = encoder_step(record), record.displacement_noise
        if count > 0 or noise > 0:
            says = (
                f"read the displacement between counts of {1e6 * count:.3g} um and averaged its "
                f"scatter of {1e6 * noise:.3g} um where the motion allows; the force is as recorded"
            )
            told = (("count", f"{count:.6g} m"), ("noise", f"{noise:.6g} m"))
            steps.append(Step("motion", told, says))
    return tuple(steps)
