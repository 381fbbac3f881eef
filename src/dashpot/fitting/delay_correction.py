r"""A force that comes too late for a tangent: its solid answers the motion as late as it is.

To first order a delay adds :math:`-\delta\dot F`. Of 10 ms at a corner of the ramp that is off by
:math:`\delta^2\ddot F/2`, which looks like a bent law. So where no linear solid is sound and the
force lags, the solid is asked again of a motion that is late by whole samples, and of one behind
a low-pass of that time constant. What is left of the delay stays a nuisance term.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.provenance import Step
from dashpot.base.units import format_quantity
from dashpot.datamodel.relaxation import RampHold
from dashpot.fitting.design_matrix import FitSetup
from dashpot.fitting.fit_data import FitData, data_of
from dashpot.fitting.linearity import HoldBlocks, LinearityResult, assess_linearity
from dashpot.fitting.nuisance_priors import LINEAR_DELAY
from dashpot.fitting.pipeline import FitOptions
from dashpot.signals.noise import evenly_sampled


class DelayedMotion(NamedTuple):
    """Tests whose motion is as late as their force.

    Attributes
    ----------
    holds : Holds
    data : FitData
    lags : tuple of float
        By how much each motion was made late, s: 0 as recorded.
    filtered : bool
        Whether by low-passes of those time constants.
    """

    holds: HoldBlocks
    data: FitData
    lags: tuple[float, ...]
    filtered: bool = False

    @classmethod
    def from_records(
        cls,
        records: Sequence[RampHold],
        design: FitSetup,
        lags: tuple[float, ...] = (),
        *,
        filtered: bool = False,
    ) -> DelayedMotion:
        """The data of records; as they are where no lags are said."""
        still = (0.0,) * len(records)
        return cls(HoldBlocks(records), data_of(records, design), lags or still, filtered)

    def coefficients(self, function: Callable[[str], float]) -> Callable[[str], float]:
        """The value of a column by its name, a delay with what the motion was made late by."""
        late = {f"delay@{i}": lag for i, lag in enumerate(self.lags)}
        return lambda name: function(name) + late.get(name, 0.0)

    @property
    def steps(self) -> tuple[Step, ...]:
        """What was done to the motion."""
        if not any(self.lags):
            return ()
        late = " and ".join(format_quantity(lag, "ms", ".3g") for lag in self.lags)
        parameters = (("lag_s", ", ".join(f"{lag:.6g}" for lag in self.lags)),)
        how = f"put the motion behind a low-pass of {late}"
        if not self.filtered:
            how = f"took the motion {late} later"
        return (Step("lag", parameters, f"{how}, as the force comes"),)


def select_delayed_motion(
    recorded: DelayedMotion, options: FitOptions
) -> tuple[DelayedMotion, LinearityResult]:
    """Return the motion under which a linear solid is sound, and how sound it is.

    As recorded where one is, or where a later motion makes none so; else the later motion that
    leaves least.
    """
    gate = assess_linearity(recorded.holds, recorded.data, options)
    if gate.sound:
        return recorded, gate
    tried = [
        (motion, assess_linearity(motion.holds, motion.data, options))
        for motion in _later(recorded, gate)
    ]
    reliable = [pair for pair in tried if pair[1].sound]
    return min(reliable, key=lambda pair: pair[1].first.solutions[-1].sse, default=(recorded, gate))


def _later(recorded: DelayedMotion, gate: LinearityResult) -> Iterator[DelayedMotion]:
    """The motions that may be as late as the force of the best linear solid."""
    records, best = recorded.holds.records, gate.first.solutions[-1]
    values = [best.coefficient(f"delay@{i}") for i in range(len(records))]
    late = tuple(lag if lag > LINEAR_DELAY else 0.0 for lag in values)
    shifted, lags = zip(*map(_shift_motion, records, late), strict=True)
    if any(lags):
        yield DelayedMotion.from_records(shifted, FitSetup("full"), lags)
    if any(late) and not any(record.machine.force_filter for record in records):
        behind = [*map(_set_force_filter, records, late)]
        yield DelayedMotion.from_records(behind, FitSetup("full"), late, filtered=True)


def _shift_motion(record: RampHold, lag: float) -> tuple[RampHold, float]:
    """The record with its motion late by whole samples, whose counts are as they were read."""
    step = record.step
    many = round(lag / step) if evenly_sampled(record.time) else 0
    if not many:
        return record, 0.0

    def late(values: FloatArray) -> FloatArray:
        return np.concatenate((np.full(many, values[0]), values[:-many]))

    provided = None if record.given is None else late(record.given)
    return replace(record, displacement=late(record.displacement), given=provided), many * step


def _set_force_filter(record: RampHold, lag: float) -> RampHold:
    """The record with a force behind a low-pass of this time constant, as one that is named."""
    if not lag:
        return record
    return replace(record, machine=replace(record.machine, force_filter=1 / (2 * np.pi * lag)))
