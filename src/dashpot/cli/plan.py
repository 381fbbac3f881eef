"""dashpot plan: the quantities a test can determine, before it is run."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import click

import dashpot as dp
from dashpot import workflow
from dashpot.base.errors import DataError
from dashpot.base.version import byline
from dashpot.cli import _options as options
from dashpot.cli._command import build_options, group, mark_advanced, opt, verb
from dashpot.cli._command_files import format_command
from dashpot.cli._command_result import CommandResult, write_output
from dashpot.cli._options import get_typed_options
from dashpot.cli._param_types import Direction, Output, WithUnit
from dashpot.cli._simulation_options import load_simulated_seal
from dashpot.datamodel.machine import Machine
from dashpot.planning.plan_options import HammerPlan, PlannedRamp
from dashpot.registry import call_handler, find_handler, list_names
from dashpot.text_output.layout import Text

if TYPE_CHECKING:
    from dashpot.solids.shift_laws import TemperatureLaw


_NOT_SIMULATED = (
    "frequency", "cold", "hammer_hits", "hammer_record", "hammer_pulse", "hammer_coherence",
    "bench_method", "bench_baseline",
)  # fmt: skip
"""Options of the planned test that a simulated one has not."""
_TEST_GROUP, _PRIOR_GROUP, _CONTROLLER_GROUP = "Planned test", "Known beforehand", "Controller"


@verb(
    "plan",
    """Say how well a planned test will measure a seal at a frequency.

  dashpot plan --frequency 12.71Hz --ramp 1s --hold 40s
  dashpot plan --frequency 12.71Hz --ramp 1s --cold 0degC
  dashpot plan --frequency 12.71Hz --ramp 1s --hold 40s --setpoints ramp.csv
  dashpot plan --use-at 70degC --longest 1000h --hottest 150degC""",
    group(
        _TEST_GROUP,
        opt("--frequency", type=WithUnit("frequency"), metavar="FREQUENCY",
            help="The frequency that matters, e.g. 12.71Hz."),
        build_options(PlannedRamp, "depth", "ramp_time", "hold_time", argument="bench"),
        opt(
            "--temperature",
            type=WithUnit("temperature"),
            metavar="TEMPERATURE",
            help="Test temperature (23degC, or that of the fit).",
        ),
        opt("--cold", type=WithUnit("temperature"), multiple=True, metavar="TEMPERATURE",
            help="Repeat it at this temperature, e.g. 0degC."),
        build_options(HammerPlan, "hits", "record", argument="hammer"),
        mark_advanced(
            build_options(PlannedRamp, "rate", "method", "baseline", argument="bench"),
            build_options(HammerPlan, argument="hammer", omit=("hits", "record", "mass", "seals")),
        ),
    ),
    group(
        _PRIOR_GROUP,
        build_options(PlannedRamp, "noise", argument="bench"),
        opt("--seal", "guess", metavar="NAME|FIT",
            help="Demo seal (paper, broad, hidden) or a fit."),
        build_options(HammerPlan, "mass", "seals", argument="hammer"),
        opt("--target-sd", "target_sd", hidden_alias="wanted", type=float, default=10.0,
            metavar="PERCENT", help="Target standard deviation (10)."),
        mark_advanced(
            build_options(Machine, argument="machine", omit=("force_filter",),
               help="What is known of the machine."),
            opt("--arm-stiffness", type=WithUnit("stiffness"), metavar="STIFFNESS",
                help="Stiffness of an arm that may be hidden."),
            opt("--arm-time", type=WithUnit("time"), metavar="TIME",
                help="Its relaxation time (1/omega)."),
            options.wlf_option(),
        ),
    ),
    group(
        _CONTROLLER_GROUP,
        opt("--setpoints", type=Output((".csv", ".txt")), metavar="FILE",
            help="Write the motion, one set-point a row."),
        mark_advanced(
            opt("--interval", type=WithUnit("time"), default="10ms", metavar="TIME",
                help="Between set-points (10ms)."),
            opt("--along", type=Direction(), default="0,0,-1", metavar="X,Y,Z",
                help="Direction of the plate (0,0,-1)."),
        ),
    ),
    *call_handler("option groups", "plan", default=()),
    options.result_options(plot=False, has_open_option=False),
)  # fmt: skip
def command(**arguments: Any) -> CommandResult:
    """Plan a ramp and hold, or the test of which an option is typed."""
    test_option = next(
        (name for name in list_names("plan test") if arguments[name] is not None), "frequency"
    )
    plan = find_handler("plan test", test_option) or _plan_ramp_hold
    if arguments[test_option] is None:
        raise click.UsageError("Missing option '--frequency'.")
    return plan(
        **options.select_arguments(
            plan, arguments, command, f"does not go with --{test_option.replace('_', '-')}"
        )
    )


def _plan_ramp_hold(
    *,
    frequency: float,
    bench: PlannedRamp,
    machine: Machine,
    hammer: HammerPlan,
    temperature: float | None,
    guess: str | None,
    arm_stiffness: float | None,
    arm_time: float | None,
    target_sd: float,
    cold: tuple[float, ...],
    wlf: TemperatureLaw | None,
    setpoints: str | None,
    interval: float,
    along: tuple[float, float, float],
) -> CommandResult:
    """Print the expected errors of stiffness and loss factor of a planned test."""
    if arm_time is not None and arm_stiffness is None:
        raise DataError("--arm-time needs --arm-stiffness, e.g. --arm-stiffness 0.05N/mm")
    arm = None
    if arm_stiffness is not None:
        arm = (arm_stiffness, arm_time if arm_time is not None else 1 / (2 * math.pi * frequency))
    assumed_seal = load_simulated_seal("paper" if guess is None else guess)
    planned_bench = workflow.Bench(**vars(bench), machine=machine)
    plan = workflow.plan(
        planned_bench,
        at=frequency,
        seal=workflow.AssumedSeal(assumed_seal.solid, arm, temperature, wlf or assumed_seal.law),
        hammer=hammer,
        cold=cold,
        target_sd=target_sd / 100,
    )
    if setpoints is not None:
        from dashpot.reading.write import write_trajectory

        motion = dp.files.planned_trajectory(
            depth=bench.depth,
            ramp_time=bench.ramp_time,
            hold_time=bench.hold_time,
            baseline=bench.baseline,
            interval=interval,
            along=along,
        )
        title = byline(f"planned test, {len(motion.time)} set-points")
        timing = (
            f"rest {bench.baseline:g} s, ramp {bench.ramp_time:g} s, hold {bench.hold_time:g} s"
        )
        comments = (title, f"{timing}; one each {interval:g} s, the first where the plate touches")
        write_output(setpoints, write_trajectory(motion, comments=comments))
    next_command = format_command(
        "simulate",
        "relaxation",
        *get_typed_options(_TEST_GROUP, excluded=_NOT_SIMULATED),
        *(() if guess is None else ("--seal", guess)),
        "-o",
        "rehearsal.csv",
        remark="simulates this test",
    )
    return CommandResult(
        plan, Text([str(plan)]), plan.checks, verdict=plan.verdict, next_command=next_command
    )
