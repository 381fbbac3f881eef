r"""Which hits of a hammer test to keep: how far the FRF of each is from those of the others.

Of each accepted hit :math:`i` with its own FRF :math:`A_i`, over the lines within a factor of 2.3
of the resonance,

.. math:: d_i = \frac{\|A_i - m_i\|}{\|m_i\|}

where :math:`m_i` is the median, of real and imaginary part, of all the other accepted hits. The hit
that is farthest off is omitted while it is off by three times the median of all and by 5 %, and
three remain. Overloads and double hits are rejected before, for reasons of their own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.errors import DashpotError
from dashpot.base.number_format import percent
from dashpot.datamodel.frf import FRF
from dashpot.datamodel.vibration_tests import ImpactTest
from dashpot.vibration.modal.peaks import find_peak
from dashpot.workflow.job import HammerChoices
from dashpot.workflow.measured_frf import average

MAX_HITS = 24
"""Largest number of hits with separate FRFs."""
BAND_RATIO = 2.3
"""Highest of the compared frequencies over the resonance, and the resonance over the lowest."""
MIN_HITS = 3
"""Smallest number of kept hits."""
DEVIATION_RATIO, MIN_DEVIATION = 3.0, 0.05
"""Multiple of the median deviation, and deviation, above which a hit is left out."""


class HitSelection(NamedTuple):
    """Proposal which hits to keep, with the deviation of each that was compared, 1."""

    keep: tuple[str, ...]
    drop: tuple[str, ...]
    deviations: Mapping[str, float]

    @property
    def message(self) -> str:
        """The proposed selection, and the reason."""
        if not self.deviations:
            return "" if len(self.keep) >= MIN_HITS else "Record at least three hits that pass."
        largest = max(self.deviations[name] for name in self.keep)
        distance_text = f"about the resonance by at most {_format_deviation(largest)}"
        if not self.drop:
            return f"Keep all {len(self.keep)}: each differs from the others {distance_text}."
        dropped_text = ", ".join(
            f"{name} by {_format_deviation(self.deviations[name])}" for name in self.drop
        )
        noun = "hit" if len(self.drop) == 1 else "hits"
        return (
            f"Keep {', '.join(self.keep)}: each differs from the others {distance_text}, "
            f"{noun} {dropped_text}."
        )


def _format_deviation(value: float) -> str:
    return percent(value).lstrip("+")


def estimate_each_hit(impact: ImpactTest, frf: FRF, choices: HammerChoices) -> dict[str, FRF]:
    """Return the FRF of every single hit, by its name; failed ones are omitted.

    Parameters
    ----------
    impact : ImpactTest
    frf : FRF
        Their average, which names them.
    choices : HammerChoices
        By which they were averaged.
    """
    names = [hit.name for hit in frf.hits]
    single_frfs: dict[str, FRF] = {}
    polarity = choices.polarity or (1,) * len(impact.acceleration)
    for name in names[:MAX_HITS]:
        other_names = tuple(other for other in names if other != name)
        single_choices = replace(choices, accept=(name,), reject=other_names)
        # one hit may be too soft to show the polarity of its accelerometers
        for item in (single_choices, replace(single_choices, polarity=polarity)):
            with suppress(DashpotError):
                single_frfs[name] = average(impact, choices=item)
                break
    return single_frfs


def propose_hits(frf: FRF, single_frfs: Mapping[str, FRF]) -> HitSelection:
    """Return which of the accepted hits to keep.

    Parameters
    ----------
    frf : FRF
        The average: its accepted hits, and where its peak lies.
    single_frfs : mapping of str to FRF
        FRF of each hit, on the same lines.
    """
    accepted = tuple(hit.name for hit in frf.hits if hit.accepted)
    names = [name for name in accepted if name in single_frfs]
    if len(names) < MIN_HITS:
        return HitSelection(accepted, (), {})
    peak = find_peak(frf).frequency
    # a softer blow reaches less far: only lines that all of them have are compared
    upper_limits = [peak * BAND_RATIO, *(float(single_frfs[name].frequency[-1]) for name in names)]
    is_near = (frf.frequency > peak / BAND_RATIO) & (frf.frequency < min(upper_limits))
    lines, average_value = frf.frequency[is_near], frf.value[is_near]
    aligned_frfs = {
        name: _align_phase(_interpolate_lines(single_frfs[name], lines), average_value)
        for name in names
    }
    deviations = {name: _compute_deviation(aligned_frfs, name, names) for name in names}
    keep = list(names)
    while len(keep) > MIN_HITS:
        current_deviations = {name: _compute_deviation(aligned_frfs, name, keep) for name in keep}
        worst = max(current_deviations, key=lambda name: current_deviations[name])
        if current_deviations[worst] <= max(
            DEVIATION_RATIO * float(np.median(list(current_deviations.values()))), MIN_DEVIATION
        ):
            break
        deviations[worst] = current_deviations[worst]
        keep.remove(worst)
    deviations |= {name: _compute_deviation(aligned_frfs, name, keep) for name in keep}
    drop = tuple(name for name in names if name not in keep)
    return HitSelection(tuple(name for name in accepted if name not in drop), drop, deviations)


def _interpolate_lines(frf: FRF, lines: FloatArray) -> ComplexArray:
    """Return an FRF on lines that it has, or between its own."""
    f, value = frf.frequency, frf.value
    return np.interp(lines, f, value.real) + 1j * np.interp(lines, f, value.imag)


def _align_phase(value: ComplexArray, average_value: ComplexArray) -> ComplexArray:
    """Return an FRF with the sign of the average, from which that of one hit may differ."""
    return -value if np.vdot(average_value, value).real < 0 else value


def _compute_deviation(
    aligned_frfs: Mapping[str, ComplexArray], name: str, compared_names: Sequence[str]
) -> float:
    other_frfs = np.array([aligned_frfs[other] for other in compared_names if other != name])
    median_frf = np.median(other_frfs.real, axis=0) + 1j * np.median(other_frfs.imag, axis=0)
    return float(np.linalg.norm(aligned_frfs[name] - median_frf) / np.linalg.norm(median_frf))
