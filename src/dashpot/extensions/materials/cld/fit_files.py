"""Fit of compression load deflection files: the values of each specimen and their scatter."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from pathlib import Path

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.checks import Check, HasChecks, select_gravest_check
from dashpot.base.errors import DataError, ReadError
from dashpot.base.provenance import Step, list_sources
from dashpot.base.reported_values import ReportedValue
from dashpot.base.result_mixins import HasVerdict, Series, collect_columns
from dashpot.base.serialisation import Key, Serialisable
from dashpot.base.student_t import t_quantile
from dashpot.base.units import Quantity, Range, format_quantity
from dashpot.datamodel.checks import caution_checks
from dashpot.datamodel.fit import Fit, scale_stiffness
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.materials.cld.checks import specimens_capable, specimens_tested_alike
from dashpot.extensions.materials.cld.datamodel import (
    CLD,
    SAME_SPEED,
    CLDTest,
    CompressionValues,
    ProcessCapability,
    RateLaw,
    RelaxedLaw,
)
from dashpot.extensions.materials.cld.equilibrium_curve import (
    find_nearest_fit,
    fit_relaxed_law,
    get_length_ratio,
)
from dashpot.extensions.materials.cld.multi_speed_fit import fit_speeds
from dashpot.extensions.materials.cld.preprocess import cld
from dashpot.extensions.materials.cld.rate_dependence import fit_rate
from dashpot.extensions.materials.cld.read import read_cld
from dashpot.reading.raw_file import add_name_to_errors
from dashpot.reading.read_options import ReadOptions
from dashpot.registry import require_handler
from dashpot.solids.elastic import ElasticLaw


def apply_elastic_law(
    fit: Fit, law: ElasticLaw, *, checks: Sequence[Check] = (), stiffness: float | None = None
) -> Fit:
    """Return the fit with the shape of another measured elastic law.

    Its stiffnesses do not change at the held depth; the solid is then the secant one at the law's
    deepest compression. With `stiffness`, N/m, the relaxed secant one there, the fit is of the part
    that the law is of, and only its memory is taken.

    Raises
    ------
    DataError
        If no part was pressed, or the law ends more than 1 % before the depth that was held.
    """
    if fit.elastic_law is None:
        raise DataError("the fit is of no pressed part: expected one of a relaxation test")
    held_depth = fit.elastic_law.depth
    if law.depth < 0.99 * held_depth:
        raise DataError(
            f"the law ends at {format_quantity(law.depth, 'mm')}, and the test was held at "
            f"{format_quantity(held_depth, 'mm')}: expected a cycle at least as deep"
        )
    factor = held_depth / float(law.path(held_depth))
    if stiffness is not None:
        factor = stiffness / fit.model.k_inf
    step = Step(
        "elastic law",
        (("depth_m", repr(law.depth)), ("of", fit._identity)),
        f"elastic law of compression load deflection to {format_quantity(law.depth, 'mm')}: "
        f"stiffnesses there {factor:.4g} times the secant of fit {fit._identity}",
    )
    scaled_fit = scale_stiffness(fit, factor, step)
    return replace(
        scaled_fit,
        elastic_law=replace(law, stiffness=scaled_fit.model.k_inf),
        evidence=replace(scaled_fit.evidence, checks=(*fit.checks, *checks), end_of_hold=None),
    )


_SAME_RATIO = 0.05
"""Relative difference of depths and speeds that are one."""
_SAME_TEMPERATURE = 3.0
"""Difference of temperatures that are one, K."""


@dataclass(frozen=True)
class SpecimenStatistics:
    """Mean and standard deviation of one value over the specimens.

    Attributes
    ----------
    name : str
    unit : str
    count : int
        Number of the specimens that have it.
    mean, deviation : float
        In SI units; a force of 100 mm where the lengths are known.
    """

    name: str
    unit: str
    count: int
    mean: float
    deviation: float

    @property
    def fact(self) -> ReportedValue:
        """The mean, with its interval by Student's t."""
        half_width = math.nan
        if self.count > 1:
            half_width = t_quantile(0.95, self.count - 1) * self.deviation / math.sqrt(self.count)
        interval = self.mean - half_width, self.mean + half_width
        unit = self.unit or "1"
        display_unit = "" if self.unit else "%"
        return ReportedValue(self.name, self.mean, *interval, unit, read=display_unit)


