"""What a user says of the arrays that he gives: their units, in the order of the arrays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from types import SimpleNamespace
from typing import Any, TypeAlias

import numpy as np

from dashpot.base.errors import DataError
from dashpot.base.serialisation import EDGE
from dashpot.base.units import Dimension, Unit, find_unit, from_unit, get_default_unit, si_unit

SI = "SI"
Dimensions: TypeAlias = Dimension | tuple[Dimension, ...]
"""What an array can be of: one, or one of several, as a modulus is of a material or of a part."""


def make_units_field() -> Any:
    """Return the field of a noun that says the units of its arrays: ``"SI"``, or one for each.

    Inside a noun everything is in SI, so that the field then says ``"SI"``; no document holds it.
    """
    return field(default="", kw_only=True, repr=False, compare=False, metadata={EDGE: SI})


def convert_arrays_to_si(result: Any, **of: Dimensions) -> Mapping[str, Dimension]:
    """Put the arrays of a frozen noun into SI by the units that were said of them, in this order.

    Parameters
    ----------
    result : dataclass
        With a field of :func:`make_units_field`; an array that is None has no unit.
    **of
        What each array can be of, by the name of its field.

    Returns
    -------
    mapping of str to str
        What each array was said to be of; empty where all are in SI already.

    Raises
    ------
    DataError
        If no unit was said, or too few or too many, or one is unknown or of another dimension.
    """
    if result.units == SI:
        return {}
    options = {name: item for name, item in of.items() if getattr(result, name) is not None}
    units = {
        name: _unit(result, name, word, option)
        for (name, option), word in zip(options.items(), words_of(result, options), strict=True)
    }
    for name, unit in units.items():
        convert_field_to_si(result, name, unit)
    object.__setattr__(result, "units", SI)
    return {name: unit.dimension for name, unit in units.items()}


def words_of(result: Any, options: Mapping[str, Dimensions]) -> list[str]:
    """Return the words of the units, one for each array."""
    kind, names = _get_type_label(result), ", ".join(options)
    example = ", ".join(get_default_unit(_several(option)[0]) for option in options.values())
    if not result.units:
        raise DataError(
            f'{kind} is made of arrays, and no array says its unit. Add units="SI", or the unit '
            f'of each in this order ({names}): units="{example}"'
        )
    words = [word.strip() for word in str(result.units).split(",")]
    if len(words) != len(options):
        raise DataError(
            f'{kind}: units="{result.units}" names {len(words)} units for {len(options)} arrays '
            f'({names}). Name one for each, in this order: units="{example}"'
        )
    return words


def _get_type_label(result: Any) -> str:
    return "a batch" if isinstance(result, SimpleNamespace) else type(result).__name__


def _several(value: Dimensions) -> tuple[Dimension, ...]:
    return (value,) if isinstance(value, str) else value


def _unit(result: Any, name: str, word: str, value: Dimensions) -> Unit:
    units = (find_unit(word, text) for text in _several(value))
    unit = next((unit for unit in units if unit is not None), None)
    if unit is None:
        wanted = " or ".join(_several(value))
        example = " or ".join(dict.fromkeys(map(get_default_unit, _several(value))))
        raise DataError(
            f"{_get_type_label(result)}: '{word}' is no unit of {wanted}, and {name} is one. "
            f"Write for example {example}"
        )
    return unit


def convert_field_to_si(result: Any, name: str, unit: Unit) -> None:
    """Put one array of a frozen noun into SI."""
    values = np.asarray(getattr(result, name))
    object.__setattr__(result, name, from_unit(values, unit))


def resolve_unit(value: Any, stated: Mapping[str, Dimension], *names: str) -> None:
    """Set the unit of a noun that may be of a part or of a material by what was said of it.

    Raises
    ------
    DataError
        If one of the arrays was said to be of a part, another of a material.
    """
    if not stated:
        return
    lines = {si_unit(stated[name]).word for name in names if name in stated}
    if len(lines) > 1:
        raise DataError(
            f"{type(value).__name__}: {' and '.join(names)} are in units of {' and '.join(lines)}. "
            "Give both as a modulus, or both as a stiffness"
        )
    object.__setattr__(value, "unit", lines.pop())


def arrays_in_si(units: str, **given: tuple[Any, Dimension]) -> list[Any]:
    """Return arrays in SI, each given with what it is of; None stays None.

    Raises
    ------
    DataError
        As :func:`convert_arrays_to_si`.
    """
    holder = SimpleNamespace(units=units, **{name: values for name, (values, _) in given.items()})
    if units != SI:
        convert_arrays_to_si(holder, **{name: of for name, (_, of) in given.items()})
    return [getattr(holder, name) for name in given]
