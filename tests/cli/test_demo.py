"""The demonstration, and its story's second answer: a cold test instead of a hammer."""

from __future__ import annotations

import json

import numpy as np
import pytest
from kit.shell import ran, run_json

from dashpot.datamodel.machine import Machine
from dashpot.fitting.prediction_bounds import unresolved_arm_band
from dashpot.reading.readers.relaxation import read_relaxation
from dashpot.workflow.json_archive import from_json


def test_demo_writes_two_files_and_the_page_of_their_report(tmp_path):
    done = ran("demo", "-o", tmp_path / "demo")
    assert done.exit_code == 0
    page = tmp_path / "demo" / "report.html"
    assert {path.name for path in page.parent.iterdir()} == {
        "seal_8mm.csv",
        "hammer.csv",
        page.name,
    }
    assert done.stdout.startswith("Use: ")
    assert done.stderr.splitlines()[-2] == f"wrote {page}"
    again = ran("demo", "-o", tmp_path / "demo", "--overwrite")
    assert again.stdout == done.stdout


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_cold_test_answers_the_puzzle_without_the_hammer(tmp_path, seed):
    seal = run_json("demo", "--story", "-o", tmp_path, "--seed", seed)["seals"]["broad"]
    comparison, cold = seal["comparison"], seal["cold"]["comparison"]
    assert comparison["predicted_damping"] / comparison["measured_damping"] < 0.5
    assert cold["predicted_hz"] == pytest.approx(cold["measured_hz"], rel=0.01)
    assert cold["predicted_damping"] == pytest.approx(cold["measured_damping"], rel=0.1)
    tests = [read_relaxation(tmp_path / f"broad_{name}.csv") for name in ("relaxation", "cold")]
    assert [test.specimen.temperature for test in tests] == [296.15, 273.15]
    fit = from_json(json.dumps(seal["cold"]["fit"]))

    def decades(tests):
        low, high = unresolved_arm_band(fit, tests, [12.71]).loss_factor[:, 0]
        assert low < 0.0561894 < high
        return np.log10(high / low)

    # a force that may be 5 ms late looks like less loss: two clocks leave most of what is open
    ready = [test.prepare() for test in tests]
    assert decades(ready) < 0.15 * decades(ready[:1])
    clock = [test.prepare(machine=Machine(sync="1ms")) for test in tests]
    assert decades(clock) < np.log10(1.3)
    assert decades(clock) < 0.5 * decades(ready)
    # one clock, but the warm test alone would not do
    assert decades(clock[:1]) > 1
