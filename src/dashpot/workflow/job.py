"""The main job as a value: which files, read and treated how; and running it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

from dashpot.base.checks import Check
from dashpot.io.options import ReadOptions
from dashpot.io.read import inspect_file, read_frf, read_impact, read_relaxation
from dashpot.records.frf import FRF
from dashpot.records.impact import ImpactTest
from dashpot.records.specimen import Specimen
from dashpot.vibration.impact.frf_estimation import estimate_frf
from dashpot.vibration.systems.prediction import moving_mass
from dashpot.workflow.study import Study, characterise


@dataclass(frozen=True)
class HammerChoices:
    """How hits are found, judged, windowed and averaged.

    The fields are the arguments of :func:`~dashpot.vibration.impact.frf_estimation.estimate_frf`.
    """

    estimator: str = "H1"
    window: str = "none"
    combine: str = "mean"
    accept: tuple[str, ...] = ()
    reject: tuple[str, ...] = ()
    record: float | None = None
    pretrigger: float | None = None
    polarity: tuple[int, ...] | None = None


@dataclass(frozen=True)
class Job:
    """Everything that decides the result of ``dashpot report``.

    Attributes
    ----------
    relaxation : str
        File of the relaxation test.
    impact : tuple of str
        Files of hits, or one file with an FRF.
    mass, seal_mass : float or None
        Of the block and of one seal, kg.
    seals : float
    arms : int or "auto"
    band : (float, float) or None
        Lines compared, Hz.
    filter : str or None
    joint : bool
    specimen : Specimen
    reading, reading_impact : ReadOptions
        What the user said of the relaxation file and of the impact files.
    hammer : HammerChoices
    """

    relaxation: str
    impact: tuple[str, ...] = ()
    mass: float | None = None
    seal_mass: float | None = None
    seals: float = 1.0
    arms: int | Literal["auto"] = "auto"
    band: tuple[float, float] | None = None
    filter: str | None = None
    joint: bool = True
    specimen: Specimen = field(default_factory=Specimen)
    reading: ReadOptions = field(default_factory=ReadOptions)
    reading_impact: ReadOptions = field(default_factory=ReadOptions)
    hammer: HammerChoices = field(default_factory=HammerChoices)


def run(job: Job) -> Study:
    """Read the files of a job and characterise the seal."""
    test = read_relaxation(job.relaxation, options=job.reading, specimen=job.specimen)
    impact = measured = None
    mass = job.mass
    noted: tuple[Check, ...] = ()
    if mass is not None and job.seal_mass is not None:
        mass, check = moving_mass(mass, seal=job.seal_mass, seals=job.seals)
        noted = (check,)
    if job.impact:
        impact, measured = read_measured(
            job.impact, choices=job.hammer, options=job.reading_impact, mass=mass
        )
    study = characterise(
        test,
        measured,
        impact=impact,
        mass=mass,
        seals=job.seals,
        arms=job.arms,
        band=job.band,
        filter=job.filter,
        joint=job.joint,
    )
    return replace(study, checks=(*study.checks, *noted))


def read_measured(
    paths: Sequence[str | Path],
    *,
    choices: HammerChoices,
    options: ReadOptions,
    mass: float | None = None,
) -> tuple[ImpactTest | None, FRF]:
    """Return the hits that files hold and their FRF, or the FRF that a file holds."""
    if len(paths) == 1 and inspect_file(paths[0], options=options).kind == "frf":
        return None, read_frf(paths[0])
    impact = read_impact(list(paths), options=options)
    return impact, average(impact, choices=choices, mass=mass)


def average(impact: ImpactTest, *, choices: HammerChoices, mass: float | None = None) -> FRF:
    """Return the FRF of an impact test under these choices."""
    return estimate_frf(
        impact,
        estimator=choices.estimator,
        window=choices.window,
        combine=choices.combine,
        accept=choices.accept,
        reject=choices.reject,
        record=choices.record,
        pretrigger=choices.pretrigger,
        polarity=choices.polarity,
        mass=mass,
    )
