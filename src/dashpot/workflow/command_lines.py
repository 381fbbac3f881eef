"""Command lines equivalent to a job."""

from __future__ import annotations

import shlex
from dataclasses import fields, replace
from glob import escape
from pathlib import Path

from dashpot.base.option_fields import words_of
from dashpot.datamodel.frf import FRF
from dashpot.reading.read_options import ReadOptions
from dashpot.workflow.job import Job, LevelJob, ModesJob, with_paths

FIT = "fit.json"
"""What the solid is called that one command writes and the next reads."""


def line(command: str, job: Job | LevelJob | ModesJob) -> str:
    """Return ``dashpot command ...`` for a job: run where its files are, it gives its numbers.

    >>> line("fit", Job("tests/seal.csv", arms=2, temperatures=(296.15,)))
    'dashpot fit seal.csv --arms 2 --temperature 23degC'
    """
    files: list[str] = []
    named = with_paths(job, lambda path: Path(path).name)
    records = [field for field in fields(named) if "argument" in field.metadata]
    for record in sorted(records, key=lambda field: int(field.metadata["argument"])):
        value = getattr(named, record.name)
        files += [value] if isinstance(value, str) else value
    if isinstance(named, Job):
        named = replace(named, reading=_merge_read_options(named), reading_impact=ReadOptions())
    return shlex.join(["dashpot", command, *files, *words_of(named)])


def predict_command(job: Job, frf: FRF, fit: str = FIT) -> str:
    """Return ``dashpot predict ... --base`` for the mass of a job on the solid in the file `fit`.

    It gives the lines of `frf`, a transmissibility, evenly spaced.
    """
    requested_job = replace(job, band=(float(frf.frequency[0]), float(frf.frequency[-1])))
    words = words_of(requested_job, "mass", "seal_mass", "seals", "compression", "band")
    return shlex.join(["dashpot", "predict", fit, *words, "--base"])


def _merge_read_options(job: Job) -> ReadOptions:
    """Return what the files are read by: the units of all of them, and of each what is its own.

    A column or a mark of one file would make the other another kind of test.
    """
    if not job.impact:
        return job.reading
    bench, hammer = job.reading, job.reading_impact
    shared = ("units",) if bench.units == hammer.units else ()
    sides = ((job.relaxation, *job.further), bench), (job.impact, hammer)
    pairs = [
        (escape(path), replace(options, own=()).without(shared))
        for paths, options in sides
        for path in dict.fromkeys(paths)
    ]
    return replace(bench.only(shared), own=(*pairs, *bench.own, *hammer.own))
