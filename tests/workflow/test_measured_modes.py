"""Modes of the FRF in a file: the truth within their errors, and what the lines do not carry."""

import json
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import dashpot as dp
from dashpot.cli import main
from dashpot.io.write import frf_uff, write_frf
from dashpot.records.frf import FRF
from dashpot.vibration.impact.checks import modes_within_band
from dashpot.workflow import modes_file

# undamped natural frequency, Hz, damping ratio, mass, kg: two bodies seen at one point
TRUE = ((12.7, 0.02, 0.1), (31.0, 0.04, 0.15))
F = np.arange(1.0, 80.0, 0.05)


def measured(noise=0.01, seed=0):
    """Accelerance of viscously damped modes with scatter, from its closed form alone."""
    s = 2j * np.pi * F
    value = np.zeros(len(F), dtype=complex)
    for frequency, ratio, mass in TRUE:
        w = 2 * np.pi * frequency
        value += s**2 / (mass * (s**2 + 2 * ratio * w * s + w**2))
    sd, rng = noise * np.abs(value), np.random.default_rng(seed)
    value = value + sd * (rng.normal(size=len(F)) + 1j * rng.normal(size=len(F)))
    return FRF(F, value, sd=sd, coherence=np.full(len(F), 0.99), averages=5)


def written(folder, frf, name="frf.csv"):
    path = folder / name
    path.write_bytes(frf_uff(frf) if name.endswith(".uff") else write_frf(frf).encode())
    return path


def asked(path, *words):
    result = CliRunner().invoke(main, ["modes", str(path), *words, "--json"])
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


@pytest.mark.parametrize("kind", ["accelerance", "mobility", "receptance", "dynamic_stiffness"])
def test_modes_of_a_file_of_any_kind_are_the_true_ones(tmp_path, kind):
    found = asked(written(tmp_path, measured().to(kind)), "--band", "5:50Hz")
    assert found["schema"] == "dashpot/modes@1"
    assert found["band"] == [5.0, 50.0]
    assert len(found["modes"]) == len(TRUE)
    modes = sorted(found["modes"], key=lambda mode: mode["frequency_hz"])
    for mode, (frequency, ratio, mass) in zip(modes, TRUE, strict=True):
        assert abs(mode["frequency_hz"] - frequency) < 4 * mode["frequency_se_hz"] < 0.02
        assert abs(mode["damping_ratio"] - ratio) < 4 * mode["damping_ratio_se"] < 0.002
        residue = complex(mode["residue_real"], mode["residue_imag"])
        damped = 2 * np.pi * frequency * np.sqrt(1 - ratio**2)
        assert abs(residue - 1 / (2j * mass * damped)) < 4 * mode["residue_se"]
        assert mode["modal_mass"] == pytest.approx(mass, rel=0.01)
    assert all(check["passed"] for check in found["checks"])


def test_the_errors_are_those_of_many_tests(tmp_path):
    draws = [modes_file(written(tmp_path, measured(seed=i)), band=(5, 50)).modes for i in range(12)]
    for pick in (0, 1):
        true = TRUE[pick]
        near = [next(m for m in d if abs(m.frequency_hz - true[0]) < 2) for d in draws]
        z = [(m.frequency_hz - true[0]) / m.frequency_se_hz for m in near]
        z += [(m.damping_ratio - true[1]) / m.damping_ratio_se for m in near]
        assert 0.6 < np.sqrt(np.mean(np.square(z))) < 1.5


def test_a_uff_and_a_csv_tell_the_same_modes(tmp_path):
    frf = replace(measured(), sd=None)
    one, other = (modes_file(written(tmp_path, frf, name)) for name in ("a.csv", "a.uff"))
    for mine, its in zip(one.modes, other.modes, strict=True):
        assert its.frequency_hz == pytest.approx(mine.frequency_hz, rel=1e-6)
        assert its.damping_ratio == pytest.approx(mine.damping_ratio, rel=1e-4)


def test_what_the_file_cannot_tell_is_said(tmp_path):
    bare = modes_file(written(tmp_path, replace(measured(), sd=None, coherence=None, averages=0)))
    assert "scatter_known" in {check.name for check in bare.frf.checks if check.failed}
    doubtful = replace(measured(), coherence=np.full(len(F), 0.89))
    failed = {c.name for c in modes_file(written(tmp_path, doubtful)).frf.checks if c.failed}
    assert failed == {"coherence"}
    other_sign = replace(measured(), value=measured().value.conj())
    failed = {c.name for c in modes_file(written(tmp_path, other_sign)).frf.checks if c.failed}
    assert "frf_dissipates" in failed or "resonance" in failed
    result = CliRunner().invoke(main, ["modes", str(written(tmp_path, other_sign))])
    assert result.output.startswith("do not use:")


def test_without_a_resonance_nothing_is_told(tmp_path):
    frf = measured(noise=0.02)
    found = asked(written(tmp_path, frf), "--band", "50:79Hz")
    assert found["modes"] == []
    assert [c["name"] for c in found["checks"] if c["passed"] is False] == ["resonance"]


def test_a_mode_beyond_the_lines_is_named():
    mode = dp.predict_frf(dp.GeneralizedMaxwell(400.0, (30.0,), (0.01,)), mass=0.1, frequency=F)
    (mode,) = mode.modes()
    assert modes_within_band((mode,), (mode.frequency, 40.0)).passed
    beyond = modes_within_band((mode,), (mode.frequency * 1.001, 40.0))
    assert beyond.failed
    assert f"{mode.frequency:.4g} Hz" in beyond.says
