"""Leak speed of a door's seal: numbers, states, limits that hold the truth, and refusals."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from kit import shell
from kit.fits import a_fit
from kit.foreign.aging import Rubber, lot
from kit.foreign.door_files import render_leaking_door

import dashpot as dp
from dashpot.base.errors import DataError, ReadError
from dashpot.datamodel.seal_line import SealSection
from dashpot.datamodel.shift_factors import Shift, TemperatureShifts
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.materials.csr.datamodel import CSRTest
from dashpot.extensions.materials.csr.fit import fit_aging
from dashpot.extensions.systems.door.leak_analysis import (
    Interval,
    SectionState,
    compute_contact_force,
    find_leak,
)
from dashpot.extensions.systems.door.leak_from_file import find_leak_speeds
from dashpot.extensions.systems.door.leak_setup import (
    LeakSetup,
    LeakState,
    compute_air_density,
)
from dashpot.solids.demo_seals import SHIFT
from dashpot.solids.elastic import ElasticLaw
from dashpot.workflow.json_archive import to_json

K_INF, ARMS, TAU = 196.5, (117.5, 17.8), (59.0 / 117.5, 292.2 / 17.8)
SEAL = dp.GeneralizedMaxwell(K_INF, ARMS, TAU)
DOOR = render_leaking_door('lip = "10mm"\nlimit = "160km/h"\n', compression="6mm", pitch="50mm")
STATES = """
[[leak.state]]
name = "gap 2 mm wider"
gap = "2mm"
[[leak.state]]
name = "aged"
retained = "50%"
"""
ran = partial(shell.did, "predict")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    fit = a_fit(SEAL, elastic_law=ElasticLaw.linear(K_INF, 8e-3))
    (tmp_path / "fit.json").write_text(to_json(fit), encoding="utf-8")
    return tmp_path


def door_file(folder: Path, text: str) -> Path:
    path = folder / "door.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_leak_speed_of_the_paper_seal_new_wider_aged(folder: Path):
    result = dp.predict(dp.read(door_file(folder, DOOR + STATES)), leak=True)
    new, wider, aged = result.states
    assert new.force == pytest.approx(23.58)
    assert new.pressure == pytest.approx(2358)
    kilometres = [3.6 * state.least.value for state in (new, wider, aged)]
    assert kilometres == pytest.approx([225.3, 184.0, 159.3], abs=0.05)
    assert result.limit_verdicts["aged"] == "open"
    assert result.limit_verdicts["new"] == "met"


def test_wider_gap_lifts_a_seal_that_has_no_time_to_follow():
    section = SealSection(20 * SEAL, ElasticLaw.linear(20 * K_INF, 8e-3))
    x, gap = np.array([6e-3]), 2e-3
    for t in (0.01, 1.0, 30.0):
        arms = sum(k * np.exp(-t / tau) for k, tau in zip(ARMS, TAU, strict=True))
        truth = 20 * (K_INF * (6e-3 - gap) - gap * arms)
        assert compute_contact_force(section, x, gap, t) == pytest.approx(truth)
    assert compute_contact_force(section, x, gap, 1e9) == pytest.approx(
        compute_contact_force(section, x, gap, float("inf"))
    )
    assert compute_contact_force(section, x, 7e-3, float("inf")) == 0


def test_cold_seal_follows_later_in_denser_air(folder: Path):
    kelvin, cold, gap, after = (253.15, 273.15, 296.15), 253.15, 1e-3, 2.0
    shifts = tuple(Shift(T, float(np.log10(SHIFT.a_t(T))), 0.0, T / 296.15) for T in kelvin)
    temperature_shifts = TemperatureShifts(
        SHIFT, shifts, np.zeros((6, 6)), ("c1", "c2"), np.zeros((2, 2)), vertical="T/T_r"
    )
    fit = a_fit(
        SEAL, specimen=Specimen(temperature=296.15), temperatures=temperature_shifts,
        elastic_law=ElasticLaw.linear(K_INF, 8e-3),
    )  # fmt: skip
    (folder / "fit.json").write_text(to_json(fit), encoding="utf-8")
    state = '[[leak.state]]\nname = "cold"\ntemperature = "-20degC"\ngap = "1mm"\ntime = "2s"\n'
    new, chilled = dp.predict(dp.read(door_file(folder, DOOR + state)), leak=True).states
    slower, stiffer = float(SHIFT.a_t(cold)), cold / 296.15
    arms = sum(k * np.exp(-after / (tau * slower)) for k, tau in zip(ARMS, TAU, strict=True))
    force = 20 * stiffer * (K_INF * (6e-3 - gap) - gap * arms)
    density = 101325 / (287.05 * cold)
    assert chilled.force == pytest.approx(force)
    assert chilled.speed == pytest.approx(np.sqrt(2 * force / (10e-3 * density)))
    assert chilled.least.value < new.least.value
    assert compute_air_density(293.15) == pytest.approx(1.2041, abs=1e-4)


def test_limits_hold_the_truth_of_foreign_seals_and_doors():
    """240 tests of foreign seals; gap, lip and coefficient are off by their stated errors."""
    inside = np.zeros(2)
    seeds = 240
    for seed in range(seeds):
        r = np.random.default_rng(seed)
        k_inf, *k = np.array([K_INF, *ARMS]) * r.uniform(0.8, 1.2, 3)
        t = np.arange(-0.5, 41.0, 0.04)
        ramp, x = np.clip(t, 0.0, 1.0), 8e-3 * np.clip(t, 0.0, 1.0)
        force = k_inf * x
        for a, b in zip(k, TAU, strict=True):
            force = force + 8e-3 * a * b * (1 - np.exp(-ramp / b)) * np.exp(
                -np.clip(t - 1, 0, None) / b
            )
        force = force + 2e-3 * r.standard_normal(len(t))
        fit = dp.fit(dp.RelaxationTest(t, x, force, units="SI"), arms=2)
        section = SealSection.from_fit(fit, length="50mm")
        setup = LeakSetup(10e-3, 1.0, 0.5e-3, 0.1, 0.3e-3)
        gap, lip, coefficient = r.standard_normal(3) * [0.3e-3, 0.5e-3, 0.1]
        for i, (state, retained) in enumerate(
            (
                (LeakState("new"), Interval(1.0, 1.0, 1.0)),
                (LeakState("wider and aged", 1e-3), Interval(0.7, 0.6, 0.8)),
            )
        ):
            case = SectionState(state, section, 1.204, retained)
            leak = find_leak(case, setup, fit=fit, compression=np.array([6e-3]), factor=np.ones(1))
            scatter = 1.0 if i == 0 else 0.7 + 0.1 / 1.96 * r.standard_normal()
            pressed = 6e-3 - gap - state.gap
            truth = np.sqrt(
                2 * 20 * k_inf * pressed * scatter / ((10e-3 + lip) * 1.204 * (1 + coefficient))
            )
            inside[i] += leak.limits[0, 0] <= truth <= leak.limits[1, 0]
    assert (inside / seeds >= 0.92).all()
    assert (inside / seeds <= 0.985).all()


@pytest.mark.once
def test_command_writes_text_document_page_and_stations(folder: Path):
    door_file(folder, DOOR + STATES)
    printed = ran(folder / "door.toml", "--leak")
    assert "225.3" in printed.output
    for name in ("leak.html", "leak.csv", "leak.json"):
        ran(folder / "door.toml", "--leak", "-o", folder / name)
    document = json.loads((folder / "leak.json").read_text(encoding="utf-8"))
    assert document["schema"] == "dashpot/leak@1"
    assert document["states"][1]["leak_speed"]["value"] * 3.6 == pytest.approx(184.0, abs=0.05)
    rows = (folder / "leak.csv").read_text(encoding="utf-8").splitlines()
    assert len(rows) == len(document["arc_length"]) + 1
    page = (folder / "leak.html").read_text(encoding="utf-8")
    assert "The first station lifts at" in page


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (DOOR.replace('lip = "10mm"', ""), "lip is missing"),
        (DOOR.replace('"10mm"', '"10m"'), "is the unit mm"),
        (DOOR.replace('"10mm"', '"0mm"'), "lip = 0"),
        (DOOR.replace('"10mm"', "10"), "unit"),
        (DOOR + "pressure_coefficient = -1\n", "expected a number > 0"),
        (DOOR + "pressure_coefficient_sd = 0.9\n", "expected a smaller standard error"),
        (DOOR + "lips = 3\n", "'lips' is unknown"),
        (DOOR + '[[leak.state]]\nretained = "0%"\n', "at most 100 %"),
        (DOOR + '[[leak.state]]\nretained = "120%"\n', "at most 100 %"),
        (DOOR + '[[leak.state]]\ntime = "1s"\n', "add gap, or leave time out"),
        (DOOR + '[[leak.state]]\ngap = "-1mm"\n', "gap = -0.001; expected a number >= 0"),
        (DOOR + '[[leak.state]]\nname = "new"\n', "two states are called 'new'"),
        (DOOR + '[[leak.state]]\naging_time = "1h"\n', "aging is missing"),
        (DOOR + '[[leak.state]]\naging = "fit.json"\n', "aging_time is missing"),
        (DOOR + '[[leak.state]]\naging = "../fit.json"\naging_time = "1h"\n'
         'aging_temperature = "20degC"\n',
         "lies outside the folder"),
        (DOOR + "state = 3\n", "expected at most 50 tables"),
    ],
)  # fmt: skip
def test_read_door_refuses_impossible_leak_tables(folder: Path, text: str, message: str):
    with pytest.raises(ReadError, match=message):
        dp.read(door_file(folder, text))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (DOOR[: DOOR.index("[leak]")], r"no \[leak\] is in it"),
        (DOOR.replace('compression = "6mm"', ""), "how far the seal is pressed is not said"),
        (DOOR[: DOOR.index("[seal]")] + DOOR[DOOR.index("[leak]") :], r"no \[seal\] is in it"),
        (DOOR + '[[leak.state]]\ntemperature = "-20degC"\n', "fit tests at several temperatures"),
        (
            DOOR + '[[leak.state]]\naging = "fit.json"\naging_time = "1h"\n'
            'aging_temperature = "20degC"\n',
            "holds no aging law",
        ),
    ],
)
def test_leak_speed_names_what_the_file_lacks(folder: Path, text: str, message: str):
    with pytest.raises(DataError, match=message):
        dp.predict(dp.read(door_file(folder, text)), leak=True)


def test_leak_speed_of_extrapolated_aging_is_doubted(folder: Path):
    record = lot(Rubber(), 0)
    tests = [
        CSRTest(
            record.hours, record.force, record.celsius, record.specimen_number, units="h, N, degC"
        )
    ]
    (folder / "csr.json").write_text(to_json(fit_aging(tests)), encoding="utf-8")
    state = '[[leak.state]]\nname = "aged"\naging = "csr.json"\naging_time = "{}"\n'
    aged = DOOR + state.format("500000h") + 'aging_temperature = "20degC"\n'
    result = find_leak_speeds(door_file(folder, aged))
    check = next(check for check in result.checks if check.name == "temperature_near_ovens")
    assert check.failed
    assert "In state 'aged'" in check.message
    assert result.verdict.use == "use with care"
    near = DOOR + state.format("500h") + 'aging_temperature = "100degC"\n'
    assert "temperature_near_ovens" not in [
        check.name for check in find_leak_speeds(door_file(folder, near)).checks if check.failed
    ]


def test_station_without_contact_leaks_at_rest(folder: Path):
    text = DOOR.replace('compression = "6mm"', 'compression = "6, 6, 6, -1 mm"')
    result = dp.predict(dp.read(door_file(folder, text)), leak=True)
    assert result.states[0].least.value == 0
    assert {"seal_touches", "leak_speed_determined"} <= {c.name for c in result.checks if c.failed}
