"""Column names and units from the lines above a table."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import zip_longest

from dashpot.base import dataclass, units
from dashpot.base.lazy import compile_on_use
from dashpot.base.provenance import Caution
from dashpot.reading.columns import vocabulary
from dashpot.reading.columns.header_units import (
    add_factor_to_unit,
    is_unit_of,
    join_units,
    split_heading,
    split_unit,
    strip_brackets,
)
from dashpot.reading.table import Column, Content
from dashpot.reading.text import cells as cell
from dashpot.reading.text.dialect import MAX_LENGTH, Dialect

_COMMENT = compile_on_use(r"\A\s*+(?:#++|%++|//++|\$++|!++|\*++|'++|--++|>++|@++)\s*+")
_CLOSED = compile_on_use(r"(?<=[\])])")
_HEADER_LINES = 6
_COUNTERS = {"index", "no", "nr", "n", "number", "point", "reading", "row", "nummer", "messpunkt"}
"""Names of a first column that counts the rows, and has no unit."""
_SIGNAL = compile_on_use(r"\ASig(\d{1,3})[\t ,;:=]\s*+(.{1,200})\Z")
_MARKS = ("\t", ";", ",", "|")
_ZERO_FACTOR = 1e-9


def uncomment(line: str, delimiter: str) -> str:
    """Drop a comment mark from the start of a line."""
    text = _COMMENT.sub("", line, count=1)
    if delimiter != ";" and text.lstrip().startswith(";"):
        text = text.lstrip()[1:]
    return text


@dataclass(frozen=True)
class Header:
    """Contents of the lines above a table: its columns, and the format of their clock times.

    `misfit` says of a row of names that is not as wide as the table; none of it is taken. `uneven`
    says of a row of units that is not, which of them are.
    """

    columns: tuple[Column, ...]
    clocks: tuple[str, ...]
    misfit: str = ""
    uneven: str = ""


def read_header(lines: Sequence[str], dialect: Dialect) -> Header:
    """Return the names and units found in the lines above the table."""
    # a row of numbers alone counts columns or rows, and names none
    spoken = list(filter(re.compile(r"[^\W\d]|%|\"|°").search, _join_quoted_lines(lines)))
    rows = [_cells(line, dialect) for line in spoken[-_HEADER_LINES:]]
    names, words, uneven_units = _pick(rows, dialect)
    names = _find_labelled_cells(lines, dialect, "name") or names
    words = _find_labelled_cells(lines, dialect, "unit") or words
    width = len(dialect.contents)
    names, words = _parse_column_lines(lines, width) or _signals(lines, width) or (names, words)
    misfit = "" if names else _misfit(rows[:-3:-1], dialect)
    uneven = ""
    if uneven_units and names and not words:
        words, uneven = _assign_uneven_units(uneven_units, names, dialect)
    pairs = zip_longest(names[:width], words[:width], dialect.contents)
    padded = [(name or "", word, content) for name, word, content in pairs]
    return Header(
        tuple(_column(name, word, content) for name, word, content in padded),
        tuple(_clock(name, word) if content == "clock" else "" for name, word, content in padded),
        misfit,
        uneven,
    )


def _assign_uneven_units(
    unit_row: Sequence[str], names: Sequence[str], dialect: Dialect
) -> tuple[list[str], str]:
    """Return units from a row of another width than the table, and a note.

    They stand under the names from the left, unless one contradicts its name: then a cell is
    missing or added further left, nobody knows where, and none is taken.
    """
    width = len(dialect.contents)
    if (
        len(unit_row) == width - 1
        and unit_row[0]
        and vocabulary.normalise_name(names[0]) in _COUNTERS
    ):
        return ["", *unit_row], ""
    message = (
        f"the row of units has {len(unit_row)} cells for {width} columns "
        f"('{unit_row[0]}' ... '{unit_row[-1]}')"
    )
    pairs = list(zip(names[:width], map(strip_brackets, unit_row), strict=False))
    if any(_denies(split_unit(name)[0], word) for name, word in pairs):
        return [], f"{message}; none was taken, for under the names from the left they do not fit"
    note = f"{message}; they were taken for those of the columns from the left"
    return list(unit_row[:width]), Caution(note)


def _denies(name: str, word: str) -> bool:
    """Return whether a unit contradicts the meaning of a name."""
    if units.find_unit(word) is None:
        return False
    sentences = [role for role, value in vocabulary.matches(name).items() if value >= 2.0]
    measured = [
        words[role]
        for role in sentences
        for words in (vocabulary.DIMENSION, vocabulary.OF_A_PART)
        if role in words
    ]
    return bool(measured) and not any(units.find_unit(word, text) for text in measured)


def _clock(name: str, word: str | None) -> str:
    """Return how the clock times of a column are written, "" if its unit does not say."""
    return vocabulary.clock_order(word or split_unit(name)[1] or "")


def _misfit(rows: Sequence[list[str]], dialect: Dialect) -> str:
    """Return the note on a row of names that is not as wide as the table; empty without one."""
    misfit_row = next((row for row in rows if _misfits(row, dialect)), [])
    if not misfit_row:
        return ""
    cells = dialect.cells or len(dialect.contents)
    message = (
        f"the header holds {len(misfit_row)} names for {cells} columns ('{misfit_row[0][:20]}' ... "
        f"'{misfit_row[-1][:20]}'), so that none was taken"
    )
    if cells == 2 * len(misfit_row) and dialect.delimiter == ",":
        message += (
            "; two columns for each name look like numbers cut in two at their decimal "
            "comma: export the file with ';' between the columns, or with decimal points"
        )
    return message


def _join_quoted_lines(lines: Sequence[str]) -> list[str]:
    """Return the lines without the overlong, each quoted cell that runs over line ends in one."""
    joined_lines: list[str] = []
    for line in lines:
        if (
            joined_lines
            and _is_open(joined_lines[-1])
            and len(joined_lines[-1]) + len(line) < MAX_LENGTH
        ):
            joined_lines[-1] += " " + line
        elif len(line) <= MAX_LENGTH:
            joined_lines.append(line)
    return joined_lines


def _is_open(line: str) -> bool:
    """Return whether a quoted cell begins in a line and does not end in it."""
    before = line.rpartition('"')[0].rstrip(" ")
    return line.count('"') % 2 == 1 and (not before or before[-1] in "\t;,|")


def _column(name: str, word: str | None, content: Content) -> Column:
    if content == "clock":  # read as seconds, whatever "hh:mm:ss" stands over it
        return Column(split_unit(name)[0], "s", content)
    column_name, unit = split_heading(name, word)
    return Column(column_name, add_factor_to_unit(column_name, unit), content)


def _cells(line: str, dialect: Dialect) -> list[str]:
    """Return a header line cut into cells: by the table's delimiter, or by one that fits better."""
    text, width = uncomment(line, dialect.delimiter), len(dialect.contents)
    if dialect.delimiter in _MARKS and line.partition(dialect.delimiter)[0].strip() == "%":
        text = line  # the unit of the first column
    parts = cell.split(text, dialect.delimiter)
    if len(parts) == width + 1 and (parts[0] in {"", "%"} or parts[0].endswith(":")):
        return parts[1:]  # a label stands before the row: "Interval data:"
    if len(parts) == width - 1 and text.rstrip(" \r\n").endswith(dialect.delimiter):
        parts.append("")  # the last has no unit
    fixed = dialect.delimiter.startswith("fixed")  # headings need not keep to the columns
    if len(parts) > 1 and not fixed and _fits(parts, dialect):
        return parts
    cuts = _other_cuts(text, dialect.delimiter)
    return next((other_cells for other_cells in cuts if len(other_cells) == width), parts)


