"""What dashpot says of the end of curves whose solid is known (`kit.foreign.curves`).

line = judged(curve)         # limits with the truth between them, the verdict, the plateau
Score.of(lines)              # shares of limits that hold, of "use" that is off, of sound kept
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

import dashpot as dp
from dashpot.extensions.curves.creep.fit import fit_creep
from dashpot.extensions.curves.dynamic.fit import fit_dynamic
from dashpot.extensions.curves.modulus.fit import fit_modulus

from .foreign.curves import Curve

#: a plateau that is wrong by more was extrapolated
OFF = 0.1
NAMES = {"k_end": 1.0, "k_3end": 3.0, "k_10end": 10.0, "k_inf": np.inf}


def fit_curve(curve: Curve) -> dp.Fit:
    """The fit of a curve, of no stated error."""
    if curve.kind == "curve":
        return fit_modulus(dp.RelaxationModulus(curve.at, curve.values, units="SI"))
    if curve.kind == "creep":
        return fit_creep(dp.CreepCompliance(curve.at, curve.values, unit="1/Pa", units="SI"))
    return fit_dynamic(dp.DynamicTest(curve.at, *curve.values, unit="Pa", units="SI"))


def evaluate_curve(curve: Curve) -> dict[str, object]:
    """The verdict, every limit with its truth, and how the plateau of the fit lies to the true."""
    fit = fit_curve(curve)
    end = fit.evidence.end_of_hold
    limits = {}
    if end is not None:
        for name, times in NAMES.items():
            low, high = getattr(end, name)
            limits[name] = (float(low), curve.truth(times), float(high))
    true = curve.truth(np.inf)
    return {
        "use": fit.verdict.use,
        "reason": [check.name for check in fit.verdict.failed_checks],
        "limits": limits,
        "off": bool(abs(fit.model.k_inf - true) > OFF * true),
        "settled": bool(curve.settled and true > 0),
    }


@dataclass(frozen=True)
class Score:
    """Counts: of limits that hold by their names, of "use", of those off, of sound ones kept."""

    count: int
    held: Mapping[str, float]
    used: int
    used_off: int
    faultless: int
    faultless_used: int

    @classmethod
    def of(cls, lines: Iterable[Mapping]) -> Score:
        lines = list(lines)
        requested = [line["limits"] for line in lines if line["limits"]]
        used = [line for line in lines if line["use"] == "use"]
        intact = [line for line in lines if line["settled"] and not line["off"]]
        held = {
            name: float(np.mean([_is_within(*limits[name]) for limits in requested]))
            if requested
            else 1.0
            for name in NAMES
        }
        return cls(
            len(lines), held, len(used), sum(line["off"] for line in used),
            len(intact), sum(line["use"] == "use" for line in intact),
        )  # fmt: skip


def _is_within(low: float, truth: float, high: float) -> bool:
    """But for rounding: curves without scatter are known to it."""
    slack = 1e-9 * truth
    return bool(low - slack <= truth <= high + slack)
