"""From a cold process to a printed fit of a 41 000-row file, beside what reading it costs anyone.

The yardstick is an interpreter that imports NumPy and reads the file with numpy.loadtxt. Both
commands run in turn, A B A B, and each pair gives one ratio. Target: 3 or less.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from dashpot.io.write import write_relaxation
from dashpot.simulation.rig import simulate_relaxation
from dashpot.simulation.seals import PAPER

PAIRS = 9


def cpu_and_wall(command: list[str]) -> tuple[float, float]:
    before, start = os.times(), os.times().elapsed
    subprocess.run(command, check=True, capture_output=True)
    after = os.times()
    used = after.children_user + after.children_system
    return used - before.children_user - before.children_system, after.elapsed - start


def main() -> None:
    os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "seal.csv"
        file.write_text(write_relaxation(simulate_relaxation(PAPER).test))
        read = f"import numpy; numpy.loadtxt({str(file)!r}, delimiter=',', skiprows=1)"
        commands = {
            "import numpy, loadtxt": [sys.executable, "-c", read],
            "dashpot fit": [str(Path(sys.executable).with_name("dashpot")), "fit", str(file)],
            "dashpot --help": [str(Path(sys.executable).with_name("dashpot")), "--help"],
            "import click": [sys.executable, "-c", "import click"],
        }
        for command in commands.values():
            cpu_and_wall(command)
        runs = [
            {name: cpu_and_wall(command) for name, command in commands.items()}
            for _ in range(PAIRS)
        ]
    for name in commands:
        cpu, wall = (statistics.median(run[name][i] for run in runs) for i in (0, 1))
        print(f"{name:24} {cpu * 1e3:7.0f} ms CPU {wall * 1e3:7.0f} ms wall")
    for ours, theirs in (
        ("dashpot fit", "import numpy, loadtxt"),
        ("dashpot --help", "import click"),
    ):
        ratio = statistics.median(run[ours][0] / run[theirs][0] for run in runs)
        print(f"{ours} / ({theirs}): {ratio:.2f} in CPU time, median of {PAIRS} pairs")


if __name__ == "__main__":
    main()
