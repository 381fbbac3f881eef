"""Modelica model of springs and dampers."""

from __future__ import annotations

from dashpot.export.deck import Deck, DeckText
from dashpot.export.deck_validation import target
from dashpot.export.unit_systems import text

FORMS = ("translational",)
SUFFIX = "mo"
VERIFICATION_NOTE = (
    "not solver-verified: read only. pymoca 0.12 flattens such a model in dashpot's tests, with "
    "Spring and Damper as the Modelica Standard Library defines them, to the stiffness of the solid"
)
_LIBRARY = "Modelica.Mechanics.Translational"


@target(*FORMS)
def modelica(
    deck: Deck,
) -> DeckText:
    r"""Modelica model of springs and dampers between two translational flanges.

    One spring :math:`k_\infty` and one damper b, where there are such, beside arms of a spring
    :math:`k_j` and a damper :math:`k_j \tau_j` in series. The components are those of the Modelica
    Standard Library, 3.2 or later, whose flanges are in m and N: parameters are in deck units, and
    the components take them with their factor.

    Parameters are those of :func:`dashpot.export.nastran`.
    """
    length, _, time, force, _ = deck.units.words
    stiffness, damping = f"{force}/{length}", f"{force}.{time}/{length}"
    by_stiffness = _format_factor(deck.units.force / deck.units.length)
    by_damping = _format_factor(deck.units.force * deck.units.time / deck.units.length)
    parameters, components, connections = [], [], []
    if deck.k_inf > 0:
        parameters.append(
            _format_parameter("k_inf", stiffness, deck.k_inf, "equilibrium stiffness")
        )
        components.append(f"  {_LIBRARY}.Components.Spring spring(c={by_stiffness}k_inf);")
        connections += _connect("flange_a", "spring", "flange_b")
    if deck.b > 0:
        parameters.append(_format_parameter("b", damping, deck.b, "parallel dashpot"))
        components.append(f"  {_LIBRARY}.Components.Damper damper(d={by_damping}b);")
        connections += _connect("flange_a", "damper", "flange_b")
    for j, (k, tau, _) in enumerate(deck.arms, start=1):
        parameters += [
            _format_parameter(f"k_{j}", stiffness, k, f"stiffness of arm {j}"),
            _format_parameter(f"tau_{j}", time, tau, f"relaxation time of arm {j}"),
        ]
        components += [
            f"  {_LIBRARY}.Components.Spring spring_{j}(c={by_stiffness}k_{j});",
            f"  {_LIBRARY}.Components.Damper damper_{j}(d={by_damping}k_{j}*tau_{j});",
        ]
        connections += [
            f"  connect(flange_a, damper_{j}.flange_a);",
            f"  connect(damper_{j}.flange_b, spring_{j}.flange_a);",
            f"  connect(spring_{j}.flange_b, flange_b);",
        ]
    return deck.format_text(
        "//",
        "Modelica model of springs and dampers",
        [
            'model ViscoelasticMount "springs and dampers of a seal"',
            *parameters,
            f'  {_LIBRARY}.Interfaces.Flange_a flange_a "ground side";',
            f'  {_LIBRARY}.Interfaces.Flange_b flange_b "moving side";',
            *components,
            "equation",
            *connections,
            "end ViscoelasticMount;",
        ],
        verified=VERIFICATION_NOTE,
        remarks=[
            "connect the flanges; the dampers rest as long as nothing moves: start there, or",
            "initialise their s_rel, of which each arm has one",
        ],
    )


def _format_factor(si: float) -> str:
    """Return the factor of a unit to SI; empty if it is 1."""
    return "" if si == 1 else f"{text(si)}*".replace(".*", ".0*")


def _format_parameter(name: str, unit: str, value: float, description: str) -> str:
    number = text(value)
    number = number.replace(".e", ".0e") if ".e" in number else number
    number += "0" * number.endswith(".")
    return f'  parameter Real {name}(unit="{unit}", min=0.0) = {number} "{description}";'


def _connect(a: str, component: str, b: str) -> list[str]:
    return [
        f"  connect({a}, {component}.flange_a);",
        f"  connect({component}.flange_b, {b});",
    ]
