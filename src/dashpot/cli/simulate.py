"""dashpot simulate: the virtual rig and the virtual hammer."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

import dashpot as dp
from dashpot.base.choices import Rehearsed, words
from dashpot.base.documents import Documented
from dashpot.base.errors import DataError, ReadError
from dashpot.cli import _options as options
from dashpot.cli._options import WithUnit
from dashpot.cli._shell import File, Outcome, claim, read_model, reports, typed, write
from dashpot.cli._terminal import Text

if TYPE_CHECKING:
    from dashpot.solids.temperature import TemperatureLaw


@dataclass(frozen=True)
class Simulated(Documented):
    """What was simulated, its file, that of the truth, or its text where there are none."""

    schema = "dashpot/simulated@1"
    keys = ("what", "file", "truth", "text?")

    what: str
    file: str
    truth: str | None
    text: str | None = None


@click.command("simulate")
@click.argument("what", type=click.Choice(words(Rehearsed)))
@click.option(
    "--model",
    default="paper",
    show_default=True,
    metavar="paper|broad|hidden|FIT",
    help="The true seal: the paper's Table 1, with three faster arms, with one, or a fit's JSON.",
)
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="Of the noise.")
@click.option("--noise-free", is_flag=True, help="No noise, drift, bias, hum or quantum.")
@click.option("--depth", type=WithUnit("length"), default="8mm", show_default=True)
@click.option("--load", type=WithUnit("force"), default="1N", show_default=True, help="Of creep.")
@click.option("--ramp", type=WithUnit("time"), default="1s", show_default=True)
@click.option("--hold", type=WithUnit("time"), default="40s", show_default=True)
@click.option(
    "--rate", type=WithUnit("frequency"), help="Sampling rate; else the instrument's own."
)
@click.option(
    "--temperature", type=WithUnit("temperature"), help="Of the test; the file will state it."
)
@options.wlf
@click.option("--mass", type=WithUnit("mass"), help="Block mass; else what peaks at 12.71 Hz.")
@click.option("--seals", type=float, default=2.0, show_default=True, help="Seals under the block.")
@click.option("--hits", type=click.IntRange(1), default=5, show_default=True)
@click.option("--record", type=WithUnit("time"), help="Record after each hit.")
@click.option("--motion", type=File(), help="Recorded or planned: time and displacement.")
@click.option("--softening", type=float, help="Share that Mullins' softening takes, e.g. 0.12.")
@click.option(
    "--warming", type=WithUnit("force"), help="What the load cell's zero moves by in 10 min."
)
@click.option("--friction", type=float, help="Of the axis, in m/s^2: above 0 it sticks and slips.")
@click.option("--gauges", is_flag=True, help="Six gauge voltages; the calibration lies beside.")
@click.option("--misaligned", type=WithUnit("angle"), help="Of the transducer, e.g. 2deg.")
@click.option("--antialias", type=WithUnit("frequency"), help="Corner of the card's filter.")
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
    dashpot simulate relaxation --gauges --misaligned 2deg -o gauges.csv
    dashpot simulate motion --motion ramp.csv --softening 0.12 -o replay.csv
    """
    tests: dict[str, Any] = {
        "relaxation": relaxation, "creep": creep, "impact": impact, "motion": replayed,
    }  # fmt: skip
    made = tests[what]
    _refuse_senseless(what, output, choices)
    if output == "-":
        text, *_ = made(**choices)
        write(output, text)
        return Outcome(Simulated(what, output, None, text), Text())
    beside = str(Path(output).with_suffix(".truth.json"))
    known = str(Path(output).with_suffix(".cal"))
    gauges = [known] if choices["gauges"] else []
    claim([output, beside, *gauges])
    text, truth, *more = made(**choices)
    write(output, text)
    write(beside, truth)
    says = [f"{output}: a simulated {what} test; what is true stands in {beside}"]
    reading = ["inspect", output]
    if more:
        calibration, said = more
        write(known, calibration)
        says += [f"! {one}" for one in said]
        reading = ["fit", output, "--calibration", known]
    story = Text(says)
    return Outcome(Simulated(what, output, beside), story, follow=typed(*reading))


_RIG = ("softening", "warming", "friction", "gauges", "misaligned", "antialias")


def _refuse_senseless(what: str, output: str, choices: dict[str, Any]) -> None:
    """Refuse what the test asked for would not heed."""
    if (what == "motion") != bool(choices["motion"]):
        raise DataError(
            "a motion is replayed by 'dashpot simulate motion --motion FILE', with time and "
            "displacement in FILE"
        )
    for name in _RIG:
        if choices[name] and what not in ("relaxation", "motion"):
            raise DataError(f"--{name} is for a relaxation test or a motion, not for {what}")
    if choices["gauges"] and output == "-":
        raise DataError("the calibration of the gauges lies beside the file; give one with -o")
    for name in ("misaligned", "antialias"):
        if choices[name] and not choices["gauges"]:
            raise DataError(f"--{name} is of the transducer and its card: add --gauges")


