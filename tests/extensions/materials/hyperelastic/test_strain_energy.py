"""Hyperelastic laws: derivatives, limits, published numbers, stability."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dashpot.base.errors import DataError
from dashpot.extensions.materials.hyperelastic.strain_energy import (
    SHEARING,
    Hyperelastic,
    direction,
)

pytestmark = pytest.mark.once

RUBBER = Hyperelastic("mooney-rivlin", (0.15e6, 0.05e6), bulk=2e9)
FOAM = Hyperelastic("hyperfoam", (0.2e6,), (8.0,), 0.0)
LAWS = {
    "neo-hooke": Hyperelastic("neo-hooke", (0.2e6,), bulk=2e9),
    "mooney-rivlin": RUBBER,
    "yeoh": Hyperelastic("yeoh", (0.2e6, -0.02e6, 0.003e6), bulk=2e9),
    # R. W. Ogden, Proc. R. Soc. A 326 (1972) 565, for Treloar's rubber, kg/cm^2 as 0.0980665 MPa,
    # mu in the convention here: mu alpha / 2 of his
    "ogden": Hyperelastic(
        "ogden",
        tuple(0.0980665e6 * m * a / 2 for m, a in ((6.3, 1.3), (0.012, 5.0), (-0.1, -2.0))),
        (1.3, 5.0, -2.0),
        bulk=2e9,
    ),
    "foam": Hyperelastic("hyperfoam", (0.2e6, 0.05e6), (8.0, -3.0), 0.3),
    "open foam": FOAM,
}


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
@pytest.mark.parametrize("mode", [*SHEARING, "volumetric"])
def test_stress_is_the_slope_of_energy_and_tangent_that_of_stress(law, mode):
    x, h = np.array([0.6, 0.9, 1.3, 2.0]), 1e-5
    sides = 2.0 if mode == "equibiaxial" else 1.0
    slope = (law.energy(mode, x + h) - law.energy(mode, x - h)) / (2 * h)
    np.testing.assert_allclose(slope, sides * law.nominal(mode, x), rtol=1e-7, atol=1e-3)
    slope = (law.nominal(mode, x + h) - law.nominal(mode, x - h)) / (2 * h)
    np.testing.assert_allclose(slope, law.tangent(mode, x), rtol=1e-7)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_small_strains_are_linear_to_the_last_digits(law):
    e, v, E = 1e-7, law.poisson, 2 * (1 + law.poisson) * law.shear_modulus
    expected = {"uniaxial": E, "equibiaxial": E / (1 - v), "planar": E / (1 - v**2)}
    for mode, modulus in expected.items():
        assert law.nominal(mode, 1 + e) == pytest.approx(modulus * e, rel=1e-5)
        assert law.tangent(mode, 1.0) == pytest.approx(modulus, rel=1e-12)
    assert law.nominal("volumetric", 1 + e) == pytest.approx(law.bulk_modulus * e, rel=1e-5)


def test_a_published_law_has_its_published_modulus():
    # R. W. Ogden's constants for L. R. G. Treloar's rubber: 4.225 kg/cm^2, 0.4225 MPa as G. A.
    # Holzapfel, Nonlinear Solid Mechanics (2000), writes it, 1 kg/cm^2 for 0.1 MPa
    assert LAWS["ogden"].shear_modulus / 0.0980665e6 == pytest.approx(4.225)


def test_uniaxial_compression_is_equibiaxial_tension():
    """A rubber under pressure from two sides and pull from one differ by a pressure alone."""
    b = np.array([1.1, 1.5, 2.5])
    for name in ("neo-hooke", "mooney-rivlin", "yeoh", "ogden"):
        law, x = LAWS[name], b**-2
        true = law.nominal("equibiaxial", b) * b
        np.testing.assert_allclose(law.nominal("uniaxial", x) * x, -true, rtol=1e-12)


def test_closed_forms_of_mooney_rivlin_at_twice_the_length():
    nominals = [RUBBER.nominal(mode, 2.0) for mode in SHEARING]
    # 2 (l - l^-2)(C10 + C01 / l), 2 (l - l^-5)(C10 + C01 l^2), 2 (l - l^-3)(C10 + C01)
    np.testing.assert_allclose(nominals, [0.6125e6, 1.378125e6, 0.75e6], rtol=1e-14)
    assert 2 * RUBBER.nominal("equibiaxial", 2.0) == pytest.approx(2.75625e6, rel=1e-14)


def test_ogden_of_two_and_minus_two_is_mooney_rivlin():
    same = Hyperelastic("ogden", (0.3e6, 0.1e6), (2.0, -2.0))
    x = np.linspace(0.4, 4, 30)
    for mode in SHEARING:
        np.testing.assert_allclose(same.nominal(mode, x), RUBBER.nominal(mode, x), atol=1e-6)
        np.testing.assert_allclose(same.drucker(mode, x), RUBBER.drucker(mode, x), rtol=1e-9)


def test_an_exponent_through_zero_is_smooth():
    stress = [
        Hyperelastic("ogden", (1e6,), (a,)).nominal("uniaxial", 2.0) for a in (-1e-4, 0, 1e-4)
    ]
    assert stress[1] == pytest.approx(0.5 * (stress[0] + stress[2]), rel=1e-6)


@pytest.mark.parametrize(
    ("stretch", "secant", "tangent"),
    [(0.95, 0.354294, 0.312684), (0.9, 0.316407, 0.247733), (0.8, 0.260071, 0.169875),
     (0.7, 0.224370, 0.143218), (0.6, 0.204834, 0.155218)],
)  # fmt: skip
def test_secant_and_tangent_of_a_foam(stretch, secant, tangent):
    """(2 mu / alpha)(l^(alpha-1) - 1/l), closed; the tangent has a least value, the plateau."""
    stress = float(FOAM.nominal("uniaxial", stretch))
    assert stress / (stretch - 1) == pytest.approx(secant * 1e6, abs=0.5)
    assert FOAM.tangent("uniaxial", stretch) == pytest.approx(tangent * 1e6, abs=0.5)
    assert 2 * (1 + FOAM.poisson) * FOAM.shear_modulus == pytest.approx(0.4e6)
    if stretch == 0.6:
        assert stress == pytest.approx(-0.0819337e6, rel=1e-6)


def test_the_faces_of_a_foam_are_free():
    law = LAWS["foam"]
    for mode in SHEARING:
        e = math.log(0.7) * direction(mode, law.poisson)
        J = np.exp(e.sum())
        beta = law.poisson / (1 - 2 * law.poisson)
        free = sum(
            2 * m / a * (np.exp(a * e[2]) - J ** (-a * beta))
            for m, a in zip(law.constants, law.exponents, strict=True)
        )
        assert abs(free) < 1e-9 * law.shear_modulus


def test_where_mooney_rivlin_with_a_negative_constant_is_not_stable():
    """In tension it first fails across, where C10 / l + C01 l = 0."""
    law = Hyperelastic("mooney-rivlin", (0.15, -0.05))
    low, high = law.stable_range("uniaxial")
    assert high == pytest.approx(math.sqrt(3), rel=1e-6)
    assert law.drucker("uniaxial", 0.99 * high) > 0 > law.drucker("uniaxial", 1.01 * high)
    assert 0.1 < low < 1
    assert law.stable_range("equibiaxial")[1] == pytest.approx(low**-0.5, rel=1e-6)


def test_power_laws_of_positive_terms_are_stable_everywhere():
    for name in ("ogden", "foam", "open foam"):
        assert all(LAWS[name].stable_range(mode) == (None, None) for mode in SHEARING)
    assert Hyperelastic("neo-hooke", (-1.0,)).stable_range("planar") == (1.0, 1.0)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("mooney", (1.0,)), "expected one of neo-hooke"),
        (("mooney-rivlin", (1.0,)), "1 constants"),
        (("ogden", (1.0, 2.0), (1.0,)), "an exponent for each"),
        (("yeoh", (1.0, 2.0, math.nan)), "finite"),
        (("hyperfoam", (1.0,), (2.0,), 0.5), "below 0.5"),
        (("neo-hooke", (1.0,), (), 0.4), "0.5 of all others"),
        (("neo-hooke", (1.0,), (), 0.5, -1.0), "bulk modulus"),
    ],
)
def test_what_is_no_law_is_refused(words, message):
    with pytest.raises(DataError, match=message):
        Hyperelastic(*words)


def test_a_rubber_of_unknown_volume_says_so():
    with pytest.raises(DataError, match="no bulk modulus"):
        Hyperelastic("neo-hooke", (1.0,)).nominal("volumetric", 0.99)
