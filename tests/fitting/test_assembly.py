"""How a fit is made of its parts, and how it ended, whatever was fitted."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import dashpot as dp
from dashpot.base.errors import Status
from dashpot.base.provenance import Step
from dashpot.datamodel.fit_diagnostics import Evidence, Provenance
from dashpot.datamodel.parameter_estimate import Nuisance
from dashpot.datamodel.relaxation import RampHold
from dashpot.fitting.checks.solid import arms_supported, optimiser_converged
from dashpot.fitting.fit_construction import (
    NO_EVIDENCE,
    SolidEstimate,
    build_fit,
    collect_provenance,
    estimate_without_errors,
    list_nuisances,
)
from dashpot.fitting.relaxation import fit as fit_tests
from dashpot.preprocessing.checks import force_relaxes
from dashpot.preprocessing.prepare import prepare
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.simulation.rig_errors import Rig
from dashpot.solids.demo_seals import PAPER

SOURCES = Path(dp.__file__).parent
POINT = estimate_without_errors(PAPER, 100, 25.0, ())
COLUMNS = ("k_inf", "offset@0", "drift@0", "offset@1", "warming@1", "b")
VALUES = {name: float(i) for i, name in enumerate(COLUMNS)}


def make_nuisances(*names: str, **more: object) -> tuple[Nuisance, ...]:
    return list_nuisances(names, VALUES.__getitem__, lambda name: 10 * VALUES[name], **more)  # type: ignore[arg-type]


def test_nuisances_of_several_tests_are_named_by_their_number():
    assert make_nuisances(*COLUMNS, prior_sds={"drift@0": 0.5}) == (
        Nuisance("offset of test 1", 1.0, 10.0, "N"),
        Nuisance("drift of test 1", 2.0, 20.0, "N/s", 0.5),
        Nuisance("offset of test 2", 3.0, 30.0, "N"),
        Nuisance("warming of test 2", 4.0, 40.0, "K"),
    )


def test_nuisance_parameters_of_one_test_have_no_number():
    assert [
        (nuisance.name, nuisance.unit) for nuisance in make_nuisances("offset@0", "drift@0")
    ] == [
        ("offset", "N"),
        ("drift", "N/s"),
    ]
    VALUES["offset"] = VALUES["drift"] = 1.0
    assert [nuisance.unit for nuisance in make_nuisances("k_inf", "offset", "drift", unit="m")] == [
        "m",
        "m/s",
    ]
    assert make_nuisances("k_inf", "b") == ()


def test_a_point_estimate_knows_no_error_of_any_parameter():
    fit = build_fit(SolidEstimate(PAPER, POINT), NO_EVIDENCE, Provenance("full"))
    assert np.isinf(np.diag(fit.covariance)).all()
    assert fit.covariance.shape == (5, 5)
    assert (
        fit.estimate.residual.n,
        fit.estimate.residual.sse,
        fit.estimate.residual.rms,
    ) == (100, 25.0, 0.5)
    assert fit.status is Status.CONVERGED
    assert fit.verdict.use == "use with care"


@pytest.mark.parametrize(
    ("has_fewer_arms", "at_bound", "checks", "status"),
    [
        (False, False, (), Status.CONVERGED),
        (True, False, (), Status.FEWER_ARMS),
        (False, True, (), Status.TAU_AT_BOUND),
        (True, True, (), Status.FEWER_ARMS),
        (False, True, ("weak",), Status.TAU_AT_BOUND),
        (False, False, ("weak",), Status.NOT_IDENTIFIED),
        (True, True, ("weak", "lost"), Status.NOT_CONVERGED),
    ],
)
def test_a_fit_ends_as_its_optimum_and_its_checks_say(
    has_fewer_arms: bool, at_bound: bool, checks: tuple[str, ...], status: Status
):
    failed = {
        "weak": arms_supported(PAPER, np.full(5, np.inf)),
        "lost": optimiser_converged(stationary=False),
    }
    evidence = Evidence((0.1, 1.0), checks=tuple(failed[name] for name in checks))
    fit = build_fit(
        SolidEstimate(PAPER, POINT, has_fewer_arms, at_bound), evidence, Provenance("full")
    )
    assert fit.status is status


def rising(kelvin: float | None = None) -> RampHold:
    """A prepared test whose force climbs back in the hold, as no relaxing solid's does."""
    rig, seed = Rig(rate=100), int(kelvin or 0)
    made = prepare(simulate_relaxation(PAPER, hold_time=10.0, rig=rig, seed=seed).test)
    more = 0.2 * made.force.max() * np.clip((made.time - made.ramp_end) / 5, 0, 1)
    specimen = replace(made.specimen, temperature=kelvin)
    return replace(made, force=made.force + more, specimen=specimen)


@pytest.mark.parametrize(
    "fit",
    [
        pytest.param(lambda: fit_tests(rising()), id="linear"),
        pytest.param(lambda: fit_tests(rising(), law="nonlinear"), id="bent"),
        pytest.param(lambda: fit_tests([rising(296.0), rising(283.0)], arms=1), id="temperatures"),
    ],
)
def test_a_force_that_rises_ends_every_fit_of_it(fit: Callable[[], dp.Fit]):
    assert force_relaxes(rising()).failed
    assert fit().status is Status.FORCE_RISES


def test_a_fit_of_tests_names_the_deepest_piece():
    shallow, deep = (
        replace(rising(), depth=depth, specimen=dp.Specimen(name=name))
        for depth, name in ((4e-3, "one"), (8e-3, "other"))
    )
    step = Step("fit")
    provenance = collect_provenance("hold", [shallow, deep], step)
    assert (provenance.method, provenance.specimen.name) == ("hold", "other")
    assert provenance.steps == (*shallow.steps, *deep.steps, step)


def test_fit_is_constructed_in_one_module():
    made = [
        file.relative_to(SOURCES).as_posix()
        for file in sorted(SOURCES.rglob("*.py"))
        if re.search(r"(?<!class )\bFit\($", file.read_text("utf-8"), re.MULTILINE)
    ]
    assert made == ["fitting/fit_construction.py"]
