"""Options of an aging law; imports no NumPy, so that help is fast."""

from __future__ import annotations

from dashpot.base import dataclass
from dashpot.base.option_fields import option


@dataclass(frozen=True)
class AgingPredictionOptions:
    """Options of a prediction of aging.

    Attributes
    ----------
    until : tuple of str
        Each a part of F0 that is left, ``"50%"``, or a time, ``"1000h"``; by default half of it.
    new : str
        Path of the fit of a new seal, which is converted to the aged seal.
    """

    until: tuple[str, ...] = option(
        (),
        "Share of force left, 50%, or a time, 1000h.",
        metavar="END",
        multiple=True,
        flag="end",
        hidden_alias="until",
    )
    new: str = option(
        "",
        "Fit of an unaged seal: -o writes it aged.",
        metavar="FIT",
        flag="unaged-fit",
        hidden_alias="new",
    )
