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
from dashpot.extensions.app.recent import place_of
from dashpot.extensions.app.upload_store import Store, path_in

_WORDS, _FILES = "session.json", "session"


def keep(state: dict[str, Any], store: Store) -> None:
    """Keep what a page looks like, and the files that it has; where it cannot, nothing."""
    names = [str(item.get("id", "")) for item in state.get("files", [])]
    if not names:
        forget()
        return
    with suppress(OSError, DashpotError):
        home = place_of(_FILES)
        home.mkdir(parents=True, exist_ok=True, mode=0o700)
        for name in names:
            _copy(path_in(store.folder, name), home / name)
        when = datetime.now(UTC).isoformat(timespec="seconds")
        origins = {
            name: [str(origin[0]), *origin[1]]
            for name in names
            if (origin := store.get_origin(name))
        }
        words = {"when": when, "state": state, "origins": origins}
        write_atomic(place_of(_WORDS), json.dumps(words).encode())
        for path in home.iterdir():
            if path.name not in names:
                shutil.rmtree(path, ignore_errors=True)


def _copy(file: Path, folder: Path) -> None:
    """Bring a file there, if it is not; without copying it where the disk allows."""
    if (folder / file.name).exists():
        return
    folder.mkdir(exist_ok=True)
    try:
        os.link(file, folder / file.name)
    except OSError:
        shutil.copy2(file, folder / file.name)


def get_saved_session() -> dict[str, Any] | None:
    """Return the names of its files, and when it was kept (UTC); None if none was left."""
    entries = _read()
    if entries is None:
        return None
    names = [str(item.get("name", "")) for item in entries["state"].get("files", [])]
    return {"files": names, "when": str(entries.get("when", ""))}


def resume(store: Store) -> dict[str, Any]:
    """Return the state of the session that was left, with its files where the page has them."""
    entries = _read()
    if entries is None:
        return {}
    state: dict[str, Any] = entries["state"]
    for entry in state.get("files", []):
        (file,) = (place_of(_FILES) / entry["id"]).iterdir()
        path, *stamp = entries.get("origins", {}).get(entry["id"], [""])
        # what changed on disk since is found so by the first look
        identity = store.put(
            file.name, file.read_bytes(), origin=Path(path) if path else None,
            stamp=tuple(stamp), modified=file.stat().st_mtime,
        )  # fmt: skip
        entry["id"] = identity + entry["id"][len(identity) :]
    return state


def forget() -> None:
    """Leave nothing of it."""
    with suppress(OSError):
        place_of(_WORDS).unlink(missing_ok=True)
    shutil.rmtree(place_of(_FILES), ignore_errors=True)


def _read() -> dict[str, Any] | None:
    """Return what was kept, if all of it is there."""
    try:
        data = json.loads(place_of(_WORDS).read_text(encoding="utf-8"))
        files = data["state"]["files"]
        is_complete = all(any((place_of(_FILES) / file["id"]).iterdir()) for file in files)
    except (OSError, ValueError, TypeError, KeyError):
        return None
    return data if files and is_complete else None
