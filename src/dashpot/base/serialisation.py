"""Documents of results: attributes as plain values with a schema, written and read."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import cache, reduce, singledispatch
from typing import Any, ClassVar, NamedTuple

from dashpot.base.errors import Status
from dashpot.base.number_format import json_number

EDGE = "edge"
"""Of a field that no document holds: what it always is within."""
DIGEST = "digest"
"""The key of a digested document that shows whether the rest was edited."""


class Serialisable:
    """Value whose document is a list of its attributes.

    Attributes
    ----------
    schema : str
        Its versioned name, ``"dashpot/rod@2"``; empty for a part of another document.
    _keys : tuple of str
        ``"law"``, the attribute of this name; ``"fit.law"``, one on the way, under its last word;
        ``"key=fit.law"``, under another; None where one on the way is. With ``"?"`` at the end
        left out where it is None, with ``"~"`` numbers that are not finite are None.
        ``"*fit.values"``: every item of a mapping, or of another document, under its own;
        ``"*"``: every field of the dataclass that no other key names, as where there are no keys.
    """

    schema: ClassVar[str] = ""
    _keys: ClassVar[tuple[str, ...]] = ()
    _is_loadable: ClassVar[bool] = True
    """Whether a document with a schema holds the whole value, so that it can be read."""

    @property
    def _has_digest(self) -> bool:
        """Whether its document ends with a digest of the rest, as one does that takes such in."""
        return False

    def to_dict(self) -> dict[str, Any]:
        """Plain dictionaries, lists, texts and numbers, SI units."""
        entries: dict[str, Any] = {"schema": self.schema} if self.schema else {}
        kind: Any = type(self)
        for key in _parse_keys(kind):
            entries |= key.item(self)
        sealed = entries.pop(DIGEST, None) is not None or self._has_digest
        return {**entries, DIGEST: compute_document_digest(entries)} if sealed else entries


class _Key(NamedTuple):
    name: str
    way: tuple[str, ...]
    spread: bool
    optional: bool
    known: bool

    @classmethod
    def parse_key(cls, text: str) -> _Key:
        body = text.rstrip("?~")
        marks = text[len(body) :]
        name, _, path = body.lstrip("*").rpartition("=")
        way = tuple(path.split("."))
        return cls(name or way[-1], way, body.startswith("*"), "?" in marks, "~" in marks)

    def item(self, result: object) -> dict[str, Any]:
        """Return the items of a document for a key: none where it is left out, or several."""
        value = to_plain_value(reduce(_attribute, self.way, result))
        if self.known:
            value = replace_nonfinite_numbers(value)
        if self.spread:
            return dict(value or {})
        return {} if value is None and self.optional else {self.name: value}


def _attribute(result: Any, name: str) -> Any:
    return None if result is None else getattr(result, name)


@cache
def _parse_keys(kind: Any) -> tuple[_Key, ...]:
    names = (
        [field.name for field in fields(kind) if EDGE not in field.metadata]
        if is_dataclass(kind)
        else []
    )
    texts = kind._keys or ("*",)
    alone = {key.way for key in map(_Key.parse_key, texts) if not key.spread}
    rest = [name for name in names if (name,) not in alone]
    return tuple(
        _Key.parse_key(name) for text in texts for name in (rest if text == "*" else [text])
    )


def decode_fields(kind: Any, document: Mapping[str, Any]) -> dict[str, Any]:
    """Return the fields of a value from its document, each attribute converted back.

    What was spread gets the whole document, and takes of it what it knows.
    """
    names = {field.name for field in fields(kind)}
    value: dict[str, Any] = {name: document[name] for name in names & document.keys()}
    value |= {field.name: field.metadata[EDGE] for field in fields(kind) if EDGE in field.metadata}
    for key in _parse_keys(kind) if issubclass(kind, Serialisable) else ():
        first = key.way[0]
        if first not in names or first in document:
            continue
        if key.spread:
            value[first] = document
        elif key.name in document:
            value = _set_nested_value(value, key.way, document[key.name])
    return value


def _set_nested_value(place: Mapping[str, Any], way: tuple[str, ...], value: Any) -> dict[str, Any]:
    first, *rest = way
    return {
        **place,
        first: _set_nested_value(place.get(first, {}), tuple(rest), value) if rest else value,
    }


# msgspec encodes every dataclass by itself: schema and layout of an inner value would be lost, so
# this walk stays; cattrs would take a hook per class and a dependency more
@singledispatch
def to_plain_value(value: Any) -> Any:
    """Return a value as JSON holds it; a number that is not finite by its name.

    >>> to_plain_value((1.5, float("inf"), {"a": 1j}))
    [1.5, 'Infinity', {'a': {'real': 0.0, 'imag': 1.0}}]
    """
    if value is None or isinstance(value, str | int):
        return value
    if is_dataclass(value):
        return {
            field.name: to_plain_value(getattr(value, field.name))
            for field in fields(value)
            if EDGE not in field.metadata
        }
    if isinstance(value, complex) or getattr(getattr(value, "dtype", None), "kind", "") == "c":
        return {"real": to_plain_value(value.real), "imag": to_plain_value(value.imag)}
    # an array: NumPy is not needed to say what went wrong
    return to_plain_value(value.tolist()) if hasattr(value, "tolist") else value


@to_plain_value.register(list)
@to_plain_value.register(tuple)
def _(value: Any) -> Any:
    if hasattr(value, "_fields"):
        return {name: to_plain_value(getattr(value, name)) for name in value._fields}
    return [to_plain_value(item) for item in value]


to_plain_value.register(Serialisable, lambda value: value.to_dict())
to_plain_value.register(
    Mapping, lambda value: {str(key): to_plain_value(item) for key, item in value.items()}
)
to_plain_value.register(float, lambda value: json_number(float(value)))
to_plain_value.register(Enum, lambda value: value.value)
to_plain_value.register(Status, lambda value: value.name.lower())

NOT_FINITE = {"Infinity": math.inf, "-Infinity": -math.inf, "NaN": math.nan}
"""JSON has no such numbers; a text that no measurement can be mistaken for stands in."""


def replace_nonfinite_numbers(value: Any) -> Any:
    """Return plain values with null for every number that is not finite: it is not known."""
    if isinstance(value, dict):
        return {key: replace_nonfinite_numbers(item) for key, item in value.items()}
    if isinstance(value, list):
        return [replace_nonfinite_numbers(item) for item in value]
    return None if isinstance(value, str) and value in NOT_FINITE else value


def compute_document_digest(document: dict[str, Any]) -> str:
    """Return 16 hexadecimal digits of what a document says, however it is laid out."""

    def even(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: even(item) for key, item in value.items() if key != DIGEST}
        if isinstance(value, list):
            return [even(item) for item in value]
        # other programs print 1.0 as 1
        return float(value) if isinstance(value, int) and not isinstance(value, bool) else value

    import hashlib  # where a document is written, which a page of help does without
    import json

    text = json.dumps(even(document), sort_keys=True)
    return hashlib.sha256(text.encode("utf-8", "backslashreplace")).hexdigest()[:16]
