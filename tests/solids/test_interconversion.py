"""Relaxation to creep and back: laws first, then the paper's seal, then quadrature."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dashpot.base.errors import DataError
from dashpot.solids.interconversion import (
    CreepSpectrum,
    creep_spectrum,
    relaxation_spectrum,
    secular_zeros,
)
from dashpot.solids.maxwell import GeneralizedMaxwell

positive = st.floats(-4, 4).map(lambda power: 10.0**power)


@st.composite
def solids(draw: st.DrawFn) -> GeneralizedMaxwell:
    arms = draw(
        st.lists(
            st.tuples(positive, positive), max_size=5, unique_by=lambda a: round(np.log10(a[1]), 6)
        )
    )
    k_inf = draw(st.one_of(st.just(0.0), positive))
    b = draw(st.one_of(st.just(0.0), positive))
    if not arms and k_inf == 0 and b == 0:
        k_inf = 1.0
    return GeneralizedMaxwell(k_inf, tuple(k for k, _ in arms), tuple(t for _, t in arms), b)


def creep_of(solid: GeneralizedMaxwell) -> CreepSpectrum:
    return creep_spectrum(solid.k_inf, solid.k, solid.tau, solid.b)


@given(solids())
def test_creep_is_positive_and_ascending(solid):
    creep = creep_of(solid)
    assert creep.glass >= 0
    assert creep.flow >= 0
    assert all(d > 0 for d in creep.d)
    assert all(lam > 0 for lam in creep.lam)
    assert list(creep.lam) == sorted(creep.lam)
    assert (creep.flow > 0) == (solid.k_inf == 0)
    assert (creep.glass == 0) == (solid.b > 0)
    t = np.logspace(-6, 6, 50)
    assert (np.diff(solid.creep(t)) >= -1e-9 * solid.creep(t)[1:]).all()


@given(solids())
def test_back_and_forth_keeps_the_stiffness(solid):
    again = GeneralizedMaxwell(*relaxation_spectrum(creep_of(solid)))
    s = np.logspace(-6, 6, 13) * (0.3 + 1j)
    assert np.abs(again.stiffness_at(s) / solid.stiffness_at(s) - 1).max() < 1e-9


@given(solids())
def test_retardation_times_interlace_relaxation_times(solid):
    creep = creep_of(solid)
    assert len(creep.lam) == solid.arms + (solid.k_inf > 0) + (solid.b > 0) - 1
    # with a parallel dashpot, the fastest retardation is faster than every arm
    below = [0.0, *solid.tau] if solid.b > 0 else list(solid.tau)
    above = [*solid.tau, np.inf] if solid.b > 0 else [*solid.tau[1:], np.inf]
    for lam, low, high in zip(creep.lam, below, above, strict=False):
        assert low * (1 - 1e-12) <= lam <= high * (1 + 1e-12)


def test_the_papers_seal():
    creep = creep_spectrum(0.1965, (0.1175, 0.0178), (0.0590 / 0.1175, 0.2922 / 0.0178))
    assert creep.lam == pytest.approx((0.776312, 17.928823), abs=5e-7)
    assert creep.d == pytest.approx((1.638841, 0.436354), abs=5e-7)
    assert creep.glass == pytest.approx(3.013864, abs=5e-7)
    assert creep.equilibrium == pytest.approx(5.089059, abs=1e-6)
    assert creep.flow == 0


@pytest.mark.parametrize(
    "solid",
    [
        GeneralizedMaxwell(0.1965, (0.1175, 0.0178), (0.502127660, 16.415730337)),
        GeneralizedMaxwell(0.0, (0.1175, 0.0178), (0.5, 16.0)),
    ],
    ids=["solid", "fluid"],
)
@pytest.mark.parametrize("t", [0.1, 1.0, 10.0, 60.0])
def test_hereditary_product_is_time(solid, t):
    """The integral of E(t-u) D(u) over 0..t is t: an oracle that knows no partial fractions."""
    nodes, weights = np.polynomial.legendre.leggauss(200)
    u = t * (nodes + 1) / 2
    integral = t / 2 * weights @ (solid.relaxation(t - u) * solid.creep(u))
    assert integral == pytest.approx(t, rel=1e-12)


def test_twelve_decades_keep_every_digit():
    tau = tuple(10.0 ** np.arange(-6, 7))
    k = tuple(1.0 + 0.3 * np.sin(np.arange(13)))
    again = relaxation_spectrum(creep_spectrum(0.7, k, tau, 1e-8))
    assert again[0] == pytest.approx(0.7, rel=1e-13)
    assert again[1] == pytest.approx(k, rel=1e-12)
    assert again[2] == pytest.approx(tau, rel=1e-13)
    assert again[3] == pytest.approx(1e-8, rel=1e-12)


def test_zeros_agree_with_the_symmetric_eigenproblem():
    """c + sum w / (p - x) = 0 where x is an eigenvalue of diag(p) + sqrt(w) sqrt(w)^T / c."""
    poles, weights, c = np.array([0.3, 1.0, 5.0]), np.array([2.0, 0.1, 7.0]), 0.5
    root = np.sqrt(weights)
    zeros, slopes = secular_zeros(poles, weights, c)
    assert zeros == pytest.approx(
        np.linalg.eigvalsh(np.diag(poles) + np.outer(root, root) / c), rel=1e-13
    )
    assert slopes == pytest.approx([np.sum(weights / (poles - x) ** 2) for x in zeros], rel=1e-10)


def test_closed_forms():
    assert creep_spectrum(3.0, (), ()) == CreepSpectrum(glass=1 / 3)
    assert creep_spectrum(0.0, (), (), 2.0) == CreepSpectrum(glass=0.0, flow=0.5)
    voigt = creep_spectrum(3.0, (), (), 2.0)
    assert (voigt.glass, voigt.d) == (0.0, pytest.approx((1 / 3,)))
    assert voigt.lam == pytest.approx((2 / 3,))
    maxwell = creep_spectrum(0.0, (3.0,), (2.0,))
    assert (maxwell.glass, maxwell.flow, maxwell.d) == (1 / 3, pytest.approx(1 / 6), ())
    assert maxwell.equilibrium == np.inf
    zener = creep_spectrum(1.0, (2.0,), (0.5,))
    assert zener.lam == pytest.approx((0.5 * 3 / 1,))


def test_nothing_has_no_creep():
    with pytest.raises(DataError, match="neither stiffness nor viscosity"):
        creep_spectrum(0.0, (), ())
    with pytest.raises(DataError, match="rigid"):
        relaxation_spectrum(CreepSpectrum(glass=0.0))
