"""The main job as a value: which files, read and treated how."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import MISSING, dataclass, fields, replace
from operator import not_
from typing import Any, Literal, TypeVar

from dashpot.base.choices import (
    AmplitudeLawAsked,
    Estimate,
    FamilyAsked,
    Method,
    OverBase,
    PartMode,
    RampLawAsked,
)
from dashpot.base.documents import Documented
from dashpot.base.errors import DataError
from dashpot.base.options import flags_of, like, names_files, option, part
from dashpot.base.units import si_fields
from dashpot.io.options import ReadOptions
from dashpot.records.machine import Machine
from dashpot.records.specimen import Specimen

J = TypeVar("J", bound=Any)


def _signs(typed: Sequence[str]) -> tuple[int, ...] | None:
    return tuple(int(sign) for sign in typed) or None


def _typed_signs(signs: Sequence[int]) -> list[str]:
    return [f"{sign:+d}" for sign in signs]


def known_of_a_test(machine: Machine | None, *, tests: int, add: str) -> None:
    """Refuse what is said of a machine where no relaxation test was made on it.

    Raises
    ------
    DataError
        If the machine is described and `tests` is 0; `add` names what is missing.
    """
    if machine is not None and machine != Machine() and not tests:
        raise DataError(
            f"{flags_of(Machine)} describe the machine of a relaxation test, and there is none "
            f"here: add {add}, or leave them out"
        )


@dataclass(frozen=True)
class HammerChoices:
    """How hits are found, judged, windowed and averaged.

    The fields are the arguments of :func:`~dashpot.vibration.impact.frf_estimation.estimate_frf`,
    and how the mass over a base that moves was measured.
    """

    estimator: Estimate = option("H1", "Where the noise is taken to be.", choices=Estimate)
    window: str = option(
        "none", "none, exponential, or exponential:0.01 (what is left at the end)."
    )
    combine: str = option("mean", "mean, weighted (nulls rocking), or a channel's name.")
    accept: tuple[str, ...] = option((), "Use this hit all the same.", metavar="HIT", multiple=True)
    reject: tuple[str, ...] = option((), "Leave this hit out.", metavar="HIT", multiple=True)
    record: float | None = option(None, "Length of a block around a hit.", unit="time")
    pretrigger: float | None = option(None, "Quiet in it before the hit.", unit="time")
    polarity: tuple[int, ...] | None = option(
        None,
        "Sign of each accelerometer, in order; repeat for each.",
        choices=("+1", "-1"),
        multiple=True,
        parse=_signs,
        typed=_typed_signs,
    )
    motion: OverBase = option(
        "absolute",
        "Of the mass over a base that moves: absolute, or relative to the base.",
        choices=OverBase,
    )


@dataclass(frozen=True)
class Cuts:
    """Where a relaxation test is cut by hand, s on its own clock; found in the record where None.

    The fields are arguments of :func:`~dashpot.preparation.prepare.prepare`.
    """

    onset: float | None = option(None, "First contact on the record's clock.", unit="time")
    ramp_end: float | None = option(None, "End of the ramp on that clock.", unit="time")
    hold_end: float | None = option(None, "End of the hold on that clock.", unit="time")

    def refuse_several(self, tests: int) -> None:
        """Refuse cuts of several tests.

        Raises
        ------
        DataError
            If anything is cut by hand and there is not one test.
        """
        if self != Cuts() and tests != 1:
            raise DataError(
                f"{flags_of(Cuts)} cut one relaxation test, and there are {tests} here: leave "
                "them out, or fit that test alone"
            )


@dataclass(frozen=True)
class Job(Documented):
    """Everything that decides the result of ``dashpot report``.

    Attributes
    ----------
    relaxation : str
        File of the relaxation test.
    further : tuple of str
        Files of further relaxation tests of the same seal, at other temperatures.
    temperatures : tuple of float
        Of the relaxation tests, K: one for all of them, or one for each, in their order.
    impact_temperature : float or None
        Of the seals under the hammer, K; None for that of the solid of the relaxation tests.
    impact : tuple of str
        Files of hits, or one file with an FRF.
    mass, seal_mass : float or None
        Of the block and of one seal, kg.
    seals : float
    arms : int or "auto"
    method : "full" or "hold"
    law : "auto", "linear" or "nonlinear"
    family : "maxwell", "fractional" or "auto"
    cuts : Cuts
        Of the relaxation test, by hand.
    band : (float, float) or None
        Lines compared, Hz.
    filter : str or None
    joint : bool
    compression : float or None
        Of the seals under the mass, m; None for that of its weight.
    specimen : Specimen
    machine : Machine
        What is known of the machine of the relaxation test.
    reading, reading_impact : ReadOptions
        What the user said of the relaxation file and of the impact files.
    hammer : HammerChoices
    title : str
        Of the report; by default the specimen, or the file.
    logo : str or None
        File of an image for its head.
    """

    schema = "dashpot/job@1"

    relaxation: str = option(MISSING, metavar="FILE", argument=True, decides="test")
    impact: tuple[str, ...] = option(
        (), "Hits, or an FRF; repeat for more.", metavar="FILE", multiple=True
    )
    mass: float | None = option(None, "Block mass; inferred, and said so, if missing.", unit="mass")
    seal_mass: float | None = option(
        None, "Of one seal: a third moves along, a sixth couples mass and base.", unit="mass"
    )
    seals: float = option(1.0, "Seals in parallel.")
    arms: int | Literal["auto"] = option(
        "auto", "Maxwell arms.", word="auto", least=0, decides="fit"
    )
    method: Method = option(
        "full",
        "full: the recorded motion, ramp and hold; hold: the paper's eq. 5.",
        choices=Method,
        decides="fit",
    )
    law: RampLawAsked = option(
        "auto",
        "Elastic law of the seal, from the ramp: straight unless the record says otherwise.",
        choices=RampLawAsked,
        decides="fit",
    )
    family: FamilyAsked = option(
        "maxwell",
        "Of the solid: arms, a fractional Zener solid, or the one that the record prefers.",
        choices=FamilyAsked,
        decides="fit",
    )
    cuts: Cuts = part(Cuts, decides="test")
    band: tuple[float, float] | None = option(
        None, "Lines compared, e.g. 5:40Hz.", unit="frequency", ends=True
    )
    filter: str | None = option(
        None, "E.g. lowpass:10Hz; off by default.", metavar="SPEC", decides="test"
    )
    joint: bool = option(
        True, "Leave out the joint fit.", flag="no-joint", is_flag=True, parse=not_
    )
    compression: float | None = option(
        None, "Of the seals under the mass, e.g. 2.6mm.", unit="length", word="weight"
    )
    specimen: Specimen = part(Specimen, decides="test")
    machine: Machine = part(Machine, decides="test")
    reading: ReadOptions = part(ReadOptions, decides="test")
    reading_impact: ReadOptions = part(ReadOptions)
    hammer: HammerChoices = part(HammerChoices)
    title: str = option("", "Of the report [default: the specimen].", metavar="TEXT")
    logo: str | None = option(None, "PNG, JPEG or SVG for its head, up to 100 kB.", metavar="FILE")
    further: tuple[str, ...] = option((), metavar="FILE", argument=True, decides="test")
    temperatures: tuple[float, ...] = option(
        (),
        "Test temperature, e.g. 23degC; once for all files, or for each, in their order.",
        unit="temperature", multiple=True, flag="temperature", decides="test",
    )  # fmt: skip
    impact_temperature: float | None = option(
        None,
        "Of the seals under the hammer, where tests at several temperatures say how they move.",
        unit="temperature",
    )


@dataclass(frozen=True)
class LevelJob:
    """Everything that decides the result of ``dashpot level``.

    The fields are the arguments of :func:`~dashpot.workflow.levels.level_files`.
    """

    files: tuple[str, ...] = option((), metavar="FILE", argument=True)
    levels: tuple[str, ...] = option(
        (),
        "Of each FRF, in order: amplitude of the force, e.g. 0.05N; of a transmissibility that of "
        "the base's acceleration, e.g. 1m/s^2; of hits their peak force, held against them.",
        metavar="FORCE", multiple=True, flag="level",
    )  # fmt: skip
    mass: float | None = like(Job, "mass", help="Under those FRFs, or struck, e.g. 104g.")
    seals: float = like(Job, "seals")
    band: tuple[float, float] | None = like(Job, "band")
    at: tuple[float, ...] = option(
        (),
        "Level at which the resonance of that mass, or of the one struck, is wanted, e.g. 0.2N.",
        unit="force", multiple=True,
    )  # fmt: skip
    motion: OverBase = like(HammerChoices, "motion")
    law: AmplitudeLawAsked = option(
        "auto",
        "Of a sweep or loops: a share of the stiffness is lost, or friction stands beside it; a "
        "spring stiffens.",
        choices=AmplitudeLawAsked,
    )
    options: ReadOptions = part(ReadOptions)


@dataclass(frozen=True)
class LevelChoices:
    """How far a part is moved, and the sweep that tells what this does to it."""

    levels: tuple[str, ...] = option(
        (),
        "Amplitude of the force, e.g. 0.5N; with --base of its acceleration, e.g. 5m/s^2. "
        "Needs --sweep.",
        multiple=True,
        metavar="LEVEL",
        flag="level",
    )
    sweep: str | None = option(
        None,
        "Storage and loss over strain or displacement, or recorded loops: what a level does.",
        metavar="FILE",
    )
    height: float | None = option(
        None, "Of the part, for its strain; of a --disc or --block it is known.", unit="length"
    )
    strain_factor: float | None = option(
        None,
        "Strain of the sweep over X/height of the part: 1 where both are loaded alike, 0.577 for a "
        "part in shear beside a sweep in tension, 1.73 the other way [default: 1, and what the "
        "other would make of it].",
        above=0.0,
    )
    fitted_at: str | None = option(
        None, "Strain at which FIT's own test was made, e.g. 0.1% [default: a vanishing one]."
    )
    resonance_level: str | None = option(
        None, "At which --resonance was measured [default: a vanishing one]."
    )


@dataclass(frozen=True)
class ModesJob:
    """Everything that decides the result of ``dashpot modes``.

    The fields are the arguments of :func:`~dashpot.workflow.measured_modes.modes_files`, and of
    :func:`~dashpot.workflow.under_masses.modes_by_mass` where there are masses.
    """

    files: tuple[str, ...] = option((), metavar="FILE", argument=True)
    band: tuple[float, float] | None = like(
        Job, "band", help="Where to look for modes, e.g. 5:50Hz."
    )
    against: tuple[str, ...] = option(
        (),
        "The same points in another test, whose modes are held against these; repeat for more.",
        metavar="FRF", multiple=True,
    )  # fmt: skip
    masses: tuple[float, ...] = option(
        (),
        "On the seals in each FRF, in order, e.g. 104g: is it one solid that carries them all?",
        unit="mass", multiple=True, flag="mass",
    )  # fmt: skip
    seals: float = like(Job, "seals")
    options: ReadOptions = part(ReadOptions)


@dataclass(frozen=True)
class PartChoices:
    """The geometry of a part of a material whose modulus was fitted, or a resonance that tells it.

    One of the shapes, a factor, or a resonance with its mass.
    """

    disc: str | None = option(None, "Diameter and height of a pad, e.g. 20mm,20mm.")
    block: str | None = option(None, "Length, width and height of a pad, e.g. 30mm,20mm,10mm.")
    bush: str | None = option(None, "Inner and outer diameter and length, e.g. 12mm,30mm,40mm.")
    bulb: str | None = option(
        None, "Outer diameter, wall and length of a hollow seal, e.g. 22mm,2mm,100mm."
    )
    mode: PartMode | None = option(None, "How the shape is loaded.", choices=PartMode)
    lubricated: bool = option(False, "The plates are lubricated, not bonded.", is_flag=True)
    resonance: float | None = option(
        None,
        "Measured peak of one such mass; tells the geometry factor in place of a shape.",
        unit="frequency",
    )
    resonance_mass: float | None = option(None, "On the parts at that peak.", unit="mass")


@dataclass(frozen=True)
class RodChoices:
    """A rod under a mass as a user says it, and how well its test is known."""

    disc: str | None = option(None, "Diameter and length of a round rod, e.g. 20mm,20mm.")
    block: str | None = option(None, "Both widths and length of another, e.g. 30mm,20mm,10mm.")
    lubricated: bool = option(False, "Its ends slide: no shape factor is taken off.", is_flag=True)
    gain_error: float = option(0.01, "Of one sensor over the other, e.g. 1%.", unit="strain")
    phase_error: float = option(
        "1deg", "Between the sensors, e.g. 1deg [default: 1deg].", unit="angle"
    )
    mass_error: float = option(0.01, "Of the mass, e.g. 0.3% where it was weighed.", unit="strain")
    poisson: float | None = option(None, "Poisson's ratio of the rod [default: 0.4995].")

    def __post_init__(self) -> None:
        si_fields(self)
        for name in ("gain_error", "phase_error", "mass_error"):
            value = getattr(self, name)
            if not 0 <= value < 1:
                raise DataError(
                    f"--{name.replace('_', '-')} {value:g}; expected an error from 0 to below 1"
                )


def deciding(job: Job, *what: str) -> Job:
    """Return what of a job decides its ``"test"`` as prepared, or the ``"fit"`` of that."""
    said = [one.name for one in fields(job) if one.metadata.get("decides") in what]
    return Job(**{name: getattr(job, name) for name in said})


def with_paths(job: J, found: Callable[[str], str]) -> J:
    """Return a job with every path in it replaced: those of its parts, then its own."""
    changed: dict[str, Any] = {}
    for one in sorted(fields(job), key=lambda one: "part" not in one.metadata):
        value = getattr(job, one.name)
        if "part" in one.metadata:
            changed[one.name] = with_paths(value, found)
        elif names_files(one) and value:
            changed[one.name] = found(value) if isinstance(value, str) else (*map(found, value),)
    return replace(job, **changed)
