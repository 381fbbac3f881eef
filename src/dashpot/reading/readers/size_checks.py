"""Checks of sizes against those of real tests, which reveal a wrong unit."""

from __future__ import annotations

from typing import TypedDict

import numpy as np

from dashpot.base.checks import Criterion, Finding, Grade, Remedy, criterion
from dashpot.base.units import convert_to_unit
from dashpot.base.value_ranges import SIZES, format_quantity_short

# Sizes of seals and their tests.


MIN_TRAVEL = SIZES["travel"].soft[0]
MIN_FORCE = SIZES["force"].soft[0]
MIN_STIFFNESS = SIZES["stiffness"].soft[0]
MAX_STRESS_FACTOR = 1e4

_SMALLER = {
    "m": "mm", "cm": "mm", "ft": "mm", "in": "mm", "mm": "um", "MN": "kN", "kN": "N", "N": "mN",
    "kgf": "N", "lbf": "N", "min": "s", "h": "s", "s": "ms", "ms": "us",
    "g": "m/s^2", "m/s^2": "mm/s^2", "m/s": "mm/s",
}  # fmt: skip
"""Likely unit where the numbers are too large."""
_LARGER = {
    "mm": "m", "cm": "m", "in": "mm", "um": "mm", "nm": "um", "nN": "N", "uN": "N", "mN": "N",
    "N": "kN", "kN": "MN", "us": "s", "ms": "s", "s": "min", "mm/s^2": "m/s^2", "m/s^2": "g",
}  # fmt: skip
"""Likely unit where the numbers are too small."""
_COARSE = {"mm", "cm", "in", "ft"}
"""Units of length in which no one writes a few micrometres."""


def make_size_criterion(
    name: str,
    question: str,
    measure: str,
    reason: str,
    *,
    message: str,
    role: str,
    grade: Grade = "stop",
) -> Criterion[[float, str]]:
    """Return the check of one size, in the unit of a column role; `message` names the size.

    As a note it asks for no unit: some tests have such sizes.

    `measure` is the size with its rule, limit and unit, such as ``"travel <= 0.2 m"``.
    """
    quantity_name, rule, limit, symbol = measure.rsplit(maxsplit=3)
    # what goes with one over time is too large where time is too small
    is_too_large = (rule == "<=") != (role == "time" and symbol != "s")
    likely_units = _SMALLER if is_too_large else _LARGER

    @criterion(
        f"{quantity_name}, {symbol}", rule, float(limit), f"our choice: {reason}",
        grade=grade, name=name, question=question,
    )  # fmt: skip
    def evaluate(size: float, unit: str) -> Finding:
        text = f"{message} {format_quantity_short(size, symbol)}"
        return Finding(text, size, **make_unit_advice(text, role, unit, likely_units))

    return evaluate


travel_of_a_seal = make_size_criterion(
    "travel_of_a_seal",
    "The displacement is no larger than in bench tests of seals.",
    f"travel <= {SIZES['travel'].soft[1]!r} m", "few benches press a seal so far",
    message="The displacement spans", role="displacement", grade="note",
)  # fmt: skip


@criterion(
    "travel, m",
    ">=",
    MIN_TRAVEL,
    "our choice; less is an indenter's",
    grade="stop",
)
def travel_of_a_bench(travel: float, unit: str, *, force: float) -> Finding:
    """The displacement is as large as rubber needs for such a force."""
    message = f"The displacement spans {format_quantity_short(travel, 'm')}"
    is_indenter = force < 10 * MIN_FORCE and unit not in _COARSE
    text = f"{message} under {format_quantity_short(force, 'N')}"
    return Finding(
        message,
        travel,
        **make_unit_advice(text, "displacement", unit, _LARGER),
        always_passes=is_indenter,
    )


force_of_a_seal = make_size_criterion(
    "force_of_a_seal",
    "The force is no greater than a seal carries.",
    f"rise of the force <= {SIZES['force'].soft[1]!r} N", "ten times what a seal carries",
    message="The force spans", role="force", grade="note",
)  # fmt: skip


@criterion(
    "rise of the force, N",
    ">=",
    MIN_FORCE,
    "our choice: rubber has more force at 0.5 mm; an indenter moves less",
    grade="stop",
)
def force_of_a_bench(force: float, unit: str, *, travel: float) -> Finding:
    """The force is as large as rubber gives for such a displacement."""
    message = f"The force spans {format_quantity_short(force, 'N')}"
    text = f"{message} while the displacement spans {format_quantity_short(travel, 'm')}"
    return Finding(
        message,
        force,
        **make_unit_advice(text, "force", unit, _LARGER),
        always_passes=travel < 5e-4,
    )


@criterion(
    "rise of the force over travel, N/m",
    ">=",
    MIN_STIFFNESS,
    "our choice: a tenth of the softest foam strip; an indenter has less",
    grade="note",
)
def stiffness_of_a_seal(force: float, unit: str, *, travel: float, travel_unit: str) -> Finding:
    """The ratio of force to displacement is no lower than that of a soft seal."""
    message = f"The force spans {format_quantity_short(force, 'N')} while the displacement spans "
    message += format_quantity_short(travel, "m")
    return Finding(
        message,
        force / travel if travel > 0 else None,
        **make_unit_advice(message, "force", unit, _LARGER),
        always_passes=travel_unit not in _COARSE,
    )


