r"""A record in the metric of its own noise, where least squares is generalised least squares.

Every model of a block lies in the span of its fixed columns and of its arms' columns at some fifty
relaxation times; with Q an orthonormal basis of that span, about forty columns, and
:math:`\Gamma` the Toeplitz matrix of the noise's autocovariance,

.. math:: z = Q'y, \qquad C = Q'\Gamma Q = V \,\mathrm{diag}(c)\, V', \qquad
    \chi^2(\theta) = \sum_i \frac{\bigl(V'(z - Q'm(\theta))\bigr)_i^2}{\max(c_i, \gamma_0)}

is the deviance of a model m in units of chi-square: fast detail counts for more where the noise is
slow. What the data hold outside the span no model can answer. No direction is trusted better than
white noise of the same variance would let it be: a filter leaves next to nothing above its
cut-off, and to believe that would let its transients decide.
Source: A. C. Aitken, Proceedings of the Royal Society of Edinburgh 55 (1936) 42.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from dashpot._arrays import FloatArray
from dashpot.engine.blocks import Block, DesignBlock
from dashpot.engine.uncertainty import Noise, toeplitz_form

_TIMES_PER_FOLD = 5.0
_LAGS = 300
# kernels weaker than this part of the strongest change no deviance
_RANK = 1e-9
_ACCURACY = 1e-7


def whitened_block(exact: Block, noise: Noise) -> DesignBlock:
    """Return the data in coordinates whose noise is independent, of variance one at most.

    Parameters
    ----------
    exact : Block
        Every sample a row, in the order of time.
    noise : Noise
        Of its residuals, with a positive variance.
    """
    shortest, longest = exact.window
    # kernels scale with the clock: they are made for a window that starts at one
    tau, lags, span, weights = _kernels(round(float(np.log(longest / shortest)) + 0.05, 1))
    whole = exact.evaluate(np.log(tau * shortest), derivative=False)
    space = np.concatenate((whole.arms @ span, whole.fixed), axis=1)
    basis, factor = np.linalg.qr(space)
    variance, axes = np.linalg.eigh(toeplitz_form(basis, noise.autocovariance))
    whiten = (axes / np.sqrt(np.maximum(variance, noise.autocovariance[0]))).T
    rows = whiten @ factor
    operator, fixed = rows[:, : span.shape[1]] @ weights, rows[:, span.shape[1] :]
    lag = lags * shortest

    def columns(at: FloatArray, derivative: bool) -> tuple[FloatArray, FloatArray]:
        x = lag[:, None] / at
        decay = np.exp(-x)
        arms = operator @ decay
        return (arms, operator @ (x * decay)) if derivative else (arms, arms)

    return DesignBlock(
        target=whiten @ (basis.T @ whole.target),
        fixed=fixed,
        fixed_names=exact.fixed_names,
        columns=columns,
        window=exact.window,
        samples=exact.samples,
        arm_group=exact.arm_group,
        accuracy=_ACCURACY,
    )


@lru_cache(maxsize=8)
def _kernels(folds: float) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    r"""Fixed times, lags, V and :math:`S^{-1}U'` of the kernels :math:`e^{-t/\tau} = USV'`.

    Any kernel of the window, one to e**folds, is the fixed ones times :math:`V S^{-1}U'e(\tau)`.
    """
    tau = np.exp(np.linspace(-0.3, folds + 0.3, round(_TIMES_PER_FOLD * folds)))
    lags = np.concatenate(([0.0], np.exp(np.linspace(np.log(0.25), folds, _LAGS))))
    u, s, vt = np.linalg.svd(np.exp(-lags[:, None] / tau), full_matrices=False)
    keep = s > _RANK * s[0]
    return tau, lags, vt[keep].T, u[:, keep].T / s[keep, None]
