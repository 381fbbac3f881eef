"""Units in a column heading: beside the name, with a factor, or as a ratio."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

from dashpot.base import units
from dashpot.base.lazy import compile_on_use
from dashpot.base.units import Dimension, Unit
from dashpot.datamodel.frf import Kind
from dashpot.reading.columns import vocabulary
from dashpot.reading.table import Column

# Units of a frequency response.


_BARE_RATIOS = {"": 1.0, "1": 1.0, "-": 1.0, "db": 1.0, "%": 0.01}
"""Units of a ratio; they mean a transmissibility if a name or a comment states it."""
_RESPONSE_KINDS: tuple[tuple[Dimension, Dimension, Kind], ...] = (
    ("length", "force", Kind.RECEPTANCE),
    ("velocity", "force", Kind.MOBILITY),
    ("acceleration", "force", Kind.ACCELERANCE),
)
_MOTIONS: tuple[Dimension, ...] = ("length", "velocity", "acceleration")
"""Each the derivative of the one before."""


_LONGEST_UNIT = 60
"""Letters of a unit."""


class Ratio(NamedTuple):
    """Ratio of a response: its kind, its factor to SI, and the derivatives still to be taken.

    A motion over another is a transmissibility times s to a power: ``mm/g`` wants s^2. Force over
    velocity or acceleration is a dynamic stiffness over s or s^2.
    """

    kind: Kind
    factor: float
    order: int = 0


_SPECIAL_RATIOS = {
    "1/kg": Ratio(Kind.ACCELERANCE, 1.0),
    "m/(N*s)": Ratio(Kind.MOBILITY, 1.0),
    "m/(N·s)": Ratio(Kind.MOBILITY, 1.0),
    **dict.fromkeys(("s^2", "s²", "s2", "s**2"), Ratio(Kind.TRANSMISSIBILITY, 1.0, 2)),
}


def parse_response_unit(word: str) -> Ratio | None:
    """Return the ratio of a unit such as ``(m/s^2)/N``, ``1/kg`` or ``g/g``; None if it is none.

    >>> millimetres = parse_response_unit("mm/g")
    >>> millimetres.kind.value, millimetres.order, parse_response_unit("furlong/N")
    ('transmissibility', 2, None)
    """
    text = (undecibel(word) or word).replace(" s)", "*s)").strip()
    if text in _SPECIAL_RATIOS:
        return _SPECIAL_RATIOS[text]
    impedance = units.find_unit(text, "damping")
    if impedance:
        return Ratio(Kind.DYNAMIC_STIFFNESS, impedance.factor, 1)
    swapped_match = re.fullmatch(r"\(?1/(\w+)\)?\s*[*·]\s*(.+)", text)  # (1/N)*(m/s^2)
    if swapped_match:
        return _parse_unit_ratio(swapped_match[2], swapped_match[1])
    # each / may be the one between them: (m/s^2)/m/s^2
    cuts = [i for i, letter in enumerate(text[:_LONGEST_UNIT]) if letter == "/"]
    return next(filter(None, (_parse_unit_ratio(text[:i], text[i + 1 :]) for i in cuts)), None)


def bare_ratio(word: str) -> Ratio | None:
    """A dimensionless ratio, whose meaning another source states."""
    factor = _BARE_RATIOS.get((undecibel(word) or word).casefold())
    return None if factor is None else Ratio(Kind.TRANSMISSIBILITY, factor)


def undecibel(word: str) -> str | None:
    """Return the unit of decibels, such as g/g in ``dB re 1 g/g``; None for another unit.

    >>> undecibel("dB re 1 g/g"), undecibel("dB ref 1 g/N"), undecibel("dB"), undecibel("g/g")
    ('g/g', 'g/N', 'dB', None)
    """
    if not word.casefold().startswith("db"):
        return None
    rest = word[2:].strip(" ()[],.:")
    for filler in ("rel", "ref", "re", ".", "1 "):
        if rest.casefold().startswith(filler):
            rest = rest[len(filler) :].strip()
    return rest or "dB"


def _parse_unit_ratio(top: str, bottom: str) -> Ratio | None:
    """Return the kind of response with the unit `top` over the unit `bottom`."""
    top, bottom = top.strip("() "), bottom.strip("() ")
    for upper, lower, kind in _RESPONSE_KINDS:
        a, b = units.find_unit(top, upper), units.find_unit(bottom, lower)
        if a is not None and b is not None:
            return Ratio(kind, a.factor / b.factor)
    numerator, denominator = _find_motion_unit(top), _find_motion_unit(bottom)
    force = units.find_unit(top, "force")
    if (
        force and denominator
    ):  # of an impedance or an apparent mass the derivatives are still to be taken
        return Ratio(Kind.DYNAMIC_STIFFNESS, force.factor / denominator[1], denominator[0])
    if numerator is None or denominator is None:
        return None
    return Ratio(
        Kind.TRANSMISSIBILITY, numerator[1] / denominator[1], denominator[0] - numerator[0]
    )


def _find_motion_unit(word: str) -> tuple[int, float] | None:
    """Return the order of the derivative of a motion of this unit, and its factor."""
    for order, dimension in enumerate(_MOTIONS):
        unit = units.find_unit(word, dimension)
        if unit is not None:
            return order, unit.factor
    return None


# Factors beside a unit, as in ``x 1000 N`` or ``10 mN``.


_FACTOR = (
    r"(10\s?(?:\^|\*\*)?\s?[-+]\d{1,2}|10\s?(?:\^|\*\*)\s?\d{1,2}"
    r"|\d{1,9}(?:\.\d{1,9})?(?:[eE][-+]?\d{1,2})?)"
)
_TIMES_SIGN = r"\s{0,3}[*x×·]?\s{0,3}"
_BEFORE = compile_on_use(rf"\A{_TIMES_SIGN}{_FACTOR}{_TIMES_SIGN}([^\d\s].{{0,40}})\Z")
_BEHIND = compile_on_use(rf"\A([^\d\s].{{0,40}}?)\s{{0,3}}[*x×·/]\s{{0,3}}{_FACTOR}\Z")
_POWER = compile_on_use(r"10\s?(?:\^|\*\*)?\s?([-+]?\d{1,2})\Z")
_BEHIND_NAME = compile_on_use(
    rf"\A(.*\S)\s{{0,3}}([*x×·/]\s{{0,3}}{_FACTOR}|(?<=\s)1[eE][-+]?\d{{1,2}})\Z"
)


def split_factor(word: str) -> tuple[float, str] | None:
    """Return the factor and the unit of a word that holds both, None of any other.

    >>> split_factor("10 mN"), split_factor("N x 10^3"), split_factor("x1000 N"), split_factor("mm")
    ((10.0, 'mN'), (1000.0, 'N'), (1000.0, 'N'), None)
    """
    for pattern, number, unit in ((_BEFORE, 1, 2), (_BEHIND, 2, 1)):
        match = pattern.match(word.strip())
        if match and units.find_unit(match[unit].strip()) is not None:
            factor = _parse_factor(match[number])
            return (factor, match[unit].strip()) if factor not in {0.0, 1.0} else None
    return None


def split_factor_off_name(text: str) -> tuple[str, str] | None:
    """Return a heading without the factor behind it, and the factor or None.

    >>> split_factor_off_name("Load [N] x 1000"), split_factor_off_name("Run 2")
    (('Load [N]', 'x 1000'), None)
    """
    match = _BEHIND_NAME.match(text)
    return (match[1], match[2]) if match else None


def _parse_factor(number: str) -> float:
    power = _POWER.match(number) if re.search(r"[-+^*]", number[2:]) else None
    if power and "e" not in number.lower():
        return float(10.0 ** int(power[1]))
    return float(number)


def parse_unit_multiple(word: str, dimension: Dimension) -> Unit | None:
    """Return the unit of a stated multiple, such as ``10mN``; None of any other text.

    >>> parse_unit_multiple("10mN", "force").factor
    0.01
    """
    factor = split_factor(word)
    unit = units.find_unit(factor[1], dimension) if factor else None
    if factor is None or unit is None or unit.offset:
        return None
    return Unit(word, dimension, float(f"{factor[0] * unit.factor:.12g}"))


def format_unit_multiple(unit: Unit, factor: float) -> str:
    """Return the word for a unit times a factor: that of another unit, or with the number.

    >>> newton, millinewton = (units.parse_unit(unit, "force") for unit in ("N", "mN"))
    >>> format_unit_multiple(newton, 1e3), format_unit_multiple(millinewton, 20.0)
    ('kN', '20mN')
    """
    size = factor * unit.factor
    for item in units.TABLE.values():
        if (
            item.dimension == unit.dimension
            and abs(item.factor / size - 1) < 1e-9
            and not item.offset
        ):
            return item.word
    return f"{factor:g}{unit.word}"


# Name and unit in one cell.


_LONGEST_HEADING = 500
"""Characters of a name; longer ones are cut."""
_OF_WHAT = compile_on_use(r"\A(?:[A-Za-z]\(t\)|(?i:tan ?\((?:delta|d|δ)\)))\Z")  # E(t): no tonnes
_IN_BRACKETS = compile_on_use(
    r"[\[(<{]([^\[\](){}<>]*+(?:\([^()]*+\)[^\[\](){}<>]*+){0,2})[\])>}][\s,;:]*+\Z"
)
_PRIMED = compile_on_use(r"[A-Za-z]['\"]{1,2}")
"""A modulus as rheologists write it: its quotes are no quotes."""
_UNIT_FIRST = compile_on_use(r"\A[\[(]([^\[\]()]++)[\])]\s*+([^\[\]()]++)\Z")
_SIGNS = compile_on_use(r"\s*[,/:]\s*|\s+in\s+|[\s_.\-]+")
_PLAIN_TAIL = compile_on_use(r"\A(.*\S)(?:\s+in\s+|\s*,\s+|\s+/\s+)([^\s,:_]+)\Z")


def remove_quotes(text: str) -> str:
    """Return a cell without the quotes around it, or lost at one end.

    >>> remove_quotes('"Force"'), remove_quotes('G"')
    ('Force', 'G"')
    """
    text = text.strip()
    return text if _PRIMED.fullmatch(text) else text.strip("\"'").strip()


def split_unit(name: str) -> tuple[str, str | None]:
    """Return name and unit of a header cell; the unit is None if there is none.

    >>> split_unit("Force (N)"), split_unit("Load__kN_"), split_unit("Kraft_N"), split_unit("time")
    (('Force', 'N'), ('Load', 'kN'), ('Kraft', 'N'), ('time', None))
    """
    raised = name[:_LONGEST_HEADING].replace("⁻", "^-").replace("^-²", "^-2").replace("²", "^2")
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
    """Return a unit multiplied by the factor in a name such as ``Load x 10^3``."""
    factor = split_factor_off_name(name[:_LONGEST_HEADING].strip()) if unit else None
    return f"{factor[1]} {unit}" if factor else unit


def _split_factored_unit(text: str) -> tuple[str, str] | None:
    """``Load [N] x 1000``, whose unit then holds the factor, too."""
    names = split_factor_off_name(text)
    if names is None or names[0][-1] not in "])":
        return None
    name, unit = split_unit(names[0])
    return (name, f"{names[1]} {unit}") if unit else None


def _unit_before(text: str) -> tuple[str, str] | None:
    match = _UNIT_FIRST.match(text)
    is_unit = match is not None and units.find_unit(match[1])
    return (match[2].strip(), match[1].strip()) if match and is_unit else None


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


def split_heading(name: str, word: str | None) -> tuple[str, str | None]:
    """Return the name and the unit of a column; the name may contain a unit.

    Two different units become an unknown word, so that the user is asked.

    >>> split_heading("Force_N", None), split_heading("Force [N]", "N"), split_heading("F_N", "daN")
    (('Force', 'N'), ('Force', 'N'), ('F', 'N or daN'))
    """
    stem, inner = split_unit(name)
    if word is None or not word.strip(" -[]()<>{}"):
        return stem, inner
    unit = strip_brackets(word)
    if inner is None or units.is_same_unit(inner, unit):
        return name if inner is None else stem, unit
    shared = set(units.dimensions(inner)) & set(units.dimensions(unit))
    if units.find_unit(unit) is not None and (shared or is_unit_of(stem, inner)):
        return stem, join_units(inner, unit)
    return name, unit


def join_units(first: str, second: str) -> str:
    """Return two units of one column as an unknown word, so that the user is asked."""
    return f"{first} or {second}"


def strip_brackets(word: str) -> str:
    """Return a unit without the brackets around it, or lost at one end; (m/s^2)/N keeps its own."""
    stripped = word.strip().strip("\"'").strip()
    inner = stripped.lstrip("[({<").rstrip("])}>").strip()
    if inner.count("(") == inner.count(")"):
        return inner
    return stripped[1:-1].strip() if stripped[0] in "[{<" and stripped[-1] in "]}>" else stripped


def state_unit(column: Column) -> Column:
    """Return a column with the unit in its name, or both if contradictory."""
    unit = add_factor_to_unit(*split_heading(column.name, column.unit))
    return replace(column, unit=unit) if column.unit or units.find_unit(unit or "") else column


def is_unit_of(stem: str, word: str) -> bool:
    """Return whether a trailing word is the unit of what the stem names: Kraft_N, not Channel_1."""
    if word.isdigit():  # as thousands of channels are counted
        return False
    for role in vocabulary.matches(stem):
        dimension = vocabulary.DIMENSION.get(role)
        if dimension is not None:
            unit = units.find_unit(word, dimension)
            if unit is not None and unit.word != "1":
                return True
    return False
