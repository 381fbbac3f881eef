"""Exact update of Maxwell arms under a moving plate, including loss of contact."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.solids.maxwell import GeneralizedMaxwell, decaying_sum

# The face of a seal under a plate that only pushes.
#
# A plate that moves away leaves the seal behind: its face recovers under no force until the plate
# meets it again. With :math:`x` the compression of the seal and :math:`x_p` that of the plate,
#
# .. math:: x \ge x_p, \qquad F \ge 0, \qquad F\,(x - x_p) = 0
#
# While it is free, :math:`F = k_\infty x + \sum_j k_j q_j = 0` and
# :math:`\dot q_j = \dot x - q_j/\tau_j` leave
#
# .. math:: k_g \dot x = \sum_j \frac{k_j}{\tau_j} q_j, \qquad k_g = k_\infty + \sum_j k_j
#
# which is linear in q: a sum of exponentials, of the retardation times.


# Number of samples of the first search step; each further step has twice as many.
_FIRST_STRETCH = 64
# of the largest compression times the stiffness: a smaller pull is rounding
_ROUNDING = 1e-12


def simulate_face_under_plate(
    solid: GeneralizedMaxwell, time: FloatArray, plate: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the compression of a seal under a plate that only pushes, m, and its force, N.

    Parameters
    ----------
    solid : GeneralizedMaxwell
        Its parallel dashpot `b` is omitted.
    time : array, shape (n,)
        s, rising.
    plate : array, shape (n,)
        m from first contact, negative in air; straight between samples while it presses. The seal
        is at rest under the first.

    Returns
    -------
    face, force : array, shape (n,)
    """
    recovery = _Recovery(solid)
    face, force = np.empty(len(plate)), np.zeros(len(plate))
    face[0] = max(float(plate[0]), 0.0)
    force[0] = solid.k_inf * face[0]
    tensile_limit = -_ROUNDING * solid.k_0 * max(float(np.abs(plate).max()), 1e-300)
    q, i, is_pressed, look_ahead = np.zeros(solid.arms), 0, True, _FIRST_STRETCH
    while i < len(plate) - 1:
        samples = slice(i, min(i + look_ahead, len(plate)))
        if is_pressed:
            x = np.concatenate((face[i : i + 1], plate[samples][1:]))
            response, states = _compute_force_and_states(solid, time[samples], x, q)
            change_indices = np.flatnonzero(response[1:] < tensile_limit)
        else:
            # what force is left at the last sample that was pressed goes at once
            jump = force[i] / recovery.k_g
            x, states = recovery(time[samples] - time[i], face[i] - jump, q - jump)
            response = np.zeros(len(x))
            x[0] = face[i]
            change_indices = np.flatnonzero(plate[samples][1:] > x[1:])
        last_sample = int(change_indices[0]) if change_indices.size else len(x) - 1
        face[i : i + last_sample + 1], q = x[: last_sample + 1], states[last_sample]
        force[i + 1 : i + last_sample + 1] = response[1 : last_sample + 1]
        i += last_sample
        if change_indices.size:
            is_pressed, look_ahead = not is_pressed, _FIRST_STRETCH
            if is_pressed:
                # the plate meets the face within the next sample, and is there at its end
                x = np.array([face[i], plate[i + 1]])
                response, states = _compute_force_and_states(solid, time[i : i + 2], x, q)
                i += 1
                face[i], force[i], q = plate[i], max(float(response[1]), 0.0), states[1]
        else:
            look_ahead *= 2
    return face, force


def _compute_force_and_states(
    solid: GeneralizedMaxwell, time: FloatArray, x: FloatArray, q: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return force and elongations of the arms under a motion, from elongations on."""
    k, tau = np.asarray(solid.k), np.asarray(solid.tau)
    z = np.diff(time)[:, None] / tau
    decay = np.concatenate((np.zeros((1, len(tau))), np.exp(-z)))
    increments = np.concatenate((q[None], -np.expm1(-z) / z * np.diff(x)[:, None]))
    states = decaying_sum(decay, increments)
    return solid.k_inf * x + states @ k, states


class _Recovery:
    """Recovery of the face of one solid without force."""

    def __init__(self, solid: GeneralizedMaxwell) -> None:
        k, tau = np.asarray(solid.k), np.asarray(solid.tau)
        self.k_g = solid.k_0
        self.pull = k / tau / self.k_g
        # -1/tau + 1 w' is made symmetric by the root of w: its eigenvalues are the rates
        root = np.sqrt(np.maximum(self.pull, 1e-300))
        self.rate, eigenvectors = np.linalg.eigh(np.outer(root, root) - np.diag(1 / tau))
        self.into, self.out = eigenvectors.T * root, eigenvectors / root[:, None]

    def __call__(
        self, time_since_release: FloatArray, face: float, q: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Seal face and elongations at times since release, s; the first at release."""
        elongation_terms = self.into @ q
        scaled_time = self.rate * time_since_release[:, None]
        states = (np.exp(scaled_time) * elongation_terms) @ self.out.T
        growth = np.where(scaled_time < -1e-12, np.expm1(scaled_time) / np.minimum(self.rate,
        -1e-300),
                         time_since_release[:, None])  # fmt: skip
        x = face + (growth * elongation_terms) @ (self.out.T @ self.pull)
        return x, states


# What arms carry over a short step in which their part moves evenly, exactly.
#
# With :math:`a = h/\tau` and the force :math:`d = k\,\Delta u` that a step gives an arm,
#
# .. math:: q(h) = q(0)\,e^{-a} + d\,\frac{1 - e^{-a}}{a}, \qquad
#           \frac1h \int_0^h q\,dt = q(0)\,\frac{1 - e^{-a}}{a}
#           + d\,\Bigl(1 - \frac{1 - e^{-a}}{a}\Bigr)\Big/a
#
# however short or long the time of an arm is beside the step.


class EvenStep(NamedTuple):
    """Factors of an arm's force over a uniform step, each of the shape of h / tau.

    Attributes
    ----------
    mean_factors : array
        Factors of the old force for the mean over the step; also of the increment at its end.
    end_factors : array
        Factors of the old force at the end of the step.
    increment_factors : array
        Factors of the increment for the mean over the step.
    """

    mean_factors: FloatArray
    end_factors: FloatArray
    increment_factors: FloatArray

    @classmethod
    def from_ratio(cls, ratio: FloatArray) -> EvenStep:
        """Return the factors of steps of h / tau > 0."""
        mean_decay = -np.expm1(-ratio) / ratio
        increment_factors = np.where(ratio < 1e-4, 0.5 - ratio / 6, (1 - mean_decay) / ratio)
        return cls(mean_decay, 1 - ratio * mean_decay, increment_factors)

    def mean(self, previous_force: FloatArray, force_step: FloatArray) -> FloatArray:
        """Return the mean force of arms over the step, N."""
        return previous_force * self.mean_factors + force_step * self.increment_factors

    def end(self, previous_force: FloatArray, force_step: FloatArray) -> FloatArray:
        """Return the forces at the end of the step, N."""
        return previous_force * self.end_factors + force_step * self.mean_factors
