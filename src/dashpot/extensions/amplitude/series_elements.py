r"""A solid in series with a part whose stiffness depends on amplitude.

Of a Coulomb element the steady cycle itself is found. The force of the solid is linear in its
elongation u until it reaches the slip force; then it stays there and u does not follow the motion:

.. math:: |F[u]| \le F_c, \qquad \dot u = \dot x \text{ while } |F| < F_c

A steady cycle is antisymmetric: after half of it the state of the solid has the opposite sign. That
is solved by Newton; the map of half a cycle is affine while the same elements slip.

Source: P. Gaillard and R. Singh, Applied Acoustics 60 (2000) 37.
"""

from __future__ import annotations

from functools import lru_cache, singledispatch
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

from dashpot.base import dataclass
from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.extensions.amplitude.friction import Coulomb
from dashpot.solids.jenkins import Jenkins
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid
from dashpot.solids.networks import series, spring
from dashpot.solids.rate_independent import AmplitudeDependent, InParallel, amplitudes

_ZERO_AMPLITUDE = 1e-30
"""m."""


@dataclass(frozen=True)
class InSeries(AmplitudeDependent):
    r"""A solid and, behind it, a part whose stiffness depends on amplitude: one force in both.

    .. math:: \frac1K = \frac1{K_1(\omega)} + \frac1{N(\omega, X_2)}, \qquad
        X = X_2 \left|1 + \frac{N(\omega, X_2)}{K_1(\omega)}\right|

    with the amplitude X_2 over the second, of whose motion one harmonic is counted. That is exact
    while the part behind sticks, and up to 3 % off where it slips: the path in time is exact. Of a
    single Coulomb or Jenkins element the steady cycle itself is found.

    Attributes
    ----------
    solid : Solid
    behind : AmplitudeDependent
    """

    solid: Solid
    behind: AmplitudeDependent

    def equivalent(self, omega: npt.ArrayLike, amplitude: npt.ArrayLike) -> ComplexArray:
        """Complex stiffness, N/m; the solid's own while the part behind it is stuck."""
        w, X = np.broadcast_arrays(np.asarray(omega, dtype=float), amplitudes(amplitude))
        return compute_series_stiffness(self.behind, self.solid, w, X)

    def start(self) -> tuple[Any, Any, float]:
        """Return both elements at rest, and the displacement between them."""
        return InParallel((self.solid,)).start(), self.behind.start(), 0.0

    def advance(
        self, state: tuple[Any, Any, float], dt: float, x: float
    ) -> tuple[float, tuple[Any, Any, float]]:
        """Force, N, where that of the solid equals that of the part behind it."""
        first, second, previous_stretch = state
        arms = InParallel((self.solid,))

        def compute_excess(y: float) -> float:
            return self.behind.advance(second, dt, y)[0] - arms.advance(first, dt, x - y)[0]

        # the difference rises with y: widen until it changes its sign
        step_size = max(abs(x - previous_stretch), 1e-9 * abs(previous_stretch), _ZERO_AMPLITUDE)
        low, high = previous_stretch - step_size, previous_stretch + step_size
        while compute_excess(low) > 0:
            low -= 2 * (high - low)
        while compute_excess(high) < 0:
            high += 2 * (high - low)
        y = float(
            brentq(compute_excess, low, high, xtol=1e-15 * (abs(previous_stretch) + step_size))
        )
        force, first = arms.advance(first, dt, x - y)
        return force, (first, self.behind.advance(second, dt, y)[1], y)

    def __mul__(self, count: float) -> InSeries:
        """`count` in parallel."""
        return InSeries(self.solid * count, self.behind * count)


@singledispatch
def compute_series_stiffness(
    series_part: AmplitudeDependent, solid: Solid, omega: FloatArray, amplitude: FloatArray
) -> ComplexArray:
    """Return the complex stiffness, N/m, of a solid and a part behind it, by one harmonic.

    Of a Coulomb or Jenkins element behind the solid it is that of the steady cycle.
    """
    first = solid.complex_stiffness(omega=omega)
    # both dissipate, so the part behind never moves further than the whole
    low, high = np.full(amplitude.shape, np.log(1e-12)), np.zeros(amplitude.shape)
    for _ in range(60):
        midpoint = (low + high) / 2
        end = amplitude * np.exp(midpoint)
        short = end * np.abs(1 + series_part.equivalent(omega, end) / first) < amplitude
        low, high = np.where(short, midpoint, low), np.where(short, high, midpoint)
    second = series_part.equivalent(omega, amplitude * np.exp(high))
    series = first * second / (first + second)
    return np.asarray(np.where(high < np.log(1e-11), first, series))


@compute_series_stiffness.register
def _(slider: Jenkins, solid: Solid, omega: FloatArray, amplitude: FloatArray) -> ComplexArray:
    connected = series(solid.maxwell, spring(slider.k))  # its spring belongs to the solid
    return compute_series_stiffness(Coulomb(slider.slip), connected, omega, amplitude)


