"""Foreign parts and rigs: closed forms that share nothing with the package."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]
COMPRESSIONS, AMPLITUDES = (4.0, 5.0, 6.5, 8.0), (0.05, 0.1, 0.2, 0.5)
"""mm."""
FREQUENCY = np.geomspace(1.0, 50.0, 16)
PAPER = ((196.5, 117.5, 17.8), (59.0 / 117.5, 292.2 / 17.8))
"""Stiffnesses, N/m, and relaxation times, s, of the paper's Table 1."""
_CUBIC = (0.1965 - 0.15) / 8.0**2


def cubic_seal(frequency: npt.ArrayLike, compression: float) -> Complex:
    """The paper's seal with the force .15 x + b x^3 N that is .1965 N/mm at 8 mm, N/m."""
    (k_inf, *k), tau = PAPER
    w = 2j * np.pi * np.asarray(frequency, dtype=float)
    solid = k_inf + sum(a * w * t / (1 + w * t) for a, t in zip(k, tau, strict=True))
    return np.asarray((0.15 + 3 * _CUBIC * compression**2) / 0.1965 * solid)


class Part(NamedTuple):
    """A part of a fractional solid, a law of its own, and friction; and how it is not separable.

    `broken` is a pair: an exponent that moves with compression, an amplitude of half loss that
    moves with frequency, a share of friction that moves with compression.
    """

    linear: float
    bend: float
    exponential: bool
    order: float
    tau: float
    rise: float
    lost: float
    half: float
    exponent: float
    broken: str
    by: float

    def stiffness(self, frequency: npt.ArrayLike, compression: float, amplitude: float) -> Complex:
        """Complex stiffness, N/m, at a compression and an amplitude, mm."""
        f, c = np.asarray(frequency, dtype=float), compression
        law = (
            self.linear * np.exp(c / (6 + self.bend))
            if self.exponential
            else self.linear + self.bend * c**2
        )
        aside = self.by * (c - 6) / 2
        order = self.order * (1 + aside * (self.broken == "compression and frequency"))
        w = (2j * np.pi * f * self.tau) ** order
        u = amplitude / self.half * np.ones(len(f))
        if self.broken == "amplitude and frequency":
            u = u * (f / 7) ** self.by
        d = self.lost * (1 + aside * (self.broken == "compression and amplitude"))
        friction = 1 - d * (1 - 1 / (1 + u ** (2 * self.exponent)))
        lag = d * self.exponent / np.pi * 2 * u**self.exponent / (1 + u ** (2 * self.exponent))
        return np.asarray(law * (1 + self.rise * w / (1 + w)) * (friction + 1j * lag))

    @property
    def departure(self) -> tuple[float, float]:
        """How far ln|K| and the angle are from separable over the levels: by means of a layout."""
        K = np.array([
            [self.stiffness(FREQUENCY, c, X) for X in AMPLITUDES] for c in COMPRESSIONS
        ])  # fmt: skip
        size, angle = np.log(np.abs(K)), np.angle(K)
        additive = (
            size.mean((1, 2), keepdims=True)
            + size.mean((0, 2), keepdims=True)
            + size.mean((0, 1), keepdims=True)
            - 2 * size.mean()
        )
        turned = angle.mean((0, 2), keepdims=True) + angle.mean((0, 1), keepdims=True)
        return (
            float(np.abs(size - additive).max()),
            float(np.abs(angle - turned + angle.mean()).max()),
        )


def draw_part(r: np.random.Generator, broken: str = "", by: float = 0.0) -> Part:
    return Part(
        r.uniform(100, 300), r.uniform(1, 4), bool(r.integers(2)), r.uniform(0.3, 0.7),
        10 ** r.uniform(-3, -1), r.uniform(0.4, 2), r.uniform(0.05, 0.5),
        10 ** r.uniform(-1.3, -0.3), r.uniform(0.3, 0.7), broken, by,
    )  # fmt: skip


class Line(NamedTuple):
    """A measured sweep: compression and amplitude, mm, and stiffness, N/m."""

    compression: float
    amplitude: float
    value: Complex


def measure(
    part: Part, r: np.random.Generator, *, repeats: int = 1, common: bool = True
) -> list[Line]:
    """Every setting on a rig with a gain, a phase, noise of lines, and scatter of repeats."""
    noise = 10 ** r.uniform(-3, -2)
    gain, phase = 0.01 * r.standard_normal(), np.radians(r.standard_normal())
    n, lines = len(FREQUENCY), []
    for c in COMPRESSIONS:
        for X in AMPLITUDES:
            for _ in range(repeats):
                error = noise * (r.standard_normal(n) + 0.5j * r.standard_normal(n))
                error = error + (gain + 1j * phase) * common
                if repeats > 1:
                    error = error + 2e-3 * r.standard_normal()
                lines.append(Line(c, X, part.stiffness(FREQUENCY, c, X) * np.exp(error)))
    return lines


def table(lines: list[Line]) -> str:
    """The text of a file of them."""
    head = "compression [mm],amplitude [mm],frequency [Hz],storage [N/mm],loss [N/mm]"
    rows = [
        f"{line.compression:g},{line.amplitude:g},{f:.6f},{K.real / 1e3:.9g},{K.imag / 1e3:.9g}"
        for line in lines
        for f, K in zip(FREQUENCY, line.value, strict=True)
    ]
    return "\n".join([head, *rows, ""])


LOOP_FREQUENCIES, LOOP_CYCLES, LOOP_RATE = (1.0, 2.0, 4.0, 7.0, 12.0, 20.0), 8, 1000.0
"""Hz; cycles of each setting; Hz."""


def loop_record(
    part: Part,
    compression: float,
    r: np.random.Generator,
    *,
    amplitudes: tuple[float, ...] = AMPLITUDES,
    frequencies: tuple[float, ...] = LOOP_FREQUENCIES,
    noise: float = 2e-4,
) -> str:
    """The text of a record at one compression: sines of each frequency and amplitude.

    The force is the steady one of the part about that of the compression; both channels have a
    noise of that share of the largest amplitude and of the largest force.
    """
    displacements, forces = [], []
    static = part.linear * compression * 1e-3
    for f in frequencies:
        for X in amplitudes:
            phase = 2 * np.pi * np.arange(round(LOOP_CYCLES * LOOP_RATE / f)) * f / LOOP_RATE
            K = complex(part.stiffness([f], compression, X)[0])
            displacements.append(compression + X * np.sin(phase))
            forces.append(static + 1e-3 * X * (K.real * np.sin(phase) + K.imag * np.cos(phase)))
    x, force = np.concatenate(displacements), np.concatenate(forces)
    swing = float(np.abs(force - static).max())
    x = x + noise * max(amplitudes) * r.standard_normal(len(x))
    force = force + noise * swing * r.standard_normal(len(x))
    samples = enumerate(zip(x, force, strict=True))
    rows = [f"{i / LOOP_RATE:.3f},{a:.6f},{b:.7f}" for i, (a, b) in samples]
    return "\n".join(["time [s],displacement [mm],force [N]", *rows, ""])
