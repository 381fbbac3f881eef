"""Results as documents: a noun lists its attributes, and one walk makes them plain values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import reduce, singledispatch
from typing import Any, ClassVar

import numpy as np

from dashpot.base.numbers import json_number


class Documented:
    """A noun whose document is a list of its attributes.

    Attributes
    ----------
    schema : str
        Its versioned name, ``"dashpot/rod@1"``; empty for a part of another document.
    keys : tuple of str
        ``"law"``, the attribute of this name; ``"fit.law"``, one on the way, under its last word;
        ``"key=fit.law"``, under another; with ``"?"`` at the end left out where it is None;
        ``"*fit.values"``, every item of a mapping, or of another document, under its own.
        Empty: every field of the dataclass.
    """

    schema: ClassVar[str] = ""
    keys: ClassVar[tuple[str, ...]] = ()

    @property
    def document(self) -> dict[str, Any]:
        """Plain dictionaries, lists, texts and numbers, SI units."""
        found: dict[str, Any] = {"schema": self.schema} if self.schema else {}
        for key in self.keys or tuple(one.name for one in fields(self)):  # type: ignore[arg-type]
            found |= _item(self, key)
        return found


def _item(noun: object, key: str) -> dict[str, Any]:
    name, _, path = key.removesuffix("?").lstrip("*").rpartition("=")
    value = plain(reduce(getattr, path.split("."), noun))
    if key.startswith("*"):
        return {} if value is None else dict(value)
    if value is None and key.endswith("?"):
        return {}
    return {name or path.rpartition(".")[2]: value}


# msgspec encodes a dataclass without asking: the schema and the layout of an inner noun would be
# lost, so this walk stays; cattrs would take a hook per noun and a dependency more
@singledispatch
def plain(value: Any) -> Any:
    """Return a value as JSON holds it; a number that is not finite by its name.

    >>> plain((1.5, float("inf"), {"a": np.array([1j])}))
    [1.5, 'Infinity', {'a': {'real': [0.0], 'imag': [1.0]}}]
    """
    if isinstance(value, Documented):
        return value.document
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        return {name: plain(getattr(value, name)) for name in value._fields}
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if is_dataclass(value):
        return {one.name: plain(getattr(value, one.name)) for one in fields(value)}
    return value


@plain.register(np.ndarray)
@plain.register(np.generic)
def _(value: Any) -> Any:
    if np.iscomplexobj(value):
        return {"real": plain(value.real), "imag": plain(value.imag)}
    return plain(value.tolist())


plain.register(float, json_number)
plain.register(Enum, lambda value: value.value)
