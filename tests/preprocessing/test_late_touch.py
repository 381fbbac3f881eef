"""A delayed force begins late: no air gap is inferred."""

from __future__ import annotations

from functools import partial

import pytest
from kit.foreign.rigs import Protocol, Rig, late, low_pass, read
from kit.foreign.truths import BROAD, Seal

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
