"""Limits held against a result as a section of its page."""

from __future__ import annotations

import math
from typing import NamedTuple

from dashpot import workflow
from dashpot.extensions.acceptance.datamodel import Acceptance, LimitAssessment
from dashpot.report.page_frame import environment

WIDTH = 200.0
"""Width of the bar of an interval, px."""
_MARKS = {"met": "good", "missed": "bad", "open": "care"}
_COLOURS = {"meets": "good", "misses": "bad", "open": "care"}


class IntervalBar(NamedTuple):
    """Interval and limits along one axis, px.

    Attributes
    ----------
    start, width : float
        Start and width of the interval.
    value_position : float
        Place of the value; nan if there is none.
    limits : tuple of float
    """

    start: float
    width: float
    value_position: float
    limits: tuple[float, ...]


class LimitRow(NamedTuple):
    """Row of the table: limit, value with its interval, and the bar."""

    limit: LimitAssessment
    value: str
    low: str
    high: str
    unit: str
    mark: str
    bar: IntervalBar


def render_section(acceptance: Acceptance) -> str:
    """Return the section as HTML: the seal's word, and a row for each limit with its bar."""
    rows = [_make_row(limit) for limit in acceptance.limits]
    template = environment("dashpot.extensions.acceptance").get_template("acceptance.html")
    colour = _COLOURS[acceptance.word]
    return str(template.render(acceptance=acceptance, rows=rows, colour=colour, width=WIDTH))


def write_page(acceptance: Acceptance) -> str:
    """Return the page of the result that was judged, with the section of its limits."""
    return workflow.html(acceptance.result, limits=render_section(acceptance))


def _make_row(limit: LimitAssessment) -> LimitRow:
    value, low, high = limit.cell_texts
    unit = limit.value.word
    return LimitRow(limit, value, low, high, unit, _MARKS[limit.outcome], _draw_bar(limit))


def _draw_bar(limit: LimitAssessment) -> IntervalBar:
    """Return the bar: an axis that holds value, interval and limits, open ends at its edges."""
    reported_value = limit.value
    limits = [end for end in (limit.lower, limit.upper) if end is not None]
    finite = [
        end
        for end in (reported_value.value, reported_value.low, reported_value.high, *limits)
        if math.isfinite(end)
    ]
    axis_low, axis_high = min(finite), max(finite)
    margin = 0.15 * ((axis_high - axis_low) or abs(axis_high) or 1.0)
    axis_low, axis_high = axis_low - margin, axis_high + margin

    def place(value: float, default: float) -> float:
        if not math.isfinite(value):
            return default
        return round(WIDTH * (value - axis_low) / (axis_high - axis_low), 1)

    start, stop = place(reported_value.low, 0.0), place(reported_value.high, WIDTH)
    return IntervalBar(
        start,
        max(round(stop - start, 1), 2.0),
        place(reported_value.value, math.nan),
        tuple(place(end, 0.0) for end in limits),
    )
