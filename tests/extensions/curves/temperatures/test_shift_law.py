"""A law through shifts: exact shifts give it back, correlated ones with honest errors."""

import numpy as np
import pytest

import dashpot as dp
from dashpot.extensions.curves.shift_law_fit import fit_shift_law
from dashpot.extensions.curves.superposition import checks

REFERENCE = 293.15
TEMPERATURES = REFERENCE + np.arange(-40.0, 41.0, 10.0)
WLF = dp.solids.WLF(8.0, 110.0, REFERENCE)
ARRHENIUS = dp.solids.Arrhenius(90e3, REFERENCE)
AWAY = TEMPERATURES != REFERENCE


def build_chained_covariance(sd):
    """Covariance of shifts that were chained from the reference, step by step."""
    order = np.arange(9) - 4
    same = np.sign(order[:, None]) == np.sign(order)
    return sd**2 * np.where(same, np.minimum(abs(order[:, None]), abs(order)), 0)


def draw_shifts(law, sd, seed):
    noise = np.random.default_rng(seed).standard_normal(9)
    values, vectors = np.linalg.eigh(build_chained_covariance(sd))
    return law.log10_a_t(TEMPERATURES) + AWAY * (vectors * np.sqrt(abs(values)) @ noise)


@pytest.mark.parametrize("law", [WLF, ARRHENIUS], ids=lambda law: law.kind)
def test_exact_shifts_give_their_law_back(law):
    shift_law_fit = fit_shift_law(
        TEMPERATURES,
        law.log10_a_t(TEMPERATURES),
        build_chained_covariance(1e-3),
        reference=REFERENCE,
    )
    assert shift_law_fit.law.kind == law.kind
    for name in shift_law_fit.parameters:
        assert getattr(shift_law_fit.law, name) == pytest.approx(getattr(law, name), rel=1e-6)
    assert [score.dof for score in shift_law_fit.scores if score.kind == law.kind] == [
        9 - 1 - len(shift_law_fit.parameters)
    ]


@pytest.mark.parametrize(("law", "least"), [(WLF, 40), (ARRHENIUS, 36)], ids=["wlf", "arrhenius"])
def test_fit_shift_law_selects_by_bic_with_valid_intervals(law, least):
    right, inside = 0, []
    for seed in range(40):
        shift_law_fit = fit_shift_law(
            TEMPERATURES,
            draw_shifts(law, 0.02, seed),
            build_chained_covariance(0.02),
            reference=REFERENCE,
        )
        right += shift_law_fit.law.kind == law.kind
        retained = fit_shift_law(
            TEMPERATURES,
            draw_shifts(law, 0.02, seed),
            build_chained_covariance(0.02),
            reference=REFERENCE,
            law=law.kind,
        )
        error = [getattr(retained.law, name) - getattr(law, name) for name in retained.parameters]
        inside.append(np.abs(error) < 1.96 * np.sqrt(np.diag(retained.covariance)))
    assert right >= least
    assert np.mean(inside) >= 0.9


def test_the_derivatives_of_wlf_are_those_of_the_law():
    shift_law_fit = fit_shift_law(
        TEMPERATURES,
        WLF.log10_a_t(TEMPERATURES),
        build_chained_covariance(0.02),
        reference=REFERENCE,
    )
    h = 1e-4
    jacobian = np.column_stack(
        [
            (dp.solids.WLF(8 + a, 110 + b, REFERENCE).log10_a_t(TEMPERATURES)
             - dp.solids.WLF(8 - a, 110 - b, REFERENCE).log10_a_t(TEMPERATURES)) / (2 * h)
            for a, b in ((h, 0), (0, h))
        ]
    )[AWAY]  # fmt: skip
    weight = np.linalg.inv(build_chained_covariance(0.02)[np.ix_(AWAY, AWAY)])
    np.testing.assert_allclose(
        shift_law_fit.covariance, np.linalg.inv(jacobian.T @ weight @ jacobian), rtol=1e-4
    )


def test_a_law_that_misses_the_shifts_has_wider_errors():
    shifts = WLF.log10_a_t(TEMPERATURES)
    close, rough = (
        fit_shift_law(
            TEMPERATURES, shifts, build_chained_covariance(sd), reference=REFERENCE, law="arrhenius"
        )
        for sd in (0.01, 0.02)
    )
    assert close.score.deviance == pytest.approx(4 * rough.score.deviance)
    np.testing.assert_allclose(close.covariance, rough.covariance)


