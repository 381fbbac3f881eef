"""Sizes that no test of a seal has: the unit is asked for again before its numbers are used."""

from __future__ import annotations

from dashpot.base.checks import Finding, criterion
from dashpot.base.units import in_unit

MOST_TRAVEL = 0.2
LEAST_TRAVEL = 2e-5
MOST_FORCE = 1e3
LEAST_FORCE = 1e-2
LEAST_TIME = 0.1
LONGEST_RAMP = 200.0
FASTEST_RAMP = 0.3
MOST_ACCELERATION = 1e4
LEAST_BLOW = 5e-2
MOST_SHOCK = 1e6
LEAST_STRAIN = 0.01
MOST_STRESS_FACTOR = 1e4
MOST_SPEED = 100.0
LEAST_CONTACT_RATE = 500.0
LEAST_RATE = 50.0
MOST_RATE = 2.5e5

_SMALLER = {
    "m": "mm", "cm": "mm", "ft": "mm", "in": "mm", "mm": "um", "MN": "kN", "kN": "N", "N": "mN",
    "kgf": "N", "lbf": "N", "min": "s", "h": "s", "s": "ms", "ms": "us",
    "g": "m/s^2", "m/s^2": "mm/s^2", "m/s": "mm/s",
}  # fmt: skip
"""What a unit is mistaken for most often, where its numbers are too large."""
_LARGER = {
    "mm": "m", "cm": "m", "in": "mm", "um": "mm", "nm": "um", "nN": "N", "uN": "N", "mN": "N",
    "N": "kN", "kN": "MN", "us": "s", "ms": "s", "s": "min", "mm/s^2": "m/s^2", "m/s^2": "g",
}  # fmt: skip
"""So too, where they are too small."""
_COARSE = {"mm", "cm", "in", "ft"}
"""Units of length in which no one writes a few micrometres."""


@criterion(
    "travel, m", "<=", MOST_TRAVEL, "our choice: no bench presses a seal so far", grade="stop"
)
def travel_of_a_seal(travel: float, unit: str) -> Finding:
    """The displacement goes no farther than a bench presses a seal."""
    says = f"the displacement goes over {_short(travel, 'm')}"
    return Finding(says, travel, instead=_doubted(says, "displacement", unit, _SMALLER))


@criterion(
    "travel, m",
    ">=",
    LEAST_TRAVEL,
    "our choice; less is a probe's, with its small force, in a small unit",
    grade="stop",
)
def travel_of_a_bench(travel: float, unit: str, *, force: float) -> Finding:
    """The displacement goes as far as a force of that size presses rubber."""
    says = f"the displacement goes over {_short(travel, 'm')}"
    probe = force < 10 * LEAST_FORCE and unit not in _COARSE
    beside = f"{says} under {_short(force, 'N')}"
    return Finding(
        says,
        travel,
        instead=_doubted(beside, "displacement", unit, _LARGER),
        excused=probe,
    )


@criterion(
    "rise of the force, N",
    "<=",
    MOST_FORCE,
    "our choice: ten times what a seal carries",
    grade="stop",
)
def force_of_a_seal(force: float, unit: str) -> Finding:
    """The force is no greater than a seal carries."""
    says = f"the force goes over {_short(force, 'N')}"
    return Finding(says, force, instead=_doubted(says, "force", unit, _SMALLER))


@criterion(
    "rise of the force, N",
    ">=",
    LEAST_FORCE,
    "our choice: over half a millimetre rubber pushes back more; a probe goes less far",
    grade="stop",
)
def force_of_a_bench(force: float, unit: str, *, travel: float) -> Finding:
    """The force is as great as rubber answers such a travel with."""
    says = f"the force goes over {_short(force, 'N')}"
    beside = f"{says} while the displacement goes over {_short(travel, 'm')}"
    return Finding(
        says,
        force,
        instead=_doubted(beside, "force", unit, _LARGER),
        excused=travel < 5e-4,
    )


@criterion(
    "length of the record, s",
    ">=",
    LEAST_TIME,
    "our choice: a ramp alone takes longer",
    grade="stop",
)
def time_of_a_test(duration: float, unit: str) -> Finding:
    """The record is as long as a ramp and a hold take."""
    says = f"the record lasts {_short(duration, 's')}"
    return Finding(says, duration, instead=_doubted(says, "time", unit, _LARGER))


@criterion(
    "length of the ramp, s",
    "<=",
    LONGEST_RAMP,
    "our choice: the seal relaxes as it is pressed",
    grade="stop",
)
def ramp_not_slow(duration: float, unit: str) -> Finding:
    """The ramp is over before most of the relaxation is."""
    says = f"the ramp takes {_short(duration, 's')}"
    return Finding(says, duration, instead=_doubted(says, "time", unit, _SMALLER))


@criterion(
    "speed of the ramp, m/s",
    "<=",
    FASTEST_RAMP,
    "our choice: no crosshead or screw is faster",
    grade="stop",
)
def ramp_not_fast(speed: float, unit: str) -> Finding:
    """The ramp is no faster than a bench drives."""
    says = f"the ramp goes at {_short(speed, 'm/s')}"
    return Finding(says, speed, instead=_doubted(says, "time", unit, _LARGER))


