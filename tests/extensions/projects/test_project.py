"""Projects: recomputation, detection of every change, and recovery after a kill."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from kit.gauges import cal
from kit.shell import ran

from dashpot.base.errors import DataError, ReadError
from dashpot.extensions.formats.ati import AXES
from dashpot.extensions.projects import history, verification
from dashpot.extensions.projects import project as folder
from dashpot.extensions.projects.verification import find_largest_difference, is_same_page, verify
from dashpot.extensions.projects.verification_checks import SAME_NUMBER_TOLERANCE
from dashpot.reading.read_options import ReadOptions, load_profile
from dashpot.reading.write import write_relaxation
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.simulation.rig_errors import Rig
from dashpot.solids.demo_seals import PAPER
from dashpot.workflow.job import Job
from dashpot.workflow.json_archive import to_json
from dashpot.workflow.study import run

WRITES = 11
"""How often a run writes to the disk or moves a file: three results, a line, its head."""


def page(study) -> str:
    """A report that takes no time: what a project keeps of it is that it is there."""
    return f"<title>{study.fit._identity}</title>"


STUDIES = {}


@pytest.fixture(autouse=True)
def study_cache(request, monkeypatch):
    """One study for one job on the same bytes: what is tested here is what is kept of it."""
    if "work_done_again" in request.fixturenames:
        return

    def once(job):
        named = folder.replace_paths(job, lambda path: history.sha256(Path(path).read_bytes()))
        key = (Path(job.relaxation).name, to_json(named))
        if key not in STUDIES:
            STUDIES[key] = run(job)
        return STUDIES[key]

    monkeypatch.setattr(folder, "run", once)
    monkeypatch.setattr(verification, "run", once)


@pytest.fixture
def work_done_again():
    """The real work, both times."""


@pytest.fixture(scope="module")
def raw(tmp_path_factory):
    path = tmp_path_factory.mktemp("machine") / "seal.csv"
    made = simulate_relaxation(PAPER, hold_time=10.0, rig=Rig(rate=200.0))
    path.write_text(write_relaxation(made.test))
    return path


@pytest.fixture(scope="module")
def finished_project(raw, tmp_path_factory):
    """A project with two results, made once."""
    project = folder.create(tmp_path_factory.mktemp("made") / "door")
    folder.record(project, Job(str(raw), mass=0.104, seals=2, arms=1), page=page)
    folder.record(project, Job(str(raw), arms=1), page=page)
    return project


@pytest.fixture
def project_copy(finished_project, tmp_path):
    """A copy of that project to damage."""
    return folder.open_project(shutil.copytree(finished_project.folder, tmp_path / "door"))


def verify_project(project, expect=None):
    return verify(project, page=page, expect=expect)


def failures(project, expect=None):
    return [check.name for check in verify_project(project, expect) if check.failed]


def test_a_project_recomputes_itself(project_copy, raw, work_done_again):
    checks = verify_project(project_copy)
    assert all(check.passed for check in checks), checks
    assert sum(check.name == "result_recomputed" for check in checks) == 2
    assert (project_copy.folder / "raw" / "seal.csv").read_bytes() == raw.read_bytes()
    lines = [json.loads(line) for line in project_copy.history_file.read_text().splitlines()]
    assert lines[1]["previous"] == lines[0]["hash"]
    assert {"numpy", "scipy", "dashpot", "python"} <= set(lines[0]["software"])


def test_project_saves_reading_options_as_a_profile(project_copy, raw):
    reading = ReadOptions(force="force", decimal="point")
    folder.record(project_copy, Job(str(raw), arms=1, reading=reading), page=page)
    (profile,) = (project_copy.folder / "profiles").iterdir()
    assert load_profile(profile) == reading
    assert not failures(project_copy)


def test_the_fit_in_a_project_goes_into_a_deck(project_copy):
    place = next((project_copy.folder / "records").glob("*.fit.json"))
    result = ran("export", place, "--to", "csv", "--unit-system", "SI", "--allow", "all")
    assert result.exit_code == 0, result.output
    identity = json.loads(place.read_text())["id"]
    assert f"fit: {identity}" in result.stdout


def test_a_changed_raw_file_is_noticed(project_copy):
    place = project_copy.folder / "raw" / "seal.csv"
    place.write_bytes(place.read_bytes().replace(b"time [s]", b"time [S]"))
    assert "file_unchanged" in failures(project_copy)


def test_a_changed_result_is_noticed(project_copy):
    place = next((project_copy.folder / "records").glob("*.fit.json"))
    place.write_text(place.read_text().replace('"k_inf"', '"k_inf" '))
    assert "file_unchanged" in failures(project_copy)


def test_a_missing_file_is_noticed(project_copy):
    next((project_copy.folder / "reports").iterdir()).unlink()
    assert "file_present" in failures(project_copy)


@pytest.mark.parametrize("change", ["edit", "drop", "swap"])
def test_a_changed_history_is_noticed(project_copy, change):
    first, second = project_copy.history_file.read_text().splitlines()
    changed = {
        "edit": [first.replace('"seals": 2', '"seals": 3'), second],
        "drop": [second],
        "swap": [second, first],
    }[change]
    project_copy.history_file.write_text("\n".join(changed) + "\n")
    assert "history_unchanged" in failures(project_copy)


def rewritten(project, entries):
    """Write lines whose hashes fit, as who knows how they are made can."""
    before, lines = history.GENESIS, []
    for number, entry in enumerate(entries, start=1):
        entry |= {"previous": before, "line": number}
        text, before = history.format_hashed_line(entry)
        lines.append(text.decode() + "\n")
    project.history_file.write_text("".join(lines))
    (project.folder / "history.head").write_text(f"{len(lines)} {before}\n")


def entries(project):
    return [json.loads(line) for line in project.history_file.read_text().splitlines()]


def test_the_last_line_survives_the_loss_of_its_line_end(project_copy, raw):
    whole = project_copy.history_file.read_bytes()
    project_copy.history_file.write_bytes(whole[:-1])
    assert not failures(project_copy)
    folder.record(project_copy, Job(str(raw), arms=1), page=page)
    assert project_copy.history_file.read_bytes().startswith(whole)
    assert len(entries(project_copy)) == 3
    assert not failures(project_copy)


@pytest.mark.parametrize("retained", [1, 40, -40])
def test_a_half_written_line_never_happened(project_copy, raw, retained):
    """Killed in the middle of the one write: the head still concerns the line before."""
    whole = project_copy.history_file.read_bytes()
    first, second, _ = whole.split(b"\n")
    project_copy.history_file.write_bytes(first + b"\n" + second[:retained])
    (project_copy.folder / "history.head").write_text(f"1 {json.loads(first)['hash']}\n")
    assert failures(project_copy) == ["history_complete", "files_listed"]
    folder.record(project_copy, Job(str(raw), arms=1), page=page)
    assert project_copy.history_file.read_bytes().startswith(first + b"\n{")
    assert len(entries(project_copy)) == 2
    assert not failures(project_copy)


@pytest.mark.parametrize("loss", ["last", "half", "all", "file", "first"])
def test_what_is_cut_off_the_history_is_missed(project_copy, raw, loss):
    first, second = project_copy.history_file.read_bytes().splitlines(keepends=True)
    value = {"last": first, "half": first + second[:99], "all": b"", "first": second}.get(loss)
    if value is None:
        project_copy.history_file.unlink()
    else:
        project_copy.history_file.write_bytes(value)
    missed = failures(project_copy)
    assert ("history_unchanged" if loss == "first" else "history_whole") in missed
    assert ("history_present" in missed) == (loss in {"all", "file"})
    if loss != "first":
        with pytest.raises(DataError, match="lines where 2 were written; put the file back"):
            folder.record(project_copy, Job(str(raw), arms=1), page=page)
        assert (project_copy.history_file.read_bytes() if value is not None else None) == value


@pytest.mark.parametrize("head", [None, "1 {first}", "2 {foreign}", "1 {first}\n2 {foreign}"])
def test_a_head_that_is_lost_older_or_foreign_is_missed(project_copy, raw, head):
    """Without it nobody knows whether lines were cut off; the next line brings it again."""
    place, first = project_copy.folder / "history.head", entries(project_copy)[0]["hash"]
    if head is None:
        place.unlink()
    else:
        place.write_text(head.format(first=first, foreign="f" * 64) + "\n")
    assert failures(project_copy) == ["history_whole"]
    if head is None or head.endswith("first}"):
        folder.record(project_copy, Job(str(raw), arms=1), page=page)
        assert not failures(project_copy)


def test_a_line_that_its_head_announced_is_whole(project_copy):
    """Killed after the line was written, before the head was."""
    first, second = (entry["hash"] for entry in entries(project_copy))
    (project_copy.folder / "history.head").write_text(f"1 {first}\n2 {second}\n")
    assert not failures(project_copy)


TAMPERED = {
    "a blank more": lambda text: text.replace('", "', '",  "', 1),
    "a blank less": lambda text: text.replace('": "', '":"', 1),
    "a key twice": lambda text: text.replace('"user": ', '"user": "nobody", "user": ', 1),
    "keys in another order": lambda text: json.dumps(dict(sorted(json.loads(text).items()))),
    "keys of the job in another order": lambda text: json.dumps(
        json.loads(text) | {"job": dict(sorted(json.loads(text)["job"].items()))}
    ),
    "an escape for a letter": lambda text: text.replace('"report"', '"\\u0072eport"', 1),
    "a number written otherwise": lambda text: text.replace('"line": 2', '"line": 2e0', 1),
    "an end of line of another system": lambda text: text + "\r",
    "a blank before it": lambda text: " " + text,
    "a blank before the hash": lambda text: text.replace(', "hash"', ',  "hash"', 1),
}


@pytest.mark.parametrize("how", TAMPERED)
def test_the_bytes_of_a_line_are_hashed(project_copy, how):
    first, second = project_copy.history_file.read_text().splitlines()
    changed = TAMPERED[how](second)
    assert changed != second
    project_copy.history_file.write_bytes(f"{first}\n{changed}\n".encode())
    try:
        assert "history_unchanged" in failures(project_copy)
    except ReadError as error:
        assert "it was changed" in str(error)  # noqa: PT017 -- either way it is reported


def test_head_is_bytes_too(project_copy):
    place = project_copy.folder / "history.head"
    whole = place.read_bytes()
    for changed in (
        whole.replace(b"\n", b"\r\n"), b"\xef\xbb\xbf" + whole, b"0" + whole, b"+" + whole,
        whole * 3, whole + b"3 soon\n", whole.rstrip(), whole[:20], b"",
    ):  # fmt: skip
        place.write_bytes(changed)
        with pytest.raises(ReadError, match=r"history\.head is not as dashpot writes it"):
            verify_project(project_copy)
    place.write_bytes(whole)
    assert not failures(project_copy)


HISTORIES = {
    "a line twice": lambda first, second: first + second + second,
    "the first line twice": lambda first, second: first + first + second,
    "lines that end as on Windows": lambda first, second: (first + second).replace(b"\n", b"\r\n"),
    "a byte order mark": lambda first, second: b"\xef\xbb\xbf" + first + second,
    "another encoding": lambda first, second: (first + second).decode().encode("utf-16"),
    "a blank line at the end": lambda first, second: first + second + b"\n",
    "a blank line between": lambda first, second: first + b"\n" + second,
    "zeros of a disk at the end": lambda first, second: first + second + b"\0" * 64,
}


@pytest.mark.parametrize("how", HISTORIES)
def test_no_byte_of_the_history_is_changed_in_passing(project_copy, how):
    """As editors, version control, mail and disks do."""
    lines = project_copy.history_file.read_bytes().splitlines(keepends=True)
    project_copy.history_file.write_bytes(HISTORIES[how](*lines))
    try:
        missed = failures(project_copy)
    except ReadError as error:
        assert "it was changed" in str(error)  # noqa: PT017 -- either way it is reported
    else:
        assert {"history_unchanged", "history_complete"} & {*missed}


def test_the_history_of_another_project_is_missed(project_copy, raw, tmp_path):
    other = folder.create(tmp_path / "other")
    for seals in (1, 3):
        folder.record(other, Job(str(raw), seals=seals, arms=1), page=page)
    for value in ("history.jsonl", "history.head"):
        shutil.copy(other.folder / value, project_copy.folder / value)
        assert failures(project_copy)


FILES = {
    "lines that end as on Windows": lambda raw: raw.write_bytes(
        raw.read_bytes().replace(b"\n", b"\r\n")
    ),
    "a blank line at the end": lambda raw: raw.write_bytes(raw.read_bytes() + b"\n"),
    "nothing left": lambda raw: raw.write_bytes(b""),
    "a folder of its name": lambda raw: (raw.unlink(), raw.mkdir()),
    "its name in capitals": lambda raw: raw.rename(raw.with_name("SEAL.CSV")),
    "its name of other code points": lambda raw: raw.rename(raw.with_name("sea\u217c.csv")),
}


@pytest.mark.parametrize("how", FILES)
def test_a_raw_file_that_a_synchronisation_changed_is_missed(project_copy, how):
    FILES[how](project_copy.folder / "raw" / "seal.csv")
    assert {"file_present", "file_unchanged"} & {*failures(project_copy)}


@pytest.mark.parametrize(
    "individual", ["history.jsonl", "history.head", "dashpot.toml", "raw/seal.csv"]
)
def test_nothing_outside_is_read_through_a_link(project_copy, tmp_path, individual):
    place = project_copy.folder / individual
    place.rename(tmp_path / "elsewhere")
    place.symlink_to(tmp_path / "elsewhere")
    with pytest.raises(ReadError, match=f"{individual} leads out of the project"):
        verify_project(project_copy)


def test_what_only_looks_half_written_is_named(project_copy):
    for name in (".evil.part", "fit.json.part", "." + "0" * 16 + ".part"):
        (project_copy.folder / "records" / name).write_text("{}")
    (check,) = [item for item in verify_project(project_copy) if item.name == "files_listed"]
    assert check.message == "The history does not list records/.evil.part, records/fit.json.part."


def test_verify_detects_swapped_figures(project_copy):
    """Each page is drawn again, of its own result."""

    def draw_page(study):
        return f"<svg><text>{study.mass}</text></svg>"

    lines = entries(project_copy)
    pages = [line["outputs"] for line in lines]
    for outputs, mass in zip(pages, ("0.104", "None"), strict=True):
        (listed,) = [output for output in outputs if output["file"].endswith(".html")]
        place = project_copy.folder / listed["file"]
        place.write_text(f"<svg><text>{mass}</text></svg>")
        listed["sha256"] = history.sha256(place.read_bytes())
    rewritten(project_copy, lines)
    assert not [check.name for check in verify(project_copy, page=draw_page) if check.failed]
    first, second = (
        project_copy.folder / output["file"]
        for o in pages
        for output in o
        if "html" in output["file"]
    )
    item, other = first.read_bytes(), second.read_bytes()
    first.write_bytes(other)
    second.write_bytes(item)
    assert [check.name for check in verify(project_copy, page=draw_page) if check.failed].count(
        "file_unchanged"
    ) == 2
    for outputs, content in zip(pages, (other, item), strict=True):
        (listed,) = [output for output in outputs if output["file"].endswith(".html")]
        listed["sha256"] = history.sha256(content)
    rewritten(project_copy, lines)
    assert [check.name for check in verify(project_copy, page=draw_page) if check.failed] == [
        "page_redrawn"
    ] * 2


def test_what_a_forger_may_say_unproven(project_copy):
    """SECURITY.md names it: when, who, what it was called, in which order, by which versions."""
    lines, noted = entries(project_copy), project_copy.head
    lines[0] |= {"time": "1999-01-01T00:00:00+00:00", "user": "boss", "operation": "approved"}
    lines[0]["software"]["numpy"] = "0.0.1"
    rewritten(project_copy, lines[::-1])
    (project_copy.folder / "dashpot.toml").write_text(
        'schema = "dashpot/project@1"\nname = "other"\n'
    )
    assert not failures(project_copy)
    assert failures(project_copy, expect=noted) == ["history_expected"]


def test_a_line_of_the_second_edition_is_still_held_to_its_hash(project_copy):
    """Its hash was of its content, sorted, and its bytes were those of plain JSON."""
    before, lines = history.GENESIS, []
    for entry in entries(project_copy):
        entry["previous"] = before
        del entry["hash"]
        ordered = json.dumps(entry, sort_keys=True, ensure_ascii=False).encode()
        entry["hash"] = before = history.sha256(ordered)
        lines.append(json.dumps(entry))
    project_copy.history_file.write_text("\n".join(lines) + "\n")
    (project_copy.folder / "history.head").write_text(f"2 {before}\n")
    assert not failures(project_copy)
    project_copy.history_file.write_text("\n".join(lines).replace('": ', '":  ', 1) + "\n")
    assert failures(project_copy) == ["history_unchanged"]


def test_who_notes_the_head_misses_even_a_forged_end(project_copy, raw):
    noted = project_copy.head
    assert not failures(project_copy, expect=noted)
    folder.record(project_copy, Job(str(raw), arms=1, seals=2), page=page)
    (check,) = [
        item for item in verify_project(project_copy, noted) if item.name == "history_expected"
    ]
    assert check.passed
    assert "1 lines were added since" in check.message
    rewritten(project_copy, entries(project_copy)[:1])
    assert failures(project_copy) == ["files_listed"]  # nothing inside shows
    assert "history_expected" in failures(project_copy, expect=noted)


def test_a_project_without_history_proves_nothing(tmp_path):
    assert failures(folder.create(tmp_path / "new")) == ["history_present"]


@pytest.mark.parametrize("kind", ["fit.json", "a key twice", "json", "html"])
def test_verify_detects_a_changed_and_rehashed_result(project_copy, kind):
    """From the fit's file decks are made; the page is what people read."""
    twice, kind = kind == "a key twice", kind.replace("a key twice", "fit.json")
    lines = entries(project_copy)
    listed = next(
        output for output in lines[0]["outputs"] if output["file"].split(".", 1)[1] == kind
    )
    place = project_copy.folder / listed["file"]
    if kind == "html":
        place.write_text(place.read_text().replace("</title>", "!</title>"))
    elif twice:  # what reads the first of them reads another solid
        place.write_text(place.read_text().replace('"k_inf": ', '"k_inf": 1.0, "k_inf": ', 1))
    else:
        document = json.loads(place.read_text())
        solid = (document if kind == "fit.json" else document["fit"])["model"]
        solid["k_inf"] *= 1.001
        place.write_text(json.dumps(document))
    listed["sha256"] = history.sha256(place.read_bytes())
    rewritten(project_copy, lines)
    assert failures(project_copy) == ["page_redrawn" if kind == "html" else "result_recomputed"]


