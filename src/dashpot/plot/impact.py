"""The figure of the hits: what the hammer did, and what the accelerometers answered."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from dashpot._arrays import FloatArray
from dashpot.plot.look import BLUE, GREY, PAGE, REJECTED, SKY, Pen, dress, figure, legend, note
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
    for i in range(channels):
        ax = made.add_subplot(grid[1, wide * i : wide * (i + 1)], sharey=first)
        first = first or ax
        for blow, hit in judged:
            panel.trace(ax, _clock(blow), blow.acceleration[i], _pen(hit))
        dress(ax, x="time after the hit, s", y="acceleration, m/s²", title=impact.channels[i])
    return made


def force_spectrum(blow: Blow) -> tuple[FloatArray, FloatArray]:
    """Frequency, Hz, and magnitude of the force pulse, dB re its value at 0 Hz.

    Only the pulse is transformed, padded with zeros: what follows it is noise.
    """
    pulse = blow.force[blow.pulse(0.02)]
    size = max(1 << 14, len(pulse))
    level = np.abs(np.fft.rfft(pulse, size))
    return np.fft.rfftfreq(size, 1 / blow.rate), 20 * np.log10(
        np.maximum(level, 1e-12) / max(float(level[0]), 1e-12)
    )


def _accepted(hit: Hit | None) -> bool:
    return hit is None or hit.accepted


def _pen(hit: Hit | None) -> Pen:
    return ACCEPTED if _accepted(hit) else REJECTED


def _clock(blow: Blow) -> FloatArray:
    return (np.arange(len(blow.force)) - blow.onset) / blow.rate


def _pulses(ax: Axes, judged: Sequence[Judged]) -> None:
    width = max(blow.width(0.1) for blow, _ in judged)
    for blow, hit in judged:
        time = _clock(blow)
        near = (time > -width) & (time < 3 * width)
        label = f"hit {hit.name}: rejected" if hit and not hit.accepted else ""
        panel.pulse(ax, 1e3 * time[near], blow.force[near], _pen(hit), label=label)
    accepted = sum(_accepted(hit) for _, hit in judged)
    dress(ax, x="time after the hit, ms", y="hammer force, N",
          title=f"{accepted} of {len(judged)} hits accepted")  # fmt: skip
    legend(ax, loc="upper right")


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
        ax.set_xlim(0, 2.2 * usable)
    ax.set_ylim(-50, 5)
    dress(ax, x="frequency, Hz", y="force spectrum, dB re 0 Hz", title="Hammer force spectra")
