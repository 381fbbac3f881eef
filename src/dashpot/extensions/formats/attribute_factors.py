"""Scale factors in the attributes of a binary file."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import lru_cache

_FACTORS = {
    "scale", "scaling", "slope", "gain", "factor", "multiplier", "calibration", "sensitivity",
    "amplification", "attenuation", "conversion", "coefficient", "coefficients", "faktor",
    "skalierung", "verstärkung", "empfindlichkeit", "kalibrierfaktor", "skalierungsfaktor", "cal",
    "coeff", "coeffs", "coef", "multiplication", "calib", "polynomial", "poly", "exponent", "ratio",
    "divisor", "divider", "attenuator", "attn", "eichfaktor", "übersetzung", "teiler", "calfac",
    "scl", "resolution", "lsb", "per", "power",
}  # fmt: skip
"""Words of a factor: 1 changes nothing."""
_SHIFTS = {"offset", "intercept", "bias", "zero", "tare", "nullpunkt"}
"""Words of a summand: 0 changes nothing."""
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
"""Words beside a factor that say of no channel."""
_OF_THE_CLOCK = {"start", "begin", "time", "trigger", "wf", "x"}
"""Words beside which an offset is when a signal begins."""
_BESIDES = {
    "full", "range", "date", "name", "type", "status", "id", "number", "poisson", "second",
    "seconds", "samples", "sample", "rate", "loss", "shape", "form", "safety", "quality", "crest",
    "damping", "noise", "aspect", "compression", "chunk", "fill", "time",
}  # fmt: skip
"""Words beside which no factor of the numbers is meant."""
_WORDS = re.compile(r"[a-zà-ÿ]+")
_STATED = re.compile(r"\A\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d{1,3})?)\s*([^\d\s].{0,20})?\Z")


def words_of_name(name: str) -> list[str]:
    """Return the words of an attribute's name in lower case.

    >>> words_of_name("ForceScale"), words_of_name("cal_factor 2")
    (['force', 'scale'], ['cal', 'factor'])
    """
    return _WORDS.findall(re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name).casefold())


@lru_cache(maxsize=4096)
def names_factor(name: str) -> bool:
    """Return whether a name is that of a factor or a summand of numbers.

    >>> names_factor("gain"), names_factor("full_scale"), names_factor("serial")
    (True, False, False)
    """
    words = set(words_of_name(name))
    words |= {"factor" for word in words if word.endswith(("factor", "faktor"))}
    begins = words & _SHIFTS and words & _OF_THE_CLOCK
    return not words & _BESIDES and not begins and bool(words & (_FACTORS | _SHIFTS))


def stated_unit(value: object) -> str | None:
    """Return the unit behind the number of an attribute that is text, None of any other."""
    text = value.decode("utf-8", "replace") if isinstance(value, bytes) else value
    match = _STATED.match(text.replace(",", ".")) if isinstance(text, str) else None
    return match[2].strip() if match and match[2] else None


def select_channel_words(name: str) -> list[str]:
    """Return the words of a factor's name that say of what it is one.

    >>> select_channel_words("force_gain"), select_channel_words("gain")
    (['force'], [])
    """
    return [
        word
        for word in words_of_name(name)
        if word not in _FACTORS | _SHIFTS | _LINKS | _UNIT_WORDS
    ]


def changes_numbers(name: str, value: object) -> bool:
    """Whether an attribute of this name and value states what would change the numbers beside it.

    >>> changes_numbers("gain", 10.0), changes_numbers("gain", 1), changes_numbers("full_scale", 5)
    (True, False, False)
    """
    if not names_factor(name):
        return False
    # an offset of the scale is a summand, too
    neutral = 0.0 if set(words_of_name(name)) & _SHIFTS else 1.0
    stated = stated_numbers(value)
    return bool(stated) and any(number != neutral for number in stated)


def stated_numbers(value: object) -> tuple[float, ...]:
    """Return the numbers that an attribute holds, be it as text with a unit; none of other text."""
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
    """Return what attributes state that would change the numbers beside them, "" if nothing.

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
