"""Figure of a hyperelastic law: stress over stretch in every mode."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.number_format import round_to_error
from dashpot.base.units import convert_to_unit
from dashpot.extensions.materials.hyperelastic.datamodel import HyperelasticFit
from dashpot.extensions.materials.hyperelastic.strain_energy import SHEARING
from dashpot.extensions.materials.options import Mode
from dashpot.plot.picture import (
    FIT,
    PREDICTED,
    REF,
    REJECTED,
    Dots,
    Line,
    Mark,
    Panel,
    Picture,
    Rule,
    Scale,
    Span,
)
from dashpot.plot.plotted_data import compute_padded_limits
from dashpot.plot.plotted_data import stamp as format_stamp

_MARGIN = 0.08
_AXES = (
    ("stretch", "nominal stress, MPa"),
    ("volume ratio J", "mean true stress, MPa"),
)


def hyperelastic(fit: HyperelasticFit, *, stamp: str = "") -> Picture:
    """Nominal stress over stretch in each mode with the law, and where that is not stable.

    Parameters
    ----------
    fit : HyperelasticFit
    stamp : str
        Origin of the data, printed below the figure; by default the files.
    """
    volume = [curve.mode for curve in fit.curves if curve.mode == "volumetric"][:1]
    panels = [_make_panel(fit, mode) for mode in (*SHEARING, *volume)]
    caption = "Stress over stretch: tested, the law's, and where the law is not stable."
    origin = format_stamp(fit.sources) if fit.sources else ""
    return Picture("hyperelastic", caption, tuple((panel,) for panel in panels), 2, stamp or origin)


def _find_unstable_range(fit: HyperelasticFit, mode: Mode, x: FloatArray) -> list[Mark]:
    """Return where the law is not stable, below and above, as far as `x` reaches."""
    stretch_limits = dict(fit.stable).get(mode, (None, None))
    marks: list[Mark] = []
    for limit, end in zip(stretch_limits, (float(x[0]), float(x[-1])), strict=True):
        if limit is not None and x[0] < limit < x[-1]:
            low, high = sorted((limit, end))
            marks += [Span(low, high, "bad", "not stable", hatched=True), Rule(limit, REJECTED)]
    return marks


def _make_panel(fit: HyperelasticFit, mode: Mode) -> Panel:
    curves = [curve for curve in fit.curves if curve.mode == mode]
    stretches = np.concatenate([dict(fit.reach).get(mode, ()), [1.0], *(c.stretch for c in curves)])
    low, high = float(stretches.min()), float(stretches.max())
    pad = _MARGIN * (high - low)
    x = np.linspace(max(low - pad, 0.02), high + pad, 160)
    law = convert_to_unit(fit.law.nominal(mode, x), "MPa")
    in_range = (x >= low) & (x <= high)
    marks = [Rule(0.0, REF, is_horizontal=True), *_find_unstable_range(fit, mode, x)]
    measured = [convert_to_unit(curve.stress, "MPa") for curve in curves]
    for elastic_curve, stress in zip(curves, measured, strict=True):
        marks.append(Dots(elastic_curve.stretch, stress, "measured", "measured", size=3.0))
    marks.append(Line(x, law, PREDICTED, "not measured"))
    if curves:
        marks.append(Line(x[in_range], law[in_range], FIT, fit.law.kind))
    residuals = [
        r for curve, r in zip(fit.curves, fit.residuals, strict=True) if curve.mode == mode
    ]  # fmt: skip
    note = (
        f"residual {round_to_error(100 * max(residuals), digits=2)} %"
        if residuals
        else "not measured"
    )
    horizontal, axis_label = _AXES[mode == "volumetric"]
    return Panel(
        Scale(horizontal, (float(x[0]), float(x[-1]))),
        Scale(axis_label, compute_padded_limits(law, *measured)),
        tuple(marks),
        title=mode,
        note=note,
    )
