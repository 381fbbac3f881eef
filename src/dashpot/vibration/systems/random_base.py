r"""A mass on a solid whose base shakes at random."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dashpot.base.arrays import FloatArray, increasing, same_length, samples
from dashpot.base.errors import DataError
from dashpot.base.units import Quantity, si
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid
from dashpot.vibration.systems.prediction import model_modes

_LINES = 4001
_ABOUT = 60.0
"""Half-power widths to either side of a resonance that are laid out finely."""


@dataclass(frozen=True)
class RandomResponse:
    """What a random motion of the base does to the mass, as standard deviations.

    Attributes
    ----------
    acceleration : float
        Of the mass, absolute, m/s^2.
    stretch : float
        Of the solid: mass against base, m.
    crossings : float
        Upward crossings of zero of the stretch a second, 1/s (Rice).
    """

    acceleration: float
    stretch: float
    crossings: float


def random_base(
    model: Solid,
    *,
    mass: Quantity,
    psd: float | npt.ArrayLike,
    frequency: npt.ArrayLike | None = None,
    coupled: float = 0.0,
) -> RandomResponse:
    r"""Standard deviations of a mass on a base whose acceleration is stationary noise.

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
        Of mounts that weigh something, the mass that couples both ends, kg
        (:mod:`dashpot.vibration.systems.mounts`).

    Raises
    ------
    DataError
        If a density is below 0, or white noise meets a parallel dashpot or a coupled mass, through
        which it has no finite acceleration.
    """
    kilograms = si(mass, "mass")
    if not (np.isfinite(kilograms) and kilograms > 0):
        raise DataError(f"mass = {mass!r} kg; expected a number > 0")
    if frequency is None:
        density = float(np.asarray(psd, dtype=float))
        if not (np.isfinite(density) and density >= 0):
            raise DataError(f"psd = {psd!r}; expected a density >= 0, in (m/s^2)^2/Hz")
        if coupled > 0:
            raise DataError(
                "white noise through mounts that weigh something has no finite acceleration; give "
                "a psd over frequencies"
            )
        return _white(model.maxwell, kilograms, density)
    f = increasing("frequency", samples("frequency", frequency, minimum=2))
    table = samples("psd", psd, minimum=2)
    same_length(frequency=f, psd=table)
    if f[0] <= 0 or (table < 0).any():
        raise DataError("a table of psd needs frequencies > 0 Hz and densities >= 0")
    return _tabled(model, kilograms, f, table, coupled)


def _white(solid: GeneralizedMaxwell, mass: float, density: float) -> RandomResponse:
    """By the states e, de/dt and the elongation of each arm's spring."""
    from scipy.linalg import solve_continuous_lyapunov

    if solid.b > 0:
        raise DataError(
            f"b = {solid.b:g} N s/m: white noise through a parallel dashpot has no finite "
            "acceleration; give a psd over frequencies"
        )
    if not solid.k_inf > 0:
        raise DataError("a solid without k_inf drifts away under white noise of its base")
    k, tau = np.asarray(solid.k), np.asarray(solid.tau)
    n = 2 + len(k)
    A = np.zeros((n, n))
    A[0, 1] = 1.0
    A[1, 0], A[1, 2:] = -solid.k_inf / mass, -k / mass
    A[2:, 1] = 1.0
    A[2:, 2:] = -np.diag(1 / tau)
    shaken = np.zeros((n, n))
    shaken[1, 1] = density / 2
    P = solve_continuous_lyapunov(A, -shaken)
    pull = A[1]
    return _response(float(pull @ P @ pull), float(P[0, 0]), float(P[1, 1]))


def _tabled(
    model: Solid, mass: float, f: FloatArray, table: FloatArray, coupled: float
) -> RandomResponse:
    grids = [np.geomspace(f[0], f[-1], _LINES), f]
    for mode in model_modes(model, mass):
        width = mode.frequency * max(mode.damping_ratio, 1e-6)
        away = width * np.sinh(np.linspace(0, np.arcsinh(_ABOUT), _LINES // 2))
        grids += [mode.frequency + away, mode.frequency - away]
    at = np.unique(np.concatenate(grids))
    at = at[(at >= f[0]) & (at <= f[-1])]
    with np.errstate(divide="ignore"):
        S = np.exp(np.interp(np.log(at), np.log(f), np.log(table)))
    w = 2 * np.pi * at
    K = model.complex_stiffness(w)
    felt = 1 / (K - mass * w**2)
    relative = (mass + coupled) * felt  # stretch per acceleration of the base
    carried = np.abs((K + coupled * w**2) * felt) ** 2
    moved = np.abs(relative) ** 2
    return _response(
        float(np.trapezoid(carried * S, at)),
        float(np.trapezoid(moved * S, at)),
        float(np.trapezoid(w**2 * moved * S, at)),
    )


def _response(acceleration: float, stretch: float, speed: float) -> RandomResponse:
    rate = np.sqrt(speed / stretch) / (2 * np.pi) if stretch > 0 else 0.0
    return RandomResponse(float(np.sqrt(acceleration)), float(np.sqrt(stretch)), float(rate))
