"""Figures of the solid: spectrum, elastic law, stiffness fitted and from an FRF."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray, IndexArray
from dashpot.base.errors import DataError
from dashpot.base.option_fields import Method, get_choice_values
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.datamodel.bounds import StiffnessBounds
from dashpot.datamodel.fit import Fit
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
    joint_pen,
)
from dashpot.plot.plotted_data import (
    FREQUENCY,
    compute_padded_limits,
    compute_padded_log_limits,
    format_fit_stamp,
    read_as,
    split_at_band,
)
from dashpot.solids.maxwell import Solid
from dashpot.vibration.modal.dynamic_stiffness import DynamicStiffness

# Stiffness from an FRF with its errors.


QUANTITY_LABELS = {
    "storage": "storage stiffness K′, N/mm",
    "damping": "damping c, N·s/m",
    "loss_factor": "loss factor K″/K′, 1",
}


@dataclass(frozen=True, eq=False)
class PlottedQuantity:
    """Quantity to be drawn, in its display unit, with its three errors."""

    name: str
    value: FloatArray
    random: FloatArray
    phase: FloatArray
    mass: FloatArray
    usable_band: tuple[float, float]

    @property
    def nested_errors(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """All errors together, those of phase and scatter, and scatter alone."""
        inner = np.hypot(self.random, self.phase)
        return np.hypot(inner, self.mass), inner, self.random

    def evaluate_for_solid(self, solid: Solid, f: FloatArray) -> FloatArray:
        """Return the same quantity as a solid has it, at `f`, Hz."""
        omega = 2 * np.pi * f
        if self.name == "storage":
            return convert_to_unit(solid.storage(omega=omega), "N/mm")
        return (
            solid.loss(omega=omega) / omega
            if self.name == "damping"
            else solid.loss_factor(omega=omega)
        )


def dynamic_stiffness(
    measured: DynamicStiffness,
    *,
    fit: Fit | None = None,
    joint: Fit | None = None,
    stamp: str = "",
) -> Picture:
    """Stiffness, damping and loss factor of one seal, line by line, with their errors.

    Shaded about the points, one standard deviation each: the scatter of the FRF, with it the
    phase error between the channels, and with both the error of the mass. Hatched is where all
    of them together leave no usable value.

    Parameters
    ----------
    measured : DynamicStiffness
    fit, joint : Fit, optional
        Solids of one seal to hold against it.
    """
    errors = (
        f"and {100 * measured.mass_sd / measured.mass:.2g} % error of mass",
        f"and {np.degrees(measured.phase_sd):.2g}° error of phase",
        "error (1 SD): scatter",
    )
    span = _span(measured)
    dense = np.geomspace(*span, 150)
    solids = (
        [] if joint is None else [(joint, *joint_pen(failed=joint.verdict.use == "do not use"))]
    )
    solids += [] if fit is None else [(fit, FIT, "relaxation fit")]
    panels = []
    for line in build_plotted_quantities(measured):
        marks: list[Mark] = []
        if np.isfinite(line.usable_band).all():
            marks.append(Span(span[0], line.usable_band[0], "away", "not usable", True, 1.0))
            marks.append(Span(line.usable_band[1], span[1], "away", hatched=True, tint=1.0))
        f, plotted = average_octave_bands(measured.frequency, line)
        for error, label, tint in zip(
            plotted.nested_errors, errors, (0.15, 0.25, 0.4), strict=True
        ):
            marks.append(
                Area(f, plotted.value - error, plotted.value + error, "ref", label, tint=tint)
            )
        low, high = compute_octave_extent(measured.frequency, line.value)
        gap = np.full(len(f), np.nan)
        marks.append(Line(np.column_stack([f, f, gap]).ravel(),
                          np.column_stack([low, high, gap]).ravel(), Pen("ref", 0.8),
                          "range of the lines"))  # fmt: skip
        marks += [
            Line(dense, line.evaluate_for_solid(fit.solid, dense), pen, who)
            for fit, pen, who in solids
        ]
        marks.append(Dots(f, plotted.value, "measured", "from the FRF"))
        axes = (
            Scale(FREQUENCY, span, log=True),
            Scale(QUANTITY_LABELS[line.name], _view(plotted, f)),
        )
        panels.append(Panel(*axes, tuple(marks), height=210))
    caption = (
        "One seal directly from the measured FRF, without a model: the mean of each twelfth of an "
        "octave, the range of its lines, and its errors, stacked."
    )
    strips = tuple((panel,) for panel in panels)
    return Picture("direct", caption, strips, 3, stamp, width=900.0)


def build_plotted_quantities(
    measured: DynamicStiffness,
) -> tuple[PlottedQuantity, PlottedQuantity, PlottedQuantity]:
    """Return storage stiffness, damping and loss factor with their errors."""
    m, omega = measured, 2 * np.pi * measured.frequency
    zeros = np.zeros(len(omega))

    def compute_factor_error(loss: FloatArray, storage: FloatArray) -> FloatArray:
        return np.asarray(np.abs(m.loss_factor) * np.hypot(loss / m.loss, storage / m.storage))

    storage, random, phase, mass = (
        convert_to_unit(values, "N/mm")
        for values in (m.storage, m.storage_random, m.storage_phase, m.storage_mass)
    )
    return (
        PlottedQuantity("storage", storage, random, phase, mass, m.storage_band),
        PlottedQuantity(
            "damping", m.damping, m.loss_random / omega, m.loss_phase / omega, zeros, m.loss_band
        ),
        PlottedQuantity(
            "loss_factor",
            m.loss_factor,
            compute_factor_error(m.loss_random, m.storage_random),
            compute_factor_error(m.loss_phase, m.storage_phase),
            compute_factor_error(zeros, m.storage_mass),
            m.loss_band,
        ),
    )


def average_octave_bands(
    f: FloatArray, line: PlottedQuantity, *, per_octave: int = 12
) -> tuple[FloatArray, PlottedQuantity]:
    """Return the mean over every part of an octave, lines weighted by their scatter.

    Scatter shrinks with the number of lines; the errors of phase and mass, alike in all, stay.
    """
    starts = _bins(f, per_octave)
    weight = 1 / line.random**2 if (line.random > 0).all() else np.ones(len(f))
    total = np.add.reduceat(weight, starts)

    def mean(values: FloatArray) -> FloatArray:
        return np.asarray(np.add.reduceat(weight * values, starts) / total)

    scatter = np.sqrt(np.add.reduceat((weight * line.random) ** 2, starts)) / total
    return mean(f), PlottedQuantity(
        line.name, mean(line.value), scatter, mean(line.phase), mean(line.mass), line.usable_band
    )


def compute_octave_extent(f: FloatArray, value: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the lowest and the highest line in every twelfth of an octave."""
    starts = _bins(f, 12)
    return np.minimum.reduceat(value, starts), np.maximum.reduceat(value, starts)


