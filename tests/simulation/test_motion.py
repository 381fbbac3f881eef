"""A recorded or planned motion on the virtual rig, softening, a load cell that warms up."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from kit.shell import ran

import dashpot as dp
from dashpot.base.errors import DataError
from dashpot.extensions.materials.cld.preprocess import cld
from dashpot.extensions.materials.cld.read import read_cld
from dashpot.reading.write import write_trajectory
from dashpot.simulation.relaxation import simulate_motion, simulate_relaxation, soften_motion
from dashpot.simulation.rig_errors import Climate, Rig
from dashpot.simulation.robot import planned_trajectory
from dashpot.solids.demo_seals import BROAD, PAPER
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.workflow.json_archive import to_json


def triangles(cycles: int, *, depth: float = 8e-3, half: float = 2.0) -> dp.files.Trajectory:
    time = np.arange(round((2 * cycles * half + 1) * 100)) / 100.0
    up = np.interp(
        time, 0.5 + half * np.arange(2 * cycles + 1), depth * (np.arange(2 * cycles + 1) % 2)
    )
    return dp.files.Trajectory(time, up)


def test_a_planned_test_replayed_is_the_test_that_was_planned():
    sent = planned_trajectory(depth=8e-3, ramp_time=1.0, hold_time=4.0, baseline=1.5)
    quiet = Rig().noise_free()
    replayed = simulate_motion(PAPER, sent, rig=quiet).test
    direct = simulate_relaxation(PAPER, depth=8e-3, ramp_time=1.0, hold_time=4.0, rig=quiet).test
    np.testing.assert_allclose(replayed.displacement, direct.displacement, atol=1e-12)
    np.testing.assert_allclose(replayed.force, direct.force, atol=1e-9)


def test_a_record_can_be_replayed():
    # what was recorded is sent again: late by the loop's own lag, 2 zeta / omega, and no more
    first = simulate_relaxation(PAPER, hold_time=4.0, rig=Rig().noise_free()).test
    again = simulate_motion(
        PAPER, dp.files.Trajectory(first.time, first.displacement), rig=Rig().noise_free()
    ).test
    middle = (first.displacement > 3e-3) & (first.displacement < 5e-3)
    late = (first.displacement - again.displacement)[middle] / 8e-3
    np.testing.assert_allclose(late, 2 * 0.6 / (2 * np.pi * 6), atol=1.5e-3)
    assert again.displacement[-1] == pytest.approx(first.displacement[-1], abs=1e-6)


def test_softening_is_12_percent_of_what_cycles_bring_in_the_end():
    # 1 - 0.12 (1 - e^(-(n - 1)/1.5)) in cycle n
    x = np.tile(np.concatenate([np.linspace(0, 1, 50), np.linspace(1, 0, 50)]), 4)
    part = soften_motion(x, 0.12)
    deep = part[50::100]
    expected = 1 - 0.12 * (1 - np.exp(-np.arange(4) / 1.5))
    np.testing.assert_allclose(deep, expected, rtol=1e-12)
    assert part[0] == 1.0
    # what is not let go has no second cycle: half a release counts for nothing
    waves = np.concatenate(
        [np.linspace(0, 1, 50), np.linspace(1, 0.06, 50), np.linspace(0.06, 1, 50)]
    )
    np.testing.assert_array_equal(soften_motion(waves, 0.12), 1.0)


@pytest.mark.parametrize("share", [-0.01, 1.0])
def test_a_softening_that_leaves_nothing_is_refused(share: float):
    assert Rig(softening=0.99).softening == 0.99
    with pytest.raises(DataError, match="expected a share from 0 to below 1"):
        Rig(softening=share)


def test_a_load_cell_warms_up():
    rig = replace(Rig().noise_free(), warming=0.1, warming_time=5.0)
    made = simulate_relaxation(PAPER, hold_time=10.0, rig=rig)
    variant = made.test.force - made.truth.force
    np.testing.assert_allclose(variant, 0.1 * (1 - np.exp(-made.test.time / 5.0)), atol=1e-12)


def test_the_temperature_of_a_motion_is_stated():
    made = simulate_motion(BROAD, triangles(1), climate=Climate(273.15))
    assert made.test.specimen.temperature == 273.15
    assert made.truth.model == Climate(273.15).shift_seal(BROAD)


@pytest.mark.once
def test_cycles_of_a_seal_that_softens_are_read_as_such(tmp_path):
    write_trajectory(triangles(4), tmp_path / "cycles.csv")
    spring = dp.GeneralizedMaxwell(200.0, (1e-3,), (1e-3,))
    (tmp_path / "spring.json").write_text(to_json(spring))
    words = "simulate motion --noise-free --softening 0.12 --seal spring.json"
    with pytest.MonkeyPatch.context() as here:
        here.chdir(tmp_path)
        made = ran(*words.split(), "--follow", "cycles.csv", "-o", "cld.csv")
        assert made.exit_code == 0, made.output
        result = cld(read_cld("cld.csv"))
    # of a spring nothing else changes: the fourth carries 1 - 0.12 (1 - e^-2) of the first
    assert result.softening == pytest.approx(0.12 * (1 - np.exp(-2)), abs=1e-4)


def test_a_file_that_leaves_a_question_open_is_sent_to_inspect(tmp_path):
    # the options that answer it are those of other commands
    (tmp_path / "f.csv").write_text("time [s],force [N]\n0,1\n1,2\n2,3\n")
    done = ran("simulate", "motion", "--follow", tmp_path / "f.csv", "-o", tmp_path / "o.csv")
    assert done.exit_code == 2
    assert "give it a header such as 'time [s], displacement [mm]" in done.output
    assert "--column" not in done.output


def test_a_seal_remembers_its_motion_and_never_pulls():
    seal = GeneralizedMaxwell(100.0, (50.0,), (1.0,))
    made = simulate_motion(seal, triangles(1), rig=Rig().noise_free())
    exact = seal.force(made.test.time, made.truth.displacement)
    assert exact.min() < -0.1  # a solid that was glued to the plate would pull
    np.testing.assert_allclose(made.truth.force, np.maximum(exact, 0.0), atol=1e-9)
