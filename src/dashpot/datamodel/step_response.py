"""What curves after a step share that may have been measured at several temperatures."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from dashpot.base.arrays import increasing, same_length, validate_measured
from dashpot.base.errors import DataError
from dashpot.base.provenance import describe_record_source
from dashpot.datamodel.shift_factors import find_near_samples, format_temperature_range
from dashpot.datamodel.specimen import tested_at

Curve = TypeVar("Curve", bound=Any)


def since_a_step(curve: Any, value: str) -> None:
    """Check time, value and temperature of a curve in the making, and freeze them.

    Raises
    ------
    DataError
        If the arrays differ in length, are not finite, or time falls or starts below 0.
    """
    for name in ("time", value):
        object.__setattr__(curve, name, validate_measured(name, getattr(curve, name)))
    if curve.temperature is None:
        increasing("time", curve.time)
    else:
        object.__setattr__(
            curve, "temperature", validate_measured("temperature", curve.temperature)
        )
        tested_at("temperature", curve.temperature.min(), curve.temperature.max())
    columns = {name: getattr(curve, name) for name in ("time", value, "temperature")}
    same_length(**columns)
    if curve.time.min() < 0:
        raise DataError(
            f"time begins at {curve.time.min():g} s; expected the time since the step, >= 0"
        )


def curve_at(curve: Curve, value: str, kelvin: float) -> Curve:
    """Return the samples of a curve within a kelvin of a temperature, K, in order of time."""
    chosen = np.flatnonzero(find_near_samples(curve.temperature, kelvin))
    chosen = chosen[np.argsort(curve.time[chosen], kind="stable")]
    parts = {name: getattr(curve, name)[chosen] for name in ("time", value)}
    specimen = replace(curve.specimen, temperature=kelvin)
    return replace(curve, temperature=None, specimen=specimen, **parts)


def described_curve(curve: Any, value: str) -> tuple[str, ...]:
    """Return which curve it is, and what it covers."""
    time, values = curve.time, getattr(curve, value)
    return (
        describe_record_source(curve.source, len(time)),
        (
            f"{values[0]:.5g} to {values[-1]:.5g} {curve.unit} over "
            f"{time.min():.4g} to {time.max():.5g} s{format_temperature_range(curve.temperature)}"
        ),
    )
