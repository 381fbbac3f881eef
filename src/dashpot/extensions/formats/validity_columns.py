"""Columns that say which rows are valid: no format defines them, so their rows are noted."""

from __future__ import annotations

from dashpot.base import replace
from dashpot.base.provenance import Caution
from dashpot.reading.columns.vocabulary import has_word
from dashpot.reading.table import FileTable

_VALID_WORDS = (
    "valid", "validity", "isvalid", "good", "gültig", "gueltig", "valide", "valido", "válido",
    "有効", "有效",
)  # fmt: skip
"""Words of a column that is 0 where a row does not count."""
_INVALID_WORDS = (
    "invalid", "bad", "overload", "overloaded", "overrange", "overflow", "saturated", "clipped",
    "error", "fault", "ungültig", "ungueltig", "überlast", "ueberlast", "übersteuert", "fehler",
    "invalide", "surcharge", "無効", "无效",
)  # fmt: skip
"""Words of a column that is 1 there."""


def note_invalid_rows(table: FileTable) -> FileTable:
    """Return the table with a caution for each column of 0 and 1 that marks rows as not valid.

    Such a column has no unit.
    """
    notes = []
    for index, column in enumerate(table.columns):
        is_bad = has_word(column.name, _INVALID_WORDS)
        if (
            column.content != "number"
            or column.unit
            or not (is_bad or has_word(column.name, _VALID_WORDS))
        ):
            continue
        values = table.load([index]).values[:, 0]
        if set(values.tolist()) == {0.0, 1.0}:
            count = int((values == is_bad).sum())
            notes.append(
                Caution(
                    f"'{column.name}' marks {count} of {len(values)} rows as not valid, and they "
                    "were read; delete them, or write them as blanks"
                )
            )
    return replace(table, notes=(*table.notes, *notes)) if notes else table
