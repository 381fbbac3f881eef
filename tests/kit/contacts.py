"""Contacts of an indenter, marched in time apart from dashpot: plain steps, plain sums."""

from __future__ import annotations

import numpy as np


def march(force, mass, speed, *, pull=0.0, step=1e-6):
    """Time, displacement, velocity and force of F(x, v), by midpoint steps until F falls to 0."""
    x, v, rows = 0.0, speed, [(0.0, 0.0, speed, force(0.0, speed))]
    while True:
        half = v + step / 2 * (pull - force(x, v) / mass)
        middle = x + step / 2 * v
        x, v = x + step * half, v + step * (pull - force(middle, half) / mass)
        now = force(x, v)
        rows.append((len(rows) * step, x, v, max(now, 0.0)))
        if now <= 0 and v < 0:
            return np.array(rows).T


def kelvin_voigt(k, c):
    return lambda x, v: k * x + c * v


def kuwabara(k, A):
    return lambda x, v: k * (max(x, 0) ** 1.5 + 1.5 * A * max(x, 0) ** 0.5 * v)


def ting(k, g, tau, mass, speed, *, steps=1200, end=3e-3):
    """Lee, Radok and Ting by sums over the whole history at every step (velocity Verlet)."""
    dt = end / steps
    x, F, v = np.zeros(steps), np.zeros(steps), speed
    turned = 0
    for i in range(1, steps):
        x[i] = x[i - 1] + dt * v - dt**2 / 2 * F[i - 1] / mass
        E = 1 + g * np.exp(-(i - np.arange(i) - 0.5) * dt / tau)
        grown = E * np.diff(np.maximum(x[: i + 1], 0) ** 1.5)
        turned = turned or (i - 1 if x[i] < x[i - 1] else 0)
        if turned:
            back = np.cumsum((E * np.diff(x[: i + 1]))[::-1])[::-1][:turned]
            last = np.flatnonzero(back >= 0)
            if not last.size:
                cut = slice(0, i)
                return np.arange(i) * dt, x[cut], F[cut], -v / speed
            j = int(last[-1])
            after = back[j + 1] if j + 1 < turned else back[j]
            part = back[j] / (back[j] - after) if back[j] > after else 0.0
            F[i] = k * (grown[:j].sum() + part * grown[j])
        else:
            F[i] = k * grown.sum()
        v -= dt / 2 * (F[i] + F[i - 1]) / mass
    raise AssertionError("still in contact")


def record_sensor(
    rows, mass, rate, *, of="acceleration", before=1.0, after=1.0, phase=0.3, pull=0.0
):
    """Time and what a sensor records of a march, with flights to either side; touch at 0."""
    T, X, V, F = rows
    end = T[-1]
    t = np.arange(-before * end, (1 + after) * end, 1 / rate) + phase / rate
    flight = np.minimum(t, 0) + np.maximum(t - end, 0)
    if of == "velocity":
        return t, np.interp(t, T, V) + pull * flight
    if of == "displacement":
        return t, np.interp(t, T, X) + V[0] * np.minimum(t, 0) + V[-1] * np.maximum(t - end, 0)
    push = np.interp(t, T, F, left=0.0, right=0.0)
    return t, push if of == "force" else -push / mass


def noisy(values, part=0.005, *, seed=1):
    scale = part * np.abs(values).max()
    return values + scale * np.random.default_rng(seed).standard_normal(len(values))