@dataclass(frozen=True, repr=False)
class CLDResult(HasChecks, HasVerdict, Serialisable):
    """Result of ``dashpot fit`` on compression load deflection.

    Attributes
    ----------
    specimens : tuple of CLD
        One a file.
    scatter : tuple of SpecimenStatistics
        Scatter of two or more specimens.
    capability : ProcessCapability or None
        Capability of the force at the nominal compression between its limits.
    checks : tuple of Check
        The worst check of each name over the specimens, and checks of the specimens together.
    relaxed : RelaxedLaw or None
        The elastic law of the first specimen, where a relaxation test determined its arms.
    fit : Fit or None
        Fit of the relaxation test with this law; or, of records at several speeds, theirs.
    rate : RateLaw or None
        For records at several speeds: a spring and a dashpot that depend on compression.

    Examples
    --------
    >>> import dashpot as dp, numpy as np
    >>> x = 8 * np.sin(np.linspace(0, np.pi, 400))
    >>> t = np.linspace(0, 20, 400)
    >>> test = dp.CLDTest(displacement=x, force=x / 4, time=t, units="mm, N, s")
    >>> round(dp.fit(test, compression="6mm").specimens[0].nominal.loading, 2)
    1.5
    """

    schema = "dashpot/cld@2"
    _keys = (
        "unit",
        "specimens",
        "scatter",
        "capability",
        Key("relaxed", optional=True),
        Key("rate", optional=True),
        "verdict",
        "checks",
        Key("fit", optional=True),
    )

    specimens: tuple[CLD, ...]
    scatter: tuple[SpecimenStatistics, ...]
    capability: ProcessCapability | None
    checks: tuple[Check, ...]
    relaxed: RelaxedLaw | None = None
    fit: Fit | None = None
    rate: RateLaw | None = None

    @property
    def _saved_result(self) -> CLDResult | Fit:
        """The fit, if there is one."""
        return self.fit or self

    @property
    def unit(self) -> str:
        """Unit of a force."""
        return self.specimens[0].unit

    @property
    def _table_columns(self) -> Series:
        """Figures of each specimen at the nominal compression, scaled by `CLD.per`."""

        def scale_nominal(name: str) -> list[float]:
            return [specimen.per * getattr(specimen.nominal, name) for specimen in self.specimens]

        names = [
            "" if specimen.source is None else specimen.source.file for specimen in self.specimens
        ]
        unit, slope = self.unit, self.unit.replace("N", "N/m", 1)
        return {
            "specimen": (names, ""),
            **collect_columns((specimen.nominal for specimen in self.specimens), compression="m"),
            "loading": (scale_nominal("loading"), unit),
            "loading_se": (scale_nominal("loading_se"), unit),
            "slope": (scale_nominal("slope"), slope),
            "slope_se": (scale_nominal("slope_se"), slope),
            **collect_columns((specimen.cycle for specimen in self.specimens), hysteresis=""),
            **collect_columns(self.specimens, set="m"),
        }

    @property
    def _headline(self) -> str:
        """Mean force at the nominal compression, and the least and the largest of the specimens."""
        if len(self.specimens) == 1 or self.rate is not None:
            return self.specimens[0]._headline
        forces = [specimen.per * specimen.nominal.loading for specimen in self.specimens]
        compression_text = format_quantity(self.specimens[0].nominal.compression, "mm", ".3g")
        return (
            f"{sum(forces) / len(forces):.3g} {self.unit} at {compression_text} ({len(forces)} "
            f"specimens: {min(forces):.3g} to {max(forces):.3g})"
        )


