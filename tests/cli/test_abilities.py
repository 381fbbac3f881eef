"""The commands refuse invalid input of every extension in one sentence."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from kit.shell import ran

import dashpot as dp
from dashpot.extensions.materials.cld.fit_files import apply_elastic_law
from dashpot.extensions.materials.csr.examples import EXAMPLES as OVENS
from dashpot.extensions.materials.drop.examples import EXAMPLES as DROP_TESTS
from dashpot.solids.elastic import ElasticLaw
from dashpot.workflow.json_archive import to_json

ROOT = Path(__file__).parents[2]
LAW = ElasticLaw((0.0, 4e-3, 8e-3), (0.6, 0.9, 1.6), 200.0)
DOOR = """
[door]
mass = "25kg"
width = "1.1m"
height = "1.2m"
centre = "550, 600, 0 mm"
[[hinge]]
at = "0, 300, 0 mm"
stiffness = "5kN/mm"
[seal]
fit = "fit.json"
length = "100mm"
points = ["0, 0, 0 m", "1, 0, 0 m", "1, 1, 0 m"]
normal = [0, 0, -1]
compression = "6mm"
pitch = "50mm"
"""
DOORS = {
    "door.toml": ("", ""),
    "number.toml": ("normal =", "shear = 0.35\nnormal ="),
    "less.toml": ("normal =", "shear = {across = -0.2}\nnormal ="),
    "more.toml": ("normal =", "shear = {across = 30}\nnormal ="),
    "rub.toml": ("normal =", "friction = {mu = -0.4}\nnormal ="),
    "along.toml": ("[0, 0, -1]", "[1, 0, 0]"),
    "nowhere.toml": ("[0, 0, -1]", "[0, 0, 0]"),
    "kilo.toml": ('"100mm"', '"100kg"'),
    "even.toml": ('"50mm"', '"0mm"'),
    "light.toml": ('"25kg"', '"0kg"'),
    "metres.toml": ('"6mm"', '"6m"'),
    "bare.toml": (DOOR[DOOR.index("[seal]") :], ""),
}
DECK = "--allow all --unit-system mm-t-s --length 100mm --temperature 23degC --line"
RIG = "--mass 114.8g --seals 2"
DROP = "predict bent.json --mass 200g --drop"
AGED = "predict csr.json --temperature 70degC --end"

ROWS = (
    # 1, the paper
    ("demo --paper --mass 104g", "No such option '--mass'"),
    ("demo --paper --files", "leave out --files"),
    ("demo --story --files", "leave out --files"),
    ("demo --story --paper", "leave out one"),
    ("demo --seed 1", "--seed is for --story and --paper"),
    ("demo --paper --all", "--all is for the files to learn on"),
    ("demo --paper -o slam.csv", "nothing can be written to"),
    ("demo --paper -o paper --plot x.svg", "No such option '--plot'"),
    ("fit slam.csv --method half", "'half' is unknown"),
    # 2, ovens
    ("predict csr.json", "Add that of the seal: --temperature 70degC"),
    ("predict csr.json --temperature -300degC", "below absolute zero"),
    (f"{AGED} 150%", "expected 1 to 99 % of the force"),
    (f"{AGED} nan%", "expected 1 to 99 % of the force"),
    (f"{AGED} -5h", "expected more than 30 min"),
    (f"{AGED} 50mm", "a part of the force with its sign"),
    (f"{AGED} 50% --mass 104g", "--mass is for a fit"),
    (f"{AGED} 50% --unaged-fit fit.json", "aged for one time at one temperature"),
    ("fit once.csv", "at least 3 readings"),
    ("fit before.csv", "Count the time from the compression"),
    ("fit ovens.csv --machine oven=-1K", "expected a number >= 0"),
    ("predict fit.json --end 50%", "--end is for a record of compression stress relaxation"),
    # 3, the line
    ("predict number.toml", "[seal.shear] is 0.35; expected a table of keys, such as across"),
    ("predict less.toml", "across = -0.2; expected 0 to 3 of the stiffness normal"),
    ("predict more.toml", "across = 30; expected 0 to 3 of the stiffness normal"),
    ("predict rub.toml", "mu = -0.4; expected more than 0"),
    ("predict along.toml", "runs along its own normal"),
    ("predict nowhere.toml", "expected a direction"),
    ("predict kilo.toml", "'kg' is a unit of mass"),
    ("predict even.toml", "pitch = 0"),
    ("predict light.toml", "mass 0 kg"),
    ("predict metres.toml", "a compression of 6 m: in mm?"),
    (f"export fit.json --to nastran {DECK} bare.toml --band 5:50Hz", "add one with fit, points"),
    (f"export fit.json --to adams {DECK} door.toml", "Those of nastran, abaqus, ansys, lsdyna"),
    (f"export fit.json --to calculix {DECK} door.toml --nominal -3Hz", "nominal = -3"),
    (f"export fit.json --to nastran {DECK} door.toml --nominal 0Hz --band 5:50Hz", "nominal = 0"),
    # 4, a level
    (f"predict fit.json {RIG} --amplitude 0.1N", "the elastic law of this fit is linear"),
    (f"predict bent.json {RIG} --amplitude -0.1N", "expected an amplitude > 0"),
    (f"predict bent.json {RIG} --amplitude nanN", "is not a quantity"),
    (f"predict bent.json {RIG} --amplitude 0.1mm", "expected a unit of force"),
    (f"predict bent.json {RIG} --amplitude 2N", "lifts the mass off the seal"),
    (f"predict bent.json {RIG} --amplitude 0.1N --base", "expected a unit of acceleration"),
    ("predict bent.json --amplitude 0.1N", "Give the test mass"),
    ("predict bent.json --mass 0g --amplitude 0.1N", "expected a number > 0"),
    ("predict bent.json --mass 10mg --amplitude 0.1N", "so slight a contact was not tested"),
    # 5, an impact
    ("predict bent.json --drop 0.6m/s", "an impact needs the mass of what moves"),
    ("predict bent.json --drop 0.6m/s --mass 0g", "mass = 0.0"),
    (f"{DROP} -0.6m/s", "expected a number > 0"),
    (f"{DROP} 0.6", "expected the speed at the touch with its unit"),
    (f"{DROP} nanm/s", "expected the speed at the touch with its unit"),
    (f"{DROP} 0.6m/s --base", "--drop is not"),
    (f"{DROP} 0.6m/s --amplitude 0.1N", "--drop is not"),
    (f"{DROP} 0.6m/s --radius 5mm", "No such option '--radius'"),
    ("fit slam.csv", "impacts need the mass"),
    ("fit slam.csv --mass 200g --radius 5mm", "--radius is for a rebound indentation"),
    ("fit slam.csv --mass 200g --drop 0m/s", "expected a number > 0"),
    ("fit slam.csv --mass 200g --relaxation csr.json", "expected a fit"),
    # 6, parts
    (f"predict fit.json {RIG} --shape disc:20mm,20mm", "a shape is given to a material's modulus"),
    ("predict fit.json --mass 104g --shape disc:20kg,20mm", "'kg' is a unit of mass"),
    ("predict fit.json --mass 104g --shape disc:20mm", "has one length; expected 2"),
    ("predict fit.json --mass 104g --shape ball:20mm", "ball"),
    ("predict fit.json --mass 104g --shape disc:0mm,20mm", "expected a length > 0"),
    ("predict fit.json --mass 104g --shape disc:nanmm,20mm", "is not a quantity"),
)  # fmt: skip


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("abilities")
    fit = dp.fit(dp.simulate("relaxation", hold="5s", noise_free=True), arms=2)
    (place / "fit.json").write_text(to_json(fit))
    (place / "bent.json").write_text(to_json(apply_elastic_law(fit, LAW)))
    for name, (old, new) in DOORS.items():
        (place / name).write_text(DOOR.replace(old, new, 1))
    ovens, slams = OVENS["ovens.csv"].write(), DROP_TESTS["slam.csv"].write()
    (place / "ovens.csv").write_text(ovens)
    (place / "slam.csv").write_text(slams)
    head, *rows = (line for line in ovens.splitlines() if not line.startswith("#"))
    (place / "once.csv").write_text("\n".join([head, *(row for row in rows if row[:3] == "0.5")]))
    (place / "before.csv").write_text("\n".join([head, *("-" + row for row in rows)]))
    (place / "csr.json").write_text(to_json(dp.fit(dp.read(place / "ovens.csv"))))
    return place


@pytest.mark.parametrize(("words", "message"), ROWS, ids=[item for item, _ in ROWS])
def test_command_refuses_invalid_input_in_one_sentence(
    folder: Path, monkeypatch: pytest.MonkeyPatch, words: str, message: str
) -> None:
    monkeypatch.chdir(folder)
    done = ran(*words.split())
    assert done.exit_code == 2, done.output
    assert message in " ".join(done.stderr.split())
    assert "a fault in dashpot" not in done.stderr


def test_every_test_that_the_page_names_is_there() -> None:
    page = (ROOT / "docs" / "accuracy.md").read_text(encoding="utf-8")
    named = re.findall(r"`(tests/[\w/]+\.py)(?:::(\w+))?`", page)
    assert len(named) > 20
    for path, name in named:
        text = (ROOT / path).read_text(encoding="utf-8")
        assert f"def {name}(" in text or not name, f"{path}::{name}"
