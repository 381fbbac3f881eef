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
from dashpot.datamodel.relaxation import RampHold

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

    @classmethod
    def from_record(cls, record: RampHold) -> Encoder:
        """Of a prepared record, up to the end of its hold."""
        used = slice(0, record.hold.stop)
        return cls(
            record.time[used],
            record.travel[used],
            record.encoder_step,
            record.onset,
            record.contact_error,
        )


class Kernel(NamedTuple):
    """The solid's relaxation: k_inf, N/m, k, N/m, and tau, s, of every arm."""

    k_inf: float
    k: FloatArray
    tau: FloatArray

    def __call__(self, time: FloatArray) -> FloatArray:
        """Return K at times >= 0."""
        return np.asarray(self.k_inf + np.exp(-time[:, None] / self.tau) @ self.k)


def encoder_rows(columns: FloatArray, encoder: Encoder, kernel: Kernel) -> FloatArray:
    """Return J' delta of every independent error of one record's encoder, of unit variance.

    A row (p,) per error. `columns` are J, or any turn of it: a row per sample, or only from some
    sample on.
    """
    before = len(encoder.time) - len(columns)
    contact = _contact_row(columns, before, encoder, kernel)
    if encoder.step == 0.0:
        return contact
    return np.concatenate((contact, _step_rows(columns, before, encoder, kernel)))


def _contact_row(columns: FloatArray, before: int, encoder: Encoder, kernel: Kernel) -> FloatArray:
    """What an error of the contact moves, a step of motion when the plate touches."""
    if encoder.contact_error == 0.0:
        return np.zeros((0, columns.shape[1]))
    first = max(int(np.searchsorted(encoder.time, encoder.onset)), before)
    change = kernel(encoder.time[first:] - encoder.onset) @ columns[first - before :]
    return encoder.contact_error * change[None]


def _step_rows(columns: FloatArray, before: int, encoder: Encoder, kernel: Kernel) -> FloatArray:
    time, readings = encoder.time, encoder.readings
    starts = np.concatenate(([0], np.flatnonzero(np.diff(readings)) + 1))
    ends = np.concatenate((starts[1:], [len(readings)]))
    rests = ends - starts > _REST * len(readings)
    rests[0] = True  # all motion is measured from the first reading
    pulses = [
        _pulse(columns, before, time, kernel, (int(a), int(b)))
        for a, b in zip(starts[rests], ends[rests], strict=True)
    ]
    seen = ends > before
    k_0 = kernel.k_inf + float(kernel.k.sum())
    short = np.add.reduceat(columns, np.maximum(starts[seen] - before, 0), axis=0)[~rests[seen]]
    return encoder.step / float(np.sqrt(12.0)) * np.concatenate((k_0 * short, np.array(pulses)))


def _pulse(
    columns: FloatArray, before: int, time: FloatArray, kernel: Kernel, run: tuple[int, int]
) -> FloatArray:
    """Return J' delta for a unit error over a run of samples.

    The record measures motion from its first reading, so an error of the first run is a step
    at the run's end.
    """
    values = np.zeros(columns.shape[1])
    for sign, at in zip((1.0, -1.0), run, strict=True):
        first = max(at, before)
        if 0 < at < len(time):
            values += sign * (kernel(time[first:] - time[at]) @ columns[first - before :])
    return values
