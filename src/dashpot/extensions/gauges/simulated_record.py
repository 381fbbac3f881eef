"""A simulated record in the voltages of six gauges, as ``dashpot simulate --gauges`` writes it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dashpot.base.errors import DataError
from dashpot.cli._command import CommandOption, opt
from dashpot.cli._param_types import WithUnit


def list_options() -> list[CommandOption]:
    """Return the options of ``dashpot simulate`` for the transducer and its card."""
    return [
        opt("--gauges", help="Six gauge voltages and their calibration."),
        opt(
            "--misaligned",
            type=WithUnit("angle"),
            metavar="ANGLE",
            help="Misalignment of the transducer, e.g. 2deg.",
        ),
        opt(
            "--antialias",
            type=WithUnit("frequency"),
            metavar="FREQUENCY",
            help="Corner of the card's filter.",
        ),
    ]


def list_calibration_files(output: str, choices: Mapping[str, Any]) -> list[str]:
    """Return the path of the gauge calibration; empty without gauges.

    Raises
    ------
    DataError
        If the record is not written to a file, or gauge options are given for a record without
        gauges.
    """
    if choices["gauges"] and output == "-":
        raise DataError("the calibration of the gauges lies beside the file; give one with -o")
    for name in ("misaligned", "antialias"):
        if choices[name] and not choices["gauges"]:
            raise DataError(f"--{name} is for the transducer and its card. Add --gauges")
    return [str(Path(output).with_suffix(".cal"))] if choices["gauges"] else []


def serialise_record(
    record: Any, choices: Mapping[str, Any]
) -> tuple[str, str, str, tuple[str, ...]]:
    """Return record and truth as text, then the calibration, and limits of the record's use.

    Parameters
    ----------
    record : SimulatedMotion or SimulatedRelaxation
    choices : mapping
        The options of ``dashpot simulate``.
    """
    from dashpot.extensions.gauges.transducer import Daq, Instrument, write_gauges
    from dashpot.simulation.ground_truth import stamp, truth_json

    truth = record.truth
    rig = truth.rig
    instrument = Instrument(
        daq=Daq(rate=rig.rate, filter=choices.get("antialias") or 0.0),
        misaligned=choices.get("misaligned") or 0.0,
    )
    volts = instrument.read(record.test.time, truth.force, rig=rig, seed=truth.seed)
    text = write_gauges(record.test, volts, comments=stamp(truth))
    return (
        text,
        truth_json(truth, instrument=instrument),
        instrument.transducer.calibration(),
        instrument.list_limitations(truth.force, rig),
    )
