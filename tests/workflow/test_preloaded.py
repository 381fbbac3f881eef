"""A mass at a level on a seal whose elastic law bends: its document and its text."""

from __future__ import annotations

import numpy as np
import pytest

import dashpot as dp
from dashpot.base.errors import DataError
from dashpot.solids.elastic import ElasticLaw
from dashpot.told.text import prediction
from dashpot.vibration.systems.preloaded import PreloadedMass

pytestmark = pytest.mark.once

MASS = 0.1148
# stiffens as it is pressed
LAW = ElasticLaw((0.0, 4e-3, 8e-3), (0.6, 0.9, 1.6), 200.0)


@pytest.fixture(scope="module")
def straight():
    made = dp.simulate("relaxation", hold="5s", noise_free=True)
    return dp.fit(made, arms=2)


@pytest.fixture(scope="module")
def bent(straight):
    return straight.with_elastic_law(LAW)


@pytest.fixture(scope="module")
def told(bent):
    return dp.predict(bent, mass=MASS, seals=2, level="0.3N", lines=31)


def test_the_document_tells_harmonics_shift_and_whether_it_lasts(told, bent):
    (level,) = told.document["levels"]
    hz, law = level["peak"]["frequency_hz"], bent.elastic_law
    (alone,) = PreloadedMass(MASS, 2 * law, bent.solid).sweep(level=0.3, frequency=np.array([hz]))
    rest = 2 * law.force(level["rest"])
    assert rest == pytest.approx(MASS * 9.80665)
    assert level["mean_shift"] == pytest.approx(level["harmonics"][0] - level["rest"])
    assert level["mean_shift"] < -2e-4
    assert level["lost_contact"] > 0.1
    assert level["floquet"] < 1
    assert len(level["harmonics"]) == len(level["phases"]) == 6
    # it stands on the branch of a sweep upwards, or has the one answer
    if alone.amplitudes[1] > 0.8 * level["amplitude"]:
        assert level["harmonics"][:4] == pytest.approx(alone.amplitudes[:4], rel=1e-5, abs=1e-8)
    omega = 2 * np.pi * hz
    assert level["peak"]["value"] == pytest.approx(omega**2 * level["amplitude"] / 0.3, rel=1e-9)


def test_the_text_says_that_the_seal_opens(told):
    said = " ".join(" ".join(prediction(told).lines).split())
    assert "mean shift, mm" in said
    shift = -1e3 * told.preloaded[0].orbit.shift
    assert f"at 0.3 N the seal opens by {shift:.2g} mm when shaken" in said


def test_a_vanishing_level_over_a_base_is_the_linear_answer(bent):
    found = dp.predict(bent, mass=MASS, seals=2, base=True, level="1e-5m/s^2", lines=31)
    (small,) = found.preloaded
    assert (small.unit, small.frf.quantity.value) == ("m/s^2", "transmissibility")
    assert small.value == pytest.approx(found.peak[1], rel=1e-2)
    assert small.frequency == pytest.approx(found.modes[0].frequency, rel=2e-3)
    shared = np.isin(small.frf.frequency, found.frf.frequency)
    assert small.frf.value[shared] == pytest.approx(found.frf.value, rel=1e-5)
    assert small.unsteady == ()
    assert "when shaken" not in " ".join(prediction(found).lines)


@pytest.mark.parametrize(("depth", "passes"), [(1.001, True), (0.999, False)])
def test_a_swing_deeper_than_tested_is_told(told, bent, depth, passes):
    deepest = told.preloaded[0].deepest
    law = bent.elastic_law
    from dashpot.vibration.checks import compression_tested

    assert any(
        check.name == "compression_tested" and check.value == pytest.approx(deepest / law.depth)
        for check in told.checks
    )
    assert compression_tested(deepest, depth * deepest).passed is passes


def test_a_straight_law_takes_no_level(straight):
    with pytest.raises(DataError, match=r"the elastic law of this fit does not: add a sweep"):
        dp.predict(straight, mass=MASS, seals=2, level="0.1N")
