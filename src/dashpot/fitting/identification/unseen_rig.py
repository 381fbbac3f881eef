r"""What the rig of a hammer may add to a response that no channel shows.

Each doubt is a stiffness :math:`\delta K(s)` beside the n seals, of which the accelerance follows

.. math:: \delta A = -\frac{A^2}{s^2}\,\delta K

with the cables of accelerometers :math:`\epsilon K'` and, for their own loss,
:math:`j\epsilon\eta_c K'`, both of the seals at the resonance; a table that gives,
:math:`-\epsilon_t K^2/K'`; a mass that moves along, :math:`\epsilon_m m s^2`. Sizes are those of
:data:`~dashpot.datamodel.machine.USUAL`. A window whose decay a is known to :math:`\sigma_a` adds
:math:`\sigma_a\,\partial A/\partial a`.

A fit is of the quiet rig; its parameters follow a doubt c by :math:`\delta\theta = C J' c`.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.datamodel.machine import USUAL
from dashpot.fitting.identification.likelihood import Candidate
from dashpot.fitting.identification.prior_knowledge import HammerRig
from dashpot.numerics.least_squares.problem import stack_real_rows

# of the decay of a window, over which the response is differenced
_STEP = 1e-3


def compute_hammer_rig_sensitivity(best: Candidate, rig: HammerRig) -> FloatArray:
    """Return by how much the flat parameter vector follows each doubt, shape (p, d).

    Parameters
    ----------
    best : Candidate
        The optimum.
    rig : HammerRig
        With what its user says of the cables.
    """
    problem = best.problem
    columns = stack_real_rows(_doubts(best, rig) / problem.frf_data.sd[:, None]) / problem.scale
    first = sum(len(rows) for rows in best.model_prediction.tests)
    slope = best.model_prediction.slope[first : first + len(columns)]
    covariance = np.where(np.isfinite(best.covariance), best.covariance, 0.0)
    return np.asarray(covariance @ (slope.T @ columns))


def _doubts(best: Candidate, rig: HammerRig) -> ComplexArray:
    """What each doubt adds to the predicted lines, one standard deviation a column."""
    data, point = best.problem.frf_data, best.point
    response = data.response(point.seal_under_hammer, point.mass)
    s, accelerance = response.s, response.accelerance
    seals = s**2 / accelerance - point.mass * s**2
    there = complex((data.seals * point.seal_under_hammer).stiffness_at(2j * np.pi * data.peak_hz))
    cable, loss = rig.cable_sd * abs(there.real), USUAL["loss of the cable"].size
    ones = np.ones_like(s)
    added = np.column_stack((
        cable * ones,
        1j * cable * loss * ones,
        -USUAL["table"].size * seals**2 / abs(there.real),
        USUAL["mass that moves along"].size * point.mass * s**2,
    ))  # fmt: skip
    by = -(accelerance**2 / s**2)[:, None] * added
    shown, *_ = data.slopes(response, point.gain, point.delay, by)
    error = data.lines.shift_sd
    if error <= 0:
        return shown
    step = _STEP * error
    after, before = (
        replace(data, lines=replace(data.lines, shift=data.lines.shift + way)).predict(
            replace(data, lines=replace(data.lines, shift=data.lines.shift + way)).response(
                point.seal_under_hammer, point.mass
            ),
            point.gain,
            point.delay,
        )
        for way in (step, -step)
    )
    return np.column_stack((shown, error * (after - before) / (2 * step)))
