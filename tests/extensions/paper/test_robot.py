"""Three axes, the plate's normal, an arm with two links."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dashpot.base.errors import DataError
from dashpot.extensions.gauges.transducer import tilt_motion
from dashpot.extensions.paper.robot import Arm, Robot, compute_depth_along, compute_misalignment
from dashpot.simulation.robot import setpoints, unit

SLANTED = (0.0, 0.6, 0.8)


def test_8_mm_along_a_slanted_normal_are_8_mm():
    # R2: 8 mm along (0, 0.6, 0.8) gives 8.000
    points = setpoints((0.01, 0.02, 0.03), (0.01, 0.0248, 0.0364), duration=1.0, interval=10e-3)
    depth = compute_depth_along(points, SLANTED, contact=(0.01, 0.02, 0.03))
    assert depth[-1] == pytest.approx(8e-3, abs=1e-15)
    assert depth[0] == 0.0


@pytest.mark.parametrize("along", [(0, 0, -1), SLANTED])
def test_three_axes_make_the_ramp_and_drift_sideways_by_less_than_50_um(along):
    # R1: overshoot < 1 %, steady error < 1 count, lateral drift < 0.05 mm
    robot, stop = Robot(), 8e-3 * unit(along)
    line = setpoints((0, 0, 0), tuple(stop), duration=1.0, interval=1e-3)
    reference = np.vstack([line, np.tile(stop, (3000, 1))])
    true = robot.follow(reference)
    depth = compute_depth_along(true, along)
    assert 8e-3 < depth.max() < 1.01 * 8e-3
    assert abs(depth[-1] - 8e-3) < robot.encoder
    sideways = true - np.multiply.outer(depth, unit(along))
    assert np.abs(sideways).max() < 0.05e-3
    read = robot.read(true)
    assert np.abs(read - true).max() <= robot.encoder / 2 * (1 + 1e-9)
    # half a count of each axis, as far as it lies along the normal
    error = np.abs(compute_depth_along(read, along) - depth).max()
    assert error <= robot.encoder / 2 * np.abs(unit(along)).sum() * (1 + 1e-9)


def test_an_encoder_without_steps_reads_the_truth():
    assert Robot(encoder=0.0).read(np.array([[1.23e-6, 0.0, 1.0]]))[0, 0] == 1.23e-6


@given(
    first=st.floats(-3, 3), second=st.floats(0.01, 3.1), z=st.floats(-0.1, 0.1),
    links=st.tuples(st.floats(0.05, 1), st.floats(0.05, 1)),
)  # fmt: skip
def test_an_arm_goes_back_to_its_joints(first, second, z, links):
    arm = Arm(links)
    place = arm.place([(first, second, z)])
    np.testing.assert_allclose(arm.place(arm.joints(place)), place, atol=1e-9)


def test_an_arm_reads_depth_to_half_a_count_and_sideways_to_its_lever():
    # R2: error of the depth <= q / 2
    arm = Arm(count=1e-4)
    line = setpoints((0.3, 0.1, 0.0), (0.3, 0.1, -8e-3), duration=1.0, interval=1e-3)
    wandered = line + 1e-3 * np.column_stack(
        (np.sin(np.arange(len(line))), np.cos(np.arange(len(line))), np.zeros(len(line)))
    )
    read = arm.read(wandered)
    depth = compute_depth_along(read, (0, 0, -1)) - compute_depth_along(wandered, (0, 0, -1))
    assert 0 < np.abs(depth).max() <= arm.encoder / 2 * (1 + 1e-9)
    sideways = np.hypot(*(read - wandered)[:, :2].T)
    # half a count of the shoulder turns the whole reach, one of the elbow the second link
    reach = np.hypot(*wandered[:, :2].T).max()
    most = arm.count / 2 * (reach + arm.links[1])
    assert 0.3 * most < sideways.max() <= most * (1 + 1e-3)
    exact = Arm(count=0.0, encoder=0.0).read(wandered)
    np.testing.assert_allclose(exact, wandered, atol=1e-15)


def test_an_arm_does_not_reach_everywhere():
    with pytest.raises(DataError, match=r"reaches from 0\.05 to 0\.55 m"):
        Arm().joints([(0.6, 0.0, 0.0)])


@given(angle=st.floats(0, 1.5), towards=st.floats(-3, 3), force=st.floats(0.01, 70))
def test_the_lateral_force_shows_the_angle(angle: float, towards: float, force: float) -> None:
    x, y, z = tilt_motion([force], angle, azimuth=towards)[:, 0]
    assert compute_misalignment(x, y, z) == pytest.approx(angle, abs=1e-12)
