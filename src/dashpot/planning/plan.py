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
from dashpot.planning.assumed_seal import AssumedSeal
from dashpot.planning.checks import format_percent, format_relative_sd
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
from dashpot.registry import find_handler, require_handler
from dashpot.solids.demo_seals import SHIFT
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.shift_laws import TemperatureLaw
from dashpot.vibration.mass_on_seals import mass_for_peak

# Advice on a planned test, as text.


MIN_GAIN = 0.9
"""A repeat is advised if it lowers the standard deviation below this part of that without it."""


def list_advice(
    expected: ExpectedError,
    alternatives: Sequence[ExpectedError],
    checks: Sequence[Check],
    length_need: RecordNeed,
    tip: Pulse | None,
    *,
    frequency: float,
    target_sd: float,
    without_arm: str,
    test_temperature: float,
) -> tuple[str, ...]:
    """Return the advice on a planned test, most useful first.

    Temperatures are in K, frequencies in Hz, times in s.
    """
    advice = _format_cold_advice(
        expected, alternatives, frequency=frequency, test_temperature=test_temperature
    )
    if expected.loss_factor_sd > target_sd:
        advice.append(
            _format_ramp_advice(expected, alternatives, frequency=frequency, target_sd=target_sd)
        )
    if length_need.record is None:
        advice.append(
            f"Record each hit for {compute_record_length(length_need):.3g} s{without_arm}. Six "
            f"time constants last {length_need.for_decay:.3g} s; five lines in the half-power "
            f"band need {length_need.for_lines:.3g} s. With an exponential window a shorter record "
            "is enough."
        )
    failed = {check.name for check in checks if check.failed}
    if "record_long_enough" in failed:
        advice.append(
            f"Record each hit for {compute_record_length(length_need):.3g} s{without_arm} instead "
            f"of {length_need.record:g} s, or use an exponential window."
        )
    if tip is not None and "tip_excites" in failed:
        advice.append(
            "Use a harder tip. A pulse shorter than "
            f"{format_quantity(_compute_longest_pulse(frequency), 'ms', '.3g')} loses less than 10 "
            f"dB at {frequency:g} Hz."
        )
    if not advice:
        advice.append(f"This test determines the loss factor at {frequency:g} Hz well enough.")
    return tuple(advice)


def compute_record_length(length_need: RecordNeed) -> float:
    """Return the length of record that a hit needs, s."""
    return max(length_need.for_decay, length_need.for_lines)


def _format_cold_advice(
    expected: ExpectedError,
    alternatives: Sequence[ExpectedError],
    *,
    frequency: float,
    test_temperature: float,
) -> list[str]:
    """Return advice on repeats at other temperatures: their gain, and a missing one."""
    if not expected.repeated:
        return []
    without_repeats = next(
        e for e in alternatives if e.method == expected.method and not e.repeated
    )
    temperatures = format_temperatures(expected.repeated)
    before = format_relative_sd(without_repeats.loss_factor_sd)
    if expected.loss_factor_sd > MIN_GAIN * without_repeats.loss_factor_sd:
        hint = "" if min(expected.repeated) < test_temperature else " Test in the cold instead."
        sd_after = f"{format_relative_sd(expected.loss_factor_sd)} instead of {before}"
        return [
            (
                f"A repeat at {temperatures} hardly improves the loss factor at {frequency:g} Hz: "
                f"{sd_after}.{hint}"
            )
        ]
    message = (
        f"Repeat it at {temperatures} and fit all together. The loss factor at {frequency:g} Hz is "
        f"then known to {format_relative_sd(expected.loss_factor_sd)} instead of {before}, if all "
        "arms shift alike."
    )
    advice = [message]
    if len(expected.repeated) == 1:
        temperature_third = 5 * round(
            sum(
                convert_to_unit(value, "degC") for value in (test_temperature, expected.repeated[0])
            )
            / 10
        )
        advice.append(
            f"Test at a third temperature, such as {temperature_third:g} degC, too. Two "
            "temperatures cannot show arms that shift apart."
        )
    return advice


def _format_ramp_advice(
    expected: ExpectedError,
    alternatives: Sequence[ExpectedError],
    *,
    frequency: float,
    target_sd: float,
) -> str:
    changes = [
        f"{change} ({format_relative_sd(best.loss_factor_sd)})"
        for change, best in _list_changes(expected, alternatives, target_sd)
    ]
    no_faster_ramp = (
        ""
        if len(changes) > 1
        else f" No faster ramp that was tried gives {format_relative_sd(target_sd)}."
    )
    return (
        f"The loss factor at {frequency:g} Hz would be known to "
        f"{format_relative_sd(expected.loss_factor_sd)} "
        f"(1 SD) only.{no_faster_ramp} {sentence(', or '.join(changes))}"
    )


