"""Figures of amplitude dependence: hysteresis loops, stiffness and loss, FRFs by amplitude."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.number_format import round_to_error
from dashpot.base.provenance import list_sources
from dashpot.base.units import convert_to_unit
from dashpot.datamodel.frf import FRF, Kind
from dashpot.extensions.amplitude.datamodel import (
    AmplitudeFit,
    AmplitudeSweep,
    LoopRecord,
    StressStrainLoops,
)
from dashpot.extensions.amplitude.fit_frfs import compute_level_rows
from dashpot.extensions.amplitude.hits_by_amplitude import HitLevels, predict_interval
from dashpot.extensions.amplitude.level_results import Elements, LevelFit
from dashpot.extensions.amplitude.preprocess import (
    HysteresisLoop,
    compute_sweep,
    find_steady_cycles,
)
from dashpot.extensions.amplitude.response import receptance_at_level
from dashpot.plot.frf_figure import DISPLAY_UNITS
from dashpot.plot.picture import (
    DATA_ON_FIT,
    FIT,
    FIT_BAND,
    PREDICTED,
    REF,
    Area,
    Dots,
    Line,
    Mark,
    Panel,
    Pen,
    Picture,
    Scale,
    Tag,
)
from dashpot.plot.plotted_data import (
    FREQUENCY,
    compute_padded_limits,
    compute_padded_log_limits,
    read_as,
    select_plot_unit,
)
from dashpot.plot.plotted_data import stamp as format_stamp
from dashpot.plot.style import sequential
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.rate_independent import InParallel
from dashpot.vibration.impact.amplitude_trend import MEAN_AMPLITUDE_RATIO

if TYPE_CHECKING:
    from dashpot.extensions.amplitude.fit_files import AmplitudeResult


_HEIGHT = 240.0
_WIDTH = 860.0
_THIN_PEN = Pen("fit", 1.2)
_LINES = 121
_LOOP_HEIGHT, _MULTIPLES = 130.0, 5
"""Height of a loop, px, and how many are shown."""
_BINS = 16
"""Means in a decade of amplitude."""


def level(
    result: AmplitudeFit | LevelFit | HitLevels,
    records: Sequence[AmplitudeSweep | LoopRecord | FRF],
    *,
    stamp: str = "",
) -> Picture:
    """Return the figure that suits the records in which amplitude was varied.

    Parameters
    ----------
    result : AmplitudeFit, LevelFit or HitLevels
    records : sequence of AmplitudeSweep, RelaxationTest, StressStrainLoops or FRF
        As fitted: one sweep, one record of loops, or the FRF of each level.
    stamp : str
        Origin of the data, printed below the figure; by default files, specimen and date.
    """
    if isinstance(result, HitLevels):
        return hits_as_levels(result, stamp=stamp)
    if isinstance(result, LevelFit):
        frfs = [record for record in records if isinstance(record, FRF)]
        return frfs_at_levels(result, frfs, stamp=stamp)
    first = records[0]
    if isinstance(first, AmplitudeSweep):
        return amplitude_sweep(first, result, stamp=stamp)
    assert not isinstance(first, FRF)  # noqa: S101
    return loops(first, result, stamp=stamp)


def draw_levels(levels: AmplitudeResult) -> Picture:
    """Return the figure of a fit over amplitude with its records."""
    return level(levels.fit, levels.records)


def loops(test: LoopRecord, fit: AmplitudeFit | None = None, *, stamp: str = "") -> Picture:
    """Hysteresis loops of several amplitudes, side by side, each over its own amplitude.

    How steep a loop is, is its stiffness, how wide, its loss. With a fit its ellipses beneath them,
    and stiffness and loss over amplitude above.

    Parameters
    ----------
    test : RelaxationTest or StressStrainLoops
        Harmonic cycles at several amplitudes.
    fit : AmplitudeFit, optional
        Fit of those loops.
    stamp : str
        Origin of the data, printed below the figure; by default file, specimen and date.
    """
    shown_loops = _select_distinct_loops(find_steady_cycles(test))
    is_material = isinstance(test, StressStrainLoops)
    amplitudes = np.array([loop.amplitude for loop in shown_loops])
    word, mm = ("%", 100.0) if is_material else select_plot_unit(amplitudes, "m")
    unit, labels = ("MPa", ("ε/A", "σ/A")) if is_material else ("N/mm", ("x/X", "F/X"))
    panels: list[tuple[str, list[Line]]] = []
    for hysteresis_loop in shown_loops:
        curves = (
            [] if fit is None else [(FIT_BAND, "fitted loop", *_make_ellipse(hysteresis_loop, fit))]
        )
        curves.append(
            (DATA_ON_FIT, "measured", hysteresis_loop.displacement, hysteresis_loop.force)
        )
        X = hysteresis_loop.amplitude
        lines = [
            Line(_close_curve(x) / X, convert_to_unit(_close_curve(F) / X, unit), pen, name)
            for pen, name, x, F in curves
        ]
        panels.append((f"{mm * X:.3g} {word}", lines))
    upper_panels = [] if fit is None else _make_amplitude_panels(compute_sweep(test), fit)
    axes = (
        "amplitude A: stress σ over strain ε"
        if is_material
        else "amplitude X: force F over displacement x"
    )
    caption = f"Hysteresis loops, each over its own {axes}" + (
        "." if fit is None else ", and stiffness and loss over amplitude."
    )
    strips = tuple((panel,) for panel in (*upper_panels, *_draw_loop_panels(panels, *labels, unit)))
    rows = tuple(count for count in (len(upper_panels), len(panels)) if count)
    return Picture(
        "loops",
        caption,
        strips,
        2,
        stamp or format_stamp(list_sources([test]), test.specimen),
        width=_WIDTH,
        rows=rows,
    )


def _draw_loop_panels(
    loops: Sequence[tuple[str, Sequence[Line]]], x_label: str, y_label: str, unit: str
) -> Iterator[Panel]:
    """Small multiples on one pair of scales."""
    all_lines = [line for _, lines in loops for line in lines]
    x = Scale(
        f"{x_label}, 1", compute_padded_limits(*(line.x for line in all_lines)), ticks=(-1, 0, 1)
    )
    y = Scale(f"{y_label}, {unit}", compute_padded_limits(*(line.y for line in all_lines)))
    for title, lines in loops:
        yield Panel(x, y, tuple(lines), title=title, height=_LOOP_HEIGHT)


def amplitude_sweep(
    sweep: AmplitudeSweep, fit: AmplitudeFit | None = None, *, stamp: str = ""
) -> Picture:
    """Return storage and loss over amplitude, one colour a frequency, with the law that was fitted.

    Parameters
    ----------
    sweep : AmplitudeSweep
    fit : AmplitudeFit, optional
    stamp : str
        Origin of the data, printed below the figure; by default file, specimen and date.
    """
    strips = tuple((panel,) for panel in _make_amplitude_panels(sweep, fit))
    caption = "Storage and loss over amplitude, measured, and the law fitted to them."
    stamp = stamp or format_stamp(list_sources([sweep]), sweep.specimen)
    return Picture("amplitude", caption, strips, 2, stamp, width=_WIDTH)


def frfs_at_levels(fit: LevelFit, frfs: Sequence[FRF], *, stamp: str = "") -> Picture:
    """The FRF at every level with its fit and the backbone, and stiffness and loss over amplitude.

    Stiffness and loss are those of one seal at the middle of the band: what the arms change from
    there to each line is taken off the measured ones, which are means of near amplitudes with two
    standard errors. Shaded is the 95 % interval.

    Parameters
    ----------
    fit : LevelFit
    frfs : sequence of FRF
        Fitted FRFs.
    stamp : str
        Origin of the data, printed below the figure; by default files, mass and seals.
    """
    text = stamp or format_stamp(fit.source, mass=fit.mass, seals=fit.seals)
    strips = (
        (_make_magnitude_panel(fit, frfs),),
        *((panel,) for panel in _draw_amplitude_panels(fit, frfs)),
    )
    caption = (
        "The FRF at each amplitude with the one model fitted to all and its backbone, and "
        "stiffness and loss of one seal over its amplitude."
    )
    return Picture("levels", caption, strips, 3, text, width=1100.0)


def hits_as_levels(levels: HitLevels, *, stamp: str = "") -> Picture:
    """Return frequency and damping of every hit over the motion that it made, with their lines.

    The 95 % interval of the line is shaded, amplitudes without a hit are dashed.

    Parameters
    ----------
    levels : HitLevels
    stamp : str
        Origin of the data, printed below the figure; by default the files.
    """
    hits = [hit for hit in levels.frf.hits if hit.amplitude]
    X = MEAN_AMPLITUDE_RATIO * np.array([hit.amplitude for hit in hits])
    low, high = levels.amplitudes
    dense = np.geomspace(low / 2, high * 2, 80)
    is_tested = (dense >= low * 0.999) & (dense <= high * 1.001)
    unit_name, mm = select_plot_unit(X, "m")
    x_scale = Scale(
        f"amplitude of motion, {unit_name}",
        compute_padded_log_limits(mm * dense, margin=1.0),
        log=True,
    )
    strips = []
    f, zeta = [hit.frequency for hit in hits], [hit.damping_ratio for hit in hits]
    for name, scale, values, line, power in (
        ("resonance, Hz", 1.0, f, levels.trend.stiffness_line, 0.5),
        ("damping ratio, %", 100.0, zeta, levels.trend.damping_line, 1.0),
    ):
        intervals = np.array([predict_interval(line, float(x)) for x in np.log2(dense)])
        middle, lower, upper = (
            scale * np.exp(power * (intervals[:, 0] + sign * intervals[:, 1]))
            for sign in (0, -1, 1)
        )
        dots = scale * np.array(values, dtype=float)
        marks = (
            Area(mm * dense, lower, upper, "fit", "95 % interval"),
            Line(mm * dense, np.where(is_tested, np.nan, middle), PREDICTED, "extrapolated"),
            Line(mm * dense, np.where(is_tested, middle, np.nan), FIT, "fit"),
            Dots(mm * X, dots, "measured", "measured"),
        )
        limits = compute_padded_limits(dots, lower[is_tested], upper[is_tested], margin=0.3)
        strips.append((Panel(x_scale, Scale(name, limits), marks, height=_HEIGHT),))
    caption = "The resonance of every hit over the motion that it made."
    text = stamp or format_stamp(levels.frf.source)
    return Picture("hits", caption, tuple(strips), 2, text, width=_WIDTH)


def _select_distinct_loops(cycles: Sequence[HysteresisLoop]) -> list[HysteresisLoop]:
    """Return a cycle of each amplitude, the smallest first; at most as many as fit in a row."""
    hysteresis_loops: list[HysteresisLoop] = []
    for cycle in sorted(cycles, key=lambda loop: loop.amplitude):
        if not hysteresis_loops or cycle.amplitude > 1.1 * hysteresis_loops[-1].amplitude:
            hysteresis_loops.append(cycle)
    chosen_indices = (
        np.linspace(0, len(hysteresis_loops) - 1, min(len(hysteresis_loops), _MULTIPLES))
        .round()
        .astype(int)
    )
    return [hysteresis_loops[i] for i in chosen_indices]


def _make_ellipse(loop: HysteresisLoop, fit: AmplitudeFit) -> tuple[FloatArray, FloatArray]:
    """Return the loop of the fitted stiffness, m and N."""
    phasor = np.exp(1j * np.linspace(0, 2 * np.pi, 181))
    tone = int(np.abs(fit.frequency - loop.frequency).argmin())
    K = complex(fit.stiffness(loop.amplitude, tone=tone))
    return loop.amplitude * phasor.real, (K * loop.amplitude * phasor).real


def _close_curve(values: FloatArray) -> FloatArray:
    return np.append(values, values[0])


def _make_amplitude_panels(sweep: AmplitudeSweep, fit: AmplitudeFit | None) -> list[Panel]:
    """Return storage and loss, one colour a frequency; the law dashed where it was not measured."""
    quantity, word, mm = "strain", "%", 100.0
    if sweep.amplitude_unit != "strain":
        quantity, (word, mm) = "displacement", select_plot_unit(sweep.amplitude, "m")
    letter, (unit, scale) = "E" if sweep.unit == "Pa" else "K", read_as(sweep.unit)
    tones, tone = np.unique(sweep.frequency.round(6), return_inverse=True)
    low, high = float(sweep.amplitude.min()), float(sweep.amplitude.max())
    dense = np.geomspace(low / 1.5, high * 1.5, 200)
    x_scale = Scale(
        f"amplitude of {quantity}, {word}",
        compute_padded_log_limits(mm * dense, margin=1.0),
        log=True,
    )
    value, panels = scale * sweep.value, []
    for name, part in ((f"storage {letter}′", np.real), (f"loss {letter}″", np.imag)):
        marks: list[Mark] = []
        for i, colour in enumerate(sequential(len(tones))):
            selected = tone == i
            label = "measured" if len(tones) == 1 else f"{tones[i]:.3g} Hz"
            marks.append(Dots(mm * sweep.amplitude[selected], part(value[selected]), colour, label))
        if fit is not None:
            for i in range(len(fit.frequency)):
                curve = part(scale * fit.stiffness(dense, tone=i))
                is_tested = (dense >= fit.amplitudes[0]) & (dense <= fit.amplitudes[1])
                marks += [
                    Line(mm * dense, np.where(is_tested, np.nan, curve), PREDICTED, "extrapolated"),
                    Line(mm * dense, np.where(is_tested, curve, np.nan), FIT, "fit"),
                ]
        drawn_values = [mark.y for mark in marks if isinstance(mark, Line | Dots)]
        panels.append(
            Panel(
                x_scale,
                Scale(f"{name}, {unit}", compute_padded_limits(*drawn_values)),
                tuple(marks),
                height=_HEIGHT,
            )
        )
    return panels


def _make_magnitude_panel(fit: LevelFit, frfs: Sequence[FRF]) -> Panel:
    """Magnitudes as measured, the fit at each level, and the backbone."""
    kind = frfs[0].quantity
    unit, scale = DISPLAY_UNITS[kind]
    dense = np.linspace(*fit.band, _LINES)
    marks: list[Mark] = []
    fits: list[Mark] = []
    tags: list[Mark] = []
    drawn_values = []
    for i in np.argsort(fit.levels):
        colour = sequential(len(frfs))[int(np.searchsorted(np.sort(fit.levels), fit.levels[i]))]
        lines = frfs[i].to(kind, mass=fit.mass).band(*fit.band)
        over_base = frfs[i].quantity.over_base
        force = fit.levels[i] * (fit.mass if over_base else 1.0)
        text = f"{fit.levels[i]:.3g} {'m/s²' if over_base else 'N'}"
        size = scale * np.abs(lines.value)
        curve = receptance_at_level(fit, force, dense).to(kind, mass=fit.mass)
        y = scale * np.abs(curve.value)
        peak_index = int(np.argmax(y))
        peak = (
            f"{text}: {round_to_error(float(dense[peak_index]), digits=4)} Hz, "
            f"{round_to_error(float(y[peak_index]))} {unit}"
        )
        marks.append(Dots(lines.frequency, size, colour, "" if fits else "measured"))
        tags.append(Tag(float(dense[peak_index]), float(y[peak_index]), peak, colour))
        fits.append(Line(dense, y, _THIN_PEN, "" if fits else "fit"))
        drawn_values += [size, y]
    limits = compute_padded_log_limits(*drawn_values)
    f, height = _compute_backbone(fit, kind)
    in_band = (f >= fit.band[0]) & (f <= fit.band[1])
    spine = Line(np.where(in_band, f, np.nan), scale * height, REF, "backbone")
    label = f"{kind.value.replace('_', ' ')}, {unit}"
    return Panel(
        Scale(FREQUENCY, fit.band), Scale(label, limits, log=True), (spine, *fits, *marks, *tags),
        title="at each amplitude", height=_HEIGHT,
    )  # fmt: skip


def _compute_backbone(fit: LevelFit, kind: Kind) -> tuple[FloatArray, FloatArray]:
    r"""Return where the motion is a quarter turn behind the force, Hz, and how large it is there.

    .. math:: m\omega^2 = n K'(\omega, X), \qquad H = \frac{1}{j n K''(\omega, X)}
    """
    X = np.geomspace(*fit.amplitudes, 60)
    omega = np.full(len(X), 2 * np.pi * float(np.mean(fit.band)))
    for _ in range(50):
        omega = np.sqrt(fit.seals * fit.stiffness(omega=omega, amplitude=X).real / fit.mass)
    loss = fit.seals * fit.stiffness(omega=omega, amplitude=X).imag
    with np.errstate(divide="ignore"):
        receptance = 1 / loss
    f = omega / (2 * np.pi)
    if kind is Kind.TRANSMISSIBILITY:
        return f, np.hypot(1.0, fit.mass * omega**2 * receptance)
    if kind is Kind.DYNAMIC_STIFFNESS:
        return f, loss
    if kind is Kind.RELATIVE_TRANSMISSIBILITY:
        return f, fit.mass * omega**2 * receptance
    power = {Kind.RECEPTANCE: 0, Kind.MOBILITY: 1, Kind.ACCELERANCE: 2}[kind]
    return f, receptance * omega**power


def _draw_amplitude_panels(fit: LevelFit, frfs: Sequence[FRF]) -> list[Panel]:
    """Return storage and loss of one seal over its amplitude, at the middle of the band."""
    middle = np.pi * (fit.band[0] + fit.band[1])
    rows = [
        compute_level_rows(frf, level, fit.mass, fit.seals, fit.band)
        for frf, level in zip(frfs, fit.levels, strict=True)
    ]
    omega, X, K, weight = (np.concatenate(group) for group in zip(*rows, strict=True))
    solid = fit.solid.complex_stiffness(omega=np.append(omega, middle))
    amplitudes, mean, error = _average_neighbours(
        X, K - solid[:-1] + solid[-1], weight / fit.residual
    )
    dense = np.geomspace(*fit.amplitudes, 60)
    curve = fit.stiffness(omega=middle, amplitude=dense)
    unit_name, mm = select_plot_unit(X, "m")
    x_scale = Scale(
        f"amplitude of displacement, {unit_name}",
        compute_padded_log_limits(mm * dense, margin=1.1),
        log=True,
    )
    panels = []
    interval = _compute_interval(fit, middle, dense)
    for i, (name, part) in enumerate((("storage K′", np.real), ("loss K″", np.imag))):
        low, high = convert_to_unit(interval[:, i], "N/mm")
        y = convert_to_unit(part(curve), "N/mm")
        marks = (
            Area(mm * dense, low, high, "fit", "95 % interval"),
            Line(mm * dense, y, FIT, "fit"),
            Dots(
                mm * amplitudes,
                convert_to_unit(part(mean), "N/mm"),
                "measured",
                "measured",
                error=convert_to_unit(2 * error, "N/mm"),
            ),
        )
        pad = max(float(np.ptp(y)), 0.1 * float(np.abs(y).max()))
        limits = compute_padded_limits(y - 0.3 * pad, y + 0.3 * pad, low, high)
        title = f"one seal at {middle / 2 / np.pi:.3g} Hz"
        panels.append(
            Panel(x_scale, Scale(f"{name}, N/mm", limits), marks, title=title, height=_HEIGHT)
        )
    return panels


def _compute_interval(fit: LevelFit, omega: float, X: FloatArray) -> FloatArray:
    """95 % interval of storage and loss over amplitude, N/m, shape (2, 2, n)."""

    def compute_stiffness_parts(solid: GeneralizedMaxwell, elements: Elements) -> FloatArray:
        K = InParallel((solid, *elements)).equivalent(omega, X)
        return np.array((K.real, K.imag))

    return fit.interval(compute_stiffness_parts)


def _average_neighbours(
    X: FloatArray, K: FloatArray, weight: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return means over near amplitudes, weighted, and their standard errors (of each part)."""
    bins = np.floor(_BINS * np.log10(X / X.min())).astype(int)
    bin_index = np.unique(bins, return_inverse=True)[1]
    w = weight**2
    total = np.bincount(bin_index, w)

    def mean(values: FloatArray) -> FloatArray:
        return np.bincount(bin_index, w * values) / total

    return mean(X), mean(K.real) + 1j * mean(K.imag), np.sqrt(1 / total / 2)
