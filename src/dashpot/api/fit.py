"""Public functions that fit a viscoelastic model to records of one or several kinds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from pathlib import Path
from typing import Any, Literal, TypeAlias

from dashpot.api import call_with_options, show_stub_signature
from dashpot.base.errors import DataError, FitError
from dashpot.base.option_fields import FamilyOption, ShiftLaw, VerticalOption
from dashpot.base.units import Quantity, Range, convert_to_si, si_range
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.frf import FRF
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.relaxation import RampHold, RelaxationTest
from dashpot.datamodel.structure import FRFSet
from dashpot.datamodel.vibration_tests import ImpactTest, ShakenTest
from dashpot.fitting.identification.prior_knowledge import HammerRig, SolidPrior
from dashpot.registry import FITS, KINDS, find_handler, load_object, row_of
from dashpot.workflow.bench_tests import BenchFitOptions, fit_records
from dashpot.workflow.fit_routing import BENCH, find_selected_fit, route
from dashpot.workflow.identification import identify_solid
from dashpot.workflow.job import BlockOnSeals, HammerChoices, ShiftChoices, TimeLimits
from dashpot.workflow.measured_frf import Modes, measured_frf, modes_of_hits

Arms: TypeAlias = int | Literal["auto"]
Elastic: TypeAlias = Literal["auto", "linear", "nonlinear", "by-depth"]
Vibration: TypeAlias = ImpactTest | ShakenTest | FRF | FRFSet


@show_stub_signature
def fit(*records: Any, **options: Any) -> Any:
    """Fit the model for the records; several records must be of one part.

    Parameters
    ----------
    *records : RelaxationTest, CreepTest, DynamicTest, RelaxationModulus, ImpactTest, FRF, ...
        Relaxation and other quasi-static tests are fitted together. Hits and FRFs give modes; with
        a `mass` they give the model of the seal, alone or together with other tests or a fit.
    arms : int or "auto"
        Number of Maxwell arms.
    model : str
        ``"maxwell"``, ``"fractional"`` or ``"auto"``; of other kinds a law by its name.
    elastic : "auto", "linear", "nonlinear" or "by-depth"
        Elastic law of the ramp.
    method : "full" or "hold"
        Ramp and hold as recorded, or the paper's equation (5).
    mass : float or str, or a sequence of them
        Test mass, kg or ``"104g"``; a sequence has one mass for each FRF.
    seals : float
        Number of seals that carry the mass.
    levels : sequence
        Force amplitude of each FRF, N.
    density, shape
        Density, kg/m^3, and shape, ``"disc:20mm,20mm"``, of a rod under the mass.
    compression, compression_limits, force_limits, relaxation, poisson, terms, stretches
        Options of a kind of test, as in ``dashpot fit FILE --help``.

    Returns
    -------
    Fit
        For quasi-static tests, and for vibration under a mass.
    Modes
        For hits and FRFs without a mass.
    CLDResult, HyperelasticFit, IndentationFit, AmplitudeFit, AmplitudeResult, MassSeriesModes
        For other kinds of tests.

    Raises
    ------
    DataError, FitError
        If the records cannot be fitted together, or an option does not apply to them.

    Examples
    --------
    >>> import dashpot as dp
    >>> test, hits = dp.read("seal_8mm.csv"), dp.read("hammer.csv")
    >>> dp.fit(test, arms=2).model.arms
    2
    >>> round(dp.fit(hits)[0].frequency, 1)
    12.7
    >>> dp.fit(test, hits, mass="114.8g", seals=2).method
    'joint'
    """
    make_records = find_handler("make records", records[0]) if records else None
    if make_records is not None:
        records = make_records(records, options)
    kinds = identify_record_kinds(records)
    mass = options.get("mass")
    masses = len(mass) if isinstance(mass, list | tuple) else int(mass is not None)
    given_options = [
        name
        for name, value in options.items()
        if value is not None and not (isinstance(value, tuple) and not value)
    ]
    handler = route(kinds, masses=masses, selected=find_selected_fit(given_options))
    row = FITS.get(handler)
    word = row.records if row is not None else ""
    fitted = load_object(word or KINDS[next(iter(kinds.values()))].fits)
    subject = row.title if row and word else handler
    return call_with_options(
        fitted, list(records), options=options, subject=subject, error=FitError
    )


def identify_record_kinds(records: Sequence[Any]) -> Mapping[str, str]:
    """Return the kind of each record by its name: its file, or its position.

    Raises
    ------
    DataError
        If there is none, or one is no record.
    """
    if not records:
        raise DataError("there is nothing to fit. Give a record: dp.fit(dp.read(FILE))")
    entries: dict[str, str] = {}
    for number, record in enumerate(records, 1):
        if isinstance(record, list | tuple):
            raise DataError(
                "records are given one by one, not as a list: dp.fit(one, two), or dp.fit(*them)"
            )
        entries[_get_record_name(record, number, entries)] = kind_of(record)
    return entries


def kind_of(record: object) -> str:
    """Return the kind of a record, by the word of the register.

    Raises
    ------
    DataError
        If it is none.
    """
    if isinstance(record, Fit):
        return "fit"
    if isinstance(record, FRF):
        return "transmissibility" if record.quantity.over_base else "frf"
    if isinstance(record, FRFSet):
        return "frf"
    if isinstance(record, ShakenTest):
        return "impact"
    row = row_of(record)
    if row is None:
        if isinstance(record, str | Path):
            raise DataError(
                f"'{record}' is the name of a file, and no record. Read the file first: "
                f'dp.read("{record}")'
            )
        raise DataError(
            f"a {type(record).__name__} is no record that is fitted. Read a table first: "
            "dp.read(TABLE)"
        )
    return row.name


def _get_record_name(record: Any, number: int, entries: Mapping[str, str]) -> str:
    source = getattr(record, "source", None)
    group = source[0] if isinstance(source, tuple) and source else source
    name = getattr(group, "file", "") or f"record {number}"
    return name if name not in entries else f"{name} ({number})"


VIBRATION_RECORDS = (ImpactTest, ShakenTest, FRF, FRFSet)

# -- Functions of each route ----------------------------------------------------------------------


def fit_bench_tests(
    records: list[Any],
    *,
    arms: Arms = "auto",
    model: FamilyOption = "maxwell",
    elastic: Elastic = "auto",
    method: Literal["full", "hold"] = "full",
    thorough: bool = False,
    filter: str | None = None,
    time_limits: TimeLimits | None = None,
    machine: Machine | None = None,
    cycle: int | None = None,
    reference: Quantity | None = None,
    shift: ShiftLaw = "auto",
    vertical: VerticalOption = "auto",
    temperature: Quantity | None = None,
) -> Fit:
    """Fit the solid of tests on a bench."""
    by_depth = elastic == "by-depth"
    shifting = ShiftChoices(
        at=convert_to_si(temperature, "temperature"),
        reference=convert_to_si(reference, "temperature"),
        law=shift,
        vertical=vertical,
    )
    options = BenchFitOptions(
        arms=arms, method=method, depth_law=by_depth, thorough=thorough,
        law="auto" if elastic == "by-depth" else elastic, family=model, filter=filter,
        time_limits=time_limits or TimeLimits(), machine=machine, cycle=cycle, shifting=shifting,
    )  # fmt: skip
    return fit_records(records, options)[0]


def fit_hits(
    records: list[Any], *, band: Range | None = None, hammer: HammerChoices | None = None
) -> Modes:
    """Fit modes to hits without a mass."""
    result, _ = modes_of_hits(
        _require_single_measurement(records), hammer=hammer, band=si_range(band, "frequency")
    )
    return result


def fit_jointly(
    records: list[Any],
    *,
    mass: Quantity | Sequence[Quantity],
    seals: float | None = None,
    seal_mass: Quantity | None = None,
    arms: Arms = "auto",
    model: FamilyOption = "maxwell",
    band: Range | None = None,
    compression: Quantity | None = None,
    prior: SolidPrior | None = None,
    rig: HammerRig | None = None,
    machine: Machine | None = None,
    impact_temperature: Quantity | None = None,
    hammer: HammerChoices | None = None,
) -> Fit:
    """Fit the solid of vibration under a mass, alone or with tests on a bench."""
    block, *others = mass if isinstance(mass, list | tuple) else (mass,)
    if others:
        raise FitError(f"{len(others) + 1} masses are given for one measurement; give one mass=")
    kilograms, hertz = convert_to_si(block, "mass"), si_range(band, "frequency")
    bench = machine and machine.on_bench
    tests = [prepare_ramp_hold(record, bench) for record in records if kind_of(record) in BENCH]
    hammer_records = [record for record in records if isinstance(record, VIBRATION_RECORDS)]
    frf = frf_of(hammer_records, mass=kilograms, band=hertz, hammer=hammer)
    result = identify_solid(
        frf,
        BlockOnSeals(
            kilograms,
            1.0 if seals is None else seals,
            convert_to_si(seal_mass, "mass"),
            convert_to_si(compression, "length"),
        ),
        tests=tests,
        fits=[record for record in records if isinstance(record, Fit)],
        seals_assumed=seals is None,
        band=hertz,
        temperature=convert_to_si(impact_temperature, "temperature"),
        hammer=hammer,
        arms=arms,
        family=model,
        solid_prior=prior or SolidPrior(),
        rig=(rig or HammerRig()).with_machine(machine),
    )
    return replace(result.fit, evidence=replace(result.fit.evidence, checks=result.checks))


# -- Records of several functions -----------------------------------------------------------------


def prepare_ramp_hold(test: Any, machine: Machine | None = None) -> RampHold:
    """Return a ramp and hold prepared for a fit; one that is prepared stays as it is.

    Raises
    ------
    FitError
        If it is another test.
    """
    if isinstance(test, RampHold):
        return test
    if not isinstance(test, RelaxationTest):
        raise FitError(
            f"a {type(test).__name__} is not fitted together with vibration. Fit it alone, and "
            "give that fit: dp.fit(fit, hits, mass=...)"
        )
    from dashpot.preprocessing.prepare import prepare

    return prepare(test, machine=machine)


def frf_of(
    measured: Sequence[Any],
    *,
    mass: float | None = None,
    band: tuple[float, float] | None = None,
    hammer: HammerChoices | None = None,
) -> FRF:
    """Return the FRF of a hammer test, or a measured FRF, with the metadata of its file."""
    measurement = _require_single_measurement(measured)
    if isinstance(measurement, FRFSet):
        raise FitError("one FRF is fitted under a mass: choose its point")
    return measured_frf(measurement, choices=hammer or HammerChoices(), mass=mass, band=band)


def _require_single_measurement(measured: Sequence[Any]) -> Any:
    """Return what was measured: one record, or hits in several."""
    if len(measured) == 1:
        return measured[0]
    if all(isinstance(item, ImpactTest) for item in measured):
        return list(measured)
    raise FitError(
        f"{len(measured)} records of vibration are no one measurement. Give one FRF, or hits alone"
    )


def shape_words(shape: str | Any) -> dict[str, Any]:
    """Return the shape of a part as its options have it: ``{"disc": "20mm,20mm"}``.

    Raises
    ------
    DataError
        If it is no shape.
    """
    if not isinstance(shape, str):
        metres = (getattr(shape, field.name) for field in fields(shape) if not field.kw_only)
        return {type(shape).__name__.lower(): ",".join(f"{metre!r}m" for metre in metres)}
    name, colon, lengths = shape.partition(":")
    if not colon or name not in {"disc", "block", "bush", "bulb"}:
        raise DataError(f"shape='{shape}': expected a shape with its lengths, disc:20mm,20mm")
    return {name: lengths}
