"""The life at a temperature of use: chart over 1/T, lives of a page, and how far they reach."""

from __future__ import annotations

import re
from functools import cache

import numpy as np
import pytest
from kit.fits import list_failed_checks
from kit.foreign.aging import HOURS, Rubber, lot
from kit.shell import ran, run_json

import dashpot as dp
from dashpot.base.errors import DataError
from dashpot.datamodel.machine import Machine
from dashpot.extensions.materials.csr.datamodel import CSRTest
from dashpot.extensions.materials.csr.examples import EXAMPLES
from dashpot.extensions.materials.csr.figure import draw_life, draw_life_chart
from dashpot.extensions.materials.csr.fit import fit_aging
from dashpot.extensions.materials.csr.life_table import find_extrapolation_limit, list_lives
from dashpot.extensions.materials.csr.lifetime_prediction import fit_life, predict_aging
from dashpot.plot.picture import Area, Dots, Line, Span, Tag

TRUE = Rubber()


def make_test(rubber=TRUE, seed=0, **how):
    record = lot(rubber, seed, **how)
    return CSRTest(
        record.hours, record.force, record.celsius, record.specimen_number, units="h, N, degC"
    )


@cache
def exact():
    return fit_aging([make_test(off=0.0, noise=1e-9)], machine=Machine(oven=1.0, drift=0.0))


@cache
def fit_usual_lot():
    return fit_aging([make_test()], machine=Machine(oven=1.0, drift=0.0))


def marks_of(picture, kind, label):
    (panel,) = picture.panels[:1]
    return next(item for item in panel.marks if isinstance(item, kind) and item.label == label)


def test_the_line_of_the_chart_is_the_life_of_the_rubber():
    for label in ("law", "below the coldest oven"):
        line = marks_of(draw_life_chart(exact(), 0.5), Line, label)
        true = [TRUE.life(1000 / x - 273.15) for x in line.x]
        assert line.y == pytest.approx(true, rel=2e-4)


def test_chart_places_each_oven_by_its_readings():
    dots = marks_of(draw_life_chart(exact(), 0.8), Dots, "each oven by itself")
    assert 1000 / dots.x - 273.15 == pytest.approx([100, 125, 150])
    assert dots.y == pytest.approx([TRUE.life(c, 0.8) for c in (100, 125, 150)], rel=1e-3)


def test_the_line_of_a_lower_energy_bends_at_the_coldest_oven():
    line = marks_of(draw_life_chart(exact(), 0.5), Line, "if Ea is 65 kJ/mol there")
    tau = TRUE.time(100.0)
    flat = Rubber(hours=tau * np.exp(65e3 / 8.314462618 * (1 / 398.15 - 1 / 373.15)), energy=65e3)
    assert line.y == pytest.approx([flat.life(1000 / x - 273.15) for x in line.x], rel=2e-4)


def test_the_marked_life_and_its_interval_are_those_of_the_prediction():
    chart = draw_life_chart(fit_usual_lot(), 0.5, 343.15)
    fact = predict_aging(fit_usual_lot(), temperature="70degC").answers[0]
    tag = next(item for item in chart.panels[0].marks if isinstance(item, Tag))
    assert (1000 / tag.x, 3600 * tag.y) == pytest.approx((343.15, fact.value))
    assert re.fullmatch(r"70 °C: [\d.]+ years \([\d.]+ to [\d.]+\)", tag.text)
    band = marks_of(chart, Area, "95 % interval")
    for side, end in ((band.low, fact.low), (band.high, fact.high)):
        at = np.exp(np.interp(1000 / 343.15, band.x, np.log(side)))
        assert 3600 * at == pytest.approx(end, rel=0.01)


def test_chart_hatches_temperatures_whose_prediction_is_marked():
    aging = exact()
    honest = find_extrapolation_limit(aging, 0.5)
    assert predict_aging(aging, temperature=honest).verdict.use == "use"
    assert predict_aging(aging, temperature=honest - 0.5).verdict.use != "use"
    span = marks_of(draw_life_chart(aging, 0.5), Span, "extrapolated too far")
    assert 1000 / span.low == pytest.approx(honest)
    for life in list_lives(aging, 0.5):
        assert (life.use == "use") is (life.temperature >= honest)
        assert life.life.value / 3600 == pytest.approx(
            TRUE.life(life.temperature - 273.15), rel=3e-4
        )


def test_the_table_goes_about_the_coldest_oven():
    lives = list_lives(fit_usual_lot(), 0.5)
    assert [round(life.temperature - 273.15) for life in lives] == list(range(40, 120, 10))
    assert [life.lower_energy_life is None for life in lives] == [False] * 6 + [True] * 2


@pytest.mark.parametrize(("hours", "fails"), [(HOURS, False), (HOURS[HOURS <= 168], True)])
def test_a_force_that_never_fell_so_far_is_marked(hours, fails):
    """At 150 degC 65 % are left after 168 h, and 12 % after 1000 h."""
    aging = fit_aging([make_test(hours=hours)], machine=Machine(oven=1.0, drift=0.0))
    result = predict_aging(aging, temperature="90degC")
    assert ("end_point_reached" in list_failed_checks(result)) is fails
    assert "end_point_reached" not in list_failed_checks(
        predict_aging(aging, temperature="90degC", until=["70%", "1000h"])
    )


