"""OpenSees commands, Tcl or Python."""

from __future__ import annotations

from collections.abc import Sequence

from dashpot.export.deck import Deck, DeckText
from dashpot.export.deck_validation import target
from dashpot.export.unit_systems import text

FORMS = ("network", "network-tcl", "python", "tcl")
SUFFIX = "txt"
LOOPS_VERIFIED = (
    "verified: OpenSeesPy runs these commands in dashpot's tests; loops of several amplitudes have "
    "the energy and the secant of the model within 1e-3"
)
_INNER_NODE_OFFSET = 10
"""Difference of the number of the first inner node from the first tag."""

Command = list[str]


@target(*FORMS)
def opensees(
    deck: Deck,
    *,
    first_tag: int = 1,
) -> DeckText:
    r"""OpenSees network of springs and dashpots, or one uniaxial material.

    ``"network"`` (Python) and ``"network-tcl"`` are zeroLength elements between two nodes: one of
    k_inf, and in each arm an Elastic and a Viscous one with an inner node between. It is right
    under every transient integrator that the tests run. In a Static analysis the arms carry no
    force, because a Viscous material has no rate there. ``"python"`` and ``"tcl"`` are Elastic,
    Maxwell and Viscous,
    joined by Parallel: one material, the last, without nodes of its own. Under HHT and
    GeneralizedAlpha each relaxation time of Maxwell is 1/alpha too long at any step, because
    these integrators scale the step. (A Series of Elastic and Viscous is not a Maxwell arm in
    OpenSees: its force is wrong.)

    Sliders are ElasticPP, a cubic spring is ElasticMultiLinear.

    Parameters
    ----------
    solid, units, specimen, allow
        As in :func:`dashpot.export.nastran`.
    form : str
        For OpenSeesPy (``"network"``, ``"python"``) or the interpreter.
    first_tag : int
        Tag of the first material and element; the others follow, and inner nodes from ten after it.
    """
    from dashpot.extensions.solver_inputs.procedures import format_procedures

    network = deck.form.startswith("network")
    tcl = deck.form.endswith("tcl")
    cards = (
        _write_network(deck, first_tag, tcl=tcl)
        if network
        else _write_material(deck, first_tag, tcl=tcl)
    )
    verification, *further_remarks = (
        [LOOPS_VERIFIED]
        if deck.nonlinear_elements.parts
        else format_procedures("opensees", deck.form, with_dashpot=deck.b > 0)
    )
    tag = first_tag + len(_list_materials(deck))
    remarks = _NODES if network else (f"material {tag} is the model; {_MATERIAL[0]}", _MATERIAL[1])
    return deck.format_text(
        "#",
        f"{'network of zeroLength elements' if network else 'uniaxial material'} for OpenSees",
        cards,
        verified=verification,
        remarks=[*further_remarks, *remarks],
    )


def _list_linear_materials(deck: Deck) -> list[Command]:
    """Materials that need no inner node: k_inf, b, sliders and a cubic spring."""
    materials = []
    if deck.k_inf > 0:
        materials.append(["Elastic", text(deck.k_inf)])
    if deck.b > 0:
        materials.append(["Viscous", text(deck.b), "1."])
    return materials


def _list_nonlinear_materials(deck: Deck) -> list[Command]:
    materials = [["ElasticPP", text(k), text(x)] for k, _, x in deck.nonlinear_elements.sliders]
    if deck.nonlinear_elements.k3:
        x, F = zip(*deck.nonlinear_elements.compute_symmetric_curve(), strict=True)
        materials.append(
            ["ElasticMultiLinear", "0.", "-strain", *map(text, x), "-stress", *map(text, F)]
        )
    return materials


def _list_materials(deck: Deck) -> list[Command]:
    # stiffness, viscosity, exponent of the dashpot, length
    arms = [["Maxwell", text(k), text(b), "1.", "1."] for k, _, b in deck.arms]
    return [*_list_linear_materials(deck), *arms, *_list_nonlinear_materials(deck)]


def _write_material(deck: Deck, first_tag: int, *, tcl: bool) -> list[str]:
    materials = _list_materials(deck)
    tags = [str(first_tag + i) for i in range(len(materials) + 1)]
    materials.append(["Parallel", *tags[:-1]])
    write = _format_tcl if tcl else _format_python
    return [
        *([] if tcl else _IMPORT),
        *(
            write("uniaxialMaterial", [kind, tag, *values])
            for tag, (kind, *values) in zip(tags, materials, strict=True)
        ),
    ]


def _write_network(deck: Deck, first_tag: int, *, tcl: bool) -> list[str]:
    """Return a material and an element for each spring and dashpot, and a node for each arm."""
    write = _format_tcl if tcl else _format_python
    ground, moving, direction = ("$ground", "$moving", "$direction") if tcl else _NAMES
    parts = [
        (material, ground, moving)
        for material in (*_list_linear_materials(deck), *_list_nonlinear_materials(deck))
    ]
    nodes = [str(first_tag + _INNER_NODE_OFFSET + j) for j in range(len(deck.arms))]
    for node, (k, _, b) in zip(nodes, deck.arms, strict=True):
        parts += [
            (["Viscous", text(b), "1."], ground, node),
            (["Elastic", text(k)], node, moving),
        ]
    cards = [*(_TCL_HEAD if tcl else _PYTHON_HEAD)]
    cards += [f"add_inner_node {node}" if tcl else f"add_inner_node({node})" for node in nodes]
    for tag, ((kind, *values), low, high) in enumerate(parts, start=first_tag):
        cards += [
            write("uniaxialMaterial", [kind, str(tag), *values]),
            write(
                "element", ["zeroLength", str(tag), low, high, "-mat", str(tag), "-dir", direction]
            ),
        ]
    return cards


_NODES = (
    "give ground, moving and direction of your own: two nodes at one place, which exist, and",
    "the direction of the force between them; inner nodes are held in all others",
)
_MATERIAL = (
    "in a zeroLength element it acts along one",
    "direction, force against displacement",
)
_NAMES = ("ground", "moving", "direction")
_IMPORT = ("import openseespy.opensees as ops", "")
_PYTHON_HEAD = (
    *_IMPORT,
    "ground, moving, direction = 1, 2, 1",
    "",
    "",
    "def add_inner_node(tag):",
    "    ops.node(tag, *ops.nodeCoord(moving))",
    "    ops.fix(tag, *(int(i != direction) for i in range(1, ops.getNDF()[0] + 1)))",
    "",
    "",
)
_TCL_HEAD = (
    "set ground 1",
    "set moving 2",
    "set direction 1",
    "proc add_inner_node {tag} {",
    "    global moving direction",
    "    eval node $tag [nodeCoord $moving]",
    "    set held {}",
    "    for {set i 1} {$i <= [getNDF]} {incr i} { lappend held [expr {$i != $direction}] }",
    "    eval fix $tag $held",
    "}",
)


def _format_argument(value: str) -> str:
    """Return an argument in Python syntax: kinds and flags are quoted, numbers and names not."""
    is_unquoted = (
        value in _NAMES or value[0].isdigit() or (value[0] == "-" and value[1:2].isdigit())
    )
    return value if is_unquoted else repr(value)


def _format_python(command: str, values: Sequence[str]) -> str:
    return f"ops.{command}({', '.join(map(_format_argument, values))})"


def _format_tcl(command: str, values: Sequence[str]) -> str:
    return " ".join([command, *values])
