"""Speed on anybody's records, and whether their bounds hold: none is of dashpot's own rig.

    python benchmarks/anybody.py [--records 200] [--seed 0] [--files DIR]

The sound records of `tests/kit/foreign`: 1 to 6 arms, fractional, power law and slower than the
hold, 250 Hz to 10 kHz, ramps of .05 to 5 s, noise white, slow or hum; then every file of a folder
that is a relaxation test. Each goes through every door: its text read, beside pandas in turn;
prepared; fitted by the hold and by the whole record, with arms sought, as many as are there and one
too many, with and without intervals; the limits of the response of a mass. Beside the fit of the
hold with as many arms as are there stands what `scipy.optimize.least_squares` takes for the optimum
of eq. 5 alone, from a start that is off by up to a factor of two. CPU time, the least of three; a
bound holds if the truth lies within it.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TypeVar

import numpy as np
import pandas as pd
from scipy.optimize import least_squares

import dashpot as dp
from dashpot.fitting.relaxation import fit
from dashpot.preprocessing.prepare import prepare

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from kit.foreign.catalogue import relaxation_records
from kit.foreign.rigs import Record

T = TypeVar("T")
DEAR = 1000.0
"""ms, above which a call is not timed again."""
MOST_ARMS = 8
BLOCK = 0.1
"""kg, under which the response is predicted."""


def spent_by(run: Callable[[], T]) -> tuple[T, float]:
    """What a call returns, and its CPU time, ms: the least of three."""
    spent = []
    for _ in range(3):
        start = time.process_time()
        process = run()
        spent.append(1e3 * (time.process_time() - start))
        if spent[-1] > DEAR:
            break
    return process, min(spent)


def fit_plain_optimum(record: dp.RampHold, solid: dp.GeneralizedMaxwell, seed: int) -> None:
    """What SciPy takes for k_inf, k and tau of eq. 5 and nothing else."""
    since = record.time[record.settled_samples] - record.ramp_end
    force, ramp, depth = record.force[record.settled_samples], record.ramp_time, record.depth
    arms, truth = len(solid.k), np.array((solid.k_inf, *solid.k, *solid.tau))

    def residual(p: np.ndarray) -> np.ndarray:
        k, tau = p[1 : arms + 1], p[arms + 1 :]
        result = p[0] - force / depth
        for value, individual in zip(k, tau, strict=True):
            result = result - value * np.expm1(-ramp / individual) * individual / ramp * np.exp(
                -since / individual
            )
        return result

    start = truth * 2 ** np.random.default_rng(seed).uniform(-1, 1, len(truth))
    least_squares(residual, start, bounds=(0, np.inf), x_scale=start)


def hold_truth(record: Record, result: dp.Fit, hold: float) -> dict[str, bool]:
    """Which 95 % limits hold the truth; those of single arms where it has as many.

    `hold`, s, is the T of k(T) as the record was understood: a rounded ramp ends where one says.
    """
    solid, inside = record.seal.solid, {}
    if result.stiffness_limits is not None:
        for name, times in (("k_end", 1), ("k_3end", 3), ("k_inf", np.inf)):
            low, high = result.stiffness_limits[name]
            inside[f"{name} left open"] = low <= record.seal.secant(times * hold) <= high
    bounds = result.intervals()
    inside["k_inf"] = bounds["k_inf"][0] <= solid.k_inf <= bounds["k_inf"][1]
    if result.model.arms == len(solid.k):
        for name in ("k", "tau"):
            pairs = zip(getattr(solid, name), bounds[name], strict=True)
            inside[f"{name} of as many arms"] = all(low <= v <= high for v, (low, high) in pairs)
    return inside


@dataclass
class Tally:
    """What a door cost, and what it said."""

    spent: list[tuple[float, str]] = field(default_factory=list)
    bounds: dict[str, list[bool]] = field(default_factory=dict)
    uses: Counter[str] = field(default_factory=Counter)

    def line(self, door: str) -> str:
        ms = [value for value, _ in self.spent]
        least, middle, late, most = np.quantile(ms, [0, 0.5, 0.95, 1])
        row = f"{door:26} {len(ms):4} {least:8.1f} {middle:8.1f} {late:8.1f} {most:8.1f}"
        return f"{row}  {max(self.spent)[1]}"


class Doors:
    """Every door, and what each record cost there."""

    def __init__(self, folder: Path) -> None:
        self.tallies: dict[str, Tally] = {}
        self.folder = folder

    def through(self, door: str, name: str, run: Callable[[], T]) -> T | None:
        """Take a record through a door."""
        tally = self.tallies.setdefault(door, Tally())
        try:
            result, ms = spent_by(run)
        except dp.DashpotError as error:
            tally.uses["refused"] += 1
            print(f"{door}: {name}: {error}", file=sys.stderr)
            return None
        tally.spent.append((ms, name))
        return result

    def text(self, path: Path, name: str) -> dp.RelaxationTest | None:
        """Read a file, and let pandas read it."""
        read = self.through("read", name, lambda: dp.read(path, kind="relaxation"))
        if read is not None and path.suffix == ".csv" and path.parent == self.folder:
            self.through("pandas.read_csv", name, lambda: pd.read_csv(path))
        return read

    def record(self, test: dp.RelaxationTest, name: str, truth: Record | None = None) -> None:
        """Take a test through all doors behind its file."""
        record = self.through("prepare", name, lambda: prepare(test))
        if record is None:
            return
        there = len(truth.seal.solid.k) if truth is not None else 2
        for method in ("hold", "full"):
            for words, arms in (
                ("auto", "auto"), ("as many arms", there), ("one arm more", there + 1)
            ):  # fmt: skip
                if arms != "auto" and not 1 <= arms <= MOST_ARMS:
                    continue
                run = partial(fit, record, method=method, arms=arms)
                door = f"{method}, {words}"
                through = self.through(door, name, run)
                if truth is not None and method == "hold" and arms == len(truth.seal.solid.k):
                    single = partial(fit_plain_optimum, record, truth.seal.solid, len(record.time))
                    self.through(f"{door}, SciPy's optimum alone", name, single)
                self.through(f"{door}, point", name, partial(run, intervals=False))
                if through is None:
                    continue
                tally = self.tallies[door]
                tally.uses[through.verdict.use] += 1
                if truth is not None and arms == "auto":
                    for bound, inside in hold_truth(truth, through, record.hold_time).items():
                        tally.bounds.setdefault(bound, []).append(inside)
                if (method, arms) == ("full", "auto"):
                    self.through(
                        "limits of the response", name,
                        partial(dp.predict, through, mass=BLOCK, record=record),
                    )  # fmt: skip

    def lines(self) -> list[str]:
        head = f"{'CPU ms':26} {'n':>4} {'min':>8} {'median':>8} {'p95':>8} {'max':>8}  dearest"
        result = [head, *(tally.line(door) for door, tally in self.tallies.items() if tally.spent)]
        read, other = (self.tallies.get(item) for item in ("read", "pandas.read_csv"))
        if read and other:
            by_name = {name: ms for ms, name in other.spent}
            ratios = [ms / by_name[name] for ms, name in read.spent if name in by_name]
            result.append(f"read / pandas: median {np.median(ratios):.2f}, most {max(ratios):.2f}")
        ours, other = (
            self.tallies.get(f"hold, as many arms{which}")
            for which in ("", ", SciPy's optimum alone")
        )
        if ours and other:
            by_name = {name: ms for ms, name in other.spent}
            ratios = [by_name[name] / ms for ms, name in ours.spent if name in by_name]
            result.append(f"SciPy's optimum alone / our whole fit: median {np.median(ratios):.1f}")
        for door, tally in self.tallies.items():
            if tally.uses:
                text = ", ".join(f"{use} {count}" for use, count in tally.uses.most_common())
                result.append(f"{door}: {text}")
            result += [
                f"  {name:24} holds {sum(h):3} of {len(h)}" for name, h in tally.bounds.items()
            ]
        return result


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--records", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--files", type=Path, help="a folder of measured tests")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        doors = Doors(Path(folder))
        for record in relaxation_records(options.records, options.seed):
            name = f"{record.name}, {len(record.time)} rows"
            path = Path(folder) / "record.csv"
            rows = np.column_stack([record.time, 1e3 * record.displacement, record.force])
            np.savetxt(
                path, rows, "%.6f", ",", header="time [s],displacement [mm],force [N]", comments=""
            )
            doors.text(path, name)
            doors.record(
                dp.RelaxationTest(record.time, record.displacement, record.force, units="SI"),
                name,
                record,
            )
        for path in sorted(options.files.rglob("*")) if options.files else ():
            try:
                expected = path.is_file() and dp.inspect(path).kind == "relaxation"
            except dp.DashpotError:
                continue
            test = doors.text(path, path.name) if expected else None
            if test is not None:
                doors.record(test, path.name)
        print("\n".join(doors.lines()))


if __name__ == "__main__":
    main()
