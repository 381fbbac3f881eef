"""dashpot fit, stress over strain: files in, law, figure and card out."""

from __future__ import annotations

import json

import numpy as np
import pytest
from kit.kinds import save_table
from kit.rubber import FOAM, RELAXATION, RUBBER, simulate_loading_at_rate
from kit.shell import did

import dashpot as dp
from dashpot.extensions.materials.hyperelastic.fit_files import hyperelastic_files
from dashpot.reading.readers.inspect import inspect_file
from dashpot.workflow.example_files import EXAMPLES
from dashpot.workflow.json_archive import from_json, to_json

pytestmark = pytest.mark.once


X = np.linspace(1, 2, 50)


def law_of(*words):
    return json.loads(did("fit", *words, "--json").stdout)["law"]


def test_the_examples_end_to_end(tmp_path):
    for name in ("tension.csv", "biaxial.csv"):
        (tmp_path / name).write_text(EXAMPLES[name](), encoding="utf-8")
    law, figure, card = (tmp_path / name for name in ("law.json", "law.svg", "law.inp"))
    words = [tmp_path / "tension.csv", tmp_path / "biaxial.csv", "--test", "uniaxial", "--test",
             "biaxial"]  # fmt: skip
    result = did("fit", *words, "-o", law, "--plot", figure, "--stretches", "0.9:1.5")
    assert result.stdout.startswith("Use: ")
    assert "dashpot export" in result.stderr
    assert "planar" in figure.read_text("utf-8")
    outcome = from_json(law.read_text("utf-8"))
    assert isinstance(outcome, dp.HyperelasticFit)
    assert to_json(outcome) == law.read_text("utf-8").rstrip("\n")
    assert outcome["C10"].low < 0.15e6 < outcome["C10"].high
    assert outcome["C01"].low < 0.05e6 < outcome["C01"].high
    stated = ["--temperature", "23degC", "--bulk-modulus", "2000MPa", "--unit-system", "mm-t-s"]
    did("export", law, "--to", "calculix", *stated, "-o", card)
    assert "SIMULATED" in card.read_text()
    assert "*HYPERELASTIC, MOONEY-RIVLIN" in card.read_text()
    assert "--mass" in did("export", law, "--to", "abaqus", *stated, "--mass", "1g", code=2).output


@pytest.mark.parametrize(
    ("head", "columns"),
    [
        ("stretch,nominal stress [MPa]", lambda x, P: (x, P / 1e6)),
        ("Strain [%],Engineering stress [kPa]", lambda x, P: (100 * (x - 1), P / 1e3)),
        ("true strain [-],true stress [MPa]", lambda x, P: (np.log(x), P * x / 1e6)),
        ("Dehnung [mm/mm],Nennspannung Spannung [MPa]", lambda x, P: (x - 1, P / 1e6)),
    ],
)
def test_fit_accepts_stretch_or_strain_nominal_or_true(tmp_path, head, columns):
    file = save_table(tmp_path / "a.csv", head, *columns(X, RUBBER.nominal("uniaxial", X)))
    law = law_of(file, "--model", "mooney-rivlin")
    np.testing.assert_allclose(law["constants"], RUBBER.constants, rtol=1e-4)
    assert inspect_file(file).kind == "stress-strain"


def test_fit_of_a_compressed_foam_is_independent_of_signs(tmp_path):
    x = np.linspace(1, 0.4, 50)
    P = FOAM.nominal("uniaxial", x)
    for mode, strain, stress in (
        ("compression", 1 - x, -P), ("compression", x - 1, P), ("uniaxial", x - 1, P),
        ("uniaxial", x - 1, -P),
    ):  # fmt: skip
        file = save_table(tmp_path / "a.csv", "strain [%],stress [MPa]", 100 * strain, stress / 1e6)
        law = law_of(file, "--test", mode, "--poisson", 0)
        np.testing.assert_allclose(law["constants"], FOAM.constants, rtol=1e-5)
    file = save_table(tmp_path / "a.csv", "strain [%],stress [MPa]", 100 * (1 - x), P / 1e6)
    result = did("fit", file, "--test", "uniaxial", "--poisson", 0, code=2)
    assert "--test compression" in result.output


