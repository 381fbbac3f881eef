"""Public Python functions for compression load deflection."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from dashpot.api.fit import identify_record_kinds
from dashpot.base.units import Quantity, Range, si_range
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.machine import Machine
from dashpot.extensions.materials.cld.fit_files import CLDResult


def fit_load_deflection(
    records: list[Any],
    *,
    compression: Quantity | None = None,
    compression_limits: Range | None = None,
    force_limits: Range | None = None,
    relaxation: Fit | Sequence[Fit] = (),
    cycle: int | None = None,
    machine: Machine | None = None,
) -> CLDResult:
    """Evaluate tests of load over deflection."""
    from dashpot.extensions.materials.cld.fit_files import evaluate_cld

    return evaluate_cld(
        records,
        nominal_compression=compression,
        tolerance_limits=compression_limits,
        limits=si_range(force_limits, "force"),
        relaxation=[relaxation] if isinstance(relaxation, Fit) else list(relaxation),
        cycle=cycle,
        names=list(identify_record_kinds(records)),
        machine=machine,
    )
