"""Scale factors in the attributes of a binary file."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import lru_cache

import numpy as np

from dashpot.base.arrays import FloatArray

_FACTORS = {
    "scale", "scaling", "slope", "gain", "factor", "multiplier", "calibration", "sensitivity",
    "amplification", "attenuation", "conversion", "coefficient", "coefficients", "faktor",
    "skalierung", "verstärkung", "empfindlichkeit", "kalibrierfaktor", "skalierungsfaktor", "cal",
    "coeff", "coeffs", "coef", "multiplication", "calib", "polynomial", "poly", "exponent", "ratio",
    "divisor", "divider", "attenuator", "attn", "eichfaktor", "übersetzung", "teiler", "calfac",
    "scl", "resolution", "lsb", "per", "power", "multiply", "multiplied", "polarity", "invert",
    "inverted", "sign", "vorzeichen", "polarität",
}  # fmt: skip
"""Words of a factor: 1 changes nothing."""
_SIGNS = {"polarity", "invert", "inverted", "sign", "vorzeichen", "polarität"}
"""Words of a factor of -1."""
_SHIFTS = {"offset", "intercept", "bias", "zero", "tare", "nullpunkt"}
"""Words of a summand: 0 changes nothing."""
_MAX_FULL_SCALE_RATIO = 1.5
"""Largest value of a channel over its full scale."""
_UNIT_WORDS = {"n", "v", "mv", "mm", "count", "counts", "volt", "volts", "newton", "unit", "units"}
_LINKS = {
    "of",
    "for",
    "the",
    "linear",
    "sensor",
    "channel",
    "amplifier",
    "amp",
    "bridge",
    "y",
    "add",
}
"""Words beside a factor that name no channel."""
_OF_THE_CLOCK = {"start", "begin", "time", "trigger", "wf", "x"}
"""Words beside which an offset is when a signal begins."""
_ACCOMPANYING_WORDS = {
    "full", "range", "date", "name", "type", "status", "id", "number", "poisson", "second",
    "seconds", "samples", "sample", "rate", "loss", "shape", "form", "safety", "quality", "crest",
    "damping", "noise", "aspect", "compression", "chunk", "fill", "time",
}  # fmt: skip
"""Words beside which no factor of the numbers is meant."""
_INVERSION_WORDS = {
    "inverted",
    "negative",
    "reversed",
    "reverse",
    "invertiert",
    "negativ",
    "-",
    "yes",
    "true",
}
"""Words for a reversed sign of a channel."""
_FILLS = {
    "fillvalue", "fill", "missingvalue", "missing", "nodata", "nodatavalue", "nullvalue", "navalue",
    "nanvalue", "invalidvalue", "errorvalue", "fehlwert", "missingdatavalue",
}  # fmt: skip
"""Names of fill values, without signs."""
_NUMBERS = re.compile(r"[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
_VALID = {
    "validrange": (0, 1), "validlimits": (0, 1), "actualvalidrange": (0, 1),
    "validmin": (0, None), "validminimum": (0, None), "validlow": (0, None),
    "validmax": (None, 0), "validmaximum": (None, 0), "validhigh": (None, 0),
}  # fmt: skip
"""Names of the range outside which there is no number, and which of their numbers are its ends."""
_FULL_SCALE = re.compile(
    r"\A(.*?)[\s_.-]*(?:full[\s_-]?scale(?:[\s_-]?(?:value|range|output))?|messbereich|fsr|fs)"
    r"([\s_.-].*)?\Z",
    re.IGNORECASE,
)
"""Names of a full scale, with the channel."""
_EXPRESSION = re.compile(
    r"=\s*[-+]?\.?\d|\d\s*[*·×]\s*[a-z(]|[a-z)]\s*[*·×]\s*[-+]?\.?\d", re.IGNORECASE
)
"""A formula such as ``y = 10 * x``, in place of a number."""
_WORDS = re.compile(r"[a-zà-ÿ]+")
_STATED = re.compile(
    r"\A\s*[x×*]?\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d{1,3})?)"
    r"(?![-./]\d)\s*([^\d\s].{0,20})?\Z"
)


def words_of_name(name: str) -> list[str]:
    """Return the words of an attribute's name in lower case.

    >>> words_of_name("ForceScale"), words_of_name("cal_factor 2")
    (['force', 'scale'], ['cal', 'factor'])
    """
    return _WORDS.findall(re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name).casefold())


@lru_cache(maxsize=4096)
def names_factor(name: str) -> bool:
    """Return whether a name denotes a factor or an offset of numbers.

    >>> names_factor("gain"), names_factor("full_scale"), names_factor("serial")
    (True, False, False)
    """
    words = set(words_of_name(name))
    words |= {"factor" for word in words if word.endswith(("factor", "faktor"))}
    begins = words & _SHIFTS and words & _OF_THE_CLOCK
    return not words & _ACCOMPANYING_WORDS and not begins and bool(words & (_FACTORS | _SHIFTS))


def stated_unit(value: object) -> str | None:
    """Return the unit behind the number of an attribute that is text, None of any other."""
    text = value.decode("utf-8", "replace") if isinstance(value, bytes) else value
    match = _STATED.match(text.replace(",", ".")) if isinstance(text, str) else None
    return match[2].strip() if match and match[2] else None


def select_channel_words(name: str) -> list[str]:
    """Return the words of a factor's name that name its channel.

    >>> select_channel_words("force_gain"), select_channel_words("gain")
    (['force'], [])
    """
    return [
        word
        for word in words_of_name(name)
        if word not in _FACTORS | _SHIFTS | _LINKS | _UNIT_WORDS
    ]


def _as_text(value: object) -> str:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


def changes_numbers(name: str, value: object) -> bool:
    """Whether an attribute states a factor that would change the numbers.

    >>> changes_numbers("gain", 10.0), changes_numbers("gain", 1), changes_numbers("full_scale", 5)
    (True, False, False)
    >>> changes_numbers("calibration", "y = 10*x"), changes_numbers("calibration", "2026-01-12")
    (True, False)
    """
    if not names_factor(name):
        return False
    # an offset of the scale is a summand, too
    neutral = 0.0 if set(words_of_name(name)) & _SHIFTS else 1.0
    numbers = stated_numbers(value)
    if not numbers and isinstance(value, str | bytes) and _EXPRESSION.search(_as_text(value)):
        return True
    if not numbers and set(words_of_name(name)) & _SIGNS:
        return _as_text(value).strip().casefold() in _INVERSION_WORDS
    return any(number != neutral for number in numbers)


def stated_numbers(value: object) -> tuple[float, ...]:
    """Return the numbers of an attribute, also of a text with a unit; none of other text."""
    if isinstance(value, bytes):
        value = value.decode("utf-8", "replace")
    if isinstance(value, str):
        match = _STATED.match(value.replace(",", "."))
        return (float(match[1]),) if match else ()
    if isinstance(value, bool):
        return ()
    if isinstance(value, int | float):
        return (float(value),)
    if hasattr(value, "tolist"):
        return stated_numbers(value.tolist())
    if isinstance(value, list | tuple) and len(value) <= 64:
        return tuple(number for item in value for number in stated_numbers(item))
    return ()


def factors_among(attributes: Mapping[str, object]) -> str:
    """Return the attributes that would change the numbers; "" if there are none.

    >>> factors_among({"gain": 10.0, "offset": 0.0, "serial": 17})
    'gain = 10'
    """
    names = [
        f"{name} = {_format_factor_value(value)}"
        for name, value in attributes.items()
        if changes_numbers(name, value)
    ]
    return " and ".join(names[:4])


def _format_factor_value(value: object) -> str:
    if isinstance(value, bytes):
        value = value.decode("utf-8", "replace")
    if isinstance(value, str):
        return value.strip()[:40]
    numbers = [f"{number:g}" for number in stated_numbers(value)]
    return numbers[0] if len(numbers) == 1 else f"[{', '.join(numbers[:8])}]"


def find_fill_values(attributes: Mapping[str, object]) -> tuple[float, ...]:
    """Return the stated fill values of missing numbers.

    >>> find_fill_values({"fill_value": "-9999", "gain": 10.0})
    (-9999.0,)
    """
    return tuple(
        number
        for name, value in attributes.items()
        if _remove_signs(name.rpartition(".")[2]) in _FILLS
        for number in stated_numbers(value)
    )


def remove_fill_values(
    name: str, values: FloatArray, attributes: Mapping[str, object]
) -> tuple[FloatArray, list[str]]:
    """Return the numbers without the stated fill values, and notes on these.

    None is a fill value, and what lies outside the range that is stated to be valid.
    """
    fill_masks = find_fill_values(attributes)
    missing = np.isin(values, fill_masks) if fill_masks else np.zeros(np.shape(values), bool)
    low, high = _find_valid_range(attributes)
    is_outside = ((values < low) | (values > high)) & ~missing
    notes = [
        f"{np.count_nonzero(is_fill)} numbers of '{name}' are stated to be none, {reason}"
        for is_fill, reason in (
            (missing, "as fill values"),
            (is_outside, f"outside the valid range {low:g} to {high:g}"),
        )
        if is_fill.any()
    ]
    return (np.where(missing | is_outside, np.nan, values), notes) if notes else (values, [])


def _find_valid_range(attributes: Mapping[str, object]) -> tuple[float, float]:
    """Return the stated valid range, infinite without one."""
    low, high = -np.inf, np.inf
    for name, value in attributes.items():
        bound_positions = _VALID.get(_remove_signs(name.rpartition(".")[2]), (None, None))
        numbers = stated_numbers(value)
        if isinstance(value, str):
            numbers = tuple(float(number) for number in _NUMBERS.findall(value)[:2])
        first, last = (
            numbers[position] if position is not None and position < len(numbers) else None
            for position in bound_positions
        )
        low = low if first is None else max(low, first)
        high = high if last is None else min(high, last)
    return low, high


def split_full_scale(name: str) -> str | None:
    """Return the channel of a name of a full scale; None for any other name.

    >>> split_full_scale("force_full_scale"), split_full_scale("FullScale"), split_full_scale("fs")
    ('force', '', '')
    """
    match = _FULL_SCALE.match(name)
    return match[1] if match else None


@lru_cache(maxsize=4096)
def concerns_numbers(name: str) -> bool:
    """Return whether a name denotes a factor, an offset, a full scale or a fill value."""
    bare_name = _remove_signs(name)
    is_numeric = bare_name in _FILLS or bare_name in _VALID
    return is_numeric or names_factor(name) or split_full_scale(name) is not None


def _remove_signs(name: str) -> str:
    return "".join(filter(str.isalpha, name.casefold()))


def describe_full_scale(values: FloatArray, name: str, value: object) -> str:
    """Return a full scale where the numbers cannot be in its unit: they are parts of it, or counts.

    >>> describe_full_scale(np.array([0.0, 0.7]), "full_scale", "50 N")
    'full_scale = 50 N'
    >>> describe_full_scale(np.array([0.0, 7.0]), "full_scale", "50 N")
    ''
    """
    full_scale = max(map(abs, stated_numbers(value)), default=0.0)
    largest = float(np.nanmax(np.abs(values), initial=0.0))
    is_implausible = (
        largest > _MAX_FULL_SCALE_RATIO * full_scale
        or largest <= 1 < full_scale / _MAX_FULL_SCALE_RATIO
    )
    return f"{name} = {_format_factor_value(value)}" if full_scale and is_implausible else ""


def apply_attributes(
    name: str, values: FloatArray, attributes: Mapping[str, object], notes: list[str]
) -> tuple[FloatArray, str]:
    """Return the numbers of a channel without fill values, and the stated factors.

    Every format uses this for factors, full scales and fill values.
    """
    values, fill_notes = remove_fill_values(name, values, attributes)
    notes += fill_notes
    scales = (
        describe_full_scale(values, key, value)
        for key, value in attributes.items()
        if split_full_scale(key.rpartition(".")[2]) == ""
    )
    return values, factors_among(attributes) or next(filter(None, scales), "")
