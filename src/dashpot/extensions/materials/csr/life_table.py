"""Lives at several temperatures, each with its interval and verdict, and how far they reach."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from dashpot.base.checks import Use
from dashpot.base.number_format import round_to_error
from dashpot.base.reported_values import ReportedValue
from dashpot.base.units import format_quantity, parse_quantity
from dashpot.extensions.materials.csr.datamodel import Aging
from dashpot.extensions.materials.csr.law import HOUR, YEAR
from dashpot.extensions.materials.csr.lifetime_prediction import format_part, predict_aging

_TEMPERATURE_STEP, _RANGE_BELOW, _RANGE_ABOVE = 10.0, 60.0, 10.0
"""Step of the table, and its range below and above the coldest oven, K."""
_RESOLUTION = 0.5
"""K."""


class Life(NamedTuple):
    """Life at one temperature.

    Attributes
    ----------
    temperature : float
        K.
    life : ReportedValue
        s.
    lower_energy_life : float or None
        With the lower activation energy below the coldest oven, s.
    use : str
        Grade of the verdict on it.
    """

    temperature: float
    life: ReportedValue
    lower_energy_life: float | None
    use: Use


def has_arrhenius_line(aging: Aging) -> bool:
    """Return whether several ovens show how a life depends on the temperature."""
    return len(aging.ovens) > 1 and not aging.law.is_lower_bound and aging.law.activation > 0


def list_lives(aging: Aging, part: float, temperatures: Sequence[float] = ()) -> tuple[Life, ...]:
    """Return lives to a part of F0 at temperatures, K, each judged by the checks of its prediction.

    Without temperatures, each 10 K about the coldest oven, from 60 K below it; temperatures whose
    life exceeds the computed range are omitted.
    """
    zero_celsius = parse_quantity("0degC", "temperature")
    coldest = aging.ovens[0].temperature - zero_celsius
    first = math.ceil(round((coldest - _RANGE_BELOW) / _TEMPERATURE_STEP, 6))
    last = math.floor(round((coldest + _RANGE_ABOVE) / _TEMPERATURE_STEP, 6))
    temperatures_listed = temperatures or tuple(
        zero_celsius + _TEMPERATURE_STEP * i for i in range(first, last + 1)
    )
    life_rows = []
    for kelvin in temperatures_listed:
        prediction = predict_aging(aging, temperature=kelvin, until=format_part(part))
        life_value, *lower_energy_facts = prediction.answers
        if not life_value.is_lower_bound:
            lower_energy_life = lower_energy_facts[0].value if lower_energy_facts else None
            life_rows.append(Life(kelvin, life_value, lower_energy_life, prediction.verdict.use))
    return tuple(life_rows)


def find_extrapolation_limit(aging: Aging, part: float) -> float:
    """Return the lowest temperature, K, at which the checks of a prediction find nothing to mark.

    To half a kelvin, by halving from the hottest oven down; infinite if there is none.
    """
    hottest, coldest = aging.ovens[-1].temperature, aging.ovens[0].temperature

    def is_unmarked(kelvin: float) -> bool:
        prediction = predict_aging(aging, temperature=kelvin, until=format_part(part))
        return prediction.verdict.use == "use" and not prediction.answers[0].is_lower_bound

    if not is_unmarked(hottest):
        return math.inf
    supported, limit_kelvin = hottest, coldest - 1.5 * _RANGE_BELOW
    while supported - limit_kelvin > _RESOLUTION:
        middle = (supported + limit_kelvin) / 2
        supported, limit_kelvin = (
            (middle, limit_kelvin) if is_unmarked(middle) else (supported, middle)
        )
    return supported


def get_life_unit(life: float) -> tuple[float, str]:
    """Return the unit in which a life, s, is read, in s, and its name: hours, or years."""
    return (YEAR, "years") if life >= YEAR else (HOUR, "h")


def format_life(life: float, error: float | None = None, *, reference: float | None = None) -> str:
    """Return a life, s, in hours or years, whichever suits a reference life, s, or itself.

    >>> format_life(1.1 * YEAR), format_life(1.1 * YEAR, 10 * HOUR, reference=0.9 * YEAR)
    ('1.10 years', '9643 h')
    """
    size, name = get_life_unit(life if reference is None else reference)
    return f"{round_to_error(life / size, error / size if error else None)} {name}"


def format_temperature(temperature: float) -> str:
    """Return a temperature, K, as charts and tables name it."""
    return format_quantity(temperature, "°C", ".4g")
