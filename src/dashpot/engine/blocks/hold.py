"""Blocks of a step, a hold, or an ideal ramp and hold, compressed."""

from __future__ import annotations

from collections.abc import Hashable
from functools import partial

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.engine.blocks.block import Columns, DesignBlock
from dashpot.engine.blocks.compression import (
    ACCURACY,
    Compression,
    compression,
    uncompressed,
    uniform_step,
)


def decay_block(
    time: FloatArray,
    values: FloatArray,
    *,
    constant: str | None = "k_inf",
    weights: FloatArray | None = None,
    arm_group: str = "k",
    compress: bool = True,
) -> DesignBlock:
    r"""A plain sum of exponentials :math:`y = y_\infty + \sum_j k_j e^{-t/\tau_j}` from t = 0.

    Parameters
    ----------
    time, values : array, shape (M,)
        Strictly increasing times >= 0 and the data.
    constant : str or None
        Name of the constant; None leaves it out.
    weights : array, shape (M,), optional
        1/sd of each sample.
    compress : bool
        False keeps every sample as a row.
    """
    time, step = _checked(time, values, weights)
    plan = (compression if compress else uncompressed)(time, weights, step=step)
    fixed = {} if constant is None else {constant: np.ones(len(plan.nodes))}

    def columns(tau: FloatArray, derivative: bool) -> tuple[FloatArray, FloatArray]:
        x = plan.nodes / tau[:, None]
        arms = plan.root_weight * np.exp(-x)
        return arms.T, (x * arms if derivative else arms).T

    full = partial(decay_block, time, values, constant=constant, weights=weights)
    return _block([plan], [(values, weights)], fixed, columns, time, full=full, arm_group=arm_group)


def hold_block(
    time: FloatArray,
    force: FloatArray,
    *,
    depth: float,
    ramp_time: float,
    k_inf: str = "k_inf",
    drift: str | None = None,
    weights: FloatArray | None = None,
    arm_group: str = "k",
    compress: bool = True,
) -> DesignBlock:
    r"""The hold after an ideal ramp (paper eq. 5, in a form that cannot overflow).

    .. math:: F = x_h \Bigl[k_\infty + \sum_j k_j\, g(c/\tau_j)\, e^{-s/\tau_j}\Bigr],
        \qquad g(x) = (1 - e^{-x})/x

    Parameters
    ----------
    time : array, shape (M,)
        s, since the end of the ramp, >= 0, strictly increasing, any spacing.
    force : array, shape (M,)
    depth, ramp_time : float
        x_h and c > 0; c = 0 is a step.
    k_inf, drift : str
        Names of the fixed columns; a drift is a straight line of force in time, N/s, and is
        left out unless named. (On a hold alone a constant offset is k_inf.)
    weights : array, shape (M,), optional
        1/sd of each sample.
    compress : bool
        False keeps every sample as a row.
    """
    time, step = _checked(time, force, weights)
    plan = (compression if compress else uncompressed)(time, weights, step=step)
    fixed = {k_inf: np.full(len(plan.nodes), depth)}
    if drift is not None:
        fixed[drift] = plan.nodes

    def columns(tau: FloatArray, derivative: bool) -> tuple[FloatArray, FloatArray]:
        return _hold(plan, tau, depth, ramp_time, derivative=derivative)

    full = partial(
        hold_block,
        time,
        force,
        depth=depth,
        ramp_time=ramp_time,
        k_inf=k_inf,
        drift=drift,
        weights=weights,
    )
    return _block([plan], [(force, weights)], fixed, columns, time, full=full, arm_group=arm_group)


def ramp_hold_block(
    time: FloatArray,
    force: FloatArray,
    *,
    depth: float,
    ramp_time: float,
    k_inf: str = "k_inf",
    offset: str | None = None,
    drift: str | None = None,
    weights: FloatArray | None = None,
    arm_group: str = "k",
    compress: bool = True,
) -> DesignBlock:
    r"""An ideal ramp and its hold.

    On the ramp, with t since its start and A = depth/ramp_time,

    .. math:: F = A \Bigl[k_\infty t + \sum_j k_j \tau_j (1 - e^{-t/\tau_j})\Bigr]

    and on the hold as in :func:`hold_block`. Parameters as there, with `time` since the start
    of the ramp; `offset` names a constant force.
    """
    time, step = _checked(time, force, weights)
    first = int(np.searchsorted(time, ramp_time))
    if first == 0 or first == len(time):
        raise DataError(
            f"ramp_time = {ramp_time:g} s leaves {first} of {len(time)} samples on the ramp; "
            "expected some on the ramp and some on the hold"
        )
    weighted = (None, None) if weights is None else (weights[:first], weights[first:])
    plan = compression if compress else uncompressed
    ramp = plan(time[:first], weighted[0], step=step)
    hold = plan(time[first:] - ramp_time, weighted[1], step=step)
    at = np.concatenate((ramp.nodes, hold.nodes + ramp_time))
    fixed = {k_inf: depth / ramp_time * np.minimum(at, ramp_time)}
    if offset is not None:
        fixed[offset] = np.ones(len(at))
    if drift is not None:
        fixed[drift] = at

    def columns(tau: FloatArray, derivative: bool) -> tuple[FloatArray, FloatArray]:
        x = ramp.nodes[:, None] / tau
        scale = depth / ramp_time * ramp.root_weight[:, None]
        rise = -tau * np.expm1(-x)
        held, held_slope = _hold(hold, tau, depth, ramp_time, derivative=derivative)
        arms = np.concatenate((scale * rise, held))
        if not derivative:
            return arms, arms
        slope = scale * (rise - ramp.nodes[:, None] * np.exp(-x))
        return arms, np.concatenate((slope, held_slope))

    data = [(force[:first], weighted[0]), (force[first:], weighted[1])]
    full = partial(
        ramp_hold_block,
        time,
        force,
        depth=depth,
        ramp_time=ramp_time,
        k_inf=k_inf,
        offset=offset,
        drift=drift,
        weights=weights,
    )
    return _block([ramp, hold], data, fixed, columns, time, full=full, arm_group=arm_group)


