r"""The Cramer-Rao bound of a ramp-and-hold test on the stiffness at a frequency.

With the ramp known and white noise of standard deviation sigma, no unbiased fit of
:math:`\theta = (k_\infty, k_j, \ln\tau_j)` does better than

.. math::

    C = \sigma^2 (J^T J)^{-1}, \qquad
    \mathrm{sd}(g) = \sqrt{\nabla g^T C\, \nabla g}, \quad g = K', \tan\delta

with J the sensitivities of the force (paper eqs. 1-5) at every sample.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.planning.needs import ExpectedError
from dashpot.solids.maxwell import GeneralizedMaxwell

# directions with less than this share of the information are not known at all
SINGULAR = 1e-14


@dataclass(frozen=True)
class Bench:
    """A ramp-and-hold test to be: SI units, `rate` in Hz, `noise` in N per sample."""

    depth: float
    ramp_time: float
    hold_time: float
    rate: float
    noise: float
    method: str
    drift: bool = False

    def time(self) -> FloatArray:
        """The samples that the method fits, s from the start of the ramp, shape (n,)."""
        count = round((self.ramp_time + self.hold_time) * self.rate)
        t = np.arange(1, count + 1) / self.rate
        return t if self.method == "full" else t[t >= self.ramp_time * (1 - 1e-12)]

    def sensitivity(self, model: GeneralizedMaxwell) -> FloatArray:
        r"""Return J = dF / d(k_inf, k, ln tau[, offset, drift]), shape (n, p), N per unit."""
        t = self.time()
        speed = self.depth / self.ramp_time
        tau, k = np.asarray(model.tau), np.asarray(model.k)
        up = np.minimum(t, self.ramp_time)[:, None]
        held = np.maximum(t - self.ramp_time, 0.0)[:, None]
        fade = np.exp(-held / tau)
        arm = -tau * np.expm1(-up / tau) * fade
        # d/d ln tau of tau (1 - e^{-u/tau}) e^{-h/tau}
        slope = arm * (1 + held / tau) - up * np.exp(-up / tau) * fade
        columns = [speed * up, speed * arm, speed * slope * k]
        if self.drift:
            columns += [np.ones((len(t), 1)), t[:, None]]
        return np.hstack(columns)

    def rows(self, model: GeneralizedMaxwell) -> FloatArray:
        """The sensitivities in units of the noise, reduced to a triangle, shape (p, p)."""
        return np.asarray(np.linalg.qr(self.sensitivity(model), mode="r")) / self.noise


def expected_error(
    model: GeneralizedMaxwell,
    bench: Bench,
    at: float,
    arm: int | None,
    hammer: FloatArray | None = None,
) -> ExpectedError:
    """What the test leaves unknown at `at` Hz; `arm` is the index of the unseen arm.

    `hammer` holds the rows of a hammer test in the same parameters and one more, the mass:
    with them both tests are fitted together.
    """
    rows = bench.rows(model)
    if hammer is not None:
        own = hammer.shape[1] - 1
        mass = np.vstack((np.zeros((len(rows), 1)), hammer[:, -1:]))
        extra = np.zeros((len(hammer), rows.shape[1] - own))
        rows = np.hstack((np.vstack((rows, np.hstack((hammer[:, :-1], extra)))), mass))
    covariance = _covariance(rows)
    storage, loss_factor, gradients = _gradients(model, at)
    sizes = [
        float(np.sqrt(max(row @ covariance @ row, 0.0)))
        for row in np.pad(gradients, ((0, 0), (0, len(covariance) - gradients.shape[1])))
    ]
    return ExpectedError(
        method=bench.method if hammer is None else "joint",
        ramp_time=bench.ramp_time,
        hold_time=bench.hold_time,
        storage_sd=sizes[0] / storage,
        loss_factor_sd=sizes[1] / loss_factor,
        arm_sd=None if arm is None else float(np.sqrt(covariance[1 + arm, 1 + arm])) / model.k[arm],
    )


def _covariance(rows: FloatArray) -> FloatArray:
    """Return (J'J)^-1 by singular values, huge where J says nothing."""
    scale = np.linalg.norm(rows, axis=0)
    scale[scale == 0] = 1.0
    _, values, vectors = np.linalg.svd(rows / scale, full_matrices=False)
    values = np.maximum(values, SINGULAR * values[0])
    root = vectors.T / values / scale[:, None]
    return np.asarray(root @ root.T)


def _gradients(model: GeneralizedMaxwell, at: float) -> tuple[float, float, FloatArray]:
    r"""Storage stiffness, loss factor, and their gradients in (k_inf, k, ln tau), shape (2, p)."""
    x = 2 * np.pi * at * np.asarray(model.tau)
    k = np.asarray(model.k)
    unit = 1j * x / (1 + 1j * x)
    slope = k * 1j * x / (1 + 1j * x) ** 2
    stiffness = complex(model.k_inf + unit @ k)
    complex_gradient = np.concatenate(([1.0], unit, slope))
    loss_factor = stiffness.imag / stiffness.real
    storage = complex_gradient.real
    ratio = (complex_gradient.imag - loss_factor * complex_gradient.real) / stiffness.real
    return stiffness.real, loss_factor, np.array([storage, ratio])
