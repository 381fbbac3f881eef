"""dashpot compare: a prediction with a measurement, two FRFs, two lots."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import click

import dashpot as dp
from dashpot import workflow
from dashpot.base.option_fields import Method, get_choice_values
from dashpot.cli import _options as options
from dashpot.cli._command import build_options, group, mark_advanced, opt, refuse_others, verb
from dashpot.cli._command_files import (
    detect_file_kinds,
    format_command,
    grams,
    kinds_of,
    print_detected_kinds,
)
from dashpot.cli._command_result import CommandResult, write_figure
from dashpot.cli._options import MASS, VIBRATION
from dashpot.cli._param_types import File
from dashpot.reading.columns.file_kinds import get_kind_label
from dashpot.registry import require_handler
from dashpot.text_output.layout import Text
from dashpot.workflow.job import BlockOnSeals, Job

_LOT, _SOLID = "lot", "fit"
_MEASURED = set(VIBRATION.split())


@verb(
    "compare",
    """Compare a prediction with a measurement, an FRF with an FRF, or two lots.

  dashpot compare fit.json hammer.csv --mass 114.8g --seals 2
  dashpot compare before.uff after.uff
  dashpot compare may/lot june/lot""",
    options.files("FIT|FRF|LOT WITH..."),
    group(
        MASS,
        options.under_mass(kinds=_SOLID, name=" Inferred if missing."),
        build_options(Job, "band", kinds=f"{_SOLID} {VIBRATION}", help="Frequencies to compare, "
                                                                       "e.g. 5:40Hz."),
        opt("--record", "records", type=File(), multiple=True, metavar="FILE", kinds=_SOLID,
            help="The fitted record: adds bounds for unresolved arms."),
        options.relative(_SOLID),
        mark_advanced(opt("--quantity", "quantities", multiple=True, metavar="NAME", kinds=_LOT,
                 help="Quantities to compare in two lots (all).")),
    ),
    options.hammer(kinds=f"{_SOLID} impact"),
    options.reading(),
    options.result(),
)  # fmt: skip
def command(*, files: tuple[str, ...], **arguments: Any) -> CommandResult:
    """Compare the first file with the others, according to their kinds."""
    first, *others = files
    if not others:
        raise click.UsageError(f"Give what {first} is compared with: a measurement, an FRF, a lot.")
    detections = detect_file_kinds([_get_lot_path(path) for path in files], arguments["options"])
    entries = kinds_of(detections, arguments["options"])
    kinds = {path: entries[_get_lot_path(path)] for path in files}
    text, other_kinds = kinds[first], {kinds[path] for path in others}
    lots = text == _LOT and other_kinds == {_LOT} and len(others) == 1
    if not (lots or (text in {_SOLID, *_MEASURED} and other_kinds <= _MEASURED)):
        raise click.UsageError(_format_no_pair(kinds))
    refuse_others(command, click.get_current_context(), {first: text})
    if lots:
        return _compare_lots(first, others[0], arguments["quantities"])
    if text == _SOLID:
        print_detected_kinds({path: detections[path] for path in others})
        return _compare_prediction(
            first, others, options.pop_block(arguments),
            picture=arguments["picture"], reading=arguments["options"],
            **{name: arguments[name] for name in ("records", "band", "hammer")},
        )  # fmt: skip
    print_detected_kinds(detections)
    return _compare_frfs(first, others, arguments)


def _format_no_pair(kinds: Mapping[str, str]) -> str:
    """Return why files of these kinds are not compared, and what is."""
    first, *others = kinds
    text = "; ".join(f"{path} is {get_kind_label(kind)}" for path, kind in kinds.items())
    message = f"{text}. Compare a fit with a measurement, an FRF with an FRF, or a lot with a lot."
    if kinds[first] in _MEASURED and {kinds[path] for path in others} == {_SOLID}:
        message += (
            f" Type: {format_command('compare', others[-1], first, *options.get_typed_options())}"
        )
    return message


def _get_lot_path(path: str) -> str:
    """Return the folder of ``FOLDER:NAME``, one lot of several; of other files the path."""
    folder = path.rpartition(":")[0]
    return folder if folder and not Path(path).exists() and Path(folder).is_dir() else path


def _compare_prediction(
    fit: str,
    measured: Sequence[str],
    block: BlockOnSeals,
    *,
    picture: str | None,
    reading: Any,
    **choices: Any,
) -> CommandResult:
    """Compare the prediction of a fit with hits or FRFs."""
    fitted = workflow.read_fit(fit)
    agreement = workflow.compare_files(
        fitted,
        measured,
        block,
        options=reading.drop_fields(reading.bench_fields),
        options_with=reading.select_fields(("units", *reading.bench_fields)),
        **choices,
    )
    if picture:
        sources = (*fitted.source, *agreement.comparison.measured.source)
        named = dp.plot.stamp(sources, fitted.specimen, mass=agreement.mass, seals=block.seals)
        drawn = dp.plot.comparison(
            agreement.comparison, band=agreement.limits, interval=agreement.interval, stamp=named
        )
        write_figure(picture, drawn)
    inferred = agreement.mass_inferred
    mass = "MASS" if inferred else grams(agreement.mass)
    family = ("--model", "auto") if fitted.evidence.alternative is not None else ()
    follow = ""
    if fitted.method in get_choice_values(Method):
        tests = [source.file for source in fitted.source]
        rig = ("--mass", mass, "--seals", f"{block.seals:g}")
        again = options.get_typed_options_for("fit", but=("--mass", "--seals", "--model"))
        why = "fits relaxation and hammer test together"
        follow = format_command("fit", *tests, *measured, *family, *rig, *again, why=why)
    return CommandResult.from_result(agreement, follow=follow)


def _compare_frfs(first: str, others: Sequence[str], stated: dict[str, Any]) -> CommandResult:
    """Compare the modes of FRFs of one structure with those of another test of it."""
    result, chart = require_handler("compare files", "frf")(
        [first], options=stated["options"], band=stated["band"], against=others
    )
    if stated["picture"]:
        modes = [mode.mode for mode in result.modes]
        stamp = dp.plot.stamp(result.frf.source)
        write_figure(stated["picture"], dp.plot.stabilisation(chart, modes, stamp=stamp))
    return CommandResult.from_result(result)


def _compare_lots(first: str, second: str, quantities: tuple[str, ...]) -> CommandResult:
    """Compare two lots; ``FOLDER:NAME`` is one lot of several."""
    result = require_handler("compare files", _LOT)(first, second, quantities)
    return CommandResult(
        result, Text(str(result).splitlines()), result.checks, verdict=result.verdict
    )
