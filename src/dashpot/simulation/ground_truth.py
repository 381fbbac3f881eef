"""Ground truth of a simulated file, written beside it."""

from __future__ import annotations

import json
import math
from dataclasses import fields, is_dataclass
from typing import Any, TypeAlias

import numpy as np

from dashpot.base.version import byline
from dashpot.simulation.impact import ImpactTruth
from dashpot.simulation.rig_errors import RigTruth

Truth: TypeAlias = RigTruth | ImpactTruth


def stamp(truth: Truth) -> tuple[str, ...]:
    """Comment lines for the head of a simulated file, without a comment character."""
    rig = "virtual hammer" if isinstance(truth, ImpactTruth) else "virtual indentation rig"
    return (
        f"simulated by {byline(f'a {rig}, not a measurement')}",
        f"seed {truth.seed}; the truth lies beside this file, in JSON",
    )


def truth_json(truth: Truth, *, instrument: object = None) -> str:
    """Return the true parameters of a simulation as JSON, SI units, without sampled signals.

    The same truth, written twice, is the same text. Complex numbers are ``[re, im]``; unlimited
    values are null. The `instrument`, a dataclass, is that of a record in gauge voltages.
    """
    body = {
        "schema": "dashpot/truth@1",
        "simulated": True,
        "kind": truth.kind,
        **_to_plain_value(truth),
    }
    if instrument is not None:
        body["instrument"] = _to_plain_value(instrument)
    return json.dumps(body, indent=2, allow_nan=False)


def _to_plain_value(value: Any) -> Any:
    if is_dataclass(value):
        entries = {field.name: getattr(value, field.name) for field in fields(value)}
        return {k: _to_plain_value(v) for k, v in entries.items() if not isinstance(v, np.ndarray)}
    if isinstance(value, tuple | list):
        return [_to_plain_value(item) for item in value]
    if isinstance(value, complex):
        return [value.real, value.imag]
    if isinstance(value, float) and math.isinf(value):
        return None
    return value
