"""Parsing of the page's request as the options of a `Job`."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import MISSING, Field, fields
from pathlib import Path
from typing import Any, TypeVar

from dashpot.base.errors import DashpotError, DataError
from dashpot.base.option_fields import is_path_field, require_choice
from dashpot.base.units import convert_to_si, si_range
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.app.command_lines import format_values, note_file
from dashpot.extensions.app.upload_store import find_file
from dashpot.registry import find_handler
from dashpot.workflow.job import Job

T = TypeVar("T")

MAX_SIZE = 8000.0
"""Largest width or height of a drawing, px: no screen has more."""


def build_job(value: object, folder: Path) -> Job:
    """Return the job of a page's request: quantities as texts, files by identity.

    Raises
    ------
    DataError
        If anything in it is not of a job, or not of its kind.
    ReadError
        If a file is no longer there.
    """
    options = require_mapping(value, "job")
    unknown_options = options.keys() - _list_field_names(Job)
    if unknown_options:
        raise DataError(f"a job has no '{min(unknown_options)}'")
    if not options.get("relaxation"):
        raise DataError("no relaxation test is open: open one first")
    temperatures = get_list(options, "temperatures")
    if "" in temperatures:
        raise DataError(
            f"{temperatures.count('')} of {len(temperatures)} tests that are fitted together has "
            "no temperature: give every one its own, or none"
        )
    return build_from_request(Job, options, folder)


def build_from_request(kind: type[T], options: Mapping[str, Any], folder: Path) -> T:
    """Return a value of declared options, filled from a page's request.

    Raises
    ------
    DataError
        If a value is of the wrong kind.
    ReadError
        If a file is no longer there.
    """
    attributes = [field for field in _fields(kind) if field.name in options]
    return kind(
        **{attribute.name: _read_field(attribute, options, folder) for attribute in attributes}
    )


def _read_field(field: Field[Any], options: Mapping[str, Any], folder: Path) -> Any:
    """Return the value of a form field; missing or empty text is the default."""
    metadata, name, value = field.metadata, field.name, options[field.name]
    if "options_class" in metadata and isinstance(value, str) and value:
        return _read_part(metadata["options_class"], name, find_file(folder, value))
    if "options_class" in metadata:
        return build_part(metadata["options_class"], value, name)
    if isinstance(field.default, tuple):
        return tuple(_read_single_value(field, item, folder) for item in get_list(options, name))
    if isinstance(field.default, bool):
        return value is True
    if value not in (None, ""):
        return _read_single_value(field, value, folder)
    if field.default is MISSING:
        raise DataError(f"{name} is not given")
    return field.default


def _read_part(kind: type[T], name: str, path: Path) -> T:
    """Return a part of a job that an open file states, as ``--machine rig.toml`` does.

    Raises
    ------
    DataError
        If no file states this part.
    ReadError
        If it is no such file.
    """
    read = find_handler("read option", f"--{name}")
    if read is None:
        raise DataError(f"{name} is a text; expected an object")
    return note_file(kind(**read(str(path))), path.name)


def _read_single_value(field: Field[Any], value: Any, folder: Path) -> Any:
    metadata, name = field.metadata, field.name
    if is_path_field(field):
        return str(find_file(folder, value))
    if "is_range" in metadata:
        return _convert_value(lambda text: si_range(text, metadata["unit"]), value, name)
    if "unit" in metadata:
        return read_quantity({name: value}, name, metadata["unit"])
    if "choices" in metadata:
        require_choice(name, value, metadata["choices"])
        return value
    if "minimum" in metadata:
        return read_arms(value)
    return (
        require_number(value, name)
        if isinstance(field.default, float)
        else require_text({name: value}, name)
    )


def parse_selection(selection: str) -> dict[str, Any]:
    """Return the reading options by which a specimen of a file is selected, from their words.

    >>> parse_selection("sheet=Seals, new,segment=2")
    {'sheet': 'Seals, new', 'segment': 2}
    """
    pairs = (word.partition("=") for word in re.split(r",(?=(?:sheet|segment)=)", selection))
    return {key: int(value) if key == "segment" else value for key, _, value in pairs if key}


def describe_job(job: Job) -> dict[str, Any]:
    """Return the choices of a job in the form that :func:`build_job` reads back exactly."""
    fields_by_name = convert_to_request(job)
    specimen = fields_by_name["specimen"]
    if "temperature" in specimen:
        fields_by_name["temperatures"] = [specimen.pop("temperature")]
    separate_fields = ("joint", "temperatures", "reading", "reading_impact")
    return {name: fields_by_name.pop(name) for name in separate_fields} | {"job": fields_by_name}


def convert_to_request(result: Any) -> dict[str, Any]:
    """Return a value as fields of a page, without its files and without its parts' defaults."""
    fields_by_name = {}
    for field in _fields(result):
        value = getattr(result, field.name)
        if "options_class" in field.metadata:
            fields_by_name[field.name] = _get_changed_fields(value)
        elif not is_path_field(field) and value not in (None, ""):
            fields_by_name[field.name] = _format_field(field, value)
    return fields_by_name


