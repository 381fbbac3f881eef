"""Public functions that predict the response of a mass or door and compare it with measurements."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from dashpot.api import call_with_options, refuse_wrong_options, show_stub_signature
from dashpot.api.fit import (
    Arms,
    Vibration,
    frf_of,
    kind_of,
    prepare_ramp_hold,
    shape_words,
)
from dashpot.api.read_save import Place
from dashpot.base.errors import DataError
from dashpot.base.option_fields import FamilyOption, Method, RampLawOption
from dashpot.base.result_mixins import HasVerdict
from dashpot.base.units import Quantity, Range, convert_to_si, si_range
from dashpot.base.value_ranges import SIZES, require_positive
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.frf import FRF
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.relaxation import RampHold, RelaxationTest
from dashpot.datamodel.specimen import Specimen
from dashpot.datamodel.structure import FRFSet
from dashpot.datamodel.vibration_tests import ImpactTest
from dashpot.fitting.fit_options import FitOptions
from dashpot.registry import find_handler, load_object, require_handler, row_of
from dashpot.workflow.frf_comparison import FRFComparison, agreement
from dashpot.workflow.frf_prediction import DEFAULT_BAND, Prediction, prediction
from dashpot.workflow.job import BlockOnSeals, HammerChoices, LevelChoices, PartChoices, TimeLimits

if TYPE_CHECKING:
    from dashpot.datamodel.seal_line import Shear, Stations
    from dashpot.solids.maxwell import Solid
    from dashpot.solids.part_geometry import Geometry
    from dashpot.vibration.comparison.comparison_result import Comparison
    from dashpot.workflow.study import Study


Records: TypeAlias = RelaxationTest | RampHold | Sequence[RelaxationTest | RampHold]
To: TypeAlias = Literal[
    "nastran", "abaqus", "ansys", "lsdyna", "radioss", "calculix", "opensees", "adams",
    "statespace", "csv", "fmu", "modelica", "felupe", "optistruct", "comsol",
]  # fmt: skip


@show_stub_signature
def predict(solid: Any, /, **options: Any) -> Any:
    """Predict how a solid vibrates under a mass, on a moving base, at an amplitude, or in a door.

    Parameters
    ----------
    solid : Fit, a solid or Door
        A fit gives an FRF with uncertainty and checks, a model without data an FRF alone.
    mass : float or str
        Test mass, kg or ``"104g"``.
    seals : float
        Number of seals that carry the mass.
    band : (float, float) or str
        Hz, ``"1:50Hz"``.
    base : bool or str
        Whether the base moves; a text is its power spectral density: a file, or ``"0.01g^2/Hz"``.
    compression, temperature, shape, level, sweep, record
        As in ``dashpot predict --help``; `record` is the test behind the fit.
    frequency : float or str, or sequence of them
        For storage, loss and loss factor there without a mass, Hz or ``"12.71Hz"``; `records` are
        then the tests behind the fit.
    close : float or str
        For a door: the speed at its edge, m/s.
    leak : bool
        For a door: the speed of the car at which its seal lifts.
    drop : float or str
        For a mass dropped on a specimen: its impact speed, m/s, or its drop height, ``"18mm"``.

    Returns
    -------
    Prediction, FRF, StiffnessPrediction, DropPrediction, DoorResult, ClosingResult or LeakResult

    Raises
    ------
    DataError
        If an option does not apply, or the mass is implausible.

    Examples
    --------
    >>> import dashpot as dp
    >>> fit = dp.fit(dp.read("seal_8mm.csv"), arms=2)
    >>> predicted = dp.predict(fit, mass="114.8g", seals=2, band=(1, 50))
    >>> round(predicted.modes[0].frequency, 1)
    12.2
    """
    predict_result = _find_prediction(solid, options)
    subject = f"the prediction of a {type(solid).__name__}"
    return call_with_options(predict_result, solid, options=options, subject=subject)


def _find_prediction(solid: Any, options: Iterable[str]) -> Callable[..., Any]:
    """Return the function that predicts from a result, given the names of its options."""
    row = row_of(solid)
    if row is not None and row.predict:
        function: Callable[..., Any] = load_object(row.predict)
        return function
    predict_special = find_handler("predict", solid)
    if predict_special is None and isinstance(solid, Fit):
        by_option = (find_handler("predict with option", option) for option in options)
        predict_special = next(filter(None, by_option), None)
    if predict_special is not None:
        predict: Callable[..., Any] = predict_special
        return predict
    if isinstance(solid, Fit):
        return _predict_under_mass
    if not hasattr(solid, "complex_stiffness"):
        raise DataError(
            f"a {type(solid).__name__} is neither a fit nor a model. Fit a test first: "
            "dp.fit(dp.read(FILE)); read a stored fit: dp.read(FIT)"
        )
    return _predict_solid_frf


def _predict_solid_frf(
    solid: Solid,
    *,
    mass: Quantity,
    seals: float = 1.0,
    band: Range | None = None,
    lines: int = 2001,
    quantity: str = "accelerance",
) -> FRF:
    import numpy as np

    from dashpot.vibration.mass_on_seals import predict_frf

    require_positive(lines=lines)
    hertz = np.linspace(*(si_range(band, "frequency") or DEFAULT_BAND), lines)
    kilograms = convert_to_si(mass, "mass")
    SIZES["mass"].refuse(kilograms)
    return predict_frf(seals * solid, mass=kilograms, frequency=hertz, kind=quantity)


def _predict_under_mass(
    fit: Fit,
    *,
    mass: Quantity,
    seals: float = 1.0,
    seal_mass: Quantity | None = None,
    band: Range | None = None,
    lines: int = 2001,
    quantity: str | None = None,
    base: bool | str = False,
    relative: bool = False,
    compression: Quantity | None = None,
    temperature: Quantity | None = None,
    shape: str | Geometry | None = None,
    level: Quantity | Sequence[Quantity] = (),
    sweep: Any = None,
    height: Quantity | None = None,
    record: Records = (),
    machine: Machine | None = None,
) -> Prediction:
    part = PartChoices(**shape_words(shape)) if shape is not None else None
    level_list = (level,) if isinstance(level, str | float | int) else tuple(level)
    levels = tuple(f"{item!r}{'m/s^2' if base else 'N'}" if not isinstance(item, str) else item
                   for item in level_list)  # fmt: skip
    choices = LevelChoices(levels=levels, height=convert_to_si(height, "length"))
    if sweep is not None and not levels:
        raise DataError("sweep= is what a level does to the part: add level=")
    fitted_sweep = None
    if sweep is not None:
        fit_sweep = require_handler("predict with sweep", sweep)
        fitted_sweep = fit_sweep(sweep, choices, unit=fit.unit, part=part)
    return prediction(
        fit,
        _prepare_tests(record, machine),
        block=BlockOnSeals(
            convert_to_si(mass, "mass"),
            seals,
            convert_to_si(seal_mass, "mass"),
            convert_to_si(compression, "length"),
        ),
        band=si_range(band, "frequency"),
        lines=lines,
        kind=quantity,
        base=bool(base),
        relative=relative,
        temperature=convert_to_si(temperature, "temperature"),
        part=part,
        at_level=choices,
        swept=fitted_sweep,
        base_psd=base if isinstance(base, str) else None,
    )


def _prepare_tests(record: Records, machine: Machine | None = None) -> list[RampHold]:
    """Return the tests behind a fit, prepared."""
    tests = (record,) if isinstance(record, RelaxationTest | RampHold) else record
    return [prepare_ramp_hold(test, machine) for test in tests]


@show_stub_signature
def compare(first: Any, other: Any, /, **options: Any) -> Any:
    """Compare a prediction with a measurement, two FRFs, or two lots.

    Parameters
    ----------
    first : Fit, Prediction, FRF or Lot
    other : ImpactTest, FRF or Lot
    mass, seals : optional
        Test mass, and number of seals that carry it; a prediction has both. A missing mass is
        inferred from the measurement, with a note.
    band : optional
        Frequencies to compare, Hz.

    Raises
    ------
    DataError
        If the two cannot be compared.

    Examples
    --------
    >>> import dashpot as dp
    >>> fit, hits = dp.fit(dp.read("seal_8mm.csv"), arms=2), dp.read("hammer.csv")
    >>> dp.compare(fit, hits, mass="114.8g", seals=2).verdict.use
    'do not use'
    """
    compare_special = find_handler("compare", first)
    if compare_special is not None and type(first) is type(other):
        return call_with_options(compare_special, first, other, options=options, subject="two lots")
    if isinstance(first, FRF) and isinstance(other, FRF):
        return call_with_options(_compare_frfs, first, other, options=options, subject="two FRFs")
    measured = isinstance(other, ImpactTest | FRF) or (
        not isinstance(other, FRFSet)
        and find_handler("compare", other) is None
        and kind_of(other) == "impact"
    )
    if isinstance(first, Fit | Prediction) and measured:
        subject = "a prediction and a measurement"
        return call_with_options(
            _compare_with_measurement, first, other, options=options, subject=subject
        )
    raise DataError(
        f"a {type(first).__name__} is not compared with a {type(other).__name__}. Compare a fit or "
        "a prediction with hits or an FRF, an FRF with an FRF, or a lot with a lot. Read a file "
        "first: dp.read(FILE)"
    )


def _compare_frfs(first: FRF, other: FRF, *, band: Range | None = None) -> Comparison:
    from dashpot.vibration.comparison.compare import compare as compare_frfs

    return compare_frfs(first, other, band=si_range(band, "frequency"))


def _compare_with_measurement(
    first: Fit | Prediction,
    second: Any,
    *,
    mass: Quantity | None = None,
    seals: float | None = None,
    seal_mass: Quantity | None = None,
    band: Range | None = None,
    compression: Quantity | None = None,
    record: Records = (),
    hammer: HammerChoices | None = None,
) -> FRFComparison:
    kilograms, at = convert_to_si(mass, "mass"), convert_to_si(compression, "length")
    if isinstance(first, Prediction):
        kilograms = first.moving_mass if kilograms is None else kilograms
        seals = first.seals if seals is None else seals
        point = first.static_equilibrium.point
        at = point.compression if at is None and point.is_stated else at
        first = first.fit
    hertz = si_range(band, "frequency")
    return agreement(
        first,
        frf_of([second], mass=kilograms, band=hertz, hammer=hammer),
        BlockOnSeals(
            kilograms, 1.0 if seals is None else seals, convert_to_si(seal_mass, "mass"), at
        ),
        tests=_prepare_tests(record),
        band=hertz,
    )


@refuse_wrong_options
def report(
    *records: RelaxationTest | Vibration,
    mass: Quantity | None = None,
    seals: float = 1.0,
    arms: Arms = "auto",
    method: Method = "full",
    model: FamilyOption = "maxwell",
    elastic: RampLawOption = "auto",
    band: Range | None = None,
    filter: str | None = None,
    time_limits: TimeLimits | None = None,
    cycle: int | None = None,
    machine: Machine | None = None,
    joint: bool = True,
    compression: Quantity | None = None,
    impact_temperature: Quantity | None = None,
    hammer: HammerChoices | None = None,
    title: str = "",
) -> Study:
    """Fit, predict, compare and fit together; ``.save("report.html")`` writes the page.

    Parameters
    ----------
    *records : RelaxationTest, and ImpactTest or FRF
        Tests of one seal, and hits or an FRF of a mass on such seals.
    mass : float or str, optional
        Test mass, kg; inferred from the hits, with a note, if missing.
    seals, arms, method, model, elastic, band, filter, time_limits, cycle, machine, compression
        As in ``dp.fit``.
    impact_temperature, hammer
        As in ``dp.fit``, for the hits.
    joint : bool
        Whether to fit tests and hits together as well.
    title : str
        Title of the page.

    Raises
    ------
    DataError, FitError
        If there is no relaxation test, or one cannot be prepared, fitted or compared.

    Examples
    --------
    >>> import dashpot as dp
    >>> study = dp.report(dp.read("seal_8mm.csv"), arms=2)
    >>> study.fit.model.arms, study.joint
    (2, None)
    """
    from dashpot.workflow.study import characterise

    tests = [record for record in records if isinstance(record, RelaxationTest)]
    hammer_records = [record for record in records if not isinstance(record, RelaxationTest)]
    if not tests:
        raise DataError("a report is of a relaxation test. Give one: dp.report(test, hits)")
    kilograms, hertz = convert_to_si(mass, "mass"), si_range(band, "frequency")
    measured = impact = None
    if hammer_records:
        measured = frf_of(hammer_records, mass=kilograms, band=hertz, hammer=hammer)
        impact = (
            hammer_records[0]
            if isinstance(hammer_records[0], ImpactTest) and len(hammer_records) == 1
            else None
        )
    study = characterise(
        tests[0],
        measured,
        block=BlockOnSeals(kilograms, seals, compression=convert_to_si(compression, "length")),
        tests=tests[1:],
        impact=impact,
        options=FitOptions(arms, method, elastic, model),
        time_limits=time_limits,
        band=hertz,
        filter=filter,
        cycle=cycle,
        machine=machine,
        joint=joint,
        impact_temperature=impact_temperature,
    )
    return replace(study, title=title)


@refuse_wrong_options
def export(
    solid: Fit | Solid | HasVerdict,
    path: Place | None = None,
    /,
    *,
    to: To,
    unit_system: Literal["SI", "mm-t-s", "mm-kg-ms", "in-lbf-s"] | None = None,
    temperature: Quantity | None = None,
    length: Quantity | None = None,
    seals: float = 1.0,
    compression: Quantity | None = None,
    band: Range | None = None,
    form: str | None = None,
    allow: str | Sequence[str] = (),
    mass: Quantity | None = None,
    tolerance: float | None = None,
    nominal: Quantity | None = None,
    line: Stations | None = None,
    shear: Shear | None = None,
    first_id: int | None = None,
    first_tag: int | None = None,
    modulus: Quantity | None = None,
    bulk_modulus: Quantity | None = None,
    density: float | None = None,
    points: int | None = None,
    specimen: Specimen | None = None,
    overwrite: bool = False,
) -> str:
    """Write a solid as input for a solver, and return the deck.

    Parameters
    ----------
    solid : Fit, a solid, HyperelasticFit or AmplitudeResult
    path : path, optional
        File of the deck.
    to : str
        The solver: ``"nastran"``, ``"abaqus"``...
    unit_system : str
        Unit system of the deck: ``"SI"``, ``"mm-t-s"``, ``"mm-kg-ms"`` or ``"in-lbf-s"``.
    temperature, length : float or str
        Temperature of the seal, K or ``"23degC"``, and its contact length, m or ``"50mm"``.
    specimen : Specimen, optional
        Instead of temperature and length.
    seals, compression
        Number of parallel seals, and their static compression.
    band : (float, float) or str, optional
        Frequencies of a table, Hz.
    tolerance, nominal, line, shear, first_id, first_tag, modulus, bulk_modulus, density, points
        Options of some solvers, as in ``dashpot export --help``.
    allow : str or sequence of str
        Problems to ignore, by their names, or ``"all"``; the header of the deck lists them.
    overwrite : bool
        Whether to replace a file that dashpot did not write.

    Raises
    ------
    ExportError
        If what the solver needs is not stated, the data do not determine a parameter, or the file
        exists and dashpot did not write it.

    Examples
    --------
    >>> import dashpot as dp
    >>> fit = dp.fit(dp.read("seal_8mm.csv"), arms=2)
    >>> deck = dp.export(
    ...     fit, to="nastran", unit_system="mm-t-s", temperature="23degC", length="100mm"
    ... )
    >>> "PBUSHT" in deck
    True
    """
    from dashpot.export import deck_for
    from dashpot.solids.maxwell import Solid

    model: Any = getattr(solid, "fit", solid) if not isinstance(solid, Fit) else solid
    kelvin, metres = convert_to_si(temperature, "temperature"), convert_to_si(length, "length")
    if metres is not None:
        model = _set_contact_length(model, metres)
    choices: dict[str, Any] = {
        "form": form,
        "frequency_range": si_range(band, "frequency"),
        "mass": convert_to_si(mass, "mass"),
        "allow": (allow,) if isinstance(allow, str) else tuple(allow),
        "units": unit_system,
        "tolerance": tolerance,
        "nominal": nominal,
        "line": line,
        "shear": shear,
        "first_id": first_id,
        "first_tag": first_tag,
        "modulus": modulus,
        "bulk_modulus": bulk_modulus,
        "density": density,
        "points": points,
    }
    if specimen is not None:
        choices["specimen"] = specimen
    elif isinstance(model, Solid):
        choices["specimen"] = Specimen(temperature=kelvin, length=metres)
    deck = deck_for(
        to,
        model,
        seals=seals,
        compression=convert_to_si(compression, "length"),
        temperature=kelvin,
        **choices,
    )
    if path is not None:
        from dashpot.workflow.outputs import Outputs

        Outputs(replace=overwrite).write(path, deck.file_content)
    return str(deck)


def _set_contact_length(result: Any, metres: float) -> Any:
    """Return the fit of a piece whose length in contact is known; a bare model has no specimen."""
    if not hasattr(result, "specimen"):
        return result
    specimen = replace(result.specimen, length=metres)
    if hasattr(result, "provenance"):
        return replace(result, provenance=replace(result.provenance, specimen=specimen))
    return replace(result, specimen=specimen)
