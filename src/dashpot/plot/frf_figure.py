"""Figures of FRFs: measured, predicted, and both compared."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.number_format import format_band, round_to_error
from dashpot.base.units import convert_to_unit
from dashpot.datamodel.bounds import FRFBounds
from dashpot.datamodel.frf import FRF, Kind
from dashpot.plot.picture import (
    JOINT,
    MEASURED,
    PREDICTED,
    REF,
    REJECTED,
    SIMPLER,
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
    Tag,
    joint_pen,
)
from dashpot.plot.plotted_data import FREQUENCY, compute_padded_limits, format_frf_stamp
from dashpot.plot.style import sequential
from dashpot.vibration.comparison.comparison_result import Comparison
from dashpot.vibration.modal.peaks import find_peak

# FRF lines to be drawn: phase and interpolation.


def wrap_phase(value: ComplexArray, lowest: float) -> FloatArray:
    """Phase in degrees within one turn from `lowest`."""
    return np.asarray((np.degrees(np.angle(value)) - lowest) % 360 + lowest)


def break_wrapped_phase(
    frequency: FloatArray, value: ComplexArray, lowest: float
) -> tuple[FloatArray, FloatArray]:
    """Phase in degrees from `lowest` up to a full turn more, broken by nan where it wraps."""
    degrees = wrap_phase(value, lowest)
    breaks = np.flatnonzero(np.abs(np.diff(degrees)) > 180) + 1
    return np.insert(frequency, breaks, np.nan), np.insert(degrees, breaks, np.nan)


def phase_axis(values: ComplexArray) -> tuple[float, tuple[float, ...]]:
    """Return where the turn begins for all `values`, degrees, and the quarters that they use.

    From -180 as usual. Where that would cut through the data, from -90, as for the noise of an
    accelerance below its resonance, or from -270, as for a transmissibility above its own.
    """

    def cuts(lowest: float) -> int:
        return int(np.count_nonzero(np.abs(np.diff(wrap_phase(values, lowest))) > 180))

    often = bool(np.mean(np.abs(wrap_phase(values, -180.0)) > 165) > 0.02)
    lowest = min((-90.0, -270.0), key=cuts) if often else -180.0
    degrees = wrap_phase(values, lowest)
    first = 90 * np.floor((np.percentile(degrees, 1) + 20) / 90)
    last = 90 * np.ceil((np.percentile(degrees, 99) - 20) / 90)
    return lowest, tuple(np.arange(first, max(last, first + 90) + 1, 90).tolist())


_CLOSE_LINES = 1e-4
"""Lines nearer than this part of their frequency are joined straight."""


def smooth(frf: FRF) -> tuple[FloatArray, ComplexArray]:
    """Return a predicted FRF on denser lines, densest near its peak; a measured one as it is.

    A sharp resonance between two lines is drawn round: not the FRF but its inverse is joined by
    straight lines, which is smooth where the FRF peaks (it is the dynamic mass m + K/s^2). Both
    sides of a jump stand too near for anything between.
    """
    dense_already = len(frf.frequency) > 2000 or len(frf.frequency) < 2
    if frf.averages > 0 or dense_already or bool((frf.value == 0).any()):
        return frf.frequency, frf.value
    magnitude = np.abs(frf.value)
    parts = np.where(np.maximum(magnitude[:-1], magnitude[1:]) > 0.2 * magnitude.max(), 24, 2)
    parts = np.where(np.diff(frf.frequency) < _CLOSE_LINES * frf.frequency[1:], 1, parts)
    start = np.repeat(np.arange(len(parts)), parts)
    part_index = np.arange(len(start)) - np.repeat(np.cumsum(parts) - parts, parts)
    positions = np.append(start + part_index / np.repeat(parts, parts), len(parts))
    lines = np.arange(len(magnitude))
    inverse = 1 / frf.value
    real, imag = (np.interp(positions, lines, part) for part in (inverse.real, inverse.imag))
    return np.interp(positions, lines, frf.frequency), np.asarray(1 / (real + 1j * imag))


def half_power(value: ComplexArray) -> list[int]:
    """Return the lines nearest to the half-power points on either side of the largest magnitude."""
    magnitude = np.abs(value)
    peak = int(np.argmax(magnitude))
    target = magnitude[peak] / np.sqrt(2)
    indices = []
    for side_indices in (np.arange(peak, -1, -1), np.arange(peak, len(magnitude))):
        indices_below = np.flatnonzero(magnitude[side_indices] < target)
        if indices_below.size:
            pair = side_indices[
                max(indices_below[0] - 1, 1) : indices_below[0] + 1
            ]  # never the peak itself
            indices.append(int(pair[np.argmin(np.abs(magnitude[pair] - target))]))
    return sorted(indices)


PENS = (MEASURED, PREDICTED, JOINT, *SIMPLER)

# display unit, and its factor from SI
DISPLAY_UNITS = {
    Kind.RECEPTANCE: ("mm/N", convert_to_unit(1.0, "mm/N")),
    Kind.MOBILITY: ("(mm/s)/N", convert_to_unit(1.0, "mm/s")),
    Kind.ACCELERANCE: ("1/kg", 1.0),
    Kind.DYNAMIC_STIFFNESS: ("N/mm", convert_to_unit(1.0, "N/mm")),
    Kind.TRANSMISSIBILITY: ("m/m", 1.0),
    Kind.RELATIVE_TRANSMISSIBILITY: ("m/m", 1.0),
}
INTERVAL, BOUND = "95 % interval of the parameters", "95 % bounds over all spectra"

# Largest distance of the upper end of a magnitude axis from the median of the lines.
MAX_MAGNITUDE_RATIO = 1e4

# Line width of a joint model, px: visible on both sides of the measured line.
JOINT_LINE_WIDTH = 7.0

# Frequency range of a peak, as factors of its frequency.
VIEW_FACTORS = (0.48, 2.3)


@dataclass(frozen=True, eq=False)
class Curve:
    """FRF to be drawn, with frequency and height of its peak where that is labelled."""

    frf: FRF
    label: str
    pen: Pen
    peak: tuple[float, float] | None = None


@dataclass(frozen=True, eq=False)
class PredictionBand:
    """Limits of a predicted magnitude, shape (2, n): accelerance, 1/kg, or T."""

    frequency: FloatArray
    limits: FloatArray
    label: str = INTERVAL
    pen: Pen | None = None
    """Pen of the curve; by default the predicted one."""

    def convert_to_kind(self, kind: Kind) -> FloatArray:
        """Return the limits for another kind of FRF; those over a moving base are their own."""
        omega = 2 * np.pi * self.frequency
        if kind is Kind.ACCELERANCE or kind.over_base:
            return self.limits
        with np.errstate(divide="ignore"):
            if kind is Kind.DYNAMIC_STIFFNESS:
                return np.asarray(omega**2 / self.limits[::-1])
        return self.limits / (omega if kind is Kind.MOBILITY else omega**2)


def make_prediction_bands(bounds: FRFBounds | None) -> tuple[PredictionBand, ...]:
    """Return the bands of a prediction, the wider first."""
    if bounds is None:
        return ()
    return (
        PredictionBand(bounds.frequency, bounds.unmeasured, BOUND),
        PredictionBand(bounds.frequency, bounds.parameter, INTERVAL),
    )


def frf(
    measured: FRF,
    *other_frfs: FRF,
    labels: Sequence[str] = (),
    band: FRFBounds | None = None,
    interval: tuple[FloatArray, FloatArray] | None = None,
    valid_band: tuple[float, float] | None = None,
    ordered: bool = False,
    intervals: Sequence[FloatArray | None] = (),
    stamp: str = "",
) -> Picture:
    """One or several FRFs of one kind: magnitude, phase, and the coherence of the first.

    The peak of the first one is labelled, unless it lies at the end of the axis.

    Parameters
    ----------
    measured : FRF
        Sets the kind and the range of frequencies. One that no hits were averaged to is taken
        for a prediction.
    *other_frfs : FRF
        Drawn over it, converted to its kind.
    labels : sequence of str
        One per FRF.
    band : FRFBounds, optional
        Between which limits a relaxation test predicts.
    interval : (array, array), optional
        Lines, Hz, and limits by standard errors alone, where no band is known: of the accelerance,
        1/kg, or of a transmissibility where that is drawn.
    valid_band : (float, float), optional
        The frequencies that the test behind a prediction informs, Hz: shaded, or said where none
        of them is in sight.
    ordered : bool
        The others rise, in level or temperature: from blue to red.
    intervals : sequence of array, shape (2, n), or None
        Such limits of each of the others, at its lines.
    stamp : str
        Origin of the data, printed below the figure; by default the files of the first FRF.
    """
    same_kind = [measured, *(other.to(measured.quantity) for other in other_frfs)]
    names = [*labels, *[""] * (len(same_kind) - len(labels))]
    pens = _pens(measured, len(other_frfs), ordered=ordered)
    curves = [
        Curve(frf, name, pens[i % len(pens)])
        for i, (frf, name) in enumerate(zip(same_kind, names, strict=True))
    ]
    curves[0] = replace(curves[0], peak=_peak_inside(measured))
    value = () if interval is None else (PredictionBand(*interval),)
    leveled = tuple(
        PredictionBand(curve.frf.frequency, limits, "", curve.pen)
        for curve, limits in zip(curves[1:], intervals, strict=False)
        if limits is not None
    )
    caption = "Frequency response function: magnitude and phase."
    upper, *others_below = _bode(curves, (*(make_prediction_bands(band) or value), *leveled))
    if valid_band is not None:
        upper = _shade_valid_band(upper, valid_band)
    strip = (upper, *others_below)
    return Picture("frf", caption, (strip,), 1, stamp or format_frf_stamp(measured))


def _peak_inside(frf: FRF) -> tuple[float, float] | None:
    """Return frequency and height of the peak of an accelerance; None where an end is as high."""
    if frf.quantity is not Kind.ACCELERANCE:
        return None
    peak_index = int(np.argmax(np.abs(frf.value)))
    if not 0 < peak_index < len(frf.frequency) - 1:
        return None
    return _peak_of(frf)


def _shade_valid_band(panel: Panel, band: tuple[float, float]) -> Panel:
    """The part of the axis that a test informs, shaded; if none is visible, a text says so."""
    low, high = panel.x.limits
    if not band[0] < band[1] or band[1] < low or band[0] > high:
        text = f"valid {format_band(band)}: all of this is extrapolated"
        return replace(panel, note=text)
    shade = Span(max(band[0], low), min(band[1], high), "fit", "valid band", tint=0.07)
    return replace(panel, marks=(shade, *panel.marks))


def comparison(
    comparison: Comparison,
    *,
    joint: Comparison | None = None,
    failed: bool = False,
    band: FRFBounds | None = None,
    interval: tuple[FloatArray, FloatArray] | None = None,
    stamp: str = "",
) -> Picture:
    """Predicted against measured accelerance, peaks named, coherence beneath (paper Fig. 6).

    Parameters
    ----------
    comparison : Comparison
        Prediction from the relaxation test against the measured FRF.
    joint : Comparison, optional
        The joint fit against the same FRF: what changes once the hammer is believed.
    failed : bool
        The joint fit is not to be used, even if it follows the FRF.
    band, interval : optional
        As in :func:`frf`.
    stamp : str
        Origin of the data, printed below the figure; by default the files of the measured FRF.
    """
    value = () if interval is None else (PredictionBand(*interval),)
    strip = _bode(curves_of(comparison, joint, failed=failed), make_prediction_bands(band) or value)
    caption = (
        "Accelerance of the mass on its seals, measured and predicted, with phase and coherence."
    )
    return Picture(
        "comparison", caption, (strip,), 1, stamp or format_frf_stamp(comparison.measured)
    )


def resonance(
    comparison: Comparison | None,
    predicted: FRF,
    *,
    joint: Comparison | None = None,
    failed: bool = False,
    band: FRFBounds | None = None,
    rival: FRF | None = None,
    height: float = 292.0,
    stamp: str = "",
) -> Picture:
    """Return the peak alone: measured, predicted with its bound, joint; every peak in sight.

    Parameters
    ----------
    comparison : Comparison or None
        None without a measurement.
    predicted : FRF
        Over as wide a range as is at hand: its peak may lie beyond the measured lines.
    joint, failed, band, stamp : optional
        As in :func:`comparison`.
    rival : FRF, optional
        By another family of solids, which explains the relaxation test as well.
    height : float
        Height of the plotted part, px.
    """
    curves = resonance_curves(comparison, predicted, joint=joint, failed=failed, alternative=rival)
    view = about_peaks(curves)
    panel = magnitude_panel(
        curves, make_prediction_bands(band)[:1], view=view, height=height, tagged=True
    )
    caption = "Accelerance of the mass on its seals: measured, and as the models predict it."
    return Picture("resonance", caption, ((panel,),), 1, stamp)


def nyquist(
    measured: FRF,
    *other_frfs: FRF,
    labels: Sequence[str] = (),
    failed: bool = False,
    stamp: str = "",
) -> Picture:
    """Imaginary against real part on equal axes, half-power points of each ringed.

    Parameters
    ----------
    measured, *other_frfs : FRF
    labels : sequence of str
        One per FRF.
    failed : bool
        The last of three is of a joint fit that is not to be used.
    stamp : str
        Origin of the data, printed below the figure; by default the files of the first FRF.
    """
    pens = (*PENS[:2], joint_pen(failed=failed)[0], *PENS[3:])
    unit, scale = DISPLAY_UNITS[measured.quantity]
    same_kind = [measured, *(other.to(measured.quantity) for other in other_frfs)]
    marks: list[Mark] = []
    ranges = []
    # the first one, which was measured, over all others
    for frf, pen, name in reversed(list(zip(same_kind, pens, [*labels, *[""] * 5], strict=False))):
        f, value = smooth(frf)
        value = scale * value
        points = half_power(value)
        at = " and ".join(f"{f[i]:.2f}" for i in points)
        label = f"{name} (○ {at} Hz)" if name and at else name
        ranges.append(value)
        if frf.averages > 0:
            marks.append(Dots(value.real, value.imag, pen.colour, label, size=3))
        else:
            marks.append(Line(value.real, value.imag, pen, label))
        marks.append(Dots(value[points].real, value[points].imag, pen.colour, size=8, hollow=True))
    values = np.concatenate(ranges)
    kind = measured.quantity.label
    panel = Panel(
        Scale(f"real part of {kind}, {unit}", compute_padded_limits(values.real, margin=0.08)),
        Scale(f"imaginary part of {kind}, {unit}", compute_padded_limits(values.imag, margin=0.08)),
        (Rule(0.0, REF, is_horizontal=True), Rule(0.0, REF), *marks),
        height=300,
        square=True,
    )
    caption = "Nyquist plot: imaginary against real part; rings are the half-power points."
    return Picture(
        "nyquist", caption, ((panel,),), 1, stamp or format_frf_stamp(measured), width=420.0
    )


# -- panels ---------------------------------------------------------------------------------------


def resonance_curves(
    comparison: Comparison | None,
    predicted: FRF,
    *,
    joint: Comparison | None = None,
    failed: bool = False,
    alternative: FRF | None = None,
) -> list[Curve]:
    """Return the curves of :func:`resonance`, each with its peak."""
    if comparison is None:
        curves = [Curve(predicted, "predicted", PREDICTED, _peak_of(predicted))]
    else:
        curves = curves_of(comparison, joint, failed=failed)
        frequency_range = comparison.measured.frequency[0], comparison.measured.frequency[-1]
        at, top = _peak_of(predicted)
        if not frequency_range[0] < at < frequency_range[1]:
            curves[1] = replace(curves[1], frf=predicted, peak=(at, top))
    if alternative is not None:
        curves.append(
            Curve(alternative, "other family from relaxation", SIMPLER[0], _peak_of(alternative))
        )
    return curves


def about_peaks(curves: Sequence[Curve]) -> tuple[float, float]:
    """Return the frequency range about every peak, Hz, as far as there are lines."""
    peaks = [curve.peak[0] for curve in curves if curve.peak is not None]
    first = min(curve.frf.frequency[curve.frf.frequency > 0][0] for curve in curves)
    last = max(curve.frf.frequency[-1] for curve in curves)
    return (max(VIEW_FACTORS[0] * min(peaks), first), min(VIEW_FACTORS[1] * max(peaks), last))


def curves_of(
    comparison: Comparison, joint: Comparison | None, *, failed: bool = False
) -> list[Curve]:
    """Return the curves of a comparison with their peaks, measured first."""
    c = comparison
    curves = [
        Curve(c.measured, "measured", MEASURED, (c.measured_hz, c.measured_peak)),
        Curve(c.predicted, c.legend, PREDICTED,
              (c.predicted_hz, c.predicted_peak)),
    ]  # fmt: skip
    if joint is not None:
        # a joint model that misses one test does not look like an answer
        pen, name = joint_pen(failed=failed or joint.verdict.use == "do not use")
        curves.append(Curve(joint.predicted, name, pen, (joint.predicted_hz, joint.predicted_peak)))
    return curves


def _pens(first: FRF, other_count: int, *, ordered: bool) -> tuple[Pen, ...]:
    """Return the pens of a measurement or a prediction, and of the other curves."""
    pens = PENS if first.averages else (PREDICTED, *PENS[2:], MEASURED)
    return (pens[0], *(Pen(colour, 2.0) for colour in sequential(other_count))) if ordered else pens


def magnitude_panel(
    curves: Sequence[Curve],
    prediction_bands: Sequence[PredictionBand] = (),
    *,
    view: tuple[float, float] | None = None,
    height: float = 240.0,
    tagged: bool = False,
) -> Panel:
    """Magnitudes of FRFs of one kind, log-log, with what the prediction leaves open."""
    kind = curves[0].frf.quantity
    unit, scale = DISPLAY_UNITS[kind]
    f = curves[0].frf.frequency
    view = view or (max(float(f[0]), 1e-3 * float(f[-1])), float(f[-1]))
    smoothed = {id(curve): smooth(curve.frf) for curve in curves}
    predicted = next((curve for curve in curves if curve.pen is PREDICTED), None)
    sizes = [
        scale * np.abs(value[(at >= view[0]) & (at <= view[1])]) for at, value in smoothed.values()
    ]
    all_sizes = np.concatenate(sizes)
    # neither a few vanishing lines nor a resonance without damping can stretch the axis
    highest = min(float(all_sizes.max()), MAX_MAGNITUDE_RATIO * float(np.median(all_sizes)))
    limits = [
        0.6 * max(float(np.percentile(all_sizes, 1)), highest / MAX_MAGNITUDE_RATIO),
        1.9 * highest,
    ]
    marks: list[Mark] = []
    for limit in prediction_bands:
        own_curve = next((curve for curve in curves if curve.pen is limit.pen), predicted)
        area = _area(limit, kind, scale, None if own_curve is None else smoothed[id(own_curve)])
        in_view = (area.x >= view[0]) & (area.x <= view[1])
        top = float(np.max(area.high[in_view], initial=0.0))
        limits[1] = max(limits[1], min(1.3 * top, 12 * limits[1]))
        # a resonance without damping has no highest magnitude
        marks.append(replace(area, low=np.maximum(area.low, 0.1 * limits[0]),
                             high=np.minimum(area.high, 10 * limits[1])))  # fmt: skip
    for item in curves:
        if item.frf.sd is not None:
            marks.append(_scatter(item, scale))
    for item in _sort_by_layer(curves):
        at, value = smoothed[id(item)]
        pen = replace(item.pen, width=JOINT_LINE_WIDTH) if item.pen is JOINT else item.pen
        marks.append(Line(at, scale * np.abs(value), pen, item.label))
    if tagged:
        marks += [replace(peak, y=min(peak.y, limits[1])) for peak in _peaks(curves, unit)]
    label = f"{kind.value.replace('_', ' ')}, {unit}"
    axes = (Scale(FREQUENCY, view, log=True), Scale(label, (limits[0], limits[1]), log=True))
    return Panel(*axes, tuple(marks), height=height)


def phase_panel(curves: Sequence[Curve], view: tuple[float, float]) -> Panel:
    """Phases of FRFs, on the part of the circle that they use."""
    lowest, ticks = phase_axis(np.concatenate([curve.frf.value for curve in curves]))
    marks: list[Mark] = []
    for item in _sort_by_layer(curves):
        f, value = smooth(item.frf)
        x, y = break_wrapped_phase(f, value, lowest)
        marks.append(Line(x, y, item.pen, item.label))
    axes = (Scale(FREQUENCY, view, log=True),
            Scale("phase, °", (ticks[0] - 15, ticks[-1] + 15), ticks=ticks))  # fmt: skip
    return Panel(*axes, tuple(marks), height=90)


def _sort_by_layer(curves: Sequence[Curve]) -> list[Curve]:
    """Return the curves in the order of drawing: broad ones, failed ones, measured ones last."""
    layers = {JOINT: 0, REJECTED: 2, MEASURED: 3}
    return sorted(curves, key=lambda curve: layers.get(curve.pen, 1))


def _bode(curves: Sequence[Curve], prediction_bands: Sequence[PredictionBand]) -> tuple[Panel, ...]:
    upper = magnitude_panel(curves, prediction_bands, tagged=True)
    if len(curves) == 1:
        upper = replace(upper, marks=(*upper.marks, *_half_power(curves[0])))
    strip = [upper, phase_panel(curves, upper.x.limits)]
    return (*strip, *coherence_panels(curves[0].frf, upper.x))


def coherence_panels(measured: FRF, frequency: Scale) -> tuple[Panel, ...]:
    """Return the coherence of a measured FRF over the same axis; empty without coherence."""
    if measured.coherence is None:
        return ()
    axes = (frequency, Scale("coherence, 1", (0.0, 1.08), ticks=(0.0, 0.5, 1.0)))
    # 0.9 is what ISO 7626-5 asks for
    marks = (Rule(0.9, REF, is_horizontal=True),
             Line(measured.frequency, measured.coherence, MEASURED))  # fmt: skip
    return (Panel(*axes, marks, height=50),)


def _area(
    band: PredictionBand, kind: Kind, scale: float, curve: tuple[FloatArray, ComplexArray] | None
) -> Area:
    """The area between limits; on the lines of its own curve too, and never narrower than that."""
    f, (low, high) = band.frequency, scale * band.convert_to_kind(kind)
    if curve is not None:
        at, value = curve
        in_range = (at >= f[0]) & (at <= f[-1])
        lines = np.union1d(f, at[in_range])
        with np.errstate(divide="ignore"):
            logs = [np.interp(lines, f, np.nan_to_num(np.log(edge), posinf=700, neginf=-700))
                    for edge in (low, high)]  # fmt: skip
        indices = scale * np.abs(np.interp(lines, at, np.abs(value)))
        indices = np.where((lines >= at[0]) & (lines <= at[-1]), indices, np.nan)
        low, high = np.fmin(np.exp(logs[0]), indices), np.fmax(np.exp(logs[1]), indices)
        f = lines
    colour = "fit" if band.pen is None else band.pen.colour
    return Area(f, low, high, colour, band.label, hatched=band.label == BOUND, tint=0.3)


def _scatter(curve: Curve, scale: float) -> Area:
    """Two standard deviations on either side of the magnitude."""
    assert curve.frf.sd is not None  # noqa: S101
    size, sd = scale * np.abs(curve.frf.value), scale * curve.frf.sd
    # a magnitude has no negative side: the area is cut well below the curve
    low = np.maximum(size - 2 * sd, 0.02 * size)
    return Area(curve.frf.frequency, low, size + 2 * sd, curve.pen.colour, tint=0.18)


def _peaks(curves: Sequence[Curve], unit: str) -> list[Tag]:
    """The peaks with frequency and height: measured filled, predicted hollow, joint by its name.

    A joint fit that failed has none: its key says so.
    """
    inks = {"joint": "joint-ink", "ref": "soft"}
    dots: dict[Pen, Literal["filled", "hollow"]] = {MEASURED: "filled", PREDICTED: "hollow"}
    tags = []
    for item in sorted(curves, key=lambda curve: curve.pen is not MEASURED):
        if item.peak is None or item.pen is REJECTED:
            continue
        hz, height = item.peak
        text = (
            f"{item.label.partition(' from')[0]} {round_to_error(hz, digits=4)} Hz, "
            f"{round_to_error(height)}"
        )
        ink_colour = inks.get(item.pen.colour, item.pen.colour)
        tags.append(
            Tag(hz, height, f"{text} {unit}", ink_colour, dots.get(item.pen, ""),
                bold=item.pen is MEASURED)
        )  # fmt: skip
    return tags


def _half_power(curve: Curve) -> list[Mark]:
    """Return the width of a measured peak at -3 dB as a line."""
    if (
        curve.pen is not MEASURED
        or curve.peak is None
        or curve.frf.quantity is not Kind.ACCELERANCE
    ):
        return []
    peak = find_peak(curve.frf)
    width, height = 2 * peak.damping_ratio * peak.frequency, peak.height / math.sqrt(2)
    half_power_ends = peak.frequency + np.array([-0.5, 0.5]) * width
    # its damping is the mode's, which is fitted to all lines
    text = f"{round_to_error(width, digits=2)} Hz wide at −3 dB"
    return [Line(half_power_ends, np.full(2, height), Pen("fit", 2.0)),
            Tag(float(half_power_ends[1]), height, text, "fit")]  # fmt: skip


def _peak_of(frf: FRF) -> tuple[float, float]:
    peak = find_peak(frf)
    return peak.frequency, peak.height
