"""Values of a result that may have limits, each with its 95 % interval and its kind."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable
from functools import partial, singledispatch
from typing import Any, Literal, NamedTuple

import numpy as np

from dashpot.base import replace
from dashpot.base.errors import DataError
from dashpot.base.number_format import duration, round_to_error
from dashpot.base.number_format import hertz as format_frequencies
from dashpot.base.reported_values import NORMAL, ReportedValue
from dashpot.base.units import Dimension, find_unit, format_quantity, parse_quantity
from dashpot.datamodel.fit import Fit
from dashpot.fitting.prediction_bounds import off_by_error, parameter_band
from dashpot.registry import find_handler
from dashpot.solids.maxwell import Solid
from dashpot.workflow.identification import IdentificationResult
from dashpot.workflow.measured_frf import Modes
from dashpot.workflow.recommended_solid import Recommendation, RecommendedValue, recommend_solid
from dashpot.workflow.study import Study

Spread = Literal["random", "bound", "unknown"]
"""Origin of an interval: noise, a bound that no such test determines, or unknown."""

_SYNONYMS = {
    "damping": "damping_ratio", "damping ratio": "damping_ratio", "loss factor": "loss_factor",
    "resonance": "frequency", "peak frequency": "frequency", "peak height": "peak",
    "storage stiffness": "storage", "dynamic stiffness": "storage",
    "storage modulus": "storage", "modulus": "stiffness", "equilibrium stiffness": "k_inf",
    "stiffness at the end": "k_end", "lifetime": "life", "e_end": "k_end", "e_inf": "k_inf",
}  # fmt: skip
_RECOMMENDED_QUANTITIES = {
    "frequency": "frequency", "damping_ratio": "damping", "peak": "peak",
    "loss_factor": "loss factor", "storage": "dynamic stiffness",
}  # fmt: skip
"""Names of quantities, and their names in a recommendation."""
_WORDS = {
    "frequency": "peak frequency", "damping_ratio": "damping ratio", "peak": "peak height",
    "storage": "storage", "loss_factor": "loss factor",
}  # fmt: skip
_BOUND_RATIO = 1.1
"""Ratio to the interval of the parameters above which a bound is not random."""
_TIME_TOLERANCE = 0.01
"""Relative difference below which a time counts as the end of the hold."""


class ResultValue(NamedTuple):
    """Value of a result, with the origin of its interval.

    Attributes
    ----------
    column : str
        Its name, as a lot calls it: ``"damping_ratio"``, ``"loss_factor_at_12.7Hz"``.
    fact : ReportedValue
        With its words, 95 % interval and units.
    spread : str
        ``"random"`` for noise of the test; ``"bound"`` for limits of a quantity that no such test
        determines; ``"unknown"`` where that or the interval is not known.
    remedy : str
        Tests that would narrow a bound, in sentences; empty if unknown.
    noise_share : float
        For a random interval: the standard error of noise over that of noise and rig.
    """

    column: str
    fact: ReportedValue
    spread: Spread
    remedy: str = ""
    noise_share: float = 1.0

    @property
    def unit(self) -> str:
        """Unit in which the quantity is shown; empty for a plain number."""
        return "" if self.fact.reading == "1" else self.fact.reading

    @property
    def dimension(self) -> Dimension | None:
        """Dimension of the quantity; None for a plain number."""
        unit = find_unit(self.fact.unit)
        return None if unit is None or unit.dimension == "strain" else unit.dimension


class _Name(NamedTuple):
    """Name of a quantity, and its frequency or time: ``"loss_factor"``, ``"12.7Hz"``."""

    word: str
    place: str

    @property
    def column(self) -> str:
        return "_at_".join(filter(None, (self.word, self.place)))

    def place_in(self, dimension: Dimension) -> float:
        """Return the time or frequency, SI."""
        value = parse_quantity(self.place, dimension)
        if not value > 0:
            raise DataError(f"{self.place} is no {dimension} at which it is known; give one > 0")
        return value


def _parse_name(text: str) -> _Name:
    """Return the quantity that a text names.

    >>> _parse_name("Loss factor at 12.7 Hz").column
    'loss_factor_at_12.7Hz'
    """
    spaced_text = " ".join(text.replace("_", " ").split())
    word, _, position_text = (
        part.strip() for part in re.sub(" after ", " at ", spaced_text).partition(" at ")
    )
    lower_case = word.lower()
    exact = "_".join(word.split())
    name = _SYNONYMS.get(spaced_text.lower()) or _SYNONYMS.get(lower_case)
    return _Name(
        name or exact, "" if spaced_text.lower() in _SYNONYMS else position_text.replace(" ", "")
    )


def find_value(result: Any, name: str) -> ResultValue:
    """Return the value of a result that a name means.

    Parameters
    ----------
    result : Study, Fit or another result that reports values
    name : str
        Such as ``"frequency"``, ``"damping"``, ``"peak"``, ``"k_end"``, ``"stiffness at 40s"``,
        ``"force at 40s"``, ``"loss factor at 12.7Hz"``, or a value that the result reports.

    Raises
    ------
    DataError
        If the result has no such value.
    """
    parsed = _parse_name(name)
    bound_value = find_handler("bound value", result)
    bound_value_result = None if bound_value is None else bound_value(result, parsed.column)
    if bound_value_result is not None:
        return ResultValue(parsed.column, bound_value_result[0], "bound", bound_value_result[1])
    value = _find_by_name(result, parsed)
    if value is None:
        available_names = ", ".join(dict.fromkeys(list_names(result)))
        raise DataError(
            f"'{name}' is no value of this result; there are {available_names}"
            if available_names
            else f"'{name}': this kind of result takes no limits"
        )
    return value


def list_names(result: Any) -> list[str]:
    """Return the names of the values of a result."""
    if isinstance(result, Study):
        advice = recommend_solid(result)
        answered = {value.quantity for value in advice.mass_values}
        names = [name for name, word in _RECOMMENDED_QUANTITIES.items() if word in answered]
        return [*names, "force at TIME", *list_names(advice.solid)]
    if isinstance(result, IdentificationResult):
        modes = [] if result.vibration is None else list_names(result.vibration)
        return [*modes, *list_names(result.fit)]
    if isinstance(result, Modes):
        return ["frequency", "damping_ratio"]
    reported_values = [
        _get_column(reported_value) for reported_value in getattr(result, "facts", ())
    ]
    if isinstance(result, Fit):
        end = [] if result.evidence.end_of_hold is None else ["k_end"]
        return [*end, "stiffness at TIME", "storage at FREQUENCY", "loss_factor at FREQUENCY",
                *reported_values]  # fmt: skip
    return reported_values


def _get_column(reported_value: ReportedValue) -> str:
    """Return the name of a reported value as one word."""
    return "_".join(reported_value.name.split())


@singledispatch
def _find_by_name(result: Any, name: _Name) -> ResultValue | None:
    """Return a value of a result by its name; None if no value has that name."""
    reported_values: Iterable[ReportedValue] = getattr(result, "facts", ())
    matches = [
        reported_value
        for reported_value in reported_values
        if _get_column(reported_value) == name.column
    ]
    return _make_reported_value(name.column, matches[0]) if matches else None


def _make_reported_value(column: str, reported_value: ReportedValue) -> ResultValue:
    """Return a reported value; one that is at most so much is bounded by 0 from below."""
    if reported_value.is_at_most:
        reported_value = replace(reported_value, low=0.0, error=None)
        return ResultValue(column, reported_value, "bound")
    if reported_value.is_lower_bound or reported_value.is_upper_bound:
        return ResultValue(column, reported_value, "bound")
    is_known = reported_value.error is not None and math.isfinite(reported_value.error)
    return ResultValue(
        column, reported_value, "random" if is_known and reported_value.has_interval else "unknown"
    )


@_find_by_name.register
def _(result: Modes, name: _Name) -> ResultValue | None:
    """Return frequency or damping ratio of the mode that moves most."""
    if name.word not in {"frequency", "damping_ratio"} or not len(result):
        return None
    frequency, damping, _ = result[0].facts
    reported_value = frequency if name.word == "frequency" else damping
    return _make_reported_value(name.word, reported_value)


@_find_by_name.register
def _(result: IdentificationResult, name: _Name) -> ResultValue | None:
    """Return a value of the measured modes, or of the fit."""
    value = None if result.vibration is None else _find_by_name(result.vibration, name)
    return value or _find_by_name(result.fit, name)


@_find_by_name.register
def _(study: Study, name: _Name) -> ResultValue | None:
    """Return a value of the mass on its seals, or of one seal."""
    advice = recommend_solid(study)
    if name.word == "force" and name.place:
        return _find_force(study, advice.solid, name)
    answer = _RECOMMENDED_QUANTITIES.get(name.word)
    if answer is not None and not name.place:
        answers = (*advice.mass_values, *advice.seal_values)
        items = (item for item in answers if item.quantity == answer)
        return next((_make_answer_value(name, item, advice) for item in items), None)
    unmeasured = study.unmeasured
    if not advice.joint and unmeasured is not None and name.word in {"storage", "loss_factor"}:
        hertz = name.place_in("frequency")
        if unmeasured.frequency[0] <= hertz <= unmeasured.frequency[-1]:
            low, high = (
                float(np.interp(np.log(hertz), np.log(unmeasured.frequency), edge))
                for edge in getattr(unmeasured, name.word)
            )
            return _make_frequency_value(advice.solid, name, hertz, (low, high), "bound")
    return _find_by_name(advice.solid, name)


def _make_answer_value(name: _Name, value: RecommendedValue, advice: Recommendation) -> ResultValue:
    """Return a value of a recommendation.

    As there, a frequency depends on the stiffness at the peak, damping and height on the loss
    factor.
    """
    reported_value, position_text = value.fact, ""
    hertz = next(item.at for item in advice.seal_values if item.quantity == "dynamic stiffness")
    part = "storage" if name.word in {"frequency", "storage"} else "loss_factor"
    if name.word in {"loss_factor", "storage"} and value.at is not None:
        position_text = f" at {round_to_error(value.at)} Hz"
    words = _WORDS[name.word] + position_text
    reported_value = replace(reported_value, error=None, words=words)
    if not reported_value.has_interval or value.is_limit:
        return ResultValue(name.column, reported_value, "bound" if value.is_limit else "unknown")
    share = _compute_noise_share(advice.solid, partial(_evaluate_at, part=part, hertz=hertz or 0.0))
    return ResultValue(name.column, reported_value, "random", noise_share=share)


def _evaluate_at(solid: Solid, *, part: str, hertz: float) -> float:
    """Return storage or loss factor of a solid at a frequency, Hz."""
    return float(getattr(solid, part)(frequency=hertz))


def _propagate_error(fit: Fit, evaluate: Callable[[Solid], float]) -> float:
    """Return the standard error of a value of the solid, to first order; nan if unknown."""
    value = evaluate(fit.solid)
    changes = [evaluate(solid) - value for solid in off_by_error(fit)]
    return math.hypot(*changes) if changes else math.nan


def _compute_noise_share(fit: Fit, evaluate: Callable[[Solid], float]) -> float:
    """Return the standard error of noise over that of noise and rig."""
    noise_fit = replace(fit, estimate=fit.estimate.noise_only)
    total, noise = (_propagate_error(item, evaluate) for item in (fit, noise_fit))
    return min(noise / total, 1.0) if total > 0 else 1.0


@_find_by_name.register
def _(fit: Fit, name: _Name) -> ResultValue | None:
    """Return a value of a fitted solid: at a time, at a frequency, or one of its parameters."""
    end = fit.evidence.end_of_hold
    if name.word == "k_end" and not name.place and end is not None:
        if end.test_kind == "hold":
            return _find_at_time(fit, name, end.end_time)
        return ResultValue("k_end", end.fact(fit.solid, fit.unit), "bound", end.remedy)
    if name.word == "stiffness" and name.place:
        return _find_at_time(fit, name, name.place_in("time"))
    if name.word in {"storage", "loss_factor"} and name.place:
        return _find_at_frequency(fit, name)
    value = _find_by_name.dispatch(object)(fit, name)
    if value is None or value.spread != "random" or not value.fact.error:
        return value
    noise_values = fit.estimate.noise_only.list_values(fit.solid, fit.unit)
    noise = {item.name: item.error for item in noise_values}.get(value.fact.name)
    return value._replace(noise_share=min((noise or math.inf) / value.fact.error, 1.0))


def _format_time(seconds: float) -> str:
    return duration(seconds).replace(".0 ", " ")


def _find_at_time(fit: Fit, name: _Name, t: float) -> ResultValue:
    """Return the relaxation function at a time after the ramp, N/m."""
    label = "modulus" if fit.unit == "Pa" else "stiffness"

    def find_at(time: float) -> ResultValue:
        return _make_time_value(
            fit, name, time, lambda solid: float(solid.relaxation(time)), unit=fit.unit, label=label
        )

    result, fastest = find_at(t), 1 / (2 * math.pi * fit.band[1]) if fit.band[1] > 0 else 0.0
    if t >= fastest:
        return result
    # arms that the ramp hides add to it, and nothing bounds them; it never is below a later value
    low = min(find_at(fastest).fact.low, result.fact.value)
    reported_value = replace(result.fact, low=low, high=math.nan)
    remedy = (
        f"{_format_time(t)} is shorter than the test shows: its valid band is "
        f"{format_frequencies(fit.band)}."
    )
    return ResultValue(result.column, reported_value, "bound", remedy)


def _find_force(study: Study, fit: Fit, name: _Name) -> ResultValue:
    """Return the force of one seal at a time after the ramp of the test, N."""
    t, test = name.place_in("time"), study.prepared
    ramp = max(test.ramp_end - test.onset, 1e-6)

    def compute_force(solid: Solid) -> float:
        force = solid.maxwell.ramp_hold_force(t + ramp, depth=test.depth, ramp_time=ramp)
        return float(force)

    label = f"force at {format_quantity(test.depth, 'mm', '.3g')}"
    return _make_time_value(fit, name, t, compute_force, unit="N", label=label)


def _make_time_value(
    fit: Fit, name: _Name, t: float, evaluate: Callable[[Solid], float], *, unit: str, label: str
) -> ResultValue:
    """Return a value at a time with the wider of two intervals, each relative to the value.

    One follows from the covariance, by one standard error along each of its axes. The other is that
    of the limits over every spectrum that the test does not reject, at the end of the hold or after
    it.
    """
    value, half_width = evaluate(fit.solid), NORMAL * _propagate_error(fit, evaluate)
    low, high, remedy = value - half_width, value + half_width, ""
    spread_kind: Spread = "unknown" if math.isnan(half_width) else "random"
    end = fit.evidence.end_of_hold
    if end is not None and not end.is_frequency and end.test_kind != "creep":
        remedy = end.remedy
        reference, last = end.compute_stiffness(fit.solid), end.end_time
        lower, upper = end.k_end
        if t > last * (1 + _TIME_TOLERANCE):
            # the stiffness falls with time, so its upper limit at the end holds later, too
            lower = end.k_3end[0] if t <= 3 * last else end.k_inf[0]
            reference = float(fit.solid.relaxation(t))
        bounds = value * lower / reference, value * upper / reference
        if not bounds[1] - bounds[0] <= _BOUND_RATIO * (high - low):
            spread_kind = "bound"
        if abs(t - last) <= _TIME_TOLERANCE * last or math.isnan(half_width):
            low, high = bounds  # the interval that every output has
        else:
            low, high = min(low, bounds[0]), max(high, bounds[1])
    words = f"{label} after {_format_time(t)}"
    reported_value = ReportedValue(
        name.word, value, min(low, value), max(high, value), unit, words=words
    )
    return ResultValue(
        name.column, reported_value, spread_kind, remedy, _compute_noise_share(fit, evaluate)
    )


def _find_at_frequency(fit: Fit, name: _Name) -> ResultValue:
    """Return storage or loss factor at a frequency; beyond the valid band without an interval."""
    hertz = name.place_in("frequency")
    low_band, high_band = fit.band
    if not low_band <= hertz <= high_band:
        remedy = f"It lies outside the valid band of the test, {format_frequencies(fit.band)}."
        unknown = _make_frequency_value(fit, name, hertz, (math.nan, math.nan), "bound")
        return unknown._replace(remedy=remedy)
    bounds = parameter_band(fit, [hertz])
    low, high = (float(edge[0]) for edge in getattr(bounds, name.word))
    error = fit.evidence.band_error
    share = _compute_noise_share(fit, partial(_evaluate_at, part=name.word, hertz=hertz))
    if error is None:
        return _make_frequency_value(fit, name, hertz, (low, high), "random")._replace(
            noise_share=share
        )
    errors = error.stiffness if name.word == "storage" else error.loss_factor
    factor = 1 + float(np.interp(np.log(hertz), np.log(error.frequency), errors))
    value = float(getattr(fit.solid, name.word)(frequency=hertz))
    is_wider = value * factor - value / factor > _BOUND_RATIO * (high - low)
    spread_kind: Spread = "bound" if is_wider else "random"
    interval = min(low, value / factor), max(high, value * factor)
    return _make_frequency_value(fit, name, hertz, interval, spread_kind)._replace(
        noise_share=share
    )


def _make_frequency_value(
    fit: Fit, name: _Name, hertz: float, interval: tuple[float, float], spread_kind: Spread
) -> ResultValue:
    value = float(getattr(fit.solid, name.word)(frequency=hertz))
    words = f"{_WORDS[name.word]} at {round_to_error(hertz)} Hz"
    unit = "" if name.word == "loss_factor" else fit.unit
    low, high = interval
    interval = interval if math.isnan(low) else (min(low, value), max(high, value))
    return ResultValue(
        name.column, ReportedValue(name.word, value, *interval, unit, words=words), spread_kind
    )
