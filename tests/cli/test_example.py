"""The example files: simulated and stamped, the same every time, and worth learning on."""

from __future__ import annotations

import shlex

import pytest
from kit.shell import ran, run_json

import dashpot as dp
from dashpot import workflow
from dashpot.fitting.relaxation import fit as fit_tests
from dashpot.reading.readers.detect_kind import recognise
from dashpot.reading.readers.impact import read_impact
from dashpot.reading.readers.relaxation import read_relaxation
from dashpot.solids.demo_seals import BROAD
from dashpot.vibration.impact.frf_estimation import estimate_frf
from dashpot.workflow.example_files import FILES
from dashpot.workflow.job import BlockOnSeals
from dashpot.workflow.study import characterise

ROD = ("--shape", "disc:20mm,20mm", "--density", "1000", "--mass", "31.4g")
NO_FIT = {"line.csv", "door.toml", "door_line.csv", "door_modes.csv", "preload_map.csv"}
"""What is fitted by another command, or no record: lines of seals, a door and its modes."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("learn") / "lab"
    made = run_json("demo", "--files", "-o", path, "--all")
    assert made["files"] == [str(path / name) for name in workflow.EXAMPLES]
    return path


def test_demo_writes_two_files_unless_all_are_requested(tmp_path):
    done = ran("demo", "--files", "-o", tmp_path / "lab")
    assert done.exit_code == 0, done.output
    assert {path.name for path in (tmp_path / "lab").iterdir()} == set(workflow.FIRST)
    assert done.stderr.splitlines()[-1].startswith("next: dashpot report ")


def test_they_are_small_and_stamped(folder):
    assert {path.name for path in folder.iterdir()} == set(workflow.EXAMPLES)
    for name in FILES:
        text = (folder / name).read_text("utf-8")
        assert len(text) < 1e6
        assert text.startswith("# ")
        assert "simulated" in text.splitlines()[0]
    assert sum((folder / name).stat().st_size for name in workflow.FIRST) < 1.1e6


@pytest.mark.parametrize("name", FILES)
def test_a_file_is_always_the_same(folder, name):
    assert (folder / name).read_text("utf-8") == FILES[name].write()


def test_fit_of_first_example_recovers_the_simulated_seal(folder):
    test, hits = read_relaxation(folder / "seal_8mm.csv"), read_impact(folder / "hammer.csv")
    assert test.source.simulated
    study = characterise(
        test,
        estimate_frf(hits, mass=workflow.MASS),
        impact=hits,
        block=BlockOnSeals(workflow.MASS, 2),
    )
    assert study.verdict.use == "use"
    assert study.joint_comparison.damping_ratio_error == pytest.approx(0, abs=0.02)
    # the bench alone misses the damping: the story that the pages tell
    assert study.comparison.verdict.use == "do not use"
    truth = BROAD.complex_stiffness(omega=2 * 3.141592653589793 * 12.71)
    stiffness = study.joint.model.complex_stiffness(omega=2 * 3.141592653589793 * 12.71)
    assert abs(stiffness / truth - 1) < 0.01


def test_fit_detects_the_faults_of_the_bad_examples(folder):
    with pytest.raises(dp.DataError, match="The force is clipped"):
        fit_tests(read_relaxation(folder / "clipped.csv"))
    short = fit_tests(read_relaxation(folder / "short_hold.csv"))
    assert short.verdict.use != "use"


def test_fit_of_three_depths_recovers_one_elastic_law(folder):
    tests = [read_relaxation(folder / f"depth_{depth}mm.csv") for depth in (4, 6, 8)]
    fit = fit_tests(tests)
    assert fit.verdict.use == "use"
    law = fit.elastic_law
    for x in (2e-3, 5e-3, 8e-3):
        truth = 196.5 * (1 + 3 * 4000.0 * x**2)
        assert abs(law.tangent(x) / truth - 1) < 0.05


def test_every_example_has_a_caption() -> None:
    assert list(workflow.CAPTIONS) == list(workflow.EXAMPLES)


def test_a_material_goes_on_to_a_deck_and_its_temperature_with_it(folder, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = ran("fit", folder / "sweeps.csv", "--at-temperature", "25degC", "-o", "rubber.json")
    follow = shlex.split(done.stderr.splitlines()[-1].removeprefix("next: dashpot "))
    assert follow[:2] == ["export", "rubber.json"]
    deck = ran(*follow)
    assert deck.exit_code == 0, deck.output
    assert "(25 degC)" in deck.stdout


def test_fit_states_a_temperature_that_differs_from_the_header(folder, monkeypatch):
    monkeypatch.chdir(folder)
    words = ["fit", "at_23degC.csv", "--arms", "1", "-v", "--temperature"]
    message = "the header says 'temperature: 23 degC'; the temperature is 60 degC, as given"
    for inputs, differs in (("60degC", True), ("23degC", False)):
        assert (message in " ".join(ran(*words, inputs).stdout.split())) is differs


@pytest.mark.once
@pytest.mark.parametrize("name", workflow.EXAMPLES)
def test_fit_takes_every_example_or_says_why_not(folder, monkeypatch, name):
    """And takes it for what `inspect` says that it is."""
    monkeypatch.chdir(folder)
    inputs = {"hit.csv": ("--mass", "5g"), "slam.csv": ("--mass", "200g"), "rod.csv": ROD}
    words = inputs.get(name, ())
    done = ran("fit", name, *words)
    seen = recognise(name)
    assert dp.inspect(name).kind == seen.kind if name != "door.toml" else seen.kind == "door"
    if name in NO_FIT:
        assert done.exit_code == 2
        (sentence,) = done.stderr.strip().splitlines()
        assert sentence.startswith(f"dashpot: {name} is {seen.kind_title}: ")
    else:
        assert done.stderr.startswith(f"recognised {name}: {seen.kind_title}\n")
        # a test that cannot be used is not fitted, and it is said why
        assert done.exit_code == (2 if name == "clipped.csv" else 0), done.output
        assert "Traceback" not in done.output
