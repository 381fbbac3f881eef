"""Figures of an aging law: F/F0 over time in every oven, and the life over 1/T."""

from __future__ import annotations

from functools import partial

import numpy as np

from dashpot.base import replace
from dashpot.base.arrays import FloatArray
from dashpot.base.number_format import round_to_error
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.extensions.materials.csr.datamodel import Aging, Oven
from dashpot.extensions.materials.csr.law import F0_TIME, HOUR, MAX_LIFETIME, YEAR, AgingLaw
from dashpot.extensions.materials.csr.life_table import (
    find_extrapolation_limit,
    format_life,
    format_temperature,
    get_life_unit,
    has_arrhenius_line,
)
from dashpot.extensions.materials.csr.lifetime_prediction import (
    LOWER,
    AgingPrediction,
    apply_lower_energy,
    format_part,
    predict_aging,
)
from dashpot.plot.picture import (
    FIT,
    PREDICTED,
    SIMPLER,
    Area,
    Dots,
    Line,
    Mark,
    Panel,
    Picture,
    Scale,
    Span,
    Tag,
)
from dashpot.plot.plotted_data import stamp as format_stamp


def csr(aging: Aging, *, stamp: str = "") -> Picture:
    """Return the retained force of every specimen over time and the aging law, a panel an oven.

    Parameters
    ----------
    aging : Aging
    stamp : str
        Origin of the data, printed below the figure; by default the files.
    """
    time = np.geomspace(F0_TIME, aging.longest, 200)
    hours = convert_to_unit(time, "h")
    horizontal = Scale("time, h", (float(hours[0]) / 1.3, float(hours[-1]) * 1.3), log=True)
    smallest = min(float(oven.retained.min()) for oven in aging.ovens)
    up = Scale("F/F0, %", (max(100 * smallest - 5, 0.0), 105.0))
    panels = []
    for item in aging.ovens:
        values = np.array([aging.law.compute_retention(item.temperature, entry) for entry in time])
        dots = Dots(convert_to_unit(item.time, "h"), 100 * item.retained, "measured", "measured")
        marks = (Line(hours, 100 * values, FIT, "law"), dots)
        panels.append(Panel(horizontal, up, marks, title=format_quantity(item.temperature, "°C")))
    caption = "Retained force of the specimens in each oven: measured, and by the aging law."
    origin = format_stamp(aging.sources) if aging.sources else ""
    return Picture("csr", caption, tuple((panel,) for panel in panels), 3, stamp or origin)


def draw_aged_force(prediction: AgingPrediction, *, stamp: str = "") -> Picture:
    """Return the predicted force at a temperature over time, with its 95 % interval.

    Parameters
    ----------
    prediction : AgingPrediction
    stamp : str
        Origin of the data, printed below the figure; by default the files.
    """
    law, kelvin = prediction.aging.law, prediction.temperature
    law = law.lower_limit() if law.is_lower_bound else law
    time = np.geomspace(F0_TIME, prediction.furthest, 200)
    values = np.array([law.compute_retention(kelvin, item) for item in time])
    errors = np.array([
        law.error_of(partial(AgingLaw.compute_retention, temperature=kelvin, time=item))
        for item in time
    ])  # fmt: skip
    half_width = 100 * law.quantile * np.where(np.isfinite(errors), errors, 0.0)
    hours = convert_to_unit(time, "h")
    measured = time <= prediction.aging.longest
    marks = (
        Area(hours, 100 * values - half_width, 100 * values + half_width, "fit", "95 % interval"),
        Line(hours, 100 * values, PREDICTED, "beyond the last reading"),
        Line(hours[measured], 100 * values[measured], FIT, "law"),
    )
    horizontal = Scale("time, h", (float(hours[0]), float(hours[-1])), log=True)
    up = Scale("F/F0, %", (max(100 * float(values.min()) - 10, 0.0), 105.0))
    title = format_quantity(kelvin, "°C") + (", at least" if law.is_lower_bound else "")
    caption = "Force that is left over time at one temperature, with its 95 % interval."
    origin = format_stamp(prediction.aging.sources) if prediction.aging.sources else ""
    panel = Panel(horizontal, up, marks, title=title, height=240)
    return Picture("aged", caption, ((panel,),), 1, stamp or origin)


