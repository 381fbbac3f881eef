"""Solver inputs drawn from the uncertainty of a fit."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from kit.shell import ran, run_json
from kit.solvers import needs_ccx, receptance, run_ccx
from scipy.stats import chi2

import dashpot as dp
from dashpot.base.errors import DataError
from dashpot.datamodel.fit import Fit
from dashpot.extensions.solver_inputs.draws.drawn_solids import (
    choose_unresolved_times,
    compute_deviance_quantile,
    draw_solids,
)
from dashpot.extensions.solver_inputs.draws.stratified_sampling import (
    draw_standard_normal,
    truncated_normal,
)
from dashpot.fitting.input_tests import ramp_holds
from dashpot.solids.demo_seals import PAPER
from dashpot.solids.maxwell import GeneralizedMaxwell

MASS, SEALS = 0.1040426, 2
TABLE_1 = GeneralizedMaxwell(196.5, (117.5, 17.8), (0.50213, 16.416))
RELATIVE_SD = (0.006, 0.01, 0.05, 0.01, 0.05)  # k_inf, k_1, k_2, tau_1, tau_2


def find_pole(solid: GeneralizedMaxwell) -> complex:
    """The ringing pole of the mass on the seals, by the eigenvalues of its first-order system."""
    n = solid.arms
    k, tau = SEALS * np.array(solid.k), np.array(solid.tau)
    A = np.zeros((n + 2, n + 2))
    A[0, 1] = 1.0
    A[1, 0], A[1, 2:] = -(SEALS * solid.k_inf + k.sum()) / MASS, k / MASS
    A[2:, 0], A[2:, 2:] = 1 / tau, -np.diag(1 / tau)  # elongation of each dashpot
    poles = np.linalg.eigvals(A)
    return max(poles, key=lambda pole: pole.imag)


@pytest.fixture(scope="module")
def table_1_fit() -> Fit:
    fit = dp.fit(dp.simulate("relaxation", noise_free=True), arms=2)
    size = np.array([196.5, 117.5, 17.8, 1.0, 1.0])
    covariance = np.diag((np.array(RELATIVE_SD) * size) ** 2)
    estimate = replace(fit.estimate, covariance=covariance, noise_covariance=None, profiles=())
    return replace(fit, solid=TABLE_1, estimate=estimate)


def test_few_draws_lie_one_in_each_stratum():
    normal = draw_standard_normal(5, 6, seed=3)
    edges = [-np.inf, -0.841621, -0.253347, 0.253347, 0.841621, np.inf]
    for column in normal.T:
        assert np.histogram(column, edges)[0].tolist() == [1] * 5


def test_draws_have_no_mean_and_unit_covariance():
    normal = draw_standard_normal(20, 7, seed=1)
    assert normal.mean(axis=0) == pytest.approx(np.zeros(7), abs=1e-12)
    assert np.cov(normal.T) == pytest.approx(np.eye(7), abs=1e-12)


def test_truncated_normal_has_its_quantiles():
    shares = np.random.default_rng(1).random(200_000)
    for mean, sd in ((1.0, 1.0), (-1.0, 0.5), (-30.0, 1.0)):
        result = np.array([truncated_normal(share, mean, sd) for share in shares[:5000]])
        assert (result >= 0).all()
        if mean > -10:
            sample = np.random.default_rng(2).normal(mean, sd, 400_000)
            sample = sample[sample >= 0]
            assert np.median(result) == pytest.approx(np.median(sample), rel=0.05)
    assert np.mean(result) == pytest.approx(1 / 30, rel=0.05)  # exponential, so far out


def test_spread_of_peak_and_damping_is_that_of_the_covariance(table_1_fit):
    """To first order .002845 and .012784; plain draws of 20 scatter by 16 % about it."""
    spreads = []
    for seed in range(20):
        poles = [find_pole(draw.solid) for draw in draw_solids(table_1_fit, 20, seed=seed)]
        logs = np.log([(abs(pole), -pole.real / abs(pole)) for pole in poles])
        spreads.append(logs.std(axis=0, ddof=1))
    mean, scatter = np.mean(spreads, axis=0), np.std(spreads, axis=0)
    print(
        f"SD of ln f {mean[0]:.6f} ({scatter[0]:.6f}), of ln zeta {mean[1]:.6f} ({scatter[1]:.6f})"
    )
    assert mean == pytest.approx([0.002845, 0.012784], rel=0.005)
    assert (scatter < [0.00002, 0.0003]).all()


def test_a_seed_gives_the_same_draws(table_1_fit):
    first, again, other = (draw_solids(table_1_fit, 20, seed=seed) for seed in (1, 1, 2))
    assert first == again
    assert first != other


def test_a_fit_without_covariance_is_refused(table_1_fit):
    estimate = replace(table_1_fit.estimate, parameters=(), covariance=np.zeros((0, 0)))
    with pytest.raises(DataError, match="no covariance"):
        draw_solids(replace(table_1_fit, estimate=estimate), 20, seed=1)


@pytest.fixture(scope="module")
def record():
    """The paper's seal with an arm of 12 ms, which the ramp of 1 s hides."""
    hidden = PAPER + GeneralizedMaxwell(0.0, (30.0,), (0.012,))
    (test,) = ramp_holds(dp.simulate("relaxation", seal=hidden, seed=3))
    return test


