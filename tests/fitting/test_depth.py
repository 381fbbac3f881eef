"""Several depths: the elastic law, whether shape depends on depth, compression curves."""

from __future__ import annotations

import numpy as np
import pytest

from dashpot.base.errors import DataError, FitError
from dashpot.fitting.depth import fit_depths
from dashpot.fitting.relaxation import fit
from dashpot.records.relaxation import RampHold
from dashpot.solids.elastic import PolynomialLaw, compare_with_curve, elastic_law
from dashpot.solids.maxwell import GeneralizedMaxwell

CUBIC = PolynomialLaw((1, 2, 3), (150.0, 0.0, 7.2656e5), 8e-3)
"""F_e = 0.15 x + 7.2656e-4 x^3 in N and mm."""


def quasi_linear(
    seal: GeneralizedMaxwell, depth: float, *, law: PolynomialLaw, noise: float = 0.0, seed: int = 0
) -> RampHold:
    """A test of a seal whose elastic force follows the law, its shape of relaxation the seal's."""
    t = np.arange(-50, 4101) / 100.0
    x = depth * np.clip(t, 0.0, 1.0)
    force = (seal * (1.0 / seal.k_inf)).force(t, law.force(x))
    force = force + noise * np.random.default_rng(seed).standard_normal(len(t))
    return RampHold(t, x, force, 0.0, 1.0, 41.0, depth, force_noise=noise)


def test_the_cubic_of_the_reference() -> None:
    law = elastic_law([4e-3, 6e-3, 8e-3], CUBIC.secant([4e-3, 6e-3, 8e-3]))
    assert float(law.secant(8e-3)) == pytest.approx(196.5, rel=1e-5)
    assert float(law.tangent(8e-3)) == pytest.approx(289.5, rel=1e-5)
    np.testing.assert_allclose(law.coefficients, CUBIC.coefficients, rtol=1e-9, atol=1e-7)
    two = elastic_law([4e-3, 8e-3], CUBIC.secant([4e-3, 8e-3]))
    assert float(two.tangent(8e-3)) == pytest.approx(float(CUBIC.tangent(8e-3)), rel=1e-9)
    one = elastic_law([8e-3], [196.5])
    assert float(one.tangent(5e-3)) == float(one.secant(5e-3)) == 196.5


def test_the_tangent_is_the_derivative_of_the_force() -> None:
    x, h = np.linspace(1e-3, 9e-3, 20), 1e-7
    slope = (CUBIC.force(x + h) - CUBIC.force(x - h)) / (2 * h)
    np.testing.assert_allclose(CUBIC.tangent(x), slope, rtol=1e-6)


def test_a_quasi_linear_seal_is_recovered_and_called_separable(
    paper_seal: GeneralizedMaxwell,
) -> None:
    tests = [quasi_linear(paper_seal, depth, law=CUBIC) for depth in (8e-3, 4e-3, 6e-3)]
    found = fit_depths(tests, arms=2)
    assert [at.depth for at in found.by_depth] == [4e-3, 6e-3, 8e-3]
    for at in found.by_depth:
        assert at.k_inf == pytest.approx(float(CUBIC.secant(at.depth)), rel=1e-5)
    assert found.separable.passed
    vibrating = found.tangent_model(8e-3)
    assert vibrating.k_inf == pytest.approx(289.5, rel=1e-4)
    np.testing.assert_allclose(vibrating.tau, paper_seal.tau, rtol=1e-4)
    np.testing.assert_allclose(
        np.divide(vibrating.k, vibrating.k_inf),
        np.divide(paper_seal.k, paper_seal.k_inf),
        rtol=1e-4,
    )
    assert found.secant_model(4e-3).k_inf == pytest.approx(float(CUBIC.secant(4e-3)), rel=1e-5)


def test_a_shape_that_changes_with_depth_is_found(paper_seal: GeneralizedMaxwell) -> None:
    stiffer = GeneralizedMaxwell(paper_seal.k_inf, (1.2 * 117.5, 17.8), paper_seal.tau)
    tests = [
        quasi_linear(paper_seal, 4e-3, law=CUBIC, noise=2e-3, seed=1),
        quasi_linear(stiffer, 8e-3, law=CUBIC, noise=2e-3, seed=2),
    ]
    found = fit_depths(tests, arms=2)
    assert not found.separable.passed
    assert "use each depth's own stiffnesses" in found.separable.says


def test_noise_alone_does_not_make_depths_differ(paper_seal: GeneralizedMaxwell) -> None:
    chances = []
    for seed in range(5):
        tests = [
            quasi_linear(paper_seal, depth, law=CUBIC, noise=5e-3, seed=10 * seed + i)
            for i, depth in enumerate((4e-3, 6e-3, 8e-3))
        ]
        check = fit_depths(tests, arms=2).separable
        assert check.value is not None
        chances.append(check.value)
    assert min(chances) > 1e-3
    assert max(chances) > 0.3


def test_depth_law_of_a_fit_keeps_each_depths_stiffness(paper_seal: GeneralizedMaxwell) -> None:
    straight = PolynomialLaw((1,), (196.5,), 8e-3)
    tests = [
        quasi_linear(paper_seal, 4e-3, law=straight),
        quasi_linear(paper_seal * 2, 8e-3, law=PolynomialLaw((1,), (393.0,), 8e-3)),
    ]
    found = fit(tests, arms=2, depth_law=True)
    assert [at.k_inf for at in found.by_depth] == pytest.approx([196.5, 393.0], rel=1e-6)
    assert found.model.k_inf == pytest.approx(393.0, rel=1e-6)
    assert found.by_depth[0].k == pytest.approx(paper_seal.k, rel=1e-5)
    assert found.parameters == ("k_inf", "k_1", "k_2", "ln_tau_1", "ln_tau_2")


def test_the_paper_seal_agrees_with_its_compression_curve() -> None:
    law = elastic_law([8e-3], [196.5])
    curve = np.linspace(0.0, 10e-3, 21)
    (agreement,) = compare_with_curve(law, [8e-3], displacement=curve, force=196.5 * curve)
    assert agreement.relaxed == pytest.approx(1.572)
    assert agreement.difference == pytest.approx(0.0, abs=1e-12)
    assert "1.572 N" in agreement.says


def test_what_cannot_be_asked_is_refused(paper_seal: GeneralizedMaxwell) -> None:
    one = quasi_linear(paper_seal, 8e-3, law=CUBIC)
    with pytest.raises(FitError, match="found 1 test; a depth law needs at least two depths"):
        fit_depths([one])
    with pytest.raises(FitError, match="fit equal depths together without depth_law"):
        fit_depths([one, one], arms=1)
    law = elastic_law([8e-3], [196.5])
    with pytest.raises(DataError, match="does not reach the depth of 8 mm; measure it deeper"):
        compare_with_curve(law, [8e-3], displacement=[0.0, 5e-3], force=[0.0, 1.0])
