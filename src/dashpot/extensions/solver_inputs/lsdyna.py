"""LS-DYNA keyword input."""

from __future__ import annotations

import itertools
from typing import TypeAlias

from dashpot.base.errors import ExportError
from dashpot.base.units import Quantity, convert_to_si
from dashpot.datamodel.seal_line import Shear, Stations
from dashpot.export.deck import Deck, DeckText
from dashpot.export.deck_validation import target
from dashpot.export.seal_line_springs import SpringRow, make_springs
from dashpot.export.unit_systems import format_fields, format_fixed_width

FORMS = ("arms", "prony")
SUFFIX = "k"
NEEDS = {"prony": ("modulus", "bulk_modulus", "density")}
VERIFICATION_NOTE = (
    "not solver-verified: no LS-DYNA runs in dashpot's tests. They read the cards back, field by "
    "field, as the manual lays them out"
)
_MAX_TERMS = 18  # of *MAT_GENERAL_VISCOELASTIC


@target(*FORMS, line=("arms",))
def lsdyna(
    deck: Deck,
    *,
    modulus: Quantity | None = None,
    bulk_modulus: Quantity | None = None,
    density: float | None = None,
    line: Stations | None = None,
    shear: Shear | None = None,
    first_id: int = 1,
) -> DeckText:
    r"""LS-DYNA keywords of a solid.

    ``"arms"`` writes discrete elements in parallel between two nodes: one ``*MAT_SPRING_ELASTIC``,
    and for each arm one ``*MAT_SPRING_MAXWELL``, whose stiffness decays from k_j to 0 at
    beta_j = 1/tau_j: the exact network without inner nodes. Sliders are
    ``*MAT_SPRING_ELASTOPLASTIC`` without hardening, a cubic spring is
    ``*MAT_SPRING_NONLINEAR_ELASTIC``. ``"prony"`` writes
    ``*MAT_GENERAL_VISCOELASTIC`` (076) with absolute shear moduli.

    Parameters
    ----------
    solid, units, specimen, allow
        As in :func:`dashpot.export.nastran`.
    form : str
    modulus, bulk_modulus : float, optional
        Instantaneous shear modulus and elastic bulk modulus of the rubber, Pa; only and always
        for ``"prony"``.
    density : float, optional
        kg/m^3; only and always for ``"prony"``.
    line, shear, first_id
        As in :func:`dashpot.export.nastran`: at each station the elements stand between two
        coincident nodes, and act along vectors of their own.
    """
    modulus, bulk_modulus = convert_to_si(modulus, "stress"), convert_to_si(bulk_modulus, "stress")
    if deck.form == "prony":
        return _write_prony(deck, modulus, bulk_modulus, density)
    if (modulus, bulk_modulus, density) != (None, None, None):
        raise ExportError(
            "modulus, bulk_modulus and density belong to the material card; add --form prony "
            "(Python: form='prony'), or leave them out"
        )
    return (
        _write_arms(deck)
        if line is None
        else _write_line(deck, make_springs(deck, line, shear), first_id)
    )


_Material: TypeAlias = tuple[str, list[float | int]]


def _write_materials(deck: Deck) -> list[_Material]:
    """Return a material for the spring, the dashpot and each arm."""
    materials: list[_Material] = []
    if deck.k_inf > 0:
        materials.append(("*MAT_SPRING_ELASTIC", [deck.k_inf]))
    if deck.b > 0:
        materials.append(("*MAT_DAMPER_VISCOUS", [deck.b]))
    for k, tau, _ in deck.arms:
        # k0, ki, beta, cut-off time and force, incremental in time
        materials.append(("*MAT_SPRING_MAXWELL", [k, 0.0, 1 / tau, 1e20, 0.0, 0.0]))
    return materials


def _format_section(number: int) -> list[str]:
    return [
        "*SECTION_DISCRETE",
        "$#   secid       dro        kd        v0        cl        fd",
        format_fields(number, 0, 0.0, 0.0, 0.0, 0.0),
        "$#     cdl       tdl",
        format_fields(0.0, 0.0),
    ]


def _format_part(number: int, section: int, material: _Material) -> list[str]:
    keyword, values = material
    return [
        keyword,
        format_fields(number, *values),
        "*PART",
        f"seal {keyword[5:].lower().replace('_', ' ')} {number}",
        format_fields(number, section, number),
    ]


def _write_parts(
    deck: Deck, row: SpringRow, first_id: int
) -> tuple[dict[tuple[int, float], list[int]], list[str]]:
    """Return the numbers of the parts of each way and share, and their cards, each written once."""
    numbers = itertools.count(first_id)
    parts: dict[tuple[int, float], list[int]] = {}
    cards: list[str] = []
    for shares in row.shares:
        for direction, solid in row.springs(shares):
            if (direction, shares[direction]) in parts:
                continue
            indices: list[int] = []
            parts[direction, shares[direction]] = indices
            for material in _write_materials(deck.with_solid(solid)):
                indices.append(next(numbers))
                cards += _format_part(indices[-1], first_id, material)
    return parts, cards


