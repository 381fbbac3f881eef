"""Prediction at a level on a seal with a nonlinear elastic law: document and text."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import dashpot as dp
from dashpot.base.errors import DataError
from dashpot.base.reported_values import NORMAL
from dashpot.extensions.amplitude.level_text import prediction
from dashpot.extensions.amplitude.preloaded_mass import PreloadedMass
from dashpot.extensions.amplitude.preloaded_response import _compute_narrow_interval
from dashpot.extensions.materials.cld.fit_files import apply_elastic_law
from dashpot.solids.elastic import ElasticLaw

pytestmark = pytest.mark.once

MASS, WIDER = 0.1148, 30.0
# stiffens as it is pressed
LAW = ElasticLaw((0.0, 4e-3, 8e-3), (0.6, 0.9, 1.6), 200.0, ratio_se=(0.01, 0.0, 0.02))


@pytest.fixture(scope="module")
def straight():
    made = dp.simulate("relaxation", hold="5s", noise_free=True)
    return dp.fit(made, arms=2)


@pytest.fixture(scope="module")
def nonlinear_fit(straight):
    return apply_elastic_law(straight, LAW)


@pytest.fixture(scope="module")
def bent_prediction(nonlinear_fit):
    return dp.predict(nonlinear_fit, mass=MASS, seals=2, level="0.3N", lines=31)


def test_the_document_tells_harmonics_shift_and_whether_it_lasts(bent_prediction, nonlinear_fit):
    (level,) = bent_prediction.to_dict()["levels"]
    hz, law = level["peak"]["frequency_hz"], nonlinear_fit.elastic_law
    (single,) = PreloadedMass(MASS, 2 * law, nonlinear_fit.solid).sweep(
        level=0.3, frequency=np.array([hz])
    )
    rest = 2 * law.force(level["rest"])
    assert rest == pytest.approx(MASS * 9.80665)
    assert level["mean_shift"] == pytest.approx(level["harmonics"][0] - level["rest"])
    assert level["mean_shift"] < -2e-4
    assert level["lost_contact"] > 0.1
    assert level["floquet"] < 1
    assert len(level["harmonics"]) == len(level["phases"]) == 6
    # it stands on the branch of a sweep upwards, or has the one answer
    if single.amplitudes[1] > 0.8 * level["amplitude"]:
        assert level["harmonics"][:4] == pytest.approx(single.amplitudes[:4], rel=1e-5, abs=1e-8)
    omega = 2 * np.pi * hz
    assert level["peak"]["value"] == pytest.approx(omega**2 * level["amplitude"] / 0.3, rel=1e-9)


def test_the_text_says_that_the_seal_opens(bent_prediction):
    text = " ".join(" ".join(prediction(bent_prediction).lines).split())
    assert "mean shift, mm" in text
    shift = -1e3 * bent_prediction.preloaded[0].orbit.shift
    assert f"at 0.3 N the seal opens by {shift:.2g} mm on average" in text


def find_peak_frequency(law, solid, level, about):
    """Frequency of the top, by many lines."""
    of = PreloadedMass(MASS, 2 * law, solid)
    lines = np.linspace(0.995 * about, 1.005 * about, 21)
    swept = of.sweep(level=level, frequency=lines)
    size = np.log([response.frequency**2 * response.amplitudes[1] for response in swept])
    top = int(size.argmax())
    near = slice(top - 2, top + 3)
    bend, slope, _ = np.polyfit(lines[near] - lines[top], size[near], 2)
    return lines[top] - 0.5 * slope / bend


def test_prediction_interval_agrees_with_laws_one_error_off(nonlinear_fit):
    """Only the law is in doubt: its tangent at rest by 1 %, at 8 mm by 2 %, its mean kept."""
    sure = replace(nonlinear_fit.estimate, covariance=0 * nonlinear_fit.covariance)
    interval = replace(nonlinear_fit, estimate=sure)
    (response,) = dp.predict(interval, mass=MASS, seals=2, level="0.0005N", lines=31).preloaded
    assert response.jumps == ()
    peak_frequency = find_peak_frequency(
        nonlinear_fit.elastic_law, nonlinear_fit.solid, 0.0005, response.frequency
    )
    off = []
    for by in ((0.01, 0.0, 0.0), (0.0, 0.0, 0.02)):
        ratio = np.array(LAW.ratio) + by
        ratio /= (ratio[0] / 2 + ratio[1] + ratio[2] / 2) / 2
        law = ElasticLaw(LAW.knots, tuple(ratio), nonlinear_fit.elastic_law.stiffness)
        off.append(
            find_peak_frequency(law, nonlinear_fit.solid, 0.0005, response.frequency)
            - peak_frequency
        )
    half = 1.96 * np.linalg.norm(off)
    interval = response.interval
    assert np.diff(interval.frequency)[0] / 2 == pytest.approx(half, rel=0.1)
    f, limits = response.frf.frequency, interval.magnitude
    assert (
        (limits[0] <= np.abs(response.frf.value)) & (np.abs(response.frf.value) <= limits[1])
    ).all()
    # far above the resonance the mass alone is felt
    assert (limits[1] / limits[0])[f > 45] == pytest.approx(1.0, abs=2e-3)


def test_prediction_reports_the_frequency_range_with_two_solutions(bent_prediction, tmp_path):
    item = bent_prediction.preloaded[0]
    (hz,) = item.jumps_hz
    before, after = item.jumps[0]
    assert after.amplitudes[1] > 1.5 * before.amplitudes[1]
    assert after.frequency - before.frequency < 1e-3 * hz
    assert item.frequency == pytest.approx(hz, rel=1e-9)
    text = " ".join(" ".join(prediction(bent_prediction).lines).split())
    assert f"! at 0.3 N two stable responses exist below {hz:.5g} Hz" in text
    low, high = item.interval.mean_shift
    half = 1e3 * (high - low) / 2
    assert f"± {half:.2g}" in text
    page = bent_prediction.save(tmp_path / "level.html").read_text()
    assert "At 0.3 N" in page
    level = bent_prediction.to_dict()["levels"][0]
    assert level["interval"]["mean_shift"] == [low, high]
    response = level["response"]
    assert np.shape(response["magnitude_between"]) == (2, len(response["frequency_hz"]))


def test_a_vanishing_level_over_a_base_is_the_linear_answer(nonlinear_fit):
    result = dp.predict(nonlinear_fit, mass=MASS, seals=2, base=True, level="1e-5m/s^2", lines=31)
    (small,) = result.preloaded
    assert (small.unit, small.frf.quantity.value) == ("m/s^2", "transmissibility")
    assert small.value == pytest.approx(result.peak[1], rel=1e-2)
    assert small.frequency == pytest.approx(result.modes[0].frequency, rel=2e-3)
    shared = np.isin(small.frf.frequency, result.frf.frequency)
    assert small.frf.value[shared] == pytest.approx(result.frf.value, rel=1e-5)
    assert small.unsteady == ()
    assert "when shaken" not in " ".join(prediction(result).lines)


@pytest.mark.parametrize(("depth", "passes"), [(1.001, True), (0.999, False)])
def test_prediction_reports_a_swing_deeper_than_tested(
    bent_prediction, nonlinear_fit, depth, passes
):
    deepest = bent_prediction.preloaded[0].compression
    law = nonlinear_fit.elastic_law
    from dashpot.vibration.checks import compression_tested

    assert any(
        check.name == "compression_tested" and check.value == pytest.approx(deepest / law.depth)
        for check in bent_prediction.checks
    )
    assert compression_tested(deepest, depth * deepest).passed is passes


def test_a_straight_law_takes_no_level(straight):
    with pytest.raises(DataError, match=r"the elastic law of this fit is linear"):
        dp.predict(straight, mass=MASS, seals=2, level="0.1N")


@pytest.mark.parametrize(
    ("how", "message"),
    [
        # the force is 0.99 times, and 1.01 times the weight
        ({"level": f"{1.01 * MASS * 9.80665}N"}, r"lifts the mass off the seal: its force is"),
        ({"level": "10m/s^2", "base": True}, r"10 m/s\^2 lifts the mass off the seal"),
        ({"level": "1uN", "mass": "10mg"}, r"so slight a contact was not tested"),
    ],
)
def test_predict_refuses_a_mass_that_hardly_preloads(nonlinear_fit, how, message):
    with pytest.raises(DataError, match=message):
        dp.predict(nonlinear_fit, **{"mass": MASS, "seals": 2, "lines": 31, **how})


def test_a_sweep_that_would_follow_every_line_from_rest_ends(nonlinear_fit, monkeypatch):
    monkeypatch.setattr("dashpot.extensions.amplitude.preloaded_mass._STEPS_OF_SWEEP", 20)
    of = PreloadedMass(0.01, 2 * nonlinear_fit.elastic_law, nonlinear_fit.solid)
    with pytest.raises(DataError, match="bounces on the seal: up to"):
        of.sweep(level=0.95 * of.static_force, frequency=np.linspace(5, 60, 40))


def test_an_error_as_large_as_the_number_is_no_interval(nonlinear_fit):
    """The damping is off by a factor: no height is reported, but its frequency."""
    scale = np.diag([1.0, *[WIDER] * (len(nonlinear_fit.covariance) - 1)])
    doubted = replace(nonlinear_fit.estimate, covariance=scale @ nonlinear_fit.covariance @ scale)
    wide = replace(nonlinear_fit, estimate=doubted)
    message = dp.predict(wide, mass=MASS, seals=2, level="0.0005N", lines=31)
    (response,) = message.preloaded
    assert response.interval.value is None
    assert response.interval.frequency[0] < response.frequency < response.interval.frequency[1]
    assert next(fact for fact in response.facts if fact.name == "peak_height").error == np.inf
    assert "the height of the peak is not identified" in " ".join(prediction(message).lines)


@pytest.mark.parametrize(("half", "expected"), [(0.99, True), (1.01, False)])
def test_an_interval_is_narrower_than_its_number(half, expected):
    ends = _compute_narrow_interval(-2.0, np.array([2 * half / NORMAL, 0.0]))
    assert (ends is not None) is expected
