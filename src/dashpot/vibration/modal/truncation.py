"""A mass on a solid, heard for a limited time only."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import ComplexArray
from dashpot.solids.maxwell import GeneralizedMaxwell


def poles(model: GeneralizedMaxwell, mass: float) -> ComplexArray:
    r"""Poles of a mass on a solid, 1/s, shape (2 + arms,): roots of :math:`m s^2 + K(s) = 0`.

    Eigenvalues of the state matrix in position, velocity and the elongation of each arm's spring,
    :math:`\dot q_j = v - q_j/\tau_j`; `model` is all the seals together, `mass` in kg.
    """
    size = 2 + model.arms
    state = np.zeros((size, size))
    state[0, 1] = 1.0
    state[1, 0] = -model.k_inf / mass
    state[1, 1] = -model.b / mass
    state[1, 2:] = -np.asarray(model.k) / mass
    state[2:, 1] = 1.0
    state[2:, 2:] = -np.diag(1 / np.asarray(model.tau))
    return np.asarray(np.linalg.eigvals(state), dtype=complex)


def residues(model: GeneralizedMaxwell, mass: float, at: ComplexArray) -> ComplexArray:
    r"""Residues of the receptance at its simple poles: :math:`1 / (2 m p + K'(p))`, m/(N s)."""
    factor = 1 + at[:, None] * np.asarray(model.tau)
    # an arm too weak to shift its own pole has an infinite slope there, and no residue
    own = np.abs(factor).min(axis=1, initial=1.0) > 0
    slope = (np.asarray(model.arm_b) / factor[own] ** 2).sum(axis=1) + model.b
    found = np.zeros(len(at), dtype=complex)
    found[own] = 1 / (2 * mass * at[own] + slope)
    return found


def cut_accelerance(
    model: GeneralizedMaxwell, mass: float, s: ComplexArray, record: float, pulse: float = 0.0
) -> ComplexArray:
    r"""Accelerance as the transform of a response cut off `record` s after the hit sees it, 1/kg.

    .. math::

        A_T(s) = \frac{s^2}{m s^2 + K(s)} - \sum_i r_i p_i^2
                 \frac{e^{(p_i - s) T + \vartheta^2 (p_i^2 - s^2)/2}}{s - p_i}

    where :math:`r_i` is the residue of the receptance at its pole :math:`p_i` and
    :math:`\vartheta` the rms width of the `pulse`, s, at whose middle the record begins. With an
    exponential window, s = j omega + a, the cut-off part shrinks by e^{-aT}.
    """
    whole = s**2 / (mass * s**2 + model.stiffness_at(s))
    p = poles(model, mass)
    lost = residues(model, mass, p) * p**2 * np.exp(p * record + 0.5 * (pulse * p) ** 2)
    live = np.abs(lost) > 0
    p, lost = p[live], lost[live]
    tail = (lost / (s[:, None] - p)).sum(axis=1)
    return np.asarray(whole - tail * np.exp(-s * record - 0.5 * (pulse * s) ** 2))
