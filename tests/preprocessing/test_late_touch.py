"""A delayed force begins late: no air gap is inferred."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from kit.foreign.rigs import Protocol, Rig, late, low_pass, read
from kit.foreign.truths import BROAD, Seal
from scipy.signal import lfilter

import dashpot as dp
from dashpot.preprocessing.prepare import prepare

PRESSED = Protocol(depth=7e-3, ramp=0.4, hold=4.0, rate=250.0)
LATE = {
    "on time": Rig(),
    "5 ms": Rig(machine=(partial(late, by=5e-3),)),
    "Bessel, 40 Hz": Rig(machine=(partial(low_pass, cut=40.0, order=4, kind="bessel"),)),
    "Butterworth, 20 Hz": Rig(machine=(partial(low_pass, cut=20.0, order=2),)),
}


def compute_air_gap(rig: Rig, gap: float) -> float:
    """The air that preparation takes off, m."""
    changed = Rig(machine=rig.machine, protocol={"gap": gap})
    record = read(Seal(BROAD), PRESSED, changed, seed=1, name="touch")
    test = dp.RelaxationTest(record.time, record.displacement, record.force, units="SI")
    return float(record.displacement.max() - prepare(test).displacement.max())


@pytest.mark.parametrize("rig", LATE)
def test_a_late_force_is_no_air(rig):
    assert compute_air_gap(LATE[rig], 0.0) < 2e-6


@pytest.mark.parametrize(("rig", "off"), [*zip(LATE, (8e-6, 60e-6, 60e-6, 80e-6), strict=True)])
def test_air_stays_air_however_late_the_force(rig, off):
    assert compute_air_gap(LATE[rig], 0.5e-3) == pytest.approx(0.5e-3, abs=off)


@pytest.mark.parametrize("seed", [0, 5])
def test_contact_is_as_doubtful_as_the_air_that_a_delay_may_be(seed: int) -> None:
    """Where noise hides whether a force is late or behind air, its contact is that doubtful."""
    seal = dp.GeneralizedMaxwell(850.0, k=(160.0,), tau=(4.2,))
    time = np.arange(0.0, 30.0, 1e-3)
    motion = 1.8e-3 * np.clip((time - 0.3) / 0.53, 0.0, 1.0)
    force = lfilter([1 - np.exp(-1 / 8)], [1.0, -np.exp(-1 / 8)], seal.force(time, motion))
    noise = 2e-3 * force.max() * np.random.default_rng(seed).standard_normal(6000)
    test = dp.RelaxationTest(time[::5], motion[::5], force[::5] + noise, units="SI")
    prepared = prepare(test)
    assert (prepared.gap > 0) is (seed == 5)
    assert prepared.contact_error == pytest.approx(prepared.gap)


def test_prepare_finds_contact_behind_an_air_gap_precisely() -> None:
    record = read(Seal(BROAD), PRESSED, Rig(protocol={"gap": 0.5e-3}), seed=1, name="touch")
    test = dp.RelaxationTest(record.time, record.displacement, record.force, units="SI")
    prepared = prepare(test)
    assert prepared.contact_error < 0.05 * prepared.gap