@pytest.fixture(scope="module")
def record_fit(record) -> Fit:
    return dp.fit(record)


def test_unresolved_arms_are_what_the_record_does_not_reject(record, record_fit):
    """Freed of offset, drift, delay and gain, the change of the force is within the noise."""
    peak = abs(find_pole(record_fit.model)) / (2 * np.pi)
    times = choose_unresolved_times(record_fit, peak)
    assert times is not None
    draws = draw_solids(record_fit, 20, seed=1, records=[record], times=times)
    limit = compute_deviance_quantile(len(record_fit.estimate.parameters) + 1)
    noise = record_fit.estimate.residual.rms
    t, x = record.time, record.displacement
    fitted = record_fit.model.force(t, x)
    free = np.column_stack([np.ones_like(t), t, np.gradient(fitted, t), fitted])
    fastest = min(record_fit.model.tau)
    for draw in draws:
        assert draw.deviance <= limit
        assert times[0] <= draw.arm.tau <= fastest
        change = draw.solid.force(t, x) - fitted
        residual = change - free @ np.linalg.lstsq(free, change, rcond=None)[0]
        assert np.sqrt(np.mean(residual**2)) < noise
    frequencies = [abs(find_pole(draw.solid)) / (2 * np.pi) for draw in draws]
    damping = [-find_pole(draw.solid).real / abs(find_pole(draw.solid)) for draw in draws]
    hidden = find_pole(PAPER + GeneralizedMaxwell(0.0, (30.0,), (0.012,)))
    assert min(frequencies) < abs(hidden) / (2 * np.pi) < max(frequencies)
    assert min(damping) < -hidden.real / abs(hidden) < max(damping)
    assert max(damping) > 5 * -find_pole(record_fit.model).real / abs(hidden)


@pytest.mark.slow
def test_draws_enclose_the_peak_of_seals_with_a_hidden_arm():
    """24 seals with an arm of 3 to 60 ms and 2 to 40 % of k_inf; all were enclosed."""
    generator, enclosed = np.random.default_rng(5), []
    for seed in range(24):
        tau = float(10 ** generator.uniform(-2.5, -1.2))
        hidden = PAPER + GeneralizedMaxwell(0.0, (196.5 * generator.uniform(0.02, 0.4),), (tau,))
        (test,) = ramp_holds(dp.simulate("relaxation", seal=hidden, seed=seed, hold="30s"))
        fit = dp.fit(test)
        times = choose_unresolved_times(fit, abs(find_pole(fit.model)) / (2 * np.pi))
        draws = draw_solids(fit, 20, seed=1, records=[test], times=times)
        poles = np.array([find_pole(draw.solid) for draw in draws])
        true = find_pole(hidden)
        for values, value in ((np.abs(poles), abs(true)), (-poles.real, -true.real)):
            enclosed.append(values.min() <= value <= values.max())
    assert np.mean(enclosed) > 0.95


def test_deviance_limit_is_that_of_chi_square():
    assert [compute_deviance_quantile(dof) for dof in (3, 6, 12)] == pytest.approx(
        chi2.ppf(0.99, [3, 6, 12]), rel=0.005
    )


