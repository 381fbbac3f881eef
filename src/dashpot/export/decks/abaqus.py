"""Abaqus input."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from dashpot.base.units import Range, si_range
from dashpot.datamodel.seal_line import Shear, Stations
from dashpot.datamodel.shift_factors import TemperatureShifts
from dashpot.export.deck import Deck, DeckText, format_temperature_lines
from dashpot.export.deck_validation import target
from dashpot.export.frequency_tables import Table
from dashpot.export.seal_line_springs import SpringRow, make_springs
from dashpot.export.unit_systems import text
from dashpot.solids.shift_laws import GAS_CONSTANT, WLF, Arrhenius

# Temperature dependence.


def abaqus_shift(shifts: TemperatureShifts | None) -> tuple[list[str], list[str]]:
    """Return the cards ``*TRS`` that follow ``*VISCOELASTIC``, and remarks on them."""
    law = None if shifts is None else shifts.law
    if shifts is None or not isinstance(law, WLF | Arrhenius):
        return [], []
    row: tuple[float, ...]
    if isinstance(law, WLF):
        row, constants = (law.reference, law.c1, law.c2), []
        cards = ["*TRS, DEFINITION=WLF"]
    else:
        row = (law.reference, law.energy)
        cards = ["*TRS, DEFINITION=ARRHENIUS"]
        constants = [
            "the model needs, above all materials, *PHYSICAL CONSTANTS, ABSOLUTE ZERO=0.,",
            f"UNIVERSAL GAS={text(GAS_CONSTANT)}: the energy on the card is in J/mol",
        ]
    sentences = [
        "*TRS: temperatures of the model are in K",
        *constants,
        *format_temperature_lines("deck remarks", shifts),
    ]
    return [*cards, ", ".join(text(value) for value in row)], sentences


FORMS = ("arms", "connector", "prony")
SUFFIX = "inp"
NOT_VERIFIED = (
    "not solver-verified: no Abaqus runs in dashpot's tests. CalculiX reads these cards there, and "
    "runs its own deck of the same ones"
)
_FIRST_SLIDER_NUMBER = 7000
"""Number after which nodes and elements of sliders begin."""
_SLIDER_PERIOD = 1e-5
"""Period over 2 pi of a slider's lid on its own spring, s: it makes the mass small."""


@target(*FORMS, line=("connector",), frequency_range=("connector",), tolerance=("connector",))
def abaqus(
    deck: Deck,
    *,
    frequency_range: Range = (1.0, 100.0),
    tolerance: float = 1e-3,
    line: Stations | None = None,
    shear: Shear | None = None,
    first_id: int = 1,
) -> DeckText:
    r"""Abaqus keywords of a solid.

    ``"arms"`` writes the exact network of SPRINGA and DASHPOTA elements, for any procedure, a
    cubic spring as one with a curve, and each slider as a block of a perfectly plastic material in
    simple shear, for ``*STATIC`` and ``*DYNAMIC``;
    ``"connector"`` a connector behavior whose stiffness and structural damping depend on
    frequency, for direct and subspace steady-state dynamics; ``"prony"`` a material card
    ``*VISCOELASTIC, TIME=PRONY`` with g_j = k_j/k_0 on the instantaneous modulus, and ``*TRS``
    where the fit has a temperature law.

    With a line, ``"connector"`` writes CARTESIAN connector elements between coincident nodes at
    its stations, each with its orientation.

    Parameters are those of :func:`dashpot.export.nastran`.
    """
    frequency_range = si_range(frequency_range, "frequency")
    if deck.form == "arms":
        return _arms(deck)
    if deck.form == "prony":
        return _prony(deck)
    if line is not None:
        row = make_springs(deck, line, shear)
        return _line(deck, row, frequency_range, tolerance, first_id)
    return _connector(deck, frequency_range, tolerance)


