"""Quasi-linear solids, fitted to downsampled records by weighted least squares."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass
from dashpot.base.arrays import BoolArray, FloatArray, IndexArray, distinct, median
from dashpot.base.errors import FitError
from dashpot.datamodel.relaxation import RampHold
from dashpot.fitting.nuisance_priors import LoadCellPriors, Prior, build_load_cell_priors
from dashpot.numerics.design_matrices.recorded_motion import recursion
from dashpot.numerics.least_squares import Optimum, Parameter, Problem, Rows, require_optimum
from dashpot.preprocessing.denoising import denoise_displacement

# Downsampled rows: every sample near a corner, block means elsewhere.
#
# A mean of c neighbours of a smooth curve is its value at their mean time, to a relative
# :math:`w^2/(24\,\tau^2)` for a block of width w, and it is worth c samples. Blocks widen in
# proportion to the time since the corner, as what relaxes after it slows down.


# blocks per e-fold of the time since a corner
_RAMP_BLOCKS, _HOLD_BLOCKS = 64, 26
# the fewest samples that can show a ramp and a hold
_MIN_RAMP_SAMPLES, _MIN_HOLD_SAMPLES = 3, 8
# motion after the ramp, as a part of the depth, that a law of the ramp can bear
_MAX_HOLD_MOTION = 0.15
# a force that peaks this part of the hold late, by so many times its scatter and this part of
# itself, had not seen the end of the ramp
_SOON, _CLEAR, _RISEN = 0.1, 6.0, 0.005


@dataclass(frozen=True, eq=False)
class DownsampledRows:
    """Rows of several records, stacked.

    Attributes
    ----------
    time : array, shape (M,)
        Mean time of the samples of a row since the first sample of its record, s.
    step : array, shape (M,)
        Time since the row before, s; at the first row of a record the sampling interval.
    displacement, force : array, shape (M,)
        Means, m and N.
    sample_counts : array, shape (M,)
        Samples in a row.
    record : array of int, shape (M,)
        Index of the record of each row.
    ramp : array of bool, shape (M,)
        Rows before the end of the ramp.
    ramp_ends : tuple of float
        End of each record's ramp on the clock of `time`, s.
    depths : tuple of float
        Compression held in each record, m.
    noise : tuple of float
        Scatter of each record's force from sample to sample, N.
    priors : tuple of LoadCellPriors
        Priors of each record's nuisance terms.
    """

    time: FloatArray
    step: FloatArray
    displacement: FloatArray
    force: FloatArray
    sample_counts: FloatArray
    record: IndexArray
    ramp: BoolArray
    ramp_ends: tuple[float, ...]
    depths: tuple[float, ...]
    noise: tuple[float, ...]
    priors: tuple[LoadCellPriors, ...]

    @property
    def depth(self) -> float:
        """The deepest compression held, m."""
        return max(self.depths)

    @cached_property
    def first_rows(self) -> IndexArray:
        """The first row of each record."""
        return np.flatnonzero(np.diff(self.record, prepend=-1))

    def peak(self, record: int) -> float:
        """Return the largest force of one record, N."""
        return float(np.abs(self.force[self.record == record]).max())

    def select_hold(self, record: int) -> BoolArray:
        """Return the rows of one record's hold."""
        return np.asarray((self.record == record) & ~self.ramp)


def downsample_tests(tests: Sequence[RampHold]) -> DownsampledRows:
    """Return the rows of prepared tests, from contact to the end of the hold.

    Raises
    ------
    FitError
        If a test has no sufficient ramp or hold.
    """
    parts, cell_priors = [], []
    for number, test in enumerate(tests):
        cell_priors.append(build_load_cell_priors(test))
        parts.append(_downsample_record(test, number, cell_priors[-1].first_sample))
    columns = [np.concatenate(column) for column in zip(*parts, strict=True)]
    time, step, x, force, count, record, ramp = columns
    return DownsampledRows(
        time,
        step,
        x,
        force,
        count,
        record.astype(np.intp),
        ramp > 0,
        tuple(test.ramp_end - float(test.time[0]) for test in tests),
        tuple(test.depth for test in tests),
        tuple(test.force_noise for test in tests),
        tuple(cell_priors),
    )


def explain_missing_ramp(test: RampHold) -> str | None:
    """Return why a record shows no elastic law by its ramp, in a sentence; None if it may."""
    corner, hold_stop = find_relaxation_start(test), test.hold.stop
    climbing = corner - int(np.searchsorted(test.time, test.onset))
    if climbing < _MIN_RAMP_SAMPLES or hold_stop - corner < _MIN_HOLD_SAMPLES:
        return (
            f"the record has {climbing} samples on the ramp and {hold_stop - corner} in the hold; "
            f"an elastic law from the ramp needs at least {_MIN_RAMP_SAMPLES} and "
            f"{_MIN_HOLD_SAMPLES}: "
            "sample faster"
        )
    ratio = float(np.ptp(test.displacement[corner:hold_stop])) / test.depth
    if ratio > _MAX_HOLD_MOTION:
        return (
            f"the displacement moves by {100 * ratio:.0f} % of the depth after the first ramp; an "
            "elastic law from the ramp needs one ramp and its hold: cut the record to them"
        )
    return None


