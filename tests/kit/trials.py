r"""Records with a known truth, made without a line of dashpot: the other side of every trial.

A seal is a relaxation stiffness of its own (`Seal.of_arms`, `Seal.fractional`, `Seal.power_law`),
written as a dense sum of exponentials that is exact to 1e-6; its elastic law is one of `LAWS`. The
force is the quasi-linear law of Fung,

.. math:: F(t) = k_\infty e(x(t)) + \sum_i k_i \int_0^t e^{-(t-s)/\tau_i}\,\mathrm d e(x(s)),
    \qquad e(D) = D

by the exact recursion for a motion that is straight between instants four times as fine as the
record. A `Bench` is the machine and its faults: motion, load cell, clocks; all faults are off by
default, `DISTURBANCES` names each at the size of the trials.

.. code-block:: python

    one = trial(KINDS[3], seed=7)                               # a Trial: arrays and truth
    one.time, one.displacement, one.force                       # s, m, N, as a file would hold
    one.seal.stiffness(omega), one.stiffness_at(omega, 2.6e-3)  # K' + j K'', N/m; tangent there
    one.k_end(), one.k_end(3), one.seal.k_inf                   # k(T), k(3 T)
    trial(KINDS[3], seed=7, bench=DISTURBANCES["late 1 ms"], law="cubic")
    strike(one.seal, mass=0.104, seals=2, seed=7)               # a Hammering: hits with noise
    relaxation_test(one), impact_test(hits)                     # as dashpot's values

`KINDS` are 42: seven solids (2 to 6 arms over 1 ms to 300 s, fractional, power law), drawn by the
seed, on each of six motions. Everything is SI.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import gamma
from types import MappingProxyType

import numpy as np
from scipy.signal import cont2discrete, lfilter

FINE = 4
"""Instants of the simulation to a sample of the record."""

_STEP = 0.4
"""Of the dense sums in ln tau: the trapezoidal rule errs by exp(-pi^2 / step) of the whole."""

_SPRING = 1e12
"""s; what relaxes more slowly than anyone lives."""


# -- the seal --------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Seal:
    """A relaxation stiffness k_inf + sum k exp(-t / tau), N/m and s; tau ascending."""

    k_inf: float
    k: tuple[float, ...]
    tau: tuple[float, ...]
    kind: str = "arms"

    @classmethod
    def of_arms(cls, k_inf, k, tau) -> Seal:
        """Some arms."""
        order = np.argsort(tau)
        k, tau = np.asarray(k)[order], np.asarray(tau)[order]
        return cls(float(k_inf), tuple(k.tolist()), tuple(tau.tolist()))

    @classmethod
    def fractional(cls, k_inf, k, tau, alpha) -> Seal:
        """k_inf + k E_alpha(-(t / tau)^alpha): the spectrum of Cole and Cole."""
        z = _STEP * np.arange(-400, 401)
        angle = np.pi * alpha
        weight = _STEP * np.sin(angle) / (np.cosh(alpha * z) + np.cos(angle)) / (2 * np.pi)
        return cls._dense(k_inf, k * weight, z + np.log(tau), "fractional")

    @classmethod
    def power_law(cls, k_inf, k, t_0, beta) -> Seal:
        """k_inf + k (1 + t / t_0)^-beta: rates u / t_0 that are gamma-distributed."""
        z = _STEP * np.arange(-400, 12)
        weight = _STEP * np.exp(beta * z - np.exp(z)) / gamma(beta)
        weight[0] += max(1 - weight.sum(), 0.0)
        return cls._dense(k_inf, k * weight, np.log(t_0) - z, "power law")

    @classmethod
    def _dense(cls, k_inf, k, log_tau, kind) -> Seal:
        """Keep 10 ns to 4 months; what is slower is a spring, what is faster is nothing."""
        slow = float(k[log_tau > np.log(1e7)].sum())
        mask = (log_tau > np.log(1e-8)) & (log_tau <= np.log(1e7)) & (k > 1e-12)
        order = np.argsort(log_tau[mask])
        k, tau = k[mask][order], np.exp(log_tau[mask][order])
        return cls(float(k_inf), (*k.tolist(), slow), (*tau.tolist(), _SPRING), kind)

    def relaxation(self, t):
        """k(t), N/m, t > 0."""
        t = np.asarray(t, dtype=float)[..., None]
        return self.k_inf + np.exp(-t / np.array(self.tau)) @ np.array(self.k)

    def stiffness(self, omega):
        """K' + j K'', N/m, at `omega`, rad/s."""
        return self.at(1j * np.asarray(omega, dtype=float))

    def at(self, s):
        """K(s), N/m."""
        turn = np.asarray(s)[..., None] * np.array(self.tau)
        return self.k_inf + (turn / (1 + turn)) @ np.array(self.k)

    def slope(self, s):
        """dK/ds, N s/m."""
        turn = 1 + np.asarray(s)[..., None] * np.array(self.tau)
        return (1 / turn**2) @ (np.array(self.k) * np.array(self.tau))

    def scaled(self, factor: float) -> Seal:
        """As many seals, or a stiffer lot."""
        return replace(self, k_inf=factor * self.k_inf, k=tuple(factor * np.array(self.k)))

    def force(self, e, step: float):
        """N, for e(x), m, straight between instants `step` s apart, from rest at zero."""
        rise = np.diff(e, prepend=0.0)
        total = self.k_inf * np.asarray(e)
        for k, tau in zip(self.k, self.tau, strict=True):
            decay, mean = np.exp(-step / tau), -np.expm1(-step / tau) * tau / step
            total = total + lfilter([k * mean], [1.0, -decay], rise)
        return total


