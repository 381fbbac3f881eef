"""The paper made again, against numbers that were computed apart from dashpot."""

from __future__ import annotations

import json

import numpy as np
import pytest
from kit.shell import ran

from dashpot.datamodel.fit import list_model_values
from dashpot.extensions.paper import reproduction as paper
from dashpot.fitting.relaxation import fit
from dashpot.preprocessing.prepare import prepare
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.solids.demo_seals import PAPER, PAPER_MASS

FORCE = {
    0.25: 0.6134406444, 0.5: 1.1537501838, 1: 2.1177275486, 1.5: 1.8565813339, 2: 1.7576141119,
    5: 1.6804156855, 10: 1.6518445396, 20: 1.6154195415, 41: 1.5840811795,
}  # fmt: skip
"""Eq. (1), N, at seconds after contact."""
Z = {
    0.25: 0.0766800806, 0.5: 0.1442187730, 1: 0.2647159436, 2: 0.4844177076, 10: 2.1573013305,
    41: 8.3836572350,
}  # fmt: skip
"""Eq. (2), N s/mm."""
ACCELERANCE = {
    1: 0.0615262025, 5: 1.76188908, 10: 15.6207276, 12: 78.7005353, 12.71: 1083.78976,
    13: 213.629576, 15: 34.0688897, 20: 16.1228357, 30: 11.7141976, 50: 10.2754833,
}  # fmt: skip
"""Eq. (7), 1/kg, at Hz."""


@pytest.fixture(scope="module")
def reproduction(tmp_path_factory):
    folder = tmp_path_factory.mktemp("paper")
    done = ran("demo", "--paper", "-o", folder, "--json")
    assert done.exit_code == 0, done.output
    return folder, json.loads(done.stdout)


def test_the_equations_as_printed():
    for at, force in FORCE.items():
        assert paper.PRINTED.eq_1(np.array([at]), speed=8e-3, c=1.0) == pytest.approx(force, 1e-10)
        assert paper.PRINTED.hereditary(at, speed=8e-3, c=1.0) == pytest.approx(force, 1e-10)
    for at, value in Z.items():
        assert 1e-3 * paper.PRINTED.z(np.array([at])) == pytest.approx(value, 1e-9)
    two = paper.PRINTED.times(2)
    for hz, value in ACCELERANCE.items():
        eq_7 = two.eq_7(2 * np.pi * np.array([hz]), mass=PAPER_MASS)
        assert eq_7 == pytest.approx(value, 1e-8)
    poles = sorted(two.poles(mass=PAPER_MASS), key=lambda values: (values.imag, values.real))
    expected = [-0.35417134 - 79.85692568j, -1.28832382, -0.05577611, -0.35417134 + 79.85692568j]
    assert poles == pytest.approx(expected, abs=2e-8)


def test_paper_table_1_needs_two_arms():
    ideal = paper.make_ideal_test()
    hold_fit, two = paper.fit_hold_phase(ideal, 1), paper.fit_hold_phase(ideal, 2)
    assert (hold_fit.solid.k_inf, *hold_fit.solid.k) == pytest.approx((200.42346, 34.60362), 1e-5)
    assert (*hold_fit.solid.tau, *hold_fit.solid.arm_b) == pytest.approx(
        (4.14149995, 143.3109), 1e-5
    )
    assert (hold_fit.rms, hold_fit.worst) == pytest.approx((24.142970e-3, 267.637e-3), 1e-6)
    result = (two.solid.k_inf, *two.solid.k, *two.solid.arm_b)
    assert result == pytest.approx((196.5, 117.5, 17.8, 59.0, 292.2), 1e-8)
    assert two.rms < 1e-12


def test_the_steps_of_the_load_cell():
    hold_fit = paper.fit_hold_phase(paper.quantise_force(paper.make_ideal_test()), 2)
    solid = hold_fit.solid
    assert (solid.k_inf, *solid.k) == pytest.approx((196.50071, 117.48881, 17.79929), 1e-6)
    assert solid.tau == pytest.approx((0.50215901, 16.41449176), 1e-6)
    assert hold_fit.rms == pytest.approx(0.2250e-3, 2e-4)


