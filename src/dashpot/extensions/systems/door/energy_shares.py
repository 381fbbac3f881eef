"""Shares of a mode's energy and loss by part of a system."""

from __future__ import annotations

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray
from dashpot.extensions.systems.multibody import System
from dashpot.extensions.systems.time_response import ComplexMode


@dataclass(frozen=True)
class EnergyShare:
    """Energy share of the springs of one name in one mode.

    Attributes
    ----------
    name : str
    energy : float
        Part of the energy that all springs store.
    loss : float
        Its contribution to the loss factor of the mode.
    """

    name: str
    energy: float
    loss: float


def energy_shares(system: System, mode: ComplexMode) -> tuple[EnergyShare, ...]:
    r"""Share of each part of a system, by the names of its springs, in a mode.

    .. math:: U_i = \tfrac12 K_i'(|s|)\,|e_i|^2, \qquad
        \eta = \sum_i \frac{K_i''(|s|)\,|e_i|^2}{\sum_j K_j'\,|e_j|^2}

    with the stretch e of each spring: :math:`\eta = \sum_i \eta_i U_i / U`, which is
    :math:`2\zeta` of a lightly damped mode.
    """
    e = system.stretch @ mode.shape
    K = system.spring_stiffness(1j * abs(mode.pole))
    change = np.abs(e) ** 2
    stored_energy, lost_energy = (
        _sum_by_name(system, K.real * change),
        _sum_by_name(system, K.imag * change),
    )
    total_energy = sum(stored_energy.values())
    return tuple(
        EnergyShare(name, stored_energy[name] / total_energy, lost_energy[name] / total_energy)
        for name in stored_energy
    )


def _sum_by_name(system: System, values: FloatArray) -> dict[str, float]:
    entries: dict[str, float] = {}
    for spring, value in zip(system.springs, values.tolist(), strict=True):
        entries[spring.name] = entries.get(spring.name, 0.0) + value
    return entries
