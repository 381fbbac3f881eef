"""Pressure on the seal of a door, and the states for which its leak speed is computed."""

from __future__ import annotations

from dashpot.base import dataclass
from dashpot.base.errors import DataError
from dashpot.base.value_ranges import require_nonnegative, require_positive
from dashpot.extensions.systems.door.air_flow import AMBIENT_PRESSURE

GAS_CONSTANT = 287.05
"""Gas constant of dry air, J/(kg K)."""
STANDARD_TEMPERATURE = 293.15
"""Temperature of the air where a state gives none, K."""
NEW_STATE = "new"
"""The state of the door as its file describes it."""
_MAX_ERROR = 0.5
"""Standard error over its quantity, at most."""
_WIDEST_LIP = 0.2
"""m; no lip of a seal is wider."""
_HIGHEST_COEFFICIENT = 5.0
"""No pressure coefficient of a car body is higher."""


def compute_air_density(temperature: float) -> float:
    r"""Return the density of air of :math:`p_a` = 1013.25 hPa, :math:`p_a/(R T)`, kg/m^3."""
    return AMBIENT_PRESSURE / (GAS_CONSTANT * temperature)


@dataclass(frozen=True)
class AgingChoice:
    """Aging of the seal in a state, by an aging law.

    Attributes
    ----------
    law_path : str
        Path of the law, a fit of compression stress relaxation.
    time, temperature : float
        s and K.
    """

    law_path: str
    time: float
    temperature: float


@dataclass(frozen=True)
class LeakState:
    """State of the seal for which its leak speed is computed.

    Attributes
    ----------
    name : str
    gap : float
        By how much the gap is wider than where the seal relaxed, m.
    time : float
        Since the gap widened, s; inf lets the seal relax there.
    temperature : float or None
        K; None is that of the seal of the door.
    retained : float
        Fraction of the force after aging, F/F0.
    retained_sd : float
        Its standard error.
    aging : AgingChoice or None
        In place of `retained`.
    density : float or None
        Density of the air, kg/m^3; None is that at the temperature.
    """

    name: str
    gap: float = 0.0
    time: float = float("inf")
    temperature: float | None = None
    retained: float = 1.0
    retained_sd: float = 0.0
    aging: AgingChoice | None = None
    density: float | None = None

    def __post_init__(self) -> None:
        prefix = f"the state '{self.name}': "
        require_nonnegative(prefix, gap=self.gap, retained_sd=self.retained_sd)
        require_positive(prefix, temperature=self.temperature, density=self.density, optional=True)
        if not 0 < self.retained <= 1:
            raise DataError(
                f"{prefix}a part of {self.retained:g} of the force; expected more than 0 and at "
                "most 100 %"
            )
        if not self.time > 0:
            raise DataError(
                f"{prefix}time = {self.time:g} s; expected a time > 0 since the gap opened"
            )
        if self.time < float("inf") and self.gap == 0:
            raise DataError(
                f"{prefix}time is that since the gap became wider, and gap is not given: add gap, "
                "or leave time out"
            )
        if self.aging is not None and self.retained != 1:
            raise DataError(f"{prefix}an aging law and a part of the force say the same; keep one")


@dataclass(frozen=True)
class LeakSetup:
    """Pressure on the seal, and the properties of its lip.

    Attributes
    ----------
    lip : float
        Width of the seal on which the pressure acts, m.
    pressure_coefficient : float
        Pressure difference over the seal, of the dynamic pressure.
    lip_sd, pressure_coefficient_sd : float
        Their standard errors.
    gap_sd : float
        Standard error of the gap, the same along the line, m.
    force_sd : float
        Relative standard deviation of the force of seals about that of the tested specimen.
    limit : float or None
        Speed up to which the seal must not leak, m/s.
    states : tuple of LeakState
        States in addition to that of the door file.
    """

    lip: float
    pressure_coefficient: float = 1.0
    lip_sd: float = 0.0
    pressure_coefficient_sd: float = 0.0
    gap_sd: float = 0.0
    force_sd: float = 0.0
    limit: float | None = None
    states: tuple[LeakState, ...] = ()

    def __post_init__(self) -> None:
        require_positive(lip=self.lip, pressure_coefficient=self.pressure_coefficient)
        require_positive(limit=self.limit, optional=True)
        require_nonnegative(
            lip_sd=self.lip_sd,
            pressure_coefficient_sd=self.pressure_coefficient_sd,
            gap_sd=self.gap_sd,
            force_sd=self.force_sd,
        )
        if self.lip > _WIDEST_LIP or self.pressure_coefficient > _HIGHEST_COEFFICIENT:
            raise DataError(
                f"a lip of {self.lip:g} m and a pressure coefficient of "
                f"{self.pressure_coefficient:g}; expected at most {_WIDEST_LIP:g} m and "
                f"{_HIGHEST_COEFFICIENT:g}: is the unit mm?"
            )
        for name in ("lip", "pressure_coefficient"):
            if getattr(self, f"{name}_sd") > _MAX_ERROR * getattr(self, name):
                raise DataError(
                    f"{name}_sd is more than {100 * _MAX_ERROR:.0f} % of {name}; expected a "
                    "smaller standard error"
                )
        if self.force_sd > _MAX_ERROR:
            raise DataError(
                f"force_sd = {100 * self.force_sd:g} %; expected at most {100 * _MAX_ERROR:.0f} %"
            )
        names = [NEW_STATE, *(state.name for state in self.states)]
        repeated_names = [name for name in names if names.count(name) > 1]
        if repeated_names:
            raise DataError(
                f"two states are called '{repeated_names[0]}'; the first of all is '{NEW_STATE}'"
            )
