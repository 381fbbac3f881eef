"""Criteria on the model of a solver card."""

from __future__ import annotations

from dashpot.base.checks import Finding, Remedy, criterion


@criterion(source="by definition")
def test_behind_model(keyword: str) -> Finding:
    """A test stands behind the model."""
    return Finding(
        "A test stands behind the model",
        failure=f"The model is that of a card ({keyword}): no test and no errors stand behind it",
        remedy="Test the part, and compare: dashpot compare MODEL.json HAMMER",
        always_fails=bool(keyword),
    )


@criterion("arms that the test would not determine", "<=", 0, "k > 3 SE, SE(ln tau) < 0.5")
def arms_testable(undetermined: int, arms: int, band: str) -> Finding:
    """A ramp and hold could have determined every arm of the card."""
    return Finding(
        f"Such a test could have determined all {arms} arms",
        undetermined,
        failure=f"Such a test could not have determined {undetermined} of {arms} arms",
        reason=band,
        remedy=Remedy("Ask for the test behind the card.", "ramp"),
    )


@criterion("largest error of the table / |K|", "<=", 0.01, "our choice: 1 %")
def table_followed(error: float | None) -> Finding:
    """Springs and dashpots follow the frequency table of the card."""
    if error is None:
        return Finding("The card has springs and dashpots, and no table over frequency")
    return Finding(
        f"The model follows the table of the card to {100 * error:.2g} %",
        error,
        reason="No springs and dashpots have such a stiffness over frequency",
        remedy="Use the table where it is, or measure it again.",
    )
