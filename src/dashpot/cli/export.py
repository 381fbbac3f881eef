"""dashpot export: the solid as a deck that a solver reads."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import dashpot as dp
from dashpot import workflow
from dashpot.base import dataclass, fields, replace
from dashpot.base.errors import ExportError
from dashpot.base.plain_text import paragraph
from dashpot.base.serialisation import Key, Serialisable
from dashpot.cli import _options as options
from dashpot.cli._command import build_options, group, mark_advanced, opt, verb
from dashpot.cli._command_result import CommandResult, write_output
from dashpot.cli._param_types import DENSITY, ChoiceWithSuggestion, File, Range, WithUnit
from dashpot.cli._terminal import to_stderr
from dashpot.datamodel.specimen import Specimen
from dashpot.registry import (
    SOLVER_INPUTS,
    SOLVER_NAMES,
    call_handler,
    find_handler,
    list_names,
    require_handler,
)
from dashpot.text_output.layout import Text
from dashpot.workflow.job import Job

if TYPE_CHECKING:
    from dashpot.datamodel.seal_line import Shear, Stations


LONGEST_LINE = 100.0
"""m; no car has more of one seal."""


@dataclass(frozen=True)
class Exported(Serialisable):
    """Exported deck: target, units, overridden refusals, and its file or text."""

    schema = "dashpot/deck@1"
    _keys = ("target", "units", "file", "overrides", Key("deck", optional=True))

    target: str
    units: str | None
    overrides: tuple[str, ...]
    file: str | None
    deck: str | None


_SOLVER = "Solver"
_SOLVERS = tuple(SOLVER_INPUTS)
_FORM_HELP = "arms, table or prony, as the solver has it."
ALL_PROBLEMS = "all"
"""The word of ``--allow`` that overlooks every problem."""


@verb(
    "export",
    """Write a model or constitutive law as input for a solver.

  dashpot export joint.json --to nastran --unit-system mm-t-s \\
      --temperature 23degC --length 50mm --band 1:20Hz -o seal.bdf
  dashpot export law.json --to abaqus --unit-system mm-t-s --temperature 23degC""",
    options.file_argument("FIT", "fit", multiple=False),
    group(
        _SOLVER,
        opt("--to", "target", type=ChoiceWithSuggestion(
                _SOLVERS, plugins="solver_inputs", synonyms=SOLVER_NAMES),
            metavar="SOLVER",
            help=f"{', '.join(_SOLVERS[:-1])} or {_SOLVERS[-1]}."),
        opt("--unit-system", "units", metavar="SYSTEM", help="SI, mm-t-s, mm-kg-ms, in-lbf-s."),
        opt("--form", metavar="NAME", help=_FORM_HELP),
        opt("--band", "frequency_range", type=Range("frequency"), metavar="RANGE",
            help="Frequencies of a table (the valid band)."),
        build_options(Job, "seals", metavar="N"),
        opt("--compression", type=WithUnit("length"), metavar="LENGTH",
            help="Compression to linearise about."),
        opt("--allow", multiple=True, metavar="PROBLEM",
            help="Overlook a problem by its name, or all."),
        mark_advanced(
            opt("--tolerance", type=float, metavar="NUMBER",
                help="Largest relative error of a table, e.g. 1e-3."),
            opt("--mass", type=WithUnit("mass"), metavar="MASS",
                help="CalculiX, FMU: a model with this mass on it."),
            opt("--nominal", type=WithUnit("frequency"), metavar="FREQUENCY",
                help="Nastran, CalculiX: of one stiffness for modes."),
            opt("--line", type=File(), metavar="FILE",
                help="Seal line: x, y, z, or DOOR.toml."),
            opt("--pitch", type=WithUnit("length"), metavar="LENGTH",
                help="Mean distance of elements along the line."),
            opt("--first-id", type=click.IntRange(1), metavar="N",
                help="First number of nodes, elements and the rest."),
            opt("--normal", metavar="X,Y,Z", help="Direction of compression (0,0,1)."),
            opt("--modulus", type=WithUnit("stress"), metavar="STRESS",
                help="Modulus of the rubber, for material cards."),
            opt("--bulk-modulus", type=WithUnit("stress"), metavar="STRESS",
                help="Bulk modulus of the rubber, for material cards."),
            opt("--density", type=DENSITY, metavar="KG/M^3",
                help="Density of the rubber, for material cards."),
        ),
    ),
    *call_handler("option groups", "export", default=()),
    options.specimen_options(is_advanced=False),
    options.result_options("Solver input (printed).", plot=False, has_open_option=False,
                           default="-"),
)  # fmt: skip
def command(
    *,
    fit: str,
    target: str | None,
    units: str | None,
    line: str | None,
    pitch: float | None,
    normal: str | None,
    output: str,
    specimen: Specimen,
    **choices: Any,
) -> CommandResult:
    """Write the deck of a fit, or the card of a law."""
    from dashpot.solids.maxwell import Solid

    exported: Any = workflow.read_exported(fit)
    if isinstance(exported, dp.Fit):
        updated_specimen = _update_specimen(exported.specimen, specimen)
        exported = replace(
            exported, provenance=replace(exported.provenance, specimen=updated_specimen)
        )
    elif isinstance(exported, Solid):
        choices["specimen"] = specimen
    elif hasattr(exported, "specimen"):
        exported = replace(exported, specimen=_update_specimen(exported.specimen, specimen))
    if target is None:
        raise click.UsageError(_format_missing_options(exported, units, specimen, choices["allow"]))
    if line is None and choices["first_id"] is not None:
        raise click.UsageError("--first-id numbers the elements of a line: add --line FILE.")
    if line is not None:
        temperature = specimen.temperature
        choices["line"], choices["shear"] = _read_stations(line, pitch, normal, units, temperature)
    choices |= {"units": units, "temperature": specimen.temperature}
    exporters = (
        find_handler("export with option", name) for name in list_names("export with option")
    )
    option_results = (export(target, exported, output, choices) for export in exporters)
    option_result: CommandResult | None = next(filter(None, option_results), None)
    if option_result:
        return option_result
    deck = workflow.deck_for(target, exported, **choices)
    if output == "-" and not deck.printable:
        raise ExportError(
            f"the file of {target} is an archive, which is not printed; name it: -o FILE"
        )
    write_output(output, deck.file_content)
    for override in deck.overrides:
        to_stderr(f"OVERRIDE: {override}")
    file_and_deck = (None, deck) if output == "-" else (output, None)
    text = Text([f"{output}: {target} deck, {units}, {deck.summary}"])
    export_result = Exported(target, units, deck.overrides, *file_and_deck)
    return CommandResult(export_result, text, deck.checks, verdict=deck.verdict)


def _format_missing_options(
    result: Any, units: str | None, specimen: Specimen, allow: tuple[str, ...]
) -> str:
    """Return the message for a missing solver, with all other options that the deck needs."""
    solver_request = f"Name the solver: --to {', '.join(_SOLVERS[:-1])} or {_SOLVERS[-1]}."
    try:
        workflow.deck_for(
            "abaqus", result, units=units, temperature=specimen.temperature, allow=allow
        )
    except ExportError as error:
        return paragraph(solver_request, str(error))
    return solver_request


def _update_specimen(specimen: Specimen, user_specimen: Specimen) -> Specimen:
    """Return the specimen of a fit, completed by the options of this command."""
    new_values = {
        field.name: getattr(user_specimen, field.name)
        for field in fields(user_specimen)
        if field.name != _DECK_FIELD
    }
    return replace(specimen, **{name: value for name, value in new_values.items() if value})


_DECK_FIELD = "temperature"
"""Field of the specimen: what a deck is asked for, not what is added to the fit."""


def _parse_normal(text: str) -> tuple[float, float, float]:
    try:
        x, y, z = map(float, text.split(","))
    except ValueError:
        raise ExportError(f"--normal {text}: expected three numbers, such as 0,0,1") from None
    return x, y, z


def _read_stations(
    path: str,
    pitch: float | None,
    normal: str | None,
    units: str | None,
    temperature: float | None,
) -> tuple[Stations, Shear | None]:
    """Return the polyline in a CSV file of x, y, z in the deck's unit of length, or of a door."""
    import numpy as np

    unit_systems = workflow.UNIT_SYSTEMS
    if Path(path).suffix.lower() == ".toml":
        stations: tuple[Stations, Shear | None] = require_handler("stations", "door")(
            path, pitch, normal, temperature
        )
        return stations
    if pitch is None or units is None or units not in unit_systems:
        raise ExportError("--line needs --pitch, e.g. 25mm, and --unit-system")
    try:
        points = np.genfromtxt(path, delimiter=",", comments="#", dtype=float, ndmin=2)
    except ValueError as error:
        raise ExportError(f"{path}: {error}; expected three columns x, y, z") from None
    if points.shape[1] < 3:
        raise ExportError(f"{path} has {points.shape[1]} columns; expected x, y, z")
    has_header = bool(np.isnan(points[0, :3]).any())  # a first row of names reads as NaN
    points_in_metres = points[1 if has_header else 0 :, :3] * unit_systems[units].length
    line = dp.systems.SealLine(points_in_metres, normal=np.array(_parse_normal(normal or "0,0,1")))
    if line.length > LONGEST_LINE:
        raise ExportError(
            f"{path}: the line is {line.length:.4g} m long in the deck's unit of length ({units}): "
            "write its points in that unit, or choose the --unit-system they are in"
        )
    return line.stations(pitch), None
