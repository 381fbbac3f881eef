r"""Gain of a planned test by blank tests of its machine.

A spring of 1 N/mm pressed as the test is, in noise :math:`\sigma`, cannot give the delay better
than

.. math:: s_\delta = \sigma \Big/ k\,v\,\sqrt{n}, \qquad v = x/t_r

on the n samples of its ramp; after a gap it gives it to twice that. The gain is that of the spring,
and creep repeats within 10 %.
"""

from __future__ import annotations

import math
from dataclasses import replace

from dashpot.base.number_format import round_to_error
from dashpot.base.units import format_quantity, parse_quantity
from dashpot.datamodel.machine import DEFAULT_UNCERTAINTIES, Machine, MachineCalibration
from dashpot.extensions.blank_tests.datamodel import CREEP_REPEATABILITY, SPRING_ERROR
from dashpot.planning.expected_errors import expected_end, expected_error
from dashpot.planning.planned_ramp_hold import Bench
from dashpot.solids.maxwell import GeneralizedMaxwell

SPRING = parse_quantity("1N/mm", "stiffness")
"""Stiffness of the spring that is supposed."""
_GAP_FACTOR = 2.0
_WORTHWHILE_RATIO = 0.9
"""Ratio of standard deviations below which a blank test is recommended."""


def expect_machine(bench: Bench) -> Machine:
    """Return the machine that blank tests would describe, with the noise of a planned test."""
    machine = bench.machine or Machine()
    samples = bench.rate * bench.ramp_time
    delay = bench.noise * bench.ramp_time / (SPRING * bench.depth * math.sqrt(samples))
    return replace(
        machine,
        sync=_GAP_FACTOR * delay,
        compliance=machine.compliance or 0.0,
        creep=CREEP_REPEATABILITY * DEFAULT_UNCERTAINTIES["crosshead"].size * bench.depth,
        calibration=MachineCalibration(gain_error=SPRING_ERROR),
    )


def advise_blank_tests(
    model: GeneralizedMaxwell, bench: Bench, frequency: float, arm: int | None
) -> tuple[str, ...]:
    """Return a sentence on the smaller errors after blank tests; none where the gain is small.

    Parameters
    ----------
    model : GeneralizedMaxwell
        The assumed solid, including its unresolved arm.
    bench : Bench
        The planned test.
    frequency : float
        The frequency that matters, Hz.
    arm : int or None
        Index of the unresolved arm.
    """
    if bench.machine is None or bench.machine.calibration is not None:
        return ()
    calibrated = replace(bench, machine=expect_machine(bench))
    half_widths = [expected_end(model, planned).half_width for planned in (bench, calibrated)]
    losses = [
        expected_error(model, planned, frequency, arm).loss_factor_sd
        for planned in (bench, calibrated)
    ]
    if (
        half_widths[1] > _WORTHWHILE_RATIO * half_widths[0]
        and not losses[1] < _WORTHWHILE_RATIO * losses[0]
    ):
        return ()
    end, end_after, loss, loss_after = (_format_percent(value) for value in (*half_widths, *losses))
    hold = format_quantity(bench.hold_time, "s", ".4g")
    text = (
        "Record blank tests of the machine, on a rigid stop, on a spring and without a seal: the "
        f"stiffness at {hold} would be known to {end_after} instead of {end} (95 %)"
    )
    if losses[1] < _WORTHWHILE_RATIO * losses[0]:
        text += f", the loss factor to {loss_after} instead of {loss} (1 SD)"
    return (f"{text}.",)


def _format_percent(value: float) -> str:
    """Return a relative error in per cent; "nothing" if it is unlimited."""
    return f"{round_to_error(100 * value, digits=2)} %" if math.isfinite(value) else "nothing"
