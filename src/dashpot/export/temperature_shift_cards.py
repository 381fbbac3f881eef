"""How temperature moves a solid, in the words and the cards of solvers."""

from __future__ import annotations

from dashpot.base.units import celsius
from dashpot.datamodel.shift_factors import TemperatureShifts
from dashpot.export.unit_systems import text
from dashpot.solids.shift_laws import GAS, WLF, Arrhenius

_SAME = 1e-3
"""Stiffnesses that change by less over the tested temperatures stay as they are."""


def law_lines(shifts: TemperatureShifts) -> list[str]:
    """What a deck's header says of the fitted law, its formula and constants in it."""
    law, (low, high) = shifts.law, shifts.tested
    reference = f"T_r = {text(law.reference)} K"
    if isinstance(law, WLF):
        says = (
            f"WLF, log10 a_T = -C1 (T - T_r)/(C2 + T - T_r), C1 = {text(law.c1)}, "
            f"C2 = {text(law.c2)} K, {reference}"
        )
    elif isinstance(law, Arrhenius):
        says = (
            f"Arrhenius, ln a_T = E/R (1/T - 1/T_r), E = {text(law.energy)} J/mol, "
            f"E/R = {text(law.energy / GAS)} K, {reference}"
        )
    else:
        listed = ", ".join(
            f"{text(shift.log10_a_t)} at {text(shift.temperature)} K" for shift in shifts.shifts
        )
        says = f"none; log10 a_T is {listed}, straight in 1/T between them"
    follows = f"relaxation times go with a_T{_stiffnesses(shifts)}"
    return [
        f"temperature law: {says}",
        f"  tested from {celsius(low)} to {celsius(high)}; {follows}",
        "  the numbers here are those of T_r; --temperature asks for others",
    ]


def not_carried(shifts: TemperatureShifts) -> list[str]:
    """What a shift of times leaves out: the change of stiffness, if there is one."""
    if not _stiffnesses(shifts):
        return []
    return [
        "the shift moves times alone: the stiffness b_T above is not in it; scale the moduli, or",
        "write a deck of each temperature",
    ]


def abaqus_shift(shifts: TemperatureShifts | None) -> tuple[list[str], list[str]]:
    """Return the cards ``*TRS`` that follow ``*VISCOELASTIC``, and what to say of them."""
    law = None if shifts is None else shifts.law
    if shifts is None or not isinstance(law, WLF | Arrhenius):
        return [], []
    row: tuple[float, ...]
    if isinstance(law, WLF):
        row, constants = (law.reference, law.c1, law.c2), []
        cards = ["*TRS, DEFINITION=WLF"]
    else:
        row = (law.reference, law.energy)
        cards = ["*TRS, DEFINITION=ARRHENIUS"]
        constants = [
            "the model needs, above all materials, *PHYSICAL CONSTANTS, ABSOLUTE ZERO=0.,",
            f"UNIVERSAL GAS={text(GAS)}: the energy on the card is in J/mol",
        ]
    sentences = ["*TRS: temperatures of the model are in K", *constants, *not_carried(shifts)]
    return [*cards, ", ".join(text(value) for value in row)], sentences


def ansys_shift(shifts: TemperatureShifts | None) -> tuple[list[str], list[str]]:
    """Return the table ``TB,SHIFT`` beside ``TB,PRONY``, and what to say of it."""
    law = None if shifts is None else shifts.law
    if shifts is None or not isinstance(law, WLF | Arrhenius):
        return [], []
    row: tuple[float, ...]
    if isinstance(law, WLF):
        head, row = "TB,SHIFT,1,1,3,WLF", (law.reference, law.c1, law.c2)
    else:
        head, row = "TB,SHIFT,1,1,2,TN", (law.reference, law.energy / GAS)
    sentences = ["TB,SHIFT: temperatures of the model are in K (TOFFST,0)", *not_carried(shifts)]
    return [head, "TBDATA,1," + ",".join(text(value) for value in row)], sentences


def _stiffnesses(shifts: TemperatureShifts) -> str:
    """How every stiffness follows the temperature; nothing if it does not."""
    low, high = (shifts.b_t(value) for value in shifts.tested)
    if max(abs(low - 1), abs(high - 1)) < _SAME:
        return ""
    if shifts.vertical == "T/T_r":
        return ", stiffnesses with b_T = T/T_r"
    ends = " to ".join(
        f"{b:.4g} at {celsius(value)}" for b, value in zip((low, high), shifts.tested, strict=True)
    )
    return f", stiffnesses with b_T = {ends}"