def test_a_temperature_of_use_gives_the_life_there():
    record = make_test()
    aged = dp.fit(record, use_at="85degC", machine=Machine(oven=1.0))
    again = dp.predict(dp.fit(record, machine=Machine(oven=1.0)), temperature="85degC")
    assert aged == again
    life = aged.facts[0]
    assert life.low / 3600 < TRUE.life(85.0) < life.high / 3600
    with pytest.raises(DataError, match="one oven, at 125 degC, shows nothing of 40 degC"):
        fit_life([make_test(ovens=(125.0,))], use_at="40degC")


def test_a_time_or_one_oven_has_no_chart():
    later = predict_aging(fit_usual_lot(), temperature="70degC", until="1000h")
    assert draw_life(later).name == "aged"
    assert len(draw_life(later).panels) == 1
    assert len(draw_life(predict_aging(fit_usual_lot(), temperature="70degC")).panels) == 2


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("life")
    (place / "ovens.csv").write_text(EXAMPLES["ovens.csv"].write())
    return place


def test_fit_with_a_temperature_of_use_keeps_the_law_and_shows_the_life(folder):
    requested = "fit", folder / "ovens.csv", "--use-at", "85degC"
    document = run_json(*requested, "-o", folder / "csr.json")
    assert document["schema"] == "dashpot/aged@2"
    retained = run_json("predict", folder / "csr.json", "--temperature", "85degC")
    assert retained["values"] == document["values"]
    assert ran(*requested, "-o", folder / "life.html", "--plot", folder / "life.svg").exit_code == 0
    page = (folder / "life.html").read_text()
    for words in ("How long it seals", "At 85 °C", "Extrapolation", "Life at other temperatures"):
        assert words in page
    assert "if Ea is 65 kJ/mol there" in (folder / "life.svg").read_text()


def test_the_page_of_the_law_shows_lives(folder):
    ran("fit", folder / "ovens.csv", "-o", folder / "fit.html")
    page = (folder / "fit.html").read_text()
    assert "How long it seals" in page
    assert "Time until F/F0 is 50 %" in page


def test_ovens_exchanged_give_no_life_to_use():
    test = make_test()
    turned = CSRTest(
        test.time, test.force, test.temperature.max() + test.temperature.min() - test.temperature,
        test.specimen_number, units="SI",
    )  # fmt: skip
    life = fit_life([turned], use_at="85degC")
    assert "activation_energy_plausible" in list_failed_checks(life)
    assert life.verdict.use != "use"


def test_a_life_without_size_is_not_used():
    life = fit_life([make_test()], machine=Machine(oven=30.0), use_at="85degC")
    assert "aging_prediction_determined" in list_failed_checks(life)
    assert life.verdict.use == "use with care"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("85", "85degC"),
        ("-300degC", "--use-at = -26.85 K"),
        ("85mm", "temperature"),
        ("20degC --arms 2", "--arms is for"),
    ],
)
def test_fit_refuses_a_wrong_temperature_of_use(folder, words, message):
    done = ran("fit", folder / "ovens.csv", "--use-at", *words.split())
    assert done.exit_code == 2
    assert message in done.stderr


def test_a_limit_of_life_hangs_on_the_lower_energy_where_the_life_does():
    """Far below the ovens the interval reaches to the life by 65 kJ/mol, in an oven it does not."""
    cold = predict_aging(fit_usual_lot(), temperature="23degC")
    life, lower = cold.answers
    (limit,) = dp.files.read_limits("life >= 10 years").judge(cold).limits
    assert limit.lower == 10 * 365.25 * 86400
    assert (limit.value.low, limit.value.high) == (lower.low, life.high)
    assert (limit.outcome, limit.spread) == ("met", "bound")
    between = (lower.low * life.low) ** 0.5
    (limit,) = dp.files.read_limits(f"life >= {between!r}s").judge(cold).limits
    assert limit.outcome == "open"
    assert "65 kJ/mol" in limit.explanation
    assert "oven at a lower temperature" in limit.explanation
    warm = predict_aging(fit_usual_lot(), temperature="100degC")
    (limit,) = dp.files.read_limits("lifetime >= 1000h").judge(warm).limits
    assert (limit.value, limit.spread) == (warm.answers[0], "random")


def test_a_limit_of_life_asks_for_the_temperature_of_use(folder):
    (folder / "limits.toml").write_text('[life]\nlower = "10 years"\n')
    requested = "fit", folder / "ovens.csv", "--limits", folder / "limits.toml"
    run = ran(*requested)
    assert run.exit_code != 0
    assert "--use-at" in run.output
    acceptance = run_json(*requested, "--use-at", "85degC")["acceptance"]
    assert [limit["name"] for limit in acceptance["limits"]] == ["life"]


@pytest.mark.parametrize(("temperature", "is_noted"), [("23degC", True), ("100degC", False)])
def test_intervals_of_an_extrapolated_life_say_what_they_leave_out(folder, temperature, is_noted):
    page = folder / f"{temperature}.html"
    run = ran("fit", folder / "ovens.csv", "--use-at", temperature, "-o", page)
    for text in (" ".join(run.output.split()), page.read_text()):
        assert ("scatter of readings and ovens alone" in text) is is_noted
