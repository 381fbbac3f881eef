"""dashpot simulate: a test of a known seal, with the truth beside it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from dashpot.base import dataclass
from dashpot.base.errors import DataError
from dashpot.base.option_fields import Rehearsed, get_choice_values
from dashpot.base.serialisation import Key, Serialisable
from dashpot.cli import _options as options
from dashpot.cli._command import group, mark_advanced, opt, verb
from dashpot.cli._command_files import format_command
from dashpot.cli._command_result import CommandResult, claim_outputs, write_output
from dashpot.cli._param_types import ChoiceWithSuggestion, File, WithUnit
from dashpot.cli._simulation_options import (
    simulate_creep,
    simulate_impact,
    simulate_relaxation,
    simulate_trajectory,
)
from dashpot.registry import call_handler
from dashpot.text_output.layout import Text


@dataclass(frozen=True)
class Simulated(Serialisable):
    """Simulated test, with the files of the test and of its truth, or its text."""

    schema = "dashpot/simulated@1"
    _keys = ("what", "file", "truth", Key("text", optional=True))

    what: str
    file: str
    truth: str | None
    text: str | None = None


_RECORD_OPTIONS = call_handler("options", "simulate", default=())
"""Options of extensions for the record of the rig."""


@verb(
    "simulate",
    """Simulate a test of a known seal; the truth is written beside it.

  dashpot simulate relaxation --depth 8mm -o seal.csv
  dashpot simulate impact --seal broad --mass 104g --hits 5 -o hammer.csv
  dashpot simulate motion --follow ramp.csv -o replay.csv""",
    click.Argument(
        ["what"],
        type=ChoiceWithSuggestion(get_choice_values(Rehearsed)),
        metavar="|".join(get_choice_values(Rehearsed)),
    ),
    group(
        "Test",
        opt(
            "--seal",
            default="paper",
            metavar="NAME|FIT",
            help="paper, broad, hidden, or a fit (paper).",
        ),
        opt(
            "--depth",
            type=WithUnit("length"),
            default="8mm",
            metavar="LENGTH",
            help="Compression (8mm).",
        ),
        opt(
            "--load",
            type=WithUnit("force"),
            default="1N",
            metavar="FORCE",
            help="Load of a creep test (1N).",
        ),
        opt("--ramp", type=WithUnit("time"), default="1s", metavar="TIME", help="Ramp time (1s)."),
        opt(
            "--hold", type=WithUnit("time"), default="40s", metavar="TIME", help="Hold time (40s)."
        ),
        opt(
            "--temperature",
            type=WithUnit("temperature"),
            metavar="TEMPERATURE",
            help="Test temperature; the file states it.",
        ),
        opt(
            "--mass",
            type=WithUnit("mass"),
            metavar="MASS",
            help="Test mass (it peaks at 12.71 Hz).",
        ),
        opt("--seals", type=float, default=2.0, metavar="N", help="Seals under the test mass (2)."),
        opt(
            "--hits",
            type=click.IntRange(1),
            default=5,
            metavar="N",
            help="Number of hammer hits (5).",
        ),
        opt("--hit-length", type=WithUnit("time"), metavar="TIME", help="Record after each hit."),
        opt(
            "--follow", type=File(), metavar="FILE", help="Motion to follow: time and displacement."
        ),
        opt("--seed", type=click.IntRange(0), default=0, metavar="N", help="Seed of noise (0)."),
        mark_advanced(
            opt(
                "--rate",
                type=WithUnit("frequency"),
                metavar="FREQUENCY",
                help="Sampling rate (the instrument's own).",
            ),
            options.wlf_option(),
        ),
    ),
    group(
        "Faults of the rig",
        opt("--noise-free", help="No noise, drift, bias, hum or quantisation."),
        mark_advanced(
            opt("--softening", type=float, metavar="SHARE", help="Mullins softening, e.g. 0.12."),
            opt(
                "--warming",
                type=WithUnit("force"),
                metavar="FORCE",
                help="Zero drift of the load cell in 10 min.",
            ),
            opt("--friction", type=float, metavar="M/S^2", help="Stick-slip of the axis."),
            *_RECORD_OPTIONS,
        ),
    ),
    options.result_options(
        "CSV; - is stdout (required).",
        ".csv",
        ".txt",
        plot=False,
        has_open_option=False,
        required=True,
    ),
)
def command(*, what: str, output: str, **choices: Any) -> CommandResult:
    """Simulate a relaxation, creep or hammer test, or the record of a motion."""
    tests: dict[str, Any] = {
        "relaxation": simulate_relaxation, "creep": simulate_creep,
        "impact": simulate_impact, "motion": simulate_trajectory,
    }  # fmt: skip
    simulate_kind = tests[what]
    _refuse_inapplicable_options(what, choices)
    extra_files = call_handler("files beside", "simulate", output, choices, default=())
    if output == "-":
        text, *_ = simulate_kind(**choices)
        write_output(output, text)
        return CommandResult(Simulated(what, output, None, text), Text())
    truth_file = str(Path(output).with_suffix(".truth.json"))
    claim_outputs([output, truth_file, *extra_files])
    text, truth, *calibration_parts = simulate_kind(**choices)
    write_output(output, text)
    write_output(truth_file, truth)
    message = [f"{output}: a simulated {what} test; what is true stands in {truth_file}"]
    next_words = ["inspect", output]
    if calibration_parts:
        calibration, calibration_notes = calibration_parts
        write_output(extra_files[0], calibration)
        message += [f"! {item}" for item in calibration_notes]
        next_words = ["fit", output, "--calibration", extra_files[0]]
    return CommandResult(
        Simulated(what, output, truth_file), Text(message), next_command=format_command(*next_words)
    )


_RIG_OPTIONS = ("softening", "warming", "friction", *(option.name for option in _RECORD_OPTIONS))


def _refuse_inapplicable_options(test_kind: str, choices: dict[str, Any]) -> None:
    """Refuse options that the requested test does not use."""
    if (test_kind == "motion") != bool(choices["follow"]):
        raise DataError(
            "a motion is replayed by 'dashpot simulate motion --follow FILE', with time and "
            "displacement in FILE"
        )
    for option_name in _RIG_OPTIONS:
        if choices[option_name] and test_kind not in ("relaxation", "motion"):
            raise DataError(
                f"--{option_name} is for a relaxation test or a motion, not for {test_kind}"
            )
