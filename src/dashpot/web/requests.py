"""What a page says, as the nouns of the work: every control is a field of a `Job`."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any, TypeVar

from dashpot.base.errors import DashpotError, DataError
from dashpot.base.units import si, si_range, typed
from dashpot.io.options import ReadOptions
from dashpot.records.machine import Machine
from dashpot.records.specimen import Specimen
from dashpot.web.store import path_in
from dashpot.workflow.job import Cuts, HammerChoices, Job

T = TypeVar("T")

_PARTS: dict[str, type] = {
    "cuts": Cuts, "specimen": Specimen, "machine": Machine, "hammer": HammerChoices,
    "reading": ReadOptions, "reading_impact": ReadOptions,
}  # fmt: skip
_CHOICES = {
    "method": ("full", "hold"), "law": ("auto", "linear", "nonlinear"),
    "family": ("maxwell", "fractional", "auto"),
}  # fmt: skip
_TEXTS = ("title", "filter")
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
    made: dict[str, Any] = {
        "relaxation": str(path_in(folder, asked["relaxation"])),
        **{
            name: tuple(str(path_in(folder, one)) for one in listed(asked, name))
            for name in ("impact", "further")
        },
        "temperatures": _temperatures(listed(asked, "temperatures")),
        "mass": quantity(asked, "mass", "mass"),
        "seal_mass": quantity(asked, "seal_mass", "mass"),
        "compression": quantity(asked, "compression", "length"),
        "seals": number(asked.get("seals", 1.0), "seals"),
        "arms": arms_of(asked.get("arms", "auto")),
        "joint": asked.get("joint", True) is True,
        "band": _made(lambda text: si_range(text, "frequency"), asked.get("band") or None, "band"),
    }
    for name, kind in _PARTS.items():
        made[name] = part(kind, asked.get(name, {}), name)
    for name, choices in _CHOICES.items():
        made[name] = choice(asked, name, choices)
    made |= {name: text for name in _TEXTS if (text := word(asked, name))}
    return Job(**made)


def page_of(job: Job) -> dict[str, Any]:
    """Return the choices of a job as a page says them: what :func:`job_of` takes back exactly."""
    quantities = (("mass", "mass"), ("seal_mass", "mass"), ("compression", "length"))
    said: dict[str, Any] = {
        name: typed(value, dimension)  # type: ignore[arg-type]
        for name, dimension in quantities
        if (value := getattr(job, name)) is not None
    }
    said |= {name: getattr(job, name) for name in ("seals", "arms", *_CHOICES)}
    said |= {name: getattr(job, name) for name in _TEXTS if getattr(job, name)}
    if job.band is not None:
        said["band"] = f"{job.band[0]!r}:{typed(job.band[1], 'frequency')}"
    said |= {name: _stated(getattr(job, name)) for name in ("cuts", "machine", "hammer")}
    specimen = _stated(job.specimen)
    warmth = [typed(one, "temperature") for one in job.temperatures]
    if "temperature" in specimen:
        warmth = [specimen.pop("temperature")]
    return {
        "job": said | {"specimen": specimen}, "joint": job.joint, "temperatures": warmth,
        "reading": _stated(job.reading), "reading_impact": _stated(job.reading_impact),
    }  # fmt: skip


def _stated(noun: Any) -> dict[str, Any]:
    """What a part of a job says that is not the default, as a page says it."""
    said = {}
    for one in fields(noun):
        value = getattr(noun, one.name)
        if value == one.default or (one.default_factory is not MISSING and not value):
            continue
        if isinstance(noun, Specimen) and "unit" in one.metadata:
            value = typed(value, one.metadata["unit"])
        said[one.name] = dict(value) if one.name == "units" else value
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
    return _made(lambda them: kind(**them), stated, name)


def _names(kind: Any) -> set[str]:
    return {one.name for one in fields(kind)}


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
        "frequency_range": _made(lambda text: si_range(text, "frequency"), band, "range"),
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


def _made(make: Callable[[Any], T], given: Any, name: str) -> T:
    try:
        return make(given)
    except DashpotError:
        raise
    except (TypeError, ValueError, AttributeError):
        raise DataError(f"{name} = {given!r} is not of the kind expected") from None


def listed(asked: Mapping[str, Any], name: str) -> list[Any]:
    """Return what must be a list; nothing is an empty one."""
    given = asked.get(name, [])
    if not isinstance(given, list):
        raise DataError(f"{name} is {type(given).__name__}; expected a list")
    return given


def _temperatures(given: list[Any]) -> tuple[float, ...]:
    if "" in given:
        raise DataError(
            f"{given.count('')} of {len(given)} tests that are fitted together has no "
            "temperature: give every one its own, or none"
        )
    return tuple(_made(lambda text: si(text, "temperature"), one, "temperature") for one in given)


def quantity(asked: Mapping[str, Any], name: str, dimension: Any) -> float | None:
    """Return a quantity that is typed with its unit, in SI; nothing is None."""
    given = asked.get(name)
    if given in (None, ""):
        return None
    if not isinstance(given, str):
        raise DataError(f"{name} = {given!r}; expected a quantity with its unit, such as '104g'")
    return si(given, dimension)


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


def choice(asked: Mapping[str, Any], name: str, choices: Sequence[str]) -> Any:
    """Return what must be one of a few words; nothing is the first."""
    given = asked.get(name, choices[0])
    if given not in choices:
        raise DataError(f"{name} = {given!r}; expected one of {', '.join(choices)}")
    return given


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
