"""A system as first-order equations: the mounts' arms become states, nothing is approximated."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dashpot._arrays import FloatArray
from dashpot.vibration.systems import System


@dataclass(frozen=True, eq=False)
class StateSpace:
    r"""First-order form of a system, states z = (q, dq/dt, y).

    .. math:: \dot z = A z + B_F F + B_u u + B_v \dot u

    with y the elongation of the dashpot of each mount arm: the force of a mount is
    :math:`k_0 e - \sum_j k_j y_j + b \dot e` and :math:`\dot y_j = (e - y_j)/\tau_j` with its
    stretch e. The motions of the grounds and their velocities enter as inputs.

    Attributes
    ----------
    A : array, shape (2n + arms, 2n + arms)
    force : array, shape (2n + arms, n)
        :math:`B_F`.
    base, base_velocity : array, shape (2n + arms, 6 grounds)
        :math:`B_u` and :math:`B_v`.
    arm_mount : array of int, shape (arms,)
        The mount that each arm state belongs to.
    arm_k : array, shape (arms,)
        Its stiffness, N/m.
    """

    A: FloatArray
    force: FloatArray
    base: FloatArray
    base_velocity: FloatArray
    arm_mount: npt.NDArray[np.int64]
    arm_k: FloatArray


def state_space(system: System) -> StateSpace:
    """The exact first-order form of a system."""
    E, G = system.stretch, system.base_stretch
    n, grounds = len(system.dofs), len(system.base_dofs)
    solids = [mount.solid for mount in system.mounts]
    glass = np.array([solid.k_0 for solid in solids])
    viscous = np.array([solid.b for solid in solids])
    mount = np.array([i for i, solid in enumerate(solids) for _ in solid.k], dtype=int)
    k = np.array([each for solid in solids for each in solid.k])
    rate = np.array([1 / each for solid in solids for each in solid.tau])
    inverse = np.linalg.inv(system.mass_matrix)
    push = -inverse @ E.T  # acceleration per mount force

    states = 2 * n + len(k)
    A = np.zeros((states, states))
    A[:n, n : 2 * n] = np.eye(n)
    A[n : 2 * n, :n] = push @ (glass[:, None] * E)
    A[n : 2 * n, n : 2 * n] = push @ (viscous[:, None] * E)
    A[n : 2 * n, 2 * n :] = -push[:, mount] * k
    A[2 * n :, :n] = rate[:, None] * E[mount]
    A[2 * n :, 2 * n :] = -np.diag(rate)
    force = np.zeros((states, n))
    force[n : 2 * n] = inverse
    base, base_velocity = np.zeros((states, grounds)), np.zeros((states, grounds))
    base[n : 2 * n] = push @ (glass[:, None] * G)
    base[2 * n :] = rate[:, None] * G[mount]
    base_velocity[n : 2 * n] = push @ (viscous[:, None] * G)
    return StateSpace(A, force, base, base_velocity, mount, k)
