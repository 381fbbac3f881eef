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
from dashpot.extensions.app.command_lines import note_file, texts_of
from dashpot.extensions.app.upload_store import path_in
from dashpot.registry import find_handler
from dashpot.workflow.job import Job

T = TypeVar("T")

LARGEST = 8000.0
"""Of a drawing, px: no screen has more."""


def job_of(value: object, folder: Path) -> Job:
    """Return the job that a page asks for: quantities as texts, files by identity.

    Raises
    ------
    DataError
        If anything in it is not of a job, or not of its kind.
    ReadError
        If a file is no longer there.
    """
    options = mapping(value, "job")
    strange = options.keys() - _names(Job)
    if strange:
        raise DataError(f"a job has no '{min(strange)}'")
    if not options.get("relaxation"):
        raise DataError("no relaxation test is open: open one first")
    warmth = get_list(options, "temperatures")
    if "" in warmth:
        raise DataError(
            f"{warmth.count('')} of {len(warmth)} tests that are fitted together has no "
            "temperature: give every one its own, or none"
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
    return kind(**{attribute.name: _value(attribute, options, folder) for attribute in attributes})


def _value(field: Field[Any], options: Mapping[str, Any], folder: Path) -> Any:
    """Return what a field is, by what a page says: nothing, or an empty text, is the default."""
    how, name, value = field.metadata, field.name, options[field.name]
    if "part" in how and isinstance(value, str) and value:
        return _read_part(how["part"], name, path_in(folder, value))
    if "part" in how:
        return part(how["part"], value, name)
    if isinstance(field.default, tuple):
        return tuple(_single(field, item, folder) for item in get_list(options, name))
    if isinstance(field.default, bool):
        return value is True
    if value not in (None, ""):
        return _single(field, value, folder)
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


def _single(field: Field[Any], value: Any, folder: Path) -> Any:
    how, name = field.metadata, field.name
    if is_path_field(field):
        return str(path_in(folder, value))
    if "ends" in how:
        return _convert_value(lambda text: si_range(text, how["unit"]), value, name)
    if "unit" in how:
        return quantity({name: value}, name, how["unit"])
    if "choices" in how:
        require_choice(name, value, how["choices"])
        return value
    if "least" in how:
        return arms_of(value)
    return number(value, name) if isinstance(field.default, float) else word({name: value}, name)


def parse_selection(selection: str) -> dict[str, Any]:
    """Return the reading options by which a specimen of a file is selected, from their words.

    >>> parse_selection("sheet=Seals, new,segment=2")
    {'sheet': 'Seals, new', 'segment': 2}
    """
    pairs = (word.partition("=") for word in re.split(r",(?=(?:sheet|segment)=)", selection))
    return {key: int(value) if key == "segment" else value for key, _, value in pairs if key}


def page_of(job: Job) -> dict[str, Any]:
    """Return the choices of a job as a page says them: what :func:`job_of` takes back exactly."""
    stated = convert_to_request(job)
    specimen = stated["specimen"]
    if "temperature" in specimen:
        stated["temperatures"] = [specimen.pop("temperature")]
    extras = ("joint", "temperatures", "reading", "reading_impact")
    return {name: stated.pop(name) for name in extras} | {"job": stated}


def convert_to_request(result: Any) -> dict[str, Any]:
    """Return a value as fields of a page, without its files and without its parts' defaults."""
    stated = {}
    for field in _fields(result):
        value = getattr(result, field.name)
        if "part" in field.metadata:
            stated[field.name] = _get_changed_fields(value)
        elif not is_path_field(field) and value not in (None, ""):
            stated[field.name] = _format_field(field, value)
    return stated


def _format_field(field: Field[Any], value: Any) -> Any:
    if "unit" not in field.metadata:
        return value
    texts = texts_of(field, value)
    return texts if isinstance(value, tuple) and "ends" not in field.metadata else texts[0]


def _get_changed_fields(result: Any) -> dict[str, Any]:
    """Return what a part of a job says that is not the default."""
    stated = {}
    for field in fields(result):
        value = getattr(result, field.name)
        if value == field.default:
            continue
        stated[field.name] = dict(value) if field.name == "units" else value
        if isinstance(result, Specimen | Machine):
            stated[field.name] = _format_field(field, value)
    return stated


def part(kind: type[T], provided: object, name: str) -> T:
    """Return a part of a job; a list is a tuple, and nothing is the default.

    Raises
    ------
    DataError
        If it has what the part does not, or a value of the wrong kind.
    """
    options = mapping(provided, name)
    strange = options.keys() - _names(kind)
    if strange:
        raise DataError(f"{name} has no '{min(strange)}'; it has {', '.join(sorted(_names(kind)))}")
    if options.get("calibration"):
        raise DataError("a page names no file beside those that it was given: no calibration")
    stated = {
        key: tuple(value) if isinstance(value, list) else value
        for key, value in options.items()
        if value not in (None, "")
    }
    return _convert_value(lambda them: kind(**them), stated, name)


def _fields(result: Any) -> tuple[Field[Any], ...]:
    return fields(result)


def _names(kind: Any) -> set[str]:
    return {field.name for field in _fields(kind)}


def sizes_of(request: Mapping[str, Any]) -> dict[str, tuple[float, float]]:
    """Return the width and height that the page has for each panel, px.

    Raises
    ------
    DataError
        If one is no pair of numbers.
    """
    sizes = {}
    for name, size in mapping(request.get("sizes", {}), "sizes").items():
        certain = isinstance(size, list) and len(size) == 2
        if not certain or not all(isinstance(item, (int, float)) for item in size):
            raise DataError(f"sizes: {name} = {size!r}; expected [width, height] in px")
        width, height = (min(max(float(value), 0.0), LARGEST) for value in size)
        sizes[name] = width, height
    return sizes


def deck_choices(request: Mapping[str, Any]) -> dict[str, Any]:
    """Return what a deck is asked for besides its target and its units; nothing of what is not.

    Raises
    ------
    DataError
        If a quantity is none.
    """
    band = request.get("range") or None
    return {
        "form": request.get("form") or None,
        "frequency_range": _convert_value(lambda text: si_range(text, "frequency"), band, "range"),
        "seals": number(request.get("seals", 1.0), "seals"),
        "compression": quantity(request, "compression", "length"),
        "modulus": quantity(request, "modulus", "stress"),
        "bulk_modulus": quantity(request, "bulk_modulus", "stress"),
        "mass": quantity(request, "mass", "mass"),
    }


def mapping(value: object, name: str) -> Mapping[str, Any]:
    """Return what must be an object.

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
    """Return what must be a list; nothing is an empty one."""
    provided = options.get(name, [])
    if not isinstance(provided, list):
        raise DataError(f"{name} is {type(provided).__name__}; expected a list")
    return provided


def quantity(options: Mapping[str, Any], name: str, dimension: Any) -> float | None:
    """Return a quantity that is typed with its unit, in SI; nothing is None."""
    value = options.get(name)
    if value in (None, ""):
        return None
    if not isinstance(value, str):
        raise DataError(f"{name} = {value!r}; expected a quantity with its unit, such as '104g'")
    return convert_to_si(value, dimension)


def number(provided: object, name: str) -> float:
    """Return what must be a number."""
    if isinstance(provided, bool) or not isinstance(provided, int | float):
        raise DataError(f"{name} = {provided!r}; expected a number")
    return float(provided)


def word(options: Mapping[str, Any], name: str) -> str:
    """Return what must be a text; nothing is an empty one."""
    value = options.get(name)
    if value is not None and not isinstance(value, str):
        raise DataError(f"{name} = {value!r}; expected a text")
    return value or ""


def arms_of(provided: object) -> Any:
    """Return a number of arms, or "auto".

    Raises
    ------
    DataError
        If it is neither.
    """
    if provided == "auto" or (
        isinstance(provided, int) and not isinstance(provided, bool) and provided >= 0
    ):
        return provided
    raise DataError(f"arms = {provided!r}; expected 'auto' or a whole number >= 0")
