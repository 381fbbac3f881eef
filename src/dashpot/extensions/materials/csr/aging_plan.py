"""Plan of a compression stress relaxation test: ovens, hours and specimens for a life."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import combinations
from typing import NamedTuple

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check, HasChecks, Verdict, verdict
from dashpot.base.errors import DataError
from dashpot.base.number_format import format_count
from dashpot.base.reported_values import NORMAL, ReportedValue
from dashpot.base.serialisation import EVERY_FIELD, Key, Serialisable
from dashpot.base.units import (
    Quantity,
    celsius,
    convert_to_si,
    format_quantity,
    parse_quantity,
)
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.specimen import tested_at
from dashpot.extensions.materials.csr import checks
from dashpot.extensions.materials.csr.aging_information import AgingTest, PlannedOvens
from dashpot.extensions.materials.csr.datamodel import Aging
from dashpot.extensions.materials.csr.fit import USUAL_DRIFT, USUAL_OVEN, WORST_OVEN
from dashpot.extensions.materials.csr.law import THOUSAND_HOURS, AgingLaw
from dashpot.extensions.materials.csr.life_table import format_life
from dashpot.extensions.materials.csr.lifetime_prediction import (
    LOWER,
    find_energy_change,
    parse_part,
)

USUAL_LAW = AgingLaw(
    0.03, math.log(parse_quantity("2500h", "time")), 90e3, 1.0,
    parse_quantity("125degC", "temperature"), np.zeros((4, 4)), NORMAL,
)  # fmt: skip
"""Supposed where no fit is given: 3 % a decade, 2500 h at 125 degC, 90 kJ/mol."""
USUAL_SCATTER = 0.01
"""Default scatter of a reading, as a fraction of F0."""
_MIN_SPECIMENS, _MAX_SPECIMENS = 2, 60
"""Specimens in an oven, and in all ovens, of a plan."""
_TEMPERATURE_STEP, _MIN_DISTANCE = 5.0, 10.0
"""Temperatures of ovens that are compared, and least distance of two, K."""
_ROBUST_COST = 2.0
"""Times as many specimens as ovens may need that a lower activation energy does not move."""


class PlannedOven(NamedTuple):
    """Oven of a plan.

    Attributes
    ----------
    temperature : float
        K.
    specimens : int
    retained : float
        Expected F/F0 at the end.
    significance : float
        Significance of the chemical rate by this oven alone, in standard errors.
    """

    temperature: float
    specimens: int
    retained: float
    significance: float


@dataclass(frozen=True)
class AgingAlternative(Serialisable):
    """Expected standard deviation of the ln life for another test.

    Attributes
    ----------
    change : str
        The change of the test, in words.
    specimens : int
        In all its ovens.
    life_sd : float
    """

    _keys = (EVERY_FIELD,)

    change: str
    specimens: int
    life_sd: float


@dataclass(frozen=True, repr=False)
class AgingPlan(HasChecks, Serialisable):
    """Planned compression stress relaxation test, with the expected error of a life.

    Attributes
    ----------
    use_at : float
        Temperature of use, K.
    part : float
        F/F0 at the end of the life.
    life : float
        By the assumed law, s.
    life_sd : float
        Expected standard deviation of the ln life.
    target_sd : float
    oven_temperatures : tuple of float
        K.
    specimens : tuple of int
        In each oven.
    retained, significance : tuple of float
        Expected F/F0 at the end in each oven; its chemical rate, in standard errors.
    longest : float
        Time of the last reading, s.
    times : tuple of float
        Times of all readings, s.
    scatter, oven_sd, drift : float
        Standard deviations: of a reading, in parts of F0; of an oven, K; of the load cell, in parts
        of F0 in 1000 h.
    alternatives : tuple of AgingAlternative
    checks : tuple of Check
    """

    schema = "dashpot/aging-plan@1"
    _keys = ("verdict", Key("values", "facts"), EVERY_FIELD)

    use_at: float
    part: float
    life: float
    life_sd: float
    target_sd: float
    oven_temperatures: tuple[float, ...]
    specimens: tuple[int, ...]
    retained: tuple[float, ...]
    significance: tuple[float, ...]
    longest: float
    times: tuple[float, ...]
    scatter: float
    oven_sd: float
    drift: float
    alternatives: tuple[AgingAlternative, ...]
    checks: tuple[Check, ...] = ()

    @property
    def ovens(self) -> tuple[PlannedOven, ...]:
        """Every oven, the coldest first."""
        return tuple(
            map(
                PlannedOven,
                self.oven_temperatures,
                self.specimens,
                self.retained,
                self.significance,
            )
        )

    @property
    def facts(self) -> tuple[ReportedValue, ...]:
        """The assumed life, with the expected interval of the test."""
        life_value = ReportedValue.from_error(
            "life", self.life, self.life_sd, NORMAL, of_log=True, unit="s", read="h",
            words=f"time until F/F0 is {format_quantity(self.part, '%', 'g')} at "
            f"{celsius(self.use_at)}",
        )  # fmt: skip
        return (life_value,)

    @property
    def verdict(self) -> Verdict:
        """Verdict, with the ovens and the expected interval of the life."""
        oven_texts = [f"{n} at {celsius(kelvin)}" for kelvin, n, *_ in self.ovens]
        low, high = (
            format_life(
                self.life * math.exp(sign * NORMAL * self.life_sd),
                self.life / 10,
                reference=self.life,
            )
            for sign in (-1, 1)
        )
        low = low.partition(" ")[0]
        specimens = format_count(sum(self.specimens), "specimen")
        headline = (
            f"{specimens} ({', '.join(oven_texts)}) for "
            f"{format_quantity(self.longest, 'h', '.4g')} will give the life at "
            f"{celsius(self.use_at)} within a factor of {math.exp(NORMAL * self.life_sd):.3g}, "
            f"about {low} to {high}"
        )
        return verdict(self.checks, headline=headline)


def plan_aging(
    *,
    use_at: Quantity,
    aging: Aging | None = None,
    longest: Quantity = "1000h",
    hottest: Quantity | None = None,
    ovens: int = 3,
    part: float | str = "50%",
    scatter: float | str | None = None,
    machine: Machine | None = None,
    within: float = 1.5,
) -> AgingPlan:
    """Choose ovens and the fewest specimens that give a life at a temperature `within` a factor.

    Temperatures are compared each 5 K, and specimens are added where each lowers the variance of
    the ln life most (the c-optimal allocation, one at a time), at least two in an oven.

    Parameters
    ----------
    use_at : float or str
        Temperature of use, K or ``"70degC"``.
    aging : Aging, optional
        A fit whose law and scatter are assumed; by default 3 % a decade, 2500 h at 125 degC, 90
        kJ/mol and a scatter of 1 % of F0.
    longest, hottest : float or str
        Last reading, s, and hottest oven, K; by default that of the fit, or 150 degC.
    ovens : int
        How many.
    part : float or str
        F/F0 at the end of the life.
    scatter : float or str, optional
        Standard deviation of a reading in parts of F0, 0.01 or ``"1%"``.
    machine : Machine, optional
        Error of the temperature of an oven, and drift in N/s of a force of about 40 N; by default 1
        K, and 3 % of F0 in 1000 h.
    within : float
        Sufficient factor from the life to either end of its 95 % interval.

    Raises
    ------
    DataError
        If a number is invalid, or the assumed law does not determine the life.
    """
    kelvin = _read_temperature("use_at", use_at)
    law = USUAL_LAW if aging is None else aging.law
    hottest_fitted = None if aging is None else aging.ovens[-1].temperature
    if hottest is None:
        hottest = "150degC" if hottest_fitted is None else hottest_fitted
    hottest_oven = _read_temperature("hottest", hottest)
    end = parse_part(part)
    if law.is_lower_bound or law.activation <= 0:
        raise DataError(
            "this aging law has no activation energy, so no life at another temperature follows. "
            "Give a fit of several ovens that showed aging, or none"
        )
    seconds = convert_to_si(longest, "time")
    if not parse_quantity("24h", "time") <= seconds <= parse_quantity("100000h", "time"):
        hours = format_quantity(seconds, "h", ".6g")
        raise DataError(f"--longest {hours}: expected 24 h to 100,000 h, such as 1000h")
    if not 3 <= ovens <= 5:
        raise DataError(
            f"--ovens {ovens}: expected 3 to 5; a line over 1/T needs three (ISO 11346)"
        )
    if not 1.01 <= within <= 50:
        raise DataError(f"--life-within {within:g}: expected a factor of 1.01 to 50, such as 1.5")
    target_sd = math.log(within) / NORMAL
    if hottest_oven < kelvin + (ovens - 1) * _MIN_DISTANCE:
        raise DataError(
            f"the hottest oven, {celsius(hottest_oven)}, is less than "
            f"{(ovens - 1) * _MIN_DISTANCE:g} K above the temperature of use, "
            f"{celsius(kelvin)}. Name a hotter oven: --hottest 150degC"
        )
    machine = machine or Machine()
    machine.refuse_unused("oven", "drift", subject="a plan of aging")
    oven_sd = USUAL_OVEN if machine.oven is None else machine.oven
    if oven_sd > WORST_OVEN:
        raise DataError(
            f"an oven known to {oven_sd:.4g} K; expected 0 to {WORST_OVEN:g} K: oven=1K"
        )
    test = AgingTest(
        law, _read_scatter(scatter, aging), oven_sd,
        USUAL_DRIFT if machine.drift is None else machine.drift * THOUSAND_HOURS / _USUAL_FORCE,
        seconds,
    )  # fmt: skip
    life = law.life(kelvin, end)
    if not math.isfinite(life):
        raise DataError(
            f"at {celsius(kelvin)} the supposed law never falls to {100 * end:g} %. Plan for a "
            "warmer use, or for a smaller loss"
        )
    best = _choose_design(test, (kelvin, end), hottest_oven, ovens, target_sd)
    plan_checks = (
        checks.life_sd_within_target(best.life_sd, target_sd),
        checks.chemical_aging_resolved(best.significance[0], best.temperatures[0]),
        checks.temperature_near_ovens(best.temperatures[0] - kelvin, kelvin),
        checks.robust_to_lower_activation_energy(
            find_energy_change(law, best.temperatures[0], kelvin, end, best.life_sd),
            LOWER, best.temperatures[0],
        ),
        checks.time_near_readings(math.log10(life / seconds), seconds),
        checks.end_point_reached(
            sum(law.compute_retention(value, seconds) <= end for value in best.temperatures), end
        ),
    )  # fmt: skip
    return AgingPlan(
        kelvin, end, life, best.life_sd, target_sd, best.temperatures, best.specimens,
        tuple(law.compute_retention(value, seconds) for value in best.temperatures),
        best.significance, seconds, tuple(test.times.tolist()), test.scatter, test.oven_sd,
        test.drift, tuple(_list_alternatives(test, kelvin, end, hottest_oven, best)), plan_checks,
    )  # fmt: skip


_USUAL_FORCE = 40.0
"""Usual force of a specimen, N, for the relative drift."""


class _Design(NamedTuple):
    """Ovens with their specimens, and the standard deviation of the ln life."""

    temperatures: tuple[float, ...]
    specimens: tuple[int, ...]
    life_sd: float
    significance: tuple[float, ...]


def _read_temperature(name: str, value: Quantity) -> float:
    """Return the temperature of an oven or of use, K."""
    kelvin = convert_to_si(value, "temperature")
    tested_at(f"--{name.replace('_', '-')}", kelvin)
    return kelvin


def _read_scatter(scatter: float | str | None, aging: Aging | None) -> float:
    """Return the standard deviation of a reading in parts of F0."""
    if scatter is None:
        return USUAL_SCATTER if aging is None else aging.scatter
    value = parse_quantity(scatter, "strain") if isinstance(scatter, str) else float(scatter)
    if not 1e-5 <= value <= 0.2:
        raise DataError(f"--scatter {scatter}: expected 0.001 to 20 % of F0, such as 1%")
    return value


def _list_oven_sets(kelvin: float, hottest: float, count: int) -> Iterator[tuple[float, ...]]:
    """Iterate over oven temperatures: the hottest is given, the coldest is near service."""
    max_distance = max(checks.MAX_EXTRAPOLATION, 0.25 * (hottest - kelvin))
    inner = np.arange(hottest - _MIN_DISTANCE, kelvin - 1e-6, -_TEMPERATURE_STEP)[::-1].tolist()
    for cooler in combinations(inner, count - 1):
        is_near = cooler[0] - kelvin <= max_distance
        if is_near and all(np.diff((*cooler, hottest)) >= _MIN_DISTANCE - 1e-6):
            yield (*cooler, hottest)


def _allocate(
    ovens: PlannedOvens, gradient: FloatArray, target: float, max_specimens: int
) -> _Design:
    """Return the specimens added one by one, each in the oven that lowers the variance most."""
    specimens = [_MIN_SPECIMENS] * len(ovens.temperatures)
    sd = ovens.compute_life_sd(specimens, gradient)
    while sd > target and sum(specimens) < max_specimens:
        candidates = []
        for k in range(len(specimens)):
            candidate = [n + (i == k) for i, n in enumerate(specimens)]
            candidates.append((ovens.compute_life_sd(candidate, gradient), candidate))
        sd, specimens = min(candidates)
    return _Design(ovens.temperatures, tuple(specimens), sd, ())


def _choose_design(
    test: AgingTest,
    temperature_and_fraction: tuple[float, float],
    hottest: float,
    count: int,
    target: float,
) -> _Design:
    """Return the ovens that meet the target with the fewest specimens, or come nearest to it.

    Only ovens that show chemical aging count, if there are any. Designs that are robust to a lower
    activation energy in the cold may need twice as many specimens.
    """
    kelvin, part = temperature_and_fraction
    gradient = test.compute_life_gradient(kelvin, part)
    ranked_designs = []
    for temperatures in _list_oven_sets(kelvin, hottest, count):
        ovens = PlannedOvens(test, temperatures)
        design = _allocate(ovens, gradient, target, _MAX_SPECIMENS)
        significance = ovens.compute_oven_significance(design.specimens)
        is_missed = float(design.life_sd > target)
        is_insignificant = float(significance[0] < checks.MIN_SIGNIFICANCE)
        rank = (is_insignificant, is_missed, is_missed * design.life_sd,
                float(sum(design.specimens)), design.life_sd)  # fmt: skip
        change = find_energy_change(test.law, temperatures[0], kelvin, part, design.life_sd)
        is_sensitive = checks.robust_to_lower_activation_energy(
            change, LOWER, temperatures[0]
        ).failed
        ranked_designs.append((rank, is_sensitive, design._replace(significance=significance)))
    if not ranked_designs:
        raise DataError("no ovens fit between the temperature of use and the hottest oven")
    rank, _, best = min(ranked_designs)
    robust = [
        (other, design)
        for other, is_sensitive, design in ranked_designs
        if not is_sensitive and other[:2] == rank[:2] and other[3] <= _ROBUST_COST * rank[3]
    ]
    return min(robust)[1] if robust else best


def _list_alternatives(
    test: AgingTest, kelvin: float, part: float, hottest: float, best: _Design
) -> Iterator[AgingAlternative]:
    """Iterate over the results of alternative tests with the same number of specimens."""

    def compare(change: str, other: AgingTest, design: _Design = best) -> AgingAlternative:
        gradient = other.compute_life_gradient(kelvin, part)
        sd = PlannedOvens(other, design.temperatures).compute_life_sd(design.specimens, gradient)
        return AgingAlternative(change, sum(design.specimens), sd)

    doubled_design = best._replace(specimens=tuple(2 * n for n in best.specimens))
    yield compare("twice as many specimens", test, doubled_design)
    longer_test = replace(test, last_reading_time=2 * test.last_reading_time)
    yield compare(
        f"{format_quantity(longer_test.last_reading_time, 'h', '.4g')} in the ovens", longer_test
    )
    shorter = replace(test, last_reading_time=test.last_reading_time / 2)
    yield compare(f"{format_quantity(shorter.last_reading_time, 'h', '.4g')} in the ovens", shorter)
    if test.oven_sd:
        better_oven = replace(test, oven_sd=test.oven_sd / 2)
        yield compare(f"ovens known to {better_oven.oven_sd:.2g} K", better_oven)
    if test.drift:
        yield compare("a load cell without drift", replace(test, drift=0.0))
    total, count = sum(best.specimens), len(best.temperatures)
    even_temperatures = np.linspace(best.temperatures[0], hottest, count)
    equal_specimens = tuple(total // count + (k < total % count) for k in range(count))
    yield compare(
        f"ovens evenly from {celsius(float(even_temperatures[0]))} on, as many in each",
        test,
        best._replace(temperatures=tuple(even_temperatures.tolist()), specimens=equal_specimens),
    )  # fmt: skip
