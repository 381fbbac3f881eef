"""The core stays small, knows no extension, and holds what the main commands run.

The limits are today's figures, rounded up; they may only fall. ``python tests/kit/structure.py``
prints the figures.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from kit.structure import (
    EXTENSION_IMPORTS,
    FILES_NOT_ENTERED,
    FIT_COMMAND,
    REPORT_COMMAND,
    count_package_tokens,
    count_tokens,
    list_extension_imports,
    list_files_not_entered,
    measure_main_commands,
    read_linter_exceptions,
    read_rows,
    read_tree_sizes,
    select_core,
    trace_files,
    write_example_files,
)

MOST_TOKENS = 430_000  # of the core
MOST_FILES = 275  # of the core
MOST_FILES_OF_FIT = 120  # that `dashpot fit FILE` runs
MOST_FILES_OF_REPORT = 200  # that `dashpot report TEST HAMMER` runs
MOST_FILES_NOT_ENTERED = 18  # by the main commands
MOST_EXTENSION_IMPORTS = 0  # by the core


def test_the_core_is_small():
    core = select_core()
    assert len(core) <= MOST_FILES
    assert count_tokens(core) <= MOST_TOKENS


@pytest.mark.parametrize(
    ("command", "limit"),
    [(FIT_COMMAND, MOST_FILES_OF_FIT), (REPORT_COMMAND, MOST_FILES_OF_REPORT)],
    ids=["fit", "report"],
)
def test_a_command_runs_few_files(command: tuple[str, ...], limit: int, tmp_path: Path) -> None:
    write_example_files(tmp_path)
    files = trace_files(*command, folder=tmp_path)
    assert "cli/__init__.py" in files
    assert len(files) <= limit


def test_the_core_imports_no_extension():
    """Ask the registry instead: see ``src/dashpot/registry``."""
    imports = list_extension_imports()
    allowed = read_linter_exceptions() | read_rows(EXTENSION_IMPORTS).keys()
    assert sorted(imports - allowed) == []
    assert len(imports) <= MOST_EXTENSION_IMPORTS


def test_every_allowed_import_exists():
    """Shorten the list by ``python tests/kit/structure.py --write-lists``."""
    assert sorted(read_rows(EXTENSION_IMPORTS).keys() - list_extension_imports()) == []


@pytest.mark.once
def test_the_main_commands_enter_every_file_of_the_core(tmp_path: Path) -> None:
    """A file that they do not enter needs a reason in the list, or belongs in an extension."""
    not_entered = list_files_not_entered(measure_main_commands(tmp_path))
    assert sorted(not_entered - read_rows(FILES_NOT_ENTERED).keys()) == []
    entered = {file.path for file in select_core()} - not_entered
    assert sorted(entered & read_rows(FILES_NOT_ENTERED).keys()) == []  # needs its reason no more


def test_every_file_that_is_not_entered_has_a_reason():
    rows, core = read_rows(FILES_NOT_ENTERED), {file.path for file in select_core()}
    assert sorted(rows.keys() - core) == []
    assert [path for path, reason in rows.items() if len(reason.split()) < 2] == []
    assert len(rows) <= MOST_FILES_NOT_ENTERED


def test_no_file_holds_the_marks_of_a_merge() -> None:
    """Neither tools for Python nor a browser complain of them in a page."""
    root, folders = Path(__file__).parents[1], ("src", "docs", "tests", "examples", "benchmarks")
    suffixes = {".py", ".pyi", ".html", ".js", ".css", ".md", ".toml", ".sh", ".txt", ".ipynb"}
    marks = tuple(7 * letter + " " for letter in "<>|")
    marked = [
        path.relative_to(root).as_posix()
        for folder in folders
        for path in sorted((root / folder).rglob("*"))
        if path.suffix in suffixes and path.is_file()
        if any(line.startswith(marks) for line in path.read_text("utf-8", "replace").split("\n"))
    ]
    assert marked == []


def test_tree_page_states_the_sizes_of_its_packages():
    counts, stated = count_package_tokens(), read_tree_sizes()
    wrong = {
        package: (size, counts[package])
        for package, size in stated.items()
        if abs(counts[package] / 1000 - size) > max(1.0, 0.15 * size)
    }
    assert not wrong, "just structure --write-lists"
    assert {name for name in counts if "/" in name} <= stated.keys() | {"extensions/__init__"}
