"""Preparation and fit of relaxation tests or their files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, TypeAlias

from dashpot.base import dataclass
from dashpot.base.errors import DataError, FitError, ReadError
from dashpot.base.option_fields import Method, copy_option, make_nested_options
from dashpot.base.result_mixins import HasSummary
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.relaxation import RampHold, RelaxationTest
from dashpot.datamodel.specimen import Specimen, make_file_specimens
from dashpot.fitting.fit_options import FitOptions, SolidOptions
from dashpot.fitting.input_tests import split_depths
from dashpot.fitting.relaxation import fit as fit_relaxation
from dashpot.preprocessing.prepare import prepare
from dashpot.reading.columns.kind_detection import format_other_kind
from dashpot.reading.raw_file import add_name_to_errors
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.detect_kind import recognise
from dashpot.reading.readers.relaxation import read_relaxation
from dashpot.registry import FIT_FILES, KINDS, find_handler, load_object, require_handler
from dashpot.workflow.job import Job, ShiftChoices, TimeLimits, require_test_for_machine

# Prepared records, and their specimens.


def prepared_tests(
    tests: Sequence[RelaxationTest | RampHold],
    *,
    filter: str | None = None,
    machine: Machine | None = None,
    time_limits: TimeLimits | None = None,
    cycle: int | None = None,
    with_checks: bool = True,
    each_depth: bool = False,
) -> tuple[RampHold, ...]:
    """Prepare ramps and holds; prepared records are returned unchanged.

    Parameters
    ----------
    tests : sequence of RelaxationTest or RampHold
    filter, machine, cycle, with_checks
        As :func:`~dashpot.preprocessing.prepare.prepare` takes them.
    time_limits : TimeLimits, optional
        For one test, by hand.
    each_depth : bool
        For one record every depth that it holds, as a test of its own.

    Raises
    ------
    FitError
        If options of the preparation are given for a prepared record.
    DataError
        If several are cut by hand, or one cannot be prepared.
    """
    time_limits = time_limits or TimeLimits()
    time_limits.refuse_several(len(tests))
    has_prepared = any(isinstance(test, RampHold) for test in tests)
    if has_prepared and (filter or machine or time_limits != TimeLimits()):
        raise FitError(
            "a test that is prepared already is fitted as it is: say filter, machine and cuts "
            "in test.prepare(...)"
        )
    preparation = {
        "filter": filter,
        "machine": machine,
        "cycle": cycle,
        "with_checks": with_checks,
        **asdict(time_limits),
    }
    if each_depth and len(tests) == 1 and cycle is None and time_limits == TimeLimits():
        (test,) = tests
        if isinstance(test, RelaxationTest):
            return split_depths(test, filter=filter, machine=machine, with_checks=with_checks)
    return tuple(
        record if isinstance(record, RampHold) else prepare(record, **preparation)
        for record in tests
    )


def prepared_files(
    files: Sequence[str | Path],
    *,
    options: ReadOptions | None = None,
    machine: Machine | None = None,
    temperatures: Sequence[float] = (),
    filter: str | None = None,
    time_limits: TimeLimits | None = None,
) -> tuple[RampHold, ...]:
    """Return the relaxation tests in files, prepared, each by the loading that was requested.

    `temperatures`, K, are one for all of them, or one for each; `filter` and `time_limits` as
    :func:`prepared_tests` takes them.
    """
    tests = [
        read_relaxation(path, options=options, specimen=specimen)
        for path, specimen in zip(
            files, make_file_specimens(None, temperatures, len(files)), strict=True
        )
    ]
    cycle = None if options is None else options.cycle
    return prepared_tests(
        tests, filter=filter, machine=machine, time_limits=time_limits, cycle=cycle
    )


def refuse_unfitted_tests(tests: Sequence[RampHold], fit: Fit) -> None:
    """Refuse records that a fit was not made from: their bounds would be of another seal.

    Raises
    ------
    DataError
    """
    entries = {source.sha256: source.file for source in fit.source}
    for test in tests:
        if entries and test.source is not None and test.source.sha256 not in entries:
            raise DataError(
                f"{test.source.file} is not what was fitted (its SHA-256 is another): the fit is "
                f"of {', '.join(dict.fromkeys(entries.values()))}; give that file by --record, or "
                "fit this one"
            )


def fill_missing_temperatures(tests: Sequence[RampHold], fit: Fit) -> tuple[RampHold, ...]:
    """Return records that do not say their temperature with that under which they were fitted."""
    step = next((step for step in reversed(fit.steps) if step.name == "fit"), None)
    text = dict(step.parameters).get("temperatures_K", "") if step is not None else ""
    entries = dict(zip((source.sha256 for source in fit.source), text.split(", "), strict=False))

    def fill_temperature(test: RampHold) -> RampHold:
        kelvin = entries.get(test.source.sha256) if test.source is not None else None
        if not kelvin or test.specimen.temperature is not None:
            return test
        return replace(test, specimen=replace(test.specimen, temperature=float(kelvin)))

    return tuple(map(fill_temperature, tests))


# Choice of the fit by the kinds of the records.


Bench: TypeAlias = HasSummary
"""A test of a bench, as read."""
Record: TypeAlias = Any
"""The same as it is fitted, of the type that its handler makes."""


@dataclass(frozen=True)
class BenchFitOptions(SolidOptions):
    """Options of the fit of bench tests of any kind.

    Sweeps, moduli and creep always have intervals.

    Attributes
    ----------
    depth_law : bool
        Tests of different depths share their relaxation times and an elastic law; each has its own
        stiffnesses.
    filter : str or None
    machine : Machine or None
        None for an unknown machine.
    time_limits : TimeLimits
        For one relaxation test, by hand.
    cycle : int or None
        The loading to use, where a relaxation test has several.
    shifting : ShiftChoices
        For sweeps or moduli at several temperatures: which one, or how all are shifted.
    specimen : Specimen or None
        Stated specimen of the first test: its temperature excludes sweeps at several.
    """

    depth_law: bool = False
    filter: str | None = copy_option(Job, "filter")
    time_limits: TimeLimits = make_nested_options(TimeLimits)
    machine: Machine | None = None
    cycle: int | None = None
    shifting: ShiftChoices = make_nested_options(ShiftChoices)
    specimen: Specimen | None = None

    @property
    def ramp_options(self) -> FitOptions:
        """Options of ramps and holds, which fit their own shifts.

        Raises
        ------
        FitError
            If a choice is for sweeps, moduli and creep alone.
        """
        choices = self.shifting
        if choices.at is not None or choices.shifts is not None:
            raise FitError(
                "--at-temperature and --shifts are for sweeps, moduli and creep; ramps and "
                "holds find their own shifts: leave them out (Python: temperature=; that of a test "
                'is stated by dp.read(FILE, specimen={"temperature": "23degC"}))'
            )
        return FitOptions(
            self.arms, self.method, self.law, self.family, self.intervals, self.thorough,
            shift_law=choices.law,
            vertical="free" if choices.vertical == "auto" else choices.vertical,
            reference=choices.reference,
        )  # fmt: skip

    def has_defaults(self, *names: str) -> bool:
        """Return whether all of these options have their defaults."""
        return all(getattr(self, name) == getattr(BenchFitOptions, name) for name in names)


def fit_files(
    files: Sequence[str | Path],
    *,
    specimen: Specimen | None = None,
    temperatures: Sequence[float] = (),
    options: ReadOptions | None = None,
    **choices: Any,
) -> tuple[Fit, tuple[Record, ...]]:
    """Fit one solid to the records in files, each in the way that suits it.

    Parameters
    ----------
    files : sequence of path
    specimen, options
        As in :func:`~dashpot.reading.readers.relaxation.read_relaxation`; `cycle` is for
        preparation.
    temperatures : sequence of float
        Temperatures of the tests, K: one for all files, or one for each, in their order.
    choices
        Fields of :class:`BenchFitOptions`.

    Returns
    -------
    fit : Fit
    records : tuple
        Records as they were fitted.

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
    fit_options = BenchFitOptions(**choices, cycle=options.cycle, specimen=specimens[0])
    return fit_records(tests, fit_options, name=Path(files[0]).name)


