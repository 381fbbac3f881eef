"""Run a command as a user types it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from click.testing import CliRunner, Result

from dashpot.cli import main


def ran(*words: object) -> Result:
    """What a command did: ``exit_code``, ``stdout``, ``stderr``, and ``output``, which is both."""
    return CliRunner().invoke(main, [str(word) for word in words])


def did(*words: object, code: int = 0) -> Result:
    """What a command did that must end with that exit code."""
    result = ran(*words)
    assert result.exit_code == code, result.output
    return result


def no_air(door: Path) -> None:
    """Leave the air in the seal and what varies out of a door file: 15 s of its closing."""
    door.write_text(door.read_text().partition("[closing.vents]")[0])


def run_json(*words: object) -> Any:
    """The JSON document of a command, which must have done its work."""
    return json.loads(did(*words, "--json").stdout)
