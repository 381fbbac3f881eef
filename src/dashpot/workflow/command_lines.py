"""A job as the command that is typed for it, so that what a page shows can be repeated."""

from __future__ import annotations

import shlex
from dataclasses import fields, replace
from pathlib import Path

from dashpot.base.options import words_of
from dashpot.io.options import OF_HAMMER, ReadOptions
from dashpot.records.frf import FRF
from dashpot.workflow.job import Job, LevelJob, ModesJob, with_paths

FIT = "fit.json"
"""What the solid is called that one command writes and the next reads."""
IMPACT_PROFILE = "hammer.toml"
"""What the answers for the impact files are called, where options cannot give them."""


def line(command: str, job: Job | LevelJob | ModesJob) -> str:
    """Return ``dashpot command ...`` for a job: run where its files are, it gives its numbers.

    >>> line("fit", Job("tests/seal.csv", arms=2, temperatures=(296.15,)))
    'dashpot fit seal.csv --arms 2 --temperature 23degC'
    """
    files: list[str] = []
    named = with_paths(job, lambda path: Path(path).name)
    for one in fields(named):
        if "argument" in one.metadata:
            value = getattr(named, one.name)
            files += [value] if isinstance(value, str) else value
    further: list[str] = []
    if isinstance(named, Job):
        further = _of_impact(named)
        named = replace(named, reading_impact=ReadOptions())
    return shlex.join(["dashpot", command, *files, *words_of(named), *further])


def predict_command(job: Job, frf: FRF, fit: str = FIT) -> str:
    """Return ``dashpot predict ... --base`` for the mass of a job on the solid in the file `fit`.

    It gives the lines of `frf`, a transmissibility, evenly spaced.
    """
    asked = replace(job, band=(float(frf.frequency[0]), float(frf.frequency[-1])))
    said = words_of(asked, "mass", "seal_mass", "seals", "compression", "band")
    return shlex.join(["dashpot", "predict", fit, *said, "--base"])


def _of_impact(job: Job) -> list[str]:
    """What the impact files are read by: options of this command where it has them for these."""
    known = job.reading_impact.only(("units", *OF_HAMMER))
    shared = known.units in {(), job.reading.units}
    if known == job.reading_impact and shared:
        return words_of(known.only(OF_HAMMER))
    return ["--impact-profile", IMPACT_PROFILE]
