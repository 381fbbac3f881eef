"""The figure of the hits: what the hammer did, and what the accelerometers answered."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.plot import panels as panel
from dashpot.plot.style import (
    BLUE,
    GREY,
    PAGE,
    REJECTED,
    Pen,
    dress,
    figure,
    legend,
    note,
    plain,
)
from dashpot.records.frf import FRF, Hit
from dashpot.records.impact import ImpactTest
from dashpot.vibration.impact.hits import HitBlock, cut_hits

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ACCEPTED = Pen(BLUE, "-", 0.7)
USABLE = 20.0
"""The hammer excites the part where its force is within so many dB of that at 0 Hz."""


class Judged(NamedTuple):
    """A hit as it is drawn: with its clock, s after the hit, and the verdict on it."""

    block: HitBlock
    time: FloatArray
    verdict: Hit | None

    @property
    def accepted(self) -> bool:
        """True unless it was rejected."""
        return self.verdict is None or self.verdict.accepted

    @property
    def pen(self) -> Pen:
        """Of all its curves."""
        return ACCEPTED if self.accepted else REJECTED

    def last(self, size: FloatArray, share: float) -> float:
        """When `size` last exceeds a share of its peak, s after the hit."""
        return float(self.time[np.flatnonzero(size > share * np.max(size))[-1]])


def hits(impact: ImpactTest, frf: FRF) -> Figure:
    """Every hit laid over the others: force pulses, their spectra, and the accelerations.

    Accepted hits are blue, rejected ones vermillion and dashed. The shaded part of the spectra
    is the band in which every accepted hit is within 20 dB of its force at 0 Hz.

    Parameters
    ----------
    impact : ImpactTest
    frf : FRF
        The FRF estimated from it, which carries the verdict on every hit.
    """
    verdicts = {hit.name: hit for hit in frf.hits}
    judged = [
        Judged(one, (np.arange(len(one.force)) - one.onset) / one.rate, verdicts.get(one.name))
        for one in cut_hits([impact])
    ]
    channels = min(len(impact.channels), 3)
    made = figure(PAGE, 104)
    grid = made.add_gridspec(2, 6)
    _pulses(made.add_subplot(grid[0, :3]), judged)
    _spectra(made.add_subplot(grid[0, 3:]), judged)
    wide = 6 // channels
    first: Axes | None = None
    # the acceleration falls below 1 % of its peak for good
    end = max(one.last(np.max(np.abs(one.block.acceleration), axis=0), 0.01) for one in judged)
    record = min(float(one.time[-1]) for one in judged)
    bins = max(120, 3000 // (channels * len(judged)))  # many hits hide each other's detail
    for i in range(channels):
        ax = made.add_subplot(grid[1, wide * i : wide * (i + 1)], sharey=first)
        first = first or ax
        for one in judged:
            inside = one.time <= 1.25 * end
            panel.trace(ax, one.time[inside], one.block.acceleration[i, inside], one.pen, bins=bins)
        dress(
            ax, x="time after the hit, s", y="acceleration, m/s²", title=plain(impact.channels[i])
        )
    decay = f"below 1 % of the peak after {end:.2g} s of {record:.3g} s"
    if end > 0.98 * record:
        decay = f"above 1 % of the peak at the end, {record:.3g} s"
    note(first or ax, decay, (0.97, 0.95), ha="right")
    return made


def force_spectrum(hit: HitBlock) -> tuple[FloatArray, FloatArray]:
    """Frequency, Hz, and magnitude of the force pulse, dB re its value at 0 Hz.

    Only the pulse is transformed, padded with zeros: what follows it is noise.
    """
    pulse = hit.force[hit.pulse(0.02)]
    size = max(1 << 14, len(pulse))
    level = np.maximum(np.abs(np.fft.rfft(pulse, size)), 1e-12)
    frequency = np.asarray(np.fft.rfftfreq(size, 1 / hit.rate), dtype=float)
    return frequency, np.asarray(20 * np.log10(level / level[0]), dtype=float)


def _pulses(ax: Axes, judged: Sequence[Judged]) -> None:
    width = max(max(one.block.width(0.1), 8 / one.block.rate) for one in judged)
    # a double hit shows its second
    end = max(one.last(one.block.force, 0.1) for one in judged) + 0.6 * width
    for one in judged:
        near = (one.time > -0.6 * width) & (one.time < end)
        label = "" if one.accepted else f"hit {plain(one.block.name)}: rejected"
        # where samples are few they are shown
        panel.line(ax, 1e3 * one.time[near], one.block.force[near], one.pen, label, alpha=0.85,
                   marker="." if near.sum() <= 80 else "", markersize=2.5)  # fmt: skip
    accepted = sum(one.accepted for one in judged)
    dress(ax, x="time after the hit, ms", y="hammer force, N",
          title=f"{accepted} of {len(judged)} hits accepted")  # fmt: skip
    legend(ax, loc="upper right")


def _spectra(ax: Axes, judged: Sequence[Judged]) -> None:
    ends = []
    for one in judged:
        frequency, level = force_spectrum(one.block)
        panel.line(ax, frequency, level, one.pen)
        if one.accepted:
            below = np.flatnonzero(level < -USABLE)
            ends.append(float(frequency[below[0]] if below.size else frequency[-1]))
    ax.axhline(-USABLE, color=GREY, linewidth=0.6, linestyle=(0, (2, 2)))
    if ends:
        usable = min(ends)
        panel.shade(ax, 0, usable, alpha=0.16)
        note(ax, f"usable to {usable:.0f} Hz (−{USABLE:.0f} dB)", (0.97, 0.95), ha="right")
        ax.set_xlim(0, min(2.2 * usable, 0.5 * judged[0].block.rate))
    ax.set_ylim(-50, 5)
    dress(ax, x="frequency, Hz", y="force, dB re 0 Hz", title="Force spectra")
