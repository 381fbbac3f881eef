r"""Modes as the poles of a rational fraction, fitted to what a record of finite length shows.

The accelerance of lightly coupled modes is, on the Laplace plane,

.. math:: A(s) = \sum_i \left[R_i\,\kappa(s, p_i) + R_i^*\,\kappa(s, p_i^*)\right] + b(s), \qquad
          \kappa(s, p) = \frac{1 - e^{(p - s) T + \vartheta^2 (p^2 - s^2)/2}}{s - p}

where :math:`\kappa` is the transform of :math:`e^{pt}` over the record alone, T after the middle of
a pulse of rms width :math:`\vartheta` (its own transform goes as :math:`e^{\vartheta^2 s^2/2}` to
second order): leakage is part of the model, not an error. Residues and the background b enter
linearly and are solved for exactly at each trial of the poles (variable projection); b holds the
mass line, modes above the band and, as slow real poles, relaxation and modes below it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from dashpot.base.arrays import BoolArray, ComplexArray, FloatArray
from dashpot.vibration.modal.lines import Lines, kernel, kernel_slope
from dashpot.vibration.modal.shapes import mac

STEPS = 60
MOST_DAMPED = 0.75  # sigma / omega of a mode; beyond it is relaxation
SLOW_POLES = (1e-3, 0.3, 1.5, 7.0)  # of the background, times the middle of the band
SMALLEST_MODE = 0.01  # of the largest value in the band
OUTSIDE = (1.02, 1.1, 1.3)  # times the band's ends, where poles beyond it are tried
FARTHEST = 2.0  # beyond which the background says the same
ALIKE = 0.8  # by the modal assurance criterion: two shapes that no close poles are told apart by


@dataclass(frozen=True, eq=False)
class PoleFit:
    """Poles common to all channels, and each channel's residues.

    Attributes
    ----------
    poles : complex array, shape (modes,)
        Upper half of the plane, 1/s.
    residues : complex array, shape (channels, modes)
        Of the accelerance.
    covariance : array, shape (2 modes, 2 modes)
        Of sigma and omega of each mode.
    residue_se : array, shape (channels, modes)
        Of real and imaginary part together.
    misfit : array, shape (modes,)
        Squared over its variance, of the lines about each mode, for each degree of freedom.
    """

    poles: ComplexArray
    residues: ComplexArray
    covariance: FloatArray
    residue_se: FloatArray
    misfit: FloatArray


@dataclass(frozen=True, eq=False)
class _Trial:
    """Poles, as ln sigma and omega of each, with the best residues and background there.

    Background and modes, two real coefficients each, are solved for channel by channel.
    """

    lines: Lines
    theta: FloatArray

    @cached_property
    def poles(self) -> ComplexArray:
        """Shape (modes,)."""
        return np.asarray(-np.exp(self.theta[0::2]) + 1j * self.theta[1::2])

    @cached_property
    def columns(self) -> ComplexArray:
        """Modes, then the background: shape (n, 2 modes + background)."""
        lines, s = self.lines, self.lines.s
        columns = [column for p in self.poles for column in _mode_columns(lines, p)]
        centre = float(np.sqrt(s.imag[0] * s.imag[-1]))
        top = float(s.imag[-1])
        columns += [np.ones_like(s), (s / top) ** 2]
        rates = np.array(SLOW_POLES) * centre
        columns += [kernel(lines, complex(-rate)) * centre for rate in rates]
        return np.array(columns).T

    @cached_property
    def solution(self) -> tuple[list[FloatArray], list[FloatArray]]:
        """Coefficients and weighted residuals by channel."""
        coefficients, residuals = [], []
        for value, sd in zip(self.lines.value, self.lines.sd, strict=True):
            rows, y = _stack(self.columns, 1 / sd), _stack(value, 1 / sd)
            scale = np.linalg.norm(rows, axis=0)
            q, triangle = np.linalg.qr(rows / scale)
            c = np.linalg.lstsq(triangle, q.T @ y, rcond=1e-12)[0] / scale
            coefficients.append(c)
            residuals.append(y - rows @ c)
        return coefficients, residuals

    @cached_property
    def cost(self) -> float:
        """Sum of squared residuals."""
        return sum(float(r @ r) for r in self.solution[1])

    @cached_property
    def misfit(self) -> FloatArray:
        """Squared residual of each line over its variance, shape (channels, n)."""
        return np.array([(r.reshape(2, -1) ** 2).sum(axis=0) for r in self.solution[1]])

    @cached_property
    def residues(self) -> ComplexArray:
        """Shape (channels, modes)."""
        c = np.array(self.solution[0])[:, : len(self.theta)]
        return np.asarray(c[:, 0::2] + 1j * c[:, 1::2])

    def slopes(self, channel: int) -> ComplexArray:
        """Derivative of the modes' sum by ln sigma and omega at fixed residues, (n, 2 modes)."""
        columns = []
        for p, residue in zip(self.poles, self.residues[channel], strict=True):
            up = residue * kernel_slope(self.lines, p)
            down = residue.conjugate() * kernel_slope(self.lines, p.conjugate())
            columns += [p.real * (up + down), 1j * (up - down)]
        return np.array(columns).T

    def only(self, modes: list[int]) -> _Trial:
        """The chosen modes."""
        return replace(self, theta=self.theta.reshape(-1, 2)[modes].ravel())


