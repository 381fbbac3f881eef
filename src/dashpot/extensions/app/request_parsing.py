"""What a page says, as the nouns of the work: every control is a field of a `Job`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import Field, fields
from pathlib import Path
from typing import Any, TypeVar

from dashpot.base.choices import require_choice
from dashpot.base.errors import DashpotError, DataError
from dashpot.base.option_fields import is_path_field, texts_of
from dashpot.base.units import convert_to_si, si_range
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.app.upload_store import path_in
from dashpot.workflow.job import Job

T = TypeVar("T")

LARGEST = 8000.0
"""Of a drawing, px: no screen has more."""


def job_of(given: object, folder: Path) -> Job:
    """Return the job that a page asks for: quantities as texts, files by identity.

    Raises
    ------
    DataError
        If anything in it is not of a job, or not of its kind.
    ReadError
        If a file is no longer there.
    """
    asked = mapping(given, "job")
    strange = asked.keys() - _names(Job)
    if strange:
        raise DataError(f"a job has no '{min(strange)}'")
    if not asked.get("relaxation"):
        raise DataError("no relaxation test is open: open one first")
    warmth = get_list(asked, "temperatures")
    if "" in warmth:
        raise DataError(
            f"{warmth.count('')} of {len(warmth)} tests that are fitted together has no "
            "temperature: give every one its own, or none"
        )
    return build_from_request(Job, asked, folder)


def build_from_request(kind: type[T], asked: Mapping[str, Any], folder: Path) -> T:
    """Return a noun whose fields are declared options, of what a page says of them.

    Raises
    ------
    DataError
        If a value is of the wrong kind.
    ReadError
        If a file is no longer there.
    """
    said = [one for one in _fields(kind) if one.name in asked]
    return kind(**{one.name: _value(one, asked, folder) for one in said})


def _value(one: Field[Any], asked: Mapping[str, Any], folder: Path) -> Any:
    """What a field is, by what a page says: nothing, or an empty text, is the default."""
    how, name, given = one.metadata, one.name, asked[one.name]
    if "part" in how:
        return part(how["part"], given, name)
    if isinstance(one.default, tuple):
        return tuple(_single(one, each, folder) for each in get_list(asked, name))
    if isinstance(one.default, bool):
        return given is True
    return one.default if given in (None, "") else _single(one, given, folder)


def _single(one: Field[Any], given: Any, folder: Path) -> Any:
    how, name = one.metadata, one.name
    if is_path_field(one):
        return str(path_in(folder, given))
    if "ends" in how:
        return _convert_value(lambda text: si_range(text, how["unit"]), given, name)
    if "unit" in how:
        return quantity({name: given}, name, how["unit"])
    if "choices" in how:
        require_choice(name, given, how["choices"])
        return given
    if "least" in how:
        return arms_of(given)
    return number(given, name) if isinstance(one.default, float) else word({name: given}, name)


def page_of(job: Job) -> dict[str, Any]:
    """Return the choices of a job as a page says them: what :func:`job_of` takes back exactly."""
    said = convert_to_request(job)
    specimen = said["specimen"]
    if "temperature" in specimen:
        said["temperatures"] = [specimen.pop("temperature")]
    beside = ("joint", "temperatures", "reading", "reading_impact")
    return {name: said.pop(name) for name in beside} | {"job": said}


def convert_to_request(noun: Any) -> dict[str, Any]:
    """Return what a noun says as a page says it, but for its files; of its parts no default."""
    said = {}
    for one in _fields(noun):
        value = getattr(noun, one.name)
        if "part" in one.metadata:
            said[one.name] = _get_changed_fields(value)
        elif not is_path_field(one) and value not in (None, ""):
            said[one.name] = _format_field(one, value)
    return said


def _format_field(one: Field[Any], value: Any) -> Any:
    if "unit" not in one.metadata:
        return value
    texts = texts_of(one, value)
    return texts if isinstance(value, tuple) and "ends" not in one.metadata else texts[0]


def _get_changed_fields(noun: Any) -> dict[str, Any]:
    """What a part of a job says that is not the default."""
    said = {}
    for one in fields(noun):
        value = getattr(noun, one.name)
        if value == one.default:
            continue
        said[one.name] = dict(value) if one.name == "units" else value
        if isinstance(noun, Specimen):
            said[one.name] = _format_field(one, value)
    return said


def part(kind: type[T], given: object, name: str) -> T:
    """Return a part of a job; a list is a tuple, and nothing is the default.

    Raises
    ------
    DataError
        If it has what the part does not, or a value of the wrong kind.
    """
    asked = mapping(given, name)
    strange = asked.keys() - _names(kind)
    if strange:
        raise DataError(f"{name} has no '{min(strange)}'; it has {', '.join(sorted(_names(kind)))}")
    if asked.get("calibration"):
        raise DataError("a page names no file beside those that it was given: no calibration")
    stated = {
        key: tuple(value) if isinstance(value, list) else value
        for key, value in asked.items()
        if value not in (None, "")
    }
    return _convert_value(lambda them: kind(**them), stated, name)


def _fields(noun: Any) -> tuple[Field[Any], ...]:
    return fields(noun)


def _names(kind: Any) -> set[str]:
    return {one.name for one in _fields(kind)}


def sizes_of(request: Mapping[str, Any]) -> dict[str, tuple[float, float]]:
    """Return width and height of each panel as the page has room for them, px.

    Raises
    ------
    DataError
        If one is no pair of numbers.
    """
    sizes = {}
    for name, size in mapping(request.get("sizes", {}), "sizes").items():
        known = isinstance(size, list) and len(size) == 2
        if not known or not all(isinstance(one, (int, float)) for one in size):
            raise DataError(f"sizes: {name} = {size!r}; expected [width, height] in px")
        width, height = (min(max(float(one), 0.0), LARGEST) for one in size)
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


def mapping(given: object, name: str) -> Mapping[str, Any]:
    """Return what must be an object.

    Raises
    ------
    DataError
        If it is not.
    """
    if not isinstance(given, Mapping):
        raise DataError(f"{name} is {type(given).__name__}; expected an object")
    return given


def _convert_value(make: Callable[[Any], T], given: Any, name: str) -> T:
    try:
        return make(given)
    except DashpotError:
        raise
    except (TypeError, ValueError, AttributeError):
        raise DataError(f"{name} = {given!r} is not of the kind expected") from None


def get_list(asked: Mapping[str, Any], name: str) -> list[Any]:
    """Return what must be a list; nothing is an empty one."""
    given = asked.get(name, [])
    if not isinstance(given, list):
        raise DataError(f"{name} is {type(given).__name__}; expected a list")
    return given


def quantity(asked: Mapping[str, Any], name: str, dimension: Any) -> float | None:
    """Return a quantity that is typed with its unit, in SI; nothing is None."""
    given = asked.get(name)
    if given in (None, ""):
        return None
    if not isinstance(given, str):
        raise DataError(f"{name} = {given!r}; expected a quantity with its unit, such as '104g'")
    return convert_to_si(given, dimension)


def number(given: object, name: str) -> float:
    """Return what must be a number."""
    if isinstance(given, bool) or not isinstance(given, int | float):
        raise DataError(f"{name} = {given!r}; expected a number")
    return float(given)


def word(asked: Mapping[str, Any], name: str) -> str:
    """Return what must be a text; nothing is an empty one."""
    given = asked.get(name)
    if given is not None and not isinstance(given, str):
        raise DataError(f"{name} = {given!r}; expected a text")
    return given or ""


def arms_of(given: object) -> Any:
    """Return a number of arms, or "auto".

    Raises
    ------
    DataError
        If it is neither.
    """
    if given == "auto" or (isinstance(given, int) and not isinstance(given, bool) and given >= 0):
        return given
    raise DataError(f"arms = {given!r}; expected 'auto' or a whole number >= 0")
