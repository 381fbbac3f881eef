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
from dashpot.cli._command import build_options, group, mark_advanced, opt, refuse_options, verb
from dashpot.cli._command_files import (
    detect_file_kinds,
    format_command,
    format_grams,
    get_file_kinds,
    print_detected_kinds,
)
from dashpot.cli._command_result import CommandResult, write_figure
from dashpot.cli._options import MASS, VIBRATION
from dashpot.cli._param_types import File
from dashpot.reading.columns.file_kinds import get_kind_label
from dashpot.registry import require_handler
from dashpot.text_output.layout import Text
from dashpot.workflow.job import BlockOnSeals, Job

_LOT_KIND, _FIT_KIND = "lot", "fit"
_VIBRATION_KINDS = set(VIBRATION.split())


@verb(
    "compare",
    """Compare a prediction with a measurement, an FRF with an FRF, or two lots.

  dashpot compare fit.json hammer.csv --mass 114.8g --seals 2
  dashpot compare before.uff after.uff
  dashpot compare may/lot june/lot""",
    options.file_argument("FIT|FRF|LOT WITH..."),
    group(
        MASS,
        options.mass_options(kinds=_FIT_KIND, purpose=" Inferred if missing."),
        build_options(Job, "band", kinds=f"{_FIT_KIND} {VIBRATION}", help="Frequencies to compare, "
                                                                       "e.g. 5:40Hz."),
        opt("--record", "records", type=File(), multiple=True, metavar="FILE", kinds=_FIT_KIND,
            help="The fitted record: adds bounds for unresolved arms."),
        options.relative_motion_option(_FIT_KIND),
        mark_advanced(opt("--quantity", "quantities", multiple=True, metavar="NAME",
                 kinds=_LOT_KIND,                 help="Quantities to compare in two lots (all).")),
    ),
    options.hammer_options(kinds=f"{_FIT_KIND} impact"),
    options.reading_options(),
    options.result_options(),
)  # fmt: skip
def command(*, files: tuple[str, ...], **arguments: Any) -> CommandResult:
    """Compare the first file with the others, according to their kinds."""
    first, *others = files
    if not others:
        raise click.UsageError(f"Give what {first} is compared with: a measurement, an FRF, a lot.")
    detections = detect_file_kinds([_get_lot_path(path) for path in files], arguments["options"])
    kinds_by_lot_path = get_file_kinds(detections, arguments["options"])
    kinds = {path: kinds_by_lot_path[_get_lot_path(path)] for path in files}
    first_kind, other_kinds = kinds[first], {kinds[path] for path in others}
    are_lots = first_kind == _LOT_KIND and other_kinds == {_LOT_KIND} and len(others) == 1
    if not (
        are_lots
        or (first_kind in {_FIT_KIND, *_VIBRATION_KINDS} and other_kinds <= _VIBRATION_KINDS)
    ):
        raise click.UsageError(_format_no_pair(kinds))
    refuse_options(command, click.get_current_context(), {first: first_kind})
    if are_lots:
        return _compare_lots(first, others[0], arguments["quantities"])
    if first_kind == _FIT_KIND:
        print_detected_kinds({path: detections[path] for path in others})
        return _compare_prediction(
            first, others, options.pop_block(arguments),
            picture=arguments["picture"], reading=arguments["options"],
            **{name: arguments[name] for name in ("records", "band", "hammer")},
        )  # fmt: skip
    print_detected_kinds(detections)
    return _compare_frfs(first, others, arguments)


def _format_no_pair(kinds: Mapping[str, str]) -> str:
    """Return why files of these kinds are not compared, and the kinds that are."""
    first, *others = kinds
    text = "; ".join(f"{path} is {get_kind_label(kind)}" for path, kind in kinds.items())
    message = f"{text}. Compare a fit with a measurement, an FRF with an FRF, or a lot with a lot."
    if kinds[first] in _VIBRATION_KINDS and {kinds[path] for path in others} == {_FIT_KIND}:
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
    fit_result = workflow.read_fit(fit)
    agreement = workflow.compare_files(
        fit_result,
        measured,
        block,
        options=reading.drop_fields(reading.bench_fields),
        options_with=reading.select_fields(("units", *reading.bench_fields)),
        **choices,
    )
    if picture:
        sources = (*fit_result.source, *agreement.comparison.measured.source)
        stamp = dp.plot.stamp(sources, fit_result.specimen, mass=agreement.mass, seals=block.seals)
        figure = dp.plot.comparison(
            agreement.comparison, band=agreement.limits, interval=agreement.interval, stamp=stamp
        )
        write_figure(picture, figure)
    is_mass_inferred = agreement.mass_inferred
    mass = "MASS" if is_mass_inferred else format_grams(agreement.mass)
    model_option = ("--model", "auto") if fit_result.evidence.alternative is not None else ()
    next_command = ""
    if fit_result.method in get_choice_values(Method):
        tests = [_find_test_path(source.file, (fit, *measured)) for source in fit_result.source]
        mass_option = ("--mass", mass, "--seals", f"{block.seals:g}")
        typed_options = options.get_typed_options_for(
            "fit", excluded_flags=("--mass", "--seals", "--model")
        )
        next_command = format_command(
            "fit",
            *tests,
            *measured,
            *model_option,
            *mass_option,
            *typed_options,
            remark="fits relaxation and hammer test together",
        )
    return CommandResult.from_result(agreement, next_command=next_command)


def _find_test_path(name: str, paths: Sequence[str]) -> str:
    """Return the path of a fitted file: here, next to the given files, or in FOLDER."""
    candidates = (Path(name), *(Path(path).parent / name for path in paths))
    return str(next((path for path in candidates if path.is_file()), Path("FOLDER", name)))


def _compare_frfs(first: str, others: Sequence[str], arguments: dict[str, Any]) -> CommandResult:
    """Compare the modes of FRFs of one structure with those of another test of it."""
    result, chart = require_handler("compare files", "frf")(
        [first], options=arguments["options"], band=arguments["band"], against=others
    )
    if arguments["picture"]:
        modes = [mode.mode for mode in result.modes]
        stamp = dp.plot.stamp(result.frf.source)
        write_figure(arguments["picture"], dp.plot.stabilisation(chart, modes, stamp=stamp))
    return CommandResult.from_result(result)


def _compare_lots(first: str, second: str, quantities: tuple[str, ...]) -> CommandResult:
    """Compare two lots; ``FOLDER:NAME`` is one lot of several."""
    result = require_handler("compare files", _LOT_KIND)(first, second, quantities)
    return CommandResult(
        result, Text(str(result).splitlines()), result.checks, verdict=result.verdict
    )
