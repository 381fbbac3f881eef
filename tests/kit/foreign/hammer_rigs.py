r"""Rigs of a hammer: a block on seals, struck by pulses, and what analyser and cable do to it.

`strike_block` is the sound rig: :math:`m\,\ddot x + n\,F(x) = f`, exact by the modes of its
equations, in blocks of their own as an FFT analyser keeps them. `Rig` says what is done: an
exponential window in every block, on force and response or the response alone; a force window; a
cable that adds :math:`k_c(1 + j\eta_c)` beside the seals; offsets, a coarse number format. A file
is text or UFF 58. SI units. Written without a look at dashpot.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi

import numpy as np
from scipy.signal import lfilter

from .kinds import simulate_response
from .rigs import table
from .truths import FAMILIES, Seal, draw_truth

_FINE = 4
"""Instants of the simulation to a sample."""
_CABLE_TAU = np.geomspace(1e-4, 1.0, 9)
"""Relaxation times, s, of the arms that stand for a cable's constant loss factor."""


@dataclass(frozen=True)
class Rig:
    """What is done to a hammer test.

    `window` is the time constant of an exponential window, s, 0 for none; with `on_force` the
    hammer carries it, too. `force_window`, s, after which the force is zero. `cable` is a stiffness
    over that of the seals at the resonance, with the loss factor `cable_loss`. `step` is that of
    the number format over the noise. `taps`, in samples, is the half-length of an anti-alias filter
    of linear phase at .8 of the Nyquist frequency, which rings before a pulse and after. `pulse` is
    the range of widths of the pulses, s. `digits` is how many significant digits of the response
    are written, 0 for all. `rattle` is a small part on the block that rings: its frequency over the
    sampling rate, and its damping ratio. `corner`, Hz, is that of the accelerometer's high-pass of
    first order, which the hammer does not have; below 0, of the hammer's.
    """

    window: float = 0.0
    on_force: bool = True
    force_window: float = 0.0
    cable: float = 0.0
    cable_loss: float = 0.5
    offset: float = 0.0
    step: float = 0.0
    rate: float = 2048.0
    length: float = 6.0
    pretrigger: float = 0.1
    hits: int = 5
    noise: float = 1.0
    taps: int = 0
    pulse: tuple[float, float] = (12e-3, 22e-3)
    digits: int = 0
    rattle: tuple[float, float] | None = None
    corner: float = 0.0


@dataclass(frozen=True, eq=False)
class HammerRecord:
    """Blocks of a hammer test on one clock, with what is true of it.

    `time` restarts nowhere: blocks follow one another with a gap, as hits that wait for a trigger.
    """

    name: str
    time: np.ndarray
    hammer: np.ndarray
    acceleration: np.ndarray
    truth: Mapping[str, object]

    def text(self, head: str = "") -> str:
        """As a file, every digit kept; `head` stands above."""
        return head + table(
            ("time [s]", self.time), ("hammer [N]", self.hammer),
            ("acceleration [m/s^2]", self.acceleration),
        )  # fmt: skip


def cable_arms(stiffness: float, loss: float, omega: float):
    """k_inf and arms of a solid with this stiffness and loss factor at omega, loss nearly constant.

    .. math:: K(s) = k_\\infty + \\sum k \\frac{s\\tau}{1 + s\\tau}
    """
    x = 1j * omega * _CABLE_TAU
    unit = (x / (1 + x)).sum()
    k = loss * stiffness / unit.imag
    return stiffness - k * unit.real, np.full(len(_CABLE_TAU), k)


def strike_block(
    seed: int, rig: Rig = Rig(), *, damping: float | None = None, seal: Seal | None = None
) -> HammerRecord:
    """Hits of a block on two seals: of those given, or of ones drawn by the seed."""
    random = np.random.default_rng([seed, *b"hammer rig"])
    seal = seal or Seal(draw_truth(FAMILIES[1 + seed % 5], seed))
    mass = seal.mass_at(random.uniform(8, 25), 2)
    there = 2 * pi * seal.peak(mass, 2)[0]
    spring, dashpot, k, tau = seal.solid.within(1e-6, 1e7)
    if damping is not None:
        # a seal of little loss: what dissipates is scaled, its stiffness at the peak kept
        whole = seal.stiffness(there)
        part = 2 * damping * whole.real / whole.imag
        x = 1j * there * np.asarray(tau)
        lost = float((np.asarray(k) * (x / (1 + x))).sum().real) * (1 - part)
        spring, dashpot, k = spring + lost, part * dashpot, part * np.asarray(k)
    neighbour = 2 * _stiffness(spring, dashpot, k, tau, there)
    k_cable, arms = cable_arms(rig.cable * neighbour.real, rig.cable_loss, there)
    force, clock = _pulses(random, rig)
    all_k = np.concatenate((2 * np.asarray(k), arms if rig.cable else []))
    all_tau = np.concatenate((np.asarray(tau), _CABLE_TAU if rig.cable else []))
    A = np.zeros((2 + len(all_k), 2 + len(all_k)))
    A[0, 1], A[2:, 1] = 1.0, 1.0
    A[1] = -1 / mass * np.array([
        2 * spring + (k_cable if rig.cable else 0.0), 2 * dashpot, *all_k
    ])  # fmt: skip
    A[2:, 2:] -= np.diag(1 / all_tau)
    b = np.zeros(len(A))
    b[1] = 1 / mass
    rows = []
    for block in force:
        pure = simulate_response((A, b, A[1], 1 / mass), block, 1 / rig.rate / _FINE)
        if rig.rattle:
            pure = pure + 0.01 * pure.max() * _ring(rig, clock, block)
        if rig.corner > 0:
            pure = pure - _pass_low(pure, rig.corner / rig.rate / _FINE)
        hammer = block
        if rig.corner < 0:
            hammer = block - _pass_low(block, -rig.corner / rig.rate / _FINE)
        rows.append(
            tuple(_filter_aliases(channel, rig.taps)[::_FINE] for channel in (hammer, pure))
        )
    time, hammer, acceleration = _analyse_blocks(random, rig, rows, clock[::_FINE])
    truth = {
        "seal": seal, "mass": mass, "seals": 2, "omega": there,
        "stiffness": _stiffness(spring, dashpot, k, tau, there), "rig": rig,
        "pole": _ringing_pole(mass, there, 2 * spring, 2 * dashpot, 2 * np.asarray(k), tau),
    }  # fmt: skip
    return HammerRecord(f"{seal.solid.name}, {seed}", time, hammer, acceleration, truth)


