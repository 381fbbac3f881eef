"""dashpot simulate: the virtual rig and the virtual hammer."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

import dashpot as dp
from dashpot.base.errors import DataError
from dashpot.cli import _options as options
from dashpot.cli._options import Quantity
from dashpot.cli._shell import Outcome, claim, read_model, reports, typed, write
from dashpot.cli._terminal import Text

if TYPE_CHECKING:
    from dashpot.solids.temperature import TemperatureLaw


@click.command("simulate")
@click.argument("what", type=click.Choice(["relaxation", "creep", "impact"]))
@click.option(
    "--model",
    default="paper",
    show_default=True,
    metavar="paper|broad|hidden|FIT",
    help="The true seal: the paper's Table 1, with three faster arms, with one, or a fit's JSON.",
)
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="Of the noise.")
@click.option("--noise-free", is_flag=True, help="No noise, drift, bias, hum or quantum.")
@click.option("--depth", type=Quantity("length"), default="8mm", show_default=True)
@click.option("--load", type=Quantity("force"), default="1N", show_default=True, help="Of creep.")
@click.option("--ramp", type=Quantity("time"), default="1s", show_default=True)
@click.option("--hold", type=Quantity("time"), default="40s", show_default=True)
@click.option(
    "--rate", type=Quantity("frequency"), help="Sampling rate; else the instrument's own."
)
@click.option(
    "--temperature", type=Quantity("temperature"), help="Of the test; the file will state it."
)
@options.wlf
@click.option("--mass", type=Quantity("mass"), help="Block mass; else what peaks at 12.71 Hz.")
@click.option("--seals", type=float, default=2.0, show_default=True, help="Seals under the block.")
@click.option("--hits", type=click.IntRange(1), default=5, show_default=True)
@click.option("--record", type=Quantity("time"), help="Record after each hit.")
@options.output("CSV; - is stdout.", ".csv", ".txt", required=True)
@options.force
@reports
def command(*, what: str, output: str, **choices: Any) -> Outcome:
    """Simulate a relaxation, creep or impact test; the truth stands beside it in FILE.truth.json.

    \b
    dashpot simulate relaxation --model paper -o seal_8mm.csv
    dashpot simulate creep --load 1N --ramp 1s --hold 60s -o creep.csv
    dashpot simulate impact --model broad --hits 5 -o hammer.csv
    dashpot simulate relaxation --model broad --temperature 0degC -o cold.csv
    """
    tests: dict[str, Any] = {"relaxation": relaxation, "creep": creep, "impact": impact}
    made = tests[what]
    document = {"schema": "dashpot/simulated@1", "what": what, "file": output, "truth": None}
    if output == "-":
        text, _ = made(**choices)
        write(output, text)
        return Outcome(document | {"text": text}, None)
    beside = str(Path(output).with_suffix(".truth.json"))
    claim([output, beside])
    text, truth = made(**choices)
    write(output, text)
    write(beside, truth)
    story = Text([f"{output}: a simulated {what} test; what is true stands in {beside}"])
    return Outcome(document | {"truth": beside}, story, follow=typed("inspect", output))


class Seal(NamedTuple):
    """A seal to simulate: its solid, the block on two of them, how it follows temperature."""

    solid: dp.GeneralizedMaxwell
    mass: float | None
    law: TemperatureLaw


def seal(name: str) -> Seal:
    """Return a demonstration seal, or that of a fit's JSON file."""
    from dashpot.solids.table_1 import SEALS, SHIFT

    if name in SEALS:
        return Seal(*SEALS[name], SHIFT)
    solid, law = read_model(name)
    return Seal(solid, None, law or SHIFT)


def relaxation(
    *,
    model: str,
    depth: float = 8e-3,
    ramp: float = 1.0,
    hold: float = 40.0,
    rate: float | None = None,
    noise_free: bool = False,
    seed: int = 0,
    temperature: float | None = None,
    wlf: TemperatureLaw | None = None,
    **_: object,
) -> tuple[str, str]:
    """Return a simulated relaxation test as CSV, and its truth as JSON."""
    from dashpot.io.write import write_relaxation

    room = dp.simulation
    rig = _chosen(room.Rig(), noise_free=noise_free, rate=rate)
    known = seal(model)
    made = room.simulate_relaxation(
        known.solid, depth=depth, ramp_time=ramp, hold_time=hold, rig=rig, seed=seed,
        climate=_climate(known, temperature, wlf),
    )  # fmt: skip
    return write_relaxation(made.test, comments=room.stamp(made.truth)), room.truth_json(made.truth)


def creep(
    *,
    model: str,
    load: float = 1.0,
    ramp: float = 1.0,
    hold: float = 40.0,
    rate: float | None = None,
    noise_free: bool = False,
    seed: int = 0,
    temperature: float | None = None,
    wlf: TemperatureLaw | None = None,
    **_: object,
) -> tuple[str, str]:
    """Return a simulated creep test as CSV, and its truth as JSON."""
    from dashpot.io.write import write_relaxation

    room = dp.simulation
    known = seal(model)
    made = room.simulate_creep(
        known.solid, load=load, ramp_time=ramp, hold_time=hold, seed=seed,
        rig=_chosen(room.Rig(), noise_free=noise_free, rate=rate),
        climate=_climate(known, temperature, wlf),
    )  # fmt: skip
    comments = (*room.stamp(made.truth), "creep test: the force is held")
    return write_relaxation(made.test, comments=comments), room.truth_json(made.truth)


def impact(
    *,
    model: str,
    mass: float | None = None,
    seals: float = 2.0,
    hits: int = 5,
    record: float | None = None,
    rate: float | None = None,
    noise_free: bool = False,
    seed: int = 0,
    temperature: float | None = None,
    wlf: TemperatureLaw | None = None,
    **_: object,
) -> tuple[str, str]:
    """Return a simulated hammer test as CSV, and its truth as JSON."""
    from dashpot.io.write import temperature_line, write_impact

    known = seal(model)
    block = mass if mass is not None else known.mass
    if block is None:
        raise DataError(f"the mass under the hammer is not known for {model}; add --mass")
    room = dp.simulation
    rig = _chosen(room.Hammer(), noise_free=noise_free, record=record, rate=rate)
    made = room.simulate_impact(
        known.solid, mass=block, seals=seals, hits=hits, rig=rig, seed=seed,
        climate=_climate(known, temperature, wlf),
    )  # fmt: skip
    stated = () if temperature is None else (temperature_line(temperature),)
    comments = (*room.stamp(made.truth), *stated)
    return write_impact(made.test, comments=comments), room.truth_json(made.truth)


def _climate(known: Seal, temperature: float | None, law: TemperatureLaw | None) -> Any:
    """Return where the test is made, by the seal's own law unless another is given."""
    if temperature is None:
        if law is not None:
            raise DataError("--wlf needs the temperature of the test: add --temperature 0degC")
        return None
    return dp.simulation.Climate(temperature, law or known.law)


def _chosen(instrument: Any, *, noise_free: bool, **given: float | None) -> Any:
    """Return an instrument with what the user said of it."""
    stated = {name: value for name, value in given.items() if value is not None}
    chosen = replace(instrument, **stated)
    return chosen.noise_free() if noise_free else chosen