def spring_dashpot_network(deck: Deck) -> list[str]:
    """The springs, dashpots and sliders along x from node 1 to node 2; a node in each arm."""
    elements = []  # kind, from, to, name, value
    if deck.k_inf > 0:
        elements.append(("SPRING", 1, 2, "K_INF", deck.k_inf))
    if deck.b > 0:
        elements.append(("DASHPOT", 1, 2, "B", deck.b))
    for j, (k, _, b) in enumerate(deck.arms):
        elements.append(("SPRING", 2, 11 + j, f"K_{j + 1}", k))
        elements.append(("DASHPOT", 11 + j, 1, f"B_{j + 1}", b))
    span = deck.nonlinear_elements.span
    cards = ["*NODE", "1, 0., 0., 0.", f"2, {text(span)}, 0., 0."]
    cards += [f"{11 + j}, {text(span / 2)}, 0., 0." for j in range(deck.model.arms)]
    for number, (kind, a, b_end, name, value) in enumerate(elements, start=1):
        cards += [
            f"*ELEMENT, TYPE={kind}A, ELSET=SEAL_{name}",
            f"{number}, {a}, {b_end}",
            f"*{kind}, ELSET=SEAL_{name}",
            "",
            text(value),
        ]
    if deck.nonlinear_elements.k3:
        cards += [
            "*ELEMENT, TYPE=SPRINGA, ELSET=SEAL_CUBIC",
            f"{1 + len(elements)}, 1, 2",
            "*SPRING, ELSET=SEAL_CUBIC, NONLINEAR",
            "",
            *(
                f"{text(F)}, {text(x)}"
                for x, F in deck.nonlinear_elements.compute_symmetric_curve()
            ),
        ]
    for number, (k, F, _) in enumerate(deck.nonlinear_elements.sliders, start=1):
        cards += _slider(number, k, F, span, k * (_SLIDER_PERIOD / deck.units.time) ** 2)
    return cards


def _slider(number: int, k: float, slip_force: float, height: float, mass: float) -> list[str]:
    r"""A block in simple shear, whose lid follows node 2: :math:`k = GA/h`, :math:`F = \tau A`.

    Its section is such that it flows at a Mises stress of 1, for ccx takes a stress of 1e-10 for
    none. All lateral motions are fixed, so nothing bends.
    """
    name, first = f"SEAL_SLIDER_{number}", _FIRST_SLIDER_NUMBER + 10 * number
    area = np.sqrt(3) * slip_force
    edge, ids = float(np.sqrt(area)), [first + i for i in range(1, 9)]
    lower_nodes, lid = ids[:4], ids[4:]
    sides = ((0.0, 0.0), (edge, 0.0), (edge, edge), (0.0, edge))
    corners = [(x, y, z) for z in (0.0, height) for x, y in sides]
    cards = [
        "*NODE",
        *(f"{n}, {', '.join(map(text, at))}" for n, at in zip(ids, corners, strict=True)),
        f"*ELEMENT, TYPE=C3D8, ELSET={name}",
        f"{first}, {', '.join(map(str, ids))}",
        f"*MATERIAL, NAME={name}",
        "*ELASTIC",
        f"{text(2 * k * height / area)}, 0.",
        "*PLASTIC",
        "1., 0.",
        "*DENSITY",
        text(mass / (area * height)),
        f"*SOLID SECTION, ELSET={name}, MATERIAL={name}",
    ]
    for n in lid:
        cards += ["*EQUATION", "2", f"{n}, 1, 1., 2, 1, -1."]
    return [*cards, "*BOUNDARY", *(f"{n}, 1, 3" for n in lower_nodes), *(f"{n}, 2, 3" for n in lid)]


def slider_remarks(deck: Deck) -> list[str]:
    """Return the remarks of the header on the two nodes and the blocks."""
    if not deck.nonlinear_elements.sliders:
        return deck.nonlinear_elements.node_spacing_remarks
    return [
        *deck.nonlinear_elements.node_spacing_remarks,
        "a slider is a block of perfectly plastic material in simple shear, which turns by less",
        "than 0.001 rad at the amplitudes tested; a linear step sees its stiffness, no friction",
    ]


def _arms(deck: Deck) -> DeckText:
    hold = [f"{11 + j}, 2, 3" for j in range(deck.model.arms)]
    return deck.format_text(
        "**",
        "network of springs and dashpots for Abaqus",
        [*spring_dashpot_network(deck), *(["*BOUNDARY", *hold] if hold else [])],
        verified=NOT_VERIFIED,
        remarks=[
            "node 1 is the ground side, node 2 the moving side, one inner node in each arm; all",
            "act along x",
            "inner nodes are massless: for Abaqus/Explicit give each a small *MASS",
            *slider_remarks(deck),
        ],
    )


def _prony(deck: Deck) -> DeckText:
    rows = [f"{text(g)}, {text(g)}, {text(tau)}" for g, tau in deck.prony]
    shift, message = abaqus_shift(deck.temperatures)
    return deck.format_text(
        "**",
        "material of relative moduli for Abaqus",
        ["*MATERIAL, NAME=SEAL", "*VISCOELASTIC, TIME=PRONY", *rows, *shift],
        remarks=[
            "g_j = k_j / k_0 refers to the instantaneous modulus: put MODULI=INSTANTANEOUS on the",
            "*ELASTIC, *HYPERELASTIC or *HYPERFOAM card beside it",
            "bulk ratios repeat the shear ratios: a sponge keeps its Poisson ratio as it relaxes;",
            "set the second column to 0 for a nearly incompressible rubber",
            *message,
        ],
    )