def format_remedy(
    expected: ExpectedError, alternatives: Sequence[ExpectedError], *, target_sd: float
) -> str:
    """Return the changes that give the wanted loss factor, in one or two sentences."""
    *faster_ramps, hammer = (
        change for change, _ in _list_changes(expected, alternatives, target_sd)
    )
    if not faster_ramps:
        return sentence(hammer)
    return f"{sentence(', or '.join(faster_ramps))} Alternatively, {hammer}."


def _list_changes(
    expected: ExpectedError, alternatives: Sequence[ExpectedError], target_sd: float
) -> list[tuple[str, ExpectedError]]:
    joint = next(e for e in alternatives if e.method == "joint")
    changes = [
        _find_faster_ramp(expected, alternatives, target_sd),
        _find_colder_repeat(expected, alternatives, target_sd),
    ]
    pairs = [(change, best) for change, best in changes if best is not None]
    return [*pairs, ("add a hammer test and fit both together", joint)]


Change: TypeAlias = tuple[str, ExpectedError | None]
"""Change of the test and its expected error; None if no change of the kind is enough."""


def _find_faster_ramp(
    expected: ExpectedError, alternatives: Sequence[ExpectedError], target_sd: float
) -> Change:
    """Return the slowest ramp that is fast enough, or the other method."""
    good_plans = [
        e
        for e in alternatives
        if e.loss_factor_sd <= target_sd and e.method != "joint" and not e.repeated
    ]
    if not good_plans:
        return "", None
    best = max(good_plans, key=lambda e: e.ramp_time)
    change = f"ramp in {duration(best.ramp_time)}" if best.ramp_time < expected.ramp_time else ""
    fit = "fit ramp and hold together" if best.method != expected.method else ""
    return " and ".join(part for part in (change, fit) if part), best


def _find_colder_repeat(
    expected: ExpectedError, alternatives: Sequence[ExpectedError], target_sd: float
) -> Change:
    """Return a repeat in the cold, if none is planned and it is enough."""
    good_plans = [e for e in alternatives if e.repeated and e.loss_factor_sd <= target_sd]
    if expected.repeated or not good_plans:
        return "", None
    return f"repeat it at {format_temperatures(good_plans[0].repeated)}", good_plans[0]


def format_temperatures(temperatures: Sequence[float]) -> str:
    """Return temperatures, K, as text in degC.

    >>> format_temperatures((273.15,)), format_temperatures((283.15, 273.15, 253.15))
    ('0 degC', '10, 0 and -20 degC')
    """
    *other_texts, last = (f"{convert_to_unit(kelvin, 'degC'):.4g}" for kelvin in temperatures)
    return f"{', '.join(other_texts)}{' and ' * bool(other_texts)}{last} degC"


def _compute_longest_pulse(frequency: float) -> float:
    # the spectrum depends on f T alone
    return half_sine(1.0, frequency).band_10db / frequency


TARGET_SD = 0.1
RAMP_TIME_RATIOS = (0.3, 0.1, 0.03)
# a hammer test determines the lines within this factor of the peak; their usual spacing, Hz
HAMMER_SPAN = 3.5
LINE_STEP = 0.1
# default temperature of a repeat, a refrigerator, K; it is tried if so much colder than the test
USUAL_COLD = 273.15
MIN_COOLING = 10.0


