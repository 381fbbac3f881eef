r"""Aging law: counterforce by physical relaxation and Arrhenius aging.

.. math:: \frac{F}{F_0} = \Bigl(1 - p \log_{10}\frac{t}{t_0}\Bigr)
          \exp\Bigl[-\Bigl(\frac{t - t_0}{\tau(T)}\Bigr)^{\beta}\Bigr], \qquad
          \ln\tau = \ln\tau_r + \frac{E_a}{R}\Bigl(\frac1T - \frac1{T_r}\Bigr)

The first factor is physical: rapid, reversible, and the same at all temperatures, for a shift of
its time cancels from F/F0 to first order. The second is chemical, and alone follows Arrhenius.
:math:`t_0` is 30 min (ISO 3384-1).
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import EqualByValue, FloatArray
from dashpot.base.units import parse_quantity
from dashpot.numerics.inference.covariance_estimate import propagate_covariance
from dashpot.solids.shift_laws import GAS_CONSTANT

F0_TIME = 1800.0
"""Time of F0 after the compression, s."""
MAX_LIFETIME = 1e12
"""Longest lifetime that is computed, s: thirty thousand years."""
ONE_SIDED_QUANTILE = 1.645
"""Standard errors of a limit to one side, 95 %."""
HOUR = parse_quantity("1h", "time")
THOUSAND_HOURS = parse_quantity("1000h", "time")
"""Time in which the drift of a load cell is stated, s."""
YEAR = parse_quantity("8766h", "time")
_DERIVATIVE_STEPS = np.array([1e-4, 1e-3, 10.0, 1e-4])
"""Steps of physical, chemical, activation and ln exponent in a derivative."""


def retained_fraction(
    time: FloatArray, physical: float, rate: FloatArray | float, exponent: float = 1.0
) -> FloatArray:
    """Return F/F0 at times, s, by the physical loss in a decade and the chemical rate, 1/s."""
    scaled_time = np.maximum(time - F0_TIME, 0.0) * rate
    aged = np.sign(scaled_time) * np.abs(scaled_time) ** exponent
    return np.asarray((1 - physical * np.log10(time / F0_TIME)) * np.exp(-aged))


@dataclass(frozen=True, eq=False)
class AgingLaw(EqualByValue):
    """Constants of the aging law, with their covariance.

    Attributes
    ----------
    physical : float
        Loss in a decade of time.
    chemical : float
        ln of tau at the reference, s.
    activation : float
        J/mol; 0 where one oven shows none.
    exponent : float
        Exponent of the chemical factor.
    reference : float
        K.
    covariance : array, shape (4, 4)
        Covariance of physical, chemical, activation and ln exponent; infinite if unknown.
    quantile : float
        Standard errors to either end of a 95 % interval.
    is_lower_bound : bool
        No chemical relaxation was detected: tau is a lower limit, valid up to the reference.
    """

    physical: float
    chemical: float
    activation: float
    exponent: float
    reference: float
    covariance: FloatArray
    quantile: float
    is_lower_bound: bool = False

    @property
    def errors(self) -> list[float]:
        """Standard errors of the four."""
        values: list[float] = np.sqrt(np.diag(self.covariance)).tolist()
        return values

    def tau(self, temperature: float) -> float:
        """Return time of the chemical factor at a temperature, s."""
        inverse_kelvin_difference = (1 / temperature - 1 / self.reference) / GAS_CONSTANT
        return float(np.exp(self.chemical + self.activation * inverse_kelvin_difference))

    def compute_retention(self, temperature: float, time: float) -> float:
        """Return F/F0 at a temperature, K, after a time, s."""
        rate = 1 / self.tau(temperature)
        return float(retained_fraction(np.array([time]), self.physical, rate, self.exponent)[0])

    def life(self, temperature: float, retained: float) -> float:
        """Return the time at which F/F0 has fallen to a part, s; infinite if never."""
        low, high = np.log(F0_TIME), np.log(MAX_LIFETIME)
        if self.compute_retention(temperature, MAX_LIFETIME) > retained:
            return float("inf")
        while high - low > 1e-9:
            midpoint = (low + high) / 2
            is_above = self.compute_retention(temperature, float(np.exp(midpoint))) > retained
            low, high = (midpoint, high) if is_above else (low, midpoint)
        return float(np.exp((low + high) / 2))

    def compute_log_life(self, temperature: float, retained_fraction: float) -> float:
        """Return the ln of the life to a part of F0, s, or of `MAX_LIFETIME` where that is less."""
        return math.log(min(self.life(temperature, retained_fraction), MAX_LIFETIME))

    def apply_activation(self, activation: float, reference: float) -> AgingLaw:
        """Return the law with another activation energy, J/mol, about a temperature, K."""
        return replace(
            self,
            chemical=math.log(self.tau(reference)),
            activation=activation,
            reference=reference,
        )

    def lower_limit(self) -> AgingLaw:
        """Return the law of the limit, with the largest plausible physical loss."""
        return replace(self, physical=self.physical + ONE_SIDED_QUANTILE * self.errors[0])

    def error_of(self, evaluate: Callable[[AgingLaw], float]) -> float:
        """Return the standard error of a function of the law by the delta method."""
        G = np.zeros((1, 4))
        for i in np.flatnonzero(np.diag(self.covariance)).tolist():
            lower, up = (self._shift_parameter(i, sign * _DERIVATIVE_STEPS[i]) for sign in (-1, 1))
            G[0, i] = (evaluate(up) - evaluate(lower)) / (2 * _DERIVATIVE_STEPS[i])
        return float(np.sqrt(propagate_covariance(self.covariance, G)[0, 0]))

    def _shift_parameter(self, index: int, step: float) -> AgingLaw:
        """Return the law with a parameter, or the ln of its exponent, shifted by a step."""
        name = ("physical", "chemical", "activation", "exponent")[index]
        value = getattr(self, name)
        return replace(self, **{name: value * np.exp(step) if name == "exponent" else value + step})
