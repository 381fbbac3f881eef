"""Figure of blank tests: measured values, and the machine's model."""

from __future__ import annotations

import numpy as np

from dashpot.extensions.blank_tests.datamodel import ROLE_LABELS, BlankCurve, MachineFit
from dashpot.plot.picture import DATA_ON_FIT, FIT, FIT_BAND, REF, Line, Panel, Picture, Rule, Scale
from dashpot.plot.plotted_data import compute_padded_limits, select_plot_unit
from dashpot.plot.plotted_data import stamp as format_stamp


def draw_machine(fit: MachineFit, *, stamp: str = "") -> Picture:
    """Return the force of each record with the machine's model, and the residual.

    Parameters
    ----------
    fit : MachineFit
    stamp : str
        Origin of the data, printed below the figure; by default the files.
    """
    strips = tuple((_draw_force(record), _draw_residual(record)) for record in fit.records)
    caption = "Blank tests: measured force, the model of the machine, and the residual."
    origin = format_stamp(fit.sources) if fit.sources else ""
    return Picture("machine", caption, strips, 3, stamp or origin)


def _draw_force(record: BlankCurve) -> Panel:
    """Return the force over time, and the model beneath or, of an empty run, upon it."""
    unit_name, scale = select_plot_unit(record.force, "N")
    force, fitted_force = scale * record.force, scale * record.fitted
    measured = Line(record.time, force, DATA_ON_FIT, "measured")
    empty = record.role == "empty"
    model = Line(
        record.time, fitted_force, FIT if empty else FIT_BAND, "drift" if empty else "model"
    )
    return Panel(
        Scale("time, s", compute_padded_limits(record.time)),
        Scale(f"force, {unit_name}", compute_padded_limits(force)),
        (measured, model) if empty else (model, measured),
        title=f"{ROLE_LABELS[record.role]}: {record.file}",
        height=210,
    )


def _draw_residual(record: BlankCurve) -> Panel:
    residual = record.force - record.fitted
    finite_values = residual[np.isfinite(residual)]
    unit_name, scale = select_plot_unit(finite_values, "N")
    return Panel(
        Scale("time, s", compute_padded_limits(record.time)),
        Scale(f"residual, {unit_name}", compute_padded_limits(scale * finite_values, np.zeros(1))),
        (Rule(0.0, REF, is_horizontal=True), Line(record.time, scale * residual, FIT)),
        title="measured less model",
        height=210,
    )
