"""What no one means: quantities beyond every seal, machine and test, so that a unit is wrong."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

from dashpot.base.errors import DataError
from dashpot.base.units import written


class Limits(NamedTuple):
    """Between which values a quantity is meant, SI, and the unit in which people read it."""

    least: float
    most: float
    unit: str
    verb: str = "is"


HARD: Mapping[str, Limits] = MappingProxyType({
    "displacement": Limits(1e-6, 0.5, "mm", "spans"),
    "force": Limits(0.0, 1e6, "N", "reaches"),
    "time": Limits(0.0, 30 * 86400.0, "s", "spans"),
    "mass": Limits(0.0, 1000.0, "kg"),
})  # fmt: skip
"""By the name of the quantity: span of a displacement, size of a force, length of a record."""


def refuse_absurd_record(noun: Any) -> None:
    """Refuse a record of force over displacement that no one means; its time may be None."""
    spans = {name: getattr(noun, name) for name in ("displacement", "time")}
    refuse_absurd(
        'Check the unit: units="s, mm, N" in Python, --units displacement=mm at the command line',
        force=float(abs(noun.force).max()),
        **{
            name: None if one is None else float(one.max() - one.min())
            for name, one in spans.items()
        },
    )


def refuse_absurd(hint: str = "Check its unit", **values: float | None) -> None:
    """Refuse a quantity that no one means, SI; None is not known, and 0 nothing that moved.

    Raises
    ------
    DataError
        If one lies beyond its limits of :data:`HARD`.
    """
    for name, value in values.items():
        limits = HARD[name]
        if value and not limits.least <= abs(value) <= limits.most:
            least = f"{written(limits.least, limits.unit)} to " if limits.least else "at most "
            raise DataError(
                f"{name} {limits.verb} {written(value, limits.unit)}; expected {least}"
                f"{written(limits.most, limits.unit)}. {hint}"
            )
