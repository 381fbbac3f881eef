"""What a slam can be trusted with, as criteria."""

from __future__ import annotations

from dashpot.base.checks import Finding, criterion
from dashpot.base.units import written


@criterion("compression / depth of the law", "<=", 1.0, "the law was measured to there")
def slam_within_law(deepest: float, depth: float | None) -> Finding:
    """The mass presses the piece no deeper than its elastic law was measured."""
    pressed = f"The mass presses the piece by {written(deepest, 'mm', '.3g')}"
    if depth is None:
        return Finding(
            f"{pressed}, and the fit holds no elastic law of a pressed piece",
            because="The law is taken as straight",
            remedy="Fit a relaxation or load deflection test of the piece.",
            faulted=True,
        )
    return Finding(
        f"{pressed}, and its law was measured to {written(depth, 'mm', '.3g')}",
        deepest / depth,
        "Beyond it the law goes on with its last slope, and a bulb that bottoms is stiffer",
        "Press a piece deeper in the load deflection test.",
    )


@criterion("frequency / highest informed", "<=", 1.0, "the band of the fit")
def slam_within_band(frequency: float, highest: float) -> Finding:
    """The contact is no faster than the fit informs."""
    return Finding(
        f"The contact is half a cycle of {frequency:.3g} Hz, and the fit informs to "
        f"{highest:.2g} Hz",
        frequency / highest,
        "A fast arm that the test could not see takes from the rebound, the force hardly changes",
        "Fit a recorded slam, or a hammer test, too.",
    )


@criterion("m/s", "<=", 0.1, "our choice: air leaves a bulb slowly pressed", grade="note")
def air_escapes(speed: float) -> Finding:
    """The mass is slow enough for the air of a bulb to leave."""
    return Finding(
        f"At {written(speed, 'm/s', '.3g')} the air in a bulb adds force unless it leaves at "
        "open ends or holes",
        speed,
        "It is not part of the law",
        "Leave the ends of the piece open, or say the vents of a door in its file.",
    )


@criterion(grade="note")
def piece_length_given(*, given: bool) -> Finding:
    """The length of the piece is known."""
    return Finding(
        "The length of the piece is known",
        instead="The length of the piece is not given, so forces and energies are of this piece, "
        "not of 100 mm",
        remedy="Give the length when the test is fitted.",
        faulted=not given,
    )
