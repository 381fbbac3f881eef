"""Every sentence names verbs and options that exist."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import click
import pytest

import dashpot as dp
from dashpot.cli import COMMANDS, main

PACKAGE_FOLDER = Path(dp.__file__).parent
NOT_TYPED = {
    "reading/sandbox/parent_process.py": "what the parent says to its own child",
}
"""Files whose words no user types, and why."""
OF_CSS = re.compile(
    r"var\(--[a-z-]+|\"--[a-z]+\"\s*:|setProperty\(\"--[a-z]+\"|--[a-z-]+\s*:\s*[#0-9a-z]"
)
OPTION = re.compile(r"(?<![\w(-])--[a-z][a-z-]*")
VERB = re.compile(r"\bdashpot ([a-z]+)\b")


def options() -> set[str]:
    context = click.Context(main)
    verbs = (main.get_command(context, name) for name in COMMANDS)
    expected = {
        word for verb in verbs if verb for parameter in verb.params for word in parameter.opts
    }
    return expected | {"--help", "--help-all", "--version", "--traceback"}


def sentences() -> Iterator[tuple[str, int, str]]:
    for path in sorted(PACKAGE_FOLDER.rglob("*.py")):
        where = path.relative_to(PACKAGE_FOLDER).as_posix()
        if where in NOT_TYPED or where.startswith(("plot/", "solids/")):
            continue
        text = path.read_text(encoding="utf-8")
        if not OPTION.search(text) and not VERB.search(text):
            continue  # to parse every file takes seconds
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                yield where, node.lineno, node.value
    for path in sorted([*PACKAGE_FOLDER.rglob("*.js"), *PACKAGE_FOLDER.rglob("*.html")]):
        where = path.relative_to(PACKAGE_FOLDER).as_posix()
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            if not OF_CSS.search(line):
                yield where, number, line


def strange(text: str, expected: set[str]) -> list[str]:
    """The words of a text that no one can type."""
    return [word for word in OPTION.findall(text) if word not in expected]


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ("give --mass 5g", []), ("give --mas 5g", ["--mas"]), ("dashpot fit takes it", []),
        ("fill: var(--panel)", []),
    ],
)  # fmt: skip
def test_what_is_strange(text: str, wrong: list[str]) -> None:
    assert strange(text, options()) == wrong


def test_every_sentence_names_what_exists() -> None:
    expected = options()
    result = [(where, line, strange(text, expected)) for where, line, text in sentences()]
    assert len(result) > 5000
    assert not [item for item in result if item[2]]