@criterion("greatest force, N", "<=", MOST_FORCE, "our choice: a sledge hammer's", grade="stop")
def hammer_not_heavy(force: float, unit: str) -> Finding:
    """The hammer hits no harder than a block on seals bears."""
    says = f"the hammer's force reaches {_short(force, 'N')}"
    return Finding(says, force, instead=_doubted(says, "hammer", unit, _SMALLER))


@criterion("greatest force, N", ">=", LEAST_BLOW, "our choice: a touch", grade="stop")
def hammer_felt(force: float, unit: str) -> Finding:
    """The hammer hits hard enough for a load cell."""
    says = f"the hammer's force reaches {_short(force, 'N')}"
    return Finding(says, force, instead=_doubted(says, "hammer", unit, _LARGER))


@criterion(
    "greatest acceleration, m/s^2",
    "<=",
    MOST_ACCELERATION,
    "our choice: a thousand g, twice a modal accelerometer's range",
    grade="stop",
)
def acceleration_not_large(acceleration: float, unit: str) -> Finding:
    """The acceleration is one that a modal accelerometer measures."""
    says = f"the acceleration reaches {_short(acceleration, 'm/s^2')}"
    return Finding(says, acceleration, instead=_doubted(says, "acceleration", unit, _SMALLER))


@criterion(
    "sampling rate, Hz", ">=", LEAST_RATE, "our choice: a pulse lasts 20 ms at most", grade="stop"
)
def hammer_sampled(rate: float, unit: str) -> Finding:
    """The record is sampled as fast as a hammer needs."""
    says = f"the record is sampled at {_short(rate, 'Hz')}"
    return Finding(says, rate, instead=_doubted(says, "time", unit, _SMALLER))


@criterion(
    "sampling rate, Hz", "<=", MOST_RATE, "our choice: no recorder of vibration", grade="stop"
)
def hammer_not_oversampled(rate: float, unit: str) -> Finding:
    """The record is sampled no faster than recorders of vibration do."""
    says = f"the record is sampled at {_short(rate, 'Hz')}"
    return Finding(says, rate, instead=_doubted(says, "time", unit, _LARGER))


@criterion(
    "greatest acceleration, m/s^2",
    "<=",
    MOST_SHOCK,
    "our choice: a hundred thousand g, the range of shock accelerometers",
    grade="stop",
)
def shock_not_large(acceleration: float, unit: str) -> Finding:
    """The acceleration of the indenter is one that a shock accelerometer measures."""
    says = f"the acceleration reaches {_short(acceleration, 'm/s^2')}"
    return Finding(says, acceleration, instead=_doubted(says, "acceleration", unit, _SMALLER))


@criterion(
    "greatest speed, m/s", "<=", MOST_SPEED, "our choice: rubber is hit more slowly", grade="stop"
)
def indenter_not_fast(speed: float, unit: str) -> Finding:
    """The indenter is no faster than a test of rubber drives it."""
    says = f"the velocity reaches {_short(speed, 'm/s')}"
    return Finding(says, speed, instead=_doubted(says, "velocity", unit, _SMALLER))


@criterion(
    "sampling rate, Hz",
    ">=",
    LEAST_CONTACT_RATE,
    "our choice: a contact lasts 40 ms at most",
    grade="stop",
)
def contact_rate(rate: float, unit: str) -> Finding:
    """The record is sampled as fast as a contact needs."""
    says = f"the record is sampled at {_short(rate, 'Hz')}"
    return Finding(says, rate, instead=_doubted(says, "time", unit, _SMALLER))


@criterion(
    "greatest strain", ">=", LEAST_STRAIN, "our choice: a law is no line there", grade="stop"
)
def strain_of_a_rubber(strain: float, unit: str) -> Finding:
    """The strain is one that shows a law."""
    says = f"the strain reaches {strain:.3g} of the length"
    return Finding(says, strain, instead=_doubted(says, "strain", unit, {"%": "1"}))


@criterion(
    "greatest stress, Pa",
    "x/",
    MOST_STRESS_FACTOR,
    "our choice: about 1 MPa, soft foam to hard rubber at break",
    grade="stop",
)
def stress_of_a_rubber(stress: float, unit: str) -> Finding:
    """The stress is one that rubber or foam bears."""
    says = f"the stress reaches {_short(stress, 'Pa')}"
    likely = {"Pa": "MPa", "kPa": "MPa"} if stress < 1e6 else {"GPa": "MPa", "MPa": "Pa"}
    doubted = _doubted(says, "stress", unit, likely)
    return Finding(says, in_unit(stress, "MPa"), instead=doubted)


def _doubted(says: str, role: str, unit: str, likely: dict[str, str]) -> str:
    likelier = likely.get(unit)
    better = f'is the unit {likelier}? Then add --units "{role}={likelier}"'
    if likelier is None:
        better = f'if the unit is another, add --units "{role}=UNIT"'
    return (
        f"{says}, in {unit} as the file has it: {better}; if it is meant so, say it: "
        f'--units "{role}={unit}"'
    )


def _short(value: float, unit: str) -> str:
    """A size as people say it: 2.1 kN, 41 ms."""
    for factor, prefix in ((1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "u")):
        if value >= factor:
            return f"{value / factor:.3g} {prefix}{unit}"
    return f"{value:.3g} {unit}"
