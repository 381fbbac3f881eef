"""Tables of thousands of columns are read in time linear in their size."""

from __future__ import annotations

import io
import re
from pathlib import Path
from typing import get_args

import nptdms
import numpy as np
import pytest

from dashpot.base.errors import ReadError
from dashpot.extensions.formats import tdms
from dashpot.reading.columns import kind_detection, role_assignment, vocabulary
from dashpot.reading.columns.kind_detection import detect_table_kind
from dashpot.reading.columns.role_assignment import assign_role, score, score_columns
from dashpot.reading.columns.vocabulary import (
    FIRST,
    SECOND,
    Role,
    has_word,
    matches,
    replace_channel_number,
)
from dashpot.reading.raw_file import RawFile
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.inspect import inspect_file
from dashpot.reading.sandbox import message_protocol
from dashpot.reading.table import Column, FileTable, Question, make_loader
from dashpot.reading.text import dialect, header
from dashpot.reading.text import rows as decimal_marks
from dashpot.reading.text.dialect import COLUMNS, MAX_LENGTH, is_overlong
from dashpot.text_output import layout
from dashpot.text_output.layout import Text


def wide(count: int) -> FileTable:
    named = [Column("time", "s"), Column("displacement", "mm"), Column("force", "N")]
    columns = (*named, *(Column(f"Temp {i}", "degC") for i in range(count)))
    return FileTable("made", columns, make_loader(np.zeros((8, len(columns)))))


def test_column_names_that_differ_by_a_number_are_scored_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    verdicts: list[str] = []
    inner = role_assignment._scores
    monkeypatch.setattr(
        role_assignment,
        "_scores",
        lambda item, options: verdicts.append(item.name) or inner(item, options),
    )
    role_assignment._compute_file_scores.cache_clear()
    assert detect_table_kind(wide(5000), ReadOptions())[0] == "relaxation"
    # three names, ten of one digit, and one for all of more
    assert len(verdicts) <= 14


def test_score_columns_scans_a_table_once_for_all_roles(monkeypatch: pytest.MonkeyPatch) -> None:
    table, gone = wide(20), []
    inner = role_assignment.scores
    monkeypatch.setattr(
        role_assignment, "scores", lambda item, options: gone.append(item) or inner(item, options)
    )
    for role in get_args(Role):
        assert score_columns(table, role, ReadOptions()) == {
            i: value
            for i, column in enumerate(table.columns)
            if (value := score(column, role, ReadOptions()))
        }
    assert len(gone) == 23 * (1 + len(get_args(Role)))  # once, and once a role by the oracle
    units = ReadOptions(units={"temperature": "K"})
    score_columns(table, "temperature", units)
    assert len(gone) == 23 * (2 + len(get_args(Role)))


@pytest.mark.parametrize(
    "name",
    ["Force {}", "Weg_{}", "tan delta {}", "sg{}", "gamma{}", "Kraft max [{}]", "x{}", "力{}"],
)
def test_a_number_says_nothing(name: str) -> None:
    item, other = name.format("17"), name.format("40372")
    assert replace_channel_number(item) == replace_channel_number(other)
    bare = vocabulary._matches.__wrapped__  # what each says where its number is kept
    assert bare(item) == bare(other) == matches(item)
    for words in (vocabulary.EXTREMES, vocabulary.DERIVED):
        single, inside = vocabulary._split_search_words(words)
        message = [
            not single.isdisjoint(vocabulary._split_name_words(name))
            or any(word in name for word in inside)
            for name in (item, other)
        ]
        assert message == [has_word(item, words)] * 2


