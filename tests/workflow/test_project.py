"""A project recomputes itself, notices every change, and survives being killed."""

from __future__ import annotations

import json
import os
import shutil

import pytest
from click.testing import CliRunner

from dashpot.base.errors import DataError, ReadError
from dashpot.cli import main
from dashpot.io.options import ReadOptions, load_profile
from dashpot.io.write import write_relaxation
from dashpot.simulation.relaxation import Rig, simulate_relaxation
from dashpot.solids.table_1 import PAPER
from dashpot.workflow import project as folder
from dashpot.workflow.job import Job


def page(study) -> str:
    """A report that takes no time: what a project keeps of it is that it is there."""
    return f"<title>{study.fit.identity}</title>"


@pytest.fixture(scope="module")
def raw(tmp_path_factory):
    path = tmp_path_factory.mktemp("machine") / "seal.csv"
    made = simulate_relaxation(PAPER, hold_time=10.0, rig=Rig(rate=200.0))
    path.write_text(write_relaxation(made.test))
    return path


@pytest.fixture(scope="module")
def made(raw, tmp_path_factory):
    """A project with two results, made once."""
    project = folder.create(tmp_path_factory.mktemp("made") / "door")
    folder.record(project, Job(str(raw), mass=0.104, seals=2, arms=1), page=page)
    folder.record(project, Job(str(raw), arms=1), page=page)
    return project


@pytest.fixture
def kept(made, tmp_path):
    """A copy of that project to damage."""
    return folder.open_project(shutil.copytree(made.folder, tmp_path / "door"))


def failures(project):
    return [check.name for check in folder.verify(project) if check.failed]


def test_a_project_recomputes_itself(kept, raw):
    checks = folder.verify(kept)
    assert all(check.passed for check in checks), checks
    assert sum(check.name == "result_recomputed" for check in checks) == 2
    assert (kept.folder / "raw" / "seal.csv").read_bytes() == raw.read_bytes()
    lines = [json.loads(line) for line in kept.history_file.read_text().splitlines()]
    assert lines[1]["previous"] == lines[0]["hash"]
    assert {"numpy", "scipy", "dashpot", "python"} <= set(lines[0]["software"])


def test_what_was_said_of_reading_is_kept_as_a_profile(kept, raw):
    reading = ReadOptions(force="force", decimal="point")
    folder.record(kept, Job(str(raw), arms=1, reading=reading), page=page)
    (profile,) = (kept.folder / "profiles").iterdir()
    assert load_profile(profile) == reading
    assert not failures(kept)


def test_the_fit_in_a_project_goes_into_a_deck(kept):
    place = next((kept.folder / "records").glob("*.fit.json"))
    words = ["export", str(place), "--to", "csv", "--units", "SI", "--force"]
    result = CliRunner().invoke(main, words)
    assert result.exit_code == 0, result.output
    identity = json.loads(place.read_text())["id"]
    assert f"fit: {identity}" in result.stdout


def test_a_changed_raw_file_is_noticed(kept):
    place = kept.folder / "raw" / "seal.csv"
    place.write_bytes(place.read_bytes().replace(b"time [s]", b"time [S]"))
    assert "file_unchanged" in failures(kept)


def test_a_changed_result_is_noticed(kept):
    place = next((kept.folder / "records").glob("*.fit.json"))
    place.write_text(place.read_text().replace('"k_inf"', '"k_inf" '))
    assert "file_unchanged" in failures(kept)


def test_a_missing_file_is_noticed(kept):
    next((kept.folder / "reports").iterdir()).unlink()
    assert "file_present" in failures(kept)


@pytest.mark.parametrize("change", ["edit", "drop", "swap"])
def test_a_changed_history_is_noticed(kept, change):
    first, second = kept.history_file.read_text().splitlines()
    changed = {
        "edit": [first.replace('"seals": 2', '"seals": 3'), second],
        "drop": [second],
        "swap": [second, first],
    }[change]
    kept.history_file.write_text("\n".join(changed) + "\n")
    assert "history_unchanged" in failures(kept)


def test_a_forged_result_with_right_hashes_is_recomputed_and_found(kept):
    """Hashes can be made to match; the raw file cannot be made to say something else."""
    line = json.loads(kept.history_file.read_text().splitlines()[0])
    listed = next(item for item in line["outputs"] if item["file"].startswith("records/"))
    place = kept.folder / listed["file"]
    found = json.loads(place.read_text())
    found["fit"]["model"]["k_inf"] *= 1.001
    place.write_text(json.dumps(found))
    listed["sha256"] = folder._sha256(place.read_bytes())
    line["hash"] = folder._chained(line)
    kept.history_file.write_text(json.dumps(line) + "\n")
    assert failures(kept) == ["result_recomputed"]


@pytest.mark.parametrize("cut", [1, 40, 400])
def test_a_half_written_line_never_happened(kept, raw, cut):
    whole = kept.history_file.read_bytes()
    kept.history_file.write_bytes(whole[:-cut])
    assert not failures(kept)
    folder.record(kept, Job(str(raw), arms=1), page=page)
    lines = kept.history_file.read_bytes().splitlines()
    assert len(lines) == 2
    assert not failures(kept)


def test_killed_before_the_history_leaves_a_consistent_project(kept, raw, monkeypatch):
    def killed(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(folder, "_append", killed)
    with pytest.raises(KeyboardInterrupt):
        folder.record(kept, Job(str(raw), arms=2), page=page)
    assert not failures(kept)


def test_a_lock_of_the_living_holds_and_of_the_dead_does_not(kept, raw):
    lock = kept.folder / ".lock"
    lock.write_text(str(os.getpid()))
    with pytest.raises(DataError, match="in use by process"):
        folder.record(kept, Job(str(raw)), page=page)
    lock.write_text("999999999")
    folder.record(kept, Job(str(raw), arms=1), page=page)
    assert not lock.exists()


def test_a_file_of_the_same_name_does_not_replace_the_first(kept, raw, tmp_path):
    other = tmp_path / "seal.csv"
    other.write_bytes(raw.read_bytes() + b"\n")
    folder.record(kept, Job(str(other), arms=1), page=page)
    assert (kept.folder / "raw" / "seal.csv").read_bytes() == raw.read_bytes()
    assert len(list((kept.folder / "raw").iterdir())) == 2


def test_paths_that_lead_out_of_the_project_are_refused(kept):
    line = json.loads(kept.history_file.read_text().splitlines()[0])
    line["inputs"][0]["file"] = "../../secret"
    line["hash"] = folder._chained(line)
    kept.history_file.write_text(json.dumps(line) + "\n")
    with pytest.raises(ReadError, match="leads out of the project"):
        folder.verify(kept)


def test_a_full_folder_is_not_taken_over(tmp_path):
    (tmp_path / "mine.txt").write_text("x")
    with pytest.raises(DataError, match=r"holds files but no dashpot\.toml"):
        folder.create(tmp_path)


def test_on_the_command_line(raw, tmp_path):
    place = str(tmp_path / "door")
    runner = CliRunner()
    made = runner.invoke(main, ["report", str(raw), "--mass", "104g", "--project", place])
    assert made.exit_code == 0, made.output
    assert runner.invoke(main, ["verify", place]).exit_code == 0
    copied = tmp_path / "door" / "raw" / "seal.csv"
    copied.write_bytes(copied.read_bytes() + b"0,0,0\n")
    found = runner.invoke(main, ["verify", place, "--json"])
    assert found.exit_code == 1
    assert json.loads(found.stdout)["ok"] is False
