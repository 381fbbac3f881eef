"""Criteria on a door on its seal."""

from __future__ import annotations

import math
from collections.abc import Sequence

from dashpot.base.checks import Finding, criterion
from dashpot.base.units import format_quantity
from dashpot.base.value_ranges import SIZES

NOT_THERE = 0.3
"""Distance above which mode shapes belong to another door, m."""
MAX_MASS_RATIO = 2.0
"""Ratio of masses, so too."""
MAX_CLOSING_RATIO = 10.0
"""Times the longest of the other pieces, beyond which that which closes a line skips points."""
HELD_BY_SEAL = 0.01
"""Share of energy or loss in the seal above which its test matters for a mode."""


@criterion("distance from the valid band, a factor", "<=", 1.0, "the valid band of the fit")
def door_modes_in_valid_band(
    modes: Sequence[tuple[float, float]], band: tuple[float, float] | None
) -> Finding:
    """Modes with 1 % of their energy or loss in the seal lie in its valid band.

    `modes` are their frequencies, Hz, and the seal's share of their energy or loss.
    """
    seal_frequencies = [f for f, share in modes if share > HELD_BY_SEAL]
    if band is None or not seal_frequencies:
        return Finding("The seal holds no mode of the door, or its test has no valid band")
    low, high = band
    if not high > 0:
        return Finding(
            "No test behind the fit of the seal has a valid band", math.inf, remedy="Test the seal."
        )
    extrapolation = {f: max(f / high, low / f) for f in seal_frequencies}
    is_outside = [f for f in seal_frequencies if extrapolation[f] > 1]
    worst = max(extrapolation.values())
    first = [f"{f:.3g}" for f in is_outside[:3]]
    frequencies_text = " and ".join(first) if len(is_outside) < 3 else ", ".join(first)
    frequencies_text += " and more" if len(is_outside) > 3 else ""
    return Finding(
        f"All {len(seal_frequencies)} modes that the seal affects lie in the valid band of its "
        "test",
        worst,
        failure=f"The seal's damping is not known at {frequencies_text} Hz. Its test covers "
        f"{low:.2g} to {high:.2g} Hz. {len(is_outside)} of {len(seal_frequencies)} modes that it "
        f"affects lie outside, up to {worst:.3g} times",
        remedy="Test the seal with a hammer, or in the cold.",
    )


@criterion(
    "part of the line", "<=", 0.0, "by definition: it leaks there",
    other_grade="stop where nothing is pressed",
)  # fmt: skip
def seal_touches(
    part: float, *, length: float, min_compression: float, position: float, max_compression: float
) -> Finding:
    """The seal is in contact along its whole line."""
    if max_compression <= 0:
        return Finding(
            "No station of the seal is pressed: the compression is "
            f"{format_quantity(max_compression, 'mm', '.3g')} "
            "at most",
            part,
            remedy="Check compression, gap and height in [seal], and their units.",
            always_fails=True,
            grade="stop",
        )
    return Finding(
        "The seal touches all along the line",
        part,
        failure=f"{format_quantity(part * length, 'mm')} of {length:.3g} m of seal do not touch: "
        "there is "
        f"a leak. The gap is largest at {position:.4g} m along the line, "
        f"{format_quantity(-min_compression, 'mm', '.3g')}",
        remedy="Close the gap there, or use a higher seal.",
    )


@criterion(
    "unsupported directions",
    "<=",
    0,
    "our choice: a tenth of a seal as stiff in shear as in compression",
)
def lateral_restraint_present(motions: int, slowest: float | None) -> Finding:
    """Hinges, latch or the shear of the seal support the door sideways."""
    has_several_motions = motions > 1
    frequency_text = "" if slowest is None else f" from {slowest:.3g} Hz"
    return Finding(
        "Hinges, latch or bumpers hold the door where its seal line does not, in its plane",
        motions,
        failure=f"In-plane motion is held by nothing: no shear is given, and {motions} "
        f"motion{'s' * has_several_motions} {'are' if has_several_motions else 'is'} "
        f"free{frequency_text}",
        remedy="Give across and along in [seal.shear].",
    )


