"""The other tests that a lab brings, each with its truth by formulas, sound or spoilt.

`sheets("creep")` are twenty of a kind, `KINDS` its function and the ways to spoil it. A `Sheet` is
columns as a file has them and what is true of them; noise is part of a sound one. Moduli are solids
of `truths` read as Pa. SI units but for the columns, which say theirs.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import log, pi

import numpy as np
from scipy import signal

from .rigs import table
from .truths import FAMILIES, Seal, Solid, draw_truth

GRAVITY = 9.80665
CYCLES = 6
"""Of compression: after three it still softens by 3 to 5 %."""
_FINE = 4
"""Instants of a simulation to a row."""


@dataclass(frozen=True, eq=False)
class Sheet:
    """One test: columns by their names with units, its truth, and how it was spoilt."""

    kind: str
    name: str
    columns: Mapping[str, np.ndarray]
    truth: Mapping[str, object]
    spoilt: str = ""

    def __getitem__(self, name: str) -> np.ndarray:
        """The column whose name begins so."""
        return next(column for head, column in self.columns.items() if head.startswith(name))

    def text(self) -> str:
        """As a file, every digit kept."""
        return table(*self.columns.items())


def _start(kind: str, seed: int):
    return np.random.default_rng([seed, *kind.encode()])


def _scatter(random, count: int):
    """Complex, of 1 in each part."""
    return random.standard_normal(count) + 1j * random.standard_normal(count)


def _log_uniform(random, low: float, high: float) -> float:
    return float(np.exp(random.uniform(log(low), log(high))))


def _modulus(seed: int, families=FAMILIES[1:9]) -> Solid:
    """A solid of rubber, Pa."""
    solid = draw_truth(families[seed % len(families)], seed)
    return replace(solid, k_inf=1e4 * solid.k_inf, k=tuple(1e4 * k for k in solid.k))


def simulate_response(system, u, step: float):
    """y = c x + d u of dx/dt = A x + b u from rest, u straight between instants: exact by modes."""
    A, b, c, d = system
    poles, modes = np.linalg.eig(A)
    total = d * np.asarray(u, float)
    for p, weight in zip(poles, (c @ modes) * np.linalg.solve(modes, b), strict=True):
        z = p * step
        grown = np.expm1(z)
        # (e^z - 1)/z and (e^z - 1 - z)/z^2
        value, two = (1 + z / 2, 0.5 + z / 6) if abs(z) < 1e-6 else (grown / z, (grown - z) / z**2)
        gain = weight * step * np.array([two, value - two])
        total = total + signal.lfilter(gain, [1.0, -1 - grown], u).real
    return total


# -- vibration -------------------------------------------------------------------------------------


def impact(seed: int, spoilt: str = "") -> Sheet:
    """Hits of a mass on two seals: m a + n F(x) = hammer, by the modes of its equations."""
    random = _start("impact", seed)
    seal = Seal(draw_truth(FAMILIES[1 + seed % 5], seed))
    mass, rate, between = seal.mass_at(random.uniform(8, 25), 2), 2048, 8.0
    clock = np.arange(round(5 * between * rate * _FINE)) / rate / _FINE
    force = np.zeros_like(clock)
    for hit in range(5):
        width, high = random.uniform(12e-3, 22e-3), random.uniform(2.0, 5.0)
        again = ((0.25, 1.0), (0.31, 0.4)) if spoilt == "double hit" else ((0.25, 1.0),)
        for start, part in again:
            turn = (clock - hit * between - start) / width
            force += part * high * np.sin(pi * np.clip(turn, 0, 1)) ** 2
    spring, dashpot, k, tau = seal.solid.within(1e-6, 1e7)
    # x, v, and of each arm the stretch of its spring
    A = np.zeros((2 + len(k), 2 + len(k)))
    A[0, 1], A[2:, 1] = 1.0, 1.0
    A[1] = -2 / mass * np.array([spring, dashpot, *k])
    A[2:, 2:] -= np.diag(1 / tau)
    b = np.zeros(len(A))
    b[1] = 1 / mass
    pure = simulate_response((A, b, A[1], 1 / mass), force, 1 / rate / _FINE)
    shown = pure * (1.05 if spoilt == "gain 5 %" else 1.0)
    if spoilt == "lag 1 ms":
        shown = np.interp(clock - 1e-3, clock, shown)
    time = clock[::_FINE]
    return Sheet("impact", f"{seal.solid.name}, hit", {
        "time [s]": time,
        "hammer [N]": force[::_FINE] + 5e-3 * random.standard_normal(len(time)),
        "acceleration [m/s^2]": shown[::_FINE] + 0.02 * random.standard_normal(len(time)),
    }, {"seal": seal, "mass": mass, "seals": 2, "hammer": force[::_FINE], "pure": pure[::_FINE]},
        spoilt)  # fmt: skip


def frf(seed: int, spoilt: str = "") -> Sheet:
    """Lines of the accelerance, with 1 % of scatter; "mass": the lab names one 5 % too heavy."""
    random = _start("frf", seed)
    seal = Seal(draw_truth(FAMILIES[1 + seed % 8], seed))
    mass, lines = seal.mass_at(random.uniform(8, 25), 2), np.arange(3.0, 60.0, 0.125)
    pure = seal.accelerance(lines, mass, 2)
    error = 0.007 * _scatter(random, len(lines))
    fault = {"phase 3 deg": np.exp(3j * pi / 180), "gain 5 %": 1.05}.get(spoilt, 1.0)
    value = pure * (1 + error) * fault
    stated = mass * (1.05 if spoilt == "mass" else 1.0)
    return Sheet("frf", f"{seal.solid.name}, FRF", {
        "frequency [Hz]": lines, "real [(m/s^2)/N]": value.real,
        "imaginary [(m/s^2)/N]": value.imag,
    }, {"seal": seal, "mass": mass, "stated": stated, "seals": 2, "pure": pure},
        spoilt)  # fmt: skip


def rod(seed: int, spoilt: str = "") -> Sheet:
    r"""A rod under a mass on a shaker: 1/T = cos z - (M/m) z sin z, z = w L sqrt(rho/E).

    V. M. Kulik et al., Exp. Mech. (2009). "rocking": a mode beside it, .15 of the motion.
    """
    random = _start("rod", seed)
    solid, length, density = _modulus(seed), 20e-3, 1000.0
    ratio, lines = random.uniform(2, 10), np.arange(20.0, 400.0, 1.0)
    pure = rod_response(solid, lines, length, density, ratio)
    value = pure * (1 + 0.005 * _scatter(random, len(lines)))
    value = value * {"phase 3 deg": np.exp(3j * pi / 180), "gain 3 %": 1.03}.get(spoilt, 1.0)
    if spoilt == "rocking":
        middle = 0.7 * lines[np.argmax(np.abs(pure))]
        value = value + 0.15 / (1 - (lines / middle) ** 2 + 0.1j)
    return Sheet("rod", f"{solid.name}, rod", {
        "frequency [Hz]": lines, "real [m/m]": value.real, "imaginary [m/m]": value.imag,
    }, {"solid": solid, "length": length, "diameter": length, "density": density,
        "mass": ratio * density * length**3 * pi / 4}, spoilt)  # fmt: skip


def rod_response(solid: Solid, frequency, length: float, density: float, ratio: float):
    """T of a rod with so many times its mass on top."""
    omega = 2 * pi * np.asarray(frequency, float)
    z = omega * length * np.sqrt(density / solid.stiffness(omega))
    return 1 / (np.cos(z) - ratio * z * np.sin(z))


# -- curves ----------------------------------------------------------------------------------------


def creep(seed: int, spoilt: str = "") -> Sheet:
    """A part under a load that is put on in .2 s: x = (F + sum k r)/k_0, tau dr/dt = x - r."""
    random = _start("creep", seed)
    solid = draw_truth(FAMILIES[1 + seed % 5], seed)
    rate, hold, load = 50, _log_uniform(random, 30.0, 300.0), random.uniform(0.5, 2.0)
    time = np.arange(round((1 + hold) * rate)) / rate
    force = load * np.clip((time - 1) / 0.2, 0, 1)
    if spoilt == "load sags":
        force *= 1 - 0.02 * np.clip((time - 1) / hold, 0, 1)
    k, tau = np.array(solid.k), np.array(solid.tau)
    k_0 = solid.k_inf + k.sum()
    A = (np.ones((len(k), 1)) * k / k_0 - np.eye(len(k))) / tau[:, None]
    pure = simulate_response((A, 1 / k_0 / tau, k / k_0, 1 / k_0), force, 1 / rate)
    shown = pure + 1e-6 * random.standard_normal(len(time))
    if spoilt == "gauge drifts":
        shown += 1e-4 * time / time[-1]
    stated = load * np.clip((time - 1) / 0.2, 0, 1)
    return Sheet("creep", f"{solid.name}, creep", {
        "time [s]": time, "displacement [mm]": 1e3 * shown,
        "force [N]": stated + 1e-3 * random.standard_normal(len(time)),
    }, {"solid": solid, "pure": pure, "force": force}, spoilt)  # fmt: skip


def modulus(seed: int, spoilt: str = "") -> Sheet:
    """E(t), even in ln t, with .5 % of scatter; "common": .5 % more in each quarter decade."""
    random = _start("modulus", seed)
    solid = _modulus(seed)
    end = _log_uniform(random, 30.0, 3000.0) / (10 if spoilt == "first tenth" else 1)
    time = np.geomspace(0.01, end, 80)
    pure = solid.relaxation(time)
    value = pure * (1 + 5e-3 * random.standard_normal(len(time)))
    if spoilt == "common":
        shared = np.floor(4 * np.log10(time / time[0])).astype(int)
        value = value * (1 + 5e-3 * random.standard_normal(shared[-1] + 1)[shared])
    return Sheet("modulus", f"{solid.name}, E(t)", {
        "time [s]": time, "relaxation modulus [MPa]": 1e-6 * value,
    }, {"solid": solid, "pure": pure, "end": end}, spoilt)  # fmt: skip


def wlf(kelvin, reference: float, c1: float, c2: float):
    """log10 a_T of Williams, Landel and Ferry (1955)."""
    return -c1 * (kelvin - reference) / (c2 + kelvin - reference)


def _sweep(kind: str, seed: int, spoilt: str, celsius) -> Sheet:
    random = _start(kind, seed)
    solid, reference = _modulus(seed, ("6 arms", "fractional", "power law")), 293.15
    law = (reference, float(random.uniform(6, 10)), float(random.uniform(100, 140)))
    kelvin = np.repeat(np.asarray(celsius, float) + 273.15, 16)
    lines = np.tile(np.geomspace(0.1, 30.0, 16), len(celsius))
    true = kelvin + (2.0 if spoilt == "2 K off" else 0.0) * (kelvin == kelvin[-1])
    a_t, b_t = 10 ** wlf(true, *law), true / reference
    pure = b_t * solid.stiffness(2 * pi * lines * a_t)
    if spoilt == "two shifts":  # the faster half of the spectrum shifts by .8 of the rest
        fast = np.array(solid.tau) < 0.3
        k = np.array(solid.k)
        slow = replace(solid, k=tuple(np.where(fast, 0.0, k)))
        quick = replace(solid, k_inf=0.0, k=tuple(np.where(fast, k, 0.0)))
        individual = b_t * quick.stiffness(2 * pi * lines * a_t**0.8)
        pure = b_t * slow.stiffness(2 * pi * lines * a_t) + individual
    value = pure + 0.01 * np.abs(pure) * _scatter(random, len(lines))
    if spoilt == "instrument gives":
        value = 1 / (1 / value + 0.1 / solid.stiffness(2 * pi).real)
    warm = {"temperature [degC]": kelvin - 273.15} if len(celsius) > 1 else {}
    return Sheet(kind, f"{solid.name}, {kind}", {
        **warm, "frequency [Hz]": lines, "storage modulus [MPa]": 1e-6 * value.real,
        "loss modulus [MPa]": 1e-6 * value.imag,
    }, {"solid": solid, "law": law, "pure": pure}, spoilt)  # fmt: skip


def dma(seed: int, spoilt: str = "") -> Sheet:
    """Storage and loss over frequency at 20 degC, 1 % of scatter."""
    return _sweep("dma", seed, spoilt, (20.0,))


def dma_temperatures(seed: int, spoilt: str = "") -> Sheet:
    """The same at five temperatures: E = b_T E(w a_T), WLF, b_T = T/T_0."""
    return _sweep("dma temperatures", seed, spoilt, (-20.0, -5.0, 10.0, 23.0, 40.0))


# -- amplitude -------------------------------------------------------------------------------------


def jenkins(X, stiffness: float, limit: float):
    """First harmonic of a spring and a slider in series at the amplitude X: K' + j K''."""
    X = np.maximum(np.asarray(X, float), limit / stiffness)
    angle = np.arccos(1 - 2 * limit / (stiffness * X))
    storage = stiffness / pi * (angle - 0.5 * np.sin(2 * angle))
    return storage + 4j * limit * (X - limit / stiffness) / (pi * X**2)


