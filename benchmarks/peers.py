"""What dashpot is measured against: one table of one run, for docs/performance.md.

    pip install lmfit pyvisco pyFRF sdypy-EMA polars pyarrow && python benchmarks/peers.py [--write]

Each row does one job by dashpot and by a peer on the same data, in turns: CPU time of one process
(median), and one number of how good the answer is. dashpot gets no start anywhere; the peers get
what is said in the row. A peer that is not installed has no row. With `--write` the table goes into
docs/performance.md between its two marks. The single benchmarks beside this one go deeper.
"""

from __future__ import annotations

import platform
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import NamedTuple

import engine
import frf_peers
import master_curves
import modal_peers
import msgspec  # noqa: F401  a session that has read before has it
import nist
import numpy as np
from scipy.optimize import curve_fit, least_squares

import dashpot as dp
from dashpot.extensions.curves.dynamic.read import read_dynamic
from dashpot.extensions.curves.relaxation_spectrum import dynamic_master_curve, master_curve
from dashpot.extensions.paper.exponential_sum import exponential_sum
from dashpot.numerics.design_matrices.recorded_motion import build_hold_block
from dashpot.numerics.exponential_fit import solve
from dashpot.reading.readers.relaxation import read_relaxation
from dashpot.vibration.impact.frf_estimation import estimate_frf
from dashpot.vibration.mass_on_seals import model_modes

ROOT = Path(__file__).resolve().parents[1]
CURVES = ROOT / "tests" / "data" / "pyvisco-master-curves"
PAGE = ROOT / "docs" / "performance.md"
MARKS = ("<!-- peers: benchmarks/peers.py --write -->\n", "<!-- end of peers -->\n")
STARTS = 20
SEAL = frf_peers.PAPER


class Row(NamedTuple):
    """One job, done twice."""

    job: str
    peer: str
    ours: float | None  # CPU time, ms
    theirs: float | None
    good: str  # what the numbers behind say
    our_good: str
    their_good: str

    def cells(self) -> list[str]:
        both = self.ours is not None and self.theirs is not None
        times = ["" if item is None else digits(item) for item in (self.ours, self.theirs)]
        ratio = digits(self.theirs / self.ours) if both else ""
        return [self.job, self.peer, *times, ratio, self.good, self.our_good, self.their_good]


def digits(value: float, sign: str = "") -> str:
    """Two digits, without an exponent."""
    return f"{float(f'{value:.2g}'):{sign}g}"


def percent(error: float) -> str:
    return f"{digits(100 * error, '+')} %"


