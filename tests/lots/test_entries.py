"""Which files a batch takes, and what paths and manifests say of them."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from dashpot.base.errors import ReadError
from dashpot.lots.entries import Entry, entries


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("a/lotX_1.csv", "a/deep/lotY_2.csv", "b.csv", "a/.hidden", "lot/part-1.parquet",
                 ".cache/x.csv"):  # fmt: skip
        Path(name).parent.mkdir(parents=True, exist_ok=True)
        Path(name).write_text(name)
    Path("a/fit.json").write_text('{"schema": "dashpot/fit@1"}')
    Path("a/seal.csv").write_text("# simulated by dashpot 1.2.3: a virtual rig, not a measurement")
    return tmp_path


def files(*paths, **how):
    return [Path(one.file).as_posix() for one in entries(paths, without=Path("lot"), **how)]


def test_folders_patterns_and_files_are_taken_once(here):
    everything = ["a/deep/lotY_2.csv", "a/lotX_1.csv", "a/seal.csv", "b.csv"]
    assert files(".") == everything
    assert files("a", "b.csv", here / "a" / "lotX_1.csv", "**/*.csv") == everything
    assert files("a/lot*") == ["a/lotX_1.csv"]
    Path("a[1].csv").write_text("x")
    assert files("a[1].csv") == ["a[1].csv"]


def test_labels_come_from_the_path_by_place_or_by_name(here):
    first, second, *_ = entries(["a"], by=r"lot(\w)_(\d)", without=Path("lot"))
    assert (first.lot, first.seal, first.repeat) == ("Y", "2", "")
    assert (second.lot, second.seal) == ("X", "1")
    (named,) = entries(["a/lot*"], by=r"lot(?P<seal>\w)_(?P<lot>\d)", without=Path("lot"))
    assert (named.lot, named.seal) == ("1", "X")
    # a group that took no part says nothing
    (one,) = entries(["b.csv"], by=r"(lot)?b(\.)", without=Path("lot"))
    assert (one.lot, one.seal) == ("", ".")


CSV = "file,lot,seal,repeat,temperature,mass\na/lotX_1.csv,A,1,2,23degC,104g\nb.csv,B,,,,\n"
TOML = (
    '[[test]]\nfile = "a/lotX_1.csv"\nlot = "A"\nseal = 1\nrepeat = 2\n'
    'temperature = "23degC"\nmass = "104g"\n\n[[test]]\nfile = "b.csv"\nlot = "B"\n'
)


@pytest.mark.parametrize(
    ("name", "text"), [("m.csv", CSV), ("m.toml", TOML), ("n.csv", "\ufeff" + CSV)]
)
def test_a_manifest_adds_its_files_and_its_labels_win(here, monkeypatch, name, text):
    Path(name).write_text(text, encoding="utf-8")
    first, second = entries([], manifest=name, by="(b)", without=Path("lot"))
    assert first == Entry(
        "a/lotX_1.csv", "A", "1", "2", pytest.approx(296.15), pytest.approx(0.104)
    )
    assert second == Entry("b.csv", "B")
    # its paths are seen from its own folder, and it is no test itself
    monkeypatch.chdir("a")
    found = entries([".."], manifest=f"../{name}", without=Path("../lot"))
    assert {one.lot for one in found} == {"", "A", "B"}
    assert not any(one.file.endswith(name) for one in found)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "is empty"),
        ("file,lot\n", "lists no test"),
        ("file,lott\nb.csv,A\n", "test 1: 'lott' is unknown; known are file, lot"),
        ("file,lot\n,A\n", "test 1: it names no file"),
        ("file,lot\nb.csv,A\nb.csv,B\n", "test 2: b.csv is listed twice"),
        ("file,mass\nb.csv,104\n", "test 1: mass:"),
        ("file,mass\nb.csv,104mm\n", "test 1: mass:"),
    ],
)
def test_a_manifest_that_is_none_says_where_and_what(here, text, says):
    Path("m.csv").write_text(text)
    with pytest.raises(ReadError, match=re.escape(says)):
        entries([], manifest="m.csv", without=Path("lot"))


@pytest.mark.parametrize("text", ["= x", "test = 3\n", "test = [1]\n", "\x00"])
def test_a_toml_that_is_none_is_refused(here, text):
    Path("m.toml").write_text(text)
    with pytest.raises(ReadError, match=r"m\.toml"):
        entries([], manifest="m.toml", without=Path("lot"))


def test_a_listed_file_that_is_missing_stays_listed(here):
    Path("m.csv").write_text("file\ngone.csv\n")
    (one,) = entries([], manifest="m.csv", without=Path("lot"))
    assert (one.file, one.sha256()) == ("gone.csv", "")