def cld_files(
    files: Sequence[str | Path],
    *,
    at: Quantity | None = None,
    compression_limits: Range | None = None,
    limits: tuple[float, float] | None = None,
    relaxation: Sequence[Fit] = (),
    specimen: Specimen | None = None,
    machine: Machine | None = None,
    options: ReadOptions | None = None,
) -> CLDResult:
    """Evaluate files of compression load deflection: figures of each specimen and their scatter.

    Records at speeds that differ by half or more are taken for one seal, whose elastic law and
    relaxation function are fitted, unless there are limits, or fits of relaxation tests.

    Parameters
    ----------
    files : sequence of path
        One for each specimen.
    at, compression_limits
        As in :func:`~dashpot.extensions.materials.cld.preprocess.cld`; without `at` the least depth
        of all.
    limits : (float, float), optional
        Limits of the force at the nominal compression, N, of 100 mm where the length is known.
    relaxation : sequence of Fit
        Fits of relaxation tests. The relaxation function of the one nearest to the nominal
        compression is removed from the first specimen, which leaves the elastic law; all are
        compared with it.
    specimen : Specimen, optional
        Data that all specimens share, such as their length.
    machine : Machine, optional
        Known properties of the machine: its `sync`.
    options : ReadOptions, optional
        Reading options of the files; `cycle` is the cycle that the figures are of.

    Raises
    ------
    ReadError, DataError
        If a file cannot be read or shows no loading, or limits are given for one specimen.
    """
    options = options or ReadOptions()
    tests = [read_cld(path, options=options, specimen=specimen) for path in files]
    return evaluate_cld(
        tests, nominal_compression=at, tolerance_limits=compression_limits, limits=limits,
        relaxation=relaxation, cycle=options.cycle, names=[Path(path).name for path in files],
        machine=machine,
    )  # fmt: skip


def evaluate_cld(
    tests: Sequence[CLDTest],
    *,
    nominal_compression: Quantity | None = None,
    tolerance_limits: Range | None = None,
    limits: tuple[float, float] | None = None,
    relaxation: Sequence[Fit] = (),
    cycle: int | None = None,
    names: Sequence[str] = (),
    machine: Machine | None = None,
) -> CLDResult:
    """Evaluate records of compression load deflection, as :func:`cld_files` does those in files.

    `names` are put before what is wrong with one of them, `cycle` is the one of the figures.
    """
    if limits is not None and len(tests) < 2:
        raise ReadError(
            "--force-limits need several specimens: name a file for each, or leave it out"
        )
    specimens = _evaluate_figures(
        tests,
        names or [""] * len(tests),
        cycle,
        nominal_compression=nominal_compression,
        tolerance_limits=tolerance_limits,
        machine=machine,
    )
    scatter = CLDResult(
        specimens,
        (),
        None,
        (*_select_worst_checks(specimens), *caution_checks(list_sources(specimens))),
    )
    if not relaxation and limits is None and _has_several_speeds(specimens):
        return _add_speed_fit(scatter)
    if len(specimens) > 1:
        scatter = _add_specimen_scatter(scatter, limits)
    return _with_relaxation(scatter, relaxation) if relaxation else scatter


def _evaluate_figures(
    tests: Sequence[CLDTest],
    names: Sequence[str],
    cycle: int | None,
    *,
    nominal_compression: Quantity | None,
    tolerance_limits: Range | None,
    machine: Machine | None,
) -> tuple[CLD, ...]:
    """Return the figures of each specimen, all at one nominal compression."""
    _refuse_repeated_records(tests)

    def figures(test: CLDTest, nominal: Quantity | None) -> CLD:
        return cld(
            test, at=nominal, compression_limits=tolerance_limits, cycle=cycle, machine=machine
        )

    specimens = []
    for name, test in zip(names, tests, strict=True):
        with add_name_to_errors(name) if name else nullcontext():
            specimens.append(figures(test, nominal_compression))
    if nominal_compression is not None or len(specimens) == 1:
        return tuple(specimens)
    smallest_depth = min(specimen.cycle.depth for specimen in specimens)
    return tuple(figures(test, smallest_depth) for test in tests)


def _select_worst_checks(specimens: Sequence[CLD]) -> tuple[Check, ...]:
    """Return the checks of every specimen, each at its worst."""
    return tuple(
        select_gravest_check(group)
        for group in zip(*(specimen.checks for specimen in specimens), strict=True)
    )


def _add_speed_fit(result: CLDResult) -> CLDResult:
    """Return the result with the model fitted to one seal at several speeds."""
    fit = fit_speeds(result.specimens)
    rate = fit_rate(result.specimens, fit)
    final_check = next(
        check for check in rate.checks if check.name == "single_relaxation_explains_speeds"
    )
    fit = replace(fit, evidence=replace(fit.evidence, checks=(*fit.checks, final_check)))
    return replace(result, checks=(*result.checks, *fit.checks), fit=fit, rate=rate)


def _add_specimen_scatter(result: CLDResult, limits: tuple[float, float] | None) -> CLDResult:
    """Return the result with the scatter of its specimens, and their capability within limits."""
    specimens, capability = result.specimens, None
    checks = [specimens_tested_alike(_list_other_conditions(specimens))]
    if limits is not None:
        forces = np.array([specimen.per * specimen.nominal.loading for specimen in specimens])
        capability = require_handler("process capability", forces)(forces, *limits)
        checks.append(specimens_capable(capability, result.unit))
    scatter = tuple(_compute_scatter(specimens))
    return replace(result, scatter=scatter, capability=capability, checks=(*result.checks, *checks))


