"""dashpot predict DOOR: from a file to modes, FRFs, a base that shakes; and what it must say."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from kit import shell
from kit.fits import a_fit
from kit.foreign.door_files import render_hinged_door

from dashpot.datamodel.shift_factors import Shift, TemperatureShifts
from dashpot.datamodel.specimen import Specimen
from dashpot.solids.demo_seals import BROAD, SHIFT
from dashpot.solids.elastic import ElasticLaw
from dashpot.workflow.example_files import EXAMPLES
from dashpot.workflow.json_archive import from_json, to_json

pytestmark = pytest.mark.once

PLATE = render_hinged_door(hinge="5kN/mm", latch="1kN/mm", pitch="20mm")
LINE = PLATE[PLATE.index("points") :]
ROUND = "points = [{}]\n".format(
    ", ".join(
        f'"{550 * (1 + np.cos(turn)):.3f}, {600 * (1 + np.sin(turn)):.3f}, 0 mm"'
        for turn in np.linspace(0, 2 * np.pi, 48, endpoint=False)
    )
)


ran = partial(shell.did, "predict")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A plate on ten broad seals of 50 mm to a line, tested far and wide."""
    fit = a_fit(10 * BROAD, specimen=Specimen(length=0.05, temperature=296.15), band=(1e-3, 1e3))
    (tmp_path / "fit.json").write_text(to_json(fit))
    (tmp_path / "door.toml").write_text(PLATE)
    return tmp_path


def predict_door(folder: Path, old: str = "", new: str = "", *words: str) -> dict:
    text = PLATE.replace(old, new, 1)
    assert not old or text != PLATE
    (folder / "door.toml").write_text(text)
    return json.loads(ran(folder / "door.toml", "--json", *words).stdout)


def get_check(document: dict, name: str) -> dict:
    return next(check for check in document["checks"] if check["name"] == name)


def test_the_rigid_door_of_the_reference(folder):
    """58.26584, 91.13105 and 205.63511 Hz, computed apart: there the integral is exact."""
    document = predict_door(folder, '"20mm"', '"10mm"', "--band", "1:250Hz")
    modes = document["modes"]
    exact = [(58.26584, 0.0024313), (91.13105, 0.0012544), (205.63511, 0.000119)]
    for mode, (frequency, ratio) in zip(modes, exact, strict=True):
        assert mode["frequency_hz"] == pytest.approx(frequency, rel=5e-6)
        assert mode["damping_ratio"] == pytest.approx(ratio, rel=1e-3)
        assert mode["loss_factor"] == pytest.approx(2 * ratio, rel=0.01)
    bare = [mode["without_seal_hz"] for mode in modes]
    assert bare == pytest.approx([54.404, 87.173, 204.014], abs=1e-3)
    assert document["seal"]["length"] == pytest.approx(4.6)
    assert document["seal"]["stiffness"] == pytest.approx(4.6 * 200 * BROAD.k_inf)
    assert document["verdict"]["verdict_grade"] == "use"
    point = document["frf"]["points"]["farthest from the hinges"]
    f = np.array(document["frf"]["frequency_hz"])
    top = {
        name: f[np.argmax(np.abs(np.array(entry["real"]) + 1j * np.array(entry["imag"])))]
        for name, entry in point.items()
    }
    assert top["sealed"] == pytest.approx(205.6, abs=0.15)
    assert min(abs(top["bare"] - value) for value in bare) < 0.1


@pytest.mark.parametrize(
    ("celsius", "frequencies", "ratios"),
    [
        (-20, [57.79719, 90.60847, 205.40435], [1.1e-6]),
        (80, [57.94382, 91.00565, 205.67290], [0.0125267, 0.0069561, 0.0008755]),
    ],
)
def test_the_same_door_in_the_cold_and_in_the_heat(folder, celsius, frequencies, ratios):
    """WLF, stiffness as T: numbers computed apart, where the seal is integrated exactly."""
    kelvin = [253.15, 296.15, 353.15]
    shifts = tuple(Shift(T, float(np.log10(SHIFT.a_t(T))), 0.0, T / 296.15) for T in kelvin)
    temperature_shifts = TemperatureShifts(
        SHIFT, shifts, np.zeros((6, 6)), ("c1", "c2"), np.zeros((2, 2)), vertical="T/T_r"
    )
    specimen = Specimen(length=0.05, temperature=296.15)
    fit = a_fit(10 * BROAD, specimen=specimen, temperatures=temperature_shifts)
    (folder / "fit.json").write_text(to_json(fit))
    words = ("--band", "1:250Hz", "--temperature", f"{celsius}degC")
    modes = predict_door(folder, '"20mm"', '"10mm"', *words)["modes"]
    assert [mode["frequency_hz"] for mode in modes] == pytest.approx(frequencies, rel=5e-6)
    damped = [mode["damping_ratio"] for mode in modes[: len(ratios)]]
    assert damped == pytest.approx(ratios, rel=1e-3, abs=6e-8)


