"""Criteria on slam tests."""

from __future__ import annotations

from collections.abc import Mapping

from dashpot.base.checks import Finding, Remedy, criterion
from dashpot.base.units import format_quantity

MAX_SHAPE = 2.5


@criterion("compression / depth of the law", "<=", 1.0, "the law was measured so far")
def slam_within_measured_depth(deepest: float, depth: float | None) -> Finding:
    """The impact compresses the specimen no further than its elastic law was measured."""
    pressed = f"The mass presses the specimen by {format_quantity(deepest, 'mm', '.3g')}"
    if depth is None:
        return Finding(
            f"{pressed}, and the fit holds no elastic law of a pressed piece",
            reason="The law is taken as straight",
            remedy="Fit a relaxation or load deflection test of the piece.",
            faulted=True,
        )
    return Finding(
        f"{pressed}, and its law was measured to {format_quantity(depth, 'mm', '.3g')}",
        deepest / depth,
        "Beyond it the law goes on with its last slope, and a bulb that bottoms is stiffer",
        "Press a specimen deeper in the load deflection test.",
    )


@criterion("frequency / upper end of the valid band", "<=", 1.0, "the valid band of the fit")
def slam_in_valid_band(frequency: float, highest: float) -> Finding:
    """The contact is no faster than the valid band of the fit covers."""
    return Finding(
        f"The contact is half a cycle of {frequency:.3g} Hz, and the fit holds to {highest:.2g} Hz",
        frequency / highest,
        "A fast arm that the test could not see takes from the rebound, the force hardly changes",
        "Fit a recorded impact, or a hammer test, too.",
    )


@criterion("speed, m/s", "<=", 0.1, "our choice: air leaves slowly compressed seals", grade="note")
def air_escapes(speed: float) -> Finding:
    """The mass is slow enough for the air of a hollow seal to escape."""
    return Finding(
        f"At {format_quantity(speed, 'm/s', '.3g')} the air in a bulb adds force unless it leaves "
        "at "
        "open ends or holes",
        speed,
        "It is not part of the law",
        "Leave the ends of the specimen open, or give the vents of a door in its file.",
    )


@criterion(grade="note")
def piece_length_given(*, provided: bool) -> Finding:
    """The length of the specimen is given."""
    return Finding(
        "The length of the specimen is known",
        instead="The length of the specimen is not given, so forces and energies are of this "
        "specimen, not of 100 mm",
        remedy="Give the length when the test is fitted.",
        faulted=not provided,
    )


# -- of recorded slams


@criterion(
    "standard error / loss factor",
    "<=",
    0.25,
    "our choice: its interval is half of it",
    grade="stop",
)
def loss_determined(relative: float, frequency: float) -> Finding:
    """The impact tests determine the loss factor."""
    name = f"known to {100 * relative:.2g} %" if relative < 10 else "not known"
    return Finding(
        f"The loss factor at {frequency:.3g} Hz is {name}",
        relative,
        instead=f"The loss factor at {frequency:.3g} Hz is not determined: it is {name}",
        remedy=Remedy(
            "Test three speeds, and give the fit of a load deflection test.", "relaxation",
            "law.json",
        ),
    )  # fmt: skip


@criterion("rms / scatter", "<=", 1.5, "our choice: the rest is scatter of the sensor")
def slams_residual_small(misfit: float) -> Finding:
    """The model fits every impact."""
    return Finding(
        f"What the motion leaves of the force is {misfit:.3g} times its scatter",
        misfit,
        "The specimen bends otherwise, or the mass or the sensor oscillates",
        "Look at the picture. Fit impacts of one range of speeds, or filter less in the sensor.",
    )


@criterion(
    "standard deviations",
    "<=",
    MAX_SHAPE,
    "measured: one sound impact in 13 exceeds it",
)
def slam_residual_structureless(shapes: Mapping[str, float]) -> Finding:
    """The residual force shows no missing effect of specimen or sensor."""
    if not shapes:
        return Finding("The impacts are too few to tell what else there is")
    words, most = max(shapes.items(), key=lambda pair: abs(pair[1]))
    return Finding(
        f"What the motion leaves of the force is most like {words}, by "
        f"{abs(most):.2g} standard deviations",
        abs(most),
        "The fit has no such force, and takes it for memory or for the law",
        "Look at the picture. Lubricate or align the specimen, or compress it less.",
    )