@compute_series_stiffness.register
def _(slider: Coulomb, solid: Solid, omega: FloatArray, amplitude: FloatArray) -> ComplexArray:
    K, arms = solid.complex_stiffness(omega=omega), solid.maxwell
    if not arms.arms and not arms.b:
        return Jenkins(arms.k_inf, slider.slip).stiffness(amplitude)
    values = np.empty(K.shape, dtype=complex)
    for value in np.unique(omega):
        at_frequency = omega == value
        ratio = amplitude[at_frequency] * np.abs(K[at_frequency]) / slider.slip
        values[at_frequency] = K[at_frequency] * compute_slip_ratio(arms, float(value), ratio)
    return values


_STEPS_PER_HALF_CYCLE, _MAX_ITERATIONS, _STEADY_TOLERANCE = 512, 60, 1e-9
"""Steps of half a cycle, largest number of Newton iterations, and relative change when steady."""
_DASHPOT_OMEGA_TAU = 1e-4
"""Product omega tau of a dashpot that is represented by an arm."""
_TABULATED_RATIOS = np.geomspace(1e-3, 1e8, 130)
"""Tabulated ratios of amplitude and slip amplitude, less 1."""


def compute_slip_ratio(solid: GeneralizedMaxwell, omega: float, ratio: FloatArray) -> ComplexArray:
    """Return the stiffness of a solid before a Coulomb element over its own, at one frequency.

    Parameters
    ----------
    solid : GeneralizedMaxwell
    omega : float
        rad/s.
    ratio : array
        Amplitude over the one at which it begins to slip, :math:`F_c / |K|`.
    """
    table = _tabulate_ratio(solid, omega)
    clipped = np.clip(ratio - 1, _TABULATED_RATIOS[0], _TABULATED_RATIOS[-1])
    value = np.exp(-np.log1p(clipped)) * table(np.log(clipped)).view(complex)[..., 0]
    # below the first it grows from what sticks, beyond the last the force is all slip
    near_value = 1 - (1 - value) * np.clip((ratio - 1) / _TABULATED_RATIOS[0], 0, 1) ** 1.5
    far_value = value * (1 + _TABULATED_RATIOS[-1]) / np.maximum(ratio, 1 + _TABULATED_RATIOS[-1])
    return np.asarray(np.where(ratio < 1 + _TABULATED_RATIOS[0], near_value, far_value))


@lru_cache(maxsize=512)
def _tabulate_ratio(solid: GeneralizedMaxwell, omega: float) -> PchipInterpolator:
    """Return stiffness times ratio over the solid's own, real and imaginary, over ln(ratio - 1)."""
    ratio = 1 + _TABULATED_RATIOS
    values = ratio * _march_steady_cycle(solid, omega, ratio)
    return PchipInterpolator(np.log(_TABULATED_RATIOS), np.column_stack([values.real, values.imag]))


def _march_steady_cycle(solid: GeneralizedMaxwell, omega: float, ratio: FloatArray) -> ComplexArray:
    """Return the first harmonic of the steady cycle over the solid's stiffness, marched."""
    K = complex(solid.complex_stiffness(omega=omega))
    # what slips sticks again soon after the motion turns: the steps are finest there
    theta = np.pi * (np.arange(_STEPS_PER_HALF_CYCLE + 1) / _STEPS_PER_HALF_CYCLE) ** 1.5
    X = ratio / abs(K)  # of a slip force of 1
    dx = np.diff(X[:, None] * np.cos(theta), axis=1)
    k, tau = np.array([solid.k_inf, *solid.k]), np.array(solid.tau)
    if solid.b:  # a dashpot is an arm that relaxes at once
        tau = np.append(tau, _DASHPOT_OMEGA_TAU / omega)
        k = np.append(k, solid.b / tau[-1])
    z = np.diff(theta)[:, None] / omega / tau
    weights = np.ones((_STEPS_PER_HALF_CYCLE, 1))
    keeps, gains = np.hstack([weights, np.exp(-z)]), np.hstack([weights, -np.expm1(-z) / z])
    stiffness = gains @ k
    state = np.zeros((len(X), len(k)))
    unit = np.eye(len(k))
    force = np.empty((len(X), _STEPS_PER_HALF_CYCLE + 1))
    for _ in range(_MAX_ITERATIONS):
        current, turns = state, np.broadcast_to(unit, (len(X), *unit.shape))
        force[:, 0] = np.clip(current @ k, -1, 1)
        for i in range(_STEPS_PER_HALF_CYCLE):
            base = current @ (k * keeps[i])
            trial = base + stiffness[i] * dx[:, i]
            force[:, i + 1] = np.clip(trial, -1, 1)
            step = (force[:, i + 1] - base) / stiffness[i]
            current = keeps[i] * current + gains[i] * step[:, None]
            is_slipping = np.abs(trial) > 1
            derivative = (
                -np.einsum("k,nkj->nj", k * keeps[i], turns) / stiffness[i] * is_slipping[:, None]
            )
            turns = keeps[i][:, None] * turns + gains[i][:, None] * derivative[:, None, :]
        residual = current + state
        if np.abs(residual).max() <= _STEADY_TOLERANCE * np.abs(current).max():
            break
        state = state - np.linalg.solve(turns + unit, residual[..., None])[..., 0]
    first = 2 / np.pi * np.trapezoid(force * np.exp(-1j * theta), theta, axis=1) / X
    return np.asarray(first / K)
