"""Choice of the fit for curves of a bench: sweeps, relaxation moduli, creep."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from dashpot.base.errors import FitError
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.relaxation import RampHold
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.curves.datamodel.stress_relaxation import StressRelaxationTest
from dashpot.fitting.fit_options import refuse_shifts
from dashpot.reading.raw_file import add_name_to_errors
from dashpot.registry import row_of
from dashpot.workflow.bench_tests import (
    Bench,
    BenchFitOptions,
    Record,
    prepare_ramps,
)
from dashpot.workflow.job import ShiftChoices, require_test_for_machine

if TYPE_CHECKING:
    from dashpot.extensions.curves.datamodel.creep import CreepCompliance, CreepTest, LoadHold
    from dashpot.extensions.curves.datamodel.dynamic import DynamicTest
    from dashpot.extensions.curves.datamodel.superposition import Superposition
    from dashpot.extensions.curves.superposition.isotherms import Measured


def fit_curves(
    tests: Sequence[Bench], options: BenchFitOptions, *, name: str = ""
) -> tuple[Fit, tuple[Record, ...]]:
    """Fit one solid to tests of which one at least is no ramp and hold.

    A sweep is fitted alone or with ramps and holds of the same part; a relaxation modulus, or a
    creep test, alone; sweeps or moduli at several temperatures by their master curve.
    """
    curves, creep_tests, relaxation_tests = (
        _select_kind(tests, text) for text in ("modulus", "creep", "relaxation")
    )
    if curves and isinstance(curves[0], StressRelaxationTest):
        return _fit_stress_relaxation(tests, options, name)
    if curves:
        _refuse_beside_modulus(options, other_count=len(tests) - len(curves))
        from dashpot.extensions.curves.modulus.fit import fit_modulus

        with _name_file(name):
            curve: Any = shift_to_one(curves, options.shifting, options.specimen)
            return fit_modulus(curve, arms=options.arms, thorough=options.thorough), (curve,)
    if creep_tests:
        _refuse_beside_creep(options, other_count=len(tests) - len(creep_tests))
        return _fit_creep(creep_tests, options, name)
    ramp_holds = prepare_ramps(relaxation_tests, options, among_others=True)
    return _fit_sweeps(_select_kind(tests, "dma"), ramp_holds, options)


def _fit_stress_relaxation(
    tests: Sequence[Bench], options: BenchFitOptions, name: str
) -> tuple[Fit, tuple[Record, ...]]:
    """Fit one test in strain and stress as a ramp and hold."""
    from dashpot.extensions.curves.modulus.stress_relaxation import fit_stress_relaxation

    if len(tests) > 1 or options.depth_law:
        raise FitError(
            "a relaxation test in strain and stress is fitted alone, without --elastic by-depth: "
            "fit the other tests one by one"
        )
    options.time_limits.refuse_several(len(tests))
    preparation_options = asdict(options.time_limits) | {
        "filter": options.filter, "machine": options.machine, "cycle": options.cycle,
        "with_checks": options.intervals,
    }  # fmt: skip
    test: Any = tests[0]
    with _name_file(name):
        return fit_stress_relaxation(test, preparation_options, **options.ramp_options.choices), (
            test,
        )


def _select_kind(tests: Sequence[Bench], name: str) -> list[Any]:
    """Return the tests of one kind, by the word of the registry."""
    return [test for test in tests if (row := row_of(test)) is not None and row.name == name]


def _name_file(name: str) -> AbstractContextManager[None]:
    """Return a context manager that puts the name of a file before an error."""
    return add_name_to_errors(name) if name else nullcontext()


def _refuse_beside_modulus(options: BenchFitOptions, *, other_count: int) -> None:
    """Refuse options of a ramp, and tests other than moduli."""
    require_test_for_machine(options.machine, tests=0, add="a ramp and hold")
    options.time_limits.refuse_several(0)
    if other_count:
        raise FitError(
            "a relaxation modulus is fitted alone, or with others at other temperatures: fit "
            "the other tests one by one"
        )
    is_default = options.has_defaults("method", "depth_law", "family")
    if options.filter or options.law == "nonlinear" or not is_default:
        raise FitError(
            "a relaxation modulus is fitted without --method hold, --elastic, --filter and "
            "--model: it is the response to a step already, of a linear model with arms"
        )


def _refuse_beside_creep(options: BenchFitOptions, *, other_count: int) -> None:
    """Refuse options of ramps and holds, and tests of another kind than creep."""
    options.time_limits.refuse_several(0)
    if other_count or options.filter or options.depth_law:
        raise FitError(
            "a creep test is fitted alone, or with others at other temperatures, without "
            "--filter and --elastic by-depth"
        )
    if not options.has_defaults("method", "law", "family"):
        raise FitError(
            "a creep test is fitted to its recorded force and to a linear model with arms: "
            "leave out --method, --elastic and --model"
        )


def _fit_creep(
    tests: Sequence[CreepTest | LoadHold | CreepCompliance], options: BenchFitOptions, name: str
) -> tuple[Fit, tuple[Record, ...]]:
    """Fit one creep test, or the master curve of several; `name` is the first file's."""
    from dashpot.extensions.curves.creep.compliance import measured_compliance
    from dashpot.extensions.curves.creep.fit import fit_creep
    from dashpot.extensions.curves.creep.preprocess import load_hold
    from dashpot.extensions.curves.datamodel.creep import CreepTest, LoadHold
    from dashpot.extensions.curves.datamodel.superposition import Superposition

    raw = sum(isinstance(test, CreepTest) for test in tests)
    require_test_for_machine(options.machine, tests=raw, add="a creep test as it was recorded")
    # a load that is not held says itself of which file it is
    held_loads = [
        load_hold(test, options.machine) if isinstance(test, CreepTest) else test for test in tests
    ]
    with _name_file(name):
        record: Any = held_loads[0]
        if len(held_loads) > 1 or not isinstance(record, LoadHold):
            curves = [
                measured_compliance(item) if isinstance(item, LoadHold) else item
                for item in held_loads
            ]
            record = shift_to_one(curves, options.shifting, options.specimen)
        if isinstance(record, LoadHold) and options.shifting.at is not None:
            raise FitError(
                "--at-temperature picks one of several temperatures, and this creep test is "
                "of one: leave it out"
            )
        if not isinstance(record, Superposition) and options.shifting.at is None:
            refuse_shifts("a creep test is", options.ramp_options)
        return fit_creep(record, arms=options.arms, thorough=options.thorough), (record,)


