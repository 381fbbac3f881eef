"""The virtual rig under force control."""

from __future__ import annotations

import json

import numpy as np
import pytest

import dashpot as dp
from dashpot.base.errors import DataError
from dashpot.extensions.curves.creep.fit import fit_creep as fit
from dashpot.extensions.curves.creep.simulation import simulate_creep
from dashpot.reading.write import write_relaxation
from dashpot.simulation.ground_truth import stamp, truth_json
from dashpot.simulation.rig_errors import Rig
from dashpot.simulation.robot import Axis
from dashpot.solids.demo_seals import PAPER
from dashpot.workflow.bench_tests import read_test


def test_simulated_creep_responds_to_the_applied_force() -> None:
    truth = simulate_creep(PAPER, hold_time=10, rig=Rig(rate=200)).truth
    time = np.arange(len(truth.force)) / 200
    assert truth.displacement == pytest.approx(PAPER.displacement(time, truth.force), abs=1e-15)
    assert truth.force[-1] == pytest.approx(1.0, abs=1e-3)
    assert truth.force.max() > 1.0  # the loop overshoots


def test_a_damped_loop_follows_without_overshoot() -> None:
    rig = Rig(axis=Axis(damping=2.0), rate=200)
    assert simulate_creep(PAPER, hold_time=10, rig=rig).truth.force.max() <= 1.0 + 1e-12


def test_a_recovery_takes_the_load_off() -> None:
    truth = simulate_creep(PAPER, hold_time=5, recovery_time=5, rig=Rig(rate=200)).truth
    assert truth.force[-1] == pytest.approx(0.0, abs=1e-3)


def test_without_noise_the_fit_is_the_seal() -> None:
    made = simulate_creep(PAPER, rig=Rig(rate=200).noise_free())
    result = fit(made.test)
    assert result.model.k == pytest.approx(PAPER.k, rel=1e-4)
    assert result.model.tau == pytest.approx(PAPER.tau, rel=1e-4)


def test_an_encoders_counts_and_a_drifting_cell_are_in_the_intervals() -> None:
    result = fit(simulate_creep(PAPER, hold_time=60, seed=0).test, arms=2)
    between = result.intervals()
    assert between["k_inf"][0] < PAPER.k_inf < between["k_inf"][1]
    for k, (low, high) in zip(PAPER.k, between["k"], strict=True):
        assert low < k < high


def test_what_is_written_is_read_as_a_creep_test(tmp_path) -> None:
    made = simulate_creep(PAPER, hold_time=5, rig=Rig(rate=100))
    path = tmp_path / "creep.csv"
    write_relaxation(made.test, path, comments=(*stamp(made.truth), "creep test"))
    read = read_test(path)
    assert isinstance(read, dp.CreepTest)
    assert read.force == pytest.approx(made.test.force)
    assert read.source is not None
    assert read.source.simulated
    assert json.loads(truth_json(made.truth))["kind"] == "creep"


@pytest.mark.parametrize("wrong", [{"load": 0.0}, {"hold_time": -1.0}, {"recovery_time": -1.0}])
def test_what_makes_no_sense_is_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(DataError, match="expected a number"):
        simulate_creep(PAPER, **wrong)