@criterion()
def slow_arms_determined(*, provided: bool) -> Finding:
    """The arms that are slow relative to a contact are known."""
    return Finding(
        "The slow arms are known from another test",
        instead="No relaxation test was given, so the loss of slow arms is missing",
        remedy=Remedy("Give the fit of a relaxation test.", "relaxation", "fit.json"),
        faulted=not provided,
    )


@criterion("samples", ">=", 50.0, "our choice: the flanks show first contact")
def slams_sampled(samples: float) -> Finding:
    """A contact has enough samples."""
    return Finding(
        f"The shortest contact has {samples:.0f} samples",
        samples,
        "Its flanks are steps",
        "Sample faster.",
    )


@criterion("fastest / slowest", ">=", 2.0, "our choice: a fitted law needs several depths")
def slam_speeds_spread(spread: float | None) -> Finding:
    """The impact speeds differ enough to fit the elastic law."""
    if spread is None:
        return Finding("The law is known, so one speed will do")
    return Finding(
        f"The fastest impact is {spread:.3g} times the slowest, and the law is free",
        spread,
        "What bends and what has memory then look alike",
        Remedy(
            "Test three speeds, or give the fit of a load deflection test.",
            "relaxation",
            "law.json",
        ),
    )


@criterion("standard deviations", "<=", 3.0, "chance, once in 370")
def slam_speeds_agree(off: float | None) -> Finding:
    """The measured impact speeds agree with the stated ones."""
    if off is None:
        return Finding("No speed was given")
    return Finding(
        f"A speed lies {off:.2g} standard deviations from what was given",
        off,
        "The mass, a speed or the height of a fall is another",
        Remedy("Check the mass, and the speeds in the order of the slams.", "drop"),
    )


@criterion("rest / contact", ">=", 10.0, "our choice: arms relax between impacts")
def slams_separated(rest: float | None) -> Finding:
    """The specimen rested between impacts."""
    if rest is None:
        return Finding("Every record holds one impact")
    return Finding(
        f"An impact follows {rest:.3g} contacts after the one before",
        rest,
        "Slow arms still carry what the one before left",
        "Leave more time between impacts, or cut the record.",
    )


@criterion("|impulse ratio - 1|", "<=", 0.03, "our choice: both sensors are calibrated")
def slam_mass_agrees(ratio: float | None) -> Finding:
    """Force and acceleration agree with the stated mass."""
    if ratio is None:
        return Finding("Force or acceleration alone was recorded, so the mass is not judged")
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
        return Finding("The arms of the other test are held")
    return Finding(
        f"The impacts move the arms of the other test by {change:.2g} of its standard deviations",
        change,
        "The two tests are not of one specimen at one temperature, or one is wrong",
        "Test the same specimen at the same temperature.",
    )


@criterion("arms", "<=", 4.0, "measured: with 14 arms, one every 0.34 decades, 7 % low")
def spectrum_has_gaps(arms: int) -> Finding:
    """The relaxation test shows few arms, so that one more can stand for faster ones."""
    return Finding(
        f"The other test sees {arms} arms",
        float(arms),
        "Its spectrum is broad, and one fast arm beside it may be 7 % off in the loss factor",
        "Compare it with a hammer test, or with a cold test.",
    )


@criterion("|standard errors|", "<=", 3.0, "chance, once in 370")
def loss_factors_agree(gap: float | None, value: float, before: float, *, within: bool) -> Finding:
    """The loss factor of the impacts agrees with that of the relaxation test."""
    if gap is None:
        return Finding("The loss factor by the impacts has no error, so it is not compared")
    least = "" if within else "at least "
    return Finding(
        f"The loss factor by the impacts is {value:.3g}, where the other test has "
        f"{least}{before:.3g}",
        abs(gap),
        "The two differ by more than their errors",
        "Test the same specimen at the same temperature.",
    )
