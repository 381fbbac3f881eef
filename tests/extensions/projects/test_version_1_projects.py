"""Projects of former versions verify; what another version computes otherwise is said."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from zipfile import ZipFile

import pytest

import dashpot as dp
from dashpot.base.checks import Check
from dashpot.extensions.projects import history
from dashpot.extensions.projects import project as folder
from dashpot.extensions.projects.project import Project
from dashpot.extensions.projects.revised_numbers import REVISED_NUMBERS, split_common
from dashpot.extensions.projects.verification import verify
from dashpot.workflow.job import Job

SAVED = Path(__file__).parents[2] / "data" / "documents_1" / "project.zip"
HEAD = "cb95ca6aeef7684a6871e0272dc20d0d1d63b12f2b3f66fc59e29d22ab0cbd04"


@pytest.fixture(scope="module")
def unpacked(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("saved")
    with ZipFile(SAVED) as saved:
        saved.extractall(place)
    return place / "pj"


@pytest.fixture
def version_1(unpacked: Path, tmp_path: Path) -> Project:
    """A copy of the saved project to change."""
    return folder.open_project(shutil.copytree(unpacked, tmp_path / "pj"))


def page(_: object) -> str:
    return "<p>A page.</p>"


def judge(project: Project) -> dict[str, Check]:
    """The failed checks by name, and those that compare results."""
    compared = {"former_result_recomputed", "uncertainty_unrevised"}
    checks = verify(project, page=page)
    return {check.name: check for check in checks if check.failed or check.name in compared}


def rewrite_record(project: Project, old: str, new: str) -> None:
    """Change a number in a result, and the history so that every hash is of what is there."""
    (line,) = project.history_file.read_text().splitlines()
    entry = json.loads(line)
    (output,) = [one for one in entry["outputs"] if one["file"].endswith(".fit.json")]
    file = project.folder / output["file"]
    text = file.read_text(encoding="utf-8")
    assert old in text
    file.write_text(text.replace(old, new, 1), encoding="utf-8")
    output["sha256"] = history.sha256(file.read_bytes())
    content, mark = history.format_hashed_line(entry)
    project.history_file.write_bytes(content + b"\n")
    (project.folder / "history.head").write_text(f"1 {mark}\n")


def test_verify_accepts_a_version_1_project(unpacked: Path) -> None:
    project = folder.open_project(unpacked)
    checks = verify(project, page=page, expect=HEAD)
    assert project.head == HEAD
    assert [check.name for check in checks if check.failed] == ["uncertainty_unrevised"]
    note = next(check for check in checks if check.failed)
    assert note.grade == "note"
    assert "standard_error" in note.says
    assert "the band ends where the loss factor is not known to 30 %" in note.says
    same = next(check for check in checks if check.name == "former_result_recomputed")
    assert same.value is not None
    assert same.value < 1e-7


def test_verify_finds_a_changed_file_of_a_version_1_project(version_1: Project) -> None:
    raw = version_1.folder / "raw" / "s.csv"
    raw.write_text(raw.read_text().replace("0.", "1.", 1))
    assert judge(version_1)["file_unchanged"].grade == "stop"


def test_verify_reports_another_stiffness_without_calling_it_tampering(version_1: Project) -> None:
    rewrite_record(version_1, '"tau": 0.5', '"tau": 0.6')
    failed = judge(version_1)
    assert set(failed) == {"former_result_recomputed", "uncertainty_unrevised"}
    check = failed["former_result_recomputed"]
    assert check.grade == "limit"
    assert "tau was 0.6" in check.says
    assert "Its files are as they were recorded, so the version changed it" in check.says


def test_result_added_to_a_version_1_project_is_of_version_2(
    version_1: Project,
) -> None:
    folder.record(version_1, Job(str(version_1.folder / "raw" / "s.csv"), arms=1), page=page)
    assert folder.SCHEMA in (version_1.folder / "dashpot.toml").read_text()
    assert {check.name for check in verify(version_1, page=page) if check.failed} == {
        "uncertainty_unrevised"
    }


def test_a_project_of_a_newer_version_is_refused(version_1: Project) -> None:
    (version_1.folder / "dashpot.toml").write_text('schema = "dashpot/project@9"\n')
    with pytest.raises(dp.ReadError, match=r"has schema 'dashpot/project@9'.*Update dashpot"):
        folder.open_project(version_1.folder)


def test_what_both_documents_hold_is_compared() -> None:
    old = {"fit": {"rms": 1.0, "dof": 3, "id": "a", "gone": 1}, "rows": [{"dof": 1}]}
    new = {"fit": {"rms": 1.0, "dof": 4, "id": "b", "more": 1}, "rows": [{"dof": 1}]}
    one, other, revised = split_common(old, new)
    assert one == other == {"fit": {"rms": 1.0}, "rows": [{}]}
    assert revised == {"fit.dof": (3, 4), "rows[0].dof": (1, 1)}
    assert all(REVISED_NUMBERS.values())
