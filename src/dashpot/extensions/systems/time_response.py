"""State space of a system: response in time, and complex modes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass
from dashpot.base.arrays import (
    ComplexArray,
    FloatArray,
    FrozenArrays,
    IndexArray,
    require_increasing,
    require_same_length,
    validate_samples,
)
from dashpot.base.errors import DataError
from dashpot.extensions.systems.multibody import Point, System

# First-order equations, and response in time.


@dataclass(frozen=True, eq=False)
class StateSpace:
    r"""State space of a system, states z = (q, dq/dt, Y).

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
        :math:`B_u` and :math:`B_v` of the ground motions requested.
    arm_mount : array of int, shape (J,)
        The mount of each of the J arms.
    arm_k : array, shape (J,)
        Its stiffness, N/m.
    arm_state : array, shape (J, z - 2n)
        Its elongation from the shared states, y = arm_state @ Y.
    """

    A: FloatArray
    force: FloatArray
    base: FloatArray
    base_velocity: FloatArray
    arm_mount: IndexArray
    arm_k: FloatArray
    arm_state: FloatArray


def state_space(system: System, *, moving: Sequence[int] = ()) -> StateSpace:
    """Return the exact first-order form of a system.

    Parameters
    ----------
    system : System
    moving : sequence of int
        The ground motions, as indices of ``system.base_dofs``, that are inputs; the others rest.
    """
    E, G = system.stretch, system.base_stretch[:, list(moving)]
    n = len(system.dofs)
    solids = [spring.linearised_solid.maxwell for spring in system.springs]
    glass = np.array([solid.k_0 for solid in solids])
    viscous = np.array([solid.b for solid in solids])
    arm_mount = np.array([i for i, solid in enumerate(solids) for _ in solid.k], dtype=np.intp)
    k = np.array([value for solid in solids for value in solid.k])
    tau = np.array([value for solid in solids for value in solid.tau])
    rate, basis, arm_state = _merge_arm_states(np.concatenate((E, G), axis=1)[arm_mount], tau)
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


def _merge_arm_states(
    stretch: FloatArray, tau: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """States that arms share: rates (y,), what drives them (y, motions), arms from them (arms, y).

    The arms of one relaxation time follow stretches that are rows of `stretch`; an orthonormal
    basis of those rows carries them all.
    """
    rates: list[float] = []
    bases: list[FloatArray] = []
    columns: list[FloatArray] = []
    other_taus = np.sort(tau)
    while len(other_taus):
        value = other_taus[0]
        is_same_tau = np.abs(tau / value - 1) < 1e-12  # only rounding parts them
        other_taus = other_taus[other_taus > value * (1 + 1e-12)]
        rows = stretch[is_same_tau]
        _, size, right = np.linalg.svd(rows, full_matrices=False)
        basis = right[size > 1e-10 * max(size.max(initial=0.0), 1e-300)]
        share = np.zeros((len(tau), len(basis)))
        share[is_same_tau] = rows @ basis.T
        rates += [1 / float(value)] * len(basis)
        bases.append(basis)
        columns.append(share)
    if not rates:
        return np.empty(0), np.empty((0, stretch.shape[1])), np.empty((len(tau), 0))
    return np.array(rates), np.concatenate(bases), np.concatenate(columns, axis=1)


@dataclass(frozen=True, eq=False)
class Motion(FrozenArrays):
    """Response of a system in time.

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
    t = require_increasing("time", validate_samples("time", time, minimum=2))
    F = np.zeros((len(system.dofs), len(t)))
    for point, values in (force or {}).items():
        F += np.outer(
            system.participation(point), _validate_history(f"force at {point}", values, t)
        )
    u = np.zeros((len(system.base_dofs), len(t)))
    for name, values in (base or {}).items():
        if name not in system.base_dofs:
            raise DataError(f"'{name}' is no ground motion; known: {', '.join(system.base_dofs)}")
        u[system.base_dofs.index(name)] += _validate_history(f"motion of {name}", values, t)
    moving = np.flatnonzero(np.abs(u).max(axis=1) > 0).tolist()
    form = state_space(system, moving=moving)
    return _observe_outputs(
        system, form, t, inputs=(F, u), states=_march_states(form, t, F, u[moving])
    )


