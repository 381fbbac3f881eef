"""A mass on seals that harden: where it rests, and which stiffness vibrates there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from kit import hardening
from kit.fits import a_fit

from dashpot.base.errors import DataError
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.frf import FRF
from dashpot.datamodel.specimen import Specimen
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.vibration.checks import compression_tested
from dashpot.vibration.comparison.compare import compare
from dashpot.vibration.mass_on_seals import MassOnSeals, operating_point, predict_frf

TABLE_1 = GeneralizedMaxwell(196.5, (117.5, 17.8), (59.0 / 117.5, 292.2 / 17.8))
MASS, SEALS = 0.104, 2.0
LINES = np.arange(4.0, 40.0, 0.05)


def law(se: float = 0.0) -> ElasticLaw:
    knots, shape = hardening.law()
    return ElasticLaw(tuple(knots), tuple(shape), 196.5, (se,) * len(knots) if se else ())


def hard(se: float = 0.0) -> Fit:
    return replace(a_fit(TABLE_1, relative=1e-3), elastic_law=law(se))


def straight() -> Fit:
    return replace(a_fit(TABLE_1), elastic_law=ElasticLaw.linear(196.5, 8e-3))


# -- laws -------------------------------------------------------------------------------------


def test_a_straight_law_changes_nothing() -> None:
    solid = predict_frf(SEALS * TABLE_1, mass=MASS, frequency=LINES)
    for fit in (a_fit(TABLE_1), straight()):
        for compression in (None, 1e-3):
            frf = predict_frf(fit, mass=MASS, seals=SEALS, frequency=LINES, compression=compression)
            np.testing.assert_array_equal(frf.value, solid.value)


@pytest.mark.parametrize("fit", [straight(), hard()], ids=["straight", "hardening"])
def test_operating_point_refuses_compression_far_outside_the_test(fit: Fit) -> None:
    operating_point(fit, MassOnSeals(MASS, compression=23.9e-3))
    for refused in (
        lambda: operating_point(fit, MassOnSeals(MASS, compression=24.1e-3)),
        lambda: operating_point(fit, MassOnSeals(104.0, SEALS)),
        lambda: fit.at_compression(24.1e-3),
        lambda: predict_frf(fit, mass=104.0, seals=SEALS, frequency=LINES),
    ):
        with pytest.raises(DataError, match="tested to 8 mm"):
            refused()
    low = replace(fit, provenance=replace(fit.provenance, specimen=Specimen(height=12e-3)))
    operating_point(low, MassOnSeals(MASS, compression=11.9e-3))
    with pytest.raises(DataError, match=r"by 12 mm, but it is 12 mm high: check its unit"):
        operating_point(low, MassOnSeals(MASS, compression=12e-3))


def test_at_the_tested_depth_of_a_straight_piece_the_factor_is_its_tangent() -> None:
    point = operating_point(hard(), MassOnSeals(MASS, SEALS, 8e-3))
    assert point.factor == law().ratio[-1]
    assert point.is_stated
    solid = point.solid(hard())
    assert solid == hard().model_at(8e-3)


@settings(max_examples=100, deadline=None)
@given(
    st.lists(st.floats(0.0, 5.0), min_size=2, max_size=9).filter(lambda t: max(t) > 0.1),
    st.floats(0.0, 1.4),
)
def test_compression_inverts_force(shape: list[float], part: float) -> None:
    # what is soft is soft by a part of what is stiff, or not there at all
    shape, part = [item if item > 1e-6 else 0.0 for item in shape], part if part > 1e-6 else 0.0
    knots = np.linspace(0.0, 8e-3, len(shape))
    mean = float(np.trapezoid(shape, knots)) / 8e-3
    if mean < 0.05 or (shape[-1] < 1e-3 and part > 1):
        return
    elastic_law = ElasticLaw(tuple(knots), tuple(np.array(shape) / mean), 196.5)
    wanted = part * float(elastic_law.force(8e-3))
    assert float(elastic_law.force(elastic_law.compression(wanted))) == pytest.approx(
        wanted, rel=1e-9, abs=1e-12
    )


def test_no_compression_carries_what_a_law_cannot() -> None:
    soft = ElasticLaw((0.0, 8e-3), (2.0, 0.0), 100.0)
    with pytest.raises(DataError, match="no compression carries"):
        soft.compression(1.0)


def test_seals_and_compression_belong_to_a_fit() -> None:
    for inputs in ({"seals": 2.0}, {"compression": 1e-3}):
        with pytest.raises(DataError, match="belong to a fit"):
            predict_frf(TABLE_1, mass=MASS, frequency=LINES, **inputs)
    with pytest.raises(DataError, match="modulus"):
        predict_frf(replace(straight(), unit="Pa"), mass=MASS, frequency=LINES)


# -- numbers ----------------------------------------------------------------------------------


def test_the_block_of_the_paper_sags_where_the_cubic_carries_it() -> None:
    at = hardening.resting(MASS, SEALS)
    assert at == pytest.approx(3.25e-3, rel=0.02)
    point = operating_point(hard(), MassOnSeals(MASS, SEALS))
    assert point.compression == pytest.approx(at, rel=2e-3)
    assert point.factor == pytest.approx(hardening.tangent(at) / 196.5, rel=5e-3)
    assert not point.is_extrapolated


def test_operating_point_outside_the_test_extends_the_last_tangent() -> None:
    point = operating_point(hard(), MassOnSeals(1.0, SEALS))
    assert point.is_extrapolated
    assert point.factor == law().ratio[-1]
    carried = law().force(8e-3) + law().tangent(8e-3) * (point.compression - 8e-3)
    assert SEALS * float(carried) == pytest.approx(9.80665)
    frf = predict_frf(hard(), mass=1.0, seals=SEALS, frequency=LINES)
    values = {c.name: c for c in compare(frf, frf, fit=hard(), mass=1.0, seals=SEALS).checks}
    assert values["operating_point"].failed
    assert "last tangent" in values["operating_point"].message


def test_predict_frf_without_frequencies_covers_the_peak() -> None:
    frf = predict_frf(hard(), mass=MASS, seals=SEALS)
    top = float(frf.frequency[np.argmax(np.abs(frf.value))])
    scale = hardening.tangent(hardening.resting(MASS, SEALS)) / 196.5
    assert top == pytest.approx(hardening.peak(MASS, SEALS, scale), rel=3e-3)


# -- an independent hammer --------------------------------------------------------------------


def test_compare_at_the_operating_point_agrees_with_the_tangent() -> None:
    scale = hardening.tangent(hardening.resting(MASS, SEALS)) / 196.5
    value, sd = hardening.simulate_accelerance(
        LINES, mass=MASS, seals=SEALS, scale=scale, noise=0.005, seed=3
    )
    frf = FRF(LINES, value, sd=sd, averages=4, units="SI")

    def compute_frequency_error(fit: Fit) -> float:
        predicted = predict_frf(fit, mass=MASS, seals=SEALS, frequency=LINES)
        return compare(predicted, frf, fit=fit, mass=MASS, seals=SEALS).frequency_error

    assert abs(compute_frequency_error(hard())) < 0.003
    # 9.8 % of stiffness is 4.8 % of frequency
    assert compute_frequency_error(straight()) == pytest.approx(scale**-0.5 - 1, abs=2e-3)
    assert abs(compute_frequency_error(straight())) > 0.03


def test_a_comparison_needs_the_mass_where_the_stiffness_depends_on_it() -> None:
    frf = predict_frf(hard(), mass=MASS, seals=SEALS, frequency=LINES)
    with pytest.raises(DataError, match="give --mass"):
        compare(frf, frf, fit=hard(), seals=SEALS)
    point = predict_frf(hard(), mass=MASS, seals=SEALS, frequency=LINES, compression=2.6e-3)
    comparison = compare(point, frf, fit=hard(), seals=SEALS, compression=2.6e-3)
    assert comparison.predicted_hz < comparison.measured_hz


def test_thrice_the_tested_depth_is_too_deep() -> None:
    assert compression_tested(2.99, 1.0).grade == "limit"
    assert compression_tested(3.01, 1.0).grade == "stop"
    assert compression_tested(3.0, None).passed is None
