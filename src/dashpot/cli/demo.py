"""dashpot demo: the paper's whole method on two simulated seals."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import dashpot as dp
from dashpot import workflow
from dashpot.base.progress import doing
from dashpot.cli import _options as options
from dashpot.cli import _text
from dashpot.cli._shell import Folder, Outcome, claim, reports, typed, write
from dashpot.cli._terminal import Text
from dashpot.cli.simulate import impact, relaxation, seal

if TYPE_CHECKING:
    from dashpot.workflow.study import Study

SEALS = 2
NAMES = ("paper", "broad")
FILES = (
    "_relaxation.csv", "_relaxation.truth.json", "_impact.csv", "_impact.truth.json", ".html",
)  # fmt: skip
"""What is written of each seal."""


@click.command("demo")
@click.option(
    "-o", "--output", type=Folder(), metavar="DIR", default="dashpot-demo", show_default=True
)
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="Of the noise.")
@options.force
@reports
def command(*, output: str, seed: int) -> Outcome:
    """Simulate the bench and hammer tests of two seals and run the main job on each.

    The 'paper' seal is the paper's Table 1 and nothing else. The 'broad' seal relaxes alike, but
    has three faster arms that a 1 s ramp cannot see and that a hammer feels: the paper's puzzle
    (frequency right, damping too low), explained and mended by the joint fit.

    \b
    dashpot demo
    dashpot demo -o somewhere --seed 7
    """
    folder = Path(output)
    claim(folder / f"{name}{file}" for name in NAMES for file in FILES)
    stories = {name: _story(name, folder, seed) for name in NAMES}
    lines, details = [], []
    for name, story in stories.items():
        judged, whole = story.verdict, _text.study(story)
        lines += [f"{name} seal: {judged.use}: {judged.says}"]
        if story.comparison is not None:
            lines += [*_text.comparison(story.comparison, story.joint_comparison), ""]
        details += ["", f"{name} seal", *whole.lines, *whole.details]
    document = {
        "schema": "dashpot/demo@1",
        "seed": seed,
        "seals": {name: _numbers(story, folder, name) for name, story in stories.items()},
    }
    follow = typed("example", why="two files to try by hand")
    return Outcome(document, Text(lines, details), follow=follow)


def _story(name: str, folder: Path, seed: int) -> Study:
    """Simulate, write, read back, characterise and report one seal."""
    doing(f"the {name} seal: simulating the bench and the hammer")
    bench = relaxation(model=name, seed=seed)
    hammer = impact(model=name, seals=SEALS, seed=seed)
    for file, text in zip(FILES, (*bench, *hammer), strict=False):
        write(folder / f"{name}{file}", text)
    hits = dp.read_impact(folder / f"{name}_impact.csv")
    mass = seal(name).mass
    story = dp.characterise(
        dp.read_relaxation(folder / f"{name}_relaxation.csv"),
        dp.estimate_frf(hits, mass=mass),
        impact=hits,
        mass=mass,
        seals=SEALS,
    )
    write(folder / f"{name}.html", dp.report.html(story))
    return story


def _numbers(story: Study, folder: Path, name: str) -> dict[str, Any]:
    return {
        "report": str(folder / f"{name}.html"),
        "fit": workflow.document(story.fit),
        "comparison": None if story.comparison is None else _agreement(story.comparison),
        "joint_comparison": (
            None if story.joint_comparison is None else _agreement(story.joint_comparison)
        ),
    }


def _agreement(comparison: Any) -> dict[str, Any]:
    """Return a comparison's document without its two FRFs, line by line."""
    whole = workflow.document(comparison)
    return {key: value for key, value in whole.items() if key not in {"predicted", "measured"}}
