r"""Fit in two stages: arms and noise by the hold, the elastic law by the ramp.

A hold needs no elastic law: whatever the ramp was, :math:`F = F_\infty + \sum_j A_j e^{-t/\tau_j}`
after it. Rows of the ramp enter with a separate variance, which includes the misfit of the law,

.. math:: s_r^2 = \max\Bigl(\kappa_r \frac{\sum c\,r^2}{n_r - \sum h},\; s_h^2 \kappa_h\Bigr)

(h leverages, :math:`\kappa` correlated rows count as one): never less than that of the hold,
so that a wrong law cannot change the result of the hold.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.fitting.nonlinear_ramp.quasi_linear import (
    Bounds,
    DownsampledRows,
    Nuisances,
    QuasiLinear,
    Weighted,
    tau_bounds,
)
from dashpot.fitting.nuisance_priors import Prior
from dashpot.numerics.design_matrices.block import DataBlock, design_block
from dashpot.numerics.exponential_fit import Solution, compute_full_jacobian, solve_orders
from dashpot.numerics.inference.correlated_noise import estimate_noise, make_directions, white
from dashpot.numerics.inference.covariance_estimate import Estimate, estimate, white_noise
from dashpot.numerics.inference.model_order import deviance
from dashpot.numerics.least_squares import Optimum

MAX_ARMS = 5
_MAX_ITERATIONS = 10
_CONVERGENCE_TOLERANCE = 0.005
# force by the motion of a plate at rest, as a fraction of the noise of a sample
REST_NOISE_SHARE = 0.1
# least degrees of freedom of a ramp, as a fraction of its rows
_MIN_DOF_SHARE = 0.2
# residual by rounding, as a fraction of the largest force
ROUNDING_SHARE = 3e-6


@dataclass(frozen=True, eq=False)
class HoldEstimate:
    """Fit of the holds of the records alone, with shared relaxation times.

    Attributes
    ----------
    log_tau : array, shape (N,)
    plateau, plateau_error : tuple of float
        Relaxed secant stiffness of each record at its own depth, N/m, and its standard error.
    scatter : tuple of float
        Standard deviation of one independent sample of each record, N.
    correlation : tuple of float
        Variance inflation by correlated rows.
    rms : tuple of float
        Root mean square of each hold's residual, N.
    """

    log_tau: FloatArray
    plateau: tuple[float, ...]
    plateau_error: tuple[float, ...]
    scatter: tuple[float, ...]
    correlation: tuple[float, ...]
    rms: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class RampHoldOptimum:
    """Optimum of one elastic law.

    Attributes
    ----------
    weighted : Weighted
    optimum : Optimum
    ramp_rms, hold_rms : tuple of float
        Root mean square of each record's residual on its ramp and in its hold, a sample, N.
    ramp_scatter : tuple of float
        s_r of each record, N.
    ramp_correlation : tuple of float
    """

    weighted: Weighted
    optimum: Optimum
    ramp_rms: tuple[float, ...]
    hold_rms: tuple[float, ...]
    ramp_scatter: tuple[float, ...]
    ramp_correlation: tuple[float, ...]

    @property
    def log_tau(self) -> FloatArray:
        """Logarithm of the relaxation time of every arm, shape (N,)."""
        return self.weighted.solid.split_parameters(self.optimum.theta)[0]

    @property
    def shape(self) -> FloatArray:
        """Shape of the law at its knots, of mean 1."""
        return self.weighted.solid.split_parameters(self.optimum.theta)[1]

    @property
    def k(self) -> FloatArray:
        """k_inf and every k, N/m, of each set of stiffnesses, shape (S, 1 + N)."""
        return self.weighted.stiffnesses(self.optimum)

    @property
    def nuisance(self) -> dict[str, float]:
        """The nuisance terms by their names, N, N/s and s."""
        names = self.weighted.nuisances.names
        return dict(zip(names, self.optimum.beta[-len(names) :].tolist(), strict=True))

    def estimate(self, hold: HoldEstimate) -> Estimate:
        """Return the covariance of the optimum.

        The noise is scaled up if the hold residual exceeds that of the hold alone. Arms without
        stiffness and shape values at 0 have no error.
        """
        best, noise_ratio = self.optimum, max(1.0, *np.divide(self.hold_rms, hold.rms).tolist())
        plateau = np.zeros(len(best.beta), dtype=bool)
        plateau[: self.k.size : self.k.shape[1]] = True
        is_absent = (self.k[:, 1:] <= 0).all(axis=0)
        return estimate(
            best,
            noises=[white_noise(best, noise_ratio**2)],
            prior_variance=noise_ratio**2,
            is_bounded=plateau,
            is_fixed=np.append(is_absent, best.theta[len(self.log_tau) :] <= 0),
        )


# -- Fit of the hold ------------------------------------------------------------------------------


def fit_hold_only(
    rows: DownsampledRows, arms: int | None = None, max_arms: int = MAX_ARMS
) -> HoldEstimate:
    """Fit the holds without their ramps: as many arms as BIC supports, or `arms`."""
    bounds = tau_bounds(rows)
    blocks = [_build_hold_block(rows, i, bounds) for i in range(len(rows.depths))]
    fewest_samples = min(block.samples for block in blocks)
    max_order = max(min(max_arms if arms is None else arms, (fewest_samples - 3) // 2), 0)
    arm_penalty = (1 + len(blocks)) * float(np.log(fewest_samples)) if arms is None else 0.0
    solutions = solve_orders(blocks, max_order, negligible=arm_penalty)
    solution = _select_order(rows, blocks, solutions) if arms is None else solutions[-1]
    return _build_hold_estimate(rows, blocks, solution)


def _build_hold_block(rows: DownsampledRows, i: int, bounds: Bounds) -> DataBlock:
    r"""Return the rows of relaxation and of the instantaneous response to a plate still moving.

    .. math:: F - F_0 = k_\infty + \sum_j A_j e^{-t/\tau_j} + k_g\,(x - x_h)
    """
    hold_rows = rows.select_hold(i)
    time = rows.time[hold_rows] - rows.time[hold_rows][0]
    root = np.sqrt(rows.sample_counts[hold_rows])
    fixed = {f"k_inf@{i}": np.ones(len(time))}
    displacement = rows.displacement[hold_rows] - rows.depths[i]
    least_motion = REST_NOISE_SHARE * rows.noise[i] / rows.peak(i) * rows.depths[i]
    if float(np.ptp(displacement)) > least_motion:
        fixed[f"settling@{i}"] = displacement

    def columns(tau: FloatArray, derivative: bool) -> tuple[FloatArray, FloatArray]:
        age = time[:, None] / tau
        decay = root[:, None] * np.exp(-age)
        return (decay, age * decay) if derivative else (decay, decay)

    block = design_block(
        target=root * (rows.force[hold_rows] - rows.priors[i].offset.mean),
        fixed=root[:, None] * np.column_stack(list(fixed.values())),
        fixed_names=tuple(fixed),
        columns=columns,
        window=(float(np.exp(bounds.low)), float(np.exp(bounds.high))),
    )
    return replace(block, arm_group=f"k@{i}")


def _select_order(
    rows: DownsampledRows, blocks: Sequence[DataBlock], solutions: Sequence[Solution]
) -> Solution:
    """Return the solution with the least BIC, by the effective number of samples."""
    sizes = [block.samples for block in blocks]
    largest = np.split(compute_full_jacobian(blocks, solutions[-1]).residual, np.cumsum(sizes)[:-1])
    effective = sum(estimate_noise(residual).effective for residual in largest)
    rounding_sse = sum(
        sample_count * rounding(rows, i) ** 2 for i, sample_count in enumerate(sizes)
    )
    penalty = float(np.log(effective / sum(sizes) * rows.sample_counts[~rows.ramp].sum()))
    per_arm = 1 + len(blocks)
    return min(
        solutions,
        key=lambda s: (
            deviance(s.sse, effective=effective, rounding_sse=rounding_sse)
            + per_arm * s.order * penalty
        ),
    )


def _build_hold_estimate(
    rows: DownsampledRows, blocks: Sequence[DataBlock], solution: Solution
) -> HoldEstimate:
    jacobian = compute_full_jacobian(blocks, solution)
    boundaries = np.cumsum([block.samples for block in blocks])[:-1]
    scatter, correlation, rms, plateau, error = [], [], [], [], []
    for i, residual in enumerate(np.split(jacobian.residual, boundaries)):
        belongs_to_record = [n.endswith(f"@{i}") or n.startswith("ln_tau") for n in jacobian.names]
        dof = max(len(residual) - sum(belongs_to_record), 1)
        rms.append(max(float(np.sqrt(np.mean(residual**2))), rounding(rows, i)))
        scatter.append(max(float(np.sqrt(residual @ residual / dof)), rounding(rows, i)))
        correlation.append(estimate_noise(residual).kappa)
    sd = np.repeat(np.array(scatter) * np.sqrt(correlation), [block.samples for block in blocks])
    covariance = white(jacobian.matrix / sd[:, None], 1.0)
    for i, depth in enumerate(rows.depths):
        row = jacobian.names.index(f"k_inf@{i}")
        offset_variance = float(covariance[row, row]) + rows.priors[i].offset.sd ** 2
        plateau.append(solution.coefficient(f"k_inf@{i}") / depth)
        error.append(float(np.sqrt(offset_variance)) / depth)
    return HoldEstimate(
        solution.log_tau,
        tuple(plateau),
        tuple(error),
        tuple(scatter),
        tuple(correlation),
        tuple(rms),
    )


def rounding(rows: DownsampledRows, i: int) -> float:
    """Return the residual of record i by block means and rounding, N."""
    return ROUNDING_SHARE * rows.peak(i)


# -- Fit of the ramp ------------------------------------------------------------------------------


def build_nuisances(rows: DownsampledRows, delay: FloatArray | None = None) -> Nuisances:
    r"""Return offset and drift of each record; with :math:`-dF/dt` given, its delay too."""
    names, columns, priors = [], [], []
    for i, prior in enumerate(rows.priors):
        record_rows = rows.record == i
        names += [f"offset@{i}", f"drift@{i}"]
        columns += [1.0 * record_rows, record_rows * (rows.time - prior.offset_time)]
        priors += [prior.offset, prior.drift]
        if delay is not None:
            names.append(f"delay@{i}")
            columns.append(record_rows * delay)
            priors.append(prior.delay)
    peak = float(np.abs(rows.force).max())
    rounding_limit = 1e-12 * peak
    return Nuisances(
        tuple(names),
        np.column_stack(columns),
        tuple(Prior(prior.mean, max(prior.sd, rounding_limit)) for prior in priors),
    )


def delay_derivative(weighted: Weighted, best: Optimum) -> FloatArray:
    r"""Return the derivative of the force by a delay, :math:`-\dot F` of the solid, N/s."""
    rows, force = weighted.solid.rows, weighted.force(best)
    values = np.empty(len(force))
    for i in range(len(rows.depths)):
        record_rows = np.flatnonzero(rows.record == i)
        values[record_rows] = -np.gradient(force[record_rows], rows.time[record_rows])
    return values


def compute_row_sd(rows: DownsampledRows, ramp: npt.ArrayLike, hold: npt.ArrayLike) -> FloatArray:
    """Return the standard deviation of each row's samples, N, from those of ramps and holds."""
    return np.where(rows.ramp, np.asarray(ramp)[rows.record], np.asarray(hold)[rows.record])


