"""The figure of a fit by what it was fitted to."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from dashpot.datamodel.fit import Fit
from dashpot.datamodel.relaxation import RampHold
from dashpot.plot.picture import Picture
from dashpot.plot.relaxation import fit
from dashpot.registry import find_handler


def bench(found: Fit, records: Sequence[Any], *, alternatives: Sequence[Fit] = ()) -> Picture:
    """Return the figure that suits the records that a fit was made from.

    Parameters
    ----------
    found : Fit
    records : sequence
        As fitted; of one kind.
    alternatives : sequence of Fit
        Of one ramp and hold: fits of other numbers of arms, drawn with it.
    """
    first = records[0]
    draw, shown = find_handler("fit figure", first), first
    if draw is None and found.temperatures is not None:
        draw = find_handler("fit figure", found.temperatures)
        shown = [record for record in records if isinstance(record, RampHold)]
    if draw is None:
        return fit(found, first, alternatives=alternatives)
    drawn: Picture = draw(found, shown)
    return drawn