def amplitude(seed: int, spoilt: str = "") -> Sheet:
    r"""Storage and loss over strain by Kraus's law, .5 % of scatter.

    :math:`G' = G_\infty + \Delta/(1 + r^{2m}), G'' = G''_\infty + 2 \Delta'' r^m/(1 + r^{2m})`,
    r = strain over `half`. Spoilt by a cubic spring, 3/4 k_3 X^2, or a Jenkins element beside it.
    """
    random = _start("amplitude", seed)
    X, f = np.tile(np.geomspace(1e-4, 0.1, 14), 2), np.repeat([10.0, 100.0], 14)
    half, power = _log_uniform(random, 2e-3, 2e-2), random.uniform(0.45, 0.7)
    base, lost = random.uniform(1e6, 3e6), random.uniform(1e6, 3e6)
    r = (X / half) ** power
    pure = base + lost / (1 + r * r) + 1j * (0.08 * base + 0.5 * lost * r / (1 + r * r))
    pure = pure * np.where(f > 50, 1.2, 1.0)
    truth = {"base": base, "lost": lost, "half": half, "power": power}
    if spoilt == "cubic":
        pure = pure + 0.75 * 20 * base * X**2
    if spoilt == "Jenkins":
        pure = pure + jenkins(X, 0.3 * base, 0.3 * base * half)
    scatter = _scatter(random, len(X))
    value = pure + 5e-3 * (pure.real * scatter.real + 1j * pure.imag * scatter.imag)
    return Sheet("amplitude", f"Kraus {seed}", {
        "frequency [Hz]": f, "strain [%]": 100 * X, "storage modulus [MPa]": 1e-6 * value.real,
        "loss modulus [MPa]": 1e-6 * value.imag,
    }, {**truth, "pure": pure}, spoilt)  # fmt: skip


