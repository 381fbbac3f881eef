"""A reader of Modelica flattens our model to the equations of the solid."""

from __future__ import annotations

import numpy as np
import pytest

from dashpot.export import TARGETS, UNIT_SYSTEMS
from dashpot.solids.maxwell import GeneralizedMaxwell

pymoca = pytest.importorskip("pymoca", reason="no reader: pip install dashpot[solvers]")

LIBRARY = """
package Modelica package Mechanics package Translational
  package Interfaces
    connector Flange_a Real s; flow Real f; end Flange_a;
    connector Flange_b Real s; flow Real f; end Flange_b;
  end Interfaces;
  package Components
    model Spring
      parameter Real c;
      Interfaces.Flange_a flange_a; Interfaces.Flange_b flange_b; Real s_rel; Real f;
    equation
      f = c*s_rel; s_rel = flange_b.s - flange_a.s; flange_b.f = f; flange_a.f = -f;
    end Spring;
    model Damper
      parameter Real d;
      Interfaces.Flange_a flange_a; Interfaces.Flange_b flange_b;
      Real s_rel; Real v_rel; Real f;
    equation
      v_rel = der(s_rel); f = d*v_rel; s_rel = flange_b.s - flange_a.s;
      flange_b.f = f; flange_a.f = -f;
    end Damper;
  end Components;
end Translational; end Mechanics; end Modelica;
"""
"""What the Modelica Standard Library says of these (f: into the component)."""


def evaluate(node, values, s):
    """A node of the syntax tree, where every derivative is s times what it is of."""
    from pymoca import ast

    if isinstance(node, ast.Primary):
        return float(node.value)
    if isinstance(node, ast.ComponentRef):
        return values[node.name]
    operator = getattr(node.operator, "name", node.operator)
    parts = [evaluate(item, values, s) for item in node.operands]
    if operator == "der":
        return s * parts[0]
    if operator == "*":
        return np.prod(parts)
    if operator == "-" and len(parts) == 1:
        return -parts[0]
    assert operator in {"+", "-"}, operator
    return parts[0] + sum(parts[1:]) if operator == "+" else parts[0] - sum(parts[1:])


def stiffness_of(flat, s):
    """Force at flange b that moves it by one while flange a is held: the equations, solved."""
    names, expected = [], {}
    for name, symbol in flat.symbols.items():
        if "parameter" in symbol.prefixes:
            expected[name] = symbol.value
        else:
            names.append(name)
    inputs = {name: float(value.value) for name, value in expected.items() if "." not in name}
    expected = inputs | {n: evaluate(value, inputs, s) for n, value in expected.items() if "." in n}

    def residuals(motion):
        values = expected | dict(zip(names, motion, strict=True))
        result = [
            evaluate(e.left, values, s) - evaluate(e.right, values, s) for e in flat.equations
        ]
        return np.array([*result, values["flange_a.s"], values["flange_b.s"] - 1.0], complex)

    rest = residuals(np.zeros(len(names)))
    A = np.column_stack([residuals(unit) - rest for unit in np.eye(len(names))])
    motion, _, rank, _ = np.linalg.lstsq(A, -rest, rcond=None)
    assert rank == len(names)
    assert np.abs(A @ motion + rest).max() < 1e-6
    return motion[names.index("flange_b.f")]


@pytest.mark.parametrize("units", list(UNIT_SYSTEMS))
@pytest.mark.parametrize(
    "solid",
    [
        GeneralizedMaxwell(196.5, (117.5, 17.8), (59 / 117.5, 292.2 / 17.8)),
        GeneralizedMaxwell(1e3, (2e3,), (5e-3,), b=7.0),
        GeneralizedMaxwell(0.0, (30.0,), (0.1,), b=1.0),
        GeneralizedMaxwell(50.0),
    ],
    ids=["paper", "dashpot", "fluid", "spring"],
)
def test_the_flat_equations_have_the_stiffness_of_the_solid(solid, units):
    import pymoca.parser
    import pymoca.tree
    from pymoca import ast

    deck = TARGETS["modelica"](solid, units=units)
    tree = pymoca.parser.parse(LIBRARY + deck)
    assert tree is not None, "pymoca refuses it"
    name = "ViscoelasticMount"
    flat = pymoca.tree.flatten(tree, ast.ComponentRef.from_string(name)).classes[name]
    for omega in (0.1, 3.0, 80.0):
        force = stiffness_of(flat, 1j * omega)
        exact = complex(solid.complex_stiffness(omega=omega))
        assert force == pytest.approx(exact, rel=1e-8)


def test_parameters_bear_their_units(paper_seal):
    deck = TARGETS["modelica"](paper_seal, units="mm-t-s")
    assert '  parameter Real k_inf(unit="N/mm", min=0.0) = 0.1965 "equilibrium stiffness";' in deck
    assert "Components.Spring spring(c=1000.0*k_inf);" in deck
    assert "read only. pymoca" in deck
