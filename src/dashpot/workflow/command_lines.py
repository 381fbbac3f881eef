"""A job as the command that is typed for it, so that what a page shows can be repeated."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Sequence
from dataclasses import fields
from functools import partial
from typing import Any

from dashpot.base.options import flag_of
from dashpot.base.units import typed
from dashpot.io.options import OF_HAMMER, ReadOptions
from dashpot.records.frf import FRF
from dashpot.workflow.job import Job

FIT = "fit.json"
"""What the solid is called that one command writes and the next reads."""
IMPACT_PROFILE = "hammer.toml"
"""What the answers for the impact files are called, where options cannot give them."""


def words_of(noun: Any) -> list[str]:
    """Return the options that say what a noun says, as they are typed; nothing of its defaults.

    The noun declares its options as :func:`~dashpot.base.options.option` does.

    >>> from dashpot.io.options import ReadOptions
    >>> words_of(ReadOptions(units={"force": "N"}, skip_rows=3))
    ['--units', 'force=N', '--skip-rows', '3']
    """
    words = []
    for one in fields(noun):
        value = getattr(noun, one.name)
        if one.metadata and value != one.default:
            for each in _several(one.metadata, value):
                words += [flag_of(one), each]
    return words


def _several(asked: Any, value: Any) -> list[str]:
    """One text for every time that an option is typed."""
    if asked.get("section") == "units":
        return [f"{name}={unit}" for name, unit in value]
    if "multiple" in asked:
        return [f"{each:+d}" if isinstance(each, int) else str(each) for each in value]
    if "unit" in asked:
        return [typed(value, asked["unit"])]
    return [str(value)]


def _range(band: tuple[float, float]) -> str:
    return f"{band[0]!r}:{typed(band[1], 'frequency')}"


def _seals(count: float) -> str:
    return f"{count!r}".removesuffix(".0")


def _flag(name: str) -> str:
    return f"--{name.replace('_', '-')}"


_OF_MASS: dict[str, Callable[[Any], str]] = {
    "mass": partial(typed, dimension="mass"),
    "seal_mass": partial(typed, dimension="mass"),
    "seals": _seals,
    "compression": partial(typed, dimension="length"),
}
"""What a job says of the mass on the seals, as it is typed behind its option."""
_OF_JOB: dict[str, Callable[[Any], str]] = {
    **_OF_MASS, "arms": str, "method": str, "law": str, "family": str, "band": _range,
    "filter": str, "title": str, "logo": str,
    "impact_temperature": partial(typed, dimension="temperature"),
}  # fmt: skip
"""The same of all that has an option of its own."""


def report_command(job: Job) -> str:
    """Return ``dashpot report ...`` for a job: run, it gives the job's numbers."""
    words = ["dashpot", "report", job.relaxation, *job.further]
    for file in job.impact:
        words += ["--impact", file]
    usual = {one.name: one.default for one in fields(Job)}
    for name, word in _OF_JOB.items():
        value = getattr(job, name)
        words += [] if value == usual[name] else [_flag(name), word(value)]
    for kelvin in job.temperatures:
        words += ["--temperature", typed(kelvin, "temperature")]
    words += [] if job.joint else ["--no-joint"]
    for noun in (job.cuts, job.machine, job.specimen, job.hammer, job.reading):
        words += words_of(noun)
    words += _of_impact(job)
    return shlex.join(words)


def fit_command(
    file: str, options: ReadOptions, *, arms: int | str = "auto", temperature: float | None = None
) -> str:
    """Return ``dashpot fit ...`` of one file."""
    words = ["dashpot", "fit", file]
    words += [] if arms == "auto" else ["--arms", str(arms)]
    if temperature is not None:
        words += ["--temperature", typed(temperature, "temperature")]
    return shlex.join([*words, *words_of(options)])


def level_command(
    files: Sequence[str],
    *,
    options: ReadOptions,
    levels: Sequence[str] = (),
    mass: float | None = None,
    seals: float = 1.0,
    at: Sequence[float] = (),
    law: str = "auto",
) -> str:
    """Return ``dashpot level ...`` of a sweep, of loops, or of FRFs at several levels."""
    words = ["dashpot", "level", *files]
    for one in levels:
        words += ["--level", one]
    words += [] if mass is None else ["--mass", typed(mass, "mass")]
    words += [] if seals == 1 else ["--seals", _seals(seals)]
    for force in at:
        words += ["--at", typed(force, "force")]
    words += [] if law == "auto" else ["--law", law]
    return shlex.join([*words, *words_of(options)])


def modes_command(
    files: Sequence[str],
    *,
    options: ReadOptions,
    masses: Sequence[float] = (),
    seals: float = 1.0,
    band: tuple[float, float] | None = None,
) -> str:
    """Return ``dashpot modes ...`` of points of one structure, or of several masses."""
    words = ["dashpot", "modes", *files]
    for mass in masses:
        words += ["--mass", typed(mass, "mass")]
    words += [] if seals == 1 else ["--seals", f"{seals!r}".removesuffix(".0")]
    words += [] if band is None else ["--band", _range(band)]
    return shlex.join([*words, *words_of(options)])


def predict_command(job: Job, frf: FRF, fit: str = FIT) -> str:
    """Return ``dashpot predict ... --base`` for the mass of a job on the solid in the file `fit`.

    It gives the lines of `frf`, a transmissibility, evenly spaced.
    """
    words = ["dashpot", "predict", fit]
    band = float(frf.frequency[0]), float(frf.frequency[-1])
    for name, word in _OF_MASS.items():
        value = getattr(job, name)
        words += [] if value is None else [_flag(name), word(value)]
    return shlex.join([*words, "--band", _range(band), "--base"])


def _of_impact(job: Job) -> list[str]:
    """What the impact files are read by: options of this command where it has them for these."""
    known = job.reading_impact.only(("units", *OF_HAMMER))
    shared = known.units in {(), job.reading.units}
    if known == job.reading_impact and shared:
        return words_of(known.only(OF_HAMMER))
    return ["--impact-profile", IMPACT_PROFILE]
