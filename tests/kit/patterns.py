"""Every regular expression of `dashpot.reading`, and the text that costs a careless one most.

Run as a script it tries each on each under a limit of CPU time that the kernel keeps: a linear
pattern needs a tenth of a second for all texts, the swiftest quadratic one forty. The last line
printed names the pattern that was under way.
"""

from __future__ import annotations

import ast
import importlib
import re
import resource
from collections.abc import Iterator
from pathlib import Path
from time import process_time

import dashpot.reading
from dashpot.base.lazy import compile_on_use
from dashpot.reading.text.dialect import Dialect
from dashpot.reading.text.plain_rows import PlainRows

SIZE = 1 << 18
SECONDS = 4
"""Of CPU for one pattern."""
HEADS = ("", "segment [")
FILLS = (
    "\t", " ", "_", "1", "\r", "\n", "a", "[", "(", '"', "-", ".", ",", ":", "#",
    "a ", "1,", "_a", "(]", "1/",
)  # fmt: skip


def _find_patterns(value: object) -> Iterator[re.Pattern]:
    """The patterns in a value of a module."""
    if isinstance(value, compile_on_use):
        yield re.compile(value.pattern, value.flags)
    elif isinstance(value, dict | tuple):
        for entry in value.values() if isinstance(value, dict) else value:
            yield from _find_patterns(entry)


def _inline(tree: ast.AST) -> Iterator[re.Pattern]:
    """The patterns that stand in a call such as ``re.match("...", text)``."""
    for node in ast.walk(tree):
        called = node.func if isinstance(node, ast.Call) else None
        if not (isinstance(called, ast.Attribute) and isinstance(called.value, ast.Name)):
            continue
        if called.value.id == "re" and called.attr not in {"compile", "escape"}:
            assert isinstance(node, ast.Call)
            yield re.compile(ast.literal_eval(node.args[0]))


def patterns() -> dict[str, re.Pattern]:
    """Every pattern by its own text."""
    root = Path(dashpot.reading.__file__).parent
    result = [*_find_patterns(PlainRows(Dialect(";", ".", ("number",)), (0,)).blank)]
    for path in sorted(root.rglob("*.py")):
        parts = path.relative_to(root).with_suffix("").parts
        module = importlib.import_module(
            ".".join(("dashpot.reading", *parts)).removesuffix(".__init__")
        )
        for value in vars(module).values():
            result += _find_patterns(value)
        result += _inline(ast.parse(path.read_text(encoding="utf-8")))
    return {str(pattern.pattern): pattern for pattern in result}


def try_all(tried: dict[str, re.Pattern]) -> None:
    """Search each text from every place, as the dearest of the ways to use a pattern does."""
    for name, pattern in tried.items():
        print(name, flush=True)
        resource.setrlimit(resource.RLIMIT_CPU, (int(process_time()) + SECONDS, -1))
        for head in HEADS:
            for fill in FILLS:
                text = head + fill * (SIZE // len(fill)) + "\N{PILCROW SIGN}"
                hay = text.encode() if isinstance(pattern.pattern, bytes) else text
                for _ in pattern.finditer(hay):
                    pass


if __name__ == "__main__":
    import sys

    stated = sys.argv[1:]
    try_all({text: re.compile(text) for text in stated} if stated else patterns())
    print("done")
