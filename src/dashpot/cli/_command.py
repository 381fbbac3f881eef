"""Command class, options in groups, and help at three levels of detail.

A verb declares its options as data: ``--help`` shows the common ones on one screen, ``--help-all``
every one, and ``FILE --help`` those of the kind that the file is of. No page of help needs NumPy.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import MISSING, Field
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

import click

from dashpot.base.option_fields import get_option_flag, iterate_option_fields
from dashpot.cli._param_types import Keyed, Scoped, type_of

WIDTH = 80
"""Columns of a page of help."""
NAME_WIDTH = 27
"""Columns for the name of an option; a longer name has a separate line."""
MAX_HELP_LINES = 40
"""Lines that the help of a verb may take."""

TYPED_VALUES = "dashpot.typed"
"""Key of the options as typed."""

KEYED_OPTIONS = {
    "--column": ("ROLE=NAME", "Column of a role, by name or number: force=Kraft."),
    "--text-format": ("KEY=VALUE", "delimiter, decimal, encoding or skip (lines)."),
    "--file-part": ("KEY=VALUE", "segment, cycle or sheet to read."),
    "--calibration": ("FILE[,axis=Fz]", "ATI .cal file: gauge voltages to force."),
    "--machine": ("KEY=VALUE", "sync, drift, ... force-filter, oven; or a machine file."),
    "--time-limits": ("KEY=TIME", "onset, ramp-end or hold-end, set by hand."),
    "--prior": ("KEY=VALUE", "stiffness, frequency or damping known beforehand."),
    "--label": ("KEY=VALUE", "name, lot, operator, date or notes."),
    "--shape": ("SHAPE", "disc:20mm,20mm or block:30mm,20mm,10mm."),
}
"""Metavar and help of an option with several keys."""


class TargetFields(NamedTuple):
    """Fields that an option fills: those of a dataclass argument, or arguments by themselves."""

    cls: type
    argument: str
    fields: tuple[Field[Any], ...]


class CommandOption(click.Option):
    """Option with its group in the help, and the kinds of records to which it applies.

    `hidden_alias` is its name in the previous edition, still accepted but not shown.
    """

    def __init__(
        self,
        *flags: str,
        kinds: Iterable[str] = (),
        is_advanced: bool = False,
        target: TargetFields | None = None,
        hidden_alias: str = "",
        **click_options: Any,
    ) -> None:
        super().__init__(flags, **click_options)
        self.group = ""
        self.kinds = frozenset(kinds)
        self.excluded_kinds: frozenset[str] = frozenset()
        """Kinds that do not take the option, if it belongs to no particular kind."""
        self.is_advanced = is_advanced
        self.target = target
        self.hidden_alias = hidden_alias

    def add_to_parser(self, parser: Any, ctx: click.Context) -> None:
        names, self.opts = self.opts, self.list_spellings()  # click shows what `opts` holds
        super().add_to_parser(parser, ctx)
        self.opts = names

    def list_spellings(self) -> list[str]:
        """Return the spellings of the option, including that of the previous edition."""
        return [*self.opts, *([f"--{self.hidden_alias}"] if self.hidden_alias else [])]

    @property
    def flag(self) -> str:
        """Option as it is typed."""
        return max(self.opts, key=len)

    def consume_value(self, ctx: click.Context, opts: Mapping[str, Any]) -> tuple[Any, Any]:
        value, source = super().consume_value(ctx, opts)
        if source is click.core.ParameterSource.COMMANDLINE:
            ctx.meta.setdefault(TYPED_VALUES, {})[self.name] = value
        return value, source

    def applies_to(self, record_kinds: set[str]) -> bool:
        """Return whether it is for records of any of these kinds."""
        if self.kinds:
            return not self.kinds.isdisjoint(record_kinds)
        return not record_kinds or not self.excluded_kinds >= record_kinds

    @property
    def names(self) -> set[str]:
        """Names of the arguments of the command function: its fields, or the value that they
        fill.
        """
        if self.target is None:
            return {str(self.name)}
        return {self.target.argument, *(field.name for field in self.target.fields)}

    def iterate_field_values(self, value: Any) -> Iterator[tuple[str, dict[str, Any]]]:
        """Yield dataclass field values from click's parameters, for all files ("") or some."""
        assert self.target is not None  # noqa: S101
        field = self.target.fields[0]
        if isinstance(self.type, Keyed):
            yield from value or ()
        elif isinstance(self.type, Scoped):
            yield from ((glob, {field.name: item}) for glob, item in value or ())
        else:
            metadata = field.metadata
            yield "", {field.name: metadata["parse"](value) if "parse" in metadata else value}

    def get_typed_words(self, ctx: click.Context) -> list[str]:
        """Return the typed words of the option; empty if it was not typed."""
        typed_values = ctx.meta.get(TYPED_VALUES, {})
        if self.name not in typed_values:
            return []
        value = typed_values[self.name]
        if self.is_flag:
            return [self.flag]
        items = value if isinstance(value, list | tuple) else (value,)
        return [word for item in items for word in (self.flag, str(item))]


