"""The functions of the API accept what files hold and report what they refuse."""

from __future__ import annotations

import contextlib
import re
from pathlib import Path

import numpy as np
import pytest

import dashpot as dp
from dashpot.api import OPTION_CLASSES, convert_option
from dashpot.api.fit import shape_words
from dashpot.base.option_fields import iterate_option_fields
from dashpot.registry import load_object
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.solids.demo_seals import BROAD
from dashpot.solids.part_geometry import Disc
from dashpot.workflow.example_files import FILES, MASS

#: example file -> the record that it is, and the result of a fit of it
RECORDS = {
    "seal_8mm.csv": ("RelaxationTest", "Fit"),
    "hammer.csv": ("ImpactTest", "ImpactResult"),
    "sweep.csv": ("DynamicTest", "Fit"),
    "curve.csv": ("RelaxationModulus", "Fit"),
    "cld_1.csv": ("CLDTest", "CLDResult"),
    "tension.csv": ("StressStrainTest", "HyperelasticFit"),
    "ovens.csv": ("CSRTest", "Aging"),
    "loops.csv": ("AmplitudeSweep", "AmplitudeFit"),
}


@pytest.fixture(scope="session")
def examples(tmp_path_factory):
    """Write an example file, once, and return its place."""
    folder = tmp_path_factory.mktemp("examples")

    def place(name):
        path = folder / name
        if not path.exists():
            path.write_text(FILES[name].write(), encoding="utf-8")
        return path

    return place


@pytest.mark.parametrize("name", [name for name in RECORDS if name in FILES])
def test_a_file_is_read_and_fitted_as_what_it_is(examples, name):
    record, result = RECORDS[name]
    read = dp.read(examples(name))
    assert type(read).__name__ == record
    fit = dp.fit(read)
    assert type(fit).__name__ == result
    assert fit.verdict.use in {"use", "use with care", "do not use"}
    assert fit.checks
    assert str(fit).startswith(("Use", "Do not use"))


def test_every_kind_of_record_has_an_example_here():
    kinds = {FILES[name].kind for name in RECORDS if name in FILES}
    assert kinds >= {
        "relaxation",
        "impact",
        "dma",
        "modulus",
        "cld",
        "stress-strain",
        "csr",
        "cyclic",
    }


def test_read_checks_the_requested_kind(examples):
    assert isinstance(dp.read(examples("seal_8mm.csv"), kind="relaxation"), dp.RelaxationTest)
    with pytest.raises(dp.DashpotError, match="relaxatio"):
        dp.read(examples("seal_8mm.csv"), kind="relaxatoin")


def test_read_joins_several_files_only_if_all_are_hammer_records(examples):
    hits = dp.read([examples("hammer.csv")])
    assert isinstance(hits, dp.ImpactTest)
    with pytest.raises(dp.ReadError, match=r"hammer\.csv is a hammer test.*dp\.fit\(one, two\)"):
        dp.read([examples("seal_8mm.csv"), examples("hammer.csv")])


def test_results_are_read_back(examples, tmp_path):
    fit = dp.fit(dp.read(examples("seal_8mm.csv")), arms=2)
    assert dp.save(fit, tmp_path / "fit.json") is fit
    assert dp.read(tmp_path / "fit.json") == fit
    assert fit.save(tmp_path / "fit.svg").read_text().startswith("<!--")
    assert list(fit.to_pandas().columns)
    with pytest.raises(dp.ExportError, match=r"written as \.json"):
        fit.save(tmp_path / "fit.xlsx")
    fit.save(tmp_path / "fit.html")
    assert f"{fit.model.k_inf:.4g}"[:3] in (tmp_path / "fit.html").read_text(encoding="utf-8")
    with pytest.raises(dp.ExportError, match=r"no page of its own"):
        dp.save(fit.elastic_law, tmp_path / "law.html")


def test_fit_of_hits_and_frf_under_a_mass_agree(examples):
    hits, test = dp.read(examples("hammer.csv")), dp.read(examples("seal_8mm.csv"))
    frf = hits.frf()
    assert dp.fit(hits)[0].frequency == pytest.approx(frf.modes()[0].frequency, rel=1e-9)
    assert type(dp.fit(frf)).__name__ == "MeasuredModes"
    fit = dp.fit(hits, mass=MASS, seals=2)
    assert (fit.method, type(fit)) == ("frf", dp.Fit)
    joint = dp.fit(test, hits, mass=MASS, seals=2)
    mended = dp.fit(dp.fit(test), hits, mass=MASS, seals=2)
    assert joint.method == mended.method == "joint"
    line = frf.stiffness(mass=MASS, seals=2)
    near = np.abs(line.frequency - 12.7).argmin()
    assert line.storage[near] == pytest.approx(
        joint.model.storage(frequency=line.frequency[near]), rel=0.02
    )


