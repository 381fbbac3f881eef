r"""Several accelerometers as one: the mean, or the weights that do not see the block rock.

A block that is struck off its centre bounces and rocks; accelerometer i at :math:`x_i` sees
:math:`A_i = B(s) + q_i R(s)`. The mean is free of rocking if the accelerometers are alike and
stand symmetrically. Otherwise, whatever their gains and places, the weights are that minimise
:math:`\sum_f |\sum_i w_i A_i(f)|^2` over the lines of the rocking resonance, with
:math:`\sum_i w_i = 1` so that the bounce is kept.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dashpot._arrays import ComplexArray, FloatArray
from dashpot.vibration.rational import Lines, find_poles, kernel, residues_at


@dataclass(frozen=True)
class Combination:
    r"""How the accelerometers are weighted, and how much rocking is left.

    Attributes
    ----------
    weights : tuple of float
        Sum 1.
    rocking_frequency, bounce_frequency : float
        Hz.
    mean_ratio, ratio : float
        Height of the rocking peak over that of the bounce peak, in the plain mean and as weighted.
    eccentricity : tuple of float
        Of each blow, :math:`e x/\rho^2`: how far from the centre e it struck, times how far from
        there x the accelerometers are, over the squared radius of gyration. Rocking is to bounce
        as this is to 1.
    reach : float or None
        That x, m, if known.
    """

    weights: tuple[float, ...]
    rocking_frequency: float
    bounce_frequency: float
    mean_ratio: float
    ratio: float
    eccentricity: tuple[float, ...]
    reach: float | None = None


def null_rocking(
    lines: Lines, blows: ComplexArray, reach: float | None = None
) -> Combination | None:
    """Weights that null the rocking mode, from poles that all accelerometers share.

    Parameters
    ----------
    lines : Lines
        A row for each accelerometer, of the band that holds bounce and rocking.
    blows : complex array, shape (channels, blows, n)
        Accelerance of each accelerometer in each blow.
    reach : float, optional
        How far the accelerometers are from the centre, m.

    Returns
    -------
    Combination or None
        None if no mode moves the accelerometers against each other.
    """
    fit = find_poles(lines, most=5)
    if fit is None:
        return None
    # in the receptance the mount's modes stand out
    shape = fit.residues / fit.poles**2
    power = (np.abs(shape) ** 2).sum(axis=0)
    together = np.abs(shape.sum(axis=0)) ** 2 / len(shape)
    # 1 where all accelerometers move as one, 0 where they cancel
    unison = together / power
    if len(unison) < 2 or unison.max() < 0.5 or unison.min() > 0.5:
        return None
    bounce = int(np.argmax(np.where(unison >= 0.5, power, 0)))
    rocking = int(np.argmax(np.where(unison < 0.5, power, 0)))
    p = fit.poles[rocking]
    step = float(np.median(np.diff(lines.s.imag)))
    at_peak = np.abs(lines.s.imag - p.imag) <= max(-p.real, 1.5 * step)
    weights = _weights(lines.value[:, at_peak])

    tall = [float(np.abs(kernel(lines, fit.poles[i])).max()) for i in (rocking, bounce)]

    def heights(w: FloatArray) -> tuple[float, float]:
        return (
            float(tall[0] * abs(w @ fit.residues[:, rocking])),
            float(tall[1] * abs(w @ fit.residues[:, bounce])),
        )

    mean = heights(np.full(len(shape), 1 / len(shape)))
    nulled = heights(weights)
    return Combination(
        weights=tuple(float(w) for w in weights),
        rocking_frequency=float(abs(fit.poles[rocking])) / (2 * np.pi),
        bounce_frequency=float(abs(fit.poles[bounce])) / (2 * np.pi),
        mean_ratio=mean[0] / mean[1],
        ratio=nulled[0] / nulled[1],
        eccentricity=_eccentricity(lines, blows, fit.poles[[bounce, rocking]]),
        reach=reach,
    )


def _eccentricity(lines: Lines, blows: ComplexArray, poles: ComplexArray) -> tuple[float, ...]:
    """Velocity that each blow gives to rocking over that to bounce, at the accelerometers."""
    channels, count, n = blows.shape
    rows = replace(
        lines,
        value=blows.reshape(-1, n),
        sd=np.repeat(lines.sd, count, axis=0),
    )
    # over its pole a residue of the accelerance is one of the mobility: half the initial velocity
    velocity = (residues_at(rows, poles) / poles).real.reshape(channels, count, 2)
    bounce, rocking = velocity[:, :, 0].mean(axis=0), velocity[:, :, 1]
    _, _, shapes = np.linalg.svd(rocking.T, full_matrices=False)
    shape = shapes[0] * np.sign(shapes[0][0]) * np.sqrt(channels)
    return tuple(float(q) for q in (shape @ rocking) / channels / bounce)


def _weights(seen: ComplexArray) -> FloatArray:
    """Real weights of sum 1 that leave least of what is `seen`, shape (channels, lines).

    Among equally good ones, those closest to the mean.
    """
    n = len(seen)
    rows = np.vstack((seen.real.T, seen.imag.T)) / np.linalg.norm(seen)
    mean = np.full(n, 1 / n)
    # any weights of sum 1 are the mean plus differences
    differences = np.linalg.svd(np.ones((1, n)))[2][1:].T
    step, *_ = np.linalg.lstsq(rows @ differences, -rows @ mean, rcond=1e-9)
    return np.asarray(mean + differences @ step)