def _format_field(field: Field[Any], value: Any) -> Any:
    if "unit" not in field.metadata:
        return value
    texts = format_values(field, value)
    return texts if isinstance(value, tuple) and "is_range" not in field.metadata else texts[0]


def _get_changed_fields(result: Any) -> dict[str, Any]:
    """Return the fields of a part of a job that differ from the default."""
    changed_fields = {}
    for field in fields(result):
        value = getattr(result, field.name)
        if value == field.default:
            continue
        changed_fields[field.name] = dict(value) if field.name == "units" else value
        if isinstance(result, Specimen | Machine):
            changed_fields[field.name] = _format_field(field, value)
    return changed_fields


def build_part(kind: type[T], given: object, name: str) -> T:
    """Return a part of a job; a list is a tuple, and nothing is the default.

    Raises
    ------
    DataError
        If it has an unknown key or a value of the wrong type.
    """
    options = require_mapping(given, name)
    unknown_options = options.keys() - _list_field_names(kind)
    if unknown_options:
        raise DataError(
            f"{name} has no '{min(unknown_options)}'; it has "
            f"{', '.join(sorted(_list_field_names(kind)))}"
        )
    if options.get("calibration"):
        raise DataError("a page names no file beside those that it was given: no calibration")
    given_options = {
        key: tuple(value) if isinstance(value, list) else value
        for key, value in options.items()
        if value not in (None, "")
    }
    return _convert_value(lambda them: kind(**them), given_options, name)


def _fields(result: Any) -> tuple[Field[Any], ...]:
    return fields(result)


def _list_field_names(kind: Any) -> set[str]:
    return {field.name for field in _fields(kind)}


def get_panel_sizes(request: Mapping[str, Any]) -> dict[str, tuple[float, float]]:
    """Return the width and height that the page has for each panel, px.

    Raises
    ------
    DataError
        If one is no pair of numbers.
    """
    sizes = {}
    for name, size in require_mapping(request.get("sizes", {}), "sizes").items():
        is_pair = isinstance(size, list) and len(size) == 2
        if not is_pair or not all(isinstance(item, (int, float)) for item in size):
            raise DataError(f"sizes: {name} = {size!r}; expected [width, height] in px")
        width, height = (min(max(float(value), 0.0), MAX_SIZE) for value in size)
        sizes[name] = width, height
    return sizes


def get_deck_options(request: Mapping[str, Any]) -> dict[str, Any]:
    """Return the options of a deck besides target and units, without empty ones.

    Raises
    ------
    DataError
        If a quantity is none.
    """
    band = request.get("range") or None
    return {
        "form": request.get("form") or None,
        "frequency_range": _convert_value(lambda text: si_range(text, "frequency"), band, "range"),
        "seals": require_number(request.get("seals", 1.0), "seals"),
        "compression": read_quantity(request, "compression", "length"),
        "modulus": read_quantity(request, "modulus", "stress"),
        "bulk_modulus": read_quantity(request, "bulk_modulus", "stress"),
        "mass": read_quantity(request, "mass", "mass"),
    }


def require_mapping(value: object, name: str) -> Mapping[str, Any]:
    """Return a value that must be an object.

    Raises
    ------
    DataError
        If it is not.
    """
    if not isinstance(value, Mapping):
        raise DataError(f"{name} is {type(value).__name__}; expected an object")
    return value


def _convert_value(make: Callable[[Any], T], value: Any, name: str) -> T:
    try:
        return make(value)
    except DashpotError:
        raise
    except (TypeError, ValueError, AttributeError):
        raise DataError(f"{name} = {value!r} is not of the kind expected") from None


def get_list(options: Mapping[str, Any], name: str) -> list[Any]:
    """Return a value that must be a list; None is an empty one."""
    value = options.get(name, [])
    if not isinstance(value, list):
        raise DataError(f"{name} is {type(value).__name__}; expected a list")
    return value


def read_quantity(options: Mapping[str, Any], name: str, dimension: Any) -> float | None:
    """Return a quantity with a unit, in SI; empty text is None."""
    value = options.get(name)
    if value in (None, ""):
        return None
    if not isinstance(value, str):
        raise DataError(f"{name} = {value!r}; expected a quantity with its unit, such as '104g'")
    return convert_to_si(value, dimension)


def require_number(value: object, name: str) -> float:
    """Return a value that must be a number."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise DataError(f"{name} = {value!r}; expected a number")
    return float(value)


def require_text(options: Mapping[str, Any], name: str) -> str:
    """Return a value that must be text; None is ""."""
    value = options.get(name)
    if value is not None and not isinstance(value, str):
        raise DataError(f"{name} = {value!r}; expected a text")
    return value or ""


def read_arms(value: object) -> Any:
    """Return a number of arms, or "auto".

    Raises
    ------
    DataError
        If it is neither.
    """
    if value == "auto" or (isinstance(value, int) and not isinstance(value, bool) and value >= 0):
        return value
    raise DataError(f"arms = {value!r}; expected 'auto' or a whole number >= 0")
