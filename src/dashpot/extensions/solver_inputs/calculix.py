"""CalculiX input."""

from __future__ import annotations

import numpy as np

from dashpot.base.errors import ExportError
from dashpot.base.units import Quantity, Range, convert_to_si, si_range
from dashpot.base.value_ranges import require_positive
from dashpot.datamodel.seal_line import Shear, Stations
from dashpot.export.deck import Deck, DeckText
from dashpot.export.deck_validation import target
from dashpot.export.decks.abaqus import (
    iterate_groups,
    pairs_of_nodes,
    slider_remarks,
    spring_dashpot_network,
)
from dashpot.export.seal_line_springs import SpringRow, make_springs
from dashpot.export.unit_systems import text

FORMS = ("arms", "springs")
SUFFIX = "inp"
CYCLED = (
    "verified: CalculiX (ccx) runs such a deck in dashpot's tests; loops of several amplitudes "
    "have the energy and the secant of the model within 1e-3"
)
RUN = (
    "verified: CalculiX (ccx) runs such a deck in dashpot's tests; the modes of a door on its seal "
    "alone are within 1e-6 of the model"
)
_ARMS_ACT = (
    "arms act in *DYNAMIC and steady state only: in *STATIC and *VISCO they carry nothing, and ccx "
    "says nothing"
)
_PADDING = 100
_INNER_MASS = 2e-5


@target(*FORMS, line=("springs",), nominal=("springs",), mass=("arms",), points=("arms",))
def calculix(
    deck: Deck,
    *,
    mass: Quantity | None = None,
    frequency_range: Range = (1.0, 100.0),
    points: int = 400,
    nominal: Quantity | None = None,
    line: Stations | None = None,
    shear: Shear | None = None,
    first_id: int = 1,
) -> DeckText:
    r"""CalculiX keywords: ``"arms"``, the exact network of SPRINGA and DASHPOTA elements.

    ``"springs"`` writes SPRING2 elements of K' at one frequency between coincident nodes, for
    ``*FREQUENCY`` and ``*STATIC``: one at the origin, or up to three at each station of a line.
    ccx has no spring whose stiffness depends on frequency.

    With a mass the deck is complete and runs without changes: the mass on the solid under a unit
    force, its displacement printed as a real and an imaginary block at each frequency, that is, the
    receptance. Without one, only the network, to be included in a model.

    Sliders are blocks of a perfectly plastic material in simple shear, for ``*STATIC`` and
    ``*DYNAMIC`` steps; ccx has no spring that slips. A mass is then refused: the steady-state
    step is linear.

    Four things about ccx shape the deck. Inner nodes need a mass, which is made so small that
    the arm does not feel it. Its eigensolver returns zeros for models of a few degrees of
    freedom, so stiff dummies that touch nothing are added. Its static and visco steps take no
    dashpot, without a word, and its modal dynamics step is wrong with inner nodes: use the
    steady-state step written here, or ``*DYNAMIC, DIRECT`` with small increments.

    Parameters
    ----------
    solid, units, specimen, allow
        As in :func:`dashpot.export.nastran`.
    form : str
    mass : float, optional
        kg; of ``"arms"``.
    frequency_range : (float, float)
        Frequency range of the steady-state step, Hz; the inner masses are small up to its end.
    points : int
        Frequencies in it, evenly spaced.
    nominal : float, optional
        Frequency, Hz, of the stiffness of ``"springs"``; the geometric middle of the range if not
        given.
    line, shear, first_id
        As in :func:`dashpot.export.nastran`.
    """
    from dashpot.extensions.solver_inputs.procedures import format_procedures

    mass, frequency_range = convert_to_si(mass, "mass"), si_range(frequency_range, "frequency")
    low, high = frequency_range
    if not 0 < low < high:
        raise ExportError(f"frequency_range = {low:g}:{high:g} Hz; expected 0 < low < high")
    if mass is not None and not mass > 0:
        raise ExportError(f"mass = {mass!r} kg; expected a number > 0")
    if mass is not None and deck.nonlinear_elements.parts:
        raise ExportError(
            "--mass writes a steady-state step, which is linear and knows no friction; leave it "
            "out, and march the network with *DYNAMIC (Python: mass=)"
        )
    if deck.form == "springs":
        at = convert_to_si(nominal, "frequency")
        require_positive("--", nominal=at, unit=" Hz", optional=True)
        return _write_springs(
            deck, make_springs(deck, line, shear), at or float(np.sqrt(low * high)), first_id
        )
    title = "network of springs and dashpots for CalculiX"
    cards = [
        *spring_dashpot_network(deck),
        *_compute_inner_masses(deck, high),
        "*BOUNDARY",
        "1, 1, 3",
        "2, 2, 3",
        *(f"{11 + j}, 2, 3" for j in range(deck.model.arms)),
    ]
    remarks = [
        "node 1 is the ground side, node 2 the moving side, one inner node in each arm, along x"
    ]
    if mass is not None:
        title = "steady-state response of a mass on the model for CalculiX"
        cards += _write_steps(deck, mass, low, high, points)
        remarks += [
            "U1 of node 2 under a unit force: the receptance, real block then",
            "imaginary block at each frequency; the dummies only keep the eigensolver busy",
        ]
    verified, *further_remarks = (
        [CYCLED]
        if deck.nonlinear_elements.parts
        else [*format_procedures("calculix", "arms"), _ARMS_ACT]
    )
    remarks = [*further_remarks, *remarks, *slider_remarks(deck)]
    return deck.format_text("**", title, cards, verified=verified, remarks=remarks)