def _write_line(deck: Deck, row: SpringRow, first_id: int) -> DeckText:
    """Return the network of each way of each station, along a vector of its own."""
    cards = ["*KEYWORD", "*NODE"]
    for i, station in enumerate(row.stations):
        coordinates_text = "".join(
            f"{format_fixed_width(value, 16):>16}" for value in station.position
        )
        cards += [f"{node:>8}{coordinates_text}" for node in row.nodes(i, first_id)]
    vectors = {
        (frame, direction): rank
        for rank, (frame, direction) in enumerate(
            itertools.product(
                dict.fromkeys(station.frame for station in row.stations), range(row.direction_count)
            ),
            start=first_id,
        )
    }
    cards += [
        "*DEFINE_SD_ORIENTATION",
        "$#     vid       iop        xt        yt        zt      nid1      nid2",
        *(
            format_fields(vid, 0, *frame[direction], 0, 0)
            for (frame, direction), vid in vectors.items()
        ),
        *_format_section(first_id),
    ]
    parts, sentences = _write_parts(deck, row, first_id)
    cards += [*sentences, "*ELEMENT_DISCRETE"]
    element = itertools.count(first_id)
    for i, item in enumerate(row.stations):
        a, b = row.nodes(i, first_id)
        for direction, _ in row.springs(item.shares):
            cards += [
                f"{next(element):>8}{part:>8}{a:>8}{b:>8}{vectors[item.frame, direction]:>8}"
                for part in parts[direction, item.shares[direction]]
            ]
    return deck.format_text(
        "$",
        "discrete springs and dampers along a seal line for LS-DYNA",
        [*cards, "*END"],
        verified=VERIFICATION_NOTE,
        remarks=[
            *row.comments,
            row.format_node_numbering(first_id),
            "fields of nine columns hold five digits or more; discrete elements add no mass",
            "forces act normal to the line, across it and along it, wherever the nodes go",
            "(*DEFINE_SD_ORIENTATION); tie the nodes to their structures",
        ],
    )


def _write_arms(deck: Deck) -> DeckText:
    materials = _write_materials(deck)
    # k, kt, fy: no hardening
    materials += [
        ("*MAT_SPRING_ELASTOPLASTIC", [k, 0.0, F]) for k, F, _ in deck.nonlinear_elements.sliders
    ]
    curve = []
    if deck.nonlinear_elements.k3:
        materials.append(("*MAT_SPRING_NONLINEAR_ELASTIC", [1]))
        rows = (
            f"{format_fixed_width(x, 20):>20}{format_fixed_width(F, 20):>20}"
            for x, F in deck.nonlinear_elements.compute_symmetric_curve()
        )
        curve = ["*DEFINE_CURVE", format_fields(1), *rows]
    cards = [
        "*KEYWORD",
        "*NODE",
        f"{1:>8}{'0.':>16}{'0.':>16}{'0.':>16}",
        # in single precision a long element loses microns: a vector of its own turns none
        f"{2:>8}{'1.':>16}{'0.':>16}{'0.':>16}",
        "*DEFINE_SD_ORIENTATION",
        "$#     vid       iop        xt        yt        zt      nid1      nid2",
        format_fields(1, 0, 1.0, 0.0, 0.0, 0, 0),
        *_format_section(1),
    ]
    for number, material in enumerate(materials, start=1):
        cards += [
            *_format_part(number, 1, material),
            "*ELEMENT_DISCRETE",
            f"{number:>8}{number:>8}{1:>8}{2:>8}{1:>8}",
        ]
    return deck.format_text(
        "$",
        "discrete springs and dampers for LS-DYNA",
        [*cards, *curve, "*END"],
        verified=VERIFICATION_NOTE,
        remarks=[
            "fields of nine columns hold five digits or more; each Maxwell arm is one discrete",
            "element, all between nodes 1 (ground side) and 2 (moving side)",
            "the force acts along x, wherever the nodes go (*DEFINE_SD_ORIENTATION)",
        ],
    )


def _write_prony(
    deck: Deck, modulus: float | None, bulk_modulus: float | None, density: float | None
) -> DeckText:
    long_term, terms = deck.shear(modulus, "LS-DYNA")
    if not (
        isinstance(bulk_modulus, int | float)
        and isinstance(density, int | float)
        and bulk_modulus > 0
        and density > 0
    ):
        raise ExportError(
            "*MAT_GENERAL_VISCOELASTIC needs --bulk-modulus, such as 2000MPa, and --density, such "
            "as 1200 (Python: bulk_modulus= in Pa, density= in kg/m^3); found "
            f"{bulk_modulus!r} and {density!r}"
        )
    if deck.k_inf > 0:
        # a term that does not decay carries the equilibrium modulus
        terms = [(long_term, 0.0), *terms]
    if len(terms) > _MAX_TERMS:
        raise ExportError(
            f"*MAT_GENERAL_VISCOELASTIC holds {_MAX_TERMS} terms, found {len(terms)}; fit fewer "
            "arms"
        )
    return deck.format_text(
        "$",
        "solid material for LS-DYNA",
        [
            "*KEYWORD",
            "*MAT_GENERAL_VISCOELASTIC",
            "$#     mid        ro      bulk       pcf        ef      tref         a         b",
            format_fields(1, deck.units.density(density), deck.units.stress(bulk_modulus)),
            "$#    lcid        nt    bstart     tramp     lcidk       ntk   bstartk    trampk",
            format_fields(0),
            "$#      gi     betai",
            *(format_fields(G, beta) for G, beta in terms),
            "*END",
        ],
        remarks=[
            *(["the first has beta = 0: the equilibrium modulus"] if deck.k_inf > 0 else []),
            f"terms: {len(terms)}; count them after another tool has rewritten the card:",
            "ansys-dyna-core 0.12 keeps the first alone",
        ],
    )
