"""Acceptance limits of the quantities of a lot."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from dashpot.base import dataclass
from dashpot.base.serialisation import Serialisable
from dashpot.extensions.batch.quantities import Quantity, quantity
from dashpot.registry import require_handler


@dataclass(frozen=True)
class Limits(Serialisable):
    """Acceptance limits of one quantity.

    Attributes
    ----------
    quantity : Quantity
    lower, upper : float or None
        SI.
    cpk : float or None
        Required Cpk.
    """

    _keys = ("lower", "upper", "cpk")

    quantity: Quantity
    lower: float | None = None
    upper: float | None = None
    cpk: float | None = None

    @property
    def ends(self) -> tuple[float, ...]:
        """The limits that there are."""
        return tuple(end for end in (self.lower, self.upper) if end is not None)

    def judge(self, low: float, high: float) -> str:
        """Return whether an interval keeps to the limits: met, missed, or open."""
        outcome: str = require_handler("judge interval", "limits")(
            self.lower, self.upper, low, high
        )
        return outcome

    @property
    def distance(self) -> float | None:
        """Distance of the two limits; None where one is missing."""
        return None if self.lower is None or self.upper is None else self.upper - self.lower

    def __str__(self) -> str:
        limit_texts = [
            f"{word} {self.quantity.read(end)}"
            for word, end in (("at least", self.lower), ("at most", self.upper))
            if end is not None
        ]
        return " and ".join(limit_texts)


def read_limits(path: str | Path, columns: Sequence[str]) -> tuple[Limits, ...]:
    """Return the limits that a TOML states, each a table named as a quantity of the columns.

    Raises
    ------
    ReadError
        If the file is no such TOML, or names an unknown column.
    """
    entries = require_handler("read limits", "file")(path, partial(quantity, columns=columns))
    return tuple(Limits(entry.quantity, entry.lower, entry.upper, entry.cpk) for entry in entries)
