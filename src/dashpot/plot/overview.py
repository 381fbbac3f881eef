"""The whole method in one picture: the relaxation test and its fit, the FRF and its prediction."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

from dashpot.plot import relaxation, vibration
from dashpot.plot.style import PAGE, figure, label_axes, legend, unit_of
from dashpot.records.bounds import FRFBounds
from dashpot.records.fit import Fit
from dashpot.records.relaxation import RampHold
from dashpot.vibration.comparison.comparison import Comparison

if TYPE_CHECKING:
    from matplotlib.figure import Figure, SubFigure


class Story(Protocol):
    """What the picture needs of a study."""

    prepared: RampHold
    fit: Fit
    alternatives: tuple[Fit, ...]
    seals: float
    mass: float | None
    comparison: Comparison | None
    joint_comparison: Comparison | None
    frf_band: FRFBounds | None


def hero(study: Story) -> Figure:
    """The relaxation test with its fits on the left, the FRF with its predictions on the right.

    Without a comparison, the fits alone.
    """
    made = figure(PAGE, 92)
    if study.comparison is None:
        _bench(made, study)
        return made
    left, right = np.asarray(made.subfigures(1, 2, width_ratios=(1.0, 1.08)))
    _bench(left, study)
    _hammer(right, study, study.comparison)
    return made


def _bench(made: Figure | SubFigure, study: Story) -> None:
    upper, lower = made.subplots(2, 1, sharex=True, height_ratios=(2.8, 1.0))
    test = study.prepared
    shown = relaxation.fitted(study.fit, study.alternatives, test)
    relaxation.draw_fits(upper, shown, test)
    word, factor = unit_of(test.displacement, "m")
    label_axes(
        upper,
        title=f"Relaxation test: {factor * test.depth:.3g} {word} in {test.ramp_time:.3g} s, "
        f"held {test.hold_time:.3g} s",
    )
    legend(upper, loc="lower right")
    chosen = next(one for one in shown if one.fit is study.fit)
    others = [one for one in shown if one is not chosen]
    relaxation.draw_residual(lower, chosen, test, others=others)
    label_axes(lower, x=relaxation.FROM_LOG, y=lower.get_ylabel().partition("\n")[2])
    made.align_ylabels([upper, lower])


def _hammer(made: Figure | SubFigure, study: Story, comparison: Comparison) -> None:
    upper, lower = made.subplots(2, 1, sharex=True, height_ratios=(2.8, 1.0))
    curves = vibration.curves_of(comparison, study.joint_comparison)
    vibration.draw_magnitude(upper, curves, around=comparison.measured_hz)
    mass = "" if study.mass is None else f"{1e3 * study.mass:.3g} g on "
    label_axes(upper, title=f"Hammer test: {mass}{study.seals:g} seals")
    if study.frf_band is not None:
        vibration.draw_band(upper, study.frf_band, parameters=False)
    vibration.mark_peaks(upper, curves)
    legend(upper, loc="lower right")
    vibration.draw_phase(lower, curves, spread=False)
    label_axes(lower, x=vibration.FREQUENCY)
    made.align_ylabels([upper, lower])
