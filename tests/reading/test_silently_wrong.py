"""Treacherous files: where a note or a refusal begins; the files are rows of one table."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from kit.crafted.treacherous import THREE, join_rows, put, three
from kit.instruments import workbook
from kit.look_alikes import truth

from dashpot.base.errors import ReadError
from dashpot.extensions.curves.dynamic.read import read_dynamic
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers import cleaning
from dashpot.reading.readers.frf import read_frf
from dashpot.reading.readers.relaxation import read_relaxation
from dashpot.reading.text import rows as decimal_marks
from dashpot.reading.text.dialect import Dialect


def with_force(tmp_path: Path, *force: str) -> Path:
    """A file of the truth with these forces in its first rows."""
    path = tmp_path / "force.csv"
    rows = [[*row[:2], force[i] if i < len(force) else "1.00000"] for i, row in enumerate(three())]
    path.write_text(join_rows(rows))
    return path


@pytest.mark.parametrize(
    ("mark", "neighbour", "residual"),
    [("9999", "1999.80000", True), ("9999", "1999.90000", False), ("-999.99", "1.00000", True),
     ("99.9", "1.00000", False), ("9989", "1.00000", False)],
)  # fmt: skip
def test_a_mark_of_no_reading_is_nines_far_away(
    tmp_path: Path, mark: str, neighbour: str, residual: bool
) -> None:
    sure = ReadOptions(units={"force": "N"})  # kilonewtons are meant
    test = read_relaxation(with_force(tmp_path, "1.00000", mark, neighbour), options=sure)
    assert (len(test.time) == len(truth()[0]) - 1) is residual
    assert any("a mark of no reading" in note for note in test.source.notes) is residual


@pytest.mark.parametrize(("second", "joined_up"), [("30.0", True), ("31.0", False)])
def test_midnight_is_a_fall_of_a_day_less_a_minute(
    tmp_path: Path, second: str, joined_up: bool
) -> None:
    path = tmp_path / "night.csv"
    clock = [f"23:59:{i:02d}.0" for i in range(21, 31)] + [f"00:00:{second}"]
    path.write_text(join_rows([[c, *row[1:]] for c, row in zip(clock, three(), strict=False)]))
    if joined_up:
        assert np.diff(read_relaxation(path).time)[-1] == 60.0
    else:
        with pytest.raises(ReadError, match="time falls"):
            read_relaxation(path)


@pytest.mark.parametrize(("rows", "cut"), [(4, True), (3, False)])
def test_truncated_number_is_detected_after_four_rows(rows: int, cut: bool) -> None:
    dialect = Dialect(";", ".", ("number", "number"))
    assert dialect.is_cut_off(["1.5;2.25"] * rows + ["1.5;2.2"]) is cut
    assert not dialect.is_cut_off(["1.5;2.25"] * rows + ["1.5;2.25"])
    assert not dialect.is_cut_off(["1.5;2.25"] * rows + ["1;2.2"])  # printed otherwise, not cut


@pytest.mark.parametrize(
    ("values", "residual"),
    [([1.6, 800.0], True), ([1.6, 1000.0], False), ([1.6, 0.9], False), ([1.6, 2.5], False),
     ([800.0, 2.0], True), ([1.6, 800.0, 1.0625], False),
     ([1e307, 8.0], False), ([1.625, 999.0, 0.0, np.nan], True)],
)  # fmt: skip
def test_only_numbers_that_thousands_marks_could_make_are_looked_at(
    values: list[float], residual: bool
) -> None:
    assert (decimal_marks.find_undecided_columns(np.array([values]).T) == {0}) is residual


def test_whole_numbers_in_a_later_block_raise_the_question(tmp_path: Path) -> None:
    """A megabyte in which every cell has three decimals, then numbers without any."""
    rows = [f"{1 + i / 1000:.3f};{1 + i % 7:.3f};{2 + i % 5:.3f}" for i in range(90_000)]
    path = tmp_path / "long.csv"
    path.write_text("\n".join([THREE, *rows, "91.001;8;1.250"]) + "\n")
    assert path.stat().st_size > 1 << 20
    with pytest.raises(ReadError, match=r"'1\.000' can mean 1\.000 or 1000"):
        read_relaxation(path)


def test_decimal_mark_is_decided_by_every_row(tmp_path: Path) -> None:
    """The cell that settles it, or raises the question, stands far below the first megabyte."""
    head, rows = "Time (ms);Position (mm);Load (N)\n", 90_000
    text = [f"{100 + i / 10:.1f};{i % 8};{100 + i % 800}.00" for i in range(rows)]
    path = tmp_path / "long.csv"
    for last, requested in (("1.250", True), ("1.25", False)):
        path.write_text(head + "\n".join([*text, f"99999.5;{last};1.25"]) + "\n")
        assert path.stat().st_size > 1 << 20
        if requested:
            with pytest.raises(ReadError, match=r"'1\.250' can mean 1\.250 or 1250"):
                read_relaxation(path)
        else:
            meant = ReadOptions(units={"time": "ms"})  # a sawtooth faster than any bench
            assert len(read_relaxation(path, options=meant).time) == rows + 1


@pytest.mark.parametrize(
    ("first", "noted"), [(("0", "1", "0.01"), True), (("0", "1", "0.01000"), False)]
)
def test_first_row_in_another_format_is_noted(
    tmp_path: Path, first: tuple[str, ...], noted: bool
) -> None:
    path = tmp_path / "first.csv"
    later = ([f"{float(row[0]) + 2:.5f}", *row[1:]] for row in three())
    path.write_text(join_rows([first, *later]))
    notes = read_relaxation(path).source.notes
    assert any("line 2, the first row, is printed otherwise" in note for note in notes) is noted


def test_a_quote_in_a_workbook_cell_is_no_quotation(tmp_path: Path) -> None:
    path = tmp_path / "case.xlsx"
    rows = [[float(row[0]), '"5" pipe', *map(float, row[1:])] for row in three()]
    workbook(path, {"Data": [["Time (s)", "Note", "Position (mm)", "Load (N)"], *rows]})
    np.testing.assert_allclose(read_relaxation(path).force, truth()[2])


@pytest.mark.parametrize("unit", ["millimeter", "Millimeter", "mm", "m"])
def test_a_second_header_may_spell_a_unit_otherwise(tmp_path: Path, unit: str) -> None:
    path = tmp_path / "again.csv"
    again = join_rows(three()[30:], f"Time (sec);Position ({unit});Load (Newton)")
    path.write_text(join_rows(three()[:30]) + again)
    if unit == "m":
        with pytest.raises(ReadError, match=r"'Position \[m\]' where the first says"):
            read_relaxation(path)
    else:
        np.testing.assert_allclose(read_relaxation(path).displacement, truth()[1] * 1e-3)


CURVES = {
    "a second header of a sweep": (
        read_dynamic,
        "Frequency (Hz);E' (MPa);E'' (MPa)",
        "Frequency (Hz);E' (kPa);E'' (MPa)",
        "line 32 ends a second header",
    ),
    "a second header of an FRF": (
        read_frf,
        "Frequency (Hz);Real ((m/s^2)/N);Imag ((m/s^2)/N)",
        "Frequency (Hz);Real ((mm/s^2)/N);Imag ((mm/s^2)/N)",
        "line 32 ends a second header",
    ),
    "a lost cell of an FRF": (
        read_frf,
        "Frequency (Hz);Real ((m/s^2)/N);Imag ((m/s^2)/N)",
        "1.5;0.1",
        "line 32 has 2 cells",
    ),
    "a lone number between the rows": (
        read_dynamic,
        "Frequency (Hz);E' (MPa);E'' (MPa)",
        "5.09",
        "line 32 has 1 cell",
    ),
}


@pytest.mark.parametrize(("read", "head", "odd", "words"), CURVES.values(), ids=CURVES.keys())
def test_curves_are_counted_as_records_are(
    tmp_path: Path, read: Callable[[Path], object], head: str, odd: str, words: str
) -> None:
    path = tmp_path / "curve.csv"
    rows = [[f"{i}.5", "10.0", "1.0"] for i in range(60)]
    path.write_text(join_rows(rows, head))
    read(path)
    path.write_text(put(join_rows(rows, head), 32, odd))
    with pytest.raises(ReadError, match=words):
        read(path)


@pytest.mark.parametrize("head", ["log E' (MPa);log E'' (MPa)", "lg(E') (MPa);lg(E'') (MPa)"])
def test_logarithms_are_no_moduli(tmp_path: Path, head: str) -> None:
    path = tmp_path / "log.csv"
    path.write_text(
        join_rows([[f"{i}.5", "1.0", "0.1"] for i in range(20)], f"Frequency (Hz);{head}")
    )
    with pytest.raises(ReadError, match="looks like storage or loss"):
        read_dynamic(path)


def test_read_frf_refuses_parts_in_different_units(tmp_path: Path) -> None:
    path = tmp_path / "frf.csv"
    rows = [[f"{i + 1}.0", "1.0", "0.1"] for i in range(20)]
    path.write_text(join_rows(rows, "Frequency (Hz);Real (g/N);Imag ((m/s^2)/N)"))
    with pytest.raises(ReadError, match="the real part is in 'g/N', the imaginary part in"):
        read_frf(path)
    frf = read_frf(path, options=ReadOptions(units={"real": "(m/s^2)/N"}))
    np.testing.assert_allclose(frf.value, 1.0 + 0.1j)


def test_a_second_header_holds_until_the_next(tmp_path: Path) -> None:
    """Segments: N, kN, kN after a pause without a header, N again."""
    milli, rows = THREE.replace("(N)", "(kN)"), three()
    heads = ("", milli, "Pause", THREE)
    parts = [join_rows(rows[15 * k : 15 * k + 15], head) for k, head in enumerate(heads)]
    path = tmp_path / "parts.csv"
    path.write_text(THREE + "".join(parts))
    for segment in (1, 4):
        test = read_relaxation(path, options=ReadOptions(segment=segment))
        np.testing.assert_allclose(test.force, truth()[2][15 * segment - 15 : 15 * segment])
    for segment in (2, 3, None):
        with pytest.raises(ReadError, match=r"'Load \[kN\]' where the first says 'Load \[N\]'"):
            read_relaxation(path, options=ReadOptions(segment=segment))


@pytest.mark.parametrize(("step", "noted"), [(0.5, False), (0.51, True)])
def test_clock_notes_report_a_long_last_step(step: float, noted: bool) -> None:
    time = np.append(np.arange(9) / 10, 0.8 + step)
    assert bool(cleaning.clock_notes(time)) is noted


@pytest.mark.parametrize(("last", "noted"), [("run 123", True), ("run 1234", False), ("", False)])
def test_labels_are_words_not_dates(tmp_path: Path, last: str, noted: bool) -> None:
    path = tmp_path / "labels.csv"
    rows = [[*row, "run 1"] for row in three()]
    path.write_text(join_rows([*rows[:-1], [*rows[-1][:-1], last]], THREE + ";Note"))
    notes = read_relaxation(path).source.notes
    assert any("begins with 'run 1' and ends with" in note for note in notes) is noted
