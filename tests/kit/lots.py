"""Lots whose rows were never fitted: their scatter is known, and no code of dashpot made it."""

from __future__ import annotations

import numpy as np
import polars as pl

import dashpot as dp

#: what every row has, as a test that nothing is wrong with
ROW = {
    "sha256": "", "hammer": "", "operator": "", "kind": "relaxation", "outcome": "fitted",
    "verdict": "use", "agreement": "", "reason": "", "failed_checks": "", "arms": 1,
    "temperature_K": 296.15, "depth_m": 0.008, "ramp_s": 2.0, "hold_s": 40.0,
    "k_inf_se_N_per_m": 0.5, "band_low_Hz": 0.004, "band_high_Hz": 0.32, "tau_1_s": 0.5,
}  # fmt: skip


def lot_of(rows):
    """Return a lot of rows, which need no more than what is their own."""
    made = [
        {**ROW, "file": f"{i:04}.csv", "lot": "", "seal": "", "repeat": "", **row}
        for i, row in enumerate(rows)
    ]
    return dp.Lot(pl.DataFrame(made, infer_schema_length=None).sort("file"), 0)


def draw_rows(
    lots=4, seals=25, repeats=4, *, sds=(0.02, 0.03, 0.01), mean=200.0, seed=0, operators=("",)
):
    """Return rows of tests that scatter, relative, between lots, seals and repeats."""
    rng = np.random.default_rng(seed)
    rows = []
    for lot in range(lots):
        of_lot = rng.normal(0, sds[0])
        for seal in range(seals):
            of_seal = rng.normal(0, sds[1])
            for repeat in range(repeats):
                k = mean * (1 + of_lot + of_seal + rng.normal(0, sds[2]))
                rows.append({
                    "lot": f"L{lot + 1}", "seal": f"{seal + 1}", "repeat": f"{repeat + 1}",
                    "file": f"L{lot + 1}/{seal + 1}_{repeat + 1}.csv",
                    "operator": operators[repeat % len(operators)], "k_end_N_per_m": k,
                    "k_inf_N_per_m": 0.98 * k, "k_0_N_per_m": 1.7 * k, "k_1_N_per_m": 0.72 * k,
                })  # fmt: skip
    return rows
