"""The plan of an aging test: its expected error by simulated tests, its choice, and refusals."""

from __future__ import annotations

from functools import cache
from itertools import product

import numpy as np
import pytest
from kit.fits import list_failed_checks
from kit.foreign.aging import Rubber, lot
from kit.shell import ran, run_json

import dashpot as dp
from dashpot.base.errors import DataError
from dashpot.datamodel.machine import Machine
from dashpot.extensions.materials.csr.aging_plan import plan_aging
from dashpot.extensions.materials.csr.datamodel import CSRTest
from dashpot.extensions.materials.csr.fit import fit_aging

TRUE = Rubber()
HOUR = 3600.0
R = 8.314462618


@cache
def make_usual_plan():
    return plan_aging(use_at="70degC")


def simulate_plan(plan, seed, rubber=TRUE, drift=0.03):
    """Readings of the plan: ovens that are off, a drift of one cell, scatter, free F0."""
    random = np.random.default_rng([seed, 11346])
    zero, hours = drift * random.standard_normal(), np.array(plan.times) / HOUR
    parts = []
    for kelvin, count in zip(plan.oven_temperatures, plan.specimens, strict=True):
        item = lot(
            rubber, int(random.integers(2**31)), ovens=(kelvin - 273.15,), specimens=count,
            hours=hours, spread=0.0, off=plan.oven_sd, noise=plan.scatter, zero=zero,
        )  # fmt: skip
        parts.append((item, len(parts) * 100))
    return CSRTest(
        np.concatenate([test.hours for test, _ in parts]),
        np.concatenate([record.force for record, _ in parts]),
        np.concatenate([test.celsius for test, _ in parts]),
        np.concatenate([element.specimen_number + more for element, more in parts]),
        units="h, N, degC",
    )


def lives(plan, seeds, machine=None, **how):
    """ln life of each simulated test, and the standard error that its fit states."""
    pairs = []
    for seed in seeds:
        law = fit_aging([simulate_plan(plan, seed, **how)], machine=machine).law
        error = law.error_of(lambda it: np.log(it.life(plan.use_at, plan.part)))
        pairs.append((np.log(law.life(plan.use_at, plan.part) / HOUR), error))
    return np.array(pairs).T


def test_the_expected_error_is_that_of_simulated_tests():
    """Of 40 the standard deviation is known to 11 %."""
    result, stated = lives(make_usual_plan(), range(40))
    assert result.std() == pytest.approx(make_usual_plan().life_sd, rel=0.33)
    assert np.median(stated) == pytest.approx(make_usual_plan().life_sd, rel=0.1)
    assert np.mean(result) == pytest.approx(
        np.log(TRUE.life(70.0)), abs=4 * make_usual_plan().life_sd / 6
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    "how",
    [
        {}, {"ovens": 4, "longest": "700h"}, {"machine": Machine(oven=0.0, drift=0.0)},
        {"part": "80%", "scatter": "2%", "longest": "500h"},
        {"use_at": "85degC", "hottest": "140degC"},
    ],
)  # fmt: skip
def test_the_planned_interval_holds_the_life_in_two_hundred_tests(how):
    plan = plan_aging(**{"use_at": "70degC", **how})
    machine = how.get("machine")
    drift = 0.03 if machine is None else 0.0
    result, _ = lives(plan, range(2000, 2200), machine, drift=drift)
    truth = np.log(TRUE.life(plan.use_at - 273.15, plan.part))
    inside = np.mean(np.abs(result - truth) < 1.96 * plan.life_sd)
    assert 0.92 <= inside <= 0.98, inside
    assert result.std() == pytest.approx(plan.life_sd, rel=0.2)


def closed_form_sd(plan, expected=True):
    """Of the ln life by rates alone: no noise of loss or drift, and what the ovens' errors leave.

    With perfect readings a rate is off by Ea s_T / (R T^2), and the line over 1/T passes them on.
    """
    kelvin = np.array(plan.oven_temperatures)
    off = 90e3 * plan.oven_sd / (R * kelvin**2)
    G = np.column_stack((np.ones(len(kelvin)), (1 / kelvin - 1 / 398.15) / R)) / off[:, None]
    at = np.array([1.0, (1 / plan.use_at - 1 / 398.15) / R])
    return float(np.sqrt(at @ np.linalg.inv(G.T @ G) @ at))


