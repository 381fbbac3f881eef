"""Exact interconversion of relaxation and creep."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray, convert_numbers_to_si
from dashpot.base.errors import DataError

_EQUAL_POLES = 1e-8
"""Relative distance below which two poles are one at their weighted mean: an error of its square,
below rounding, where the difference of the two would have lost half its digits."""


@dataclass(frozen=True)
class CreepSpectrum:
    r"""Solid given by its compliance: its response to a force.

    .. math::

        D(t) = D_g + D_f t + \sum_i D_i \left(1 - e^{-t/\lambda_i}\right), \qquad
        \frac{X}{F}(s) = D_g + \frac{D_f}{s} + \sum_i \frac{D_i}{1 + \lambda_i s}

    ::

        o--[ 1/D_g ]--+-[ 1/D_1 ]-+--+-[ 1/D_2 ]-+--( 1/D_f )--o      damper i = lambda_i / D_i
                      +-(       )-+  +-(       )-+

    Attributes
    ----------
    glass : float
        Instantaneous compliance :math:`D_g`, m/N; 0 with a parallel dashpot.
    d : tuple of float
        Retarded compliances :math:`D_i`, m/N.
    lam : tuple of float
        Retardation times :math:`\lambda_i`, s, ascending.
    flow : float
        Fluidity :math:`D_f`, m/(N s); 0 unless the solid flows (k_inf = 0).
    """

    glass: float
    d: tuple[float, ...] = ()
    lam: tuple[float, ...] = ()
    flow: float = 0.0

    @property
    def equilibrium(self) -> float:
        r"""Compliance at rest :math:`D_e = D_g + \sum_i D_i`, m/N; infinite if the solid flows."""
        return float("inf") if self.flow > 0 else self.glass + sum(self.d)

    def compliance(self, t: npt.ArrayLike) -> FloatArray:
        """Creep compliance D(t), m/N, for t > 0 in s."""
        t = convert_numbers_to_si("t", t, "time")
        relaxed_part = -np.expm1(-t[..., None] / np.array(self.lam, dtype=float))
        return np.asarray(self.glass + self.flow * t + relaxed_part @ np.array(self.d, dtype=float))


def creep_spectrum(
    k_inf: float, k: Sequence[float], tau: Sequence[float], b: float = 0.0
) -> CreepSpectrum:
    r"""Return the creep of a generalized Maxwell solid, from poles and residues of 1/(s K(s)).

    With :math:`r_0 = 0, k_0 = k_\infty, r_j = 1/\tau_j`,

    .. math:: \frac{K(s)}{s} = b + \sum_{j \ge 0} \frac{k_j}{s + r_j}

    has one zero :math:`-x_i` between each two neighbouring poles, and one beyond the last if
    b > 0. Each is a retardation: :math:`\lambda_i = 1/x_i` and
    :math:`D_i = 1 / \left(x_i^2 \sum_j k_j / (r_j - x_i)^2\right)`.

    Raises
    ------
    DataError
        If there is neither stiffness nor viscosity: nothing bounds the creep.
    """
    if k_inf <= 0 and b <= 0 and not len(k):
        raise DataError(
            "a part with neither stiffness nor viscosity has no creep; give it a spring, "
            "a dashpot or an arm"
        )
    rates, weights = 1 / np.array(tau, dtype=float), np.array(k, dtype=float)
    if k_inf > 0:
        rates, weights = np.append(0.0, rates), np.append(k_inf, weights)
    rates, weights = merge_twins(rates, weights)
    zeros, slopes = secular_zeros(rates, weights, b)
    viscosity = b + float(np.sum(np.asarray(k, dtype=float) * np.asarray(tau, dtype=float)))
    order = np.argsort(zeros)[::-1]
    return CreepSpectrum(
        glass=0.0 if b > 0 else 1 / float(weights.sum()),
        d=tuple((1 / (zeros**2 * slopes))[order].tolist()),
        lam=tuple((1 / zeros)[order].tolist()),
        flow=0.0 if k_inf > 0 else 1 / viscosity,
    )


def relaxation_spectrum(
    creep: CreepSpectrum,
) -> tuple[float, tuple[float, ...], tuple[float, ...], float]:
    r"""Return the generalized Maxwell solid ``(k_inf, k, tau, b)`` of a creep spectrum.

    The same mathematics the other way: the compliance
    :math:`D_g + D_f/s + \sum_i D_i x_i/(s + x_i)` has zeros :math:`-\rho_j` between its poles,
    and each is an arm, :math:`\tau_j = 1/\rho_j`,
    :math:`k_j = 1 / \left(\rho_j \sum_i w_i / (x_i - \rho_j)^2\right)` with
    :math:`w_i = D_i x_i`.

    Raises
    ------
    DataError
        If there is no compliance at all: a rigid link is no solid.
    """
    rates = 1 / np.array(creep.lam, dtype=float)
    weights = np.array(creep.d, dtype=float) * rates
    if creep.flow > 0:
        rates, weights = np.append(0.0, rates), np.append(creep.flow, weights)
    if creep.glass <= 0 and not len(rates):
        raise DataError("a link without any compliance is rigid; it has no relaxation spectrum")
    rates, weights = merge_twins(rates, weights)
    zeros, slopes = secular_zeros(rates, weights, creep.glass)
    order = np.argsort(zeros)[::-1]
    k = (1 / (zeros * slopes))[order]
    is_positive = k > 0  # an arm too weak for a double is no arm
    return (
        0.0 if creep.flow > 0 else 1 / creep.equilibrium,
        tuple(k[is_positive].tolist()),
        tuple((1 / zeros)[order][is_positive].tolist()),
        0.0 if creep.glass > 0 else 1 / float(weights.sum()),
    )


def merge_twins(rates: FloatArray, weights: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Rates ascending, those closer than rounding can show made one at their weighted mean."""
    if not len(rates):
        return rates, weights
    order = np.argsort(rates)
    rates, weights = rates[order], weights[order]
    first = np.flatnonzero(np.append(True, np.diff(rates) > _EQUAL_POLES * rates[1:]))
    merged_weights = np.add.reduceat(weights, first)
    shift = np.add.reduceat(
        weights * (rates - np.repeat(rates[first], np.diff([*first, len(rates)]))), first
    )
    return rates[first] + shift / merged_weights, merged_weights


