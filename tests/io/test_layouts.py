"""Layouts of other labs that are no fault of the file: labels, padding, clocks in pairs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from kit.look_alikes import truth
from kit.treacherous import joined, three

from dashpot.base.errors import ReadError
from dashpot.io.options import ReadOptions
from dashpot.io.readers.impact import read_impact
from dashpot.io.readers.inspect import inspect_file
from dashpot.io.readers.relaxation import read_relaxation

TIME, MOVED, FORCE = truth()
PADDING = {
    "a row of zeros": [["0"] * 3],
    "five rows of zeros": [["0.0"] * 3] * 5,
    "rows of -1": [["-1"] * 3] * 2,
    "rows of NaN": [["NaN"] * 3] * 5,
    "the last row again": [three()[-1]] * 5,
    "rows of zero time": [["0", "8", "1.6"]] * 2,
}
OVER = {
    "names and units parted by blanks over tabs": ("Time Displacement Force\ns mm N", "\t"),
    "names without a blank over tabs": ("Time(s) Displacement(mm) Force(N)", "\t"),
    "names with underscores over tabs": ("Time_s Displacement_mm Force_N", "\t"),
    "names with brackets over tabs": ("Time (s) Displacement (mm) Force (N)", "\t"),
    "tabs over blanks": ("Time [s]\tDisplacement [mm]\tForce [N]", " "),
    "many blanks over two": ("Total Time (s)   Axial Position (mm)    Axial Force (N)", "  "),
    "a comma after each name": ("time(s), displacement(mm), force(N),", " "),
    "a comma after each name over tabs": ("time(s),\tdisplacement(mm),\tforce(N)", "\t"),
}


def is_the_truth(path: Path) -> tuple[str, ...]:
    """Check the numbers; return the notes."""
    test = read_relaxation(path)
    np.testing.assert_allclose(test.time, TIME, atol=1e-9)
    np.testing.assert_allclose(test.displacement, MOVED * 1e-3, atol=1e-9)
    np.testing.assert_allclose(test.force, FORCE, atol=1e-9)
    assert not inspect_file(path).questions
    return test.source.notes


def test_two_columns_of_labels(tmp_path: Path) -> None:
    rows = (
        ["Hold", "1-Compress" if i < 15 else "1-Hold", row[0], "20.1", *row[1:]]
        for i, row in enumerate(three())
    )
    head = "SetName,Cycle,Time_S,Size_mm,Displacement_mm,Force_N"
    path = tmp_path / "labels.csv"
    path.write_text(joined([*rows], head, ","))
    assert is_the_truth(path) == ("column 'Cycle' begins with '1-Compress' and ends with '1-Hold'",)


@pytest.mark.parametrize("rows", PADDING.values(), ids=PADDING.keys())
def test_padding_at_the_end_is_left_out(tmp_path: Path, rows: list[list[str]]) -> None:
    path = tmp_path / "padded.csv"
    path.write_text(joined([*three(), *rows]))
    (note,) = is_the_truth(path)
    assert f"left out: {len(rows)}, from line 62" in note


@pytest.mark.parametrize("row", [["0", "8", "1.6"], ["5.9", "8", "1.5"]])
def test_one_odd_row_at_the_end_is_no_padding(tmp_path: Path, row: list[str]) -> None:
    path = tmp_path / "odd.csv"
    path.write_text(joined([*three(), row]))
    if row[0] == "0":
        with pytest.raises(ReadError, match=r"time falls from 5\.9 s to 0 s at line 62"):
            read_relaxation(path)
    else:
        assert "1 repeated time stamp" in is_the_truth(path)[0]


def test_padding_of_a_hammer_record_is_left_out(tmp_path: Path) -> None:
    path = tmp_path / "hit.csv"
    head = "time [s];hammer [N];acceleration 1 [m/s^2]"
    path.write_text(joined([*three(), *[["0"] * 3] * 4], head))
    test = read_impact(path, options=ReadOptions(units={"time": "s"}))
    assert (len(test.time), test.starts) == (len(TIME), (0,))


@pytest.mark.parametrize(("head", "sign"), OVER.values(), ids=OVER.keys())
def test_names_parted_otherwise_than_the_rows(tmp_path: Path, head: str, sign: str) -> None:
    path = tmp_path / "names.txt"
    path.write_text(joined(three(), head, sign))
    assert is_the_truth(path) == ()


def pairs(clock: np.ndarray, moved: np.ndarray, unit: str = "s") -> str:
    """Columns in pairs: a displacement on a clock of its own, and the force of the truth."""
    rows = []
    for i in range(max(len(clock), len(TIME))):
        left = [f"{clock[i]:.6f}", f"{moved[i]:.6f}"] if i < len(clock) else ["", ""]
        right = [f"{TIME[i]:.5f}", f"{FORCE[i]:.5f}"] if i < len(TIME) else ["", ""]
        rows.append([*left, *right])
    return joined(rows, f"Time ({unit});Position (mm);Time (s);Load (N)")


@pytest.mark.parametrize(("unit", "factor"), [("s", 1.0), ("ms", 1e3), ("min", 1 / 60)])
def test_each_signal_has_its_clock(tmp_path: Path, unit: str, factor: float) -> None:
    clock = np.linspace(0.0, 6.0, 241)  # which holds the ends of the ramp: the line is exact
    path = tmp_path / "pairs.csv"
    path.write_text(pairs(clock * factor, np.clip(clock - 0.5, 0, 1) * 8, unit))
    test = read_relaxation(path)
    np.testing.assert_allclose(test.time, TIME, atol=1e-9)
    np.testing.assert_allclose(test.displacement, MOVED * 1e-3, atol=1e-6)
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
    path.write_text(pairs(clock, MOVED))
    with pytest.raises(ReadError, match=words):
        read_relaxation(path)


def test_one_clock_is_taken_where_the_pairs_share_it(tmp_path: Path) -> None:
    path = tmp_path / "pairs.csv"
    path.write_text(pairs(TIME, MOVED))
    assert is_the_truth(path) == ()
