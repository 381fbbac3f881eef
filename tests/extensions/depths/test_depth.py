"""Several depths: the elastic law, whether shape depends on depth, compression curves."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest
from kit.ramps import Law, cubic, linear

from dashpot.base.errors import FitError
from dashpot.datamodel.relaxation import RampHold
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.depths.depth_dependence import fit_depths
from dashpot.fitting.relaxation import fit
from dashpot.solids.maxwell import GeneralizedMaxwell


def quasi_linear(
    seal: GeneralizedMaxwell,
    depth: float,
    *,
    law: Law = cubic,
    noise: float = 0.0,
    seed: int = 0,
    rate: float = 100.0,
    ramp: float = 1.0,
) -> RampHold:
    """A test of a seal whose elastic force follows the law, its shape of relaxation the seal's."""
    t = np.arange(-0.5 * rate, 41 * rate + 1) / rate
    x = depth * np.clip(t / ramp, 0.0, 1.0)
    force = (seal * (1.0 / seal.k_inf)).force(t, law(x))
    force = force + noise * np.random.default_rng(seed).standard_normal(len(t))
    return RampHold(t, x, force, 0.0, ramp, float(t[-1]), depth, force_noise=noise)


def test_a_quasi_linear_seal_is_recovered_and_called_separable(
    paper_seal: GeneralizedMaxwell,
) -> None:
    tests = [quasi_linear(paper_seal, depth) for depth in (8e-3, 4e-3, 6e-3)]
    depth_law = fit_depths(tests, arms=2)
    assert [at.depth for at in depth_law.by_depth] == [4e-3, 6e-3, 8e-3]
    for at in depth_law.by_depth:
        # a tangent linear between nine knots is a parabola within a few parts in ten thousand
        assert at.k_inf == pytest.approx(float(cubic(np.array(at.depth))) / at.depth, rel=1e-3)
    assert depth_law.separable.passed
    assert depth_law.fit.evidence.stiffness_by_depth == depth_law.by_depth
    assert replace(depth_law.fit.elastic_law, ratio_se=()) == depth_law.law
    vibrating = depth_law.fit.model_at(8e-3)
    assert vibrating.k_inf == pytest.approx(289.5, rel=0.02)
    assert depth_law.fit.model_at(2.6e-3).k_inf == pytest.approx(164.7, rel=0.005)
    np.testing.assert_allclose(vibrating.tau, paper_seal.tau, rtol=3e-3)
    np.testing.assert_allclose(
        np.divide(vibrating.k, vibrating.k_inf),
        np.divide(paper_seal.k, paper_seal.k_inf),
        rtol=3e-3,
    )
    relaxed = float(cubic(np.array(4e-3))) / 4e-3
    assert depth_law.fit.model_at(4e-3, secant=True).k_inf == pytest.approx(relaxed, rel=1e-3)


def test_a_linear_seal_stays_linear_at_every_depth(paper_seal: GeneralizedMaxwell) -> None:
    tests = [
        quasi_linear(paper_seal, depth, law=linear, noise=4e-3, seed=i)
        for i, depth in enumerate((4e-3, 8e-3))
    ]
    depth_law = fit_depths(tests)
    assert depth_law.law.kind == "linear"
    assert depth_law.fit.model.arms == 2
    error = np.sqrt(depth_law.fit.covariance[0, 0])
    assert abs(depth_law.fit.model.k_inf - paper_seal.k_inf) < 3 * error


def test_fit_depths_detects_a_shape_that_changes_with_depth(paper_seal: GeneralizedMaxwell) -> None:
    stiffer = GeneralizedMaxwell(paper_seal.k_inf, (1.2 * 117.5, 17.8), paper_seal.tau)
    tests = [
        quasi_linear(paper_seal, 4e-3, noise=2e-3, seed=1),
        quasi_linear(stiffer, 8e-3, noise=2e-3, seed=2),
    ]
    depth_law = fit_depths(tests, arms=2)
    assert depth_law.separable.failed
    assert "Use the stiffnesses of each depth." in depth_law.separable.message_with_remedy
    shallow, deep = (at.k[0] / at.k_inf for at in depth_law.by_depth)
    assert deep / shallow == pytest.approx(1.2, rel=0.02)


