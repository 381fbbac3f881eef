"""dashpot inspect: what is in a file."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from dashpot import workflow
from dashpot.base.number_format import format_count
from dashpot.base.units import format_quantity
from dashpot.cli import _options as options_of
from dashpot.cli._command import group, opt, verb
from dashpot.cli._command_io import CommandResult, format_command, write
from dashpot.cli._options import READING, RESULT, get_typed_options
from dashpot.cli._param_types import Output
from dashpot.reading.read_options import ReadOptions
from dashpot.registry import KINDS
from dashpot.text_output.layout import Text, table

if TYPE_CHECKING:
    from dashpot.workflow.inspections import InspectedFile


_SHORT = ("--column", "--units", "--profile", "--text", "--part", "--rate", "--calibration", "--as")


@verb(
    "inspect",
    """Show what each FILE is, how it was read, and what is unclear.

  dashpot inspect seal_8mm.csv
  dashpot inspect raw.txt --column force=Kraft --units force=N --save lab.toml

The last line names the command that comes next. Answers saved with --save are
given to every other command by --profile lab.toml, or hammer*.csv:lab.toml for
some files alone.""",
    options_of.files("FILE...", least=0),
    options_of.reading(short=_SHORT),
    group(
        RESULT,
        opt("--save", type=Output([".toml"]), metavar="FILE",
            help="Save these answers as a profile (.toml)."),
        opt("--plugins", help="List installed plug-ins; none is loaded."),
    ),
    options_of.result(plot=False, opens=False),
)  # fmt: skip
def command(
    *, files: tuple[str, ...], save: str | None, plugins: bool, options: ReadOptions
) -> CommandResult:
    """Inspect files, and keep what was said of them; or list the plug-ins."""
    if plugins:
        if files:
            raise click.UsageError("--plugins lists packages and inspects no file. Leave one out.")
        return _plugins()
    if not files:
        raise click.UsageError("Missing argument 'FILE...'.")
    found = workflow.inspect_files(files, options=options)
    if save:
        from dashpot.reading.read_options import dump_profile

        write(save, dump_profile(options))
    answers = [
        line
        for one, path in zip(found.files, files, strict=True)
        for line in _answer(one, "" if len(files) == 1 else path)
    ]
    tables = [line for one in found.files for line in (one.file, *_columns(one))]
    text = Text(answers, tables) if len(files) > 1 else Text([*answers, *tables[1:]])
    return CommandResult(found, text, found.checks, follow=_follow(files, found.files, save))


_ASKED = {
    "formats": "fit FILE --part format={}", "kinds": "fit FILE --as {}",
    "decks": "export FIT --to {}",
}  # fmt: skip
"""How a plug-in of each group is asked for."""


def _plugins() -> CommandResult:
    """What packages of others add, as their metadata say."""
    from dashpot.base.plugins import Installed, plugins

    found = Installed(plugins())
    rows = [["adds", "name", "package", "asked for by"]]
    rows += [
        [p.group, p.name, p.package_version, _ASKED[p.group].format(p.name)] for p in found.plugins
    ]
    lines = table(rows, left=True) if found.plugins else ["no plug-in is installed"]
    return CommandResult(found, Text([line.rstrip() for line in lines]))


def _follow(paths: tuple[str, ...], found: tuple[InspectedFile, ...], saved: str | None) -> str:
    """Return the whole command for such files, once no question is open."""
    said = ["--profile", saved] if saved and saved != "-" else get_typed_options(READING)
    if any(each.questions or each.refusal for each in found):
        return format_command("inspect", *paths, *said, why="with the option that answers")
    words = _get_next_command(found[0])
    return format_command(*words, *paths, *said) if words else ""


def _get_next_command(found: InspectedFile) -> tuple[str, ...]:
    kind = KINDS.get(found.kind)
    return ("fit",) if kind and kind.meant and not kind.needs else ()


def _answer(found: InspectedFile, path: str = "") -> list[str]:
    """Return what a file is, what it still asks, and the test in it; briefly for one of several.

    Of those the first question alone is shown, with the `path` by which the rest are asked for.
    """
    asked = [f"  ASK       {question.says}" for question in found.questions]
    if path and asked[1:]:
        asked[1:] = [f"  ASK       {len(asked) - 1} more: {format_command('inspect', path)}"]
    lines = [
        f"{found.file}: {found.kind} ({found.reason})",
        *([f"  for       {found.use}"] if found.use and not _get_next_command(found) else []),
        *asked,
    ]
    if found.refusal:
        lines.append(f"  ! cannot be prepared: {found.refusal}")
    if found.simulated:
        lines.append("  SIMULATED: made by the virtual rig or hammer, not measured")
    if found.rows:
        lines.append(f"  sampling  {_sampling(found)}")
    if test := found.preparation:
        lines += [
            (
                f"  ramp      {test.onset:.4g} to {test.ramp_end:.4g} s ({test.ramp_time:.4g} s), "
                f"{format_quantity(test.depth, 'mm')}"
            ),
            f"  hold      to {test.hold_end:.5g} s ({test.hold_time:.4g} s)",
            (
                f"  noise     force {format_quantity(test.force_noise, 'mN', '.3g')}, "
                f"displacement {format_quantity(test.displacement_noise, 'um', '.3g')}"
            ),
        ]
    return [*lines, *(f"  note      {warning}" for warning in found.warnings)]


def _columns(found: InspectedFile) -> list[str]:
    """Return how a file is written, and its columns with their roles."""
    how = (
        found.format,
        found.encoding,
        f"delimiter {_format_delimiter(found.delimiter)}" if found.delimiter else "",
        f"decimal {found.decimal!r}" if found.decimal else "",
    )
    lines = [f"  format    {', '.join(part for part in how if part)}"]
    if found.header:
        lines.append(f"  header    {format_count(len(found.header), 'line')} above the table")
    rows = [["  #", "column", "unit", "role", "because"]]
    rows += [
        [
            f"  {column.number}",
            column.name or "(no name)",
            column.unit or "?",
            column.role or "-",
            column.reason,
        ]
        for column in found.columns
    ]
    several = found.segments if len(found.segments) > 1 else ()
    segments = (
        f"  segment   {segment.name or number}: {segment.rows} rows"
        for number, segment in enumerate(several, start=1)
    )
    return [*lines, *(table(rows, left=True) if found.columns else []), *segments]


def _sampling(found: InspectedFile) -> str:
    if found.rate is None:
        return f"{found.rows} rows, no clock"
    even = "even" if found.even else "uneven"
    duration = "" if found.duration is None else f" over {found.duration:.5g} s"
    first, *others = found.segments
    if duration and any(one.start == first.start for one in others):
        duration = f"{duration} in each segment"  # whose clock begins anew
    return f"{found.rows} rows, {found.rate:.6g} Hz, {even}{duration}"


def _format_delimiter(mark: str) -> str:
    return {"\t": "tab", " ": "space"}.get(mark, repr(mark))
