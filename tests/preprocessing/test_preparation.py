"""From a raw relaxation test to a ramp and a hold."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dashpot.base.checks import Check
from dashpot.base.errors import DataError
from dashpot.base.provenance import Source
from dashpot.datamodel.relaxation import RampHold, RelaxationTest
from dashpot.datamodel.specimen import Specimen
from dashpot.fitting.relaxation import fit
from dashpot.preprocessing import contact
from dashpot.preprocessing.contact import find_contact
from dashpot.preprocessing.prepare import prepare
from dashpot.simulation.relaxation import SimulatedRelaxation, simulate_path, simulate_relaxation
from dashpot.simulation.rig_errors import Rig
from dashpot.simulation.robot import Axis
from dashpot.solids.demo_seals import BROAD, PAPER

QUANTUM = 0.02e-3


@pytest.fixture(scope="module")
def simulation() -> SimulatedRelaxation:
    return simulate_relaxation(PAPER)


@pytest.fixture(scope="module")
def raw(simulation: SimulatedRelaxation) -> RelaxationTest:
    return simulation.test


def check(prepared: RampHold, name: str) -> Check:
    return next(result for result in prepared.checks if result.name == name)


def list_failed_checks(prepared: RampHold) -> list[str]:
    return [result.name for result in prepared.checks if result.failed]


def step(prepared: RampHold, name: str) -> str:
    return next(result.message for result in prepared.steps if result.name == name)


def ideal(*, rate: float = 1000.0, force=None) -> RelaxationTest:
    time = np.arange(round(12 * rate)) / rate
    x = 8e-3 * np.clip(time - 1.5, 0, 1)
    return RelaxationTest(
        time=time,
        displacement=x,
        force=PAPER.force(time, x) if force is None else force(time, x),
        units="SI",
    )


# -- what the virtual rig made is found -----------------------------------------------------------


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize(
    ("model", "rig"),
    [
        (PAPER, Rig()),
        (BROAD, Rig()),
        (PAPER, Rig().noise_free()),
        (PAPER, Rig(rate=100.0)),
        (PAPER, Rig(encoder=0.0, position_noise=20e-6)),
        (PAPER, Rig(gap=0.5e-3)),
        (BROAD, Rig(gap=0.5e-3)),
        (PAPER, Rig(gap=0.5e-3, rate=100.0)),
        (PAPER, Rig(axis=Axis(damping=0.35))),
        (PAPER, Rig(axis=Axis(friction=0.05))),
    ],
    ids="paper broad noise-free 100Hz analogue gap broad-gap gap-100Hz overshoot sticky".split(),  # noqa: SIM905
)
def test_onset_ramp_depth_and_hold_of_the_virtual_rig(model, rig: Rig, seed: int):
    made = simulate_relaxation(model, rig=rig, seed=seed)
    ramp_hold, truth = prepare(made.test), made.truth
    quantum_time = (rig.encoder or 20e-6) / 8e-3
    assert ramp_hold.onset == pytest.approx(truth.onset, abs=1 / rig.rate + quantum_time)
    assert ramp_hold.ramp_time == pytest.approx(truth.ramp_end - truth.onset, abs=5e-3)
    assert ramp_hold.ramp_time == pytest.approx(1.0, abs=7e-3)
    held = truth.displacement[-1] - truth.contact
    assert ramp_hold.depth == pytest.approx(held, abs=QUANTUM)
    assert ramp_hold.hold_time == pytest.approx(made.test.time[-1] - truth.ramp_end, abs=0.01)
    assert list_failed_checks(ramp_hold) == []


def test_the_compression_is_zero_before_contact_and_as_recorded_after(raw: RelaxationTest):
    ramp_hold = prepare(raw)
    assert np.abs(ramp_hold.displacement[ramp_hold.time < 1.5]).max() == 0.0
    after = ramp_hold.time > 1.6
    np.testing.assert_allclose(ramp_hold.displacement[after], raw.displacement[after], atol=1e-15)
    np.testing.assert_array_equal(ramp_hold.time, raw.time)
    assert ramp_hold.specimen == raw.specimen


def test_the_tare_is_the_mean_of_the_baseline(raw: RelaxationTest):
    ramp_hold = prepare(raw)
    assert ramp_hold.force[ramp_hold.time < 1.5].mean() == pytest.approx(0.0, abs=2e-4)
    tared = raw.force[0] - ramp_hold.reading[0]
    assert tared == pytest.approx(0.05, abs=5e-4)
    assert "tare of 50" in step(ramp_hold, "tare")
    assert "the baseline drifts by" in step(ramp_hold, "tare")
    assert "no drift taken off" in step(ramp_hold, "tare")


def test_nothing_is_filtered_by_default(raw: RelaxationTest):
    ramp_hold = prepare(raw)
    np.testing.assert_allclose(np.diff(ramp_hold.reading), np.diff(raw.force), atol=1e-12)
    assert "filter" not in [s.name for s in ramp_hold.steps]


def test_the_noise_of_both_channels_is_measured(raw: RelaxationTest):
    ramp_hold = prepare(raw)
    assert ramp_hold.force_noise == pytest.approx(4e-3, rel=0.05)
    assert ramp_hold.displacement_noise == pytest.approx(QUANTUM / 12**0.5, rel=1e-6)
    rough = prepare(simulate_relaxation(PAPER, rig=Rig(encoder=0, position_noise=5e-6)).test)
    assert rough.displacement_noise == pytest.approx(5e-6, rel=0.05)


def test_preparation_keeps_the_source(raw: RelaxationTest):
    source = Source(file="seal.csv", sha256="0" * 64)
    specimen = Specimen(length=0.05, height=0.02)
    ramp_hold = prepare(replace(raw, source=source, specimen=specimen))
    assert ramp_hold.source == source
    assert ramp_hold.specimen == specimen
    assert [s.name for s in ramp_hold.steps] == [
        "orientation", "segments", "contact", "tare", "ramp", "hum",
    ]  # fmt: skip


@settings(max_examples=20)
@given(
    delay=st.floats(0.2, 3.0),
    c=st.floats(0.05, 3.0),
    depth=st.floats(1e-4, 2e-2),
    rate=st.sampled_from([200.0, 1000.0]),
)
def test_prepare_recovers_an_ideal_ramp_exactly(delay: float, c: float, depth: float, rate: float):
    time = np.arange(round((delay + 10 * c) * rate)) / rate
    x = depth * np.clip((time - delay) / c, 0, 1)
    ramp_hold = prepare(
        RelaxationTest(time=time, displacement=x, force=PAPER.force(time, x), units="SI")
    )
    assert ramp_hold.onset == pytest.approx(delay, abs=1e-6)
    assert ramp_hold.ramp_end == pytest.approx(delay + c, abs=1e-6)
    assert ramp_hold.depth == pytest.approx(depth, rel=1e-9)
    assert ramp_hold.hold_end == time[-1]


@given(scale=st.floats(1e-3, 60), shift=st.floats(-10, 10), later=st.floats(-100, 100))
@settings(max_examples=20)
def test_units_and_zeros_do_not_matter(scale: float, shift: float, later: float):
    first = ideal(rate=200.0)
    ramp_hold = prepare(first)
    variant = prepare(
        RelaxationTest(
            time=first.time + later,
            displacement=scale * (first.displacement + shift * 8e-3),
            force=first.force,
            units="SI",
        )
    )
    assert variant.onset - later == pytest.approx(ramp_hold.onset, abs=1e-6)
    assert variant.ramp_time == pytest.approx(ramp_hold.ramp_time, abs=1e-6)
    assert variant.depth == pytest.approx(scale * ramp_hold.depth, rel=1e-6)


# -- signs ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("plate", "cell", "sentence"),
    [
        (-1, -1, "displacement and force are negative in compression; both signs are changed"),
        (-1, 1, "displacement is negative in compression; its sign is changed"),
        (1, -1, "force is negative in compression; its sign is changed"),
        (1, 1, "as recorded"),
    ],
)
def test_compression_is_made_positive(raw: RelaxationTest, plate: int, cell: int, sentence: str):
    expected = prepare(raw)
    ramp_hold = prepare(
        replace(raw, displacement=plate * raw.displacement + 3e-3, force=cell * raw.force)
    )
    assert sentence in step(ramp_hold, "orientation")
    np.testing.assert_allclose(ramp_hold.displacement, expected.displacement, atol=1e-12)
    np.testing.assert_allclose(ramp_hold.force, expected.force, atol=1e-12)


def test_prepare_accepts_a_sign(raw: RelaxationTest):
    turned = replace(raw, displacement=-raw.displacement, force=-raw.force)
    assert prepare(turned, sign=-1).depth == prepare(raw).depth
    with pytest.raises(DataError, match="ith the other sign it would ramp and rest"):
        prepare(turned, sign=1)
    with pytest.raises(DataError, match="sign = 2; expected 1, -1 or None"):
        prepare(raw, sign=2)


def test_a_force_on_both_sides_of_zero_is_refused(raw: RelaxationTest):
    pulled = raw.force - 3.0 * (raw.time > 20)
    with pytest.raises(DataError, match=r"mixed signs: .*a pressed seal only pushes"):
        prepare(replace(raw, force=pulled))


# -- contact, preload, baseline -------------------------------------------------------------------


def test_prepare_removes_and_reports_an_air_gap():
    made = simulate_relaxation(PAPER, rig=Rig(gap=0.5e-3))
    ramp_hold = prepare(made.test)
    assert "an air gap of 0.5" in step(ramp_hold, "contact")
    assert "crosses an air gap of 0.5 mm" in check(ramp_hold, "contact_detected").message
    assert ramp_hold.displacement[-1] == pytest.approx(8e-3, abs=QUANTUM)
    # the way through the air lengthens the baseline
    assert check(ramp_hold, "baseline_recorded").value > 1500
    assert np.abs(ramp_hold.displacement[ramp_hold.time < ramp_hold.onset - 0.01]).max() == 0.0


def test_the_error_of_the_contact_is_its_scatter():
    errors, stated = [], []
    for seed in range(12):
        made = simulate_relaxation(PAPER, hold_time=10.0, rig=Rig(gap=0.5e-3), seed=seed)
        ramp_hold = prepare(made.test)
        errors.append(ramp_hold.depth - (made.truth.displacement[-1] - 0.5e-3))
        stated.append(ramp_hold.contact_error)
    assert 0.5 < np.sqrt(np.mean(np.square(errors))) / np.mean(stated) < 2.0
    assert prepare(simulate_relaxation(PAPER, hold_time=2.0).test).contact_error == 0.0


def test_find_contact_is_independent_of_block_size(monkeypatch):
    x = np.linspace(0, 1e-3, 400)
    force = 2e3 * np.maximum(x - 3.1e-4, 0) + 2e-3 * np.random.default_rng(3).standard_normal(400)
    at_once = find_contact(x, force, noise=2e-3)
    monkeypatch.setattr(contact, "READINGS_PER_BATCH", 10)
    assert find_contact(x, force, noise=2e-3) == at_once
    assert at_once.displacement == pytest.approx(3.1e-4, abs=4 * at_once.standard_error)


def test_prepare_accepts_a_contact(raw: RelaxationTest):
    ramp_hold = prepare(raw, contact=1e-3)
    assert ramp_hold.depth == pytest.approx(7e-3, abs=1e-6)
    assert ramp_hold.onset == pytest.approx(prepare(raw).onset + 0.125, abs=1e-3)
    assert "Contact was given" in check(ramp_hold, "contact_detected").message
    turned = replace(raw, displacement=-raw.displacement)
    assert prepare(turned, contact=-1e-3).depth == ramp_hold.depth


def test_an_uncertain_contact_fails_its_check():
    rig = Rig(gap=1e-3, noise=0.2)
    ramp_hold = prepare(simulate_relaxation(PAPER, rig=rig, seed=1).test)
    assert ramp_hold.depth == pytest.approx(8e-3, abs=0.3e-3)
    assert check(ramp_hold, "contact_detected").failed
    assert "The depth is known to" in check(ramp_hold, "contact_detected").message


def test_prepare_distinguishes_a_preload_from_a_small_offset(raw: RelaxationTest):
    assert prepare(raw).preload == 0.0
    ramp_hold = prepare(replace(raw, force=raw.force + 0.3))
    assert ramp_hold.preload == pytest.approx(0.35, abs=1e-3)
    assert list_failed_checks(ramp_hold) == ["preload_absent"]
    assert (
        "the stiffnesses are those about that preload" in check(ramp_hold, "preload_absent").message
    )


def test_a_record_that_starts_on_the_ramp_has_no_tare():
    whole = ideal()
    mask = whole.time >= 1.5
    ramp_hold = prepare(
        RelaxationTest(
            time=whole.time[mask],
            displacement=whole.displacement[mask],
            force=whole.force[mask] + 0.2,
            units="SI",
        )
    )
    assert list_failed_checks(ramp_hold) == ["baseline_recorded", "preload_absent"]
    assert "The record has 1 sample before contact" in check(ramp_hold, "baseline_recorded").message
    assert step(ramp_hold, "tare").startswith("no tare: the record starts on the ramp")
    assert ramp_hold.onset == pytest.approx(1.5, abs=1e-6)
    assert ramp_hold.preload == pytest.approx(0.2)
    assert ramp_hold.force[0] == pytest.approx(0.2)


@pytest.mark.parametrize(("rate", "gap"), [(50.0, 1.2), (100.0, 0.6), (100.0, 1.2), (250.0, 0.3)])
@pytest.mark.parametrize("bend", [0.0, 0.4, 1.5])
def test_few_samples_show_the_air_of_a_record_that_starts_on_the_ramp(rate, gap, bend):
    """Air of 7 to 15 samples, mm of 8, counted as compression made a seal 4 to 15 % too soft."""
    time = np.arange(0, 21, 1 / (20 * rate))
    plate = 8.0 * np.minimum(time, 1.0)
    depth = np.maximum(plate - gap, 0.0)
    elastic = depth + bend * depth**2 / 8
    held = np.maximum(time - 1.0, 0.0)
    force = elastic * (0.2 + 0.05 * np.exp(-held))
    rows = slice(None, None, 20)
    noise = 3e-3 * np.random.default_rng(1).standard_normal(len(time[rows]))
    ramp_hold = prepare(
        RelaxationTest(time[rows], 1e-3 * plate[rows], force[rows] + noise, units="SI")
    )
    assert ramp_hold.depth == pytest.approx(8e-3 - 1e-3 * gap, abs=6e-5)


@pytest.mark.parametrize("rate", [50.0, 250.0, 1000.0])
@pytest.mark.parametrize("bend", [0.0, 0.4, 4.0])
def test_no_air_is_seen_where_a_record_starts_in_contact(rate, bend):
    time = np.arange(0, 21, 1 / rate)
    depth = 8.0 * np.minimum(time, 1.0)
    force = (depth + bend * depth**2 / 8) * (0.2 + 0.05 * np.exp(-np.maximum(time - 1.0, 0.0)))
    force += 3e-3 * np.random.default_rng(2).standard_normal(len(time))
    ramp_hold = prepare(RelaxationTest(time, 1e-3 * depth, force, units="SI"))
    assert ramp_hold.depth == pytest.approx(8e-3, rel=1e-9)


# -- drift ----------------------------------------------------------------------------------------


def test_prepare_removes_drift_only_on_request():
    drifting = simulate_relaxation(PAPER, rig=Rig(baseline=20.0, drift=2e-3)).test
    ramp_hold, inputs, seen = (prepare(drifting, drift=d) for d in (None, 2e-3, "baseline"))
    assert ramp_hold.force[-1] - inputs.force[-1] == pytest.approx(2e-3 * (61 - 10), rel=0.01)
    assert seen.force[-1] == pytest.approx(inputs.force[-1], abs=1e-3)
    assert "2 mN/s taken off" in step(inputs, "tare")


def test_an_impossible_drift_is_refused(raw: RelaxationTest):
    with pytest.raises(DataError, match="drift = 'auto'; expected a number in N/s, 'baseline'"):
        prepare(raw, drift="auto")
    whole = ideal()
    mask = whole.time >= 1.5
    with pytest.raises(DataError, match="drift='baseline' was asked for, but 1 samples lie before"):
        prepare(
            RelaxationTest(
                time=whole.time[mask],
                displacement=whole.displacement[mask],
                force=whole.force[mask],
                units="SI",
            ),
            drift="baseline",
        )


# -- several ramps, unloading, no hold ------------------------------------------------------------


def test_a_staircase_keeps_its_first_ramp_and_its_last_hold():
    test, _, _ = simulate_path(PAPER, path=((1.0, 4e-3), (11.0, 4e-3), (12.0, 8e-3), (42.0, 8e-3)))
    ramp_hold = prepare(test)
    assert ramp_hold.onset == pytest.approx(1.526, abs=2e-3)
    assert ramp_hold.ramp_time == pytest.approx(1.0, abs=5e-3)
    assert ramp_hold.hold_end == pytest.approx(43.5)
    assert ramp_hold.depth == pytest.approx(8e-3, abs=QUANTUM)
    message = check(ramp_hold, "single_loading").message
    assert "It has 2 ramps. The fit of ramp and hold follows them all" in message
    first = prepare(test, hold_end=12.0)
    assert first.depth == pytest.approx(4e-3, abs=QUANTUM)
    assert "ramps. The fit" not in check(first, "single_loading").message


@pytest.mark.parametrize("gap", [5e-3, 5.5e-3])
def test_an_approach_through_air_is_no_ramp(gap: float):
    path = ((1.0, 5e-3), (6.0, 5e-3), (7.0625, 13.5e-3), (37.0, 13.5e-3))
    test, truth, _ = simulate_path(PAPER, path=path, rig=Rig(gap=gap))
    ramp_hold = prepare(test)
    lag = 2 * 0.6 / (2 * np.pi * 6) - 5e-3
    assert ramp_hold.onset == pytest.approx(1.5 + 6.0 + (gap - 5e-3) / 8e-3 + lag, abs=5e-3)
    assert ramp_hold.ramp_end == pytest.approx(1.5 + 7.0625 + lag, abs=5e-3)
    assert ramp_hold.depth == pytest.approx(truth[-1] - gap, abs=QUANTUM)
    assert "ramps. The fit" not in check(ramp_hold, "single_loading").message
    assert list_failed_checks(ramp_hold) == []
    np.testing.assert_array_equal(prepare(replace(test, force=-test.force)).force, ramp_hold.force)


def test_prepare_refuses_a_contact_deeper_than_the_hold(raw: RelaxationTest):
    with pytest.raises(DataError, match=r"contact = 0\.009 m lies at or beyond the held"):
        prepare(raw, contact=9e-3)


def test_prepare_excludes_an_unloading_after_the_hold():
    test, _, _ = simulate_path(PAPER, path=((1.0, 8e-3), (31.0, 8e-3), (32.0, 0.0), (35.0, 0.0)))
    ramp_hold = prepare(test)
    assert ramp_hold.hold_end == pytest.approx(32.5, abs=0.02)
    assert ramp_hold.time[-1] == ramp_hold.hold_end
    assert ramp_hold.displacement[-1] == pytest.approx(8e-3, abs=QUANTUM)
    assert list_failed_checks(ramp_hold) == []


@pytest.fixture(scope="module")
def cycles() -> RelaxationTest:
    corners: list[tuple[float, float]] = []
    for start, hold in ((0, 1.0), (6, 3.0), (14, 20.0)):
        corners += [(start, 0.0)] if start else []
        corners += [(start + 1, 8e-3), (start + 1 + hold, 8e-3), (start + 2 + hold, 0.0)]
    return simulate_path(PAPER, path=(*corners, (40.0, 0.0)))[0]


def test_of_several_loadings_the_longest_hold_is_used_and_the_choice_listed(
    cycles: RelaxationTest,
):
    ramp_hold = prepare(cycles)
    assert ramp_hold.onset == pytest.approx(15.526, abs=3e-3)
    assert ramp_hold.hold_time == pytest.approx(20.0, abs=0.05)
    assert list_failed_checks(ramp_hold) == ["single_loading"]
    message = check(ramp_hold, "single_loading").message
    assert "The record has 3 loadings with a hold; cycle 3 is fitted" in message
    assert "2 moves towards the seal before it" in message
    assert "cycle 3 is fitted, because its hold is the longest" in message
    second = prepare(cycles, cycle=2)
    assert second.onset == pytest.approx(7.526, abs=3e-3)
    assert list_failed_checks(second) == []
    with pytest.raises(DataError, match=r"cycle 4 was asked for, but the record holds 3 loadings"):
        prepare(cycles, cycle=4)


def test_no_hold_is_an_error_that_shows_the_motion():
    test, _, _ = simulate_path(PAPER, path=((1.0, 8e-3), (2.0, 0.0), (3.0, 8e-3)))
    with pytest.raises(
        DataError,
        match=r"no hold after a ramp was found. The displacement shows hold 0 to .*, ramp .*"
        r"unloading .*Check the columns and the units",
    ):
        prepare(test)


def test_a_plate_that_never_moves_is_an_error(raw: RelaxationTest):
    with pytest.raises(DataError, match="the displacement never moves by more than its scatter"):
        prepare(replace(raw, displacement=np.zeros(len(raw.time))))


def test_the_error_names_the_file(raw: RelaxationTest):
    source = Source(file="bad.csv", sha256="")
    with pytest.raises(DataError, match=r"^bad\.csv: "):
        prepare(replace(raw, displacement=np.zeros(len(raw.time)), source=source))


def test_swapped_columns_are_noticed(raw: RelaxationTest):
    ramp_hold = prepare(replace(raw, displacement=1e-3 * raw.force, force=1e3 * raw.displacement))
    assert "columns_plausible" in list_failed_checks(ramp_hold)
    assert "Force and displacement look swapped" in check(ramp_hold, "columns_plausible").message


# -- times given ----------------------------------------------------------------------------------


def test_prepare_accepts_times(raw: RelaxationTest):
    ramp_hold = prepare(raw, onset=1.5, ramp_end=2.5, hold_end=20.0)
    assert (ramp_hold.onset, ramp_hold.ramp_end, ramp_hold.hold_end) == (1.5, 2.5, 20.0)
    assert ramp_hold.time[-1] == 20.0
    assert prepare(raw, onset=1.51).onset == 1.51
    assert prepare(raw, ramp_end=2.6).ramp_end == 2.6


def test_prepare_uses_stated_times_of_a_fast_creeping_hold():
    time = np.arange(2000) / 100
    x = 1e-3 * np.clip(time - 1, 0, 1) + 1e-3 * np.clip(time - 2, 0, None) ** 0.7
    test = RelaxationTest(time=time, displacement=x, force=PAPER.force(time, x), units="SI")
    ramp_hold = prepare(test, onset=1.0, ramp_end=2.0, hold_end=19.0)
    assert ramp_hold.hold_time == 17.0


@pytest.mark.parametrize(
    ("times", "sentence"),
    [
        ((3.0, 2.0, 20.0), "expected them in this order within the record, 0 to 42.5 s"),
        ((1.5, 2.5, 50.0), "expected them in this order within the record"),
        ((1.5, 2.5, 2.501), "in the hold that were given; expected at least 1 and 3"),
        ((5.0, 6.0, 20.0), "does not rise between the onset and the hold"),
    ],
)
def test_times_that_cannot_be_are_refused(
    raw: RelaxationTest, times: tuple[float, float, float], sentence: str
):
    onset, ramp_end, hold_end = times
    with pytest.raises(DataError, match=sentence):
        prepare(raw, onset=onset, ramp_end=ramp_end, hold_end=hold_end, sign=1)


# -- a force that says nothing --------------------------------------------------------------------


@pytest.mark.parametrize("ceiling", [0.5, 1.5, 2.0, 2.14])
def test_a_saturated_force_is_refused(raw: RelaxationTest, ceiling: float):
    with pytest.raises(DataError, match=r"force is clipped at .* larger load-cell range"):
        prepare(replace(raw, force=np.minimum(raw.force, ceiling)))


@pytest.mark.once
def test_prepare_without_checks_is_the_same_and_refuses_the_same(raw: RelaxationTest):
    ramp_hold = prepare(raw, with_checks=False)
    assert ramp_hold.checks == ()
    assert replace(ramp_hold, checks=prepare(raw).checks) == prepare(raw)
    with pytest.raises(DataError, match="clipped"):
        prepare(replace(raw, force=np.minimum(raw.force, 0.7 * raw.force.max())), with_checks=False)


def test_swapped_columns_are_not_called_saturated():
    time = np.arange(0, 42, 0.01)
    held = 8 * np.clip(time - 1, 0, 1)
    force = PAPER.force(time, 1e-3 * held) + 0.005 * np.sin(1e3 * time**2)
    with pytest.raises(DataError, match="force and displacement look swapped"):
        prepare(RelaxationTest(time, 1e-3 * force, held, units="SI"))


def test_an_elastic_or_a_coarse_force_is_not_called_saturated():
    elastic = prepare(ideal(force=lambda t, x: 200 * x))
    assert elastic.force.max() == pytest.approx(1.6)
    coarse = prepare(ideal(force=lambda t, x: np.round(PAPER.force(t, x) / 0.05) * 0.05))
    assert list_failed_checks(coarse) == []


def test_a_force_of_few_quanta_is_refused(raw: RelaxationTest):
    with pytest.raises(DataError, match=r"14 steps of the sensor's 150 mN; at least 20 are needed"):
        prepare(replace(raw, force=np.round(raw.force / 0.15) * 0.15))


def test_a_force_that_does_not_answer_is_refused(raw: RelaxationTest):
    noise = 1e-3 * np.random.default_rng(0).standard_normal(len(raw.time))
    with pytest.raises(DataError, match="the force does not rise while the plate presses"):
        prepare(replace(raw, force=noise))


def test_prepare_reports_an_oversized_load_cell(raw: RelaxationTest):
    ramp_hold = prepare(raw, force_range=70.0)
    assert list_failed_checks(ramp_hold) == ["load_cell_range_used"]
    assert "3 % of the load cell's 70 N" in check(ramp_hold, "load_cell_range_used").message
    assert list_failed_checks(prepare(raw, force_range=10.0)) == []
    with pytest.raises(DataError, match=r"force_range = 0.*expected a number > 0"):
        prepare(raw, force_range=0.0)


# -- samples that are missing, few, uneven or wild ------------------------------------------------


def some(raw: RelaxationTest, retained) -> RelaxationTest:
    return replace(
        raw,
        time=raw.time[retained],
        displacement=raw.displacement[retained],
        force=raw.force[retained],
    )


def test_prepare_reports_a_gap_in_the_ramp(raw: RelaxationTest):
    ramp_hold = prepare(some(raw, (raw.time < 1.7) | (raw.time > 2.3)))
    assert list_failed_checks(ramp_hold) == ["samples_unbroken", "clock_steady"]
    assert (
        "The longest pause between samples, up to one ramp time after the ramp, is 0.6"
        in check(ramp_hold, "samples_unbroken").message
    )
    assert ramp_hold.ramp_time == pytest.approx(1.0, abs=0.02)


def test_any_sampling_will_do(raw: RelaxationTest):
    drawn = np.sort(np.random.default_rng(1).choice(len(raw.time), 3000, replace=False))
    ramp_hold = prepare(some(raw, drawn))
    assert ramp_hold.onset == pytest.approx(1.526, abs=3e-3)
    assert ramp_hold.ramp_time == pytest.approx(1.0, abs=5e-3)
    late = 2600 + np.geomspace(1, 39000, 60).astype(int)
    logged = np.unique(np.concatenate((np.arange(0, 2600, 50), late)))
    ramp_hold = prepare(some(raw, logged))
    assert ramp_hold.ramp_time == pytest.approx(1.0, abs=5e-3)
    assert ramp_hold.hold_end == raw.time[int(logged[-1])]


def test_a_dozen_rows_are_enough():
    time = np.array([0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0, 10.0, 20.0, 40.0])
    x = 8e-3 * np.clip(time - 1, 0, 1)
    ramp_hold = prepare(
        RelaxationTest(time=time, displacement=x, force=PAPER.force(time, x), units="SI")
    )
    assert ramp_hold.onset == pytest.approx(1.0)
    assert ramp_hold.ramp_end == pytest.approx(2.0)
    assert ramp_hold.depth == pytest.approx(8e-3)


def test_prepare_refuses_times_out_of_order(raw: RelaxationTest):
    with pytest.raises(DataError, match=r"are out of order; expected them in this order"):
        prepare(raw, ramp_end=1.2)


def test_five_samples_a_second_still_show_the_ramp(raw: RelaxationTest):
    ramp_hold = prepare(some(raw, slice(None, None, 200)))
    assert ramp_hold.ramp_time == pytest.approx(1.0, abs=0.01)


def test_a_step_joins_two_samples():
    time = np.arange(5000) / 100
    x = np.where(time >= 1, 8e-3, 0.0)
    ramp_hold = prepare(
        RelaxationTest(time=time, displacement=x, force=PAPER.force(time, x), units="SI")
    )
    assert ramp_hold.onset == pytest.approx(0.99)
    assert ramp_hold.ramp_time == pytest.approx(0.01)


def test_prepare_ignores_and_reports_single_spikes(raw: RelaxationTest):
    expected = prepare(raw)
    force, x = raw.force.copy(), raw.displacement.copy()
    force[[700, 1900, 9000]] += 5.0
    x[[2000, 9500]] += 5e-3
    ramp_hold = prepare(replace(raw, force=force, displacement=x))
    assert list_failed_checks(ramp_hold) == ["spikes_absent"]
    assert "3 are of the force, 2 of the displacement" in check(ramp_hold, "spikes_absent").message
    assert ramp_hold.onset == pytest.approx(expected.onset, abs=1e-3)
    assert ramp_hold.ramp_end == pytest.approx(expected.ramp_end, abs=1e-3)
    assert ramp_hold.force[5000] == pytest.approx(expected.force[5000], abs=1e-5)
    mended = prepare(replace(raw, force=force, displacement=x), filter="median:3")
    assert np.abs(mended.force - expected.force).max() < 0.05


def test_prepare_applies_reports_and_checks_a_filter(raw: RelaxationTest):
    ramp_hold = prepare(raw, filter="lowpass:5Hz")
    assert ramp_hold.steps[-1].name == "filter"
    assert dict(ramp_hold.steps[-1].parameters) == {"filter": "lowpass:5Hz"}
    assert ramp_hold.unfiltered is not None
    np.testing.assert_array_equal(ramp_hold.unfiltered.force, prepare(raw).force)
    assert "filter_bias" in {check.name for check in fit(ramp_hold).checks if check.failed}
    assert ramp_hold.force_noise == prepare(raw).force_noise
    late = ramp_hold.time > 10
    assert np.std(np.diff(ramp_hold.force[late])) < 0.1 * np.std(np.diff(raw.force[raw.time > 10]))
    with pytest.raises(DataError, match="filter 'smooth' is not known"):
        prepare(raw, filter="smooth")


# -- real records ---------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["Relaxed", "RelaxedMavaSet", "pCa4.4"])
@pytest.mark.parametrize("ramp", [0.1, 1.0, 10.0, 100.0])
def test_the_muscle_records_start_on_their_ramp(real_data: Path, kind: str, ramp: float):
    rows = np.loadtxt(
        real_data / "titin-ramp-hold" / f"Avg{kind}_{ramp:g}s.csv", delimiter=",", skiprows=1
    )
    ramp_hold = prepare(
        RelaxationTest(time=rows[:, 0], displacement=rows[:, 1], force=rows[:, 2], units="SI")
    )
    assert ramp_hold.onset == pytest.approx(2.0, abs=0.005 * ramp)
    assert ramp_hold.ramp_time == pytest.approx(ramp, rel=2e-3)
    assert ramp_hold.depth == pytest.approx(1.1754 - 0.9498, abs=5e-4)
    assert ramp_hold.hold_end == rows[-1, 0]
    assert "baseline_recorded" in list_failed_checks(ramp_hold)


def test_prepare_of_the_afm_record_excludes_its_retraction(shared_data: Path):
    text = (shared_data / "rheosafm-jpk-relaxation" / "AFM_relaxation.txt").read_text()
    rows = np.array(
        [line.split() for line in text.splitlines() if line and line[0] != "#"], dtype=float
    )
    ramp_hold = prepare(
        RelaxationTest(time=rows[:, 2], displacement=rows[:, 0], force=rows[:, 1], units="SI")
    )
    # 800 samples of extension, 75000 of pause, then the retraction
    assert len(ramp_hold.time) == 75800
    assert ramp_hold.hold_end == pytest.approx(15.1599, abs=1e-6)
    assert ramp_hold.hold_time == pytest.approx(15.0, abs=0.01)
    assert ramp_hold.ramp_end == pytest.approx(0.1625, abs=0.003)
    # the tip flies 6 micrometres through the air first
    assert ramp_hold.onset == pytest.approx(0.123, abs=0.003)
    assert ramp_hold.depth == pytest.approx(2.0e-6, abs=0.1e-6)
    assert ramp_hold.force.max() == pytest.approx(2.2e-6, rel=0.02)
    assert "displacement is negative in compression" in step(ramp_hold, "orientation")
    assert np.abs(ramp_hold.displacement[ramp_hold.time < 0.12]).max() == 0.0


def test_the_tiny_record_of_101_rows(real_data: Path):
    rows = np.loadtxt(real_data / "rheos-data-time" / "data_time.csv", delimiter=",")
    ramp_hold = prepare(
        RelaxationTest(time=rows[:, 0], displacement=rows[:, 1], force=rows[:, 2], units="s, mm, N")
    )
    assert ramp_hold.onset == pytest.approx(1.0, abs=1e-9)
    assert ramp_hold.ramp_end == pytest.approx(3.0, abs=1e-9)
    assert ramp_hold.depth == pytest.approx(2e-3)
    assert list_failed_checks(ramp_hold) == []


@pytest.mark.parametrize(
    ("name", "columns", "ramps"),
    [("_0d1", (0, 2, 1), 4), ("_1", (0, 1, 2), 4), ("_2", (0, 1, 2), 4), ("", (0, 1, 2), 5)],
)
def test_the_adhesive_climbs_in_steps(real_data: Path, name: str, columns, ramps: int):
    openpyxl = pytest.importorskip("openpyxl")
    path = real_data / "oca-cyclic-shear-relaxation" / f"shear_relaxation{name}.xlsx"
    sheet = openpyxl.load_workbook(path).active
    rows = np.array([row[:3] for row in sheet.iter_rows(values_only=True)], dtype=float)
    time, force, x = (rows[:, i] for i in columns)
    ramp_hold = prepare(RelaxationTest(time=time, displacement=x, force=force, units="s, mm, N"))
    assert f"It has {ramps} ramps" in check(ramp_hold, "single_loading").message
