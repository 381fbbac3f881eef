"""Squeezed specimens of a rubber of known truth in ovens of known error, by formulas alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

R = 8.314462618
HOURS = np.array([0.5, 1, 2, 5, 10, 24, 48, 72, 168, 336, 500, 750, 1000])
OVENS = (100.0, 125.0, 150.0)


@dataclass(frozen=True)
class Rubber:
    """Physical loss in a decade from .5 h, and scission: hours at 125 degC, J/mol."""

    loss: float = 0.03
    hours: float = 2500.0
    energy: float = 90e3
    exponent: float = 1.0

    def time(self, celsius):
        """Of the scission, h."""
        warmer = 1 / (celsius + 273.15) - 1 / 398.15
        return self.hours * np.exp(self.energy / R * warmer)

    def force_ratio(self, hours, celsius):
        """F/F0."""
        aged = ((hours - 0.5) / self.time(celsius)) ** self.exponent
        return (1 - self.loss * np.log10(hours / 0.5)) * np.exp(-aged)

    def life(self, celsius, part=0.5):
        """Hours until a part is left, by halving."""
        low, high = np.log(0.5), np.log(1e12)
        for _ in range(100):
            middle = (low + high) / 2
            above = self.force_ratio(np.exp(middle), celsius) > part
            low, high = (middle, high) if above else (low, middle)
        return float(np.exp(middle))


@dataclass(frozen=True)
class Lot:
    """Readings of every specimen: hours, N, oven temperature, degC, and its number."""

    hours: np.ndarray
    force: np.ndarray
    celsius: np.ndarray
    specimen_number: np.ndarray

    def text(self, head="time [h],force [N],temperature [degC],piece"):
        """As a file."""
        columns = zip(self.hours, self.force, self.celsius, self.specimen_number, strict=True)
        rows = (f"{a!r},{b!r},{c!r},{d}" for a, b, c, d in columns)
        return "\n".join([head, *map(_format_row, rows), ""])


def _format_row(row):
    return row.replace("np.float64(", "").replace(")", "")


def lot(
    rubber,
    seed=0,
    *,
    ovens=OVENS,
    specimens=3,
    hours=HOURS,
    off=1.0,
    noise=0.01,
    spread=0.03,
    zero=0.0,
):
    """Ovens that are `off` by N(0, K), F0 of 40 N with its `spread`, `noise` in parts of it.

    The zero of the cell drifts by so much of 40 N in 1000 h.
    """
    random, result = np.random.default_rng([seed, 3384]), []
    for number in range(specimens * len(ovens)):
        if number % specimens == 0:
            oven = ovens[number // specimens]
            warm = oven + off * random.standard_normal()
        first = 40 * (1 + spread * random.standard_normal())
        scatter = 40 * noise * random.standard_normal(len(hours))
        force = first * rubber.force_ratio(hours, warm) + scatter + 40 * zero * hours / 1000
        result.append((hours, force, np.full(len(hours), oven), np.full(len(hours), number + 1)))
    return Lot(*map(np.concatenate, zip(*result, strict=True)))
