"""The figures of the report, as SVG text with a caption each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

from dashpot import plot
from dashpot.workflow.study import Study

CAPTIONS = {
    "segments": "The test as prepared: displacement and force, the ramp on linear time, the hold "
    "on logarithmic time. Shaded: baseline (grey), ramp (yellow), hold (blue).",
    "fit": "Measured force and fitted solids. Residuals: every sample pale, their mean in colour; "
    "a good fit leaves noise and no shape.",
    "law": "Elastic law from the ramp: relaxed force and tangent stiffness against "
    "compression. Small vibration feels the tangent where the mass rests, not the secant.",
    "spectrum": "Relaxation spectrum: one stem per Maxwell arm.",
    "stiffness": "Dynamic stiffness and loss factor of one seal. Solid line and blue shade: what "
    "the relaxation test informs; dashed: extrapolation.",
    "comparison": "Accelerance of the mass on its seals, measured and predicted, with phase and "
    "coherence. Dots: the peaks, with frequency and height in the corner.",
    "nyquist": "Nyquist plot of the accelerance; rings are the half-power points.",
    "frf": "Frequency response function,",
    "direct": "One seal straight from the measured FRF, without a model: the mean of each twelfth "
    "of an octave, the range of its lines (grey), and its errors laid upon each other.",
    "hits": "The hits laid over each other. Blue: accepted; vermillion, dashed: rejected. "
    "Shaded: the band that every accepted hit excites.",
}


class Picture(NamedTuple):
    """One figure: its SVG, and the caption that a reader without the picture can follow."""

    svg: str
    caption: str


def pictures(study: Study) -> dict[str, Picture]:
    """Every figure that this study can fill, by name."""
    drawn = {}
    for name, figure, *further in (*_of_relaxation(study), *_of_vibration(study)):
        caption = " ".join([CAPTIONS[name], *further])
        svg = plot.to_svg(replace(figure, name=name, caption=caption))
        drawn[name] = Picture(svg, caption)
    return drawn


def _of_relaxation(study: Study) -> Iterator[tuple[str, plot.Picture, *tuple[str, ...]]]:
    """Name, figure, and what its caption says further."""
    yield "segments", plot.segments(study.prepared)
    yield "fit", plot.fit(study.fit, study.prepared, alternatives=study.alternatives)
    law = study.fit.elastic_law
    if law is not None and law.kind != "linear":
        at = None if study.at_rest is None else study.at_rest.point.compression
        yield "law", plot.elastic_law(study.fit, compression=at)
    yield "spectrum", plot.spectrum(study.fit, joint=study.joint)
    stiffness = plot.stiffness(
        study.fit,
        parameters=study.parameters,
        unseen=study.unseen,
        joint=study.joint,
        measured=study.direct,
        mark=None if study.comparison is None else study.comparison.measured_hz,
    )
    further = []
    if study.unseen is not None:
        further.append("Purple: the bound over unresolved arms.")
    if study.direct is not None:
        further.append(
            "Points: straight from the FRF, where that is good, with one standard deviation."
        )
    yield "stiffness", stiffness, *further


def _of_vibration(study: Study) -> Iterator[tuple[str, plot.Picture, *tuple[str, ...]]]:
    alone = study.measured or study.prediction
    if study.comparison is not None:
        c, joint = study.comparison, study.joint_comparison
        yield "comparison", plot.comparison(c, joint=joint, band=study.frf_band)
        after = () if joint is None else (joint.predicted,)
        labels = ("measured", "predicted", "joint fit")
        yield "nyquist", plot.nyquist(c.measured, c.predicted, *after, labels=labels)
    elif alone is not None:
        measured = alone is study.measured
        what = "measured" if measured else "predicted, tested by no measurement"
        limits = None if measured else study.frf_band
        yield "frf", plot.frf(alone, labels=(what,), band=limits), f"{what}."
    if study.direct is not None:
        yield "direct", plot.dynamic_stiffness(study.direct, fit=study.fit, joint=study.joint)
    if study.impact is not None and study.measured is not None:
        yield "hits", plot.hits(study.impact, study.measured)
