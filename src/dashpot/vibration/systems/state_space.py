"""A system as first-order equations: the mounts' arms become states, nothing is approximated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dashpot.base.arrays import FloatArray
from dashpot.vibration.systems.system import System


@dataclass(frozen=True, eq=False)
class StateSpace:
    r"""First-order form of a system, states z = (q, dq/dt, Y).

    .. math:: \dot z = A z + B_F F + B_u u + B_v \dot u

    The force of a mount is :math:`k_0 e - \sum_j k_j y_j + b \dot e` with its stretch e and the
    elongations of its arms' dashpots, :math:`\dot y_j = (e - y_j)/\tau_j`. Arms of the same
    relaxation time forget at the same rate, so they share states: as many as their stretches are
    independent. Forty mounts of the same seal under a door add three states a relaxation time,
    and the form has no pole that the system has not.

    Attributes
    ----------
    A : array, shape (z, z)
    force : array, shape (z, n)
        :math:`B_F`.
    base, base_velocity : array, shape (z, moving)
        :math:`B_u` and :math:`B_v` of the ground motions asked for.
    arm_mount : array of int, shape (arms,)
        The mount of each arm.
    arm_k : array, shape (arms,)
        Its stiffness, N/m.
    arm_state : array, shape (arms, z - 2n)
        Its elongation from the shared states, y = arm_state @ Y.
    """

    A: FloatArray
    force: FloatArray
    base: FloatArray
    base_velocity: FloatArray
    arm_mount: npt.NDArray[np.int64]
    arm_k: FloatArray
    arm_state: FloatArray


def state_space(system: System, *, moving: Sequence[int] = ()) -> StateSpace:
    """The exact first-order form of a system.

    Parameters
    ----------
    system : System
    moving : sequence of int
        The ground motions, as indices of ``system.base_dofs``, that are inputs; the others rest.
    """
    E, G = system.stretch, system.base_stretch[:, list(moving)]
    n = len(system.dofs)
    solids = [mount.solid for mount in system.mounts]
    glass = np.array([solid.k_0 for solid in solids])
    viscous = np.array([solid.b for solid in solids])
    arm_mount = np.array([i for i, solid in enumerate(solids) for _ in solid.k], dtype=np.int64)
    k = np.array([each for solid in solids for each in solid.k])
    tau = np.array([each for solid in solids for each in solid.tau])
    rate, basis, arm_state = _shared(np.concatenate((E, G), axis=1)[arm_mount], tau)
    inverse = np.linalg.inv(system.mass_matrix)
    push = -inverse @ E.T  # acceleration per mount force

    size = 2 * n + len(rate)
    A = np.zeros((size, size))
    A[:n, n : 2 * n] = np.eye(n)
    A[n : 2 * n, :n] = push @ (glass[:, None] * E)
    A[n : 2 * n, n : 2 * n] = push @ (viscous[:, None] * E)
    A[n : 2 * n, 2 * n :] = -(push[:, arm_mount] * k) @ arm_state
    A[2 * n :, :n] = rate[:, None] * basis[:, :n]
    A[2 * n :, 2 * n :] = -np.diag(rate)
    force = np.zeros((size, n))
    force[n : 2 * n] = inverse
    base, base_velocity = np.zeros((size, len(moving))), np.zeros((size, len(moving)))
    base[n : 2 * n] = push @ (glass[:, None] * G)
    base[2 * n :] = rate[:, None] * basis[:, n:]
    base_velocity[n : 2 * n] = push @ (viscous[:, None] * G)
    return StateSpace(A, force, base, base_velocity, arm_mount, k, arm_state)


def _shared(stretch: FloatArray, tau: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """States that arms share: rates (y,), what drives them (y, motions), arms from them (arms, y).

    The arms of one relaxation time follow stretches that are rows of `stretch`; an orthonormal
    basis of those rows carries them all.
    """
    rates: list[float] = []
    bases: list[FloatArray] = []
    columns: list[FloatArray] = []
    left = np.sort(tau)
    while len(left):
        value = left[0]
        alike = np.abs(tau / value - 1) < 1e-12  # only rounding parts them
        left = left[left > value * (1 + 1e-12)]
        rows = stretch[alike]
        _, size, right = np.linalg.svd(rows, full_matrices=False)
        basis = right[size > 1e-10 * max(size.max(initial=0.0), 1e-300)]
        share = np.zeros((len(tau), len(basis)))
        share[alike] = rows @ basis.T
        rates += [1 / float(value)] * len(basis)
        bases.append(basis)
        columns.append(share)
    if not rates:
        return np.empty(0), np.empty((0, stretch.shape[1])), np.empty((len(tau), 0))
    return np.array(rates), np.concatenate(bases), np.concatenate(columns, axis=1)
