"""Which fit suits which record: from files to the solid behind them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Literal, TypeAlias

import dashpot as dp
from dashpot.base.errors import FitError
from dashpot.io.options import ReadOptions
from dashpot.io.source import about
from dashpot.preparation.creep import load_hold
from dashpot.preparation.motion import loading_in
from dashpot.records.creep import CreepCompliance, CreepTest, LoadHold
from dashpot.records.dynamic import DynamicTest
from dashpot.records.fit import Fit
from dashpot.records.machine import Machine
from dashpot.records.modulus import RelaxationModulus
from dashpot.records.relaxation import RampHold, RelaxationTest
from dashpot.records.specimen import Specimen
from dashpot.workflow.job import known_of_a_test

Record: TypeAlias = RampHold | DynamicTest | RelaxationModulus | LoadHold | CreepCompliance


def fit_files(
    files: Sequence[str | Path],
    *,
    arms: int | Literal["auto"] = "auto",
    method: Literal["full", "hold"] = "full",
    depth_law: bool = False,
    thorough: bool = False,
    law: Literal["auto", "linear", "nonlinear"] = "auto",
    filter: str | None = None,
    specimen: Specimen | None = None,
    machine: Machine | None = None,
    options: ReadOptions | None = None,
) -> tuple[Fit, tuple[Record, ...]]:
    """Fit one solid to the records in files, each in the way that suits it.

    Ramps and holds are fitted together; a dynamic (DMA) sweep alone or with ramps and holds of
    the same part; a relaxation modulus, or a creep test, alone.

    Parameters
    ----------
    files : sequence of path
    arms, method, thorough, law
        As in :func:`~dashpot.fitting.relaxation.fit`.
    depth_law : bool
        Tests of different depths share their relaxation times, and by method ``"full"`` an elastic
        law (:func:`~dashpot.fitting.depth.fit_depths`); each has its own stiffnesses.
    filter, machine : optional
        As in :func:`~dashpot.preparation.prepare.prepare`.
    specimen, options
        As in :func:`~dashpot.io.readers.relaxation.read_relaxation`; with a column of `modulus` the
        file is a relaxation modulus over time, and `cycle` is for preparation.

    Returns
    -------
    fit : Fit
    records : tuple of RampHold, DynamicTest, RelaxationModulus, LoadHold or CreepCompliance
        What is behind it, as fitted.

    Raises
    ------
    ReadError, DataError, FitError
        If a file cannot be read, prepared or fitted, or the choices exclude each other.
    """
    options = options or ReadOptions()
    if options.modulus is not None:
        known_of_a_test(machine, tests=0, add="a ramp and hold")
        if len(files) > 1 or depth_law or method == "hold" or filter:
            raise FitError(
                "a relaxation modulus is fitted one at a time, without --depth-law, --method hold "
                "and --filter: it is the answer to a step already"
            )
        curve = dp.read_modulus(files[0], options=options, specimen=specimen)
        with about(Path(files[0]).name):
            found = dp.fit_modulus(
                curve.time,
                curve.modulus,
                arms=arms,
                thorough=thorough,
                unit=curve.unit,
                source=curve.source,
                specimen=curve.specimen,
            )
        return found, (curve,)
    tests = [dp.read_bench(path, options=options, specimen=specimen) for path in files]
    crept = _creep(tests)
    if crept is not None:
        known_of_a_test(machine, tests=0, add="a ramp and hold")
        if len(tests) > 1 or filter:
            raise FitError("a creep test is fitted alone, without --filter")
        with about(Path(files[0]).name):
            record = load_hold(crept) if isinstance(crept, CreepTest) else crept
            found = dp.fit(
                record, arms=arms, method=method, depth_law=depth_law, thorough=thorough, law=law
            )
        return found, (record,)
    sweeps = [test for test in tests if isinstance(test, DynamicTest)]
    prepared = tuple(
        dp.prepare(test, filter=filter, machine=machine, cycle=options.cycle)
        for test in tests
        if isinstance(test, RelaxationTest)
    )
    known_of_a_test(machine, tests=len(prepared), add="a ramp and hold")
    if not sweeps:
        depths = {round(test.depth, 9) for test in prepared}
        if depth_law and method == "full" and len(depths) == len(prepared) > 1:
            return dp.fit_depths(prepared, arms=arms).fit, prepared
        found = dp.fit(
            prepared, arms=arms, method=method, depth_law=depth_law, thorough=thorough, law=law
        )
        return found, prepared
    if len(sweeps) > 1 or depth_law or method == "hold":
        raise FitError(
            "a dynamic sweep is fitted one at a time, alone or with relaxation tests of the "
            "same part, without --depth-law and --method hold"
        )
    asked = specimen.temperature if specimen and sweeps[0].several_temperatures else None
    found = dp.fit_dynamic(
        sweeps[0], arms=arms, tests=prepared, thorough=thorough, temperature=asked
    )
    return found, (*sweeps, *prepared)


def _creep(
    tests: Sequence[RelaxationTest | DynamicTest | CreepTest | CreepCompliance],
) -> CreepTest | CreepCompliance | None:
    """The first that is a creep test, by its file or by what its force and displacement do."""
    for one in tests:
        if isinstance(one, CreepTest | CreepCompliance):
            return one
        if isinstance(one, RelaxationTest):
            signals = one.time, one.displacement, one.force
            if loading_in(*signals) == "creep":
                return CreepTest(*signals, specimen=one.specimen, source=one.source)
    return None
