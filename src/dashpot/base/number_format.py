"""Numbers as text: significant digits by their uncertainty, in N/mm, mm, Hz and ms."""

from __future__ import annotations

import math
import re

from dashpot.base.lazy import compile_on_use
from dashpot.base.units import convert_to_unit

_PARAMETER = compile_on_use(r"\bk_inf\b|\b(?:ln_)?(?:k|tau|b)_\d+\b|\btau\b|\b[ab]_T\b")
# what a command line or Python alone can heed: (--band), (dashpot identify), (Python: arms=2)
_COMMAND = compile_on_use(r"\s*\((?:--|dashpot |Python:)(?:[^()]|\([^()]*\))*\)")
_POWER = compile_on_use(r"(?<![\w.])[0-9]+(?:\.[0-9]+)?e[+-][0-9]{2,3}\b")
_NEGATIVE = compile_on_use(r"(?<![\w.)-])-(?=[0-9])")
_UNIT = compile_on_use(
    r"(?<=[0-9]) (?=(?:%|dB|[mk]?Hz|k?g|[mµu]?m|m?s|[mk]?N(?:/m?m|/s)?|1/kg|MPa|°C)(?![\w/]))"
)
MINUS = "−"
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
_ASCII = str.maketrans(f"{MINUS}–⁻⁰¹²³⁴⁵⁶⁷⁸⁹µ", "---0123456789u") | {ord("∞"): "inf", ord("·"): " "}


_ROUNDING_RATIO = 1e-6
"""Value over its error below which it is rounding, and 0."""


def round_to_error(value: float, error: float | None = None, *, digits: int = 3) -> str:
    """`value` to two digits of its error, or to `digits` significant ones if that is unknown.

    One far below its error keeps a digit: it is not 0.

    >>> round_to_error(0.1228, 0.0031), round_to_error(396.0, 20000.0)
    ('0.1228', '396')
    """
    if math.isnan(value):
        return "unknown"
    if math.isinf(value):
        return "∞" if value > 0 else f"{MINUS}∞"
    if error is None or not math.isfinite(error) or error <= 0:
        return _format_digits(value, digits)
    decimals = 1 - math.floor(math.log10(error))
    if decimals > 9:
        return _format_digits(value, 10)
    if round(value, decimals) == 0 and abs(value) > _ROUNDING_RATIO * error:
        return _format_digits(value, 1)
    return f"{round(value, decimals):.{max(decimals, 0)}f}".replace("-", MINUS)


def format_with_error(
    value: float, unit: str, error: float | None = None, *, digits: int = 3
) -> str:
    """Return an SI value as :func:`round_to_error` prints it, in a unit of the table.

    >>> format_with_error(0.00830, "mm"), format_with_error(17432.1, "N/mm",
    ...     120.0), format_with_error(0.104, "g", digits=4)
    ('8.30 mm', '17.43 N/mm', '104.0 g')
    """
    reference = None if error is None else convert_to_unit(error, unit)
    return (
        f"{round_to_error(convert_to_unit(value, unit), reference, digits=digits)} "
        f"{unit.replace('*', ' ')}"
    )


def format_cell(value: float | None, unit: str, *, digits: int = 3) -> str:
    """Return a value, SI, in a column of a unit of the table; empty if there is none.

    >>> format_cell(0.0083, "mm"), format_cell(None, "mm"), format_cell(17432.1, "N/mm", digits=4)
    ('8.30', '', '17.43')
    """
    return "" if value is None else round_to_error(convert_to_unit(value, unit), digits=digits)


def ascii_only(text: str) -> str:
    """A number as :func:`round_to_error` prints it in the alphabet that every terminal has."""
    return text.replace("·10", "e").translate(_ASCII)


