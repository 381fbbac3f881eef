"""Mounts that weigh something, against the rod that they are."""

import json

import numpy as np
import pytest
from kit.shell import run_json

import dashpot as dp
from dashpot.base.errors import DataError
from dashpot.reading.write import write_frf
from dashpot.solids.demo_seals import PAPER, PAPER_MASS
from dashpot.vibration.mass_on_seals import add_mount_mass, compute_coupled_mass, remove_mount_mass

pytestmark = pytest.mark.once

SOLID, MASS = 2 * PAPER, PAPER_MASS
HEAVY = 0.1 * MASS
AT = np.array([6.0, 12.71, 25.0, 40.0])


def rod(frequency, mass=MASS, mounts=HEAVY):
    r"""T = 1 / (cos q - (m w^2 / (K q)) sin q), q^2 = w^2 m_r / K: waves and all."""
    w = 2 * np.pi * np.asarray(frequency)
    K = SOLID.complex_stiffness(omega=w)
    q = np.sqrt(w**2 * mounts / K)
    return dp.FRF(
        frequency,
        1 / (np.cos(q) - mass * w**2 / (K * q) * np.sin(q)),
        "transmissibility",
        units="SI",
    )


def compute_error(frf, mass):
    """By how much the storage stiffness is off, per cent."""
    w = 2 * np.pi * frf.frequency
    K = mass * w**2 * frf.value / (frf.value - 1)
    return 100 * (K.real / SOLID.storage(omega=w) - 1)


def test_what_each_share_of_the_mounts_mass_leaves():
    """None; a third, which is worse than none above the resonance; a third and a sixth."""
    assert compute_error(rod(AT), MASS) == pytest.approx([-4.4, -3.2, 1.5, 12.5], abs=0.15)
    assert compute_error(rod(AT), MASS + HEAVY / 3) == pytest.approx(
        [-1.2, 0.0, 4.9, 16.2], abs=0.15
    )
    moving, coupled = MASS + HEAVY / 3, compute_coupled_mass(HEAVY / 2, 2)
    assert coupled == pytest.approx(HEAVY / 6)
    light = remove_mount_mass(rod(AT), mass=moving, coupled=coupled)
    assert compute_error(light, moving) == pytest.approx([-0.01, -0.02, 0.13, 1.6], abs=0.03)


def test_there_and_back():
    f = np.array([5.0, 12.71, 20.0])
    light = dp.systems.predict_frf(SOLID, mass=0.11, frequency=f, kind="transmissibility")
    heavy = add_mount_mass(light, mass=0.11, coupled=0.002)
    back = remove_mount_mass(heavy, mass=0.11, coupled=0.002)
    assert back.value == pytest.approx(light.value, rel=1e-12)
    w2 = (2 * np.pi * f) ** 2
    K = SOLID.complex_stiffness(omega=np.sqrt(w2))
    assert heavy.value == pytest.approx((K + 0.002 * w2) / (K - 0.11 * w2), rel=1e-12)
    with pytest.raises(DataError, match="expected a transmissibility"):
        add_mount_mass(light.to("accelerance", mass=0.11), mass=0.11, coupled=0.002)


def test_mass_of_seals_option_is_shared_by_fit_and_predict(tmp_path):
    """A shaker's file of heavy mounts, and what is predicted of it: one option for both."""
    fit, path = tmp_path / "fit.json", tmp_path / "base.csv"
    arms = [{"k": k, "tau": t} for k, t in zip(PAPER.k, PAPER.tau, strict=True)]
    model = {"k_inf": PAPER.k_inf, "arms": arms}
    fit.write_text(json.dumps({"schema": "dashpot/fit@2", "model": model}))
    write_frf(rod(np.arange(5.0, 25.0, 0.05)), path)
    mass = ["--mass", f"{1e3 * MASS}g", "--seals", "2"]
    seal = ["--seal-mass", f"{1e3 * HEAVY / 2}g"]

    peaks = [run_json("compare", fit, path, *mass, *more)["frac"] for more in ([], seal)]
    assert peaks[1] > 0.999 > peaks[0]
    direct = run_json("fit", path, *mass, *seal, "--arms", 1)["direct"]
    near = np.interp([8.0, 20.0], direct["frequency_hz"], direct["stiffness"])
    assert near == pytest.approx(PAPER.storage(omega=2 * np.pi * np.array([8.0, 20.0])), rel=2e-3)
    lines = ["--band", "5:25Hz", "--points", 401]
    base = run_json("predict", fit, *mass, *seal, "--base", *lines)
    size = np.hypot(base["real"], base["imag"])
    assert size[[0, 100, 400]] == pytest.approx(np.abs(rod([5.0, 10.0, 25.0]).value), rel=5e-3)
    isolated = np.abs(rod([base["isolation_hz"]]).value)
    assert isolated == pytest.approx([1.0], abs=5e-3)
    low, high = np.array(base["limits"]["parameter"])
    interpolated = np.interp(base["limits"]["frequency_hz"], base["frequency_hz"], size)
    assert (low <= interpolated * 1.02).all()
    assert (high >= interpolated * 0.98).all()
