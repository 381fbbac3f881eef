"""The last session, saved for the next start: its options and its files.

There is one, the last; it is deleted when its files are removed from the page, or on request.
"""

from __future__ import annotations

import json
import os
import shutil
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from dashpot.base.errors import DashpotError
from dashpot.base.file_writing import write_atomic
from dashpot.extensions.app.recent import get_state_path
from dashpot.extensions.app.upload_store import Store, find_file

_SESSION_FILE, _FILES_FOLDER = "session.json", "session"


def save_session(state: dict[str, Any], store: Store) -> None:
    """Save the state of a page and its files; ignore a folder that cannot be written."""
    names = [str(item.get("id", "")) for item in state.get("files", [])]
    if not names:
        delete_session()
        return
    with suppress(OSError, DashpotError):
        files_folder = get_state_path(_FILES_FOLDER)
        files_folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        for name in names:
            _link_or_copy(find_file(store.folder, name), files_folder / name)
        time = datetime.now(UTC).isoformat(timespec="seconds")
        origins = {
            name: [str(origin[0]), *origin[1]]
            for name in names
            if (origin := store.get_origin(name))
        }
        contents = {"when": time, "state": state, "origins": origins}
        write_atomic(get_state_path(_SESSION_FILE), json.dumps(contents).encode())
        for path in files_folder.iterdir():
            if path.name not in names:
                shutil.rmtree(path, ignore_errors=True)


def _link_or_copy(file: Path, folder: Path) -> None:
    """Bring a file there, if it is not; without copying it where the disk allows."""
    if (folder / file.name).exists():
        return
    folder.mkdir(exist_ok=True)
    try:
        os.link(file, folder / file.name)
    except OSError:
        shutil.copy2(file, folder / file.name)


def get_saved_session() -> dict[str, Any] | None:
    """Return the names of its files, and when it was saved (UTC); None without one."""
    entries = _read_session()
    if entries is None:
        return None
    names = [str(item.get("name", "")) for item in entries["state"].get("files", [])]
    return {"files": names, "when": str(entries.get("when", ""))}


def restore_session(store: Store) -> dict[str, Any]:
    """Return the saved state of the session, with its files."""
    entries = _read_session()
    if entries is None:
        return {}
    state: dict[str, Any] = entries["state"]
    for entry in state.get("files", []):
        (file,) = (get_state_path(_FILES_FOLDER) / entry["id"]).iterdir()
        path, *stamp = entries.get("origins", {}).get(entry["id"], [""])
        # what changed on disk since is found so by the first look
        identity = store.put(
            file.name, file.read_bytes(), origin=Path(path) if path else None,
            stamp=tuple(stamp), modified=file.stat().st_mtime,
        )  # fmt: skip
        entry["id"] = identity + entry["id"][len(identity) :]
    return state


def delete_session() -> None:
    """Delete all its files."""
    with suppress(OSError):
        get_state_path(_SESSION_FILE).unlink(missing_ok=True)
    shutil.rmtree(get_state_path(_FILES_FOLDER), ignore_errors=True)


def _read_session() -> dict[str, Any] | None:
    """Return the stored session if it is complete."""
    try:
        data = json.loads(get_state_path(_SESSION_FILE).read_text(encoding="utf-8"))
        files = data["state"]["files"]
        is_complete = all(
            any((get_state_path(_FILES_FOLDER) / file["id"]).iterdir()) for file in files
        )
    except (OSError, ValueError, TypeError, KeyError):
        return None
    return data if files and is_complete else None
