r"""The frequencies that a relaxation test can inform.

Ask the test about any seal, not about the one arm model it happened to choose: arms at half
decades of tau, none of them known beyond a plausible size (a tenth of the stiffness found, one
standard deviation). The test then leaves a posterior spread of the loss stiffness

.. math:: K''(\omega) = \sum_j k_j \frac{\omega\tau_j}{1 + \omega^2\tau_j^2}

and a frequency is informed where that spread is at most half of what it was before. Noise,
sampling, ramp, hold, offset and drift all enter through the columns of the fit. Beyond what
noise allows, no frequency is claimed that the motion itself hardly holds: above
:math:`1/(\pi c)` for the shortest ramp c, above half the sampling rate, or below one radian in
the longest hold.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from dashpot.base.arrays import FloatArray, find_true_runs
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.exponential_fit.log_tau_descent import Stack

_PER_DECADE = 2
_PLAUSIBLE = 0.1
_LEARNED = 0.5
_FREQUENCIES_PER_DECADE = 20


class HeldTest(Protocol):
    """The times of a ramp and hold, of a motion or of a load."""

    @property
    def time(self) -> FloatArray:
        """Of every sample, s."""

    @property
    def ramp_time(self) -> float:
        """How long the ramp takes, s."""

    @property
    def hold_time(self) -> float:
        """How long the hold lasts, s."""


def informed_band(
    tests: Sequence[HeldTest],
    blocks: Sequence[DataBlock],
    *,
    stiffness: float,
    noise: float,
    slower: Sequence[float] | None = None,
) -> tuple[float, float]:
    """Return the band, Hz; both ends equal if the test informs no frequency by half.

    Parameters
    ----------
    tests, blocks : sequences
        The tests and their compressed blocks.
    stiffness : float
        k_0 of the solid found, N/m; of a creep test its compliance at rest, m/N.
    noise : float
        Standard deviation of one residual, N or m, widened for correlation (s times root kappa).
    slower : sequence of float, optional
        How many times slower than the solid asked about each test's was: its shift factor.
    """
    group = list(zip(tests, slower or [1.0] * len(tests), strict=True))
    slowest = 1.0 / (2.0 * np.pi * max(test.hold_time / a for test, a in group))
    step = min(float(np.diff(test.time).min()) / a for test, a in group)
    ramp = min(test.ramp_time / a for test, a in group)
    fastest = min(1.0 / (np.pi * max(ramp, step)), 0.5 / step)
    frequency, residual = compute_posterior_spread(blocks, stiffness=stiffness, noise=noise)
    return _widest(frequency, residual, slowest, fastest)


def find_single_test_band(
    block: DataBlock, *, stiffness: float, noise: float
) -> tuple[float, float]:
    """Return the band of one test by its noise alone, Hz, whatever its motion holds."""
    frequency, residual = compute_posterior_spread([block], stiffness=stiffness, noise=noise)
    return _widest(frequency, residual, float(frequency[0]), float(frequency[-1]))


def compute_posterior_spread(
    blocks: Sequence[DataBlock], *, stiffness: float, noise: float
) -> tuple[FloatArray, FloatArray]:
    """Return frequencies, Hz, and the part of the prior spread of K'' that the test leaves."""
    stack = Stack(blocks)
    low, high = stack.bounds
    decades = (high - low) / np.log(10.0) + 2.0
    log_tau = np.linspace(low - np.log(10.0), high + np.log(10.0), int(_PER_DECADE * decades) + 1)
    rows = stack.evaluate(log_tau, derivative=False)
    fixed, arms = rows.phi[:, : len(stack.names)], rows.phi[:, len(stack.names) :]
    basis = np.linalg.qr(fixed)[0]
    # spring, offset and drift are free: what they explain tells nothing of an arm
    arms = arms - basis @ (basis.T @ arms)
    prior = _PLAUSIBLE * stiffness
    information = arms.T @ arms * (prior / noise) ** 2
    posterior = np.linalg.inv(information + np.eye(len(log_tau)))
    tau = np.exp(log_tau)
    count = int(_FREQUENCIES_PER_DECADE * decades)
    omega = np.exp(-np.linspace(log_tau[-1], log_tau[0], count))
    x = omega[:, None] * tau
    loss = x / (1.0 + x * x)
    # what millions of samples leave is less than its rounding
    spread = np.maximum(((loss @ posterior) * loss).sum(axis=1), 0.0)
    remainder = np.sqrt(spread / (loss * loss).sum(axis=1))
    return omega / (2.0 * np.pi), remainder


def _widest(
    frequency: FloatArray, left: FloatArray, slowest: float, fastest: float
) -> tuple[float, float]:
    best = float(
        np.clip(frequency[int(np.argmin(left))], min(slowest, fastest), max(slowest, fastest))
    )
    ends = frequency[find_true_runs(left <= _LEARNED)].tolist()
    clipped = [(max(low, slowest), min(high, fastest)) for low, high in ends]
    wide = [(low, high) for low, high in clipped if high > low]
    return max(wide, key=lambda run: run[1] / run[0], default=(best, best))