def _with_relaxation(result: CLDResult, relaxation: Sequence[Fit]) -> CLDResult:
    """Return the result with the elastic law of the first specimen, without relaxation."""
    relaxed_law = fit_relaxed_law(result.specimens[0], relaxation)
    nearest_fit = find_nearest_fit(result.specimens[0], relaxation)
    # the saved law is of a specimen as long as that of the relaxation test
    stiffness = relaxed_law.law.stiffness / get_length_ratio(result.specimens[0], nearest_fit)
    fit_with_law = apply_elastic_law(
        nearest_fit, relaxed_law.law, checks=relaxed_law.checks, stiffness=stiffness
    )
    return replace(
        result,
        checks=(*result.checks, *relaxed_law.checks),
        relaxed=relaxed_law,
        fit=fit_with_law,
    )


def _refuse_repeated_records(tests: Sequence[CLDTest]) -> None:
    files_by_record: dict[str, str] = {}
    for source in (test.source for test in tests if test.source is not None):
        if source.sha256 in files_by_record:
            raise ReadError(
                f"{source.file} is the same record as {files_by_record[source.sha256]}; each "
                "specimen once"
            )
        files_by_record[source.sha256] = source.file


def _has_several_speeds(specimens: Sequence[CLD]) -> bool:
    speeds = [specimen.cycle.speed for specimen in specimens if specimen.cycle.speed is not None]
    return len(speeds) == len(specimens) and max(speeds) >= SAME_SPEED * min(speeds)


def _compute_scatter(specimens: Sequence[CLD]) -> list[SpecimenStatistics]:
    unit = specimens[0].unit
    each_mm = "N/m" + unit.removeprefix("N")
    figures: tuple[tuple[str, str, Callable[[CLD], float | None]], ...] = (
        ("force at least", unit, lambda result: _interpolate_force(result, result.least)),
        ("force at nominal", unit, lambda result: _interpolate_force(result, result.nominal)),
        ("force at most", unit, lambda result: _interpolate_force(result, result.most)),
        ("slope at nominal", each_mm, lambda result: result.per * result.nominal.slope),
        ("energy", "J" + unit.removeprefix("N"), lambda result: result.per * result.cycle.energy),
        ("hysteresis", "", lambda result: result.cycle.hysteresis),
        ("softening", "", lambda result: result.softening if len(result.cycles) > 1 else None),
        ("set", "m", lambda result: result.set),
    )
    statistics = []
    for name, figure_unit, figure in figures:
        values = [value for value in map(figure, specimens) if value is not None]
        if len(values) > 1:
            statistics.append(
                SpecimenStatistics(
                    name,
                    figure_unit,
                    len(values),
                    float(np.mean(values)),
                    float(np.std(values, ddof=1)),
                )
            )
    return statistics


def _interpolate_force(result: CLD, nominal_value: CompressionValues | None) -> float | None:
    return None if nominal_value is None else result.per * nominal_value.loading


def _list_other_conditions(specimens: Sequence[CLD]) -> list[str]:
    """Return the conditions in which the tests of the specimens differ."""
    speeds, depths, numbers, temperatures = (
        sorted(value for value in map(figure, specimens) if value is not None) or [0.0]
        for figure in _CONDITIONS
    )
    differs = {
        "speed": speeds[-1] > (1 + _SAME_RATIO) * speeds[0],
        "depth": depths[-1] > (1 + _SAME_RATIO) * depths[0],
        "number of the cycle": numbers[-1] > (1 + _SAME_RATIO) * numbers[0],
        "length, known of some alone": len(
            {specimen.specimen.length is None for specimen in specimens}
        )
        > 1,
        "temperature": temperatures[-1] - temperatures[0] > _SAME_TEMPERATURE,
    }
    return [name for name, flag in differs.items() if flag]


_CONDITIONS: tuple[Callable[[CLD], float | None], ...] = (
    lambda result: result.cycle.speed,
    lambda result: result.cycle.depth,
    lambda result: result.cycle.number,
    lambda result: result.specimen.temperature,
)
"""Speed, depth, number of the cycle and temperature, K, of a test."""
