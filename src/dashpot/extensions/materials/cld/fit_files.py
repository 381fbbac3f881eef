"""Fit of compression load deflection files: the values of each piece and their scatter."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from pathlib import Path

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.checks import Check, HasChecks, select_gravest_check
from dashpot.base.errors import ReadError
from dashpot.base.provenance import sources_of
from dashpot.base.reported_values import ReportedValue
from dashpot.base.result_mixins import HasVerdict, Series, collect_columns
from dashpot.base.serialisation import Key, Serialisable
from dashpot.base.student_t import t_quantile
from dashpot.base.units import Quantity, Range, format_quantity
from dashpot.datamodel.checks import caution_checks
from dashpot.datamodel.fit import Fit, apply_elastic_law
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.materials.cld.checks import pieces_capable, pieces_tested_alike
from dashpot.extensions.materials.cld.datamodel import (
    CLD,
    SAME_SPEED,
    AtCompression,
    CLDTest,
    ProcessCapability,
    RateLaw,
    RelaxedLaw,
)
from dashpot.extensions.materials.cld.equilibrium_curve import find_nearest_fit, longer, relaxed_law
from dashpot.extensions.materials.cld.multi_speed_fit import fit_speeds
from dashpot.extensions.materials.cld.preprocess import cld
from dashpot.extensions.materials.cld.rate_dependence import fit_rate
from dashpot.extensions.materials.cld.read import read_cld
from dashpot.reading.raw_file import add_name_to_errors
from dashpot.reading.read_options import ReadOptions
from dashpot.registry import find_handler

_ALIKE = 0.05
"""Relative difference of depths and speeds that are one."""
_AS_WARM = 3.0
"""Difference of temperatures that are one, K."""


@dataclass(frozen=True)
class PieceStatistics:
    """Mean and standard deviation of one value over the pieces.

    Attributes
    ----------
    name : str
    unit : str
    count : int
        Of the pieces that have it.
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
        half = math.nan
        if self.count > 1:
            half = t_quantile(0.95, self.count - 1) * self.deviation / math.sqrt(self.count)
        ends = self.mean - half, self.mean + half
        unit = self.unit or "1"
        read = "" if self.unit else "%"
        return ReportedValue(self.name, self.mean, *ends, unit, read=read)


@dataclass(frozen=True, repr=False)
class CLDResult(HasChecks, HasVerdict, Serialisable):
    """Result of ``dashpot fit`` on compression load deflection.

    Attributes
    ----------
    pieces : tuple of CLD
        One a file.
    scatter : tuple of PieceStatistics
        Of two or more pieces.
    capability : ProcessCapability or None
        Of the force at the nominal compression between its limits.
    checks : tuple of Check
        Those of every piece, each at its worst, and of the pieces together.
    relaxed : RelaxedLaw or None
        The elastic law of the first piece, where a relaxation test determined its arms.
    fit : Fit or None
        That of the relaxation test with this law; or, of records at several speeds, theirs.
    rate : RateLaw or None
        Of records at several speeds: a spring and a dashpot that depend on compression.

    Examples
    --------
    >>> import dashpot as dp, numpy as np
    >>> x = 8 * np.sin(np.linspace(0, np.pi, 400))
    >>> t = np.linspace(0, 20, 400)
    >>> piece = dp.CLDTest(displacement=x, force=x / 4, time=t, units="mm, N, s")
    >>> round(dp.fit(piece, compression="6mm").pieces[0].nominal.loading, 2)
    1.5
    """

    schema = "dashpot/cld@2"
    _keys = (
        "unit",
        Key("specimens", "pieces"),
        "scatter",
        "capability",
        Key("relaxed", optional=True),
        Key("rate", optional=True),
        "verdict",
        "checks",
        Key("fit", optional=True),
    )

    pieces: tuple[CLD, ...]
    scatter: tuple[PieceStatistics, ...]
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
        """Of a force."""
        return self.pieces[0].unit

    @property
    def table_columns(self) -> Series:
        """Of each piece what it shows at the nominal compression, as `CLD.per` gives it."""

        def scale_nominal(name: str) -> list[float]:
            return [piece.per * getattr(piece.nominal, name) for piece in self.pieces]

        names = ["" if piece.source is None else piece.source.file for piece in self.pieces]
        unit, slope = self.unit, self.unit.replace("N", "N/m", 1)
        return {
            "piece": (names, ""),
            **collect_columns((piece.nominal for piece in self.pieces), compression="m"),
            "loading": (scale_nominal("loading"), unit),
            "loading_se": (scale_nominal("loading_se"), unit),
            "slope": (scale_nominal("slope"), slope),
            "slope_se": (scale_nominal("slope_se"), slope),
            **collect_columns((piece.cycle for piece in self.pieces), hysteresis=""),
            **collect_columns(self.pieces, set="m"),
        }

    @property
    def headline(self) -> str:
        """The force at the nominal compression, and that of the least and of the stiffest piece."""
        if len(self.pieces) == 1 or self.rate is not None:
            return self.pieces[0].headline
        forces = [piece.per * piece.nominal.loading for piece in self.pieces]
        at = format_quantity(self.pieces[0].nominal.compression, "mm", ".3g")
        return (
            f"{sum(forces) / len(forces):.3g} {self.unit} at {at} ({len(forces)} specimens: "
            f"{min(forces):.3g} to {max(forces):.3g})"
        )


