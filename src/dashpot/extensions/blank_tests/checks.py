"""Criteria on blank tests."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from dashpot.base.checks import Check, Finding, Remedy, criterion
from dashpot.base.reported_values import ReportedValue
from dashpot.base.units import convert_to_unit, format_quantity, parse_quantity
from dashpot.datamodel.machine import DEFAULT_UNCERTAINTIES

if TYPE_CHECKING:
    from dashpot.extensions.blank_tests.estimation import Blanks, EmptyRun, Press

MAX_COMPLIANCE = parse_quantity("200um/N", "compliance")
"""Compliance beyond which no machine is rigid enough for a seal."""
MAX_CREEP = parse_quantity("30um", "length")
"""Creep in a factor e of time beyond which no crosshead settles."""
_CLEAR_ERRORS = 3.0
"""Standard errors beyond which a departure is no chance."""
_DELAY_TOLERANCE = parse_quantity("0.2ms", "time")
_CREEP_TOLERANCE = parse_quantity("1.5um", "length")
"""Difference of two records of one machine beyond their errors."""
MAX_DELAY_ERROR = 0.1 * DEFAULT_UNCERTAINTIES["delay"].size
"""Standard error of a delay, s, above which a machine file is hardly better than the default."""
_CELL_CLASS = 1.035
"""Largest gain of a load cell of the lowest class (3 %), measured with a spring known to 0.5 %."""


def run_checks(blanks: Blanks, values: Sequence[ReportedValue]) -> tuple[Check, ...]:
    """Return every check of blank tests."""
    reported_values = {value.name: value for value in values}
    stop_tests, springs, empties = blanks.stop_presses, blanks.spring_presses, blanks.empty_runs
    stop, spring = next(iter(stop_tests), None), next(iter(springs), None)
    empty = next(iter(empties), None)
    return (
        blank_tests_complete(bool(stop_tests), bool(springs), bool(empties)),
        stop_rigid(None if stop is None else reported_values["compliance"].value),
        stop_force_straight(_find_worst(stop_tests, _measure_bend)),
        stop_force_returns(_find_worst(stop_tests, lambda press: press.hysteresis)),
        stop_follows_machine(_find_worst(stop_tests, lambda press: press.misfit)),
        crosshead_creep_plausible(_find_worst(blanks.presses, lambda press: press.creep.value)),
        spring_force_straight(_find_worst(springs, _measure_bend)),
        spring_force_returns(_find_worst(springs, lambda press: press.hysteresis)),
        spring_follows_machine(_find_worst(springs, lambda press: press.misfit)),
        stop_and_spring_creep_agree(*_compare_estimates(stop, spring, "creep", _CREEP_TOLERANCE)),
        stop_and_spring_delay_agree(*_compare_estimates(stop, spring, "delay", _DELAY_TOLERANCE)),
        repeated_stops_agree(_measure_repeats(stop_tests)),
        repeated_springs_agree(_measure_repeats(springs)),
        delay_determined(reported_values["delay"].error if springs else None),
        gain_plausible(reported_values["gain"].value if "gain" in reported_values else None),
        empty_run_force_free_of_motion(empty),
        empty_run_plate_steady(None if empty is None else empty.unsteady_share),
        empty_run_force_steady(empty),
    )


def _find_worst(records: Sequence[Press], measure: Callable[[Press], float]) -> float | None:
    """Return the measure of largest size over some records; None where it is nan in all."""
    values = [value for value in map(measure, records) if not math.isnan(value)]
    return max(values, key=abs, default=None)


def _measure_bend(press: Press) -> float:
    """Return the curvature of a force, over its peak, less three of its standard errors."""
    value, error = press.curvature
    return math.copysign(max(abs(value) - _CLEAR_ERRORS * error, 0.0), value)


def _measure_repeats(records: Sequence[Press]) -> float | None:
    """Return by how much the stiffness of repeats differs beyond chance, over the smallest."""
    if len(records) < 2:
        return None
    stiffest = max((press.stiffness for press in records), key=lambda estimate: estimate.value)
    softest = min((press.stiffness for press in records), key=lambda estimate: estimate.value)
    chance = _CLEAR_ERRORS * math.hypot(stiffest.error, softest.error)
    return max(stiffest.value - softest.value - chance, 0.0) / softest.value


def _compare_estimates(
    stop: Press | None, spring: Press | None, name: str, tolerance: float
) -> tuple[float | None, float, float]:
    """Return the difference of two records in standard errors, and the value of each.

    Errors are at least those of a repeat, `tolerance` at three standard errors.
    """
    if stop is None or spring is None:
        return None, 0.0, 0.0
    first, second = getattr(stop, name), getattr(spring, name)
    difference_sd = math.hypot(first.error, second.error, tolerance / _CLEAR_ERRORS)
    return (first.value - second.value) / difference_sd, first.value, second.value


@criterion("kinds of blank tests", ">=", 3.0, "by definition", grade="note")
def blank_tests_complete(stop: bool, spring: bool, has_empty_run: bool) -> Finding:
    """There are a stop, a spring and an empty run."""
    missing = [
        text
        for text, is_recorded in (
            ("A rigid stop gives compliance and creep", stop),
            ("A spring gives gain and delay", spring),
            ("An empty run gives noise, drift and hum", has_empty_run),
        )
        if not is_recorded
    ]
    return Finding(
        "A rigid stop, a spring and an empty run were recorded",
        float(3 - len(missing)),
        remedy="Record what is missing.",
        failure=f"Not every blank test was recorded. {'. '.join(missing)}",
    )


@criterion("m/N", "<=", MAX_COMPLIANCE, "our choice: four times a usual machine")
def stop_rigid(compliance: float | None) -> Finding:
    """The stop is stiff relative to usual machines."""
    if compliance is None:
        return Finding("No stop was pressed, so its stiffness is not checked")
    return Finding(
        f"The stop and the machine give {format_quantity(compliance, 'um/N', '.3g')}",
        compliance,
        "A stop that gives itself is taken for the machine",
        "Press steel on steel, without a pad.",
    )


@criterion("fraction of the largest force", "|x| <=", 0.03, "our choice")
def stop_force_straight(nonlinearity: float | None) -> Finding:
    """The force of the stop rises in proportion."""
    if nonlinearity is None:
        return Finding("No stop was pressed, so its force is not checked")
    return Finding(
        f"At half its load the stop's force is {_format_percent(nonlinearity)} off a straight line",
        nonlinearity,
        "The machine has no single compliance, or the stop touches with a corner",
        "Press on a flat and level stop.",
    )


@criterion("fraction of the largest force", "|x| <=", 0.02, "our choice: play of a crosshead")
def stop_force_returns(difference: float | None) -> Finding:
    """The stop gives the same force on the way back."""
    return _judge_return("stop", difference, "It is rubber, or the crosshead has play")


@criterion("fraction of the largest force", "<=", 0.005, "our choice")
def stop_follows_machine(misfit: float | None) -> Finding:
    """The model of a rigid stop fits the record."""
    return _judge_misfit("stop", misfit, "It relaxes as rubber does, or it slipped")


@criterion("m", "|x| <=", MAX_CREEP, "three usual standard deviations at 8 mm")
def crosshead_creep_plausible(creep: float | None) -> Finding:
    """The creep of the crosshead is in the usual range."""
    if creep is None:
        return Finding("Nothing was pressed, so creep is not checked")
    return Finding(
        f"In a factor e of time the record creeps by {format_quantity(creep, 'um', '.2g')}",
        creep,
        "What was pressed relaxes, as rubber does",
        "Press steel, without a pad.",
    )


@criterion("fraction of the largest force", "|x| <=", 0.005, "our choice: a calibrated spring")
def spring_force_straight(nonlinearity: float | None) -> Finding:
    """The force of the spring rises in proportion."""
    if nonlinearity is None:
        return Finding("No spring was pressed, so its force is not checked")
    return Finding(
        f"At half its load the spring's force is {_format_percent(nonlinearity)} off a straight "
        "line",
        nonlinearity,
        "The spring has no single stiffness, so the gain is off by as much",
        "Use a spring with ground ends, and press it from a small force on.",
    )


@criterion(
    "fraction of the largest force", "|x| <=", 0.003, "our choice: friction of a good spring"
)
def spring_force_returns(difference: float | None) -> Finding:
    """The spring gives the same force on the way back."""
    return _judge_return("spring", difference, "It rubs or is no steel, so gain and delay are off")


@criterion("fraction of the largest force", "<=", 0.002, "our choice")
def spring_follows_machine(misfit: float | None) -> Finding:
    """The model of a spring in the machine fits the record."""
    return _judge_misfit("spring", misfit, "It relaxes, rubs, or left its seat")


@criterion("difference / standard error", "|x| <=", _CLEAR_ERRORS, "chance, once in 370")
def stop_and_spring_creep_agree(difference: float | None, stop: float, spring: float) -> Finding:
    """Stop and spring show the same creep of the crosshead."""
    if difference is None:
        return Finding("One of stop and spring is missing, so their creep is not compared")
    return Finding(
        f"The crosshead creeps by {format_quantity(stop, 'um', '.2g')} on the stop and "
        f"{format_quantity(spring, 'um', '.2g')} on the spring",
        difference,
        "One of them relaxes itself, or the load cell creeps",
        "Press steel without a pad. Check the load cell with a dead weight.",
    )


@criterion("difference / standard error", "|x| <=", _CLEAR_ERRORS, "chance, once in 370")
def stop_and_spring_delay_agree(difference: float | None, stop: float, spring: float) -> Finding:
    """Stop and spring show the same delay between the channels."""
    if difference is None:
        return Finding("One of stop and spring is missing, so their delay is not compared")
    return Finding(
        f"The force is late by {format_quantity(stop, 'ms', '.2g')} on the stop and "
        f"{format_quantity(spring, 'ms', '.2g')} on the spring",
        difference,
        "The delay changes from record to record, or one of them rubs",
        "Start both channels by one clock, and repeat.",
    )


@criterion("fraction of the stiffness", "<=", 0.1, "our choice: contact of steel on steel")
def repeated_stops_agree(difference: float | None) -> Finding:
    """Repeated stops show the same stiffness."""
    return _judge_repeats(
        "stop", difference, "One of them was no rigid stop, or was mounted otherwise"
    )


@criterion("fraction of the stiffness", "<=", 0.01, "our choice: a calibrated spring")
def repeated_springs_agree(difference: float | None) -> Finding:
    """Repeated springs show the same stiffness."""
    return _judge_repeats("spring", difference, "They were two springs, or one left its seat")


@criterion("s", "<=", MAX_DELAY_ERROR, "our choice: a tenth of what is usual")
def delay_determined(error: float | None) -> Finding:
    """The spring determines the delay of the force."""
    if error is None:
        return Finding("No spring was pressed, so the error of the delay is not checked")
    return Finding(
        f"The delay is known to {format_quantity(error, 'ms', '.2g')}",
        error,
        "The zero of the force moved in the record, something slipped, or the ramp is too slow",
        "Press a spring in a second or less, and touch nothing until its record ends.",
    )


@criterion("factor", "x/", _CELL_CLASS, "ISO 7500-1: class 3, the lowest, is within 3 %")
def gain_plausible(gain: float | None) -> Finding:
    """The gain is that of a calibrated cell."""
    if gain is None:
        return Finding("No spring of known stiffness and stop were pressed, so there is no gain")
    return Finding(
        f"The force reads {gain:.4g} times what it is",
        gain,
        "The spring's stiffness or a unit is wrong",
        Remedy("Check the spring, and the units of the channels.", "spring-stiffness", "1N/mm"),
    )


@criterion("force by motion / its standard error", "<=", 5.0, "chance, once in a million")
def empty_run_force_free_of_motion(run: EmptyRun | None) -> Finding:
    """The force of the empty run does not follow the plate."""
    if run is None:
        return Finding("No empty run was recorded, so its force is not checked")
    if not run.motion_error:
        return Finding(
            "The plate rests in the empty run, so nothing follows it", always_passes=True
        )
    return Finding(
        f"Up to {format_quantity(run.motion_force, 'mN', '.2g')} follow the motion of the plate",
        run.motion_force / run.motion_error,
        "The sensor moves along, a cable pulls, or the run was not empty",
        "Repeat with cable and sensor fastened, and free plates.",
        always_passes=run.motion_force < run.noise.value / 2,
    )


@criterion("part of the record", "<=", 0.15, "our choice")
def empty_run_plate_steady(unsteady_share: float | None) -> Finding:
    """The plate of the empty run either rests or moves."""
    if unsteady_share is None:
        return Finding("No empty run was recorded, so its plate is not checked")
    return Finding(
        f"For {_format_percent(unsteady_share)} of the empty run the plate neither rests nor "
        "travels",
        unsteady_share,
        "Its sensor moves by itself",
        "Repeat with the displacement sensor fastened.",
    )


@criterion("scatter of means / scatter", "<=", 0.2, "our choice: twice that behind 10 Hz")
def empty_run_force_steady(run: EmptyRun | None) -> Finding:
    """The force of the empty run has no slow wander beside its drift."""
    if run is None:
        return Finding("No empty run was recorded, so its noise is not checked")
    return Finding(
        f"The force scatters by {format_quantity(run.noise.value, 'mN', '.2g')}, and its means "
        f"over a twentieth of the record by {format_quantity(run.slow_noise, 'mN', '.2g')}",
        run.slow_noise / run.noise.value if run.noise.value > 0 else None,
        "Something moves or warms the sensor",
        "Let the amplifier warm up, and repeat.",
    )


def _judge_return(name: str, difference: float | None, reason: str) -> Finding:
    if difference is None:
        return Finding(f"No {name} was released in its record, so its way back is not checked")
    return Finding(
        f"On the way back the {name}'s force is {_format_percent(difference)} of the largest off",
        difference,
        reason,
        f"Use a {'steel block' if name == 'stop' else 'calibrated steel spring'}.",
    )


def _judge_repeats(name: str, difference: float | None, reason: str) -> Finding:
    if difference is None:
        return Finding(f"Not more than one {name} was pressed, so none are compared")
    return Finding(
        f"The stiffness of the {name}s differs by {_format_percent(difference)}",
        difference,
        reason,
        "Repeat what differs, and leave out the other record.",
    )


def _judge_misfit(name: str, misfit: float | None, reason: str) -> Finding:
    if misfit is None:
        return Finding(f"No {name} was pressed, so it is not compared with the machine's model")
    return Finding(
        f"The {name}'s force departs from the machine's model by {_format_percent(misfit)}",
        misfit,
        reason,
        "Look at the figure, and repeat.",
    )


def _format_percent(part: float) -> str:
    return f"{convert_to_unit(part, '%'):.2g} %"
