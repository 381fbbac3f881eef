r"""Response of a multibody system to random base motion."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np
import numpy.typing as npt

from dashpot.base.arrays import (
    ComplexArray,
    FloatArray,
    require_increasing,
    require_same_length,
    validate_samples,
)
from dashpot.base.errors import DataError
from dashpot.base.units import Quantity, convert_to_si
from dashpot.datamodel.frf import Kind, Mode
from dashpot.datamodel.random_response import RandomLimits, RandomResponse
from dashpot.extensions.systems.multibody import (
    MOTIONS,
    Mount,
    Point,
    System,
    Vector,
    point_mass,
    unit_vector,
)
from dashpot.extensions.systems.time_response import ComplexMode, complex_modes, state_space
from dashpot.solids.maxwell import Solid
from dashpot.vibration.mass_on_seals import model_modes

_LINES = 4001
_UNDAMPED, _RIGID_RATIO = 1e-10, 1e-15
"""Rate of decay over that of turning, and any rate over the largest of a system: rounding."""
_DECADES = 1e10
"""Longest over shortest relaxation time, beyond which the first-order form is rounding."""
_WHITE_BAND = (1e-6, 1e4)
"""Times the natural frequency: a table as wide as white noise."""
_ROUNDING_STRETCH = 1e-9
"""Stretch of a spring per motion of a ground that takes all bodies along: rounding."""
_FINE_WIDTHS = 60.0
"""Half-power widths to either side of a resonance that are laid out finely."""
_LIMIT_LINES = 201
"""Lines of limits over a table, and as many about each resonance."""
_WHITE_NOISE_BAND = (1e-3, 1e3)
"""Times the relaxed natural frequency: what of white noise has limits."""


def random_base(
    model: Solid,
    *,
    mass: Quantity,
    psd: float | npt.ArrayLike,
    frequency: npt.ArrayLike | None = None,
    coupled: float = 0.0,
) -> RandomResponse:
    r"""Return standard deviations of a mass on a base whose acceleration is stationary noise.

    White noise: from the Lyapunov equation of position, velocity and the arms,

    .. math:: A P + P A^T + \tfrac12 S\, b\, b^T = 0, \qquad \sigma_a^2 = c P c^T

    with c the force of the solid over the mass; exact, whatever the damping. A table of psd over
    frequency, straight between its points in their logarithms:
    :math:`\sigma_a^2 = \int |T|^2 S\,df`.

    Parameters
    ----------
    model : Solid
        All the mounts together.
    mass : str or float
        kg.
    psd : float or array_like, shape (n,)
        One-sided, of the base's acceleration, (m/s^2)^2/Hz.
    frequency : array_like, shape (n,), optional
        Hz, of a table; it is 0 outside.
    coupled : float
        For mounts that weigh something, the mass that couples both ends, kg
        (:mod:`dashpot.vibration.mass_on_seals`).

    Raises
    ------
    DataError
        If a density is below 0, or white noise meets a coupled mass, through which it has no
        finite acceleration.
    """
    kilograms = convert_to_si(mass, "mass")
    if not (np.isfinite(kilograms) and kilograms > 0):
        raise DataError(f"mass = {mass!r} kg; expected a number > 0")
    if frequency is None:
        if coupled > 0:
            raise DataError(
                "white noise through mounts that weigh something has no finite acceleration; give "
                "a psd over frequencies"
            )
        if _has_wide_spectrum((model,)):
            peak = model_modes(model, kilograms)[0].frequency
            frequency_range, flat_psd = (
                np.array(_WHITE_BAND) * peak,
                np.array([psd, psd], dtype=float),
            )
            return _integrate_table(model, kilograms, *_read_table(frequency_range, flat_psd), 0.0)
        system = System((point_mass("mass", kilograms),), (Mount(model, ("mass", "ground")),))
        return random_response(system, response="mass.z", psd=psd)
    f, table = _read_table(frequency, psd)
    return _integrate_table(model, kilograms, f, table, coupled)


def random_limits(
    model: Solid,
    limits: Callable[[FloatArray, Kind], FloatArray],
    *,
    mass: float,
    psd: float | npt.ArrayLike,
    frequency: npt.ArrayLike | None = None,
    coupled: float = 0.0,
) -> RandomLimits:
    r"""Return limits of :func:`random_base` from those of the response, line by line.

    .. math:: \int |T|_{low}^2 S\,df \le \sigma_a^2 \le \int |T|_{high}^2 S\,df

    and so for the stretch, :math:`(m + m_c) |A| / \omega^2` per acceleration of the base. No one
    solid need be at the limit of every line: these are wider than those of the integral.

    Parameters
    ----------
    model : Solid
        Model of the point value, which lies within.
    limits : callable
        Lowest and highest magnitude, shape (2, n), at lines, Hz, of the transmissibility and of
        the accelerance, 1/kg.
    mass, psd, frequency, coupled
        As in :func:`random_base`.
    """
    if frequency is None:
        resonance = np.sqrt(model.k_inf / mass) / (2 * np.pi)
        f, table = _read_table(
            np.array(_WHITE_NOISE_BAND) * resonance, np.array([psd, psd], dtype=float)
        )
    else:
        f, table = _read_table(frequency, psd)
    modes = model_modes(model, mass)
    grid, lines = _place_lines(f, modes), _place_lines(f[[0, -1]], modes, _LIMIT_LINES)
    S = _interpolate_density(grid, f, table)
    transmissibility, relative = _compute_base_ratios(model, mass, 2 * np.pi * grid, coupled)
    per_force = limits(lines, Kind.ACCELERANCE) / (2 * np.pi * lines) ** 2

    def reach(limits: FloatArray, nominal: ComplexArray) -> tuple[float, float]:
        low, high = (np.interp(grid, lines, row) for row in limits)
        # beside a line that nothing limits, the straight line to it is no number
        high = np.nan_to_num(np.maximum(high, np.abs(nominal)), nan=np.inf, posinf=np.inf)
        powers = [np.minimum(low, np.abs(nominal)), np.where(S > 0, high, 0.0)]
        small, larger = (float(np.sqrt(np.trapezoid(power**2 * S, grid))) for power in powers)
        return small, larger

    return RandomLimits(
        reach(limits(lines, Kind.TRANSMISSIBILITY), transmissibility),
        reach((mass + coupled) * per_force, relative),
        (float(f[0]), float(f[-1])),
    )


def random_response(
    system: System,
    *,
    response: str | Point,
    psd: float | npt.ArrayLike,
    frequency: npt.ArrayLike | None = None,
    base: str = "ground",
    along: Vector = (0.0, 0.0, 1.0),
) -> RandomResponse:
    r"""Standard deviations at a place of a system whose ground shakes at random along a direction.

    With the motion relative to the ground, :math:`q = q_r + R u` with R that of bodies that follow,

    .. math:: M \ddot q_r + \ldots = -M R\,\ddot u, \qquad
        \ddot q = M^{-1} (\text{forces of the springs})

    white noise by the Lyapunov equation of its first-order form, arms included; a table by the
    poles and shapes of the system, :math:`q_r/\ddot u = -\sum_r \varphi_r \varphi_r^T M R /
    (s - s_r)`.

    Parameters
    ----------
    system : System
        All of whose bodies are free to follow the ground.
    response : str or Point
    psd, frequency
        As in :func:`random_base`.
    base : str
        The ground.
    along : (float, float, float)

    Raises
    ------
    DataError
        As :func:`random_base`; or if a body is held in a motion in which the ground shakes, or
        nothing holds it.
    """
    rigid_motion, participation = (
        _get_rigid_motion(system, base, along),
        system.participation(response),
    )
    if frequency is None:
        density = float(np.asarray(psd, dtype=float))
        if not (np.isfinite(density) and density >= 0):
            raise DataError(f"psd = {psd!r}; expected a density >= 0, in (m/s^2)^2/Hz")
        if _has_wide_spectrum(model.linearised_solid for model in system.springs):
            raise DataError(
                "the arms of a part reach over more than ten decades of time, too many for white "
                "noise of the base; give a psd over frequencies"
            )
        return _compute_white_response(system, rigid_motion, participation, density)
    f, table = _read_table(frequency, psd)
    modes = complex_modes(system)
    lines = _place_lines(f, [m for m in modes if m.oscillates])
    S = _interpolate_density(lines, f, table)
    s, push = 2j * np.pi * lines, system.mass_matrix @ rigid_motion
    values = np.zeros(len(lines), dtype=complex)
    for mode in modes:
        gain = complex((participation @ mode.shape) * (mode.shape @ push))
        values -= gain / (s - mode.pole)
        if mode.oscillates:
            values -= gain.conjugate() / (s - mode.pole.conjugate())
    transmissibility = participation @ rigid_motion + s**2 * values
    return _integrate_response(lines, S, transmissibility, values)


def _has_wide_spectrum(solids: Iterable[Solid]) -> bool:
    """Return whether arms reach over more decades than a first-order form can hold."""
    times = [tau for solid in solids for tau in solid.maxwell.tau]
    return bool(times) and max(times) > _DECADES * min(times)


def _get_rigid_motion(system: System, base: str, along: Vector) -> FloatArray:
    """Return the rigid motion of the degrees of freedom with a ground, shape (n,)."""
    if base not in system.grounds:
        raise DataError(f"'{base}' is no ground; known: {', '.join(system.grounds)}")
    direction = dict(zip(MOTIONS, unit_vector(along), strict=False))
    R = np.array([direction.get(dof.rpartition(".")[2], 0.0) for dof in system.dofs])
    G = np.array([direction.get(dof.removeprefix(f"{base}."), 0.0) for dof in system.base_dofs])
    remainder = system.stretch @ R + system.base_stretch @ G
    if np.abs(remainder).max(initial=0.0) > _ROUNDING_STRETCH:
        raise DataError(
            f"a body is held in a motion in which '{base}' shakes, along {along}, or hangs on "
            "another ground; let it move there"
        )
    return R


def _compute_white_response(
    system: System, rigid_motion: FloatArray, participation: FloatArray, density: float
) -> RandomResponse:
    """Return the response to white noise by the stable states of the first-order form.

    The others, undamped motions, must not be shaken: in an ordered Schur form they then rest.
    """
    from scipy.linalg import schur, solve_continuous_lyapunov

    A, n = state_space(system).A, len(system.dofs)
    size = np.ones(len(A))  # velocities in units in which they are as large as displacements
    size[n : 2 * n] = np.sqrt(np.abs(A[n : 2 * n, :n]).max())
    scaled_matrix = A * size / size[:, None]
    input_vector = np.zeros(len(A))
    input_vector[n : 2 * n] = -rigid_motion / size[n : 2 * n]
    tolerance = _RIGID_RATIO * float(np.linalg.norm(scaled_matrix, ord=np.inf))

    def dies_away(re: float, im: float) -> bool:
        magnitude = float(np.hypot(re, im))
        return re < -_UNDAMPED * magnitude and magnitude > tolerance  # a slow arm dies away slowly

    triangle, basis, count = schur(scaled_matrix, sort=dies_away)
    if np.abs(basis[:, count:].T @ input_vector).max(
        initial=0.0
    ) > _ROUNDING_STRETCH * np.linalg.norm(input_vector):
        ratio = np.abs(np.linalg.eigvals(triangle[count:, count:])).min() / (2 * np.pi)
        raise DataError(
            "white noise of the base has no finite answer: a model without k_inf drifts away, or "
            f"nothing damps a motion that it shakes, at {ratio:.4g} Hz; give that part a damping, "
            "or a psd over frequencies"
        )
    stable, stable_input = basis[:, :count], basis[:, :count].T @ input_vector
    inner = triangle[:count, :count]
    variance = solve_continuous_lyapunov(inner, -density / 2 * np.outer(stable_input, stable_input))
    P = np.outer(size, size) * (stable @ variance @ stable.T)
    acceleration_row = participation @ A[n : 2 * n]
    change, speed = (participation @ P[i : i + n, i : i + n] @ participation for i in (0, n))
    return _make_response(
        float(acceleration_row @ P @ acceleration_row), float(change), float(speed)
    )


def _read_table(frequency: npt.ArrayLike, psd: npt.ArrayLike) -> tuple[FloatArray, FloatArray]:
    f = require_increasing("frequency", validate_samples("frequency", frequency, minimum=2))
    table = validate_samples("psd", psd, minimum=2)
    require_same_length(frequency=f, psd=table)
    if f[0] <= 0 or (table < 0).any():
        raise DataError("a table of psd needs frequencies > 0 Hz and densities >= 0")
    return f, table


def _integrate_table(
    model: Solid, mass: float, f: FloatArray, table: FloatArray, coupled: float
) -> RandomResponse:
    grid = _place_lines(f, model_modes(model, mass))
    return _integrate_response(
        grid,
        _interpolate_density(grid, f, table),
        *_compute_base_ratios(model, mass, 2 * np.pi * grid, coupled),
    )


def _compute_base_ratios(
    model: Solid, mass: float, w: FloatArray, coupled: float
) -> tuple[ComplexArray, ComplexArray]:
    """Transmissibility, and stretch per acceleration of the base, s^2."""
    K = model.complex_stiffness(omega=w)
    ratio = 1 / (K - mass * w**2)
    return (K + coupled * w**2) * ratio, (mass + coupled) * ratio


def _place_lines(
    f: FloatArray, modes: Sequence[Mode | ComplexMode], count: int = _LINES
) -> FloatArray:
    """Return frequencies over a table, dense about the resonances."""
    grids = [np.geomspace(f[0], f[-1], count), f]
    for mode in modes:
        width = mode.frequency * max(mode.damping_ratio, 1e-6)
        distances = width * np.sinh(np.linspace(0, np.arcsinh(_FINE_WIDTHS), count // 2))
        grids += [mode.frequency + distances, mode.frequency - distances]
    grid = np.unique(np.concatenate(grids))
    return np.asarray(grid[(grid >= f[0]) & (grid <= f[-1])])


def _interpolate_density(frequency: FloatArray, f: FloatArray, table: FloatArray) -> FloatArray:
    with np.errstate(divide="ignore"):
        return np.exp(np.interp(np.log(frequency), np.log(f), np.log(table)))


def _integrate_response(
    f: FloatArray, S: FloatArray, transmissibility: ComplexArray, relative: ComplexArray
) -> RandomResponse:
    """Return the response from transmissibility, and relative motion per acceleration."""
    change = np.abs(relative) ** 2
    return _make_response(
        float(np.trapezoid(np.abs(transmissibility) ** 2 * S, f)),
        float(np.trapezoid(change * S, f)),
        float(np.trapezoid((2 * np.pi * f) ** 2 * change * S, f)),
    )


def _make_response(acceleration: float, stretch: float, speed: float) -> RandomResponse:
    rate = np.sqrt(speed / stretch) / (2 * np.pi) if stretch > 0 else 0.0
    return RandomResponse(float(np.sqrt(acceleration)), float(np.sqrt(stretch)), float(rate))
