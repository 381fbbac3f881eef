"""Input, output and exit codes that all commands share."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

import dashpot as dp
from dashpot import workflow
from dashpot.base.errors import ReadError
from dashpot.base.plain_text import escaped_json
from dashpot.base.units import convert_to_unit
from dashpot.cli._param_types import Output
from dashpot.cli._terminal import to_stderr, to_stdout
from dashpot.text_output.layout import Text

if TYPE_CHECKING:
    from dashpot.base.checks import Check, Verdict
    from dashpot.base.serialisation import Serialisable
    from dashpot.reading.read_options import ReadOptions
    from dashpot.reading.readers.detect_kind import Recognised
    from dashpot.solids.shift_laws import TemperatureLaw
    from dashpot.workflow.outputs import Outputs


# Result of a command, input and output files, exit codes.


_WRITTEN, _TAKEN = "dashpot.written", "dashpot.stdout"
_MAKERS = ("simulate", "demo")
"""Commands that write records; to all others a record is somebody's measurement."""
_SEEN = (".html", ".png", ".svg", ".pdf")


class CommandResult(NamedTuple):
    """Result of a command, for programs and as text, with its checks.

    Attributes
    ----------
    found
        What it prints as a document.
    text
        It is printed unless stdout is taken by what was asked for there.
    must_pass
        A failed check is this command's own failure, ``--strict`` or not.
    verdict
        Leads the text; ``--strict`` heeds its checks, or all where there is no verdict.
    follow
        The command that comes next, if it can be named.
    nothing_done
        Nothing that was given could be used: the exit code is that of bad input.
    """

    found: Serialisable
    text: Text
    checks: Sequence[Check] = ()
    must_pass: bool = False
    verdict: Verdict | None = None
    follow: str = ""
    nothing_done: bool = False

    @classmethod
    def from_result(cls, result: Any, *, follow: str = "") -> CommandResult:
        """Return the text, the checks and the verdict of a result."""
        from dashpot.text_output import render_text

        return cls(
            result, render_text(result), result.checks, verdict=result.verdict, follow=follow
        )

    @property
    def weighty(self) -> list[Check]:
        """The checks that failed and are more than a note."""
        checks = self.checks if self.verdict is None else self.verdict.failed_checks
        return [check for check in checks if check.failed and check.grade != "note"]


def run_and_report(context: click.Context, run: Callable[[], CommandResult]) -> None:
    """Run a verb; turn its outcome into output and an exit code.

    stdout gets the text or, with ``--json``, one JSON document and nothing else; then stderr says
    what was written and what comes next. Where the outputs go is settled before any work is done;
    what goes wrong is the group's to say.
    """
    from dashpot.cli._terminal import progress  # a page of help shows none

    params = context.params
    context.obj = _outputs(context, may_replace=params.get("overwrite", False))
    as_json, written = params["as_json"], context.meta.setdefault(_WRITTEN, [])
    try:
        with progress():
            outcome = run()
            text = _format_result(outcome, as_json=as_json, verbose=params.get("verbose", False))
        if text:
            to_stdout(text)
    finally:
        for path in dict.fromkeys(written):
            to_stderr(f"wrote {path}")
    if params.get("opens"):
        _open(written)
    if outcome.follow and not as_json:
        to_stderr(f"next: {outcome.follow}")
    if outcome.nothing_done:
        sys.exit(2)
    if (params.get("strict") or outcome.must_pass) and outcome.weighty:
        sys.exit(1)


def _format_result(outcome: CommandResult, *, as_json: bool, verbose: bool) -> str:
    if as_json:
        return format_json(outcome.found)
    if click.get_current_context().meta.get(_TAKEN):
        return ""
    from dashpot.cli._terminal import screen
    from dashpot.text_output.layout import format_for_screen

    parts = outcome.text, outcome.verdict, outcome.checks
    return "\n".join(format_for_screen(*parts, verbose=verbose, style=click.style, size=screen()))


def format_json(result: Serialisable) -> str:
    """Return a result as the JSON that commands print and write: it names its schema."""
    import json

    document = result.to_dict()
    if "schema" not in document:
        raise TypeError(f"the document of {type(result).__name__} names no schema")
    return escaped_json(json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False))


def _outputs(context: click.Context, *, may_replace: bool) -> Outputs:
    """Return where a command may write, its own outputs claimed: all else it names is read."""
    from dashpot.workflow.outputs import Outputs

    kinds = {param.name: isinstance(param.type, Output) for param in context.command.params}
    words: dict[bool, list[str]] = {True: [], False: []}
    for name, group in context.params.items():
        several = group if isinstance(group, tuple) else (group,)
        words[kinds.get(name, False)] += [
            text for text in several if isinstance(text, str) and text != "-"
        ]
    inputs = tuple(word for word in words[False] if Path(word).is_file())
    outputs = Outputs(inputs, may_replace, makes_records=context.command.name in _MAKERS)
    outputs.claim(words[True])
    return outputs


def reads(context: click.Context, path: str) -> None:
    """Count a file among the inputs that no argument names."""
    context.obj = replace(context.obj, inputs=(*context.obj.inputs, path))


