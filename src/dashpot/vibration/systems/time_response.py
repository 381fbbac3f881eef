"""How a system moves in time, exactly between samples."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dashpot.base.arrays import ByValue, FloatArray, frozen, increasing, same_length, samples
from dashpot.base.errors import DataError
from dashpot.vibration.systems.bodies import Point
from dashpot.vibration.systems.state_space import StateSpace, state_space
from dashpot.vibration.systems.system import System


@dataclass(frozen=True, eq=False)
class Motion(ByValue):
    """The response of a system.

    Attributes
    ----------
    time : array, shape (t,)
        s.
    dofs : tuple of str
    displacement, velocity, acceleration : array, shape (n, t)
        One row per degree of freedom, SI.
    mount_force : array, shape (mounts, t)
        Tension in each mount, N.
    """

    time: FloatArray
    dofs: tuple[str, ...]
    displacement: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    mount_force: FloatArray

    def __post_init__(self) -> None:
        for name in ("time", "displacement", "velocity", "acceleration", "mount_force"):
            object.__setattr__(self, name, frozen(np.asarray(getattr(self, name), dtype=float)))


def respond(
    system: System,
    time: npt.ArrayLike,
    *,
    force: Mapping[str | Point, npt.ArrayLike] | None = None,
    base: Mapping[str, npt.ArrayLike] | None = None,
) -> Motion:
    r"""Response of a system at rest to forces and to motions of its grounds.

    Forces and ground displacements are straight between samples, and for those the answer is
    exact: each step is a matrix exponential of the first-order form, whatever its length and
    however fast the arms. A ground displacement that is not zero at the first sample is a step
    at that instant. Accelerations and mount forces at a sample belong to the segment that ends
    there, where a parallel dashpot sees the ground's velocity jump.

    Parameters
    ----------
    system : System
    time : array_like, shape (t,)
        s, strictly increasing, any spacing.
    force : mapping
        From a degree of freedom or a point to N (or N m), each of shape (t,).
    base : mapping
        From a ground motion such as ``"ground.z"`` to m (or rad), each of shape (t,).
    """
    t = increasing("time", samples("time", time, minimum=2))
    F = np.zeros((len(system.dofs), len(t)))
    for place, values in (force or {}).items():
        F += np.outer(system.participation(place), _history(f"force at {place}", values, t))
    u = np.zeros((len(system.base_dofs), len(t)))
    for name, values in (base or {}).items():
        if name not in system.base_dofs:
            raise DataError(f"'{name}' is no ground motion; known: {', '.join(system.base_dofs)}")
        u[system.base_dofs.index(name)] += _history(f"motion of {name}", values, t)
    moving = np.flatnonzero(np.abs(u).max(axis=1) > 0).tolist()
    form = state_space(system, moving=moving)
    return _observe(system, form, t, inputs=(F, u), states=_march(form, t, F, u[moving]))


def _march(form: StateSpace, t: FloatArray, F: FloatArray, u: FloatArray) -> FloatArray:
    """The states at every sample, shape (states, t)."""
    steps = np.diff(t)
    slope = np.diff(u, axis=1) / steps
    # inputs: force and displacement, straight over a step; ground velocity, constant over it
    B = np.concatenate((form.force, form.base, form.base_velocity), axis=1)
    start = np.concatenate((F[:, :-1], u[:, :-1], slope))
    rise = np.concatenate((np.diff(F, axis=1) / steps, slope, np.zeros_like(slope)))
    z = np.zeros((len(form.A), len(t)))
    z[:, 0] = form.base_velocity @ u[:, 0]  # the impulse of a step through the dashpots
    exact: dict[float, tuple[FloatArray, FloatArray, FloatArray]] = {}
    for i, step in enumerate(steps):
        h = float(f"{step:.13g}")  # equal steps differ by rounding
        if h not in exact:
            exact[h] = _step(form.A, B, h)
        free, hold, ramp = exact[h]
        z[:, i + 1] = free @ z[:, i] + hold @ start[:, i] + ramp @ rise[:, i]
    return z


def _observe(
    system: System,
    form: StateSpace,
    t: FloatArray,
    *,
    inputs: tuple[FloatArray, FloatArray],
    states: FloatArray,
) -> Motion:
    (F, u), z, n = inputs, states, len(system.dofs)
    slope = np.diff(u, axis=1) / np.diff(t)
    u_dot = np.concatenate((slope[:, :1], slope), axis=1)
    stretch = system.stretch @ z[:n] + system.base_stretch @ u
    speed = system.stretch @ z[n : 2 * n] + system.base_stretch @ u_dot
    glass = np.array([mount.solid.k_0 for mount in system.mounts])
    viscous = np.array([mount.solid.b for mount in system.mounts])
    tension = np.asarray(glass[:, None] * stretch + viscous[:, None] * speed)
    np.subtract.at(tension, form.arm_mount, form.arm_k[:, None] * (form.arm_state @ z[2 * n :]))
    acceleration = np.linalg.solve(system.mass_matrix, F - system.stretch.T @ tension)
    return Motion(t, system.dofs, z[:n], z[n : 2 * n], np.asarray(acceleration), tension)


def _step(A: FloatArray, B: FloatArray, h: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    r"""Exact step: :math:`e^{Ah}`, and what a constant and a rising input add over h."""
    from scipy.linalg import expm

    n, m = B.shape
    block = np.zeros((n + 2 * m, n + 2 * m))
    block[:n, :n] = A * h
    block[:n, n : n + m] = B * h
    block[n : n + m, n + m :] = np.eye(m) * h
    exponential = expm(block)
    return exponential[:n, :n], exponential[:n, n : n + m], exponential[:n, n + m :]


def _history(what: str, values: npt.ArrayLike, t: FloatArray) -> FloatArray:
    history = samples(what, values)
    same_length(time=t, **{what: history})
    return history
