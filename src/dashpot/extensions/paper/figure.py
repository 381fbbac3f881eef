"""Figures of the paper, reproduced."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.number_format import round_to_error
from dashpot.base.units import convert_to_unit
from dashpot.datamodel.relaxation import RelaxationTest
from dashpot.plot.picture import FIT, REF, SIMPLER, Line, Panel, Pen, Picture, Rule, Scale, Tag
from dashpot.plot.plotted_data import compute_padded_limits, downsample_to_extremes

DATA = Pen("measured", 2.4)
CLOCK = "time from first contact, s"
BINS = 500


def figure_2(test: RelaxationTest, contact: float, *, stamp: str = "") -> Picture:
    """Return displacement and force of the ramp and hold, one below the other (paper Fig. 2).

    Parameters
    ----------
    test : RelaxationTest
    contact : float
        Contact with the seal, s on the clock of the record.
    stamp : str
        Origin of the data, printed below the figure.
    """
    t = test.time - contact
    axis = Scale(CLOCK, (float(t[0]), float(t[-1])))
    displacement, force = convert_to_unit(test.displacement, "mm"), test.force
    peak_index = int(np.argmax(force))
    highest = Tag(
        float(t[peak_index]),
        float(force[peak_index]),
        f"{round_to_error(float(force[peak_index]), digits=4)} N at {t[peak_index]:.3g} s",
        "measured",
        "filled",
    )
    end = f"{round_to_error(float(force[-1]), digits=4)} N at {t[-1]:.3g} s"
    panels = (
        Panel(
            axis,
            Scale("displacement, mm", compute_padded_limits(displacement)),
            (Line(*downsample_to_extremes(t, displacement, bins=BINS), DATA),),
            title="a: displacement",
            height=110,
        ),
        Panel(
            axis,
            Scale("force, N", compute_padded_limits(force, margin=0.12)),
            (Line(*downsample_to_extremes(t, force, bins=BINS), DATA), highest),
            title="b: force",
            note=end,
            height=210,
        ),
    )
    caption = "Stress relaxation of one seal, 8 mm in 1 s and held: displacement and force."
    return Picture("figure-2", caption, (panels,), 1, stamp)


def figure_4(
    test: RelaxationTest,
    contact: float,
    fits: Sequence[tuple[str, FloatArray, FloatArray]],
    *,
    stamp: str = "",
) -> Picture:
    """Return the hold, the models fitted to it, and their residuals (paper Fig. 4).

    Parameters
    ----------
    test : RelaxationTest
    contact : float
        Contact with the seal, s on the clock of the record.
    fits : sequence of (str, array, array)
        Name, time from contact, s, and force, N, of each; the best one last.
    stamp : str
        Origin of the data, printed below the figure.
    """
    hold_start = float(fits[0][1][0])
    t = test.time - contact
    in_hold = t >= hold_start
    x = Scale(CLOCK, (hold_start, float(t[-1])), log=True)
    pens = (*SIMPLER[: len(fits) - 1], FIT)
    hold_force = test.force[in_hold]
    # the fit over a broad record: both are seen where they agree
    marks = [
        Line(
            *downsample_to_extremes(t[in_hold], hold_force, bins=BINS, log=True),
            Pen("measured", 6.0),
            "measured",
        )
    ]
    panels = []
    for (name, time, force), pen in zip(fits, pens, strict=True):
        marks.append(Line(*downsample_to_extremes(time, force, bins=BINS, log=True), pen, name))
        residual = convert_to_unit(np.interp(time, t, test.force) - force, "mN")
        rms = round_to_error(float(np.sqrt(np.mean(residual**2))), digits=3)
        label = "left, mN"
        panels.append(
            Panel(
                x,
                Scale(label, compute_padded_limits(residual, np.array([-1.0, 1.0]))),
                (
                    Rule(0.0, REF, is_horizontal=True),
                    Line(
                        *downsample_to_extremes(time, residual, bins=BINS, log=True),
                        Pen(pen.colour, 1.4),
                    ),
                ),
                height=80,
                note=f"{name}: {rms} mN rms",
            )
        )
    upper = Panel(
        x,
        Scale("force, N", compute_padded_limits(hold_force, *(fit[2] for fit in fits))),
        tuple(marks),
        height=230,
    )
    caption = (
        "Force while the seal is held, with N = 1 and N = 2 fitted to it, and what each leaves."
    )
    return Picture("figure-4", caption, ((upper, *panels),), 1, stamp)
