"""Files of a command: read, and their kinds."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import dashpot as dp
from dashpot import workflow
from dashpot.base.errors import ReadError
from dashpot.base.units import convert_to_unit
from dashpot.cli._terminal import to_stderr

if TYPE_CHECKING:
    from dashpot.reading.columns.file_kinds import RecognisedKind
    from dashpot.reading.read_options import ReadOptions
    from dashpot.solids.shift_laws import TemperatureLaw


PAGE_RENDERER = "dashpot.page"
"""Key of the function that writes the page of a result."""


def render_page(result: Any, **figures: Any) -> str:
    """Return the page of a result, with the additions of options."""
    write: Callable[..., str] = click.get_current_context().meta.get(PAGE_RENDERER, workflow.html)
    return write(result, **figures)


def format_command(*words: object, remark: str = "") -> str:
    """Return a dashpot command as it is typed, with a remark that the shell overlooks."""
    line = shlex.join(["dashpot", *(str(word) for word in words)])
    return f"{line}  # {remark}" if remark else line


def format_grams(mass: float) -> str:
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
    from dashpot.reading.raw_file import looks_like_json

    if not Path(path).is_file():  # a look into a pipe would take its first bytes away
        return False
    with Path(path).open("rb") as file:
        return looks_like_json(file.read(64))


# Recognised kind of each record, as reported to the user.


def detect_file_kinds(files: Sequence[str], options: ReadOptions) -> dict[str, RecognisedKind]:
    """Return the kind of each file."""
    return {path: _detect_file_kind(path, options) for path in files}


def _detect_file_kind(path: str, options: ReadOptions) -> RecognisedKind:
    if is_json(path):
        from dashpot.reading.columns.file_kinds import identify_json
        from dashpot.reading.raw_file import open_raw

        if document := identify_json(open_raw(path)):
            return document
    from dashpot.reading.readers.detect_kind import recognise  # which no document needs

    return recognise(path, options.for_file(path))


def get_file_kinds(
    detections: Mapping[str, RecognisedKind], options: ReadOptions
) -> dict[str, str]:
    """Return the word of each file's kind, as it was read with the options.

    Raises
    ------
    click.UsageError
        If one is no record that is known.
    """
    for path, item in detections.items():
        if item.kind in {"unclear", "not-a-test"}:
            from dashpot.reading.readers.detect_kind import describe_unknown_test

            problem = describe_unknown_test(path, item.reason, options)
            raise click.UsageError(f"{problem} To see its columns: dashpot inspect {path}")
    return {path: detection.kind for path, detection in detections.items()}


def format_override_hint(kinds: Collection[str]) -> str:
    """Return how to state that a file is of this kind; empty for a choice of several."""
    from dashpot.reading.columns.file_kinds import KINDS_OF_FILE

    (kind, *other_kinds) = kinds
    is_kind = kind in KINDS_OF_FILE and not other_kinds
    return f" If the file is {KINDS_OF_FILE[kind].label}, add --kind {kind}." if is_kind else ""


def print_detected_kinds(detections: Mapping[str, RecognisedKind]) -> None:
    """Print on stderr the kind for which each file was taken."""
    files_by_kind: dict[str, list[str]] = {}
    for path, detection in detections.items():
        files_by_kind.setdefault(detection.kind_title, []).append(Path(path).name)
    kind_texts = "; ".join(
        f"{', '.join(names)}: {kind_title}" for kind_title, names in files_by_kind.items()
    )
    to_stderr(f"recognised {kind_texts}")


# Input of ``dashpot fit``: the records, their kinds, and the options.


PAGE_SUFFIXES = (".html", ".htm")