@pytest.mark.parametrize(
    "word", ["NaN", "Infinity", "-1e999", "1" + "0" * 400, "true", "null", '"0.09"']
)
def test_verify_detects_non_finite_numbers(project_copy, word):
    lines = entries(project_copy)
    listed = next(output for output in lines[0]["outputs"] if output["file"].endswith(".fit.json"))
    place = project_copy.folder / listed["file"]
    place.write_text(re.sub(r'("k_inf": )[-0-9.e]+', rf"\g<1>{word}", place.read_text(), count=1))
    listed["sha256"] = history.sha256(place.read_bytes())
    rewritten(project_copy, lines)
    assert failures(project_copy) == ["result_recomputed"]


def test_find_largest_difference_leaves_what_rounding_decides():
    """Of arms of one time constant only the sum is determined; a gap of 1e-14 has no digits."""

    def write_model(*arms):
        keys = ("k", "tau", "b")
        return {"model": {"arms": [dict(zip(keys, arm, strict=True)) for arm in arms]}}

    item = write_model((1.0, 0.1, 0.1), (2.0, 0.1, 0.2), (5.0, 2.0, 10.0))
    other = write_model((1.5, 0.1, 0.15), (1.5, 0.1 + 1e-9, 0.15), (5.0, 2.0, 10.0))
    merged = write_model((3.0, 0.1, 0.3), (5.0, 2.0, 10.0))
    assert find_largest_difference(item, other)[0] < SAME_NUMBER_TOLERANCE
    assert find_largest_difference(item, merged)[0] < SAME_NUMBER_TOLERANCE
    separate = write_model((1.5, 0.1, 0.15), (1.5, 0.1001, 0.15), (5.0, 2.0, 10.0))
    assert find_largest_difference(item, separate)[0] > SAME_NUMBER_TOLERANCE
    more = write_model((1.5, 0.1, 0.15), (1.51, 0.1, 0.151), (5.0, 2.0, 10.0))
    assert find_largest_difference(item, more)[0] > SAME_NUMBER_TOLERANCE
    gaps = [{"certificate": {"gap": gap}} for gap in (5.0e-14, 5.1e-14, 1e-3, np.nan)]
    assert find_largest_difference(*gaps[:2])[0] < SAME_NUMBER_TOLERANCE
    assert find_largest_difference(*gaps[1:3])[0] > SAME_NUMBER_TOLERANCE
    assert find_largest_difference(*gaps[2:])[0] == np.inf


