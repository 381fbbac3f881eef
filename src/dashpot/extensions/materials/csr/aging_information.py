r"""Fisher information of a planned compression stress relaxation test, before it is run.

A reading of specimen i in oven k is :math:`s_i\,f(t; p, \tau_k, \beta) + d\,t + \varepsilon` with
F0 :math:`s_i` free, the drift d of the load cell and white noise of the scatter of a reading. With
the columns :math:`G_k` of p, ln tau, ln beta and d,

.. math:: A_k = G_k^T \Bigl(I - \frac{f f^T}{f^T f}\Bigr) G_k / \sigma^2, \qquad
          I = \sum_k n_k D_k^T A_k D_k + P,

for n_k specimens, where D_k leads from the law and the temperature error of the oven to those
four, and P holds the priors of temperature errors and drift: the normal equations of
:func:`dashpot.extensions.materials.csr.fit.fit_aging`, with the data not yet measured.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.extensions.materials.csr.law import (
    HOUR,
    THOUSAND_HOURS,
    AgingLaw,
    retained_fraction,
)
from dashpot.solids.shift_laws import GAS_CONSTANT

_HOURS = (
    0.5, 1, 2, 5, 10, 24, 48, 72, 168, 336, 500, 750, 1000, 1500, 2000, 3000, 4000, 5000, 7000,
    10000, 15000, 20000,
)  # fmt: skip
"""Usual times of a reading."""
_ENERGY_UNIT = 1e4
"""J/mol in a unit of the activation energy."""
_STEP = 1e-5
_OVEN_PARAMETERS = 4
"""Number of parameters of an oven: physical loss, ln tau, ln exponent and drift."""


@dataclass(frozen=True)
class AgingTest:
    """Properties of a planned test except its ovens and numbers of specimens.

    Attributes
    ----------
    law : AgingLaw
        The assumed law.
    scatter : float
        Standard deviation of a reading, in parts of F0.
    oven_sd : float
        Standard deviation of the temperature of an oven, K.
    drift : float
        Standard deviation of the drift of the load cell, in parts of F0 in 1000 h.
    last_reading_time : float
        Time of the last reading, s.
    """

    law: AgingLaw
    scatter: float
    oven_sd: float
    drift: float
    last_reading_time: float

    @property
    def times(self) -> FloatArray:
        """Usual times of readings up to the longest, s."""
        reading_times = [
            HOUR * value for value in _HOURS if HOUR * value < 0.999 * self.last_reading_time
        ]
        return np.array([*reading_times, self.last_reading_time])

    def compute_specimen_information(self, temperature: float) -> FloatArray:
        """Return the information of a specimen on loss, ln tau, ln exponent and drift, (4, 4)."""
        law, time = self.law, self.times
        rate = 1 / law.tau(temperature)

        def shape(loss: float, log_tau: float, log_exponent: float) -> FloatArray:
            return retained_fraction(
                time, law.physical + loss, rate * np.exp(-log_tau),
                law.exponent * np.exp(log_exponent),
            )  # fmt: skip

        columns = [
            (shape(*(_STEP * step_signs)) - shape(*(-_STEP * step_signs))) / (2 * _STEP)
            for step_signs in np.eye(3)
        ]
        G = np.column_stack((*columns, self.drift * time / THOUSAND_HOURS))
        f = shape(0.0, 0.0, 0.0)
        G -= np.outer(f, f @ G) / (f @ f)
        return np.asarray(G.T @ G / self.scatter**2)

    def compute_life_gradient(self, temperature: float, fraction: float) -> FloatArray:
        """Return the derivatives of the ln life by loss, ln tau, Ea in 10 kJ/mol, ln exponent."""
        law = self.law

        def log_life(**other: Any) -> float:
            return replace(law, **other).compute_log_life(temperature, fraction)

        steps = {"physical": 1e-4, "chemical": 1e-4, "activation": 10.0}
        gradient = [
            (log_life(**{name: getattr(law, name) + step})
             - log_life(**{name: getattr(law, name) - step})) / (2 * step)
            for name, step in steps.items()
        ]  # fmt: skip
        gradient[2] *= _ENERGY_UNIT
        upper, lower = (log_life(exponent=law.exponent * np.exp(sign * 1e-4)) for sign in (1, -1))
        return np.array([*gradient, (upper - lower) / 2e-4])


class PlannedOvens:
    """Information of ovens on the law, to which specimens are added.

    Attributes
    ----------
    temperatures : tuple of float
        K.
    """

    def __init__(self, test: AgingTest, temperatures: Sequence[float]) -> None:
        self.temperatures = tuple(temperatures)
        self._test, count = test, len(self.temperatures)
        law, parameter_count = test.law, 5 + count
        # loss, ln tau at the reference, Ea, ln exponent, drift, then each oven's temperature
        prior = np.zeros(parameter_count)
        prior[4] = 1.0 if test.drift else np.inf
        prior[5:] = 1.0 if test.oven_sd else np.inf
        is_fixed = ~np.isfinite(prior)
        is_fixed[3] |= law.exponent == 1
        self._free = np.flatnonzero(~is_fixed)
        self._prior = np.diag(prior[self._free])
        self._parts = []
        for k, kelvin in enumerate(self.temperatures):
            D = np.zeros((_OVEN_PARAMETERS, parameter_count))
            D[0, 0] = D[1, 1] = D[2, 3] = D[3, 4] = 1.0
            D[1, 2] = _ENERGY_UNIT * (1 / kelvin - 1 / law.reference) / GAS_CONSTANT
            D[1, 5 + k] = -law.activation * test.oven_sd / (GAS_CONSTANT * kelvin**2)
            D = D[:, self._free]
            self._parts.append(D.T @ test.compute_specimen_information(kelvin) @ D)

    def compute_life_sd(self, specimens: Sequence[int], gradient: FloatArray) -> float:
        """Return the standard deviation of the ln life for numbers of specimens in each oven.

        Parameters
        ----------
        specimens : sequence of int
        gradient : array, shape (4,)
            Gradient of the ln life, as :meth:`AgingTest.compute_life_gradient` gives it.
        """
        full_gradient = np.zeros(5 + len(self.temperatures))
        full_gradient[:4] = gradient
        g = full_gradient[self._free]
        information = self._prior + sum(
            n * part for n, part in zip(specimens, self._parts, strict=True)
        )
        return float(np.sqrt(g @ np.linalg.solve(information, g)))

    def compute_oven_significance(self, specimens: Sequence[int]) -> tuple[float, ...]:
        """Return the chemical rate of each oven by itself in its expected standard errors."""
        test, count = self._test, len(self.temperatures)
        is_stretched = test.law.exponent != 1
        parameter_count = 2 + int(is_stretched) + count
        information = np.zeros((parameter_count, parameter_count))
        information[-1, -1] = 1.0  # the prior of the drift, last
        for k, (kelvin, n) in enumerate(zip(self.temperatures, specimens, strict=True)):
            D = np.zeros((_OVEN_PARAMETERS, parameter_count))
            D[0, 0] = D[1, 1 + k] = D[3, parameter_count - 1] = 1.0
            if is_stretched:
                D[2, 1 + count] = 1.0
            information += n * D.T @ test.compute_specimen_information(kelvin) @ D
        errors = np.sqrt(np.diag(np.linalg.inv(information)))[1 : 1 + count]
        return tuple((1 / errors).tolist())