time_of_a_test = make_size_criterion(
    "time_of_a_test",
    "The record is long enough for a ramp and a hold.",
    f"length of the record >= {SIZES['record'].soft[0]!r} s", "a ramp alone takes longer",
    message="The record lasts", role="time",
)  # fmt: skip


@criterion(
    "change of step over a power of 1,000, as a factor",
    ">=",
    2.0,
    "our choice: rates change by 10 and 100, units by 1,000",
    grade="stop",
)
def clock_unit_constant(step_before: float, step_after: float, time: float, unit: str) -> Finding:
    """The time steps have one unit from first to last."""
    decades = abs(np.log10(step_after / step_before))
    distance_from_thousand = abs(decades - 3 * max(round(decades / 3), 1))
    message = (
        f"The clock's steps go from {format_quantity_short(step_before, 's')} to "
        f"{format_quantity_short(step_after, 's')} at {time:.6g} s"
    )
    return Finding(
        message,
        float(10**distance_from_thousand),
        failure=f"{message}. Its unit may change there",
        remedy=Remedy(f"Correct the clock there, or confirm {unit}.", "units", f"time={unit}"),
    )


ramp_not_slow = make_size_criterion(
    "ramp_not_slow",
    "The ramp ends before most of the relaxation is over.",
    f"length of the ramp <= {SIZES['ramp'].soft[1]!r} s", "the seal relaxes during the ramp",
    message="The ramp takes", role="time", grade="note",
)  # fmt: skip


@criterion(
    "size / largest, or least / size", "<=", 1.0, "the table of plausible sizes", grade="stop"
)
def size_possible(kind: str, size: float, unit: str, *, role: str) -> Finding:
    """The value is possible in a test of rubber."""
    row = SIZES[kind]
    low, high = row.hard
    message = f"{row.description} is {format_quantity_short(size, row.unit)}"
    expected = (
        f"{message}, where {format_quantity_short(low, row.unit)} to "
        f"{format_quantity_short(high, row.unit)} is expected"
    )
    likely_units = _SMALLER if size > high else _LARGER
    excess_factor = max(size / high, low / size) if size > 0 else 0.0
    return Finding(message, excess_factor, **make_unit_advice(expected, role, unit, likely_units))


ramp_not_fast = make_size_criterion(
    "ramp_not_fast",
    "The ramp is no faster than a test machine.",
    "speed of the ramp <= 0.3 m/s", "no crosshead or screw is faster",
    message="The ramp goes at", role="time",
)  # fmt: skip
hammer_not_heavy = make_size_criterion(
    "hammer_not_heavy",
    "The hammer force is no larger than a mass on seals can take.",
    "greatest force <= 1e3 N", "a sledge hammer",
    message="The hammer's force reaches", role="hammer",
)  # fmt: skip
impact_force_measurable = make_size_criterion(
    "impact_force_measurable",
    "The hammer force is large enough for a load cell.",
    "greatest force >= 5e-2 N", "a touch of the hand",
    message="The hammer's force reaches", role="hammer",
)  # fmt: skip
acceleration_not_large = make_size_criterion(
    "acceleration_not_large",
    "The acceleration is within the range of a modal accelerometer.",
    "greatest acceleration <= 1e4 m/s^2", "a thousand g, twice a modal accelerometer's range",
    message="The acceleration reaches", role="acceleration",
)  # fmt: skip
hammer_sampled = make_size_criterion(
    "hammer_sampled",
    "The sampling rate is high enough for a hammer test.",
    "sampling rate >= 50.0 Hz", "a pulse lasts 20 ms at most",
    message="The record is sampled at", role="time",
)  # fmt: skip
hammer_not_oversampled = make_size_criterion(
    "hammer_not_oversampled",
    "The sampling rate is no higher than that of vibration recorders.",
    "sampling rate <= 2.5e5 Hz", "no vibration recorder is faster",
    message="The record is sampled at", role="time",
)  # fmt: skip


@criterion(
    "greatest stress, Pa",
    "x/",
    MAX_STRESS_FACTOR,
    "our choice: about 1 MPa, soft foam to hard rubber at break",
    grade="stop",
)
def stress_of_a_rubber(stress: float, unit: str) -> Finding:
    """The stress is possible in rubber or foam."""
    message = f"The stress reaches {format_quantity_short(stress, 'Pa')}"
    likely_units = {"Pa": "MPa", "kPa": "MPa"} if stress < 1e6 else {"GPa": "MPa", "MPa": "Pa"}
    return Finding(
        message,
        convert_to_unit(stress, "MPa"),
        **make_unit_advice(message, "stress", unit, likely_units),
    )


class _Advice(TypedDict):
    failure: str
    remedy: Remedy


def make_unit_advice(message: str, role: str, unit: str, likely_units: dict[str, str]) -> _Advice:
    """Return the question after a unit, and the unit that is likelier."""
    likelier = likely_units.get(unit)
    question = f"{message}, in {unit} as the file has it."
    words = f"Give the unit of the {role}, or confirm {unit}."
    if likelier is not None:
        question += f" The unit may be {likelier}."
        words = f"Give {likelier} as the unit of the {role}, or confirm {unit}."
    return {
        "failure": question,
        "remedy": Remedy(words, "units", f"{role}={likelier or unit}"),
    }
