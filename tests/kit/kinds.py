"""One small file of each kind that a lab brings, and what it is."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
ARMS = ((120.0, 0.5), (18.0, 16.0))
STIFFNESS = 200.0
MASS, LOSS = 0.104, 6.0


def answer(time: Array, x: Array) -> Array:
    """Force of a spring and two arms under a displacement that is straight between samples, N."""
    force = STIFFNESS * x
    for k, tau in ARMS:
        arm = np.zeros_like(time)
        for i in range(1, len(time)):
            h = time[i] - time[i - 1]
            decay = np.exp(-h / tau)
            arm[i] = arm[i - 1] * decay + k * tau * (x[i] - x[i - 1]) / h * (1 - decay)
        force = force + arm
    return force


def csv(head: str, *columns: Array) -> str:
    """The text of a table."""
    rows = "\n".join(",".join(f"{v:.8g}" for v in row) for row in zip(*columns, strict=True))
    return f"{head}\n{rows}\n"


def save_table(path: Path, head: str, *columns: Array) -> Path:
    """The file of a table, to the last digit."""
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=head, comments="")
    return path


BENCH = "time [s],displacement [mm],force [N]"
CLOCK = np.arange(0, 20, 0.04)


def bench(x: Array, *, time: Array = CLOCK, head: str = BENCH, seed: int = 1) -> str:
    """A bench's file: the compression `x`, m, and what the seal answers."""
    noise = 2e-4 * np.random.default_rng(seed).standard_normal(len(time))
    return csv(head, time, 1e3 * x, answer(time, x) + noise)


def ramp_and_hold(time: Array = CLOCK) -> Array:
    """8 mm in a second, from 1 s."""
    return 8e-3 * np.clip(time - 1, 0, 1)


def late(settling: float) -> str:
    """A record that begins 0.2 s after its ramp, while the plate settles by so much, m."""
    time = np.arange(0, 22, 0.04)
    force = answer(time, ramp_and_hold(time))[55:]
    since = time[55:] - time[55]
    x = 8e-3 - settling * np.exp(-since / 0.05)
    scatter = np.random.default_rng(2).standard_normal((2, len(x)))
    return csv(BENCH, since, 1e3 * x + 1e-4 * scatter[0], force + 2e-4 * scatter[1])


def _creep() -> str:
    since = CLOCK - 1
    risen = np.clip(since, 0, 1)
    x = np.where(since > 0, 8e-3 * risen * (0.6 + 0.2 * (1 - np.exp(-since / 5))), 0.0)
    noise = 2e-4 * np.random.default_rng(3).standard_normal(len(x))
    return csv(BENCH, CLOCK, 1e3 * x, 1.6 * risen + noise)


def response() -> tuple[Array, npt.NDArray[np.complex128]]:
    """Lines, Hz, and the accelerance of the mass on a spring and a dashpot, 1/kg."""
    lines = np.arange(2.0, 40.0, 0.1)
    omega = 2 * np.pi * lines
    return lines, -(omega**2) / (640 - MASS * omega**2 + 1j * omega * LOSS)


def hammer(columns: str = "hammer [N],acceleration 1 [m/s^2],acceleration 2 [m/s^2]") -> str:
    """Three hits of a mass on a spring and a dashpot."""
    rate, count = 1000.0, 6000
    time = np.arange(count) / rate
    force = np.zeros(count)
    pulse = 20 * np.sin(np.pi * (np.arange(6) + 0.5) / 6)
    pole = (-LOSS + np.sqrt(complex(LOSS**2 - 4 * MASS * 640))) / (2 * MASS)
    displacement = np.zeros(count)
    ringing = np.imag(np.exp(pole * time)) / (MASS * pole.imag) / rate
    for start in (200, 2200, 4200):
        force[start : start + 6] = pulse
        for k, push in enumerate(pulse):
            displacement[start + k :] += push * ringing[: count - start - k]
    acceleration = np.gradient(np.gradient(displacement, 1 / rate), 1 / rate)
    noise = 0.01 * np.random.default_rng(4).standard_normal((2, count))
    return csv(f"time [s],{columns}", time, force, *(acceleration + noise))


def _sweep(frequency: Array, *, head: str, besides: tuple[Array, ...] = ()) -> str:
    omega = 2 * np.pi * frequency
    value = 0.2 + sum(
        k / 1e3 * 1j * omega * tau / (1 + 1j * omega * tau) for k, tau in ((120, 0.5), (40, 0.01))
    )
    return csv(head, frequency, *besides, value.real, value.imag)


