"""What the unit of a frequency response says: motion over force or over motion, and its size."""

from __future__ import annotations

import re
from typing import NamedTuple

from dashpot.base import units
from dashpot.base.units import Dimension
from dashpot.datamodel.frf import Kind

_BARE = {"": 1.0, "1": 1.0, "-": 1.0, "db": 1.0, "%": 0.01}
"""Units of a ratio; they tell a transmissibility where a name or a comment does."""
_KINDS: tuple[tuple[Dimension, Dimension, Kind], ...] = (
    ("length", "force", Kind.RECEPTANCE),
    ("velocity", "force", Kind.MOBILITY),
    ("acceleration", "force", Kind.ACCELERANCE),
    ("force", "length", Kind.DYNAMIC_STIFFNESS),
)
_MOTIONS: tuple[Dimension, ...] = ("length", "velocity", "acceleration")
"""Each the derivative of the one before."""


_LONGEST = 60
"""Letters of a unit."""


class Ratio(NamedTuple):
    """What a response relates, its factor to SI, and how often it is yet to be differentiated.

    A motion over another is a transmissibility times s to a power: ``mm/g`` wants s^2.
    """

    kind: Kind
    factor: float
    order: int = 0


_SPECIAL = {
    "1/kg": Ratio(Kind.ACCELERANCE, 1.0),
    "m/(N*s)": Ratio(Kind.MOBILITY, 1.0),
    "m/(N·s)": Ratio(Kind.MOBILITY, 1.0),
    **dict.fromkeys(("s^2", "s²", "s2", "s**2"), Ratio(Kind.TRANSMISSIBILITY, 1.0, 2)),
}


def ratio(word: str) -> Ratio | None:
    """What a unit such as ``(m/s^2)/N``, ``1/kg``, ``g/g`` or ``mm/(m/s^2)`` says; None if nothing.

    >>> ratio("mm/g").kind.value, ratio("mm/g").order, ratio("furlong/N")
    ('transmissibility', 2, None)
    """
    text = (undecibel(word) or word).replace(" s)", "*s)").strip()
    if text in _SPECIAL:
        return _SPECIAL[text]
    swapped = re.fullmatch(r"\(?1/(\w+)\)?\s*[*·]\s*(.+)", text)  # (1/N)*(m/s^2)
    if swapped:
        return _parse_unit_ratio(swapped[2], swapped[1])
    # each / may be the one between them: (m/s^2)/m/s^2
    cuts = [i for i, letter in enumerate(text[:_LONGEST]) if letter == "/"]
    return next(filter(None, (_parse_unit_ratio(text[:i], text[i + 1 :]) for i in cuts)), None)


def bare_ratio(word: str) -> Ratio | None:
    """A transmissibility, where the unit is that of a number and something else says what of."""
    factor = _BARE.get((undecibel(word) or word).casefold())
    return None if factor is None else Ratio(Kind.TRANSMISSIBILITY, factor)


def undecibel(word: str) -> str | None:
    """What decibels are of, such as g/g in ``dB re 1 g/g``, dB if of nothing; None if no decibels.

    >>> undecibel("dB re 1 g/g"), undecibel("dB"), undecibel("g/g")
    ('g/g', 'dB', None)
    """
    if not word.casefold().startswith("db"):
        return None
    rest = word[2:].strip(" ()[],.:")
    for filler in ("re", "rel", "ref", ".", "1 "):
        if rest.casefold().startswith(filler):
            rest = rest[len(filler) :].strip()
    return rest or "dB"


def _parse_unit_ratio(top: str, bottom: str) -> Ratio | None:
    """What the unit `top` over the unit `bottom` says."""
    top, bottom = top.strip("() "), bottom.strip("() ")
    for upper, lower, kind in _KINDS:
        a, b = units.find_unit(top, upper), units.find_unit(bottom, lower)
        if a is not None and b is not None:
            return Ratio(kind, a.factor / b.factor)
    over, under = _motion(top), _motion(bottom)
    if over is None or under is None:
        return None
    return Ratio(Kind.TRANSMISSIBILITY, over[1] / under[1], under[0] - over[0])


def _motion(word: str) -> tuple[int, float] | None:
    """How often the displacement was differentiated in a motion of this unit, and its factor."""
    for order, dimension in enumerate(_MOTIONS):
        unit = units.find_unit(word, dimension)
        if unit is not None:
            return order, unit.factor
    return None
