"""Handler of ``dashpot demo --story``: the main job on two seals, and its puzzle solved twice."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import dashpot as dp
from dashpot import workflow
from dashpot.base import dataclass
from dashpot.base.progress import send_progress
from dashpot.base.serialisation import Serialisable
from dashpot.cli._command_files import format_command
from dashpot.cli._command_result import CommandResult, claim_outputs, write_output
from dashpot.cli._simulation_options import (
    load_simulated_seal,
    simulate_impact,
    simulate_relaxation,
)
from dashpot.text_output.layout import Text

if TYPE_CHECKING:
    from dashpot.datamodel.bounds import StiffnessBounds
    from dashpot.workflow.study import Study


SEALS = 2
NAMES = ("paper", "broad")
FILES = (
    "_relaxation.csv", "_relaxation.truth.json", "_impact.csv", "_impact.truth.json", ".html",
)  # fmt: skip
"""Files of each seal."""
PUZZLE = "broad"
"""The seal that a warm test and a hammer find to be two."""
COLD = ("_cold.csv", "_cold.truth.json")
"""Files of that seal in a refrigerator."""
ROOM_TEMPERATURE, COLD_TEMPERATURE = 296.15, 273.15
"""Temperatures of its two tests, K."""
COLD_HOLD = 20.0
"""Hold of the cold test, s: its arms relax in a tenth of that."""


@dataclass(frozen=True)
class Demo(Serialisable):
    """Result of the demonstration: the seed of the noise, and the results of each seal."""

    schema = "dashpot/demo@1"

    seed: int
    seals: dict[str, dict[str, Any]]


def run(folder: Path, seed: int) -> CommandResult:
    """Simulate the bench and hammer tests of two seals and run the main job on each."""
    from dashpot.text_output import results

    claim_outputs(folder / f"{name}{file}" for name in NAMES for file in _list_files(name))
    stories = {name: _run_story(name, folder, seed) for name in NAMES}
    lines, details = [], []
    for name, story in stories.items():
        verdict, study_verdict_and_document = story.verdict, results.render_study(story)
        lines += [f"{name} seal. {verdict}"]
        if story.comparison is not None:
            lines += [*results.format_comparison(story.comparison, story.joint_comparison), ""]
        details += [
            "",
            f"{name} seal",
            *study_verdict_and_document.lines,
            *study_verdict_and_document.details,
        ]
    seals = {name: _list_numbers(story, folder, name) for name, story in stories.items()}
    puzzle = stories[PUZZLE]
    if puzzle.measured is not None:
        fit, cold, bound = _fit_both_temperatures(folder, seed, puzzle.measured)
        lines += [
            f"{PUZZLE} seal at 23 and 0 degC, without the hammer: {fit.verdict.use}",
            *results.format_comparison(cold),
            _compare_loss_factors(fit, bound, puzzle.joint),
        ]
        seals[PUZZLE]["cold"] = {"fit": fit, "comparison": _summarise_comparison(cold)}
    next_command = format_command("demo", "--files", remark="two files to practise on")
    return CommandResult(Demo(seed, seals), Text(lines, details), next_command=next_command)


def _list_files(name: str) -> tuple[str, ...]:
    return (*FILES, *COLD) if name == PUZZLE else FILES


def _run_story(name: str, folder: Path, seed: int) -> Study:
    """Simulate, write, read back, characterise and report one seal."""
    send_progress(f"the {name} seal: simulating the bench and the hammer")
    bench = simulate_relaxation(
        seal=name, seed=seed, temperature=ROOM_TEMPERATURE if name == PUZZLE else None
    )
    hammer = simulate_impact(seal=name, seals=SEALS, seed=seed)
    for file, text in zip(FILES, (*bench, *hammer), strict=False):
        write_output(folder / f"{name}{file}", text)
    study = dp.report(
        dp.read(folder / f"{name}_relaxation.csv", kind="relaxation"),
        dp.read(folder / f"{name}_impact.csv", kind="impact"),
        mass=load_simulated_seal(name).mass,
        seals=SEALS,
    )
    write_output(folder / f"{name}.html", workflow.html(study))
    return study


def _fit_both_temperatures(
    folder: Path, seed: int, measured: dp.FRF
) -> tuple[dp.Fit, dp.Comparison, StiffnessBounds]:
    """Fit the puzzling seal's tests at both temperatures, and hold them against the hammer."""
    from dashpot.solids.demo_seals import SEALS as KNOWN_SEALS

    send_progress(f"the {PUZZLE} seal at 0 degC")
    test = simulate_relaxation(
        seal=PUZZLE, seed=seed + 1, temperature=COLD_TEMPERATURE, hold=COLD_HOLD
    )
    for file, text in zip(COLD, test, strict=True):
        write_output(folder / f"{PUZZLE}{file}", text)
    warm_test, cold = (
        dp.read(folder / f"{PUZZLE}{file}", kind="relaxation").prepare()
        for file in (FILES[0], COLD[0])
    )
    fit = dp.fit(warm_test, cold)
    comparison = dp.compare(fit, measured, mass=KNOWN_SEALS[PUZZLE][1], seals=SEALS).comparison
    return (
        fit,
        comparison,
        workflow.unresolved_arm_band(fit, (warm_test, cold), [comparison.measured_hz]),
    )


def _compare_loss_factors(fit: dp.Fit, bounds: StiffnessBounds, joint_fit: dp.Fit | None) -> str:
    """Return the loss factor at a frequency, its bound, and that of bench and hammer together."""
    frequency = float(bounds.frequency[0])
    low, high = (float(limit[0]) for limit in bounds.loss_factor)
    value, *other = (
        float(item.model.loss_factor(omega=2 * math.pi * frequency))
        for item in (fit, joint_fit)
        if item is not None
    )
    text = (
        f"  loss factor at {frequency:.4g} Hz {value:.4f}, over every rubber {low:.4f} to "
        f"{high:.4f}"
    )
    return f"{text}; with the hammer {other[0]:.4f}" if other else text


def _list_numbers(study: Study, folder: Path, name: str) -> dict[str, Any]:
    return {
        "report": str(folder / f"{name}.html"),
        "fit": study.fit,
        "comparison": None if study.comparison is None else _summarise_comparison(study.comparison),
        "joint_comparison": (
            None
            if study.joint_comparison is None
            else _summarise_comparison(study.joint_comparison)
        ),
    }


def _summarise_comparison(comparison: dp.Comparison) -> dict[str, Any]:
    """Return a comparison's document without its two FRFs, line by line."""
    items = comparison.to_dict().items()
    return {key: value for key, value in items if key not in {"predicted", "measured"}}