def _bins(f: FloatArray, per_octave: int) -> IndexArray:
    """Return where every part of an octave begins, empty ones omitted."""
    number = np.floor(per_octave * np.log2(f / f[0]))
    return np.flatnonzero(np.concatenate(([True], np.diff(number) > 0)))


def _span(measured: DynamicStiffness) -> tuple[float, float]:
    """Return the usable band and a little more; all lines if none is usable."""
    f = measured.frequency
    low, high = measured.storage_band
    if not np.isfinite(low):
        return float(f[0]), float(f[-1])
    return max(low / 1.3, float(f[0])), min(high * 1.3, float(f[-1]))


def _view(plotted: PlottedQuantity, f: FloatArray) -> tuple[float, float]:
    """Return limits that show the usable part with its errors, without the excesses outside it."""
    usable = (f >= plotted.usable_band[0]) & (f <= plotted.usable_band[1])
    shown_lines = usable if usable.any() else np.ones(len(f), dtype=bool)
    error = plotted.nested_errors[0]
    low = float(np.min((plotted.value - error)[shown_lines]))
    high = float(np.max((plotted.value + error)[shown_lines]))
    if plotted.name != "storage" and not plotted.usable_band[1] > 2 * plotted.usable_band[0]:
        # a lightly damped part is usable at its peak only: leave space for what is not
        median_value = float(np.median(plotted.value[shown_lines]))
        low, high = (
            min(low, -0.5 * abs(median_value)),
            max(high, median_value + 1.5 * abs(median_value)),
        )
    margin = 0.1 * (high - low)
    return low - margin, high + margin


