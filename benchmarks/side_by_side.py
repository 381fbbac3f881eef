"""CPU time of two installations of dashpot on the same files, command by command in turns.

    python benchmarks/side_by_side.py BEFORE AFTER [--rounds 15] [--records 24] [--only REGEX]
        [--most RATIO]

BEFORE and AFTER are environments (folders with bin/python and bin/dashpot). The example files are
those of AFTER's `dashpot demo --files`; the foreign records are those of `tests/kit/foreign`, which
import nothing from dashpot. Both run, A B A B, each command as a process of its own, whose CPU time
is its own and its children's; then another mass in the app, and `dp.fit` of each foreign record,
inside one process of each, so that start-up is not counted. Printed: medians, and the median of the
ratios AFTER / BEFORE of the rounds (of the records). Exit status 1 if a ratio is larger than
--most. A command that an installation does not know, or that fails there, is named and not timed.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shlex
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage
from typing import NamedTuple

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from kit.foreign.catalogue import relaxation_records
from kit.foreign.rigs import Record

ENVIRONMENT = {
    **{name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"},
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
}
MASS = "--mass 114.8g --seals 2"
COMMANDS = {
    "--help": "--help",
    "inspect": "inspect seal_8mm.csv",
    "fit": "fit seal_8mm.csv",
    "fit of the hammer": "fit hammer.csv",
    "joint fit": f"fit seal_8mm.csv hammer.csv {MASS}",
    "predict": f"predict fit.json {MASS}",
    "compare": f"compare fit.json hammer.csv {MASS}",
    "export": (
        "export fit.json --to nastran --unit-system mm-t-s --temperature 23degC --length 50mm "
        "--band 1:20Hz --allow all -o seal.bdf --overwrite"
    ),
    "plan": "plan --frequency 12.7Hz",
    "report": "report seal_8mm.csv -o report.html --overwrite",
    "report of both": f"report seal_8mm.csv hammer.csv {MASS} -o both.html --overwrite",
    "fit -o page.html": "fit seal_8mm.csv -o page.html --overwrite",
    "fit --plot png": "fit seal_8mm.csv --plot fit.png --overwrite",
    "demo": "demo -o demo --overwrite",
}
"""Name -> arguments of dashpot, in a folder with the example files and `fit.json`."""
FIT_RECORDS = """
import json, sys, time
import dashpot as dp
spent = {}
for path in sys.argv[1:]:
    test = dp.read(path, kind="relaxation")
    times = []
    for _ in range(3):
        start = time.process_time()
        try:
            dp.fit(test)
        except dp.DashpotError:
            break
        times.append(time.process_time() - start)
    if times:
        spent[path] = 1e3 * min(times)
print(json.dumps(spent))
"""
"""CPU time of `dp.fit`, ms, of each file: the least of three."""
CHANGE_MASS = """
import json, os, sys, time
from pathlib import Path
os.environ["DASHPOT_STATE"] = "state"
try:
    from dashpot.extensions.app.handler_registry import VERBS
    from dashpot.extensions.app.upload_store import Store
except ImportError:
    from dashpot.web.store import Store
    from dashpot.web.verbs import VERBS
store, spent = Store(), []
seal, hammer = (store.put(name, Path(name).read_bytes()) for name in ("seal_8mm.csv", "hammer.csv"))
for mass in range(1 + int(sys.argv[1])):
    job = {"relaxation": seal, "impact": [hammer], "seals": 2, "mass": f"{114.8 + mass / 10}g"}
    start = time.process_time()
    VERBS["study"]({"job": job}, store.folder)
    spent.append(1e3 * (time.process_time() - start))
