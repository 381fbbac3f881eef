"""Every kind of test that reads a displacement doubts that of a crosshead over a stiff seal.

The generator imports nothing of dashpot: two arms, 2 N/mm, on a machine of 33 um/N.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import dashpot as dp
from dashpot.preprocessing.checks import MACHINE_NAME

K, ARMS, COMPLIANCE, STEP = 2000.0, ((800.0, 0.5), (600.0, 12.0)), 33e-6, 0.02


def compute_force(x: np.ndarray, step: float) -> np.ndarray:
    """Return the force of the seal, N, along a displacement that is straight between samples."""
    force, elongation = K * x, np.zeros(len(ARMS))
    k, tau = np.array(ARMS).T
    decay = np.exp(-step / tau)
    mean = (1 - decay) / (step / tau)
    for i in range(1, len(x)):
        elongation = decay * elongation + mean * (x[i] - x[i - 1])
        force[i] += k @ elongation
    return force


def compute_creep(load: np.ndarray, step: float) -> np.ndarray:
    """Return the displacement under a load, m."""
    x, elongation = np.zeros(len(load)), np.zeros(len(ARMS))
    k, tau = np.array(ARMS).T
    decay = np.exp(-step / tau)
    mean = (1 - decay) / (step / tau)
    for i in range(1, len(load)):
        selected = decay * elongation
        shifted = (load[i] - K * x[i - 1] - k @ selected) / (K + k @ mean)
        x[i], elongation = x[i - 1] + shifted, selected + mean * shifted
    return x


def make_record(kind: str) -> np.ndarray:
    """Return time, displacement of the seal and force, SI, shape (n, 3)."""
    if kind == "loops":
        step, time = 1e-3, np.arange(12000) * 1e-3
        x = np.repeat([0.1e-3, 0.3e-3, 1e-3], 4000) * np.sin(4 * np.pi * time)
        return np.column_stack((time, x, compute_force(x, step)))
    time = np.arange(0.0, 62.0, STEP)
    if kind == "creep":
        load = 10.0 * np.clip((time - 1.0) / 0.1, 0.0, 1.0)
        return np.column_stack((time, compute_creep(load, STEP), load))
    if kind == "cld":
        x = 5e-3 * np.abs((time / 10.0 + 1.0) % 2.0 - 1.0)
    else:
        x = 5e-3 * np.clip(time - 1.0, 0.0, 1.0)
    return np.column_stack((time, x, compute_force(x, STEP)))


@pytest.mark.parametrize("name", ["Crosshead", "Kolbenweg", "Displacement"])
@pytest.mark.parametrize("scale", [1.0, 0.02])
@pytest.mark.parametrize("kind", ["relaxation", "creep", "loops", "cld"])
def test_displacement_of_a_crosshead_is_doubted(
    kind: str, scale: float, name: str, tmp_path: Path
) -> None:
    """A seal of a fiftieth of the stiffness takes a fiftieth of the deflection: it is no doubt."""
    time, x, force = make_record(kind).T
    random, force = np.random.default_rng(3), scale * force
    x = x + COMPLIANCE * force + 1e-8 * random.standard_normal(len(x))
    force = force + 1e-3 * scale * random.standard_normal(len(x))
    np.savetxt(
        tmp_path / "record.csv",
        np.column_stack((time, 1e3 * x, force)),
        delimiter=",",
        header=f"time [s],{name} [mm],force [N]",
        comments="",
        fmt="%.7f",
    )
    result = dp.fit(dp.read(tmp_path / "record.csv"))
    doubts = {check.name for check in result.checks if check.failed}
    is_doubted = name != "Displacement" and scale == 1.0
    assert ("machine_deflection_small" in doubts) is is_doubted
    assert not (is_doubted and result.verdict.use == "use")


@pytest.mark.parametrize(
    ("title", "is_of_machine"),
    [
        ("Extension", True), ("Standardweg", True), ("Position", True), ("XHD", True),
        ("Przemieszczenie trawersy", True), ("Grip separation", True), ("Ram position", True),
        ("Extensometer extension", False), ("Weg", False), ("Displacement of the frame", False),
        ("LVDT", False),
    ],
)  # fmt: skip
def test_machine_name_matches_titles_of_test_machines(title: str, *, is_of_machine: bool) -> None:
    column = f"displacement: {title} [mm] (its unit mm fits)"
    assert bool(MACHINE_NAME.search(column)) == is_of_machine


@pytest.mark.parametrize(
    ("title", "is_doubted"),
    [
        ("Strain (crosshead)", True),
        ("Tensile strain (Displacement)", True),
        ("Nenndehnung Traversenweg", True),
        ("Strain grip to grip", True),
        ("Strain", False),
        ("Tensile strain (Strain 1)", False),
        ("Strain extensometer", False),
    ],
)
def test_strain_of_the_grips_is_doubted(title: str, *, is_doubted: bool, tmp_path: Path) -> None:
    """A Neo-Hooke rubber of 0.8 MPa in tension and planar tension, so that no mode is missing."""
    stretch = np.linspace(1.0, 2.2, 120)
    random, records = np.random.default_rng(3), []
    for mode, power in (("uniaxial", 2.0), ("planar", 3.0)):
        stress = 0.8 * (stretch - stretch**-power) * (1 + 2e-3 * random.standard_normal(120))
        np.savetxt(
            tmp_path / f"{mode}.csv",
            np.column_stack((100 * (stretch - 1), stress)),
            delimiter=",",
            header=f"{title} [%],nominal stress [MPa]",
            comments="",
            fmt="%.6f",
        )
        records.append(dp.read(tmp_path / f"{mode}.csv", test=mode))
    result = dp.fit(*records)
    failed = {check.name for check in result.checks if check.failed}
    assert ("strain_measured_on_specimen" in failed) == is_doubted
    assert (result.verdict.use == "use") == (not is_doubted)
