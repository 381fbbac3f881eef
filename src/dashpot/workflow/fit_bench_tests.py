"""Which fit suits which record: from files to the solid behind them."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from dashpot.base.choices import FamilyAsked, Method, RampLawAsked
from dashpot.base.errors import FitError, ReadError
from dashpot.base.option_fields import like, part
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.relaxation import RampHold, RelaxationTest
from dashpot.datamodel.specimen import Specimen, each_specimen
from dashpot.fitting.fit_options import refuse_shifts
from dashpot.fitting.relaxation import fit as fit_relaxation
from dashpot.reading.columns.kind_detection import other_kind
from dashpot.reading.raw_file import about
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.detect_kind import recognise
from dashpot.registry import FIT_FILES, KINDS, load, row_of
from dashpot.workflow.job import Cuts, Job, known_of_a_test
from dashpot.workflow.prepare_tests import prepared_tests
from dashpot.workflow.shift_options import ShiftChoices, one_temperature, shifted_ramps

if TYPE_CHECKING:
    from dashpot.extensions.curves.datamodel.creep import CreepCompliance, CreepTest, LoadHold
    from dashpot.extensions.curves.datamodel.dynamic import DynamicTest
    from dashpot.extensions.curves.datamodel.modulus import RelaxationModulus
    from dashpot.extensions.curves.datamodel.superposition import Superposition

    Bench: TypeAlias = (
        RelaxationTest | RampHold | DynamicTest | RelaxationModulus | CreepTest | LoadHold
        | CreepCompliance
    )  # fmt: skip
    Record: TypeAlias = (
        RampHold | DynamicTest | RelaxationModulus | LoadHold | CreepCompliance | Superposition
    )


@dataclass(frozen=True)
class BenchAsked:
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

    arms: int | Literal["auto"] = like(Job, "arms")
    method: Method = like(Job, "method")
    depth_law: bool = False
    thorough: bool = False
    law: RampLawAsked = like(Job, "law")
    family: FamilyAsked = like(Job, "family")
    intervals: bool = True
    filter: str | None = like(Job, "filter")
    cuts: Cuts = part(Cuts)
    machine: Machine | None = None
    cycle: int | None = None
    shifting: ShiftChoices = part(ShiftChoices)
    specimen: Specimen | None = None

    def nothing_of(self, *names: str) -> bool:
        """Whether each of these is left at what it is where nothing is said."""
        return all(getattr(self, name) == getattr(BenchAsked, name) for name in names)

    def refuse_beside_a_modulus(self, *, others: int) -> None:
        """Refuse what belongs to a ramp, and tests that are no moduli."""
        self.refuse_a_machine()
        if others:
            raise FitError(
                "a relaxation modulus is fitted alone, or with others at other temperatures: fit "
                "the other tests one by one"
            )
        usual = self.nothing_of("method", "depth_law", "family")
        if self.filter or self.law == "nonlinear" or not usual:
            raise FitError(
                "a relaxation modulus is fitted without --method hold, --elastic, --filter and "
                "--model: it is the response to a step already, of a linear solid with arms"
            )

    def refuse_a_machine(self) -> None:
        """Refuse what is known of a ramp and hold alone."""
        known_of_a_test(self.machine, tests=0, add="a ramp and hold")
        self.cuts.refuse_several(0)

    def refuse_beside_creep(self, *, others: int) -> None:
        """Refuse what is of ramps and holds, and tests that are none of creep."""
        self.cuts.refuse_several(0)
        if others or self.filter or self.depth_law:
            raise FitError(
                "a creep test is fitted alone, or with others at other temperatures, without "
                "--filter and --elastic by-depth"
            )
        if not self.nothing_of("method", "law", "family"):
            raise FitError(
                "a creep test is fitted to its recorded force and to a linear solid with arms: "
                "leave out --method, --elastic and --model"
            )


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
        Fields of :class:`BenchAsked`.

    Returns
    -------
    fit : Fit
    records : tuple of RampHold, DynamicTest, RelaxationModulus, LoadHold, CreepCompliance or
        Superposition
        What is behind it, as fitted.

    Raises
    ------
    ReadError, DataError, FitError
        If a file cannot be read, prepared or fitted, or the choices exclude each other.
    """
    options = options or ReadOptions()
    each = each_specimen(specimen, temperatures, len(files))
    tests = [read_test(path, options, one) for path, one in zip(files, each, strict=True)]
    said = BenchAsked(**asked, cycle=options.cycle, specimen=each[0])
    return fit_records(tests, said, name=Path(files[0]).name)


