"""A seal that hardens with compression, from its own formulas: nothing here calls the library.

Relaxed force F_e = a x + c x^3 (x in m), memory of the paper's Table 1, every arm answering
F_e(x(t)) (Fung): at a compression x small vibration feels F_e'(x) / k_inf times Table 1, where
k_inf = F_e(8 mm) / 8 mm.
"""

from __future__ import annotations

import numpy as np

A, C = 150.0, 7.2656e5
DEPTH, G = 8e-3, 9.80665
K_INF, ARMS = 196.5, ((117.5, 59.0 / 117.5), (17.8, 292.2 / 17.8))


def force(x):
    return A * x + C * x**3


def tangent(x):
    return A + 3 * C * x**2


def resting(mass: float, seals: float) -> float:
    """The real root of seals (a x + c x^3) = m g, m."""
    roots = np.roots([C, 0.0, A, -mass * G / seals])
    return float(roots[np.abs(roots.imag) < 1e-9].real[0])


def stiffness(omega, scale: float):
    """Complex stiffness of one seal, `scale` times Table 1."""
    s = 1j * np.asarray(omega)
    return scale * (K_INF + sum(k * s * tau / (1 + s * tau) for k, tau in ARMS))


def simulate_accelerance(
    frequency, *, mass: float, seals: float, scale: float, noise: float, seed: int
):
    """Accelerance with noise, and the noise's standard deviation: 4 equal averages."""
    omega = 2 * np.pi * frequency
    value = -(omega**2) / (seals * stiffness(omega, scale) - mass * omega**2)
    sd = noise * np.abs(value) + 1e-3 * noise * np.abs(value).max()
    draw = np.random.default_rng(seed).standard_normal((2, len(omega)))
    return value + sd * (draw[0] + 1j * draw[1]), sd


def peak(mass: float, seals: float, scale: float) -> float:
    """Frequency of the largest accelerance, Hz, on a fine grid."""
    f = np.linspace(4.0, 40.0, 360_001)
    omega = 2 * np.pi * f
    return float(
        f[np.argmax(np.abs(omega**2 / (seals * stiffness(omega, scale) - mass * omega**2)))]
    )


def law(knots: int = 17):
    """Knots, m, and the tangent over its mean: what an elastic law of straight pieces holds."""
    x = np.linspace(0.0, DEPTH, knots)
    shape = tangent(x)
    return x, shape / (np.trapezoid(shape, x) / DEPTH)
