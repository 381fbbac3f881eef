"""dashpot inspect: the contents of a file."""

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


_COMMON_FLAGS = (
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
    options_of.file_argument("FILE...", min_count=0),
    options_of.reading_options(common_flags=_COMMON_FLAGS),
    group(
        RESULT,
        opt("--save", type=Output([".toml"]), metavar="FILE",
            help="Save these answers as a profile (.toml)."),
        opt("--plugins", help="List installed plug-ins; none is loaded."),
    ),
    options_of.result_options(plot=False, has_open_option=False),
)  # fmt: skip
def command(
    *, files: tuple[str, ...], save: str | None, plugins: bool, options: ReadOptions
) -> CommandResult:
    """Inspect files, and save the stated options as a profile; or list the plug-ins."""
    if plugins:
        if files:
            raise click.UsageError("--plugins lists packages and inspects no file. Leave one out.")
        return _list_plugins()
    if not files:
        raise click.UsageError("Missing argument 'FILE...'.")
    inspections = workflow.inspect_files(files, options=options)
    if save:
        from dashpot.reading.read_options import dump_profile

        write_output(save, dump_profile(options))
    summary_lines = [
        line
        for file, path in zip(inspections.files, files, strict=True)
        for line in _format_inspection(file, "" if len(files) == 1 else path)
    ]
    tables = [line for file in inspections.files for line in (file.file, *_format_columns(file))]
    text = Text(summary_lines, tables) if len(files) > 1 else Text([*summary_lines, *tables[1:]])
    return CommandResult(
        inspections,
        text,
        inspections.checks,
        next_command=_format_next_command(files, inspections.files, save),
    )


_USES = {
    "formats": "fit FILE --file-part format={}", "kinds": "fit FILE --kind {}",
    "solver_inputs": "export FIT --to {}",
}  # fmt: skip
"""How a plug-in of each group is asked for."""


def _list_plugins() -> CommandResult:
    """Return the installed plug-ins as text."""
    from dashpot.registry.plugins import read_plugins

    installed = read_plugins()
    rows = [["adds", "name", "package", "asked for by"]]
    rows += [
        [plugin.group, plugin.name, plugin.package_version, _USES[plugin.group].format(plugin.name)]
        for plugin in installed.plugins
    ]
    lines = table(rows, align_left=True) if installed.plugins else []
    lines += [f"{sentence}." for sentence in installed.refusals or ()]
    return CommandResult(installed, Text(lines or ["no plug-in is installed"]))


def _format_next_command(
    paths: tuple[str, ...], inspections: tuple[InspectedFile, ...], profile: str | None
) -> str:
    """Return the whole command for such files, once no question is open."""
    options = ["--profile", profile] if profile and profile != "-" else get_typed_options(READING)
    if any(inspection.questions or inspection.refusal for inspection in inspections):
        return format_command("inspect", *paths, *options, remark="with the option that answers")
    next_words = _get_next_command(inspections[0])
    return format_command(*next_words, *paths, *options) if next_words else ""


def _get_next_command(inspection: InspectedFile) -> tuple[str, ...]:
    kind = KINDS.get(inspection.kind)
    return ("fit",) if kind and kind.fit_route and not kind.required_value else ()


def _format_inspection(inspection: InspectedFile, shown_path: str = "") -> list[str]:
    """Return the kind of a file, its open questions and its test; briefly for one of several.

    Of such a file only the first question is shown, with the command that shows the others.
    """
    question_lines = [f"  ASK       {question.message}" for question in inspection.questions]
    if shown_path and question_lines[1:]:
        question_lines[1:] = [
            f"  ASK       {len(question_lines) - 1} more: {format_command('inspect', shown_path)}"
        ]
    lines = [
        f"{inspection.file}: {inspection.kind} ({inspection.reason})",
        *(
            [f"  for       {inspection.use}"]
            if inspection.use and not _get_next_command(inspection)
            else []
        ),
        *question_lines,
    ]
    if inspection.refusal:
        lines.append(f"  ! cannot be prepared: {inspection.refusal}")
    if inspection.simulated:
        lines.append("  SIMULATED: made by simulation, not measured")
    if inspection.rows:
        lines.append(f"  sampling  {_format_sampling(inspection)}")
    if preparation := inspection.preparation:
        lines += [
            (
                f"  ramp      {preparation.onset:.4g} to {preparation.ramp_end:.4g} s "
                f"({preparation.ramp_time:.4g} s), "
                f"{format_quantity(preparation.depth, 'mm')}"
            ),
            f"  hold      to {preparation.hold_end:.5g} s ({preparation.hold_time:.4g} s)",
            (
                f"  noise     force {format_quantity(preparation.force_noise, 'mN', '.3g')}, "
                f"displacement {format_quantity(preparation.displacement_noise, 'um', '.3g')}"
            ),
        ]
    return [*lines, *(f"  note      {warning}" for warning in inspection.warnings)]


def _format_columns(inspection: InspectedFile) -> list[str]:
    """Return how a file is written, and its columns with their roles."""
    format_parts = (
        inspection.format,
        inspection.encoding,
        f"delimiter {_format_delimiter(inspection.delimiter)}" if inspection.delimiter else "",
        f"decimal {inspection.decimal!r}" if inspection.decimal else "",
    )
    lines = [f"  format    {', '.join(text for text in format_parts if text)}"]
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
    segments_shown = inspection.segments if len(inspection.segments) > 1 else ()
    segments = (
        f"  segment   {segment.name or number}: {segment.rows} rows"
        for number, segment in enumerate(segments_shown, start=1)
    )
    return [*lines, *(table(rows, align_left=True) if inspection.columns else []), *segments]


def _format_sampling(inspection: InspectedFile) -> str:
    if inspection.rate is None:
        return f"{inspection.rows} rows, no clock"
    evenness = "even" if inspection.even else "uneven"
    duration = "" if inspection.duration is None else f" over {inspection.duration:.5g} s"
    first_segment, *other_segments = inspection.segments
    if duration and any(other.start == first_segment.start for other in other_segments):
        duration = f"{duration} in each segment"  # whose clock begins anew
    return f"{inspection.rows} rows, {inspection.rate:.6g} Hz, {evenness}{duration}"


def _format_delimiter(delimiter: str) -> str:
    return {"\t": "tab", " ": "space"}.get(delimiter, repr(delimiter))
