"""OptiStruct bulk data: the bushings of Nastran, and a material of relative moduli."""

from __future__ import annotations

from dashpot.base.errors import ExportError
from dashpot.base.units import Quantity, Range
from dashpot.datamodel.seal_line import Shear, Stations
from dashpot.export.deck import Deck, DeckText
from dashpot.export.deck_validation import target
from dashpot.export.decks import nastran as bushings
from dashpot.export.unit_systems import format_fixed_width

FORMS = (*bushings.FORMS, "prony")
SUFFIX = "fem"
_TABLES = FORMS[:2]
_MAX_TERMS = 5
"""Terms that the card has room for."""


@target(*FORMS, line=bushings.FORMS, frequency_range=_TABLES, tolerance=_TABLES, nominal=_TABLES)
def optistruct(
    deck: Deck,
    *,
    frequency_range: Range = (1.0, 100.0),
    tolerance: float = 1e-3,
    nominal: Quantity | None = None,
    line: Stations | None = None,
    shear: Shear | None = None,
    first_id: int = 1,
) -> DeckText:
    r"""Bulk data for OptiStruct: the bushings of Nastran, or a material card.

    ``"table"``, ``"viscous-table"`` and ``"arms"`` are those of :func:`dashpot.export.nastran`.
    ``"prony"`` writes MATVE with the relative moduli :math:`g_j = k_j/k_0` of the deviatoric part
    and their relaxation times, for nonlinear analyses; the fields of MATFVE, for frequency
    response, are the same.

    Parameters
    ----------
    solid, units, specimen, allow, frequency_range, tolerance, nominal, line, shear, first_id
        As in :func:`dashpot.export.nastran`; `first_id` is the number of the material, too.
    form : str

    Raises
    ------
    ExportError
        If the deck must not be written, or the card has no room for all arms.
    """
    if deck.form != "prony":
        text: DeckText = bushings.nastran.__wrapped__(  # type: ignore[attr-defined]
            deck,
            frequency_range=frequency_range,
            tolerance=tolerance,
            nominal=nominal,
            line=line,
            shear=shear,
            first_id=first_id,
        )
        return text
    terms = deck.prony
    is_material = deck.linear_fit is not None and deck.linear_fit.unit == "Pa"
    if len(terms) > _MAX_TERMS:
        other = "" if is_material else ", or use --form table"
        raise ExportError(
            f"MATVE holds {_MAX_TERMS} terms, and the model has {len(terms)} arms: fit "
            f"fewer (dashpot fit FILE --arms {_MAX_TERMS}){other}"
        )
    return deck.format_text(
        "$",
        "material of relative moduli for OptiStruct",
        _format_matve(first_id, terms),
        remarks=[
            "written by the public description of MATVE: compare one element with the model first",
            f"the elastic material of number {first_id} (MAT1, MATHE) holds the instantaneous",
            "moduli; the bulk part does not relax",
            "for frequency response name the card MATFVE: its fields are the same",
        ],
    )


def _format_matve(number: int, terms: list[tuple[float, float]]) -> list[str]:
    """Return the card in small fields: the first term beside the name, four in the next row."""
    words = [word for term in terms for word in (format_fixed_width(v, 8) for v in term)]
    rows = [["MATVE", str(number), "PRONY", *words[:2]]]
    if len(terms) > 1:
        rows.append(["+", *words[2:]])
    return ["".join(f"{word:<8}" for word in row).rstrip() for row in rows]
