"""Fit of poles: a rational fraction through the lines of measured FRFs."""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import BoolArray, ComplexArray, FloatArray
from dashpot.numerics.least_squares import Objective, descend

# Modal assurance criterion: similarity of two mode shapes.


def mac(shapes: ComplexArray, other_shapes: ComplexArray) -> FloatArray:
    r"""Modal assurance criterion of every one of `shapes` with every one of `other_shapes`.

    .. math:: \mathrm{MAC}_{ij} = \frac{|\varphi_i^H \psi_j|^2}
              {(\varphi_i^H \varphi_i)(\psi_j^H \psi_j)}

    Parameters
    ----------
    shapes, other_shapes : complex array, shape (n, r)
        Residues or shapes at n points; their lengths and phases do not matter.

    Returns
    -------
    array, shape (r, r)
        0 to 1; 0 if a shape is zero.

    Notes
    -----
    Allemang and Brown, *A correlation coefficient for modal vector analysis*, IMAC 1982.
    """
    cross_power = np.abs(shapes.conj().T @ other_shapes) ** 2
    norm_product = np.outer(
        (np.abs(shapes) ** 2).sum(axis=0), (np.abs(other_shapes) ** 2).sum(axis=0)
    )
    return np.asarray(
        np.divide(
            cross_power, norm_product, out=np.zeros_like(norm_product), where=norm_product > 0
        )
    )


# FRF lines to be fitted, and the shape of a pole on them.


# Smallest relative error of a line of a measured FRF: leakage and aliasing.
MIN_LINE_ERROR = 1e-3
MIN_ERROR_OF_PEAK = 3e-4  # and of the highest line: leakage is modelled that well


@dataclass(frozen=True, eq=False)
class FRFLines:
    """FRF lines to be fitted: one row of `value` and `sd` per channel.

    Attributes
    ----------
    s : complex array, shape (n,)
    value : complex array, shape (channels, n)
        Accelerance, 1/kg.
    sd : array, shape (channels, n)
    record : float or None
        Length of the record after the hit, s; None if the response was not cut.
    pulse : float
        Rms width of the hit, s.
    """

    s: ComplexArray
    value: ComplexArray
    sd: FloatArray
    record: float | None
    pulse: float = 0.0

    @classmethod
    def from_measurement(
        cls,
        s: ComplexArray,
        value: ComplexArray,
        sd: FloatArray | None,
        *,
        record: float | None,
        pulse: float = 0.0,
    ) -> FRFLines:
        """Return lines as an FRF holds them; `value` and `sd` of shape (channels, n)."""
        magnitude = np.abs(value)
        largest_magnitude = magnitude.max(axis=1, keepdims=True)
        error = np.broadcast_to(MIN_LINE_ERROR * largest_magnitude, magnitude.shape)
        if sd is not None:
            error = np.sqrt(
                sd**2
                + (MIN_LINE_ERROR * magnitude) ** 2
                + (MIN_ERROR_OF_PEAK * largest_magnitude) ** 2
            )
        return cls(s, value, error, record, pulse)

    def only(self, keep: BoolArray) -> FRFLines:
        """Return the chosen lines."""
        return replace(self, s=self.s[keep], value=self.value[:, keep], sd=self.sd[:, keep])


def pole_kernel(lines: FRFLines, p: complex | ComplexArray) -> ComplexArray:
    r"""Transform of :math:`e^{pt}` over the record (:mod:`.rational_fraction`), shape (n,).

    Of poles of shape (k, 1) it is a row for each.
    """
    s = lines.s
    if lines.record is None:
        return np.asarray(1 / (s - p))
    return np.asarray(-np.expm1(_compute_log_truncation(lines, p)) / (s - p))


def _compute_log_truncation(lines: FRFLines, p: complex | ComplexArray) -> ComplexArray:
    """Logarithm of the part that the end of the record takes."""
    T = lines.record or 0.0
    return np.asarray((p - lines.s) * T + 0.5 * lines.pulse**2 * (p**2 - lines.s**2))


