"""What commands read: fits, models, and the names of simulated seals."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from dashpot.base.errors import ReadError

if TYPE_CHECKING:
    from dashpot.records.fit import Fit
    from dashpot.solids.maxwell import GeneralizedMaxwell


def read_text(path: str) -> str:
    """Return the text of a file; ``-`` is stdin."""
    if path == "-":
        return sys.stdin.buffer.read().decode()
    try:
        return Path(path).read_text(encoding="utf-8")
    except UnicodeDecodeError:
        raise ReadError(f"{path} is not a JSON document: it is not UTF-8 text") from None


def read_fit(path: str) -> Fit:
    """Return the fit in a JSON file, as written by ``dashpot fit -o``."""
    from dashpot.records.fit import Fit
    from dashpot.workflow.archive import from_json

    try:
        found = from_json(read_text(path))
    except ReadError as error:
        raise ReadError(
            f"{path}: {error}; expected a fit, as 'dashpot fit FILE -o fit.json' writes it"
        ) from None
    if not isinstance(found, Fit):
        raise ReadError(
            f"{path} holds a {type(found).__name__}; expected a fit, as 'dashpot fit FILE "
            "-o fit.json' writes it"
        )
    return found


def read_model(path: str) -> GeneralizedMaxwell:
    """Return the solid in a JSON file that holds a fit or a model."""
    from dashpot.records.fit import Fit
    from dashpot.solids.maxwell import GeneralizedMaxwell
    from dashpot.workflow.archive import from_json

    try:
        found = from_json(read_text(path))
    except ReadError as error:
        raise ReadError(f"{path}: {error}") from None
    if isinstance(found, Fit):
        return found.model
    if isinstance(found, GeneralizedMaxwell):
        return found
    raise ReadError(f"{path} holds a {type(found).__name__}; expected a fit or a model")


def looks_like_json(path: str) -> bool:
    """Tell whether a file opens like a JSON object, so that it may be a fit."""
    with Path(path).open("rb") as file:
        return file.read(64).lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"{")
