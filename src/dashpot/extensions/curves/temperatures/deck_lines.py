"""Lines of a solver input on the temperature law of a fit."""

from __future__ import annotations

from dashpot.base.units import celsius
from dashpot.datamodel.shift_factors import TemperatureShifts
from dashpot.export.unit_systems import text
from dashpot.solids.shift_laws import GAS_CONSTANT, WLF, Arrhenius

# Temperature dependence.


_SAME_STIFFNESS = 1e-3
"""Stiffnesses that change by less over the tested temperatures stay as they are."""


def format_law_lines(shifts: TemperatureShifts) -> list[str]:
    """Return the lines of a deck's header on the fitted law: its formula and constants."""
    law, (low, high) = shifts.law, shifts.tested_range
    reference = f"T_r = {text(law.reference)} K"
    if isinstance(law, WLF):
        message = (
            f"WLF, log10 a_T = -C1 (T - T_r)/(C2 + T - T_r), C1 = {text(law.c1)}, "
            f"C2 = {text(law.c2)} K, {reference}"
        )
    elif isinstance(law, Arrhenius):
        message = (
            f"Arrhenius, ln a_T = E/R (1/T - 1/T_r), E = {text(law.energy)} J/mol, "
            f"E/R = {text(law.energy / GAS_CONSTANT)} K, {reference}"
        )
    else:
        shifts_text = ", ".join(
            f"{text(shift.log10_a_t)} at {text(shift.temperature)} K" for shift in shifts.shifts
        )
        message = f"none; log10 a_T is {shifts_text}, straight in 1/T between them"
    sentence = f"relaxation times go with a_T{_format_stiffness_shift(shifts)}"
    return [
        f"temperature law: {message}",
        f"  tested from {celsius(low)} to {celsius(high)}; {sentence}",
        "  the numbers here are those of T_r; --temperature asks for others",
    ]


def format_missing_stiffness_lines(shifts: TemperatureShifts) -> list[str]:
    """Return the change of stiffness that a shift of times leaves out, if there is one."""
    if not _format_stiffness_shift(shifts):
        return []
    return [
        "the shift moves times alone: the stiffness b_T above is not in it; scale the moduli, or",
        "write a deck of each temperature",
    ]


def _format_stiffness_shift(shifts: TemperatureShifts) -> str:
    """Return the temperature dependence of the stiffnesses as text; empty if there is none."""
    low, high = (shifts.b_t(value) for value in shifts.tested_range)
    if max(abs(low - 1), abs(high - 1)) < _SAME_STIFFNESS:
        return ""
    if shifts.vertical == "T/T_r":
        return ", stiffnesses with b_T = T/T_r"
    range_text = " to ".join(
        f"{b:.4g} at {celsius(value)}"
        for b, value in zip((low, high), shifts.tested_range, strict=True)
    )
    return f", stiffnesses with b_T = {range_text}"
