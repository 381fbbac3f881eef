"""Contract of plug-ins: validation of their results, item by item."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NoReturn

from dashpot.base.errors import ReadError
from dashpot.registry.plugins import Plugin, format_plain_line


def refuse_result(plugin: Plugin, problem: str, expected: str) -> NoReturn:
    """Raise an error: the result of a plug-in violates the contract.

    Raises
    ------
    ReadError
    """
    raise ReadError(
        f"{plugin.label} returned {problem}; expected {expected}. Ask who maintains "
        f"{plugin.package}"
    )


def validate_keys(
    plugin: Plugin, item: Mapping[str, Any], keys: Sequence[str], place: str = ""
) -> None:
    """Refuse a key that the contract does not have: a mistyped one would be ignored.

    `place` names the item in the sentence.

    Raises
    ------
    ReadError
    """
    unknown_keys = sorted(str(key) for key in item if key not in keys)
    if unknown_keys:
        refuse_result(plugin, f"the key '{unknown_keys[0]}'{place}", f"among {', '.join(keys)}")


def get_items(plugin: Plugin, document: Mapping[str, Any], key: str) -> Sequence[Mapping[str, Any]]:
    """Return a list of dictionaries from the result of a plug-in; empty if the key is missing.

    Raises
    ------
    ReadError
        If the key holds something else.
    """
    return _get_typed_list(plugin, document, key, dict, "a list of dictionaries")


def get_texts(plugin: Plugin, document: Mapping[str, Any], key: str) -> tuple[str, ...]:
    """Return a list of texts from the result of a plug-in; empty if the key is missing.

    Raises
    ------
    ReadError
        If the key holds something else.
    """
    return tuple(
        map(format_plain_line, _get_typed_list(plugin, document, key, str, "a list of texts"))
    )


def _get_typed_list(
    plugin: Plugin, document: Mapping[str, Any], key: str, kind: type, expected: str
) -> Sequence[Any]:
    results = document.get(key, [])
    if not isinstance(results, list | tuple) or not all(
        isinstance(result, kind) for result in results
    ):
        refuse_result(plugin, f"'{key}' of type {type(results).__name__}", expected)
    return results


def get_text(plugin: Plugin, item: Mapping[str, Any], key: str, default: str | None = None) -> str:
    """Return a text in an item of the result of a plug-in.

    Raises
    ------
    ReadError
        If it is no text, or is missing without a default.
    """
    text = item.get(key, default)
    if not isinstance(text, str):
        refuse_result(plugin, f"'{key}' of type {type(text).__name__}", "a text")
    return format_plain_line(text)
