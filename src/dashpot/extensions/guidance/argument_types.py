"""Advice for an argument of a Python function with the wrong type.

Types are read from the annotations of the function, as text: nothing is imported for a check.
"""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from inspect import Parameter, Signature
from numbers import Integral, Number, Real
from os import PathLike
from types import MappingProxyType
from typing import Any, NamedTuple

from dashpot.api import OPTION_CLASSES
from dashpot.base.errors import DashpotError


def refuse_wrong_types(
    signature: Signature,
    arguments: Mapping[str, Any],
    error: type[DashpotError],
    *,
    takes_mappings: bool = True,
) -> None:
    """Refuse the first argument that is not of the type of its annotation.

    A verb takes a mapping for a class of options (:data:`dashpot.api.OPTION_CLASSES`), which checks
    its own values.

    Raises
    ------
    DashpotError
        Of the type `error`.
    """
    for name, value in arguments.items():
        parameter = signature.parameters[name]
        is_checked_later = takes_mappings and name in OPTION_CLASSES
        if is_checked_later or not isinstance(parameter.annotation, str):
            continue
        is_variadic = parameter.kind is Parameter.VAR_POSITIONAL
        for item in value if is_variadic else (value,):
            example = suggest_argument(parameter)
            problem = describe_wrong_argument(name, item, parameter.annotation, example)
            if not (problem or parameter.default == ()) and _is_empty_sequence(item, parameter):
                problem = f"is empty; expected at least one value, such as {name}={example}"
            if problem:
                by_place = parameter.kind is not Parameter.KEYWORD_ONLY
                raise error(f"{name} {problem}" if by_place else f"{name}= {problem}")


def describe_wrong_argument(name: str, value: Any, annotation: str, example: str = "") -> str:
    """Return the message on an argument of a wrong type; empty if the type is right.

    Parameters
    ----------
    name : str
    value : object
    annotation : str
        As the function has it.
    example : str
        A value that it takes, as it is written.

    >>> describe_wrong_argument("seals", "2", "float | None")
    "is '2'; expected a number, such as seals=2"
    >>> describe_wrong_argument("mass", "114.8g", "Quantity | None")
    ''
    """
    if _is_of_any_type(value, annotation):
        return ""
    alternatives = _split(annotation)
    expected = " or ".join(
        dict.fromkeys(_describe_type(word, alternatives) for word in alternatives if word != "None")
    )
    example = _suggest_value(value, alternatives) or example
    hint = f", such as {name}={example}" if example else ""
    if value is None:
        hint += ". Leave it out for the usual one"
    elif isinstance(value, str | PathLike) and "str" not in expected:
        classes = [word for word in alternatives if _is_class(word)]
        hint += f'. Read the file first: dp.read("{value}")' if classes else ""
    return f"is {_format_value(value)}; expected {expected}{hint}"


def suggest_argument(parameter: Parameter) -> str:
    """Return a value that a parameter takes, as it is written; empty if none is known."""
    example, default = _EXAMPLES.get(parameter.name, ""), parameter.default
    if example and _is_of_any_type(ast.literal_eval(example), str(parameter.annotation)):
        return example
    return repr(default) if isinstance(default, str | int | float) and default != "" else ""


def _is_empty_sequence(value: Any, parameter: Parameter) -> bool:
    return parameter.annotation != "Any" and _is_sequence(value) and len(value) == 0


def _format_value(value: Any) -> str:
    """Return a short value as it was written, and the type of a longer one."""
    if value is None or isinstance(value, str | bytes | int | float | complex | tuple | list):
        text = repr(value) if not isinstance(value, int) or abs(value) < _LARGEST else "too large"
        if len(text) <= _LONGEST:
            return text
    return f"of the type {type(value).__name__}"


_LONGEST = 40
_LARGEST = 10**15


# Types, by the word of an annotation.


class _Type(NamedTuple):
    """Type of arguments: a test of values, and its name in a message."""

    is_instance: Callable[[Any], bool]
    text: str


def _is_number(value: Any) -> bool:
    """Whether a value is one finite real number; also those of NumPy."""
    if getattr(value, "ndim", None) == 0 and hasattr(value, "item"):
        value = value.item()
    if isinstance(value, bool) or not isinstance(value, Real):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:
        return False


