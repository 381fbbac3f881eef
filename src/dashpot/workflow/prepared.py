"""From files of relaxation tests to prepared records; where their questions are answered."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from dashpot.base.errors import DataError
from dashpot.io.options import ReadOptions
from dashpot.io.readers.relaxation import read_relaxation
from dashpot.preparation.prepare import prepare
from dashpot.records.fit import Fit
from dashpot.records.machine import Machine
from dashpot.records.relaxation import RampHold
from dashpot.workflow.shifting import each_specimen


def prepared_files(
    files: Sequence[str | Path],
    *,
    options: ReadOptions | None = None,
    machine: Machine | None = None,
    temperatures: Sequence[float] = (),
) -> tuple[RampHold, ...]:
    """Return the relaxation tests in files, prepared, each by the loading that was asked for.

    `temperatures`, K, are one for all of them, or one for each.
    """
    cycle = None if options is None else options.cycle
    return tuple(
        prepare(read_relaxation(path, options=options, specimen=one), machine=machine, cycle=cycle)
        for path, one in zip(files, each_specimen(None, temperatures, len(files)), strict=True)
    )


def refuse_others(tests: Sequence[RampHold], found: Fit) -> None:
    """Refuse records that a fit was not made from: their bounds would be of another seal.

    Raises
    ------
    DataError
    """
    known = {source.sha256: source.file for source in found.source}
    for test in tests:
        if known and test.source is not None and test.source.sha256 not in known:
            raise DataError(
                f"{test.source.file} is not what was fitted (its SHA-256 is another): the fit is "
                f"of {', '.join(dict.fromkeys(known.values()))}; give that file by --record, or "
                "fit "
                "this one"
            )


def at_their_temperatures(tests: Sequence[RampHold], found: Fit) -> tuple[RampHold, ...]:
    """Return records that do not say their temperature with that under which they were fitted."""
    step = next((step for step in reversed(found.steps) if step.name == "fit"), None)
    told = dict(step.parameters).get("temperatures_K", "") if step is not None else ""
    known = dict(zip((one.sha256 for one in found.source), told.split(", "), strict=False))

    def of(test: RampHold) -> RampHold:
        kelvin = known.get(test.source.sha256) if test.source is not None else None
        if not kelvin or test.specimen.temperature is not None:
            return test
        return replace(test, specimen=replace(test.specimen, temperature=float(kelvin)))

    return tuple(map(of, tests))