def find_poles(lines: Lines, *, most: int, count: int | None = None) -> PoleFit | None:
    """Add modes, each where the others leave most, until none is left that matters.

    Parameters
    ----------
    lines : Lines
    most : int
        Largest number of modes.
    count : int, optional
        Exactly this many instead of as many as matter.

    Returns
    -------
    PoleFit or None
        None if there is no mode in the lines.
    """
    trial = kept = _Trial(lines, np.empty(0))
    failures = 0
    for _ in range(count or most):
        last, trial = trial, _refine(_with_next_pole(trial))
        if count is not None or _matters(trial, last):
            kept, failures = trial, 0
        else:
            failures += 1  # one of two like modes does not matter before the other is there
        if failures == 2:
            break
    if count is None:
        kept = _prune(kept)
    modes = len(kept.poles)
    return _finish(_with_outer_poles(kept), modes) if modes else None


def residues_at(lines: Lines, poles: ComplexArray) -> ComplexArray:
    """Best residues of each row at given poles, shape (channels, modes)."""
    theta = np.ravel(np.column_stack((np.log(-poles.real), poles.imag)))
    return _Trial(lines, theta).residues


def _prune(trial: _Trial) -> _Trial:
    """Drop what is no mode until all are."""
    while trial.theta.size:
        good = [i for i in range(len(trial.poles)) if _is_mode(trial, i)]
        if len(good) == len(trial.poles):
            break
        trial = trial.only(good)
        trial = _refine(trial) if good else trial
    return trial


def _mode_columns(lines: Lines, p: complex) -> tuple[ComplexArray, ComplexArray]:
    """What a residue of 1 and of j looks like."""
    up, down = kernel(lines, p), kernel(lines, p.conjugate())
    return up + down, 1j * (up - down)


def _stack(values: ComplexArray, weight: FloatArray) -> FloatArray:
    """Real above imaginary parts, weighted."""
    w = weight if values.ndim == 1 else weight[:, None]
    return np.concatenate((values.real * w, values.imag * w))


def _near(lines: Lines, p: complex) -> BoolArray:
    """The lines that decide about a mode: ten to either side, or three half-power widths."""
    omega = lines.s.imag
    reach = max(10.5 * float(np.median(np.diff(omega))), -6 * p.real)
    return np.asarray(np.abs(omega - p.imag) <= reach)


