"""The engine against scipy in one run: CPU times, ratios, and whether both found one optimum.

Run: OMP_NUM_THREADS=1 python benchmarks/engine.py [--once]

The doors are `dashpot.fit` and `dashpot.batch` as a user calls them, on a record of the virtual
rig with hum, drift, encoder and delay: gate, priors, order, intervals, checks and bounds included;
rows without intervals are of the function behind `dashpot.fit`, which takes that choice alone.

Times are medians of thread CPU seconds. The rival is `scipy.optimize.least_squares` as it is
mostly used (trf, 2-point Jacobian, bounds >= 0, parameters k and tau in N/mm and s), twice: from
good starts (the truth, each parameter off by a random factor up to two) and from blind ones (k
log-uniform in 1e-3..10, tau in 1e-2..1e2), the median of each. dashpot gets no start. "cold" is
the first fit on a sampling, with nothing cached. With `--once` nothing is repeated, so that its
figures are rough, and the record of 3 million rows is left out.
"""

from __future__ import annotations

import sys
import time
import warnings
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.optimize import curve_fit, least_squares
from scipy.signal import lfilter

import dashpot
from dashpot.extensions.batch.arrays.batched_solver import solve_many
from dashpot.extensions.batch.arrays.shared_sampling import make_hold_family, make_recorded_family
from dashpot.fitting.relaxation import fit as fit_prepared
from dashpot.numerics import log_tau_descent as first_look
from dashpot.numerics.design_matrices import data_compression
from dashpot.numerics.design_matrices.recorded_motion import (
    build_hold_block,
    build_recorded_block,
    compute_arm_columns,
)
from dashpot.numerics.exponential_fit import Solution, solve

DEPTH = 8.0  # mm, so that k is in N/mm and both see numbers of order one
K_INF = 0.1965
TRUTH = {2: ((0.1175, 0.0178), (0.5021, 16.416)), 3: ((0.09, 0.04, 0.02), (0.25, 2.0, 18.0))}
NOISE = 0.0106
GENERATOR = np.random.default_rng(0)
ONCE = "--once" in sys.argv


def cpu(work: Callable[[], object], repeats: int) -> float:
    """Median thread CPU seconds of a call."""
    spent = []
    for _ in range(1 if ONCE else repeats):
        start = time.thread_time()
        work()
        spent.append(time.thread_time() - start)
    return float(np.median(spent))


def hold(seconds: np.ndarray, p: np.ndarray) -> np.ndarray:
    n = len(p) // 2
    k, tau = p[1 : n + 1], p[n + 1 :]
    force = p[0]
    for j in range(n):
        force = force + k[j] * -np.expm1(-1 / tau[j]) * tau[j] * np.exp(-seconds / tau[j])
    return DEPTH * force


def blind_start(arms: int) -> np.ndarray:
    """Stiffnesses log-uniform in 1e-3..10 N/mm, relaxation times in 1e-2..1e2 s."""
    k = GENERATOR.uniform(np.log(1e-3), np.log(10), arms + 1)
    tau = GENERATOR.uniform(np.log(1e-2), np.log(1e2), arms)
    return np.exp(np.concatenate((k, tau)))


class Rival(NamedTuple):
    good: float  # median CPU seconds from good starts
    blind: float  # from blind ones
    sse: float  # the best SSE of all


def rival(residual: Callable[[np.ndarray], np.ndarray], arms: int, starts: int) -> Rival:
    k, tau = TRUTH[arms]
    truth = np.array((K_INF, *k, *tau))
    good: list[float] = []
    blind: list[float] = []
    sse = []
    for _ in range(1 if ONCE else starts):
        for spent in (good, blind):
            if spent is good:
                start = truth * 2 ** GENERATOR.uniform(-1, 1, len(truth))
            else:
                start = blind_start(arms)
            begun = time.thread_time()
            result = least_squares(residual, start, bounds=(0, np.inf))
            spent.append(time.thread_time() - begun)
            sse.append(2 * result.cost)
    return Rival(float(np.median(good)), float(np.median(blind)), min(sse))


def row(
    name: str, ours: float, theirs: Rival, target: float | None = None, sse: float | None = None
) -> None:
    ratio = theirs.good / ours
    verdict = "" if target is None else f"   target {target:.0f}x: "
    if target is not None:
        verdict += "reached" if ratio >= target else "not reached"
    agree = "" if sse is None else f"  SSE {sse / theirs.sse - 1:+.0e}"
    print(
        f"{name:44s} {ours * 1e3:8.3f} {theirs.good * 1e3:9.1f} {ratio:6.0f}x"
        f" {theirs.blind * 1e3:9.1f} {theirs.blind / ours:6.0f}x"
        f"{verdict}{agree}"
    )


