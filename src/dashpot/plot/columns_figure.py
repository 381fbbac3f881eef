"""The columns of a file as they stand, before anything is made of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.plot.picture import MEASURED, Line, Panel, Picture, Scale, compute_padded_limits

MOST = 6
"""Columns that are drawn."""

ACROSS = ("time", "frequency")
"""Roles that a record runs along."""


def columns(
    names: Sequence[str],
    roles: Sequence[str | None],
    values: FloatArray | None,
    *,
    stamp: str = "",
) -> Picture:
    """Each column of numbers against time, frequency or, if the file has neither, the row.

    Parameters
    ----------
    names : sequence of str
    roles : sequence of str or None
    values : array, shape (n, m)
        In the file's units; a column without numbers is left out.
    stamp : str
        What the figure says of its origin.

    Raises
    ------
    DataError
        If there is no column of numbers.
    """
    values = np.zeros((0, 0)) if values is None else values
    filled = np.flatnonzero(np.isfinite(values).any(axis=0)).tolist()
    along = next((i for i in filled if roles[i] in ACROSS), None)
    shown = [i for i in filled if i != along][:MOST]
    if not shown:
        raise DataError("the file has no column of numbers to draw")
    x, word = np.arange(1.0, len(values) + 1), "row of those drawn"
    if along is not None:
        x, word = values[:, along], names[along]
    across = Scale(word, compute_padded_limits(x, margin=0.0))
    panels = tuple(
        Panel(
            across,
            Scale(names[i], compute_padded_limits(values[:, i])),
            (Line(x, values[:, i], MEASURED),),
            title=roles[i] or "",
            height=90,
        )
        for i in shown
    )
    return Picture("columns", "The columns of the file, as they stand.", (panels,), stamp=stamp)
