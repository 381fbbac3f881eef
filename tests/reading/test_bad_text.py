"""Text that cannot be read as it stands, and the sentence the user sees."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from kit.look_alikes import ROWS, table, truth

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError, ReadError
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.curves.dynamic.read import read_dynamic
from dashpot.reading import raw_file
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers import inspect
from dashpot.reading.readers.impact import read_impact
from dashpot.reading.readers.inspect import inspect_file
from dashpot.reading.readers.relaxation import read_relaxation

HEAD = "Time (s);Displacement (mm);Force (N)\n"


def read(tmp_path: Path, text: str | bytes, **options):
    path = tmp_path / "bad.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_relaxation(path, options=ReadOptions(**options))


def get_refusal(tmp_path: Path, text: str | bytes, *words: str, **options) -> str:
    """The sentence, which holds each of the words."""
    with pytest.raises(ReadError) as caught:
        read(tmp_path, text, **options)
    message = str(caught.value)
    assert message.startswith("bad.csv")
    for word in words:
        assert word in message, message
    return message


def lines(**changed: str) -> str:
    """The truth with some rows, by number, replaced."""
    rows = table(";").splitlines()
    for key, row in changed.items():
        rows[int(key[1:])] = row
    return HEAD + "\n".join(rows) + "\n"


# row 1: decimal marks
def test_read_asks_whether_a_comma_is_decimal(tmp_path: Path) -> None:
    rows = "".join(f"{i};1,{i:03d};2,{i:03d}\n" for i in range(100, 130))
    get_refusal(
        tmp_path, HEAD + rows, "'1,100' can mean 1.100 or 1100", '--text-format decimal=","'
    )
    as_decimal = read(tmp_path, HEAD + rows, decimal=",")
    assert as_decimal.displacement[0] == pytest.approx(1.1e-3)
    as_thousand = read(tmp_path, HEAD + rows, decimal=".")
    assert as_thousand.displacement[0] == pytest.approx(1.1)


def test_decimal_comma_is_stated(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text(HEAD + table(";", decimal=","))
    inspection = inspect_file(path)
    assert (inspection.delimiter, inspection.decimal) == ("semicolon", "comma")


def test_mixed_marks_are_stated(tmp_path: Path) -> None:
    rows = "".join(
        f"{t:.5f};{x:.5f};{f:.5f}\n".replace(".", ",", 1) for t, x, f in zip(*truth(), strict=True)
    )
    assert "mixed" in " ".join(read(tmp_path, HEAD + rows).source.notes)


# row 2: units
def test_foreign_units_are_converted_and_echoed(tmp_path: Path) -> None:
    text = "Time (s);pos (µm);Force (lbf)\n" + table(";")
    test = read(tmp_path, text)
    np.testing.assert_allclose(test.force, truth()[2] * 4.4482216152605)
    assert any("pos [um]" in line for line in test.source.columns)
    assert any("Force [lbf]" in line for line in test.source.columns)


# row 3: the clock
@pytest.mark.parametrize(
    ("step", "noted"), [(0.9e-6, True), (1.1e-6, False), (0.9, False), (1.1, True)]
)
def test_implausible_rate_is_noted(tmp_path: Path, step: float, noted: bool) -> None:
    at = np.arange(1500)  # a record that lasts as long as one may
    rows = "".join(f"{step * i:.12g};{min(i / 300, 1)};{min(i / 150, 2)}\n" for i in at)
    notes = read(tmp_path, HEAD + rows, units={"time": "s"}).source.notes
    assert any("if the unit of time is right" in note for note in notes) is noted


def test_clock_reset_names_the_line(tmp_path: Path) -> None:
    rows = table(";").splitlines()
    message = get_refusal(
        tmp_path, HEAD + "\n".join(rows + rows) + "\n", "time falls from 5.9 s to 0 s"
    )
    assert f"line {ROWS + 2}" in message
    assert "--file-part segment=1" in message
    assert "--rate" not in message


def test_read_asks_which_of_several_segments(tmp_path: Path) -> None:
    text = HEAD + table(";") + "\nSegment: two\n" + HEAD + table(";")
    get_refusal(
        tmp_path, text, "2 segments (1, 2 two)", "clock starts again", "--file-part segment=1"
    )
    test = read(tmp_path, text, segment=2)
    assert len(test.time) == ROWS
    get_refusal(tmp_path, text, "--file-part segment=3, but the file has two segments", segment=3)


def test_single_remark_does_not_split_a_record(tmp_path: Path) -> None:
    rows = table(";").splitlines()
    path = tmp_path / "hit.csv"
    head = "time [s];hammer [N];acceleration 1 [m/s^2]\n"
    parts = {"# a lorry 3 passed": (0,), "# record: 2": (0, 30), head[:-1]: (0, 30)}
    for between, starts in parts.items():
        path.write_text(head + "\n".join([*rows[:30], between, *rows[30:]]) + "\n")
        slow = ReadOptions(units={"time": "s"})  # 10 Hz are meant
        assert read_impact(path, options=slow).starts == starts


# row 6: swapped columns
def test_swapped_columns_are_refused_unless_they_are_named(tmp_path: Path) -> None:
    time, displacement, force = truth()
    text = HEAD + table(";", columns=(time, force, displacement))
    get_refusal(tmp_path, text, "look swapped", "--column displacement=", "--column force=")
    read(tmp_path, text, force="Force")


def test_no_file_and_a_folder(tmp_path: Path) -> None:
    with pytest.raises(ReadError, match="there is no such file"):
        read_relaxation(tmp_path / "none.csv")
    with pytest.raises(ReadError, match="is a folder"):
        read_relaxation(tmp_path)


# what is what
def test_no_header_asks_for_every_column(tmp_path: Path) -> None:
    message = get_refusal(
        tmp_path, table(","), '--column time="1"', '--column displacement="2"', "--rate 1000Hz"
    )
    assert "1 (no name), 2 (no name), 3 (no name)" in message
    named = {"time": "1", "displacement": "2", "force": "3"}
    get_refusal(tmp_path, table(","), "'column 1' (time) has no unit", **named)
    units = {"time": "s", "displacement": "mm", "force": "N"}
    assert read(tmp_path, table(","), units=units, **named).displacement[-1] == 8e-3


def test_read_asks_which_of_two_displacements(tmp_path: Path) -> None:
    time, displacement, force = truth()
    text = "Zeit [s];Traversenweg absolut [mm];Standardweg [mm];Kraft [N]\n" + table(
        ";", columns=(time, displacement, displacement + 1, force)
    )
    get_refusal(tmp_path, text, "'Traversenweg absolut [mm]' and 'Standardweg [mm]' could each be")
    test = read(tmp_path, text, displacement="Standardweg")
    assert test.displacement[0] == pytest.approx(1e-3)
    with pytest.raises(ReadError, match="there is no such column; the columns are 1 'Zeit"):
        read(tmp_path, text, displacement="Weg")


def test_read_asks_by_number_which_of_two_specimens(tmp_path: Path) -> None:
    head = ";".join(("Time [s]", "Weg [mm]", "Kraft [N]") * 2) + "\n"
    time, displacement, force = truth()
    text = head + table(
        ";", columns=(time, displacement, force, time + 1, displacement + 1, 2 * force)
    )
    get_refusal(tmp_path, text, "2 sets of columns could each be the test", "--file-part segment=1")
    test = read(tmp_path, text, segment=2)
    np.testing.assert_allclose(test.time - test.time[0], time - time[0], atol=1e-9)
    np.testing.assert_allclose(test.force, 2 * force, atol=1e-6)
    get_refusal(tmp_path, text, "columns 1 and 4 have that name; give the number", time="Time")
    named = {"time": "4", "displacement": "5", "force": "6"}
    assert len(read(tmp_path, text, **named).time) == ROWS


@pytest.mark.parametrize(("separate", "asks"), [(0.0, False), (1e-3, False), (1.1e-3, True)])
def test_a_column_that_stands_twice_is_no_question(
    tmp_path: Path, separate: float, asks: bool
) -> None:
    time, displacement, force = truth()
    again = force.copy()
    again[-1] += separate * np.ptp(force)
    text = "t [s];z [mm];F1 [N];F2 [mN]\n" + table(
        ";", columns=(time, displacement, force, 1e3 * again)
    )
    if asks:
        get_refusal(
            tmp_path, text, "'F1 [N]' and 'F2 [mN]' could each be the force", '--column force="F1"'
        )
        return
    source = read(tmp_path, text).source
    assert "force: F1 [N] ('F1 [N]' and 'F2 [mN]' hold the same numbers)" in source.columns


def test_no_clock_asks_for_the_rate(tmp_path: Path) -> None:
    _, displacement, force = truth()
    text = "Kraft_N;Position_mm\n" + table(";", columns=(force, displacement), decimal=",")
    get_refusal(tmp_path, text, "looks like time", "--rate 1000Hz")
    get_refusal(tmp_path, "Sampling rate: 10 Hz\n" + text, "header says", "--rate 10Hz")
    test = read(tmp_path, text, rate=10.0)
    np.testing.assert_allclose(test.time, truth()[0], atol=1e-9)
    assert any("counted from the rows at 10 Hz" in note for note in test.source.notes)


def test_wrong_encoding_names_the_option(tmp_path: Path) -> None:
    content = ("Zeit (s);Weg (mm);Kräfte (N)\n" + table(";")).encode("cp1252")
    get_refusal(tmp_path, content, "--text-format encoding=cp1252", encoding="utf-8")


@pytest.mark.parametrize("word", ["klingon", "zlib", "rot13", "undefined", "idna", "punycode"])
def test_what_is_no_encoding_of_text_is_refused(word: str) -> None:
    with pytest.raises(
        DataError, match=f"encoding '{word}' is unknown; give --text-format encoding=utf-8"
    ):
        ReadOptions(encoding=word)


@pytest.mark.parametrize("word", ["utf-8", "utf-16", "cp1252", "cp037", "gb18030", "shift_jis"])
def test_an_encoding_of_text_is_taken(word: str) -> None:
    assert ReadOptions(encoding=word).encoding == word


def test_a_stray_byte_far_down_is_no_obstacle(tmp_path: Path) -> None:
    time = np.arange(9000) / 100
    rows = table(";", columns=(time, np.minimum(time, 1.0), time))
    test = read(
        tmp_path, HEAD.encode() + rows.encode() + "Prüfung beendet bei 23 °C\n".encode("cp1252")
    )
    assert len(test.time) == 9000


def test_lost_line_ends_are_refused(tmp_path: Path) -> None:
    get_refusal(tmp_path, HEAD + table(";") + "1;" * (5 << 20), "a line of more than 8 million")


def test_an_impact_with_a_hole_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "hit.csv"
    path.write_text(
        "time [s];hammer [N];acceleration 1 [m/s^2]\n" + lines(_9="0.9;;1")[len(HEAD) :]
    )
    with pytest.raises(ReadError, match=re.escape("hit.csv: line 11 lacks a number (1 such row)")):
        read_impact(path)


def test_uneven_impact_is_refused(tmp_path: Path) -> None:
    time = np.cumsum(np.random.default_rng(1).uniform(0.5, 1.5, ROWS))
    path = tmp_path / "hit.csv"
    path.write_text(
        "time [s];hammer [N];acceleration 1 [m/s^2]\n" + table(";", columns=(time, time, time))
    )
    with pytest.raises(ReadError, match=r"hit\.csv: an impact record needs even sampling"):
        read_impact(path)


def test_read_reports_text_that_is_no_utf_16(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("time [s],displacement [mm],force [N]\n" + "0,0,0\n" * 20)
    with pytest.raises(ReadError, match="is not utf-16"):
        read_relaxation(path, options=ReadOptions(encoding="utf-16"))


def test_read_reports_a_closed_stdin(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stdin", None)
    with pytest.raises(ReadError, match="stdin is closed"):
        read_relaxation("-")


@pytest.mark.parametrize(
    ("kelvin", "fails"), [(99.9, True), (100.0, False), (550.0, False), (550.1, True)]
)
def test_specimen_asks_about_an_impossible_temperature(kelvin: float, fails: bool) -> None:
    if not fails:
        assert Specimen(temperature=kelvin).temperature == kelvin
        return
    with pytest.raises(DataError, match="is the unit degC"):
        Specimen(temperature=kelvin)


@pytest.mark.parametrize(
    ("unit", "last", "fails"),
    [("degC", 276.8, False), ("degC", 276.9, True), ("K", 100.0, False), ("K", 99.9, True)],
)
def test_read_dynamic_asks_about_temperatures_in_another_unit(
    tmp_path: Path, unit: str, last: float, fails: bool
) -> None:
    rows = "".join(f"{f},5,1,{t}\n" for t in (270.0, last) for f in (1, 2, 5, 10))
    file = tmp_path / "sweeps.csv"
    file.write_text(f"frequency [Hz],storage [MPa],loss [MPa],temperature [{unit}]\n{rows}")
    if fails:
        with pytest.raises(ReadError, match=r"sweeps.csv: temperature = .*is the unit degC"):
            read_dynamic(file)
    else:
        assert len(read_dynamic(file).frequency) == 8


@pytest.mark.parametrize(("seconds", "refuses"), [(0.0, True), (30.0, False)])
def test_rows_that_are_hardly_alike_have_their_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seconds: float, refuses: bool
) -> None:
    monkeypatch.setattr(raw_file, "compute_time_allowed", lambda _: seconds)
    time, displacement, force = truth()
    rows = (f"{t};{x};{f}\n# {t}" for t, x, f in zip(time, displacement, force, strict=True))
    text = HEAD + "\n".join(rows) + "\n"
    if refuses:
        with pytest.raises(ReadError, match=r"took more than 0 s to read up to line \d+"):
            read(tmp_path, text)
    else:
        assert len(read(tmp_path, text).time) == len(time)


@pytest.mark.parametrize(("most", "refuses"), [(2.5, True), (3.5, False)])
def test_all_readings_of_a_file_share_its_time(
    monkeypatch: pytest.MonkeyPatch, most: float, refuses: bool
) -> None:
    monkeypatch.setattr(raw_file, "compute_time_allowed", lambda _: most / raw_file._ROWS_SHARE)
    now = iter([0.0, 1.0, 100.0, 102.0])
    monkeypatch.setattr(raw_file.time, "thread_time", lambda: next(now))
    patience = raw_file.TimeBudget(1)
    with patience.count_time_spent():
        pass
    now = iter([100.0, 102.0, 102.0])
    with patience.count_time_spent():
        if refuses:
            with pytest.raises(ReadError, match="up to line 7"):
                patience.check_time_limit(7)
        else:
            patience.check_time_limit(7)


def test_repeated_remark_is_parsed_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from dashpot.reading.text import rows

    requested, find_header_change = [], rows.find_header_change
    monkeypatch.setattr(
        rows,
        "find_header_change",
        lambda *about: requested.append(about) or find_header_change(*about),
    )
    time, displacement, force = truth()
    item = zip(time, displacement, force, strict=True)
    text = HEAD + "".join(f"{t};{x};{f}\n# a word\n" for t, x, f in item)
    assert len(read(tmp_path, text).time) == len(time)
    assert len(requested) <= 2


def test_swap_check_ignores_columns_without_rows() -> None:
    """A header of LabVIEW that ends twice leaves a segment of no rows."""
    none = np.zeros(0)
    assert not inspect._look_swapped(
        {0: none, 1: none}, {0: ("displacement", ""), 1: ("force", "")}
    )


@pytest.mark.parametrize(("rate", "digits"), [(100, 1), (128, 1), (1000, 2), (2048, 3), (50, 0)])
@pytest.mark.parametrize("rows", [1500, 4000])
@pytest.mark.parametrize("to", [np.round, np.floor, np.ceil])
def test_rate_of_a_coarse_clock_is_that_of_its_rows(
    tmp_path: Path, rate: int, digits: int, rows: int, to: Callable[[FloatArray], FloatArray]
) -> None:
    """Rounded ticks stand a row early or late: 99.97 and 2047.64 Hz were advised."""
    time = to(np.arange(rows) / rate * 10**digits) / 10**digits
    depth = np.interp(np.arange(rows) / rate, [0.0, 1.0, 2.0], [0.0, 0.0, 8.0])
    text = HEAD + "".join(
        f"{t:.{digits}f};{x:.4f};{0.4 * x:.4f}\n" for t, x in zip(time, depth, strict=True)
    )
    get_refusal(tmp_path, text, f"give --rate {rate}Hz")
