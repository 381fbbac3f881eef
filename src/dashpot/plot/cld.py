"""The figure of compression load deflection: every cycle, and the compressions asked for."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.plot.picture import (
    FIT,
    REF,
    Axis,
    Line,
    Mark,
    Panel,
    Pen,
    Picture,
    Rule,
    Tag,
    around,
)
from dashpot.plot.stamps import stamp as stamped
from dashpot.plot.thinning import extremes
from dashpot.records.cld import CLD, Branch, Cycle

_EARLIER = Pen("ref", 1.1)
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
    marks: list[Mark] = []
    for one in pieces:
        alone = len(pieces) == 1
        for cycle in one.cycles if alone else ():
            if cycle is not one.cycle:
                label = "first cycle" if cycle.number == 1 else "other cycles"
                pen = Pen("ref", 1.4, (2, 3)) if cycle.number == 1 else _EARLIER
                marks += [_line(one, way, pen, label) for way in _ways(cycle)]
    for one in pieces:
        marks.append(_line(one, one.loading, FIT, "loading"))
        if one.unloading is not None:
            marks.append(_line(one, one.unloading, _BACK, "unloading"))
    first = pieces[0]
    for at in first.marked:
        marks.append(Rule(1e3 * at.compression, REF))
        if len(pieces) == 1:
            words = f"{first.per * at.loading:.3g}"
            marks.append(
                Tag(1e3 * at.compression, first.per * at.loading, words, "fit", "filled", bold=True)
            )
    lines = [one for one in marks if isinstance(one, Line)]
    x, y = (np.concatenate([getattr(one, way) for one in lines]) for way in ("x", "y"))
    across = Axis("compression since first contact, mm", around(x))
    panel = Panel(across, Axis(f"force, {first.unit}", around(y)), tuple(marks), height=320)
    caption = (
        "Compression load deflection: force on the way in and back, with the nominal compression "
        "and its tolerance."
    )
    sources = [one.source for one in pieces if one.source is not None]
    return Picture("cld", caption, ((panel,),), 1, stamp or stamped(sources, first.specimen))


def _ways(cycle: Cycle) -> tuple[Branch, ...]:
    return (cycle.loading,) if cycle.unloading is None else (cycle.loading, cycle.unloading)


def _line(one: CLD, way: Branch, pen: Pen, label: str) -> Line:
    x, y = way.compression, way.force
    if x[0] > x[-1]:
        x, y = x[::-1], y[::-1]
    # bins need a rising x: noise makes a few readings fall
    order = np.argsort(x, kind="stable")
    thin: tuple[FloatArray, FloatArray] = extremes(1e3 * x[order], one.per * y[order], bins=300)
    return Line(*thin, pen, label)
