"""dashpot predict: how a fitted solid vibrates, under a mass or in a door."""

from __future__ import annotations

from dataclasses import replace
from inspect import signature
from pathlib import Path
from typing import Any

import click

from dashpot import workflow
from dashpot.base.option_fields import FrfKind, get_choice_values, iterate_option_fields
from dashpot.cli import _options as options
from dashpot.cli._command import build_options, group, mark_advanced, opt, refuse_options, verb
from dashpot.cli._command_files import PAGE_SUFFIXES, detect_file_kinds, format_command
from dashpot.cli._command_result import CommandResult, format_json, write_figure, write_output
from dashpot.cli._options import MASS, RAMP
from dashpot.cli._param_types import ChoiceWithSuggestion, File, WithUnit
from dashpot.reading.read_options import ReadOptions
from dashpot.registry import (
    KINDS,
    PREDICTED,
    KindOfTest,
    call_handler,
    list_names,
    load_object,
    require_handler,
)
from dashpot.workflow.job import Job, LevelChoices, PartChoices

_FIT_KIND = "fit"
_FILE_KINDS = list_names("predict file")
"""Kinds of files that are predicted as a whole."""
_QUESTION_GROUP, _PART_GROUP = "Question", "Part of a material"


def _list_fit_options(kind: KindOfTest) -> list[str]:
    """Return the options of a kind's own prediction that take the file of a fit."""
    return [
        field.name
        for field in iterate_option_fields(load_object(kind.predict_options))
        if field.metadata.get("metavar") == "FIT"
    ]


@verb(
    "predict",
    """Predict how a fitted model vibrates, under a mass or in a door.

  dashpot predict fit.json --mass 114.8g --seals 2
  dashpot predict law.json --drop 0.6m/s --mass 200g
  dashpot predict door.toml --close 1.2m/s""",
    options.file_argument("FIT|DOOR.toml", "path", multiple=False),
    group(
        _QUESTION_GROUP,
        build_options(
            Job,
            "band",
            kinds=" ".join((_FIT_KIND, *_FILE_KINDS)),
            help="Frequencies (1:50Hz; door 1:200Hz).",
        ),
        opt(
            "--temperature",
            type=WithUnit("temperature"),
            metavar="TEMPERATURE",
            help="Temperature of the seals.",
        ),
        *call_handler("options", "stiffness", _FIT_KIND, default=()),
        opt("--base", kinds=_FIT_KIND, help="The base moves: transmissibility."),
        opt(
            "--base-psd",
            type=File(),
            metavar="DENSITY",
            kinds=_FIT_KIND,
            help="Random base: FILE or 0.01g^2/Hz.",
        ),
        opt(
            "--record",
            "records",
            type=File(),
            multiple=True,
            metavar="FILE",
            kinds=_FIT_KIND,
            help="The record behind the fit: adds a bound.",
        ),
        build_options(
            LevelChoices,
            "levels",
            argument="at_level",
            kinds=_FIT_KIND,
            help="Resonance at an amplitude, e.g. 0.5N.",
        ),
        mark_advanced(build_options(LevelChoices, "sweep", argument="at_level", kinds=_FIT_KIND)),
        *(
            build_options(
                load_object(kind.predict_options), kinds=kind.name, omit=_list_fit_options(kind)
            )
            for kind in PREDICTED
        ),
        mark_advanced(
            *(
                build_options(
                    load_object(kind.predict_options), *_list_fit_options(kind), kinds=kind.name
                )
                for kind in PREDICTED
                if _list_fit_options(kind)
            ),
            *call_handler("options", "predict", _FIT_KIND, default=()),
            opt(
                "--frf-type",
                "kind",
                type=ChoiceWithSuggestion(get_choice_values(FrfKind)),
                metavar="NAME",
                kinds=_FIT_KIND,
                help=", ".join(get_choice_values(FrfKind)[:-1]) + " or "
                f"{get_choice_values(FrfKind)[-1]}.",
            ),
            options.relative_motion_option(_FIT_KIND),
            opt(
                "--points",
                "lines",
                type=click.IntRange(2),
                default=2001,
                metavar="N",
                kinds=_FIT_KIND,
                help="Lines of the FRF (2001).",
            ),
        ),
    ),
    group(MASS, options.mass_options(kinds=_FIT_KIND)),
    group(
        _PART_GROUP,
        build_options(
            PartChoices,
            "disc",
            "block",
            "bush",
            "bulb",
            argument="part",
            kinds=_FIT_KIND,
            help="disc:20mm,20mm; block, bush, bulb.",
        ),
        mark_advanced(
            build_options(
                PartChoices,
                "mode",
                "lubricated",
                "resonance",
                "resonance_mass",
                argument="part",
                kinds=_FIT_KIND,
            ),
            build_options(
                LevelChoices,
                "height",
                "strain_factor",
                "fitted_at",
                "resonance_level",
                argument="at_level",
                kinds=_FIT_KIND,
            ),
        ),
    ),
    *call_handler("option groups", "predict", default=()),
    mark_advanced(group(RAMP, options.machine_option(_FIT_KIND)), options.reading_options()),
    options.result_options("FRF as .csv; of a door .json; or a page, .html."),
)
def command(*, path: str, **arguments: Any) -> CommandResult:
    """Return the prediction by the kind of file: a door, a mass on seals, or the kind's own."""
    detection = detect_file_kinds([path], ReadOptions())[path]
    if arguments["options"].kind in get_choice_values(FrfKind):  # --kind in the edition before
        kind = arguments["options"].kind
        arguments |= {"kind": kind, "options": replace(arguments["options"], kind=None)}
    kind_of_test = KINDS.get(detection.kind) if detection.stored else None
    has_own_prediction = kind_of_test is not None and bool(kind_of_test.predict)
    kind = detection.kind if detection.kind in _FILE_KINDS or has_own_prediction else _FIT_KIND
    refuse_options(command, click.get_current_context(), {path: kind})
    if kind_of_test is not None and has_own_prediction:
        return _predict_kind(path, kind_of_test, arguments)
    if kind in _FILE_KINDS:
        predict = require_handler("predict file", kind)
        _, *names = signature(predict).parameters
        result: CommandResult = predict(path, **{name: arguments[name] for name in names})
        return result
    for name in _OTHER_PREDICTIONS:
        if arguments[name]:
            return _predict_with_option(name, path, arguments)
    # an argument may be filled by several options, such as those of reading
    fit_arguments = {
        name
        for option in command.options
        if not option.kinds or _FIT_KIND in option.kinds
        for name in option.names
    }.difference(_OTHER_PREDICTIONS)
    return _predict_mass(
        path, **{name: item for name, item in arguments.items() if name in fit_arguments}
    )