class SimulatedSeal(NamedTuple):
    """A seal to simulate: its solid, the block on two of them, how it follows temperature."""

    solid: dp.GeneralizedMaxwell
    mass: float | None
    law: TemperatureLaw


def seal(name: str) -> SimulatedSeal:
    """Return a demonstration seal, or that of a fit's JSON file."""
    from dashpot.solids.table_1 import SEALS, SHIFT

    if name in SEALS:
        return SimulatedSeal(*SEALS[name], SHIFT)
    solid, law = read_model(name)
    return SimulatedSeal(solid, None, law or SHIFT)


def relaxation(
    *, model: str, depth: float = 8e-3, ramp: float = 1.0, hold: float = 40.0, **choices: Any
) -> tuple[Any, ...]:
    """Return a simulated relaxation test as CSV, its truth as JSON, and what gauges add to it."""
    known, rig, climate = _bench(model, choices)
    made = dp.simulation.simulate_relaxation(
        known.solid, depth=depth, ramp_time=ramp, hold_time=hold, rig=rig, climate=climate,
        seed=choices.get("seed", 0),
    )  # fmt: skip
    return _told(made, choices)


def replayed(*, model: str, motion: str, **choices: Any) -> tuple[Any, ...]:
    """Return the record of a motion as CSV, its truth as JSON, and what gauges add to it."""
    known, rig, climate = _bench(model, choices)
    with as_it_stands(motion):
        sent = dp.read_trajectory(motion)
    made = dp.simulation.simulate_motion(
        known.solid, sent, rig=rig, climate=climate, seed=choices.get("seed", 0)
    )
    return _told(made, choices)


@contextmanager
def as_it_stands(path: str) -> Iterator[None]:
    """Say of a file that leaves a question open what answers it, where no option here does."""
    try:
        yield
    except ReadError as error:
        if not Path(path).is_file():
            raise
        raise ReadError(
            f"{path} does not say by itself which column is what, and in which unit: give it a "
            f"header such as 'time [s], displacement [mm], force [N]'; 'dashpot inspect {path}' "
            "says more"
        ) from error


def _bench(model: str, choices: dict[str, Any]) -> tuple[SimulatedSeal, Any, Any]:
    """Return the seal, the rig and its climate that were asked for."""
    given = {name: choices.get(name) for name in ("rate", "softening", "warming")}
    rig = _chosen(dp.simulation.Rig(), noise_free=bool(choices.get("noise_free")), **given)
    if choices.get("friction"):
        rig = replace(rig, axis=replace(rig.axis, friction=choices["friction"]))
    known = seal(model)
    return known, rig, _climate(known, choices.get("temperature"), choices.get("wlf"))


def _told(made: Any, choices: dict[str, Any]) -> tuple[Any, ...]:
    """Return record and truth as text; of gauges the calibration too, and what limits them."""
    from dashpot.io.write import write_gauges, write_relaxation

    room, truth = dp.simulation, made.truth
    if not choices.get("gauges"):
        text = write_relaxation(made.test, comments=room.stamp(truth))
        return text, room.truth_json(truth)
    rig = truth.rig
    chosen = room.Instrument(
        daq=room.Daq(rate=rig.rate, filter=choices.get("antialias") or 0.0),
        misaligned=choices.get("misaligned") or 0.0,
    )
    volts = chosen.read(made.test.time, truth.force, rig=rig, seed=truth.seed)
    text = write_gauges(made.test, volts, comments=room.stamp(truth))
    says = chosen.says(truth.force, rig)
    return (
        text, room.truth_json(truth, instrument=chosen), chosen.transducer.calibration(), says
    )  # fmt: skip


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


def _climate(known: SimulatedSeal, temperature: float | None, law: TemperatureLaw | None) -> Any:
    """Return where the test is made, by the seal's own law unless another is given."""
    if temperature is None:
        if law is not None:
            raise DataError("--wlf needs the temperature of the test: add --temperature 0degC")
        return None
    return dp.simulation.Climate(temperature, law or known.law)


def _chosen(instrument: Any, *, noise_free: bool, **given: float | None) -> Any:
    """Return an instrument with what the user said of it."""
    stated = {name: value for name, value in given.items() if value is not None}
    # what was asked for by name is there in any case
    return replace(instrument.noise_free() if noise_free else instrument, **stated)
