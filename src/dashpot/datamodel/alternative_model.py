"""Families of solids, and what another one than the fit's own makes of the same data."""

from __future__ import annotations

from dataclasses import dataclass

from dashpot.base.choices import Family
from dashpot.base.serialisation import Serialisable
from dashpot.solids.fractional import FractionalZener
from dashpot.solids.maxwell import Solid


def family_of(solid: Solid) -> Family:
    """Return the family of a solid: fractional, or of springs and dashpots."""
    return "fractional" if isinstance(solid, FractionalZener) else "maxwell"


@dataclass(frozen=True)
class Alternative(Serialisable):
    """The best solid of another family, fitted to the same data.

    Attributes
    ----------
    solid : Solid
    bic : float
        Its Bayesian criterion less that of the fit's own solid.
    explains : bool
        Chance may leave as much as is between the residuals of the two.
    parts_at : float or None
        From which frequency on the two differ by more than data of this kind are worth, Hz;
        None if nowhere that a part vibrates.
    says : str
        What the two predict there, and what would tell them apart.
    """

    keys = ("family", "*")

    solid: Solid
    bic: float
    explains: bool
    parts_at: float | None
    says: str

    @property
    def family(self) -> Family:
        """Of its solid."""
        return family_of(self.solid)