def single_holds() -> None:
    for rate, arms, target, starts in ((1000, 2, 50, 9), (10_000, 3, 300, 5)):
        seconds = np.arange(40 * rate + 1) / rate
        k, tau = TRUTH[arms]
        force = hold(seconds, np.array((K_INF, *k, *tau)))
        force = force + NOISE * GENERATOR.standard_normal(len(force))

        def fit(
            seconds: np.ndarray = seconds, force: np.ndarray = force, n: int = arms
        ) -> Solution:
            return solve([build_hold_block(seconds, force, depth=DEPTH, ramp_time=1.0)], n)

        def fresh(fit: Callable[[], Solution] = fit) -> Solution:
            data_compression.make_sample_plan.cache_clear()
            data_compression._piece.cache_clear()
            first_look._KEPT_LATTICES.clear()
            return fit()

        theirs = rival(lambda p, s=seconds, f=force: hold(s, p) - f, arms, starts)
        label = f"one fit, 41 s @ {rate // 1000} kHz, N = {arms}"
        row(label, cpu(fit, 101), theirs, target, fit().sse)
        row(label + ", cold", cpu(fresh, 7), theirs)


def batch() -> None:
    seconds = np.arange(40_001) / 1000
    for arms, target in ((2, 400), (3, None)):
        k, tau = TRUTH[arms]
        clean = hold(seconds, np.array((K_INF, *k, *tau)))
        forces = clean + NOISE * GENERATOR.standard_normal((200, len(clean)))
        family = make_hold_family(seconds, depth=DEPTH, ramp_time=1.0)
        ours = cpu(lambda f=family, y=forces, n=arms: solve_many(f, y, n), 5) / len(forces)
        plain = cpu(lambda y=forces: [values.sum() for values in y], 5) / len(forces)
        theirs = rival(lambda p, y=forces: hold(seconds, p) - y[0], arms, 5)
        many = solve_many(family, forces, arms)
        row(f"batch, per record, 1 kHz, N = {arms}", ours, theirs, target, float(many.sse[0]))
        verdict = "reached" if ours <= 15 * plain else "NOT reached"
        print(f"{'':44s} = {ours / plain:.1f} plain sums of its samples (target 15, {verdict})")


def compare_recorded_motion() -> None:
    seconds = np.arange(41_001) / 1000
    x = DEPTH * np.minimum(seconds, 1.0) + GENERATOR.normal(0, 1e-3, len(seconds))
    x[0] = 0.0
    k, tau = TRUTH[2]
    q, _ = compute_arm_columns(seconds, x, np.array(tau))
    force = K_INF * x + q @ np.array(k) + NOISE * GENERATOR.standard_normal(len(x))
    steps = np.diff(x, prepend=0.0)

    def residual(p: np.ndarray) -> np.ndarray:
        model = p[0] * x
        for stiffness, t in ((p[1], p[3]), (p[2], p[4])):
            a = np.exp(-1e-3 / t)
            model = model + stiffness * lfilter([(1 - a) * t / 1e-3], [1, -a], steps)
        return model - force

    def fit() -> Solution:
        return solve([build_recorded_block(seconds, x, force)], 2)

    theirs = rival(residual, 2, 7)
    row("any recorded history, 41k points, N = 2", cpu(fit, 41), theirs, 10, fit().sse)
    forces = force + 0.1 * NOISE * GENERATOR.standard_normal((64, len(force)))
    family = make_recorded_family(seconds, x)
    ours = cpu(lambda: solve_many(family, forces, 2), 3) / len(forces)
    row("  the same in a batch, per record", ours, theirs, 10)


def leastsq_of_lmfit(residual: Callable[[np.ndarray], np.ndarray], start: np.ndarray) -> float:
    """The SSE that lmfit's default ends at, every parameter kept >= 0."""
    import lmfit

    parameters = lmfit.Parameters()
    for i, value in enumerate(start):
        parameters.add(f"p{i}", value=value, min=0)
    solution = lmfit.minimize(
        lambda p: residual(np.array(list(p.valuesdict().values()))), parameters
    )
    return float(solution.chisqr)


