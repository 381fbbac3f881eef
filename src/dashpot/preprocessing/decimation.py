"""Long records: neighbouring samples averaged, in both channels alike."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dashpot.base.arrays import block_means
from dashpot.base.provenance import Step
from dashpot.datamodel.relaxation import RampHold
from dashpot.signals.noise import evenly_sampled, scatter

# samples that no fit needs more of
ENOUGH = 200_000
# and of them at least so many on the ramp
ON_THE_RAMP = 500


def decimate(record: RampHold) -> RampHold:
    r"""Average neighbouring samples of a record that is longer than any fit needs.

    A mean over m samples is a filter that commutes with every linear solid,
    :math:`\bar F = K * \bar x`, so the same solid answers the averaged motion with the averaged
    force. Displacement in counts is read at the middle sample instead, where it stays in counts:
    the mean differs from it by :math:`(m h)^2 \ddot x / 24`, h the sampling interval. Arms faster
    than m h are out of reach; no ramp of 500 m samples or more shows them.
    """
    count = _neighbours(record)
    if count == 1:
        return record
    time, force = block_means(record.time, count), block_means(record.force, count)
    displacement = record.displacement[count // 2 : count * len(time) : count]
    noise = record.displacement_noise
    late = slice(int(np.searchsorted(time, record.ramp_end + record.hold_time / 10)), None)
    if not record.encoder_step > 0:
        displacement = block_means(record.displacement, count)
        noise = scatter(time[late], displacement[late])
    says = (
        f"averaged each {count} of {len(record.time)} samples, force and displacement alike: "
        "more than a fit needs, and any linear solid answers a mean with a mean"
    )
    return replace(
        record,
        time=time,
        displacement=displacement,
        force=force,
        hold_end=min(record.hold_end, float(time[-1])),
        force_noise=scatter(time[late], force[late]),
        displacement_noise=noise,
        given=None if record.given is None else block_means(record.given, count),
        plate=None if record.plate is None else block_means(record.plate, count),
        steps=(*record.steps, Step("average", (("samples", str(count)),), says)),
    )


def _neighbours(record: RampHold) -> int:
    """How many samples become one, an odd number; one where averaging is no help or no mean."""
    step = float(record.time[-1] - record.time[0]) / (len(record.time) - 1)
    most = int(record.ramp_time / step / ON_THE_RAMP)
    count = min(len(record.time) // ENOUGH, most)
    in_counts_of_force = record.given is not None and record.encoder_step > 0
    if count < 2 or in_counts_of_force or not evenly_sampled(record.time):
        return 1
    return count - 1 + count % 2
