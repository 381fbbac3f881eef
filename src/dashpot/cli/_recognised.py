"""What each record was taken for, and that the user is told so."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from dashpot.cli._echo import to_stderr

if TYPE_CHECKING:
    from dashpot.io.options import ReadOptions
    from dashpot.io.readers.recognise import Recognised


def recognised(files: Sequence[str], options: ReadOptions) -> dict[str, Recognised]:
    """Return what each file is."""
    from dashpot.io.readers.recognise import recognise

    return {path: recognise(path, options.of(path)) for path in files}


def kinds_of(found: Mapping[str, Recognised]) -> dict[str, str]:
    """Return the word of each file's kind.

    Raises
    ------
    click.UsageError
        If one is no record that is known.
    """
    for path, one in found.items():
        if one.kind in {"unclear", "not-a-test"}:
            raise click.UsageError(
                f"{path} is no test that dashpot knows: {one.reason}. Name its columns, such as "
                "--column time=1,displacement=2,force=3 --units time=s,displacement=mm,force=N; to "
                f"see them: dashpot inspect {path}"
            )
    return {path: one.kind for path, one in found.items()}


def called(kind: str) -> str:
    """Return what a file of a kind is called, such as 'a relaxation test'."""
    from dashpot.io.readers import recognise

    return recognise.called(kind)


def overruled(kinds: Collection[str]) -> str:
    """Return how a file is said to be of this kind after all; nothing of a choice of several."""
    from dashpot.io.columns.kinds import RECOGNISED

    (word, *more) = kinds
    return f" If it is one after all: --as {word}." if word in RECOGNISED and not more else ""


def tell(found: Mapping[str, Recognised]) -> None:
    """Say on stderr what each file was taken for: a decision that the user did not make."""
    grouped: dict[str, list[str]] = {}
    for path, one in found.items():
        grouped.setdefault(one.what, []).append(Path(path).name)
    listed = "; ".join(f"{', '.join(names)}: {what}" for what, names in grouped.items())
    to_stderr(f"recognised {listed}")
