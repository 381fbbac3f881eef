"""The number of arms, by two rules."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import chi2

from dashpot.numerics.inference.model_order import (
    MAX_CHANCE,
    bic,
    bic_of_deviance,
    chi2_sf,
    is_significant_fall,
    select_model_order,
    significant,
)


def test_bic_is_its_formula() -> None:
    assert bic(2.0, effective=100.0, parameters=5) == pytest.approx(
        100 * np.log(2.0) + 5 * np.log(100.0)
    )


def test_a_gain_below_the_floor_is_no_gain() -> None:
    few = bic(1e-20, effective=1000.0, parameters=3, rounding_sse=1e-16)
    many = bic(1e-26, effective=1000.0, parameters=5, rounding_sse=1e-16)
    assert few < many
    assert bic(1e-26, effective=1000.0, parameters=5) < bic(1e-20, effective=1000.0, parameters=3)


def test_correlated_residuals_are_less_evidence() -> None:
    """A gain of 2 % in SSE convinces 10 000 samples and not the 100 they are worth."""
    for effective, convinced in ((10_000.0, True), (100.0, False)):
        item = bic(1.0, effective=effective, parameters=3)
        two = bic(0.98, effective=effective, parameters=5)
        assert (two < item) is convinced


@pytest.mark.parametrize(
    ("k", "se_k", "se_ln_tau", "expected"),
    [
        ([10.0, 5.0], [1.0, 1.0], [0.1, 0.4], True),
        ([10.0, 2.9], [1.0, 1.0], [0.1, 0.4], False),
        ([10.0, 5.0], [1.0, 1.0], [0.1, 0.6], False),
        ([10.0], [np.inf], [np.inf], False),
        ([], [], [], True),
    ],
)
def test_significance(
    k: list[float], se_k: list[float], se_ln_tau: list[float], expected: bool
) -> None:
    assert significant(np.array(k), np.array(se_k), np.array(se_ln_tau)) is expected


def test_select_model_order_takes_the_smaller_and_reports_disagreement() -> None:
    agreed = select_model_order([0, 1, 2, 3], [9.0, 5.0, 1.0, 2.0], [True, True, True, False])
    assert (agreed.arms, agreed.has_agreement) == (2, True)
    cautious = select_model_order([0, 1, 2, 3], [9.0, 5.0, 2.0, 1.0], [True, True, True, False])
    assert (cautious.arms, cautious.by_bic, cautious.by_significance) == (2, 3, 2)
    assert not cautious.has_agreement
    frugal = select_model_order([0, 1, 2], [9.0, 1.0, 2.0], [True, True, True])
    assert (frugal.arms, frugal.by_bic, frugal.by_significance) == (1, 1, 2)


def test_what_bic_rejects_decisively_is_not_chosen() -> None:
    scores = [0, 1, 2, 3], [900.0, 300.0, 120.0, 10.0], [True, True, False, False]
    assert select_model_order(*scores).arms == 1
    decided = select_model_order(*scores, decisive=50.0)
    assert (decided.arms, decided.by_bic, decided.by_significance) == (3, 3, 1)
    assert not decided.has_agreement
    # fewest of what is left, and never fewer than both rules support
    near = select_model_order([0, 1, 2, 3], [900.0, 300.0, 40.0, 10.0], scores[2], decisive=50.0)
    assert near.arms == 2
    frugal = select_model_order([0, 1, 2], [30.0, 1.0, 2.0], [True, True, True], decisive=50.0)
    assert frugal.arms == 1


def test_a_choice_at_the_end_of_what_was_tried_is_capped() -> None:
    scores = ([0, 1, 2], [9.0, 5.0, 1.0], [True, True, True])
    assert select_model_order(*scores, is_exhausted=False).is_largest_tried
    assert not select_model_order(*scores).is_largest_tried
    assert not select_model_order(
        [0, 1, 2], [9.0, 1.0, 5.0], [True, True, True], is_exhausted=False
    ).is_largest_tried


def test_the_bic_of_a_deviance_is_its_formula() -> None:
    assert bic_of_deviance(30.0, effective=50.0, parameters=5) == pytest.approx(
        30.0 + 5 * np.log(50.0)
    )


@given(value=st.floats(0.0, 200.0), dof=st.integers(1, 12))
def test_chance_is_the_tail_of_chi_square(value: float, dof: int) -> None:
    assert chi2_sf(value, dof) == pytest.approx(chi2.sf(value, dof), rel=1e-10, abs=1e-300)


@pytest.mark.parametrize("dof", [1, 2, 3, 10, 99, 170, 171, 300, 301, 343, 1000, 5001])
@pytest.mark.parametrize("ratio", [0.0, 1e-12, 0.05, 0.5, 0.9, 1.0, 1.1, 1.5, 3.0, 30.0])
def test_chance_is_the_tail_of_chi_square_for_any_degrees_of_freedom(
    dof: int, ratio: float
) -> None:
    """Powers and gamma functions of some hundreds overflow; the tail does not."""
    expected = chi2.sf(ratio * dof, dof)
    assert chi2_sf(ratio * dof, dof) == pytest.approx(expected, rel=1e-10, abs=1e-300)


@pytest.mark.parametrize("parameters", [1, 2, 3, 5])
def test_significant_fall_is_three_standard_errors(parameters: int) -> None:
    limit = chi2.isf(MAX_CHANCE, parameters)
    assert chi2.sf(9.0, 1) == pytest.approx(MAX_CHANCE)
    assert is_significant_fall(1.001 * limit, parameters)
    assert not is_significant_fall(0.999 * limit, parameters)
    assert not is_significant_fall(-1.0, parameters)


def test_select_model_order_states_its_metric() -> None:
    assert select_model_order(
        [0, 1], [2.0, 1.0], [True, True], in_noise_metric=True
    ).in_noise_metric
    assert not select_model_order([0, 1], [2.0, 1.0], [True, True]).in_noise_metric
