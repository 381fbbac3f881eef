"""Tests grouped by seal, and the control charts of several lots."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray
from dashpot.base.serialisation import Key, Serialisable
from dashpot.extensions.batch.statistics.control_chart import (
    Chart,
    chart_individuals,
    chart_means_and_deviations,
)


@dataclass(frozen=True, eq=False)
class Seal(Serialisable):
    """Tests of one seal; a test without a named seal forms its own.

    Attributes
    ----------
    lot, name : str
    files : tuple of str
    values : array, shape (n,)
        Values of a quantity, SI.
    """

    _keys = ("lot", Key("seal", "name"), "tests", "mean", "repeats_sd")

    lot: str
    name: str
    files: tuple[str, ...]
    values: FloatArray

    @property
    def tests(self) -> int:
        """Number of tests."""
        return len(self.files)

    @property
    def mean(self) -> float:
        """Mean of the tests of the seal."""
        return float(self.values.mean())

    @property
    def repeats_sd(self) -> float | None:
        """Standard deviation of its repeats; None of one test."""
        return float(self.values.std(ddof=1)) if len(self.values) > 1 else None


def split_seals_by_lot(seals: Sequence[Seal]) -> dict[str, list[Seal]]:
    """Return the seals of each lot, in their order."""
    lots: dict[str, list[Seal]] = defaultdict(list)
    for seal in seals:
        lots[seal.lot].append(seal)
    return dict(lots)


def average_seals(seals: Sequence[Seal]) -> FloatArray:
    """Return the mean of each seal, shape (n,)."""
    return np.array([seal.mean for seal in seals])


class Charts(NamedTuple):
    """Control charts of one lot.

    Attributes
    ----------
    seals : tuple of Seal
        The points.
    means, moving : Chart
        Individual seals, and the moving ranges of neighbours.
    repeats : Chart or None
        Standard deviations of the repeats; None where no two seals were tested twice.
    """

    seals: tuple[Seal, ...]
    means: Chart
    moving: Chart
    repeats: Chart | None


class LotCharts(NamedTuple):
    """Lots, and the X-bar and s charts whose groups are the seals of each."""

    names: tuple[str, ...]
    mean: Chart
    sd: Chart


def make_control_charts(seals: Sequence[Seal]) -> Charts:
    """Return the control charts of the seals of one lot, two or more."""
    points, moving_range = chart_individuals(average_seals(seals))
    groups = [seal.values for seal in seals]
    has_several_repeats = sum(len(group) > 1 for group in groups) > 1
    repeats = chart_means_and_deviations(groups)[1] if has_several_repeats else None
    return Charts(tuple(seals), points, moving_range, repeats)