# Relaxation spectrum, and stiffness fitted and from an FRF.


SECANT = Pen("ref", 1.4, (6, 3))
RESONANCE = Pen("ref", 1.4, (2, 3))


class StiffnessSweep(Protocol):
    """Measured storage and loss over frequency."""

    @property
    def frequency(self) -> FloatArray: ...  # noqa: D102
    @property
    def storage(self) -> FloatArray: ...  # noqa: D102
    @property
    def loss(self) -> FloatArray: ...  # noqa: D102


def spectrum(fit: Fit, *, joint: Fit | None = None, stamp: str = "") -> Picture:
    """Relaxation spectrum: one stem per arm with 95 % intervals, what is out of reach hatched.

    The dashed line is the equilibrium stiffness. A relaxation time out of reach is one that the
    test could not have distinguished from its neighbours.
    """
    words = _words(fit)
    low, high = (1 / (2 * np.pi * f) for f in reversed(fit.band))
    shown_taus = [*fit.model.tau, *(joint.model.tau if joint else ())]
    limits = (min([low, *shown_taus]) / 4, max([high, *shown_taus]) * 4)
    k_inf = words.scale * fit.model.k_inf
    marks: list[Mark] = [
        Span(limits[0], low, "away", "unresolved range", hatched=True, tint=1.0),
        Span(high, limits[1], "away", hatched=True, tint=1.0),
        Rule(k_inf, SECANT, f"{words.plateau}, {words.fit}", is_horizontal=True),
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
    constant_stiffness = np.full(len(x), law.stiffness)
    tangent, error = (
        convert_to_unit(values, "N/mm")
        for values in (law.tangent(x), 2 * law.stiffness * law.factor_se(x))
    )
    secant = f"secant at {format_quantity(law.depth, 'mm', '.3g')}"
    rest: tuple[Mark, ...] = ()
    if compression is not None:
        rest_text = f"the mass rests at {format_quantity(compression, 'mm', '.3g')}"
        rest = (Rule(convert_to_unit(compression, "mm"), RESONANCE, rest_text),)
    force = (
        *rest,
        Line(at, law.stiffness * x, SECANT, secant),
        Line(at, law.force(x), FIT, "elastic law"),
    )
    stiffness = (
        *rest,
        Area(at, tangent - error, tangent + error, "fit", "± 2 standard errors"),
        Line(at, convert_to_unit(constant_stiffness, "N/mm"), SECANT, secant),
        Line(at, tangent, FIT, "elastic law"),
        Dots(
            convert_to_unit(knots, "mm"), convert_to_unit(law.tangent(knots), "N/mm"), "fit", size=5
        ),
    )
    horizontal = Scale("compression, mm", (0.0, float(at[-1])))
    highest = float(np.max([law.force(x), law.stiffness * x]))
    steepest = compute_padded_limits(tangent, tangent + error, margin=0.0)[1]
    panels = (
        Panel(horizontal, Scale("relaxed force, N", (0.0, 1.08 * highest)), force),
        Panel(horizontal, Scale("tangent stiffness k∞, N/mm", (0.0, 1.08 * steepest)), stiffness),
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
    unresolved_bounds: StiffnessBounds | None = None,
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
    parameters, unresolved_bounds : StiffnessBounds, optional
        Limits by the standard errors; the limits over all spectra that the test does not reject.
    joint : Fit, optional
        The fit to relaxation and FRF together.
    measured : DynamicStiffness, optional
        Stiffness of one seal directly from the FRF, drawn as points where it is accurate.
    data : StiffnessSweep, optional
        The sweep that was fitted, drawn as points.
    mark : float, optional
        A frequency to point at, such as the measured resonance, Hz.
    stamp : str
        Origin of the data, printed below the figure; by default the fit's files, specimen and date.
    """
    f = _frequencies(fit, measured, data, unresolved_bounds, mark)
    words = _words(fit)
    panels = []
    for name, label in zip(("storage", "loss", "loss_factor"), words.axes, strict=True):
        factor = 1.0 if name == "loss_factor" else words.scale
        curve = factor * getattr(fit.solid, name)(frequency=f)
        marks: list[Mark] = []
        for bounds, band_label in ((unresolved_bounds, BOUND), (parameters, INTERVAL)):
            if bounds is not None:
                edges = factor * getattr(bounds, name)
                marks.append(
                    Area(
                        bounds.frequency, edges[0], edges[1], "fit", band_label, band_label == BOUND
                    )
                )
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
        "Dynamic stiffness and loss factor: solid in the valid band of the fit, dashed where it "
        "is extrapolated."
    )
    strips = tuple((panel,) for panel in panels)
    return Picture("stiffness", caption, strips, 3, stamp or format_fit_stamp(fit), width=900.0)


def _scale(name: str, label: str, curve: FloatArray, marks: list[Mark]) -> Scale:
    """Return the upright axis: logarithmic for a loss, unless it is a spring's, which has none."""
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
    """Words for a fit on an axis, and the factor from SI to the unit of the axis."""

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
    axes = (QUANTITY_LABELS["storage"], "loss stiffness K″, N/mm", QUANTITY_LABELS["loss_factor"])
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
    if not fit.estimate.parameters:
        return marks  # a dense spectrum has no intervals to draw
    bounds = fit.intervals(level=0.95)
    window = [1 / (2 * np.pi * f) for f in reversed(fit.band)]
    # an open end is drawn to the edge of what could matter
    interval_ends = [
        ((t, t), (scale * max(a, 0.0), scale * min(b, k_0)))
        for t, (a, b) in zip(tau, bounds["k"], strict=True)
    ]
    interval_ends += [
        ((max(a, window[0] / 10), min(b, window[1] * 10)), (height, height))
        for height, (a, b) in zip(k, bounds["tau"], strict=True)
    ]
    x, y = (np.array([v for pair in interval_ends for v in (*pair[i], np.nan)]) for i in (0, 1))
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
    return np.geomspace(fit.band[0] / 3 or 0.01, max(tops), 300)


def _sweep(data: StiffnessSweep, name: str, factor: float) -> Dots:
    """Return the measured values."""
    values = data.loss / data.storage if name == "loss_factor" else factor * getattr(data, name)
    return Dots(data.frequency, np.asarray(values), "measured", "measured")


def _points(measured: DynamicStiffness | None, name: str) -> list[Dots]:
    """Return the FRF in third octaves where it is accurate, with one standard deviation."""
    if measured is None:
        return []
    lines = {quantity.name: quantity for quantity in build_plotted_quantities(measured)}
    line = lines["damping" if name == "loss" else name]
    f, plotted = average_octave_bands(measured.frequency, line, per_octave=3)
    is_good = (f >= plotted.usable_band[0]) & (f <= plotted.usable_band[1])
    factor = convert_to_unit(2 * np.pi * f, "N/mm") if name == "loss" else np.ones(len(f))
    value, error = factor * plotted.value, factor * plotted.nested_errors[0]
    points = Dots(
        f[is_good], value[is_good], "measured", "directly from the FRF", error=error[is_good]
    )
    return [points] * bool(is_good.any())  # an FRF may be good nowhere
