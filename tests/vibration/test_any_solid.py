"""Whatever has a complex stiffness and arms is predicted, shaken, compared: a fractional Zener."""

from __future__ import annotations

import numpy as np
import pytest

from dashpot.datamodel.frf import FRF
from dashpot.extensions.systems.multibody import Mount, System, point_mass
from dashpot.extensions.systems.time_response import complex_modes, newton_modes, respond
from dashpot.solids.fractional import FractionalZener
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid
from dashpot.vibration.comparison.compare import compare, infer_mass
from dashpot.vibration.mass_on_seals import accelerance, mass_for_peak, model_modes, predict_frf

MASS = 0.2
LINES = np.linspace(2.0, 60.0, 233)


SEAL = FractionalZener(900.0, 400.0, 0.01, 0.6)


def closed_form(frequency: np.ndarray, *, shift: float = 0.0, seals: int = 2) -> np.ndarray:
    s = 2j * np.pi * frequency + shift
    x = (0.01 * s) ** 0.6
    return s**2 / (MASS * s**2 + seals * (400.0 + 500.0 * x / (1 + x)))


@pytest.mark.parametrize("solid", [SEAL, GeneralizedMaxwell(100.0, (40.0,), (0.02,), 0.3)])
def test_the_slope_of_the_stiffness_is_its_derivative(solid: Solid) -> None:
    s = np.array([-3.0 + 80j, 0.5 + 10j, 200j])
    assert Solid.slope_at(solid, s) == pytest.approx(solid.slope_at(s), rel=1e-9)
    step = 1e-4 * np.abs(s)
    central = (solid.stiffness_at(s + step) - solid.stiffness_at(s - step)) / (2 * step)
    assert solid.slope_at(s) == pytest.approx(central, rel=1e-6)


@pytest.mark.parametrize("shift", [0.0, 2.3])
def test_it_is_predicted_in_closed_form(shift: float) -> None:
    frf = predict_frf(2 * SEAL, mass=MASS, frequency=LINES, shift=shift)
    np.testing.assert_allclose(frf.value, closed_form(LINES, shift=shift), rtol=1e-13)


def test_it_holds_a_system() -> None:
    system = System(
        (point_mass("block", MASS),), tuple(Mount(SEAL, ("block", "ground")) for _ in range(2))
    )
    frf = system.frf(response="block.z", force="block.z", frequency=LINES)
    np.testing.assert_allclose(frf.value, closed_form(LINES), rtol=1e-12)
    (mode,) = newton_modes(system)
    assert mode.converged
    residual = MASS * mode.pole**2 + 2 * SEAL.stiffness_at(mode.pole)
    assert abs(residual) < 1e-9 * 2 * SEAL.k_0
    (same,) = model_modes(2 * SEAL, MASS)
    assert mode.pole == pytest.approx(same.pole, rel=1e-9)
    ringing = [complex_mode for complex_mode in complex_modes(system) if complex_mode.oscillates]
    assert ringing[0].pole == pytest.approx(mode.pole, rel=1e-3)


def test_a_system_on_it_moves_as_on_its_arms() -> None:
    t = np.linspace(0.0, 0.3, 61)
    displacements = [
        respond(
            System((point_mass("block", MASS),), (Mount(solid, ("block", "ground")),)),
            t, force={"block.z": np.sin(40 * t)},
        ).displacement
        for solid in (SEAL, SEAL.maxwell)
    ]  # fmt: skip
    np.testing.assert_allclose(*displacements, rtol=1e-12)
    assert np.abs(displacements[0]).max() > 1e-4


def test_it_is_compared_as_its_test_saw_it() -> None:
    s = 2j * np.pi * LINES + 1.5
    measured = FRF(LINES, accelerance(2 * SEAL, MASS, s, 1.0), shift=1.5, record=1.0, units="SI")
    frf = predict_frf(2 * SEAL, mass=MASS, frequency=LINES)
    comparison = compare(frf, measured, model=SEAL, seals=2)
    assert comparison.frac == pytest.approx(1.0, abs=1e-12)
    assert abs(comparison.frequency_error) < 1e-9
    assert sum(arm.loss_share for arm in comparison.arms) == pytest.approx(1.0)


def test_arms_faster_than_the_pulse_leave_nothing_at_the_end_of_the_record() -> None:
    s = 2j * np.pi * LINES
    slow = FractionalZener(900.0, 400.0, 0.01, 0.45)
    result = accelerance(2 * slow, MASS, s, 8.0, pulse=0.01)
    assert slow.maxwell.tau[0] < 1e-9
    whole = accelerance(2 * slow, MASS, s)
    np.testing.assert_allclose(result, whole, rtol=1e-3)
    assert np.abs(result - whole).max() > 0


def test_a_flat_spectrum_of_a_hundred_decades_leaves_its_poles_their_digits() -> None:
    s = 2j * np.pi * LINES
    flat = FractionalZener(900.0, 400.0, 0.3, 0.08)
    assert flat.maxwell.tau[-1] / flat.maxwell.tau[0] > 1e80
    cut = accelerance(2 * flat, MASS, s, 2.0, pulse=0.01)
    # in the band of the lines few of its arms are more than springs and dashpots
    few = flat.arms(1e-7, (1e-2, 1e4))
    expected = accelerance(2 * few, MASS, s, 2.0, pulse=0.01)
    assert np.abs(cut - expected).max() < 1e-4 * np.abs(expected).max()
    assert np.abs(cut - accelerance(2 * flat, MASS, s)).max() > 0.5 * np.abs(expected).max()


def test_mass_for_peak_recovers_the_mass() -> None:
    fine = np.linspace(10.0, 30.0, 2001)
    frf = predict_frf(2 * SEAL, mass=MASS, frequency=fine)
    peak = fine[np.argmax(np.abs(frf.value))]
    assert mass_for_peak(2 * SEAL, peak) == pytest.approx(MASS, rel=1e-3)
    assert infer_mass(2 * SEAL, frf)[0] == pytest.approx(MASS, rel=1e-3)
