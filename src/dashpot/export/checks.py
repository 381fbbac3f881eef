"""What a deck says beyond the test behind it, as a criterion with a limit and a sentence."""

from __future__ import annotations

from dashpot.base.checks import Finding, criterion


@criterion("rows outside the band", "<=", 0, "the band of the fit")
def rows_informed(outside: int, rows: int, low: float, high: float) -> Finding:
    """Every row of a deck's table lies where the test informs the solid."""
    return Finding(
        f"every one of the {rows} rows of this deck lies inside what the test informs",
        outside,
        instead=f"{outside} of {rows} rows, from {low:.6g} to {high:.6g} Hz, lie outside "
        "what the test informs: stiffness and damping there are extrapolated; a hammer test "
        "fitted together with it (identify) informs them",
    )
