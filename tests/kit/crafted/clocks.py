"""Clocks that jump: noted, and never of a record that is to be used as it is; or refused."""

# ruff: noqa: E501 - a file of a lab stands on one line

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from dashpot.extensions.curves.creep.preprocess import load_hold
from dashpot.extensions.curves.creep.read import read_creep
from dashpot.preprocessing.prepare import prepare
from dashpot.reading.readers.impact import read_impact
from dashpot.reading.readers.relaxation import read_relaxation
from kit.crafted.row import CLOCK, CREPT, HIT, RUNG, TICKS, Row, Truth, table
from kit.kinds import CLOCK as BENCH_CLOCK
from kit.kinds import answer, ramp_and_hold

TIME = BENCH_CLOCK
X = ramp_and_hold()
FORCE = answer(TIME, X) + 2e-4 * np.random.default_rng(1).standard_normal(len(TIME))
LEAP = ("the clock goes on by",)
FALL = ("time falls from", "give --rate 25Hz if the rows are evenly sampled")


def _steady(*, failed: bool) -> Callable[[Any, Row], None]:
    def holds(test: Any, row: Row) -> None:
        checks = {check.name: check for check in prepare(test).checks}
        assert checks["clock_steady"].failed is failed

    return holds


LEAPT = Truth("relaxation", read_relaxation, _steady(failed=True))
"""A record whose slow arms are not to be believed."""
FAULTLESS = Truth("relaxation", read_relaxation, _steady(failed=False))
"""One whose clock is as it should be."""


def _unsteady_load(test: Any, row: Row) -> None:
    checks = {check.name: check for check in load_hold(test).checks}
    assert checks["clock_steady"].failed


def _goes_on(test: Any, row: Row) -> None:
    assert test.time[-1] > 9000


def _two_records(test: Any, row: Row) -> None:
    assert test.starts == (0, 1024)


def bench(time: np.ndarray) -> bytes:
    return table(
        "time [s];displacement [mm];force [N]", time, 1e3 * X, FORCE, form="%.12g"
    ).encode()


def leapt(*jumps: tuple[float, float]) -> np.ndarray:
    """The time with jumps: where, s, and by how much, s."""
    return TIME + sum(by * (at < TIME) for at, by in jumps)


def encode_clock_table(time: np.ndarray, start: float, *, date: bool = False) -> bytes:
    cells = []
    for t in start + time:
        days, second = divmod(t, 86400)
        clock = f"{int(second // 3600):02d}:{int(second // 60) % 60:02d}:{second % 60:06.3f}"
        cells.append(f"2024-05-{int(1 + days):02d} {clock}" if date else clock)
    rows = zip(cells, 1e3 * X, FORCE, strict=True)
    return (
        "Time;Position (mm);Load (N)\n" + "".join(f"{c};{x:.9g};{f:.9g}\n" for c, x, f in rows)
    ).encode()


def blocks(second: float) -> bytes:
    """Two blocks under one header each, the second of them so much later."""
    head = "time [s];displacement [mm];force [N]"
    parts = []
    for part, late in ((slice(0, 250), 0.0), (slice(250, None), second)):
        parts.append(table(head, TIME[part] + late, 1e3 * X[part], FORCE[part], form="%.9g"))
    return "\nSegment: two\n".join(parts).encode()


def _midnight() -> bytes:
    """Instants of which the one at midnight is written as a date alone."""
    return encode_clock_table(TIME, 86390.0, date=True).replace(
        b"2024-05-02 00:00:00.000", b"2024-05-02"
    )


