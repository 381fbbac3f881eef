"""What ``dashpot rod`` found, as text."""

from __future__ import annotations

import numpy as np

from dashpot import workflow
from dashpot.cli import _text
from dashpot.cli._terminal import Text
from dashpot.cli._text import hertz, rounded, table, with_error

_ROWS = 8
"""Lines of a rod that are shown."""


def rod(found: workflow.Rod) -> Text:
    """Return the modulus of a rod over its usable band, what errors do to it, and the solid."""
    of, factor = found.modulus, found.part.factor(bonded=found.bonded)
    stiffer = factor * found.part.height / found.part.area
    ends = f"bonded, so {stiffer:.4g} times as stiff as its material" if found.bonded else "sliding"
    lines = [
        (
            f"a rod of {1e3 * found.own_mass:.4g} g under {1e3 * found.mass:.4g} g "
            f"({found.mass / found.own_mass:.3g} times its own), shape factor "
            f"{found.part.shape_factor:.3g}: its ends are {ends}"
        )
    ]
    lines.append(
        f"  usable      {hertz(of.band)}: storage and loss factor are known to 10 %"
        if of.usable.any()
        else "  usable      nowhere"
    )
    lines += table(_rows(found, shown=_ROWS))
    lines.append(
        "  1 degree of phase, 1 % of gain: change of the storage, %, and of the loss factor"
    )
    if found.fit is None:
        lines.append(f"  no solid was fitted: {found.reason}")
        return Text(lines, table(_rows(found, shown=len(of.frequency))))
    fitted = _text.fit(found.fit)
    details = ["every line", *table(_rows(found, shown=len(of.frequency)))]
    return Text([*lines, *fitted.lines], [*fitted.details, *details])


def _rows(found: workflow.Rod, *, shown: int) -> list[list[str]]:
    """Storage and loss factor at some lines of the band, or of all where none is usable."""
    of = found.modulus
    some = of.only(of.usable) if of.usable.any() else of
    if shown < len(some.frequency):
        low, high = float(some.frequency[0]), float(some.frequency[-1])
        asked = np.geomspace(low, high, shown)
        at = np.unique(np.abs(some.frequency[:, None] - asked).argmin(axis=0))
        some = some.only(at)
    degree, gain = some.changes("phase", np.pi / 180), some.changes("gain", 0.01)
    rows = [
        ["Hz", "storage, MPa", "loss factor", "1 deg: %", "loss factor", "1 %: %", "loss factor"]
    ]
    for i, line in enumerate(some.frequency):
        rows.append(
            [
                rounded(float(line)),
                with_error(1e-6 * float(some.storage[i]), 1e-6 * float(some.storage_sd[i])),
                with_error(float(some.loss_factor[i]), float(some.loss_factor_sd[i])),
                f"{100 * degree[0][i]:+.2f}",
                f"{degree[1][i]:+.4f}",
                f"{100 * gain[0][i]:+.2f}",
                f"{gain[1][i]:+.4f}",
            ]
        )
    return rows