def _is_whole_number(value: Any) -> bool:
    return _is_number(value) and isinstance(value, Integral) and abs(int(value)) < _LARGEST


def _is_truth_value(value: Any) -> bool:
    return type(value).__name__ in {"bool", "bool_"} or (
        isinstance(value, Integral) and value in {0, 1}
    )


def _is_text(value: Any) -> bool:
    return isinstance(value, str)


def _is_quantity(value: Any) -> bool:
    return _is_number(value) or (_is_text(value) and re.search(r"\d", value) is not None)


def _is_pair(holds: Callable[[Any], bool]) -> Callable[[Any], bool]:
    return lambda value: _is_sequence(value) and len(value) == 2 and all(map(holds, value))


def _is_sequence(value: Any) -> bool:
    """Whether a value has items in an order: a list, tuple, array or column."""
    return (
        hasattr(value, "__len__")
        and hasattr(value, "__getitem__")
        and not isinstance(value, str | bytes | Mapping | type)
        and getattr(value, "ndim", 1) == 1
    )


def _is_array(kinds: str, number: type) -> Callable[[Any], bool]:
    """Return the test for a number, or numbers in an order, of some kinds of NumPy."""

    def is_array(value: Any) -> bool:
        if hasattr(value, "dtype"):
            return value.dtype.kind in kinds
        items = value if _is_sequence(value) else (value,)
        return all(isinstance(item, number) or _is_truth_value(item) for item in items)

    return is_array


_WORD = _Type(_is_text, "a text")
_TYPES: Mapping[str, _Type] = MappingProxyType({
    "Any": _Type(lambda _: True, "anything"),
    "N": _Type(lambda _: True, "anything"),
    "None": _Type(lambda value: value is None, "None"),
    "Quantity": _Type(_is_quantity, "a number in SI units or a text with its unit"),
    "Range": _Type(
        lambda value: _is_text(value) or _is_pair(_is_quantity)(value),
        "two numbers in SI units or a text with their unit",
    ),
    "float": _Type(_is_number, "a number"),
    "int": _Type(_is_whole_number, "a whole number"),
    "bool": _Type(_is_truth_value, "True or False"),
    "str": _WORD,
    "Arms": _Type(
        lambda value: _is_whole_number(value) or (_is_text(value) and value == "auto"),
        "a whole number or 'auto'",
    ),
    "Place": _Type(lambda value: isinstance(value, str | PathLike), "the path of a file"),
    "Path": _Type(lambda value: isinstance(value, PathLike), "the path of a file"),
    "Column": _Type(
        lambda value: _is_text(value) or _is_whole_number(value) or _is_sequence(value),
        "the name or number of a column",
    ),
    "tuple[float, float]": _Type(_is_pair(_is_number), "two numbers"),
    **dict.fromkeys(
        ("npt.ArrayLike", "FloatArray", "ComplexArray"),
        _Type(_is_array("biufc", Number), "an array of numbers"),
    ),
    **dict.fromkeys(
        ("BoolArray", "IndexArray"),
        _Type(_is_array("biu", Integral), "an array of True or False, or of positions"),
    ),
    **dict.fromkeys(
        ("To", "Method", "Elastic", "FamilyOption", "ShiftLaw", "VerticalOption", "RampLawOption",
         "AmplitudeLawOption", "ElasticKindOption",
         "ImpactLawOption"),
        _WORD,
    ),
})  # fmt: skip
_ALIASES: Mapping[str, str] = MappingProxyType(
    {
        "Records": "RelaxationTest | RampHold | Sequence[RelaxationTest | RampHold]",
        "Vibration": "ImpactTest | ShakenTest | FRF | FRFSet",
        "Geometry": "Disc | Block | Bush | Bulb",
    }
)
"""Annotations of several types, as defined by `dashpot.api`."""
_CLASS_NAMES: Mapping[str, str] = MappingProxyType(
    {"Solid": "a solid", "HasVerdict": "another result"}
)
_EXAMPLES: Mapping[str, str] = MappingProxyType({
    "band": '"1:50Hz"', "baseline": '"1s"', "close": '"1m/s"',
    "cold": '["0degC"]', "compression": '"8mm"', "compression_limits": '"1:4mm"',
    "depth": '"8mm"', "drop": '"1m/s"',
    "drop_height": '"18mm"', "force_limits": '"1:20N"', "frequency": '"12.71Hz"',
    "height": '"10mm"', "hit_length": '"8s"', "hold": '"40s"', "impact_temperature": '"23degC"',
    "impact_velocity": '"1m/s"', "length": '"50mm"', "level": '"1N"', "levels": '["1N", "2N"]',
    "load": '"2N"', "mass": '"114.8g"', "modulus": '"2MPa"', "bulk_modulus": '"2GPa"',
    "mass_sd": '"0.1g"', "noise": '"5mN"', "nominal": '"8mm"', "radius": '"10mm"',
    "radius_error": '"0.1mm"', "ramp": '"1s"', "rate": '"1kHz"', "reference": '"23degC"',
    "resonance_at": '["12Hz", "11Hz"]', "seal_mass": '"5g"', "seals": "2", "arms": "2",
    "spread": '"10%"', "spring_stiffness": '"10N/mm"', "use_at": '"23degC"',
    "temperature": '"23degC"', "window_decay": '"0.5s"', "density": "1100", "seed": "1",
    "hits": "5", "lines": "2001", "cycle": "2", "quantity": '"accelerance"',
    "path": '"result.json"', "to": '"nastran"', "until": '["10years"]', "stretches": "(1.0, 2.0)",
})  # fmt: skip
"""A value of a parameter by its name, as it is written."""


