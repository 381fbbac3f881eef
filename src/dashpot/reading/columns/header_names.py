"""A column's name and its unit, where one cell holds both."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable

from dashpot.base import units
from dashpot.reading.columns import vocabulary
from dashpot.reading.columns.unit_factors import off_the_name

_LONGEST = 500
"""Characters of a name; what is longer is cut."""
_OF_WHAT = re.compile(r"\A(?:[A-Za-z]\(t\)|(?i:tan ?\((?:delta|d|δ)\)))\Z")  # E(t): no tonnes
_IN_BRACKETS = re.compile(
    r"[\[(<{]([^\[\](){}<>]*+(?:\([^()]*+\)[^\[\](){}<>]*+){0,2})[\])>}][\s,;:]*+\Z"
)
_PRIMED = re.compile(r"[A-Za-z]['\"]{1,2}")
"""A modulus as rheologists write it: its quotes are no quotes."""
_UNIT_FIRST = re.compile(r"\A[\[(]([^\[\]()]++)[\])]\s*+([^\[\]()]++)\Z")
_SIGNS = re.compile(r"\s*[,/:]\s*|\s+in\s+|[\s_.\-]+")
_PLAIN_TAIL = re.compile(r"\A(.*\S)(?:\s+in\s+|\s*,\s+|\s+/\s+)([^\s,:_]+)\Z")


def remove_quotes(text: str) -> str:
    """Return a cell without the quotes around it, or lost at one end.

    >>> remove_quotes('"Force"'), remove_quotes('G"')
    ('Force', 'G"')
    """
    text = text.strip()
    return text if _PRIMED.fullmatch(text) else text.strip("\"'").strip()


def split_unit(name: str) -> tuple[str, str | None]:
    """Return a header cell as its name and its unit, None if it has none.

    >>> split_unit("Force (N)"), split_unit("Load__kN_"), split_unit("Kraft_N"), split_unit("time")
    (('Force', 'N'), ('Load', 'kN'), ('Kraft', 'N'), ('time', None))
    """
    raised = name[:_LONGEST].replace("⁻", "^-").replace("^-²", "^-2").replace("²", "^2")
    text = unicodedata.normalize("NFKC", raised)
    text = remove_quotes(text.replace("\u2032", "'"))  # a prime: G″ is two of them by now
    if _OF_WHAT.match(text):
        return text, None
    for shape in _SHAPES:
        names = shape(text)
        if names is not None:
            return names
    return text, None


def add_factor_to_unit(name: str, unit: str | None) -> str | None:
    """Return the unit with the factor of a name such as ``Load x 10^3``: no unit that is known."""
    factor = off_the_name(name[:_LONGEST].strip()) if unit else None
    return f"{factor[1]} {unit}" if factor else unit


def _split_factored_unit(text: str) -> tuple[str, str] | None:
    """``Load [N] x 1000``, whose unit then holds the factor, too."""
    names = off_the_name(text)
    if names is None or names[0][-1] not in "])":
        return None
    name, unit = split_unit(names[0])
    return (name, f"{names[1]} {unit}") if unit else None


def _unit_before(text: str) -> tuple[str, str] | None:
    match = _UNIT_FIRST.match(text)
    certain = match is not None and units.find_unit(match[1])
    return (match[2].strip(), match[1].strip()) if match and certain else None


def _split_bracketed_unit(text: str) -> tuple[str, str | None] | None:
    match = _IN_BRACKETS.search(text)
    if match is None:
        return None
    name, word = text[: match.start()].strip(), match[1].strip()
    return (name or text, word) if word else (name, None)


def _split_mangled_unit(text: str) -> tuple[str, str] | None:
    """``Load__kN_`` and ``Speed_mm_s_``, in which every other sign became an underscore."""
    parts = text.rstrip("_").split("_") if text.endswith("_") else []
    for count in (2, 1):
        stem, word = "_".join(parts[:-count]).strip("_ "), "/".join(parts[-count:])
        if stem and is_unit_of(stem, word):
            return stem, word
    return None


def _after_sign(text: str) -> tuple[str, str] | None:
    match = _PLAIN_TAIL.match(text)
    if match and match[2] != "1" and units.find_unit(match[2]):
        return match[1].strip(), match[2]
    for sign in list(_SIGNS.finditer(text))[:-4:-1]:  # the last few places to cut, last first
        stem, word = text[: sign.start()], text[sign.end() :]
        if stem and word and is_unit_of(stem, word):
            return stem.strip(" _,/:"), word
    return None


_SHAPES: tuple[Callable[[str], tuple[str, str | None] | None], ...] = (
    _split_factored_unit, _unit_before, _split_bracketed_unit, _split_mangled_unit, _after_sign,
)  # fmt: skip
"""The ways to write a unit into a name, the surest first."""


def is_unit_of(stem: str, word: str) -> bool:
    """Whether a trailing word is the unit of what the stem names: Kraft_N, not Channel_1."""
    if word.isdigit():  # as thousands of channels are counted
        return False
    for role in vocabulary.matches(stem):
        dimension = vocabulary.DIMENSION.get(role)
        if dimension is not None:
            unit = units.find_unit(word, dimension)
            if unit is not None and unit.word != "1":
                return True
    return False
