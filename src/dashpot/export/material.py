"""Absolute shear moduli for solvers whose Prony cards are not relative."""

from __future__ import annotations

from dashpot.base.errors import ExportError
from dashpot.export.deck import Deck


def shear_modulus(modulus: float | None, target: str) -> float:
    """Return the instantaneous shear modulus G_0, Pa, if it was given.

    Raises
    ------
    ExportError
        If it is missing: a part's stiffness does not tell its material's modulus.
    """
    if modulus is None or not modulus > 0:
        raise ExportError(
            f"a {target} material needs the instantaneous shear modulus of the rubber, which the "
            f"stiffness of a part does not tell (found modulus = {modulus!r}); give modulus= in Pa"
        )
    return modulus


def shear_terms(deck: Deck, modulus: float) -> list[tuple[float, float]]:
    r"""G_j = G_0 k_j / k_0 and decay rate beta_j = 1/tau_j of each arm, deck units."""
    G_0 = deck.units.stress(modulus)
    return [
        (g * G_0, 1 / tau) for g, (_, tau, _) in zip(deck.relative_moduli, deck.arms, strict=True)
    ]


def long_term(deck: Deck, modulus: float) -> float:
    """Equilibrium shear modulus G_inf, deck units."""
    return deck.units.stress(modulus) * deck.model.k_inf / deck.model.k_0