def cld_files(
    files: Sequence[str | Path],
    *,
    at: Quantity | None = None,
    between: Range | None = None,
    limits: tuple[float, float] | None = None,
    memory: Sequence[Fit] = (),
    specimen: Specimen | None = None,
    machine: Machine | None = None,
    options: ReadOptions | None = None,
) -> CLDResult:
    """Find the figures of compression load deflection of pieces, and how they scatter.

    Records at speeds that differ by half or more are taken for one seal, whose elastic law and
    memory are fitted, unless there are limits, or a memory.

    Parameters
    ----------
    files : sequence of path
        A piece each.
    at, between
        As in :func:`~dashpot.extensions.materials.cld.preprocess.cld`; without `at` the least depth
        of all.
    limits : (float, float), optional
        Of the force at the nominal compression, N, of 100 mm where the length is known.
    memory : sequence of Fit
        Of relaxation tests: the memory of the one held nearest to the nominal compression is taken
        off the first piece, which leaves the elastic law; all are held against it.
    specimen : Specimen, optional
        What is the same of every piece, such as its length.
    machine : Machine, optional
        What is known of the machine: its `sync`.
    options : ReadOptions, optional
        What the user said of the files; `cycle` is the cycle that the figures are of.

    Raises
    ------
    ReadError, DataError
        If a file cannot be read or shows no loading, or limits are given for one piece.
    """
    options = options or ReadOptions()
    tests = [read_cld(path, options=options, specimen=specimen) for path in files]
    return cld_of(
        tests, at=at, between=between, limits=limits, memory=memory, cycle=options.cycle,
        names=[Path(path).name for path in files], machine=machine,
    )  # fmt: skip


def cld_of(
    tests: Sequence[CLDTest],
    *,
    at: Quantity | None = None,
    between: Range | None = None,
    limits: tuple[float, float] | None = None,
    memory: Sequence[Fit] = (),
    cycle: int | None = None,
    names: Sequence[str] = (),
    machine: Machine | None = None,
) -> CLDResult:
    """Find the figures of pieces, as :func:`cld_files` does of those in files.

    `names` are put before what is wrong with one of them, `cycle` is the one of the figures.
    """
    if limits is not None and len(tests) < 2:
        raise ReadError("--force-limits are of several pieces: name a file for each, or leave out")
    pieces = _figures(
        tests, names or [""] * len(tests), cycle, at=at, between=between, machine=machine
    )
    scatter = CLDResult(
        pieces, (), None, (*_select_worst_checks(pieces), *caution_checks(sources_of(pieces)))
    )
    if not memory and limits is None and _several_speeds(pieces):
        return _add_speed_fit(scatter)
    if len(pieces) > 1:
        scatter = _add_piece_scatter(scatter, limits)
    return _with_memory(scatter, memory) if memory else scatter


def _figures(
    tests: Sequence[CLDTest],
    names: Sequence[str],
    cycle: int | None,
    *,
    at: Quantity | None,
    between: Range | None,
    machine: Machine | None,
) -> tuple[CLD, ...]:
    """Return each piece, all at one nominal compression."""
    _refuse_twice(tests)

    def figures(test: CLDTest, nominal: Quantity | None) -> CLD:
        return cld(test, at=nominal, between=between, cycle=cycle, machine=machine)

    pieces = []
    for name, test in zip(names, tests, strict=True):
        with add_name_to_errors(name) if name else nullcontext():
            pieces.append(figures(test, at))
    if at is not None or len(pieces) == 1:
        return tuple(pieces)
    least = min(piece.cycle.depth for piece in pieces)
    return tuple(figures(test, least) for test in tests)


def _select_worst_checks(pieces: Sequence[CLD]) -> tuple[Check, ...]:
    """Return the checks of every piece, each at its worst."""
    return tuple(
        select_gravest_check(group)
        for group in zip(*(piece.checks for piece in pieces), strict=True)
    )


