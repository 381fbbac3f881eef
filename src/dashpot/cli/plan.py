"""dashpot plan: what a test can and cannot tell, before it is run."""

from __future__ import annotations

import click

from dashpot.cli._shell import Outcome, Quantity, failed, reports


@click.command("plan", short_help="What a test can and cannot tell, before it is run.")
@click.option("--at", type=Quantity("frequency"), required=True, help="Frequency that matters.")
@click.option("--depth", type=Quantity("length"), default="8mm", show_default=True)
@click.option("--ramp", type=Quantity("time"), default="1s", show_default=True)
@click.option("--hold", type=Quantity("time"), default="40s", show_default=True)
@click.option("--rate", type=Quantity("frequency"), default="1kHz", show_default=True)
@click.option(
    "--noise", type=Quantity("force"), default="5mN", show_default=True, help="Per sample, one SD."
)
@click.option("--method", type=click.Choice(["full", "hold"]), default="full", show_default=True)
@click.option("--model", metavar="paper|broad|FIT", help="A guess at the seal; else Table 1.")
@click.option("--arm-stiffness", type=Quantity("stiffness"), help="Of the arm that may hide.")
@click.option("--arm-time", type=Quantity("time"), help="Its relaxation time; else 1/omega.")
@click.option("--drift", is_flag=True, help="Offset and drift of the force are fitted too.")
@click.option("--mass", type=Quantity("mass"), help="Block; else what peaks at the frequency.")
@click.option("--seals", type=float, default=1.0, show_default=True, help="Seals in parallel.")
@click.option("--record", type=Quantity("time"), help="Planned record after a hit.")
@click.option("--pulse", type=Quantity("time"), help="Hammer pulse; soft tips give 10 to 20 ms.")
@click.option("--hits", type=click.IntRange(1), default=5, show_default=True)
@click.option("--coherence", type=float, default=0.99, show_default=True, help="Of those hits.")
@click.option("--wanted", type=float, default=10.0, show_default=True, help="SD that would do, %.")
@reports
def command(
    *,
    at: float,
    depth: float,
    ramp: float,
    hold: float,
    rate: float,
    noise: float,
    method: str,
    model: str | None,
    arm_stiffness: float | None,
    arm_time: float | None,
    drift: bool,
    mass: float | None,
    seals: float,
    record: float | None,
    pulse: float | None,
    hits: int,
    coherence: float,
    wanted: float,
) -> Outcome:
    """Tell how well a planned test will know stiffness and loss factor at a frequency.

    \b
    dashpot plan --ramp 1s --hold 40s --at 12.71Hz
    dashpot plan --ramp 0.1s --at 12.71Hz --noise 1mN --record 8s --pulse 15ms
    """
    import math

    from dashpot.base.errors import DataError
    from dashpot.cli._virtual import seal
    from dashpot.planning.plan import plan
    from dashpot.workflow.archive import document

    if arm_time is not None and arm_stiffness is None:
        raise DataError("--arm-time needs --arm-stiffness, e.g. --arm-stiffness 0.05N/mm")
    arm = None
    if arm_stiffness is not None:
        arm = (arm_stiffness, arm_time if arm_time is not None else 1 / (2 * math.pi * at))
    found = plan(
        depth=depth,
        ramp_time=ramp,
        hold_time=hold,
        rate=rate,
        noise=noise,
        at=at,
        model=None if model is None else seal(model)[0],
        method=method,
        arm=arm,
        drift=drift,
        mass=mass,
        seals=seals,
        record=record,
        pulse=pulse,
        wanted=wanted / 100,
        hits=hits,
        coherence=coherence,
    )
    text = "\n".join([str(found), *failed(found.checks)])
    return Outcome(lambda: document(found), text, found.checks)
