"""The figure of a door: how its seal is pressed, its modes, and FRFs with the seal and without."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.numbers import rounded
from dashpot.base.units import in_unit
from dashpot.door.assembly import AXES, DOOR
from dashpot.door.result import DoorResult
from dashpot.plot.picture import (
    FIT,
    REF,
    Dots,
    Line,
    Mark,
    Panel,
    Pen,
    Picture,
    Rule,
    Scale,
    Tag,
    around,
    around_log,
)
from dashpot.plot.stamps import stamp as stamped
from dashpot.plot.tokens import sequential
from dashpot.vibration.systems.bodies import Point

SHOWN = 4
"""Modes that are drawn."""
_CLASSES = 4
"""Of compression."""
_FINE = 200
"""Places along the line at which a shape is drawn."""
_OBLIQUE = (0.35, 0.35)
"""How a motion across the plane of the door is drawn in it."""
_AXES = "xyz"


def door(found: DoorResult, *, stamp: str = "") -> Picture:
    """The seal line by its compression, the first modes as the line moves, and FRFs.

    Parameters
    ----------
    found : DoorResult
    stamp : str
        What the figure says of its origin; by default the files.
    """
    strips: list[tuple[Panel, ...]] = []
    if found.door.line is not None:
        plane = _plane(found.door.line.points)
        strips.append((_line(found, plane),))
        if found.stations is not None and found.stations.compression is not None:
            strips.append((_pressed(found),))
        strips += [(panel,) for panel in _shapes(found, plane)]
    strips += [(_frf(found, i),) for i in range(min(len(found.frfs), 2))]
    caption = (
        "A door on its seal: where and how far the seal is pressed, how its line moves in the "
        "first modes, and the accelerance with the seal and without."
    )
    return Picture("door", caption, tuple(strips), 2, stamp or stamped(found.sources), 860.0)


def _plane(points: FloatArray) -> tuple[int, int]:
    """The two axes along which the line is longest."""
    first, second = sorted(np.argsort(np.ptp(points, axis=0))[1:].tolist())
    return first, second


def _line(found: DoorResult, plane: tuple[int, int]) -> Panel:
    i, j = plane
    stations, line = found.stations, found.door.line
    marks: list[Mark] = []
    if line is not None and stations is not None:
        marks.append(Line(line.points[:, i], line.points[:, j], Pen("line", 1.2)))
        x, y = stations.place[:, i], stations.place[:, j]
        pressed = stations.compression
        if pressed is None:
            marks.append(Dots(x, y, "fit", "seal", size=4.0))
        else:
            marks += _classes(x, y, in_unit(pressed, "mm"))
    latch = () if found.door.latch is None else (found.door.latch,)
    marks += [
        Tag(one.at[i], one.at[j], one.name, "ink", "filled")
        for one in (*found.door.hinges, *latch, *found.door.bumpers)
    ]
    x, y = (
        np.concatenate([np.atleast_1d(getattr(one, name)) for one in marks]) for name in ("x", "y")
    )
    return Panel(
        Scale(f"{_AXES[i]}, m", around(x, margin=0.15)),
        Scale(f"{_AXES[j]}, m", around(y, margin=0.1)),
        tuple(marks),
        title="seal line",
        height=300,
        square=True,
    )


def _classes(x: FloatArray, y: FloatArray, mm: FloatArray) -> list[Mark]:
    """Stations in a few classes of compression, and those that do not touch."""
    touches = mm >= 0
    marks: list[Mark] = []
    if touches.any():
        low, high = float(mm[touches].min()), float(mm[touches].max())
        count = _CLASSES if high - low > 1e-6 else 1
        edges = np.linspace(low, high, count + 1)
        rank = np.clip(np.searchsorted(edges, mm, side="right") - 1, 0, count - 1)
        for k, colour in enumerate(sequential(count)):
            here = touches & (rank == k)
            label = f"pressed {edges[k]:.3g} to {edges[k + 1]:.3g} mm"
            if here.any():
                marks.append(Dots(x[here], y[here], colour, label, size=5.0))
    if not touches.all():
        away = ~touches
        marks.append(Dots(x[away], y[away], "bad", "does not touch", size=5.0, hollow=True))
    return marks


def _pressed(found: DoorResult) -> Panel:
    stations = found.stations
    along = np.zeros(0) if stations is None else stations.along
    length = 0.0 if found.door.line is None else found.door.line.length
    mm = np.zeros(0)
    if stations is not None and stations.compression is not None:
        mm = in_unit(stations.compression, "mm")
    law = None if found.fit is None else found.fit.elastic_law
    marks: list[Mark] = [Line(along, mm, FIT, "compression"), Rule(0.0, REF, across=True)]
    limits = [mm, np.zeros(1)]
    if law is not None:
        tested = in_unit(law.depth, "mm")
        marks.append(Rule(tested, Pen("ref", 1.2, (7, 4)), "depth tested", across=True))
        limits.append(np.array([tested]))
    return Panel(
        Scale("along the line, m", (0.0, length)),
        Scale("compression, mm", around(*limits)),
        tuple(marks),
        title="compression along the line",
        height=300,
    )


def _shapes(found: DoorResult, plane: tuple[int, int]) -> list[Panel]:
    """The line at rest and in each of the first modes, what leaves its plane drawn oblique."""
    line = found.door.line
    if line is None:
        return []
    i, j = plane
    across = next(k for k in range(3) if k not in plane)
    at = np.linspace(0.0, line.length, _FINE)
    place = np.stack([np.interp(at, line.along, line.points[:, k]) for k in range(3)], axis=1)
    system = found.assembly.system()
    rows = np.array(
        [
            [system.participation(Point(DOOR, (x, y, z), axis)) for axis in AXES]
            for x, y, z in place.tolist()
        ]
    )
    size = 0.18 * float(np.ptp(place[:, [i, j]], axis=0).max())
    panels = []
    for number, one in enumerate(found.modes[:SHOWN], start=1):
        moved = _in_phase(rows @ one.mode.shape)
        moved *= size / float(np.abs(moved).max())
        x = place[:, i] + moved[:, i] + _OBLIQUE[0] * moved[:, across]
        y = place[:, j] + moved[:, j] + _OBLIQUE[1] * moved[:, across]
        share = 100 * one.share("seal")
        damping = 100 * one.mode.damping_ratio
        panels.append(
            Panel(
                Scale(f"{_AXES[i]}, m", around(place[:, i], margin=0.25)),
                Scale(f"{_AXES[j]}, m", around(place[:, j], margin=0.25)),
                (
                    Line(place[:, i], place[:, j], REF, "at rest"),
                    Line(x, y, FIT, "in the mode"),
                ),
                title=f"mode {number}: {rounded(one.mode.frequency)} Hz, {rounded(damping)} %",
                height=230,
                note=f"seal {share:.2f} % of the energy",
                square=True,
            )
        )
    return panels


def _in_phase(moved: ComplexArray) -> FloatArray:
    """The real motion when most of it is at its largest."""
    top = moved.ravel()[int(np.abs(moved).argmax())]
    return np.asarray((moved / top).real)


def _frf(found: DoorResult, index: int) -> Panel:
    name, sealed, bare = found.frfs[index]
    f = sealed.frequency
    curves: Sequence[FloatArray] = (np.abs(sealed.value), np.abs(bare.value))
    return Panel(
        Scale("frequency, Hz", (float(f[0]), float(f[-1]))),
        Scale("accelerance, 1/kg", around_log(*curves), log=True),
        (
            Line(f, curves[1], Pen("ref", 1.6, (7, 4)), "without the seal"),
            Line(f, curves[0], FIT, "with the seal"),
        ),
        title=name if name == found.driven.name else f"{name}, driven at {found.driven.name}",
        height=230,
    )
