r"""Combination of several accelerometers: their mean, or weights insensitive to rocking.

A block that is struck off its centre bounces and rocks; accelerometer i sees, in hit h,
:math:`A_{ih} = B(s) + q_{ih} R(s)`. The mean is free of rocking if the accelerometers are alike and
stand symmetrically. Otherwise, whatever their gains and places, the weights are that minimise
:math:`\sum_{h,f} |\sum_i w_i A_{ih}(f)|^2` over the lines of the rocking resonance, with
:math:`\sum_i w_i = 1` so that the bounce is kept.
"""

from __future__ import annotations

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.vibration.modal.pole_fit import (
    MIN_LINE_ERROR,
    FRFLines,
    find_poles,
    pole_kernel,
    residues_at,
)

FREQUENCY_FACTOR = 1.2  # times their frequencies lie the lines that decide about two modes
MIN_LINES = 12  # lines for that


@dataclass(frozen=True)
class Combination:
    r"""Combination of accelerometers: their weights, and the remaining rocking.

    Attributes
    ----------
    weights : tuple of float
        Sum 1.
    bounce, rocking : complex
        Poles, 1/s.
    mean_ratio, ratio : float
        Height of the rocking peak over that of the bounce peak, in the plain mean and as weighted.
    eccentricity : tuple of float
        Eccentricity of each hit, :math:`e x/\rho^2`: how far from the centre e it struck, times how
        far from there x the accelerometers are, over the squared radius of gyration. Rocking is to
        bounce as this is to 1.
    reach : float or None
        That x, m, if known.
    """

    weights: tuple[float, ...]
    bounce: complex
    rocking: complex
    mean_ratio: float
    ratio: float
    eccentricity: tuple[float, ...]
    reach: float | None = None


def compute_rocking_weights(
    lines: FRFLines, hits: ComplexArray, reach: float | None = None
) -> Combination | None:
    """Return weights that null the rocking mode.

    Parameters
    ----------
    lines : FRFLines
        A row for each accelerometer, averaged over the hits, of the band that holds bounce and
        rocking.
    hits : complex array, shape (channels, hits, n)
        Accelerance of each accelerometer in each hit.
    reach : float, optional
        How far the accelerometers are from the centre, m.

    Returns
    -------
    Combination or None
        None if no mode moves the accelerometers against each other.
    """
    poles = _find_poles(lines, hits)
    if poles is None:
        return None
    bounce, rocking = complex(poles[0]), complex(poles[1])
    step = float(np.median(np.diff(lines.s.imag)))
    at_peak = np.abs(lines.s.imag - rocking.imag) <= max(-rocking.real, 1.5 * step)
    weights = _solve_weights(hits[:, :, at_peak].reshape(len(hits), -1))
    # what is left is small: only lines about the two modes distinguish it from other modes' skirts
    omega, pair = lines.s.imag, (bounce.imag, rocking.imag)
    is_near_poles = (omega > min(pair) / FREQUENCY_FACTOR) & (omega < max(pair) * FREQUENCY_FACTOR)
    if np.count_nonzero(is_near_poles) > MIN_LINES:
        lines, hits = lines.only(is_near_poles), hits[:, :, is_near_poles]
        poles = poles[
            (poles.imag > min(pair) / FREQUENCY_FACTOR)
            & (poles.imag < max(pair) * FREQUENCY_FACTOR)
        ]
    residues = residues_at(lines, poles)[:, :2]
    peak_heights = [float(np.abs(pole_kernel(lines, p)).max()) for p in (bounce, rocking)]

    def ratio(w: FloatArray) -> float:
        heights = np.abs(w @ residues) * peak_heights
        return float(heights[1] / heights[0])

    return Combination(
        weights=tuple(float(w) for w in weights),
        bounce=bounce,
        rocking=rocking,
        mean_ratio=ratio(np.full(len(hits), 1 / len(hits))),
        ratio=ratio(weights),
        eccentricity=_find_eccentricity(lines, hits, poles),
        reach=reach,
    )


def _find_poles(lines: FRFLines, hits: ComplexArray) -> ComplexArray | None:
    """Return the poles: that of the common motion, that of rocking, others.

    Hits to either side of the centre rock the block in opposite senses, so an average hides it;
    the strongest pattern over hits and accelerometers does not.
    """
    n = hits.shape[2]
    mean_frf = lines.value.mean(axis=0)
    difference = (hits - hits.mean(axis=0)).reshape(-1, n)
    singular_values, patterns = np.linalg.svd(difference, full_matrices=False)[1:]
    strongest = singular_values[0] * patterns[0] / np.sqrt(len(difference))
    rows = np.array([mean_frf, strongest])
    row_maxima = np.abs(rows).max(axis=1)
    if row_maxima[1] < 1e-9 * row_maxima[0]:
        return None
    error = np.stack(
        (np.sqrt((lines.sd**2).mean(axis=0)), np.full(n, MIN_LINE_ERROR * row_maxima[1]))
    )
    fit = find_poles(replace(lines, value=rows, sd=error), max_modes=5)
    if fit is None:
        return None
    # by its pole the residue of the accelerance becomes the velocity a hit gives to the mode
    velocity = np.abs(fit.residues / fit.poles)
    unison = velocity[0] > velocity[1]
    if unison.all() or not unison.any():
        return None
    bounce = int(np.argmax(np.where(unison, velocity[0], 0)))
    rocking = int(np.argmax(np.where(unison, 0, velocity[1])))
    order = sorted(range(len(unison)), key=lambda i: (i != bounce, i != rocking))
    return np.asarray(fit.poles[order])


def _find_eccentricity(
    lines: FRFLines, hits: ComplexArray, poles: ComplexArray
) -> tuple[float, ...]:
    """Velocity that each hit gives to rocking over that to bounce, at the accelerometers."""
    channels, count, n = hits.shape
    rows = replace(lines, value=hits.reshape(-1, n), sd=np.repeat(lines.sd, count, axis=0))
    velocity = (residues_at(rows, poles) / poles).real.reshape(channels, count, -1)
    bounce, rocking = velocity[:, :, 0].mean(axis=0), velocity[:, :, 1]
    _, _, shapes = np.linalg.svd(rocking.T, full_matrices=False)
    shape = shapes[0] * np.sign(shapes[0][0]) * np.sqrt(channels)
    return tuple(float(q) for q in (shape @ rocking) / channels / bounce)


def _solve_weights(response: ComplexArray) -> FloatArray:
    """Real weights of sum 1 that leave least of a `response`, shape (channels, lines).

    Among equally good ones, those closest to the mean.
    """
    n = len(response)
    rows = np.vstack((response.real.T, response.imag.T)) / np.linalg.norm(response)
    mean = np.full(n, 1 / n)
    # any weights of sum 1 are the mean plus differences
    differences = np.linalg.svd(np.ones((1, n)))[2][1:].T
    step, *_ = np.linalg.lstsq(rows @ differences, -rows @ mean, rcond=1e-9)
    return np.asarray(mean + differences @ step)
