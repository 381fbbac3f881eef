"""Plan of a test: expected errors at a frequency, and advice on changes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray, sample_count
from dashpot.base.checks import Check, HasChecks
from dashpot.base.errors import DataError
from dashpot.base.number_format import duration
from dashpot.base.plain_text import sentence
from dashpot.base.serialisation import EVERY_FIELD, Serialisable
from dashpot.base.units import Quantity, convert_to_si, convert_to_unit, format_quantity
from dashpot.base.value_ranges import require_positive
from dashpot.planning import checks
from dashpot.planning.assumed_seal import SupposedSeal
from dashpot.planning.checks import format_relative_sd, percent
from dashpot.planning.expected_errors import (
    ExpectedArm,
    ExpectedEnd,
    ExpectedError,
    Pulse,
    RecordNeed,
    expected_arms,
    expected_end,
    expected_error,
    half_sine,
    hammer_rows,
    record_need,
)
from dashpot.planning.plan_options import IN_SI, HammerPlan
from dashpot.planning.planned_ramp_hold import Bench, Repeat
from dashpot.registry import find_handler
from dashpot.solids.demo_seals import SHIFT
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.shift_laws import TemperatureLaw
from dashpot.vibration.mass_on_seals import mass_for_peak

# Advice on a planned test, as text.


WORTH = 0.9
"""A repeat is worth its day if it brings the standard deviation below this part of it."""


def list_advice(
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
    """Return the record that a hit needs, s."""
    return max(need.for_decay, need.for_lines)


def _cold_advice(
    expected: ExpectedError, alternatives: Sequence[ExpectedError], *, at: float, margin: float
) -> list[str]:
    """Return what the repeats at other temperatures bring, and which one is still missing."""
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
    message = (
        f"Repeat it at {where} and fit all together. The loss factor at {at:g} Hz is then known "
        f"to {format_relative_sd(expected.loss_factor_sd)} instead of {before}, if all arms shift "
        "alike."
    )
    words = [message]
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
        for how, best in _list_ways(expected, alternatives, wanted)
    ]
    none = (
        ""
        if len(ways) > 1
        else f" No faster ramp that was tried gives {format_relative_sd(wanted)}."
    )
    return (
        f"The loss factor at {at:g} Hz would be known to "
        f"{format_relative_sd(expected.loss_factor_sd)} "
        f"(1 SD) only.{none} {sentence(', or '.join(ways))}"
    )


def format_remedy(
    expected: ExpectedError, alternatives: Sequence[ExpectedError], *, wanted: float
) -> str:
    """Return what gives the loss factor as it is wanted: each way, in a sentence."""
    *faster, hammer = (how for how, _ in _list_ways(expected, alternatives, wanted))
    if not faster:
        return sentence(hammer)
    return f"{sentence(', or '.join(faster))} Or {hammer}."


def _list_ways(
    expected: ExpectedError, alternatives: Sequence[ExpectedError], wanted: float
) -> list[tuple[str, ExpectedError]]:
    joint = next(e for e in alternatives if e.method == "joint")
    ways = [
        _find_faster_ramp(expected, alternatives, wanted),
        _find_colder_repeat(expected, alternatives, wanted),
    ]
    pairs = [(how, best) for how, best in ways if best is not None]
    return [*pairs, ("add a hammer test and fit both together", joint)]


Way: TypeAlias = tuple[str, ExpectedError | None]
"""What to do, and what it brings; None if nothing of the kind will do."""


def _find_faster_ramp(
    expected: ExpectedError, alternatives: Sequence[ExpectedError], wanted: float
) -> Way:
    """Return the slowest ramp that will do, or the other method."""
    good = [
        e
        for e in alternatives
        if e.loss_factor_sd <= wanted and e.method != "joint" and not e.repeated
    ]
    if not good:
        return "", None
    best = max(good, key=lambda e: e.ramp_time)
    how = f"ramp in {duration(best.ramp_time)}" if best.ramp_time < expected.ramp_time else ""
    fit = "fit ramp and hold together" if best.method != expected.method else ""
    return " and ".join(part for part in (how, fit) if part), best


def _find_colder_repeat(
    expected: ExpectedError, alternatives: Sequence[ExpectedError], wanted: float
) -> Way:
    """Return the test repeated in the cold, if it is not yet and that will do."""
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


WANTED = 0.1
FASTER = (1 / 3, 1 / 10, 1 / 30)
# a hammer test informs the lines within this factor of the peak; their usual spacing, Hz
AROUND = 3.5
LINE_STEP = 0.1
# where a test is repeated if nobody says: a refrigerator, K; if that is so much colder
USUAL_COLD = 273.15
COLDER = 10.0


@dataclass(frozen=True)
class Plan(HasChecks, Serialisable):
    """Plan of a test: expected errors at a frequency, and advice on changes.

    Attributes
    ----------
    at : float
        Hz.
    model : GeneralizedMaxwell
        The solid that was supposed, the unseen arm included.
    arm : (float, float) or None
        Stiffness, N/m, and relaxation time, s, of the arm that the test may not see.
    expected : ExpectedError
        Of the test as asked, with its repeats.
    alternatives : tuple of ExpectedError
        Of the test alone and at each other temperature, of the other method, of faster ramps,
        of the test repeated at 0 degC if no other was asked for, and with a hammer test.
    band : (float, float)
        The frequencies that the relaxation test can inform, Hz.
    record : RecordNeed
    pulse : Pulse or None
    checks : tuple of Check
    advice : tuple of str
        What to change, most useful first.
    temperature : float
        Of the test, K.
    repeats : tuple of Repeat
        Where it is repeated, as asked.
    arms : tuple of ExpectedArm
        How well a fit of the test, without its repeats, would know each arm of the seal, that which
        it may not see left out.
    end : ExpectedEnd
        How well the test, without its repeats, would know the stiffness when it ends, and how
        well if the machine were named.
    """

    schema = "dashpot/plan@2"
    _keys = ("verdict", EVERY_FIELD)

    at: float
    model: GeneralizedMaxwell
    arm: tuple[float, float] | None
    expected: ExpectedError
    alternatives: tuple[ExpectedError, ...]
    band: tuple[float, float]
    record: RecordNeed
    end: ExpectedEnd
    pulse: Pulse | None
    checks: tuple[Check, ...]
    advice: tuple[str, ...]
    temperature: float = SHIFT.reference
    repeats: tuple[Repeat, ...] = ()
    arms: tuple[ExpectedArm, ...] = ()

    @property
    def _headline(self) -> str:
        """How well the loss factor would be known."""
        sd = format_relative_sd(self.expected.loss_factor_sd)
        return f"this test would give the loss factor at {self.at:g} Hz to {sd}"

    def __str__(self) -> str:
        head = f"{'method':<8}{'ramp, s':>10}{'hold, s':>10}{'storage':>12}{'loss factor':>14}"
        rows = [
            f"{e.method:<8}{e.ramp_time:>10.3g}{e.hold_time:>10.3g}"
            f"{percent(e.storage_sd, 'unknown'):>12}{percent(e.loss_factor_sd, 'unknown'):>14}"
            f"{f'  and at {format_temperatures(e.repeated)}' if e.repeated else ''}"
            for e in (self.expected, *self.alternatives)
        ]
        title = f"expected standard deviation at {self.at:g} Hz"
        return "\n".join([title, head, *rows, *self._arm_table, self.end.message, *self.advice])

    @property
    def _arm_table(self) -> list[str]:
        """A table of the arms."""
        if not self.arms:
            return []
        title = "half widths of 95 % limits of each arm"
        starred = (
            "* with drift, compliance and creep of the machine given, after a baseline of 10 s"
        )
        names = ("k", "tau", "b")
        titles = (*names, *(f"{name} *" for name in names))
        head = f"{'arm, s':<10}{''.join(f'{title:>12}' for title in titles)}"
        rows = []
        for arm in self.arms:
            group = [getattr(arm, f"{when}_{name}") for when in ("half", "named") for name in names]
            cells = (f"{percent(half, 'unknown'):>12}" for half in group)
            rows.append(f"{arm.tau:<10.3g}{''.join(cells)}")
        return [title, head, *rows, starred]


def plan(
    bench: Bench = Bench(),  # noqa: B008
    *,
    at: Quantity,
    seal: SupposedSeal = SupposedSeal(),  # noqa: B008
    hammer: HammerPlan = HammerPlan(),  # noqa: B008
    cold: Quantity | Sequence[Quantity] = (),
    wanted: float = WANTED,
) -> Plan:
    r"""Tell what a test will tell at a frequency, before it is run.

    Supposes that the seal has an arm at :math:`\tau = 1/\omega`, where it matters most for damping,
    and asks the Cramer-Rao bound how well the relaxation test would know storage stiffness and loss
    factor there (:mod:`dashpot.planning.expected_errors`), with offset, drift and delay of the
    force known before as the fit knows them. For the hammer test, how long the record must be and
    what the tip excites.

    >>> from dashpot.planning.planned_ramp_hold import Bench
    >>> plan(Bench(ramp_time="0.1s", noise="1mN"), at="12.71Hz").at
    12.71

    Parameters
    ----------
    bench : Bench
        The relaxation test.
    at : float
        The frequency that matters, Hz.
    seal : SupposedSeal
    hammer : HammerPlan
    cold : float or sequence of float
        Temperatures, K, at which the same test is repeated: arms that are too fast for the ramp
        are slower there (:mod:`dashpot.planning.planned_ramp_hold`).
    wanted : float
        The relative standard deviation of the loss factor that would do.

    Raises
    ------
    DataError
        If a number is not positive, or the law does not reach so far.
    """
    at = convert_to_si(at, "frequency")
    requested = [cold] if isinstance(cold, str | float | int) else cold
    places = [convert_to_si(item, "temperature") for item in requested]
    require_positive(at=at, wanted=wanted, expected=IN_SI)
    for place in places:
        require_positive(cold=place, expected=IN_SI)
    margin, law = seal.test_temperature, seal.law
    repeats = find_handler("plan repeats", "temperatures")(places, margin, law) if places else ()
    supposed, arm = seal.with_arm(at)
    index = None if arm is None else supposed.tau.index(arm[1])
    expected = expected_error(supposed, bench, at, index, repeats=repeats)
    total = hammer.seals * supposed
    weight = mass_for_peak(total, at) if hammer.mass is None else hammer.mass
    rows = hammer_rows(
        supposed,
        weight,
        seals=hammer.seals,
        lines=_lines(at, hammer.record),
        relative_sd=hammer.relative_sd,
    )
    alternatives = (
        *(
            expected_error(supposed, other, at, index, repeats=where)
            for other, where in _build_alternatives(bench, repeats, margin, law)
        ),
        expected_error(supposed, replace(bench, method="full"), at, index, rows),
    )
    need = record_need(total, weight, hammer.record)
    tip = None if hammer.pulse is None else half_sine(hammer.pulse, at)
    band = _band(bench, repeats)
    todo = format_remedy(expected, alternatives, wanted=wanted)
    answers = _checks(expected, band, need, tip, at=at, wanted=wanted, todo=todo)
    words = list_advice(
        expected, alternatives, answers, need, tip, at=at, wanted=wanted, margin=margin,
        without="" if arm is None else _without_arm(hammer.seals * seal.model, hammer.mass, at),
    )  # fmt: skip
    advise = find_handler("plan advice", "machine")
    if advise is not None and expected.loss_factor_sd > wanted:
        words += advise(supposed, bench, at, index)
    return Plan(
        at=at, model=supposed, arm=arm, expected=expected, alternatives=alternatives, band=band,
        record=need, end=expected_end(supposed, bench), pulse=tip, checks=answers, advice=words,
        temperature=margin, repeats=repeats, arms=expected_arms(seal.model, bench),
    )  # fmt: skip


def _build_alternatives(
    bench: Bench, repeats: Sequence[Repeat], margin: float, law: TemperatureLaw
) -> list[tuple[Bench, Sequence[Repeat]]]:
    """Return the tests beside the one that was asked for, each with its repeats."""
    other = replace(bench, method="hold" if bench.method == "full" else "full")
    faster = [
        replace(bench, method="full", ramp_time=bench.ramp_time * part)
        for part in FASTER
        if bench.ramp_time * part * bench.rate >= 5
    ]
    ramps = [(planned_test, ()) for planned_test in (other, *faster)]
    if not repeats:
        return [*ramps, *((bench, place) for place in _usual_cold(margin, law))]
    single = [(bench, (repeat,)) for repeat in repeats] if len(repeats) > 1 else []
    return [(bench, ()), *single, (other, repeats), *ramps]


def _usual_cold(margin: float, law: TemperatureLaw) -> list[tuple[Repeat]]:
    """Return a refrigerator, if it is colder than the room and the law reaches so far."""
    if margin < USUAL_COLD + COLDER:
        return []
    try:
        return [find_handler("plan repeats", "temperatures")([USUAL_COLD], margin, law)]
    except DataError:
        return []


def _band(bench: Bench, repeats: Sequence[Repeat]) -> tuple[float, float]:
    """Return the frequency range of ramp and hold, Hz; that of a repeat is a_T times as high."""
    slower = [1.0, *(repeat.a_t for repeat in repeats)]
    low, high = 1 / (2 * np.pi * bench.hold_time), 1 / (np.pi * bench.ramp_time)
    return min(slower) * low, max(slower) * high


def _without_arm(seal: GeneralizedMaxwell, mass: float | None, at: float) -> str:
    """Return the record that the seal needs if the arm that was supposed is not there."""
    need = record_need(seal, mass_for_peak(seal, at) if mass is None else mass, None)
    return f" ({compute_record_length(need):.3g} s if no arm of the seal damps there)"


def _lines(at: float, record: float | None) -> FloatArray:
    """Return the lines that a hammer test would give about the peak, Hz."""
    step = LINE_STEP if record is None else 1 / record
    first, last = at / AROUND, at * AROUND
    count = max(sample_count(last - first, 1 / step), 8)
    return np.asarray(first + step * np.arange(count, dtype=float))


# -- words ------------------------------------------------------------------------------------


def _checks(
    expected: ExpectedError,
    band: tuple[float, float],
    need: RecordNeed,
    tip: Pulse | None,
    *,
    at: float,
    wanted: float,
    todo: str,
) -> tuple[Check, ...]:
    new_checks = [
        checks.loss_factor_determined(expected.loss_factor_sd, at, wanted, remedy=todo),
        checks.inside_valid_band(at, band),
    ]
    if need.record is not None and need.peak_error is not None:
        new_checks.append(checks.record_long_enough(need))
    if tip is not None:
        new_checks.append(checks.tip_excites(tip, at))
    return tuple(new_checks)