@criterion(
    "shear / compression stiffness", "<=", SIZES["shear"].soft[1],
    "our choice: G/E of a block is 1/3, bulbs have 0.1 to 0.5",
)  # fmt: skip
def shear_stiffness_plausible(ratio: float) -> Finding:
    """The shear stiffness of the seal is in the usual range."""
    return Finding(
        f"The seal is {ratio:.3g} times as stiff sideways as where it is pressed",
        ratio,
        "Hardly any seal is so stiff that way, and the door's modes in its plane rest on it",
        "Check across and along in [seal.shear], or the length of the tested specimen.",
    )


@criterion(source="our choice: most door seals are closed", grade="note")
def line_closed(length: float, value: float, pieces: Sequence[float] = (1.0, 1.0)) -> Finding:
    """The seal line is closed, and not by one long segment alone."""
    closing, longest = pieces[-1], max(pieces[:-1])
    has_jump = closing > MAX_CLOSING_RATIO * longest
    return Finding(
        f"The seal line of {length:.4g} m is closed",
        failure=f"The seal line of {length:.4g} m is closed by a straight segment of "
        f"{format_quantity(closing, 'mm')}, and no other is longer than "
        f"{format_quantity(longest, 'mm')}"
        if has_jump and not value > 0
        else f"The seal line of {length:.4g} m ends {format_quantity(value, 'mm')} from where it "
        "begins",
        remedy="Add its last points, if some are missing.",
        always_fails=value > 0 or has_jump,
    )


@criterion("change of frequency", "<=", 1e-3, "our choice: less than doors are tuned to")
def stations_suffice(change: float, pitch: float) -> Finding:
    """The stations are close enough: half their distance changes no mode."""
    return Finding(
        f"With stations twice as dense as {format_quantity(pitch, 'mm')} no mode moves by more "
        "than "
        f"{100 * change:.2g} %",
        change,
        remedy="Use a smaller pitch in [seal].",
    )


@criterion("change of frequency", "<=", 5e-3, "our choice: half a percent")
def modes_suffice(change: float | None, count: int, highest: float) -> Finding:
    """The elastic modes of the door are enough: a third fewer changes little."""
    if change is None:
        return Finding(f"{count} elastic modes are too few to judge whether they are enough")
    return Finding(
        f"Without the upper third of {count} elastic modes, to {highest:.4g} Hz, those below move "
        f"by {100 * change:.2g} %",
        change,
        remedy="Give more modes of the door, to higher frequencies.",
    )


@criterion(
    "distance, m", "<=", 0.03, "our choice: a tenth of a short panel wave",
    other_grade="stop beyond 0.3",
)  # fmt: skip
def mode_shapes_cover_points(distance: float, point_name: str) -> Finding:
    """Mode shapes are given close to the seal, the supports and the output points."""
    return Finding(
        f"The shapes are known within {format_quantity(distance, 'mm', '.3g')} of all places that "
        "are used",
        distance,
        failure=(
            f"The shapes are known only {format_quantity(distance, 'mm', '.3g')} from {point_name}"
        ),
        remedy="Export points there, or check the axes and the unit of the modes.",
        grade="stop" if distance > NOT_THERE else "limit",
    )


@criterion(
    "ratio of masses", "x/", 1.05, "5 %: trim is often left out", other_grade="stop beyond 2"
)
def masses_agree(stated_mass: float, implied_mass: float) -> Finding:
    """The rigid-body modes have the mass that [door] states."""
    return Finding(
        f"The rigid modes weigh {implied_mass:.4g} kg; [door] gives {stated_mass:.4g} kg",
        implied_mass / stated_mass,
        "The modal masses or the units of the modes are wrong, or the modes are of another door",
        "Check the mass in [door], and the units of the modes.",
        grade="limit"
        if 1 / MAX_MASS_RATIO <= implied_mass / stated_mass <= MAX_MASS_RATIO
        else "stop",
    )


