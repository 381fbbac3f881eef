"""Storage and loss factor line by line as text, with what small errors of the test make of them."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray, IndexArray
from dashpot.base.number_format import ascii_only
from dashpot.base.result_mixins import HasVerdict
from dashpot.base.units import get_display_unit
from dashpot.text_output.layout import Text, facts, table
from dashpot.text_output.results import format_rounded, with_error

ERRORS = {
    "phase": ("1 deg", "1 degree of phase", float(np.pi / 180)),
    "gain": ("1 %", "1 % of gain", 0.01),
    "mass": ("1 %", "1 % of mass", 0.01),
}
"""Heading, words and size of each."""


class Measured(Protocol):
    """Storage and loss factor against frequency, such as a rod's modulus or a seal's stiffness."""

    @property
    def frequency(self) -> FloatArray:
        """Hz."""
        ...

    @property
    def storage(self) -> FloatArray:
        """Real part, by line."""
        ...

    @property
    def loss_factor(self) -> FloatArray:
        """By line."""
        ...

    @property
    def storage_sd(self) -> FloatArray:
        """Standard deviation of the real part."""
        ...

    @property
    def loss_factor_sd(self) -> FloatArray:
        """Standard deviation of the loss factor."""
        ...

    @property
    def usable(self) -> BoolArray:
        """Which lines tell something."""
        ...

    def changes(self, of: str, by: float) -> tuple[FloatArray, FloatArray]:
        """What an error of so much does to both."""
        ...


def render_facts(verdict: HasVerdict) -> Text:
    """Return the numbers of a result with their intervals, and what the readers noticed."""
    sources = getattr(verdict, "sources", ())
    notes = [f"  read        {source.file}: {note}" for source in sources for note in source.notes]
    return Text(facts(verdict.facts), ascii_only("\n".join(notes)).splitlines())


def render_summary(result: object) -> Text:
    """Return what a result says of itself."""
    return Text(str(result).splitlines())


def sensitive(of: Measured, *, errors: tuple[str, ...], unit: str, shown: int) -> list[str]:
    """Return `shown` lines of the usable band, or of all where none is usable, and the errors.

    Parameters
    ----------
    of : Measured
    errors : tuple of str
        Which of :data:`ERRORS` are told; none for the lines alone.
    unit : str
        Of SI, of the storage.
    shown : int
    """
    pairs = [(ERRORS[name], of.changes(name, ERRORS[name][2])) for name in errors]
    rows = [["Hz", f"storage, {get_display_unit(unit)}", "loss factor"]]
    for (heading, _, _), _ in pairs:
        rows[0] += [f"{heading}: %", "loss factor"]
    for i in _spread(of, shown):
        row = [
            format_rounded(float(of.frequency[i])),
            with_error(float(of.storage[i]), float(of.storage_sd[i]), unit),
            with_error(float(of.loss_factor[i]), float(of.loss_factor_sd[i])),
        ]
        for _, (storage, loss) in pairs:
            row += [f"{100 * storage[i]:+.2f}", f"{loss[i]:+.4f}"]
        rows.append(row)
    if not errors:
        return table(rows)
    words = ", ".join(ERRORS[name][1] for name in errors)
    return [*table(rows), f"  {words}: change of the storage, %, and of the loss factor"]


def _spread(of: Measured, shown: int) -> IndexArray:
    """Lines at even ratios over the usable band."""
    lines = np.flatnonzero(of.usable if of.usable.any() else np.isfinite(of.frequency))
    if shown >= len(lines):
        return lines
    f = of.frequency[lines]
    low, high = float(f[0]), float(f[-1])
    grid = np.geomspace(low, high, shown)
    return np.unique(lines[np.abs(f[:, None] - grid).argmin(axis=0)])
