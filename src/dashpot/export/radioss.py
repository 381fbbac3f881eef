"""Radioss starter input."""

from __future__ import annotations

from collections.abc import Collection

from dashpot.export.material import long_term, shear_modulus, shear_terms
from dashpot.export.number_fields import text
from dashpot.export.open_deck import Solid, choose_form, open_deck
from dashpot.records.specimen import Specimen

FORMS = ("prony",)


def radioss(
    solid: Solid,
    *,
    units: str | None = None,
    specimen: Specimen | None = None,
    allow: Collection[str] = (),
    form: str = "prony",
    modulus: float | None = None,
) -> str:
    r"""Radioss ``/VISC/PRONY`` card: G_j = G_0 k_j/k_0 and beta_j = 1/tau_j.

    Parameters
    ----------
    solid, units, specimen, allow
        As in :func:`dashpot.export.nastran.nastran`.
    form : str
        ``"prony"``.
    modulus : float
        Instantaneous shear modulus G_0 of the rubber, Pa: a part's stiffness does not tell it.
    """
    choose_form(form, FORMS, "radioss")
    deck = open_deck(solid, units=units, specimen=specimen, allow=allow, prony=True)
    G_0 = shear_modulus(modulus, "Radioss")
    terms = shear_terms(deck, G_0)
    header = deck.header(
        "#",
        "viscosity card for Radioss",
        remarks=[
            "the card adds to the material law of the same number, whose own shear modulus is the",
            f"long-term one, {text(long_term(deck, G_0))} {deck.units.words[4]}",
        ],
    )
    return "\n".join(
        [
            *header,
            "/VISC/PRONY/1",
            "#        M",
            f"{len(terms):>10}",
            "#                G_i              beta_i",
            *(f"{text(G):>20}{text(beta):>20}" for G, beta in terms),
            "",
        ]
    )