def test_find_largest_difference_distinguishes_true_from_one(project_copy):
    assert find_largest_difference({"a": 1}, {"a": True})[0] == np.inf
    assert find_largest_difference({"a": 1, "b": 0.0}, {"a": 1.0, "b": -0.0})[0] == 0.0
    assert find_largest_difference({"a": np.nan}, {"a": np.nan})[0] == 0.0
    assert find_largest_difference({"a": 2.0}, {"a": 1.0})[0] == 0.5
    assert find_largest_difference({"a": "NaN"}, {"a": 1.0})[0] == np.inf
    assert find_largest_difference({"a": 1.0}, {"a": "NaN"})[0] == np.inf


def _add_file(retained, line, kind, named):
    """A forged file beside that of a line, which the line lists first."""
    place = retained.folder / next(
        output["file"] for output in line["outputs"] if output["file"].endswith(kind)
    )
    forged = place.with_name(named + kind)
    forged.write_text(place.read_text().replace("0", "1"))
    listed = {"file": forged.relative_to(retained.folder).as_posix()}
    line["outputs"].insert(0, listed | {"sha256": history.sha256(forged.read_bytes())})


def _rename_file(retained, line, kind):
    listed = next(output for output in line["outputs"] if output["file"].endswith(kind))
    place = retained.folder / listed["file"]
    listed["file"] = listed["file"].replace(place.name, "0" * 16 + kind)
    place.rename(retained.folder / listed["file"])