def pole_kernel_slope(lines: FRFLines, p: complex | ComplexArray) -> ComplexArray:
    """Return derivative of :func:`pole_kernel` by the pole."""
    k = pole_kernel(lines, p)
    if lines.record is None:
        return k**2
    time_factor = lines.record + lines.pulse**2 * p
    return np.asarray((k - time_factor * np.exp(_compute_log_truncation(lines, p))) / (lines.s - p))


# Trial poles: best residues of every channel, and the remainder.
#
# Residues and background enter linearly (variable projection). The background needs no trial, so it
# is taken off the lines once; each trial has but the modes to solve for.


SLOW_POLES = (1e-3, 0.3, 1.5, 7.0)  # of the background, times the middle of the band
TRIAL_DAMPING_RATIOS = np.geomspace(3e-4, 0.4, 9)  # of damping, at which a pole is tried
MAX_BLOCK_SIZE = 1 << 20  # numbers of a block that is worked on at once
MAX_DAMPING = 0.75  # sigma / omega of a mode; beyond it is relaxation


@dataclass(frozen=True, eq=False)
class BackgroundProjection:
    """Lines projected off their background, which is independent of the poles.

    Real and imaginary part of each line are two rows, over its standard deviation.

    Attributes
    ----------
    lines : FRFLines
    basis : array, shape (channels, 2n, background)
        Orthonormal.
    projected_values : array, shape (channels, 2n)
        The values without it.
    """

    lines: FRFLines
    basis: FloatArray
    projected_values: FloatArray

    @classmethod
    def from_lines(cls, lines: FRFLines) -> BackgroundProjection:
        """Background: mass line, modes above the band and, as slow real poles, motion below it."""
        s = lines.s
        rates = np.array(SLOW_POLES) * float(np.sqrt(s.imag[0] * s.imag[-1]))
        columns = [np.ones_like(s), (s / s.imag[-1]) ** 2]
        columns += list(pole_kernel(lines, -rates[:, None].astype(complex)) * rates[1])
        rows = _make_rows(np.array(columns), lines.sd)
        basis = np.linalg.qr(rows / np.linalg.norm(rows, axis=1, keepdims=True))[0]
        y = _make_rows(lines.value[:, None], lines.sd)
        return cls(lines, basis, _subtract_projection(basis, y)[..., 0])

    @cached_property
    def broad(self) -> list[Scan]:
        """Poles of much damping all over the band, tried whenever one more is sought."""
        omega = self.lines.s.imag
        frequencies = np.geomspace(omega[0], omega[-1], 16)[1:-1]
        return scans(
            self.lines,
            [
                (r * frequency, float(frequency))
                for r in TRIAL_DAMPING_RATIOS[5:]
                for frequency in frequencies
            ],
        )

    def parts(self, columns: int) -> list[slice]:
        """Channels that are solved for at once: as many as a cache of so many columns holds."""
        channels, rows = self.projected_values.shape
        value = max(1, MAX_BLOCK_SIZE // (rows * max(columns, 1)))
        return [
            slice(first_channel, first_channel + value)
            for first_channel in range(0, channels, value)
        ]

    def remove_background(self, part: slice, columns: ComplexArray) -> FloatArray:
        """Weighted columns of shape (k, n) or (channels, k, n), the background taken off."""
        return _subtract_projection(self.basis[part], _make_rows(columns, self.lines.sd[part]))


class _Residues(NamedTuple):
    """Best residues of each channel, and their derivatives by the poles."""

    residues: ComplexArray  # (channels, modes)
    residuals: FloatArray  # (channels, 2n)
    inverse: FloatArray  # (channels, 2 modes, 2 modes): from rows' coordinates to coefficients
    crossing: FloatArray  # (channels, 2 modes, 2 modes): the slopes' coordinates
    normal: FloatArray  # (channels, 2 modes, 2 modes): slopes' products, residues projected out
    gradient: FloatArray  # (channels, 2 modes)


@dataclass(frozen=True, eq=False)
class PoleTrial:
    """Trial poles, as ln sigma and ln omega, with the best residues and background.

    Modes, two real coefficients each, are solved for channel by channel, so that it is no problem
    of dense rows; it descends as any other
    (:class:`dashpot.numerics.least_squares.Trial`).
    """

    background: BackgroundProjection
    theta: FloatArray

    @cached_property
    def poles(self) -> ComplexArray:
        """Shape (modes,)."""
        sigma, omega = np.exp(self.theta.reshape(-1, 2)).T
        return np.asarray(-sigma + 1j * omega)

    @cached_property
    def columns(self) -> ComplexArray:
        """Return the columns of a residue of 1 and of j, pole by pole: shape (2 modes, n)."""
        return _make_residue_columns(self.background.lines, self.poles)

    @cached_property
    def slopes(self) -> tuple[ComplexArray, ComplexArray]:
        """Slopes of the kernels of poles and of their conjugates, shape (modes, n) each."""
        lines, p = self.background.lines, self.poles[:, None]
        return pole_kernel_slope(lines, p), pole_kernel_slope(lines, p.conj())

    def basis(self, part: slice) -> tuple[FloatArray, FloatArray, FloatArray]:
        """The modes' rows of some channels, their orthonormal basis, and the way back from it."""
        rows = self.background.remove_background(part, self.columns)
        weight = 1 / self.background.lines.sd[part] ** 2
        scale = np.sqrt(weight @ (np.abs(self.columns) ** 2).T)
        q, triangle = np.linalg.qr(rows / scale[:, None, :])
        return rows, q, np.linalg.pinv(triangle, rcond=1e-12) / scale[:, :, None]

    @cached_property
    def solution(self) -> _Residues:
        """The linear problem at these poles."""
        residues = [self._solve_residues(part) for part in self.background.parts(len(self.theta))]
        return _Residues(*(np.concatenate(group) for group in zip(*residues, strict=True)))

    def _solve_residues(self, part: slice) -> _Residues:
        rows, q, inverse = self.basis(part)
        y = self.background.projected_values[part]
        c = _multiply(inverse, _multiply(q.swapaxes(1, 2), y))
        residual = y - _multiply(rows, c)
        residues = c[:, 0::2] + 1j * c[:, 1::2]
        upper_kernel, lower = (
            by[None] * slope
            for by, slope in zip(
                (residues[..., None], residues[..., None].conj()), self.slopes, strict=True
            )
        )
        slopes = np.empty((len(c), len(self.theta), upper_kernel.shape[-1]), complex)
        sigma, omega = -self.poles.real[:, None], self.poles.imag[:, None]
        slopes[:, 0::2], slopes[:, 1::2] = (
            -sigma * (upper_kernel + lower),
            1j * omega * (upper_kernel - lower),
        )
        jacobian = self.background.remove_background(part, slopes)
        crossing = q.swapaxes(1, 2) @ jacobian
        jacobian -= q @ crossing
        transposed = jacobian.swapaxes(1, 2)
        return _Residues(
            residues,
            residual,
            inverse,
            crossing,
            transposed @ jacobian,
            _multiply(transposed, residual),
        )

    @cached_property
    def sse(self) -> float:
        """Sum of squared residuals; infinite where a pole does not oscillate."""
        if (self.theta[0::2] - self.theta[1::2] >= np.log(MAX_DAMPING)).any():
            return np.inf
        return float((self.solution.residuals**2).sum())

    @cached_property
    def gradient(self) -> FloatArray:
        """Half the slope of the sum of squares by theta."""
        return np.asarray(-self.solution.gradient.sum(axis=0))

    @cached_property
    def curvature(self) -> FloatArray:
        """Gauss-Newton curvature."""
        return np.asarray(self.solution.normal.sum(axis=0))

    def step_ahead(self, step: FloatArray) -> PoleTrial:
        """Return the trial a short step away."""
        return replace(self, theta=self.theta + step)

    @cached_property
    def misfit(self) -> FloatArray:
        """Squared residual of each line over its variance, shape (channels, n)."""
        residuals = self.solution.residuals
        return np.asarray((residuals.reshape(len(residuals), -1, 2) ** 2).sum(axis=2))

    @property
    def residues(self) -> ComplexArray:
        """Shape (channels, modes)."""
        return self.solution.residues

    @property
    def beta(self) -> FloatArray:
        """The residues' real and imaginary parts in turn, shape (channels * 2 modes,)."""
        return self.residues.view(float).ravel()

    def select_modes(self, modes: list[int]) -> PoleTrial:
        """Return the chosen modes."""
        return replace(self, theta=self.theta.reshape(-1, 2)[modes].ravel())


class Scan(NamedTuple):
    """Scan of candidate poles, with all that is independent of the present ones."""

    poles: ComplexArray
    rows: FloatArray  # (2 poles, 2n)
    squares: FloatArray  # (3, channels, poles): of each pair of weighted rows, and their product


def scans(lines: FRFLines, starts: list[tuple[float, float]]) -> list[Scan]:
    """Yield several (sigma, omega), as many in each as memory allows."""
    weights = 1 / np.repeat(lines.sd, 2, axis=1) ** 2
    value = max(1, MAX_BLOCK_SIZE // weights.shape[1])
    scans = []
    for first in range(0, len(starts), value):
        poles = np.array([complex(-sigma, omega) for sigma, omega in starts[first : first + value]])
        rows = _make_residue_columns(lines, poles).view(float)
        values, omegas = rows[0::2], rows[1::2]
        pairs = ((values, values), (values, omegas), (omegas, omegas))
        scans.append(Scan(poles, rows, np.array([weights @ (u * v).T for u, v in pairs])))
    return scans


def _make_residue_columns(lines: FRFLines, poles: ComplexArray) -> ComplexArray:
    """Return the responses of each pole for the residues 1 and j, shape (2 poles, n)."""
    p = poles[:, None]
    upper_kernel, lower_kernel = pole_kernel(lines, p), pole_kernel(lines, p.conj())
    pairs = np.empty((2 * len(poles), len(lines.s)), complex)
    pairs[0::2], pairs[1::2] = upper_kernel + lower_kernel, 1j * (upper_kernel - lower_kernel)
    return pairs


def _make_rows(columns: ComplexArray, sd: FloatArray) -> FloatArray:
    """Weighted real and imaginary parts of each line, shape (channels, 2n, k)."""
    return np.ascontiguousarray(columns / sd[:, None]).view(float).swapaxes(1, 2)


def _subtract_projection(basis: FloatArray, rows: FloatArray) -> FloatArray:
    """Return what of rows an orthonormal basis does not have, by channel."""
    return np.asarray(rows - basis @ (basis.swapaxes(1, 2) @ rows))


def _multiply(matrix: FloatArray, vector: FloatArray) -> FloatArray:
    """Return the product of matrix and vector for each channel."""
    return np.asarray((matrix @ vector[..., None])[..., 0])


# Modes as the poles of a rational fraction, fitted to what a record of finite length shows.
#
# The accelerance of lightly coupled modes is, on the Laplace plane,
#
# .. math:: A(s) = \sum_i \left[R_i\,\kappa(s, p_i) + R_i^*\,\kappa(s, p_i^*)\right] + b(s), \qquad
#           \kappa(s, p) = \frac{1 - e^{(p - s) T + \vartheta^2 (p^2 - s^2)/2}}{s - p}
#
# where :math:`\kappa` is the transform of :math:`e^{pt}` over the record alone, T after the middle
# of a pulse of rms width :math:`\vartheta` (its own transform goes as :math:`e^{\vartheta^2 s^2/2}`
# to second order): leakage is part of the model, not an error. Residues and the background b enter
# linearly and are solved for exactly at each trial of the poles (variable projection); b holds the
# mass line, modes above the band and, as slow real poles, relaxation and modes below it.


MAX_STEPS = 60
STEP_TOLERANCE = 0.2  # variances: what a last step may explain while modes are sought
MIN_NEW_RESIDUAL = 1e-10  # of a column's square: what rounding leaves of one that is known
MIN_MODE_SHARE = 0.01  # of the largest value in the band
OUTER_FACTORS = (1.02, 1.1, 1.3)  # times the band's ends, where poles beyond it are tried
BACKGROUND_FACTOR = 2.0  # beyond which the background says the same
MAX_MAC = 0.8  # by the modal assurance criterion: two shapes too alike to separate close poles


@dataclass(frozen=True, eq=False)
class PoleFit:
    """Fitted poles, common to all channels, with each channel's residues.

    Attributes
    ----------
    poles : complex array, shape (modes,)
        Upper half of the plane, 1/s.
    residues : complex array, shape (channels, modes)
        Residues of the accelerance.
    covariance : array, shape (2 modes, 2 modes)
        Covariance of sigma and omega of each mode.
    residue_se : array, shape (channels, modes)
        Standard error of real and imaginary part together.
    misfit : array, shape (modes,)
        Squared over its variance, of the lines about each mode, for each degree of freedom.
    """

    poles: ComplexArray
    residues: ComplexArray
    covariance: FloatArray
    residue_se: FloatArray
    misfit: FloatArray


def find_poles(lines: FRFLines, *, max_modes: int, count: int | None = None) -> PoleFit | None:
    """Return the modes: add one at a time where the residual is largest, until none is significant.

    Parameters
    ----------
    lines : FRFLines
    max_modes : int
        Largest number of modes.
    count : int, optional
        Exactly this many instead of as many as matter.

    Returns
    -------
    PoleFit or None
        None if there is no mode in the lines.
    """
    trial = pole_trial = PoleTrial(BackgroundProjection.from_lines(lines), np.empty(0))
    failures = 0
    for _ in range(count or max_modes):
        last, trial = trial, _refine(_add_next_pole(trial), STEP_TOLERANCE)
        if count is not None or _is_last_supported(trial, last):
            pole_trial, failures = trial, 0
        else:
            failures += 1  # one of two like modes does not matter before the other is there
        if failures == 2:
            break
    pole_trial = _refine(pole_trial)
    if count is None:
        pole_trial = _prune(pole_trial)
    modes = len(pole_trial.poles)
    return _finish(_add_outer_poles(pole_trial), modes) if modes else None


def residues_at(lines: FRFLines, poles: ComplexArray) -> ComplexArray:
    """Best residues of each row at given poles, shape (channels, modes)."""
    theta = np.log(np.ravel(np.column_stack((-poles.real, poles.imag))))
    return PoleTrial(BackgroundProjection.from_lines(lines), theta).residues


def _prune(trial: PoleTrial) -> PoleTrial:
    """Drop poles that are no modes until only modes remain."""
    while trial.theta.size:
        mode_indices = [i for i in range(len(trial.poles)) if _is_mode(trial, i)]
        if len(mode_indices) == len(trial.poles):
            break
        trial = trial.select_modes(mode_indices)
        trial = _refine(trial) if mode_indices else trial
    return trial


def _select_mode_lines(lines: FRFLines, p: complex) -> BoolArray:
    """Return the lines that decide about a mode: ten to either side, or three half-power widths."""
    omega = lines.s.imag
    half_range = max(10.5 * float(np.median(np.diff(omega))), -6 * p.real)
    return np.asarray(np.abs(omega - p.imag) <= half_range)


def _refine(trial: PoleTrial, tolerance: float = 0.0) -> PoleTrial:
    """Return the nearest optimum of the poles, the residues projected out.

    Ends where a step promises no more than `tolerance` variances, as one for each row of the lines.
    """
    is_free = np.full(len(trial.theta), np.inf)
    objective = Objective(lambda theta, _: replace(trial, theta=theta), -is_free, is_free)
    cost_tolerance = max(1e-13, tolerance / trial.background.projected_values.size)
    descent = descend(objective, trial.theta, cost_tolerance=cost_tolerance, limit=MAX_STEPS)
    return trial if descent is None else descent.point


def _add_next_pole(trial: PoleTrial) -> PoleTrial:
    """Scan frequency and damping about the line that the poles so far miss by most."""
    lines, omega = trial.background.lines, trial.background.lines.s.imag
    missed_power = (trial.misfit * lines.sd**2).sum(axis=0)
    worst_line, step = float(omega[np.argmax(missed_power)]), float(np.median(np.diff(omega)))
    # sharp peaks stand where most is missed, to a line; broad ones may be missed most beside it
    starts = [
        (r * worst_line, worst_line + i * step)
        for r in TRIAL_DAMPING_RATIOS
        for i in np.linspace(-1.5, 1.5, 7)
        if worst_line + i * step > 0
    ]
    return _add_best_pole(trial, scans(lines, starts) + trial.background.broad)[0]


def _add_best_pole(trial: PoleTrial, candidates: list[Scan]) -> tuple[PoleTrial, float]:
    """Add the pole, of several, that explains most, and say how much that is."""
    gains = np.concatenate([_compute_gains(trial, scan) for scan in candidates])
    best = int(np.argmax(gains))
    pole = np.concatenate([scan.poles for scan in candidates])[best]
    theta = np.append(trial.theta, np.log((-pole.real, pole.imag)))
    return replace(trial, theta=theta), float(gains[best])


def _compute_gains(trial: PoleTrial, scan: Scan) -> FloatArray:
    """Return the fall of the squared residuals by each of these poles, unrefined."""
    background, count = trial.background, len(scan.poles)
    gains = np.zeros(count)
    for i, (sd, r) in enumerate(zip(background.lines.sd, trial.solution.residuals, strict=True)):
        weight = 1 / np.repeat(sd, 2)
        values = (
            np.hstack((background.basis[i], trial.basis(slice(i, i + 1))[1][0])) * weight[:, None]
        )
        # what the rest cannot say as well: the rest is orthonormal, and the residual without it
        explained = (scan.rows @ values).reshape(count, 2, -1)
        x, y = (scan.rows @ (r * weight)).reshape(-1, 2).T
        a, b, c = scan.squares[:, i]
        margin = MIN_NEW_RESIDUAL * (a + c)
        a, c = (
            value - (explained[:, k] ** 2).sum(axis=1) + margin for k, value in enumerate((a, c))
        )
        b = b - (explained[:, 0] * explained[:, 1]).sum(axis=1)
        gains += (c * x**2 - 2 * b * x * y + a * y**2) / (a * c - b**2)
    return gains


def _add_outer_poles(trial: PoleTrial) -> PoleTrial:
    """Add poles beyond either end of the band, as background, where they explain what is missed."""
    omega, value_count = trial.background.lines.s.imag, trial.background.projected_values.size
    low, high = float(omega[0]), float(omega[-1])
    outer_frequencies = [
        float(pole_frequency) for by in OUTER_FACTORS for pole_frequency in (low / by, high * by)
    ]
    starts = [
        (ratio * pole_frequency, pole_frequency)
        for pole_frequency in outer_frequencies
        for ratio in (0.003, 0.02, 0.1)
    ]
    scanned_poles = scans(trial.background.lines, starts)
    for _ in range(2):
        refined_trial, gain = _add_best_pole(trial, scanned_poles)
        # a scan shows a part of what a refined pole explains
        if 10 * gain < trial.sse * _get_least_gain(trial) / value_count:
            break
        refined_trial = _refine(refined_trial)
        pole_frequency = refined_trial.poles[-1].imag
        is_outside = (
            low / BACKGROUND_FACTOR < pole_frequency <= low
            or high <= pole_frequency < high * BACKGROUND_FACTOR
        )
        if (
            not is_outside
            or trial.sse - refined_trial.sse
            < refined_trial.sse * _get_least_gain(trial) / value_count
        ):
            break
        trial = refined_trial
    return trial


def _get_least_gain(trial: PoleTrial) -> float:
    """Return the gain in variances by which a pole is accepted."""
    return float(
        3 * _count_parameters(trial.misfit) * np.log(trial.background.projected_values.size)
    )


def _finish(trial: PoleTrial, modes: int) -> PoleFit:
    """Residues of the first poles, and all errors: every channel shows the poles."""
    solution = trial.solution
    scales = 1 / np.ravel(
        np.column_stack((-trial.poles.real, trial.poles.imag))
    )  # not by logarithms
    normal = trial.curvature * np.outer(scales, scales)
    scale = np.sqrt(np.diag(normal))
    inverse_normal = np.linalg.pinv(normal / np.outer(scale, scale)) / np.outer(scale, scale)
    covariance = inverse_normal[: 2 * modes, : 2 * modes]
    inverse = solution.inverse[:, : 2 * modes]
    change = inverse @ (solution.crossing * scales)
    variance = (inverse**2).sum(axis=2) + ((change @ inverse_normal) * change).sum(axis=2)
    # what the model misses about a mode widens that mode's error
    misfit = np.array([_compute_chi2(trial, p) for p in trial.poles[:modes]])
    error_factor = np.sqrt(np.maximum(misfit, 1.0))
    return PoleFit(
        poles=trial.poles[:modes],
        residues=trial.residues[:, :modes],
        covariance=covariance * np.outer(np.repeat(error_factor, 2), np.repeat(error_factor, 2)),
        residue_se=np.sqrt(variance[:, 0::2] + variance[:, 1::2]) * error_factor,
        misfit=misfit,
    )


def _compute_chi2(trial: PoleTrial, p: complex) -> float:
    """Misfit per degree of freedom of the lines about a mode."""
    misfit_near_mode = trial.misfit[:, _select_mode_lines(trial.background.lines, p)]
    return float(misfit_near_mode.sum()) / max(
        2 * misfit_near_mode.size - _count_parameters(misfit_near_mode), 1
    )


def _count_parameters(channels: FloatArray) -> int:
    """Return the number of parameters of one mode: its pole, and a residue in each channel."""
    return 2 + 2 * len(channels)


def _is_last_supported(trial: PoleTrial, previous: PoleTrial) -> bool:
    """Return whether the last mode is a real one and explains more than chance would."""
    if not _is_mode(trial, len(trial.poles) - 1):
        return False
    p = trial.poles[-1]
    mode_lines = _select_mode_lines(trial.background.lines, p)
    gain = float((previous.misfit - trial.misfit)[:, mode_lines].sum()) / max(
        _compute_chi2(trial, p), 1e-300
    )
    return bool(gain > _get_least_gain(trial))


def _is_mode(trial: PoleTrial, i: int) -> bool:
    """Return whether pole i is in the band, oscillates, decays, is distinct and tall."""
    lines, p = trial.background.lines, trial.poles[i]
    omega, record = lines.s.imag, lines.record
    if not omega[0] < p.imag < omega[-1] or -p.real > 0.99 * MAX_DAMPING * p.imag:
        return False
    # what stands on one line is hum: lines are no closer than a record is long
    record_length = record or 2 * np.pi / float(np.median(np.diff(omega)))
    if -p.real * record_length < 1e-2:
        return False
    residue = np.abs(trial.residues)
    taller = residue.max(axis=0) > residue[:, i].max()
    # closer than this no record of such length distinguishes two modes, unless their shapes do
    difference = max(-0.5 * p.real, 0.0 if record is None else 3 * np.pi / record)
    is_similar = mac(trial.residues, trial.residues[:, [i]])[:, 0] > MAX_MAC
    if (np.abs(trial.poles - p)[taller & is_similar] < difference).any():
        return False
    height = residue[:, i] * float(np.abs(pole_kernel(lines, p)).max())
    return bool((height >= MIN_MODE_SHARE * np.abs(lines.value).max(axis=1)).any())
