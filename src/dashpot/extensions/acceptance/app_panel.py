"""Limits in the app: judged beside the verdict, and the entry of a limit file in the list."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from dashpot.base.errors import DataError, ReadError
from dashpot.base.number_format import format_count
from dashpot.extensions.acceptance.accept import read_limits
from dashpot.extensions.acceptance.datamodel import AcceptanceResult
from dashpot.extensions.acceptance.limit_files import is_expression, recognise_limits
from dashpot.extensions.acceptance.page import render_section
from dashpot.reading.toml import read_tables


def judge_for_app(
    result: Any, expressions: Sequence[str], files: Sequence[Path]
) -> tuple[str, tuple[str, ...], AcceptanceResult]:
    """Return limits held against a result: their section as HTML, their options, the document.

    Parameters
    ----------
    result : Study, Fit or another result that reports values
    expressions : sequence of str
        As they were typed.
    files : sequence of Path
        Limit files.

    Raises
    ------
    DataError
        If one is no expression, or of no value of this result.
    """
    for text in expressions:
        # a text without a sign would be taken for the path of a file
        if not is_expression(text):
            raise DataError(
                f"'{text}' is no limit; expected a quantity, <= or >=, and a value with its unit, "
                "such as 'damping >= 3%'"
            )
    try:
        acceptance = read_limits(*files, *expressions).judge(result)
    except ReadError as error:
        message = str(error)
        for path in files:
            message = message.replace(str(path), path.name)
        raise ReadError(message) from None
    options = [("--limits", path.name) for path in files]
    options += [("--limit", text) for text in expressions]
    words = tuple(word for option in options for word in option)
    return render_section(acceptance), words, AcceptanceResult(result, acceptance)


def describe_limit_file(path: Path) -> dict[str, Any] | None:
    """Return the entry of a limit file in the list of files; None for another TOML file."""
    try:
        _, tables = read_tables(path)
    except ReadError:
        return None
    if recognise_limits(tables) is None:
        return None
    return {"kind": "limits", "page": "limits", "line": format_count(len(tables), "limit"),
            "mark": "good", "simulated": False, "long": False, "form_fields": [],
            "takes_one_file": False, "name": path.name}  # fmt: skip
