"""Assumed seal of a plan."""

from __future__ import annotations

import numpy as np

from dashpot.base import dataclass
from dashpot.base.option_fields import option
from dashpot.base.units import Quantity, convert_to_si, si_fields
from dashpot.base.value_ranges import require_positive
from dashpot.planning.plan_options import IN_SI
from dashpot.solids.demo_seals import PAPER, SHIFT
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.shift_laws import TemperatureLaw

# share of the instantaneous stiffness of an arm that may be undetected in sponge rubber
TYPICAL_ARM_SHARE = 0.1
# an arm of the model this near, as a factor in time, already stands for the unseen one
NEAR_FACTOR = 3.0


@dataclass(frozen=True)
class AssumedSeal:
    """Assumed seal, with an arm that the test may not show.

    Attributes
    ----------
    model : GeneralizedMaxwell
        The paper's Table 1 by default.
    arm : (float, float), optional
        Stiffness, N/m, and relaxation time, s, of the unresolved arm. By default 10 % of the
        instantaneous stiffness at 1/omega, unless the model has an arm within a factor of 3.
    temperature : float, optional
        Temperature of `model`, K; by default the reference of the law.
    law : TemperatureLaw
        Its shift with temperature: by default of a rubber with its glass transition at -55 degC.
        The fit needs no law.

    Raises
    ------
    DataError
        If the temperature is not positive.
    """

    model: GeneralizedMaxwell = PAPER
    arm: tuple[Quantity, Quantity] | None = None
    temperature: float | None = option(
        None, "Test temperature (23degC, or that of the fit).", unit="temperature"
    )
    law: TemperatureLaw = SHIFT

    def __post_init__(self) -> None:
        si_fields(self)
        require_positive(temperature=self.temperature, expected=IN_SI, optional=True)

    @property
    def test_temperature(self) -> float:
        """The temperature of the test, K."""
        return self.law.reference if self.temperature is None else self.temperature

    def with_arm(self, at: float) -> tuple[GeneralizedMaxwell, tuple[float, float] | None]:
        """Return the model with the unresolved arm that matters at a frequency, Hz, and the arm."""
        arm = self.arm
        if arm is None:
            tau = 1 / (2 * np.pi * at)
            if any(1 / NEAR_FACTOR < value / tau < NEAR_FACTOR for value in self.model.tau):
                return self.model, None
            arm = (TYPICAL_ARM_SHARE * self.model.k_0, tau)
        values = convert_to_si(arm[0], "stiffness"), convert_to_si(arm[1], "time")
        return self.model + GeneralizedMaxwell(0.0, values[:1], values[1:]), values