def compare_other_solvers(starts: int = 1 if ONCE else 20) -> None:
    """What else people fit with, from blind starts: the optimum found, and the time it took."""
    seconds = np.arange(40_001) / 1000
    for arms in (2, 3):
        k, tau = TRUTH[arms]
        force = hold(seconds, np.array((K_INF, *k, *tau)))
        force = force + NOISE * GENERATOR.standard_normal(len(force))
        best = solve([build_hold_block(seconds, force, depth=DEPTH, ramp_time=1.0)], arms).sse

        def residual(p: np.ndarray, force: np.ndarray = force) -> np.ndarray:
            return hold(seconds, p) - force

        def run_curve_fit(start: np.ndarray, force: np.ndarray = force) -> float:
            result = curve_fit(lambda s, *p: hold(s, np.array(p)), seconds, force, start)[0]
            return float(np.square(hold(seconds, result) - force).sum())

        methods = {
            "curve_fit": run_curve_fit,
            "least_squares (trf, >= 0)": lambda start, residual=residual: float(
                2 * least_squares(residual, start, bounds=(0, np.inf)).cost
            ),
            "lmfit (leastsq, >= 0)": lambda start, r=residual: leastsq_of_lmfit(r, start),
        }
        for name, method in methods.items():
            hits, spent = 0, []
            for _ in range(starts):
                begun = time.thread_time()
                try:
                    with np.errstate(all="ignore"), warnings.catch_warnings():
                        warnings.simplefilter("ignore")
                        sse = method(blind_start(arms))
                except ImportError:
                    print(f"  {name}: not installed")
                    break
                except (RuntimeError, ValueError):
                    sse = np.inf
                spent.append(time.thread_time() - begun)
                hits += sse < best * (1 + 1e-6)
            else:
                print(
                    f"  N = {arms}  {name:28s} optimum from {hits:2d} of {starts} blind starts,"
                    f" {1e3 * np.median(spent):7.0f} ms each"
                )


def doors() -> None:
    """The public functions, beside scipy's optimum alone, from good starts, on the same record."""
    seal = dashpot.GeneralizedMaxwell(1e3 * K_INF, tuple(1e3 * np.array(TRUTH[2][0])), TRUTH[2][1])
    test = dashpot.simulation.simulate_relaxation(seal, seed=1).test
    record = test.prepare()
    rows, since = len(record.time), record.time - record.time[0]
    x = 1e3 * record.displacement

    def record_residual(p: np.ndarray) -> np.ndarray:
        q, _ = compute_arm_columns(since, x, p[3:], derivative=False)
        return p[0] * x + q @ p[1:3] - record.force

    theirs = rival(record_residual, 2, 3)
    held = record.force[record.settled_samples]
    after = record.time[record.settled_samples] - record.ramp_end
    of_hold = rival(lambda p: hold(after, p) - held, 2, 5)
    for method, target, other in (("hold", (5, 25), of_hold), ("full", (10, 45), theirs)):
        call = partial(dashpot.fit, record, method=method)
        bare = partial(fit_prepared, record, method=method, arms=2, intervals=False)
        point = cpu(bare, 9)
        door(f"fit {method}, {rows} rows, N = 2, no intervals", point, other, target[0])
        for arms in (2, 1, 3, 4, 6, "auto"):
            label = f"fit {method}, N = {arms}, intervals and checks"
            door(label, cpu(lambda call=call, n=arms: call(arms=n), 5), other, target[1])
    many_doors()
    if ONCE:
        return
    rows = 3_000_000
    seconds = np.linspace(0, 41, rows)
    motion = 8e-3 * np.clip(seconds - 0.5, 0, 1)
    force = seal.force(seconds, motion) + 3e-3 * GENERATOR.standard_normal(rows)
    test = dashpot.RelaxationTest(time=seconds, displacement=motion, force=force, units="SI")
    print(f"{'prepare, 3 M rows':44s} {1e3 * cpu(test.prepare, 1):8.0f}")
    record = test.prepare()
    print(f"{'fit full, the same':44s} {1e3 * cpu(lambda: dashpot.fit(record, arms=2), 3):8.0f}")


def many_doors() -> None:
    seconds = np.arange(41_001) / 1000
    clean = hold(seconds, np.array((K_INF, *TRUTH[2][0], *TRUTH[2][1])))
    forces = clean + NOISE * GENERATOR.standard_normal((200, len(clean)))
    theirs = rival(lambda p: hold(seconds, p) - forces[0], 2, 5)
    time = np.concatenate(([0.0], 1 + seconds))
    forces = np.concatenate((np.zeros((200, 1)), forces), axis=1)
    for count, target in ((1, 2.0), (200, 0.12)):
        for errors in (False, True):

            def call(count: int = count, errors: bool = errors) -> object:
                how = {"ramp": (8e-3, 1.0), "method": "hold", "errors": errors}
                return dashpot.batch(forces[:count], time=time, units="SI", **how)

            label = f"batch, hold, R = {count}, {'errors' if errors else 'no errors'}, per record"
            door(label, cpu(call, 9) / count, theirs, target * (1 + errors))


def door(name: str, ours: float, theirs: Rival, target: float) -> None:
    verdict = "reached" if 1e3 * ours <= target else "not reached"
    print(
        f"{name:52s} {1e3 * ours:8.2f} ms (target {target:g}: {verdict})"
        f"   scipy's optimum alone {1e3 * theirs.good:7.1f} ms, {theirs.good / ours:5.1f}x"
    )


if __name__ == "__main__":
    if ONCE:
        print("each once, the first time: rough figures, and targets that say little")
    print(f"{'':44s} {'ours ms':>8s} {'good ms':>9s} {'ratio':>7s} {'blind ms':>9s} {'ratio':>7s}")
    single_holds()
    batch()
    compare_recorded_motion()
    compare_other_solvers()
    doors()
