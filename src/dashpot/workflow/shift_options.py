"""What a user says of tests at several temperatures: one of them alone, or all, shifted to one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from dashpot.base.choices import ShiftLaw, VerticalAsked, get_choice_values
from dashpot.base.errors import FitError
from dashpot.base.option_fields import option

_TYPED = {value.removesuffix("/T_r"): value for value in get_choice_values(VerticalAsked)}
"""Shifts of the moduli, by the words that are typed."""


@dataclass(frozen=True)
class ShiftChoices:
    """How tests at several temperatures are shifted: sweeps, moduli or creep to a master curve.

    Of ramps and holds, which find their shifts in one fit, `at` and `shifts` say nothing. `shifts`
    names a file.
    """

    at: float | None = option(
        None, "Use the sweep of this temperature alone.", unit="temperature", flag="only"
    )
    reference: float | None = option(
        None,
        "Temperature to shift to (nearest to 23degC).",
        unit="temperature",
    )
    law: ShiftLaw = option("auto", "Law of the shift factors.", flag="shift", choices=ShiftLaw)
    vertical: VerticalAsked = option(
        "auto",
        "Shift of the moduli: auto, 1, T or free.",
        choices=_TYPED,
        parse=_TYPED.__getitem__,
    )
    shifts: str | None = option(None, "Known shift factors.", metavar="FILE")


def shifted_ramps(choices: ShiftChoices) -> dict[str, Any]:
    """Return what :func:`~dashpot.fitting.relaxation.fit` is to do with several temperatures.

    Raises
    ------
    FitError
        If a choice is for sweeps, moduli and creep alone.
    """
    if choices.at is not None or choices.shifts is not None:
        raise FitError(
            "--only and --shifts are for sweeps, moduli and creep; ramps and holds find their own "
            "shifts: leave them out"
        )
    vertical = "free" if choices.vertical == "auto" else choices.vertical
    return {"reference": choices.reference, "shift_law": choices.law, "vertical": vertical}
