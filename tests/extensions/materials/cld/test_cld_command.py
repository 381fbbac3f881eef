"""dashpot fit: files of specimens to figures, scatter and Cpk."""

from __future__ import annotations

import json

import numpy as np
import pytest
from kit import shell
from kit.cld import bulb, fit_of, press_cycles

import dashpot as dp
from dashpot.extensions.batch.statistics.process_capability import capability
from dashpot.extensions.materials.cld.preprocess import cld
from dashpot.extensions.materials.cld.read import read_cld
from dashpot.workflow.json_archive import from_json, to_json

pytestmark = pytest.mark.once
SCALES = (1.0, 1.04, 0.97, 1.01)
WORDS = ("--length", "50mm", "--compression", "6mm", "--compression-limits", "4:7.5mm")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pieces")
    for number, scale in enumerate(SCALES, start=1):
        press_cycles(bulb, scale=scale, seed=number, softening=0.05).write(
            folder / f"p{number}.csv"
        )
    press_cycles(bulb, speed=2e-3, softening=0.05).write(folder / "slow.csv")
    press_cycles(bulb, softening=0.05).write(folder / "unclocked.csv", clock=False)
    return folder


def ran(folder, *words, code=0):
    words = [str(folder / word) if word.endswith(".csv") else word for word in words]
    return shell.did("fit", *words, code=code)


def read_result(folder, *words):
    return json.loads(ran(folder, *words, "--json").stdout)


def test_fit_writes_every_figure_of_one_specimen(folder):
    result = read_result(folder, "p1.csv", *WORDS)
    assert result["schema"] == "dashpot/cld@2"
    assert result["unit"] == "N per 100 mm"
    (specimen,) = result["specimens"]
    assert specimen["length"] == 0.05
    assert len(specimen["sha256"]) == 64
    assert [cycle["number"] for cycle in specimen["cycles"]] == [1, 2, 3, 4]
    nominal = specimen["nominal"]
    assert nominal["per_100mm"]["loading"] == pytest.approx(2 * nominal["loading"])
    assert specimen["least"]["compression"] == pytest.approx(4e-3)
    test = read_cld(folder / "p1.csv", specimen=dp.Specimen(length="50mm"))
    assert cld(test, at="6mm").nominal.loading == nominal["loading"]
    assert result["scatter"] == []
    assert result["capability"] is None


def test_pieces_scatter_as_they_were_made(folder):
    files = [f"p{number}.csv" for number in range(1, 5)]
    result = read_result(folder, *files, *WORDS, "--force-limits", "4:6.5N")
    force = next(entry for entry in result["scatter"] if entry["name"] == "force at nominal")
    spread = np.std(SCALES, ddof=1) / np.mean(SCALES)
    assert force["deviation"] / force["mean"] == pytest.approx(spread, rel=0.05)
    values = [specimen["nominal"]["per_100mm"]["loading"] for specimen in result["specimens"]]
    assert result["capability"]["cpk"] == capability(np.array(values), 4.0, 6.5).cpk
    names = {check["name"]: check["passed"] for check in result["checks"]}
    assert names["specimens_tested_alike"] is True
    stdout = ran(folder, *files, *WORDS, "--force-limits", "4:6.5N").stdout
    assert "4 specimens" in stdout
    assert "Cpk" in stdout


def test_fit_reports_forces_per_piece_without_a_length(folder):
    stdout = ran(folder, "unclocked.csv", "--compression", "6mm", "-v").stdout
    assert "loading, N " in stdout
    assert "length_stated" in stdout
    assert "N per 100 mm" not in stdout.split("checks")[0]
    assert read_result(folder, "unclocked.csv")["specimens"][0]["cycles"][0]["speed"] is None


def test_fit_reports_specimens_tested_at_other_speeds(folder):
    result = read_result(folder, "p1.csv", "slow.csv", *WORDS, "--force-limits", "4:6.5N")
    assert "speed" in next(
        c["message"] for c in result["checks"] if c["name"] == "specimens_tested_alike"
    )


