"""Abaqus input."""

from __future__ import annotations

from collections.abc import Collection

from dashpot.base.units import Range, si_range
from dashpot.export.deck import Deck, DeckText, Exportable, open_deck
from dashpot.export.notation import text
from dashpot.export.shift import abaqus_shift
from dashpot.records.specimen import Specimen

FORMS = ("arms", "connector", "prony")


def abaqus(
    solid: Exportable,
    *,
    units: str | None = None,
    specimen: Specimen | None = None,
    allow: Collection[str] = (),
    form: str = "arms",
    frequency_range: Range = (1.0, 100.0),
    tolerance: float = 1e-3,
) -> DeckText:
    r"""Abaqus keywords of a solid.

    ``"arms"`` writes the exact network of SPRINGA and DASHPOTA elements, for any procedure;
    ``"connector"`` a connector behavior whose stiffness and structural damping depend on
    frequency, for direct and subspace steady-state dynamics; ``"prony"`` a material card
    ``*VISCOELASTIC, TIME=PRONY`` with g_j = k_j/k_0 on the instantaneous modulus, and ``*TRS``
    where the fit has a temperature law.

    Parameters are those of :func:`dashpot.export.nastran`.
    """
    frequency_range = si_range(frequency_range, "frequency")
    deck = open_deck(solid, "abaqus", form, FORMS, units=units, specimen=specimen, allow=allow)
    if form == "arms":
        return _arms(deck)
    if form == "prony":
        return _prony(deck)
    return _connector(deck, frequency_range, tolerance)


def spring_dashpot_network(deck: Deck) -> list[str]:
    """SPRINGA and DASHPOTA elements along x from node 1 to node 2, an inner node in each arm."""
    elements = []  # kind, from, to, name, value
    if deck.k_inf > 0:
        elements.append(("SPRING", 1, 2, "K_INF", deck.k_inf))
    if deck.b > 0:
        elements.append(("DASHPOT", 1, 2, "B", deck.b))
    for j, (k, _, b) in enumerate(deck.arms):
        elements.append(("SPRING", 2, 11 + j, f"K_{j + 1}", k))
        elements.append(("DASHPOT", 11 + j, 1, f"B_{j + 1}", b))
    cards = ["*NODE", "1, 0., 0., 0.", "2, 1., 0., 0."]
    cards += [f"{11 + j}, 0.5, 0., 0." for j in range(deck.model.arms)]
    for number, (kind, a, b_end, name, value) in enumerate(elements, start=1):
        cards += [
            f"*ELEMENT, TYPE={kind}A, ELSET=SEAL_{name}",
            f"{number}, {a}, {b_end}",
            f"*{kind}, ELSET=SEAL_{name}",
            "",
            text(value),
        ]
    return cards


def _arms(deck: Deck) -> DeckText:
    hold = [f"{11 + j}, 2, 3" for j in range(deck.model.arms)]
    return deck.written(
        "**",
        "network of springs and dashpots for Abaqus",
        [*spring_dashpot_network(deck), *(["*BOUNDARY", *hold] if hold else [])],
        remarks=[
            "node 1 is the ground side, node 2 the moving side, one inner node in each arm; all",
            "act along x and only the direction of the axis matters, not its length",
            "inner nodes are massless: for Abaqus/Explicit give each a small *MASS",
        ],
    )


def _prony(deck: Deck) -> DeckText:
    rows = [f"{text(g)}, {text(g)}, {text(tau)}" for g, tau in deck.prony]
    shift, says = abaqus_shift(deck.fit.temperatures if deck.fit else None)
    return deck.written(
        "**",
        "material of relative moduli for Abaqus",
        ["*MATERIAL, NAME=SEAL", "*VISCOELASTIC, TIME=PRONY", *rows, *shift],
        remarks=[
            "g_j = k_j / k_0 refers to the instantaneous modulus: put MODULI=INSTANTANEOUS on the",
            "*ELASTIC, *HYPERELASTIC or *HYPERFOAM card beside it",
            "bulk ratios repeat the shear ratios: a sponge keeps its Poisson ratio as it relaxes;",
            "set the second column to 0 for a nearly incompressible rubber",
            *says,
        ],
    )


def _connector(deck: Deck, frequency_range: tuple[float, float], tolerance: float) -> DeckText:
    table = deck.table(frequency_range, tolerance)
    columns = {
        "*CONNECTOR ELASTICITY, COMPONENT=1": deck.units.stiffness(table.storage),
        "*CONNECTOR DAMPING, COMPONENT=1, TYPE=STRUCTURAL": table.damping,
    }
    cards = ["*CONNECTOR BEHAVIOR, NAME=SEAL"]
    for card, values in columns.items():
        cards.append(card)
        outside = False
        for f, value in zip(table.frequency.tolist(), values.tolist(), strict=True):
            if deck.extrapolated(f) is not outside:
                outside = not outside
                cards.append("** EXTRAPOLATED" if outside else "** identified")
            cards.append(f"{text(value)}, {text(deck.units.frequency(f))}")
    return deck.written(
        "**",
        "frequency-dependent connector behavior for Abaqus",
        cards,
        remarks=[
            "acts along component 1 of an AXIAL or CARTESIAN connector, in direct",
            "or subspace-based steady-state dynamics; rows after EXTRAPOLATED lie outside",
            "the identified band",
        ],
        table=table,
    )
