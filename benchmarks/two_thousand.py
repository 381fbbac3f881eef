"""Two thousand tests in four lots, thirty of them spoilt in ten ways: does the batch find them out?

Seals are as stiff as a draw of 2 % between lots, 3 % between the seals of a lot and 1 % between
the repeats of a seal makes them; the rig is written here, apart from ``src``. Judged are the
components of variance against those of the draw, every spoilt file by its row, and every sound one
by the truth: k(T), T the hold, lies between the limits of its row, and k_inf, of which a hold tells
no lower one, below its upper. Two gigabytes are written to the folder for temporary files.
``python benchmarks/two_thousand.py [TESTS] [--jobs N]``
"""

from __future__ import annotations

import argparse
import math
import resource
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import polars as pl

import dashpot as dp
from dashpot.extensions.batch.batch_run import batch

LOTS, REPEATS = 4, 4
SCATTER = {"lot": 0.02, "seal": 0.03, "repeat": 0.01}
K_INF, ARMS = 196.5, ((117.5, 0.502), (17.8, 16.4))
DEPTH, RAMP, BEFORE, HOLD, RATE = 8e-3, 1.0, 1.0, 40.0, 1000.0
NOISE, COUNT, ZERO = 2e-3, 1e-6, 5e-3
"""Of the force, N; of the encoder, m; of the cell's zero, N."""
K_END = K_INF + sum(k * math.exp(-HOLD / tau) for k, tau in ARMS)
"""k(T), N/m, T the hold: what statistics of a lot are of."""
BY = r"lot(\w)_seal(\d+)_rep(\d)"


def record(scale: float, rng: np.random.Generator) -> pl.DataFrame:
    """A ramp and hold of a seal `scale` times as stiff as the paper's, by the closed form."""
    t = np.arange(0, BEFORE + RAMP + HOLD, 1 / RATE)
    since = np.maximum(t - BEFORE, 0)
    ramped = np.minimum(since, RAMP)
    force = K_INF * ramped
    for k, tau in ARMS:
        force = force + k * tau * (np.exp(-(since - ramped) / tau) - np.exp(-since / tau))
    force = scale * DEPTH / RAMP * force
    x = np.round(DEPTH / RAMP * ramped / COUNT) * COUNT
    force += rng.normal(0, ZERO) + NOISE * rng.standard_normal(len(t))
    return pl.DataFrame({"time [s]": t, "displacement [mm]": 1e3 * x, "force [N]": force})


def text(frame: pl.DataFrame) -> str:
    return frame.write_csv(float_precision=7)


def cut(frame: pl.DataFrame) -> str:
    return text(frame[: int(6 * RATE)])


def with_a_hole(frame: pl.DataFrame) -> str:
    lines = text(frame).splitlines()
    at = int((BEFORE + RAMP / 2) * RATE)
    lines[at] = lines[at].rsplit(",", 1)[0] + ",NaN"
    return "\n".join(lines)


def format_saturated(frame: pl.DataFrame) -> str:
    return text(frame.with_columns(pl.col("force [N]").clip(upper_bound=1.5)))


def clock_reset(frame: pl.DataFrame) -> str:
    half = frame.height // 2
    back = frame[half:].with_columns(pl.col("time [s]") - 20)
    return text(pl.concat([frame[:half], back]))


def never_touched(frame: pl.DataFrame) -> str:
    rng = np.random.default_rng(frame.height)
    return text(
        frame.with_columns(pl.Series("force [N]", NOISE * rng.standard_normal(frame.height)))
    )


SPOILT: dict[str, Callable[[pl.DataFrame], str | bytes]] = {
    "empty": lambda _: "",
    "binary": lambda frame: bytes(range(256)) * frame.height,
    "words": lambda _: "The test of this seal was not saved.\n" * 40,
    "no units": lambda frame: text(frame.rename(dict(zip(frame.columns, "abc", strict=True)))),
    "no force": lambda frame: text(frame.drop("force [N]")),
    "cut in the hold": cut,
    "NaN in the ramp": with_a_hole,
    "saturated": format_saturated,
    "clock reset": clock_reset,
    "never touched": never_touched,
}
"""Ten ways; each spoils as many files as the others."""


