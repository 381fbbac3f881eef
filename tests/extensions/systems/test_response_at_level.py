"""Systems with friction at a level: published answers, closed forms, and a march in time."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dashpot.base.errors import DataError
from dashpot.extensions.amplitude.friction import Berg, Coulomb, Iwan, Kraus
from dashpot.extensions.systems.level_response import (
    backbone,
    can_fold,
    find_all_responses,
    response_at_level,
)
from dashpot.extensions.systems.multibody import Mount, System, point_mass
from dashpot.extensions.systems.time_response import complex_modes, newton_modes, respond
from dashpot.solids.demo_seals import PAPER
from dashpot.solids.jenkins import Jenkins
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.nonlinear_springs import Cubic
from dashpot.solids.rate_independent import InParallel

pytestmark = pytest.mark.once

TWO = GeneralizedMaxwell(393.0, (235.0, 35.6), (0.50212766, 16.4157303))
SLIDER = Jenkins(100.0, 0.05)
STRIPS = InParallel(tuple(Jenkins(5.0, 5.0 * 1.6e-3 * (i + 0.5) / 30) for i in range(30)))
STIFF = GeneralizedMaxwell(393.0, (235.0, 35.6), (0.004, 16.4157303))
HARD = GeneralizedMaxwell(393.0, (60.0, 30.0), (0.02, 0.5))


def make_single_mass(solid, friction, mass=0.104):
    return System(
        (point_mass("block", mass),), (Mount(solid, ("block", "ground"), friction=friction),)
    )


def find_amplitude(system, hz, level, harmonics=(1,)):
    level_response = response_at_level(
        system, response="block.z", force="block.z", level=level, frequency=hz, harmonics=harmonics
    )
    return float(level_response.amplitude[-1])


def march(bodies, links, drive, hz, *, cycles, steps):
    """First harmonic of each mass by Newmark's average acceleration, apart from src.

    bodies: masses; links: (i, j or None, solid, sliders [(k, slip)], k3); drive: (body, N).
    """
    h = 1 / hz / steps
    M, n = np.array(bodies), len(bodies)
    x, v, a = np.zeros(n), np.zeros(n), np.zeros(n)
    arms = [np.zeros(len(link[2].k)) for link in links]
    held = [np.zeros(len(link[3])) for link in links]
    rows = []

    def stretch(link, x):
        return x[link[0]] - (x[link[1]] if link[1] is not None else 0.0)

    old = [0.0] * len(links)
    for step in range(1, cycles * steps + 1):
        t = step * h
        new = x + h * v + h * h / 4 * a
        for _ in range(60):
            F, J = np.zeros(n), np.diag(4 * M / h**2)
            F[drive[0]] = drive[1] * np.cos(2 * np.pi * hz * t)
            for i, link in enumerate(links):
                solid, sliders, k3 = link[2], link[3], link[4]
                tau, k = np.array(solid.tau), np.array(solid.k)
                e = stretch(link, new)
                d, mean = np.exp(-h / tau), -np.expm1(-h / tau) * tau / h
                q = d * arms[i] + mean * (e - old[i])
                f, tangent = (
                    solid.k_inf * e + k @ q + k3 * e**3,
                    solid.k_inf + k @ mean + 3 * k3 * e**2,
                )
                if len(sliders):
                    trial = held[i] + sliders[:, 0] * (e - old[i])
                    slips = np.abs(trial) > sliders[:, 1]
                    f += np.clip(trial, -sliders[:, 1], sliders[:, 1]).sum()
                    tangent += sliders[~slips, 0].sum()
                E = np.zeros(n)
                E[link[0]] = 1
                if link[1] is not None:
                    E[link[1]] = -1
                F -= E * f
                J += tangent * np.outer(E, E)
            r = F - M * (4 / h**2 * (new - x) - 4 / h * v - a)
            new = new + np.linalg.solve(J, r)
            if np.abs(r).max() < 1e-12 * drive[1]:
                break
        for i, link in enumerate(links):
            e, tau = stretch(link, new), np.array(link[2].tau)
            arms[i] = np.exp(-h / tau) * arms[i] - np.expm1(-h / tau) * tau / h * (e - old[i])
            if len(link[3]):
                trial = held[i] + link[3][:, 0] * (e - old[i])
                held[i] = np.clip(trial, -link[3][:, 1], link[3][:, 1])
            old[i] = e
        faster = 4 / h**2 * (new - x) - 4 / h * v - a
        v, a, x = v + h / 2 * (a + faster), faster, new
        rows.append(x)
    last = np.array(rows[-steps:])
    phase = 2 * np.pi * np.arange(1, steps + 1) / steps
    return np.abs(2 / steps * np.exp(-1j * phase) @ last)


class TestPublished:
    """`Harmonic balance of a Jenkins element beside two of Table 1`, to the last digit printed."""

    @pytest.mark.parametrize(
        ("level", "hz", "gain"),
        [
            (1e-4, 13.63659, 0.1823287),
            (0.005, 13.62735, 0.1035112),
            (0.02, 13.45614, 0.03358057),
            (0.1, 12.74299, 0.06969845),
            (0.5, 12.71304, 0.1484947),
        ],
    )
    def test_the_peak_at_five_levels(self, level, hz, gain):
        system = make_single_mass(2 * PAPER, SLIDER)
        f = hz + np.linspace(-2e-3, 2e-3, 41)
        peak = np.array([find_amplitude(system, item, level) for item in f]) / level
        assert abs(f[peak.argmax()] - hz) < 1.1e-4
        assert peak.max() == pytest.approx(gain, rel=2e-6)

    @pytest.mark.parametrize(
        "case",
        [
            (TWO, SLIDER, 13.0, 0.1, 3.288152e-3, 3.284517e-3),
            (TWO, SLIDER, 13.5, 0.02, 6.686580e-4, 6.695167e-4),
            (TWO, STRIPS, 13.0, 0.1, 2.000353e-3, 1.994331e-3),
            (TWO, STRIPS, 13.8, 0.05, 1.242392e-3, 1.242631e-3),
            (STIFF, SLIDER + Cubic(2e6), 14.0, 0.5, 1.498782e-3, 1.498670e-3),
            (STIFF, SLIDER + Cubic(2e6), 15.0, 0.5, 1.146960e-3, 1.146987e-3),
        ],
    )
    def test_response_at_level_agrees_for_one_and_three_harmonics(self, case):
        solid, friction, hz, level, item, three = case
        system = make_single_mass(solid, friction)
        assert find_amplitude(system, hz, level) == pytest.approx(item, rel=3e-6)
        assert find_amplitude(system, hz, level, (1, 3, 5)) == pytest.approx(three, rel=4e-4)

    def test_three_answers_where_a_cubic_spring_folds(self):
        system = make_single_mass(HARD, InParallel((Cubic(6e7),)))
        level_response = find_all_responses(
            system, response="block.z", force="block.z", level=0.6, frequency=16.0
        )
        assert level_response.amplitude == pytest.approx(
            [1.15198e-3, 2.87920e-3, 4.01998e-3], rel=5e-6
        )
        assert level_response.stable.tolist() == [True, False, True]
        assert find_amplitude(
            system, [4.0, 8.0, 12.0, 14.0, 15.0, 16.0], 0.6, (1, 3, 5)
        ) == pytest.approx(3.960964e-3, rel=1e-4)

    def test_two_masses(self):
        ground = Mount(
            GeneralizedMaxwell(393.0, (100.0, 60.0), (0.012, 0.12)),
            ("block", "ground"),
            friction=Jenkins(150.0, 0.06),
        )
        between = Mount(GeneralizedMaxwell(800.0, (200.0,), (0.01,)), ("top", "block"))
        system = System((point_mass("block", 0.1), point_mass("top", 0.2)), (ground, between))
        for place, expected in (("block.z", 1.195511e-3), ("top.z", 1.740060e-3)):
            level_response = response_at_level(
                system, response=place, force="top.z", level="0.1N", frequency=6.0
            )
            assert level_response.amplitude[0] == pytest.approx(expected, rel=1e-6)


@pytest.mark.slow
class TestInTime:
    """Held against a march in time that shares nothing with the balance."""

    @pytest.mark.parametrize(
        ("solid", "sliders", "k3", "hz", "level"),
        [
            (TWO, [(100.0, 0.05)], 0.0, 13.0, 0.1),
            (STIFF, [(100.0, 0.05)], 2e6, 14.0, 0.5),
        ],
    )
    def test_response_at_level_of_one_mass_agrees_with_time_integration(
        self, solid, sliders, k3, hz, level
    ):
        friction = InParallel(tuple(Jenkins(*slider) for slider in sliders))
        friction = friction + Cubic(k3) if k3 else friction
        system = make_single_mass(solid, friction)
        link = (0, None, solid, np.array(sliders), k3)
        X = march([0.104], [link], (0, level), hz, cycles=250, steps=400)[0]
        assert find_amplitude(system, hz, level) == pytest.approx(X, rel=5e-3)
        assert find_amplitude(system, hz, level, (1, 3, 5)) == pytest.approx(X, rel=1e-3)

    def test_two_masses_and_two_sliders(self):
        a, b = (
            GeneralizedMaxwell(393.0, (100.0,), (0.012,)),
            GeneralizedMaxwell(800.0, (200.0,), (0.01,)),
        )
        mounts = (
            Mount(a, ("block", "ground"), friction=Jenkins(150.0, 0.06)),
            Mount(b, ("top", "block"), friction=Jenkins(300.0, 0.04)),
        )
        system = System((point_mass("block", 0.1), point_mass("top", 0.2)), mounts)
        links = [
            (0, None, a, np.array([(150.0, 0.06)]), 0.0),
            (1, 0, b, np.array([(300.0, 0.04)]), 0.0),
        ]
        X = march([0.1, 0.2], links, (1, 0.1), 6.0, cycles=25, steps=400)
        for place, expected in zip(("block.z", "top.z"), X, strict=True):
            level_response = response_at_level(
                system, response=place, force="top.z", level=0.1, frequency=6.0
            )
            assert level_response.amplitude[0] == pytest.approx(expected, rel=5e-3)


class TestLimits:
    def test_without_slip_it_is_the_linear_system(self):
        stuck = make_single_mass(TWO, Jenkins(100.0, 1e3))
        linear = make_single_mass(GeneralizedMaxwell(493.0, TWO.k, TWO.tau), None)
        f = np.linspace(5, 30, 26)
        H = response_at_level(stuck, response="block.z", force="block.z", level=0.1, frequency=f)
        expected = linear.frf(response="block.z", force="block.z", frequency=f)
        assert np.abs(H.frf().value / expected.value - 1).max() < 1e-12

    def test_friction_that_is_not_there_changes_nothing(self):
        system = make_single_mass(TWO, None)
        with_amplitude = replace(system.mounts[0], amplitude=1e-3)
        assert replace(system, mounts=(with_amplitude,)).dynamic_stiffness(3j) == pytest.approx(
            system.dynamic_stiffness(3j)
        )

    def test_the_base_moves_all_when_slow(self):
        system = make_single_mass(TWO, SLIDER)
        level_response = response_at_level(
            system, response="block.z", base="ground.z", level="1mm", frequency=0.01
        )
        assert level_response.amplitude[0] == pytest.approx(1e-3, rel=1e-3)

    def test_a_base_is_the_force_m_a_on_the_relative_motion(self):
        system, w, level = make_single_mass(TWO, SLIDER), 2 * np.pi * 13.0, 3e-5
        base = response_at_level(
            system, response="block.z", base="ground.z", level=level, frequency=13.0
        )
        force = response_at_level(
            system, response="block.z", force="block.z", level=0.104 * w**2 * level, frequency=13.0
        )
        assert base.stretch[0] == pytest.approx(force.stretch[0], rel=1e-10)

    def test_dry_friction_holds_a_mass_below_its_force(self):
        system = make_single_mass(GeneralizedMaxwell(393.0), Coulomb(0.2))
        assert find_amplitude(system, 5.0, 0.2) == 0.0
        w, X = 2 * np.pi * 5.0, find_amplitude(system, 5.0, 1.0)
        # closed form: (k - m w^2)^2 X^2 = F^2 - (4 F_c / pi)^2
        closed = np.sqrt(1 - (0.8 / np.pi) ** 2) / abs(393.0 - 0.104 * w**2)
        assert abs(X / closed - 1) < 1e-9

    def test_response_at_level_differs_between_sweeps_where_it_folds(self):
        system = make_single_mass(HARD, InParallel((Cubic(6e7),)))
        f = np.linspace(8, 24, 161)
        up, down = (
            response_at_level(
                system, response="block.z", force="block.z", level=0.6, frequency=item
            )
            for item in (f, f[::-1])
        )
        separate = np.abs(up.amplitude - down.amplitude[::-1]) > 1e-6
        assert 16.0 in f[separate].round(1)
        assert up.stable.all()
        assert down.stable.all()
        with pytest.raises(DataError, match="increas"):
            response_at_level(
                system, response="block.z", force="block.z", level=0.6, frequency=[16.0, 16.0]
            ).frf()

    def test_a_sweep_of_the_level(self):
        system = make_single_mass(TWO, SLIDER)
        levels = np.array([1e-3, 1e-2, 1e-1])
        level_response = response_at_level(
            system, response="block.z", force="block.z", level=levels, frequency=13.0
        )
        amplitudes = [find_amplitude(system, 13.0, level) for level in levels]
        assert level_response.amplitude == pytest.approx(amplitudes, rel=1e-12)


class TestBackbone:
    def test_a_cubic_spring(self):
        m, k3 = 0.104, 6e7
        result = backbone(
            make_single_mass(GeneralizedMaxwell(393.0), Cubic(k3), m), amplitude=[1e-4, 1e-3, 5e-3]
        )
        X = result.amplitude
        assert result.frequency == pytest.approx(
            np.sqrt((393.0 + 0.75 * k3 * X**2) / m) / 2 / np.pi, rel=1e-10
        )
        assert np.abs(result.damping_ratio).max() < 1e-12

    def test_it_falls_from_stuck_to_free_and_damps_between(self):
        result = backbone(make_single_mass(TWO, SLIDER), amplitude=np.geomspace(1e-5, 1, 25))
        ends = [
            newton_modes(make_single_mass(solid, None))[0].frequency
            for solid in (GeneralizedMaxwell(493.0, TWO.k, TWO.tau), TWO)
        ]
        assert result.frequency[[0, -1]] == pytest.approx(ends, rel=1e-4)
        assert (np.diff(result.frequency) < 1e-12).all()
        assert 5 < result.damping_ratio.argmax() < 20

    def test_two_sliders_take_their_shares_from_the_shape(self):
        mounts = (
            Mount(TWO, ("block", "ground"), friction=Jenkins(100.0, 0.05)),
            Mount(2 * TWO, ("top", "block"), friction=Jenkins(100.0, 0.02)),
        )
        system = System((point_mass("block", 0.1), point_mass("top", 0.1)), mounts)
        first = backbone(system, amplitude=[1e-3])
        share = 0.5  # any other amplitude of the second gives another pole
        held = tuple(
            replace(m, amplitude=1e-3 * s) for m, s in zip(mounts, (1, share), strict=True)
        )
        other = newton_modes(replace(system, mounts=held))[0]
        assert first.frequency[0] != pytest.approx(other.frequency, rel=1e-9)
        shape = np.abs(system.stretch @ other.shape)
        for _ in range(50):
            held = tuple(
                replace(m, amplitude=1e-3 * s)
                for m, s in zip(mounts, shape / shape[0], strict=True)
            )
            other = newton_modes(replace(system, mounts=held))[0]
            shape = np.abs(system.stretch @ other.shape)
        assert first.frequency[0] == pytest.approx(other.frequency, rel=1e-9)


class TestFold:
    def test_kraus_with_tied_loss_never_folds_and_a_cubic_spring_does(self):
        X = np.geomspace(1e-6, 1e-1, 400)
        for m in (0.3, 0.5, 0.8):
            assert not can_fold(Kraus(100.0, 1e-3, exponent=m), omega=80.0, amplitude=X).any()
        assert can_fold(HARD + Cubic(6e7), omega=80.0, amplitude=X).any()

    def test_the_rule_finds_what_the_scan_finds(self):
        system = make_single_mass(HARD, InParallel((Cubic(6e7),)))
        level_response = find_all_responses(
            system, response="block.z", force="block.z", level=0.6, frequency=16.0
        )
        low, high = level_response.amplitude[[0, -1]]
        X = np.geomspace(low, high, 100)
        assert can_fold(HARD + Cubic(6e7), omega=2 * np.pi * 16.0, amplitude=X).any()

    def test_jenkins_elements_parallel_to_arms_have_one_response(self):
        rng = np.random.default_rng(7)
        for _ in range(20):
            parts = [
                Jenkins(k, k * y)
                for k, y in zip(rng.uniform(1, 300, 3), 10 ** rng.uniform(-4, -2, 3), strict=True)
            ]
            system = make_single_mass(TWO, InParallel(tuple(parts)))
            for hz in rng.uniform(8, 20, 3):
                level_response = find_all_responses(
                    system, response="block.z", force="block.z", level=0.1, frequency=float(hz)
                )
                assert len(level_response.frequency) == 1


class TestRefused:
    def test_a_loop_that_does_not_close(self):
        """Berg's friction creeps to its loop: slowly where the motion is a small part of x_2."""
        system = make_single_mass(TWO, Berg(0.1, 5e-4))
        assert find_amplitude(system, 5.0, 0.5, (1, 3)) == pytest.approx(
            find_amplitude(system, 5.0, 0.5), rel=0.02
        )
        with pytest.raises(DataError, match="does not close"):
            find_amplitude(make_single_mass(TWO, Berg(10.0, 1e-2)), 5.0, 0.5, (1, 3))

    def test_a_linear_answer_without_an_amplitude(self):
        system = make_single_mass(TWO, SLIDER)
        with pytest.raises(DataError, match="amplitude"):
            system.frf(response="block.z", force="block.z", frequency=[10.0])

    def test_linear_equations_in_time(self):
        held = replace(make_single_mass(TWO, SLIDER).mounts[0], amplitude=1e-3)
        system = replace(make_single_mass(TWO, SLIDER), mounts=(held,))
        assert np.isfinite(
            system.frf(response="block.z", force="block.z", frequency=[10.0]).value
        ).all()
        for ask in (complex_modes, lambda s: respond(s, [0, 1.0])):
            with pytest.raises(DataError, match="no arms"):
                ask(system)

    @pytest.mark.parametrize(
        ("words", "message"),
        [
            ({"force": None}, "one of the two"),
            ({"level": 0.0}, "above 0"),
            ({"harmonics": (1, 2)}, "odd"),
            ({"force": None, "base": "ground"}, "no ground motion"),
        ],
    )
    def test_questions_without_an_answer(self, words, message):
        requested = {
            "response": "block.z",
            "force": "block.z",
            "level": 0.1,
            "frequency": [10.0],
            **words,
        }
        with pytest.raises(DataError, match=message):
            response_at_level(make_single_mass(TWO, SLIDER), **requested)

    def test_a_system_without_friction(self):
        with pytest.raises(DataError, match="no mount of the system has friction"):
            response_at_level(
                make_single_mass(TWO, None),
                response="block.z",
                force="block.z",
                level=1.0,
                frequency=[1.0],
            )

    def test_every_answer_of_two_mounts(self):
        mounts = (
            Mount(TWO, ("block", "ground"), friction=SLIDER),
            Mount(TWO, ("block", "ground"), friction=Iwan(100.0, 0.1)),
        )
        system = System((point_mass("block", 0.1),), mounts)
        with pytest.raises(DataError, match="one such mount"):
            find_all_responses(
                system, response="block.z", force="block.z", level=0.1, frequency=10.0
            )
