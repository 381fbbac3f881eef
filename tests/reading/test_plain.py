"""Numbers of plain rows: all ways to read them give the same bits, or the same refusal."""

from __future__ import annotations

import sys
from decimal import Decimal, getcontext
from unittest.mock import patch

import msgspec
import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from dashpot.base.errors import ReadError
from dashpot.reading.table import Column
from dashpot.reading.text import plain_rows
from dashpot.reading.text.cells import ClockColumn
from dashpot.reading.text.dialect import Dialect, decode_blocks
from dashpot.reading.text.plain_rows import PlainRows, SplitLines, split_line_cells
from dashpot.reading.text.rows import Heading, load_rows

assert msgspec, "imported, so that it is what reads"
getcontext().prec = 1200  # halfway between the smallest doubles are 1075 digits

doubles = st.floats(min_value=0, max_value=1e308)


def halfway(low: float) -> str:
    """The decimal right between a double and the next, written out."""
    return str((Decimal(low) + Decimal(float(np.nextafter(low, np.inf)))) / 2).replace("E", "e")


def format_value(digits: int, value: float) -> str:
    return f"{value:.{digits}e}"


plain_numerals = st.one_of(
    doubles.map(repr),
    st.floats(max_value=2.3e-308, min_value=0).map(repr),  # subnormal
    st.one_of(doubles, st.floats(min_value=0, max_value=1e-307)).map(halfway),
    st.builds(format_value, st.integers(0, 40), doubles),
    st.from_regex(r"[1-9][0-9]{0,25}(\.[0-9]{1,25})?([eE][+-]?[0-9]{1,2})?", fullmatch=True),
    st.sampled_from(["0", "0.0", "0e0", "1e-400", "9007199254740993", "1.000", "1e22", "1e23"]),
)
numerals = st.builds("{}{}".format, st.sampled_from(["", "-"]), plain_numerals)
others = st.one_of(
    st.builds("{}{}".format, st.sampled_from(["+", " ", "--", "+-"]), plain_numerals),
    st.from_regex(r"\.[0-9]{1,5}|0[0-9]{1,3}|[0-9]{1,3}\.", fullmatch=True),
    st.sampled_from(["1e400", "-1e309"]),
)
words = st.sampled_from(
    ["", " ", "nan", "-nan", "inf", "Infinity", "null", "true", "1_0", "1 2", "[1]", "]", "0x1p3",
     "1d5", "1,234", "1.234,5", "1e", "-", "n/a", "OVER", "³", "١", "\x00", '"2"', "5 "]
)  # fmt: skip


@st.composite
def even_rows(draw: st.DrawFn, width: int) -> list[list[str]]:
    """Rows whose columns are each printed with so many decimals, as most programs do."""
    decimals = draw(st.lists(st.integers(0, 10), min_size=width, max_size=width))
    value = st.one_of(st.floats(-1e7, 1e7), st.floats(-20, 20), st.sampled_from([0.0, -0.0]))
    rows = draw(st.lists(st.lists(value, min_size=width, max_size=width), min_size=1, max_size=6))
    return [[f"{v:.{d}f}" for v, d in zip(row, decimals, strict=True)] for row in rows]


@st.composite
def tables(draw: st.DrawFn) -> tuple[str, Dialect, tuple[int, ...]]:
    """Rows of three cells, nearly all of them numbers, of some lab."""
    width, mark = 3, draw(st.sampled_from([".", ",", ".,"]))
    sign = draw(st.sampled_from([";", "\t", "|", " ", *([","] if mark == "." else [])]))
    cells = draw(st.sampled_from([numerals, numerals, numerals | others, numerals | words]))
    rows = draw(st.lists(st.lists(cells, min_size=width, max_size=width), min_size=1, max_size=6))
    if draw(st.booleans()):
        rows = draw(even_rows(width))
        if draw(st.booleans()):
            odd = draw(st.sampled_from([numerals, others, words]))
            rows[draw(st.integers(0, len(rows) - 1))][draw(st.integers(0, width - 1))] = draw(odd)
    if mark != ".":
        rows = [[text.replace(".", ",") for text in row] for row in rows]
    if sign == " " and draw(st.booleans()):
        rows = [[text.rjust(9) for text in row] for row in rows]
    more = draw(st.sampled_from(["", "", sign, 2 * sign]))
    if draw(st.integers(0, 9)) == 0:
        rows.append(["1"] * draw(st.integers(0, 5)))
    if draw(st.integers(0, 5)) == 0:
        rows = [[f'"{text}"' for text in row] for row in rows]
    text = "".join(sign.join(row) + more + "\n" for row in rows)
    wanted = draw(st.sampled_from([(0, 1, 2), (2, 0), (1,)]))
    return text, Dialect(sign, mark, ("number",) * width, cells=width + len(more)), wanted


