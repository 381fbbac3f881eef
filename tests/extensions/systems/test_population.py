"""Doors of many cars: scatter of modes by closed forms, shares and their intervals, a lot."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from kit.fits import a_fit
from kit.foreign.door_files import render_hinged_door
from kit.lots import draw_rows, lot_of
from kit.shell import ran, run_json
from scipy.stats import norm

import dashpot as dp
from dashpot.base.errors import DataError
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.batch.specimen_scatter import find_specimen_scatter
from dashpot.extensions.systems.door.population import (
    DoorLimit,
    DoorPopulation,
    SpecimenSpread,
    describe_quantity,
    parse_limit,
    predict_population,
)
from dashpot.registry import find_handler
from dashpot.solids.demo_seals import BROAD, PAPER
from dashpot.workflow.json_archive import to_json

SOFT = render_hinged_door(hinge="1N/m", latch="1N/m", pitch="100mm")
STIFF = render_hinged_door(hinge="5kN/mm", latch="1kN/mm", pitch="100mm")


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """A plate on a seal that holds nearly all of it, and the same on hinges that hold most."""
    place = tmp_path_factory.mktemp("cars")
    fit = a_fit(
        10 * PAPER, relative=0.008, specimen=Specimen(length=0.05, temperature=296.15),
        band=(1e-3, 1e3),
    )  # fmt: skip
    (place / "fit.json").write_text(to_json(fit))
    (place / "soft.toml").write_text(SOFT)
    (place / "stiff.toml").write_text(STIFF)
    return place


def test_mode_on_the_seal_scatters_by_half_of_the_stiffness(folder):
    """4 % between the seals and .8 % of the fit: 4.08 % of the stiffness, 2.04 % of a mode."""
    cars = predict_population(folder / "soft.toml", spread="4%")
    for quantity in cars.quantities:
        assert quantity.seal_share == pytest.approx(1.0, abs=1e-3)
        assert 100 * quantity.sd == pytest.approx(2.04, abs=0.01)
        assert 100 * quantity.between_sd == pytest.approx(2.0, abs=0.01)
        assert 100 * quantity.mean_sd == pytest.approx(0.4, abs=0.01)
        ratio = np.exp(1.96 * 0.02)
        assert (quantity.low, quantity.high) == pytest.approx(
            (quantity.value / ratio, quantity.value * ratio), 1e-3
        )


def test_a_stiffness_that_rises_with_frequency_scatters_a_mode_more(folder, tmp_path):
    """f^2 goes as K'(f), so d ln f is d ln k / (2 - d ln K' / d ln f)."""
    fit = a_fit(10 * BROAD, specimen=Specimen(length=0.05, temperature=296.15), band=(1e-3, 1e3))
    (tmp_path / "fit.json").write_text(to_json(fit))
    (tmp_path / "soft.toml").write_text((folder / "soft.toml").read_text())
    quantity = predict_population(tmp_path / "soft.toml", spread="4%").quantities[0]

    def storage(hertz):
        turn = 2 * np.pi * hertz * np.array(BROAD.tau)
        return BROAD.k_inf + np.sum(np.array(BROAD.k) * turn**2 / (1 + turn**2))

    pair = [storage(quantity.value * np.exp(side)) for side in (-1e-4, 1e-4)]
    rise = float(np.log(pair[1] / pair[0]) / 2e-4)
    assert rise > 0.02
    assert quantity.between_sd == pytest.approx(0.04 / (2 - rise), rel=3e-3)


def test_a_mode_of_which_the_seal_holds_a_part_scatters_by_half_of_that(folder):
    """A share of .06 of the energy gives .12 % where the stiffness scatters by 4.08 %."""
    cars = predict_population(folder / "stiff.toml", spread=0.04)
    stiffness = np.hypot(0.04, 0.008)
    assert len(cars.quantities) == 2
    for quantity in cars.quantities:
        assert quantity.sd == pytest.approx(quantity.seal_share / 2 * stiffness, rel=0.01)
    assert 0.06 / 2 * stiffness == pytest.approx(0.0012, abs=3e-5)


def test_limit_share_agrees_with_normal_distribution(folder):
    """On the seal alone ln f scatters by 2 %: 2 % below the median 16 % of the cars."""
    first = predict_population(folder / "soft.toml", spread="4%").quantities[0]
    bound = first.value * np.exp(-0.02)
    cars = predict_population(folder / "soft.toml", spread="4%", limits=[f"mode 1 >= {bound}Hz"])
    quantity = cars.quantities[0]
    assert quantity.nonconforming_share == pytest.approx(norm.cdf(-1.0), abs=2e-3)
    ends = norm.cdf((-0.02 + 1.96 * 0.004 * np.array([-1, 1])) / 0.02)
    assert (quantity.share_low, quantity.share_high) == pytest.approx(tuple(ends), abs=0.01)
    above = predict_population(folder / "soft.toml", spread="4%", limits=[f"mode 1 <= {bound}Hz"])
    assert above.quantities[0].nonconforming_share == pytest.approx(
        1 - quantity.nonconforming_share
    )


U = np.linspace(-0.4, 0.4, 11)
ROOT = 30.0 * np.exp(U / 2)
"""Of a mode on its seal alone."""


def seals(random, count, repeats, sd, repeat_sd):
    """ln stiffness of seals tested some times, as the scatter of their means and repeats."""
    true = sd * random.standard_normal(count)
    values = true[:, None] + repeat_sd * random.standard_normal((count, repeats))
    means, freedom = values.mean(axis=1), count * (repeats - 1)
    square = means.var(ddof=1)
    within = values.var(axis=1, ddof=1).mean() / repeats if freedom else 0.0
    between = np.sqrt(max(square - within, 0.0))
    return SpecimenSpread(between, means.mean(), np.sqrt(square / count), count, square, within,
                          freedom)  # fmt: skip


@pytest.mark.parametrize(
    ("count", "repeats", "repeat_sd", "z"),
    [(12, 1, 0.0, 1.0), (30, 1, 0.0, 2.0), (20, 3, 0.03, 1.5), (40, 2, 0.02, 0.0)],
)
def test_the_interval_of_a_share_holds_it_in_four_hundred_lots(count, repeats, repeat_sd, z):
    random = np.random.default_rng([count, repeats])
    limit = DoorLimit("mode 1", 30.0 * float(np.exp(0.04 * z / 2)), is_upper=True)
    true, held = norm.sf(z), []
    for _ in range(400):
        spread = seals(random, count, repeats, 0.04, repeat_sd)
        door_quantity = describe_quantity("mode 1", U, ROOT, spread, limit=limit)
        held.append(door_quantity.share_low <= true <= door_quantity.share_high)
    assert 0.92 <= np.mean(held) <= 0.98


def test_a_lot_gives_mean_and_scatter_of_its_seals():
    """Of 200 seals with 3 % between and 1 % within; mean 200 N/m."""
    rows = draw_rows(lots=1, seals=200, repeats=2, sds=(0.0, 0.03, 0.01), seed=3)
    specimen_scatter = find_specimen_scatter(lot_of(rows))
    assert specimen_scatter["specimens"] == 200
    assert specimen_scatter["mean"] == pytest.approx(np.log(200), abs=0.01)
    assert np.sqrt(specimen_scatter["within_square"]) == pytest.approx(0.01 / np.sqrt(2), rel=0.1)
    between = np.sqrt(specimen_scatter["between_square"] - specimen_scatter["within_square"])
    assert between == pytest.approx(0.03, rel=0.12)
    assert find_handler("scatter of specimens", "lot") is find_specimen_scatter


@cache
def make_lot(seed=1, seals=20, mean=None, lots=1):
    k = 10 * PAPER.k_inf if mean is None else mean
    return lot_of(
        draw_rows(lots=lots, seals=seals, repeats=2, sds=(0.0, 0.04, 0.01), mean=k, seed=seed)
    )


def write_press(path: Path, stiffness: float, seed: int) -> None:
    """Write a ramp of 1 s and a hold of a solid with one arm, by its closed form."""
    t, random = np.arange(-2.0, 20.0, 0.02), np.random.default_rng(seed)
    rise = [-np.expm1(-np.clip(t - start, 0.0, None) / 2.0) for start in (0.0, 1.0)]
    x = np.clip(t, 0.0, 1.0) * 6e-3
    force = stiffness * (x + 0.3 * 6e-3 * 2.0 * (rise[0] - rise[1]))
    force = force + 2e-3 * random.standard_normal(len(t))
    np.savetxt(path, np.column_stack((t - t[0], 1e3 * x, force)), delimiter=",", fmt="%.6f",
               header="time [s],displacement [mm],force [N]", comments="")  # fmt: skip


def test_a_folder_of_tests_becomes_a_lot_and_a_share_of_cars(tmp_path, monkeypatch):
    """From files alone: tests, ``batch``, and the door; a lot may be named by its table."""
    monkeypatch.chdir(tmp_path)
    random, true = np.random.default_rng(7), []
    Path("seals").mkdir()
    for seal in range(6):
        true.append(200.0 * (1 + 0.04 * random.standard_normal()))
        for repeat in (1, 2):
            write_press(Path(f"seals/s{seal}_{repeat}.csv"), true[-1], 10 * seal + repeat)
    assert ran("fit", "seals/s0_1.csv", "--length", "50mm", "-o", "fit.json").exit_code == 0
    named = "--label-pattern", r"(?P<seal>s\d+)_(?P<repeat>\d)"
    assert ran("batch", "seals", *named, "-o", "lot").exit_code == 0
    Path("door.toml").write_text(SOFT)
    requested = "predict", "door.toml", "--limit", "mode 1 >= 5Hz", "--lot"
    document = run_json(*requested, "lot")
    assert document["spread"]["specimens"] == 6
    assert document["spread"]["between_sd"] == pytest.approx(np.std(np.log(true), ddof=1), rel=0.1)
    assert run_json(*requested, "lot/lot.csv")["spread"] == document["spread"]
    refused = ran(*requested, "nowhere")
    assert refused.exit_code != 0
    assert "nowhere does not exist" in refused.output


def test_cars_of_a_lot_are_about_its_mean_not_about_the_fit(folder):
    lot = make_lot(mean=1.1 * 10 * PAPER.k_inf)
    cars = dp.predict(dp.read(folder / "soft.toml"), lot=lot, limits=["mode 1 >= 20Hz"])
    quantity = predict_population(folder / "soft.toml", spread="4%").quantities[0]
    mean = find_specimen_scatter(lot)["mean"] - np.log(10 * PAPER.k_inf)
    assert cars.spread.mean == pytest.approx(mean)
    assert cars.quantities[0].value == pytest.approx(quantity.value * np.exp(mean / 2), rel=1e-3)
    assert cars.spread.between_sd == pytest.approx(0.04, rel=0.4)


def test_closing_speed_of_the_cars_follows_the_force_of_the_seal(tmp_path, monkeypatch):
    from dashpot.extensions.systems.door.closing_analysis import find_least_speed, make_closing_door

    monkeypatch.chdir(tmp_path)
    ran("demo", "--files", "--all", "-o", ".")
    dp.save(dp.fit(dp.read("seal_8mm.csv"), arms=2), "fit.json")
    cars = run_json("predict", "door.toml", "--spread", "4%", "--limit", "closing <= 0.73m/s",
                    "-o", "cars.html", "--plot", "cars.svg")  # fmt: skip
    (entry,) = [item for item in cars["quantities"] if item["name"] == "closing"]
    door = dp.read("door.toml")
    assert entry["limit"] == 0.73
    assert 0 <= entry["share_low"] <= entry["nonconforming_share"] <= entry["share_high"] <= 1
    from dashpot.extensions.systems.door.analyse_file import open_door

    closed = make_closing_door(open_door(door)[0].door)
    pair = find_least_speed(closed, load=np.exp([-0.04, 0.04]))
    slope = float(np.diff(np.log(pair))[0] / 0.08)
    assert entry["between_sd"] == pytest.approx(0.04 * slope, rel=0.05)
    page = Path("cars.html").read_text()
    assert "How the cars differ" in page
    assert "door.toml" in page
    Path("cars.json").write_text(json.dumps(cars))
    assert dp.read("cars.json").quantities[-1].name == "closing"


@pytest.mark.parametrize(
    ("text", "limit"),
    [
        ("mode 1 >= 30Hz", ("mode 1", 30.0, False)), ("Mode 12<0.1kHz", ("mode 12", 100.0, True)),
        ("closing <= 1.2m/s", ("closing", 1.2, True)),
    ],
)  # fmt: skip
def test_a_limit_is_read(text, limit):
    assert parse_limit(text) == limit


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--limit", "mode 1 >= 30Hz"], "the lot that was tested"),
        (["--spread", "4%", "--lot", "lot"], "once"),
        (["--spread", "4%", "--limit", "mode 1 = 30Hz"], "expected a mode or the closing speed"),
        (["--spread", "4%", "--limit", "mode 1 >= 30mm"], "expected a unit of frequency"),
        (["--spread", "4%", "--limit", "mode 40 >= 30Hz"], "this door has mode 1, mode 2"),
        (["--spread", "80%"], "expected 0.01 to 50 %"),
        (["--spread", "4%", "--modes"], "are of one door"),
        (["--spread", "4%", "--limit", "mode 1 > 3Hz", "--limit", "mode 1 < 9Hz"], "same quantity"),
    ],
)
def test_predict_refuses_questions_that_suit_no_cars(folder, words, message):
    (folder / "lot").mkdir(exist_ok=True)
    words = [str(folder / "lot") if word == "lot" else word for word in words]
    done = ran("predict", folder / "soft.toml", *words)
    assert done.exit_code == 2
    assert message in done.stderr


def test_a_mode_without_the_seal_shows_no_rounding():
    u = np.linspace(-0.2, 0.2, 11)
    spread = SpecimenSpread(0.04)
    door_quantity = describe_quantity("mode 3", u, np.full(11, 61.875310127), spread)
    (fact,) = DoorPopulation(spread, (door_quantity,)).facts
    assert fact.cells.value == "61.88"


def test_a_lot_that_does_not_suit_is_refused(folder):
    with pytest.raises(DataError, match="times as stiff as the fit of the door"):
        predict_population(folder / "soft.toml", lot=make_lot(mean=200.0 * PAPER.k_inf))
    with pytest.raises(DataError, match="the lot has 3 seals; at least 4"):
        predict_population(folder / "soft.toml", lot=make_lot(seals=3))
    with pytest.raises(DataError, match="the folder holds 2 lots"):
        predict_population(folder / "soft.toml", lot=make_lot(lots=2))


def test_text_of_many_cars_separates_scatter_from_error(folder, monkeypatch):
    monkeypatch.chdir(folder)
    limits = ("--limit", "mode 1 >= 1Hz")
    done = ran("predict", "soft.toml", "--spread", "4%", *limits)
    assert done.exit_code == 0, done.output
    lines = done.stdout.splitlines()
    (head,) = [line for line in lines if "median door" in line]
    assert "95 % of the cars" in head
    assert "SE" not in head
    (share,) = [line for line in lines if "mode 1 below 1 Hz" in line and "SD" not in line][-1:]
    assert "below 0.1 %" in share
    assert all(len(line) <= 100 for line in lines)
