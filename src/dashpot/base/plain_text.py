"""Plain text for people: sentences, line breaking, and characters safe to print on a terminal."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from dashpot.base.lazy import compile_on_use

# Text that is safe to print on a terminal.


# control characters except tab and line feed, bidirectional marks, bytes that are not text
_CONTROL = "\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff"
_OBEYED = compile_on_use(f"[{_CONTROL}]")
_FORMULA_SIGN = r"[=+@|%\-\uff1d\uff0b\uff0d\uff20]"
"""Characters that start a formula in a spreadsheet, wide letters included."""
_CELL = compile_on_use(rf"""(?<=[,;])( ?"?)(?={_FORMULA_SIGN})""")
_COLOUR = compile_on_use(f"(\x1b\\[(?:[012]|[39][0-7])(?:;(?:[012]|[39][0-7]))*m)|[{_CONTROL}]")


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
    return "'" + line if re.match(_FORMULA_SIGN, line) else line


def format_csv_comment(text: str) -> str:
    """Return a comment of a CSV file on one line, with no formula behind a comma in it.

    A spreadsheet parts a comment into cells like any other line.

    >>> format_csv_comment("seal, =1+1, -0.5 mN")
    "seal, '=1+1, '-0.5 mN"
    """
    return _CELL.sub(r"\1'", " ".join(text.split()))


def _escape_character(sign: str) -> str:
    return sign.encode("unicode_escape").decode("ascii")


# Sentences: their beginning, end, order and length.


_END = compile_on_use(r"(?<=[.?!])(?<!eq\.)(?<!e\.g\.) (?=[A-Z\d])")
# "eq. 5" ends nothing; "k_inf" and "seal.csv" are names, and keep their letters
_WORD = compile_on_use(r"(?!tau\b)(?:a|[a-z]{2,})(?=[\s,;:?!'-]|\.(?:\s|$)|$)")
_NAMES = compile_on_use(
    r"Maxwell|Poisson|Zener|Ogden|Mooney|Neo|Hertz|Prony|Arrhenius|Table|Cpk|Hz"
)
"""Words that keep their capital within a sentence."""


def sentence(text: str) -> str:
    """Return a text that begins with a capital and ends with a stop.

    >>> sentence("the hold is too short"), sentence("k_inf is not known."), sentence("which file?")
    ('The hold is too short.', 'k_inf is not known.', 'Which file?')
    >>> sentence("a hold is needed"), sentence("c is not known")
    ('A hold is needed.', 'c is not known.')
    """
    if not text:
        return ""
    if _WORD.match(text):
        text = text[0].upper() + text[1:]
    return text if text.endswith((".", "?", "!")) else f"{text}."


def paragraph(*parts: str) -> str:
    """Return texts one after another, each as a sentence; empty ones are omitted."""
    return " ".join(sentence(part) for part in parts if part)


def decapitalise_sentence(text: str) -> str:
    """Return a sentence with a lower-case start, for use after a colon or a comma.

    >>> decapitalise_sentence("The hold is too short."), decapitalise_sentence(
    ...     "FRF lines are missing."), decapitalise_sentence("Maxwell arm")
    ('the hold is too short.', 'FRF lines are missing.', 'Maxwell arm')
    """
    first = re.match(r"(?:A|[A-Z][a-z]+)(?=[\s,;:'-])", text)
    if first is None or _NAMES.match(text):
        return text
    return text[0].lower() + text[1:]


def sentences(text: str) -> list[str]:
    """Return the sentences of a text.

    >>> sentences("The hold is short. It lasts 3 s (eq. 5). 10 are needed.")
    ['The hold is short.', 'It lasts 3 s (eq. 5).', '10 are needed.']
    """
    return _END.split(text) if text else []


def count_words(text: str) -> int:
    """Return how many words a text has; a number and its unit are two."""
    return len(text.split())


def clip_sentences(
    max_words: int, lines: Sequence[str], closing_sentences: Iterable[str] = ()
) -> str:
    """Return the sentences of `lines` that fit before `closing_sentences`, but one at least."""
    end = [name for name in closing_sentences if name]
    retained = list(lines)
    while len(retained) > 1 and count_words(" ".join((*retained, *end))) > max_words:
        retained.pop()
    return " ".join((*retained, *end))
