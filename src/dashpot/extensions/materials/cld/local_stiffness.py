"""Force and local stiffness of a branch of a load deflection cycle at one compression."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.extensions.materials.cld.datamodel import Branch, CompressionValues, Cycle
from dashpot.numerics.inference.covariance_estimate import estimate
from dashpot.numerics.least_squares import solve_ordinary

WINDOW = 0.04
"""Half of the compressions taken, as a part of the depth."""
_DIGITS = 1e-6
_MIN_SAMPLES = 8
"""Samples there; a window with fewer is widened."""


class LocalSlope(NamedTuple):
    """Force and slope at a compression, N and N/m, and their standard errors."""

    force: float
    force_se: float
    slope: float
    slope_se: float


def fit_local_slope(
    branch: Branch, compression: float, *, half_width: float, excess: float
) -> LocalSlope | None:
    """Return force and slope at a compression, m, of a parabola over `half_width` to either side.

    None where the branch ends more than `excess` before.
    """
    x, f = branch.compression, branch.force
    if not x.min() - excess <= compression <= x.max() + excess or len(x) < 4:
        return None
    distance = np.abs(x - compression)
    half_width = max(
        half_width,
        float(np.partition(distance, min(_MIN_SAMPLES, len(x)) - 1)[min(_MIN_SAMPLES, len(x)) - 1]),
    )
    is_near = distance <= half_width
    u, y = (x[is_near] - compression) / half_width, f[is_near]
    A = np.column_stack((np.ones_like(u), u, u**2))
    uncertainty = estimate(solve_ordinary(y, A))
    c, error = uncertainty.optimum.beta, uncertainty.standard_error
    rounding_limit = _DIGITS * abs(
        float(c[0])
    )  # what follows without a rest still has a file's digits
    return LocalSlope(
        float(c[0]), max(float(error[0]), rounding_limit), float(c[1]) / half_width,
        max(float(error[1]), rounding_limit) / half_width,
    )  # fmt: skip


def evaluate_cycle(
    cycle: Cycle, compression: float, *, excess: float, contact_se: float, force_se: float
) -> CompressionValues | None:
    """Return the stiffness of a cycle at a compression, m; None if it is not reached.

    The error of the force includes the errors of the two zeros.
    """
    half_width = WINDOW * cycle.depth
    way_in = fit_local_slope(cycle.loading, compression, half_width=half_width, excess=excess)
    if way_in is None:
        return None
    unloading = (
        None
        if cycle.unloading is None
        else fit_local_slope(cycle.unloading, compression, half_width=half_width, excess=excess)
    )
    error = _combine_force_errors(way_in, contact_se=contact_se, force_se=force_se)
    return CompressionValues(
        compression,
        way_in.force,
        error,
        None if unloading is None else unloading.force,
        way_in.slope,
        way_in.slope_se,
        cycle.loading.work(compression),
        None
        if unloading is None
        else _combine_force_errors(unloading, contact_se=contact_se, force_se=force_se),
    )


def _combine_force_errors(slope: LocalSlope, *, contact_se: float, force_se: float) -> float:
    """Return the standard error of a force, N, including the errors of the two zeros."""
    return float(np.linalg.norm([slope.force_se, slope.slope * contact_se, force_se]))


def measure_speed(clock: FloatArray, x: FloatArray) -> tuple[float, float]:
    """Return speed, m/s, and largest departure of a stroke's middle from it, part of its travel."""
    low, high = float(x[0]), float(x[-1])
    middle = np.abs(x - 0.5 * (low + high)) <= 0.4 * abs(high - low)
    t, change = clock[middle], x[middle]
    if len(t) < 3:
        return abs(high - low) / float(clock[-1] - clock[0]), 0.0
    t = t - t.mean()
    speed = float(t @ change) / float(t @ t)
    remainder = change - change.mean() - speed * t
    return abs(speed), float(np.abs(remainder).max()) / abs(high - low)


def delay_channel(time: FloatArray, values: FloatArray, delay: float) -> FloatArray:
    """Return a channel delayed by a time, s, with constant ends."""
    return np.asarray(np.interp(time - delay, time, values))