def test_the_example_end_to_end(tmp_path):
    for name in ("door.toml", "door_line.csv", "door_modes.csv"):
        (tmp_path / name).write_text(EXAMPLES[name](), encoding="utf-8")
    fit = a_fit(BROAD, specimen=Specimen(length=0.1, temperature=296.15))
    (tmp_path / "fit.json").write_text(to_json(fit))
    written, figure = tmp_path / "door.json", tmp_path / "door.svg"
    text = ran(tmp_path / "door.toml", "--modes", "--plot", figure, "-o", written).output
    assert "damping is not known at" in " ".join(text.split())
    # every part has its shares, on one screen
    (head,) = [line for line in text.splitlines() if line.split()[:2] == ["mode", "Hz"]]
    assert re.split("  +", head.strip()) == [
        "mode", "Hz", "damping, %", "lower hinge", "upper hinge", "latch", "seal", "door",
    ]  # fmt: skip
    first = text.partition(head)[2].splitlines()[1].split()
    shares = [cell.split("/") for cell in first[3:]]
    assert len(shares) == 5
    assert sum(float(energy) for energy, _ in shares) == pytest.approx(100, abs=1)
    assert len(text.splitlines()) <= 24
    assert max(map(len, text.splitlines())) <= 100
    document = json.loads(written.read_text())
    assert [share["name"] for share in document["modes"][0]["shares"]] == [
        "lower hinge", "upper hinge", "latch", "seal", "door",
    ]  # fmt: skip
    for mode in document["modes"]:
        assert sum(share["energy"] for share in mode["shares"]) == pytest.approx(1)
        assert mode["loss_factor"] == pytest.approx(2 * mode["damping_ratio"], rel=0.06)
    (shaken,) = document["random"]
    assert shaken["sealed"]["stretch"] < shaken["bare"]["stretch"]
    drawn = figure.read_text()
    assert all(
        word in drawn for word in ("pressed", "seal line goes out", "without the seal", "SIMULATED")
    )


def test_door_reports_a_seal_that_does_not_touch(folder):
    gaps = 'height = "20mm"\ngap = "14, 14, 26, 26 mm"\npitch'
    document = predict_door(folder, "pitch", gaps)
    assert not get_check(document, "seal_touches")["passed"]
    assert "do not touch" in get_check(document, "seal_touches")["message"]
    whole = predict_door(folder)
    assert document["seal"]["touching"] == pytest.approx(0.5, abs=0.01)
    assert document["seal"]["stiffness"] == pytest.approx(
        document["seal"]["touching"] * whole["seal"]["stiffness"]
    )
    assert document["modes"][0]["frequency_hz"] < whole["modes"][0]["frequency_hz"]


def test_door_uses_the_tangent_of_a_stiffening_seal(folder):
    """Twice the secant at 8 mm: as stiff as two linear seals there, and loaded by its law."""
    law = ElasticLaw((0.0, 0.008), (0.0, 2.0), 10 * BROAD.k_inf)
    fit = a_fit(10 * BROAD, specimen=Specimen(length=0.05), band=(1e-3, 1e3), elastic_law=law)
    (folder / "fit.json").write_text(to_json(fit))
    document = predict_door(folder, "pitch", 'compression = "8mm"\npitch')
    assert document["seal"]["stiffness"] == pytest.approx(2 * 4.6 * 200 * BROAD.k_inf)
    assert document["seal"]["force"] == pytest.approx(4.6 * 200 * BROAD.k_inf * 0.008)
    deeper = predict_door(folder, "pitch", 'compression = "9mm"\npitch')
    assert not get_check(deeper, "compression_tested")["passed"]
    (folder / "door.toml").write_text(PLATE)
    assert "how far it is pressed along the line is not stated" in ran(
        folder / "door.toml", code=2
    ).output.replace("\n", " ").replace("  ", " ")


@pytest.mark.parametrize(
    ("old", "new", "name"),
    [
        ('[latch]\nat = "1.1, 0.6, 0 m"\nstiffness = "1kN/mm"\n', "", None),
        ("closed = true\n", "", "line_closed"),
        ('pitch = "20mm"', 'pitch = "2m"', None),  # exact: the door is rigid, the line straight
        # so it is where the seal lifts off: the line is cut there
        ('pitch = "20mm"', 'height = "20mm"\ngap = "14, 14, 22, 22 mm"\npitch = "2m"',
         "seal_touches"),
        (LINE, ROUND + 'closed = true\npitch = "20mm"', None),
        (LINE, ROUND + 'closed = true\npitch = "1m"', "stations_suffice"),
        ('["z", "rx", "ry"]', '["x", "z", "rx", "ry"]', None),
        ('stiffness = "5kN/mm"\n[[hinge]]', 'along = [0, 0, 1]\nstiffness = "5kN/mm"\n[[hinge]]',
         None),
    ],
)  # fmt: skip
def test_door_checks_detect_invalid_doors(folder, old, new, name):
    failed = {c["name"] for c in predict_door(folder, old, new)["checks"] if c["passed"] is False}
    assert failed - {"bound_known"} == set((name or "").split())


