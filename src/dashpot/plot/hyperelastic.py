"""The figure of a hyperelastic law: stress over stretch in every mode."""

from __future__ import annotations

import numpy as np

from dashpot.base.numbers import rounded
from dashpot.plot.picture import (
    FIT,
    PREDICTED,
    REF,
    REJECTED,
    Axis,
    Dots,
    Line,
    Mark,
    Panel,
    Picture,
    Rule,
    Span,
    around,
)
from dashpot.plot.stamps import stamp as stamped
from dashpot.records.hyperelastic import HyperelasticFit
from dashpot.solids.hyperelastic import SHEARING, Mode

_MARGIN = 0.08


def hyperelastic(fit: HyperelasticFit, *, stamp: str = "") -> Picture:
    """Nominal stress over stretch in each mode with the law, and where that is not stable.

    Parameters
    ----------
    fit : HyperelasticFit
    stamp : str
        What the figure says of its origin; by default the files.
    """
    volume = [one.mode for one in fit.curves if one.mode == "volumetric"][:1]
    panels = [_panel(fit, mode) for mode in (*SHEARING, *volume)]
    caption = "Stress over stretch: tested, the law's, and where the law is not stable."
    origin = stamped(fit.sources) if fit.sources else ""
    return Picture("hyperelastic", caption, tuple((one,) for one in panels), 2, stamp or origin)


def _panel(fit: HyperelasticFit, mode: Mode) -> Panel:
    curves = [one for one in fit.curves if one.mode == mode]
    spans = [(float(one.stretch.min()), float(one.stretch.max())) for one in curves]
    low, high = dict(fit.reach).get(mode, (1.0, 1.0))
    low, high = min([low, *(a for a, _ in spans)]), max([high, *(b for _, b in spans)])
    low, high = min(low, 1.0), max(high, 1.0)
    pad = _MARGIN * (high - low)
    x = np.linspace(max(low - pad, 0.02), high + pad, 160)
    law = 1e-6 * fit.law.nominal(mode, x)
    within = (x >= low) & (x <= high)
    marks: list[Mark] = [Rule(0.0, REF, across=True)]
    for below, at in zip((True, False), dict(fit.stable).get(mode, (None, None)), strict=True):
        if at is not None and x[0] < at < x[-1]:
            edge = (float(x[0]), at) if below else (at, float(x[-1]))
            marks += [Span(*edge, "bad", "not stable", hatched=True), Rule(at, REJECTED)]
    measured = [1e-6 * one.stress for one in curves]
    for one, stress in zip(curves, measured, strict=True):
        marks.append(Dots(one.stretch, stress, "measured", "measured", size=3.0))
    if curves:
        marks.append(Line(x, law, PREDICTED, "not measured"))
        marks.append(Line(x[within], law[within], FIT, fit.law.kind))
    else:
        marks.append(Line(x, law, PREDICTED, "not measured"))
    left = [
        r for one, r in zip(fit.curves, fit.residuals, strict=True) if one.mode == mode
    ]  # fmt: skip
    note = f"residual {rounded(100 * max(left), digits=2)} %" if left else "not measured"
    across = "volume over volume at rest" if mode == "volumetric" else "stretch"
    what = "mean true stress, MPa" if mode == "volumetric" else "nominal stress, MPa"
    return Panel(
        Axis(across, (float(x[0]), float(x[-1]))), Axis(what, around(law, *measured)),
        tuple(marks), title=mode, note=note,
    )  # fmt: skip