store.remove()
print(json.dumps(spent[1:]))
"""
"""CPU time, ms, of what the app computes and draws when the mass changes once more."""


class Pair(NamedTuple):
    """CPU times of one command, ms: of each round, or of each record."""

    before: list[float]
    after: list[float]

    @property
    def ratio(self) -> float:
        """Median of the ratios, round by round."""
        return statistics.median(b / a for a, b in zip(self.before, self.after, strict=True))


def measure_cpu(command: Sequence[str], folder: Path) -> float:
    """Return the CPU time of a command that succeeds, ms; raise CalledProcessError otherwise."""
    start = getrusage(RUSAGE_CHILDREN)
    subprocess.run(command, check=True, capture_output=True, env=ENVIRONMENT, cwd=folder)
    end = getrusage(RUSAGE_CHILDREN)
    return 1e3 * (end.ru_utime + end.ru_stime - start.ru_utime - start.ru_stime)


def compare_commands(environments: tuple[Path, Path], arguments: str, rounds: int) -> Pair:
    """Time a command in both environments in turns, after one run that is not counted."""
    times = Pair([], [])
    with tempfile.TemporaryDirectory() as name:
        folders = [Path(name) / place for place in Pair._fields]
        for environment, folder in zip(environments, folders, strict=True):
            prepare_folder(environment, folder)
        for turn in range(rounds + 1):
            for environment, folder, spent in zip(environments, folders, times, strict=True):
                command = [str(environment / "bin" / "dashpot"), *shlex.split(arguments)]
                cpu = measure_cpu(command, folder)
                if turn:
                    spent.append(cpu)
    return times


def compare_app(environments: tuple[Path, Path], rounds: int) -> Pair:
    """Time another mass in the app, each environment in processes of its own, in turns."""
    times = Pair([], [])
    with tempfile.TemporaryDirectory() as name:
        prepare_folder(environments[1], folder := Path(name) / "files")
        for _ in range(rounds):
            for environment, spent in zip(environments, times, strict=True):
                done = subprocess.run(
                    [str(environment / "bin" / "python"), "-c", CHANGE_MASS, "3"],
                    check=True, capture_output=True, text=True, env=ENVIRONMENT, cwd=folder,
                )  # fmt: skip
                spent.append(statistics.median(json.loads(done.stdout)))
    return times


def prepare_folder(environment: Path, folder: Path) -> None:
    """Write the example files and the fit that commands read."""
    folder.mkdir()
    dashpot = str(environment / "bin" / "dashpot")
    measure_cpu([dashpot, "demo", "--files"], folder)
    measure_cpu([dashpot, "fit", "seal_8mm.csv", "-o", "fit.json"], folder)


def write_record(record: Record, path: Path) -> None:
    """Write a relaxation record as text: s, mm, N."""
    columns = np.column_stack((record.time, 1e3 * record.displacement, record.force))
    header = "time [s],displacement [mm],force [N]"
    np.savetxt(path, columns, fmt="%.9g", delimiter=",", header=header, comments="")


def compare_records(environments: tuple[Path, Path], count: int) -> Pair:
    """Time `dp.fit` of foreign records, each environment in a process of its own."""
    with tempfile.TemporaryDirectory() as name:
        paths = []
        for number, record in enumerate(relaxation_records(count)):
            paths.append(Path(name) / f"{number:03d}.csv")
            write_record(record, paths[-1])
        spent: list[dict[str, float]] = [{}, {}]
        for path in paths:  # in turns, so that a machine that slows down slows both
            for environment, times in zip(environments, spent, strict=True):
                done = subprocess.run(
                    [str(environment / "bin" / "python"), "-c", FIT_RECORDS, str(path)],
                    check=True, capture_output=True, text=True, env=ENVIRONMENT,
                )  # fmt: skip
                times.update(json.loads(done.stdout))
        both = [str(path) for path in paths if all(str(path) in times for times in spent)]
    return Pair([spent[0][path] for path in both], [spent[1][path] for path in both])


def format_row(name: str, pair: Pair) -> str:
    """One line of the table."""
    before, after = statistics.median(pair.before), statistics.median(pair.after)
    return f"{name:24} {before:9.1f} {after:9.1f} {pair.ratio:7.2f}"


def main() -> int:
    """Print the table; return 1 where a ratio is above --most."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("before", type=Path)
    parser.add_argument("after", type=Path)
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--records", type=int, default=24, help="foreign records; 0: none")
    parser.add_argument("--only", default="", help="commands whose names match")
    parser.add_argument("--most", type=float, default=float("inf"))
    options = parser.parse_args()
    environments = (options.before, options.after)
    ratios = []
    print(f"{'CPU, ms (medians)':24} {'before':>9} {'after':>9} {'ratio':>7}")
    rows = {name: partial(compare_commands, arguments=how) for name, how in COMMANDS.items()}
    for name, compare in {**rows, "another mass in the app": compare_app}.items():
        if not re.search(options.only, name):
            continue
        try:
            pair = compare(environments, rounds=options.rounds)
        except subprocess.CalledProcessError as error:
            print(f"{name:24} exit status {error.returncode}: {shlex.join(error.cmd)}")
            continue
        ratios.append(pair.ratio)
        print(format_row(name, pair), flush=True)
    if options.records and re.search(options.only, "dp.fit of foreign records"):
        pair = compare_records(environments, options.records)
        ratios.append(pair.ratio)
        print(format_row(f"dp.fit of {len(pair.before)} records", pair))
        tail = [float(np.quantile(times, 0.95)) for times in pair]
        total = sum(pair.after) / sum(pair.before)
        print(f"{'  95 % of them, and sum':24} {tail[0]:9.1f} {tail[1]:9.1f} {total:7.2f}")
    return int(any(ratio > options.most for ratio in ratios))


if __name__ == "__main__":
    sys.exit(main())
