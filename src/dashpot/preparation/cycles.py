"""Loadings: what lies between one rest and the return to it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.errors import DataError
from dashpot.preparation.segments import Segment

_LEAST_HOLD = 0.2
"""A stop shorter than this part of the ramp before it is a turning point, not a hold."""


class Cycle(NamedTuple):
    """One loading of the seal: a rest, at least one ramp, at least one hold.

    Attributes
    ----------
    rest : Segment or None
        The stand before the first ramp; None if the record starts on the ramp.
    segments : tuple of Segment
        From the first ramp to the last hold.
    """

    rest: Segment | None
    segments: tuple[Segment, ...]

    @property
    def ramp(self) -> Segment:
        """The first ramp."""
        return self.segments[0]

    @property
    def hold(self) -> Segment:
        """The last hold."""
        return self.segments[-1]

    @property
    def moves(self) -> int:
        """How many ramps, up or down, lie between the rest and the last hold."""
        return sum(segment.kind != "hold" for segment in self.segments)

    def words(self) -> str:
        """Every segment, in words."""
        return ", ".join(_in_words(segment) for segment in self.segments)


def cycles_of(segments: tuple[Segment, ...]) -> tuple[Cycle, ...]:
    """Return the loadings that hold, in order; whatever follows the last hold is left out.

    A loading ends where the displacement comes back to within 10 % of where it began: there the
    plate may leave the seal, and no linear solid describes what follows.
    """
    found: list[Cycle] = []
    rest: Segment | None = None
    current: list[Segment] = []
    for segment in segments:
        if not current:
            if segment.kind == "load":
                current = [segment]
            else:
                rest = segment if segment.kind == "hold" else None
            continue
        current.append(segment)
        begin = current[0].origin
        top = max(part.level for part in current)
        if segment.kind == "unload" and segment.level <= begin + 0.1 * (top - begin):
            found += _closed(rest, current)
            current, rest = [], None
    return tuple(found + _closed(rest, current))


def choose_cycle(
    segments: tuple[Segment, ...], number: int | None, *, where: str
) -> tuple[int, tuple[Cycle, ...]]:
    """Return the index of the loading to be used, and all of them; there is at least one.

    Parameters
    ----------
    segments : tuple of Segment
    number : int or None
        Counted from 1; None takes the longest hold.
    where : str
        Name of the record, for the error.

    Raises
    ------
    DataError
        If there is no such loading.
    """
    found = cycles_of(segments)
    if number is None:
        return int(np.argmax([cycle.hold.duration for cycle in found])), found
    if not 1 <= number <= len(found):
        raise DataError(
            f"{where}: cycle {number} was asked for, but the record holds {listed(found)}"
        )
    return number - 1, found


def listed(cycles: tuple[Cycle, ...]) -> str:
    """The choices, in words."""
    parts = [f"cycle {i}: {cycle.words()}" for i, cycle in enumerate(cycles, start=1)]
    count = f"{len(cycles)} loading{'s' * (len(cycles) > 1)}"
    return f"{count} ({'; '.join(parts)})"


def nothing_held(segments: tuple[Segment, ...], where: str, advice: str) -> str:
    """The sentence for a record without a ramp and a hold."""
    if len(segments) == 1 and segments[0].kind == "hold":
        return f"{where}: the displacement never moves by more than its own scatter; {advice}"
    shown = ", ".join(_in_words(segment) for segment in segments[:8])
    more = ", ..." if len(segments) > 8 else ""
    return (
        f"{where}: no hold after a ramp was found: the displacement shows {shown}{more}; {advice}"
    )


def _closed(rest: Segment | None, parts: list[Segment]) -> list[Cycle]:
    """A loading up to its last hold, if it has one."""
    for stop in range(len(parts), 1, -1):
        hold, before = parts[stop - 1], parts[stop - 2]
        enough = hold.last - hold.first >= 3 and hold.duration >= _LEAST_HOLD * before.duration
        if hold.kind == "hold" and enough:
            return [Cycle(rest, tuple(parts[:stop]))]
    return []


def _in_words(segment: Segment) -> str:
    if segment.kind == "hold":
        return f"hold {segment.start:.5g} to {segment.end:.5g} s"
    verb = "ramp" if segment.kind == "load" else "unloading"
    moved = 1e3 * (segment.level - segment.origin)
    return f"{verb} {segment.start:.5g} to {segment.end:.5g} s by {moved:+.4g} mm"
