"""dashpot map: complex stiffness over frequency, amplitude and compression."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from dashpot import workflow
from dashpot.cli import _options as options
from dashpot.cli._command import group, mark_advanced, opt, verb
from dashpot.cli._command_files import (
    PAGE_SUFFIXES,
    detect_file_kinds,
    get_file_kinds,
    print_detected_kinds,
)
from dashpot.cli._command_result import CommandResult, format_json, write_figure, write_output
from dashpot.cli._param_types import Range, Scoped, WithUnit

if TYPE_CHECKING:
    from dashpot.extensions.preload_map.preload_map import PreloadMap
    from dashpot.reading.read_options import ReadOptions

_DECKS = (".bdf", ".inp")
_SETTING = "Setting"


@verb(
    "map",
    """Map the complex stiffness of a part over frequency, amplitude and compression.

  dashpot map preload_map.csv --mass 104g --seals 2 -o map.html
  dashpot map c4.csv c6.csv c8.csv --compression c4.csv:4mm \\
      --compression c6.csv:6mm --compression c8.csv:8mm
  dashpot map map.json --unit-system mm-t-s -o seal.bdf

A table holds compression, amplitude, frequency, storage and loss. Without a
column of the compression, state it of each file. A saved map may stand for its
files.""",
    options.file_argument("FILE", "files"),
    group(
        _SETTING,
        opt("--compression", "compressions", type=Scoped(WithUnit("length")), multiple=True,
            metavar="LENGTH", help="Compression in a file, e.g. c4.csv:4mm."),
        opt("--amplitude", "amplitudes", type=Scoped(WithUnit("length")), multiple=True,
            metavar="AMPLITUDE", help="Amplitude in a file, e.g. 0.1mm for all."),
        opt("--band", type=Range("frequency"), metavar="RANGE",
            help="Frequencies, e.g. 1:40Hz (all)."),
        opt("--mass", type=WithUnit("mass"), metavar="MASS",
            help="Mass on the parts: its resonance, and that of hits."),
        opt("--seals", type=float, default=1.0, metavar="N",
            help="Parts in parallel under the mass (1)."),
        opt("--unit-system", "unit_system", metavar="SYSTEM",
            help="With .bdf or .inp: SI, mm-t-s, mm-kg-ms, in-lbf-s."),
        mark_advanced(
            opt("--repeatability", type=WithUnit("strain"), metavar="SHARE",
                help="Scatter of a setting reached anew, e.g. 0.3%."),
            opt("--gain-error", type=WithUnit("strain"), metavar="SHARE",
                help="Standard error of the sensors' ratio (1%)."),
            opt("--phase-error", type=WithUnit("angle"), metavar="ANGLE",
                help="Standard error of their phase (1deg)."),
        ),
    ),
    options.reading_options(),
    options.result_options(
        "Page .html, table .csv or .m, solver .bdf or .inp, .json.",
        ".html", ".htm", ".csv", ".json", ".bdf", ".inp", ".m",
    ),
)  # fmt: skip
def command(
    *,
    files: tuple[str, ...],
    picture: str | None,
    output: str | None,
    unit_system: str | None,
    options: ReadOptions,
    compressions: tuple[tuple[str, float], ...],
    amplitudes: tuple[tuple[str, float], ...],
    mass: float | None,
    seals: float,
    **choices: Any,
) -> CommandResult:
    """Return the map of files."""
    from dashpot.extensions.preload_map.fit import add_resonances, fit_preload_map
    from dashpot.extensions.preload_map.read import read_sweeps

    suffix = Path(output or "").suffix.lower()
    if (suffix in _DECKS) is not (unit_system is not None):
        raise click.UsageError(
            "a solver input needs its unit system: add --unit-system mm-t-s, SI, mm-kg-ms or "
            "in-lbf-s"
            if suffix in _DECKS
            else "--unit-system is for a solver input: add -o FILE.bdf or FILE.inp"
        )
    if mass is None and seals != 1.0:
        raise click.UsageError("--seals counts the parts under a mass: add --mass MASS")
    detections = detect_file_kinds(files, options)
    given_options = {name: value for name, value in choices.items() if value is not None}
    if any(detected.stored for detected in detections.values()):
        if compressions or amplitudes or given_options:
            raise click.UsageError(
                "a saved map is not fitted again: only --mass, --seals and outputs go with it"
            )
        preload_map = _read_map(files)
        preload_map = preload_map if mass is None else add_resonances(preload_map, mass, seals)
    else:
        get_file_kinds(detections, options)
        print_detected_kinds(detections)
        sweeps = read_sweeps(
            files, options=options, compressions=compressions, amplitudes=amplitudes, mass=mass,
            seals=seals,
        )  # fmt: skip
        preload_map = fit_preload_map(sweeps, mass=mass, seals=seals, **given_options)
    if picture:
        write_figure(picture, preload_map.plot())
    if output:
        write_output(output, _render(preload_map, suffix, unit_system))
    return CommandResult.from_result(preload_map)


def _read_map(files: tuple[str, ...]) -> PreloadMap:
    """Return the map that a command has saved.

    Raises
    ------
    click.UsageError
        If it is another result, or one of several files.
    """
    from dashpot.extensions.preload_map.preload_map import PreloadMap

    document = workflow.read_json_document(files[0])
    if len(files) > 1 or not isinstance(document, PreloadMap):
        raise click.UsageError(
            f"{files[0]} is a saved result. Give records of stiffness, or one map that "
            "dashpot map FILE -o map.json has saved"
        )
    return document


def _render(preload_map: PreloadMap, suffix: str, unit_system: str | None) -> str:
    """Return the content of an output file."""
    from dashpot.export.unit_systems import unit_system as find_unit_system
    from dashpot.extensions.preload_map import tables

    if suffix in PAGE_SUFFIXES:
        return workflow.html(preload_map)
    if suffix in _DECKS:
        render = tables.render_nastran if suffix == ".bdf" else tables.render_abaqus
        return render(preload_map, find_unit_system(unit_system))
    if suffix == ".m":
        return tables.render_matlab(preload_map)
    return tables.render_csv(preload_map) if suffix == ".csv" else format_json(preload_map) + "\n"
