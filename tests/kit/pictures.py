"""Access to the marks of a picture by kind and by name."""

from __future__ import annotations

from typing import TypeVar

from dashpot.plot.picture import Line, Mark, Panel, Tag

T = TypeVar("T", bound=Mark)


def marks(panel: Panel, kind: type[T]) -> list[T]:
    """All of one kind, in the order in which they are drawn."""
    return [mark for mark in panel.marks if isinstance(mark, kind)]


def lines(panel: Panel) -> list[Line]:
    """All curves."""
    return marks(panel, Line)


def first(panel: Panel, label: str):
    """The first mark of that name in the key."""
    return next(mark for mark in panel.marks if not isinstance(mark, Tag) and mark.label == label)