@dataclass(frozen=True)
class Law:
    """F_e(x) = k_inf e(x): e of x / D with e(1) = 1, and its slope."""

    shape: Callable[[np.ndarray], np.ndarray]
    slope: Callable[[np.ndarray], np.ndarray]


def _foam(u):
    return 0.35 * (1 - np.exp(-12 * u)) + 0.3 * u + 0.35 * u**6


def _foam_slope(u):
    return 4.2 * np.exp(-12 * u) + 0.3 + 2.1 * u**5


def _rubber(u):
    return (1 - 0.4 * u) ** -2 - (1 - 0.4 * u)


def _rubber_slope(u):
    return 0.8 * (1 - 0.4 * u) ** -3 + 0.4


_C = 150 / 196.5  # of F_e = 0.15 x + 7.2656e-4 x^3 N (x in mm): secant 196.5 N/m at 8 mm
LAWS = MappingProxyType(
    {
        "linear": Law(lambda u: u, np.ones_like),
        "cubic": Law(lambda u: _C * u + (1 - _C) * u**3, lambda u: _C + 3 * (1 - _C) * u**2),
        "exponential": Law(
            lambda u: np.expm1(2 * u) / np.expm1(2), lambda u: 2 * np.exp(2 * u) / np.expm1(2)
        ),
        # plateau of buckling walls, then densification
        "foam": Law(lambda u: _foam(u) / _foam(1.0), lambda u: _foam_slope(u) / _foam(1.0)),
        # neo-Hookean block, 40 % compressed at the full depth
        "rubber": Law(
            lambda u: _rubber(u) / _rubber(1.0), lambda u: _rubber_slope(u) / _rubber(1.0)
        ),
    }
)


# -- the bench -------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Bench:
    """The machine, the load cell and their faults; SI units.

    Motion: set-points every `interval` to `depth` in `ramp`, through an axis of second order
    (`axis` Hz, `damping`); held for `hold`; `baseline` recorded before. Record: `rate`, `noise`
    of the force (white, or of first order with `noise_time`), steps `count` and `encoder`.

    Faults: force `late` by s; `force_filter` Hz of first order; `hum` N at 50 Hz with 0.4 of it at
    two alias lines; `drift` N/s; `compliance` m/N; `creep` of the crosshead that the encoder does
    not see, part of the depth; `friction` N, of sliders that stick; `slip` m, lost at 70 % of the
    ramp, unseen; `clip`, the load cell's limit as part of the peak.
    """

    depth: float = 8e-3
    ramp: float = 1.0
    hold: float = 40.0
    baseline: float = 1.5
    axis: float = 6.0
    damping: float = 0.9
    interval: float = 10e-3
    rate: float = 1000.0
    bias: float = 0.05
    noise: float = 4.5e-3
    noise_time: float = 0.0
    count: float = 1 / 1280
    encoder: float = 0.02e-3
    late: float = 0.0
    force_filter: float | None = None
    hum: float = 0.0
    drift: float = 0.0
    compliance: float = 0.0
    creep: float = 0.0
    friction: float = 0.0
    slip: float = 0.0
    clip: float | None = None

    def perfect(self) -> Bench:
        """The same motion, read without noise, steps or offset."""
        return replace(self, bias=0.0, noise=0.0, count=0.0, encoder=0.0)


FAULTLESS = Bench()

