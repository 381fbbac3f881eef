"""Two signals over frequency, each by its amplitude and its phase: their ratio is a response."""

from __future__ import annotations

from typing import NamedTuple

from dashpot.base import units
from dashpot.base.units import Dimension
from dashpot.reading.columns import vocabulary
from dashpot.reading.columns.response_units import ratio
from dashpot.reading.columns.role_assignment import score
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.table import FileTable

_MOTIONS: tuple[Dimension, ...] = ("acceleration", "length", "velocity")
_NAMED = 1.5
_FEWEST, _MOST = 5, 64
"""Columns of a controller's table."""


class AmplitudePhaseColumns(NamedTuple):
    """A signal by the columns of its amplitude and its phase; whether it is a force."""

    size: int
    phase: int
    pushes: bool


def two_signals(
    table: FileTable, options: ReadOptions
) -> tuple[AmplitudePhaseColumns, AmplitudePhaseColumns] | None:
    """Return the two signals of a table that holds two amplitudes with two phases over frequency.

    None of any other, and where a column is a response already.
    """
    phases, sizes, lines = [], [], 0
    if not _FEWEST <= len(table.columns) <= _MOST:
        return None
    for i, column in enumerate(table.columns):
        if column.content != "number":
            continue
        word = column.unit or ""
        if ratio(word) or any(score(column, r, options) >= _NAMED for r in ("real", "storage")):
            return None
        if score(column, "frequency", options) >= _NAMED:
            lines += 1
        elif score(column, "phase", options) >= _NAMED:
            phases.append(i)
        elif units.find_unit(word, "force") or any(
            units.find_unit(word, motion) for motion in _MOTIONS
        ):
            sizes.append(i)
    pushes = [bool(units.find_unit(table.columns[i].unit or "", "force")) for i in sizes]
    if not lines or len(sizes) != 2 or len(phases) != 2 or all(pushes):
        return None
    if _has_reversed_phases(table, sizes, phases):
        phases.reverse()
    first, second = (
        AmplitudePhaseColumns(*item) for item in zip(sizes, phases, pushes, strict=True)
    )
    return first, second


def _has_reversed_phases(table: FileTable, sizes: list[int], phases: list[int]) -> bool:
    """Whether the names say that the first phase is that of the second amplitude."""
    words = {i: set(vocabulary.tokens(table.columns[i].name)) for i in (*sizes, *phases)}
    entries = {i: words[i] - words[j] for i, j in (sizes, sizes[::-1])}
    straight, across = (
        sum(len(entries[i] & words[p]) for i, p in zip(sizes, order, strict=True))
        for order in (phases, phases[::-1])
    )
    return across > straight