def spent(run: Callable[[], object], repeats: int) -> tuple[object, float]:
    """The last result, and the median CPU time in ms."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        process = run()
        times.append(1e3 * (time.process_time() - start))
    return process, float(np.median(times))


def reading() -> Iterator[Row]:
    made = dp.simulation.simulate_relaxation(SEAL, seed=1)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "seal.csv"
        path.write_text(dp.files.write_relaxation(made.test), "utf-8")
        rows = len(made.test.time)
        _, ours = spent(lambda: read_relaxation(path), 9)
        readers: dict[str, Callable[[], object]] = {
            "numpy.loadtxt": lambda: np.loadtxt(path, delimiter=",", skiprows=1),
        }
        with suppress(ImportError):
            import pandas as pd

            readers["pandas.read_csv"] = lambda: pd.read_csv(path)
        with suppress(ImportError):
            import polars as pl

            readers["polars.read_csv"] = lambda: pl.read_csv(path, comment_prefix="#")
        with suppress(ImportError):
            from pyarrow import csv

            readers["pyarrow.csv"] = lambda: csv.read_csv(path)
        for name, reader in readers.items():
            _, theirs = spent(reader, 9)
            job = f"read {rows:,} rows of text"
            yield Row(job, name, ours, theirs, "roles, units, clock", "found and checked", "none")


def holds() -> Iterator[Row]:
    """The hold of eq. (5), two arms; the peers from blind starts."""
    seconds = np.arange(40_001) / 1000
    k, tau = engine.TRUTH[2]
    force = engine.hold(seconds, np.array((engine.K_INF, *k, *tau)))
    force = force + engine.NOISE * engine.GENERATOR.standard_normal(len(force))
    block = build_hold_block(seconds, force, depth=engine.DEPTH, ramp_time=1.0)
    result, ours = spent(lambda: solve([block], 2), 51)

    def residual(p: np.ndarray) -> np.ndarray:
        return engine.hold(seconds, p) - force

    def run_curve_fit(start: np.ndarray) -> float:
        best = curve_fit(lambda s, *p: engine.hold(s, np.array(p)), seconds, force, start)[0]
        return float(np.square(residual(best)).sum())

    def run_least_squares(start: np.ndarray) -> float:
        return float(2 * least_squares(residual, start, bounds=(0, np.inf)).cost)

    methods: dict[str, Callable[[np.ndarray], float]] = {
        "scipy curve_fit": run_curve_fit,
        "scipy least_squares": run_least_squares,
        "lmfit": lambda start: engine.leastsq_of_lmfit(residual, start),
    }
    for name, method in methods.items():
        hits, times = 0, []
        for _ in range(STARTS):
            begun = time.process_time()
            try:
                with np.errstate(all="ignore"), warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    sse = method(engine.blind_start(2))
            except ImportError:
                break
            except (RuntimeError, ValueError):
                sse = np.inf
            times.append(1e3 * (time.process_time() - begun))
            hits += sse < result.sse * (1 + 1e-6)
        if times:
            yield Row(
                "fit a hold, 2 arms, 40,001 samples", name, ours, float(np.median(times)),
                f"optimum found from {STARTS} blind starts", "no start needed", f"{hits} times",
            )  # fmt: skip


def intervals() -> Iterator[Row]:
    """Limits of every parameter of a hold; those of lmfit are of white noise alone."""
    with suppress(ImportError):
        from lmfit import Minimizer, Parameters, conf_interval

        made = dp.simulation.simulate_relaxation(SEAL, seed=1).test.prepare()
        _, ours = spent(lambda: dp.fit(made, arms=2, method="hold"), 5)
        held = made.time >= made.ramp_end
        seconds, force = made.time[held] - made.ramp_end, made.force[held]
        k, tau = engine.TRUTH[2]
        names = ("k_inf", *(f"k{j}" for j in range(2)), *(f"tau{j}" for j in range(2)))
        start = Parameters()
        for name, value in zip(names, (engine.K_INF, *k, *tau), strict=True):
            start.add(name, value=1.2 * value, min=0.0)

        def residual(p: Parameters) -> np.ndarray:
            return engine.hold(seconds, np.array([p[name].value for name in names])) - force

        def limits() -> object:
            minimizer = Minimizer(residual, start)
            return conf_interval(minimizer, minimizer.minimize(method="leastsq"), sigmas=[1.96])

        _, theirs = spent(limits, 1)
        yield Row(
            f"limits of a hold, 2 arms, {len(force):,} samples", "lmfit conf_interval, good start",
            ours, theirs, "what they hold", "correlated noise, drift, rig", "white noise",
        )  # fmt: skip


def compare_nist_sums() -> Iterator[Row]:
    """NIST's sums of exponentials; curve_fit from NIST's own near start."""
    for name in ("Lanczos1", "Lanczos2", "Lanczos3"):
        table, amplitudes, rates, _, _ = nist.CERTIFIED[name]
        y, truth = nist.parse_values(table), (*amplitudes, *rates)
        result, ours = spent(lambda y=y: exponential_sum(nist.LANCZOS_X, y, terms=3), 5)
        rival, theirs = spent(
            lambda y=y: curve_fit(nist.three, nist.LANCZOS_X, y, nist.START, maxfev=10_000)[0], 5
        )
        good = (
            nist.digits(np.concatenate((result.amplitudes, result.rates)), truth),
            nist.digits(rival, truth),
        )
        texts = [f"{item:.1f}" for item in good]
        yield Row(f"NIST {name}", "scipy curve_fit", ours, theirs, "correct digits", *texts)


def rms(error: np.ndarray) -> str:
    return f"{digits(100 * float(np.sqrt(np.mean(np.square(error)))))} %"


def curves() -> Iterator[Row]:
    """Master curves over 31 and 26 decades; the terms of an FE code come with the data."""
    t, modulus = np.loadtxt(CURVES / "time_user_master.csv", delimiter=",", skiprows=2).T
    result, ours = spent(lambda: master_curve(t, modulus, per_decade=4), 5)
    our_good = rms(result.model.relaxation(t) / modulus - 1)
    job = "Prony terms of a modulus over 31 decades"
    terms = np.loadtxt(CURVES / "ansys-reference" / "prony_terms_KPf_MD.csv", delimiter=",")
    code = rms(1739.03 * master_curves.prony_time(t, terms) / modulus - 1)
    yield Row(job, "a commercial FE code", ours, None, "rms misfit", our_good, code)
    theirs = run_quietly(
        lambda: master_curves.pyvisco_terms(CURVES / "time_user_master.csv", "time")
    )
    if theirs is not None:
        e_0, terms, ms = theirs
        misfit = rms(e_0 * master_curves.prony_time(t, terms) / modulus - 1)
        yield Row(job, "pyvisco", ours, ms, "rms misfit", our_good, misfit)
    data = read_dynamic(CURVES / "freq_user_master.csv")
    result, ours = spent(lambda: dynamic_master_curve(data, per_decade=4), 5)
    value = result.model.complex_stiffness(omega=data.omega)
    theirs = run_quietly(
        lambda: master_curves.pyvisco_terms(CURVES / "freq_user_master.csv", "freq")
    )
    if theirs is not None:
        e_0, terms, ms = theirs
        _, loss = master_curves.prony_frequency(data.omega, terms)
        job = "Prony terms of storage and loss over 26 decades"
        good = (rms(value.imag / data.loss - 1), rms(1e6 * e_0 * loss / data.loss - 1))
        yield Row(job, "pyvisco", ours, ms, "rms misfit of the loss", *good)


def run_quietly(run: Callable[[], object]) -> object:
    return frf_peers.quietly(run)


def hammers() -> Iterator[Row]:
    """The damping ratio of Table 1's seal, 0.44 %, out of hits of two seconds."""
    seal, mass = frf_peers.SEALS["paper"]
    (true,) = model_modes(2 * seal, mass)
    test, force, response = frf_peers.hits("paper", 2.0)
    mode, ours = spent(lambda: estimate_frf(test).modes()[0], 9)
    off = percent(mode.damping_ratio / true.damping_ratio - 1)
    force, response = map(frf_peers.without_offset, (force, response))
    job, good = "damping ratio from hits cut at 2 s", "its error"
    if frf_peers.HAVE_PYFRF:
        window = ("exponential:0.01", "exponential:0.01")
        (f, value, _), theirs = spent(lambda: frf_peers.pyfrf(force, response, window), 9)
        ratio = frf_peers.half_power(f, value)[1] / true.damping_ratio - 1
        name = "pyFRF, exponential window, half power"
        yield Row(job, name, ours, theirs, good, off, percent(ratio))
    if frf_peers.HAVE_PYFRF and frf_peers.HAVE_EMA:
        f, value, _ = frf_peers.pyfrf(force, response, "none")
        (_, ratio), theirs = spent(lambda: frf_peers.poles_by_ema(f, value), 3)
        name = "pyFRF and sdypy-EMA, pole picked nearest to the truth"
        message = percent(ratio / true.damping_ratio - 1)
        yield Row(job, name, ours, theirs, good, off, message)
    (f, value), theirs = spent(lambda: frf_peers.scipy_default(force, response), 9)
    ratio = frf_peers.half_power(f, value)[1] / true.damping_ratio - 1
    yield Row(job, "scipy csd / welch, half power", ours, theirs, good, off, percent(ratio))


