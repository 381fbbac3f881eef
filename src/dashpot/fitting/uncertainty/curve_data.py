r"""A curve, or a creep test, as data to be explained by all the spectra that it does not reject.

A published curve states no errors. They are

.. math:: \sigma_i^2 = S, \qquad
    \mathrm{cov}_{ij} = c^2 s_i s_j \sum_n h_n(\lg t_i)\, h_n(\lg t_j)

with S the power of what the nearest non-negative spectrum leaves, by the rule of noise of every
fit (:func:`~dashpot.numerics.inference.covariance.noise_of`), s the size of that spectrum, and h_n
straight lines between knots a quarter of a decade apart: what neighbours have in common - a load
cell, a thermostat, grips, smoothing - is not seen in a residual.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.fitting.nuisance_priors import NuisanceTerms
from dashpot.fitting.relaxation_data import RelaxationRows
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.inference.covariance import JacobianColumns, ResidualSeries, noise_of
from dashpot.numerics.inference.whitening import marginal
from dashpot.numerics.least_squares.nnls import solve_linear

#: what neighbours have in common, one standard deviation relative to their size
COMMON = 2e-3
# knots to a decade between which it changes
KNOTS = 4
# no value of a curve is better than this part of its size: it has four digits
DIGITS = 1e-4
# of the grid on which the nearest spectrum is sought
PER_DECADE = 12
#: a curve of fewer values is not asked
ENOUGH = 8
_SPRINGS, _DASHPOTS = {"k_inf", "glass"}, {"b", "flow"}


@dataclass(frozen=True, eq=False)
class CurveData:
    """Rows in units of their noise, and what is doubted besides.

    Attributes
    ----------
    block : DataBlock
        A spring and a dashpot among its fixed columns, of stiffness or of compliance.
    window : (float, float)
        Shortest and longest relaxation time that is asked about, s.
    dof : float
        Degrees of freedom of the noise.
    common : array, shape (n, d)
        What rows have in common, in units of the noise.
    terms : Terms
        What is known of the other fixed columns, and unseen in those of the solid.
    """

    block: DataBlock
    window: tuple[float, float]
    dof: float
    common: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    terms: NuisanceTerms = field(default_factory=lambda: NuisanceTerms({}))

    def rows(self, log_tau: FloatArray, *, slopes: bool = True) -> RelaxationRows:
        """Everything that depends on the solid, whitened for all that is doubted."""
        evaluation = self.block.evaluate(log_tau, slopes)
        names = self.block.fixed_names
        doubts, mean = self.terms.doubts(evaluation.fixed, names)
        every = np.hstack((doubts, self.common)) if self.common.size else doubts
        white = marginal(np.zeros((len(mean), 0)), every)

        def column(kinds: set[str]) -> FloatArray:
            there = [i for i, name in enumerate(names) if name in kinds]
            return white(evaluation.fixed[:, there].sum(axis=1))

        return RelaxationRows(
            target=white(evaluation.target - mean),
            spring=column(_SPRINGS),
            dashpot=column(_DASHPOTS),
            arms=white(evaluation.arms),
            slopes=white(evaluation.d_arms),
        )


def curve_data(
    block: DataBlock, at: FloatArray, *, window: tuple[float, float], common: float = COMMON
) -> CurveData:
    """Weigh a curve by what the nearest of all non-negative spectra leaves of it.

    Parameters
    ----------
    block : DataBlock
        A row a value, in units in which the errors of each part of it are alike.
    at : array, shape (n,)
        Times or frequencies, > 0, of each of its parts: one, or storage and loss.
    window : (float, float)
        Relaxation times that are asked about, s.
    common : float
        What neighbours have in common, one standard deviation relative to their size.
    """
    n, low, high = len(at), *np.log(window)
    grid = np.linspace(low, high, int(np.ceil((high - low) / np.log(10) * PER_DECADE)) + 1)
    rows = block.evaluate(grid, False)
    columns = np.concatenate((rows.fixed, rows.arms), axis=1)
    best, _ = solve_linear(columns, rows.target, positive=True)
    nearest = columns @ best
    active = np.linalg.qr(columns[:, best > 0])[0]
    weight, worth = np.empty(len(nearest)), 0.0
    for start in range(0, len(nearest), n):
        part = slice(start, start + n)
        # a spring has no loss
        size = nearest[part] if nearest[part].any() else nearest
        least = DIGITS * float(np.sqrt(np.mean(size**2)))
        series = ResidualSeries(rows.target[part] - nearest[part])
        noise = noise_of(series, JacobianColumns(active[part], shared=True), rounding=least)
        weight[part] = 1 / np.sqrt(max(noise.power, least**2))
        worth += noise.effective
    hats = common * np.kron(np.eye(len(nearest) // n), _hats(np.log10(at)))
    return CurveData(
        block.transform_rows(lambda part: (weight * part.T).T),
        window,
        worth - np.count_nonzero(best),
        hats * (weight * nearest)[:, None],
    )


def _hats(at: FloatArray) -> FloatArray:
    """Straight lines from 1 at each knot to 0 at its neighbours, shape (n, m)."""
    count = int(np.ceil(KNOTS * float(np.ptp(at)))) + 1
    knots = float(at.min()) + np.arange(count) / KNOTS
    return np.asarray(np.maximum(1 - KNOTS * np.abs(at[:, None] - knots), 0.0))