DISTURBANCES = MappingProxyType(
    {
        "late 1 ms": Bench(late=1e-3),
        "late 5 ms": Bench(late=5e-3),
        "filter 10 Hz": Bench(force_filter=10.0),
        "hum": Bench(hum=5e-3),
        "drift": Bench(drift=0.2e-3),
        "compliance": Bench(compliance=50e-6),
        "crosshead creep": Bench(creep=3e-3),
        "friction": Bench(friction=0.08),
        "slip": Bench(slip=0.3e-3),
        "clipped": Bench(clip=0.9),
        "coarse 250 Hz": Bench(rate=250.0, interval=20e-3, axis=25.0, damping=0.5),
        "coarse 500 Hz": Bench(rate=500.0, interval=20e-3, axis=25.0, damping=0.5),
        "coloured noise": Bench(noise_time=50e-3),
    }
)


@dataclass(frozen=True, eq=False)
class Trial:
    """A record, and what is true of it.

    `compression` and `pure` are the seal's own, m and N, at the samples; `end` is the end of the
    hold, s after the onset.
    """

    name: str
    seal: Seal
    law: str
    bench: Bench
    seed: int
    time: np.ndarray
    displacement: np.ndarray
    force: np.ndarray
    compression: np.ndarray
    pure: np.ndarray

    @property
    def end(self) -> float:
        return self.bench.ramp + self.bench.hold

    def k_end(self, times: float = 1.0) -> float:
        """k at so many times the end of the hold, N/m, secant."""
        return float(self.seal.relaxation(times * self.end))

    def tangent(self, x: float) -> float:
        """F_e'(x) over the secant stiffness at the full depth."""
        return float(LAWS[self.law].slope(np.asarray(x / self.bench.depth, dtype=float)))

    def stiffness_at(self, omega, x: float):
        """K' + j K'' of small vibration about the compression x, N/m."""
        return self.tangent(x) * self.seal.stiffness(omega)


def record(
    seal: Seal, bench: Bench = FAULTLESS, *, law: str = "linear", seed: int = 0, name: str = ""
) -> Trial:
    """Press the seal on the bench, and read it."""
    random = np.random.default_rng([seed, 0x5EA1])
    step = 1 / (bench.rate * FINE)
    clock = step * np.arange(round((bench.baseline + bench.ramp + bench.hold) / step) + 1)
    plate = _plate(clock, bench)
    true, force = _answer(seal, LAWS[law], plate, clock, bench)
    shown = np.interp(clock - bench.late, clock, _filter_force(force, step, bench.force_filter))
    time, read = clock[::FINE], shown[::FINE]
    read = read + bench.bias + bench.drift * time + _hum(time, bench, random)
    read = read + _noise(len(time), bench, random)
    if bench.clip is not None:
        read = np.minimum(read, bench.clip * read.max())
    return Trial(
        name, seal, law, bench, seed, time,
        _quantise(plate[::FINE], bench.encoder), _quantise(read, bench.count),
        true[::FINE], force[::FINE],
    )  # fmt: skip


def _plate(clock, bench: Bench):
    """What the encoder sees: set-points through the axis, from rest."""
    # a set-point is sent at the start of its interval: the staircase leads the straight line
    ahead = np.floor((clock - bench.baseline) / bench.interval + 1e-9) + 1
    sent = bench.depth * np.clip(ahead * bench.interval / bench.ramp, 0.0, 1.0)
    sent[clock < bench.baseline - 1e-12] = 0.0
    omega = 2 * np.pi * bench.axis
    numerator, denominator, _ = cont2discrete(
        ([omega**2], [1, 2 * bench.damping * omega, omega**2]), clock[1] - clock[0], method="zoh"
    )
    return lfilter(numerator[0], denominator, sent)


def _answer(seal: Seal, law: Law, plate, clock, bench: Bench):
    """Compression and force of the seal; the machine gives way by C F (a fixed point)."""
    late = np.maximum(clock - bench.baseline - bench.ramp, 0.0)
    hidden = bench.creep * bench.depth * -np.expm1(-late / 12.0)
    slipped = bench.slip * (clock > bench.baseline + 0.7 * bench.ramp)
    free = np.maximum(plate + hidden - slipped, 0.0)
    step = clock[1] - clock[0]
    x, force = free, np.zeros_like(free)
    for _ in range(12 if bench.compliance else 1):
        x = np.maximum(free - bench.compliance * force, 0.0)
        force = seal.force(bench.depth * law.shape(x / bench.depth), step)
        force = force + _stuck(x, bench)
    return x, force


