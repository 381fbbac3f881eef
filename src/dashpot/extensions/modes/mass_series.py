r"""Stiffness of a solid from the poles under several masses.

Where a mass m rings, :math:`m p^2 + K(p) = 0`: each pole is one complex value of the stiffness,

.. math:: K(p) = -m p^2

exactly, whatever the linear solid. A passive one is :math:`k_\infty + b\,s + \sum_j k_j s\tau_j /
(1 + s\tau_j)` with nothing negative, so whether any solid at all has the poles of several masses is
a non-negative least-squares problem over all relaxation times.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.errors import DataError
from dashpot.datamodel.frf import Mode
from dashpot.numerics.nonnegative_least_squares import solve_linear
from dashpot.solids.maxwell import GeneralizedMaxwell

STORAGE, LOSS = 0.003, 0.03
"""Relative differences of stiffness and damping that do not matter, as standard deviations."""
TIMES = np.geomspace(1e-3, 1e3, 97)
"""Relaxation times, over the time 1/|p| of the poles."""


@dataclass(frozen=True, eq=False)
class SeveralMasses:
    """Stiffness at the poles under several masses, and the solid closest to all.

    Attributes
    ----------
    masses : tuple of float
        kg.
    modes : tuple of Mode
    stiffness : complex array, shape (masses,)
        N/m of one seal, at each pole.
    spread : array, shape (masses, 2)
        Standard errors of its real and its imaginary part.
    solid : GeneralizedMaxwell
        Model of one seal: one of the solids that come closest; poles of a few masses show no
        spectrum.
    distance : float
        How far its stiffness is from that at the poles, root of the sum of squares in standard
        errors, of which none counts less than 0.3 % of the stiffness and 3 % of the damping.
    worst : int
        Under which of the masses it is farthest.
    """

    masses: tuple[float, ...]
    modes: tuple[Mode, ...]
    stiffness: ComplexArray
    spread: FloatArray
    solid: GeneralizedMaxwell
    distance: float
    worst: int

    @property
    def max_difference(self) -> complex:
        """Relative difference at the worst pole: of the stiffness, and of its imaginary part."""
        measured, model_stiffness = self.stiffness[self.worst], self.stiffness_at_poles[self.worst]
        return complex(
            measured.real / model_stiffness.real - 1, measured.imag / model_stiffness.imag - 1
        )

    @property
    def stiffness_at_poles(self) -> ComplexArray:
        """The solid's stiffness at the poles, N/m."""
        return np.array([self.solid.stiffness_at(mode.pole) for mode in self.modes])


def several_masses(
    modes: Sequence[Mode], masses: Sequence[float], *, seals: float = 1.0
) -> SeveralMasses:
    """Hold the poles under several masses against every passive linear solid.

    Parameters
    ----------
    modes : sequence of Mode
        One under each mass.
    masses : sequence of float
        kg.
    seals : float
        That carry each of them.

    Raises
    ------
    DataError
        If there are fewer than two masses, or two are alike.
    """
    if len(masses) < 2 or len(set(masses)) < len(masses) or len(modes) != len(masses):
        masses_text = ", ".join(f"{mass:g}" for mass in masses)
        raise DataError(
            f"{len(modes)} modes under masses of {masses_text} kg; expected one mode under each of "
            "two or more different masses"
        )
    p = np.array([mode.pole for mode in modes])
    m = np.array(masses)
    stiffness = -m * p**2 / seals
    pairs = zip(modes, masses, strict=True)
    standard_errors = np.array(
        [_compute_standard_errors(mode, mass / seals) for mode, mass in pairs]
    )
    # the loss is Im K where a pole is light: its error is that of the damping
    counts = np.column_stack(
        (np.hypot(standard_errors[:, 0], STORAGE * np.abs(stiffness)),
         np.hypot(standard_errors[:, 1], LOSS * np.abs(stiffness) * 2 * _compute_ratios(modes)))
    )  # fmt: skip
    tau = TIMES / float(np.exp(np.log(np.abs(p)).mean()))
    size = float(np.abs(stiffness).mean())
    damper = p / float(np.abs(p).mean())
    columns = np.column_stack((np.ones_like(p), damper, p[:, None] * tau / (1 + p[:, None] * tau)))
    rows = np.concatenate((columns.real / counts[:, [0]], columns.imag / counts[:, [1]])) * size
    y = np.concatenate((stiffness.real / counts[:, 0], stiffness.imag / counts[:, 1]))
    k = solve_linear(rows, y, positive=True)[0]
    pair = (rows @ k - y).reshape(2, -1)
    max_error, k = np.hypot(pair[0], pair[1]), size * k
    arms = np.flatnonzero(k[2:] > 0)
    solid = GeneralizedMaxwell(
        float(k[0]), tuple(map(float, k[2:][arms])), tuple(map(float, tau[arms])),
        b=float(k[1] / np.abs(p).mean()),
    )  # fmt: skip
    worst_index = int(np.argmax(max_error))
    return SeveralMasses(
        tuple(masses),
        tuple(modes),
        stiffness,
        standard_errors,
        solid,
        float(np.linalg.norm(max_error)),
        worst_index,
    )


def _compute_ratios(modes: Sequence[Mode]) -> FloatArray:
    return np.array([mode.damping_ratio for mode in modes])


def _compute_standard_errors(mode: Mode, mass: float) -> tuple[float, float]:
    """Return standard errors of the real and imaginary part of m p^2, N/m."""
    zeta, size = mode.damping_ratio, mass * abs(mode.pole) ** 2
    real_part, imaginary_part = 1 - 2 * zeta**2, 2 * zeta * float(np.sqrt(1 - zeta**2))
    by_frequency = 2 * mode.frequency_se / mode.frequency
    real = np.hypot(real_part * by_frequency, 4 * zeta * mode.damping_ratio_se)
    damping_error = 2 * real_part / np.sqrt(1 - zeta**2) * mode.damping_ratio_se
    return size * float(real), size * float(np.hypot(imaginary_part * by_frequency, damping_error))
