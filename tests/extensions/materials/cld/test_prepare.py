"""Compression load deflection of seals whose truth is known, and records that deceive."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from kit.cld import ARMS, LENGTH, bulb, press_cycles, stiffening
from kit.fits import list_failed_checks

import dashpot as dp
from dashpot.base.errors import DataError
from dashpot.extensions.materials.cld.preprocess import cld
from dashpot.extensions.materials.strokes import MIN_STROKE, find_strokes

SPECIMEN = dp.Specimen(length=LENGTH)
ELASTIC = {"arms": (), "softening": 0.0}


def evaluate_record(truth, **how):
    test = dp.CLDTest(truth.displacement, truth.force, truth.time, SPECIMEN, units="SI")
    return cld(test, **how)


def true_force(truth, at, *, cycle, inward=True):
    """The force without noise where the plate passes a compression in a cycle, from 1."""
    x = truth.compression
    passes = (x[:-1] < at) & (x[1:] >= at) if inward else (x[:-1] > at) & (x[1:] <= at)
    i = np.flatnonzero(passes)[cycle - 1]
    return np.interp(at, *np.sort(np.array([x[i : i + 2], truth.clean[i : i + 2]]), axis=1))


def test_cld_stores_the_work_of_a_spring():
    """5 N of 100 mm at 6 mm: 15 mJ, none lost; whatever the length of the specimen."""
    spring = press_cycles(
        lambda x: 5 / 6e-3 * x, depth=6e-3, noise=0.0, bias=0.0, count=0.0, **ELASTIC
    )
    for length in (0.1, 0.05):
        test = dp.CLDTest(
            spring.displacement,
            spring.force * length / 0.1,
            spring.time,
            replace(SPECIMEN, length=length),
            units="SI",
        )
        quantity = cld(test)
        assert quantity.unit == "N per 100 mm"
        assert quantity.per * quantity.nominal.loading == pytest.approx(5, rel=1e-9)
        assert quantity.per * quantity.nominal.slope == pytest.approx(5 / 6e-3, rel=1e-9)
        assert quantity.per * quantity.cycle.energy == pytest.approx(15e-3, rel=1e-5)
        assert quantity.cycle.hysteresis == pytest.approx(0, abs=1e-9)
        assert quantity.softening == pytest.approx(0, abs=1e-9)
        assert quantity.nominal.secant == pytest.approx(quantity.nominal.slope, rel=1e-9)


@pytest.mark.parametrize("law", [stiffening, bulb])
@pytest.mark.parametrize("turn", [(1, 1), (-1, 1), (1, -1), (-1, -1)])
def test_figures_are_those_of_the_truth_whatever_the_signs(law, turn):
    truth = press_cycles(law, drift=2e-4)
    turned = replace(truth, displacement=turn[0] * truth.displacement, force=turn[1] * truth.force)
    outcome = evaluate_record(turned, at=6e-3, compression_limits=(4e-3, 7.5e-3))
    assert len(outcome.cycles) == 4
    assert outcome.cycle.number == 4
    assert outcome.cycle.speed == pytest.approx(5e-3, rel=1e-3)
    for mark in outcome.limit_marks:
        for inward, force in ((True, mark.loading), (False, mark.unloading)):
            true = true_force(truth, mark.compression, cycle=4, inward=inward)
            assert force == pytest.approx(true, abs=4 * mark.loading_se)
        near = [true_force(truth, mark.compression + d, cycle=4) for d in (-2e-5, 2e-5)]
        assert mark.slope == pytest.approx((near[1] - near[0]) / 4e-5, abs=4 * mark.slope_se + 5)
    x, last = truth.compression, truth.time > truth.time[-1] - 1.0 - 2 * 9e-3 / 5e-3
    lost = np.trapezoid(truth.clean[last], x[last])
    inward = last & (np.gradient(x) > 0)
    assert outcome.cycle.hysteresis == pytest.approx(
        lost / np.trapezoid(truth.clean[inward], x[inward]), abs=0.006
    )
    assert outcome.drift == pytest.approx(2e-4 * (truth.time[-1] - 1.0), rel=0.15)


@pytest.mark.once
def test_the_errors_of_force_and_contact_hold():
    """Over seeds: the truth within twice the error nearly as often as it should be."""
    z = []
    for seed in range(30):
        truth = press_cycles(seed=seed, count=2e-5, cycles=2)
        outcome = evaluate_record(truth, at=6e-3)
        z.append(
            (outcome.nominal.loading - true_force(truth, 6e-3, cycle=2))
            / outcome.nominal.loading_se
        )
    assert np.mean(np.abs(z) < 2) >= 0.85
    assert np.abs(z).max() < 4


def test_softening_is_that_of_the_cycles_and_set_that_of_the_contact():
    soft = evaluate_record(press_cycles(arms=(), softening=0.12), at=6e-3)
    share = 0.12 * (1 - np.exp(-3 / 1.5))
    assert soft.softening == pytest.approx(share, abs=0.01)
    gone = evaluate_record(press_cycles(set_=0.4e-3, **ELASTIC), at=6e-3)
    assert gone.set == pytest.approx(0.4e-3 * (1 - np.exp(-3)), abs=0.05e-3)
    assert gone.cycles[0].contact == 0


@pytest.mark.parametrize(
    ("how", "names"),
    [
        ({}, set()),
        ({"gap": 0.0}, set()),
        ({"gap": -1e-3}, {"zero_recorded"}),
        ({"cycles": 1}, {"specimen_conditioned"}),
        ({"cycles": 2}, {"specimen_conditioned"}),
        ({"depth": (4e-3, 5e-3, 6e-3, 8e-3)}, {"specimen_conditioned", "depth_conditioned"}),
        ({"wait": 3.0}, set()),
        ({"drift": 3e-3}, {"load_cell_steady"}),
        ({"cycles": 1, "unload": False}, {"specimen_conditioned", "unloading_recorded"}),
    ],
)
def test_cld_reports_exactly_the_faults_of_a_record(how, names):
    assert (
        list_failed_checks(evaluate_record(press_cycles(**{"softening": 0.05} | how), at=6e-3))
        == names
    )


def test_cld_retains_and_reports_a_preload():
    truth = press_cycles(gap=-1e-3, bias=0.0)
    outcome = evaluate_record(truth, at=5e-3)
    assert outcome.preload == pytest.approx(float(np.median(truth.clean[:100])), abs=4e-3)
    assert "begins in contact, under 11 %" in outcome.verdict.message
    assert outcome.cycle.depth == pytest.approx(7e-3, abs=1e-5)


def test_a_stop_in_the_stroke_is_no_turning_point_but_no_even_speed():
    truth = press_cycles(cycles=3, softening=0.0)
    still = np.flatnonzero((truth.compression > 4e-3) & (np.gradient(truth.compression) > 0))
    i = int(still[-1]) - 60
    held = [np.insert(item, i, np.full(100, item[i])) for item in (truth.displacement, truth.force)]
    test = dp.CLDTest(*held, np.arange(len(held[0])) / 100, SPECIMEN, units="SI")
    element = cld(test, at=6e-3)
    assert len(element.cycles) == 3
    assert "plate_speed_constant" in list_failed_checks(element)


def test_cld_selects_the_requested_or_last_reaching_cycle():
    truth = press_cycles(depth=(8e-3, 8e-3, 5e-3))
    assert evaluate_record(truth, at=4e-3).cycle.number == 3
    assert evaluate_record(truth, at=6e-3).cycle.number == 2
    assert evaluate_record(truth, at=6e-3, cycle=1).cycle.number == 1
    outcome = evaluate_record(truth, at=6e-3, compression_limits=(4e-3, 9e-3))
    assert outcome.most is None
    assert "compressions_reached" in list_failed_checks(outcome)
    for how, message in (
        ({"at": 9e-3}, "at most 7.9"),
        ({"at": "-1mm"}, "expected a compression > 0"),
        ({"cycle": 4}, "holds 3 cycles"),
    ):
        with pytest.raises(DataError, match=message):
            evaluate_record(truth, **how)


def test_cld_without_a_clock_has_the_same_curve_and_no_speed():
    truth = press_cycles()
    timed = evaluate_record(truth, at=6e-3)
    quantity = cld(dp.CLDTest(truth.displacement, truth.force, units="SI"), at=6e-3)
    assert quantity.nominal.loading == pytest.approx(timed.nominal.loading, abs=1e-4)
    assert quantity.cycle.speed is None
    assert (quantity.unit, quantity.per) == ("N", 1)
    assert list_failed_checks(quantity) == {"length_stated"} | list_failed_checks(timed)


@pytest.mark.parametrize("still", ["displacement", "force"])
def test_nothing_pressed_is_refused(still):
    signals = {"displacement": np.linspace(0, 1e-3, 50), "force": np.linspace(0, 1, 50)}
    signals[still] = np.ones(50)
    with pytest.raises(DataError, match=f"the {still} never changes"):
        cld(dp.CLDTest(**signals, units="SI"))


@pytest.mark.parametrize(("share", "strokes"), [(0.98, 1), (1.02, 3)])
def test_a_stroke_is_a_twentieth_of_the_travel(share, strokes):
    way = np.interp(np.arange(301), [0, 100, 200, 300], [0, 0.5, 0.5 - share * MIN_STROKE, 1])
    assert len(find_strokes(way, resolution=0.0)) == strokes


def test_noise_and_counts_make_no_strokes():
    truth = press_cycles(cycles=5, count=2e-5, rate=400.0)
    noisy = truth.displacement + 3e-5 * np.random.default_rng(0).standard_normal(len(truth.time))
    for x in (truth.displacement, noisy):
        ways = find_strokes(x, resolution=1.2e-4)
        assert [item.inward for item in ways] == [True, False] * 5
        assert np.diff([(item.first, item.last) for item in ways], axis=1).min() > 600


def test_relaxation_makes_the_unloading_lower():
    """An elastic seal has no hysteresis; one with arms has, and shows less when slow."""
    lost = [
        evaluate_record(
            press_cycles(speed=v, softening=0.0, arms=arms, rate=2e4 * v), at=6e-3
        ).cycle.hysteresis
        for v, arms in ((5e-3, ()), (5e-3, ARMS), (0.2e-3, ARMS))
    ]
    assert abs(lost[0]) < 0.005
    assert lost[1] > lost[2] > 0.05


def test_swapped_columns_make_energy_and_are_not_to_be_used():
    truth = press_cycles(cycles=3)
    swapped = dp.CLDTest(1e-3 * truth.force, 1e3 * truth.displacement, truth.time, units="SI")
    fit = cld(swapped)
    assert fit.verdict.use == "do not use"
    assert "swapped" in fit.verdict.message


def test_a_curve_typed_from_a_sheet_begins_where_it_begins():
    """A few rows from 0 mm and 0 N, without a clock, a rest or the way back."""
    x = np.linspace(0, 8e-3, 17)
    item = cld(dp.CLDTest(x, 200.0 * x, units="SI"), at=6e-3)
    assert item.nominal.loading == pytest.approx(1.2)
    assert item.preload == 0
    assert list_failed_checks(item) == {
        "specimen_conditioned",
        "unloading_recorded",
        "length_stated",
    }
    up = np.concatenate((x, x[-2::-1]))
    assert cld(dp.CLDTest(up, 200.0 * up, units="SI")).cycle.hysteresis == pytest.approx(
        0, abs=1e-9
    )


@pytest.mark.once
def test_its_numbers_are_a_table_and_its_picture_is_there():
    pytest.importorskip("pandas")
    outcome = evaluate_record(press_cycles(cycles=1), at=6e-3)
    table = outcome.to_pandas()
    assert list(table.columns) == ["force", "time"]
    assert table.attrs["units"]["force"] == "N"
    assert np.array_equal(table["force"], outcome.force)
    assert outcome.plot().panels[0].y.label == "force, N per 100 mm"


@pytest.mark.parametrize(("pull", "holds"), [(0.0, True), (0.015, True), (0.05, False)])
def test_cld_distinguishes_adhesion_from_noise(pull, holds):
    truth = press_cycles(softening=0.0)
    back = (np.gradient(truth.compression) < 0) & (np.abs(truth.compression - 2e-4) < 4e-4)
    outcome = evaluate_record(replace(truth, force=truth.force - pull * back))
    assert {check.name: check.passed for check in outcome.checks}["no_adhesion_on_release"] is holds
