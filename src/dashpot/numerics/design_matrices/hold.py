"""Blocks of a step, a hold, or an ideal ramp and hold, compressed."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.numerics.design_matrices.block import Columns, DataBlock, design_rows
from dashpot.numerics.design_matrices.data_compression import (
    ACCURACY,
    DataCompression,
    compression,
    make_identity_plan,
    project_values,
    uniform_step,
)


class _Ideal(NamedTuple):
    """An ideal motion, whether its ramp is in the record, and the names of the fixed columns."""

    depth: float
    ramp_time: float
    ramp: bool
    spring: str | None
    offset: str | None
    drift: str | None


def hold_block(
    time: FloatArray,
    force: FloatArray,
    *,
    depth: float = 1.0,
    ramp_time: float = 0.0,
    ramp: bool = False,
    k_inf: str | None = "k_inf",
    offset: str | None = None,
    drift: str | None = None,
    weights: FloatArray | None = None,
    compress: bool = True,
) -> DataBlock:
    r"""The hold after an ideal ramp (paper eq. 5, in a form that cannot overflow).

    .. math:: F = x_h \Bigl[k_\infty + \sum_j k_j\, g(c/\tau_j)\, e^{-s/\tau_j}\Bigr],
        \qquad g(x) = (1 - e^{-x})/x

    After a step of one, the default, a plain sum of exponentials. With its `ramp`, where t counts
    from its start and A = depth/ramp_time,

    .. math:: F = A \Bigl[k_\infty t + \sum_j k_j \tau_j (1 - e^{-t/\tau_j})\Bigr]

    Parameters
    ----------
    time : array, shape (M,)
        s, since the end of the ramp, or since its start with the `ramp`: >= 0, strictly increasing,
        any spacing.
    force : array, shape (M,)
    depth, ramp_time : float
        x_h and c > 0; c = 0 is a step.
    ramp : bool
        The record has the ramp, too.
    k_inf, offset, drift : str or None
        Names of the fixed columns; an offset is a constant force, N, which on a hold alone only a
        prior tells from k_inf, a drift a straight line of force in time, N/s. Both are left out
        unless named.
    weights : array, shape (M,), optional
        1/sd of each sample.
    compress : bool
        False keeps every sample as a row.
    """
    ideal = _Ideal(depth, ramp_time, ramp, k_inf, offset, drift)
    time, step = _validate_samples(time, force, weights)
    plans = _plans(time, weights, ideal, step, compress=compress)
    starts = (0.0, ideal.ramp_time)
    at = np.concatenate([plan.nodes + start for plan, start in zip(plans, starts, strict=False)])
    root = np.concatenate([plan.root_weight for plan in plans])
    spring = np.full(len(at), ideal.depth)
    if ideal.ramp:
        spring = ideal.depth / ideal.ramp_time * np.minimum(at, ideal.ramp_time)
    fixed = {ideal.spring: spring, ideal.offset: 1.0, ideal.drift: at}
    fixed.pop(None, None)
    matrix = np.empty((len(at), len(fixed)))
    for i, column in enumerate(fixed.values()):
        matrix[:, i] = root * column
    names = tuple(filter(None, fixed))
    target, floor = project_values(plans, force if weights is None else force * weights)
    rows = design_rows(target, matrix, _columns(plans, ideal))
    window = window_of(time, plans[-1].step)
    if len(target) == len(time):
        return DataBlock(rows, names, window, len(time))
    full = partial(
        hold_block, time, force, depth=depth, ramp_time=ramp_time, ramp=ramp, k_inf=k_inf,
        offset=offset, drift=drift, weights=weights, compress=False,
    )  # fmt: skip
    # the columns follow from the clock and all but the data
    certain = weights is None and step is not None
    block = DataBlock(
        rows,
        names,
        window,
        len(time),
        floor=float(floor),
        accuracy=ACCURACY,
        sampling=(len(time), float(time[0]), step, ideal) if certain else None,
        full=full,
    )
    return _widening(block, plans)


def window_of(time: FloatArray, step: float | None = None) -> tuple[float, float]:
    """Relaxation times that a sampling could tell: twice its finest step to ten times its span.

    The finest step is the 2 % quantile of all steps: one jittered pair says nothing.
    """
    if step is not None:
        return 2 * step, 10 * float(time[-1] - time[0])
    steps = np.diff(time)
    fine = float(np.partition(steps, len(steps) // 50)[len(steps) // 50])
    return 2 * fine, 10 * float(time[-1] - time[0])


def _widening(block: DataBlock, plans: tuple[DataCompression, ...]) -> DataBlock:
    """The block, able to take a fixed column that is smooth as its arms are."""

    def widen(name: str, column: FloatArray) -> DataBlock:
        at_nodes, _ = project_values(plans, column)
        whole = partial(block.exact.with_column, name, column)
        return _widening(block.append_column(name, at_nodes, full=whole), plans)

    return replace(block, widen=widen)


def _plans(
    time: FloatArray,
    weights: FloatArray | None,
    ideal: _Ideal,
    step: float | None,
    *,
    compress: bool,
) -> tuple[DataCompression, ...]:
    """The hold's compression, after the ramp's if the record has it."""
    plan = compression if compress else make_identity_plan
    if not ideal.ramp:
        return (plan(time, weights, step=step),)
    first = int(np.searchsorted(time, ideal.ramp_time))
    if first == 0 or first == len(time):
        raise DataError(
            f"ramp_time = {ideal.ramp_time:g} s leaves {first} of {len(time)} samples on the ramp; "
            "expected some on the ramp and some on the hold"
        )
    on, after = (None, None) if weights is None else (weights[:first], weights[first:])
    return (
        plan(time[:first], on, step=step),
        plan(time[first:] - ideal.ramp_time, after, step=step),
    )


def _columns(plans: tuple[DataCompression, ...], ideal: _Ideal) -> Columns:
    *ramps, hold = plans

    def columns(tau: FloatArray, derivative: bool) -> tuple[FloatArray, FloatArray]:
        held, held_slope = _hold(hold, tau, ideal, derivative=derivative)
        if not ramps:
            return held, held_slope
        ramp = ramps[0]
        x = ramp.nodes[:, None] / tau
        scale = ideal.depth / ideal.ramp_time * ramp.root_weight[:, None]
        rise = -tau * np.expm1(-x)
        arms = np.concatenate((scale * rise, held))
        if not derivative:
            return arms, arms
        slope = scale * (rise - ramp.nodes[:, None] * np.exp(-x))
        return arms, np.concatenate((slope, held_slope))

    return columns


def _hold(
    plan: DataCompression, tau: FloatArray, ideal: _Ideal, *, derivative: bool
) -> tuple[FloatArray, FloatArray]:
    # a column is a row until the end: long rows are fast
    s = plan.nodes / -tau[:, None]
    decay = np.exp(s)
    decay *= ideal.depth * plan.root_weight
    if ideal.ramp_time > 0:
        x = ideal.ramp_time / tau
        lost = np.expm1(-x)
        mean = -lost / x
        arms = mean[:, None] * decay
    else:
        arms = decay
    if not derivative:
        return arms.T, arms.T
    s *= arms
    if ideal.ramp_time <= 0:
        return arms.T, -s.T
    # d/d ln tau of g(c/tau) is g - e^{-c/tau}
    decay *= (mean - (1 + lost))[:, None]
    decay -= s
    return arms.T, decay.T


def _validate_samples(
    time: FloatArray, values: FloatArray, weights: FloatArray | None
) -> tuple[FloatArray, float | None]:
    """The times and, if they are uniform, their interval."""
    time = np.asarray(time, dtype=float)
    for name, array in (("values", values), ("weights", weights)):
        if array is not None and np.shape(array) != time.shape:
            raise DataError(f"{name} have shape {np.shape(array)}, time has {time.shape}")
    step = uniform_step(time)
    rising = step is not None or bool((time[1:] > time[:-1]).all())
    if not (len(time) >= 3 and time[0] >= 0 and rising):
        raise DataError("time must hold at least 3 strictly increasing values from 0 on")
    if weights is not None and not np.min(weights) > 0:
        raise DataError("weights are 1/sd of each sample: every one must be > 0")
    return time, step
