"""The figure of the hits: what the hammer did, and what the accelerometers answered."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from dashpot._arrays import FloatArray
from dashpot.plot.look import (
    BLUE,
    GREY,
    PAGE,
    REJECTED,
    SKY,
    Pen,
    dress,
    figure,
    legend,
    note,
    plain,
)
from dashpot.plot.panels import time as panel
from dashpot.vibration.blows import Blow, cut_blows
from dashpot.vibration.frf import FRF, Hit
from dashpot.vibration.records import ImpactTest

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ACCEPTED = Pen(BLUE, "-", 0.7)
USABLE = 20.0
"""The hammer excites the part where its force is within so many dB of that at 0 Hz."""

Judged = tuple[Blow, Hit | None]


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
    judged = [(blow, verdicts.get(blow.name)) for blow in cut_blows([impact])]
    channels = min(len(impact.channels), 3)
    made = figure(PAGE, 104)
    grid = made.add_gridspec(2, 6)
    _pulses(made.add_subplot(grid[0, :3]), judged)
    _spectra(made.add_subplot(grid[0, 3:]), judged)
    wide = 6 // channels
    first: Axes | None = None
    end = max(decay_time(blow) for blow, _ in judged)
    bins = max(120, 3000 // (channels * len(judged)))  # many hits hide each other's detail
    for i in range(channels):
        ax = made.add_subplot(grid[1, wide * i : wide * (i + 1)], sharey=first)
        first = first or ax
        for blow, hit in judged:
            time = _clock(blow)
            seen = time <= 1.25 * end
            panel.trace(ax, time[seen], blow.acceleration[i, seen], _pen(hit), bins=bins)
        dress(
            ax, x="time after the hit, s", y="acceleration, m/s²", title=plain(impact.channels[i])
        )
    note(first or ax, _decay_words(judged), (0.97, 0.95), ha="right")
    return made


def decay_time(blow: Blow) -> float:
    """When the acceleration falls below 1 % of its peak for good, s after the hit."""
    size = np.max(np.abs(blow.acceleration), axis=0)
    loud = np.flatnonzero(size > 0.01 * np.max(size))
    return float(_clock(blow)[loud[-1]])


def _decay_words(judged: Sequence[Judged]) -> str:
    longest = max(decay_time(blow) for blow, _ in judged)
    record = min(float(_clock(blow)[-1]) for blow, _ in judged)
    if longest > 0.98 * record:
        return f"above 1 % of the peak at the end, {record:.3g} s"
    return f"below 1 % of the peak after {longest:.2g} s of {record:.3g} s"


def force_spectrum(blow: Blow) -> tuple[FloatArray, FloatArray]:
    """Frequency, Hz, and magnitude of the force pulse, dB re its value at 0 Hz.

    Only the pulse is transformed, padded with zeros: what follows it is noise.
    """
    pulse = blow.force[blow.pulse(0.02)]
    size = max(1 << 14, len(pulse))
    level = np.maximum(np.abs(np.fft.rfft(pulse, size)), 1e-12)
    frequency = np.asarray(np.fft.rfftfreq(size, 1 / blow.rate), dtype=float)
    return frequency, np.asarray(20 * np.log10(level / level[0]), dtype=float)


def _accepted(hit: Hit | None) -> bool:
    return hit is None or hit.accepted


def _pen(hit: Hit | None) -> Pen:
    return ACCEPTED if _accepted(hit) else REJECTED


def _clock(blow: Blow) -> FloatArray:
    return (np.arange(len(blow.force)) - blow.onset) / blow.rate


def _pulses(ax: Axes, judged: Sequence[Judged]) -> None:
    width = max(max(blow.width(0.1), 8 / blow.rate) for blow, _ in judged)
    end = max(_last_pulse(blow) for blow, _ in judged) + 0.6 * width
    for blow, hit in judged:
        time = _clock(blow)
        near = (time > -0.6 * width) & (time < end)
        label = f"hit {plain(hit.name)}: rejected" if hit and not hit.accepted else ""
        panel.pulse(ax, 1e3 * time[near], blow.force[near], _pen(hit), label=label)
    accepted = sum(_accepted(hit) for _, hit in judged)
    dress(ax, x="time after the hit, ms", y="hammer force, N",
          title=f"{accepted} of {len(judged)} hits accepted")  # fmt: skip
    legend(ax, loc="upper right")


def _last_pulse(blow: Blow) -> float:
    """When the force last falls below a tenth of its peak, s: a double hit shows its second."""
    above = np.flatnonzero(blow.force > 0.1 * blow.peak)
    return float(_clock(blow)[above[-1]])


def _spectra(ax: Axes, judged: Sequence[Judged]) -> None:
    ends = []
    for blow, hit in judged:
        frequency, level = force_spectrum(blow)
        pen = _pen(hit)
        ax.plot(frequency, level, color=pen.color, linestyle=pen.dashes, linewidth=pen.width)
        if _accepted(hit):
            below = np.flatnonzero(level < -USABLE)
            ends.append(float(frequency[below[0]] if below.size else frequency[-1]))
    ax.axhline(-USABLE, color=GREY, linewidth=0.6, linestyle=(0, (2, 2)))
    if ends:
        usable = min(ends)
        ax.axvspan(0, usable, color=SKY, alpha=0.16, linewidth=0, zorder=0)
        note(ax, f"usable to {usable:.0f} Hz (−{USABLE:.0f} dB)", (0.97, 0.95), ha="right")
        ax.set_xlim(0, min(2.2 * usable, 0.5 * judged[0][0].rate))
    ax.set_ylim(-50, 5)
    dress(ax, x="frequency, Hz", y="force, dB re 0 Hz", title="Force spectra")
