"""dashpot inspect: what is in a file."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from dashpot import workflow
from dashpot.base.number_format import format_count
from dashpot.base.units import format_quantity
from dashpot.cli import _options as options_of
from dashpot.cli._command import group, opt, verb
from dashpot.cli._command_files import format_command
from dashpot.cli._command_result import CommandResult, write_output
from dashpot.cli._options import READING, RESULT, get_typed_options
from dashpot.cli._param_types import Output
from dashpot.reading.read_options import ReadOptions
from dashpot.registry import KINDS
from dashpot.text_output.layout import Text, table

if TYPE_CHECKING:
    from dashpot.workflow.inspections import InspectedFile


_SHORT = (
    "--column",
    "--units",
    "--profile",
    "--text-format",
    "--file-part",
    "--rate",
    "--calibration",
    "--kind",
)


@verb(
    "inspect",
    """Show what each FILE is, how it was read, and what is unclear.

  dashpot inspect seal_8mm.csv
  dashpot inspect raw.txt --column force=Kraft --units force=N --save lab.toml

The last line names the command that comes next. Settings saved with --save are
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
    inspections = workflow.inspect_files(files, options=options)
    if save:
        from dashpot.reading.read_options import dump_profile

        write_output(save, dump_profile(options))
    summary_lines = [
        line
        for file, path in zip(inspections.files, files, strict=True)
        for line in _answer(file, "" if len(files) == 1 else path)
    ]
    tables = [line for file in inspections.files for line in (file.file, *_columns(file))]
    text = Text(summary_lines, tables) if len(files) > 1 else Text([*summary_lines, *tables[1:]])
    return CommandResult(
        inspections, text, inspections.checks, follow=_follow(files, inspections.files, save)
    )


_ASKED = {
    "formats": "fit FILE --file-part format={}", "kinds": "fit FILE --kind {}",
    "solver_inputs": "export FIT --to {}",
}  # fmt: skip
"""How a plug-in of each group is asked for."""


def _plugins() -> CommandResult:
    """What packages of others add, as their rows say."""
    from dashpot.registry.plugins import read_plugins

    installed = read_plugins()
    rows = [["adds", "name", "package", "asked for by"]]
    rows += [
        [p.group, p.name, p.package_version, _ASKED[p.group].format(p.name)]
        for p in installed.plugins
    ]
    lines = table(rows, align_left=True) if installed.plugins else []
    lines += [f"{sentence}." for sentence in installed.refused or ()]
    return CommandResult(installed, Text(lines or ["no plug-in is installed"]))


def _follow(
    paths: tuple[str, ...], inspections: tuple[InspectedFile, ...], saved: str | None
) -> str:
    """Return the whole command for such files, once no question is open."""
    options = ["--profile", saved] if saved and saved != "-" else get_typed_options(READING)
    if any(inspection.questions or inspection.refusal for inspection in inspections):
        return format_command("inspect", *paths, *options, why="with the option that answers")
    words = _get_next_command(inspections[0])
    return format_command(*words, *paths, *options) if words else ""


def _get_next_command(inspection: InspectedFile) -> tuple[str, ...]:
    kind = KINDS.get(inspection.kind)
    return ("fit",) if kind and kind.fit_route and not kind.required_value else ()


def _answer(inspection: InspectedFile, path: str = "") -> list[str]:
    """Return what a file is, what it still asks, and the test in it; briefly for one of several.

    Of those the first question alone is shown, with the `path` by which the rest are asked for.
    """
    requested = [f"  ASK       {question.message}" for question in inspection.questions]
    if path and requested[1:]:
        requested[1:] = [
            f"  ASK       {len(requested) - 1} more: {format_command('inspect', path)}"
        ]
    lines = [
        f"{inspection.file}: {inspection.kind} ({inspection.reason})",
        *(
            [f"  for       {inspection.use}"]
            if inspection.use and not _get_next_command(inspection)
            else []
        ),
        *requested,
    ]
    if inspection.refusal:
        lines.append(f"  ! cannot be prepared: {inspection.refusal}")
    if inspection.simulated:
        lines.append("  SIMULATED: made by simulation, not measured")
    if inspection.rows:
        lines.append(f"  sampling  {_sampling(inspection)}")
    if test := inspection.preparation:
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
    return [*lines, *(f"  note      {warning}" for warning in inspection.warnings)]


def _columns(inspection: InspectedFile) -> list[str]:
    """Return how a file is written, and its columns with their roles."""
    how = (
        inspection.format,
        inspection.encoding,
        f"delimiter {_format_delimiter(inspection.delimiter)}" if inspection.delimiter else "",
        f"decimal {inspection.decimal!r}" if inspection.decimal else "",
    )
    lines = [f"  format    {', '.join(part for part in how if part)}"]
    if inspection.header:
        lines.append(f"  header    {format_count(len(inspection.header), 'line')} above the table")
    rows = [["  #", "column", "unit", "role", "reason"]]
    rows += [
        [
            f"  {column.number}",
            column.name or "(no name)",
            column.unit or "?",
            column.role or "-",
            column.reason,
        ]
        for column in inspection.columns
    ]
    several = inspection.segments if len(inspection.segments) > 1 else ()
    segments = (
        f"  segment   {segment.name or number}: {segment.rows} rows"
        for number, segment in enumerate(several, start=1)
    )
    return [*lines, *(table(rows, align_left=True) if inspection.columns else []), *segments]


def _sampling(inspection: InspectedFile) -> str:
    if inspection.rate is None:
        return f"{inspection.rows} rows, no clock"
    even = "even" if inspection.even else "uneven"
    duration = "" if inspection.duration is None else f" over {inspection.duration:.5g} s"
    first, *others = inspection.segments
    if duration and any(other.start == first.start for other in others):
        duration = f"{duration} in each segment"  # whose clock begins anew
    return f"{inspection.rows} rows, {inspection.rate:.6g} Hz, {even}{duration}"


def _format_delimiter(mark: str) -> str:
    return {"\t": "tab", " ": "space"}.get(mark, repr(mark))