def _swap_files(lines, kind):
    first, second = (
        next(output for output in line["outputs"] if output["file"].endswith(kind))
        for line in lines
    )
    for key in first:
        first[key], second[key] = second[key], first[key]


LISTS = {
    "another fit": lambda retained, lines: _add_file(retained, lines[0], ".fit.json", "f" * 16),
    "another report": lambda retained, lines: _add_file(retained, lines[0], ".html", "f" * 16),
    "a report without a name": lambda retained, lines: _add_file(
        retained, lines[0], ".html", "good"
    ),
    "one file renamed": lambda retained, lines: _rename_file(retained, lines[0], ".fit.json"),
    "all files renamed": lambda retained, lines: [
        _rename_file(retained, lines[0], kind) for kind in (".fit.json", ".html", ".json")
    ],
    "files of two results swapped": lambda _, lines: _swap_files(lines, ".fit.json"),
    "a file that was not read": lambda retained, lines: lines[0]["inputs"].append(
        {"file": "raw/more.csv", "sha256": history.sha256(b"1")}
    ),
}


@pytest.mark.parametrize("how", LISTS)
def test_a_line_lists_what_its_job_reads_and_makes_and_no_more(project_copy, how):
    lines = entries(project_copy)
    (project_copy.folder / "raw" / "more.csv").write_bytes(b"1")
    LISTS[how](project_copy, lines)
    rewritten(project_copy, lines)
    assert "result_recomputed" in failures(project_copy)


