"""Which fit suits which record, and what a seal adds to the mass."""

from __future__ import annotations

from dataclasses import fields, replace
from inspect import signature

import numpy as np
import pytest
from kit import hardening
from kit.fits import a_fit

from dashpot.base.errors import FitError, ReadError
from dashpot.datamodel.frf import FRF
from dashpot.datamodel.specimen import Specimen
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.relaxation import read_relaxation, relaxation_in
from dashpot.reading.text import rows
from dashpot.reading.write import write_relaxation
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.solids.demo_seals import PAPER
from dashpot.solids.elastic import ElasticLaw
from dashpot.vibration.impact.frf_estimation import estimate_frf
from dashpot.vibration.mass_on_seals import MassOnSeals, operating_point, predict_frf
from dashpot.workflow.bench_tests import fit_files
from dashpot.workflow.example_files import EXAMPLES
from dashpot.workflow.frf_comparison import compare_files, find_mass_on_seals
from dashpot.workflow.frf_prediction import predict_files
from dashpot.workflow.identification import identify_files
from dashpot.workflow.inspections import inspect_files
from dashpot.workflow.job import BlockOnSeals, HammerChoices, ShiftChoices
from dashpot.workflow.measured_frf import total_mass
from dashpot.workflow.stiffness_under_mass import _slide_limits


@pytest.fixture(scope="module")
def seal(tmp_path_factory):
    path = tmp_path_factory.mktemp("bench") / "seal.csv"
    path.write_text(write_relaxation(simulate_relaxation(PAPER, hold_time=5.0).test))
    return path


@pytest.fixture(scope="module")
def two_depths(tmp_path_factory):
    folder, paths = tmp_path_factory.mktemp("depths"), []
    for depth in (4e-3, 8e-3):
        paths.append(folder / f"{1e3 * depth:.0f}mm.csv")
        made = simulate_relaxation(PAPER, depth=depth, hold_time=5.0)
        paths[-1].write_text(write_relaxation(made.test))
    return paths


@pytest.fixture(scope="module")
def sweep(tmp_path_factory):
    path = tmp_path_factory.mktemp("dma") / "sweep.csv"
    rows = [(f, 1e6 * f**0.1, 1e5 * f**0.1) for f in (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50)]
    head = "frequency [Hz],storage modulus [Pa],loss modulus [Pa]"
    path.write_text("\n".join([head, *(",".join(map(str, row)) for row in rows)]) + "\n")
    return path


def test_fit_files_uses_the_relaxation_fit_for_ramp_and_hold(seal):
    result, (test,) = fit_files([seal], arms=1)
    assert result.method == "full"
    assert test.depth == pytest.approx(8e-3, rel=0.01)
    assert fit_files([seal], arms=1, method="hold")[0].method == "hold"


def test_depth_law_applies_or_refuses_options(two_depths):
    result, _ = fit_files(two_depths, arms=2, depth_law=True)
    assert [at.depth for at in result.evidence.stiffness_by_depth] == pytest.approx(
        [4e-3, 8e-3], rel=0.01
    )
    choices = (
        {"method": "hold"}, {"law": "linear"}, {"law": "nonlinear"}, {"family": "auto"},
        {"thorough": True}, {"shifting": ShiftChoices(law="wlf")},
    )  # fmt: skip
    for choice in choices:
        with pytest.raises(FitError, match="leave out --method, --elastic, --model, --thorough"):
            fit_files(two_depths, depth_law=True, **choice)
    with pytest.raises(FitError, match="a depth law needs at least two depths"):
        fit_files(two_depths[:1], depth_law=True)


def test_a_sweep_is_fitted_as_a_sweep(sweep):
    result, (data,) = fit_files([sweep], arms=2)
    assert result.method == "dynamic"
    assert len(data.frequency) == 9


@pytest.mark.parametrize("choice", [{"depth_law": True}, {"method": "hold"}])
def test_a_sweep_excludes_what_belongs_to_a_hold(sweep, choice):
    with pytest.raises(FitError, match="a dynamic sweep is fitted alone"):
        fit_files([sweep], arms=2, **choice)


@pytest.mark.parametrize("choice", [{"law": "nonlinear"}, {"filter": "median:3"}])
def test_a_sweep_is_not_bent_and_not_filtered(sweep, choice):
    with pytest.raises(FitError, match="leave out --elastic and --filter"):
        fit_files([sweep], arms=2, **choice)


@pytest.mark.parametrize(
    "choice",
    [
        {"depth_law": True},
        {"method": "hold"},
        {"filter": "x"},
        {"law": "nonlinear"},
        {"family": "auto"},
    ],
)
def test_a_modulus_excludes_what_belongs_to_a_ramp(tmp_path, choice):
    curve = tmp_path / "curve.csv"
    curve.write_text(EXAMPLES["curve.csv"]())
    with pytest.raises(FitError, match="a relaxation modulus is fitted without"):
        fit_files([curve], **choice)


