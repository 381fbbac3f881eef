"""The best solid for each number of arms, and the choice among them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.engine.blocks.block import Block
from dashpot.engine.inference.order import significant
from dashpot.fitting.identification.frf_data import FRFData
from dashpot.fitting.identification.likelihood import (
    Constraints,
    NuisancePriors,
    Parameters,
    Problem,
)
from dashpot.fitting.relaxation_data import RelaxationData, WeightedBlock
from dashpot.records.fit import Fit
from dashpot.solids.maxwell import GeneralizedMaxwell

# arms are sought this far, as a factor in time, beyond what the lines and tests could tell
BEYOND = 3.0
# an arm with less than this part of the stiffness has left
GONE = 1e-6
SMALLEST_SCATTER = 1e-9
# a criterion this much above the best ends the search for more arms
WORSE = 6.0
# relative fall of chi-square that ends a search, and the last descent
LOOSE, TIGHT = 1e-9, 1e-13


@dataclass(frozen=True, eq=False)
class Candidate:
    """The optimum for one number of arms, with or without a parallel dashpot."""

    problem: Problem
    theta: FloatArray
    cost: float
    bic: float
    converged: bool

    @property
    def point(self) -> Parameters:
        """The optimum in physical terms."""
        return self.problem.unpack(self.theta)

    def covariance(self) -> FloatArray:
        """Of the flat parameter vector."""
        jacobian = self.problem.jacobian(self.theta)
        return np.asarray(np.linalg.pinv(jacobian.T @ jacobian, rcond=1e-14, hermitian=True))

    def significant(self) -> bool:
        """Every arm has k > 3 SE and SE(ln tau) < 0.5."""
        n = self.problem.arms
        # stiffnesses are logarithms: their standard errors are relative
        se = np.sqrt(np.diag(self.covariance()))
        return significant(np.ones(n), se[1 : 1 + n], se[1 + n : 1 + 2 * n])


@dataclass(frozen=True, eq=False)
class Search:
    """Everything that the candidates have in common."""

    relaxations: tuple[RelaxationData, ...]
    frf_data: FRFData
    priors: NuisancePriors
    constraints: Constraints
    before: Fit | None

    def candidates(self, numbers: Sequence[int], *, dashpot: bool) -> list[Candidate]:
        """The optimum for each number of arms that keeps all its arms."""
        linear = self._linear(max(numbers), dashpot=dashpot)
        found = []
        for number in numbers:
            starts = [start for start in linear if start.model.arms == number]
            starts += self._spread(number, dashpot=dashpot)
            problem = self._problem(number, dashpot=dashpot)
            tries = [_descend(problem, problem.pack(start)) for start in starts]
            best = min(tries, key=lambda candidate: candidate.cost)
            model = best.point.model
            if all(k > GONE * model.k_0 for k in model.k):
                found.append(best)
            if found and best.bic > min(candidate.bic for candidate in found) + WORSE:
                break
        return found

    def refined(self, candidate: Candidate, scale: float) -> Candidate:
        """The same optimum with the scatter of the lines scaled."""
        problem = self._problem(
            candidate.problem.arms, dashpot=candidate.problem.dashpot, scale=scale
        )
        return _descend(problem, candidate.theta, tolerance=TIGHT)

    def rescaled(self, candidate: Candidate, scale: float) -> Candidate:
        """The candidate as it was found, its covariance with the scatter scaled."""
        problem = self._problem(
            candidate.problem.arms, dashpot=candidate.problem.dashpot, scale=scale
        )
        return replace(candidate, problem=problem)

    def _problem(self, arms: int, *, dashpot: bool, scale: float = 1.0) -> Problem:
        return Problem(
            self.relaxations,
            self.frf_data,
            self.priors,
            self.constraints,
            arms=arms,
            dashpot=dashpot,
            scale=scale,
        )

    def _linear(self, most: int, *, dashpot: bool) -> list[Parameters]:
        """Starts from the engine: dynamic stiffness is linear in the stiffnesses of the solid."""
        from dashpot.engine.solver.variable_projection import solve_orders

        known = None if self.priors.mass is None else self.priors.mass.value
        blocks: list[Block] = [
            WeightedBlock(relaxation, i) for i, relaxation in enumerate(self.relaxations)
        ]
        blocks.append(self.frf_data.stiffness_block(known, dashpot=dashpot))
        starts = []
        for solution in solve_orders(blocks, most):
            k = solution.arms[0]
            model = GeneralizedMaxwell(
                max(solution.coefficient("k_inf"), 0.0),
                tuple(np.maximum(k, GONE * k.max(initial=0.0))),
                tuple(solution.tau),
                max(solution.coefficient("b"), 0.0) if dashpot else 0.0,
            )
            mass = known if known is not None else solution.coefficient("mass@frf")
            if mass > 0:
                starts.append(
                    Parameters(_with_dashpot(model, self.frf_data, dashpot), mass, 1.0, 0.0)
                )
        return starts

    def _spread(self, number: int, *, dashpot: bool) -> list[Parameters]:
        """Starts from the earlier fit, or from nothing, with arms spread over the lines."""
        omega = 2 * np.pi * self.frf_data.peak_hz
        old = None if self.before is None else self.before.model
        if old is not None and old.arms > number:
            return []
        new = number - (0 if old is None else old.arms)
        mass = 1.0 if self.priors.mass is None else self.priors.mass.value
        if old is None or self.priors.mass is None:
            # at the peak the mass holds the storage stiffness in balance
            level = mass * omega**2 / self.frf_data.seals
        else:
            level = old.k_0
        starts = []
        for reach in (1.0, 6.0):
            tau = np.geomspace(1 / (reach * omega), reach / omega, new) if new > 1 else [1 / omega]
            base = GeneralizedMaxwell(level * 0.8) if old is None else old
            part = 0.2 if old is None else 0.1
            extra = (
                GeneralizedMaxwell(0.0, (part * level / new,) * new, tuple(tau)) if new else None
            )
            model = base if extra is None else base + extra
            if model.arms == number:
                starts.append(
                    Parameters(_with_dashpot(model, self.frf_data, dashpot), mass, 1.0, 0.0)
                )
            if new < 2:
                break
        return starts


def _with_dashpot(
    model: GeneralizedMaxwell, frf_data: FRFData, dashpot: bool
) -> GeneralizedMaxwell:
    if not dashpot or model.b > 0:
        return model
    # two percent of the stiffness at the peak
    return replace(model, b=0.02 * model.k_0 / (2 * np.pi * frf_data.peak_hz))


def _descend(problem: Problem, start: FloatArray, *, tolerance: float = LOOSE) -> Candidate:
    """To the nearest optimum, every logarithm kept where doubles can follow."""
    from scipy.optimize import least_squares

    low, high = _bounds(problem, start)
    result = least_squares(
        problem.residual,
        np.clip(start, low + 1e-9, high - 1e-9),
        jac=problem.jacobian,
        bounds=(low, high),
        x_scale="jac",
        xtol=1e-10,
        ftol=tolerance,
        gtol=1e-12,
        max_nfev=200,
    )
    return Candidate(
        problem, result.x, 2 * float(result.cost), _bic(problem, result.x), result.status > 0
    )


def window_ends(problem: Problem) -> tuple[float, float]:
    """Shortest and longest relaxation time that is sought, ln s."""
    windows = [relaxation.block.window for relaxation in problem.relaxations]
    windows.append(problem.frf_data.stiffness_block(1.0, dashpot=False).window)
    if problem.constraints.before is not None and problem.constraints.before.model.arms:
        tau = problem.constraints.before.model.tau
        windows.append((tau[0] / BEYOND, tau[-1] * BEYOND))
    low, high = min(w[0] for w in windows), max(w[1] for w in windows)
    return float(np.log(low / BEYOND)), float(np.log(high * BEYOND))


def _bounds(problem: Problem, start: FloatArray) -> tuple[FloatArray, FloatArray]:
    low, high = start - 25.0, start + 12.0
    arms = slice(1 + problem.arms, 1 + 2 * problem.arms)
    low[arms], high[arms] = window_ends(problem)
    if "delay" in problem.at:
        low[problem.at["delay"]], high[problem.at["delay"]] = -1e3, 1e3
    return low, high


def _bic(problem: Problem, theta: FloatArray) -> float:
    r"""Bayesian criterion with each test's own noise profiled: sum n ln(chi2/n) + p ln n."""
    lines = 2.0 * len(problem.frf_data.s)
    frf_data = float(np.sum((problem.frf_residual(theta) * problem.scale) ** 2))
    # below a millionth of the value, or of the noise, one misfit is as good as another
    total = lines * np.log(max(frf_data / lines, SMALLEST_SCATTER**2))
    count = lines
    for relaxation, chi2 in zip(problem.relaxations, problem.relaxation_chi2(theta), strict=True):
        total += relaxation.samples * np.log(chi2 / relaxation.samples)
        count += relaxation.samples
    prior = float(np.sum(problem.prior_residual(theta) ** 2))
    return float(total + prior + len(theta) * np.log(count))


def chosen(found: Sequence[Candidate]) -> Candidate:
    """Choose by the criterion among those with every arm significant, else among all."""
    scale = line_scale(min(found, key=lambda c: c.bic))
    sure = []
    for candidate in found:
        candidate.problem.scale = scale
        if candidate.significant():
            sure.append(candidate)
        candidate.problem.scale = 1.0
    return min(sure or found, key=lambda candidate: candidate.bic)


def line_scale(best: Candidate) -> float:
    """What the standard deviation of the lines must be multiplied by to explain the misfit."""
    residual = best.problem.frf_residual(best.theta) * best.problem.scale
    spare = max(len(residual) - len(best.theta), 1)
    rms = float(np.sqrt(residual @ residual / spare))
    return max(rms, 1.0) if best.problem.frf_data.known_sd else max(rms, SMALLEST_SCATTER)
