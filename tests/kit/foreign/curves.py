"""Curves of moduli, compliances and sweeps that end anywhere: before their plateau, and long after.

`moduli(300)`, `compliances(100)`, `sweeps(100)`: every family of solids by turns, a plateau of
nothing to all, no scatter to 3 %, in three of ten a common error of .5 % in each quarter decade.
A curve cut to its first tenth is `one.cut()`. Units of SI; stiffness as Pa.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import log, pi

import numpy as np

from .truths import Solid

FAMILIES = (
    "1 arm", "2 arms", "3 arms", "5 arms", "fractional", "springpot", "power law",
    "slower than the curve", "liquid", "4 arms",
)  # fmt: skip
SCATTER = (0.0, 1e-3, 1e-2, 3e-2)
COMMON = 5e-3
RESOLVED = 1e-3
"""A curve ends where it has lost all but so much."""


@dataclass(frozen=True, eq=False)
class Curve:
    """Values at times, s, or storage and loss at frequencies, Hz, and the solid that has them."""

    name: str
    kind: str
    at: np.ndarray
    values: np.ndarray
    solid: Solid
    slowest: float

    @property
    def end(self) -> float:
        """T, s: 1/omega of the lowest line of a sweep."""
        return float(1 / (2 * pi * self.at.min()) if self.kind == "sweep" else self.at.max())

    @property
    def settled(self) -> bool:
        """It was watched for ten times its slowest arm."""
        return self.end >= 10 * self.slowest

    def truth(self, times: float) -> float:
        """Stiffness at so many T: k(t), K'(1/t), 1/J(t)."""
        t = times * self.end
        if np.isinf(t):
            return self.solid.k_inf + sum(k for k, tau in _pairs(self.solid) if tau >= 1e11)
        if self.kind == "sweep":
            return float(self.solid.stiffness(1 / t).real)
        return float(1 / crept(self.solid, t) if self.kind == "creep" else self.solid.relaxation(t))

    def cut(self, part: float = 0.1) -> Curve:
        """Its first tenth."""
        fast = self.at * part >= self.at.min() if self.kind == "sweep" else None
        retained = self.at <= part * self.at.max() if fast is None else fast
        return replace(
            self, name=f"{self.name}, cut", at=self.at[retained], values=self.values[..., retained]
        )


def _pairs(solid: Solid):
    return zip(solid.k, solid.tau, strict=True)


def _log_uniform(random, low: float, high: float) -> float:
    return float(np.exp(random.uniform(log(low), log(high))))


def _draw_solid(family: str, random) -> tuple[Solid, float, float]:
    """A solid with relaxation times about 1 s, its slowest one, and the time to watch it for."""
    E = _log_uniform(random, 1e5, 1e7)
    share = 0.0 if family == "liquid" else float(random.uniform(0.02, 1.0))
    name, times = f"{family}, {share:.2f}", _log_uniform(random, 0.1, 100.0)
    if family in {"fractional", "springpot", "power law"}:
        lasts = _log_uniform(random, 3.0, 3e4)
        power = float(random.uniform(0.3, 0.7))
        if family == "fractional":
            return Solid.fractional(name, share * E, E, 1.0, power), np.inf, lasts
        if family == "springpot":
            return Solid.springpot(name, share * E, 0.5 * E, 0.5 * power), np.inf, lasts
        return Solid.power_law(name, share * E, E, 0.05, 0.7 * power), np.inf, lasts
    count = 2 if family in {"liquid", "slower than the curve"} else int(family.split()[0])
    tau = np.exp(np.cumsum(random.uniform(0.8, 3.0, count)))
    k = E * random.dirichlet(np.full(count, 1.5))
    slowest = float(tau[-1])
    watched = times * slowest
    if family == "slower than the curve":
        slow = watched * _log_uniform(random, 3.0, 30.0)
        k, tau, slowest = np.append(k, E * random.uniform(0.1, 0.4)), np.append(tau, slow), slow
    return Solid.arms(name, share * E, k, tau), slowest, watched


