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

from dashpot.base.option_fields import flag_of, iterate_option_fields
from dashpot.cli._param_types import Keyed, Scoped, type_of

WIDTH = 80
"""Columns of a page of help."""
NAMES = 27
"""Of them for the name of an option; what is longer stands on a line of its own."""
LIMIT = 40
"""Lines that the help of a verb may take."""

TYPED = "dashpot.typed"
"""Where options are kept as they were typed."""

KEYED = {
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
"""What an option of several keys takes, and says."""


class TargetFields(NamedTuple):
    """Fields that an option fills: those of a dataclass argument, or arguments by themselves."""

    cls: type
    receives: str
    fields: tuple[Field[Any], ...]


class CommandOption(click.Option):
    """Option with its group in the help, and the kinds of records to which it applies.

    `former` is its name in the edition before: still taken, and shown nowhere.
    """

    def __init__(
        self,
        *flags: str,
        kinds: Iterable[str] = (),
        more: bool = False,
        fills: TargetFields | None = None,
        former: str = "",
        **how: Any,
    ) -> None:
        super().__init__(flags, **how)
        self.group = ""
        self.kinds = frozenset(kinds)
        self.unheard: frozenset[str] = frozenset()
        """Kinds that do not take it, of an option that is of no kind alone."""
        self.more = more
        self.fills = fills
        self.former = former

    def add_to_parser(self, parser: Any, ctx: click.Context) -> None:
        shown, self.opts = self.opts, self.list_spellings()  # click shows what `opts` holds
        super().add_to_parser(parser, ctx)
        self.opts = shown

    def list_spellings(self) -> list[str]:
        """Return the option as it is typed, also as in the edition before."""
        return [*self.opts, *([f"--{self.former}"] if self.former else [])]

    @property
    def flag(self) -> str:
        """Option as it is typed."""
        return max(self.opts, key=len)

    def consume_value(self, ctx: click.Context, opts: Mapping[str, Any]) -> tuple[Any, Any]:
        value, source = super().consume_value(ctx, opts)
        if source is click.core.ParameterSource.COMMANDLINE:
            ctx.meta.setdefault(TYPED, {})[self.name] = value
        return value, source

    def suits(self, kinds: set[str]) -> bool:
        """Return whether it is for records of any of these kinds."""
        if self.kinds:
            return not self.kinds.isdisjoint(kinds)
        return not kinds or not self.unheard >= kinds

    @property
    def names(self) -> set[str]:
        """Names of the arguments of the command function: its fields, or the value that they
        fill.
        """
        if self.fills is None:
            return {str(self.name)}
        return {self.fills.receives, *(field.name for field in self.fills.fields)}

    def iterate_field_values(self, value: Any) -> Iterator[tuple[str, dict[str, Any]]]:
        """Yield what its fields are by what click passes on, for all files ("") or for some."""
        assert self.fills is not None  # noqa: S101
        field = self.fills.fields[0]
        if isinstance(self.type, Keyed):
            yield from value or ()
        elif isinstance(self.type, Scoped):
            yield from ((glob, {field.name: item}) for glob, item in value or ())
        else:
            how = field.metadata
            yield "", {field.name: how["parse"](value) if "parse" in how else value}

    def get_typed_words(self, ctx: click.Context) -> list[str]:
        """Return its words as they were typed; nothing where it was not."""
        stated = ctx.meta.get(TYPED, {})
        if self.name not in stated:
            return []
        value = stated[self.name]
        if self.is_flag:
            return [self.flag]
        several = value if isinstance(value, list | tuple) else (value,)
        return [word for item in several for word in (self.flag, str(item))]


def opt(*flags: str, kinds: str = "", **how: Any) -> CommandOption:
    """Return an option; without a metavar and a type it is a flag."""
    if "metavar" not in how and "type" not in how:
        how["is_flag"] = True
    return CommandOption(*flags, kinds=kinds.split(), **how)


def build_options(
    cls: type,
    *names: str,
    into: str = "",
    leave: Sequence[str] = (),
    kinds: str = "",
    more: bool = False,
    **other: Any,
) -> list[CommandOption]:
    """Return the options that these fields of a dataclass declare, or all.

    A command function receives each, or the value as one argument, `into`. `other` is what these
    options say otherwise here: `help`, `default`, `required`, `metavar`.
    """
    every = {field.name: field for field in iterate_option_fields(cls) if field.name not in leave}
    rows: dict[str, list[Field[Any]]] = {}
    for name in names or every:
        rows.setdefault(flag_of(every[name]), []).append(every[name])
    return [
        _make_option(flag, TargetFields(cls, into, tuple(row)), kinds=kinds, more=more, **other)
        for flag, row in rows.items()
    ]


def _make_option(
    flag: str, fills: TargetFields, *, kinds: str, more: bool, **other: Any
) -> CommandOption:
    (field, *_), name = fills.fields, f"{fills.receives}_{fills.fields[0].name}"
    how: dict[str, Any] = {}
    if "under" in field.metadata or len(fills.fields) > 1:
        metavar, message = KEYED[flag]
        how = {"type": Keyed(flag, fills.fields), "multiple": True, "metavar": metavar}
        how["help"] = message
    else:
        how = {key: field.metadata[key] for key in _PASSED if key in field.metadata}
        how["default"] = _get_default(field)
        if "is_flag" not in how:
            kind = how["type"] = type_of(field)
            how.setdefault("metavar", _metavar(kind))
    how |= other
    how["help"] = _with_default(how.get("help") or "", how.get("default"))
    how.setdefault("former", field.metadata.get("former", ""))
    return CommandOption(flag, name, kinds=kinds.split(), more=more, fills=fills, **how)


def _metavar(kind: click.ParamType[Any]) -> str:
    """Return what stands for a value: its words, its dimension, or a number."""
    if isinstance(kind, click.Choice):
        return "|".join(kind.choices)
    return _NUMBERS.get(kind.name, kind.name.upper())


_NUMBERS = {"float": "N", "integer": "N", "integer range": "N", "text": "NAME"}
_PASSED = ("help", "metavar", "multiple", "is_flag")


def _get_default(field: Field[Any]) -> Any:
    """Return what click takes where nothing is typed."""
    if "is_flag" in field.metadata:
        return False
    if field.default is MISSING or "multiple" in field.metadata:
        return None
    return field.metadata.get("word") if field.default is None else field.default


def _with_default(message: str, default: Any) -> str:
    """Say what is usual, where that is a word or a number."""
    if default in (None, "", False, ()) or message.endswith(")."):
        return message
    shown = f"{default:g}" if isinstance(default, float) else str(default)
    return f"{message.rstrip('.')} ({shown})."


def group(title: str, *options: CommandOption | Iterable[CommandOption]) -> list[CommandOption]:
    """Return options under one title of the help."""
    flat = _flatten(options)
    for item in flat:
        item.group = title
    return flat


def mark_advanced(*options: CommandOption | Iterable[CommandOption]) -> list[CommandOption]:
    """Return options that the short help leaves out."""
    flat = _flatten(options)
    for item in flat:
        item.more = True
    return flat


def _flatten(params: Iterable[Any]) -> list[Any]:
    """Return parameters and those of lists of them in one list."""
    return list(
        chain.from_iterable(
            [param] if isinstance(param, click.Parameter) else param for param in params
        )
    )


class DashpotCommand(click.Command):
    """Command whose help fits a screen, and whose function receives dataclass values.

    Attributes
    ----------
    by_kind : callable or None
        From words of the command to the kinds of the files in them; of a verb whose options are of
        kinds of records.
    """

    def __init__(
        self,
        name: str,
        *,
        params: Sequence[click.Parameter],
        by_kind: Callable[[Sequence[str]], Mapping[str, str]] | None = None,
        **how: Any,
    ) -> None:
        options = [
            click.Option(["-h", "--help"], is_flag=True, expose_value=False, hidden=True),
            click.Option(["--help-all"], is_flag=True, expose_value=False, hidden=True),
            click.Option(["--traceback"], is_flag=True, expose_value=False, hidden=True),
        ]
        super().__init__(name, params=[*params, *options], add_help_option=False, **how)
        self.by_kind = by_kind

    @property
    def options(self) -> list[CommandOption]:
        """Options of the command."""
        return [param for param in self.params if isinstance(param, CommandOption)]

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        words = args[: args.index("--")] if "--" in args else args
        if {"-h", "--help", "--help-all"} & set(words):
            files = [word for word in words if not word.startswith("-") and Path(word).is_file()]
            click.echo(self.render_help(ctx, every="--help-all" in words, files=files))
            ctx.exit()
        return super().parse_args(ctx, args)

    def collect_usage_pieces(self, ctx: click.Context) -> list[str]:
        named = [
            param.make_metavar(ctx) for param in self.params if isinstance(param, click.Argument)
        ]
        return [*named, "[OPTIONS]"]

    def get_help(self, ctx: click.Context) -> str:
        return self.render_help(ctx)

    def render_help(
        self, ctx: click.Context, *, every: bool = False, files: Sequence[str] = ()
    ) -> str:
        """Return the help: the common options, all, or those of the kinds of the files."""
        kinds = self.by_kind(files) if files and self.by_kind and not every else {}
        have = set(kinds.values())
        if kinds:
            options = [option for option in self.options if option.suits(have)]
        else:
            options = [option for option in self.options if every or not option.more]
        head = f"{_format_kinds(kinds)}. These options apply:" if kinds else self.help or ""
        usage = f"Usage: {ctx.command_path} {' '.join(self.collect_usage_pieces(ctx))}"
        lines = [usage, "", *_wrap_text(head), "", *_groups(options)]
        remaining = len(self.options) - len(options)
        if remaining:
            name = f"; for a file: {ctx.command_path} FILE --help"
            again = name if self.by_kind and not kinds else ""
            lines.append(f"{remaining} more: {ctx.command_path} --help-all{again}")
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
            if param.name not in ctx.params or param.name in _TOLD_APART:
                continue
            value = ctx.params[param.name]
            if not isinstance(param, CommandOption) or param.fills is None:
                options[param.name] = value
                continue
            cls, receives, fields = param.fills
            if receives:
                stated = arguments.setdefault(receives, (cls, {}))[1]
            else:
                stated = {"": options}
                options |= {
                    field.name: field.default for field in fields if field.name not in options
                }
            _gather(stated, param.iterate_field_values(value))
        for receives, (cls, stated) in arguments.items():
            pairs = tuple((glob, cls(**entry)) for glob, entry in stated.items() if glob)
            options[receives] = cls(**stated.get("", {}), **({"own": pairs} if pairs else {}))
        return _with_profile(ctx, options)


def _gather(
    stated: dict[str, dict[str, Any]], rows: Iterable[tuple[str, Mapping[str, Any]]]
) -> None:
    """Add the values of fields, for all files ("") or for some, to those stated before."""
    for scope, fields in rows:
        entries = stated.setdefault(scope, {})
        for name, field in fields.items():
            entries[name] = _merge_values(entries[name], field) if name in entries else field


def _merge_values(first: Any, then: Any) -> Any:
    """Return the merged values of a field stated twice: both units, both columns, or the last."""
    if isinstance(then, dict):
        return first | then
    return (*first, *then) if isinstance(then, tuple) and isinstance(first, tuple) else then


_TOLD_APART = {"as_json", "strict", "verbose", "overwrite", "opens", "size"}
"""Options on the format and the output files of a result, which the output code uses."""


def _with_profile(ctx: click.Context, options: dict[str, Any]) -> dict[str, Any]:
    """Lay what the profiles say below what was typed."""
    if "profile" not in options:
        return options
    from dashpot.cli._read_options import over_profiles

    options["options"] = over_profiles(ctx, options["options"], options.pop("profile"))
    return options


def verb(
    name: str, message: str, *params: click.Parameter | Iterable[click.Parameter], **how: Any
) -> Callable[[Callable[..., Any]], DashpotCommand]:
    """Make a verb of a function that receives its arguments and options."""

    def make_command(function: Callable[..., Any]) -> DashpotCommand:
        return DashpotCommand(name, params=_flatten(params), help=message, callback=function, **how)

    return make_command


def refuse_others(verb: DashpotCommand, ctx: click.Context, kinds: Mapping[str, str]) -> None:
    """Refuse an option that is of other kinds of records than those that were given.

    Raises
    ------
    click.UsageError
        If one was typed.
    """
    from dashpot.cli._command_files import format_override_hint
    from dashpot.reading.columns.file_kinds import get_kind_label

    have = set(kinds.values())
    for option in verb.options:
        if not option.suits(have) and option.get_typed_words(ctx):
            if not option.kinds:
                raise click.UsageError(f"{option.flag} does not suit it. {_format_kinds(kinds)}.")
            *others, last = dict.fromkeys(get_kind_label(word) for word in sorted(option.kinds))
            wanted = f"{', '.join(others)} or {last}" if others else last
            but = format_override_hint(option.kinds) if len(kinds) == 1 else ""
            raise click.UsageError(f"{option.flag} is for {wanted}. {_format_kinds(kinds)}.{but}")


def _format_kinds(kinds: Mapping[str, str]) -> str:
    """Return what each file is called, in a sentence."""
    from dashpot.reading.columns.file_kinds import get_kind_label

    return "; ".join(f"{Path(path).name} is {get_kind_label(word)}" for path, word in kinds.items())


# -- how it is laid out ---------------------------------------------------------------------------


def _groups(options: Sequence[CommandOption]) -> list[str]:
    """Return options under their titles."""
    width = min(max(len(_format_option_name(option)) for option in options), NAMES)
    lines: list[str] = []
    for title in dict.fromkeys(option.group for option in options):
        lines.append(f"{title}:")
        for item in options:
            if item.group == title:
                lines += _row(_format_option_name(item), item.help or "", width)
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
    lead = "" if flags.startswith("-") and not flags.startswith("--") else "    "
    return f"{lead}{flags} {option.metavar}" if option.metavar else f"{lead}{flags}"


def _row(name: str, message: str, width: int) -> list[str]:
    space = WIDTH - width - 4
    lines = click.formatting.wrap_text(message, space).splitlines() or [""]
    if len(name) <= width:
        first = [f"  {name:<{width}}  {lines[0]}"]
    else:
        first = [f"  {name}", f"  {'':<{width}}  {lines[0]}"]
    return [*first, *(f"  {'':<{width}}  {line}" for line in lines[1:])]
