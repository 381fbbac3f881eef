"""The bare engine on the certified sums of exponentials of NIST, with no start."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dashpot.base.errors import DataError, FitError
from dashpot.extensions.paper.exponential_sum import exponential_sum

# NIST/ITL StRD, nonlinear regression: Lanczos1-3 (C. Lanczos, Applied Analysis, 1956), MGH17
LANCZOS_X = 0.05 * np.arange(24)
LANCZOS1 = """
    2.513400000000E+00 2.044333373291E+00 1.668404436564E+00 1.366418021208E+00 1.123232487372E+00
    9.268897180037E-01 7.679338563728E-01 6.388775523106E-01 5.337835317402E-01 4.479363617347E-01
    3.775847884350E-01 3.197393199326E-01 2.720130773746E-01 2.324965529032E-01 1.996589546065E-01
    1.722704126914E-01 1.493405660168E-01 1.300700206922E-01 1.138119324644E-01 1.000415587559E-01
    8.833209084540E-02 7.833544019350E-02 6.976693743449E-02 6.239312536719E-02"""
LANCZOS2 = """
    2.51340E+00 2.04433E+00 1.66840E+00 1.36642E+00 1.12323E+00 9.26890E-01 7.67934E-01 6.38878E-01
    5.33784E-01 4.47936E-01 3.77585E-01 3.19739E-01 2.72013E-01 2.32497E-01 1.99659E-01 1.72270E-01
    1.49341E-01 1.30070E-01 1.13812E-01 1.00042E-01 8.83321E-02 7.83354E-02 6.97669E-02 6.23931E-02
"""
LANCZOS3 = """
    2.5134 2.0443 1.6684 1.3664 1.1232 0.9269 0.7679 0.6389 0.5338 0.4479 0.3776 0.3197
    0.2720 0.2325 0.1997 0.1723 0.1493 0.1301 0.1138 0.1000 0.0883 0.0783 0.0698 0.0624"""
MGH17_X = 10.0 * np.arange(33)
MGH17 = """
    0.844 0.908 0.932 0.936 0.925 0.908 0.881 0.850 0.818 0.784 0.751 0.718 0.685 0.658 0.628 0.603
    0.580 0.558 0.538 0.522 0.506 0.490 0.478 0.467 0.457 0.448 0.438 0.431 0.424 0.420 0.414 0.411
    0.406"""
CERTIFIED = {  # amplitudes, rates, their standard deviations, SSE
    "Lanczos1": (
        LANCZOS1,
        (9.5100000027e-02, 8.6070000013e-01, 1.5575999998e00),
        (1.0000000001e00, 3.0000000002e00, 5.0000000001e00),
        None,
        None,
    ),
    "Lanczos2": (
        LANCZOS2,
        (9.6251029939e-02, 8.6424689056e-01, 1.5529016879e00),
        (1.0057332849e00, 3.0078283915e00, 5.0028798100e00),
        (3.3989646176e-03, 4.1707005856e-03, 1.3958787284e-03),
        2.2299428125e-11,
    ),
    "Lanczos3": (
        LANCZOS3,
        (8.6816414977e-02, 8.4400777463e-01, 1.5825685901e00),
        (9.5498101505e-01, 2.9515951832e00, 4.9863565084e00),
        (9.7041624475e-02, 1.0766312506e-01, 3.4436403035e-02),
        1.6117193594e-08,
    ),
}


def parse_values(table: str) -> np.ndarray:
    return np.array(table.split(), dtype=float)


def digits(values: np.ndarray, certified: tuple[float, ...]) -> float:
    """Correct digits of the worst value; the certificate itself has eleven."""
    error = np.abs(values - np.array(certified)) / np.abs(certified)
    return float(min(11.0, -np.log10(error.max() + 1e-11)))


@pytest.mark.parametrize("name", CERTIFIED)
def test_lanczos_without_a_start(name: str) -> None:
    table, amplitudes, rates, rate_errors, sse = CERTIFIED[name]
    result = exponential_sum(LANCZOS_X, parse_values(table), terms=3)
    assert result.converged
    assert min(digits(result.rates, rates), digits(result.amplitudes, amplitudes)) >= 10
    if sse is not None:
        assert result.sse == pytest.approx(sse, rel=2e-10)
        np.testing.assert_allclose(result.rate_errors, rate_errors, rtol=1e-6)


def test_mgh17_without_a_start_needs_a_negative_amplitude() -> None:
    result = exponential_sum(MGH17_X, parse_values(MGH17), terms=2, constant=True, signed=True)
    assert digits(result.rates, (1.2867534640e-02, 2.2122699662e-02)) >= 10
    assert digits(result.amplitudes, (1.9358469127e00, -1.4646871366e00)) >= 10
    assert digits(np.array([result.constant]), (3.7541005211e-01,)) >= 10
    assert result.sse == pytest.approx(5.4648946975e-05, rel=1e-10)
    assert result.constant_error == pytest.approx(2.0723153551e-03, rel=1e-6)
    assert result.certificate is None


@given(
    shift=st.floats(-10, 10),
    rates=st.lists(st.floats(0.2, 12), min_size=2, max_size=2).filter(
        lambda r: max(r) > 3 * min(r)
    ),
)
@settings(max_examples=15, deadline=None)
def test_exact_data_anywhere_on_the_axis_come_back(shift: float, rates: list[float]) -> None:
    x = np.linspace(0, 3, 120)
    slow, fast = sorted(rates)
    y = 2 * np.exp(-slow * x) + 3 * np.exp(-fast * x)
    result = exponential_sum(x + shift, y, terms=2)
    np.testing.assert_allclose(result.rates, [slow, fast], rtol=1e-8)
    np.testing.assert_allclose(result(x + shift), y, atol=1e-10)


def test_a_term_that_is_not_there_is_not_invented() -> None:
    x = np.linspace(0, 5, 200)
    result = exponential_sum(x, 2 * np.exp(-x), terms=3)
    assert len(result.rates) == 1
    assert result.rates[0] == pytest.approx(1, rel=1e-10)
    assert result.certificate is not None
    assert result.certificate.optimal


def test_weights_are_inverse_standard_deviations() -> None:
    generator = np.random.default_rng(3)
    x = np.linspace(0, 5, 200)
    sd = np.where(x < 1, 1e-3, 1e-1)
    y = 2 * np.exp(-3 * x) + 1 + sd * generator.normal(size=200)
    result = exponential_sum(x, y, terms=1, constant=True, weights=1 / sd)
    plain = exponential_sum(x, y, terms=1, constant=True)
    assert abs(result.rates[0] - 3) < 4 * result.rate_errors[0]
    assert result.rate_errors[0] < plain.rate_errors[0]
    assert result.sse == pytest.approx(200, rel=0.4)


def test_refusals_say_what_to_do() -> None:
    with pytest.raises(FitError, match="at least one exponential"):
        exponential_sum([0, 1, 2], [3, 2, 1], terms=0)
    with pytest.raises(DataError, match="fit fewer terms"):
        exponential_sum([0, 1, 2], [3, 2, 1], terms=2)
    with pytest.raises(DataError, match="comes twice"):
        exponential_sum([0, 1, 1, 2], [3, 2, 1, 1], terms=1)