def test_verify_detects_renamed_files_of_another_version(project_copy):
    lines = entries(project_copy)
    for line in lines:
        line["software"]["numpy"] = "0.0.1"
    rewritten(project_copy, lines)
    assert not failures(project_copy)
    _rename_file(project_copy, lines[0], ".fit.json")
    rewritten(project_copy, lines)
    assert failures(project_copy) == ["result_recomputed"]


def test_a_line_is_numbered_by_its_place(project_copy):
    before, texts = history.GENESIS, []
    for entry in entries(project_copy):
        text, before = history.format_hashed_line(
            entry | {"previous": before, "line": entry["line"] + 1}
        )
        texts.append(text.decode() + "\n")
    project_copy.history_file.write_text("".join(texts))
    (project_copy.folder / "history.head").write_text(f"{len(texts)} {before}\n")
    assert failures(project_copy) == ["history_unchanged"] * 2


def test_another_version_may_draw_another_page(project_copy):
    lines = entries(project_copy)
    for line in lines:
        line["software"]["numpy"] = "0.0.1"
    rewritten(project_copy, lines)
    checks = verify(project_copy, page=lambda study: page(study).replace("title", "b"))
    verdicts = [check for check in checks if check.name == "page_redrawn"]
    assert [verdict.passed for verdict in verdicts] == [None, None]


