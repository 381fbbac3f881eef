"""Leak speeds of a door file."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from dashpot.base import replace
from dashpot.base.checks import Check
from dashpot.base.errors import DataError
from dashpot.base.reported_values import NORMAL
from dashpot.datamodel.checks import temperature_tested
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.seal_line import SealSection
from dashpot.extensions.systems.door import checks
from dashpot.extensions.systems.door.analyse_file import (
    add_file_to_errors,
    check_contact,
    open_door,
)
from dashpot.extensions.systems.door.door_model import Door
from dashpot.extensions.systems.door.leak_analysis import Interval, SectionState, find_leak
from dashpot.extensions.systems.door.leak_result import LeakResult
from dashpot.extensions.systems.door.leak_setup import (
    NEW_STATE,
    STANDARD_TEMPERATURE,
    LeakState,
    compute_air_density,
)
from dashpot.registry import find_handler
from dashpot.vibration.checks import compression_tested
from dashpot.workflow.json_archive import read_fit, read_json_document


def find_leak_speeds(path: str | Path | Door, *, temperature: float | None = None) -> LeakResult:
    """Return the speeds at which the seal of a door lifts, at each station and in each state.

    Parameters
    ----------
    path : path or Door
        TOML, as :func:`~dashpot.extensions.systems.door.read.read_door` reads it.
    temperature : float, optional
        Temperature of the new seal, K, in place of the value in the file.

    Raises
    ------
    ReadError
        If a file cannot be read, or holds an impossible value.
    DataError
        If the file lacks values for a leak speed.
    """
    assembly, fit = open_door(path, temperature=temperature)
    door = assembly.door
    with add_file_to_errors(path):
        if door.leak is None:
            raise DataError(
                "no [leak] is in it, and a leak speed needs the width on which the pressure acts: "
                'add [leak] with lip = "10mm"'
            )
        if fit is None or door.line is None or door.seal is None or door.line.section is None:
            raise DataError("no [seal] is in it; add one with fit, points and compression")
        stations = door.line.stations(door.pitch)
        compression = stations.compression
        if compression is None:
            raise DataError(
                "how far the seal is pressed is not said: give compression, or gap and height, in "
                "[seal]"
            )
        seal_fit = read_fit(door.seal.fit)
        seal_temperature = door.seal.temperature if temperature is None else temperature
        cases = []
        aging_checks: list[Check] = []
        for state in (LeakState(NEW_STATE), *door.leak.states):
            temperature_there = seal_temperature if state.temperature is None else state.temperature
            fit_there = (
                seal_fit
                if temperature_there is None
                else seal_fit.at_temperature(temperature_there)
            )
            section = SealSection.from_fit(fit_there, length=door.seal.length)
            air_temperature = (
                STANDARD_TEMPERATURE if temperature_there is None else temperature_there
            )
            density = (
                compute_air_density(air_temperature) if state.density is None else state.density
            )
            retention, failed_checks = _evaluate_retention(state)
            aging_checks += failed_checks
            cases.append((fit_there, SectionState(state, section, density, retention)))
        leaks = tuple(
            find_leak(
                case, door.leak, fit=fit_there, compression=compression, factor=stations.factor
            )
            for fit_there, case in cases
        )
        result = LeakResult(door, door.leak, fit, stations, compression, leaks, ())
        leak_checks = _run_checks(result, [(case.state, fit_there) for fit_there, case in cases])
        all_checks = (*leak_checks, *aging_checks)
    return replace(result, checks=all_checks)


def _evaluate_retention(state: LeakState) -> tuple[Interval, list[Check]]:
    """Return the fraction of force after aging, with 95 % limits, and its failed checks."""
    aging = state.aging
    if aging is None:
        half_width = NORMAL * state.retained_sd
        low, high = max(state.retained - half_width, 0.0), min(state.retained + half_width, 1.0)
        return Interval(state.retained, low, high), []
    document = read_json_document(aging.law_path)
    predict = find_handler("retained force", document)
    if predict is None:
        raise DataError(
            f"{aging.law_path} holds no aging law; expected a fit of compression stress relaxation "
            "(dashpot fit ovens.csv -o csr.json)"
        )
    predicted = predict(document, temperature=aging.temperature, until=f"{aging.time!r}s")
    predicted_force = predicted.answers[0]
    location = f"in state '{state.name}'"
    failed_checks = [check.with_location(location) for check in predicted.checks if check.failed]
    if np.isnan(predicted_force.value):  # the ovens bound what is left from below alone
        return Interval(predicted_force.low, predicted_force.low, 1.0), failed_checks
    low, high = (
        (predicted_force.low, predicted_force.high)
        if np.isfinite([predicted_force.low, predicted_force.high]).all()
        else (0.0, 1.0)
    )
    return Interval(min(predicted_force.value, 1.0), max(low, 0.0), min(high, 1.0)), failed_checks


def _run_checks(result: LeakResult, states: list[tuple[LeakState, Fit]]) -> Iterator[Check]:
    """Iterate over the checks of leak speeds, each state with the fit at its temperature."""
    fit, compression = result.fit, result.compression
    yield check_contact(compression, result.arc_length, result.stations.length.sum())
    law = fit.elastic_law
    yield compression_tested(float(compression.max()), None if law is None else law.depth)
    for state, fit_there in states:
        if fit_there.temperatures is not None and fit_there.specimen.temperature is not None:
            check = temperature_tested(fit_there.temperatures, fit_there.specimen.temperature)
            yield (
                check
                if state.name == NEW_STATE
                else check.with_location(f"in state '{state.name}'")
            )
    widest = max(result.states, key=lambda state: _compute_relative_width(state.least))
    yield checks.leak_speed_determined(_compute_relative_width(widest.least), state=widest.name)
    yield from fit.checks


def _compute_relative_width(speed: Interval) -> float:
    """Return the wider half of an interval over its value; inf where the seal leaks at rest."""
    value, low, high = speed
    return max(high - value, value - low) / value if value > 0 else float("inf")
