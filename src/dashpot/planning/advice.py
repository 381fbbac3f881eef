"""What to change of a planned test, in words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

from dashpot.base.checks import Check
from dashpot.base.sentences import sentence
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.planning.checks import format_relative_sd
from dashpot.planning.expected_errors import ExpectedError, Pulse, RecordNeed, half_sine

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
    margin: float,
) -> tuple[str, ...]:
    """Return what to change, most useful first; `margin` is the temperature of the test, K."""
    words = _cold_advice(expected, alternatives, at=at, margin=margin)
    if expected.loss_factor_sd > wanted:
        words.append(_ramp_advice(expected, alternatives, at=at, wanted=wanted))
    if need.record is None:
        words.append(
            f"Record each hit for {compute_record_length(need):.3g} s{without}. Six time constants "
            "last "
            f"{need.for_decay:.3g} s; five lines in the half-power band need {need.for_lines:.3g} "
            "s. With an exponential window a shorter record does."
        )
    failed = {check.name for check in answers if check.failed}
    if "record_long_enough" in failed:
        words.append(
            f"Record each hit for {compute_record_length(need):.3g} s{without} instead of "
            f"{need.record:g} s, or "
            "use an exponential window."
        )
    if tip is not None and "tip_excites" in failed:
        words.append(
            "Use a harder tip. A pulse shorter than "
            f"{format_quantity(_pulse_for(at), 'ms', '.3g')} loses less than 10 dB at {at:g} Hz."
        )
    if not words:
        words.append(f"This test will do. It gives the loss factor at {at:g} Hz well enough.")
    return tuple(words)


def compute_record_length(need: RecordNeed) -> float:
    """The record that a hit needs, s."""
    return max(need.for_decay, need.for_lines)


def _cold_advice(
    expected: ExpectedError, alternatives: Sequence[ExpectedError], *, at: float, margin: float
) -> list[str]:
    """What the repeats at other temperatures bring, and which one is still missing."""
    if not expected.repeated:
        return []
    error = next(e for e in alternatives if e.method == expected.method and not e.repeated)
    where, before = format_temperatures(expected.repeated), format_relative_sd(error.loss_factor_sd)
    if expected.loss_factor_sd > WORTH * error.loss_factor_sd:
        colder = "" if min(expected.repeated) < margin else " Test in the cold instead."
        after = f"{format_relative_sd(expected.loss_factor_sd)} instead of {before}"
        return [
            f"A repeat at {where} hardly improves the loss factor at {at:g} Hz: {after}.{colder}"
        ]
    says = (
        f"Repeat it at {where} and fit all together. The loss factor at {at:g} Hz is then known "
        f"to {format_relative_sd(expected.loss_factor_sd)} instead of {before}, if all arms shift "
        "alike."
    )
    words = [says]
    if len(expected.repeated) == 1:
        between = 5 * round(
            sum(convert_to_unit(value, "degC") for value in (margin, expected.repeated[0])) / 10
        )
        words.append(
            f"Test at a third temperature, such as {between:g} degC, too. Two temperatures cannot "
            "show arms that shift apart."
        )
    return words


def _ramp_advice(
    expected: ExpectedError, alternatives: Sequence[ExpectedError], *, at: float, wanted: float
) -> str:
    ways = [
        f"{how} ({format_relative_sd(best.loss_factor_sd)})"
        for how, best in _ways(expected, alternatives, wanted)
    ]
    none = (
        ""
        if len(ways) > 1
        else f" No faster ramp that was tried gives {format_relative_sd(wanted)}."
    )
    return (
        f"The loss factor at {at:g} Hz would be known to "
        f"{format_relative_sd(expected.loss_factor_sd)} "
        f"only.{none} {sentence(', or '.join(ways))}"
    )


def remedy(expected: ExpectedError, alternatives: Sequence[ExpectedError], *, wanted: float) -> str:
    """Return what gives the loss factor as it is wanted: each way, in a sentence."""
    *faster, hammer = (how for how, _ in _ways(expected, alternatives, wanted))
    if not faster:
        return sentence(hammer)
    return f"{sentence(', or '.join(faster))} Or {hammer}."


def _ways(
    expected: ExpectedError, alternatives: Sequence[ExpectedError], wanted: float
) -> list[tuple[str, ExpectedError]]:
    joint = next(e for e in alternatives if e.method == "joint")
    ways = [_faster(expected, alternatives, wanted), _colder(expected, alternatives, wanted)]
    pairs = [(how, best) for how, best in ways if best is not None]
    return [*pairs, ("add a hammer test and fit both together", joint)]


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
    return f"repeat it at {format_temperatures(good[0].repeated)}", good[0]


def format_temperatures(temperatures: Sequence[float]) -> str:
    """Temperatures, K, in words.

    >>> format_temperatures((273.15,)), format_temperatures((283.15, 273.15, 253.15))
    ('0 degC', '10, 0 and -20 degC')
    """
    *others, last = (f"{convert_to_unit(kelvin, 'degC'):.4g}" for kelvin in temperatures)
    return f"{', '.join(others)}{' and ' * bool(others)}{last} degC"


def _pulse_for(at: float) -> float:
    # the spectrum depends on f T alone
    return half_sine(1.0, at).band_10db / at
