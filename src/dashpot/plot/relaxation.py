"""Figures of relaxation tests: segments, and fits."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.number_format import round_to_error
from dashpot.base.option_fields import Method, get_choice_values
from dashpot.datamodel.fit import Fit, get_model_label
from dashpot.datamodel.relaxation import RampHold
from dashpot.plot.picture import (
    FIT,
    MEASURED,
    REF,
    SIMPLER,
    Area,
    Line,
    Mark,
    Panel,
    Pen,
    Picture,
    Rule,
    Scale,
    Span,
)
from dashpot.plot.plotted_data import (
    compute_padded_limits,
    downsample_to_extremes,
    downsample_to_means,
    format_fit_stamp,
    format_test_stamp,
    select_plot_unit,
)
from dashpot.preprocessing.denoising import denoise_displacement
from dashpot.registry import find_handler
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid

DATA = Pen("measured", 1.2)
"""Pen of a record; the fits are drawn over it."""

TIME_LABEL, TIME_AFTER_RAMP_LABEL = "time since first contact, s", "time since ramp end, s"


def segments(prepared: RampHold, *, stamp: str = "") -> Picture:
    """Return the prepared test with its baseline, ramp and hold (paper Fig. 2).

    Left the ramp on linear time, right the hold on log time from first contact, so that neither
    is a sliver of the other; displacement above, force below.
    """
    length, to_length = select_plot_unit(prepared.displacement, "m")
    force, to_force = select_plot_unit(prepared.force, "N")
    rows = (
        (to_length * prepared.displacement, f"compression, {length}"),
        (to_force * prepared.force, f"force, {force}"),
    )
    t, c, end = prepared.time - prepared.onset, prepared.ramp_time, _get_hold_end(prepared)
    ramp = (max(t[0], -0.6 * c), min(t[-1], 2.0 * c))
    hold = (0.5 * c, max(t[-1], end))
    hold_time, depth_text = prepared.hold_time, f"{to_length * prepared.depth:.3g} {length}"
    titles = (f"Ramp, {c:.3g} s", f"Hold, {hold_time:.3g} s at {depth_text}")
    strips = []
    for limits, log, title in zip((ramp, hold), (False, True), titles, strict=True):
        in_range = (t >= limits[0]) & (t <= limits[1])
        strip: list[Panel] = []
        for values, label in rows:
            x, y = downsample_to_extremes(t[in_range], values[in_range], bins=400, log=log)
            marks: list[Mark] = [*_shade_ramp(prepared, limits)]
            marks.append(Line(x, y, MEASURED, "measured"))
            axes = (Scale(TIME_LABEL, limits, log), Scale(label, compute_padded_limits(y)))
            strip.append(Panel(*axes, tuple(marks), title=title * (not strip), height=130))
        strips.append(tuple(strip))
    caption = (
        "The test as prepared: displacement and force, the ramp on linear time, the hold on "
        "logarithmic time."
    )
    return Picture("segments", caption, tuple(strips), 2, stamp or format_test_stamp(prepared))


def fit(
    fit: Fit, prepared: RampHold, *, alternatives: Sequence[Fit] = (), stamp: str = ""
) -> Picture:
    """Return the force and one or more fits to it, with the residuals of each (paper Fig. 4).

    Log time from first contact. A residual is drawn as the range of its samples and their mean.

    Parameters
    ----------
    fit : Fit
        The chosen one.
    prepared : RampHold
        Fitted record.
    alternatives : sequence of Fit
        Other fits for comparison, such as one arm against two.
    stamp : str
        Origin of the data, printed below the figure; by default the fit's files, specimen and date.
    """
    plotted_fits = make_plotted_fits(fit, alternatives, prepared)
    # the chosen one first
    residuals = [residual_panel(item, prepared)
                 for item in sorted(plotted_fits,
                 key=lambda item: item.fit is not fit)]  # fmt: skip
    caption = (
        "Measured force and fitted models, and their residuals: a good fit leaves noise without "
        "systematic shape."
    )
    strip = (force_panel(plotted_fits, prepared), *residuals)
    return Picture("fit", caption, (strip,), 1, stamp or format_fit_stamp(fit))


class PlottedFit(NamedTuple):
    """Fit to be drawn: its pen, time from first contact, s, and its force, N."""

    fit: Fit
    pen: Pen
    time: FloatArray
    force: FloatArray

    @property
    def label(self) -> str:
        """Label in the key."""
        name = get_model_label(self.fit)
        return f"fit, {name}" if self.pen is FIT else name

    def residual(
        self, prepared: RampHold, start: float | None = None
    ) -> tuple[FloatArray, FloatArray]:
        """Time from first contact and residual, N, over what a log axis shows, or from `start`."""
        start = _log_start(prepared) if start is None else start
        in_fit = (self.time >= start) & (self.time <= _get_hold_end(prepared))
        measured = np.interp(self.time[in_fit], prepared.time - prepared.onset, prepared.force)
        return self.time[in_fit], measured - self.force[in_fit]


def make_plotted_fits(
    chosen_fit: Fit, alternatives: Sequence[Fit], prepared: RampHold
) -> list[PlottedFit]:
    """Return the curves of all fits that are shown."""
    return [
        PlottedFit(fit, FIT if fit is chosen_fit else SIMPLER[fit.model.arms % 2],
               *fitted_force(fit, prepared))
        for fit in fits_to_show(chosen_fit, alternatives)
    ]  # fmt: skip


def fits_to_show(fit: Fit, alternatives: Sequence[Fit]) -> list[Fit]:
    """Return the alternatives and the chosen fit, one per number of arms, fewest arms first."""
    by_arms = {alternative.model.arms: alternative for alternative in (*alternatives, fit)}
    return [by_arms[arms] for arms in sorted(by_arms)]


def force_panel(
    plotted_fits: Sequence[PlottedFit],
    prepared: RampHold,
    *,
    title: str = "",
    height: float = 210.0,
) -> Panel:
    """Return force with the fitted curves over it, on log time."""
    start, end = _log_start(prepared), _get_hold_end(prepared)
    unit, scale = select_plot_unit(prepared.force, "N")

    def line(t: FloatArray, force: FloatArray, pen: Pen, label: str) -> Line:
        is_drawn = (t >= start) & (t <= end)
        return Line(*downsample_to_extremes(t[is_drawn], scale * force[is_drawn], bins=350,
        log=True),
                    pen, label)  # fmt: skip

    data = line(prepared.time - prepared.onset, prepared.force, DATA, "measured")
    # the chosen one over the others
    curves = [line(item.time, item.force, item.pen, item.label)
              for item in sorted(plotted_fits, key=lambda item: item.pen is FIT)]  # fmt: skip
    marks: list[Mark] = [*_shade_ramp(prepared, (start, end)), data, *curves]
    axes = (
        Scale(TIME_LABEL, (start, end), log=True),
        Scale(f"force, {unit}", compute_padded_limits(data.y)),
    )
    return Panel(*axes, tuple(marks), title=title, height=height)


def residual_panel(
    curve: PlottedFit,
    prepared: RampHold,
    *,
    time_origin: float = 0.0,
    axis: Scale | None = None,
) -> Panel:
    """Measured less fitted force against log time, and the noise it should be.

    Time counts from `time_origin`, s after first contact; by default from it.
    """
    start = None if axis is None else time_origin + axis.limits[0]
    time, residual = curve.residual(prepared, start)
    time = time - time_origin
    unit, scale = select_plot_unit(residual, "N")
    drawn_residual = scale * residual
    x, mean = downsample_to_means(time, drawn_residual, log=True)
    low, high = _compute_ranges(time, drawn_residual, x)
    noise = scale * prepared.force_noise
    marks: list[Mark] = [Area(x, low, high, curve.pen.colour, "residual: range of samples")]
    if noise > 0:
        pair = (
            Rule(noise, REF, "noise, one SD", is_horizontal=True),
            Rule(-noise, REF, is_horizontal=True),
        )
        marks += pair
    marks.append(Line(x, mean, Pen(curve.pen.colour, 1.4), "residual: mean"))
    # of a fit to several tests the residual has no unit
    of_force = curve.fit.method in get_choice_values(Method)
    rms = curve.fit.estimate.residual.rms if of_force else float(np.sqrt(np.mean(residual**2)))
    unit_name, factor = select_plot_unit(np.array([rms]), "N")
    label = f"residual of {get_model_label(curve.fit)}, {unit}"
    note = f"rms {round_to_error(factor * rms)} {unit_name}"
    horizontal = axis or Scale(
        TIME_LABEL, (_log_start(prepared), _get_hold_end(prepared)), log=True
    )
    vertical = Scale(label, compute_padded_limits(low, high, margin=0.08))
    return Panel(horizontal, vertical, tuple(marks), height=90, note=note)


def _compute_ranges(
    time: FloatArray, values: FloatArray, times: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the lowest and the highest value nearest to each of some times."""
    edges = np.searchsorted(time, np.sqrt(times[1:] * times[:-1]))
    starts = np.concatenate(([int(np.searchsorted(time, 0.0, "right"))], edges))
    return np.minimum.reduceat(values, starts), np.maximum.reduceat(values, starts)