def opt(*flags: str, kinds: str = "", **click_options: Any) -> CommandOption:
    """Return an option; without a metavar and a type it is a flag."""
    if "metavar" not in click_options and "type" not in click_options:
        click_options["is_flag"] = True
    return CommandOption(*flags, kinds=kinds.split(), **click_options)


def build_options(
    cls: type,
    *names: str,
    argument: str = "",
    omit: Sequence[str] = (),
    kinds: str = "",
    is_advanced: bool = False,
    **overrides: Any,
) -> list[CommandOption]:
    """Return the options that these fields of a dataclass declare, or all.

    A command function receives each, or the value as one argument, `argument`. `overrides` is what
    these options say otherwise here: `help`, `default`, `required`, `metavar`.
    """
    fields_by_name = {
        field.name: field for field in iterate_option_fields(cls) if field.name not in omit
    }
    fields_by_flag: dict[str, list[Field[Any]]] = {}
    for name in names or fields_by_name:
        fields_by_flag.setdefault(get_option_flag(fields_by_name[name]), []).append(
            fields_by_name[name]
        )
    return [
        _make_option(
            flag,
            TargetFields(cls, argument, tuple(option_fields)),
            kinds=kinds,
            is_advanced=is_advanced,
            **overrides,
        )
        for flag, option_fields in fields_by_flag.items()
    ]


def _make_option(
    flag: str, target: TargetFields, *, kinds: str, is_advanced: bool, **overrides: Any
) -> CommandOption:
    (field, *_), name = target.fields, f"{target.argument}_{target.fields[0].name}"
    click_options: dict[str, Any] = {}
    if "keyed_flag" in field.metadata or len(target.fields) > 1:
        metavar, message = KEYED_OPTIONS[flag]
        click_options = {"type": Keyed(flag, target.fields), "multiple": True, "metavar": metavar}
        click_options["help"] = message
    else:
        click_options = {
            key: field.metadata[key] for key in _CLICK_SETTINGS if key in field.metadata
        }
        click_options["default"] = _get_default(field)
        if "is_flag" not in click_options:
            kind = click_options["type"] = type_of(field)
            click_options.setdefault("metavar", _get_metavar(kind))
    click_options |= overrides
    click_options["help"] = _add_default(
        click_options.get("help") or "", click_options.get("default")
    )
    click_options.setdefault("hidden_alias", field.metadata.get("hidden_alias", ""))
    return CommandOption(
        flag, name, kinds=kinds.split(), is_advanced=is_advanced, target=target, **click_options
    )


def _get_metavar(kind: click.ParamType[Any]) -> str:
    """Return the placeholder of a value in the help: its choices, its dimension, or a number."""
    if isinstance(kind, click.Choice):
        return "|".join(kind.choices)
    return _METAVARS.get(kind.name, kind.name.upper())


_METAVARS = {"float": "N", "integer": "N", "integer range": "N", "text": "NAME"}
_CLICK_SETTINGS = ("help", "metavar", "multiple", "is_flag")


def _get_default(field: Field[Any]) -> Any:
    """Return the default for click."""
    if "is_flag" in field.metadata:
        return False
    if field.default is MISSING or "multiple" in field.metadata:
        return None
    return field.metadata.get("keyword") if field.default is None else field.default


def _add_default(message: str, default: Any) -> str:
    """Add the default to the help, if it is a word or a number."""
    if default in (None, "", False, ()) or message.endswith(")."):
        return message
    default_text = f"{default:g}" if isinstance(default, float) else str(default)
    return f"{message.rstrip('.')} ({default_text})."


def group(title: str, *options: CommandOption | Iterable[CommandOption]) -> list[CommandOption]:
    """Return options under one title of the help."""
    group_options = _flatten(options)
    for option in group_options:
        option.group = title
    return group_options


def mark_advanced(*options: CommandOption | Iterable[CommandOption]) -> list[CommandOption]:
    """Return the options that the short help omits."""
    advanced_options = _flatten(options)
    for option in advanced_options:
        option.is_advanced = True
    return advanced_options


def _flatten(params: Iterable[Any]) -> list[Any]:
    """Return parameters, also from nested lists, as one list."""
    return list(
        chain.from_iterable(
            [param] if isinstance(param, click.Parameter) else param for param in params
        )
    )


