"""Comparison of a fit with its own hits, and leave-one-out prediction of each hit."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest
from kit.shell import ran

import dashpot as dp
from dashpot.extensions.modes import leave_one_out as module
from dashpot.plot.frf_figure import curves_of
from dashpot.reading.readers.impact import read_impact
from dashpot.vibration.mass_on_seals import MassOnSeals
from dashpot.workflow.example_files import EXAMPLES
from dashpot.workflow.job import HammerChoices

pytestmark = pytest.mark.once
RIG = ("--mass", "114.8g", "--seals", "2")


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("joint")
    for name in ("seal_8mm.csv", "hammer.csv"):
        (folder / name).write_text(EXAMPLES[name](), encoding="utf-8")
    made = ran(
        "fit", folder / "seal_8mm.csv", folder / "hammer.csv", *RIG, "--arms", "4",
        "-o", folder / "joint.json",
    )  # fmt: skip
    assert made.exit_code == 0, made.output
    return folder


def run_compare(folder, *words):
    result = ran("compare", folder / "joint.json", folder / "hammer.csv", *RIG, *words, "--json")
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


def test_a_comparison_with_the_hits_that_were_fitted_says_so_first(files):
    result = run_compare(files)
    assert result["in_sample"] is True
    assert result["unmeasured"] is None
    assert result["verdict"]["message"].startswith("The peak frequency is off by ")
    assert result["verdict"]["verdict_grade"] == "no test"
    assert "The fit was made from these hits." in result["verdict"]["message"]


def test_an_frf_and_its_hits_are_one_measurement_however_often_written(files):
    """The fit may be of the FRF and the comparison with the hits, and an FRF be written again."""
    frf, again, fit = files / "first.csv", files / "again.csv", files / "of_frf.json"
    assert ran("fit", files / "hammer.csv", "-o", frf).exit_code == 0
    dp.read(frf).save(again)
    made = ran("fit", files / "seal_8mm.csv", frf, *RIG, "--arms", "4", "-o", fit)
    assert made.exit_code == 0, made.output
    text = frf.read_text(encoding="utf-8")
    foreign = files / "foreign.csv"
    foreign.write_text(
        "".join(line for line in text.splitlines(True) if "made from" not in line),
        encoding="utf-8",
    )
    for of, with_ in ((fit, frf), (fit, files / "hammer.csv"), (files / "joint.json", again)):
        assert json.loads(ran("compare", of, with_, *RIG, "--json").stdout)["in_sample"] is True
    for of in (fit, files / "joint.json"):
        document = json.loads(ran("compare", of, foreign, *RIG, "--json").stdout)
        assert not document.get("in_sample")


def test_an_frf_written_from_the_fitted_hits_is_no_other_measurement(files):
    """Its file is another one, and names the hits that it was estimated from."""
    assert ran("fit", files / "hammer.csv", "-o", files / "frf.csv").exit_code == 0
    for more in ((), ("--record", files / "seal_8mm.csv")):
        result = ran("compare", files / "joint.json", files / "frf.csv", *RIG, *more, "--json")
        assert result.exit_code == 0, result.output
        document = json.loads(result.stdout)
        assert document["in_sample"] is True
        assert document["verdict"]["verdict_grade"] == "no test"
    fit = dp.fit(dp.read(files / "seal_8mm.csv"), arms=2)
    other = dp.compare(fit, dp.read(files / "frf.csv"), mass="114.8g", seals=2)
    assert other.in_sample is False


def test_leave_one_out_predicts_each_hit(files):
    result = run_compare(files, "--record", files / "seal_8mm.csv")
    unmeasured = result["unmeasured"]
    assert unmeasured["hits"] >= 3
    assert 0.001 < unmeasured["error"] < 0.1
    low, high = unmeasured["height_error"]
    assert -0.1 < low <= high < 0.1
    assert f"{100 * unmeasured['error']:.2g} % rms" in result["verdict"]["message"]


def test_another_record_is_no_circle_and_the_legend_says_which_solid(files):
    joint, hits = dp.read(files / "joint.json"), dp.read(files / "hammer.csv")
    fit = dp.fit(dp.read(files / "seal_8mm.csv"), arms=2)
    comparison = dp.compare(joint, hits, mass="114.8g", seals=2)
    other = dp.compare(fit, hits, mass="114.8g", seals=2)
    fresh = dp.compare(joint, dp.simulate("impact", hits=3), mass="114.8g", seals=2)
    assert (comparison.in_sample, other.in_sample, fresh.in_sample) == (True, False, False)
    (check,) = [
        check for check in comparison.checks if check.name == "measurement_independent_of_fit"
    ]
    assert (check.passed, check.grade) == (False, "note")
    names = [curves_of(item.comparison, None)[1].label for item in (comparison, other, fresh)]
    assert names == [
        "fitted to these hits", "predicted from relaxation", "predicted by the joint model",
    ]  # fmt: skip


def test_leave_one_out_compares_each_hit_with_the_other_hits(files, monkeypatch):
    impact = read_impact(files / "hammer.csv")
    fit = dp.read(files / "joint.json")
    seen: list[set[str]] = []
    inner = module.average

    def average(impact, *, choices):
        frf = inner(impact, choices=choices)
        seen.append({hit.name for hit in frf.hits if hit.accepted})
        return frf

    monkeypatch.setattr(module, "average", average)
    monkeypatch.setattr(module, "identify", lambda *_, **__: fit)
    cross_validate_hits = module.cross_validate_hits(
        impact, (), fit, MassOnSeals(0.1148, 2), choices=HammerChoices()
    )
    whole, *pairs = seen
    assert cross_validate_hits is not None
    assert 2 * cross_validate_hits.hits == len(pairs) == 2 * min(len(whole), 8)
    for rest, pair in zip(pairs[::2], pairs[1::2], strict=True):
        assert len(pair) == 1
        assert rest == whole - pair
    assert set().union(*pairs[1::2]) <= whole


def test_a_hit_taken_the_other_way_round_is_turned(files):
    whole = module.average(read_impact(files / "hammer.csv"), choices=HammerChoices())
    turned = replace(whole, value=-whole.value)
    for item in (whole, turned):
        assert (module._as_signed(item.band(5, 40), whole).value == whole.band(5, 40).value).all()
