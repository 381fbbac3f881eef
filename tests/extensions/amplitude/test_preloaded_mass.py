"""A mass on a nonlinear seal with lift-off: harmonics against independent shooting."""

from __future__ import annotations

import numpy as np
import pytest

from dashpot.base.errors import DataError
from dashpot.extensions.amplitude.polynomial_law import PolynomialLaw
from dashpot.extensions.amplitude.preloaded_mass import HARMONICS, PreloadedMass, _PressedBalance
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.fractional import FractionalZener
from dashpot.solids.maxwell import GeneralizedMaxwell

pytestmark = pytest.mark.once

SOLID = GeneralizedMaxwell(196.5, (117.5, 17.8), (59.0 / 117.5, 292.2 / 17.8))
LAW = PolynomialLaw((120.0, 1e4, 8e5))
MASS = 0.1040426
ON_SEALS = PreloadedMass(MASS, 2 * LAW, SOLID)

# shooting with DOP853 at rtol 1e-12, two seals under the weight: N, Hz, |h0| to |h5| in mm, phase
# of the first in degrees, and the largest Floquet multiplier
SHOT = {
    "mild": (
        0.02, 12.0, (3.186830185, 0.179434438, 0.000576939, 2.180e-6, 8e-9), -3.3952, 0.99536
    ),
    "below resonance": (
        0.30, 10.0, (3.143046963, 1.031379714, 0.033540678, 0.000933099, 2.7737e-5, 8.28e-7),
        -1.5613, 0.99444,
    ),
    "half resonance": (
        0.30, 6.6, (3.159591062, 0.538736330, 0.610585379, 0.022222059, 0.005597140, 0.000374853),
        -2.9118, 0.99158,
    ),
    "far": (
        0.75, 8.0, (3.064301174, 1.683637277, 0.240907522, 0.016404796, 0.001352353, 0.000112634),
        -1.3222, 0.99305,
    ),
    "contact lost": (
        0.60, 9.5, (2.937172660, 2.031594896, 0.209104938, 0.000998156, 0.004124773, 0.000684924),
        -1.5526, 0.99458,
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", SHOT)
def test_harmonics_and_multipliers_are_those_of_shooting(case):
    level, hz, amplitudes, phase, growth = SHOT[case]
    result = ON_SEALS.shaken(level=level, frequency=hz)
    near = 1e-4 if case == "contact lost" else 1e-6
    # relative; of the smallest the last digit that the page prints
    assert 1e3 * result.amplitudes[: len(amplitudes)] == pytest.approx(
        amplitudes, rel=near, abs=1e-9
    )
    assert np.degrees(np.angle(result.harmonics[1])) == pytest.approx(phase, abs=1e-4)
    assert result.growth == pytest.approx(growth, abs=2e-5)
    assert result.lost_contact == pytest.approx(0.245 if case == "contact lost" else 0.0, abs=2e-3)


@pytest.mark.parametrize(
    ("level", "hz", "linear", "item"),
    [
        (0.02, 12.0, 0.179333, 0.179490), (0.30, 10.0, 1.027091, 1.038597),
        (0.30, 6.6, 0.572937, 0.574027), (0.75, 8.0, 1.705249, None),
        (0.60, 9.5, 1.806658, None), (2.2, 20.0, 2.340245, None),
    ],
)  # fmt: skip
def test_what_fewer_harmonics_find_is_that_far_off(level, hz, linear, item):
    """Linear about rest, and with the mean and one harmonic: what either misses, by shooting."""
    small = ON_SEALS.shaken(level=1e-6, frequency=hz)
    assert 1e9 * level * small.amplitudes[1] == pytest.approx(linear, abs=6e-7)
    if item is not None:
        pressed_balance = _PressedBalance(ON_SEALS, hz, level, 1)
        harmonics = pressed_balance.harmonics(pressed_balance.solve_by_continuation().unknowns)
        assert 1e3 * abs(harmonics[1]) == pytest.approx(item, abs=6e-7)


def test_the_seal_opens_when_shaken():
    result = ON_SEALS.shaken(level="0.6N", frequency="9.5Hz")
    assert 1e3 * ON_SEALS.rest == pytest.approx(3.1881952824, abs=1e-10)
    assert 1e3 * result.shift == pytest.approx(-0.251, abs=5e-4)
    assert 0 < result.least < ON_SEALS.rest < result.most


@pytest.mark.parametrize(
    ("of", "at", "amplitudes", "growth", "lost"),
    [
        # 1e-4 of loss: a step of the level goes past the turn of its phase
        (
            PreloadedMass(
                0.975, PolynomialLaw((1167.0, 0.0, 4e6)),
                GeneralizedMaxwell(1.0, (0.0106,), (5.78,)), preload=9.566,
            ),
            (7.68, 5.85), (3.0801735, 18.754517, 2.2466709, 0.51759601), 0.99993680, 0.59284,
        ),
        # a step of the level goes past it, and no way leads back
        (
            PreloadedMass(
                0.13596, PolynomialLaw((63.0275, 0.0, 41399.0)),
                GeneralizedMaxwell(1.0, (0.80736, 1.87014), (0.10956, 1.80003), b=2.2e-4),
                preload=1.33332,
            ),
            (0.535, 7.7117), (13.493255, 7.8345613, 0.52968191, 0.013748493), 0.96609195, 0.40664,
        ),
    ],
)  # fmt: skip
def test_shaken_mass_follows_large_bouncing_past_the_folds(of, at, amplitudes, growth, lost):
    """By shooting with DOP853 between the instants of contact, apart from dashpot."""
    result = of.shaken(level=at[0], frequency=at[1])
    assert 1e3 * result.amplitudes[:4] == pytest.approx(amplitudes, abs=1e-6 * amplitudes[1])
    assert result.growth == pytest.approx(growth, abs=1e-5)
    assert result.lost_contact == pytest.approx(lost, abs=5e-4)


def test_an_orbit_that_does_not_last_is_refused():
    with pytest.raises(
        DataError, match="steady answer at the drive's period is unstable"
    ) as message:
        ON_SEALS.shaken(level=2.2, frequency=20.0)
    assert "grows by 1.74" in str(message.value)
    assert "twice the period" in str(message.value)
    (orbit,) = ON_SEALS.sweep(level=2.2, frequency=np.array([20.0]))
    assert not orbit.stable
    assert 1e3 * orbit.amplitudes[:4] == pytest.approx(
        (2.839145804, 2.149047322, 0.037851855, 0.003381632), rel=3e-3
    )


def test_sweep_passes_the_fold_and_agrees_with_single_frequencies():
    lines = np.array([10.0, 11.0, 12.76, 14.0, 26.15, 30.0])
    swept = ON_SEALS.sweep(level=0.3, frequency=lines)
    assert [response.frequency for response in swept] == lines.tolist()
    # half as fast as twice the resonance it answers at twice the period
    assert [item.stable for item in swept] == [True] * 4 + [False, True]
    for element in (swept[0], swept[2]):
        single = ON_SEALS.shaken(level=0.3, frequency=element.frequency)
        assert element.amplitudes[:4] == pytest.approx(single.amplitudes[:4], abs=2e-6)
        assert len(element.harmonics) == HARMONICS + 1


def test_what_a_stiffer_law_changes_is_what_it_finds():
    (at,) = ON_SEALS.sweep(level=0.3, frequency=np.array([8.0]))
    harder = PreloadedMass(MASS, 2 * PolynomialLaw((120.0, 1.0005e4, 8e5)), SOLID)
    (there,) = harder.sweep(level=0.3, frequency=np.array([8.0]))
    change = ON_SEALS.changes(at, [harder])[0]
    assert change[:4] == pytest.approx((there.harmonics - at.harmonics)[:4], rel=1e-2, abs=1e-10)


def test_a_sweep_jumps_where_its_branch_ends_and_the_end_moves_with_the_law():
    """A soft law: the answer from below ends, and the larger one lasts below that, too."""
    lines = np.linspace(12.0, 13.4, 29)

    def jump(law):
        of = PreloadedMass(MASS, 2 * law, SOLID)
        (result,) = of.jumps(of.sweep(level=0.1, frequency=lines))
        return of, result

    of, (before, after) = jump(ElasticLaw((0.0, 8e-3), (1.0, 1.0), 208.0))
    assert before.stable
    assert after.stable
    assert after.lost_contact > 0.1
    stiffer = ElasticLaw((0.0, 8e-3), (1.0, 1.0), 208.2)
    (variant,) = of.end_changes(before, [PreloadedMass(MASS, 2 * stiffer, SOLID)])
    assert variant == pytest.approx(jump(stiffer)[1].before.frequency - before.frequency, rel=0.1)


def test_shaken_mass_of_small_motion_is_linear():
    """Of the tangent at rest, with arms, a dashpot, and a solid of no finite number of arms."""
    for solid in (
        SOLID,
        SOLID + GeneralizedMaxwell(0.0, b=0.4),
        FractionalZener(200, 160, 0.3, 0.4),
    ):
        of = PreloadedMass(MASS, 2 * LAW, solid)
        result = of.shaken(level=1e-6, frequency=11.0)
        omega = 2 * np.pi * 11.0
        G = complex(solid.complex_stiffness(omega=omega)) / solid.k_inf
        K = 2 * (120 + 2e4 * of.rest + 2.4e6 * of.rest**2) * G
        assert result.harmonics[1] == pytest.approx(1e-6 / (K - MASS * omega**2), rel=1e-6)
        # the multiplier of a linear system: of its slowest pole
        assert result.stable


def test_knots_answer_as_the_curve_they_lie_on():
    """A piecewise law with many knots is the polynomial."""
    knots = np.linspace(0.0, 7e-3, 1401)
    tangent, deepest = LAW.tangent(knots), float(LAW.force(knots[-1])) / knots[-1]
    mean = np.trapezoid(tangent, knots) / knots[-1]
    law = ElasticLaw(tuple(knots), tuple(tangent / mean), deepest)
    item, other = (
        PreloadedMass(MASS, 2 * value, SOLID).shaken(level=0.3, frequency=6.6)
        for value in (law, LAW)
    )
    assert item.amplitudes[:4] == pytest.approx(other.amplitudes[:4], rel=1e-5, abs=1e-9)


class TestRefused:
    def test_a_preload_that_pulls(self):
        with pytest.raises(
            DataError, match=r"preload of -1 N pulls.*expected a force that presses"
        ):
            PreloadedMass(MASS, LAW, SOLID, preload=-1.0)

    def test_a_law_that_carries_it_nowhere(self):
        with pytest.raises(DataError, match=r"no compression carries 1\.02 N"):
            PreloadedMass(MASS, PolynomialLaw((100.0, -1e4)), SOLID)

    def test_a_law_with_several_rests_lists_them(self):
        # (x - 1)(x - 2)(x - 4), in mm and N
        law = PolynomialLaw((14e3 / 8, -7e6 / 8, 1e9 / 8))
        with pytest.raises(DataError, match=r"not monotone.*1 N rests at 1 mm, 2 mm, 4 mm"):
            PreloadedMass(MASS, law, SOLID, preload=1.0)

    def test_preloaded_mass_has_one_rest_on_a_non_monotone_law(self):
        law = PolynomialLaw((14e3 / 8, -7e6 / 8, 1e9 / 8))
        assert PreloadedMass(MASS, law, SOLID, preload=5.0).rest > 4e-3

    def test_a_solid_that_relaxes_to_nothing(self):
        with pytest.raises(DataError, match="relaxes to zero"):
            PreloadedMass(MASS, LAW, GeneralizedMaxwell(0.0, (100.0,), (1.0,)))

    def test_shaken_mass_states_the_largest_force_with_an_orbit(self):
        # bears 1.5 N at most
        soft = PreloadedMass(MASS, ElasticLaw((0.0, 5e-3), (2.0, 0.0), 300.0), SOLID)
        with pytest.raises(DataError, match=r"is reached above 0\.\d+ N, and 1 N was asked for"):
            soft.shaken(level=1.0, frequency=0.5)

    def test_numbers_that_cannot_be(self):
        with pytest.raises(DataError, match="expected one other than 0"):
            PolynomialLaw((0.0, 0.0))
        with pytest.raises(DataError, match=r"mass = 0\.0"):
            PreloadedMass(0.0, LAW, SOLID)
        with pytest.raises(DataError, match=r"frequency = -1\.0"):
            ON_SEALS.shaken(level=1.0, frequency=-1.0)
        with pytest.raises(DataError, match="the mass would move by"):
            ON_SEALS.sweep(level=1e6, frequency=np.array([50.0]))


@pytest.mark.slow
def test_shaken_mass_agrees_with_shooting_for_a_general_case():
    """A law that softens and hardens, an arm that is fast, a dashpot, under a spring of 3 N."""
    from scipy.integrate import solve_ivp

    a, m, P, F, hz = (900.0, -1.5e5, 2.5e7), 0.25, 3.0, 2.0, 7.0
    solid = GeneralizedMaxwell(500.0, (120.0, 60.0), (4e-3, 0.3), b=0.6)
    of = PreloadedMass(m, PolynomialLaw(a), solid, preload=P)
    result = of.shaken(level=F, frequency=hz)
    g, tau, dash, omega = np.array(solid.k) / 500, np.array(solid.tau), 0.6 / 500, 2 * np.pi * hz

    def run(y0, **how):
        def rate(t, y):
            x = max(y[0], 0.0)
            force = a[0] * x + a[1] * x**2 + a[2] * x**3
            slope = (a[0] + 2 * a[1] * x + 3 * a[2] * x**2) * (y[0] > 0)
            whole = force + g @ (force - y[2:]) + dash * slope * y[1]
            push = P + F * np.cos(omega * t) - max(whole, 0.0)
            return np.concatenate(([y[1], push / m], (force - y[2:]) / tau))

        how = {"rtol": 1e-10, "atol": 1e-13, "max_step": 1 / hz / 200, **how}
        return solve_ivp(rate, (0, 1 / hz), y0, "DOP853", **how)

    size = np.array([1e-3, 0.1, 1.0, 1.0])
    y = np.array([of.rest, 0.0, P, P])
    for _ in range(60):  # towards the orbit, which attracts
        y = run(y, rtol=1e-6, atol=1e-9).y[:, -1]
    for _ in range(8):
        end = run(y).y[:, -1]
        J = np.column_stack([
            (run(y + 1e-6 * step).y[:, -1] - run(y - 1e-6 * step).y[:, -1]) / 2e-6
            for step in np.diag(size)
        ])  # fmt: skip
        y = y + size * np.linalg.solve(np.eye(4) - J / size[:, None], (end - y) / size)
        if abs((end - y) / size).max() < 1e-9:
            break
    path = run(y, dense_output=True).sol(np.arange(4096) / 4096 / hz)[0]
    h = np.fft.rfft(path)[:4] / 4096 * np.array([1, 2, 2, 2])
    assert result.harmonics[:4] == pytest.approx(h, rel=2e-5, abs=2e-8)
    assert result.growth == pytest.approx(abs(np.linalg.eigvals(J / size[None])).max(), rel=2e-3)
    assert abs(result.harmonics[2]) > 0.02 * abs(result.harmonics[1])


def test_an_orbit_takes_as_many_harmonics_as_it_needs():
    """Twice as many change what is shown by 1e-7 at most, or there are 80."""
    mild = ON_SEALS.shaken(level=0.3, frequency=4.3)
    wild = ON_SEALS.shaken(level=0.6, frequency=9.5)
    assert (len(mild.harmonics) - 1, len(wild.harmonics) - 1) == (20, 80)