def _stuck(x, bench: Bench):
    """Sliders that stick until they are drawn by 0.1 to 1.6 mm, and hold what they have."""
    if not bench.friction:
        return 0.0
    reach = 1e-4 * 2.0 ** np.arange(5)
    # the motion is all but monotonic: a slider carries at most its limit
    drawn = (
        np.minimum(np.maximum.accumulate(x)[:, None], reach)
        - np.maximum(np.maximum.accumulate(x) - x, 0.0)[:, None]
    )
    return bench.friction * (np.clip(drawn, -reach, reach) / reach).mean(axis=1)


def _filter_force(force, step: float, cut: float | None):
    if cut is None:
        return force
    # exact for a force that is straight between instants
    turn = 2 * np.pi * cut * step
    decay, mean = np.exp(-turn), -np.expm1(-turn) / turn
    return lfilter([1 - mean, mean - decay], [1.0, -decay], force)


def _hum(time, bench: Bench, random):
    lines = ((50.0, 1.0), (8013.0, 0.4), (1963.0, 0.4))
    phase = random.uniform(0, 2 * np.pi, len(lines))
    return bench.hum * sum(
        size * np.sin(2 * np.pi * hertz * time + lag)
        for (hertz, size), lag in zip(lines, phase, strict=True)
    )


def _noise(count: int, bench: Bench, random):
    white = random.standard_normal(count)
    if not bench.noise_time:
        return bench.noise * white
    keep = np.exp(-1 / (bench.rate * bench.noise_time))
    white[0] /= np.sqrt(1 - keep**2)
    return bench.noise * lfilter([np.sqrt(1 - keep**2)], [1.0, -keep], white)


def _quantise(values, count: float):
    return np.round(values / count) * count if count else values


# -- the 42 kinds ----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Kind:
    """A solid, drawn by the seed, and a motion."""

    solid: str
    motion: str

    @property
    def name(self) -> str:
        return f"{self.solid}, {self.motion}"


SOLIDS = ("2 arms", "3 arms", "4 arms", "5 arms", "6 arms", "fractional", "power law")
MOTIONS = MappingProxyType(
    {
        "0.2 s": {"ramp": 0.2, "axis": 8.0},
        "0.5 s rounded": {"ramp": 0.5, "axis": 3.0, "damping": 1.0},
        "1 s": {"ramp": 1.0},
        "1 s overshooting": {"ramp": 1.0, "axis": 2.5, "damping": 0.45},
        "2 s jerky": {"ramp": 2.0, "axis": 14.0, "damping": 0.4, "interval": 40e-3},
        "5 s": {"ramp": 5.0},
    }
)
KINDS = tuple(Kind(solid, motion) for motion in MOTIONS for solid in SOLIDS)


def trial(kind: Kind, *, seed: int, bench: Bench = FAULTLESS, law: str = "linear") -> Trial:
    """Draw the solid and the baseline (none in one of four), press it in the kind's motion.

    A bench whose motion is its fault (coarse) keeps its axis and interval.
    """
    random = np.random.default_rng([seed, KINDS.index(kind)])
    seal = draw(kind.solid, random)
    baseline = 0.0 if random.uniform() < 0.25 else float(random.uniform(0.5, 3.0))
    motion = MOTIONS[kind.motion]
    if bench.rate != FAULTLESS.rate:
        motion = {"ramp": motion["ramp"]}
    made = replace(bench, baseline=round(baseline, 2), **motion)
    return record(seal, made, law=law, seed=seed, name=kind.name)


def draw(solid: str, random: np.random.Generator) -> Seal:
    """A seal of that kind, about as stiff as the paper's."""
    k_inf = float(random.uniform(120, 260))
    total = k_inf * float(random.uniform(0.4, 1.6))
    if solid == "fractional":
        tau = float(np.exp(random.uniform(np.log(0.03), np.log(10))))
        return Seal.fractional(k_inf, total, tau, float(random.uniform(0.35, 0.75)))
    if solid == "power law":
        t_0 = float(np.exp(random.uniform(np.log(1e-3), np.log(0.3))))
        return Seal.power_law(k_inf, total, t_0, float(random.uniform(0.08, 0.5)))
    count = int(solid.split()[0])
    # one in each equal part of 1 ms to 300 s, in ln tau
    edges = np.linspace(np.log(1e-3), np.log(300), count + 1)
    tau = np.exp(random.uniform(edges[:-1] + 0.3, edges[1:] - 0.3))
    share = random.uniform(0.3, 1.0, count)
    return Seal.of_arms(k_inf, total * share / share.sum(), tau)


