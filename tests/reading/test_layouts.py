"""Layouts of other labs that are no fault of the file: labels, padding, clocks in pairs."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import pytest
from kit.crafted.treacherous import join_rows, three
from kit.look_alikes import truth

from dashpot.base.errors import ReadError
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.impact import read_impact
from dashpot.reading.readers.inspect import inspect_file
from dashpot.reading.readers.relaxation import read_relaxation
from dashpot.reading.text import header
from dashpot.reading.text.dialect import Dialect

TIME, DISPLACEMENT, FORCE = truth()


def is_the_truth(path: Path) -> tuple[str, ...]:
    """Check the numbers; return the notes."""
    test = read_relaxation(path)
    np.testing.assert_allclose(test.time, TIME, atol=1e-9)
    np.testing.assert_allclose(test.displacement, DISPLACEMENT * 1e-3, atol=1e-9)
    np.testing.assert_allclose(test.force, FORCE, atol=1e-9)
    assert not inspect_file(path).questions
    return test.source.notes


@pytest.mark.parametrize("row", [["0", "8", "1.6"], ["5.9", "8", "1.5"]])
def test_single_odd_row_at_the_end_is_no_padding(tmp_path: Path, row: list[str]) -> None:
    path = tmp_path / "odd.csv"
    path.write_text(join_rows([*three(), row]))
    if row[0] == "0":
        with pytest.raises(ReadError, match=r"time falls from 5\.9 s to 0 s at line 62"):
            read_relaxation(path)
    else:
        assert "1 repeated time stamp" in is_the_truth(path)[0]


def test_padding_of_a_hammer_record_is_removed(tmp_path: Path) -> None:
    path = tmp_path / "hit.csv"
    head = "time [s];hammer [N];acceleration 1 [m/s^2]"
    path.write_text(join_rows([*three(), *[["0"] * 3] * 4], head))
    test = read_impact(path, options=ReadOptions(units={"time": "s"}))
    assert (len(test.time), test.starts) == (len(TIME), (0,))


def pairs(clock: np.ndarray, displacement: np.ndarray, unit: str = "s") -> str:
    """Columns in pairs: a displacement on a clock of its own, and the force of the truth."""
    rows = []
    for i in range(max(len(clock), len(TIME))):
        residual = [f"{clock[i]:.6f}", f"{displacement[i]:.6f}"] if i < len(clock) else ["", ""]
        right = [f"{TIME[i]:.5f}", f"{FORCE[i]:.5f}"] if i < len(TIME) else ["", ""]
        rows.append([*residual, *right])
    return join_rows(rows, f"Time ({unit});Position (mm);Time (s);Load (N)")


@pytest.mark.parametrize(("unit", "factor"), [("s", 1.0), ("ms", 1e3), ("min", 1 / 60)])
def test_each_signal_has_its_clock(tmp_path: Path, unit: str, factor: float) -> None:
    clock = np.linspace(0.0, 6.0, 241)  # which holds the ends of the ramp: the line is exact
    path = tmp_path / "pairs.csv"
    path.write_text(pairs(clock * factor, np.clip(clock - 0.5, 0, 1) * 8, unit))
    test = read_relaxation(path)
    np.testing.assert_allclose(test.time, TIME, atol=1e-9)
    np.testing.assert_allclose(test.displacement, DISPLACEMENT * 1e-3, atol=1e-6)
    np.testing.assert_allclose(test.force, FORCE, atol=1e-9)
    assert "clocks of their own: 60 of 241 rows" in " ".join(test.source.notes)
    assert not inspect_file(path).questions


def test_only_what_both_clocks_cover_is_read(tmp_path: Path) -> None:
    clock = TIME + 0.25
    path = tmp_path / "pairs.csv"
    path.write_text(pairs(clock, clock))
    test = read_relaxation(path)
    np.testing.assert_allclose(test.time, TIME[3:], atol=1e-9)
    np.testing.assert_allclose(test.displacement * 1e3, TIME[3:], atol=1e-9)


@pytest.mark.parametrize(
    ("clock", "words"),
    [(TIME[::-1], "does not rise at line 3"), (TIME + 60, "share no time")],
    ids=["falling", "apart"],
)
def test_clocks_that_cannot_be_joined_are_refused(
    tmp_path: Path, clock: np.ndarray, words: str
) -> None:
    path = tmp_path / "pairs.csv"
    path.write_text(pairs(clock, DISPLACEMENT))
    with pytest.raises(ReadError, match=words):
        read_relaxation(path)


def test_column_pairs_with_a_shared_clock_are_one_record(tmp_path: Path) -> None:
    path = tmp_path / "pairs.csv"
    path.write_text(pairs(TIME, DISPLACEMENT))
    assert is_the_truth(path) == ()


@pytest.mark.slow
def test_twenty_thousand_columns_are_read(tmp_path: Path) -> None:
    more = range(3, 20_000)
    head = [*["Time [s]", "Position [mm]", "Load [N]"], *(f"gauge {i} [V]" for i in more)]
    rows = [[*row, *(f"{i % 97}.5" for i in more)] for row in three()]
    path = tmp_path / "wide.csv"
    path.write_text(join_rows(rows, ";".join(head)))
    begun = time.process_time()
    is_the_truth(path)
    assert time.process_time() - begun < 30.0


@pytest.mark.parametrize(
    ("row", "units"),
    [
        (["m/s", "N/mm"], True), (["s", "mm", "N"], True), (["t/ms", "F/mN"], False),
        (["t/s", "s/mm", "F/N"], False), (["g/N", "g/N"], True), (["t/ms", "N"], True),
    ],
)  # fmt: skip
def test_a_symbol_over_its_unit_is_a_name(row: list[str], *, units: bool) -> None:
    assert header._holds_units(row) is units


@pytest.mark.parametrize(
    ("lines", "names"),
    [
        (["# t: s", "# x: mm", "# F: N"], ["t", "x", "F"]),
        (["# made by a rig", "#", "# 1) t [s]", "# 2) x [mm]", "# 3) F [N]"], ["t", "x", "F"]),
        (["# column 1: t [s]", "# column 2: x [mm]", "# column 4: F [N]"], ["", "", ""]),
        (["# t: s", "# x: mm"], ["", "", ""]),  # one too few
        (["# T: degC", "# t: s", "# x: mm", "# F: N"], ["", "", ""]),
        (["# t: s", "# x: mm", "# F: much"], ["", "", ""]),
        (["t: s", "x: mm", "F: N"], ["", "", ""]),  # no comments
    ],
)
def test_a_comment_for_each_column_names_it(lines: list[str], names: list[str]) -> None:
    result = header.read_header(lines, Dialect(" ", ".", ("number",) * 3, first=len(lines)))
    assert [column.name for column in result.columns] == names
    if names[0]:
        assert [column.unit for column in result.columns] == ["s", "mm", "N"]


@pytest.mark.parametrize(("first", "unit"), [("Index", None), ("Nr.", None), ("Zeit", "s")])
def test_a_column_that_counts_has_no_unit(first: str, unit: str | None) -> None:
    lines = [f"{first};Weg;Kraft", "s;mm" if unit else "mm;N"]
    result = header.read_header(lines, Dialect(";", ".", ("number",) * 3, first=2, cells=3))
    assert result.columns[0].unit == unit
    assert result.columns[1].unit == "mm"
    assert bool(result.uneven) is bool(unit)