def _downsample_record(test: RampHold, number: int, first: int) -> tuple[npt.NDArray[Any], ...]:
    refusal = explain_missing_ramp(test)
    if refusal is not None:
        raise FitError(refusal)
    x = denoise_displacement(test)[0]
    time, force = test.time[: len(x)] - test.time[0], test.force[: len(x)]
    corner = find_relaxation_start(test)
    usual_step = median(np.diff(time[first:corner]))
    median_step = median(np.diff(time[corner : corner + _MIN_HOLD_SAMPLES]))
    cuts = distinct(np.concatenate((
        _place_ramp_blocks(time[first:corner], usual_step) + first,
        _place_hold_blocks(time[corner:], median_step, _HOLD_BLOCKS) + corner,
    )))  # fmt: skip
    count = np.diff(np.append(cuts, len(x))).astype(float)
    mean_time, mean_x, mean_force = (
        np.add.reduceat(values, cuts) / count for values in (time, x, force)
    )
    step = np.diff(mean_time, prepend=mean_time[0] - usual_step)
    return mean_time, step, mean_x, mean_force, count, np.full(len(cuts), number), cuts < corner


def find_relaxation_start(test: RampHold) -> int:
    """Return the sample from which the force falls: the first of the hold, or the peak behind it.

    A force that rises on after the plate is said to stand belongs to the ramp.
    """
    start = test.hold.start
    window = min(test.ramp_time, _SOON * test.hold_time)
    stop = int(np.searchsorted(test.time, test.ramp_end + window))
    soon = test.force[start : max(stop, start + 1)]
    peak = int(np.argmax(soon))
    initial_rise = float(soon[peak] - soon[0])
    rises_on = initial_rise > _CLEAR * test.force_noise + _RISEN * float(soon[peak])
    return int(start) + peak if rises_on else int(start)


def _place_ramp_blocks(time: FloatArray, interval: float) -> IndexArray:
    """Return where blocks start that widen from both corners of a ramp."""
    middle_index = int(np.searchsorted(time, 0.5 * (time[0] + time[-1])))
    first_half = _place_hold_blocks(time[:middle_index], interval, _RAMP_BLOCKS)
    second_half = (
        len(time) - _place_hold_blocks(-time[middle_index:][::-1], interval, _RAMP_BLOCKS)[1:]
    )
    return np.concatenate((first_half, [middle_index], second_half))


def _place_hold_blocks(time: FloatArray, interval: float, blocks: int) -> IndexArray:
    """Return where blocks start that widen with the time since the first sample."""
    span = float(time[-1] - time[0]) if len(time) else 0.0
    block_count = np.ceil(blocks * np.log1p(span / (blocks * interval)))
    edges = blocks * interval * np.expm1(np.arange(block_count + 1) / blocks)
    cuts = distinct(np.searchsorted(time - time[0] if len(time) else time, edges))
    return np.asarray(cuts[cuts < len(time)])


# Force of a quasi-linear solid, linear in its stiffnesses and in the shape of its law.
#
# All arms answer the same elastic path p(x) (Y. C. Fung, *Biomechanics*, 1993, ch. 7):
#
# .. math:: F = k_\infty\,p(x) + \sum_j k_j \int_0^t e^{-(t-u)/\tau_j}\,\frac{d\,p(x(u))}{du}\,du,
#     \qquad p(x) = \sum_m s_m B_m(x), \quad B_m(x) = \int_0^x h_m(v)\,dv
#
# with hats :math:`h_m` on the knots, so that the tangent :math:`p'` is linear between them and
# :math:`p' \ge 0` if and only if every :math:`s_m \ge 0`. The shape has the mean 1: p of the depth
# is the depth and the stiffnesses are secants there.


