r"""All models of a record as some forty numbers each.

Every model of a block lies, to seven digits, in the span of its fixed columns G and of its arms'
columns :math:`\Phi_k` at some fifty fixed relaxation times, since their kernels do: with
:math:`E = USV'` the kernels :math:`e^{-t/\tau_k}` and e(tau) any other, both at some 300 lags,

.. math:: \varphi(\tau) = \Phi_k V S^{-1} U'\, e(\tau), \qquad [\Phi_k V,\, G] = QR

What the data hold outside the span of Q no model can answer.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from dashpot._arrays import FloatArray
from dashpot.engine.blocks import Block, DesignBlock

_TIMES_PER_FOLD = 5.0
_LAGS = 300
_AT_ONCE = 16
# kernels weaker than this part of the strongest change no deviance
_RANK = 1e-9
_ACCURACY = 1e-7


class Span(NamedTuple):
    """A record in the coordinates of its models.

    Attributes
    ----------
    basis : array, shape (n, r)
        Q, orthonormal columns, one row per sample.
    block : DesignBlock
        Q'y, Q'G and Q' phi, r rows.
    """

    basis: FloatArray
    block: DesignBlock


def span_of(exact: Block) -> Span:
    """Return the span of a block that has every sample as a row, in the order of time."""
    shortest, longest = exact.window
    # kernels scale with the clock: they are made for a window that starts at one
    tau, lags, right, left = _kernels(round(float(np.log(longest / shortest)) + 0.05, 1))
    plain = exact.evaluate(np.zeros(0), derivative=False)
    rank = right.shape[1]
    space = np.zeros((len(plain.target), rank + plain.fixed.shape[1]))
    for first in range(0, len(tau), _AT_ONCE):
        part = slice(first, first + _AT_ONCE)
        arms = exact.evaluate(np.log(tau[part] * shortest), derivative=False).arms
        space[:, :rank] += arms @ right[part]
    space[:, rank:] = plain.fixed
    basis, factor = np.linalg.qr(space)
    operator, lag = factor[:, :rank] @ left, lags * shortest

    def columns(at: FloatArray, derivative: bool) -> tuple[FloatArray, FloatArray]:
        x = lag[:, None] / at
        decay = np.exp(-x)
        arms = operator @ decay
        return (arms, operator @ (x * decay)) if derivative else (arms, arms)

    block = DesignBlock(
        target=basis.T @ plain.target,
        fixed=factor[:, rank:],
        fixed_names=exact.fixed_names,
        columns=columns,
        window=exact.window,
        samples=exact.samples,
        arm_group=exact.arm_group,
        accuracy=_ACCURACY,
    )
    return Span(basis, block)


@lru_cache(maxsize=8)
def _kernels(folds: float) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Fixed times, lags, V and S^-1 U' for a window from one to e**folds."""
    tau = np.exp(np.linspace(-0.3, folds + 0.3, round(_TIMES_PER_FOLD * folds)))
    lags = np.concatenate(([0.0], np.exp(np.linspace(np.log(0.25), folds, _LAGS))))
    u, s, vt = np.linalg.svd(np.exp(-lags[:, None] / tau), full_matrices=False)
    keep = s > _RANK * s[0]
    return tau, lags, vt[keep].T, u[:, keep].T / s[keep, None]