def _march_states(form: StateSpace, t: FloatArray, F: FloatArray, u: FloatArray) -> FloatArray:
    """Return the states at every sample, shape (states, t)."""
    steps = np.diff(t)
    slope = np.diff(u, axis=1) / steps
    # inputs: force and displacement, straight over a step; ground velocity, constant over it
    B = np.concatenate((form.force, form.base, form.base_velocity), axis=1)
    start = np.concatenate((F[:, :-1], u[:, :-1], slope))
    derivative = np.concatenate((np.diff(F, axis=1) / steps, slope, np.zeros_like(slope)))
    z = np.zeros((len(form.A), len(t)))
    z[:, 0] = form.base_velocity @ u[:, 0]  # the impulse of a step through the dashpots
    exact: dict[float, tuple[FloatArray, FloatArray, FloatArray]] = {}
    for i, step in enumerate(steps):
        h = float(f"{step:.13g}")  # equal steps differ by rounding
        if h not in exact:
            exact[h] = _compute_step_matrices(form.A, B, h)
        free_step, hold, ramp = exact[h]
        z[:, i + 1] = free_step @ z[:, i] + hold @ start[:, i] + ramp @ derivative[:, i]
    return z


def _observe_outputs(
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
    solids = [spring.linearised_solid.maxwell for spring in system.springs]
    glass = np.array([solid.k_0 for solid in solids])
    viscous = np.array([solid.b for solid in solids])
    tension = np.asarray(glass[:, None] * stretch + viscous[:, None] * speed)
    np.subtract.at(tension, form.arm_mount, form.arm_k[:, None] * (form.arm_state @ z[2 * n :]))
    acceleration = np.linalg.solve(system.mass_matrix, F - system.stretch.T @ tension)
    return Motion(t, system.dofs, z[:n], z[n : 2 * n], np.asarray(acceleration), tension)


def _compute_step_matrices(
    A: FloatArray, B: FloatArray, h: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    r"""Exact step: :math:`e^{Ah}`, and what a constant and a rising input add over h."""
    from scipy.linalg import expm

    n, m = B.shape
    block = np.zeros((n + 2 * m, n + 2 * m))
    block[:n, :n] = A * h
    block[:n, n : n + m] = B * h
    block[n : n + m, n + m :] = np.eye(m) * h
    exponential = expm(block)
    return exponential[:n, :n], exponential[:n, n : n + m], exponential[:n, n + m :]


def _validate_history(owner: str, values: npt.ArrayLike, t: FloatArray) -> FloatArray:
    history = validate_samples(owner, values)
    require_same_length(time=t, **{owner: history})
    return history


# Complex modes, computed by two methods.


_RIGID = 1e-6
"""Relative square of a pole below which it counts as 0: a double pole is only known to the root
of rounding."""


_THERE, _STEP_ASIDE = 1e-9, 1e-3
"""Part of a pole found already within which a search stands on it, and by which it steps aside."""


@dataclass(frozen=True, eq=False)
class ComplexMode(FrozenArrays):
    r"""Pole of a system and its complex mode shape.

    Scaled so that :math:`\phi^T D'(s) \phi = 1` with the dynamic stiffness D(s): then

    .. math:: H(s) = \sum_r \frac{\phi_r \phi_r^T}{s - s_r}

    over all poles, conjugates included, is the receptance, exactly.

    Attributes
    ----------
    pole : complex
        1/s, imaginary part >= 0.
    shape : complex array, shape (n,)
        One number per degree of freedom.
    converged : bool
        False if an iteration ended before the pole stood still.
    """

    pole: complex
    shape: ComplexArray
    converged: bool = True

    @property
    def frequency(self) -> float:
        """Undamped natural frequency abs(s) / 2 pi, Hz."""
        return abs(self.pole) / (2 * np.pi)

    @property
    def damping_ratio(self) -> float:
        """Damping ratio of the pole s, -Re s / abs(s); 1 for one that does not oscillate."""
        return -self.pole.real / abs(self.pole) if self.pole else 1.0

    @property
    def oscillates(self) -> bool:
        """False for a real pole, a relaxation."""
        return self.pole.imag > 0


def complex_modes(system: System) -> tuple[ComplexMode, ...]:
    """Return every mode of a system by the eigenvalues of its exact first-order form.

    Oscillations first, by rising frequency, then relaxations, by falling rate. Rigid-body motions
    of a system that nothing holds, double poles at 0, are omitted.
    """
    poles, vectors = np.linalg.eig(state_space(system).A)
    n = len(system.dofs)
    # rounding may leave a hair of an imaginary part on a real pole
    tolerance = 1e-9 * np.abs(poles) + 1e-13 * np.abs(poles).max()
    poles = np.where(np.abs(poles.imag) <= tolerance, poles.real, poles)
    rigid = _get_rigid_pole_limit(system)
    indices = np.flatnonzero((poles.imag >= 0) & (np.abs(poles) > rigid))
    with np.errstate(all="ignore"):  # the slope of an arm at its own rate
        slopes = system.spring_slope(poles[indices])
    modes = [
        ComplexMode(
            complex(poles[i]), _normalise_shape(system, complex(poles[i]), vectors[:n, i], slope)
        )
        for i, slope in zip(indices.tolist(), slopes, strict=True)
    ]
    return tuple(sorted(modes, key=lambda m: (not m.oscillates, abs(m.pole) * _get_sign(m))))


def newton_modes(system: System, *, iterations: int = 100) -> tuple[ComplexMode, ...]:
    r"""Return the oscillating modes by the nonlinear eigenproblem :math:`D(s)\phi = 0` itself.

    Newton's method on det D, whose logarithmic derivative is :math:`\mathrm{tr}(D^{-1} D')`,
    started near the poles by iterating :math:`s^2 = -\mathrm{eig}(M^{-1} E^T K(s) E)` from the
    glassy modes. Poles found already are divided out (Maehly), so no two starts end at the same
    one. No state of an arm appears: agreement with :func:`complex_modes` checks both. A mode so
    heavily damped that it does not oscillate may come out as one of its real poles.
    """
    results: list[complex] = []
    modes = []
    for start in _find_newton_starts(system):
        s, is_near = _refine_pole(system, start, results, iterations, 1e-6)
        s, is_converged = _refine_pole(system, s, results, iterations, 1e-14)
        s = s if s.imag >= 0 else s.conjugate()
        results.append(s)
        vector = np.linalg.svd(system.dynamic_stiffness(s))[2][-1].conj()
        shape = _normalise_shape(system, s, vector, system.spring_slope(s))
        modes.append(ComplexMode(s, shape, converged=is_near and is_converged))
    return tuple(sorted(modes, key=lambda mode: mode.frequency))


def _find_newton_starts(system: System) -> list[complex]:
    """Return starting points of the modes: with the stiffness at their own frequency."""
    E = system.stretch
    inverse = np.linalg.inv(system.mass_matrix)
    glass = np.array([spring.linearised_solid.k_0 for spring in system.springs])
    squared = np.sort(np.linalg.eigvals(inverse @ (E.T * glass) @ E).real)
    starts = []
    for rank, value in enumerate(squared):
        if value <= _RIGID * squared[-1]:
            continue
        s = 1j * np.sqrt(value)
        for _ in range(20):
            K = system.spring_stiffness(s)
            eigenvalues = np.linalg.eigvals(inverse @ (E.T * K) @ E)
            s = 1j * np.sqrt(eigenvalues[np.argsort(np.abs(eigenvalues))[rank]])
        starts.append(complex(s))
    return starts


def _refine_pole(
    system: System, s: complex, results: list[complex], iterations: int, tolerance: float
) -> tuple[complex, bool]:
    best = np.inf
    for _ in range(iterations):
        if any(min(abs(s - p), abs(s - p.conjugate())) < _THERE * abs(s) for p in results):
            s += _STEP_ASIDE * abs(s)
        try:
            derivative = _compute_derivative(system, s, system.spring_slope(s))
            change = np.linalg.solve(system.dynamic_stiffness(s), derivative)
        except np.linalg.LinAlgError:  # singular to the last digit: this is the pole
            return s, True
        slope = np.trace(change) - sum(1 / (s - p) + 1 / (s - p.conjugate()) for p in results)
        step = complex(1 / slope)
        s -= step
        magnitude = abs(step) / abs(s)
        # at the floor of rounding the steps stop shrinking: the pole stands still
        if not np.isfinite(magnitude):
            return s, False
        if magnitude <= tolerance or (magnitude < 1e-11 and magnitude >= best):
            return s, True
        best = min(best, magnitude)
    return s, False


def _compute_derivative(system: System, s: complex, slopes: ComplexArray) -> ComplexArray:
    """dD/ds: 2 s M + E^T K'(s) E."""
    E = system.stretch
    return np.asarray(2 * s * system.mass_matrix + (E.T * slopes) @ E)


def _normalise_shape(
    system: System, s: complex, vector: ComplexArray, slopes: ComplexArray
) -> ComplexArray:
    """Return the shape; 0 of a relaxation too close to that of its arm for any motion."""
    with np.errstate(all="ignore"):
        size = complex(vector @ _compute_derivative(system, s, slopes) @ vector)
        shape = np.asarray(vector / np.sqrt(size))
    return shape if np.isfinite(shape).all() else np.zeros_like(vector)


def _get_rigid_pole_limit(system: System) -> float:
    """Size of a pole, 1/s, below which it is 0, if the system has motions that stretch no spring.

    Otherwise less than any.
    """
    stretch = system.stretch  # of no spring at all NumPy before 2.1 knows no rank
    if len(system.dofs) <= (np.linalg.matrix_rank(stretch) if stretch.size else 0):
        return -1.0
    inertia = float(np.trace(system.mass_matrix))
    glass = float(sum(spring.linearised_solid.k_0 for spring in system.springs))
    return float(np.sqrt(_RIGID * glass / inertia))


def _get_sign(mode: ComplexMode) -> int:
    return 1 if mode.oscillates else -1