@pytest.mark.parametrize(
    ("text", "again", "same"),
    [
        ("f = 12.710 Hz", "f = 12.711 Hz", True),
        ("f = 12.710 Hz", "f = 12.712 Hz", False),
        ("f = 12.71 Hz", "f = 12.75 Hz", False),
        ("f = 13 Hz", "f = 12.71 Hz", False),
        ("All 14 checks passed", "All 13 checks passed", False),
        ("opacity:1", "opacity:0", False),
        ("-14", "-13", False),
        ("f = 12.7999 Hz", "f = 12.7 Hz", False),
        ("f = 12.69999 Hz", "f = 12.7 Hz", True),
        ("f = 10.0 Hz", "f = 9.9999 Hz", True),
        ("use", "do not use", False),
        ("12.71 Hz", "１２.７１ Hz", False),
        ('<svg d="M10 20.5l3 4"></svg>', '<svg d="M10 20.6l3 4"></svg>', True),
        ('<svg d="M10 20.5l3 4"></svg>', '<svg d="M10 21.5l3 4"></svg>', False),
        ("<svg><text>12.51 Hz</text></svg>", "<svg><text>13.51 Hz</text></svg>", False),
        ("<svg><text>12.51 Hz</text></svg>", "<svg><text>12.53 Hz</text></svg>", False),
        ("0.01 <svg></svg>", "0.03 <svg></svg>", False),
        ("1e-05", "2e-05", True),
        ("1e-05", "3e-05", False),
        ("href=data:x;base64,MC4xMDAw", "href=data:x;base64,MC4xMDAx", True),
        ("href=data:x;base64,MC4xMDAw", "href=data:x;base64,MC4xMDAy", False),
        ("href=data:x;base64,MC4xMDAw", "href=data:x;base64,MC4yMDAw", False),
    ],
)
def test_pages_are_the_same_but_for_a_last_digit(text, again, same):
    assert is_same_page(text.encode(), again.encode()) == same


def test_files_that_no_line_lists_are_named(project_copy):
    (project_copy.folder / "records" / "planted.fit.json").write_text("{}")
    (project_copy.folder / "records" / ".0123456789abcdef.part").write_text("half")
    (check,) = [item for item in verify_project(project_copy) if item.name == "files_listed"]
    assert check.failed
    assert check.message == "The history does not list records/planted.fit.json."


