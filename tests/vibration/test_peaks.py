"""Peaks read from the smooth inverse of a response, and responses that are cut short."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dashpot.base.errors import DataError
from dashpot.datamodel.frf import FRF, Kind
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.vibration.mass_on_seals import accelerance, poles, predict_frf, residues
from dashpot.vibration.modal.peaks import find_peak

PAPER = GeneralizedMaxwell(196.5, (117.5, 17.8), (59.0 / 117.5, 292.2 / 17.8))


@pytest.mark.parametrize("step", [0.02, 0.1, 0.25, 0.5])
@pytest.mark.parametrize("start", [1.0, 1.03, 1.11])
def test_find_peak_resolves_a_peak_between_lines(step: float, start: float) -> None:
    """Q = 113: the half-power band is 0.113 Hz, narrower than most of these line spacings."""
    frf = predict_frf(PAPER, mass=0.0520213, frequency=np.arange(start, 40, step))
    peak = find_peak(frf)
    assert peak.frequency == pytest.approx(12.71, abs=1e-4)
    assert peak.height == pytest.approx(2167.58, rel=2e-3)
    assert peak.damping_ratio == pytest.approx(0.004435, rel=0.05)
    assert peak.half_power_lines == pytest.approx(0.1127 / step, rel=0.1)


@settings(max_examples=25, deadline=None)
@given(
    kind=st.sampled_from([kind for kind in sorted(Kind) if not kind.over_base]),
    shift=st.floats(0, 3),
    mass=st.floats(0.02, 0.2),
)
def test_kind_and_window_do_not_move_it(kind: Kind, shift: float, mass: float) -> None:
    lines = np.arange(1, 60, 0.1)
    plain = find_peak(predict_frf(PAPER, mass=mass, frequency=lines))
    other = find_peak(predict_frf(PAPER, mass=mass, frequency=lines, kind=kind, shift=shift))
    assert other.frequency == pytest.approx(plain.frequency, rel=1e-3)
    assert other.height == pytest.approx(plain.height, rel=0.1)


def test_the_standard_error_is_the_scatter() -> None:
    lines = np.arange(5, 30, 0.1)
    solid = GeneralizedMaxwell(300.0, (40.0,), (0.0125,))
    clean = predict_frf(solid, mass=0.05, frequency=lines)
    sd = 0.02 * np.abs(clean.value)
    result = []
    for seed in range(200):
        draw = np.random.default_rng(seed).standard_normal((2, len(lines)))
        result.append(
            find_peak(replace(clean, value=clean.value + sd * (draw[0] + 1j * draw[1]), sd=sd))
        )
    spread = np.std([peak.frequency for peak in result])
    assert spread == pytest.approx(np.mean([peak.frequency_se for peak in result]), rel=0.35)
    spread = np.std([peak.damping_ratio for peak in result])
    assert spread == pytest.approx(np.mean([peak.damping_se for peak in result]), rel=0.35)


def test_coherence_gives_the_scatter() -> None:
    """ISO 7626-2: sqrt((1 - g2) / (2 n g2)) of the magnitude."""
    frf = FRF(
        np.array([1.0, 2.0]),
        np.array([3 + 4j, 1j]),
        coherence=np.array([0.9, 1.0]),
        averages=5,
        units="SI",
    )
    assert frf.random_sd == pytest.approx([5 * np.sqrt(0.1 / (10 * 0.9)), 0.0])
    assert replace(frf, averages=1).random_sd is None
    assert replace(frf, coherence=None).random_sd is None


def test_too_few_lines() -> None:
    frf = predict_frf(PAPER, mass=0.05, frequency=[1.0, 2.0, 3.0])
    with pytest.raises(DataError, match="a peak needs at least 5"):
        find_peak(frf)


# -- cut records ------------------------------------------------------------------------------


def test_poles_and_residues_make_the_receptance() -> None:
    solid = PAPER + GeneralizedMaxwell(0.0, (30.0,), (0.01,), 0.4)
    p = poles(solid, 0.05)
    r = residues(solid, 0.05, p)
    s = 2j * np.pi * np.linspace(0.1, 60, 50)
    summed = (r / (s[:, None] - p)).sum(axis=1)
    assert summed == pytest.approx(1 / (0.05 * s**2 + solid.stiffness_at(s)), rel=1e-9)
    assert 0.05 * p**2 + solid.stiffness_at(p) == pytest.approx(0, abs=1e-7)


def test_the_poles_of_table_1() -> None:
    """Domain reference 1c."""
    p = np.sort_complex(poles(PAPER, 0.0520213))
    assert p == pytest.approx(
        [-1.288324, -0.354171 - 79.85693j, -0.354171 + 79.85693j, -0.055776], abs=2e-5
    )


@settings(max_examples=15, deadline=None)
@given(record=st.floats(0.2, 10), shift=st.floats(0, 2))
def test_a_cut_response_against_quadrature(record: float, shift: float) -> None:
    """The transform of the impulse response over the record alone."""
    mass = 0.05
    p = poles(PAPER, mass)
    weight = residues(PAPER, mass, p) * p**2
    t = np.linspace(0, record, 200001)
    impulse = (weight * np.exp(p * t[:, None])).sum(axis=1).real
    s = np.array([3.0, 12.6, 30.0]) * 2j * np.pi + shift
    transform = np.array([np.trapezoid(impulse * np.exp(-value * t), t) for value in s]) + 1 / mass
    assert accelerance(PAPER, mass, s, record) == pytest.approx(transform, rel=2e-5, abs=1e-2)


def test_a_cut_response_to_a_pulse() -> None:
    """A 15 ms half-sine at whose middle the record begins: ratio of the two transforms."""
    mass, record, width = 0.05, 1.3, 0.015
    h = 2e-5
    t = (np.arange(round((record + width / 2) / h)) + 0.5) * h
    pulse = np.where(t < width, np.sin(np.pi * t / width), 0.0)
    p = poles(PAPER, mass)
    weight = residues(PAPER, mass, p) * p**2
    # response of each pole to the pulse, exactly after it has ended
    grown = np.cumsum(pulse[:, None] * np.exp(-p * t[:, None]), axis=0) * h
    response = (weight * np.exp(p * t[:, None]) * grown).sum(axis=1).real
    s = 2j * np.pi * np.array([5.0, 12.0, 20.0])
    kernel = np.exp(-s[:, None] * t)
    ratio = (kernel @ response) / (kernel @ pulse) + 1 / mass
    rms = np.sqrt(np.sum(pulse * (t - width / 2) ** 2) / np.sum(pulse))
    cut = accelerance(PAPER, mass, s, record, float(rms))
    assert cut == pytest.approx(ratio, rel=2e-3)
    plain = accelerance(PAPER, mass, s, record)
    assert np.abs(cut - ratio).max() < 0.2 * np.abs(plain - ratio).max()


def test_a_long_record_cuts_nothing() -> None:
    s = 2j * np.pi * np.array([1.0, 12.71, 40.0])
    whole = s**2 / (0.05 * s**2 + PAPER.stiffness_at(s))
    assert accelerance(PAPER, 0.05, s, 500.0) == pytest.approx(whole, rel=1e-12)
