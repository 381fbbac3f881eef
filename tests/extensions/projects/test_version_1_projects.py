"""Projects of former versions verify; what another version computes otherwise is said."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import pytest

import dashpot as dp
from dashpot.base.checks import Check
from dashpot.base.serialisation import compute_document_digest
from dashpot.extensions.projects import history
from dashpot.extensions.projects import project as folder
from dashpot.extensions.projects.project import Project
from dashpot.extensions.projects.revised_numbers import REVISED_NUMBERS, split_common
from dashpot.extensions.projects.verification import verify
from dashpot.extensions.projects.verification_checks import SAME_NUMBER_TOLERANCE
from dashpot.workflow.job import Job

SAVED = Path(__file__).parents[2] / "data" / "documents_1" / "project.zip"
HEAD = "cb95ca6aeef7684a6871e0272dc20d0d1d63b12f2b3f66fc59e29d22ab0cbd04"


@pytest.fixture(scope="module")
def saved_project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("saved")
    with ZipFile(SAVED) as saved:
        saved.extractall(place)
    return place / "pj"


@pytest.fixture
def version_1(saved_project: Path, tmp_path: Path) -> Project:
    """A copy of the saved project to change."""
    return folder.open_project(shutil.copytree(saved_project, tmp_path / "pj"))


def page(_: object) -> str:
    return "<p>A page.</p>"


def judge(project: Project) -> dict[str, Check]:
    """The failed checks by name, and those that compare results."""
    compared = {"earlier_result_reproduced", "uncertainty_unrevised"}
    checks = verify(project, page=page)
    return {check.name: check for check in checks if check.failed or check.name in compared}


def edit_record(project: Project, suffix: str, edit: Callable[[str], str]) -> None:
    """Change a result, and the history so that every hash is of what is there."""
    (line,) = project.history_file.read_text().splitlines()
    entry = json.loads(line)
    (output,) = [
        output
        for output in entry["outputs"]
        if output["file"].startswith("records/") and output["file"].partition(".")[2] == suffix[1:]
    ]
    file = project.folder / output["file"]
    text = file.read_text(encoding="utf-8")
    assert edit(text) != text
    file.write_text(edit(text), encoding="utf-8")
    output["sha256"] = history.sha256(file.read_bytes())
    content, mark = history.format_hashed_line(entry)
    project.history_file.write_bytes(content + b"\n")
    (project.folder / "history.head").write_text(f"1 {mark}\n")


def change_time_constant(fit: dict[str, Any]) -> None:
    """What a forger does who knows of the digest: nothing but the raw file contradicts it."""
    fit["model"]["arms"][0]["tau"] = 0.6
    fit |= {"digest": compute_document_digest(fit)} if "digest" in fit else {}


def test_verify_accepts_a_version_1_project(saved_project: Path) -> None:
    project = folder.open_project(saved_project)
    checks = verify(project, page=page, expect=HEAD)
    assert project.head == HEAD
    assert [check.name for check in checks if check.failed] == ["uncertainty_unrevised"]
    note = next(check for check in checks if check.failed)
    assert note.grade == "note"
    assert "standard_error" in note.message
    assert "the band ends where the loss factor is not known to 30 %" in note.message
    same = next(check for check in checks if check.name == "earlier_result_reproduced")
    assert same.value is not None
    assert same.value < SAME_NUMBER_TOLERANCE


def test_verify_finds_a_changed_file_of_a_version_1_project(version_1: Project) -> None:
    raw = version_1.folder / "raw" / "s.csv"
    raw.write_text(raw.read_text().replace("0.", "1.", 1))
    assert judge(version_1)["file_unchanged"].grade == "stop"


def test_verify_reports_another_stiffness_without_calling_it_tampering(version_1: Project) -> None:
    change = edit_document(change_time_constant)
    edit_record(version_1, ".fit.json", change)
    edit_record(
        version_1, ".json", edit_document(lambda result: change_time_constant(result["fit"]))
    )
    failed = judge(version_1)
    assert set(failed) == {"earlier_result_reproduced", "uncertainty_unrevised"}
    check = failed["earlier_result_reproduced"]
    assert check.grade == "limit"
    assert "tau was 0.6" in check.message
    assert "Either this version computes it otherwise, or result and history were" in check.message


def edit_document(edit: Callable[[dict[str, Any]], object]) -> Callable[[str], str]:
    def rewrite(text: str) -> str:
        document = json.loads(text)
        edit(document)
        return json.dumps(document)

    return rewrite


def change_band_under_a_new_digest(fit: dict[str, Any]) -> None:
    fit["band_hz"] = [0.001, 500.0]
    fit["digest"] = compute_document_digest(fit)


@pytest.mark.parametrize(
    ("suffix", "edit", "words"),
    [
        (".fit.json", lambda fit: fit["model"].pop("k_inf"), "changed by hand"),
        (".fit.json", change_band_under_a_new_digest, "hold different fits"),
        (".json", lambda result: result["fit"].__setitem__("band_hz", [0.001, 500.0]), "different"),
        (".json", lambda result: result["fit"].pop("model"), "hold different fits"),
        (".json", lambda result: result.__setitem__("k_true", 123.0), "has other keys"),
        (".json", lambda result: result["comparison"].pop("measured_hz"), "has other keys"),
        (".json", lambda result: result["alternatives"].pop(), "another length"),
        (".fit.json", lambda fit: fit.__setitem__("schema", "dashpot/fit@2"), "versions"),
        (".json", lambda result: result.pop("fit"), "hold different fits"),
        (".json", lambda result: result.__setitem__("schema", "dashpot/result@2"), "versions"),
    ],
)
def test_verify_stops_at_an_edited_version_1_record(
    version_1: Project, suffix: str, edit: Callable[[dict[str, Any]], object], words: str
) -> None:
    edit_record(version_1, suffix, edit_document(edit))
    check = judge(version_1)["result_recomputed"]
    assert check.grade == "stop"
    assert words in check.message


def test_verify_stops_at_a_present_record_that_claims_version_1(
    saved_project: Path, tmp_path: Path
) -> None:
    project = folder.create(tmp_path / "pj")
    folder.record(project, Job(str(saved_project / "raw" / "s.csv"), arms=1), page=page)
    edit_record(
        project, ".json", lambda text: text.replace("dashpot/result@2", "dashpot/result@1", 1)
    )
    assert judge(project)["result_recomputed"].grade == "stop"


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
    item, other, revised = split_common(old, new)
    assert item == {"fit": {"rms": 1.0, "gone": 1}, "rows": [{}]}
    assert other == {"fit": {"rms": 1.0, "more": 1}, "rows": [{}]}
    assert revised == {"fit.dof": (3, 4), "rows[0].dof": (1, 1)}
    assert all(REVISED_NUMBERS.values())
