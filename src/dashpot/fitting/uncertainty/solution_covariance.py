"""How well a solution of the engine is known, from the residuals in their own order."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.datamodel.parameter_estimate import Residual
from dashpot.fitting.uncertainty.encoder_resolution import Encoder, Kernel, encoder_rows
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.exponential_fit.log_tau_descent import Stack
from dashpot.numerics.exponential_fit.variable_projection import Jacobian, Solution, full_jacobian
from dashpot.numerics.inference.covariance import (
    JacobianColumns,
    Noise,
    ResidualSeries,
    directions,
    noise_gain_ratio,
    noise_of,
)
from dashpot.numerics.inference.model_order import bic, significant

# a fit that leaves less than this of the largest force has met the rounding of the data
_ROUNDING = 1e-10


@dataclass(frozen=True, eq=False)
class ParameterCovariance:
    """Parameters with their covariance, and the residuals that it comes from.

    Attributes
    ----------
    names : tuple of str
        Rows of `covariance`.
    covariance : array, shape (p, p)
    residuals : tuple of arrays
        One per record, N.
    noises : tuple of Noise
    """

    names: tuple[str, ...]
    covariance: FloatArray
    residuals: tuple[FloatArray, ...]
    noises: tuple[Noise, ...]

    @property
    def effective(self) -> float:
        """Effective number of independent residuals."""
        return sum(noise.effective for noise in self.noises)

    @property
    def dof(self) -> float:
        """Degrees of freedom left: effective residuals less parameters."""
        return self.effective - len(self.names)

    @property
    def sse(self) -> float:
        """Sum of squared residuals over every sample, N^2."""
        return float(sum(residual @ residual for residual in self.residuals))

    @property
    def samples(self) -> int:
        """Number of residuals."""
        return sum(noise.samples for noise in self.noises)

    @property
    def rms(self) -> float:
        """Root mean square of the residuals, N."""
        return float(np.sqrt(self.sse / self.samples))

    @property
    def kappa(self) -> float:
        """Samples per independent residual, over all records."""
        return self.samples / self.effective

    def statistics(self, weights: Sequence[float]) -> Residual:
        """Statistics of the residuals; `weights` of the records in that of Durbin and Watson."""
        watson = [noise.durbin_watson for noise in self.noises]
        mean = float(np.average(watson, weights=weights)) if sum(weights) > 0 else 2.0
        return Residual(self.samples, self.sse, self.rms, self.kappa, mean)

    def standard_error(self, name: str) -> float:
        """Standard error of a row."""
        row = self.names.index(name)
        return float(np.sqrt(self.covariance[row, row]))


@dataclass(frozen=True, eq=False)
class SolutionEstimate(ParameterCovariance):
    """A solution with its uncertainty.

    Attributes
    ----------
    solution : Solution
        The rows of `covariance` are its fixed columns, stiffnesses group by group, then ln tau.
    directions : array, shape (p, r)
        Those that all samples know, D: D D' is the inverse of their J'J.
    noise_gain : float
        How much more of the noise meets one of them than another.
    """

    solution: Solution
    directions: FloatArray
    noise_gain: float

    @property
    def spread(self) -> float:
        """Standard deviation of one independent residual, N: the rms times root kappa."""
        return float(np.sqrt(self.sse / self.effective))

    def with_depth_doubt(
        self, doubts: Sequence[float], stiffnesses: Mapping[str, float]
    ) -> SolutionEstimate:
        r"""Return the estimate with what the encoder's step leaves unknown of each depth.

        A relative error :math:`\epsilon` of a depth scales every stiffness of its test, so that n
        tests that share them add :math:`\overline{\epsilon^2} k k^T / n` to the covariance;
        `stiffnesses` holds each by its row.
        """
        doubt = float(np.sqrt(np.mean(np.square(doubts)) / len(doubts)))
        change = np.array([doubt * stiffnesses.get(name, 0.0) for name in self.names])
        return replace(self, covariance=self.covariance + np.outer(change, change))


class Score(NamedTuple):
    """One number of arms, judged."""

    solution: Solution
    bic: float
    significant: bool


def estimate_covariance(
    solution: Solution,
    every_sample: Sequence[DataBlock],
    *,
    peak: float,
    priors: Sequence[DataBlock] = (),
    encoders: Sequence[Encoder] | None = None,
    others: Sequence[Callable[[FloatArray], FloatArray]] = (),
    whole: Jacobian | None = None,
    series: Sequence[ResidualSeries] = (),
) -> SolutionEstimate:
    """Return the solution's uncertainty from one block per record with a row per sample.

    Parameters
    ----------
    solution : Solution
    every_sample : sequence of DataBlock
    peak : float
        The largest force, N: it sets what rounding alone leaves.
    encoders : sequence of Encoder, optional
        Of each record, where the recorded motion is fitted.
    priors : sequence of DataBlock
        What was known before the data.
    others : sequence of callable, optional
        Of each record that has no encoder, as
        :func:`~dashpot.numerics.inference.covariance.sandwich` takes errors that are not constant
        in time.
    whole : Jacobian, optional
        Of every sample and then of the priors, where it is known already.
    series : sequence of Series, optional
        The residual of each record, where its correlations are known already.
    """
    whole = whole or full_jacobian([*every_sample, *priors], solution)
    every_residual, every_jacobian = split_by_record(whole, [*every_sample, *priors])
    count = len(every_sample)
    series, known_by = (
        series or [*map(ResidualSeries, every_residual[:count])],
        directions(every_jacobian),
    )
    noises = noises_of(series, known_by.columns[:count], peak=peak)
    others = others or [
        partial(encoder_rows, encoder=encoder, kernel=_kernel(solution, block))
        for encoder, block in zip(encoders or (), every_sample, strict=False)
    ]
    resolved_noises = [
        Noise(block.samples, np.array([block.variance]), 1.0, 2.0) for block in priors
    ]
    met = [
        *map(known_by.compute_record_gain, range(len(every_jacobian)), [*noises, *resolved_noises])
    ]
    covariance = known_by.covariance(np.sum(met, axis=0), others=others)
    residuals = tuple(residual_series.values for residual_series in series)
    return SolutionEstimate(
        whole.names, covariance, residuals, noises, solution, known_by.turn,
        noise_gain_ratio(known_by, met[:count]),
    )  # fmt: skip


def split_by_record(
    whole: Jacobian, every_sample: Sequence[DataBlock]
) -> tuple[tuple[FloatArray, ...], list[FloatArray]]:
    """Return residuals and Jacobians, one of each per record."""
    cuts = np.cumsum([block.samples for block in every_sample])[:-1]
    return tuple(np.split(whole.residual, cuts)), np.split(whole.matrix, cuts)


def noises_of(
    residuals: Sequence[FloatArray | ResidualSeries],
    jacobians: Sequence[FloatArray | JacobianColumns],
    *,
    peak: float,
) -> tuple[Noise, ...]:
    """Return what the residuals of each record say about its noise."""
    return tuple(
        noise_of(residual, jacobian, rounding=rounding(peak))
        for residual, jacobian in zip(residuals, jacobians, strict=True)
    )


def rounding(peak: float) -> float:
    """Return the rms that rounding alone leaves of data with this largest force."""
    return _ROUNDING * peak


def _kernel(solution: Solution, block: DataBlock) -> Kernel:
    """Return the relaxation of the solid that one record sees."""
    spring = [name for name in block.fixed_names if name.partition("@")[0] == "k_inf"]
    return Kernel(
        sum(solution.coefficient(name) for name in spring),
        solution.arms[solution.groups.index(block.arm_group)],
        solution.tau,
    )


def residual_of(solution: Solution, block: DataBlock) -> FloatArray:
    """Return what a solution leaves of one record, a row per sample."""
    rows = block.evaluate(solution.log_tau, False)
    fixed = np.array([solution.coefficient(name) for name in block.fixed_names])
    arms = solution.arms[solution.groups.index(block.arm_group)]
    return np.asarray(rows.target - rows.fixed @ fixed - rows.arms @ arms)


def score_solution(
    solution: Solution,
    blocks: Sequence[DataBlock],
    every_sample: Sequence[DataBlock],
    *,
    effective: float,
    peak: float,
    priors: Sequence[DataBlock] = (),
) -> Score:
    """Judge one number of arms by BIC and by the significance of its arms.

    Parameters
    ----------
    solution : Solution
    blocks, every_sample : sequences of DataBlock
        The compressed data, and all of it.
    effective : float
        Effective number of residuals, from the largest model tried.
    peak : float
        Largest force, N; sets what rounding alone leaves.
    priors : sequence of DataBlock
        What was known before the data.
    """
    floor = max(solution.samples * rounding(peak) ** 2, Stack(blocks).rounding_floor)
    parameters = len(solution.fixed) + solution.arms.size + solution.order
    criterion = bic(solution.sse, effective=effective, parameters=parameters, floor=floor)
    if not solution.order:
        return Score(solution, criterion, True)
    information = directions([full_jacobian([*blocks, *priors], solution).matrix])

    def is_significant(independent: float) -> bool:
        variance = (solution.sse + floor) / max(independent - parameters, 1.0)
        return _significant(solution, information.covariance(variance * information.gram))

    # if every sample counted in full and it is not significant, or if only the slowest
    # correlation counted and it is, the sandwich between the two need not be built
    is_clear = is_significant(solution.samples) and (
        is_significant(effective)
        or _significant(
            solution,
            estimate_covariance(solution, every_sample, peak=peak, priors=priors).covariance,
        )
    )
    return Score(solution, criterion, is_clear)


def _significant(solution: Solution, covariance: FloatArray) -> bool:
    first, arms = len(solution.fixed_names), solution.order
    error = np.sqrt(np.diag(covariance))
    k, se_k = solution.arms.ravel(), error[first : first + arms]
    return significant(k, se_k, error[first + arms :])