def outcome(
    text: str, dialect: Dialect, indexes: tuple[int, ...], heading: Heading | None = None, *,
    sure: bool = True,
) -> tuple:  # fmt: skip
    """Everything that is read, to the bit, or the sentence why not."""
    try:
        got = load_rows(lambda: iter([text]), dialect, indexes, heading, is_decimal_certain=sure)
    except ReadError as error:
        return (str(error),)
    # whatever the sign of what is no number
    values = np.where(np.isnan(got.values), np.nan, got.values)
    return (values.shape, values.tobytes(), got.lines, got.notes, got.starts, got.questions)


COMMA = Dialect(",", ".", ("number",) * 3, cells=3)


@example(("true 0 0\n", Dialect(" ", ".", ("number",) * 3, cells=3), (1,)))
@example(("-0,0,1\n", COMMA, (0, 1, 2)))
@example(("1,2,-0\n", COMMA, (0, 1, 2)))
@example(("\n", Dialect(",", ".", ("number",)), (0,)))
@example((";\n1;\n", Dialect(";", ".", ("number",), cells=2), (0,)))
@example(("1;;3;;\n4;;6;;\n", Dialect(";", ".", ("number",) * 3, cells=5), (0, 2)))
@example(("1;2;3\n1;2\n1;2;3;4\n", Dialect(";", ".", ("number",) * 3, cells=3), (0, 2)))
@example((3 * "1;2;3;4;\n", Dialect(";", ".", ("number",) * 3, cells=3), (0, 2)))
@example(("1,5;2,5;3\n", Dialect(";", ".", ("number",) * 3, cells=3), (0, 1, 2)))
@given(tables())
def test_the_fast_way_reads_the_same_bits_or_refuses_with_the_same_words(table):
    with patch.object(SplitLines, "numbers", return_value=None):
        by_json = outcome(*table)
        with patch.object(PlainRows, "_from_json", return_value=None):
            expected = outcome(*table)
    assert by_json == expected
    assert outcome(*table) == expected


@example([["-0.000000", "0.1", "9"], ["12345678.123456", "-999.9", "123456789012345"]])
@example([[".12345678901234", "5.", "007"], ["0.00000000000001", "-0.", "-0"]])
@given(even_rows(3))
def test_digits_of_even_columns_are_read_to_the_nearest_double(rows):
    """Of all columns whose numbers have fifteen digits at most."""
    lines = "".join(";".join(row) + "\n" for row in rows)
    parted_lines = split_line_cells(lines.encode(), ord(";"))
    wanted = [i for i in range(3) if all(sum(map(str.isdigit, row[i])) <= 15 for row in rows)]
    values = parted_lines.numbers(wanted, b".")
    assert values.tobytes() == np.array([[float(row[i]) for i in wanted] for row in rows]).tobytes()


@pytest.mark.parametrize(
    "odd",
    ["", "-", ".", "1.50", "15", "1.-5", "--1.5", "+1.5", " 1.5", "1.5 ", "1,5", "1/5",
     "1:5", "a.5", "1.e", "nan", "1e5", "\x00.5", "1234567890123456.5"]
)  # fmt: skip
@pytest.mark.parametrize("first", [True, False])
def test_split_line_cells_leaves_an_irregular_number_unparsed(odd, first):
    rows = [f"{odd};1", "2.5;1"] if first else ["2.5;1", f"{odd};1"]
    parted_lines = split_line_cells("".join(f"{row}\n" for row in rows).encode("latin-1"), ord(";"))
    assert parted_lines.numbers((0,), b".") is None


@given(st.lists(numerals.filter(lambda text: not text.endswith("-0")), min_size=1, max_size=30))
def test_the_fast_way_reads_the_nearest_double(cells):
    """Python's own conversion rounds correctly, whatever the decimal."""
    reader = PlainRows(Dialect(",", ".", ("number",)), (0,))
    from_json = reader._from_json("".join(f"{text}\n" for text in cells).encode(), 0)
    assert from_json[:, 0].tobytes() == np.array([float(text) for text in cells]).tobytes()


