"""Abaqus input."""

from __future__ import annotations

from collections.abc import Collection

from dashpot.export.deck import Deck
from dashpot.export.frequency_tables import tabulate
from dashpot.export.number_fields import text
from dashpot.export.open_deck import Solid, choose_form, open_deck
from dashpot.records.specimen import Specimen

FORMS = ("arms", "connector", "prony")


def abaqus(
    solid: Solid,
    *,
    units: str | None = None,
    specimen: Specimen | None = None,
    allow: Collection[str] = (),
    form: str = "arms",
    frequency_range: tuple[float, float] = (1.0, 100.0),
    tolerance: float = 1e-3,
) -> str:
    r"""Abaqus keywords of a solid.

    ``"arms"`` writes the exact network of SPRINGA and DASHPOTA elements, for any procedure;
    ``"connector"`` a connector behavior whose stiffness and structural damping depend on
    frequency, for direct and subspace steady-state dynamics; ``"prony"`` a material card
    ``*VISCOELASTIC, TIME=PRONY`` with g_j = k_j/k_0 on the instantaneous modulus.

    Parameters are those of :func:`dashpot.export.nastran.nastran`.
    """
    choose_form(form, FORMS, "abaqus")
    deck = open_deck(solid, units=units, specimen=specimen, allow=allow, prony=form == "prony")
    if form == "arms":
        return _arms(deck)
    if form == "prony":
        return _prony(deck)
    return _connector(deck, frequency_range, tolerance)


def spring_dashpot_cards(
    deck: Deck, *, ground: int, mass: int, first_inner: int, first_element: int, name: str
) -> list[str]:
    """SPRINGA and DASHPOTA elements between two nodes, with one inner node in each arm."""
    cards: list[str] = []
    number = first_element

    def element(kind: str, a: int, b: int, label: str, value: float) -> None:
        nonlocal number
        keyword = "SPRING" if kind == "SPRINGA" else "DASHPOT"
        cards.extend(
            [
                f"*ELEMENT, TYPE={kind}, ELSET={label}",
                f"{number}, {a}, {b}",
                f"*{keyword}, ELSET={label}",
                "",
                text(value),
            ]
        )
        number += 1

    if deck.k_inf > 0:
        element("SPRINGA", ground, mass, f"{name}_K_INF", deck.k_inf)
    if deck.b > 0:
        element("DASHPOTA", ground, mass, f"{name}_B", deck.b)
    for j, (k, _, b) in enumerate(deck.arms):
        inner = first_inner + j
        element("SPRINGA", mass, inner, f"{name}_K_{j + 1}", k)
        element("DASHPOTA", inner, ground, f"{name}_B_{j + 1}", b)
    return cards


def _arms(deck: Deck) -> str:
    inner = [f"{11 + j}, 0.5, 0., 0." for j in range(deck.model.arms)]
    header = deck.header(
        "**",
        "network of springs and dashpots for Abaqus",
        remarks=[
            "node 1 is the ground side, node 2 the moving side, one inner node in each arm; all",
            "act along x and only the direction of the axis matters, not its length",
            "inner nodes are massless: for Abaqus/Explicit give each a small *MASS",
        ],
    )
    hold = [f"{11 + j}, 2, 3" for j in range(deck.model.arms)]
    return "\n".join(
        [
            *header,
            "*NODE",
            "1, 0., 0., 0.",
            "2, 1., 0., 0.",
            *inner,
            *spring_dashpot_cards(
                deck, ground=1, mass=2, first_inner=11, first_element=1, name="SEAL"
            ),
            *(["*BOUNDARY", *hold] if hold else []),
            "",
        ]
    )


def _prony(deck: Deck) -> str:
    header = deck.header(
        "**",
        "material of relative moduli for Abaqus",
        remarks=[
            "g_j = k_j / k_0 refers to the instantaneous modulus: put MODULI=INSTANTANEOUS on the",
            "*ELASTIC, *HYPERELASTIC or *HYPERFOAM card beside it",
            "bulk ratios repeat the shear ratios: a sponge keeps its Poisson ratio as it relaxes;",
            "set the second column to 0 for a nearly incompressible rubber",
        ],
    )
    rows = [
        f"{text(g)}, {text(g)}, {text(tau)}"
        for g, (_, tau, _) in zip(deck.relative_moduli, deck.arms, strict=True)
    ]
    return "\n".join([*header, "*MATERIAL, NAME=SEAL", "*VISCOELASTIC, TIME=PRONY", *rows, ""])


def _connector(deck: Deck, frequency_range: tuple[float, float], tolerance: float) -> str:
    table = tabulate(
        deck.model,
        frequency_range=frequency_range,
        tolerance=tolerance,
        damping="loss_factor",
        edges=deck.band or (),
        rounded=lambda value: float(text(value)),
    )
    header = deck.header(
        "**",
        "frequency-dependent connector behavior for Abaqus",
        remarks=[
            table.says,
            "acts along component 1 of an AXIAL or CARTESIAN connector, in direct",
            "or subspace-based steady-state dynamics; rows after EXTRAPOLATED lie outside",
            "the identified band",
        ],
    )
    storage = [deck.units.stiffness(value) for value in table.storage]
    frequency = [deck.units.frequency(value) for value in table.frequency]
    rows = {"stiffness": storage, "loss": table.damping.tolist()}
    cards = {
        "stiffness": "*CONNECTOR ELASTICITY, COMPONENT=1",
        "loss": "*CONNECTOR DAMPING, COMPONENT=1, TYPE=STRUCTURAL",
    }
    lines = [*header, "*CONNECTOR BEHAVIOR, NAME=SEAL"]
    for name, card in cards.items():
        lines.append(card)
        outside = False
        for f, shown, value in zip(table.frequency, frequency, rows[name], strict=True):
            if deck.extrapolated(float(f)) is not outside:
                outside = not outside
                lines.append("** EXTRAPOLATED" if outside else "** identified")
            lines.append(f"{text(value)}, {text(shown)}")
    return "\n".join([*lines, ""])
