"""One ramp and hold, and its rows in any dialect."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

ROWS = 60


def truth() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time s, displacement mm, force N, to be printed with 5 decimals."""
    time = np.round(0.1 * np.arange(ROWS), 5)
    displacement = np.round(np.clip(time - 0.5, 0, 1) * 8.0, 5)
    force = np.round(0.2 * displacement + 0.3 * np.where(time > 1.5, np.exp(-(time - 1.5)), 0.0), 5)
    return time, displacement, force


def table(
    delimiter: str,
    *,
    decimal: str = ".",
    quote: bool = False,
    tail: str = "",
    end: str = "\n",
    columns: Sequence[np.ndarray] | None = None,
    lead: str = "",
    pad: int = 0,
) -> str:
    """Rows of the truth, or of other columns, in a dialect."""
    rows = []
    for values in zip(*(columns or truth()), strict=True):
        cells = [f"{value:.5f}".replace(".", decimal).rjust(pad) for value in values]
        cells = [f'"{cell}"' for cell in cells] if quote else cells
        rows.append(lead + delimiter.join(cells) + tail)
    return end.join(rows) + end
