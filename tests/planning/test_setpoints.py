"""The planned test as a list that a controller takes."""

from __future__ import annotations

import numpy as np
import pytest
from kit.shell import ran

import dashpot as dp
from dashpot.base.errors import DataError
from dashpot.reading.write import write_trajectory
from dashpot.simulation.robot import planned_trajectory

USUAL = {"depth": "8mm", "ramp_time": "1s", "hold_time": "40s", "baseline": "1s"}


def test_the_ramp_has_101_set_points_and_its_ends_are_exact():
    motion = planned_trajectory(**USUAL)
    assert len(motion.time) == 100 + 101 + 4000
    # R1: (0,0,0) -> (0,0,-8), dt = 10 ms: 101 points, last exact
    ramp = (motion.time >= 1.0) & (motion.time <= 2.0)
    assert ramp.sum() == 101
    assert motion.position[ramp][0].tolist() == [0.0, 0.0, 0.0]
    assert motion.position[ramp][-1].tolist() == [0.0, 0.0, -8e-3]
    assert motion.time[-1] == 42.0
    np.testing.assert_array_equal(motion.position[motion.time >= 2.0, 2], -8e-3)
    np.testing.assert_allclose(np.diff(motion.time), 10e-3, rtol=1e-9)


@pytest.mark.parametrize("depth", [8e-3, 8.3e-3, 1 / 300])
def test_a_file_of_them_reads_back(tmp_path, depth: float):
    motion = planned_trajectory(**USUAL | {"depth": depth, "along": (0, 3, 4)})
    write_trajectory(motion, tmp_path / "a.csv", comments=["a plan"])
    back = dp.files.read_trajectory(tmp_path / "a.csv")
    np.testing.assert_array_equal(back.time, motion.time)
    np.testing.assert_allclose(back.displacement, motion.displacement, atol=1e-15)
    assert back.position is None


@pytest.mark.once
def test_the_command_writes_what_the_plan_is_of(tmp_path):
    file = tmp_path / "ramp.csv"
    words = (
        "plan --ramp 0.5s --hold 3s --frequency 12.71Hz --depth 6mm --baseline 0.2s --interval 5ms"
    )
    done = ran(*words.split(), "--along", "0,0.6,0.8", "--setpoints", file)
    assert done.exit_code == 0, done.output
    lines = file.read_text().splitlines()
    assert "rest 0.2 s, ramp 0.5 s, hold 3 s; one each 0.005 s" in lines[1]
    assert lines[2] == "time [s],displacement [mm],x [mm],y [mm],z [mm]"
    assert len(lines) == 3 + 40 + 101 + 600
    assert lines[-1] == "3.7,6.0,0.0,3.6,4.8"
    again = ran(*words.split(), "--setpoints", file)
    assert again.exit_code == 0  # it is dashpot's own, and may be written anew
    bad = ran(*words.split(), "--along", "0,1", "--setpoints", file)
    assert bad.exit_code == 2
    assert "expected x,y,z, such as 0,0,-1" in bad.output


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"interval": "3ms"}, "ramp of 1 s is no whole number .* 0.003 s apart; make it 0.999 s"),
        ({"interval": 0.0}, "expected a time > 0"),
        ({"ramp_time": 0.0}, "the ramp takes no time"),
        ({"hold_time": float("nan")}, "the hold takes nan s"),
        ({"along": (0, 0, 0)}, "is no direction"),
        ({"interval": 1e-12, "hold_time": 1e9}, "expected at most"),
    ],
)  # fmt: skip
def test_what_is_no_plan_for_a_controller_is_refused(wrong, message: str):
    with pytest.raises(DataError, match=message):
        planned_trajectory(**USUAL | {"baseline": 0.0} | wrong)


def test_read_trajectory_omits_incomplete_rows_and_accepts_a_rate(tmp_path):
    file = tmp_path / "a.csv"
    rows = "".join(f"{i / 10},{i if i != 3 else ''}\n" for i in range(10))
    file.write_text("time [s],displacement [mm]\n" + rows)
    motion = dp.files.read_trajectory(file)
    assert len(motion.time) == 9
    assert any("1 rows lack a number" in note for note in motion.source.notes)
    with pytest.raises(DataError, match="expected 10 rows of x, y, z"):
        dp.files.Trajectory(np.arange(10.0), np.arange(10.0), np.zeros((9, 3)))
