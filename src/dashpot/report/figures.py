"""Figures of the report: inline SVG in two widths, with key and caption."""

from __future__ import annotations

import math
from collections.abc import Iterator

from dashpot import plot
from dashpot.base import dataclass, replace
from dashpot.plot.picture import Panel, joint_pen
from dashpot.plot.svg import strip, swatch, validate_svg_id
from dashpot.registry import find_handler
from dashpot.vibration.mass_on_seals import predict_frf
from dashpot.workflow.study import Study

PHONE_WIDTH, PAPER_WIDTH, PAGE_WIDTH = 350.0, 680.0, 1204.0
"""Widths of the drawing for a phone, for paper, and of all the columns on a screen, px."""

LOW_HEIGHT = 172.0
"""Height of the first figure where the numbers must stand beneath it on one screen or sheet, px."""

_GUTTER, _FEW = 24.0, 2
"""Gap between strips, px; number of small multiples in a row on a phone."""

LEAD_WIDTH, HALF_WIDTH = 728.0, 590.0
"""Widths of the figure on the first screen, and of one that stands beside words, px."""

BESIDE_WORDS = {"fit", "spectrum", "nyquist"}


@dataclass(frozen=True)
class RenderedFigure:
    """Figure as part of a page.

    Attributes
    ----------
    name, caption, stamp : str
    wide, narrow : tuple of str
        Its strips as SVG text, for a screen and for a phone.
    paper : tuple of str
        For a sheet of paper; empty if another one is sufficient.
    key : tuple of (str, str)
        A sample as SVG text, and its name.
    columns : int
    full : tuple of int
        For each strip how many would fill its row, where rows differ.
    """

    name: str
    caption: str
    stamp: str
    wide: tuple[str, ...]
    narrow: tuple[str, ...]
    paper: tuple[str, ...]
    key: tuple[tuple[str, str], ...]
    columns: int
    full: tuple[int, ...] = ()


def render_figure(
    picture: plot.Picture,
    *,
    width: float | None = None,
    low: float | None = None,
    phone: int = 1,
) -> RenderedFigure:
    """Render a picture for a page, `width` px wide; by default the width of its column.

    On a phone and on paper its panels are `low` px high together at most, if that is given. A row
    has `phone` strips on a phone, at most three on paper.
    """
    name = validate_svg_id(picture.name)
    columns = min(picture.columns, len(picture.strips))
    number = width or min(picture.width, (PAGE_WIDTH - 24 * (columns - 1)) / columns)

    panel_counts = tuple(count for count, row in picture.strip_rows for _ in row)

    def strips(value: float, kind: str, max_height: float = math.inf) -> tuple[str, ...]:
        total_width = PHONE_WIDTH if kind == "narrow" else value * columns + _GUTTER * (columns - 1)
        names = []
        for i, (panels, count) in enumerate(zip(picture.strips, panel_counts, strict=True)):
            index = count if kind == "wide" else min(count, _FEW) if count > _FEW else 1
            ratio = (total_width - _GUTTER * (index - 1)) / index if picture.rows else value
            scaled_panels = _scale_to_height(panels, max_height)
            names.append(strip(scaled_panels, name=f"{name}-{kind}-{i}", width=ratio, kind=kind))
        return tuple(names)

    key = tuple(
        (swatch(mark, name=f"{name}-key{i}"), mark.label) for i, mark in enumerate(picture.key)
    )
    on_paper = min(columns, 3)
    max_height, sheet = low or math.inf, (PAPER_WIDTH - 24 * (on_paper - 1)) / on_paper
    small = (PHONE_WIDTH - 16 * (phone - 1)) / phone
    paper = strips(sheet, "paper", max_height) if low or columns > 2 else ()
    versions = strips(number, "wide"), strips(small, "narrow", max_height), paper
    rows = panel_counts if picture.rows else ()
    return RenderedFigure(name, picture.caption, picture.stamp, *versions, key, columns, rows)


def _scale_to_height(panels: tuple[Panel, ...], max_height: float) -> tuple[Panel, ...]:
    """Panels no higher than that together, px."""
    ratio = min(1.0, max_height / sum(panel.height for panel in panels))
    return tuple(replace(panel, height=ratio * panel.height) for panel in panels)


