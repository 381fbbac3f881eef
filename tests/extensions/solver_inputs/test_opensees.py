"""OpenSees runs our material: its ramp and hold is equation 5."""

from __future__ import annotations

import re

import numpy as np
import pytest
from kit.solvers import PULSE, run_opensees

from dashpot.export import TARGETS
from dashpot.extensions.systems.multibody import Mount, System, point_mass
from dashpot.extensions.systems.time_response import respond
from dashpot.solids.maxwell import GeneralizedMaxwell


@pytest.mark.parametrize("b", [0.0, 5.0])
def test_ramp_and_hold_is_equation_5(paper_seal, b):
    """8 mm in 1 s, held 40 s: the force within 1e-5 of the largest, every 10 ms."""
    model = paper_seal + GeneralizedMaxwell(0.0, b=b)
    deck = TARGETS["opensees"](model, units="mm-t-s", form="python", first_tag=5)
    material = 5 + 3 + (b > 0)
    dt, steps = 0.01, 4100
    force = run_opensees(
        {
            "deck": deck, "material": material, "dt": dt, "steps": steps,
            "path_time": [0.0, 1.0, 1000.0], "path_value": [0.0, 8.0, 8.0],
        }
    )  # fmt: skip
    t = dt * np.arange(1, steps + 1)
    exact = model.ramp_hold_force(t, depth=8e-3, ramp_time=1.0)
    error = np.abs(force - exact) / exact.max()
    if b > 0:  # the integrator needs two steps to know the velocity after a corner
        error = error[(t > 2.5 * dt) & ~((t > 1 - dt / 2) & (t < 1 + 2.5 * dt))]
    print(f"b = {b}: peak {force.max():.5f} N, largest error {error.max():.2e}")
    assert error.max() < 1e-5


def test_a_struck_block_moves_as_ours_does(paper_seal):
    """Transient of a mass on the material: Newmark's own error, which falls with dt squared."""
    mass, seconds = 0.05202, 0.5
    system = System((point_mass("block", mass),), (Mount(paper_seal, ("block", "ground")),))
    errors = []
    for dt in (1e-3, 2.5e-4):
        t = dt * np.arange(round(seconds / dt) + 1)
        pulse = {"path_time": [0.0, 0.005, 0.01, 10.0], "path_value": [0.0, 2.0, 0.0, 0.0]}
        variant = run_opensees(
            {
                "deck": TARGETS["opensees"](paper_seal, units="SI", form="python"),
                "material": 4, "mass": mass,
                "dt": dt, "steps": len(t) - 1,
            } | pulse,
            script=PULSE,
        )  # fmt: skip
        force = np.interp(t, pulse["path_time"], pulse["path_value"])
        ours = respond(system, t, force={"block.z": force}).displacement[0]
        errors.append(np.abs(variant - ours[1:]).max() / np.abs(ours).max())
    print(f"error of OpenSees against ours: {errors[0]:.2e} at 1 ms, {errors[1]:.2e} at 0.25 ms")
    assert errors[1] < 5e-3
    assert errors[0] / errors[1] == pytest.approx(16, rel=0.2)


IN_SPACE = """
import json, sys
task = json.load(sys.stdin)
try:
    import openseespy.opensees as ops
except (ImportError, RuntimeError) as error:
    print(json.dumps({"missing": str(error)}))
    sys.exit()
ops.model("basic", "-ndm", 3, "-ndf", 6)
ops.node(1, 1.0, 2.0, 3.0)
ops.node(2, 1.0, 2.0, 3.0)
ops.fix(1, 1, 1, 1, 1, 1, 1)
ops.fix(2, 1, 0, 1, 1, 1, 1)
exec(task["deck"])
ops.timeSeries("Path", 1, "-time", 0.0, 1.0, 1000.0, "-values", 0.0, 8.0, 8.0)
ops.pattern("Plain", 1, 1)
ops.sp(2, 2, 1.0)
ops.constraints("Transformation")
ops.numberer("Plain")
ops.system("FullGeneral")
ops.test("NormDispIncr", 1e-12, 20)
ops.algorithm("Newton")
ops.integrator("TRBDF2")
ops.analysis("Transient")
force = []
for _ in range(200):
    assert ops.analyze(1, 0.01) == 0
    ops.reactions()
    force.append(-ops.nodeReaction(1, 2))
print(json.dumps({"force": force}))
"""


def test_the_network_stands_in_space_along_any_direction(paper_seal):
    """Six freedoms at a node, the force along the second."""
    deck = TARGETS["opensees"](paper_seal, units="mm-t-s", first_tag=5)
    assert "add_inner_node(15)" in deck
    deck = deck.replace("direction = 1, 2, 1", "direction = 1, 2, 2")
    force = run_opensees({"deck": deck}, script=IN_SPACE)
    exact = paper_seal.ramp_hold_force(0.01 * np.arange(1, 201), depth=8e-3, ramp_time=1.0)
    assert np.abs(force - exact).max() / exact.max() < 1e-5


def test_python_and_tcl_build_the_same_network(paper_seal):
    python, tcl = (
        TARGETS["opensees"](paper_seal, units="SI", form=form)
        for form in ("network", "network-tcl")
    )
    calls = [
        re.sub(r"[(),']", " ", line.removeprefix("ops.")).split()
        for line in python.splitlines()
        if re.match(r"ops\.|add_", line)
    ]
    commands = [
        line.replace("$", "").split()
        for line in tcl.splitlines()
        if re.match("uniaxial|element|add_", line)
    ]
    assert calls == commands
    assert len(calls) == 2 + 2 * (1 + 2 * 2)


def test_python_and_tcl_say_the_same(paper_seal):
    model = paper_seal + GeneralizedMaxwell(0.0, b=2.0)
    python = TARGETS["opensees"](model, units="SI", form="python").splitlines()
    tcl = TARGETS["opensees"](model, units="SI", form="tcl").splitlines()
    calls = [line for line in python if line.startswith("ops.")]
    commands = [line for line in tcl if not line.startswith("#")]
    words = [
        line.removeprefix("ops.").replace("(", " ").replace(")", "").replace("'", "")
        .replace(",", "").split()
        for line in calls
    ]  # fmt: skip
    assert words == [command.split() for command in commands]
    assert commands[-1].split()[:3] == ["uniaxialMaterial", "Parallel", "5"]
