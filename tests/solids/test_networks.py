"""Networks: any composition is the canonical solid, and its stiffness is the formula's."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dashpot.base.errors import DataError
from dashpot.solids import networks as net
from dashpot.solids.maxwell import GeneralizedMaxwell

positive = st.floats(-3, 3).map(lambda power: 10.0**power)
# a network as a tree: ("spring", k), ("dashpot", b), ("series", [...]), ("parallel", [...])
leaves = st.tuples(st.sampled_from(["spring", "dashpot"]), positive)
trees = st.recursive(
    leaves,
    lambda inner: st.tuples(
        st.sampled_from(["series", "parallel"]), st.lists(inner, min_size=1, max_size=4)
    ),
    max_leaves=12,
)


def build(tree) -> GeneralizedMaxwell:
    word, rest = tree
    if word in ("spring", "dashpot"):
        return getattr(net, word)(rest)
    return getattr(net, word)(*map(build, rest))


def stiffness(tree, s):
    word, rest = tree
    if word == "spring":
        return np.full_like(s, rest)
    if word == "dashpot":
        return rest * s
    parts = [stiffness(item, s) for item in rest]
    return sum(parts) if word == "parallel" else 1 / sum(1 / part for part in parts)


@given(trees, st.floats(-4, 4))
def test_any_network_has_the_stiffness_of_its_formula(tree, power):
    s = 2j * np.pi * 10.0**power * np.array([0.3, 1.0, 3.0])
    expected = stiffness(tree, s)
    assert np.abs(build(tree).stiffness_at(s) / expected - 1).max() < 1e-9


@given(trees)
def test_any_network_is_passive(tree):
    solid = build(tree)
    omega = np.logspace(-6, 6, 25)
    assert (solid.complex_stiffness(omega=omega).imag >= 0).all()
    assert (np.diff(solid.storage(omega=omega)) >= -1e-9 * solid.storage(omega=omega)[1:]).all()


@given(trees, trees)
def test_order_does_not_matter(one, other):
    a, b = build(one), build(other)
    s = 1j * np.logspace(-3, 3, 7)
    for join in (net.series, net.parallel):
        assert join(a, b).stiffness_at(s) == pytest.approx(join(b, a).stiffness_at(s), rel=1e-10)


def test_equal_elements_in_series_halve_the_stiffness(paper_seal):
    half = net.series(paper_seal, paper_seal)
    assert half.arms == paper_seal.arms
    assert half.k == pytest.approx([k / 2 for k in paper_seal.k], rel=1e-12)
    assert half.tau == pytest.approx(paper_seal.tau, rel=1e-12)
    assert half.k_inf == pytest.approx(paper_seal.k_inf / 2, rel=1e-14)


def test_series_of_a_single_element_is_that_element(paper_seal):
    assert net.series(paper_seal) is paper_seal
    assert net.parallel(paper_seal, paper_seal).k == pytest.approx((2 * paper_seal).k)


def test_series_of_a_spring_and_a_dashpot_is_a_maxwell_arm():
    solid = net.series(net.spring(3.0), net.dashpot(6.0))
    assert (solid.k_inf, solid.b) == (0.0, 0.0)
    assert solid.k == pytest.approx((3.0,))
    assert solid.tau == pytest.approx((2.0,))
    assert solid == net.maxwell(3.0, tau=2.0) or solid.k == pytest.approx(net.maxwell(3.0, b=6.0).k)


def test_springs_and_dashpots_stay_springs_and_dashpots():
    assert net.series(net.spring(2.0), net.spring(2.0)) == net.spring(1.0)
    assert net.series(net.dashpot(2.0), net.dashpot(2.0)) == net.dashpot(1.0)
    assert net.parallel(net.dashpot(2.0), net.spring(1.0)) == net.kelvin_voigt(1.0, 2.0)


def test_zener_and_its_kelvin_form_are_the_same_solid():
    """Spring in series with a Voigt element: k_0, and k_inf from the two springs in series."""
    k_g, k_v, tau = 5.0, 2.0, 0.3
    solid = net.kelvin_chain(k_g, k=[k_v], tau=[tau])
    by_hand = net.series(net.spring(k_g), net.kelvin_voigt(k_v, k_v * tau))
    k_inf = k_g * k_v / (k_g + k_v)
    expected = net.zener(k_inf, k_g - k_inf, tau=tau * k_v / (k_g + k_v))
    for model in (solid, by_hand):
        assert model.k_inf == pytest.approx(expected.k_inf)
        assert model.k == pytest.approx(expected.k)
        assert model.tau == pytest.approx(expected.tau)


def test_kelvin_chain_creeps_as_it_is_written():
    solid = net.kelvin_chain(5.0, k=[2.0, 1.0], tau=[0.3, 20.0], b=100.0)
    t = np.logspace(-3, 3, 20)
    expected = 0.2 + (1 - np.exp(-t / 0.3)) / 2 + (1 - np.exp(-t / 20)) + t / 100
    assert solid.creep(t) == pytest.approx(expected, rel=1e-12)


def test_kelvin_chain_without_a_spring_ends_in_a_dashpot():
    solid = net.kelvin_chain(None, k=[2.0, 1.0], tau=[0.3, 20.0])
    assert solid.b == pytest.approx(1 / (1 / 0.6 + 1 / 20.0))


def test_creep_round_trip(paper_seal):
    again = net.from_creep(net.creep_of(paper_seal))
    assert again.k == pytest.approx(paper_seal.k, rel=1e-13)
    assert again.tau == pytest.approx(paper_seal.tau, rel=1e-13)


def test_clutch_elements_of_gaillard_and_singh():
    """Energy per cycle of a Voigt element, pi c omega X^2: 0.98696 mJ."""
    omega, amplitude = 2 * np.pi * 10, 1e-3
    voigt = net.kelvin_voigt(1000.0, 5.0)
    assert np.pi * voigt.loss(omega=omega) * amplitude**2 == pytest.approx(0.98696e-3, rel=1e-5)
    clutch = net.maxwell_voigt(1000.0, 5.0, arm_k=400.0, arm_b=20.0)
    formula = 1000 + 5j * omega + 1 / (1 / 400 + 1 / (20j * omega))
    assert clutch.complex_stiffness(omega=omega) == pytest.approx(formula)
    # the Maxwell part makes the dynamic stiffness rise with frequency
    assert abs(clutch.complex_stiffness(omega=2 * omega)) > abs(
        clutch.complex_stiffness(omega=omega)
    )


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: net.spring(0.0), "k = 0.0; expected a finite number > 0"),
        (lambda: net.dashpot(-1.0), "b = -1.0"),
        (lambda: net.maxwell(1.0), "either tau or b"),
        (lambda: net.maxwell(1.0, tau=1.0, b=1.0), "either tau or b"),
        (net.series, "at least one"),
        (net.parallel, "at least one"),
        (lambda: net.kelvin_chain(1.0, k=[1.0], tau=[]), "needs a k and a tau"),
        (
            lambda: net.series(net.spring(1.0), GeneralizedMaxwell(0.0)),
            "neither stiffness nor viscosity",
        ),
        (lambda: net.kelvin_chain(None, k=[], tau=[]), "rigid"),
    ],
)
def test_what_is_refused(call, sentence):
    with pytest.raises(DataError, match=sentence):
        call()
