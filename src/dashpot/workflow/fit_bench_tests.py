"""Which fit suits which record: from files to the solid behind them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, TypeAlias

from dashpot.base.choices import FamilyAsked, Method, RampLawAsked
from dashpot.base.errors import FitError, ReadError
from dashpot.base.option_fields import copy_option, make_nested_options
from dashpot.base.result_mixins import HasSummary
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.relaxation import RampHold
from dashpot.datamodel.specimen import Specimen, make_file_specimens
from dashpot.fitting.relaxation import fit as fit_relaxation
from dashpot.reading.columns.kind_detection import other_kind
from dashpot.reading.raw_file import add_name_to_errors
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.detect_kind import recognise
from dashpot.registry import FIT_FILES, KINDS, find_handler, load_object
from dashpot.workflow.job import Cuts, Job, require_test_for_machine
from dashpot.workflow.prepare_tests import prepared_tests
from dashpot.workflow.shift_options import ShiftChoices, shifted_ramps

Bench: TypeAlias = HasSummary
"""A test of a bench, as read."""
Record: TypeAlias = Any
"""The same as it is fitted, of the type that its handler makes."""


@dataclass(frozen=True)
class BenchFitOptions:
    """What is asked of the fit of tests on a bench, whatever the records turn out to be.

    Attributes
    ----------
    arms, method, law, family, filter, machine
        As of :class:`~dashpot.workflow.job.Job`; `machine` None is a machine of which nothing is
        known.
    cuts : Cuts
        Of one relaxation test, by hand.
    depth_law : bool
        Tests of different depths share their relaxation times and an elastic law; each has its own
        stiffnesses (:func:`~dashpot.fitting.depth_dependence.fit_depths`).
    thorough, intervals : bool
        As :func:`~dashpot.fitting.relaxation.fit` takes them; sweeps, moduli and creep always have
        intervals.
    cycle : int or None
        The loading to use, where a relaxation test has several.
    shifting : ShiftChoices
        Of sweeps or moduli at several temperatures: which one, or how all are shifted.
    specimen : Specimen or None
        What was said of the first test: a temperature of its own refuses sweeps at several.
    """

    arms: int | Literal["auto"] = copy_option(Job, "arms")
    method: Method = copy_option(Job, "method")
    depth_law: bool = False
    thorough: bool = False
    law: RampLawAsked = copy_option(Job, "law")
    family: FamilyAsked = copy_option(Job, "family")
    intervals: bool = True
    filter: str | None = copy_option(Job, "filter")
    cuts: Cuts = make_nested_options(Cuts)
    machine: Machine | None = None
    cycle: int | None = None
    shifting: ShiftChoices = make_nested_options(ShiftChoices)
    specimen: Specimen | None = None

    def nothing_of(self, *names: str) -> bool:
        """Whether each of these is left at what it is where nothing is said."""
        return all(getattr(self, name) == getattr(BenchFitOptions, name) for name in names)


def fit_files(
    files: Sequence[str | Path],
    *,
    specimen: Specimen | None = None,
    temperatures: Sequence[float] = (),
    options: ReadOptions | None = None,
    **asked: Any,
) -> tuple[Fit, tuple[Record, ...]]:
    """Fit one solid to the records in files, each in the way that suits it.

    Parameters
    ----------
    files : sequence of path
    specimen, options
        As in :func:`~dashpot.reading.readers.relaxation.read_relaxation`; `cycle` is for
        preparation.
    temperatures : sequence of float
        Of the tests, K: one for all files, or one for each, in their order.
    asked
        Fields of :class:`BenchFitOptions`.

    Returns
    -------
    fit : Fit
    records : tuple
        What is behind it, as fitted.

    Raises
    ------
    ReadError, DataError, FitError
        If a file cannot be read, prepared or fitted, or the choices exclude each other.
    """
    options = options or ReadOptions()
    specimens = make_file_specimens(specimen, temperatures, len(files))
    tests = [
        read_test(path, options, specimen) for path, specimen in zip(files, specimens, strict=True)
    ]
    fit_options = BenchFitOptions(**asked, cycle=options.cycle, specimen=specimens[0])
    return fit_records(tests, fit_options, name=Path(files[0]).name)


def fit_records(
    tests: Sequence[Bench], asked: BenchFitOptions, *, name: str = ""
) -> tuple[Fit, tuple[Record, ...]]:
    """Fit one solid to the records of a bench, as :func:`fit_files` does to those in files.

    Ramps and holds are fitted together, also such as are prepared; what is with other tests, by
    the handler of these. `name`, of the first file, stands before what is wrong.
    """
    named = (find_handler("fit records", test) for test in tests)
    fit_others = next((item for item in named if item is not None), None)
    if fit_others is not None:
        result: tuple[Fit, tuple[Record, ...]] = fit_others(tests, asked, name=name)
        return result
    prepared = prepare_ramps(tests, asked)
    return _fit_ramps(prepared, asked), prepared


def prepare_ramps(
    tests: Sequence[Any], result: BenchFitOptions, *, among_others: bool = False
) -> tuple[RampHold, ...]:
    """Prepare ramps and holds, those that are fitted with other tests with all their checks."""
    prepared = prepared_tests(
        tests, filter=result.filter, machine=result.machine, cuts=result.cuts, cycle=result.cycle,
        checked=result.intervals or among_others, each_depth=result.depth_law and not among_others,
    )  # fmt: skip
    require_test_for_machine(result.machine, tests=len(prepared), add="a ramp and hold")
    return prepared


def read_test(
    path: str | Path, options: ReadOptions | None = None, specimen: Specimen | None = None
) -> Bench:
    """Return the test of a bench in a file, by the reader of its kind.

    What is of no kind is asked for the columns of a ramp and hold.

    Raises
    ------
    ReadError
        If the file is of another kind, or leaves open which column is what or in which unit.
    """
    detection = recognise(path, options)
    row = KINDS.get(detection.kind, KINDS["relaxation"])
    if row.fit != FIT_FILES:
        with add_name_to_errors(Path(path).name):
            raise ReadError(other_kind(detection.kind, detection.reason, "a test of a bench is"))
    test: Bench = load_object(row.reader)(path, options=options, specimen=specimen)
    return test


def _fit_ramps(tests: tuple[RampHold, ...], options: BenchFitOptions) -> Fit:
    """Fit ramps and holds together, or, where a law of the depth is asked for, each by itself."""
    if not options.depth_law:
        return fit_relaxation(
            tests,
            arms=options.arms,
            method=options.method,
            thorough=options.thorough,
            law=options.law,
            family=options.family,
            intervals=options.intervals,
            **shifted_ramps(options.shifting),
        )
    usual = options.nothing_of("method", "law", "family")
    if not usual or options.thorough or options.shifting != ShiftChoices():
        raise FitError(
            "a law of the depth is of arms of one temperature, found from ramps and holds with "
            "starts of its own: leave out --method, --elastic, --model, --thorough, --reference, "
            "--shift, --vertical, --only and --shifts"
        )
    from dashpot.fitting.depth_dependence import fit_depths

    return fit_depths(tests, arms=options.arms).fit


def fit_fixed_order(test: RampHold, arms: int, *, method: Method = "full") -> Fit:
    """The optimum with so many arms alone, which is drawn, not judged."""
    return fit_relaxation(test, arms=arms, method=method, intervals=False)
