"""What every fit tells of its estimate: residuals, nuisances, the proof of its optimum."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.engine.blocks import Block
from dashpot.engine.certificate import certificate
from dashpot.engine.separable import Solution
from dashpot.errors import FitError
from dashpot.relaxation.estimate import Estimate
from dashpot.relaxation.fit import Certificate, Nuisance, Residual


def asked_arms(arms: object, max_arms: object) -> int:
    """Return the most arms to try.

    Raises
    ------
    FitError
        If `arms` is neither ``"auto"`` nor a whole number >= 0.
    """
    if arms == "auto":
        if not _whole(max_arms):
            raise FitError(f"max_arms = {max_arms!r}; expected a whole number >= 0")
        return int(max_arms)  # type: ignore[call-overload,no-any-return]
    if not _whole(arms):
        raise FitError(
            f'arms = {arms!r}; expected "auto" or a whole number of arms, 0 for a spring alone'
        )
    return int(arms)  # type: ignore[call-overload,no-any-return]


def residual_of(estimate: Estimate) -> Residual:
    """Return the statistics of the weighted residuals."""
    weights = [float(residual @ residual) for residual in estimate.residuals]
    watson = [noise.durbin_watson for noise in estimate.noises]
    return Residual(
        n=estimate.samples,
        sse=estimate.sse,
        rms=float(np.sqrt(estimate.sse / estimate.samples)),
        kappa=estimate.kappa,
        durbin_watson=float(np.average(watson, weights=weights)) if sum(weights) > 0 else 2.0,
    )


def nuisance_of(estimate: Estimate, *, tests: int) -> tuple[Nuisance, ...]:
    """Return offset and drift of the load cell of each relaxation test."""
    units = {"offset": "N", "drift": "N/s"}
    found = []
    for name in estimate.solution.fixed_names:
        kind, _, test = name.partition("@")
        if kind in units:
            found.append(
                Nuisance(
                    name=f"{kind} of test {int(test) + 1}" if tests > 1 else kind,
                    value=estimate.solution.coefficient(name),
                    standard_error=estimate.standard_error(name),
                    unit=units[kind],
                )
            )
    return tuple(found)


def proof_of(blocks: Sequence[Block], solution: Solution) -> Certificate:
    """Return how far the optimum can be from the best positive spectrum."""
    proof = certificate(blocks, solution)
    if proof.optimal:
        says = "no positive spectrum, with any number of arms, fits better"
    else:
        says = (
            f"the best positive spectrum with any number of arms would lower the sum of squares "
            f"by {100 * proof.gap:.2g} %"
        )
    return Certificate(proof.optimal, proof.gap, proof.tau, says)


def _whole(number: object) -> bool:
    whole = isinstance(number, int | np.integer) and not isinstance(number, bool)
    return whole and number >= 0  # type: ignore[operator]
