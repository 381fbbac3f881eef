"""The whole method in one picture: the relaxation test and its fit, the FRF and its prediction."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from dashpot.comparison import Comparison
from dashpot.plot import relaxation, vibration
from dashpot.plot.look import (
    CHOSEN,
    JOINT,
    MEASURED,
    NORMAL,
    PAGE,
    SMALL,
    dress,
    figure,
    legend,
)
from dashpot.plot.panels import frequency as panel
from dashpot.relaxation.fit import Fit
from dashpot.relaxation.records import RampHold

if TYPE_CHECKING:
    from matplotlib.figure import Figure, SubFigure


class Story(Protocol):
    """What the picture needs of a study."""

    @property
    def prepared(self) -> RampHold: ...
    @property
    def fit(self) -> Fit: ...
    @property
    def alternatives(self) -> tuple[Fit, ...]: ...
    @property
    def comparison(self) -> Comparison | None: ...
    @property
    def joint_comparison(self) -> Comparison | None: ...


def hero(study: Story) -> Figure:
    """The relaxation test with its fits on the left, the FRF with its predictions on the right.

    Without a comparison, the fits alone.
    """
    made = figure(PAGE, 88)
    if study.comparison is None:
        _bench(made, study)
        return made
    left, right = made.subfigures(1, 2, width_ratios=(1.0, 1.12))
    _bench(left, study)
    _hammer(right, study.comparison, study.joint_comparison)
    return made


def _bench(made: Figure | SubFigure, study: Story) -> None:
    upper, lower = made.subplots(2, 1, sharex=True, height_ratios=(2.6, 1.0))
    shown = relaxation.fits_to_show(study.fit, study.alternatives)
    relaxation.draw_fits(upper, shown, study.prepared, chosen=study.fit)
    dress(upper, y="force, N", title="Relaxation test: ramp and hold")
    legend(upper, loc="lower right")
    relaxation.draw_residual(lower, study.fit, study.prepared, chosen=study.fit)
    lower.set_xlabel(f"{relaxation.FROM_CONTACT} (log)", fontsize=NORMAL)
    made.align_ylabels([upper, lower])


def _hammer(made: Figure | SubFigure, comparison: Comparison, joint: Comparison | None) -> None:
    upper, lower = made.subplots(2, 1, sharex=True, height_ratios=(2.6, 1.0))
    curves = [
        (comparison.measured, "measured (hammer)", MEASURED),
        (comparison.predicted, "predicted from the relaxation test", CHOSEN),
    ]
    if joint is not None:
        curves.append((joint.predicted, "joint fit of both tests", JOINT))
    vibration.draw_magnitude(upper, curves)
    upper.set_title("Frequency response of the mass on its seals", fontsize=NORMAL, loc="left",
                    fontweight="bold")  # fmt: skip
    vibration.name_peaks(upper, comparison, joint)
    for one, _, pen in curves:
        panel.phase(lower, one.frequency, one.value, pen)
    dress(lower, x=vibration.FREQUENCY, y="phase, °")
    handles, labels = upper.get_legend_handles_labels()
    upper.legend(handles, labels, loc="lower right", fontsize=SMALL, frameon=False)
    made.align_ylabels([upper, lower])
