"""What the whole story shows, and what a project's history proves, as criteria with a sentence."""

from __future__ import annotations

import math

from dashpot.base.checks import Finding, criterion


@criterion(source="the paper's eq. (5) needs one ideal ramp", grade="note")
def hold_fit_possible(obstacle: str) -> Finding:
    """The paper's eq. (5) can be fitted to the record."""
    return Finding(f"eq. (5) cannot be fitted: {obstacle}", faulted=True)


@criterion("distance from the band, a factor", "<=", 1.0, "the band of the fit")
def prediction_informed(peak: float, band: tuple[float, float]) -> Finding:
    """The predicted peak lies where a test informs the solid."""
    low, high = band
    factor = max(peak / high, low / peak) if high > 0 else math.inf
    return Finding(
        f"the predicted peak at {peak:.4g} Hz lies inside what the test informs",
        factor,
        instead=f"the predicted peak at {peak:.4g} Hz is extrapolated x{factor:.3g} beyond what "
        f"the test informs, {low:.2g} to {high:.2g} Hz, so its damping is not known: hit the mass "
        "with a hammer",
    )


@criterion(source="a note: what was cut short did not happen", grade="note")
def history_complete() -> Finding:
    """The history ends with a whole line."""
    return Finding("the last line of history was cut short: that operation did not happen")


@criterion(source="SHA-256 of the line, and of the line before it", grade="stop")
def history_unchanged(number: int, *, whole: bool) -> Finding:
    """Every line of the history is as it was written."""
    line = f"line {number} of history.jsonl is "
    return Finding(
        line + "as it was written",
        instead=line + "not as it was written, or out of place",
        faulted=not whole,
    )


@criterion(source="by definition", grade="stop")
def file_present(file: str, number: int) -> Finding:
    """Every recorded file is there."""
    return Finding(f"{file} (line {number}) is missing", faulted=True)


@criterion(source="SHA-256 of its bytes", grade="stop")
def file_unchanged(file: str, number: int, *, same: bool) -> Finding:
    """Every recorded file is as it was."""
    return Finding(
        f"{file} (line {number}) is as it was",
        instead=f"{file} (line {number}) has changed since it was recorded",
        faulted=not same,
    )


@criterion("relative difference", "<=", 1e-7, "our choice: below what is printed", grade="stop")
def result_recomputed(worst: float, where: str, number: int) -> Finding:
    """Every result follows again from its raw files."""
    result = f"the result of line {number}, computed again from its raw files, "
    return Finding(
        f"{result}is the same (largest relative difference {worst:.2g})",
        worst,
        instead=f"{result}differs: {where}",
    )
