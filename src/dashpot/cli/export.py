"""dashpot export: the solid as a deck that a solver reads."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import click

import dashpot as dp
from dashpot import workflow
from dashpot.base.choices import DECKS
from dashpot.base.documents import Documented
from dashpot.base.errors import ExportError
from dashpot.cli import _options as options
from dashpot.cli._echo import to_stderr
from dashpot.cli._options import Range, WithUnit
from dashpot.cli._shell import File, Outcome, reports, write
from dashpot.cli._terminal import Text
from dashpot.kinds.level.levels import LevelFit
from dashpot.records.seal_line import Stations
from dashpot.records.specimen import Specimen
from dashpot.workflow.job import Job

LONGEST_LINE = 100.0
"""m; no car has more of one seal."""


@dataclass(frozen=True)
class Exported(Documented):
    """A deck: for what, in which units, which refusals were overridden, its file, or its text."""

    schema = "dashpot/deck@1"
    keys = ("target", "units", "file", "overrides", "deck?")

    target: str
    units: str | None
    overrides: tuple[str, ...]
    file: str | None
    deck: str | None


@click.command("export")
@click.argument("fit", type=File())
@click.option("--to", "target", type=click.Choice(DECKS), required=True)
@click.option("--units", metavar="SI|mm-t-s|mm-kg-ms", help="The deck's unit system; required.")
@click.option("--form", help="E.g. arms, table, prony; each target has its own.")
@click.option("--range", "frequency_range", type=Range("frequency"), help="Of a table, 1:100Hz.")
@click.option("--tolerance", type=float, help="Largest relative FRF error of a table, e.g. 1e-3.")
@click.option("--mass", type=WithUnit("mass"), help="CalculiX: a complete deck with this mass.")
@click.option(
    "--line",
    type=File(),
    metavar="FILE",
    help="Nastran: seal line, CSV with x, y, z columns in units; or DOOR.toml with [seal].",
)
@click.option("--pitch", type=WithUnit("length"), help="Distance of elements along the line.")
@click.option(
    "--normal", metavar="X,Y,Z", help="Direction of compression along it [default: 0,0,1]."
)
@click.option("--modulus", type=WithUnit("stress"), help="Of the rubber, for material cards.")
@click.option("--bulk-modulus", type=WithUnit("stress"), help="Of the rubber, for material cards.")
@click.option("--density", type=float, help="Of the rubber, kg/m^3, for material cards.")
@options.of(Job, "seals")
@click.option(
    "--compression",
    type=WithUnit("length"),
    help="Small vibration about it: the tangent there, e.g. 2.6mm [default: the secant].",
)
@click.option("--allow", multiple=True, metavar="PROBLEM", help="Overlook one named problem.")
@click.option(
    "--force",
    is_flag=True,
    help="Overlook every problem, with a mark in the deck; replace any file.",
)
@options.output("The deck [default: stdout].", default="-")
@options.overwrite
@reports
@options.specimen
def command(
    *,
    fit: str,
    target: str,
    units: str | None,
    line: str | None,
    pitch: float | None,
    normal: str | None,
    seals: float,
    compression: float | None,
    allow: tuple[str, ...],
    force: bool,
    output: str,
    specimen: Specimen,
    **choices: Any,
) -> Outcome:
    """Write the solid of FIT (a fit's JSON file) as a deck, or a hyperelastic law as a card.

    What FRFs at several levels tell (dashpot level FRF... --json > level.json) is written with its
    sliders and its cubic spring, for the solvers that hold such.

    A deck is refused if temperature, contact length or units are not stated, or if the data do
    not determine a parameter; --force writes it all the same and says so in its header. Of tests
    at several temperatures, --temperature asks for the solid there.

    \b
    dashpot export fit.json --to nastran --units mm-t-s --temperature 23degC --length 100mm
    dashpot export fit.json --to calculix --units mm-t-s --mass 104g --seals 2 --force -o seal.inp
    dashpot export level.json --to opensees --units SI --temperature 23degC --length 100mm
    """
    found = workflow.read_exported(fit)
    if isinstance(found, dp.Fit):
        added = _described(found.specimen, specimen)
        found = replace(found, provenance=replace(found.provenance, specimen=added))
    elif isinstance(found, LevelFit):
        found = replace(found, specimen=_described(found.specimen, specimen))
    choices["line"] = None if line is None else _seal_line(line, pitch, normal, units)
    deck = dp.export.deck_for(
        target,
        found,
        seals=seals,
        compression=compression,
        units=units,
        temperature=specimen.temperature,
        allow=("all",) if force else allow,
        **choices,
    )
    write(output, deck)
    for mark in deck.overrides:
        to_stderr(f"OVERRIDE: {mark}")
    written = (None, deck) if output == "-" else (output, None)
    text = Text([f"{output}: {target} deck, {units}, {len(deck.splitlines())} lines"])
    made = Exported(target, units, deck.overrides, *written)
    return Outcome(made, text, deck.checks, verdict=deck.verdict)


def _described(known: Specimen, given: Specimen) -> Specimen:
    """Return what a fit knows of its specimen with what the user adds now."""
    news = {one.name: getattr(given, one.name) for one in fields(given) if one.name != _ASKED}
    return replace(known, **{name: value for name, value in news.items() if value})


_ASKED = "temperature"
"""Of the specimen: what a deck is asked for, not what is added to the fit."""


def _line_of_door(path: str, pitch: float | None, normal: str | None) -> Stations:
    """Return the stations of a door's seal, with its own compression, joints and normals."""
    door = dp.read_door(path)
    if door.line is None or door.seal is None or normal is not None:
        raise ExportError(
            f"{path}: --normal is for a file of points; the [seal] of a door says its own"
            if normal is not None
            else f"{path}: no [seal] is in it"
        )
    wanted = pitch or door.seal.pitch
    if wanted is None:
        raise ExportError(f"{path}: [seal] says no pitch; add --pitch, e.g. 25mm")
    return door.line.stations(wanted)


def _normal(text: str) -> tuple[float, float, float]:
    try:
        x, y, z = map(float, text.split(","))
    except ValueError:
        raise ExportError(f"--normal {text}: expected three numbers, such as 0,0,1") from None
    return x, y, z


def _seal_line(path: str, pitch: float | None, normal: str | None, units: str | None) -> Stations:
    """Return the polyline in a CSV file of x, y, z in the deck's unit of length."""
    import numpy as np

    systems = dp.export.UNIT_SYSTEMS
    if Path(path).suffix.lower() == ".toml":
        return _line_of_door(path, pitch, normal)
    if pitch is None or units is None or units not in systems:
        raise ExportError("--line needs --pitch, e.g. 25mm, and --units")
    try:
        points = np.genfromtxt(path, delimiter=",", comments="#", dtype=float, ndmin=2)
    except ValueError as error:
        raise ExportError(f"{path}: {error}; expected three columns x, y, z") from None
    if points.shape[1] < 3:
        raise ExportError(f"{path} has {points.shape[1]} columns; expected x, y, z")
    named = bool(np.isnan(points[0, :3]).any())  # a first row of names reads as NaN
    corners = points[1 if named else 0 :, :3] * systems[units].length
    line = dp.SealLine(corners, normal=np.array(_normal(normal or "0,0,1")))
    if line.length > LONGEST_LINE:
        raise ExportError(
            f"{path}: the line is {line.length:.4g} m long in the deck's unit of length ({units}): "
            "write its points in that unit, or choose the --units they are in"
        )
    return line.stations(pitch)
