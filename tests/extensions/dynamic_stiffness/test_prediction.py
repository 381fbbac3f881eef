"""Storage and loss stiffness at a frequency, against the formula of Maxwell arms."""

import json
import math
import re
from dataclasses import replace

import numpy as np
import pytest
from kit.shell import ran

import dashpot as dp
from dashpot.base.errors import DataError
from dashpot.extensions.dynamic_stiffness.command_options import parse_frequencies
from dashpot.extensions.dynamic_stiffness.figure import draw_stiffness_prediction
from dashpot.extensions.dynamic_stiffness.prediction import predict_stiffness

K_INF, ARMS = 180.0, ((120.0, 0.5), (20.0, 16.0))


@pytest.fixture(scope="module")
def fit():
    record = dp.simulate("relaxation", hold="20s", seed=4)
    return dp.fit(record)


def stiffness(model, frequency):
    """K' and K'' of a spring beside Maxwell arms, by their closed form."""
    w = 2 * math.pi * frequency
    pairs = list(zip(model.k, model.tau, strict=True))
    storage = model.k_inf + sum(k * (w * tau) ** 2 / (1 + (w * tau) ** 2) for k, tau in pairs)
    return storage, sum(k * w * tau / (1 + (w * tau) ** 2) for k, tau in pairs)


def test_stiffness_is_that_of_the_arms_and_of_all_seals(fit):
    prediction = dp.predict(fit, frequency=["0.05Hz", "0.2Hz"], seals=2)
    for i, f in enumerate((0.05, 0.2)):
        storage, loss = stiffness(fit.model, f)
        values = [item.value for item in prediction.values[3 * i : 3 * i + 3]]
        assert values == pytest.approx([2 * storage, 2 * loss, loss / storage], rel=1e-12)
    assert prediction.verdict.use == "use"


def test_limits_hold_the_value_in_the_valid_band(fit):
    low, high = fit.band
    for value in dp.predict(fit, frequency=math.sqrt(low * high)).values:
        assert value.low < value.value < value.high


def test_a_modulus_has_no_number_of_seals(fit):
    with pytest.raises(DataError, match="a modulus is of the material"):
        predict_stiffness(replace(fit, unit="Pa"), frequency=0.1, seals=2)


def test_frequency_outside_the_band_has_no_limits_and_is_extrapolated(fit):
    prediction = dp.predict(fit, frequency="12.71Hz")
    assert all(math.isnan(value.low) and math.isnan(value.high) for value in prediction.values)
    assert prediction.verdict.use == "use with care"
    assert prediction.verdict.reasons == ("frequencies_in_valid_band",)


def test_records_bound_what_the_band_leaves_open(tmp_path):
    assert ran("simulate", "relaxation", "-o", tmp_path / "seal.csv").exit_code == 0
    made = ran("fit", tmp_path / "seal.csv", "-o", tmp_path / "fit.json")
    assert made.exit_code == 0, made.output
    result = ran(
        "predict", tmp_path / "fit.json", "--frequency", "12.71Hz",
        "--record", tmp_path / "seal.csv", "--json",
    )  # fmt: skip
    document = json.loads(result.stdout)
    storage = document["values"][0]
    assert storage["low"] < storage["value"] < storage["high"]
    assert document["verdict"]["failed_checks"] == ["loss_factor_determined_at"]


@pytest.mark.parametrize("frequency", [0.0, -1.0, "0Hz"])
def test_frequency_that_is_not_positive_is_refused(fit, frequency):
    with pytest.raises(dp.DataError, match="frequency"):
        dp.predict(fit, frequency=frequency)


def test_figure_is_that_of_the_fit_with_its_origin(fit):
    prediction = dp.predict(fit, frequency="0.2Hz")
    assert prediction.plot().name == fit.plot().name
    stamped = draw_stiffness_prediction(prediction, stamp="of a test")
    assert stamped.stamp == "of a test"


