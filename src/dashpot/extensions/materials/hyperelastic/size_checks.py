"""Criterion on the size of a strain as read: how large a rubber is strained."""

from __future__ import annotations

from dashpot.base.checks import Finding, criterion
from dashpot.reading.readers.size_checks import make_unit_advice

MIN_STRAIN = 0.05


@criterion(
    "greatest strain", ">=", MIN_STRAIN, "our choice: nonlinearity shows above it", grade="stop"
)
def strain_of_a_rubber(strain: float, unit: str) -> Finding:
    """The strain is large enough to determine a hyperelastic law."""
    message = f"The strain reaches {strain:.3g} of the length"
    return Finding(message, strain, **make_unit_advice(message, "strain", unit, {"%": "1"}))
