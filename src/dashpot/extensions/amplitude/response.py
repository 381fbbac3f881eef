"""Response at any level of the mass under FRFs at several amplitudes."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.errors import DataError
from dashpot.datamodel.frf import FRF, Kind
from dashpot.extensions.amplitude.level_results import LevelFit, Parts
from dashpot.extensions.amplitude.mass_response import mass_at_level
from dashpot.solids.nonlinear_springs import Cubic
from dashpot.solids.rate_independent import InParallel

_LINES = 121
_AMPLITUDES = 80
_HALVINGS = 25


def receptance_at_level(level_fit: LevelFit, level: float, frequency: FloatArray) -> FRF:
    """Motion of the mass over a force of that amplitude, by harmonic balance, m/N.

    Parameters
    ----------
    level_fit : LevelFit
    level : float
        N.
    frequency : array, shape (n,)
        Hz, rising: where the resonance folds, the branch of an upward sweep.
    """
    solid = level_fit.seals * level_fit.solid
    dependent = (
        level_fit.seals * InParallel(level_fit.rate_independent)
        if level_fit.rate_independent
        else None
    )
    frf, _ = mass_at_level(
        solid,
        dependent,
        mass=level_fit.mass,
        level=level,
        frequency=frequency,
        kind=Kind.RECEPTANCE,
    )
    return frf


def resonance_at_level(
    level_fit: LevelFit, level: float, *, parts_of_model: Parts | None = None
) -> tuple[float, float]:
    r"""Frequency, Hz, and amplitude, m, of the largest motion under a force of that amplitude.

    The force required for an amplitude is smallest at its own resonance,

    .. math:: F(X) = X \min_\omega |n K^*(\omega, X) - m\omega^2|

    and X is where that is the level: also where the resonance folds, and a sweep might miss it.

    Parameters
    ----------
    level_fit : LevelFit
    level : float
        N.
    parts_of_model : (GeneralizedMaxwell, tuple of Jenkins or Cubic), optional
        One of the fit's draws, in the place of the fit itself.

    Raises
    ------
    DataError
        If there is no resonance between the lines that were fitted.
    """
    parts = (
        (level_fit.solid, level_fit.rate_independent) if parts_of_model is None else parts_of_model
    )
    inertia = level_fit.mass / level_fit.seals
    f = np.linspace(*level_fit.band, _LINES)
    omega = 2 * np.pi * f

    def missing(X: FloatArray) -> FloatArray:
        """Size of the dynamic stiffness of amplitudes X, N/m, shape (x, f)."""
        K = stiffness_at(parts, omega, np.asarray(X)[:, None], inertia)
        return level_fit.seals * np.abs(K - inertia * omega**2)

    low = high = np.log(level / missing(np.array([level_fit.amplitudes[0]])).min())
    grid = np.linspace(low - 5, high + 5, _AMPLITUDES)
    X = np.exp(grid)
    strong_enough = np.flatnonzero(X * missing(X).min(axis=1) >= level)
    first = int(strong_enough[0]) if strong_enough.size else 0
    if not first:
        raise DataError(f"at {level:g} N no amplitude of motion near the fitted ones is found")
    low, high = grid[first - 1], grid[first]
    for _ in range(_HALVINGS):
        midpoint = (low + high) / 2
        X = np.exp([midpoint])
        low, high = (low, midpoint) if X[0] * missing(X).min() >= level else (midpoint, high)
    size = missing(np.exp([high]))[0]
    peak_index = int(size.argmin())
    if peak_index in {0, _LINES - 1}:
        raise DataError(
            f"at {level:g} N the motion is largest at an end of the lines, {f[0]:.4g} to "
            f"{f[-1]:.4g} Hz: there is no resonance among them"
        )
    # the square is a parabola about its least
    left, centre, right = size[peak_index - 1 : peak_index + 2] ** 2
    shift = (left - right) / (2 * (left - 2 * centre + right))
    peak_square = centre - shift * (left - right) / 4
    return float(f[peak_index] + shift * (f[1] - f[0])), level / float(np.sqrt(peak_square))


def stiffness_at(parts: Parts, omega: FloatArray, X: FloatArray, inertia: float) -> ComplexArray:
    """Return complex stiffness of one seal under its share of the mass, N/m; broadcasts."""
    solid, elements = parts
    springs = [element for element in elements if isinstance(element, Cubic)]
    other_elements = InParallel(
        (solid, *(element for element in elements if not isinstance(element, Cubic)))
    )
    K = other_elements.equivalent(omega, X)
    if springs:
        harmonic_factor = with_third_harmonic(parts, omega, X, inertia)
        K = K + harmonic_factor * sum(spring.stiffness(X) for spring in springs)
    return np.asarray(K)


def with_third_harmonic(
    parts: Parts, omega: FloatArray, X: FloatArray, inertia: float
) -> ComplexArray:
    r"""Return the factor of the third harmonic on the stiffness of a cubic spring under a mass.

    .. math:: \frac{X_3}{X} = \frac{-k_3 X^2 / 4}{K(3\omega) - 9 m \omega^2}, \qquad
        \frac{N}{\tfrac34 k_3 X^2} = 1 + \frac{X_3}{X} + 2 \left|\frac{X_3}{X}\right|^2

    Parameters
    ----------
    parts : (GeneralizedMaxwell, tuple of Jenkins or Cubic)
        Friction is omitted from the motion at the third harmonic.
    omega, X : array
        rad/s and m; broadcast.
    inertia : float
        Inertia of one seal, kg.
    """
    solid, elements = parts
    k3 = sum(element.k3 for element in elements if isinstance(element, Cubic))
    third_harmonic_stiffness = solid.complex_stiffness(omega=3 * omega) - 9 * inertia * omega**2
    ratio = -k3 * X**2 / 4 / third_harmonic_stiffness
    return np.asarray(1 + ratio + 2 * np.abs(ratio) ** 2)
