"""Figures of the solid: its relaxation spectrum, its stiffness fitted and straight from an FRF."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.choices import Method, get_choice_values
from dashpot.base.errors import DataError
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.datamodel.bounds import StiffnessBounds
from dashpot.datamodel.fit import Fit
from dashpot.plot.dynamic_stiffness_figure import (
    FREQUENCY,
    LABELS,
    average_octave_bands,
    quantities,
)
from dashpot.plot.frf_figure import BOUND, INTERVAL
from dashpot.plot.picture import (
    FIT,
    Area,
    Dots,
    Line,
    Mark,
    Panel,
    Pen,
    Picture,
    Rule,
    Scale,
    Span,
    compute_padded_limits,
    compute_padded_log_limits,
    joint_pen,
    read_as,
    split_at_band,
)
from dashpot.plot.provenance_stamp import format_fit_stamp
from dashpot.vibration.modal.dynamic_stiffness import DynamicStiffness

SECANT = Pen("ref", 1.4, (6, 3))
RESONANCE = Pen("ref", 1.4, (2, 3))


class StiffnessSweep(Protocol):
    """Storage and loss that were measured over frequency."""

    @property
    def frequency(self) -> FloatArray: ...  # noqa: D102
    @property
    def storage(self) -> FloatArray: ...  # noqa: D102
    @property
    def loss(self) -> FloatArray: ...  # noqa: D102


def spectrum(fit: Fit, *, joint: Fit | None = None, stamp: str = "") -> Picture:
    """Relaxation spectrum: one stem per arm with 95 % intervals, what is out of reach hatched.

    The dashed line is the equilibrium stiffness. A relaxation time out of reach is one that the
    test could not have told from its neighbours.
    """
    words = _words(fit)
    low, high = (1 / (2 * np.pi * f) for f in reversed(fit.band))
    shown = [*fit.model.tau, *(joint.model.tau if joint else ())]
    limits = (min([low, *shown]) / 4, max([high, *shown]) * 4)
    k_inf = words.scale * fit.model.k_inf
    marks: list[Mark] = [
        Span(limits[0], low, "away", "unresolved range", hatched=True, tint=1.0),
        Span(high, limits[1], "away", hatched=True, tint=1.0),
        Rule(k_inf, SECANT, f"{words.plateau}, {words.fit}", across=True),
    ]
    if joint is not None:
        marks += _stems(joint, *joint_pen(failed=joint.verdict.use == "do not use"))
    marks += _stems(fit, FIT, words.fit)
    tallest = max(
        [k_inf, *(words.scale * k for item in (fit, joint) if item for k in item.model.k)]
    )
    axes = Scale("relaxation time τ, s", limits, log=True), Scale(words.arm, (0.0, 1.2 * tallest))
    caption = "Relaxation spectrum: one stem per Maxwell arm, 95 % intervals of k and τ."
    panel = Panel(*axes, tuple(marks), height=220)
    return Picture("spectrum", caption, ((panel,),), 1, stamp or format_fit_stamp(fit), width=420.0)


def elastic_law(fit: Fit, *, compression: float | None = None, stamp: str = "") -> Picture:
    """Relaxed force and tangent stiffness against compression, the tangent with two errors.

    The dashed lines are the secant of the fit, which a straight law would follow. `compression`,
    m, is where a mass rests.

    Raises
    ------
    DataError
        If the fit has no elastic law.
    """
    law = fit.elastic_law
    if law is None:
        raise DataError("the fit has no elastic law: it is not of a relaxation test")
    x = np.linspace(0.0, law.depth, 201)
    knots, at = np.asarray(law.knots), convert_to_unit(x, "mm")
    straight = np.full(len(x), law.stiffness)
    tangent, error = (
        convert_to_unit(values, "N/mm")
        for values in (law.tangent(x), 2 * law.stiffness * law.factor_se(x))
    )
    secant = f"secant at {format_quantity(law.depth, 'mm', '.3g')}"
    rest: tuple[Mark, ...] = ()
    if compression is not None:
        where = f"the mass rests at {format_quantity(compression, 'mm', '.3g')}"
        rest = (Rule(convert_to_unit(compression, "mm"), RESONANCE, where),)
    force = (
        *rest,
        Line(at, law.stiffness * x, SECANT, secant),
        Line(at, law.force(x), FIT, "elastic law"),
    )
    stiffness = (
        *rest,
        Area(at, tangent - error, tangent + error, "fit", "± 2 standard errors"),
        Line(at, convert_to_unit(straight, "N/mm"), SECANT, secant),
        Line(at, tangent, FIT, "elastic law"),
        Dots(
            convert_to_unit(knots, "mm"), convert_to_unit(law.tangent(knots), "N/mm"), "fit", size=5
        ),
    )
    below = Scale("compression, mm", (0.0, float(at[-1])))
    highest = float(np.max([law.force(x), law.stiffness * x]))
    steepest = compute_padded_limits(tangent, tangent + error, margin=0.0)[1]
    panels = (
        Panel(below, Scale("relaxed force, N", (0.0, 1.08 * highest)), force),
        Panel(below, Scale("tangent stiffness k∞, N/mm", (0.0, 1.08 * steepest)), stiffness),
    )
    caption = (
        "Elastic law from the ramp: relaxed force and tangent stiffness against compression. "
        "Small vibration feels the tangent where the mass rests, not the secant."
    )
    strips = tuple((panel,) for panel in panels)
    return Picture("law", caption, strips, 2, stamp or format_fit_stamp(fit))


def stiffness(
    fit: Fit,
    *,
    parameters: StiffnessBounds | None = None,
    unseen: StiffnessBounds | None = None,
    joint: Fit | None = None,
    measured: DynamicStiffness | None = None,
    data: StiffnessSweep | None = None,
    mark: float | None = None,
    stamp: str = "",
) -> Picture:
    """Storage, loss and loss factor against frequency: stiffness of one seal, or a modulus.

    Solid where the test informs the model, dashed where it is extrapolated.

    Parameters
    ----------
    fit : Fit
    parameters, unseen : StiffnessBounds, optional
        What the standard errors allow; what any spectrum allows that the test cannot reject.
    joint : Fit, optional
        The fit to relaxation and FRF together.
    measured : DynamicStiffness, optional
        Stiffness of one seal straight from the FRF, drawn as points where it is good.
    data : StiffnessSweep, optional
        The sweep that was fitted, drawn as points.
    mark : float, optional
        A frequency to point at, such as the measured resonance, Hz.
    stamp : str
        What the figure says of its origin; by default the fit's files, specimen and date.
    """
    f = _frequencies(fit, measured, data, unseen, mark)
    words = _words(fit)
    panels = []
    for name, label in zip(("storage", "loss", "loss_factor"), words.axes, strict=True):
        factor = 1.0 if name == "loss_factor" else words.scale
        curve = factor * getattr(fit.solid, name)(frequency=f)
        marks: list[Mark] = []
        for bounds, what in ((unseen, BOUND), (parameters, INTERVAL)):
            if bounds is not None:
                edges = factor * getattr(bounds, name)
                marks.append(Area(bounds.frequency, edges[0], edges[1], "fit", what, what == BOUND))
        if joint is not None:
            value = factor * getattr(joint.solid, name)(frequency=f)
            marks.append(Line(f, value, *joint_pen(failed=joint.verdict.use == "do not use")))
        marks += split_at_band(fit.band, f, curve, words.fit, text=f"{words.fit}, extrapolated")
        if data is not None:
            marks.append(_sweep(data, name, factor))
        marks += _points(measured, name)
        if mark is not None:
            marks.append(Rule(mark, RESONANCE, f"resonance, {mark:.4g} Hz"))
        axes = (
            Scale(FREQUENCY, (float(f[0]), float(f[-1])), log=True),
            _scale(name, label, curve, marks),
        )
        panels.append(Panel(*axes, tuple(marks), height=210))
    caption = (
        "Dynamic stiffness and loss factor: solid where the test informs the fit, dashed where it "
        "is extrapolated."
    )
    strips = tuple((panel,) for panel in panels)
    return Picture("stiffness", caption, strips, 3, stamp or format_fit_stamp(fit), width=900.0)


def _scale(name: str, label: str, curve: FloatArray, marks: list[Mark]) -> Scale:
    """The upright axis: logarithmic for a loss, unless it is a spring's, which has none."""
    points = [m.y for m in marks if isinstance(m, (Line, Dots))]
    tops = [m.high for m in marks if isinstance(m, Area)]
    # a bound that no test sets runs out at the top of the axis
    highest = compute_padded_limits(*points, *tops, margin=0.0)[1]
    if name == "storage" or not curve.max() > 0:
        lowest = min(0.0, float(np.nanmin(curve)))
        return Scale(label, (lowest, 1.08 * highest if highest > 0 else 1.0))
    # a lower limit that touches zero must not make the axis dive after it
    low, high = compute_padded_log_limits(*points, margin=1.4)
    return Scale(label, (max(low, 1e-4 * high), max(high, min(1.2 * highest, 30 * high))), log=True)


