"""Which files a batch takes, and what paths and manifests say of them."""

from __future__ import annotations

import os
import re
import sys
from pathlib import Path

import pytest

from dashpot.base.errors import DataError, ReadError
from dashpot.extensions.batch.batch_options import BatchOptions
from dashpot.extensions.batch.input_files import Entry, find_entries
from dashpot.extensions.batch.parquet_parts import Task, make_tasks
from dashpot.extensions.batch.table_row import make_row


@pytest.fixture
def working_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("a/lotX_1.csv", "a/deep/lotY_2.csv", "b.csv", "a/.hidden", "lot/part-1.parquet",
                 ".cache/x.csv"):  # fmt: skip
        Path(name).parent.mkdir(parents=True, exist_ok=True)
        Path(name).write_text(name)
    Path("a/fit.json").write_text('{"schema": "dashpot/fit@2"}')
    Path("a/seal.csv").write_text("# simulated by dashpot 1.2.3: a virtual rig, not a measurement")
    return tmp_path


def files(*paths, **how):
    return [
        Path(entry.file).as_posix()
        for entry in find_entries(paths, output_folder=Path("lot"), **how)
    ]


def test_find_entries_takes_each_file_once(working_folder):
    everything = ["a/deep/lotY_2.csv", "a/lotX_1.csv", "a/seal.csv", "b.csv"]
    assert files(".") == everything
    assert files("a", "b.csv", working_folder / "a" / "lotX_1.csv", "**/*.csv") == everything
    assert files("a/lot*") == ["a/lotX_1.csv"]
    Path("a[1].csv").write_text("x")
    assert files("a[1].csv") == ["a[1].csv"]


def test_labels_come_from_the_path_by_place_or_by_name(working_folder):
    first, second, *_ = find_entries(
        ["a"], label_pattern=r"lot(\w)_(\d)", output_folder=Path("lot")
    )
    assert (first.lot, first.seal, first.repeat) == ("Y", "2", "")
    assert (second.lot, second.seal) == ("X", "1")
    (named,) = find_entries(
        ["a/lot*"], label_pattern=r"lot(?P<seal>\w)_(?P<lot>\d)", output_folder=Path("lot")
    )
    assert (named.lot, named.seal) == ("1", "X")
    # a group that took no part says nothing
    (item,) = find_entries(["b.csv"], label_pattern=r"(lot)?b(\.)", output_folder=Path("lot"))
    assert (item.lot, item.seal) == ("", ".")


CSV = "file,lot,seal,repeat,temperature,mass\na/lotX_1.csv,A,1,2,23degC,104g\nb.csv,B,,,,\n"
TOML = (
    '[[test]]\nfile = "a/lotX_1.csv"\nlot = "A"\nseal = 1\nrepeat = 2\n'
    'temperature = "23degC"\nmass = "104g"\n\n[[test]]\nfile = "b.csv"\nlot = "B"\n'
)


@pytest.mark.parametrize(
    ("name", "text"), [("m.csv", CSV), ("m.toml", TOML), ("n.csv", "\ufeff" + CSV)]
)
def test_a_manifest_adds_its_files_and_its_labels_win(working_folder, monkeypatch, name, text):
    Path(name).write_text(text, encoding="utf-8")
    first, second = find_entries([], manifest=name, label_pattern="(b)", output_folder=Path("lot"))
    assert first == Entry(
        "a/lotX_1.csv", "A", "1", "2", pytest.approx(296.15), pytest.approx(0.104)
    )
    assert second == Entry("b.csv", "B")
    # its paths are seen from its own folder, and it is no test itself
    monkeypatch.chdir("a")
    entries = find_entries([".."], manifest=f"../{name}", output_folder=Path("../lot"))
    assert {entry.lot for entry in entries} == {"", "A", "B"}
    assert not any(entry.file.endswith(name) for entry in entries)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252", "utf-16"])