def _ring(rig: Rig, clock, block):
    """A decaying cosine from the peak of a pulse on."""
    frequency, ratio = rig.rattle
    omega, time = 2 * pi * frequency * rig.rate, clock - clock[block.argmax()]
    ring = np.exp(-ratio * omega * np.maximum(time, 0)) * np.cos(omega * time)
    return np.where(time >= 0, ring, 0.0)


def _pass_low(channel, corner: float):
    """A low-pass of first order; its corner over the sampling rate."""
    part = 1 - np.exp(-2 * pi * corner)
    return lfilter([part / 2, part / 2], [1, part - 1], channel)


def _filter_aliases(channel, taps: int):
    """A windowed sinc of linear phase, its delay taken off; as it is without taps."""
    if not taps:
        return channel
    place = np.arange(-taps * _FINE, taps * _FINE + 1)
    kernel = np.sinc(0.8 * place / _FINE) * np.hamming(len(place))
    return np.convolve(channel, kernel / kernel.sum(), "same")


def _stiffness(spring, dashpot, k, tau, omega):
    x = 1j * omega * np.asarray(tau)
    return complex(spring + 1j * omega * dashpot + (np.asarray(k) * x / (1 + x)).sum())


def _ringing_pole(mass, start, spring, dashpot, *arms):
    """Root of m s^2 + K(s) near j omega, by Newton."""
    s, (k, tau) = 1j * start, arms
    for _ in range(60):
        x = s * np.asarray(tau)
        value = mass * s**2 + spring + dashpot * s + (k * x / (1 + x)).sum()
        slope = 2 * mass * s + dashpot + (k * np.asarray(tau) / (1 + x) ** 2).sum()
        s = s - value / slope
    return complex(s)


def _pulses(random, rig: Rig):
    """The force of every block, and the clock of one."""
    clock = np.arange(round(rig.length * rig.rate * _FINE)) / rig.rate / _FINE
    force = []
    for _ in range(rig.hits):
        width, high = random.uniform(*rig.pulse), random.uniform(2.0, 5.0)
        start = rig.pretrigger + random.uniform(0.0, 0.02)
        force.append(high * np.sin(pi * np.clip((clock - start) / width, 0, 1)) ** 2)
    return force, clock


def _analyse_blocks(random, rig: Rig, rows, clock):
    """Noise, offsets, windows and number format of every block, one after the other."""
    fade = np.exp(-clock / rig.window) if rig.window else np.ones_like(clock)
    times, hammers, accelerations = [], [], []
    for i, (force, pure) in enumerate(rows):
        hammer = force + rig.noise * 5e-3 * random.standard_normal(len(clock))
        response = pure + rig.noise * 0.02 * random.standard_normal(len(clock)) + rig.offset
        if rig.force_window:
            hammer = np.where(clock < rig.pretrigger + rig.force_window, hammer, 0.0)
        hammer = hammer * fade if rig.on_force else hammer
        response = response * fade
        if rig.step:
            response = np.round(response / (0.02 * rig.step)) * 0.02 * rig.step
            hammer = np.round(hammer / (5e-3 * rig.step)) * 5e-3 * rig.step
        if rig.digits:
            response = np.array([float(f"{value:.{rig.digits}g}") for value in response])
        times.append(clock + i * (rig.length + 3.0))
        hammers.append(hammer)
        accelerations.append(response)
    return tuple(map(np.concatenate, (times, hammers, accelerations)))


# -- rigs by name ----------------------------------------------------------------------------------

