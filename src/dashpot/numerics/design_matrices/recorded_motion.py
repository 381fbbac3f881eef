"""Blocks of a motion: a step, a ramp and hold, or a recorded displacement."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.numerics.design_matrices.block import (
    Columns,
    DataBlock,
    Evaluation,
    compute_arm_elongations,
    design_block,
    design_rows,
)
from dashpot.numerics.design_matrices.data_compression import (
    ACCURACY,
    SMALL_BLOCK,
    DataCompression,
    make_identity_plan,
    plan_compression,
    project_values,
    reduced_block,
    uniform_step,
)
from dashpot.numerics.design_matrices.displacement_correlation import correlation_block

# Blocks of a step, a hold, or an ideal ramp and hold, compressed.


class _Ideal(NamedTuple):
    """An ideal motion, whether its ramp is in the record, and the names of the fixed columns."""

    depth: float
    ramp_time: float
    ramp: bool
    spring: str | None
    offset: str | None
    drift: str | None


def build_hold_block(
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
    r"""Return the hold after an ideal ramp (paper eq. 5, in a form that cannot overflow).

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
        Whether the record includes the ramp.
    k_inf, offset, drift : str or None
        Names of the fixed columns; an offset is a constant force, N, which on a hold alone only a
        prior distinguishes from k_inf, a drift a straight line of force in time, N/s. Both are
        omitted unless named.
    weights : array, shape (M,), optional
        1/sd of each sample.
    compress : bool
        False keeps every sample as a row.
    """
    ideal_ramp = _Ideal(depth, ramp_time, ramp, k_inf, offset, drift)
    time, step = _validate_samples(time, force, weights)
    plans = _plan_compressions(time, weights, ideal_ramp, step, compress=compress)
    starts = (0.0, ideal_ramp.ramp_time)
    nodes = np.concatenate([plan.nodes + start for plan, start in zip(plans, starts, strict=False)])
    root = np.concatenate([plan.root_weight for plan in plans])
    spring = np.full(len(nodes), ideal_ramp.depth)
    if ideal_ramp.ramp:
        spring = ideal_ramp.depth / ideal_ramp.ramp_time * np.minimum(nodes, ideal_ramp.ramp_time)
    fixed = {ideal_ramp.spring: spring, ideal_ramp.offset: 1.0, ideal_ramp.drift: nodes}
    fixed.pop(None, None)
    matrix = np.empty((len(nodes), len(fixed)))
    for i, column in enumerate(fixed.values()):
        matrix[:, i] = root * column
    names = tuple(filter(None, fixed))
    target, remainder_sse = project_values(plans, force if weights is None else force * weights)
    rows = design_rows(target, matrix, _columns(plans, ideal_ramp))
    window = window_of(time, plans[-1].step)
    if len(target) == len(time):
        return DataBlock(rows, names, window, len(time))
    make_full = partial(
        build_hold_block, time, force, depth=depth, ramp_time=ramp_time, ramp=ramp, k_inf=k_inf,
        offset=offset, drift=drift, weights=weights, compress=False,
    )  # fmt: skip
    # the columns follow from the clock and all but the data
    is_plain = weights is None and step is not None
    block = DataBlock(
        rows,
        names,
        window,
        len(time),
        floor=float(remainder_sse),
        accuracy=ACCURACY,
        sampling=(len(time), float(time[0]), step, ideal_ramp) if is_plain else None,
        build_full=make_full,
    )
    return _widening(block, plans)


def window_of(time: FloatArray, step: float | None = None) -> tuple[float, float]:
    """Relaxation times that a sampling could show: twice its finest step to ten times its span.

    The finest step is the 2 % quantile of all steps: one jittered pair is not representative.
    """
    if step is not None:
        return 2 * step, 10 * float(time[-1] - time[0])
    steps = np.diff(time)
    fine_step = float(np.partition(steps, len(steps) // 50)[len(steps) // 50])
    return 2 * fine_step, 10 * float(time[-1] - time[0])


def _widening(block: DataBlock, plans: tuple[DataCompression, ...]) -> DataBlock:
    """Return the block, able to take a fixed column that is smooth as its arms are."""

    def widen(name: str, column: FloatArray) -> DataBlock:
        at_nodes, _ = project_values(plans, column)
        make_full = partial(block.exact.with_column, name, column)
        return _widening(block.append_column(name, at_nodes, make_full=make_full), plans)

    return replace(block, add_fixed_column=widen)


def _plan_compressions(
    time: FloatArray,
    weights: FloatArray | None,
    ideal_ramp: _Ideal,
    step: float | None,
    *,
    compress: bool,
) -> tuple[DataCompression, ...]:
    """Return the hold's compression, after the ramp's if the record has it."""
    plan = plan_compression if compress else make_identity_plan
    if not ideal_ramp.ramp:
        return (plan(time, weights, step=step),)
    first = int(np.searchsorted(time, ideal_ramp.ramp_time))
    if first == 0 or first == len(time):
        raise DataError(
            f"ramp_time = {ideal_ramp.ramp_time:g} s leaves {first} of {len(time)} samples on the "
            "ramp; expected some on the ramp and some on the hold"
        )
    weights_before, weights_after = (
        (None, None) if weights is None else (weights[:first], weights[first:])
    )
    return (
        plan(time[:first], weights_before, step=step),
        plan(time[first:] - ideal_ramp.ramp_time, weights_after, step=step),
    )


def _columns(plans: tuple[DataCompression, ...], ideal_ramp: _Ideal) -> Columns:
    *ramps, hold = plans

    def columns(tau: FloatArray, derivative: bool) -> tuple[FloatArray, FloatArray]:
        hold_columns, held_slope = _hold(hold, tau, ideal_ramp, derivative=derivative)
        if not ramps:
            return hold_columns, held_slope
        ramp = ramps[0]
        x = ramp.nodes[:, None] / tau
        scale = ideal_ramp.depth / ideal_ramp.ramp_time * ramp.root_weight[:, None]
        arm_elongation = -tau * np.expm1(-x)
        arms = np.concatenate((scale * arm_elongation, hold_columns))
        if not derivative:
            return arms, arms
        slope = scale * (arm_elongation - ramp.nodes[:, None] * np.exp(-x))
        return arms, np.concatenate((slope, held_slope))

    return columns


def _hold(
    plan: DataCompression, tau: FloatArray, ideal_ramp: _Ideal, *, derivative: bool
) -> tuple[FloatArray, FloatArray]:
    # a column is a row until the end: long rows are fast
    s = plan.nodes / -tau[:, None]
    decay = np.exp(s)
    decay *= ideal_ramp.depth * plan.root_weight
    if ideal_ramp.ramp_time > 0:
        x = ideal_ramp.ramp_time / tau
        decay_less_one = np.expm1(-x)
        mean = -decay_less_one / x
        arms = mean[:, None] * decay
    else:
        arms = decay
    if not derivative:
        return arms.T, arms.T
    s *= arms
    if ideal_ramp.ramp_time <= 0:
        return arms.T, -s.T
    # d/d ln tau of g(c/tau) is g - e^{-c/tau}
    decay *= (mean - (1 + decay_less_one))[:, None]
    decay -= s
    return arms.T, decay.T


def _validate_samples(
    time: FloatArray, values: FloatArray, weights: FloatArray | None
) -> tuple[FloatArray, float | None]:
    """Return the times and, if they are uniform, their interval."""
    time = np.asarray(time, dtype=float)
    for name, array in (("values", values), ("weights", weights)):
        if array is not None and np.shape(array) != time.shape:
            raise DataError(f"{name} have shape {np.shape(array)}, time has {time.shape}")
    step = uniform_step(time)
    is_rising = step is not None or bool((time[1:] > time[:-1]).all())
    if not (len(time) >= 3 and time[0] >= 0 and is_rising):
        raise DataError("time must hold at least 3 strictly increasing values from 0 on")
    if weights is not None and not np.min(weights) > 0:
        raise DataError("weights are 1/sd of each sample: every one must be > 0")
    return time, step


# Blocks of a recorded displacement on any grid.
#
# The force is that of displacement straight between its samples, which the recursion gives
# exactly, with z = h/tau and a = e^{-z}:
#
# .. math:: q_i = a\, q_{i-1} + G\,(x_i - x_{i-1}), \quad G = \frac{1 - e^{-z}}{z}, \qquad
#     p_i = \frac{\partial q_i}{\partial \ln\tau}
#         = a\, p_{i-1} + a z\, q_{i-1} + (G - a)(x_i - x_{i-1})
#
# On a uniform grid without weights the correlation form
# (:mod:`dashpot.numerics.design_matrices.displacement_correlation`) costs one Fourier transform and
# then nothing that grows with the record.


#: number of samples from which the recursion is reduced
MIN_REDUCED_SAMPLES = 2000
#: of its way, a plate that moves by less is at rest
REST_SHARE = 1e-5
#: correlations cannot distinguish arms that are slower than a record's window by more than this
MAX_SLOWNESS = 10.0


def build_recorded_block(
    time: FloatArray,
    displacement: FloatArray,
    force: FloatArray,
    *,
    window: slice = slice(None),
    k_inf: str = "k_inf",
    offset: str | None = None,
    drift: str | None = None,
    columns: Mapping[str, FloatArray] = MappingProxyType({}),
    weights: FloatArray | None = None,
    tau_range: tuple[float, float] | None = None,
) -> DataBlock:
    r"""Return force under a recorded displacement that is straight between its samples.

    .. math:: F_i = k_\infty x_i + \sum_j k_j q_j(t_i) + F_0 + \dot F (t_i - t_0)

    The form is chosen by the record: correlation on a uniform grid from where every weight is 1,
    if it moves there, recursion otherwise, reduced
    (:mod:`dashpot.numerics.design_matrices.data_compression`) if it is long.

    Parameters
    ----------
    time, displacement, force : array, shape (M,)
        Strictly increasing times, any spacing; at rest at displacement zero before the first.
    window : slice
        The contiguous samples whose force is fitted; the displacement before it still acts.
        t_0 is the first time of all.
    k_inf, offset, drift : str
        Names of the fixed columns; offset and drift are omitted unless named.
    columns : mapping of str to array, shape (M,)
        Further fixed columns, a value at every sample.
    weights : array, shape (M,), optional
        1/sd of each sample.
    tau_range : (float, float), optional
        Relaxation times to be evaluated, s; those of the window, if omitted.
    """
    time = np.asarray(time, dtype=float)
    x = np.asarray(displacement, dtype=float)
    y = np.asarray(force, dtype=float)
    if not len(time) == len(x) == len(y):
        raise DataError(
            f"time, displacement and force have {len(time)}, {len(x)} and {len(y)} samples; "
            "expected the same number"
        )
    start, stop, stride = window.indices(len(time))
    if stride != 1 or stop - start < 3:
        raise DataError("the window must hold at least 3 neighbouring samples")
    fixed = {k_inf: x}
    if offset is not None:
        fixed[offset] = np.ones(len(x))
    if drift is not None:
        fixed[drift] = time - time[0]
    fixed |= columns
    step = uniform_step(time)

    def exact(first: int, last: int, weights: FloatArray | None = None) -> DataBlock:
        return recursion_block(
            time[:last], x[:last], y[:last], window=slice(first, last), step=step,
            fixed={name: column[first:last] for name, column in fixed.items()},
            weights=None if weights is None else weights[:last],
        )  # fmt: skip

    limits = window_of(time, step)
    # the first sample from which on every weight is 1
    first_even = 0 if weights is None else int(np.flatnonzero(weights[:stop] != 1)[-1:].sum()) + 1
    is_fast = tau_range is None or tau_range[1] <= MAX_SLOWNESS * limits[1]
    # the correlation of a plate that all but rests is rounding beside that of its whole way
    is_at_rest = first_even > 0 and np.ptp(x[first_even - 1 : stop]) <= REST_SHARE * np.ptp(
        x[:stop]
    )
    if (
        x[0] != 0
        or len(time) <= SMALL_BLOCK
        or step is None
        or first_even > stop // 2
        or not is_fast
        or is_at_rest
    ):
        whole_block = replace(exact(start, stop, weights), window=limits)
        if tau_range is None and stop - start < MIN_REDUCED_SAMPLES:
            return whole_block
        return reduced_block(whole_block, tau_range=tau_range)
    if first_even <= start:
        whole_block = replace(exact(start, stop), window=limits)
        return correlation_block(whole_block, time, x, start=start, stop=stop)
    before = replace(exact(start, first_even, weights), window=limits)
    even_block = replace(exact(first_even, stop), window=limits)
    return _stack_blocks(
        reduced_block(before, tau_range=tau_range),
        correlation_block(even_block, time, x, start=first_even, stop=stop),
    )


def _stack_blocks(block: DataBlock, second: DataBlock) -> DataBlock:
    """Two stretches of one record as one block."""
    first_length = block.samples

    def rows(log_tau: FloatArray, derivative: bool) -> Evaluation:
        rows_of_blocks = block.evaluate(log_tau, derivative), second.evaluate(log_tau, derivative)
        return Evaluation(*(np.concatenate(pair) for pair in zip(*rows_of_blocks, strict=True)))

    return replace(
        second,
        rows=rows,
        samples=block.samples + second.samples,
        floor=block.floor + second.floor,
        sampling=None,
        build_full=lambda: _stack_blocks(block.exact, second.exact),
        add_fixed_column=lambda name, column: _stack_blocks(
            block.with_column(name, column[:first_length]),
            second.with_column(name, column[first_length:]),
        ),
        add_delayed_column=None,
    )


def recursion_block(
    time: FloatArray,
    x: FloatArray,
    y: FloatArray,
    *,
    window: slice,
    fixed: dict[str, FloatArray],
    step: float | None = None,
    weights: FloatArray | None = None,
) -> DataBlock:
    """Return the full record, every sample a row, arms by recursion: any grid, any weights.

    `step` is the interval of a grid known to be uniform.
    """
    root = None if weights is None else weights[window, None]

    def columns(tau: FloatArray, derivative: bool) -> tuple[FloatArray, FloatArray]:
        q, p = compute_arm_columns(time, x, tau, derivative=derivative)
        q, p = q[window], p[window]
        return (q, p) if root is None else (root * q, root * p)

    # columns stand as contiguous rows, turned
    matrix = np.stack(list(fixed.values())).T
    return design_block(
        target=y[window] if root is None else root[:, 0] * y[window],
        fixed=matrix if root is None else root * matrix,
        fixed_names=tuple(fixed),
        columns=columns,
        window=window_of(time, step),
    )


def compute_arm_columns(
    time: FloatArray, x: FloatArray, tau: FloatArray, *, derivative: bool = True
) -> tuple[FloatArray, FloatArray]:
    """Elongations q of unit arms and dq / d ln tau, both (M, N), by the exact recursion.

    Without the derivative the second is the first.
    """
    step = uniform_step(time)
    if step is not None:
        return compute_arm_elongations(x, step / tau, derivative=derivative)
    displacement = np.diff(x)[:, None]
    z = np.diff(time)[:, None] / tau
    decay_less_one = np.expm1(-z)
    decay, mean = 1 + decay_less_one, -decay_less_one / z
    q = recursion(decay, mean * displacement, np.full(len(tau), x[0]))
    if not derivative:
        return q, q
    return q, recursion(
        decay, decay * z * q[:-1] + (mean - decay) * displacement, np.zeros(len(tau))
    )


def recursion(decay: FloatArray, increments: FloatArray, first: FloatArray) -> FloatArray:
    r"""u_0 = first, u_i = decay_{i-1} u_{i-1} + increments_{i-1}, shape (M, N, ...).

    A decay may serve several increments, as arrays broadcast. Many stretches are computed
    simultaneously, one step of all at a time; then each one's end is passed on, damped by the
    product of the decays since.
    """
    total = len(increments) + 1
    length = int(np.ceil(np.sqrt(total)))
    stretches = -(-total // length)

    def reshape_by_step(values: FloatArray) -> FloatArray:
        padded_values = np.zeros((stretches * length, *values.shape[1:]))
        padded_values[total - len(values) : total] = values
        stretched = padded_values.reshape(stretches, length, *values.shape[1:])
        return np.ascontiguousarray(stretched.swapaxes(0, 1))

    solution = reshape_by_step(np.concatenate((first[None], increments)))
    u, decay_to_step = np.zeros(solution.shape[1:]), reshape_by_step(decay)
    for i in range(length):
        u = u * decay_to_step[i] + solution[i]
        solution[i] = u
        if i:
            decay_to_step[i] *= decay_to_step[i - 1]
    carry = np.zeros_like(u)
    for b in range(1, stretches):
        carry[b] = carry[b - 1] * decay_to_step[-1, b - 1] + u[b - 1]
    solution += decay_to_step * carry
    return np.asarray(
        solution.swapaxes(0, 1).reshape(stretches * length, *solution.shape[2:])[:total]
    )
