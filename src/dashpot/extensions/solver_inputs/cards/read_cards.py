"""Viscoelastic cards of a file, for any solver."""

from __future__ import annotations

import re
from collections.abc import Sequence

from dashpot.base.errors import ExportError, ReadError
from dashpot.base.units import dimensions, parse_quantity
from dashpot.export.unit_systems import UNIT_SYSTEMS, UnitSystem, unit_system
from dashpot.extensions.solver_inputs.cards.abaqus_cards import read_abaqus_cards
from dashpot.extensions.solver_inputs.cards.ansys_cards import read_ansys_cards
from dashpot.extensions.solver_inputs.cards.card import ViscoelasticCard
from dashpot.extensions.solver_inputs.cards.lsdyna_cards import read_lsdyna_cards
from dashpot.extensions.solver_inputs.cards.nastran_cards import read_nastran_cards

_DIALECTS = {
    "lsdyna": r"(?m)^\*(MAT_|KEYWORD|PART|ELEMENT_|SECTION_)",
    "abaqus": r"(?mi)^\s*\*\s*(VISCO\s*ELASTIC|MATERIAL\b|HEADING|ELEMENT\s*,)",
    "ansys": r"(?mi)^\s*(TB\s*,|MP(DATA)?\s*,)",
    "nastran": r"(?mi)^(PBUSHT?|MATF?VE|CBUSH|MAT1|CELAS2|CDAMP2)\b",
    "radioss": r"(?mi)^/(VISC|MAT)/",
}
"""Pattern of a line in a file of each solver."""
READ = (
    "*VISCOELASTIC, TIME=PRONY and *TRS, SPRINGA and DASHPOTA (Abaqus, CalculiX), PBUSH, PBUSHT, "
    "MATVE, CELAS2 and CDAMP2 (Nastran, OptiStruct), TB,PRONY (Ansys), *MAT_GENERAL_VISCOELASTIC, "
    "*MAT_VISCOELASTIC and *MAT_SPRING_MAXWELL (LS-DYNA)"
)


def read_stated_units(text: str, name: str, units: str | None) -> UnitSystem:
    """Return the unit system of a file: the given one, or the one written by dashpot.

    Raises
    ------
    ExportError
        If there is neither, or they contradict each other.
    """
    stated = re.search(rf"(?m)^\W*UNITS: ({'|'.join(map(re.escape, UNIT_SYSTEMS))}):", text)
    if units is None and stated is None:
        raise ExportError(
            f"a card names no units; add --unit-system, one of {', '.join(UNIT_SYSTEMS)}"
        )
    if units is None and stated is not None:
        return unit_system(stated[1])
    system = unit_system(units)
    if stated is not None and stated[1] != system.name:
        raise ExportError(
            f"{name} says UNITS: {stated[1]}, and --unit-system {system.name} contradicts it. "
            "Leave it out, or take the line out of the file"
        )
    return system


def read_stated_modulus(text: str) -> float | None:
    """Return the instantaneous modulus, Pa, that dashpot wrote into the comments of a material.

    None without such comments, of a part, and of a file that joins several decks.
    """
    if len(re.findall(r"(?m)^\W*model: k_inf = ", text)) != 1:
        return None
    moduli = re.findall(r"(?m)^\W*(?:model: k_inf|arm \d+: k) = ([^\s,]+) ([^\s,]+)", text)
    if not all("stress" in dimensions(unit) for _, unit in moduli):
        return None
    return sum(parse_quantity(f"{number}{unit}", "stress") for number, unit in moduli)


def read_cards(
    text: str, name: str, units: UnitSystem, component: int | None
) -> tuple[ViscoelasticCard, ...]:
    """Return every viscoelastic card of a solver input.

    Parameters
    ----------
    text : str
    name : str
        Name of the file, for messages.
    units : UnitSystem
    component : int, optional
        For bushes.

    Raises
    ------
    ReadError
        If there is none, or one is of a form that is not read.
    """
    dialect = next(
        (word for word, signature in _DIALECTS.items() if re.search(signature, text)), ""
    )
    if dialect == "radioss":
        raise ReadError(
            f"{name}: /VISC/PRONY of Radioss is not read; it has no long-term modulus. These are: "
            f"{READ}"
        )
    cards: Sequence[ViscoelasticCard]
    if dialect == "abaqus":
        cards = read_abaqus_cards(text)
    elif dialect == "ansys":
        cards = read_ansys_cards(text)
    elif dialect == "lsdyna":
        cards = read_lsdyna_cards(text)
    elif dialect == "nastran":
        cards = read_nastran_cards(text, units, component)
    else:
        cards = ()
    if not cards:
        raise ReadError(f"{name} has no viscoelastic card that is read. These are: {READ}")
    return tuple(cards)


def select_card(
    cards: Sequence[ViscoelasticCard], requested_name: str | None, name: str
) -> ViscoelasticCard:
    """Return the card of a name, or the only one.

    Raises
    ------
    ReadError
        If there are several and none is named, or no card has the name.
    """
    matching_cards = [
        card for card in cards if requested_name is None or requested_name.lower() in
        {card.name.lower(), card.name.lower().rpartition(" ")[2]}
    ]  # fmt: skip
    if len(matching_cards) == 1:
        return matching_cards[0]
    cards_text = ", ".join(f"'{card.name}' ({card.keyword})" for card in cards)
    if not matching_cards:
        raise ReadError(f"{name} has no card '{requested_name}'; it has {cards_text}")
    raise ReadError(
        f"{name} has {len(cards)} cards: {cards_text}. Name one, such as --card {cards[0].name!r}"
    )
