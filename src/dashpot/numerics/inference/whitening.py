r"""A record in the metric of its own noise.

Every model of a record lies, to seven digits, in the span of its fixed columns G and of the space
:math:`\Phi V` of its kernels (:mod:`dashpot.numerics.design_matrices.relaxation_kernels`),
:math:`[\Phi V,\, G] = QR`; what the data hold outside the span of Q no model can answer. With
:math:`\Gamma` the Toeplitz matrix of the noise's autocovariance,

.. math:: C = Q'\Gamma Q = V \,\mathrm{diag}(c)\, V', \qquad
    \chi^2(\theta) = \sum_i \frac{\bigl(V'Q'(y - m(\theta))\bigr)_i^2}{\max(c_i, \gamma_0)}

is the deviance of a model m in units of chi-square, and its least value is that of generalised
least squares: fast detail counts for more where the noise is slow. No direction is trusted better
than white noise of the same variance would let it be: a filter leaves next to nothing above its
cut-off, and to believe that would let its transients decide.
So slow noise is as good as white above some frequency, and means over a few neighbours, which keep
what is below it, stand for the record.
What a record holds beside the model, columns that are free or known to within a standard deviation,
adds to that covariance too, and is taken out likewise (``marginal``).
Source: A. C. Aitken, Proceedings of the Royal Society of Edinburgh 55 (1936) 42.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray, block_means, cache_on_record
from dashpot.numerics.design_matrices.block import DataBlock, design_rows
from dashpot.numerics.design_matrices.relaxation_kernels import (
    FEW_DIGITS,
    FEW_RANK,
    FEW_TIMES_PER_FOLD,
    Kernels,
)
from dashpot.numerics.exponential_fit.log_tau_descent import Stack
from dashpot.numerics.exponential_fit.variable_projection import Solution, full_jacobian
from dashpot.numerics.inference.covariance import JacobianColumns, Noise, toeplitz_form

# rows of a tall matrix that a cache holds
AT_ONCE = 1024


def whitened_block(exact: DataBlock, noise: Noise) -> DataBlock:
    """Return the data in coordinates whose noise is independent, of variance one at most.

    Parameters
    ----------
    exact : DataBlock
        Every sample a row, in the order of time.
    noise : Noise
        Of its residuals, with a positive variance.
    """
    basis = reduced_basis(exact, compute_averaging_length(noise))
    variance, axes = _principal(basis, noise)
    whiten = (axes / np.sqrt(variance)).T
    return basis.block.transform_rows(lambda part: whiten @ part)


def marginal(free: FloatArray, doubts: FloatArray) -> Callable[[FloatArray], FloatArray]:
    """Return what makes noise of covariance 1 + C C' white, free columns projected out.

    Parameters
    ----------
    free : array, shape (n, q)
        Columns of which nothing is known.
    doubts : array, shape (n, m)
        C, known columns times their standard deviation.
    """
    private = np.linalg.qr(free)[0]
    axes, stretch, _ = np.linalg.svd(doubts - private @ (private.T @ doubts), full_matrices=False)
    shrink = 1 - 1 / np.sqrt(1 + stretch**2)

    def white(columns: FloatArray) -> FloatArray:
        residual = columns - private @ (private.T @ columns)
        along = axes.T @ residual
        return np.asarray(residual - axes @ (shrink.reshape(-1, *[1] * (along.ndim - 1)) * along))

    return white


class ReducedBasis(NamedTuple):
    """A record in the coordinates of its models.

    Attributes
    ----------
    basis : Columns, shape (n, r)
        Q, orthonormal columns, a row for each mean over a few samples times the root of how many.
    block : DataBlock
        Q'y, Q'G and Q' phi, r rows.
    """

    basis: JacobianColumns
    block: DataBlock


def reduced_basis(exact: DataBlock, few: int) -> ReducedBasis:
    """Return the span of a block that has every sample as a row, in the order of time.

    Of means over `few` neighbours; found once.
    """
    bases = _bases(exact)
    if few not in bases:
        bases[few] = _make_reduced_basis(exact, few)
    return bases[few]


@cache_on_record
def _bases(_: DataBlock) -> dict[int, ReducedBasis]:
    """Those that were found of a block, by how many neighbours are one."""
    return {}


def _make_reduced_basis(exact: DataBlock, few: int) -> ReducedBasis:
    kernels = Kernels.from_window(exact.window, per_fold=FEW_TIMES_PER_FOLD, rank=FEW_RANK)
    target, fixed, *_ = exact.evaluate(np.zeros(0), False)

    def means(columns: FloatArray) -> FloatArray:
        return np.sqrt(few) * block_means(columns.T, few).T if few > 1 else columns

    space = kernels.space(exact, means)
    basis, factor = compute_blockwise_qr(np.concatenate((space, means(fixed)), axis=1))
    rank = kernels.right.shape[1]
    rows = design_rows(basis.T @ means(target), factor[:, rank:], kernels.columns(factor[:, :rank]))
    return ReducedBasis(JacobianColumns(basis), replace(exact, rows=rows, accuracy=FEW_DIGITS))


def compute_blockwise_qr(tall: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Q and R of a tall matrix, by pieces that a cache holds."""
    pieces = [np.linalg.qr(tall[i : i + AT_ONCE]) for i in range(0, len(tall), AT_ONCE)]
    turn, factor = np.linalg.qr(np.concatenate([piece.R for piece in pieces]))
    basis, row, at = np.empty((len(tall), turn.shape[1])), 0, 0
    for values, (rows, columns) in ((piece.Q, piece.Q.shape) for piece in pieces):
        np.matmul(values, turn[at : at + columns], out=basis[row : row + rows])
        row, at = row + rows, at + columns
    return basis, factor