def test_the_moving_mass_is_the_block_and_a_third_of_the_seals():
    mass, (check,) = total_mass(BlockOnSeals(0.1, 2, 0.003))
    assert mass == pytest.approx(0.102)
    assert check.name == "seal_mass_negligible"
    assert total_mass(BlockOnSeals(0.1, 2)) == (0.1, ())
    assert total_mass(BlockOnSeals(None, 2, 0.003)) == (None, ())


def test_identify_files_refuses_a_fit_with_its_test():
    choices = {"hammer": HammerChoices(), "options": ReadOptions()}
    with pytest.raises(ReadError, match="leave the fit out"):
        identify_files(
            ["hits.csv"], BlockOnSeals(0.1), fits=[a_fit(PAPER)], tests=["seal.csv"], **choices
        )


def test_an_inspection_says_what_preparation_sees(seal, sweep):
    inspections = inspect_files([seal, sweep])
    assert inspections.files[0].preparation.ramp_time == pytest.approx(1.0, abs=0.02)
    assert inspections.files[1].preparation is None
    assert inspections.checks == inspections.files[0].preparation.checks


def test_inspect_and_read_parse_the_numbers_a_single_time(tmp_path, monkeypatch):
    text = write_relaxation(simulate_relaxation(PAPER, hold_time=5.0).test)
    first, last = text.rstrip("\n").rsplit("\n", 1)
    path = tmp_path / "seal.csv"
    # a reading that is none: what takes it out for one must leave it to the other
    path.write_text(f"{first}\n{last.rsplit(',', 1)[0]},9.9e37\n")
    parsed = []
    plain = rows.load_rows
    monkeypatch.setattr(
        "dashpot.reading.formats.text.load_rows", lambda *a, **k: parsed.append(1) or plain(*a, **k)
    )
    (result,) = inspect_files([path]).files
    assert len(parsed) == 1
    assert "overload mark" in " ".join(result.warnings)
    direct = read_relaxation(path)
    retained = []
    inspect_files(
        [path], read=lambda file: retained.append(relaxation_in(file, Specimen())) or retained[0]
    )
    assert retained[0] == direct


# -- an FRF from elsewhere ------------------------------------------------------------------------


@pytest.fixture(scope="module")
def foreign(tmp_path_factory):
    """An FRF with coherence and noise, without its number of hits and without units."""
    f = np.arange(1.0, 40.0, 0.1)
    value = predict_frf(2 * PAPER, mass=0.104, frequency=f).value
    coherence = np.where(f < 6, 0.05, 0.999)
    scatter = np.sqrt((1 - coherence) / (2 * coherence)) * np.abs(value)
    random = np.random.default_rng(3)
    # far below the resonance there is noise alone, and more of it than the peak is high
    value = value + scatter * (random.standard_normal(len(f)) + 1j * random.standard_normal(len(f)))
    value[f < 6] *= 3e3
    rows = zip(f, value.real, value.imag, coherence, strict=True)
    path = tmp_path_factory.mktemp("frf") / "frf.csv"
    head = "frequency [Hz],real,imaginary,coherence"
    path.write_text("\n".join([head, *(",".join(map(repr, map(float, row))) for row in rows)]))
    return path


FRF_UNITS = ReadOptions(units={"real": "(m/s^2)/N", "imaginary": "(m/s^2)/N"})


def test_what_the_user_says_of_an_frf_is_heeded(foreign):
    with pytest.raises(ReadError, match="makes no FRF"):
        compare_files(
            a_fit(PAPER), [foreign], BlockOnSeals(), hammer=HammerChoices(), options=ReadOptions()
        )
    frf_comparison = compare_files(
        a_fit(PAPER),
        [foreign],
        BlockOnSeals(0.104, 2),
        hammer=HammerChoices(),
        options=FRF_UNITS,
    )
    assert frf_comparison.comparison.measured_hz == pytest.approx(12.71, abs=0.02)


def test_the_coherence_of_a_file_is_used_and_checked_in_the_band(foreign):
    frf_comparison = compare_files(
        a_fit(PAPER),
        [foreign],
        BlockOnSeals(seals=2),
        hammer=HammerChoices(),
        options=FRF_UNITS,
        band=(8, 40),
    )
    assert frf_comparison.mass == pytest.approx(0.104, rel=1e-2)
    (coherence,) = [check for check in frf_comparison.frf_checks if check.name == "coherence"]
    assert coherence.passed
    assert "(12.6 Hz)" in coherence.message
    frf_comparison = identify_files(
        [foreign],
        BlockOnSeals(0.104, 2),
        hammer=HammerChoices(),
        options=FRF_UNITS,
        band=(8, 40),
    )
    fit, straight, noted = (
        frf_comparison.fit,
        frf_comparison.direct.stiffness,
        frf_comparison.frf_checks,
    )
    (lines,) = [check for check in fit.checks if check.name == "lines_explained"]
    assert "It has coherence but no number of hits" in lines.message
    assert lines.value < 0.1
    assert fit.model.storage(omega=80.0) == pytest.approx(PAPER.storage(omega=80.0), rel=0.01)
    assert "coherence" in [check.name for check in noted]
    assert straight.frequency[0] >= 8