def loops(seed: int, spoilt: str = "") -> Sheet:
    """Harmonic loops of a seal and its sliders at rising amplitudes about a preload."""
    random = _start("loops", seed)
    seal = Seal(draw_truth(FAMILIES[1 + seed % 5], seed), friction=float(random.uniform(0, 0.1)))
    hertz, rate, sizes = 5.0, 500, np.array([1e-4, 3e-4, 1e-3, 2e-3])
    clock = np.arange(round((20 + 8) * rate * _FINE)) / rate / _FINE
    since = np.maximum(clock - 20, 0)
    size = sizes[np.minimum((since / 2).astype(int), 3)]
    x = 4e-3 * np.clip(clock, 0, 1) + size * np.sin(2 * pi * hertz * since)
    pure = seal.force(x, clock[1])
    shown = np.interp(clock - 2e-3, clock, pure) if spoilt == "lag 2 ms" else pure
    shown = 1.05 * shown if spoilt == "gain 5 %" else shown
    rows = slice(20 * rate * _FINE, None, _FINE)
    return Sheet("loops", f"{seal.solid.name}, loops", {
        "time [s]": clock[rows], "displacement [mm]": 1e3 * x[rows],
        "force [N]": shown[rows] + 1e-3 * random.standard_normal(len(x[rows])),
    }, {"seal": seal, "sizes": sizes, "frequency": hertz, "pure": pure[rows]}, spoilt)  # fmt: skip