class _Words(NamedTuple):
    """What a fit is called on an axis, and the factor from SI to the unit said there."""

    scale: float
    arm: str
    plateau: str
    axes: tuple[str, str, str]
    band: str
    fit: str


def _words(fit: Fit) -> _Words:
    of_force = fit.method in get_choice_values(Method)
    band = "band of the relaxation test" if of_force else "band of the test"
    name = "relaxation fit" if of_force else "fit"
    _, scale = read_as(fit.unit)
    if fit.unit == "Pa":
        axes = ("storage modulus E′, MPa", "loss modulus E″, MPa", "loss factor E″/E′, 1")
        return _Words(scale, "modulus E, MPa", "E∞", axes, band, name)
    axes = (LABELS["storage"], "loss stiffness K″, N/mm", LABELS["loss_factor"])
    return _Words(scale, "stiffness k, N/mm", "k∞", axes, band, name)


def _stems(fit: Fit, pen: Pen, label: str) -> list[Mark]:
    """One stem per arm, with the intervals of its stiffness and of its relaxation time."""
    scale, k_0 = _words(fit).scale, fit.model.k_0
    tau, k = np.asarray(fit.model.tau), scale * np.asarray(fit.model.k)
    gap = np.full(len(tau), np.nan)
    stems = Line(
        np.column_stack([tau, tau, gap]).ravel(),
        np.column_stack([np.zeros(len(tau)), k, gap]).ravel(), pen, label,
    )  # fmt: skip
    marks: list[Mark] = [stems, Dots(tau, k, pen.colour, size=8)]
    if not fit.parameters:
        return marks  # a dense spectrum has no intervals to draw
    bounds = fit.intervals(level=0.95)
    window = [1 / (2 * np.pi * f) for f in reversed(fit.band)]
    # an open end is drawn to the edge of what could matter
    ends = [
        ((t, t), (scale * max(a, 0.0), scale * min(b, k_0)))
        for t, (a, b) in zip(tau, bounds["k"], strict=True)
    ]
    ends += [
        ((max(a, window[0] / 10), min(b, window[1] * 10)), (height, height))
        for height, (a, b) in zip(k, bounds["tau"], strict=True)
    ]
    x, y = (np.array([v for pair in ends for v in (*pair[i], np.nan)]) for i in (0, 1))
    return [Line(x, y, Pen(pen.colour, 1.2), ""), *marks]


