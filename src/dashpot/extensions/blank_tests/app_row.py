"""Machine file in the app: its entry in the list of files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from dashpot.base.errors import ReadError
from dashpot.extensions.blank_tests.machine_file import read_machine_file
from dashpot.reading.toml import read_tables


def describe_machine_file(path: Path) -> dict[str, Any] | None:
    """Return the entry of a machine file in the list; None for another TOML file.

    Raises
    ------
    ReadError
        If it is a machine file that cannot be used.
    """
    try:
        _, tables = read_tables(path)
    except ReadError:
        return None
    if "machine" not in tables:
        return None
    machine = read_machine_file(path)
    source = "" if machine.calibration is None else machine.calibration.source
    line = source.replace(f" {path.name}", "", 1) or "machine file, not from blank tests"
    return {"kind": "machine", "page": "machine", "line": line, "mark": "good", "simulated": False,
            "long": False, "form_fields": [], "takes_one_file": False,
            "name": path.name}  # fmt: skip
