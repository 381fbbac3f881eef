"""Lifetime at a temperature, and retained force after a time, by an aging law."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.checks import Check, Verdict, verdict
from dashpot.base.errors import DataError
from dashpot.base.provenance import Source, Step
from dashpot.base.reported_values import ReportedValue
from dashpot.base.result_mixins import HasVerdict
from dashpot.base.serialisation import EVERY_FIELD, Key, Serialisable
from dashpot.base.units import Quantity, celsius, convert_to_si, format_quantity, parse_quantity
from dashpot.datamodel.fit import Fit, scale_stiffness
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.specimen import tested_at
from dashpot.extensions.materials.csr.checks import (
    aging_prediction_determined,
    end_point_reached,
    robust_to_lower_activation_energy,
    stiffness_follows_force,
    temperature_near_ovens,
    time_near_readings,
)
from dashpot.extensions.materials.csr.datamodel import Aging, CSRTest, format_fact_clause
from dashpot.extensions.materials.csr.fit import fit_aging
from dashpot.extensions.materials.csr.law import F0_TIME, MAX_LIFETIME, AgingLaw
from dashpot.extensions.materials.csr.preprocess import ONE_OVEN

LOWER = 65e3
"""Activation energy at low temperature, J/mol (EPDM, Gillen et al. 2003)."""
_ROBUST = "robust_to_lower_activation_energy"
_EXTRAPOLATION = {"temperature_near_ovens", _ROBUST, "time_near_readings"}
"""Checks of the extrapolation."""


@dataclass(frozen=True, repr=False)
class AgingPrediction(HasVerdict, Serialisable):
    """Predicted retained force at a temperature over time.

    Attributes
    ----------
    aging : Aging
    temperature : float
        K.
    until : tuple of str
        The requested fractions of F0 and times.
    furthest : float
        The latest requested or computed time, s.
    checks : tuple of Check
    """

    schema = "dashpot/aged@2"
    _keys = ("verdict", Key("values", "answers"), EVERY_FIELD, Key("latest_time", "furthest"))

    aging: Aging
    temperature: float
    until: tuple[str, ...]
    furthest: float
    checks: tuple[Check, ...]

    @property
    def answers(self) -> tuple[ReportedValue, ...]:
        """Lifetimes to the requested parts of F0, s, and retained parts after requested times."""
        lists = (
            _report_end(self.aging, self.temperature, *_parse_end(name)) for name in self.until
        )
        return tuple(
            reported_value for reported_values in lists for reported_value in reported_values
        )

    @property
    def first_part(self) -> float | None:
        """The first requested fraction of F0; None if only times were requested."""
        parts = (part for part, _ in map(_parse_end, self.until) if not math.isnan(part))
        return next(parts, None)

    @property
    def facts(self) -> tuple[ReportedValue, ...]:
        """The answers."""
        return self.answers

    @property
    def interval_note(self) -> str:
        """Note on errors that the intervals do not include; else ""."""
        if not any(check.failed and check.name in _EXTRAPOLATION for check in self.checks):
            return ""
        return (
            "The intervals contain the scatter of readings and ovens alone. They assume that the "
            "aging law is valid beyond the ovens."
        )

    @property
    def sources(self) -> tuple[Source, ...]:
        """Sources of the aging law."""
        return self.aging.sources

    @property
    def verdict(self) -> Verdict:
        """Verdict, with the first lifetime or retained force."""
        message = f"at {celsius(self.temperature)} {format_fact_clause(self.answers[0])}"
        return verdict(self.checks, headline=message)


@dataclass(frozen=True, repr=False)
class FittedLife(AgingPrediction):
    """Life at the temperature of use, fitted from files: its file keeps the aging law."""

    @property
    def _saved_result(self) -> Aging:
        """The aging law, for other commands."""
        return self.aging


def predict_aging(
    aging: Aging, *, temperature: Quantity | None = None, until: str | Sequence[str] = ()
) -> AgingPrediction:
    """Predict lifetimes to parts of F0 at a temperature, or retained forces after times.

    Parameters
    ----------
    aging : Aging
    temperature : float or str
        K, or ``"70degC"``.
    until : str or sequence of str
        Each a part, ``"50%"``, or a time, ``"1000h"``; by default half of it.

    Raises
    ------
    DataError
        If no temperature is given, or the ovens do not determine the result there.
    """
    if temperature is None:
        raise DataError(
            "aging depends on the temperature. Add that of the seal: --temperature 70degC"
        )
    temperature = convert_to_si(temperature, "temperature")
    tested_at("--temperature", temperature)
    law, coldest, hottest = aging.law, aging.ovens[0].temperature, aging.ovens[-1].temperature
    kelvin_distances = [abs(temperature - oven.temperature) for oven in aging.ovens]
    if law.is_lower_bound and temperature > hottest + ONE_OVEN:
        raise DataError(
            f"no oven up to {celsius(hottest)} showed aging, so nothing is known of "
            f"{celsius(temperature)}. Test a hotter oven"
        )
    if len(kelvin_distances) == 1 and kelvin_distances[0] > ONE_OVEN and not law.is_lower_bound:
        raise DataError(
            f"one oven, at {celsius(hottest)}, shows nothing of {celsius(temperature)}. Fit two "
            "more ovens together with it, or ask for the temperature of the oven"
        )
    questions = _parse_questions(until) or ("50%",)
    latest_time = max(
        _compute_question_time(law, temperature, *_parse_end(question)) for question in questions
    )
    changes = [
        _compute_answer_shift(aging, temperature, *_parse_end(question)) for question in questions
    ]
    checks = (
        temperature_near_ovens(coldest - temperature, temperature),
        robust_to_lower_activation_energy(
            max((change for change in changes if change is not None), default=None), LOWER, coldest
        ),
        time_near_readings(math.log10(latest_time / aging.longest), aging.longest),
        end_point_reached(*count_ovens_at_end_point(aging, questions)),
        aging_prediction_determined(_find_widest(aging, temperature, questions)),
    )
    return AgingPrediction(aging, temperature, questions, latest_time, (*checks, *aging.checks))


def _find_widest(aging: Aging, temperature: float, questions: Sequence[str]) -> float | None:
    """Return the largest relative standard error of the results; None without errors."""
    errors = [
        reported_value.error / reported_value.value
        for question in questions
        for reported_value in _report_end(aging, temperature, *_parse_end(question))
        if reported_value.error is not None and reported_value.value > 0
    ]
    return max(errors, default=None)


def make_life_interval(
    result: Aging | AgingPrediction, name: str
) -> tuple[ReportedValue, str] | None:
    """Return the life with a lower limit that allows for a lower activation energy, and the remedy.

    None for other values, and where the life is robust to the lower energy.

    Raises
    ------
    DataError
        If a life is asked of an aging law without a temperature of use.
    """
    if name != "life":
        return None
    if isinstance(result, Aging):
        raise DataError(
            "a life depends on the temperature of use. Add it: dashpot fit FILE --use-at 40degC"
        )
    reported_values = {
        reported_value.name: reported_value for reported_value in reversed(result.facts)
    }
    life_value, lower_energy_life = (
        reported_values.get("life"),
        reported_values.get("life_if_Ea_falls"),
    )
    failed_check = next(
        (check for check in result.checks if check.failed and check.name == _ROBUST), None
    )
    if life_value is None or lower_energy_life is None or failed_check is None:
        return None
    low = min(life_value.low, lower_energy_life.low)
    return replace(life_value, low=low, error=None), failed_check.message_with_remedy


def fit_life(
    records: Sequence[CSRTest],
    *,
    machine: Machine | None = None,
    use_at: Quantity | None = None,
) -> Aging | AgingPrediction:
    """Fit the aging law, and with a temperature of use predict the life there, to half of F0.

    Parameters
    ----------
    records : sequence of CSRTest
    machine : Machine, optional
        As in :func:`dashpot.extensions.materials.csr.fit.fit_aging`.
    use_at : float or str, optional
        K, or ``"40degC"``.

    Raises
    ------
    DataError, FitError
        As there, and if the ovens do not determine the result at the temperature.
    """
    if use_at is not None:
        use_at = convert_to_si(use_at, "temperature")
        tested_at("--use-at", use_at)
    aging = fit_aging(records, machine=machine)
    return aging if use_at is None else predict_aging(aging, temperature=use_at)


def predict_aged(
    aging: Aging,
    *,
    temperature: Quantity | None = None,
    until: str | Sequence[str] = (),
    new: Fit | None = None,
) -> AgingPrediction | Fit:
    """Return the result of :func:`predict_aging`, or the fit of a new seal after one time.

    Raises
    ------
    DataError
        As there, and if not exactly one time is given for a seal.
    """
    if new is None:
        return predict_aging(aging, temperature=temperature, until=until)
    questions = _parse_questions(until)
    if len(questions) != 1 or math.isnan(_parse_end(questions[0])[1]) or temperature is None:
        raise DataError(
            "a seal is aged for one time at one temperature. Add both: --temperature 70degC "
            "--end 10000h"
        )
    return age_fit(aging, new, temperature=temperature, time=_parse_end(questions[0])[1])


def age_fit(aging: Aging, fit: Fit, *, temperature: Quantity, time: Quantity) -> Fit:
    """Return the fit of a seal after a time at a temperature: its stiffnesses times F/F0.

    Parameters
    ----------
    aging : Aging
    fit : Fit
        Fit of the new seal.
    temperature, time : float or str
        K and s, or ``"70degC"`` and ``"10000h"``.

    Raises
    ------
    DataError
        If the ovens do not determine it, or give only a lower limit.
    """
    seconds = convert_to_si(time, "time")
    prediction = predict_aging(aging, temperature=temperature, until=f"{seconds!r}s")
    law, (reported_value, *_) = aging.law, prediction.answers
    chemical = replace(law, physical=0.0).compute_retention(prediction.temperature, seconds)
    message = f"after {format_quantity(seconds, 'h', '.6g')} at {celsius(prediction.temperature)}"
    checks = (*prediction.checks, stiffness_follows_force(1 - chemical))
    return scale_for_aging(
        fit, reported_value, message, checks=tuple(check for check in checks if check.failed)
    )


def _parse_questions(ends: str | Sequence[str] | float) -> tuple[str, ...]:
    """Return the requested ends, as parts of F0 or times."""
    return (str(ends),) if isinstance(ends, str | float | int) else tuple(map(str, ends))


def _parse_end(text: str) -> tuple[float, float]:
    """Return the fraction of F0 or the time, s, that a text states; the other is nan.

    Raises
    ------
    DataError
        If the text is neither, or out of range.
    """
    if text.strip().endswith("%"):
        try:
            part = parse_quantity(text, "strain")
        except DataError:
            part = math.nan
        if not 0.01 <= part <= 0.99:
            raise DataError(f"--end {text}: expected 1 to 99 % of the force, such as 50%")
        return part, math.nan
    try:
        time = parse_quantity(text, "time")
    except DataError:
        raise DataError(
            f"--end {text}: expected a part of the force with its sign, 50%, or a time with its "
            "unit, 1000h"
        ) from None
    if not F0_TIME < time <= MAX_LIFETIME:
        raise DataError(f"--end {text}: expected more than 30 min, and at most 30,000 years")
    return math.nan, time


def _compute_question_time(law: AgingLaw, temperature: float, part: float, time: float) -> float:
    """Return the latest time of a requested end, s."""
    return min(law.life(temperature, part), MAX_LIFETIME) if math.isnan(time) else time


def _report_end(aging: Aging, temperature: float, part: float, time: float) -> list[ReportedValue]:
    """Return the life or the retained part at an end, with its interval or lower bound.

    A life is followed by that with the lower activation energy, where there is one.
    """
    law, coldest = aging.law, aging.ovens[0].temperature
    if math.isnan(part):
        words = f"F/F0 after {format_quantity(time, 'h', '.6g')}"
        if law.is_lower_bound:
            remainder = law.lower_limit().compute_retention(temperature, time)
            return [ReportedValue("left", math.nan, remainder, math.inf, "1", None, "%", words)]
        remainder = law.compute_retention(temperature, time)
        error = law.error_of(lambda aging_law: aging_law.compute_retention(temperature, time))
        return [
            ReportedValue.from_error(
                "left", remainder, error, law.quantile, unit="1", read="%", words=words
            )
        ]
    words = f"time until F/F0 is {format_quantity(part, '%', 'g')}"
    if law.is_lower_bound or math.isinf(law.life(temperature, part)):
        shortest_life = min(law.lower_limit().life(temperature, part), MAX_LIFETIME)
        return [ReportedValue("life", math.nan, shortest_life, math.inf, "s", None, "h", words)]
    error = law.error_of(lambda aging_law: math.log(aging_law.life(temperature, part)))
    life = law.life(temperature, part)
    reported_values = [
        ReportedValue.from_error(
            "life", life, error, law.quantile, of_log=True, unit="s", read="h", words=words
        )
    ]
    lower_energy_law = apply_lower_energy(aging, temperature)
    if lower_energy_law is not None:
        label = (
            f"the same, if Ea were {format_quantity(LOWER, 'kJ/mol', 'g')} below {celsius(coldest)}"
        )

        def log_life(aging_law: AgingLaw) -> float:
            lower_energy_aging = apply_lower_energy(replace(aging, law=aging_law), temperature)
            return math.log(
                (aging_law if lower_energy_aging is None else lower_energy_aging).life(
                    temperature, part
                )
            )

        reported_values.append(
            ReportedValue.from_error(
                "life_if_Ea_falls", lower_energy_law.life(temperature, part),
                law.error_of(log_life), law.quantile, of_log=True, unit="s", read="h", words=label,
            )
        )  # fmt: skip
    return reported_values


def count_ovens_at_end_point(aging: Aging, questions: Sequence[str]) -> tuple[int | None, float]:
    """Return how many ovens reached the smallest requested fraction of F0, and the fraction."""
    parts = [part for part, _ in map(_parse_end, questions) if not math.isnan(part)]
    if not parts or aging.law.is_lower_bound:
        return None, math.nan
    part = min(parts)
    last_retained = [
        float(np.mean(oven.retained[oven.time == oven.time.max()])) for oven in aging.ovens
    ]
    return sum(value <= part for value in last_retained), part


def apply_lower_energy(aging: Aging, temperature: float) -> AgingLaw | None:
    """Return the law with a lower activation energy below the coldest oven; None without one."""
    law, coldest = aging.law, aging.ovens[0].temperature
    if law.is_lower_bound or temperature >= coldest - ONE_OVEN or law.activation <= LOWER:
        return None
    return law.apply_activation(LOWER, coldest)


def find_energy_change(
    law: AgingLaw, coldest: float, temperature: float, part: float, life_sd: float
) -> float | None:
    """Return the change of a ln life by the lower activation energy, in standard deviations.

    None at the coldest oven and above, where it is not checked, and without a lower energy.
    """
    if temperature >= coldest - ONE_OVEN or law.activation <= LOWER:
        return None
    lower = law.apply_activation(LOWER, coldest)
    change = law.compute_log_life(temperature, part) - lower.compute_log_life(temperature, part)
    return change / life_sd


def format_part(part: float) -> str:
    """Return a part of F0 as `until` takes it.

    >>> format_part(0.5)
    '50%'
    """
    return f"{100 * part:.12g}%"


def parse_part(part: float | str) -> float:
    """Return the part of F0 at the end of a life, 0.5 or ``"50%"``.

    Raises
    ------
    DataError
        If it is not between 1 and 99 %.
    """
    value, _ = _parse_end(part if isinstance(part, str) else format_part(part))
    if math.isnan(value):
        raise DataError(f"--end {part}: a plan is for a part of the force, such as 50%")
    return value


def _compute_answer_shift(
    aging: Aging, temperature: float, part: float, time: float
) -> float | None:
    """Return the change of a prediction by the lower activation energy, in standard errors."""
    law, lower_energy_law = aging.law, apply_lower_energy(aging, temperature)
    if lower_energy_law is None:
        return None

    def evaluate(aging_law: AgingLaw) -> float:
        if math.isnan(part):
            return aging_law.compute_retention(temperature, time)
        return aging_law.compute_log_life(temperature, part)

    error = law.error_of(evaluate)
    return (evaluate(law) - evaluate(lower_energy_law)) / error if 0 < error < math.inf else None


def scale_for_aging(
    fit: Fit, factor: ReportedValue, condition: str, *, checks: Sequence[Check] = ()
) -> Fit:
    r"""Return the fit of the same part after aging: every stiffness times a factor.

    .. math:: C' = f^2 C + \sigma_f^2\,k k^T

    for the stiffnesses k, with the error of the factor f in the covariance: it is one of all.

    Parameters
    ----------
    factor : ReportedValue
        The retained fraction after aging, and its standard error.
    condition : str
        Duration of aging as text.
    checks : sequence of Check
        Checks of the factor.

    Raises
    ------
    DataError
        If the fraction is not known, or only its lower limit.
    """
    error = factor.error or 0.0
    if factor.is_lower_bound or not np.isfinite(error):
        raise DataError(
            f"a fit is scaled by a number that is known, and this is not: {factor.text}. Use a "
            "hotter oven, or read longer"
        )
    step = Step(
        "aging",
        (("left", repr(factor.value)), ("of", fit._identity)),
        f"{factor.value:.4g} of fit {fit._identity} is left {condition}",
    )
    scaled_fit = scale_stiffness(fit, factor.value, step)
    values = {item.name: item.value for item in fit.estimate.list_values(fit.solid, fit.unit)}
    k = np.array([values.get(name, 0.0) for name in fit.estimate.parameters])
    estimate, factor_covariance = scaled_fit.estimate, error**2 * np.outer(k, k)
    noise_covariance = (
        None if estimate.noise_covariance is None else estimate.noise_covariance + factor_covariance
    )
    return replace(
        scaled_fit,
        estimate=replace(
            estimate,
            covariance=estimate.covariance + factor_covariance,
            noise_covariance=noise_covariance,
            profiles=(),
        ),
        evidence=replace(scaled_fit.evidence, checks=(*fit.checks, *checks)),
    )