def compute_independent_noise(hold: HoldEstimate) -> FloatArray:
    """Return the standard deviation of one independent sample of each hold, N."""
    return np.asarray(hold.scatter * np.sqrt(hold.correlation))


def fit_recorded_hold(rows: DownsampledRows, hold: HoldEstimate) -> RampHoldOptimum:
    """Fit the hold rows alone, with the recorded history of a linear seal."""
    effects = compute_row_sd(
        rows, np.full(len(rows.depths), np.inf), compute_independent_noise(hold)
    )
    weighted = Weighted(
        QuasiLinear(rows, np.array([0.0, rows.depth])), effects, build_nuisances(rows)
    )
    return add_residual_statistics(
        weighted, weighted.descend(hold.log_tau), compute_independent_noise(hold)
    )


def fit_ramp_and_hold(
    solid: QuasiLinear,
    hold: HoldEstimate,
    optimum: RampHoldOptimum,
    theta: FloatArray,
    *,
    value: Nuisances | None = None,
    separate: bool = False,
) -> RampHoldOptimum:
    """Fit one law to every row, the ramps weighted by their misfit, first that of `optimum`.

    The nuisances are `value`, by default offset and drift; with `separate` each record has its
    own stiffnesses.
    """
    rows = solid.rows
    value = build_nuisances(rows) if value is None else value
    by_hold = compute_independent_noise(hold)
    for _ in range(_MAX_ITERATIONS):
        weighted = Weighted(
            solid, compute_row_sd(rows, optimum.ramp_scatter, by_hold), value, separate=separate
        )
        previous = optimum
        optimum = add_residual_statistics(weighted, weighted.descend(theta), by_hold)
        theta = optimum.optimum.theta
        change = np.array(optimum.ramp_scatter) / np.array(previous.ramp_scatter) - 1
        if float(np.abs(change).max()) < _CONVERGENCE_TOLERANCE:
            break
    return optimum


