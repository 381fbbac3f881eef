"""A record or a result to a file, by how the file's name ends."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from dashpot.base.atomic import write_atomic
from dashpot.base.choices import Drawn, get_choice_values
from dashpot.base.errors import ExportError
from dashpot.base.serialisation import Serialisable
from dashpot.datamodel.frf import FRF
from dashpot.datamodel.impact import ImpactTest
from dashpot.datamodel.relaxation import RelaxationTest
from dashpot.reading.write import write_frf, write_impact, write_relaxation

_TABLES: dict[type, Callable[..., str]] = {
    FRF: write_frf,
    ImpactTest: write_impact,
    RelaxationTest: write_relaxation,
}
"""What is written as a table that every tool here reads back."""


def save(result: Any, path: str | Path) -> Path:
    """Write a record or a result, and return where it stands.

    ``.json``: its document, which ``dashpot.read`` takes back where it has a schema; ``.png``,
    ``.svg``, ``.pdf``: its picture; ``.html``: its page; ``.csv``: its numbers.

    Raises
    ------
    ExportError
        If it has none of the kind that the name asks for, or the file cannot be written.
    """
    target = Path(path)
    suffix = target.suffix.lower().lstrip(".")
    writers = {"json": _document, "html": _page, "csv": _table}
    if suffix in get_choice_values(Drawn):
        from dashpot.plot.figure_files import save as save_picture

        save_picture(_picture(result), target)
    elif suffix in writers:
        text = writers[suffix](result, target.name)
        try:
            write_atomic(target, text.encode())
        except OSError as error:
            reason = error.strerror or error
            raise ExportError(f"{target}: it cannot be written: {reason}") from None
    else:
        name = ", ".join(f".{writer}" for writer in (*writers, *get_choice_values(Drawn)))
        raise ExportError(f"{target.name}: a result is written as {name}. Name the file so")
    return target


def _picture(result: Any) -> Any:
    if not hasattr(result, "plot"):
        raise ExportError(f"a {type(result).__name__} has no picture. Write it as .json")
    return result.plot()


def _document(document: Any, name: str) -> str:
    if not isinstance(document, Serialisable):
        raise ExportError(f"{name}: a {type(document).__name__} has no document")
    return json.dumps(document.document, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _page(item: Any, name: str) -> str:
    from dashpot.report import has_page, html

    if not has_page(item):
        raise ExportError(
            f"{name}: a {type(item).__name__} has no page of its own. Write it as .json, or make a "
            'report: dp.report(test, hits).save("report.html")'
        )
    return html(item)


def _table(result: Any, name: str) -> str:
    frf = getattr(result, "frf", None)
    result = frf if isinstance(frf, FRF) else result
    for kind, write in _TABLES.items():
        if isinstance(result, kind):
            return str(write(result))
    if callable(getattr(result, "csv", None)):
        return str(result.csv())
    raise ExportError(f"{name}: a {type(result).__name__} has no table. Write it as .json")