def draw_life(prediction: AgingPrediction, *, stamp: str = "") -> Picture:
    """Return the life over 1/T above the predicted force over time at the temperature of use.

    Parameters
    ----------
    prediction : AgingPrediction
        For a prediction of times only, or from one oven, only the second panel is drawn.
    stamp : str
        Origin of the data, printed below the figure; by default the files.
    """
    force, part = draw_aged_force(prediction, stamp=stamp), prediction.first_part
    if part is None or not has_arrhenius_line(prediction.aging):
        return force
    chart = draw_life_chart(prediction.aging, part, prediction.temperature)
    return put_chart_first(chart, force)


def put_chart_first(chart: Picture, ovens: Picture) -> Picture:
    """Return the chart of the life above panels of the force."""
    return replace(
        ovens,
        caption=f"{chart.caption} {ovens.caption}",
        strips=(*chart.strips, *ovens.strips),
        rows=(1, len(ovens.strips)),
    )


_TEMPERATURE_TICKS = np.arange(-40.0, 301.0, 20.0)
"""degC."""
_LIFE_TICKS = ((1.0, "1 h"), (10.0, "10 h"), (100.0, "100 h"), (1000.0, "1000 h"), *(
    (convert_to_unit(YEAR, "h") * years, f"{years} year" + "s" * (years > 1))
    for years in (1, 10, 100, 1000, 10000)
))  # fmt: skip
"""Ticks of a life, each with its name."""
_MARGIN = 10.0
"""K, to either side of what the chart is of."""


def draw_life_chart(
    aging: Aging, part: float, temperature: float | None = None, *, stamp: str = ""
) -> Picture:
    """Return the life over 1/T: aging law with its 95 % interval, ovens, and temperature of use.

    Parameters
    ----------
    aging : Aging
        Aging of several ovens that show an activation energy.
    part : float
        F/F0 at the end of the life.
    temperature : float, optional
        Temperature of use, K, whose life is marked.
    stamp : str
        Origin of the data, printed below the figure; by default the files.
    """
    law, coldest, hottest = aging.law, aging.ovens[0].temperature, aging.ovens[-1].temperature
    kelvin_range = (coldest - 40.0, hottest, *(() if temperature is None else (temperature,)))
    kelvin = np.linspace(max(kelvin_range) + _MARGIN, min(kelvin_range) - _MARGIN, 61)
    life, low, high = _compute_life_band(law, kelvin, part)
    reciprocal = 1000 / kelvin
    marks: list[Mark] = []
    limit = find_extrapolation_limit(aging, part)
    if kelvin[-1] < limit < kelvin[0]:
        words = "extrapolated too far"
        marks.append(Span(1000 / limit, float(reciprocal[-1]), "ref", words, hatched=True))
    if np.isfinite(low).all():
        marks.append(Area(reciprocal, low, high, "fit", "95 % interval"))
    is_colder = kelvin <= coldest
    marks += [
        Line(reciprocal[is_colder], life[is_colder], PREDICTED, "below the coldest oven"),
        Line(reciprocal[~is_colder], life[~is_colder], FIT, "law"),
    ]
    lower_energy_law = apply_lower_energy(aging, float(kelvin[-1]))
    drawn_lives = [life, *(limit for limit in (low, high) if np.isfinite(limit).all())]
    if lower_energy_law is not None:
        colder_kelvin = np.array([coldest, *kelvin[is_colder]])
        lower = (
            np.array([lower_energy_law.life(value, part) for value in colder_kelvin.tolist()])
            / HOUR
        )
        words = f"if Ea is {format_quantity(LOWER, 'kJ/mol', 'g')} there"
        marks.append(Line(1000 / colder_kelvin, lower, SIMPLER[1], words))
        drawn_lives.append(lower)
    if law.exponent == 1:
        ovens = [oven for oven in aging.ovens if oven.rate > 0]
        oven_lives = np.array([_compute_oven_life(law, oven, part) for oven in ovens]) / HOUR
        error_bars = np.array([law.quantile / oven.significance for oven in ovens]) * oven_lives
        reciprocals = np.array([1000 / oven.temperature for oven in ovens])
        marks.append(
            Dots(reciprocals, oven_lives, "measured", "each oven by itself", error=error_bars)
        )
        drawn_lives.append(oven_lives)
    if temperature is not None and np.isfinite(law.life(temperature, part)):
        marks += _mark_use(aging, part, temperature)
    low_end, high_end = min(map(np.min, drawn_lives)) / 2, max(map(np.max, drawn_lives)) * 2
    names = [tick for tick in _LIFE_TICKS if low_end < tick[0] < high_end]
    celsius = convert_to_unit(kelvin[[-1, 0]], "°C").tolist()
    ticks = [value for value in _TEMPERATURE_TICKS.tolist() if celsius[0] <= value <= celsius[1]]
    zero = float(kelvin[0]) - celsius[1]
    horizontal = Scale(
        "temperature, °C (even in 1/T)", (float(reciprocal[0]), float(reciprocal[-1])),
        ticks=tuple(1000 / (value + zero) for value in ticks),
        tick_names=tuple(f"{value:g}" for value in ticks),
    )  # fmt: skip
    up = Scale(
        f"time until F/F0 is {100 * part:g} %", (float(low_end), float(high_end)), log=True,
        ticks=tuple(value for value, _ in names), tick_names=tuple(name for _, name in names),
    )  # fmt: skip
    caption = (
        f"Time until {100 * part:g} % of the force is left over the temperature, in 1/T: aging law "
        "with its 95 % interval, and each oven by itself."
    )
    origin = format_stamp(aging.sources) if aging.sources else ""
    panel = Panel(horizontal, up, tuple(marks), height=260)
    return Picture("life", caption, ((panel,),), 1, stamp or origin)


