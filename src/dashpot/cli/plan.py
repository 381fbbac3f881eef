"""dashpot plan: what a test can and cannot tell, before it is run."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import click

import dashpot as dp
from dashpot.base.checks import verdict
from dashpot.base.errors import DataError
from dashpot.base.version import byline
from dashpot.cli import _options as options
from dashpot.cli._options import Direction, WithUnit, given
from dashpot.cli._shell import Outcome, Output, reports, typed, write
from dashpot.cli._terminal import Text
from dashpot.cli.simulate import seal as seal_named
from dashpot.io.write import write_trajectory

if TYPE_CHECKING:
    from dashpot.solids.temperature import TemperatureLaw


@click.command("plan")
@click.option("--at", type=WithUnit("frequency"), required=True, help="Frequency that matters.")
@options.filled(dp.Bench, "bench", show_default=True)
@click.option(
    "--model", metavar="paper|broad|hidden|FIT", help="A guess at the seal; else Table 1."
)
@click.option("--arm-stiffness", type=WithUnit("stiffness"), help="Of the arm that may hide.")
@click.option("--arm-time", type=WithUnit("time"), help="Its relaxation time; else 1/omega.")
@options.filled(dp.Machine, "machine", leave=("compliance", "force_filter"))
@options.filled(dp.HammerPlan, "hammer", show_default=True)
@click.option("--wanted", type=float, default=10.0, show_default=True, help="SD that would do, %.")
@click.option(
    "--cold",
    type=WithUnit("temperature"),
    multiple=True,
    help="Repeated there too, e.g. 0degC; repeat it for more.",
)
@options.filled(dp.SupposedSeal, "seal")
@options.wlf
@click.option(
    "--setpoints",
    type=Output((".csv", ".txt")),
    metavar="FILE",
    help="Write the planned motion for a controller, one set-point a row; - is stdout.",
)
@click.option("--interval", type=WithUnit("time"), default="10ms", show_default=True)
@click.option(
    "--along",
    type=Direction(),
    default="0,0,-1",
    show_default=True,
    help="Where the plate goes, in the axes of the controller.",
)
@options.force
@reports
def command(
    *,
    at: float,
    bench: dp.Bench,
    machine: dp.Machine,
    hammer: dp.HammerPlan,
    seal: dp.SupposedSeal,
    model: str | None,
    arm_stiffness: float | None,
    arm_time: float | None,
    wanted: float,
    cold: tuple[float, ...],
    wlf: TemperatureLaw | None,
    setpoints: str | None,
    interval: float,
    along: tuple[float, float, float],
) -> Outcome:
    """Tell how well a planned test will know stiffness and loss factor at a frequency.

    \b
    dashpot plan --ramp 1s --hold 40s --at 12.71Hz
    dashpot plan --ramp 0.1s --at 12.71Hz --noise 1mN --record 8s --pulse 15ms
    dashpot plan --ramp 1s --at 12.71Hz --sync 0.5ms --drift 0.2mN/s
    dashpot plan --ramp 1s --at 12.71Hz --cold 0degC --cold 10degC
    dashpot plan --ramp 1s --hold 40s --at 12.71Hz --setpoints ramp.csv
    """
    if arm_time is not None and arm_stiffness is None:
        raise DataError("--arm-time needs --arm-stiffness, e.g. --arm-stiffness 0.05N/mm")
    arm = None
    if arm_stiffness is not None:
        arm = (arm_stiffness, arm_time if arm_time is not None else 1 / (2 * math.pi * at))
    guess = seal_named("paper" if model is None else model)
    bench = replace(bench, machine=machine)
    found = dp.plan(
        bench,
        at=at,
        seal=replace(seal, model=guess.solid, arm=arm, law=wlf or guess.law),
        hammer=hammer,
        cold=cold,
        wanted=wanted / 100,
    )
    if setpoints is not None:
        motion = dp.planned_trajectory(
            depth=bench.depth,
            ramp_time=bench.ramp_time,
            hold_time=bench.hold_time,
            baseline=bench.baseline,
            interval=interval,
            along=along,
        )
        count = byline(f"planned test, {len(motion.time)} set-points")
        rest, ramp, hold = bench.baseline, bench.ramp_time, bench.hold_time
        timed = f"rest {rest:g} s, ramp {ramp:g} s, hold {hold:g} s"
        says = (count, f"{timed}; one each {interval:g} s, the first where the plate touches")
        write(setpoints, write_trajectory(motion, comments=says))
    rehearsed = typed(
        "simulate",
        "relaxation",
        *given("bench_ramp_time", "bench_hold_time"),
        "-o",
        "rehearsal.csv",
        why="rehearses it",
    )
    made = verdict(found.checks)
    return Outcome(found, Text([str(found)]), found.checks, verdict=made, follow=rehearsed)