def test_door_reports_an_unsupported_motion(folder):
    hinged = PLATE.replace('motions = ["z", "rx", "ry"]\n', "")
    for _ in range(2):
        hinged = hinged.replace(
            'stiffness = "5kN/mm"', 'along = [0, 0, 1]\nstiffness = "5e3N/mm"', 1
        )
    latch = 'at = "1.1, 0.6, 0 m"\n'
    (folder / "door.toml").write_text(hinged.replace(latch, latch + "along = [0, 0, 1]\n"))
    document = json.loads(ran(folder / "door.toml", "--json").stdout)
    assert "3 motions of the door are free" in get_check(document, "door_supported")["message"]


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ('fit = "fit.json"', 'fit = "none.json"', "none.json: there is no such file"),
        ('fit = "fit.json"', 'fit = "door.toml"', "this is not a JSON document; expected a fit"),
        ("pitch", 'temperature = "0degC"\npitch', "nothing says how the model shifts to 0 degC"),
        ("pitch", 'height = "2m"\ngap = "1.9m"\npitch', "was tested to"),
        ("[seal]", '[[point]]\nat = "0, 0, 0 m"\non = "body"\n[seal]', "which stands still"),
        ("[latch]", '[base]\npsd = "1g"\n[latch]', "expected a density in g^2/Hz"),
        ('mass = "25kg"\n', "", "the door has no mass"),
        ('mass = "25kg"', 'mass = "25t"', "mass 25000 kg; expected that of a door, 0.05 to 500 kg"),
    ],
)
def test_what_a_door_cannot_be(folder, old, new, sentence):
    law = ElasticLaw.linear(10 * BROAD.k_inf, 0.008)
    specimen = Specimen(length=0.05, temperature=296.15)
    fit = a_fit(10 * BROAD, specimen=specimen, elastic_law=law)
    (folder / "fit.json").write_text(to_json(fit))
    text = PLATE.replace(old, new, 1)
    assert text != PLATE
    (folder / "door.toml").write_text(text)
    message = " ".join(ran(folder / "door.toml", code=2).output.split())
    assert sentence in message
    assert "Traceback" not in message


@pytest.mark.parametrize(
    ("change", "word", "sentence"),
    [
        (("mode,frequency", "mode,frequency"), 'modal_mass = "1t"', "weigh 25000 kg"),
        (("uz", "ux"), "", "no rigid motions of their points"),
        (("x [mm],y [mm],z [mm]", "x [m],y [m],z [m]"), "", "mm from the seal at"),
        (("mode,", "number,"), "", "no column is named mode"),
        (("mode,frequency", "mode,frequency"), 'most = "0.5Hz"', "too few to judge"),
    ],
)
def test_door_reports_contradicting_plate_modes(tmp_path, change, word, sentence):
    """A slip of unit or axes is caught, or stated in the first lines."""
    for name in ("door.toml", "door_line.csv", "door_modes.csv"):
        text = EXAMPLES[name]().replace("[modes]", "[modes]\n" + word)
        (tmp_path / name).write_text(text.replace('"25mm"', '"200mm"'))
    path = tmp_path / "door_modes.csv"
    path.write_text(path.read_text().replace(*change))
    fit = a_fit(BROAD, specimen=Specimen(length=0.1), band=(1e-3, 1e3))
    (tmp_path / "fit.json").write_text(to_json(fit))
    result = shell.ran("predict", tmp_path / "door.toml", "--json", "--strict")
    assert sentence in result.output.replace("\n  ", " ")


def test_export_of_a_door_line_has_its_stiffness(folder):
    gaps = 'height = "20mm"\ngap = "14, 14, 26, 26 mm"\npitch'
    (folder / "door.toml").write_text(PLATE.replace("pitch", gaps))
    words = ["export", folder / "fit.json", "--to", "nastran", "--unit-system", "mm-t-s", "--line",
             folder / "door.toml", "-o", folder / "line.bdf"]  # fmt: skip
    result = shell.ran(*words)
    assert result.exit_code == 0, result.output
    text = (folder / "line.bdf").read_text()
    assert text.count("CBUSH") == 116
    assert "116 more do not touch and are left out" in text
    result = shell.ran(*words, "--normal", "0,0,1", "--overwrite")
    assert result.exit_code == 2


def test_door_lists_a_fitted_bumper_next_to_the_latch(folder):
    bumper = '[[bumper]]\nat = "1.1, 0.6, 0 m"\nalong = [0, 0, 1]\nfit = "fit.json"\n[seal]'
    document = predict_door(folder, "[seal]", bumper)
    names = [share["name"] for share in document["modes"][0]["shares"]]
    assert names == ["hinge 1", "hinge 2", "latch", "bumper", "seal"]


def test_door_reports_modes_outside_the_valid_band_in_json(folder):
    fit = from_json((folder / "fit.json").read_text())
    evidence = replace(fit.evidence, band=(0.0, 0.0))
    (folder / "fit.json").write_text(to_json(replace(fit, evidence=evidence)))
    check = get_check(predict_door(folder), "door_modes_in_valid_band")
    assert (check["passed"], check["value"]) == (False, "Infinity")