def _frequencies(
    fit: Fit,
    measured: DynamicStiffness | None,
    data: StiffnessSweep | None,
    bounds: StiffnessBounds | None,
    mark: float | None,
) -> FloatArray:
    tops = [fit.band[1] * 30, 30.0]
    if data is not None:
        tops = [float(data.frequency.max()) * 3]
    if mark is not None:
        tops.append(3 * mark)
    tops += [float(item.frequency[-1]) for item in (bounds, measured) if item is not None]
    return np.geomspace(fit.band[0] / 3, max(tops), 300)


def _sweep(data: StiffnessSweep, name: str, factor: float) -> Dots:
    """What was measured of it."""
    values = data.loss / data.storage if name == "loss_factor" else factor * getattr(data, name)
    return Dots(data.frequency, np.asarray(values), "measured", "measured")


def _points(measured: DynamicStiffness | None, name: str) -> list[Dots]:
    """What the FRF says in thirds of an octave, where that is good, with one standard deviation."""
    if measured is None:
        return []
    lines = {quantity.name: quantity for quantity in quantities(measured)}
    line = lines["damping" if name == "loss" else name]
    f, plotted = average_octave_bands(measured.frequency, line, per_octave=3)
    good = (f >= plotted.good[0]) & (f <= plotted.good[1])
    factor = convert_to_unit(2 * np.pi * f, "N/mm") if name == "loss" else np.ones(len(f))
    value, error = factor * plotted.value, factor * plotted.nested_errors[0]
    points = Dots(f[good], value[good], "measured", "straight from the FRF", error=error[good])
    return [points] * bool(good.any())  # an FRF may be good nowhere
