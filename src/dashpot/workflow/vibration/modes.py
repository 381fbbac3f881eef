"""What every search for modes gives: a sequence of them, judged with the FRF that shows them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import overload

import numpy as np

from dashpot.base.checks import Check, Verdict, verdict
from dashpot.base.number_format import format_count
from dashpot.base.reported_values import ReportedValue
from dashpot.base.result_mixins import Plottable, Series, collect_columns
from dashpot.base.serialisation import Serialisable
from dashpot.datamodel.frf import FRF, Mode


@dataclass(frozen=True)
class ImpactMode:
    """A mode as the document tells it: what a method cannot tell is None."""

    frequency_hz: float
    damping_ratio: float
    frequency_se_hz: float | None
    damping_ratio_se: float | None
    method: str

    @property
    def mode(self) -> Mode:
        """The pole with its errors: nan where a method cannot tell."""
        values = (self.frequency_se_hz, self.damping_ratio_se)
        frequency, ratio = (np.nan if se is None else se for se in values)
        return Mode(self.frequency_hz, self.damping_ratio, 0j, frequency, ratio, 0.0, self.method)


@dataclass(frozen=True, repr=False)
class Modes(Plottable, Serialisable, Sequence[Mode]):
    """Natural frequencies, damping ratios and shapes, each with its standard error.

    A sequence of :class:`~dashpot.datamodel.frf.Mode`, the one that moves most first.

    Attributes
    ----------
    frf : FRF
        That they were found in, with every check.
    modes : tuple of ImpactMode
        As the document tells them.

    Examples
    --------
    >>> import dashpot as dp
    >>> found = dp.fit(dp.simulate("impact", seal="broad", hits=3))
    >>> len(found), round(found[0].damping_ratio, 3)
    (1, 0.029)
    """

    frf: FRF
    modes: tuple[ImpactMode, ...]

    @overload
    def __getitem__(self, index: int) -> Mode: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Mode, ...]: ...
    def __getitem__(self, index: int | slice) -> Mode | tuple[Mode, ...]:
        """The mode at a place, or several."""
        return tuple(mode.mode for mode in self.modes)[index]

    def __len__(self) -> int:
        """Number of modes."""
        return len(self.modes)

    @property
    def checks(self) -> tuple[Check, ...]:
        """Of the FRF and of its modes."""
        return self.frf.checks

    @property
    def verdict(self) -> Verdict:
        """What to make of the FRF and its modes."""
        return verdict(self.frf.checks, headline=self.sound)

    @property
    def sound(self) -> str:
        """The first mode and how many there are."""
        return format_modes_headline(self)

    @property
    def facts(self) -> tuple[ReportedValue, ...]:
        """Frequency, damping ratio and residue of each mode."""
        return tuple(fact for mode in self for fact in mode.facts)

    @property
    def series(self) -> Series:
        """The modes as a table."""
        columns = collect_columns(
            self, frequency="Hz", frequency_se="Hz", damping_ratio="", damping_ratio_se=""
        )
        return {"mode": (np.arange(1, len(self) + 1), ""), **columns}

    @property
    def described(self) -> tuple[str, ...]:
        """The verdict, and each mode."""
        rows = (mode.facts for mode in self)
        return (
            str(self.verdict),
            *(f"{hz.cells.with_unit}, damping {ratio.cells.with_unit}" for hz, ratio, _ in rows),
        )


def format_modes_headline(modes: Sequence[Mode]) -> str:
    """Return frequency and damping of the first of some modes, and how many there are."""
    if not modes:
        return "0 modes were found"
    frequency, ratio, _ = (fact.cells.with_unit for fact in modes[0].facts)
    count = "" if len(modes) == 1 else f", the first of {format_count(len(modes), 'mode')}"
    return f"resonance at {frequency}, damping ratio {ratio}{count}"
