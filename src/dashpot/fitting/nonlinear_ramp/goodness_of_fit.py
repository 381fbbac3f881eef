"""Whether a linear solid explains a record to its noise, ramp and hold alike."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.datamodel.relaxation import RampHold
from dashpot.fitting.checks.relaxation import slow_noise
from dashpot.fitting.nonlinear_ramp.downsampling import relaxes_from
from dashpot.numerics.inference.covariance import noise_of
from dashpot.preprocessing.denoising import denoise_displacement

# a linear law is wrong if it leaves so much more than the noise on the ramp, in one sample or in
# one independent residual, and than the hold alone in the hold
SOUND_RAMP, SOUND_SHAPE, SOUND_HOLD = 1.2, 1.5, 1.1
# what a residual of this part of the peak stands for moves no stiffness that anyone would notice
NEGLIGIBLE = 1e-4
# and more than this part is not what an encoder leaves
UNREAD = 1e-3


class LinearFitQuality(NamedTuple):
    """What a linear fit leaves of a record, against its noise.

    Attributes
    ----------
    ramp : float
        Residual on the ramp over the noise of one sample.
    hold : float
        Residual in the hold over what the hold alone leaves.
    sound : bool
    """

    ramp: float
    hold: float
    sound: bool


def soundness(
    ramp: float,
    hold: float,
    single: float,
    *,
    noise: float,
    discrepancy: float,
    samples: float,
    peak: float,
    unread: float = 0.0,
) -> LinearFitQuality:
    r"""Judge a linear fit by its residuals.

    Parameters
    ----------
    ramp, hold : float
        Root mean square residual of the fit to the whole record, on the ramp and in the hold, N.
    single : float
        That of a fit to the hold alone, N.
    noise : float
        Standard deviation of the noise of one sample, N.
    discrepancy : float
        :math:`r_r \sqrt{\kappa_r}/(r_h \sqrt{\kappa_h})`, scatter of one independent residual
        of the ramp over one of the hold: a curve below the noise shows in :math:`\kappa_r`.
    samples : float
        Effective number of residuals on the ramp: of few, more is chance.
    peak : float
        Largest force, N.
    unread : float
        Force on the ramp that what the encoder leaves of the motion stands for, N.
    """
    floor = NEGLIGIBLE * peak
    by_chance = 1.0 + 3.0 / np.sqrt(2.0 * max(samples, 1.0))
    quiet = ramp <= max(SOUND_RAMP, by_chance) * noise
    straight = discrepancy <= SOUND_SHAPE * by_chance
    unread = min(SOUND_SHAPE * unread, UNREAD * peak)
    followed = (quiet and straight) or ramp <= max(floor, unread)
    valid = bool(followed and (hold <= SOUND_HOLD * single or hold <= floor))
    return LinearFitQuality(ramp / max(noise, 1e-300), hold / max(single, 1e-300), valid)


def linear_soundness(test: RampHold, whole: FloatArray, single: FloatArray) -> LinearFitQuality:
    """Judge a linear fit that was made elsewhere, by the residuals of every sample.

    Parameters
    ----------
    test : RampHold
    whole : array, shape (n,)
        Residual of the fit to ramp and hold, up to the last sample of the hold, N.
    single : array, shape (m,)
        Residual of a fit to the hold alone, N.
    """
    corner, onset = relaxes_from(test), int(np.searchsorted(test.time, test.onset))
    held = whole[corner - test.hold.stop :]
    ramp = whole[: -len(held)][onset - corner :]
    # the colour of the noise shows in a stretch of it
    noises = noise_of(ramp), noise_of(single[: 4 * len(ramp)])
    rms, least = (float(np.sqrt(np.mean(part**2))) for part in (ramp, single))
    peak = float(np.abs(test.force[: test.hold.stop]).max())
    return soundness(
        rms,
        float(np.sqrt(np.mean(held**2))),
        least,
        noise=max(sample_noise(test.force_noise, least), slow_noise(single, peak)),
        discrepancy=rms / max(least, 1e-300) * float(np.sqrt(noises[0].kappa / noises[1].kappa)),
        samples=len(ramp) / noises[1].kappa,
        peak=peak,
        unread=peak / test.depth * _compute_motion_residual(test, slice(onset, corner)),
    )


def _compute_motion_residual(test: RampHold, ramp: slice) -> float:
    """Standard deviation of what the encoder leaves of the motion on the ramp, m."""
    _, residual = denoise_displacement(test)
    return float(np.sqrt(np.mean(residual[ramp] ** 2)))


def sample_noise(scatter: float, rms: float) -> float:
    """Standard deviation of the noise of one sample, N: its scatter, or what its hold leaves.

    What a hold leaves may be a solid that does not fit: it is noise up to twice the scatter.
    """
    return max(scatter, min(rms, 2.0 * scatter)) if scatter > 0 else rms
