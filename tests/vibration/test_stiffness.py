"""Stiffness and damping straight from an FRF: Lin's method and its error bars."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dashpot.base.errors import DataError
from dashpot.datamodel.frf import FRF, Kind
from dashpot.solids.demo_seals import BROAD, BROAD_MASS, PAPER
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.vibration.mass_on_seals import predict_frf
from dashpot.vibration.modal.dynamic_stiffness import causal_loss_factor, dynamic_stiffness

LINES = np.array([1.0, 2.0, 5.0, 8.0, 10.0, 12.0, 12.71, 13.0, 15.0, 20.0, 30.0, 50.0])
MASS = 0.05202


def select_values(values: np.ndarray, *frequencies: float) -> list[float]:
    return [float(values[list(LINES).index(f)]) for f in frequencies]


def test_lins_numbers_for_table_1() -> None:
    """Domain reference, row [6]."""
    result = dynamic_stiffness(predict_frf(PAPER, mass=MASS, frequency=LINES), MASS)
    assert select_values(result.storage, 1, 5, 12.71, 50) == pytest.approx(
        [321.071, 331.330, 331.727, 331.795], abs=6e-4
    )
    assert select_values(result.damping, 1, 5, 12.71, 50) == pytest.approx(
        [5.41373, 0.237246, 0.0368393, 0.00238185], rel=3e-6
    )


@settings(max_examples=20, deadline=None)
@given(mass=st.floats(0.02, 1), kind=st.sampled_from(list(Kind)), seals=st.floats(0.5, 4))
def test_dynamic_vertical_shift_plausible_is_exact(mass: float, kind: Kind, seals: float) -> None:
    frf = predict_frf(seals * BROAD, mass=mass, frequency=LINES, kind=kind)
    result = dynamic_stiffness(frf, mass, seals=seals)
    expected = BROAD.complex_stiffness(omega=2 * np.pi * LINES)
    assert result.storage + 1j * result.loss == pytest.approx(expected, rel=1e-10)


def test_dynamic_stiffness_error_of_a_per_cent_of_mass() -> None:
    """0.155, 1.00 and 15.5 % of the stiffness at 5, 12.71 and 50 Hz."""
    result = dynamic_stiffness(predict_frf(PAPER, mass=MASS, frequency=LINES), MASS)
    bars = result.storage_mass / result.storage
    assert select_values(bars, 5, 12.71, 50) == pytest.approx([0.00155, 0.0100, 0.155], rel=5e-3)
    # the bar is what a wrong mass does
    wrong = dynamic_stiffness(predict_frf(PAPER, mass=MASS, frequency=LINES), 1.01 * MASS)
    assert wrong.storage - result.storage == pytest.approx(result.storage_mass, rel=1e-6)


def test_dynamic_stiffness_error_of_a_degree_of_phase() -> None:
    """Vibration reference 4b, loss factor 0.056: 26 % at 5 Hz, 1.5 % near 12.7, 48 % at 20 Hz."""
    solid = PAPER + GeneralizedMaxwell(0.0, (0.1 * PAPER.k_0,), (0.0125,))
    frf = predict_frf(solid, mass=0.0547, frequency=LINES)
    result = dynamic_stiffness(frf, 0.0547)
    bars = result.loss_phase / result.loss
    assert select_values(bars, 5, 20) == pytest.approx([0.26, 0.48], rel=0.1)
    assert select_values(bars, 12.71)[0] < 0.03
    turned = replace(frf, value=frf.value * np.exp(-1j * np.pi / 180))
    off = dynamic_stiffness(turned, 0.0547).loss - result.loss
    assert select_values(np.abs(off), 5, 20, 30) == pytest.approx(
        select_values(result.loss_phase, 5, 20, 30), rel=0.05
    )


def test_the_band_is_narrower_for_damping(broad_frf: FRF) -> None:
    result = dynamic_stiffness(broad_frf, BROAD_MASS, seals=2)
    assert result.storage_band[0] < result.loss_band[0] < 12.71
    assert 12.71 < result.loss_band[1] < result.storage_band[1]
    inside = (result.frequency > result.loss_band[0]) & (result.frequency < result.loss_band[1])
    truth = BROAD.complex_stiffness(omega=2 * np.pi * result.frequency)
    off = np.abs(result.loss - truth.imag)[inside]
    assert np.mean(off < 2 * result.loss_sd[inside]) > 0.9


def test_the_local_kramers_kronig_estimate_of_the_broad_seal() -> None:
    """Domain reference: 0.0551 against 0.0562 at 12.71 Hz."""
    f = np.geomspace(2, 80, 400)
    implied = causal_loss_factor(f, BROAD.storage(omega=2 * np.pi * f), 12.71)
    assert implied == pytest.approx(0.0551, rel=0.02)
    assert BROAD.loss_factor(omega=2 * np.pi * 12.71) == pytest.approx(0.0562, rel=1e-3)


def test_a_phase_that_cannot_be_is_noticed() -> None:
    frf = predict_frf(2 * BROAD, mass=BROAD_MASS, frequency=np.arange(3, 50, 0.1))
    good = dynamic_stiffness(frf, BROAD_MASS, seals=2).checks[0]
    assert good.passed
    # a wrong mass tilts the stiffness, and the tilt belongs to no damping
    bad = dynamic_stiffness(frf, 1.1 * BROAD_MASS, seals=2).checks[0]
    assert bad.failed
    assert "Mass, gain or phase" in bad.message


def test_scatter_goes_into_the_bars() -> None:
    frf = predict_frf(PAPER, mass=MASS, frequency=LINES)
    frf = replace(frf, sd=0.02 * np.abs(frf.value))
    result = dynamic_stiffness(frf, MASS, mass_sd=0.0, phase_sd=0.0)
    expected = 0.02 * np.abs(result.storage + 1j * result.loss - MASS * (2 * np.pi * LINES) ** 2)
    assert result.storage_sd == pytest.approx(expected)
    assert result.loss_sd == pytest.approx(expected)
    assert (result.loss_factor_sd > 0).all()


def test_a_mass_that_cannot_be_is_refused() -> None:
    with pytest.raises(DataError, match=r"mass = -1\.0"):
        dynamic_stiffness(predict_frf(PAPER, mass=MASS, frequency=LINES), -1.0)