@pytest.mark.parametrize("grade", ["limit", "stop"])
def test_a_doubt_of_the_fit_is_one_of_its_stiffness(fit, grade):
    doubt = replace(fit.checks[0], name="doubted", passed=False, grade=grade)
    doubtful = replace(fit, evidence=replace(fit.evidence, checks=(*fit.checks, doubt)))
    verdicts = [
        dp.predict(doubtful, **requested).verdict
        for requested in ({"frequency": 0.2}, {"mass": 0.1})
    ]
    assert all("doubted" in verdict.reasons for verdict in verdicts)
    assert verdicts[0].use == doubtful.verdict.use != "use"


def test_a_model_without_a_band_is_not_for_use(fit):
    bare = replace(fit, evidence=replace(fit.evidence, band=(0.0, 0.0), checks=()))
    verdict = dp.predict(bare, frequency="0.001Hz").verdict
    assert verdict.use == "use with care"
    assert "frequencies_in_valid_band" in verdict.reasons


@pytest.mark.parametrize(
    ("text", "hertz"),
    [
        ("1,5,10,44Hz", (1, 5, 10, 44)), ("1, 5, 10 Hz", (1, 5, 10)), ("1Hz,5Hz", (1, 5)),
        ("1.5,5Hz", (1.5, 5)), ("1;5Hz", (1, 5)), ("500mHz,1kHz", (0.5, 1000)),
        ("12.71Hz", (12.71,)), ("1e-1,2e1,3Hz", (0.1, 20, 3)),
    ],
)  # fmt: skip
def test_list_of_frequencies_has_the_unit_of_its_last(text, hertz):
    assert parse_frequencies(text) == pytest.approx(hertz)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1,5Hz", "write 1.5Hz, or a unit after each"),
        ("1,000Hz", "write 1.000Hz or 1000Hz, or a unit"),
        ("1,000,000Hz", "write 1000000Hz, or a unit"),
        ("1,5,10", "has no unit"), ("1,5,10mm", "expected a unit of frequency"),
        ("1,,5Hz", "is not a quantity"), ("1,five,10Hz", "is not a quantity"),
    ],
)  # fmt: skip
def test_list_of_frequencies_that_may_mean_something_else_is_refused(text, message):
    with pytest.raises(DataError, match=re.escape(message)):
        parse_frequencies(text)


def test_list_of_frequencies_equals_the_option_repeated(fit, tmp_path):
    path = tmp_path / "fit.json"
    dp.save(fit, path)
    listed, repeated = (
        ran("predict", path, *words, "--json").stdout
        for words in (
            ["--frequency", "1,5,10Hz", "--frequency", "20Hz"],
            [word for f in (1, 5, 10, 20) for word in ("--frequency", f"{f}Hz")],
        )
    )
    assert listed == repeated
    assert json.loads(listed)["frequencies"] == [1, 5, 10, 20]


@pytest.mark.parametrize("is_joint", [True, False])
def test_fit_with_a_hammer_has_the_error_of_its_band_and_no_advice_on_a_hammer(is_joint):
    records = [dp.simulate("relaxation", seed=4)] * is_joint
    fit = dp.fit(*records, dp.simulate("impact", seed=4), mass="114.8g", seals=2)
    error = fit.evidence.band_error
    low, high = fit.band
    for frequency in (1.2 * low, math.sqrt(low * high), 12.7, high / 1.2):
        prediction = dp.predict(fit, frequency=frequency)
        (check,) = [item for item in prediction.checks if item.name == "loss_factor_determined_at"]
        assert "add a hammer test" not in check.message_with_remedy
        value = next(item for item in prediction.values if item.name == "loss_factor")
        at = float(np.interp(math.log(frequency), np.log(error.frequency), error.loss_factor))
        assert value.high / value.value - 1 == pytest.approx(at, rel=0.02)
        assert 1 - value.low / value.value == pytest.approx(min(at, 1.0), rel=0.02)
        assert check.value == (pytest.approx(at, rel=0.02) if value.low > 0 else math.inf)