def crept(solid: Solid, t):
    r"""J(t) of :math:`1 = \int k(t-u)\,\mathrm dJ`: by the zeros of s K(s), between its poles.

    Between the poles -1/tau of :math:`f(p) = k_\infty - p\sum_j k_j/(1/\tau_j - p)` f falls from
    infinity to minus infinity, or from k_inf at p = 0: one zero p_i in each, found by halving.
    """
    k, rate = np.array(solid.k), 1 / np.array(solid.tau)
    order = np.argsort(rate)
    k, rate = k[order], rate[order]
    mask = k > 1e-18 * k.sum()  # a density far out is no pole
    k, rate = k[mask], rate[mask]

    def stiff(p):
        return solid.k_inf - (p[:, None] * k / (rate - p[:, None])).sum(axis=1)

    low, high = np.concatenate(([0.0], rate[:-1])), rate.copy()
    for _ in range(48):
        middle = 0.5 * (low + high)
        above = stiff(middle) > 0
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    p = 0.5 * (low + high)
    glass = 1 / (solid.k_inf + k.sum())
    # residues of 1/(s k(s)) at s = -p: d/ds of s k(s) = -p f(p)
    slope = (k * rate / (rate - p[:, None]) ** 2).sum(axis=1)
    t = np.asarray(t, float)[..., None]
    if solid.k_inf > 0:
        return glass + (-np.expm1(-p * t) / (p * slope)).sum(axis=-1)
    # of a liquid the first zero is 0: J = glass + t/eta + ...
    flow = t[..., 0] / float(k @ (1 / rate))
    return glass + flow + (-np.expm1(-p[1:] * t) / (p[1:] * slope[1:])).sum(axis=-1)


def _noise(random, at, parts: int):
    """Relative errors, shape (parts, n): scatter, and in three of ten what neighbours share."""
    scatter = SCATTER[int(random.integers(len(SCATTER)))]
    error = scatter * random.standard_normal((parts, len(at)))
    if random.random() < 0.3:
        quarter = np.floor(4 * np.log10(at / at.min()) + 1e-9).astype(int)
        error += COMMON * random.standard_normal((parts, quarter.max() + 1))[:, quarter]
    return error


def _times(random, watched: float) -> np.ndarray:
    first = watched / _log_uniform(random, 1e2, 1e5)
    count = int(np.log10(watched / first) * random.uniform(8, 25)) + 1
    return np.geomspace(first, watched, count)


def moduli(count: int, seed: int = 0) -> Iterator[Curve]:
    """E(t), even in ln t."""
    for i in range(count):
        random = np.random.default_rng([seed, i, 1])
        solid, slowest, watched = _draw_solid(FAMILIES[i % len(FAMILIES)], random)
        t = _times(random, watched)
        pure = solid.relaxation(t)
        t, pure = (part[pure > RESOLVED * pure[0]] for part in (t, pure))
        values = pure * (1 + _noise(random, t, 1)[0])
        yield Curve(f"{i} {solid.name}", "curve", t, values, solid, slowest)


def compliances(count: int, seed: int = 0) -> Iterator[Curve]:
    """J(t), even in ln t."""
    for i in range(count):
        random = np.random.default_rng([seed, i, 2])
        solid, slowest, watched = _draw_solid(FAMILIES[i % len(FAMILIES)], random)
        if solid.k_inf > 0 and np.isfinite(slowest):
            # it creeps as much later than it relaxes as it softens
            late = (solid.k_inf + sum(solid.k)) / solid.k_inf
            slowest, watched = late * slowest, late * watched
        t = _times(random, watched)
        values = crept(solid, t) * (1 + _noise(random, t, 1)[0])
        yield Curve(f"{i} {solid.name}", "creep", t, values, solid, slowest)


def sweeps(count: int, seed: int = 0) -> Iterator[Curve]:
    """E' and E'' at lines even in ln f."""
    for i in range(count):
        random = np.random.default_rng([seed, i, 3])
        solid, slowest, watched = _draw_solid(FAMILIES[i % len(FAMILIES)], random)
        f = 1 / (2 * pi * _times(random, watched)[::-1])
        value = solid.stiffness(2 * pi * f)
        mask = value.real > RESOLVED * value.real.max()
        f, value = f[mask], value[mask]
        error = _noise(random, f, 2)
        values = np.array([value.real * (1 + error[0]), value.imag * (1 + error[1])])
        yield Curve(f"{i} {solid.name}", "sweep", f, values, solid, slowest)
