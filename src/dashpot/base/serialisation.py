"""Documents of results: attributes as plain values with a schema, written and read."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import cache, reduce
from typing import Any, ClassVar, NamedTuple

from dashpot.base.errors import Status
from dashpot.base.number_format import json_number

FIXED_VALUE = "fixed_value"
"""Key in the metadata of a field that no document holds: its constant value."""
DIGEST = "digest"
"""The key of the digest that shows whether a document was edited."""


class Key(NamedTuple):
    """Key of a document, and the attribute that it holds.

    Attributes
    ----------
    name : str
    attribute : str
        A dotted path; by default the name.
    optional : bool
        Whether the key is omitted if the value is None.
    nonfinite_as_null : bool
        Whether numbers in it that are not finite are null.
    flatten : bool
        Whether each item of a mapping, or of another document, is stored under its own name.
    """

    name: str
    attribute: str = ""
    optional: bool = False
    nonfinite_as_null: bool = False
    flatten: bool = False

    @property
    def path(self) -> list[str]:
        """The names of the attributes on the way."""
        return (self.attribute or self.name).split(".")

    def build_items(self, result: object) -> dict[str, Any]:
        """Return the items of a document for a key: none where it is omitted, or several."""
        value = to_plain_value(reduce(_get_attribute, self.path, result))
        if self.nonfinite_as_null:
            value = replace_nonfinite_numbers(value)
        if self.flatten:
            return dict(value or {})
        return {} if value is None and self.optional else {self.name: value}


EVERY_FIELD = Key("", flatten=True)


class Serialisable:
    """Value whose document is a list of its attributes.

    Attributes
    ----------
    schema : str
        Its versioned name, ``"dashpot/rod@2"``; empty for a part of another document.
    _keys : tuple of str or Key
        ``"law"``, the attribute of this name; ``"fit.law"``, one on the path, under its last word;
        a :class:`Key` where the document has another name for it, or another form;
        ``EVERY_FIELD``, every field of the dataclass that no other key names, as where there are
        no keys. None where an attribute on the path is.
    """

    schema: ClassVar[str] = ""
    _keys: ClassVar[tuple[str | Key, ...]] = ()
    _is_loadable: ClassVar[bool] = True
    """Whether a document with a schema holds the whole value, so that it can be read."""

    @property
    def _has_digest(self) -> bool:
        """Whether its document ends with a digest of the rest."""
        return False

    def to_dict(self) -> dict[str, Any]:
        """Plain dictionaries, lists, texts and numbers, SI units."""
        entries: dict[str, Any] = {"schema": self.schema} if self.schema else {}
        class_: Any = type(self)
        for key in _list_keys(class_):
            entries |= key.build_items(self)
        has_digest = entries.pop(DIGEST, None) is not None or self._has_digest
        return {**entries, DIGEST: compute_document_digest(entries)} if has_digest else entries


def _get_attribute(result: Any, name: str) -> Any:
    return None if result is None else getattr(result, name)


@cache
def _list_keys(class_: Any) -> tuple[Key, ...]:
    keys = [
        entry if isinstance(entry, Key) else Key(entry.rpartition(".")[2], entry)
        for entry in class_._keys or (EVERY_FIELD,)
    ]
    if EVERY_FIELD not in keys:
        return tuple(keys)
    key_names = {".".join(key.path) for key in keys if not key.flatten}
    names = [field.name for field in fields(class_) if FIXED_VALUE not in field.metadata]
    other_keys = [Key(name) for name in names if name not in key_names]
    index = keys.index(EVERY_FIELD)
    return (*keys[:index], *other_keys, *keys[index + 1 :])


def decode_fields(class_: Any, document: Mapping[str, Any]) -> dict[str, Any]:
    """Return the fields of a value from its document, each attribute converted back.

    A flattened attribute gets the whole document and selects its own keys.
    """
    names = {field.name for field in fields(class_)}
    values: dict[str, Any] = {name: document[name] for name in names & document.keys()}
    values |= {
        field.name: field.metadata[FIXED_VALUE]
        for field in fields(class_)
        if FIXED_VALUE in field.metadata
    }
    for key in _list_keys(class_) if issubclass(class_, Serialisable) else ():
        attribute = key.path[0]
        if attribute not in names or attribute in document:
            continue
        if key.flatten:
            values[attribute] = document
        elif key.name in document:
            values = _set_nested_value(values, key.path, document[key.name])
    return values


def _set_nested_value(values: Mapping[str, Any], path: Sequence[str], value: Any) -> dict[str, Any]:
    first, *rest = path
    return {
        **values,
        first: _set_nested_value(values.get(first, {}), rest, value) if rest else value,
    }


# msgspec encodes every dataclass by itself: schema and layout of an inner value would be lost, so
# this walk stays; cattrs would take a hook per class and a dependency more. singledispatch with an
# abstract class such as Mapping searches the bases of each new class: 2 % of `dashpot predict`
def to_plain_value(value: Any) -> Any:
    """Return a value as JSON holds it; a number that is not finite by its name.

    >>> to_plain_value((1.5, float("inf"), {"a": 1j}))
    [1.5, 'Infinity', {'a': {'real': 0.0, 'imag': 1.0}}]
    """
    if isinstance(value, Enum):
        return value.name.lower() if isinstance(value, Status) else value.value
    if value is None or isinstance(value, str | int):
        return value
    if isinstance(value, float):
        return json_number(float(value))
    if isinstance(value, Serialisable):
        return value.to_dict()
    if isinstance(value, list | tuple):
        if hasattr(value, "_fields"):
            return {name: to_plain_value(getattr(value, name)) for name in value._fields}
        return [to_plain_value(item) for item in value]
    if is_dataclass(value):
        return {
            field.name: to_plain_value(getattr(value, field.name))
            for field in fields(value)
            if FIXED_VALUE not in field.metadata
        }
    if isinstance(value, Mapping):
        return {str(key): to_plain_value(item) for key, item in value.items()}
    if isinstance(value, complex) or getattr(getattr(value, "dtype", None), "kind", "") == "c":
        return {"real": to_plain_value(value.real), "imag": to_plain_value(value.imag)}
    # an array: NumPy is not needed to say what went wrong
    return to_plain_value(value.tolist()) if hasattr(value, "tolist") else value


NOT_FINITE = {"Infinity": math.inf, "-Infinity": -math.inf, "NaN": math.nan}
"""Texts in place of numbers that JSON does not have."""


def replace_nonfinite_numbers(value: Any) -> Any:
    """Return plain values with null for every number that is not finite: it is not known."""
    if isinstance(value, dict):
        return {key: replace_nonfinite_numbers(item) for key, item in value.items()}
    if isinstance(value, list):
        return [replace_nonfinite_numbers(item) for item in value]
    return None if isinstance(value, str) and value in NOT_FINITE else value


def compute_document_digest(document: dict[str, Any]) -> str:
    """Return 16 hexadecimal digits of the content of a document, whatever its layout."""

    def normalise_numbers(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: normalise_numbers(item) for key, item in value.items() if key != DIGEST}
        if isinstance(value, list):
            return [normalise_numbers(item) for item in value]
        # other programs print 1.0 as 1
        return float(value) if isinstance(value, int) and not isinstance(value, bool) else value

    import hashlib  # where a document is written, which a page of help does without
    import json

    text = json.dumps(normalise_numbers(document), sort_keys=True)
    return hashlib.sha256(text.encode("utf-8", "backslashreplace")).hexdigest()[:16]
