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
PIECE = "Specimen"

VIBRATION = "impact frf transmissibility"
"""Kinds that are of a mass on its seals."""
SOLIDS = "relaxation dma master-curve modulus creep fit"
"""Kinds that are of a solid: tests of it, and its fit."""


def _build_keyed_option(cls: type[Any], name: str, into: str) -> list[CommandOption]:
    """Return the option of KEY=VALUE that fills fields of a dataclass."""
    keys = [field.name for field in fields(cls) if field.metadata.get("under") == name]
    return build_options(cls, *keys, into=into)


def files(
    metavar: str, name: str = "files", *, several: bool = True, least: int = 1
) -> click.Argument:
    """Return the argument that names what a verb reads."""
    nargs = -1 if several else 1
    return click.Argument([name], type=File(), nargs=nargs, required=least > 0, metavar=metavar)


def reading(*, short: Sequence[str] = ("--column", "--units", "--profile")) -> list[CommandOption]:
    """Return the options that say what a file leaves open; `short` stand in the short help."""
    options = [
        *_build_keyed_option(ReadOptions, "column", into="options"),
        *build_options(
            ReadOptions,
            "units",
            type=Units(),
            into="options",
            help="Unit of a role or column: force=N.",
        ),
        opt(
            "--profile",
            type=Scoped(File()),
            multiple=True,
            metavar="FILE",
            help="Settings saved by 'inspect --save'.",
        ),
        *_build_keyed_option(ReadOptions, "text-format", into="options"),
        *_build_keyed_option(ReadOptions, "file-part", into="options"),
        *build_options(
            ReadOptions,
            "rate",
            type=Scoped(WithUnit("frequency")),
            multiple=True,
            metavar="FREQUENCY",
            into="options",
        ),
        *build_options(
            ReadOptions,
            "window_decay",
            type=Scoped(WithUnit("time")),
            multiple=True,
            metavar="TIME",
            kinds="impact frf",
            into="options",
        ),
        *build_options(ReadOptions, "calibration", "axis", into="options"),
        *build_options(
            ReadOptions,
            "kind",
            type=Scoped(click.STRING),
            multiple=True,
            metavar="KIND",
            help="What a file is, if taken for another: FILE:KIND.",
            into="options",
        ),
    ]
    for option in options:
        option.more = option.flag not in short
    return group(READING, options)


