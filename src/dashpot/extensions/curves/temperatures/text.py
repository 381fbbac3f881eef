"""Text of the shifts of a fit at several temperatures."""

from __future__ import annotations

from dashpot.base.number_format import ascii_only
from dashpot.base.units import celsius
from dashpot.datamodel.fit import Fit, get_error_label
from dashpot.datamodel.shift_factors import TemperatureShifts
from dashpot.text_output.layout import table


def format_shifts(fit: Fit) -> list[str]:
    """Return the law of temperature and the shifts of a fit at several."""
    shifts = fit.temperatures
    assert shifts is not None  # noqa: S101  -- fits at several temperatures alone come here
    rows = [["", "log10 a_T", get_error_label(fit), "b_T"]]
    for shift in shifts.shifts:
        time_cells, stiffness_cells = (reported_value.cells.ascii for reported_value in shift.facts)
        rows.append(
            [celsius(shift.temperature), time_cells.value, time_cells.error, stiffness_cells.value]
        )
    count = len(shifts.tested_shifts)
    return [
        f"  reference   {celsius(shifts.reference)}, of {count} temperatures; b_T "
        + ("free" if shifts.vertical == "free" else f"= {shifts.vertical}"),
        f"  law         {_format_shift_law(fit, shifts)}",
        *table(rows),
        *(
            f"  advice      {check.message_with_remedy}"
            for check in fit.checks
            if check.name == "shifts_distinguished" and check.failed
        ),
    ]


def _format_shift_law(fit: Fit, shifts: TemperatureShifts) -> str:
    """Return the law of the shifts with its constants, where it has any."""
    constants = ", ".join(
        f"{constant.label} {constant.cells.with_unit}" for constant in shifts.constants
    )
    if constants and fit.estimate.noise_covariance is not None:
        constants += f" ({get_error_label(fit)})"
    law = {"wlf": "WLF", "arrhenius": "Arrhenius"}.get(shifts.law.kind, "none, the shifts alone")
    return ascii_only(": ".join(filter(None, (law, constants))))