@pytest.mark.parametrize("at", range(WRITES + 1))
def test_killed_at_any_write_nothing_is_lost(project_copy, raw, at):
    """The process ends, without a word to anyone, at the n-th time that it writes or moves."""
    before = project_copy.history_file.read_bytes()
    child = os.fork()
    if not child:
        killed_at(at)
        folder.record(project_copy, Job(str(raw), arms=1, seals=3), page=page)
        os._exit(0)
    _, status = os.waitpid(child, 0)
    assert os.waitstatus_to_exitcode(status) == (9 if at < WRITES else 0)
    assert project_copy.history_file.read_bytes().startswith(before)
    assert set(failures(project_copy)) <= {"files_listed"}
    lines = len(entries(project_copy))
    folder.record(project_copy, Job(str(raw), arms=1, seals=3), page=page)
    assert len(entries(project_copy)) == lines + 1
    assert not failures(project_copy)
    assert not list(project_copy.folder.rglob("*.part"))


def killed_at(number):
    """End this process at the n-th of its writes, before and after which a kill may fall."""
    remaining_calls = [number]

    def count_calls(function):
        def call(*args, **how):
            if remaining_calls[0] == 0:
                os._exit(9)
            remaining_calls[0] -= 1
            return function(*args, **how)

        return call

    os.fsync = count_calls(os.fsync)
    Path.replace = count_calls(Path.replace)


