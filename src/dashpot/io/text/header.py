"""Names and units from the lines above a table."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Iterator, Sequence

from dashpot.base import units
from dashpot.io.columns import vocabulary
from dashpot.io.table import Column, Content
from dashpot.io.text import cells as cell
from dashpot.io.text.dialect import Dialect

_COMMENT = re.compile(r"^\s*(?:#+|%+|//+|\$+|!+|\*+|'+|--+|>+|@+)\s*")
_OF_TIME = re.compile(r"[A-Za-z]\(t\)")  # E(t): no tonnes
_BRACKETS = re.compile(
    r"^(.*?)\s*[\[(<{]\s*([^\[\](){}<>]*(?:\([^()]*\))?[^\[\](){}<>]*?)\s*[\])>}]\s*$", re.DOTALL
)
_UNIT_FIRST = re.compile(r"^[\[(]([^\[\]()]+)[\])]\s*([^\[\]()]+)$")
_MANGLED = re.compile(r"^(.*?)_+([^\W_]+(?:_[^\W_]+)?)_+$")
_SIGNS = re.compile(r"\s*[,/:]\s*|\s+in\s+|[\s_.\-]+")
_PLAIN_TAIL = re.compile(r"^(.*\S)(?:\s+in\s+|\s*,\s+|\s+/\s+)([^\s,:_]+)$")
_REACH = 6


def uncomment(line: str, delimiter: str) -> str:
    """Drop a comment mark from the start of a line."""
    text = _COMMENT.sub("", line, count=1)
    if delimiter != ";" and text.lstrip().startswith(";"):
        text = text.lstrip()[1:]
    return text


def name_columns(lines: Sequence[str], dialect: Dialect) -> tuple[Column, ...]:
    """Return the columns with the names and units found in the lines above the table."""
    width = len(dialect.contents)
    rows = [_cells(line, dialect) for line in lines if re.search(r"\w|%|\"", line) is not None][
        -_REACH:
    ]
    names, words = _pick(rows, width)
    names, words = (
        _labelled(lines, dialect, "name") or names,
        _labelled(lines, dialect, "unit") or words,
    )
    columns = []
    for i, content in enumerate(dialect.contents):
        name = names[i] if i < len(names) else ""
        word = words[i] if i < len(words) else None
        columns.append(_column(name, word, content))
    return tuple(columns)


def _column(name: str, word: str | None, content: Content) -> Column:
    if content == "clock":  # read as seconds, whatever "hh:mm:ss" stands over it
        return Column(part_unit(name)[0], "s", content)
    if word is not None and word.strip(" -[]()<>{}"):
        stem, inner = part_unit(name)
        same = inner is not None and units.find(inner) == units.find(_strip(word))
        return Column(stem if same else name, _strip(word), content)
    stem, unit = part_unit(name)
    return Column(stem, unit, content)


def _strip(word: str) -> str:
    return word.strip().strip("\"'").strip().lstrip("[({<").rstrip("])}>").strip()


def _cells(line: str, dialect: Dialect) -> list[str]:
    """A header line cut into cells: by the table's delimiter, or by one that fits better."""
    text = uncomment(line, dialect.delimiter)
    width = len(dialect.contents)
    found = cell.split(text, dialect.delimiter)
    if len(found) == width + 1 and (not found[0] or found[0].endswith(":")):
        return found[1:]  # a label stands before the row: "Interval data:"
    fixed = dialect.delimiter.startswith("fixed")  # headings need not keep to the columns
    if abs(len(found) - width) <= 1 and len(found) > 1 and not fixed:
        return found
    cuts = _other_cuts(text, dialect.delimiter)
    return next((again for again in cuts if len(again) == width), found)


def _other_cuts(text: str, delimiter: str) -> Iterator[list[str]]:
    """The cells of a header line by what else may part them."""
    for other in ("\t", ";", ",", "|"):
        if other in text and other != delimiter:
            yield cell.split(text, other)
    bracketed = re.findall(r"[^\[\]()]+?\s*(?:\[[^\]]*\]|\([^)]*\))", text)
    yield [part.strip(" \t,;|") for part in bracketed]
    yield [part.strip() for part in re.split(r"\s{2,}|\t", text.strip())]
    yield re.findall(r'"([^"]*)"', text)


_LABELS = {
    "name": re.compile(
        r"(?:columns?|column[ _]names?|names?|fields?|channels?|variables?)\s*[:=]\s*", re.I
    ),
    "unit": re.compile(r"(?:column[ _])?units?\s*[:=]\s*", re.I),
}


def _labelled(lines: Sequence[str], dialect: Dialect, what: str) -> list[str]:
    """The cells of a line such as ``# columns: a b c``, if it has one for each column."""
    for line in lines:
        text = uncomment(line, dialect.delimiter)
        match = _LABELS[what].match(text)
        if match:
            found = _cells(text[match.end() :], dialect)
            if len(found) == len(dialect.contents):
                return found
    return []


