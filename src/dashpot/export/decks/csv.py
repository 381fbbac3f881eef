"""Tables as comma-separated text."""

from __future__ import annotations

import numpy as np

from dashpot.base.plain_text import format_csv_comment
from dashpot.base.units import Range, si_range
from dashpot.export.deck import Deck, DeckText
from dashpot.export.deck_validation import target
from dashpot.export.unit_systems import convert_to_printable_ascii, text

FORMS = ("frequency", "arms")
SUFFIX = "csv"
_VERIFIED = "verified: read back in dashpot's tests"


@target(*FORMS, frequency_range=("frequency",), tolerance=("frequency",))
def csv(
    deck: Deck,
    *,
    frequency_range: Range = (1.0, 100.0),
    tolerance: float = 1e-3,
) -> DeckText:
    """Comma-separated text: dynamic stiffness against frequency, or the arms.

    ``"frequency"`` has one row per frequency: storage and loss stiffness, loss factor, viscous
    equivalent, and 1 where the row is extrapolated; ``"arms"`` one row per element. Comments start
    with ``#``; no part of them between commas can be taken for a formula.

    Parameters are those of :func:`dashpot.export.nastran`.
    """
    frequency_range = si_range(frequency_range, "frequency")
    return _arms(deck) if deck.form == "arms" else _frequency(deck, frequency_range, tolerance)


def _arms(deck: Deck) -> DeckText:
    units = deck.units
    rows = [("k_inf", text(deck.k_inf), "", "")]
    if deck.b > 0:
        rows.append(("parallel dashpot", "", "", text(deck.b)))
    rows += [
        (f"arm {j}", text(k), text(tau), text(b))
        for j, (k, tau, b) in enumerate(deck.arms, start=1)
    ]
    names = f"element,k [{units.stiffness_word}],tau [{units.words[2]}],b [{units.damping_word}]"
    body = [names, *(",".join(row) for row in rows)]
    return deck.format_text(
        "#", "springs and dashpots", body, verified=_VERIFIED, function=_format_remark
    )


def _format_remark(line: str) -> str:
    return format_csv_comment(convert_to_printable_ascii(line))


def _frequency(deck: Deck, frequency_range: tuple[float, float], tolerance: float) -> DeckText:
    units, table = deck.units, deck.table(frequency_range, tolerance)
    loss = table.storage * table.damping
    columns = {
        f"frequency [{units.frequency_word}]": units.frequency(table.frequency),
        f"storage [{units.stiffness_word}]": units.stiffness(table.storage),
        f"loss [{units.stiffness_word}]": units.stiffness(loss),
        "loss_factor [1]": table.damping,
        f"damping [{units.damping_word}]": units.damping(loss / (2 * np.pi * table.frequency)),
    }
    is_extrapolated_flags = [
        "" if deck.band is None else str(int(deck.is_extrapolated(f)))
        for f in table.frequency.tolist()
    ]
    rows = (
        ",".join([*(text(value) for value in row), mark])
        for *row, mark in zip(*columns.values(), is_extrapolated_flags, strict=True)
    )
    return deck.format_text(
        "#",
        "dynamic stiffness",
        [",".join([*columns, "extrapolated"]), *rows],
        verified=_VERIFIED,
        table=table,
        function=_format_remark,
    )