@dataclass(frozen=True)
class Plan(HasChecks, Serialisable):
    """Plan of a test: expected errors at a frequency, and advice on changes.

    Attributes
    ----------
    at : float
        Hz.
    model : GeneralizedMaxwell
        The assumed model of the seal, the unresolved arm included.
    arm : (float, float) or None
        Stiffness, N/m, and relaxation time, s, of the arm that the test may not show.
    expected : ExpectedError
        Errors of the requested test with its repetitions.
    alternatives : tuple of ExpectedError
        Errors of the test alone and at each other temperature, of the other method, of faster
        ramps, of the test repeated at 0 degC if no other was requested, and with a hammer test.
    band : (float, float)
        Frequency range of the relaxation test, Hz.
    record : RecordNeed
    pulse : Pulse or None
    checks : tuple of Check
    advice : tuple of str
        Advised changes, most useful first.
    temperature : float
        Temperature of the test, K.
    repeats : tuple of Repeat
        The requested repetitions.
    arms : tuple of ExpectedArm
        Expected errors of each arm of the seal, but for the unseen one, by the test without its
        repeats.
    end : ExpectedEnd
        Expected error of the stiffness at the end of the hold, by the test without its repeats,
        with and without the effects of the machine stated.
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
        """The expected error of the loss factor, as a sentence."""
        sd = format_relative_sd(self.expected.loss_factor_sd)
        return f"this test would give the loss factor at {self.at:g} Hz to {sd}"

    def __str__(self) -> str:
        header = f"{'method':<8}{'ramp, s':>10}{'hold, s':>10}{'storage':>12}{'loss factor':>14}"
        rows = [
            f"{e.method:<8}{e.ramp_time:>10.3g}{e.hold_time:>10.3g}"
            f"{format_percent(e.storage_sd, 'unknown'):>12}"
            f"{format_percent(e.loss_factor_sd, 'unknown'):>14}"
            f"{f'  and at {format_temperatures(e.repeated)}' if e.repeated else ''}"
            for e in (self.expected, *self.alternatives)
        ]
        title = (
            f"expected standard deviation at {self.at:g} Hz; full: fit of ramp and hold, "
            "joint: with a hammer test"
        )
        return "\n".join([title, header, *rows, *self._arm_table, self.end.message, *self.advice])

    @property
    def _arm_table(self) -> list[str]:
        """Lines of the table of arms."""
        if not self.arms:
            return []
        title = "half width of the 95 % interval of each arm"
        starred = (
            "* with drift, compliance and creep of the machine given, after a baseline of 10 s"
        )
        names = ("k", "tau", "b")
        titles = (*names, *(f"{name} *" for name in names))
        header = f"{'arm, s':<10}{''.join(f'{title:>12}' for title in titles)}"
        rows = []
        for arm in self.arms:
            group = [
                getattr(arm, f"{prefix}_{name}") for prefix in ("half", "named") for name in names
            ]
            cells = (f"{format_percent(half_width, 'unknown'):>12}" for half_width in group)
            rows.append(f"{arm.tau:<10.3g}{''.join(cells)}")
        return [title, header, *rows, starred]


def plan(
    bench: Bench = Bench(),  # noqa: B008
    *,
    at: Quantity,
    seal: AssumedSeal = AssumedSeal(),  # noqa: B008
    hammer: HammerPlan = HammerPlan(),  # noqa: B008
    cold: Quantity | Sequence[Quantity] = (),
    target_sd: float = TARGET_SD,
) -> Plan:
    r"""Return the expected errors of a test at a frequency, before it is run, and advice.

    The seal is assumed to have an arm at :math:`\tau = 1/\omega`, where it has most effect on
    damping. The Cramer-Rao bound gives the errors of storage stiffness and loss factor there
    (:mod:`dashpot.planning.expected_errors`), with the priors of offset, drift and delay that the
    fit has. For a hammer test: the length of record that it needs, and the band that its tip
    excites.

    >>> from dashpot.planning.planned_ramp_hold import Bench
    >>> plan(Bench(ramp_time="0.1s", noise="1mN"), at="12.71Hz").at
    12.71

    Parameters
    ----------
    bench : Bench
        The relaxation test.
    at : float
        The frequency of interest, Hz.
    seal : AssumedSeal
    hammer : HammerPlan
    cold : float or sequence of float
        Temperatures, K, at which the same test is repeated: arms that are too fast for the ramp
        are slower there (:mod:`dashpot.planning.planned_ramp_hold`).
    target_sd : float
        The relative standard deviation of the loss factor that is enough.

    Raises
    ------
    DataError
        If a number is not positive, or the law does not reach so far.
    """
    at = convert_to_si(at, "frequency")
    requested = [cold] if isinstance(cold, str | float | int) else cold
    cold_temperatures = [convert_to_si(item, "temperature") for item in requested]
    require_positive(at=at, wanted=target_sd, expected=IN_SI)
    for temperature in cold_temperatures:
        require_positive(cold=temperature, expected=IN_SI)
    test_temperature, law = seal.test_temperature, seal.law
    repeats = (
        require_handler("plan repeats", "temperatures")(cold_temperatures, test_temperature, law)
        if cold_temperatures
        else ()
    )
    model, arm = seal.with_arm(at)
    index = None if arm is None else model.tau.index(arm[1])
    expected = expected_error(model, bench, at, index, repeats=repeats)
    total = hammer.seals * model
    mass = mass_for_peak(total, at) if hammer.mass is None else hammer.mass
    rows = hammer_rows(
        model,
        mass,
        seals=hammer.seals,
        lines=_compute_hammer_lines(at, hammer.record),
        relative_sd=hammer.relative_sd,
    )
    alternatives = (
        *(
            expected_error(model, other, at, index, repeats=other_repeats)
            for other, other_repeats in _build_alternatives(bench, repeats, test_temperature, law)
        ),
        expected_error(model, replace(bench, method="full"), at, index, rows),
    )
    length_need = record_need(total, mass, hammer.record)
    tip = None if hammer.pulse is None else half_sine(hammer.pulse, at)
    band = _compute_frequency_range(bench, repeats)
    remedy = format_remedy(expected, alternatives, target_sd=target_sd)
    answered_checks = _run_checks(
        expected, band, length_need, tip, frequency=at, target_sd=target_sd, remedy=remedy
    )
    without_arm = (
        ""
        if arm is None
        else _format_record_without_arm(hammer.seals * seal.model, hammer.mass, at)
    )
    advice = list_advice(
        expected, alternatives, answered_checks, length_need, tip, frequency=at,
        target_sd=target_sd, test_temperature=test_temperature, without_arm=without_arm,
    )  # fmt: skip
    advise = find_handler("plan advice", "machine")
    if advise is not None and expected.loss_factor_sd > target_sd:
        advice += advise(model, bench, at, index)
    return Plan(
        at=at, model=model, arm=arm, expected=expected, alternatives=alternatives, band=band,
        record=length_need, end=expected_end(model, bench), pulse=tip, checks=answered_checks,
        advice=advice, temperature=test_temperature, repeats=repeats,
        arms=expected_arms(seal.model, bench),
    )  # fmt: skip


def _build_alternatives(
    bench: Bench, repeats: Sequence[Repeat], test_temperature: float, law: TemperatureLaw
) -> list[tuple[Bench, Sequence[Repeat]]]:
    """Return the alternatives to a planned test, each with its repeats."""
    other = replace(bench, method="hold" if bench.method == "full" else "full")
    faster_benches = [
        replace(bench, method="full", ramp_time=bench.ramp_time * part)
        for part in RAMP_TIME_RATIOS
        if bench.ramp_time * part * bench.rate >= 5
    ]
    ramps = [(planned_test, ()) for planned_test in (other, *faster_benches)]
    if not repeats:
        return [
            *ramps,
            *((bench, repeats) for repeats in _list_cold_repeats(test_temperature, law)),
        ]
    single = [(bench, (repeat,)) for repeat in repeats] if len(repeats) > 1 else []
    return [(bench, ()), *single, (other, repeats), *ramps]


def _list_cold_repeats(test_temperature: float, law: TemperatureLaw) -> list[tuple[Repeat]]:
    """Return the repeat in a refrigerator, if it is colder and within the range of the law."""
    plan_repeats = find_handler("plan repeats", "temperatures")
    if plan_repeats is None or test_temperature < USUAL_COLD + MIN_COOLING:
        return []
    try:
        return [plan_repeats([USUAL_COLD], test_temperature, law)]
    except DataError:
        return []


def _compute_frequency_range(bench: Bench, repeats: Sequence[Repeat]) -> tuple[float, float]:
    """Return the frequency range of ramp and hold, Hz; that of a repeat is a_T times as high."""
    slower = [1.0, *(repeat.a_t for repeat in repeats)]
    low, high = 1 / (2 * np.pi * bench.hold_time), 1 / (np.pi * bench.ramp_time)
    return min(slower) * low, max(slower) * high


def _format_record_without_arm(
    seal: GeneralizedMaxwell, mass: float | None, frequency: float
) -> str:
    """Return the length of record for a seal without the assumed arm, as text."""
    length_need = record_need(seal, mass_for_peak(seal, frequency) if mass is None else mass, None)
    return f" ({compute_record_length(length_need):.3g} s if no arm of the seal adds damping there)"


def _compute_hammer_lines(frequency: float, record: float | None) -> FloatArray:
    """Return the lines that a hammer test would give about the peak, Hz."""
    step = LINE_STEP if record is None else 1 / record
    first, last = frequency / HAMMER_SPAN, frequency * HAMMER_SPAN
    count = max(sample_count(last - first, 1 / step), 8)
    return np.asarray(first + step * np.arange(count, dtype=float))


# -- Texts ------------------------------------------------------------------------------------


def _run_checks(
    expected: ExpectedError,
    band: tuple[float, float],
    length_need: RecordNeed,
    tip: Pulse | None,
    *,
    frequency: float,
    target_sd: float,
    remedy: str,
) -> tuple[Check, ...]:
    new_checks = [
        checks.loss_factor_determined(expected.loss_factor_sd, frequency, target_sd, remedy=remedy),
        checks.inside_valid_band(frequency, band),
    ]
    if length_need.record is not None and length_need.peak_error is not None:
        new_checks.append(checks.record_long_enough(length_need))
    if tip is not None:
        new_checks.append(checks.tip_excites(tip, frequency))
    return tuple(new_checks)