def fit_records(
    tests: Sequence[Bench], options: BenchFitOptions, *, name: str = ""
) -> tuple[Fit, tuple[Record, ...]]:
    """Fit one solid to the records of a bench, as :func:`fit_files` does to those in files.

    Ramps and holds, prepared or not, are fitted together; with tests of another kind, the handler
    of that kind fits them. `name` of the first file is the beginning of error messages.
    """
    handlers = (find_handler("fit records", test) for test in tests)
    fit_others = next((handler for handler in handlers if handler is not None), None)
    if fit_others is not None:
        result: tuple[Fit, tuple[Record, ...]] = fit_others(tests, options, name=name)
        return result
    prepared = prepare_ramps(tests, options)
    return _fit_ramps(prepared, options), prepared


def prepare_ramps(
    tests: Sequence[Any], result: BenchFitOptions, *, among_others: bool = False
) -> tuple[RampHold, ...]:
    """Prepare ramps and holds, those that are fitted with other tests with all their checks."""
    prepared = prepared_tests(
        tests, filter=result.filter, machine=result.machine, time_limits=result.time_limits,
        cycle=result.cycle, with_checks=result.intervals or among_others,
        each_depth=result.depth_law and not among_others,
    )  # fmt: skip
    require_test_for_machine(result.machine, tests=len(prepared), add="a ramp and hold")
    return prepared


def read_test(
    path: str | Path, options: ReadOptions | None = None, specimen: Specimen | None = None
) -> Bench:
    """Return the test of a bench in a file, by the reader of its kind.

    A file of unknown kind is read as a ramp and hold.

    Raises
    ------
    ReadError
        If the file is of another kind, or does not determine its columns and units.
    """
    detection = recognise(path, options)
    row = KINDS.get(detection.kind, KINDS["relaxation"])
    if row.fit != FIT_FILES:
        with add_name_to_errors(Path(path).name):
            raise ReadError(
                format_other_kind(detection.kind, detection.reason, "a test of a bench is")
            )
    test: Bench = load_object(row.reader)(path, options=options, specimen=specimen)
    return test


def _fit_ramps(tests: tuple[RampHold, ...], options: BenchFitOptions) -> Fit:
    """Fit ramps and holds together, or, where a law of the depth is requested, each by itself."""
    if not options.depth_law:
        return fit_relaxation(tests, **options.ramp_options.choices)
    usual_options = options.has_defaults("method", "law", "family")
    if not usual_options or options.thorough or options.shifting != ShiftChoices():
        raise FitError(
            "a law of the depth is of arms of one temperature, found from ramps and holds with "
            "starts of its own: leave out --method, --elastic, --model, --thorough, --reference, "
            "--shift, --vertical, --at-temperature and --shifts"
        )
    fit: Fit = require_handler("fit at several depths", tests[0])(tests, arms=options.arms).fit
    return fit


def fit_fixed_order(test: RampHold, arms: int, *, method: Method = "full") -> Fit:
    """Return the optimum with this number of arms, without checks, as for a figure."""
    return fit_relaxation(test, arms=arms, method=method, intervals=False)
