"""Compression load deflection of a seal whose truth is known: its motion and force use no dashpot.

The seal has an elastic law and relaxes, each arm by the exact recursion; it softens from cycle
to cycle, carries a set, and does not pull. The machine counts, drifts and makes noise.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

import dashpot as dp
from dashpot.solids.elastic import ElasticLaw

from . import handmade

Array = npt.NDArray[Any]

ARMS = ((0.35, 0.5), (0.15, 16.0))
"""g_j, parts of the relaxed force, and tau_j, s."""
LENGTH = 0.1


def stiffening(x: Array) -> Array:
    """Relaxed force of a stiffening seal, N; x in m."""
    return 150.0 * x + 7.2656e5 * x**3


def bulb(x: Array) -> Array:
    """Relaxed force of a bulb: stiff at first, a plateau, then the walls meet."""
    u = np.maximum(x, 0.0) / 8e-3
    return np.sign(x) * (2.2 * np.tanh(2.2 * u) + 0.25 * u + 1.4 * u**6) * (x != 0)


@dataclass(frozen=True)
class Truth:
    """A record and what is true of it; SI units, compression positive."""

    time: Array
    displacement: Array
    force: Array
    compression: Array
    clean: Array

    def text(self, *, head: str = "time [s],displacement [mm],force [N]", clock: bool = True,
             rows: slice = slice(None)) -> str:  # fmt: skip
        columns = [self.time, 1e3 * self.displacement, self.force][not clock :]
        table = np.column_stack([column[rows] for column in columns])
        names = head if clock else head.partition(",")[2]
        return "\n".join([names, *(",".join(f"{v:.9g}" for v in row) for row in table), ""])

    def write(self, path: Path, **how: Any) -> Path:
        path.write_text(self.text(**how), encoding="utf-8")
        return path


def compute_relaxed_force(
    wanted: Array, met: Array, arms: tuple[tuple[float, float], ...], step: float
) -> Array:
    """The force of relaxed forces with relaxation; a seal that would pull is left, and recovers."""
    g, tau = (np.array([arm[i] for arm in arms]) for i in (0, 1))
    decay = np.exp(-step / tau)
    mean = g * (1 - decay) * tau / step
    arm, e, force = np.zeros(len(arms)), 0.0, np.zeros(len(wanted))
    for i, value in enumerate(wanted):
        passed = decay * arm
        force[i] = value + np.sum(passed + mean * (value - e))
        last, e = e, value
        if force[i] <= 0 or not met[i]:
            force[i], e = 0.0, (mean.sum() * last - passed.sum()) / (1 + mean.sum())
        arm = passed + mean * (e - last)
    return force


def press_cycles(
    law: Callable[[Array], Array] = stiffening,
    *,
    depth: float | tuple[float, ...] = 8e-3,
    speed: float = 5e-3,
    cycles: int = 4,
    gap: float = 1e-3,
    arms: tuple[tuple[float, float], ...] = ARMS,
    softening: float = 0.12,
    set_: float = 0.0,
    wait: float = 0.0,
    rest: float = 1.0,
    rate: float = 100.0,
    noise: float = 4e-3,
    drift: float = 0.0,
    bias: float = 0.05,
    count: float = 2e-6,
    scale: float = 1.0,
    unload: bool = True,
    seed: int = 1,
) -> Truth:
    """A seal pressed through cycles at one speed, from a gap of air, m.

    `set_` is reached after a few cycles; softening is 1 - m (1 - e^{-(n-1)/1.5}) of the law's
    force in cycle n; a negative `gap` begins in contact.
    """
    depths = (depth,) * cycles if isinstance(depth, float) else depth
    knots, at, ends = [0.0, rest], [-gap, -gap], []
    for number, deep in enumerate(depths):
        last = number == len(depths) - 1
        knots.append(knots[-1] + (deep + gap) / speed)
        at.append(deep)
        if wait:
            knots.append(knots[-1] + wait)
            at.append(deep)
        if unload or not last:
            knots.append(knots[-1] + (deep + gap) / speed)
            at.append(-gap)
            ends.append(knots[-1])
    if unload:
        knots.append(knots[-1] + rest)
        at.append(-gap)
    time = np.arange(0.0, knots[-1] + 0.5 / rate, 1 / rate)
    x = np.interp(time, knots, at)
    number = np.searchsorted(ends, time)
    n = np.clip(number, 0, len(depths) - 1).astype(float)
    soft = 1 - softening * (1 - np.exp(-n / 1.5))
    lost = set_ * (1 - np.exp(-n))
    wanted = soft * law(np.maximum(x - lost, 0.0))
    clean = scale * compute_relaxed_force(wanted, x > lost, arms, 1 / rate)
    draw = np.random.default_rng(seed).standard_normal(len(x))
    read = clean + bias + drift * time + noise * draw
    counted = np.round(x / count) * count if count else x
    return Truth(time, counted, read, x, clean)


def fit_of(law, *, arms=ARMS, scale=1.0, depth=8e-3):
    """A fit that knows the relaxation, and the secant stiffness at a depth."""
    k = scale * float(law(np.array([depth]))[0]) / depth
    model = dp.GeneralizedMaxwell(k, tuple(k * g for g, _ in arms), tuple(tau for _, tau in arms))
    fit = handmade.study().fit
    evidence = replace(fit.evidence, band=(1e-3, 10.0), stiffness_by_depth=(), checks=())
    return replace(fit, solid=model, elastic_law=ElasticLaw.linear(k, depth), evidence=evidence)


def dashpot_and_arms(
    speed: float,
    *,
    c: Callable[[Array], Array],
    arms: tuple[tuple[float, float], ...],
    depth: float = 8e-3,
    gap: float = 1e-3,
    rest: float = 8.0,
    per_stroke: int = 400,
    noise: float = 2e-3,
    seed: int = 1,
) -> Truth:
    """A stiffening spring, a dashpot c(x) and arms, k and tau, in parallel: no single relaxation.

    Each arm by steps eight times as fine as the record; the seal does not pull.
    """
    step, stroke = (depth + gap) / speed / per_stroke / 8, (depth + gap) / speed
    knots = rest + stroke * np.arange(5)
    time = np.arange(0.0, knots[-1] + rest, step)
    x = np.interp(time, knots, [-gap, depth, -gap, depth, -gap])
    pressed_by = np.maximum(x, 0.0)
    force = stiffening(pressed_by) + c(pressed_by) * np.gradient(x, time) * (x > 0)
    increment = np.diff(pressed_by, prepend=0.0)
    for k, tau in arms:
        decay, arm = float(np.exp(-step / tau)), 0.0
        for i, by in enumerate((increment * (1 - decay) * tau / step).tolist()):
            arm = decay * arm + by
            force[i] += k * arm
    clean = np.maximum(force, 0.0)[::8]
    draw = np.random.default_rng(seed).standard_normal(len(clean))
    return Truth(time[::8], x[::8], clean + 0.03 + noise * draw, x[::8], clean)