def window_of(time: FloatArray, step: float | None = None) -> tuple[float, float]:
    """Relaxation times that a sampling could tell: twice its finest step to ten times its span.

    The finest step is the 2 % quantile of all steps: one jittered pair says nothing.
    """
    if step is not None:
        return 2 * step, 10 * float(time[-1] - time[0])
    steps = np.diff(time)
    fine = float(np.partition(steps, len(steps) // 50)[len(steps) // 50])
    return 2 * fine, 10 * float(time[-1] - time[0])


def _hold(
    plan: Compression, tau: FloatArray, depth: float, ramp_time: float, *, derivative: bool
) -> tuple[FloatArray, FloatArray]:
    x = ramp_time / tau
    lost = np.expm1(-x)
    mean = -lost / x if ramp_time > 0 else np.ones(len(tau))
    # a column is a row until the end: long rows are fast
    s = plan.nodes * (-1 / tau)[:, None]
    decay = np.exp(s)
    decay *= depth * plan.root_weight
    arms = mean[:, None] * decay
    if not derivative:
        return arms.T, arms.T
    # d/d ln tau of g(c/tau) is g - e^{-c/tau}
    decay *= (mean - (1 + lost))[:, None]
    s *= arms
    decay -= s
    return arms.T, decay.T


def _block(
    plans: list[Compression],
    data: list[tuple[FloatArray, FloatArray | None]],
    fixed: dict[str, FloatArray],
    columns: Columns,
    time: FloatArray,
    *,
    full: partial[DesignBlock],
    arm_group: str,
) -> DesignBlock:
    target, floor = [], 0.0
    for plan, (values, weights) in zip(plans, data, strict=True):
        z, aside = plan.project(values if weights is None else values * weights)
        target.append(z)
        floor += float(aside)
    root = np.concatenate([plan.root_weight for plan in plans])
    stacked = np.concatenate(target)
    compressed = len(stacked) < len(time)
    empty = np.zeros((len(stacked), 0))
    return DesignBlock(
        target=stacked,
        fixed=np.column_stack([root * column for column in fixed.values()]) if fixed else empty,
        fixed_names=tuple(fixed),
        columns=columns,
        window=window_of(time, plans[-1].step),
        floor=floor,
        samples=len(time),
        arm_group=arm_group,
        accuracy=ACCURACY if compressed else 1e-15,
        full=partial(full, arm_group=arm_group, compress=False) if compressed else None,
        sampling=_sampling(full, time, plans[-1].step) if compressed else None,
    )


def _sampling(full: partial[DesignBlock], time: FloatArray, step: float | None) -> Hashable:
    """What the columns of a compressed record follow from: its clock and all but its data."""
    parameters = dict(full.keywords)
    if parameters.pop("weights") is not None or step is None:
        return None
    return full.func.__name__, len(time), float(time[0]), step, tuple(parameters.items())


def _checked(
    time: FloatArray, values: FloatArray, weights: FloatArray | None
) -> tuple[FloatArray, float | None]:
    """The times and, if they are uniform, their interval."""
    time = np.asarray(time, dtype=float)
    for name, array in (("values", values), ("weights", weights)):
        if array is not None and np.shape(array) != time.shape:
            raise DataError(f"{name} have shape {np.shape(array)}, time has {time.shape}")
    step = uniform_step(time) if len(time) > 2 else None
    rising = step is not None or bool((time[1:] > time[:-1]).all())
    if len(time) < 3 or time[0] < 0 or not rising:
        raise DataError("time must hold at least 3 strictly increasing values from 0 on")
    if weights is not None and not np.min(weights) > 0:
        raise DataError("weights are 1/sd of each sample: every one must be > 0")
    return time, step
