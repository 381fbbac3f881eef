"""Figures of measured modes: the stabilisation chart, and modes under several masses."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from dashpot.base.number_format import format_with_error, round_to_error
from dashpot.base.reported_values import NORMAL
from dashpot.base.units import convert_to_unit
from dashpot.datamodel.frf import FRF, Kind, Mode
from dashpot.datamodel.structure import FRFSet
from dashpot.extensions.modes.mass_series import SeveralMasses
from dashpot.extensions.modes.stabilisation import DAMPING, FREQUENCY, NEW, SHAPE, Stabilisation
from dashpot.extensions.modes.stabilisation import stabilisation as compute_stabilisation
from dashpot.plot.picture import MEASURED, Dots, Line, Mark, Panel, Pen, Picture, Rule, Scale, Tag
from dashpot.plot.plotted_data import compute_padded_limits, compute_padded_log_limits
from dashpot.plot.style import sequential

if TYPE_CHECKING:
    from dashpot.extensions.modes.mass_series_files import MassSeriesModes


MODE_PEN = Pen("fit", 1.2, (7, 4))
BACKGROUND_PEN = Pen("line", 1.4)
MARKERS = {
    SHAPE: ("stable in frequency, damping and shape", "fit", 4.5, False),
    DAMPING: ("stable in frequency and damping", "fit", 4.5, False),
    FREQUENCY: ("stable in frequency", "ref", 4.5, True),
    NEW: ("new pole", "ref", 2.5, False),
}
"""Words, colour, size and whether hollow."""
BAND_RATIO = 2.0
"""Factor by which the FRFs under several masses are shown below and above their modes."""
MAX_LABELS = 4
"""Number of modes that have a label."""


def stabilisation(chart: Stabilisation, modes: Sequence[Mode] = (), *, stamp: str = "") -> Picture:
    """Poles of every order over frequency, by the properties kept from the previous order.

    Above them, and pale behind them, the root mean square of the points' accelerances; dashed the
    modes that were found without the chart.

    Parameters
    ----------
    chart : Stabilisation
    modes : sequence of Mode
    stamp : str
        Origin of the data, printed below the figure.
    """
    x = Scale("frequency, Hz", (float(chart.lines[0]), float(chart.lines[-1])))
    mode_rules = [Rule(mode.frequency, MODE_PEN, "fitted mode") for mode in modes]
    limits = compute_padded_log_limits(chart.height, margin=2.0)
    upper: list[Mark] = [*mode_rules, Line(chart.lines, chart.height, MEASURED, "measured")]
    tallest = sorted(modes, key=lambda mode: -abs(mode.residue))[:MAX_LABELS]
    for mode in sorted(tallest, key=lambda mode: mode.frequency):
        top = float(np.interp(mode.frequency, chart.lines, chart.height))
        text = (
            f"{round_to_error(mode.frequency, digits=4)} Hz, "
            f"{round_to_error(100 * mode.damping_ratio)} %"
        )
        upper.append(Tag(mode.frequency, top, text, "fit"))
    axis_label = "accelerance, 1/kg" if chart.points == 1 else "rms accelerance, 1/kg"
    level = np.log(chart.height / limits[0]) / np.log(limits[1] / limits[0])
    lower: list[Mark] = [Line(chart.lines, level * chart.highest, BACKGROUND_PEN), *mode_rules]
    has_several_points = chart.points > 1
    for state, (label, colour, size, hollow) in sorted(MARKERS.items()):
        is_state = chart.state == state
        if is_state.any():
            # of several points what stays in shape stands out, of one there is no shape
            is_pale = has_several_points and state == DAMPING
            lower.append(
                Dots(chart.frequency[is_state], chart.order[is_state].astype(float), colour, label,
                     size=size, hollow=hollow or is_pale)
            )  # fmt: skip
    count = f"{chart.points} points" if has_several_points else "one point"
    caption = (
        f"Stabilisation chart of {count}: poles by model order. Poles of the structure stay at one "
        "frequency as the order rises; dashed, the modes that were found without the chart."
    )
    strip = (
        Panel(x, Scale(axis_label, limits, log=True), tuple(upper), height=150),
        Panel(x, Scale("order", (0.0, chart.highest + 1.0)), tuple(lower), height=230),
    )
    return Picture("stabilisation", caption, (strip,), 1, stamp)


def several_masses(masses: SeveralMasses, frfs: Sequence[FRF], *, stamp: str = "") -> Picture:
    """Return the FRF under each mass with its mode, and the stiffness of one seal at the poles.

    The figure shows the measured values and the linear solid closest to all of them.

    Parameters
    ----------
    masses : SeveralMasses
    frfs : sequence of FRF
        Under each of the masses.
    stamp : str
        Origin of the data, printed below the figure.
    """
    hertz = np.array([mode.frequency for mode in masses.modes])
    low, high = hertz.min() / BAND_RATIO, hertz.max() * BAND_RATIO
    curves: list[Mark] = []
    heights = []
    colours = sequential(len(frfs))
    for frf, mass, mode, colour in zip(frfs, masses.masses, masses.modes, colours, strict=True):
        single_frf = frf.to(Kind.ACCELERANCE, mass=mass)
        in_range = (single_frf.frequency >= low) & (single_frf.frequency <= high)
        f, height = single_frf.frequency[in_range], np.abs(single_frf.value[in_range])
        heights.append(height)
        curves.append(Line(f, height, Pen(colour, 1.6), format_with_error(mass, "g", digits=4)))
        top = float(np.interp(mode.frequency, f, height))
        text = (
            f"{round_to_error(mode.frequency, digits=4)} Hz, "
            f"{round_to_error(100 * mode.damping_ratio)} %"
        )
        curves.append(Tag(mode.frequency, top, text, colour, "filled"))
    x = Scale(
        "frequency, Hz", compute_padded_log_limits(np.array([low, high]), margin=1.0), log=True
    )
    limits = compute_padded_log_limits(*heights, margin=2.0)
    panels = [Panel(x, Scale("accelerance, 1/kg", limits, log=True), tuple(curves))]
    order = np.argsort(hertz)
    for i, name in enumerate(("storage stiffness, N/mm", "loss stiffness, N/mm")):
        measured, solid = (
            convert_to_unit((values.imag if i else values.real)[order], "N/mm")
            for values in (masses.stiffness, masses.stiffness_at_poles)
        )
        error = NORMAL * convert_to_unit(masses.spread[order, i], "N/mm")
        marks = (
            Line(hertz[order], solid, MODE_PEN),
            Dots(hertz[order], solid, "fit", "the linear model nearest to all", hollow=True,
                 size=7.0),
            Dots(hertz[order], measured, "measured", "at each pole, 95 %", error=error),
        )  # fmt: skip
        panels.append(
            Panel(
                x,
                Scale(name, compute_padded_limits(measured - error, measured + error, solid)),
                marks,
            )
        )
    caption = (
        "Modes under several masses, and the stiffness and loss of one seal that their poles have, "
        "and those of the one linear model that fits best."
    )
    return Picture("masses", caption, tuple((panel,) for panel in panels), 3, stamp, width=1100.0)


def draw_masses(modes: MassSeriesModes) -> Picture:
    """Return the figure of modes under several masses."""
    return several_masses(modes.joint_modes, [test.frf for test in modes.tests])


def draw_poles(frf: FRF, *, band: tuple[float, float] | None = None) -> Picture:
    """Return the stabilisation chart of an FRF with its modes."""
    return stabilisation(compute_stabilisation(FRFSet((frf,)), band=band), frf.modes(band=band))


def list_poles(frf: FRF, *, band: tuple[float, float] | None = None) -> list[list[float]]:
    """Return frequency, Hz, order and state of every pole of the stabilisation chart of an FRF."""
    chart = compute_stabilisation(FRFSet((frf,)), band=band)
    columns = (chart.frequency.tolist(), chart.order.tolist(), chart.state.tolist())
    return [list(row) for row in zip(*columns, strict=True)]