def claim(paths: Iterable[str | Path]) -> None:
    """Refuse, before the work, files that no option names and that could not be written."""
    outputs: Outputs = click.get_current_context().obj
    outputs.claim(paths)


def write(path: str | Path, content: str | bytes) -> None:
    """Write a file, which the command says at its end; ``-`` is stdout.

    Under ``--json`` stdout belongs to the document.
    """
    context = click.get_current_context()
    if str(path) != "-":
        outputs: Outputs = context.obj
        outputs.write(path, content)
        note_written(path)
        return
    context.meta[_TAKEN] = True
    if not context.params["as_json"]:
        to_stdout(content if isinstance(content, str) else content.decode())


def note_written(path: str | Path) -> None:
    """Remember a file that the command says at its end, and opens if it was asked to."""
    click.get_current_context().meta.setdefault(_WRITTEN, []).append(str(path))


def write_figure(path: str, figure: dp.plot.Picture) -> None:
    """Write a figure as the suffix of its file says."""
    size = click.get_current_context().params.get("size")
    write(path, dp.plot.render_figure(figure, Path(path).suffix, size=size))


def _open(written: Sequence[str]) -> None:
    """Open the last page or picture that was written, or say why not."""
    pages = [path for path in written if Path(path).suffix.lower() in _SEEN]
    if not pages:
        to_stderr("nothing to open: name a page (-o page.html) or a picture (--plot fit.png)")
    elif click.launch(pages[-1]):
        to_stderr(f"{pages[-1]} could not be opened: no program for it was found")


def format_command(*words: object, why: str = "") -> str:
    """Return a dashpot command as it is typed, with a remark that the shell overlooks."""
    line = shlex.join(["dashpot", *(str(word) for word in words)])
    return f"{line}  # {why}" if why else line


def grams(mass: float) -> str:
    """Return a mass, kg, as it is typed."""
    return f"{convert_to_unit(mass, 'g'):g}g"


def read_model(path: str) -> tuple[dp.GeneralizedMaxwell, TemperatureLaw | None]:
    """Return the solid in a JSON file that holds a fit or a model, and how it follows temperature.

    ``-`` is stdin.
    """
    document = workflow.read_json_document(path)
    if isinstance(document, dp.Fit):
        shifts = document.temperatures
        return document.model, None if shifts is None else shifts.law
    if isinstance(document, dp.GeneralizedMaxwell | dp.solids.FractionalZener | dp.solids.Parallel):
        return document.maxwell, None
    raise ReadError(f"{workflow.format_unexpected_kind(path, document)}; expected a fit or a model")


def is_json(path: str) -> bool:
    """Return whether a file begins like a JSON object, so that it may be a fit."""
    from dashpot.reading.raw_file import like_json

    if not Path(path).is_file():  # a look into a pipe would take its first bytes away
        return False
    with Path(path).open("rb") as file:
        return like_json(file.read(64))


# The kind that each record was taken for, which is reported to the user.


def detect_file_kinds(files: Sequence[str], options: ReadOptions) -> dict[str, Recognised]:
    """Return the kind of each file."""
    from dashpot.reading.readers.detect_kind import recognise

    return {path: recognise(path, options.for_file(path)) for path in files}


def kinds_of(detections: Mapping[str, Recognised], options: ReadOptions) -> dict[str, str]:
    """Return the word of each file's kind, as it was read with the options.

    Raises
    ------
    click.UsageError
        If one is no record that is known.
    """
    for path, item in detections.items():
        if item.kind in {"unclear", "not-a-test"}:
            raise click.UsageError(
                f"{path} is no test that dashpot knows: {item.reason}. {_to_name(path, options)}"
            )
    return {path: detection.kind for path, detection in detections.items()}


def _to_name(path: str, options: ReadOptions) -> str:
    """Return how the columns of such a file are named, as it is typed; of too few, what lacks."""
    from dashpot.reading.readers.detect_kind import as_a_ramp

    see = f"To see its columns: dashpot inspect {path}"
    named = as_a_ramp(path, options)
    return (
        f"If it is a test of a seal, name its columns: {named}. {see}"
        if named
        else (f"A test of a seal has time, displacement and force. {see}")
    )


def get_kind_name(kind: str) -> str:
    """Return the name of a file's kind, such as 'a relaxation test'."""
    from dashpot.reading.readers import detect_kind

    return detect_kind.get_kind_label(kind)


def format_override_hint(kinds: Collection[str]) -> str:
    """Return how a file is said to be of this kind after all; nothing of a choice of several."""
    from dashpot.reading.columns.kind_detection import RECOGNISED

    (word, *more) = kinds
    return f" If it is one after all: --kind {word}." if word in RECOGNISED and not more else ""


def print_detected_kinds(detections: Mapping[str, Recognised]) -> None:
    """Print on stderr the kind for which each file was taken."""
    grouped: dict[str, list[str]] = {}
    for path, detection in detections.items():
        grouped.setdefault(detection.kind_title, []).append(Path(path).name)
    listed = "; ".join(f"{', '.join(names)}: {what}" for what, names in grouped.items())
    to_stderr(f"recognised {listed}")


# Input of ``dashpot fit``: the records, their kinds, and the options.


PAGE_SUFFIXES = (".html", ".htm")
