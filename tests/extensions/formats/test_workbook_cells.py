"""Cells of workbooks that are not what they look like: decimal commas as text, days as dates."""

from __future__ import annotations

import datetime as dt
import random
import zipfile
from pathlib import Path

import numpy as np
import openpyxl
import pytest
from kit.foreign.files import press_and_hold
from kit.instruments import ods

from dashpot.base.errors import ReadError
from dashpot.extensions.formats.workbook_sheets import sheets
from dashpot.reading.raw_file import RawFile
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.relaxation import read_relaxation

TIME, DISPLACEMENT, FORCE = press_and_hold(10.0)
HEAD = ["Time [s]", "Displacement [mm]", "Force [N]"]


def comma(value: float, digits: int = 4) -> str:
    return f"{value:.{digits}f}".replace(".", ",")


def xlsx(path: Path, rows: list[list[object]], style: str = "") -> Path:
    book = openpyxl.Workbook()
    sheet = book.active
    assert sheet is not None
    for row in rows:
        sheet.append(row)
    if style:
        for (cell,) in sheet.iter_rows(min_row=2, max_col=1):
            cell.number_format = style
    book.save(path)
    return path


@pytest.mark.parametrize("share", [0.02, 0.3, 1.0])
@pytest.mark.parametrize("column", [0, 1, 2])
@pytest.mark.parametrize("digits", [2, 4])
def test_decimal_commas_as_text_are_numbers(
    tmp_path: Path, share: float, column: int, digits: int
) -> None:
    """In any column, in a few of the cells or in all."""
    pick = random.Random(column)  # noqa: S311
    rows: list[list[object]] = []
    for row in zip(TIME, DISPLACEMENT, FORCE, strict=True):
        cells: list[object] = [round(float(value), digits) for value in row]
        if pick.random() < share:
            cells[column] = comma(float(row[column]), digits)
        rows.append(cells)
    test = read_relaxation(xlsx(tmp_path / "a.xlsx", [HEAD, *rows]))
    np.testing.assert_allclose(test.time, TIME, atol=0.51 * 10.0**-digits)
    np.testing.assert_allclose(test.displacement, 1e-3 * DISPLACEMENT, atol=0.51e-3 * 10.0**-digits)
    np.testing.assert_allclose(test.force, FORCE, atol=0.51 * 10.0**-digits)
    assert not test.source.cautions


def test_workbook_asks_about_ambiguous_commas(tmp_path: Path) -> None:
    rows = [
        [float(t), float(x), comma(max(float(f), 0) + 1, 3) if i % 3 else float(f) + 1]
        for i, (t, x, f) in enumerate(zip(TIME, DISPLACEMENT, FORCE, strict=True))
    ]
    path = xlsx(tmp_path / "a.xlsx", [HEAD, *rows])
    with pytest.raises(ReadError, match="say which with --text-format decimal"):
        read_relaxation(path)
    test = read_relaxation(path, options=ReadOptions(decimal=","))
    np.testing.assert_allclose(test.force, FORCE + 1, atol=1.5e-2)


def test_workbook_reads_thousands_points_with_decimal_commas(tmp_path: Path) -> None:
    rows = [
        [float(t), float(x), f"{1e3 * f + 2e3:,.1f}".translate(str.maketrans(",.", ".,"))]
        for t, x, f in zip(TIME, DISPLACEMENT, FORCE, strict=True)
    ]
    path = xlsx(tmp_path / "a.xlsx", [[*HEAD[:2], "Force [mN]"], *rows])
    np.testing.assert_allclose(read_relaxation(path).force, FORCE + 2, atol=1e-4)


BEGINS = (0.0, 3600.0, 23.9 * 3600, 47.99 * 3600)