KINDS: Mapping[str, str] = {
    "sound": "nothing is wrong",
    "window": "an exponential window of .2 to 2 s that nobody states",
    "window of the responses": "the same, and the force lacks it",
    "window stated": "the same, and the header says so",
    "window, coarse channels": "the same, rounded to .05 to 4 times the noise",
    "force window": "the force is zero .03 to .3 s after the trigger",
    "anti-alias filter": "250 to 320 Hz; a filter of linear phase rings before a pulse of 4 ms",
    "cable": "1 to 3 % of the stiffness of the seals, loss factor .5",
}
"""What is done to a hammer test, by name."""


def struck_rig(kind: str, seed: int) -> tuple[HammerRecord, str]:
    """A hammer test on a rig of a kind, drawn by a seed, and the header of its file."""
    random = np.random.default_rng([seed, *kind.encode()])
    changes: dict[str, object] = {
        "rate": float(random.choice([512, 1024, 2048])), "length": float(random.uniform(4, 8)),
        "noise": float(np.exp(random.uniform(np.log(0.1), np.log(3)))),
        "hits": int(random.integers(3, 8)), "pretrigger": float(random.uniform(0.05, 0.2)),
        "offset": float(random.choice([0.0, 0.2])),
    }  # fmt: skip
    if "window" in kind and kind != "force window":
        changes["window"] = float(np.exp(random.uniform(np.log(0.2), np.log(2.0))))
        changes["on_force"] = "responses" not in kind
    if "coarse" in kind:
        changes["step"] = float(np.exp(random.uniform(np.log(0.05), np.log(4.0))))
        changes["noise"] = 1.0
    if kind == "force window":
        changes["force_window"] = float(random.uniform(0.03, 0.3))
    if kind == "anti-alias filter":
        changes["rate"] = float(random.choice([250, 256, 300, 320]))
        changes["taps"], changes["pulse"] = int(random.integers(10, 40)), (3e-3, 6e-3)
    if kind == "cable":
        changes["cable"] = float(random.uniform(0.01, 0.03))
    record = strike_block(seed, Rig(**changes))
    stated = kind == "window stated"
    return record, f"# Exponential window: {changes['window']!r} s\n" if stated else ""


# -- FRFs as universal files -----------------------------------------------------------------------


def windowed_lines(record: HammerRecord):
    """Frequency and the ratio of the transforms of all blocks, H1, as an analyser writes them."""
    rig = record.truth["rig"]
    size = round(rig.length * rig.rate)
    force = np.fft.rfft(record.hammer.reshape(-1, size), axis=1)
    spectrum = np.fft.rfft(record.acceleration.reshape(-1, size), axis=1)
    frequency = np.fft.rfftfreq(size, 1 / rig.rate)
    power, cross = (np.abs(force) ** 2).sum(0), (spectrum * force.conj()).sum(0)
    power_a = (np.abs(spectrum) ** 2).sum(0)
    keep = (frequency >= 3) & (frequency <= 60)
    coherence = np.abs(cross) ** 2 / (power * power_a)
    return frequency[keep], (cross / power)[keep], np.minimum(coherence[keep], 1.0)


def uff_58(
    frequency, value, *, directions=(3, 3), factor: float | None = None, window: int = 4,
    exponent: str = "E", amplitude: bool = False, before: bool = False,
) -> str:  # fmt: skip
    """Dataset 58 of an FRF, and dataset 1858 behind or `before` it where a `factor` is said."""
    step = frequency[1] - frequency[0]
    response, reference = directions
    kind = 2 if amplitude else 5
    lines = ["    -1", "    58", *["NONE"] * 5]
    lines.append(f"{4:5d}{0:10d}{1:5d}{0:10d} {'NONE':10s}{1:10d}{response:4d} {'NONE':10s}"
                 f"{1:10d}{reference:4d}")  # fmt: skip
    lines.append(f"{kind:10d}{len(value):10d}{1:10d}{frequency[0]:13.5E}{step:13.5E}{0:13.5E}")
    for number, name, unit in (
        (18, "Frequency", "Hz"), (12, "Acceleration", "m/s^2"), (13, "Force", "N"),
        (0, "NONE", "NONE"),
    ):  # fmt: skip
        lines.append(f"{number:10d}{0:5d}{0:5d}{0:5d} {name:20s} {unit:20s}")
    cells = np.abs(value) if amplitude else np.column_stack((value.real, value.imag)).ravel()
    texts = [f"{cell:13.5E}".replace("E", exponent) for cell in cells]
    lines += ["".join(texts[i : i + 6]) for i in range(0, len(texts), 6)]
    lines.append("    -1")
    if factor is not None:
        zeros = "".join(f"{0.0:15.7E}" for _ in range(5))
        stated = ["    -1", "  1858", "".join(f"{n:12d}" for n in (1, 0, 1, 0, 0, 0)),
                  "".join(f"{n:6d}" for n in (0, window, *[0] * 10)), zeros,
                  "".join(f"{0.0:15.7E}" for _ in range(4)) + f"{factor:15.7E}", zeros,
                  "Z+    Z+", "NONE", "    -1"]  # fmt: skip
        lines = [*stated, *lines] if before else [*lines, *stated]
    return "\n".join(lines) + "\n"
