"""What a JSON file of dashpot's own holds."""

from __future__ import annotations

from pathlib import Path

from dashpot.base.errors import ReadError
from dashpot.datamodel.fit import Fit
from dashpot.reading.raw_file import like_json, open_raw
from dashpot.reading.readers.detect_kind import get_kind_command, get_kind_label
from dashpot.registry import find_handler
from dashpot.workflow.json_archive import from_json

A_FIT = "a fit, as 'dashpot fit FILE -o fit.json' writes it"


def read_json_document(path: str | Path, *, hint: str = "") -> object:
    """Return the noun in a JSON file; ``-`` is stdin.

    Raises
    ------
    ReadError
        If it is none; the sentence ends with the hint.
    """
    raw = open_raw(path)
    if not like_json(raw.head(64)):
        raise ReadError(f"{path}: this is not a JSON document{hint}")
    try:
        return from_json(raw.head(raw.size).decode())
    except UnicodeDecodeError:
        raise ReadError(f"{path} is not a JSON document: it is not UTF-8 text") from None
    except ReadError as error:
        raise ReadError(f"{path}: {error}{hint}") from None


def read_fit(path: str | Path) -> Fit:
    """Return the fit in a JSON file, as written by ``dashpot fit -o``; ``-`` is stdin.

    Raises
    ------
    ReadError
        If it holds something else.
    """
    return _a_fit(path, read_json_document(path, hint=f"; expected {A_FIT}"))


def read_exported(path: str | Path) -> object:
    """Return a solid or a fit of which a row says who exports it; ``-`` is stdin.

    Raises
    ------
    ReadError
        If it holds something else.
    """
    document = read_json_document(path, hint=f"; expected {A_FIT}, or of FRFs at several levels")
    return document if find_handler("export", document) else _a_fit(path, document)


def _a_fit(path: str | Path, result: object) -> Fit:
    if not isinstance(result, Fit):
        raise ReadError(f"{format_unexpected_kind(path, result)}; expected {A_FIT}")
    return result


def format_unexpected_kind(path: str | Path, result: object) -> str:
    """Return what a document holds that is not what was wanted, and who wants it."""
    kind = str(getattr(result, "schema", "")).partition("/")[2].partition("@")[0]
    use = get_kind_command(kind)
    return f"{path} is {get_kind_label(kind)}{f' ({use})' if use else ''}"
