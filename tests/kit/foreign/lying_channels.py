"""Channels that do not say what happened, and sound ones that look as if they did not.

Steps for `rigs`: a reading that stands still while its sensor does not (`freezes`, `repeats`), a
servo that hunts on record (`hunts`), the mains in both channels (`hums_in_both`), mains that a slow
clock folds (`add_folded_hum`), and a path that is sent and not measured (`as_sent`). `LYING` are
rigs of each kind, `HONEST` their sound siblings. `press_steps` presses and eases a seal by any
stairs. SI units.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from types import MappingProxyType

import numpy as np

from .rigs import FAULTLESS, Protocol, Record, Rig, hums, press_seal
from .truths import Seal


def freezes(
    record: Record, random, *, channel: str, seconds: float, times: int = 1, start: float = 0.3
) -> Record:
    """A channel keeps one value bit for bit, `times` over, from this part of the hold on."""
    values = getattr(record, channel).copy()
    hold = record.protocol.hold
    span = (1 - start) * hold
    for i in range(times):
        first = record.ramp_end + start * hold + i * span / times
        stuck = (record.time >= first) & (record.time < first + seconds)
        values[stuck] = values[np.argmax(stuck)]
    return replace(record, **{channel: values})


def freezes_in_ramp(record: Record, random, *, channel: str, part: float = 0.3) -> Record:
    """A channel keeps one value for a part of the ramp, from its middle less half of that."""
    values, ramp = getattr(record, channel).copy(), record.protocol.ramp
    first = record.protocol.baseline + (0.5 - part / 2) * ramp
    stuck = (record.time >= first) & (record.time < first + part * ramp)
    values[stuck] = values[np.argmax(stuck)]
    return replace(record, **{channel: values})


def repeats(record: Record, random, *, channel: str, rate: float) -> Record:
    """A channel is renewed at `rate`, Hz, and repeated between."""
    value = max(1, round(record.protocol.rate / rate))
    rows = np.arange(len(record.time)) // value * value
    return replace(record, **{channel: getattr(record, channel)[rows]})


def clips(record: Record, random, *, channel: str, part: float) -> Record:
    """A channel stands at its end from this part of what it would reach."""
    values = getattr(record, channel)
    return replace(record, **{channel: np.minimum(values, part * values.max())})


def trembles(record: Record, random, *, by: float) -> Record:
    """The encoder scatters, m."""
    noise = by * random.standard_normal(len(record.time))
    return replace(record, displacement=record.displacement + noise)


def hunts(record: Record, random, *, by: float, hertz: float) -> Record:
    """The servo swings by `by`, m, from the ramp's end on, and the encoder sees it."""
    since = np.maximum(record.time - record.ramp_end, 0.0)
    swing = by * (1 - np.exp(-since / 0.2)) * np.sin(2 * np.pi * hertz * since)
    x = np.maximum(record.compression + swing, 0.0)
    force = record.seal.force(x, record.step)
    return replace(
        record, displacement=record.displacement + swing, compression=x, pure=force, force=force
    )


def hums_in_both(record: Record, random, *, size: float, by: float, hertz: float = 50.02) -> Record:
    """The mains in the force, N, and in the encoder's reading, m: the plate does not move."""
    record = hums(record, random, size=size, hertz=hertz)
    turn = 2 * np.pi * hertz * record.time + random.uniform(0, 2 * np.pi)
    return replace(record, displacement=record.displacement + by * np.sin(turn))


def add_folded_hum(record: Record, random, *, size: float, hertz: float = 50.0) -> Record:
    """The mains, of a frequency of the day, before a converter without a filter."""
    return hums(record, random, size=size, hertz=hertz + random.uniform(-0.02, 0.02))


def as_sent(record: Record, random) -> Record:
    """The file has the set-point, which is where the plate went."""
    return replace(record, displacement=np.round(record.displacement, 12))


def _reading(*steps, **changes) -> Rig:
    return Rig(reading=steps, **changes)


_SHAKEN = partial(trembles, by=3e-6)
_COARSE = {"noise": 0.3e-3, "count": 8e-3}

