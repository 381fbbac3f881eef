"""Viscoelastic card of a solver with its numbers, and the equivalent model."""

from __future__ import annotations

import re

import numpy as np

from dashpot.base import dataclass, field, replace
from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.errors import ReadError
from dashpot.export.unit_systems import UnitSystem
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.part_geometry import RUBBER_POISSON_RATIO
from dashpot.solids.shift_laws import TemperatureLaw

_CONSTANT = 1e-6
"""Relative moduli of shear and bulk that differ by less are the same."""


@dataclass(frozen=True)
class FrequencyTable:
    """Stiffness of a bushing over frequency, SI: Hz and complex N/m, shape (n,)."""

    frequency: FloatArray
    stiffness: ComplexArray


@dataclass(frozen=True)
class ViscoelasticCard:
    """Viscoelastic card; moduli, stiffnesses and times in units of its file.

    Attributes
    ----------
    name : str
        Name of the material, or the number of the property.
    keyword : str
        Name of the card of the relaxation.
    relative : tuple of (float, float)
        Relative moduli of shear g_j and times tau_j, of the instantaneous modulus.
    bulk : tuple of (float, float)
        The same of the bulk modulus; empty if it does not relax.
    modulus : float or None
        Young's modulus; None if the card has none.
    poisson : float
    is_long_term : bool
        Whether `modulus` is the relaxed one, not the instantaneous one.
    spring : GeneralizedMaxwell or None
        Stiffnesses of a part; a card has either this, relative moduli or a table.
    table : FrequencyTable or None
        SI.
    law : TemperatureLaw or None
        Law of the relaxation times.
    notes : tuple of str
        Unread parts of the card, and assumptions.
    """

    name: str
    keyword: str
    relative: tuple[tuple[float, float], ...] = ()
    bulk: tuple[tuple[float, float], ...] = ()
    modulus: float | None = None
    poisson: float = RUBBER_POISSON_RATIO
    is_long_term: bool = False
    spring: GeneralizedMaxwell | None = None
    table: FrequencyTable | None = field(default=None, compare=False)
    law: TemperatureLaw | None = None
    notes: tuple[str, ...] = ()

    @property
    def is_material(self) -> bool:
        """Whether its model is a material's modulus, not a part's stiffness."""
        return self.spring is None and self.table is None

    def convert_to_model(self, units: UnitSystem, modulus: float | None) -> GeneralizedMaxwell:
        """Return the model in SI; for a material, of Young's modulus.

        Parameters
        ----------
        units : UnitSystem
        modulus : float or None
            Instantaneous Young's modulus, Pa, where the card has none.

        Raises
        ------
        ReadError
            If there is no modulus, or the relative moduli sum to more than 1.
        """
        if self.spring is not None:
            spring, stiffness = self.spring, units.stiffness(1.0)
            return GeneralizedMaxwell(
                spring.k_inf / stiffness,
                tuple(k / stiffness for k in spring.k),
                tuple(tau * units.time for tau in spring.tau),
                spring.b / units.damping(1.0),
            )
        g = [share for share, _ in self.relative]
        remaining_share = 1 - sum(g)
        if remaining_share < -1e-9 or min(g, default=0.0) < 0:
            raise ReadError(
                f"{self.keyword} of {self.name}: relative moduli from {min(g):g} that sum to "
                f"{sum(g):g}; expected none below 0 and a sum of at most 1"
            )
        E_0 = modulus
        if self.modulus is not None:
            E_0 = self.modulus / units.stress(1.0)
            if self.is_long_term:
                if remaining_share <= 0:
                    raise ReadError(
                        f"{self.keyword} of {self.name}: nothing is left of the instantaneous "
                        "modulus, and the card has the relaxed one; its MODULI are INSTANTANEOUS"
                    )
                E_0 /= remaining_share
        if E_0 is None:
            raise ReadError(
                f"{self.keyword} of {self.name} has relative moduli alone: give the instantaneous "
                "Young's modulus of the material, such as --modulus 3MPa"
            )
        order = sorted(self.relative, key=lambda term: term[1])
        return GeneralizedMaxwell(
            max(remaining_share, 0.0) * E_0,
            tuple(share * E_0 for share, _ in order),
            tuple(tau * units.time for _, tau in order),
        )

    def format_poisson_note(self) -> tuple[str, ...]:
        """Return by how much Young's modulus is off, for Poisson's ratio is taken as constant."""
        if not self.is_material or not self.relative:
            return ()
        g, k = (sum(share for share, _ in terms) for terms in (self.relative, self.bulk))
        is_same_series = len(self.relative) == len(self.bulk) and np.allclose(
            np.array(self.relative), np.array(self.bulk), rtol=_CONSTANT
        )
        if is_same_series or not self.poisson < 0.5:
            return ()
        # with K and G in units of E_0
        G = (1 - g) / (2 * (1 + self.poisson))
        K = (1 - k) / (3 * (1 - 2 * self.poisson))
        exact = 9 * K * G / (3 * K + G) if K > 0 else 0.0
        difference = exact - (1 - g)
        if abs(difference) < 1e-3:
            return ()
        note = (
            "shear and bulk relax differently: the relaxed Young's modulus is "
            f"{100 * difference:+.2g} % of the instantaneous one off, for Poisson's ratio is taken "
            f"as {self.poisson:g} throughout"
        )
        return (note,)

    def add_notes(self, *notes: str) -> ViscoelasticCard:
        """Return the card with further notes."""
        return replace(self, notes=(*self.notes, *notes))


def parse_number(text: str, location: str) -> float:
    """Return a number as Fortran writes it: ``1.5+3``, ``1.D0``, ``-.2E-4``.

    Raises
    ------
    ReadError
        If it is not a number, such as the name of a parameter.

    >>> parse_number("1.5-3", "card"), parse_number("2.D1", "card")
    (0.0015, 20.0)
    """
    word = text.strip().upper().replace("D", "E")
    word = re.sub(r"(?<=[\d.])([+-])(?=\d+$)", r"E\1", word)
    try:
        return float(word)
    except ValueError:
        raise ReadError(
            f"{location}: '{text.strip()}' is no number; write numbers in place of parameters"
        ) from None


def convert_shear_to_young(G: float, K: float) -> tuple[float, float]:
    """Return Young's modulus and Poisson's ratio of a shear and a bulk modulus; K = 0: rubber."""
    if K <= 0:
        return 2 * (1 + RUBBER_POISSON_RATIO) * G, RUBBER_POISSON_RATIO
    return 9 * K * G / (3 * K + G), (3 * K - 2 * G) / (2 * (3 * K + G))
