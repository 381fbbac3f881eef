"""Cache of a job's results, looked up by the job."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import fields, replace
from functools import lru_cache
from typing import Any

from dashpot.base.arrays import replace_notes
from dashpot.base.errors import DashpotError, FitError
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.frf import FRF
from dashpot.datamodel.relaxation import RampHold, RelaxationTest
from dashpot.datamodel.specimen import make_file_specimens
from dashpot.datamodel.vibration_tests import ImpactTest, ShakenTest
from dashpot.extensions.app import record_cache
from dashpot.extensions.app.preview_fit import refit_nearby
from dashpot.fitting.relaxation import fit
from dashpot.reading.read_options import ReadOptions
from dashpot.vibration.impact.checks import mass_shown
from dashpot.vibration.mass_on_seals import compute_peak_limit
from dashpot.workflow.bench_tests import prepared_tests
from dashpot.workflow.frf_prediction import Prediction, prediction
from dashpot.workflow.job import HammerChoices, Job, TimeLimits
from dashpot.workflow.measured_frf import measured_frf, read_record
from dashpot.workflow.study import FittedTests, Study, find_reference_test, fit_tests, run


def select_options(job: Job, *stages: str) -> Job:
    """Return what of a job decides its ``"test"`` as prepared, or the ``"fit"`` of that."""
    names = [field.name for field in fields(job) if field.metadata.get("stage") in stages]
    return Job(**{name: getattr(job, name) for name in names})


MAX_CACHED = 8
"""Results of each kind that a worker remembers."""
MAX_QUICK_SAMPLES = 300_000
"""Samples that are fitted at first; all of them are next."""
MAX_PREVIEW_SAMPLES = 20_000
"""Samples that are fitted while a handle is held: its curves are to follow."""

read_test = lru_cache(MAX_CACHED)(record_cache.read_relaxation_test)
"""The relaxation test in a file."""


def read_tests(job: Job) -> tuple[RelaxationTest, ...]:
    """Return the tests of a job, each with its stated temperature, if any."""
    files = job.relaxation, *job.other_tests
    specimens = make_file_specimens(job.specimen, job.temperatures, len(files))
    return tuple(
        read_test(file, options=job.reading, specimen=specimen)
        for file, specimen in zip(files, specimens, strict=True)
    )


@lru_cache(MAX_CACHED)
def prepare_job_tests(job: Job, max_samples: int | None) -> tuple[RampHold, ...]:
    """Return the prepared tests of a job, each of at most `max_samples`, or of all samples."""
    full_tests = read_tests(job)
    if max_samples is not None and all(len(test.time) <= max_samples for test in full_tests):
        return prepare_job_tests(job, None)
    downsampled_tests = [downsample_test(test, max_samples) for test in full_tests]
    return prepared_tests(
        downsampled_tests,
        with_checks=max_samples != MAX_PREVIEW_SAMPLES,
        filter=job.filter,
        machine=job.machine,
        time_limits=_shorten_hold(job.time_limits, full_tests, downsampled_tests),
        cycle=job.reading.cycle,
    )


def _shorten_hold(
    limits: TimeLimits,
    full_tests: Sequence[RelaxationTest],
    downsampled_tests: Sequence[RelaxationTest],
) -> TimeLimits:
    """Return the limits with a hold that ends by the last sample of those that are left.

    One that ends beyond the whole record stays what it is, and is refused.
    """
    record_end, last_sample = (
        min(float(test.time[-1]) for test in tests) for tests in (full_tests, downsampled_tests)
    )
    if limits.hold_end is None or not last_sample < limits.hold_end <= record_end:
        return limits
    return replace(limits, hold_end=last_sample)


def downsample_test(
    test: RelaxationTest, max_samples: int | None = MAX_QUICK_SAMPLES
) -> RelaxationTest:
    """Return the test with every n-th sample, so that at most `max_samples` are left."""
    step = 1 if max_samples is None else -(-len(test.time) // max_samples)
    if step == 1:
        return test
    signals = {name: getattr(test, name)[::step] for name in ("time", "displacement", "force")}
    return replace(test, **signals)


@lru_cache(MAX_CACHED)
def fit_job(job: Job, intervals: bool, max_samples: int | None) -> Fit:
    """Return the fit of a job's tests; with its intervals and checks if requested."""
    return fit(
        prepare_job_tests(select_test_choices(job), max_samples),
        **replace(job.fit_options, intervals=intervals).choices,
    )


_previous_fits: dict[Job, Fit] = {}
"""Fits: for each job without its cuts, the fit of the cut before."""


def fit_while_dragging(job: Job) -> Fit:
    """The fit while a handle is held: of a linear solid the one next to that of the cut before."""
    uncut_job = replace(job, time_limits=TimeLimits())
    tests = prepare_job_tests(select_test_choices(job), MAX_PREVIEW_SAMPLES)
    previous_fit, preview = _previous_fits.get(uncut_job), None
    if previous_fit is not None and len(tests) == 1 and _can_refit(previous_fit, job):
        with suppress(FitError):
            preview = refit_nearby(tests[0], previous_fit)
    if len(_previous_fits) > MAX_CACHED:
        _previous_fits.clear()
    _previous_fits[uncut_job] = preview or fit_job(job, job.arms == "auto", MAX_PREVIEW_SAMPLES)
    return _previous_fits[uncut_job]


def _can_refit(previous_fit: Fit, job: Job) -> bool:
    """Whether only the number of arms was requested, and nothing that a cut could change."""
    law = previous_fit.elastic_law
    has_linear_law = law is not None and law.kind == "linear" and previous_fit.family == "maxwell"
    return (
        has_linear_law and previous_fit.method == job.method and previous_fit.model.arms == job.arms
    )