def test_two_temperatures_keep_their_shift_and_three_have_a_law():
    t = np.array([273.15, 293.15, 313.15])
    s = ARRHENIUS.log10_a_t(t)
    two = fit_shift_law(t[:2], s[:2], np.diag([1e-4, 0.0]), reference=REFERENCE)
    assert two.law == dp.solids.FreeShifts(tuple(t[:2]), tuple(s[:2]), REFERENCE)
    assert (
        fit_shift_law(t, s, np.diag([1e-4, 0, 1e-4]), reference=REFERENCE).law.kind == "arrhenius"
    )
    shift_law_fit = fit_shift_law(
        t[:2], s[:2], np.diag([1e-4, 0.0]), reference=REFERENCE, law="arrhenius"
    )
    assert shift_law_fit.law.energy == pytest.approx(90e3)


def test_shifts_that_rise_with_temperature_have_no_law():
    s = -WLF.log10_a_t(TEMPERATURES)
    assert (
        fit_shift_law(TEMPERATURES, s, build_chained_covariance(0.01), reference=REFERENCE).law.kind
        == "free"
    )
    with pytest.raises(dp.FitError, match="must fall as it gets warmer"):
        fit_shift_law(
            TEMPERATURES, s, build_chained_covariance(0.01), reference=REFERENCE, law="wlf"
        )
    with pytest.raises(dp.FitError, match="expected one of"):
        fit_shift_law(
            TEMPERATURES, s, build_chained_covariance(0.01), reference=REFERENCE, law="vft"
        )


@pytest.mark.parametrize("i", [0, 2, 5, 8])
def test_fit_shift_law_names_the_outlying_temperature(i):
    shifts, sd = draw_shifts(WLF, 0.005, i), build_chained_covariance(0.005)
    assert fit_shift_law(TEMPERATURES, shifts, sd, reference=REFERENCE).outlier is None
    shifts[i] -= 0.15
    odd = fit_shift_law(TEMPERATURES, shifts, sd, reference=REFERENCE).outlier
    assert odd.temperature == TEMPERATURES[i]
    assert odd.missed == pytest.approx(-0.15, abs=0.06)


def test_fit_shift_law_names_no_outlier_of_a_general_misfit():
    bent = WLF.log10_a_t(TEMPERATURES) + 0.2 * np.cos(np.arange(9) * np.pi) * AWAY
    assert (
        fit_shift_law(
            TEMPERATURES, bent, build_chained_covariance(0.005), reference=REFERENCE
        ).outlier
        is None
    )


@pytest.mark.parametrize("temperatures", [(0, 23, 50, 80), (-10, 23, 60, 90), (0, 23, 40, 60, 90)])
@pytest.mark.parametrize("sigmas", [-1.8, -1.0, 1.0, 1.8])
def test_uncertain_shift_of_a_hot_test_blames_no_other_temperature(temperatures, sigmas):
    """A seal that relaxes within the ramp leaves its own shift open, not that of the others."""
    kelvin = 273.15 + np.array(temperatures, dtype=float)
    law = dp.solids.WLF(8.0, 110.0, kelvin[1])
    error = np.where(kelvin == kelvin[1], 0.0, 0.008)
    error[-1] = 0.13
    shifts = law.log10_a_t(kelvin) + sigmas * error * (kelvin == kelvin[-1])
    covariance = np.diag(error**2)
    assert fit_shift_law(kelvin, shifts, covariance, reference=kelvin[1]).outlier is None
    if len(kelvin) > 4:  # one that is known, and off, is named beside it
        shifts[0] += 0.3
        result = fit_shift_law(kelvin, shifts, covariance, reference=kelvin[1]).outlier
        assert result is None or result.temperature != kelvin[-1]


@pytest.mark.parametrize(
    ("steps", "totals", "named"),
    [((0.01, 0.8), (0.02, 0.0, 0.8), "80 degC"), ((0.9, 0.01), (0.9, 0.0, 0.01), "0 degC"),
     ((2.9, 0.1), (0.0, 2.9, 2.9), "23 degC")],
)  # fmt: skip
def test_step_that_is_not_determined_names_the_flat_curve(steps, totals, named):
    check = checks.shifts_determined(
        np.array(steps), np.array([273.15, 296.15, 353.15]), np.array(totals)
    )
    assert check.failed
    assert f"The curve at {named} is flat and fits anywhere" in check.message
