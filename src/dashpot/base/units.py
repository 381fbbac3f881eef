"""Units of quantities as text, and their conversion to SI."""

from __future__ import annotations

import math
import re
from functools import lru_cache
from numbers import Real
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, overload

from dashpot.base import dataclass, fields, replace
from dashpot.base.errors import DataError

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    FloatArray: TypeAlias = npt.NDArray[np.float64]

Quantity: TypeAlias = float | str
"""A number in SI units, or one with its unit: ``0.104`` or ``"104g"``."""

Range: TypeAlias = tuple[Quantity, Quantity] | str
"""Two of them, or both with one unit: ``"5:40Hz"``."""

Dimension: TypeAlias = Literal[
    "time", "length", "force", "mass", "acceleration", "velocity", "frequency",
    "stiffness", "damping", "temperature", "strain", "stress", "voltage", "torque", "angle",
    "compliance", "force rate", "material compliance", "moment of inertia",
    "area", "volume", "viscosity", "energy", "molar energy",
]  # fmt: skip


@dataclass(frozen=True)
class Unit:
    """Unit: the quantity it measures and its size in SI, ``si = factor * value + offset``."""

    word: str
    dimension: Dimension
    factor: float
    offset: float = 0.0


_POUND_FORCE = 4.4482216152605
GRAVITY = 9.80665
"""Standard gravity, m/s^2."""


_SIZES: dict[Dimension, str] = {
    "time": "s 1, sec 1, ms 1e-3, us 1e-6, ns 1e-9, min 60, h 3600, d 86400, year 31557600",
    "length": "m 1, mm 1e-3, cm 1e-2, um 1e-6, nm 1e-9, in 0.0254, ft 0.3048, mil 2.54e-5, "
    "thou 2.54e-5, yd 0.9144, dm 0.1",
    "force": "N 1, mN 1e-3, uN 1e-6, nN 1e-9, pN 1e-12, kN 1e3, MN 1e6, cN 1e-2, daN 10, "
    f"lbf {_POUND_FORCE}, kgf {GRAVITY}, gf {GRAVITY * 1e-3}, kp {GRAVITY}, "
    f"ozf {_POUND_FORCE / 16}, dyn 1e-5, kip {1e3 * _POUND_FORCE}, tf {1e3 * GRAVITY}",
    "mass": f"kg 1, g 1e-3, mg 1e-6, t 1e3, lb 0.45359237, lbf*s^2/in {_POUND_FORCE / 0.0254}",
    "acceleration": f"m/s^2 1, mm/s^2 1e-3, g {GRAVITY}, gn {GRAVITY}, cm/s^2 1e-2, Gal 1e-2, "
    "ft/s^2 0.3048, in/s^2 0.0254",
    "velocity": f"m/s 1, mm/s 1e-3, mm/min {1e-3 / 60}, um/s 1e-6, cm/s 1e-2, in/s 0.0254, "
    f"ft/s 0.3048, in/min {0.0254 / 60}, km/h {1 / 3.6}",
    "frequency": f"Hz 1, kHz 1e3, mHz 1e-3, rad/s {0.5 / math.pi}, 1/min {1 / 60}",
    "stiffness": "N/m 1, N/mm 1e3, kN/m 1e3, kN/mm 1e6, N/um 1e6, MN/m 1e6, mN/mm 1, N/cm 100, "
    f"lbf/in {_POUND_FORCE / 0.0254}",
    "damping": "N*s/m 1, N*s/mm 1e3",
    "compliance": "um/N 1e-6, m/N 1, mm/N 1e-3, nm/N 1e-9, mm/kN 1e-6, um/kN 1e-9",
    "material compliance": "1/Pa 1, 1/kPa 1e-3, 1/MPa 1e-6, 1/GPa 1e-9",
    "force rate": f"mN/s 1e-3, N/s 1, uN/s 1e-6, N/min {1 / 60}, mN/min {1e-3 / 60}, "
    f"N/h {1 / 3600}, mN/h {1e-3 / 3600}",
    "strain": "1 1, % 1e-2, mm/mm 1, m/m 1, um/m 1e-6",
    "stress": f"Pa 1, kPa 1e3, MPa 1e6, GPa 1e9, psi 6894.757293168361, ksi {6894757.293168361}, "
    "bar 1e5, mbar 100, hPa 100, kgf/cm^2 98066.5, dyn/cm^2 0.1",
    "voltage": "V 1, mV 1e-3, uV 1e-6",
    "torque": "N*m 1, N*mm 1e-3, mN*m 1e-3, uN*m 1e-6",
    "angle": "rad 1, deg 0.017453292519943295, mrad 1e-3",
    "area": "m^2 1, cm^2 1e-4, mm^2 1e-6",
    "volume": "m^3 1, dm^3 1e-3, cm^3 1e-6, mm^3 1e-9",
    "moment of inertia": "kg*m^2 1, kg*mm^2 1e-6, t*mm^2 1e-3, g*mm^2 1e-9",
    "viscosity": "Pa*s 1, MPa*s 1e6",
    "energy": "J 1, mJ 1e-3",
    "molar energy": "J/mol 1, kJ/mol 1e3",
}
"""Unit words of each dimension with their size in SI."""


