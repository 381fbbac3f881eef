"""From a cold process to a written report: CPU time, and how much of it the page takes.

The yardstick is an interpreter that imports matplotlib's figure and its SVG writer and draws
nothing. Targets: 1.5 s with a relaxation test alone, 5 s with a hammer test and the joint fit.

    python benchmarks/report.py [--rounds 7]
"""

from __future__ import annotations

import argparse
import statistics
import sys
import tempfile
import time
from pathlib import Path

from cold_start import cpu_and_wall

from dashpot.reading.write import write_impact, write_relaxation
from dashpot.report import html
from dashpot.simulation.impact import simulate_impact
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.solids.demo_seals import BROAD, BROAD_MASS
from dashpot.vibration.impact.frf_estimation import estimate_frf
from dashpot.workflow.job import BlockOnSeals
from dashpot.workflow.study import characterise


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=7)
    rounds = parser.parse_args().rounds
    dashpot = str(Path(sys.executable).with_name("dashpot"))
    hammer = simulate_impact(BROAD, mass=BROAD_MASS).test
    bench = simulate_relaxation(BROAD).test
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        (place / "seal.csv").write_text(write_relaxation(bench))
        (place / "hammer.csv").write_text(write_impact(hammer))
        common = [dashpot, "report", str(place / "seal.csv"), "-o", str(place / "report.html")]
        both = [str(place / "hammer.csv"), "--mass", f"{BROAD_MASS}kg", "--seals", "2"]
        draws = "import matplotlib.figure, matplotlib.backends.backend_svg"
        commands = {
            "relaxation alone": common,
            "with hammer, joint fit": [*common, *both],
            "import matplotlib": [sys.executable, "-c", draws],
        }
        for command in commands.values():  # compiles what is not compiled
            cpu_and_wall(command)
        for name, command in commands.items():
            spent = [cpu_and_wall(command)[0] for _ in range(rounds)]
            print(f"{name:24} {statistics.median(spent):5.2f} s CPU (least {min(spent):.2f})")
    frf = estimate_frf(hammer, mass=BROAD_MASS)
    study = characterise(bench, frf, impact=hammer, block=BlockOnSeals(BROAD_MASS, 2))
    spent = []
    for _ in range(rounds):
        start = time.process_time()
        page = html(study)
        spent.append(time.process_time() - start)
    size = len(page.encode()) / 1000
    print(f"{'the page of both':24} {statistics.median(spent):5.2f} s CPU, {size:.0f} kB")


if __name__ == "__main__":
    main()
