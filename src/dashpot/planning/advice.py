"""What to change of a planned test, in words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

from dashpot.base.checks import Check
from dashpot.base.units import in_unit, written
from dashpot.planning.checks import percent
from dashpot.planning.expected import ExpectedError, Pulse, RecordNeed, half_sine

WORTH = 0.9
"""A repeat is worth its day if it brings the standard deviation below this part of it."""


def advice(
    expected: ExpectedError,
    alternatives: Sequence[ExpectedError],
    answers: Sequence[Check],
    need: RecordNeed,
    tip: Pulse | None,
    *,
    at: float,
    wanted: float,
    without: str,
    room: float,
) -> tuple[str, ...]:
    """Return what to change, most useful first; `room` is the temperature of the test, K."""
    words = _cold_advice(expected, alternatives, at=at, room=room)
    if expected.loss_factor_sd > wanted:
        words.append(_ramp_advice(expected, alternatives, at=at, wanted=wanted))
    if need.record is None:
        words.append(
            f"Record each hit for {needed(need):.3g} s{without}: {need.for_decay:.3g} s hold six "
            f"time constants, {need.for_lines:.3g} s put five lines into the half-power band; with "
            "an exponential window on both channels and the model taken at s = jw + a a shorter "
            "record does."
        )
    failed = {check.name for check in answers if check.failed}
    if "record_long_enough" in failed:
        words.append(
            f"Record each hit for {needed(need):.3g} s{without} instead of {need.record:g} s, or "
            "fit the model to the cut or windowed record."
        )
    if tip is not None and "tip_excites" in failed:
        words.append(
            "Use a harder tip: the pulse must be shorter than "
            f"{written(_pulse_for(at), 'ms', '.3g')} to lose less than 10 dB at {at:g} Hz."
        )
    if not words:
        words.append(f"This test will do: it knows the loss factor at {at:g} Hz well enough.")
    return tuple(words)


def needed(need: RecordNeed) -> float:
    """The record that a hit needs, s."""
    return max(need.for_decay, need.for_lines)


def _cold_advice(
    expected: ExpectedError, alternatives: Sequence[ExpectedError], *, at: float, room: float
) -> list[str]:
    """What the repeats at other temperatures bring, and which one is still missing."""
    if not expected.repeated:
        return []
    alone = next(e for e in alternatives if e.method == expected.method and not e.repeated)
    where, before = listed(expected.repeated), percent(alone.loss_factor_sd)
    if expected.loss_factor_sd > WORTH * alone.loss_factor_sd:
        faster = "" if min(expected.repeated) < room else ": fast arms are slower in the cold"
        after = f"{percent(expected.loss_factor_sd)} for {before}{faster}"
        return [
            f"Repeating it at {where} hardly tells more of the loss factor at {at:g} Hz, {after}."
        ]
    says = (
        f"Repeat it at {where} and fit all together: the standard deviation of the loss factor at "
        f"{at:g} Hz goes from {before} to {percent(expected.loss_factor_sd)}, if all arms shift "
        "alike."
    )
    words = [says]
    if len(expected.repeated) == 1:
        between = 5 * round(sum(in_unit(one, "degC") for one in (room, expected.repeated[0])) / 10)
        words.append(
            "Two temperatures cannot see arms that shift apart, three can: test at a third one, "
            f"such as {between:g} degC, too."
        )
    return words


def _ramp_advice(
    expected: ExpectedError, alternatives: Sequence[ExpectedError], *, at: float, wanted: float
) -> str:
    joint = next(e for e in alternatives if e.method == "joint")
    ways = [
        f"{how} ({percent(best.loss_factor_sd)})"
        for how, best in (
            _faster(expected, alternatives, wanted), _colder(expected, alternatives, wanted)
        )
        if best is not None
    ]  # fmt: skip
    none = "" if ways else f", and no faster ramp tried here brings it to {percent(wanted)}"
    ways.append(
        f"test the damping with a hammer test and fit both together (identify, "
        f"{percent(joint.loss_factor_sd)})"
    )
    return (
        f"The loss factor at {at:g} Hz would be known to {percent(expected.loss_factor_sd)} only"
        f"{none}: {', or '.join(ways)}."
    )


Way: TypeAlias = tuple[str, ExpectedError | None]
"""What to do, and what it brings; None if nothing of the kind will do."""


def _faster(expected: ExpectedError, alternatives: Sequence[ExpectedError], wanted: float) -> Way:
    """The slowest ramp that will do, or the other method."""
    good = [
        e
        for e in alternatives
        if e.loss_factor_sd <= wanted and e.method != "joint" and not e.repeated
    ]
    if not good:
        return "", None
    best = max(good, key=lambda e: e.ramp_time)
    how = f"ramp in {best.ramp_time:.3g} s" if best.ramp_time < expected.ramp_time else ""
    fit = "fit ramp and hold together" if best.method != expected.method else ""
    return " and ".join(part for part in (how, fit) if part), best


def _colder(expected: ExpectedError, alternatives: Sequence[ExpectedError], wanted: float) -> Way:
    """The test repeated in the cold, if it is not yet and that will do."""
    good = [e for e in alternatives if e.repeated and e.loss_factor_sd <= wanted]
    if expected.repeated or not good:
        return "", None
    return f"repeat it at {listed(good[0].repeated)}", good[0]


def listed(temperatures: Sequence[float]) -> str:
    """Temperatures, K, in words.

    >>> listed((273.15,)), listed((283.15, 273.15, 253.15))
    ('0 degC', '10, 0 and -20 degC')
    """
    *others, last = (f"{in_unit(kelvin, 'degC'):.4g}" for kelvin in temperatures)
    return f"{', '.join(others)}{' and ' * bool(others)}{last} degC"


def _pulse_for(at: float) -> float:
    # the spectrum depends on f T alone
    return half_sine(1.0, at).band_10db / at