def result(
    message: str = "",
    *suffixes: str,
    plot: bool = True,
    checked: bool = True,
    title: str = RESULT,
    default: str | None = None,
    required: bool = False,
    opens: bool = True,
) -> list[CommandOption]:
    """Return the options on the output files and the format of a result."""
    options: list[CommandOption] = []
    if message:
        how: dict[str, Any] = {"required": True} if required else {"default": default}
        options.append(
            CommandOption(
                "-o", "--output", type=Output(suffixes), metavar="FILE", help=message, **how
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
    if opens:
        options.append(opt("--open", "opens", help="Open the page or picture written."))
    options.append(opt("--overwrite", help="Replace a file that dashpot did not write."))
    if checked:
        options += [
            opt("--json", "as_json", help="Print one JSON document in SI units."),
            opt("--strict", help="Exit with 1 if a check limits the use."),
            opt("-v", "--verbose", help="Print everything."),
        ]
    return group(title, options)


def under_mass(*, kinds: str = "", name: str = "", required: bool = False) -> list[CommandOption]:
    """Return the options of a mass on its seals; `name` says what goes without it."""
    message = f"Test mass, e.g. 104g.{name}"
    return [
        *build_options(Job, "mass", kinds=kinds, help=message, required=required),
        *build_options(Job, "seals", kinds=kinds, metavar="N"),
        *mark_advanced(
            build_options(Job, "seal_mass", kinds=kinds),
            build_options(Job, "compression", kinds=kinds),
        ),
    ]


def pop_block(options: dict[str, Any]) -> BlockOnSeals:
    """Take the block that the options of :func:`under_mass` describe out of what was said."""
    return BlockOnSeals(*(options.pop(attribute.name) for attribute in fields(BlockOnSeals)))


def hammer(*, kinds: str = "", leave: Sequence[str] = ()) -> list[CommandOption]:
    """Return the options of hits, and of a mass over a base that moves."""
    hits = build_options(HammerChoices, into="hammer", leave=("motion", *leave), kinds=kinds)
    for hit in hits:
        if hit.flag == "--polarity" and hit.kinds:
            hit.kinds |= {"frf"}
    return mark_advanced(group(HITS, hits))


def relative(kinds: str = "") -> list[CommandOption]:
    """Return the option of a motion that was measured against the base."""
    return mark_advanced(build_options(HammerChoices, "motion", into="hammer", kinds=kinds))


def machine(kinds: str = "") -> list[CommandOption]:
    """Return the option of what is known of the testing machine."""
    return build_options(Machine, into="machine", kinds=kinds)


def time_limits(kinds: str = "") -> list[CommandOption]:
    """Return the option of cuts that are made by hand."""
    return build_options(TimeLimits, into="time_limits", kinds=kinds)


def piece(*, flag: bool = False, more: bool = True) -> list[CommandOption]:
    """Return the options of the specimen; a temperature for `flag` file where there are several."""
    options = [
        *(
            build_options(Job, "temperatures")
            if flag
            else build_options(Specimen, "temperature", into="specimen")
        ),
        *build_options(Specimen, "length", "height", into="specimen"),
        *_build_keyed_option(Specimen, "label", into="specimen"),
    ]
    for option in options:
        option.more = more
    return group(PIECE, options)


def wlf() -> CommandOption:
    """Return the option of how a seal follows temperature."""
    message = "How the seal follows temperature: 6.94,129.6K,23degC."
    return opt("--wlf", type=Wlf(), metavar="C1,C2,T", help=message)


def get_typed_options(*titles: str, but: Container[str] = ()) -> list[str]:
    """Return the options that were typed, of these groups of the help or of all, as typed.

    For the command that comes next; without what says where results go.
    """
    context = click.get_current_context()
    assert isinstance(context.command, DashpotCommand)  # noqa: S101
    return [
        word
        for option in context.command.options
        if (not titles or option.group in titles)
        and option.name not in but
        and option.group != RESULT
        for word in option.get_typed_words(context)
    ]


def get_typed_options_for(verb: str, *, but: Container[str] = ()) -> list[str]:
    """Return the options that were typed and that another verb takes too, as typed.

    `but` are flags that it is given otherwise.
    """
    root = click.get_current_context().find_root()
    assert isinstance(root.command, click.Group)  # noqa: S101
    other = root.command.get_command(root, verb)
    assert isinstance(other, DashpotCommand)  # noqa: S101
    names = {option.flag for option in other.options if option.group != RESULT}
    command = click.get_current_context().command
    assert isinstance(command, DashpotCommand)  # noqa: S101
    return get_typed_options(
        but={
            option.name
            for option in command.options
            if option.flag not in names or option.flag in but
        }
    )


def format_column_hint(files: Sequence[str]) -> str:
    """Return how a column is said of one file alone, where one was said of several; else nothing.

    A number, or a name that two files share, may make another kind of test of the second.
    """
    context = click.get_current_context()
    assert isinstance(context.command, DashpotCommand)  # noqa: S101
    words = [
        option.get_typed_words(context)
        for option in context.command.options
        if option.flag == "--column"
    ]
    plain = [word for word in words[0][1::2] if ":" not in word.partition("=")[0]] if words else []
    if len(files) < 2 or not plain:
        return ""
    text = shlex.join(["--column", f"{Path(files[0]).name}:{plain[0]}"])
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
        other = option.group != RESULT and option.names.isdisjoint(names)
        if other and option.get_typed_words(click.get_current_context()):
            raise click.UsageError(f"{option.flag} {reason}. Leave out one of them.")
    return {name: options[name] for name in names if name in options}
