"""Text that a terminal prints and does not obey."""

from __future__ import annotations

import re

# controls but tab and line feed, marks that turn the direction of writing, bytes that are no text
_CONTROL = "\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff"
_OBEYED = re.compile(f"[{_CONTROL}]")
_FORMULA = re.compile(r"[=+@|%\-\uff1d\uff0b\uff0d\uff20]")
"""What a spreadsheet takes for the beginning of a formula, as wide letters, too."""
_CELL = re.compile(rf"""(?<=[,;])( ?"?)(?={_FORMULA.pattern})""")
_COLOUR = re.compile(f"(\x1b\\[(?:[012]|[39][0-7])(?:;(?:[012]|[39][0-7]))*m)|[{_CONTROL}]")


def escape_terminal_text(text: str, *, colours: bool = False) -> str:
    r"""Return text with every sign that a terminal would obey written as an escape.

    A file's name, its header and its column names are others' words: an escape sequence in them
    must not move the cursor, set the title or hide what follows. With `colours` the sequences
    that make text bold, dim or coloured stay.

    >>> escape_terminal_text("seal\x1b[2J.csv\n")
    'seal\\x1b[2J.csv\n'
    """
    if colours:
        return _COLOUR.sub(lambda match: match[1] or _escape_character(match[0]), text)
    return _OBEYED.sub(lambda match: _escape_character(match[0]), text)


def escaped_json(text: str) -> str:
    """Return a JSON document with those signs as JSON escapes: it holds the same."""
    return re.sub(f"(?!\n)[{_CONTROL}]", lambda match: f"\\u{ord(match[0]):04x}", text)


def escape_formula(cell: str) -> str:
    """Return a text cell that no spreadsheet takes for a formula.

    >>> escape_formula("=1+1"), escape_formula("m_1")
    ("'=1+1", 'm_1')
    """
    line = " ".join(cell.split())
    return "'" + line if _FORMULA.match(line) else line


def format_csv_comment(text: str) -> str:
    """Return a comment of a CSV file on one line, with no formula behind a comma in it.

    A spreadsheet parts a comment into cells like any other line.

    >>> format_csv_comment("seal, =1+1, -0.5 mN")
    "seal, '=1+1, '-0.5 mN"
    """
    return _CELL.sub(r"\1'", " ".join(text.split()))


def _escape_character(sign: str) -> str:
    return sign.encode("unicode_escape").decode("ascii")
