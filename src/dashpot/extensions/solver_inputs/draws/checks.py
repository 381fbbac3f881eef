"""Criteria on solids drawn from the uncertainty of a fit."""

from __future__ import annotations

from dashpot.base.checks import Finding, Remedy, criterion


@criterion("peaks outside the valid band, without a record", "<=", 0, "the valid band of the fit")
def unresolved_arm_drawn(outside: int, peak: float, *, has_record: bool) -> Finding:
    """The draws include the arms that the test does not resolve at the peak."""
    frequency_text = f"{peak:.4g} Hz"
    return Finding(
        f"The peak at {frequency_text} lies outside the valid band, and the draws have an "
        "unresolved arm"
        if outside and has_record
        else f"The peak at {frequency_text} lies in the valid band of the fit",
        outside,
        "A faster arm, which the test does not show, may change peak and damping by far more",
        Remedy("Give the record behind the fit.", "record"),
        failure=f"The peak at {frequency_text} lies outside the valid band, and the draws hold "
        "standard errors alone",
        always_passes=has_record,
    )
