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

import numpy as np

from dashpot.base.arrays import BoolArray, ComplexArray, FloatArray

FLOOR = 1e-3  # relative error below which no line of a measured FRF is trusted
FLOOR_OF_TOP = 3e-4  # and of the highest line: leakage is modelled that well
STEPS = 60
MOST_DAMPED = 0.75  # sigma / omega of a mode; beyond it is relaxation
SLOW_POLES = (1e-3, 0.3, 1.5, 7.0)  # of the background, times the middle of the band
SMALLEST_MODE = 0.01  # of the largest value in the band


@dataclass(frozen=True, eq=False)
class Lines:
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
    def measured(
        cls,
        s: ComplexArray,
        value: ComplexArray,
        sd: FloatArray | None,
        *,
        record: float | None,
        pulse: float = 0.0,
    ) -> Lines:
        """Lines as an FRF holds them; `value` and `sd` of shape (channels, n)."""
        size = np.abs(value)
        top = size.max(axis=1, keepdims=True)
        error = np.broadcast_to(FLOOR * top, size.shape)
        if sd is not None:
            error = np.sqrt(sd**2 + (FLOOR * size) ** 2 + (FLOOR_OF_TOP * top) ** 2)
        return cls(s, value, error, record, pulse)

    def only(self, keep: BoolArray) -> Lines:
        """The chosen lines."""
        return replace(self, s=self.s[keep], value=self.value[:, keep], sd=self.sd[:, keep])


@dataclass(frozen=True, eq=False)
class PoleFit:
    """Poles common to all channels, and each channel's residues.

    Attributes
    ----------
    poles : complex array, shape (modes,)
        Upper half of the plane, 1/s.
    residues : complex array, shape (channels, modes)
        Of the accelerance.
    covariance : array, shape (4 modes, 4 modes)
        Of sigma, omega of each mode, then of real and imaginary residues of the first channel.
    """

    poles: ComplexArray
    residues: ComplexArray
    covariance: FloatArray


def kernel(lines: Lines, p: complex) -> ComplexArray:
    r"""Transform of :math:`e^{pt}` over the record (module docstring), shape (n,)."""
    s = lines.s
    if lines.record is None:
        return np.asarray(1 / (s - p))
    return np.asarray(-np.expm1(_lost(lines, p)) / (s - p))


def _lost(lines: Lines, p: complex) -> ComplexArray:
    """Logarithm of the part that the end of the record takes."""
    T = lines.record or 0.0
    return np.asarray((p - lines.s) * T + 0.5 * lines.pulse**2 * (p**2 - lines.s**2))


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
    kept, theta = np.empty(0), np.empty(0)
    before = _misfit(lines, theta)
    failures = 0
    for _ in range(count or most):
        theta = _refine(lines, np.concatenate((theta, _next_pole(lines, theta, before))))
        after = _misfit(lines, theta)
        if count is not None or _matters(lines, theta, before, after):
            kept, failures = theta, 0
        else:
            failures += 1  # one of two like modes does not matter before the other is there
        before = after
        if failures == 2:
            break
    if count is None:
        kept = _prune(lines, kept)
    return _finish(lines, kept) if kept.size else None


def residues_at(lines: Lines, poles: ComplexArray) -> ComplexArray:
    """Best residues of each row at given poles, shape (channels, modes)."""
    theta = np.ravel(np.column_stack((np.log(-poles.real), poles.imag)))
    coefficients = _solve(lines, theta)[1]
    return np.array([_residues(coefficients, i) for i in range(len(poles))]).T


