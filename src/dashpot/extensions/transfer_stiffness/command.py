"""dashpot stiffness: dynamic transfer stiffness of a mount."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from dashpot import workflow
from dashpot.cli import _options as options
from dashpot.cli._command import group, mark_advanced, opt, refuse_options, verb
from dashpot.cli._command_files import (
    PAGE_SUFFIXES,
    detect_file_kinds,
    get_file_kinds,
    print_detected_kinds,
)
from dashpot.cli._command_result import CommandResult, format_json, write_figure, write_output
from dashpot.cli._param_types import File, Range, WithUnit
from dashpot.reading.columns.file_kinds import get_kind_command, get_kind_label
from dashpot.registry import KINDS, list_names, load_object, require_handler

if TYPE_CHECKING:
    from dashpot.datamodel.frf import FRF
    from dashpot.extensions.transfer_stiffness.stiffness_sheet import TransferStiffness
    from dashpot.reading.read_options import ReadOptions

_FIT, _FRF, _BASE = "fit", "frf", "transmissibility"
_SWEEP_KINDS = " ".join(
    name
    for name, kind in KINDS.items()
    if not set(kind.classes).isdisjoint(list_names("dynamic stiffness"))
)
"""Kinds of sweeps of storage and loss."""
_MODEL_ROUTES = {"bench", "hits"}
"""Fits that give a viscoelastic model, which has a stiffness over frequency."""
_MEASURED_KINDS = f"{_FRF} {_BASE} {_SWEEP_KINDS}"


@verb(
    "stiffness",
    """Transfer stiffness of a mount over frequency, as ISO 10846 reports it.

  dashpot stiffness force_over_motion.csv -o sheet.html
  dashpot stiffness transmissibility.csv --mass 5kg -o sheet.csv
  dashpot stiffness fit.json --seals 2 --band 3:40Hz --mass 5kg

