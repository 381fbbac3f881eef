r"""Correlations of a recorded displacement on a uniform grid, independent of record length.

With d_i = x_i - x_{i-1}, z = h/tau, a = e^{-z}, G = (1 - e^{-z})/z and u_i = a u_{i-1} + d_i, an
arm is q = G u, and every inner product that a fit asks for over the window W is a sum of
:math:`a^l c(l)` over the lags of a correlation:

.. math::

    \langle v, q \rangle &= G \sum_l a^l C_v(l), \qquad C_v(l) = \sum_{i \in W} v_i d_{i-l} \\
    \langle q_j, q_k \rangle &= G_j G_k
        \frac{S_j + S_k - C_d(0) + a_j a_k (u_j u_k|_{before} - u_j u_k|_{last})}
             {1 - a_j a_k}, \qquad S_j = \sum_l a_j^l C_d(l)

The C_v(l) are compressed like a decaying signal, so a sum over all lags is a sum over some 200
nodes. Derivatives by ln tau multiply a node by l z; the mixed derivative of
:math:`\langle q_j, q_k \rangle` is :math:`\langle p_j, p_k \rangle`. The Cholesky factor of the
Gram matrix of [fixed, q, y, p] then holds the columns in orthogonal coordinates.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import ComplexArray, EqualByValue, FloatArray, find_fast_length
from dashpot.base.errors import FitError
from dashpot.numerics.design_matrices.block import (
    DataBlock,
    DelayedForce,
    Evaluation,
    MotionSteps,
    Rows,
    compute_delayed_lags,
    reverse_before_start,
)
from dashpot.numerics.design_matrices.data_compression import (
    DataCompression,
    make_sample_plan,
    uniform_step,
)

#: relative sum of squares below which a Gram matrix is rounding error
ROUNDING = 1e-14
_SIGNS = np.array([[1.0], [-1.0]])
#: of the energy of all steps: an arm with less in a window is nothing there
MIN_ENERGY = 1e-15
#: a ridge that takes no digit that counts: 1e-9, and not ten times that
LARGEST_RIDGE = 2e-9
#: part of the whole motion that is rest: rounding
REST_SHARE = 1e-13
#: so many columns of decays are dependent to rounding
MAX_INDEPENDENT_COLUMNS = 24


@dataclass(frozen=True, eq=False)
class ConvolvedMotion(EqualByValue):
    """Displacement convolved with decays, independent of the force.

    Attributes
    ----------
    fixed : array, shape (n, q)
        The fixed columns over the window.
    fixed_gram : array, shape (q, q)
        Their inner products.
    sequences : array, shape (q + 3, m)
        Compressed lag sequences: fixed columns, d, u before the window, u at its end.
    lags : DataCompression
    steps_spectrum : complex array
        Conjugate Fourier transform of the displacement's steps, zero padded.
    energy : float
        Sum of squared steps in the window.
    rounding : float
        Rounding error of the energy of an arm without decay: a part of all steps' energy.
    start, count, step
        First sample of the window, samples up to its end, sample interval in s.
    steps : MotionSteps or None
        The steps themselves, and their correlation.
    """

    fixed: FloatArray
    fixed_gram: FloatArray
    sequences: FloatArray
    lags: DataCompression
    steps_spectrum: ComplexArray
    fft_length: int
    energy: float
    rounding: float
    start: int
    count: int
    step: float
    steps: MotionSteps | None = None

    def with_fixed(self, column: FloatArray, values: FloatArray | None = None) -> ConvolvedMotion:
        """Return the motion with a further fixed column, shape (n,), and its correlation."""
        fixed = np.concatenate((self.fixed.T, column[None])).T
        crossed = column @ fixed
        column_count = len(crossed)
        gram = np.empty((column_count, column_count))
        gram[:-1, :-1], gram[-1], gram[:, -1] = self.fixed_gram, crossed, crossed
        values = self.correlate(column) if values is None else self.lags.compress_to_nodes(values)
        sequences = np.concatenate((self.sequences[:-3], values[None], self.sequences[-3:]))
        return replace(self, fixed=fixed, fixed_gram=gram, sequences=sequences)

    def correlate(self, values: FloatArray) -> FloatArray:
        """Compressed correlation of window values, shape (..., n), with the displacement."""
        return self.lags.compress_to_nodes(self.correlate_with_steps(values))

    def correlate_with_steps(self, values: FloatArray) -> FloatArray:
        r"""Correlation :math:`\sum_{i \in W} v_i d_{i-l}` for all lags l, shape (..., count)."""
        if self.start:
            padded_values = np.zeros((*values.shape[:-1], self.count))
            padded_values[..., self.start :] = values
            values = padded_values
        spectrum = np.fft.rfft(values, self.fft_length)
        spectrum *= self.steps_spectrum
        return np.asarray(np.fft.irfft(spectrum, self.fft_length)[..., : self.count])

    def gram(self, tau: FloatArray, force: Force, *, derivative: bool) -> FloatArray:
        """Gram matrix of [fixed, arms, y] or [fixed, arms, slopes, y].

        For tau of shape (..., N) and a force of leading shape (...).
        """
        arm = self._arm_sums(tau, force)
        q, arms = self.fixed.shape[1], tau.shape[-1]
        column_count = q + 1 + (2 * arms if derivative else arms)
        gram = np.empty((*tau.shape[:-1], column_count, column_count))
        arm_rows, y = slice(q, q + arms), column_count - 1
        gram[..., :q, :q] = self.fixed_gram
        gram[..., :q, y] = gram[..., y, :q] = force.fixed
        gram[..., y, y] = force.energy
        _mirror(gram, slice(q), arm_rows, arm.g[..., None, :] * arm.sums[..., :q, :])
        _mirror(gram, y, arm_rows, arm.g * arm.y)
        if not derivative:
            gram[..., arm_rows, arm_rows] = _values(arm, self.energy)
        else:
            products = _compute_arm_products(arm, self.energy)
            gram[..., arm_rows, arm_rows] = products.qq
            offset_rows = slice(q + arms, y)
            slopes = arm.dg[..., None, :] * arm.sums + arm.g[..., None, :] * arm.slopes
            _mirror(gram, slice(q), offset_rows, slopes[..., :q, :])
            _mirror(gram, y, offset_rows, arm.dg * arm.y + arm.g * arm.dy)
            _mirror(gram, arm_rows, offset_rows, products.qp)
            gram[..., offset_rows, offset_rows] = products.pp
        values = np.diagonal(gram, axis1=-2, axis2=-1)[..., arm_rows]
        is_rounded = values < arm.g * arm.g * self.rounding
        if is_rounded.any():
            is_vanishing = np.zeros((*tau.shape[:-1], column_count), dtype=bool)
            is_vanishing[..., arm_rows] = is_rounded
            if derivative:
                is_vanishing[..., offset_rows] = is_rounded
            gram[is_vanishing[..., :, None] | is_vanishing[..., None, :]] = 0.0
        return gram

    def products(self, tau: FloatArray, sequences: FloatArray) -> FloatArray:
        """Inner products of forces, (R, m), with arms at shared tau (G,), shape (R, G)."""
        z = self.step / tau
        decay = self.lags.root_weight[:, None] * np.exp(-self.lags.nodes[:, None] * z)
        return np.asarray(sequences @ decay * (-np.expm1(-z) / z))

    def _arm_sums(self, tau: FloatArray, force: Force) -> _ArmSums:
        z = self.step / tau
        decay_less_one = np.expm1(-z)
        a, g = 1 + decay_less_one, -decay_less_one / z
        x = z[..., None] * self.lags.nodes
        decay = self.lags.root_weight * np.exp(-x)
        decay_slope = x * decay
        values = force.sequence[..., None]
        return _ArmSums(
            z,
            a,
            g,
            g - a,
            np.swapaxes(decay @ self.sequences.T, -1, -2),
            np.swapaxes(decay_slope @ self.sequences.T, -1, -2),
            (decay @ values)[..., 0],
            (decay_slope @ values)[..., 0],
        )


def _correlate_window_steps(motion: ConvolvedMotion, d: FloatArray, moving: int) -> FloatArray:
    """Correlation of the steps of the window with all steps, the last of which is at `moving`."""
    if d[: motion.start].any():
        # never the difference of two correlations: the last creep of a motion is lost in it
        return motion.correlate_with_steps(d[motion.start :])
    values = np.zeros(len(d))
    fft_length = find_fast_length(2 * moving)
    spectrum = np.fft.rfft(d[:moving], fft_length)
    power = spectrum.real**2 + spectrum.imag**2
    values[:moving] = np.fft.irfft(power, fft_length)[:moving]
    return values


class Force(NamedTuple):
    """Force, or a stack of forces, correlated with a motion: y of the Gram matrix."""

    sequence: FloatArray  # (..., m) compressed correlation with the displacement
    fixed: FloatArray  # (..., q) inner products with the fixed columns
    energy: FloatArray  # (...) y'y

    @classmethod
    def from_motion(cls, motion: ConvolvedMotion, values: FloatArray) -> Force:
        """Correlate window values of shape (..., n)."""
        energy = np.asarray(np.vecdot(values, values))
        return cls(motion.correlate(values), values @ motion.fixed, energy)


def correlation_rows(shared: ConvolvedMotion, force: Force, exact: DataBlock) -> Rows:
    """Return rows whose inner products are closed forms in tau, in the coordinates of their factor.

    Where rounding is too large for this factor, the factor of all samples is used.
    """
    q = shared.fixed.shape[1]

    def rows(log_tau: FloatArray, derivative: bool) -> Evaluation:
        try:
            factor = upper_factor(shared.gram(np.exp(log_tau), force, derivative=derivative))
        except FitError:
            factor = _factor_of_samples(exact.evaluate(log_tau, derivative), derivative=derivative)
        span = slice(q, q + len(log_tau))
        slope = slice(span.stop, -1) if derivative else span
        return Evaluation(factor[:, -1], factor[:, :q], factor[:, span], factor[:, slope])

    return rows


def _factor_of_samples(evaluation: Evaluation, *, derivative: bool) -> FloatArray:
    """Return the same factor from the columns themselves: slower, without loss of digits."""
    slopes = [evaluation.d_arms] if derivative else []
    columns = np.column_stack((evaluation.fixed, evaluation.arms, *slopes, evaluation.target))
    if not np.isfinite(columns).all():
        raise FitError("the terms of the fit are no finite numbers on this record; check its units")
    return np.asarray(np.linalg.qr(columns, mode="r"))


class _ArmSums(NamedTuple):
    z: FloatArray
    a: FloatArray
    g: FloatArray
    dg: FloatArray  # dG / d ln tau = G - a
    sums: FloatArray  # sum a^l c(l): a row per sequence, a column per arm
    slopes: FloatArray  # their derivatives by ln tau
    y: FloatArray  # the same for the force
    dy: FloatArray


class _Products(NamedTuple):
    qq: FloatArray
    qp: FloatArray
    pp: FloatArray


def _compute_arm_products(arm: _ArmSums, energy: float) -> _Products:
    r"""Inner products of arms and of their derivatives, by the quotient rule on num/den."""
    arms = arm.z.shape[-1]
    ds = arm.slopes[..., -3, :]
    a, da = arm.a[..., None, :], (arm.a * arm.z)[..., None, :]
    end_terms = a * arm.sums[..., -2:, :]
    d_ends = da * arm.sums[..., -2:, :] + a * arm.slopes[..., -2:, :]
    # before the window less its last sample: values and derivatives at once
    end_terms_and_slopes = np.concatenate((end_terms, d_ends), axis=-1)
    products = _swap_axes(end_terms_and_slopes * _SIGNS) @ end_terms_and_slopes
    den, num = _quotient(arm, energy, products[..., :arms, :arms])
    u = num / den
    num_k = ds[..., None, :] + products[..., :arms, arms:]
    den_k = -_swap_axes(a) * da
    u_k = (num_k - u * den_k) / den
    crossed = _swap_axes(u_k) * den_k
    u_jk = products[..., arms:, arms:] - crossed - _swap_axes(crossed) + u * (_swap_axes(da) * da)
    g, dg = arm.g[..., None, :], arm.dg[..., None, :]
    gg, g_dg = _swap_axes(g) * g, _swap_axes(g) * dg
    cross_product = _swap_axes(g_dg) * u_k
    return _Products(
        qq=gg * u,
        qp=g_dg * u + gg * u_k,
        pp=_swap_axes(dg) * dg * u + cross_product + _swap_axes(cross_product) + gg * u_jk / den,
    )


def _values(arm: _ArmSums, energy: float) -> FloatArray:
    """Inner products of arms alone."""
    end_values = arm.a[..., None, :] * arm.sums[..., -2:, :]
    den, num = _quotient(arm, energy, _swap_axes(end_values * _SIGNS) @ end_values)
    return np.asarray(arm.g[..., :, None] * arm.g[..., None, :] * num / den)


def _quotient(
    arm: _ArmSums, energy: float, end_products: FloatArray
) -> tuple[FloatArray, FloatArray]:
    s = arm.sums[..., -3, :]
    den = -np.expm1(-(arm.z[..., :, None] + arm.z[..., None, :]))
    return den, s[..., :, None] + s[..., None, :] - energy + end_products


def _swap_axes(a: FloatArray) -> FloatArray:
    return a.swapaxes(-1, -2)


def _mirror(gram: FloatArray, row: slice | int, column: slice, values: FloatArray) -> None:
    gram[..., row, column] = values
    gram[..., column, row] = values if isinstance(row, int) else _swap_axes(values)


def upper_factor(gram: FloatArray) -> FloatArray:
    """Upper factors R with R'R = gram, (..., c, c), scaled to a unit diagonal where in doubt.

    Dependent columns get a ridge of the size of rounding; a zero column stays zero.

    Raises
    ------
    FitError
        If a number is not finite, or rounding takes more than 1e-9 of the columns.
    """
    if gram.shape[-1] <= MAX_INDEPENDENT_COLUMNS:
        try:
            return np.asarray(np.swapaxes(np.linalg.cholesky(gram), -1, -2))
        except np.linalg.LinAlgError:  # so it is asked again, with all that follows
            pass
    values = np.diagonal(gram, axis1=-2, axis2=-1)
    is_positive = ~(values <= 0)  # what is no number is not passed over
    scale = np.sqrt(np.where(is_positive, values, 0.0))
    inverse_scale = np.where(is_positive, 1 / np.where(is_positive, scale, 1.0), 0.0)
    unit = gram * (inverse_scale[..., :, None] * inverse_scale[..., None, :])
    if not is_positive.all():
        unit += (~is_positive)[..., None] * np.eye(unit.shape[-1])
    ridge = 0.0
    if unit.shape[-1] > MAX_INDEPENDENT_COLUMNS:
        ridge = ROUNDING
        unit = unit + ridge * np.eye(unit.shape[-1])
    while True:
        try:
            lower = np.linalg.cholesky(unit)
        except np.linalg.LinAlgError:
            ridge = max(10 * ridge, 1e-15)
            if not ridge <= LARGEST_RIDGE:
                raise FitError(
                    "the terms of the fit are no finite numbers on this record, or no two of them "
                    "can be distinguished: its times and those of the records fitted with it "
                    "lie too far apart; check their units"
                ) from None
            unit = unit + ridge * np.eye(unit.shape[-1])
        else:
            return np.asarray(np.swapaxes(lower, -1, -2) * scale[..., None, :])


def correlate_displacement(
    time: FloatArray, x: FloatArray, fixed: FloatArray, *, start: int, stop: int
) -> ConvolvedMotion:
    """Correlate a displacement on a uniform grid, at rest at zero before its first sample.

    Parameters
    ----------
    time, x : array, shape (M,)
    fixed : array, shape (stop - start, q)
        Fixed columns over the window.
    start, stop : int
        The window.
    """
    d, moving = _steps(x[:stop])
    # the lags may wrap around where nothing moves any more
    fft_length = find_fast_length(stop + moving)
    lags = make_sample_plan(stop)
    initial_state = np.zeros(len(lags.nodes))
    if start:
        initial_state = lags.compress_to_nodes(reverse_before_start(d, start))
    lagged = np.fft.rfft(d, fft_length)
    without_columns = ConvolvedMotion(
        fixed=fixed,
        fixed_gram=fixed.T @ fixed,
        sequences=initial_state[None],
        lags=lags,
        steps_spectrum=np.conjugate(lagged, out=lagged),
        fft_length=fft_length,
        energy=float(d[start:] @ d[start:]),
        rounding=MIN_ENERGY * float(d @ d),
        start=start,
        count=stop,
        step=float(time[-1] - time[0]) / (len(time) - 1),
    )
    steps = _correlate_window_steps(without_columns, d, moving)
    rows = [_correlate_column(without_columns, column, x, d, steps) for column in fixed.T]
    nodes = lags.compute_stacked_nodes([*rows, steps, d[::-1]])
    sequences = np.concatenate((nodes[:-1], initial_state[None], nodes[-1:]))
    last_step = float(x[stop] - x[stop - 1] if stop < len(x) else d[-1])
    return replace(without_columns, sequences=sequences, steps=MotionSteps(d, last_step, steps))


def _steps(x: FloatArray) -> tuple[FloatArray, int]:
    """The steps of a motion from zero, and their number: what it still moves by is rounding."""
    end_distance = np.abs(x - x[-1])
    moving = int(np.flatnonzero(end_distance > REST_SHARE * end_distance.max())[-1:].sum()) + 2
    d = x.copy()
    d[1:] -= x[:-1]
    d[moving - 1 : moving] = x[-1] - x[moving - 2]
    d[moving:] = 0.0
    return d, min(moving, len(x))


def _correlate_column(
    motion: ConvolvedMotion, column: FloatArray, x: FloatArray, d: FloatArray, values: FloatArray
) -> FloatArray:
    r"""Correlation of a fixed column with the steps, in closed form where there is one.

    For a constant the sum of the steps telescopes. Summing by parts over the window that ends at
    e and starts after b gives that of a straight line of slope s, and of the displacement itself,

    .. math:: C_t(l) = t_e x_{e-l} - t_{b+1} x_{b-l} - s \sum_{b < i < e} x_{i-l}, \qquad
              C_x(l) - C_x(l+1) = -C_d(l+1) + x_e d_{e-l} - x_b d_{b-l}
    """
    start, stop = motion.start, motion.count
    if column[0] == column[-1] and (column == column[0]).all():
        return np.asarray(column[0] * (x[:stop][::-1] - reverse_before_start(x[:stop], start)))
    slope = uniform_step(column)
    if slope is not None:
        final_level = x[
            stop - 1
        ]  # a sum of what is left of it in the hold loses nothing to rounding
        total = np.cumsum(x[:stop] - final_level) + final_level * np.arange(1.0, stop + 1.0)
        line = column[-1] * x[:stop][::-1] - slope * reverse_before_start(total, stop - 1)
        if start:
            line -= reverse_before_start(column[0] * x[:stop] - slope * total, start)
        return np.asarray(line)
    if not np.array_equal(column, x[start:stop]):
        return motion.correlate_with_steps(column)
    # from the last lag to the first
    correlation = x[stop - 1] * d
    if start:
        correlation -= x[start - 1] * reverse_before_start(d, start)[::-1]
    correlation[1:] -= values[:0:-1]
    return np.cumsum(correlation)[::-1]


def correlation_block(
    exact: DataBlock, time: FloatArray, x: FloatArray, *, start: int, stop: int
) -> DataBlock:
    """Return the block of one force: its record correlated, every sample kept in `exact`.

    Its Gram matrix resolves an SSE to 1e-14 of the data's own sum of squares.
    """
    target, fixed, *_ = exact.evaluate(np.zeros(0), False)
    shared = correlate_displacement(time, x, fixed, start=start, stop=stop)
    return _make_force_block(exact, shared, Force.from_motion(shared, target), target)


def _make_force_block(
    exact: DataBlock, shared: ConvolvedMotion, force: Force, target: FloatArray
) -> DataBlock:
    def append_delayed_force(name: str, delayed_force: DelayedForce) -> DataBlock:
        lags = None
        if shared.steps is not None:
            lags = compute_delayed_lags(
                shared.steps, delayed_force, start=shared.start, interval=shared.step
            )
        return widen(name, delayed_force.column, lags)

    def widen(name: str, column: FloatArray, lags: FloatArray | None = None) -> DataBlock:
        extended = shared.with_fixed(column, lags)
        extended_force = force._replace(fixed=np.append(force.fixed, target @ column))
        return _make_force_block(exact.with_column(name, column), extended, extended_force, target)

    return replace(
        exact,
        rows=correlation_rows(shared, force, exact),
        accuracy=float(np.sqrt(ROUNDING)),
        rotated_basis=True,
        build_full=lambda: exact,
        add_fixed_column=widen,
        add_delayed_column=append_delayed_force,
    )
