"""A load cell that drifts before contact does not move the contact."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from kit.foreign.blank_rigs import Rig, draw_seal, make_seal_test

import dashpot as dp
from dashpot.preprocessing.prepare import prepare

GAP, DEPTH = 1e-3, 8e-3
DEPARTURE = 10.0
"""Time at which the plate leaves its rest, s; it meets the seal .125 s later."""
SEEDS = range(2)


@cache
def press_seal(seed: int) -> np.ndarray:
    """Return time, displacement and force of a cell that is still."""
    rig = Rig(
        compliance=0.0, creep=0.0, gain=1.0, delay=0.0, drift=0.0, hum=0.0, rate=200.0,
        displacement_noise=0.2e-6,
    )  # fmt: skip
    return np.array(make_seal_test(rig, draw_seal(seed), seed, hold=4.0, gap=GAP))


def find_contact_errors(drift: float, first: float) -> np.ndarray:
    """Errors of the contact, m, in records that begin `first` s before the plate moves."""
    errors = []
    for seed in SEEDS:
        channels = press_seal(seed)
        time, x, force = channels[:, channels[0] >= DEPARTURE - first]
        test = dp.RelaxationTest(time - time[0], x, force + drift * time, units="SI")
        errors.append(DEPTH - prepare(test, with_checks=False).depth)
    return np.array(errors)


@pytest.mark.parametrize("first", [10.0, 2.0, 0.3, -0.03])
def test_drift_does_not_move_the_contact(first: float) -> None:
    """Whatever its rate and sign; the last record begins in the air, on the ramp."""
    still = find_contact_errors(0.0, first)
    assert np.abs(still).max() < 15e-6
    for drift in (-3e-3, -1e-3, 1e-3, 3e-3):
        assert np.abs(find_contact_errors(drift, first) - still).max() < 1.5e-6, drift


def test_drift_without_a_baseline_leaves_the_contact_at_the_first_sample() -> None:
    """Half of the ramp is missing: the first sample is the contact, as of a cell that is still."""
    still = find_contact_errors(0.0, -0.5)
    for drift in (-3e-3, 3e-3):
        assert np.abs(find_contact_errors(drift, -0.5) - still).max() < 1e-9, drift
