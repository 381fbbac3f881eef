"""Compression stress relaxation as a user meets it: inspect, fit, predict, batch."""

from __future__ import annotations

import base64
import json
import re
from pathlib import Path

import pytest
from kit.shell import ran, run_json

import dashpot as dp
from dashpot.extensions.materials.csr.examples import EXAMPLES


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("csr")
    (place / "ovens.csv").write_text(EXAMPLES["ovens.csv"].write())
    done = ran("fit", place / "ovens.csv", "--machine", "oven=1K", "-o", place / "csr.json",
               "--plot", place / "csr.svg")  # fmt: skip
    assert done.exit_code == 0, done.output
    assert "recognised ovens.csv: a record of compression stress relaxation" in done.stderr
    assert f"predict {place / 'csr.json'} --temperature 70degC --end 50%" in done.stderr
    assert "activation energy" in done.stdout
    return place


def test_inspect_says_what_it_is(folder):
    (result,) = run_json("inspect", folder / "ovens.csv")["files"]
    assert result["kind"] == "csr"
    # rows that are read by hand have no rate that could be wrong
    assert not result["warnings"]


def test_a_document_is_predicted_from(folder):
    document = json.loads((folder / "csr.json").read_text())
    assert document["schema"] == "dashpot/csr@2"
    assert document["oven_sd"] == 1.0
    result = run_json("predict", folder / "csr.json", "--temperature", "70degC", "--end", "50%",
                 "--end", "1000h", "--plot", folder / "aged.svg")  # fmt: skip
    life, cold, retention = result["values"]
    assert life["low"] < 3600 * 101430 < life["high"]
    assert cold["name"] == "life_if_Ea_falls"
    assert retention["low"] < 0.8964 < retention["high"]
    assert (folder / "aged.svg").stat().st_size > 1000
    again = dp.read(folder / "csr.json")
    aged = dp.predict(again, temperature="70degC")
    assert aged.facts[0].value == pytest.approx(life["value"])
    assert dp.read(dp.save(aged, folder / "aged.json") and folder / "aged.json").temperature


def test_a_seal_is_aged_for_a_mass_a_door_and_a_deck(folder):
    """The factor is the law's own at 70 degC; every stiffness is that of the new seal times it."""
    new = dp.simulate("relaxation", hold="5s", noise_free=True)
    dp.save(dp.fit(new, arms=2), folder / "fit.json")
    aged = "predict", folder / "csr.json", "--temperature", "70degC", "--end"
    run_json(*aged, "1000h", "--unaged-fit", folder / "fit.json", "-o", folder / "old.json")
    value = run_json(*aged, "1000h")["values"][0]
    before, after = dp.read(folder / "fit.json"), dp.read(folder / "old.json")
    assert after.model.k_inf == pytest.approx(value["value"] * before.model.k_inf)
    assert after.model.tau == pytest.approx(before.model.tau)
    peaks = [dp.predict(item, mass="104g", seals=2).modes[0].frequency for item in (before, after)]
    assert peaks[1] / peaks[0] == pytest.approx(value["value"] ** 0.5, rel=1e-3)
    deck = ran("export", folder / "old.json", "--to", "abaqus", "--unit-system", "SI",
               "--temperature", "23degC", "--length", "100mm", "--allow", "all")  # fmt: skip
    assert "is left after 1000 h at 70 degC" in deck.stdout
    for until in ("50%", "1000h --end 2000h"):
        bad = ran(*aged, *until.split(), "--unaged-fit", folder / "fit.json")
        assert (bad.exit_code, "a seal is aged for one time" in bad.stderr) == (2, True)


def test_a_limit_is_an_exit_code(folder):
    words = "predict", folder / "csr.json", "--temperature", "20degC"
    assert ran(*words, "--strict").exit_code == 1
    assert ran(*words).exit_code == 0


def test_the_help_of_a_file_shows_what_it_takes(folder):
    shown = ran("fit", folder / "ovens.csv", "--help").output
    assert "--machine" in shown
    assert "--temperature" in shown
    assert "--model" not in shown
    assert "--length" not in shown


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["predict", "csr.json", "--temperature", "70degC", "--mass", "1kg"], "--mass is for"),
        (["predict", "csr.json", "--temperature", "70degC", "--band", "1:2Hz"], "--band is for"),
        (["predict", "csr.json"], "--temperature 70degC"),
        (["fit", "ovens.csv", "--arms", "2"], "--arms is for"),
        (["fit", "ovens.csv", "--model", "maxwell"], "--model does not suit"),
        (["fit", "ovens.csv", "--length", "1m"], "--length does not suit"),
        (["fit", "ovens.csv", "--machine", "oven=1degC"], "--machine oven=1K"),
        (["fit", "ovens.csv", "--machine", "sync=1ms"], "sync= does not suit"),
        (["fit", "ovens.csv", "-o", "csr.csv"], "written as .json"),
    ],
)
def test_what_does_not_suit_is_refused_by_name(folder, words, message):
    verb, name, *rest = words
    done = ran(verb, folder / name, *rest)
    assert done.exit_code == 2
    assert message in done.stderr


@pytest.mark.parametrize(
    ("requested", "name"),
    [
        (("fit", "ovens.csv", "--machine", "oven=1K"), "csr"),
        (("predict", "csr.json", "--temperature", "70degC"), "aged"),
    ],
)
def test_a_page_holds_what_the_command_prints(
    folder: Path, tmp_path: Path, requested: tuple[str, ...], name: str
) -> None:
    verb, file, *rest = requested
    page = tmp_path / "page.html"
    printed = run_json(verb, folder / file, *rest, "-o", page)
    text = page.read_text(encoding="utf-8")
    (link,) = re.findall(
        rf'download="{name}.json" href="data:application/json;base64,([^"]+)"', text
    )
    assert json.loads(base64.b64decode(link)) == printed
    assert f">{printed['verdict']['verdict_grade'].capitalize()}<" in text
    assert 'id="figure-lead"' in text
    assert len(re.findall(rf"<td>{name}</td>", text)) == len(printed["checks"])
    assert ">ovens.csv<" in text
