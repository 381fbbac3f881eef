r"""Which arms of a model a ramp and hold could have determined.

The Cramer-Rao bound of white noise, with offset and drift of the load cell found too:

.. math:: C = \sigma^2 (J^T J)^{-1}, \qquad J = \partial F / \partial (k_\infty, k_j, \ln\tau_j, o,
    \dot o)

with J over a baseline, the ramp and the hold. No unbiased fit does better. It does not include
effects of the machine: ``dashpot plan`` has that.
"""

from __future__ import annotations

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray
from dashpot.base.reported_values import NORMAL
from dashpot.base.serialisation import EVERY_FIELD, Key, Serialisable
from dashpot.numerics.inference.model_order import is_well_determined
from dashpot.planning.planned_ramp_hold import Bench
from dashpot.solids.maxwell import GeneralizedMaxwell

STIFFNESS, LOSS_FACTOR = 0.1, 0.3
"""Errors, relative and at 95 %, up to which stiffness and loss factor count as known."""

_SINGULAR = 1e-14
_PER_DECADE = 20
_BAND_MARGIN = 100.0
"""The band is sought so far, as a factor, beyond the fastest arm."""


@dataclass(frozen=True)
class TestableArm(Serialisable):
    """Arm with the relative standard deviations by a possible test.

    Attributes
    ----------
    k, tau : float
        N/m or Pa, and s.
    k_sd, tau_sd : float
        Relative; infinite where the test does not determine the arm.
    is_determined : bool
        k exceeds three standard deviations, and that of ln tau is below a half.
    """

    __test__ = False
    _keys = (EVERY_FIELD, Key("determined", "is_determined"))

    k: float
    tau: float
    k_sd: float
    tau_sd: float
    is_determined: bool


def find_testable_arms(
    model: GeneralizedMaxwell, test: Bench
) -> tuple[tuple[TestableArm, ...], tuple[float, float] | None]:
    """Return the arms that a test could have determined, and the band of such a test.

    In the band, Hz, |K| would be known to 10 % and the loss factor to 30 %; None if nowhere.
    """
    covariance = _compute_covariance(model, test)
    n = model.arms
    sd = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    k, tau = np.asarray(model.k), np.asarray(model.tau)
    k_sd, tau_sd = sd[1 : 1 + n] / k, sd[1 + n : 1 + 2 * n]
    is_testable = is_well_determined(np.ones(n), k_sd, tau_sd)
    arms = tuple(
        TestableArm(
            float(k[j]), float(tau[j]), float(k_sd[j]), float(tau_sd[j]), bool(is_testable[j])
        )
        for j in range(n)
    )
    known_part = covariance[: 1 + 2 * n, : 1 + 2 * n]
    return arms, _find_known_band(model, known_part, test.hold_time)


def _compute_covariance(model: GeneralizedMaxwell, test: Bench) -> FloatArray:
    """Return the bound of k_inf, k, ln tau, offset and drift; huge if undetermined."""
    columns = test.sensitivity(model)
    count = max(round(test.baseline * test.rate), 1)
    baseline_time = -np.arange(count, 0, -1) / test.rate
    time = np.concatenate((baseline_time, test.time()))
    J = np.zeros((len(time), columns.shape[1] + 2))
    J[count:, :-2] = columns
    J[:, -2], J[:, -1] = 1.0, time
    scale = np.linalg.norm(J, axis=0)
    scale[scale == 0] = 1.0
    triangle = np.linalg.qr(J / scale, mode="r")
    _, values, turn = np.linalg.svd(triangle, full_matrices=False)
    root = turn.T / np.maximum(values, _SINGULAR * values[0]) / scale[:, None]
    return np.asarray(test.noise**2 * root @ root.T)


def _find_known_band(
    model: GeneralizedMaxwell, covariance: FloatArray, hold_time: float
) -> tuple[float, float] | None:
    """Return the widest range of frequencies, Hz, in which stiffness and loss factor are known.

    Below the inverse of the hold time a test determines nothing.
    """
    low = 1 / (2 * np.pi * hold_time)
    high = 1 / (2 * np.pi * min(model.tau)) * _BAND_MARGIN
    if high <= low:
        return None
    count = int(np.ceil(np.log10(high / low) * _PER_DECADE)) + 1
    f = np.geomspace(low, high, count)
    s = 2j * np.pi * f
    K = model.stiffness_at(s)
    slopes = model.arm_slopes(s)[0] / K[:, None]  # d ln K = d ln |K| + j d(angle)
    size, angle = (
        np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", part, covariance, part), 0.0))
        for part in (slopes.real, slopes.imag)
    )
    loss_factor = K.imag / K.real
    factor_sd = (1 + loss_factor**2) / np.maximum(loss_factor, 1e-300) * angle
    is_known = (NORMAL * size <= STIFFNESS) & (NORMAL * factor_sd <= LOSS_FACTOR)
    best: tuple[int, int] | None = None
    start = None
    for i, is_known_line in enumerate([*is_known.tolist(), False]):
        if is_known_line and start is None:
            start = i
        elif not is_known_line and start is not None:
            if best is None or i - start > best[1] - best[0]:
                best = start, i
            start = None
    return None if best is None else (float(f[best[0]]), float(f[best[1] - 1]))
