r"""Which hits of a hammer test to keep: how far the FRF of each is from those of the others.

Of each accepted hit :math:`i` with its own FRF :math:`A_i`, over the lines within a factor of 2.3
of the resonance,

.. math:: d_i = \\frac{\\|A_i - m_i\\|}{\\|m_i\\|}

where :math:`m_i` is the median, of real and imaginary part, of all the other accepted hits. The hit
that is farthest off is left out while it is off by three times the median of all and by 5 %, and
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

MOST = 24
"""Hits whose own FRFs are estimated."""
ABOUT = 2.3
"""Times the resonance to either side, Hz/Hz."""
FEWEST = 3
"""Hits that are kept at least."""
FACTOR, LEAST = 3.0, 0.05
"""Times the median deviation, and the deviation, above which a hit is left out."""


class HitSelection(NamedTuple):
    """Proposal which hits to keep, with the deviation of each that was compared, 1."""

    keep: tuple[str, ...]
    drop: tuple[str, ...]
    deviations: Mapping[str, float]

    @property
    def message(self) -> str:
        """What is proposed, and why."""
        if not self.deviations:
            return "" if len(self.keep) >= FEWEST else "Record at least three hits that pass."
        rest = max(self.deviations[name] for name in self.keep)
        within = f"about the resonance by at most {_part(rest)}"
        if not self.drop:
            return f"Keep all {len(self.keep)}: each differs from the others {within}."
        off = ", ".join(f"{name} by {_part(self.deviations[name])}" for name in self.drop)
        word = "hit" if len(self.drop) == 1 else "hits"
        return f"Keep {', '.join(self.keep)}: each differs from the others {within}, {word} {off}."


def _part(value: float) -> str:
    return percent(value).lstrip("+")


def estimate_each_hit(impact: ImpactTest, frf: FRF, choices: HammerChoices) -> dict[str, FRF]:
    """Return the FRF of every hit alone, by its name; none of one that gives none.

    Parameters
    ----------
    impact : ImpactTest
    frf : FRF
        Their average, which names them.
    choices : HammerChoices
        By which they were averaged.
    """
    names = [hit.name for hit in frf.hits]
    single: dict[str, FRF] = {}
    unturned = choices.polarity or (1,) * len(impact.acceleration)
    for name in names[:MOST]:
        others = tuple(other for other in names if other != name)
        alone = replace(choices, accept=(name,), reject=others)
        # one hit may be too soft to tell how its accelerometers are turned
        for asked in (alone, replace(alone, polarity=unturned)):
            with suppress(DashpotError):
                single[name] = average(impact, choices=asked)
                break
    return single


def propose_hits(frf: FRF, single: Mapping[str, FRF]) -> HitSelection:
    """Return which of the accepted hits to keep.

    Parameters
    ----------
    frf : FRF
        The average: its accepted hits, and where its peak lies.
    single : mapping of str to FRF
        Of each hit, on the same lines.
    """
    accepted = tuple(hit.name for hit in frf.hits if hit.accepted)
    names = [name for name in accepted if name in single]
    if len(names) < FEWEST:
        return HitSelection(accepted, (), {})
    peak = find_peak(frf).frequency
    # a softer blow reaches less far: only lines that all of them have are compared
    ends = [peak * ABOUT, *(float(single[name].frequency[-1]) for name in names)]
    near = (frf.frequency > peak / ABOUT) & (frf.frequency < min(ends))
    lines, whole = frf.frequency[near], frf.value[near]
    rows = {name: _align_phase(_on_lines(single[name], lines), whole) for name in names}
    deviations = {name: _deviation(rows, name, names) for name in names}
    keep = list(names)
    while len(keep) > FEWEST:
        now = {name: _deviation(rows, name, keep) for name in keep}
        worst = max(now, key=lambda name: now[name])
        if now[worst] <= max(FACTOR * float(np.median(list(now.values()))), LEAST):
            break
        deviations[worst] = now[worst]
        keep.remove(worst)
    deviations |= {name: _deviation(rows, name, keep) for name in keep}
    drop = tuple(name for name in names if name not in keep)
    return HitSelection(tuple(name for name in accepted if name not in drop), drop, deviations)


def _on_lines(frf: FRF, lines: FloatArray) -> ComplexArray:
    """Return an FRF on lines that it has, or between its own."""
    f, value = frf.frequency, frf.value
    return np.interp(lines, f, value.real) + 1j * np.interp(lines, f, value.imag)


def _align_phase(value: ComplexArray, whole: ComplexArray) -> ComplexArray:
    """Return an FRF with the sign of the average: one hit alone may be turned by its own."""
    return -value if np.vdot(whole, value).real < 0 else value


def _deviation(rows: Mapping[str, ComplexArray], name: str, among: Sequence[str]) -> float:
    others = np.array([rows[other] for other in among if other != name])
    middle = np.median(others.real, axis=0) + 1j * np.median(others.imag, axis=0)
    return float(np.linalg.norm(rows[name] - middle) / np.linalg.norm(middle))