def cld(seed: int, spoilt: str = "") -> Sheet:
    """Six cycles at one speed; cycle n is softer by .12 (1 - e^-(n-1)/1.5) (Mullins)."""
    random = _start("cld", seed)
    depth, speed, rate = 6e-3, _log_uniform(random, 1e-4, 2e-3), 50
    friction = 0.05 if spoilt == "friction" else 0.0
    solid = draw_truth(FAMILIES[1 + seed % 5], seed)
    seal = Seal(solid, depth, c=random.uniform(0, 0.4), friction=friction)
    slack = 0.3e-3 if spoilt == "slack" else 0.0
    travel = depth + slack
    clock = np.arange(round(2 * CYCLES * travel / speed * rate) + 1) / rate
    turn = clock * speed / travel
    plate = travel * (1 - np.abs(1 - turn % 2))
    x = np.maximum(plate - slack, 0.0)
    softer = 1 - 0.12 * -np.expm1(-np.floor(turn / 2) / 1.5)
    pure = solid.force(softer * seal.elastic(x), clock[1])
    if friction:
        pure = pure + seal.force(x, clock[1]) - solid.force(seal.elastic(x), clock[1])
    return Sheet("cld", f"{solid.name}, CLD", {
        "time [s]": clock, "displacement [mm]": 1e3 * plate,
        "force [N]": pure + 2e-3 * random.standard_normal(len(clock)),
    }, {"seal": seal, "speed": speed, "cycles": CYCLES, "pure": pure}, spoilt)  # fmt: skip


