"""The few dimensions that all columns of one compressed sampling live in."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray, IndexArray
from dashpot.engine.blocks.block import DesignBlock

TIMES_PER_FOLD = 9.5
RANK = 1e-14


class ColumnSpace(NamedTuple):
    r"""The few dimensions that the compressed columns of a sampling live in.

    With B an orthonormal basis of them, the fixed columns first, :math:`G = B_f F`, and S as many
    nodes as it has columns, so chosen that B_S is well conditioned,

    .. math:: B'\varphi(\tau) = B_S^{-1} \varphi_S(\tau)

    Attributes
    ----------
    basis : array, shape (n, q + r)
    triangle : array, shape (q, q)
        F.
    inverse : array, shape (q + r, q + r)
        The inverse of B_S.
    chosen : DesignBlock
        The columns at the nodes S alone.
    """

    basis: FloatArray
    triangle: FloatArray
    inverse: FloatArray
    chosen: DesignBlock


def column_space(
    template: DesignBlock, at_nodes: Callable[[slice | IndexArray], DesignBlock]
) -> ColumnSpace:
    """Return the space of a block's columns; `at_nodes` makes the block at some of its rows."""
    low, high = np.log(template.window)
    tau = np.exp(np.linspace(low, high, round(TIMES_PER_FOLD * (high - low))))
    columns = template.columns(tau, False)[0]
    fixed = np.linalg.qr(template.fixed)[0]
    swept = columns - fixed @ (fixed.T @ columns)
    u, s, _ = np.linalg.svd(swept / np.linalg.norm(columns, axis=0), full_matrices=False)
    # the last directions hold rounding along the fixed columns
    basis, r = np.linalg.qr(np.concatenate((template.fixed, u[:, s > RANK * s[0]]), axis=1))
    nodes, q = _independent(basis), template.fixed.shape[1]
    return ColumnSpace(basis, r[:q, :q], np.linalg.inv(basis[nodes]), at_nodes(nodes))


def _independent(basis: FloatArray) -> IndexArray:
    """As many rows as there are columns, each the farthest from the span of those before it."""
    rest, chosen = basis.copy(), []
    for _ in range(basis.shape[1]):
        square = np.vecdot(rest, rest)
        chosen.append(int(np.argmax(square)))
        unit = rest[chosen[-1]] / np.sqrt(square[chosen[-1]])
        rest -= np.outer(rest @ unit, unit)
    return np.sort(np.array(chosen))
