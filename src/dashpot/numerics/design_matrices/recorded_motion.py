r"""Blocks of a recorded displacement, any history on any grid.

The force is that of displacement straight between its samples, which the recursion gives
exactly, with z = h/tau and a = e^{-z}:

.. math:: q_i = a\, q_{i-1} + G\,(x_i - x_{i-1}), \quad G = \frac{1 - e^{-z}}{z}, \qquad
    p_i = \frac{\partial q_i}{\partial \ln\tau}
        = a\, p_{i-1} + a z\, q_{i-1} + (G - a)(x_i - x_{i-1})

On a uniform grid without weights the correlation form
(:mod:`dashpot.numerics.design_matrices.displacement_correlation`) costs one Fourier transform and
then nothing that grows with the record.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.numerics.design_matrices.arm_recursion import compute_arm_elongations
from dashpot.numerics.design_matrices.block import DataBlock, Evaluation, design_block
from dashpot.numerics.design_matrices.data_compression import SMALL, uniform_step
from dashpot.numerics.design_matrices.displacement_correlation import correlation_block
from dashpot.numerics.design_matrices.hold import window_of
from dashpot.numerics.design_matrices.relaxation_kernels import reduced_block

#: samples from which the recursion is worth reducing
LONG = 2000
#: of its way, a plate that moves by less is at rest
RESTING = 1e-5
#: correlations cannot tell apart arms that are slower than a record's window by more than this
FARTHEST = 10.0


def recorded_block(
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
    reach: tuple[float, float] | None = None,
) -> DataBlock:
    r"""Force under a recorded displacement that is straight between its samples.

    .. math:: F_i = k_\infty x_i + \sum_j k_j q_j(t_i) + F_0 + \dot F (t_i - t_0)

    The form is chosen by the record: correlation on a uniform grid from where every weight is 1,
    if it moves there, recursion otherwise, reduced
    (:mod:`dashpot.numerics.design_matrices.relaxation_kernels`) if it is long.

    Parameters
    ----------
    time, displacement, force : array, shape (M,)
        Strictly increasing times, any spacing; at rest at displacement zero before the first.
    window : slice
        The contiguous samples whose force is fitted; the displacement before it still acts.
        t_0 is the first time of all.
    k_inf, offset, drift : str
        Names of the fixed columns; offset and drift are left out unless named.
    columns : mapping of str to array, shape (M,)
        Further fixed columns, a value at every sample.
    weights : array, shape (M,), optional
        1/sd of each sample.
    reach : (float, float), optional
        Relaxation times to be evaluated, s; those of the window, if left out.
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
    even = 0 if weights is None else int(np.flatnonzero(weights[:stop] != 1)[-1:].sum()) + 1
    near = reach is None or reach[1] <= FARTHEST * limits[1]
    # the correlation of a plate that all but rests is rounding beside that of its whole way
    rests = even > 0 and np.ptp(x[even - 1 : stop]) <= RESTING * np.ptp(x[:stop])
    if x[0] != 0 or len(time) <= SMALL or step is None or even > stop // 2 or not near or rests:
        whole = replace(exact(start, stop, weights), window=limits)
        return whole if reach is None and stop - start < LONG else reduced_block(whole, reach=reach)
    if even <= start:
        whole = replace(exact(start, stop), window=limits)
        return correlation_block(whole, time, x, start=start, stop=stop)
    before = replace(exact(start, even, weights), window=limits)
    after = replace(exact(even, stop), window=limits)
    return _stack_blocks(
        reduced_block(before, reach=reach),
        correlation_block(after, time, x, start=even, stop=stop),
    )


def _stack_blocks(block: DataBlock, two: DataBlock) -> DataBlock:
    """Two stretches of one record as one block."""
    cut = block.samples

    def rows(log_tau: FloatArray, derivative: bool) -> Evaluation:
        parts = block.evaluate(log_tau, derivative), two.evaluate(log_tau, derivative)
        return Evaluation(*(np.concatenate(pair) for pair in zip(*parts, strict=True)))

    return replace(
        two,
        rows=rows,
        samples=block.samples + two.samples,
        floor=block.floor + two.floor,
        sampling=None,
        full=lambda: _stack_blocks(block.exact, two.exact),
        widen=lambda name, column: _stack_blocks(
            block.with_column(name, column[:cut]), two.with_column(name, column[cut:])
        ),
        delayed=None,
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
    """The full record, every sample a row, arms by recursion: any grid, any weights.

    `step` is the interval of a grid known to be uniform.
    """
    root = None if weights is None else weights[window, None]

    def columns(tau: FloatArray, derivative: bool) -> tuple[FloatArray, FloatArray]:
        q, p = arm_columns(time, x, tau, derivative=derivative)
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


def arm_columns(
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
    lost = np.expm1(-z)
    decay, mean = 1 + lost, -lost / z
    q = recursion(decay, mean * displacement, np.full(len(tau), x[0]))
    if not derivative:
        return q, q
    return q, recursion(
        decay, decay * z * q[:-1] + (mean - decay) * displacement, np.zeros(len(tau))
    )


def recursion(decay: FloatArray, increments: FloatArray, first: FloatArray) -> FloatArray:
    r"""u_0 = first, u_i = decay_{i-1} u_{i-1} + increments_{i-1}, shape (M, N, ...).

    A decay may serve several increments, as arrays broadcast. Many stretches run side by side, one
    step of all at a time; then each one's end is passed on, damped by the product of the decays
    since.
    """
    total = len(increments) + 1
    length = int(np.ceil(np.sqrt(total)))
    stretches = -(-total // length)

    def reshape_by_step(values: FloatArray) -> FloatArray:
        padded = np.zeros((stretches * length, *values.shape[1:]))
        padded[total - len(values) : total] = values
        parts = padded.reshape(stretches, length, *values.shape[1:])
        return np.ascontiguousarray(parts.swapaxes(0, 1))

    out = reshape_by_step(np.concatenate((first[None], increments)))
    u, since = np.zeros(out.shape[1:]), reshape_by_step(decay)
    for i in range(length):
        u = u * since[i] + out[i]
        out[i] = u
        if i:
            since[i] *= since[i - 1]
    carry = np.zeros_like(u)
    for b in range(1, stretches):
        carry[b] = carry[b - 1] * since[-1, b - 1] + u[b - 1]
    out += since * carry
    return np.asarray(out.swapaxes(0, 1).reshape(stretches * length, *out.shape[2:])[:total])
