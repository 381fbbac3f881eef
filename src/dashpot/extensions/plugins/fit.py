"""Fit by a plug-in, validated against the plug-in contract."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from dashpot.base import units
from dashpot.base.checks import GRADES, Check, Remedy
from dashpot.base.errors import FitError
from dashpot.base.provenance import list_sources
from dashpot.base.reported_values import NORMAL, ReportedValue
from dashpot.datamodel.checks import caution_checks
from dashpot.extensions.plugins.contract import (
    get_items,
    get_text,
    get_texts,
    refuse_result,
    validate_keys,
)
from dashpot.extensions.plugins.datamodel import PluggedTest, PluginFit
from dashpot.registry.plugins import Plugin, require_plugin

_EXPECTED = (
    "{'numbers': [{'name': ..., 'value': ..., 'unit': ...}, ...], 'checks': [...]}, SI units"
)
_KEYS = ("numbers", "checks", "notes")
_NUMBER_KEYS = ("name", "value", "unit", "error", "low", "high", "words")
_CHECK_KEYS = ("name", "message", "passed", "grade", "remedy")


def fit_plugged(records: Sequence[PluggedTest]) -> PluginFit:
    """Return the result of the plug-in of a kind for the columns of one file.

    Its function ``(columns, options)`` gets a list of ``{"name", "role", "unit", "values"}``,
    SI where a unit is known, and returns numbers and checks.

    Raises
    ------
    FitError
        If there are several files.
    ReadError
        If there is no such plug-in, it fails, or returns something else.
    """
    if len(records) != 1:
        raise FitError(f"a plug-in fits one file at a time, and {len(records)} were given")
    (test,) = records
    plugin = require_plugin("kinds", test.kind)
    function = plugin.load()
    columns = [
        {
            "name": column.name,
            "role": column.role,
            "unit": column.unit,
            "values": column.values.tolist(),
        }
        for column in test.columns
    ]
    try:
        entries = function(columns, {"file": test.source.file if test.source else ""})
    except Exception as error:  # noqa: BLE001  others' code may raise anything
        plugin.raise_failure(error)
    if not isinstance(entries, dict):
        refuse_result(plugin, f"a {type(entries).__name__}", _EXPECTED)
    validate_keys(plugin, entries, _KEYS)
    reported_values = tuple(
        _make_reported_value(plugin, entry) for entry in get_items(plugin, entries, "numbers")
    )
    if not reported_values:
        refuse_result(plugin, "no numbers", _EXPECTED)
    all_checks = tuple(_check(plugin, entry) for entry in get_items(plugin, entries, "checks"))
    checks = (*all_checks, *caution_checks(list_sources(records)))
    notes = get_texts(plugin, entries, "notes")
    return PluginFit(
        plugin.name, plugin.package_version, reported_values, checks, notes, list_sources(records)
    )


def _make_reported_value(plugin: Plugin, item: Mapping[str, Any]) -> ReportedValue:
    name = get_text(plugin, item, "name")
    validate_keys(plugin, item, _NUMBER_KEYS, f" of the number '{name}'")
    if not name.isidentifier():
        refuse_result(plugin, f"a number called '{name}'", "an identifier, such as peel_force")
    unit = get_text(plugin, item, "unit", "")
    resolved_unit = units.find_unit(unit) if unit else None
    if unit and (resolved_unit is None or resolved_unit.factor != 1.0 or resolved_unit.offset):
        refuse_result(plugin, f"'{name}' in '{unit}'", "a unit of SI that dashpot knows, or none")
    value = _number(plugin, item, "value", name)
    words = get_text(plugin, item, "words", "")
    if "low" in item or "high" in item:
        low, high = (_number(plugin, item, end, name) for end in ("low", "high"))
        if not low <= value <= high:
            refuse_result(
                plugin, f"'{name}' = {value:g} outside {low:g} to {high:g}", "a value within"
            )
        return ReportedValue(name, value, low, high, unit, words=words)
    if "error" not in item:
        return ReportedValue(name, value, unit=unit, words=words)
    error = _number(plugin, item, "error", name)
    if error < 0:
        refuse_result(plugin, f"'{name}' with the standard error {error:g}", "one of 0 or more")
    half_width = NORMAL * error  # an interval alone: that is what a document keeps
    return ReportedValue(name, value, value - half_width, value + half_width, unit, words=words)


def _number(plugin: Plugin, item: Mapping[str, Any], key: str, name: str) -> float:
    value = item.get(key)
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        refuse_result(plugin, f"'{name}' whose {key} is {value!r:.40}", "a finite number")
    return float(value)


def _check(plugin: Plugin, item: Mapping[str, Any]) -> Check:
    name, message = (get_text(plugin, item, key) for key in ("name", "message"))
    validate_keys(plugin, item, _CHECK_KEYS, f" of the check '{name}'")
    is_passed, grade = item.get("passed"), item.get("grade", "limit")
    if not (is_passed is None or isinstance(is_passed, bool)):
        refuse_result(
            plugin, f"the check '{name}' whose 'passed' is {is_passed!r:.40}", "True, False or None"
        )
    if grade not in GRADES:
        refuse_result(
            plugin, f"the check '{name}' of grade {grade!r:.40}", f"one of {', '.join(GRADES)}"
        )
    remedy = get_text(plugin, item, "remedy", "")
    return Check(name, is_passed, message, grade=grade, remedy=Remedy(remedy) if remedy else None)
