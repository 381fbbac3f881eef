"""Radioss starter input."""

from __future__ import annotations

from dashpot.base.units import Quantity, convert_to_si
from dashpot.export.deck import Deck, DeckText
from dashpot.export.deck_validation import target
from dashpot.export.unit_systems import text

FORMS = ("prony",)
SUFFIX = "rad"
NEEDS = {"prony": ("modulus",)}


@target(*FORMS)
def radioss(
    deck: Deck,
    *,
    modulus: Quantity | None = None,
) -> DeckText:
    r"""Radioss ``/VISC/PRONY`` card: G_j = G_0 k_j/k_0 and beta_j = 1/tau_j.

    Parameters
    ----------
    solid, units, specimen, allow
        As in :func:`dashpot.export.nastran`.
    form : str
        ``"prony"``.
    modulus : float
        Instantaneous shear modulus G_0 of the rubber, Pa: a part's stiffness does not give it.
    """
    modulus = convert_to_si(modulus, "stress")
    long_term, terms = deck.shear(modulus, "Radioss")
    return deck.format_text(
        "#",
        "viscosity card for Radioss",
        [
            "/VISC/PRONY/1",
            "#        M",
            f"{len(terms):>10}",
            "#                G_i              beta_i",
            *(f"{text(G):>20}{text(beta):>20}" for G, beta in terms),
        ],
        remarks=[
            "the card adds to the material law of the same number, whose own shear modulus is the",
            f"long-term one, {text(long_term)} {deck.units.words[4]}",
        ],
    )
