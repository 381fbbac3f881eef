"""Leak speeds of a door file."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from dashpot.base.checks import Check
from dashpot.base.errors import DataError
from dashpot.base.reported_values import NORMAL
from dashpot.datamodel.checks import temperature_tested
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.seal_line import SealSection
from dashpot.extensions.systems.door import checks
from dashpot.extensions.systems.door.analyse_file import (
    add_file_to_errors,
    open_door,
    touches_along,
)
from dashpot.extensions.systems.door.door_model import Door
from dashpot.extensions.systems.door.leak_analysis import Interval, SectionState, find_leak
from dashpot.extensions.systems.door.leak_result import LeakResult
from dashpot.extensions.systems.door.leak_setup import (
    NEW,
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
        Of the new seal, K, instead of what the file says.

    Raises
    ------
    ReadError
        If a file cannot be read, or what it says cannot be.
    DataError
        If the file lacks what a leak speed needs.
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
        pressed = stations.compression
        if pressed is None:
            raise DataError(
                "how far the seal is pressed is not said: give compression, or gap and height, in "
                "[seal]"
            )
        whole = read_fit(door.seal.fit)
        kelvin = door.seal.temperature if temperature is None else temperature
        cases = []
        for state in (LeakState(NEW), *door.leak.states):
            warm = kelvin if state.temperature is None else state.temperature
            here = whole if warm is None else whole.at_temperature(warm)
            section = SealSection.from_fit(here, length=door.seal.length)
            air = STANDARD_TEMPERATURE if warm is None else warm
            density = compute_air_density(air) if state.density is None else state.density
            cases.append((here, SectionState(state, section, density, _evaluate_retention(state))))
        found = tuple(
            find_leak(case, door.leak, fit=here, compression=pressed, factor=stations.factor)
            for here, case in cases
        )
        result = LeakResult(door, door.leak, fit, stations, pressed, found, ())
        every = tuple(_check(result, [(case.state, here) for here, case in cases]))
    return LeakResult(door, door.leak, fit, stations, pressed, found, every)


def _evaluate_retention(state: LeakState) -> Interval:
    """Return what is left of the force in a state, with its 95 % limits."""
    aging = state.aging
    if aging is None:
        half = NORMAL * state.retained_sd
        return Interval(
            state.retained, max(state.retained - half, 0.0), min(state.retained + half, 1.0)
        )
    document = read_json_document(aging.law_path)
    predict = find_handler("retained force", document)
    if predict is None:
        raise DataError(
            f"{aging.law_path} holds no aging law; expected a fit of compression stress relaxation "
            "(dashpot fit ovens.csv -o csr.json)"
        )
    predicted = predict(document, temperature=aging.temperature, until=f"{aging.time!r}s")
    fact = predicted.answers[0]
    if np.isnan(fact.value):  # the ovens bound what is left from below alone
        return Interval(fact.low, fact.low, 1.0)
    low, high = (fact.low, fact.high) if np.isfinite([fact.low, fact.high]).all() else (0.0, 1.0)
    return Interval(min(fact.value, 1.0), max(low, 0.0), min(high, 1.0))


def _check(result: LeakResult, states: list[tuple[LeakState, Fit]]) -> Iterator[Check]:
    fit, pressed = result.fit, result.compression
    yield touches_along(pressed, result.arc_length, result.stations.length.sum())
    law = fit.elastic_law
    yield compression_tested(float(pressed.max()), None if law is None else law.depth)
    for state, here in states:
        if here.temperatures is not None and here.specimen.temperature is not None:
            check = temperature_tested(here.temperatures, here.specimen.temperature)
            yield check if state.name == NEW else check.with_location(f"in state '{state.name}'")
    widest = max(result.states, key=lambda state: _width(state.least))
    yield checks.leak_speed_known(_width(widest.least), state=widest.name)
    yield from fit.checks


def _width(speed: Interval) -> float:
    """Return the wider half of an interval over its value; inf where the seal leaks at rest."""
    value, low, high = speed
    return max(high - value, value - low) / value if value > 0 else float("inf")