def _table() -> dict[str, Unit]:
    units: dict[str, Unit] = {}
    for dimension, text in _SIZES.items():
        for word, size in map(str.split, text.split(", ")):
            # "g" and "mg" are masses or accelerations: the dimension asked for decides
            units[f"{dimension}:{word}"] = Unit(word, dimension, float(size))
    units["temperature:K"] = Unit("K", "temperature", 1.0)
    units["temperature:degC"] = Unit("degC", "temperature", 1.0, 273.15)
    units["temperature:degF"] = Unit("degF", "temperature", 5 / 9, 273.15 - 32 * 5 / 9)
    return units


MIN_SI_VALUE, MAX_SI_VALUE = 1e-15, 1e15
"""Smallest and largest quantity that a user can mean, in SI units, if it is not 0."""

TABLE = MappingProxyType(_table())
"""Every unit word known, keyed ``"dimension:word"``."""

_SPELLINGS = {
    "s": "seconds second secs sek sekunde sekunden sekund sekundy seconde secondes segundo "
    "segundos secondo secondi saniye sn с сек 秒 초",
    "ms": "msec msecs millisecond milliseconds millisekunden мс 毫秒 ミリ秒",
    "ns": "nsec nanosecond nanoseconds",
    "us": "µs µsec usec microsecond microseconds мкс 微秒",
    "min": "minute minutes minuten minuty dakika dk мин 分 分钟",
    "h": "hr hrs hour hours stunde stunden std godz 小时 時間",
    "d": "day days tag tage dni jour jours 天 日",
    "year": "years yr yrs",
    "m": "meter metre meters metres м 米",
    "mm": "millimeter millimetre millimeters millimetres milimetr milimetry мм 毫米 ミリ",
    "cm": "centimeter centimetre centimeters centimetres см 厘米",
    "um": "µm micron microns micrometer micrometre micrometers micrometres мкм 微米",
    "in": "inch inches zoll \" ''",
    "ft": "foot feet",
    "N": "newton newtons niuton niutony н 牛 牛顿 ニュートン",
    "mN": "millinewton millinewtons мн 毫牛",
    "uN": "µn",
    "kN": "kilonewton kilonewtons кн 千牛",
    "daN": "dan decanewton",
    "lbf": "lb_f lbsf lb-f poundforce pound-force lb.f",
    "kgf": "kg_f kg-f kilopond 公斤力 кгс",
    "gf": "g_f gramforce gram-force pond ponds",
    "dyn": "dyne dynes",
    "tf": "tonf ton-force",
    "mil": "mils",
    "thou": "thous",
    "Gal": "gals",
    "cm/s^2": "cm/s2 cm/s² cm/s**2",
    "ft/s^2": "ft/s2 ft/s² ft/s**2 ft/sec^2 ft/sec2",
    "in/s^2": "in/s2 in/s² in/s**2 in/sec^2 in/sec2",
    "in/s": "in/sec ips",
    "ft/s": "ft/sec fps",
    "um/s": "µm/s",
    "N/um": "n/µm",
    "lbf/in": "lb/in lbs/in",
    "um/m": "µm/m microstrain ustrain µstrain µε ue",
    "bar": "bars",
    "kgf/cm^2": "kgf/cm2 kgf/cm² kg/cm2 kg/cm²",
    "dyn/cm^2": "dyn/cm2 dyn/cm² dyne/cm2 dyne/cm² dyne/cm^2 dynes/cm^2 dynes/cm2",
    "mrad": "milliradian milliradians",
    "ozf": "oz_f oz-f ounceforce ounce-force",
    "lb": "lbs pound pounds",
    "kg": "kilogram kilograms кг 千克 公斤",
    "g": "gram grams",
    "t": "tonne tonnes",
    "gn": "g0 g's gs g_n grav",
    "m/s^2": "m/s2 m/s² m/s**2 m/s/s m/(s^2) m/(s²) m/(s*s) m*s^-2 m·s^-2 m.s-2 m.s^-2 ms^-2 ms-2 "
    "m/sec^2 m/sec2 m/sec² м/с² м/с2 м/с^2 米/秒²",
    "mm/s^2": "mm/s2 mm/s² mm/s**2 mm/sec^2",
    "m/s": "m/sec m.s-1 м/с",
    "mm/s": "mm/sec мм/с",
    "Hz": "hertz гц 赫兹 1/s s^-1 cps",
    "kHz": "kilohertz",
    "rad/s": "rad/sec rad.s-1 rad*s^-1 rad·s^-1 rad.s^-1 rad_s^-1",
    "1/min": "min^-1 rpm cpm u/min",
    "N/m": "n/meter",
    "N*s/m": "n/(m/s) n.s/m ns/m n·s/m n-s/m n*s*m^-1 n_s/m",
    "N*s/mm": "n.s/mm ns/mm n·s/mm n-s/mm n_s/mm",
    "Pa*s": "pa_s",
    "um/N": "µm/n",
    "um/kN": "µm/kn",
    "uN/s": "µn/s",
    "1": "- [-] none dimensionless unitless abs.",
    "%": "percent prozent pct",
    "mm/mm": "in/in",
    "Pa": "pascal n/m^2 n/m2 n/m² n·m^-2 n*m^-2 n.m^-2 па 帕",
    "kPa": "kilopascal кпа 千帕",
    "MPa": "megapascal n/mm^2 n/mm2 n/mm² n·mm^-2 n*mm^-2 n.mm^-2 мпа 兆帕",
    "GPa": "gigapascal гпа",
    "1/Pa": "pa^-1 pa-1 pa⁻¹ m^2/n m2/n m²/n",
    "1/kPa": "kpa^-1 kpa-1 kpa⁻¹",
    "1/MPa": "mpa^-1 mpa-1 mpa⁻¹ mm^2/n mm2/n mm²/n",
    "1/GPa": "gpa^-1 gpa-1 gpa⁻¹",
    "V": "volt volts в 伏",
    "mV": "millivolt millivolts",
    "uV": "µv",
    "N*m": "nm n·m n.m n-m",
    "mN*m": "mnm mn·m mn.m mn-m",
    "uN*m": "µnm µn·m µn.m µn-m",
    "N*mm": "nmm n·mm n.mm n-mm",
    "kg*m^2": "kg*m2 kg*m² kgm2 kgm^2 kgm² kg·m² kg·m^2 kg.m2 kg.m^2",
    "kg*mm^2": "kg*mm2 kg*mm² kgmm2 kgmm^2 kgmm² kg·mm² kg.mm2 kg.mm^2",
    "t*mm^2": "t*mm2 t*mm² t.mm2 t.mm^2",
    "g*mm^2": "g*mm2 g*mm² g.mm2 g.mm^2",
    "deg": "° degree degrees grad grad_ °(deg)",
    "rad": "radian radians",
    "degC": "°c c ℃ deg_c degc celsius grad_c градус °с",
    "degF": "°f ℉ fahrenheit",
    "K": "kelvin",
}
_ALIASES = {
    spelling: word for word, spellings in _SPELLINGS.items() for spelling in spellings.split()
}
_WORDS: dict[str, list[Unit]] = {}
_FOLDED_SPELLINGS: dict[str, list[Unit]] = {}
for _unit in TABLE.values():
    _WORDS.setdefault(_unit.word, []).append(_unit)
    _FOLDED_SPELLINGS.setdefault(_unit.word.lower(), []).append(_unit)


