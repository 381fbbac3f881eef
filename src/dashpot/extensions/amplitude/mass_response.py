"""FRF of a rigid mass at a level of excitation, by one harmonic."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dashpot.base.arrays import BoolArray, ComplexArray, FloatArray
from dashpot.base.value_ranges import SIZES, format_quantity_short
from dashpot.datamodel.frf import FRF, Kind
from dashpot.registry import require_handler
from dashpot.solids.maxwell import Solid
from dashpot.solids.rate_independent import AmplitudeDependent


def mass_at_level(
    solid: Solid,
    dependent: AmplitudeDependent | None,
    *,
    mass: float,
    level: float,
    frequency: FloatArray,
    kind: Kind | str = Kind.ACCELERANCE,
) -> tuple[FRF, FloatArray]:
    r"""FRF of a rigid mass at a level, by one harmonic, and the deformation of its support, m.

    .. math:: |K^*(\omega, X) - m\omega^2|\,X = F, \qquad F = m a

    over a base that moves with the acceleration a, X being the motion relative to it.

    Parameters
    ----------
    solid : Solid
        All that carries the mass, N/m, at a vanishing amplitude.
    dependent : AmplitudeDependent or None
        Amplitude-dependent part.
    mass : float
        kg.
    level : float
        Amplitude of the force, N; for a transmissibility of the base's acceleration, m/s^2.
    frequency : array, shape (n,)
        Hz, rising: where the resonance folds, the branch of an upward sweep.
    kind : Kind or str

    Raises
    ------
    DataError
        If the level moves the mass farther than any test does.
    """
    omega = 2 * np.pi * frequency
    kind = Kind(kind)
    K, inertia = solid.complex_stiffness(omega=omega), mass * omega**2
    force = mass * level if kind.over_base else level
    X = force / np.abs(K - inertia)
    if dependent is not None:
        stretch = _solve_stretch(lambda X: K + dependent.equivalent(omega, X), inertia, force)
        if stretch is None:  # it folds: what a sweep upwards shows
            sweep = require_handler("sweep at level", "mass")
            stretch = sweep(solid, dependent, mass=mass, level=force, frequency=frequency).stretch[
                0
            ]
        X = stretch
        K = K + dependent.equivalent(omega, X)
    max_amplitude = float(X.max(initial=0.0))
    SIZES["amplitude"].refuse(
        max(max_amplitude, SIZES["amplitude"].hard[0]),  # however little, a level is asked for
        f"at an amplitude of {format_quantity_short(level, 'm/s^2' if kind.over_base else 'N')} "
        "the mass would move by "
        f"{format_quantity_short(max_amplitude, 'm')}",
        remedy="Check the amplitude and its unit, and the mass.",
    )
    if kind.over_base:
        return FRF(frequency, K / (K - inertia), Kind.TRANSMISSIBILITY, units="SI").to(kind), X
    return FRF.from_receptance(frequency, 1 / (K - inertia), kind=kind), X


_DECADES, _PER_DECADE, _HALVINGS = 7, 20, 40
"""Decades of amplitudes over that of a rigid spring, points of each, and halvings between two."""


def _solve_stretch(
    stiffness: Callable[[FloatArray], ComplexArray], inertia: FloatArray, force: float
) -> FloatArray | None:
    """Return the amplitude at every line that the force takes, m; None where a line has several."""

    def is_above_force(ln_X: FloatArray) -> BoolArray:
        X = np.exp(ln_X)
        return np.asarray(np.abs(stiffness(X) - inertia) * X >= force)

    small = np.full(inertia.shape, 1e-12)
    low = np.log(force / 10 / (np.abs(stiffness(small)) + inertia))
    steps = np.log(10) / _PER_DECADE * np.arange(_DECADES * _PER_DECADE)
    is_above = is_above_force(low + steps[:, None])
    turns = np.count_nonzero(is_above[1:] != is_above[:-1], axis=0)
    if is_above[0].any() or (turns != 1).any():
        return None
    low = low + steps[is_above.argmax(axis=0) - 1]
    width = steps[1] - steps[0]
    for _ in range(_HALVINGS):
        width /= 2
        low = np.where(is_above_force(low + width), low, low + width)
    return np.asarray(np.exp(low + width))
