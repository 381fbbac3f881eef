"""How often the engine finds the global optimum with no start, over random truths.

Run: python benchmarks/global_optimum.py [truths]

Two families of ramp-and-hold records (1 s ramp, 40 s hold, 1 kHz, N = 1..4 arms, four noise
levels plus the quantum of a 16-bit force sensor): identifiable truths (tau in 0.05..20 s, ratio
at least 3) and wide ones (tau in 0.01..100 s, ratio at least 2: many arms cannot be told from
these records). The reference is the best of everything: the engine, thorough, the truth and 50
random starts. "Within 1e-6" means 1e-6 of the SSE, about 0.04 of a chi-square unit.
"""

from __future__ import annotations

import sys
import time

import numpy as np

from dashpot.numerics.design_matrices.recorded_motion import build_hold_block
from dashpot.numerics.exponential_fit import solve
from dashpot.numerics.log_tau_descent import Stack, descend

TIME = np.arange(40001) / 1000
QUANTUM = 1 / 1280
NOISE = (0.0, 1e-4, 1e-3, 5e-3)
RANDOM_STARTS = 50


def truth(generator: np.random.Generator, *, wide: bool) -> tuple[np.ndarray, np.ndarray]:
    arms = int(generator.integers(1, 5))
    low, high, ratio = (1e-2, 1e2, 2.0) if wide else (0.05, 20.0, 3.0)
    while True:
        tau = np.sort(np.exp(generator.uniform(np.log(low), np.log(high), arms)))
        if (tau[1:] >= ratio * tau[:-1]).all():
            return np.exp(generator.uniform(np.log(10), np.log(320), arms)), tau


def record(generator: np.random.Generator, k: np.ndarray, tau: np.ndarray) -> np.ndarray:
    mean = -np.expm1(-1 / tau) * tau
    force = 8e-3 * (196.5 + np.exp(-TIME[:, None] / tau) @ (k * mean))
    force += generator.choice(NOISE) * force.max() * generator.standard_normal(len(force))
    return np.round(force / QUANTUM) * QUANTUM


def best_of_random(stack: Stack, tau: np.ndarray, generator: np.random.Generator) -> float:
    """The smallest SSE with all coefficients positive from the truth and from random starts."""
    arms = len(tau)
    restricted = stack.get_nonnegative_mask(arms, signed=False)
    starts = [np.log(tau)]
    starts += [np.sort(generator.uniform(*stack.bounds, arms)) for _ in range(RANDOM_STARTS)]
    best = np.inf
    for start in starts:
        local = descend(stack, start)
        if local is not None and (local.point.beta[restricted] >= 0).all():
            best = min(best, local.point.sse)
    return best + stack.floor


def main(truths: int) -> None:
    print(f"{truths} truths each; fraction within 1e-9 / 1e-6 / 1e-3 of the best SSE known")
    for wide in (False, True):
        generator = np.random.default_rng(20 + wide)
        excess: dict[str, list[float]] = {"default": [], "thorough": []}
        spent = {"default": 0.0, "thorough": 0.0}
        evaluations = {"default": 0, "thorough": 0}
        arms = []
        for _ in range(truths):
            k, tau = truth(generator, wide=wide)
            block = build_hold_block(TIME, record(generator, k, tau), depth=8e-3, ramp_time=1.0)
            sse = {}
            for name in excess:
                start = time.thread_time()
                solution = solve([block], len(tau), thorough=name == "thorough")
                spent[name] += time.thread_time() - start
                evaluations[name] += solution.evaluations
                sse[name] = solution.sse
            best = min(best_of_random(Stack([block]), tau, generator), *sse.values())
            for name, value in sse.items():
                excess[name].append(value / best - 1)
            arms.append(len(tau))
        for name, values in excess.items():
            e = np.array(values)
            four = e[np.array(arms) == 4]
            share = " / ".join(f"{(e <= limit).mean():.4f}" for limit in (1e-9, 1e-6, 1e-3))
            print(
                f"{'wide' if wide else 'identifiable':13s} {name:9s} {share}   "
                f"N=4: {(four <= 1e-6).mean():.4f}   {evaluations[name] / truths:6.0f} trials  "
                f"{spent[name] / truths * 1e3:6.2f} ms CPU"
            )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1000)
