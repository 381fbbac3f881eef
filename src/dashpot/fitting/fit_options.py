"""Options of a fit to relaxation tests, and their contradictions."""

from __future__ import annotations

from typing import Any, Literal

from dashpot.base import dataclass
from dashpot.base.errors import FitError
from dashpot.base.option_fields import (
    FamilyOption,
    Method,
    RampLawOption,
    ShiftLaw,
    Vertical,
    option,
    require_choice,
)
from dashpot.base.units import Quantity


@dataclass(frozen=True)
class SolidOptions:
    """Options of the solid that a fit finds, whatever the tests are.

    Attributes
    ----------
    arms : int or "auto"
    method : "full" or "hold"
    law : "auto", "linear" or "nonlinear"
    family : "maxwell", "fractional" or "auto"
    intervals, thorough : bool
        As :func:`~dashpot.fitting.relaxation.fit` takes them.
    """

    arms: int | Literal["auto"] = option(
        "auto", "Maxwell arms.", keyword="auto", minimum=0, stage="fit"
    )
    method: Method = option(
        "full", "Whole record, or equation (5) of the paper.", choices=Method, stage="fit"
    )
    law: RampLawOption = option(
        "auto", "Elastic law of the ramp.", choices=RampLawOption, flag="elastic", stage="fit"
    )
    family: FamilyOption = option(
        "maxwell",
        "Model of the seal: Maxwell arms, or fractional.",
        choices=FamilyOption,
        flag="model",
        stage="fit",
    )
    intervals: bool = True
    thorough: bool = False


@dataclass(frozen=True)
class FitOptions(SolidOptions):
    """Options of a fit: arguments of :func:`~dashpot.fitting.relaxation.fit`.

    Attributes
    ----------
    max_arms : int
        The most that ``"auto"`` tries; at several temperatures three more a decade of shift.
    shift_law, vertical : str
        For tests at several temperatures.
    reference : float, optional
        The temperature that they are shifted to, K.
    """

    max_arms: int = 6
    shift_law: ShiftLaw = "auto"
    vertical: Vertical = "free"
    reference: Quantity | None = None

    @property
    def choices(self) -> dict[str, Any]:
        """Options that differ from the defaults, by name."""
        return {
            name: value for name, value in vars(self).items() if value != getattr(FitOptions, name)
        }

    @property
    def count(self) -> int | None:
        """The requested number of arms; None if the data decide."""
        return None if self.arms == "auto" else self.arms

    @property
    def point(self) -> int | None:
        """The requested arms of a fixed-order optimum; None if the order is selected."""
        return None if self.intervals or self.family != "maxwell" else self.count


def checked_family(family: str, arms: int | str = "auto") -> None:
    """Refuse an unknown family, or a number of arms for a family without arms.

    Raises
    ------
    FitError
    """
    require_choice("family", family, FamilyOption, FitError)
    if family == "fractional" and arms != "auto":
        raise FitError(
            f"arms = {arms}, but a fractional model has no number of arms: leave out --arms, or "
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


def refuse_shifts(subject: str, fit_options: FitOptions) -> None:
    """Refuse options of temperature shifts if there is only one temperature."""
    options = {
        "--reference": fit_options.reference is not None,
        "--shift": fit_options.shift_law != "auto",
        "--vertical": fit_options.vertical != "free",
    }
    given_flags = [flag for flag, option in options.items() if option]
    if given_flags:
        raise FitError(
            f"{subject} of one temperature as far as is known, and shifted to no other: leave out "
            f"{' and '.join(given_flags)}, or fit tests at several temperatures and give those "
            "(--temperature 23degC --temperature 0degC)"
        )


def refuse_law(options: FitOptions) -> None:
    """Refuse an unknown elastic law, or one that contradicts the method or the starts."""
    law = options.law
    require_choice("law", law, RampLawOption, FitError)
    if law == "nonlinear" and options.method == "hold":
        raise FitError(
            "a nonlinear law is found from the ramp, and the method hold leaves the ramp out. "
            "Leave out --method hold, or --elastic nonlinear"
        )
    if law == "nonlinear" and options.thorough:
        raise FitError(
            "a nonlinear law has starts of its own. Leave out --thorough, or --elastic nonlinear"
        )


def refuse_family(options: FitOptions) -> None:
    """Refuse an unknown family, or one that contradicts the arms or the elastic law."""
    checked_family(options.family, options.arms)
    if options.family == "fractional" and options.law == "nonlinear":
        raise FitError(
            "a nonlinear law is fitted with arms alone. Leave out --model fractional, or "
            "--elastic nonlinear"
        )
