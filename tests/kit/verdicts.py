"""Verdicts of dashpot on records of known truth, and whether the result is wrong.

    found = judged(trial(KINDS[3], seed=7))      # a Judged: verdict, failed checks, errors
    print(table({"sound": [found]}))             # shares of use, use with care, do not use

A result is wrong if the stiffness at the end of the hold, K* somewhere in the band that the fit
says it informs, or the tangent at the depth misses the truth by more than `WRONG`, and by more than
three of the standard errors that the fit gives.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

import dashpot as dp
from dashpot.base.errors import DashpotError
from dashpot.fitting.relaxation import fit as fit_tests
from dashpot.preprocessing.prepare import prepare
from kit.trials import Trial, relaxation_test

#: relative errors that make a result wrong: of k(T), of K* in the informed band, of the tangent
WRONG = {"k_end": 0.02, "band": 0.05, "tangent": 0.05}
#: frequencies of the bounds, Hz
LINES = (1.0, 5.0, 12.7)


@dataclass(frozen=True)
class Outcome:
    """A verdict, what failed, and how far the result is from the truth."""

    name: str
    use: str
    failed: tuple[tuple[str, str], ...]
    errors: Mapping[str, float]
    inside: bool | None = None

    @property
    def wrong(self) -> bool:
        """The result misses the truth."""
        return any(self.errors.get(name, 0.0) > limit for name, limit in WRONG.items())


def evaluate_record(trial: Trial, *, bounds: bool = False) -> Outcome:
    """Prepare and fit a record, and hold verdict and result against the truth.

    A record that is refused is one that is not to be used. `bounds` asks whether the limits over
    unseen arms hold the truth at every line of `LINES`.
    """
    try:
        record = prepare(relaxation_test(trial))
        fit = fit_tests(record)
    except DashpotError as error:
        return Outcome(trial.name, "do not use", ((type(error).__name__, "stop"),), {})
    failed = tuple((check.name, check.grade) for check in fit.checks if check.failed)
    inside = _is_inside(trial, fit, record) if bounds else None
    return Outcome(trial.name, fit.verdict.use, failed, _errors(trial, fit), inside)


def _errors(trial: Trial, fit: dp.Fit) -> dict[str, float]:
    """Relative errors; 0 where three standard errors explain them."""
    omega = 2 * np.pi * np.geomspace(fit.band[0], max(fit.band[1], fit.band[0]), 21)
    true, stiffness = trial.seal.stiffness(omega), fit.model.complex_stiffness(omega=omega)
    k, tau = (np.array(values)[:, None] for values in (fit.model.k, fit.model.tau))
    passed = 1j * omega * tau / (1 + 1j * omega * tau)
    decay = np.exp(-trial.end / tau)
    end = float(fit.model.relaxation(trial.end))
    missed = np.abs(stiffness - true)
    honest = missed < 3 * _error(fit, passed, k * passed / (1 + 1j * omega * tau))
    off = abs(end - trial.k_end())
    expected = off < 3 * float(_error(fit, decay, k * decay * trial.end / tau)[0])
    tangent = trial.tangent(trial.bench.depth) * trial.seal.k_inf
    by_law = tangent if fit.elastic_law is None else fit.elastic_law.tangent(trial.bench.depth)
    return {
        "k_end": 0.0 if expected else off / trial.k_end(),
        "band": float(np.max(np.where(honest, 0.0, missed / np.abs(true)))),
        # of one law, k_inf apart: the secant is judged by the two others
        "tangent": abs(float(by_law) / max(fit.model.k_inf, 1e-9) * trial.seal.k_inf / tangent - 1),
    }


def _error(fit: dp.Fit, of_k, of_ln_tau):
    """Standard error of k_inf + sum k h(tau), of its derivatives by k and ln tau."""
    n = fit.model.arms
    slopes = np.vstack((np.ones((1, of_k.shape[1])), of_k, of_ln_tau))
    covariance = fit.covariance[: 1 + 2 * n, : 1 + 2 * n]
    return np.sqrt(np.einsum("im,ij,jm->m", slopes.conj(), covariance, slopes).real)


def _is_inside(trial: Trial, fit: dp.Fit, record: dp.RampHold) -> bool:
    from dashpot.fitting.prediction_bounds import unresolved_arm_band

    band = unresolved_arm_band(fit, record, LINES)
    true = trial.stiffness_at(2 * np.pi * np.asarray(LINES), trial.bench.depth)
    return bool(
        np.all((band.storage[:, 0] <= true.real) & (true.real <= band.storage[:, 1]))
        and np.all((band.loss[:, 0] <= true.imag) & (true.imag <= band.loss[:, 1]))
    )


def table(groups: Mapping[str, Iterable[Outcome]]) -> str:
    """The shares of each verdict, and of the wrong results that are said to be of use."""
    head = ("records", "n", "use", "care", "not", "wrong", "of them use")
    rows = ["{:<22}{:>4}{:>7}{:>7}{:>7}{:>7}{:>13}".format(*head)]
    for name, group in groups.items():
        result = tuple(group)
        share = Counter(item.use for item in result)
        wrong = [item for item in result if item.wrong]
        used = sum(item.use == "use" for item in wrong)
        shares = (share[use] / len(result) for use in ("use", "use with care", "do not use"))
        rows.append(
            f"{name:<22}{len(result):>4}"
            + "".join(f"{100 * part:>6.0f}%" for part in shares)
            + f"{len(wrong):>7}{used:>13}"
        )
    return "\n".join(rows)


def failures(outcomes: Iterable[Outcome]) -> Counter[tuple[str, str]]:
    """How often each check failed, by grade."""
    return Counter(failed for outcome in outcomes for failed in outcome.failed)
