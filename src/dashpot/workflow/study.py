"""Study of a seal: one result from a relaxation test and a hammer test."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.checks import Check, Verdict, verdict
from dashpot.base.errors import DataError, FitError, ReadError
from dashpot.base.number_format import hertz, seals
from dashpot.base.plain_text import paragraph
from dashpot.base.progress import send_progress
from dashpot.base.result_mixins import Plottable
from dashpot.base.serialisation import EVERY_FIELD, Serialisable
from dashpot.base.units import Quantity, Range, format_quantity, si_range
from dashpot.datamodel.bounds import FRFBounds, StiffnessBounds
from dashpot.datamodel.fit import (
    Fit,
    get_fewest_arms_model,
    get_fitted_mass,
    get_hammer_stiffness_factor,
)
from dashpot.datamodel.frf import FRF
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.relaxation import RampHold, RelaxationTest
from dashpot.datamodel.specimen import make_file_specimens
from dashpot.datamodel.vibration_tests import ImpactTest
from dashpot.fitting.fit_options import FitOptions
from dashpot.fitting.identification.identify import identify
from dashpot.fitting.identification.prior_knowledge import HammerRig
from dashpot.fitting.prediction_bounds import parameter_band, unresolved_arm_band
from dashpot.fitting.relaxation import fit
from dashpot.reading.readers.relaxation import read_relaxation
from dashpot.vibration.comparison.comparison_result import Comparison
from dashpot.vibration.mass_on_seals import (
    FREQUENCY_FACTOR,
    MassOnSeals,
    OperatingPoint,
    compute_peak_limit,
    predict_frf,
)
from dashpot.vibration.modal.dynamic_stiffness import DynamicStiffness, dynamic_stiffness
from dashpot.vibration.modal.peaks import find_peak
from dashpot.workflow.bench_tests import fit_fixed_order, prepared_tests
from dashpot.workflow.checks import hold_fit_possible, prediction_in_valid_band
from dashpot.workflow.frf_comparison import compare_with_measured, find_mass_on_seals
from dashpot.workflow.job import BlockOnSeals, Job, TimeLimits
from dashpot.workflow.measured_frf import read_measured, remove_seal_mass, total_mass
from dashpot.workflow.stiffness_under_mass import (
    StaticEquilibrium,
    family_checks,
    find_static_equilibrium,
    frf_limits,
    replace_by_alternative,
    rest_checks,
)

# Logo of a report, as a data URI.


LARGEST_LOGO = 100_000
"""Bytes."""

LOGO_TYPES = {b"\x89PNG\r\n\x1a\n": "image/png", b"\xff\xd8\xff": "image/jpeg"}


def read_logo(path: str | Path) -> str:
    """Return an image as a data URI; an SVG in an image element runs no script.

    Raises
    ------
    ReadError
        If the file is no PNG, JPEG or SVG, or too large.
    """
    with Path(path).open("rb") as file:
        content = file.read(LARGEST_LOGO + 1)
    name = Path(path).name
    if len(content) > LARGEST_LOGO:
        raise ReadError(
            f"{name} is larger than {LARGEST_LOGO} bytes; expected a small image: shrink the logo"
        )
    kind = next((kind for head, kind in LOGO_TYPES.items() if content.startswith(head)), "")
    head = content.removeprefix(b"\xef\xbb\xbf").lstrip()[:2000]
    if not kind and head.startswith((b"<?xml", b"<!", b"<svg")) and b"<svg" in head:
        kind = "image/svg+xml"
    if not kind:
        raise ReadError(f"{name} is no supported image; expected PNG, JPEG or SVG")
    import base64

    return f"data:{kind};base64,{base64.b64encode(content).decode()}"


COMPARED_ORDERS = (1, 2)
"""The numbers of arms that the paper's Fig. 4 compares."""

STIFFNESS_LINES = np.geomspace(1e-3, 100.0, 61)
"""Frequencies of the band of unresolved arms, Hz: from the hold to above the hammer test."""


BAND_LINES, PEAK_LINES = 61, 121
"""Number of lines of the limits of the predicted FRF, in the whole band, and near the peak."""