@lru_cache(maxsize=1024)
def find_unit(word: str, dimension: Dimension | None = None) -> Unit | None:
    """Return the unit that `word` names, or None; `dimension` settles ``g`` and ``nm``.

    >>> find_unit("µm"), find_unit("Newtons").word, find_unit("furlong")
    (Unit(word='um', dimension='length', factor=1e-06, offset=0.0), 'N', None)
    """
    text = " ".join(word.replace("μ", "µ").split())
    lower_case = text.lower()
    spellings = (
        text,
        text.replace("µ", "u"),
        _ALIASES.get(lower_case, ""),
        _ALIASES.get(lower_case.replace(" ", ""), ""),
        _ALIASES.get(lower_case.replace(" ", "_"), ""),
        text.rstrip("."),
        _ALIASES.get(lower_case.rstrip("."), ""),
    )
    for spelling in spellings:
        for unit in _WORDS.get(spelling, ()):
            if dimension in (None, unit.dimension):
                return unit
    # a wrong case is forgiven where only one unit can be meant: "HZ", "n", "Sec", not "MN"
    ascii_text = text.replace("µ", "u").lower().rstrip(".")
    matches = [u for u in _FOLDED_SPELLINGS.get(ascii_text, ()) if dimension in (None, u.dimension)]
    return matches[0] if len(matches) == 1 else None


