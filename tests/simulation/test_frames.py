"""Set-points along a line, a transducer that is not square to the plate."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dashpot.base.errors import DataError
from dashpot.extensions.gauges.transducer import tilt_motion
from dashpot.simulation.robot import setpoints, unit


def test_a_line_in_space_has_101_set_points_and_the_last_is_exact():
    # R1: (0,0,0) -> (0,0,-8), dt = 10 ms
    points = setpoints((0, 0, 0), (0, 0, -8e-3), duration=1.0, interval=10e-3)
    assert points.shape == (101, 3)
    assert points[-1].tolist() == [0.0, 0.0, -8e-3]
    np.testing.assert_allclose(np.diff(points[:, 2]), -8e-5, rtol=1e-12)


@given(angle=st.floats(0, 1.5), towards=st.floats(-3, 3), force=st.floats(0.01, 70))
def test_the_lateral_force_tells_the_angle(angle: float, towards: float, force: float):
    # R4: atan(F_lat / F_z)
    x, y, z = tilt_motion([force], angle, azimuth=towards)[:, 0]
    assert np.hypot(np.hypot(x, y), z) == pytest.approx(force)
    assert np.arctan2(np.hypot(x, y), z) == pytest.approx(angle, abs=1e-12)


@pytest.mark.parametrize("wrong", [(0, 0, 0), (0, float("nan"), 1), (0, 1)])
def test_what_is_no_direction_is_refused(wrong):
    with pytest.raises(DataError, match="expected three numbers, not all zero"):
        unit(wrong)
