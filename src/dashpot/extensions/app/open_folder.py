"""Opening of folders: a project with its last job, a lot with its table.

A page names a folder, as the user typed it, and never a file: what is read of it is what the
project's own history lists inside it, and of a lot the test whose contents the table knows.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dashpot.base.errors import DataError, ReadError
from dashpot.base.number_format import format_count
from dashpot.extensions.app import recent, wire_format
from dashpot.extensions.app.request_parsing import describe_job, parse_selection, require_text
from dashpot.extensions.app.upload_store import (
    MAX_FILE_BYTES,
    Store,
    get_file_stamp,
    identify_specimen,
)
from dashpot.reading.raw_file import open_raw
from dashpot.registry import require_handler

COLUMNS = (
    "file", "part", "sha256", "lot", "seal", "repeat", "k_end_N_per_m", "k_end_low_N_per_m",
    "k_end_high_N_per_m", "k_inf_N_per_m", "verdict", "outcome", "reason",
)  # fmt: skip
"""Columns of a row on the page."""


def open_folder(request: Mapping[str, Any], path: Path) -> bytes:
    """Return the files and options of a project folder, or the table of a lot."""
    opened_folder = _parse_folder(request)
    if (opened_folder / "dashpot.toml").exists():
        contents = _describe_project(opened_folder, path)
    elif any(opened_folder.glob("part-*.parquet")):
        contents = _describe_lot(opened_folder)
    else:
        raise ReadError(
            f"{opened_folder} is neither a project (it has no dashpot.toml) nor a lot (it has no "
            "part-*.parquet of dashpot batch): give the folder of one"
        )
    recent.add_recent_folder(opened_folder)
    return wire_format.encode_message(
        contents | {"folder": str(opened_folder), "name": opened_folder.resolve().name}
    )


def get_recent_folders(_: Mapping[str, Any], __: Path) -> bytes:
    """Return the folders saved or opened last."""
    return wire_format.encode_message({"recent": recent.list_recent_folders()})


def open_row(request: Mapping[str, Any], folder: Path) -> bytes:
    """One test of a lot, to be opened as a file with the choices that its row was made by."""
    lot_folder, sha256, part = (
        _parse_folder(request),
        request.get("sha256"),
        require_text(request, "part"),
    )
    entries = [
        row
        for row in _list_rows(lot_folder)
        if row["sha256"] == sha256 and (row.get("part") or "") == part
    ]
    if not entries:
        raise DataError(f"{lot_folder} has no test with that hash")
    entry = entries[0]
    # behind the name of the file stands which of its specimens a row is of
    file = entry["file"].rpartition(f" [{part}")[0] if part else entry["file"]
    path, file_stamp, raw = next(
        (
            (path, file_stamp, raw)
            for path in _list_candidate_paths(lot_folder, file)
            if (file_stamp := get_file_stamp(path)) and (raw := _read_verified_bytes(path, sha256))
        ),
        (None, None, None),
    )
    if path is None or raw is None:
        raise ReadError(
            f"{file} is not there any more, or is not what it was: start the app where the batch "
            "was run"
        )
    identity = identify_specimen(_store_file(folder, path, file_stamp, raw), part)
    brought = {"id": identity, "name": path.name, "options": parse_selection(part)}
    if part:
        label = entry["file"].rpartition(f" [{part}")[2].strip(" ]")
        brought["specimen"] = label or part.rpartition("=")[2]
    choices = {"arms": entry["arms"] or "auto", "method": entry["method"] or "full"}
    return wire_format.encode_message(
        {
            "files": [brought],
            "job": choices,
        }
    )


def _parse_folder(request: Mapping[str, Any]) -> Path:
    typed_folder = request.get("folder")
    if not isinstance(typed_folder, str) or not typed_folder.strip():
        raise DataError("no folder is named: type where the project or the lot is kept")
    parsed_folder = Path(typed_folder.strip()).expanduser()
    if not parsed_folder.is_dir():
        raise ReadError(f"{parsed_folder} is no folder")
    return parsed_folder


def _store_file(folder: Path, path: Path, stamp: tuple[int, ...] | None, content: bytes) -> str:
    if len(content) > MAX_FILE_BYTES:
        raise DataError(
            f"{path.name} is larger than {MAX_FILE_BYTES >> 20} MB, more than the page takes"
        )
    modified = path.stat().st_mtime
    return Store(folder).put(path.name, content, origin=path, stamp=stamp, modified=modified)


# -- projects -------------------------------------------------------------------------------------


def _describe_project(project_folder: Path, folder: Path) -> dict[str, Any]:
    """Return the last job of a project, with its files put where the page has them."""
    job, find_file = require_handler("open folder", "project")(project_folder)
    calibration = job.machine.calibration
    if calibration is not None:
        raise ReadError(
            f"{project_folder.name} was fitted with {calibration.source}, and a project does not "
            "keep the machine file. Open its records and the machine file here"
        )

    def brought(path: str) -> dict[str, str]:
        file = find_file(path)
        stamp = get_file_stamp(file)
        content = b"".join(open_raw(file).blocks())
        return {"id": _store_file(folder, file, stamp, content), "name": file.name}

    tests = [brought(path) for path in (job.relaxation, *job.other_tests)]
    hammers = [brought(path) for path in job.impact]
    return {"kind": "project", "tests": tests, "hammers": hammers, **describe_job(job)}


# -- lots -----------------------------------------------------------------------------------------


def _list_rows(lot_folder: Path) -> list[dict[str, Any]]:
    return list(require_handler("read", "lot")(lot_folder).table.iter_rows(named=True))


def _describe_lot(lot_folder: Path) -> dict[str, Any]:
    """Return the table of a lot; non-finite numbers become null."""
    lot = require_handler("read", "lot")(lot_folder)
    rows = [
        [_replace_non_finite(table_row.get(name)) for name in COLUMNS]
        for table_row in lot.table.iter_rows(named=True)
    ]
    outcomes = ", ".join(f"{count} {name}" for name, count in lot.outcomes.items())
    message = f"{format_count(len(rows), 'file')}: {outcomes}"
    return {"kind": "lot", "columns": COLUMNS, "rows": rows, "message": message}


def _replace_non_finite(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _list_candidate_paths(lot: Path, file: str) -> tuple[Path, ...]:
    """Where the file of a row may lie: as the batch named it, or seen from beside the lot."""
    return Path(file), lot.parent / file


def _read_verified_bytes(path: Path, sha256: object) -> bytes | None:
    """Return the bytes of a file if they are those that the table knows by their hash."""
    try:
        raw = open_raw(path)
        return b"".join(raw.blocks()) if raw.sha256 == sha256 else None
    except ReadError:
        return None
