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
from dashpot.extensions.app.request_parsing import page_of, parse_selection, word
from dashpot.extensions.app.upload_store import LIMIT, Store, get_file_stamp, identify_specimen
from dashpot.reading.raw_file import open_raw
from dashpot.registry import require_handler

COLUMNS = (
    "file", "part", "sha256", "lot", "seal", "repeat", "k_end_N_per_m", "k_end_low_N_per_m",
    "k_end_high_N_per_m", "k_inf_N_per_m", "verdict", "outcome", "reason",
)  # fmt: skip
"""What the page shows of a row."""


def folder(request: Mapping[str, Any], path: Path) -> bytes:
    """Return what is in a folder: the files and the choices of a project, or the table of a lot."""
    place = _parse_folder(request)
    if (place / "dashpot.toml").exists():
        head = _project(place, path)
    elif any(place.glob("part-*.parquet")):
        head = _lot(place)
    else:
        raise ReadError(
            f"{place} is neither a project (it has no dashpot.toml) nor a lot (it has no "
            "part-*.parquet of dashpot batch): give the folder of one"
        )
    recent.remember(place)
    return wire_format.encode_message(head | {"folder": str(place), "name": place.resolve().name})


def get_recent_folders(_: Mapping[str, Any], __: Path) -> bytes:
    """Return the folders that were kept or opened last."""
    return wire_format.encode_message({"recent": recent.recent()})


def row(request: Mapping[str, Any], folder: Path) -> bytes:
    """One test of a lot, to be opened as a file with the choices that its row was made by."""
    place, wanted, part = _parse_folder(request), request.get("sha256"), word(request, "part")
    entries = [
        row for row in _rows(place) if row["sha256"] == wanted and (row.get("part") or "") == part
    ]
    if not entries:
        raise DataError(f"{place} has no test with that hash")
    one = entries[0]
    # behind the name of the file stands which of its specimens a row is of
    file = one["file"].rpartition(f" [{part}")[0] if part else one["file"]
    path, stamp, raw = next(
        (
            (path, stamp, raw)
            for path in _places(place, file)
            if (stamp := get_file_stamp(path)) and (raw := _read_verified_bytes(path, wanted))
        ),
        (None, None, None),
    )
    if path is None or raw is None:
        raise ReadError(
            f"{file} is not there any more, or is not what it was: start the app where the "
            "batch was run"
        )
    identity = identify_specimen(_put(folder, path, stamp, raw), part)
    brought = {"id": identity, "name": path.name, "options": parse_selection(part)}
    if part:
        label = one["file"].rpartition(f" [{part}")[2].strip(" ]")
        brought["specimen"] = label or part.rpartition("=")[2]
    choices = {"arms": one["arms"] or "auto", "method": one["method"] or "full"}
    return wire_format.encode_message({"files": [brought], "job": choices})


def _parse_folder(request: Mapping[str, Any]) -> Path:
    stated = request.get("folder")
    if not isinstance(stated, str) or not stated.strip():
        raise DataError("no folder is named: type where the project or the lot is kept")
    place = Path(stated.strip()).expanduser()
    if not place.is_dir():
        raise ReadError(f"{place} is no folder")
    return place


def _put(folder: Path, path: Path, stamp: tuple[int, ...] | None, content: bytes) -> str:
    if len(content) > LIMIT:
        raise DataError(f"{path.name} is larger than {LIMIT >> 20} MB, more than the page takes")
    modified = path.stat().st_mtime
    return Store(folder).put(path.name, content, origin=path, stamp=stamp, modified=modified)


# -- projects -------------------------------------------------------------------------------------


def _project(place: Path, folder: Path) -> dict[str, Any]:
    """Return the last job of a project, with its files put where the page has them."""
    job, find_file = require_handler("open folder", "project")(place)
    calibration = job.machine.calibration
    if calibration is not None:
        raise ReadError(
            f"{place.name} was fitted with {calibration.source}, and a project does not keep the "
            "machine file. Open its records and the machine file here"
        )

    def brought(path: str) -> dict[str, str]:
        file = find_file(path)
        stamp = get_file_stamp(file)
        content = b"".join(open_raw(file).blocks())
        return {"id": _put(folder, file, stamp, content), "name": file.name}

    tests = [brought(path) for path in (job.relaxation, *job.other_tests)]
    hammers = [brought(path) for path in job.impact]
    return {"kind": "project", "tests": tests, "hammers": hammers, **page_of(job)}


# -- lots -----------------------------------------------------------------------------------------


def _rows(place: Path) -> list[dict[str, Any]]:
    return list(require_handler("read", "lot")(place).table.iter_rows(named=True))


def _lot(place: Path) -> dict[str, Any]:
    """Return the table of a lot; what is no number is null."""
    lot = require_handler("read", "lot")(place)
    rows = [
        [_finite(iter_row.get(name)) for name in COLUMNS]
        for iter_row in lot.table.iter_rows(named=True)
    ]
    outcomes = ", ".join(f"{count} {name}" for name, count in lot.outcomes.items())
    message = f"{format_count(len(rows), 'file')}: {outcomes}"
    return {"kind": "lot", "columns": COLUMNS, "rows": rows, "message": message}


def _finite(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _places(lot: Path, file: str) -> tuple[Path, ...]:
    """Where the file of a row may lie: as the batch named it, or seen from beside the lot."""
    return Path(file), lot.parent / file


def _read_verified_bytes(path: Path, wanted: object) -> bytes | None:
    """Return the bytes of a file if they are those that the table knows by their hash."""
    try:
        raw = open_raw(path)
        return b"".join(raw.blocks()) if raw.sha256 == wanted else None
    except ReadError:
        return None