def fit_records(
    tests: Sequence[Bench], asked: BenchAsked, *, name: str = ""
) -> tuple[Fit, tuple[Record, ...]]:
    """Fit one solid to the records of a bench, as :func:`fit_files` does to those in files.

    Ramps and holds are fitted together, also such as are prepared; a dynamic (DMA) sweep alone or
    with ramps and holds of the same part; a relaxation modulus, or a creep test, alone; sweeps or
    moduli at several temperatures by their master curve. `name`, of the first file, stands before
    what is wrong.
    """
    curves, crept, pressed = (_of_kind(tests, one) for one in ("modulus", "creep", "relaxation"))
    if curves:
        asked.refuse_beside_a_modulus(others=len(tests) - len(curves))
        from dashpot.extensions.curves.modulus.fit import fit_modulus

        with _named(name):
            curve: Any = one_temperature(curves, asked.shifting, asked.specimen)
            return fit_modulus(curve, arms=asked.arms, thorough=asked.thorough), (curve,)
    if crept:
        asked.refuse_beside_creep(others=len(tests) - len(crept))
        return _crept(crept, asked, name)
    prepared = prepared_tests(
        pressed, filter=asked.filter, machine=asked.machine, cuts=asked.cuts, cycle=asked.cycle,
        judged=asked.intervals or len(pressed) < len(tests),
        each_depth=asked.depth_law and len(pressed) == len(tests),
    )  # fmt: skip
    known_of_a_test(asked.machine, tests=len(prepared), add="a ramp and hold")
    if len(pressed) == len(tests):
        return _pressed(prepared, asked), prepared
    return _swept(_of_kind(tests, "dma"), prepared, asked)


def _of_kind(tests: Sequence[Bench], name: str) -> list[Any]:
    """The tests of one kind, by the word of the register."""
    return [one for one in tests if (row := row_of(one)) is not None and row.name == name]


def _named(name: str) -> AbstractContextManager[None]:
    return about(name) if name else nullcontext()


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
    found = recognise(path, options)
    row = KINDS.get(found.kind, KINDS["relaxation"])
    if row.fit != FIT_FILES:
        with about(Path(path).name):
            raise ReadError(other_kind(found.kind, found.reason, "a test of a bench is"))
    test: Bench = load(row.reader)(path, options=options, specimen=specimen)
    return test


def _crept(
    tests: Sequence[CreepTest | LoadHold | CreepCompliance], asked: BenchAsked, name: str
) -> tuple[Fit, tuple[Record, ...]]:
    """Fit one creep test, or the master curve of several; `name` is the first file's."""
    from dashpot.extensions.curves.creep.compliance import measured_compliance
    from dashpot.extensions.curves.creep.fit import fit_creep
    from dashpot.extensions.curves.creep.preprocess import load_hold
    from dashpot.extensions.curves.datamodel.creep import CreepTest, LoadHold
    from dashpot.extensions.curves.datamodel.superposition import Superposition

    raw = sum(isinstance(one, CreepTest) for one in tests)
    known_of_a_test(asked.machine, tests=raw, add="a creep test as it was recorded")
    # a load that is not held says itself of which file it is
    held = [load_hold(one, asked.machine) if isinstance(one, CreepTest) else one for one in tests]
    with _named(name):
        record: Any = held[0]
        if len(held) > 1 or not isinstance(record, LoadHold):
            curves = [
                measured_compliance(one) if isinstance(one, LoadHold) else one for one in held
            ]
            record = one_temperature(curves, asked.shifting, asked.specimen)
        if isinstance(record, LoadHold) and asked.shifting.at is not None:
            raise FitError(
                "--only picks one of several temperatures, and this creep test is of one: leave "
                "it out"
            )
        if not isinstance(record, Superposition) and asked.shifting.at is None:
            refuse_shifts("a creep test is", **shifted_ramps(asked.shifting))
        return fit_creep(record, arms=asked.arms, thorough=asked.thorough), (record,)


def _pressed(tests: tuple[RampHold, ...], asked: BenchAsked) -> Fit:
    """Fit ramps and holds together, or, where a law of the depth is asked for, each by itself."""
    if not asked.depth_law:
        return fit_relaxation(
            tests,
            arms=asked.arms,
            method=asked.method,
            thorough=asked.thorough,
            law=asked.law,
            family=asked.family,
            intervals=asked.intervals,
            **shifted_ramps(asked.shifting),
        )
    usual = asked.nothing_of("method", "law", "family")
    if not usual or asked.thorough or asked.shifting != ShiftChoices():
        raise FitError(
            "a law of the depth is of arms of one temperature, found from ramps and holds with "
            "starts of its own: leave out --method, --elastic, --model, --thorough, --reference, "
            "--shift, --vertical, --only and --shifts"
        )
    from dashpot.fitting.depth_dependence import fit_depths

    return fit_depths(tests, arms=asked.arms).fit


def _swept(
    sweeps: Sequence[DynamicTest], tests: tuple[RampHold, ...], asked: BenchAsked
) -> tuple[Fit, tuple[Record, ...]]:
    """Fit a sweep, or a master curve, with the ramps and holds of the same part."""
    if asked.depth_law or asked.method == "hold" or (tests and len(sweeps) > 1):
        raise FitError(
            "a dynamic sweep is fitted alone, with others at other temperatures, or with "
            "relaxation tests of the same part, without --elastic by-depth and --method hold"
        )
    if asked.law != "auto" or (asked.filter and not tests):
        raise FitError(
            "a dynamic sweep is of a linear solid, and nothing of it is filtered: leave out "
            "--elastic "
            "and --filter, which are for ramps and holds"
        )
    from dashpot.extensions.curves.dynamic.fit import fit_dynamic

    sweep: Any = one_temperature(sweeps, asked.shifting, asked.specimen)
    found = fit_dynamic(
        sweep, arms=asked.arms, tests=tests, thorough=asked.thorough, family=asked.family
    )
    return found, (sweep, *tests)


def of_order(test: RampHold, arms: int, *, method: Method = "full") -> Fit:
    """The optimum with so many arms alone, which is drawn, not judged."""
    return fit_relaxation(test, arms=arms, method=method, intervals=False)