def _other_cuts(text: str, delimiter: str) -> Iterator[list[str]]:
    """Return the cells of a header line for each other delimiter."""
    for other in _MARKS:
        if other in text and other != delimiter:
            yield cell.split(text, other)
    closed = (part.strip(" \t,;|") for part in _CLOSED.split(text))
    yield [part for part in closed if part[-1:] in {"]", ")"} and re.search(r"[\[(]", part)]
    yield [part.strip() for part in re.split(r"\s{2,}|\t", text.strip())]
    yield re.findall(r'"([^"]*)"', text)
    words = [] if any(other in text for other in "\t;,|") else text.split()
    score = sum(
        bool(vocabulary.matches(word)) or units.find_unit(word) is not None for word in words
    )
    yield words if 2 * score >= len(words) else []  # else a sentence


_LABELS = {
    "name": compile_on_use(
        r"\A(?:columns?|column[ _]names?|names?|fields?|channels?|variables?)\s*[:=]\s*", re.I
    ),
    "unit": compile_on_use(r"\A(?:column[ _])?units?\s*[:=]\s*", re.I),
}


def _find_labelled_cells(lines: Sequence[str], dialect: Dialect, label_kind: str) -> list[str]:
    """Return the cells of a line such as ``# columns: a b c``, if it has one for each column."""
    for line in lines:
        text = uncomment(line, dialect.delimiter)
        match = _LABELS[label_kind].match(text)
        if match:
            names = _cells(text[match.end() :], dialect)
            if len(names) == len(dialect.contents):
                return names
    return []