@dataclass(frozen=True, repr=False)
class Study(Plottable, Serialisable):
    """Study: all results of the main job.

    Attributes
    ----------
    test, prepared : RelaxationTest, RampHold
        The relaxation test as recorded and as fitted.
    fit : Fit
        The chosen solid of one seal.
    alternatives : tuple of Fit
        The fits with one and with two arms, as in the paper's Fig. 4.
    hold_fit : Fit or None
        The same number of arms by the paper's eq. (5) on the hold alone; None if refused.
    seals : float
        How many such seals (or how many times the tested length) carry the mass.
    mass : float or None
        kg; None if unknown.
    mass_inferred : bool
        True if the mass was taken from the measured FRF, so that the frequency proves nothing.
    prediction : FRF or None
        Accelerance of the mass on the seals.
    impact : ImpactTest or None
    measured : FRF or None
        The FRF of the hammer test.
    comparison : Comparison or None
    joint : Fit or None
        Relaxation and FRF fitted together.
    joint_prediction : FRF or None
    joint_comparison : Comparison or None
    unmeasured : StiffnessBounds or None
        The widest stiffness and loss over all spectra that the relaxation test cannot reject.
    parameters : StiffnessBounds or None
        What the standard errors of `fit` alone allow: the formal band.
    direct : DynamicStiffness or None
        Stiffness of one seal directly from the measured FRF, without a model of it.
    static_equilibrium : StaticEquilibrium or None
        Where the mass rests on the seals, and what secant and tangent make of it.
    frf_band : FRFBounds or None
        Limits of the predicted accelerance, by standard errors and unresolved arms.
    checks : tuple of Check
        Checks that need several of the tests.
    other_tests : tuple of RampHold
        Tests of the same seal at other temperatures, fitted with `prepared`.
    title, logo : str
        Title of its report, and a logo as a data URI.

    Examples
    --------
    >>> import dashpot as dp
    >>> dp.report(dp.simulate("relaxation", hold="5s", noise_free=True), arms=2).joint is None
    True
    """

    schema = "dashpot/study@2"
    _keys = ("verdict", EVERY_FIELD, "unmeasured", "static_equilibrium", "other_tests")

    test: RelaxationTest
    prepared: RampHold
    fit: Fit
    alternatives: tuple[Fit, ...]
    hold_fit: Fit | None
    seals: float
    mass: float | None
    mass_inferred: bool
    prediction: FRF | None
    impact: ImpactTest | None
    measured: FRF | None
    comparison: Comparison | None
    joint: Fit | None = None
    joint_prediction: FRF | None = None
    joint_comparison: Comparison | None = None
    unmeasured: StiffnessBounds | None = None
    parameters: StiffnessBounds | None = None
    direct: DynamicStiffness | None = None
    frf_band: FRFBounds | None = None
    static_equilibrium: StaticEquilibrium | None = None
    checks: tuple[Check, ...] = ()
    title: str = ""
    logo: str = ""
    other_tests: tuple[RampHold, ...] = ()

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """The verdict, the mass, the solid, and the peaks."""
        solid = self.fit if self.joint is None else self.joint
        final_comparison = self.comparison if self.joint is None else self.joint_comparison
        mass = "no mass" if self.mass is None else format_quantity(self.mass, "g", ".6g")
        return (
            str(self.verdict),
            f"{mass} on {seals(self.seals)}; {solid.model} ({solid.unit}, s), {solid.method}",
            *(
                ()
                if final_comparison is None
                else (
                    f"{quantity} {by_model}, measured {measured}, {difference}"
                    for quantity, by_model, measured, difference in final_comparison.rows
                )
            ),
        )

    @property
    def rival(self) -> FRF | None:
        """FRF of the other model family, if it fits the relaxation test equally well."""
        other = replace_by_alternative(self.fit)
        if other is None or self.mass is None or self.static_equilibrium is None:
            return None
        point = self.static_equilibrium.point
        at = point.compression if point.is_stated else None
        return predict_frf(other, mass=self.mass, seals=self.seals, compression=at)

    @property
    def every_check(self) -> tuple[Check, ...]:
        """The checks of the fit, of the hammer test, of their comparison, and of the study."""
        hammer = () if self.measured is None else self.measured.checks
        comparison_checks = () if self.comparison is None else self.comparison.checks
        return (*self.fit.checks, *hammer, *comparison_checks, *self.checks)

    @property
    def verdict(self) -> Verdict:
        """Verdict on the study's solid: the joint fit's where there is one, else the fit's.

        A prediction from the relaxation test that misses the hammer test does not count against
        the joint fit, which corrects it.
        """
        return verdict(self.verdict_checks, headline=self._headline_text)

    @property
    def verdict_checks(self) -> tuple[Check, ...]:
        """The checks behind the verdict, each once."""
        hammer = () if self.measured is None else self.measured.checks
        solid, comparison = self.fit, self.comparison
        if self.joint is not None:
            solid, comparison = self.joint, self.joint_comparison
        comparison_checks = () if comparison is None else comparison.checks
        of_test = self.fit.checks
        if solid.evidence.alternative is not None:
            # model families: both tests decide, not the relaxation test alone
            own_checks = {check.name for check in solid.checks} & {"model_families_distinguished"}
            of_test = tuple(check for check in of_test if check.name not in own_checks)
        all_checks = (*of_test, *hammer, *solid.checks, *comparison_checks, *self.checks)
        return tuple(dict.fromkeys(all_checks))

    @property
    def _headline_text(self) -> str:
        """The headline of the study if no important check failed."""
        if self.joint is not None and self.joint_comparison is not None:
            sentence_start = f"From {hertz(self.joint.band)} one model matches both tests"
            return paragraph(sentence_start, self.joint_comparison.resonance_match)
        if self.joint is None and self.comparison is not None:
            return self.comparison.message
        return (self.joint or self.fit)._headline


