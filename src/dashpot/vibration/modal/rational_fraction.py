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
from dashpot.numerics.least_squares.levenberg_marquardt import Objective, descend
from dashpot.vibration.modal.frf_lines import FRFLines, kernel
from dashpot.vibration.modal.modal_assurance import mac
from dashpot.vibration.modal.pole_trial import (
    MOST_DAMPED,
    RATIOS,
    BackgroundProjection,
    PoleTrial,
    Scan,
    scans,
)

STEPS = 60
ENOUGH = 0.2  # variances: what a last step may explain while modes are sought
NOTHING_NEW = 1e-10  # of a column's square: what rounding leaves of one that is known
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


def find_poles(lines: FRFLines, *, most: int, count: int | None = None) -> PoleFit | None:
    """Add modes, each where the others leave most, until none is left that matters.

    Parameters
    ----------
    lines : FRFLines
    most : int
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
    for _ in range(count or most):
        last, trial = trial, _refine(_with_next_pole(trial), ENOUGH)
        if count is not None or _matters(trial, last):
            pole_trial, failures = trial, 0
        else:
            failures += 1  # one of two like modes does not matter before the other is there
        if failures == 2:
            break
    pole_trial = _refine(pole_trial)
    if count is None:
        pole_trial = _prune(pole_trial)
    modes = len(pole_trial.poles)
    return _finish(_with_outer_poles(pole_trial), modes) if modes else None


def residues_at(lines: FRFLines, poles: ComplexArray) -> ComplexArray:
    """Best residues of each row at given poles, shape (channels, modes)."""
    theta = np.log(np.ravel(np.column_stack((-poles.real, poles.imag))))
    return PoleTrial(BackgroundProjection.from_lines(lines), theta).residues


def _prune(trial: PoleTrial) -> PoleTrial:
    """Drop what is no mode until all are."""
    while trial.theta.size:
        good = [i for i in range(len(trial.poles)) if _is_mode(trial, i)]
        if len(good) == len(trial.poles):
            break
        trial = trial.only(good)
        trial = _refine(trial) if good else trial
    return trial


def _select_mode_lines(lines: FRFLines, p: complex) -> BoolArray:
    """The lines that decide about a mode: ten to either side, or three half-power widths."""
    omega = lines.s.imag
    reach = max(10.5 * float(np.median(np.diff(omega))), -6 * p.real)
    return np.asarray(np.abs(omega - p.imag) <= reach)


def _refine(trial: PoleTrial, enough: float = 0.0) -> PoleTrial:
    """To the nearest optimum of the poles, the residues projected out.

    Ends where a step promises no more than `enough` variances, as one for each row of the lines.
    """
    free = np.full(len(trial.theta), np.inf)
    objective = Objective(lambda theta, _: replace(trial, theta=theta), -free, free)
    flat = max(1e-13, enough / trial.ground.rest.size)
    ended = descend(objective, trial.theta, flat=flat, limit=STEPS)
    return trial if ended is None else ended.point


def _with_next_pole(trial: PoleTrial) -> PoleTrial:
    """Scan frequency and damping about the line that the poles so far miss by most."""
    lines, omega = trial.ground.lines, trial.ground.lines.s.imag
    missed = (trial.misfit * lines.sd**2).sum(axis=0)
    worst, step = float(omega[np.argmax(missed)]), float(np.median(np.diff(omega)))
    # sharp peaks stand where most is missed, to a line; broad ones may be missed most beside it
    starts = [(r * worst, worst + i * step) for r in RATIOS for i in np.linspace(-1.5, 1.5, 7)]
    return _with_best(trial, scans(lines, starts) + trial.ground.broad)[0]


def _with_best(trial: PoleTrial, tried: list[Scan]) -> tuple[PoleTrial, float]:
    """Add the pole, of several, that explains most, and say how much that is."""
    gains = np.concatenate([_gains(trial, scan) for scan in tried])
    best = int(np.argmax(gains))
    pole = np.concatenate([scan.poles for scan in tried])[best]
    theta = np.append(trial.theta, np.log((-pole.real, pole.imag)))
    return replace(trial, theta=theta), float(gains[best])


def _gains(trial: PoleTrial, scan: Scan) -> FloatArray:
    """What each of these poles, none of them refined, takes off the squared residuals."""
    ground, count = trial.ground, len(scan.poles)
    gains = np.zeros(count)
    for i, (sd, r) in enumerate(zip(ground.lines.sd, trial.solution.residuals, strict=True)):
        weight = 1 / np.repeat(sd, 2)
        values = np.hstack((ground.basis[i], trial.basis(slice(i, i + 1))[1][0])) * weight[:, None]
        # what the rest cannot say as well: the rest is orthonormal, and the residual without it
        stated = (scan.rows @ values).reshape(count, 2, -1)
        x, y = (scan.rows @ (r * weight)).reshape(-1, 2).T
        a, b, c = scan.squares[:, i]
        least = NOTHING_NEW * (a + c)
        a, c = (value - (stated[:, k] ** 2).sum(axis=1) + least for k, value in enumerate((a, c)))
        b = b - (stated[:, 0] * stated[:, 1]).sum(axis=1)
        gains += (c * x**2 - 2 * b * x * y + a * y**2) / (a * c - b**2)
    return gains


def _with_outer_poles(trial: PoleTrial) -> PoleTrial:
    """Add poles beyond either end of the band, as background, where they explain what is missed."""
    omega, size = trial.ground.lines.s.imag, trial.ground.rest.size
    low, high = float(omega[0]), float(omega[-1])
    places = [float(at) for by in OUTSIDE for at in (low / by, high * by)]
    starts = [(ratio * at, at) for at in places for ratio in (0.003, 0.02, 0.1)]
    tried = scans(trial.ground.lines, starts)
    for _ in range(2):
        more, gain = _with_best(trial, tried)
        # a scan shows a part of what a refined pole explains
        if 10 * gain < trial.sse * _worth(trial) / size:
            break
        more = _refine(more)
        at = more.poles[-1].imag
        excess = low / FARTHEST < at <= low or high <= at < high * FARTHEST
        if not excess or trial.sse - more.sse < more.sse * _worth(trial) / size:
            break
        trial = more
    return trial


def _worth(trial: PoleTrial) -> float:
    """What a pole must explain, in variances, to be there."""
    return float(3 * _parameters(trial.misfit) * np.log(trial.ground.rest.size))


def _finish(trial: PoleTrial, modes: int) -> PoleFit:
    """Residues of the first poles, and all errors: every channel tells the poles."""
    solved = trial.solution
    by = 1 / np.ravel(np.column_stack((-trial.poles.real, trial.poles.imag)))  # not by logarithms
    normal = trial.curvature * np.outer(by, by)
    scale = np.sqrt(np.diag(normal))
    whole = np.linalg.pinv(normal / np.outer(scale, scale)) / np.outer(scale, scale)
    covariance = whole[: 2 * modes, : 2 * modes]
    inverse = solved.inverse[:, : 2 * modes]
    change = inverse @ (solved.crossing * by)
    variance = (inverse**2).sum(axis=2) + ((change @ whole) * change).sum(axis=2)
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


def _chi2(trial: PoleTrial, p: complex) -> float:
    """Misfit per degree of freedom of the lines about a mode."""
    near = trial.misfit[:, _select_mode_lines(trial.ground.lines, p)]
    return float(near.sum()) / max(2 * near.size - _parameters(near), 1)


def _parameters(channels: FloatArray) -> int:
    """Of one mode: its pole, and a residue in each channel."""
    return 2 + 2 * len(channels)


def _matters(trial: PoleTrial, before: PoleTrial) -> bool:
    """Tell whether the last mode added is one, and explains more than chance would."""
    if not _is_mode(trial, len(trial.poles) - 1):
        return False
    p = trial.poles[-1]
    near = _select_mode_lines(trial.ground.lines, p)
    gain = float((before.misfit - trial.misfit)[:, near].sum()) / max(_chi2(trial, p), 1e-300)
    return bool(gain > _worth(trial))


def _is_mode(trial: PoleTrial, i: int) -> bool:
    """Tell whether pole i lies in the band, oscillates, decays, is distinct and tall."""
    lines, p = trial.ground.lines, trial.poles[i]
    omega, record = lines.s.imag, lines.record
    if not omega[0] < p.imag < omega[-1] or -p.real > 0.99 * MOST_DAMPED * p.imag:
        return False
    # what stands on one line is hum: lines are no closer than a record is long
    longest = record or 2 * np.pi / float(np.median(np.diff(omega)))
    if -p.real * longest < 1e-2:
        return False
    residue = np.abs(trial.residues)
    taller = residue.max(axis=0) > residue[:, i].max()
    # closer than this no record of such length tells two modes apart, unless their shapes do
    difference = max(-0.5 * p.real, 0.0 if record is None else 3 * np.pi / record)
    alike = mac(trial.residues, trial.residues[:, [i]])[:, 0] > ALIKE
    if (np.abs(trial.poles - p)[taller & alike] < difference).any():
        return False
    height = residue[:, i] * float(np.abs(kernel(lines, p)).max())
    return bool((height >= SMALLEST_MODE * np.abs(lines.value).max(axis=1)).any())
