"""The Python and command-line contracts, as users type them."""

from __future__ import annotations

import json

import numpy as np
import pytest
from click.testing import CliRunner
from kit.shell import did

import dashpot as dp
from dashpot.cli import main
from dashpot.reading.write import write_impact, write_relaxation
from dashpot.simulation.impact import Hammer, simulate_impact
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.solids.demo_seals import BROAD, BROAD_MASS
from dashpot.workflow.json_archive import from_json, to_json

MASS = ["--mass", f"{BROAD_MASS} kg", "--seals", "2"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with both tests of the broad seal."""
    path = tmp_path_factory.mktemp("lab")
    bench = simulate_relaxation(BROAD, seed=3)
    hammer = simulate_impact(BROAD, mass=BROAD_MASS, hits=4, rig=Hammer(record=6.0), seed=3)
    (path / "seal_8mm.csv").write_text(write_relaxation(bench.test))
    (path / "impact.csv").write_text(write_impact(hammer.test))
    return path


def document(*words, code=0):
    return json.loads(did(*words, "--json", code=code).stdout)


def test_python_contract(folder, tmp_path, monkeypatch):
    """The page of the design on Python, as it is written there, in one script."""
    monkeypatch.chdir(folder)
    (folder / "hammer.csv").write_text((folder / "impact.csv").read_text())
    names = {"dp": dp, "tests": tmp_path / "tests", "lot_folder": tmp_path / "lot"}
    names["tests"].mkdir()
    (names["tests"] / "seal_8mm.csv").write_text((folder / "seal_8mm.csv").read_text())
    cold, at_rest = dp.read("seal_8mm.csv"), dp.read("seal_8mm.csv")
    names["cold"] = dp.simulate("relaxation", seal="broad", temperature="-20degC", seed=4)
    names["at_rest"] = dp.simulate("relaxation", seal="broad", temperature="23degC", seed=5)
    assert cold == at_rest
    t, x, f = cold.time, 1e3 * cold.displacement, cold.force
    exec(SCRIPT, names | {"t": t, "x": x, "f": f, "found": names})  # noqa: S102
    test, fit, joint, modes, lot = (
        names[item] for item in ("test", "fit", "joint", "modes", "lot")
    )
    np.testing.assert_allclose(test.displacement, cold.displacement, rtol=1e-15)
    assert fit.model.arms == 2
    assert names["intervals"]["k_inf"][0] < fit.model.k_inf < names["intervals"]["k_inf"][1]
    assert names["loss_factor"] == fit.model.loss_factor(omega=2 * np.pi * 12.71)
    assert modes[0].frequency == pytest.approx(12.70, abs=0.05)
    assert modes[0].damping_ratio == pytest.approx(0.02856, rel=0.05)
    assert joint.method == "joint"
    assert "damping ratio" in names["printed"]
    assert "PBUSHT" in (folder / "seal.bdf").read_text()
    assert "<svg" in (folder / "report.html").read_text(encoding="utf-8")
    assert names["warm"].tau[0] > names["shared"].model.tau[0]
    assert lot.table.height == 1


SCRIPT = """
test, hits = dp.read("seal_8mm.csv"), dp.read("hammer.csv")
test = dp.RelaxationTest(time=t, displacement=x, force=f, units="s, mm, N")
fit = dp.fit(test, arms=2)
intervals = fit.intervals(level=0.95)
assert fit.verdict and fit.stiffness_limits and fit.evidence.certificate and fit.elastic_law
assert fit.model_at(2.6e-3) == fit.model
loss_factor = fit.model.loss_factor(frequency="12.71Hz")
modes = dp.fit(hits)
joint = dp.fit(test, hits, mass="114.8g", seals=2)
pred = dp.predict(joint, mass="114.8g", seals=2, band=(1, 50))
printed = str(dp.compare(pred, hits.frf()))
piece = {"temperature": "23degC", "length": "50mm"}
dp.export(joint, "seal.bdf", to="nastran", unit_system="mm-t-s", **piece)
dp.report(test, hits, mass="114.8g", seals=2).save("report.html")
shared = dp.fit(cold, at_rest)
warm = shared.at(253.15)
lot = dp.batch(tests, to=lot_folder, jobs=2)
found.update(locals())
"""


def test_batch_accepts_arrays_on_a_common_clock(folder):
    test = dp.read(folder / "seal_8mm.csv").prepare()
    many = dp.batch(
        [test.force, 2 * test.force], time=test.time, displacement=1e3 * test.displacement,
        units="s, mm, N", arms=2,
    )  # fmt: skip
    assert len(many.k_inf) == 2
    assert many.k_inf[1] == pytest.approx(2 * many.k_inf[0], rel=1e-6)
    assert dp.fit(test, arms=2, method="hold").model.arms == 2


def test_exponential_sums():
    x = np.linspace(0, 3, 60)
    sums = dp.solids.exponential_sum(x, 2 * np.exp(-x) + 0.5 * np.exp(-5 * x), terms=2)
    assert sorted(sums.rates) == pytest.approx([1, 5], rel=1e-8)
    assert sorted(sums.amplitudes) == pytest.approx([0.5, 2], rel=1e-8)


def test_fit_json(folder, tmp_path):
    result = document("fit", folder / "seal_8mm.csv", "--arms", "2", "-o", tmp_path / "fit.json")
    assert result["schema"] == "dashpot/fit@2"
    assert result["status"] == "converged"
    assert result["ok"] is True
    assert set(result["model"]) >= {"k_inf", "b", "arms"}
    for arm in result["model"]["arms"]:
        assert arm["b"] == pytest.approx(arm["k"] * arm["tau"])
    assert [order["arms"] for order in result["orders"]]
    assert set(result["residual"]) >= {"n", "sse", "rms"}
    assert len(result["band_hz"]) == 2
    assert {"name", "passed", "value", "limit", "message"} <= set(result["checks"][0])
    assert result["source"][0]["file"] == "seal_8mm.csv"
    assert len(result["source"][0]["sha256"]) == 64
    assert json.loads((tmp_path / "fit.json").read_text()) == result


def test_impact_compare_identify_json(folder, tmp_path):
    did("fit", folder / "seal_8mm.csv", "--arms", "2", "-o", tmp_path / "fit.json")
    impact = document("fit", folder / "impact.csv", "-o", tmp_path / "frf.csv")
    mode = impact["modes"][0]
    assert {"frequency_hz", "damping_ratio", "frequency_se_hz", "damping_ratio_se"} <= set(mode)
    assert len(impact["hits"]) == 4
    assert {"accepted", "reasons"} <= set(impact["hits"][0])
    assert impact["file"] == str(tmp_path / "frf.csv")
    assert json.loads(to_json(from_json(json.dumps(impact)))) == impact
    for measured in (folder / "impact.csv", tmp_path / "frf.csv"):
        result = document("compare", tmp_path / "fit.json", measured, *MASS)
        assert {"predicted_hz", "measured_hz", "ratio_db"} <= set(result["peak"])
        assert result["peak"]["ratio_db"] > 3
        assert 0 < result["frac"] < 1
        assert {"tau", "loss_share", "seen_by_relaxation"} <= set(result["arms"][0])
    joint = document(
        "fit", folder / "impact.csv", folder / "seal_8mm.csv", *MASS,
        "-o", tmp_path / "joint.json",
    )  # fmt: skip
    assert joint["schema"] == "dashpot/fit@2"
    assert joint["mass"] == pytest.approx(BROAD_MASS, rel=0.02)
    assert joint["parameter_changes"]
    assert joint["nuisance"]
    agreement = document("compare", tmp_path / "joint.json", folder / "impact.csv", *MASS)
    assert abs(agreement["peak"]["difference_percent"]) < 0.2
    assert agreement["peak"]["ratio"] == pytest.approx(1, abs=0.05)


def test_predict_plan_inspect_export_json(folder, tmp_path):
    did("fit", folder / "seal_8mm.csv", "-o", tmp_path / "fit.json")
    predicted = document("predict", tmp_path / "fit.json", *MASS, "--band", "5:40Hz")
    assert predicted["frequency_hz"][0] == 5.0
    assert predicted["extrapolated"] is True
    assert predicted["compression"] == pytest.approx(2.865e-3, rel=0.02)
    pressed = document("predict", tmp_path / "fit.json", *MASS, "--compression", "5mm")
    assert pressed["compression"] == 5e-3
    # a straight law vibrates alike at any compression
    assert pressed["tangent"]["frequency"] == predicted["secant"]["frequency"]
    planned = document("plan", "--frequency", "12.71Hz", "--machine", "compliance=0mm/N")
    assert planned["expected"]["loss_factor_sd"] > 0.1
    assert 0 < planned["end"]["if_machine_named"] < planned["end"]["half_width"]
    message = document("inspect", folder / "seal_8mm.csv", folder / "impact.csv")
    assert json.loads(to_json(from_json(json.dumps(message)))) == message
    seen, hammer = message["files"]
    assert "preparation" not in hammer
    assert seen["kind"] == "relaxation"
    assert [column["role"] for column in seen["columns"]] == ["time", "displacement", "force"]
    assert seen["preparation"]["ramp_time"] == pytest.approx(1, abs=0.02)
    deck = document(
        "export", tmp_path / "fit.json", "--to", "nastran", "--unit-system", "mm-t-s",
        "--temperature", "23degC", "--length", "100mm", "--allow", "all",
        "-o", tmp_path / "seal.bdf",
    )  # fmt: skip
    assert deck["target"] == "nastran"
    assert "PBUSHT" in (tmp_path / "seal.bdf").read_text()


def test_the_main_job(folder, tmp_path):
    result = document(
        "report", folder / "seal_8mm.csv", folder / "impact.csv", *MASS,
        "-o", tmp_path / "report.html",
    )  # fmt: skip
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert result["schema"] == "dashpot/study@2"
    assert result["fit"]["schema"] == "dashpot/fit@2"
    assert "<svg" in page
    assert "seal_8mm.csv" in page


def test_simulated_files_are_stamped(tmp_path):
    did("simulate", "relaxation", "--hold", "5s", "-o", tmp_path / "s.csv")
    assert "simulated" in (tmp_path / "s.csv").read_text()[:200]
    truth = json.loads((tmp_path / "s.truth.json").read_text())
    assert truth["simulated"] is True
    (seen,) = document("inspect", tmp_path / "s.csv")["files"]
    assert seen["simulated"] is True


def test_pipes(folder):
    fit = did("fit", folder / "seal_8mm.csv", "-o", "-").stdout
    result = CliRunner().invoke(main, ["predict", "-", *MASS, "--json"], input=fit)
    assert result.exit_code == 0, result.output
    assert json.loads(result.stdout)["schema"] == "dashpot/prediction@2"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("fit", "nowhere.csv"), "nowhere.csv"),
        (("fit",), "FILE"),
        (("fit", "{seal}", "--arms", "many"), "'many' is not a number of arms"),
        (("fit", "{seal}", "--column", "force=Load"), "Load"),
        (("fit", "{seal}", "--units", "force"), "role=unit"),
        (("fit", "{seal}", "--length", "100"), "has no unit"),
        (("predict", "{seal}", "--mass", "104g"), "expected a fit"),
        (("predict", "{fit}", "--mass", "104"), "has no unit"),
        (("predict", "{fit}", "--mass", "104mm"), "is a unit of length"),
        (("predict", "{fit}", "--mass", "-104g"), "mass"),
        (("predict", "{fit}", "--mass", "104g", "--band", "50:1Hz"), "50 is not below 1"),
        (("fit", "{seal}", "--kind", "impact"), "acceleration"),
        (("report", "{fit}", "-o", "x.html"), "is a fit"),
        (("export", "{fit}", "--to", "nastran"), "unit"),
        (("export", "{fit}", "--to", "nastran", "--unit-system", "mm-t-s"), "--temperature"),
        (("export", "{fit}", "--to", "adams", "--unit-system", "SI", "--mass", "1kg"), "no --mass"),
        (("verify", "{folder}"), "is not a project"),
        (("plan", "--frequency", "12.71"), "has no unit"),
        (("plan", "--frequency", "12Hz", "--arm-time", "1ms"), "--arm-stiffness"),
        (("simulate", "impact", "--seal", "{fit}", "-o", "x.csv"), "--mass"),
    ],
)
def test_the_first_wrong_thing_a_user_does(folder, tmp_path, monkeypatch, words, message):
    monkeypatch.chdir(tmp_path)
    fit = folder / "fit.json"
    if not fit.exists():
        did("fit", folder / "seal_8mm.csv", "-o", fit)
    places = {"seal": folder / "seal_8mm.csv", "fit": fit, "folder": tmp_path}
    result = did(*(word.format(**places) for word in words), code=2)
    assert message in result.stderr
    assert "Traceback" not in result.output
    assert result.stdout == ""


def test_strict_turns_a_failed_check_into_exit_code_1(folder):
    did("fit", folder / "seal_8mm.csv", "--arms", "3", "--strict", code=0)
    did("fit", folder / "seal_8mm.csv", "--arms", "0", code=0)
    did("fit", folder / "seal_8mm.csv", "--arms", "0", "--strict", code=1)


def test_bench_and_hammer_have_separate_profiles(folder, tmp_path):
    """Hammer columns whose names say nothing are named in a profile of their own."""
    head = "time [s],ch1,ch2 [m/s^2],ch3 [m/s^2]"
    plain = (folder / "impact.csv").read_text().splitlines()
    lines = [head if line.startswith("time") else line for line in plain]
    (tmp_path / "raw.csv").write_text("\n".join(lines) + "\n")
    did("inspect", tmp_path / "raw.csv", "--column", "force=ch1", "--units", "force=N",
        "--save", tmp_path / "hammer.toml")  # fmt: skip
    result = document(
        "fit", folder / "seal_8mm.csv", tmp_path / "raw.csv", *MASS,
        "--profile", f"raw.csv:{tmp_path / 'hammer.toml'}",
    )  # fmt: skip
    assert result["mass"] == pytest.approx(BROAD_MASS, rel=0.02)
