"""Dashpot's closed forms against solids and rigs that share no line with it."""

from __future__ import annotations

import numpy as np
import pytest
from kit.foreign.kinds import KINDS, nominal
from kit.foreign.rigs import Protocol, Rig, read
from kit.foreign.truths import BROAD, TABLE_1, TRUTHS, Seal, Solid, slider

import dashpot as dp
from dashpot.fitting.relaxation import fit
from dashpot.preprocessing.prepare import prepare
from dashpot.reading.readers.relaxation import read_relaxation
from dashpot.solids.jenkins import Jenkins

T = np.geomspace(1e-3, 1e3, 40)
ARMS = [truth for truth in TRUTHS if len(truth.k) < 10]


def model(solid):
    return dp.GeneralizedMaxwell(solid.k_inf, solid.k, solid.tau)


@pytest.mark.parametrize("solid", [TABLE_1, BROAD, *ARMS[4:30:6]], ids=lambda item: item.name)
def test_relaxation_stiffness_and_force_agree(solid):
    ours = model(solid)
    np.testing.assert_allclose(ours.relaxation(T), solid.relaxation(T), rtol=1e-13)
    np.testing.assert_allclose(
        ours.complex_stiffness(omega=1 / T), solid.stiffness(1 / T), rtol=1e-13
    )
    clock, x = Protocol(baseline=0.0, rounding=0.0).plate()
    eq5 = ours.ramp_hold_force(clock, depth=8e-3, ramp_time=1.0)
    np.testing.assert_allclose(eq5, solid.force(x, clock[1]), rtol=0, atol=1e-10)
    clock, x = Protocol(servo=(6.0, 0.5), hold=5.0).plate()
    np.testing.assert_allclose(ours.force(clock, x), solid.force(x, clock[1]), rtol=0, atol=1e-10)


def test_the_fractional_solid_agrees():
    ours = dp.solids.FractionalZener(336.5, 196.5, 0.6, 0.6)
    theirs = Solid.fractional("", 196.5, 140.0, 0.6, 0.6)
    np.testing.assert_allclose(ours.relaxation(T), theirs.relaxation(T), rtol=1e-8)
    np.testing.assert_allclose(
        ours.complex_stiffness(omega=1 / T), theirs.stiffness(1 / T), rtol=1e-7
    )


def test_the_response_of_a_block_agrees():
    lines = np.linspace(1, 60, 600)
    ours = dp.systems.predict_frf(2 * model(BROAD), mass=0.1148, frequency=lines)
    np.testing.assert_allclose(ours.value, Seal(BROAD).accelerance(lines, 0.1148, 2), rtol=1e-12)


def test_creep_friction_and_rubber_agree():
    creep = KINDS["creep"][0](2)
    clock, force = creep["time"], creep.truth["force"]
    ours = model(creep.truth["solid"]).displacement(clock, force)
    np.testing.assert_allclose(ours, creep.truth["pure"], rtol=0, atol=1e-12)
    x = np.cumsum(np.random.default_rng(1).standard_normal(400)) * 1e-4
    x -= x[0]
    path = Jenkins(5e3, 2.0).path_force(np.arange(400.0), x)
    np.testing.assert_allclose(path, slider(x, 2.0, 5e3), atol=1e-12)
    stretch = np.linspace(1.1, 2.0, 9)
    for mode in ("uniaxial", "equibiaxial", "planar"):
        ours = dp.solids.Hyperelastic("mooney-rivlin", (0.15e6, 0.05e6)).nominal(mode, stretch)
        theirs = nominal("mooney-rivlin", mode, stretch, (0.15e6, 0.05e6))
        np.testing.assert_allclose(ours, theirs, rtol=1e-12)


def test_a_record_reads_back_and_is_fitted_within_its_interval(tmp_path):
    item = read(Seal(TABLE_1), Protocol(), Rig(noise=1e-3, bias=0.0), name="Table 1")
    path = tmp_path / "one.csv"
    path.write_text(item.text(), "utf-8")
    test = read_relaxation(path)
    np.testing.assert_array_equal(test.force, item.force)
    np.testing.assert_array_equal(test.time, item.time)
    record = prepare(test)
    result = fit(record, arms=2)
    bounds = result.stiffness_limits
    assert bounds is not None
    for name, times in (("k_end", 1), ("k_3end", 3), ("k_inf", np.inf)):
        low, high = bounds[name]
        assert low <= item.seal.secant(times * record.hold_time) <= high
    assert result.model.tau == pytest.approx(TABLE_1.tau, rel=0.05)
