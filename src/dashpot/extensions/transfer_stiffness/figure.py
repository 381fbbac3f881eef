"""Figure of a transfer stiffness: level, loss factor, level difference."""

from __future__ import annotations

import numpy as np

from dashpot.base.units import convert_to_unit
from dashpot.extensions.transfer_stiffness.checks import MIN_BLOCKED_DIFFERENCE
from dashpot.extensions.transfer_stiffness.stiffness_sheet import (
    TransferStiffness,
    compute_level,
)
from dashpot.plot.picture import (
    FIT,
    PREDICTED,
    REF,
    Area,
    Dots,
    Line,
    Mark,
    Panel,
    Picture,
    Rule,
    Scale,
    Span,
)
from dashpot.plot.plotted_data import compute_padded_limits
from dashpot.plot.plotted_data import stamp as format_stamp

_MIN_REACH = 0.5
"""dB that the axis of the level spans at least, to either side."""


def draw_transfer_stiffness(sheet: TransferStiffness, *, stamp: str = "") -> Picture:
    """Return level and loss factor with their 95 % limits, and how well the output is blocked.

    Parameters
    ----------
    sheet : TransferStiffness
    stamp : str
        Origin of the data, printed below the figure; by default the files.
    """
    f = sheet.frequency
    frequency_scale = Scale("frequency, Hz", (float(f[0]), float(f[-1])), log=True)
    strips = [(_draw_level(sheet, frequency_scale),), (_draw_loss_factor(sheet, frequency_scale),)]
    difference = sheet.level_difference
    if difference is not None:
        low, high = compute_padded_limits(difference, np.array([MIN_BLOCKED_DIFFERENCE]))
        marks: tuple[Mark, ...] = (
            *_mark_unblocked(sheet),
            Rule(MIN_BLOCKED_DIFFERENCE, REF, f"{MIN_BLOCKED_DIFFERENCE:g} dB", is_horizontal=True),
            Line(f, difference, FIT, "input over output"),
        )
        strips.append(
            (Panel(frequency_scale, Scale("level difference, dB", (low, high)), marks,
                   title="how well the output is blocked"),)
        )  # fmt: skip
    caption = (
        "Transfer stiffness of a mount: its level re 1 N/m over frequency and in third octaves, "
        "and its loss factor, with 95 % limits."
    )
    origin = format_stamp(sheet.source) if sheet.source else ""
    return Picture("transfer-stiffness", caption, tuple(strips), 2, stamp or origin)


def _mark_unblocked(sheet: TransferStiffness) -> tuple[Mark, ...]:
    """Return a hatched span over the lines at which the output is not blocked; none if it is."""
    start = sheet.valid_from
    first, last = float(sheet.frequency[0]), float(sheet.frequency[-1])
    end = last if start is None else start
    return (Span(first, end, "edge", "output not blocked", hatched=True),) if end > first else ()


def _draw_level(sheet: TransferStiffness, frequency_scale: Scale) -> Panel:
    f, bands = sheet.frequency, sheet.bands
    centre = np.array([band.centre for band in bands])
    level = np.array([band.level for band in bands])
    low, high = compute_level(sheet.limits)
    pen = PREDICTED if sheet.method == "predicted" else FIT
    marks: list[Mark] = [
        *_mark_unblocked(sheet),
        Area(f, low, high, "fit", "95 % limits"),
        Line(f, sheet.level, pen, "lines"),
    ]
    shown_lines = sheet.blocked if sheet.blocked.any() else np.ones(len(f), dtype=bool)
    shown_levels = [low[shown_lines], high[shown_lines]]
    if sheet.indirect is not None and (sheet.exact or sheet.method == "predicted"):
        formula = compute_level(np.abs(sheet.indirect))
        marks.append(Line(f, formula, REF, "indirect method"))
        shown_levels.append(formula[shown_lines])
    marks.append(Dots(centre, level, "measured", "third octaves"))
    lower, upper = compute_padded_limits(*shown_levels)
    middle, half_range = (lower + upper) / 2, max((upper - lower) / 2, _MIN_REACH)
    last = bands[-1]
    return Panel(
        frequency_scale,
        Scale("level, dB re 1 N/m", (middle - half_range, middle + half_range)),
        tuple(marks),
        title="level of the transfer stiffness",
        note=f"{convert_to_unit(last.stiffness, 'N/mm'):.4g} N/mm at {last.centre:g} Hz",
    )


def _draw_loss_factor(sheet: TransferStiffness, frequency_scale: Scale) -> Panel:
    f, (low, high) = sheet.frequency, sheet.loss_factor_limits
    bands = [band for band in sheet.bands if band.valid] or list(sheet.bands)
    loss_factor_limits = np.array([band.loss_factor_limits for band in bands]).T
    lower, upper = compute_padded_limits(
        loss_factor_limits[0], loss_factor_limits[1], np.array([0.0])
    )
    marks: tuple[Mark, ...] = (
        *_mark_unblocked(sheet),
        Area(f, low, high, "fit", "95 % limits"),
        Line(f, sheet.loss_factor, PREDICTED if sheet.method == "predicted" else FIT, "lines"),
        Dots(
            np.array([band.centre for band in bands]),
            np.array([band.loss_factor for band in bands]),
            "measured",
            "third octaves",
        ),
    )
    return Panel(frequency_scale, Scale("loss factor", (lower, upper)), marks, title="loss factor")
