"""Options that several commands share, in the groups of the help."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Container, Mapping, Sequence
from dataclasses import fields
from inspect import signature
from pathlib import Path
from typing import Any

import click

from dashpot.base.option_fields import FigureSize, get_choice_values
from dashpot.cli._command import (
    CommandOption,
    DashpotCommand,
    build_options,
    group,
    mark_advanced,
    opt,
)
from dashpot.cli._param_types import (
    ChoiceWithSuggestion,
    Figure,
    File,
    Output,
    Scoped,
    Units,
    WithUnit,
    Wlf,
)
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.specimen import Specimen
from dashpot.reading.read_options import ReadOptions
from dashpot.workflow.job import BlockOnSeals, HammerChoices, Job, TimeLimits

MODEL, MASS, READING, RESULT = "Model", "Mass on seals", "Reading the files", "Result"
RAMP, TEMPERATURE_GROUP, HITS = "Ramp and hold", "Several temperatures", "Hammer hits"
SPECIMEN_GROUP = "Specimen"

VIBRATION = "impact frf transmissibility"
"""Kinds of vibration tests of a mass on its seals."""
SOLIDS = "relaxation dma master-curve modulus creep fit"
"""Kinds that concern a solid: its tests, and its fit."""


def _build_keyed_option(cls: type[Any], name: str, argument: str) -> list[CommandOption]:
    """Return the option of KEY=VALUE that fills fields of a dataclass."""
    keys = [field.name for field in fields(cls) if field.metadata.get("keyed_flag") == name]
    return build_options(cls, *keys, argument=argument)


def file_argument(
    metavar: str, name: str = "files", *, multiple: bool = True, min_count: int = 1
) -> click.Argument:
    """Return the argument for the files that a verb reads."""
    nargs = -1 if multiple else 1
    return click.Argument([name], type=File(), nargs=nargs, required=min_count > 0, metavar=metavar)


def reading_options(
    *, common_flags: Sequence[str] = ("--column", "--units", "--profile")
) -> list[CommandOption]:
    """Return the options for reading a file; the short help shows `common_flags`."""
    options = [
        *_build_keyed_option(ReadOptions, "column", argument="options"),
        *build_options(
            ReadOptions,
            "units",
            type=Units(),
            argument="options",
            help="Unit of a role or column: force=N.",
        ),
        opt(
            "--profile",
            type=Scoped(File()),
            multiple=True,
            metavar="FILE",
            help="Settings saved by 'inspect --save'.",
        ),
        *_build_keyed_option(ReadOptions, "text-format", argument="options"),
        *_build_keyed_option(ReadOptions, "file-part", argument="options"),
        *build_options(
            ReadOptions,
            "rate",
            type=Scoped(WithUnit("frequency")),
            multiple=True,
            metavar="FREQUENCY",
            argument="options",
        ),
        *build_options(
            ReadOptions,
            "window_decay",
            type=Scoped(WithUnit("time")),
            multiple=True,
            metavar="TIME",
            kinds="impact frf",
            argument="options",
        ),
        *build_options(ReadOptions, "calibration", "axis", argument="options"),
        *build_options(
            ReadOptions,
            "kind",
            type=Scoped(click.STRING),
            multiple=True,
            metavar="KIND",
            help="What a file is, if taken for another: FILE:KIND.",
            argument="options",
        ),
    ]
    for option in options:
        option.is_advanced = option.flag not in common_flags
    return group(READING, options)


def result_options(
    file_help: str = "",
    *suffixes: str,
    plot: bool = True,
    has_checks: bool = True,
    title: str = RESULT,
    default: str | None = None,
    required: bool = False,
    has_open_option: bool = True,
) -> list[CommandOption]:
    """Return the options on the output files and the format of a result."""
    options: list[CommandOption] = []
    if file_help:
        output_settings: dict[str, Any] = {"required": True} if required else {"default": default}
        options.append(
            CommandOption(
                "-o",
                "--output",
                type=Output(suffixes),
                metavar="FILE",
                help=file_help,
                **output_settings,
            )
        )
    if plot:
        options.append(opt("--plot", "picture", type=Figure(), metavar="FILE",
                         help="Draw the result: .png, .svg or .pdf."))  # fmt: skip
        sizes = get_choice_values(FigureSize)
        options += mark_advanced(
            opt(
                "--size",
                type=ChoiceWithSuggestion(sizes),
                metavar="|".join(sizes),
                help="Size of --plot: 85 mm wide, or of a slide.",
            )
        )
    if has_open_option:
        options.append(opt("--open", "opens", help="Open the page or figure written."))
    options.append(opt("--overwrite", help="Replace a file that dashpot did not write."))
    if has_checks:
        options += [
            opt("--json", "as_json", help="Print one JSON document in SI units."),
            opt("--strict", help="Exit with 1 if a check limits the use."),
            opt("-v", "--verbose", help="Print everything."),
        ]
    return group(title, options)


def mass_options(
    *, kinds: str = "", purpose: str = "", required: bool = False
) -> list[CommandOption]:
    """Return the options of a mass on its seals; `purpose` names the results that need them."""
    return [
        *build_options(
            Job, "mass", kinds=kinds, help=f"Test mass, e.g. 104g.{purpose}", required=required
        ),
        *build_options(Job, "seals", kinds=kinds, metavar="N"),
        *mark_advanced(
            build_options(Job, "seal_mass", kinds=kinds),
            build_options(Job, "compression", kinds=kinds),
        ),
    ]


def pop_block(options: dict[str, Any]) -> BlockOnSeals:
    """Take the block that the options of :func:`mass_options` describe out of what was said."""
    return BlockOnSeals(*(options.pop(attribute.name) for attribute in fields(BlockOnSeals)))


def hammer_options(*, kinds: str = "", omit: Sequence[str] = ()) -> list[CommandOption]:
    """Return the options of hits, and of a mass over a base that moves."""
    hit_options = build_options(
        HammerChoices, argument="hammer", omit=("motion", *omit), kinds=kinds
    )
    for option in hit_options:
        if option.flag == "--polarity" and option.kinds:
            option.kinds |= {"frf"}
    return mark_advanced(group(HITS, hit_options))


def relative_motion_option(kinds: str = "") -> list[CommandOption]:
    """Return the option of a motion that was measured against the base."""
    return mark_advanced(build_options(HammerChoices, "motion", argument="hammer", kinds=kinds))


def machine_option(kinds: str = "") -> list[CommandOption]:
    """Return the option for a file with the properties of the testing machine."""
    return build_options(Machine, argument="machine", kinds=kinds)


def time_limits_option(kinds: str = "") -> list[CommandOption]:
    """Return the option of cuts that are made by hand."""
    return build_options(TimeLimits, argument="time_limits", kinds=kinds)


def specimen_options(*, per_file: bool = False, is_advanced: bool = True) -> list[CommandOption]:
    """Return the options of the specimen; with `per_file`, a temperature of each file."""
    options = [
        *(
            build_options(Job, "temperatures")
            if per_file
            else build_options(Specimen, "temperature", argument="specimen")
        ),
        *build_options(Specimen, "length", "height", argument="specimen"),
        *_build_keyed_option(Specimen, "label", argument="specimen"),
    ]
    for option in options:
        option.is_advanced = is_advanced
    return group(SPECIMEN_GROUP, options)


def wlf_option() -> CommandOption:
    """Return the option of how a seal follows temperature."""
    return opt("--wlf", type=Wlf(), metavar="C1,C2,T",
               help="How the seal follows temperature: 6.94,129.6K,23degC.")  # fmt: skip


def get_typed_options(*groups: str, excluded: Container[str] = ()) -> list[str]:
    """Return the options that were typed, of these groups of the help or of all, as typed.

    For the command that comes next; without what says where results go.
    """
    context = click.get_current_context()
    assert isinstance(context.command, DashpotCommand)  # noqa: S101
    return [
        word
        for option in context.command.options
        if (not groups or option.group in groups)
        and option.name not in excluded
        and option.group != RESULT
        for word in option.get_typed_words(context)
    ]


def get_typed_options_for(verb: str, *, excluded_flags: Container[str] = ()) -> list[str]:
    """Return the typed options that another verb takes as well.

    `excluded_flags` are flags that it is given otherwise.
    """
    root = click.get_current_context().find_root()
    assert isinstance(root.command, click.Group)  # noqa: S101
    other_command = root.command.get_command(root, verb)
    assert isinstance(other_command, DashpotCommand)  # noqa: S101
    names = {option.flag for option in other_command.options if option.group != RESULT}
    command = click.get_current_context().command
    assert isinstance(command, DashpotCommand)  # noqa: S101
    return get_typed_options(
        excluded={
            option.name
            for option in command.options
            if option.flag not in names or option.flag in excluded_flags
        }
    )


def format_column_hint(files: Sequence[str]) -> str:
    """Return the option for a column of one file, if several files were given; else "".

    A number, or a name that two files share, may make another kind of test of the second.
    """
    context = click.get_current_context()
    assert isinstance(context.command, DashpotCommand)  # noqa: S101
    typed_columns = [
        option.get_typed_words(context)
        for option in context.command.options
        if option.flag == "--column"
    ]
    columns = (
        [word for word in typed_columns[0][1::2] if ":" not in word.partition("=")[0]]
        if typed_columns
        else []
    )
    if len(files) < 2 or not columns:
        return ""
    text = shlex.join(["--column", f"{Path(files[0]).name}:{columns[0]}"])
    return f" What --column says is for every file; for one alone: {text}"


def select_arguments(
    function: Callable[..., Any], options: Mapping[str, Any], verb: DashpotCommand, reason: str
) -> dict[str, Any]:
    """Return those of the arguments that a function takes; options that fill others are refused.

    Raises
    ------
    click.UsageError
        If such an option was typed, but for those of the result: that it does, or is, the reason.
    """
    names = signature(function).parameters
    for option in verb.options:
        is_other = option.group != RESULT and option.names.isdisjoint(names)
        if is_other and option.get_typed_words(click.get_current_context()):
            raise click.UsageError(f"{option.flag} {reason}. Leave out one of them.")
    return {name: options[name] for name in names if name in options}