# -- materials -------------------------------------------------------------------------------------

_LATERAL = {"uniaxial": -0.5, "equibiaxial": -2.0, "planar": -1.0}
"""Of a solid that keeps its volume: the free stretch is this power of the pulled one."""


def nominal(law: str, mode: str, stretch, constants):
    r"""Nominal stress, Pa, of a law and its constants.

    Mooney and Rivlin (C10, C01): :math:`P = 2 (\lambda - \lambda_3^2/\lambda)(C_{10} + C_{01} q)`,
    q = 1/lambda, lambda^2, 1 in the three modes. Ogden (pairs mu, alpha; W of 2 mu/alpha^2):
    :math:`P = \sum \frac{2\mu}{\alpha}(\lambda^{\alpha} - \lambda_3^{\alpha})/\lambda`. Hyperfoam
    at nu = 0: the same with a free stretch of 1, so in every mode alike.
    """
    x = np.asarray(stretch, float)
    free = np.ones_like(x) if law == "hyperfoam" else x ** _LATERAL[mode]
    if law == "mooney-rivlin":
        neighbour = {"uniaxial": 1 / x, "equibiaxial": x**2, "planar": np.ones_like(x)}[mode]
        return 2 * (x - free**2 / x) * (constants[0] + constants[1] * neighbour)
    pairs = zip(constants[::2], constants[1::2], strict=True)
    return sum(2 * mu / alpha * (x**alpha - free**alpha) / x for mu, alpha in pairs)


def stress_strain(seed: int, spoilt: str = "") -> Sheet:
    """Three modes over one column of strain, .5 % of scatter of the largest stress."""
    random = _start("stress strain", seed)
    law = ("mooney-rivlin", "ogden", "hyperfoam")[seed % 3]
    stiff = _log_uniform(random, 0.3, 3.0)
    constants = stiff * np.array({
        "mooney-rivlin": [0.15e6, 0.05e6], "ogden": [0.6e6, 1.3, 1e3, 5.0],
        "hyperfoam": [0.2e6, 8.0],
    }[law])  # fmt: skip
    constants[1::2] /= 1.0 if law == "mooney-rivlin" else stiff
    strain = np.linspace(0, -0.5 if law == "hyperfoam" else 1.0, 41)[1:]
    columns = {"strain [1]": strain}
    fault = {("uniaxial", "Mullins"): 0.9, ("planar", "gain"): 1.05}
    for mode in _LATERAL:
        stress = nominal(law, mode, 1 + strain, constants) * fault.get((mode, spoilt), 1.0)
        error = 5e-3 * np.abs(stress).max() * random.standard_normal(len(strain))
        columns[f"{mode} stress [MPa]"] = 1e-6 * (stress + error)
    truth = {"law": law, "constants": tuple(constants.tolist())}
    return Sheet("stress strain", f"{law} {seed}", columns, truth, spoilt)


