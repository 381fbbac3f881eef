"""Solvers that run our decks: CalculiX, and OpenSees in a process of its own."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

needs_ccx = pytest.mark.skipif(
    shutil.which("ccx") is None, reason="CalculiX is not installed: apt-get install calculix-ccx"
)


def run_ccx(deck: str, folder: Path) -> str:
    (folder / "deck.inp").write_text(deck)
    run = subprocess.run(
        ["ccx", "-i", "deck"], cwd=folder, capture_output=True, text=True, timeout=120, check=False
    )
    assert run.returncode == 0, run.stdout[-2000:]
    return (folder / "deck.dat").read_text()


def read_printed(dat: str, block: str, node: int) -> np.ndarray:
    """First components of a node in the blocks of one kind."""
    result, wanted = [], False
    for line in dat.splitlines():
        if line.lstrip().startswith(("displacements", "forces")):
            wanted = line.lstrip().startswith(block)
        elif wanted and line.split()[:1] == [str(node)]:
            result.append(float(line.split()[1]))
    return np.array(result)


def receptance(dat: str, node: int) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies, in full, and U1 of a node: real block, then imaginary block, at each."""
    frequency, blocks = [], []
    for line in dat.splitlines():
        if "F O R   F R E Q U E N C Y" in line:
            frequency.append(float(re.findall(r"([\d.E+-]+) \(CYCLES", line)[0]))
        elif line.lstrip().startswith("displacements"):
            blocks.append(None)
        elif blocks and blocks[-1] is None and line.split()[:1] == [str(node)]:
            blocks[-1] = float(line.split()[1])
    real, imaginary = np.array(blocks[::2]), np.array(blocks[1::2])
    assert len(real) == len(imaginary) == len(frequency)
    return np.array(frequency), real + 1j * imaginary


RUN = """
import json, sys
task = json.load(sys.stdin)
try:
    import openseespy.opensees as ops
except (ImportError, RuntimeError) as error:
    print(json.dumps({"missing": str(error)}))
    sys.exit()
ops.model("basic", "-ndm", 1, "-ndf", 1)
ops.node(1, 0.0)
ops.node(2, 0.0)
ops.fix(1, 1)
exec(task["deck"])
if task["material"]:  # and 0 of a network, which brings its elements
    ops.element("zeroLength", 1, 1, 2, "-mat", task["material"], "-dir", 1)
ops.timeSeries("Path", 1, "-time", *task["path_time"], "-values", *task["path_value"])
ops.pattern("Plain", 1, 1)
ops.sp(2, 1, 1.0)
ops.constraints("Lagrange")
ops.numberer("Plain")
ops.system("FullGeneral")
ops.test("NormDispIncr", 1e-12, 20)
ops.algorithm("Newton")
ops.integrator("BackwardEuler", 0)
ops.analysis("Transient")
force = []
for _ in range(task["steps"]):
    assert ops.analyze(1, task["dt"]) == 0
    moving = [each for each in ops.getEleTags() if 2 in ops.eleNodes(each)]
    force.append(sum(ops.eleResponse(each, "material", 1, "stress")[0] for each in moving))
print(json.dumps({"force": force}))
"""


def run_opensees(task: dict, script: str = RUN) -> np.ndarray:
    """In a process of its own: OpenSees prints and keeps its model as global state.

    DASHPOT_OPENSEES names a Python that has it, where that of the tests does not.
    """
    python = os.environ.get("DASHPOT_OPENSEES", sys.executable)
    run = subprocess.run(
        [python, "-c", script],
        input=json.dumps(task), capture_output=True, text=True, timeout=120, check=False,
    )  # fmt: skip
    assert run.returncode == 0, run.stderr
    document = json.loads(next(line for line in run.stdout.splitlines() if line.startswith("{")))
    if "missing" in document:
        pytest.skip(f"OpenSeesPy does not run here ({document['missing']}): pip install openseespy")
    return np.array(document["force"])


PULSE = (
    RUN[: RUN.index("ops.timeSeries")]
    + """
ops.mass(2, task["mass"])
ops.timeSeries("Path", 1, "-time", *task["path_time"], "-values", *task["path_value"])
ops.pattern("Plain", 1, 1)
ops.load(2, 1.0)
ops.constraints("Plain")
ops.numberer("Plain")
ops.system("FullGeneral")
ops.test("NormDispIncr", 1e-14, 20)
ops.algorithm("Newton")
ops.integrator("Newmark", 0.5, 0.25)
ops.analysis("Transient")
moved = []
for _ in range(task["steps"]):
    assert ops.analyze(1, task["dt"]) == 0
    moved.append(ops.nodeDisp(2, 1))
print(json.dumps({"force": moved}))
"""
)