def _is_of_any_type(value: Any, annotation: str) -> bool:
    return any(_is_of_type(value, word) for word in _split(annotation))


def _is_of_type(value: Any, word: str) -> bool:
    """Return whether a value is of the type that one word of an annotation names."""
    if word in _TYPES:
        return _TYPES[word].is_instance(value)
    if word.startswith("Literal["):
        return _is_text(value) or ("True" in word and value is True)
    name, bracket, items = word.partition("[")
    if bracket and name in {"Sequence", "list", "Iterable"}:
        kinds = _split(items[:-1])
        return _is_sequence(value) and all(
            any(_is_of_type(item, kind) for kind in kinds) for item in value
        )
    if bracket or not name.isidentifier():
        return True  # a mapping, which its function reads
    return any(kind.__name__ == name for kind in type(value).__mro__)


def _describe_type(word: str, alternatives: tuple[str, ...] = ()) -> str:
    if word in _TYPES:
        return _TYPES[word].text
    name, bracket, items = word.partition("[")
    if name == "Literal":
        return f"one of {items[:-1]}"
    if bracket and set(_split(items[:-1])) <= set(alternatives):
        return "a list of them"
    if bracket:
        return f"a list, each {' or '.join(map(_describe_type, _split(items[:-1])))}"
    article = "an" if name.startswith(("A", "E", "I", "O", "FR")) else "a"
    return _CLASS_NAMES.get(name, f"{article} {name}")


def _is_class(word: str) -> bool:
    return word not in _TYPES and word.isidentifier()


def _suggest_value(value: Any, alternatives: tuple[str, ...]) -> str:
    """Return the value meant by a number with a separate unit, or in quotes; else empty."""
    quantities = any("Quantity" in word or "Range" in word for word in alternatives)
    if isinstance(value, tuple | list) and len(value) == 2 and quantities:
        number, unit = value
        if _is_number(number) and _is_text(unit):
            return f'"{number:g}{unit.strip()}"'
    if _is_text(value) and re.fullmatch(r"\s*[\d.]+\s*", value) and "float" in alternatives:
        return str(value).strip()
    return ""


@cache
def _split(annotation: str) -> tuple[str, ...]:
    """Return the types of a union, with aliases expanded."""
    return tuple(_iterate_words(annotation))


def _iterate_words(annotation: str) -> Iterator[str]:
    depth, start = 0, 0
    for place, sign in enumerate(f"{annotation}|"):
        depth += (sign == "[") - (sign == "]")
        if sign == "|" and depth == 0:
            word = annotation[start:place].strip()
            start = place + 1
            yield from _iterate_words(_ALIASES[word]) if word in _ALIASES else (word,)
