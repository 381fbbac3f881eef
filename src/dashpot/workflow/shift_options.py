"""What a user says of tests at several temperatures: one of them alone, or all, shifted to one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from dashpot.base.choices import ShiftLaw, VerticalAsked, words
from dashpot.base.errors import FitError
from dashpot.base.option_fields import option
from dashpot.datamodel.specimen import Specimen

if TYPE_CHECKING:
    from dashpot.extensions.curves.datamodel.superposition import Superposition
    from dashpot.extensions.curves.superposition.isotherms import Measured

_TYPED = {one.removesuffix("/T_r"): one for one in words(VerticalAsked)}
"""Shifts of the moduli, by the words that are typed."""


@dataclass(frozen=True)
class ShiftChoices:
    """How tests at several temperatures are shifted: sweeps, moduli or creep to a master curve.

    Of ramps and holds, which find their shifts in one fit, `at` and `shifts` say nothing. All but
    `at` are arguments of :func:`~dashpot.extensions.curves.superposition.superpose.superpose`;
    `shifts` names a file here.
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


def one_temperature(
    tests: Sequence[Measured],
    choices: ShiftChoices,
    specimen: Specimen | None,
) -> Measured | Superposition:
    """Return the test as it is, the part of one temperature, or the master curve of them all.

    Raises
    ------
    FitError
        If the choices exclude each other, or the tests.
    """
    first, at = tests[0], choices.at
    if first.several_temperatures and specimen is not None and specimen.temperature is not None:
        raise FitError(
            "the file says the temperature of every sample, so --temperature has nothing to add: "
            "--only takes one of them alone, --reference moves the master curve of them all"
        )
    alone = len(tests) == 1 and choices == ShiftChoices(at=at)
    if at is not None:
        if not alone:
            raise FitError(
                "--only takes one temperature out of a file of several; leave out --reference, "
                "--shift, --vertical and --shifts, which shift them all, and other files"
            )
        return first.at(at)
    if alone and not first.several_temperatures:
        return first
    from dashpot.extensions.curves.superposition.read_shift_factors import read_shifts
    from dashpot.extensions.curves.superposition.superpose import superpose

    known = () if choices.shifts is None else read_shifts(choices.shifts)
    return superpose(
        tests,
        reference=choices.reference,
        law=choices.law,
        vertical=choices.vertical,
        shifts=known,
    )
