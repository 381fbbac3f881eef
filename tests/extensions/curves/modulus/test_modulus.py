"""A relaxation modulus over time: from a file, from the shell, to a solid."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from kit.shell import ran

from dashpot.base.errors import DataError, ReadError, Status
from dashpot.extensions.curves.datamodel.modulus import RelaxationModulus
from dashpot.extensions.curves.modulus.fit import fit_modulus
from dashpot.extensions.curves.modulus.read import read_modulus
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.inspect import inspect_file
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.workflow.json_archive import from_json

SOLID = GeneralizedMaxwell(1e6, (2e6, 1e6), (0.1, 20.0))
TIME = np.geomspace(1e-3, 1e3, 200)


def curve_file(path: Path, header: str = "time [s],E(t) [MPa]", scale: float = 1e-6) -> Path:
    rows = zip(TIME, scale * SOLID.relaxation(TIME), strict=True)
    path.write_text(header + "\n" + "".join(f"{t:.9g},{e:.9g}\n" for t, e in rows))
    return path


def test_a_curve_is_read_in_si_units(tmp_path: Path) -> None:
    curve = read_modulus(curve_file(tmp_path / "a.csv"))
    np.testing.assert_allclose(curve.time, TIME, rtol=1e-8)
    np.testing.assert_allclose(curve.modulus, SOLID.relaxation(TIME), rtol=1e-8)
    assert curve.unit == "Pa"
    assert curve.source is not None
    part = read_modulus(curve_file(tmp_path / "b.csv", "time [s],modulus [N/mm]", 1e-3))
    assert part.unit == "N/m"
    np.testing.assert_allclose(part.modulus, SOLID.relaxation(TIME), rtol=1e-8)


def test_read_modulus_asks_about_ambiguous_columns_and_units(tmp_path: Path) -> None:
    two = tmp_path / "two.csv"
    two.write_text("time [s],E(t) [MPa],G(t) [MPa]\n1,3,1\n2,2,0.7\n3,1.5,0.5\n")
    with pytest.raises(ReadError, match=r"could each be the modulus; say which.*--column modulus="):
        read_modulus(two)
    shear = read_modulus(two, options=ReadOptions(modulus="G(t)"))
    np.testing.assert_allclose(shear.modulus, [1e6, 0.7e6, 0.5e6])
    bare = tmp_path / "bare.csv"
    bare.write_text("time [s],E(t)\n1,3\n2,2\n3,1.5\n")
    with pytest.raises(ReadError, match=r"'E\(t\)' \(modulus\) has no unit; add --units"):
        read_modulus(bare)
    back = tmp_path / "back.csv"
    back.write_text("time [s],E(t) [MPa]\n1,3\n3,2\n2,1.5\n")
    with pytest.raises(ReadError, match="time must increase strictly"):
        read_modulus(back)
    gap = tmp_path / "gap.csv"
    gap.write_text("time [s],E(t) [MPa]\n1,3\n2,\n3,1.5\n4,1.2\n")
    modulus = read_modulus(gap)
    assert modulus.source is not None
    assert len(modulus.time) == 3
    assert any("1 rows lack a number" in note for note in modulus.source.notes)


def test_a_curve_is_what_it_says() -> None:
    with pytest.raises(DataError, match="since the step, >= 0"):
        RelaxationModulus(np.array([-1.0, 1.0]), np.array([1.0, 1.0]), units="SI")
    with pytest.raises(DataError, match="expected 'Pa' or 'N/m'"):
        RelaxationModulus(TIME, SOLID.relaxation(TIME), "MPa", units="SI")
    with pytest.raises(DataError, match="one value per sample"):
        RelaxationModulus(TIME, SOLID.relaxation(TIME)[1:], units="SI")


def shell(*words: object, expect: int = 0) -> str:
    result = ran(*words)
    assert result.exit_code == expect, result.output
    return result.stdout if expect == 0 else result.stderr


def test_the_shell_fits_the_column_that_is_named(tmp_path: Path) -> None:
    file = curve_file(tmp_path / "a.csv")
    fit, picture = tmp_path / "fit.json", tmp_path / "fit.png"
    process = shell("fit", file, "--column", "modulus=E(t)", "-o", fit, "--plot", picture)
    assert "2 Maxwell arms, method modulus" in process
    assert "MPa" in process
    assert picture.stat().st_size > 10_000
    content = json.loads(fit.read_text())
    assert [arm["tau"] for arm in content["model"]["arms"]] == pytest.approx([0.1, 20.0], rel=1e-5)
    assert content["model"]["k_inf"] == pytest.approx(1e6, rel=1e-5)
    assert from_json(fit.read_text()).unit == "Pa"
    card = shell(
        "export", fit, "--to", "abaqus", "--form", "prony", "--unit-system", "mm-t-s",
        "--temperature", "23degC",
    )  # fmt: skip
    assert "*VISCOELASTIC" in card.upper()


def test_the_shell_says_how_a_curve_is_fitted_and_with_what_it_is_not(tmp_path: Path) -> None:
    file = curve_file(tmp_path / "a.csv")
    assert inspect_file(file).kind == "modulus"
    assert "method modulus" in shell("fit", file)
    for more in (["--method", "hold"], ["--elastic", "by-depth"], ["--filter", "lowpass:10Hz"]):
        refused = shell("fit", file, "--column", "modulus=E(t)", *more, expect=2)
        assert f"{more[0]} is for a relaxation test" in refused
    assert "says no temperature" in shell("fit", file, file, "--column", "modulus=E(t)", expect=2)
    assert "there is no such column" in shell("fit", file, "--column", "modulus=G", expect=2)


def test_a_profile_may_name_the_column(tmp_path: Path) -> None:
    file, profile = curve_file(tmp_path / "a.csv"), tmp_path / "lab.toml"
    profile.write_text('[columns]\nmodulus = "E(t)"\n')
    assert "2 Maxwell arms, method modulus" in shell("fit", file, "--profile", profile)


def test_fit_modulus_uses_a_dense_spectrum_for_a_broad_curve() -> None:
    many = GeneralizedMaxwell(1e6, (1e6,) * 20, tuple(10.0**n for n in range(-10, 10)))
    time = np.concatenate(([0.0], np.geomspace(1e-11, 1e10, 200)))
    fit = fit_modulus(time, many.relaxation(time))
    check = next(check for check in fit.checks if check.name == "few_arms_sufficient")
    assert check.failed
    assert fit.status is Status.NOT_IDENTIFIED
    assert fit.model.arms > 6
    np.testing.assert_allclose(fit.model.relaxation(time), many.relaxation(time), rtol=0.02)
    assert fit_modulus(time, many.relaxation(time), arms=3).model.arms == 3


def test_a_real_master_curve_is_followed(real_data: Path) -> None:
    file = real_data / "pyvisco-master-curves" / "time_user_master.csv"
    curve = read_modulus(file)
    fit = fit_modulus(curve.time, curve.modulus, source=curve.source)
    assert np.abs(fit.model.relaxation(curve.time) / curve.modulus - 1).max() < 0.005


def test_band_of_a_dense_spectrum_is_that_of_the_curve_and_holds_the_loss_factor():
    """A material of 600 arms over 32 decades, which no few arms follow."""
    tau = np.geomspace(1e-16, 1e16, 600)
    k = np.exp(-0.5 * (np.log10(tau) / 6.0) ** 2)
    k *= 990e6 / k.sum()
    time = np.geomspace(1e-13, 1e13, 400)
    modulus = 10e6 + np.exp(-time[:, None] / tau) @ k
    noise = 1 + 1e-3 * np.random.default_rng(5).standard_normal(len(time))
    fit = fit_modulus(time, modulus * noise)
    assert any(check.name == "few_arms_sufficient" and check.failed for check in fit.checks)
    low, high = fit.band
    assert high / low > 1e7
    error = fit.evidence.band_error
    x = 2 * np.pi * np.array(error.frequency)[:, None] * tau
    storage = 10e6 + (k * x**2 / (1 + x**2)).sum(axis=1)
    loss_factor = (k * x / (1 + x**2)).sum(axis=1) / storage
    fitted = fit.model.loss_factor(frequency=error.frequency)
    ratio = np.maximum(loss_factor / fitted, fitted / loss_factor) - 1
    assert (ratio <= np.array(error.loss_factor)).mean() > 0.9
    assert max(error.loss_factor) <= 0.3 + 1e-6


@pytest.mark.parametrize("factor", [1e-20, 1.0, 1e20])
def test_band_of_a_curve_scales_with_its_times(factor: float) -> None:
    """Nothing that a curve shows depends on whether its times are of a clock or of a reference."""
    time = np.geomspace(0.01, 1e4, 120)
    modulus = (1.0 + 2.0 * np.exp(-time / 0.5) + np.exp(-time / 300.0)) * 1e6
    noise = 1 + 1e-3 * np.random.default_rng(2).standard_normal(len(time))
    fit = fit_modulus(factor * time, modulus * noise)
    reference = fit_modulus(time, modulus * noise)
    np.testing.assert_allclose(np.array(fit.band) * factor, reference.band, rtol=0.05)
    assert max(fit.evidence.band_error.loss_factor) < 0.31
