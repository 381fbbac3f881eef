"""Watch of open files: what each holds, of when it is, and whether it changed on disk since."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from dashpot.base.errors import ReadError
from dashpot.extensions.app.upload_store import MAX_FILE_BYTES, Store, find_file, get_file_stamp


class FileWatch:
    """State of open files against the files on disk that they were read from.

    A change is detected by size, times of contents and of the directory entry, and number of the
    file; a file that is still being written is not read until two checks agree. A changed file
    becomes a new file of the store, so results of the old contents are not used for the new.

    Parameters
    ----------
    store : Store
    """

    def __init__(self, store: Store) -> None:
        self._store = store
        self._hashes: dict[str, str] = {}
        self._stamps: dict[str, tuple[int, ...]] = {}

    def list_file_states(self, files: Sequence[Any]) -> dict[str, dict[str, Any]]:
        """Return hash, time and state of each file, and the new identity of a changed one.

        The state is empty, ``"writing"``, ``"gone"`` or ``"changed"``.
        """
        return {
            name: self._inspect_file(name)
            for name in dict.fromkeys(item for item in files if isinstance(item, str))
            if self._is_stored(name)
        }

    def _is_stored(self, identity: str) -> bool:
        try:
            find_file(self._store.folder, identity)
        except ReadError:
            return False
        return True

    def _inspect_file(self, identity: str) -> dict[str, Any]:
        stored_path = find_file(self._store.folder, identity)
        read_at = datetime.fromtimestamp(stored_path.stat().st_mtime, UTC).isoformat(
            timespec="seconds"
        )
        row: dict[str, Any] = {
            "sha256": self._get_hash(identity, stored_path),
            "when": read_at,
            "state": "",
        }
        origin = self._store.get_origin(identity)
        if origin is None:
            return row
        path, stamp = origin
        now = get_file_stamp(path)
        if now is None:
            return row | {"state": "gone"}
        if now == stamp:
            return row
        is_settled = self._stamps.get(identity) == now
        self._stamps[identity] = now
        if not is_settled:
            return row | {"state": "writing"}
        if path.stat().st_size > MAX_FILE_BYTES:
            return row | {"state": "gone"}
        name = self._store.put_file(path)
        if identity.startswith(name):  # touched, and the same
            return row
        return row | {"state": "changed", "new": {"id": name, "name": path.name}}

    def _get_hash(self, identity: str, path: Path) -> str:
        if identity not in self._hashes:
            with path.open("rb") as file:
                self._hashes[identity] = hashlib.file_digest(file, "sha256").hexdigest()
        return self._hashes[identity]
