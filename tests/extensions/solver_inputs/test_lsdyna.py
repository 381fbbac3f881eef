"""An independent reader of LS-DYNA keywords finds the network of the model in our deck."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from dashpot.export import TARGETS, UNIT_SYSTEMS
from dashpot.solids.maxwell import GeneralizedMaxwell


@pytest.mark.parametrize("units", list(UNIT_SYSTEMS))
def test_ansys_dyna_core_reads_the_same_springs(paper_seal, units):
    """In an environment of its own; name its Python in DASHPOT_DYNA."""
    python = os.environ.get("DASHPOT_DYNA", sys.executable)
    model, unit = paper_seal + GeneralizedMaxwell(0.0, b=2.0), UNIT_SYSTEMS[units]
    run = subprocess.run(
        [python, str(Path(__file__).with_name("read_with_dyna_core.py"))], check=False,
        input=TARGETS["lsdyna"](model, units=units), capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    if "No module named 'ansys" in run.stderr:
        pytest.skip("ansys-dyna-core is not installed: set DASHPOT_DYNA to a Python that has it")
    assert run.returncode == 0, run.stderr
    read = json.loads(run.stdout)
    spring, damper, *arms = read["materials"]
    assert [title for title, _ in read["materials"]] == [
        "*MAT_SPRING_ELASTIC", "*MAT_DAMPER_VISCOUS", *["*MAT_SPRING_MAXWELL"] * model.arms
    ]  # fmt: skip
    assert spring[1]["k"] == pytest.approx(unit.stiffness(model.k_inf), rel=1e-5)
    assert damper[1]["dc"] == pytest.approx(unit.damping(model.b), rel=1e-5)
    for (_, values), k, tau in zip(arms, model.k, model.tau, strict=True):
        assert values["k0"] == pytest.approx(unit.stiffness(k), rel=1e-5)
        assert values["ki"] == 0
        assert values["beta"] == pytest.approx(unit.time / tau, rel=1e-5)
    assert read["elements"] == [[1, 2, 1]] * (2 + model.arms)
