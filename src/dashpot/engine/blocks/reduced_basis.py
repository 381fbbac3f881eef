r"""All models of a record as some forty numbers each.

Every model of a block lies, to seven digits, in the span of its fixed columns G and of its arms'
columns :math:`\Phi_k` at some fifty fixed relaxation times, since their kernels do: with
:math:`E = USV'` the kernels :math:`e^{-t/\tau_k}` and e(tau) any other, both at some 300 lags,

.. math:: \varphi(\tau) = \Phi_k V S^{-1} U'\, e(\tau), \qquad [\Phi_k V,\, G] = QR

What the data hold outside the span of Q no model can answer.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.engine.blocks.block import Block, DesignBlock
from dashpot.engine.blocks.kernels import Kernels

_TIMES_PER_FOLD = 5.0
_AT_ONCE = 16
# kernels weaker than this part of the strongest change no deviance
_RANK = 1e-9
_ACCURACY = 1e-7


class ReducedBasis(NamedTuple):
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


def reduced_basis(exact: Block) -> ReducedBasis:
    """Return the span of a block that has every sample as a row, in the order of time."""
    kernels = Kernels.over(exact.window, per_fold=_TIMES_PER_FOLD, rank=_RANK)
    plain = exact.evaluate(np.zeros(0), derivative=False)
    rank = kernels.right.shape[1]
    space = np.zeros((len(plain.target), rank + plain.fixed.shape[1]))
    for first in range(0, len(kernels.tau), _AT_ONCE):
        part = slice(first, first + _AT_ONCE)
        arms = exact.evaluate(np.log(kernels.tau[part]), derivative=False).arms
        space[:, :rank] += arms @ kernels.right[part]
    space[:, rank:] = plain.fixed
    basis, factor = np.linalg.qr(space)
    block = DesignBlock(
        target=basis.T @ plain.target,
        fixed=factor[:, rank:],
        fixed_names=exact.fixed_names,
        columns=kernels.columns(factor[:, :rank] @ kernels.left),
        window=exact.window,
        samples=exact.samples,
        arm_group=exact.arm_group,
        accuracy=_ACCURACY,
    )
    return ReducedBasis(basis, block)
