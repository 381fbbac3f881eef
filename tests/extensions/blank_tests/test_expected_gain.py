"""What blank tests would buy, before they are made."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import dashpot as dp
from dashpot.datamodel.machine import MachineCalibration
from dashpot.extensions.blank_tests.expected_gain import advise_blank_tests, expect_machine
from dashpot.planning.expected_errors import expected_end
from dashpot.planning.planned_ramp_hold import Bench
from dashpot.solids.demo_seals import PAPER


def test_expected_delay_is_twice_the_bound_of_a_spring_held_from_the_start() -> None:
    machine = expect_machine(Bench(noise=4e-3, rate=1000.0))
    assert machine.sync == pytest.approx(2 * 4e-3 / (8.0 * np.sqrt(1000)), rel=1e-9)


def test_plan_says_what_blank_tests_would_buy_and_a_file_silences_it() -> None:
    planned = dp.plan(frequency="12.71Hz", ramp="1s", hold="40s")
    assert any(line.startswith("Record blank tests of the machine") for line in planned.advice)
    expected = dp.Machine(sync="0.03ms", calibration=MachineCalibration(gain_error=1e-3))
    again = dp.plan(frequency="12.71Hz", ramp="1s", hold="40s", machine=expected)
    assert not any("blank tests" in line for line in again.advice)


def test_advice_names_the_half_widths_that_the_plan_itself_would_print() -> None:
    bench = Bench(baseline=10.0)
    expected = replace(bench, machine=expect_machine(bench))
    (text,) = advise_blank_tests(PAPER, bench, 12.71, None)
    before, after = (expected_end(PAPER, each).half_width for each in (bench, expected))
    assert after < 0.5 * before
    assert f"known to {100 * after:.2g} % instead of {100 * before:.2g} % (95 %)" in text


def test_advice_is_silent_without_a_machine() -> None:
    assert advise_blank_tests(PAPER, Bench(machine=None), 12.71, None) == ()
