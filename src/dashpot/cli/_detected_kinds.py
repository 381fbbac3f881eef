"""What each record was taken for, and that the user is told so."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from dashpot.cli._echo import to_stderr

if TYPE_CHECKING:
    from dashpot.reading.read_options import ReadOptions
    from dashpot.reading.readers.detect_kind import Recognised


def detect_file_kinds(files: Sequence[str], options: ReadOptions) -> dict[str, Recognised]:
    """Return what each file is."""
    from dashpot.reading.readers.detect_kind import recognise

    return {path: recognise(path, options.of(path)) for path in files}


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
    """Return what a file of a kind is called, such as 'a relaxation test'."""
    from dashpot.reading.readers import detect_kind as recognise

    return recognise.get_kind_label(kind)


def format_override_hint(kinds: Collection[str]) -> str:
    """Return how a file is said to be of this kind after all; nothing of a choice of several."""
    from dashpot.reading.columns.kind_detection import RECOGNISED

    (word, *more) = kinds
    return f" If it is one after all: --as {word}." if word in RECOGNISED and not more else ""


def print_detected_kinds(detections: Mapping[str, Recognised]) -> None:
    """Say on stderr what each file was taken for: a decision that the user did not make."""
    grouped: dict[str, list[str]] = {}
    for path, detection in detections.items():
        grouped.setdefault(detection.what, []).append(Path(path).name)
    listed = "; ".join(f"{', '.join(names)}: {what}" for what, names in grouped.items())
    to_stderr(f"recognised {listed}")