def _fit_sweeps(
    sweeps: Sequence[DynamicTest], tests: tuple[RampHold, ...], options: BenchFitOptions
) -> tuple[Fit, tuple[Record, ...]]:
    """Fit a sweep, or a master curve, with the ramps and holds of the same part."""
    if options.depth_law or options.method == "hold" or (tests and len(sweeps) > 1):
        raise FitError(
            "a dynamic sweep is fitted alone, with others at other temperatures, or with "
            "relaxation tests of the same part, without --elastic by-depth and --method hold"
        )
    if options.law != "auto" or (options.filter and not tests):
        raise FitError(
            "a dynamic sweep is of a linear model, and nothing of it is filtered: leave out "
            "--elastic and --filter, which are for ramps and holds"
        )
    from dashpot.extensions.curves.dynamic.fit import fit_dynamic

    sweep: Any = shift_to_one(sweeps, options.shifting, options.specimen)
    fit = fit_dynamic(
        sweep, arms=options.arms, tests=tests, thorough=options.thorough, family=options.family
    )
    return fit, (sweep, *tests)


def shift_to_one(
    tests: Sequence[Measured],
    choices: ShiftChoices,
    specimen: Specimen | None,
) -> Measured | Superposition:
    """Return the test as it is, the part of one temperature, or the master curve of them all.

    Raises
    ------
    FitError
        If the choices exclude each other, or the tests.
    """
    first, temperature = tests[0], choices.at
    if first.several_temperatures and specimen is not None and specimen.temperature is not None:
        raise FitError(
            "the file says the temperature of every sample, so --temperature has nothing to add: "
            "--at-temperature takes one of them alone, --reference moves their master curve"
        )
    single = len(tests) == 1 and choices == ShiftChoices(at=temperature)
    if temperature is not None:
        if not single:
            raise FitError(
                "--at-temperature takes one temperature out of a file of several; leave out "
                "--reference, --shift, --vertical and --shifts, which shift them all, and other "
                "files"
            )
        return first.select_temperature(temperature)
    if single and not first.several_temperatures:
        return first
    from dashpot.extensions.curves.superposition.read_shift_factors import read_shifts
    from dashpot.extensions.curves.superposition.superpose import superpose

    shifts = () if choices.shifts is None else read_shifts(choices.shifts)
    return superpose(
        tests,
        reference=choices.reference,
        law=choices.law,
        vertical=choices.vertical,
        shifts=shifts,
    )
