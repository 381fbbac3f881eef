"""Criteria on drop tests."""

from __future__ import annotations

from collections.abc import Mapping

from dashpot.base.checks import Finding, Remedy, criterion
from dashpot.base.units import format_quantity

MAX_PATTERN_SD = 2.5


@criterion(
    "compression / depth of the elastic law", "<=", 1.0, "the elastic law was measured so far"
)
def impact_within_measured_depth(max_compression: float, depth: float | None) -> Finding:
    """The impact compresses the specimen no further than its elastic law was measured."""
    compression_text = (
        f"The mass presses the specimen by {format_quantity(max_compression, 'mm', '.3g')}"
    )
    if depth is None:
        return Finding(
            f"{compression_text}, and the fit has no elastic law of a compressed specimen",
            reason="The elastic law is taken as linear",
            remedy="Fit a relaxation or load deflection test of the specimen.",
            always_fails=True,
        )
    return Finding(
        f"{compression_text}, and its elastic law was measured to "
        f"{format_quantity(depth, 'mm', '.3g')}",
        max_compression / depth,
        "Beyond it the elastic law is extrapolated linearly; a bulb that bottoms is stiffer",
        "Press a specimen deeper in the load deflection test.",
    )


@criterion("frequency / upper end of the valid band", "<=", 1.0, "the valid band of the fit")
def impact_in_valid_band(frequency: float, highest_frequency: float) -> Finding:
    """The contact is no faster than the valid band of the fit covers."""
    return Finding(
        f"The contact is half a cycle of {frequency:.3g} Hz, and the model is valid to "
        f"{highest_frequency:.2g} Hz",
        frequency / highest_frequency,
        "An arm too fast for the test would lower the rebound, and hardly change the force",
        "Fit a recorded impact, or a hammer test, too.",
    )


@criterion("speed, m/s", "<=", 0.1, "our choice: air leaves slowly compressed seals", grade="note")
def air_escapes(speed: float) -> Finding:
    """The mass is slow enough for the air of a hollow seal to escape."""
    return Finding(
        f"At {format_quantity(speed, 'm/s', '.3g')} the air in a bulb adds force unless it leaves "
        "at open ends or holes",
        speed,
        "It is not part of the elastic law",
        "Leave the ends of the specimen open, or give the vents of a door in its file.",
    )


@criterion(grade="note")
def specimen_length_stated(*, is_given: bool) -> Finding:
    """The length of the specimen is given."""
    return Finding(
        "The length of the specimen is known",
        failure="The length of the specimen is not given, so forces and energies are of this "
        "specimen, not of 100 mm",
        remedy="Give the length when the test is fitted.",
        always_fails=not is_given,
    )


# -- of recorded impacts


@criterion(
    "standard error / loss factor",
    "<=",
    0.25,
    "our choice: its interval is half of it",
    grade="stop",
)
def loss_determined(relative: float, frequency: float) -> Finding:
    """The drop tests determine the loss factor."""
    name = f"known to {100 * relative:.2g} %" if relative < 10 else "not known"
    return Finding(
        f"The loss factor at {frequency:.3g} Hz is {name}",
        relative,
        failure=f"The loss factor at {frequency:.3g} Hz is not determined: it is {name}",
        remedy=Remedy(
            "Test three speeds, and give the fit of a load deflection test.", "relaxation",
            "law.json",
        ),
    )  # fmt: skip


@criterion("rms / scatter", "<=", 1.5, "our choice: the rest is scatter of the sensor")
def impacts_residual_small(misfit: float) -> Finding:
    """The model fits every impact."""
    return Finding(
        f"The residual of the force is {misfit:.3g} times its scatter",
        misfit,
        "The specimen deforms in another way, or the mass or the sensor oscillates",
        "Look at the figure. Fit impacts of one range of speeds, or filter less in the sensor.",
    )


@criterion(
    "standard deviations",
    "<=",
    MAX_PATTERN_SD,
    "measured: one faultless impact in 13 exceeds it",
)
def impact_residual_structureless(patterns: Mapping[str, float]) -> Finding:
    """The residual force shows no missing effect of specimen or sensor."""
    if not patterns:
        return Finding("There are too few impacts for this test of the residual")
    words, largest = max(patterns.items(), key=lambda pair: abs(pair[1]))
    return Finding(
        f"The residual of the force is most like {words}, by {abs(largest):.2g} standard "
        "deviations",
        abs(largest),
        "The fit has no such force, and counts it as relaxation or elastic law",
        "Look at the figure. Lubricate or align the specimen, or compress it less.",
    )


