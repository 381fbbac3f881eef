"""Options of a rod under a mass; imports no NumPy, so that help is fast."""

from __future__ import annotations

from dashpot.base import dataclass
from dashpot.base.errors import DataError
from dashpot.base.option_fields import option
from dashpot.base.units import si_fields
from dashpot.workflow.job import declare_shape


@dataclass(frozen=True)
class RodChoices:
    """Options of a rod under a mass: its dimensions and the errors of its test."""

    disc: str | None = declare_shape("Diameter and length of a round rod: 20mm,20mm.")
    block: str | None = declare_shape("Both widths and length of another: 30mm,20mm,10mm.")
    lubricated: bool = option(False, "The ends slide.", is_flag=True)
    gain_error: float = option(0.01, "Gain error between the sensors, e.g. 1%.", unit="strain")
    phase_error: float = option("1deg", "Phase error between the sensors.", unit="angle")
    glue_error: float = option(0.065, "Give of the glue over the rod's; 0: none.", unit="strain")

    def __post_init__(self) -> None:
        si_fields(self)
        for name in ("gain_error", "phase_error", "glue_error"):
            value = getattr(self, name)
            if not 0 <= value < 1:
                raise DataError(
                    f"--{name.replace('_', '-')} {value:g}; expected an error from 0 to below 1"
                )