def test_the_lock_is_of_the_process_and_not_of_the_file(project_copy, raw):
    """A file that a dead dashpot left, whatever stands in it, locks nothing."""
    lock = project_copy.folder / ".lock"
    for text in ("", str(os.getpid()), "999999999"):
        lock.write_text(text)
        folder.record(project_copy, Job(str(raw), arms=1), page=page)
    code = (
        "import sys; from pathlib import Path\n"
        "from dashpot.base.file_writing import open_exclusive_lock\n"
        "with open_exclusive_lock(Path(sys.argv[1]), 'x'): print('held', flush=True); "
        "sys.stdin.read()"
    )
    other = subprocess.Popen(
        [sys.executable, "-c", code, lock], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    assert other.stdout.readline().strip() == b"held"
    with pytest.raises(DataError, match="in use by another dashpot; try again"):
        folder.record(project_copy, Job(str(raw)), page=page)
    other.kill()
    other.communicate()
    folder.record(project_copy, Job(str(raw), arms=1), page=page)


def test_a_copy_that_was_damaged_is_not_analysed_instead(project_copy, raw, tmp_path):
    other = tmp_path / "seal.csv"
    other.write_bytes(raw.read_bytes() + b"\n")
    folder.record(project_copy, Job(str(other), arms=1), page=page)
    (copy,) = [path for path in (project_copy.folder / "raw").iterdir() if path.name != "seal.csv"]
    whole = copy.read_bytes()
    copy.write_bytes(whole.replace(b"0.0", b"0.1", 1))
    with pytest.raises(DataError, match="is no longer the copy of"):
        folder.record(project_copy, Job(str(other), arms=1), page=page)
    copy.write_bytes(whole)
    damaged = project_copy.folder / "raw" / "seal.csv"
    damaged.write_bytes(b"time [s],displacement [mm],force [N]\n")
    study, _ = folder.record(project_copy, Job(str(raw), arms=1), page=page)
    assert study.test.source.sha256 == history.sha256(raw.read_bytes())


def test_a_calibration_is_an_input_like_any_other(tmp_path):
    project = folder.create(tmp_path / "door")
    matrix = cal(tmp_path / "nano.cal", version="1.1")
    made = simulate_relaxation(PAPER, hold_time=10.0, rig=Rig(rate=200.0)).test
    loads = np.zeros((6, len(made.time)))
    loads[AXES.index("Fz")] = made.force
    columns = [made.time, 1e3 * made.displacement, *np.linalg.solve(matrix, loads)]
    head = ["time [s]", "displacement [mm]", *(f"G{number} [V]" for number in range(6))]
    rows = [",".join(map(repr, row)) for row in np.transpose(columns).tolist()]
    (tmp_path / "seal.csv").write_text("\n".join([",".join(head), *rows]) + "\n")
    reading = ReadOptions(calibration=str(tmp_path / "nano.cal"))
    folder.record(project, Job(str(tmp_path / "seal.csv"), arms=1, reading=reading), page=page)
    (tmp_path / "nano.cal").unlink()
    (line,) = entries(project)
    assert line["job"]["reading"]["calibration"] == "raw/nano.cal"
    *copies, profile = [output["file"] for output in line["inputs"]]
    assert copies == ["raw/nano.cal", "raw/seal.csv"]
    assert profile.startswith("profiles/")
    assert not failures(project)
    copy = project.folder / "raw" / "nano.cal"
    copy.write_text(copy.read_text() + " ")
    assert failures(project) == ["file_unchanged"]


@pytest.mark.parametrize("path", ["/etc/passwd", "../secret.cal", "raw/link.cal"])
def test_a_foreign_project_opens_no_file_outside_as_calibration(project_copy, tmp_path, path):
    (tmp_path / "secret.cal").write_text("top secret")
    (project_copy.folder / "raw" / "link.cal").symlink_to(tmp_path / "secret.cal")
    lines = entries(project_copy)
    lines[0]["job"]["reading"]["calibration"] = path
    lines[0]["inputs"].append({"file": "raw/seal.csv", "sha256": "0"})
    rewritten(project_copy, lines[:1])
    assert "file_unchanged" in failures(project_copy)
    lines[0]["inputs"][-1:] = [{"file": path, "sha256": history.sha256(b"top secret")}]
    rewritten(project_copy, lines[:1])
    with pytest.raises(ReadError, match="leads out of the project"):
        verify_project(project_copy)


def test_leftovers_are_cleaned(project_copy, raw):
    part_file = project_copy.folder / "records" / ".0123456789abcdef.part"
    part_file.write_text("half")
    folder.record(project_copy, Job(str(raw), arms=1), page=page)
    assert not part_file.exists()


def test_verify_lists_and_clears_files_of_killed_runs(project_copy, tmp_path):
    (tmp_path / "lot").mkdir()
    places = project_copy.folder / "records", tmp_path / "lot"
    part_files = [place / ".0123456789abcdef.part" for place in places]
    for path in part_files:
        path.write_text("half")
    assert failures(project_copy) == []  # it may still be written to
    for path in part_files:
        os.utime(path, (1, 1))
    assert failures(project_copy) == ["nothing_half_written"]
    (tmp_path / "lot" / ".hidden.part").write_text("a user's own")
    result = ran("verify", tmp_path / "lot")
    assert (result.exit_code, part_files[1].exists()) == (0, True)
    assert ".0123456789abcdef.part" in result.stdout
    assert (
        "cleared .0123456789abcdef.part"
        in ran("verify", part_files[1].parent, "--overwrite").stdout
    )
    assert not part_files[1].exists()
    assert (tmp_path / "lot" / ".hidden.part").exists()
    assert ran("verify", tmp_path / "lot").exit_code == 2


def test_a_folder_that_was_killed_while_it_was_made_is_no_obstacle(tmp_path):
    (tmp_path / ".0123456789abcdef.part").write_text("half")
    assert folder.create(tmp_path).folder == tmp_path


@pytest.mark.parametrize(
    "text", [b"[]", b"{}", b"5", b"\xff", b'{"line": 1}', b"[" * 5000, b'{"hash": {"a": 1}}', None]
)
def test_a_line_of_another_kind_is_refused(project_copy, text):
    if text is None:  # one thing more than a line holds
        text = json.dumps(entries(project_copy)[0] | {"more": 1}).encode()
    project_copy.history_file.write_bytes(text + b"\n")
    with pytest.raises(ReadError, match=r"line 1 of history.jsonl is none that dashpot writes"):
        verify_project(project_copy)


def test_verify_detects_unlisted_inputs(project_copy):
    lines = entries(project_copy)
    lines[0]["inputs"] = []
    rewritten(project_copy, lines)
    assert failures(project_copy) == ["inputs_listed"]


def test_a_file_of_the_same_name_does_not_replace_the_first(project_copy, raw, tmp_path):
    other = tmp_path / "seal.csv"
    other.write_bytes(raw.read_bytes() + b"\n")
    folder.record(project_copy, Job(str(other), arms=1), page=page)
    assert (project_copy.folder / "raw" / "seal.csv").read_bytes() == raw.read_bytes()
    assert len(list((project_copy.folder / "raw").iterdir())) == 2


def test_paths_that_lead_out_of_the_project_are_refused(project_copy):
    lines = entries(project_copy)
    lines[0]["inputs"][0]["file"] = "../../secret"
    rewritten(project_copy, lines)
    with pytest.raises(ReadError, match="leads out of the project"):
        verify_project(project_copy)


def test_a_full_folder_is_not_taken_over(tmp_path):
    (tmp_path / "mine.txt").write_text("x")
    with pytest.raises(DataError, match=r"holds files but no dashpot\.toml"):
        folder.create(tmp_path)


def test_on_the_command_line(raw, tmp_path, work_done_again):
    place = tmp_path / "door"
    made = ran("report", raw, "--arms", "1", "--project", place)
    assert made.exit_code == 0, made.output
    head = folder.open_project(place).head
    assert f"--expect {head}" in made.stderr
    result = ran("verify", place, "--expect", head)
    assert result.exit_code == 0, result.output
    assert head in result.stdout
    assert ran("verify", place, "--expect", "0" * 64).exit_code == 1
    copied = tmp_path / "door" / "raw" / "seal.csv"
    copied.write_bytes(copied.read_bytes() + b"0,0,0\n")
    outcome = ran("verify", place, "--json")
    assert outcome.exit_code == 1
    assert json.loads(outcome.stdout)["ok"] is False
