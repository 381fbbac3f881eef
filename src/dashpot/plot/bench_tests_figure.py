"""The figure of a fit by what it was fitted to."""

from __future__ import annotations

from collections.abc import Sequence

from dashpot.datamodel.fit import Fit
from dashpot.datamodel.relaxation import RampHold
from dashpot.extensions.curves.creep.figure import creep
from dashpot.extensions.curves.datamodel.creep import CreepCompliance, LoadHold
from dashpot.extensions.curves.datamodel.dynamic import DynamicTest
from dashpot.extensions.curves.datamodel.modulus import RelaxationModulus
from dashpot.extensions.curves.datamodel.superposition import Superposition
from dashpot.extensions.curves.superposition.figure import superposition
from dashpot.extensions.curves.temperatures.figure import temperatures
from dashpot.extensions.curves.time_curve_figure import modulus
from dashpot.plot.picture import Picture
from dashpot.plot.relaxation import fit
from dashpot.plot.solid import stiffness

Record = RampHold | DynamicTest | RelaxationModulus | LoadHold | CreepCompliance | Superposition


def bench(found: Fit, records: Sequence[Record], *, alternatives: Sequence[Fit] = ()) -> Picture:
    """Return the figure that suits the records that a fit was made from.

    Parameters
    ----------
    found : Fit
    records : sequence
        As fitted; of one kind.
    alternatives : sequence of Fit
        Of one ramp and hold: fits of other numbers of arms, drawn with it.
    """
    first = records[0]
    if isinstance(first, Superposition):
        return superposition(first, found)
    if isinstance(first, RelaxationModulus):
        return modulus(found, first)
    if isinstance(first, LoadHold | CreepCompliance):
        return creep(found, first)
    if isinstance(first, DynamicTest):
        return stiffness(found, data=first)
    if found.temperatures is not None:
        return temperatures(found, [one for one in records if isinstance(one, RampHold)])
    return fit(found, first, alternatives=alternatives)