def fitted_force(fit: Fit, prepared: RampHold) -> tuple[FloatArray, FloatArray]:
    """Return time from first contact and the fitted force, N.

    A fit of the hold answers to the ideal ramp of the paper's eq. (5), on the hold only, and its
    drift begins there. Every other answers to the motion behind the recorded displacement, bent by
    the elastic law. Offset, drift and delay are the fitted ones; of a fit to other tests too,
    offset and drift are those that leave least.
    """
    fit = _shift_to_temperature(fit, prepared)
    solid = _select_depth_solid(fit, prepared.depth)
    if fit.method == "hold":
        fitted_samples = prepared.hold
        time, start_time = prepared.time[fitted_samples], prepared.ramp_end
        force = solid.maxwell.ramp_hold_force(
            time - prepared.onset, depth=prepared.depth, ramp_time=prepared.ramp_time
        )
    else:
        fitted_samples = slice(0, prepared.hold.stop)
        time, (x, _) = prepared.time[fitted_samples], denoise_displacement(prepared)
        law, start_time = fit.elastic_law, time[0]
        path = x - x[0] if law is None or law.kind == "linear" else law.path(x - x[0])
        force = solid.force(time, path)
    terms = {
        "offset": np.ones(len(time)),
        "drift": time - start_time,
        "delay": -np.gradient(force, time),
    }
    entries = {term.name: term.value for term in fit.estimate.nuisance if term.name in terms}
    allowed = {term.name.partition(" ")[0] for term in fit.estimate.nuisance} & set(terms)
    if fit.method not in get_choice_values(Method):
        # a fit to other tests too states what it found of those
        entries, allowed = {}, {"offset", "drift"}
    if entries:
        # the chord of a delay: its tangent is off at the corners of a ramp
        force = np.interp(time - entries.pop("delay", 0.0), time, force)
        force = force + sum(value * terms[name] for name, value in entries.items())
    elif allowed:
        # of several tests it is not known which this is
        design = np.column_stack([terms[name] for name in sorted(allowed)])
        size, *_ = np.linalg.lstsq(design, prepared.force[fitted_samples] - force, rcond=None)
        force = force + design @ size
    return time - prepared.onset, force


