"""Solids from an FRF alone: Zhang and Richards' method."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib import import_module
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dashpot.base.errors import DataError, FitError, Status
from dashpot.datamodel.frf import FRF
from dashpot.fitting.identification.identify import identify
from dashpot.fitting.identification.prior_knowledge import HammerRig, SolidPrior
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.vibration.comparison.compare import infer_mass
from dashpot.vibration.mass_on_seals import accelerance, model_modes, poles, predict_frf

EXACT_RIG = HammerRig(mass_sd=0.0, gain_sd=0.0, delay_sd=0.0)
VOIGT = SolidPrior(parallel_dashpot=True)
# domain reference, row [14]: a rubber isolator with three arms under 5 kg
ISOLATOR = GeneralizedMaxwell(1e5, (3e4,) * 3, tuple(1 / (2 * np.pi * f) for f in (5, 20, 80)))
LINES = np.linspace(5, 100, 191)


@pytest.fixture(scope="module")
def isolator_frf() -> FRF:
    return predict_frf(ISOLATOR, mass=5.0, frequency=LINES)


def misfit_db(model: GeneralizedMaxwell, frf: FRF) -> tuple[float, float]:
    message = predict_frf(model, mass=5.0, frequency=frf.frequency)
    db = 20 * np.log10(np.abs(message.value) / np.abs(frf.value))
    return float(np.sqrt(np.mean(db**2))), float(np.abs(db).max())


def noisy(frf: FRF, relative: float, seed: int) -> FRF:
    sd = relative * np.abs(frf.value) / np.sqrt(2)
    draw = np.random.default_rng(seed).standard_normal((2, len(sd)))
    return replace(frf, value=frf.value + sd * (draw[0] + 1j * draw[1]), sd=sd, averages=5)


def test_the_benchmark_has_its_frequency_and_damping() -> None:
    (mode,) = model_modes(ISOLATOR, 5.0)
    assert mode.frequency == pytest.approx(28.07560, abs=5e-6)
    assert mode.damping_ratio == pytest.approx(0.0996519, abs=5e-8)


@pytest.mark.parametrize(
    ("options", "rms", "largest"),
    [
        ({"arms": 0, "solid_prior": replace(VOIGT, static_stiffness=1e5)}, 3.20, 9.84),
        ({"arms": 0, "solid_prior": VOIGT}, 0.585, 2.10),
        ({"arms": 1, "solid_prior": SolidPrior(static_stiffness=1e5)}, 0.236, 0.851),
        ({"arms": 2}, 0.027, 0.112),
        ({"arms": 3}, 0.0, 0.0),
    ],
    ids=["Voigt with the static stiffness", "Voigt", "one arm, static", "two arms", "three arms"],
)
def test_zhang_and_richards_ladder(
    isolator_frf: FRF, options: dict[str, object], rms: float, largest: float
) -> None:
    """A Voigt solid cannot, one arm nearly, two arms do, three are exact."""
    fit = identify(isolator_frf, mass=5.0, band=(5, 100), rig=EXACT_RIG, **options)
    assert fit.method == "frf"
    assert misfit_db(fit.model, isolator_frf) == pytest.approx((rms, largest), rel=0.02, abs=1e-6)


def test_three_arms_are_recovered_exactly(isolator_frf: FRF) -> None:
    fit = identify(isolator_frf, mass=5.0, band=(5, 100), arms=3, rig=EXACT_RIG)
    assert fit.model.k_inf == pytest.approx(1e5, rel=1e-8)
    assert fit.model.k == pytest.approx(ISOLATOR.k, rel=1e-7)
    assert fit.model.tau == pytest.approx(ISOLATOR.tau, rel=1e-7)
    assert fit.status is Status.CONVERGED


def test_constraints_are_obeyed(isolator_frf: FRF) -> None:
    """One arm can have the frequency, the damping and the static stiffness, not the curve."""
    fit = identify(
        isolator_frf, mass=5.0, band=(5, 100), arms=1, rig=EXACT_RIG,
        solid_prior=SolidPrior(
            static_stiffness=1e5, natural_frequency=28.0756, damping_ratio=0.0996519
        ),
    )  # fmt: skip
    (mode,) = model_modes(fit.model, 5.0)
    assert fit.model.k_inf == pytest.approx(1e5, rel=1e-5)
    assert mode.frequency == pytest.approx(28.0756, rel=1e-5)
    assert mode.damping_ratio == pytest.approx(0.0996519, rel=1e-5)
    assert misfit_db(fit.model, isolator_frf)[0] > 0.2


def test_a_constraint_with_a_standard_deviation_bends(isolator_frf: FRF) -> None:
    measured = noisy(isolator_frf, 0.01, 1)
    hard = identify(
        measured,
        mass=5.0,
        band=(5, 100),
        arms=1,
        rig=EXACT_RIG,
        solid_prior=SolidPrior(static_stiffness=1e5),
    )
    soft = identify(
        measured,
        mass=5.0,
        band=(5, 100),
        arms=1,
        rig=EXACT_RIG,
        solid_prior=SolidPrior(static_stiffness=(1e5, 5e4)),
    )
    assert hard.model.k_inf == pytest.approx(1e5, rel=1e-4)
    assert soft.model.k_inf > 1.05e5


def test_poles_of_maxwell_voigt_reproduce_row_15() -> None:
    """m = 1 kg, k_v = k_m = 1e4 N/m, c_v = 10, c_m = 50 N s/m."""
    solid = GeneralizedMaxwell(1e4, (1e4,), (50 / 1e4,), 10.0)
    result = poles(solid, 1.0)
    ringing = result[result.imag > 0][0]
    assert abs(ringing) / (2 * np.pi) == pytest.approx(18.265016, abs=1e-6)
    assert -ringing.real / abs(ringing) == pytest.approx(0.253326, abs=1e-6)
    assert result[result.imag == 0].real == pytest.approx([-151.855], abs=1e-3)
    frf = predict_frf(solid, mass=1.0, frequency=np.linspace(1, 100, 199))
    again = identify(frf, mass=1.0, band=(1, 100), arms=1, rig=EXACT_RIG, solid_prior=VOIGT)
    assert again.model.b == pytest.approx(10.0, rel=1e-5)
    assert again.model.k == pytest.approx((1e4,), rel=1e-5)
    # the Voigt solid of equal frequency and damping has quite another FRF
    omega, zeta = abs(ringing), -ringing.real / abs(ringing)
    voigt = GeneralizedMaxwell(omega**2, (), (), 2 * zeta * omega)
    f = omega / (2 * np.pi) * np.array([0.1, 0.5, 1, 2, 5])
    ratio = np.abs(
        predict_frf(solid, mass=1.0, frequency=f).value
        / predict_frf(voigt, mass=1.0, frequency=f).value
    )
    assert ratio == pytest.approx([1.3155, 1.2817, 1.2114, 1.1062, 1.0238], abs=6e-5)


def test_identify_selects_a_dashpot_only_if_present() -> None:
    lines = np.linspace(3, 60, 115)
    voigt = noisy(predict_frf(GeneralizedMaxwell(4e4, b=40.0), mass=2.0, frequency=lines), 0.01, 2)
    maxwell = GeneralizedMaxwell(4e4, (2e4,), (0.008,))
    zener = noisy(predict_frf(maxwell, mass=2.0, frequency=lines), 0.01, 3)
    options = {"mass": 2.0, "solid_prior": SolidPrior("auto"), "band": (3, 60), "rig": EXACT_RIG}
    fit = identify(voigt, **options)  # type: ignore[arg-type]
    assert (fit.model.arms, fit.model.b > 0) == (0, True)
    fit = identify(zener, **options)  # type: ignore[arg-type]
    assert (fit.model.arms, fit.model.b > 0) == (1, False)


@settings(max_examples=8, deadline=None)
@given(seals=st.floats(0.5, 4), mass=st.floats(1, 20), loss=st.floats(0.1, 0.5))
def test_identify_returns_the_model_of_one_seal(seals: float, mass: float, loss: float) -> None:
    model = GeneralizedMaxwell(1e5, (loss * 1e5,), (1 / np.sqrt(seals * 1.2e5 / mass),))
    peak = np.sqrt(seals * 1.2e5 / mass) / (2 * np.pi)
    frf = predict_frf(seals * model, mass=mass, frequency=np.linspace(0.3, 3, 100) * peak)
    fit = identify(frf, mass=mass, seals=seals, arms=1, rig=EXACT_RIG)
    assert fit.model.k_inf == pytest.approx(1e5, rel=1e-5)
    assert fit.model.k == pytest.approx(model.k, rel=1e-5)
    assert fit.model.tau == pytest.approx(model.tau, rel=1e-5)


def test_a_windowed_record_needs_no_correction() -> None:
    """The FRF of an exponential window is H(s) at s = jw + a; the fit is made there."""
    lines = np.arange(5, 41, 0.5)
    solid = GeneralizedMaxwell(300.0, (33.0,), (0.0125,))
    frf = predict_frf(solid, mass=0.052, frequency=lines, shift=2.3)
    fit = identify(frf, mass=0.052, arms=1, band=(5, 40), rig=EXACT_RIG)
    assert fit.model.k == pytest.approx((33.0,), rel=1e-6)
    assert fit.model.tau == pytest.approx((0.0125,), rel=1e-6)


def test_a_cut_record_needs_no_correction() -> None:
    """From 2 s of a response that rings for 20 s, leakage and all."""
    lines = np.arange(5, 41, 0.5)
    solid = GeneralizedMaxwell(300.0, (20.0,), (0.1,))
    value = accelerance(solid, 0.052, 2j * np.pi * lines, 2.0, 0.004)
    frf = FRF(lines, value, record=2.0, pulse=0.004, units="SI")
    fit = identify(frf, mass=0.052, arms=1, band=(5, 40), rig=EXACT_RIG)
    assert fit.model.k_inf == pytest.approx(300.0, rel=1e-4)
    assert fit.model.k == pytest.approx((20.0,), rel=1e-3)
    assert fit.model.tau == pytest.approx((0.1,), rel=1e-3)


def test_identify_estimates_an_unknown_mass(isolator_frf: FRF) -> None:
    fit = identify(
        noisy(isolator_frf, 0.005, 4),
        band=(5, 100),
        arms=3,
        rig=HammerRig(gain_sd=0.0, delay_sd=0.0),
    )
    mass = next(item for item in fit.estimate.nuisance if item.name == "mass")
    assert mass.value == pytest.approx(5.0, rel=0.01)
    assert abs(mass.value - 5.0) < 4 * mass.standard_error


def test_identify_reports_gain_and_delay() -> None:
    solid = GeneralizedMaxwell(1e5, (3e4,), (0.005,))
    lines = np.linspace(5, 100, 191)
    clean = predict_frf(solid, mass=5.0, frequency=lines)
    late = replace(clean, value=clean.value * np.exp(-2j * np.pi * lines * 2e-4))
    fit = identify(
        noisy(late, 0.003, 5),
        mass=5.0,
        band=(5, 100),
        arms=1,
        rig=HammerRig(gain_sd=0.0, delay_sd=1e-3),
    )
    delay = next(item for item in fit.estimate.nuisance if item.name == "delay")
    assert delay.value == pytest.approx(2e-4, abs=4 * delay.standard_error)
    assert delay.standard_error < 2e-5
    assert fit.model.k == pytest.approx((3e4,), rel=0.05)


def test_another_mode_in_the_band_is_noticed(isolator_frf: FRF) -> None:
    other = predict_frf(GeneralizedMaxwell(2e5, b=40.0), mass=2.0, frequency=LINES)
    both = noisy(replace(isolator_frf, value=isolator_frf.value + 0.3 * other.value), 0.003, 6)
    fit = identify(both, mass=5.0, band=(5, 100), arms=1, rig=EXACT_RIG)
    message = next(check for check in fit.checks if check.name == "lines_explained")
    assert message.failed
    assert "A second mode" in message.message


def test_arms_that_the_lines_reject_are_not_returned() -> None:
    spring = GeneralizedMaxwell(4e4, b=40.0)
    measured = noisy(predict_frf(spring, mass=2.0, frequency=np.linspace(3, 60, 115)), 0.01, 7)
    fit = identify(measured, mass=2.0, band=(3, 60), arms=3, rig=EXACT_RIG, solid_prior=VOIGT)
    assert fit.model.arms < 3 or not fit.evidence.orders[0].significant
    assert fit.status in {Status.FEWER_ARMS, Status.NOT_IDENTIFIED, Status.TAU_AT_BOUND}


@pytest.mark.slow
def test_intervals_cover_the_truth() -> None:
    solid = GeneralizedMaxwell(1e5, (3e4,), (0.006,))
    frf = predict_frf(solid, mass=5.0, frequency=LINES)
    hits = np.zeros(3)
    for seed in range(100):
        fit = identify(noisy(frf, 0.01, seed), mass=5.0, band=(5, 100), arms=1, rig=EXACT_RIG)
        limits = fit.intervals(0.95)
        for i, (name, value) in enumerate((("k_inf", 1e5), ("k", 3e4), ("tau", 0.006))):
            low, high = limits["k_inf"] if name == "k_inf" else limits[name][0]  # type: ignore[literal-required]
            hits[i] += low <= value <= high
    assert (hits >= 88).all()


# -- the mass ---------------------------------------------------------------------------------


def test_the_mass_behind_12_71_hz() -> None:
    """Finding 3: 104.04 g for two seals of Table 1, 52.02 g for one."""
    seal = GeneralizedMaxwell(196.5, (117.5, 17.8), (59.0 / 117.5, 292.2 / 17.8))
    frf = predict_frf(2 * seal, mass=0.1040426, frequency=np.arange(1, 40, 0.05))
    mass, se = infer_mass(2 * seal, frf)
    assert mass == pytest.approx(0.10404, abs=1e-5)
    assert se < 1e-5
    assert infer_mass(seal, frf)[0] == pytest.approx(0.05202, abs=1e-5)


@settings(max_examples=20, deadline=None)
@given(mass=st.floats(0.05, 1), k=st.floats(1, 200), tau=st.floats(1e-3, 1))
def test_infer_mass_reproduces_the_peak(mass: float, k: float, tau: float) -> None:
    solid = GeneralizedMaxwell(300.0, (k,), (tau,))
    peak = np.sqrt(solid.k_0 / mass) / (2 * np.pi)
    frf = predict_frf(solid, mass=mass, frequency=np.linspace(0.2, 3, 600) * peak)
    assert infer_mass(solid, frf)[0] == pytest.approx(mass, rel=2e-3)


# -- what the user sees -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"mass": -1.0}, "mass = -1.0 kg"),
        ({"mass": 5.0, "seals": 0.0}, "seals = 0.0"),
        ({"mass": 5.0, "band": (27.0, 29.0)}, "needs at least 8"),
        ({"mass": 5.0, "band": (200.0, 300.0)}, "no line between"),
    ],
)
def test_what_cannot_be_is_refused(
    isolator_frf: FRF, options: dict[str, object], words: str
) -> None:
    with pytest.raises(DataError, match=words):
        identify(isolator_frf, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("result", "words"),
    [
        (lambda: HammerRig(mass_sd=-1.0), "mass_sd = -1.0"),
        (lambda: HammerRig(delay_sd=float("nan")), "delay_sd = nan"),
        (lambda: SolidPrior(static_stiffness=-5.0), "static_stiffness = -5.0"),
        (lambda: SolidPrior(natural_frequency=(12.0, -1.0)), "expected a standard deviation >= 0"),
        (lambda: SolidPrior(damping_ratio=2.0), "if it is in per cent, give 0.02"),
    ],
)
def test_rig_and_priors_refuse_invalid_values(result: Callable[[], object], words: str) -> None:
    with pytest.raises(DataError, match=words):
        result()


def test_prior_model_converts_to_si_units_once() -> None:
    expected = SolidPrior(static_stiffness=("1N/mm", "20N/m"), natural_frequency="12Hz")
    assert expected.static_stiffness == (1000.0, 20.0)
    assert expected.natural_frequency == (12.0, 0.0)
    assert replace(expected) == expected
    assert HammerRig("2g", delay_sd="0.1ms") == HammerRig(0.002, delay_sd=1e-4)


def test_a_strange_number_of_arms_is_refused(isolator_frf: FRF) -> None:
    with pytest.raises(FitError, match="expected a number >= 0"):
        identify(isolator_frf, mass=5.0, arms=-1)


identification = import_module("dashpot.fitting.identification.identify")


@pytest.mark.parametrize(("worse", "result"), [(1.009, [1, 2]), (1.011, [1])])
def test_order_selection_ignores_an_optimum_worse_than_fewer_arms(monkeypatch, worse, result):
    """Their optimum leaves no more than that of fewer: a descent that ended above it counts not."""

    @dataclass(frozen=True)
    class FakeProblem:
        parametrisation: object = None

    def make_descent(problem, start, **_):
        number = problem.parametrisation.number
        parametrisation = SimpleNamespace(is_complete=lambda model: True)
        return SimpleNamespace(
            problem=SimpleNamespace(parametrisation=parametrisation),
            point=SimpleNamespace(model=None), exact=False,
            cost=worse if number == 2 else 1.0, bic=0.0, number=number,
        )  # fmt: skip

    monkeypatch.setattr(identification, "Arms", lambda number: SimpleNamespace(number=number))
    monkeypatch.setattr(identification, "_linear", lambda problem, most: [])
    monkeypatch.setattr(identification, "_spread_arms", lambda problem, before: [None])
    monkeypatch.setattr(identification, "descend", make_descent)
    monkeypatch.setattr(FakeProblem, "pack", lambda self, start: start, raising=False)
    assert [
        candidate.number
        for candidate in identification._fit_candidates(FakeProblem(), [1, 2], None)
    ] == result
