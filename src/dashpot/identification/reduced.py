r"""A block of many rows as one of a hundred, by interpolation in ln tau.

An arm's column, made of :math:`e^{-t/\tau}`, is bounded and analytic in ln tau in a strip of half
width pi/2, so its Chebyshev series on a window of half length L converges like
:math:`\rho^{-n}`, :math:`\rho = \frac{\pi}{2L} + \sqrt{1 + (\frac{\pi}{2L})^2}`: 128 nodes hold
ten decades to 1e-7 or better. The columns at the nodes and the fixed ones span everything that a
fit can ask for; in that basis a row per basis vector is left.
"""

from __future__ import annotations

import numpy as np

from dashpot._arrays import FloatArray
from dashpot.engine.blocks import DesignBlock

NODES = 128


def reduced(block: DesignBlock, *, shortest: float, longest: float) -> DesignBlock:
    """Return the block for relaxation times from `shortest` to `longest`, s, in few rows."""
    low, high = np.log(shortest), np.log(longest)
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    u = np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)
    at_nodes = block.columns(np.exp(middle + half * u), False)[0]
    every = np.column_stack((block.fixed, at_nodes))
    basis = np.linalg.qr(every / np.linalg.norm(every, axis=0))[0]
    target = basis.T @ block.target
    rest = block.target - basis @ target
    series = np.linalg.solve(np.polynomial.chebyshev.chebvander(u, NODES - 1), at_nodes.T @ basis)
    slope = np.polynomial.chebyshev.chebder(series) / half

    def columns(tau: FloatArray, derivative: bool) -> tuple[FloatArray, FloatArray]:
        place = (np.log(tau) - middle) / half
        powers = np.polynomial.chebyshev.chebvander(place, NODES - 1)
        arms = (powers @ series).T
        return arms, (powers[:, :-1] @ slope).T if derivative else arms

    return DesignBlock(
        target=target,
        fixed=basis.T @ block.fixed,
        fixed_names=block.fixed_names,
        columns=columns,
        window=block.window,
        floor=block.floor + float(rest @ rest),
        samples=block.samples,
        arm_group=block.arm_group,
    )
