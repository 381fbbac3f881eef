"""Recognition of tables of material tests by their columns."""

from __future__ import annotations

from dashpot.reading.columns import vocabulary
from dashpot.reading.columns.kind_detection import NamedColumns

_DROP_WORDS = {"slam", "slams", "slammed"}


def has_indenter_motion(columns: NamedColumns) -> bool:
    """Return whether an indenter and its motion are named, or only a velocity."""
    if not columns.has_time():
        return False
    names = " ".join((*columns.table.header, *columns.unique_names)).casefold()
    velocity_column = columns.has("velocity", min_score=2.5)
    if "indent" in names and (velocity_column or columns.has_acceleration()):
        return True
    return velocity_column and not (
        columns.has_acceleration() or any(columns.has(name) for name in ("displacement", "force"))
    )


def has_drop(columns: NamedColumns) -> bool:
    """Return whether a slam is named beside a force or the motion of its mass."""
    text = " ".join((*columns.table.header, *columns.unique_names))
    is_drop = not _DROP_WORDS.isdisjoint(vocabulary.tokens(text))
    return is_drop and columns.has_time() and (columns.has("force") or columns.has_acceleration())