def _connector(deck: Deck, frequency_range: tuple[float, float], tolerance: float) -> DeckText:
    table = deck.table(frequency_range, tolerance)
    return deck.format_text(
        "**",
        "frequency-dependent connector behavior for Abaqus",
        ["*CONNECTOR BEHAVIOR, NAME=SEAL", *_component(deck, 1, table)],
        remarks=[
            "acts along component 1 of an AXIAL or CARTESIAN connector, in direct",
            "or subspace-based steady-state dynamics; rows after EXTRAPOLATED lie outside",
            "the valid band",
        ],
        table=table,
    )


def _component(deck: Deck, number: int, table: Table) -> list[str]:
    """Elasticity and structural damping of one component, a row a frequency."""
    columns = {
        f"*CONNECTOR ELASTICITY, COMPONENT={number}": deck.units.stiffness(table.storage),
        f"*CONNECTOR DAMPING, COMPONENT={number}, TYPE=STRUCTURAL": table.damping,
    }
    cards = []
    for card, values in columns.items():
        cards.append(card)
        outside = False
        for f, value in zip(table.frequency.tolist(), values.tolist(), strict=True):
            if deck.is_extrapolated(f) is not outside:
                outside = not outside
                cards.append("** EXTRAPOLATED" if outside else "** identified")
            cards.append(f"{text(value)}, {text(deck.units.frequency(f))}")
    return cards


def _line(
    deck: Deck,
    row: SpringRow,
    frequency_range: tuple[float, float],
    tolerance: float,
    first_id: int,
) -> DeckText:
    """Connectors at the stations of a seal line."""
    cards, tables = pairs_of_nodes(row, first_id), []
    for shares, rank in row.shares.items():
        cards.append(f"*CONNECTOR BEHAVIOR, NAME=SEAL_{rank + 1}")
        for direction, solid in row.springs(shares):
            tables.append(deck.table(frequency_range, tolerance, solid=solid))
            cards += _component(deck, direction + 1, tables[-1])
    for number, (first, frame, shares, members) in enumerate(
        iterate_groups(row, first_id), start=1
    ):
        cards += [
            f"*ELEMENT, TYPE=CONN3D2, ELSET=SEAL_LINE_{number}",
            *(f"{first + i}, {a}, {b}" for i, (a, b) in enumerate(members)),
            f"*CONNECTOR SECTION, ELSET=SEAL_LINE_{number}, BEHAVIOR=SEAL_{row.shares[shares] + 1}",
            "CARTESIAN,",
            f"SEAL_FRAME_{frame},",
        ]
    low, high = frequency_range
    return deck.format_text(
        "**",
        "connectors along a seal line for Abaqus",
        cards,
        remarks=[
            *row.comments,
            row.format_node_numbering(first_id),
            "components 1 to 3 act normal to the line, across it and along it; tie the nodes of",
            "each side to its structure (*COUPLING, *TIE, *RIGID BODY)",
            "direct and subspace-based steady-state dynamics read the rows; *FREQUENCY reads those",
            f"at its PROPERTY EVALUATION, e.g. {np.sqrt(low * high):.4g}, and *STATIC the first",
        ],
        table=max(tables, key=lambda table: table.error),
    )


def pairs_of_nodes(row: SpringRow, first_id: int) -> list[str]:
    """Coincident nodes at each station, in a set of either side, and the frames."""
    sides: list[list[str]] = [[], []]
    for i, station in enumerate(row.stations):
        for side, node in zip(sides, row.nodes(i, first_id), strict=True):
            side.append(f"{node}, {', '.join(map(text, station.position))}")
    cards = ["*NODE, NSET=SEAL_GROUND", *sides[0], "*NODE, NSET=SEAL_MOVING", *sides[1]]
    for rank, (normal, across, _) in enumerate(_frames_of(row), start=1):
        axes = ", ".join(text(value) for value in (*normal, *across))
        cards += [f"*ORIENTATION, NAME=SEAL_FRAME_{rank}, SYSTEM=RECTANGULAR", axes]
    return cards


def _frames_of(row: SpringRow) -> list[tuple[tuple[float, ...], ...]]:
    return list(dict.fromkeys(station.frame for station in row.stations))


def iterate_groups(
    row: SpringRow, first_id: int
) -> Iterator[tuple[int, int, tuple[float, float, float], list[tuple[int, int]]]]:
    """Iterate over groups of stations: first element, frame, shares and nodes."""
    frames = {frame: rank for rank, frame in enumerate(_frames_of(row), start=1)}
    entries: dict[tuple[int, tuple[float, float, float]], list[tuple[int, int]]] = {}
    for i, station in enumerate(row.stations):
        group = entries.setdefault((frames[station.frame], station.shares), [])
        group.append(row.nodes(i, first_id))
    first = first_id
    for (frame, shares), members in entries.items():
        yield first, frame, shares, members
        first += len(members)