def secular_zeros(
    poles: FloatArray, weights: FloatArray, constant: float
) -> tuple[FloatArray, FloatArray]:
    r"""Zeros of :math:`g(x) = c + \sum_j w_j / (p_j - x)`, and g' there.

    `poles` ascending and >= 0, `weights` > 0, `constant` >= 0. g rises from -inf to +inf between
    neighbouring poles, so each gap holds one zero; beyond the last pole it rises to c, so
    there is one more if c > 0. In each gap the unknown is the distance to the nearer pole: the
    small differences that carry all the digits are then formed without cancellation, and
    zeros are right to the last digits however many decades the poles span. The distance is
    bisected over the floats themselves, whose bit patterns are ordered as the numbers are:
    64 steps reach the last bit whatever its size.
    """
    if not len(poles):
        return np.empty(0), np.empty(0)
    gaps = np.diff(poles)
    anchor, sides, half_gap = poles[:-1].copy(), np.ones(len(gaps)), gaps / 2
    middle = anchor + half_gap
    is_above = _secular(poles, weights, constant, anchor, middle - anchor)[0] < 0
    anchor[is_above], sides[is_above] = poles[1:][is_above], -1.0
    if constant > 0:
        # the zero beyond the last pole is no further from it than all weights over c
        anchor = np.append(anchor, poles[-1])
        sides = np.append(sides, 1.0)
        half_gap = np.append(half_gap, 2 * weights.sum() / constant)
    low = np.full(len(anchor), np.finfo(float).tiny).view(np.int64)
    high = np.array(np.maximum(half_gap, np.finfo(float).tiny)).view(np.int64)
    for _ in range(64):
        trial = low + (high - low) // 2
        g = _secular(poles, weights, constant, anchor, sides * trial.view(np.float64))[0]
        is_before_root = sides * g < 0  # the zero lies further from the anchor
        low, high = np.where(is_before_root, trial, low), np.where(is_before_root, high, trial)
    offset = sides * high.view(np.float64)
    return anchor + offset, _secular(poles, weights, constant, anchor, offset)[1]


def _secular(
    poles: FloatArray, weights: FloatArray, constant: float, anchor: FloatArray, offset: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return values and slopes of g at anchor + offset, each of shape (zeros,)."""
    distance = (poles[None, :] - anchor[:, None]) - offset[:, None]
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        return constant + (1 / distance) @ weights, (1 / distance**2) @ weights
