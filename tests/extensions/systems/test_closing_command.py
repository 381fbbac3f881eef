"""dashpot predict DOOR --close: from a file to the least speed, and what it must say."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from kit import shell
from kit.fits import a_fit

import dashpot as dp
from dashpot.base.number_format import round_to_error
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.systems.door.closing_setup import (
    Cabin,
    CheckStrap,
    InterSealAir,
    Latch,
    Tolerances,
    Vents,
)
from dashpot.extensions.systems.door.read import read_door
from dashpot.extensions.systems.door.read_closing import read_closing
from dashpot.report.first_screen import MARK_ORDER
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.workflow.json_archive import to_json

pytestmark = pytest.mark.once

DOOR = """
[door]
mass = "25kg"
width = "1.1m"
height = "1.2m"
centre = "0.55, 0.6, 0 m"
[[hinge]]
at = "0, 300, 0 mm"
stiffness = "5kN/mm"
[[hinge]]
at = "0, 900, 0 mm"
stiffness = "5kN/mm"
[seal]
fit = "fit.json"
points = ["200, 0, 0 mm", "1100, 0, 0 mm", "1100, 1200, 0 mm", "200, 1200, 0 mm"]
normal = [0, 0, -1]
compression = "6mm"
"""
ALL = """
[closing]
friction = "1N*m"
start = "5deg"
[closing.check]
angle = "0, 4 deg"
moment = "0, 1 N*m"
[closing.latch]
travel = "0, 5 mm"
force = "50, 0 N"
[closing.vents]
width = "8mm"
hollow = "14mm"
hole = "5mm"
spacing = "50mm"
[closing.between]
width = "15mm"
depth = "12mm"
leak = "2mm"
process = "isothermal"
[closing.cabin]
volume = "2.8m^3"
opening = "600cm^2"
discharge = 0.7
[closing.variation]
gap = "1mm"
force = "15%"
correlation = "0.4m"
doors = 12
seed = 4
limit = "1m/s"
"""


def test_a_page_of_a_door_tells_of_modes_and_closing(tmp_path):
    fit = a_fit(10 * GeneralizedMaxwell(200.0, (60.0,), (0.5,)), specimen=Specimen(length=0.05),
                band=(1e-3, 0.5))  # fmt: skip
    (tmp_path / "fit.json").write_text(to_json(fit))
    closing = '[closing]\nstart = "5deg"\n[closing.variation]\ngap = "1mm"\ndoors = 5\nseed = 4\n'
    (tmp_path / "door.toml").write_text(f'{DOOR}pitch = "100mm"\n{closing}')
    page = tmp_path / "page.html"
    done = shell.did("predict", tmp_path / "door.toml", "--close", "1m/s", "--band", "1:120Hz",
                     "--json", "-o", page)  # fmt: skip
    document, text = json.loads(done.stdout), page.read_text(encoding="utf-8")
    # the whole bar of a mode is all of it, and the cells are the document's numbers
    bars = re.findall(r'<svg class="shares".*?</svg>', text)
    assert len(bars) == 2 * len(document["modes"]) > 0
    for bar in bars:
        assert sum(map(float, re.findall(r'width="([\d.]+)%"', bar))) == pytest.approx(100, abs=0.1)
    for mode in document["modes"]:
        assert f"<b>{round_to_error(mode['frequency_hz'], digits=4)}</b>" in text
    for name in ("figure-line", "figure-shapes", "figure-waterfall", "figure-doors", "figure-frf"):
        assert text.count(f'id="{name}"') == 1
    assert f">{document['verdict']['verdict_grade'].capitalize()}<" in text
    marks = re.findall(r'<dd class="state (\w+)"', text.partition("</dl>")[0])
    worst = {"use": {"good", "note"}, "use with care": {"care"}, "do not use": {"bad"}}
    assert max(marks, key=MARK_ORDER.index) in worst[document["verdict"]["verdict_grade"]]


def ran(*words, code=0):
    return shell.did("predict", *words, code=code).output


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    solid = GeneralizedMaxwell(50 / 6e-3 / 10)
    fit = a_fit(solid, specimen=Specimen(length=0.1), band=(1e-3, 1e3))
    (tmp_path / "fit.json").write_text(to_json(fit))
    (tmp_path / "door.toml").write_text(DOOR)
    return tmp_path


def test_the_least_speed_of_a_file(folder):
    document = json.loads(ran(folder / "door.toml", "--close", "1m/s", "--json"))
    assert document["schema"] == "dashpot/closing@2"
    assert document["least_speed"] == pytest.approx(0.328634, abs=1e-4)
    assert document["energy"] == pytest.approx(4.1667, abs=1e-4)
    taken = {term["name"]: term["work"] for term in document["terms"]}
    assert taken["seal, elastic"] == pytest.approx(0.45, rel=1e-3)
    assert "it closes" in ran(folder / "door.toml", "--close", "1m/s")
    assert "The door does not close" in ran(folder / "door.toml", "--close", "0.3m/s")


def test_every_term_has_its_table(folder, tmp_path):
    (folder / "door.toml").write_text(DOOR + ALL)
    setup = read_door(folder / "door.toml").closing
    assert setup.friction == 1.0
    assert setup.start == pytest.approx(0.0872665)
    assert setup.check == CheckStrap((0.0, 4 * np.pi / 180), (0.0, 1.0))
    assert setup.latch == Latch((0.0, 0.005), (50.0, 0.0), 1.1)
    assert setup.vents == Vents(0.62, 1.4, 0.008, 0.008 * 0.014, np.pi / 4 * 0.005 * 0.005 / 0.05)
    assert setup.inter_seal_air == InterSealAir(0.62, 1.0, 0.015, 0.012, 0.002)
    assert setup.cabin == Cabin(0.7, 1.4, 2.8, 1.1 * 1.2, 0.55, 0.06)
    assert setup.variation == Tolerances(1e-3, 0.15, 0.4, 12, 4, 1.0)
    picture, output = tmp_path / "closing.svg", tmp_path / "closing.json"
    words = ran(
        folder / "door.toml", "--close", "2m/s", "--plot", picture, "-o", output, "--overwrite"
    )
    names = ("hinge friction", "check", "latch", "vents", "air between seals", "cabin air")
    assert all(name in words for name in names)
    assert all(name in picture.read_text() for name in names)
    document = json.loads(output.read_text())
    assert len(document["scatter"]["least_speed"]) == 12
    assert "12 doors, gap ±1 mm the same over 0.4" in words


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('[closing]\nspeed = "1m/s"', "'speed' is unknown"),
        ('[closing]\nfriction = "-1N*m"', "friction = -1.0"),
        ('[closing.vents]\nwidth = "8mm"', "hollow is missing"),
        ('[closing.cabin]\nvolume = "2.8"\nopening = "1cm^2"', "has no unit"),
        ('[closing.cabin]\nvolume = "2m^3"\nopening = "-1cm^2"', "opening"),
        ("[closing.variation]\ndoors = 1.5", "whole number"),
        ('[closing.check]\nangle = "0, 4 deg"\nmoment = "0 N*m"', "as many of both"),
        ('[closing.between]\nwidth="1mm"\ndepth="1mm"\nprocess="slow"', "adiabatic or isoth"),
    ],
)
def test_what_cannot_be_is_refused(folder, text, message):
    (folder / "door.toml").write_text(DOOR + text)
    words = ran(folder / "door.toml", "--close", "1m/s", code=2)
    assert message in " ".join(words.split())


def test_what_is_missing_is_named(folder):
    (folder / "door.toml").write_text(DOOR.replace('compression = "6mm"', ""))
    assert "how far it is pressed" in " ".join(
        ran(folder / "door.toml", "--close", "1m/s", code=2).split()
    )
    with pytest.raises(dp.ReadError, match="lever is missing"):
        read_closing("[closing]", {"latch": {"travel": "0, 1 mm", "force": "1, 0 N"}})
    ran(folder / "door.toml", "--close", "1m/s", "--modes", code=2)


def test_modes_and_closing_go_together(folder, monkeypatch):
    monkeypatch.chdir(folder)
    closing = json.loads(ran("door.toml", "--close", "1m/s", "--json"))
    both = json.loads(ran("door.toml", "--modes", "--close", "1m/s", "--json"))
    assert both["closing"] == closing
    assert {name for name in both if name != "closing"} == set(
        json.loads(ran("door.toml", "--json"))
    )
    result = ran("door.toml", "--modes", "--close", "1m/s", "-v")
    assert "% of the energy" in result
    assert "Least closing speed" in result
    refused = ran("door.toml", "--modes", "--close", "1m/s", "--plot", "both.png", code=2)
    assert "leave out --modes or --close" in refused