class DashpotCommand(click.Command):
    """Command whose help fits a screen, and whose function receives dataclass values.

    Attributes
    ----------
    detect_kinds : callable or None
        Function from the words of the command to the kinds of the files among them, for a verb
        whose options depend on the kind of record.
    """

    def __init__(
        self,
        name: str,
        *,
        params: Sequence[click.Parameter],
        detect_kinds: Callable[[Sequence[str]], Mapping[str, str]] | None = None,
        **click_options: Any,
    ) -> None:
        options = [
            click.Option(["-h", "--help"], is_flag=True, expose_value=False, hidden=True),
            click.Option(["--help-all"], is_flag=True, expose_value=False, hidden=True),
            click.Option(["--traceback"], is_flag=True, expose_value=False, hidden=True),
        ]
        super().__init__(name, params=[*params, *options], add_help_option=False, **click_options)
        self.detect_kinds = detect_kinds

    @property
    def options(self) -> list[CommandOption]:
        """Options of the command."""
        return [param for param in self.params if isinstance(param, CommandOption)]

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        words = args[: args.index("--")] if "--" in args else args
        if {"-h", "--help", "--help-all"} & set(words):
            files = [word for word in words if not word.startswith("-") and Path(word).is_file()]
            click.echo(self.render_help(ctx, show_all="--help-all" in words, files=files))
            ctx.exit()
        return super().parse_args(ctx, args)

    def collect_usage_pieces(self, ctx: click.Context) -> list[str]:
        argument_names = [
            param.make_metavar(ctx) for param in self.params if isinstance(param, click.Argument)
        ]
        return [*argument_names, "[OPTIONS]"]

    def get_help(self, ctx: click.Context) -> str:
        return self.render_help(ctx)

    def render_help(
        self, ctx: click.Context, *, show_all: bool = False, files: Sequence[str] = ()
    ) -> str:
        """Return the help: the common options, all, or those of the kinds of the files."""
        kinds = self.detect_kinds(files) if files and self.detect_kinds and not show_all else {}
        file_kinds = set(kinds.values())
        if kinds:
            options = [option for option in self.options if option.applies_to(file_kinds)]
        else:
            options = [option for option in self.options if show_all or not option.is_advanced]
        introduction = f"{_format_kinds(kinds)}. These options apply:" if kinds else self.help or ""
        usage = f"Usage: {ctx.command_path} {' '.join(self.collect_usage_pieces(ctx))}"
        lines = [usage, "", *_wrap_text(introduction), "", *_format_groups(options)]
        remaining = len(self.options) - len(options)
        if remaining:
            file_hint = f"; for a file: {ctx.command_path} FILE --help"
            hint = file_hint if self.detect_kinds and not kinds else ""
            lines.append(f"{remaining} more: {ctx.command_path} --help-all{hint}")
        return "\n".join(lines).rstrip("\n")

    def invoke(self, ctx: click.Context) -> Any:
        from dashpot.cli._command_result import run_and_report

        assert self.callback is not None  # noqa: S101
        if "as_json" not in ctx.params:
            return ctx.invoke(self.callback, **self.build_arguments(ctx))
        return run_and_report(ctx, lambda: self.callback(**self.build_arguments(ctx)))  # type: ignore[misc]

    def build_arguments(self, ctx: click.Context) -> dict[str, Any]:
        """Return the arguments of the command function: plain values, and dataclass values."""
        options: dict[str, Any] = {}
        arguments: dict[str, tuple[type, dict[str, dict[str, Any]]]] = {}
        for param in self.params:
            if param.name not in ctx.params or param.name in _OUTPUT_OPTIONS:
                continue
            value = ctx.params[param.name]
            if not isinstance(param, CommandOption) or param.target is None:
                options[param.name] = value
                continue
            cls, argument, fields = param.target
            if argument:
                field_values = arguments.setdefault(argument, (cls, {}))[1]
            else:
                field_values = {"": options}
                options |= {
                    field.name: field.default for field in fields if field.name not in options
                }
            _add_field_values(field_values, param.iterate_field_values(value))
        for argument, (cls, field_values) in arguments.items():
            scoped_values = tuple(
                (glob, cls(**entry)) for glob, entry in field_values.items() if glob
            )
            options[argument] = cls(
                **field_values.get("", {}),
                **({"file_options": scoped_values} if scoped_values else {}),
            )
        return _apply_profiles(ctx, options)


