"""dashpot simulate: the virtual rig and the virtual hammer."""

from __future__ import annotations

from pathlib import Path

import click

from dashpot.cli._shell import Outcome, Quantity, reports, said, write


@click.command("simulate", short_help="The virtual rig and hammer, stamped 'simulated'.")
@click.argument("what", type=click.Choice(["relaxation", "impact"]))
@click.option(
    "--model",
    default="paper",
    show_default=True,
    metavar="paper|broad|FIT",
    help="The true seal: the paper's Table 1, one with faster arms too, or a fit's JSON.",
)
@click.option("--seed", type=int, default=0, show_default=True, help="Of the noise.")
@click.option("--noise-free", is_flag=True, help="No noise, drift, bias, hum or quantum.")
@click.option("--depth", type=Quantity("length"), default="8mm", show_default=True)
@click.option("--ramp", type=Quantity("time"), default="1s", show_default=True)
@click.option("--hold", type=Quantity("time"), default="40s", show_default=True)
@click.option(
    "--rate", type=Quantity("frequency"), help="Sampling rate; else the instrument's own."
)
@click.option("--mass", type=Quantity("mass"), help="Block mass; else what peaks at 12.71 Hz.")
@click.option("--seals", type=float, default=2.0, show_default=True, help="Seals under the block.")
@click.option("--hits", type=click.IntRange(1), default=5, show_default=True)
@click.option("--record", type=Quantity("time"), help="Record after each hit.")
@click.option("-o", "--output", metavar="FILE", required=True, help="CSV; - is stdout.")
@reports
def command(
    *,
    what: str,
    model: str,
    seed: int,
    noise_free: bool,
    depth: float,
    ramp: float,
    hold: float,
    rate: float | None,
    mass: float | None,
    seals: float,
    hits: int,
    record: float | None,
    output: str,
) -> Outcome:
    """Simulate a relaxation or an impact test; the truth stands beside it in FILE.truth.json.

    \b
    dashpot simulate relaxation --model paper -o seal_8mm.csv
    dashpot simulate impact --model broad --hits 5 -o hammer.csv
    """
    from dashpot.cli._virtual import impact, relaxation

    if what == "relaxation":
        text, truth = relaxation(
            model, depth=depth, ramp=ramp, hold=hold, rate=rate, noise_free=noise_free, seed=seed
        )
    else:
        text, truth = impact(
            model,
            mass=mass,
            seals=seals,
            hits=hits,
            record=record,
            rate=rate,
            noise_free=noise_free,
            seed=seed,
        )
    write(output, text)
    beside = None
    if output != "-":
        beside = str(Path(output).with_suffix(".truth.json"))
        Path(beside).write_text(truth, encoding="utf-8")
        said(f"wrote {beside}")
    document = {"schema": "dashpot/simulated@1", "what": what, "file": output, "truth": beside}
    return Outcome(lambda: document, "" if output == "-" else f"{output}: a simulated {what} test")
