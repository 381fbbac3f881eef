"""Standard errors of an estimate: noise alone, and noise with errors of the rig."""

from __future__ import annotations

import numpy as np
import pytest
from kit.fits import a_fit

from dashpot.base.errors import DataError
from dashpot.base.reported_values import ReportedValue
from dashpot.datamodel.parameter_estimate import Profile
from dashpot.extensions.materials.csr.lifetime_prediction import scale_for_aging
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.workflow.json_archive import from_json, to_json

SEAL = GeneralizedMaxwell(196.5, (117.5, 17.8), (0.5, 16.4))
# by two doubts: of k_inf, both k, both ln tau
SHIFTS = np.array([[1.0, 0.0], [2.0, 3.0], [0.5, 0.0], [0.0, 0.04], [0.01, -0.02]])


def make_fit_with_rig_errors(**inputs):
    fit = a_fit(SEAL, **inputs)
    return a_fit(SEAL, estimate=fit.estimate.with_rig(SHIFTS))


def test_standard_error_includes_rig_and_noise():
    fit, quiet = make_fit_with_rig_errors(), a_fit(SEAL)
    error, noise = fit.standard_error, quiet.standard_error
    assert error["k"][0] == pytest.approx(np.sqrt(1.175**2 + 2**2 + 3**2))
    assert error["tau"][1] == pytest.approx(16.4 * np.sqrt(0.01**2 + 0.01**2 + 0.02**2))
    # of b = k tau both parts move together: 3/117.5 and .04 of the second doubt
    of_noise = (noise["b"][0] / 58.75) ** 2
    rig = (2 / 117.5) ** 2 + (3 / 117.5 + 0.04) ** 2
    assert error["b"][0] == pytest.approx(58.75 * np.sqrt(of_noise + rig))
    assert fit.estimate.noise_only == quiet.estimate
    assert quiet.estimate.noise_only is quiet.estimate
    # a second rig leaves the noise as it is
    assert fit.estimate.with_rig(SHIFTS).noise_only == quiet.estimate


def test_either_side_of_a_profile_grows_by_what_the_rig_may_have_done():
    value = np.linspace(SEAL.k[0] - 4, SEAL.k[0] + 8, 121)
    # twice as steep below the optimum as above
    away = value - SEAL.k[0]
    profile = Profile("k_1", value, np.where(away < 0, 2 * away, away) ** 2)
    fit = make_fit_with_rig_errors(profiles=(profile,))
    ends = fit.estimate.confidence_limits(SEAL, 0.95)["k_1"]
    q, by = fit.estimate.quantile(0.95), np.hypot(2.0, 3.0)
    assert SEAL.k[0] - ends[0] == pytest.approx(q * np.hypot(0.5, by), rel=1e-3)
    assert ends[1] - SEAL.k[0] == pytest.approx(q * np.hypot(1.0, by), rel=1e-3)
    # an end that the data leave open stays open
    open_above = Profile("k_1", value, np.where(away < 0, away**2, 0.1 * (away > 0)))
    assert (
        make_fit_with_rig_errors(profiles=(open_above,)).estimate.confidence_limits(SEAL, 0.95)[
            "k_1"
        ][1]
        == np.inf
    )


def test_what_scales_a_fit_scales_both():
    fit = make_fit_with_rig_errors()
    twice = fit.in_parallel(2)
    assert twice.standard_error["k"] == pytest.approx(2 * np.array(fit.standard_error["k"]))
    assert twice.standard_error["tau"] == pytest.approx(fit.standard_error["tau"])
    quiet, before = (fit.estimate.noise_only for fit in (twice, fit))
    assert quiet.errors(twice.solid)["k_1"] == pytest.approx(2 * before.errors(SEAL)["k_1"])
    aged = scale_for_aging(fit, ReportedValue("left", 0.5, error=0.1), "after a year")
    of_noise = aged.estimate.noise_only.errors(aged.solid)["k_1"]
    assert of_noise == pytest.approx(np.hypot(0.5 * 1.175, 0.1 * 117.5))
    assert aged.standard_error["k"][0] == pytest.approx(
        np.sqrt((0.5 * fit.standard_error["k"][0]) ** 2 + 11.75**2)
    )


def test_a_document_keeps_both():
    fit = make_fit_with_rig_errors()
    again = from_json(to_json(fit))
    assert again == fit
    assert again.estimate.noise_only == fit.estimate.noise_only
    # one of no doubted rig has one covariance
    assert "noise_covariance" not in a_fit(SEAL).to_dict()


def test_covariance_must_have_one_row_per_parameter():
    with pytest.raises(DataError, match="noise_covariance has shape"):
        a_fit(SEAL, noise_covariance=np.eye(3))