@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
@pytest.mark.parametrize(
    "names", ["file,lot,part,temperature,mass", "Filename,Batch,Part No.,Temp,Mass",
              "path, lot ,Serial-Number,temperature,mass"],
)  # fmt: skip
def test_manifest_is_read_as_spreadsheets_write_it(
    working_folder: Path, names: str, delimiter: str, encoding: str
) -> None:
    """Delimiters, decimal commas, encodings and names of columns."""
    temperature, mass = ("23.5 °C", "104.5g") if delimiter == "," else ("23,5 °C", "104,5g")
    lines = [names.split(","), ["b.csv", "A", "4711-B", temperature, mass]]
    text = "".join(f"{delimiter.join(line)}\r\n" for line in lines)
    for first in ("",) if delimiter == "," else ("", f"sep={delimiter}\r\n"):
        Path("m.csv").write_bytes((first + text).encode(encoding))
        (item,) = find_entries([], manifest="m.csv", output_folder=Path("lot"))
        assert item == Entry(
            "b.csv", "A", "4711-B", "", pytest.approx(296.65), pytest.approx(0.1045)
        )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty"),
        ("file;part;seal\nb.csv;1;2\n", "test 1: 'part' and 'seal' are both the seal"),
        ("file;lot\nb.csv;A;2;3\n", "test 1: more cells than the first line has names: 2, 3"),
        ("file;mass\nb.csv;104\n", "test 1: mass:"),
        ("file,lot\n", "lists no test"),
        ("file,lott\nb.csv,A\n", "test 1: 'lott' is unknown; known are file, lot"),
        ("file,lot\n,A\n", "test 1: it names no file"),
        ("file,lot\nb.csv,A,2,3\n", "test 1: more cells than the first line has names: 2, 3"),
        ("file,lot\nb.csv,A\nb.csv,B\n", "test 2: b.csv is listed twice"),
        ("file,mass\nb.csv,104\n", "test 1: mass:"),
        ("file,mass\nb.csv,104mm\n", "test 1: mass:"),
        ("file,machine\nb.csv,stiff\n", "test 1: machine: 'stiff'; expected a machine file"),
        ("file,machine\nb.csv,stiffness=30N/mm\n", "test 1: machine: 'stiffness=30N/mm'; exp"),
        ("file,machine\nb.csv,compliance=50um\n", "test 1: machine:"),
        ("file,machine\nb.csv,gone.toml\n", "gone.toml"),
    ],
)
def test_a_manifest_that_is_none_says_where_and_what(working_folder, text, message):
    Path("m.csv").write_text(text)
    with pytest.raises(ReadError, match=re.escape(message)):
        find_entries([], manifest="m.csv", output_folder=Path("lot"))


@pytest.mark.parametrize("text", ["= x", "test = 3\n", "test = [1]\n", "\x00"])
def test_a_toml_that_is_none_is_refused(working_folder, text):
    Path("m.toml").write_text(text)
    with pytest.raises(ReadError, match=r"m\.toml"):
        find_entries([], manifest="m.toml", output_folder=Path("lot"))


def test_a_listed_file_that_is_missing_stays_listed(working_folder):
    Path("m.csv").write_text("file\ngone.csv\n")
    (item,) = find_entries([], manifest="m.csv", output_folder=Path("lot"))
    assert (item.file, item.hashes()) == ("gone.csv", ("",))


def test_results_among_the_tests_are_none(tmp_path, monkeypatch):
    """Of this batch or of another, beside the tests or below them."""
    monkeypatch.chdir(tmp_path)
    ours = ("part-0123456789abcdef.parquet", "batch.log", ".lock")
    theirs = ("part-1.parquet", "log.log", "seal.csv")
    for folder in ("t", "t/lot", "t/log"):
        Path(folder).mkdir()
        for name in (*ours, *theirs):
            (Path(folder) / name).write_text("2026-11-23T06:44:35+00:00 part-0 1 fitted\n")
    Path("t/log/batch.log").write_text("time [s],force [N]\n")
    everywhere = [f"{folder}{name}" for folder in ("t/", "t/log/", "t/lot/") for name in theirs]
    (of_a_rig,) = set(files("t")) - set(everywhere)
    assert of_a_rig == "t/log/batch.log"
    assert [
        Path(entry.file).as_posix() for entry in find_entries(["t"], output_folder=Path("t"))
    ] == files("t")


@pytest.fixture
def pairs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("t/A_1.csv", "t/A_2.csv", "t/A_10.csv", "t/A_1_hammer1.csv", "t/A_1_hammer2.csv",
                 "t/A_2_hammer.csv", "hits/A-2.uff"):  # fmt: skip
        Path(name).parent.mkdir(parents=True, exist_ok=True)
        Path(name).write_text(name)
    return tmp_path


def hammers(*paths, **how):
    entries = find_entries(paths, output_folder=Path("lot"), **how)
    return {Path(entry.file).stem: [Path(h).name for h in entry.hammer] for entry in entries}


def test_hammers_are_paired_by_the_name_of_the_test_and_are_no_tests_themselves(pairs):
    by_stem = {"A_1": ["A_1_hammer1.csv", "A_1_hammer2.csv"], "A_2": ["A_2_hammer.csv"], "A_10": []}
    assert hammers("t", pair="{stem}_hammer*.csv") == by_stem
    # by the labels, which the hammer's own path has too
    assert hammers("t", label_pattern=r"(\w)_(\d+)", pair="{lot}_{seal}_hammer*") == by_stem
    # in another folder, and one hammer for all the repeats of a seal
    Path("t/A_2_again.csv").write_text("")
    rows = hammers("t/A_2.csv", "t/A_2_again.csv", "hits", label_pattern=r"(\w)[_-](\d+)",
                        pair="../hits/{lot}-{seal}.uff")  # fmt: skip
    assert rows == {"A_2": ["A-2.uff"], "A_2_again": ["A-2.uff"]}


def test_find_entries_pairs_a_name_with_pattern_characters(pairs):
    for name in ("s[1].csv", "s[1]_h.csv", "s1_h.csv"):
        Path(name).write_text(name)
    assert hammers("s[1].csv", pair="{stem}_h.csv") == {"s[1]": ["s[1]_h.csv"]}