def _predict_kind(path: str, kind_of_test: KindOfTest, arguments: dict[str, Any]) -> CommandResult:
    """Return the prediction of a kind's own fit."""
    predict_options = {
        field.name: arguments[field.name]
        for field in iterate_option_fields(load_object(kind_of_test.predict_options))
    }
    predict_options |= {
        name: workflow.read_fit(predict_options[name]) if predict_options[name] else None
        for name in _list_fit_options(kind_of_test)
    }
    result = load_object(kind_of_test.predict)(
        workflow.read_json_document(path), temperature=arguments["temperature"], **predict_options
    )
    return _write_prediction(result, arguments)


def _write_prediction(result: Any, arguments: dict[str, Any]) -> CommandResult:
    """Return the result of a prediction that is no FRF, with its document and figure."""
    output = arguments["output"]
    writes_page = is_page_output(output)
    if arguments["picture"]:
        write_figure(arguments["picture"], result.plot())
    if output:
        write_output(output, workflow.html(result) if writes_page else format_json(result) + "\n")
    return CommandResult.from_result(result)


def is_page_output(output: str | None) -> bool:
    """Return whether an output other than an FRF is a page; else it is a document."""
    suffix = Path(output or "").suffix.lower()
    if output and output != "-" and suffix not in (".json", *PAGE_SUFFIXES):
        raise click.UsageError(f"-o {output}: this prediction is written as .json or .html.")
    return suffix in PAGE_SUFFIXES


_OTHER_PREDICTIONS = list_names("predict with option")
"""Options of predictions other than vibration."""


def _predict_with_option(name: str, path: str, arguments: dict[str, Any]) -> CommandResult:
    """Return the prediction that such an option selects."""
    predict = require_handler("predict with option", name)
    prediction_arguments = options.select_arguments(
        predict, arguments, command, f"is for a vibration, and --{name} is not"
    )
    return _write_prediction(predict(workflow.read_fit(path), **prediction_arguments), arguments)


def _predict_mass(
    fit: str,
    *,
    picture: str | None,
    output: str | None,
    hammer: Any,
    **choices: Any,
) -> CommandResult:
    """Return the response of a mass on seals, or on parts of a material."""
    fit_result = workflow.read_fit(fit)  # what is no fit is said before what a fit lacks
    block = options.pop_block(choices)
    if block.mass is None:
        raise click.UsageError("Give the test mass: --mass 104g")
    has_several_levels = len(choices["at_level"].levels) > 1
    if output and has_several_levels and not output.lower().endswith((".json", *PAGE_SUFFIXES)):
        raise click.UsageError(
            "-o FRF.csv holds one level: ask one --amplitude, or write .json or .html"
        )
    prediction = workflow.predict_files(
        fit_result, block=block, relative=hammer.motion == "relative", **choices
    )
    if picture:
        write_figure(picture, prediction.plot())
    if output:
        _write_frf_output(prediction, output)
    return CommandResult.from_result(
        prediction, next_command="" if prediction.is_of_part else _format_next_command(fit)
    )


def _write_frf_output(prediction: workflow.Prediction, path: str) -> None:
    suffix = path.lower().rpartition(".")[2]
    if path.lower().endswith(PAGE_SUFFIXES):
        write_output(path, workflow.html(prediction))
    elif suffix == "json":
        write_output(path, format_json(prediction) + "\n")
    elif suffix in {"csv", path.lower()}:
        write_output(path, prediction.csv())
    else:
        raise click.UsageError(f"-o {path}: a prediction is written as .csv, .json or .html.")


def _format_next_command(fit: str) -> str:
    typed_options = options.get_typed_options_for(
        "compare", excluded_flags=("--kind",)
    )  # which is of another file
    return format_command("compare", fit, "HAMMER", *typed_options, remark="tests it with a hammer")