def files() -> dict[str, tuple[str, str]]:
    """Text and kind by name of file."""
    moduli = "storage modulus [MPa],loss modulus [MPa]"
    lines, value = response()
    frf = "frequency [Hz],real [{0}],imaginary [{0}],coherence"
    ones = np.ones(25)
    spread = np.geomspace(0.1, 50, 25)
    long = np.geomspace(1e-6, 1e6, 60)
    flown = np.arange(0, 9, 0.02)
    decay = np.geomspace(0.01, 1e3, 40)
    triangle = 8e-3 * np.interp(CLOCK, [0, 10, 20], [0, 1, 0])
    waves = 4e-3 * (1 - np.cos(np.pi * CLOCK))
    return {
        "seal.csv": (bench(ramp_and_hold()), "relaxation"),
        "creep.csv": (_creep(), "creep"),
        "compliance.csv": (
            csv("time [s],Creep Compliance [1/MPa]", decay, (1 + decay) ** 0.4), "creep",
        ),
        "trios.txt": ("Procedure name: Creep\n" + bench(1e-4 * CLOCK), "creep"),
        "triangle.csv": (bench(triangle), "cld"),
        "unclocked.csv": (
            csv("displacement [mm],force [N]", 1e3 * triangle, answer(CLOCK, triangle)), "cld",
        ),
        "fatigue.csv": (bench(waves), "cyclic"),
        "hammer.csv": (hammer(), "impact"),
        "ball.csv": (
            csv("time [ms],velocity [m/s]", flown, np.cos(np.clip(flown - 3, 0, np.pi))),
            "indentation",
        ),
        "squeezed.csv": (
            csv("time [h],force [N],temperature [degC]", decay[20:], 40 - 0.3 * decay[20:] ** 0.3,
                398 - 273 + 0 * decay[20:]), "csr",
        ),
        "slam.csv": (
            csv("time [ms],slam force [N]", flown, np.maximum(np.sin(flown - 2), 0) * (flown < 6)),
            "drop",
        ),
        "tension.csv": (
            csv("strain [%],stress [MPa]", 2 * spread, 0.02 * spread), "stress-strain",
        ),
        "frf.csv": (
            csv(frf.format("(m/s^2)/N"), lines, value.real, value.imag, 1 + 0 * lines), "frf",
        ),
        "polar.csv": (
            csv("f [Hz],magnitude [g/N],phase [deg]", lines, abs(value) / 9.80665,
                np.degrees(np.angle(value))), "frf",
        ),
        "base.csv": (
            csv(frf.format("g/g"), lines, value.real, value.imag, 1 + 0 * lines),
            "transmissibility",
        ),
        "dma.csv": (
            _sweep(spread, head=f"frequency [Hz],omega [rad/s],{moduli}",
                   besides=(2 * np.pi * spread,)), "dma",
        ),
        "preloads.csv": (
            csv("compression [mm],frequency [Hz],storage [N/mm],loss [N/mm]",
                np.repeat((4.0, 6.0, 8.0), len(spread)), np.tile(spread, 3),
                np.repeat((0.31, 0.39, 0.49), len(spread)),
                np.repeat((0.031, 0.039, 0.049), len(spread))), "preload-map",
        ),
        "strain.csv": (
            _sweep(ones, head=f"frequency [Hz],strain [%],{moduli}", besides=(spread,)),
            "strain-sweep",
        ),
        "warming.csv": (
            _sweep(ones, head=f"frequency [Hz],temperature [degC],{moduli}",
                   besides=(np.linspace(-40, 60, 25),)), "temperature-sweep",
        ),
        "waiting.csv": (_sweep(ones, head=f"frequency [Hz],{moduli}"), "single-frequency"),
        "master.csv": (_sweep(long, head=f"frequency [Hz],{moduli}"), "master-curve"),
        "line.csv": (csv("x [mm],y [mm],z [mm]", spread, 2 * spread, 0 * spread), "seal-line"),
        "shapes.csv": (
            csv("mode,frequency [Hz],x [mm],y [mm],z [mm],uz", ones, 12 * ones, spread, spread,
                0 * spread, spread), "free-modes",
        ),
        "modulus.csv": (
            csv("time [s],Relaxation modulus [MPa]", decay, 0.2 + (1 + decay) ** -0.4), "modulus",
        ),
    }  # fmt: skip
