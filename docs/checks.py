"""Writes the page of every check from the register: ``python docs/checks.py``."""

from __future__ import annotations

from importlib import import_module
from itertools import groupby
from pathlib import Path

import dashpot
from dashpot.base.checks import REGISTER, Criterion
from dashpot.base.errors import Status

PAGE = Path(__file__).with_suffix(".md")
HEAD = """\
# Checks

Every way in which a record, a fit or a comparison can deceive is a named check: a value, a limit,
what was found, what it means, and what to do. This page is written from their register by
`python docs/checks.py`. Some records set a limit of their own, as the last column says; *our
choice* is a limit that no standard sets.

A check has three states: it *passed*, it *failed*, or it was *not judged*, because the record does
not answer its question; what was not judged has not passed (`"passed": true`, `false`, `null` in
JSON). A failure has one of three grades:

| grade | what a failure means |
|---|---|
| `note` | it does not matter to the result; what it costs is in the intervals already |
| `limit` | use the result with care: it is right within what the sentence says |
| `stop` | do not use the result |

The verdict of a fit, a comparison or a study is that of the gravest failure: *do not use* after any
stop, else *use with care* after any limit, else *use*. It leads every report in one line: what the
check that decided found and what to do about it, or the number that the reader came for. `--strict`
leaves with exit code 1 after a failure graded limit or stop; a note is no reason to stop a batch.
Some checks grade a failure by its size, as the column says.

How the optimiser ended is another matter, and stands below the verdict: it is the gravest status
that a failed check sets, whatever its grade, or that the optimum itself shows. The gravest first:

| status | what it says | set by |
|---|---|---|
"""
BESIDE = {
    Status.NO_DATA: "a record that is not finite",
    Status.FEWER_ARMS: "fewer arms than were asked for",
    Status.TAU_AT_BOUND: "a bound that holds the optimum",
    Status.CONVERGED: "nothing of these",
}
"""What sets a status that no check asks for, or not alone."""
WORDS = {
    "<=": "at most", "<": "below", ">=": "at least", ">": "above", "==": "equal to",
    "|x| <=": "within ±", "x/": "within a factor",
}  # fmt: skip


def page() -> str:
    """Return the page: a table of its criteria for each stage, as the code has them."""
    sources = Path(dashpot.__file__).parent
    for file in sorted(sources.rglob("*.py")):
        module = file.relative_to(sources).with_suffix("").parts
        if any(name.endswith("checks") for name in module):
            import_module(".".join(("dashpot", *module)))
    parts = [HEAD, *map(_ended, reversed(Status))]
    for stage, ours in groupby(sorted(REGISTER.values(), key=_file), key=_stage):
        parts.append(
            f"\n## {stage}\n\n| check | what holds | value | passes if | a failure is a | "
            "source of the limit |\n"
        )
        parts.append("|---|---|---|---|---|---|\n")
        parts += [_row(asked) for asked in ours]
    return "".join(parts)


def _file(asked: Criterion[...]) -> tuple[str, str]:
    return asked.stage, asked.judge.__module__


def _stage(asked: Criterion[...]) -> str:
    return asked.stage


def _grade(asked: Criterion[...]) -> str:
    return ", or ".join(filter(None, (asked.grade, asked.otherwise)))


def _ended(status: Status) -> str:
    names = dict.fromkeys(
        f"`{one.name}`" for _, one in sorted(REGISTER.items()) if one.ends is status
    )
    ways = [*names, *([BESIDE[status]] if status in BESIDE else [])]
    return f"| `{status.name.lower()}` | {status.value} | {', '.join(ways)} |\n"


def _row(asked: Criterion[...]) -> str:
    limit = "that of the record" if asked.limit is None else f"{asked.limit:g}"
    passes = f"{WORDS[asked.rule]} {limit}" if asked.rule else ""
    cells = (f"`{asked.name}`", asked.question, asked.measure, passes, _grade(asked), asked.source)
    return "| " + " | ".join(cell.replace("|", r"\|") for cell in cells) + " |\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