def add_residual_statistics(
    weighted: Weighted, best: Optimum, by_hold: FloatArray
) -> RampHoldOptimum:
    """Return an optimum with the residual statistics of each ramp and hold."""
    rows, nuisance = weighted.solid.rows, best.beta[-len(weighted.nuisances.names) :]
    residual = rows.force - weighted.force(best) - weighted.nuisances.columns @ nuisance
    leverage = np.sum(make_directions([best.jacobian]).columns[0].matrix ** 2, axis=1)[
        : len(residual)
    ]
    scaled_residual = np.sqrt(rows.sample_counts) * residual
    ramps, holds, scatters, correlations = [], [], [], []
    for i in range(len(rows.depths)):
        ramp, hold = rows.ramp & (rows.record == i), rows.select_hold(i)
        ramp_rows = int(ramp.sum())
        remainder = max(ramp_rows - float(leverage[ramp].sum()), _MIN_DOF_SHARE * ramp_rows)
        kappa = estimate_noise(scaled_residual[ramp]).kappa
        ramps.append(max(float(np.sqrt(np.mean(scaled_residual[ramp] ** 2))), rounding(rows, i)))
        holds.append(max(float(np.sqrt(np.mean(scaled_residual[hold] ** 2))), rounding(rows, i)))
        correlations.append(kappa)
        scatters.append(
            max(
                float(np.sqrt(kappa * (scaled_residual[ramp] @ scaled_residual[ramp]) / remainder)),
                float(by_hold[i]),
            )
        )
    return RampHoldOptimum(
        weighted, best, tuple(ramps), tuple(holds), tuple(scatters), tuple(correlations)
    )
