"""Jobs and options of commands: which files are read, and how they are processed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import MISSING, fields, replace
from operator import not_
from typing import Any, Literal, TypeVar

from dashpot.base import dataclass
from dashpot.base.errors import DataError
from dashpot.base.option_fields import (
    AmplitudeLawOption,
    Estimate,
    FamilyOption,
    Method,
    OverBase,
    PartMode,
    RampLawOption,
    ShiftLaw,
    VerticalOption,
    copy_option,
    format_option_flags,
    get_choice_values,
    is_path_field,
    make_nested_options,
    option,
)
from dashpot.base.serialisation import EVERY_FIELD, Serialisable
from dashpot.base.units import si_fields
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.specimen import Specimen
from dashpot.fitting.fit_options import FitOptions, SolidOptions
from dashpot.reading.read_options import ReadOptions

# Main job.


J = TypeVar("J", bound=Any)


def _parse_signs(texts: Sequence[str]) -> tuple[int, ...] | None:
    return tuple(int(sign) for sign in texts) or None


def _format_signs(signs: Sequence[int]) -> list[str]:
    return [f"{sign:+d}" for sign in signs]


def _parse_motion(relative: bool) -> OverBase:
    return "relative" if relative else "absolute"


def require_test_for_machine(machine: Machine | None, *, tests: int, add: str) -> None:
    """Refuse the description of a machine where there is no test made on it.

    Raises
    ------
    DataError
        If the machine is described and `tests` is 0; `add` names what is missing.
    """
    if machine is not None and machine != Machine() and not tests:
        raise DataError(
            f"{format_option_flags(Machine)} describes the machine of a test, and there is none "
            f"here. Add {add}, or leave it out."
        )


@dataclass(frozen=True)
class HammerChoices:
    """Options of a hammer test: detection, judgement, windows and averaging of hits.

    The fields are the arguments of :func:`~dashpot.vibration.impact.frf_estimation.estimate_frf`,
    and how the mass over a base that moves was measured.
    """

    estimator: Estimate = option("H1", "Estimator of the FRF.", choices=Estimate)
    window: str = option("none", "none, exponential, or exponential:0.01.", metavar="NAME")
    combine: str = option("mean", "mean, weighted, or the name of a channel.", metavar="HOW")
    accept: tuple[str, ...] = option((), "Use this hit anyway.", metavar="HIT", multiple=True)
    reject: tuple[str, ...] = option((), "Leave this hit out.", metavar="HIT", multiple=True)
    record: float | None = option(
        None, "Length of the record around a hit.", unit="time", flag="hit-length"
    )
    pretrigger: float | None = option(None, "Quiet time before a hit.", unit="time")
    polarity: tuple[int, ...] | None = option(
        None,
        "Sign of each accelerometer, in order.",
        choices=("+1", "-1"),
        multiple=True,
        parse=_parse_signs,
        unparse=_format_signs,
    )
    motion: OverBase = option(
        "absolute",
        "The motion is relative to the base.",
        flag="relative",
        is_flag=True,
        parse=_parse_motion,
    )


@dataclass(frozen=True)
class TimeLimits:
    """Manual time limits of a relaxation test, s on its own clock; None: detected in the record.

    The fields are arguments of :func:`~dashpot.preprocessing.prepare.prepare`.
    """

    onset: float | None = option(
        None,
        "First contact on the record's clock.",
        unit="time",
        keyed_flag="time-limits",
        hidden_alias="cuts",
    )
    ramp_end: float | None = option(
        None,
        "End of the ramp on that clock.",
        unit="time",
        keyed_flag="time-limits",
        hidden_alias="cuts",
    )
    hold_end: float | None = option(
        None,
        "End of the hold on that clock.",
        unit="time",
        keyed_flag="time-limits",
        hidden_alias="cuts",
    )

    def __post_init__(self) -> None:
        si_fields(self)

    def refuse_several(self, tests: int) -> None:
        """Refuse cuts of several tests.

        Raises
        ------
        DataError
            If anything is cut by hand and there is not one test.
        """
        if self != TimeLimits() and tests != 1:
            raise DataError(
                f"{format_option_flags(TimeLimits)} cuts one relaxation test, and there are "
                f"{tests} here. Leave it out, or fit that test alone."
            )


@dataclass(frozen=True)
class BlockOnSeals:
    """Options of a block on equal seals: masses, number and compression.

    Attributes
    ----------
    mass, seal_mass : float or None
        Mass of the block, to be inferred from an FRF if missing, and of one seal, kg.
    seals : float
        How many carry the block.
    compression : float or None
        Compression of the seals under it, m; None for that of its weight.
    """

    mass: float | None = option(None, "Test mass, e.g. 104g.", unit="mass")
    seals: float = option(1.0, "Seals in parallel.")
    seal_mass: float | None = option(
        None, "Mass of one seal: a third moves with the test mass.", unit="mass"
    )
    compression: float | None = option(
        None, "Compression of the seals under the mass.", unit="length", keyword="weight"
    )

    @property
    def weighed_mass(self) -> float:
        """The mass of the block, kg.

        Raises
        ------
        DataError
            If it is not given.
        """
        if self.mass is None:
            raise DataError("no mass is given: say what rests on the seals, such as 104 g")
        return self.mass


@dataclass(frozen=True)
class Job(Serialisable):
    """Job of ``dashpot report``: all files and options that decide its result.

    Attributes
    ----------
    relaxation : str
        File of the relaxation test.
    other_tests : tuple of str
        Files of further relaxation tests of the same seal, at other temperatures.
    temperatures : tuple of float
        Temperatures of the relaxation tests, K: one for all of them, or one for each, in their
        order.
    impact_temperature : float or None
        Temperature of the seals under the hammer, K; None for that of the solid of the relaxation
        tests.
    impact : tuple of str
        Files of hits, or one file with an FRF.
    mass, seal_mass : float or None
        Masses of the block and of one seal, kg.
    seals : float
    arms : int or "auto"
    method : "full" or "hold"
    law : "auto", "linear" or "nonlinear"
    family : "maxwell", "fractional" or "auto"
    time_limits : TimeLimits
        Time limits of the relaxation test, by hand.
    band : (float, float) or None
        Lines compared, Hz.
    filter : str or None
    joint : bool
    compression : float or None
        Compression of the seals under the mass, m; None for that of its weight.
    specimen : Specimen
    machine : Machine
        What is known of the machine of the relaxation test.
    reading, reading_impact : ReadOptions
        Reading options of the relaxation file and of the impact files.
    hammer : HammerChoices
    title : str
        Title of the report; by default the specimen, or the file.
    logo : str or None
        File of an image for its head.
    """

    schema = "dashpot/job@2"
    _keys = (EVERY_FIELD, "time_limits", "other_tests")

    relaxation: str = option(MISSING, metavar="FILE", argument=1, stage="test")
    impact: tuple[str, ...] = option((), "Hits, or an FRF.", metavar="FILE", argument=3)
    mass: float | None = copy_option(BlockOnSeals, "mass")
    seal_mass: float | None = copy_option(BlockOnSeals, "seal_mass")
    seals: float = copy_option(BlockOnSeals, "seals")
    arms: int | Literal["auto"] = copy_option(SolidOptions, "arms")
    method: Method = copy_option(SolidOptions, "method")
    law: RampLawOption = copy_option(SolidOptions, "law")
    family: FamilyOption = copy_option(SolidOptions, "family")
    time_limits: TimeLimits = make_nested_options(TimeLimits, stage="test")
    band: tuple[float, float] | None = option(
        None, "Frequencies to use, e.g. 5:40Hz.", unit="frequency", is_range=True
    )
    filter: str | None = option(
        None, "Filter the force first, e.g. lowpass:10Hz.", metavar="SPEC", stage="test"
    )
    joint: bool = option(
        True, "Do not fit both tests together.", flag="no-joint", is_flag=True, parse=not_
    )
    compression: float | None = copy_option(BlockOnSeals, "compression")
    specimen: Specimen = make_nested_options(Specimen, stage="test")
    machine: Machine = make_nested_options(Machine, stage="test")
    reading: ReadOptions = make_nested_options(ReadOptions, stage="test")
    reading_impact: ReadOptions = make_nested_options(ReadOptions)
    hammer: HammerChoices = make_nested_options(HammerChoices)
    title: str = option("", "Title (the specimen).", metavar="TEXT")
    logo: str | None = option(None, "PNG, JPEG or SVG, up to 100 kB.", metavar="FILE")
    other_tests: tuple[str, ...] = option((), metavar="FILE", argument=2, stage="test")
    temperatures: tuple[float, ...] = option(
        (),
        "Test temperature: once for all files, or for each.",
        unit="temperature", multiple=True, flag="temperature", stage="test",
    )  # fmt: skip
    impact_temperature: float | None = option(
        None,
        "Temperature of the seals under the hammer.",
        unit="temperature",
        flag="hammer-temperature",
    )

    @property
    def block(self) -> BlockOnSeals:
        """The block on the seals."""
        return BlockOnSeals(self.mass, self.seals, self.seal_mass, self.compression)

    @property
    def fit_options(self) -> FitOptions:
        """Options of the fit of the relaxation tests."""
        return FitOptions(self.arms, self.method, self.law, self.family)


@dataclass(frozen=True)
class LevelJob:
    """Job of ``dashpot fit`` at several amplitudes: all files and options.

    The fields are the arguments of :func:`~dashpot.extensions.amplitude.fit_files.level_files`.
    """

    files: tuple[str, ...] = option((), metavar="FILE", argument=1)
    levels: tuple[str, ...] = option(
        (), "Amplitude of each FRF, in order: 0.02N or 1m/s^2.",
        metavar="AMPLITUDE", multiple=True, flag="amplitude", hidden_alias="level",
    )  # fmt: skip
    mass: float | None = copy_option(Job, "mass")
    seals: float = copy_option(Job, "seals")
    band: tuple[float, float] | None = copy_option(Job, "band")
    at: tuple[float, ...] = option(
        (),
        "Also find the resonance at this amplitude, e.g. 0.1N.",
        unit="force", multiple=True, metavar="AMPLITUDE", flag="resonance-amplitude",
        hidden_alias="resonance-at",
    )  # fmt: skip
    motion: OverBase = copy_option(HammerChoices, "motion")
    law: AmplitudeLawOption = option(
        "auto",
        "Law of the amplitude.",
        choices=AmplitudeLawOption,
        flag="model",
    )
    options: ReadOptions = make_nested_options(ReadOptions)


@dataclass(frozen=True)
class LevelChoices:
    """Options of levels: amplitudes of a part, and the sweep of its amplitude dependence."""

    levels: tuple[str, ...] = option(
        (),
        "Amplitude of the resonance, e.g. 0.5N or 5m/s^2.",
        multiple=True,
        metavar="AMPLITUDE",
        flag="amplitude",
        hidden_alias="level",
    )
    sweep: str | None = option(
        None,
        "Amplitude sweep or loops of the part.",
        metavar="FILE",
    )
    height: float | None = option(None, "Height of the part, for its strain.", unit="length")
    strain_factor: float | None = option(
        None,
        "Strain of the sweep over that of the part; 0.577 in shear.",
        exclusive_minimum=0.0,
        metavar="NUMBER",
    )
    fitted_at: str | None = option(
        None,
        "Strain of the test behind the fit, e.g. 0.1%.",
        metavar="STRAIN",
        flag="reference-strain",
        hidden_alias="fitted-at",
    )
    resonance_level: str | None = option(
        None,
        "Amplitude at which --resonance was measured.",
        metavar="AMPLITUDE",
        flag="resonance-amplitude",
        hidden_alias="resonance-level",
    )


def declare_shape(message: str) -> Any:
    """Return the field of a shape, ``--shape disc:20mm,20mm``."""
    return option(None, message, keyed_flag="shape", separator=":")


@dataclass(frozen=True)
class PartChoices:
    """Options of a part: its geometry, or a resonance that determines it.

    One of the shapes, a factor, or a resonance with its mass.
    """

    disc: str | None = declare_shape("Diameter and height of a pad: 20mm,20mm.")
    block: str | None = declare_shape("Length, width and height of a pad: 30mm,20mm,10mm.")
    bush: str | None = declare_shape("Inner and outer diameter and length: 12mm,30mm,40mm.")
    bulb: str | None = declare_shape("Outer diameter, wall and length: 22mm,2mm,100mm.")
    mode: PartMode | None = option(
        None, "How the shape is loaded.", choices=PartMode, flag="loading"
    )
    lubricated: bool = option(False, "The plates are lubricated, not bonded.", is_flag=True)
    resonance: float | None = option(
        None, "A measured peak, in place of a shape.", unit="frequency"
    )
    resonance_mass: float | None = option(None, "Mass on the parts at that peak.", unit="mass")


def replace_paths(job: J, replace_path: Callable[[str], str]) -> J:
    """Return a job with every path replaced, in nested options first."""
    values: dict[str, Any] = {}
    for job_field in sorted(fields(job), key=lambda field: "options_class" not in field.metadata):
        value = getattr(job, job_field.name)
        if "options_class" in job_field.metadata:
            values[job_field.name] = replace_paths(value, replace_path)
        elif is_path_field(job_field) and value:
            values[job_field.name] = (
                replace_path(value) if isinstance(value, str) else (*map(replace_path, value),)
            )
    return replace(job, **values)


# Options of tests at several temperatures: one alone, or all, shifted to one.


_TYPED_SHIFTS = {
    word: value
    for value in get_choice_values(VerticalOption)
    for word in (value.removesuffix("/T_r"), value)
}
"""Options for the shift of the moduli by the words that a user types."""


@dataclass(frozen=True)
class ShiftChoices:
    """Options of shifting tests at several temperatures to a master curve.

    `at` and `shifts`, a file, do not apply to ramps and holds, whose shifts one fit determines.
    """

    at: float | None = option(
        None,
        "Use the sweep of this temperature alone.",
        unit="temperature",
        flag="at-temperature",
        hidden_alias="only",
    )
    reference: float | None = option(
        None,
        "Temperature to shift to (nearest to 23degC).",
        unit="temperature",
    )
    law: ShiftLaw = option("auto", "Law of the shift factors.", flag="shift", choices=ShiftLaw)
    vertical: VerticalOption = option(
        "auto",
        "Shift of the moduli: auto, 1, T or free.",
        choices=_TYPED_SHIFTS,
        parse=_TYPED_SHIFTS.__getitem__,
    )
    shifts: str | None = option(None, "Known shift factors.", metavar="FILE")