A force over a motion is the direct method, a transmissibility with the mass on
the mount the indirect one. Of a fit, --mass shows what an indirect test would
give.""",
    options.file_argument("FRF|FIT", "path", multiple=False),
    group(
        "Mount",
        opt("--mass", type=WithUnit("mass"), metavar="MASS", kinds=f"{_BASE} {_FIT}",
            help="Blocking mass on the output, e.g. 5kg."),
        opt("--flange-mass", type=WithUnit("mass"), default=0.0, metavar="MASS",
            help="Mass of the output flange (0)."),
        opt("--seals", type=float, default=1.0, metavar="N", kinds=_FIT,
            help="Parts in parallel that are one mount (1)."),
        opt("--band", type=Range("frequency"), metavar="RANGE",
            help="Frequencies, e.g. 3:40Hz (all; of a fit 1:100Hz)."),
        opt("--exact", kinds=_MEASURED_KINDS,
            help="Formula with the motion of the output, T/(T-1)."),
        opt("--record", "records", type=File(), multiple=True, metavar="FILE", kinds=_FIT,
            help="The record behind the fit: limits with unresolved arms."),
        mark_advanced(
            opt("--output-response", "output_response", type=File(), metavar="FILE",
                kinds=f"{_FRF} {_SWEEP_KINDS}",
                help="Transmissibility to the output of a direct test."),
            opt("--gain-error", type=WithUnit("strain"), metavar="SHARE",
                kinds=_MEASURED_KINDS, help="Standard error of the sensors' ratio (1%)."),
            opt("--phase-error", type=WithUnit("angle"), metavar="ANGLE",
                kinds=_MEASURED_KINDS, help="Standard error of their phase (1deg)."),
            opt("--mass-error", type=WithUnit("mass"), metavar="MASS", kinds=_BASE,
                help="Standard error of the blocking mass (1 % of it)."),
            opt("--rigid-to", type=WithUnit("frequency"), metavar="FREQUENCY",
                help="Up to which mass and foundation are rigid."),
            opt("--preload", type=WithUnit("force"), metavar="FORCE",
                help="Static preload, which the sheet states."),
            opt("--temperature", type=WithUnit("temperature"), metavar="TEMPERATURE",
                help="Temperature; of a fit, it is shifted there."),
            opt("--compression", type=WithUnit("length"), metavar="LENGTH", kinds=_FIT,
                help="Compression at which the tangent is taken."),
            options.relative_motion_option(_BASE),
        ),
    ),
    options.reading_options(),
    options.result_options(
        "Page .html, third octaves .csv, document .json.", ".html", ".htm", ".csv", ".json"
    ),
    group(options.RESULT, mark_advanced(opt("--lines", help="With -o FILE.csv: the lines."))),
)  # fmt: skip
def command(
    *,
    path: str,
    picture: str | None,
    output: str | None,
    lines: bool,
    options: ReadOptions,
    hammer: Any,
    output_response: str | None,
    records: tuple[str, ...],
    **choices: Any,
) -> CommandResult:
    """Return the sheet of a measurement or of a fit."""
    from dashpot.extensions.transfer_stiffness.transfer_methods import compute_transfer_stiffness
    from dashpot.reading.readers.frf import read_frf
    from dashpot.workflow.bench_tests import prepared_files

    if lines and not (output or "").lower().endswith(".csv"):
        raise click.UsageError("--lines is for a table of the lines: add -o FILE.csv")
    detections = detect_file_kinds([path], options)
    kind = get_file_kinds(detections, options)[path]
    is_on_base = options.base_acceleration is not None
    kind = _BASE if is_on_base else kind
    choices = {name: value for name, value in choices.items() if value is not None}
    refuse_options(command, click.get_current_context(), {path: kind})
    if kind == _FIT:
        tests = prepared_files(records, options=options) if records else ()
        sheet = compute_transfer_stiffness(workflow.read_fit(path), record=tests, **choices)
    else:
        print_detected_kinds(detections)
        measured = _read_frf(path, kind, options, hammer, mass=choices.get("mass"))
        response = None if output_response is None else read_frf(output_response, options=options)
        sheet = compute_transfer_stiffness(measured, output_response=response, **choices)
    if picture:
        write_figure(picture, sheet.plot())
    if output:
        write_output(output, _render_output(sheet, output, lines=lines))
    return CommandResult.from_result(sheet)


def _read_frf(
    path: str, kind: str, options: ReadOptions, hammer: Any, *, mass: float | None
) -> FRF:
    """Return the FRF of the measured file.

    Raises
    ------
    click.UsageError
        If it is no such measurement.
    """
    from dashpot.base.plain_text import sentence
    from dashpot.reading.readers.frf import read_frf
    from dashpot.workflow.measured_frf import as_measured

    if options.base_acceleration is not None:
        test = require_handler("read several", "shaken base")([path], options=options)
        frf: FRF = require_handler("estimate frf", test)(
            test, choices=hammer, mass=mass, band=None
        )[0]
        return frf
    if kind in {_FRF, _BASE}:
        return as_measured(read_frf(path, options=options), hammer.motion)
    if kind in _SWEEP_KINDS.split():
        sweep = load_object(KINDS[kind].reader)(path, options=options)
        response: FRF = require_handler("dynamic stiffness", sweep)(sweep)
        return response
    route = KINDS[kind].fit_route if kind in KINDS else ""
    if route in _MODEL_ROUTES:
        advice = "fit it first: dashpot fit"
    else:
        advice = "its fit has no stiffness over frequency" if route else get_kind_command(kind)
    raise click.UsageError(
        f"{path} is {get_kind_label(kind)}. A sheet is of a force over a motion, a "
        f"transmissibility, or a fit. {sentence(advice)}"
    )


def _render_output(sheet: TransferStiffness, path: str, *, lines: bool) -> str:
    """Return the content of an output file."""
    suffix = Path(path).suffix.lower()
    if suffix in PAGE_SUFFIXES:
        return workflow.html(sheet)
    return sheet.csv(lines=lines) if suffix == ".csv" else format_json(sheet) + "\n"