def test_pressure_over_volume(tmp_path):
    a = save_table(
        tmp_path / "a.csv", "stretch,stress [MPa]", X, RUBBER.nominal("uniaxial", X) / 1e6
    )
    J = np.linspace(1, 0.95, 30)
    for head, column in (("volume ratio", J), ("volumetric strain [%]", 100 * (1 - J))):
        file = save_table(tmp_path / "v.csv", f"{head},pressure [MPa]", column, 2000 * (1 - J))
        law = law_of(a, file, "--test", "uniaxial", "--test", "volumetric")
        assert law["bulk"] == pytest.approx(2e9, rel=1e-4)


def test_relaxation_test_unites_rates(tmp_path):
    relaxation = tmp_path / "memory.json"
    relaxation.write_text(
        json.dumps({"schema": "dashpot/fit@2", "model": {"k_inf": 1e6, "b": 0.0, "arms": [
            {"k": 1e6 * k, "tau": tau} for k, tau in zip(RELAXATION.k, RELAXATION.tau, strict=True)
        ]}, "unit": "Pa"})
    )  # fmt: skip
    files = []
    for rate in (0.01, 1.0):
        test = simulate_loading_at_rate(RUBBER, "equibiaxial", rate, rows=400)
        head, file = "time [s],stretch,nominal stress [MPa]", tmp_path / f"{rate}.csv"
        files.append(save_table(file, head, test.time, test.stretch, test.stress / 1e6))
    law = law_of(
        *files, "--test", "biaxial", "--relaxation", relaxation, "--model", "mooney-rivlin"
    )
    np.testing.assert_allclose(law["constants"], RUBBER.constants, rtol=5e-3)


@pytest.mark.parametrize(
    ("head", "scale", "message"),
    [
        ("stretch,stress", (1, 1), "has no unit"),
        ("strain,stress [MPa]", (1, 1), "'strain' (strain) has no unit"),
        (
            "strain [%],stress [MPa]",
            (0.001, 1),
            "The unit may be 1. Give 1 as the unit of the strain",
        ),
        ("strain [-],stress [MPa]", (100, 1), "in per cent"),
        ("stretch,stress [Pa]", (1, 1e-4), "The unit may be MPa."),
        ("stretch,extension [mm]", (1, 1), "looks like stress"),
        (
            "time [s],displacement [mm],force [N]",
            (1, 1),
            "looks like strain or stress",
        ),
    ],
)
def test_fit_reports_unreadable_stress_strain_files(tmp_path, head, scale, message):
    columns = [X * scale[0], np.linspace(0.001, 1, 50) * scale[1]]
    columns = [np.arange(50.0), *columns] if "time" in head else columns
    file = save_table(tmp_path / "a.csv", head, *columns)
    text = " ".join(did("fit", file, "--kind", "stress-strain", code=2).output.split())
    assert message in text


def test_fit_asks_for_a_file():
    assert "FILE..." in did("fit", code=2).output
    with pytest.raises(dp.DashpotError, match="no file"):
        hyperelastic_files({})


@pytest.mark.parametrize(("clocked", "says"), [(True, "at the rate of the tests, 0.05 1/s"),
                                               (False, "at an unknown rate")])  # fmt: skip
def test_fit_says_at_which_rate_the_law_holds(tmp_path, clocked: bool, says: str) -> None:
    strain = np.linspace(0, 0.5, 200)
    stress = 2 * 0.3 * (1 + strain - (1 + strain) ** -2)
    head = f"{'time [s],' * clocked}strain [1],stress [MPa]\n"
    columns = [*([strain / 0.05] if clocked else []), strain, stress]
    rows = "\n".join(",".join(f"{cell:.8g}" for cell in row) for row in zip(*columns, strict=True))
    (tmp_path / "a.csv").write_text(head + rows + "\n", "utf-8")
    result = did("fit", tmp_path / "a.csv", "--test", "uniaxial")
    assert f", {says}\n" in result.stdout
