"""Figures of records before a fit: columns of a file, hits of a hammer test."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.base.units import convert_to_unit
from dashpot.datamodel.frf import FRF, Hit
from dashpot.datamodel.vibration_tests import ImpactTest
from dashpot.plot.picture import (
    MEASURED,
    REF,
    REJECTED,
    Line,
    Mark,
    Panel,
    Pen,
    Picture,
    Rule,
    Scale,
    Span,
)
from dashpot.plot.plotted_data import (
    compute_padded_limits,
    downsample_to_extremes,
    format_frf_stamp,
)
from dashpot.plot.plotted_data import compute_padded_limits as pad_limits
from dashpot.vibration.impact.hits import HitBlock, cut_hits

# Hits: force and accelerations.


ACCEPTED = Pen("fit", 1.1)
USABLE_DB = 20.0
"""Largest drop of the force spectrum from 0 Hz where the hammer excites the part, dB."""


class PlottedHit(NamedTuple):
    """Hit to be drawn, with its clock, s after the hit, and its verdict."""

    block: HitBlock
    time: FloatArray
    verdict: Hit | None

    @property
    def is_accepted(self) -> bool:
        """True unless it was rejected."""
        return self.verdict is None or self.verdict.accepted

    @property
    def pen(self) -> Pen:
        """Pen of all its curves."""
        return ACCEPTED if self.is_accepted else REJECTED

    def last(self, size: FloatArray, share: float) -> float:
        """Return the time at which `size` last exceeds a share of its peak, s after the hit."""
        return float(self.time[np.flatnonzero(size > share * np.max(size))[-1]])


def hits(impact: ImpactTest, frf: FRF, *, stamp: str = "") -> Picture:
    """Return every hit laid over the others: force pulses, their spectra, and the accelerations.

    Accepted hits are blue, rejected ones vermillion and dashed. The shaded part of the spectra
    is the band in which every accepted hit is within 20 dB of its force at 0 Hz.

    Parameters
    ----------
    impact : ImpactTest
    frf : FRF
        The FRF estimated from it, which carries the verdict on every hit.
    stamp : str
        Origin of the data, printed below the figure; by default the files of the FRF.
    """
    verdicts = {hit.name: hit for hit in frf.hits}
    plotted_hits = [
        PlottedHit(hit, (np.arange(len(hit.force)) - hit.onset) / hit.rate, verdicts.get(hit.name))
        for hit in cut_hits([impact])
    ]
    # rejected ones over the others, to be seen
    plotted_hits.sort(key=lambda hit: not hit.is_accepted)
    panels = [_pulses(plotted_hits), _spectra(plotted_hits), *_answers(impact, plotted_hits)]
    caption = (
        "The hits laid over each other: blue accepted, vermillion and dashed rejected; shaded "
        "the band that every accepted hit excites."
    )
    strips = tuple((panel,) for panel in panels)
    return Picture("hits", caption, strips, 2, stamp or format_frf_stamp(frf))


def force_spectrum(hit: HitBlock) -> tuple[FloatArray, FloatArray]:
    """Frequency, Hz, and magnitude of the force pulse, dB re its value at 0 Hz.

    Only the pulse is transformed, padded with zeros: later samples are noise.
    """
    pulse = hit.force[hit.pulse(0.02)]
    size = max(1 << 14, len(pulse))
    level = np.maximum(np.abs(np.fft.rfft(pulse, size)), 1e-12)
    frequency = np.asarray(np.fft.rfftfreq(size, 1 / hit.rate), dtype=float)
    return frequency, np.asarray(20 * np.log10(level / level[0]), dtype=float)


def _key(hit: PlottedHit) -> str:
    return "hit, accepted" if hit.is_accepted else f"hit {hit.block.name}, rejected"


def _pulses(plotted_hits: Sequence[PlottedHit]) -> Panel:
    width = max(max(hit.block.width(0.1), 8 / hit.block.rate) for hit in plotted_hits)
    # a double hit shows its second
    end = max(hit.last(hit.block.force, 0.1) for hit in plotted_hits) + 0.6 * width
    lines = []
    for plotted_hit in plotted_hits:
        near_pulse = (plotted_hit.time > -0.6 * width) & (plotted_hit.time < end)
        x, y = downsample_to_extremes(
            convert_to_unit(plotted_hit.time[near_pulse], "ms"),
            plotted_hit.block.force[near_pulse],
            bins=250,
        )
        lines.append(Line(x, y, plotted_hit.pen, _key(plotted_hit)))
    accepted = sum(hit.is_accepted for hit in plotted_hits)
    span = convert_to_unit(-0.6 * width, "ms"), convert_to_unit(end, "ms")
    axes = (Scale("time after the hit, ms", span),
            Scale("hammer force, N", pad_limits(*(line.y for line in lines))))  # fmt: skip
    title = f"{accepted} of {len(plotted_hits)} hits accepted"
    return Panel(*axes, tuple(lines), title=title, height=150)


def _spectra(plotted_hits: Sequence[PlottedHit]) -> Panel:
    ends, lines = [], []
    for hit in plotted_hits:
        frequency, level = force_spectrum(hit.block)
        lines.append((frequency, level, hit.pen))
        if hit.is_accepted:
            indices_below = np.flatnonzero(level < -USABLE_DB)
            ends.append(float(frequency[indices_below[0]] if indices_below.size else frequency[-1]))
    top = min(2.2 * min(ends), 0.5 * plotted_hits[0].block.rate) if ends else lines[0][0][-1]
    marks: list[Mark] = [Rule(-USABLE_DB, REF, is_horizontal=True)]
    note = ""
    if ends:
        marks.append(Span(0.0, min(ends), "fit", "band that every accepted hit excites"))
        note = f"usable to {min(ends):.0f} Hz (−{USABLE_DB:.0f} dB)"
    for frequency, level, pen in lines:
        is_visible = frequency <= top
        marks.append(
            Line(*downsample_to_extremes(frequency[is_visible], level[is_visible], bins=200), pen)
        )
    axes = Scale("frequency, Hz", (0.0, float(top))), Scale("force, dB re 0 Hz", (-50.0, 5.0))
    return Panel(*axes, tuple(marks), title="Force spectra", height=150, note=note)


def _answers(impact: ImpactTest, plotted_hits: Sequence[PlottedHit]) -> list[Panel]:
    """Acceleration after each hit, one panel for each of the first channels."""
    channels = min(len(impact.channels), 3)
    # the acceleration falls below 1 % of its peak for good
    end = max(
        hit.last(np.max(np.abs(hit.block.acceleration), axis=0), 0.01) for hit in plotted_hits
    )
    record = min(float(hit.time[-1]) for hit in plotted_hits)
    bins = max(100, 1600 // (channels * len(plotted_hits)))  # many hits hide each other's detail
    decay = f"below 1 % after {end:.2g} s"
    if end > 0.98 * record:
        decay = f"above 1 % at the end, {record:.3g} s"
    end_time = 1.25 * end
    panels = []
    for i in range(channels):
        lines = []
        for plotted_hit in plotted_hits:
            in_range = plotted_hit.time <= end_time
            x, y = downsample_to_extremes(
                plotted_hit.time[in_range], plotted_hit.block.acceleration[i, in_range], bins=bins
            )
            lines.append(Line(x, y, plotted_hit.pen, _key(plotted_hit)))
        start = float(min(line.x[0] for line in lines))
        span = max(float(np.max(np.abs(line.y))) for line in lines) * 1.08
        last = min(end_time, float(max(line.x[-1] for line in lines)))
        axes = (
            Scale("time after the hit, s", (start, last)),
            Scale("acceleration, m/s²", (-span, span)),
        )
        note = "" if i else decay
        panels.append(Panel(*axes, tuple(lines), title=impact.channels[i], height=150, note=note))
    return panels


# Columns of a file as read.


MAX_COLUMNS = 6
"""Columns that are drawn."""

RUNNING_ROLES = ("time", "frequency")
"""Roles that a record runs along."""


def columns(
    names: Sequence[str],
    roles: Sequence[str | None],
    values: FloatArray | None,
    *,
    stamp: str = "",
) -> Picture:
    """Return each column of numbers against time, frequency or, if the file has neither, the row.

    Parameters
    ----------
    names : sequence of str
    roles : sequence of str or None
    values : array, shape (n, m)
        In the file's units; a column without numbers is omitted.
    stamp : str
        Origin of the data, printed below the figure.

    Raises
    ------
    DataError
        If there is no column of numbers.
    """
    values = np.zeros((0, 0)) if values is None else values
    filled = np.flatnonzero(np.isfinite(values).any(axis=0)).tolist()
    running_column = next((i for i in filled if roles[i] in RUNNING_ROLES), None)
    shown_columns = [i for i in filled if i != running_column][:MAX_COLUMNS]
    if not shown_columns:
        raise DataError("the file has no column of numbers to draw")
    x, word = np.arange(1.0, len(values) + 1), "row of those drawn"
    if running_column is not None:
        x, word = values[:, running_column], names[running_column]
    horizontal = Scale(word, compute_padded_limits(x, margin=0.0))
    panels = tuple(
        Panel(
            horizontal,
            Scale(names[i], compute_padded_limits(values[:, i])),
            (Line(x, values[:, i], MEASURED),),
            title=roles[i] or "",
            height=90,
        )
        for i in shown_columns
    )
    return Picture("columns", "The columns of the file, as they stand.", (panels,), stamp=stamp)