def is_same_unit(first: str, second: str) -> bool:
    """Return whether two words are one unit, however spelled.

    >>> is_same_unit("sec", "Sekunden"), is_same_unit("N", "kN"), is_same_unit("Pa.s", "pa.s")
    (True, False, True)
    """
    unit, other = find_unit(first), find_unit(second)
    if unit is None or other is None:
        return first.casefold().split() == second.casefold().split()
    return (unit.dimension, unit.factor, unit.offset) == (
        other.dimension,
        other.factor,
        other.offset,
    )


def dimensions(word: str) -> tuple[Dimension, ...]:
    """Return every dimension that a unit word can measure: ``g`` is a mass or an acceleration.

    >>> dimensions("g")
    ('mass', 'acceleration')
    """
    entries = dict.fromkeys(unit.dimension for unit in TABLE.values())
    return tuple(dimension for dimension in entries if find_unit(word, dimension) is not None)


def parse_unit(word: str, dimension: Dimension) -> Unit:
    """Return the unit of `dimension` that `word` names.

    Raises
    ------
    DataError
        If the word is unknown or measures something else.
    """
    unit = find_unit(word, dimension)
    if unit is not None:
        return unit
    other = " or ".join(dimensions(word))
    text = ", ".join(unit.word for unit in _filter_units(dimension))
    name = f"is a unit of {other}" if other else "is not a known unit"
    raise DataError(f"'{word}' {name}; expected a unit of {dimension}, one of: {text}")


def si_unit(dimension: Dimension) -> Unit:
    """Return the SI unit of a dimension.

    >>> si_unit("stress").word, si_unit("compliance").word
    ('Pa', 'm/N')
    """
    return next(unit for unit in _filter_units(dimension) if (unit.factor, unit.offset) == (1, 0))


def _filter_units(dimension: Dimension) -> list[Unit]:
    return [unit for unit in TABLE.values() if unit.dimension == dimension]


_DEFAULT_UNITS: dict[Dimension, str] = {
    "mass": "g", "length": "mm", "temperature": "degC", "stiffness": "N/mm", "stress": "MPa",
    "compliance": "um/N",
}  # fmt: skip
"""The unit of a form and of an example, where that is not the first unit of the table."""

_DISPLAY_UNITS = MappingProxyType({
    "m": "mm", "kg": "g", "N/m": "N/mm", "N*s/m": "N*s/mm", "Pa": "MPa", "Pa*s": "MPa*s",
    "m/N": "mm/N", "1/Pa": "1/MPa", "J": "mJ", "J/mol": "kJ/mol", "m/s": "mm/s", "m^2": "mm^2",
    "strain": "% strain",
})  # fmt: skip
"""The customary unit of values in an SI unit, if different."""


