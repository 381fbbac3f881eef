"""How CPU time and memory grow with rows, temperatures and files, and what an idle watch costs.

    python benchmarks/growth.py [--rows N ...] [--temperatures N ...] [--files N ...]
        [--watched N] [--rounds 3]

Each command runs as a process of its own; printed are the median of its CPU time, its peak of
memory, and the exponent of the time between this size and the one before.
"""

from __future__ import annotations

import argparse
import math
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from dashpot.extensions.batch.batch_options import BatchOptions
from dashpot.extensions.batch.batch_run import BatchJob
from dashpot.extensions.batch.folder_watch import POLL_PERIOD, watch_batch

ENVIRONMENT = {
    **{name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"},
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
}
SETTLED = 8
"""Beats after which a folder of still files is idle."""


RUN = """
import resource, subprocess, sys
quiet = subprocess.DEVNULL
code = subprocess.run([sys.executable, "-m", "dashpot", *sys.argv[1:]], stdout=quiet, stderr=quiet)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(1e3 * (used.ru_utime + used.ru_stime), used.ru_maxrss / 1024)
sys.exit(code.returncode)
"""
"""Run a command from a small process: the peak of a child is at least that of its parent."""


def run_dashpot(words: Sequence[str], folder: Path) -> tuple[float, float]:
    """Return the CPU time, ms, and the peak of memory, MB, of a command that succeeds."""
    done = subprocess.run(
        [sys.executable, "-c", RUN, *words],
        check=False, capture_output=True, text=True, cwd=folder, env=ENVIRONMENT,
    )  # fmt: skip
    if done.returncode:
        raise RuntimeError(f"dashpot {' '.join(words)}: exit status {done.returncode}")
    cpu, memory = map(float, done.stdout.split())
    return cpu, memory


def write_record(path: Path, rows: int) -> None:
    """Write a ramp and hold of 41.5 s, two arms, as text of six decimals."""
    noise = np.random.default_rng(rows).normal(0, 4e-3, rows)
    time_s = np.arange(rows) * 41.5 / rows
    held = np.clip(time_s - 1.5, 0, None)
    depth = 8.0 * np.clip(time_s - 0.5, 0, 1)
    fade = 0.8 + 0.15 * np.exp(-held / 0.5) + 0.05 * np.exp(-held / 16)
    columns = np.column_stack((time_s, depth, 0.25 * depth * fade + noise))
    header = "time [s],displacement [mm],force [N]"
    np.savetxt(path, columns, fmt="%.6f", delimiter=",", header=header, comments="")


def print_growth(
    name: str, sizes: Sequence[int], commands: Sequence[Sequence[str]], folder: Path, rounds: int
) -> None:
    """Print a line for each size: CPU time, memory, exponent."""
    before: tuple[int, float] | None = None
    for size, words in zip(sizes, commands, strict=True):
        try:
            runs = [run_dashpot(words, folder) for _ in range(rounds)]
        except RuntimeError as error:
            print(f"{size:>10} {name:24} {error}")
            continue
        cpu, memory = (statistics.median(values) for values in zip(*runs, strict=True))
        exponent = ""
        if before is not None:
            exponent = f"{math.log(cpu / before[1]) / math.log(size / before[0]):10.2f}"
        print(f"{size:>10} {name:24} {cpu:9.0f} ms {memory:7.0f} MB{exponent}", flush=True)
        before = size, cpu


def measure_idle_beat(folder: Path, files: int) -> float:
    """Return the CPU time of a beat of a watched folder in which nothing changes, ms."""
    for number in range(files):
        (folder / f"{number:05}.csv").write_text("no record\n", "utf-8")
    beats: list[float] = []
    last = time.process_time()

    def wait(_: float) -> None:
        nonlocal last
        beats.append(1e3 * (time.process_time() - last))
        if len(beats) > 3 * SETTLED:
            raise KeyboardInterrupt
        last = time.process_time()

    job = BatchJob((folder,), folder.parent / "lot", BatchOptions(arms=1, quick=True), jobs=1)
    watch_batch(job, lambda _: None, wait=wait, clock=lambda: POLL_PERIOD * len(beats))
    return statistics.median(beats[SETTLED:])


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rows", type=int, nargs="*", default=[10_000, 100_000, 1_000_000])
    parser.add_argument("--temperatures", type=int, nargs="*", default=[2, 4, 8])
    parser.add_argument("--files", type=int, nargs="*", default=[50, 200])
    parser.add_argument("--watched", type=int, default=2000)
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for rows in options.rows:
            write_record(folder / f"{rows}.csv", rows)
        words = [("fit", f"{rows}.csv") for rows in options.rows]
        print_growth("rows, fit", options.rows, words, folder, options.rounds)
        words = [("inspect", f"{rows}.csv") for rows in options.rows]
        print_growth("rows, inspect", options.rows, words, folder, options.rounds)
        tests = [f"t{number}.csv" for number in range(max(options.temperatures, default=0))]
        for number, test in enumerate(tests):
            celsius = f"{23 - 25 * number / len(tests):.4g}degC"
            made = ("simulate", "relaxation", "--seal", "broad", "--temperature", celsius)
            run_dashpot((*made, "--seed", str(number), "-o", test), folder)
        words = [("fit", *tests[:count]) for count in options.temperatures]
        print_growth("temperatures, fit", options.temperatures, words, folder, options.rounds)
        words = []
        for count in options.files:
            (folder / f"lot{count}").mkdir()
            for number in range(count):
                write_record(folder / f"lot{count}" / f"{number:05}.csv", 8500)
            lot = f"lot{count}"
            requested = ("--arms", "2", "--quick", "--jobs", "1")
            words.append(("batch", lot, "-o", f"{lot}-results", *requested))
        print_growth("files, batch --quick", options.files, words, folder, 1)
        if options.watched:
            (folder / "watched").mkdir()
            beat = measure_idle_beat(folder / "watched", options.watched)
            print(f"{options.watched:>10} {'files, idle --watch':24} {beat:9.1f} ms a beat")


if __name__ == "__main__":
    main()
