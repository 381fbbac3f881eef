"""The core by itself: its main commands run where extensions are not installed."""

from __future__ import annotations

import ast
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from kit.structure import MAIN_COMMANDS, ROOT, write_example_files

from dashpot.registry import EXTENSIONS

SOURCE = ROOT / "src"
FOLDERS = sorted(path.parent.name for path in SOURCE.glob("dashpot/extensions/*/registration.py"))
LOST_COMMANDS = {
    "paper": ("demo --files",),
    "modes": ("compare frf.csv predicted.csv",),
}
"""Main commands that an extension alone can do."""


def copy_source(folder: Path, *removed: str) -> None:
    """Copy the source of dashpot without the folders of some extensions."""
    shutil.copytree(SOURCE, folder, ignore=shutil.ignore_patterns("__pycache__"))
    for name in removed:
        shutil.rmtree(folder / "dashpot" / "extensions" / name)


def run(folder: Path, source: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run a command in a folder on some source of dashpot."""
    return subprocess.run(
        words, cwd=folder, env={**os.environ, "PYTHONPATH": str(source)},
        capture_output=True, text=True, check=False,
    )  # fmt: skip


def list_failed_commands(folder: Path, *removed: str) -> tuple[list[str], str]:
    """Return the main commands that fail without some extensions, and all messages."""
    source, place = folder / "src", folder / "run"
    copy_source(source, *removed)
    place.mkdir()
    write_example_files(place)
    lines = run(place, source, "bash", str(MAIN_COMMANDS), f"{sys.executable} -m dashpot").stdout
    failed = [line for line in lines.splitlines() if not line.startswith("0 ")]
    return failed, (place / "messages.txt").read_text()


def list_lost_commands(*removed: str) -> list[str]:
    """Return the lines of main commands that the removed extensions alone can do."""
    return [f"2  dashpot {line}" for name in removed for line in LOST_COMMANDS.get(name, ())]


@pytest.mark.once
def test_the_core_runs_its_main_commands_without_any_extension(tmp_path: Path) -> None:
    failed, messages = list_failed_commands(tmp_path, *FOLDERS)
    assert sorted(failed) == sorted(list_lost_commands(*FOLDERS))
    assert "no extension of this installation does the task 'compare files'" in messages
    assert "Traceback" not in messages


@pytest.mark.slow
@pytest.mark.parametrize("name", FOLDERS)
def test_each_extension_can_be_removed(name: str, tmp_path: Path) -> None:
    failed, messages = list_failed_commands(tmp_path, name)
    assert failed == list_lost_commands(name)
    assert "Traceback" not in messages


def test_a_task_without_an_extension_says_what_to_do(tmp_path: Path) -> None:
    source = tmp_path / "src"
    copy_source(source, *FOLDERS)
    write_example_files(tmp_path)
    call = "dp.read('hammer.csv').frf().modes(method='peak')"
    code = f"import dashpot as dp\ntry: {call}\nexcept dp.DashpotError as error: print(error)"
    answer = run(tmp_path, source, sys.executable, "-c", code).stdout
    assert "no extension of this installation does the task 'read resonance'" in answer
    assert "put the folder of the extension back" in answer


def test_every_extension_has_a_folder() -> None:
    assert len(EXTENSIONS) == 1 + len(FOLDERS)  # and the core


def list_unasked_handlers(tree: ast.AST) -> list[int]:
    """Return the lines that call what `find_handler` returns without asking whether it is there."""
    lines = []
    for node in ast.walk(tree):
        is_called_twice = isinstance(node, ast.Call) and isinstance(node.func, ast.Call)
        if is_called_twice and ast.unparse(node.func.func) == "find_handler":
            lines.append(node.lineno)
        if isinstance(node, ast.FunctionDef):
            lines += _list_unasked_names(node)
    return lines


def _list_unasked_names(function: ast.FunctionDef) -> list[int]:
    """Return the lines of names for a handler that are called and in no condition."""
    result: dict[str, int] = {}
    for node in ast.walk(function):
        if isinstance(node, ast.Assign | ast.AnnAssign) and isinstance(node.value, ast.Call):
            target = node.targets[0] if isinstance(node, ast.Assign) else node.target
            if ast.unparse(node.value.func) == "find_handler" and isinstance(target, ast.Name):
                result[target.id] = node.lineno
    called = {
        node.func.id
        for node in ast.walk(function)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
    }
    requested = {
        name.id
        for node in ast.walk(function)
        for condition in (
            [node.test] if isinstance(node, ast.If | ast.IfExp)
            else [node] if isinstance(node, ast.BoolOp | ast.Compare) else []
        )
        for name in ast.walk(condition)
        if isinstance(name, ast.Name)
    }  # fmt: skip
    return [line for name, line in result.items() if name in called - requested]


def test_no_handler_is_called_that_may_be_missing() -> None:
    wrong = [
        f"{path.relative_to(SOURCE)}:{line}"
        for path in sorted(SOURCE.glob("dashpot/**/*.py"))
        for line in list_unasked_handlers(ast.parse(path.read_text(encoding="utf-8")))
    ]
    assert wrong == []  # call `require_handler`, or `call_handler` with a default


@pytest.mark.parametrize(
    "code",
    [
        "find_handler('a', 'b')(1)",
        "def f():\n    handler = find_handler('a', 'b')\n    return handler(1)",
    ],
)
def test_a_handler_that_may_be_missing_is_noticed(code: str) -> None:
    assert list_unasked_handlers(ast.parse(code))
