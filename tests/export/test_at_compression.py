"""A fit with a nonlinear elastic law: its stiffness about a compression, and its deck."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from kit.fits import a_fit
from kit.pictures import first

import dashpot as dp
from dashpot.datamodel.fit import Fit
from dashpot.export import TARGETS
from dashpot.solids.demo_seals import PAPER
from dashpot.solids.elastic import ElasticLaw

LAW = ElasticLaw((0.0, 4e-3, 8e-3), (0.75, 0.95, 1.35), PAPER.k_inf, (0.01, 0.01, 0.02))


def make_nonlinear_fit() -> Fit:
    return replace(a_fit(PAPER), elastic_law=LAW)


def test_the_fit_at_a_compression_is_the_tangent_solid() -> None:
    there = make_nonlinear_fit().at_compression(2e-3)
    assert there.model == make_nonlinear_fit().model_at(2e-3)
    assert there.model.k_inf == pytest.approx(0.85 * PAPER.k_inf)
    np.testing.assert_allclose(there.model.k, 0.85 * np.array(PAPER.k))
    assert there.model.tau == PAPER.tau
    np.testing.assert_allclose(
        there.covariance[0, 0], 0.85**2 * make_nonlinear_fit().covariance[0, 0]
    )
    # it is a solid about that compression: no law bends it a second time
    assert there.elastic_law is None
    assert there.model_at(5e-3) == there.model
    assert "0.85 times the secant" in there.steps[-1].message


def test_a_straight_law_changes_nothing() -> None:
    straight = replace(a_fit(PAPER), elastic_law=ElasticLaw.linear(PAPER.k_inf, 8e-3))
    assert straight.at_compression(2e-3) is straight
    with pytest.raises(dp.DataError, match="expected a number > 0"):
        straight.at_compression(-1.0)


def test_a_deck_says_which_stiffness_it_holds() -> None:
    secant = TARGETS["csv"](make_nonlinear_fit(), units="SI", allow=("all",))
    assert "elastic law: nonlinear; its tangent k_inf is 147.4 N/m at 0 m" in secant
    assert "depends on the tangent there" in secant
    tangent = TARGETS["csv"](make_nonlinear_fit().at_compression(2e-3), units="SI", allow=("all",))
    assert "tangent at 2 mm, 0.85 times the secant of fit" in tangent
    assert "elastic law" not in tangent
    straight = TARGETS["csv"](a_fit(PAPER), units="SI", allow=("all",))
    assert "elastic law" not in straight


def test_the_law_is_drawn_with_its_doubt() -> None:
    made = dp.plot.elastic_law(make_nonlinear_fit(), compression=2.6e-3)
    law_panel, right = made.panels
    law, secant = first(law_panel, "elastic law"), first(law_panel, "secant at 8 mm")
    assert law.y[-1] == pytest.approx(PAPER.k_inf * 8e-3)
    assert law.y[-1] == pytest.approx(secant.y[-1])
    tangent, doubt = first(right, "elastic law"), first(right, "± 2 standard errors")
    assert tangent.y[-1] == pytest.approx(1.35e-3 * PAPER.k_inf)
    assert (doubt.low < tangent.y).all()
    with pytest.raises(dp.DataError, match="no elastic law"):
        dp.plot.elastic_law(replace(make_nonlinear_fit(), elastic_law=None))
