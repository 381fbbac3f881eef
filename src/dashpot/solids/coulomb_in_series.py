r"""Solid in series with a Coulomb element: steady cycle and its first harmonic.

The force of the solid is linear in its elongation u until it reaches the slip force; then it stays
there and u does not follow the motion x:

.. math:: |F[u]| \le F_c, \qquad \dot u = \dot x \text{ while } |F| < F_c

A steady cycle is antisymmetric: after half of it the state of the solid is the negative of what it
was. That is solved by Newton; the map of half a cycle is affine wherever what slips stays the same.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy.interpolate import PchipInterpolator

from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.solids.maxwell import GeneralizedMaxwell

_STEPS, _ROUNDS, _SETTLED = 512, 60, 1e-9
"""Of half a cycle; of Newton at most; what a steady state moves by at most, relatively."""
_AT_ONCE = 1e-4
"""Of a dashpot taken for an arm: omega tau."""
_BEYOND = np.geomspace(1e-3, 1e8, 130)
"""Amplitudes over the one that begins to slip, less 1, at which the answer is tabulated."""


def coulomb_in_series(solid: GeneralizedMaxwell, omega: float, ratio: FloatArray) -> ComplexArray:
    """Return stiffness of a solid before a Coulomb element over its own, at one frequency.

    Parameters
    ----------
    solid : GeneralizedMaxwell
    omega : float
        rad/s.
    ratio : array
        Amplitude over the one at which it begins to slip, :math:`F_c / |K|`.
    """
    table = _table(solid, omega)
    clipped = np.clip(ratio - 1, _BEYOND[0], _BEYOND[-1])
    value = np.exp(-np.log1p(clipped)) * table(np.log(clipped)).view(complex)[..., 0]
    # below the first it grows from what sticks, beyond the last the force is all slip
    near = 1 - (1 - value) * np.clip((ratio - 1) / _BEYOND[0], 0, 1) ** 1.5
    far = value * (1 + _BEYOND[-1]) / np.maximum(ratio, 1 + _BEYOND[-1])
    return np.asarray(np.where(ratio < 1 + _BEYOND[0], near, far))


@lru_cache(maxsize=512)
def _table(solid: GeneralizedMaxwell, omega: float) -> PchipInterpolator:
    """Return stiffness times ratio over the solid's own, real and imaginary, over ln(ratio - 1)."""
    ratio = 1 + _BEYOND
    values = ratio * _steady(solid, omega, ratio)
    return PchipInterpolator(np.log(_BEYOND), np.column_stack([values.real, values.imag]))


def _steady(solid: GeneralizedMaxwell, omega: float, ratio: FloatArray) -> ComplexArray:
    """Return the first harmonic of the steady cycle over the solid's stiffness, marched."""
    K = complex(solid.complex_stiffness(omega=omega))
    # what slips sticks again soon after the motion turns: the steps are finest there
    theta = np.pi * (np.arange(_STEPS + 1) / _STEPS) ** 1.5
    X = ratio / abs(K)  # of a slip force of 1
    dx = np.diff(X[:, None] * np.cos(theta), axis=1)
    k, tau = np.array([solid.k_inf, *solid.k]), np.array(solid.tau)
    if solid.b:  # a dashpot is an arm that relaxes at once
        tau = np.append(tau, _AT_ONCE / omega)
        k = np.append(k, solid.b / tau[-1])
    z = np.diff(theta)[:, None] / omega / tau
    weights = np.ones((_STEPS, 1))
    keeps, gains = np.hstack([weights, np.exp(-z)]), np.hstack([weights, -np.expm1(-z) / z])
    rise = gains @ k
    state = np.zeros((len(X), len(k)))
    unit = np.eye(len(k))
    force = np.empty((len(X), _STEPS + 1))
    for _ in range(_ROUNDS):
        here, turns = state, np.broadcast_to(unit, (len(X), *unit.shape))
        force[:, 0] = np.clip(here @ k, -1, 1)
        for i in range(_STEPS):
            base = here @ (k * keeps[i])
            tried = base + rise[i] * dx[:, i]
            force[:, i + 1] = np.clip(tried, -1, 1)
            step = (force[:, i + 1] - base) / rise[i]
            here = keeps[i] * here + gains[i] * step[:, None]
            slips = np.abs(tried) > 1
            follows = -np.einsum("k,nkj->nj", k * keeps[i], turns) / rise[i] * slips[:, None]
            turns = keeps[i][:, None] * turns + gains[i][:, None] * follows[:, None, :]
        residual = here + state
        if np.abs(residual).max() <= _SETTLED * np.abs(here).max():
            break
        state = state - np.linalg.solve(turns + unit, residual[..., None])[..., 0]
    first = 2 / np.pi * np.trapezoid(force * np.exp(-1j * theta), theta, axis=1) / X
    return np.asarray(first / K)
