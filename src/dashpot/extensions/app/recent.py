"""List of recently opened folders, kept in the user's data folder."""

from __future__ import annotations

import json
import os
import sys
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from dashpot.base.file_writing import write_atomic

MAX_FOLDERS = 12
"""Folders of the list."""
_LIST = "recent.json"
STATE_VARIABLE = "DASHPOT_STATE"
"""Name of the variable that says where the list is kept instead."""


def recent() -> list[dict[str, Any]]:
    """Return folders that are still there, the last one first: path, name, and when (UTC)."""
    return [entry for entry in _read_list() if Path(entry["folder"]).is_dir()]


def remember(folder: Path) -> None:
    """Put a folder at the head of the list; where it cannot be written nothing is kept."""
    path = str(folder.resolve())
    now = datetime.now(UTC).isoformat(timespec="seconds")
    retained = [entry for entry in _read_list() if entry["folder"] != path]
    listed = [{"folder": path, "name": folder.resolve().name, "when": now}, *retained][:MAX_FOLDERS]
    with suppress(OSError):
        place_of(_LIST).parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        write_atomic(place_of(_LIST), json.dumps(listed, indent=1).encode())


def _read_list() -> list[dict[str, Any]]:
    try:
        data = json.loads(place_of(_LIST).read_text(encoding="utf-8"))
        return [{name: str(values[name]) for name in ("folder", "name", "when")} for values in data]
    except (OSError, ValueError, TypeError, KeyError):
        return []


def place_of(name: str) -> Path:
    """Return where this system keeps what a program remembers of its user."""
    stated = os.environ.get(STATE_VARIABLE)
    if stated:
        return Path(stated) / name
    home = Path.home()
    by_system = {
        "win32": Path(os.environ.get("LOCALAPPDATA", home / "AppData" / "Local")),
        "darwin": home / "Library" / "Application Support",
    }
    default_folder = Path(os.environ.get("XDG_STATE_HOME") or home / ".local" / "state")
    return by_system.get(sys.platform, default_folder) / "dashpot" / name
