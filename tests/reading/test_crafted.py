"""Crafted files, in one table: read right, with a note, after a question, or refused with a word.

A new file is a row in ``kit/crafted``.
"""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest
from kit.crafted import TABLE
from kit.crafted.row import Row

from dashpot.base.errors import ReadError
from dashpot.reading.readers.inspect import inspect_file

ROWS = 250
"""How many the table holds, at least."""


def notes(record: object) -> str:
    """What was noted of the file that a record is from."""
    source = record.source  # type: ignore[attr-defined]
    sources = source if isinstance(source, tuple) else (source,)
    return " ".join(note for source in sources for note in source.notes)


@pytest.mark.parametrize("row", TABLE, ids=lambda row: row.name)
def test_crafted_file_has_its_stated_outcome(tmp_path: Path, row: Row) -> None:
    path = tmp_path / "case.csv"
    path.write_bytes(row.content)
    if row.outcome in {"right", "noted"}:
        record = row.read(path)
        row.truth.holds(record, row)
        inspection = inspect_file(path)
        assert inspection.kind == row.truth.kind
        assert not inspection.questions
        assert all(word in notes(record) for word in row.message), notes(record)
        return
    with pytest.raises(ReadError) as caught:
        row.read(path)
    message = str(caught.value)
    assert all(word in message for word in row.message), message
    if row.outcome == "asked":
        assert inspect_file(path).questions or row.by_size
        row.truth.holds(row.read(path, **row.answer), row)


def test_there_are_enough() -> None:
    names = Counter(row.name for row in TABLE)
    assert names.most_common(1)[0][1] == 1
    assert len(TABLE) >= ROWS


def test_every_crafted_file_states_its_outcome() -> None:
    for row in TABLE:
        assert bool(row.message) == (row.outcome != "right"), row.name
        assert bool(row.answer) == (row.outcome == "asked"), row.name
