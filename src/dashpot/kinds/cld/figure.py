"""The figure of compression load deflection: every cycle, and the compressions asked for."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.provenance import sources_of
from dashpot.base.units import in_unit
from dashpot.kinds.cld.record import CLD, Branch, Cycle
from dashpot.plot.picture import (
    FIT,
    REF,
    Line,
    Mark,
    Panel,
    Pen,
    Picture,
    Rule,
    Scale,
    Tag,
    around,
)
from dashpot.plot.stamps import stamp as stamped
from dashpot.plot.thinning import extremes

_FIRST = Pen("ref", 1.4, (2, 3)), "first cycle"
_EARLIER = Pen("ref", 1.1), "other cycles"
_BACK = Pen("fit", 1.6, (6, 3))


def cld(found: CLD | Sequence[CLD], *, stamp: str = "") -> Picture:
    """Loading and unloading over compression: the cycle that the figures are of over the others.

    Nominal compression and tolerance are marked. Several pieces are drawn by that cycle alone.

    Parameters
    ----------
    found : CLD or sequence of CLD
    stamp : str
        What the figure says of its origin; by default files, specimen and date.
    """
    pieces = (found,) if isinstance(found, CLD) else tuple(found)
    first, alone = pieces[0], len(pieces) == 1
    lines = _others(first) if alone else []
    for one in pieces:
        lines += _ways(one, one.cycle, (FIT, _BACK), ("loading", "unloading"))
    marks: list[Mark] = [*lines]
    for at in first.marked:
        pressed = in_unit(at.compression, "mm")
        marks.append(Rule(pressed, REF))
        if alone:
            force = first.per * at.loading
            words = f"{force:.3g}"
            marks.append(Tag(pressed, force, words, "fit", "filled", bold=True))
    x, y = (np.concatenate([getattr(one, way) for one in lines]) for way in ("x", "y"))
    across = Scale("compression since first contact, mm", around(x))
    panel = Panel(across, Scale(f"force, {first.unit}", around(y)), tuple(marks), height=320)
    caption = (
        "Compression load deflection: force on the way in and back, with the nominal compression "
        "and its tolerance."
    )
    return Picture(
        "cld", caption, ((panel,),), 1, stamp or stamped(sources_of(pieces), first.specimen)
    )


def _others(one: CLD) -> list[Line]:
    """The cycles that the figures are not of."""
    lines = []
    for cycle in one.cycles:
        if cycle is not one.cycle:
            pen, label = _FIRST if cycle.number == 1 else _EARLIER
            lines += _ways(one, cycle, (pen, pen), (label, label))
    return lines


def _ways(one: CLD, cycle: Cycle, pens: tuple[Pen, Pen], labels: tuple[str, str]) -> list[Line]:
    """Loading and unloading of a cycle, as far as it was recorded."""
    ways = zip((cycle.loading, cycle.unloading), pens, labels, strict=True)
    return [_line(one, way, pen, label) for way, pen, label in ways if way is not None]


def _line(one: CLD, way: Branch, pen: Pen, label: str) -> Line:
    x, y = way.compression, way.force
    if x[0] > x[-1]:
        x, y = x[::-1], y[::-1]
    # bins need a rising x: noise makes a few readings fall
    order = np.argsort(x, kind="stable")
    thin: tuple[FloatArray, FloatArray] = extremes(
        in_unit(x[order], "mm"), one.per * y[order], bins=300
    )
    return Line(*thin, pen, label)
