"""A ramp-and-hold test to be: what each of its samples says of the solid."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from dashpot.base.arrays import FloatArray, sample_count
from dashpot.planning.asked import PlannedRamp
from dashpot.records.machine import USUAL, Machine
from dashpot.signals.unseen import machine_terms, warming
from dashpot.solids.maxwell import GeneralizedMaxwell

# a doubt is smooth: instants of ramp and hold, each, at which it is laid out
_LAID_OUT = 300


@dataclass(frozen=True)
class Bench(PlannedRamp):
    """A ramp-and-hold test to be; quantities as in ``"8mm"``, or in SI units.

    Attributes
    ----------
    depth : float
        m.
    ramp_time, hold_time : float
        s.
    rate : float
        Samples per second, Hz.
    noise : float
        Standard deviation of a force sample, N; multiply by the square root of the correlation
        (``fit.residual.kappa``) if samples are filtered.
    method : str
        ``"full"`` fits ramp and hold, ``"hold"`` the hold alone.
    baseline : float
        Recorded before the ramp, s: it tells the offset of the load cell.
    machine : Machine or None
        Its fit of ramp and hold finds offset, drift and delay of the force besides; on None, and
        by eq. 5, it finds none of them.

    Raises
    ------
    DataError
        If a number is not positive, or the method unknown.
    """

    machine: Machine | None = field(default=Machine())

    def time(self) -> FloatArray:
        """The samples that the method fits, s from the start of the ramp, shape (n,)."""
        count = sample_count(self.ramp_time + self.hold_time, self.rate)
        t = np.arange(1, count + 1) / self.rate
        return t if self.method == "full" else t[t >= self.ramp_time * (1 - 1e-12)]

    def sensitivity(self, model: GeneralizedMaxwell) -> FloatArray:
        r"""Return J = dF / d(k_inf, k, ln tau[, offset, drift, delay]), shape (n, p), N per unit.

        The offset is that at the middle of the baseline.
        """
        t = self.time()
        speed = self.depth / self.ramp_time
        tau, k = np.asarray(model.tau), np.asarray(model.k)
        up = np.minimum(t, self.ramp_time)[:, None]
        held = np.maximum(t - self.ramp_time, 0.0)[:, None]
        fade = np.exp(-held / tau)
        arm = -tau * np.expm1(-up / tau) * fade
        # d/d ln tau of tau (1 - e^{-u/tau}) e^{-h/tau}
        slope = arm * (1 + held / tau) - up * np.exp(-up / tau) * fade
        columns = [speed * up, speed * arm, speed * slope * k]
        if self.doubted:
            ramps = (t <= self.ramp_time)[:, None]
            rates = np.where(ramps, np.exp(-up / tau), -arm / tau) @ k + model.k_inf * ramps[:, 0]
            since = t + 0.5 * self.baseline
            columns += [np.ones((len(t), 1)), since[:, None], -speed * rates[:, None]]
        return np.hstack(columns)

    @property
    def doubted(self) -> bool:
        """True if offset, drift and delay are fitted too."""
        return self.machine is not None and self.method == "full"

    def prior_sd(self, model: GeneralizedMaxwell) -> FloatArray:
        """What is known of offset, drift and delay before the fit: N, N/s and s."""
        machine = self.machine or Machine()
        length = self.ramp_time + self.hold_time
        final = float(
            model.ramp_hold_force([length], depth=self.depth, ramp_time=self.ramp_time)[0]
        )
        offset = self.noise / np.sqrt(self.baseline * self.rate)
        slope = float(np.sqrt(12.0) * offset / self.baseline)
        _, drift, _ = machine.drift_told((0.0, slope), final, length, self.noise)
        return np.array([offset, drift, machine.delay_sd(1 / self.rate)])

    def rows(self, model: GeneralizedMaxwell, *, unseen: bool = False) -> FloatArray:
        """Sensitivities in units of the noise, reduced to a triangle, and priors, shape (m, p).

        With what may add to the force `unseen`, a further column each.
        """
        columns, known = self.sensitivity(model), np.zeros(0)
        if self.doubted:
            known = 1 / np.maximum(self.prior_sd(model), 1e-300)
        if unseen:
            more = self.unseen(model)
            columns, known = np.hstack((columns, more)), np.append(known, np.ones(more.shape[1]))
        seen = np.asarray(np.linalg.qr(columns, mode="r")) / self.noise
        return np.vstack((seen, np.pad(np.diag(known), ((0, 0), (seen.shape[1] - len(known), 0)))))

    def unseen(self, model: GeneralizedMaxwell) -> FloatArray:
        """What machine and room may add that no channel shows, in N, one sd each, shape (n, d).

        The crosshead is thought to settle by less than its encoder reads.
        """
        machine, held = self.machine or Machine(), self.ramp_time * 1e-3
        since = np.concatenate((
            np.linspace(-self.ramp_time, 0.0, _LAID_OUT),
            np.geomspace(min(held, self.hold_time / 2), self.hold_time, _LAID_OUT),
        ))  # fmt: skip
        at = since + self.ramp_time
        x = self.depth * np.minimum(at / self.ramp_time, 1.0)
        terms = machine_terms(
            machine, model, at, x, since=since, ramp_time=self.ramp_time, depth=self.depth
        )
        terms["warming"] = warming(at, x, model), USUAL["warming"].size
        time = self.time()
        return np.column_stack([np.interp(time, at, one) * sd for one, sd in terms.values()])