def test_oven_errors_limit_the_life_when_readings_are_perfect():
    plan = plan_aging(
        use_at="70degC",
        scatter=1e-5,
        machine=Machine(drift=0.0),
        within=1.01,
        longest="20000h",
    )
    # a life by tau alone; the physical loss shortens it, and its part of the gradient is below 1
    tau = np.log(TRUE.life(70.0)) - np.log(TRUE.time(70.0))
    assert tau < 0
    by_tau = plan.life_sd / closed_form_sd(plan)
    low = Rubber(hours=2500 * np.exp(-1e-4)).life(70.0)
    high = Rubber(hours=2500 * np.exp(1e-4)).life(70.0)
    assert by_tau == pytest.approx(np.log(high / low) / 2e-4, rel=1e-3)
    assert "life_sd_within_target" in list_failed_checks(plan)


def information(plan_kelvin, count, *, use_at=343.15, scatter=0.01, oven=1.0, drift=0.03):
    """Variance of the ln life for `count` specimens in each oven, by differences of the truth."""
    hours = np.array([0.5, 1, 2, 5, 10, 24, 48, 72, 168, 336, 500, 750, 1000])
    rows, ovens = [], len(plan_kelvin)

    def model(theta):
        p, log_hours, energy, zero, *off = theta
        out = []
        for k, (kelvin, n) in enumerate(zip(plan_kelvin, count, strict=True)):
            rubber = Rubber(p, np.exp(log_hours), energy)
            value = rubber.force_ratio(hours, kelvin - 273.15 + oven * off[k])
            value = value + zero * drift * hours / 1000
            out += [value] * n
        return np.concatenate(out)

    start = np.array([0.03, np.log(2500.0), 90e3, 0.0, *[0.0] * ovens])
    steps = np.array([1e-6, 1e-6, 1.0, 1e-4, *[1e-4] * ovens])
    base = model(start)
    for i, step in enumerate(steps):
        up, down = start.copy(), start.copy()
        up[i] += step
        down[i] -= step
        rows.append((model(up) - model(down)) / (2 * step))
    n = sum(count)
    F0 = np.kron(np.eye(n), np.ones((len(hours), 1))) * base[:, None]
    J = np.column_stack((np.array(rows).T, F0)) / scatter
    prior = np.zeros((1 + ovens, J.shape[1]))
    prior[np.arange(1 + ovens), 3 + np.arange(1 + ovens)] = 1.0
    scale = np.concatenate((steps, np.full(n, 1e-3)))
    J = np.vstack((J, prior)) * scale
    covariance = np.linalg.inv(J.T @ J) * np.outer(scale, scale)
    g = np.zeros(J.shape[1])
    for i in range(3):
        pair = [0.03, np.log(2500.0), 90e3]
        values = []
        for sign in (1, -1):
            pair[i] = start[i] + sign * steps[i] * 10
            values.append(np.log(Rubber(pair[0], np.exp(pair[1]), pair[2]).life(use_at - 273.15)))
            pair[i] = start[i]
        g[i] = (values[0] - values[1]) / (20 * steps[i])
    return float(np.sqrt(g @ covariance @ g))


def test_the_expected_error_is_that_of_the_whole_normal_equations():
    plan = make_usual_plan()
    assert plan.life_sd == pytest.approx(
        information(plan.oven_temperatures, plan.specimens), rel=2e-3
    )


def test_no_other_allocation_of_as_many_specimens_is_better():
    """All allocations to the chosen ovens, by the normal equations apart from the plan."""
    plan = make_usual_plan()
    total = sum(plan.specimens)
    every = [
        (information(plan.oven_temperatures, (a, b, total - a - b)), (a, b, total - a - b))
        for a, b in product(range(2, 8), range(2, 8))
        if total - a - b >= 2
    ]
    assert plan.life_sd <= min(every)[0] * 1.005
    fewer = [
        information(plan.oven_temperatures, (a, b, total - 1 - a - b))
        for a, b in product(range(2, 7), range(2, 7))
        if total - 1 - a - b >= 2
    ]
    assert min(fewer) > plan.target_sd * 0.999