def _format_digits(value: float, digits: int) -> str:
    if value != 0 and not 1e-4 <= abs(value) < 10 ** max(digits, 6):
        mantissa, _, power = f"{value:.{digits - 1}e}".partition("e")
        raised = str(int(power)).translate(SUPERSCRIPTS)
        return f"{mantissa}·10{raised}".replace("-", MINUS)
    if value == 0:
        return "0"
    # the exponent after rounding: 0.9996 is 1.00, not 1.000
    exponent = int(f"{value:.{digits - 1}e}".partition("e")[2])
    decimals = max(digits - 1 - exponent, 0)
    return f"{value:.{decimals}f}".replace("-", MINUS)


def with_error(value: float, error: float) -> str:
    """Value ± standard error, each to two digits of the error; alone where that is nan."""
    if math.isnan(error):
        return round_to_error(value, digits=4)
    if math.isinf(error):
        return f"{round_to_error(value)}, not identified"
    if error <= 0:
        return f"{round_to_error(value)}, held"
    return f"{round_to_error(value, error)} ± {round_to_error(error, error)}"


def interval(low: float, high: float) -> str:
    """Both ends of an interval to two digits of its half width; an open end is marked as open."""
    if math.isinf(low) and math.isinf(high):
        return "not bounded"
    if math.isinf(high):
        return f"above {round_to_error(low)}"
    if math.isinf(low):
        return f"below {round_to_error(high)}"
    half_width = (high - low) / 4
    return f"{round_to_error(low, half_width)} to {round_to_error(high, half_width)}"


def format_interval(value: float, low: float, high: float, error: float) -> str:
    """Return the interval of a value; an end more than a factor of ten away from one >= 0 is open.

    With both ends open the value is not identified.
    """
    if value < 0:
        return " to ".join(round_to_error(end, error or None, digits=2) for end in (low, high))
    far_below, far_above = low < value / 10 or value == 0, high > 10 * value > 0
    if far_below and far_above:
        return "not identified"
    error_for_rounding = error if 0 < error < value else None
    end_texts = [round_to_error(end, error_for_rounding, digits=2) for end in (low, high)]
    if far_above:
        return f"above {end_texts[0]}"
    return f"below {end_texts[1]}" if far_below else f"{end_texts[0]} to {end_texts[1]}"


def percent(ratio: float, *, digits: int = 2) -> str:
    """Return a relative difference with its sign, in per cent."""
    if not math.isfinite(ratio):
        return "unknown"
    value = 100 * ratio
    if abs(value) < 0.005:
        return "0.00 %"
    text = _format_digits(abs(value), digits)
    return f"{MINUS if value < 0 else '+'}{text} %"


def format_signed_difference(value: float | None, *, digits: int = 2) -> str:
    """Return a difference with its sign; a dash where none is known."""
    if value is None or not math.isfinite(value):
        return "–"
    return f"{MINUS if value < 0 else '+'}{_format_digits(abs(value), digits)}"


def decibels(value: float) -> str:
    """Return a level difference with its sign."""
    text = f"{abs(value):.1f} dB"
    return text if text == "0.0 dB" else f"{MINUS if value < 0 else '+'}{text}"


def hertz(band: tuple[float, float]) -> str:
    """Return a band of frequencies; one without width holds none.

    >>> hertz((0.5, 20.0)), hertz((3.0, 3.0))
    ('0.5 to 20 Hz', 'none')
    """
    if not band[0] < band[1]:
        return "none"
    low, high = (round_to_error(end, digits=2) for end in band)
    return f"{_drop_trailing_zeros(low)} to {_drop_trailing_zeros(high)} Hz"


def format_band(band: tuple[float, float]) -> str:
    """Return a frequency band as text for a sentence.

    >>> format_band((0.5, 20.0)), format_band((3.0, 3.0))
    ('from 0.5 to 20 Hz', 'nowhere')
    """
    return f"from {hertz(band)}" if band[0] < band[1] else "nowhere"


def _drop_trailing_zeros(number: str) -> str:
    """Return a number without the zeros behind its point."""
    return number.rstrip("0").rstrip(".") if "." in number and "·" not in number else number


