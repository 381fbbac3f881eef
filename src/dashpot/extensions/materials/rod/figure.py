"""Figure of a rod's modulus against frequency with its uncertainty."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dashpot.base.units import convert_to_unit
from dashpot.datamodel.fit import Fit
from dashpot.extensions.materials.rod.datamodel import RodModulus
from dashpot.plot.picture import FIT, Area, Dots, Line, Mark, Panel, Picture, Scale, Span
from dashpot.plot.plotted_data import FREQUENCY, compute_padded_limits
from dashpot.plot.plotted_data import stamp as format_stamp

if TYPE_CHECKING:
    from dashpot.extensions.materials.rod.fit_files import Rod


def rod(modulus: RodModulus, *, fit: Fit | None = None, stamp: str = "") -> Picture:
    """Return storage modulus and loss factor with all errors together (1 SD), and the fitted model.

    Hatched is where either is not known to 10 %.

    Parameters
    ----------
    modulus : RodModulus
    fit : Fit, optional
        Fit of the usable band.
    stamp : str
        Origin of the data, printed below the figure.
    """
    f, usable = modulus.frequency, modulus.usable
    shown_lines = usable if usable.any() else np.ones(len(f), dtype=bool)
    low, high = float(f[shown_lines][0]), float(f[shown_lines][-1])
    span = max(low / 1.3, float(f[0])), min(high * 1.3, float(f[-1]))
    is_drawn = (f >= span[0]) & (f <= span[1])
    rows = (
        (
            "storage modulus E′, MPa",
            convert_to_unit(modulus.storage, "MPa"),
            convert_to_unit(modulus.storage_sd, "MPa"),
        ),
        ("loss factor E″/E′, 1", modulus.loss_factor, modulus.loss_factor_sd),
    )
    dense = np.geomspace(low, high, 150)
    panels = []
    for number, (label, value, error) in enumerate(rows):
        marks: list[Mark] = []
        if usable.any():
            marks += [
                Span(span[0], low, "away", "not usable", True, 1.0),
                Span(high, span[1], "away", hatched=True, tint=1.0),
            ]
        x, y, e = f[is_drawn], value[is_drawn], error[is_drawn]
        marks.append(Area(x, y - e, y + e, "ref", "error (1 SD)", tint=0.25))
        if fit is not None:
            omega = 2 * np.pi * dense
            values = (
                fit.solid.loss_factor(omega=omega)
                if number
                else convert_to_unit(fit.solid.storage(omega=omega), "MPa")
            )
            marks.append(Line(dense, values, FIT, "fit"))
        marks.append(Dots(x, y, "measured", "from the FRF"))
        error_limits = (value - error)[shown_lines], (value + error)[shown_lines]
        panels.append(
            Panel(
                Scale(FREQUENCY, span, log=True),
                Scale(label, compute_padded_limits(*error_limits)),
                tuple(marks),
                height=210,
            )
        )
    caption = (
        "Modulus of the rod's material by its wave equation, line by line, with the errors of "
        "sensors, masses and lengths together."
    )
    return Picture("rod", caption, tuple((panel,) for panel in panels), 2, stamp, width=900.0)


def draw_rod(new_rod: Rod) -> Picture:
    """Return the figure of a rod under a mass, stamped with its test."""
    return rod(
        new_rod.modulus, fit=new_rod.fit, stamp=format_stamp(new_rod.frf.source, mass=new_rod.mass)
    )