# -- at the compression of the mass ---------------------------------------------------------------


def hard(se=0.0):
    knots, shape = hardening.law()
    law = ElasticLaw(tuple(knots), tuple(shape), PAPER.k_inf, (se,) * len(knots) if se else ())
    return replace(a_fit(PAPER, relative=1e-4), elastic_law=law)


def test_a_prediction_tells_both_solids_and_where_the_mass_rests():
    prediction = predict_files(hard(), block=BlockOnSeals(0.104, 2), band=(5.0, 40.0))
    at = hardening.resting(0.104, 2)
    scale = hardening.tangent(at) / hardening.K_INF
    document = prediction.to_dict()
    assert document["compression"] == pytest.approx(at, rel=5e-3)
    assert document["depth"] == 8e-3
    assert not document["extrapolated_law"]
    assert document["secant"]["frequency"] == pytest.approx(hardening.peak(0.104, 2, 1.0), rel=1e-3)
    assert document["tangent"]["frequency"] == pytest.approx(
        hardening.peak(0.104, 2, scale), rel=3e-3
    )
    assert prediction.peak[0] == pytest.approx(hardening.peak(0.104, 2, scale), rel=3e-3)
    assert "tangent at 3.24 mm" in str(prediction.static_equilibrium)
    inputs = predict_files(hard(), block=BlockOnSeals(0.104, 2, compression=8e-3), band=(5.0, 40.0))
    assert inputs.to_dict()["compression"] == 8e-3
    assert inputs.peak[0] > prediction.peak[0]
    assert (
        str(
            predict_files(
                a_fit(PAPER), block=BlockOnSeals(0.104), band=(5.0, 40.0)
            ).static_equilibrium
        )
        == ""
    )


def test_limits_carry_the_doubt_of_the_tangent():
    """A seal whose tangent is 1.5 standard errors off has its peak inside, and only then."""
    f = np.linspace(8.0, 18.0, 801)

    def check_limits(se):
        prediction = predict_files(
            hard(se), block=BlockOnSeals(0.104, 2), band=(8.0, 18.0), lines=801
        )
        scale = prediction.static_equilibrium.point.factor * (1 + 1.5 * 0.02)
        omega = 2 * np.pi * f
        truth = np.abs(omega**2 / (2 * hardening.stiffness(omega, scale) - 0.104 * omega**2))
        limits = prediction.to_dict()["limits"]
        low, high = np.array(limits["parameter"])
        lines = limits["frequency_hz"]
        return (
            (np.interp(f, lines, low) <= 1.02 * truth) & (truth <= 1.02 * np.interp(f, lines, high))
        ).mean()

    assert check_limits(0.02) > 0.97
    assert check_limits(0.0) < 0.6


def test_a_mass_and_the_stiffness_under_it_find_each_other():
    at = hardening.resting(0.104, 2)
    f = np.arange(4.0, 40.0, 0.05)
    value, sd = hardening.simulate_accelerance(
        f, mass=0.104, seals=2, scale=hardening.tangent(at) / hardening.K_INF, noise=1e-3, seed=1
    )
    frf = FRF(f, value, sd=sd, averages=4, units="SI")
    assert find_mass_on_seals(hard(), frf, BlockOnSeals(seals=2)).mass == pytest.approx(
        0.104, rel=5e-3
    )


def test_what_nothing_limits_stays_without_limit_however_the_tangent_slides():
    f = np.geomspace(5.0, 30.0, 200)
    limits = np.array([np.full(200, 0.1), np.where((f > 12) & (f < 13), np.inf, 5.0)])
    point = operating_point(hard(0.02), MassOnSeals(0.104, 2))
    slid = _slide_limits(f, limits, point)
    assert not np.isnan(slid).any()
    assert np.isinf(slid[1]).sum() > np.isinf(limits[1]).sum()
    assert (slid[0] <= limits[0]).all()
    assert (slid[1] >= limits[1]).all()
    certain = operating_point(hard(), MassOnSeals(0.104, 2))
    np.testing.assert_array_equal(_slide_limits(f, limits, certain), limits)


def test_what_was_inspected_is_drawn(tmp_path):
    path = tmp_path / "seal.csv"
    table = "\n".join(f"{t / 10},{min(t, 20) / 10},{min(t, 20) / 50}" for t in range(200))
    path.write_text(f"time [s],displacement [mm],force [N]\n{table}\n", encoding="utf-8")
    assert inspect_files([path]).files[0].plot().panels


def test_hammer_choices_default_to_those_of_estimate_frf():
    defaults = signature(estimate_frf).parameters
    shared = [item for item in fields(HammerChoices) if item.name in defaults]
    assert {"window", "estimator", "combine", "record"} <= {item.name for item in shared}
    assert {item.name: item.default for item in shared} == {
        item.name: defaults[item.name].default for item in shared
    }