#: a call that is wrong -> what is said of it
WRONG = {
    "fit nothing": (lambda test, hits: dp.fit(), "nothing to fit"),
    "fit a list": (lambda test, hits: dp.fit([test, test]), r"dp\.fit\(one, two\)"),
    "fit a path": (
        lambda test, hits: dp.fit("seal_8mm.csv"), r'Read the file first: dp\.read\("seal_8mm',
    ),
    "fit a path object": (lambda test, hits: dp.fit(Path("a.csv")), r'dp\.read\("a\.csv"\)'),
    "compare with a path": (
        lambda test, hits: dp.compare(dp.fit(test, arms=1), "hammer.csv"),
        r'the name of a file, and no record. Read the file first: dp\.read\("hammer',
    ),
    "compare of a path": (lambda test, hits: dp.compare("fit.json", hits), r"dp\.read\(FILE\)"),
    "predict a path": (lambda test, hits: dp.predict("fit.json", mass="1kg"), r"dp\.read\(FIT\)"),
    "predict a test": (lambda test, hits: dp.predict(test, mass="1kg"), "Fit a test first"),
    "export a path": (
        lambda test, hits: dp.export("fit.json", to="abaqus"), r'dp\.read\("fit\.json"\)',
    ),
    "read nothing": (lambda test, hits: dp.read(None), "None is no file and no table"),
    "inspect a number": (lambda test, hits: dp.inspect(3), "3 is no file and no table"),
    "units as text": (
        lambda test, hits: dp.read("x.csv", units="s, mm, N"),
        r"units= of dp\.read is 's, mm, N'; expected a mapping, such as units=\{\"time\": \"s\"",
    ),
    "units as a list": (
        lambda test, hits: dp.read("x.csv", units=["s", "mm", "N"]), "expected a mapping",
    ),
    "columns as text": (lambda test, hits: dp.read("x.csv", columns="F"), "expected a mapping"),
    "text as text": (lambda test, hits: dp.read("x.csv", text=","), "expected a mapping"),
    "part as a number": (lambda test, hits: dp.inspect("x.csv", part=2), "expected a mapping"),
    "fit a number": (lambda test, hits: dp.fit(3), "a int is no record"),
    "a mass is missing": (dp.fit, "Give the test mass"),
    "arms of hits": (lambda test, hits: dp.fit(hits, arms=2), r"arms= does not suit hits"),
    "a mass of a test": (lambda test, hits: dp.fit(test, mass="1g"), r"mass= does not suit tests"),
    "a word misspelt": (lambda test, hits: dp.fit(test, arm=2), r"arm= does not suit"),
    "prepared twice": (
        lambda test, hits: dp.fit(test.prepare(), filter="lowpass:10Hz"), "prepared already",
    ),
    "a rod without a shape": (
        lambda test, hits: dp.fit(hits, mass="1g", density=1100), "density and shape",
    ),
    "a mass in grams": (
        lambda test, hits: dp.predict(dp.fit(test, arms=1), mass=114.8), "check the mass",
    ),
    "a mass of a lorry": (
        lambda test, hits: dp.predict(dp.fit(test, arms=1), mass=1148.0), "the mass is 1.15 t",
    ),
    "a test is no prediction": (
        dp.compare, "a RelaxationTest is not compared with",
    ),
    "a report of hits": (lambda test, hits: dp.report(hits), r"dp\.report\(test, hits\)"),
    "a level without a sweep": (
        lambda test, hits: dp.predict(dp.fit(test, arms=1), mass="100g", level="1N"), "add a sweep",
    ),
    "mm for m": (
        lambda test, hits: dp.RelaxationTest(
            time=test.time, displacement=1e3 * test.displacement, force=test.force, units="SI"
        ),
        "the travel is",
    ),
    "no units": (
        lambda test, hits: dp.RelaxationTest(test.time, test.displacement, test.force),
        'units="s, mm, N"',
    ),
    "no such seal": (lambda test, hits: dp.simulate("impact", seal="x"), "paper, broad"),
    "a load of hits": (lambda test, hits: dp.simulate("impact", load="1N"), "load= does not suit"),
    "a batch of numbers": (lambda test, hits: dp.batch([[1.0, 2.0]]), r"dp\.batch\(forces"),
    "a file that is none": (lambda test, hits: dp.read("nowhere.csv"), "nowhere.csv"),
    "a role that is none": (
        lambda test, hits: dp.read("x.csv", columns={"forc": "F"}), "'forc' is no role",
    ),
    "a word that is none": (
        lambda test, hits: dp.read("x.csv", colums={}), "colums= does not suit",
    ),
}  # fmt: skip


@pytest.fixture(scope="module")
def records(examples):
    return dp.read(examples("seal_8mm.csv")), dp.read(examples("hammer.csv"))


@pytest.mark.parametrize("what", WRONG)
def test_a_wrong_call_is_answered_in_a_sentence(records, what):
    call, message = WRONG[what]
    with pytest.raises(dp.DashpotError, match=message) as output:
        call(*records)
    assert "Traceback" not in str(output.value)
    assert len(re.findall(r"[.:]", str(output.value))) >= 1


@pytest.mark.parametrize("name", [name for name in dp.__all__ if name[0].isupper()])
def test_every_public_class_shows_how_it_is_used(name):
    assert ">>> " in (getattr(dp, name).__doc__ or ""), f"dp.{name} has no example"


