"""Ansys Mechanical APDL input."""

from __future__ import annotations

import numpy as np

from dashpot.base.errors import ExportError
from dashpot.base.units import Range, si_range
from dashpot.datamodel.seal_line import Shear, Stations
from dashpot.datamodel.shift_factors import TemperatureShifts
from dashpot.export.deck import CARRIERS, Deck, DeckText, format_temperature_lines
from dashpot.export.deck_validation import target
from dashpot.export.frequency_tables import Table
from dashpot.export.seal_line_springs import SpringRow, make_springs
from dashpot.export.unit_systems import format_tbdata, text
from dashpot.solids.shift_laws import GAS_CONSTANT, WLF, Arrhenius

# Temperature dependence.


def ansys_shift(shifts: TemperatureShifts | None) -> tuple[list[str], list[str]]:
    """Return the table ``TB,SHIFT`` for a ``TB,PRONY``, and notes."""
    law = None if shifts is None else shifts.law
    if shifts is None or not isinstance(law, WLF | Arrhenius):
        return [], []
    row: tuple[float, ...]
    if isinstance(law, WLF):
        header, row = "TB,SHIFT,1,1,3,WLF", (law.reference, law.c1, law.c2)
    else:
        header, row = "TB,SHIFT,1,1,2,TN", (law.reference, law.energy / GAS_CONSTANT)
    sentences = [
        "TB,SHIFT: temperatures of the model are in K (TOFFST,0)",
        *format_temperature_lines("deck remarks", shifts),
    ]
    return [header, "TBDATA,1," + ",".join(text(value) for value in row)], sentences


FORMS = ("arms", "table", "prony")
SUFFIX = "mac"
_MAX_POINTS = 20
VERIFICATION_NOTE = (
    "not solver-verified: no Ansys runs in dashpot's tests. They read the commands back to the "
    "stiffness of the whole line"
)


@target(*FORMS, line=("table",), frequency_range=("table",), tolerance=("table",))
def ansys(
    deck: Deck,
    *,
    frequency_range: Range = (1.0, 100.0),
    tolerance: float = 1e-3,
    line: Stations | None = None,
    shear: Shear | None = None,
    first_id: int = 1,
) -> DeckText:
    r"""Mechanical APDL commands of a solid.

    ``"arms"`` writes the exact network of COMBIN14 springs and dampers acting along UX, for any
    analysis; sliders are COMBIN40, a cubic spring is COMBIN39, for transient ones.
    ``"table"`` writes COMBIN14 whose K = K' and CV1 = K''/omega are tables of the frequency, for
    full harmonic analyses: one at the origin, or up to three at each station of a line, along
    the axes of its rotated nodes.
    ``"prony"`` writes a TB,PRONY table of relative shear moduli alpha_j = k_j/k_0 and times, for
    transient and full harmonic analyses, and ``TB,SHIFT`` where the fit has a temperature law.

    Parameters are those of :func:`dashpot.export.nastran`.
    """
    if deck.form == "table":
        requested = (si_range(frequency_range, "frequency"), tolerance)
        return _write_table(deck, make_springs(deck, line, shear), requested, first_id)
    return _write_prony(deck) if deck.form == "prony" else _write_arms(deck)


def _write_table(
    deck: Deck, row: SpringRow, table_limits: tuple[tuple[float, float], float], first_id: int
) -> DeckText:
    """Return an element type for each way, a real constant of two tables for each share of it."""
    cards, tables = ["/PREP7"], []
    constants: dict[tuple[int, float], int] = {}
    for direction in range(row.direction_count):
        cards += [
            f"ET,{first_id + direction},COMBIN14",
            f"KEYOPT,{first_id + direction},2,{direction + 1}",
        ]
    for shares in row.shares:
        for direction, solid in row.springs(shares):
            if (direction, shares[direction]) in constants:
                continue
            number = constants[direction, shares[direction]] = first_id + len(constants)
            tables.append(deck.table(*table_limits, solid=solid, damping="damping"))
            cards += _real_constant(deck, number, tables[-1])
    for i, station in enumerate(row.stations):
        for node in row.nodes(i, first_id):
            words = [text(value) for value in (*station.position, *compute_rotation(station.frame))]
            cards.append(f"N,{node},{','.join(words)}")
    for i, station in enumerate(row.stations):
        a, b = row.nodes(i, first_id)
        for direction, _ in row.springs(station.shares):
            constant = constants[direction, station.shares[direction]]
            cards += [f"TYPE,{first_id + direction}", f"REAL,{constant}", f"E,{a},{b}"]
    return deck.format_text(
        "!",
        "springs and dampers against frequency for Ansys Mechanical APDL",
        [*cards, "FINISH"],
        verified=VERIFICATION_NOTE,
        remarks=[
            *row.comments,
            row.format_node_numbering(first_id),
            "K and CV1 are tables of FREQ: for full harmonic analyses",
            "the nodes are rotated: UX, UY and UZ are normal to the line, across it and along it;",
            "tie them to nodes of your own at the same places (CP, CERIG): NROTAT on yours turns",
            "whatever else is there",
        ],
        table=max(tables, key=lambda table: table.error),
    )


