"""Section of the page of a model that was fitted at several temperatures."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from dashpot.base.number_format import round_to_error
from dashpot.base.reported_values import NORMAL, ReportedValue
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.datamodel.fit import Fit, get_error_label
from dashpot.datamodel.shift_factors import TemperatureShifts
from dashpot.report.first_screen import Row
from dashpot.report.result_page import CollapsibleSection, Group, Topic, row
from dashpot.report.solid_and_frf_pages import TemperaturePart
from dashpot.report.tables import TextTable

_MAX_SHIFTS = 3
"""Largest number of shifts in the main table; all are in a collapsible section."""
_SHIFTS = frozenset({
    "shifts_determined", "shift_monotone", "law_follows_shifts", "no_temperature_outlier",
    "glass_below_tests", "shifts_distinguished", "shifts_independent_of_vertical_rule",
})  # fmt: skip
_CURVE = frozenset({
    "isotherms_overlap", "thermorheologically_simple", "vertical_shift_determined",
    "vertical_rule_holds",
})  # fmt: skip


def make_page_part(fit: Fit) -> TemperaturePart:
    """Return the section of the page on shifts and their law."""
    shifts = fit.temperatures
    assert shifts is not None  # noqa: S101  -- only for fits at several temperatures
    law = {"wlf": "WLF holds", "arrhenius": "Arrhenius holds"}.get(shifts.law.kind, "each its own")
    temperatures = [shift.temperature for shift in shifts.tested_shifts]
    range_text = " to ".join(
        round_to_error(convert_to_unit(value, "°C"), digits=3)
        for value in (min(temperatures), max(temperatures))
    )
    return TemperaturePart(
        "master curve",
        (Topic("Superposition", _CURVE, "one curve"), Topic("Shifts", _SHIFTS, law)),
        (
            ("Reference", format_quantity(shifts.reference, "°C", ".4g")),
            ("Temperatures", f"{len(temperatures)}, {range_text} °C"),
        ),
        tuple(_make_groups(fit, shifts)),
        (_make_shift_table(fit, shifts),),
    )


def _make_groups(fit: Fit, shifts: TemperatureShifts) -> Iterator[Group]:
    """Yield the constants of the law, and the shifts of selected temperatures."""
    # an error from noise only is shown as such, not as an interval
    error_label = "" if fit.estimate.noise_covariance is None else f" ({get_error_label(fit)})"
    if shifts.constants:
        law = {"wlf": "WLF", "arrhenius": "Arrhenius"}.get(shifts.law.kind, "law")
        yield Group(
            f"{law} about {format_quantity(shifts.reference, '°C', '.4g')}{error_label}",
            tuple(
                _make_error_row(constant, is_noise_error=bool(error_label))
                for constant in shifts.constants
            ),
        )
    all_shifts = shifts.tested_shifts
    selected_shifts = (
        all_shifts
        if len(all_shifts) <= _MAX_SHIFTS
        else (all_shifts[0], all_shifts[len(all_shifts) // 2], all_shifts[-1])
    )
    yield Group(
        f"Shift, log₁₀ a_T{error_label}",
        tuple(
            _make_error_row(shift.facts[0], f"At {format_quantity(shift.temperature, '°C', '.4g')}",
                      is_noise_error=bool(error_label))
            for shift in selected_shifts
        ),
    )  # fmt: skip


def _make_error_row(reported_value: ReportedValue, name: str = "", *, is_noise_error: bool) -> Row:
    """Return the row of a number: with its 95 % interval, or with its error if that is of noise."""
    error = reported_value.error or 0.0
    if is_noise_error or not 0 < error < math.inf:
        return row(reported_value, name)._replace(value=reported_value.cells.with_error)
    half_width = NORMAL * error
    return row(
        replace(
            reported_value,
            low=reported_value.value - half_width,
            high=reported_value.value + half_width,
        ),
        name,
    )


def _make_shift_table(fit: Fit, shifts: TemperatureShifts) -> CollapsibleSection:
    """Return the table of all shifts."""
    rows = tuple(
        (
            format_quantity(shift.temperature, "°C", ".4g"),
            time_value.cells.value,
            time_value.cells.error,
            stiffness_value.cells.value,
        )
        for shift in shifts.shifts
        for time_value, stiffness_value in (shift.facts,)
    )
    names = ("temperature", "log₁₀ a_T", get_error_label(fit), "b_T")
    return CollapsibleSection("Every temperature", f"{len(rows)} shifts", TextTable(names, rows))