@dataclass(frozen=True, eq=False)
class FittedTests:
    """Relaxation tests of a study, and the results that do not depend on the mass.

    Attributes
    ----------
    tests : tuple of RampHold
    fit : Fit
        Fit of all of them, at the temperature of the seals under the hammer.
    """

    tests: tuple[RampHold, ...]
    fit: Fit

    @cached_property
    def hold_fit(self) -> tuple[Fit | None, tuple[Check, ...]]:
        """Fit of the paper's eq. (5) to one test; else the check with the reason."""
        if len(self.tests) > 1:
            return None, ()
        arms = get_fewest_arms_model(self.fit).arms
        try:
            return fit(self.tests, arms=arms, method="hold"), ()
        except (DataError, FitError) as error:
            return None, (hold_fit_possible(str(error)),)

    @cached_property
    def alternatives(self) -> tuple[Fit, ...]:
        """Fits with other numbers of arms."""
        prepared = self.tests[find_reference_test(self.fit, self.tests)]
        arm_count = self.fit.model.arms if self.fit.family == "maxwell" else 0
        return tuple(
            self.fit if arms == arm_count else fit_fixed_order(prepared, arms)
            for arms in COMPARED_ORDERS
        )

    @cached_property
    def unmeasured_arm_limits(self) -> StiffnessBounds:
        """Limits of the stiffness over every spectrum that the tests do not exclude."""
        return unresolved_arm_band(self.fit, self.tests, STIFFNESS_LINES)


def fit_tests(
    tests: tuple[RelaxationTest, ...],
    options: FitOptions,
    temperature: Quantity | None,
    **preparation: Any,
) -> FittedTests:
    """Return the relaxation tests of a study, prepared as :func:`characterise` says, and fitted."""
    prepared = prepared_tests(tests, **preparation)
    fitted = fit(prepared, **options.choices)
    return FittedTests(
        prepared, fitted if temperature is None else fitted.at_temperature(temperature)
    )


