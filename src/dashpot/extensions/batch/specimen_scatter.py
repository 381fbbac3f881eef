"""Scatter of the stiffness between the seals of a lot, for doors of many cars."""

from __future__ import annotations

from typing import TypedDict

import numpy as np

from dashpot.base.errors import DataError
from dashpot.base.number_format import format_count
from dashpot.extensions.batch.api import read_lot
from dashpot.extensions.batch.lot import Lot

_QUANTITY = "k_end"


class SpecimenScatter(TypedDict):
    """Scatter of the ln stiffness at the end of the test of the seals of a lot.

    `mean` is its mean, `between_square` the variance of the means of the seals, `within_square`
    what of it repeated tests explain, with `within_freedom` degrees; 0 without repeats, whose
    scatter is then in the first.
    """

    specimens: int
    mean: float
    between_square: float
    within_square: float
    within_freedom: int


def find_specimen_scatter(lot: Lot | str) -> SpecimenScatter:
    """Return how the stiffness of the seals of one lot scatters, in its logarithm.

    Parameters
    ----------
    lot : Lot or path
        A folder that ``dashpot batch`` wrote.

    Raises
    ------
    DataError
        If the seals are of several lots, or fewer than two.
    """
    lot_table = lot if isinstance(lot, Lot) else read_lot(lot)
    seals = lot_table.seals(_QUANTITY)
    lots = {seal.lot for seal in seals}
    if len(lots) > 1:
        raise DataError(
            f"the folder holds {len(lots)} lots, and the seals of a car are of one. Batch one lot "
            "by itself, or in Python give lot.only(NAME)"
        )
    if len(seals) < 2:
        raise DataError(
            f"the lot has {format_count(len(seals), 'seal')} with a stiffness; at least two show "
            "how they scatter"
        )
    logs = [np.log(seal.values) for seal in seals]
    means = np.array([float(values.mean()) for values in logs])
    counts = np.array([len(values) for values in logs])
    freedom = int((counts - 1).sum())
    repeat = sum(float(((values - values.mean()) ** 2).sum()) for values in logs)
    repeat_variance = repeat / freedom * float((1 / counts).mean()) if freedom else 0.0
    return SpecimenScatter(
        specimens=len(seals),
        mean=float(means.mean()),
        between_square=float(means.var(ddof=1)),
        within_square=repeat_variance,
        within_freedom=freedom,
    )