_SMALLER_UNITS = MappingProxyType({"N": "mN", "N/s": "mN/s", "s": "ms"})
"""Display units of small quantities: a tare, a drift, a delay."""


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
        if dimension != "temperature" and not float(match[1]):
            return 0.0  # nothing is nothing in any unit
        names = [unit.word for unit in _filter_units(dimension)]
        raise DataError(
            f"'{text}' has no unit; add a unit of {dimension} to it, for example '{text.strip()}"
            f"{_DEFAULT_UNITS.get(dimension, names[names[0] == '1'])}' (known: {', '.join(names)})"
        )
    if "," in match[2][1:]:
        raise DataError(
            f"'{text}' holds several numbers; expected one number and a unit of {dimension}, "
            "without commas. Give each value by itself"
        )
    if re.match(r",\d", match[2]):
        plain_text = text.strip().replace(",", "")
        grouped = (
            f", or '{plain_text}' if that is meant" if re.match(r",\d{3}(?!\d)", match[2]) else ""
        )
        pointed = text.strip().replace(",", ".", 1)
        raise DataError(f"'{text}' has a decimal comma; write '{pointed}' with a point{grouped}")
    unit = parse_unit(match[2], dimension)
    scaled = from_unit(float(match[1]), replace(unit, offset=0.0))
    if (
        re.search("[1-9]", match[1].lower().partition("e")[0])
        and not MIN_SI_VALUE <= abs(scaled) <= MAX_SI_VALUE
    ):
        raise DataError(
            f"'{text}' is {scaled:.3g} in SI units; expected 0 or a magnitude from "
            f"{MIN_SI_VALUE:g} to "
            f"{MAX_SI_VALUE:g}: check the number and its unit"
        )
    return scaled + unit.offset


@overload
def from_unit(value: float, unit: Unit) -> float: ...
@overload
def from_unit(value: FloatArray, unit: Unit) -> FloatArray: ...
def from_unit(value: float | FloatArray, unit: Unit) -> float | FloatArray:
    """Return a value of a unit, or an array of them, in SI."""
    # division keeps 104 g exactly 0.104 kg where the factor is a negative power of ten
    inverse = round(1 / unit.factor)
    scaled = value / inverse if inverse > 1 and 1 / inverse == unit.factor else value * unit.factor
    return scaled + unit.offset if unit.offset else scaled


def get_default_unit(dimension: Dimension) -> str:
    """Return the default unit of a dimension.

    >>> get_default_unit("length"), get_default_unit("time")
    ('mm', 's')
    """
    return _DEFAULT_UNITS.get(dimension, _filter_units(dimension)[0].word)


def get_display_unit(unit: str, *, prefers_small: bool = False) -> str:
    """Return the unit in which people read an SI unit, a smaller one if `prefers_small`.

    >>> get_display_unit("N/m"), get_display_unit("N s/m"), get_display_unit(
    ...     "Hz"), get_display_unit(""), get_display_unit("s", prefers_small=True)
    ('N/mm', 'N*s/mm', 'Hz', '', 'ms')
    >>> get_display_unit("N/m per 100 mm")
    'N/mm per 100 mm'
    """
    word, per, divisor = unit.partition(" per ")
    resolved_unit = find_unit(word)
    unit_word = word if resolved_unit is None else resolved_unit.word
    display_unit = _DISPLAY_UNITS.get(unit_word, word)
    return (
        (_SMALLER_UNITS.get(unit_word, display_unit) if prefers_small else display_unit)
        + per
        + divisor
    )


def column(name: str, unit: str) -> str:
    """Return the column of a table in SI units: its name ends in the unit.

    >>> column("k_inf", "N/m"), column("tau_1", "s"), column("alpha", "")
    ('k_inf_N_per_m', 'tau_1_s', 'alpha')
    """
    return f"{name}_{unit.replace('/', '_per_')}" if unit else name


@overload
def convert_to_unit(value: float, unit: str) -> float: ...
@overload
def convert_to_unit(value: FloatArray, unit: str) -> FloatArray: ...
def convert_to_unit(value: float | FloatArray, unit: str) -> float | FloatArray:
    """Return an SI value, or an array of them, in a unit of the table.

    >>> convert_to_unit(0.0083, "mm"), convert_to_unit(17400.0, "N/mm"), convert_to_unit(300.15,
    ...     "degC")
    (8.3, 17.4, 27.0)

    Raises
    ------
    DataError
        If the unit is not in the table.
    """
    resolved_unit = find_unit(re.split(" per | strain", unit)[0])
    if resolved_unit is None:
        raise DataError(f"'{unit}' is not a known unit")
    if resolved_unit.offset:
        return (value - resolved_unit.offset) / resolved_unit.factor
    # by the whole number that the inverse of a negative power of ten is: 1e3 * x, not x / 1e-3
    inverse = round(1 / resolved_unit.factor)
    return (
        inverse * value
        if inverse > 1 and 1 / inverse == resolved_unit.factor
        else value / resolved_unit.factor
    )