def test_plan_needs_fewer_specimens_for_a_wider_interval_or_longer_test():
    assert sum(make_usual_plan().specimens) > sum(plan_aging(use_at="70degC", within=2.0).specimens)
    assert sum(make_usual_plan().specimens) > sum(
        plan_aging(use_at="70degC", longest="2000h").specimens
    )
    assert (
        make_usual_plan().life_sd
        <= make_usual_plan().target_sd
        == pytest.approx(np.log(1.5) / 1.96)
    )
    tight = plan_aging(use_at="70degC", within=1.1)
    assert "life_sd_within_target" in list_failed_checks(tight)
    assert tight.verdict.use != "use"
    by = {alternative.change: alternative.life_sd for alternative in make_usual_plan().alternatives}
    assert by["2000 h in the ovens"] < make_usual_plan().life_sd < by["500 h in the ovens"]
    assert by["twice as many specimens"] < make_usual_plan().life_sd
    assert all(oven.significance >= 4 for oven in make_usual_plan().ovens)


def test_a_near_use_is_planned_with_a_verdict_of_use():
    plan = plan_aging(use_at="95degC", hottest="150degC")
    assert not list_failed_checks(plan)
    assert plan.verdict.use == "use"
    assert f"within a factor of {np.exp(1.96 * plan.life_sd):.3g}" in str(plan.verdict).replace(
        "\n ", ""
    )


def test_the_law_and_scatter_of_a_fit_are_supposed():
    aging = fit_aging([simulate_plan(make_usual_plan(), 1, Rubber(energy=80e3))])
    plan = plan_aging(use_at="80degC", aging=aging)
    assert plan.life == pytest.approx(aging.law.life(353.15, 0.5))
    assert plan.scatter == aging.scatter
    assert plan.oven_temperatures[-1] == pytest.approx(aging.ovens[-1].temperature)


@pytest.mark.parametrize(
    ("how", "message"),
    [
        ({"longest": "10h"}, "expected 24 h to"), ({"ovens": 2}, "needs three"),
        ({"within": 1.0}, "a factor of 1.01 to 50"), ({"part": "1000h"}, "a part of the force"),
        ({"hottest": "80degC"}, "Name a hotter oven"), ({"scatter": "50%"}, "--scatter 50%"),
        ({"machine": Machine(sync=1e-3)}, "sync= does not suit"), ({"use_at": "-300degC"}, "zero"),
        ({"use_at": "-60degC"}, "never falls to 50 %"),
    ],
)  # fmt: skip
def test_plan_refuses_numbers_that_make_no_sense(how, message):
    with pytest.raises(DataError, match=message):
        plan_aging(**{"use_at": "70degC", **how})


def test_a_law_without_activation_energy_plans_nothing():
    aging = fit_aging([simulate_plan(make_usual_plan(), 1, Rubber(hours=1e8))])
    with pytest.raises(DataError, match="no activation energy"):
        plan_aging(use_at="70degC", aging=aging)


def test_the_command_prints_the_plan(tmp_path):
    document = run_json("plan", "--use-at", "70degC")
    assert document["schema"] == "dashpot/aging-plan@1"
    assert document["life_sd"] == make_usual_plan().life_sd
    (tmp_path / "plan.json").write_text(dp.files.to_json(make_usual_plan()))
    assert dp.read(tmp_path / "plan.json") == make_usual_plan()
    text = ran("plan", "--use-at", "70degC").stdout
    for words in ("specimens", "F/F0 at the end", "a factor of 1.49; wanted 1.50", "2000 h in"):
        assert words in text


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("--use-at 70degC --ramp 1s", "--ramp does not go with --use-at"),
        ("--frequency 12Hz --hottest 150degC", "--hottest does not go with --frequency"),
        ("", "Missing option '--frequency'"), ("--use-at 70", "degC"),
    ],
)  # fmt: skip
def test_options_of_two_tests_are_refused(words, message):
    done = ran("plan", *words.split())
    assert done.exit_code == 2
    assert message in done.stderr


def test_a_file_that_is_no_aging_law_is_refused(tmp_path):
    dp.save(dp.fit(dp.simulate("relaxation", hold="5s"), arms=2), tmp_path / "fit.json")
    done = ran("plan", "--use-at", "70degC", "--aging", tmp_path / "fit.json")
    assert done.exit_code == 2
    assert "is no fit of an aging test" in done.stderr