def shapes(draws: int = 8) -> Iterator[Row]:
    """Two modes 2 % apart at four points; the peer's poles are those nearest to the truth."""
    if not frf_peers.HAVE_EMA:
        return
    name = "2 %, broad"
    sums = [{"f": [], "damping": [], "mac": [], "time": []} for _ in range(2)]
    for seed in range(draws):
        points = modal_peers.four_points(name, seed)
        modal_peers.errors_of(modal_peers.shapes_by_dashpot(points)[0], name, sums[0])
        near = [hz for hz, *_ in modal_peers.FOUR[name]]
        modal_peers.errors_of(modal_peers.shapes_by_ema(points, near), name, sums[1])
    ours, theirs = (1e3 * float(np.median(entry["time"])) for entry in sums)
    good = [rms(np.array(entry["damping"])) for entry in sums]
    job = "two modes 2 % apart at four points"
    yield Row(job, "sdypy-EMA, poles picked nearest to the truth", ours, theirs,
              "rms error of damping", *good)  # fmt: skip


def batches() -> Iterator[Row]:
    """Two hundred holds, with intervals; the peer has none."""
    seconds = np.arange(41_001) / 1000
    k, tau = engine.TRUTH[2]
    clean = engine.hold(seconds, np.array((engine.K_INF, *k, *tau)))
    forces = clean + engine.NOISE * engine.GENERATOR.standard_normal((200, len(clean)))
    theirs = engine.rival(lambda p: engine.hold(seconds, p) - forces[0], 2, 5)
    at = np.concatenate(([0.0], 1 + seconds))
    forces = np.concatenate((np.zeros((200, 1)), forces), axis=1)
    _, ours = spent(
        lambda: dp.batch(forces, time=at, units="SI", ramp=(8e-3, 1.0), method="hold", errors=True),
        3,
    )
    yield Row("fit 200 holds, each", "scipy least_squares, from good starts", ours / 200,
              1e3 * theirs.good, "standard errors", "with", "without")  # fmt: skip


def table(rows: list[Row]) -> str:
    head = ["job", "peer", "dashpot, ms", "peer, ms", "ratio", "what counts", "dashpot", "peer"]
    lines = [head, ["---"] * 2 + ["--:"] * 3 + ["---"] * 3, *(row.cells() for row in rows)]
    return "".join("| " + " | ".join(line) + " |\n" for line in lines)


def versions() -> str:
    message = [f"Python {platform.python_version()}"]
    for name in (
        "numpy",
        "scipy",
        "pandas",
        "polars",
        "pyarrow",
        "lmfit",
        "pyvisco",
        "pyFRF",
        "sdypy-EMA",
    ):
        try:
            message.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            message.append(f"no {name}")
    return ", ".join(message)


def main() -> None:
    jobs = (reading, holds, intervals, batches, compare_nist_sums, curves, hammers, shapes)
    message = table([row for job in jobs for row in job()]) + f"\nOne run with {versions()}.\n"
    sys.stdout.write(message)
    if "--write" in sys.argv:
        before, _, rest = PAGE.read_text("utf-8").partition(MARKS[0])
        after = rest.partition(MARKS[1])[2]
        PAGE.write_text(f"{before}{MARKS[0]}\n{message}\n{MARKS[1]}{after}", "utf-8")


if __name__ == "__main__":
    main()