def characterise(
    test: RelaxationTest,
    measured: FRF | None = None,
    *,
    block: BlockOnSeals = BlockOnSeals(),  # noqa: B008
    tests: Sequence[RelaxationTest] = (),
    impact: ImpactTest | None = None,
    options: FitOptions = FitOptions(),  # noqa: B008
    time_limits: TimeLimits | None = None,
    band: Range | None = None,
    filter: str | None = None,
    cycle: int | None = None,
    machine: Machine | None = None,
    joint: bool = True,
    impact_temperature: Quantity | None = None,
    fit_once: Callable[..., FittedTests] = fit_tests,
) -> Study:
    """Return the study of the main job: prepare, fit, predict, compare, and fit both tests jointly.

    Parameters
    ----------
    test : RelaxationTest
        One seal, ramp and hold.
    measured : FRF, optional
        FRF of a mass on the seals.
    block : BlockOnSeals
        Its mass is inferred from `measured`, and labelled so, if missing.
    tests : sequence of RelaxationTest
        Tests of the same seal, to be fitted with `test`, such as a cold one.
    impact : ImpactTest, optional
        The hits behind `measured`, kept for the report.
    options : FitOptions
        Options of the fit of the tests; a number of arms is that of the joint fit, too.
    filter, cycle, machine
        As in :func:`~dashpot.preprocessing.prepare.prepare`.
    time_limits : TimeLimits, optional
        Time limits of the relaxation test, by hand.
    band : (float, float), optional
        Lines to compare, Hz.
    joint : bool
        Whether to fit relaxation and FRF together, too.
    impact_temperature : float, optional
        Temperature of the seals under the hammer, K; by default that of the solid of the tests.
    fit_once : callable
        Cached replacement of :func:`fit_tests`.

    Raises
    ------
    DataError, FitError
        If a test cannot be prepared, fitted or compared.
    """
    band = si_range(band, "frequency")
    mass, mass_checks = total_mass(block)
    send_progress("fitting the relaxation test")
    fitted = fit_once(
        (test, *tests), options, impact_temperature, filter=filter, time_limits=time_limits,
        cycle=cycle, machine=_select_bench_machine(machine, measured),
    )  # fmt: skip
    fitted_records, chosen_fit = fitted.tests, fitted.fit
    # the test at the temperature of the solid is shown
    first = find_reference_test(chosen_fit, fitted_records)
    test, prepared = (test, *tests)[first], fitted_records[first]
    load = None if mass is None else MassOnSeals(mass, block.seals, block.compression)
    if measured is not None:
        measured = remove_seal_mass(measured, block)
        load = find_mass_on_seals(chosen_fit, measured, block, band=band)
    response, mended = _MassResponse(), _JointResults()
    if load is not None:
        response = _predict_mass_response(chosen_fit, fitted_records, measured, load, band)
        if joint and measured is not None:
            send_progress("fitting the joint model of relaxation and hammer test")
            usual_options = replace(options, arms="auto", family="maxwell")
            earlier_fit, number = _select_earlier_fit(
                chosen_fit, fitted_records, options.arms, usual_options, impact_temperature
            )
            joint_fit = identify(
                measured, tests=fitted_records, fit=earlier_fit, mass=mass, seals=load.seals,
                band=band, compression=response.compression if mass is None else load.compression,
                arms=number, family=options.family, rig=HammerRig().with_machine(machine),
                bench=usual_options,
            )  # fmt: skip
            fitted_mass = (
                get_fitted_mass(joint_fit) or load.mass,
                load.seals * get_hammer_stiffness_factor(joint_fit),
            )
            mass_on_seals = MassOnSeals(*fitted_mass, load.compression)
            mended = _JointResults(
                joint_fit, *_predict_and_compare(joint_fit, measured, mass_on_seals, band)
            )
    send_progress("computing bounds over the spectra that the tests do not exclude")
    hold_fit, checks = fitted.hold_fit
    return Study(
        test=test,
        prepared=prepared,
        fit=chosen_fit,
        alternatives=fitted.alternatives,
        hold_fit=hold_fit,
        seals=block.seals,
        mass=None if load is None else load.mass,
        mass_inferred=mass is None and load is not None,
        impact=impact,
        measured=measured,
        unmeasured=fitted.unmeasured_arm_limits,
        parameters=parameter_band(chosen_fit, STIFFNESS_LINES),
        checks=(*checks, *response.untested, *mass_checks),
        other_tests=(*fitted_records[:first], *fitted_records[first + 1 :]),
        prediction=response.prediction,
        comparison=response.comparison,
        static_equilibrium=response.at_rest,
        frf_band=response.frf_band,
        direct=response.direct,
        **mended._asdict(),
    )


def _select_bench_machine(machine: Machine | None, measured: FRF | None) -> Machine | None:
    """Return the machine of the bench tests, without the rig of a hammer test."""
    return machine if machine is None or measured is None else machine.on_bench


def _select_earlier_fit(
    chosen_fit: Fit,
    tests: Sequence[RampHold],
    arms: int | Literal["auto"],
    bench: FitOptions,
    temperature: Quantity | None,
) -> tuple[Fit, int | Literal["auto"]]:
    """Return the fit of the tests for the joint fit, and its number of arms.

    A requested number of arms is that of the joint fit, as in ``dashpot fit``, unless the fit of
    the tests has more arms: then it is ``"auto"``.
    """
    if arms == "auto":
        return chosen_fit, arms
    local_fit = fit(tests, **bench.choices)
    if temperature is not None:
        local_fit = local_fit.at_temperature(temperature)
    return local_fit, arms if arms >= local_fit.model.arms else "auto"


class _MassResponse(NamedTuple):
    """Predicted and measured response of the mass on the seals; None where missing."""

    prediction: FRF | None = None
    comparison: Comparison | None = None
    at_rest: StaticEquilibrium | None = None
    frf_band: FRFBounds | None = None
    direct: DynamicStiffness | None = None
    untested: tuple[Check, ...] = ()

    @property
    def compression(self) -> float | None:
        """Compression of the seals under the mass, m."""
        return None if self.at_rest is None else self.at_rest.point.compression


class _JointResults(NamedTuple):
    """Results of the joint fit of both tests, and its mass; None where missing."""

    joint: Fit | None = None
    joint_prediction: FRF | None = None
    joint_comparison: Comparison | None = None


