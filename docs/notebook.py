"""Run the notebook of the main job, and keep what each cell shows: ``python docs/notebook.py``.

In one process, as a kernel does it; Jupyter itself is 40 packages, for one file. The tests hold
what is kept to what a cell shows.
"""

from __future__ import annotations

import ast
import io
import json
from collections.abc import Iterator
from contextlib import chdir, redirect_stdout
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from dashpot import workflow

BOOK = Path(__file__).resolve().parents[1] / "examples" / "main_job.ipynb"


def execute_cell(code: str, names: dict[str, Any]) -> tuple[str, Any]:
    """Return what a cell prints, and the value of its last line if that is an expression."""
    lines = ast.parse(code).body
    last = lines.pop() if isinstance(lines[-1], ast.Expr) else ast.Expr(ast.Constant(None))
    with redirect_stdout(io.StringIO()) as out:
        exec(compile(ast.Module(lines, []), "cell", "exec"), names)  # noqa: S102
        value = eval(compile(ast.Expression(last.value), "cell", "eval"), names)  # noqa: S307
    return out.getvalue(), value


def cells(book: dict[str, Any], names: dict[str, Any]) -> Iterator[tuple[dict[str, Any], str, Any]]:
    """Run each cell of code; yield it, what it printed, and its value."""
    for cell in book["cells"]:
        if cell["cell_type"] == "code":
            yield (cell, *execute_cell("".join(cell["source"]), names))


def build_outputs(printed: str, value: Any, number: int) -> Iterator[dict[str, Any]]:
    """What a notebook keeps of a cell."""
    if printed:
        yield {"name": "stdout", "output_type": "stream", "text": printed.splitlines(keepends=True)}
    if value is not None:
        shown = {"text/html": value._repr_html_(), "text/plain": repr(value)}
        data = {kind: text.splitlines(keepends=True) for kind, text in shown.items()}
        yield {"data": data, "execution_count": number, "metadata": {},
               "output_type": "execute_result"}  # fmt: skip


def main() -> None:
    """Run the notebook on the example files, and write it."""
    book = json.loads(BOOK.read_text("utf-8"))
    with TemporaryDirectory() as place, chdir(place):
        for name in ("seal_8mm.csv", "hammer.csv"):
            Path(name).write_text(workflow.EXAMPLES[name](), encoding="utf-8")
        for number, (cell, printed, value) in enumerate(cells(book, {}), start=1):
            cell["execution_count"] = number
            cell["outputs"] = list(build_outputs(printed, value, number))
    text = json.dumps(book, indent=1, ensure_ascii=False, sort_keys=True) + "\n"
    BOOK.write_text(text, encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
