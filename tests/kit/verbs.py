"""The public functions, and what each is done by for the records that it is given."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import dashpot as dp
from dashpot.api.plan_simulate import simulate
from dashpot.api.predict_compare import (
    _compare_frfs,
    _compare_with_measurement,
    _predict_solid_frf,
    _predict_under_mass,
)
from dashpot.registry import FITS, KINDS

FUNCTIONS = [
    getattr(dp, name)
    for name in (
        "batch", "compare", "export", "fit", "inspect", "plan", "predict", "read", "report",
        "save", "simulate",
    )
]  # fmt: skip
CASES: dict[str, list[str | Callable[..., Any]]] = {
    "fit": [*(row.records for row in FITS.values()), *(kind.fits for kind in KINDS.values())],
    "predict": [
        *(kind.predict for kind in KINDS.values()),
        "dashpot.extensions.dynamic_stiffness.prediction:predict_stiffness",
        "dashpot.extensions.materials.drop.prediction:predict_drop",
        "dashpot.extensions.systems.door.api:predict_door",
        _predict_under_mass,
        _predict_solid_frf,
    ],
    "compare": [
        _compare_frfs,
        _compare_with_measurement,
        "dashpot.extensions.batch.api:compare_lots",
    ],
    "simulate": [simulate],
}
