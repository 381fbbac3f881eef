r"""Impacts on a specimen that is known, sound or outside every model of a fit.

.. math:: m\ddot x = -F(x, \text{history}), \qquad x(0) = 0, \quad \dot x(0) = v

by Verlet, with the arms exact for a relaxed force that is straight over a step, and whatever a
specimen, its mass or a sensor does besides. `drop_set("friction 5 %", seed)` are three impacts of a
specimen that is drawn, with the truth of its relaxation
and of an impact at another speed. SI units.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import signal

from .truths import Solid

RATE = 1e4
"""Samples a second."""
SPEEDS, OTHER = (0.3, 0.6, 1.0), 0.8
"""Of the impacts, and of the one to be predicted, m/s."""
_STEP = 2e-5
_LEAD, _TAIL = 0.02, 0.02
_NOISE = 0.01


@dataclass(frozen=True)
class Specimen:
    """Relaxed law c1 x + c2 x^2 + c3 x^3, N and m, and arms over it; what else there is, by name.

    Attributes
    ----------
    friction : float
        Of a Jenkins element, N, that slips after `reach`, m.
    steep : float
        Part of the cubic's force at `depth` that a sixth power adds there.
    tilt : float
        How far the far edge of the specimen is from the mass when the near one is met, m.
    """

    mass: float
    c: tuple[float, float, float]
    solid: Solid
    depth: float
    friction: float = 0.0
    reach: float = 3e-4
    steep: float = 0.0
    tilt: float = 0.0

    def relaxed(self, x):
        """Relaxed force at compressions, m, N."""
        if self.tilt:
            across = (np.arange(16) + 0.5) / 16 * self.tilt
            return float(np.mean([self._relaxed(max(x - value, 0.0)) for value in across]))
        return self._relaxed(x)

    def _relaxed(self, x):
        c1, c2, c3 = self.c
        whole = x * (c1 + x * (c2 + x * c3))
        if self.steep:
            at = self.depth * (c1 + self.depth * (c2 + self.depth * c3))
            whole += self.steep * at * (x / self.depth) ** 6
        return whole

    def loss_factor(self, frequency: float) -> float:
        """Of the relaxation, at Hz."""
        K = self.solid.stiffness(2 * np.pi * frequency)
        return float(K.imag / K.real)


def impact_force(specimen: Specimen, speed: float):
    """Clock and force of one impact from its touch to its release, at `_STEP`."""
    rigid, dashpot, k, tau = specimen.solid.within(_STEP / 20, 1e3)
    # of a dashpot over one step
    decay = np.exp(-_STEP / tau)
    gain = k * (1 - decay) * tau / _STEP
    x, v, t, q, stuck = 0.0, speed, 0.0, np.zeros(len(k)), 0.0
    before, force = 0.0, 0.0
    result = [0.0]
    while True:
        a = -force / specimen.mass
        travel = v * _STEP + 0.5 * a * _STEP**2
        x += travel
        relaxed = specimen.relaxed(x) if x > 0 else 0.0
        q = q * decay + gain * (relaxed - before)
        new = rigid * relaxed + q.sum() + dashpot * (relaxed - before) / _STEP
        if specimen.friction:
            most = specimen.friction * min(max(x / specimen.depth, 0.0), 1.0)
            stuck = min(max(stuck + specimen.friction / specimen.reach * travel, -most), most)
            new += stuck
        before = relaxed
        v += 0.5 * (a - new / specimen.mass) * _STEP
        force, t = new, t + _STEP
        if (force <= 0 and v < 0) or t > 1:
            return _STEP * np.arange(len(result)), np.array(result)
        result.append(force)


@dataclass(frozen=True, eq=False)
class DropSet:
    """Three impacts as they are read, and what is true of the specimen."""

    name: str
    specimen: Specimen
    time: tuple
    force: tuple
    stated_speeds: tuple[float, ...]
    peak: float
    """Largest force of an impact at `OTHER`, N."""


def _record_impact(specimen: Specimen, speed: float, random, filtered: Callable | None):
    clock, pure = impact_force(specimen, speed)
    time = np.arange(-_LEAD, clock[-1] + _TAIL, 1 / RATE)
    force = np.interp(time, clock, pure, left=0.0, right=0.0)
    if filtered is not None:
        force = filtered(force)
    return time + _LEAD, force + _NOISE * pure.max() * random.standard_normal(len(time))


def _low_pass(hertz: float) -> Callable:
    b, a = signal.butter(2, hertz, fs=RATE)
    return lambda force: signal.lfilter(b, a, force)


def _rings(hertz: float) -> Callable:
    """A sensor of second order, damped by 5 %."""
    omega = 2 * np.pi * hertz
    a, b, c, d, _ = signal.cont2discrete(
        signal.tf2ss([omega**2], [1, 0.1 * omega, omega**2]), 1 / RATE, "zoh"
    )
    system = signal.ss2tf(a, b, c, d)
    return lambda force: signal.lfilter(np.squeeze(system[0]), system[1], force)


WAYS: dict[str, tuple[dict[str, float], Callable | None]] = {
    "": ({}, None),
    "friction 2 %": ({"friction": 0.02}, None),
    "friction 5 %": ({"friction": 0.05}, None),
    "friction 10 %": ({"friction": 0.10}, None),
    "steep 10 %": ({"steep": 0.1}, None),
    "steep 30 %": ({"steep": 0.3}, None),
    "tilted 1 mm": ({"tilt": 1e-3}, None),
    "tilted 3 mm": ({"tilt": 3e-3}, None),
    "filter 200 Hz": ({}, _low_pass(200.0)),
    "rings at 300 Hz": ({}, _rings(300.0)),
}
"""What there is besides, and of the sensor; of friction in parts of the force at the depth."""


def drawn_specimen(seed: int, *, fractional: bool = False) -> Specimen:
    """A specimen as a door's seal, 100 mm of it, with two slow arms and one of milliseconds."""
    random = np.random.default_rng([seed, 6])
    mass = float(random.uniform(0.1, 0.4))
    c1 = float(random.uniform(150.0, 450.0))
    depth = 1.15 * max(SPEEDS) / np.sqrt(2.0 * c1 / mass)
    bends = random.uniform(0.0, 0.6, 2)
    c = (c1, float(0.3 * bends[0] * c1 / depth), float(bends[1] * c1 / depth**2))
    slow = [random.uniform(0.3, 0.7), random.uniform(0.05, 0.15)]
    times = [float(np.exp(random.uniform(np.log(0.3), 0.0))), float(random.uniform(8.0, 25.0))]
    hidden, quick = random.uniform(0.1, 0.35), float(np.exp(random.uniform(*np.log((5e-3, 0.03)))))
    if fractional:
        solid = Solid.fractional("", 1.0, 1.0, float(random.uniform(0.02, 0.1)), 0.5)
        return Specimen(mass, c, solid, float(depth))
    solid = Solid.arms("", 1.0, (*slow, hidden), (*times, quick))
    return Specimen(mass, c, solid, float(depth))


def drop_set(way: str, seed: int) -> DropSet:
    """Impacts of a specimen with a way of `WAYS`, or "fractional"."""
    specimen = drawn_specimen(seed, fractional=way == "fractional")
    added, filtered = WAYS.get(way, ({}, None))
    random = np.random.default_rng([seed, *way.encode()])
    if "friction" in added:
        at = float(impact_force(specimen, 0.6)[1].max())
        added = {"friction": added["friction"] * at}
    specimen = Specimen(**{**vars(specimen), **added})
    rows = [_record_impact(specimen, speed, random, filtered) for speed in SPEEDS]
    stated_speeds = tuple(speed * (1 + 0.05 * random.standard_normal()) for speed in SPEEDS)
    peak = float(impact_force(specimen, OTHER)[1].max())
    return DropSet(way, specimen, *zip(*rows, strict=True), stated_speeds, peak)
