"""The figures of the report, as SVG text with a caption each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from dashpot import plot
from dashpot.records.frf import FRF
from dashpot.workflow.study import Study

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Picture:
    """One figure: its SVG, and the caption that a reader without the picture can follow."""

    svg: str
    caption: str


def pictures(study: Study) -> dict[str, Picture]:
    """Every figure that this study can fill, by name."""
    drawn = {
        "segments": _picture(
            "segments",
            plot.segments(study.prepared),
            "The test as prepared: displacement and force, the ramp on linear time, the hold on "
            "logarithmic time. Shaded: baseline (grey), ramp (yellow), hold (blue).",
        ),
        "fit": _picture(
            "fit",
            plot.fit(study.fit, study.prepared, alternatives=study.alternatives),
            "Measured force and fitted solids. Residuals: every sample pale, their mean in "
            "colour; a good fit leaves noise and no shape.",
        ),
        "spectrum": _picture(
            "spectrum",
            plot.spectrum(study.fit, joint=study.joint),
            "Relaxation spectrum: one stem per Maxwell arm.",
        ),
        "stiffness": _picture("stiffness", _stiffness(study), _about_stiffness(study)),
    }
    return drawn | _hammer(study)


def _picture(name: str, figure: Figure, caption: str) -> Picture:
    return Picture(plot.to_svg(figure, name=name, title=caption), caption)


def _stiffness(study: Study) -> Figure:
    return plot.stiffness(
        study.fit,
        parameters=study.parameters,
        unseen=study.unseen,
        joint=study.joint,
        measured=study.direct,
        mark=None if study.comparison is None else study.comparison.measured_hz,
    )


def _about_stiffness(study: Study) -> str:
    text = (
        "Dynamic stiffness and loss factor of one seal. Solid line and blue shade: what the "
        "relaxation test informs; dashed: extrapolation."
    )
    if study.unseen is not None:
        text += " Purple: the room it leaves for arms that it cannot see."
    if study.direct is not None:
        text += " Points: straight from the FRF, where that is good, with one standard deviation."
    return text


def _hammer(study: Study) -> dict[str, Picture]:
    drawn = {}
    if study.comparison is not None:
        c, joint = study.comparison, study.joint_comparison
        drawn["comparison"] = _picture(
            "comparison",
            plot.comparison(c, joint=joint, band=study.frf_band),
            "Accelerance of the mass on its seals, measured and predicted, with phase and "
            "coherence. Dots: the peaks, with frequency and height in the corner.",
        )
        after = () if joint is None else (joint.predicted,)
        drawn["nyquist"] = _picture(
            "nyquist",
            plot.nyquist(
                c.measured, c.predicted, *after, labels=("measured", "predicted", "joint fit")
            ),
            "Nyquist plot of the accelerance; rings are the half-power points.",
        )
    elif (alone := study.measured or study.prediction) is not None:
        drawn["frf"] = _alone(alone, study)
    if study.direct is not None:
        drawn["direct"] = _picture(
            "direct",
            plot.dynamic_stiffness(study.direct, fit=study.fit, joint=study.joint),
            "One seal straight from the measured FRF, without a model: the mean of each twelfth of "
            "an octave, the range of its lines (grey), and its errors laid upon each other.",
        )
    if study.impact is not None and study.measured is not None:
        drawn["hits"] = _picture(
            "hits",
            plot.hits(study.impact, study.measured),
            "The hits laid over each other. Blue: accepted; vermillion, dashed: rejected. "
            "Shaded: the band that every accepted hit excites.",
        )
    return drawn


def _alone(frf: FRF, study: Study) -> Picture:
    measured = frf is study.measured
    what = "measured" if measured else "predicted, tested by no measurement"
    made = plot.frf(frf, labels=(what,), band=None if measured else study.frf_band)
    return _picture("frf", made, f"Frequency response function, {what}.")
