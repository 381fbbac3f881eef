"""Every option of a fit and of a report acts or is refused; the next line gives the same solid."""

from __future__ import annotations

import json
import shlex
from collections.abc import Iterator
from pathlib import Path

import click
import pytest
from kit.shell import ran

from dashpot import workflow
from dashpot.cli import main
from dashpot.cli._command import CommandOption, DashpotCommand
from dashpot.report.first_screen import make_study_indicators
from dashpot.workflow.job import Job
from dashpot.workflow.recommended_solid import recommend_solid

RIG = ("--mass", "114.8g", "--seals", "2")
JOBS: dict[str, tuple[str, ...]] = {
    "relaxation": ("fit", "seal_8mm.csv"),
    "joint": ("fit", "seal_8mm.csv", "hammer.csv", *RIG),
    "fit and hammer": ("fit", "fit.json", "hammer.csv", *RIG),
    "hammer under a mass": ("fit", "hammer.csv", *RIG),
    "hits": ("fit", "hammer.csv"),
    "modes": ("fit", "frf.csv"),
    "masses": ("fit", "frf.csv", "frf2.csv", "--mass", "114.8g", "--mass", "115g"),
    "levels": ("fit", "frf.csv", "frf2.csv", "--amplitude", "0.02N", "--amplitude", "0.5N", *RIG),
    "sweep": ("fit", "sweep.csv"),
    "modulus": ("fit", "curve.csv"),
    "sweep and test": ("fit", "sweep.csv", "seal_8mm.csv"),
    "load deflection": ("fit", "cld_1.csv", "--compression", "6mm"),
    "stress over strain": ("fit", "tension.csv"),
    "indenter": ("fit", "hit.csv", "--mass", "5g", "--radius", "5mm"),
    "rod": ("fit", "rod.csv", "--shape", "disc:20mm,20mm", "--density", "1100", "--mass", "31.4g"),
    "loops": ("fit", "loops.csv"),
    "report": ("report", "seal_8mm.csv", "hammer.csv", *RIG),
    "report of a test": ("report", "seal_8mm.csv"),
}
"""Jobs of every kind, each of which runs as it stands."""
BY_DAY = {"hits", "modes", "masses", "levels", "sweep", "modulus", "load deflection"}
CHOICES: dict[str, tuple[str, ...]] = {
    "--model": ("fractional",), "--arms": ("4",), "--elastic": ("linear", "nonlinear", "by-depth"),
    "--band": ("9:16Hz",), "--amplitude": ("0.2N",), "--seals": ("3",), "--seal-mass": ("10g",),
    "--compression": ("2mm",), "--resonance-amplitude": ("0.1N",), "--mass": ("100g",),
    "--mass-sd": ("3g",), "--relative": ("",), "--prior": ("stiffness=0.2N/mm",),
    "--dashpot": ("",), "--method": ("hold",), "--time-limits": ("hold-end=20s",),
    "--machine": ("sync=0.5ms",), "--filter": ("lowpass:10Hz",), "--thorough": ("",),
    "--at-temperature": ("5degC",), "--reference": ("5degC",), "--shift": ("arrhenius",),
    "--vertical": ("1",), "--hammer-temperature": ("10degC",), "--estimator": ("H2",),
    "--window": ("exponential:0.5",), "--combine": ("weighted",), "--accept": ("1",),
    "--reject": ("1",), "--hit-length": ("4s",), "--pretrigger": ("20ms",), "--polarity": ("-1",),
    "--poisson": ("0.1",), "--terms": ("2",), "--test": ("planar",), "--stretches": ("0.7:1.5",),
    "--stress-is": ("true",), "--strain-is": ("true",), "--radius": ("6mm",),
    "--drop-height": ("50mm",), "--impact-velocity": ("1m/s",), "--drop": ("1m/s",),
    "--shape": ("disc:25mm,25mm",), "--lubricated": ("",), "--gain-error": ("2%",),
    "--phase-error": ("2deg",), "--glue-error": ("3%",),
    "--radius-error": ("1%",), "--density": ("1000",), "--compression-limits": ("4:8mm",),
    "--force-limits": ("1:2N",), "--temperature": ("30degC",), "--length": ("50mm",),
    "--height": ("20mm",), "--label": ("name=door",),
    "--use-at": ("60degC",), "--spring-stiffness": ("2N/mm",), "--spring-error": ("1%",),
    "--role": ("stop",), "--no-joint": ("",), "--title": ("X",),
}  # fmt: skip
"""Of every option that states a choice, values other than its default."""
NO_CHOICE = {
    "--stiffness-table",
    "--save-shifts",
    "--shifts",
    "--relaxation",
    "--project",
    "--logo",
}
"""Options that name a file to write or to read."""
TELLING = {"Result", "Reading the files"}


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("choices")
    names = {word for job in JOBS.values() for word in job if word in workflow.EXAMPLES}
    for name in names:
        (folder / name).write_text(workflow.EXAMPLES[name](), encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        assert ran("fit", "seal_8mm.csv", "-o", "fit.json").exit_code == 0
        assert ran("fit", "hammer.csv", "-o", "frf.csv").exit_code == 0
        assert ran("fit", "hammer.csv", "--reject", "2", "-o", "frf2.csv").exit_code == 0
    return folder


def options_of(verb: str) -> Iterator[CommandOption]:
    command = main.get_command(click.Context(main), verb)
    assert isinstance(command, DashpotCommand)
    for option in command.options:
        if option.group not in TELLING and option.flag not in NO_CHOICE | {"--output", "--open"}:
            yield option


@pytest.mark.parametrize("verb", ["fit", "report"])
def test_every_choice_is_tried(verb: str) -> None:
    assert {option.flag for option in options_of(verb)} <= CHOICES.keys()


def list_idle_options(job: str) -> Iterator[str]:
    """The options of a job that are neither refused nor change its document."""
    words = JOBS[job]
    usual = ran(*words, "--json", "--overwrite")
    assert usual.exit_code == 0, usual.output
    for option in options_of(words[0]):
        for value in CHOICES[option.flag]:
            typed = (option.flag,) if option.is_flag else (option.flag, value)
            result = ran(*words, *typed, "--json", "--overwrite")
            assert result.exit_code in {0, 2}, (typed, result.output)
            if result.exit_code == 0 and result.stdout == usual.stdout:
                yield shlex.join(typed)


@pytest.mark.parametrize(
    "job", [pytest.param(job, marks=() if job in BY_DAY else pytest.mark.slow) for job in JOBS]
)
def test_an_option_acts_or_is_refused(
    job: str, place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(place)
    assert list(list_idle_options(job)) == []


@pytest.mark.parametrize(
    "choice",
    [("--time-limits", "hold-end=8s"), ("--method", "hold"), ("--elastic", "nonlinear")],
    ids=lambda item: item[0],
)
def test_a_choice_of_the_test_moves_the_joint_fit(
    choice: tuple[str, str], place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(place)
    usual, model = (
        json.loads(ran(*JOBS["joint"], *more, "--json").stdout)["model"] for more in ((), choice)
    )
    assert usual != model


@pytest.mark.parametrize(
    "choice",
    [
        (), ("--time-limits", "hold-end=8s"), ("--arms", "2"), ("--arms", "5"), ("--model", "auto"),
        ("--no-joint", "--arms", "2"), ("--band", "9:18Hz", "--reject", "2"),
        ("--seal-mass", "5g", "--elastic", "nonlinear"),
    ],
    ids=shlex.join,
)  # fmt: skip
def test_the_next_line_of_a_report_gives_its_solid(
    choice: tuple[str, ...], place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(place)
    words = (*JOBS["report"], *choice, "--overwrite")
    study = json.loads(ran(*words, "--json").stdout)
    (follow,) = [line for line in ran(*words).stderr.splitlines() if line.startswith("next: ")]
    again = shlex.split(follow.removeprefix("next: "), comments=True)[1:]
    result = ran(*again, "--json", "--overwrite")
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    assert document["model"] == (study["joint"] or study["fit"])["model"]


@pytest.mark.parametrize(
    "choice", [("--time-limits", "hold-end=8s"), ("--arms", "2"), ("--elastic", "nonlinear")],
    ids=shlex.join,
)  # fmt: skip
@pytest.mark.parametrize("job", ["relaxation", "joint"])
def test_the_next_line_of_a_fit_gives_its_solid(
    job: str, choice: tuple[str, ...], place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if job == "joint" and "--arms" in choice:
        choice = ("--arms", "5")
    monkeypatch.chdir(place)
    first = ran(*JOBS[job], *choice)
    (follow,) = [line for line in first.stderr.splitlines() if line.startswith("next: ")]
    again = shlex.split(follow.removeprefix("next: "), comments=True)[1:]
    usual, document = (
        json.loads(ran(*words, "--json", "--overwrite").stdout)
        for words in ((*JOBS[job], *choice), again)
    )
    assert document["model"] == usual["model"]


@pytest.mark.parametrize(("grams", "marks"), [(114.8, {"good"}), (200, {"bad"}), (80, {"bad"})])
def test_the_light_of_stiffness_sees_a_wrong_mass(
    grams: float, marks: set[str], place: Path
) -> None:
    """A joint fit peaks where the hammer does with any mass; its stiffness is then wrong."""
    files = (str(place / "seal_8mm.csv"), (str(place / "hammer.csv"),))
    study = workflow.run(Job(files[0], impact=files[1], mass=grams / 1000, seals=2))
    _, stiffness, _ = make_study_indicators(study, recommend_solid(study, allow_rejected=True))
    assert {stiffness.mark} == marks, stiffness
    assert stiffness.message.startswith("agrees" if marks == {"good"} else "misses")


def test_predict_uses_the_elastic_law_of_load_deflection_unchanged(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where the relaxation test of another piece has another stiffness."""
    monkeypatch.chdir(place)
    soft = workflow.EXAMPLES["seal_8mm.csv"]().splitlines()
    rows = [i for i, line in enumerate(soft) if line[:1].isdigit()]
    for i in rows:
        *others, force = soft[i].split(",")
        soft[i] = ",".join((*others, f"{0.8 * float(force):.6f}"))
    (place / "soft.csv").write_text("\n".join(soft), encoding="utf-8")
    assert ran("fit", "soft.csv", "-o", "soft.json").exit_code == 0
    document = json.loads(ran("fit", "cld_1.csv", "--relaxation", "soft.json", "--json").stdout)
    (check,) = [check for check in document["checks"] if check["name"] == "relaxed_agrees"]
    assert not check["passed"]
    law, elastic_law = document["relaxed"]["elastic_law"], document["fit"]["elastic_law"]
    assert elastic_law["tangent"] == pytest.approx(law["tangent"], rel=1e-12)
    assert document["fit"]["model"]["k_inf"] == pytest.approx(elastic_law["stiffness"], rel=1e-12)


def test_next_line_of_a_comparison_finds_the_fitted_file(
    place: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From another folder it named a file that is not there."""
    test, hits = JOBS["report"][1:3]
    done = ran("fit", place / test, "-o", tmp_path / "fit.json")
    assert done.exit_code == 0, done.output
    monkeypatch.chdir(tmp_path)
    block = ("--mass", "114.8g", "--seals", "2")
    lines = {}
    for folder in (tmp_path, place):
        hits_path = folder / hits
        hits_path.write_bytes((place / hits).read_bytes())
        compared = ran("compare", tmp_path / "fit.json", hits_path, *block)
        (lines[folder],) = [
            line for line in compared.stderr.splitlines() if line.startswith("next: ")
        ]
    assert str(place / test) in lines[place]
    assert f"FOLDER/{test}" in lines[tmp_path]
