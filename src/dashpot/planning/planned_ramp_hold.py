"""Planned ramp-and-hold test and its repeats: the information of its samples."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from dashpot.base import dataclass, field
from dashpot.base.arrays import FloatArray, sample_count
from dashpot.datamodel.machine import USUAL, Machine
from dashpot.planning.plan_options import PlannedRamp
from dashpot.signals.disturbances import build_earlier_press, build_machine_terms, compute_warming
from dashpot.solids.maxwell import GeneralizedMaxwell

# Planned ramp-and-hold test: the information of its samples.


# a doubt is smooth: instants of ramp and hold, each, at which it is laid out
_LAID_OUT = 300
# a chamber in parts of what a room without one does, one standard deviation
_IN_A_CHAMBER = USUAL["warming in a chamber"].size / USUAL["warming"].size


class PlannedRows(NamedTuple):
    """Planned test in units of its noise: its information, and unmeasured effects.

    Attributes
    ----------
    rows : array, shape (m, p)
        Sensitivities, reduced to a triangle, above what is known beforehand.
    unseen : array, shape (m, d)
        What the rig may add that no column of the fit has, one standard deviation each.
    """

    rows: FloatArray
    unseen: FloatArray


@dataclass(frozen=True)
class Bench(PlannedRamp):
    """Planned ramp-and-hold test; quantities as in ``"8mm"``, or in SI units.

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
        Its fit finds offset, drift and, of ramp and hold, delay of the force besides, and bears
        what machine and climate may add unseen; on None there is nothing but the force.

    Raises
    ------
    DataError
        If a number is not positive, or the method unknown.
    """

    machine: Machine | None = field(default=Machine())

    def time(self) -> FloatArray:
        """Return the samples that the method fits, s from the start of the ramp, shape (n,)."""
        count = sample_count(self.ramp_time + self.hold_time, self.rate)
        t = np.arange(1, count + 1) / self.rate
        return t if self.method == "full" else t[t >= self.ramp_time * (1 - 1e-12)]

    def sensitivity(self, model: GeneralizedMaxwell) -> FloatArray:
        r"""Return J = dF / d(k_inf, k, ln tau[, offset, drift[, delay]]), shape (n, p), N per unit.

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
        if self.machine is not None:
            columns += [np.ones((len(t), 1)), self._since_rest(t)]
            if self.method == "full":
                columns.append(self._late(model, columns[1]))
        return np.hstack(columns)

    def _since_rest(self, t: FloatArray) -> FloatArray:
        """Return time since the middle of the baseline, s, shape (n, 1)."""
        return (t + 0.5 * self.baseline)[:, None]

    def _late(self, model: GeneralizedMaxwell, by_arms: FloatArray) -> FloatArray:
        """Return force that a late clock takes, N/s, shape (n, 1), from the columns of arms.

        The force of an arm rises at k times the speed of the plate, less itself over tau.
        """
        t, speed = self.time(), self.depth / self.ramp_time
        moves = t <= self.ramp_time if self.method == "full" else np.zeros(len(t), dtype=bool)
        falls = by_arms @ (np.asarray(model.k) / np.asarray(model.tau))
        return np.asarray(falls - speed * model.k_0 * moves)[:, None]

    def prior_sd(self, model: GeneralizedMaxwell) -> FloatArray:
        """Return what the fit knows of offset, drift and delay beforehand: N, N/s and s.

        Eq. 5 has no delay, and a drift as free as it may be.
        """
        offset, held, free = self._zero(model)
        if self.method == "hold":
            return np.array([offset, free])
        machine = self.machine or Machine()
        return np.array([offset, held, machine.delay_sd(1 / self.rate)])

    def _zero(self, model: GeneralizedMaxwell) -> tuple[float, float, float]:
        """Return what is known of the offset, N, and of the drift in a fit and in a limit, N/s."""
        machine = self.machine or Machine()
        length = self.ramp_time + self.hold_time
        final = float(
            model.ramp_hold_force([length], depth=self.depth, ramp_time=self.ramp_time)[0]
        )
        offset = self.noise / np.sqrt(self.baseline * self.rate)
        slope = 0.0, float(np.sqrt(12.0) * offset / self.baseline)
        held, free = (
            machine.combine_drift(slope, final, length, noise)[1] for noise in (None, self.noise)
        )
        return offset, held, free

    @lru_cache(maxsize=4)  # noqa: B019  a plan asks for the same test several times
    def rows(self, model: GeneralizedMaxwell, *, several: bool = False) -> PlannedRows:
        """Return what the test tells its fit, and what its rig may add to that unseen.

        A fit of `several` temperatures looks for a seal that warms, and finds it; it is a point,
        and bears nothing of earlier presses.
        """
        columns, values = self.sensitivity(model), np.zeros((0, 0))
        unmeasured = self.unmeasured_effects(model, columns[:, 1 : 1 + model.arms])
        if self.machine is not None:
            sd = self.prior_sd(model)
            if several:
                columns, sd = np.hstack((columns, unmeasured[:, :1])), np.append(sd, _IN_A_CHAMBER)
                unmeasured = unmeasured[:, 2:]
            values = np.diag(1 / np.maximum(sd, 1e-300))
        count = columns.shape[1]
        both = np.asarray(np.linalg.qr(np.hstack((columns, unmeasured)), mode="r")) / self.noise
        priors = np.pad(values, ((0, 0), (count - len(values), 0)))
        return PlannedRows(
            np.vstack((both[:, :count], priors)),
            np.pad(both[:, count:], ((0, len(values)), (0, 0))),
        )

    def unmeasured_effects(self, model: GeneralizedMaxwell, by_arms: FloatArray) -> FloatArray:
        """Return what climate and machine may add that the fit does not estimate, in N, shape (n,
        d).

        One standard deviation a column, first that of a seal that warms, then that of one that was
        pressed before. `by_arms` are the
        sensitivities to k. The crosshead is thought to settle by less than its encoder reads.
        """
        time = self.time()
        if self.machine is None:
            return np.zeros((len(time), 0))
        machine, held = self.machine, self.ramp_time * 1e-3
        since = np.concatenate((
            np.linspace(-self.ramp_time, 0.0, _LAID_OUT),
            np.geomspace(min(held, self.hold_time / 2), self.hold_time, _LAID_OUT),
        ))  # fmt: skip
        at = since + self.ramp_time
        x = self.depth * np.minimum(at / self.ramp_time, 1.0)
        warms = compute_warming(at, x, model, since=-min(self.baseline, self.ramp_time))
        terms = {"warming": (warms, USUAL["warming"].size)}
        # of a seal that was pressed before; what it carries in the middle of the rest is offset
        began = np.append(at + self.baseline, self.baseline / 2)
        memory, sd = build_earlier_press(machine, model, began, depth=self.depth)
        terms["memory"] = memory[:-1] - memory[-1], sd
        terms |= build_machine_terms(
            machine, model, at, x, since=since, ramp_time=self.ramp_time, depth=self.depth
        )
        columns = [np.interp(time, at, values)[:, None] * sd for values, sd in terms.values()]
        _, quiet, free = self._zero(model)
        if self.method == "hold":
            columns.append(self._late(model, by_arms) * machine.delay_sd(1 / self.rate))
        else:
            # of the drift, what the fit holds to be less than it may be
            excess = np.sqrt(max(free**2 - quiet**2, 0.0))
            columns.append(self._since_rest(time) * excess)
        return np.hstack(columns)


@dataclass(frozen=True)
class Repeat:
    """Temperature at which a test is repeated, with the shift of the solid.

    Attributes
    ----------
    temperature : float
        K.
    a_t, b_t : float
        Shift factors of time and of stiffness that are supposed there, dimensionless.
    """

    temperature: float
    a_t: float
    b_t: float
