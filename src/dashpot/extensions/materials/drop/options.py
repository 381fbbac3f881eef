"""Options of drop tests; imports no NumPy, so that help is fast."""

from __future__ import annotations

from dashpot.base import dataclass
from dashpot.base.option_fields import option


@dataclass(frozen=True)
class DropOptions:
    """Options of a drop test: impact speeds, or drop heights.

    Attributes
    ----------
    drop : tuple of str
        Impact speed, ``"0.6m/s"``, or drop height, ``"18mm"``, of each impact in its order.
    """

    drop: tuple[str, ...] = option(
        (), "Impact speed of the mass, 0.6m/s, or drop height, 18mm.", metavar="SPEED",
        multiple=True, flag="drop", former="slam",
    )  # fmt: skip
