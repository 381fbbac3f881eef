"""Criterion on a deck that extends beyond the test of its solid."""

from __future__ import annotations

from dashpot.base.checks import Finding, Remedy, criterion


@criterion("rows outside the valid band", "<=", 0, "the valid band of the fit")
def rows_in_valid_band(outside: int, rows: int, low: float, high: float) -> Finding:
    """Every row of the exported table lies inside the valid band."""
    return Finding(
        f"All {rows} rows of this deck lie in the valid band of the fit",
        outside,
        failure=f"{outside} of {rows} rows, from {low:.3g} to {high:.3g} Hz, lie outside the valid "
        "band. Stiffness and damping there are extrapolated",
        remedy=Remedy("Limit the table to the valid band, or add a hammer test.", "band"),
    )


@criterion("frequencies outside the valid band", "<=", 0, "the valid band of the fit")
def nominal_in_valid_band(outside: int, frequency: float) -> Finding:
    """The nominal frequency of the exported stiffness lies inside the valid band."""
    return Finding(
        f"The stiffness of this deck is that at {frequency:.6g} Hz, in the valid band of the fit",
        outside,
        failure=f"The stiffness of this deck is that at {frequency:.6g} Hz, outside the valid "
        "band, and extrapolated",
        remedy=Remedy("Name a frequency in the valid band, or add a hammer test.", "nominal"),
    )