@pytest.mark.parametrize("style", ["hh:mm:ss", "[h]:mm:ss.000", "h:mm:ss.0"])
@pytest.mark.parametrize("begins", BEGINS)
@pytest.mark.parametrize("step", [0.1, 3600.0])
def test_a_clock_of_xlsx_past_24_hours(
    tmp_path: Path, style: str, begins: float, step: float
) -> None:
    at = begins + step * np.arange(len(TIME))
    rows = [
        [t / 86400, float(x), float(f)] for t, x, f in zip(at, DISPLACEMENT, FORCE, strict=True)
    ]
    path = xlsx(tmp_path / "a.xlsx", [["Time", *HEAD[1:]], *rows], style)
    test = read_relaxation(path)
    assert len(test.time) == len(TIME)
    np.testing.assert_allclose(test.time - test.time[0], at - at[0], atol=2e-3)


@pytest.mark.parametrize("style", ["hh:mm:ss", "[h]:mm:ss"])
@pytest.mark.parametrize("hours", [1.0, 7.0, 24.0, 30.0, 49.0])
@pytest.mark.parametrize("offset", [0.5, 5.5, 17.0])
def test_a_clock_of_xlsx_past_the_29th_of_february_1900(
    tmp_path: Path, style: str, hours: float, offset: float
) -> None:
    """Calamine returns day 60 of Excel's count as day 59 again."""
    at = (offset + hours * np.arange(int(70 * 24 / hours))) * 3600
    rows = [[t / 86400, 1.0, 40.0 - 1e-6 * t] for t in map(float, at)]
    path = xlsx(tmp_path / "a.xlsx", [["Time", *HEAD[1:]], *rows], style)
    with path.open("rb") as stream:
        lines = sheets(RawFile(path.name, None, stream.read()), ReadOptions())["Sheet"].decode()
    clocks = [line.split("\t")[0].split(":") for line in lines.splitlines()[1:]]
    result = [3600 * float(h) + 60 * float(m) + float(s) for h, m, s in clocks]
    np.testing.assert_allclose(result, at, atol=2e-3)


def iso(seconds: float) -> str:
    whole, part = divmod(round(1e3 * seconds), 1000)
    hours, minutes = whole // 3600, whole // 60 % 60
    return f"PT{hours:02d}H{minutes:02d}M{whole % 60:02d}.{part:03d}000000S"


@pytest.mark.parametrize("begins", BEGINS)
def test_a_clock_of_ods_past_24_hours(tmp_path: Path, begins: float) -> None:
    at = begins + 10 * 60 * TIME
    names = "".join(
        f'<table:table-cell office:value-type="string"><text:p>{item}</text:p></table:table-cell>'
        for item in ("Time", *HEAD[1:])
    )
    rows = [f"<table:table-row>{names}</table:table-row>"]
    for row in zip(at, DISPLACEMENT, FORCE, strict=True):
        t, *others = map(float, row)
        cells = f'<table:table-cell office:value-type="time" office:time-value="{iso(t)}"/>'
        cells += "".join(
            f'<table:table-cell office:value-type="float" office:value="{other!r}"/>'
            for other in others
        )
        rows.append(f"<table:table-row>{cells}</table:table-row>")
    ods(tmp_path / "a.ods", "".join(rows))
    assert zipfile.is_zipfile(tmp_path / "a.ods")
    test = read_relaxation(tmp_path / "a.ods")
    assert len(test.time) == len(TIME)
    np.testing.assert_allclose(test.time - test.time[0], at - at[0], atol=2e-3)


def test_dates_of_today_stay_dates(tmp_path: Path) -> None:
    begun = dt.datetime(2026, 3, 1, 23, 59, 50)
    rows = [
        [begun + dt.timedelta(seconds=float(t)), float(x), float(f)]
        for t, x, f in zip(TIME, DISPLACEMENT, FORCE, strict=True)
    ]
    path = xlsx(tmp_path / "a.xlsx", [["Time", *HEAD[1:]], *rows], "yyyy-mm-dd hh:mm:ss.000")
    test = read_relaxation(path)
    np.testing.assert_allclose(test.time - test.time[0], TIME, atol=2e-3)