def _refine(trial: _Trial) -> _Trial:
    """Levenberg-Marquardt over the poles, the residues projected out (Kaufman's Jacobian)."""
    damping = 1e-3
    for _ in range(STEPS):
        normal, gradient = _normal(trial)
        diagonal = np.diag(normal).copy()
        diagonal[diagonal == 0] = 1.0
        better = None
        while better is None and damping < 1e8:
            step = np.linalg.solve(normal + damping * np.diag(diagonal), gradient)
            step[0::2] = np.clip(step[0::2], -2.0, 2.0)
            theta = trial.theta + step
            if (np.exp(theta[0::2]) < MOST_DAMPED * theta[1::2]).all():
                there = _Trial(trial.lines, theta)
                better = there if there.cost <= trial.cost else None
            damping = damping * 10 if better is None else max(damping / 10, 1e-12)
        if better is None:
            break
        gain, trial = trial.cost - better.cost, better
        if gain <= 1e-13 * trial.cost or np.abs(step).max() < 1e-13:
            break
    return trial


def _normal(trial: _Trial) -> tuple[FloatArray, FloatArray]:
    """Normal matrix and gradient of the poles."""
    size = len(trial.theta)
    normal, gradient = np.zeros((size, size)), np.zeros(size)
    for i, (r, sd) in enumerate(zip(trial.solution[1], trial.lines.sd, strict=True)):
        basis, _ = np.linalg.qr(_stack(trial.columns, 1 / sd))
        jacobian = _stack(trial.slopes(i), 1 / sd)
        jacobian = jacobian - basis @ (basis.T @ jacobian)
        normal += jacobian.T @ jacobian
        gradient += jacobian.T @ r
    return normal, gradient


def _with_next_pole(trial: _Trial) -> _Trial:
    """Scan frequency and damping about the line that the poles so far miss by most."""
    lines, omega = trial.lines, trial.lines.s.imag
    missed = (trial.misfit * lines.sd**2).sum(axis=0)
    worst, step = float(omega[np.argmax(missed)]), float(np.median(np.diff(omega)))
    ratios = np.geomspace(3e-4, 0.4, 9)
    # sharp peaks stand where most is missed, to a line; broad ones may be missed most beside it
    starts = [(r * worst, worst + i * step) for r in ratios for i in np.linspace(-1.5, 1.5, 7)]
    broad = np.geomspace(omega[0], omega[-1], 16)[1:-1]
    starts += [(r * at, float(at)) for r in ratios[5:] for at in broad]
    return _with_best(trial, starts)[0]


def _with_best(trial: _Trial, starts: list[tuple[float, float]]) -> tuple[_Trial, float]:
    """Add the pole, of several (sigma, omega), that explains most, and say how much that is."""
    lines = trial.lines
    weights = [1 / sd for sd in lines.sd]
    bases = [np.linalg.qr(_stack(trial.columns, weight))[0] for weight in weights]
    best, start = -np.inf, np.zeros(2)
    for sigma, at in starts:
        pair = np.column_stack(_mode_columns(lines, complex(-sigma, at)))
        gain = 0.0
        for weight, basis, r in zip(weights, bases, trial.solution[1], strict=True):
            new = _stack(pair, weight)
            new = new - basis @ (basis.T @ new)  # what the rest cannot say as well
            gain += float(r @ new @ np.linalg.pinv(new.T @ new) @ (new.T @ r))
        if gain > best:
            best, start = gain, np.array([np.log(sigma), at])
    return _Trial(lines, np.concatenate((trial.theta, start))), best


def _with_outer_poles(trial: _Trial) -> _Trial:
    """Add poles beyond either end of the band, as background, where they explain what is missed."""
    omega, size = trial.lines.s.imag, 2 * trial.lines.value.size
    low, high = float(omega[0]), float(omega[-1])
    places = [float(at) for by in OUTSIDE for at in (low / by, high * by)]
    starts = [(ratio * at, at) for at in places for ratio in (0.003, 0.02, 0.1)]
    for _ in range(2):
        more, gain = _with_best(trial, starts)
        # a scan shows a part of what a refined pole explains
        if 10 * gain < trial.cost * _worth(trial) / size:
            break
        more = _refine(more)
        at = more.poles[-1].imag
        beyond = low / FARTHEST < at <= low or high <= at < high * FARTHEST
        if not beyond or trial.cost - more.cost < more.cost * _worth(trial) / size:
            break
        trial = more
    return trial


