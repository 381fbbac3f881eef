"""Records that are no ramp and hold, and sound ones that look like them."""

from __future__ import annotations

import numpy as np
import pytest
from kit.kinds import answer, ramp_and_hold

from dashpot.base.errors import DataError
from dashpot.datamodel.relaxation import RelaxationTest
from dashpot.preprocessing.prepare import prepare
from dashpot.signals.segments import (
    MAX_HELD_CHANGE,
    MAX_SETTLING,
    MIN_CREEP,
    classify_load_history,
)

TIME = np.arange(0, 30, 0.05)


@pytest.mark.parametrize("every", [2, 8, 15])
def test_a_ramp_of_few_samples_is_a_ramp(every: int) -> None:
    time = TIME[20::every]  # the ramp begins at the first sample
    force = answer(TIME, ramp_and_hold(TIME))[20::every]
    ramp_hold = prepare(RelaxationTest(time, ramp_and_hold(time), force, units="SI"))
    assert ramp_hold.depth == pytest.approx(8e-3)


@pytest.mark.parametrize(("settling", "late"), [(0.98, True), (1.02, False)])
def test_a_displacement_that_settles_while_the_force_relaxes_began_late(
    settling: float, late: bool
) -> None:
    level = 8e-3
    x = level * (1 - settling * MAX_SETTLING * np.exp(-TIME))  # its median is the level
    force = 1 + np.exp(-TIME / 9)
    assert (classify_load_history(TIME, x, force) == "other") == late
    with pytest.raises(DataError, match="the record begins within its ramp, or after it"):
        prepare(RelaxationTest(TIME, x, force, units="SI"))


@pytest.mark.parametrize(("steady", "crept", "creeps"), [
    (0.9, 1.1, True), (1.1, 1.1, False), (0.9, 0.9, False),
])  # fmt: skip
def test_a_creep_test_holds_its_force(steady: float, crept: float, creeps: bool) -> None:
    risen, since = np.clip(TIME - 1, 0, 1), np.clip(TIME - 2, 0, None) / 28
    # from the first tenth of the hold to the last, as tenths of a straight line go: 0.9
    force = risen * (1 - MAX_HELD_CHANGE * steady * since / 0.9)
    x = 8e-3 * risen * (1 + MIN_CREEP * crept * since / 0.9 * (1 + MIN_CREEP * crept / 0.9))
    assert (classify_load_history(TIME, x, force) == "creep") == creeps
