"""From a cold process to a printed fit of a 41 000-row file, beside what reading it costs anyone.

The yardstick is an interpreter that imports NumPy and reads the file with numpy.loadtxt. All
commands run in turn, A B A B, and each round gives one ratio. Target: 3 or less.

    python benchmarks/cold_start.py [--rounds 25]

Byte code is compiled before anything is timed, as it is for any installed package.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage

from dashpot.reading.write import write_relaxation
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.solids.demo_seals import PAPER

ENVIRONMENT = {
    **{key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"},
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
}


def cpu_and_wall(command: list[str]) -> tuple[float, float]:
    before, start = getrusage(RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run(command, check=True, capture_output=True, env=ENVIRONMENT)
    wall, after = time.perf_counter() - start, getrusage(RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, wall


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=25)
    rounds = parser.parse_args().rounds
    dashpot = str(Path(sys.executable).with_name("dashpot"))
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "seal.csv"
        file.write_text(write_relaxation(simulate_relaxation(PAPER).test))
        read = f"import numpy; numpy.loadtxt({str(file)!r}, delimiter=',', skiprows=1)"
        commands = {
            "import numpy": [sys.executable, "-c", "import numpy"],
            "import numpy, loadtxt": [sys.executable, "-c", read],
            "dashpot fit": [dashpot, "fit", str(file)],
            "dashpot --help": [dashpot, "--help"],
            "import click": [sys.executable, "-c", "import click"],
        }
        for command in commands.values():  # compiles what is not compiled
            cpu_and_wall(command)
        runs = [
            {name: cpu_and_wall(command) for name, command in commands.items()}
            for _ in range(rounds)
        ]
    print(f"{'ms, median (least)':24} {'CPU':>14} {'wall':>14}")
    for name in commands:
        texts = [
            f"{statistics.median(times):6.0f} ({min(times):4.0f})"
            for times in ([1e3 * run[name][i] for run in runs] for i in (0, 1))
        ]
        print(f"{name:24} {texts[0]:>14} {texts[1]:>14}")
    for ours, theirs in (
        ("dashpot fit", "import numpy, loadtxt"),
        ("dashpot --help", "import click"),
    ):
        ratio = statistics.median(run[ours][0] / run[theirs][0] for run in runs)
        least = min(run[ours][0] for run in runs) / min(run[theirs][0] for run in runs)
        print(
            f"{ours} / ({theirs}): {ratio:.2f} in CPU time, median of {rounds} rounds; "
            f"least over least {least:.2f}"
        )


if __name__ == "__main__":
    main()