# -- the hammer ------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Hammering:
    """Hits on a mass on seals: one record, s, N, m/s^2; and what is true of them."""

    seal: Seal
    mass: float
    seals: float
    time: np.ndarray
    hammer: np.ndarray
    acceleration: np.ndarray

    def accelerance(self, frequency):
        """A / F, 1/kg, at `frequency`, Hz."""
        s = 2j * np.pi * np.asarray(frequency, dtype=float)
        return s**2 / (self.mass * s**2 + self.seals * self.seal.at(s))

    def pole(self) -> complex:
        """Of the vibration, rad/s, in the upper half plane."""
        return _vibration(self.seal, self.mass, self.seals)


def strike(
    seal: Seal,
    *,
    mass: float,
    seals: float = 2.0,
    hits: int = 5,
    between: float = 4.0,
    rate: float = 2048.0,
    peak: float = 30.0,
    width: float = 12e-3,
    noise: tuple[float, float] = (0.02, 0.02),
    seed: int = 0,
) -> Hammering:
    """Hit a mass on seals; raised cosines of changing height, `noise` in N and m/s^2.

    The acceleration is the sum over every pole, each by its exact recursion for a force that is
    straight between instants four times as fine as the record.
    """
    random = np.random.default_rng([seed, 0x4A33])
    step = 1 / (rate * FINE)
    clock = step * np.arange(round(hits * between / step) + 1)
    force = np.zeros_like(clock)
    for number in range(hits):
        wide = width * random.uniform(0.85, 1.2)
        turn = (clock - 0.25 - number * between) / wide
        height = peak * random.uniform(0.6, 1.2)
        force += height * np.where(np.abs(turn) < 0.5, 0.5 + 0.5 * np.cos(2 * np.pi * turn), 0.0)
    pure = _simulate_motion(seal, mass, seals, force, step)
    time = clock[::FINE]
    return Hammering(
        seal, mass, seals, time,
        force[::FINE] + noise[0] * random.standard_normal(len(time)),
        pure[::FINE] + noise[1] * random.standard_normal(len(time)),
    )  # fmt: skip


def _simulate_motion(seal: Seal, mass: float, seals: float, force, step: float):
    """A(s) = 1/m + sum R / (s - p), with R = p^2 / (2 m p + n K'(p))."""
    total = force / mass
    vibration = _vibration(seal, mass, seals)
    for pole, twice in [(vibration, 2.0), *((p, 1.0) for p in _real_poles(seal, mass, seals))]:
        # an arm faster than the sampling has its pole at -1/tau to the last digit, and no residue
        with np.errstate(divide="ignore"):
            residue = twice * pole**2 / (2 * mass * pole + seals * seal.slope(pole))
        grown, z = np.exp(pole * step), pole * step
        if abs(z) < 1e-9:
            continue
        # exact integral of exp(p (t - s)) over a straight piece
        new = (np.expm1(z) - z) / (z * pole)
        old = np.expm1(z) / pole - new
        total = total + np.real(lfilter([residue * new, residue * old], [1.0, -grown], force))
    return total


def _vibration(seal: Seal, mass: float, seals: float) -> complex:
    s = 1j * np.sqrt(seals * seal.stiffness(1e3).real / mass)
    for _ in range(60):
        s = s - (mass * s**2 + seals * seal.at(s)) / (2 * mass * s + seals * seal.slope(s))
    return complex(s)


def _real_poles(seal: Seal, mass: float, seals: float):
    """One between neighbouring -1/tau, and one above the slowest."""
    rates = 1 / np.array(seal.tau)
    low, high = -rates, np.append(-rates[1:], 0.0)
    for _ in range(80):
        middle = 0.5 * (low + high)
        with np.errstate(divide="ignore", invalid="ignore"):
            below = mass * middle**2 + seals * seal.at(middle) < 0
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return 0.5 * (low + high)


# -- as values of dashpot
# ---------------------------------------------------------------------------


def relaxation_test(item: Trial):
    """The record as `read_relaxation` would give it."""
    from dashpot.datamodel.relaxation import RelaxationTest

    return RelaxationTest(
        time=item.time, displacement=item.displacement, force=item.force, units="SI"
    )


def impact_test(hits: Hammering):
    """The hits as `read_impact` would give them."""
    from dashpot.datamodel.vibration_tests import ImpactTest

    return ImpactTest(time=hits.time, force=hits.hammer, acceleration=hits.acceleration, units="SI")