def _real_constant(deck: Deck, number: int, table: Table) -> list[str]:
    """K and CV1 as tables of the frequency."""
    f = deck.units.frequency(table.frequency).tolist()
    values = {
        "SK": deck.units.stiffness(table.storage).tolist(),
        "SC": deck.units.damping(table.damping).tolist(),
    }
    cards = []
    for name, column in values.items():
        label = f"{name}{number}"
        cards.append(f"*DIM,{label},TABLE,{len(f)},1,1,FREQ")
        # a command holds ten values
        for at in range(0, len(f), 10):
            cards.append(f"*TAXIS,{label}({at + 1}),1,{','.join(map(text, f[at : at + 10]))}")
            rows = ",".join(map(text, column[at : at + 10]))
            cards.append(f"*SET,{label}({at + 1},1),{rows}")
    return [*cards, f"R,{number},%SK{number}%,%SC{number}%"]


def compute_rotation(frame: tuple[tuple[float, ...], ...]) -> tuple[float, float, float]:
    r"""Angles of a node whose x, y and z axes are normal, across and the third, deg.

    :math:`R_z(\theta_{xy}) R_x(\theta_{yz}) R_y(\theta_{zx})`, as N takes them.
    """
    x, y = (np.array(values) for values in frame[:2])
    a = np.arctan2(-y[0], y[1])
    b = np.arctan2(y[2], np.hypot(y[0], y[1]))
    # x as the first two leave it; where y stands on z they are one, and this is the rest
    about_z = np.array([(np.cos(a), np.sin(a), 0), (-np.sin(a), np.cos(a), 0), (0, 0, 1)])
    about_x = np.array([(1, 0, 0), (0, np.cos(b), np.sin(b)), (0, -np.sin(b), np.cos(b))])
    remainder = about_x @ about_z @ x
    c = np.arctan2(-remainder[2], remainder[0])
    xy, yz, zx = np.degrees([a, b, c]).tolist()
    return xy + 0.0, yz + 0.0, zx + 0.0


def _write_arms(deck: Deck) -> DeckText:
    nodes = ["N,1,0,0,0", "N,2,0,0,0", *(f"N,{11 + j},0,0,0" for j in range(deck.model.arms))]
    elements: list[tuple[float, float, int, int]] = []  # K, CV1, I, J
    # a COMBIN39 must rise at its origin, as a cubic spring does not: it carries k_inf too
    k_inf = 0.0 if deck.nonlinear_elements.k3 else deck.k_inf
    if k_inf > 0 or deck.b > 0:
        elements.append((k_inf, deck.b, 1, 2))
    for j, (k, _, b) in enumerate(deck.arms):
        elements += [(k, 0.0, 2, 11 + j), (0.0, b, 11 + j, 1)]
    cards = ["/PREP7", "ET,1,COMBIN14", "KEYOPT,1,2,1", *nodes, "TYPE,1"]
    for number, (k, c, i, j) in enumerate(elements, start=1):
        cards += [f"R,{number},{text(k)},{text(c)}", f"REAL,{number}", f"E,{i},{j}"]
    cards += _format_nonlinear_cards(deck, 1 + len(elements))
    return deck.format_text(
        "!",
        "network of springs and dampers for Ansys Mechanical APDL",
        [*cards, "FINISH"],
        remarks=[
            "node 1 is the ground side, node 2 the moving side, one inner node in each arm; all",
            "act along UX of the nodes (KEYOPT(2) = 1), wherever the nodes stand",
            *["COMBIN40: K1, C, M, GAP = 0, FSLIDE: slides both ways"]
            * bool(deck.nonlinear_elements.sliders),
            *["COMBIN39: k_inf and the cubic spring in one, from 0; it is reflected"]
            * bool(deck.nonlinear_elements.k3),
        ],
    )


def _format_nonlinear_cards(deck: Deck, number: int) -> list[str]:
    """Sliders, and k_inf with the cubic spring: a curve of 20 points at most, from 0 up."""
    cards = []
    if deck.nonlinear_elements.sliders:
        cards += ["ET,2,COMBIN40", "TYPE,2"]
    for k, F, _ in deck.nonlinear_elements.sliders:
        cards += [f"R,{number},{text(k)},0.,0.,0.,{text(F)},0.", f"REAL,{number}", "E,1,2"]
        number += 1
    if not deck.nonlinear_elements.k3:
        return cards
    curve = deck.nonlinear_elements.compute_curve(_MAX_POINTS - 1, k=deck.k_inf)
    if not curve[1][1] > 0:
        raise ExportError(
            "COMBIN39 must rise at its origin, but k_inf does not exceed the softening of the "
            "cubic spring; use a target that supports it: --to "
            f"{', '.join(name for name in CARRIERS if name != 'ansys')}"
        )
    values = [text(value) for pair in curve for value in pair]
    cards += ["ET,3,COMBIN39", "TYPE,3", f"R,{number},{','.join(values[:6])}"]
    cards += [f"RMORE,{','.join(values[at : at + 6])}" for at in range(6, len(values), 6)]
    return [*cards, f"REAL,{number}", "E,1,2"]


def _write_prony(deck: Deck) -> DeckText:
    rows = format_tbdata([value for pair in deck.prony for value in pair])
    shift, message = ansys_shift(deck.temperatures)
    return deck.format_text(
        "!",
        "material of relative moduli for Ansys Mechanical APDL",
        [f"TB,PRONY,1,1,{deck.model.arms},SHEAR", *rows, *shift],
        remarks=[
            "alpha_j = k_j / k_0 refers to the instantaneous modulus: the elastic constants of",
            "material 1 are the instantaneous ones",
            "repeat the table with BULK in place of SHEAR for a sponge, which keeps its Poisson",
            "ratio as it relaxes",
            *message,
        ],
    )
