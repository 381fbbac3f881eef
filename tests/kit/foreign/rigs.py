r"""What a machine does to a sound record: each fault is a step from record to record.

A seal is pressed by an ideal machine (`press_seal`) on a clock of at least 2 kHz; steps of the
machine change the motion of the seal and its force with it, steps of the chain lag or filter its
signal; `sample_record` takes the record's rows; steps of the reading add what an amplifier and an
encoder add.
`RIGS` are the 40 that verdicts are judged on: `read(seal, protocol, RIGS["drift .5 mN/s"])`. Every
record keeps the seal's own compression and force, and what was done to it. SI units.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from types import MappingProxyType
from zlib import crc32

import numpy as np
from scipy import signal

from .truths import Seal

_FINE = 2000.0
"""Hz, at least, of the clock that seals are pressed on."""


@dataclass(frozen=True)
class Protocol:
    """How the plate is sent: `depth` in `ramp`, from `baseline` on, then held; s, m, Hz.

    The speed rises and falls in `rounding` of the ramp each. With `setpoints`, s, the way is sent
    in steps; with `servo`, its natural frequency and damping, an axis of second order follows it.
    The plate meets the seal after `gap`.
    """

    depth: float = 8e-3
    ramp: float = 1.0
    hold: float = 40.0
    baseline: float = 1.0
    rate: float = 1000.0
    rounding: float = 0.1
    setpoints: float = 0.0
    servo: tuple[float, float] | None = None
    gap: float = 0.0

    def plate(self):
        """The clock, and where the plate is."""
        rate = self.rate * np.ceil(_FINE / self.rate)
        clock = np.arange(round((self.baseline + self.ramp + self.hold) * rate) + 1) / rate
        since = clock - self.baseline
        if self.setpoints:
            since = self.setpoints * (np.floor(since / self.setpoints + 1e-9) + 1) * (since > 0)
        rise, whole = self.rounding * self.ramp, (1 - self.rounding) * self.ramp
        x = np.clip(since / self.ramp, 0.0, 1.0)
        if rise:
            ends = ((0.0, 1), (rise, -1), (whole, -1), (self.ramp, 1))
            x = sum(sign * np.maximum(since - end, 0) ** 2 for end, sign in ends) / rise / whole / 2
            x[since >= self.ramp] = 1.0
        if self.servo is not None:
            omega, damping = 2 * np.pi * self.servo[0], self.servo[1]
            x = _filter_signal([omega**2], [1, 2 * damping * omega, omega**2], x, 1 / rate)
        return clock, (self.depth + self.gap) * x


@dataclass(frozen=True, eq=False)
class Record:
    """A relaxation test, and what is true of it.

    `time`, `displacement`, `force` are as read, `compression` and `pure` the seal's own at the same
    instants; `told` is what the lab would state of its machine, `done` every step with its numbers.
    """

    name: str
    seal: Seal
    protocol: Protocol
    time: np.ndarray
    displacement: np.ndarray
    force: np.ndarray
    compression: np.ndarray
    pure: np.ndarray
    machine_options: Mapping[str, float] = field(default_factory=dict)
    done: tuple[tuple[str, Mapping[str, float]], ...] = ()

    @property
    def step(self) -> float:
        """Of the clock that the seal is pressed on, s."""
        return float(self.time[1] - self.time[0])

    @property
    def ramp_end(self) -> float:
        """s, on the clock of the record before any fault of the clock."""
        return self.protocol.baseline + self.protocol.ramp

    def k(self, times: float = 1.0) -> float:
        """The secant k(T) at so many times the hold T of the protocol, N/m; at infinity k_inf.

        What says its own T is held to `seal.secant` there: a rounded ramp ends where one says.
        """
        return float(self.seal.secant(times * self.protocol.hold))

    def rows(self, chosen) -> Record:
        """Only some rows."""
        names = ("time", "displacement", "force", "compression", "pure")
        return replace(self, **{name: getattr(self, name)[chosen] for name in names})

    def text(self) -> str:
        """The record as a file, every digit kept."""
        return table(
            ("time [s]", self.time), ("displacement [mm]", 1e3 * self.displacement),
            ("force [N]", self.force),
        )  # fmt: skip


def table(*columns) -> str:
    """Names and columns as text."""
    cells = [map(repr, np.asarray(column, float).tolist()) for _, column in columns]
    lines = [",".join(name for name, _ in columns), *map(",".join, zip(*cells, strict=True))]
    return "\n".join(lines) + "\n"


def press_seal(seal: Seal, protocol: Protocol, *, name: str = "") -> Record:
    """An ideal machine and ideal readings, on the clock of the press."""
    clock, plate = protocol.plate()
    x = np.maximum(plate - protocol.gap, 0.0)
    force = seal.force(x, clock[1])
    return Record(name, seal, protocol, clock, plate, force, x, force)


def _filter_signal(numerator, denominator, values, step: float):
    """What a linear filter makes of a signal that is straight between instants, from rest."""
    top, bottom, _ = signal.cont2discrete((numerator, denominator), step, method="foh")
    start = signal.lfilter_zi(top[0], bottom) * values[0]
    return signal.lfilter(top[0], bottom, values, zi=start)[0]


# -- the machine -----------------------------------------------------------------------------------


def _press_again(record: Record, x, plate=None) -> Record:
    """The seal is compressed otherwise; the encoder reads the plate."""
    force = record.seal.force(x, record.step)
    shown = record.displacement if plate is None else plate
    return replace(record, displacement=shown, compression=x, pure=force, force=force)


def gives(record: Record, random, *, compliance: float) -> Record:
    """Machine and cell give by C F, m/N: x = x_encoder - C F, a fixed point."""
    free, item = record.compression, record
    for _ in range(60):
        last, item = item, _press_again(record, np.maximum(free - compliance * item.pure, 0.0))
        if np.max(np.abs(item.compression - last.compression)) < 1e-13 * record.protocol.depth:
            return item
    msg = f"a compliance of {compliance:g} m/N is too large for this seal"
    raise ValueError(msg)


def creeps(record: Record, random, *, by: float, seen: bool = False) -> Record:
    """The crosshead settles by `by` ln(1 + (t - t_r)/ramp), m; the encoder may see it."""
    late = np.maximum(record.time - record.ramp_end, 0.0) / record.protocol.ramp
    extra = by * np.log1p(late)
    shown = record.displacement + extra if seen else None
    return _press_again(record, record.compression + extra, shown)


def warms(record: Record, random, *, decades: float) -> Record:
    """The seal warms evenly: its times fall by so many decades over the record.

    Pressed on the reduced clock dr = dt/a_T, in even steps of it.
    """
    time, rate = record.time, decades * np.log(10) / record.time[-1]
    reduced = np.expm1(rate * time) / rate
    even = np.linspace(0.0, reduced[-1], len(time))
    x = np.interp(np.log1p(rate * even) / rate, time, record.compression)
    force = np.interp(reduced, even, record.seal.force(x, even[1]))
    return replace(record, pure=force, force=force)


# -- the chain -------------------------------------------------------------------------------------


def late(record: Record, random, *, by: float) -> Record:
    """The force comes `by` s after the motion."""
    return replace(record, force=np.interp(record.time - by, record.time, record.force))


def low_pass(record: Record, random, *, cut: float, order: int = 1, kind: str = "butter") -> Record:
    """An analog filter of the force, Hz: Butterworth (of order 1: one pole) or Bessel."""
    words = {"norm": "mag"} if kind == "bessel" else {}
    top, bottom = getattr(signal, kind)(order, 2 * np.pi * cut, analog=True, **words)
    return replace(record, force=_filter_signal(top, bottom, record.force, record.step))


def sample_record(record: Record, random, *, lost: float = 0.0, jitter: float = 0.0) -> Record:
    """The rows at the rate of the record; `lost` of them dropped, `jitter` of a step early or late.

    The clock tells the truth.
    """
    fine = round(1 / record.step / record.protocol.rate)
    rows = np.arange(0, len(record.time), fine)
    if jitter:
        offset = np.round(fine * jitter * random.uniform(-1, 1, len(rows))).astype(int)
        rows = np.clip(rows + offset, 0, len(record.time) - 1)
    return record.rows(rows[random.uniform(size=len(rows)) >= lost] if lost else rows)


# -- the reading -----------------------------------------------------------------------------------


def _add_force(record: Record, what) -> Record:
    return replace(record, force=record.force + what)


def noisy(record: Record, random, *, sd: float, tau: float = 0.0) -> Record:
    """Gaussian noise of the force, N: white, or of first order with `tau`, s."""
    white = sd * random.standard_normal(len(record.time))
    if not tau:
        return _add_force(record, white)
    keep = np.exp(-1 / (record.protocol.rate * tau))
    white[1:] *= np.sqrt(1 - keep**2)
    return _add_force(record, signal.lfilter([1.0], [1.0, -keep], white))


def hums(
    record: Record, random, *, size: float, hertz: float = 50.02, overtones: int = 0
) -> Record:
    """The mains, N: a line and its odd overtones, each a third of the one before."""
    lines = 2 * np.arange(overtones + 1) + 1
    phase = random.uniform(0, 2 * np.pi, len(lines))
    return _add_force(record, sum(
        size / 3**i * np.sin(2 * np.pi * hertz * n * record.time + phase[i])
        for i, n in enumerate(lines)
    ))  # fmt: skip


def drifts(record: Record, random, *, rate: float) -> Record:
    """The load cell drifts, N/s."""
    return _add_force(record, rate * record.time)


def wanders(record: Record, random, *, by: float) -> Record:
    """The load cell walks at random, N after a minute."""
    steps = random.standard_normal(len(record.time)) * by / np.sqrt(60 * record.protocol.rate)
    return _add_force(record, np.cumsum(steps))


def waves(record: Record, random, *, size: float, period: float) -> Record:
    """The hall's heating swings the load cell, N."""
    turn = 2 * np.pi * record.time / period + random.uniform(0, 2 * np.pi)
    return _add_force(record, size * np.sin(turn))


