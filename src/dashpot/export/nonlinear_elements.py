"""What stands beside the arms: sliders and a cubic spring, in the units of a deck."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from dashpot.base.errors import ExportError
from dashpot.export.unit_systems import UnitSystem, text
from dashpot.solids.friction import Jenkins
from dashpot.solids.nonlinear_springs import Cubic
from dashpot.solids.rate_independent import RateIndependent

CARRIERS = MappingProxyType(
    {
        "abaqus": ("arms",),
        "ansys": ("arms",),
        "calculix": ("arms",),
        "lsdyna": ("arms",),
        "opensees": ("python", "tcl"),
    }
)
"""The forms that hold springs whose force is not linear, of each target that has any."""

_REACH = 2.0
"""A cubic spring is drawn to so many times the largest amplitude that was measured."""
_POINTS = 80
_PRESSED = 0.01
"""m: as far as a seal is pressed, where no amplitude was tested."""
_APART = 1000
"""Nodes stand so many largest amplitudes apart: elements that follow their nodes never turn."""


@dataclass(frozen=True)
class NonlinearElements:
    """Sliders and a cubic spring beside a solid; none of either where it is linear.

    Attributes
    ----------
    units : UnitSystem
    parts : tuple of Jenkins or Cubic
        SI.
    amplitudes : (float, float)
        Range of displacement amplitudes that the tests cover, m.
    """

    units: UnitSystem
    parts: tuple[RateIndependent, ...] = ()
    amplitudes: tuple[float, float] = (0.0, 0.0)

    @property
    def sliders(self) -> tuple[tuple[float, float, float], ...]:
        """Each slider's stiffness, force at which it slips, and displacement there, deck units."""
        return tuple(
            (
                self.units.stiffness(part.k),
                part.slip / self.units.force,
                part.yields_at / self.units.length,
            )
            for part in self.parts
            if isinstance(part, Jenkins)
        )

    @property
    def k3(self) -> float:
        """Of the cubic springs, deck units."""
        whole = sum(part.k3 for part in self.parts if isinstance(part, Cubic))
        return whole * self.units.length**3 / self.units.force

    @property
    def span(self) -> float:
        """Distance of the two nodes, deck units: far, for near ones would pass each other."""
        most = (self.amplitudes[1] or _PRESSED) / self.units.length
        return float(10.0 ** np.ceil(np.log10(_APART * most)))

    @property
    def node_spacing_remarks(self) -> list[str]:
        """What the header says of the two nodes where elements follow them."""
        far = f"{text(self.span)} {self.units.words[0]}"
        return [
            f"keep the two nodes {far} apart: if they are near, a press turns the elements round"
        ]

    def curve(self, points: int = _POINTS, *, k: float = 0.0) -> list[tuple[float, float]]:
        r"""Displacement and force of the cubic spring, and of one of `k` with it, from 0 on.

        At :math:`x_i \propto (i/n)^{2/3}`, where straight lines are everywhere as far, in force,
        from the cubic.
        """
        ends = (np.arange(points + 1) / points) ** (2 / 3)
        x = _REACH * self.amplitudes[1] / self.units.length * ends
        return list(zip(x.tolist(), (k * x + self.k3 * x**3).tolist(), strict=True))

    def both_ways(self) -> list[tuple[float, float]]:
        """That curve from compression to tension."""
        half = self.curve()
        return [(-x, -F) for x, F in half[:0:-1]] + half

    @property
    def described(self) -> list[str]:
        """As the header of a deck says it."""
        if not self.amplitudes[1]:
            return []
        length, force = self.units.words[0], self.units.words[3]
        low, high = (amplitude / self.units.length for amplitude in self.amplitudes)
        lines = [
            f"  slider {i}: k = {text(k)} {self.units.stiffness_word}, slips at {text(F)} {force} "
            f"({text(x)} {length})"
            for i, (k, F, x) in enumerate(self.sliders, start=1)
        ]
        if self.k3:
            lines.append(
                f"  cubic spring: k3 = {text(self.k3)} {force}/{length}^3, by straight lines to "
                f"{text(_REACH * high)} {length} either way; beyond it is another one"
            )
        tested = f"displacement amplitudes tested: {low:.4g} to {high:.4g} {length}"
        return [*lines, f"{tested}; whatever moves less or farther is EXTRAPOLATED"]

    def refuse_unless_held(self, target: str, form: str) -> None:
        """Raise where the target's form holds neither friction nor a cubic spring.

        Raises
        ------
        ExportError
        """
        held = CARRIERS.get(target, ())
        if not self.parts or form in held:
            return
        many = len(self.sliders)
        name = f"{many} slider{'s' * (many != 1)}" if many else ""
        name += " and " * bool(many and self.k3) + "a cubic spring" * bool(self.k3)
        other = (
            f"take --form {held[0]} (Python: form='{held[0]}')"
            if held
            else f"those that hold such: --to {', '.join(CARRIERS)}"
        )
        raise ExportError(
            f"{target} decks of the form '{form}' are linear, and beside the arms this fit has "
            f"{name}, whose force is not; {other}"
        )