class NoiseGain:
    r"""The noise that meets a change d of the model, :math:`d'\Gamma d / d'd`.

    Parameters
    ----------
    every_sample : sequence of DataBlock
        One per record, every sample a row.
    noises : sequence of Noise
    solution : Solution
        The model that changes.
    """

    def __init__(
        self, every_sample: Sequence[DataBlock], noises: Sequence[Noise], solution: Solution
    ) -> None:
        pairs = zip(every_sample, noises, strict=True)
        spans = [reduced_basis(block, compute_averaging_length(noise)) for block, noise in pairs]
        blocks = [basis.block for basis in spans]
        self._stack = Stack(blocks)
        self._cuts = np.cumsum([len(block.target) for block in blocks])[:-1]
        self._principal = [_principal(*pair) for pair in zip(spans, noises, strict=True)]
        self._jacobian = full_jacobian(blocks, solution).matrix
        self._model = self._evaluate_model(solution.beta, solution.log_tau)

    def compute_step_gain(self, step: FloatArray) -> float:
        """Return it for a small step of the parameters, in the order of the Jacobian."""
        return self._compute_gain(self._jacobian @ step)

    def at(self, beta: FloatArray, log_tau: FloatArray) -> float:
        """Return it for the way to other linear parameters and relaxation times."""
        return self._compute_gain(self._evaluate_model(beta, log_tau) - self._model)

    def _evaluate_model(self, beta: FloatArray, log_tau: FloatArray) -> FloatArray:
        return np.asarray(self._stack.evaluate(log_tau, derivative=False).phi @ beta)

    def _compute_gain(self, change: FloatArray) -> float:
        change = change / max(float(np.abs(change).max()), 1e-150)  # a walk may go very far
        parts = np.split(change, self._cuts)
        met = sum(
            float(variance @ (axes.T @ part) ** 2)
            for part, (variance, axes) in zip(parts, self._principal, strict=True)
        )
        return met / max(float(change @ change), 1e-300)


def compute_averaging_length(noise: Noise) -> int:
    r"""How many neighbours may count as one, a power of two.

    Noise of correlation :math:`\kappa` falls to the power of white noise of its variance at some
    :math:`1/(\pi\sqrt\kappa)` of a sample's frequency, for an autoregressive one: means over a
    quarter of :math:`\sqrt\kappa` samples leave what is slower than that.
    """
    return 1 << max(int(np.log2(noise.kappa) / 2 - 2), 0)


def _principal(basis: ReducedBasis, noise: Noise) -> tuple[FloatArray, FloatArray]:
    """Return the variances of the noise along its principal axes, and these as columns."""
    gamma, few = noise.autocovariance, compute_averaging_length(noise)
    met = toeplitz_form(basis.basis, gamma if few == 1 else _average_autocovariance(gamma, few))
    variance, axes = np.linalg.eigh(met)
    return np.maximum(variance, gamma[0]), axes


def _average_autocovariance(gamma: FloatArray, few: int) -> FloatArray:
    """The autocovariance, of `few` lags at least, of means over neighbours, times their number."""
    share = 1 - np.abs(np.arange(1 - few, few)) / few
    # from the lag -(few - 1) on, and as far as any is left
    both = np.concatenate((gamma[few - 1 : 0 : -1], gamma, np.zeros(2 * few)))
    return np.asarray(np.convolve(both, share, "valid")[::few])