CLOCKS = [
    *(Row(f"a clock that leaps by {by:g} s in the hold", bench(leapt((10.0, by))), "noted", LEAP, LEAPT) for by in (60.0, 3600.0, 86400.0, 1e5, 1e7)),
    Row("a clock that leaps early in the hold", bench(leapt((2.5, 100.0))), "noted", LEAP, LEAPT),
    Row("a clock that leaps late in the hold", bench(leapt((19.0, 1e5))), "noted", LEAP, LEAPT),
    Row("a clock that leaps before the ramp", bench(leapt((0.5, 50.0))), "noted", LEAP, LEAPT),
    *(Row(f"a clock that leaps by half a second {where}", bench(leapt((at, 0.5))), "noted", LEAP, LEAPT) for where, at in (("before the ramp", 0.5), ("in the ramp", 1.5), ("at the end of the ramp", 2.05), ("in the hold", 5.0), ("late in the hold", 19.0))),
    Row("a clock that leaps by half a second before its last row", bench(leapt((TIME[-2], 0.5))), "noted", ("the last row stands 0.54 s behind",), LEAPT),
    Row("a clock that leaps in the ramp", bench(leapt((1.5, 60.0))), "noted", LEAP, LEAPT),
    Row("a clock that leaps before the ramp and in the hold", bench(leapt((0.5, 5.0), (9.0, 0.6))), "noted", LEAP, LEAPT),
    Row("a machine that pauses while its reading rests", bench(TIME - 0.036 * (np.arange(len(TIME)) % 10)), "noted", LEAP, FAULTLESS),
    Row("a clock that goes on in other units", bench(np.where(TIME > 10, TIME[250] + 1e3 * (TIME - TIME[250]), TIME)), "asked", ("go from 40 ms to 40 s at 10 s", "confirm s", "--units time=s"), Truth("relaxation", read_relaxation, _goes_on), answer={"units": {"time": "s"}}, by_size=True),
    Row("a clock that goes on at a hundredth of its rate", bench(np.where(TIME > 10, TIME[250] + 100 * (TIME - TIME[250]), TIME)), truth=FAULTLESS),
    Row("a clock that leaps behind its first row", bench(leapt((0.0, 500.0))), "noted", ("the first row stands 500.04 s before",), LEAPT),
    Row("a clock that leaps twice", bench(leapt((6.0, 1e3), (14.0, 1e3))), "noted", ("at t = 6 s", "at t = 1014 s"), LEAPT),
    Row("a clock that leaps three times in a row", bench(leapt((9.98, 1e3), (10.02, 1e3), (10.06, 1e3))), "noted", LEAP, LEAPT),
    Row("a clock that leaps at ten places", bench(leapt(*((2.0 * k, 40.0) for k in range(2, 10)))), "noted", ("the clock does so at 5 more places",), LEAPT),
    Row("a clock that falls back by 5 s", bench(leapt((10.0, -5.0))), "refused", FALL),
    Row("a clock that falls back by a day", bench(leapt((10.0, -86400.0))), "refused", FALL),
    Row("a clock that leaps and falls back", bench(leapt((8.0, 1e3), (14.0, -1e3))), "refused", FALL),
    Row("a counter of 16 bits that begins again", bench(np.mod(TIME, 16.384)), "refused", FALL),
    Row("a clock that stands still", bench(np.minimum(TIME, 12.0)), "refused", ("time stamps repeat",)),
    Row("hours of the day that leap by one", encode_clock_table(leapt((10.0, 3600.0)), 6000.0), "noted", LEAP, LEAPT),
    Row("hours of the day that fall back by one", encode_clock_table(leapt((10.0, -3600.0)), 36000.0), "refused", FALL),
    Row("hours of the day over midnight", encode_clock_table(TIME, 86390.0), "noted", ("the clock passes midnight",), FAULTLESS),
    Row("dates that leap by a day at midnight", encode_clock_table(leapt((9.98, 86400.0)), 86390.0, date=True), "noted", LEAP, LEAPT),
    Row("instants of which midnight is a date alone", _midnight(), truth=FAULTLESS),
    Row("a second block on a later clock", blocks(1e4), "noted", ("2 segments joined", *LEAP), LEAPT),
    Row("a second block that begins again", blocks(-10.0), "refused", ("2 segments", "--file-part segment=1")),
    Row("the clock of a hammer that leaps", table("time [s];hammer [N];acceleration [m/s^2]", TICKS + 50.0 * (TICKS >= 1), HIT, RUNG, form="%.9g").encode(), "noted", ("the clock jumps at line 1026",), Truth("impact", read_impact, _two_records)),
    Row("the clock of a creep test that leaps", table("time [s];Strain [%];Stress [Pa]", CLOCK + 1e4 * (CLOCK > 30), CREPT, 1e5 + 0 * CLOCK, form="%.9g").encode(), "noted", LEAP, Truth("creep", read_creep, _unsteady_load)),
]  # fmt: skip
