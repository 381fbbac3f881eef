"""Figure of a master curve: the shifted data, their shift factors and law."""

from __future__ import annotations

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.units import convert_to_unit
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.shift_factors import TemperatureShifts
from dashpot.extensions.curves.datamodel.creep import CreepCompliance
from dashpot.extensions.curves.datamodel.dynamic import DynamicTest
from dashpot.extensions.curves.datamodel.modulus import RelaxationModulus
from dashpot.extensions.curves.datamodel.superposition import Superposition
from dashpot.extensions.curves.time_curve_figure import TIME
from dashpot.plot.picture import (
    FIT,
    REF,
    Area,
    Dots,
    Line,
    Mark,
    Panel,
    Pen,
    Picture,
    Rule,
    Scale,
    Tag,
)
from dashpot.plot.plotted_data import (
    FREQUENCY,
    compute_padded_limits,
    compute_padded_log_limits,
    format_fit_stamp,
    read_as,
)
from dashpot.plot.plotted_data import stamp as format_stamp
from dashpot.plot.style import SEQUENTIAL, sequential
from dashpot.solids.maxwell import Solid

_DOT = 4.5
_THIN_PEN = Pen("measured", 1.3)
"""The fit is drawn below the samples, whose colours show the temperature."""


def draw_fit(fit: Fit, data: Superposition) -> Picture:
    """Return the figure of a fit to a master curve."""
    return superposition(data, fit)


def superposition(data: Superposition, fit: Fit | None = None, *, stamp: str = "") -> Picture:
    """A master curve, coloured from cold to warm, its shifts and their law, and van Gurp-Palmen.

    The last, the loss angle against the size of the modulus, knows no time: temperatures that do
    not lie on one line there are not shifted onto one either.

    Parameters
    ----------
    data : Superposition
    fit : Fit, optional
        Drawn as a line; by default the spectrum that all temperatures share.
    stamp : str
        Origin of the data, printed below the figure; by default files, specimen and date.
    """
    if isinstance(data.curve, DynamicTest):
        panels = _make_sweep_panels(data, data.curve, fit)
    else:
        panels = _make_curve_panels(data, data.curve, fit)
    shifted = shift_panel(data.temperatures)
    caption = (
        "Master curve: every sample where it lies at the reference, from cold to warm, the "
        "spectrum that all share, and the shift factors with their law and two standard errors."
    )
    text = stamp or (
        format_stamp(data.sources, data.curve.specimen) if fit is None else format_fit_stamp(fit)
    )
    strips = tuple((panel,) for panel in (*panels, shifted))
    return Picture("superposition", caption, strips, 2, text, width=860.0)


def _make_sweep_panels(
    data: Superposition, curve: DynamicTest, fit: Fit | None
) -> tuple[Panel, ...]:
    unit_name, scale = read_as(curve.unit)
    solid, text = _make_line(data, fit)
    f = np.geomspace(float(curve.frequency.min()), float(curve.frequency.max()), 400)
    value = scale * solid.complex_stiffness(omega=2 * np.pi * f)
    measured = scale * curve.value
    letter = "E" if curve.unit == "Pa" else "K"
    horizontal = Scale(f"reduced {FREQUENCY}", (float(f[0]), float(f[-1])), log=True)
    panels: list[Panel] = []
    for name, row, line in (
        (f"storage {letter}′", measured.real, value.real),
        (f"loss {letter}″", np.where(measured.imag > 0, measured.imag, np.nan), value.imag),
    ):
        dots = _make_dots(data, curve.frequency, row)
        temperature_tags = _make_temperature_tags(dots) if not panels else ()
        panels.append(
            Panel(horizontal, Scale(f"{name}, {unit_name}", compute_padded_log_limits(row, line),
            log=True),
                  (Line(f, line, _THIN_PEN, text), *dots, *temperature_tags), height=220)
        )  # fmt: skip
    magnitude, angle = np.abs(measured), np.degrees(np.angle(measured))
    palmen = Panel(
        Scale(f"size of the modulus, {unit_name}", compute_padded_log_limits(magnitude), log=True),
        Scale("loss angle, °", compute_padded_limits(angle)),
        (Line(np.abs(value), np.degrees(np.angle(value)), _THIN_PEN), *_make_dots(data, magnitude,
        angle)),
        title="van Gurp-Palmen", height=220,
    )  # fmt: skip
    return (*panels, palmen)