def _pick(rows: Sequence[list[str]], width: int) -> tuple[list[str], list[str]]:
    """The row of names and the row of units among the last lines above the table."""
    words: list[str] = []
    for i in range(len(rows) - 1, -1, -1):
        row, above = rows[i], rows[i - 1] if i else []
        if not words and _is_units(row, width):
            words = row
        elif _is_names(row, width):
            beside = not words and len(above) == len(row) and _is_units(above, width)
            return row, above if beside else words
        elif any(row) and (words or len(row) >= max(2, width - 1)):
            break
    return [], words


def _is_units(row: Sequence[str], width: int) -> bool:
    """Whether a row holds units: most filled cells are unit words, and it is about as wide."""
    filled = [_strip(text) for text in row if text.strip(" -[]()")]
    if not filled:
        return False
    if not width - 1 <= len(row) <= width + 2:  # a shorter row must hold nothing else
        return 2 <= len(row) == len(filled) <= width and all(map(units.find, filled))
    known = sum(units.find(word) is not None or _unit_shape(word) for word in filled)
    named = any(vocabulary.plain(word) in vocabulary.FIRST for word in filled)
    bracketed = sum(map(_is_bracketed, row)) == len(filled)
    return not named and (known >= 0.6 * len(filled) or bracketed)


def _is_bracketed(text: str) -> bool:
    return re.fullmatch(r"[\[(].*[\])]", text.strip(), re.DOTALL) is not None


def _unit_shape(word: str) -> bool:
    """Whether an unknown word is built like a unit: ``1/MPa``, ``Pa.s``, ``g²/Hz``."""
    parts = [part for part in re.split(r"[/*·.^²³\d\s-]+", word) if part]
    return bool(parts) and len(parts) > 1 and all(units.find(part) for part in parts)


def _is_names(row: Sequence[str], width: int) -> bool:
    filled = [text for text in row if text]
    if not filled or len(row) > width + 2 or len(row) < min(width, max(1, width - 2)):
        return False
    letters = sum(re.search(r"[^\W\d_]", text) is not None for text in filled)
    return letters >= 0.6 * len(filled) and len(filled) >= 0.5 * width


def part_unit(name: str) -> tuple[str, str | None]:
    """Return a header cell as its name and its unit, None if it has none.

    >>> part_unit("Force (N)"), part_unit("Load__kN_"), part_unit("Kraft_N"), part_unit("time")
    (('Force', 'N'), ('Load', 'kN'), ('Kraft', 'N'), ('time', None))
    """
    text = unicodedata.normalize("NFKC", name.replace("²", "^2")).strip().strip("\"'").strip()
    if _OF_TIME.fullmatch(text):
        return text, None
    for shape in _SHAPES:
        found = shape(text)
        if found is not None:
            return found
    return text, None


def _unit_before(text: str) -> tuple[str, str] | None:
    match = _UNIT_FIRST.match(text)
    known = match is not None and units.find(match[1])
    return (match[2].strip(), match[1].strip()) if match and known else None


def _bracketed(text: str) -> tuple[str, str | None] | None:
    match = _BRACKETS.match(text)
    if match is None:
        return None
    name, word = match[1].strip(), match[2].strip()
    return (name or text, word) if word else (name, None)


def _mangled(text: str) -> tuple[str, str] | None:
    match = _MANGLED.match(text)
    word = match[2].replace("_", "/") if match else ""
    return (match[1].strip("_ "), word) if match and _is_unit_of(match[1], word) else None


def _after_sign(text: str) -> tuple[str, str] | None:
    match = _PLAIN_TAIL.match(text)
    if match and match[2] != "1" and units.find(match[2]):
        return match[1].strip(), match[2]
    for sign in list(_SIGNS.finditer(text))[:-4:-1]:  # the last few places to cut, last first
        stem, word = text[: sign.start()], text[sign.end() :]
        if stem and word and _is_unit_of(stem, word):
            return stem.strip(" _,/:"), word
    return None


_SHAPES: tuple[Callable[[str], tuple[str, str | None] | None], ...] = (
    _unit_before, _bracketed, _mangled, _after_sign,
)  # fmt: skip
"""The ways to write a unit into a name, the surest first."""


def _is_unit_of(stem: str, word: str) -> bool:
    """Whether a trailing word is the unit of what the stem names: Kraft_N, not Channel_1."""
    for role in vocabulary.matches(stem):
        dimension = vocabulary.DIMENSION.get(role)
        if dimension is not None:
            unit = units.find(word, dimension)
            if unit is not None and unit.word != "1":
                return True
    return False
