"""Figure of a closing door: energy by source and place, and which doors close."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.number_format import format_with_error, round_to_error
from dashpot.base.units import convert_to_unit
from dashpot.extensions.systems.door.closing_analysis import ClosingAnalysis, Scatter
from dashpot.extensions.systems.door.closing_result import ClosingResult
from dashpot.plot.picture import FIT, REF, Area, Line, Mark, Panel, Pen, Picture, Rule, Scale, Tag
from dashpot.plot.plotted_data import compute_padded_limits
from dashpot.plot.plotted_data import stamp as format_stamp
from dashpot.plot.style import sequential

_HALF_BAR = 0.36
"""Half the height of a bar; its rows are 1 apart."""
_DRAWN_RATIO = 6.0
"""Length of the drawn motion, over that on which most of the seal is pressed."""
_WORDS, _NAMES = 1.18, 0.55
"""Ends of the energy axis, for the number beside a bar and the name left of it."""
_WHOLE_NUMBER_ENERGY = 2.0
"""Energy above which its axis has whole numbers, J."""


def closing(result: ClosingResult, *, stamp: str = "") -> Picture:
    """Energy term by term, moments and speed over the way, and the least speed of many doors.

    Parameters
    ----------
    result : ClosingResult
    stamp : str
        Origin of the data, printed below the figure; by default the files.
    """
    closing_result = result.closing
    strips: list[tuple[Panel, ...]] = [
        (make_energy_waterfall(closing_result),),
        (make_moments_panel(closing_result),),
        (make_speed_panel(closing_result),),
    ]
    if closing_result.scatter is not None and np.isfinite(closing_result.scatter.least_speed).any():
        strips.append((make_doors_panel(closing_result, closing_result.scatter),))
    caption = (
        "A door that closes: what each term takes of its energy, their moments and its speed over "
        "the way, and the least speed that closes doors within their tolerances."
    )
    return Picture(
        "closing", caption, tuple(strips), 2, stamp or format_stamp(result.sources), 900.0
    )


def make_energy_waterfall(closing: ClosingAnalysis) -> Panel:
    """Return the energy absorbed by each term, the largest first, and the rest."""
    rows = [("door", 0.0, closing.energy)]
    at = closing.energy
    for energy_term in sorted(closing.terms, key=lambda term: -abs(term.work)):
        rows.append((energy_term.name, at - energy_term.work, at))
        at -= energy_term.work
    rows.append(
        ("left", 0.0, closing.remaining_energy)
        if closing.is_latched
        else ("stopped", 0.0, max(at, 0.0))
    )
    begins = -_NAMES * closing.energy
    # one count of decimals down the column
    decimals = max(2 - int(np.floor(np.log10(closing.energy))), 0)
    marks: list[Mark] = []
    for y, (name, low, high) in zip(range(len(rows), 0, -1), rows, strict=True):
        left, right = sorted((low, high))
        is_total = name in {"door", "left", "stopped"}
        colour, label = ("fit", "seal") if name.startswith("seal") else ("ref", "all else")
        bar_ends = np.array([left, right])
        marks.append(
            Area(
                bar_ends,
                np.full(2, y - _HALF_BAR),
                np.full(2, y + _HALF_BAR),
                colour,
                label,
                tint=0.75,
            )
        )
        energy = high if is_total else low - high
        marks.append(Tag(begins, y, name, "ink", end=True))
        marks.append(
            Tag(right, y, f"{energy:z.{decimals}f}".replace("-", "\u2212"), "ink", end=True)
        )
    step = (
        max(round(closing.energy / 3), 1)
        if closing.energy > _WHOLE_NUMBER_ENERGY
        else closing.energy / 2
    )
    ticks = tuple(np.arange(0.0, closing.energy * 1.001, step).tolist())
    return Panel(
        Scale("energy, J", (begins, _WORDS * closing.energy), ticks=ticks),
        Scale("", (0.4, len(rows) + 0.6), unnumbered=True),
        tuple(marks),
        title="where the energy goes",
        height=20.0 * len(rows),
        note="closes" if closing.is_latched else "does not close",
    )


def _get_edge_path(closing: ClosingAnalysis) -> tuple[FloatArray, float]:
    """Return where the edge is, mm to closed, and how far of it is drawn."""
    edge_distance = convert_to_unit(closing.door.edge * closing.march.angle, "mm")
    door = closing.door
    angles = door.compression[door.lever > 0] / door.lever[door.lever > 0]
    axis_limit = 0.0
    if len(angles):
        axis_limit = _DRAWN_RATIO * convert_to_unit(door.edge * float(np.median(angles)), "mm")
    return edge_distance, min(float(edge_distance[0]), axis_limit) if axis_limit > 0 else float(
        edge_distance[0]
    )


def make_moments_panel(closing: ClosingAnalysis) -> Panel:
    """Return the moment of each term over the last of the way."""
    edge_distance, axis_limit = _get_edge_path(closing)
    midpoint, turned_angle = (
        0.5 * (edge_distance[1:] + edge_distance[:-1]),
        -np.diff(closing.march.angle),
    )
    is_shown = np.isfinite(closing.march.kinetic[1:, 0]) & (midpoint <= axis_limit)
    marks: list[Mark] = [Rule(0.0, REF, is_horizontal=True)]
    highest = []
    pens = [Pen(colour, 1.8) for colour in sequential(5)]
    pens += [Pen(colour, 1.8, (6, 3)) for colour in sequential(5)]
    for pen, (name, work) in zip(pens, closing.march.work.items(), strict=False):
        moment = (work[:, 0] / turned_angle)[is_shown]
        highest.append(moment)
        marks.append(Line(midpoint[is_shown], moment, pen, name))
    return Panel(
        Scale("edge to closed, mm", (float(edge_distance[-1]), axis_limit)),
        Scale("moment against closing, N m", compute_padded_limits(*highest)),
        tuple(marks),
        title="moments",
        height=250,
    )


def make_speed_panel(closing: ClosingAnalysis) -> Panel:
    """Return the speed of the edge over its way."""
    edge_distance, _ = _get_edge_path(closing)
    speed = closing.door.edge * np.sqrt(2 * closing.march.kinetic[:, 0] / closing.door.inertia)
    finite = np.isfinite(speed)
    marks: list[Mark] = [Line(edge_distance[finite], speed[finite], FIT)]
    return Panel(
        Scale("edge to closed, mm", (float(edge_distance[-1]), float(edge_distance[0]))),
        Scale("speed of the edge, m/s", compute_padded_limits(speed[finite], np.zeros(1))),
        tuple(marks),
        title="speed",
        height=220,
        note=f"{format_with_error(closing.sealing, 'ms')} for the seal",
    )


def make_doors_panel(closing: ClosingAnalysis, scatter: Scatter, *, height: float = 220.0) -> Panel:
    """Return the least speeds of doors within their tolerances, those beyond the limit apart."""
    speed = scatter.least_speed[np.isfinite(scatter.least_speed)]
    limit, share_above_limit = scatter.variation.limit, scatter.share_above_limit
    bars, top = _make_histogram(speed, limit)
    marks: list[Mark] = [*bars]
    speeds = [speed]
    if closing.interval is not None and np.isfinite(closing.interval).all():
        speeds.append(np.array(closing.interval))
        low_edge, high_edge = np.full(2, 1.06 * top), np.full(2, 1.14 * top)
        words = "nominal, as far as its seal is known"
        marks.append(Area(speeds[-1], low_edge, high_edge, "fit", words, hatched=True))
    for at, pen, name, colour, level in (
        (closing.minimum, Pen("measured", 1.4), "nominal", "ink", 1.36),
        (limit, Pen("bad", 1.4, (5, 3)), "limit", "bad-ink", 1.23),
    ):
        if at is not None and np.isfinite(at):
            # each ends where it is named: the name of one may reach over the other
            marks.append(Line(np.full(2, at), np.array([0.0, level * top]), pen))
            speeds.append(np.array([at]))
            words = f"{name} {round_to_error(at, digits=3)}"
            marks.append(Tag(at, level * top, words, colour, end=True))
    return Panel(
        Scale("least speed of the edge, m/s", compute_padded_limits(*speeds, margin=0.12)),
        Scale("doors", (0.0, 1.45 * top)),
        tuple(marks),
        title=f"least speed of {len(scatter.least_speed)} doors",
        height=height,
        note=""
        if share_above_limit is None
        else f"{round_to_error(100 * share_above_limit, digits=3)} % need more than the limit",
    )


def _make_histogram(speed: FloatArray, limit: float | None) -> tuple[list[Area], float]:
    """Return the histogram of closing speeds, those beyond the limit apart, and its largest bar."""
    bins = np.histogram_bin_edges(speed, bins=max(8, int(1.2 * np.sqrt(len(speed)))))
    if limit is not None and bins[0] < limit < bins[-1]:
        # an edge at the limit: no bar is on both sides of it
        bins = bins + (limit - bins)[int(np.abs(bins - limit).argmin())]
        bins = np.concatenate([[bins[0] - (bins[1] - bins[0])], bins, [2 * bins[-1] - bins[-2]]])
    counts, _ = np.histogram(speed, bins=bins)
    bars: list[Area] = []
    for low, high, count in zip(bins[:-1], bins[1:], counts.tolist(), strict=True):
        if not count:
            continue
        is_outside = limit is not None and (low + high) / 2 > limit
        # the limit is named at its line, and the axis says that they are doors
        colour = "bad" if is_outside else "ref"
        gap = 0.04 * (high - low)
        bar_edges = np.array([low + gap, high - gap])
        bars.append(Area(bar_edges, np.zeros(2), np.full(2, float(count)), colour, tint=0.6))
    return bars, float(counts.max())