def draw_study_figures(study: Study) -> dict[str, RenderedFigure]:
    """Return every figure that this study can fill, by name; "lead" is that of the first screen."""
    all_pictures = (*_make_relaxation_pictures(study), *_make_vibration_pictures(study))
    figures = {
        picture.name: render_figure(
            replace(picture, stamp=stamp(study)),
            width=HALF_WIDTH if picture.name in BESIDE_WORDS else None,
        )
        for picture in all_pictures
    }
    return figures | {
        "lead": render_figure(replace(lead(study), name="lead"), width=LEAD_WIDTH, low=LOW_HEIGHT)
    }


def stamp(study: Study) -> str:
    """Return the stamp of origin of every figure."""
    sources = list(study.fit.source)
    if study.measured is not None:
        sources += study.measured.source
    specimen = study.prepared.specimen
    seals = None if study.mass is None else study.seals
    return plot.stamp(sources, specimen, mass=study.mass, seals=seals)


def lead(study: Study) -> plot.Picture:
    """Return the figure that answers: the FRF of the mass on its seals; without a mass the fit."""
    text = stamp(study)
    if study.prediction is None or study.mass is None:
        picture = plot.fit(study.fit, study.prepared, stamp=text)
        return replace(picture, width=LEAD_WIDTH)
    predicted = study.prediction
    if study.comparison is not None:
        # on lines of its own: its peak may lie beyond the measured ones
        point = study.static_equilibrium.point if study.static_equilibrium is not None else None
        compression = point.compression if point is not None and point.is_stated else None
        predicted = predict_frf(
            study.fit, mass=study.mass, seals=study.seals, compression=compression
        )
    return plot.resonance(
        study.comparison,
        predicted,
        joint=study.joint_comparison,
        failed=_has_failed_joint_fit(study),
        band=study.frf_band,
        rival=study.rival,
        stamp=text,
    )


def _has_failed_joint_fit(study: Study) -> bool:
    """Return whether the joint fit is not to be used, however well it follows the hammer."""
    return study.joint is not None and study.joint.verdict.use == "do not use"


def _make_relaxation_pictures(study: Study) -> Iterator[plot.Picture]:
    yield plot.segments(study.prepared)
    yield plot.fit(study.fit, study.prepared, alternatives=study.alternatives)
    if study.other_tests and study.fit.temperatures is not None:
        yield plot.bench(study.fit, (study.prepared, *study.other_tests))
    law = study.fit.elastic_law
    if law is not None and law.kind != "linear":
        at = (
            None if study.static_equilibrium is None else study.static_equilibrium.point.compression
        )
        yield plot.elastic_law(study.fit, compression=at)
    yield plot.spectrum(study.fit, joint=study.joint)
    yield plot.stiffness(
        study.fit,
        parameters=study.parameters,
        unresolved_bounds=study.unmeasured,
        joint=study.joint,
        measured=study.direct,
        mark=None if study.comparison is None else study.comparison.measured_hz,
    )


def _make_vibration_pictures(study: Study) -> Iterator[plot.Picture]:
    if study.comparison is not None:
        c, joint = study.comparison, study.joint_comparison
        yield plot.comparison(
            c, joint=joint, failed=_has_failed_joint_fit(study), band=study.frf_band
        )
        after_fit = () if joint is None else (joint.predicted,)
        name = joint_pen(failed=_has_failed_joint_fit(study))[1]
        labels = ("measured", "predicted", name)
        yield plot.nyquist(
            c.measured, c.predicted, *after_fit, labels=labels, failed=_has_failed_joint_fit(study)
        )
    elif study.measured is not None:
        yield plot.frf(study.measured, labels=("measured",))
    elif study.prediction is not None:
        yield plot.frf(study.prediction, labels=("predicted, untested",), band=study.frf_band)
    chart = draw_stabilisation_chart(study)
    if chart is not None:
        yield chart
    if study.direct is not None:
        yield plot.dynamic_stiffness(study.direct, fit=study.fit, joint=study.joint)
    if study.impact is not None and study.measured is not None:
        yield plot.hits(study.impact, study.measured)


def draw_stabilisation_chart(study: Study) -> plot.Picture | None:
    """The stabilisation chart of the measured FRF with its modes; none of a transmissibility."""
    if study.measured is None or study.measured.quantity.over_base:
        return None
    band = None if study.comparison is None else study.comparison.band
    draw = find_handler("pole figure", study.measured)
    return None if draw is None else draw(study.measured, band=band)