LYING: Mapping[str, Rig] = MappingProxyType({
    "force frozen 12 s": _reading(partial(freezes, channel="force", seconds=12.0)),
    "force frozen to the end": _reading(partial(freezes, channel="force", seconds=1e3)),
    "force frozen 1 s, 6 times": _reading(
        partial(freezes, channel="force", seconds=1.0, times=6, start=0.1)
    ),
    "force frozen early": _reading(
        partial(freezes, channel="force", seconds=1e3, start=0.02)
    ),
    "force frozen in the ramp": _reading(partial(freezes_in_ramp, channel="force")),
    "coarse force frozen": _reading(
        partial(freezes, channel="force", seconds=1e3, start=0.02), noise=1e-3, count=2e-3
    ),
    "force without noise frozen": _reading(
        partial(freezes, channel="force", seconds=1e3, start=0.02), noise=0.0, count=0.0
    ),
    "coarser force frozen": _reading(
        partial(freezes, channel="force", seconds=1e3, start=0.02), noise=0.2e-3, count=1e-3
    ),
    "force repeated at 5 Hz": _reading(partial(repeats, channel="force", rate=5.0)),
    "displacement frozen 12 s": _reading(
        _SHAKEN, partial(freezes, channel="displacement", seconds=5.0, times=2)
    ),
    "displacement frozen in the ramp": _reading(
        partial(freezes_in_ramp, channel="displacement")
    ),
    "displacement repeated at 10 Hz": _reading(
        partial(repeats, channel="displacement", rate=10.0)
    ),
    "displacement stands at its end": _reading(partial(clips, channel="displacement", part=0.85)),
})  # fmt: skip
"""Rigs of which a channel stands still while its sensor does not."""

HONEST: Mapping[str, Rig] = MappingProxyType({
    "none": FAULTLESS,
    "coarse force": Rig(**_COARSE),
    "coarser force": Rig(noise=1e-3, count=15e-3),
    "force of 4 mN counts": Rig(noise=1e-3, count=4e-3),
    "without noise": Rig(noise=0.0, count=0.0, encoder=0.0),
    "as sent": _reading(as_sent, encoder=0.0),
    "shaken encoder": _reading(_SHAKEN),
})  # fmt: skip
"""Sound siblings: coarse counts, no noise at all, a path as it was sent."""

HUNTING: Mapping[str, Rig] = MappingProxyType({
    "hold oscillates .8 Hz, recorded": Rig(machine=(partial(hunts, by=20e-6, hertz=0.8),)),
    "hold oscillates 3 Hz, recorded": Rig(machine=(partial(hunts, by=8e-6, hertz=3.1),)),
    "hold oscillates 6 Hz, recorded": Rig(machine=(partial(hunts, by=20e-6, hertz=6.3),)),
    "hold oscillates 17 Hz, recorded": Rig(machine=(partial(hunts, by=50e-6, hertz=17.0),)),
})  # fmt: skip

PICKED_UP: Mapping[str, Rig] = MappingProxyType(
    {
        f"mains in both, {1e6 * by:g} um": _reading(partial(hums_in_both, size=6e-3, by=by))
        for by in (0.0, 0.5e-6, 2e-6)
    }
)

FOLDED: Mapping[str, Rig] = MappingProxyType({
    f"mains folded at {rate:g} Hz": _reading(
        partial(add_folded_hum, size=8e-3, hertz=hertz), protocol={"rate": rate}
    )
    for rate, hertz in ((25.0, 50.0), (10.0, 50.0), (20.0, 60.0))
})  # fmt: skip


CHANNELS: Mapping[str, Rig] = MappingProxyType({**LYING, **HUNTING, **PICKED_UP, **FOLDED})
"""What verdicts are judged on."""


def press_steps(
    seal: Seal, levels, *, ramp: float = 1.0, rest: float = 10.0, rate: float = 50.0,
    noise: float = 3e-3, encoder: float = 0.0, seed: int = 0,
) -> Record:  # fmt: skip
    """Pressed to each of the levels, m, in turn and held there, at the last four times as long.

    The plate's path is known exactly where `encoder` is 0.
    """
    ends, at = [(0.0, 0.0), (1.0, 0.0)], 1.0
    for i, level in enumerate(levels):
        held = rest * (4 if i == len(levels) - 1 else 1)
        ends += [(at + ramp, level), (at + ramp + held, level)]
        at += ramp + held
    fine = max(1, round(2000 / rate))
    clock = np.arange(round(at * rate * fine) + 1) / (rate * fine)
    x = np.interp(clock, *np.array(ends).T)
    force = seal.force(x, clock[1])[::fine]
    clock, x = clock[::fine], x[::fine]
    random = np.random.default_rng(seed)
    shown = np.round(x / encoder) * encoder if encoder else x
    read = force + noise * random.standard_normal(len(clock))
    protocol = Protocol(depth=float(levels[-1]), ramp=ramp, hold=4 * rest, rate=rate)
    return Record("stepped", seal, protocol, clock, shown, read, x, force)


STAIRS: Mapping[str, tuple[float, ...]] = MappingProxyType(
    {
        "up, then down": (2e-3, 4e-3, 6e-3, 4e-3, 2e-3),
        "eased by a quarter": (8e-3, 6e-3),
        "eased by half": (8e-3, 4e-3),
        "eased a little": (8e-3, 7.6e-3),
        "down and up again": (6e-3, 3e-3, 5e-3),
        "up": (2e-3, 4e-3, 6e-3),
    }
)

__all__ = [
    "CHANNELS", "FOLDED", "HONEST", "HUNTING", "LYING", "PICKED_UP", "STAIRS", "press_seal",
    "press_steps",
]  # fmt: skip