def begins_late(record: Record, random) -> Record:
    """There is no baseline: the first row is that of contact."""
    return record.rows(record.time >= record.protocol.baseline)


def thin_rows(record: Record, random, *, rows: int) -> Record:
    """A logger that keeps rows even in ln(t) from the start of the ramp on."""
    start = int(np.searchsorted(record.time, record.protocol.baseline))
    mask = start + np.unique(np.geomspace(1, len(record.time) - start, rows).astype(int)) - 1
    return record.rows(np.concatenate((np.arange(0, start, max(start // 20, 1)), mask)))


def clock_jumps(record: Record, random, *, by: float) -> Record:
    """The clock leaps in mid-hold, s."""
    middle = record.ramp_end + record.protocol.hold / 2
    return replace(record, time=record.time + by * (record.time > middle))


# -- whole rigs ------------------------------------------------------------------------------------

Step = Callable[[Record, np.random.Generator], Record]


@dataclass(frozen=True)
class Rig:
    """Steps before the rows are taken and after; what every reading has; and what the lab says.

    `noise`, `count`, `bias` of the force, N; `encoder`, m; `friction` as a part of k_inf times the
    depth; `protocol` and `seal` are changes to those.
    """

    machine: tuple[Step, ...] = ()
    reading: tuple[Step, ...] = ()
    rows: Step = sample_record
    noise: float = 2e-3
    count: float = 1 / 1280
    bias: float = 0.05
    encoder: float = 1e-6
    protocol: Mapping[str, object] = field(default_factory=dict)
    seal: Mapping[str, float] = field(default_factory=dict)
    friction: float = 0.0
    machine_options: Mapping[str, float] = field(default_factory=dict)


FAULTLESS = Rig()
_MAINS = (50.01, 49.97, 60.02)
"""Hz."""
_C = 1 - 150.0 / 196.5
"""Of F_e = .15 x + 7.2656e-4 x^3 N (x in mm): tangent 1.473 times the secant at 8 mm."""


def _machine(*steps: Step, **changes) -> Rig:
    return Rig(machine=steps, **changes)


def _reading(*steps: Step, **changes) -> Rig:
    return Rig(reading=steps, **changes)


RIGS: Mapping[str, Rig] = MappingProxyType({
    "none": FAULTLESS,
    "white 10 mN": Rig(noise=10e-3),
    "AR noise 20 ms": _reading(partial(noisy, sd=5e-3, tau=0.02)),
    "AR noise .5 s": _reading(partial(noisy, sd=5e-3, tau=0.5)),
    "hum 50 Hz": _reading(partial(hums, size=5e-3)),
    "hum 60 Hz, overtones": _reading(partial(hums, size=5e-3, hertz=59.98, overtones=3)),
    "skew .5 ms, 1 kHz": _machine(partial(late, by=5e-4), protocol={"rate": 1000.0}),
    "skew 2 ms": _machine(partial(late, by=2e-3)),
    "skew 5 ms, 1 kHz": _machine(partial(late, by=5e-3), protocol={"rate": 1000.0}),
    "filter 10 Hz": _machine(partial(low_pass, cut=10.0)),
    "filter 20 Hz Butterworth": _machine(partial(low_pass, cut=20.0, order=2)),
    "filter 40 Hz Bessel": _machine(partial(low_pass, cut=40.0, order=4, kind="bessel")),
    "encoder 2 um": Rig(encoder=2e-6),
    "encoder 20 um": Rig(encoder=20e-6),
    "encoder 60 um": Rig(encoder=60e-6),
    "force quantum 10 mN": Rig(count=10e-3),
    "drift .2 mN/s": _reading(partial(drifts, rate=2e-4)),
    "drift .5 mN/s": _reading(partial(drifts, rate=5e-4)),
    "drift -.5 mN/s": _reading(partial(drifts, rate=-5e-4)),
    "drift wanders": _reading(partial(wanders, by=5e-3)),
    "drift .5 mN/s, baseline 10 s": _reading(
        partial(drifts, rate=5e-4), protocol={"baseline": 10.0}
    ),
    "thermal wave": _reading(partial(waves, size=20e-3, period=600.0)),
    "compliance 50 um/N": _machine(partial(gives, compliance=50e-6)),
    "compliance 50 um/N, named": _machine(
        partial(gives, compliance=50e-6), machine_options={"compliance": 50e-6}
    ),
    "crosshead creep 20 um": _machine(partial(creeps, by=20e-6)),
    "crosshead creep 20 um, recorded": _machine(partial(creeps, by=20e-6, seen=True)),
    "seal warms .12 decade": _machine(partial(warms, decades=0.12)),
    "overshoot": Rig(protocol={"servo": (4.0, 0.5)}),
    "jerky 20 ms": Rig(protocol={"setpoints": 0.02, "servo": (25.0, 0.5)}),
    "air gap .5 mm": Rig(protocol={"gap": 0.5e-3}),
    "no baseline": _reading(begins_late),
    "dropped rows and jitter": Rig(rows=partial(sample_record, lost=0.1, jitter=0.4)),
    "log-thinned": _reading(partial(thin_rows, rows=400)),
    "clock jump": _reading(partial(clock_jumps, by=1e5)),
    "law +8 %": Rig(seal={"a": 0.08}),
    "law +48 %": Rig(seal={"a": 0.48}),
    "law cubic": Rig(seal={"c": _C}),
    "law softens 20 %": Rig(seal={"a": -0.2}),
    "friction 3 %": Rig(friction=0.03),
    "friction 10 %": Rig(friction=0.1),
})  # fmt: skip
"""By the names of the trials' tables; creep is for each e-fold, friction a part of k_inf x."""


def several(seed: int) -> Rig:
    """A rig with several faults at once, each smaller than where it stands alone.

    Sizes are even in their logarithm; how often each fault is there is a guess of ours.
    """
    random = np.random.default_rng([seed, crc32(b"several")])

    def size(low: float, high: float) -> float:
        return float(np.exp(random.uniform(np.log(low), np.log(high))))

    def draw_signed(low: float, high: float) -> float:
        return size(low, high) * (-1.0 if random.uniform() < 0.5 else 1.0)

    def some(*steps: tuple[float, Callable[[], Step]]) -> tuple[Step, ...]:
        return tuple(made() for share, made in steps if random.uniform() < share)

    def draw_present(share: float, low: float, high: float) -> float:
        return size(low, high) if random.uniform() < share else 0.0

    return Rig(
        machine=some(
            (0.5, lambda: partial(gives, compliance=size(2e-6, 40e-6))),
            (0.35, lambda: partial(creeps, by=size(1e-6, 12e-6))),
            (0.35, lambda: partial(warms, decades=size(0.01, 0.08))),
            (0.5, lambda: partial(late, by=size(1e-4, 3e-3))),
        ),
        reading=some(
            (0.5, lambda: partial(hums, size=size(1e-3, 6e-3), hertz=random.choice(_MAINS))),
            (0.5, lambda: partial(drifts, rate=draw_signed(3e-5, 3e-4))),
            (0.3, lambda: partial(noisy, sd=size(1e-3, 5e-3), tau=size(5e-3, 0.5))),
            (0.25, lambda: partial(wanders, by=size(1e-3, 5e-3))),
        ),
        noise=size(1e-3, 8e-3),
        encoder=draw_present(0.7, 0.5e-6, 12e-6),
        count=draw_present(0.6, 1e-3, 6e-3),
        friction=draw_present(0.2, 1e-3, 1e-2),
        seal={"a": draw_signed(5e-3, 6e-2)} if random.uniform() < 0.3 else {},
        protocol={
            "rate": float(random.choice([200.0, 250.0, 500.0, 1000.0])),
            "baseline": size(0.4, 8.0),
            "gap": draw_present(0.2, 1e-4, 1e-3),
            "servo": (size(4.0, 15.0), size(0.5, 0.9)) if random.uniform() < 0.2 else None,
        },
    )


def read(
    seal: Seal, protocol: Protocol, rig: Rig = FAULTLESS, *, seed: int = 0, name: str = ""
) -> Record:
    """Press a seal on a rig and read it; the same words give the same bytes."""
    random = np.random.default_rng([seed, crc32(name.encode())])
    protocol = replace(protocol, **rig.protocol)
    seal = replace(seal, depth=protocol.depth, **rig.seal)
    if rig.friction:
        seal = replace(seal, friction=rig.friction * seal.solid.k_inf * protocol.depth)
    steps = (
        *rig.machine, rig.rows, partial(noisy, sd=rig.noise), *rig.reading,
        partial(quantise_record, encoder=rig.encoder, count=rig.count, bias=rig.bias),
    )  # fmt: skip
    record = replace(press_seal(seal, protocol, name=name), machine_options=rig.machine_options)
    for step in steps:
        words = getattr(step, "keywords", {})
        done = (*record.done, (getattr(step, "func", step).__name__, words))
        record = replace(step(record, random), done=done)
    return record


def quantise_record(record: Record, random, *, encoder: float, count: float, bias: float) -> Record:
    """The steps of the encoder, m, and of the force, N, about a tare of `bias` N."""
    shown, force = record.displacement, record.force + bias
    return replace(
        record,
        displacement=np.round(shown / encoder) * encoder if encoder else shown,
        force=np.round(force / count) * count if count else force,
    )
