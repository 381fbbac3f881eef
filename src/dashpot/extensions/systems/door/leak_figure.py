"""Figure of leak speeds: each state, along the line, and on the door."""

from __future__ import annotations

import numpy as np

from dashpot.base.units import convert_to_unit
from dashpot.extensions.systems.door.figure import View, mark_classes
from dashpot.extensions.systems.door.leak_result import LeakResult
from dashpot.plot.picture import REF, Area, Line, Mark, Panel, Pen, Picture, Rule, Scale, Tag
from dashpot.plot.plotted_data import compute_padded_limits
from dashpot.plot.plotted_data import stamp as format_stamp

_HALF_BAR, _ABOVE = 0.2, 0.75
"""Half the height of a bar, its rows being 1 apart, and the height of its name above it."""
_COLOURS = ("fit", "joint", "measured", "ref", "bad")
_DASHES: tuple[tuple[float, ...], ...] = ((), (7, 4), (2, 3))


def draw_leak(result: LeakResult, *, stamp: str = "") -> Picture:
    """Return the leak speed in every state, along the line, and on the door as described.

    Parameters
    ----------
    result : LeakResult
    stamp : str
        Origin of the data, printed below the figure; by default the files.
    """
    caption = (
        "Speed of the car at which the pressure lifts the seal: of the first station in every "
        "state with its 95 % limits, along the line, and on the door seen from outside."
    )
    strips = ((draw_states(result),), (draw_line(result),), (draw_door(result),))
    origin = format_stamp(result.sources) if result.sources else ""
    return Picture("leak", caption, strips, 3, stamp or origin, width=960.0)


def draw_states(result: LeakResult) -> Panel:
    """Return the speed at which the first station lifts in each state, with its limits."""
    rows = len(result.states)
    marks: list[Mark] = []
    max_speed = 0.0
    for y, state in zip(range(rows, 0, -1), result.states, strict=True):
        value, low, high = (float(convert_to_unit(item, "km/h")) for item in state.least)
        max_speed = max(max_speed, high)
        limits, heights = np.array([low, high]), np.full(2, y)
        marks += [
            Area(limits, heights - _HALF_BAR, heights + _HALF_BAR, "fit", "95 % limits"),
            Line(
                np.array([value, value]), np.array([y - _HALF_BAR, y + _HALF_BAR]), Pen("ink", 2.4)
            ),
            Tag(0.0, y + _ABOVE, f"{state.name}: {value:.0f}", "ink"),
        ]
    limit = result.setup.limit
    if limit is not None:
        limit_speed = float(convert_to_unit(limit, "km/h"))
        max_speed = max(max_speed, limit_speed)
        marks.append(Rule(limit_speed, REF, f"limit {limit_speed:.0f} km/h"))
    return Panel(
        Scale("speed, km/h", (0.0, 1.08 * max(max_speed, 1.0))),
        Scale("", (0.3, rows + 0.8), unnumbered=True),
        tuple(marks),
        title="the first station lifts at",
        height=264,
    )


def draw_line(result: LeakResult) -> Panel:
    """Return the leak speed of every station along the line in each state."""
    arc_length = result.arc_length
    marks: list[Mark] = []
    speeds = [np.zeros(1)]
    for i, state in enumerate(result.states):
        speed = convert_to_unit(state.speed, "km/h")
        low, high = convert_to_unit(state.limits, "km/h")
        if i == 0:
            marks.append(Area(arc_length, low, high, "fit", "95 % limits, new"))
            speeds.append(high)
        pen = Pen(_COLOURS[i % len(_COLOURS)], 1.8, _DASHES[i // len(_COLOURS) % len(_DASHES)])
        marks.append(Line(arc_length, speed, pen, state.name))
        speeds.append(speed)
    limit = result.setup.limit
    if limit is not None:
        limit_speed = float(convert_to_unit(limit, "km/h"))
        speeds.append(np.array([limit_speed]))
        marks.append(Rule(limit_speed, REF, f"limit {limit_speed:.0f} km/h", is_horizontal=True))
    max_speed = compute_padded_limits(*speeds)[1]
    return Panel(
        Scale("along the line, m", (0.0, float(arc_length[-1]))),
        Scale("leak speed, km/h", (0.0, max_speed)),
        tuple(marks),
        title="leak speed along the line",
        height=264,
    )


def draw_door(result: LeakResult) -> Panel:
    """Return the seal line from outside by the leak speed of its stations."""
    line, first = result.door.line, result.states[0]
    assert line is not None  # noqa: S101  a leak speed is of a line
    view = View.from_line(line)
    outline, station_points = view.project_points(line.points), view.project_points(result.place)
    speed = convert_to_unit(first.speed, "km/h")
    weakest = station_points[first.weakest]
    marks: list[Mark] = [
        Line(outline[:, 0], outline[:, 1], Pen("line", 1.2)),
        *mark_classes(station_points, speed, first.speed > 0, unit="km/h"),
        Tag(float(weakest[0]), float(weakest[1]), "lifts first", "ink", "hollow"),
    ]
    low, high = outline.min(axis=0), outline.max(axis=0)
    return Panel(
        Scale("", compute_padded_limits(np.array([low[0], high[0]]), margin=0.16)),
        Scale("", compute_padded_limits(np.array([low[1], high[1]]), margin=0.1)),
        tuple(marks),
        title="seal line lifted at, from outside",
        height=300,
        square=True,
        drawing=True,
    )
