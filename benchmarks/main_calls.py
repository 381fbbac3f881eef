"""The main Python calls: read, fit, predict, compare, export and report, on the example files.

    python benchmarks/main_calls.py

Works in a temporary folder. ``main_commands.sh`` runs it after the main commands.
"""

from __future__ import annotations

import contextlib
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import dashpot as dp


def run_main_calls() -> None:
    """Go from two files to a report, by Python alone."""
    test, hits = dp.read("seal_8mm.csv"), dp.read("hammer.csv")
    time, displacement, force = np.loadtxt("seal_8mm.csv", delimiter=",", skiprows=2).T[:3]
    dp.RelaxationTest(time=time, displacement=displacement, force=force, units="s, mm, N")
    fit = dp.fit(test, arms=2)
    print(fit, fit.intervals(level=0.95), fit.verdict, fit.model.loss_factor(frequency="12.71Hz"))
    print(dp.fit(hits))
    joint = dp.fit(test, hits, mass="114.8g", seals=2)
    prediction = dp.predict(joint, mass="114.8g", seals=2, band=(1, 50))
    print(dp.compare(prediction, hits.frf()))
    dp.export(
        joint, "seal.bdf", to="nastran", unit_system="mm-t-s", temperature="23degC",
        length="50mm", band=(1, 20), allow="all",
    )  # fmt: skip
    dp.report(test, hits, mass="114.8g", seals=2).save("report.html")
    warm = dp.fit(dp.read("at_0degC.csv"), dp.read("at_23degC.csv"))
    print(warm.at(283.15))
    fit.save("fit.json")
    dp.plot.save(fit.plot(), "fit.png")
    print(dp.read("fit.json"), fit.to_pandas(), fit.checks, fit.facts)
    print(dp.simulate("relaxation", hold="10s"))
    Path("tests").mkdir()
    shutil.copy("seal_8mm.csv", "tests")
    print(dp.batch("tests/", to="lot", jobs=1))
    print("all main calls ran")


def main() -> None:
    """Write the example files to a temporary folder and run the calls there."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        demo = [sys.executable, "-m", "dashpot", "demo", "--files", "--all"]
        subprocess.run(demo, check=True, capture_output=True)
        run_main_calls()


if __name__ == "__main__":
    main()
