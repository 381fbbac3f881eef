"""Writes the page of every check from the register: ``python docs/checks.py``."""

from __future__ import annotations

from importlib import import_module
from itertools import groupby
from pathlib import Path

import dashpot
from dashpot.base.checks import REGISTER, Criterion

PAGE = Path(__file__).with_suffix(".md")
HEAD = """\
# Checks

Every way in which a record, a fit or a comparison can deceive is a named check: a value, a limit, a
sentence. This page is written from their register by `python docs/checks.py`. Some records set a
limit of their own, as the last column says; *our choice* is a limit that no standard sets. What
a record does not show is not judged: the check passes, without a value, and says so.
"""
WORDS = {
    "<=": "at most", "<": "below", ">=": "at least", ">": "above", "==": "equal to",
    "|x| <=": "within ±", "x/": "within a factor",
}  # fmt: skip


def page() -> str:
    """Return the page: a table of its criteria for each stage, as the code has them."""
    sources = Path(dashpot.__file__).parent
    for file in sorted(sources.rglob("checks.py")):
        import_module("dashpot." + ".".join(file.relative_to(sources).with_suffix("").parts))
    parts = [HEAD]
    for stage, ours in groupby(sorted(REGISTER.values(), key=_stage), key=_stage):
        parts.append(
            f"\n## {stage}\n\n| check | what holds | value | passes if | source of the limit |\n"
        )
        parts.append("|---|---|---|---|---|\n")
        parts += [_row(asked) for asked in ours]
    return "".join(parts)


def _stage(asked: Criterion[...]) -> str:
    return asked.stage


def _row(asked: Criterion[...]) -> str:
    limit = "that of the record" if asked.limit is None else f"{asked.limit:g}"
    passes = f"{WORDS[asked.rule]} {limit}" if asked.rule else ""
    cells = (f"`{asked.name}`", asked.question, asked.measure, passes, asked.source)
    return "| " + " | ".join(cell.replace("|", r"\|") for cell in cells) + " |\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
