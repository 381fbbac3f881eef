"""Modes: exact ones of a model, and measured ones by every method."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dashpot.base.errors import DataError, FitError
from dashpot.datamodel.frf import FRF, Kind, Mode
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.vibration.impact.frf_estimation import estimate_frf
from dashpot.vibration.mass_on_seals import model_modes, predict_frf
from dashpot.vibration.modal.modal_methods import Method
from dashpot.vibration.modal.peaks import find_mount_band
from dashpot.vibration.modal.pole_fit import BackgroundProjection, FRFLines, PoleTrial, pole_kernel

MASS, BROAD_MASS = 0.1040426, 0.114829829
TRUE = 12.70975, 0.00443503

positive = st.floats(0.01, 100.0)
solids = st.builds(
    lambda k_inf, arms: GeneralizedMaxwell(k_inf, [k for k, _ in arms], [tau for _, tau in arms]),
    st.floats(10.0, 1000.0),
    st.lists(
        st.tuples(st.floats(1.0, 500.0), st.floats(1e-4, 100.0)),
        max_size=3,
        unique_by=lambda a: a[1],
    ),
)


# -- of a model ---------------------------------------------------------------------------------


def test_the_papers_block_on_two_seals(paper_seal):
    (mode,) = model_modes(2 * paper_seal, MASS)
    assert mode.frequency == pytest.approx(12.70975, abs=5e-6)
    assert mode.damping_ratio == pytest.approx(0.00443503, abs=5e-9)
    assert mode.pole.real == pytest.approx(-0.354171, abs=1e-6)
    assert mode.pole.imag == pytest.approx(79.85693, abs=1e-4)
    # one seal under half the mass is the same oscillator
    (half,) = model_modes(paper_seal, MASS / 2)
    assert half.frequency == pytest.approx(mode.frequency, rel=1e-12)


def test_the_broad_seal(broad_seal):
    (mode,) = model_modes(2 * broad_seal, BROAD_MASS)
    assert mode.frequency == pytest.approx(12.69983, abs=5e-6)
    assert mode.damping_ratio == pytest.approx(0.0285575, abs=5e-8)


@given(solids, positive)
def test_a_model_mode_is_a_root_and_its_residue_a_limit(solid, mass):
    for mode in model_modes(solid, mass):
        p = mode.pole
        assert abs(mass * p**2 + solid.stiffness_at(p)) < 1e-8 * abs(mass * p**2)
        near = p * (1 + 1e-6j)
        limit = (near - p) / (mass * near**2 + solid.stiffness_at(near))
        assert mode.residue == pytest.approx(complex(limit), rel=1e-2)
        assert 0 <= mode.damping_ratio < 1


def test_modal_mass_of_a_spring_is_the_mass():
    (mode,) = model_modes(GeneralizedMaxwell(400.0, b=0.2), mass=0.25)
    assert mode.modal_mass == pytest.approx(0.25, rel=1e-12)
    assert mode.damping_ratio == pytest.approx(0.2 / (2 * np.sqrt(400 * 0.25)), rel=1e-12)
    assert mode.bandwidth == pytest.approx(2 * mode.damping_ratio * mode.frequency)


def test_an_overdamped_block_has_no_mode():
    assert model_modes(GeneralizedMaxwell(1.0, b=100.0), mass=0.1) == ()


def test_a_model_needs_a_mass(paper_seal):
    with pytest.raises(DataError, match="mass = 0 kg; expected a number > 0"):
        model_modes(paper_seal, 0)


# -- measured -----------------------------------------------------------------------------------


def test_two_seconds_are_enough_for_a_q_of_113(strike):
    (mode,) = estimate_frf(strike(record=2.0)).modes()
    assert mode.frequency == pytest.approx(TRUE[0], rel=1e-5)
    assert mode.damping_ratio == pytest.approx(TRUE[1], rel=1e-3)
    assert mode.modal_mass == pytest.approx(MASS, rel=1e-3)
    (noisy,) = estimate_frf(strike(record=2.0, hits=5, noise=(5e-3, 0.02))).modes()
    assert noisy.frequency == pytest.approx(TRUE[0], rel=5e-4)
    assert noisy.damping_ratio == pytest.approx(TRUE[1], rel=0.05)


@pytest.mark.parametrize("method", ["rational", "peak", "half-power", "circle"])
def test_every_method_reads_a_long_record(strike, method):
    (mode,) = estimate_frf(strike(record=64.0, rate=1024)).modes(method=method)
    assert mode.method == method
    assert mode.frequency == pytest.approx(TRUE[0], abs=0.005)
    assert 1 / (2 * mode.damping_ratio) == pytest.approx(112.76, rel=0.01)


@pytest.mark.parametrize("method", ["rational", "circle", "peak", "decrement", "half-power"])
def test_every_method_takes_noise_and_says_its_error(strike, broad_seal, method):
    frf = estimate_frf(strike(2 * broad_seal, BROAD_MASS, record=16.0, hits=5, noise=(5e-3, 0.02)))
    (mode,) = frf.modes(method=method)
    assert mode.frequency == pytest.approx(12.69983, abs=5 * mode.frequency_se + 0.002)
    assert mode.damping_ratio == pytest.approx(0.0285575, abs=5 * mode.damping_ratio_se + 3e-4)
    assert 0 < mode.damping_ratio_se < 0.1 * mode.damping_ratio


@pytest.mark.parametrize("method", ["rational", "peak", "circle", "decrement"])
def test_the_exponential_window_leaves_no_trace(strike, method):
    """Damping comes from s = j omega + a, without a correction that knows one damping only."""
    frf = estimate_frf(strike(record=16.0), window="exponential:0.001")
    assert frf.shift > 0.35
    (mode,) = frf.modes(method=method)
    assert mode.frequency == pytest.approx(TRUE[0], rel=1e-4)
    assert mode.damping_ratio == pytest.approx(TRUE[1], rel=0.025)


def test_half_power_is_refused_where_lines_are_too_few(strike):
    frf = estimate_frf(strike(record=8.0))
    with pytest.raises(FitError, match="needs at least 5 lines in the half-power band, but only"):
        frf.modes(method="half-power")


def test_a_peak_between_the_lines_is_refused(strike):
    frf = estimate_frf(strike(record=2.0))
    with pytest.raises(FitError, match="miss the peak between them"):
        frf.modes(method="peak")


def test_unknown_methods_and_empty_bands_are_refused(strike):
    frf = estimate_frf(strike())
    with pytest.raises(DataError, match="expected one of rational, peak, half-power, circle"):
        frf.modes(method="magic")
    with pytest.raises(DataError, match=r"lines between 12 and 12\.5 Hz; modes need at least 8"):
        frf.modes(band=(12.0, 12.5))
    with pytest.raises(DataError, match="reads one mode, not 3"):
        frf.modes(method="circle", count=3)
    with pytest.raises(FitError, match="edge of the band"):
        frf.modes(method="circle", band=(13.0, 30.0))


@pytest.mark.parametrize("kind", [kind for kind in sorted(Kind) if not kind.over_base])
def test_the_kind_of_frf_does_not_matter(paper_seal, kind):
    frf = predict_frf(2 * paper_seal, mass=MASS, frequency=np.arange(2, 50, 0.05), kind=kind)
    (mode,) = frf.modes()
    assert mode.frequency == pytest.approx(TRUE[0], rel=1e-5)
    assert mode.damping_ratio == pytest.approx(TRUE[1], rel=1e-3)


@settings(max_examples=40, deadline=None)
@given(st.floats(1.2, 200.0), st.floats(1e-3, 0.4), st.floats(0.0, 0.2), st.sampled_from([40, 300]))
def test_a_predicted_block_has_the_mode_it_has(frequency, zeta, shift, lines):
    """Kelvin-Voigt, whatever the damping, window and spacing of the lines."""
    omega, mass = 2 * np.pi * frequency, 0.3
    solid = GeneralizedMaxwell(mass * omega**2, b=2 * zeta * omega * mass)
    f = np.geomspace(frequency / 10, 6 * frequency, lines)
    (mode,) = predict_frf(solid, mass=mass, frequency=f, shift=shift * omega).modes()
    assert mode.frequency == pytest.approx(frequency, rel=1e-6)
    assert mode.damping_ratio == pytest.approx(zeta, rel=1e-4)
    assert mode.modal_mass == pytest.approx(mass, rel=1e-3)


def _modal(frequency, modes, record=None, shift=0.0):
    """Accelerance of given modes, heard for `record` s after an impulse."""
    s = 2j * np.pi * frequency + shift
    lines = FRFLines(s, s[None], s[None].real, record)
    total = np.zeros(len(s), dtype=complex)
    for mode in modes:
        for p, r in ((mode.pole, mode.residue), (mode.pole.conjugate(), mode.residue.conjugate())):
            total += r * p**2 * pole_kernel(lines, p)
    return total


@pytest.mark.parametrize(("record", "shift"), [(None, 0.0), (4.0, 0.0), (4.0, 1.0)])
def test_modes_separates_several_modes(record, shift):
    true = (
        Mode(9.0, 0.02, -0.05j),
        Mode(11.0, 0.01, -0.03j),
        Mode(20.0, 0.03, 0.02j),
    )
    f = np.arange(1, 160) / 4
    frf = FRF(f, _modal(f, true, record, shift), record=record, shift=shift, units="SI")
    modes = frf.modes(band=(2, 39))
    assert len(modes) == 3
    for mode, expected in zip(modes, true, strict=True):  # largest residue first
        assert mode.frequency == pytest.approx(expected.frequency, rel=1e-4)
        assert mode.damping_ratio == pytest.approx(expected.damping_ratio, rel=1e-2)
        assert mode.residue == pytest.approx(expected.residue, rel=1e-2)


def test_modes_of_a_mode_with_noise_has_no_spurious_mode():
    random = np.random.default_rng(1)
    f = np.arange(8, 320) / 8
    for seed in range(5):
        random = np.random.default_rng(seed)
        noise = random.standard_normal(len(f)) + 1j * random.standard_normal(len(f))
        sd = 0.2
        value = _modal(f, (Mode(12.0, 0.02, -0.05j),)) + sd * noise
        modes = FRF(f, value, sd=np.full(len(f), sd), units="SI").modes()
        assert len(modes) == 1
        assert modes[0].frequency == pytest.approx(12.0, abs=4 * modes[0].frequency_se)


def test_flat_lines_have_no_mode():
    f = np.arange(1, 200) / 4
    assert FRF(f, np.full(len(f), 2.0 + 0j), units="SI").modes(band=(1, 40)) == ()


def test_modes_returns_the_requested_number():
    f = np.arange(1, 160) / 4
    modes = FRF(f, _modal(f, (Mode(9.0, 0.02, -0.05j),)), units="SI").modes(count=2, band=(2, 39))
    assert len(modes) == 2


def test_the_kernel_is_the_transform_over_the_record():
    p, record = complex(-0.4, 80.0), 2.0
    s = np.array([1j * 70.0, 0.3 + 81j, 1j * 80.0])
    t = np.linspace(0, record, 400_001)
    lines = FRFLines(s, s[None], s[None].real, record)
    numeric = [np.trapezoid(np.exp((p - x) * t), t) for x in s]
    np.testing.assert_allclose(pole_kernel(lines, p), numeric, rtol=1e-6)


def test_the_mount_band_ignores_noise_near_zero(strike):
    frf = estimate_frf(strike(record=8.0, hits=3, noise=(0.01, 0.2)))
    low, high = find_mount_band(frf.frequency, frf.value, frf.sd)
    assert low == pytest.approx(12.7 / 4, rel=0.05)
    assert high == pytest.approx(12.7 * 4, rel=0.05)


def test_modes_are_a_method_of_the_frf(strike):
    frf = estimate_frf(strike(hits=3, noise=(5e-3, 0.02)))
    assert isinstance(frf, FRF)
    assert all(isinstance(mode, Mode) for mode in frf.modes())
    assert frf.modes()[0].method == Method.RATIONAL.value


def test_modes_refuses_a_band_outside_the_lines(paper_seal):
    frf = predict_frf(2 * paper_seal, mass=MASS, frequency=np.arange(4.0, 40.0, 0.5))
    with pytest.raises(DataError, match=r"0 lines between 900 and 950 Hz; .* from 4 to 39.5 Hz"):
        frf.modes(band=(900.0, 950.0))


def test_poles_on_trial_know_the_slope_of_their_sum_of_squares():
    f, rng = np.arange(5.0, 60.0, 0.5), np.random.default_rng(3)
    s, p = 2j * np.pi * f, np.array([[complex(-3.0, 80.0)], [complex(-9.0, 200.0)]])
    lines = FRFLines(s, np.empty((2, len(f)), complex), np.full((2, len(f)), 0.01), 2.0, 0.002)
    modes = pole_kernel(lines, p) * 0.1
    scatter = 0.01 * rng.standard_normal((2, 2, len(f)))
    lines = replace(lines, value=np.array([[1.0, 0.4], [0.7, -1.0]]) @ modes + 1j * scatter[0])
    theta = np.log([4.0, 82.0, 7.0, 190.0])
    trial = PoleTrial(BackgroundProjection.from_lines(lines), theta)
    for i in range(4):
        h = 1e-5 * np.eye(4)[i]
        rise = trial.step_ahead(h).sse - trial.step_ahead(-h).sse
        assert trial.gradient[i] == pytest.approx(rise / 4e-5, rel=1e-6)


def test_a_pole_on_trial_oscillates():
    s, ones = 2j * np.pi * np.arange(5.0, 60.0), np.ones((1, 55))
    lines = FRFLines(s, ones.astype(complex), ones, None)
    for ratio, there in ((0.74, True), (0.76, False)):
        trial = PoleTrial(BackgroundProjection.from_lines(lines), np.log([ratio * 100.0, 100.0]))
        assert np.isfinite(trial.sse) == there
