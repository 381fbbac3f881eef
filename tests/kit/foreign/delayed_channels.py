"""Records of two channels of which one comes late, each with its truth by formulas.

`delayed("creep", seed, late=.5, rate=50)` has its force half a sample behind its displacement;
a negative `late` has it before. What is late is the whole channel, noise and all, as of a converter
with a filter of its own. SI units but for the columns, which say theirs.
"""

from __future__ import annotations

from math import pi

import numpy as np
from scipy.linalg import expm

from .drop_tests import SPEEDS, drawn_specimen, impact_force
from .kinds import CYCLES, Sheet, _log_uniform, _start, simulate_response
from .truths import FAMILIES, Seal, Solid, draw_truth

RATES = (20.0, 50.0, 100.0, 200.0)
"""Samples a second."""
LATE = (0.5, -0.5, 1.0, -1.0)
"""Samples by which the force comes behind the displacement."""
_FINE = 8
"""Instants of a simulation to a row."""
_REST = 2.0
"""Before a record moves, s."""


def late_by(values: np.ndarray, samples: float, fine: int = _FINE) -> np.ndarray:
    """The rows of a fine signal, so many samples late; it rests before it begins and ends."""
    at = np.arange(0, len(values), fine) - samples * fine
    return np.interp(at, np.arange(len(values)), values)


def creep(seed: int, late: float, rate: float) -> Sheet:
    """A part under a load put on in .1 to 1 s: x = (F + sum k r)/k_0, tau dr/dt = x - r."""
    random = _start("late creep", seed)
    solid = draw_truth(FAMILIES[1 + seed % 5], seed)
    hold, load = _log_uniform(random, 30.0, 120.0), random.uniform(0.5, 2.0)
    ramp = _log_uniform(random, 0.1, 1.0)
    clock = np.arange(round((2 + hold) * rate * _FINE)) / rate / _FINE
    force = load * np.clip((clock - 2) / ramp, 0, 1)
    k, tau = np.array(solid.k), np.array(solid.tau)
    k_0 = solid.k_inf + k.sum()
    A = (np.ones((len(k), 1)) * k / k_0 - np.eye(len(k))) / tau[:, None]
    x = simulate_response((A, 1 / k_0 / tau, k / k_0, 1 / k_0), force, clock[1])
    shown, displacement = late_by(force, late), x[::_FINE]
    return Sheet("creep", f"{solid.name}, creep, {late:+g} at {rate:g} Hz", {
        "time [s]": clock[::_FINE],
        "displacement [mm]": 1e3 * (displacement + 1e-6 * random.standard_normal(len(shown))),
        "force [N]": shown + 1e-3 * random.standard_normal(len(shown)),
    }, {"solid": solid, "hold": hold, "ramp": ramp, "late": late / rate}, "late")  # fmt: skip


def over_displacement(solid: Solid, time: float) -> float:
    """1/J(t), N/m, by the matrix exponential of the arms' equations."""
    k, tau = np.array(solid.k), np.array(solid.tau)
    k_0 = solid.k_inf + k.sum()
    A = (np.ones((len(k), 1)) * k / k_0 - np.eye(len(k))) / tau[:, None]
    grown = np.linalg.solve(A, (expm(A * time) - np.eye(len(k))) @ (1 / k_0 / tau))
    return 1 / float(1 / k_0 + k / k_0 @ grown)


def loops(seed: int, late: float, rate: float) -> Sheet:
    """Harmonic loops of a seal and its sliders at rising amplitudes about a preload."""
    random = _start("late loops", seed)
    seal = Seal(draw_truth(FAMILIES[1 + seed % 5], seed), friction=float(random.uniform(0, 0.1)))
    hertz, sizes = rate / random.uniform(20, 100), np.array([1e-4, 3e-4, 1e-3, 2e-3])
    value = 10 / hertz
    clock = np.arange(round((20 + 4 * value) * rate * _FINE)) / rate / _FINE
    since = np.maximum(clock - 20, 0)
    size = sizes[np.minimum((since / value).astype(int), 3)]
    x = 4e-3 * np.clip(clock, 0, 1) + size * np.sin(2 * pi * hertz * since)
    shown = late_by(seal.force(x, clock[1]), late)
    rows = slice(round(20 * rate), None)
    time, displacement, shown = clock[::_FINE][rows], x[::_FINE][rows], shown[rows]
    return Sheet("loops", f"{seal.solid.name}, loops, {late:+g} at {rate:g} Hz", {
        "time [s]": time, "displacement [mm]": 1e3 * displacement,
        "force [N]": shown + 1e-3 * random.standard_normal(len(shown)),
    }, {"seal": seal, "sizes": sizes, "frequency": hertz, "late": late / rate},
        "late")  # fmt: skip


