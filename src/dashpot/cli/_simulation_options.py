"""Options of simulated tests, shared by ``simulate``, ``demo``, ``plan`` and ``record``."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import dashpot as dp
from dashpot.base.errors import DataError, ReadError
from dashpot.cli._command_files import read_model
from dashpot.cli._param_types import format_suggestion
from dashpot.registry import list_names, require_handler

if TYPE_CHECKING:
    from dashpot.solids.shift_laws import TemperatureLaw


class SimulatedSeal(NamedTuple):
    """Simulated seal: its solid, the block on two of them, and its temperature law."""

    solid: dp.GeneralizedMaxwell
    mass: float | None
    law: TemperatureLaw


def load_simulated_seal(name: str) -> SimulatedSeal:
    """Return a demonstration seal, or that of a fit's JSON file."""
    from dashpot.solids.demo_seals import SEALS, SHIFT

    if name in SEALS:
        return SimulatedSeal(*SEALS[name], SHIFT)
    if not Path(name).exists() and not Path(name).suffix:
        raise ReadError(
            f"--seal: there is no seal and no file '{name}'. {format_suggestion(name, SEALS)}"
        )
    solid, law = read_model(name)
    return SimulatedSeal(solid, None, law or SHIFT)


def simulate_relaxation(
    *, seal: str, depth: float = 8e-3, ramp: float = 1.0, hold: float = 40.0, **choices: Any
) -> tuple[Any, ...]:
    """Return a simulated relaxation test as CSV, its truth as JSON, and files of extensions."""
    simulated_seal, rig, climate = _build_bench(seal, choices)
    record = dp.simulation.simulate_relaxation(
        simulated_seal.solid, depth=depth, ramp_time=ramp, hold_time=hold, rig=rig, climate=climate,
        seed=choices.get("seed", 0),
    )  # fmt: skip
    return _serialise_record(record, choices)


def simulate_trajectory(*, seal: str, follow: str, **choices: Any) -> tuple[Any, ...]:
    """Return the record of a motion as CSV, its truth as JSON, and files of extensions."""
    simulated_seal, rig, climate = _build_bench(seal, choices)
    with explain_unclear_file(follow):
        commanded_motion = dp.files.read_trajectory(follow)
    motion = dp.simulation.simulate_motion(
        simulated_seal.solid,
        commanded_motion,
        rig=rig,
        climate=climate,
        seed=choices.get("seed", 0),
    )
    return _serialise_record(motion, choices)


@contextmanager
def explain_unclear_file(path: str) -> Iterator[None]:
    """Context manager that adds the required header to the error of an unclear file."""
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


def _build_bench(seal: str, choices: dict[str, Any]) -> tuple[SimulatedSeal, Any, Any]:
    """Return the seal, the rig and its climate that were requested."""
    options = {name: choices.get(name) for name in ("rate", "softening", "warming")}
    simulated_seal, rig, climate = _build_instrument(dp.simulation.Rig(), seal, choices, options)
    if choices.get("friction"):
        rig = replace(rig, axis=replace(rig.axis, friction=choices["friction"]))
    return simulated_seal, rig, climate


def _serialise_record(record: Any, choices: dict[str, Any]) -> tuple[Any, ...]:
    """Return record and ground truth as text, and the requested additions of extensions."""
    option = next((name for name in list_names("simulated record") if choices.get(name)), None)
    if option is not None:
        texts: tuple[Any, ...] = require_handler("simulated record", option)(record, choices)
        return texts
    from dashpot.reading.write import write_relaxation

    text = write_relaxation(record.test, comments=dp.simulation.stamp(record.truth))
    return text, dp.simulation.truth_json(record.truth)


def simulate_creep(
    *, seal: str, load: float = 1.0, ramp: float = 1.0, hold: float = 40.0, **choices: Any
) -> tuple[str, str]:
    """Return a simulated creep test as CSV, and its truth as JSON."""
    from dashpot.reading.write import write_relaxation

    simulated_seal, rig, climate = _build_bench(seal, choices)
    module = dp.simulation
    record = module.simulate_creep(
        simulated_seal.solid, load=load, ramp_time=ramp, hold_time=hold, rig=rig, climate=climate,
        seed=choices.get("seed", 0),
    )  # fmt: skip
    comments = (*module.stamp(record.truth), "creep test: the force is held")
    return write_relaxation(record.test, comments=comments), module.truth_json(record.truth)


def simulate_impact(
    *, seal: str, mass: float | None = None, seals: float = 2.0, hits: int = 5, **choices: Any
) -> tuple[str, str]:
    """Return a simulated hammer test as CSV, and its truth as JSON."""
    from dashpot.reading.write import temperature_line, write_impact

    module = dp.simulation
    options = {"record": choices.get("hit_length"), "rate": choices.get("rate")}
    simulated_seal, rig, climate = _build_instrument(module.Hammer(), seal, choices, options)
    test_mass = mass if mass is not None else simulated_seal.mass
    if test_mass is None:
        raise DataError(f"the mass under the hammer is not known for {seal}; add --mass")
    record = module.simulate_impact(
        simulated_seal.solid, mass=test_mass, seals=seals, hits=hits, rig=rig, climate=climate,
        seed=choices.get("seed", 0),
    )  # fmt: skip
    kelvin = choices.get("temperature")
    header_lines = () if kelvin is None else (temperature_line(kelvin),)
    comments = (*module.stamp(record.truth), *header_lines)
    return write_impact(record.test, comments=comments), module.truth_json(record.truth)


def _build_instrument(
    instrument: Any, seal: str, choices: dict[str, Any], options: dict[str, Any]
) -> tuple[SimulatedSeal, Any, Any]:
    """Return the seal, the instrument with the stated properties, and the climate."""
    simulated_seal = load_simulated_seal(seal)
    settings = {name: value for name, value in options.items() if value is not None}
    # what was asked for by name is there in any case
    base_instrument = instrument.noise_free() if choices.get("noise_free") else instrument
    climate = _build_climate(simulated_seal, choices.get("temperature"), choices.get("wlf"))
    return simulated_seal, replace(base_instrument, **settings), climate


def _build_climate(
    seal: SimulatedSeal, temperature: float | None, law: TemperatureLaw | None
) -> Any:
    """Return the climate of the test, with the seal's own law unless another is given."""
    if temperature is None:
        if law is not None:
            raise DataError("--wlf needs the temperature of the test: add --temperature 0degC")
        return None
    return dp.simulation.Climate(temperature, law or seal.law)
