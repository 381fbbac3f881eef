"""Abaqus and CalculiX materials with ``*VISCOELASTIC, TIME=PRONY``."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from dashpot.base import dataclass
from dashpot.base.errors import ReadError
from dashpot.extensions.solver_inputs.cards.card import (
    ViscoelasticCard,
    convert_shear_to_young,
    parse_number,
)
from dashpot.extensions.solver_inputs.cards.spring_network import Element, convert_network
from dashpot.solids.shift_laws import WLF, Arrhenius, TemperatureLaw

_IN_KELVIN = 150.0
"""A reference temperature above it is taken as K; rubber is tested nowhere near 150 degC."""


@dataclass(frozen=True)
class Keyword:
    """One keyword with its parameters, and its rows of numbers as text."""

    name: str
    parameters: dict[str, str]
    rows: list[list[str]]


def parse_keywords(text: str) -> Iterator[Keyword]:
    """Yield the keywords of an Abaqus input; a keyword line that ends with a comma goes on."""
    current: Keyword | None = None
    pending_text = ""
    for raw in text.splitlines():
        line = pending_text + raw.strip()
        pending_text = ""
        if line.startswith("**") or not line:
            continue
        if line.startswith("*"):
            if line.endswith(","):
                pending_text = line
                continue
            if current is not None:
                yield current
            name, *words = [word.strip() for word in line[1:].split(",")]
            pairs = [word.partition("=") for word in words if word]
            current = Keyword(
                _squeeze(name), {_squeeze(key): value.strip() for key, _, value in pairs}, []
            )
        elif current is not None:
            current.rows.append([word.strip() for word in line.rstrip(",").split(",")])
    if current is not None:
        yield current


def _squeeze(word: str) -> str:
    """Return a word of Abaqus as it compares it: without blanks and case."""
    return "".join(word.upper().split())


def read_abaqus_cards(text: str) -> tuple[ViscoelasticCard, ...]:
    """Return the viscoelastic materials of an Abaqus or CalculiX input.

    Raises
    ------
    ReadError
        If a viscoelasticity is of a form that has no Prony series.
    """
    materials: list[tuple[str, list[Keyword]]] = []
    zero: float | None = None
    keywords_of_file = list(parse_keywords(text))
    for keyword in keywords_of_file:
        if keyword.name == "PHYSICALCONSTANTS" and "ABSOLUTEZERO" in keyword.parameters:
            zero = parse_number(keyword.parameters["ABSOLUTEZERO"], "*PHYSICAL CONSTANTS")
        if keyword.name == "MATERIAL":
            materials.append((keyword.parameters.get("NAME", "material"), []))
        elif materials:
            materials[-1][1].append(keyword)
        elif keyword.name == "VISCOELASTIC":  # a fragment without its *MATERIAL
            materials.append(("material", [keyword]))
    cards = [
        _read_material(name, keywords, zero)
        for name, keywords in materials
        if any(keyword.name == "VISCOELASTIC" for keyword in keywords)
    ]
    # springs beside a material are of the structure that it is in
    return tuple(cards or _read_network(keywords_of_file))


def _read_network(keywords: Sequence[Keyword]) -> Iterator[ViscoelasticCard]:
    """Yield the model of SPRINGA and DASHPOTA elements between the two lowest node numbers."""
    values = {
        (keyword.name, keyword.parameters.get("ELSET", "").upper()): keyword
        for keyword in keywords
        if keyword.name in ("SPRING", "DASHPOT")
    }
    elements: dict[str, list[Element]] = {"SPRINGA": [], "DASHPOTA": []}
    for keyword in keywords:
        kind = keyword.parameters.get("TYPE", "").upper()
        if keyword.name != "ELEMENT" or kind not in elements:
            continue
        elset = keyword.parameters.get("ELSET", "")
        stated = values.get((kind[:-1], elset.upper()))
        if stated is None:
            raise ReadError(f"*ELEMENT, TYPE={kind}, ELSET={elset}: its *{kind[:-1]} is missing")
        if "NONLINEAR" in stated.parameters or len(stated.rows) != 1 or len(stated.rows[0]) != 1:
            raise ReadError(
                f"*{kind[:-1]}, ELSET={elset} has a table; expected one number: a linear element"
            )
        value = parse_number(stated.rows[0][0], f"*{kind[:-1]}, ELSET={elset}")
        for _, *nodes in keyword.rows:
            first, second = (
                f"{parse_number(node, f'*ELEMENT, ELSET={elset}'):.0f}" for node in nodes
            )
            elements[kind].append(Element((first, second), value))
    springs, dashpots = elements.values()
    if not springs or not dashpots:
        return
    nodes = sorted({point for points, _ in (*springs, *dashpots) for point in points}, key=int)
    keyword_text = "SPRINGA and DASHPOTA"
    note = f"the model is taken to act between the nodes {nodes[0]} and {nodes[1]}"
    yield ViscoelasticCard(
        "arms",
        keyword_text,
        spring=convert_network(springs, dashpots, nodes[:2], keyword_text),
        notes=(note,),
    )


def _read_material(name: str, keywords: Sequence[Keyword], zero: float | None) -> ViscoelasticCard:
    keyword_by_name = {keyword.name: keyword for keyword in reversed(keywords)}
    visco = keyword_by_name["VISCOELASTIC"]
    time = _squeeze(visco.parameters.get("TIME", ""))
    if time != "PRONY":
        form = ", ".join(f"{key}={value}" for key, value in visco.parameters.items())
        raise ReadError(
            f"*VISCOELASTIC, {form} of {name} is not read; expected TIME=PRONY, whose rows are "
            "shear ratio, bulk ratio and time"
        )
    kind = _squeeze(visco.parameters.get("TYPE", "ISOTROPIC"))
    if kind not in {"", "ISOTROPIC"}:
        raise ReadError(f"*VISCOELASTIC, TYPE={kind} of {name} is not read; expected ISOTROPIC")
    relative, bulk = [], []
    for row in visco.rows:
        g, k, tau = (
            parse_number(word or "0", f"*VISCOELASTIC of {name}") for word in (*row, "", "")[:3]
        )
        if not tau > 0:
            raise ReadError(
                f"*VISCOELASTIC of {name}: the row {', '.join(row)} has no relaxation time > 0"
            )
        relative += [(g, tau)] * (g != 0)
        bulk += [(k, tau)] * (k != 0)
    modulus, poisson, long_term, notes = _read_elasticity(name, keyword_by_name)
    law, shift_notes = _read_shift(name, keyword_by_name.get("TRS"), zero)
    card = ViscoelasticCard(
        name,
        "*VISCOELASTIC, TIME=PRONY",
        tuple(relative),
        tuple(bulk),
        modulus,
        poisson,
        long_term,
        law=law,
        notes=(*notes, *shift_notes),
    )
    return card.add_notes(*card.format_poisson_note())


def _read_elasticity(
    name: str, keywords: dict[str, Keyword]
) -> tuple[float | None, float, bool, list[str]]:
    """Return Young's modulus, Poisson's ratio, whether it is the relaxed one, and notes."""
    for word in ("ELASTIC", "HYPERELASTIC", "HYPERFOAM"):
        keyword = keywords.get(word)
        if keyword is None:
            continue
        keyword_text = f"*{word} of {name}"
        long_term = _squeeze(keyword.parameters.get("MODULI", "LONGTERM")) != "INSTANTANEOUS"
        if not keyword.rows or "TESTDATAINPUT" in keyword.parameters:
            notes = [f"{keyword_text} has test data, of which no modulus is made: give --modulus"]
            return None, convert_shear_to_young(1.0, 0.0)[1], False, notes
        row = [parse_number(value or "0", keyword_text) for value in keyword.rows[0]]
        notes = [f"{keyword_text}: its first row alone is read"] * (len(keyword.rows) > 1)
        if word == "ELASTIC":
            kind = _squeeze(keyword.parameters.get("TYPE", "ISOTROPIC"))
            if kind not in {"", "ISOTROPIC", "ISO"}:
                return (
                    None,
                    0.4995,
                    False,
                    [f"{keyword_text}, TYPE={kind}, is not read: give --modulus"],
                )
            return row[0], (row[1] if len(row) > 1 else 0.0), long_term, notes
        shear = _read_shear_modulus(word, keyword, row)
        if shear is None:
            form = ", ".join(keyword.parameters)
            return None, 0.4995, False, [f"{keyword_text}, {form}, is not read: give --modulus"]
        E, poisson = convert_shear_to_young(*shear)
        return E, poisson, long_term, notes
    return None, 0.4995, False, []


def _read_shear_modulus(
    word: str, keyword: Keyword, row: list[float]
) -> tuple[float, float] | None:
    """Return shear and bulk modulus of an elastic law at no strain; bulk 0 for rubber."""
    names = set(keyword.parameters)
    count = int(keyword.parameters.get("N", "1") or 1)
    bulk = 0.0
    if word == "HYPERFOAM":
        values = [value for line in keyword.rows for value in line]
        numbers = [parse_number(value or "0", "*HYPERFOAM") for value in values]
        G = sum(numbers[0 : 2 * count : 2])
        poisson = numbers[2 * count] if len(numbers) > 2 * count else 0.0
        return G, (2 * G * (1 + poisson) / (3 * (1 - 2 * poisson)) if poisson < 0.5 else 0.0)
    if names & {"NEOHOOKE", "NEOHOOKEAN"}:
        G, at = 2 * row[0], 1
    elif names & {"MOONEY-RIVLIN", "MOONEYRIVLIN"} or ("POLYNOMIAL" in names and count == 1):
        G, at = 2 * (row[0] + row[1]), 2
    elif "YEOH" in names:
        G, at = 2 * row[0], 3
    elif "REDUCEDPOLYNOMIAL" in names:
        G, at = 2 * row[0], count
    elif "OGDEN" in names:
        G, at = sum(row[0 : 2 * count : 2]), 2 * count
    else:
        return None
    if len(row) > at and row[at] > 0:
        bulk = 2 / row[at]
    return G, bulk


def _read_shift(
    name: str, keyword: Keyword | None, zero: float | None
) -> tuple[TemperatureLaw | None, list[str]]:
    if keyword is None:
        return None, []
    definition = _squeeze(keyword.parameters.get("DEFINITION", "WLF"))
    if definition not in {"WLF", "ARRHENIUS"} or not keyword.rows:
        return None, [f"*TRS, DEFINITION={definition} of {name} is not read"]
    row = [parse_number(value or "0", f"*TRS of {name}") for value in keyword.rows[0]]
    reference, notes = row[0], []
    if zero is not None:
        reference -= zero
    elif reference < _IN_KELVIN:
        note = (
            f"*TRS of {name} is not read: its reference {row[0]:g} is in an unknown unit; add "
            "*PHYSICAL CONSTANTS, ABSOLUTE ZERO=-273.15"
        )
        return None, [note]
    else:
        notes = [f"*TRS of {name}: its temperatures are taken as K"]
    law: TemperatureLaw
    if definition == "WLF":
        law = WLF(row[1], row[2], reference)
    else:
        law = Arrhenius(row[1], reference)
        notes.append(f"*TRS of {name}: its energy is taken as J/mol")
    if not math.isfinite(reference) or reference <= 0:
        return None, [f"*TRS of {name} has the reference {reference:g} K; it is not read"]
    return law, notes