@pytest.mark.parametrize("name", [name for name in dp.__all__ if callable(getattr(dp, name))])
def test_every_verb_says_what_it_raises(name):
    doc = getattr(dp, name).__doc__
    if name[0].islower():
        assert ">>> " in doc
        assert "Raises" in doc


def test_shape_words_accepts_text_and_shape_objects():
    for name in ("disc", "block", "bush", "bulb"):
        assert shape_words(f"{name}:1mm,2mm") == {name: "1mm,2mm"}
    assert shape_words(Disc(0.02, 0.01)) == {"disc": "0.02m,0.01m"}
    for wrong in ("ball:1mm", "disc"):
        with pytest.raises(dp.DataError, match="expected a shape with its lengths"):
            shape_words(wrong)


@pytest.mark.parametrize("name", ["mine.json", "mine.csv", "mine.svg", "mine.html"])
def test_save_replaces_only_what_dashpot_wrote(records, name: str, tmp_path: Path) -> None:
    path, foreign = tmp_path / name, b"time;force\n0;1\n"
    fit = dp.fit(records[0], arms=2)
    result = dp.predict(fit, mass="100g") if name.endswith("csv") else fit
    path.write_bytes(foreign)
    with pytest.raises(dp.ExportError, match="--overwrite"):
        dp.save(result, path)
    with pytest.raises(dp.ExportError, match="--overwrite"):
        result.save(path)
    assert path.read_bytes() == foreign
    dp.save(result, path, overwrite=True)
    dp.save(result, path)  # its own file


def test_export_replaces_only_what_dashpot_wrote(tmp_path: Path) -> None:
    path, foreign = tmp_path / "seal.bdf", "$ a deck of my own\n"
    solid = dp.GeneralizedMaxwell(200.0, k=(100.0,), tau=(0.5,))
    deck = {
        "to": "nastran", "unit_system": "mm-t-s", "temperature": "23degC", "length": "50mm",
        "band": "1:20Hz", "allow": "all",
    }  # fmt: skip
    path.write_text(foreign)
    with pytest.raises(dp.ExportError, match="--overwrite"):
        dp.export(solid, path, **deck)
    assert path.read_text() == foreign
    dp.export(solid, path, **deck, overwrite=True)
    dp.export(solid, path, **deck)


@pytest.mark.parametrize("name", sorted(OPTION_CLASSES))
def test_option_of_several_values_is_a_mapping_or_refused(name):
    """Every such option of every verb: whatever else it is given is a sentence."""
    expected = [field.name for field in iterate_option_fields(load_object(OPTION_CLASSES[name]))]
    for wrong in ((0, 1), "11s", 5, [1.0], object()):
        with pytest.raises(dp.DataError, match=f"{name}= is of the type .*; expected a mapping"):
            convert_option(name, wrong)
    with pytest.raises(dp.DataError, match=f"furlong= does not suit {name}="):
        convert_option(name, {"furlong": 1})
    kind = load_object(OPTION_CLASSES[name])
    assert convert_option(name, {}) == kind()
    assert convert_option(name, kind()) == kind()
    assert convert_option(name, None) is None
    assert expected


def test_fit_and_report_take_time_limits_and_machine_as_mappings():
    test = dp.simulate("relaxation", hold="8s")
    limits, machine = {"hold_end": "8s"}, {"compliance": "0.1mm/N"}
    by_mapping = dp.fit(test, arms=1, time_limits=limits, machine=machine)
    prepared = test.prepare(hold_end=8.0, machine=dp.Machine(**machine))
    assert by_mapping.model == dp.fit(prepared, arms=1).model
    study = dp.report(test, arms=1, time_limits=limits, machine=machine)
    assert study.fit.model == by_mapping.model
    with pytest.raises(dp.DataError, match="time_limits= is of the type tuple"):
        dp.report(test, arms=1, time_limits=(0, 8))


@pytest.mark.parametrize("wrong", [[{}], [{"time": [1.0]}], [], (1, 2), [None], iter([b""])])
def test_read_refuses_a_list_of_what_is_no_path(wrong):
    with pytest.raises(dp.DataError, match=r"Read each table by itself: dp\.read\(TABLE\)"):
        dp.read(wrong)


@pytest.mark.parametrize("name", sorted(FILES))
def test_read_of_any_example_is_a_record_or_a_sentence(name, examples):
    """Whatever is stated beside it; any other exception would be a fault."""
    for stated in ({}, {"specimen": {"temperature": "23degC"}}):
        with contextlib.suppress(dp.DashpotError):
            assert dp.read(examples(name), **stated) is not None


def test_read_says_what_holds_no_record(examples):
    with pytest.raises(dp.ReadError, match=r"door_modes.csv is .*, which holds no record"):
        dp.read(examples("door_modes.csv"))
    with pytest.raises(dp.DataError, match=r"specimen= does not suit rod\.csv"):
        dp.read(examples("rod.csv"), specimen=dp.Specimen())


def test_fit_takes_scalars_of_numpy() -> None:
    test = simulate_relaxation(BROAD, hold_time=5.0, seed=1).test
    fit = dp.fit(test, arms=2, method="hold")
    assert dp.fit(test, arms=np.int64(2), method="hold").model == fit.model
