r"""Solids that are known: their stiffness, their force under any motion, a mass on them.

Every linear solid is a sum of arms,

.. math:: k(t) = k_\infty + \sum_j k_j e^{-t/\tau_j}, \qquad
    K(\omega) = k_\infty + \sum_j k_j \frac{j\omega\tau_j}{1 + j\omega\tau_j}.

One that is no sum of arms is written as a dense one: its spectrum over :math:`\ln\tau` is analytic
in a strip of half width d, so that the trapezoidal rule of step h errs by :math:`e^{-2\pi d/h}`,
here below 1e-6 (Trefethen and Weideman, SIAM Review 56 (2014) 385). The force of a motion that is
straight between instants is the convolution of its steps with the means of k(t) over each,

.. math:: F_i = \sum_{m \le i} (x_m - x_{m-1}) \frac1h \int_{(i-m)h}^{(i-m+1)h} k(t)\,\mathrm dt,

exact but for rounding. SI units.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import gamma, log, pi

import numpy as np
from scipy import fft
from scipy.optimize import minimize_scalar

_STEP = 0.4
"""h, of the dense sums."""
_FAST, _SLOW, _SPRING = 1e-8, 1e9, 1e12
"""s; what is faster is a dashpot to every record, what is slower a spring: an arm of the last."""


@dataclass(frozen=True)
class Solid:
    """k_inf + sum of k exp(-t / tau), N/m (or Pa) and s; tau ascending."""

    name: str
    k_inf: float
    k: tuple[float, ...]
    tau: tuple[float, ...]

    @classmethod
    def arms(cls, name: str, k_inf: float, k, tau) -> Solid:
        """Generalized Maxwell (Wiechert): the solid of the paper's eq. 2."""
        order = np.argsort(tau)
        return cls(name, float(k_inf), *(tuple(np.take(item, order).tolist()) for item in (k, tau)))

    @classmethod
    def fractional(cls, name: str, k_inf: float, k: float, tau: float, alpha: float) -> Solid:
        r"""k_inf + k E_alpha(-(t/tau)^alpha), K = k_inf + k z/(1+z), z = (j w tau)^alpha.

        Its spectrum: Cole and Cole, J. Chem. Phys. 9 (1941) 341; alpha <= .75 for the strip.
        """
        angle = pi * alpha
        return cls._dense(
            name, k_inf, tau,
            lambda z: k * np.sin(angle) / (np.cosh(alpha * z) + np.cos(angle)) / (2 * pi),
        )  # fmt: skip

    @classmethod
    def springpot(cls, name: str, k_inf: float, c: float, alpha: float) -> Solid:
        """k_inf + c t^-alpha / Gamma(1-alpha), K = k_inf + c (j w)^alpha; alpha <= .4.

        Scott Blair, J. Colloid Sci. 2 (1947) 21.
        """
        return cls._dense(
            name, k_inf, 1.0, lambda z: c * np.exp(-alpha * z) / gamma(alpha) / gamma(1 - alpha)
        )

    @classmethod
    def power_law(cls, name: str, k_inf: float, k: float, t_0: float, beta: float) -> Solid:
        """k_inf + k (1 + t/t_0)^-beta: rates u/t_0, u gamma-distributed."""
        return cls._dense(
            name, k_inf, t_0, lambda z: k * np.exp(-beta * z - np.exp(-z)) / gamma(beta)
        )

    @classmethod
    def _dense(cls, name: str, k_inf: float, t_0: float, spectrum: Callable) -> Solid:
        z = _STEP * np.arange(-900, 901)
        with np.errstate(over="ignore", under="ignore"):
            k, tau = _STEP * spectrum(z), t_0 * np.exp(z)
        fast, slow = tau < _FAST, tau > _SLOW
        mask = ~fast & ~slow & (k > 0)
        dashpot = float(k[fast] @ tau[fast]) / _FAST
        return cls.arms(
            name, k_inf, [dashpot, *k[mask], k[slow].sum()], [_FAST, *tau[mask], _SPRING]
        )

    def relaxation(self, t):
        """k(t), t > 0."""
        return self.k_inf + np.exp(-np.asarray(t, float)[..., None] / self.tau) @ np.array(self.k)

    def stiffness(self, omega):
        """K(omega) = K' + j K''; omega in rad/s."""
        turn = 1j * np.asarray(omega, float)[..., None] * np.array(self.tau)
        return self.k_inf + (turn / (1 + turn)) @ np.array(self.k)

    def means(self, count: int, step: float):
        """Of k(t) - k_inf over each of `count` steps."""
        # exp(-(a B + b) h/tau) is a product of two short tables
        short = 1024
        z = step / np.array(self.tau)
        far = np.exp(-z * short * np.arange(-(-count // short))[:, None])
        near = np.exp(-z * np.arange(short)[:, None])
        return ((far * (np.array(self.k) * -np.expm1(-z) / z)) @ near.T).ravel()[:count]

    def force(self, x, step: float):
        """Force of a motion that is straight between instants `step` apart, from rest at 0."""
        x, size = np.asarray(x, float), fft.next_fast_len(2 * len(x), real=True)
        history = fft.rfft(self.means(len(x), step), size) * fft.rfft(np.diff(x, prepend=0.0), size)
        return self.k_inf * x + fft.irfft(history, size)[: len(x)]

    def within(self, fast: float, slow: float) -> tuple[float, float, np.ndarray, np.ndarray]:
        """Spring, dashpot, k and tau of what lies between: for a system of equations."""
        k, tau = np.array(self.k), np.array(self.tau)
        quick, late = tau < fast, tau > slow
        mask = ~quick & ~late
        return self.k_inf + float(k[late].sum()), float(k[quick] @ tau[quick]), k[mask], tau[mask]


@dataclass(frozen=True)
class Seal:
    r"""A solid under Fung's quasi-linear law, with sliders beside it.

    .. math:: F = \int k(t - s)\,\mathrm d e(x(s)) + F_f, \qquad
        \frac eD = u + a (u^2 - u) + c (u^3 - u), \quad u = \frac xD

    so that the secant at the depth D, m, is that of the solid and the tangent :math:`1 + a + 2c` of
    it: a = .08 bends the law by 8 %, a < 0 softens, c alone is a cubic. The sliders, five Jenkins
    elements of `friction` N in all (Iwan, J. Appl. Mech. 33 (1966) 893), slip after `reach`, m, and
    its doubles.
    """

    solid: Solid
    depth: float = 8e-3
    a: float = 0.0
    c: float = 0.0
    friction: float = 0.0
    reach: float = 1e-4

    @property
    def tangent(self) -> float:
        """dF/dx at the depth over the secant."""
        return 1 + self.a + 2 * self.c

    def elastic(self, x):
        """e(x), m."""
        u = np.asarray(x, float) / self.depth
        return self.depth * (u + self.a * (u * u - u) + self.c * (u**3 - u))

    def force(self, x, step: float):
        """Of a motion in equal steps, N."""
        total = self.solid.force(self.elastic(x), step)
        for times in 2.0 ** np.arange(5) if self.friction else ():
            total = total + slider(x, self.friction / 5, self.friction / 5 / self.reach / times)
        return total

    def secant(self, t):
        """Force over depth at t after a step, N/m, with the sliders, which hold what they have."""
        return self.solid.relaxation(t) + self.friction / self.depth

    def stiffness(self, omega):
        """K of a vibration about the depth, N/m: the solid's; sliders that stick would add."""
        return self.tangent * self.solid.stiffness(omega)

    def accelerance(self, frequency, mass: float, seals: float = 1.0):
        """a/F = -w^2/(n K - m w^2), 1/kg: eq. 7 of the paper, with its phase."""
        omega = 2 * pi * np.asarray(frequency, float)
        return -(omega**2) / (seals * self.stiffness(omega) - mass * omega**2)

    def peak(self, mass: float, seals: float = 1.0) -> tuple[float, float]:
        """Frequency, Hz, and height of the accelerance at its peak."""
        lines = np.geomspace(0.5, 500.0, 4000)
        top = lines[np.argmax(np.abs(self.accelerance(lines, mass, seals)))]
        solution = minimize_scalar(
            lambda f: -abs(self.accelerance(f, mass, seals)),
            bounds=(top / 1.02, top * 1.02), method="bounded", options={"xatol": 1e-10 * top},
        )  # fmt: skip
        return float(solution.x), float(-solution.fun)

    def mass_at(self, frequency: float, seals: float = 1.0) -> float:
        """The mass, kg, that the seals' storage stiffness brings to resonance there."""
        omega = 2 * pi * frequency
        return float(seals * self.stiffness(omega).real / omega**2)


def slider(x, limit: float, stiffness: float):
    """A spring and a Coulomb slider in series (Jenkins), N: exact from each turning point on."""
    x = np.asarray(x, float)
    step = np.sign(np.diff(x))
    moving = np.flatnonzero(step)
    turns = moving[1:][step[moving[1:]] != step[moving[:-1]]]
    force, start, carried = np.empty_like(x), 0, 0.0
    for end in [*turns.tolist(), len(x) - 1]:
        part = carried + stiffness * (x[start : end + 1] - x[start])
        force[start : end + 1] = np.clip(part, -limit, limit)
        start, carried = end, force[end]
    return force


# -- solids as seals have them ---------------------------------------------------------------------

TABLE_1 = Solid.arms("Table 1", 196.5, (117.5, 17.8), (59.0 / 117.5, 292.2 / 17.8))
"""The paper's seal at 8 mm: k_inf .1965, k .1175 and .0178 N/mm, b = k tau .0590, .2922 N s/mm."""
BROAD = Solid.arms(
    "broad", 196.5, (20.0, 20.0, 20.0, 117.5, 17.8), (3.2e-3, 0.016, 0.08, *TABLE_1.tau)
)
"""The same with three arms that a ramp of 1 s hardly sees: loss factor .0562 at 12.71 Hz."""
FAMILIES = (
    "1 arm", "2 arms", "3 arms", "4 arms", "5 arms", "6 arms", "fractional",
    "springpot", "power law", "slower than the hold",
)  # fmt: skip


def draw_truth(family: str, seed: int, *, hold: float = 80.0) -> Solid:
    """A solid of a family, as soft as 50 to 100 mm of a door's seal; `hold` in s."""
    random = np.random.default_rng([seed, FAMILIES.index(family)])
    name = f"{family}, {seed}"
    k_inf = float(np.exp(random.uniform(log(80.0), log(500.0))))
    lost = k_inf * float(random.uniform(0.3, 1.5))
    t_0, power = np.exp(random.uniform(log(0.02), log(5.0))), float(random.uniform(0.3, 0.7))
    if family == "fractional":
        return Solid.fractional(name, k_inf, lost, float(t_0), power)
    if family == "springpot":
        return Solid.springpot(name, k_inf, 0.5 * lost, 0.5 * power)
    if family == "power law":
        return Solid.power_law(name, k_inf, lost, float(t_0) / 20, 0.7 * power)
    slow = family == "slower than the hold"
    count = 2 if slow else int(family.split()[0])
    # one in each equal part of 5 ms to 60 s, in ln tau
    ends = np.linspace(log(5e-3), log(60.0), count + 1)
    tau = np.exp(random.uniform(ends[:-1] + 0.3, ends[1:] - 0.3)).tolist()
    share = random.uniform(0.3, 1.0, count)
    k = (lost * share / share.sum()).tolist()
    if slow:
        k.append(k_inf * float(random.uniform(0.1, 0.4)))
        tau.append(hold * float(np.exp(random.uniform(log(3.0), log(30.0)))))
    return Solid.arms(name, k_inf, k, tau)


_COUNTS = (2, 6, 6, 6, 4, 4, 5, 2, 4, 3)
TRUTHS: tuple[Solid, ...] = (
    TABLE_1, BROAD,
    *(draw_truth(family, seed) for family, many in zip(FAMILIES, _COUNTS, strict=True)
      for seed in range(many - (family in {"2 arms", "5 arms"}))),
)  # fmt: skip
"""The 42 that verdicts are judged on."""
