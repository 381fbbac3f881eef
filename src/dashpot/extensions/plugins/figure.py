"""Figure of a plug-in's result: each value with its interval."""

from __future__ import annotations

import math

import numpy as np

from dashpot.base.reported_values import ReportedValue
from dashpot.extensions.plugins.datamodel import PluginFit
from dashpot.plot.picture import FIT, Dots, Line, Panel, Picture, Scale
from dashpot.plot.plotted_data import stamp as format_stamp

_HEIGHT = 60.0


def draw_plugin_result(fit: PluginFit, *, stamp: str = "") -> Picture:
    """Return every number of a plug-in with its interval, one below the other.

    Parameters
    ----------
    fit : PluginFit
    stamp : str
        Origin of the data, printed below the figure; by default the files.
    """
    origin = format_stamp(fit.sources) if fit.sources else ""
    caption = f"Numbers of '{fit.kind}' of {fit.package}, each with its interval."
    panels = tuple((_make_panel(reported_value),) for reported_value in fit.reported_values)
    return Picture("plugged", caption, panels, 1, stamp or origin)


def _make_panel(reported_value: ReportedValue) -> Panel:
    value, low, high = (
        reported_value.to_display_unit(number)
        for number in (reported_value.value, reported_value.low, reported_value.high)
    )
    limits = [number for number in (low, high) if math.isfinite(number)]
    half_range = max([abs(end - value) for end in limits] + [0.1 * abs(value) or 1.0])
    label = f"{reported_value.label}, {reported_value.word or '1'}"
    horizontal = Scale(label, (value - 1.2 * half_range, value + 1.2 * half_range))
    marks = [Dots(np.array([value]), np.array([0.5]), "fit", "value")]
    lines = [Line(np.array(limits), np.full(2, 0.5), FIT, "interval")] if len(limits) == 2 else []
    return Panel(horizontal, Scale("", (0.0, 1.0)), (*lines, *marks), height=_HEIGHT)
