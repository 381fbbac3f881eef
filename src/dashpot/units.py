"""Unit words at the edges; SI inside."""

from __future__ import annotations

import re
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal, TypeAlias

from dashpot.errors import DataError

Dimension: TypeAlias = Literal[
    "time", "length", "force", "mass", "acceleration", "velocity", "frequency",
    "stiffness", "damping", "temperature", "strain", "stress", "voltage", "torque", "angle",
]  # fmt: skip


@dataclass(frozen=True)
class Unit:
    """A unit word: what it measures and its size in SI, ``si = factor * value + offset``."""

    word: str
    dimension: Dimension
    factor: float
    offset: float = 0.0


_POUND_FORCE = 4.4482216152605
_G = 9.80665


def _table() -> dict[str, Unit]:
    rows: dict[Dimension, dict[str, float]] = {
        "time": {"s": 1.0, "sec": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0, "h": 3600.0},
        "length": {
            "m": 1.0, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "nm": 1e-9, "in": 0.0254, "ft": 0.3048,
        },
        "force": {
            "N": 1.0, "mN": 1e-3, "uN": 1e-6, "nN": 1e-9, "pN": 1e-12, "kN": 1e3, "MN": 1e6,
            "daN": 10.0, "lbf": _POUND_FORCE, "kgf": _G, "gf": _G * 1e-3, "kp": _G,
        },
        "mass": {"kg": 1.0, "g": 1e-3, "mg": 1e-6, "t": 1e3, "lb": 0.45359237},
        "acceleration": {"m/s^2": 1.0, "mm/s^2": 1e-3, "g": _G, "gn": _G},
        "velocity": {"m/s": 1.0, "mm/s": 1e-3, "mm/min": 1e-3 / 60},
        "frequency": {"Hz": 1.0, "kHz": 1e3, "mHz": 1e-3},
        "stiffness": {"N/m": 1.0, "N/mm": 1e3, "kN/m": 1e3, "kN/mm": 1e6},
        "damping": {"N*s/m": 1.0, "N*s/mm": 1e3},
        "strain": {"1": 1.0, "%": 1e-2, "mm/mm": 1.0, "m/m": 1.0},
        "stress": {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "psi": 6894.757293168361},
        "voltage": {"V": 1.0, "mV": 1e-3, "uV": 1e-6},
        "torque": {"N*m": 1.0, "N*mm": 1e-3},
        "angle": {"rad": 1.0, "deg": 0.017453292519943295},
    }  # fmt: skip
    units: dict[str, Unit] = {}
    for dimension, words in rows.items():
        for word, factor in words.items():
            # "g" and "mg" are masses or accelerations: the dimension asked for decides
            units[f"{dimension}:{word}"] = Unit(word, dimension, factor)
    units["temperature:K"] = Unit("K", "temperature", 1.0)
    units["temperature:degC"] = Unit("degC", "temperature", 1.0, 273.15)
    units["temperature:degF"] = Unit("degF", "temperature", 5 / 9, 273.15 - 32 * 5 / 9)
    return units


TABLE = MappingProxyType(_table())
"""Every unit word known, keyed ``"dimension:word"``."""

_ALIASES = {
    "seconds": "s", "second": "s", "sek": "s", "secs": "s", "秒": "s", "msec": "ms", "µs": "us",
    "minutes": "min", "hr": "h", "newton": "N", "newtons": "N", "micron": "um", "microns": "um",
    "µm": "um", "µn": "uN", "millimeter": "mm", "millimetre": "mm", "meter": "m", "metre": "m",
    "inch": "in", "lb_f": "lbf", "lbs": "lbf", "毫米": "mm", "牛": "N", "hertz": "Hz",
    "m/s2": "m/s^2", "m/s²": "m/s^2", "m/s**2": "m/s^2", "m s^-2": "m/s^2", "ms^-2": "m/s^2",
    "mm/s2": "mm/s^2", "mm/s²": "mm/s^2", "°c": "degC", "c": "degC", "degc": "degC", "°f": "degF",
    "k": "K", "n.s/m": "N*s/m", "ns/m": "N*s/m", "n·s/m": "N*s/m", "n.s/mm": "N*s/mm",
    "ns/mm": "N*s/mm", "n·s/mm": "N*s/mm", "nm": "N*m", "n·m": "N*m", "n.m": "N*m",
    "nmm": "N*mm", "n·mm": "N*mm", "n-mm": "N*mm", "n-m": "N*m", "-": "1", "percent": "%",
}  # fmt: skip


