"""Handler of ``dashpot demo --paper``."""

from __future__ import annotations

import json
from pathlib import Path

import dashpot as dp
from dashpot.cli._command_files import format_command
from dashpot.cli._command_result import CommandResult, claim_outputs, write_output
from dashpot.extensions.paper.page import paper_page, paper_pictures
from dashpot.extensions.paper.reproduction import make_paper_records, reproduce
from dashpot.extensions.paper.text import render_reproduction

PAPER_FILES = (
    "paper.csv", "paper_steps.csv", "paper_rig.csv", "paper_rig.truth.json", "paper_hammer.csv",
    "paper_hammer.truth.json", "figure_2.svg", "figure_4.svg", "figure_6.svg", "paper.json",
    "paper.html",
)  # fmt: skip
"""Files of the paper."""


def run(folder: Path, seed: int) -> CommandResult:
    """Make the paper's equations, figures and table again, each beside its statement."""
    claim_outputs(folder / name for name in PAPER_FILES)
    reproduction = reproduce(seed)
    for name, text in make_paper_records(reproduction).items():
        write_output(folder / name, text)
    for name, picture in paper_pictures(reproduction).items():
        write_output(folder / f"{name}.svg", dp.plot.render_figure(picture, "svg"))
    write_output(folder / "paper.json", json.dumps(reproduction.to_dict(), indent=2) + "\n")
    write_output(folder / "paper.html", paper_page(reproduction))
    record = folder / "paper.csv"
    next_command = format_command(
        "fit", record, "--arms", 2, "--method", "hold", remark="the paper's fit, by hand"
    )
    return CommandResult(reproduction, render_reproduction(reproduction), next_command=next_command)
