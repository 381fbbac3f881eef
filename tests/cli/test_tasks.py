"""Forty tasks of users, as they are typed."""

from __future__ import annotations

import shlex
from pathlib import Path

import click
import pytest
from kit.kinds import bench, ramp_and_hold
from kit.shell import ran

from dashpot import workflow
from dashpot.cli import main

pytestmark = pytest.mark.once

RIG = "--mass 114.8g --seals 2"
LEVELS = f"shaker_20mN.csv shaker_500mN.csv --amplitude 0.02N --amplitude 0.5N {RIG}"
TASKS = (
    "inspect seal_8mm.csv",
    ("inspect raw.txt --column force=Kraft --column displacement=Weg "
     "--units force=N,displacement=mm --save lab.toml --overwrite"),
    "fit raw.txt --profile lab.toml",
    ("fit raw.txt --column force=3 --column displacement=2 --units force=N,displacement=mm "
     "--text-format 'delimiter=;,decimal=comma'"),
    "fit seal_8mm.csv -o fit.json",
    "fit seal_8mm.csv --arms 2 --method hold",
    "fit depth_4mm.csv depth_6mm.csv depth_8mm.csv --elastic by-depth",
    "fit at_23degC.csv at_10degC.csv at_0degC.csv -o warm.json",
    "fit seal_8mm.csv --model auto",
    "fit sweep.csv -o dma.json",
    "fit sweeps.csv --reference 25degC -o master.json --save-shifts shifts.csv",
    "fit sweeps.csv --at-temperature 25degC",
    "fit curve.csv",
    "fit hammer.csv -o frf.csv --overwrite",
    "fit hammer.csv --reject 3 --window exponential",
    "fit frf.csv --band 5:40Hz",
    "compare frf.csv shaker_20mN.csv",
    f"fit hammer.csv {RIG}",
    f"fit seal_8mm.csv hammer.csv {RIG} -o joint.json --overwrite",
    f"fit frf.csv {RIG} --stiffness-table k.csv --overwrite",
    "fit loops.csv",
    f"fit {LEVELS} --resonance-amplitude 0.1N",
    "fit cld_1.csv cld_2.csv cld_3.csv --length 100mm --compression 6mm --compression-limits 4:8mm",
    "fit cld_1.csv --compression 6mm --relaxation fit.json",
    "fit hit.csv --mass 5g --radius 5mm --drop-height 51mm",
    "fit rod.csv --shape disc:20mm,20mm --density 1000 --mass 31.4g",
    "fit tension.csv biaxial.csv --test uniaxial --test biaxial -o law.json --overwrite",
    f"predict fit.json {RIG} --band 1:50Hz -o p.csv",
    f"predict fit.json {RIG} --record seal_8mm.csv",
    f"predict fit.json {RIG} --base",
    "predict master.json --shape disc:20mm,20mm --mass 400g --seals 2 --base",
    "predict door.toml",
    "predict door.toml --close 1.2m/s",
    f"compare fit.json hammer.csv {RIG}",
    f"report seal_8mm.csv hammer.csv {RIG} -o report.html --overwrite",
    ("export joint.json --to nastran --unit-system mm-t-s --band 1:20Hz --temperature 23degC "
     "--length 50mm -o seal.bdf --overwrite"),
    "plan --frequency 12.71Hz --ramp 1s --hold 40s",
    "batch lotdir -o lot --arms 2 --quick --frequency 12.7Hz",
    "simulate relaxation --seal broad --depth 6mm -o sim.csv",
    "demo --files -o ex2 --all",
)  # fmt: skip
"""What is typed, in the order of their files."""
TELLS = ("fit", "compare", "report")
"""Verbs that say what they took records for."""


def lab(folder: Path) -> None:
    """Write a file of another lab and a folder of tests beside the examples."""
    german = bench(ramp_and_hold()).replace(",", ";").replace(".", ",").splitlines()
    (folder / "raw.txt").write_text("\n".join(["Zeit [s];Weg;Kraft", *german[1:]]) + "\n")
    (folder / "lotdir").mkdir()
    for number in range(3):
        text = bench((1 + 0.02 * number) * ramp_and_hold(), seed=number)
        (folder / "lotdir" / f"seal_{number}.csv").write_text(text)


def does(line: str) -> str:
    """Run a line, which must do its work, and say what it took records for."""
    words = shlex.split(line)
    done = ran(*words)
    assert done.exit_code == 0, f"{line}\n{done.output}"
    assert "Traceback" not in done.output
    if words[0] in TELLS and "lot" not in words:
        files = [word for word in words[1:] if Path(word).suffix in {".csv", ".txt"}]
        assert "recognised " in done.stderr, line
        message = done.stderr.partition("recognised ")[2].splitlines()[0]
        named = [file for file in files if f" {file}" in f" {message}"]
        assert named, f"{line}\n{message}"
    return done.stdout


@pytest.mark.slow
def test_forty_tasks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Pages of the docs run their like by day."""
    assert len(TASKS) == 40
    monkeypatch.chdir(tmp_path)
    # the files to learn on are those that the others take
    *tasks, first = TASKS
    does(first)
    monkeypatch.chdir(tmp_path / "ex2")
    lab(Path())
    for line in tasks:
        does(line)


def test_forty_tasks_are_lines_that_parse(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """They have a command and its options; what they do is known every night."""
    monkeypatch.chdir(tmp_path)
    lab(Path())
    for name in workflow.FIRST:
        Path(name).write_text(workflow.EXAMPLES[name]())
    for line in TASKS:
        name, *words = shlex.split(line)
        command = main.get_command(click.Context(main), name)
        assert command is not None, line
        command.make_context(name, words)
