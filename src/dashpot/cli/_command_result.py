"""Result of a command: printed text, written files and exit code."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

import dashpot as dp
from dashpot.base.plain_text import escaped_json
from dashpot.cli._param_types import Output
from dashpot.cli._terminal import to_stderr, to_stdout
from dashpot.text_output.layout import Text

if TYPE_CHECKING:
    from dashpot.base.checks import Check, Verdict
    from dashpot.base.serialisation import Serialisable
    from dashpot.workflow.outputs import Outputs


WRITTEN, STDOUT_TAKEN = "dashpot.written", "dashpot.stdout"
OUTCOME_JUDGE = "dashpot.judge"
"""Key of the function that judges the outcome."""
_RECORD_WRITERS = ("simulate", "demo")
"""Commands that write records; to all others a record is somebody's measurement."""
_VISUAL_SUFFIXES = (".html", ".png", ".svg", ".pdf")


def collect_outputs(context: click.Context, *, may_replace: bool) -> Outputs:
    """Return the output paths of a command, checked for writing; every other path is read."""
    from dashpot.workflow.outputs import Outputs

    is_output = {param.name: isinstance(param.type, Output) for param in context.command.params}
    paths: dict[bool, list[str]] = {True: [], False: []}
    for name, value in context.params.items():
        items = value if isinstance(value, tuple) else (value,)
        paths[is_output.get(name, False)] += [
            item for item in items if isinstance(item, str) and item != "-"
        ]
    inputs = tuple(word for word in paths[False] if Path(word).is_file())
    outputs = Outputs(inputs, may_replace, makes_records=context.command.name in _RECORD_WRITERS)
    outputs.check_writable(paths[True])
    return outputs


def note_input(context: click.Context, path: str) -> None:
    """Count a file among the inputs that no argument names."""
    context.obj = replace(context.obj, inputs=(*context.obj.inputs, path))


def claim_outputs(paths: Iterable[str | Path]) -> None:
    """Refuse, before the work, files that no option names and that could not be written."""
    outputs: Outputs = click.get_current_context().obj
    outputs.check_writable(paths)


def write_output(path: str | Path, content: str | bytes) -> None:
    """Write a file, which is listed at the end of the command; ``-`` is stdout.

    Under ``--json`` stdout belongs to the document.
    """
    context = click.get_current_context()
    if str(path) != "-":
        outputs: Outputs = context.obj
        outputs.write(path, content)
        note_written(path)
        return
    context.meta[STDOUT_TAKEN] = True
    if not context.params["as_json"]:
        to_stdout(content if isinstance(content, str) else content.decode())


def note_written(path: str | Path) -> None:
    """Record a written file; the command names it at its end, and opens it with ``--open``."""
    click.get_current_context().meta.setdefault(WRITTEN, []).append(str(path))


def write_figure(path: str, figure: dp.plot.Picture) -> None:
    """Write a figure in the format of its file's suffix."""
    size = click.get_current_context().params.get("size")
    write_output(path, dp.plot.render_figure(figure, Path(path).suffix, size=size))


def open_written(paths: Sequence[str]) -> None:
    """Open the last page or figure that was written, or say why not."""
    pages = [path for path in paths if Path(path).suffix.lower() in _VISUAL_SUFFIXES]
    if not pages:
        to_stderr("nothing to open: name a page (-o page.html) or a figure (--plot fit.png)")
    elif click.launch(pages[-1]):
        to_stderr(f"{pages[-1]} could not be opened: no program for it was found")


# Running of a command: its printed result and its exit code.


class CommandResult(NamedTuple):
    """Result of a command, for programs and as text, with its checks.

    Attributes
    ----------
    result
        What it prints as a document.
    text
        It is printed unless stdout is taken by what was requested there.
    must_pass
        A failed check is this command's own failure, ``--strict`` or not.
    verdict
        Leads the text; ``--strict`` heeds its checks, or all where there is no verdict.
    next_command
        The command that comes next, if it can be named.
    nothing_done
        Nothing that was given could be used: the exit code is that of bad input.
    unmet
        An acceptance limit is not met, which ``--strict`` heeds.
    """

    result: Serialisable
    text: Text
    checks: Sequence[Check] = ()
    must_pass: bool = False
    verdict: Verdict | None = None
    next_command: str = ""
    nothing_done: bool = False
    unmet: bool = False

    @classmethod
    def from_result(cls, result: Any, *, next_command: str = "") -> CommandResult:
        """Return the text, the checks and the verdict of a result."""
        from dashpot.text_output import render_text

        return cls(
            result,
            render_text(result),
            result.checks,
            verdict=result.verdict,
            next_command=next_command,
        )

    @property
    def weighty(self) -> list[Check]:
        """The checks that failed and are more than a note."""
        checks = self.checks if self.verdict is None else self.verdict.failed_checks
        return [check for check in checks if check.failed and check.grade != "note"]


def run_and_report(context: click.Context, run: Callable[[], CommandResult]) -> None:
    """Run a verb; turn its outcome into output and an exit code.

    stdout gets the text or, with ``--json``, one JSON document and nothing else; stderr then lists
    the written files and the next commands. Where the outputs go is settled before any work is
    done; what goes wrong is the group's to say.
    """
    from dashpot.cli._terminal import show_progress  # a page of help shows none

    params = context.params
    context.obj = collect_outputs(context, may_replace=params.get("overwrite", False))
    is_json, written_files = params["as_json"], context.meta.setdefault(WRITTEN, [])
    try:
        with show_progress():
            outcome = run()
            if OUTCOME_JUDGE in context.meta:
                outcome = context.meta[OUTCOME_JUDGE](outcome)
            text = _format_result(outcome, as_json=is_json, verbose=params.get("verbose", False))
        if text:
            to_stdout(text)
    finally:
        for path in dict.fromkeys(written_files):
            to_stderr(f"wrote {path}")
    if params.get("opens"):
        open_written(written_files)
    if outcome.next_command and not is_json:
        to_stderr(f"next: {outcome.next_command}")
    if outcome.nothing_done:
        sys.exit(2)
    if (params.get("strict") or outcome.must_pass) and (outcome.weighty or outcome.unmet):
        sys.exit(1)


def _format_result(outcome: CommandResult, *, as_json: bool, verbose: bool) -> str:
    if as_json:
        return format_json(outcome.result)
    if click.get_current_context().meta.get(STDOUT_TAKEN):
        return ""
    from dashpot.cli._terminal import get_screen_size
    from dashpot.text_output.layout import format_for_screen

    parts = outcome.text, outcome.verdict, outcome.checks
    return "\n".join(
        format_for_screen(*parts, verbose=verbose, style=click.style, size=get_screen_size())
    )


def format_json(result: Serialisable) -> str:
    """Return a result as the JSON that commands print and write: it names its schema."""
    import json

    document = result.to_dict()
    if "schema" not in document:
        raise TypeError(f"the document of {type(result).__name__} names no schema")
    return escaped_json(json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False))
