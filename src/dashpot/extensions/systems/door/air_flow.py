r"""Flow of air out of chambers through openings: compressible, choked at the limit.

.. math:: \dot m = C_d A \sqrt{p_u \rho_u}\,\Psi(p_d/p_u), \qquad
    \Psi^2 = \frac{2\gamma}{\gamma-1}\left(x^{2/\gamma} - x^{(\gamma+1)/\gamma}\right)

with x no lower than its critical value :math:`(2/(\gamma+1))^{\gamma/(\gamma-1)} = .5283`, and
:math:`p/p_a = (\rho/\rho_a)^n` within (A. H. Shapiro, *The Dynamics and Thermodynamics of
Compressible Fluid Flow*, 1953, ch. 4).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from dashpot.base.arrays import FloatArray

AMBIENT_PRESSURE = 101325.0
"""Pressure, Pa."""
AIR_DENSITY = 1.2
"""kg/m^3, at 21 degC."""
GAMMA = 1.4
CHOKED_PRESSURE_RATIO = (2 / (GAMMA + 1)) ** (GAMMA / (GAMMA - 1))
_LOG_CHOKED = np.log(CHOKED_PRESSURE_RATIO)
_SLOPE = np.sqrt(2 * GAMMA / (GAMMA - 1) * AMBIENT_PRESSURE * AIR_DENSITY)

_IMPLICIT_STAGE = 1 - np.sqrt(0.5)
"""Stage of the stiffly stable two-stage rule of second order (Alexander 1977)."""
_MAX_ITERATIONS = 60
_CONVERGENCE_TOLERANCE = 1e-9


def mass_flux(pressure: npt.ArrayLike, density: npt.ArrayLike) -> FloatArray:
    """Flow out of a chamber per area of jet, kg/(s m^2); negative for inflow.

    Parameters
    ----------
    pressure, density : array_like
        In the chamber, Pa and kg/m^3; outside they are those of the environment.
    """
    log_pressure = np.log(np.asarray(pressure, dtype=float) / AMBIENT_PRESSURE)
    return _compute_log_flux(log_pressure, np.log(np.asarray(density, dtype=float) / AIR_DENSITY))


def _compute_log_flux(log_pressure: FloatArray, log_density_ratio: FloatArray) -> FloatArray:
    """Return the same of ln p/p_a and ln rho/rho_a, of which a march has no need to take powers."""
    upstream = np.exp(np.where(log_pressure > 0, 0.5 * (log_pressure + log_density_ratio), 0.0))
    log_ratio = np.maximum(-np.abs(log_pressure), _LOG_CHOKED)
    # x^(2/g) - x^(1+1/g), without cancellation at x near 1
    flow_drop = -np.exp(2 / GAMMA * log_ratio) * np.expm1((1 - 1 / GAMMA) * log_ratio)
    return np.asarray(np.copysign(_SLOPE * upstream * np.sqrt(flow_drop), log_pressure))


def compute_pressure(density: npt.ArrayLike, exponent: float) -> FloatArray:
    """Pa, of air of a density, kg/m^3, that was the ambient's."""
    return np.asarray(AMBIENT_PRESSURE * (np.asarray(density) / AIR_DENSITY) ** exponent)


def compute_stored_energy(density: FloatArray, volume: FloatArray, exponent: float) -> FloatArray:
    """Return the energy that the air of a chamber would give back in expansion, J."""
    p = compute_pressure(density, exponent)
    free_volume = volume * density / AIR_DENSITY
    if exponent == 1.0:
        inner = p * volume * np.log(p / AMBIENT_PRESSURE)
    else:
        inner = (p * volume - AMBIENT_PRESSURE * free_volume) / (exponent - 1)
    return np.asarray(inner - AMBIENT_PRESSURE * (free_volume - volume))


def compute_next_density(
    density: FloatArray,
    volumes: tuple[FloatArray, FloatArray],
    opening: FloatArray,
    seconds: FloatArray,
    exponent: float,
) -> FloatArray:
    """Density after a step of time in which the volume changes evenly, kg/m^3.

    Parameters
    ----------
    density : array
        Before it.
    volumes : (array, array)
        Before and after, m^3.
    opening : array
        Jet area C_d A, m^2.
    seconds : array
    exponent : float
        n.
    """
    volume_before, volume_after = volumes
    mass = density * volume_before
    inner = volume_before + _IMPLICIT_STAGE * (volume_after - volume_before)
    step = opening * seconds
    first = _solve_implicit_step(mass, inner, _IMPLICIT_STAGE * step, exponent, density)
    flow = step * mass_flux(compute_pressure(first, exponent), first)
    return _solve_implicit_step(
        mass - (1 - _IMPLICIT_STAGE) * flow, volume_after, _IMPLICIT_STAGE * step, exponent, first
    )


def _solve_implicit_step(
    mass: FloatArray, volume: FloatArray, step: FloatArray, n: float, guess: FloatArray
) -> FloatArray:
    """Return the density r with V r + step * flux(r) = mass, near a guess.

    In z with p/p_a = 1 + z|z| the flux is all but straight, so that Newton does not feel its
    infinite slope at rest; the answer lies between rest and the chamber without its opening.
    """
    z_bound = _find_density(np.maximum(mass / volume, 1e-6 * AIR_DENSITY), n)
    low, high = np.minimum(z_bound, 0.0), np.maximum(z_bound, 0.0)
    # where nothing flows, the bound is the answer
    z = np.where(step > 0, np.clip(_find_density(guess, n), low, high), z_bound)
    slope = np.sqrt(2 * AMBIENT_PRESSURE * AIR_DENSITY)
    for _ in range(_MAX_ITERATIONS):
        magnitude = np.abs(z)
        log_pressure = np.log1p(z * magnitude)
        air_mass = volume * AIR_DENSITY * np.exp(log_pressure / n)
        miss = air_mass + step * _compute_log_flux(log_pressure, log_pressure / n) - mass
        slope_of_balance = air_mass * (2 / n) * magnitude / (1 + z * magnitude) + step * slope
        z = np.minimum(
            np.maximum(z - miss / np.where(slope_of_balance > 0, slope_of_balance, np.inf), low),
            high,
        )
        if (np.abs(miss) <= _CONVERGENCE_TOLERANCE * mass).all():
            break
    return np.asarray(AIR_DENSITY * (1 + z * np.abs(z)) ** (1 / n))


def _find_density(density: FloatArray, n: float) -> FloatArray:
    relative_pressure = (density / AIR_DENSITY) ** n - 1
    return np.asarray(np.copysign(np.sqrt(np.abs(relative_pressure)), relative_pressure))
