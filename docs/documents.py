"""Writes the page of schemas and former keys from the code: ``python docs/documents.py``."""

from __future__ import annotations

from pathlib import Path

from dashpot.extensions.projects.document_versions import (
    EVERYWHERE,
    FORMER_PROJECT,
    RENAMED_CHECKS,
    RENAMED_KEYS,
    name_present_schema,
)
from dashpot.extensions.projects.revised_numbers import REVISED_NUMBERS

PAGE = Path(__file__).with_suffix(".md")
HEAD = """\
# Documents and their versions

`--json` prints one JSON document, `-o fit.json` and `dp.save` write one. Each says in `"schema"`
what it holds and in which version: `"dashpot/fit@2"`. A version changes where a key changes its
name or its meaning; new keys do not change it. Values are in SI units. This page is written from
the tables of the code by `python docs/documents.py`.

dashpot reads the present version and the former ones below. Keys and names of checks of a former
version are converted before the document is decoded, so that it holds the same value; it is written
anew in the present version. An unknown version is refused, with what to do: of a newer one, update
dashpot.

## Schemas

| former | present |
|---|---|
"""
KEYS = """
## Keys

A key that stands in an object of the document follows the key of that object: `checks.says` is
`"says"` of each of the `"checks"`.

| schema | former key | present key |
|---|---|---|
"""
CHECKS = """
## Names of checks

| former | present |
|---|---|
"""
PROJECTS = """
## Saved projects

`dashpot verify` checks the history and every hash of a project of any version as they are. A result
in documents of a former version is computed again and compared in what both versions hold: the
solid, its residual and what is predicted from it must be the same to 1e-7 of each number
(`former_result_recomputed`). These numbers are computed otherwise since; where they differ a note
says so (`uncertainty_unrevised`):

| key | why it is another number |
|---|---|
"""


def format_page() -> str:
    """Return the page: former and present schemas, keys and names of checks."""
    schemas = sorted({*RENAMED_KEYS, FORMER_PROJECT})
    rows = [_row(f"`{schema}`", f"`{name_present_schema(schema)}`") for schema in schemas]
    keys = [_row("every schema", f"`{old}`", f"`{new}`") for old, new in EVERYWHERE.items()]
    keys += [
        _row(f"`{name_present_schema(schema)}`", f"`{old.lstrip('.')}`", f"`{new}`")
        for schema, renamed in sorted(RENAMED_KEYS.items())
        for old, new in renamed.items()
    ]
    checks = [_row(f"`{old}`", f"`{new}`") for old, new in sorted(RENAMED_CHECKS.items())]
    revised = [_row(f"`{key}`", reason) for key, reason in REVISED_NUMBERS.items()]
    return "".join([HEAD, *rows, KEYS, *keys, CHECKS, *checks, PROJECTS, *revised])


def _row(*cells: str) -> str:
    return f"| {' | '.join(cells)} |\n"


if __name__ == "__main__":
    PAGE.write_text(format_page(), encoding="utf-8")