@criterion()
def slow_arms_determined(*, is_given: bool) -> Finding:
    """The arms that are slow relative to a contact are known."""
    return Finding(
        "The slow arms are known from another test",
        failure="No relaxation test was given, so the loss of slow arms is missing",
        remedy=Remedy("Give the fit of a relaxation test.", "relaxation", "fit.json"),
        always_fails=not is_given,
    )


@criterion("samples", ">=", 50.0, "our choice: the flanks show first contact")
def impacts_sampled(samples: float) -> Finding:
    """A contact has enough samples."""
    return Finding(
        f"The shortest contact has {samples:.0f} samples",
        samples,
        "Its flanks are steps",
        "Sample faster.",
    )


@criterion("fastest / slowest", ">=", 2.0, "our choice: a fitted elastic law needs several depths")
def impact_speeds_spread(speed_ratio: float | None) -> Finding:
    """The impact speeds differ enough to fit the elastic law."""
    if speed_ratio is None:
        return Finding("The elastic law is known, so one speed is enough")
    return Finding(
        f"The fastest impact is {speed_ratio:.3g} times the slowest, and the elastic law is fitted",
        speed_ratio,
        "A nonlinear elastic law and relaxation then look alike",
        Remedy(
            "Test three speeds, or give the fit of a load deflection test.",
            "relaxation",
            "law.json",
        ),
    )


@criterion("standard deviations", "<=", 3.0, "chance, once in 370")
def impact_speeds_agree(speed_deviation: float | None) -> Finding:
    """The measured impact speeds agree with the stated ones."""
    if speed_deviation is None:
        return Finding("No speed was given")
    return Finding(
        f"A speed lies {speed_deviation:.2g} standard deviations from what was given",
        speed_deviation,
        "The mass, a speed or the height of a fall is another",
        Remedy("Check the mass, and the speeds in the order of the impacts.", "drop"),
    )


@criterion("rest / contact", ">=", 10.0, "our choice: arms relax between impacts")
def impacts_separated(rest_time: float | None) -> Finding:
    """The specimen rested between impacts."""
    if rest_time is None:
        return Finding("Every record holds one impact")
    return Finding(
        f"An impact follows {rest_time:.3g} contacts after the one before",
        rest_time,
        "Slow arms still carry what the one before left",
        "Leave more time between impacts, or cut the record.",
    )


@criterion("|impulse ratio - 1|", "<=", 0.03, "our choice: both sensors are calibrated")
def impact_mass_agrees(ratio: float | None) -> Finding:
    """Force and acceleration agree with the stated mass."""
    if ratio is None:
        return Finding("Force or acceleration alone was recorded, so the mass is not checked")
    return Finding(
        f"The impulse by the force is {ratio:.4g} times that by mass and acceleration",
        abs(ratio - 1),
        "The mass is another, or a sensor is scaled wrong",
        Remedy("Weigh all that moves.", "mass"),
    )


@criterion("standard deviations", "<=", 3.0, "chance, once in 370")
def arms_agree_with_relaxation_test(change: float | None) -> Finding:
    """The impacts change the arms of the relaxation test by no more than their errors."""
    if change is None:
        return Finding("The arms of the relaxation test are fixed")
    return Finding(
        f"The impacts change the arms of the relaxation test by {change:.2g} standard deviations",
        change,
        "The two tests are not of one specimen at one temperature, or one is wrong",
        "Test the same specimen at the same temperature.",
    )


@criterion("arms", "<=", 4.0, "measured: with 14 arms, one every 0.34 decades, 7 % low")
def spectrum_has_gaps(arms: int) -> Finding:
    """The relaxation test shows few arms, so that one more can stand for faster ones."""
    return Finding(
        f"The relaxation test has {arms} arms",
        float(arms),
        "Its spectrum is broad, and one additional fast arm may be 7 % off in the loss factor",
        "Compare it with a hammer test, or with a cold test.",
    )


@criterion("|standard errors|", "<=", 3.0, "chance, once in 370")
def loss_factors_agree(
    gap: float | None, value: float, relaxation_loss_factor: float, *, is_in_interval: bool
) -> Finding:
    """The loss factor of the impacts agrees with that of the relaxation test."""
    if gap is None:
        return Finding("The loss factor by the impacts has no error, so it is not compared")
    at_least_text = "" if is_in_interval else "at least "
    return Finding(
        f"The loss factor is {value:.3g} by the impacts, and by the relaxation test "
        f"{at_least_text}{relaxation_loss_factor:.3g}",
        abs(gap),
        "The two differ by more than their errors",
        "Test the same specimen at the same temperature.",
    )
