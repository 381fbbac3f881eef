"""Options of a fit to relaxation tests, and their contradictions."""

from __future__ import annotations

from collections.abc import Sequence

from dashpot.base.errors import FitError
from dashpot.base.option_fields import FamilyAsked, Method, RampLawAsked, require_choice
from dashpot.datamodel.relaxation import RampHold
from dashpot.fitting.fit_data import NUISANCE, FitSetup, eq5_obstacle
from dashpot.fitting.order_selection import FitOptions


def checked_family(family: str, arms: int | str = "auto") -> None:
    """Refuse a family that is none, and a number of arms of a solid that has none.

    Raises
    ------
    FitError
    """
    require_choice("family", family, FamilyAsked, FitError)
    if family == "fractional" and arms != "auto":
        raise FitError(
            f"arms = {arms}, but a fractional solid has no number of arms: leave out --arms, or "
            "fit both families (--model auto), of which --arms counts those of one"
        )


def require_maxwell_family(family: str) -> None:
    """Refuse all but arms where a solid moves with temperature.

    Raises
    ------
    FitError
    """
    if family != "maxwell":
        raise FitError(
            "a solid with arms alone is fitted at several temperatures. Leave out --model "
            f"{family}, or fit one temperature by itself (Python: model='maxwell')"
        )


def checked_design(
    records: Sequence[RampHold],
    options: FitOptions,
    nuisance: Sequence[str] = NUISANCE,
) -> FitSetup:
    """Return how the tests are set out, if that and all else that is asked go together.

    Raises
    ------
    FitError
        If an option is none, contradicts another, or does not apply to the records.
    """
    _refuse_method(records, options.method)
    _refuse_law(options)
    _refuse_family(options)
    unknown = [name for name in nuisance if name not in NUISANCE]
    if isinstance(nuisance, str) or unknown:
        raise FitError(
            f"nuisance = {nuisance!r}; expected a tuple of names out of {', '.join(NUISANCE)}"
        )
    return FitSetup(options.method, tuple(name for name in NUISANCE if name in nuisance))


def refuse_shifts(what: str, asked: FitOptions) -> None:
    """Refuse what is asked of shifts where one temperature, or none, leaves nothing to shift."""
    options = {
        "--reference": asked.reference is not None,
        "--shift": asked.shift_law != "auto",
        "--vertical": asked.vertical != "free",
    }
    named = [flag for flag, option in options.items() if option]
    if named:
        raise FitError(
            f"{what} of one temperature as far as is known, and shifted to no other: leave out "
            f"{' and '.join(named)}, or fit tests at several temperatures and give those "
            "(--temperature 23degC --temperature 0degC)"
        )


def _refuse_method(records: Sequence[RampHold], method: str) -> None:
    require_choice("method", method, Method, FitError)
    if method == "full":
        return
    for number, record in enumerate(records, start=1):
        obstacle = eq5_obstacle(record)
        if obstacle is not None:
            which = f"test {number} of {len(records)}: " if len(records) > 1 else ""
            raise FitError(which + obstacle)


def _refuse_law(options: FitOptions) -> None:
    law = options.law
    require_choice("law", law, RampLawAsked, FitError)
    if law == "nonlinear" and options.method == "hold":
        raise FitError(
            "a nonlinear law is found from the ramp, and the method hold leaves the ramp out. "
            "Leave out --method hold, or --elastic nonlinear"
        )
    if law == "nonlinear" and options.thorough:
        raise FitError(
            "a nonlinear law has starts of its own. Leave out --thorough, or --elastic nonlinear"
        )


def _refuse_family(options: FitOptions) -> None:
    checked_family(options.family, options.arms)
    if options.family == "fractional" and options.law == "nonlinear":
        raise FitError(
            "a nonlinear law is fitted with arms alone. Leave out --model fractional, or "
            "--elastic nonlinear"
        )