def test_the_command_makes_every_figure_and_a_page(reproduction):
    folder, message = reproduction
    assert message["schema"] == "dashpot/paper@2"
    assert message["reproduced"] is True
    assert {path.name for path in folder.iterdir()} >= {
        "paper.csv", "paper_steps.csv", "paper_rig.csv", "figure_2.svg", "figure_4.svg",
        "figure_6.svg", "paper.json", "paper.html",
    }  # fmt: skip
    assert dict(map(tuple, message["force"])) == pytest.approx(FORCE, 1e-10)
    assert {hz: value for hz, value, _ in message["accelerance"]} == pytest.approx(
        ACCELERANCE, 1e-8
    )
    phases = {hz: phase for hz, _, phase in message["accelerance"]}
    assert (phases[1.0], phases[5.0], phases[12.71]) == pytest.approx(
        (173.914, 178.475, 89.237), abs=1e-3
    )
    assert message["peak"] == pytest.approx((12.70999929, 1083.78976), 1e-7)
    assert message["receptance_peak"] == pytest.approx((12.70949937, 0.16994615), 1e-7)
    assert message["mode"] == pytest.approx((12.709749, 0.00443503), 1e-6)


def test_paper_reproduction_lists_every_statement_with_its_value(reproduction):
    folder, message = reproduction
    rows = message["rows"]
    assert {row["name"] for row in rows if row["part"] == "equation"} == {
        "eq. (1)", "eq. (2)", "eq. (3)", "eqs. (4), (5)", "eq. (6)", "eq. (7)",
    }  # fmt: skip
    assert all(row["within_interval"] for row in rows if row["tolerance"] is not None)
    text = " ".join(row["reproduced"] for row in rows if row["part"] == "misprint")
    # every b_j times a half, one, two, five; lines .1, .25, .5 and 1 Hz apart
    for number in ("542.5", "1083.8", "2167.0", "5417.0", "1067", "885.3", "274.5", "213.6"):
        assert number in text
    assert "8.98687 Hz" in text
    assert "1.41 ms" in text
    page = (folder / "paper.html").read_text()
    assert all(f'id="{item}"' in page for item in ("test", "fit", "frf", "table_1", "misprint"))
    assert "SIMULATED" in page


def test_paper_statement_reports_a_deviation():
    row = paper.Statement("figure", "Fig. 6", "12.71 Hz", "13 Hz", difference=0.29, tolerance=5e-3)
    assert row.within_interval is False
    just = paper.Statement(
        "figure", "Fig. 6", "12.71 Hz", "12.715 Hz", difference=5e-3, tolerance=5e-3
    )
    assert just.within_interval is True
    assert paper.Statement("unsaid", "m", "not given", "104 g").within_interval is None


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--paper", "--files"), "leave out --files"),
        (("--paper", "--all"), "--all"),
    ],
)
def test_what_does_not_go_with_the_paper(words, message, tmp_path):
    done = ran("demo", *words, "-o", tmp_path)
    assert done.exit_code == 2
    assert message in done.stderr
    assert not list(tmp_path.iterdir())


def test_a_file_of_somebody_else_is_not_replaced(tmp_path):
    (tmp_path / "paper.csv").write_text("mine")
    done = ran("demo", "--paper", "-o", tmp_path)
    assert done.exit_code == 2
    assert "paper.csv" in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["paper.csv"]
    assert (tmp_path / "paper.csv").read_text() == "mine"


@pytest.mark.slow
@pytest.mark.parametrize("method", ["full", "hold"])
def test_intervals_hold_table_1_on_the_virtual_rig(method):
    printed = {"k_inf": 196.5, "k_1": 117.5, "k_2": 17.8, "b_1": 59.0, "b_2": 292.2}
    held = dict.fromkeys(printed, 0)
    for seed in range(100):
        test = prepare(simulate_relaxation(PAPER, seed=seed).test)
        expected = {
            value.name: value for value in list_model_values(fit(test, arms=2, method=method))
        }
        for name, value in printed.items():
            held[name] += paper.is_within_interval(expected[name], value)
    assert min(held.values()) >= 90, held
