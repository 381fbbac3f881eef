"""Validation of arrays: range of an instrument and number of samples."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import dashpot as dp
from dashpot.base.arrays import (
    MAX_SAMPLES,
    MAX_SI_MAGNITUDE,
    MIN_SI_MAGNITUDE,
    compute_single_dft,
    interpolate_quantile,
    make_cosine_sequence,
    make_readonly_copy,
    sample_count,
    set_readonly,
    slow_periodogram,
    to_complex,
    to_float,
    validate_measured,
)
from dashpot.base.errors import DataError
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.nonlinear_springs import Cubic
from dashpot.solids.shift_laws import WLF, Arrhenius


@given(
    st.lists(st.floats(-MAX_SI_MAGNITUDE, MAX_SI_MAGNITUDE), min_size=1),
    st.sampled_from([MIN_SI_MAGNITUDE, -MIN_SI_MAGNITUDE, MAX_SI_MAGNITUDE, -MAX_SI_MAGNITUDE]),
)
def test_validate_measured_accepts_values_within_range(values, peak):
    array = validate_measured("force", [*values, peak])
    assert array.tolist() == [*values, peak]


@pytest.mark.parametrize(
    "peak",
    [1.01 * MAX_SI_MAGNITUDE, -1.01 * MAX_SI_MAGNITUDE, 0.99 * MIN_SI_MAGNITUDE, -1e-300, 1e308],
)
def test_what_cannot_is_refused(peak):
    with pytest.raises(DataError, match=r"force reaches .* check the unit"):
        validate_measured("force", [0.0, peak])


def test_nothing_at_all_can_be_measured():
    assert validate_measured("force", [0.0, 0.0]).tolist() == [0.0, 0.0]


@pytest.mark.parametrize("scale", [1e150, 1e300, 1e-150, 1e-300])
@pytest.mark.parametrize("name", ["time", "displacement", "force"])
def test_a_record_of_impossible_size_is_refused_where_it_is_made(name, scale):
    columns = dict.fromkeys(("time", "displacement", "force"), np.arange(1.0, 20.0))
    with pytest.raises(DataError, match=f"{name} reaches"):
        dp.RelaxationTest(**columns | {name: scale * columns[name]}, units="SI")


def test_samples_are_counted_and_bounded():
    assert sample_count(2.0, 100.4) == 201
    assert sample_count(MAX_SAMPLES, 1.0) == MAX_SAMPLES
    for duration, rate in ((MAX_SAMPLES, 1.001), (1e300, 1e300), (1.0, np.inf), (1.0, np.nan)):
        with pytest.raises(DataError, match="expected at most 2e\\+07"):
            sample_count(duration, rate)


@pytest.mark.parametrize(("n", "most"), [(97, 8), (1000, 3.3), (1000, 0), (11, 240)])
def test_slow_periodogram_is_the_plain_sum_at_its_cycles(n, most):
    values = np.random.default_rng(n).standard_normal(n) + 5.0
    cycles, power = slow_periodogram(values, most)
    turns = np.exp(-2j * np.pi * cycles[:, None] * np.arange(n) / n)
    np.testing.assert_allclose(power, abs(turns @ (values - values.mean())) ** 2 / n, atol=1e-10)
    assert cycles[-1] > min(most, 0.5 * n - 1)


def test_what_nobody_can_write_to_is_taken_as_it_is_and_all_else_is_copied():
    individual, others = set_readonly(np.arange(8.0)), np.arange(8.0)
    assert validate_measured("time", individual) is individual
    assert make_readonly_copy(individual[1:]).base is individual
    # a small part would keep the whole
    assert make_readonly_copy(individual[:1]).base is None
    view = others[:]
    view.setflags(write=False)
    retained = [
        validate_measured("time", others),
        validate_measured("time", view),
        make_readonly_copy(view),
    ]
    others[0] = 7.0
    assert [item[0] for item in retained] == [0.0, 0.0, 0.0]
    for element in (*retained, make_readonly_copy(individual)):
        with pytest.raises(ValueError, match="read-only"):
            element[0] = 1.0


@pytest.mark.parametrize("count", [1, 2, 3, 400, 401, 40_003])
def test_a_wave_and_a_turned_sum_are_those_of_exponentials(count):
    turn, size = 0.0371, 0.3 - 0.4j
    turns = np.exp(1j * turn * np.arange(count))
    values = np.random.default_rng(count).standard_normal(count)
    np.testing.assert_allclose(
        make_cosine_sequence(count, turn, size), (size * turns).real, atol=1e-11
    )
    assert compute_single_dft(values, turn) == pytest.approx(values @ turns, abs=1e-9)


@given(st.integers(1, 60), st.integers(0, 2**32), st.floats(0, 1))
def test_a_quantile_is_that_of_numpy(rows, seed, part):
    values = np.random.default_rng(seed).normal(size=(rows, 3))
    assert (interpolate_quantile(values, part) == np.quantile(values, part, axis=0)).all()


@pytest.mark.parametrize("to_numbers", [to_float, to_complex])
@pytest.mark.parametrize(
    "values", [3, [1, 2.5], np.float32(2), [Fraction(1, 2)], np.array([1.0, 2], dtype=object)]
)
def test_numbers_of_any_type_are_an_array(to_numbers, values):
    assert to_numbers(values).tolist() == np.asarray(values, dtype=float).tolist()


@pytest.mark.parametrize("to_numbers", [to_float, to_complex])
@pytest.mark.parametrize("values", ["3", ["3", 4.0], b"3", None, [None], [np.datetime64("2026")]])
def test_what_is_no_number_is_refused(to_numbers, values):
    """NumPy reads a text as a number, and None as nan."""
    with pytest.raises(TypeError):
        to_numbers(values)


@pytest.mark.parametrize(
    "function",
    [
        ElasticLaw.linear(200.0, 8e-3).path, ElasticLaw.linear(200.0, 8e-3).factor,
        Cubic(1e9).stiffness, WLF(8.86, 101.6, 296.15).log10_a_t, Arrhenius(9e4, 296.15).a_t,
    ],
)  # fmt: skip
def test_no_law_reads_a_text(function):
    for text in ("3", ["3"]):
        with pytest.raises((TypeError, dp.DataError)):
            function(text)
