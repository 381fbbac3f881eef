"""The virtual rig and hammer in the cold and in the heat."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from kit.shell import ran

from dashpot.base.errors import DataError
from dashpot.reading.readers.impact import read_impact
from dashpot.reading.readers.relaxation import read_relaxation
from dashpot.simulation import (
    Climate,
    Hammer,
    Rig,
    simulate_impact,
    simulate_relaxation,
    truth_json,
)
from dashpot.solids.demo_seals import BROAD, BROAD_MASS, HIDDEN, HIDDEN_MASS, SHIFT
from dashpot.solids.shift_laws import WLF, Arrhenius, FreeShifts, shift_to_temperature
from dashpot.vibration.mass_on_seals import accelerance, mass_for_peak

OMEGA = 2 * np.pi * 12.71
# computed apart: degC, K' N/mm and loss factor at 12.71 Hz, peak Hz and 1/kg of .114829829 kg on 2
BROAD_AT = (
    (-20, 0.334912, 9.1011e-5, 12.15551, 9.151e4),
    (0, 0.361079, 0.00801357, 12.62198, 1079.39),
    (23, 0.364878, 0.0561894, 12.71000, 155.227),
    (40, 0.359200, 0.0970919, 12.66032, 89.9371),
    (80, 0.267204, 0.158968, 10.86545, 61.4832),
)


@pytest.mark.parametrize(("celsius", "storage", "loss_factor", "peak", "height"), BROAD_AT)
def test_the_broad_seal_follows_temperature(celsius, storage, loss_factor, peak, height):
    model = Climate(celsius + 273.15).shift_seal(BROAD)
    assert 1e-3 * model.storage(omega=OMEGA) == pytest.approx(storage, rel=3e-6)
    assert model.loss_factor(omega=OMEGA) == pytest.approx(loss_factor, rel=6e-6)
    lines = peak + np.linspace(-2e-3, 2e-3, 4001)
    magnitude = np.abs(accelerance(2 * model, BROAD_MASS, 2j * np.pi * lines))
    assert lines[np.argmax(magnitude)] == pytest.approx(peak, abs=6e-6)
    assert magnitude.max() == pytest.approx(height, rel=6e-5)


def test_the_hidden_seal_is_the_papers_with_the_arm_it_supposes():
    assert HIDDEN.loss_factor(omega=OMEGA) == pytest.approx(0.0783383, rel=1e-5)
    assert mass_for_peak(2 * HIDDEN, 12.71) == pytest.approx(HIDDEN_MASS, rel=1e-8)


@pytest.mark.parametrize("law", [SHIFT, Arrhenius(60e3, 296.15)])
def test_cold_relaxation_equals_warm_relaxation_on_a_shifted_clock(law):
    """Relaxation at T is b_T times that at T_r, at a time shorter by a_T."""
    a, b = float(law.a_t(273.15)), 273.15 / 296.15
    t = np.geomspace(1e-3, 100, 30)
    np.testing.assert_allclose(
        shift_to_temperature(BROAD, 273.15, law).relaxation(a * t),
        b * BROAD.relaxation(t),
        rtol=1e-12,
    )


def test_a_record_is_of_the_seal_at_its_temperature():
    rig = replace(Rig().noise_free(), rate=100.0)
    made = simulate_relaxation(BROAD, hold_time=2.0, rig=rig, climate=Climate(273.15))
    shift = shift_to_temperature(BROAD, 273.15, SHIFT)
    assert made.truth.model == shift
    assert made.test.specimen.temperature == 273.15
    np.testing.assert_allclose(
        made.truth.force,
        shift.force(made.test.time, made.test.displacement),
        atol=2e-3 * made.truth.force.max(),
    )
    message = json.loads(truth_json(made.truth))["climate"]
    assert message == {
        "temperature": 273.15,
        "law": {"c1": SHIFT.c1, "c2": SHIFT.c2, "reference": 296.15},
    }


def test_a_block_rings_as_its_seals_do_at_their_temperature():
    rig = replace(Hammer(), record=1.0)
    made = simulate_impact(BROAD, mass=BROAD_MASS, hits=1, rig=rig, climate=Climate(273.15))
    same = simulate_impact(
        shift_to_temperature(BROAD, 273.15, SHIFT), mass=BROAD_MASS, hits=1, rig=rig
    )
    assert made.test == same.test
    assert made.truth.bounce_poles == same.truth.bounce_poles


def test_simulation_without_climate_states_no_temperature():
    made = simulate_relaxation(BROAD, hold_time=1.0)
    assert made.test.specimen.temperature is None
    assert made.truth.climate is None
    warm = simulate_relaxation(BROAD, hold_time=1.0, climate=Climate(296.15))
    np.testing.assert_array_equal(warm.test.force, made.test.force)


def test_a_law_that_does_not_reach_there_is_refused():
    with pytest.raises(DataError, match="diverges"):
        simulate_relaxation(BROAD, climate=Climate(SHIFT.reference - SHIFT.c2))
    with pytest.raises(DataError, match="outside the tested"):
        Climate(250.0, FreeShifts((273.15, 296.15), (1.5, 0.0), 296.15)).shift_seal(BROAD)


def test_the_file_states_the_temperature_and_reading_takes_it(tmp_path):
    path = tmp_path / "cold.csv"
    words = ("simulate", "relaxation", "--seal", "hidden", "--hold", "1s", "-o", path)
    assert ran(*words, "--temperature", "0degC", "--wlf", "8, 110K,20degC").exit_code == 0
    test = read_relaxation(path)
    assert test.specimen.temperature == 273.15
    assert test.source is not None
    assert "temperature 0 degC: the header says 'temperature: 0 degC'" in test.source.notes
    document = json.loads((tmp_path / "cold.truth.json").read_text())
    shift = shift_to_temperature(HIDDEN, 273.15, WLF(8.0, 110.0, 293.15))
    np.testing.assert_allclose(document["model"]["tau"], shift.tau)
    assert ran(*words[:-1], tmp_path / "warm.csv").exit_code == 0
    assert read_relaxation(tmp_path / "warm.csv").specimen.temperature is None


def test_a_hammer_file_states_it_too(tmp_path):
    path = tmp_path / "hits.csv"
    words = ("simulate", "impact", "--hits", "1", "--hit-length", "1s", "--temperature", "-20degC")
    assert ran(*words, "-o", path).exit_code == 0
    assert "# temperature: -20 degC" in path.read_text()
    assert len(read_impact(path).starts) == 1


@pytest.mark.parametrize(
    ("inputs", "message"),
    [
        (("--wlf", "8,110K"), "expected C1,C2,T_r"),
        (("--wlf", "8,110K,20"), "has no unit"),
        (("--wlf", "8,-110K,20degC"), "c2 = -110"),
        (("--wlf", "8,110K,20degC"), "add --temperature 0degC"),
        (("--temperature", "-80degC", "--wlf", "8,50K,0degC"), "diverges"),
    ],
)
def test_what_is_no_law_is_refused(tmp_path, inputs, message):
    ended = ran("simulate", "relaxation", *inputs, "-o", tmp_path / "a.csv")
    assert ended.exit_code == 2
    assert message in " ".join(ended.output.split())
