r"""Gain of a planned test by blank tests of its machine.

A spring of 1 N/mm pressed as the test is, in noise :math:`\sigma`, cannot give the delay better
than

.. math:: s_\delta = \sigma \Big/ k\,v\,\sqrt{n}, \qquad v = x/t_r

on the n samples of its ramp; after a gap it gives it to twice that. The gain is that of the spring,
and a creep repeats to a tenth.
"""

from __future__ import annotations

import math
from dataclasses import replace

from dashpot.base.number_format import round_to_error
from dashpot.base.units import format_quantity, parse_quantity
from dashpot.datamodel.machine import USUAL, Machine, MachineCalibration
from dashpot.extensions.blank_tests.datamodel import REPEATS
from dashpot.extensions.blank_tests.fit import SPRING_ERROR
from dashpot.planning.expected_errors import expected_end, expected_error
from dashpot.planning.planned_ramp_hold import Bench
from dashpot.solids.maxwell import GeneralizedMaxwell

SPRING = parse_quantity("1N/mm", "stiffness")
"""Stiffness of the spring that is supposed."""
_AFTER_A_GAP = 2.0
_WORTH = 0.9
"""Part of a standard deviation below which a blank test is worth a sentence."""


def expect_machine(bench: Bench) -> Machine:
    """Return the machine that blank tests would describe, with the noise of a planned test."""
    machine = bench.machine or Machine()
    samples = bench.rate * bench.ramp_time
    delay = bench.noise * bench.ramp_time / (SPRING * bench.depth * math.sqrt(samples))
    return replace(
        machine,
        sync=_AFTER_A_GAP * delay,
        compliance=machine.compliance or 0.0,
        creep=REPEATS * USUAL["crosshead"].size * bench.depth,
        calibration=MachineCalibration(gain_error=SPRING_ERROR),
    )


def advise_blank_tests(
    model: GeneralizedMaxwell, bench: Bench, at: float, arm: int | None
) -> tuple[str, ...]:
    """Return what blank tests of the machine would buy, as a sentence; none where that is little.

    Parameters
    ----------
    model : GeneralizedMaxwell
        The solid that is supposed, its unseen arm included.
    bench : Bench
        The planned test.
    at : float
        The frequency that matters, Hz.
    arm : int or None
        Index of the unseen arm.
    """
    if bench.machine is None or bench.machine.calibration is not None:
        return ()
    known = replace(bench, machine=expect_machine(bench))
    ends = [expected_end(model, each).half_width for each in (bench, known)]
    losses = [expected_error(model, each, at, arm).loss_factor_sd for each in (bench, known)]
    if ends[1] > _WORTH * ends[0] and not losses[1] < _WORTH * losses[0]:
        return ()
    end, end_known, loss, loss_known = (_format_percent(value) for value in (*ends, *losses))
    hold = format_quantity(bench.hold_time, "s", ".4g")
    text = (
        "Record blank tests of the machine, a rigid stop, a spring and an empty run: the stiffness "
        f"at {hold} would be known to {end_known} instead of {end} (95 %)"
    )
    if losses[1] < _WORTH * losses[0]:
        text += f", the loss factor to {loss_known} instead of {loss} (1 SD)"
    return (f"{text}.",)


def _format_percent(value: float) -> str:
    return f"{round_to_error(100 * value, digits=2)} %" if math.isfinite(value) else "nothing"
