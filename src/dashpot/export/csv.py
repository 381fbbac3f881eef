"""Tables as comma-separated text."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from dashpot.export.deck import Deck
from dashpot.export.frequency_tables import tabulate
from dashpot.export.number_fields import text
from dashpot.export.open_deck import Solid, choose_form, open_deck
from dashpot.records.specimen import Specimen

FORMS = ("frequency", "arms")
_VERIFIED = "verified: read back in dashpot's tests"


def csv(
    solid: Solid,
    *,
    units: str | None = None,
    specimen: Specimen | None = None,
    allow: Collection[str] = (),
    form: str = "frequency",
    frequency_range: tuple[float, float] = (1.0, 100.0),
    tolerance: float = 1e-3,
) -> str:
    """Comma-separated text: dynamic stiffness against frequency, or the arms.

    ``"frequency"`` has one row per frequency: storage and loss stiffness, loss factor, viscous
    equivalent, and 1 where the row is extrapolated; ``"arms"`` one row per element. Comments
    stand behind ``#``, so that no cell of the file's own can be taken for a formula.

    Parameters are those of :func:`dashpot.export.nastran.nastran`.
    """
    choose_form(form, FORMS, "csv")
    deck = open_deck(solid, units=units, specimen=specimen, allow=allow)
    return _arms(deck) if form == "arms" else _frequency(deck, frequency_range, tolerance)


def _arms(deck: Deck) -> str:
    units = deck.units
    rows = [("k_inf", text(deck.k_inf), "", "")]
    if deck.b > 0:
        rows.append(("parallel dashpot", "", "", text(deck.b)))
    rows += [
        (f"arm {j}", text(k), text(tau), text(b))
        for j, (k, tau, b) in enumerate(deck.arms, start=1)
    ]
    names = f"element,k [{units.stiffness_word}],tau [{units.words[2]}],b [{units.damping_word}]"
    header = deck.header("#", "springs and dashpots", verified=_VERIFIED)
    return "\n".join([*header, names, *(",".join(row) for row in rows), ""])


def _frequency(deck: Deck, frequency_range: tuple[float, float], tolerance: float) -> str:
    units = deck.units
    table = tabulate(
        deck.model,
        frequency_range=frequency_range,
        tolerance=tolerance,
        damping="loss_factor",
        edges=deck.band or (),
        rounded=lambda value: float(text(value)),
    )
    header = deck.header("#", "dynamic stiffness", verified=_VERIFIED, remarks=[table.says])
    names = (
        f"frequency [{units.frequency_word}],storage [{units.stiffness_word}],"
        f"loss [{units.stiffness_word}],loss_factor [1],damping [{units.damping_word}],extrapolated"
    )
    rows = []
    for f, k, eta in zip(
        table.frequency.tolist(), table.storage.tolist(), table.damping.tolist(), strict=True
    ):
        values = (
            units.frequency(f),
            units.stiffness(k),
            units.stiffness(k * eta),
            eta,
            units.damping(k * eta / (2 * np.pi * f)),
        )
        mark = "" if deck.band is None else str(int(deck.extrapolated(f)))
        rows.append(",".join([*(text(value) for value in values), mark]))
    return "\n".join([*header, names, *rows, ""])
