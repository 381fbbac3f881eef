"""Tables for COMSOL Multiphysics."""

from __future__ import annotations

import numpy as np

from dashpot.base.units import Quantity, Range, convert_to_si, si_range
from dashpot.export.deck import Deck, DeckText
from dashpot.export.deck_validation import target
from dashpot.export.unit_systems import text

FORMS = ("table", "prony")
SUFFIX = "txt"
NEEDS = {"prony": ("modulus",)}


@target(*FORMS, frequency_range=("table",), tolerance=("table",), modulus=("prony",))
def comsol(
    deck: Deck,
    *,
    frequency_range: Range = (1.0, 100.0),
    tolerance: float = 1e-3,
    modulus: Quantity | None = None,
) -> DeckText:
    r"""Text tables that COMSOL loads: an interpolation function, or branches of a Maxwell model.

    ``"table"`` has a row for each frequency with K' and K'' in the next columns, for an
    interpolation function of two values: a spring foundation or thin layer of stiffness K' + i K''
    in the frequency domain. ``"prony"`` has a row for each branch of a generalized Maxwell model
    of a viscoelastic material: :math:`G_j = G_0 k_j/k_0` and :math:`\tau_j`.

    Parameters
    ----------
    solid, units, specimen, allow, frequency_range, tolerance
        As in :func:`dashpot.export.nastran`.
    form : str
    modulus : float
        Instantaneous shear modulus G_0 of the rubber, Pa, for ``"prony"`` alone: a part's stiffness
        does not give it.
    """
    if deck.form == "prony":
        return _write_prony(deck, convert_to_si(modulus, "stress"))
    return _write_table(deck, si_range(frequency_range, "frequency"), tolerance)


def _write_table(deck: Deck, frequency_range: tuple[float, float], tolerance: float) -> DeckText:
    units, table = deck.units, deck.table(frequency_range, tolerance)
    rows = np.column_stack(
        (
            units.frequency(table.frequency),
            units.stiffness(table.storage),
            units.stiffness(table.storage * table.damping),
        )
    )
    return deck.format_text(
        "%",
        "interpolation function for COMSOL",
        [" ".join(map(text, row)) for row in rows.tolist()],
        remarks=[
            f"columns: frequency [{units.frequency_word}], K' and K'' [{units.stiffness_word}]",
            "load it as an interpolation function from a spreadsheet file, with one argument and",
            "two functions, linear; the argument is freq",
        ],
        table=table,
    )


def _write_prony(deck: Deck, modulus: float | None) -> DeckText:
    long_term, terms = deck.shear(modulus, "COMSOL")
    words = deck.units.words
    return deck.format_text(
        "%",
        "branches of a generalized Maxwell model for COMSOL",
        [f"{text(G)} {text(1 / beta)}" for G, beta in terms],
        remarks=[
            f"columns: G_j [{words[4]}], tau_j [{words[2]}]",
            "load it into the table of branches of a viscoelastic material",
            f"the linear elastic material holds the long-term shear modulus, {text(long_term)}",
            f"{words[4]}: the branches add to it",
        ],
    )
