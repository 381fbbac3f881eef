"""Shift factors as CSV, which `read_shifts` reads, and from their document."""

from __future__ import annotations

from typing import Any

import numpy as np

from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.base.version import byline
from dashpot.datamodel.fit import Fit
from dashpot.reading.write import format_table


def format_shift_table(fit: Fit) -> str:
    """Return the shift factors of a fit at several temperatures as text that `read_shifts` takes.

    The columns are ``temperature [degC], log10_a_t [1], se [1], b_t [1]``; `se` is of log10_a_t.
    """
    shifts = fit.temperatures
    assert shifts is not None  # noqa: S101  -- fits at several temperatures alone come here
    all_shifts = shifts.shifts
    header = ["temperature [degC]", "log10_a_t [1]", "se [1]", "b_t [1]"]
    columns = [
        np.array([round(convert_to_unit(shift.temperature, "degC"), 9) for shift in all_shifts]),
        np.array([shift.log10_a_t for shift in all_shifts]),
        np.array([shift.se for shift in all_shifts]),
        np.array([shift.b_t for shift in all_shifts]),
    ]
    origin_lines = ["simulated"] if any(source.simulated for source in fit.source) else []
    reference = f"reference {format_quantity(shifts.reference, 'degC', '.9g')}"
    header_lines = [byline("shift factors"), *origin_lines, f"{reference}, law {shifts.law.kind}"]
    return format_table(header_lines, header, columns)


def complete_document(entries: dict[str, Any]) -> dict[str, Any]:
    """Return the fields of shifts from their document: the law has their reference.

    A document of the bare contract holds the errors alone.
    """
    count = 2 * len(entries["shifts"])
    law = {**entries["law"], "reference": entries["reference"]}
    return {"covariance": np.zeros((count, count)).tolist(), **entries, "law": law}
