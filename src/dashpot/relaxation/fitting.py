"""From prepared relaxation tests to a fitted solid."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Literal

import numpy as np

from dashpot.engine.blocks import Block
from dashpot.engine.descent import Stack
from dashpot.engine.order import DECISIVE, Choice, choose
from dashpot.engine.separable import Jacobian, full_jacobian, solve, solve_orders
from dashpot.engine.uncertainty import Noise, pale, uneven
from dashpot.errors import FitError
from dashpot.relaxation.design import (
    NUISANCE,
    Design,
    Method,
    compressed,
    eq5_obstacle,
    every_sample,
)
from dashpot.relaxation.encoder import Encoder
from dashpot.relaxation.estimate import Score, by_record, estimated, residual_noises, scored
from dashpot.relaxation.fit import Fit
from dashpot.relaxation.outcome import outcome
from dashpot.relaxation.record_checks import encoder_step
from dashpot.relaxation.records import RampHold
from dashpot.relaxation.telling import asked_arms


def fit(
    tests: RampHold | Sequence[RampHold],
    *,
    arms: int | Literal["auto"] = "auto",
    method: Method = "full",
    thorough: bool = False,
    depth_law: bool = False,
    nuisance: Sequence[str] = NUISANCE,
    max_arms: int = 6,
) -> Fit:
    r"""Fit a generalized Maxwell solid to one prepared test, or to several at once.

    ``method="full"`` answers the *recorded* motion x(t) from the first sample to the end of the
    hold, freed of the encoder's counts and noise where it shows any
    (:func:`~dashpot.relaxation.denoising.true_motion`), with the tare and drift of the load cell
    as nuisance terms; the force is never filtered,

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
        effective sample size and the significance of every arm both support; under noise as slow
        as the arms, by fits in the metric of that noise (:mod:`dashpot.engine.order`).
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
    most = asked_arms(arms, max_arms)
    _checked_method(records, method)
    design = Design(method, depth_law, _checked_nuisance(nuisance))
    peak = max(float(np.abs(record.force).max()) for record in records)
    blocks = compressed(records, design)
    samples = every_sample(records, design, blocks)
    if arms == "auto":
        most = min(most, _determinable(blocks))
    trial, noises = _tried(
        blocks, samples, most, every=arms != "auto" or thorough, peak=peak, thorough=thorough
    )
    exhausted = len(trial) - 1 < most
    choice = _choice(trial, exhausted=exhausted)

    @lru_cache(maxsize=1)  # the order that the rules support is, as a rule, the one chosen
    def whole(order: int) -> Jacobian:
        return full_jacobian(samples, trial[order].solution)

    # least squares is a fair judge where the noise is even to the arms that a rule supports
    supported = min(max(choice.by_bic, choice.by_significance, 1), len(trial) - 1)
    if (
        arms == "auto"
        and not pale(noises)
        and uneven(by_record(whole(supported), samples)[1], noises)
    ):
        from dashpot.relaxation.evidence import in_noise_metric

        largest = whole(len(trial) - 1)
        anew = in_noise_metric(trial, samples, largest, peak=peak, thorough=thorough)
        if anew is not None:
            trial, choice = anew, _choice(anew, exhausted=exhausted, in_noise_metric=True)
    chosen = choice.arms if arms == "auto" else min(most, len(trial) - 1)
    estimate = estimated(
        trial[chosen].solution,
        samples,
        peak=peak,
        encoders=_encoders(records, design),
        whole=whole(chosen),
    )
    return outcome(
        records,
        blocks,
        samples,
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


def _determinable(blocks: Sequence[Block]) -> int:
    """Return how many arms the samples could determine at all."""
    stack = Stack(blocks)
    return max(0, (stack.samples - len(stack.names) - 1) // (1 + len(stack.groups)))


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
            encoder_step(record),
            record.onset,
            record.contact_error,
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
    every: bool,
    peak: float,
    thorough: bool,
) -> tuple[tuple[Score, ...], tuple[Noise, ...]]:
    """Return the numbers of arms from none up, judged by the residuals of the largest.

    The noise of each record in these is returned beside. Unless `every` number is asked for, only
    one more is tried where all further arms together would gain less than BIC asks for one.
    """
    solutions = [solve(blocks, 0)]
    if most:
        stack = Stack(blocks)
        one_more = 0.0 if every else (1 + len(stack.groups)) * float(np.log(stack.samples))
        found = solve_orders(blocks, most, negligible=one_more, thorough=thorough)
        solutions += [solution for solution in found if solution.order]
    noises = residual_noises(solutions[-1], samples, peak=peak)
    effective = sum(noise.effective for noise in noises)
    scores = tuple(
        scored(solution, blocks, samples, effective=effective, peak=peak) for solution in solutions
    )
    return scores, noises


def _choice(trial: Sequence[Score], *, exhausted: bool, in_noise_metric: bool = False) -> Choice:
    return choose(
        range(len(trial)),
        [score.bic for score in trial],
        [score.significant for score in trial],
        exhausted=exhausted,
        in_noise_metric=in_noise_metric,
        decisive=DECISIVE,
    )