@criterion("unsupported directions", "<=", 0, "by definition")
def door_supported(free_motions: int) -> Finding:
    """Something supports the door in every direction in which it could move."""
    return Finding(
        "Every motion of the door is held",
        free_motions,
        failure=f"{free_motions} motions of the door are free, and have no natural frequency",
        remedy="Check that no hinge or latch is missing, and along which directions they act.",
    )


@criterion("distance from the valid band, a factor", "<=", 1.0, "the valid band of the fit")
def closing_in_valid_band(
    seconds: float,
    band: tuple[float, float] | None,
    *,
    glassy: float,
    values: tuple[float, float] | None,
) -> Finding:
    """The door compresses its seal no faster than the valid band of the seal covers.

    An even press over a time T is taken as a quarter of a period, 1/(4 T); `glassy` is
    k_0/k_inf of the fit, `values` the least speeds that its doubt leaves, m/s.
    """
    if band is None or not band[1] > 0 or not seconds > 0:
        return Finding("The valid band of the seal's test is not known")
    factor = 1 / (4 * seconds) / band[1]
    speeds = ""
    if values is not None:
        range_text = f"lies between {values[0]:.3g} and {values[1]:.3g} m/s"
        if math.isinf(values[1]):
            range_text = f"is {values[0]:.3g} m/s or more"
        speeds = f"The least closing speed {range_text}. "
    return Finding(
        f"The door presses its seal in {format_quantity(seconds, 'ms', '.3g')}, as slowly as its "
        "test",
        factor,
        failure=f"{speeds}The door presses its seal in {format_quantity(seconds, 'ms', '.3g')}, "
        f"{factor:.3g} times faster than its test did. There the fit gives {glassy:.3g} times the "
        "relaxed force",
        remedy="Test the seal faster, or in the cold.",
    )


@criterion(source="by definition", grade="note")
def faster_closings_latch(closes: bool) -> Finding:
    """Every closing speed above the minimum closes the door."""
    return Finding(
        "Every faster door that was tried closes too",
        failure="Some faster doors do not close. The air takes more, the faster the door",
        remedy="Look at the air in the energy table.",
        always_fails=not closes,
    )


@criterion("half width of the interval over the speed", "<=", 0.2, "our choice: 40 % of the load")
def leak_speed_determined(width: float, *, state: str) -> Finding:
    """The leak speed is known to 20 % in every state."""
    if not math.isfinite(width):
        return Finding(
            f"The seal leaks at rest in state '{state}': a station does not touch",
            width,
            remedy="Close the gap there, or use a higher seal.",
        )
    return Finding(
        f"The leak speed is known to {100 * width:.2g} % or better",
        width,
        failure=f"The leak speed is known to {100 * width:.2g} % only in state '{state}'",
        remedy="Measure gap and lip, hold the test longer, or test the aged seal.",
    )


@criterion("specimens", ">=", 10.0, "our choice: the scatter is then known to a quarter")
def seals_suffice(specimens: int | None) -> Finding:
    """The lot has enough seals to know their scatter."""
    if specimens is None:
        return Finding("The scatter of the seals is stated, so this check does not apply")
    return Finding(
        f"{specimens} seals of the lot were tested",
        float(specimens),
        "Shares of cars far out are uncertain by that",
        "Test more seals of the lot.",
    )


@criterion("variance of testing / variance between", "<=", 1.0, "our choice: at most as large")
def scatter_exceeds_testing(between_sd: float | None, testing: float) -> Finding:
    """The seals scatter by more than their tests."""
    if between_sd is None:
        return Finding("The scatter of the seals is stated, so this check does not apply")
    return Finding(
        f"The seals scatter by {100 * math.sqrt(between_sd):.2g} %, their tests by "
        f"{100 * math.sqrt(testing):.2g} %",
        testing / between_sd if between_sd > 0 else math.inf,
        "How far the seals themselves scatter is hardly seen",
        "Test each seal several times, taken out and put in again.",
    )
