"""CalculiX runs our deck: its FRF is the model's."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from kit.solvers import needs_ccx, read_printed, receptance, run_ccx

from dashpot.export import TARGETS, UNIT_SYSTEMS
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.vibration.mass_on_seals import predict_frf

pytestmark = needs_ccx


SEALS = {
    "table-1": (GeneralizedMaxwell(196.5, (117.5, 17.8), (59 / 117.5, 292.2 / 17.8)), 0.05202),
    "broad": (
        GeneralizedMaxwell(
            196.5,
            (117.5, 17.8, 20.0, 20.0, 20.0),
            (59 / 117.5, 292.2 / 17.8, 0.08, 0.016, 0.0032),
        ),
        0.0574,
    ),
    "maxwell-voigt": (GeneralizedMaxwell(1e4, (1e4,), (5e-3,), b=10.0), 1.0),
    "kelvin-voigt": (GeneralizedMaxwell(1e4, b=10.0), 1.0),
    "fluid": (GeneralizedMaxwell(0.0, (3e4, 3e4), (1e-4, 1.0), b=10.0), 5.0),
}


@pytest.mark.parametrize("seal", list(SEALS))
@pytest.mark.parametrize("units", list(UNIT_SYSTEMS))
def test_frf_within_1e_4_of_the_model(seal, units, tmp_path):
    model, mass = SEALS[seal]
    system = UNIT_SYSTEMS[units]
    deck = TARGETS["calculix"](
        model, units=units, mass=mass, frequency_range=(1.0, 30.0), points=200
    )
    f, u = receptance(run_ccx(deck, tmp_path), node=2)
    f = f / system.time
    assert f[0] == pytest.approx(1.0)
    assert f[-1] == pytest.approx(30.0)
    assert len(f) >= 199
    exact = predict_frf(model, mass=mass, frequency=f, kind="receptance").value
    error = np.abs(u * system.stiffness(1.0) / exact - 1)
    print(f"{seal} {units}: largest relative error of the FRF {error.max():.2e}")
    assert error.max() < 1e-4


PRESSED = (1.6e-3, 2e-3, 8e-3)
"""m, at 2 mm/s: where the force is compared."""


@pytest.mark.parametrize("target", ["calculix", "abaqus"])
@pytest.mark.parametrize("units", list(UNIT_SYSTEMS))
def test_pressed_far_it_pushes_as_the_model_does(target, units, paper_seal, tmp_path):
    """Nodes 1 mm apart would pass each other, and push the other way, beyond 1 mm."""
    unit, steps = UNIT_SYSTEMS[units], 400
    speed, end = 2e-3, PRESSED[-1]
    deck = TARGETS[target](paper_seal, units=units)
    t = end / speed / unit.time
    deck += "\n".join([
        "*BOUNDARY", "1, 1, 3", "2, 2, 3", "*AMPLITUDE, NAME=RAMP", f"0., 0., {t!r}, 1.",
        "*NSET, NSET=MOVING", "2", f"*STEP, NLGEOM, INC={2 * steps}", "*DYNAMIC, DIRECT",
        f"{t / steps!r}, {t!r}", "*BOUNDARY, AMPLITUDE=RAMP", f"2, 1, 1, {-end / unit.length!r}",
        "*NODE PRINT, NSET=MOVING", "U, RF", "*END STEP", "",
    ])  # fmt: skip
    if target == "abaqus":  # ccx wants a mass where something moves; Abaqus needs none
        deck = deck.replace("*AMPLITUDE", "\n".join([
            "*ELEMENT, TYPE=MASS, ELSET=M", "5001, 11", "5002, 12", "*MASS, ELSET=M",
            f"{1e-9 / unit.mass!r}", "*AMPLITUDE",
        ]), 1)  # fmt: skip
    dat = run_ccx(deck, tmp_path)
    printed, pushed = (read_printed(dat, block, 2) for block in ("disp", "forces"))
    at = [round(x / end * steps) - 1 for x in PRESSED]
    time = np.array(PRESSED) / speed
    exact = -paper_seal.ramp_hold_force(time, depth=end, ramp_time=end / speed)
    assert printed[at] * unit.length == pytest.approx(-np.array(PRESSED), rel=1e-6)
    error = np.abs(pushed[at] * unit.force / exact - 1)
    print(f"{target} {units}: largest relative error of the force {error.max():.1e}")
    assert error.max() < 1e-5


def test_ccx_network_has_its_static_stiffness(paper_seal, tmp_path):
    """The fragment under a steady pull: only k_inf answers."""
    fragment = TARGETS["calculix"](paper_seal, units="mm-t-s")
    deck = fragment + "\n".join(
        ["*STEP", "*STATIC", "*CLOAD", "2, 1, 1.", "11, 1, 0.", "*NODE PRINT, NSET=N", "U",
         "*END STEP", ""]
    )  # fmt: skip
    deck = deck.replace("*STEP\n", "*NSET, NSET=N\n2\n*STEP\n")
    (line,) = [row for row in run_ccx(deck, tmp_path).splitlines() if row.split()[:1] == ["2"]]
    assert float(line.split()[1]) == pytest.approx(1 / 0.1965, rel=1e-6)


def convert_by_abq2ccx(deck: str, folder: Path) -> str:
    """Return an Abaqus input as the converter abq2ccx writes it for CalculiX.

    DASHPOT_ABQ2CCX names the program, of an environment of its own.
    """
    program = os.environ.get("DASHPOT_ABQ2CCX", "abq2ccx")
    if shutil.which(program) is None:
        pytest.skip("abq2ccx is not installed: pip install abq2ccx, and set DASHPOT_ABQ2CCX")
    (folder / "abaqus.inp").write_text(deck)
    command = [program, "abaqus.inp", "-o", "converted.inp", "--strict"]
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return (folder / "converted.inp").read_text()


@pytest.mark.parametrize("convert", [None, convert_by_abq2ccx], ids=["direct", "abq2ccx"])
def test_the_abaqus_network_is_read_by_ccx(paper_seal, tmp_path, convert):
    """CalculiX reads the Abaqus dialect: the same network, checked for its syntax and statics."""
    network = TARGETS["abaqus"](paper_seal, units="mm-t-s")
    steps = [
        "*NSET, NSET=MOVING", "2", "*BOUNDARY", "1, 1, 3", "2, 2, 3",
        "*STEP", "*STATIC", "*CLOAD", "2, 1, 1.", "*NODE PRINT, NSET=MOVING", "U", "*END STEP", "",
    ]  # fmt: skip
    deck = network + "\n".join(steps)
    dat = run_ccx(deck if convert is None else convert(deck, tmp_path), tmp_path)
    (line,) = [row for row in dat.splitlines() if row.split()[:1] == ["2"]]
    assert float(line.split()[1]) == pytest.approx(1 / 0.1965, rel=1e-6)
