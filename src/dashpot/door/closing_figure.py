"""The figure of a door that closes: what takes its energy, where, and which doors close."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.numbers import rounded, shown
from dashpot.base.units import in_unit
from dashpot.door.closing_result import ClosingResult
from dashpot.door.slam import Closing, Scatter
from dashpot.plot.picture import (
    FIT,
    REF,
    Area,
    Line,
    Mark,
    Panel,
    Pen,
    Picture,
    Rule,
    Scale,
    Span,
    Tag,
    around,
)
from dashpot.plot.stamps import stamp as stamped
from dashpot.plot.tokens import sequential

_HALF = 0.36
"""Of a bar, its rows being 1 apart."""
_NEAR = 6.0
"""How many times the way on which most of the seal is pressed is drawn."""
_WORDS = 1.6
"""How far the axis of energy goes, to hold the words beside its bars."""


def closing(found: ClosingResult, *, stamp: str = "") -> Picture:
    """Energy term by term, moments and speed over the way, and the least speed of many doors.

    Parameters
    ----------
    found : ClosingResult
    stamp : str
        What the figure says of its origin; by default the files.
    """
    done = found.closing
    strips: list[tuple[Panel, ...]] = [(_waterfall(done),), (_moments(done),), (_speed(done),)]
    if done.scatter is not None and np.isfinite(done.scatter.speed).any():
        strips.append((_doors(done, done.scatter),))
    caption = (
        "A door that closes: what each term takes of its energy, their moments and its speed over "
        "the way, and the least speed that closes doors within their tolerances."
    )
    return Picture("closing", caption, tuple(strips), 2, stamp or stamped(found.sources), 900.0)


def _waterfall(done: Closing) -> Panel:
    rows = [("door", 0.0, done.energy)]
    at = done.energy
    for one in done.terms:
        rows.append((one.name, at - one.work, at))
        at -= one.work
    rows.append(("left", 0.0, done.left) if done.latched else ("stopped", 0.0, max(at, 0.0)))
    marks: list[Mark] = []
    for y, (name, low, high) in zip(range(len(rows), 0, -1), rows, strict=True):
        left, right = sorted((low, high))
        colour = "ref" if name in {"door", "left", "stopped"} else "fit"
        ends = np.array([left, right])
        marks.append(Area(ends, np.full(2, y - _HALF), np.full(2, y + _HALF), colour, tint=0.55))
        marks.append(Tag(right, y, f"{name} {rounded(high - low, digits=3)} J", "ink", "filled"))
    return Panel(
        Scale("energy, J", (min(0.0, at), _WORDS * done.energy)),
        Scale("", (0.0, len(rows) + 0.6), ticks=(0.0,)),
        tuple(marks),
        title="where the energy goes",
        height=250,
        note="closes" if done.latched else "does not close",
    )


def _way(done: Closing) -> tuple[FloatArray, float]:
    """Where the edge is, mm to closed, and how far of it is drawn."""
    way = in_unit(done.door.edge * done.march.angle, "mm")
    door = done.door
    angles = door.compression[door.lever > 0] / door.lever[door.lever > 0]
    most = 0.0
    if len(angles):
        most = _NEAR * in_unit(door.edge * float(np.median(angles)), "mm")
    return way, min(float(way[0]), most) if most > 0 else float(way[0])


def _moments(done: Closing) -> Panel:
    way, most = _way(done)
    middle, turned = 0.5 * (way[1:] + way[:-1]), -np.diff(done.march.angle)
    on = np.isfinite(done.march.kinetic[1:, 0]) & (middle <= most)
    marks: list[Mark] = [Rule(0.0, REF, across=True)]
    highest = []
    pens = [Pen(colour, 1.8) for colour in sequential(5)]
    pens += [Pen(colour, 1.8, (6, 3)) for colour in sequential(5)]
    for pen, (name, work) in zip(pens, done.march.work.items(), strict=False):
        moment = (work[:, 0] / turned)[on]
        highest.append(moment)
        marks.append(Line(middle[on], moment, pen, name))
    return Panel(
        Scale("edge to closed, mm", (float(way[-1]), most)),
        Scale("moment against closing, N m", around(*highest)),
        tuple(marks),
        title="moments",
        height=250,
    )


def _speed(done: Closing) -> Panel:
    way, _ = _way(done)
    speed = done.door.edge * np.sqrt(2 * done.march.kinetic[:, 0] / done.door.inertia)
    known = np.isfinite(speed)
    marks: list[Mark] = [Line(way[known], speed[known], FIT)]
    return Panel(
        Scale("edge to closed, mm", (float(way[-1]), float(way[0]))),
        Scale("speed of the edge, m/s", around(speed[known], np.zeros(1))),
        tuple(marks),
        title="speed",
        height=220,
        note=f"{shown(done.sealing, 'ms')} for the seal",
    )


def _doors(done: Closing, scatter: Scatter) -> Panel:
    speed = np.sort(scatter.speed[np.isfinite(scatter.speed)])
    part = 100 * np.arange(1, len(speed) + 1) / len(scatter.speed)
    marks: list[Mark] = []
    ends = [speed]
    if done.interval is not None and np.isfinite(done.interval).all():
        marks.append(Span(*done.interval, "ref", "nominal, as far as its seal is known"))
        ends.append(np.array(done.interval))
    marks.append(Line(np.repeat(speed, 2)[1:], np.repeat(part, 2)[:-1], FIT, "doors that close"))
    for at, pen, label in (
        (done.minimum, Pen("measured", 1.4), "nominal door"),
        (scatter.variation.limit, Pen("bad", 1.4, (5, 3)), "limit"),
    ):
        if at is not None and np.isfinite(at):
            marks.append(Rule(at, pen, label))
            ends.append(np.array([at]))
    above = scatter.above
    return Panel(
        Scale("least speed, m/s", around(*ends)),
        Scale("doors, %", (0.0, 100.0)),
        tuple(marks),
        title=f"least speed of {len(scatter.speed)} doors",
        height=220,
        note=""
        if above is None
        else f"{rounded(100 * above, digits=3)} % need more than the limit",
    )