CLOCKS = {
    "over midnight": ["23:59:58.25", "23:59:59,5", "00:00:00", "00:00:01.125"],
    "an hour of one digit": ["9:59:59.9", "10:00:00.0", "10:00:00.1"],
    "dates": ["2024-01-31 23:59:59", "2024-02-01 00:00:00.5", "2024-02-01T00:00:01"],
    "dates with points": ["31.12.2024 23:59:59,999999", "01.01.2025 00:00:00,000001"],
    "dates of two kinds": ["04/05/2024 23:59:59", "04/06/2024 00:00:00"],
    "halves of a day": ["11:59:59 AM", "12:00:00 PM", "12:00:01 PM"],
    "zones": ["01:59:59+01:00", "03:00:00+02:00", "03:00:01Z"],
    "a colon before the milliseconds": ["00:00:01:500", "00:00:02:000"],
    "minutes alone": ["12:30", "12:31"],
    "minutes with tenths": ["12:30.5", "12:31.5"],
    "a hole": ["00:00:01", "", "00:00:03"],
    "a word": ["00:00:01", "pause", "00:00:03"],
    "padded": [" 00:00:01 ", "00:00:02.5"],
    "too much": ["00:00:61.5", "99:99:99"],
}


@pytest.mark.parametrize("order", ["", "ms", "hm", "dmy"])
@pytest.mark.parametrize("mark", [".", ","])
@pytest.mark.parametrize("times", CLOCKS.values(), ids=CLOCKS)
def test_clock_times_are_read_the_same_however(times, mark, order):
    """In blocks and one by one: the same bits, notes and questions."""
    rows = [f'1{mark}5;{"" if i % 3 else chr(34)}{item}{"" if i % 3 else chr(34)};{i}'
            for i, item in enumerate(40 * times)]  # fmt: skip
    text = "".join(f"{row}\n" for row in rows)
    how = Dialect(";", mark, ("number", "clock", "number"), cells=3)
    heading = Heading(tuple(map(Column, "abc")), ("", order, ""))
    with patch.object(PlainRows, "_without_clocks", return_value=("", {})):
        expected = outcome(text, how, (1, 2), heading)
    assert outcome(text, how, (1, 2), heading) == expected


@pytest.mark.parametrize("word", ["over midnight", "an hour of one digit", "dates", "padded"])
def test_ordinary_clock_times_are_read_in_blocks(word):
    """Else the law above would hold of nothing."""
    how = Dialect(";", ".", ("clock", "number"), cells=2)
    reader = PlainRows(how, (0, 1), {0: ClockColumn("")})
    assert reader.read("".join(f"{item};1.5\n" for item in CLOCKS[word])) is not None


@pytest.mark.parametrize(("sign", "mark"), [(",", "."), (";", ","), (" ", "."), (" ", ",")])
def test_even_rows_are_read_by_their_digits(sign, mark):
    """Else the laws above would hold of nothing."""
    rows = [["0.50", "-1.2", "7"], ["12.12", "10.0", "-0"], ["0.00", "0.5", "1"]]
    text = "".join(sign.join(item.rjust(6 * sign.isspace()) for item in row) + "\n" for row in rows)
    reader = PlainRows(Dialect(sign, mark, ("number",) * 3), (2, 0))
    others = patch.multiple(PlainRows, _parse=None, _from_json=None)
    with others:
        values = reader.read(text.replace(".", mark))
    assert values.tolist() == [[7.0, 0.5], [-0.0, 12.12], [1.0, 0.0]]
    assert np.signbit(values[1, 0])


@pytest.mark.parametrize(("sign", "mark"), [(",", "."), (";", ","), ("\t", "."), (";", ".,")])
@pytest.mark.parametrize("more", [0, 1, 2])
def test_ordinary_rows_are_read_the_fast_way(sign, mark, more):
    """Else the laws above would hold of nothing."""
    rows = [["0.5", "-1.25e-3", "7"], ["12.125", "1E+5", "-0"]]
    text = "".join(sign.join(row) + sign * more + "\n" for row in rows)
    text = text.replace(".", ",") if mark == "," else text
    reader = PlainRows(Dialect(sign, mark, ("number",) * 3), (2, 0))
    with patch.object(PlainRows, "_parse", side_effect=AssertionError):
        values = reader.read(text)
    np.testing.assert_array_equal(values, [[7.0, 0.5], [-0.0, 12.125]])
    assert np.signbit(values[1, 0])