_NUMBERED = compile_on_use(
    r"\A(?:(?:col(?:umn)?|field|channel|spalte|kanal)\.?\s*)?(\d{1,4})\s*[:=.)]\s*", re.I
)


def _parse_column_lines(lines: Sequence[str], width: int) -> tuple[list[str], list[str]] | None:
    """The names and units of ``# time: s`` or ``# column 1: time [s]``, if so end the lines above.

    There is one comment for each column, and one before them that is none of them.
    """
    run: list[tuple[str, str]] = []
    for line in [line for line in lines if line.strip()][-width - 1 :]:
        text = _COMMENT.sub("", line, count=1).strip()
        number = _NUMBERED.match(text)
        unit = (
            _parse_name_unit(text[number.end() :] if number else text)
            if text != line.strip()
            else None
        )
        if not unit or (number and int(number[1]) != len(run) + 1):
            run = []
        else:
            run.append(unit)
    return ([name for name, _ in run], [word for _, word in run]) if len(run) == width else None


def _signals(lines: Sequence[str], width: int) -> tuple[list[str], list[str]] | None:
    """The names and units of ``Sig1  Time (min)``, if there is one for each column, in order."""
    matches = list(filter(None, map(_SIGNAL.match, lines)))
    if [int(match[1]) for match in matches] != list(range(1, width + 1)):
        return None
    items = [split_unit(match[2].strip()) for match in matches]
    return [name for name, _ in items], [unit or "" for _, unit in items]


def _parse_name_unit(text: str) -> tuple[str, str] | None:
    """Return the name of a column and its unit, as ``time: s`` or ``time [s]``."""
    name, sign, word = text.partition(":")
    if sign and units.find_unit(strip_brackets(word) if word.strip() else "") is not None:
        return name.strip(), word.strip()
    stem, unit = split_unit(text)
    return (stem, unit) if unit and units.find_unit(unit) is not None else None


def _pick(rows: Sequence[list[str]], dialect: Dialect) -> tuple[list[str], list[str], list[str]]:
    """Return the row of names and the row of units among the last lines above the table.

    Behind them a row of units that is not as wide as the table, if one stands there.
    """
    width = len(dialect.contents)
    words: list[str] = []
    uneven_units: list[str] = []
    for i in range(len(rows) - 1, -1, -1):
        row, row_above = rows[i], rows[i - 1] if i else []
        if _is_units(row, dialect):
            words = _merge_unit_rows(row, words) if words else row
        elif _is_names(row, dialect):
            parallel = not words and len(row_above) == len(row) and _is_units(row_above, dialect)
            words, upper = (
                (row_above, rows[i - 2] if i > 1 else []) if parallel else (words, row_above)
            )
            return _fill_blank_names(row, upper, words), words, uneven_units
        elif not words and not uneven_units and len(row) > 1 and _holds_units(row):
            uneven_units = row
        elif any(row) and (words or len(row) >= max(2, width - 1)):
            break
    return [], words, uneven_units


def _fill_blank_names(
    row: Sequence[str], row_above: Sequence[str], words: Sequence[str]
) -> list[str]:
    """Return the names, and where one is blank the one above it that is a name with its unit.

    So stands a cell that runs over both rows of names of a sheet: its text is in the upper one.
    """
    names = list(row)
    for i, (name, upper) in enumerate(zip(row, row_above, strict=False)):
        word = words[i] if i < len(words) else split_unit(upper)[1]
        is_unit = (
            word is not None
            and units.find_unit(strip_brackets(word) if word.strip() else "") is not None
        )
        if not name and is_unit and vocabulary.matches(split_unit(upper)[0]):
            names[i] = upper
    return names


def _merge_unit_rows(upper_row: Sequence[str], lower_row: Sequence[str]) -> list[str]:
    """Merge two rows of units; where they differ, join both."""
    merged = []
    for i in range(max(len(upper_row), len(lower_row))):
        upper, lower = (
            strip_brackets(row[i]) if i < len(row) else "" for row in (upper_row, lower_row)
        )
        is_same_unit = not upper or not lower or units.is_same_unit(upper, lower)
        merged.append((lower or upper) if is_same_unit else join_units(upper, lower))
    return merged


def _fits(row: Sequence[str], dialect: Dialect) -> bool:
    """Return whether a row has a cell for each column, but for words at the end."""
    count = len(row)
    while count and not row[count - 1].strip(" -[]()"):
        count -= 1
    min_width = dialect.numbers[-1] + 1 if dialect.numbers else len(dialect.contents)
    return count <= max(dialect.cells, len(dialect.contents)) and len(row) >= min_width