def cld(seed: int, late: float, rate: float) -> Sheet:
    """Six cycles after 2 s of rest; cycle n is softer by .12 (1 - e^-(n-1)/1.5) (Mullins).

    A cycle has 160 samples or more, and lasts up to 40 s. The truth is the reported cycle,
    without noise: its forces at .6 of the depth, and its work.
    """
    random = _start("late cld", seed)
    depth, lasts = 6e-3, _log_uniform(random, max(160 / rate, 1.0), 40.0)
    solid = draw_truth(FAMILIES[1 + seed % 5], seed)
    seal = Seal(solid, depth, c=random.uniform(0, 0.4))
    air, speed = 0.5e-3, 2 * (depth + 0.5e-3) / lasts
    travel = depth + air
    lasts = round(lasts * rate * _FINE) / rate / _FINE
    clock = np.arange(round((_REST + CYCLES * lasts) * rate * _FINE) + 1) / rate / _FINE
    turn = 2 * np.maximum(clock - _REST, 0) / lasts
    plate = travel * (1 - np.abs(1 - turn % 2))
    x = np.maximum(plate - air, 0.0)
    softer = 1 - 0.12 * -np.expm1(-np.floor(turn / 2) / 1.5)
    # a face that recovers more slowly than the plate leaves it bears no force
    pure = np.maximum(solid.force(softer * seal.elastic(x), clock[1]), 0.0)
    shown = late_by(pure, late)
    return Sheet("cld", f"{solid.name}, CLD, {late:+g} at {rate:g} Hz", {
        "time [s]": clock[::_FINE], "displacement [mm]": 1e3 * plate[::_FINE],
        "force [N]": shown + 2e-3 * random.standard_normal(len(shown)),
    }, {"seal": seal, "speed": speed, "lasts": lasts, "air": air, "plate": plate, "pure": pure,
        "many": round(lasts * rate * _FINE), "first": round(_REST * rate * _FINE),
        "late": late / rate}, "late")  # fmt: skip


def cycle_of(sheet: Sheet, number: int) -> tuple[np.ndarray, np.ndarray, int]:
    """Compression and force of a CLD's cycle, from 1, without delay, and its deepest sample."""
    plate, pure = sheet.truth["plate"], sheet.truth["pure"]
    first, many = sheet.truth["first"], sheet.truth["many"]
    rows = slice(first + (number - 1) * many, first + number * many + 1)
    x = plate[rows] - sheet.truth["air"]
    return x, pure[rows], int(np.argmax(x))


def drop(seed: int, late: float, rate: float) -> Sheet:
    """Three impacts on a specimen: force and acceleration of the mass, 60 samples a contact.

    The rate counts in units of 20 Hz where a contact of 3 s would have 60 samples: what matters is
    the delay in samples.
    """
    random = _start("late slam", seed)
    specimen = drawn_specimen(seed)
    runs = [impact_force(specimen, speed) for speed in SPEEDS]
    step = min(float(clock[-1]) for clock, _ in runs) / (60 * rate / RATES[0])
    time, force = [], []
    begun = 0.0
    for clock, pure in runs:
        lasts = 20 * float(clock[-1])
        fine = np.arange(0, lasts, step / _FINE)
        time.append(begun + fine)
        force.append(np.interp(fine - 2 * clock[-1], clock, pure, left=0.0, right=0.0))
        begun += lasts
    clock = np.arange(0, begun, step / _FINE)
    pure = np.interp(clock, np.concatenate(time), np.concatenate(force))
    noise = 0.01 * pure.max()
    shown, acceleration = late_by(pure, late), pure[::_FINE] / specimen.mass
    return Sheet("slam", f"impacts, {late:+g} of {step:.3g} s", {
        "time [s]": clock[::_FINE],
        "force [N]": shown + noise * random.standard_normal(len(shown)),
        "acceleration [m/s^2]": acceleration
        + noise / specimen.mass * random.standard_normal(len(shown)),
    }, {"specimen": specimen, "late": late * step}, "late")  # fmt: skip


DELAYED = {"creep": creep, "loops": loops, "cld": cld, "slam": drop}


def make_delayed_sheet(
    kind: str, seed: int, late: float | None = None, rate: float | None = None
) -> Sheet:
    """One record of a kind; by turns of its seed each delay at each rate where none is said."""
    turn, rest = seed % len(LATE), seed // len(LATE) % len(RATES)
    return DELAYED[kind](
        seed, LATE[turn] if late is None else late, RATES[rest] if rate is None else rate
    )
