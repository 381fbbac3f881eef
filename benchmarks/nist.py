"""Correct digits on NIST's certified sums: dashpot with no start, scipy with NIST's.

Run: python benchmarks/nist.py

The digits of the worst parameter, capped at eleven, which is what the certificates have. scipy runs
`curve_fit` with its defaults from NIST's second start, the near one. The published data and
values are those of tests/numerics/test_sums.py.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np
from scipy.optimize import curve_fit

from dashpot.extensions.paper.exponential_sum import exponential_sum

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "numerics"))
from test_sums import CERTIFIED, LANCZOS_X, MGH17, MGH17_X, digits, parse_values

START = (0.5, 3.6, 4.0, 0.7, 4.2, 6.3)
MGH17_VALUES = (1.9358469127e00, -1.4646871366e00, 1.2867534640e-02, 2.2122699662e-02)
MGH17_CONSTANT = 3.7541005211e-01


def three(x: np.ndarray, *p: float) -> np.ndarray:
    return np.exp(-x[:, None] * np.array(p[3:])) @ np.array(p[:3])


def two(x: np.ndarray, *p: float) -> np.ndarray:
    return p[4] + np.exp(-x[:, None] * np.array(p[2:4])) @ np.array(p[:2])


def main() -> None:
    print(f"{'':10s} {'dashpot':>8s} {'ms':>7s} {'curve_fit':>10s}")
    for name, (table, amplitudes, rates, _, _) in CERTIFIED.items():
        y = parse_values(table)
        start = time.perf_counter()
        result = exponential_sum(LANCZOS_X, y, terms=3)
        spent = time.perf_counter() - start
        ours = digits(np.concatenate((result.amplitudes, result.rates)), (*amplitudes, *rates))
        rival = curve_fit(three, LANCZOS_X, y, START, maxfev=10_000)[0]
        theirs = digits(rival, (*amplitudes, *rates))
        print(f"{name:10s} {ours:8.1f} {spent * 1e3:7.2f} {theirs:10.1f}")
    y = parse_values(MGH17)
    start = time.perf_counter()
    result = exponential_sum(MGH17_X, y, terms=2, constant=True, signed=True)
    spent = time.perf_counter() - start
    certified = (*MGH17_VALUES, MGH17_CONSTANT)
    ours = digits(np.concatenate((result.amplitudes, result.rates, [result.constant])), certified)
    rival = curve_fit(two, MGH17_X, y, (1.5, -1.0, 0.01, 0.02, 0.5), maxfev=10_000)[0]
    print(f"{'MGH17':10s} {ours:8.1f} {spent * 1e3:7.2f} {digits(rival, certified):10.1f}")


if __name__ == "__main__":
    main()