def _write_springs(deck: Deck, row: SpringRow, nominal: float, first_id: int) -> DeckText:
    """Return a spring of K' for each way of each station, along an axis of its frame."""
    cards, element = pairs_of_nodes(row, first_id), first_id
    for number, (_, frame, shares, members) in enumerate(iterate_groups(row, first_id), start=1):
        for direction, solid in row.springs(shares):
            K = complex(solid.complex_stiffness(omega=2 * np.pi * nominal)).real
            name = f"SEAL_{number}_{direction + 1}"
            cards += [
                f"*ELEMENT, TYPE=SPRING2, ELSET={name}",
                *(f"{element + i}, {a}, {b}" for i, (a, b) in enumerate(members)),
                f"*SPRING, ELSET={name}, ORIENTATION=SEAL_FRAME_{frame}",
                f"{direction + 1}, {direction + 1}",
                text(deck.units.stiffness(K)),
            ]
            element += len(members)
    eta = complex(deck.solid.complex_stiffness(omega=2 * np.pi * nominal))
    return deck.format_text(
        "**",
        "springs of one frequency for CalculiX",
        [*cards, "*BOUNDARY", "SEAL_GROUND, 1, 3"],
        verified=RUN,
        nominal=nominal,
        remarks=[
            *row.comments,
            row.format_node_numbering(first_id),
            f"stiffness of {nominal:.6g} Hz, for *FREQUENCY and *STATIC: ccx knows no loss factor",
            f"of a spring, and the seal's is {eta.imag / eta.real:.4g} there",
            "the nodes of SEAL_GROUND are held; tie those of SEAL_MOVING to the door, e.g. by",
            "*RIGID BODY, NSET=, REF NODE=, ROT NODE=; a model of few degrees of freedom needs",
            "some that touch nothing, or ccx prints zeros for its frequencies",
        ],
    )


def _compute_inner_rates(deck: Deck, high: float) -> list[float]:
    """Squared natural frequency of each inner mass on its spring, (rad/s)^2."""
    omega = 2 * np.pi * high
    # what an inner node feels at the top frequency: the softer of its spring and dashpot
    return [omega**2 / (_INNER_MASS * min(1.0, omega * tau)) for tau in deck.model.tau]


def _compute_inner_masses(deck: Deck, high: float) -> list[str]:
    cards: list[str] = []
    for j, (k, rate) in enumerate(zip(deck.model.k, _compute_inner_rates(deck, high), strict=True)):
        cards += [
            f"*ELEMENT, TYPE=MASS, ELSET=SEAL_M_{j + 1}",
            f"{5001 + j}, {11 + j}",
            f"*MASS, ELSET=SEAL_M_{j + 1}",
            text(k / rate / deck.units.mass),
        ]
    return cards


def _write_steps(deck: Deck, mass: float, low: float, high: float, points: int) -> list[str]:
    units = deck.units
    value = mass / units.mass
    fastest = max([deck.model.k_0 / mass, *_compute_inner_rates(deck, high)]) * units.time**2
    # the eigensolver returns the modes nearest to an eigenvalue of 1: the dummies must be further
    stiffness = 100 * max(fastest, 1.0) * value
    return [
        "*ELEMENT, TYPE=MASS, ELSET=BLOCK",
        "5000, 2",
        "*MASS, ELSET=BLOCK",
        text(value),
        *_write_dummies(stiffness, value),
        "*NSET, NSET=MOVING",
        "2",
        "*STEP",
        "*FREQUENCY, STORAGE=YES",
        f"{1 + deck.model.arms}",
        "*END STEP",
        "*STEP",
        "*STEADY STATE DYNAMICS",
        f"{text(units.frequency(low))}, {text(units.frequency(high))}, {points}, 1.",
        "*CLOAD",
        "2, 1, 1.",
        "*NODE PRINT, NSET=MOVING",
        "U",
        "*END STEP",
    ]


def _write_dummies(stiffness: float, mass: float) -> list[str]:
    """Masses along x, each on a spring of its own along y."""
    numbers = [1000 + i for i in range(1, 1 + _PADDING)]
    return [
        "*NODE, NSET=DUMMIES",
        *(f"{n}, {n - 1000}., 10., 0." for n in numbers),
        "*NODE, NSET=FIXED",
        *(f"{n + 1000}, {n - 1000}., 11., 0." for n in numbers),
        "*ELEMENT, TYPE=SPRINGA, ELSET=DUMMY_K",
        *(f"{n}, {n}, {n + 1000}" for n in numbers),
        "*SPRING, ELSET=DUMMY_K",
        "",
        text(stiffness),
        "*ELEMENT, TYPE=MASS, ELSET=DUMMY_M",
        *(f"{n + 1000}, {n}" for n in numbers),
        "*MASS, ELSET=DUMMY_M",
        text(mass),
        "*BOUNDARY",
        "FIXED, 1, 3",
        "DUMMIES, 1, 1",
        "DUMMIES, 3, 3",
    ]