def test_meaningless_column_names_are_scored_once(monkeypatch: pytest.MonkeyPatch) -> None:
    verdicts: list[str] = []
    inner = role_assignment._scores
    monkeypatch.setattr(
        role_assignment,
        "_scores",
        lambda item, options: verdicts.append(item.name) or inner(item, options),
    )
    role_assignment._compute_file_scores.cache_clear()
    rng = np.random.default_rng(29)
    names = ["".join(rng.choice([*"bghjkqw"], 7)) for _ in range(500)]
    dull = [role_assignment.scores(Column(name, "degC"), ReadOptions()) for name in names]
    assert verdicts == [""]
    assert dull == [inner(Column(name, "degC"), ReadOptions()) for name in names]
    for words in (vocabulary.COMMANDED, vocabulary.DERIVED, vocabulary.EXTREMES, vocabulary.STATIC):
        column = Column(f"{names[0]} {words[0]}", "degC")
        assert role_assignment.scores(column, ReadOptions()) == inner(column, ReadOptions())
        assert role_assignment.scores(column, ReadOptions()) != dull[0]


@pytest.mark.parametrize(("sign", "mark"), [(",", "."), (";", ","), ("\t", "."), ("|", ",")])
def test_plain_numbers_throughout_leave_nothing_to_try(
    sign: str, mark: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = [sign.join(f"{i}.{j}{i % 3}".replace(".", mark) for j in range(9)) for i in range(300)]
    tried: list[str] = []
    inner = dialect._find_best_run
    monkeypatch.setattr(
        dialect,
        "_find_best_run",
        lambda window, *by, **how: tried.append(by) or inner(window, *by, **how),
    )
    result = dialect.find_dialect(["a name", *rows])
    assert result is not None
    assert (result.delimiter, result.mark, result.first, tried) == (sign, mark, 1, [])
    monkeypatch.setattr(dialect, "_find_plain_dialect", lambda *_: None)
    assert dialect.find_dialect(["a name", *rows]) == result
    assert tried


def test_vocabulary_has_no_word_with_two_digits() -> None:
    assert matches("gamma2") != matches("gamma3")
    words = [*FIRST, *SECOND, *vocabulary.EXTREMES, *vocabulary.DERIVED, *vocabulary.COMMANDED]
    assert not [word for word in words if re.search(r"\d\d", word)]


@pytest.mark.parametrize("name", ["tan d", "Tan_d", "tan d 2"])
def test_the_tangent_of_d_is_no_displacement(name: str) -> None:
    assert matches(name)["loss_factor"] >= 2.7
    assert not {"displacement", "loss_angle", "loss"} & matches(name).keys()
    assert matches("d")["displacement"] == 1.5


def test_the_name_that_users_give_a_unit_keeps_its_number() -> None:
    options = ReadOptions(units={"ai_0017": "N"})
    assert score(Column("ai_0017"), "force", options) == 1.0
    assert score(Column("ai_0018"), "force", options) == 0.0


def test_column_names_that_differ_by_a_number_are_normalised_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    folded: list[str] = []
    inner = vocabulary.normalise_name
    monkeypatch.setattr(
        kind_detection.vocabulary, "normalise_name", lambda name: folded.append(name) or inner(name)
    )
    role_assignment._compute_file_scores.cache_clear()
    assert detect_table_kind(wide(5000), ReadOptions())[0] == "relaxation"
    assert len(folded) < 500


def text(columns: int, rows: int = 8, cell: str = "21.5") -> str:
    """A ramp and hold beside columns of temperature."""
    more = columns - 3
    names = ["time [s]", "displacement [mm]", "force [N]", *(f"T{i} [degC]" for i in range(more))]
    ramp = ([f"{i / 10:.1f}", f"{min(i, 3)}.5", f"{4 - 1 / (1 + i):.4f}"] for i in range(rows))
    return "\n".join(",".join(row) for row in (names, *([*row, *[cell] * more] for row in ramp)))


def test_inspect_file_reads_a_line_of_a_million_characters(tmp_path: Path) -> None:
    place = tmp_path / "wide.csv"
    place.write_text(text(300, cell="21." + "5" * 3600))
    assert 1 << 20 < len(place.read_text().splitlines()[-1]) < MAX_LENGTH
    inspection = inspect_file(place)
    assert (inspection.kind, inspection.rows, len(inspection.columns)) == ("relaxation", 8, 300)


def test_read_reports_too_many_columns(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    place = tmp_path / "wide.csv"
    for module in ("dialect", "formats.text"):
        where = "text." + module if module == "dialect" else module
        monkeypatch.setattr(f"dashpot.reading.{where}.COLUMNS", 40)
    place.write_text(text(40).replace("T", "T of oven "))  # a heading may have more blanks
    assert len(inspect_file(place).columns) == 40
    place.write_text(text(41))
    with pytest.raises(ReadError, match=r"line 9 has \d{3} characters and 41 cells, and at most"):
        inspect_file(place)


@pytest.mark.parametrize("sign", [",", ";", "\t", "|", " "])
def test_how_wide_a_line_may_be(sign: str) -> None:
    assert not is_overlong("1" + f"{sign}1" * (COLUMNS - 1))
    assert is_overlong("1" + f"{sign}1" * COLUMNS)
    assert not is_overlong("1" * MAX_LENGTH)
    assert is_overlong("1" * (MAX_LENGTH + 1))


@pytest.mark.parametrize(("copies", "requested"), [(8, False), (9, True)])
def test_assign_asks_about_many_columns_before_loading(copies: int, *, requested: bool) -> None:
    loaded: list[int] = []
    same = wide(copies)

    def load(indexes):
        loaded.extend(indexes)
        return make_loader(np.tile(np.linspace(20, 21, 8)[:, None], (1, copies + 3)))(indexes)

    table = FileTable("made", same.columns, load)
    answer = role_assignment.assign_role(table, "temperature", ReadOptions())
    assert isinstance(answer, role_assignment.Question) is requested
    assert len(loaded) == (0 if requested else 2 + copies)


def test_decimal_marks_in_blocks_equal_those_by_column(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(decimal_marks, "_MAX_CELLS", 90)  # blocks of three rows
    rng = np.random.default_rng(29)
    likely = [2.0, 300.0, 1.5, 1.234, 999.999, np.nan, 0.0, -7.0, np.inf]
    rare = [0.5, 1000.0, 1.23456]
    values = rng.choice(likely, (8, 30))
    for j in range(0, 30, 3):
        values[rng.integers(8), j] = rng.choice(rare)

    def open_(column: np.ndarray) -> bool:
        part = [abs(x) for x in column if np.isfinite(x) and x]
        printed = all(1 <= x < 1000 and abs(x * 1e3 - round(x * 1e3)) <= 0.01 for x in part)
        return printed and any(x == int(x) for x in part)

    expected = {j for j in range(30) if open_(values[:, j])}
    assert 5 < len(expected) < 25
    assert decimal_marks.find_undecided_columns(np.asfortranarray(values)) == expected


@pytest.mark.parametrize("at_a_time", [1, 20, 40, 1000])
def test_columns_are_handed_over_in_blocks(at_a_time: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(message_protocol, "_BLOCK", at_a_time)
    columns = tuple(Column(f"c{i}") for i in range(7))
    values = np.arange(140.0).reshape(20, 7)
    stream = io.BytesIO()
    message_protocol.send_reply(stream, FileTable("made", columns, make_loader(values)))
    stream.seek(0)
    answer = message_protocol.receive_answer(stream, message_protocol.receive(stream))
    assert (answer.load(range(7)).values == values).all()
    assert not stream.read()


def test_channels_of_tdms_are_read_without_an_object_of_its_library_for_each(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of 60,000 channels those objects took half of the time."""
    made: list[str] = []
    inner = nptdms.tdms.TdmsChannel.__init__
    monkeypatch.setattr(
        nptdms.tdms.TdmsChannel,
        "__init__",
        lambda self, path, *more, **named: (
            made.append(str(path)) or inner(self, path, *more, **named)
        ),
    )
    values, units = np.arange(8.0), {"unit_string": "N", "wf_increment": 0.5}
    names = [f"it's {i}" for i in range(20)]
    place = tmp_path / "many.tdms"
    for more in ({}, {"NI_Scaling_Status": "unscaled", "NI_Number_Of_Scales": 1,
                      "NI_Scale[0]_Scale_Type": "Linear", "NI_Scale[0]_Linear_Slope": 2.0,
                      "NI_Scale[0]_Linear_Y_Intercept": 1.0}):  # fmt: skip
        with nptdms.TdmsWriter(place) as writer:
            for part in (values[:3], values[3:]):
                writer.write_segment(
                    [
                        nptdms.ChannelObject("a'b", n, part + i, units | more)
                        for i, n in enumerate(names)
                    ]
                )
        record = tdms.read(RawFile(place.name, place, place.read_bytes()), ReadOptions())
        loaded = record.load(range(21))
        assert loaded.segments == ("a'b",)
        assert [(c.name, c.unit) for c in record.columns] == [
            ("time", "s"),
            *((n, "N") for n in names),
        ]
        expected = np.column_stack([values / 2, *(values + i for i in range(20))])
        expected[:, 1:] = 2 * expected[:, 1:] + 1 if more else expected[:, 1:]
        assert np.array_equal(loaded.values, expected)
        assert len(made) == (20 if more else 0)


def test_of_a_table_of_thousands_no_more_is_put_into_lines_than_fits(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    wrapped: list[str] = []
    inner = layout.wrap_line
    monkeypatch.setattr(
        layout, "wrap_line", lambda line, **how: wrapped.append(line) or inner(line, **how)
    )
    rows = [f"row {i}" for i in range(5000)]
    assert layout.format_for_screen(Text(rows), None, ())[-1] == "  more with -v"
    assert len(wrapped) < 2 * layout.LINES
    assert layout.format_for_screen(Text(rows), None, (), verbose=True) == rows


@pytest.mark.parametrize(("more", "cut"), [(0, False), (1, True)])
def test_a_table_is_cut_where_the_screen_ends(more: int, *, cut: bool) -> None:
    rows = [f"row {i}" for i in range(layout.LINES - 1 + more)]
    shown = layout.format_for_screen(Text(rows), None, ())
    assert (shown[-1] == "  more with -v") is cut
    assert (shown == rows) is not cut


def test_unit_row_test_stops_early_on_a_row_of_names(monkeypatch: pytest.MonkeyPatch) -> None:
    requested: list[str] = []
    inner = header._unit_shape
    monkeypatch.setattr(header, "_unit_shape", lambda word: requested.append(word) or inner(word))
    assert not header._holds_units([f"ch{i} a" for i in range(1000)])
    assert len(requested) == 401
    requested.clear()
    assert not header._holds_units([f"ch{i}" for i in range(1000)])
    assert len(requested) <= 11  # of names that differ by a number alone, one speaks for all


@pytest.mark.parametrize(("words", "units"), [(4, True), (5, False)])
def test_unit_row_needs_six_of_ten_cells(words: int, *, units: bool) -> None:
    row = [*(f"ch{i}" for i in range(words)), *["mm", "N"] * 5][:10]
    assert header._holds_units(row) is units


def test_assign_asks_once_about_columns_that_differ_by_a_number(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    verdicts: list[str] = []
    inner = role_assignment._is_mislabelled
    monkeypatch.setattr(
        role_assignment,
        "_is_mislabelled",
        lambda item, role: verdicts.append(item.name) or inner(item, role),
    )
    question = role_assignment.assign_role(wide(5000), "frequency", ReadOptions())
    assert isinstance(question, role_assignment.Question)
    assert len(verdicts) <= 14


@pytest.mark.parametrize(("forces", "loads"), [(8, [2]), (40, [])])
def test_many_alike_columns_are_compared_two_by_two(forces: int, loads: list[int]) -> None:
    """A file of 200 MB with 40 forces is not read to ask which is meant, equal or not."""
    counts = []
    values = np.random.default_rng(0).normal(size=(100, forces))

    def load(indexes):
        counts.append(len(indexes))
        return make_loader(values)(indexes)

    columns = tuple(Column(f"force {i}", "N") for i in range(forces))
    answer = assign_role(
        FileTable(format="MDF", columns=columns, load=load), "force", ReadOptions()
    )
    assert isinstance(answer, Question)
    assert counts == loads