def _predict_mass_response(
    chosen_fit: Fit,
    tests: Sequence[RampHold],
    measured: FRF | None,
    load: MassOnSeals,
    band: tuple[float, float] | None,
) -> _MassResponse:
    prediction, comparison = _predict_and_compare(chosen_fit, measured, load, band)
    rest_state = find_static_equilibrium(chosen_fit, load)
    return _MassResponse(
        prediction,
        comparison,
        rest_state,
        _prediction_bounds(chosen_fit, tests, measured, rest_state.point, load),
        None
        if measured is None
        else dynamic_stiffness(measured, load.mass, seals=load.seals, band=band),
        ()
        if measured is not None
        else _check_untested_prediction(prediction, chosen_fit, rest_state, load),
    )


def find_reference_test(chosen_fit: Fit, tests: Sequence[RampHold]) -> int:
    """Return which test is of the temperature of the fit's solid; the first if all are of one."""
    if chosen_fit.temperatures is None:
        return 0
    reference = chosen_fit.temperatures.reference
    return min(
        range(len(tests)), key=lambda i: abs((tests[i].specimen.temperature or 0.0) - reference)
    )


def run(
    job: Job,
    *,
    read: Callable[..., RelaxationTest] = read_relaxation,
    measure: Callable[..., tuple[ImpactTest | None, FRF]] = read_measured,
    fit_once: Callable[..., FittedTests] = fit_tests,
) -> Study:
    """Read the files of a job and characterise the seal.

    `read`, `measure` and `fit_once` replace the reader of the relaxation tests, the reader of the
    hammer files and the fit by cached versions.
    """
    files = job.relaxation, *job.other_tests
    send_progress(f"reading {_format_file_names(files)}")
    test, *tests = (
        read(file, options=job.reading, specimen=specimen)
        for file, specimen in zip(
            files, make_file_specimens(job.specimen, job.temperatures, len(files)), strict=True
        )
    )
    impact = measured = None
    mass, _ = total_mass(job.block)
    if job.impact:
        send_progress(f"reading {_format_file_names(job.impact)}")
        impact, measured = measure(
            job.impact, choices=job.hammer, options=job.reading_impact, mass=mass, band=job.band
        )
    study = characterise(
        test,
        measured,
        block=job.block,
        tests=tests,
        impact=impact,
        options=job.fit_options,
        time_limits=job.time_limits,
        band=job.band,
        filter=job.filter,
        cycle=job.reading.cycle,
        machine=job.machine,
        joint=job.joint,
        impact_temperature=job.impact_temperature,
        fit_once=fit_once,
    )
    logo = "" if job.logo is None else read_logo(job.logo)
    return replace(study, title=job.title, logo=logo)


def _format_file_names(files: Sequence[str]) -> str:
    return ", ".join(Path(file).name for file in files)


def _predict_and_compare(
    fit: Fit, measured: FRF | None, load: MassOnSeals, band: tuple[float, float] | None
) -> tuple[FRF, Comparison | None]:
    """Return the FRF that a fit predicts, on the measured lines if there are any."""
    if measured is None:
        return predict_frf(fit, **load.keywords), None
    return compare_with_measured(fit, measured, load, band=band)


def _check_untested_prediction(
    prediction: FRF, chosen_fit: Fit, rest_state: StaticEquilibrium, load: MassOnSeals
) -> tuple[Check, ...]:
    """Return the checks of a prediction that no hammer test validates."""
    band_check = prediction_in_valid_band(find_peak(prediction).frequency, chosen_fit.band)
    return (
        *rest_checks(rest_state.point, load.mass),
        band_check,
        *family_checks(chosen_fit, rest_state.point, load),
    )


def _prediction_bounds(
    chosen_fit: Fit,
    prepared: Sequence[RampHold],
    measured: FRF | None,
    point: OperatingPoint,
    load: MassOnSeals,
) -> FRFBounds:
    """Return limits of the predicted FRF near its peak: standard errors and unresolved arms."""
    top = compute_peak_limit(load.seals * point.solid(chosen_fit).k_0, load.mass)
    low, high = top / FREQUENCY_FACTOR, top * FREQUENCY_FACTOR
    if measured is not None:
        low, high = max(low, measured.frequency[0]), min(high, measured.frequency[-1])
    near_peak = np.geomspace(max(low, 0.75 * top), min(high, 1.3 * top), PEAK_LINES)
    lines = np.union1d(
        np.geomspace(low, high, BAND_LINES), near_peak if near_peak[0] < near_peak[-1] else ()
    )
    return frf_limits(chosen_fit, prepared, point, load, frequency=lines)
