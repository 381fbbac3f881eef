"""The command that adds an extra to this installation of dashpot."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from importlib.metadata import PackageNotFoundError, requires
from importlib.util import find_spec
from pathlib import Path

_EXTRA = re.compile(r"extra\s*==\s*[\"']([^\"']+)[\"']")


def format_install_command(extras: str) -> str:
    """Return the command that installs the packages of some extras in this environment.

    pipx and uv install a tool in a separate environment, to which they add packages; an environment
    of uv has no pip.

    Parameters
    ----------
    extras : str
        Names of extras, ``"batch,cluster"``.
    """
    prefix = Path(sys.prefix)
    requirement = f"dashpot[{extras}]"
    if (prefix / "pipx_metadata.json").is_file():
        return _format_shell_line("pipx", "inject", prefix.name, *_list_requirements(extras))
    if (prefix / "uv-receipt.toml").is_file() or find_spec("pip") is None:
        return _format_shell_line(
            "uv", "pip", "install", "-p", sys.executable, *_list_requirements(extras)
        )
    return _format_shell_line(sys.executable, "-m", "pip", "install", requirement)


def _list_requirements(extras: str) -> list[str]:
    """Return the requirements of the extras of the installed dashpot, or the extras if unknown."""
    try:
        requirements = requires("dashpot") or []
    except PackageNotFoundError:
        requirements = []
    names = set(extras.split(","))
    return [
        line.partition(";")[0].strip()
        for line in requirements
        if (match := _EXTRA.search(line)) is not None and match[1] in names
    ] or [f"dashpot[{extras}]"]


def _format_shell_line(*words: str) -> str:
    """Return a command as the shell of this system takes it."""
    return subprocess.list2cmdline(words) if sys.platform == "win32" else shlex.join(words)