class QuasiLinear:
    r"""Rows of records under an elastic law on some knots.

    Attributes
    ----------
    rows : DownsampledRows
    knots : array, shape (P,)
        m, from 0 to the deepest compression.
    weights : array, shape (P,)
        Weights of each hat in the mean of the tangent: :math:`w \cdot s = 1`.
    """

    def __init__(self, rows: DownsampledRows, knots: FloatArray) -> None:
        self.rows, self.knots = rows, knots
        self.hats = integrate_hats(rows.displacement, knots)
        width = np.diff(knots)
        self.weights = 0.5 * (np.append(width, 0.0) + np.append(0.0, width)) / knots[-1]
        steps = np.diff(self.hats, axis=0, prepend=0.0)
        steps[rows.first_rows] = self.hats[rows.first_rows]
        self._hat_steps = steps

    @property
    def bends(self) -> slice:
        """The hats with a free shape; none if the law is linear."""
        return slice(0, len(self.knots) if len(self.knots) > 2 else 0)

    def theta(self, log_tau: FloatArray, shape: FloatArray) -> FloatArray:
        """Return every ln tau, and the shape of a law that is not straight, (N + P,)."""
        return np.concatenate((log_tau, shape[self.bends]))

    def split_parameters(self, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return every ln tau, and the shape at every knot."""
        arms = len(theta) - self.bends.stop
        return theta[:arms], theta[arms:] if self.bends.stop else np.ones(2)

    def columns(self, log_tau: FloatArray) -> FloatArray:
        """Return columns of k_inf and every k under each hat: path and elongations, (M, 1+N, P)."""
        _, mean, decay = self._steps(log_tau)
        arms = _run_recursion(decay[:, :, None], mean[:, :, None] * self._hat_steps[:, None, :])
        return np.concatenate((self.hats[:, None, :], arms), axis=1)

    def slopes(self, log_tau: FloatArray, shape: FloatArray, arms: FloatArray) -> FloatArray:
        """Return derivative of each arm's elongation under a shape by its ln tau, (M, N)."""
        z, mean, decay = self._steps(log_tau)
        elongation_before = np.concatenate((np.zeros((1, len(log_tau))), arms[:-1]))
        change = (self._hat_steps @ shape)[:, None]
        return _run_recursion(decay, decay * z * elongation_before + (mean - np.exp(-z)) * change)

    def _steps(self, log_tau: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Step of each row over tau, the mean decay within it, and what passes from row to row."""
        z = self.rows.step[:, None] / np.exp(log_tau)
        change = np.expm1(-z)
        decay = 1 + change
        decay[self.rows.first_rows] = 0.0
        return z, -change / z, decay


def integrate_hats(x: FloatArray, knots: FloatArray) -> FloatArray:
    """Integral of each hat from 0 to x, shape (M, P); beyond the ends the last tangent stays."""
    width = np.diff(knots)
    i = np.clip(np.searchsorted(knots, x, side="right") - 1, 0, len(width) - 1)
    distance = np.clip(x, 0.0, knots[-1]) - knots[i]
    half_width = 0.5 * width
    lower_integrals = np.zeros((len(knots), len(knots)))
    for m in range(1, len(knots)):
        lower_integrals[m] = lower_integrals[m - 1]
        lower_integrals[m, m - 1 : m + 1] += half_width[m - 1]
    values = lower_integrals[i]
    area = 0.5 * distance**2 / width[i]
    row_index = np.arange(len(x))
    values[row_index, i] += distance - area
    values[row_index, i + 1] += area
    values[:, 0] += np.minimum(x, 0.0)
    values[:, -1] += np.maximum(x - knots[-1], 0.0)
    return values


def _run_recursion(decay: FloatArray, increments: FloatArray) -> FloatArray:
    return recursion(decay[1:], increments[1:], increments[0])


# Weighted least squares: stiffnesses solved, descent in ln tau and shape.
#
# .. math:: \min_{\tau,\,s,\,k \ge 0,\,z}\; \sum_i \frac{c_i}{\sigma_i^2}
#     \Bigl(F_i - \Phi_i(\tau, s)\,k - Z_i z\Bigr)^2 + \sum_q \frac{(z_q - \mu_q)^2}{\sigma_q^2}
#
# Nuisance terms z (offset, drift, delay) carry priors. The shape has the mean 1, which is known as
# well as the ramps show their own size.


_MAX_STEPS = 40
# a fall of the cost, in units of noise variance, that is not worth a further step
_COST_TOLERANCE = 1e-5


class Nuisances(NamedTuple):
    """Columns of load cells and clocks, shape (M, Q), with their priors."""

    names: tuple[str, ...]
    columns: FloatArray
    priors: tuple[Prior, ...]


class Bounds(NamedTuple):
    """Bounds of ln tau: from one sample of the ramp to the longest hold."""

    low: float
    high: float


def tau_bounds(rows: DownsampledRows) -> Bounds:
    """Return the range of relaxation times visible in ramp and hold, ln s."""
    shortest = min(float(rows.step[rows.record == i].min()) for i in range(len(rows.depths)))
    holds = [rows.time[rows.record == i][-1] - end for i, end in enumerate(rows.ramp_ends)]
    return Bounds(float(np.log(shortest)), float(np.log(max(holds))))


class Weighted:
    """Quasi-linear solid, with the standard deviation of a sample of each row, and nuisances.

    Theta is every ln tau, then the shape of a law that is not straight; beta every stiffness of
    each set, then the nuisances. With `apart` each record has stiffnesses of its own; relaxation
    times and shape stay shared.
    """

    def __init__(
        self, solid: QuasiLinear, sd: FloatArray, nuisances: Nuisances, *, separate: bool = False
    ) -> None:
        self.solid, self.nuisances = solid, nuisances
        self._set_index = solid.rows.record if separate else np.zeros(len(sd), dtype=np.intp)
        self.sets = int(self._set_index[-1]) + 1
        self._set_mask = (self._set_index[:, None] == np.arange(self.sets)) * 1.0
        self.root = np.sqrt(solid.rows.sample_counts) / sd
        mean, prior_sd = np.array(nuisances.priors).T.reshape(2, -1)
        data = self.root * solid.rows.force
        # how far the mean of the shape is from 1 is the last row
        self._size = float(np.linalg.norm(data[solid.rows.ramp]))
        self.target = np.concatenate((data, mean / prior_sd, [0.0]))
        self._prior_rows = self._whiten(nuisances.columns)
        self._prior_rows[len(sd) : -1] = np.diag(1.0 / prior_sd)

    def _whiten(self, columns: FloatArray) -> FloatArray:
        """Columns of the rows in units of their noise, with rows of zeros for the priors."""
        values = np.zeros((len(self.target), columns.shape[1]))
        values[: len(columns)] = self.root[:, None] * columns
        return values

    def _expand_by_row(self, k: FloatArray) -> FloatArray:
        """Stiffnesses of each row's own set, shape (M, 1 + N)."""
        return np.asarray(k.reshape(self.sets, -1)[self._set_index])

    def stiffnesses(self, best: Optimum) -> FloatArray:
        """k_inf and every k of each set, N/m, shape (S, 1 + N)."""
        return best.beta[: len(best.beta) - len(self.nuisances.names)].reshape(self.sets, -1)

    def force(self, best: Optimum) -> FloatArray:
        """Return force of the solid alone, N, shape (M,)."""
        log_tau, shape = self.solid.split_parameters(best.theta)
        columns = self.solid.columns(log_tau) @ shape
        return np.asarray(np.sum(columns * self._expand_by_row(self.stiffnesses(best)), axis=1))

    def problem(self, arms: int) -> Problem:
        """Return the problem of a number of arms, their ln tau inside the window of the rows."""
        solid, stiffness_count = self.solid, self.sets * (1 + arms)
        bend_weights = solid.weights[solid.bends]

        def model(theta: FloatArray) -> Rows:
            log_tau, shape = solid.split_parameters(theta)
            mean = float(solid.weights @ shape)
            hat_columns, shape = solid.columns(log_tau), shape / mean
            columns = hat_columns @ shape
            value = (self._set_mask[:, :, None] * columns[:, None, :]).reshape(len(columns), -1)
            A = np.concatenate((self._whiten(value), self._prior_rows), axis=1)

            def slope(beta: FloatArray) -> FloatArray:
                k = self._expand_by_row(beta[:stiffness_count])
                by_tau = solid.slopes(log_tau, shape, columns[:, 1:]) * k[:, 1:]
                force = np.sum(columns * k, axis=1)
                by_shape = (np.einsum("mnp,mn->mp", hat_columns[:, :, solid.bends], k)
                            - np.outer(force, bend_weights)) / mean  # fmt: skip
                values = self._whiten(np.concatenate((by_tau, by_shape), axis=1))
                values[-1, arms:] = self._size * bend_weights
                return values

            y = self.target.copy()
            y[-1] = self._size * (1.0 - mean)
            return Rows(y, A, slope)

        return Problem(
            model,
            [Parameter(*tau_bounds(solid.rows))] * arms + [Parameter(0.0)] * len(bend_weights),
            positive=np.arange(stiffness_count + len(self.nuisances.names)) < stiffness_count,
            priors=len(self.nuisances.names) + 1,
            gauge=self._normalise_shape if len(bend_weights) else None,
        )

    def _normalise_shape(self, theta: FloatArray) -> FloatArray:
        """Return the length of the shape is no parameter."""
        log_tau, shape = self.solid.split_parameters(theta)
        return np.concatenate((log_tau, shape / float(self.solid.weights @ shape)))

    def descend(self, theta: FloatArray) -> Optimum:
        """Return the nearest optimum, ln tau in the window of the rows, shape >= 0 of mean 1."""
        problem = self.problem(len(self.solid.split_parameters(theta)[0]))
        return require_optimum(
            problem, [theta], max_steps=_MAX_STEPS, cost_tolerance=_COST_TOLERANCE / len(self.root)
        )
