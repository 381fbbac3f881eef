"""What a JSON document says that it should not: keys twice or unknown, texts for numbers, edits."""

from __future__ import annotations

import re
from typing import Any

from dashpot.base.serialisation import DIGEST, compute_document_digest

_NUMERIC = {"k_inf", "k", "tau", "b"}
"""Keys of a solid, whose values are numbers."""


def has_edited_fit(value: Any) -> bool:
    """Whether a document holds a fit that was changed since; one typed by hand has no digest."""
    if isinstance(value, list):
        return any(map(has_edited_fit, value))
    if not isinstance(value, dict):
        return False
    sealed = "schema" in value and DIGEST in value
    return (sealed and value[DIGEST] != compute_document_digest(value)) or any(
        map(has_edited_fit, value.values())
    )


def require_unique_keys(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Return a JSON object whose keys each stand once."""
    entries = dict(pairs)
    if len(entries) < len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for key in keys if keys.count(key) > 1)
        raise ValueError(f'the key "{twice}" stands twice in one object')
    return entries


def parts_of(value: Any, where: str) -> dict[str, Any]:
    """Return what an object or an array holds by its place; nothing of any other value."""
    if isinstance(value, dict):
        return {f"{where}.{key}": item for key, item in value.items()}
    if isinstance(value, list):
        return {f"{where}[{i}]": item for i, item in enumerate(value)}
    return {}


def find_mistyped_number(value: Any, where: str = "$") -> str:
    """Say which number of a document is a text; nothing if none is."""
    if isinstance(value, str) and re.fullmatch(r"[-+]?[\d.,]+(?:[eE][-+]?\d+)?", value):
        numeric = where.rpartition(".")[2].partition("[")[0] in _NUMERIC
        return f'{where} is the text "{value}"; expected a number, with a point' if numeric else ""
    parts = parts_of(value, where).items()
    return next(filter(None, (find_mistyped_number(item, place) for place, item in parts)), "")


def find_unknown_keys(value: Any, reference: Any, where: str = "$") -> str:
    """Say what a document holds that its noun, written again, does not; nothing if all is known."""
    if isinstance(value, dict | list) and type(value) is not type(reference):
        text, expected = (_KINDS.get(type(item), "one value") for item in (value, reference))
        return f"{where} is {text}; expected {expected}"
    if isinstance(value, dict):
        unknown = sorted(value.keys() - reference.keys())
        if unknown:
            return f'{where} has "{unknown[0]}", which this version of dashpot does not know'
    # the bare contract's orders are left out: then there is nothing to hold the items against
    elif isinstance(value, list) and len(value) != len(reference):
        return ""
    there = parts_of(reference, where)
    parts = parts_of(value, where).items()
    return next(
        filter(None, (find_unknown_keys(item, there[place], place) for place, item in parts)), ""
    )


_KINDS: dict[type, str] = {dict: "an object", list: "an array"}
