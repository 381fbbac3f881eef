"""Example files, simulated reproducibly and marked as such.

The virtual rig and hammer write them when asked. Stored in the package they would be megabytes of
numbers that the code makes in a second, and could be out of date.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from types import MappingProxyType

import numpy as np

from dashpot.base.units import format_quantity
from dashpot.reading.write import write_impact, write_relaxation
from dashpot.registry import KINDS, Example, load_object
from dashpot.simulation.ground_truth import stamp
from dashpot.simulation.impact import Hammer, simulate_impact
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.simulation.rig_errors import Climate, Rig
from dashpot.solids.demo_seals import BROAD, BROAD_MASS

MASS = round(BROAD_MASS, 4)
"""Mass of the block under the hammer, kg: 114.8 g on two seals."""

_RIG = replace(Rig(), rate=200.0)
# a seal that is a quarter stiffer at 8 mm than at first contact
_STIFFENING = replace(Rig(), rate=250.0, bias=0.02, stiffening=4000.0)
# arms a decade apart differ by thousandths of the force: a finer encoder, a faster record
_FINE = replace(Rig(), rate=500.0, encoder=2e-6)
_HAMMER = replace(Hammer(), rate=512.0, record=6.0)


def _write_seal(
    seed: int,
    *,
    depth: float = 8e-3,
    hold: float = 40.0,
    rig: Rig = _RIG,
    celsius: float | None = None,
) -> Callable[[], str]:
    climate = None if celsius is None else Climate(celsius + 273.15)

    def simulate_test_file() -> str:
        relaxation = simulate_relaxation(
            BROAD, depth=depth, hold_time=hold, rig=rig, seed=seed, climate=climate
        )
        return write_relaxation(relaxation.test, comments=stamp(relaxation.truth)[:1])

    return simulate_test_file


def _simulate_clipped_test() -> str:
    """Return a load cell whose range ends at three quarters of the force."""
    relaxation = simulate_relaxation(BROAD, rig=_RIG, seed=7)
    force_limit = 0.75 * float(relaxation.test.force.max())
    spoilt = replace(relaxation.test, force=np.minimum(relaxation.test.force, force_limit))
    return write_relaxation(
        spoilt, comments=(*stamp(relaxation.truth)[:1], "spoilt: the load cell clips")
    )


def _write_hammer() -> str:
    impact = simulate_impact(BROAD, mass=MASS, seals=2, hits=5, rig=_HAMMER, seed=1)
    return write_impact(impact.test, comments=stamp(impact.truth)[:1])


_BENCH = {
    "seal_8mm.csv": Example(
        "relaxation", "a seal pressed 8 mm in 1 s and held 40 s", _write_seal(1)
    ),
    "hammer.csv": Example(
        "impact",
        f"a mass of {format_quantity(MASS, 'g', 'g')} on two such seals, struck five times",
        _write_hammer,
    ),
    "depth_4mm.csv": Example(
        "relaxation",
        "a seal that stiffens as it is pressed, to 4 mm",
        _write_seal(3, depth=4e-3, rig=_STIFFENING),
    ),
    "depth_6mm.csv": Example(
        "relaxation", "the same to 6 mm", _write_seal(2, depth=6e-3, rig=_STIFFENING)
    ),
    "depth_8mm.csv": Example(
        "relaxation",
        "the same to 8 mm: dashpot fit --elastic by-depth takes the three",
        _write_seal(1, depth=8e-3, rig=_STIFFENING),
    ),
    "at_23degC.csv": Example(
        "relaxation", "another seal at 23 degC", _write_seal(5, rig=_FINE, celsius=23.0)
    ),
    "at_10degC.csv": Example(
        "relaxation", "the same at 10 degC", _write_seal(6, rig=_FINE, celsius=10.0)
    ),
    "at_0degC.csv": Example(
        "relaxation",
        "the same at 0 degC: dashpot fit takes the three together",
        _write_seal(7, rig=_FINE, celsius=0.0),
    ),
    "short_hold.csv": Example(
        "relaxation", "a hold of 3 s, too short for the slow arms", _write_seal(4, hold=3.0)
    ),
    "clipped.csv": Example(
        "relaxation", "a load cell that clips: a test not to be used", _simulate_clipped_test
    ),
}
FILES: Mapping[str, Example] = MappingProxyType({
    **_BENCH,
    **{
        name: item
        for kind in KINDS.values()
        if kind.examples
        for name, item in load_object(kind.examples).items()
    },
})  # fmt: skip
"""Every example file: those of a bench and a hammer, of the kinds of extensions."""

CAPTIONS: Mapping[str, str] = MappingProxyType({name: file.caption for name, file in FILES.items()})
"""Captions of the example files."""

FIRST = ("seal_8mm.csv", "hammer.csv")
"""The two files of the first seal."""

EXAMPLES: Mapping[str, Callable[[], str]] = MappingProxyType(
    {name: cache(file.write) for name, file in FILES.items()}
)
"""Every example file and the function that writes it: once, as it is the same every time."""