def _compute_life_band(
    law: AgingLaw, kelvin: FloatArray, part: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the life at temperatures and both ends of its 95 % interval, h."""
    life = np.array([min(law.life(value, part), MAX_LIFETIME) for value in kelvin.tolist()]) / HOUR
    errors = np.array([
        law.error_of(partial(AgingLaw.compute_log_life, temperature=value, retained_fraction=part))
        for value in kelvin.tolist()
    ])  # fmt: skip
    half_width = law.quantile * errors
    return life, life * np.exp(-half_width), life * np.exp(half_width)


def _compute_oven_life(law: AgingLaw, oven: Oven, part: float) -> float:
    """Return the life in an oven by the rate of its own readings, s."""
    oven_law = replace(law, chemical=-float(np.log(oven.rate)), activation=0.0)
    return min(oven_law.life(oven.temperature, part), MAX_LIFETIME)


def _mark_use(aging: Aging, part: float, temperature: float) -> list[Mark]:
    """Return the life at the temperature of use, with its interval and its words."""
    reported_value = predict_aging(aging, temperature=temperature, until=format_part(part)).answers[
        0
    ]
    inverse_temperature = 1000 / temperature
    words = (
        f"{format_temperature(temperature)}: "
        f"{format_life(reported_value.value, reported_value.error)}"
    )
    marks: list[Mark] = []
    if reported_value.has_interval:
        size, _ = get_life_unit(reported_value.value)
        low, high = (
            round_to_error(end / size, digits=2)
            for end in (reported_value.low, reported_value.high)
        )
        words += f" ({low} to {high})"
        interval = np.array([reported_value.low, reported_value.high]) / HOUR
        marks.append(Line(np.array([inverse_temperature, inverse_temperature]), interval, FIT))
    return [
        *marks,
        Tag(inverse_temperature, reported_value.value / HOUR, words, "ink", "hollow", bold=True),
    ]
