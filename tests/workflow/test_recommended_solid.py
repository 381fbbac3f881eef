"""The recommended model of a study, and numbers with limits that contain the truth."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from kit import handmade
from kit.fits import replace_fields

from dashpot.base.checks import Check
from dashpot.datamodel.bounds import EndOfHold
from dashpot.solids.demo_seals import BROAD, BROAD_MASS
from dashpot.vibration.mass_on_seals import model_modes
from dashpot.workflow.recommended_solid import recommend_solid

S = handmade.study()
NO_JOINT = replace(S, joint=None, joint_prediction=None, joint_comparison=None)
STOP = Check("force_residual_small", False, "The model misses the force.", grade="stop")


def index_by_name(answers):
    return {answer.quantity: answer for answer in answers}


def test_the_joint_solid_is_recommended_where_the_verdict_allows_it():
    recommendation = recommend_solid(S)
    assert (recommendation.recommended, recommendation.joint) == (True, True)
    assert recommendation.solid is S.joint


def test_without_a_joint_fit_it_is_that_of_the_relaxation_test():
    intact = replace(NO_JOINT, comparison=None, measured=None)
    recommendation = recommend_solid(intact)
    assert (recommendation.recommended, recommendation.joint) == (True, False)
    assert recommendation.solid is S.fit


def test_nothing_is_recommended_where_the_verdict_says_do_not_use():
    failed = replace(S, joint=replace_fields(S.joint, checks=(STOP,)))
    recommendation = recommend_solid(failed)
    assert (recommendation.recommended, recommendation.joint) == (False, False)
    assert recommendation.solid is S.fit


def test_the_frequency_is_that_of_the_peak_and_the_damping_that_of_the_pole():
    """What a hammer shows is a peak: for one viscous degree of freedom above the pole by 1/sqrt."""
    recommendation = recommend_solid(S)
    mass = next((n.value for n in S.joint.estimate.nuisance if n.name == "mass"), S.mass)
    (mode,) = model_modes(S.seals * S.joint.model, mass)
    under = index_by_name(recommendation.mass_values)
    zeta = mode.damping_ratio
    assert under["damping"].value == pytest.approx(zeta)
    assert under["frequency"].value == pytest.approx(
        mode.frequency / math.sqrt(1 - 2 * zeta**2), rel=1e-3
    )
    assert under["frequency"].value == pytest.approx(S.joint_comparison.predicted_hz, rel=5e-4)
    assert under["frequency"].measured == S.comparison.measured_hz
    assert under["damping"].measured == S.comparison.measured_damping


def highest(solid, mass, near):
    """The largest accelerance of a mass on a solid within 10 % of a frequency, by its equation."""
    omega = 2 * np.pi * near * np.linspace(0.9, 1.1, 2001)
    stiff = solid.storage(omega=omega) + 1j * solid.loss(omega=omega)
    return float((omega**2 / np.abs(stiff - mass * omega**2)).max())


def test_the_height_of_the_peak_is_that_of_the_solid_and_goes_against_the_damping():
    mass = next((n.value for n in S.joint.estimate.nuisance if n.name == "mass"), S.mass)
    for study, rel in ((S, 1e-2), (replace(S, joint_comparison=None), 1e-4)):
        under = index_by_name(recommend_solid(study).mass_values)
        zeta, height = under["damping"], under["peak"]
        there = highest(S.seals * S.joint.model, mass, under["frequency"].value)
        assert height.value == pytest.approx(there, rel=rel)  # of a hammer's on its lines
        assert height.low * zeta.high == pytest.approx(height.value * zeta.value)
        assert height.high * zeta.low == pytest.approx(height.value * zeta.value)
    assert (
        index_by_name(recommend_solid(S).mass_values)["peak"].measured == S.comparison.measured_peak
    )


@pytest.mark.parametrize("study", [S, NO_JOINT], ids=["joint", "relaxation"])
def test_every_value_lies_between_its_ends(study):
    recommendation = recommend_solid(study)
    for quantity in (*recommendation.mass_values, *recommendation.seal_values):
        assert quantity.low <= quantity.value <= quantity.high


def test_recommendation_bounds_contain_unresolved_arms():
    """The broad seal's fast arms are out of its reach: the bound knows, an interval does not."""
    recommendation = recommend_solid(NO_JOINT)
    (truth,) = model_modes(2 * BROAD, BROAD_MASS)
    under = index_by_name(recommendation.mass_values)
    seal = index_by_name(recommendation.seal_values)
    omega = 2 * np.pi * under["frequency"].value
    for quantity, value in (
        (under["damping"], truth.damping_ratio),
        (under["peak"], highest(2 * BROAD, BROAD_MASS, truth.frequency)),
        (seal["dynamic stiffness"], BROAD.storage(omega=omega)),
        (seal["loss factor"], BROAD.loss_factor(omega=omega)),
    ):
        assert quantity.is_limit
        assert quantity.low <= value <= quantity.high
    assert not any(item.is_limit for item in recommend_solid(S).mass_values)


def test_the_stiffness_at_the_end_of_the_hold_is_that_of_the_test():
    end = EndOfHold(40.0, (190.0, 210.0), (180.0, 210.0), (0.0, 211.0), 1.0)
    expected = replace(NO_JOINT, fit=replace_fields(S.fit, end_of_hold=end))
    quantity = index_by_name(recommend_solid(expected).seal_values)["end of hold"]
    assert quantity.value == pytest.approx(S.fit.model.relaxation(40.0))
    assert (quantity.low, quantity.high, quantity.at, quantity.is_limit) == (
        190.0,
        210.0,
        40.0,
        True,
    )
    assert "end of hold" not in index_by_name(recommend_solid(NO_JOINT).seal_values)


def test_a_peak_that_nothing_limits_has_no_upper_end():
    open_ended = replace(S.frf_band, peak_frequency=(12.0, math.inf))
    frequency = index_by_name(recommend_solid(replace(NO_JOINT, frf_band=open_ended)).mass_values)[
        "frequency"
    ]
    assert (frequency.low, frequency.high) == (12.0, math.inf)


def test_without_a_mass_the_answers_are_those_of_the_seal_at_the_edge_of_its_band():
    recommendation = recommend_solid(handmade.bench_only())
    assert recommendation.mass_values == ()
    quantity = index_by_name(recommendation.seal_values)["dynamic stiffness"]
    assert quantity.at == S.fit.band[1]
    assert quantity.value == pytest.approx(S.fit.model.storage(omega=2 * np.pi * S.fit.band[1]))