def duration(seconds: float) -> str:
    """Return a time in ms below one second, else in s."""
    if seconds < 0.9995:
        return format_with_error(seconds, "ms")
    return format_with_error(seconds, "s")


def json_number(value: float) -> float | str:
    """Return a number as JSON may hold it: one that is not finite by its name.

    >>> [json_number(float(word)) for word in ("1.5", "inf", "-inf", "nan")]
    [1.5, 'Infinity', '-Infinity', 'NaN']
    """
    if math.isfinite(value):
        return value
    return "NaN" if math.isnan(value) else "Infinity" if value > 0 else "-Infinity"


def format_count(number: int, noun: str) -> str:
    """Return a count with its noun, for a sentence.

    >>> format_count(1, "arm"), format_count(4, "Maxwell arm"), format_count(9, "arm")
    ('one arm', 'four Maxwell arms', '9 arms')
    """
    words = ("no", "one", "two", "three", "four", "five", "six")
    return f"{words[number] if number < len(words) else number} {noun}{'' if number == 1 else 's'}"


def seals(number: float) -> str:
    """Return the number of seals as text.

    >>> seals(2.0), seals(1), seals(1.5)
    ('2 seals', '1 seal', '1.5 seals')
    """
    return f"{number:g} seal{'' if number == 1 else 's'}"


def symbol(name: str) -> str:
    """Return a parameter's name as it is printed: ``"k_inf"`` is k∞, ``"ln_tau_2"`` is ln τ₂."""
    text = (
        name.replace("k_inf", "k∞").replace("tau", "τ").replace("alpha", "α").replace("ln_", "ln ")
    )
    text = text.replace("_T", "(T)")
    head, _, number = text.rpartition("_")
    return head + number.translate(SUBSCRIPTS) if head and number.isdigit() else text


def split_identifier(name: str) -> str:
    """Return a check's or a step's identifier as words."""
    return name.replace("k_inf", "k∞").replace("tau", "τ").replace("_", " ")


def expand_powers(sentence: str) -> str:
    """Return a sentence with the powers of ten that people do not write spelled out.

    >>> expand_powers("leaves 1.3e+02 times the scatter, 2e-14 m")
    'leaves 130 times the scatter, 2e-14 m'
    """

    def expand_match(match: re.Match[str]) -> str:
        value = float(match[0])
        return _format_match(match) if value == 0 or 1e-4 <= abs(value) < 1e6 else match[0]

    return _POWER.sub(expand_match, sentence)


def _format_match(match: re.Match[str]) -> str:
    digits = sum(letter.isdigit() for letter in match[0].partition("e")[0])
    return _format_digits(float(match[0]), digits)


def format_typographic(sentence: str) -> str:
    r"""A sentence as a page prints it: k∞ for k_inf, τ₁ for tau_1, ±, °C, a minus for a hyphen.

    Hints in brackets for the command line or Python are omitted: a page has neither. A number and
    its unit stay on one line.

    >>> format_typographic("the shift to 0 degC")
    'the shift to 0\xa0°C'
    >>> format_typographic("k_inf moves by -2.5e-09 +- 3e-10 m; widen the band (--band), or wait")
    'k∞ moves by −2.5·10⁻⁹ ± 3·10⁻¹⁰ m; widen the band, or wait'
    """
    typeset = _PARAMETER.sub(lambda match: symbol(match[0]), _COMMAND.sub("", sentence))
    typeset = re.sub(r"(?<=[0-9] )um\b", "µm", typeset)
    typeset = typeset.replace("+-", "±").replace(" degC", " °C")
    typeset = _NEGATIVE.sub(MINUS, _POWER.sub(_format_match, typeset))
    return _UNIT.sub("\N{NO-BREAK SPACE}", typeset)


def shorten_number(text: str) -> str:
    """Return a number given in full precision as six digits; anything else as it is."""
    try:
        return f"{float(text):.6g}" if len(text) > 8 else text
    except ValueError:
        return text
