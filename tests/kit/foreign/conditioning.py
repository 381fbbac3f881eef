"""Relaxation records with all that a lab may do to a seal before its test; nothing of dashpot.

A seal with arms is pressed by a plate, sample by sample: while the plate presses, the force is that
of the arms; where it would pull, a plate that only pushes leaves the seal, whose face then moves so
that the force stays zero. A bonded one is pulled.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from math import gamma
from typing import NamedTuple

import numpy as np


class Arms(NamedTuple):
    """A truth: a spring and arms, N/m and s."""

    name: str
    k_inf: float
    k: tuple[float, ...]
    tau: tuple[float, ...]

    def relaxation(self, t: float) -> float:
        """k(t), N/m."""
        return self.k_inf + float(np.sum(np.array(self.k) * np.exp(-t / np.array(self.tau))))


def power_law(k_inf: float, k_1: float, exponent: float) -> Arms:
    """k_inf + k_1 (t/1 s)^-n from 10 ms to 2000 s, as dense arms."""
    tau = np.geomspace(3e-3, 6e3, 44)
    # int tau^-n e^-t/tau dln tau = Gamma(n) t^-n
    k = k_1 / gamma(exponent) * tau**-exponent * np.log(tau[1] / tau[0])
    return Arms(f"power law {exponent:g}", k_inf, tuple(k.tolist()), tuple(tau.tolist()))


def truths(seed: int) -> Iterator[Arms]:
    """Without end, by turns: one to four arms, and a power law."""
    rng = np.random.default_rng([seed, 71])
    while True:
        for count in (1, 2, 3, 4, 0):
            k_inf = float(rng.uniform(100, 400))
            if count == 0:
                yield power_law(k_inf, float(rng.uniform(0.1, 0.3)) * k_inf, rng.uniform(0.1, 0.3))
                continue
            edges = np.geomspace(0.1, 30.0, count + 1)
            tau = [float(np.exp(rng.uniform(*np.log(pair)))) for pair in pairwise(edges)]
            k = rng.uniform(0.06, 0.3, count) * k_inf
            yield Arms(f"{count} arms", k_inf, tuple(k.tolist()), tuple(tau))


def press_solid(
    solid: Arms, step: float, plate: np.ndarray, *, bonded: bool, fine: int = 1
) -> tuple[np.ndarray, np.ndarray]:
    """Face, m, and force, N, under a plate that is straight between samples of one `step`, s."""
    k, tau = np.array(solid.k), np.array(solid.tau)
    x_plate = np.interp(np.arange((len(plate) - 1) * fine + 1) / fine, np.arange(len(plate)), plate)
    decay = np.exp(-step / fine / tau)
    mean = -np.expm1(-step / fine / tau) / (step / fine / tau)
    glass = solid.k_inf + float(k @ mean)
    x = float(x_plate[0]) if bonded else max(float(x_plate[0]), 0.0)
    q = np.zeros(len(k))
    face, force = np.empty(len(x_plate)), np.empty(len(x_plate))
    face[0], force[0] = x, solid.k_inf * x
    for i in range(1, len(x_plate)):
        q *= decay
        held = solid.k_inf * x + float(k @ q)
        # the move that leaves no force
        free = x - held / glass
        new = float(x_plate[i]) if bonded else max(float(x_plate[i]), free)
        q += mean * (new - x)
        x = new
        face[i], force[i] = x, solid.k_inf * x + float(k @ q)
    return face[::fine], force[::fine]


def apply_mullins(plate: np.ndarray, force: np.ndarray, part: float, reach: float) -> np.ndarray:
    """Mullins: behind the deepest compression so far a seal is softer, by up to `part`.

    Over a distance `reach`, m, from that deepest one.
    """
    behind = np.maximum.accumulate(plate) - plate
    return force * (1 - part * (1 - np.exp(-behind / reach)))


@dataclass(frozen=True, eq=False)
class ConditionedRecord:
    """A record, and what is true of it."""

    name: str
    time: np.ndarray
    displacement: np.ndarray
    force: np.ndarray
    truth: Arms
    hold: float
    depth: float
    faultless: bool
    facts: Mapping[str, object] = field(default_factory=dict)


HISTORIES = (
    "cycles", "cycles with holds", "preload hold", "trial of another depth", "part depth",
    "other speeds", "cycles to a low point",
)  # fmt: skip
"""What a lab may leave on record before its test."""


RIGS = (
    "air", "counts", "exact motion", "late force", "drift", "turned", "begins on its ramp",
    "thinned hold", "two steps",
)  # fmt: skip
"""What else a bench may do."""


def _path(kind: str, rng: np.random.Generator, depth: float, rest: float) -> list[tuple]:
    """Corners before the last ramp: durations, s, and where the plate then is, m."""
    speed = depth / float(rng.uniform(0.5, 2.5))
    many = int(rng.integers(2, 7))
    path: list[tuple[float, float]] = []

    def triangle(to: float, pace: float, hold: float = 0.0, low: float = 0.0) -> None:
        at = path[-1][1] if path else 0.0
        path.append((abs(to - at) / pace, to))
        if hold:
            path.append((hold, to))
        path.append(((to - low) / pace, low))

    if kind == "cycles":
        for _ in range(many):
            triangle(depth, speed)
    elif kind == "cycles with holds":
        for _ in range(min(many, 4)):
            triangle(depth, speed, hold=float(rng.uniform(1, 8)))
            path.append((float(rng.uniform(0.5, 6)), 0.0))
    elif kind == "preload hold":
        triangle(float(rng.uniform(0.1, 0.4)) * depth, speed, hold=float(rng.uniform(3, 15)))
    elif kind == "trial of another depth":
        triangle(float(rng.choice([0.5, 0.7, 1.25])) * depth, speed, hold=float(rng.uniform(0, 6)))
    elif kind == "part depth":
        for part in np.linspace(0.4, 1.0, many):
            triangle(float(part) * depth, speed)
    elif kind == "other speeds":
        for _ in range(many):
            triangle(depth, speed * float(rng.choice([0.25, 0.5, 2.0])))
    else:
        low = float(rng.uniform(0.02, 0.08)) * depth
        for _ in range(many):
            triangle(depth, speed, low=low)
        path.append((float(rng.uniform(0.2, 1.0)), 0.0))
    if rest > 0:
        path.append((rest, path[-1][1]))
    return path


def make_conditioned_record(
    number: int, seed: int = 0, *, kind: str | None = None, bonded: bool | None = None,
    mullins: float | None = None, truth: Arms | None = None, rest: float | None = None,
    shown: bool = True, rate: float | None = None, rig: str = "",
) -> ConditionedRecord:  # fmt: skip
    """The `number`-th record of a seed; what is said holds, the rest is drawn.

    A `rig` is one of `RIGS`.
    """
    rng = np.random.default_rng([seed, number, 29])
    if truth is None:
        source = truths(seed)
        truth = next(item for i, item in enumerate(source) if i == number)
    kind = HISTORIES[number % len(HISTORIES)] if kind is None else kind
    bonded = bool(rng.random() < 0.35) if bonded is None else bonded
    soft = (0.0, 0.0, float(rng.uniform(0.05, 0.2)))[int(rng.integers(3))]
    mullins = soft if mullins is None else mullins
    # the draws of a record do not depend on what is said
    drawn = float(rng.choice([0.0, 1.0, 2.0, 5.0, 20.0, 60.0]))
    rest = drawn if rest is None else rest
    depth, hold = float(rng.uniform(4e-3, 9e-3)), float(rng.uniform(25, 80))
    ramp, noise = float(rng.uniform(0.4, 2.5)), float(rng.uniform(1e-3, 5e-3))
    drawn = float(rng.choice([50.0, 100.0, 250.0]))
    rate = drawn if rate is None else rate
    before = float(rng.uniform(1.0, 4.0))
    path = [(before, 0.0), *_path(kind, rng, depth, rest), (ramp, depth), (hold, depth)]
    if rig == "air":
        away = float(rng.uniform(0.3e-3, 2e-3))
        path = [(duration, level or -away) for duration, level in path]
    if rig == "two steps":
        path[-1:] = [(6.0, 0.6 * depth), (ramp, depth), (hold, depth)]
        path[-4] = (ramp, 0.6 * depth)
    corners = np.cumsum([0.0, *(duration for duration, _ in path)])
    levels = np.array([path[0][1], *(level for _, level in path)])
    separate = np.append(True, np.diff(corners) > 0)
    time = np.arange(0.0, corners[-1], 1 / rate)
    plate = np.interp(time, corners[separate], levels[separate])
    bonded = bonded and rig != "air"
    _, force = press_solid(truth, 1 / rate, plate, bonded=bonded)
    if mullins:
        force = apply_mullins(plate, force, mullins, float(rng.uniform(0.05, 0.4)) * depth)
    seen = plate + rng.normal(0.0, 0.5e-6, len(plate))
    force = force + rng.normal(0.0, noise, len(force)) + float(rng.normal(0.0, 0.02))
    if rig == "counts":
        seen = 1e-5 * np.round(plate / 1e-5)
    elif rig == "exact motion":
        seen = np.round(plate, 8)
    elif rig == "late force":
        force = np.interp(time - 0.006, time, force)
    elif rig == "drift":
        force += time * float(rng.choice([-1, 1])) * 3e-4
    elif rig == "turned":
        seen, force = 0.012 - seen, -force
    elif rig == "begins on its ramp":
        mask = time >= before
        time, seen, force = time[mask] - time[mask][0], seen[mask], force[mask]
    elif rig == "thinned hold":
        since = time - (corners[-2] + 2)
        mask = (since < 0) | (np.arange(len(time)) % 8 == 0)
        time, seen, force = time[mask], seen[mask], force[mask]
    if not shown:
        late = time >= corners[-3] - min(rest, 2.0)
        time, seen, force = time[late] - time[late][0], seen[late], force[late]
    message = (
        f"{number} {kind}, {'bonded' if bonded else 'pushed'}, rest {rest:g} s, {truth.name}"
        f"{f', softens {100 * mullins:.0f} %' if mullins else ''}{rig and f', {rig}'}"
    )
    return ConditionedRecord(
        message, np.round(time, 6), seen, force, truth, hold, depth, faultless=not mullins,
        facts={"kind": kind, "bonded": bonded, "rest": rest, "ramp": ramp},
    )  # fmt: skip


def limits_of(
    record: ConditionedRecord, stated: Mapping[str, tuple[float, float]], hold: float
) -> dict[str, tuple[float, float, float]]:
    """Lower limit, truth and upper limit of k(T), k(3T) and the most that k_inf may be."""
    result = {}
    for name, at in (("k_end", hold), ("k_3end", 3 * hold), ("k_inf", np.inf)):
        low, high = stated.get(name, (np.nan, np.nan))
        truth = record.truth.k_inf if name == "k_inf" else record.truth.relaxation(at)
        result[name] = (0.0 if name == "k_inf" else low, truth, high)
    return result
