"""Tests in which amplitude was varied, that the page fits: sweeps, loops, FRFs at levels."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

from dashpot import plot
from dashpot.base.errors import DataError
from dashpot.base.progress import doing
from dashpot.base.units import si
from dashpot.io.options import ReadOptions
from dashpot.kinds.level.laws import LAWS
from dashpot.plot.picture import Picture
from dashpot.report.level import beyond, document, numbers
from dashpot.report.pages import COLOURS
from dashpot.web import views, wire
from dashpot.web.bench import KEPT, WIDE
from dashpot.web.requests import choice, listed, number, part, quantity, sizes_of
from dashpot.web.store import path_in
from dashpot.workflow.command_lines import level_command
from dashpot.workflow.levels import Levels, level_files


class _LevelArguments(NamedTuple):
    """What decides a fit: what `level_files` takes."""

    files: tuple[str, ...]
    options: ReadOptions
    levels: tuple[str, ...]
    mass: float | None
    seals: float
    at: tuple[float, ...]
    law: str


@lru_cache(KEPT)
def _fitted(asked: _LevelArguments) -> tuple[Levels, Picture]:
    """The fit of these files, and its figure."""
    doing(f"fitting {', '.join(Path(path).name for path in asked.files)}")
    how = asked._asdict()
    found = level_files(how.pop("files"), **how)
    return found, plot.level(found.fit, found.records)


def _asked(request: Mapping[str, Any], folder: Path) -> _LevelArguments:
    """The request; a mass and seals are of FRFs alone, each of which has its level."""
    levels = tuple(map(str, listed(request, "levels")))
    mass = quantity(request, "mass", "mass") if levels else None
    if levels and mass is None:
        raise DataError("no mass is given: say what rests on the seals, such as 104 g")
    return _LevelArguments(
        tuple(str(path_in(folder, one)) for one in listed(request, "files")),
        part(ReadOptions, request.get("options", {}), "options"),
        levels,
        mass,
        number(request.get("seals", 1.0), "seals") if levels else 1.0,
        tuple(si(str(one), "force") for one in listed(request, "at")) if levels else (),
        choice(request, "law", ("auto", *LAWS)) if not levels else "auto",
    )


def level(request: Mapping[str, Any], folder: Path) -> bytes:
    """The fit of such files: verdict, numbers, checks, figures, and the command that gives it."""
    asked = _asked(request, folder)
    found, picture = _fitted(asked)
    rows = [views.term(one) for one in numbers(found)]
    how = asked._asdict()
    names = [Path(path).name for path in how.pop("files")]
    return wire.packed(
        {
            "verdict": views.verdict(found.verdict),
            "colour": COLOURS[found.verdict.use],
            "solid": views.term_table("What amplitude does", rows, beyond(found)),
            "arms": "",
            "checks": views.check_list(found.checks),
            "figures": views.bench_panels(picture, sizes_of(request).get("bench", WIDE)[0]),
            "simulated": any(source.simulated for source in found.source),
            "command": level_command(names, **how),
        }
    )


def take_level(request: Mapping[str, Any], folder: Path) -> bytes:
    """The fit as its JSON, as ``dashpot level --json`` prints it."""
    found, _ = _fitted(_asked(request, folder))
    text = document(found)
    return wire.packed({"name": "levels.json", "kind": "application/json", "text": text})
