r"""What the steps of an encoder leave unknown of a fit to recorded motion.

While a reading stands, its error :math:`e`, uniform within one step q, stands too. To first order
it moves the parameters by :math:`(J^T J)^{-1} J^T \delta`, with the force that the solid would
have given to the pulse of motion that was not there,

.. math:: \delta(t) = e\,[K(t - t_a) - K(t - t_b)], \qquad
          K(t) = k_\infty + \sum_j k_j e^{-t/\tau_j} \; (t \ge 0), \qquad
          \mathrm{Var}(e) = q^2/12

from the run's first reading to the next one. Over a short run that is e k_0. All runs are
independent, so :math:`\sum J^T\delta\,\delta^T J` joins the middle of the sandwich: the error of
the depth held, which scales every stiffness, and that of each step on the way. So does a contact
found behind an air gap: its error shifts all motion after it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray

# a run longer than this part of the record is rest, and the solid relaxes under its error
_REST = 1.0 / 20.0


class Encoder(NamedTuple):
    """The displacement of one record as read.

    Attributes
    ----------
    time : array, shape (n,)
        s.
    readings : array, shape (n,)
        m.
    step : float
        Step q of the readings, m; 0 if they show none.
    onset, contact_error : float
        First contact, s, and the standard deviation of the position where it was found, m.
    """

    time: FloatArray
    readings: FloatArray
    step: float
    onset: float = 0.0
    contact_error: float = 0.0


class Kernel(NamedTuple):
    """The solid's relaxation: k_inf, N/m, k, N/m, and tau, s, of every arm."""

    k_inf: float
    k: FloatArray
    tau: FloatArray

    def __call__(self, time: FloatArray) -> FloatArray:
        """Return K at times >= 0."""
        return np.asarray(self.k_inf + np.exp(-time[:, None] / self.tau) @ self.k)


def encoder_term(jacobian: FloatArray, encoder: Encoder, kernel: Kernel) -> FloatArray:
    """Return what one record's encoder adds to the middle of the sandwich, shape (p, p).

    `jacobian` has a row per sample, or only from some sample on.
    """
    before = len(encoder.time) - len(jacobian)
    jacobian = np.concatenate((np.zeros((before, jacobian.shape[1])), jacobian))
    contact = _contact_term(jacobian, encoder, kernel)
    return contact if encoder.step == 0.0 else contact + _steps_term(jacobian, encoder, kernel)


def _contact_term(jacobian: FloatArray, encoder: Encoder, kernel: Kernel) -> FloatArray:
    """Return what an error of the contact adds: a step of motion when the plate touches."""
    if encoder.contact_error == 0.0:
        return np.zeros((jacobian.shape[1],) * 2)
    touched = int(np.searchsorted(encoder.time, encoder.onset))
    sensitivity = kernel(encoder.time[touched:] - encoder.onset) @ jacobian[touched:]
    return np.asarray(encoder.contact_error**2 * np.outer(sensitivity, sensitivity))


def _steps_term(jacobian: FloatArray, encoder: Encoder, kernel: Kernel) -> FloatArray:
    time, readings, step = encoder.time, encoder.readings, encoder.step
    size = jacobian.shape[1]
    starts = np.concatenate(([0], np.flatnonzero(np.diff(readings)) + 1))
    ends = np.concatenate((starts[1:], [len(readings)]))
    rests = ends - starts > _REST * len(readings)
    rests[0] = True  # all motion is measured from the first reading
    sensitivities = [
        _pulse(jacobian, time, kernel, (int(a), int(b)))
        for a, b in zip(starts[rests], ends[rests], strict=True)
    ]
    k_0 = kernel.k_inf + float(kernel.k.sum())
    short = k_0 * np.add.reduceat(jacobian, starts, axis=0)[~rests]
    rows = np.concatenate((short, np.reshape(sensitivities, (-1, size))))
    return np.asarray(step**2 / 12.0 * (rows.T @ rows))


def _pulse(
    jacobian: FloatArray, time: FloatArray, kernel: Kernel, run: tuple[int, int]
) -> FloatArray:
    """Return J' delta for a unit error over a run of samples.

    The record measures motion from its first reading, so an error of the first run is a step
    at the run's end.
    """
    sensitivity = np.zeros(jacobian.shape[1])
    for sign, at in zip((1.0, -1.0), run, strict=True):
        if 0 < at < len(time):
            sensitivity += sign * (kernel(time[at:] - time[at]) @ jacobian[at:])
    return sensitivity
