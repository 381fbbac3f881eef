"""Lot row of a curve."""

from __future__ import annotations

from typing import Any

import numpy as np

from dashpot.extensions.curves.datamodel.creep import CreepCompliance, LoadHold
from dashpot.extensions.curves.datamodel.dynamic import DynamicTest
from dashpot.extensions.curves.datamodel.modulus import RelaxationModulus
from dashpot.reading.columns.kind_detection import MASTER_CURVE_DECADES


def list_load_columns(record: LoadHold) -> dict[str, Any]:
    """Return the number of samples and the times of a creep test."""
    times = {"ramp_s": record.ramp_time, "hold_s": record.hold_time}
    return {"samples": len(record.time)} | times


def list_curve_columns(record: CreepCompliance | RelaxationModulus) -> dict[str, Any]:
    """Return the number of samples of a curve over time, and its end."""
    return {"samples": len(record.time), "hold_s": record.time[-1]}


def list_sweep_columns(record: DynamicTest) -> dict[str, Any]:
    """Return the number of samples of a sweep, and its kind if it is a master curve."""
    is_wide_band = (
        np.log10(np.max(record.frequency) / np.min(record.frequency)) >= MASTER_CURVE_DECADES
    )
    shifted = {"kind": "master-curve"} if is_wide_band else {}
    return shifted | {"samples": len(record.frequency)}