@pytest.mark.parametrize(
    ("pair", "message"),
    [
        ("*_hammer*.csv", "holds no name in braces"),
        ("{name}_hammer*.csv", "holds name in braces"),
        ("{stem", "is no pattern"),
        ("{seal}*.csv", "give --label-pattern too"),
        ("{stem}_hits.csv", "A_1_hits.csv"),
        ("{stem}*.csv", "fits the tests themselves"),
    ],
)
def test_a_pattern_that_pairs_nothing_says_why(pairs, pair, message):
    with pytest.raises(DataError, match=re.escape(message)):
        find_entries(["t"], pair=pair, output_folder=Path("lot"))


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("m.csv", "file,hammer\nt/A_1.csv,t/A_1_hammer1.csv; hits/A-2.uff\nt/A_2.csv,\n"),
        (
            "m.toml",
            """[[test]]
            file = "t/A_1.csv"
            hammer = ["t/A_1_hammer1.csv", "hits/A-2.uff"]
            [[test]]
            file = "t/A_2.csv"
            """,
        ),
    ],
)
def test_a_manifest_names_the_hammers_and_wins_over_a_pattern(pairs, name, text):
    Path(name).write_text(text)
    listed = {"A_1": ["A_1_hammer1.csv", "A-2.uff"], "A_2": []}
    assert hammers(manifest=name) == listed
    paired = hammers(manifest=name, pair="{stem}_hammer*.csv")
    assert paired == listed | {"A_2": ["A_2_hammer.csv"]}


@pytest.mark.skipif(sys.platform != "linux", reason="names of files are text elsewhere")
def test_find_entries_reports_a_name_that_is_no_utf8(tmp_path):
    (tmp_path / os.fsdecode(b"a\xff.csv")).write_text("")
    with pytest.raises(ReadError, match=r"a\\udcff\.csv: the name is not UTF-8"):
        find_entries([tmp_path], output_folder=Path("lot"))


def test_find_entries_reports_an_unreadable_folder(working_folder, monkeypatch):
    def walk(folder, onerror):
        onerror(FileNotFoundError(2, "gone", "a/gone"))
        onerror(PermissionError(13, "Permission denied", "a/deep"))

    monkeypatch.setattr(os, "walk", walk)
    with pytest.raises(ReadError, match="a/deep: the folder cannot be read: Permission denied"):
        find_entries(["a"], output_folder=Path("lot"))


@pytest.mark.parametrize(
    "entry",
    [
        Entry("a.csv"),
        Entry("ü/ß €.csv", "A", "1", "2", 296.15, 0.1, ("h 1.csv", "h2.csv"), "Kim", 250.0),
    ],
)
def test_a_task_gives_back_what_it_was_made_of(entry):
    (task,) = make_tasks([entry], BatchOptions(), compute_hash=lambda file: f"{len(file):064x}")
    assert task.entry == entry
    assert task.hashes == tuple(f"{len(file):064x}" for file in (entry.file, *entry.hammer))
    assert len(task.key) == 64
    assert Task.from_entry(task.entry, task.hashes, task.key) == task


def test_find_entries_reports_links_outside_and_pipes_unread(tmp_path):
    rig, neighbour = tmp_path / "rig", tmp_path / "beside.csv"
    rig.mkdir()
    neighbour.write_text("secret\n")
    (rig / "own.csv").write_text("own\n")
    (rig / "alias.csv").symlink_to(rig / "own.csv")
    (rig / "out.csv").symlink_to(neighbour)
    (rig / "gone.csv").symlink_to(tmp_path / "nowhere.csv")
    os.mkfifo(rig / "pipe.csv")
    entries = find_entries([rig], output_folder=tmp_path / "lot")
    asides = {Path(entry.file).name: entry.aside for entry in entries}
    # one file by two names is one test, and what a broken link names is not there
    assert asides.keys() == {"alias.csv", "gone.csv", "out.csv", "pipe.csv"}
    assert not asides["alias.csv"]
    assert "leads out of the folder" in asides["out.csv"]
    assert "a pipe" in asides["pipe.csv"]
    (out,) = [entry for entry in entries if entry.file.endswith("out.csv")]
    assert out.hashes() == ("",)
    answer = make_row(out, out.hashes(), BatchOptions())
    assert (answer["outcome"], answer["reason"]) == ("refused", out.aside)
    (named,) = find_entries([rig / "out.csv"], output_folder=tmp_path / "lot")
    assert not named.aside


def test_a_manifest_that_is_nested_too_deep_is_no_manifest(working_folder: Path) -> None:
    Path("m.toml").write_text("test = " + "[" * 10_000 + "]" * 10_000)
    with pytest.raises(ReadError, match=r"m.toml: not a manifest: not TOML that a person wrote"):
        find_entries(["b.csv"], output_folder=working_folder / "lot", manifest="m.toml")