def fit_by_eq5(job: Job, fit: Fit, max_samples: int | None = None) -> Fit | None:
    """Return the fit of one test by eq. (5) with as many arms; None if it is impossible."""
    if fit.family != "maxwell" or job.other_tests:
        return None
    hold_job = replace(select_test_choices(job), arms=fit.model.arms, method="hold")
    try:
        return (
            fit_while_dragging(hold_job)
            if max_samples == MAX_PREVIEW_SAMPLES
            else fit_job(hold_job, False, max_samples)
        )
    except DashpotError:
        return None


def select_shown_test(
    job: Job, fit: Fit, max_samples: int | None = None
) -> tuple[RelaxationTest, RampHold]:
    """Return the test that is drawn: that of the temperature of the solid."""
    prepared_tests = prepare_job_tests(select_test_choices(job), max_samples)
    test_index = find_reference_test(fit, prepared_tests)
    return read_tests(job)[test_index], prepared_tests[test_index]


def prepare_uncut_test(job: Job, prepared: RampHold) -> RampHold | None:
    """Return the test of a job to its last sample, for the eye, where its hold is cut by hand."""
    if job.time_limits.hold_end is None or job.other_tests:
        return None
    uncut_job = replace(
        select_test_choices(job), time_limits=replace(job.time_limits, hold_end=None)
    )
    try:
        (record,) = prepare_job_tests(uncut_job, MAX_QUICK_SAMPLES)
    except DashpotError:
        return None
    return record if record.time[-1] > prepared.time[-1] else None


_fitted_tests: dict[tuple[Any, ...], tuple[tuple[RelaxationTest, ...], FittedTests]] = {}
"""Fitted records by their identity and the options of the fit."""


def fit_study_tests(
    tests: tuple[RelaxationTest, ...], *choices: Any, **preparation: Any
) -> FittedTests:
    """Return the relaxation tests of a study, fitted; another mass or band leaves them as they are.

    Records are distinguished by identity; each entry holds its records, so no identity is reused.
    """
    key = (*map(id, tests), *choices, *preparation.items())
    if key not in _fitted_tests:
        while len(_fitted_tests) >= MAX_CACHED:
            del _fitted_tests[next(iter(_fitted_tests))]
        _fitted_tests[key] = tests, fit_tests(tests, *choices, **preparation)
    return _fitted_tests[key][1]


_ANY_MASS = 1.0
"""Placeholder mass, kg, of a check that is replaced later."""


@lru_cache(MAX_CACHED)
def _read_hammer(paths: tuple[str, ...], options: ReadOptions) -> FRF | ShakenTest | ImpactTest:
    return read_record(paths, options)


@lru_cache(MAX_CACHED)
def _average_hits(
    paths: tuple[str, ...],
    choices: HammerChoices,
    options: ReadOptions,
    band: tuple[float, float] | None,
) -> FRF:
    """Return the FRF of hits, whose check of the mass is of another mass."""
    return measured_frf(_read_hammer(paths, options), choices=choices, mass=_ANY_MASS, band=band)


def measure_hammer(
    paths: Sequence[str],
    *,
    choices: HammerChoices,
    options: ReadOptions,
    mass: float | None,
    band: tuple[float, float] | None,
) -> tuple[ImpactTest | None, FRF]:
    """Return the result of :func:`.read_measured`; another mass reads no file and averages no hit.

    Of hits it decides over one check alone.
    """
    record = _read_hammer(tuple(paths), options)
    if not isinstance(record, ImpactTest):
        return None, measured_frf(record, choices=choices, mass=mass, band=band)
    frf = _average_hits(tuple(paths), choices, options, band)
    main_mode = next(iter(frf.modes(band=band)), None)
    mass_checks = () if mass is None else (mass_shown(frf, main_mode, mass),)
    checks = tuple(
        replacement
        for check in frf.checks
        for replacement in (mass_checks if check.name == "high_frequency_mass_agrees" else (check,))
    )
    # the modes that are kept with the FRF stay with it
    return record, replace_notes(frf, checks=checks)


@lru_cache(MAX_CACHED)
def get_study(job: Job) -> Study:
    """Return the whole story of a job."""
    return run(job, read=read_test, measure=measure_hammer, fit_once=fit_study_tests)


@lru_cache(MAX_CACHED)
def predict_base_motion(job: Job) -> Prediction:
    r"""The transmissibility to the mass of a job, as ``dashpot predict FIT --base`` predicts it.

    By the solid of both tests if they are fitted together; where the job names no band, to either
    side of the highest frequency of the peak, :math:`\sqrt{n k_0 / m} / 2\pi`.

    Raises
    ------
    DataError
        If the mass is not known.
    """
    job_study = get_study(job)
    block = replace(job.block, mass=job_study.mass, seal_mass=None)
    solid = job_study.joint or job_study.fit
    peak_limit = compute_peak_limit(job.seals * solid.solid.k_0, block.weighed_mass)
    return prediction(
        solid,
        block=block,
        band=job.band or (float(f"{peak_limit / 5:.2g}"), float(f"{4 * peak_limit:.2g}")),
        base=True,
    )


def select_test_choices(job: Job) -> Job:
    """Return the fields of a job on which the prepared test depends."""
    return select_options(job, "test")


def select_fit_choices(job: Job) -> Job:
    """Return the fields of a job on which the fit of the relaxation test depends."""
    return select_options(job, "test", "fit")