def test_fit_depths_accepts_noise(paper_seal: GeneralizedMaxwell) -> None:
    chances = []
    for seed in range(5):
        tests = [
            quasi_linear(paper_seal, depth, noise=5e-3, seed=10 * seed + i)
            for i, depth in enumerate((4e-3, 6e-3, 8e-3))
        ]
        check = fit_depths(tests, arms=2).separable
        assert check.value is not None
        chances.append(check.value)
    assert min(chances) > 1e-3
    assert max(chances) > 0.3


def test_what_each_depth_says_of_its_stiffness_bears_the_rig(
    paper_seal: GeneralizedMaxwell,
) -> None:
    """A machine that gives by .8 % of the depth, of which nobody spoke."""
    tests = []
    for i, depth in enumerate((4e-3, 6e-3, 8e-3)):
        ramp_hold = quasi_linear(paper_seal, depth, noise=2e-3, seed=i)
        shown, quiet = ramp_hold.displacement, quasi_linear(paper_seal, depth).force
        force = quiet
        for _ in range(4):
            pressed = shown - 8e-3 * depth * force / quiet.max()
            force = (paper_seal * (1.0 / paper_seal.k_inf)).force(ramp_hold.time, cubic(pressed))
        tests.append(replace(ramp_hold, force=ramp_hold.force - quiet + force))
    for at in fit_depths(tests, arms=2).by_depth:
        secant = float(cubic(np.array(at.depth))) / at.depth
        for k, se, quiet in zip(
            (at.k_inf, *at.k),
            ((at.k_inf_most - at.k_inf) / 1.96, *at.k_se),
            (paper_seal.k_inf, *paper_seal.k),
            strict=True,
        ):
            truth = quiet * secant / paper_seal.k_inf
            assert abs(k - truth) < 1.96 * se < 0.25 * truth


@pytest.mark.slow
def test_eight_long_records_take_seconds(paper_seal: GeneralizedMaxwell) -> None:
    tests = [
        quasi_linear(paper_seal, 1e-3 * i, noise=4e-3, seed=i, rate=2000.0, ramp=1 + 0.3 * i)
        for i in range(1, 9)
    ]
    assert sum(len(test.time) for test in tests) > 600_000
    begun = time.process_time()
    depth_law = fit_depths(tests)
    assert time.process_time() - begun < 20
    assert depth_law.law.secant(8e-3) == pytest.approx(196.5, rel=2e-3)
    assert depth_law.law.tangent(8e-3) == pytest.approx(289.5, rel=0.02)
    assert depth_law.law.tangent(2.6e-3) == pytest.approx(164.7, rel=0.01)


def test_fit_depths_refuses_incompatible_options(paper_seal: GeneralizedMaxwell) -> None:
    ramp_hold = quasi_linear(paper_seal, 8e-3)
    warm, chilled = (
        replace(quasi_linear(paper_seal, depth), specimen=Specimen(temperature=kelvin))
        for depth, kelvin in ((4e-3, 296.15), (8e-3, 273.15))
    )
    with pytest.raises(
        FitError, match=r"at several temperatures .* leave out .*--elastic by-depth"
    ):
        fit_depths([warm, chilled])
    with pytest.raises(FitError, match=r"a nonlinear law has .* Leave out --thorough"):
        fit(warm, law="nonlinear", thorough=True)
    with pytest.raises(FitError, match="found 1 test of one depth; a depth law needs at"):
        fit_depths([ramp_hold])
    with pytest.raises(FitError, match="fit equal depths together without depth_law"):
        fit_depths([ramp_hold, replace(ramp_hold, force=1.01 * ramp_hold.force)], arms=1)