def _add_field_values(
    scoped_values: dict[str, dict[str, Any]], new_values: Iterable[tuple[str, Mapping[str, Any]]]
) -> None:
    """Add the values of fields, for all files ("") or for some, to those stated before."""
    for scope, fields in new_values:
        entries = scoped_values.setdefault(scope, {})
        for name, value in fields.items():
            entries[name] = _merge_values(entries[name], value) if name in entries else value


def _merge_values(old_value: Any, new_value: Any) -> Any:
    """Return the merged values of a field stated twice: both units, both columns, or the last."""
    if isinstance(new_value, dict):
        return old_value | new_value
    return (
        (*old_value, *new_value)
        if isinstance(new_value, tuple) and isinstance(old_value, tuple)
        else new_value
    )


_OUTPUT_OPTIONS = {"as_json", "strict", "verbose", "overwrite", "opens", "size"}
"""Options on the format and the output files of a result, which the output code uses."""


def _apply_profiles(ctx: click.Context, options: dict[str, Any]) -> dict[str, Any]:
    """Fill the options that were not typed from the profiles."""
    if "profile" not in options:
        return options
    from dashpot.cli._read_options import merge_profiles

    options["options"] = merge_profiles(ctx, options["options"], options.pop("profile"))
    return options


def verb(
    name: str,
    message: str,
    *params: click.Parameter | Iterable[click.Parameter],
    **settings: Any,
) -> Callable[[Callable[..., Any]], DashpotCommand]:
    """Make a verb of a function that receives its arguments and options."""

    def make_command(function: Callable[..., Any]) -> DashpotCommand:
        return DashpotCommand(
            name, params=_flatten(params), help=message, callback=function, **settings
        )

    return make_command


def refuse_options(verb: DashpotCommand, ctx: click.Context, kinds: Mapping[str, str]) -> None:
    """Refuse an option that belongs to other kinds of records than the given ones.

    Raises
    ------
    click.UsageError
        If one was typed.
    """
    from dashpot.cli._command_files import format_override_hint
    from dashpot.reading.columns.file_kinds import get_kind_label

    file_kinds = set(kinds.values())
    for option in verb.options:
        if not option.applies_to(file_kinds) and option.get_typed_words(ctx):
            if not option.kinds:
                raise click.UsageError(f"{option.flag} does not suit it. {_format_kinds(kinds)}.")
            *other_kinds, last_kind = dict.fromkeys(
                get_kind_label(word) for word in sorted(option.kinds)
            )
            expected_kinds = (
                f"{', '.join(other_kinds)} or {last_kind}" if other_kinds else last_kind
            )
            override_hint = format_override_hint(option.kinds) if len(kinds) == 1 else ""
            raise click.UsageError(
                f"{option.flag} is for {expected_kinds}. {_format_kinds(kinds)}.{override_hint}"
            )


def _format_kinds(kinds: Mapping[str, str]) -> str:
    """Return the description of each file in a sentence."""
    from dashpot.reading.columns.file_kinds import get_kind_label

    return "; ".join(f"{Path(path).name} is {get_kind_label(word)}" for path, word in kinds.items())


# -- Layout of the help ---------------------------------------------------------------------------


def _format_groups(options: Sequence[CommandOption]) -> list[str]:
    """Return options under their titles."""
    width = min(max(len(_format_option_name(option)) for option in options), NAME_WIDTH)
    lines: list[str] = []
    for title in dict.fromkeys(option.group for option in options):
        lines.append(f"{title}:")
        for item in options:
            if item.group == title:
                lines += _format_option_row(_format_option_name(item), item.help or "", width)
        lines.append("")
    return lines


def _wrap_text(text: str) -> list[str]:
    lines: list[str] = []
    for block in text.strip("\n").split("\n\n"):
        if block.startswith("  "):  # commands and tables stand as they are
            lines += block.splitlines()
        else:
            lines += click.formatting.wrap_text(" ".join(block.split()), WIDTH).splitlines()
        lines.append("")
    return lines[:-1]


def _format_option_name(option: CommandOption) -> str:
    flags = ", ".join(sorted(option.opts, key=len))
    indent = "" if flags.startswith("-") and not flags.startswith("--") else "    "
    return f"{indent}{flags} {option.metavar}" if option.metavar else f"{indent}{flags}"


def _format_option_row(name: str, message: str, width: int) -> list[str]:
    text_width = WIDTH - width - 4
    lines = click.formatting.wrap_text(message, text_width).splitlines() or [""]
    if len(name) <= width:
        first_lines = [f"  {name:<{width}}  {lines[0]}"]
    else:
        first_lines = [f"  {name}", f"  {'':<{width}}  {lines[0]}"]
    return [*first_lines, *(f"  {'':<{width}}  {line}" for line in lines[1:])]