def test_a_peak_in_the_valid_band_needs_no_unresolved_arm(record_fit):
    assert choose_unresolved_times(record_fit, record_fit.band[1] / 2) is None


# -- files -----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def folder(tmp_path_factory, record_fit) -> Path:
    path = tmp_path_factory.mktemp("draws")
    dp.save(record_fit, path / "fit.json")
    return path


TERMS = (
    "--unit-system", "mm-t-s", "--temperature", "23degC", "--length", "50mm",
    "--mass", "104.0426g", "--seals", 2, "--draws", 20,
)  # fmt: skip


def read_index(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize("target", ["nastran", "abaqus", "lsdyna", "opensees", "fmu"])
def test_one_file_of_each_draw_and_one_index(folder, target):
    file = folder / f"{target}.txt"
    document = run_json(
        "export", folder / "fit.json", "--to", target, *TERMS, "--seed", 1, "-o", file
    )
    assert document["schema"] == "dashpot/draws@1"
    rows = read_index(Path(document["index"]))
    assert [row["file"] for row in rows] == [
        Path(name).name for name in (document["file"], *document["files"])
    ]
    assert len(rows) == 21
    if target == "fmu":
        return
    for row in rows[1:]:
        text = (folder / row["file"]).read_text()
        assert f"draw {row['draw']} of 20 of fit" in text
        k_inf = 2 * float(row["k_inf [N/mm]"])  # of two seals
        assert f"k_inf = {k_inf:.6f}"[:14] in text
    logs = np.log([float(row["peak [Hz]"]) for row in rows[1:]])
    assert document["ln_peak_sd"] == pytest.approx(logs.std(ddof=1), rel=1e-6)


def test_the_same_seed_writes_the_same_bytes(folder):
    written = []
    for name in ("a", "b"):
        place = folder / name
        place.mkdir()
        run_json(
            "export", folder / "fit.json", "--to", "abaqus", *TERMS, "--seed", 5,
            "-o", place / "seal.inp",
        )  # fmt: skip
        written.append({file.name: file.read_bytes() for file in sorted(place.iterdir())})
    assert written[0] == written[1]
    assert len(written[0]) == 22


@needs_ccx
def test_draw_7_in_calculix_is_the_model(folder, tmp_path):
    document = run_json(
        "export", folder / "fit.json", "--to", "calculix", *TERMS, "--seed", 1, "--band", "1:30Hz",
        "-o", folder / "ccx.inp",
    )  # fmt: skip
    row = read_index(Path(document["index"]))[7]
    arms = sorted({name.partition(" ")[0][2:] for name in row if name.startswith("k_")} - {"inf"})
    solid = GeneralizedMaxwell(
        1e3 * float(row["k_inf [N/mm]"]),
        tuple(1e3 * float(row[f"k_{j} [N/mm]"]) for j in arms),
        tuple(float(row[f"tau_{j} [s]"]) for j in arms),
    )
    pole = find_pole(solid)
    assert float(row["peak [Hz]"]) == pytest.approx(abs(pole) / (2 * np.pi), rel=1e-8)
    assert float(row["damping_ratio [1]"]) == pytest.approx(-pole.real / abs(pole), rel=1e-6)
    f, u = receptance(run_ccx((folder / row["file"]).read_text(), tmp_path), node=2)
    s = 2j * np.pi * f
    tau, k = np.array(solid.tau)[:, None], np.array(solid.k)[:, None]
    K = solid.k_inf + (k * s * tau / (1 + s * tau)).sum(axis=0)
    exact = 1 / (SEALS * K + MASS * s**2)  # m/N
    error = np.abs(1e-3 * u / exact - 1).max()  # in mm/N
    print(f"largest relative error of the FRF {error:.1e}")
    assert error < 1e-5


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--draws", 20, "-o", "x.inp"), "--mass"),
        (("--draws", 20, "--mass", "104g"), "-o FILE"),
        (("--seed", 1, "-o", "x.inp"), "--draws 20"),
    ],
)
def test_export_draws_names_the_missing_option(folder, words, message, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    done = ran(
        "export", folder / "fit.json", "--to", "abaqus", *TERMS[:6],
        "--temperature", "23degC", "--length", "50mm", *words,
    )  # fmt: skip
    assert done.exit_code == 2
    assert message in done.output