def write_files(folder: Path, tests: int) -> tuple[dict[str, float], dict[str, str]]:
    """Write the files; return the scale of each sound one, and how each other is spoilt."""
    rng = np.random.default_rng(2026)
    seals = tests // (LOTS * REPEATS)
    names, scales = [], []
    for lot in range(LOTS):
        of_lot = rng.normal(0, SCATTER["lot"])
        for seal in range(seals):
            of_seal = of_lot + rng.normal(0, SCATTER["seal"])
            for repeat in range(REPEATS):
                names.append(f"lot{'ABCD'[lot]}_seal{seal:03}_rep{repeat}.csv")
                scales.append(1 + of_seal + rng.normal(0, SCATTER["repeat"]))
    ways = list(SPOILT)
    chosen = rng.permutation(len(names))[: max(len(ways), 30 * tests // 2000)]
    spoilt = {names[at]: ways[i % len(ways)] for i, at in enumerate(chosen)}
    for name, scale in zip(names, scales, strict=True):
        frame = record(scale, rng)
        content = SPOILT[spoilt[name]](frame) if name in spoilt else text(frame)
        (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    intact = {n: s for n, s in zip(names, scales, strict=True) if n not in spoilt}
    return intact, spoilt


def judge(lot: dp.Lot, intact: dict[str, float], spoilt: dict[str, str]) -> None:
    table = lot.table.with_columns(pl.col("file").str.split("/").list.last().alias("name"))
    rows = {row["name"]: row for row in table.iter_rows(named=True)}
    used = {file.rsplit("/", 1)[-1] for file in lot.rows_in_statistics["file"]}
    print(f"{len(rows)} rows of {len(intact) + len(spoilt)} files: {lot.outcomes}, {lot.verdicts}")
    for way in SPOILT:
        ours = [name for name, item in spoilt.items() if item == way]
        counted = [name for name in ours if name in used]
        example = rows[ours[0]]
        message = example["reason"] or lot.dissimilar.get(example["file"], "nothing")
        print(
            f"  {way:18} {len(ours)} files, {len(counted)} in the statistics; says: {message[:110]}"
        )
    lost = [name for name in intact if name not in used]
    print(f"  sound tests left out of the statistics: {len(lost)} of {len(intact)}")
    for name in lost[:5]:
        print(f"    {name}: {rows[name]['reason'][:110]}")
    result = [(rows[name], scale) for name, scale in intact.items() if name in used]
    between = [
        row["k_end_low_N_per_m"] <= K_END * scale <= row["k_end_high_N_per_m"]
        for row, scale in result
    ]
    below = [K_INF * scale <= row["k_inf_high_N_per_m"] for row, scale in result]
    print(f"  k(T) between its limits: {np.mean(between):.3f} of {len(result)} sound tests")
    print(f"  k_inf below its upper limit: {np.mean(below):.3f}")
    for component in lot.components("k_end"):
        sd = 100 * component.variance**0.5 / K_END
        if component.interval is None:
            print(f"  {component.source:7} {sd:.3f} %")
            continue
        low, high = (100 * end**0.5 / K_END for end in component.interval)
        true = 100 * SCATTER[component.source]
        output = "inside" if low <= true <= high else "OUTSIDE"
        print(
            f"  {component.source:7} {sd:.3f} % ({low:.3f} to {high:.3f}), "
            f"drawn from {true:g} %: {output}"
        )


def main() -> None:
    requested = argparse.ArgumentParser()
    requested.add_argument("tests", type=int, nargs="?", default=2000)
    requested.add_argument("--jobs", type=int)
    how = requested.parse_args()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "tests"
        folder.mkdir()
        intact, spoilt = write_files(folder, how.tests)
        size = sum(path.stat().st_size for path in folder.iterdir()) / 1e6
        began = time.perf_counter()
        lot = batch(folder, output=Path(place) / "lot", arms=2, label_pattern=BY, jobs=how.jobs)
        wall = time.perf_counter() - began
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        cpu = used.ru_utime + used.ru_stime
        print(
            f"{how.tests} tests, {size:.0f} MB: {wall:.0f} s, {how.tests / cpu:.1f} tests/s of CPU "
            f"of the processes, the largest {used.ru_maxrss / 1024:.0f} MB"
        )
        judge(lot, intact, spoilt)


if __name__ == "__main__":
    main()