def indentation(seed: int, spoilt: str = "") -> Sheet:
    """A ball of 5 g falls on rubber: Hertz with one arm, its acceleration with .1 % of scatter."""
    random = _start("indentation", seed)
    mass, speed = 5e-3, random.uniform(0.5, 2.0)
    k, g = _log_uniform(random, 1e5, 1e6), random.uniform(0.1, 0.5) * (seed % 4 > 0)
    lasts = 2.9432 * (1.25 * mass / k) ** 0.4 * speed**-0.2
    tau = lasts * _log_uniform(random, 0.2, 3.0)
    contact = Solid.arms(f"contact {seed}", k * (1 - g), [k * g], [tau])
    time, x, force = simulate_impact(contact, mass, speed, 3 * lasts / 4000)
    rows = np.arange(0, len(time), 10)
    lead = time[rows[1]] * np.arange(-60, 0)
    # free fall before and after; the deceleration that a sensor on the ball shows
    pure = np.concatenate((np.zeros(60), force[rows] / mass, np.zeros(60)))
    clock = np.concatenate((lead, time[rows], time[rows[-1]] - lead[::-1]))
    shown = pure + 1e-3 * pure.max() * random.standard_normal(len(pure))
    shown += 0.03 * pure.max() if spoilt == "zero off" else 0.0
    shown = 1.05 * shown if spoilt == "gain 5 %" else shown
    return Sheet("indentation", contact.name, {
        "time [ms]": 1e3 * (clock - clock[0]), "indenter acceleration [m/s^2]": shown,
    }, {"contact": contact, "mass": mass, "speed": speed, "depth": x.max()}, spoilt)  # fmt: skip


def simulate_impact(contact: Solid, mass: float, speed: float, step: float):
    r"""Time, depth and force of m x'' = -F until F is spent, after Ting (J. Appl. Mech. 33 (1966)).

    :math:`F = \int_0^{t_1} k(t - s)\,\mathrm d x^{3/2}`; t_1 = t while the contact grows, then
    :math:`\int_{t_1}^t k(t - s)\,\mathrm dx = 0`. Equal steps, of second order: 1,300 of them err
    by some 3e-6 of the peak. Gravity is left out.
    """
    most = 8000
    means = contact.k_inf + contact.means(most, step)
    x, deep, way = np.zeros(most), np.zeros(most), np.zeros(most)
    force, v = np.zeros(most), speed
    for i in range(1, most):
        x[i] = x[i - 1] + step * (v - step * force[i - 1] / mass / 2)
        way[i] = x[i] - x[i - 1]
        deep[i] = max(x[i], 0.0) ** 1.5 - max(x[i - 1], 0.0) ** 1.5
        weight = means[i - 1 :: -1]
        if way[i] < 0:
            # sums over the last cells; t_1 lies in the cell where they pass zero
            last = np.cumsum((weight * way[1 : i + 1])[::-1])
            past = np.flatnonzero(last >= 0)
            if not past.size:
                break
            cell = i - past[0]
            residual = last[past[0]] / (weight[cell - 1] * way[cell])
            item = weight[:cell] * deep[1 : cell + 1]
            force[i] = item[:-1].sum() + residual * item[-1]
        else:
            force[i] = weight @ deep[1 : i + 1]
        v -= step * (force[i] + force[i - 1]) / mass / 2
    return step * np.arange(i), x[:i], force[:i]


KINDS = {
    "impact": (impact, ("double hit", "gain 5 %", "lag 1 ms")),
    "frf": (frf, ("phase 3 deg", "gain 5 %", "mass")),
    "rod": (rod, ("phase 3 deg", "gain 3 %", "rocking")),
    "creep": (creep, ("load sags", "gauge drifts")),
    "modulus": (modulus, ("common", "first tenth")),
    "dma": (dma, ("instrument gives",)),
    "dma temperatures": (dma_temperatures, ("2 K off", "two shifts", "instrument gives")),
    "amplitude": (amplitude, ("cubic", "Jenkins")),
    "loops": (loops, ("lag 2 ms", "gain 5 %")),
    "cld": (cld, ("slack", "friction")),
    "stress strain": (stress_strain, ("Mullins", "gain")),
    "indentation": (indentation, ("zero off", "gain 5 %")),
}


def sheets(kind: str, count: int = 20, seed: int = 0) -> tuple[Sheet, ...]:
    """So many of a kind: every other one is spoilt, in each of its ways in turn."""
    made, ways = KINDS[kind]
    spoilt = ("" if i % 2 == 0 else ways[i // 2 % len(ways)] for i in range(count))
    return tuple(made(seed + i, way) for i, way in enumerate(spoilt))