def test_a_figure_is_drawn(folder, tmp_path):
    path = tmp_path / "a.svg"
    ran(folder, "p1.csv", *WORDS, "--plot", str(path))
    assert "N per 100 mm" in path.read_text()
    ran(folder, "p1.csv", "p2.csv", "--plot", str(path), "--overwrite")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["p1.csv", "--force-limits", "1:2N"], "several specimens"),
        (["p1.csv", "p1.csv"], "same record as"),
        (["p1.csv", "--compression", "12mm"], "at most 7.99"),
        (["p1.csv", "--file-part", "cycle=9"], "holds 4 cycles"),
        (["p1.csv", "--compression", "6N"], "length"),
    ],
)
def test_what_does_not_go_is_refused(folder, words, message):
    assert message in ran(folder, *words, code=2).stderr


@pytest.mark.parametrize(
    ("head", "message"),
    [
        (
            "time [s],displacement [m],force [N]",
            "mm. Give mm as the unit of the displacement",
        ),
        (
            "time [s],displacement [um],force [N]",
            "mm. Give mm as the unit of the displacement",
        ),
        (
            "time [s],displacement [mm],force [MN]",
            "kN. Give kN as the unit of the force",
        ),
        ("time [s],displacement [mm],force", "unit"),
    ],
)
def test_fit_asks_about_a_wrong_unit(tmp_path, head, message):
    path = press_cycles(bulb).write(tmp_path / "a.csv", head=head)
    assert message in ran(tmp_path, path.name, code=2).stderr


def test_inspect_names_the_kind(folder):
    for name in ("p1.csv", "unclocked.csv"):
        assert '"cld"' in shell.ran("inspect", folder / name, "--json").stdout
    assert "recognised p1.csv: " in ran(folder, "p1.csv").stderr


def test_fit_with_relaxation_writes_the_elastic_law(folder, tmp_path):
    fit = fit_of(bulb)
    (folder / "fit.json").write_text(to_json(fit))
    words = ("p1.csv", "--compression", "6mm", "--relaxation", str(folder / "fit.json"))
    law = tmp_path / "law.json"
    result = read_result(folder, *words, "-o", str(law))
    assert result["relaxed"]["residual_hysteresis"] == pytest.approx(0, abs=0.01)
    written = from_json(law.read_text())
    assert list(written.elastic_law.knots) == result["relaxed"]["elastic_law"]["knots"]
    assert "tangent, N/mm" in ran(folder, *words).stdout
    twice = read_result(folder, *words, "--relaxation", str(folder / "fit.json"))
    names = [check["name"] for check in twice["checks"]]
    assert names.count("relaxed_agrees") == 2
    assert "relaxation_tests_agree" in names
    single = tmp_path / "alone.json"
    assert read_result(folder, "p1.csv", "-o", str(single)) == json.loads(single.read_text())


def test_fit_of_several_speeds_is_one_model(folder, tmp_path):
    law = tmp_path / "law.json"
    words = ("p1.csv", "slow.csv", "--compression", "6mm")
    result = read_result(folder, *words, "-o", str(law))
    assert result["fit"] == json.loads(law.read_text())
    assert result["scatter"] == []
    assert result["fit"]["method"] == "cld"
    names = {check["name"] for check in result["checks"]}
    assert {
        "speeds_spread",
        "slowest_stroke_quasi_static",
        "single_relaxation_explains_speeds",
    } <= names
    assert len(result["rate"]["damping"]) == len(result["rate"]["knots"])
    stdout = ran(folder, *words).stdout
    assert "elastic law" in stdout
    assert "c, N s/m" not in stdout
    every = ran(folder, *words, "-v").stdout
    assert "explain the speeds worse than one relaxation" in " ".join(every.split())
    assert "c, N s/m" in every