def find(word: str, dimension: Dimension | None = None) -> Unit | None:
    """Return the unit that `word` names, or None; `dimension` settles ``g`` and ``nm``."""
    text = word.strip().replace("μ", "µ")
    for spelling in (text, text.replace("µ", "u"), _ALIASES.get(text.lower(), "")):
        for unit in TABLE.values():
            if unit.word == spelling and dimension in (None, unit.dimension):
                return unit
    lowered = text.replace("µ", "u").lower()
    # a wrong case is forgiven where only one unit can be meant: "HZ", "n", "Sec", not "MN"
    matches = [
        unit
        for unit in TABLE.values()
        if unit.word.lower() == lowered and dimension in (None, unit.dimension)
    ]
    return matches[0] if len(matches) == 1 else None


def parse_unit(word: str, dimension: Dimension) -> Unit:
    """Return the unit of `dimension` that `word` names.

    Raises
    ------
    DataError
        If the word is unknown or measures something else.
    """
    unit = find(word, dimension)
    if unit is not None:
        return unit
    other = find(word)
    known = ", ".join(entry.word for entry in TABLE.values() if entry.dimension == dimension)
    found = f"is a unit of {other.dimension}" if other else "is not a known unit"
    raise DataError(f"'{word}' {found}; expected a unit of {dimension}, one of: {known}")


def parse_quantity(text: str, dimension: Dimension) -> float:
    """Return the SI value of a quantity such as ``"104g"``, ``"12.71 Hz"`` or ``"8mm"``.

    >>> parse_quantity("104g", "mass")
    0.104

    Raises
    ------
    DataError
        If the number or the unit is missing or unknown.
    """
    match = re.fullmatch(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([^\d\s].*?)?\s*", text)
    if match is None:
        raise DataError(f"'{text}' is not a quantity; expected a number and a unit of {dimension}")
    if match[2] is None:
        known = ", ".join(entry.word for entry in TABLE.values() if entry.dimension == dimension)
        raise DataError(
            f"'{text}' has no unit; add a unit of {dimension} to it, for example '{text.strip()}"
            f"{known.split(', ')[0]}' (known: {known})"
        )
    unit = parse_unit(match[2], dimension)
    value = float(match[1])
    # division keeps 104 g exactly 0.104 kg where the factor is a negative power of ten
    inverse = round(1 / unit.factor)
    scaled = value / inverse if inverse > 1 and 1 / inverse == unit.factor else value * unit.factor
    return scaled + unit.offset


def parse_range(text: str, dimension: Dimension) -> tuple[float, float]:
    """Return the SI ends of a range such as ``"1:50Hz"``; the unit stands once, at the end.

    >>> parse_range("1:50Hz", "frequency")
    (1.0, 50.0)
    """
    low_text, colon, high_text = text.partition(":")
    if not colon:
        raise DataError(f"'{text}' is not a range; expected 'low:high' with a unit of {dimension}")
    high = parse_quantity(high_text, dimension)
    unit_word = re.sub(r"^[\s\d.eE+-]+", "", high_text)
    has_unit = re.search(r"[^\d.eE+\-\s]", low_text) is not None
    low = parse_quantity(low_text if has_unit else low_text + unit_word, dimension)
    if not low < high:
        raise DataError(f"'{text}' is not a range: {low_text} is not below {high_text}")
    return low, high
