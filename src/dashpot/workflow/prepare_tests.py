"""From relaxation tests, or their files, to prepared records; whose tests they are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path

from dashpot.base.errors import DataError, FitError
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.relaxation import RampHold, RelaxationTest
from dashpot.datamodel.specimen import make_file_specimens
from dashpot.preprocessing.prepare import prepare
from dashpot.preprocessing.prepare_tests import depths_of
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.relaxation import read_relaxation
from dashpot.workflow.job import Cuts


def prepared_tests(
    tests: Sequence[RelaxationTest | RampHold],
    *,
    filter: str | None = None,
    machine: Machine | None = None,
    cuts: Cuts | None = None,
    cycle: int | None = None,
    checked: bool = True,
    each_depth: bool = False,
) -> tuple[RampHold, ...]:
    """Prepare ramps and holds; what is prepared already stays as it is.

    Parameters
    ----------
    tests : sequence of RelaxationTest or RampHold
    filter, machine, cycle, checked
        As :func:`~dashpot.preprocessing.prepare.prepare` takes them.
    cuts : Cuts, optional
        Of one test, by hand.
    each_depth : bool
        Of one record every depth that it holds, as a test of its own.

    Raises
    ------
    FitError
        If it is said how to prepare them, and one is prepared.
    DataError
        If several are cut by hand, or one cannot be prepared.
    """
    cuts = cuts or Cuts()
    cuts.refuse_several(len(tests))
    ready = any(isinstance(test, RampHold) for test in tests)
    if ready and (filter or machine or cuts != Cuts()):
        raise FitError(
            "a test that is prepared already is fitted as it is: say filter, machine and cuts "
            "in test.prepare(...)"
        )
    how = {"filter": filter, "machine": machine, "cycle": cycle, "judged": checked, **asdict(cuts)}
    if each_depth and len(tests) == 1 and cycle is None and cuts == Cuts():
        (test,) = tests
        if isinstance(test, RelaxationTest):
            return depths_of(test, filter=filter, machine=machine, judged=checked)
    return tuple(
        record if isinstance(record, RampHold) else prepare(record, **how) for record in tests
    )


def prepared_files(
    files: Sequence[str | Path],
    *,
    options: ReadOptions | None = None,
    machine: Machine | None = None,
    temperatures: Sequence[float] = (),
    filter: str | None = None,
    cuts: Cuts | None = None,
) -> tuple[RampHold, ...]:
    """Return the relaxation tests in files, prepared, each by the loading that was asked for.

    `temperatures`, K, are one for all of them, or one for each; `filter` and `cuts` as
    :func:`prepared_tests` takes them.
    """
    tests = [
        read_relaxation(path, options=options, specimen=specimen)
        for path, specimen in zip(
            files, make_file_specimens(None, temperatures, len(files)), strict=True
        )
    ]
    cycle = None if options is None else options.cycle
    return prepared_tests(tests, filter=filter, machine=machine, cuts=cuts, cycle=cycle)


def refuse_others(tests: Sequence[RampHold], fit: Fit) -> None:
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
                "fit "
                "this one"
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
