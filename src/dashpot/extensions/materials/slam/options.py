"""Options of slam tests; imports no NumPy, so that help is fast."""

from __future__ import annotations

from dashpot.base import dataclass
from dashpot.base.option_fields import option


@dataclass(frozen=True)
class SlamOptions:
    """Options of a slam: speeds, or heights of fall.

    Attributes
    ----------
    slam : tuple of str
        Each the speed at the touch, ``"0.6m/s"``, or the height of a fall, ``"18mm"``: of the hits
        in their order.
    """

    slam: tuple[str, ...] = option(
        (), "Impact speed of the mass, 0.6m/s, or drop height, 18mm.", metavar="SPEED",
        multiple=True, flag="drop", former="slam",
    )  # fmt: skip
