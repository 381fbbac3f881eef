"""Registration files that cannot be read: one sentence with the file and the line."""

from __future__ import annotations

import subprocess
import sys
from itertools import count
from pathlib import Path

import pytest

import dashpot.extensions
from dashpot.base.errors import DashpotError
from dashpot.registry import _read_rows

NUMBERS = count()
"""A module that was tried once is not tried under its name again."""

BROKEN = [
    ("import os\n\nEXTENSION = Extension(\n", ":3: ", "SyntaxError: '(' was never closed"),
    ('import os\n\nraise ValueError("no depth")\n', ":3: ", "ValueError: no depth"),
    ("\nimport no_such_package\n", ":2: ", "No module named 'no_such_package'"),
    ('from json import loads\n\nROWS = loads("{")\n', ":3: ", "JSONDecodeError"),
    (
        "from dashpot.registry.row import Extension\n\nEXTENSION = Extension()\n",
        ":3: ",
        "missing 1 required positional argument: 'name'",
    ),
    ("ROWS = ()\n", ": ", "EXTENSION is None; expected EXTENSION = Extension(...)"),
    ("EXTENSION = 5\n", ": ", "EXTENSION is 5; expected EXTENSION = Extension(...)"),
]


def write_extension(folder: Path, text: str) -> Path:
    package = folder / f"broken{next(NUMBERS)}"
    package.mkdir()
    (package / "__init__.py").touch()
    path = package / "registration.py"
    path.write_text(text)
    return path


@pytest.mark.parametrize(("text", "line", "found"), BROKEN)
def test_registry_names_file_and_line_of_a_broken_registration(
    text: str, line: str, found: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write_extension(tmp_path, text)
    monkeypatch.setattr(dashpot.extensions, "__path__", [str(tmp_path)])
    with pytest.raises(DashpotError) as answer:
        list(_read_rows())
    message = str(answer.value)
    assert message.startswith(f"{path}{line}the rows of this extension cannot be read: ")
    assert found in message
    assert "Correct the file" in message


@pytest.mark.parametrize("traceback", [False, True])
def test_command_line_reports_a_broken_registration_in_one_line(
    traceback: bool, tmp_path: Path
) -> None:
    path = write_extension(tmp_path, BROKEN[1][0])
    code = (
        "import dashpot.extensions; "
        f"dashpot.extensions.__path__.append({str(tmp_path)!r}); "
        "from dashpot.cli import main; main()"
    )
    words = ["--traceback"] if traceback else []
    done = subprocess.run(
        [sys.executable, "-c", code, *words, "--help"],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert not done.stdout
    if traceback:
        assert done.returncode == 1
        assert "Traceback" in done.stderr
    else:
        assert done.returncode == 3
        assert done.stderr.count("\n") == 1
        assert done.stderr.startswith(f"dashpot: {path}:3: ")