def _worth(trial: _Trial) -> float:
    """What a pole must explain, in variances, to be there."""
    return float(3 * _parameters(trial.misfit) * np.log(2 * trial.lines.value.size))


def _finish(trial: _Trial, modes: int) -> PoleFit:
    """Residues of the first poles, and all errors: every channel tells the poles."""
    every = len(trial.poles)
    normal = np.zeros((2 * every, 2 * every))
    channels = []
    for i, sd in enumerate(trial.lines.sd):
        slopes = _stack(trial.slopes(i), 1 / sd)
        slopes[:, 0::2] /= -trial.poles.real  # by sigma, not by its logarithm
        columns = _stack(trial.columns, 1 / sd)
        scale = np.linalg.norm(columns, axis=0)
        q, triangle = np.linalg.qr(columns / scale)
        apart = slopes - q @ (q.T @ slopes)
        normal += apart.T @ apart
        inverse = (np.linalg.pinv(triangle, rcond=1e-12) / scale[:, None])[: 2 * modes]
        channels.append((inverse, inverse @ (q.T @ slopes)))
    scale = np.sqrt(np.diag(normal))
    whole = np.linalg.pinv(normal / np.outer(scale, scale)) / np.outer(scale, scale)
    covariance = whole[: 2 * modes, : 2 * modes]
    variance = np.array(
        [(own**2).sum(axis=1) + ((by @ whole) * by).sum(axis=1) for own, by in channels]
    )
    # what the model misses about a mode widens that mode's error
    misfit = np.array([_chi2(trial, p) for p in trial.poles[:modes]])
    worse = np.sqrt(np.maximum(misfit, 1.0))
    return PoleFit(
        poles=trial.poles[:modes],
        residues=trial.residues[:, :modes],
        covariance=covariance * np.outer(np.repeat(worse, 2), np.repeat(worse, 2)),
        residue_se=np.sqrt(variance[:, 0::2] + variance[:, 1::2]) * worse,
        misfit=misfit,
    )


def _chi2(trial: _Trial, p: complex) -> float:
    """Misfit per degree of freedom of the lines about a mode."""
    near = trial.misfit[:, _near(trial.lines, p)]
    return float(near.sum()) / max(2 * near.size - _parameters(near), 1)


def _parameters(channels: FloatArray) -> int:
    """Of one mode: its pole, and a residue in each channel."""
    return 2 + 2 * len(channels)


def _matters(trial: _Trial, before: _Trial) -> bool:
    """Tell whether the last mode added is one, and explains more than chance would."""
    if not _is_mode(trial, len(trial.poles) - 1):
        return False
    p = trial.poles[-1]
    near = _near(trial.lines, p)
    gain = float((before.misfit - trial.misfit)[:, near].sum()) / max(_chi2(trial, p), 1e-300)
    return bool(gain > _worth(trial))


def _is_mode(trial: _Trial, i: int) -> bool:
    """Tell whether pole i lies in the band, oscillates, decays, is distinct and tall."""
    lines, p = trial.lines, trial.poles[i]
    omega, record = lines.s.imag, lines.record
    if not omega[0] < p.imag < omega[-1] or -p.real > 0.99 * MOST_DAMPED * p.imag:
        return False
    if record is not None and -p.real * record < 1e-2:
        return False
    residue = np.abs(trial.residues)
    taller = residue.max(axis=0) > residue[:, i].max()
    # closer than this no record of such length tells two modes apart, unless their shapes do
    apart = max(-0.5 * p.real, 0.0 if record is None else 3 * np.pi / record)
    alike = mac(trial.residues, trial.residues[:, [i]])[:, 0] > ALIKE
    if (np.abs(trial.poles - p)[taller & alike] < apart).any():
        return False
    height = residue[:, i] * float(np.abs(kernel(lines, p)).max())
    return bool((height >= SMALLEST_MODE * np.abs(lines.value).max(axis=1)).any())