def _make_curve_panels(
    data: Superposition, curve: RelaxationModulus | CreepCompliance, fit: Fit | None
) -> tuple[Panel, ...]:
    """Return panels of a relaxation modulus, or a creep compliance, and its residual."""
    solid, text = _make_line(data, fit)
    if isinstance(curve, CreepCompliance):
        name, response, value = "creep compliance", solid.maxwell.creep, curve.compliance
    else:
        name, response, value = "relaxation modulus", solid.relaxation, curve.modulus
    unit, scale = read_as(curve.unit)
    t = np.geomspace(float(curve.time[0]), float(curve.time[-1]), 400)
    line, measured = scale * response(t), scale * value
    residual = 100 * (value / response(curve.time) - 1)
    horizontal = Scale(f"reduced {TIME}", (float(t[0]), float(t[-1])), log=True)
    dots = _make_dots(data, curve.time, measured)
    upper = Panel(
        horizontal, Scale(f"{name}, {unit}", compute_padded_log_limits(measured, line), log=True),
        (Line(t, line, _THIN_PEN, text), *dots, *_make_temperature_tags(dots)), height=220,
    )  # fmt: skip
    lower = Panel(
        horizontal, Scale("residual, %", compute_padded_limits(residual, np.zeros(1), margin=0.1)),
        (Rule(0.0, REF, is_horizontal=True), *_make_dots(data, curve.time, residual)), height=220,
    )  # fmt: skip
    return upper, lower


def shift_panel(shifts: TemperatureShifts) -> Panel:
    """Shift factors over temperature, with two standard errors, and the law with its own."""
    t = np.array([shift.temperature for shift in shifts.shifts])
    log10 = np.array([shift.log10_a_t for shift in shifts.shifts])
    error = 2 * np.array([shift.se for shift in shifts.shifts])
    dense = np.linspace(t[0], t[-1], 200)
    law = shifts.law.log10_a_t(dense)
    celsius, tested_celsius = convert_to_unit(dense, "degC"), convert_to_unit(t, "degC")
    law_name = {"wlf": "WLF", "arrhenius": "Arrhenius"}.get(shifts.law.kind, "between the shifts")
    marks: list[Mark] = []
    if shifts.law_parameters:
        half_width = 2 / np.log(10.0) * np.array([shifts.error(float(value))[0] for value in dense])
        marks.append(
            Area(celsius, law - half_width, law + half_width, "fit", "± 2 standard errors")
        )
    marks += [
        Line(celsius, law, FIT, law_name),
        Dots(tested_celsius, log10, "measured", "shift", error=error),
    ]
    return Panel(
        Scale("temperature, °C", compute_padded_limits(tested_celsius)),
        Scale("log₁₀ of the shift factor", compute_padded_limits(log10 - error, log10 + error)),
        tuple(marks), title=f"shift factors, b = {shifts.vertical}", height=220,
    )  # fmt: skip


def _make_dots(data: Superposition, x: FloatArray, y: FloatArray) -> list[Dots]:
    """Return the samples, in as many colours as there are for temperatures."""
    celsius = convert_to_unit(data.temperature, "degC")
    temperatures = np.unique(celsius)
    classes = np.array_split(temperatures, min(len(temperatures), len(SEQUENTIAL)))
    dots = []
    for colour, part in zip(sequential(len(classes)), classes, strict=True):
        selected = np.isin(celsius, part)
        end_texts = dict.fromkeys(f"{end:.0f}".replace("-", "−") for end in (part[0], part[-1]))
        label = f"{' to '.join(end_texts)} °C"
        dots.append(Dots(x[selected], y[selected], colour, label, size=_DOT))
    return dots


def _make_temperature_tags(dots: list[Dots]) -> list[Tag]:
    """Return the temperatures, each at the middle of its samples."""
    tags = []
    for dot in dots:
        finite_indices = np.flatnonzero(np.isfinite(dot.y))
        if len(finite_indices):
            middle_index = finite_indices[
                np.argsort(dot.x[finite_indices])[len(finite_indices) // 2]
            ]
            tags.append(
                Tag(
                    float(dot.x[middle_index]),
                    float(dot.y[middle_index]),
                    dot.label,
                    dot.colour,
                    bold=True,
                )
            )
    return tags


def _make_line(data: Superposition, fit: Fit | None) -> tuple[Solid, str]:
    """Return the solid to be drawn, and its label."""
    return (data.solid, "spectrum of all temperatures") if fit is None else (fit.solid, "fit")