def format_quantity(value: float, unit: str, form: str = ".4g") -> str:
    """Return an SI value as text for a sentence: in a unit of the table, with its word.

    >>> format_quantity(0.0083, "mm"), format_quantity(17432.1, "N/mm", ".3g"), format_quantity(
    ...     2.5e-3, "ms")
    ('8.3 mm', '17.4 N/mm', '2.5 ms')
    """
    return f"{convert_to_unit(value, unit):{form}} {unit.replace('*', ' ')}"


def celsius(temperature: float) -> str:
    """Return a temperature, K, as text for a sentence."""
    return format_quantity(temperature, "degC")


@overload
def convert_to_si(value: Quantity, dimension: Dimension) -> float: ...
@overload
def convert_to_si(value: Quantity | None, dimension: Dimension) -> float | None: ...
def convert_to_si(value: Quantity | None, dimension: Dimension) -> float | None:
    """Return a quantity in SI units; numbers are taken as SI, None stays None.

    >>> convert_to_si("104g", "mass"), convert_to_si(0.104, "mass"), convert_to_si(None, "mass")
    (0.104, 0.104, None)

    Raises
    ------
    DataError
        If the value is neither a number nor a text that states a quantity of that dimension.
    """
    if isinstance(value, str):
        return parse_quantity(value, dimension)
    if value is not None and getattr(value, "ndim", not isinstance(value, Real)):
        raise DataError(
            f"{value!r} is no quantity; expected a number in SI units, or a text with a unit of "
            f"{dimension}"
        )
    # a fraction or a scalar of NumPy is a number as well
    return value if value is None or type(value) in {int, float} else float(value)


def si_fields(result: Any) -> None:
    """Convert fields of a frozen dataclass to SI that state their unit and hold a text.

    Raises
    ------
    DataError
        If a text is no quantity, or a value lies outside the ``size`` that its field states.
    """
    for field in fields(result):
        if "unit" not in field.metadata:
            continue
        value, dimension = getattr(result, field.name), field.metadata["unit"]
        several = value if isinstance(value, tuple | list) else (value,)
        converted = tuple(convert_to_si(item, dimension) for item in several)
        size: Any = field.metadata.get("size")
        for item in () if size is None else converted:
            size.refuse(item or 0.0, remedy=f"Check the unit of {field.name}.")
        object.__setattr__(result, field.name, converted if several is value else converted[0])


@overload
def si_range(value: Range, dimension: Dimension) -> tuple[float, float]: ...
@overload
def si_range(value: Range | None, dimension: Dimension) -> tuple[float, float] | None: ...
def si_range(value: Range | None, dimension: Dimension) -> tuple[float, float] | None:
    """Return both ends of a range in SI units.

    >>> si_range("5:40Hz", "frequency"), si_range(("8mm", 0.01), "length")
    ((5.0, 40.0), (0.008, 0.01))

    Raises
    ------
    DataError
        If a text is no quantity, or no range, of that dimension.
    """
    if value is None:
        return None
    if isinstance(value, str):
        return parse_range(value, dimension)
    if not hasattr(value, "__len__") or len(value) != 2:
        raise DataError(
            f"{value!r} is no range; expected (low, high) in SI units, or a text 'low:high' with "
            f"a unit of {dimension}"
        )
    low, high = value
    return convert_to_si(low, dimension), convert_to_si(high, dimension)


def parse_range(text: str, dimension: Dimension) -> tuple[float, float]:
    """Return the SI ends of a range such as ``"1:50Hz"``; the unit is written once, at the end.

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
    if low < 0:
        raise DataError(f"'{text}' begins below 0; expected 0 <= low < high")
    if not low < high:
        raise DataError(f"'{text}' is not a range: {low_text} is not below {high_text}")
    return low, high
