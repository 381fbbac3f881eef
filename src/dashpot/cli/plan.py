"""dashpot plan: what a test can and cannot tell, before it is run."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import click

import dashpot as dp
from dashpot.base.checks import verdict
from dashpot.base.errors import DataError
from dashpot.base.version import byline
from dashpot.cli import _options as options
from dashpot.cli._options import Direction, Quantity, given
from dashpot.cli._shell import Outcome, Output, reports, typed, write
from dashpot.cli._terminal import Text
from dashpot.cli.simulate import seal
from dashpot.io.write import write_trajectory

if TYPE_CHECKING:
    from dashpot.solids.temperature import TemperatureLaw


@click.command("plan")
@click.option("--at", type=Quantity("frequency"), required=True, help="Frequency that matters.")
@click.option("--depth", type=Quantity("length"), default="8mm", show_default=True)
@click.option("--ramp", type=Quantity("time"), default="1s", show_default=True)
@click.option("--hold", type=Quantity("time"), default="40s", show_default=True)
@click.option("--rate", type=Quantity("frequency"), default="1kHz", show_default=True)
@click.option(
    "--noise", type=Quantity("force"), default="5mN", show_default=True, help="Per sample, one SD."
)
@click.option("--method", type=click.Choice(["full", "hold"]), default="full", show_default=True)
@click.option(
    "--model", metavar="paper|broad|hidden|FIT", help="A guess at the seal; else Table 1."
)
@click.option("--arm-stiffness", type=Quantity("stiffness"), help="Of the arm that may hide.")
@click.option("--arm-time", type=Quantity("time"), help="Its relaxation time; else 1/omega.")
@click.option(
    "--baseline", type=Quantity("time"), default="1s", show_default=True, help="Before the ramp."
)
@click.option("--sync", type=Quantity("time"), help="Doubt of the clocks, e.g. 0.5ms.")
@click.option("--drift", type=Quantity("force rate"), help="Of the load cell, e.g. 0.2mN/s.")
@click.option("--mass", type=Quantity("mass"), help="Block; else what peaks at the frequency.")
@options.seals
@click.option("--record", type=Quantity("time"), help="Planned record after a hit.")
@click.option("--pulse", type=Quantity("time"), help="Hammer pulse; soft tips give 10 to 20 ms.")
@click.option("--hits", type=click.IntRange(1), default=5, show_default=True)
@click.option("--coherence", type=float, default=0.99, show_default=True, help="Of those hits.")
@click.option("--wanted", type=float, default=10.0, show_default=True, help="SD that would do, %.")
@click.option(
    "--cold",
    type=Quantity("temperature"),
    multiple=True,
    help="Repeated there too, e.g. 0degC; repeat it for more.",
)
@click.option(
    "--temperature", type=Quantity("temperature"), help="Of the test; else 23degC or the fit's."
)
@options.wlf
@click.option(
    "--setpoints",
    type=Output((".csv", ".txt")),
    metavar="FILE",
    help="Write the planned motion for a controller, one set-point a row; - is stdout.",
)
@click.option("--interval", type=Quantity("time"), default="10ms", show_default=True)
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
    ramp: float,
    hold: float,
    model: str | None,
    arm_stiffness: float | None,
    arm_time: float | None,
    wanted: float,
    wlf: TemperatureLaw | None,
    setpoints: str | None,
    interval: float,
    along: tuple[float, float, float],
    **choices: Any,
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
    guess = seal("paper" if model is None else model)
    found = dp.plan(
        at=at,
        ramp_time=ramp,
        hold_time=hold,
        model=guess.solid,
        arm=arm,
        wanted=wanted / 100,
        law=wlf or guess.law,
        **choices,
    )
    if setpoints is not None:
        motion = dp.planned_trajectory(
            depth=choices["depth"],
            ramp_time=ramp,
            hold_time=hold,
            baseline=choices["baseline"],
            interval=interval,
            along=along,
        )
        count = byline(f"planned test, {len(motion.time)} set-points")
        timed = f"rest {choices['baseline']:g} s, ramp {ramp:g} s, hold {hold:g} s"
        says = (count, f"{timed}; one each {interval:g} s, the first where the plate touches")
        write(setpoints, write_trajectory(motion, comments=says))
    rehearsed = typed(
        "simulate", "relaxation", *given("ramp", "hold"), "-o", "rehearsal.csv", why="rehearses it"
    )
    made = verdict(found.checks)
    return Outcome(found, Text([str(found)]), found.checks, verdict=made, follow=rehearsed)
