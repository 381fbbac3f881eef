"""Which fit suits which record, and what a seal adds to the mass."""

from __future__ import annotations

import pytest
from kit.fits import a_fit

from dashpot.base.errors import FitError, ReadError
from dashpot.io.options import ReadOptions
from dashpot.io.write import write_relaxation
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.solids.table_1 import PAPER
from dashpot.workflow.fits import fit_files
from dashpot.workflow.impacts import identify_files, total_mass
from dashpot.workflow.inspections import inspect_files
from dashpot.workflow.job import HammerChoices


@pytest.fixture(scope="module")
def seal(tmp_path_factory):
    path = tmp_path_factory.mktemp("bench") / "seal.csv"
    path.write_text(write_relaxation(simulate_relaxation(PAPER, hold_time=5.0).test))
    return path


@pytest.fixture(scope="module")
def sweep(tmp_path_factory):
    path = tmp_path_factory.mktemp("dma") / "sweep.csv"
    rows = [(f, 1e6 * f**0.1, 1e5 * f**0.1) for f in (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50)]
    head = "frequency [Hz],storage modulus [Pa],loss modulus [Pa]"
    path.write_text("\n".join([head, *(",".join(map(str, row)) for row in rows)]) + "\n")
    return path


def test_ramp_and_hold_is_fitted_by_the_pipeline_of_its_own(seal):
    found, (test,) = fit_files([seal], arms=1)
    assert found.method == "full"
    assert test.depth == pytest.approx(8e-3, rel=0.01)
    assert fit_files([seal], arms=1, method="hold")[0].method == "hold"


def test_a_sweep_is_fitted_as_a_sweep(sweep):
    found, tests = fit_files([sweep], arms=2)
    assert found.method == "dynamic"
    assert tests == ()


@pytest.mark.parametrize("choice", [{"depth_law": True}, {"method": "hold"}])
def test_a_sweep_excludes_what_belongs_to_a_hold(sweep, choice):
    with pytest.raises(FitError, match="a dynamic sweep is fitted one at a time"):
        fit_files([sweep], arms=2, **choice)


@pytest.mark.parametrize("choice", [{"depth_law": True}, {"method": "hold"}, {"filter": "x"}])
def test_a_modulus_excludes_what_belongs_to_a_ramp(seal, choice):
    for given in ({"modulus": "E"}, {"options": ReadOptions(modulus="E")}):
        with pytest.raises(FitError, match="a relaxation modulus is fitted one at a time"):
            fit_files([seal], **given, **choice)


def test_the_moving_mass_is_the_block_and_a_third_of_the_seals():
    mass, (check,) = total_mass(0.1, seal=0.003, seals=2)
    assert mass == pytest.approx(0.102)
    assert check.name == "seal_mass_negligible"
    assert total_mass(0.1, seal=None, seals=2) == (0.1, ())
    assert total_mass(None, seal=0.003, seals=2) == (None, ())


def test_a_fit_is_not_fitted_together_with_its_own_test():
    choices = {"hammer": HammerChoices(), "options": ReadOptions(), "mass": 0.1}
    with pytest.raises(ReadError, match="not both"):
        identify_files(["hits.csv"], fits=[a_fit(PAPER)], tests=["seal.csv"], **choices)


def test_an_inspection_says_what_preparation_sees(seal, sweep):
    found = inspect_files([seal, sweep])
    assert found.files[0].preparation.ramp_time == pytest.approx(1.0, abs=0.02)
    assert found.files[1].preparation is None
    assert found.checks == found.files[0].preparation.checks