def _is_units(row: Sequence[str], dialect: Dialect) -> bool:
    """Return whether a row as wide as the table holds units."""
    return _fits(row, dialect) and _holds_units(row)


def _holds_units(row: Sequence[str]) -> bool:
    """Return whether most filled cells of a row are unit words."""
    texts = [text for text in row if text.strip(" -[]()")]
    filled = Counter(vocabulary.replace_channel_number(strip_brackets(text)) for text in texts)
    if not filled or not (all(map(_is_bracketed, texts)) or _most_are_units(filled)):
        return False
    words = map(vocabulary.normalise_name, filled)
    has_names = any(word in vocabulary.FIRST and word not in vocabulary.COUNTED for word in words)
    return not has_names and not all(map(_is_name_over_unit, filled))


def _most_are_units(words: Counter[str]) -> bool:
    """Return whether most words are units, or built like one: no more are judged than decide it."""
    remainder = 0.4 * words.total()
    for word, count in words.items():
        remainder -= count * (not _has_unit(word))
        if remainder < -_ZERO_FACTOR:
            return False
    return True


def _has_unit(word: str) -> bool:
    is_unit = (
        units.find_unit(word) is not None or vocabulary.normalise_name(word) in vocabulary.COUNTED
    )
    return is_unit or _unit_shape(word)


def _is_name_over_unit(word: str) -> bool:
    """Whether a word is a symbol over its unit, as ``t/ms``, and no quotient of two units."""
    stem, sign, unit = word.partition("/")
    return bool(sign) and is_unit_of(stem, unit)


def _is_bracketed(text: str) -> bool:
    stripped = text.strip()
    return len(stripped) > 1 and stripped[0] in "[(" and stripped[-1] in "])"


def _unit_shape(word: str) -> bool:
    """Return whether an unknown word is built like a unit: ``1/MPa``, ``Pa.s``, ``g²/Hz``."""
    if " in " in word:  # "t in s" is a name with its unit: no tonne-inch-seconds
        return False
    parts = [part for part in re.split(r"[/*·.^²³()\d\s-]+", word) if part]
    return bool(parts) and len(parts) > 1 and all(units.find_unit(part) for part in parts)


def _is_names(row: Sequence[str], dialect: Dialect) -> bool:
    """Return whether a row as wide as the table holds words."""
    filled = [text for text in row if text]
    letters = sum(re.search(r"[^\W\d_]", text) is not None for text in filled)
    has_many_letters = letters >= 0.6 * len(filled) and len(filled) >= 0.5 * len(dialect.contents)
    return bool(filled) and has_many_letters and _fits(row, dialect)


def _misfits(row: Sequence[str], dialect: Dialect) -> bool:
    """Return whether a row would name columns if it were as wide as the table."""
    role_cells = [text for text in row if vocabulary.matches(split_unit(text)[0])]
    return len(role_cells) > 1 and not _fits(row, dialect)


def find_header_change(
    lines: Sequence[str], dialect: Dialect, columns: Sequence[Column], indexes: Sequence[int]
) -> str | None:
    """Return how a header inside the table differs from the first; None if it does not."""
    new_header = read_header(lines, dialect)
    if new_header.misfit:
        return new_header.misfit
    if not _has_column_names(new_header.columns):
        return None  # a sentence, not a row of names
    pairs = ((columns[i], new_header.columns[i]) for i in indexes)
    return next(
        (
            f"{_format_column(new)} where the first says {_format_column(old)}"
            for old, new in pairs
            if _contradicts(old, new)
        ),
        "",
    )


def _has_column_names(columns: Sequence[Column]) -> bool:
    """Return whether at least half of the cells are known names or units."""
    total = sum(bool(vocabulary.matches(c.name) or units.find_unit(c.unit or "")) for c in columns)
    return total > 0 and 2 * total >= sum(bool(c.name or c.unit) for c in columns)


def _contradicts(old: Column, new: Column) -> bool:
    """Return whether both have a name, or a unit, and not the same."""
    has_other_name = (
        old.name
        and new.name
        and vocabulary.normalise_name(old.name) != vocabulary.normalise_name(new.name)
    )
    rated = old.unit and new.unit and not units.is_same_unit(old.unit, new.unit)
    return bool(has_other_name or rated)


def _format_column(column: Column) -> str:
    return f"'{column.name}" + (f" [{column.unit}]'" if column.unit else "'")
