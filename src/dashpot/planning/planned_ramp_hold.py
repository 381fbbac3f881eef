"""Planned ramp-and-hold test and its repeats: the information of its samples."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from dashpot.base import dataclass, field
from dashpot.base.arrays import FloatArray, sample_count
from dashpot.datamodel.machine import DEFAULT_UNCERTAINTIES, Machine
from dashpot.planning.plan_options import PlannedRamp
from dashpot.signals.disturbances import build_earlier_press, build_machine_terms, compute_warming
from dashpot.solids.maxwell import GeneralizedMaxwell

# Planned ramp-and-hold test: the information of its samples.


# Number of nodes of an unmeasured, smooth effect, in the ramp and in the hold.
_NODE_COUNT = 300
# of its age that a group of samples may last: they weigh as one, to 1e-4 of an error
_GROUP_DURATION = 0.005
# warming in a chamber over that in a room, one standard deviation
_CHAMBER_WARMING_SD = (
    DEFAULT_UNCERTAINTIES["warming in a chamber"].size / DEFAULT_UNCERTAINTIES["warming"].size
)


class PlannedRows(NamedTuple):
    """Design matrix of a planned test in units of its noise, and unmeasured effects.

    Attributes
    ----------
    rows : array, shape (m, p)
        Sensitivities, reduced to a triangle, above the priors.
    unmeasured : array, shape (m, d)
        Effects of the rig that the fit does not estimate, one standard deviation each.
    """

    rows: FloatArray
    unmeasured: FloatArray


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
        Recorded before the ramp, s: it determines the offset of the load cell.
    machine : Machine or None
        The fit then has offset, drift and, with the ramp, delay of the force as parameters, and
        its errors include unmeasured effects of machine and climate; None leaves all of them out.

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

    def _group_samples(self) -> tuple[FloatArray, FloatArray]:
        """Return mean times, s, and numbers of samples of groups that see the same, shape (m,)."""
        t = self.time()
        is_held = t > self.ramp_time
        age = t - self.ramp_time * is_held
        groups = np.floor(np.log(age * self.rate) / _GROUP_DURATION)
        starts = np.flatnonzero(np.append(True, (np.diff(groups) != 0) | np.diff(is_held)))
        counts = np.diff(starts, append=len(t))
        return np.add.reduceat(t, starts) / counts, counts

    def sensitivity(self, model: GeneralizedMaxwell, time: FloatArray | None = None) -> FloatArray:
        r"""Return J = dF / d(k_inf, k, ln tau[, offset, drift[, delay]]), shape (n, p), N per unit.

        The offset refers to the middle of the baseline; `time` (n,) is the time of every sample.
        """
        t = self.time() if time is None else time
        speed = self.depth / self.ramp_time
        tau, k = np.asarray(model.tau), np.asarray(model.k)
        ramp_age = np.minimum(t, self.ramp_time)[:, None]
        hold_age = np.maximum(t - self.ramp_time, 0.0)[:, None]
        decay = np.exp(-hold_age / tau)
        arm = -tau * np.expm1(-ramp_age / tau) * decay
        # d/d ln tau of tau (1 - e^{-u/tau}) e^{-h/tau}
        slope = arm * (1 + hold_age / tau) - ramp_age * np.exp(-ramp_age / tau) * decay
        columns = [speed * ramp_age, speed * arm, speed * slope * k]
        if self.machine is not None:
            columns += [np.ones((len(t), 1)), self._compute_time_since_baseline(t)]
            if self.method == "full":
                columns.append(self._compute_delay_sensitivity(model, t, columns[1]))
        return np.hstack(columns)

    def _compute_time_since_baseline(self, t: FloatArray) -> FloatArray:
        """Return time since the middle of the baseline, s, shape (n, 1)."""
        return (t + 0.5 * self.baseline)[:, None]

    def _compute_delay_sensitivity(
        self, model: GeneralizedMaxwell, t: FloatArray, by_arms: FloatArray
    ) -> FloatArray:
        """Return the derivative of the force by a delay, N/s, shape (n, 1), from columns of arms.

        The force of an arm rises at k times the speed of the plate, less itself over tau.
        """
        speed = self.depth / self.ramp_time
        is_moving = t <= self.ramp_time if self.method == "full" else np.zeros(len(t), dtype=bool)
        relaxation_rate = by_arms @ (np.asarray(model.k) / np.asarray(model.tau))
        return np.asarray(relaxation_rate - speed * model.k_0 * is_moving)[:, None]

    def prior_sd(self, model: GeneralizedMaxwell) -> FloatArray:
        """Return the prior standard deviations of offset, drift and delay: N, N/s and s.

        The fit of the hold has no delay, and the widest prior of the drift.
        """
        offset, fitted_drift_sd, free_drift_sd = self._compute_offset_and_drift_sd(model)
        if self.method == "hold":
            return np.array([offset, free_drift_sd])
        machine = self.machine or Machine()
        return np.array([offset, fitted_drift_sd, machine.delay_sd(1 / self.rate)])

    def _compute_offset_and_drift_sd(self, model: GeneralizedMaxwell) -> tuple[float, float, float]:
        """Return prior SDs of the offset, N, and of the drift in a fit and in a limit, N/s."""
        machine = self.machine or Machine()
        length = self.ramp_time + self.hold_time
        final = float(
            model.ramp_hold_force([length], depth=self.depth, ramp_time=self.ramp_time)[0]
        )
        offset = self.noise / np.sqrt(self.baseline * self.rate)
        slope = 0.0, float(np.sqrt(12.0) * offset / self.baseline)
        fitted_drift_sd, free_drift_sd = (
            machine.combine_drift(slope, final, length, noise)[1] for noise in (None, self.noise)
        )
        return offset, fitted_drift_sd, free_drift_sd

    @lru_cache(maxsize=4)  # noqa: B019  a plan asks for the same test several times
    def rows(self, model: GeneralizedMaxwell, *, has_several_tests: bool = False) -> PlannedRows:
        """Return the design matrix of the test with its priors, and its unmeasured effects.

        A fit of `has_several_tests` temperatures estimates the warming of the seal, and its errors
        leave out earlier presses.
        """
        time, counts = self._group_samples()
        columns, prior_rows = self.sensitivity(model, time), np.zeros((0, 0))
        unmeasured = self.unmeasured_effects(model, time, columns[:, 1 : 1 + model.arms])
        if self.machine is not None:
            sd = self.prior_sd(model)
            if has_several_tests:
                columns = np.hstack((columns, unmeasured[:, :1]))
                sd = np.append(sd, _CHAMBER_WARMING_SD)
                unmeasured = unmeasured[:, 2:]
            prior_rows = np.diag(1 / np.maximum(sd, 1e-300))
        count = columns.shape[1]
        weighted = np.hstack((columns, unmeasured)) * np.sqrt(counts)[:, None]
        triangle = np.asarray(np.linalg.qr(weighted, mode="r")) / self.noise
        priors = np.pad(prior_rows, ((0, 0), (count - len(prior_rows), 0)))
        return PlannedRows(
            np.vstack((triangle[:, :count], priors)),
            np.pad(triangle[:, count:], ((0, len(prior_rows)), (0, 0))),
        )

    def unmeasured_effects(
        self, model: GeneralizedMaxwell, time: FloatArray, by_arms: FloatArray
    ) -> FloatArray:
        """Return forces of climate and machine that the fit does not estimate, N, shape (n, d).

        Each column is one standard deviation: the first of a seal that warms, the second of one
        that was pressed before. `by_arms` are the sensitivities to k at each `time`. The crosshead
        is assumed to settle by less than the resolution of its encoder.
        """
        if self.machine is None:
            return np.zeros((len(time), 0))
        machine, first_node = self.machine, self.ramp_time * 1e-3
        time_since_ramp = np.concatenate((
            np.linspace(-self.ramp_time, 0.0, _NODE_COUNT),
            np.geomspace(min(first_node, self.hold_time / 2), self.hold_time, _NODE_COUNT),
        ))  # fmt: skip
        nodes = time_since_ramp + self.ramp_time
        x = self.depth * np.minimum(nodes / self.ramp_time, 1.0)
        warming = compute_warming(nodes, x, model, start_time=-min(self.baseline, self.ramp_time))
        terms = {"warming": (warming, DEFAULT_UNCERTAINTIES["warming"].size)}
        # of a seal that was pressed before; what it carries in the middle of the rest is offset
        times = np.append(nodes + self.baseline, self.baseline / 2)
        memory, sd = build_earlier_press(machine, model, times, depth=self.depth)
        terms["memory"] = memory[:-1] - memory[-1], sd
        terms |= build_machine_terms(
            machine,
            model,
            nodes,
            x,
            time_since_stop=time_since_ramp,
            ramp_time=self.ramp_time,
            depth=self.depth,
        )
        columns = [np.interp(time, nodes, values)[:, None] * sd for values, sd in terms.values()]
        _, fitted_drift_sd, free_drift_sd = self._compute_offset_and_drift_sd(model)
        if self.method == "hold":
            columns.append(
                self._compute_delay_sensitivity(model, time, by_arms)
                * machine.delay_sd(1 / self.rate)
            )
        else:
            # the part of the drift that the prior of the fit excludes
            excess = np.sqrt(max(free_drift_sd**2 - fitted_drift_sd**2, 0.0))
            columns.append(self._compute_time_since_baseline(time) * excess)
        return np.hstack(columns)


@dataclass(frozen=True)
class Repeat:
    """Temperature at which a test is repeated, with the shift of the solid.

    Attributes
    ----------
    temperature : float
        K.
    a_t, b_t : float
        Assumed shift factors of time and of stiffness, dimensionless.
    """

    temperature: float
    a_t: float
    b_t: float
