"""Two accelerometers: the rocking mode cancels."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from dashpot.datamodel.vibration_tests import ImpactTest
from dashpot.simulation.impact import Hammer, simulate_impact
from dashpot.vibration.impact.frf_estimation import estimate_frf
from dashpot.vibration.impact.rocking import _solve_weights

pytestmark = pytest.mark.once

MASS = 0.114829829
TRUE = 12.69983, 0.0285575


@pytest.fixture(scope="module")
def real_hits(real_data: Path) -> ImpactTest:
    """Two hits on a block with two accelerometers; the force is in arbitrary units."""
    text = (real_data / "lvm-read" / "long_single_header_multi_ch.lvm").read_text()
    lines = text.splitlines()
    head = max(i for i, line in enumerate(lines) if line.startswith("X_Value"))
    rows = np.array([line.split("\t")[1:4] for line in lines[head + 1 :] if line.strip()], float)
    assert len(rows) == 16384
    return ImpactTest(
        time=np.arange(16384) * 0.000977,
        force=rows[:, 0],
        acceleration=rows[:, 1:].T,
        starts=(0, 8192),
        channels=("m_1", "m_2"),
        units="SI",
    )


def check(frf, name):
    (result,) = [check for check in frf.checks if check.name == name]
    return result


def height(frf, at):
    return np.abs(frf.value)[np.argmin(np.abs(frf.frequency - at))]


# -- a real block -------------------------------------------------------------------------------


@pytest.mark.parametrize("channel", ["m_1", "m_2"])
def test_both_accelerometers_hear_both_modes_of_the_real_block(real_hits, channel):
    modes = estimate_frf(real_hits, combine=channel).modes()
    bounce = min(modes, key=lambda m: abs(m.frequency - 19.763))
    rocking = min(modes, key=lambda m: abs(m.frequency - 21.147))
    assert bounce.frequency == pytest.approx(19.763, abs=0.006)
    assert rocking.frequency == pytest.approx(21.147, abs=0.006)
    assert bounce.damping_ratio == pytest.approx(0.0026, abs=3e-4)
    assert rocking.damping_ratio == pytest.approx(0.0020, abs=3e-4)


def test_the_real_block_bounces_in_phase_and_rocks_out_of_phase(real_hits):
    item, two = (estimate_frf(real_hits, combine=name) for name in ("m_1", "m_2"))
    for at, sign in ((19.763, 1), (21.147, -1)):
        residues = [
            min(frf.modes(), key=lambda m: abs(m.frequency - at)).residue for frf in (item, two)
        ]
        assert np.sign((residues[0] * residues[1].conjugate()).real) == sign


def test_weights_null_the_rocking_of_the_real_block(real_hits):
    mean = estimate_frf(real_hits)
    weighted = estimate_frf(real_hits, combine="weighted")
    assert height(mean, 21.1) / height(mean, 19.75) == pytest.approx(0.163, abs=0.001)
    assert height(weighted, 21.1) / height(weighted, 19.75) <= 0.05
    assert check(mean, "rocking_cancelled").failed
    assert check(weighted, "rocking_cancelled").passed
    assert check(weighted, "rocking_cancelled").value <= 0.05
    assert weighted.modes()[0].frequency == pytest.approx(19.763, abs=0.006)
    assert weighted.modes()[0].damping_ratio == pytest.approx(0.0026, abs=1e-4)


def test_the_real_hits_are_doubtful_but_not_thrown_away(real_hits):
    frf = estimate_frf(real_hits)
    assert frf.averages == 2
    assert [hit.accepted for hit in frf.hits] == [True, True]
    assert any("of the pulse exceed" in reason for reason in frf.hits[0].reasons)
    assert any("left at the end of the record" in reason for reason in frf.hits[0].reasons)
    assert check(frf, "hits_enough").failed
    assert "hammer_sign" in [step.name for step in frf.steps]
    assert check(frf, "hits_centred").failed


# -- a simulated block --------------------------------------------------------------------------


def test_mean_of_accelerometers_cancels_rocking(broad_seal):
    """Hits scattered by 3 mm: coherence holds for the mean and breaks for one accelerometer."""
    rig = replace(Hammer().noise_free(), record=8.0, eccentricity=3e-3)
    test = simulate_impact(broad_seal, mass=MASS, hits=10, rig=rig).test
    mean, band = (estimate_frf(test, combine=c).band(5, 40) for c in ("mean", "acceleration 1"))
    assert mean.coherence.min() > 0.999
    assert band.coherence.min() < 0.8


def test_damping_survives_hits_off_centre(broad_seal):
    rig = replace(Hammer().noise_free(), record=8.0, eccentricity=10e-3, gain_mismatch=0.03)
    test = simulate_impact(broad_seal, mass=MASS, hits=5, rig=rig).test
    for combine in ("mean", "weighted"):
        mode = estimate_frf(test, combine=combine).modes()[0]
        assert mode.frequency == pytest.approx(TRUE[0], rel=2e-4)
        assert mode.damping_ratio == pytest.approx(TRUE[1], rel=0.01)


def test_weighted_accelerometers_cancel_rocking_better_than_the_mean(broad_seal):
    rig = replace(Hammer(), record=8.0, eccentricity=8e-3)
    test = simulate_impact(broad_seal, mass=MASS, hits=6, rig=rig, seed=3).test
    bounce = test.acceleration.mean(axis=0)
    swing = test.acceleration[0] - bounce
    # the second accelerometer moves in to 60 % of its distance
    variant = replace(test, acceleration=np.vstack((bounce + swing, bounce - 0.6 * swing)))
    mean, weighted = estimate_frf(variant), estimate_frf(variant, combine="weighted")
    assert mean.band(14, 19).coherence.min() < weighted.band(14, 19).coherence.min()
    (step,) = [step for step in weighted.steps if step.name == "combine"]
    weights = [float(value) for _, value in step.parameters]
    assert weights == pytest.approx([0.6 / 1.6, 1 / 1.6], abs=0.03)


def test_single_accelerometer_is_not_combined(strike):
    frf = estimate_frf(strike(hits=3, noise=(5e-3, 0.02)), combine="weighted")
    assert "combine" not in [step.name for step in frf.steps]


def test_accelerometer_weights_sum_to_unity_and_cancel_a_shape():
    shape = np.array([[1.0 + 0j], [-0.7], [0.2]])
    weights = _solve_weights(shape)
    assert weights.sum() == pytest.approx(1)
    assert abs(weights @ shape[:, 0]) < 1e-12
    # two accelerometers see one shape in exactly one way
    assert _solve_weights(np.array([[1.0 + 0j], [-0.5]])) == pytest.approx([1 / 3, 2 / 3])
