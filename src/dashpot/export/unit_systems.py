"""Consistent unit systems of solvers."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType


@dataclass(frozen=True)
class UnitSystem:
    """A consistent unit system: the SI size of one unit of each base quantity.

    Attributes
    ----------
    name : str
        ``"SI"``, ``"mm-t-s"`` or ``"mm-kg-ms"``.
    length, mass, time : float
        Size of the unit in m, kg, s.
    words : tuple of str
        Names of the units of length, mass, time, force and stress.
    """

    name: str
    length: float
    mass: float
    time: float
    words: tuple[str, str, str, str, str]

    @property
    def force(self) -> float:
        """Size of the unit of force, N."""
        return self.mass * self.length / self.time**2

    def stiffness(self, si: float) -> float:
        """N/m in this system."""
        return si * self.length / self.force

    def damping(self, si: float) -> float:
        """N s/m in this system."""
        return si * self.length / (self.force * self.time)

    def stress(self, si: float) -> float:
        """Pa in this system."""
        return si * self.length**2 / self.force

    def density(self, si: float) -> float:
        """kg/m^3 in this system."""
        return si * self.length**3 / self.mass

    def frequency(self, si: float) -> float:
        """Hz in cycles per unit of time: solvers count frequency in their own unit of time."""
        return si * self.time

    @property
    def frequency_word(self) -> str:
        """Name of the unit of frequency."""
        return "Hz" if self.time == 1 else "kHz"

    @property
    def stiffness_word(self) -> str:
        """Name of the unit of stiffness."""
        return f"{self.words[3]}/{self.words[0]}"

    @property
    def damping_word(self) -> str:
        """Name of the unit of damping."""
        return f"{self.words[3]} {self.words[2]}/{self.words[0]}"


UNIT_SYSTEMS = MappingProxyType(
    {
        "SI": UnitSystem("SI", 1.0, 1.0, 1.0, ("m", "kg", "s", "N", "Pa")),
        "mm-t-s": UnitSystem("mm-t-s", 1e-3, 1e3, 1.0, ("mm", "t", "s", "N", "MPa")),
        "mm-kg-ms": UnitSystem("mm-kg-ms", 1e-3, 1.0, 1e-3, ("mm", "kg", "ms", "kN", "GPa")),
    }
)
"""The unit systems a deck can be written in."""
