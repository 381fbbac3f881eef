"""A mass on a viscoelastic solid under half-sine pulses, exactly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.errors import DataError
from dashpot.solids.maxwell import GeneralizedMaxwell


@dataclass(frozen=True)
class Pulse:
    """A half-sine push: start, s; duration, s; peak, N (or N m about the centre)."""

    start: float
    duration: float
    peak: float

    def force(self, time: FloatArray) -> FloatArray:
        """The push at `time`."""
        inside = (time >= self.start) & (time <= self.start + self.duration)
        phase = np.pi * (time - self.start) / self.duration
        return np.asarray(np.where(inside, self.peak * np.sin(phase), 0.0))


@dataclass(frozen=True)
class Oscillator:
    r"""One degree of freedom on a solid, in modal form.

    .. math::

        m\ddot y + k_\infty y + \sum_j k_j q_j + b\dot y = F, \qquad
        \dot q_j = \dot y - q_j / \tau_j, \qquad
        \ddot y = \frac{F}{m} + \sum_i r_i z_i, \quad \dot z_i = \lambda_i z_i + F

    Attributes
    ----------
    inertia : float
        kg (kg m^2 for rocking).
    poles, residues : array, shape (modes,)
        lambda, 1/s, and r.
    """

    inertia: float
    poles: ComplexArray
    residues: ComplexArray

    @classmethod
    def on(cls, solid: GeneralizedMaxwell, inertia: float) -> Oscillator:
        """A mass (or a moment of inertia) on a solid (or a rotary one).

        Raises
        ------
        DataError
            If the solid has no stiffness at rest, or two poles coincide.
        """
        if solid.k_inf <= 0:
            raise DataError(
                "k_inf = 0: the block would sink without end; the virtual hammer needs a solid "
                "with k_inf > 0"
            )
        k, tau = np.array(solid.k), np.array(solid.tau)
        size = 2 + len(k)
        matrix = np.zeros((size, size))
        matrix[0, 1] = 1.0
        matrix[1] = -np.concatenate(([solid.k_inf, solid.b], k)) / inertia
        matrix[2:, 1] = 1.0
        matrix[2:, 2:] = -np.diag(1 / tau)
        poles, vectors = np.linalg.eig(matrix)
        if np.linalg.cond(vectors / np.linalg.norm(vectors, axis=0)) > 1e10:
            raise DataError(
                "two poles of the block on its seals coincide; change the mass a little"
            )
        push = np.zeros(size)
        push[1] = 1 / inertia
        return cls(inertia, poles, (matrix[1] @ vectors) * np.linalg.solve(vectors, push))

    def acceleration(
        self, time: FloatArray, pulses: tuple[Pulse, ...], rest: ComplexArray | None = None
    ) -> tuple[FloatArray, ComplexArray]:
        r"""Acceleration at `time`, and the modal state at its end.

        A half-sine of duration T, with :math:`\Omega = \pi/T` and s since its start, moves a
        mode to

        .. math:: z = P\,\frac{\Omega e^{\lambda s} - \Omega\cos\Omega s - \lambda\sin\Omega s}
            {\lambda^2 + \Omega^2}, \quad s \le T; \qquad z(T)\,e^{\lambda(s - T)}, \quad s > T

        Parameters
        ----------
        time : array, shape (n,)
            Evenly spaced, s.
        pulses : tuple of Pulse
        rest : array, shape (modes,), optional
            Modal state at ``time[0]``; at rest if not given.
        """
        total = sum((pulse.force(time) for pulse in pulses), np.zeros(len(time))) / self.inertia
        state = np.zeros(len(self.poles), dtype=complex)
        for i, (pole, residue) in enumerate(zip(self.poles, self.residues, strict=True)):
            free = np.exp(pole * (time - time[0]))
            z = (rest[i] if rest is not None else 0.0) * free
            for pulse in pulses:
                z += _mode_under(pulse, pole, time, free)
            state[i] = z[-1]
            total = total + (residue * z).real
        return total, state


def _mode_under(pulse: Pulse, pole: complex, time: FloatArray, free: ComplexArray) -> ComplexArray:
    """The motion of one mode under one pulse; `free` is its decay since ``time[0]``."""
    omega = np.pi / pulse.duration
    stop = pulse.start + pulse.duration
    during = slice(*np.searchsorted(time, [pulse.start, stop]))
    s = time[during] - pulse.start
    scale = pulse.peak / (pole**2 + omega**2)
    z = np.zeros(len(time), dtype=complex)
    z[during] = scale * (
        omega * np.exp(pole * s) - omega * np.cos(omega * s) - pole * np.sin(omega * s)
    )
    parting = scale * omega * (np.exp(pole * pulse.duration) + 1)
    after = slice(during.stop, None)
    if len(time[after]):
        # the decay from the pulse's end is the common decay, shifted
        first = time[after][0]
        z[after] = parting * np.exp(pole * (first - stop)) * free[: len(time) - during.stop]
    return z
