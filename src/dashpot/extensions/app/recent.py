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
_LIST_FILE = "recent.json"
STATE_VARIABLE = "DASHPOT_STATE"
"""Name of the environment variable with another folder for the list."""


def list_recent_folders() -> list[dict[str, Any]]:
    """Return folders that are still there, the last one first: path, name, and when (UTC)."""
    return [entry for entry in _read_list() if Path(entry["folder"]).is_dir()]


def add_recent_folder(folder: Path) -> None:
    """Put a folder at the head of the list; ignore a list that cannot be written."""
    path = str(folder.resolve())
    timestamp = datetime.now(UTC).isoformat(timespec="seconds")
    other_entries = [entry for entry in _read_list() if entry["folder"] != path]
    entries = [{"folder": path, "name": folder.resolve().name, "when": timestamp}, *other_entries][
        :MAX_FOLDERS
    ]
    with suppress(OSError):
        get_state_path(_LIST_FILE).parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        write_atomic(get_state_path(_LIST_FILE), json.dumps(entries, indent=1).encode())


def _read_list() -> list[dict[str, Any]]:
    try:
        data = json.loads(get_state_path(_LIST_FILE).read_text(encoding="utf-8"))
        return [{name: str(values[name]) for name in ("folder", "name", "when")} for values in data]
    except (OSError, ValueError, TypeError, KeyError):
        return []


def get_state_path(name: str) -> Path:
    """Return the path of a file in the folder in which this system keeps user data of programs."""
    folder = os.environ.get(STATE_VARIABLE)
    if folder:
        return Path(folder) / name
    home_folder = Path.home()
    folders_by_system = {
        "win32": Path(os.environ.get("LOCALAPPDATA", home_folder / "AppData" / "Local")),
        "darwin": home_folder / "Library" / "Application Support",
    }
    default_folder = Path(os.environ.get("XDG_STATE_HOME") or home_folder / ".local" / "state")
    return folders_by_system.get(sys.platform, default_folder) / "dashpot" / name