def _prune(lines: Lines, theta: FloatArray) -> FloatArray:
    """Drop what is no mode until all are."""
    while theta.size:
        c = _solve(lines, theta)[1]
        good = [i for i in range(len(theta) // 2) if _is_mode(lines, theta, c, i)]
        if 2 * len(good) == len(theta):
            break
        theta = theta.reshape(-1, 2)[good].ravel()
        theta = _refine(lines, theta) if theta.size else theta
    return theta


def _residues(coefficients: list[FloatArray], i: int) -> ComplexArray:
    return np.array([complex(c[2 * i], c[2 * i + 1]) for c in coefficients])


def _poles(theta: FloatArray) -> ComplexArray:
    return np.asarray(-np.exp(theta[0::2]) + 1j * theta[1::2])


def _columns(lines: Lines, theta: FloatArray) -> ComplexArray:
    """Modes, two real coefficients each, and the background: shape (n, 2 modes + background)."""
    s = lines.s
    columns = [column for p in _poles(theta) for column in _mode_columns(lines, p)]
    centre = float(np.sqrt(s.imag[0] * s.imag[-1]))
    top = float(s.imag[-1])
    columns += [np.ones_like(s), (s / top) ** 2]
    columns += [kernel(lines, complex(-rate)) * centre for rate in np.array(SLOW_POLES) * centre]
    return np.array(columns).T


def _mode_columns(lines: Lines, p: complex) -> tuple[ComplexArray, ComplexArray]:
    """What a residue of 1 and of j looks like."""
    up, down = kernel(lines, p), kernel(lines, p.conjugate())
    return up + down, 1j * (up - down)


def _stack(values: ComplexArray, weight: FloatArray) -> FloatArray:
    """Real above imaginary parts, weighted."""
    w = weight if values.ndim == 1 else weight[:, None]
    return np.concatenate((values.real * w, values.imag * w))


def _solve(lines: Lines, theta: FloatArray) -> tuple[float, list[FloatArray], list[FloatArray]]:
    """Best linear coefficients at given poles: cost, coefficients and residuals by channel."""
    return _linear(lines, _columns(lines, theta))


def _linear(
    lines: Lines, columns: ComplexArray
) -> tuple[float, list[FloatArray], list[FloatArray]]:
    cost, coefficients, residuals = 0.0, [], []
    for value, sd in zip(lines.value, lines.sd, strict=True):
        rows, y = _stack(columns, 1 / sd), _stack(value, 1 / sd)
        scale = np.linalg.norm(rows, axis=0)
        q, triangle = np.linalg.qr(rows / scale)
        c = np.linalg.lstsq(triangle, q.T @ y, rcond=1e-12)[0] / scale
        r = y - rows @ c
        coefficients.append(c)
        residuals.append(r)
        cost += float(r @ r)
    return cost, coefficients, residuals


def _misfit(lines: Lines, theta: FloatArray) -> FloatArray:
    """Squared residual of each line over its variance, shape (channels, n)."""
    _, _, residuals = _solve(lines, theta)
    return np.array([(r.reshape(2, -1) ** 2).sum(axis=0) for r in residuals])


def _near(lines: Lines, p: complex) -> BoolArray:
    """The lines that decide about a mode: ten to either side, or three half-power widths."""
    omega = lines.s.imag
    reach = max(10.5 * float(np.median(np.diff(omega))), -6 * p.real)
    return np.asarray(np.abs(omega - p.imag) <= reach)


def _slopes(lines: Lines, theta: FloatArray, c: FloatArray) -> ComplexArray:
    """Derivative of the modes' sum by ln sigma and omega at fixed coefficients, (n, 2 modes)."""
    columns = []
    for i, p in enumerate(_poles(theta)):
        residue = complex(c[2 * i], c[2 * i + 1])
        up = residue * _kernel_slope(lines, p)
        down = residue.conjugate() * _kernel_slope(lines, p.conjugate())
        columns += [p.real * (up + down), 1j * (up - down)]
    return np.array(columns).T


def _kernel_slope(lines: Lines, p: complex) -> ComplexArray:
    k = kernel(lines, p)
    if lines.record is None:
        return k**2
    later = lines.record + lines.pulse**2 * p
    return np.asarray((k - later * np.exp(_lost(lines, p))) / (lines.s - p))


def _refine(lines: Lines, theta: FloatArray) -> FloatArray:
    """Levenberg-Marquardt over the poles, the residues projected out (Kaufman's Jacobian)."""
    cost, coefficients, residuals = _solve(lines, theta)
    damping = 1e-3
    for _ in range(STEPS):
        columns = _columns(lines, theta)
        normal, gradient = np.zeros((len(theta),) * 2), np.zeros(len(theta))
        for c, r, sd in zip(coefficients, residuals, lines.sd, strict=True):
            basis, _ = np.linalg.qr(_stack(columns, 1 / sd))
            jacobian = _stack(_slopes(lines, theta, c), 1 / sd)
            jacobian = jacobian - basis @ (basis.T @ jacobian)
            normal += jacobian.T @ jacobian
            gradient += jacobian.T @ r
        diagonal = np.diag(normal).copy()
        diagonal[diagonal == 0] = 1.0
        moved = False
        while damping < 1e8:
            step = np.linalg.solve(normal + damping * np.diag(diagonal), gradient)
            step[0::2] = np.clip(step[0::2], -2.0, 2.0)
            trial = theta + step
            if (np.exp(trial[0::2]) < MOST_DAMPED * trial[1::2]).all():
                trial_cost, trial_c, trial_r = _solve(lines, trial)
                if trial_cost <= cost:
                    moved = True
                    break
            damping *= 10
        if not moved:
            break
        gain = cost - trial_cost
        theta, cost, coefficients, residuals = trial, trial_cost, trial_c, trial_r
        damping = max(damping / 10, 1e-12)
        if gain <= 1e-13 * cost or np.abs(step).max() < 1e-13:
            break
    return theta


def _next_pole(lines: Lines, theta: FloatArray, misfit: FloatArray) -> FloatArray:
    """Scan frequency and damping about the line that the poles so far miss by most."""
    omega = lines.s.imag
    missed = (misfit * lines.sd**2).sum(axis=0)
    worst, step = float(omega[np.argmax(missed)]), float(np.median(np.diff(omega)))
    weights = [1 / sd for sd in lines.sd]
    known = _columns(lines, theta)
    bases = [np.linalg.qr(_stack(known, weight))[0] for weight in weights]
    residuals = _linear(lines, known)[2]
    ratios = np.geomspace(3e-4, 0.4, 9)
    # sharp peaks stand where most is missed, to a line; broad ones may be missed most beside it
    trials = [(r * worst, worst + i * step) for r in ratios for i in np.linspace(-1.5, 1.5, 7)]
    broad = np.geomspace(omega[0], omega[-1], 16)[1:-1]
    trials += [(r * at, float(at)) for r in ratios[5:] for at in broad]
    best, start = -np.inf, np.zeros(2)
    for sigma, at in trials:
        pair = np.column_stack(_mode_columns(lines, complex(-sigma, at)))
        gain = 0.0
        for weight, basis, r in zip(weights, bases, residuals, strict=True):
            new = _stack(pair, weight)
            new = new - basis @ (basis.T @ new)  # what the rest cannot say as well
            gain += float(r @ new @ np.linalg.pinv(new.T @ new) @ (new.T @ r))
        if gain > best:
            best, start = gain, np.array([np.log(sigma), at])
    return start


def _finish(lines: Lines, theta: FloatArray) -> PoleFit:
    """Residues, and the covariance of the first channel's fit with all parameters in it."""
    _, coefficients, _ = _solve(lines, theta)
    misfit = _misfit(lines, theta)
    poles, modes = _poles(theta), len(theta) // 2
    sd = lines.sd[0]
    columns = _stack(_columns(lines, theta), 1 / sd)
    slopes = _stack(_slopes(lines, theta, coefficients[0]), 1 / sd)
    slopes[:, 0::2] /= poles.real  # by p.real = -sigma, so by sigma up to the sign
    full = np.hstack((slopes, columns))
    scale = np.linalg.norm(full, axis=0)
    covariance = np.linalg.pinv((full / scale).T @ (full / scale)) / np.outer(scale, scale)
    # what the model misses about a mode widens that mode's error
    worse = np.sqrt([max(_chi2(lines, p, misfit), 1.0) for p in poles])
    widen = np.concatenate((np.repeat(worse, 2), np.repeat(worse, 2)))
    return PoleFit(
        poles=poles,
        residues=np.array([_residues(coefficients, i) for i in range(modes)]).T,
        covariance=covariance[: 4 * modes, : 4 * modes] * np.outer(widen, widen),
    )


def _chi2(lines: Lines, p: complex, misfit: FloatArray) -> float:
    """Misfit per degree of freedom of the lines about a mode."""
    near = misfit[:, _near(lines, p)]
    return float(near.sum()) / max(2 * near.size - _parameters(near), 1)


def _parameters(channels: FloatArray) -> int:
    """Of one mode: its pole, and a residue in each channel."""
    return 2 + 2 * len(channels)


def _matters(lines: Lines, theta: FloatArray, before: FloatArray, after: FloatArray) -> bool:
    """Tell whether the last mode added is one, and explains more than chance would."""
    coefficients = _solve(lines, theta)[1]
    if not _is_mode(lines, theta, coefficients, len(theta) // 2 - 1):
        return False
    p = _poles(theta)[-1]
    near = _near(lines, p)
    gain = float((before - after)[:, near].sum()) / max(_chi2(lines, p, after), 1e-300)
    return bool(gain > 3 * _parameters(before) * np.log(2 * lines.value.size))


def _is_mode(lines: Lines, theta: FloatArray, coefficients: list[FloatArray], i: int) -> bool:
    """Tell whether pole i lies in the band, oscillates, decays, is distinct and tall."""
    poles = _poles(theta)
    p, others = poles[i], np.delete(poles, i)
    residue = np.abs(_residues(coefficients, i))
    omega, record = lines.s.imag, lines.record
    if not omega[0] < p.imag < omega[-1] or -p.real > 0.99 * MOST_DAMPED * p.imag:
        return False
    if record is not None and -p.real * record < 1e-2:
        return False
    taller = np.array(
        [np.abs(_residues(coefficients, j)).max() > residue.max() for j in range(len(poles))]
    )
    nearest = np.abs(others - p)[np.delete(taller, i)]
    # closer than this no record of such length tells two modes apart
    apart = max(-0.5 * p.real, 0.0 if record is None else 3 * np.pi / record)
    if nearest.size and nearest.min() < apart:
        return False
    height = residue * float(np.abs(kernel(lines, p)).max())
    return bool((height >= SMALLEST_MODE * np.abs(lines.value).max(axis=1)).any())
