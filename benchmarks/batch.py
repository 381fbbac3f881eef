"""A batch: what a test costs, in a loop, by processes, on a cluster; and what many files hold.

Run: python benchmarks/batch.py [TESTS [REPEATS [FILES]]] [--kinds REGEX]

The tests are of the virtual rig, 42 500 rows each, linked so that there are four of each. A cost is
CPU time of all processes: the least of some repeats, taken in turns, for other work on a machine
lengthens it. Every run is an interpreter of its own; a run of a quarter of the files is taken off,
so that neither its start nor that of its workers counts.

Processors that work side by side share caches, memory and clock rate: the same loop takes longer
on each than it takes alone. An engine is therefore held to plain loops, one on each processor at
the same time, each over its share of the same files. Memory is told by many short records.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import time
from collections import defaultdict
from contextlib import redirect_stdout, suppress
from importlib.util import find_spec
from io import StringIO
from pathlib import Path
from resource import RUSAGE_CHILDREN, RUSAGE_SELF, getrusage
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import dashpot as dp
from dashpot.base.subprocesses import get_long_lived_env
from dashpot.extensions.batch.batch_options import BatchOptions
from dashpot.extensions.batch.batch_run import batch
from dashpot.extensions.batch.input_files import find_entries
from dashpot.extensions.batch.parquet_parts import make_tasks
from dashpot.extensions.batch.process_pool import count_processors
from dashpot.extensions.batch.table_row import make_row
from dashpot.reading.write import write_relaxation
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.simulation.rig_errors import Rig
from dashpot.solids.demo_seals import PAPER

KINDS: dict[str, dict[str, Any]] = {
    "intervals and checks": {},
    "--arms 2": {"arms": 2},
    "--arms 2 --quick": {"arms": 2, "quick": True},
}
TARGETS = {"intervals and checks": 9, "--arms 2 --quick": 25}
SHORT = {"arms": 1, "method": "hold", "quick": True}
QUIET = {
    "distributed.admin.tick.interval": "1s",
    "distributed.admin.system-monitor.interval": "5s",
    "distributed.worker.memory.monitor-interval": "1s",
    "distributed.worker.profile.enabled": False,
}
LINKS = 4
"""Of each file in the folder of all, whose other folder holds each once."""
COUNTED = (100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000)


def main() -> None:
    """Print the cost of a test, the memory of many, and what ten million would take."""
    parser = argparse.ArgumentParser(description=__doc__)
    for name, default in (("tests", 60), ("repeats", 3), ("files", 5000)):
        parser.add_argument(name, type=int, nargs="?", default=default)
    parser.add_argument("--kinds", default="", help=f"of {', '.join(KINDS)}")
    options = parser.parse_args()
    tests, repeats, files = options.tests, options.repeats, options.files
    kinds = {name: how for name, how in KINDS.items() if re.search(options.kinds, name)}
    with TemporaryDirectory() as place:
        whole, part, many = (Path(place) / name for name in ("whole", "part", "many"))
        for folder in (whole, part, many):
            folder.mkdir()
        rng = np.random.default_rng(0)
        for i in range(tests):
            seal = (1 + 0.03 * rng.standard_normal()) * PAPER
            text = write_relaxation(simulate_relaxation(seal, seed=i).test)
            made = part / f"seal_{i:04d}.csv"
            made.write_text(text)
            for again in range(LINKS):
                (whole / f"{made.stem}_{again}.csv").hardlink_to(made)
        costs = {name: cost(name, how, whole, part, repeats) for name, how in kinds.items()}
        individual = memory(many, files)
    print_extrapolation(costs, individual)


def cost(name: str, how: dict[str, Any], whole: Path, part: Path, repeats: int) -> float:
    """Print CPU time for each test by every engine; return the least of the processes, s."""
    runs: dict[tuple[str, Path], list[dict[str, float]]] = defaultdict(list)
    # a fit of the API has its intervals
    engines = [engine for engine in ENGINES if not (how.get("quick") and engine in ALONE)]
    for _ in range(repeats):
        for engine in engines:
            for folder in (whole, part):
                runs[engine, folder].append(run(engine, folder, how))
    least = {}
    for engine in engines:
        cpu = [min(entry["cpu"] for entry in runs[engine, folder]) for folder in (whole, part)]
        tests = [runs[engine, folder][0]["tests"] for folder in (whole, part)]
        least[engine] = (cpu[0] - cpu[1]) / (tests[0] - tests[1])
    for engine, value in least.items():
        neighbour = value / least["loops"] - 1
        target = f"   target {TARGETS[name]}" if name in TARGETS else ""
        print(
            f"{name:22} {engine:11} {1e3 * value:6.1f} ms   {1 / value:5.1f} tests/s/core{target}"
            + (
                f"   beside loops {100 * neighbour:+.1f} %"
                if engine not in {"loop", "loops"}
                else ""
            )
        )
    return least["processes"]


def memory(folder: Path, most: int) -> float:
    """Print what parent and workers hold of so many files; return the parent's CPU time each, s."""
    made = simulate_relaxation(PAPER, hold_time=4.0, rig=Rig(rate=250.0)).test
    text, there, spent = write_relaxation(made), 0, 0.0
    for count in (most // 20, most // 4, most):
        for i in range(there, count):
            (folder / f"seal_{i:05d}.csv").write_text(f"# seal {i}\n{text}")
        process, whole = (run(name, folder, SHORT) for name in ("processes", "command"))
        value = (process["own"] - spent) / (count - there)
        there, spent = count, process["own"]
        print(
            f"{count:5} short files, {process['wall']:3.0f} s   "
            f"parent {process['parent_mb']:.0f} MB, "
            f"with workbook and page {whole['parent_mb']:.0f} MB, "
            f"each worker at most {process['worker_mb']:.0f} MB"
        )
    print(f"finding, hashing, asking and writing one more file: {1e3 * value:.2f} ms of the parent")
    return value


def print_extrapolation(costs: dict[str, float], individual: float) -> None:
    """Print what as many tests take: computed from the above, not measured."""
    print("\ncomputed   " + "".join(f"{name:>24}" for name in costs) + f"{'parent':>12}")
    for count in COUNTED:
        hours = "".join(f"{count * value / 3600:18.3g} core h" for value in costs.values())
        print(f"{count:10}   {hours} {count * individual / 3600:9.2g} h")


def run(engine: str, folder: Path, how: dict[str, Any]) -> dict[str, float]:
    """What an interpreter of its own takes for one run."""
    words = [sys.executable, __file__, "--engine", engine, str(folder), json.dumps(how)]
    done = subprocess.run(
        words, check=True, capture_output=True, text=True, env=get_long_lived_env()
    )
    values: dict[str, float] = json.loads(done.stdout)
    return values


def measure_engine(engine: str, folder: str, how: dict[str, Any]) -> dict[str, float]:
    """CPU time, s, and memory, MB, of this process and of those that it waited for."""
    began = time.perf_counter()
    count = (ENGINES | OTHERS)[engine](folder, how)
    individual, others = getrusage(RUSAGE_SELF), getrusage(RUSAGE_CHILDREN)
    spent = [item.ru_utime + item.ru_stime for item in (individual, others)]
    return {
        "tests": count, "cpu": sum(spent), "own": spent[0], "wall": time.perf_counter() - began,
        "parent_mb": individual.ru_maxrss / 1024, "worker_mb": others.ru_maxrss / 1024,
    }  # fmt: skip


def run_loop(folder: str, how: dict[str, Any], share: slice = slice(None)) -> int:
    """Make the rows here, one after the other, and no table."""
    import msgspec  # noqa: F401 -- as in a worker

    choices = BatchOptions(**how)
    entry = find_entries([folder], output_folder=Path(folder) / "none")[share]
    requested = make_tasks(entry, choices)
    return sum(
        make_row(item.entry, item.hashes, choices)["outcome"] == "fitted" for item in requested
    )


def run_loops(folder: str, how: dict[str, Any]) -> int:
    """Make them in as many loops as processors, each on one of its own; no table, no engine."""
    count = count_processors()
    words = [sys.executable, __file__, "--share", folder, json.dumps(how), str(count)]
    loops = [
        subprocess.Popen([*words, str(i)], stdout=subprocess.PIPE, text=True) for i in range(count)
    ]
    return sum(int(loop.communicate()[0]) for loop in loops)


def run_worker_loop(folder: str, how: str, count: str, i: str) -> None:
    """Be one of those loops."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {sorted(os.sched_getaffinity(0))[int(i)]})
    print(run_loop(folder, json.loads(how), slice(int(i), None, int(count))))


def run_processes(folder: str, how: dict[str, Any]) -> int:
    """Make them by processes of this machine, with their table."""
    with TemporaryDirectory() as output:
        return batch(folder, output=output, **how).outcomes["fitted"]


def run_command(folder: str, _how: dict[str, Any]) -> int:
    """Make those of short records by the command, with its workbook and page."""
    from dashpot.cli import main as dashpot

    quick = ("--arms", "1", "--method", "hold", "--quick")
    with TemporaryDirectory() as output, redirect_stdout(StringIO()):
        with suppress(SystemExit):
            dashpot(["batch", folder, "-o", output, *quick])
        if not (Path(output) / "lot.html").exists():
            raise SystemExit("the command ended before its page was there")
        return len(dp.Lot.read(output).table)


def run_quiet_cluster(folder: str, how: dict[str, Any]) -> int:
    """Make them by a cluster whose clocks are set as docs/howto/batch.md says."""
    import dask

    dask.config.set(QUIET)
    return run_cluster(folder, how)


def run_cluster(folder: str, how: dict[str, Any]) -> int:
    """Make them by the workers of a cluster as it comes, one a processor, with their table."""
    import warnings

    from distributed import LocalCluster

    warnings.filterwarnings("ignore")
    side = {"n_workers": count_processors(), "threads_per_worker": 1, "dashboard_address": None}
    with TemporaryDirectory() as output, LocalCluster(**side, silence_logs=50) as cluster:
        lot = batch(folder, output=output, scheduler=cluster.scheduler_address, **how)
        return lot.outcomes["fitted"]


def fit_file(path: Path, arms: Any) -> bool:
    """Read and fit one file through the functions of the API; its row, checks and all, is lost."""
    return bool(dp.fit(dp.read(path), arms=arms).model.arms)


def run_joblib(folder: str, how: dict[str, Any]) -> int:
    """Fit them by joblib's processes: no table, and what fails ends the run."""
    from joblib import Parallel, delayed
    from joblib.externals.loky import get_reusable_executor

    arms, paths = how.get("arms", "auto"), sorted(Path(folder).glob("*.csv"))
    fitted = Parallel(count_processors())(delayed(fit_file)(path, arms) for path in paths)
    get_reusable_executor().shutdown(wait=True)  # whose CPU time then counts
    return sum(fitted)


def run_dask_map(folder: str, how: dict[str, Any]) -> int:
    """Fit them by the workers of a cluster as it comes: no table, and what fails ends the run."""
    from distributed import Client, LocalCluster

    side = {"n_workers": count_processors(), "threads_per_worker": 1, "dashboard_address": None}
    with LocalCluster(**side, silence_logs=50) as cluster, Client(cluster) as client:
        paths = sorted(Path(folder).glob("*.csv"))
        return sum(
            client.gather(client.map(fit_file, paths, arms=how.get("arms", "auto"), pure=False))
        )


ENGINES = {
    "loop": run_loop,
    "loops": run_loops,
    "processes": run_processes,
    "cluster": run_quiet_cluster,
    "as it comes": run_cluster,
    "dask map": run_dask_map,
}
if find_spec("joblib"):
    ENGINES["joblib"] = run_joblib
ALONE = {"dask map", "joblib"}
"""Fits alone, with neither rows nor a table."""

OTHERS = {"command": run_command}

if __name__ == "__main__":
    if sys.argv[1:2] == ["--engine"]:
        print(json.dumps(measure_engine(*sys.argv[2:4], json.loads(sys.argv[4]))))
    elif sys.argv[1:2] == ["--share"]:
        run_worker_loop(*sys.argv[2:])
    else:
        main()
