"""Sizes that no seal has: the unit of a column is asked for again before its numbers are used."""

from __future__ import annotations

from dashpot.base.checks import Finding, criterion

MOST_TRAVEL = 1.0
MOST_FORCE = 1e3
LEAST_TIME = 0.1

_LIKELIER = {
    "m": "mm", "cm": "mm", "ft": "mm", "in": "mm", "mm": "um", "MN": "kN", "kN": "N", "N": "mN",
    "kgf": "N", "lbf": "N", "ms": "s", "us": "ms",
}  # fmt: skip
"""What a unit is mistaken for most often."""


@criterion(
    "travel, m", "<=", MOST_TRAVEL, "our choice: no bench presses a seal by metres", grade="stop"
)
def travel_of_a_seal(travel: float, unit: str) -> Finding:
    """The displacement goes no farther than a bench presses a seal."""
    says = f"the displacement goes over {_short(travel, 'm')}"
    return Finding(says, travel, instead=_doubted(says, "displacement", unit))


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
    return Finding(says, force, instead=_doubted(says, "force", unit))


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
    return Finding(says, duration, instead=_doubted(says, "time", unit))


def _doubted(says: str, role: str, unit: str) -> str:
    likelier = _LIKELIER.get(unit)
    better = f'is the unit {likelier}? Then add --units "{role}={likelier}"'
    if likelier is None:
        better = f'if the unit is another, add --units "{role}=UNIT"'
    return (
        f"{says}, in {unit} as the file has it: {better}; if it is meant so, say it: "
        f'--units "{role}={unit}"'
    )


def _short(value: float, unit: str) -> str:
    """A size as people say it: 2.1 kN, 41 ms."""
    for factor, prefix in ((1e3, "k"), (1.0, ""), (1e-3, "m")):
        if value >= factor:
            return f"{value / factor:.3g} {prefix}{unit}"
    return f"{value:.3g} {unit}"