def _add_speed_fit(pieces: CLDResult) -> CLDResult:
    """With the elastic law and the memory of one seal at several speeds."""
    fit = fit_speeds(pieces.pieces)
    rate = fit_rate(pieces.pieces, fit)
    final_check = next(
        check for check in rate.checks if check.name == "one_relaxation_explains_speeds"
    )
    fit = replace(fit, evidence=replace(fit.evidence, checks=(*fit.checks, final_check)))
    return replace(pieces, checks=(*pieces.checks, *fit.checks), fit=fit, rate=rate)


def _add_piece_scatter(new_pieces: CLDResult, limits: tuple[float, float] | None) -> CLDResult:
    """With how several pieces scatter, and whether their forces keep within limits."""
    pieces, within = new_pieces.pieces, None
    checks = [pieces_tested_alike(_otherwise(pieces))]
    if limits is not None:
        forces = np.array([piece.per * piece.nominal.loading for piece in pieces])
        within = find_handler("process capability", forces)(forces, *limits)
        checks.append(pieces_capable(within, new_pieces.unit))
    scatter = tuple(_scatter(pieces))
    return replace(
        new_pieces, scatter=scatter, capability=within, checks=(*new_pieces.checks, *checks)
    )


def _with_memory(pieces: CLDResult, memory: Sequence[Fit]) -> CLDResult:
    """With the elastic law under the first piece."""
    relaxed = relaxed_law(pieces.pieces[0], memory)
    near = find_nearest_fit(pieces.pieces[0], memory)
    # the reported law is the saved law, of a piece as long as that of the relaxation test
    stiffness = relaxed.law.stiffness / longer(pieces.pieces[0], near)
    fed = apply_elastic_law(near, relaxed.law, checks=relaxed.checks, stiffness=stiffness)
    return replace(pieces, checks=(*pieces.checks, *relaxed.checks), relaxed=relaxed, fit=fed)


def _refuse_twice(tests: Sequence[CLDTest]) -> None:
    seen: dict[str, str] = {}
    for source in (test.source for test in tests if test.source is not None):
        if source.sha256 in seen:
            raise ReadError(
                f"{source.file} is the same record as {seen[source.sha256]}; each specimen once"
            )
        seen[source.sha256] = source.file


def _several_speeds(pieces: Sequence[CLD]) -> bool:
    speeds = [piece.cycle.speed for piece in pieces if piece.cycle.speed is not None]
    return len(speeds) == len(pieces) and max(speeds) >= SAME_SPEED * min(speeds)


def _scatter(pieces: Sequence[CLD]) -> list[PieceStatistics]:
    unit = pieces[0].unit
    each_mm = "N/m" + unit.removeprefix("N")
    figures: tuple[tuple[str, str, Callable[[CLD], float | None]], ...] = (
        ("force at least", unit, lambda result: _force(result, result.least)),
        ("force at nominal", unit, lambda result: _force(result, result.nominal)),
        ("force at most", unit, lambda result: _force(result, result.most)),
        ("slope at nominal", each_mm, lambda result: result.per * result.nominal.slope),
        ("energy", "J" + unit.removeprefix("N"), lambda result: result.per * result.cycle.energy),
        ("hysteresis", "", lambda result: result.cycle.hysteresis),
        ("softening", "", lambda result: result.softening if len(result.cycles) > 1 else None),
        ("set", "m", lambda result: result.set),
    )
    statistics = []
    for name, of, figure in figures:
        values = [value for value in map(figure, pieces) if value is not None]
        if len(values) > 1:
            statistics.append(
                PieceStatistics(
                    name, of, len(values), float(np.mean(values)), float(np.std(values, ddof=1))
                )
            )
    return statistics


def _force(result: CLD, at: AtCompression | None) -> float | None:
    return None if at is None else result.per * at.loading


def _otherwise(pieces: Sequence[CLD]) -> list[str]:
    """Return what differs between the tests of pieces that should scatter by themselves alone."""
    speeds, depths, numbers, temperatures = (
        sorted(value for value in map(figure, pieces) if value is not None) or [0.0]
        for figure in _CONDITIONS
    )
    differs = {
        "speed": speeds[-1] > (1 + _ALIKE) * speeds[0],
        "depth": depths[-1] > (1 + _ALIKE) * depths[0],
        "number of the cycle": numbers[-1] > (1 + _ALIKE) * numbers[0],
        "length, known of some alone": len({piece.specimen.length is None for piece in pieces}) > 1,
        "temperature": temperatures[-1] - temperatures[0] > _AS_WARM,
    }
    return [name for name, flag in differs.items() if flag]


_CONDITIONS: tuple[Callable[[CLD], float | None], ...] = (
    lambda result: result.cycle.speed,
    lambda result: result.cycle.depth,
    lambda result: result.cycle.number,
    lambda result: result.specimen.temperature,
)
"""Speed, depth, number of the cycle and temperature, K, of a test."""
