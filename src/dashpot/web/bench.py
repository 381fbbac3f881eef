"""Tests that the page fits by themselves: sweeps, master curves, moduli over time, creep."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal

from dashpot import plot
from dashpot.base.progress import doing
from dashpot.base.units import si
from dashpot.io.options import ReadOptions
from dashpot.io.readers.inspect import inspect_file
from dashpot.kinds import KINDS
from dashpot.plot.picture import Picture
from dashpot.records.fit import Fit
from dashpot.report.pages import COLOURS
from dashpot.web import views, wire
from dashpot.web.requests import arms_of, part, sizes_of
from dashpot.web.store import path_in
from dashpot.workflow.archive import to_json
from dashpot.workflow.command_lines import fit_command
from dashpot.workflow.fits import fit_files

WIDE = (800.0, 0.0)
"""Room for the figures where the page says nothing, px."""
KEPT = 4
"""Fits that a worker remembers."""


@lru_cache(KEPT)
def _fitted(
    path: str, options: ReadOptions, arms: int | Literal["auto"], temperature: float | None
) -> tuple[Fit, Picture]:
    """The fit of a file, and its figure."""
    doing(f"fitting {Path(path).name}")
    known = () if temperature is None else (temperature,)
    found, records = fit_files([path], arms=arms, temperatures=known, options=options)
    return found, plot.bench(found, records)


def _asked(request: Mapping[str, Any], folder: Path) -> tuple[Any, ...]:
    """File, options, arms and temperature of a request; a column that must be named is."""
    path = str(path_in(folder, request.get("file")))
    options = part(ReadOptions, request.get("options", {}), "options")
    found = inspect_file(path, options=options)
    column = KINDS[found.kind].column if found.kind in KINDS else ""
    playing = [one for one in found.columns if one.role == column]
    if playing and getattr(options, column) is None:
        named: dict[str, Any] = {column: playing[0].name or str(playing[0].number)}
        options = replace(options, **named)
    warmth = request.get("temperature") or None
    return path, options, arms_of(request.get("arms", "auto")), si(warmth, "temperature")


def bench(request: Mapping[str, Any], folder: Path) -> bytes:
    """The fit of one such file: verdict, solid, checks, figures, and the command that gives it."""
    path, options, arms, temperature = asked = _asked(request, folder)
    found, picture = _fitted(*asked)
    return wire.packed(
        {
            "verdict": views.verdict(found.verdict),
            "colour": COLOURS[found.verdict.use],
            "solid": views.solid_table(found),
            "arms": found.model.arms,
            "checks": views.check_list(found.checks),
            "figures": views.bench_panels(picture, sizes_of(request).get("bench", WIDE)[0]),
            "simulated": any(source.simulated for source in found.source),
            "command": fit_command(Path(path).name, options, arms=arms, temperature=temperature),
        }
    )


def take_bench(request: Mapping[str, Any], folder: Path) -> bytes:
    """The fit as its JSON, as ``dashpot fit --json`` prints it."""
    found, _ = _fitted(*_asked(request, folder))
    return wire.packed({"name": "fit.json", "kind": "application/json", "text": to_json(found)})
