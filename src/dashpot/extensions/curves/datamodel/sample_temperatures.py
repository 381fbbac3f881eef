"""Temperatures of the samples of a curve."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from dashpot.base.arrays import (
    BoolArray,
    FloatArray,
    require_increasing,
    require_same_length,
    validate_measured,
)
from dashpot.base.errors import DataError
from dashpot.base.provenance import describe_record_source
from dashpot.base.units import celsius, convert_to_unit
from dashpot.datamodel.shift_factors import Shift
from dashpot.datamodel.specimen import tested_at

ONE_TEMPERATURE = 2.0
"""Largest range of temperatures of one sweep, K."""


def make_shifts(
    temperature: FloatArray, log10_a_t: FloatArray, b_t: FloatArray, covariance: FloatArray
) -> tuple[Shift, ...]:
    """Return shifts with their errors; `covariance` is of log10 a_T, then of ln b_T."""
    error, b_error = np.split(np.sqrt(np.maximum(np.diag(covariance), 0.0)), 2)
    rows = zip(temperature, log10_a_t, error, b_t, b_t * b_error, strict=True)
    return tuple(Shift(*map(float, row)) for row in rows)


def find_near_samples(temperature: FloatArray | None, kelvin: float) -> BoolArray:
    """Return which samples lie within a kelvin of a temperature, K, shape (n,).

    Raises
    ------
    DataError
        If there are no temperatures, or none is that near.
    """
    if temperature is None:
        raise DataError(
            f"{celsius(kelvin)} was asked for, but the test has no temperatures: leave "
            "--at-temperature out"
        )
    is_near = np.abs(temperature - kelvin) <= ONE_TEMPERATURE / 2
    if not is_near.any():
        temperatures_text = ", ".join(
            f"{value:.0f} degC"
            for value in np.unique(np.round(convert_to_unit(temperature, "degC")))
        )
        raise DataError(
            f"no sample within {ONE_TEMPERATURE / 2:g} K of {celsius(kelvin)}; the test has "
            f"{temperatures_text}"
        )
    return np.asarray(is_near)


def has_several_temperatures(temperature: FloatArray | None) -> bool:
    """Return whether samples differ too much in temperature, K, for one solid."""
    values = np.zeros(0) if temperature is None else np.asarray(temperature)
    return bool(values.size and np.ptp(values) > ONE_TEMPERATURE)


def format_temperature_range(temperature: FloatArray | None) -> str:
    """Return the range of temperatures in words; empty if there is one only."""
    if temperature is None:
        return ""
    return f", {temperature.min():.5g} to {temperature.max():.5g} K"


# Curves after a step, possibly at several temperatures.


Curve = TypeVar("Curve", bound=Any)


def validate_step_response(curve: Any, value: str) -> None:
    """Check time, value and temperature of a curve in the making, and freeze them.

    Raises
    ------
    DataError
        If the arrays differ in length, are not finite, or time falls or starts below 0.
    """
    for name in ("time", value):
        object.__setattr__(curve, name, validate_measured(name, getattr(curve, name)))
    if curve.temperature is None:
        require_increasing("time", curve.time)
    else:
        object.__setattr__(
            curve, "temperature", validate_measured("temperature", curve.temperature)
        )
        tested_at("temperature", curve.temperature.min(), curve.temperature.max())
    columns = {name: getattr(curve, name) for name in ("time", value, "temperature")}
    require_same_length(**columns)
    if curve.time.min() < 0:
        raise DataError(
            f"time begins at {curve.time.min():g} s; expected the time since the step, >= 0"
        )


def select_temperature(curve: Curve, value: str, kelvin: float) -> Curve:
    """Return the samples of a curve within a kelvin of a temperature, K, in order of time."""
    indices = np.flatnonzero(find_near_samples(curve.temperature, kelvin))
    indices = indices[np.argsort(curve.time[indices], kind="stable")]
    parts = {name: getattr(curve, name)[indices] for name in ("time", value)}
    specimen = replace(curve.specimen, temperature=kelvin)
    return replace(curve, temperature=None, specimen=specimen, **parts)


def describe_step_response(curve: Any, value: str) -> tuple[str, ...]:
    """Return the kind and the range of the curve."""
    time, values = curve.time, getattr(curve, value)
    return (
        describe_record_source(curve.source, len(time)),
        (
            f"{values[0]:.5g} to {values[-1]:.5g} {curve.unit} over "
            f"{time.min():.4g} to {time.max():.5g} s{format_temperature_range(curve.temperature)}"
        ),
    )