def _shift_to_temperature(fit: Fit, prepared: RampHold) -> Fit:
    """Return the fit at the temperature of a test, where several were fitted."""
    shifts, kelvin = fit.temperatures, prepared.specimen.temperature
    if shifts is None or kelvin is None:
        return fit
    return fit.at_temperature(shifts.find_nearest(kelvin).temperature)


def _select_depth_solid(fit: Fit, depth: float) -> Solid:
    """Return the solid at this depth, where every test of the fit has stiffnesses of its own."""
    if not fit.evidence.stiffness_by_depth:
        return fit.solid
    nearest_depth = min(fit.evidence.stiffness_by_depth, key=lambda at: abs(at.depth - depth))
    active_arms = [
        (k, tau) for k, tau in zip(nearest_depth.k, fit.model.tau, strict=False) if k > 0
    ]
    k, tau = zip(*active_arms, strict=True) if active_arms else ((), ())
    return GeneralizedMaxwell(max(nearest_depth.k_inf, 0.0), k, tau)


def _get_hold_end(prepared: RampHold) -> float:
    """Return the end of the hold, s after first contact."""
    return prepared.hold_end - prepared.onset


def _shade_ramp(prepared: RampHold, limits: tuple[float, float]) -> list[Span]:
    """Shade the ramp; the hold is what follows it."""
    low, high = max(0.0, limits[0]), min(prepared.ramp_time, limits[1])
    return [Span(low, high, "ref", "ramp")] if high > low else []


def _log_start(prepared: RampHold) -> float:
    """Return where log time begins: a tenth of the ramp, but not between two samples."""
    start = max(0.1 * prepared.ramp_time, 2 * compute_time_step(prepared))
    digit = 10.0 ** np.floor(np.log10(start))
    return float(digit * np.floor(start / digit + 1e-9))


def compute_time_step(prepared: RampHold) -> float:
    """Return the time step on the ramp; sampling may slow down during the hold."""
    near_ramp = (prepared.time >= prepared.onset) & (prepared.time <= prepared.ramp_end)
    return float(
        np.median(np.diff(prepared.time[near_ramp] if near_ramp.sum() > 1 else prepared.time))
    )


# Choice of the figure by the data of the fit.


def bench(bench_fit: Fit, records: Sequence[Any], *, alternatives: Sequence[Fit] = ()) -> Picture:
    """Return the figure that suits the records that a fit was made from.

    Parameters
    ----------
    bench_fit : Fit
    records : sequence
        As fitted; of one kind.
    alternatives : sequence of Fit
        For one ramp and hold: fits of other numbers of arms, drawn with it.
    """
    first = records[0]
    draw, shown_records = find_handler("fit figure", first), first
    if draw is None and bench_fit.temperatures is not None:
        draw = find_handler("fit figure", bench_fit.temperatures)
        shown_records = [record for record in records if isinstance(record, RampHold)]
    if draw is None:
        return fit(bench_fit, first, alternatives=alternatives)
    picture: Picture = draw(bench_fit, shown_records)
    return picture