@st.composite
def grouped_tables(draw: st.DrawFn) -> tuple[str, Dialect, tuple[int, ...]]:
    """Rows of three cells whose thousands some sign parts, here and there a word or a blank."""
    mark = draw(st.sampled_from([".", ",", ".,"]))
    sign = draw(st.sampled_from([";", "\t", "|", *([","] if mark == "." else [])]))
    quoted = sign == "," or draw(st.booleans())
    group = draw(
        st.sampled_from([",", "'", " ", "\u2009"] if mark == "." else [".", "'", "\u00a0"])
    )
    marks = str.maketrans({",": group, ".": mark[-1]})
    value = st.builds(
        lambda v, digits: f"{v:,.{digits}f}".translate(marks),
        st.floats(-1e7, 1e7),
        st.integers(0, 3),
    )
    odd = st.sampled_from(["", " 1", "1,23", "12.3456", "n/a", "1,2345", "0,123", "1.234", "a"])
    wanted = draw(st.sampled_from([(0, 1, 2), (2,)]))
    cells = draw(st.sampled_from([value, value, value | odd]))
    # what a column holds that nobody asks for is looked at by the row alone
    row = st.tuples(*(cells if i in wanted else value for i in range(3))).map(list)
    rows = draw(st.lists(row, min_size=1, max_size=8))
    rows = [[f'"{item}"' for item in row] if quoted else row for row in rows]
    text = "".join(sign.join(row) + "\n" for row in rows)
    return (
        text,
        Dialect(sign, mark, ("number",) * 3, cells=3),
        wanted,
    )


@example(('"1,234.5","2","3,000"\n"1,234","1","1"\n', COMMA, (0, 1, 2)))
@example(("1 234.5;2;3\n1 234;1;1 2\n", Dialect(";", ".", ("number",) * 3, cells=3), (0, 2)))
@given(grouped_tables())
def test_grouped_thousands_in_blocks_equal_those_by_row(table):
    with patch.object(PlainRows, "_numbers_even_grouped", PlainRows._numbers):
        expected = outcome(*table, sure=False)
    assert outcome(*table, sure=False) == expected


@pytest.mark.parametrize(
    ("text", "sign", "mark", "commas"),
    [
        ('"1,234.5","2","3,000"\n"1,000","1","1"\n', ",", ".", {0, 2}),
        ("1,234.5;2;3\n1000;1;-1,000,000.25\n", ";", ".", {0, 2}),
        ("1'234.5;2;3\n1000;1;-1'000'000.25\n", ";", ".", set()),
        ("1.234,5\t2\t3\n1000\t1\t-1.000.000,25\n", "\t", ",", set()),
        ("1\u2009234,5\t2\t3\n", "\t", ",", set()),
    ],
)
def test_grouped_thousands_are_read_in_blocks(text, sign, mark, commas):
    reader = PlainRows(Dialect(sign, mark, ("number",) * 3), (0, 1, 2))
    values = reader.read(text)
    assert values is not None
    assert values[0, 0] == 1234.5
    assert reader.commas == commas


@pytest.mark.parametrize(("before", "fast"), [(-1, False), (0, True)])
def test_msgspec_is_imported_once_it_saves_more_time_than_it_takes(monkeypatch, before, fast):
    monkeypatch.delitem(sys.modules, "msgspec")
    reader = PlainRows(COMMA, (0,))
    text = b"1,2,3\n"
    monkeypatch.setattr(
        PlainRows, "characters_read", plain_rows._MIN_CHARACTERS + before - len(text)
    )
    assert (reader._from_json(text, 0) is not None) is fast


@pytest.mark.parametrize("size", range(1, 12))
def test_decode_blocks_is_independent_of_block_size(size):
    """Some write two carriage returns before the end of a line, some nothing else."""
    raw = b"1\r\r\n2\r\n3\r4\n\n5\r\r\n"
    blocks = [raw[i : i + size] for i in range(0, len(raw), size)]
    assert "".join(decode_blocks(blocks, "utf-8")) == "1\n2\n3\n4\n\n5\n"
