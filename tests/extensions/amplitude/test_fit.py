"""Laws of amplitude from sweeps, and sliders from FRFs at several levels; truths built apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from kit import levels
from scipy.optimize import brentq

from dashpot.base.errors import DataError, FitError
from dashpot.datamodel.frf import FRF, Hit, Kind
from dashpot.extensions.amplitude.checks import levels_as_stated
from dashpot.extensions.amplitude.datamodel import AmplitudeSweep
from dashpot.extensions.amplitude.fit import fit_amplitude
from dashpot.extensions.amplitude.fit_frfs import fit_levels
from dashpot.extensions.amplitude.hits_by_amplitude import HitLevels
from dashpot.extensions.amplitude.preprocess import compute_sweep
from dashpot.extensions.amplitude.response import resonance_at_level
from dashpot.vibration.impact.amplitude_trend import fit_amplitude_trend

pytestmark = pytest.mark.once

MASS = 0.104
X = np.geomspace(1e-4, 0.02, 13)
STIFFNESS_UNITS = {"unit": "N/m", "amplitude_unit": "m"}


def payne(X, d=0.55, X_c=2e-3, m=0.5):
    """Softening and its loss by the rule of broad friction, written out."""
    u = (X / X_c) ** (2 * m)
    return 1 - d + d / (1 + u) + 1j * d * m / np.pi * 2 * np.sqrt(u) / (1 + u)


def sweep(K, X=X, hz=10.0, noise=0.0, seed=0, **words):
    rng = np.random.default_rng(seed)
    K = K * (1 + noise * (rng.normal(size=len(X)) + 1j * rng.normal(size=len(X))))
    hz = np.broadcast_to(hz, X.shape)
    return AmplitudeSweep(hz, X, K.real, K.imag, **words, units="SI")


class TestSweep:
    def test_fit_recovers_a_factor_law_to_the_last_digit(self):
        amplitude_fit = fit_amplitude(sweep(5e6 * (1 + 0.1j) * payne(X)))
        assert amplitude_fit.law == "factor"
        assert (
            amplitude_fit.lost,
            amplitude_fit.half_way,
            amplitude_fit.exponent,
        ) == pytest.approx((0.55, 2e-3, 0.5), rel=1e-4)
        assert amplitude_fit.linear[0] == pytest.approx(5e6 * (1 + 0.1j), rel=1e-4)
        assert amplitude_fit.ratio(3e-3) == pytest.approx(complex(payne(3e-3)), rel=1e-4)
        # another friction with a spring beside it would look the same
        assert amplitude_fit.verdict.use == "use with care"
        assert [check.name for check in amplitude_fit.checks if check.failed] == [
            "no_hidden_cubic_spring"
        ]

    def test_fit_recovers_an_element_parallel_to_the_solid(self):
        K = 400 * (1 + 0.05j) + 200 * (payne(X, d=1.0) - 1)
        amplitude_fit = fit_amplitude(sweep(K, **STIFFNESS_UNITS))
        assert amplitude_fit.law == "additive"
        assert amplitude_fit.lost == pytest.approx(200, rel=1e-3)
        assert amplitude_fit.element().stiffness(1e-3) == pytest.approx(
            200 * complex(payne(1e-3, d=1.0)), rel=1e-3
        )

    @pytest.mark.parametrize("law", ["factor", "additive"])
    def test_two_frequencies_tell_which(self, law):
        low, high = 5e6 * (1 + 0.08j), 9e6 * (1 + 0.4j)
        change = payne(X, d=1.0) - 1
        parts = [L * payne(X) if law == "factor" else L + 2.5e6 * change for L in (low, high)]
        both, tones = np.concatenate((X, X)), np.repeat([10.0, 100.0], len(X))
        amplitude_fit = fit_amplitude(
            sweep(np.concatenate(parts), both, tones, noise=0.005, seed=3)
        )
        assert amplitude_fit.law == law
        assert amplitude_fit.half_way == pytest.approx(2e-3, rel=0.05)

    def test_as_many_frequencies_as_amplitudes_tell_neither(self):
        with pytest.raises(FitError, match=r"13 loops.*Record three loops at each"):
            fit_amplitude(sweep(5e6 * (1 + 0.1j) * payne(X), hz=np.geomspace(1, 100, len(X))))

    @pytest.mark.parametrize("change", [0.02, -0.04, 0.06])
    def test_the_way_down_that_differs_is_named(self, change):
        up_down = np.concatenate((X, X[-2::-1]))
        K = 5e6 * (1 + 0.1j) * payne(up_down)
        K[len(X) :] *= 1 + change
        checks = {check.name: check for check in fit_amplitude(sweep(K, up_down)).checks}
        assert checks["up_and_down_sweeps_agree"].value == pytest.approx(abs(change), abs=1e-9)
        assert checks["up_and_down_sweeps_agree"].failed == (abs(change) > 0.03)
        assert ("softer" if change < 0 else "stiffer") in checks["up_and_down_sweeps_agree"].message

    def test_fit_omits_the_return_check_without_a_return(self):
        shuffled = np.random.default_rng(1).permutation(X)
        for item in (X, X[::-1], shuffled):
            amplitude_fit = fit_amplitude(sweep(5e6 * (1 + 0.1j) * payne(item), item))
            assert "up_and_down_sweeps_agree" not in {check.name for check in amplitude_fit.checks}

    def test_its_errors_hold_the_truth(self):
        held = 0
        for seed in range(60):
            amplitude_fit = fit_amplitude(
                sweep(5e6 * (1 + 0.1j) * payne(X), noise=0.01, seed=seed), law="factor"
            )
            error = dict(amplitude_fit.se)
            held += abs(amplitude_fit.half_way - 2e-3) < 2 * error["half_way"]
            held += abs(amplitude_fit.lost - 0.55) < 2 * error["lost"]
            off, se = amplitude_fit.linear[0] - 5e6 * (1 + 0.1j), amplitude_fit.linear_se[0]
            held += abs(off.real) < 2 * se.real
            held += abs(off.imag) < 2 * se.imag
        assert 0.88 <= held / 240 <= 0.995

    def test_a_short_sweep_sets_the_exponent_and_says_so(self):
        short = np.geomspace(1e-5, 2e-3, 13)
        amplitude_fit = fit_amplitude(sweep(5e6 * (1 + 0.1j) * payne(short), short, noise=0.003))
        assert amplitude_fit.exponent == pytest.approx(0.5, abs=1e-6)
        assert dict(amplitude_fit.se)["exponent"] == 0
        assert any(c.name == "softening_seen" and c.failed for c in amplitude_fit.checks)
        assert amplitude_fit.verdict.use == "use with care"

    def test_a_linear_rubber_has_no_law(self):
        for seed in range(6):
            amplitude_fit = fit_amplitude(
                sweep(np.full(len(X), 5e6 * (1 + 0.1j)), noise=0.01, seed=seed)
            )
            assert amplitude_fit.law == "none", seed
            matters = next(
                c for c in amplitude_fit.checks if c.name == "amplitude_dependence_detected"
            )
            assert "no change with amplitude is seen" in matters.message
            assert amplitude_fit.ratio(1e-3) == 1

    def test_the_first_samples_of_an_instrument_out_of_its_range(self):
        K = 5e6 * (1 + 0.1j) * payne(X)
        rng = np.random.default_rng(5)
        K = K * (1 + 0.003 * (rng.normal(size=len(X)) + 1j * rng.normal(size=len(X))))
        K[:2] *= [1.3 + 0.4j, 0.85 - 0.2j]
        amplitude_fit = fit_amplitude(sweep(K))
        assert amplitude_fit.omitted_samples == 2
        assert amplitude_fit.half_way == pytest.approx(2e-3, rel=0.1)

    def test_a_rubber_that_does_not_follow_the_law(self):
        steps = np.where(X < 1e-3, 5e6, 3e6) * (1 + 0.1j)
        amplitude_fit = fit_amplitude(sweep(steps))
        assert amplitude_fit.verdict.use == "use with care"

    def test_a_loss_that_is_not_the_laws_is_not_hidden_by_the_storage(self):
        r = np.minimum(2e-3 / X, 1)
        theta = np.arccos(1 - 2 * r)
        value = (theta - np.sin(2 * theta) / 2) / np.pi + 4j / np.pi * r * (1 - r)
        amplitude_fit = fit_amplitude(sweep(1e6 * (3 + 0.3j + 2 * value), noise=0.005))
        failed = [check.name for check in amplitude_fit.checks if check.failed]
        assert failed == ["loss_residual_small", "no_hidden_cubic_spring"]

    def test_a_spring_that_stiffens_is_no_friction(self):
        held, Xs = 0, np.geomspace(1e-4, 6e-3, 24)
        for seed in range(12):
            K = 400 * (1 + 0.08j) + 0.75 * 3e6 * Xs**2
            amplitude_fit = fit_amplitude(sweep(K, Xs, noise=0.003, seed=seed, **STIFFNESS_UNITS))
            assert (amplitude_fit.law, amplitude_fit.verdict.use) == ("cubic", "use"), seed
            held += abs(amplitude_fit.k3 - 3e6) < 2 * dict(amplitude_fit.se)["k3"]
            assert amplitude_fit.spring().k3 == amplitude_fit.k3
        assert held >= 10
        assert amplitude_fit.ratio(6e-3) == pytest.approx(complex(K[-1] / (400 + 32j)), rel=0.01)

    def test_fit_recovers_friction_and_cubic_spring_with_honest_error(self):
        Xs = np.geomspace(1e-4, 6e-3, 12)
        for friction in (lambda X: payne(X, d=1.0, X_c=4e-4), lambda X: jenkins(X) / 100):
            K = 400 + 30j + 150 * np.array([friction(item) for item in Xs]) + 0.75 * 5e6 * Xs**2
            amplitude_fit = fit_amplitude(sweep(K, Xs, noise=0.003, **STIFFNESS_UNITS))
            assert amplitude_fit.law == "additive+cubic"
            assert abs(amplitude_fit.k3 - 5e6) < 2.5 * dict(amplitude_fit.se)["k3"]

    @pytest.mark.parametrize("other", [lambda X: 8e10 * 0.625 * X**4, lambda X: 2 * stop(X)])
    def test_fit_reports_a_spring_that_is_not_cubic(self, other):
        Xs = np.tile(np.geomspace(1e-4, 6e-3, 12), 3)
        K = 400 + 30j + np.array([other(item) for item in Xs])
        amplitude_fit = fit_amplitude(sweep(K, Xs, noise=0.002, **STIFFNESS_UNITS))
        assert amplitude_fit.law == "cubic"
        assert [check.name for check in amplitude_fit.checks if check.failed] == ["spring_cubic"]

    @pytest.mark.parametrize(("friction", "least"), [(0.0, 0.002), (150.0, 0.02)])
    def test_a_spring_that_is_not_seen_lies_below_its_bound(self, friction, least):
        Xs = np.geomspace(1e-4, 6e-3, 24)
        K = 400 + 30j + friction * (payne(Xs, d=1.0, X_c=8e-4) - 1)
        added = 0.75 * (Xs / Xs.max()) ** 2
        for seed in range(2):
            for part in (least, -least):
                k3 = part * 400
                amplitude_fit = fit_amplitude(
                    sweep(K + k3 * added, Xs, noise=0.003, seed=seed, **STIFFNESS_UNITS)
                )
                hidden = amplitude_fit.k3_detection_limit * Xs.max() ** 2
                assert abs(k3) < hidden < 6 * abs(k3)
                assert "No cubic spring is seen. One of up to" in " ".join(
                    amplitude_fit._summary_lines
                )
        amplitude_fit = fit_amplitude(sweep(K + 80 * added, Xs, noise=0.003, **STIFFNESS_UNITS))
        assert amplitude_fit.k3 > 0
        assert amplitude_fit.k3_detection_limit == 0

    @pytest.mark.parametrize("slip", [1e-4, 1e-3, 4e-3])
    def test_friction_that_is_not_the_laws_is_no_spring(self, slip):
        Xs = np.geomspace(1e-4, 6e-3, 12)
        K = 400 + 30j + np.array([jenkins(item, F=100 * slip) for item in Xs])
        for seed in range(3):
            amplitude_fit = fit_amplitude(sweep(K, Xs, noise=0.003, seed=seed, **STIFFNESS_UNITS))
            assert "cubic" not in amplitude_fit.law

    def test_too_few(self):
        with pytest.raises(FitError, match="loops or lines found: 5"):
            fit_amplitude(sweep(5e6 * payne(X[:5]), X[:5]))

    @pytest.mark.parametrize("words", [{"unit": "mm"}, {"amplitude_unit": "mm"}])
    def test_no_unit(self, words):
        with pytest.raises(DataError, match="expected"):
            sweep(5e6 * payne(X), **words)

    def test_an_amplitude_of_nothing(self):
        with pytest.raises(DataError, match="amplitude"):
            sweep(5e6 * payne(X), np.concatenate(([0.0], X[1:])))


def test_a_third_harmonic_stays_out_of_the_first():
    """A spring that stiffens loses nothing, and 3/4 k3 X^2 is its stiffness."""
    recorded = levels.loops(force=lambda x: 1e3 * x + 2e8 * x**3, noise=0.0)
    amplitude_sweep = compute_sweep(recorded)
    true = 1e3 + 0.75 * 2e8 * amplitude_sweep.amplitude**2
    assert amplitude_sweep.storage == pytest.approx(true, rel=2e-3)
    assert np.abs(amplitude_sweep.loss).max() < 2e-3 * true.min()


def jenkins(X, k=100.0, F=0.05):
    """The describing function of a Jenkins element, by its area and a sum over its loop."""
    x_y = F / k
    if x_y >= X:
        return k + 0j
    theta = np.arccos(1 - 2 * x_y / X)
    return k / np.pi * (theta - np.sin(2 * theta) / 2) + 4j * F * (X - x_y) / np.pi / X**2


def stop(X, k=150.0, gap=3e-3):
    """The describing function of a spring that begins at a gap."""
    r = min(gap / X, 1.0)
    return k * (1 - 2 / np.pi * (np.arcsin(r) + r * np.sqrt(1 - r**2)))


def arms(w):
    s = 1j * w
    return 393 + 235 * s * 0.502 / (1 + s * 0.502) + 35.6 * s * 0.012 / (1 + s * 0.012)


def integrate_cubic_response(f, level, k3, per=128, cycles=90):
    """First harmonic over the force of a mass on arms and a cubic spring, by leapfrog."""
    k, tau = np.array([[235.0], [200.0]]), np.array([[0.502], [0.012]])
    dt = 1 / f / per
    x, v, e, X = np.zeros_like(f), np.zeros_like(f), np.zeros((2, len(f))), 0j
    fade, share = np.exp(-dt / tau), -np.expm1(-dt / tau) * tau / dt
    for i in range(cycles * per):
        turn = np.exp(2j * np.pi * i / per)
        if i >= (cycles - 8) * per:
            X = X + x * turn.conj()
        pull = level * turn.real * min(1, i / (10 * per))
        v = v + (pull - 393 * x - (k * e).sum(axis=0) - k3 * x**3) / MASS * dt
        x, e = x + v * dt, fade * e + share * v * dt
    return 2 * X / (8 * per) / level


def simulate_response(level, f, friction=jenkins, *, noise=0.01, seed=0, kind=Kind.ACCELERANCE):
    """One balance a line, by a root of our own, and noise."""
    rng = np.random.default_rng(seed)
    w, out = 2 * np.pi * f, []
    for value in w:

        def compute_log_excess(u, item=value):
            X = np.exp(u)
            return np.log(abs(arms(item) + friction(X) - MASS * item**2) * X / level)

        X = np.exp(brentq(compute_log_excess, np.log(1e-9), np.log(1)))
        out.append(1 / (arms(value) + friction(X) - MASS * value**2))
    H = np.array(out)
    H = H * (1 + noise / np.sqrt(2) * (rng.normal(size=len(f)) + 1j * rng.normal(size=len(f))))
    if kind is Kind.TRANSMISSIBILITY:
        return FRF(f, 1 + MASS * w**2 * H, kind, units="SI")
    return FRF.from_receptance(f, H, kind=kind)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ([20.0, 2.0], "belong to each other's files"),
        ([2000.0, 20000.0], "looks like mN or kN"),
        ([0.002, 0.02], "looks like mN or kN"),
        ([2.0, 50.0], "sensitivity of the force"),
    ],
)
def test_levels_check_explains_a_contradiction_with_the_hits(text, message):
    check = levels_as_stated(text, [2.1, 19.0])
    assert check.failed
    assert message in check.message


def test_hits_that_leave_no_resonance_at_a_level_say_so():
    """The damping ratio halves per doubling, from 0.4: of a twentieth of the motion no peak."""
    made = [
        Hit(str(i), i, True, (), X, 0.01, 12.0, 4e-5 / X, 0.1, X)
        for i, X in enumerate(np.geomspace(1e-4, 8e-4, 6))
    ]
    trend = fit_amplitude_trend(made)
    hit_levels = HitLevels(FRF(np.arange(1.0, 4.0), np.ones(3), units="SI"), trend, ())
    assert hit_levels.resonance(0.4)[0] > 10
    with pytest.raises(DataError, match="leaves no resonance: hit so that"):
        hit_levels.resonance(0.02)


F = np.linspace(8, 20, 61)
LEVELS = (0.005, 0.05, 0.5)


def three(friction=jenkins, seed=0, levels=LEVELS, **words):
    return [
        simulate_response(level, F, friction, seed=10 * seed + i, **words)
        for i, level in enumerate(levels)
    ]


def compute_largest_error(result, friction=jenkins, at=(2e-4, 1e-3, 4e-3)):
    w = 2 * np.pi * 13.0
    return max(
        abs(complex(result.stiffness(omega=w, amplitude=X)) / (arms(w) + friction(X)) - 1)
        for X in at
        if result.covers(X)
    )


class TestLevels:
    @pytest.mark.parametrize("seed", range(6))
    def test_stiffness_and_loss_at_every_amplitude(self, seed):
        fit = fit_levels(three(seed=seed), LEVELS, mass=MASS)
        assert compute_largest_error(fit) < 0.01
        assert fit.k3 == 0
        assert fit.verdict.use == "use"
        assert fit.residual < 0.012
        assert fit.linear_residual > 0.05

    def test_fit_levels_scales_with_the_number_of_seals(self):
        fit = fit_levels(three(), LEVELS, mass=MASS)
        two = fit_levels(three(), LEVELS, mass=MASS, seals=2)
        assert 2 * two.stiffness(omega=80.0, amplitude=1e-3) == pytest.approx(
            fit.stiffness(omega=80.0, amplitude=1e-3), rel=1e-6
        )

    def test_wrong_mass_in_fit_levels_leaves_the_predicted_resonance(self):
        fit, other = (fit_levels(three(), LEVELS, mass=part * MASS) for part in (1, 1.01))
        for level in (0.02, 0.2):
            here, there = (resonance_at_level(result, level)[0] for result in (fit, other))
            assert there == pytest.approx(here, rel=3e-4)
        heavier = (replace(result, mass=1.3 * MASS) for result in (fit, other))
        here, there = (resonance_at_level(result, 0.05)[0] for result in heavier)
        assert there / here - 1 == pytest.approx(0.005, abs=1e-3)
        assert "that of another mass moves by 0.5 %" in " ".join(fit._summary_lines)

    def test_a_linear_truth_needs_no_sliders(self):
        def nothing(X):
            return 0j

        for seed in range(12):
            fit = fit_levels(three(nothing, seed=seed), LEVELS, mass=MASS)
            assert fit.rate_independent == (), seed
            assert "no change with amplitude is seen" in " ".join(
                fit._summary_lines + tuple(c.message for c in fit.checks)
            )

    @pytest.mark.parametrize(("message", "use"), [(True, "use"), (False, "do not use")])
    def test_lines_that_are_noise_count_by_the_error_that_they_state(self, message, use):
        part = np.where(F > 15, 0.2, 0.003)
        rng = np.random.default_rng(2)
        noisy = []
        for quantity in three(noise=0.0):
            off = part * (rng.normal(size=len(F)) + 1j * rng.normal(size=len(F)))
            sd = part * np.abs(quantity.value) if message else None
            noisy.append(FRF(F, quantity.value * (1 + off), quantity.quantity, sd=sd, units="SI"))
        fit = fit_levels(noisy, LEVELS, mass=MASS)
        assert bool(compute_largest_error(fit) < 0.002) is message
        assert fit.verdict.use == use

    def test_fit_levels_accepts_excess_noise_off_resonance(self):
        """Ten times the noise below 12 Hz, as of a transmissibility near 1, and none of it said."""
        part = np.where(F < 12, 0.03, 0.003)
        rng = np.random.default_rng(4)
        noisy = []
        for quantity in three(noise=0.0):
            off = part * (rng.normal(size=len(F)) + 1j * rng.normal(size=len(F)))
            noisy.append(FRF(F, quantity.value * (1 + off), quantity.quantity, units="SI"))
        fit = fit_levels(noisy, LEVELS, mass=MASS)
        ratio = next(c.value for c in fit.checks if c.name == "levels_residual_small")
        assert 0.8 < ratio < 1.2

    def test_transmissibility_says_the_same(self):
        w0 = 2 * np.pi * 13
        base = [
            simulate_response(level, F, seed=i, kind=Kind.TRANSMISSIBILITY)
            for i, level in enumerate(LEVELS)
        ]
        fit = fit_levels(base, [level / MASS for level in LEVELS], mass=MASS)
        assert compute_largest_error(fit) < 0.01
        assert fit.stiffness(omega=w0, amplitude=1e-3).shape == ()

    @pytest.mark.parametrize(
        ("wrong", "use"),
        [
            ({"mass": 1.03 * MASS}, "use with care"),
            ({"mass": 0.97 * MASS}, "use with care"),
            ({"mass": 1.3 * MASS}, "do not use"),
            ({"levels": (0.05, 0.005, 0.5)}, "do not use"),
            ({"levels": (0.5, 0.05, 0.005)}, "do not use"),
            ({"levels": (0.005, 0.1, 0.5)}, "use with care"),
            ({"gain": 1.05}, "use with care"),
            ({"phase": np.radians(1)}, "use with care"),
            ({"friction": lambda X: jenkins(X) + stop(X)}, "use with care"),
            ({"friction": lambda X: jenkins(X) - 0.4 * stop(X)}, "use with care"),
        ],
    )
    def test_fit_levels_rejects_wrong_statements_and_poor_fits(self, wrong, use):
        """FRFs that say nothing of their scatter: it is seen from line to line."""
        frfs = three(wrong.get("friction", jenkins), noise=0.005)
        odd = wrong.get("gain", 1.0) * np.exp(1j * wrong.get("phase", 0.0))
        which = slice(1, 2) if "gain" in wrong else slice(None)
        frfs[which] = [
            FRF(quantity.frequency, quantity.value * odd, quantity.quantity, units="SI")
            for quantity in frfs[which]
        ]
        fit = fit_levels(frfs, wrong.get("levels", LEVELS), mass=wrong.get("mass", MASS))
        assert fit.verdict.use == use
        # what nothing explains is not called linear
        assert "the solid is linear" not in " ".join(check.message for check in fit.checks)

    @pytest.mark.parametrize("k3", [4e5, -4e5, 8e5])
    @pytest.mark.parametrize("slips", [True, False])
    def test_fit_levels_distinguishes_a_hardening_spring_from_friction(self, k3, slips):
        def compute_added_stiffness(X):
            return 0.75 * k3 * X**2 + (jenkins(X) if slips else 0)

        for seed in range(2):
            fit = fit_levels(three(compute_added_stiffness, seed=seed), LEVELS, mass=MASS)
            assert bool(fit.sliders) == slips, seed
            assert fit.k3 == pytest.approx(k3, rel=0.05)
            assert compute_largest_error(fit, compute_added_stiffness) < 0.01
            assert fit.verdict.use == "use"
            assert ("stiffens" in repr(fit)) == (k3 > 0)

    def test_a_resonance_that_leans_is_followed_with_its_third_harmonic(self):
        """Marched in time, so that the motion is what it is."""
        k3, levels = 3e6, (0.05, 0.6)
        f = np.linspace(9, 17, 33)
        frfs = [integrate_cubic_response(f, level, k3) for level in levels]
        rng, held = np.random.default_rng(3), 0
        for _ in range(4):
            noise = 1 + 0.001 * (rng.normal(size=(2, 33)) + 1j * rng.normal(size=(2, 33)))
            noisy = [
                FRF(f, H * value, Kind.RECEPTANCE, units="SI")
                for H, value in zip(frfs, noise, strict=True)
            ]
            fit = fit_levels(noisy, levels, mass=MASS)
            assert fit.sliders == ()
            assert fit.k3 == pytest.approx(k3, rel=0.01)
            low, high = fit.k3_interval
            held += low < k3 < high
        assert held >= 3
        # it rises with the level, and where the sweep upwards jumps is its end
        peaks = [resonance_at_level(fit, level) for level in (0.05, 0.2, 0.6)]
        assert np.all(np.diff([hz for hz, _ in peaks]) > 0)
        hz, X = peaks[-1]
        swept = np.abs(integrate_cubic_response(np.linspace(hz - 0.3, hz + 0.3, 13), 0.6, k3)) * 0.6
        assert swept.max() == pytest.approx(X, rel=0.01)

    def test_its_intervals_hold_the_truth(self):
        held, w = [], 2 * np.pi * 13.0
        for seed in range(8):
            fit = fit_levels(three(seed=40 + seed), LEVELS, mass=MASS)
            for X in (2e-4, 1e-3, 4e-3):
                for part in (np.real, np.imag):

                    def follows(solid, sliders, X=X, part=part):
                        K = solid.complex_stiffness(omega=w) + sum(s.stiffness(X) for s in sliders)
                        return float(part(K))

                    low, high = fit.interval(follows)
                    held.append(low <= part(arms(w) + jenkins(X)) <= high)
        assert 0.88 < np.mean(held) < 1

    def test_fit_levels_reports_a_single_amplitude(self):
        far = np.linspace(30, 40, 30)  # above resonance the amplitude hardly moves
        fit = fit_levels([simulate_response(0.05, far)], [0.05], mass=MASS)
        assert any(c.name == "amplitudes_spread" and c.failed for c in fit.checks)

    def test_what_does_not_belong_together(self):
        with pytest.raises(DataError, match="one amplitude for each"):
            fit_levels(three(), LEVELS[:2], mass=MASS)
        with pytest.raises(DataError, match="usable lines"):
            fit_levels(three(), LEVELS, mass=MASS, band="8:9Hz")
        with pytest.raises(DataError, match="> 0"):
            fit_levels(three(), [0.0, 0.1, 0.2], mass=MASS)
